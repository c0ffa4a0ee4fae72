"""Check accepted calls by another way than the call itself: 50 digits, the closed loop, one door against another."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision.reference import HighPrecision, error_in_roundings
from tests.hostile.planes import PLANES

#: Sizes of numbers that are checked: beyond them a step may overflow or underflow, which 50 digits do not.
LEAST, GREATEST = 1e-3, 1e3
#: An argument that is taken for another number changes more than this; the digits themselves are tested elsewhere.
ROUNDINGS = 1000.0
OPTIONS = ("branch", "links", "input", "solver", "allow_invalid")


def call_of(door: str, text: str, names: dict[str, Any]) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """Return the arguments of a call, by position and by name."""
    assert text.startswith(f"{door}(")
    taken: Any = eval(text.replace(door, "arguments_of", 1), names | {"arguments_of": lambda *a, **k: (a, k)})
    return taken


def configurations(inputs: dict[str, Any]) -> Iterator[tuple[Any, dict[str, float]]]:
    """Yield the first and the last of the configurations, with their places; those of usual sizes."""
    arrays = dict(zip(inputs, np.broadcast_arrays(*map(np.asarray, inputs.values())), strict=True))
    shape = next(iter(arrays.values())).shape
    if 0 in shape:
        return
    for place in {tuple(0 for _ in shape), tuple(n - 1 for n in shape)}:
        one = {name: float(values[place]) for name, values in arrays.items()}
        if all(value == 0.0 or LEAST <= abs(value) <= GREATEST for value in one.values()):
            yield place, one


def evaluated(result: dict[str, Any], text: str, names: dict[str, Any]) -> str:
    """Return what is wrong with evaluated quantities, by the same facts with 50 digits, or an empty text."""
    (mechanism, *_), options = call_of("fl.evaluate", text, names)
    facts = catalogue(mechanism, options.get("input"))
    inputs = {name: value for name, value in options.items() if name not in OPTIONS}
    choices = {name: min(one.choices) for name, one in facts.inputs.items() if one.choices}
    for place, one in configurations(choices | inputs | {"branch": options.get("branch", 1)}):
        reference = HighPrecision(facts, result, one, zeroes=True)
        exact = reference.at(one)
        condition = reference.condition(exact, [name for name in one if name not in (*choices, "branch")])
        for name, values in result.items():
            value = float(np.asarray(values)[place])
            if np.isnan(value) and np.isnan(float(exact[name])):
                continue
            if not error_in_roundings(value, exact[name], condition[name]) <= ROUNDINGS:
                return f"{name} is {value!r}, with 50 digits {float(exact[name])!r}"
        theta4 = result.get("theta4") if mechanism == "planar_4r" else None
        if theta4 is not None and (wrong := open_loop(float(np.asarray(theta4)[place]), **one)):
            return wrong
    return ""


def open_loop(
    theta4: float, *, a1: float, a2: float, a3: float, a4: float, theta1: float, branch: float, **_: float
) -> str:
    """Return how far the loop of a planar 4R is from closed, or on which side of AD its point B is, if it is wrong."""
    A, D = a1 * np.exp(1j * theta1), complex(a4)
    B = D + a3 * np.exp(1j * theta4)
    reach = a1 + a2 + a3 + a4
    # Each point is some roundings of its lengths off; near toggles, where theta4 is less exact, B moves across AB.
    if abs(abs(B - A) - a2) > 32 * UNIT_ROUNDING * reach:
        return f"the coupler is {abs(B - A)} long"
    left = ((D - A).conjugate() * (B - A)).imag
    if (left > 0.0) != (branch == 2.0) and abs(left) > 1e-6 * reach**2:
        return "B is on the side of the other assembly mode"
    return ""


def swept(result: Any, text: str = "", names: dict[str, Any] | None = None) -> str:
    """Return whether the angles of a map of the planar 4R are not the bits of `fastlink.evaluate`."""
    if (
        result.attrs["mechanism"] != "planar_4r"
        or "theta4" not in result
        or "theta1" not in result.theta4.dims
    ):
        return ""
    given = {name: result[name] for name in ("a1", "a2", "a3", "a4")}
    facts = fl.evaluate(
        "planar_4r", ["theta4"], **given, theta1=result.theta1, branch=result.branch, allow_invalid=True
    )["theta4"]
    facts = facts.broadcast_like(result.theta4).transpose(*result.theta4.dims)
    return "" if np.array_equal(result.theta4, facts, equal_nan=True) else "theta4 differs from evaluate"


def function(result: Any, text: str, names: dict[str, Any]) -> str:
    """Return whether a function of designs does not give the bits of a sweep of them, or an empty text."""
    (mechanism, inputs, outputs), options = call_of("fl.function", text, names)
    sample = np.linspace(0.7, 1.3, 3)
    constants = {name: options.pop(name) for name in ("a1", "a3", "a4", "omega1")}
    designs = fl.table(constants | dict.fromkeys(inputs, sample))
    maps = fl.sweep(mechanism, designs, outputs, threads=1, progress=False, verify=0, **options)
    wanted = [maps[name].values for name in outputs]
    found = result(np.tile(sample, (len(result.inputs), 1)))
    return "" if np.array_equal(found, wanted, equal_nan=True) else f"gives {found}, a sweep {wanted}"


def by_name(check: Callable[[Any, str, dict[str, Any]], str]) -> Callable[[Any, str, dict[str, Any]], str]:
    """Return the check of a function that is called by the names of its arguments."""

    def checked(result: Any, text: str, names: dict[str, Any]) -> str:
        door = text.partition("(")[0]
        with np.errstate(all="ignore"):  # of calls that give NaN, which is looked at
            return check(result, door.rpartition(".")[2], call_of(door, text, names)[1])

    return checked


#: By the word of a door.
CHECKS: dict[str, Callable[[Any, str, dict[str, Any]], str]] = {
    "evaluated": evaluated,
    "swept": swept,
    "function": function,
    **{word: by_name(check) for word, check in PLANES.items()},
}

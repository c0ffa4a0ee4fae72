"""`fl.sweep`, `fl.evaluate` and `fl.function` give hostile arguments one verdict: both accept, or both refuse alike.

Nothing is compiled for a verdict: a sweep is resolved, which checks all of it. Where both doors accept, some designs
are compared by their numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from tests.support.hostile_values import Raising, arrays, scalars

import fastlink as fl
from fastlink.engine.resolve import resolve
from fastlink.errors import Wording

BARS = fl.round_bar(density=7850.0, radius=0.01)
#: What each mechanism is asked for, besides hostile names: by its first input, and by another.
REQUESTS: dict[tuple[str, str | None], tuple[dict[str, float], tuple[str, ...], dict[str, float]]] = {
    ("planar_4r", None): (
        {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 2.0, "gravity_y": -9.81, "m1": 1.0},
        ("omega4", "T41"),
        {"theta1": 1.0},
    ),
    ("planar_4r", "joint_angle_2"): (
        {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0},
        ("theta4",),
        {"joint_angle_2": 1.0},
    ),
    ("slider_crank", None): (
        {"r": 0.1, "l": 0.4, "e": 0.01, "omega": 3.0},
        ("slider_position",),
        {"theta": 1.0},
    ),
    ("minkowski_4r", None): ({"a": 1.0, "b": 1.0, "g": 4.0, "h": 1.0}, ("psi",), {"theta": 0.5}),
    ("focal", None): (
        {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0, "completion": 1},
        ("F_x",),
        {"phi": 1.0},
    ),
    ("hart", None): ({"m": 1.0, "n": 1.1, "d": 1.2, "kappa": 0.5}, ("F_x",), {"phi": 0.3}),
    ("hart", "F_y"): ({"m": 1.0, "n": 1.1, "d": 1.2, "kappa": 0.5}, ("F_x",), {"F_y": 0.1}),
}


# fmt: off
def branches() -> list[Any]:
    """Return what may be given for assembly modes."""
    return [
        *scalars(), [1, 2], (2, 1), [1.0, 2.0], np.array([1.0, 2.0]), np.array([1, 2], dtype=np.int8), [True, 2],
        [1, None], [1, 2.5], [1, "2"], [1, float("nan")], [[1, 2], [2]], np.ma.array([1, 2], mask=[0, 1]), [3],
        range(1, 3), np.array([1, None], dtype=object), [np.bool_(True), 2], pd.Series([1, 2]),
        xr.DataArray([1, 2]), [1, 10**5000],
    ]


def names() -> list[Any]:
    """Return what may be given for quantities."""
    return [
        None, 3, 0.5, b"F_x", "F_x", [], (), {}, set(), {"F_x"}, {"F_x": 1}, [None], [3], [["F_x"]], [b"F_x"], [""],
        ["F_x", "F_x"], ["omga4"], ["d_omega4_d_a9"], ["omega4_eror"], ["status", "F_x_"], [np.nan], np.array(3),
        ["branch"], ["theta1"], ["a1"], ["phi"], ["d_status_d_a1"], Raising(), ["F_x\0"], ["x" * 5000], True, int,
    ]
# fmt: on


def others() -> list[Any]:
    """Return what may be given where a name or a model is expected."""
    return [
        *scalars()[15:],
        "round_bar",
        [],
        ["dense"],
        "dense",
        "theta",
        "phi",
        "F_y",
        np.array(["a", "b"]),
        BARS,
    ]


@dataclass(frozen=True)
class Call:
    """One request, with one hostile argument."""

    mechanism: Any
    design: dict[str, Any]
    quantities: Any
    position: dict[str, Any]
    options: dict[str, Any] = field(default_factory=dict)
    kind: str = ""
    changed: str = ""


def calls(seed: int, count: int) -> list[Call]:
    """Return requests of which one argument each is hostile."""
    rng = np.random.default_rng(seed)
    keys, made = list(REQUESTS), []
    kinds = [
        "value",
        "value",
        "array",
        "array",
        "branch",
        "quantities",
        "links",
        "solver",
        "input",
        "mechanism",
    ]
    kinds.append("name")
    unusual = ["gravity", "gravty", "a9", "rho", "s", "density", "completion", "m2", "lambda_", "A1", "omega"]

    def one_of(choices: list[Any]) -> Any:
        return choices[rng.integers(len(choices))]

    for _ in range(count):
        mechanism, driven = keys[rng.integers(len(keys))]
        usual, quantities, position = REQUESTS[mechanism, driven]
        design, options = dict(usual), {"input": driven, "branch": 1}
        if mechanism in ("planar_4r", "slider_crank"):
            options["links"] = BARS
        kind = one_of(kinds)
        call: dict[str, Any] = {"mechanism": mechanism, "quantities": list(quantities)}
        changed = kind
        if kind in ("value", "array"):
            changed = one_of(list(design))
            design[changed] = one_of(scalars() if kind == "value" else arrays())
        elif kind == "name":
            changed = one_of(unusual)
            design[changed] = one_of([1.0, *scalars()[:4]])
        elif kind == "branch":
            options["branch"] = one_of(branches())
        elif kind == "quantities":
            call["quantities"] = one_of(names())
        elif kind == "mechanism":
            call["mechanism"] = one_of(others())
        else:
            options[kind] = one_of(others())
        if rng.random() < 0.1:
            del design[one_of(list(design))]
        made.append(
            Call(
                **call,
                design=design,
                position=position,
                options=options,
                kind=kind,
                changed=changed,
            )
        )
    return made


def verdict(door: Callable[[], Any]) -> tuple[Any, set[tuple[str, str]] | None]:
    """Return the result of a door, or else the last name of the path and the remedy of each problem."""
    try:
        return door(), None
    except fl.InputError as error:
        problems, text = error.problems, str(error)
    assert text
    words = Wording()
    keys = [[part for part in one.where[1:] if isinstance(part, str)] or one.where[:1] for one in problems]
    keys = [
        [] if key in (("design",), ("evaluate",), ("function",)) else key for key in keys
    ]  # all inputs together
    remedies = [words.remedy(one.remedy) for one in problems]
    return None, {(key[-1] if key else "", remedy) for key, remedy in zip(keys, remedies, strict=True)}


def swept(call: Call) -> Any:
    """Resolve a sweep at the one position of the call."""
    positions = {name: [value] for name, value in call.position.items()}
    space = fl.grid(**call.design)
    return resolve(call.mechanism, space, call.quantities, positions=positions, **call.options)


def evaluated(call: Call) -> Any:
    return fl.evaluate(call.mechanism, call.quantities, **call.design, **call.position, **call.options)


def alike(of_sweep: set[tuple[str, str]], of_evaluate: set[tuple[str, str]], *, whole: bool) -> bool:
    """Tell whether every problem of the sweep is among those of evaluate, whose remedies may go on.

    A sweep's values are read by `fl.grid` alone, before the request is checked: evaluate reports the rest too. Of an
    array it may name another value, the first that is no number instead of the first that is no code.
    """
    return all(
        any(key == other and (whole or more.startswith(remedy) or not more) for other, more in of_evaluate)
        for key, remedy in of_sweep
    )


def made(call: Call) -> Any:
    """Make the function of the first input of the design, the others of which stay."""
    first, *rest = call.design
    fixed = {name: call.design[name] for name in rest} | {k: [v] for k, v in call.position.items()}
    return fl.function(call.mechanism, [first], call.quantities, **fixed, **call.options)


def check(call: Call) -> bool:
    """Assert one verdict of all doors, and return whether it is to accept."""
    resolved, refused_there = verdict(lambda: swept(call))
    values, refused_here = verdict(lambda: evaluated(call))
    shown = f"{call.changed}: sweep {refused_there}, evaluate {refused_here}"
    assert (refused_there is None) == (refused_here is None), shown
    if refused_there is None or refused_here is None:
        assert set(values) <= {output.name for output in resolved.plan.outputs}, shown
        return True
    assert alike(refused_there, refused_here, whole=call.kind == "array"), shown
    if call.changed != next(iter(call.design)) and call.kind != "array":
        # a function that were made would be compiled, and no test
        refused_by_function = verdict(lambda: made(call))[1]
        assert refused_by_function, f"{shown}: a function is made"
        keys = {"outputs" if key == "quantities" else key for key, _ in refused_there}
        assert keys & {key for key, _ in refused_by_function}, f"{shown}, function {refused_by_function}"
    return False


@pytest.mark.filterwarnings("ignore:Warning. converting a masked element to nan")
@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.stress)])
def test_all_doors_give_one_verdict(seed):
    accepted = [check(call) for call in calls(seed, 400 if seed == 1 else 10_000)]
    # both verdicts come up: a test of one of them alone would be none
    assert 0.03 < np.mean(accepted) < 0.5


def test_what_both_doors_accept_has_the_same_numbers():
    """Whatever the type of a number: a sweep and evaluate read it alike, to the bit."""
    design, (name, _), position = REQUESTS["planar_4r", None]
    design = {key: design[key] for key in ("a1", "a2", "a3", "a4", "omega1")}
    angles = {key: [value] for key, value in position.items()}
    for a1 in (
        Fraction(2, 5),
        Decimal("0.4"),
        np.float32(0.4),
        np.array(0.4),
        xr.DataArray(0.4),
        np.ma.array(0.4),
    ):
        given = design | {"a1": a1}
        there = fl.sweep("planar_4r", fl.grid(**given), [name], branch=(1, 2), **angles)[name]
        here = fl.evaluate("planar_4r", [name], **given, **position, branch=[1, 2])[name]
        np.testing.assert_array_equal(there.values.ravel(), np.ravel(here))
        if not isinstance(a1, np.float32):
            assert float(np.ravel(here)[0]) == fl.evaluate("planar_4r", [name], **design, **position)[name]

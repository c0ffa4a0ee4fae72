"""Check the request of `fastlink.function`: inputs that vary, numbers that stay, outputs that go together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fastlink._text import counted
from fastlink.errors import InputError, Problem, Problems
from fastlink.plan.validate import unknown_input
from fastlink.space.degrees import angle_of, degrees_name, in_unit
from fastlink.space.samplers import grid
from fastlink.space.values import numbers_of

if TYPE_CHECKING:
    from fastlink.catalogue.catalogue import Catalogue, Input
    from fastlink.engine.resolve import ResolvedSweep
    from fastlink.plan.program import Output
    from fastlink.space.design_space import DesignSpace

__all__ = ["axes_of", "constants", "refuse_choices", "wrong_inputs"]


def wrong_inputs(catalogue: Catalogue, names: Sequence[str]) -> list[Problem]:
    """Return the problems of names that are listed as inputs and are none."""
    position, known = catalogue.position.name, catalogue.all_inputs
    problems = []
    for k, name in enumerate(names):
        if name in (position, degrees_name(position), "branch"):
            remedy = f"leave it out of the list, and write {name} as an option of the function"
            problems.append(Problem(f"{name!r} is not an input of a design", ("inputs", k), remedy))
        elif name not in known and angle_of(name) not in known:
            problems.append(unknown_input(catalogue, name, known, "inputs"))
    return problems


def constants(fixed: Mapping[str, Any], known: Mapping[str, Input]) -> dict[str, float]:
    """Return fixed inputs as numbers in their own units, or refuse what is not one number."""
    numbers, problems = {}, Problems()
    for name, value in fixed.items():
        with problems.at():
            plain = numbers_of("function", name, value)
            numbers[name] = in_unit(("function", name), value, plain, known[name].units)
    problems.stop()
    space = grid(numbers)
    if space.dims:
        name = space.dims[0]
        what = f"is given {counted(space.shape[0], 'value')}"
        remedy = "write one number, or name it among the inputs"
        raise InputError(what, where=("function", name), remedy=remedy)
    return space.constants


def refuse_choices(resolved: ResolvedSweep, varying: DesignSpace) -> None:
    """Refuse a missing code, of which a sweep would evaluate every choice."""
    known = resolved.catalogue.known_inputs(resolved.plan.variants)
    for name in resolved.space.axes:
        if name not in varying.names:
            codes = ", ".join(f"{code} ({meaning})" for code, meaning in known[name].choices.items())
            raise InputError("is missing", where=("function", name), remedy=f"give it, one of {codes}")


def axes_of(outputs: Sequence[Output]) -> tuple[str, ...]:
    """Return the axes of the output that has most; no other may have further ones."""
    first, *others = (output for output in sorted(outputs, key=lambda output: -len(output.axes)))
    for other in others:
        if set(other.axes) - set(first.axes):
            what = f"{first.name} is along {first.axes[-1]}, {other.name} along {other.axes[-1]}"
            raise InputError(what, where=("function",), remedy="make a function of each")
    return first.axes

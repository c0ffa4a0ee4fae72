"""Read the numbers of one or many designs for functions of both planes, by the rules of a sweep."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from fastlink._text import short_repr
from fastlink.catalogue.catalogue import Catalogue, Input
from fastlink.engine.broadcast import broadcast_inputs, like
from fastlink.errors import InputError, Problems
from fastlink.options import check_whole
from fastlink.plan.validate import name_problems, value_problems
from fastlink.space.degrees import angle_of, in_unit
from fastlink.space.values import MOST_DIMS, has, numbers_of, read_or_none

__all__ = [
    "BY_NAME",
    "CURVE",
    "GREATEST_LENGTH",
    "MOST_SAMPLES",
    "all_entries",
    "broadcast",
    "broadcast_points",
    "check_lengths",
    "check_samples",
    "read_design",
]

#: The inputs of planar_4r that determine a coupler curve.
CURVE = ("a1", "a2", "a3", "a4", "P_u", "P_v")
#: How the functions of planar_4r are called, for who calls them otherwise.
BY_NAME = "inputs are given by name, such as a1=0.5, or as one mapping"
#: Lengths of whole designs are at most this, and links at least its inverse: no product of six over a squared one
#: overflows.
GREATEST_LENGTH = 1e25
#: Most samples of one curve.
MOST_SAMPLES = 10**6


def read_design(
    function: str,
    catalogue: Catalogue,
    design: Any,
    inputs: Mapping[str, Any],
    needed: Iterable[str],
    *,
    optional: Iterable[str] = (),
    further: Iterable[tuple[Input, Any]] = (),
) -> dict[str, Any]:
    """Return the inputs of designs that a function needs, as arrays of one shape.

    Parameters
    ----------
    function : str
        The function that was called, for messages.
    catalogue : Catalogue
        The mechanism.
    design : mapping, pandas.DataFrame, xarray.Dataset or None
        Inputs by name. An input position is not read, nor are columns and variables that are not inputs.
    inputs : mapping
        Further inputs by name.
    needed, optional : iterable of str
        The names to return; and those to return where they are given.
    further : iterable of (Input, value)
        What else is checked and broadcast.

    Raises
    ------
    InputError
        With every input that is unknown, missing, given twice or has an impossible value, and every length beyond
        `GREATEST_LENGTH`.
    """
    known, problems = catalogue.known_inputs(catalogue.variant_inputs), Problems()
    of_position = (catalogue.position.name, f"{catalogue.position.name}_deg")
    given = all_entries(function, design, inputs, known, problems, of_position)
    names = [name for name in given if angle_of(name) not in known]  # no angle is needed
    problems.noted += name_problems(catalogue, names, known, function)
    for name in needed:
        if name not in given:
            what = f"is missing ({known[name].meaning} [{known[name].units}])"
            problems.add(what, (function, name), "add it to the design")
    values = {name: given[name] for name in (*needed, *optional) if name in given}
    declared = {name: known[name] for name in values} | {one.name: one for one, _ in further}
    values |= {one.name: value for one, value in further}
    numbers = _broadcast(function, declared, values, problems)
    check_lengths(function, declared.values(), numbers.values())
    return numbers


def all_entries(
    function: str,
    design: Any,
    inputs: Mapping[str, Any],
    known: Iterable[str],
    problems: Problems,
    unread: Iterable[str] = (),
) -> dict[str, Any]:
    """Return what a design gives of the known names but some, and what is given by name; note what is in both."""
    given = {name: of for name, of in _entries(function, design, known).items() if name not in unread}
    for name in inputs:
        if name in given:
            problems.add("is in the design and given by name", (function, name), "leave one out")
    return given | dict(inputs)


def _entries(function: str, design: Any, known: Iterable[str]) -> dict[str, Any]:
    """Return name and values of each input of a design."""
    if design is None:
        return {}
    entries = read_or_none(_entries_of, design, known)
    if entries is not None:
        return entries
    what, remedy = f"is {short_repr(design)}", "give the inputs by name, such as a1=0.5, or a mapping of them"
    raise InputError(what, where=(function, "design"), remedy=remedy)


def _entries_of(design: Any, known: Iterable[str]) -> dict[str, Any] | None:
    """Return name and values of each input of a DataFrame, a Dataset or a mapping; None of what is none of these."""
    if has(design, "data_vars") and has(design, "variables"):
        return {name: design[name] for name in design.variables if name in known}
    if has(design, "columns") and has(design, "to_numpy"):
        return {name: design[name].to_numpy() for name in design.columns if name in known}
    if isinstance(design, Mapping) and all(isinstance(name, str) for name in design):
        return dict(design)
    return None


def broadcast(function: str, declared: Iterable[Input], *numbers: Any, gaps: bool = False) -> list[Any]:
    """Return numbers as arrays of one shape.

    Parameters
    ----------
    function : str
        The function that was called, for messages.
    declared : iterable of Input
        The name of each number, and the values that it may have.
    *numbers : float or array_like
        The numbers.
    gaps : bool
        Whether NaN may stand among them.

    Raises
    ------
    InputError
        With every value that is not a number or impossible; or the shapes do not broadcast.

    Examples
    --------
    >>> lengths = [Input(name, "m", name, "length", "positive") for name in ("a1", "a2")]
    >>> broadcast("sextic", lengths, 1.0, [0.5, 2.0])
    [array([1., 1.]), array([0.5, 2. ])]
    """
    named = {one.name: one for one in declared}
    values = dict(zip(named, numbers, strict=True))
    return list(_broadcast(function, named, values, Problems(), gaps=gaps).values())


def broadcast_points(function: str, x: Any, y: Any) -> list[Any]:
    """Return the coordinates of points in the last axis, among which NaN may stand, as arrays of one shape."""
    declared = (Input(name, "m", name, "coordinate of the points") for name in "xy")
    points = broadcast(function, declared, x, y, gaps=True)
    if not points[0].ndim:
        raise InputError("is one point", where=(function, "x"), remedy="write arrays of points")
    return points


def _broadcast(
    function: str,
    declared: Mapping[str, Input],
    values: Mapping[str, Any],
    problems: Problems,
    *,
    gaps: bool = False,
) -> dict[str, Any]:
    read = {}
    for name, value in values.items():
        with problems.at():
            stated = numbers_of(function, name, value, MOST_DIMS)
            numbers = in_unit((function, name), value, stated, declared[name].units)
            checked = np.where(np.isnan(numbers), 1.0, numbers) if gaps else numbers
            problems.noted += value_problems(declared[name], checked, function)
            read[name] = like(value, numbers)
    problems.stop()
    _, plain, shape = broadcast_inputs(function, read)
    return {name: np.broadcast_to(value, shape) for name, value in plain.items()}


def check_lengths(
    function: str,
    declared: Iterable[Input],
    values: Iterable[Any],
    greatest: float = GREATEST_LENGTH,
    products: str = "six lengths over a squared one",
) -> None:
    """Refuse lengths whose products would overflow or vanish: those beyond a greatest, links below its inverse.

    Raises
    ------
    InputError
        With the first such value of each length; inputs in other units are not looked at.
    """
    problems = Problems()
    for one, numbers in zip(declared, values, strict=True):
        least = 1.0 / greatest if one.rule == "positive" else -greatest
        if one.units != "m" or bool(np.all((numbers >= least) & (numbers <= greatest))):
            continue
        bad = numbers[~((numbers >= least) & (numbers <= greatest))].flat[0]
        remedy = (
            f"write {least:g} to {greatest:g}, in another unit of length: products of {products} are computed"
        )
        problems.add(f"is {bad} ({one.meaning})", (function, one.name), remedy)
    problems.stop()


def check_samples(function: str, samples: Any, least: int = 1) -> int:
    """Return a number of samples of a curve, or refuse it."""
    return check_whole((function, "samples"), samples, least, MOST_SAMPLES)

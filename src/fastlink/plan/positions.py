"""Checks of a request: input positions, by whatever name they are given, and the search for extrema."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import short_repr
from fastlink.catalogue.catalogue import Catalogue
from fastlink.errors import InputError, Problems, Samples, Setting, suggest
from fastlink.mechanisms import NAMES, inputs_of
from fastlink.options import check_choice
from fastlink.plan.query import Extrema, parse_request
from fastlink.space.degrees import (
    DEGREE_UNIT,
    DEGREES,
    RADIANS,
    Degrees,
    angle_of,
    as_floats,
    check_angle,
    degrees_name,
    has_unit,
    in_unit,
    radians,
    remark_on_angles,
    unit_remedy,
)
from fastlink.space.values import (
    MOST_DIMS,
    MOST_LISTED,
    check_length,
    first_invalid,
    listed,
    numbers_of,
    units_of,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from fastlink.engine.extending import Extension

__all__ = [
    "check_extrema",
    "check_keywords",
    "check_positions",
    "check_turn",
    "given_angles",
    "in_degrees",
    "radian_keywords",
]

EXTREMA: tuple[Extrema, ...] = ("refined", "sampled")
ANGLES = 360
#: What users call an option that takes degrees.
IN_DEGREES = ("deg", "degree", "degrees", "in_degrees")


def check_keywords(
    mechanism: str | Extension, catalogue: Catalogue, names: Iterable[str], options: Iterable[str]
) -> None:
    """Refuse a keyword that is neither an option nor the name of the input that drives the mechanism.

    `names` are the keywords that are not options, `options` those that are, for a hint.

    Raises
    ------
    InputError
        With the name of the input, or the nearest option.
    """
    position, problems = catalogue.position.name, Problems()
    for name in names:
        if name == position:
            continue
        if name in (degrees_name(position), "angles_deg"):
            if name == "angles_deg":
                problems.add("is not an option", (name,), f"write {degrees_name(position)}")
            else:
                with problems.at():
                    check_angle(name, position, catalogue.position.units, ())
        elif name in IN_DEGREES and catalogue.position.units == RADIANS:
            problems.add("is not an option", (name,), f"write angles in degrees as {degrees_name(position)}")
        elif any(name in inputs_of(other) for other in NAMES):
            own = name in inputs_of(mechanism)
            other = (f", or, to drive {name}, write ", Setting("input", name)) if own else ()
            problems.add(f"the input is {position}", (name,), (f"write its positions as {position}", other))
        else:
            problems.add("is not an option", (name,), suggest(name, {*options, position}))
    problems.stop()


def _are_several(values: Any) -> bool:
    """Tell whether input positions are an array, or at least no scalar."""
    if isinstance(values, (list, tuple, range)):  # one of 10^8 takes 10 s to convert
        return True
    try:
        return np.ndim(values) > 0
    except Exception:  # ragged lists, and whatever a class of somebody's does; `check_positions` refuses them
        return True


def given_angles(catalogue: Catalogue, angles: Any, positions: Mapping[str, Any]) -> tuple[str, Any]:
    """Return the input positions that were given, and by which name; else the usual ones.

    Those in degrees are converted. A warning tells of numbers that can hardly be radians.

    Raises
    ------
    InputError
        They are given both as `angles` and by the name of the input, or in degrees too; or degrees are no array.
    """
    name = catalogue.position.name
    given = {
        "angles": angles,
        name: positions.get(name),
        degrees_name(name): positions.get(degrees_name(name)),
    }
    given = {key: values for key, values in given.items() if values is not None}
    if len(given) > 1:
        first, second, *_ = given
        are = "angles are" if first == "angles" else f"{first} is"
        raise InputError(f"{are} given too", where=(second,), remedy="write one of them")
    if catalogue.position.units != RADIANS:
        given.pop(degrees_name(name), None)  # see `check_keywords`
    for key, values in given.items():
        check_length((key,), values)
        try:
            if not isinstance(values, (list, tuple, range)):
                np.ndim(values)
        except Exception:  # whatever a class of somebody's does when it is converted
            remedy = "write a flat array of numbers"
            raise InputError(f"is {short_repr(values)}", where=(key,), remedy=remedy) from None
        if isinstance(values, Degrees):
            return degrees_name(name), _from_degrees(catalogue, values.values)
        unit = units_of(key, values).get(key, "")
        expected = DEGREE_UNIT if key == degrees_name(name) else catalogue.position.units
        if unit in DEGREES and expected == RADIANS:
            return key, _from_degrees(catalogue, values)
        if unit and not has_unit(unit, expected):
            raise InputError(f"has the unit {unit!r}", where=(key,), remedy=unit_remedy(expected))
        if key == degrees_name(name):
            return key, _from_degrees(catalogue, values)
        if catalogue.position.units == RADIANS and _are_several(values):
            remark_on_angles(name, values)
        return key, values
    return name, ANGLES if catalogue.positions is None else np.linspace(*catalogue.positions)


def in_degrees(catalogue: Catalogue, angles: Any, positions: Mapping[str, Any]) -> bool:
    """Tell whether input positions are given in degrees."""
    return isinstance(angles, Degrees) or positions.get(degrees_name(catalogue.position.name)) is not None


def _from_degrees(catalogue: Catalogue, values: Any) -> NDArray[Any]:
    """Return input positions in radians, or refuse what is no array of degrees."""
    name = catalogue.position.name
    key = degrees_name(name)
    if listed(values) == 0 or not _are_several(values):
        other = f"; {name} may be a number of angles" if catalogue.positions is None else ""
        raise InputError(
            f"is {short_repr(values)}", where=(key,), remedy=f"write a flat array of degrees{other}"
        )
    return as_floats(check_positions(catalogue, values, key))


def radian_keywords(
    catalogue: Catalogue, door: str, given: Mapping[str, Any], problems: Problems, *, position: bool
) -> dict[str, Any]:
    """Return inputs that are given by keywords with every angle in radians, by its own name.

    Parameters
    ----------
    catalogue : Catalogue
        The mechanism.
    door : str
        The function that is called, for the paths of problems.
    given : mapping of str to value
        The inputs.
    problems : Problems
        Receives what is wrong; such inputs are left out.
    position : bool
        Whether the input position may be among them.
    """
    declared = catalogue.all_inputs
    if position:
        declared[catalogue.position.name] = catalogue.position
    result: dict[str, Any] = {}
    for name, value in given.items():
        angle = "" if name in declared else angle_of(name)
        if angle not in declared:
            result[name] = value
            continue
        try:
            check_angle(name, angle, declared[angle].units, given)
            numbers = numbers_of(door, name, value, MOST_DIMS)
            plain = radians(in_unit((door, name), value, numbers, DEGREE_UNIT))
            result[angle] = _relabelled(value, plain) if hasattr(value, "dims") else plain
        except InputError as error:
            problems.noted += [replace(one, where=(door, name, *one.where[2:])) for one in error.problems]
            result.setdefault(angle, 0.5)  # so that it is not reported as missing too
    return result


def _relabelled(value: Any, numbers: Any) -> Any:
    """Return other numbers with the dimensions and coordinates of labelled ones."""
    result = value.copy(data=numbers)
    result.attrs = {}  # with the unit
    return result


def check_extrema(extrema: str | None, catalogue: Catalogue, angles: Any) -> Extrema:
    """Return the search for extrema: refined over a whole turn, unless the angles themselves are given.

    Raises
    ------
    InputError
        The search is unknown, or does not go with an array of angles.
    """
    chosen = _are_several(angles)
    if extrema is None:
        return "sampled" if chosen else "refined"
    extrema = check_choice(("extrema",), extrema, EXTREMA)
    if chosen and extrema == "refined":
        name = catalogue.position.name
        what = f"'refined' is over the whole turn of {name}, but {name} is an array"
        other = ", or a number of angles" if catalogue.positions is None else ""
        remedy = ("write ", Setting("extrema", "sampled"), other)
        raise InputError(what, where=("extrema",), remedy=remedy)
    return "refined" if extrema == "refined" else "sampled"


def check_turn(catalogue: Catalogue, names: Iterable[str], angles: Any) -> None:
    """Refuse an array of angles for a reduction that needs equal steps over a whole turn.

    Raises
    ------
    InputError
        With the name of the reduction.
    """
    if not _are_several(angles):
        return
    problems = Problems()
    for k, request in enumerate(parse_request(name, catalogue) for name in names):
        if request.reduction is not None and request.reduction.whole:
            what = f"{request.name!r} is over a whole turn, but {catalogue.position.name} is an array"
            remedy = "write a number of angles" if catalogue.positions is None else "leave it out"
            problems.add(what, ("quantities", k), remedy)
    problems.stop()


def check_positions(catalogue: Catalogue, given: int | ArrayLike, key: str = "angles") -> NDArray[Any]:
    """Return the input positions: a number of equal steps over one turn, or the positions themselves.

    Parameters
    ----------
    catalogue : Catalogue
        The mechanism.
    given : int or array_like
        A number of positions, or these.
    key : str
        The name by which it was given.

    Raises
    ------
    InputError
        The number is not positive, or a position is not finite or repeated.
    """
    name, noun = catalogue.position.name, "angles in rad" if catalogue.positions is None else "numbers"
    noun = "angles in degrees" if angle_of(key) else noun
    if catalogue.positions is not None and not _are_several(given):
        what = f"{short_repr(given)} is not an array, and {name} has no bounds"
        remedies = ("write them all, such as ", Samples(*catalogue.positions))
        raise InputError(what, where=(key,), remedy=remedies)
    if isinstance(given, (int, np.integer)) and not isinstance(given, (bool, np.timedelta64)):
        if not 1 <= given <= MOST_LISTED:
            what = f"{short_repr(given)} input angles"
            remedy = f"write a number from 1 to {MOST_LISTED}, or an array in rad"
            raise InputError(what, where=(key,), remedy=remedy)
        return np.arange(int(given)) * (2.0 * np.pi / int(given))
    turning = "a number of angles, or " if catalogue.positions is None else ""
    remedy = f"write {turning}a flat array of {noun}"
    try:
        values = numbers_of("", key, given)
    except InputError as error:
        raise InputError(error.what, where=error.where[1:], remedy=remedy) from None
    if values.ndim != 1:
        raise InputError(f"is {short_repr(given)}", where=(key,), remedy=remedy)
    if values.size == 0:
        raise InputError("the array of input positions is empty", where=(key,), remedy="give at least one")
    if (bad := first_invalid(values)) is not None:
        raise InputError(f"is {values[bad]}", where=(key, bad), remedy=f"write finite {noun}")
    order = np.argsort(values, kind="stable")
    twice = np.flatnonzero(np.diff(values[order]) == 0.0)
    if twice.size:
        first, second = sorted(order[twice[0] : twice[0] + 2].tolist())
        what = f"{values[first]} stands twice (at {first} and {second})"
        raise InputError(what, where=(key,), remedy="give each position once")
    return np.array(values)

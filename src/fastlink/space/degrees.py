"""Angles that are given in degrees, by names that end in ``_deg``."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import short_repr
from fastlink.errors import InputError, KeyPath, Remedy, remark
from fastlink.numerics.compensated import two_product, two_sum
from fastlink.space.values import Floats, numbers_of, units_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "COMMENT",
    "DEGREES",
    "DEGREE_UNIT",
    "RADIANS",
    "Degrees",
    "angle_of",
    "as_floats",
    "check_angle",
    "degrees_name",
    "ends_of",
    "has_unit",
    "in_unit",
    "looks_like_degrees",
    "radians",
    "remark_on_angles",
    "unit_remedy",
]

ENDING = "_deg"
#: The unit of angles, and the texts by which labelled values say that theirs is the degree.
RADIANS, DEGREES = "rad", frozenset({"deg", "degree", "degrees", "°"})
#: The unit of an input whose name ends in ``_deg``.
DEGREE_UNIT = "deg"
#: What labelled values call units, by the catalogue's own text.
SAME_UNITS = {
    "m": {"m", "meter", "metre", "meters", "metres"},
    "rad": {"rad", "radian", "radians"},
    "1": {"1", "", "dimensionless"},
    "kg": {"kg", "kilogram", "kilograms"},
    "N": {"N", "newton", "newtons"},
    DEGREE_UNIT: DEGREES,
}
#: The comment of a coordinate whose values were converted.
COMMENT = "given in degrees"
#: pi/180 as an unevaluated sum of two doubles, 106 bits of it.
DEGREE, DEGREE_LOW = 0.017453292519943295, 2.9486522708701687e-19
#: Numbers beyond are shifted by a power of two, for Veltkamp's splitting would leave the range of doubles.
GREAT, SMALL, SHIFT = 1e290, 1e-200, 256
#: Whole numbers of at least so much are no usual angles in radians, and multiples of 30 are usual ones in degrees.
BEYOND, STEP, MOST_DEGREES = 10.0, 30.0, 36000.0


@dataclass(frozen=True, eq=False)
class Degrees:
    """Input positions in degrees, in place of an array of angles."""

    values: Any


def angle_of(name: str) -> str:
    """Return the name of an angle that is given in degrees, an empty text for another name.

    Examples
    --------
    >>> angle_of("theta1_deg"), angle_of("theta1")
    ('theta1', '')
    """
    return name.removesuffix(ENDING) if name.endswith(ENDING) else ""


def degrees_name(name: str) -> str:
    """Return the name by which an angle is given in degrees."""
    return name + ENDING


def radians(degrees: Any) -> Any:
    """Return degrees in radians, rounded once from 100 bits of deg pi/180, if not below 1e-307.

    180 gives the double nearest to pi.

    Examples
    --------
    >>> import math
    >>> float(radians(180.0)) == math.pi, float(radians(40.0))
    (True, 0.6981317007977318)
    """
    values = np.asarray(degrees, dtype=np.float64)
    with np.errstate(all="ignore"):
        size = abs(values)
        scale = np.where(size > GREAT, 2.0**-SHIFT, np.where(size < SMALL, 2.0**SHIFT, 1.0))
        product, rest = two_product(values * scale, DEGREE)
        high, _ = two_sum(product, rest + values * scale * DEGREE_LOW)
        # -0.0 and what is not finite as they are
        return np.where((size > 0.0) & (size < np.inf), high / scale, values)[()]


def looks_like_degrees(values: Any) -> bool:
    """Tell whether numbers can hardly be radians by their size: whole ones, or up to a multiple of 30.

    Examples
    --------
    >>> looks_like_degrees([40, 80, 120]), looks_like_degrees([0.0, 3.1]), looks_like_degrees([0, 1, 2, 3, 4, 5, 6])
    (True, False, False)
    """
    if isinstance(values, (bytes, bytearray, memoryview)):
        return False  # refused as such
    try:
        numbers: NDArray[Any] = np.asarray(values, dtype=np.float64)
    except Exception:  # whatever a class of somebody's does when it is converted
        return False
    if not numbers.size:
        return False
    most = float(abs(numbers).max())
    if not BEYOND <= most <= MOST_DEGREES:
        return False
    return most % STEP == 0.0 or bool((numbers % 1.0 == 0.0).all())


def check_angle(name: str, angle: str, unit: str, others: Collection[str]) -> None:
    """Refuse degrees of what is no angle, or is given in radians too."""
    if unit != RADIANS:
        unit = "a plain number" if unit == "1" else f"in {unit}"
        raise InputError(f"{angle} is no angle but {unit}", where=(name,), remedy=f"write {angle}")
    if angle in others:
        raise InputError(f"{angle} is given too", where=(name,), remedy="write one of them")


def has_unit(unit: str, expected: str) -> bool:
    """Tell whether labelled values state the unit that is expected, by whatever spelling.

    Examples
    --------
    >>> has_unit("rad/s", "rad s-1"), has_unit("rad s-1", "rad s-1"), has_unit("mm", "m"), has_unit("°", "deg")
    (False, True, False, True)
    """
    plain = unit.translate(str.maketrans("", "", "^* ."))
    return plain == expected.replace(" ", "") or unit.strip() in SAME_UNITS.get(expected, ())


def unit_remedy(expected: str) -> str:
    """Return the remedy for values that state another unit."""
    return f"convert it to {'degrees' if expected == DEGREE_UNIT else expected}, or leave the attribute 'units' out"


def in_unit(where: KeyPath, given: Any, numbers: Floats, expected: str) -> Floats:
    """Return the numbers of labelled values in the expected unit: degrees are converted, other units refused."""
    for unit in units_of("", given).values():
        if unit in DEGREES and expected == RADIANS:
            return as_floats(numbers)
        if not has_unit(unit, expected):
            raise InputError(f"has the unit {unit!r}", where=where, remedy=unit_remedy(expected))
    return numbers


def ends_of(where: str, name: str, given: Any, unit: str, remedy: Remedy) -> tuple[float, float]:
    """Return the ends of a range, or refuse it: not two numbers, not in order, or farther apart than any double."""
    ends = in_unit((where, name), given, numbers_of(where, name, given), unit)
    with np.errstate(over="ignore", invalid="ignore"):
        if ends.shape != (2,) or not 0.0 < ends[1] - ends[0] < np.inf:
            raise InputError(f"is {short_repr(given)}", where=(where, name), remedy=remedy)
    return float(ends[0]), float(ends[1])


def remark_on_angles(name: str, values: Any, *where: str) -> None:
    """Warn of angles that can hardly be meant as radians."""
    if looks_like_degrees(values):
        what = f"{short_repr(np.asarray(values).tolist())} is taken as radians"
        remark(what, (*where, name), f"if these are degrees, write {degrees_name(name)}")


def as_floats(values: Any) -> Floats:
    """Return values in degrees as an array in radians."""
    return np.asarray(radians(values), dtype=np.float64)

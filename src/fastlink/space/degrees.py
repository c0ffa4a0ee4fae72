"""Angles that are given in degrees, by names that end in ``_deg``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import short_repr
from fastlink.errors import InputError
from fastlink.numerics.compensated import two_product, two_sum
from fastlink.space.values import Floats

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["COMMENT", "Degrees", "angle_of", "degrees_name", "looks_like_degrees", "radians"]

ENDING = "_deg"
#: The unit of angles, and the texts by which labelled values say that theirs is the degree.
RADIANS, DEGREES = "rad", frozenset({"deg", "degree", "degrees", "°"})
#: The comment of a coordinate whose values were converted.
COMMENT = "given in degrees"
#: pi/180 as an unevaluated sum of two doubles, 106 bits of it.
DEGREE, DEGREE_LOW = 0.017453292519943295, 2.9486522708701687e-19
#: Numbers beyond are too great to be split by Veltkamp's constant.
LARGEST_SPLIT = 1e290
#: Whole numbers of at least so much are no usual angles in radians, and multiples of 30 are usual ones in degrees.
BEYOND, STEP = 10.0, 30.0


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
    """Return degrees in radians, rounded once from 100 bits of deg pi/180.

    180 gives the double nearest to pi. Labelled values keep their labels.

    Examples
    --------
    >>> import math
    >>> float(radians(180.0)) == math.pi, float(radians(40.0))
    (True, 0.6981317007977318)
    """
    if hasattr(degrees, "dims"):
        return degrees.copy(data=radians(degrees.values))
    values = np.asarray(degrees, dtype=np.float64)
    with np.errstate(all="ignore"):
        product, rest = two_product(values, DEGREE)
        high, _ = two_sum(product, rest + values * DEGREE_LOW)
        plain = values * DEGREE
        return np.where(abs(values) < LARGEST_SPLIT, np.where(np.isfinite(high), high, plain), plain)[()]


def looks_like_degrees(values: Any) -> bool:
    """Tell whether numbers can hardly be radians by their size: whole ones, or up to a multiple of 30.

    Examples
    --------
    >>> looks_like_degrees([40, 80, 120]), looks_like_degrees([0.0, 3.1]), looks_like_degrees([0, 1, 2, 3, 4, 5, 6])
    (True, False, False)
    """
    try:
        numbers: NDArray[Any] = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        return False
    if not numbers.size:
        return False
    most = float(abs(numbers).max())
    if not BEYOND <= most < np.inf:
        return False
    return most % STEP == 0.0 or bool((numbers % 1.0 == 0.0).all())


def converted(names: Mapping[str, Any], units: Mapping[str, str]) -> dict[str, Any]:
    """Return keywords with each angle that is given in degrees in radians, by its own name.

    Parameters
    ----------
    names : mapping of str to value
        The keywords.
    units : mapping of str to str
        The unit of each input.

    Raises
    ------
    InputError
        An angle is given twice, or an input is no angle.
    """
    result: dict[str, Any] = {}
    for name, value in names.items():
        angle = "" if name in units else angle_of(name)
        if angle not in units:
            result[name] = value
            continue
        check_angle(name, angle, units[angle], names)
        try:
            result[angle] = radians(value)
        except (TypeError, ValueError):
            what = f"is {short_repr(value)}"
            raise InputError(what, where=(name,), remedy="write numbers, in degrees") from None
    return result


def check_angle(name: str, angle: str, unit: str, others: Mapping[str, Any] | tuple[str, ...]) -> None:
    """Refuse degrees of what is no angle, or is given in radians too."""
    if unit != RADIANS:
        unit = "a plain number" if unit == "1" else f"in {unit}"
        raise InputError(f"{angle} is no angle but {unit}", where=(name,), remedy=f"write {angle}")
    if angle in others:
        raise InputError(f"{angle} is given too", where=(name,), remedy="write one of them")


def as_floats(values: Any) -> Floats:
    """Return values in degrees as an array in radians."""
    return np.asarray(radians(values), dtype=np.float64)

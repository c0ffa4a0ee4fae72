"""Powers of two of the units of mass, length and time in which the numbers of a design are near 1.

Facts multiply forces by lengths and masses by squares of lengths: of lengths of 1e-160 m the moments underflow, though
angles and forces are ordinary numbers. In other units they are: a design far from 1 is evaluated in units of its own, a
power of two times kg, m and s, and its results are taken back. Both are exact, so that an ordinary design has the same
bits in any such units, and is evaluated in its own.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.facts.names import Derivative, ErrorBound, Trust

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.facts.catalogue import Catalogue
    from fastlink.facts.fact import Input

__all__ = [
    "PURE",
    "DesignSizes",
    "Sized",
    "dimensional",
    "dimensions",
    "is_ordinary",
    "natural_size",
    "sized",
    "sizes_of",
]


#: Powers of kilogram, metre and second.
Dimensions = tuple[int, int, int]
NONE: Dimensions = (0, 0, 0)
MASS, LENGTH, TIME = (1, 0, 0), (0, 1, 0), (0, 0, 1)
UNITS: dict[str, Dimensions] = {"kg": MASS, "m": LENGTH, "s": TIME, "rad": NONE, "1": NONE}
UNITS |= {"N": (1, 1, -2), "J": (1, 2, -2), "W": (1, 2, -3)}
#: Designs stay as they are if their numbers are within 2^-ORDINARY and 2^ORDINARY. The steps of all facts are
#: products of at most eight of them, and stay far within 2^-1022 and 2^1023.
ORDINARY = 80
LEAST, MOST = math.ldexp(1.0, -ORDINARY), math.ldexp(1.0, ORDINARY)
#: In its own units, a design has no greater number.
GREATEST = 960
#: The search of extremes takes squares of slopes: beyond, of lengths that count as squares themselves (those of mass
#: centres) beyond half of it, they overflow or underflow.
SEARCHED = 480
#: Beyond this power of two, results may leave the normal numbers when they are taken back.
FAR = 900
#: Two units in the last place of what is below 2^-1022: that of the value, and that of its bound.
UNDERFLOW = math.ldexp(1.0, -1073)


@lru_cache(maxsize=256)
def dimensions(units: str) -> Dimensions:
    """Return the powers of kilogram, metre and second in a unit.

    Examples
    --------
    >>> dimensions("N m"), dimensions("rad s-2"), dimensions("kg m-3")
    ((1, 2, -2), (0, 0, -2), (1, -3, 0))
    """
    found = [re.fullmatch(r"([A-Za-z]+|1)(-?\d*)", unit) for unit in units.split()]
    powers = [(UNITS[match[1]], int(match[2] or 1)) for match in found if match is not None]
    mass, length, time = (sum(unit[k] * power for unit, power in powers) for k in range(3))
    return mass, length, time


def is_ordinary(values: Any) -> bool:
    """Tell whether all numbers are 0 or within 2^-80 and 2^80; NaN and infinities are of no size.

    Examples
    --------
    >>> is_ordinary([0.0, -3.0, 1e-20]), is_ordinary(1e-150)
    (True, False)
    """
    if isinstance(values, float):  # 5 us less than by an array
        return LEAST < abs(values) < MOST or values == 0.0 or not math.isfinite(values)
    sizes = np.abs(np.asarray(values))
    if sizes.size and sizes.min() > LEAST and sizes.max() < MOST:  # no array of conditions
        return True
    return not ((sizes > 0.0) & ~((sizes > LEAST) & (sizes < MOST)) & np.isfinite(sizes)).any()


@lru_cache(maxsize=256)
def dimensional(catalogue: Catalogue, version: int, names: tuple[str, ...]) -> dict[str, Input]:
    """Return those of these names that are inputs with a dimension; found once for a version of the catalogue."""
    declared = catalogue.all_inputs
    return {
        name: declared[name]
        for name in names
        if name in declared and dimensions(declared[name].units) != NONE
    }


@dataclass(frozen=True, eq=False)
class DesignSizes:
    """The units of designs.

    Attributes
    ----------
    exponents : tuple of int array
        Those of two, by which kilogram, metre and second are multiplied.
    apart : bool array
        Where no units bring all inputs near 1: those designs are evaluated as they are, and no bound holds.
    stays : bool array
        Where lengths are far from 1 and stay, as positions do: no bound of a derivative holds.
    unsearched : bool array
        Where the search of extremes may overflow: no bound of theirs holds.
    """

    exponents: tuple[NDArray[Any], NDArray[Any], NDArray[Any]]
    apart: NDArray[Any]
    stays: NDArray[Any]
    unsearched: NDArray[Any]

    def power(self, of: Dimensions) -> Any:
        """Return the power of two by which numbers of these dimensions are greater than in the units of the design."""
        return sum(power * exponent for power, exponent in zip(of, self.exponents, strict=True))

    def inputs(self, catalogue: Catalogue, values: Mapping[str, Any]) -> dict[str, Any]:
        """Return the inputs with a dimension in the units of the design."""
        declared = dimensional(catalogue, catalogue.version, tuple(values))
        return {
            name: np.ldexp(values[name], -self.power(dimensions(one.units))) for name, one in declared.items()
        }

    def result(self, sized: Sized, value: Any, axes: int = 0) -> Any:
        """Return a result in kilogram, metre and second; it has further axes besides those of the designs."""
        power = np.asarray(self.power(sized.dimensions))
        further = (..., *(None,) * axes)
        with np.errstate(over="ignore", under="ignore"):
            value = np.ldexp(value, power[further]) if sized.dimensions != NONE else value
        lost = self.apart | self.stays if sized.is_slope else self.apart
        lost = lost | self.unsearched if sized.is_extreme else lost
        if sized.is_bound:
            value = np.where((power < -FAR)[further], value + UNDERFLOW, value)
            return np.where(lost[further] & ~np.isnan(value), np.inf, value)
        if sized.is_trust:
            doubtful = lost | (np.abs(self.power(sized.of_value)) > FAR)
            return np.where(doubtful[further] & (value == 0.0), 1.0, value)
        return value


@dataclass(frozen=True)
class Sized:
    """Units of a result: the powers in it, or those of the value whose trust it is.

    `is_slope` tells that this value, or that of which it is a bound, is a derivative; `is_extreme` that it is the bound
    of an extreme.
    """

    dimensions: Dimensions
    is_bound: bool = False
    is_trust: bool = False
    is_slope: bool = False
    of_value: Dimensions = NONE
    is_extreme: bool = False


#: What has no units.
PURE = Sized(NONE)


def sized(catalogue: Catalogue, name: str, units: str) -> Sized:
    """Return what a quantity of these units has of them."""
    tree = catalogue.parse(name)
    if not isinstance(tree, (ErrorBound, Trust)):
        return Sized(dimensions(units))
    is_slope = isinstance(tree.of, Derivative)
    if isinstance(tree, ErrorBound):
        return Sized(dimensions(units), is_bound=True, is_slope=is_slope)
    of_value = dimensions(catalogue.public_fact(str(tree.of)).units)
    return Sized(NONE, is_trust=True, is_slope=is_slope, of_value=of_value)


def sizes_of(catalogue: Catalogue, inputs: Mapping[str, Any]) -> DesignSizes | None:
    """Return the units of designs, or None where they are those of the inputs.

    The longest link, the greatest mass and the greatest rate are near 1 there. Where a joint's position is a length,
    which all designs share, lengths stay.
    """
    declared = dimensional(catalogue, catalogue.version, tuple(inputs))
    values = {name: inputs[name] for name in declared}
    if all(map(is_ordinary, values.values())):
        return None
    of = {name: dimensions(one.units) for name, one in declared.items()}
    shapes, fixed = (
        np.broadcast_shapes(*map(np.shape, values.values())),
        dimensions(catalogue.position.units)[1] != 0,
    )
    mass, far, rate = _sizes(declared, values, lengths_stay=fixed, settled=_settled)
    length = np.int64(0) if fixed else far
    exponents = [np.broadcast_to(one, shapes) for one in (mass, length, -rate)]
    apart, stays = np.zeros(shapes, dtype=bool), np.broadcast_to((far != 0) & fixed, shapes)
    sizes = DesignSizes((exponents[0], exponents[1], exponents[2]), apart, stays, np.zeros_like(apart))
    for name, value in values.items():
        power, most = -sizes.power(of[name]), SEARCHED // 2 if of[name] == LENGTH else SEARCHED
        with np.errstate(over="ignore", under="ignore"):
            there = np.ldexp(value, power)
            exponent, exact = _exponent(there), np.ldexp(there, -power) == value
        apart |= np.isfinite(value) & (~exact | ((exponent > GREATEST) & (power > 0)))
        small = (exponent < -SEARCHED) & (value != 0.0) if of[name][0] != 0 else False
        sizes.unsearched[...] |= (exponent > most) | small
    whole = [np.where(apart, 0, one) for one in exponents]
    return DesignSizes((whole[0], whole[1], whole[2]), apart, stays, sizes.unsearched)


def natural_size(catalogue: Catalogue, inputs: Mapping[str, Any], units: str) -> float:
    """Return the power of two near which a quantity of these units is for a design: of its lengths, masses and rates.

    Examples
    --------
    >>> from fastlink.mechanisms import catalogue
    >>> natural_size(catalogue("planar_4r"), {"a1": 3.0, "a2": 7.0, "omega1": 1.5}, "m s-1")
    16.0
    """
    declared = dimensional(catalogue, catalogue.version, tuple(inputs))
    mass, length, rate = _sizes(declared, inputs, lengths_stay=False, settled=_of_any)
    power = sum(x * int(y) for x, y in zip(dimensions(units), (mass, length, -rate), strict=True))
    return math.ldexp(1.0, min(max(power, -1074), 1023))


def _sizes(
    declared: Mapping[str, Input],
    values: Mapping[str, Any],
    *,
    lengths_stay: bool,
    settled: Callable[[Any], Any],
) -> tuple[Any, Any, Any]:
    """Return the exponents of the greatest mass, of the longest link and of the greatest rate."""
    of = {name: dimensions(one.units) for name, one in declared.items()}
    far = settled(
        _greatest(_exponent(values[n]) for n in of if of[n] == LENGTH and declared[n].rule == "positive")
    )
    length = np.int64(0) if lengths_stay else far
    rates = [n for n in of if of[n][:2] == (0, 0) and of[n][2] < 0]
    rate = settled(_greatest(_exponent(values[n]) // -of[n][2] for n in rates))
    of_masses = _greatest(_exponent(values[n]) for n in of if of[n] == MASS)
    others = [n for n in of if of[n][0] == 1 and of[n] != MASS]
    of_others = _greatest(_exponent(values[n]) - (of[n][1] * length - of[n][2] * rate) for n in others)
    # moments of inertia far beyond those of the masses are near 2^SEARCHED
    of_masses = np.where(of_masses > _NOTHING // 2, np.maximum(of_masses, of_others - SEARCHED), of_others)
    return settled(of_masses), far, rate


#: The exponent of what has no size.
_NOTHING = -(2**40)


def _exponent(value: Any) -> Any:
    """Return the exponents of numbers, that of 0, NaN and infinity below all."""
    sizes = np.abs(np.asarray(value, dtype=np.float64))
    return np.where((sizes > 0.0) & (sizes < np.inf), np.frexp(sizes)[1].astype(np.int64), _NOTHING)


def _greatest(exponents: Iterable[Any]) -> Any:
    """Return the greatest of exponents."""
    found: Any = np.int64(_NOTHING)
    for one in exponents:
        found = np.maximum(found, one)
    return found


def _settled(exponent: Any) -> Any:
    """Return 0 where numbers are ordinary, or nothing has a size."""
    return np.where((np.abs(exponent) <= ORDINARY) | (exponent < _NOTHING // 2), 0, exponent)


def _of_any(exponent: Any) -> Any:
    """Return 0 where nothing has a size."""
    return np.where(exponent < _NOTHING // 2, 0, exponent)

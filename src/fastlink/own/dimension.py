"""Check the units of a user's quantity: its text runs on numbers that have no value, only a dimension.

Designs far from 1 are evaluated in units of their own (`fastlink.catalogue.sizes`), which is right only for a text that
means the same in any units: constants are pure numbers, what has a unit is an input.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from fastlink._text import short_repr
from fastlink.catalogue.sizes import UNITS, dimensions
from fastlink.errors import InputError, KeyPath
from fastlink.symbolic.condition import Condition

__all__ = ["Dimension", "WrongDimension", "check_units", "dimension_of_text", "units_text"]

#: What other programs call units, and their texts here.
OTHERS = {
    "deg": "rad",
    "degree": "rad",
    "degrees": "rad",
    "°": "rad",
    "": "1",
    "-": "1",
    "dimensionless": "1",
}
OTHERS |= {
    "Nm": "N m",
    "N*m": "N m",
    "m/s": "m s-1",
    "rad/s": "rad s-1",
    "Hz": "s-1",
    "Pa": "N m-2",
    "mm": "m",
}
OTHERS |= {"m/s2": "m s-2", "m/s^2": "m s-2", "kg*m2": "kg m2", "kN": "N", "ms": "s", "g": "kg", "%": "1"}


class WrongDimension(Exception):
    """Unlike dimensions are added, compared or chosen between, or a function takes numbers without units only."""


@dataclass(frozen=True, eq=False)
class Dimension:
    """A number of which only the powers of kilogram, metre and second are known."""

    powers: tuple[float, ...]

    @property
    def context(self) -> _Functions:
        """The functions of `fastlink.numerics.elementary` for such numbers."""
        return _Functions()

    def _like(self, other: Any, doing: str) -> Dimension:
        if isinstance(other, int | float) and (other == 0 or other != other):
            return self
        if (powers := _powers(other)) != self.powers:
            raise WrongDimension(f"{doing} {units_text(self.powers)} and {units_text(powers)}")
        return self

    def _sum(self, other: Any) -> Dimension:
        return self._like(other, "adds")

    __add__ = __radd__ = __sub__ = __rsub__ = _sum

    def _times(self, other: Any, sign: int) -> Dimension:
        return Dimension(tuple(x + sign * y for x, y in zip(self.powers, _powers(other), strict=True)))

    def __mul__(self, other: Any) -> Dimension:
        return self._times(other, 1)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Dimension:
        return self._times(other, -1)

    def __rtruediv__(self, other: Any) -> Dimension:
        return Dimension(_powers(other))._times(self, -1)

    def __neg__(self) -> Dimension:
        return self

    __abs__ = __neg__

    def _compared(self, other: Any) -> _Condition:
        self._like(other, "compares")
        return _Condition()

    __lt__ = __le__ = __gt__ = __ge__ = __eq__ = __ne__ = _compared  # type: ignore[assignment]
    __hash__ = None  # type: ignore[assignment]


class _Condition(Condition):
    """The result of a comparison."""

    def choose(self, if_true: Any, if_false: Any) -> Any:
        """Return the dimension of both values of `fastlink.numerics.elementary.select`."""
        if isinstance(if_true, float) and if_true == 0.0:
            return if_false
        return _pure(if_true)._like(if_false, "chooses between")


class _Functions:
    """Elementary functions of such numbers."""

    nan = float("nan")

    def sqrt(self, x: Any) -> Dimension:
        return Dimension(tuple(0.5 * power for power in _powers(x)))

    def atan2(self, y: Any, x: Any) -> Dimension:
        _pure(y)._like(x, "takes the angle of")
        return Dimension(PURE)

    def _of_number(self, x: Any) -> Dimension:
        if any(_powers(x)):
            raise WrongDimension(
                f"takes a function of {units_text(_powers(x))}, not of a number without units"
            )
        return Dimension(PURE)

    log = cos = sin = _of_number


PURE = (0.0, 0.0, 0.0)


def _powers(value: Any) -> tuple[float, ...]:
    return value.powers if isinstance(value, Dimension) else PURE


def _pure(value: Any) -> Dimension:
    return value if isinstance(value, Dimension) else Dimension(PURE)


def units_text(powers: tuple[float, ...]) -> str:
    """Return powers of kilogram, metre and second as units.

    Examples
    --------
    >>> units_text((1.0, 1.0, -2.0)), units_text((0.0, 0.5, 0.0)), units_text((0.0, 0.0, 0.0))
    ('N', 'm0.5', 'a number')
    """
    if powers == PURE:
        return "a number"
    named = [name for name, known in UNITS.items() if known == powers]
    parts = [
        f"{unit}{power:g}" if power != 1 else unit
        for unit, power in zip(("kg", "m", "s"), powers, strict=True)
        if power
    ]
    return named[0] if named else " ".join(parts)


def check_units(where: KeyPath, units: Any) -> str:
    """Return the units of a quantity or an input, or refuse what files cannot state.

    Examples
    --------
    >>> check_units(("units",), "N m")
    'N m'
    >>> check_units(("units",), "m/s")
    Traceback (most recent call last):
    fastlink.errors.InputError: units is 'm/s'; write 'm s-1'
    """
    text = " ".join(units.split()) if isinstance(units, str) else ""
    found = [re.fullmatch(r"([A-Za-z]+|1)(-?\d*)", one) for one in text.split()]
    if found and all(one is not None and one[1] in UNITS for one in found):
        return text
    meant = OTHERS.get(units.strip()) if isinstance(units, str) else None
    known = f"of {', '.join(UNITS)} with whole powers, such as 'kg m2 s-2' or 'rad s-1'"
    remedy = f"write {meant!r}" if meant else f"write a product {known}"
    raise InputError(f"is {short_repr(units)}", where=where, remedy=remedy)


def dimension_of_text(function: Callable[..., Any], units: Mapping[str, str]) -> tuple[float, ...]:
    """Return the dimension of what a function of facts returns, for parameters of these units.

    Raises
    ------
    WrongDimension
        With what it does to unlike dimensions.
    """
    given = [Dimension(tuple(map(float, dimensions(unit)))) for unit in units.values()]
    return _powers(function(*given))

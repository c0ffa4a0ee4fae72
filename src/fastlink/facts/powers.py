"""Numbers that have no value, only powers: of kilogram, metre and second, or of an input that scales results.

Facts, and texts of users, run on them as on doubles. Unlike powers are neither added nor compared: a text that does so
means something else in other units, and its value does not grow as a power of the input.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import lru_cache
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from fastlink.facts.expression import Condition, Valueless

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from fastlink.facts.fact import Input


#: Powers of kilogram, metre and second.
UNITS: dict[str, tuple[int, int, int]] = {
    "kg": (1, 0, 0), "m": (0, 1, 0), "s": (0, 0, 1), "rad": (0, 0, 0), "1": (0, 0, 0),
    "N": (1, 1, -2), "J": (1, 2, -2), "W": (1, 2, -3),
}  # fmt: skip
#: A unit of an input is multiplied by numbers within 2^-RANGE and 2^RANGE. The steps of all facts are products of at
#: most eight of them, and stay far within 2^-1022 and 2^1023.
RANGE = 80


class UnlikePowers(Exception):
    """Unlike powers meet; the arguments are a sentence with gaps and the powers that fill them."""

    def __str__(self) -> str:
        return str(self.args[0]).format(*map(units_text, self.args[1:]))


@dataclass(frozen=True, eq=False)
class Powers(Valueless):
    """A number of which only the powers are known; without any, that of a pure number."""

    powers: tuple[float, ...] = ()

    @classmethod
    def of_units(cls, units: str) -> Self:
        """Return a number of some units."""
        return cls(tuple(map(float, dimensions(units))))

    def like(self, other: Any, doing: str) -> Powers:
        """Return a sum or choice of both; zero and NaN have any powers."""
        if not isinstance(other, Powers) and (other == 0.0 or other != other):
            return self
        if any(self.times(other, -1).powers):
            pure = (0.0,) * len(self.powers)
            raise UnlikePowers(f"{doing} {{}} and {{}}", self.powers, self.of(other).powers or pure)
        return self

    def plus(self, other: Any) -> Powers:
        """Return a sum."""
        return self.like(other, "adds")

    def times(self, other: Any, power: int) -> Powers:
        """Return the product with a power of another number."""
        pairs = zip_longest(self.powers, self.of(other).powers, fillvalue=0.0)
        return Powers(tuple(x + power * y for x, y in pairs))

    def compared(self, other: Any) -> Condition:
        """Return the result of a comparison: the same in any units."""
        if isinstance(other, Powers) or abs(other) != math.inf:  # infinities are beyond any power
            self.like(other, "compares")
        return Condition(self.either)

    @staticmethod
    def either(if_true: Any, if_false: Any) -> Any:
        """Return the powers of both values of `fastlink.numerics.elementary.select`."""
        if isinstance(if_true, Powers):
            return if_true.like(if_false, "chooses between")
        if not isinstance(if_false, Powers):
            return if_true if if_true != 0.0 else if_false
        if if_true == 0.0 or if_true != if_true:
            return if_false
        return (if_false.times(if_false, -1)).like(if_false, "chooses between")

    def sqrt(self) -> Powers:
        """Return the square root."""
        return Powers(tuple(0.5 * power for power in self.powers))

    @staticmethod
    def atan2(y: Any, x: Any) -> Powers:
        """Return the angle of a vector."""
        pure: Powers = y.times(y, -1) if isinstance(y, Powers) else x.times(x, -1)
        (y if isinstance(y, Powers) else pure).like(x, "takes the angle of")
        return pure

    @staticmethod
    def sign(x: Any) -> float:
        """Return a sign."""
        return 1.0

    def pure(self) -> Powers:
        """Return a function of a number without units."""
        if any(self.powers):
            raise UnlikePowers("takes a function of {}, not of a number without units", self.powers)
        return self

    log = log1p = cos = sin = exp = pure


def units_text(powers: tuple[float, ...]) -> str:
    """Return powers of kilogram, metre and second as units.

    Examples
    --------
    >>> units_text((1.0, 1.0, -2.0)), units_text((0.0, 0.5, 0.0)), units_text((0.0, 0.0, 0.0))
    ('N', 'm0.5', 'a number')
    """
    if not any(powers):
        return "a number"
    named = [name for name, known in UNITS.items() if known == powers]
    parts = [
        f"{unit}{power:g}" if power != 1 else unit
        for unit, power in zip(("kg", "m", "s"), powers, strict=True)
        if power
    ]
    return named[0] if named else " ".join(parts)


@lru_cache(maxsize=256)
def dimensions(units: str) -> tuple[int, int, int]:
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


@lru_cache(maxsize=256)
def limits(units: str, rule: str) -> tuple[float, float]:
    """Return the numbers between which the magnitude of an input stays unless it is 0.

    A length that may be 0 may be as small as it likes: it stands beside the bars. Moments of inertia and their like
    have a lower limit for each power of a unit that is in them, and twice the exponent above.

    Examples
    --------
    >>> limits("m", "positive") == (2.0**-80, 2.0**80), limits("m", "any") == (0.0, 2.0**80), limits("rad", "any")
    (True, True, (0.0, inf))
    """
    powers = dimensions(units)
    if not any(powers):
        return 0.0, math.inf
    may_vanish = powers == UNITS["m"] and rule != "positive"
    most = 2.0 ** (RANGE * (2 if powers[0] * powers[1] > 0 else 1))
    return 0.0 if may_vanish else 2.0 ** (-RANGE * sum(map(abs, powers))), most


def beyond_range(declared: Input, values: Any) -> Any:
    """Tell for one or several values of an input whether they are beyond its limits; NaN and infinities are not."""
    least, most = limits(declared.units, declared.rule)
    if most == math.inf:
        return False
    sizes = abs(values)
    return ((sizes <= least) | (sizes >= most)) & (sizes > 0.0) & (sizes < math.inf)


def any_beyond_range(declared: Mapping[str, Input], inputs: Mapping[str, Any]) -> NDArray[np.bool_]:
    """Tell for designs whether one of their inputs is beyond its limits."""
    found = np.zeros((), dtype=bool)
    for name, values in inputs.items():
        if name in declared:
            found = found | beyond_range(declared[name], values)
    return found

"""Find the inputs that only scale results, from the facts.

The facts run on `Homogeneity` numbers, which have no value, only the power of one input by which they grow: rates
grow as omega1, forces as its square or as the density, positions not at all. Values that depend on a sum of unlike
powers, or on a comparison with anything but zero, are not homogeneous.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from fastlink.facts.expression import Condition
from fastlink.facts.fact import Fact, System

__all__ = ["homogeneity_degrees"]


class _NotHomogeneous(Exception):
    """Unlike powers are added or compared."""


@dataclass(frozen=True, eq=False)
class Homogeneity:
    """A number of which only the power of a positive factor is known."""

    power: float

    @property
    def context(self) -> _Functions:
        """The functions of `fastlink.numerics.elementary` for such numbers."""
        return _Functions()

    def _sum(self, other: Any) -> Homogeneity:
        if isinstance(other, float) and (other == 0.0 or other != other):
            return self
        if _power(other) != self.power:
            raise _NotHomogeneous
        return self

    __add__ = __radd__ = __sub__ = __rsub__ = _sum

    def __mul__(self, other: Any) -> Any:
        return 0.0 if isinstance(other, float) and other == 0.0 else Homogeneity(self.power + _power(other))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Homogeneity:
        return Homogeneity(self.power - _power(other))

    def __rtruediv__(self, other: Any) -> Any:
        return 0.0 if isinstance(other, float) and other == 0.0 else Homogeneity(_power(other) - self.power)

    def __neg__(self) -> Homogeneity:
        return self

    __abs__ = __neg__

    def _compared(self, other: Any) -> _Condition:
        # signs and ratios stay; infinities are beyond any power
        if isinstance(other, Homogeneity) or other not in (0, float("inf"), float("-inf")):
            self._sum(other)
        return _Condition()

    __lt__ = __le__ = __gt__ = __ge__ = __eq__ = __ne__ = _compared  # type: ignore[assignment]
    __hash__ = None  # type: ignore[assignment]


class _Condition(Condition):
    """The result of a comparison: the same for any positive factor."""

    def choose(self, if_true: Any, if_false: Any) -> Any:
        """Return the power of both values of `fastlink.numerics.elementary.select`."""
        if isinstance(if_true, Homogeneity):
            return if_true + if_false
        return if_false + if_true if isinstance(if_false, Homogeneity) else Homogeneity(0.0)


class _Functions:
    """Elementary functions of such numbers."""

    nan = float("nan")

    def sqrt(self, x: Homogeneity) -> Homogeneity:
        return Homogeneity(0.5 * x.power)

    def atan2(self, y: Any, x: Any) -> Homogeneity:
        if _power(y) != _power(x):
            raise _NotHomogeneous
        return Homogeneity(0.0)

    def _of_ratio(self, x: Homogeneity) -> Homogeneity:
        if x.power:
            raise _NotHomogeneous
        return x

    log = cos = sin = exp = _of_ratio


def _power(value: Any) -> float:
    return value.power if isinstance(value, Homogeneity) else 0.0


def homogeneity_degrees(steps: Iterable[Fact | System], name: str) -> dict[str, float | None]:
    """Return the power of an input by which each value grows, or None.

    Examples
    --------
    >>> from fastlink.mechanisms import catalogue
    >>> planar = catalogue("planar_4r")
    >>> leaves = (*planar.inputs, *planar.tables, *planar.table_low_parts, "branch")
    >>> powers = homogeneity_degrees(planar.dependencies(["omega4", "alpha4", "theta4"], leaves), "omega1")
    >>> [powers[quantity] for quantity in ("omega4", "alpha4", "theta4")]
    [1.0, 2.0, 0.0]
    """
    degrees: dict[str, Any] = {name: Homogeneity(1.0)}
    for step in steps:
        known = [degrees.get(part, Homogeneity(0.0)) for part in step.depends_on]
        degrees |= zip(step.names, _degrees(step, known), strict=True)
    return {of: value if value is None else _power(value) for of, value in degrees.items()}


def _degrees(step: Fact | System, known: Sequence[Any]) -> Sequence[Any]:
    """Return the degrees of the values of a step."""
    unknown = [None] * len(step.names)
    if any(value is None for value in known):
        return unknown
    if all(_power(value) == 0.0 for value in known):
        return [Homogeneity(0.0)] * len(step.names)
    if isinstance(step, System):
        return unknown
    try:
        value = step.function(*known)
    except (_NotHomogeneous, TypeError, AttributeError):
        return unknown
    return [value] if step.low is None else value

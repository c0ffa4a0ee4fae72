"""Find how quantities grow at a toggle, and how they behave under the mirror, from their facts.

The facts run on `Asymptotics` numbers, which have no value, only the power of 1/sigma by which a value grows where
sigma vanishes, and whether it changes sign when sides and branches are exchanged.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextvars import ContextVar
from dataclasses import dataclass, replace
from typing import Any

from fastlink.facts.expression import Condition, Valueless
from fastlink.facts.fact import Fact, GradedRange, System

#: Whether values may be compared: in facts of users, whose text may do more than to choose.
_COMPARES: ContextVar[bool] = ContextVar("compares", default=False)


@dataclass(frozen=True, eq=False)
class Asymptotics(Valueless):
    """A number without a value, of which growth and symmetry are known."""

    #: The power of 1/sigma that bounds its growth at a toggle.
    order: float = 0.0
    #: 1 if the mirror preserves it, -1 if it changes its sign, else 0.
    parity: int = 1
    #: Whether a comparison of values selects it, so that it may jump.
    choice: bool = False
    #: The power that bounds the growth of its reciprocal, where that is another one than of what vanishes as it grows.
    of_reciprocal: float | None = None

    @property
    def reciprocal(self) -> float:
        """The power of 1/sigma that bounds the growth of its reciprocal."""
        return -self.order if self.of_reciprocal is None else self.of_reciprocal

    def plus(self, other: Any) -> Asymptotics:
        """Return a sum."""
        return self if isinstance(other, float) and other == 0.0 else self.with_other(other)

    def with_other(self, other: Any, jumps: bool = False) -> Asymptotics:
        """Return what is known of a value that grows as both of two at most."""
        known = self.of(other)
        parity = self.parity if self.parity == known.parity else 0
        return Asymptotics(max(self.order, known.order), parity, jumps or self.choice or known.choice)

    def times(self, other: Any, power: int) -> Asymptotics:
        """Return the product with a power of another number."""
        known = self.of(other)
        grows, shrinks = (known.order, known.reciprocal)[::power]
        order, reciprocal = self.order + grows, self.reciprocal + shrinks
        return Asymptotics(order, self.parity * known.parity, self.choice or known.choice, reciprocal)

    def __abs__(self) -> Asymptotics:
        return Asymptotics(self.order, abs(self.parity), self.choice)

    def __ge__(self, other: Any) -> Any:
        # `fastlink.numerics.elementary.sqrt` tests the sign of its argument.
        return True if not isinstance(other, Asymptotics) and other == 0 else self.compared(other)

    def compared(self, other: Any) -> Condition:
        """Return the result of a comparison, by which either value may be chosen.

        Of values that the mirror changes it is another one there: the greater of two negatives is the lesser.
        """
        if not _COMPARES.get():
            raise TypeError("asymptotics have no value to compare")
        same = other is self or (self.parity == 1 == self.of(other).parity)
        return Condition(self.either if same else self.of_no_parity, rank=int(same))

    @classmethod
    def of_no_parity(cls, if_true: Any, if_false: Any) -> Asymptotics:
        """Return what is known of both values where the mirror may choose the other one."""
        return replace(cls.either(if_true, if_false), parity=0)

    @classmethod
    def either(cls, if_true: Any, if_false: Any) -> Asymptotics:
        """Return what is known of both values of `fastlink.numerics.elementary.select`."""
        first: Asymptotics = cls.of(if_true)
        if isinstance(if_false, float) and if_false != if_false:  # what is no number has no parity
            return first
        return first.with_other(if_false, jumps=True)

    def sqrt(self) -> Asymptotics:
        """Return the square root."""
        return Asymptotics(self.order / 2.0, max(self.parity, 0), self.choice, self.reciprocal / 2.0)

    def cos(self) -> Asymptotics:
        """Return the cosine."""
        return Asymptotics(0.0, abs(self.parity), self.choice)

    def sin(self) -> Asymptotics:
        """Return the sine."""
        return Asymptotics(0.0, self.parity, self.choice)

    def exp(self) -> Asymptotics:
        """Return an exponential or a logarithm."""
        return Asymptotics(0.0, max(self.parity, 0), self.choice)

    log = exp

    @classmethod
    def atan2(cls, y: Any, x: Any) -> Asymptotics:
        """Return the angle of a vector."""
        above, beside = cls.of(y), cls.of(x)
        return Asymptotics(0.0, above.parity if beside.parity == 1 else 0, above.choice or beside.choice)


def asymptotics(
    graded: GradedRange, steps: Iterable[Fact | System], varying: Iterable[str], strict: bool = False
) -> dict[str, Asymptotics]:
    """Return the asymptotics of all values that steps determine.

    A strict bound of growth counts what vanishes at one end alone, and what built-in facts compare, too; a search does
    without, whose samples are divided by these powers of sigma.
    """
    orders: dict[str, Any] = {
        name: Asymptotics(0.0, -1 if name in graded.antisymmetric else 1) for name in varying
    }
    moving = set(orders)
    for step in steps:
        if isinstance(step, System):
            continue
        if moving.intersection(step.depends_on):
            moving.update(step.names)
        if step.name in graded.vanishing:
            orders[step.name] = Asymptotics(-1.0, 1)
        elif strict and step.name in graded.vanish_at_one_end:  # as sigma^2
            orders[step.name] = Asymptotics(0.0, 1, of_reciprocal=2.0)
        elif step.name in graded.antisymmetric:
            orders[step.name] = Asymptotics(0.0, -1)
        else:
            # A mass centre on its link's line is 0.0 across it, and products with 0.0 vanish.
            known = {part: orders.get(part, Asymptotics()) for part in step.depends_on}
            compares = _COMPARES.set(step.own or strict)
            try:
                orders |= step.values(known)
            except (TypeError, AttributeError):
                # It compares values: only the order of what varies is known.
                order = max((Asymptotics.of(value).order for value in known.values()), default=0.0)
                orders |= dict.fromkeys(
                    step.names, Asymptotics(order, 0, True) if step.name in moving else Asymptotics()
                )
            finally:
                _COMPARES.reset(compares)
    return {name: Asymptotics.of(value) for name, value in orders.items()}

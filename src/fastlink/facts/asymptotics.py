"""Find how quantities grow at a toggle, and how they behave under the mirror, from their facts.

The facts run on `Asymptotics` numbers, which have no value, only the power of 1/sigma by which a value grows where
sigma vanishes, and whether it changes sign when sides and branches are exchanged.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

from fastlink.facts.expression import Condition
from fastlink.facts.fact import Fact, GradedRange, System

__all__ = ["asymptotics"]


#: Whether values may be compared: in facts of users, whose text may do more than to choose.
_COMPARES: ContextVar[bool] = ContextVar("compares", default=False)


@dataclass(frozen=True, eq=False)
class Asymptotics:
    """A number without a value, of which growth and symmetry are known."""

    #: The power of 1/sigma that bounds its growth at a toggle.
    order: float = 0.0
    #: 1 if the mirror preserves it, -1 if it changes its sign, else 0.
    parity: int = 1
    #: Whether a comparison of values selects it, so that it may jump.
    choice: bool = False

    @property
    def context(self) -> _Functions:
        """The functions of `fastlink.numerics.elementary` for such numbers."""
        return _Functions()

    def _sum(self, other: Any) -> Asymptotics:
        if isinstance(other, float) and other == 0.0:
            return self
        right = _asymptotics_of(other)
        parity = self.parity if self.parity == right.parity else 0
        return Asymptotics(max(self.order, right.order), parity, self.choice or right.choice)

    def _product(self, other: Any) -> Any:
        if isinstance(other, float) and other == 0.0:
            return 0.0
        right = _asymptotics_of(other)
        return Asymptotics(self.order + right.order, self.parity * right.parity, self.choice or right.choice)

    __add__ = __radd__ = __sub__ = __rsub__ = _sum
    __mul__ = __rmul__ = _product

    def __truediv__(self, other: Any) -> Asymptotics:
        right = _asymptotics_of(other)
        return Asymptotics(self.order - right.order, self.parity * right.parity, self.choice or right.choice)

    def __rtruediv__(self, other: Any) -> Any:
        return 0.0 if isinstance(other, float) and other == 0.0 else _asymptotics_of(other) / self

    def __neg__(self) -> Asymptotics:
        return self

    def __abs__(self) -> Asymptotics:
        return Asymptotics(self.order, abs(self.parity), self.choice)

    def __ge__(self, other: Any) -> Any:
        # `fastlink.numerics.elementary.sqrt` tests the sign of its argument.
        return True if not isinstance(other, Asymptotics) and other == 0 else self._compared(other)

    def _compared(self, other: Any) -> Any:
        if not _COMPARES.get():
            raise TypeError("asymptotics have no value to compare")
        return _Condition()

    __lt__ = __le__ = __gt__ = __eq__ = __ne__ = _compared
    __hash__ = None  # type: ignore[assignment]


class _Condition(Condition):
    """The result of a comparison, by which either value may be chosen."""

    def choose(self, if_true: Any, if_false: Any) -> Asymptotics:
        """Return what is known of both values of `fastlink.numerics.elementary.select`."""
        one, other = _asymptotics_of(if_true), _asymptotics_of(if_false)
        if isinstance(if_false, float) and if_false != if_false:  # what is no number has no parity
            return one
        parity = one.parity if one.parity == other.parity else 0
        return Asymptotics(max(one.order, other.order), parity, True)


class _Functions:
    """Elementary functions of such numbers."""

    nan = Asymptotics()

    def sqrt(self, x: Asymptotics) -> Asymptotics:
        return Asymptotics(x.order / 2.0, 1 if x.parity == 1 else 0, x.choice)

    def cos(self, x: Asymptotics) -> Asymptotics:
        return Asymptotics(0.0, abs(x.parity), x.choice)

    def sin(self, x: Asymptotics) -> Asymptotics:
        return Asymptotics(0.0, x.parity, x.choice)

    def exp(self, x: Asymptotics) -> Asymptotics:
        return Asymptotics(0.0, 1 if x.parity == 1 else 0, x.choice)

    log = exp

    def atan2(self, y: Any, x: Any) -> Asymptotics:
        above, beside = _asymptotics_of(y), _asymptotics_of(x)
        return Asymptotics(0.0, above.parity if beside.parity == 1 else 0, above.choice or beside.choice)


def _asymptotics_of(value: Any) -> Asymptotics:
    return value if isinstance(value, Asymptotics) else Asymptotics()


def asymptotics(
    graded: GradedRange, steps: Iterable[Fact | System], varying: Iterable[str]
) -> dict[str, Asymptotics]:
    """Return the asymptotics of all values that steps determine."""
    orders: dict[str, Any] = {
        name: Asymptotics(0.0, -1 if name in graded.antisymmetric else 1) for name in varying
    }
    moving = set(orders)
    for step in steps:
        if isinstance(step, System):
            continue
        if moving.intersection(step.depends_on):
            moving.update(step.names)
        if step.name == graded.vanishes_at_toggle:
            orders[step.name] = Asymptotics(-1.0, 1)
        elif step.name in graded.antisymmetric:
            orders[step.name] = Asymptotics(0.0, -1)
        else:
            # A mass centre on its link's line is 0.0 across it, and products with 0.0 vanish.
            known = {part: orders.get(part, Asymptotics()) for part in step.depends_on}
            compares = _COMPARES.set(step.own)
            try:
                orders |= step.values(known)
            except (TypeError, AttributeError):
                # It compares values: only the order of what varies is known.
                order = max((_asymptotics_of(value).order for value in known.values()), default=0.0)
                orders |= dict.fromkeys(
                    step.names, Asymptotics(order, 0, True) if step.name in moving else Asymptotics()
                )
            finally:
                _COMPARES.reset(compares)
    return {name: _asymptotics_of(value) for name, value in orders.items()}

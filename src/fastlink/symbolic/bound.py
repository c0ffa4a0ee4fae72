"""The error bound of one value: a relative part known beforehand, an expression, and low words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from fastlink.symbolic.expression import Node

__all__ = ["Bound", "Lost", "multiplied", "united"]

#: What rounding lost and another value keeps (the low word of a sum of two): a multiple of that value is the error,
#: with its sign, and cancels where both words meet. With it stands the high word, of which it is a rounding at most.
Lost = Mapping[Node, tuple[float, Node]]


@dataclass(frozen=True)
class Bound:
    """An error bound: u `relative` |value| + `rest`, besides what is `lost`.

    Here u is UNIT_WITH_MARGIN. `scale` tells that the value is 0 or a power of two, up to its sign, with which products
    are exact; `one` that it is 1, up to its sign (or NaN); `positive` that it is not negative; `gap` that a gap is in
    it, which may have been set to zero: its sign may be wrong.
    """

    relative: float
    rest: Node
    lost: Lost = field(default_factory=dict)
    scale: bool = False
    one: bool = False
    positive: bool = False
    gap: bool = False


def multiplied(lost: Lost, number: float) -> Lost:
    """Return a multiple of the lost low words."""
    return {low: (number * times, high) for low, (times, high) in lost.items()}


def united(first: Lost, second: Lost) -> Lost:
    """Return what two values lose together; a low word with both signs cancels."""
    sums = dict(first)
    for low, (times, high) in second.items():
        sums[low] = (times + (sums[low][0] if low in sums else 0.0), high)
    return {low: entry for low, entry in sums.items() if entry[0] != 0.0}

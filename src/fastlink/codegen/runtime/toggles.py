"""Signs of the sampled function at toggles at which it vanishes.

What is finite at a toggle may have a slope that is a small difference of great numbers there: within 2^-26 of the scale
its sign is nothing but rounding, and a wrong one at the last sample hides the extreme that follows. The value at a
little distance stands for that at the toggle. Arrays are as in `sampling`.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import (
    CELLS,
    FIRST,
    HALVES,
    LANE,
    START,
    TOGGLE,
    XA,
    XC,
    F,
    X,
    append_item,
    padded,
    set_bracket,
)
from fastlink.numerics.compiler import lanes, outlined

__all__ = ["collect_toggles", "place_toggles", "settle_toggles"]

# The function at a toggle over that at the next sample, below which it vanishes there.
SMALL = 2.0**-10
# At 2^-22 of the scale, so many times the distance of the last sample, an error of the slope's terms of one rounding is
# a thousandth of it; an extreme nearer than that is as great as the quantity at the toggle but for 2^-44 of its bend.
AWAY = 2.0**38


@outlined
def collect_toggles(w: Any, table: Any, part: Any, samples: Any, count: int, items: Any) -> int:
    """Make items of the ends at toggles where the function vanishes; return how many there are.

    The parameters are those of `octaves.collect_folds`; `XC` of an item is the row of its sample.
    """
    total, cells = 0, part[CELLS]
    for upper in range(2):
        start, toggle, position = table[START] + upper, table[TOGGLE] + upper, upper * (cells + 1)
        for half in range(table[HALVES]):
            first = part[FIRST] + half * (2 * cells + 1)
            end, inner = first + upper * 2 * cells, first + 1 + upper * (2 * cells - 2)
            for i in range(count):
                f, after = samples[end, i], samples[inner, i]
                is_toggle = (w[start, i] != 0.0) & (w[toggle, i] != 0.0)
                if is_toggle & (abs(f) <= SMALL * abs(after)):
                    set_bracket(items, total, samples[position, i], f, samples[position + 1, i], after)
                    items[XC, total] = end
                    total = append_item(items, total, i, half, upper == 1)
    return total


@outlined
def place_toggles(s: Any, count: int) -> None:
    """Put items where the sign is certain."""
    for i in lanes(padded(count)):
        s[X, i] = AWAY * s[XA, i]


@outlined
def settle_toggles(s: Any, count: int, samples: Any) -> None:
    """Give the samples at toggles the values beside them; 0 would be taken for the zero that is sought."""
    for i in range(count):
        row, lane, f = int(s[XC, i]), int(s[LANE, i]), s[F, i]
        if (f < 0.0) | (f > 0.0):
            samples[row, lane] = f

"""Signs of the sampled function at toggles at which it vanishes.

What is finite at a toggle may have a slope that is a small difference of great numbers there: within 2^-26 of the scale
its sign is nothing but rounding, and a wrong one at the last sample hides the extreme that follows. The value at a
little distance stands for that at the toggle. Where both signs are certain there is an extreme between that is not
looked for: it is in the error bounds of the greatest and least values. Arrays are as in `sampling`.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.bounds import is_certain
from fastlink.codegen.runtime.cells import (
    BOUND,
    CELLS,
    FA,
    FB,
    FIRST,
    HALVES,
    LANE,
    SLOPE,
    SLOPE_BOUND,
    START,
    TOGGLE,
    UPPER,
    VALUE,
    XC,
    F,
    X,
    append_item,
    padded,
    set_bracket,
)
from fastlink.numerics.compiler import lanes, outlined

__all__ = [
    *("bound_hidden", "collect_toggles", "count_turned", "keep_away", "keep_near", "keep_turned"),
    *("place_near", "settle_toggles"),
]

# The function at a toggle over that at the next sample, below which it vanishes there.
SMALL = 2.0**-10
# At 2^-22 of the scale, so many times the distance of the last sample, an error of the slope's terms of one rounding is
# a thousandth of it; an extreme nearer than that is as great as the quantity at the toggle but for 2^-44 of its bend.
AWAY = 2.0**38
# A function at a toggle over that away from it, below which it may be rounding: at most 2^4 roundings of its terms. The
# zero that a greater one shows is beyond 2^-28 of the scale.
ROUNDED = 2.0**-6
# An extreme within a distance is off by less than what the quantity changes within so many times that: one of its
# square by an eighth, the kink of a magnitude that is linear in the square by a fourteenth.
BEYOND = 4.0
# While that is found, of the items of ends: the function at the first sample, then the quantity away from it; whether
# an extreme is between.
NEAR, HIDES = FA, FB


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
def settle_toggles(s: Any, count: int, samples: Any) -> None:
    """Give the samples at toggles the values beside them; 0 would be taken for the zero that is sought."""
    for i in range(count):
        row, lane, f = int(s[XC, i]), int(s[LANE, i]), s[F, i]
        if ((f < 0.0) | (f > 0.0)) & (abs(s[FA, i]) <= ROUNDED * abs(f)):
            samples[row, lane] = f


@outlined
def place_near(s: Any, count: int, w: Any, table: Any, times: float) -> None:
    """Put items of ends at so many times the distance of the first sample."""
    for i in range(count):
        s[X, i] = times * abs(w[table[START] + int(s[UPPER, i]), int(s[LANE, i])])


@outlined
def keep_near(s: Any, count: int) -> None:
    """Keep the function at the first sample."""
    for i in lanes(padded(count)):
        s[NEAR, i] = s[F, i]


@outlined
def count_turned(s: Any, count: int, w: Any, table: Any) -> int:
    """Mark the toggles where the function has another sign at the first sample than away from it; return their number.

    Parameters
    ----------
    s, count : array, int
        State of items of ends, and how many they are.
    w, table : array
        Lane values, and the table of the kernel, see `cells`.
    """
    total = 0
    for i in range(count):
        is_toggle = w[table[TOGGLE] + int(s[UPPER, i]), int(s[LANE, i])] != 0.0
        turned = is_toggle & (((s[NEAR, i] < 0.0) & (s[F, i] > 0.0)) | ((s[NEAR, i] > 0.0) & (s[F, i] < 0.0)))
        s[HIDES, i] = 1.0 if turned else 0.0
        total = total + 1 if turned else total
    return total


@outlined
def keep_away(s: Any, count: int) -> None:
    """Keep the quantity away from the first sample."""
    for i in lanes(padded(count)):
        s[NEAR, i] = s[VALUE, i]


@outlined
def keep_turned(s: Any, count: int) -> None:
    """Leave the marks where the slope at the first sample is certain: else its sign may be rounding."""
    for i in lanes(padded(count)):
        s[HIDES, i] = s[HIDES, i] if is_certain(s[SLOPE, i], s[SLOPE_BOUND, i]) else 0.0


@outlined
def bound_hidden(s: Any, count: int) -> None:
    """Add to the bounds of values at toggles how far an extreme beside is from them."""
    for i in lanes(padded(count)):
        s[BOUND, i] = s[BOUND, i] + abs(s[VALUE, i] - s[NEAR, i]) if s[HIDES, i] > 0.0 else s[BOUND, i]

"""Entries of the lists that are nothing but rounding, next to folds.

At a fold a quantity may be a small difference of great numbers: its slope changes its sign with every last bit, and
each change looks like an extreme. What rounding does to the value there is measured: it is evaluated at positions
beside, which differ by so little that an extreme would not change in its last digits. A maximum and the minimum next to
it whose values differ by less than rounding does to each of them are no extremes, and leave the list together; the
nearest values first. So of an odd number of such entries one is left, the greatest or the least of them; and where
there are more than the lists have room for, all stay. The greatest and the least of all stay, too: they are within the
bounds of their values.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import (
    HIGHEST,
    LANE,
    LOWEST,
    NOISE,
    SAVED,
    START,
    TOGGLE,
    UPPER,
    VALUE,
    X,
    padded,
)
from fastlink.codegen.runtime.results import (
    COUNT,
    GREATEST,
    LEAST,
    LIST_KIND,
    LIST_NOISE,
    LIST_THETA,
    LIST_VALUE,
)
from fastlink.numerics.compiler import lanes, outlined
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER

__all__ = ["TRIALS", "count_folded", "keep_beside_fold", "place_beside_fold", "settle_noise", "thin"]

#: Positions are moved by 2^-20 of themselves, then 2^-28, 2^-36, 2^-44; rounding is at most so many times as great as
#: these show.
TRIALS, FIRST_STEP, NEXT_STEP, MARGIN = 4, 2.0**-20, 2.0**-8, 8.0
# How near a fold, in x, rounding is measured: farther away quantities are no small differences of great numbers.
NEAR = 2.0**-10


@outlined
def count_folded(s: Any, count: int, w: Any, table: Any) -> int:
    """Return how many items are near a fold; mark these, and keep their positions."""
    near = 0
    for i in range(count):
        lane, upper = int(s[LANE, i]), int(s[UPPER, i])
        fold = (w[table[START] + upper, lane] != 0.0) & (w[table[TOGGLE] + upper, lane] == 0.0)
        s[SAVED, i] = s[X, i]
        s[NOISE, i] = 0.0
        s[LOWEST, i] = INFINITY
        s[HIGHEST, i] = -INFINITY
        if fold & (abs(s[X, i]) < NEAR):
            s[NOISE, i] = 1.0
            near = near + 1
    return near


@outlined
def place_beside_fold(s: Any, count: int, trial: int) -> None:
    """Put items near a fold beside their positions."""
    step = FIRST_STEP
    for _ in range(trial):
        step = NEXT_STEP * step
    for i in lanes(padded(count)):
        s[X, i] = s[SAVED, i] * (1.0 + step) if s[NOISE, i] > 0.0 else s[SAVED, i]


@outlined
def keep_beside_fold(s: Any, count: int) -> None:
    """Keep the least and the greatest of the values beside; put items back."""
    for i in lanes(padded(count)):
        value = s[VALUE, i]
        s[LOWEST, i] = value if value < s[LOWEST, i] else s[LOWEST, i]
        s[HIGHEST, i] = value if value > s[HIGHEST, i] else s[HIGHEST, i]
        s[X, i] = s[SAVED, i]


@outlined
def settle_noise(s: Any, count: int) -> None:
    """Make what rounding does to values of what was seen beside them; 0 far from folds."""
    for i in lanes(padded(count)):
        value = s[VALUE, i]
        above, below = s[HIGHEST, i] - value, value - s[LOWEST, i]
        s[NOISE, i] = MARGIN * (above if above > below else below) if s[NOISE, i] > 0.0 else 0.0


@outlined
def thin(lists: Any, best: Any, kept: int) -> None:
    """Take pairs of extremes out of the lists that differ by rounding alone.

    Parameters
    ----------
    lists, best : array
        The results, see `store_extrema`.
    kept : int
        How many entries are returned.
    """
    for column in range(lists.shape[1]):
        n, noise = int(best[COUNT, column]), 0.0
        for k in range(min(n, lists.shape[2])):
            noise = noise + lists[LIST_NOISE, column, k]
        if noise == 0.0 or n > lists.shape[2]:
            continue
        pair = 0
        while pair >= 0:
            pair, least = -1, INFINITY
            for k in range(n - 1):
                value, after = lists[LIST_VALUE, column, k], lists[LIST_VALUE, column, k + 1]
                low, high = min(value, after), max(value, after)
                turns = lists[LIST_KIND, column, k] != lists[LIST_KIND, column, k + 1]
                one, other = lists[LIST_NOISE, column, k], lists[LIST_NOISE, column, k + 1]
                inner = (high < best[GREATEST, column]) & (low > best[LEAST, column])
                if turns & inner & (high - low <= min(one, other)) & (high - low < least):
                    pair, least = k, high - low
            if pair >= 0:
                n = n - 2
                best[COUNT, column] -= 2.0
                for k in range(pair, n):
                    for r in range(lists.shape[0]):
                        lists[r, column, k] = lists[r, column, k + 2]
        for k in range(n, kept):
            lists[LIST_THETA, column, k] = NOT_A_NUMBER
            for r in range(LIST_VALUE, lists.shape[0]):
                lists[r, column, k] = 0.0 if r == LIST_KIND else NOT_A_NUMBER

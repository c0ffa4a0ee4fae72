"""Places where the slope of a quantity jumps or has a kink, at which cells are split.

A load by the square of a rate changes its sign with the rate: the slope is a V there, which may dip below zero within a
millionth of a cell. Neither the samples nor a parabola through them tell of it, and a search for the least magnitude
ends above it. The function on both sides of the place itself tells: between such places it is smooth. Arrays are as in
`sampling`.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import (
    CELLS,
    FA,
    FB,
    FC,
    FIRST,
    HALF,
    ITEM_ROWS,
    LANE,
    LANES,
    PART,
    ROOTS,
    UPPER,
    XA,
    XB,
    XC,
    F,
    X,
    append_item,
    append_of_lane,
    padded,
    set_bracket,
)
from fastlink.codegen.runtime.sampling import UNRESOLVED_CELL, position_of
from fastlink.numerics.compiler import lanes, merged, outlined
from fastlink.numerics.elementary import NOT_A_NUMBER

__all__ = [
    *("MOST_SPLITS", "NEXT", "PASSED", "SPLIT_ROWS"),
    *("collect_jumps", "forget_slopes", "forget_splits", "keep_slopes", "keep_splits", "mark_splits"),
    *("next_split", "place_split"),
]

#: How many places of one design are kept; a rate is zero twice in a half of the range at most.
MOST_SPLITS = 32
# Both sides of a place, over it less 1: the least that none of both roundings takes away.
ASIDE = 2.0**-50
# The first columns are no places: in two rows they tell the last place of each lane, 0 where there is none, and the
# first of them where the next one goes.
LAST, NEXT = LANE, HALF
# One row more tells whether a divided cell is split at a place: at one of two that are almost one.
PASSED = ITEM_ROWS
SPLIT_ROWS = PASSED + 1


@outlined
def forget_splits(splits: Any) -> None:
    """Begin anew: no places, of no lane."""
    splits[NEXT, 0] = LANES
    for i in lanes(LANES):
        splits[LAST, i] = 0.0


@outlined
def keep_splits(s: Any, count: int, samples: Any, part: Any, splits: Any, number: int) -> None:
    """Keep the zeros at items, found by the search of this number, as far as their designs have room for them.

    Parameters
    ----------
    s, count : array, int
        State of the items, and how many they are.
    samples, part
        As for `mark_splits`.
    splits : array (rows of an item, items)
        The places, behind `LANES` columns that tell the last one of each lane: `XA` and `XB` are both sides, `FA` and
        `FB` the function there, NaN where it has no kink; `XC` is the number of the search, and `FC` the place of the
        same lane that was kept before, 0 if none was.
    number : int
        The number of the search.
    """
    for i in range(count):
        x, lane, upper, own = s[X, i], int(s[LANE, i]), s[UPPER, i] > 0.0, 0
        if not (x > 0.0):
            continue
        if (not upper) & (x > position_of(samples, part[CELLS], part[CELLS], False, lane)):
            x = 1.0 / x  # of a valley about the middle
            upper = True
        k = int(splits[LAST, lane])
        while k > 0:
            own = own + (1 if splits[XC, k] == number else 0)
            k = int(splits[FC, k])
        if own < MOST_SPLITS:
            n = int(splits[NEXT, 0])
            set_bracket(splits, n, x * (1.0 - ASIDE), NOT_A_NUMBER, x * (1.0 + ASIDE), NOT_A_NUMBER)
            splits[XC, n] = number
            splits[FC, n] = splits[LAST, lane]
            splits[LAST, lane] = n
            splits[NEXT, 0] = append_item(splits, n, lane, int(s[HALF, i]), upper)


@outlined
def forget_slopes(splits: Any) -> None:
    """Begin with a function that has kinks nowhere."""
    for n in range(LANES, int(splits[NEXT, 0])):
        splits[FA, n] = NOT_A_NUMBER


@outlined
def place_split(s: Any, count: int, after: int) -> None:
    """Put items at one side of their places."""
    for i in lanes(padded(count)):
        s[X, i] = s[XB, i] if after > 0 else s[XA, i]


@outlined
def keep_slopes(s: Any, count: int, after: int, splits: Any, start: int, split_by: Any) -> None:
    """Keep the function at one side of the places, of which the items are those from `start` on.

    It has kinks at those alone that were found by searches whose numbers are in `split_by`.
    """
    row = FB if after > 0 else FA
    for i in range(count):
        own = 0
        for k in range(split_by.size):
            own = 1 if s[XC, i] == split_by[k] else own
        splits[row, start + i] = s[F, i] if own > 0 else NOT_A_NUMBER
        splits[PASSED, start + i] = 0.0


@merged
def _is_between(splits: Any, n: int, a: float, b: float) -> Any:
    """Tell whether both sides of a place with a kink are strictly between two positions."""
    low, high = (a if a < b else b), (b if a < b else a)
    return (low < splits[XA, n]) & (splits[XB, n] < high) & (splits[FA, n] == splits[FA, n])


@outlined
def next_split(splits: Any, lane: int, half: int, upper: bool, a: float, b: float) -> int:
    """Return which place is the next one on the way from one position to another, 0 where none is between."""
    found, n = 0, int(splits[LAST, lane])
    while n > 0:
        own = (splits[HALF, n] == half) & ((splits[UPPER, n] > 0.0) == upper)
        if own & _is_between(splits, n, a, b):
            best = n if found == 0 else found
            nearer = splits[XA, n] < splits[XA, best] if a < b else splits[XB, n] > splits[XB, best]
            found = n if nearer else best
        n = int(splits[FC, n])
    return found


@outlined
def _changes(splits: Any, n: int, a: float, fa: float, b: float, fb: float) -> int:
    """Return how often the signs change from one position to another, at the places between them, of which n is one."""
    lane, half, upper = int(splits[LANE, n]), int(splits[HALF, n]), splits[UPPER, n] > 0.0
    near, far = (FA if a < b else FB), (FB if a < b else FA)
    at, above, found = a, fa > 0.0, 0
    k = next_split(splits, lane, half, upper, at, b)
    while k > 0:
        found = found + (1 if (splits[near, k] > 0.0) != above else 0)
        found = found + (1 if (splits[near, k] > 0.0) != (splits[far, k] > 0.0) else 0)
        at, above = (splits[XB, k] if a < b else splits[XA, k]), splits[far, k] > 0.0
        k = next_split(splits, lane, half, upper, at, b)
    return found + (1 if (fb > 0.0) != above else 0)


@outlined
def mark_splits(samples: Any, marks: Any, part: Any, splits: Any) -> None:
    """Mark the samples that begin a cell of one half of the range in which such places show more zeros than its ends.

    Parameters
    ----------
    samples, marks : array (rows, lanes)
        Positions and the function's values there, and the marks of these.
    part : array of int
        Table of the half, see `cells`.
    splits : array (rows of an item, items)
        As for `keep_splits`.
    """
    cells = part[CELLS]
    for n in range(LANES, int(splits[NEXT, 0])):
        if int(splits[HALF, n]) == part[PART]:
            lane, upper = int(splits[LANE, n]), splits[UPPER, n] > 0.0
            j, width = (cells if upper else 0), cells
            while width > 1:
                width = width >> 1
                beyond = position_of(samples, cells, j + width, upper, lane)
                before = beyond > splits[XA, n] if upper else beyond < splits[XA, n]
                j = j + width if before else j
            a = position_of(samples, cells, j, upper, lane)
            b = position_of(samples, cells, j + 1, upper, lane)
            at = part[FIRST] + j
            fa, fb = samples[at, lane], samples[at + 1, lane]
            silenced = fa != fa
            if _is_between(splits, n, a, b) & (not silenced):
                hidden = _changes(splits, n, a, fa, b, fb) > 1
                marks[at, lane] = marks[at, lane] | (UNRESOLVED_CELL if hidden else 0)


@outlined
def collect_jumps(part: Any, splits: Any, counts: Any, roots: Any) -> None:
    """Make roots of the places in divided cells of one half of the range where the function jumps over zero.

    Parameters
    ----------
    part, splits
        As for `mark_splits`, once the parts of divided cells are items.
    counts, roots : array
        How many items of each kind there are, and the roots.
    """
    for n in range(LANES, int(splits[NEXT, 0])):
        f, g, upper = splits[FA, n], splits[FB, n], splits[UPPER, n] > 0.0
        if (splits[PASSED, n] > 0.0) & (splits[HALF, n] == part[PART]) & ((f > 0.0) != (g > 0.0)):
            if upper:
                set_bracket(roots, counts[ROOTS], splits[XB, n], g, splits[XA, n], f)
            else:
                set_bracket(roots, counts[ROOTS], splits[XA, n], f, splits[XB, n], g)
            append_of_lane(roots, counts, ROOTS, int(splits[LANE, n]), part[PART], upper)

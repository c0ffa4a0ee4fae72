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
    COUNTS,
    FA,
    FB,
    FC,
    FIRST,
    HALF,
    LANE,
    LAST_SPLIT,
    PART,
    SPLITS,
    UPPER,
    XA,
    XB,
    XC,
    F,
    X,
    append_item,
    padded,
    set_bracket,
)
from fastlink.codegen.runtime.sampling import UNRESOLVED_CELL, position_of
from fastlink.numerics.compiler import lanes, merged, outlined

__all__ = [
    "MOST_SPLITS",
    "forget_splits",
    "keep_slopes",
    "keep_splits",
    "mark_splits",
    "next_split",
    "place_split",
]

#: How many places of one design are kept; a rate is zero twice in a half of the range at most.
MOST_SPLITS = 32
# Both sides of a place, over it less 1: the least that none of both roundings takes away.
ASIDE = 2.0**-50


@outlined
def forget_splits(counts: Any) -> None:
    """Begin anew: no places, of no lane."""
    for k in range(SPLITS, COUNTS):
        counts[k] = 0


@outlined
def keep_splits(s: Any, count: int, samples: Any, part: Any, splits: Any, counts: Any, number: int) -> None:
    """Keep the zeros at items, found by the search of this number, as far as their designs have room for them.

    Parameters
    ----------
    s, count : array, int
        State of the items, and how many they are.
    samples, part
        As for `mark_splits`.
    splits : array (rows of an item, items)
        The places: `XA` and `XB` are both sides, `FA` and `FB` the function there, `XC` is the number of the search,
        `FC` the place of the same lane that was kept before, as `LAST_SPLIT` counts them.
    counts : array of int
        How many designs there are, and how many items of each kind.
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
        k = counts[LAST_SPLIT + lane] - 1
        while k >= 0:
            own = own + (1 if splits[XC, k] == number else 0)
            k = int(splits[FC, k]) - 1
        if own < MOST_SPLITS:
            n = counts[SPLITS]
            set_bracket(splits, n, x * (1.0 - ASIDE), 0.0, x * (1.0 + ASIDE), 0.0)
            splits[XC, n] = number
            splits[FC, n] = counts[LAST_SPLIT + lane]
            counts[LAST_SPLIT + lane] = n + 1
            counts[SPLITS] = append_item(splits, n, lane, int(s[HALF, i]), upper)


@outlined
def place_split(s: Any, count: int, after: int) -> None:
    """Put items at one side of their places."""
    for i in lanes(padded(count)):
        s[X, i] = s[XB, i] if after > 0 else s[XA, i]


@outlined
def keep_slopes(s: Any, count: int, after: int, splits: Any, start: int) -> None:
    """Keep the function at one side of the places, of which the items are those from `start` on."""
    row = FB if after > 0 else FA
    for i in range(count):
        splits[row, start + i] = s[F, i]


@merged
def _is_between(splits: Any, n: int, a: float, b: float) -> Any:
    """Tell whether both sides of a place are strictly between two positions."""
    low, high = (a if a < b else b), (b if a < b else a)
    return (low < splits[XA, n]) & (splits[XB, n] < high)


@merged
def _is_of(splits: Any, n: int, split_by: Any) -> Any:
    """Tell whether a place is of one of these searches."""
    found = 0
    for k in range(split_by.size):
        found = 1 if splits[XC, n] == split_by[k] else found
    return found > 0


@outlined
def next_split(
    splits: Any, counts: Any, split_by: Any, lane: int, half: int, upper: bool, a: float, b: float
) -> int:
    """Return which place is the next one on the way from one position to another, -1 where none is between."""
    found, n = -1, counts[LAST_SPLIT + lane] - 1
    while n >= 0:
        own = (splits[HALF, n] == half) & ((splits[UPPER, n] > 0.0) == upper)
        if own & _is_between(splits, n, a, b) & _is_of(splits, n, split_by):
            best = n if found < 0 else found
            nearer = splits[XA, n] < splits[XA, best] if a < b else splits[XB, n] > splits[XB, best]
            found = n if nearer else best
        n = int(splits[FC, n]) - 1
    return found


@outlined
def _changes(
    splits: Any, counts: Any, split_by: Any, n: int, a: float, fa: float, b: float, fb: float
) -> int:
    """Return how often the signs change from one position to another, at the places between them, of which n is one."""
    lane, half, upper = int(splits[LANE, n]), int(splits[HALF, n]), splits[UPPER, n] > 0.0
    near, far = (FA if a < b else FB), (FB if a < b else FA)
    at, above, found = a, fa > 0.0, 0
    k = next_split(splits, counts, split_by, lane, half, upper, at, b)
    while k >= 0:
        found = found + (1 if (splits[near, k] > 0.0) != above else 0)
        found = found + (1 if (splits[near, k] > 0.0) != (splits[far, k] > 0.0) else 0)
        at, above = (splits[XB, k] if a < b else splits[XA, k]), splits[far, k] > 0.0
        k = next_split(splits, counts, split_by, lane, half, upper, at, b)
    return found + (1 if (fb > 0.0) != above else 0)


@outlined
def mark_splits(samples: Any, marks: Any, part: Any, splits: Any, counts: Any, split_by: Any) -> None:
    """Mark the samples that begin a cell of one half of the range in which such places show more zeros than its ends.

    Parameters
    ----------
    samples, marks : array (rows, lanes)
        Positions and the function's values there, and the marks of these.
    part : array of int
        Table of the half, see `cells`.
    splits, counts
        As for `keep_splits`.
    split_by : array of int
        The numbers of the searches whose zeros are places where this function has kinks.
    """
    cells = part[CELLS]
    for n in range(counts[SPLITS]):
        lane, upper = int(splits[LANE, n]), splits[UPPER, n] > 0.0
        if (int(splits[HALF, n]) != part[PART]) | (not _is_of(splits, n, split_by)):
            continue
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
            hidden = _changes(splits, counts, split_by, n, a, fa, b, fb) > 1
            marks[at, lane] = marks[at, lane] | (UNRESOLVED_CELL if hidden else 0)

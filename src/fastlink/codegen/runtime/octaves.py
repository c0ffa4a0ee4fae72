"""The cell next to a fold, octave by octave.

A quantity near a fold is a sum of powers of the distance x, negative ones among them, whose factors may differ by any
power of ten: what it does there it may do at 1e-10 of the cell, where equally spaced samples show nothing, and the
function that is searched, the slope times a power of x, is far below its value at the next sample anyway. Or a point
far away swings round there, and the function is far above both. So it is sampled at half the distance, a quarter and so
on, where one of a few of these octaves shows that it is worth it.

Close to a fold the slope may be nothing but rounding. A smooth function changes by a millionth with its argument,
rounding errors do as they like: signs count where the function stays what it is. Arrays are as in `sampling`.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import (
    CELLS,
    F1,
    F2,
    FA,
    FB,
    FIRST,
    HALF,
    HALVES,
    LANE,
    OPEN,
    ROOTS,
    START,
    TOGGLE,
    UPPER,
    X1,
    X2,
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
from fastlink.codegen.runtime.sampling import ROOT, UNRESOLVED_CELL
from fastlink.codegen.runtime.splits import next_split
from fastlink.numerics.compiler import lanes, merged, outlined

__all__ = [
    *(
        "COARSE",
        "FEW",
        "OCTAVES",
        "TRIALS",
        "begin_octaves",
        "collect_folds",
        "collect_octaves",
        "keep_octave",
    ),
    *("place_octave", "replace_cells", "to_sample", "weigh_octave"),
]

#: From the first sample, 2^-60 of the scale, to the second one, less than 2^-4 of it.
OCTAVES = 57
#: How often signs are tried.
TRIALS = 3
#: So many octaves tell whether all are sampled, every eighth one.
FEW, COARSE = 7, 8
# The function at the end over that at the next sample, where the octaves are sampled; or that of both over one between.
SMALL = 2.0**-10
# Changes of the position by which signs are tried, and that of the function which rounding errors exceed.
STEP, CHANGE = 2.0**-20, 2.0**-8


@outlined
def collect_folds(w: Any, table: Any, part: Any, samples: Any, count: int, items: Any) -> int:
    """Make items of the cells next to folds; return how many there are.

    Parameters
    ----------
    w, samples : array (rows, lanes)
        Lane values, and positions and the function's values there.
    table, part : array of int
        Tables of the kernel and of the first half, see `cells`.
    count : int
        The number of designs.
    items : array (rows of an item, items)
        The items; `XC` is the row of the cell's mark.
    """
    total, cells = 0, part[CELLS]
    for upper in range(2):
        start, toggle, position = table[START] + upper, table[TOGGLE] + upper, upper * (cells + 1)
        folds = 0
        for i in range(count):
            folds = folds + (1 if (w[start, i] != 0.0) & (w[toggle, i] == 0.0) else 0)
        if folds == 0:
            continue
        for half in range(table[HALVES]):
            first = part[FIRST] + half * (2 * cells + 1)
            end, inner = first + upper * 2 * cells, first + 1 + upper * (2 * cells - 2)
            for i in range(count):
                f, after = samples[end, i], samples[inner, i]
                fold = (w[start, i] != 0.0) & (w[toggle, i] == 0.0)
                if fold:
                    set_bracket(items, total, samples[position, i], f, samples[position + 1, i], after)
                    items[XC, total] = end - upper
                    total = append_item(items, total, i, half, upper == 1)
    return total


@outlined
def begin_octaves(s: Any, count: int) -> None:
    """Open the items whose octaves are sampled in any case: the function is small at the end."""
    for i in lanes(padded(count)):
        s[OPEN, i] = 1.0 if abs(s[FA, i]) <= SMALL * abs(s[FB, i]) else 0.0


@outlined
def weigh_octave(s: Any, count: int) -> None:
    """Open the items of which an octave is of another sign than the next sample, or far greater than both ends."""
    for i in lanes(padded(count)):
        f, end, after = s[F, i], abs(s[FA, i]), s[FB, i]
        most = end if end > abs(after) else abs(after)
        great = SMALL * abs(f) > most
        turned = ((f < 0.0) & (after > 0.0)) | ((f > 0.0) & (after < 0.0))
        s[OPEN, i] = 1.0 if great | turned else s[OPEN, i]


@outlined
def place_octave(s: Any, count: int, k: int, trial: int) -> None:
    """Put items at the second sample's position over 2^(k+1), or at the first one's; of a trial, beside it."""
    times, beside = 0.5, 1.0 + (trial * trial) * STEP
    for _ in range(k):
        times = 0.5 * times
    for i in lanes(padded(count)):
        x, least = times * s[XB, i], s[XA, i]
        s[X, i] = beside * (x if x > least else least)


@outlined
def keep_octave(s: Any, count: int, k: int, trial: int, octaves: Any) -> None:
    """Keep the values at the k-th positions; after a trial those alone that are the same beside them, else 0."""
    if trial == 0:
        for i in lanes(padded(count)):
            octaves[k, i] = s[F, i] if s[OPEN, i] > 0.0 else 0.0
    else:
        for i in lanes(padded(count)):
            f = octaves[k, i]
            octaves[k, i] = f if abs(s[F, i] - f) <= CHANGE * abs(f) else 0.0


@outlined
def to_sample(s: Any, count: int, trial: int, octaves: Any) -> int:
    """Return how many octaves are sampled: all if an item is open, and for a trial if one has values of both signs."""
    both = 0
    for i in range(count):
        both = 1 if (trial == 0) & (s[OPEN, i] > 0.0) else both
        above = s[FB, i] > 0.0
        for k in range(OCTAVES if trial > 0 else 0):
            f = octaves[k, i]
            both = 1 if (f == f) & (f != 0.0) & ((f > 0.0) != above) else both
    return both * OCTAVES


@merged
def _add_root(s: Any, i: int, counts: Any, roots: Any) -> int:
    """Make a root of an octave, or a part of one, if the function changes its sign; go on to its end; return if so."""
    x, before, place, f = s[X1, i], s[F1, i], s[X2, i], s[F2, i]
    turned = (f > 0.0) != (before > 0.0)
    if turned:
        n, upper = counts[ROOTS], s[UPPER, i] > 0.0
        if upper:
            set_bracket(roots, n, x, before, place, f)
        else:
            set_bracket(roots, n, place, f, x, before)
        append_of_lane(roots, counts, ROOTS, int(s[LANE, i]), int(s[HALF, i]), upper)
    s[X1, i] = place
    s[F1, i] = f
    return 1 if turned else 0


@outlined
def collect_octaves(s: Any, count: int, octaves: Any, counts: Any, roots: Any, splits: Any) -> None:
    """Make items of the octaves that hold a zero, and note how many there are.

    Parameters
    ----------
    s, count : array, int
        State of the items, and how many they are.
    octaves : array (OCTAVES, lanes)
        The function's values, 0 where they are not known.
    counts, roots : array
        How many items of each kind there are, and the roots.
    splits : array (rows of an item, items)
        Places where the function has kinks, see `splits.keep_splits`.
    """
    for i in range(count):
        lane, half, upper = int(s[LANE, i]), int(s[HALF, i]), s[UPPER, i] > 0.0
        found, at = 0, s[XB, i]
        s[X1, i] = at
        s[F1, i] = s[FB, i]
        for k in range(OCTAVES):
            at = 0.5 * at
            place, f = (at if at > s[XA, i] else s[XA, i]), octaves[k, i]
            if (f < 0.0) | (f > 0.0):
                n = next_split(splits, lane, half, upper, s[X1, i], place)
                while n > 0:
                    s[X2, i] = splits[XA, n]
                    s[F2, i] = splits[FA, n]
                    # else it is rounding, or a jump, which octaves show
                    if abs(splits[FB, n] - s[F2, i]) <= CHANGE * abs(s[F2, i]):
                        found = found + _add_root(s, i, counts, roots)
                    n = next_split(splits, lane, half, upper, s[X2, i], place)
                s[X2, i] = place
                s[F2, i] = f
                found = found + _add_root(s, i, counts, roots)
        s[F, i] = found


@outlined
def replace_cells(s: Any, count: int, marks: Any) -> None:
    """Take the marks of cells away whose octaves hold a zero: their ends at the fold may be rounding."""
    for i in range(count):
        lane, cell = int(s[LANE, i]), int(s[XC, i])
        if s[F, i] > 0.0:
            marks[cell, lane] = 0
            marks[cell + 1, lane] = marks[cell + 1, lane] & (ROOT | UNRESOLVED_CELL)

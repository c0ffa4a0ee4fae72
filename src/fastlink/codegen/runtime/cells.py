"""Items: cells of one design that hold a zero of one function, kept in lists, worked on `LANES` at a time.

The constants name the rows of arrays and the entries of the small tables that kernels call the functions here with.
"""

from __future__ import annotations

from typing import Any

from fastlink.numerics.compiler import inlined, lanes, merged, outlined

__all__ = [
    "ITEM_ROWS",
    "LANES",
    "MOST_LANES",
    "STATE_ROWS",
    "append_item",
    "append_of_lane",
    "append_unresolved",
    "gather",
    "nothing_yet",
    "padded",
    "set_bracket",
]

LANES = 64
#: Doubles in the widest vectors: loops over lanes run over whole numbers of these.
MOST_LANES = 8
# Rows of an item: what it is, then its bracket (position, value) and for a valley the position between.
LANE, HALF, UPPER, XA, FA, XB, FB, XC, FC = range(9)
ITEM_ROWS = 9
# Rows of the state of `LANES` items under way: the item, what the iteration keeps, then the extremum.
X, F, X1, F1, X2, F2, TOLERANCE, STEPS, OPEN = range(ITEM_ROWS, ITEM_ROWS + 9)
# The extremum: value, input position, mirror image of that, kind.
VALUE, THETA, IMAGE, KIND = range(ITEM_ROWS + 9, ITEM_ROWS + 13)
# Where error bounds are requested, in rows that the iteration has left: those of the value and of the slope at the
# position, and the sizes of the slope and of the second derivative.
BOUND, SLOPE, SLOPE_BOUND, BEND = X1, F1, X2, F2
# What rounding does to the value, in rows of the bracket: first the position and what values beside are, at folds.
SAVED, NOISE, LOWEST, HIGHEST = XA, XB, XC, FC
# Whether the slope changes its sign there, and while that is sought one slope, whether others of its side agree, and
# that of the other side, 0 where they do not; in rows that the iteration has left.
CERTAIN, BEFORE, AGREES, ONE_SIDE = STEPS, F1, TOLERANCE, OPEN
# What the slope was at the end of the iteration, until values beside are evaluated.
FOUND = X2
# Of a cell that is divided: the fine samples' positions, negative beyond an end of the range, and values there.
PARTS = 8
FINE_SAMPLES = PARTS + 3
FINE_AT, FINE = ITEM_ROWS + 13, ITEM_ROWS + 13 + FINE_SAMPLES
STATE_ROWS = FINE + FINE_SAMPLES
# Of the function at the ends of a valley: a dip that is no deeper is an inflection. Two zeros as close as 2^-20 of the
# valley leave that depth; their extremes differ by 2^-60 of the valley's rise, less than a rounding. The
# double zero of omega4 of 5, 3, 2, 2 leaves less than 2^-44.
FLAT = 2.0**-40
# Entries of the table of a kernel: rows of the lane values (the lower end's, the upper end's follows each), sides,
# halves and branches, and for each searched branch where its results go, and those of its mirror (-1 for nowhere).
START, TOGGLE, SIDES, HALVES, BRANCHES, OWN, MIRROR = 0, 1, 2, 3, 4, 5, 7
# Entries of the table of a search: its number; the search that it adds to, itself or another; the power of 1/sigma by
# which the quantity grows at a toggle; what the mirror does to it; whether it has a value exactly at a toggle; whether
# it is for the places where an angle passes pi (1), or for a smooth part of what has kinks (-1); how many entries each
# of its lists of extremes has room for; how many
# valleys, roots and unresolved cells one design may have. None of these depends on the other searches.
NUMBER, ONTO, ORDER, PARITY, AT_LIMIT, JUMPS, ROOM, MOST_VALLEYS = range(8)
MOST_ITEMS = 3
# Entries of the table of one half of the range in one search: rows of its first sample and of that of the half that
# continues it beyond both ends, number of the half, -1 where a zero at a sample counts for the cell on its other side
# (else 1), half the number of cells, the sign with which the half beyond continues the function (1 or -1).
FIRST, BEYOND, PART, SIGN, CELLS, CONTINUED = range(6)
# How many designs, valleys, roots and unresolved cells there are; how many of the last three one lane may have, and how
# many each has.
DESIGNS, VALLEYS, ROOTS, UNRESOLVED, MOST = range(5)
SHARES = MOST + MOST_ITEMS
COUNTS = SHARES + MOST_ITEMS * LANES


@inlined
def padded(count: int) -> int:
    """Return the number of lanes of the whole vectors that hold so many."""
    return (count + (MOST_LANES - 1)) & -MOST_LANES


@merged
def set_bracket(items: Any, count: int, a: float, fa: float, b: float, fb: float) -> None:
    """Write the bracket of the next item, see `append_item`."""
    items[XA, count] = a
    items[FA, count] = fa
    items[XB, count] = b
    items[FB, count] = fb


@merged
def append_item(items: Any, count: int, lane: int, half: int, upper: bool) -> int:
    """Append the item whose bracket is set; return how many there are.

    There is room for all that smooth functions can ask for; beyond that, the last column is written again.
    """
    items[LANE, count] = lane
    items[HALF, count] = half
    items[UPPER, count] = 1.0 if upper else 0.0
    return count + 1 if count + MOST_LANES <= items.shape[1] else count


@merged
def append_of_lane(items: Any, counts: Any, kind: int, lane: int, half: int, upper: bool) -> None:
    """Append the item whose bracket is set to a list, unless its design has its share of the list already.

    A function that is constant but for rounding has zeros without end; what other designs find must not depend on them.
    """
    count, own = counts[kind], SHARES + (kind - 1) * LANES + lane
    items[LANE, count] = lane
    items[HALF, count] = half
    items[UPPER, count] = 1.0 if upper else 0.0
    one = 1 if counts[own] < counts[MOST + (kind - 1)] else 0
    counts[own] = counts[own] + one
    counts[kind] = count + one


@outlined
def nothing_yet(counts: Any, search: Any) -> None:
    """Begin the lists of a search: no items of any kind, of no lane."""
    for k in range(VALLEYS, COUNTS):
        counts[k] = 0
    for k in range(MOST_ITEMS):
        counts[MOST + k] = search[MOST_VALLEYS + k]


@merged
def append_unresolved(items: Any, count: int, level: int, sign: float, owner: bool) -> None:
    """Write how often the next item was divided, its sign, and whether a valley at its first end is its own."""
    items[XC, count] = level
    items[FC, count] = 2.0 * sign if owner else sign


@outlined
def gather(items: Any, start: int, stop: int, w: Any, rows: Any, s: Any) -> int:
    """Copy up to `LANES` items and the design values they need into the state; return how many they are.

    Lanes beyond the last item, up to a whole number of vectors, repeat it.
    """
    count = min(LANES, stop - start)
    width = padded(count)
    if start + count == stop:
        for k in range(stop, start + width):
            for r in range(ITEM_ROWS):
                items[r, k] = items[r, stop - 1]
    for r in range(ITEM_ROWS):
        for i in lanes(width):
            s[r, i] = items[r, start + i]
    for r in range(rows.size):
        row = rows[r]
        for i in lanes(width):
            s[STATE_ROWS + r, i] = w[row, int(s[LANE, i])]
    return count

"""Results of a search: extrema by design and branch, sorted lists, the greatest and the least.

The zeros of a derivative come as items, each of one design, branch and side of the ground line. Where a quantity
has a mirror symmetry, a zero of one branch is one of the other branch too, at the mirror image of the input position.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.bounds import of_better
from fastlink.codegen.runtime.cells import (
    BOUND,
    BRANCHES,
    FA,
    FB,
    HALF,
    IMAGE,
    JUMPS,
    KIND,
    LANE,
    LANES,
    MIRROR,
    NOISE,
    NUMBER,
    ONTO,
    ORDER,
    OWN,
    PARITY,
    ROOM,
    SIDES,
    START,
    THETA,
    TOGGLE,
    UPPER,
    VALUE,
    X,
    padded,
)
from fastlink.numerics.compiler import inlined, lanes, outlined
from fastlink.numerics.elementary import ANGLE_ROUNDING, INFINITY, NOT_A_NUMBER, PI, TWO_PI

__all__ = [
    *("clear", "doubt", "drop_folds", "extrema_at_zeros", "mirror_image"),
    *("store_best", "store_bound", "store_counts", "store_extrema", "store_list"),
]

# Rows of the lists: an extremum's position, value and kind, and what rounding does to the value at a fold; where error
# bounds are requested, that of the value.
LIST_THETA, LIST_VALUE, LIST_KIND, LIST_NOISE, LIST_BOUND = range(5)
LIST_ROWS = 4
#: So many more entries than are returned are kept until those that are rounding have left.
MORE = 27
LIST_ROW_OF = {"position": LIST_THETA, "value": LIST_VALUE, "kind": LIST_KIND, "error": LIST_BOUND}
#: What stands for the rounding of a value that may be no extreme: its slope is certain on neither side.
DOUBTFUL = -1.0
#: And for that of one next to a toggle, where there is none: no list holds it.
SPURIOUS = -2.0
# Rows of the best: greatest and least value with their positions, and how many extrema there are; where error bounds
# are requested, those of both, and whether the list of extremes is undecided.
GREATEST, AT_GREATEST, LEAST, AT_LEAST, COUNT, GREATEST_BOUND, LEAST_BOUND, UNDECIDED = range(8)
BEST_ROWS = 5
# Zeros of a slope within so many distances of the first sample from a fold are the fold itself, which is listed no more
# than a toggle: towards a pole the sampled function falls with a power of the distance, and looks like zero there.
FOLDED = 2.0**8
# An extreme within 2^-26 of the scale from a toggle is as great as the quantity at the toggle to a rounding, where
# that is finite; the slope is a small difference of great numbers there, which changes its sign as it likes.
TOGGLED = 2.0**34


@outlined
def clear(lists: Any, best: Any, kept: int) -> None:
    """Forget the extrema of the designs before, in lists those that are returned."""
    for r in range(lists.shape[0]):
        for column in range(lists.shape[1]):
            for k in range(kept):
                lists[r, column, k] = 0.0 if r == LIST_KIND else NOT_A_NUMBER
    for i in lanes(best.shape[1]):
        best[GREATEST, i] = -INFINITY
        best[LEAST, i] = INFINITY
        best[AT_GREATEST, i] = NOT_A_NUMBER
        best[AT_LEAST, i] = NOT_A_NUMBER
        best[COUNT, i] = 0.0
    for r in range(BEST_ROWS, best.shape[0]):
        for i in lanes(best.shape[1]):
            best[r, i] = 0.0


@outlined
def _insert(lists: Any, column: int, count: int, theta: float, room: int) -> int:
    """Make room in a sorted list of so many extrema, the last of which drops out beyond its room; return where."""
    k = count if count < room else room
    while k > 0 and lists[LIST_THETA, column, k - 1] > theta:
        k -= 1
    for move in range(min(count, room - 1), k, -1):
        for r in range(lists.shape[0]):
            lists[r, column, move] = lists[r, column, move - 1]
    return k


@inlined
def mirror_image(theta: Any, twice_axis: Any) -> Any:
    """Return the mirror image of an input position; the sum of both is `twice_axis`, but for full turns."""
    image = twice_axis - theta
    return image + TWO_PI if image < -(twice_axis * ANGLE_ROUNDING) else (0.0 if image < 0.0 else image)


@outlined
def extrema_at_zeros(s: Any, count: int, table: Any, search: Any) -> None:
    """Find of what kind the extremum at each zero is: 1 for a maximum, -1 for a minimum; 0 and pi where an angle jumps.

    A zero of another slope is of no kind.

    Parameters
    ----------
    s, count : array, int
        State of the items, and how many they are.
    table, search : array of int
        Tables of the kernel and of the search, see `cells`.
    """
    sides = table[SIDES]
    if search[ONTO] == search[NUMBER]:
        for i in lanes(padded(count)):
            half = int(s[HALF, i])
            lower_side = half - (half >> (sides - 1)) * sides == 0
            rises = (s[FA, i] > 0.0) | (s[FB, i] < 0.0)
            s[KIND, i] = 1.0 if rises == lower_side else -1.0
    elif search[JUMPS] <= 0:
        for i in lanes(padded(count)):
            s[KIND, i] = 0.0
    else:
        for i in lanes(padded(count)):
            # An angle near 0 passes 0, which is no extremum; it is pi and -pi where it jumps.
            s[KIND, i] = NOT_A_NUMBER if abs(s[VALUE, i]) < 1.0 else 0.0
            s[VALUE, i] = PI


@outlined
def drop_folds(s: Any, count: int, w: Any, table: Any, search: Any) -> None:
    """Drop extrema that are nothing but the end of the range at a fold or toggle, or have no value.

    Parameters
    ----------
    s, count : array, int
        State of the items, and how many they are.
    w, table : array
        Lane values, and the table of the kernel, see `cells`.
    search : array of int
        Table of the search.
    """
    of_toggle = (
        TOGGLED if search[ORDER] == 0 else 0.0
    )  # a quantity that grows towards a toggle has no value there
    for i in range(count):
        upper, lane = int(s[UPPER, i]), int(s[LANE, i])
        first, fold = abs(w[table[START] + upper, lane]), w[table[TOGGLE] + upper, lane] == 0.0
        is_end = s[X, i] < (FOLDED if fold else of_toggle) * first
        if (is_end and s[KIND, i] != 0.0) or s[VALUE, i] != s[VALUE, i]:
            s[KIND, i] = NOT_A_NUMBER


@outlined
def store_extrema(s: Any, count: int, table: Any, search: Any, lists: Any, best: Any) -> None:
    """Sort the extrema at items into the results of their design, each for its own branch, then for the mirror's.

    Parameters
    ----------
    s, count, table, search
        As for `extrema_at_zeros`.
    lists : array (3 or 4, columns, length)
        Sorted lists of extrema; a column is of one search, branch and design.
    best : array (5 or 8, columns)
        The greatest and least values.
    """
    sides, branches = table[SIDES], table[BRANCHES]
    onto, parity = search[ONTO], float(search[PARITY])
    jumps, room = search[JUMPS] > 0, search[ROOM]
    for i in range(count):
        value, theta, kind, bound = s[VALUE, i], s[THETA, i], s[KIND, i], s[BOUND, i]
        if kind != kind:
            continue
        lane, branch = int(s[LANE, i]), int(s[HALF, i]) >> (sides - 1)
        for mirror in range(2):
            target = table[MIRROR + branch] if mirror == 1 else table[OWN + branch]
            if target < 0:
                continue
            if mirror == 1:
                theta = s[IMAGE, i]
                if not jumps:
                    value = parity * value
                kind = parity * kind
            column = (onto * branches + target) * LANES + lane
            # a function that is nothing but rounding would leave no room for extremes
            doubtful = (room > 0) & (s[NOISE, i] == DOUBTFUL)
            spurious = (room > 0) & (s[NOISE, i] == SPURIOUS)
            if (kind != 0.0) & (not spurious) & ((not doubtful) | (best[COUNT, column] < (room >> 1))):
                if room > 0:
                    k = _insert(lists, column, int(best[COUNT, column]), theta, room)
                    if k < room:
                        lists[LIST_THETA, column, k] = theta
                        lists[LIST_VALUE, column, k] = value
                        lists[LIST_KIND, column, k] = kind
                        lists[LIST_NOISE, column, k] = s[NOISE, i]
                        if lists.shape[0] > LIST_BOUND:
                            lists[LIST_BOUND, column, k] = bound
                best[COUNT, column] += 1.0
            least = -PI if jumps else value
            if best.shape[0] > BEST_ROWS:
                high, low = best[GREATEST_BOUND, column], best[LEAST_BOUND, column]
                best[GREATEST_BOUND, column] = of_better(best[GREATEST, column], high, value, bound)
                best[LEAST_BOUND, column] = of_better(-best[LEAST, column], low, -least, bound)
            if value > best[GREATEST, column]:
                best[GREATEST, column] = value
                best[AT_GREATEST, column] = theta
            if least < best[LEAST, column]:
                best[LEAST, column] = least
                best[AT_LEAST, column] = theta


@outlined
def doubt(w: Any, row: int, count: int, lists: Any, best: Any) -> None:
    """Make the bounds of all extremes of designs infinite where a lane value is positive.

    Parameters
    ----------
    w, row : array, int
        Lane values, and the row of the error of a toggle.
    count : int
        The number of designs.
    lists, best : array
        The results.
    """
    for i in range(count):
        if w[row, i] > 0.0:
            for column in range(i, best.shape[1], LANES):
                for r in range(BEST_ROWS, UNDECIDED):
                    best[r, column] = INFINITY
                if lists.shape[0] > LIST_BOUND:
                    for k in range(lists.shape[2]):
                        lists[LIST_BOUND, column, k] = lists[LIST_BOUND, column, k] + INFINITY


@outlined
def store_list(result: Any, first: int, count: int, base: int, lists: Any, row: int) -> None:
    """Copy a list of each design and branch; beyond the last extremum stands NaN, and 0 as a kind."""
    beyond = 0.0 if row == LIST_KIND else NOT_A_NUMBER
    for i in range(count):
        for branch in range(result.shape[1]):
            for k in range(result.shape[2]):
                value = lists[row, base + branch * LANES + i, k] if k < lists.shape[2] - MORE else beyond
                result[first + i, branch, k] = value


@outlined
def store_counts(result: Any, first: int, count: int, base: int, best: Any) -> None:
    """Copy how many extrema there are."""
    for i in range(count):
        for branch in range(result.shape[1]):
            result[first + i, branch] = min(int(best[COUNT, base + branch * LANES + i]), 127)


@outlined
def store_best(result: Any, first: int, count: int, base: int, best: Any, row: int) -> None:
    """Copy a greatest or least value, or its position from the row after; NaN where there is none."""
    for i in range(count):
        for branch in range(result.shape[1]):
            column = base + branch * LANES + i
            theta = best[row | 1, column]
            result[first + i, branch] = best[row, column] if theta == theta else NOT_A_NUMBER


@outlined
def store_bound(result: Any, first: int, count: int, base: int, best: Any, row: int) -> None:
    """Copy the error bound of the greatest or least value; NaN where there is none."""
    of = GREATEST_BOUND if row == GREATEST else LEAST_BOUND
    for i in range(count):
        for branch in range(result.shape[1]):
            column = base + branch * LANES + i
            theta = best[row | 1, column]
            result[first + i, branch] = best[of, column] if theta == theta else NOT_A_NUMBER

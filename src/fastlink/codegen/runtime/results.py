"""What a search has found: extremes by design and branch, sorted lists, the greatest and the least.

The zeros of a derivative come as items, each of one design, branch and side of the ground line. Where a quantity
has a mirror symmetry, a zero of one branch is one of the other branch too, at the mirror image of the input position.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import FA, FB, HALF, LANE, LANES, UPPER, append_item
from fastlink.numerics.compiler import lanes, outlined
from fastlink.numerics.elementary import ANGLE_ROUNDING, INFINITY, NOT_A_NUMBER, PI, TWO_PI

__all__ = ["clear", "collect_ends", "store_best", "store_counts", "store_list", "take"]

# Rows of the lists, and of the best.
PLACE, VALUE, KIND = range(3)
GREATEST, AT_GREATEST, LEAST, AT_LEAST = range(4)


@outlined
def clear(lists: Any, best: Any, found: Any) -> None:
    """Forget what was found."""
    for r in range(lists.shape[0]):
        for column in range(lists.shape[1]):
            for k in range(lists.shape[2]):
                lists[r, column, k] = NOT_A_NUMBER
    for i in lanes(found.size):
        best[GREATEST, i] = -INFINITY
        best[LEAST, i] = INFINITY
        best[AT_GREATEST, i] = NOT_A_NUMBER
        best[AT_LEAST, i] = NOT_A_NUMBER
        found[i] = 0


@outlined
def _insert(lists: Any, column: int, count: int, theta: float, value: float, kind: float) -> None:
    """Insert into a sorted list; beyond its length the last one drops out, and the count tells."""
    room = lists.shape[2]
    k = min(count, room)
    while k > 0 and lists[PLACE, column, k - 1] > theta:
        k -= 1
    if k == room:
        return
    for move in range(min(count, room - 1), k, -1):
        for r in range(3):
            lists[r, column, move] = lists[r, column, move - 1]
    lists[PLACE, column, k] = theta
    lists[VALUE, column, k] = value
    lists[KIND, column, k] = kind


@outlined
def take(
    s: Any,
    count: int,
    which: int,
    ends: bool,
    w: Any,
    about: Any,
    own: Any,
    other: Any,
    onto: Any,
    order: Any,
    parity: Any,
    lists: Any,
    best: Any,
    found: Any,
    twice_axis: float,
) -> None:
    """Sort the items of a search into the results of their design.

    Parameters
    ----------
    s, count : array, int
        State of the items, and how many they are.
    which : int
        Number of the search.
    ends : bool
        Whether the items are ends of the range.
    w : array
        Lane values.
    about : array of int
        Row of the state that holds the quantity, the next one holds the input position; row of `w` that says whether
        the lower end is a toggle, the next one whether the upper one is; sides that were searched; branches that are
        asked for.
    own, other : array of int
        For each branch that was searched where its results go, and those of its mirror; -1 for nowhere.
    onto : array of int
        For each search that whose results it adds to: itself, or another if it tells where that one's angle passes pi.
    order, parity : array
        For each quantity the power of 1/sigma by which it grows at a toggle, and what the mirror does to it.
    twice_axis : float
        Sum of an input position and its mirror image, but for full turns.
    """
    row, toggles, sides, branches = about[0], about[1], about[2], about[3]
    for i in range(count):
        lane, half = int(s[LANE, i]), int(s[HALF, i])
        value, theta = s[row, i], s[row + 1, i]
        branch = half >> (sides - 1)
        side = half - branch * sides
        kind = 0.0
        jumps = onto[which] != which
        if jumps:
            # An angle near 0 passes 0; it is pi and -pi where it jumps.
            if abs(value) < 1.0:
                continue
            value = PI
        elif ends:
            if w[toggles + int(s[UPPER, i]), lane] > 0.0 and order[which] > 0 and value != 0.0:
                value = value * INFINITY
        else:
            rises = s[FA, i] > 0.0 or s[FB, i] < 0.0
            kind = 1.0 if rises == (side == 0) else -1.0
        # Of its own branch, then of the mirror's.
        for mirror in range(2):
            target = other[branch] if mirror == 1 else own[branch]
            if target < 0:
                continue
            if mirror == 1:
                theta = twice_axis - theta
                theta = theta + TWO_PI if theta < -(twice_axis * ANGLE_ROUNDING) else max(theta, 0.0)
                if not jumps:
                    value = parity[which] * value
                kind = parity[which] * kind
            column = (onto[which] * branches + target) * LANES + lane
            if kind != 0.0:
                if lists.shape[2] > 0:
                    _insert(lists, column, found[column], theta, value, kind)
                found[column] += 1
            if value > best[GREATEST, column]:
                best[GREATEST, column] = value
                best[AT_GREATEST, column] = theta
            least = -PI if jumps else value
            if least < best[LEAST, column]:
                best[LEAST, column] = least
                best[AT_LEAST, column] = theta


@outlined
def collect_ends(
    w: Any,
    starts: int,
    count: int,
    halves: int,
    which: int,
    very_end: bool,
    best: Any,
    branches: int,
    ends: Any,
) -> int:
    """Make items of the ends of the range where they may be extreme: at toggles, and where nothing else was found.

    An end counts where the first sample is; with `very_end` at the end itself, unless the first sample's place is
    negative: nothing has a value at the end itself then.
    """
    total = 0
    for i in range(count):
        empty = False
        for branch in range(branches):
            empty = empty or best[GREATEST, (which * branches + branch) * LANES + i] == -INFINITY
        for half in range(halves):
            for upper in range(2):
                first = w[starts + upper, i]
                if first != 0.0 or empty:
                    place = 0.0 if very_end and first >= 0.0 else abs(first)
                    total = append_item(ends, total, i, half, upper == 1, place, 0.0, place, 0.0)
    return total


@outlined
def store_list(result: Any, first: int, count: int, base: int, lists: Any, row: int) -> None:
    """Copy a list of each design and branch."""
    for i in range(count):
        for branch in range(result.shape[1]):
            for k in range(result.shape[2]):
                value = lists[row, base + branch * LANES + i, k] if k < lists.shape[2] else NOT_A_NUMBER
                result[first + i, branch, k] = value


@outlined
def store_kinds(result: Any, first: int, count: int, base: int, lists: Any) -> None:
    """Copy the kinds: 1 for a maximum, -1 for a minimum, 0 beyond the last extreme."""
    for i in range(count):
        for branch in range(result.shape[1]):
            for k in range(result.shape[2]):
                kind = lists[KIND, base + branch * LANES + i, k] if k < lists.shape[2] else NOT_A_NUMBER
                result[first + i, branch, k] = int(kind) if kind == kind else 0


@outlined
def store_counts(result: Any, first: int, count: int, base: int, found: Any) -> None:
    """Copy how many extremes were found."""
    for i in range(count):
        for branch in range(result.shape[1]):
            result[first + i, branch] = min(found[base + branch * LANES + i], 127)


@outlined
def store_best(result: Any, first: int, count: int, base: int, best: Any, row: int) -> None:
    """Copy a greatest or least value, or its place in the row after; NaN where there is none."""
    where = row | 1
    for i in range(count):
        for branch in range(result.shape[1]):
            column = base + branch * LANES + i
            there_is = best[where, column] == best[where, column]
            result[first + i, branch] = best[row, column] if there_is else NOT_A_NUMBER

"""Lists that may lack an extreme, or hold one too many: those that doubles do not decide.

Beside a fold the slope may be certain down to some distance, and below that nothing but rounding. Where it falls
towards the fold as far as it is certain, it may have one more zero between; where it keeps its size, or grows, it has
none that a sample would not show. Lists of the first kind are marked, like those from which entries left that may be
extremes, those without room for all, those of halves that were silenced, being at rest but for what rounding hides,
those of an extreme whose place is as uncertain as its distance from the fold, or from a toggle that is almost one, is
great, and those of a peak with few certain digits. Their bounds are infinite, and so are those of places that no
extreme takes: a list that is empty can tell it, too.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.bounds import is_certain
from fastlink.codegen.runtime.cells import (
    BEND,
    BOUND,
    BRANCHES,
    FA,
    HALF,
    KIND,
    LANE,
    LANES,
    MIRROR,
    NUMBER,
    OWN,
    SIDES,
    SLOPE,
    SLOPE_BOUND,
    START,
    STEPS,
    TOGGLE,
    TOLERANCE,
    UPPER,
    VALUE,
    X,
    padded,
)
from fastlink.codegen.runtime.results import LIST_BOUND, UNDECIDED
from fastlink.numerics.compiler import lanes, merged, outlined
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER

__all__ = ["begin_certain", "flag_undecided", "keep_certain", "note_hidden", "note_uncertain"]

# A slope that comes down to so little of itself with half the distance falls: as the distance itself it halves.
FALLING = 0.75
# A peak that may be off by so much of its height: what it is in the middle of is as uncertain. Of the three extremes of
# a curvature within a peak above 1e15 two were lost, and the third was so.
PEAK = 2.0**-16
# The scale of a toggle, beside which the first sample stands.
PER_FIRST = 2.0**60
# As near to a toggle rounding may make extremes up.
BESIDE = 2.0**-20
# While that is found: the slope at the place before that was certain, 0 before there is one; and whether it falls.
LAST, FALLS = TOLERANCE, STEPS


@outlined
def begin_certain(s: Any, count: int) -> None:
    """Forget what was certain: as long as nothing is, an extreme may hide."""
    for i in lanes(padded(count)):
        s[LAST, i] = 0.0
        s[FALLS, i] = 1.0


@outlined
def keep_certain(s: Any, count: int) -> None:
    """Compare a slope at half the distance before with that there; an uncertain one counts for nothing."""
    for i in lanes(padded(count)):
        slope, last = s[SLOPE, i], s[LAST, i]
        certain = is_certain(slope, s[SLOPE_BOUND, i])
        falls = 1.0 if (slope < FALLING * last) | (last == 0.0) else 0.0
        s[FALLS, i] = falls if certain else s[FALLS, i]
        s[LAST, i] = slope if certain else FALLING * last


@merged
def _undecided(best: Any, table: Any, search: Any, lane: int, half: int) -> None:
    """Mark the lists that the extremes of one half of a design would be in."""
    branch = half >> (table[SIDES] - 1)
    for mirror in range(2):
        target = table[MIRROR + branch] if mirror == 1 else table[OWN + branch]
        if target >= 0:
            best[UNDECIDED, (search[NUMBER] * table[BRANCHES] + target) * LANES + lane] = 1.0


@outlined
def note_hidden(s: Any, count: int, table: Any, search: Any, best: Any) -> None:
    """Mark the lists of items whose cells may hide an extreme next to the fold."""
    for i in range(count):
        silenced = s[FA, i] != s[FA, i]
        if silenced | (s[FALLS, i] > 0.0):
            _undecided(best, table, search, int(s[LANE, i]), int(s[HALF, i]))


@merged
def _distance(w: Any, table: Any, upper: int, lane: int, x: float) -> Any:
    """Return how far a position is from a fold, 1 at most, or from a toggle next to it; NaN where there is neither.

    Far from a toggle a bound as great as the slope is that of a kink, whose place is certain.
    """
    first, is_toggle = abs(w[table[START] + upper, lane]), w[table[TOGGLE] + upper, lane] != 0.0
    # the input angle goes with x beside a fold, with its square beside a toggle, up to its scale
    from_toggle = x * (x / (x + PER_FIRST * first))
    distance = from_toggle if from_toggle < BESIDE else NOT_A_NUMBER
    return (distance if is_toggle else min(x, 1.0)) if first > 0.0 else NOT_A_NUMBER


@outlined
def note_uncertain(s: Any, count: int, w: Any, table: Any, search: Any, best: Any) -> None:
    """Mark lists of extremes whose side of a fold or toggle rounding hides, and of those with few certain digits."""
    for i in range(count):
        upper, lane, x = int(s[UPPER, i]), int(s[LANE, i]), s[X, i]
        off, bend = s[SLOPE, i] + s[SLOPE_BOUND, i], s[BEND, i]
        if s[KIND, i] != s[KIND, i]:
            continue
        here = _distance(w, table, upper, lane, x)
        there = _distance(w, table, 1 - upper, lane, 1.0 / x)
        unsettled = (off >= bend * here) | (off >= bend * there)
        height = s[KIND, i] * s[VALUE, i]
        peak = (height > 0.0) & (s[BOUND, i] > PEAK * height)
        if unsettled | peak:
            _undecided(best, table, search, lane, int(s[HALF, i]))


@outlined
def flag_undecided(lists: Any, best: Any, first: int, last: int, room: int) -> None:
    """Make the bounds of all places of undecided lists infinite; the parameters are those of `noise.thin`."""
    for column in range(first, last):
        if best[UNDECIDED, column] > 0.0:
            for k in range(room):
                lists[LIST_BOUND, column, k] = INFINITY

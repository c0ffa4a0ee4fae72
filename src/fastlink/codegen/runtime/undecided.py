"""Lists that doubles do not decide: entries of rounding, extremes that may hide, halves at rest."""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import (
    BEND,
    BEYOND,
    BOUND,
    BRANCHES,
    CELLS,
    CERTAIN,
    EXPECTED,
    FA,
    FB,
    FIRST,
    FOUND,
    HALF,
    KIND,
    LANE,
    LANES,
    MIRROR,
    NUMBER,
    ONE_SIDE,
    OWN,
    PART,
    SAVED,
    SIDES,
    SLOPE,
    SLOPE_BOUND,
    START,
    STEPS,
    TOGGLE,
    TOLERANCE,
    UPPER,
    VALUE,
    XA,
    XB,
    F,
    X,
    append_item,
    padded,
    set_bracket,
)
from fastlink.codegen.runtime.results import (
    COUNT,
    LIST_BOUND,
    UNDECIDED,
    is_certain,
)
from fastlink.numerics.compiler import lanes, merged, outlined
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER

# -- Entries of the lists that are nothing but rounding, next to folds and toggles

# At a fold a quantity may be a small difference of great numbers: its slope changes its sign with every
# last bit, and each change looks like an extreme. At a toggle a curvature goes on in the other branch, and
# its slope in the input position is infinite: a small difference of great numbers there, too. So an entry
# there is certain only if at some distance the slope is beyond its error bound on both sides, with the
# signs of that extreme. Others leave the list, which is undecided then: it may lack an extreme. They still
# count for the greatest and the least value, within whose bounds they are.


#: Slopes are evaluated on both sides at so many distances from an extreme: 2^-1, 2^-7, ... of the position itself.
DISTANCES, FIRST_DISTANCE, NEXT_DISTANCE = 6, 0.5, 2.0**-6
SLOPES = 2 * DISTANCES
# How near a fold, in x, that is done: farther away quantities are no small differences of great numbers.
NEAR = 2.0**-10
# And within how many distances of the first sample from a toggle: within 2^-20 of the scale.
NEAR_TOGGLE = 2.0**40


@outlined
def count_near(s: Any, count: int, w: Any, table: Any) -> int:
    """Return how many items are near a fold or toggle, and not certain yet; keep all positions and slopes."""
    near = 0
    for i in range(count):
        lane, upper = int(s[LANE, i]), int(s[UPPER, i])
        first, toggle = abs(w[table[START] + upper, lane]), w[table[TOGGLE] + upper, lane]
        is_near = (first != 0.0) & (s[X, i] < NEAR) if toggle == 0.0 else s[X, i] < NEAR_TOGGLE * first
        rises, turned = (s[FA, i] > 0.0) | (s[FB, i] < 0.0), s[XA, i] > s[XB, i]
        s[EXPECTED, i] = 1.0 if rises != turned else -1.0
        s[SAVED, i] = s[X, i]
        s[FOUND, i] = s[F, i]
        s[CERTAIN, i] = 0.0 if is_near else 1.0
        near = near + (1 if is_near else 0)
    return near


@outlined
def place_slope(s: Any, count: int, k: int) -> None:
    """Put items at the k-th place where the slope is evaluated: nearer to the end and farther from it in turns."""
    distance = FIRST_DISTANCE
    for _ in range(k >> 1):
        distance = NEXT_DISTANCE * distance
    times = 1.0 / (1.0 + distance) if k & 1 == 0 else 1.0 + distance
    for i in lanes(padded(count)):
        s[X, i] = s[SAVED, i] * times


@outlined
def keep_slope(s: Any, count: int, k: int) -> None:
    """Keep the slope nearer to the end if its sign is certain, or compare that with the one on the other side."""
    for i in lanes(padded(count)):
        f = s[F, i] * s[EXPECTED, i]
        f = f if abs(f) > s[SLOPE_BOUND, i] else 0.0
        turns = (s[ONE_SIDE, i] > 0.0) & (f < 0.0) & (k & 1 == 1)
        s[CERTAIN, i] = 1.0 if turns else s[CERTAIN, i]
        s[ONE_SIDE, i] = f


@outlined
def settle_slopes(s: Any, count: int) -> None:
    """Put items back."""
    for i in lanes(padded(count)):
        s[X, i] = s[SAVED, i]
        s[F, i] = s[FOUND, i]


# -- Lists that may lack an extreme, or hold one too many: those that doubles do not decide

# Beside a fold the slope may be certain down to some distance, and below that nothing but rounding. Where
# it falls towards the fold as far as it is certain, it may have one more zero between; where it keeps its
# size, or grows, it has none that a sample would not show. Lists of the first kind are marked, like those
# from which entries left that may be extremes, those without room for all, those of halves that were
# silenced, being at rest but for what rounding hides, those of an extreme whose place is as uncertain as
# its distance from the fold, or from a toggle that is almost one, is great, and those of a peak with few
# certain digits. Their bounds are infinite, and so are those of places that no extreme takes: a list that
# is empty can tell it, too.


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
LAST_TOLERANCE, FALLS = TOLERANCE, STEPS


@outlined
def begin_certain(s: Any, count: int) -> None:
    """Forget what was certain: as long as nothing is, an extreme may hide."""
    for i in lanes(padded(count)):
        s[LAST_TOLERANCE, i] = 0.0
        s[FALLS, i] = 1.0


@outlined
def keep_certain(s: Any, count: int) -> None:
    """Compare a slope at half the distance before with that there; an uncertain one counts for nothing."""
    for i in lanes(padded(count)):
        slope, last = s[SLOPE, i], s[LAST_TOLERANCE, i]
        certain = is_certain(slope, s[SLOPE_BOUND, i])
        falls = 1.0 if (slope < FALLING * last) | (last == 0.0) else 0.0
        s[FALLS, i] = falls if certain else s[FALLS, i]
        s[LAST_TOLERANCE, i] = slope if certain else FALLING * last


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
        if (best[UNDECIDED, column] > 0.0) | (best[COUNT, column] > room):
            for k in range(room):
                lists[LIST_BOUND, column, k] = INFINITY


# -- Halves of the range in which a quantity does not change: bars that fold onto each other turn as one

# At a fold a linkage may go on as another: a kite with two of its joints in one place, a parallelogram
# whose output turns as its input does. Forces and torques are constant then, and all that samples show of
# the slope is rounding errors, of which zeros fill the lists. Arrays are as in `cells`.


#: A half may be at rest where the greatest slope is so little of the greatest of the half that continues it. It is if
#: one sample in five is 0 or of another sign than the one before: rounding errors are so at every second one, and no
#: quantity has so many extremes.
REST, RESTLESS = 2.0**-20, 5


@outlined
def silence_rest(w: Any, table: Any, samples: Any, marks: Any, part: Any, count: int) -> None:
    """Take the samples of one half of the range away where they are rounding errors beside those of the next half."""
    start, toggle, rows = table[START], table[TOGGLE], 2 * part[CELLS] + 1
    first, beyond = part[FIRST], part[BEYOND]
    for i in range(count):
        lower = (w[start, i] != 0.0) & (w[toggle, i] == 0.0)
        upper = (w[start + 1, i] != 0.0) & (w[toggle + 1, i] == 0.0)
        if lower | upper:
            own, other, restless = 0.0, 0.0, 0
            for j in range(rows):
                f, there, before = (
                    samples[first + j, i],
                    abs(samples[beyond + j, i]),
                    samples[first + max(j - 1, 0), i],
                )
                own = abs(f) if abs(f) > own else own
                other = there if there > other else other
                restless = restless + (1 if (f == 0.0) | ((f > 0.0) != (before > 0.0)) else 0)
            if (own <= REST * other) & (other < INFINITY) & (RESTLESS * restless > rows):
                for j in range(rows):
                    samples[first + j, i] = NOT_A_NUMBER
                    marks[first + j, i] = 0


@outlined
def collect_rest(samples: Any, part: Any, count: int, ends: Any, total: int) -> int:
    """Make items of the middles of halves that were silenced: no extreme, yet the value there may be the greatest."""
    for i in range(count):
        middle = samples[part[FIRST] + part[CELLS], i]
        if middle != middle:
            set_bracket(ends, total, 1.0, 0.0, 1.0, 0.0)
            total = append_item(ends, total, i, part[PART], False)
    return total

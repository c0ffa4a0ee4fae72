"""Lists that doubles do not decide: entries of rounding, extremes that may hide, halves at rest."""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import (
    AGREES,
    BEFORE,
    BEND,
    BEYOND,
    BOUND,
    BRANCHES,
    CELLS,
    CERTAIN,
    FA,
    FIRST,
    FOUND,
    HALF,
    HIGHEST,
    KIND,
    LANE,
    LANES,
    LOWEST,
    MIRROR,
    NOISE_FLAG,
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
    F,
    X,
    append_item,
    padded,
    set_bracket,
)
from fastlink.codegen.runtime.results import (
    BEST_ROWS,
    COUNT,
    DOUBTFUL,
    LIST_BOUND,
    LIST_KIND,
    LIST_NOISE,
    LIST_THETA,
    LIST_VALUE,
    SPURIOUS,
    UNDECIDED,
    is_certain,
)
from fastlink.numerics.compiler import lanes, merged, outlined
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER

# -- Entries of the lists that are nothing but rounding, next to folds

# At a fold a quantity may be a small difference of great numbers: its slope changes its sign with every
# last bit, and each change looks like an extreme. So an extreme is listed only if its slope has one sign on
# its one side and the other on the other, at some distance at which a slight change of the position leaves
# the slope what it is: rounding errors do as they like. Of others between two maxima, or two minima, one is
# left, as there is one; else all leave. They still count for the greatest and the least value, within whose
# bounds they are.
#
# At a toggle a curvature goes on in the other branch, and its slope in the input position is infinite: a
# small difference of great numbers there. An entry within 2^-20 of the scale from a toggle is listed only
# if its slope is certain, too.
#
# Where a slope has three zeros in place of one, two of these are rounding. What that does to the value is
# measured, too: it is evaluated at positions beside, which differ by so little that an extreme would not
# change in its last digits. A maximum and the minimum next to it whose values differ by less than rounding
# does to each of them leave the list together; the nearest values first. The greatest and the least of all
# stay. Where more entries are certain than the lists have room for, all stay. A list from which uncertain
# ones were taken, or that has no room for all, is undecided: it may lack an extreme, or hold one too many,
# see `hidden`.


#: Positions are moved by 2^-20 of themselves, then 2^-28, 2^-36, 2^-44; rounding is at most so many times as great as
#: these show.
TRIALS, FIRST_STEP, NEXT_STEP, MARGIN = 4, 2.0**-20, 2.0**-8, 8.0
#: Slopes are compared at so many distances from an extreme, on both sides at so many positions each; the distances
#: are 2^-1, 2^-7, ... of the position itself, and positions 2^-4 of the distance apart, by which the slope there may
#: change by so much.
DISTANCES, POSITIONS, FIRST_DISTANCE, NEXT_DISTANCE, APART, CHANGE = 6, 4, 0.5, 2.0**-6, 2.0**-4, 0.3125
SLOPES = DISTANCES * 2 * POSITIONS
#: Whose number is one of so many bits, then comes that of the side, as kernels divide by powers of two alone.
BITS, LAST = 2, POSITIONS - 1
# How near a fold, in x, rounding is measured: farther away quantities are no small differences of great numbers.
NEAR = 2.0**-10
# So many distances of the first sample from a toggle its slope is looked at: within 2^-20 of the scale.
NEAR_TOGGLE = 2.0**40
#: What marks items next to a fold, and those next to a toggle.
FOLDED, TOGGLED = 1.0, 2.0


@outlined
def count_folded(s: Any, count: int, w: Any, table: Any) -> int:
    """Return how many items are near a fold or toggle; mark these, and keep all positions and slopes."""
    near = 0
    for i in range(count):
        lane, upper = int(s[LANE, i]), int(s[UPPER, i])
        fold = (w[table[START] + upper, lane] != 0.0) & (w[table[TOGGLE] + upper, lane] == 0.0)
        s[SAVED, i] = s[X, i]
        s[FOUND, i] = s[F, i]
        s[NOISE_FLAG, i] = 0.0
        s[CERTAIN, i] = 1.0
        s[LOWEST, i] = INFINITY
        s[HIGHEST, i] = -INFINITY
        beside = (not fold) & (s[X, i] < NEAR_TOGGLE * abs(w[table[START] + upper, lane]))
        if beside | (fold & (abs(s[X, i]) < NEAR)):
            s[NOISE_FLAG, i] = TOGGLED if beside else FOLDED
            s[CERTAIN, i] = 0.0
            near = near + 1
    return near


@outlined
def place_slope(s: Any, count: int, k: int) -> None:
    """Put items near a fold at the k-th position at which the slope is compared."""
    distance = FIRST_DISTANCE
    for _ in range(k >> (BITS + 1)):
        distance = NEXT_DISTANCE * distance
    away = distance * (1.0 + APART * (k & LAST))
    times = 1.0 + away if (k >> BITS) & 1 == 1 else 1.0 / (1.0 + away)
    for i in lanes(padded(count)):
        s[X, i] = s[SAVED, i] * times if s[NOISE_FLAG, i] > 0.0 else s[SAVED, i]


@outlined
def keep_slope(s: Any, count: int, k: int) -> None:
    """Compare the slope at the k-th position with that at the first one of its side, and that with the other side's."""
    position, side = k & LAST, (k >> BITS) & 1
    if position == 0:
        for i in lanes(padded(count)):
            s[BEFORE, i] = s[F, i]
            s[AGREES, i] = 1.0
    else:
        for i in lanes(padded(count)):
            before = s[BEFORE, i]
            s[AGREES, i] = s[AGREES, i] if abs(s[F, i] - before) <= CHANGE * abs(before) else 0.0
    if position == POSITIONS - 1:
        for i in lanes(padded(count)):
            before = s[BEFORE, i] if s[AGREES, i] > 0.0 else 0.0
            turns = ((before > 0.0) & (s[ONE_SIDE, i] < 0.0)) | ((before < 0.0) & (s[ONE_SIDE, i] > 0.0))
            s[CERTAIN, i] = 1.0 if turns & (side == 1) else s[CERTAIN, i]
            s[ONE_SIDE, i] = before


@outlined
def settle_slopes(s: Any, count: int) -> None:
    """Put items back."""
    for i in lanes(padded(count)):
        s[X, i] = s[SAVED, i]
        s[F, i] = s[FOUND, i]


@outlined
def place_beside_fold(s: Any, count: int, trial: int) -> None:
    """Put items near a fold beside their positions."""
    step = FIRST_STEP
    for _ in range(trial):
        step = NEXT_STEP * step
    for i in lanes(padded(count)):
        s[X, i] = s[SAVED, i] * (1.0 + step) if s[NOISE_FLAG, i] > 0.0 else s[SAVED, i]


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
    """Make what rounding does to values of what was seen beside them; 0 far from folds, `DOUBTFUL` of no extreme."""
    for i in lanes(padded(count)):
        value = s[VALUE, i]
        above, below = s[HIGHEST, i] - value, value - s[LOWEST, i]
        beside = s[NOISE_FLAG, i] == TOGGLED
        noise = MARGIN * (above if above > below else below) if s[NOISE_FLAG, i] == FOLDED else 0.0
        s[NOISE_FLAG, i] = noise if s[CERTAIN, i] > 0.0 else (SPURIOUS if beside else DOUBTFUL)


@outlined
def _drop(lists: Any, best: Any, column: int, k: int, many: int) -> None:
    """Take so many entries out of a list, from the k-th on."""
    best[COUNT, column] -= float(many)
    for j in range(k, int(best[COUNT, column])):
        for r in range(lists.shape[0]):
            lists[r, column, j] = lists[r, column, j + many]


@outlined
def _drop_doubtful(lists: Any, best: Any, column: int) -> None:
    """Take entries that may be no extremes out of a list, but for one between two of one kind."""
    n, last = int(best[COUNT, column]), -1
    for k in range(n):
        last = k if lists[LIST_NOISE, column, k] != DOUBTFUL else last
    before, extreme = lists[LIST_KIND, column, max(last, 0)], -1
    for step in range(1, n + 1 if last >= 0 else 1):
        beyond = last + step - n
        at = beyond if beyond >= 0 else last + step  # the turn goes on from the last entry to the first one
        kind, value = lists[LIST_KIND, column, at], lists[LIST_VALUE, column, at]
        if lists[LIST_NOISE, column, at] != DOUBTFUL:
            if extreme >= 0 and kind == before:
                lists[LIST_NOISE, column, extreme] = 0.0
            before, extreme = kind, -1
        elif kind == -before:
            other = lists[LIST_VALUE, column, max(extreme, 0)]
            extreme = at if extreme < 0 or kind * (value - other) > 0.0 else extreme
    for j in range(n - 1, -1, -1):
        if lists[LIST_NOISE, column, j] == DOUBTFUL:
            _drop(lists, best, column, j, 1)


@outlined
def thin(lists: Any, best: Any, first: int, last: int, room: int) -> None:
    """Take pairs of extremes out of the lists of a search that differ by rounding alone."""
    for column in range(first, last):
        n, noisy, doubtful = int(best[COUNT, column]), 0, 0
        for k in range(min(n, room)):
            noisy = noisy + (1 if lists[LIST_NOISE, column, k] > 0.0 else 0)
            doubtful = doubtful + (1 if lists[LIST_NOISE, column, k] == DOUBTFUL else 0)
        if ((doubtful > 0) | (n > room)) & (best.shape[0] > BEST_ROWS):
            best[UNDECIDED, column] = 1.0
        if (noisy + doubtful == 0) | (n > room):
            continue
        before = n
        if doubtful > 0:
            _drop_doubtful(lists, best, column)
        n = int(best[COUNT, column])
        # of the list: whether ends of the range count, too, hangs on what else is requested
        greatest, lowest = -INFINITY, INFINITY
        for k in range(n):
            greatest = max(greatest, lists[LIST_VALUE, column, k])
            lowest = min(lowest, lists[LIST_VALUE, column, k])
        pair = 0
        while pair >= 0:
            pair, least = -1, INFINITY
            for k in range(n - 1):
                value, after = lists[LIST_VALUE, column, k], lists[LIST_VALUE, column, k + 1]
                low, high = min(value, after), max(value, after)
                turns = lists[LIST_KIND, column, k] != lists[LIST_KIND, column, k + 1]
                one, other = lists[LIST_NOISE, column, k], lists[LIST_NOISE, column, k + 1]
                inner = (high < greatest) & (low > lowest)
                if turns & inner & (high - low <= min(one, other)) & (high - low < least):
                    pair, least = k, high - low
            if pair >= 0:
                n = n - 2
                _drop(lists, best, column, pair, 2)
        for k in range(n, before):
            lists[LIST_THETA, column, k] = NOT_A_NUMBER
            for r in range(LIST_VALUE, lists.shape[0]):
                lists[r, column, k] = 0.0 if r == LIST_KIND else NOT_A_NUMBER


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
        if best[UNDECIDED, column] > 0.0:
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

"""What samples do not show: ends of the range, toggles, folds octave by octave, kinks, cells to be divided.

Arrays are as in `fastlink.codegen.runtime.cells`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.codegen.runtime.cells import (
    BOUND,
    BRANCHES,
    CELLS,
    DESIGNS,
    F1,
    F2,
    FA,
    FB,
    FC,
    FINE,
    FINE_AT,
    FINE_SAMPLES,
    FIRST,
    GREATEST,
    HALF,
    HALVES,
    HAS_LIMIT,
    ITEM_ROWS,
    KIND,
    LANE,
    LANES,
    NUMBER,
    OPEN,
    ORDER,
    PARITY,
    PART,
    PARTS,
    ROOT,
    ROOTS,
    SIDES,
    SIGN,
    SLOPE,
    SLOPE_BOUND,
    START,
    STEPS,
    TOGGLE,
    TOLERANCE,
    UNRESOLVED,
    UNRESOLVED_CELL,
    UPPER,
    VALLEY,
    VALLEYS,
    VALUE,
    X1,
    X2,
    XA,
    XB,
    XC,
    F,
    X,
    append_item,
    append_of_lane,
    copy_row,
    evaluate_at,
    evaluate_items,
    first_of,
    is_certain,
    is_unresolved,
    mark,
    mark_undecided,
    padded,
    position_of,
    toggle_of,
)
from fastlink.numerics.compiler import inlined, lanes, merged, outlined
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, trailing_zeros

# -- Ends of the range: where a quantity may be extreme though its slope is not 0, and where it grows
#    without bound

# At a toggle a quantity has a limit or grows by its order. At a fold, where all bars of a change point are
# in line, it is a sum of powers of the distance x: it may have a pole there whose factor is as small as
# masses and loads are, so that nothing shows it but positions far closer.


# The first sample stands at 2^-60 of the scale. How much farther from a toggle a quantity is evaluated too, how much
# nearer to a fold, and how much greater it is there at least if it has a pole at the fold. At 2^-150 no power of an
# angle that is needed underflows; rounding errors leave no pole.
FARTHER, NEARER, GROWS = 2.0**30, 2.0**-90, 2.0**20
# How little a quantity changes from there to a toggle if it is finite.
STEADY = 2.0**-16


@inlined
def _is_fold(s: Any, i: Any, w: Any) -> Any:
    """Tell whether an item is the first sample beside a fold."""
    first = abs(first_of(w, s, i))
    return (toggle_of(w, s, i) == 0.0) & (first > 0.0) & (s[XA, i] == first)


@outlined
def values_beside(value: Any, s: Any, count: int, vectors: Any, w: Any) -> None:
    """Keep the values of a quantity farther from the ends of the range, at folds those nearer to them."""
    evaluate_at(value, s, count, vectors, XA, FARTHER)
    copy_row(s, count, F, VALUE)
    folds = 0
    for i in range(count):
        folds = 1 if _is_fold(s, i, w) else folds
    if folds > 0:
        evaluate_at(value, s, count, vectors, XA, NEARER)
        for i in range(count):
            s[F, i] = s[VALUE, i] if _is_fold(s, i, w) else s[F, i]


@outlined
def values_lost(value: Any, s: Any, count: int, vectors: Any, w: Any) -> None:
    """Evaluate a quantity without a value at a fold itself beside it: a limit, whose error nothing bounds."""
    lost = 0
    for i in range(count):
        first = abs(first_of(w, s, i))
        if s[VALUE, i] != s[VALUE, i] and s[X, i] == 0.0 and first > 0.0:
            s[X, i] = FARTHER * first
            lost = 1
    if lost > 0:
        evaluate_items(value, s, count, vectors)


@outlined
def end_values(s: Any, count: int, w: Any, search: Any) -> None:
    """Make values at ends of the range infinite where they grow towards a toggle or fold; an end is of no kind.

    At a toggle a quantity grows by its order, unless what grows has the factor 0, as the forces of links without mass:
    then it is the same at both positions. At a fold forces grow as 1/x or more where all bars are in line.
    """
    for i in range(count):
        s[KIND, i] = 0.0
        value, beside = s[VALUE, i], s[F, i]
        if search[ORDER] > 0 and value != 0.0:
            if _is_fold(s, i, w):
                s[VALUE, i] = beside * INFINITY if abs(beside) > GROWS * abs(value) else value
            elif toggle_of(w, s, i) > 0.0:
                s[VALUE, i] = value if abs(value - beside) <= STEADY * abs(beside) else value * INFINITY


@outlined
def collect_ends(w: Any, count: int, table: Any, search: Any, best: Any, ends: Any, every: int) -> int:
    """Make items of the ends of the range where they may be extreme: at toggles, and where there is no extremum.

    Of pieces it is every end: where two of them meet may be an extreme. An end counts where the first sample is; for a
    quantity with a value at the end itself, there, unless the position of the first sample is negative: nothing has a
    value at the end itself then.
    """
    total = 0
    for i in range(count):
        empty = every > 0
        for branch in range(table[BRANCHES]):
            column = (search[NUMBER] * table[BRANCHES] + branch) * LANES + i
            empty = empty or best[GREATEST, column] == -INFINITY
        for half in range(table[HALVES]):
            for upper in range(2):
                first = w[START + upper, i]
                if first != 0.0 or empty:
                    x = 0.0 if search[HAS_LIMIT] > 0 and first >= 0.0 else abs(first)
                    total = append_item(ends, total, i, half, upper == 1, x, 0.0, x, 0.0)
    return total


# -- Signs of the sampled function at toggles at which it vanishes

# What is finite at a toggle may have a slope that is a small difference of great numbers there: within
# 2^-26 of the scale its sign is nothing but rounding, and a wrong one at the last sample hides the extreme
# that follows. The value at a little distance stands for that at the toggle. Where both signs are certain
# there is an extreme between that is not looked for: it is in the error bounds of the greatest and least
# values.


# The function at a toggle over that at the next sample, below which it vanishes there.
SMALL = 2.0**-10
# At 2^-22 of the scale, so many times the distance of the last sample, an error of the slope's terms of one rounding is
# a thousandth of it; an extreme nearer than that is as great as the quantity at the toggle but for 2^-44 of its bend.
AWAY = 2.0**38
# A function at a toggle over that away from it, below which it may be rounding: at most 2^4 roundings of its terms. The
# zero that a greater one shows is beyond 2^-28 of the scale.
ROUNDED = 2.0**-6
# An extreme within a distance is off by less than what the quantity changes within so many times that: one of its
# square by an eighth, the kink of a magnitude that is linear in the square by a fourteenth.
BEYOND = 4.0
# While that is found, of the items of ends: the function at the first sample, then the quantity away from it; whether
# an extreme is between; the distance of the first sample.
NEAR, HIDES, DISTANCE = FA, FB, XC


@outlined
def collect_beside(
    w: Any, table: Any, part: Any, samples: Any, count: int, items: Any, at_folds: bool
) -> int:
    """Make items of the cells next to folds, or to toggles where the function vanishes; return how many there are.

    `XC` of an item is the row of the sample at its end.
    """
    total, cells = 0, part[CELLS]
    for upper in range(2):
        position = upper * (cells + 1)
        for half in range(table[HALVES]):
            first = part[FIRST] + half * (2 * cells + 1)
            end, inner = first + upper * 2 * cells, first + 1 + upper * (2 * cells - 2)
            for i in range(count):
                f, after = samples[end, i], samples[inner, i]
                is_fold = w[TOGGLE + upper, i] == 0.0
                vanishes = at_folds | (abs(f) <= SMALL * abs(after))
                if (w[START + upper, i] != 0.0) & (is_fold == at_folds) & vanishes:
                    a, b = samples[position, i], samples[position + 1, i]
                    items[XC, total] = end
                    total = append_item(items, total, i, half, upper == 1, a, f, b, after)
    return total


@outlined
def settle_toggles(slope: Any, s: Any, count: int, vectors: Any, samples: Any) -> None:
    """Give samples at toggles where the function vanishes the values beside them; 0 would be taken for a zero."""
    evaluate_at(slope, s, count, vectors, XA, AWAY)
    for i in range(count):
        row, lane, f = int(s[XC, i]), int(s[LANE, i]), s[F, i]
        if ((f < 0.0) | (f > 0.0)) & (abs(s[FA, i]) <= ROUNDED * abs(f)):
            samples[row, lane] = f


@outlined
def find_hidden(slope: Any, value: Any, s: Any, count: int, vectors: Any, w: Any) -> None:
    """Mark the ends of the range at toggles with an extreme beside them that is not looked for.

    The sign at the first sample is another than away from it, and is more than rounding.
    """
    for i in range(padded(count)):
        s[DISTANCE, i] = abs(first_of(w, s, i))
    evaluate_at(slope, s, count, vectors, DISTANCE, 1.0)
    copy_row(s, count, NEAR, F)
    evaluate_at(slope, s, count, vectors, DISTANCE, AWAY)
    total = 0
    for i in range(count):
        near, away = s[NEAR, i], s[F, i]
        turned = ((near < 0.0) & (away > 0.0)) | ((near > 0.0) & (away < 0.0))
        hides = turned & (toggle_of(w, s, i) != 0.0)
        s[HIDES, i] = 1.0 if hides else 0.0
        total = total + 1 if hides else total
    if total > 0:
        evaluate_at(value, s, count, vectors, DISTANCE, BEYOND * AWAY)
        copy_row(s, count, NEAR, VALUE)
        evaluate_at(value, s, count, vectors, DISTANCE, 1.0)
        for i in lanes(padded(count)):
            s[HIDES, i] = s[HIDES, i] if is_certain(s[SLOPE, i], s[SLOPE_BOUND, i]) else 0.0


@outlined
def bound_hidden(s: Any, count: int) -> None:
    """Add to the bounds of values at toggles how far an extreme beside is from them."""
    for i in lanes(padded(count)):
        s[BOUND, i] = s[BOUND, i] + abs(s[VALUE, i] - s[NEAR, i]) if s[HIDES, i] > 0.0 else s[BOUND, i]


# -- Places where the slope of a quantity jumps or has a kink, at which cells are split

# A load by the square of a rate changes its sign with the rate: the slope is a V there, which may dip below
# zero within a millionth of a cell. Neither the samples nor a parabola through them tell of it, and a
# search for the least magnitude ends above it. The function on both sides of the place itself tells:
# between such places it is smooth.


#: How many places of one design are kept; a rate is zero twice in a half of the range at most.
MOST_SPLITS = 32
# Both sides of a place, over it less 1: the least that none of both roundings takes away.
ASIDE = 2.0**-50
# The rounding of what vanishes there may hide a jump from places that close: 2^-46 is 64 roundings.
FARTHER_ASIDE = 2.0**-46
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
    """Keep the zeros at items, found by the search of this number, as far as their designs have room for them."""
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
            before, after = x * (1.0 - ASIDE), x * (1.0 + ASIDE)
            splits[XC, n] = number
            splits[FC, n] = splits[LAST, lane]
            splits[LAST, lane] = n
            half = int(s[HALF, i])
            splits[NEXT, 0] = append_item(
                splits, n, lane, half, upper, before, NOT_A_NUMBER, after, NOT_A_NUMBER
            )


@outlined
def forget_slopes(splits: Any) -> None:
    """Begin with a function that has kinks nowhere."""
    for n in range(LANES, int(splits[NEXT, 0])):
        splits[FA, n] = NOT_A_NUMBER


@outlined
def place_aside(s: Any, count: int, k: int) -> None:
    """Put items at one side of their places, nearer at first: rounding may hide which side of a jump that is."""
    off = (ASIDE if k < 2 else FARTHER_ASIDE) * (1.0 if k - ((k >> 1) << 1) == 0 else -1.0)
    for i in lanes(padded(count)):
        s[X, i] = s[XA, i] * (1.0 + off)


@outlined
def bound_aside(s: Any, count: int) -> None:
    """Add to the bounds of values beside jumps what these change on the way: a position by four parts of x."""
    for i in lanes(padded(count)):
        s[BOUND, i] = s[BOUND, i] + 8.0 * FARTHER_ASIDE * s[SLOPE, i]


# How far on either side of a place where a quantity may be infinite it is evaluated, over the distance of the place
# from the end of the range; how much greater it is nearer by at least: a simple pole makes it 1024 times as great, and
# the rounding of the place, 2^-51 of it, changes that by a part in 2^17.
FAR_FROM_POLE, NEAR_POLE, GROWS_AT_POLE = 2.0**-24, 2.0**-34, 2.0**5


# Nearer to the end of a range that goes on in another half is one place: the other side is there.
AT_SEAM = 2.0**-40


@outlined
def values_at_pole(
    value: Any, s: Any, count: int, vectors: Any, w: Any, table: Any, search: Any, turn: int
) -> None:
    """Keep the values at one side of places, farther and nearer, of a mirrored half those of the mirror."""
    if turn == 0:
        copy_row(s, count, XA, X)
        copy_row(s, count, XB, HALF)
    for k in range(3):
        off = FAR_FROM_POLE if k == 0 else (NEAR_POLE if k == 1 else 0.0)  # last at the places themselves
        for i in range(count):
            x, half = s[XA, i], int(s[XB, i])
            seam = (abs(x) < AT_SEAM) & (first_of(w, s, i) == 0.0)
            s[X, i] = off if seam and off > 0.0 else x * (1.0 + (off if turn == 0 else -off))
            s[HALF, i] = half ^ 1 if seam and turn > 0 and off > 0.0 else half
        if k < 2:
            evaluate_items(value, s, count, vectors)
            for i in lanes(padded(count)):
                mirrored = (table[SIDES] == 1) & (s[HALF, i] != s[XB, i])
                here = s[VALUE, i] * (float(search[PARITY]) if mirrored else 1.0)
                s[FA, i] = here if k == 0 else s[FA, i]
                s[FB, i] = here if k == 1 else s[FB, i]


@outlined
def pole_values(s: Any, count: int, w: Any, search: Any) -> None:
    """Make values infinite where they grow towards the place; others, whose quotient has a limit, do not count.

    What grows towards a toggle or fold is for `end_values` to tell.
    """
    for i in range(count):
        far, near = abs(s[FA, i]), abs(s[FB, i])
        grows = (near > GROWS_AT_POLE * far) | (near == INFINITY)
        grows = grows & (s[XA, i] >= 2.0 * abs(first_of(w, s, i)))
        s[VALUE, i] = s[FB, i] * INFINITY if grows else NOT_A_NUMBER
        s[BOUND, i] = INFINITY
        s[KIND, i] = 0.0 if grows else NOT_A_NUMBER


@outlined
def unlist_jumps(s: Any, count: int, splits: Any, numbers: Any) -> None:
    """Let no zero of the slope be an extreme where the quantity jumps or is infinite, at places of some searches."""
    for i in range(count):
        x, n = s[X, i], int(splits[LAST, int(s[LANE, i])])
        while n > 0:
            same = (splits[HALF, n] == s[HALF, i]) & (splits[UPPER, n] == s[UPPER, i])
            if same & (splits[XA, n] * (1.0 - ASIDE) <= x) & (x <= splits[XB, n] * (1.0 + ASIDE)):
                for k in range(numbers.size):
                    s[KIND, i] = 0.0 if splits[XC, n] == numbers[k] else s[KIND, i]
            n = int(splits[FC, n])


@outlined
def keep_slopes(slope: Any, s: Any, count: int, vectors: Any, splits: Any, start: int, split_by: Any) -> None:
    """Keep the function on both sides of the places, of which the items are those from `start` on.

    It has kinks at those alone that were found by searches whose numbers are in `split_by`.
    """
    for after in range(2):
        at, kept = (XB, FB) if after == 1 else (XA, FA)
        evaluate_at(slope, s, count, vectors, at, 1.0)
        for i in range(count):
            own = 0
            for k in range(split_by.size):
                own = 1 if s[XC, i] == split_by[k] else own
            splits[kept, start + i] = s[F, i] if own > 0 else NOT_A_NUMBER
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
    """Mark the samples that begin a cell of one half of the range where such places show more zeros than its ends."""
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
    """Make roots of the places in divided cells of one half of the range where the function jumps over zero."""
    for n in range(LANES, int(splits[NEXT, 0])):
        f, g, upper = splits[FA, n], splits[FB, n], splits[UPPER, n] > 0.0
        if (splits[PASSED, n] > 0.0) & (splits[HALF, n] == part[PART]) & ((f > 0.0) != (g > 0.0)):
            lane, half, a, b = int(splits[LANE, n]), part[PART], splits[XA, n], splits[XB, n]
            if upper:
                append_of_lane(roots, counts, ROOTS, lane, half, upper, b, g, a, f)
            else:
                append_of_lane(roots, counts, ROOTS, lane, half, upper, a, f, b, g)


# -- The cell next to a fold, octave by octave

# A quantity near a fold is a sum of powers of the distance x, negative ones among them, whose factors may
# differ by any power of ten: what it does there it may do at 1e-10 of the cell, where equally spaced
# samples show nothing, and the function that is searched, the slope times a power of x, is far below its
# value at the next sample anyway. Or a point far away swings round there, and the function is far above
# both. So it is sampled at half the distance, a quarter and so on, where one of a few of these octaves
# shows that it is worth it.
#
# Close to a fold the slope may be nothing but rounding. A smooth function changes by a millionth with its
# argument, rounding errors do as they like: signs count where the function stays what it is.


#: From the first sample, 2^-60 of the scale, to the second one, less than 2^-4 of it.
OCTAVES = 57
#: How often signs are tried.
TRIALS = 3
#: So many octaves tell whether all are sampled, every eighth one.
FEW, COARSE = 7, 8
# The function at the end over that at the next sample, where the octaves are sampled; or that of both over one between.
# Changes of the position by which signs are tried, and that of the function which rounding errors exceed.
STEP, CHANGE = 2.0**-20, 2.0**-8


@outlined
def evaluate_octave(function: Any, s: Any, count: int, vectors: Any, k: int, trial: int) -> None:
    """Evaluate a function at the second sample's position over 2^(k+1), or the first one's; of a trial, beside it."""
    times, beside = 0.5, 1.0 + (trial * trial) * STEP
    for _ in range(k):
        times = 0.5 * times
    for i in lanes(padded(count)):
        x, least = times * s[XB, i], s[XA, i]
        s[X, i] = beside * (x if x > least else least)
    evaluate_items(function, s, count, vectors)


@outlined
def _weigh_octaves(slope: Any, s: Any, count: int, vectors: Any) -> int:
    """Open the items whose octaves are sampled; return how many there are.

    The function is small at the end, or one of few octaves is of another sign than the next sample, or far greater than
    both ends.
    """
    for i in lanes(padded(count)):
        s[OPEN, i] = 1.0 if abs(s[FA, i]) <= SMALL * abs(s[FB, i]) else 0.0
    for k in range(FEW):
        evaluate_octave(slope, s, count, vectors, COARSE * k + (COARSE >> 1), 0)
        for i in lanes(padded(count)):
            f, end, after = s[F, i], abs(s[FA, i]), s[FB, i]
            most = end if end > abs(after) else abs(after)
            great = SMALL * abs(f) > most
            turned = ((f < 0.0) & (after > 0.0)) | ((f > 0.0) & (after < 0.0))
            s[OPEN, i] = 1.0 if great | turned else s[OPEN, i]
    total = 0
    for i in range(count):
        total = total + (1 if s[OPEN, i] > 0.0 else 0)
    return total


@outlined
def _sample_octaves(slope: Any, s: Any, count: int, vectors: Any, octaves: Any) -> None:
    """Keep the values of open items in all octaves; if one has both signs, those that are the same beside, else 0."""
    for trial in range(TRIALS + 1):
        wanted = trial == 0
        for i in range(count):
            for k in range(OCTAVES if trial > 0 else 0):
                f = octaves[k, i]
                wanted = wanted | ((f == f) & (f != 0.0) & ((f > 0.0) != (s[FB, i] > 0.0)))
        for k in range(OCTAVES if wanted else 0):
            evaluate_octave(slope, s, count, vectors, k, trial)
            for i in lanes(padded(count)):
                here, before = s[F, i], octaves[k, i]
                same = before if abs(here - before) <= CHANGE * abs(before) else 0.0
                octaves[k, i] = (here if s[OPEN, i] > 0.0 else 0.0) if trial == 0 else same


@merged
def _add_root(s: Any, i: int, counts: Any, roots: Any) -> int:
    """Make a root of an octave, or a part of one, if the function changes its sign; go on to its end; return if so."""
    x, before, place, f = s[X1, i], s[F1, i], s[X2, i], s[F2, i]
    turned = (f > 0.0) != (before > 0.0)
    if turned:
        lane, half, upper = int(s[LANE, i]), int(s[HALF, i]), s[UPPER, i] > 0.0
        if upper:
            append_of_lane(roots, counts, ROOTS, lane, half, upper, x, before, place, f)
        else:
            append_of_lane(roots, counts, ROOTS, lane, half, upper, place, f, x, before)
    s[X1, i] = place
    s[F1, i] = f
    return 1 if turned else 0


@outlined
def search_octaves(
    slope: Any,
    s: Any,
    count: int,
    vectors: Any,
    octaves: Any,
    counts: Any,
    roots: Any,
    splits: Any,
    marks: Any,
) -> None:
    """Make items of the octaves that hold a zero, in place of the cell: its end at the fold may be rounding."""
    if _weigh_octaves(slope, s, count, vectors) == 0:
        return
    _sample_octaves(slope, s, count, vectors, octaves)
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
        if found > 0:
            cell = int(s[XC, i]) - int(s[UPPER, i])
            marks[cell, lane] = 0
            marks[cell + 1, lane] = marks[cell + 1, lane] & (ROOT | UNRESOLVED_CELL)


# A slope that comes down to so little of itself with half the distance falls: as the distance itself it halves.
FALLING = 0.75
# While that is found: the slope at the place before that was certain, 0 before there is one; and whether it falls.
LAST_SLOPE, FALLS = TOLERANCE, STEPS


@outlined
def mark_hiding(value: Any, s: Any, count: int, vectors: Any, table: Any, search: Any, best: Any) -> None:
    """Mark the lists of cells that may hide an extreme next to the fold: the slope falls as far as it is certain."""
    for i in lanes(padded(count)):
        s[LAST_SLOPE, i] = 0.0
        s[FALLS, i] = 1.0  # as long as nothing is certain, an extreme may hide
    for k in range(OCTAVES):
        evaluate_octave(value, s, count, vectors, k, 0)
        for i in lanes(padded(count)):
            slope, last = s[SLOPE, i], s[LAST_SLOPE, i]
            certain = is_certain(slope, s[SLOPE_BOUND, i])
            falls = 1.0 if (slope < FALLING * last) | (last == 0.0) else 0.0
            s[FALLS, i] = falls if certain else s[FALLS, i]
            s[LAST_SLOPE, i] = slope if certain else FALLING * last
    for i in range(count):
        silenced = s[FA, i] != s[FA, i]
        if silenced | (s[FALLS, i] > 0.0):
            mark_undecided(best, table, search, int(s[LANE, i]), int(s[HALF, i]))


# -- Cells in which the samples cannot exclude further zeros, divided until they can

# Zeros hide where the function is not resolved: a pair between two samples of one sign, or three between samples of
# both signs. The fourth differences of the samples tell where: cubic interpolation between equally spaced samples is
# off by about 3/128 of them where they change little from sample to sample. It is an estimate, no bound: what leaves no
# trace in six samples stays unseen.


# Eight marks at once.
UNRESOLVED_CELLS = 0x0404040404040404

# The row of the state that tells which parts are divided again: free until a search for a least magnitude begins.
DIVIDED = STEPS
#: How often a cell is divided at most, into eighths: a double zero at a sample would go on for ever.
LEVELS = 4
#: A smooth function is unresolved in a few of the eight parts, beside what it hides; rounding errors are so in all.
MOST_UNRESOLVED = 5
# Of a fourth difference, 2.7 times the error of the cubic. At the 88 pairs that hid in 1.6 million searches of forces,
# the cubic came within 0.0132 of it to zero.
DOUBT = 0.0625


@inlined
def unresolved(before: Any, f0: Any, f1: Any, after: Any, fourth0: Any, fourth1: Any) -> Any:
    """Return the mark of a cell that may hold more zeros than its ends show; 0 for others.

    It is by the cubic through its ends and the samples beside.

    Of one sign: the cubic, which dips below both ends by at most an eighth of a second difference, comes nearer to zero
    than it may be off. Of both signs: it may turn back.
    """
    bend0, bend1 = abs(before - 2.0 * f0 + f1), abs(f0 - 2.0 * f1 + after)
    fourth0, fourth1 = abs(fourth0), abs(fourth1)
    turn = 0.5 * (bend0 if bend0 > bend1 else bend1) + (4.0 * DOUBT) * (
        fourth0 if fourth0 > fourth1 else fourth1
    )
    low, high = abs(f0), abs(f1)
    least = 4.0 * (low if low < high else high)
    is_doubtful = (abs(f1 - f0) if (f0 > 0.0) != (f1 > 0.0) else least) < turn
    return UNRESOLVED_CELL if is_doubtful else 0


@outlined
def mark_unresolved(samples: Any, marks: Any, part: Any, width: int) -> None:
    """Mark the samples that begin a cell which may hold more zeros than its ends show."""
    first, last = part[FIRST], part[FIRST] + 2 * part[CELLS]
    for j in range(first + 2, last - 2):
        for i in lanes(width):
            a, b, f0, f1 = samples[j - 2, i], samples[j - 1, i], samples[j, i], samples[j + 1, i]
            c, d = samples[j + 2, i], samples[j + 3, i]
            fourth0 = (a + c) - 4.0 * (b + f1) + 6.0 * f0
            fourth1 = (b + d) - 4.0 * (f0 + c) + 6.0 * f1
            marks[j, i] = marks[j, i] | unresolved(b, f0, f1, c, fourth0, fourth1)
    for upper in range(2):
        # the two cells at each end of the half, with the fourth difference of the five samples there
        end, step = (last, -1) if upper == 1 else (first, 1)
        at0, at1 = end - upper, end + step - upper
        for i in lanes(width):
            f0, f1, f2 = samples[end, i], samples[end + step, i], samples[end + 2 * step, i]
            f3, f4 = samples[end + 3 * step, i], samples[end + 4 * step, i]
            fourth = (f0 + f4) - 4.0 * (f1 + f3) + 6.0 * f2
            beyond = 4.0 * (f0 + f2) - 6.0 * f1 - f3
            marks[at0, i] = marks[at0, i] | unresolved(beyond, f0, f1, f2, fourth, fourth)
            marks[at1, i] = marks[at1, i] | unresolved(f0, f1, f2, f3, fourth, fourth)
    # a valley with an unresolved cell: both of its cells are divided
    for j in range(first + 1, last):
        for i in lanes(width):
            before, here = marks[j - 1, i], marks[j, i]
            both = (
                (here & VALLEY != 0)
                & ((before | here) & ROOT == 0)
                & ((before | here) & UNRESOLVED_CELL != 0)
            )
            flag = UNRESOLVED_CELL if both else 0
            marks[j - 1, i] = before | flag
            marks[j, i] = here | flag


@outlined
def collect_unresolved(
    samples: Any, marks: Any, part: Any, counts: Any, unresolved: Any, splits: Any
) -> None:
    """Make items of the unresolved cells of one half of the range, of parts of them where these are split."""
    first, cells, count = part[FIRST], part[CELLS], counts[DESIGNS]
    n_words = padded(count) >> 3
    for j in range(2 * cells):
        at, upper = first + j, j >= cells
        words = marks[at].view(np.int64)
        for k in range(n_words):
            word = words[k] & UNRESOLVED_CELLS
            while word != 0:
                shift = trailing_zeros(word) & 56
                word = word & (word - 1)
                lane = 8 * k + (shift >> 3)
                if lane >= count:
                    break
                a = position_of(samples, cells, j, upper, lane)
                b = position_of(samples, cells, j + 1, upper, lane)
                near, far = (XA if a < b else XB), (XB if a < b else XA)
                fa, owner, n = samples[at, lane], not is_unresolved(marks, part, j - 1, lane), 1
                while n > 0:
                    n = next_split(splits, lane, part[PART], upper, a, b)
                    x = splits[near, n] if n > 0 else b
                    f = splits[near + 1, n] if n > 0 else samples[at + 1, lane]
                    unresolved[XC, counts[UNRESOLVED]] = 1.0
                    unresolved[FC, counts[UNRESOLVED]] = part[SIGN] * (2.0 if owner else 1.0)
                    append_of_lane(unresolved, counts, UNRESOLVED, lane, part[PART], upper, a, fa, x, f)
                    a, fa, owner = splits[far, n], splits[far + 1, n], False
                    splits[PASSED, n] = 1.0  # of column 0, which is no place, too


@outlined
def _sample_fine(slope: Any, s: Any, count: int, vectors: Any) -> None:
    """Keep the values at the fine samples of items; of those beyond an end of the range, at their mirror images."""
    for k in range(FINE_SAMPLES):
        t = (k - 1) / PARTS
        for i in lanes(padded(count)):
            position = (1.0 - t) * s[XA, i] + t * s[XB, i]  # exact at both ends
            s[FINE_AT + k, i] = position
            s[X, i] = abs(position)
        evaluate_items(slope, s, count, vectors)
        copy_row(s, count, FINE + k, F)


@outlined
def _mark_fine(s: Any, count: int, marks: Any) -> None:
    """Mark the fine samples of items as `mark` and `mark_unresolved` do; extrapolate first beyond the ends."""
    width = padded(count)
    for i in lanes(width):
        # what the signs at the ends of a cell are was decided by its samples
        s[FINE + 1, i] = s[FA, i]
        s[FINE + PARTS + 1, i] = s[FB, i]
    for upper in range(2):
        end, step = (FINE_SAMPLES - 1, -1) if upper == 1 else (0, 1)
        f = FINE + end
        for i in lanes(width):
            cubic = (
                4.0 * (s[f + step, i] + s[f + 3 * step, i]) - 6.0 * s[f + 2 * step, i] - s[f + 4 * step, i]
            )
            s[f, i] = cubic if s[FINE_AT + end, i] < 0.0 else s[f, i]
    for k in range(1, PARTS + 2):
        f, after = FINE + k, FINE + min(k + 2, PARTS + 2)
        m0, m1 = FINE + min(max(k, 2), PARTS), FINE + min(max(k + 1, 2), PARTS)
        for i in lanes(width):
            a, b, c = s[f - 1, i], s[f, i], s[f + 1, i]
            fourth0 = (s[m0 - 2, i] + s[m0 + 2, i]) - 4.0 * (s[m0 - 1, i] + s[m0 + 1, i]) + 6.0 * s[m0, i]
            fourth1 = (s[m1 - 2, i] + s[m1 + 2, i]) - 4.0 * (s[m1 - 1, i] + s[m1 + 1, i]) + 6.0 * s[m1, i]
            one_sign = ((a > 0.0) == (b > 0.0)) & ((c > 0.0) == (b > 0.0))
            sign = 1.0 if s[FC, i] > 0.0 else -1.0
            flag = mark(a, b, c, sign) & (ROOT | VALLEY if one_sign else ROOT)
            marks[k, i] = flag | unresolved(a, b, c, s[after, i], fourth0, fourth1)


@merged
def _append_part(s: Any, i: int, k: int, to: int, items: Any, counts: Any, kind: int) -> None:
    """Make an item between two fine samples of a cell."""
    lane, half, upper = int(s[LANE, i]), int(s[HALF, i]), s[UPPER, i] > 0.0
    a, fa, b, fb = s[FINE_AT + k, i], s[FINE + k, i], s[FINE_AT + to, i], s[FINE + to, i]
    append_of_lane(items, counts, kind, lane, half, upper, a, fa, b, fb)


@outlined
def _divide(s: Any, count: int, marks: Any, counts: Any, items: Any) -> None:
    """Make items of the parts of cells that are divided again: unresolved ones, and those about a valley with one.

    A valley at an end of a cell may reach into another one that is divided, so its part is divided too. The parts are
    bits of `DIVIDED`.
    """
    for i in range(count):
        level, owner, parts, doubtful = int(s[XC, i]), abs(s[FC, i]) > 1.0, 0, 0
        for k in range(1, PARTS + 2):
            if marks[k, i] & UNRESOLVED_CELL != 0 and k <= PARTS:
                parts = parts | (1 << k)
                doubtful = doubtful + 1
        if marks[1, i] & VALLEY != 0 and not owner:
            parts = parts | 2
        if marks[PARTS + 1, i] & VALLEY != 0:
            parts = parts | (1 << PARTS)
        for k in range(1, PARTS + 2):
            both = 3 << (k - 1)
            if marks[k, i] & VALLEY != 0 and parts & both != 0:
                parts = parts | both
        parts = parts & ((2 << PARTS) - 2) if (level < LEVELS) & (doubtful <= MOST_UNRESOLVED) else 0
        s[DIVIDED, i] = parts
        for k in range(1, PARTS + 1):
            if (parts >> k) & 1 != 0:
                first = (parts >> (k - 1)) & 1 == 0 and (k > 1 or owner)
                items[XC, counts[UNRESOLVED]] = level + 1
                items[FC, counts[UNRESOLVED]] = (1.0 if s[FC, i] > 0.0 else -1.0) * (2.0 if first else 1.0)
                _append_part(s, i, k, k + 1, items, counts, UNRESOLVED)


@outlined
def divide_cells(
    slope: Any,
    s: Any,
    count: int,
    vectors: Any,
    marks: Any,
    counts: Any,
    items: Any,
    roots: Any,
    valleys: Any,
) -> None:
    """Make items of the zeros and valleys of cells by their fine samples, and of the parts that are divided again."""
    _sample_fine(slope, s, count, vectors)
    _mark_fine(s, count, marks)
    _divide(s, count, marks, counts, items)
    for i in range(count):
        parts, owner = int(s[DIVIDED, i]), abs(s[FC, i]) > 1.0
        for k in range(1, PARTS + 2):
            at = FINE_AT + k
            if marks[k, i] & VALLEY != 0 and (parts >> (k - 1)) & 3 == 0 and (k > 1 or owner):
                # at an end of the range the bracket begins at the end itself
                a, b = (0 if s[at - 1, i] < 0.0 else 1), (0 if s[at + 1, i] < 0.0 else 1)
                valleys[XC, counts[VALLEYS]] = s[at, i]
                valleys[FC, counts[VALLEYS]] = s[FINE + k, i]
                _append_part(s, i, k - a, k + b, valleys, counts, VALLEYS)
            if k <= PARTS and (parts >> k) & 1 == 0 and marks[k, i] & ROOT != 0:
                _append_part(s, i, k, k + 1, roots, counts, ROOTS)

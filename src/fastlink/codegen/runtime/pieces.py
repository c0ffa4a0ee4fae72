"""Pieces of the turn in which all loops of a mechanism close, cut gap by gap; what their extremes come to.

Each gap is a function of the input position that is not negative where its loop closes (`GradedRange.gaps`). Its zeros
in a piece of the range, and the least values next to which its root turns sharply, cut the piece; from the turn on, all
gaps do so one after the other. Pieces are columns, as lanes of a search are; afterwards the extremes of all pieces of
one design and branch are put together.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import (
    AT_GREATEST,
    AT_LEAST,
    BEST,
    BEST_ROWS,
    BOUND,
    CELLS,
    CODE,
    COUNT,
    FA,
    FB,
    FC,
    FIRST,
    GREATEST,
    GREATEST_BOUND,
    IMAGE,
    LANE,
    LANES,
    LEAST,
    LEAST_BOUND,
    LIST_THETA,
    PLACE,
    SLOPE_BOUND,
    THETA,
    TIE,
    UNDECIDED,
    VALUE,
    WINNER_ROWS,
    XC,
    F,
    append_item,
    evaluate_at,
    find_least,
    insert,
    note_best,
    padded,
    position_of,
)
from fastlink.numerics.compiler import AT_LIMIT, SMOOTH, TIED, lanes, merged, outlined
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, TWO_PI, sqrt

# Rows of pieces: the lane of the design, the branch by its place among the results and as a number, then the values of
# `fastlink.facts.fact.PIECE`.
OF_LANE, OF_COLUMN, BRANCH, LOW, WIDTH, OFF, END_LOW, END_HIGH = 0, 1, 2, 3, 4, 5, 6, 14
BY, GROWS, BENDS, ROUGH, NEAR, SCALE, FIRST_SAMPLE, IS_TOGGLE = range(8)
END_ROWS, PIECE_ROWS = 8, 22
# Rows of the zeros of a gap: the input position, slope, half the second derivative, how far off the place and the slope
# may be. Of least values: the input position, the value, and infinite errors where rounding alone tells its sign. The
# count of a lane is in the column after the last.
AT, SLOPE_AT, BEND_AT, OFF_AT, ROUGH_AT = range(5)
ZERO_ROWS, MOST_ZEROS = 5, 17
#: How many pieces there is room for, by design and branch.
MOST_PIECES = 8
#: Where the turn is cut anyway: at no place that symmetry gives an extreme.
SEAM = -0.7390851332151607
# The first sample beside a limit, over the scale; and the size of a least gap whose root turns within a fraction of a
# radian.
NEAR_LIMIT, SHARP = 2.0**-60, 2.0**-6
# The first sample beside a place where rounding decides whether a loop opens: nearer, gaps may be below zero.
NEAR_UNDECIDED = 2.0**-12
# A gap that is no deeper below zero, over that at the samples beside, may be so by rounding.
UNDECIDED_DEPTH = 2.0**-34
# Limits that are one place still have a scale.
TINY = 2.0**-60
# Within what distance of a limit, in rad, two terms of a gap's power series are nearer to it than its formula, which is
# off by some 2^-52: there the third is as small. Next to another limit, or another gap, it is within this part of the
# way, as the series may come to its end there.
SERIES, PART_OF_WAY = 2.0**-17, 2.0**-13
# Rows of what is found of a design in a branch: the length of all pieces, how many ends are limits, and how many ranges
# it moves through. Rows of a range: where it begins and ends, and the gaps that limit it there.
LENGTH, LIMITS, COUNT_OF_RANGES = range(3)
RANGE_ROWS, MOST_RANGES = 4, 16


@merged
def _set_end(pieces: Any, k: int, end: int, distance: float, width: float, whole: Any) -> None:
    """Write how samples are graded at an end of a piece, by how far beyond it the next sharp place is."""
    near, by = distance / width + TINY, pieces[end + BY, k]
    scale = sqrt(near / (1.0 + near)) if near < 1.0 else sqrt(0.5)
    way = width if whole else PART_OF_WAY * width
    pieces[end + NEAR, k] = way if way < SERIES else SERIES
    pieces[end + SCALE, k] = scale
    first = NEAR_LIMIT if by > 0.0 else (NEAR_UNDECIDED if pieces[end + ROUGH, k] == INFINITY else 0.0)
    pieces[end + FIRST_SAMPLE, k] = first * scale
    pieces[end + IS_TOGGLE, k] = 1.0 if by > 0.0 else 0.0


@outlined
def forget_zeros(zeros: Any, leasts: Any) -> None:
    """Begin with no zeros, and no least values."""
    for i in range(LANES):
        zeros[AT, i, MOST_ZEROS - 1] = 0.0
        leasts[AT, i, MOST_ZEROS - 1] = 0.0


@merged
def _keep(zeros: Any, lane: int, theta: float, slope: float, bend: float, off: float, rough: float) -> None:
    """Sort a zero or a least value into those of a piece, if there is room."""
    n = int(zeros[AT, lane, MOST_ZEROS - 1])
    if n < MOST_ZEROS - 1:
        k = n
        while k > 0 and zeros[AT, lane, k - 1] > theta:
            for r in range(ZERO_ROWS):
                zeros[r, lane, k] = zeros[r, lane, k - 1]
            k -= 1
        zeros[AT, lane, k] = theta
        zeros[SLOPE_AT, lane, k] = slope
        zeros[BEND_AT, lane, k] = bend
        zeros[OFF_AT, lane, k] = off
        zeros[ROUGH_AT, lane, k] = rough
        zeros[AT, lane, MOST_ZEROS - 1] = n + 1.0


@outlined
def keep_zeros(s: Any, count: int, zeros: Any, leasts: Any) -> None:
    """Sort the zeros at items into those of their pieces, with the slope, the second derivative and the error there.

    One of a pair between which the gap is no deeper below zero than its error is where a loop may open or only touch:
    it is kept as a least value, for by rounding both of a pair may be on one side of the true one.
    """
    for i in range(count):
        lane, theta, slope = int(s[LANE, i]), s[THETA, i], s[VALUE, i]
        depth = 0.5 * slope * slope / s[IMAGE, i] if s[IMAGE, i] > 0.0 else INFINITY
        if (depth <= 4.0 * s[BOUND, i]) & (depth <= UNDECIDED_DEPTH):
            _keep(leasts, lane, theta, s[BOUND, i], 0.0, INFINITY, INFINITY)
        elif slope == slope:
            off = s[BOUND, i] / abs(slope)
            _keep(zeros, lane, theta, slope, 0.5 * s[IMAGE, i], off, s[SLOPE_BOUND, i])


@outlined
def collect_leasts(samples: Any, part: Any, count: int, items: Any) -> int:
    """Make items of the cells about small least values of a gap; return how many there are."""
    cells, first, total = part[CELLS], part[FIRST], 0
    for j in range(1, 2 * cells):
        at, upper = first + j, j > cells
        for i in range(count):
            f = samples[at, i]
            if (f > 0.0) & (f < 2.0 * SHARP) & (f <= samples[at - 1, i]) & (f <= samples[at + 1, i]):
                a = position_of(samples, cells, j - 1, upper, i)
                b = position_of(samples, cells, j + 1, upper, i)
                items[XC, total] = position_of(samples, cells, j, upper, i)
                items[FC, total] = f
                before, after = samples[at - 1, i], samples[at + 1, i]
                total = append_item(items, total, i, 0, upper, a, before, b, after)
    return total


@outlined
def keep_leasts(slope: Any, value: Any, s: Any, count: int, vectors: Any, flags: Any, leasts: Any) -> None:
    """Sort the least values at items into those of their pieces, if the root of the gap turns sharply there.

    Below zero there are two zeros, which are found, unless the gap is that deep by rounding alone: then nothing decides
    whether the loop opens, and as little where the gap is within its error bound.
    """
    find_least(slope, s, count, vectors, flags)
    evaluate_at(value, s, count, vectors, XC, 1.0)
    for i in range(count):
        lane, least, deepest = int(s[LANE, i]), s[FC, i], max(abs(s[FA, i]), abs(s[FB, i]))
        flat = (s[F, i] <= 0.0) & (abs(s[F, i]) <= UNDECIDED_DEPTH * deepest)
        if (least > 0.0) & (least < SHARP) & ((s[F, i] > 0.0) | flat):
            off = INFINITY if flat | (least <= 2.0 * s[BOUND, i]) else 0.0
            _keep(leasts, lane, s[THETA, i], least, 0.0, off, INFINITY if flat else 0.0)


@outlined
def begin_pieces(pieces: Any, count: int, branches: Any) -> int:
    """Begin with the whole turn of each design in each branch; return how many pieces there are."""
    total = 0
    for i in range(count):
        for b in range(branches.size):
            pieces[OF_LANE, total] = i
            pieces[OF_COLUMN, total] = b
            pieces[BRANCH, total] = branches[b]
            pieces[LOW, total] = SEAM
            pieces[WIDTH, total] = TWO_PI
            pieces[OFF, total] = 0.0
            for end in range(END_LOW, PIECE_ROWS, END_ROWS):
                for r in range(END_ROWS):
                    pieces[end + r, total] = 0.0
                _set_end(pieces, total, end, TWO_PI, TWO_PI, False)
            total += 1
    return _fill(pieces, total)


@merged
def _fill(pieces: Any, total: int) -> int:
    """Repeat the last piece up to a whole vector; return how many there are."""
    if total > 0:
        for k in range(total, padded(total)):
            for r in range(PIECE_ROWS):
                pieces[r, k] = pieces[r, total - 1]
    return total


@outlined
def close_pieces(further: Any, total: int, pieces: Any) -> int:
    """Take the pieces that were cut in place of those before; return how many there are."""
    for r in range(PIECE_ROWS):
        for k in lanes(padded(total)):
            pieces[r, k] = further[r, k]
    return _fill(pieces, total)


@merged
def _end_piece(pieces: Any, p: int, further: Any, total: int, high: float, beyond: float) -> int:
    """End the piece under way, whose end is written; return how many there are, as far as there is room."""
    width = high - further[LOW, total]
    further[WIDTH, total] = width
    for r in range(3):
        further[r, total] = pieces[r, p]
    # what is beyond the lower end was kept in place of its scale
    whole = further[END_LOW + BY, total] == further[END_HIGH + BY, total]
    _set_end(further, total, END_LOW, further[END_LOW + SCALE, total], width, whole)
    _set_end(further, total, END_HIGH, beyond, width, whole)
    return total + 1 if (width > 0.0) & (total + 8 < further.shape[1]) else total


@merged
def _begin_piece(further: Any, total: int, low: float, beyond: float, off: float) -> None:
    """Begin a piece, whose lower end is written, which `_end_piece` ends."""
    further[LOW, total] = low
    further[OFF, total] = off
    further[END_LOW + SCALE, total] = beyond


@merged
def _copy_end(pieces: Any, p: int, further: Any, total: int, end: int) -> None:
    """Take over one end of a piece that was cut."""
    for r in range(END_ROWS):
        further[end + r, total] = pieces[end + r, p]


@merged
def _limit(further: Any, total: int, end: int, by: float, zeros: Any, i: int, z: int, rough: float) -> None:
    """Write what limits one end of a piece, a zero of a gap; nothing by 0, where it may be rough for ever."""
    further[end + BY, total] = by
    further[end + GROWS, total] = abs(zeros[SLOPE_AT, i, z])
    further[end + BENDS, total] = zeros[BEND_AT, i, z]
    further[end + ROUGH, total] = rough


@merged
def _beyond(pieces: Any, p: int, end: int) -> float:
    """Return how far beyond an end of a piece the next sharp place is, by its scale."""
    square = pieces[end + SCALE, p] * pieces[end + SCALE, p]
    return float(pieces[WIDTH, p] * (square / (1.0 - square)))


@outlined
def cut_pieces(
    pieces: Any,
    start: int,
    count: int,
    zeros: Any,
    leasts: Any,
    samples: Any,
    middle: int,
    gap: int,
    further: Any,
    total: int,
) -> int:
    """Cut pieces where a gap is zero, and at small least values of it; return how many there are.

    Without a zero the sample in row `middle` tells whether the loop closes in all of a piece.
    """
    for i in range(count):
        p = start + i
        low = pieces[LOW, p]
        high = low + pieces[WIDTH, p]
        n_zeros, n_leasts = int(zeros[AT, i, MOST_ZEROS - 1]), int(leasts[AT, i, MOST_ZEROS - 1])
        inside = zeros[SLOPE_AT, i, 0] < 0.0 if n_zeros > 0 else samples[middle, i] > 0.0
        _copy_end(pieces, p, further, total, END_LOW)
        _begin_piece(further, total, low, _beyond(pieces, p, END_LOW), pieces[OFF, p])
        z, m = 0, 0
        while z + m < n_zeros + n_leasts:
            is_zero = m >= n_leasts
            if (z < n_zeros) & (m < n_leasts):
                is_zero = zeros[AT, i, z] <= leasts[AT, i, m]
            if is_zero:
                theta, slope = zeros[AT, i, z], zeros[SLOPE_AT, i, z]
                before = theta - zeros[AT, i, max(z - 1, 0)] if z > 0 else TWO_PI
                after = zeros[AT, i, z + 1] - theta if z + 1 < n_zeros else TWO_PI
                off = zeros[OFF_AT, i, z]
                if inside & (slope < 0.0):
                    further[OFF, total] += off
                    _limit(further, total, END_HIGH, float(gap), zeros, i, z, zeros[ROUGH_AT, i, z])
                    total = _end_piece(pieces, p, further, total, theta, after)
                    inside = False
                elif (not inside) & (slope > 0.0):
                    _limit(further, total, END_LOW, float(gap), zeros, i, z, zeros[ROUGH_AT, i, z])
                    _begin_piece(further, total, theta, before, off)
                    inside = True
                z += 1
            else:
                theta, beyond = leasts[AT, i, m], 2.0 * sqrt(leasts[SLOPE_AT, i, m])
                near = (theta - further[LOW, total] <= beyond) & (further[END_LOW + BY, total] == 0.0)
                if (leasts[ROUGH_AT, i, m] > 0.0) & ((not inside) | near):  # also the second zero of a pair
                    _limit(further, total, END_LOW, 0.0, zeros, i, 0, leasts[ROUGH_AT, i, m])
                    _begin_piece(further, total, theta, beyond, INFINITY)
                    inside = True
                elif inside & (theta - further[LOW, total] > beyond):  # else it is found twice
                    further[OFF, total] += leasts[OFF_AT, i, m]
                    _limit(further, total, END_HIGH, 0.0, zeros, i, 0, leasts[ROUGH_AT, i, m])
                    total = _end_piece(pieces, p, further, total, theta, beyond)
                    _limit(further, total, END_LOW, 0.0, zeros, i, 0, leasts[ROUGH_AT, i, m])
                    _begin_piece(further, total, theta, beyond, leasts[OFF_AT, i, m])
                m += 1
        if inside:
            _copy_end(pieces, p, further, total, END_HIGH)
            further[OFF, total] += pieces[OFF, p]
            total = _end_piece(pieces, p, further, total, high, _beyond(pieces, p, END_HIGH))
    return total


@outlined
def clear_ranges(found: Any, ranges: Any) -> None:
    """Forget the ranges of the designs before."""
    for column in range(found.shape[1]):
        for r in range(found.shape[0]):
            found[r, column] = 0.0
        for r in range(RANGE_ROWS):
            for k in range(MOST_RANGES):
                ranges[r, column, k] = NOT_A_NUMBER if r < 2 else 0.0


@merged
def _in_turn(theta: float) -> float:
    """Return an input position in [0, 2 pi)."""
    turned = theta + TWO_PI if theta < 0.0 else theta
    return turned - TWO_PI if turned >= TWO_PI else turned


@outlined
def note_pieces(pieces: Any, count: int, found: Any, ranges: Any) -> None:
    """Note how much of the turn each design moves through in each branch, between which limits, and what limits it.

    Pieces that meet are one range; one that the seam cuts begins with the last piece and ends with the first.
    """
    for p in range(count):
        column = int(pieces[OF_COLUMN, p]) * LANES + int(pieces[OF_LANE, p])
        n = int(found[COUNT_OF_RANGES, column])
        found[LENGTH, column] += pieces[WIDTH, p]
        found[LIMITS, column] += pieces[END_LOW + IS_TOGGLE, p] + pieces[END_HIGH + IS_TOGGLE, p]
        if n < MOST_RANGES:
            if pieces[END_LOW + IS_TOGGLE, p] > 0.0:
                ranges[0, column, n] = _in_turn(pieces[LOW, p])
                ranges[2, column, n] = pieces[END_LOW + BY, p]
            if pieces[END_HIGH + IS_TOGGLE, p] > 0.0:
                ranges[1, column, n] = _in_turn(pieces[LOW, p] + pieces[WIDTH, p])
                ranges[3, column, n] = pieces[END_HIGH + BY, p]
                found[COUNT_OF_RANGES, column] = n + 1.0
    for i in range(found.shape[1]):
        last, first = int(found[COUNT_OF_RANGES, i]), ranges[0, i, 0]
        if (last > 0) & (last < MOST_RANGES) & (first != first):
            ranges[0, i, 0] = ranges[0, i, last]
            ranges[2, i, 0] = ranges[2, i, last]
            ranges[0, i, last] = NOT_A_NUMBER
            ranges[2, i, last] = 0.0


@outlined
def join_pieces(
    pieces: Any,
    start: int,
    count: int,
    branches: int,
    numbers: Any,
    lists: Any,
    best: Any,
    all_lists: Any,
    all_best: Any,
) -> None:
    """Put the extremes of pieces together with those of the pieces before of the same design and branch."""
    room = lists.shape[2]
    for n in range(numbers.size):
        for i in range(count):
            p, of = start + i, numbers[n] * LANES + i
            to = (numbers[n] * branches + int(pieces[OF_COLUMN, p])) * LANES + int(pieces[OF_LANE, p])
            for k in range(min(int(best[COUNT, of]), room)):
                theta = _in_turn(lists[LIST_THETA, of, k])
                j = insert(all_lists, to, int(all_best[COUNT, to]), theta, room)
                if j < room:
                    for r in range(lists.shape[0]):
                        all_lists[r, to, j] = lists[r, of, k]
                    all_lists[LIST_THETA, to, j] = theta
                all_best[COUNT, to] += 1.0
            if room == 0:
                all_best[COUNT, to] += best[COUNT, of]
            if best.shape[0] > BEST_ROWS:
                all_best[UNDECIDED, to] = max(all_best[UNDECIDED, to], best[UNDECIDED, of])
            if best[GREATEST, of] >= best[LEAST, of]:
                has_bounds = best.shape[0] > BEST_ROWS
                note_best(
                    all_best,
                    to,
                    best[GREATEST, of],
                    _in_turn(best[AT_GREATEST, of]),
                    best[GREATEST_BOUND, of] if has_bounds else 0.0,
                    best[LEAST, of],
                    _in_turn(best[AT_LEAST, of]),
                    best[LEAST_BOUND, of] if has_bounds else 0.0,
                )


@outlined
def join_winners(
    pieces: Any,
    start: int,
    count: int,
    branches: int,
    numbers: Any,
    winners: Any,
    gradients: Any,
    all_winners: Any,
    all_gradients: Any,
) -> None:
    """Put the places of extremes and the derivatives there together with those of the pieces before.

    A place at which two pieces meet is one; another one of the same value makes a tie.
    """
    half = gradients.shape[0] >> 1
    for n in range(numbers.size):
        for i in range(count):
            p, of = start + i, numbers[n] * LANES + i
            to = (numbers[n] * branches + int(pieces[OF_COLUMN, p])) * LANES + int(pieces[OF_LANE, p])
            for least in range(2):
                row = least * WINNER_ROWS
                value, best = winners[row + BEST, of], all_winners[row + BEST, to]
                apart = abs(winners[row + PLACE, of] - all_winners[row + PLACE, to])
                other = apart > TIE
                tied = (abs(value - best) <= TIE * abs(best)) & other & (best > -INFINITY)
                if value > best:
                    for r in range(WINNER_ROWS):
                        all_winners[row + r, to] = winners[row + r, of]
                    for r in range(half):
                        all_gradients[least * half + r, to] = gradients[least * half + r, of]
                code = all_winners[row + CODE, to]
                if tied & ((code == 1.0 * SMOOTH) | (code == 1.0 * AT_LIMIT)):
                    all_winners[row + CODE, to] = 1.0 * TIED


@outlined
def store_assembly(result: Any, first: int, count: int, found: Any, w: Any, valid: int) -> None:
    """Store how designs assemble over the turn: all of it, a part, nowhere, or with inputs that are none."""
    for i in range(count):
        for branch in range(result.shape[1]):
            column = branch * LANES + i
            part = 1 if found[LIMITS, column] > 0.0 else 0
            code = part if found[LENGTH, column] > 0.0 else 2
            result[first + i, branch] = code if w[valid, i] == 1.0 else 3

"""The search for extremes, item by item, and its results by design and branch.

An item is a cell of one design that holds a zero of one function. Items stand in lists, and `LANES` of them are worked
on at a time. The constants name the rows of arrays and the entries of the small tables that kernels call the functions
here with.

The zeros of a derivative come as items, each of one design, branch and side of the ground line. Where a quantity has a
mirror symmetry, a zero of one branch is one of the other branch too, at the mirror image of the input position.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.numerics.compiler import (
    AT_CHANGE_POINT,
    AT_LIMIT,
    CONSTANT,
    INFINITE,
    JUMP,
    KINK,
    NOTHING,
    SMOOTH,
    TIED,
    inlined,
    lanes,
    merged,
    outlined,
)
from fastlink.numerics.elementary import (
    ANGLE_ROUNDING,
    INFINITY,
    NOT_A_NUMBER,
    PI,
    TWO_PI,
    sine,
    sqrt,
    trailing_zeros,
)
from fastlink.numerics.vectors import magnitude

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
# Whether the slope changes its sign there beyond its error, and while that is sought the position, the slope, that of
# the side nearer to the end and the sign that is expected of it; in rows that the iteration has left.
CERTAIN, SAVED, FOUND, ONE_SIDE, EXPECTED = STEPS, XA, TOLERANCE, OPEN, XC
# Of a cell that is divided: the fine samples' positions, negative beyond an end of the range, and values there.
PARTS = 8
FINE_SAMPLES = PARTS + 3
FINE_AT, FINE = ITEM_ROWS + 13, ITEM_ROWS + 13 + FINE_SAMPLES
STATE_ROWS = FINE + FINE_SAMPLES
# Of the function at the ends of a valley: a dip that is no deeper is an inflection. Two zeros as close as 2^-20 of the
# valley leave that depth; their extremes differ by 2^-60 of the valley's rise, less than a rounding. The
# double zero of omega4 of 5, 3, 2, 2 leaves less than 2^-44.
FLAT = 2.0**-40
# The first rows of the lane values, of the lower end of the range; the upper end's follows each.
START, TOGGLE, SCALE = 0, 2, 4
# Entries of the table of a kernel: sides, halves and branches, and for each searched branch where its results go, and
# those of its mirror (-1 for nowhere).
SIDES, HALVES, BRANCHES, OWN, MIRROR = 0, 1, 2, 3, 5
# Entries of the table of a search: its number; the search that it adds to, itself or another; the power of 1/sigma by
# which the quantity grows at a toggle; what the mirror does to it; whether it has a value exactly at a toggle; whether
# it is for the places where an angle passes pi (1), or for a smooth part of what has kinks (-1); how many entries each
# of its lists of extremes has room for; how many
# valleys, roots and unresolved cells one design may have. None of these depends on the other searches.
NUMBER, ONTO, ORDER, PARITY, HAS_LIMIT, JUMPS, ROOM, MOST_VALLEYS = range(8)
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
def first_of(w: Any, s: Any, i: int) -> Any:
    """Return where the first sample is at the end of an item, negative if nothing has a value at the end itself."""
    return w[START + int(s[UPPER, i]), int(s[LANE, i])]


@merged
def toggle_of(w: Any, s: Any, i: int) -> Any:
    """Return what is positive if the end of an item is a toggle, 0 at a fold."""
    return w[TOGGLE + int(s[UPPER, i]), int(s[LANE, i])]


@merged
def append_item(
    items: Any, n: int, lane: int, half: int, upper: bool, a: float, fa: float, b: float, fb: float
) -> int:
    """Append an item with its bracket; return how many there are.

    There is room for all that smooth functions can ask for; beyond that, the last column is written again.
    """
    items[LANE, n] = lane
    items[HALF, n] = half
    items[UPPER, n] = 1.0 if upper else 0.0
    items[XA, n] = a
    items[FA, n] = fa
    items[XB, n] = b
    items[FB, n] = fb
    return n + 1 if n + MOST_LANES <= items.shape[1] else n


@merged
def append_of_lane(
    items: Any,
    counts: Any,
    kind: int,
    lane: int,
    half: int,
    upper: bool,
    a: float,
    fa: float,
    b: float,
    fb: float,
) -> None:
    """Append an item with its bracket to a list, unless its design has its share of the list already.

    A function that is constant but for rounding has zeros without end; what other designs find must not depend on them.
    """
    own, n = SHARES + (kind - 1) * LANES + lane, counts[kind]
    append_item(items, n, lane, half, upper, a, fa, b, fb)
    one = 1 if counts[own] < counts[MOST + (kind - 1)] else 0
    counts[own] = counts[own] + one
    counts[kind] = n + one


@outlined
def nothing_yet(counts: Any, search: Any) -> None:
    """Begin the lists of a search: no items of any kind, of no lane."""
    for k in range(VALLEYS, COUNTS):
        counts[k] = 0
    for k in range(MOST_ITEMS):
        counts[MOST + k] = search[MOST_VALLEYS + k]


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


@outlined
def evaluate_items(function: Any, s: Any, count: int, vectors: Any) -> None:
    """Evaluate a function at the positions of items."""
    function(s, vectors, every_vector(vectors, count))


@outlined
def evaluate_at(function: Any, s: Any, count: int, vectors: Any, row: int, times: float) -> None:
    """Put items at so many times the positions in a row of the state, and evaluate a function there."""
    for i in lanes(padded(count)):
        s[X, i] = times * s[row, i]
    evaluate_items(function, s, count, vectors)


@outlined
def copy_row(s: Any, count: int, row: int, of: int) -> None:
    """Copy a row of the state to another one."""
    for i in lanes(padded(count)):
        s[row, i] = s[of, i]


# -- Refine zeros and least magnitudes in their brackets, lane by lane: no item waits for another design


# 2 units in the last place of a position, and 2^-56 of the cell where the zero is at 0.
RELATIVE = 2.0**-51
ABSOLUTE = 2.0**-56
# A minimum is found to half the digits; closer pairs of zeros are not seen.
VALLEY_RELATIVE = 2.0**-26
# After this many steps a parabola is trusted that stays above half of the least magnitude.
TRUSTED_STEPS = 4
GOLDEN = 0.3819660112501051
# Bisection alone halves a cell to nothing in half as many; values that are no numbers must not go on for ever.
MOST_STEPS = 200


@outlined
def _refine(slope: Any, advance: Any, s: Any, open_ones: int, vectors: Any, flags: Any) -> None:
    """Take steps until no vector is open."""
    for _ in range(MOST_STEPS):
        if open_ones == 0:
            break
        slope(s, vectors, open_ones)
        open_ones = advance(s, vectors, open_ones, flags)


@outlined
def find_least(slope: Any, s: Any, count: int, vectors: Any, flags: Any) -> None:
    """Find where the magnitude of a function is least in each valley, or another sign of it."""
    width = padded(count)
    for i in lanes(width):
        low, high, c = s[XA, i], s[XB, i], s[XC, i]
        turned = high < low
        a, fa = (high if turned else low), (s[FB, i] if turned else s[FA, i])
        b, fb = (low if turned else high), (s[FA, i] if turned else s[FB, i])
        s[TOLERANCE, i] = ABSOLUTE * (low if turned else high)
        s[X, i] = c + GOLDEN * (b - c) if b - c > c - a else c + GOLDEN * (a - c)
        s[F, i] = 0.0
        s[X1, i] = a
        s[F1, i] = fa
        s[X2, i] = b
        s[F2, i] = fb
        s[STEPS, i] = 0.0
        s[OPEN, i] = 1.0
    _refine(slope, _advance_valleys, s, every_vector(vectors, count), vectors, flags)


@outlined
def find_roots(slope: Any, s: Any, count: int, vectors: Any, flags: Any) -> None:
    """Find the zero of a function in each bracket, which may be an end of it."""
    width = padded(count)
    for i in lanes(width):
        a, fa, b, fb = s[XA, i], s[FA, i], s[XB, i], s[FB, i]
        s[TOLERANCE, i] = ABSOLUTE * (b if b > a else a)
        t = fa / (fa - fb)
        t = 0.02 if t < 0.02 else t
        t = 0.98 if t > 0.98 else t
        exact = (fa == 0.0) | (fb == 0.0)
        s[X, i] = (a if fa == 0.0 else b) if exact else a + t * (b - a)
        s[F, i] = 0.0
        s[X1, i] = a
        s[F1, i] = fa
        s[X2, i] = b
        s[F2, i] = fb
        s[OPEN, i] = 0.0 if exact else 1.0
    still_open = _still_open(s, vectors, every_vector(vectors, count), flags)
    _refine(slope, _advance_roots, s, still_open, vectors, flags)


@outlined
def every_vector(vectors: Any, count: int) -> int:
    """List all vectors of so many items; return how many."""
    n = padded(count) >> 3
    for k in range(n):
        vectors[k] = k << 3
    return n


@outlined
def _still_open(s: Any, vectors: Any, n: int, flags: Any) -> int:
    """Keep the vectors with an open item; return how many."""
    words = flags.view(np.int64)
    n_open = 0
    for v in range(n):
        at = vectors[v]
        for i in lanes(MOST_LANES):
            flags[at + i] = 1 if s[OPEN, at + i] > 0.0 else 0
        if words[at >> 3] != 0:
            vectors[n_open] = at
            n_open += 1
    return n_open


@outlined
def _advance_roots(s: Any, vectors: Any, n: int, flags: Any) -> int:
    """Use the function's value at each position, choose the next; return how many vectors are open.

    One step of Chandrupatla's method: inverse quadratic interpolation where it is safe, else bisection.
    """
    for v in range(n):
        at = vectors[v]
        for i in lanes(MOST_LANES):
            x, f, x1, f1 = s[X, at + i], s[F, at + i], s[X1, at + i], s[F1, at + i]
            x2, f2 = s[X2, at + i], s[F2, at + i]
            same = (f > 0.0) == (f1 > 0.0)
            x3 = x1 if same else x2
            f3 = f1 if same else f2
            x2 = x2 if same else x1
            f2 = f2 if same else f1
            nearer = abs(f2) < abs(f)
            best = x2 if nearer else x
            best_f = f2 if nearer else f
            sum_of_four = x2 - x
            per_gap = 1.0 / sum_of_four
            limit = (RELATIVE * abs(best) + s[TOLERANCE, at + i]) * abs(per_gap)
            # Values over f2, so that nothing overflows.
            per_f2 = 1.0 / f2
            a, b = f * per_f2, f3 * per_f2
            per_b = 1.0 / (1.0 - b)
            xi = sum_of_four / (x2 - x3)
            phi = (1.0 - a) * per_b
            smooth = (phi * phi < xi) & ((1.0 - phi) * (1.0 - phi) < 1.0 - xi)
            skew = (x3 - x) * per_gap
            step = a * per_b * ((b * (b - a) - skew * (1.0 - a)) / ((1.0 - a) * (b - a)))
            t = step if smooth else 0.5
            t = t if t > limit else limit
            t = t if t < 1.0 - limit else 1.0 - limit
            done = (limit > 0.5) | (best_f == 0.0)
            next_x = best if done else x + t * sum_of_four
            is_open = s[OPEN, at + i]
            s[X, at + i] = next_x if is_open > 0.0 else x
            s[X1, at + i] = x
            s[F1, at + i] = f
            s[X2, at + i] = x2
            s[F2, at + i] = f2
            s[OPEN, at + i] = 0.0 if done else is_open
    return _still_open(s, vectors, n, flags)


@inlined
def _vertex(a: float, fa: float, c: float, fc: float, b: float, fb: float) -> float:
    """Return the least value of the parabola through three points of a valley."""
    left, right = (fc - fa) / (c - a), (fb - fc) / (b - c)
    bend = (right - left) / (b - a)
    slope = left + bend * (c - a)
    return fc - slope * slope / (4.0 * bend)


@outlined
def _advance_valleys(s: Any, vectors: Any, n: int, flags: Any) -> int:
    """Take a golden-section step towards the least magnitude; return how many vectors are open.

    An item is done where the sign changes.
    """
    for k in range(n * MOST_LANES):
        i = vectors[k >> 3] + (k & 7)
        if s[OPEN, i] == 0.0:
            continue
        a, b, c, fc, x, f = s[X1, i], s[X2, i], s[XC, i], s[FC, i], s[X, i], s[F, i]
        if (f > 0.0) != (fc > 0.0):
            s[OPEN, i] = 0.0
            continue
        # The outer of the two interior positions replaces the end on its side.
        inner, f_inner, outer, f_outer = (x, f, c, fc) if abs(f) < abs(fc) else (c, fc, x, f)
        if outer < inner:
            a = outer
            s[F1, i] = f_outer
        else:
            b = outer
            s[F2, i] = f_outer
        s[X1, i] = a
        s[X2, i] = b
        s[XC, i] = inner
        s[FC, i] = f_inner
        s[STEPS, i] += 1.0
        at_end = (inner == a) | (inner == b)
        least = 0.0 if at_end else _vertex(a, abs(s[F1, i]), inner, abs(f_inner), b, abs(s[F2, i]))
        high = s[STEPS, i] >= TRUSTED_STEPS and (at_end or least > 0.5 * abs(f_inner))
        if high or b - a <= VALLEY_RELATIVE * inner + s[TOLERANCE, i]:
            s[OPEN, i] = 0.0
            continue
        s[X, i] = inner + GOLDEN * (b - inner) if b - inner > inner - a else inner + GOLDEN * (a - inner)
    return _still_open(s, vectors, n, flags)


@outlined
def split_valleys(slope: Any, s: Any, count: int, vectors: Any, flags: Any, counts: Any, roots: Any) -> None:
    """Make two roots of each valley that has a value of the other sign in it, beyond rounding."""
    find_least(slope, s, count, vectors, flags)
    for i in range(count):
        x, f = s[X, i], s[F, i]
        deep = abs(f) > FLAT * max(abs(s[FA, i]), abs(s[FB, i]))
        if (f > 0.0) != (s[FC, i] > 0.0) and deep:
            lane, half, upper = int(s[LANE, i]), int(s[HALF, i]), s[UPPER, i] > 0.0
            append_of_lane(roots, counts, ROOTS, lane, half, upper, s[XA, i], s[FA, i], x, f)
            append_of_lane(roots, counts, ROOTS, lane, half, upper, x, f, s[XB, i], s[FB, i])


# -- Samples on the graded range, and the cells of it that hold a zero of a function

# Arrays are rows of `LANES` values; lanes are designs.


ROOT, VALLEY, UNRESOLVED_CELL = 1, 2, 4
# At 0.85 one pair of extremes of a rate in 10^6 was lost, at 1 a search takes a third longer.
SHALLOW = 0.97
# Of a derivative, over its terms: some ten roundings.
NOISE = 2.0**-50


@outlined
def place_samples(w: Any, samples: Any, cells: int, width: int) -> None:
    """Write the positions scale sinh(j h), j = 0 ... cells, of both ends; the last ones are one position."""
    beyond = cells + 1
    a, b, up, down = 2 * beyond, 2 * beyond + 1, 2 * beyond + 2, 2 * beyond + 3
    for i in lanes(width):
        g = 1.0 / sqrt(w[SCALE, i] * w[SCALE + 1, i])
        samples[a, i] = g + sqrt(g * g + 1.0)
        samples[up, i] = 1.0
        samples[down, i] = 1.0
    part = cells
    while part > 1:
        for i in lanes(width):
            samples[a, i] = sqrt(samples[a, i])
        part = part >> 1
    for i in lanes(width):
        samples[b, i] = 1.0 / samples[a, i]
    for j in range(1, cells + 1):
        for i in lanes(width):
            x = samples[up, i] * samples[a, i]
            y = samples[down, i] * samples[b, i]
            samples[up, i] = x
            samples[down, i] = y
            samples[j, i] = w[SCALE, i] * (0.5 * (x - y))
            samples[beyond + j, i] = w[SCALE + 1, i] * (0.5 * (x - y))
    for i in lanes(width):
        samples[0, i] = abs(w[START, i])
        samples[beyond, i] = abs(w[START + 1, i])


@inlined
def silenced(x: Any, y: Any) -> Any:
    """Return the values of a function in both branches, rounding errors made zero.

    The function is a mean and a part that changes sign with the branch; where one of them cancels the other, as in
    all of a parallelogram's motion, errors would look like zeros.
    """
    noise = NOISE * (abs(x) + abs(y))
    return 0.0 if abs(x) <= noise else x, 0.0 if abs(y) <= noise else y


@inlined
def flattened(before: Any, here: Any, after: Any, toggle: Any) -> Any:
    """Return the sample at an end of the range: with the sign of both neighbours where it is zero but for rounding.

    The function touches zero there. It comes to zero at a toggle, too, where a quantity grows less than its order says;
    the samples beside do not tell its sign there.
    """
    size, same = abs(here), (before > 0.0) == (after > 0.0)
    flat = same & (size <= FLAT * abs(before)) & (size <= FLAT * abs(after)) & (toggle == 0.0)
    return FLAT * after if flat else here


@inlined
def mark(a: Any, b: Any, c: Any, sign: Any) -> Any:
    """Return `ROOT` for a zero between the second of three samples and the third, `VALLEY` where two may hide about it.

    A valley: a parabola through the three values comes low, or the least of them lies well below both others; the dip
    may be narrower than a cell.
    """
    differ = ((sign * b > 0.0) != (sign * c > 0.0)) & (b == b) & (c == c)
    before, here, after = abs(a), abs(b), abs(c)
    least = (here <= before) & (here <= after) & (here > 0.0)
    bend = before - 2.0 * here + after
    low = (before - after) * (before - after) > here * bend
    deep = (here < SHALLOW * before) & (here < SHALLOW * after)
    return (ROOT if differ else 0) + (VALLEY if least & (low | deep) else 0)


@outlined
def mark_ends(w: Any, samples: Any, marks: Any, part: Any, width: int) -> None:
    """Mark the first and the last sample of one half of the range, which other halves continue."""
    sign, along = float(part[SIGN]), float(part[CONTINUED])
    first, last = part[FIRST], part[FIRST] + 2 * part[CELLS]
    beyond, continued = part[BEYOND] + 1, part[BEYOND] + 2 * part[CELLS] - 1
    for i in lanes(width):
        before, after = along * samples[beyond, i], samples[first + 1, i]
        here = flattened(before, samples[first, i], after, w[TOGGLE, i])
        samples[first, i] = here
        marks[first, i] = mark(before, here, after, sign)
    for i in lanes(width):
        inner, before, after = samples[last - 2, i], samples[last - 1, i], along * samples[continued, i]
        here = flattened(after, samples[last, i], before, w[TOGGLE + 1, i])
        samples[last, i] = here
        marks[last - 1, i] = mark(inner, before, here, sign)
        marks[last, i] = mark(before, here, after, sign)


@merged
def position_of(samples: Any, cells: int, j: int, upper: bool, lane: int) -> float:
    """Return the position of a sample from the lower end, or from the upper one."""
    if upper:
        return float(samples[3 * cells + 1 - j, lane])
    if j <= cells:
        return float(samples[j, lane])
    return 1.0 / float(samples[3 * cells + 1 - j, lane])


@merged
def _add_root(samples: Any, part: Any, j: int, lane: int, counts: Any, roots: Any) -> None:
    """Make an item of the cell that begins with a sample."""
    cells = part[CELLS]
    at, upper = part[FIRST] + j, j >= cells
    a, b = position_of(samples, cells, j, upper, lane), position_of(samples, cells, j + 1, upper, lane)
    fa, fb = samples[at, lane], samples[at + 1, lane]
    append_of_lane(roots, counts, ROOTS, lane, part[PART], upper, a, fa, b, fb)


@merged
def is_unresolved(marks: Any, part: Any, j: int, lane: int) -> Any:
    """Tell whether the cell that begins with a sample is divided; there is none beyond the ends."""
    if (j < 0) | (j >= 2 * part[CELLS]):
        return False
    return marks[part[FIRST] + j, lane] & UNRESOLVED_CELL != 0


@merged
def _add_valley(samples: Any, part: Any, j: int, lane: int, counts: Any, valleys: Any) -> None:
    """Make an item of the cells about a sample, if the function has one sign at their ends."""
    cells, first, n = part[CELLS], part[FIRST], counts[VALLEYS]
    left, right = max(j - 1, 0), min(j + 1, 2 * cells)
    fa, fb, middle = samples[first + left, lane], samples[first + right, lane], samples[first + j, lane]
    if (fa > 0.0) == (middle > 0.0) and (fb > 0.0) == (middle > 0.0):
        upper = left >= cells
        a, b = position_of(samples, cells, left, upper, lane), position_of(samples, cells, right, upper, lane)
        valleys[XC, n] = position_of(samples, cells, j, upper, lane)
        valleys[FC, n] = middle
        append_of_lane(valleys, counts, VALLEYS, lane, part[PART], upper, a, fa, b, fb)


@outlined
def collect(samples: Any, marks: Any, part: Any, counts: Any, roots: Any, valleys: Any) -> None:
    """Make items of the cells of one half of the range that hold a zero or may hold two, but for unresolved ones."""
    first, last, count = part[FIRST], 2 * part[CELLS], counts[DESIGNS]
    n_words = padded(count) >> 3
    for j in range(last + 1):
        # Eight marks at once: most are none.
        words = marks[first + j].view(np.int64)
        for k in range(n_words):
            word = words[k]
            while word != 0:
                shift = trailing_zeros(word) & 56
                flag = (word >> shift) & (ROOT | VALLEY | UNRESOLVED_CELL)
                word = word ^ (flag << shift)
                lane = 8 * k + (shift >> 3)
                if lane >= count:
                    break
                if flag & UNRESOLVED_CELL != 0:
                    continue
                if flag & ROOT and j < last:
                    _add_root(samples, part, j, lane, counts, roots)
                if flag & VALLEY and not is_unresolved(marks, part, j - 1, lane):
                    _add_valley(samples, part, j, lane, counts, valleys)


# -- Error bounds of extrema, where they are requested

# Every position x of the graded range is one of the reachable range. So the exact quantity at an x that was
# found, which is within its error bound E of the computed value, is never beyond the extreme; it may fall
# short of it, as x is not the exact place.
#
# - At a zero of the slope s, the exact slope is at most S = |s| + E_s, with the error bound E_s of the
# slope: x is off by at most S/|b|, b being the second derivative, and the value by half of S S/|b|. Twice
# that is added, as b changes on the way and has an error of its own. Where two extremes are about to meet,
# or one is flat, b differs on the way, and the value is off by a power of S beyond the first (4/3 for an
# extreme like x^4): a thousandth of E. - Where b vanishes, s is within E_s: the value is off by at most 2
# E_s times half a turn. At a kink s is far from zero on both sides; its place is known to 2^-51 of x, less
# than 2^-48 in the input position, or to where rounding hides which side it is on, by E. - The magnitude of
# a vector that almost vanishes has a kink, too. A least magnitude f is off by at most the greater of E and
# f, as the exact one is between 0 and f + E. - An end of the range counts at x = 0, which is exact; or at a
# first sample x = 2^-60 r beside a toggle or a fold, for quantities that have no value at the toggle
# itself. In x they are smooth there, and the input position changes by less than 4 x. The value is off by
# at most 8 x |s|; beside a toggle, where it may change as c x and s grows as 1/x, by c x = s s/|b|. What is
# infinite at a toggle has no bound, nor has what grows as 1/x or more towards a fold: |b| x^2 is at least
# half of it, then. - Beside a toggle at which the slope vanishes an extreme may stand that is not looked
# for (`beside.find_hidden`): the value at the toggle is off by at most what the quantity changes within four times the
# distance of that. - Where a quantity has a limit at a fold but no value there in doubles, that at 2^-30 of
# the scale stands for it, and has no bound. - Where no slope changes its sign, a place in the middle of the
# turn stands for the extreme. If its slope is within its error bound the quantity is constant but for
# rounding: off by at most S times half a turn on each side. - A jump by a whole turn is at pi, which is off
# by its own rounding. - Where a gap counts as zero within the rounding of the lengths, others may stand
# next to the fold for the lengths as given: nothing bounds them.


# For what the powers of E_s beyond the first come to, and for the roundings of the bound itself.
MARGIN = 1.0 + 2.0**-10
# Of pi in doubles, 1.2e-16: half of its last place is 2^-52.
OF_PI = 2.0**-52
# The place of a kink.
OF_PLACE = 2.0**-48
# At a kink rounding may hide the sign of a slope that is far beyond that of rounding, and no step leads to its zero.
STEEP, FAR = 2.0**20, 2.0**-7
# An end of an arc is found within some roundings of half its distance from the middle.
ARC_ROUNDING = 2.0**-48
# A slope is certain where it is so many times as great as its error bound.
TIMES = 2.0


@inlined
def known(bound: Any) -> Any:
    """Return a bound, infinite where it is not a number."""
    return bound if bound >= 0.0 else INFINITY


@inlined
def is_certain(slope: Any, slope_bound: Any) -> Any:
    """Tell whether the sign of a slope of some size is more than rounding."""
    return slope > TIMES * slope_bound


@inlined
def bound_at_zero(bound: Any, slope: Any, slope_bound: Any, bend: Any) -> Any:
    """Return the bound of a value, and what its place is off, at a zero of the slope."""
    own, steep = MARGIN * bound, slope + slope_bound
    kink = (steep > STEEP * own) & (steep > FAR * bend)
    off = steep * (steep / bend)
    most = own + (OF_PLACE * slope + (0.0 if kink else TWO_PI * slope_bound))
    total = own + (off if off < most else most)
    return own, total


@inlined
def off_at_end(x: Any, slope: Any, slope_bound: Any, bend: Any, first: Any) -> Any:
    """Return what the place of a value at an end of the range is off, where the first sample is."""
    off, beside = 8.0 * x * slope, 4.0 * slope * (slope / bend)
    off = 0.0 if x == 0.0 else (beside if beside < off else off)
    return PI * (slope + slope_bound) if (first == 0.0) & (slope <= slope_bound) else off


@inlined
def has_no_bound(x: Any, size: Any, bend: Any, first: Any, toggle: Any) -> Any:
    """Tell whether a value at an end of the range is infinite, grows towards a fold, or stands for a limit."""
    pole = (toggle == 0.0) & (x > 0.0) & (size > 0.0) & (4.0 * (bend * (x * x)) >= size)
    return (size == INFINITY) | pole | (x > 2.0 * abs(first))


@outlined
def bound_zeros(s: Any, count: int, search: Any, magnitude: int) -> None:
    """Add to the bounds of values at zeros of the slope what the places are off."""
    if search[JUMPS] > 0:
        for i in lanes(padded(count)):
            s[BOUND, i] = OF_PI
    else:
        for i in lanes(padded(count)):
            value = s[VALUE, i]
            own, bound = bound_at_zero(s[BOUND, i], s[SLOPE, i], s[SLOPE_BOUND, i], s[BEND, i])
            # not a number where the value is exactly 0
            least = (magnitude > 0) & (s[KIND, i] < 0.0) & ((bound > value) | (bound != bound))
            s[BOUND, i] = known((value if value > own else own) if least else bound)


@outlined
def bound_ends(s: Any, count: int, w: Any) -> None:
    """Add to the bounds of values at ends of the range what the places are off."""
    for i in range(count):
        first, toggle = first_of(w, s, i), toggle_of(w, s, i)
        x, size, bend = s[X, i], abs(s[VALUE, i]), s[BEND, i]
        total = known(MARGIN * s[BOUND, i] + off_at_end(x, s[SLOPE, i], s[SLOPE_BOUND, i], bend, first))
        s[BOUND, i] = INFINITY if has_no_bound(x, size, bend, first, toggle) else total


@inlined
def of_better(best: Any, best_bound: Any, value: Any, bound: Any) -> Any:
    """Return the error bound of the better of two candidates for an extreme, of which the other may be it.

    Each extreme lies within the bound of its own candidate, so that the outermost of all lies within that of the best
    candidate, or beyond it by at most what the bound of another exceeds the distance of both values.
    """
    ahead = value - best
    own = bound if ahead > 0.0 else best_bound
    other = best_bound if ahead > 0.0 else bound
    reach = other - abs(ahead)
    return reach if reach > own else own


# Rows of the lists: an extremum's position, value and kind; where error bounds are requested, that of the value.
LIST_THETA, LIST_VALUE, LIST_KIND, LIST_BOUND = range(4)
LIST_ROWS = 3
LIST_ROW_OF = {"position": LIST_THETA, "value": LIST_VALUE, "kind": LIST_KIND, "error": LIST_BOUND}
# Rows of the best: greatest and least value with their positions, and how many extrema there are; where error bounds
# are requested, those of both, and whether the list of extremes is undecided.
GREATEST, AT_GREATEST, LEAST, AT_LEAST, COUNT, GREATEST_BOUND, LEAST_BOUND, UNDECIDED = range(8)
BEST_ROWS = 5
ROWS_OF_GREATEST = GREATEST, AT_GREATEST, GREATEST_BOUND
ROWS_OF_LEAST = LEAST, AT_LEAST, LEAST_BOUND
# Zeros of a slope within so many distances of the first sample from a fold are the fold itself, which is listed no more
# than a toggle: towards a pole the sampled function falls with a power of the distance, and looks like zero there.
FOLDED = 2.0**8
# An extreme within 2^-26 of the scale from a toggle is as great as the quantity at the toggle to a rounding, where
# that is finite; the slope is a small difference of great numbers there, which changes its sign as it likes.
TOGGLED = 2.0**34


@outlined
def clear(lists: Any, best: Any) -> None:
    """Forget the extrema of the designs before."""
    for r in range(lists.shape[0]):
        for column in range(lists.shape[1]):
            for k in range(lists.shape[2]):
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
def insert(lists: Any, column: int, count: int, theta: float, room: int) -> int:
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


@inlined
def within_arc(value: Any, theta: Any, middle: Any, reach: Any) -> Any:
    """Return a value at a position, NaN outside of an arc; `reach` is the sine of a quarter of its length."""
    half = 0.5 * (theta - middle)
    return value if abs(sine(half)) <= reach + ARC_ROUNDING else NOT_A_NUMBER


@outlined
def extrema_at_zeros(s: Any, count: int, table: Any, search: Any) -> None:
    """Find of what kind the extremum at each zero is: 1 for a maximum, -1 for a minimum; 0 and pi where an angle jumps.

    A zero of another slope is of no kind.
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
            s[KIND, i] = 0.0 if abs(s[VALUE, i]) >= 1.0 else NOT_A_NUMBER
            s[VALUE, i] = PI


@outlined
def drop_folds(s: Any, count: int, w: Any, search: Any) -> None:
    """Drop extrema that are nothing but the end of the range at a fold or toggle, or have no value."""
    # a quantity that grows towards a toggle has no value there
    of_toggle = TOGGLED if search[ORDER] == 0 else 0.0
    for i in range(count):
        is_end = s[X, i] < (FOLDED if toggle_of(w, s, i) == 0.0 else of_toggle) * abs(first_of(w, s, i))
        if (is_end and s[KIND, i] != 0.0) or s[VALUE, i] != s[VALUE, i]:
            s[KIND, i] = NOT_A_NUMBER


@merged
def column_of(table: Any, search: int, lane: int, half: int, mirror: int) -> int:
    """Return the column of the results of a search that a half of a design is for, or its mirror image; -1 for none."""
    branch = half >> (table[SIDES] - 1)
    target = table[MIRROR + branch] if mirror == 1 else table[OWN + branch]
    return (search * table[BRANCHES] + target) * LANES + lane if target >= 0 else -1


@merged
def note_best(
    best: Any,
    column: int,
    greatest: float,
    at_greatest: float,
    bound: float,
    least: float,
    at_least: float,
    least_bound: float,
) -> None:
    """Take over a greatest and a least value, with their positions and error bounds, where they are better."""
    if best.shape[0] > BEST_ROWS:
        high, low = best[GREATEST_BOUND, column], best[LEAST_BOUND, column]
        best[GREATEST_BOUND, column] = of_better(best[GREATEST, column], high, greatest, bound)
        best[LEAST_BOUND, column] = of_better(-best[LEAST, column], low, -least, least_bound)
    if greatest > best[GREATEST, column]:
        best[GREATEST, column] = greatest
        best[AT_GREATEST, column] = at_greatest
    if least < best[LEAST, column]:
        best[LEAST, column] = least
        best[AT_LEAST, column] = at_least


@outlined
def store_extrema(s: Any, count: int, table: Any, search: Any, lists: Any, best: Any) -> None:
    """Sort the extrema at items into the results of their design, each for its own branch, then for the mirror's."""
    parity, jumps, room = float(search[PARITY]), search[JUMPS] > 0, search[ROOM]
    for i in range(count):
        value, theta, kind, bound = s[VALUE, i], s[THETA, i], s[KIND, i], s[BOUND, i]
        if kind != kind:
            continue
        for mirror in range(2):
            column = column_of(table, search[ONTO], int(s[LANE, i]), int(s[HALF, i]), mirror)
            if column < 0:
                continue
            if mirror == 1:
                theta = s[IMAGE, i]
                if not jumps:
                    value = parity * value
                kind = parity * kind
            if (kind != 0.0) & (room > 0):
                if s[CERTAIN, i] > 0.0:
                    k = insert(lists, column, int(best[COUNT, column]), theta, room)
                    if k < room:
                        lists[LIST_THETA, column, k] = theta
                        lists[LIST_VALUE, column, k] = value
                        lists[LIST_KIND, column, k] = kind
                        if lists.shape[0] > LIST_BOUND:
                            lists[LIST_BOUND, column, k] = bound
                    best[COUNT, column] += 1.0
                elif best.shape[0] > BEST_ROWS:
                    best[UNDECIDED, column] = 1.0
            note_best(best, column, value, theta, bound, -PI if jumps else value, theta, bound)


@outlined
def doubt(w: Any, row: int, count: int, lists: Any, best: Any) -> None:
    """Make the bounds of all extremes of designs infinite where a lane value is positive."""
    for i in range(count):
        if w[row, i] > 0.0:
            for column in range(i, best.shape[1], LANES):
                for r in range(BEST_ROWS, UNDECIDED):
                    best[r, column] = INFINITY
                if lists.shape[0] > LIST_BOUND:
                    for k in range(lists.shape[2]):
                        lists[LIST_BOUND, column, k] = lists[LIST_BOUND, column, k] + INFINITY


@outlined
def store_list(result: Any, first: int, count: int, base: int, lists: Any, row: int, beyond: float) -> None:
    """Copy a list of each design and branch; what stands beyond the room of lists is given."""
    for i in range(count):
        for branch in range(result.shape[1]):
            for k in range(result.shape[2]):
                value = lists[row, base + branch * LANES + i, k] if k < lists.shape[2] else beyond
                result[first + i, branch, k] = value


@outlined
def store_counts(result: Any, first: int, count: int, base: int, best: Any) -> None:
    """Copy how many extrema there are."""
    for i in range(count):
        for branch in range(result.shape[1]):
            result[first + i, branch] = min(int(best[COUNT, base + branch * LANES + i]), 127)


@outlined
def store_best(result: Any, first: int, count: int, base: int, best: Any, row: int, at: int) -> None:
    """Copy a greatest or least value, its position (`at`) or its error bound; NaN where there is none."""
    for i in range(count):
        for branch in range(result.shape[1]):
            column = base + branch * LANES + i
            theta = best[at, column]
            result[first + i, branch] = best[row, column] if theta == theta else NOT_A_NUMBER


# -- Where the greatest and the least value of a search are, for their derivatives by the inputs if these
#    are requested

# Two places for each design, branch and search: of the greatest value, and of the least one with its sign
# changed. Derivatives are evaluated there, once for each, lanes being designs: at the input position that
# was found; at a limit of motion beside it, at 2^-60 of the scale, with the place kept at that distance
# from the limit.


# Rows of a place: the value (of a least one with its sign changed), the input position, the place in the range, whether
# it is of a mirror image, its kind; the next best value elsewhere; the code of what derivatives there are worth; and
# whether these are taken at one input position, along with a limit of motion, or not at all (0).
BEST, PLACE, AT_X, IN_HALF, IN_UPPER, MIRRORED, OF_KIND, SECOND, CODE, WHERE = range(10)
WINNER_ROWS = 10
HELD, ALONG = 1.0, 2.0
#: Entries of the table of a change by tolerances: see `store_change`.
COLUMN, SQUARES, WINNERS, TERMS = range(4)
#: The kinds of a jump by a full turn, and of a place where a quotient is divided by almost nothing and has its extreme
#: beside it; an end of the range has kind 0.
TURN, NEARLY_POLE = 2.0, 3.0
# A zero is found to 2^-51 of its place: there a slope without a jump is below this part of that at the bracket's ends.
KINKED = 2.0**-20
# An angle whose sine is 0 is within some roundings of 0 or pi.
FOLD = 2.0**-46
# Input positions that are nearer are one place; values that differ by less tie.
SAME, TIE = 2.0**-20, 2.0**-40


@outlined
def forget_winners(winners: Any, gradients: Any) -> None:
    """Forget the places of the designs before, and the derivatives there."""
    for least in range(2):
        row = least * WINNER_ROWS
        for i in lanes(winners.shape[1]):
            winners[row + BEST, i] = -INFINITY
            winners[row + SECOND, i] = -INFINITY
            winners[row + PLACE, i] = NOT_A_NUMBER
            winners[row + OF_KIND, i] = NOT_A_NUMBER
    for r in range(gradients.shape[0]):
        for i in lanes(gradients.shape[1]):
            gradients[r, i] = NOT_A_NUMBER


@inlined
def next_best(best: Any, second: Any, place: Any, value: Any, theta: Any) -> Any:
    """Return the next best value at another place than the best, once one more value counts."""
    apart = abs(theta - place)
    same = (apart < SAME) | (abs(apart - TWO_PI) < SAME)
    ahead, behind = (second if same else best), (second if same else value)
    return ahead if value > best else (behind if value > second else second)


@outlined
def note_winners(s: Any, count: int, table: Any, search: Any, winners: Any, signs: Any) -> None:
    """Keep the places of the extrema at items that are the greatest or least so far, see `store_extrema`.

    `signs` tells whether greatest values are requested (1, else 0), and whether least ones are.
    """
    jumps, piece, beside = search[JUMPS] > 0, search[JUMPS] < 0, search[ONTO] != search[NUMBER]
    for i in range(count):
        if s[KIND, i] != s[KIND, i]:
            continue
        for mirror in range(2):
            column = column_of(table, search[ONTO], int(s[LANE, i]), int(s[HALF, i]), mirror)
            if column < 0:
                continue
            theta = s[IMAGE, i] if mirror == 1 else s[THETA, i]
            value = float(search[PARITY]) * s[VALUE, i] if mirror == 1 else s[VALUE, i]
            for least in range(1 - signs[0], 1 + signs[1]):
                high = PI if jumps else (-value if least == 1 else value)
                row = least * WINNER_ROWS
                best = winners[row + BEST, column]
                second = next_best(
                    best, winners[row + SECOND, column], winners[row + PLACE, column], high, theta
                )
                winners[row + SECOND, column] = second
                if high > best:
                    winners[row + BEST, column] = high
                    winners[row + PLACE, column] = theta
                    winners[row + AT_X, column] = s[X, i]
                    winners[row + IN_HALF, column] = s[HALF, i]
                    winners[row + IN_UPPER, column] = s[UPPER, i]
                    winners[row + MIRRORED, column] = float(mirror)
                    winners[row + OF_KIND, column] = (
                        TURN if jumps else (1.0 if piece else (NEARLY_POLE if beside else s[KIND, i]))
                    )


@outlined
def note_kinks(s: Any, count: int, table: Any, search: Any, winners: Any, signs: Any) -> None:
    """Note which of the places kept last are kinks: the slope jumps over zero there; arguments as of `note_winners`."""
    for i in range(count):
        low, high = abs(s[FA, i]), abs(s[FB, i])
        jumps = abs(s[F, i]) > KINKED * (high if high > low else low)
        if (s[KIND, i] != s[KIND, i]) | (not jumps):
            continue
        for mirror in range(2):
            column = column_of(table, search[ONTO], int(s[LANE, i]), int(s[HALF, i]), mirror)
            if column < 0:
                continue
            theta = s[IMAGE, i] if mirror == 1 else s[THETA, i]
            for least in range(1 - signs[0], 1 + signs[1]):
                row = least * WINNER_ROWS
                if winners[row + PLACE, column] == theta:
                    winners[row + OF_KIND, column] = NEARLY_POLE


@outlined
def judge_winners(winners: Any, w: Any, count: int, table: Any, search: Any, asked: Any) -> None:
    """Find what derivatives of greatest and least values are worth."""
    for least in range(1 - asked[0], 1 + asked[1]):
        row = least * WINNER_ROWS
        for branch in range(table[BRANCHES]):
            column = (search[NUMBER] * table[BRANCHES] + branch) * LANES
            for i in lanes(padded(count)):
                best, kind = winners[row + BEST, column + i], winners[row + OF_KIND, column + i]
                x, upper = winners[row + AT_X, column + i], winners[row + IN_UPPER, column + i] > 0.0
                first = abs(w[START + 1, i] if upper else w[START, i])
                toggle = (w[TOGGLE + 1, i] if upper else w[TOGGLE, i]) > 0.0
                at_end, tied = kind == 0.0, winners[row + SECOND, column + i] >= best - TIE * abs(best)
                fold = (first > 0.0) & (at_end | (x < FOLDED * first))
                folded = (asked[3] > 0) & ((abs(best) < FOLD) | (abs(abs(best) - PI) < FOLD))
                code = TIED if tied else (AT_LIMIT if at_end else SMOOTH)
                code = KINK if (kind == NEARLY_POLE) | ((asked[2] > 0) & (best == 0.0)) else code
                code = code if toggle else (AT_CHANGE_POINT if fold else (CONSTANT if at_end else code))
                code = INFINITE if abs(best) == INFINITY else code
                code = JUMP if (kind == TURN) | folded else code
                code = code if kind == kind else NOTHING
                along, held = at_end & (code <= TIED), (code <= TIED) | (code == CONSTANT)
                winners[row + CODE, column + i] = 1.0 * code
                winners[row + WHERE, column + i] = ALONG if along else (HELD if held else 0.0)
                winners[row + AT_X, column + i] = first if along & (x < first) else x


@outlined
def settle_jumps(winners: Any, row: int, columns: Any, gradients: Any, base: int, values: int) -> None:
    """Store zeros as the derivatives of values that are pi or 0 because an angle jumps or folds.

    `row` is the first one of the places, `base` that of the derivatives, of which so many are of values.
    """
    for column in range(columns[0], columns[1]):
        if winners[row + CODE, column] == JUMP:
            for j in range(values):
                gradients[base + j, column] = 0.0


@outlined
def store_row(result: Any, first: int, count: int, base: int, values: Any, row: int) -> None:
    """Copy the derivatives of greatest or least values or of their places, or the codes of what these are worth."""
    for i in range(count):
        for branch in range(result.shape[1]):
            result[first + i, branch] = values[row, base + branch * LANES + i]


@outlined
def store_change(result: Any, first: int, count: int, gradients: Any, w: Any, terms: Any) -> None:
    """Put together the changes of a greatest or least value, or of its place, by the tolerances of inputs.

    `terms` has the first column, whether squares are added, how many inputs there are, the rows of the derivatives by
    them, and the rows of the lane values of their tolerances.
    """
    total = terms[WINNERS]
    for i in range(count):
        for branch in range(result.shape[1]):
            change = 0.0
            for k in range(total):
                slope = gradients[terms[TERMS + k], terms[COLUMN] + branch * LANES + i]
                one = abs(slope) * w[terms[TERMS + total + k], i]
                change = magnitude(change, one) if terms[SQUARES] > 0 else change + one
            result[first + i, branch] = change


# -- Entries of the lists that are nothing but rounding, next to folds and toggles

# At a fold a quantity may be a small difference of great numbers: its slope changes its sign with every
# last bit, and each change looks like an extreme. At a toggle a curvature goes on in the other branch, and
# its slope in the input position is infinite: a small difference of great numbers there, too. So an entry
# there is certain only if at some distance the slope is beyond its error bound on both sides, with the
# signs of that extreme. Others leave the list, which is undecided then: it may lack an extreme. They still
# count for the greatest and the least value, within whose bounds they are.


#: Slopes are evaluated on both sides at so many distances from an extreme: 2^-1, 2^-7, ... of the position itself.
DISTANCES, FIRST_DISTANCE, NEXT_DISTANCE = 6, 0.5, 2.0**-6
# The scale of a toggle, beside which the first sample stands.
PER_FIRST = 2.0**60
# As near to a toggle rounding may make extremes up; next to a fold it may everywhere.
BESIDE = 2.0**-20


@merged
def _distance(w: Any, upper: int, lane: int, x: float) -> Any:
    """Return how far a position is from a fold, 1 at most, or from a toggle next to it; NaN where there is neither.

    Far from a toggle a bound as great as the slope is that of a kink, whose place is certain.
    """
    first, is_toggle = abs(w[START + upper, lane]), w[TOGGLE + upper, lane] != 0.0
    # the input angle goes with x beside a fold, with its square beside a toggle, up to its scale
    from_toggle = x * (x / (x + PER_FIRST * first))
    distance = from_toggle if from_toggle < BESIDE else NOT_A_NUMBER
    return (distance if is_toggle else min(x, 1.0)) if first > 0.0 else NOT_A_NUMBER


@outlined
def find_certain(certain: Any, s: Any, count: int, vectors: Any, w: Any) -> None:
    """Tell at which items next to folds and toggles the slope changes its sign beyond its error bound."""
    near = 0
    for i in range(count):
        distance = _distance(w, int(s[UPPER, i]), int(s[LANE, i]), s[X, i])
        is_near = distance == distance
        rises, turned = (s[FA, i] > 0.0) | (s[FB, i] < 0.0), s[XA, i] > s[XB, i]
        s[EXPECTED, i] = 1.0 if rises != turned else -1.0
        s[SAVED, i] = s[X, i]
        s[FOUND, i] = s[F, i]
        s[CERTAIN, i] = 0.0 if is_near else 1.0
        near = near + (1 if is_near else 0)
    if near > 0:
        distance = FIRST_DISTANCE
        for _ in range(DISTANCES):
            for farther in range(2):
                times = 1.0 + distance if farther == 1 else 1.0 / (1.0 + distance)
                evaluate_at(certain, s, count, vectors, SAVED, times)
                for i in lanes(padded(count)):
                    f = s[F, i] * s[EXPECTED, i]
                    f = f if abs(f) > s[SLOPE_BOUND, i] else 0.0
                    turns = (s[ONE_SIDE, i] > 0.0) & (f < 0.0) & (farther == 1)
                    s[CERTAIN, i] = 1.0 if turns else s[CERTAIN, i]
                    s[ONE_SIDE, i] = f
            distance = NEXT_DISTANCE * distance
        copy_row(s, count, X, SAVED)
        copy_row(s, count, F, FOUND)


# -- Lists that may lack an extreme, or hold one too many: those that doubles do not decide

# Beside a fold the slope may be certain down to some distance, and below that nothing but rounding. Where
# it falls towards the fold as far as it is certain, it may have one more zero between; where it keeps its
# size, or grows, it has none that a sample would not show. Lists of the first kind are marked, like those
# from which entries left that may be extremes, those without room for all, those of halves that were
# silenced, being at rest but for what rounding hides, those of an extreme whose place is as uncertain as
# its distance from the fold, or from a toggle that is almost one, is great, and those of a peak with few
# certain digits. Their bounds are infinite, and so are those of places that no extreme takes: a list that
# is empty can tell it, too.


# A peak that may be off by so much of its height: what it is in the middle of is as uncertain. Of the three extremes of
# a curvature within a peak above 1e15 two were lost, and the third was so.
PEAK = 2.0**-16


@merged
def mark_undecided(best: Any, table: Any, search: Any, lane: int, half: int) -> None:
    """Mark the lists that the extremes of one half of a design would be in."""
    for mirror in range(2):
        column = column_of(table, search[NUMBER], lane, half, mirror)
        if column >= 0:
            best[UNDECIDED, column] = 1.0


@outlined
def note_uncertain(s: Any, count: int, w: Any, table: Any, search: Any, best: Any) -> None:
    """Mark lists of extremes whose side of a fold or toggle rounding hides, and of those with few certain digits."""
    for i in range(count):
        upper, lane, x = int(s[UPPER, i]), int(s[LANE, i]), s[X, i]
        off, bend = s[SLOPE, i] + s[SLOPE_BOUND, i], s[BEND, i]
        if s[KIND, i] != s[KIND, i]:
            continue
        here, there = _distance(w, upper, lane, x), _distance(w, 1 - upper, lane, 1.0 / x)
        unsettled = (off >= bend * here) | (off >= bend * there)
        height = s[KIND, i] * s[VALUE, i]
        peak = (height > 0.0) & (s[BOUND, i] > PEAK * height)
        if unsettled | peak:
            mark_undecided(best, table, search, lane, int(s[HALF, i]))


@outlined
def flag_undecided(lists: Any, best: Any, first: int, last: int, room: int) -> None:
    """Make the bounds of all places of undecided lists infinite."""
    for column in range(first, last):
        if (best[UNDECIDED, column] > 0.0) | (best[COUNT, column] > room):
            for k in range(lists.shape[2]):
                lists[LIST_BOUND, column, k] = INFINITY


# -- Halves of the range in which a quantity does not change: bars that fold onto each other turn as one

# At a fold a linkage may go on as another: a kite with two of its joints in one place, a parallelogram
# whose output turns as its input does. Forces and torques are constant then, and all that samples show of
# the slope is rounding errors, of which zeros fill the lists.


#: A half may be at rest where the greatest slope is so little of the greatest of the half that continues it. It is if
#: one sample in five is 0 or of another sign than the one before: rounding errors are so at every second one, and no
#: quantity has so many extremes.
REST, RESTLESS = 2.0**-20, 5


@outlined
def silence_rest(w: Any, samples: Any, marks: Any, part: Any, count: int) -> None:
    """Take the samples of one half of the range away where they are rounding errors beside those of the next half."""
    rows, first, beyond = 2 * part[CELLS] + 1, part[FIRST], part[BEYOND]
    for i in range(count):
        lower = (w[START, i] != 0.0) & (w[TOGGLE, i] == 0.0)
        upper = (w[START + 1, i] != 0.0) & (w[TOGGLE + 1, i] == 0.0)
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
            total = append_item(ends, total, i, part[PART], False, 1.0, 0.0, 1.0, 0.0)
    return total

"""Items: cells of one design that hold a zero of one function, kept in lists, worked on `LANES` at a time.

The constants name the rows of arrays and the entries of the small tables that kernels call the functions here with.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.numerics.compiler import inlined, lanes, merged, outlined
from fastlink.numerics.elementary import sqrt, trailing_zeros

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
def evaluate(function: Any, s: Any, count: int, vectors: Any) -> None:
    """Evaluate a function at the positions of items."""
    function(s, vectors, every_vector(vectors, count))


@outlined
def evaluate_at(function: Any, s: Any, count: int, vectors: Any, row: int, times: float) -> None:
    """Put items at so many times the positions in a row of the state, and evaluate a function there."""
    for i in lanes(padded(count)):
        s[X, i] = times * s[row, i]
    evaluate(function, s, count, vectors)


@outlined
def keep(s: Any, count: int, row: int, of: int) -> None:
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

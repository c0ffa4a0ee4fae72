"""Search for zeros in the lanes: graded samples, cells that hold a zero, and bracketing iteration.

Arrays are rows of `LANES` values. Lanes are designs while samples are taken and items (one cell of one design) while
zeros are refined, so that no lane waits for another design's extremes. Loops run over views of rows: numba cannot tell
that a computed index is not negative, and then does not vectorise.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.jit import called, inlined, sqrt

__all__ = [
    "ITEM_ROWS",
    "STATE_ROWS",
    "advance",
    "append_item",
    "begin",
    "collect",
    "fractions",
    "gather",
    "place_samples",
    "split",
]

LANES = 64
# Rows of an item: what it is, then its bracket (place, value) and for a valley the place between.
LANE, HALF, UPPER, XA, FA, XB, FB, XC, FC = range(9)
ITEM_ROWS = 9
# Rows of the state of `LANES` items under way: the item, then what the iteration keeps.
X, F, X1, F1, X2, F2, TOLERANCE, OPEN, REAL = range(ITEM_ROWS, ITEM_ROWS + 9)
STATE_ROWS = ITEM_ROWS + 9
ROOT, VALLEY = 1, 2
# 2 units in the last place of a place, and 2^-56 of the cell where the zero is at 0.
RELATIVE = 2.0**-51
ABSOLUTE = 2.0**-56
# A minimum is found to half the digits; closer pairs of zeros are not told from none.
VALLEY_RELATIVE = 2.0**-26
GOLDEN = 0.3819660112501051


@inlined
def _sinh_step(low: Any, high: Any, a: Any, b: Any, up: Any, down: Any, first: Any, second: Any) -> None:
    for i in range(LANES):
        x = up[i] * a[i]
        y = down[i] * b[i]
        up[i] = x
        down[i] = y
        first[i] = low[i] * (0.5 * (x - y))
        second[i] = high[i] * (0.5 * (x - y))


@called
def place_samples(w: Any, scale: int, start: int, rows: int, spare: int, cells: int) -> None:
    """Write the places scale sinh(j h), j = 0 ... cells, of both ends; the last ones are one place.

    Parameters
    ----------
    w : array (rows, lanes)
        Lane values.
    scale, start : int
        Rows of the scale and of the first place of the lower end; those of the upper end follow each.
    rows, spare : int
        First row of the results (cells + 1 for the lower end, then as many for the upper), and of four spare ones.
    cells : int
        Half the number of cells, a power of two.
    """
    a, b, up, down = w[spare], w[spare + 1], w[spare + 2], w[spare + 3]
    low, high = w[scale], w[scale + 1]
    for i in range(LANES):
        g = 1.0 / sqrt(low[i] * high[i])
        a[i] = g + sqrt(g * g + 1.0)
        up[i] = 1.0
        down[i] = 1.0
    part = cells
    while part > 1:
        for i in range(LANES):
            a[i] = sqrt(a[i])
        part //= 2
    for i in range(LANES):
        b[i] = 1.0 / a[i]
    for j in range(1, cells + 1):
        _sinh_step(low, high, a, b, up, down, w[rows + j], w[rows + cells + 1 + j])
    w[rows] = w[start]
    w[rows + cells + 1] = w[start + 1]


@called
def fractions(w: Any, place: int, near: int, far: int) -> None:
    """Write the distances from the near and the far end over the width, for a row of places from the near end."""
    p, n, f = w[place], w[near], w[far]
    for i in range(LANES):
        square = p[i] * p[i]
        rest = 1.0 / (1.0 + square)
        n[i] = square * rest
        f[i] = rest


@inlined
def _mark(before: Any, here: Any, after: Any, sign: float, flags: Any) -> None:
    """Flag the lanes with a zero between this sample and the next, and those where two may hide about this one."""
    for i in range(LANES):
        a, b, c = before[i], here[i], after[i]
        differ = ((sign * b > 0.0) != (sign * c > 0.0)) & (b == b) & (c == c)
        a, b, c = abs(a), abs(b), abs(c)
        # The parabola through three values of a valley reaches below half of the least.
        low = (b <= a) & (b <= c) & ((a - c) * (a - c) > 4.0 * b * (a - 2.0 * b + c)) & (b > 0.0)
        flags[i] = (1 if differ else 0) + (2 if low else 0)


@called
def collect(
    w: Any,
    values: Any,
    f: int,
    beyond: int,
    rows: int,
    cells: int,
    lanes: int,
    half: int,
    sign: float,
    flags: Any,
    counts: Any,
    roots: Any,
    valleys: Any,
) -> None:
    """Make items of the cells of one half of the range that hold a zero or may hold two.

    Parameters
    ----------
    w, values : array (rows, lanes)
        Lane values with the places of samples, and the function's values there.
    f, beyond : int
        First row of the function's samples in this half, and in the half that continues it beyond both ends.
    rows, cells : int
        As in `place_samples`.
    lanes : int
        How many lanes are designs.
    half : int
        Number of this half.
    sign : float
        1, or -1 where a zero at a sample counts for the cell on its other side.
    flags : array (lanes,) of int8
        Scratch.
    counts, roots, valleys : array
        How many items there are of each kind, and the items.
    """
    last = 2 * cells
    words = flags.view(np.int64)
    for j in range(last + 1):
        before = values[f + j - 1 if j > 0 else beyond + 1]
        here = values[f + j]
        after = values[f + j + 1 if j < last else beyond + last - 1]
        _mark(before, here, after, sign, flags)
        for k in range(LANES // 8):
            if words[k] == 0:
                continue
            for i in range(8 * k, min(8 * k + 8, lanes)):
                flag = flags[i]
                if flag & ROOT and j < last:
                    upper = j >= cells
                    counts[1] = append_item(
                        roots, counts[1], i, half, upper,
                        _place(w, rows, cells, j, upper, i), here[i],
                        _place(w, rows, cells, j + 1, upper, i), after[i],
                    )  # fmt: skip
                if flag & VALLEY:
                    left, right = max(j - 1, 0), min(j + 1, last)
                    fa, fb = values[f + left, i], values[f + right, i]
                    if (fa > 0.0) == (here[i] > 0.0) and (fb > 0.0) == (here[i] > 0.0):
                        upper = left >= cells
                        n = counts[0]
                        counts[0] = append_item(
                            valleys, n, i, half, upper,
                            _place(w, rows, cells, left, upper, i), fa,
                            _place(w, rows, cells, right, upper, i), fb,
                        )  # fmt: skip
                        if counts[0] > n:
                            valleys[n, XC] = _place(w, rows, cells, j, upper, i)
                            valleys[n, FC] = here[i]


@called
def append_item(
    items: Any, count: int, lane: int, half: int, upper: bool, a: float, fa: float, b: float, fb: float
) -> int:
    """Append an item; there is room for all that a smooth function can ask for."""
    if count < items.shape[0]:
        item = items[count]
        item[LANE] = lane
        item[HALF] = half
        item[UPPER] = 1.0 if upper else 0.0
        item[XA] = a
        item[FA] = fa
        item[XB] = b
        item[FB] = fb
        return count + 1
    return count


@called
def _place(w: Any, rows: int, cells: int, j: int, upper: bool, lane: int) -> float:
    """Return the place of a sample from the lower end, or from the upper one."""
    if upper:
        return float(w[rows + 3 * cells + 1 - j, lane])
    if j <= cells:
        return float(w[rows + j, lane])
    return 1.0 / float(w[rows + 3 * cells + 1 - j, lane])


@inlined
def _gather_row(source: Any, lanes: Any, target: Any, width: int) -> None:
    for i in range(width):
        target[i] = source[lanes[i]]


@called
def gather(items: Any, start: int, stop: int, w: Any, rows: Any, s: Any, lanes: Any) -> int:
    """Copy up to `LANES` items and the design values they need into the state; return the width in use.

    Lanes beyond the last item, up to a multiple of eight, repeat it.
    """
    real = min(LANES, stop - start)
    width = (real + 7) // 8 * 8
    for i in range(width):
        item = items[start + min(i, real - 1)]
        for r in range(ITEM_ROWS):
            s[r, i] = item[r]
        s[REAL, i] = 1.0 if i < real else 0.0
        lanes[i] = np.uint64(item[LANE])
    for r in range(rows.size):
        _gather_row(w[rows[r]], lanes, s[STATE_ROWS + r], width)
    return width


@called
def begin(s: Any, width: int, phase: int) -> int:
    """Prepare the first place of each item: of a valley, a root, or a place as it is; return how many are open."""
    count = 0
    for i in range(width):
        a, fa, b, fb = s[XA, i], s[FA, i], s[XB, i], s[FB, i]
        s[TOLERANCE, i] = ABSOLUTE * max(a, b)
        is_open = 1.0
        if phase == 2:
            x, is_open = a, 0.0
        elif phase == 0:
            a, b = min(a, b), max(a, b)
            c = s[XC, i]
            x = c + GOLDEN * (b - c) if b - c > c - a else c + GOLDEN * (a - c)
        else:
            t = min(max(fa / (fa - fb), 0.02), 0.98)
            x = a + t * (b - a)
            if fa == 0.0 or fb == 0.0:
                x = a if fa == 0.0 else b
                is_open = 0.0
        s[X, i], s[F, i] = x, 0.0
        s[X1, i], s[F1, i], s[X2, i], s[F2, i] = a, fa, b, fb
        s[OPEN, i] = is_open
        count += int(is_open)
    return count


@inlined
def _advance_roots(
    x0: Any, f0: Any, xs1: Any, fs1: Any, xs2: Any, fs2: Any, tolerance: Any, is_open: Any, width: int
) -> None:
    """One step of Chandrupatla's method: inverse quadratic interpolation where it is safe, else bisection."""
    for i in range(width):
        x, f, x1, f1, x2, f2 = x0[i], f0[i], xs1[i], fs1[i], xs2[i], fs2[i]
        same = (f > 0.0) == (f1 > 0.0)
        x3 = x1 if same else x2
        f3 = f1 if same else f2
        x2 = x2 if same else x1
        f2 = f2 if same else f1
        nearer = abs(f2) < abs(f)
        best = x2 if nearer else x
        best_f = f2 if nearer else f
        gap = x2 - x
        per_gap = 1.0 / gap
        limit = (RELATIVE * abs(best) + tolerance[i]) * abs(per_gap)
        # Values over f2, so that nothing overflows.
        per_f2 = 1.0 / f2
        a, b = f * per_f2, f3 * per_f2
        per_b = 1.0 / (1.0 - b)
        xi = gap / (x2 - x3)
        phi = (1.0 - a) * per_b
        smooth = (phi * phi < xi) & ((1.0 - phi) * (1.0 - phi) < 1.0 - xi)
        skew = (x3 - x) * per_gap
        step = a * per_b * ((b * (b - a) - skew * (1.0 - a)) / ((1.0 - a) * (b - a)))
        t = step if smooth else 0.5
        t = t if t > limit else limit
        t = t if t < 1.0 - limit else 1.0 - limit
        done = (limit > 0.5) | (best_f == 0.0)
        place = best if done else x + t * gap
        x0[i] = place if is_open[i] > 0.0 else x
        xs1[i] = x
        fs1[i] = f
        xs2[i] = x2
        fs2[i] = f2
        is_open[i] = 0.0 if done else is_open[i]


@called
def _advance_valleys(s: Any, width: int) -> None:
    """One golden-section step towards the least magnitude; an item is done where the sign changes."""
    for i in range(width):
        if s[OPEN, i] == 0.0:
            continue
        a, b, c, fc, x, f = s[X1, i], s[X2, i], s[XC, i], s[FC, i], s[X, i], s[F, i]
        if (f > 0.0) != (fc > 0.0):
            s[OPEN, i] = 0.0
            continue
        inner, outer = (x, c) if abs(f) < abs(fc) else (c, x)
        if abs(f) < abs(fc):
            s[FC, i] = f
        # The outer of the two interior places replaces the end on its side.
        if outer < inner:
            a = outer
        else:
            b = outer
        s[X1, i], s[X2, i], s[XC, i] = a, b, inner
        if b - a <= VALLEY_RELATIVE * inner + s[TOLERANCE, i]:
            s[OPEN, i] = 0.0
            continue
        s[X, i] = inner + GOLDEN * (b - inner) if b - inner > inner - a else inner + GOLDEN * (a - inner)


@called
def advance(s: Any, width: int, valley: bool) -> int:
    """Take the function's value at each open item's place, choose the next; return how many are open."""
    if valley:
        _advance_valleys(s, width)
    else:
        _advance_roots(s[X], s[F], s[X1], s[F1], s[X2], s[F2], s[TOLERANCE], s[OPEN], width)
    count = 0.0
    is_open = s[OPEN]
    for i in range(width):
        count += is_open[i]
    return int(count)


@called
def split(s: Any, width: int, counts: Any, roots: Any) -> None:
    """Make two roots of each valley in which a place of the other sign was found."""
    for i in range(width):
        if s[REAL, i] > 0.0 and (s[F, i] > 0.0) != (s[FC, i] > 0.0):
            lane, half, upper = int(s[LANE, i]), int(s[HALF, i]), s[UPPER, i] > 0.0
            x, f = s[X, i], s[F, i]
            counts[1] = append_item(roots, counts[1], lane, half, upper, s[XA, i], s[FA, i], x, f)
            counts[1] = append_item(roots, counts[1], lane, half, upper, x, f, s[XB, i], s[FB, i])

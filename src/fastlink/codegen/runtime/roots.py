"""Refine zeros and least magnitudes in their brackets, lane by lane: no item waits for another design."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.codegen.runtime.cells import (
    F1,
    F2,
    FA,
    FB,
    FC,
    FLAT,
    HALF,
    LANE,
    MOST_LANES,
    OPEN,
    ROOTS,
    STEPS,
    TOLERANCE,
    UPPER,
    X1,
    X2,
    XA,
    XB,
    XC,
    F,
    X,
    append_of_lane,
    padded,
    set_bracket,
)
from fastlink.numerics.compiler import inlined, lanes, outlined

__all__ = [
    *("advance_roots", "advance_valleys", "begin_roots", "begin_valleys"),
    *("every_vector", "split"),
]

# 2 units in the last place of a position, and 2^-56 of the cell where the zero is at 0.
RELATIVE = 2.0**-51
ABSOLUTE = 2.0**-56
# A minimum is found to half the digits; closer pairs of zeros are not seen.
VALLEY_RELATIVE = 2.0**-26
# After this many steps a parabola is trusted that stays above half of the least magnitude.
TRUSTED_STEPS = 4
GOLDEN = 0.3819660112501051


@outlined
def begin_valleys(s: Any, count: int, vectors: Any) -> int:
    """Choose the first position in each valley; return how many vectors are open."""
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
    return every_vector(vectors, count)


@outlined
def begin_roots(s: Any, count: int, vectors: Any, flags: Any) -> int:
    """Choose the first position for each root, perhaps an end of its bracket; return how many vectors are open."""
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
    return _still_open(s, vectors, every_vector(vectors, count), flags)


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
def advance_roots(s: Any, vectors: Any, n: int, flags: Any) -> int:
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
def advance_valleys(s: Any, vectors: Any, n: int, flags: Any) -> int:
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
def split(s: Any, count: int, counts: Any, roots: Any) -> None:
    """Make two roots of each valley that has a value of the other sign in it, beyond rounding."""
    for i in range(count):
        deep = abs(s[F, i]) > FLAT * max(abs(s[FA, i]), abs(s[FB, i]))
        if (s[F, i] > 0.0) != (s[FC, i] > 0.0) and deep:
            lane, half, upper = int(s[LANE, i]), int(s[HALF, i]), s[UPPER, i] > 0.0
            set_bracket(roots, counts[ROOTS], s[XA, i], s[FA, i], s[X, i], s[F, i])
            append_of_lane(roots, counts, ROOTS, lane, half, upper)
            set_bracket(roots, counts[ROOTS], s[X, i], s[F, i], s[XB, i], s[FB, i])
            append_of_lane(roots, counts, ROOTS, lane, half, upper)

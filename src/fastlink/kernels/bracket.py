"""Zeros and least magnitudes in their brackets, refined in the lanes: no item waits for another design."""

from __future__ import annotations

from typing import Any

from fastlink.jit import called, inlined
from fastlink.kernels.items import (
    F1,
    F2,
    FA,
    FB,
    FC,
    HALF,
    LANE,
    OPEN,
    REAL,
    STEPS,
    TOLERANCE,
    UPPER,
    WHICH,
    X1,
    X2,
    XA,
    XB,
    XC,
    F,
    X,
    append_item,
)

__all__ = ["advance", "begin", "split"]

# 2 units in the last place of a place, and 2^-56 of the cell where the zero is at 0.
RELATIVE = 2.0**-51
ABSOLUTE = 2.0**-56
# A minimum is found to half the digits; closer pairs of zeros are not told from none.
VALLEY_RELATIVE = 2.0**-26
# After this many steps a parabola is trusted that stays above half of the least magnitude.
TRUSTED_STEPS = 4
GOLDEN = 0.3819660112501051


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
            if b < a:
                a, fa, b, fb = b, fb, a, fa
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
        s[STEPS, i], s[OPEN, i] = 0.0, is_open
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


@inlined
def _vertex(a: float, fa: float, c: float, fc: float, b: float, fb: float) -> float:
    """Return the least value of the parabola through three points of a valley."""
    left, right = (fc - fa) / (c - a), (fb - fc) / (b - c)
    bend = (right - left) / (b - a)
    slope = left + bend * (c - a)
    return fc - slope * slope / (4.0 * bend)


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
        # The outer of the two interior places replaces the end on its side.
        inner, f_inner, outer, f_outer = (x, f, c, fc) if abs(f) < abs(fc) else (c, fc, x, f)
        if outer < inner:
            a = outer
            s[F1, i] = f_outer
        else:
            b = outer
            s[F2, i] = f_outer
        s[X1, i], s[X2, i], s[XC, i], s[FC, i] = a, b, inner, f_inner
        s[STEPS, i] += 1.0
        at_end = (inner == a) | (inner == b)
        least = 0.0 if at_end else _vertex(a, abs(s[F1, i]), inner, abs(f_inner), b, abs(s[F2, i]))
        high = s[STEPS, i] >= TRUSTED_STEPS and (at_end or least > 0.5 * abs(f_inner))
        if high or b - a <= VALLEY_RELATIVE * inner + s[TOLERANCE, i]:
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
            lane, which, half = int(s[LANE, i]), int(s[WHICH, i]), int(s[HALF, i])
            upper = s[UPPER, i] > 0.0
            x, f = s[X, i], s[F, i]
            counts[1] = append_item(roots, counts[1], lane, which, half, upper, s[XA, i], s[FA, i], x, f)
            counts[1] = append_item(roots, counts[1], lane, which, half, upper, x, f, s[XB, i], s[FB, i])

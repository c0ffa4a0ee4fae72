"""Samples on the graded range, and the cells of it that hold a zero of a function.

Arrays are rows of `LANES` values; lanes are designs. Loops run over views of rows: numba cannot tell that a computed
index is not negative, and then does not vectorise.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.jit import called, inlined, sqrt
from fastlink.kernels.items import FC, HALF, LANES, STATE_ROWS, UPPER, XC, X, append_item

__all__ = ["collect", "fractions", "load_designs", "place_samples", "set_places", "silence"]

ROOT, VALLEY = 1, 2
# At 0.85 one pair of extremes of a rate in 10^6 was lost, at 1 a search takes a third longer.
SHALLOW = 0.97
# Of a derivative, over its terms: some ten roundings.
NOISE = 2.0**-50


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
    for i in range(LANES):
        w[rows, i] = abs(w[start, i])
        w[rows + cells + 1, i] = abs(w[start + 1, i])


@called
def fractions(w: Any, place: int, near: int, far: int) -> None:
    """Write the distances from the near and the far end over the width, for a row of places from the near end."""
    p, n, f = w[place], w[near], w[far]
    for i in range(LANES):
        square = p[i] * p[i]
        rest = 1.0 / (1.0 + square)
        n[i] = square * rest
        f[i] = rest


@called
def load_designs(w: Any, rows: Any, s: Any) -> None:
    """Copy the design values that items carry into their state: item i is of design i."""
    for r in range(rows.size):
        s[STATE_ROWS + r] = w[rows[r]]


@called
def set_places(w: Any, place: int, upper: bool, half: int, s: Any) -> None:
    """Put all items at a row of places, from the upper end or the lower one, in one half."""
    s[X] = w[place]
    s[UPPER] = 1.0 if upper else 0.0
    s[HALF] = half


@called
def silence(values: Any, one: int, other: int, samples: int) -> None:
    """Make rounding errors zero, given the first rows of a function's samples in both branches.

    The function is a mean and a part that changes sign with the branch; where one of them cancels the other, as in
    all of a parallelogram's motion, errors would look like zeros.
    """
    for j in range(samples):
        a, b = values[one + j], values[other + j]
        for i in range(LANES):
            x, y = a[i], b[i]
            noise = NOISE * (abs(x) + abs(y))
            a[i] = 0.0 if abs(x) <= noise else x
            b[i] = 0.0 if abs(y) <= noise else y


@inlined
def _mark(before: Any, here: Any, after: Any, sign: float, flags: Any) -> None:
    """Flag the lanes with a zero between this sample and the next, and those where two may hide about this one."""
    for i in range(LANES):
        a, b, c = before[i], here[i], after[i]
        differ = ((sign * b > 0.0) != (sign * c > 0.0)) & (b == b) & (c == c)
        a, b, c = abs(a), abs(b), abs(c)
        # A valley: a parabola through the three values comes low, or the least of them lies well below both others;
        # the dip may be narrower than a cell.
        low = (b <= a) & (b <= c) & (b > 0.0)
        bend = a - 2.0 * b + c
        low &= ((a - c) * (a - c) > b * bend) | ((b < SHALLOW * a) & (b < SHALLOW * c))
        flags[i] = (1 if differ else 0) + (2 if low else 0)


@called
def _place(w: Any, rows: int, cells: int, j: int, upper: bool, lane: int) -> float:
    """Return the place of a sample from the lower end, or from the upper one."""
    if upper:
        return float(w[rows + 3 * cells + 1 - j, lane])
    if j <= cells:
        return float(w[rows + j, lane])
    return 1.0 / float(w[rows + 3 * cells + 1 - j, lane])


@called
def collect(
    w: Any,
    values: Any,
    f: int,
    beyond: int,
    rows: int,
    cells: int,
    lanes: int,
    which: int,
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
    which, half : int
        Number of the function, and of this half.
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
                        roots, counts[1], i, which, half, upper,
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
                            valleys, n, i, which, half, upper,
                            _place(w, rows, cells, left, upper, i), fa,
                            _place(w, rows, cells, right, upper, i), fb,
                        )  # fmt: skip
                        if counts[0] > n:
                            valleys[n, XC] = _place(w, rows, cells, j, upper, i)
                            valleys[n, FC] = here[i]

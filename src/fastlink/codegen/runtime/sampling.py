"""Samples on the graded range, and the cells of it that hold a zero of a function.

Arrays are rows of `LANES` values; lanes are designs.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.codegen.runtime.cells import FC, MOST_LANES, XC, append_item
from fastlink.numerics.compiler import lanes, outlined
from fastlink.numerics.elementary import sqrt

__all__ = ["collect", "place_samples", "silence"]

ROOT, VALLEY = 1, 2
# At 0.85 one pair of extremes of a rate in 10^6 was lost, at 1 a search takes a third longer.
SHALLOW = 0.97
# Of a derivative, over its terms: some ten roundings.
NOISE = 2.0**-50


@outlined
def place_samples(w: Any, scale: int, start: int, rows: int, spare: int, cells: int, width: int) -> None:
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
    width : int
        Number of lanes.
    """
    a, b, up, down = spare, spare + 1, spare + 2, spare + 3
    for i in lanes(width):
        g = 1.0 / sqrt(w[scale, i] * w[scale + 1, i])
        w[a, i] = g + sqrt(g * g + 1.0)
        w[up, i] = 1.0
        w[down, i] = 1.0
    part = cells
    while part > 1:
        for i in lanes(width):
            w[a, i] = sqrt(w[a, i])
        part = part >> 1
    for i in lanes(width):
        w[b, i] = 1.0 / w[a, i]
    for j in range(1, cells + 1):
        for i in lanes(width):
            x = w[up, i] * w[a, i]
            y = w[down, i] * w[b, i]
            w[up, i] = x
            w[down, i] = y
            w[rows + j, i] = w[scale, i] * (0.5 * (x - y))
            w[rows + cells + 1 + j, i] = w[scale + 1, i] * (0.5 * (x - y))
    for i in lanes(width):
        w[rows, i] = abs(w[start, i])
        w[rows + cells + 1, i] = abs(w[start + 1, i])


@outlined
def silence(values: Any, one: int, other: int, samples: int, width: int) -> None:
    """Make rounding errors zero, given the first rows of a function's samples in both branches.

    The function is a mean and a part that changes sign with the branch; where one of them cancels the other, as in
    all of a parallelogram's motion, errors would look like zeros.
    """
    for j in range(samples):
        for i in lanes(width):
            x, y = values[one + j, i], values[other + j, i]
            noise = NOISE * (abs(x) + abs(y))
            values[one + j, i] = 0.0 if abs(x) <= noise else x
            values[other + j, i] = 0.0 if abs(y) <= noise else y


@outlined
def _place(w: Any, rows: int, cells: int, j: int, upper: bool, lane: int) -> float:
    """Return the place of a sample from the lower end, or from the upper one."""
    if upper:
        return float(w[rows + 3 * cells + 1 - j, lane])
    if j <= cells:
        return float(w[rows + j, lane])
    return 1.0 / float(w[rows + 3 * cells + 1 - j, lane])


@outlined
def collect(
    w: Any,
    values: Any,
    f: int,
    beyond: int,
    rows: int,
    cells: int,
    count: int,
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
    count : int
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
    width = (count + (MOST_LANES - 1)) & -MOST_LANES
    for j in range(last + 1):
        before = f + j - 1 if j > 0 else beyond + 1
        here = f + j
        after = f + j + 1 if j < last else beyond + last - 1
        # A zero between this sample and the next, and where two may hide about this one.
        for i in lanes(width):
            a, b, c = values[before, i], values[here, i], values[after, i]
            differ = ((sign * b > 0.0) != (sign * c > 0.0)) & (b == b) & (c == c)
            a, b, c = abs(a), abs(b), abs(c)
            # A valley: a parabola through the three values comes low, or the least of them lies well below both
            # others; the dip may be narrower than a cell.
            low = (b <= a) & (b <= c) & (b > 0.0)
            bend = a - 2.0 * b + c
            low = low & (((a - c) * (a - c) > b * bend) | ((b < SHALLOW * a) & (b < SHALLOW * c)))
            flags[i] = (1 if differ else 0) + (2 if low else 0)
        for k in range(width >> 3):
            if words[k] == 0:
                continue
            for i in range(8 * k, min(8 * k + 8, count)):
                flag = flags[i]
                if flag & ROOT and j < last:
                    upper = j >= cells
                    counts[1] = append_item(
                        roots, counts[1], i, half, upper,
                        _place(w, rows, cells, j, upper, i), values[here, i],
                        _place(w, rows, cells, j + 1, upper, i), values[after, i],
                    )  # fmt: skip
                if flag & VALLEY:
                    left, right = max(j - 1, 0), min(j + 1, last)
                    fa, fb = values[f + left, i], values[f + right, i]
                    middle = values[here, i]
                    if (fa > 0.0) == (middle > 0.0) and (fb > 0.0) == (middle > 0.0):
                        upper = left >= cells
                        n = counts[0]
                        counts[0] = append_item(
                            valleys, n, i, half, upper,
                            _place(w, rows, cells, left, upper, i), fa,
                            _place(w, rows, cells, right, upper, i), fb,
                        )  # fmt: skip
                        if counts[0] > n:
                            valleys[n, XC] = _place(w, rows, cells, j, upper, i)
                            valleys[n, FC] = middle

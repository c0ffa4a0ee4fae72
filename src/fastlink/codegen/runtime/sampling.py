"""Samples on the graded range, and the cells of it that hold a zero of a function.

Arrays are rows of `LANES` values; lanes are designs.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.codegen.runtime.cells import FC, XC, append_item, padded
from fastlink.numerics.compiler import inlined, lanes, merged, outlined
from fastlink.numerics.elementary import sqrt, trailing_zeros

__all__ = ["collect", "mark", "mark_ends", "place_samples", "silenced"]

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


@inlined
def silenced(x: Any, y: Any) -> Any:
    """Return the values of a function in both branches, rounding errors made zero.

    The function is a mean and a part that changes sign with the branch; where one of them cancels the other, as in
    all of a parallelogram's motion, errors would look like zeros.
    """
    noise = NOISE * (abs(x) + abs(y))
    return 0.0 if abs(x) <= noise else x, 0.0 if abs(y) <= noise else y


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
def mark_ends(values: Any, flags: Any, f: int, beyond: int, last: int, sign: float, width: int) -> None:
    """Mark the first and the last sample of one half of the range, which other halves continue.

    Parameters
    ----------
    values, flags : array (rows, lanes)
        The function's values, and their marks.
    f, beyond : int
        First row of the function's samples in this half, and in the half that continues it beyond both ends.
    last : int
        Number of the last sample.
    sign : float
        1, or -1 where a zero at a sample counts for the cell on its other side.
    width : int
        Number of lanes.
    """
    for i in lanes(width):
        flags[f, i] = mark(values[beyond + 1, i], values[f, i], values[f + 1, i], sign)
    end = f + last
    for i in lanes(width):
        flags[end, i] = mark(values[end - 1, i], values[end, i], values[beyond + last - 1, i], sign)


@merged
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
    flags: Any,
    f: int,
    rows: int,
    cells: int,
    count: int,
    half: int,
    counts: Any,
    roots: Any,
    valleys: Any,
) -> None:
    """Make items of the cells of one half of the range that hold a zero or may hold two.

    Parameters
    ----------
    w, values, flags : array (rows, lanes)
        Lane values with the places of samples, the function's values there, and their marks.
    f : int
        First row of the function's samples in this half.
    rows, cells : int
        As in `place_samples`.
    count : int
        How many lanes are designs.
    half : int
        Number of this half.
    counts, roots, valleys : array
        How many items there are of each kind, and the items.
    """
    last = 2 * cells
    for j in range(last + 1):
        # Eight marks at once: most are none.
        words = flags[f + j].view(np.int64)
        for k in range(padded(count) >> 3):
            word = words[k]
            while word != 0:
                shift = trailing_zeros(word) & 56
                flag = (word >> shift) & (ROOT | VALLEY)
                word = word ^ (flag << shift)
                i = 8 * k + (shift >> 3)
                if i >= count:
                    break
                if flag & ROOT and j < last:
                    upper = j >= cells
                    counts[1] = append_item(
                        roots, counts[1], i, half, upper,
                        _place(w, rows, cells, j, upper, i), values[f + j, i],
                        _place(w, rows, cells, j + 1, upper, i), values[f + j + 1, i],
                    )  # fmt: skip
                if flag & VALLEY:
                    left, right = max(j - 1, 0), min(j + 1, last)
                    fa, fb, middle = values[f + left, i], values[f + right, i], values[f + j, i]
                    if (fa > 0.0) == (middle > 0.0) and (fb > 0.0) == (middle > 0.0):
                        upper = left >= cells
                        n = counts[0]
                        counts[0] = append_item(
                            valleys, n, i, half, upper,
                            _place(w, rows, cells, left, upper, i), fa,
                            _place(w, rows, cells, right, upper, i), fb,
                        )  # fmt: skip
                        if counts[0] > n:
                            valleys[XC, n] = _place(w, rows, cells, j, upper, i)
                            valleys[FC, n] = middle

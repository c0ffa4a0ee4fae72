"""Samples on the graded range, and the cells of it that hold a zero of a function.

Arrays are rows of `LANES` values; lanes are designs.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.codegen.runtime.cells import (
    BEYOND,
    CELLS,
    CONTINUED,
    DESIGNS,
    FC,
    FIRST,
    FLAT,
    PART,
    ROOTS,
    SIGN,
    TOGGLE,
    VALLEYS,
    XC,
    append_of_lane,
    padded,
    set_bracket,
)
from fastlink.numerics.compiler import inlined, lanes, merged, outlined
from fastlink.numerics.elementary import sqrt, trailing_zeros

__all__ = [
    *("collect", "is_unresolved", "mark", "mark_ends", "place_samples", "position_of", "silenced"),
    *("ROOT", "UNRESOLVED_CELL", "VALLEY"),
]

ROOT, VALLEY, UNRESOLVED_CELL = 1, 2, 4
# At 0.85 one pair of extremes of a rate in 10^6 was lost, at 1 a search takes a third longer.
SHALLOW = 0.97
# Of a derivative, over its terms: some ten roundings.
NOISE = 2.0**-50


@outlined
def place_samples(w: Any, samples: Any, scale: int, start: int, cells: int, width: int) -> None:
    """Write the positions scale sinh(j h), j = 0 ... cells, of both ends; the last ones are one position.

    Parameters
    ----------
    w : array (rows, lanes)
        Lane values.
    samples : array (rows, lanes)
        Written: cells + 1 rows for the lower end, then as many for the upper, and four spare ones.
    scale, start : int
        Rows of the scale and of the first position of the lower end; those of the upper end follow each.
    cells : int
        Half the number of cells, a power of two.
    width : int
        Number of lanes.
    """
    beyond = cells + 1
    a, b, up, down = 2 * beyond, 2 * beyond + 1, 2 * beyond + 2, 2 * beyond + 3
    for i in lanes(width):
        g = 1.0 / sqrt(w[scale, i] * w[scale + 1, i])
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
            samples[j, i] = w[scale, i] * (0.5 * (x - y))
            samples[beyond + j, i] = w[scale + 1, i] * (0.5 * (x - y))
    for i in lanes(width):
        samples[0, i] = abs(w[start, i])
        samples[beyond, i] = abs(w[start + 1, i])


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
def mark_ends(w: Any, table: Any, samples: Any, marks: Any, part: Any, width: int) -> None:
    """Mark the first and the last sample of one half of the range, which other halves continue.

    Parameters
    ----------
    w : array (rows, lanes)
        Lane values.
    samples, marks : array (rows, lanes)
        Positions and the function's values there, and the marks of these.
    table, part : array of int
        Tables of the kernel and of the half, see `cells`.
    width : int
        Number of lanes.
    """
    sign, along, toggle = float(part[SIGN]), float(part[CONTINUED]), table[TOGGLE]
    first, last = part[FIRST], part[FIRST] + 2 * part[CELLS]
    beyond, continued = part[BEYOND] + 1, part[BEYOND] + 2 * part[CELLS] - 1
    for i in lanes(width):
        before, after = along * samples[beyond, i], samples[first + 1, i]
        here = flattened(before, samples[first, i], after, w[toggle, i])
        samples[first, i] = here
        marks[first, i] = mark(before, here, after, sign)
    for i in lanes(width):
        inner, before, after = samples[last - 2, i], samples[last - 1, i], along * samples[continued, i]
        here = flattened(after, samples[last, i], before, w[toggle + 1, i])
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
    cells, n = part[CELLS], counts[ROOTS]
    at, upper = part[FIRST] + j, j >= cells
    a, b = position_of(samples, cells, j, upper, lane), position_of(samples, cells, j + 1, upper, lane)
    set_bracket(roots, n, a, samples[at, lane], b, samples[at + 1, lane])
    append_of_lane(roots, counts, ROOTS, lane, part[PART], upper)


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
        set_bracket(valleys, n, a, fa, b, fb)
        valleys[XC, n] = position_of(samples, cells, j, upper, lane)
        valleys[FC, n] = middle
        append_of_lane(valleys, counts, VALLEYS, lane, part[PART], upper)


@outlined
def collect(samples: Any, marks: Any, part: Any, counts: Any, roots: Any, valleys: Any) -> None:
    """Make items of the cells of one half of the range that hold a zero or may hold two, but for unresolved ones.

    Parameters
    ----------
    samples, marks, part
        As for `mark_ends`.
    counts : array of int
        How many designs there are, and how many items of each kind.
    roots, valleys : array (rows of an item, items)
        The items.
    """
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

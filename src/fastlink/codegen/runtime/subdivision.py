"""Cells in which the samples cannot exclude further zeros, divided until they can.

Zeros hide where the function is not resolved: a pair between two samples of one sign, or three between samples of both
signs. The fourth differences of the samples tell where: cubic interpolation between equally spaced samples is off by
about 3/128 of them where they change little from sample to sample. It is an estimate, no bound: what leaves no trace in
six samples stays unseen. Arrays are as in `cells`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.codegen.runtime.beside import PASSED, next_split
from fastlink.codegen.runtime.cells import (
    CELLS,
    DESIGNS,
    FA,
    FB,
    FC,
    FINE,
    FINE_AT,
    FINE_SAMPLES,
    FIRST,
    HALF,
    LANE,
    PART,
    PARTS,
    ROOT,
    ROOTS,
    SIGN,
    STEPS,
    UNRESOLVED,
    UNRESOLVED_CELL,
    UPPER,
    VALLEY,
    VALLEYS,
    XA,
    XB,
    XC,
    F,
    X,
    append_of_lane,
    append_unresolved,
    is_unresolved,
    mark,
    padded,
    position_of,
    set_bracket,
)
from fastlink.numerics.compiler import inlined, lanes, outlined
from fastlink.numerics.elementary import trailing_zeros

__all__ = [
    "collect_fine",
    "collect_unresolved",
    "divide",
    "keep_fine",
    "mark_fine",
    "mark_unresolved",
    "place_fine",
]


# Eight marks at once.
UNRESOLVED_CELLS = 0x0404040404040404

# The row of the state that tells which parts are divided again: free until a search for a least magnitude begins.
DIVIDED = STEPS
#: How often a cell is divided at most, into eighths: a double zero at a sample would go on for ever.
LEVELS = 4
#: A smooth function is unresolved in a few of the eight parts, beside what it hides; rounding errors are so in all.
MOST_UNRESOLVED = 5
# Of a fourth difference, 2.7 times the error of the cubic. At the 88 pairs that hid in 1.6 million searches of forces,
# the cubic came within 0.0132 of it to zero.
DOUBT = 0.0625


@inlined
def unresolved(before: Any, f0: Any, f1: Any, after: Any, fourth0: Any, fourth1: Any) -> Any:
    """Tell whether a cell may hold more zeros than its ends show, by the cubic through its ends and the samples beside.

    Of one sign: the cubic, which dips below both ends by at most an eighth of a second difference, comes nearer to zero
    than it may be off. Of both signs: it may turn back.
    """
    bend0, bend1 = abs(before - 2.0 * f0 + f1), abs(f0 - 2.0 * f1 + after)
    fourth0, fourth1 = abs(fourth0), abs(fourth1)
    turn = 0.5 * (bend0 if bend0 > bend1 else bend1) + (4.0 * DOUBT) * (
        fourth0 if fourth0 > fourth1 else fourth1
    )
    low, high = abs(f0), abs(f1)
    least = 4.0 * (low if low < high else high)
    return (abs(f1 - f0) if (f0 > 0.0) != (f1 > 0.0) else least) < turn


@outlined
def mark_unresolved(samples: Any, marks: Any, part: Any, width: int) -> None:
    """Mark the samples that begin a cell which may hold more zeros than its ends show."""
    first, last = part[FIRST], part[FIRST] + 2 * part[CELLS]
    for j in range(first + 2, last - 2):
        for i in lanes(width):
            a, b, f0, f1 = samples[j - 2, i], samples[j - 1, i], samples[j, i], samples[j + 1, i]
            c, d = samples[j + 2, i], samples[j + 3, i]
            fourth0 = (a + c) - 4.0 * (b + f1) + 6.0 * f0
            fourth1 = (b + d) - 4.0 * (f0 + c) + 6.0 * f1
            doubtful = unresolved(b, f0, f1, c, fourth0, fourth1)
            marks[j, i] = marks[j, i] | (UNRESOLVED_CELL if doubtful else 0)
    for upper in range(2):
        # the two cells at each end of the half, with the fourth difference of the five samples there
        end, step = (last, -1) if upper == 1 else (first, 1)
        at0, at1 = end - upper, end + step - upper
        for i in lanes(width):
            f0, f1, f2 = samples[end, i], samples[end + step, i], samples[end + 2 * step, i]
            f3, f4 = samples[end + 3 * step, i], samples[end + 4 * step, i]
            fourth = (f0 + f4) - 4.0 * (f1 + f3) + 6.0 * f2
            beyond = 4.0 * (f0 + f2) - 6.0 * f1 - f3
            marks[at0, i] = marks[at0, i] | (
                UNRESOLVED_CELL if unresolved(beyond, f0, f1, f2, fourth, fourth) else 0
            )
            marks[at1, i] = marks[at1, i] | (
                UNRESOLVED_CELL if unresolved(f0, f1, f2, f3, fourth, fourth) else 0
            )
    # a valley with an unresolved cell: both of its cells are divided
    for j in range(first + 1, last):
        for i in lanes(width):
            before, here = marks[j - 1, i], marks[j, i]
            both = (
                (here & VALLEY != 0)
                & ((before | here) & ROOT == 0)
                & ((before | here) & UNRESOLVED_CELL != 0)
            )
            flag = UNRESOLVED_CELL if both else 0
            marks[j - 1, i] = before | flag
            marks[j, i] = here | flag


@outlined
def collect_unresolved(
    samples: Any, marks: Any, part: Any, counts: Any, unresolved: Any, splits: Any
) -> None:
    """Make items of the unresolved cells of one half of the range, of parts of them where these are split."""
    first, cells, count = part[FIRST], part[CELLS], counts[DESIGNS]
    n_words = padded(count) >> 3
    for j in range(2 * cells):
        at, upper = first + j, j >= cells
        words = marks[at].view(np.int64)
        for k in range(n_words):
            word = words[k] & UNRESOLVED_CELLS
            while word != 0:
                shift = trailing_zeros(word) & 56
                word = word & (word - 1)
                lane = 8 * k + (shift >> 3)
                if lane >= count:
                    break
                a = position_of(samples, cells, j, upper, lane)
                b = position_of(samples, cells, j + 1, upper, lane)
                near, far = (XA if a < b else XB), (XB if a < b else XA)
                fa, owner, n = samples[at, lane], not is_unresolved(marks, part, j - 1, lane), 1
                while n > 0:
                    n = next_split(splits, lane, part[PART], upper, a, b)
                    x = splits[near, n] if n > 0 else b
                    f = splits[near + 1, n] if n > 0 else samples[at + 1, lane]
                    set_bracket(unresolved, counts[UNRESOLVED], a, fa, x, f)
                    append_unresolved(unresolved, counts[UNRESOLVED], 1, float(part[SIGN]), owner)
                    append_of_lane(unresolved, counts, UNRESOLVED, lane, part[PART], upper)
                    a, fa, owner = splits[far, n], splits[far + 1, n], False
                    splits[PASSED, n] = 1.0  # of column 0, which is no place, too


@outlined
def place_fine(s: Any, count: int, k: int) -> None:
    """Put items at the k-th of their fine samples; beyond an end of the range, mirrored."""
    t = (k - 1) / PARTS
    for i in lanes(padded(count)):
        position = (1.0 - t) * s[XA, i] + t * s[XB, i]  # exact at both ends
        s[FINE_AT + k, i] = position
        s[X, i] = abs(position)


@outlined
def keep_fine(s: Any, count: int, k: int) -> None:
    """Keep the values at the k-th fine samples."""
    for i in lanes(padded(count)):
        s[FINE + k, i] = s[F, i]


@outlined
def mark_fine(s: Any, count: int, marks: Any) -> None:
    """Mark the fine samples of items as `mark` and `mark_unresolved` do; extrapolate first beyond the ends."""
    width = padded(count)
    for i in lanes(width):
        # what the signs at the ends of a cell are was decided by its samples
        s[FINE + 1, i] = s[FA, i]
        s[FINE + PARTS + 1, i] = s[FB, i]
    for upper in range(2):
        end, step = (FINE_SAMPLES - 1, -1) if upper == 1 else (0, 1)
        f = FINE + end
        for i in lanes(width):
            cubic = (
                4.0 * (s[f + step, i] + s[f + 3 * step, i]) - 6.0 * s[f + 2 * step, i] - s[f + 4 * step, i]
            )
            s[f, i] = cubic if s[FINE_AT + end, i] < 0.0 else s[f, i]
    for k in range(1, PARTS + 2):
        f, after = FINE + k, FINE + min(k + 2, PARTS + 2)
        m0, m1 = FINE + min(max(k, 2), PARTS), FINE + min(max(k + 1, 2), PARTS)
        for i in lanes(width):
            a, b, c = s[f - 1, i], s[f, i], s[f + 1, i]
            fourth0 = (s[m0 - 2, i] + s[m0 + 2, i]) - 4.0 * (s[m0 - 1, i] + s[m0 + 1, i]) + 6.0 * s[m0, i]
            fourth1 = (s[m1 - 2, i] + s[m1 + 2, i]) - 4.0 * (s[m1 - 1, i] + s[m1 + 1, i]) + 6.0 * s[m1, i]
            one_sign = ((a > 0.0) == (b > 0.0)) & ((c > 0.0) == (b > 0.0))
            sign = 1.0 if s[FC, i] > 0.0 else -1.0
            doubt = unresolved(a, b, c, s[after, i], fourth0, fourth1)
            flag = mark(a, b, c, sign) & (ROOT | VALLEY if one_sign else ROOT)
            marks[k, i] = flag | (UNRESOLVED_CELL if doubt else 0)


@outlined
def divide(s: Any, count: int, marks: Any, counts: Any, items: Any) -> None:
    """Make items of the parts of cells that are divided again: unresolved ones, and those about a valley with one.

    A valley at an end of a cell may reach into another one that is divided, so its part is divided too. The parts are
    bits of `DIVIDED`.
    """
    for i in range(count):
        level, owner, parts, doubtful = int(s[XC, i]), abs(s[FC, i]) > 1.0, 0, 0
        for k in range(1, PARTS + 2):
            if marks[k, i] & UNRESOLVED_CELL != 0 and k <= PARTS:
                parts = parts | (1 << k)
                doubtful = doubtful + 1
        if marks[1, i] & VALLEY != 0 and not owner:
            parts = parts | 2
        if marks[PARTS + 1, i] & VALLEY != 0:
            parts = parts | (1 << PARTS)
        for k in range(1, PARTS + 2):
            both = 3 << (k - 1)
            if marks[k, i] & VALLEY != 0 and parts & both != 0:
                parts = parts | both
        parts = parts & ((2 << PARTS) - 2) if (level < LEVELS) & (doubtful <= MOST_UNRESOLVED) else 0
        s[DIVIDED, i] = parts
        for k in range(1, PARTS + 1):
            if (parts >> k) & 1 != 0:
                n = counts[UNRESOLVED]
                set_bracket(
                    items, n, s[FINE_AT + k, i], s[FINE + k, i], s[FINE_AT + k + 1, i], s[FINE + k + 1, i]
                )
                first = (parts >> (k - 1)) & 1 == 0 and (k > 1 or owner)
                append_unresolved(items, n, level + 1, 1.0 if s[FC, i] > 0.0 else -1.0, first)
                append_of_lane(items, counts, UNRESOLVED, int(s[LANE, i]), int(s[HALF, i]), s[UPPER, i] > 0.0)


@outlined
def collect_fine(s: Any, count: int, marks: Any, counts: Any, roots: Any, valleys: Any) -> None:
    """Make items of the zeros and valleys of cells by their fine samples, but for the parts that are divided again."""
    for i in range(count):
        lane, half, upper, parts = int(s[LANE, i]), int(s[HALF, i]), s[UPPER, i] > 0.0, int(s[DIVIDED, i])
        owner = abs(s[FC, i]) > 1.0
        for k in range(1, PARTS + 2):
            at, f = FINE_AT + k, FINE + k
            if marks[k, i] & VALLEY != 0 and (parts >> (k - 1)) & 3 == 0 and (k > 1 or owner):
                # at an end of the range the bracket begins at the end itself
                a, b = (0 if s[at - 1, i] < 0.0 else 1), (0 if s[at + 1, i] < 0.0 else 1)
                n = counts[VALLEYS]
                set_bracket(valleys, n, s[at - a, i], s[f - a, i], s[at + b, i], s[f + b, i])
                valleys[XC, n] = s[at, i]
                valleys[FC, n] = s[f, i]
                append_of_lane(valleys, counts, VALLEYS, lane, half, upper)
            if k <= PARTS and (parts >> k) & 1 == 0 and marks[k, i] & ROOT != 0:
                n = counts[ROOTS]
                set_bracket(roots, n, s[at, i], s[f, i], s[at + 1, i], s[f + 1, i])
                append_of_lane(roots, counts, ROOTS, lane, half, upper)

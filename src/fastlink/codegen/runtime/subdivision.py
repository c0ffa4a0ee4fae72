"""Cells in which the samples cannot exclude further zeros, divided until they can.

Zeros hide where the function is not resolved: a pair between two samples of one sign, or three between samples of both
signs. The fourth differences of the samples tell where: cubic interpolation between equally spaced samples is off by at
most 3/128 of them, so a function that keeps away from zero by more cannot have a zero. Arrays are as in `sampling`.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import (
    CELLS,
    FC,
    FIRST,
    HALF,
    LANE,
    ROOTS,
    UNRESOLVED,
    UPPER,
    VALLEYS,
    XA,
    XB,
    XC,
    F,
    X,
    append_item,
    append_unresolved,
    padded,
    set_bracket,
)
from fastlink.codegen.runtime.sampling import ROOT, UNRESOLVED_CELL, VALLEY, mark
from fastlink.numerics.compiler import inlined, lanes, merged, outlined

__all__ = ["FINE_SAMPLES", "divide", "keep_fine", "mark_fine", "mark_unresolved", "place_fine"]

#: Parts of a cell that is divided, and samples then: those beyond its ends show what is a valley at an end.
PARTS = 8
FINE_SAMPLES = PARTS + 3
#: How often a cell is divided again; of 10^6 designs with random masses none needs the last.
LEVELS = 4
# Of a fourth difference. A cubic through four equally spaced samples is off by 3/128 of it between the middle two where
# the difference changes little from sample to sample; of the 90 hidden pairs of 1.6 million searches, the cubic came
# within 0.0132 of it to zero.
DOUBT = 0.0625


@inlined
def unresolved(before: Any, f0: Any, f1: Any, after: Any, fourth0: Any, fourth1: Any) -> Any:
    """Tell whether a cell may hold more zeros than its ends show, by the cubic through its ends and the samples beside.

    Of one sign: the cubic, which dips below both ends by an eighth of a second difference, comes nearer to zero than it
    may be off. Of both signs: it may turn back.
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
    """Mark the samples that begin a cell which may hold more zeros than its ends show.

    Parameters
    ----------
    samples, marks : array (rows, lanes)
        Positions and the function's values there, and the marks of these.
    part : array of int
        Table of the half, see `cells`.
    width : int
        Number of lanes.
    """
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


@outlined
def place_fine(s: Any, count: int, k: int) -> None:
    """Put items at the k-th of their fine samples; beyond an end of the range, where it is mirrored."""
    t = (k - 1) / PARTS
    for i in lanes(padded(count)):
        s[X, i] = abs(s[XA, i] + t * (s[XB, i] - s[XA, i]))


@outlined
def keep_fine(s: Any, count: int, k: int, fine: Any) -> None:
    """Keep the values at the k-th fine samples."""
    for i in lanes(padded(count)):
        fine[k, i] = s[F, i]


@outlined
def mark_fine(s: Any, count: int, fine: Any, marks: Any) -> None:
    """Mark the fine samples of items as `mark` and `mark_unresolved` do; beyond an end of the range, extrapolate first.

    Parameters
    ----------
    s, count : array, int
        State of the items, and how many they are.
    fine, marks : array (FINE_SAMPLES, lanes)
        Their fine samples, and the marks of these.
    """
    width = padded(count)
    for upper in range(2):
        end, step = (FINE_SAMPLES - 1, -1) if upper == 1 else (0, 1)
        t = (end - 1) / PARTS
        for i in lanes(width):
            beyond = s[XA, i] + t * (s[XB, i] - s[XA, i]) < 0.0
            f1, f2, f3 = fine[end + step, i], fine[end + 2 * step, i], fine[end + 3 * step, i]
            cubic = 4.0 * (f1 + f3) - 6.0 * f2 - fine[end + 4 * step, i]
            fine[end, i] = cubic if beyond else fine[end, i]
    for k in range(1, PARTS + 2):
        m0, m1 = min(max(k, 2), PARTS), min(max(k + 1, 2), PARTS)
        after = min(k + 2, PARTS + 2)
        for i in lanes(width):
            a, b, c = fine[k - 1, i], fine[k, i], fine[k + 1, i]
            outer0, inner0 = fine[m0 - 2, i] + fine[m0 + 2, i], fine[m0 - 1, i] + fine[m0 + 1, i]
            outer1, inner1 = fine[m1 - 2, i] + fine[m1 + 2, i], fine[m1 - 1, i] + fine[m1 + 1, i]
            fourth0 = outer0 - 4.0 * inner0 + 6.0 * fine[m0, i]
            fourth1 = outer1 - 4.0 * inner1 + 6.0 * fine[m1, i]
            one_sign = ((a > 0.0) == (b > 0.0)) & ((c > 0.0) == (b > 0.0))
            sign = 1.0 if s[FC, i] > 0.0 else -1.0
            flag = mark(a, b, c, sign) & (ROOT | VALLEY if one_sign else ROOT)
            marks[k, i] = flag | (
                UNRESOLVED_CELL if unresolved(a, b, c, fine[after, i], fourth0, fourth1) else 0
            )


@merged
def _position(s: Any, i: int, k: int) -> float:
    """Return the position of a fine sample, negative beyond an end of the range."""
    return float(s[XA, i]) + ((k - 1) / PARTS) * (float(s[XB, i]) - float(s[XA, i]))


@merged
def _divided_parts(marks: Any, i: int, owner: bool) -> int:
    """Return the parts of an item that are divided again, as bits: unresolved ones, and those about a valley with one.

    A valley at an end of the item may reach into another item, so its part is divided too.
    """
    parts = 0
    for k in range(1, PARTS + 1):
        if marks[k, i] & UNRESOLVED_CELL != 0:
            parts = parts | (1 << k)
    if marks[1, i] & VALLEY != 0 and not owner:
        parts = parts | 2
    if marks[PARTS + 1, i] & VALLEY != 0:
        parts = parts | (1 << PARTS)
    for k in range(1, PARTS + 2):
        both = 3 << (k - 1)
        if marks[k, i] & VALLEY != 0 and parts & both != 0:
            parts = parts | both
    return parts & ((2 << PARTS) - 2)


@outlined
def divide(
    s: Any, count: int, fine: Any, marks: Any, counts: Any, items: Any, roots: Any, valleys: Any
) -> None:
    """Make items of the parts of cells by their fine samples: of zeros, of valleys, and of parts to be divided again.

    Parameters
    ----------
    s, count, fine, marks
        As for `mark_fine`.
    counts : array of int
        How many items of each kind there are.
    items, roots, valleys : array (rows of an item, items)
        Unresolved cells, zeros and valleys.
    """
    for i in range(count):
        lane, half, upper, level = int(s[LANE, i]), int(s[HALF, i]), s[UPPER, i] > 0.0, int(s[XC, i])
        owner = abs(s[FC, i]) > 1.0
        sign = 1.0 if s[FC, i] > 0.0 else -1.0
        parts = _divided_parts(marks, i, owner) if level < LEVELS else 0
        for k in range(1, PARTS + 2):
            first = k > 1 or owner
            if marks[k, i] & VALLEY != 0 and (parts >> (k - 1)) & 3 == 0 and first:
                # at an end of the range the bracket begins at the end itself
                begin = k if _position(s, i, k - 1) < 0.0 else k - 1
                stop = k if _position(s, i, k + 1) < 0.0 else k + 1
                n, a, b = counts[VALLEYS], _position(s, i, begin), _position(s, i, stop)
                set_bracket(valleys, n, a, fine[begin, i], b, fine[stop, i])
                valleys[XC, n] = _position(s, i, k)
                valleys[FC, n] = fine[k, i]
                counts[VALLEYS] = append_item(valleys, n, lane, half, upper)
            if k > PARTS:
                continue
            if (parts >> k) & 1 != 0:
                n, a, b = counts[UNRESOLVED], _position(s, i, k), _position(s, i, k + 1)
                set_bracket(items, n, a, fine[k, i], b, fine[k + 1, i])
                append_unresolved(items, n, level + 1, sign, (parts >> (k - 1)) & 1 == 0 and first)
                counts[UNRESOLVED] = append_item(items, n, lane, half, upper)
            elif marks[k, i] & ROOT != 0:
                n, a, b = counts[ROOTS], _position(s, i, k), _position(s, i, k + 1)
                set_bracket(roots, n, a, fine[k, i], b, fine[k + 1, i])
                counts[ROOTS] = append_item(roots, n, lane, half, upper)

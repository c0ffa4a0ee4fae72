"""Halves of the range in which a quantity does not change: bars that fold onto each other turn as one.

At a fold a linkage may go on as another: a kite with two of its joints in one place, a parallelogram whose output turns
as its input does. Forces and torques are constant then, and all that samples show of the slope is rounding errors, of
which zeros fill the lists. Arrays are as in `sampling`.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import (
    BEYOND,
    CELLS,
    FIRST,
    PART,
    START,
    TOGGLE,
    append_item,
    set_bracket,
)
from fastlink.numerics.compiler import outlined
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER

__all__ = ["collect_rest", "silence_rest"]

#: A half may be at rest where the greatest slope is so little of the greatest of the half that continues it. It is if
#: one sample in five is 0 or of another sign than the one before: rounding errors are so at every second one, and no
#: quantity has so many extremes.
REST, RESTLESS = 2.0**-20, 5


@outlined
def silence_rest(w: Any, table: Any, samples: Any, marks: Any, part: Any, count: int) -> None:
    """Take the samples of one half of the range away where they are rounding errors beside those of the next half.

    Parameters
    ----------
    w : array (rows, lanes)
        Lane values.
    table, part : array of int
        Tables of the kernel and of the half, see `cells`.
    samples, marks : array (rows, lanes)
        The function's values, and their marks.
    count : int
        The number of designs.
    """
    start, toggle, rows = table[START], table[TOGGLE], 2 * part[CELLS] + 1
    first, beyond = part[FIRST], part[BEYOND]
    for i in range(count):
        lower = (w[start, i] != 0.0) & (w[toggle, i] == 0.0)
        upper = (w[start + 1, i] != 0.0) & (w[toggle + 1, i] == 0.0)
        if lower | upper:
            own, other, restless = 0.0, 0.0, 0
            for j in range(rows):
                f, there, before = (
                    samples[first + j, i],
                    abs(samples[beyond + j, i]),
                    samples[first + max(j - 1, 0), i],
                )
                own = abs(f) if abs(f) > own else own
                other = there if there > other else other
                restless = restless + (1 if (f == 0.0) | ((f > 0.0) != (before > 0.0)) else 0)
            if (own <= REST * other) & (other < INFINITY) & (RESTLESS * restless > rows):
                for j in range(rows):
                    samples[first + j, i] = NOT_A_NUMBER
                    marks[first + j, i] = 0


@outlined
def collect_rest(samples: Any, part: Any, count: int, ends: Any, total: int) -> int:
    """Make items of the middles of halves that were silenced: no extreme, yet the value there may be the greatest.

    Parameters
    ----------
    samples, part, count
        As for `silence_rest`, after it.
    ends : array (rows of an item, items)
        The ends of the range, to which they are appended.
    total : int
        How many these are.
    """
    for i in range(count):
        middle = samples[part[FIRST] + part[CELLS], i]
        if middle != middle:
            set_bracket(ends, total, 1.0, 0.0, 1.0, 0.0)
            total = append_item(ends, total, i, part[PART], False)
    return total

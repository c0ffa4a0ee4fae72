"""Halves of the range in which a quantity does not change: bars that fold onto each other turn as one.

At a fold a linkage may go on as another: a kite with two of its joints in one place, a parallelogram whose output turns
as its input does. Forces and torques are constant then, and all that samples show of the slope is rounding errors, of
which zeros fill the lists. Arrays are as in `sampling`.
"""

from __future__ import annotations

from typing import Any

from fastlink.codegen.runtime.cells import BEYOND, CELLS, FIRST, START, TOGGLE
from fastlink.numerics.compiler import outlined
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER

__all__ = ["silence_rest"]

#: A half is at rest where the greatest slope is so little of the greatest of the half that continues it: some 250
#: roundings. Where both bars of a kite differ by 1e-13, what they do is no greater.
REST = 2.0**-45


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
            own, other = 0.0, 0.0
            for j in range(rows):
                here, there = abs(samples[first + j, i]), abs(samples[beyond + j, i])
                own = here if here > own else own
                other = there if there > other else other
            if (own <= REST * other) & (other < INFINITY):
                for j in range(rows):
                    samples[first + j, i] = NOT_A_NUMBER
                    marks[first + j, i] = 0

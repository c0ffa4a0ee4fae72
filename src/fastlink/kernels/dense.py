"""Dense linear systems in the lanes: LU with partial pivoting, one system per lane.

The matrices stand as a structure of arrays, entry (r, c) of all lanes side by side, so that elimination
vectorises over the lanes. Pivoting is by selection: rows are exchanged lane by lane without a branch.
"""

from __future__ import annotations

from typing import Any

from fastlink.jit import called, inlined

__all__ = ["solve_lanes"]


@called
def _exchange_rows(matrix: Any, upper: int, lower: int, size: int, k: int) -> None:
    """Exchange two rows in the lanes where the lower one has the greater entry in column k."""
    pivot, below = matrix[upper + k], matrix[lower + k]
    for c in range(k + 1, size + 1):
        above, under = matrix[upper + c], matrix[lower + c]
        for i in range(pivot.size):
            greater = abs(below[i]) > abs(pivot[i])
            a, b = above[i], under[i]
            above[i] = b if greater else a
            under[i] = a if greater else b
    # Column k last: it decides the others. Apart from them, because it would alias itself above.
    for i in range(pivot.size):
        a, b = pivot[i], below[i]
        greater = abs(b) > abs(a)
        pivot[i] = b if greater else a
        below[i] = a if greater else b


@inlined
def _subtract_multiple(target: Any, factor: Any, row: Any) -> None:
    for i in range(target.size):
        target[i] -= factor[i] * row[i]


@inlined
def _divide(target: Any, divisor: Any) -> None:
    for i in range(target.size):
        target[i] /= divisor[i]


@called
def solve_lanes(matrix: Any, start: int, size: int) -> None:
    """Solve in place: the last column (right-hand side) becomes the solution.

    Parameters
    ----------
    matrix : array (rows, lanes)
        Scratch; entry (r, c) of this system stands in row ``start + r * (size + 1) + c``.
    start : int
        Row where the system begins.
    size : int
        Number of unknowns.
    """
    width = size + 1
    for k in range(size):
        upper = start + k * width
        for r in range(k + 1, size):
            _exchange_rows(matrix, upper, start + r * width, size, k)
        for r in range(k + 1, size):
            lower = start + r * width
            _divide(matrix[lower + k], matrix[upper + k])
            for c in range(k + 1, width):
                _subtract_multiple(matrix[lower + c], matrix[lower + k], matrix[upper + c])
    for k in range(size - 1, -1, -1):
        result = start + k * width + size
        _divide(matrix[result], matrix[start + k * width + k])
        for r in range(k):
            above = start + r * width
            _subtract_multiple(matrix[above + size], matrix[above + k], matrix[result])

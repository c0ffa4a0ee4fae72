"""Dense linear systems in the lanes: LU with partial pivoting, one system per lane.

The matrices stand as a structure of arrays, entry (r, c) of all lanes side by side, so that elimination
vectorises over the lanes. Pivoting is by selection: rows are exchanged lane by lane without a branch.
"""

from __future__ import annotations

from typing import Any

from fastlink.numerics.compiler import lanes, outlined

__all__ = ["solve_lanes"]


@outlined
def _exchange_rows(matrix: Any, upper: int, lower: int, size: int, k: int, width: int) -> None:
    """Exchange two rows in the lanes where the lower one has the greater entry in column k."""
    for c in range(k + 1, size + 1):
        for i in lanes(width):
            greater = abs(matrix[lower + k, i]) > abs(matrix[upper + k, i])
            a, b = matrix[upper + c, i], matrix[lower + c, i]
            matrix[upper + c, i] = b if greater else a
            matrix[lower + c, i] = a if greater else b
    # Column k last: it decides the others.
    for i in lanes(width):
        a, b = matrix[upper + k, i], matrix[lower + k, i]
        greater = abs(b) > abs(a)
        matrix[upper + k, i] = b if greater else a
        matrix[lower + k, i] = a if greater else b


@outlined
def _subtract_multiple(matrix: Any, target: int, factor: int, row: int, width: int) -> None:
    for i in lanes(width):
        matrix[target, i] -= matrix[factor, i] * matrix[row, i]


@outlined
def _divide(matrix: Any, target: int, divisor: int, width: int) -> None:
    for i in lanes(width):
        matrix[target, i] /= matrix[divisor, i]


@outlined
def solve_lanes(matrix: Any, start: int, size: int, width: int) -> None:
    """Solve in place: the last column (right-hand side) becomes the solution.

    Parameters
    ----------
    matrix : array (rows, lanes)
        Scratch; entry (r, c) of this system stands in row ``start + r * (size + 1) + c``.
    start : int
        Row where the system begins.
    size : int
        Number of unknowns.
    width : int
        Number of lanes.
    """
    length = size + 1
    for k in range(size):
        upper = start + k * length
        for r in range(k + 1, size):
            _exchange_rows(matrix, upper, start + r * length, size, k, width)
        for r in range(k + 1, size):
            lower = start + r * length
            _divide(matrix, lower + k, upper + k, width)
            for c in range(k + 1, length):
                _subtract_multiple(matrix, lower + c, lower + k, upper + c, width)
    for k in range(size - 1, -1, -1):
        result = start + k * length + size
        _divide(matrix, result, start + k * length + k, width)
        for r in range(k):
            above = start + r * length
            _subtract_multiple(matrix, above + size, above + k, result, width)

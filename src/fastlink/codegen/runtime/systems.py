"""Functions of whole systems and cycles in the lanes: dense linear systems, fluctuation over a cycle."""

from __future__ import annotations

from typing import Any

from fastlink.numerics.compiler import lanes, outlined
from fastlink.numerics.elementary import TWO_PI

# -- Dense linear systems in the lanes: LU with partial pivoting, one system per lane

# The matrices stand as a structure of arrays, entry (r, c) of all lanes side by side, so that elimination
# vectorises over the lanes. Pivoting is by selection: rows are exchanged lane by lane without a branch.


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
    """Solve in place: the last column (right-hand side) becomes the solution."""
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


# -- Reductions of a whole cycle at once, not of one input position after the other; lanes are designs


MEAN, TOTAL, LOW, HIGH = range(4)


@outlined
def fluctuation_lanes(curve: Any, result: Any, count: int, width: int, sums: Any) -> None:
    """Store the greatest minus the least value of the integral of a curve less its mean.

    The integral from sample to sample is that of the cubic through four samples (an error of the fourth order in the
    step); between samples, it is greatest or least where the straight line through two of them passes the mean (third
    order). A lane with a NaN gives NaN.
    """
    for r in range(HIGH + 1):
        for i in lanes(width):
            sums[r, i] = 0.0
    for j in range(count):
        for i in lanes(width):
            sums[MEAN, i] += curve[j, i] / count
    for j in range(count):
        before = j - 1 if j > 0 else count - 1
        after = j + 1 if j + 1 < count else j + 1 - count
        # With one position or two the samples repeat.
        later = after + 1 if after + 1 < count else after + 1 - count
        for i in lanes(width):
            excess, following = curve[j, i] - sums[MEAN, i], curve[after, i] - sums[MEAN, i]
            passes = excess * following < 0.0
            turn = sums[TOTAL, i] + (0.5 * (excess * excess) / (excess - following) if passes else 0.0)
            sums[LOW, i] = turn if turn < sums[LOW, i] else sums[LOW, i]
            sums[HIGH, i] = turn if turn > sums[HIGH, i] else sums[HIGH, i]
            near, far = curve[j, i] + curve[after, i], curve[before, i] + curve[later, i]
            sums[TOTAL, i] += (13.0 * near - far) / 24.0 - sums[MEAN, i]
    for i in lanes(width):
        # Zero times the mean is the NaN of a curve that has one.
        result[i] = (sums[HIGH, i] - sums[LOW, i]) * (TWO_PI / count) + 0.0 * sums[MEAN, i]

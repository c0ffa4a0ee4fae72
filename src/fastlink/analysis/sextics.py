"""The coupler sextic over complex and double numbers, for both planes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

__all__ = ["coupler_sextic"]

#: Designs at once. Their coefficients stay in the cache; the powers are the first two axes, so that operations on one
#: coefficient run over all designs (ten times as fast as with powers last and all designs at once).
BLOCK = 512


def _polynomial(size: int, **terms: Any) -> Any:
    """Return coefficients (size, size, designs) of terms such as x1y2 for X Y^2."""
    result = np.zeros((size, size, next(iter(terms.values())).size))
    for powers, coefficient in terms.items():
        result[int(powers[1]), int(powers[3])] = coefficient
    return result


def _product(f: Any, g: Any) -> Any:
    """Multiply polynomials in X and Y of degree n - 1, coefficients (n, n, designs)."""
    n = f.shape[0]
    powers = [(i, j) for i in range(n) for j in range(n - i)]
    result = np.zeros((2 * n - 1, 2 * n - 1, *f.shape[2:]))
    for i, j in powers:
        for k, m in powers:
            result[i + k, j + m] += f[i, j] * g[k, m]
    return result


def coupler_sextic(jj: int, lengths: Sequence[Any], point: Sequence[Any]) -> Any:
    """Return the coefficients (..., 7, 7) of the sextic of all coupler points.

    Parameters
    ----------
    jj : {-1, 1}
        The square of the unit j: -1 for the Euclidean plane of the complex numbers, 1 for the Minkowskian plane of
        the double numbers.
    lengths : sequence of ndarray
        Those of crank, coupler, output link and ground, of one shape.
    point : sequence of ndarray
        u and v of the coupler point p = u + j v in the coupler's frame.

    Notes
    -----
    With N(z) = z conj(z) and the W and V of `fastlink.planar.sextic` the equation is
    N(W) + 4 jj V^2 = 0: its elimination depends neither on the sign of j^2 nor on that of N(p).

    Examples
    --------
    >>> import numpy as np
    >>> c = coupler_sextic(1, np.array([3.0, 4.0, 5.0, 6.0]), np.zeros(2))  # p = 0: on X^2 - Y^2 = 9
    >>> float(np.polynomial.polynomial.polyval2d(5.0, 4.0, c))
    0.0
    """
    shape = np.shape(lengths[0])
    columns = np.array([np.ravel(number) for number in (*lengths, *point)])
    result = np.empty((columns.shape[1], 7, 7))
    for first in range(0, len(result), BLOCK):
        part = slice(first, first + BLOCK)
        result[part] = np.moveaxis(_sextics(jj, columns[:, part]), -1, 0)
    return result.reshape(*shape, 7, 7)


def _sextics(jj: int, columns: Any) -> Any:
    """Return the coefficients (7, 7, designs) of designs, one a column."""
    crank, coupler, output, ground, u, v = columns
    square = (u - v) * (u + v) if jj > 0 else u * u + v * v
    k = square - crank * crank
    middle = 2.0 * coupler * u - (crank - output) * (crank + output) - coupler * coupler - ground * ground
    along, across = u / coupler, v / coupler
    # g = ground z^2 + middle z - k ground, then W = (N(z) + k)(z - ground) - (along - j across) g.
    real = _polynomial(4, x2y0=ground, x0y2=jj * ground, x1y0=middle, x0y0=-k * ground)
    unit = _polynomial(4, x1y1=2.0 * ground, x0y1=middle)
    one = np.ones_like(ground)
    W_real = _polynomial(
        4, x3y0=one, x1y2=-jj * one, x2y0=-ground, x0y2=jj * ground, x1y0=k, x0y0=-k * ground
    )
    W_real -= along * real - jj * across * unit
    W_unit = _polynomial(4, x2y1=one, x0y3=-jj * one, x0y1=k) - (along * unit - across * real)
    V = _polynomial(4, x0y1=ground * (square / coupler - u), x2y0=-v, x0y2=jj * v, x1y0=v * ground)
    return _product(W_real, W_real) - jj * _product(W_unit, W_unit) + 4.0 * jj * _product(V, V)

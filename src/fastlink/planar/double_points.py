"""Where the coupler curve of a planar 4R crosses itself."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["crunodes"]

#: Directions of which one at least is far from the roots of any cubic form.
DIRECTIONS = np.arange(7) * (np.pi / 7.0)


def _cubic_form(k: Any, x: Any, y: Any) -> Any:
    """Return k3 x^3 + k2 x^2 y + k1 x y^2 + k0 y^3."""
    return ((k[..., 3] * x + k[..., 2] * y) * x + k[..., 1] * y * y) * x + k[..., 0] * y * y * y


def _turned(k: Any, c: Any, s: Any) -> Any:
    """Return the coefficients of a cubic form in t, for x = c t - s and y = s t + c."""
    result = np.zeros(k.shape)
    for power in range(4):
        term = [k[..., power]]
        for low, high in [(-s, c)] * power + [(c, s)] * (3 - power):
            lower, higher = [part * low for part in term], [part * high for part in term]
            term = [lower[0], *(one + two for one, two in zip(lower[1:], higher, strict=False)), higher[-1]]
        for i in range(4):
            result[..., i] += term[i]
    return result


def _real_roots(k: Any) -> tuple[Any, Any]:
    """Return the real zeros (x, y) of cubic forms, three in the last axis, NaN where a zero is not real."""
    values = _cubic_form(k[..., None, :], np.cos(DIRECTIONS), np.sin(DIRECTIONS))
    best = DIRECTIONS[np.argmax(np.abs(values), axis=-1)]
    c, s = np.cos(best), np.sin(best)
    turned = _turned(k, c, s)
    companion = np.zeros((*k.shape[:-1], 3, 3))
    companion[..., 1, 0] = companion[..., 2, 1] = 1.0
    companion[..., :, 2] = -turned[..., :3] / turned[..., 3:]
    good: Any = np.isfinite(companion).all(axis=(-2, -1))
    roots = np.linalg.eigvals(np.where(good[..., None, None], companion, 0.0))
    t = np.where((roots.imag == 0.0) & good[..., None], roots.real, np.nan)
    x, y = c[..., None] * t - s[..., None], s[..., None] * t + c[..., None]
    size = np.hypot(x, y)
    return x / size, y / size


def crunodes(a1: Any, a2: Any, a3: Any, a4: Any, P_u: Any, P_v: Any) -> tuple[Any, Any, Any]:
    r"""Return the points where the coupler curve of a linkage crosses itself.

    Parameters
    ----------
    a1, a2, a3, a4 : float or array_like
        Lengths of crank, coupler, output link and ground [m], broadcast with the coupler point.
    P_u, P_v : float or array_like
        The coupler point, along AB from A and to the left of AB [m].

    Returns
    -------
    X, Y : ndarray, shape (..., 3)
        The crunodes in the ground frame [m] by growing X, NaN-padded. The curve is that of both branches: two
        configurations of the linkage meet there, of one branch or of both.
    count : ndarray of int, shape (...)
        Their number. Where it changes from one design to the next, the curve has a cusp (a crunode turns into an
        isolated double point) or touches itself. It is 0 if P is A or B, which move on circles.

    Notes
    -----
    With the notation of `sextic`, two coupler angles for one point make its two linear equations one:
    (A_2, B_2, C_2) is a multiple of (A_1, B_1, C_1). The first two say that the point lies on the circle of
    singular foci, through O, D and the third pivot of the cognates,

    .. math::
        z = a_4/(1 + \sigma g), \quad g = \bar p q/(|p||q|), \quad \sigma \text{ real},
        \quad A_2 + i B_2 = -\sigma (|q|/|p|)(A_1 + i B_1),

    and the third is then a cubic for sigma, Roberts' three double points:

    .. math::
        a_4^2 \sigma (|q| + \sigma |p|) + (1 + 2 \sigma \mathrm{Re}\,g + \sigma^2)
        [(|q|^2 - a_3^2)|p| + \sigma |q| (|p|^2 - a_1^2)] = 0.

    The linkage reaches it if the sides abs(z), abs(p) and a1 form a triangle; else it is an isolated point of
    the sextic. Where the sextic falls apart into curves of lower degree (parallelogram and kite), double points
    coincide; they are listed as often as the cubic has them.

    Examples
    --------
    >>> import fastlink as fl
    >>> X, Y, count = fl.planar.crunodes(1.0, 2.5, 2.5, 2.0, 1.25, 1.0)
    >>> int(count), round(float(X[0]), 4), round(float(Y[0]), 4)
    (1, 1.7287, -0.9459)
    """
    numbers = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in (a1, a2, a3, a4, P_u, P_v)))
    a1, a2, a3, a4, u, v = numbers
    p, q = np.hypot(u, v), np.hypot(u - a2, v)
    with np.errstate(invalid="ignore", divide="ignore"):  # P is A or B
        cosine, sine = (u * (u - a2) + v * v) / (p * q), a2 * v / (p * q)
        first, last = (q - a3) * (q + a3) * p, (p - a1) * (p + a1) * q
        square = a4 * a4
        k = np.stack(
            [
                first,
                2.0 * cosine * first + last + square * q,
                first + 2.0 * cosine * last + square * p,
                last,
            ],
            axis=-1,
        )
        x, y = _real_roots(k)
        # z = a4 y/(y + x g)
        real, imaginary = y + x * cosine[..., None], x * sine[..., None]
        scale = a4[..., None] * y / (real * real + imaginary * imaginary)
        X, Y = scale * real, -scale * imaginary
        reach, crank = np.hypot(X, Y), a1[..., None]
        there = (np.abs(reach - p[..., None]) < crank) & (crank < reach + p[..., None])
    X, Y = np.where(there, X, np.nan), np.where(there, Y, np.nan)
    order = np.argsort(X, axis=-1)
    return (
        np.take_along_axis(X, order, axis=-1),
        np.take_along_axis(Y, order, axis=-1),
        np.sum(there, axis=-1),
    )

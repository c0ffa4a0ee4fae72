"""Find the point of a focal cubic that is nearest to a given point."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.analysis.focal.cubic import coefficients, trace

__all__ = ["nearest_point"]

#: Points that are searched at once; each has some thousand points of its cubic beside it.
BLOCK = 500
#: Points on each of eight arcs from which Newton's iteration starts, and its steps.
SAMPLES, STEPS = 100, 12
#: Over the longest bar, what is no farther off than this is on the cubic.
ON_IT = 1e-9


def nearest_point(position: tuple[Any, ...], z: Any) -> Any:
    """Return the points of focal cubics that are nearest to points z, as complex numbers.

    Parameters
    ----------
    position : tuple of ndarray
        a, b, c, d, phi and branch.
    z : ndarray of complex
        The points, of the same shape.
    """
    shape = z.shape
    *lengths, phi, branch = (np.ravel(value) for value in position)
    z = np.ravel(z)
    size = 2.0 ** np.ceil(np.log2(np.max(lengths, axis=0)))
    plain = (*(length / size for length in lengths), phi, branch)
    k = np.moveaxis(coefficients(*plain), 0, -1)
    start = z / size
    found = onto(k, start)
    # on which side of the curve a point lies is rounding; farther ones need the whole curve
    off = np.abs(found - start)
    far = np.flatnonzero(~(off <= ON_IT) & np.isfinite(k[0, 1]))
    for begin in range(0, far.size, BLOCK):
        some = far[begin : begin + BLOCK]
        traced = trace((value[some] for value in plain), SAMPLES)
        found[some] = _nearest_of(k[..., some], start[some], traced[..., 0] + 1j * traced[..., 1])
    return (found * size).reshape(shape)


def _nearest_of(k: Any, start: Any, traced: Any) -> Any:
    """Return the point of each cubic that is nearest to a point, from points all along the cubic."""
    distances = np.abs(traced - start[:, None])
    distances[np.isnan(distances)] = np.inf
    sample = np.take_along_axis(traced, distances.argmin(axis=1)[:, None], axis=1)[:, 0]
    # far out the cubic is traced in great steps, and next to its asymptote
    with np.errstate(all="ignore"):
        asymptote = (k[0, 3] - 1j * k[3, 0]) / np.hypot(k[0, 3], k[3, 0])
        far = asymptote * (start * np.conj(asymptote)).real
    found = [
        onto(k, way(begin)) for begin in (sample, far) for way in (lambda z: _foot(k, start, z), np.copy)
    ]
    off = np.stack([np.where(_is_on(k, z), np.abs(z - start), np.inf) for z in found])
    return np.take_along_axis(np.stack(found), off.argmin(axis=0)[None], axis=0)[0]


def _is_on(k: Any, z: Any) -> Any:
    """Tell whether points are on cubics, but for roundings."""
    value, slope, *_ = gradient(k, z)
    with np.errstate(all="ignore"):
        return np.abs(value) <= ON_IT * np.abs(slope) * (1.0 + np.abs(z))


def gradient(k: Any, z: Any) -> tuple[Any, Any, Any, Any, Any]:
    """Return the polynomial k of cubics, its gradient as a complex number, and its second derivatives xx, xy, yy."""
    x, y = z.real, z.imag
    value = k[0, 1] * y + x * (k[1, 0] + x * (k[2, 0] + x * k[3, 0]))
    value = value + y * (k[1, 1] * x + k[2, 1] * x * x + y * (k[0, 2] + k[1, 2] * x + k[0, 3] * y))
    by_x = (
        k[1, 0] + 2.0 * k[2, 0] * x + 3.0 * k[3, 0] * x * x + y * (k[1, 1] + 2.0 * k[2, 1] * x + k[1, 2] * y)
    )
    by_y = (
        k[0, 1] + 2.0 * k[0, 2] * y + 3.0 * k[0, 3] * y * y + x * (k[1, 1] + k[2, 1] * x + 2.0 * k[1, 2] * y)
    )
    xx = 2.0 * k[2, 0] + 6.0 * k[3, 0] * x + 2.0 * k[2, 1] * y
    yy = 2.0 * k[0, 2] + 6.0 * k[0, 3] * y + 2.0 * k[1, 2] * x
    return value, by_x + 1j * by_y, xx, k[1, 1] + 2.0 * k[2, 1] * x + 2.0 * k[1, 2] * y, yy


def onto(k: Any, z: Any) -> Any:
    """Return points of the cubics, from points near them along the gradient."""
    for _ in range(4):
        value, slope, *_ = gradient(k, z)
        with np.errstate(all="ignore"):
            step = value * slope / (slope.real**2 + slope.imag**2)
        z = z - np.where(np.isfinite(step), step, 0.0)
    return z


def _foot(k: Any, start: Any, z: Any) -> Any:
    """Return the point where the normal of each cubic goes through a point, by Newton's iteration."""
    _, slope, *_ = gradient(k, z)
    with np.errstate(all="ignore"):
        multiplier = ((start - z) * np.conj(slope)).real / np.abs(slope) ** 2
        for _ in range(STEPS):
            value, slope, xx, xy, yy = gradient(k, z)
            # z - start + multiplier slope = 0 and value = 0
            left = start - z - multiplier * slope
            a, b, c = 1.0 + multiplier * xx, multiplier * xy, 1.0 + multiplier * yy
            determinant = a * c - b * b
            # the first two equations by the change of the multiplier
            by_left = ((c * left.real - b * left.imag) + 1j * (a * left.imag - b * left.real)) / determinant
            by_slope = (
                (c * slope.real - b * slope.imag) + 1j * (a * slope.imag - b * slope.real)
            ) / determinant
            change = ((by_left * np.conj(slope)).real + value) / (by_slope * np.conj(slope)).real
            step = by_left - change * by_slope
            sure = np.isfinite(step)
            z = z + np.where(sure, step, 0.0)
            multiplier = multiplier + np.where(sure, change, 0.0)
    return z

"""Motions of the Minkowskian plane: boosts and translations (section 2.2 of the paper)."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.analysis.minkowski.vectors import grown, number, read
from fastlink.doors import door

__all__ = ["boost", "motion", "moved"]


@door
def boost(phi: Any) -> Any:
    """Return the matrix A(phi) of the proper Lorentzian group SO+(1, 1).

    Hegedues and Moore, section 2.2: rows (ch phi, sh phi) and (sh phi, ch phi). Products of boosts add their angles,
    the inverse is A(-phi), and scalar products, causal types and orientations stay.

    Parameters
    ----------
    phi : float or array_like
        The angle, NaN where there is none.

    Returns
    -------
    ndarray, shape (..., 2, 2)
        The matrices.

    Raises
    ------
    InputError
        The angle is not a finite number.

    Examples
    --------
    >>> import fastlink as fl, numpy as np
    >>> fl.minkowski.boost(np.log(2.0)) @ [4.0, 0.0]
    array([5., 3.])
    """
    (phi,) = read("boost", {}, [(number("phi", "angle of a boost"), phi)])
    return motion(phi)[..., :2, :2]


@door
def motion(t: Any, a: Any = 0.0, b: Any = 0.0) -> Any:
    """Return the matrix of a motion of the Minkowskian plane in homogeneous coordinates.

    Hegedues and Moore, section 2.2: the group of the matrices with rows (ch t, sh t, a), (sh t, ch t, b) and (0, 0, 1),
    a boost by t followed by a translation.

    Parameters
    ----------
    t : float or array_like
        The angle of the boost.
    a, b : float or array_like, optional
        The translation [m]. All broadcast.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        The matrices; what is beyond the range of doubles is infinite.

    Raises
    ------
    InputError
        A value is not a finite number, or the shapes do not broadcast.

    Examples
    --------
    >>> import fastlink as fl, numpy as np
    >>> fl.minkowski.motion(np.log(2.0), 1.0, -3.0) @ [4.0, 0.0, 1.0]
    array([6., 0., 1.])
    """
    t, a, b = read("motion", {}, _numbers(t, a, b))
    with np.errstate(over="ignore"):
        ch, sh = np.cosh(t), np.sinh(t)
    rows = [[ch, sh, a], [sh, ch, b], [0.0 * t, 0.0 * t, 0.0 * t + 1.0]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


@door
def moved(z: Any, t: Any, a: Any = 0.0, b: Any = 0.0) -> Any:
    """Move points by a boost and a translation, in null coordinates.

    The motion of `fastlink.minkowski.motion`, Hegedues and Moore, section 2.2: x + y is multiplied by e^t, x - y by
    e^-t. A point near the light cone keeps its digits where the matrix cancels.

    Parameters
    ----------
    z : array_like, shape (..., 2)
        Points x, y [m]; NaN where there is none.
    t : float or array_like
        The angle of the boost.
    a, b : float or array_like, optional
        The translation [m]. All broadcast.

    Returns
    -------
    ndarray, shape (..., 2)
        The points; what is beyond the range of doubles is infinite.

    Raises
    ------
    InputError
        A point has not two coordinates along its last axis, a value is not finite, or the shapes do not broadcast.

    Examples
    --------
    >>> import fastlink as fl, numpy as np
    >>> fl.minkowski.moved([4.0, 0.0], np.log(2.0), 1.0, -3.0)
    array([6., 0.])
    """
    (x, y), t, a, b = read("moved", {"z": z}, _numbers(t, a, b))
    u, v = grown(0.5 * x + 0.5 * y, t), grown(0.5 * x - 0.5 * y, -t)
    with np.errstate(over="ignore", invalid="ignore"):
        return np.stack([(u + v) + a, (u - v) + b], axis=-1)


def _numbers(t: Any, a: Any, b: Any) -> list[Any]:
    """Return the declarations of the numbers of a motion, with their values."""
    along, across = number("a", "translation along x", "m"), number("b", "translation along y", "m")
    return [(number("t", "angle of a boost"), t), (along, a), (across, b)]

"""Length and area of coupler curves, to the last digits and with their errors."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fastlink.analysis.designs import BY_NAME
from fastlink.analysis.planar.curves import curve_inputs
from fastlink.analysis.planar.path import paths_of
from fastlink.analysis.quadrature import integrate
from fastlink.doors import door
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.options import check_switch

__all__ = ["curve_area", "curve_length"]

#: Designs that are integrated at a time: their nodes fit the cache.
BLOCK = 256


@door(hint=BY_NAME)
def curve_length(design: Any = None, *, branch: Any = 1, error: bool = False, **inputs: Any) -> Any:
    """Return the length of the path of the coupler point in an assembly mode [m].

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        Inputs of ``planar_4r`` by name: lengths ``a1`` ... ``a4`` and coupler point ``P_u``, ``P_v`` [m], broadcast.
        Other inputs are not read.
    branch : int or array_like
        Assembly mode, broadcast with the design.
    error : bool
        Whether to return a bound of the error too.
    **inputs : float, array_like or xarray.DataArray
        The same by name.

    Returns
    -------
    length : ndarray
        One turn where the input turns fully, else all input angles at which the linkage assembles, once: the whole
        curve is that of both modes. NaN where it assembles nowhere.
    error : ndarray
        With ``error=True``: a bound of the absolute error [m].

    Notes
    -----
    The integral of the speed by adaptive Gauss rules, each design on panels of its own; between toggles by the root
    of the distance from these. The error is below 1e-12 of the length, also with cusps and next to change
    points, but where the point hardly moves for the lengths of the links, and their roundings count:
    docs/numerics.md#integrals-along-coupler-curves.

    Examples
    --------
    >>> import fastlink as fl
    >>> design = dict(a1=0.5, a2=1.2, a3=0.8, a4=1.0, P_u=0.0, P_v=0.0)
    >>> length, error = fl.planar.curve_length(design, error=True)
    >>> round(float(length), 12), bool(error < 1e-12)  # P = A: 2 pi a1
    (3.14159265359, True)
    """
    return _integral("curve_length", (design, branch, error, inputs), 1, _speed)


@door(hint=BY_NAME)
def curve_area(design: Any = None, *, branch: Any = 1, error: bool = False, **inputs: Any) -> Any:
    """Return the area that the coupler curve encloses over one turn of the input [m2].

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        Inputs of ``planar_4r`` by name: lengths ``a1`` ... ``a4`` and coupler point ``P_u``, ``P_v`` [m], broadcast.
        Other inputs are not read.
    branch : int or array_like
        Assembly mode, broadcast with the design.
    error : bool
        Whether to return a bound of the error too.
    **inputs : float, array_like or xarray.DataArray
        The same by name.

    Returns
    -------
    area : ndarray
        The signed area, half the integral of x dy - y dx: parts that the curve runs around to the left
        as theta1 grows count positive, to the right negative (the loops of a figure eight subtract). NaN where
        the input does not turn fully: the path of one assembly mode is not closed then.
    error : ndarray
        With ``error=True``: a bound of the absolute error [m2].

    Notes
    -----
    Computed as in `curve_length`; the error is below 1e-12 of the area that the ray from O to P sweeps, forth and
    back added.

    Examples
    --------
    >>> import fastlink as fl
    >>> design = dict(a1=0.5, a2=1.2, a3=0.8, a4=1.0, P_u=0.0, P_v=0.0)
    >>> round(float(fl.planar.curve_area(design)), 12)  # P = A: pi a1^2
    0.785398163397
    """
    return _integral("curve_area", (design, branch, error, inputs), 2, _swept)


def _speed(point: Any, velocity: Any, noise: Any) -> tuple[Any, Any]:
    """Return the speed along a path and a bound of its roundings."""
    return np.hypot(velocity.real, velocity.imag), noise


def _swept(point: Any, velocity: Any, noise: Any) -> tuple[Any, Any]:
    """Return the area that the ray from O sweeps per step, and a bound of its roundings."""
    size = np.abs(point)
    return 0.5 * (point.conj() * velocity).imag, size * (noise + 16.0 * UNIT_ROUNDING * np.abs(velocity))


def _integral(
    function: str, called: tuple[Any, Any, Any, Any], power: int, integrand: Callable[[Any, Any, Any], Any]
) -> Any:
    """Return an integral along coupler curves, a power of a length, with its error where that is asked for."""
    design, branch, with_error, inputs = called
    with_error = check_switch((function, "error"), with_error)
    curve = curve_inputs(function, design, inputs, branch)
    shape = curve["a1"].shape
    columns = {name: values.reshape(-1) for name, values in curve.items()}
    results = np.empty((2, columns["a1"].size))
    with np.errstate(all="ignore"):
        for start in range(0, results.shape[1], BLOCK):
            block = slice(start, start + BLOCK)
            part = {name: values[block] for name, values in columns.items()}
            results[:, block] = _of_block(part, power, integrand)
    value, bound = results.reshape(2, *shape)[:, ...]
    return (value[()], bound[()]) if with_error else value[()]


def _of_block(curve: dict[str, Any], power: int, integrand: Callable[[Any, Any, Any], Any]) -> Any:
    paths = paths_of(curve)
    owner, sign, end, width, layer = paths.pieces()

    def along(piece: Any, v: Any) -> tuple[Any, Any]:
        value, noise = integrand(*paths.motion(owner[piece], sign[piece], end[piece], v))
        return value, noise

    exists = np.isfinite(paths.extent) & ((power == 1) | ~paths.toggles.any(axis=0))
    sums = np.array(integrate(along, owner, width, layer, exists.size))
    return np.where(exists, np.ldexp(sums, power * paths.exponent), np.nan)

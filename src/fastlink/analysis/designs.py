"""Check and broadcast the numbers of one or many designs for functions of both planes."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.errors import InputError

__all__ = ["CURVE", "broadcast", "check_range", "curve_designs"]

#: The inputs of planar_4r that must be lengths, and those that determine a coupler curve.
LENGTHS = ("a1", "a2", "a3", "a4")
CURVE = (*LENGTHS, "P_u", "P_v")
#: Those of minkowski_4r.
MINKOWSKI_LENGTHS = ("a", "b", "g", "h")


def broadcast(function: str, **numbers: Any) -> list[Any]:
    """Return numbers as arrays of one shape.

    Parameters
    ----------
    function : str
        The calling function, for messages.
    **numbers : float or array_like
        The numbers by name; a1 ... a4 and a, b, g, h must be positive and finite.

    Raises
    ------
    InputError
        A value is not a number or not a length, or the shapes do not broadcast.

    Examples
    --------
    >>> broadcast("sextic", a1=1.0, P_u=[0.0, 2.0])
    [array([1., 1.]), array([0., 2.])]
    """
    arrays = {}
    for name, value in numbers.items():
        try:
            arrays[name] = np.asarray(value, dtype=float)
        except (TypeError, ValueError) as error:
            raise InputError(f"{function}: {name} is not a number or an array of numbers") from error
        if name in LENGTHS + MINKOWSKI_LENGTHS and not np.all(
            (arrays[name] > 0.0) & np.isfinite(arrays[name])
        ):
            raise InputError(f"{function}: {name} must be positive and finite")
    try:
        return list(np.broadcast_arrays(*arrays.values()))
    except ValueError as error:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items() if array.ndim)
        raise InputError(f"{function}: shapes do not broadcast: {shapes}") from error


def curve_designs(function: str, *numbers: Any) -> list[Any]:
    """Return the numbers of `CURVE`, in that order, as arrays of one shape."""
    return broadcast(function, **dict(zip(CURVE, numbers, strict=True)))


def check_range(function: str, name: str, values: Any, limits: tuple[float, float], products: str) -> None:
    """Refuse lengths whose products, the coefficients of a curve, would overflow or vanish."""
    least, greatest = limits
    if not np.all((values >= least) & (values <= greatest)):
        raise InputError(
            f"{function}: {name} must be in {least:g} ... {greatest:g}, as coefficients are products of {products}; "
            "write the design in another unit of length"
        )

"""Exchange the ground for the coupler: the focal mechanism with AB held fixed (Wunderlich, section 3)."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.analysis.designs import read_design
from fastlink.analysis.focal.construction import RATIOS
from fastlink.doors import door
from fastlink.errors import InputError
from fastlink.mechanisms.focal import focal

__all__ = ["held_at_AB"]


@door(hint="inputs are given by name, such as a=5.0, or as one mapping")
def held_at_AB(design: Any = None, **inputs: Any) -> dict[str, Any]:
    """Return the focal mechanism that a focal mechanism is with AB held fixed.

    Its M, N, A, B, S, T are A, B, M, N, T, S of the other one; P, Q and F stay.

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        Inputs of ``focal`` by name: ``a``, ``b``, ``c``, ``d``, one of ``rho``, ``s`` and ``lambda_``, and
        ``completion`` unless it is to be both. Other inputs are not read.
    **inputs : float, array_like or xarray.DataArray
        The same by name.

    Returns
    -------
    dict of str to ndarray
        The same inputs of the mechanism that stands on AB, as `fastlink.sweep` takes them.

    Raises
    ------
    InputError
        The design lacks a number, or one is not valid.

    Notes
    -----
    c and d are exchanged, rho stays, lambda becomes lambda/(lambda - 1), and so completions by rho or s are exchanged.
    Where the one is at phi and psi, with AB in the direction theta, the other is at phi + pi - theta, in branch 1 where
    sin(psi) > 0, else in branch 2. `F_along_AB`, `F_across_AB` and their like are quantities of the first.

    Examples
    --------
    >>> import fastlink as fl
    >>> chebyshev = {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0, "completion": 1}
    >>> held = fl.focal.held_at_AB(chebyshev)
    >>> {name: float(value) for name, value in held.items()}
    {'a': 5.0, 'b': 5.0, 'c': 4.0, 'd': 2.0, 'rho': 1.0, 'completion': 2.0}
    >>> radius = fl.evaluate("focal", ["r"], **held, phi=1.0)["r"]  # F runs on a circle about T
    >>> bool(radius == fl.evaluate("focal", ["FT"], **chebyshev, phi=1.0)["FT"])
    True
    """
    bars, optional = ("a", "b", "c", "d"), (*RATIOS, "completion")
    given = read_design("held_at_AB", focal, design, inputs, bars, optional=optional)
    by = next((name for name in RATIOS if name in given), "")
    if not by:
        what = f"{', '.join(RATIOS[:-1])} and {RATIOS[-1]} are missing"
        raise InputError(what, where=("held_at_AB",), remedy="give one of them")
    ratio, completion = given[by], given.get("completion")
    with np.errstate(all="ignore"):
        held = {"rho": ratio, "s": ratio / given["d"] * given["c"], "lambda_": 1.0 + 1.0 / (ratio - 1.0)}[by]
    found = {"a": given["a"], "b": given["b"], "c": given["d"], "d": given["c"], by: held}
    if completion is not None:
        found["completion"] = completion if by == "lambda_" else 3.0 - completion
    return found

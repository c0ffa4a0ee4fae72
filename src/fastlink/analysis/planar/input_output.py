"""Coefficients of the six algebraic input-output equations of the planar 4R."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink._text import short_repr
from fastlink.analysis.designs import BY_NAME, read_design
from fastlink.doors import door
from fastlink.errors import InputError, listed
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.mechanisms.planar_4r.residuals import IO_CROSS, IO_PRODUCTS

__all__ = ["io_coefficients"]


@door(hint=BY_NAME)
def io_coefficients(design: Any = None, *, pair: str = "14", **inputs: Any) -> Any:
    """Return the coefficients of an input-output equation, eqs. (1) to (6) of Hayes.

    With v_i = tan(joint_angle_i/2) for the joint angles of the closed polygon a1, a2, a3, a4 (quantities ``v1``
    ... ``v4``), the equation of joints i and j is::

        c[0] v_i^2 v_j^2 + c[1] v_i^2 + c[2] v_j^2 + c[3] v_i v_j + c[4] = 0

    In terms of the ground-frame angles, joint_angle_1 = theta1 - pi and joint_angle_4 = -theta4. Each
    coefficient is the product of two factors that are summed without loss, and right to three roundings, near change
    points too; a factor is zero only where the lengths as given are at a change point exactly.

    Parameters
    ----------
    design : mapping, pandas.DataFrame or xarray.Dataset, optional
        Inputs of ``planar_4r`` by name: the lengths ``a1`` ... ``a4`` [m], broadcast. Other inputs are not read.
    pair : {"12", "13", "14", "23", "24", "34"}
        The two joints: eqs. (2), (3), (1), (4), (5), (6).
    **inputs : float, array_like or xarray.DataArray
        The same by name.

    Returns
    -------
    ndarray
        The five coefficients in m2, shape (..., 5).

    Raises
    ------
    InputError
        A length is not positive and finite, the lengths do not broadcast, or there is no such pair.

    Examples
    --------
    >>> import fastlink as fl
    >>> fl.planar.io_coefficients(a1=4.0, a2=12.0, a3=8.0, a4=10.0, pair="14")
    array([-140.,   52., -108., -256.,  340.])
    """
    if not isinstance(pair, str) or pair not in IO_PRODUCTS:
        where, remedy = ("io_coefficients", "pair"), listed(list(IO_PRODUCTS))
        raise InputError(f"{short_repr(pair)} is unknown", where=where, remedy=remedy)
    lengths = [*read_design("io_coefficients", planar_4r, design, inputs, ("a1", "a2", "a3", "a4")).values()]

    def factor(name: str) -> Any:
        return planar_4r.facts[f"factor_{name}"].function(*lengths)[0]

    _equation, *products = IO_PRODUCTS[pair]
    vivj, vi, vj, one = (factor(x) * factor(y) for x, y in (str(product).split() for product in products))
    cross = np.zeros_like(lengths[0])
    if pair in IO_CROSS:
        number, x, y = IO_CROSS[pair]
        cross = number * (lengths[int(x) - 1] * lengths[int(y) - 1])
    return np.stack(np.broadcast_arrays(vivj, vi, vj, cross, one), axis=-1)

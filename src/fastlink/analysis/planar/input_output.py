"""Coefficients of the six algebraic input-output equations of the planar 4R."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.analysis.designs import broadcast
from fastlink.doors import door
from fastlink.errors import InputError, suggest
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.mechanisms.planar_4r.residuals import IO_CROSS, IO_PRODUCTS

__all__ = ["io_coefficients"]


@door
def io_coefficients(a1: Any, a2: Any, a3: Any, a4: Any, pair: str = "14") -> Any:
    """Return the coefficients of an input-output equation, eqs. (1) to (6) of Hayes.

    With v_i = tan(joint_angle_i/2) for the joint angles of the closed polygon a1, a2, a3, a4 (quantities ``v1``
    ... ``v4``), the equation of joints i and j is::

        c[0] v_i^2 v_j^2 + c[1] v_i^2 + c[2] v_j^2 + c[3] v_i v_j + c[4] = 0

    In terms of the ground-frame angles, joint_angle_1 = theta1 - pi and joint_angle_4 = -theta4. Each
    coefficient is the product of two factors that are summed without loss, and right to three roundings, near change
    points too; a factor is zero only where the lengths as given are at a change point exactly.

    Parameters
    ----------
    a1, a2, a3, a4 : array_like
        Lengths of crank, coupler, output link and ground link in m, positive; broadcast against each other.
    pair : {"12", "13", "14", "23", "24", "34"}
        The two joints: eqs. (2), (3), (1), (4), (5), (6).

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
    >>> fl.planar.io_coefficients(4.0, 12.0, 8.0, 10.0, pair="14")
    array([-140.,   52., -108., -256.,  340.])
    """
    if pair not in IO_PRODUCTS:
        raise InputError(f"io_coefficients: pair {pair!r} is unknown; {suggest(str(pair), IO_PRODUCTS)}")
    lengths = broadcast("io_coefficients", a1=a1, a2=a2, a3=a3, a4=a4)

    def factor(name: str) -> Any:
        return planar_4r.facts[f"factor_{name}"].function(*lengths)[0]

    _equation, *products = IO_PRODUCTS[pair]
    vivj, vi, vj, one = (factor(x) * factor(y) for x, y in (str(product).split() for product in products))
    cross = np.zeros_like(lengths[0])
    if pair in IO_CROSS:
        number, x, y = IO_CROSS[pair]
        cross = number * (lengths[int(x) - 1] * lengths[int(y) - 1])
    return np.stack(np.broadcast_arrays(vivj, vi, vj, cross, one), axis=-1)

"""Integrate functions of many designs at once, each to its own accuracy and with its own error."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fastlink.numerics.compensated import UNIT_ROUNDING

__all__ = ["integrate"]

# scipy.integrate has quad_vec and cubature, which refine all functions where one of them needs it, and quad, which
# takes one function of one design; kinks lie elsewhere in each design, so that the first evaluate a thousand designs
# a thousand times too often.

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
#: Gauss's weights on (0, 1), and its nodes between two next to the ends: a pole or a zero may lie at the first end.
WEIGHTS, NODES = 0.5 * _WEIGHTS, np.concatenate([[1e-6], 0.5 * (_NODES + 1.0), [1.0]])
#: Takes values at Gauss's nodes to those of their polynomial at the ends.
_AT_ALL = np.polynomial.legendre.legvander(2.0 * NODES - 1.0, _NODES.size - 1)
TO_ENDS = (_AT_ALL[[0, -1]] @ np.linalg.inv(_AT_ALL[1:-1])).T
#: A panel is halved until its two halves change it by less than this part of the whole integral of magnitudes.
PANEL_TOLERANCE = 8.0 * UNIT_ROUNDING
#: Most halvings: a kink needs some 25, a layer at the end of a range as many as it is narrow.
MOST_HALVINGS = 64


def integrate(
    integrand: Callable[[Any, Any], tuple[Any, Any]], owner: Any, width: Any, layer: Any, count: int
) -> tuple[Any, Any]:
    """Return the sums of integrals from 0 over pieces of many designs, and bounds of their errors.

    Parameters
    ----------
    integrand : callable
        Takes piece numbers, shape (n, 1), and positions in these, shape (n, nodes); returns the values and bounds of
        their rounding errors.
    owner : ndarray of int, shape (pieces,)
        The design that each piece belongs to.
    width : ndarray, shape (pieces,)
        The length of each piece.
    layer : ndarray, shape (pieces,)
        How near to 0 the function may change all at once; the panel there is halved at least so far.
    count : int
        Number of designs.

    Returns
    -------
    value, error : ndarray, shape (count,)
        NaN for a design whose integrand is not finite somewhere.

    Notes
    -----
    Gauss's rule of 16 nodes on a panel against the sum of its halves: they differ by the error of the former, many
    times that of the latter, which is kept. A kink between the last node and the end of a panel is seen by neither: at
    a distance d it moves the value at the end by the change s of the slope times d, the integral by s d^2/2; s is about
    the size of the values per panel. The error is the sum of these differences, of the tolerance of each panel (two
    rules may agree by chance), and of the integrated bounds of roundings.
    """
    piece = np.arange(owner.size)
    low, high = np.zeros(owner.size), width
    whole = _rule(integrand, piece, low, high)
    scale = np.bincount(owner, whole[2], count)
    value, error = np.zeros(count), np.zeros(count)
    whole_value = whole[0]
    for halving in range(MOST_HALVINGS):
        middle = 0.5 * (low + high)
        both = np.concatenate([piece, piece])
        ends = np.concatenate([low, middle]), np.concatenate([middle, high])
        halves, noise, _, kinks = _rule(integrand, both, *ends)
        total, rounding, unseen = (part.reshape(2, -1).sum(axis=0) for part in (halves, noise, kinks))
        change, of = np.abs(whole_value - total) + unseen, owner[piece]
        # A panel next to 0 that is wider than the layer there may not have seen it.
        seen = (low > 0.0) | (high <= layer[piece])
        done = (change <= np.maximum(PANEL_TOLERANCE * scale[of], rounding)) & seen
        done |= ~np.isfinite(change) | (halving == MOST_HALVINGS - 1)
        value += np.bincount(of[done], total[done], count)
        error += np.bincount(of[done], (change + rounding)[done] + PANEL_TOLERANCE * scale[of[done]], count)
        if done.all():
            break
        left = np.tile(~done, 2)
        piece, low, high, whole_value = both[left], ends[0][left], ends[1][left], halves[left]
    return value, np.where(np.isnan(value), np.nan, error)


def _rule(integrand: Any, piece: Any, low: Any, high: Any) -> tuple[Any, Any, Any, Any]:
    """Return Gauss's rule of the integrand, of its roundings and magnitudes on each panel, and what a kink may hide."""
    size = high - low
    values, noise = integrand(piece[:, None], low[:, None] + size[:, None] * NODES)
    inner, magnitude = values[:, 1:-1], np.abs(values[:, 1:-1]) @ WEIGHTS
    apart = np.abs(inner @ TO_ENDS - values[:, [0, -1]]).max(axis=1)
    kink = np.where(apart > 0.0, apart * (apart / magnitude), 0.0)
    return size * (inner @ WEIGHTS), size * (noise[:, 1:-1] @ WEIGHTS), size * magnitude, size * kink

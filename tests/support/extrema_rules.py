"""What the extrema of one branch must look like: they alternate along each range, with the infinities at its ends."""

from __future__ import annotations

import numpy as np

import fastlink as fl
from tests.support.extrema_families import space
from tests.support.extrema_oracle import extrema

TURN = 2 * np.pi


def ends(lengths: np.ndarray, quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the angles (n, 2, 4) where ranges end, -high, -low, low, high (NaN: none), and the infinity's sign there.

    At the inner toggle |AD| = |b - c|, at the outer |AD| = b + c. Near them omega4/omega1 is
    s sin(theta1) (1 + k/G)/(2 sigma) with 1 + k/G = 2b/(b - c) or 2b/(b + c), and omega2/omega1 the like with
    -(1 - k/G) = 2c/(b - c) or -2c/(b + c), where sigma goes to zero (docs/numerics.md, Rates). Where a range ends, an
    acceleration has the sign of the rate, where it starts the other one.
    """
    result = fl.sweep("planar_4r", space(lengths), ["theta1_low", "theta1_high"], theta1=[0.0])
    low = np.where(result.theta1_low > 0, result.theta1_low, np.nan)
    high = np.where(result.theta1_high < np.pi, result.theta1_high, np.nan)
    inner = np.sign(lengths[1] - lengths[2])
    outer = np.full_like(inner, 1.0 if quantity.endswith("4") else -1.0)
    rate = np.stack([-outer, -inner, inner, outer], axis=-1)
    if quantity.startswith("alpha"):
        rate = rate * [-1, 1, -1, 1]
    angles = np.stack([-high, -low, low, high], axis=-1)
    return np.stack([angles, angles], axis=1), np.stack([-rate, rate], axis=1)


def in_order(lengths: np.ndarray, quantity: str, theta1: np.ndarray, marks: np.ndarray) -> list[np.ndarray]:
    """Return what stands at the ends of the ranges (the infinity's sign) and at the extrema (marks), along the turn.

    Also the mark that follows (after the last the first), and where a range ends. A mark of 0 is none.
    """
    angles, grows = ends(lengths, quantity)
    signed = np.where(theta1 > np.pi, theta1 - TURN, theta1)
    # Rounding must not put an extremum beyond its toggle.
    size = np.fmin(np.fmax(np.abs(signed), angles[:, :, 2:3]), angles[:, :, 3:4])
    inside = np.where(marks != 0, np.copysign(size, signed), np.nan)
    places = np.concatenate([angles, inside], axis=2)
    marks = np.where(np.isnan(places), 0, np.concatenate([grows, marks], axis=2))
    # Among equal angles the start of a range comes first, its end last.
    rank = np.broadcast_to(np.array([0, 2, 0, 2] + [1] * inside.shape[2]), places.shape)
    order = np.lexsort((rank, places), axis=2)
    marks, rank = (np.take_along_axis(values, order, axis=2) for values in (marks, rank))
    last = np.arange(marks.shape[2]) == np.sum(marks != 0, axis=2, keepdims=True) - 1
    return [marks, np.where(last, marks[:, :, :1], np.roll(marks, -1, axis=2)), rank == 2]


def broken(lengths: np.ndarray, quantity: str, theta1: np.ndarray, kind: np.ndarray) -> np.ndarray:
    """Return which designs (n, 2) break the rule: along a range maxima and minima alternate, infinite ends included.

    With it the parity: from +inf to +inf an odd number, once round the turn an even one and at least two.
    """
    kinds, following, ended = in_order(lengths, quantity, theta1, kind)
    full_turn_without_any = ~np.any(kinds, axis=2)
    return np.any((kinds != 0) & (kinds == following) & ~ended, axis=2) | full_turn_without_any


def zeros(lengths: np.ndarray, quantity: str, theta1: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Return how often a quantity is zero along the turn (n, 2), from the signs of its extrema and at its ends."""
    signs, following, ended = in_order(lengths, quantity, theta1, np.nan_to_num(np.sign(value)))
    return np.sum((signs * following < 0) & ~ended, axis=2)


def padded(lengths: np.ndarray, quantity: str) -> list[np.ndarray]:
    """Return what the oracle finds in the form of the engine: value, theta1, count and kind."""
    n = lengths.shape[1]
    (value, theta1), kind = np.full((2, n, 2, 6), np.nan), np.zeros((n, 2, 6), dtype=np.int8)
    for i in range(n):
        points = extrema(lengths[:, i], quantity)
        for branch in (1, 2):
            mine = [point for point in points if point.branch == branch]
            value[i, branch - 1, : len(mine)] = [point.value for point in mine]
            theta1[i, branch - 1, : len(mine)] = [point.theta1 for point in mine]
            kind[i, branch - 1, : len(mine)] = [point.kind for point in mine]
    return [value, theta1, np.sum(kind != 0, axis=2), kind]

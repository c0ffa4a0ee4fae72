"""Millions of configurations near where digits may get lost, at input positions from a pool that can be tabled.

The lengths are made for the positions: so that a toggle, a limit or an escape is as near as one likes.
"""

from __future__ import annotations

import numpy as np

from tests.support.configurations import LENGTHS, masses_and_points

POOL = 4000


def sizes(rng, n, least=1e-12, greatest=1e-1):
    """Numbers of all sizes, of either sign."""
    return rng.choice([-1.0, 1.0], n) * np.exp(rng.uniform(np.log(least), np.log(greatest), n))


def planar(kind, rng, n):
    """Return inputs and angles of `n` planar 4R."""
    a, b, c, d = rng.uniform(0.3, 2.0, (4, n))
    theta = rng.choice(rng.uniform(-np.pi, np.pi, POOL), n)
    if kind == "unequal":
        a, b, c, d = np.exp(rng.uniform(-5.0, 5.0, (4, n)))
    elif kind == "toggle":  # B near the line AD: c near |AD| - b, b - |AD| or |AD| + b
        diagonal = np.sqrt((d - a) ** 2 + 4.0 * a * d * np.sin(theta / 2) ** 2)
        c = np.abs(diagonal * (1.0 + sizes(rng, n)) + rng.choice([-1.0, 1.0], n) * b)
    elif kind == "change point":
        theta = rng.choice(sizes(rng, POOL, 1e-8), n) + np.pi * rng.integers(0, 2, n)
        theta = rng.choice(theta[:POOL], n)
        a = np.abs(np.where(rng.random(n) < 0.5, c + d - b, b + d - c) + sizes(rng, n))
    elif kind == "kite":
        theta = rng.choice(sizes(rng, POOL, 1e-8), n)
        first = rng.random(n) < 0.5
        a, b = np.where(first, d, c) * (1.0 + sizes(rng, n)), np.where(first, c, d) * (1.0 + sizes(rng, n))
    return dict(zip(LENGTHS, (a, b, c, d), strict=True)) | masses_and_points(rng, n), theta


def minkowski(kind, rng, n):
    """Return inputs and rapidities of `n` Minkowskian 4R."""
    a, b, g, h = rng.uniform(0.3, 2.0, (4, n))
    theta = rng.choice(rng.uniform(-4.0, 4.0, POOL), n)
    if kind == "unequal":
        a, b, g, h = np.exp(rng.uniform(-20.0, 20.0, (4, n)))
    elif kind == "great":
        theta = rng.choice(sizes(rng, POOL, 4.0, 700.0), n)
    elif kind == "limit":  # |AC| near b + h or |b - h|
        square = (g - a) ** 2 - 4.0 * a * g * np.sinh(theta / 2) ** 2
        diagonal = np.sqrt(np.abs(square)) * (1.0 + sizes(rng, n))
        h = np.abs(diagonal + rng.choice([-1.0, 1.0], n) * b)
    elif kind == "escape":  # A and C nearly lightlike separated
        g = a * np.exp(np.abs(theta)) * (1.0 + sizes(rng, n))
    elif kind == "fold":
        theta = rng.choice(sizes(rng, POOL, 1e-8, 1.0), n)
        h = np.abs(rng.choice([-1.0, 1.0], n) * (g - a) + rng.choice([-1.0, 1.0], n) * b + sizes(rng, n))
    elif kind == "light":
        h = h * np.abs(sizes(rng, n))
    return dict(zip("abgh", (a, b, g, h), strict=True)) | {
        name: rng.uniform(-2.0, 2.0, n) for name in "xy"
    }, theta


FAMILIES = {
    "planar_4r": (planar, ("random", "unequal", "toggle", "change point", "kite")),
    "minkowski_4r": (minkowski, ("random", "unequal", "great", "limit", "escape", "fold", "light")),
}

"""Where the loop of the Minkowskian 4R closes, found by scanning it: no limit, no T_i, no formula of the paper.

In null coordinates (x + y, x - y) the vector of length r and rapidity t is (r p, r/p), p = e^t, and negative p is
a past-pointing vector. The loop then is a quadratic in the unknown p or q.
"""

from __future__ import annotations

import numpy as np

from fastlink.numerics.compensated import UNIT_ROUNDING

STEP = 0.06
#: Half a step off 0: there branches may meet.
GRID = (np.arange(110) + 0.5) * STEP
HALVINGS = 50
#: So many designs are scanned at once, and so many changes refined: what fits into the cache of the processor.
CHUNK, CELLS = 250, 2000


def quadratic_of_output(lengths, theta):
    """Coefficients of q^2, q, 1 for the output crank: |AC + CB|^2 = h^2."""
    a, b, g, h = lengths
    p = np.exp(theta)
    alpha, beta = g - a * p, g - a / p
    return b * beta, alpha * beta + b * b - h * h, b * alpha


def quadratic_of_input(lengths, psi):
    """Coefficients of p^2, p, 1 for the input crank: |AO + OB|^2 = h^2."""
    a, b, g, h = lengths
    q = np.exp(psi)
    u, v = g + b * q, g + b / q
    return -a * v, u * v + a * a - h * h, -a * u


def closes(coefficients):
    x, y, z = coefficients
    return y * y - 4.0 * x * z >= 0.0


def closes_ahead(coefficients):
    """Whether a root is positive: the vector points to the future."""
    x, y, z = coefficients
    return closes(coefficients) & ((x * z < 0.0) | (x * y < 0.0))


def scan(lengths, quadratic, test):
    """Follow a test along the positive half of the crank's rapidity.

    Returns
    -------
    starts : array of bool (n,)
        The test next to 0.
    changes : array (n, 3)
        Where it changes, refined by bisection; NaN beyond the last change.
    """
    n = lengths.shape[1]
    starts = np.empty(n, dtype=bool)
    changes = np.full((n, 3), np.nan)
    for begin in range(0, n, CHUNK):
        held = test(quadratic(lengths[:, begin : begin + CHUNK, None], GRID))
        starts[begin : begin + CHUNK] = held[:, 0]
        design, cell = np.nonzero(held[:, 1:] != held[:, :-1])
        # cells come in order: the place of a change among those of its design
        place = np.arange(design.size) - np.searchsorted(design, design)
        changes[begin + design, place] = cell
    design, place = np.nonzero(~np.isnan(changes))
    for begin in range(0, design.size, CELLS):
        here = design[begin : begin + CELLS], place[begin : begin + CELLS]
        some, cell = lengths[:, here[0]], changes[here].astype(int)
        low, high, before = GRID[cell], GRID[cell + 1], starts[here[0]] ^ (here[1] % 2 == 1)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            same = test(quadratic(some, middle)) == before
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        changes[here] = 0.5 * (low + high)
    return starts, changes


def ranges(starts, changes):
    """Number of intervals of the whole rapidity: each but the one about 0 has its mirror."""
    count = np.sum(~np.isnan(changes), axis=1)
    runs = np.where(starts, 1 + count // 2, (count + 1) // 2)
    return np.where(starts, 2 * runs - 1, 2 * runs)


def rounding(lengths, quadratic, rapidity):
    """What rounding of the discriminant does to the hyperbolic cosine of the place where it vanishes.

    Its terms are below S^2, each wrong by at most 16 roundings of that; its slope by the cosine is 8 a b g h.
    """
    x, y, z = quadratic(abs(lengths), -abs(rapidity))
    a, b, g, h = lengths
    size = abs(x) + abs(y) + abs(z) + b * b + h * h
    longest = (a + b + g + h) ** 2 * np.exp(2.0 * abs(rapidity))
    return 16.0 * UNIT_ROUNDING * (size + longest) ** 2 / (8.0 * a * b * g * h) + 2.0**-HALVINGS

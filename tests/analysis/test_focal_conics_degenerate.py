"""Inscribed conics of four-bars next to parallelograms, kites and rhombi, and next to parabolas, against 60 digits."""

import mpmath as mp
import numpy as np
import pytest

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

#: Which lengths are equal but for a gap, of a, b, c, d: the length of each by its number.
EQUAL = {
    "parallelogram": (0, 0, 2, 2),
    "kite of M": (0, 2, 2, 0),
    "kite of A": (0, 2, 0, 2),
    "rhombus": (0, 0, 0, 0),
}
EQUAL |= {"random": (0, 1, 2, 3)}


def drawn(kind, rng, n):
    """Return lengths with gaps from 1e-16 to 0.01, angles and numbers of conics up to 1e12 of either sign."""
    lengths = rng.uniform(0.3, 2.0, (4, n))[list(EQUAL[kind])]
    gaps = 10.0 ** rng.uniform(-16.0, -2.0, (4, n)) * rng.choice([-1.0, 0.0, 1.0], (4, n))
    t = rng.uniform(-1.5, 2.5, n) * 10.0 ** rng.choice([0.0, 0.0, 4.0, 8.0, 12.0], n)
    return [*(lengths * (1.0 + gaps)), rng.uniform(-3.0, 3.0, n), t]


def foci(branch, a, b, c, d, phi, t):
    """Return the foci and the squared semi-axis across them, with its sign; None where the four-bar does not close."""
    A = a * mp.expj(phi)
    along = (d - A) / abs(d - A)
    foot = (abs(d - A) ** 2 + c * c - b * b) / (2 * abs(d - A))
    if abs(foot) >= c:
        return None
    B = A + along * mp.mpc(foot, (1 if branch == 2 else -1) * mp.sqrt(c * c - foot * foot))
    half = ((1 - t) * B + t * (A + d)) / 2
    root = mp.sqrt(half * half - t * A * d)
    return [half + root, half - root], mp.im(half + root) * mp.im(half - root)


def matched(found, others):
    """Return others in the order in which they are nearest."""
    straight = sum(abs(x - y) for x, y in zip(found, others, strict=True))
    crossed = sum(abs(x - y) for x, y in zip(found, others[::-1], strict=True))
    return others if straight <= crossed else others[::-1]


@pytest.mark.parametrize("kind", EQUAL)
def test_the_foci_are_right_to_the_roundings_of_the_inputs(kind):
    rng, n = np.random.default_rng(6), 40
    inputs, branch, compared = drawn(kind, rng, n), rng.integers(1, 3, n), 0
    conic = fl.focal.inscribed_conics(*inputs[:5], branch=branch, t=inputs[5])
    with mp.workdps(60):
        step = mp.mpf(10) ** -25
        for i in range(n):
            at = [mp.mpf(float(values[i])) for values in inputs]
            exact = foci(branch[i], *at)
            assert (exact is not None) == np.isfinite(conic.x1[i])
            if exact is None:
                continue
            # the change of each focus with relative changes of all inputs: what their last digits determine
            moved = [
                foci(branch[i], *(x * (1 + step * (j == k)) for k, x in enumerate(at))) for j in range(6)
            ]
            moved = [matched(exact[0], one[0]) for one in moved]
            got = matched(exact[0], [mp.mpc(conic.x1[i], conic.y1[i]), mp.mpc(conic.x2[i], conic.y2[i])])
            units = [
                abs(exact[0][k]) + sum(abs(one[k] - exact[0][k]) for one in moved) / step for k in (0, 1)
            ]
            for k in (0, 1):
                # corners and the root have some three roundings each; the greatest of 1,200 is 1.2
                assert abs(got[k] - exact[0][k]) <= 4 * UNIT_ROUNDING * units[k], (kind, i)
            squared = mp.mpf(float(conic.minor[i])) ** 2 * (-1 if conic.kind[i] == 1 else 1)
            unit = sum(abs(mp.im(exact[0][k])) * units[1 - k] for k in (0, 1)) + abs(squared)
            assert abs(squared - exact[1]) <= 8 * UNIT_ROUNDING * unit, (kind, i)
            compared += 1
    assert compared > n // 3

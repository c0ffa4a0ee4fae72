"""The sextic of the Minkowskian planar 4R, against points traced in null coordinates and the paper's elimination."""

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.refusals import refused

import fastlink as fl
from fastlink.minkowski import sextic
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.papers import BLOCK

#: Causal types of a vector: the sign of its square.
SPACELIKE, LIGHTLIKE, TIMELIKE = 1, 0, -1
TYPES = (SPACELIKE, LIGHTLIKE, TIMELIKE)


def point_of(rng, h, AX, BX):
    """A coupler point with AX and BX of the given causal types: exact dyadic numbers, h too."""
    while True:
        x, y = rng.integers(-256, 257, 2) / 64.0
        if AX == LIGHTLIKE:
            y = rng.choice([-1.0, 1.0]) * x
        if BX == LIGHTLIKE:
            x = h / 2 if AX == LIGHTLIKE else x
            y = rng.choice([-1.0, 1.0]) * (h - x)
        if (np.sign(x * x - y * y), np.sign((x - h) ** 2 - y * y)) == (AX, BX):
            return x, y


def random_designs(seed, n, AX_types=TYPES, BX_types=TYPES):
    """Dyadic lengths of all classes, and n coupler points of each pair of causal types: (6, pairs n)."""
    rng = np.random.default_rng(seed)
    designs = []
    for AX in AX_types:
        for BX in BX_types:
            for lengths in rng.integers(8, 129, (n, 4)) / 32.0:
                designs.append((*lengths, *point_of(rng, lengths[3], AX, BX)))
    return np.array(designs).T


def traced(design, theta):
    """Yield the coupler points (X, Y) at an input: the loop's quadratic in q = e^psi, of either sign.

    In null coordinates X + Y, X - Y: A = (a p, a/p), C = (g, g), B = C + (b q, b/q), and h^2 is the product of
    those of AB.
    """
    a, b, g, h, x, y = (mp.mpf(float(value)) for value in design)
    p = mp.exp(mp.mpf(theta))
    alpha, beta = g - a * p, g - a / p
    middle = alpha * beta + b**2 - h**2
    discriminant = middle**2 - 4 * b**2 * alpha * beta
    if discriminant < 0:
        return
    for sign in (-1, 1):
        q = (-middle + sign * mp.sqrt(discriminant)) / (2 * b * beta)
        AB = (alpha + b * q, beta + b / q)
        U, V = a * p + (x + y) * AB[0] / h, a / p + (x - y) * AB[1] / h
        yield (U + V) / 2, (U - V) / 2


def value(c, X, Y):
    """The polynomial with the coefficients in doubles, but evaluated with all digits."""
    return mp.fsum(mp.mpf(float(c[i, j])) * X**i * Y**j for i in range(7) for j in range(7 - i))


def majorant(design, X, Y):
    """Every term of the sextic with its absolute value: what one relative rounding of each may do to it."""
    a, b, g, h, x, y = np.abs(design)
    z, p = np.abs(X) + np.abs(Y), x + y
    k = p * p + a * a
    middle = 2 * h * x + a * a + h * h + b * b + g * g
    W = (z * z + k) * (z + g) + p / h * (g * z * z + middle * z + k * g)
    V = g * z * (p * p / h + x) + y * (z * z + g * z)
    return W * W + 4 * V * V


def printed(design, X, Y):
    """The paper's elimination at a point with both corrections, AX and BX spacelike, over r^2 > 0 at once."""
    a, b, g, h, x, y = (mp.mpf(float(value)) for value in design)
    r, s = mp.sqrt(x * x - y * y), mp.sqrt((x - h) ** 2 - y * y)
    s_ch, s_sh = (x * (x - h) - y * y) / r, h * y / r
    A1 = 2 * X * s_ch - 2 * Y * s_sh - 2 * g * s_ch
    B1 = 2 * X * s_sh - 2 * Y * s_ch - 2 * g * s_sh
    C1 = X * X - 2 * X * g - Y * Y + g * g + s * s - b * b
    A2, B2, C2 = 2 * r * X, -2 * r * Y, X * X - Y * Y - a * a + r * r
    return (C1 * B2 - C2 * B1) ** 2 - (A2 * C1 - A1 * C2) ** 2 - (A1 * B2 - A2 * B1) ** 2


@pytest.mark.sample(3)
@pytest.mark.parametrize("AX", TYPES)
@pytest.mark.parametrize("BX", TYPES)
def test_the_sextic_vanishes_on_the_traced_curve(AX, BX):
    designs = random_designs(51 + 3 * AX + BX, 40, (AX,), (BX,))
    c = sextic(*designs)
    points = 0
    with mp.workdps(50):
        for i in range(40):
            for theta in (-3.0, -0.9, 0.1, 0.6, 1.7):
                for X, Y in traced(designs[:, i], theta):
                    # The points are exact; each coefficient is a sum of products of at most 24 operations, each of
                    # which may be off by a rounding of its terms (worst seen: below 0.3).
                    allowed = 24 * UNIT_ROUNDING * majorant(designs[:, i], X, Y)
                    assert abs(value(c[i], X, Y)) <= allowed, (i, theta)
                    points += 1
    assert points > 100


def test_at_any_point_it_is_the_paper_s_elimination_with_both_corrections():
    designs = random_designs(53, 60, (SPACELIKE,), (SPACELIKE,))
    c = sextic(*designs)
    places = np.random.default_rng(54).uniform(-4.0, 4.0, (2, designs.shape[1]))
    with mp.workdps(50):
        for i, (X, Y) in enumerate(places.T):
            h = float(designs[3, i])
            exact = -printed(designs[:, i], mp.mpf(X), mp.mpf(Y)) / (4 * h**2)
            # Coefficients alone are rounded, as above.
            assert abs(value(c[i], mp.mpf(X), mp.mpf(Y)) - exact) <= 24 * UNIT_ROUNDING * majorant(
                designs[:, i], X, Y
            )


def test_the_circles_of_eq_14_are_those_of_eqs_10_and_11():
    """Expanded by hand in `coupler_circles`; here as they stand, in null coordinates."""
    designs = random_designs(58, 20, (SPACELIKE,))
    tested = 0
    with mp.workdps(50):
        for design in designs.T:
            a, b, g, h, x, y = (mp.mpf(float(value)) for value in design)
            r = mp.sqrt(x * x - y * y)
            for X, Y in traced(design, 0.6):
                X, Y = mp.mpf(float(X)), mp.mpf(float(Y))
                found = fl.minkowski.coupler_circles(*design, X=float(X), Y=float(Y))
                size = (abs(X) + abs(Y) + a + b + g + h + abs(x) + abs(y)) ** 2 * (1 + (abs(x) + abs(y)) / r)
                # Of any unit vector e = AB/h, not only the traced one: A = X - p e and B = X - (p - h) e in turn, whose
                # circles are C2 - A2 ch - B2 sh and C1 - A1 ch - B1 sh, with lambda the rapidity of p e.
                for rapidity in (-0.7, 0.0, 1.3):
                    e = mp.exp(rapidity)
                    one = (X + Y - (x + y) * e) * (X - Y - (x - y) / e) - a * a
                    other = (X + Y - (x - h + y) * e - g) * (X - Y - (x - h - y) / e - g) - b * b
                    lam = rapidity + mp.atanh(y / x)
                    ch, sh = mp.sign(x) * mp.cosh(lam), mp.sign(x) * mp.sinh(lam)
                    for true, A, B, C in ((other, *found[:3]), (one, *found[3:])):
                        value = mp.mpf(float(C)) - mp.mpf(float(A)) * ch - mp.mpf(float(B)) * sh
                        assert abs(value - true) <= 8 * UNIT_ROUNDING * size * (mp.cosh(lam) + 1)
                tested += 1
    assert tested > 50
    assert np.isnan(fl.minkowski.coupler_circles(1.0, 2.0, 4.0, 1.5, 0.5, 0.5, X=1.0, Y=0.0).A1)
    with refused("X", "write -1e+24 to 1e+24"):
        fl.minkowski.coupler_circles(1.0, 2.0, 4.0, 1.5, 0.5, 0.0, X=1e26, Y=0.0)


def test_mirror_and_scale_change_no_bit_and_the_top_terms_are_those_at_infinity():
    designs = random_designs(59, 30)
    c = sextic(*designs)
    signs = np.where(np.arange(7) % 2, -1.0, 1.0)
    assert_array_equal(sextic(*designs[:5], -designs[5]), c * signs)
    powers = 6 - np.add.outer(np.arange(7), np.arange(7))
    for exponent in (-60, 60):
        assert_array_equal(sextic(*np.ldexp(designs, exponent)), np.ldexp(c, exponent * powers))
    c = sextic(*random_designs(60, 10))
    top = np.array([c[..., i, 6 - i] for i in range(7)])
    assert_array_equal(top.T, np.tile([-1.0, 0.0, 3.0, 0.0, -3.0, 0.0, 1.0], (c.shape[0], 1)))
    beyond = np.add.outer(np.arange(7), np.arange(7)) > 6
    assert not c[:, beyond].any()


def test_designs_broadcast():
    many = sextic([1.0, 2.0], 1.0, 4.0, np.ones((3, 1)), 0.5, [[0.0], [0.5], [1.0]])
    assert many.shape == (3, 2, 7, 7)
    assert_array_equal(many[2, 1], sextic(2.0, 1.0, 4.0, 1.0, 0.5, 1.0))
    # More than one block.
    designs = np.tile(random_designs(65, 3), 40)
    many = sextic(*designs)
    assert many.shape[0] > 2 * BLOCK
    assert_array_equal(many, np.tile(sextic(*designs[:, :27]), (40, 1, 1)))
    assert sextic(np.ones(0), 1.0, 4.0, 1.0, 0.5, 0.0).shape == (0, 7, 7)

"""The coupler curve: sextic, cognates, straightness and inflections, each against another way to it."""

import mpmath as mp
import numpy as np
import pytest
from tests.support.configurations import LENGTHS
from tests.support.curve_designs import CURVE, design_of, evaluate, random_designs, traced

from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.planar import (
    cognates,
    curve_straightness,
    inflections,
    sextic,
    straightness,
)

# -- sextic ------------------------------------------------------------------------------------------


def majorant(inputs, X, Y):
    """Every term of the sextic with its absolute value: what one relative rounding each may do to it.

    Lengths, coordinates and their errors enter it homogeneously, of degree eight before the division by a2^2.
    """
    a1, a2, a3, a4, u, v = (np.abs(inputs[name]) for name in CURVE)
    z = np.abs(X) + np.abs(Y)
    p = u + v
    k = p * p + a1 * a1
    middle = 2 * a2 * u + a1 * a1 + a2 * a2 + a3 * a3 + a4 * a4
    W = (z * z + k) * (z + a4) + p / a2 * (a4 * z * z + middle * z + k * a4)
    V = a4 * z * (p * p / a2 + u) + v * (z * z + a4 * z)
    return W * W + 4 * V * V


def test_the_sextic_anywhere_is_the_product_over_both_assemblies_with_the_crank():
    """At any point, place A on its two circles, B beside it, and ask how far B is from its circle."""
    inputs, _ = random_designs(33, 60)
    c = sextic(**inputs)
    points = np.random.default_rng(34).uniform(-3.0, 3.0, (2, 60))
    with mp.workdps(50):
        for i in range(60):
            a1, a2, a3, a4, u, v = (mp.mpf(float(inputs[name][i])) for name in CURVE)
            X, Y = (mp.mpf(float(x)) for x in points[:, i])
            z, p, square = mp.mpc(X, Y), mp.mpc(u, v), X * X + Y * Y
            # A = z - p e with |A| = a1: e is a unit (or, off the reach, complex reciprocal) root of a quadratic.
            lead, middle = -p * mp.conj(z), square + abs(p) ** 2 - a1**2
            root = mp.sqrt(middle**2 - 4 * lead * mp.conj(lead))
            e1, e2 = (root - middle) / (2 * lead), (-root - middle) / (2 * lead)
            product = mp.mpf(1)
            for e in (e1, e2):
                # (B - a4)(conj B - a4), the conjugate written with 1/e.
                B, mirror = z - (p - a2) * e, mp.conj(z) - (mp.conj(p) - a2) / e
                product *= (B - a4) * (mirror - a4) - a3**2
            expected = (square * abs(p) ** 2 * product / a2**2).real
            found = mp.fsum(float(c[i, m, n]) * X**m * Y**n for m in range(7) for n in range(7))
            size = majorant({name: float(inputs[name][i]) for name in CURVE}, float(X), float(Y))
            # The coefficients alone are rounded here: sums of products of at most 24 operations each.
            assert abs(found - expected) <= 32 * UNIT_ROUNDING * size


def test_the_sextic_is_tricircular_and_sees_both_branches_of_a_design():
    c = sextic(design_of([0.4, 0.5], 1.2, 0.8, 1.0, 0.3, 0.2))
    top = np.array([[c[0, i, 6 - i] for i in range(7)], [c[1, i, 6 - i] for i in range(7)]])
    np.testing.assert_array_equal(top, [[1, 0, 3, 0, 3, 0, 1]] * 2)
    assert not any(c[:, i, j].any() for i in range(7) for j in range(7 - i, 7))
    np.testing.assert_array_equal(c[1], sextic(design_of(0.5, 1.2, 0.8, 1.0, 0.3, 0.2)))


# -- cognates ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("branch", [1, 2])
def test_cognates_trace_the_same_points(branch):
    inputs, theta = random_designs(35, 4000)
    names = ["P_x", "P_y", "theta2", "theta4"]
    got = evaluate(names, inputs, theta, branch)
    closes = np.isfinite(got["P_x"])
    assert closes.sum() > 1500
    lengths = np.array([inputs[name] for name in LENGTHS])
    reach = lengths.sum(axis=0) + np.hypot(inputs["P_u"], inputs["P_v"])
    sine = np.abs(np.sin(got["theta4"] - got["theta2"]))
    sine_cognate = np.abs(np.sin(got["theta4"] - theta))
    for cognate in cognates(inputs):
        angle, side = cognate.configuration(theta, got["theta2"], got["theta4"])
        np.testing.assert_array_equal(side[closes & (cognate.number == 1)], branch)
        own = cognate.design
        traced = evaluate(["P_x", "P_y"], own, angle, side)
        X, Y = cognate.to_ground(traced["P_x"], traced["P_y"])
        # Each closure amplifies the roundings of lengths and angles by 1/sine of its own transmission angle and
        # by the ratio of its sizes; where the product nears 1e-6 even the branch may be rounded away.
        shortest = np.minimum(lengths.min(axis=0), np.min([own[name] for name in LENGTHS], axis=0))
        spread = (1 + reach / shortest) / (sine * (sine_cognate if cognate.number > 1 else sine))
        good = closes & (spread < 1e6)
        assert good.sum() > 0.95 * closes.sum()
        allowed = 8 * UNIT_ROUNDING * reach * spread
        assert np.all(np.hypot(X - got["P_x"], Y - got["P_y"])[good] <= allowed[good]), cognate.number


# -- length, area, straightness ----------------------------------------------------------------------


def test_straightness():
    s = np.linspace(-1.0, 1.0, 101)
    bow = 0.01 * (1 - s**2)
    for angle in (0.0, 0.7, 2.0, -1.5):
        x, y = s * np.cos(angle) - bow * np.sin(angle), s * np.sin(angle) + bow * np.cos(angle)
        # Half of the bow's height: coordinates of size 1 and edges as directions, a few roundings of the length 2.
        assert straightness(x, y) == pytest.approx(0.005, abs=32 * UNIT_ROUNDING)
        assert straightness(s * np.cos(angle), s * np.sin(angle)) <= 32 * UNIT_ROUNDING
    assert straightness(np.r_[s, np.nan], np.r_[bow, 0.0]) == pytest.approx(0.005, abs=32 * UNIT_ROUNDING)
    assert np.isnan(straightness([np.nan], [0.0]))
    assert straightness([2.0, 3.0], [1.0, 1.0]) == straightness([2.0], [1.0]) == 0.0
    assert straightness(s * 2.0**600, bow * 2.0**600) == straightness(s, bow) * 2.0**600
    # Against strips of 7200 directions, which are off by half a step times the extent at most.
    x, y = np.random.default_rng(42).normal(size=(2, 20, 3, 50))
    angle = np.linspace(0.0, np.pi, 7200)[:, None]
    found = straightness(x, y)
    assert found.shape == (20, 3)
    for place in np.ndindex(found.shape):
        strips = 0.5 * np.ptp(np.cos(angle) * y[place] - np.sin(angle) * x[place], axis=1)
        assert strips.min() - 8 * np.pi / 14400 <= found[place] <= strips.min() + 32 * UNIT_ROUNDING


def test_straightness_of_curves():
    # Chebyshev's approximate straight line, 1 : 2.5 : 2.5 : 2, P at 2 a2: flat around theta1 = pi.
    theta = np.linspace(np.pi - 1.2, np.pi + 1.2, 201)
    lambda_linkage = {"a1": 1.0, "a2": 2.5, "a3": 2.5, "a4": 2.0, "P_u": 5.0, "P_v": 0.0}
    got = evaluate(["P_x", "P_y"], lambda_linkage, theta, 2)
    length = np.hypot(np.ptp(got["P_x"]), np.ptp(got["P_y"]))
    part = straightness(got["P_x"], got["P_y"])
    assert part < 0.01 * length
    ends = {"theta1": (np.pi - 1.2, np.pi + 1.2), "branch": 2}
    assert curve_straightness(**lambda_linkage, **ends, samples=201) == part
    assert curve_straightness(**lambda_linkage, branch=2) > 50 * part


# -- inflections -------------------------------------------------------------------------------------


def test_inflections_next_to_toggles_are_found():
    """Within a step of 2 pi/720 of a toggle, where 4 of 100 rockers have one; against polylines that are fine there."""
    inputs, _ = random_designs(5, 200)
    places, _X, _Y, count = inflections(inputs, branch=2)
    compared = 0
    for i in range(200):
        one = {name: float(values[i]) for name, values in inputs.items()}
        a, b, c, d = (one[name] for name in LENGTHS)
        inner, outer = ((a * a + d * d - (b + sign * c) ** 2) / (2 * a * d) for sign in (-1, 1))
        if inner <= -1 or outer >= 1 or (inner > 1 and outer < -1):
            continue
        ends = np.arccos([min(inner, 1.0), max(outer, -1.0)])
        # By the cosine the distance from a toggle is a square: 1e-3 of a sample's step there is 1e-9 rad.
        theta = ends.mean() - 0.5 * np.ptp(ends) * np.cos(np.pi * (np.arange(4000) + 0.5) / 4000)
        parts = [theta, -theta] if inner < 1 and outer > -1 else [np.r_[-theta[::-1], theta]]
        if outer < -1:
            parts = [np.r_[theta, 2 * np.pi - theta[::-1]]]
        turns = 0
        for part in parts:
            chord = np.diff(traced(one, 2, part))
            turn = np.sign((chord[:-1].conj() * chord[1:]).imag)
            turns += np.count_nonzero(turn[1:] != turn[:-1])
        compared += 1
        # The polyline has its first vertex at theta[1]: an inflection still nearer to the toggle is not in it.
        size = np.arccos(np.cos(places[i, : count[i]]))
        seen = (size > (theta[1] if inner < 1 else -1.0)) & (size < (theta[-2] if outer > -1 else 4.0))
        assert turns == np.count_nonzero(seen), one
    assert compared > 50


def test_inflections_of_circles_and_of_many_designs():
    assert inflections(design_of(0.4, 1.2, 0.8, 1.0, 0.0, 0.0))[3] == 0
    theta1, X, _Y, count = inflections(
        design_of([[0.4], [0.3]], 1.2, 0.8, 1.0, [0.0, 0.7, 0.8], 0.5), branch=2
    )
    assert count.shape == (2, 3)
    assert theta1.shape == X.shape == (2, 3, count.max())
    np.testing.assert_array_equal(np.isfinite(theta1).sum(axis=-1), count)

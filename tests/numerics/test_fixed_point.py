"""Tables in fixed point: the bits of 40-digit arithmetic, wherever they say that they are certain."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from fastlink.catalogue import tables
from fastlink.mechanisms import catalogue
from fastlink.numerics.fixed_point import GREATEST_ANGLE, HALF_PI, LEAST_ANGLE, PLACES, fixed

RNG = np.random.default_rng(2)
ANGLES = {
    "anywhere": RNG.uniform(-7.0, 7.0, 2000),
    "a turn": np.arange(360) * (2.0 * np.pi / 360),
    "many turns": RNG.uniform(-2.0 * GREATEST_ANGLE, 2.0 * GREATEST_ANGLE, 400),
    "all sizes": 10.0 ** RNG.uniform(-200.0, 1.0, 400) * RNG.choice([-1, 1], 400),
    "near quarters": np.add.outer(np.arange(-9, 9) * np.pi / 2, [0.0, 1e-16, 1e-12, -1e-9, 3e-5]).ravel(),
    "near sixty-fourths": np.add.outer((np.arange(-60, 60) + 0.5) / 64, [0.0, 1e-17, -1e-15]).ravel(),
    "special": np.array(
        [
            0.0,
            -0.0,
            1.0,
            -0.5,
            5e-324,
            1e-310,
            LEAST_ANGLE,
            2.0 * LEAST_ANGLE,
            GREATEST_ANGLE,
            -GREATEST_ANGLE,
            1e300,
        ]
    ),
}
FUNCTIONS = {
    f"{mechanism} {name}": table.function
    for mechanism, input in (
        ("planar_4r", None),
        ("planar_4r", "joint_angle_2"),
        ("slider_crank", None),
        ("minkowski_4r", None),
    )
    for name, table in catalogue(mechanism, input).tables.items()
}
OF_ANGLES = [name for name in FUNCTIONS if not name.startswith("minkowski_4r")]


def tabled(function, angles):
    tables._tabled.cache_clear()
    return tables._tabled(function, angles.tobytes())


@pytest.mark.parametrize("family", ANGLES)
@pytest.mark.parametrize("name", OF_ANGLES)
def test_tables_have_the_bits_of_mpmath(name, family):
    function, angles = FUNCTIONS[name], ANGLES[family]
    expected = tables._by_mpmath(function, angles)
    np.testing.assert_array_equal(tabled(function, angles), expected)
    for k in range(0, angles.size, 7):  # one by one they take another way
        np.testing.assert_array_equal(tabled(function, angles[k : k + 1]), expected[:, k : k + 1])


@pytest.mark.parametrize("name", [name for name in FUNCTIONS if name.startswith("minkowski_4r")])
def test_functions_without_fixed_point_are_left_to_mpmath(name):
    angles = np.linspace(-4.0, 4.0, 41)
    expected = tables._by_mpmath(FUNCTIONS[name], angles)
    np.testing.assert_array_equal(tabled(FUNCTIONS[name], angles), expected)


@pytest.mark.parametrize("name", OF_ANGLES)
def test_almost_every_rounding_is_certain(name):
    angles = ANGLES["anywhere"]
    x, doubt = fixed(angles)
    *_, sure = FUNCTIONS[name](x).doubles(doubt)
    # What remains after rounding has 130 - 107 places more than its double, most often: one of 2^22 is in doubt.
    assert sure.mean() > 0.999
    singles = [FUNCTIONS[name](x).doubles(d)[2] for x, d in map(fixed, angles[:200].tolist())]
    np.testing.assert_array_equal(singles, sure[:200])


def test_nothing_is_certain_beyond_the_range():
    for angle in (LEAST_ANGLE, -LEAST_ANGLE / 2, GREATEST_ANGLE, 1e300, np.inf, np.nan):
        x, doubt = fixed(float(angle))
        assert not x.doubles(doubt)[2]
    x, doubt = fixed(0.0)
    assert x.doubles(doubt) == (0.0, 0.0, True)


def test_pi_is_rounded_to_its_last_place():
    with mpmath.workprec(400):
        assert int(mpmath.nint(mpmath.pi * mpmath.mpf(2) ** (PLACES - 1))) == HALF_PI


def test_errors_stay_below_the_doubt():
    """The doubt is 2^12 in the last place: 2^-180, and 2^-190 would be said of the steps alone."""
    for angle in RNG.uniform(-GREATEST_ANGLE, GREATEST_ANGLE, 200).tolist():
        x, doubt = fixed(angle)
        with mpmath.workprec(400):
            for value, exact in zip(x.cos_sin, (mpmath.cos(angle), mpmath.sin(angle)), strict=True):
                assert abs(value - exact * mpmath.mpf(2) ** PLACES) < doubt / 4

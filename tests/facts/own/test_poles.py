"""Quantities that pass infinity: their greatest and least values are infinite, wherever what divides them vanishes."""

from math import tan

import numpy as np
import pytest
from tests.support.four_bar import sweep_4r

import fastlink as fl

planar = fl.extend("planar_4r")


@planar.quantity(units="1", description="Torque on the output link over that on the crank", symbol="m")
def torque_ratio(omega1, omega4):
    return omega1 / omega4


@planar.quantity(units="s2", description="Even pole", symbol="e")
def even(omega4):
    return 1.0 / (omega4 * omega4)


@planar.quantity(units="1", description="Poles of a tangent", symbol="t")
def slope_of_output(theta4):
    return tan(theta4)


@planar.quantity(units="m-1", description="Pole in line with the ground", symbol="g")
def over_height(A_y):
    return 1.0 / A_y


@planar.quantity(units="rad s-1", description="A quotient with a limit", symbol="l")
def with_limit(A_y, omega4):
    return A_y * omega4 / A_y


@planar.quantity(units="1", description="A quotient of a quotient", symbol="q")
def within(torque_ratio):
    return 1.0 + torque_ratio


@planar.quantity(units="rad s-1", description="Pole where the other has none", symbol="n")
def undone(omega1, torque_ratio):
    return omega1 / torque_ratio


#: What vanishes where each may be infinite, whether it is of one sign on both sides, and the built-in quantities.
POLES = {
    "torque_ratio": ("omega4", False),
    "even": ("omega4", True),
    "over_height": ("A_y", False),
    "within": ("omega4", False),
    "mechanical_advantage": ("omega4", False),
    "instant_centre_x": ("omega2", False),
    "instant_centre_y": ("omega2", False),
}


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", POLES)
def test_extremes_are_infinite_where_the_divisor_changes_its_sign(name):
    space = fl.sobol(200, a1=(0.2, 1.5), a2=(0.2, 1.5), a3=(0.2, 1.5)).with_constants(
        {"a4": 1.0, "omega1": 10.0}
    )
    wanted = [f"{name}_max", f"{name}_min", f"{name}_peak"]
    found = fl.sweep(planar, space, wanted, branch=(1, 2), verify=20)
    assert found.attrs["verify_mismatches"] == 0
    divisor, even_pole = POLES[name]
    angles = np.linspace(0.001, 2.0 * np.pi, 720, endpoint=False)
    dense = fl.sweep(planar, space, [divisor, name, "theta4"], branch=(1, 2), angles=angles)
    dense = dense.where(dense.theta4.notnull())  # where the linkage assembles
    sign = np.sign(dense[divisor])
    turns = ((sign * sign.roll(theta1=1)) < 0).any("theta1") & sign.notnull().all("theta1")
    assert turns.any()
    # a quotient of two that vanish at one place has a limit; of 200 designs none does but by chance
    high, low = (found[f"{name}_{end}"] for end in ("max", "min"))
    assert np.isposinf(high.where(turns, np.inf)).all()
    assert even_pole or np.isneginf(low.where(turns, -np.inf)).all()
    assert np.isposinf(found[f"{name}_peak"].where(turns, np.inf)).all()
    # and no sample is beyond what is finite, but for its rounding
    assert not ((dense[name].max("theta1") - high) > 1e-9 * abs(high)).any()
    assert not ((low - dense[name].min("theta1")) > 1e-9 * abs(low)).any()


def test_places_bounds_and_lists_beside_poles():
    design = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
    names = [
        "torque_ratio_max",
        "torque_ratio_max_error",
        "theta1_at_torque_ratio_max",
        "even_extrema",
        "even_min",
    ]
    names += ["with_limit_max", "undone_max", "omega4_max", "d_torque_ratio_max_d_a1", "slope_of_output_peak"]
    found = fl.sweep(planar, design, names, branch=(1, 2), verify=1)
    assert found.attrs["verify_mismatches"] == 0
    assert np.isposinf(found.torque_ratio_max_error).all()
    assert np.isnan(found.d_torque_ratio_max_d_a1).all()
    # the output link rests there: its rate is that of a place off by a few roundings, of some 50 rad/s per rad
    for branch in (1, 2):
        place = float(found.theta1_at_torque_ratio_max.sel(branch=branch))
        rest = fl.sweep("planar_4r", design, ["omega4"], branch=branch, angles=[place])
        assert abs(rest.omega4.item()) < 1e-11
    assert found.even_extrema_count.values.tolist() == [2, 2]
    assert (found.even_extrema.min("extremum") == found.even_min).all()
    # a divisor of what it stands beside leaves no pole
    for name in ("with_limit_max", "undone_max"):
        np.testing.assert_allclose(found[name], found.omega4_max, rtol=1e-14)
    assert np.isposinf(found.slope_of_output_peak).all()
    arc = fl.sweep(
        planar, design | {"arc_start": 0.5, "arc_end": 1.5}, names[:1], branch=(1, 2)
    ).torque_ratio_max
    dense = fl.sweep(planar, design, ["torque_ratio"], branch=(1, 2), angles=np.linspace(0.5, 1.5, 4001))
    np.testing.assert_allclose(arc, dense.torque_ratio.max("theta1"), rtol=1e-5)


def test_poles_of_the_slider_crank_and_where_the_centre_is():
    space = fl.sobol(200, r=(0.05, 0.3), l=(0.1, 0.5), e=(-0.2, 0.2)).with_constants({"omega": 10.0})
    names = [
        f"{name}_{end}" for name in ("mechanical_advantage", "instant_centre_x") for end in ("max", "min")
    ]
    found = fl.sweep("slider_crank", space, names, branch=(1, 2), verify=20)
    assert found.attrs["verify_mismatches"] == 0
    turning = found.where(found.status == 0)
    assert all(np.isinf(turning[name].where(turning.status == 0, np.inf)).all() for name in names[:2])
    # both points of the rod move across the lines to its centre: O, A and the centre are in line, B below or above it
    at = fl.sweep(
        "slider_crank",
        space,
        ["instant_centre_x", "instant_centre_y", "A_x", "A_y", "slider_position"],
        branch=1,
    )
    scale = abs(at.instant_centre_x) + abs(at.instant_centre_y)
    # the centre is off by some roundings of A times its distance, which its rate over that of the crank is
    off = abs(at.A_x * at.instant_centre_y - at.A_y * at.instant_centre_x) / scale
    assert float(off.max()) < 1e-13
    away = abs(at.instant_centre_x - at.slider_position) / scale
    assert float(away.max()) < 1e-11


def test_centres_of_the_planar_4r_are_where_the_links_meet():
    design = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
    names = ["instant_centre_x", "instant_centre_y", "relative_centre_x", "A_x", "A_y", "B_x", "B_y"]
    at = sweep_4r(design, [*names, "mechanical_advantage", "omega4"], positions=50)
    x, y = at.instant_centre_x, at.instant_centre_y
    scale = abs(x) + abs(y) + 1.0
    # lines through A and O, and through B and D, meet there: roundings times how far it is
    assert float(abs(at.A_x * y - at.A_y * x).max() / scale.max()) < 1e-14
    assert float((abs((at.B_x - 1.0) * y - at.B_y * (x - 1.0)) / scale**2).max()) < 1e-13
    crossing = at.A_x - at.A_y * (at.B_x - at.A_x) / (at.B_y - at.A_y)
    np.testing.assert_allclose(at.relative_centre_x, crossing, rtol=1e-11)
    # each is rounded on its own, and cancels next to where the output link rests
    np.testing.assert_allclose(at.mechanical_advantage * at.omega4, 25.0, rtol=1e-13)

"""Extremes over a part of the turn: exact within it, its ends among them, at every door alike."""

import numpy as np
import pytest
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r, sweep_both

import fastlink as fl

FOUR_BAR = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 10.0}
PARTIAL = {"a1": 1.0, "a2": 0.6, "a3": 0.7, "a4": 1.2, "omega1": 10.0}
DOUBLE_CRANK = {"a1": 2.0, "a2": 2.5, "a3": 2.2, "a4": 0.8, "omega1": 10.0}
CASES = {
    "crank-rocker": ("planar_4r", FOUR_BAR, ["omega4", "alpha4", "theta4", "transmission_angle", "theta2"]),
    "double crank": ("planar_4r", DOUBLE_CRANK, ["omega4", "theta4", "joint_angle_2"]),
    "part of the turn": ("planar_4r", PARTIAL, ["theta4", "A_y", "transmission_angle"]),
    "slider-crank": (
        "slider_crank",
        {"r": 0.1, "l": 0.3, "e": 0.02, "omega": 20.0},
        ["slider_velocity", "slider_acceleration", "theta2"],
    ),
    "hart": ("hart", {"m": 4.0, "n": 8.0, "d": 6.0, "kappa": 0.5}, ["B_x", "psi"]),
    "focal": ("focal", {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0, "completion": 1}, ["F_y", "A_x"]),
}
#: Start and length: across the end of the turn, tiny, nearly a turn, a turn.
ARCS = [(0.5, 1.0), (5.5, 1.5), (-0.1, 0.3), (2.0, 1e-3), (3.0, 6.2), (-1.0, 2.0 * np.pi)]
SAMPLES = 4001


@pytest.mark.sample(2)
@pytest.mark.parametrize("case", CASES)
def test_extremes_over_an_arc_are_those_of_its_dense_samples(case):
    mechanism, design, names = CASES[case]
    start, length = np.array(ARCS).T
    designs = fl.table({"arc_start": start, "arc_end": start + length}).with_constants(design)
    wanted = [f"{name}_{end}{more}" for name in names for end in ("min", "max") for more in ("", "_error")]
    found = sweep_both(mechanism, designs, wanted)
    for k, (first, span) in enumerate(ARCS):
        # the ends of a whole turn are one position
        angles = np.linspace(first, first + span, SAMPLES)[: None if span < 6.28 else -1]
        curves = sweep_both(mechanism, design, names, angles=angles)
        for name in names:
            # a crank pin has a place where the linkage cannot be assembled, too, which is no part of the motion
            curve = curves[name].where(curves[names[0]].notnull())
            step = abs(curve.diff(curve.dims[-1])).max(curve.dims[-1]).values
            for end, sign in (("max", 1.0), ("min", -1.0)):
                best = (sign * curve).max(curve.dims[-1]).values
                value, bound = (found[f"{name}_{end}{more}"][k].values for more in ("", "_error"))
                there = np.isfinite(best)  # the linkage may reach no position of an arc
                assert (np.isnan(value) == ~there).all()
                # a sample is off by some roundings; next to a toggle by the root of one
                beyond = best - sign * value > bound + 1e-12 * abs(best)
                assert not (beyond | (sign * value - best > 4.0 * step))[there].any(), (name, end, first)


def test_lists_means_and_places_are_of_the_arc():
    design = DOUBLE_CRANK | {"arc_start": 2.0, "arc_end": 5.0}
    names = ["omega4_extrema", "omega4_min", "theta1_at_omega4_min", "omega4_mean", "omega4", "alpha4_peak"]
    names += ["omega4_rms", "d_omega4_mean_d_a2"]
    maps = fl.sweep("planar_4r", design, names, positions=1000, branch=1, verify=1)
    assert maps.attrs["verify_mismatches"] == 0
    assert maps.theta1.size == 1000
    assert maps.theta1[[0, -1]].values.tolist() == [2.0, 5.0]
    # the trapezoidal rule: of a smooth curve off by h^2/12 of the change of its slope, below 1e-6 of it
    assert maps.omega4_mean == pytest.approx(float(maps.omega4.integrate("theta1")) / 3.0, rel=1e-13)
    angles = fl.sweep("planar_4r", DOUBLE_CRANK, ["theta4"], angles=[2.0, 5.0]).theta4.values
    turned = (angles[1] - angles[0]) % (2.0 * np.pi) / 3.0 * 10.0
    assert maps.omega4_mean == pytest.approx(turned, rel=1e-6)
    assert maps.theta1_at_omega4_min == maps.theta1_at_omega4_extrema[0]
    assert maps.omega4_extrema_count == 1
    assert maps.omega4_min.attrs["long_name"].endswith("least over the arc")
    peak = abs(fl.sweep("planar_4r", design, ["alpha4_max", "alpha4_min"], branch=1).to_array()).max()
    assert maps.alpha4_peak == peak


def test_an_axis_of_arcs_scales_nothing():
    """Once the axis was taken for one that only scales results."""
    starts = [1.2, 1.3, 1.5]
    axis = fl.sweep("planar_4r", fl.grid(**FOUR_BAR, arc_start=starts, arc_end=2.0), ["omega4_min"], branch=1)
    rows = [
        fl.sweep("planar_4r", FOUR_BAR | {"arc_start": start, "arc_end": 2.0}, ["omega4_min"], branch=1)
        for start in starts
    ]
    assert axis.omega4_min.values.tolist() == [row.omega4_min.item() for row in rows]


def test_derivatives_hold_the_ends_of_the_arc():
    names = ["omega4_max", "d_omega4_max_d_a1", "d_omega4_max_d_a2", "omega4_max_gradient_status"]
    arc = {"arc_start": 0.5, "arc_end": 1.5}
    maps = sweep_4r(FOUR_BAR | arc, names)
    assert (maps.omega4_max_gradient_status == 0).all()
    for by in ("a1", "a2"):
        # central differences over h: off by h^2 and by the rounding of the value over h, 1e-9 together
        h = 1e-5
        ends = [sweep_4r(FOUR_BAR | arc | {by: FOUR_BAR[by] + k * h}, ["omega4_max"]) for k in (-1, 1)]
        slope = (ends[1] - ends[0]).omega4_max / (2 * h)
        np.testing.assert_allclose(maps[f"d_omega4_max_d_{by}"], slope, rtol=1e-6)


def test_the_same_at_every_door(tmp_path):
    arc = {"arc_start_deg": 30.0, "arc_end_deg": 120.0}
    expected = fl.sweep("planar_4r", FOUR_BAR | arc, ["omega4_max"], branch=1).omega4_max.item()
    radians = {name.removesuffix("_deg"): np.radians(value) for name, value in arc.items()}
    in_radians = fl.sweep("planar_4r", FOUR_BAR | radians, ["omega4_max"], branch=1).omega4_max.item()
    # an arc of degrees is rounded once more
    assert in_radians == pytest.approx(expected, rel=1e-14)
    fixed = {name: value for name, value in (FOUR_BAR | radians).items() if name != "a1"}
    assert fl.function("planar_4r", ["a1"], ["omega4_max"], branch=1, **fixed)([0.4]).item() == in_radians
    space = fl.sobol(2000, a1=(0.2, 0.5), a2=(0.8, 1.4), a3=(0.6, 1.2)).with_constants(
        {"a4": 1.0, "omega1": 10.0} | radians
    )
    best = fl.search(
        "planar_4r", space, ["theta4_max", "theta4_min"], minimise="omega4_peak", branch=1, top=1
    )
    row = {name: float(best[name][0]) for name in ("a1", "a2", "a3")}
    again = fl.sweep("planar_4r", FOUR_BAR | radians | row, ["omega4_peak"], branch=1)
    assert float(best.omega4_peak[0]) == pytest.approx(float(again.omega4_peak), rel=1e-12)


@pytest.mark.parametrize(
    ("more", "names", "options", "what", "remedy"),
    [
        ({"arc_end": 0.2}, ["omega4_max"], {}, "arc_end", "beyond the start"),
        ({"arc_end": 9.0}, ["omega4_max"], {}, "arc_end", "by a turn at most"),
        (
            {"arc_end": 2.0},
            ["omega4_max"],
            {"theta1": [0.1, 0.2]},
            "theta1 is an array",
            "number of positions",
        ),
        ({"arc_end": 2.0}, ["omega4_fluctuation"], {}, "a whole turn", "leave out"),
        ({"arc_end": [2.0, 0.1]}, ["omega4_max"], {}, "arc_end[1] is 0.1 rad", "beyond the start"),
        ({"arc_end": [1.0, 2.0]}, ["omega4_mean"], {}, "differs", "extremes alone"),
        ({}, ["omega4_max"], {"over": (0.1, 0.2)}, "over", "arc_start and arc_end"),
    ],
)
def test_what_is_no_arc_is_refused(more, names, options, what, remedy):
    start = {"arc_start": 0.5} if more else {}
    with refused(what, remedy):
        sweep_4r(FOUR_BAR | start | more, names, **options)


def test_arcs_that_end_before_they_start_are_told_or_allowed():
    rows = {"arc_start": [0.0, 1.0, 2.0], "arc_end": [1.0, 2.0, 1.0]}
    table = fl.table(rows).with_constants(FOUR_BAR)
    grid = fl.grid(arc_start=[0.0, 2.0], arc_end=[1.5, 2.5], **FOUR_BAR)
    sample = fl.sobol(8, arc_start=(0.0, 2.0), arc_end=(1.0, 3.0), **FOUR_BAR)
    for space, what in (
        (table, "arc_end[2] is 1 rad (57.2958 degrees)"),
        (grid, "arc_start is 2 rad"),
        (sample, "arc_end[1]"),
    ):
        with refused(what, "write an end beyond the start"):
            fl.sweep("planar_4r", space, ["omega4_max"])
    allowed = fl.sweep("planar_4r", table, ["omega4_max"], allow_invalid=True).omega4_max.values
    assert np.isnan(allowed).tolist() == [False, False, True]
    with refused("arc_start is missing beside arc_end", "write it, or leave arc_end out"):
        fl.sweep("planar_4r", FOUR_BAR | {"arc_end_deg": 90.0}, ["omega4_max"])
    with refused("arc_end is missing beside arc_start", "write it"):
        fl.function("planar_4r", ["arc_start"], ["omega4_max"], **FOUR_BAR)
    both = fl.function("planar_4r", ["arc_start", "arc_end"], ["omega4_max"], **FOUR_BAR)
    with refused("arc_start: there is no derivative by an end of an arc", "leave it out"):
        both.gradient([1.0, 2.0])
    within = fl.sweep("planar_4r", FOUR_BAR | {"arc_start": 0.5, "arc_end": 1.5}, ["omega4_max"])
    for tolerances in ({"arc_start": 0.01}, {"arc_end_deg": 1.0, "a1": 1e-4}):
        with refused(next(iter(tolerances)), "leave it out"):
            fl.tolerance(within, **tolerances)
    assert np.isnan(both([[1.0, 2.0], [2.0, 1.0]])).ravel().tolist() == [False, True]


def test_travel_tells_how_far_a_link_moves_over_an_arc():
    names = ["theta4_travel", "d_theta4_travel_d_a1", "theta4", "theta4_max", "theta4_min"]
    maps = sweep_4r(FOUR_BAR | {"arc_start": 0.5, "arc_end": 1.5}, names, verify=1)
    assert maps.attrs["verify_mismatches"] == 0
    curve = maps.theta4
    assert (maps.theta4_travel == curve.max("theta1") - curve.min("theta1")).all()
    # the ends of the arc are positions, and the curve is monotonic: roundings of two angles
    exact = maps.theta4_max - maps.theta4_min
    np.testing.assert_allclose(exact, maps.theta4_travel, rtol=1e-14)
    h = 1e-6
    ends = [
        sweep_4r(FOUR_BAR | {"arc_start": 0.5, "arc_end": 1.5, "a1": 0.4 + k * h}, names[:1]) for k in (-1, 1)
    ]
    # central differences: the square of h and a rounding over h
    np.testing.assert_allclose(
        maps.d_theta4_travel_d_a1, (ends[1] - ends[0]).theta4_travel / (2 * h), rtol=1e-8
    )

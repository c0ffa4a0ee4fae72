"""Reductions over the cycle run over the positions at which the linkage can be assembled."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.configurations import draw
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r, sweep_both

import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue, inputs_of

LINKS = {"a1": 1.0, "a2": 0.6, "a3": 0.7, "a4": 1.2}  # no link turns fully
ALL = np.linspace(0.0, 2.0 * np.pi, 97)[:-1]


def swept(names, **options):
    return fl.sweep("planar_4r", fl.grid(**LINKS), names, branch=1, verify=0, **options)


REDUCED = {
    "mean": lambda values: values.mean(),
    "rms": lambda values: math.sqrt((values * values).mean()),
    "max": lambda values: values.max(),
    "min": lambda values: values.min(),
    "peak": lambda values: abs(values).max(),
}
EXTREMES = ("max", "min", "peak")
SLOPED = 2  # of every sixth quantity from there on the first one changes with the first input


@pytest.mark.sample(4)
@pytest.mark.parametrize(
    ("mechanism", "drive"),
    [(name, drive) for name in NAMES for drive in inputs_of(name) if drive not in ("F_y", "sigma")],
)
def test_reductions_run_over_positions_that_assemble(mechanism, drive):
    """Of what the driven link alone determines: with F and with the focal crank nothing is."""
    known, rng = catalogue(mechanism, drive), np.random.default_rng(3)
    design = draw(known.inputs, rng, 60)
    design |= {one: np.ones(60) for one, of in known.inputs.items() if of.choices}
    positions = ALL if known.position.units == "rad" else np.linspace(-1.5, 1.5, 60)
    columns = {name: values[:, None] for name, values in design.items()}
    numbers = [name for name in known.public if known.varies(name) and not known.public[name].flags]
    numbers = [name for name in numbers if name != "shaking_moment_at"]
    found = fl.evaluate(mechanism, numbers, input=drive, branch=1.0, **columns, **{drive: positions})
    there = {name: np.isfinite(np.broadcast_to(of, (60, positions.size))) for name, of in found.items()}
    always = [name for name in numbers if there[name].mean() > 0.95]  # a half-angle tangent is infinite at pi
    name = next(name for name in always if there[name].all() and np.ptp(found[name]) > 0.0)
    closes = np.any([there[other] for other in numbers if other not in always], axis=0)
    part = closes.any(axis=1) & ~closes.all(axis=1)
    assert part.sum() > 5
    asked = [*(f"{name}_{how}" for how in REDUCED), f"{drive}_at_{name}_max"]
    options = {"input": drive, "branch": 1, "verify": 0, drive: positions, "extrema": "sampled"}
    maps = sweep_both(mechanism, fl.table(design), asked, **options)
    for k in np.flatnonzero(part):
        values = np.broadcast_to(found[name], closes.shape)[k][closes[k]]
        for how, reduce in REDUCED.items():
            # sums of fewer than 100 terms, each right to 2 roundings
            off = abs(float(maps[f"{name}_{how}"][k]) - reduce(values))
            assert off < 100 * 2.0**-52 * abs(values).max()
        assert float(maps[asked[-1]][k]) in positions[closes[k]]


def test_a_mean_over_the_motion_is_an_integral():
    limit = math.acos((1.0 + 1.44 - 1.69) / 2.4)  # |AD| = a2 + a3
    maps = swept(["A_x_mean", "A_x_rms", "A_x_max", "A_x_min", "A_x_fluctuation"], theta1=20_000)
    # equal steps leave an error of the share of one step of the motion, times the range of cosines
    step = 2.0 * math.pi / 20_000 / (2.0 * limit)
    assert abs(float(maps.A_x_mean.item()) - math.sin(limit) / limit) < 2.0 * step
    square = 0.5 + math.sin(2.0 * limit) / (4.0 * limit)
    assert abs(float(maps.A_x_rms.item()) - math.sqrt(square)) < 2.0 * step
    assert float(maps.A_x_min.item()) <= float(maps.A_x_mean.item()) <= float(maps.A_x_max.item())
    assert np.isnan(maps.A_x_fluctuation.item())  # which needs a whole turn
    names = ["A_x_mean", "A_x_rms", "A_x_max", "status"]
    maps = sweep_4r(fl.grid(a1=1.0, a2=0.1, a3=0.2, a4=5.0), names, theta1=36)
    assert all(np.isnan(maps[name]).all() for name in names[:3])


def test_derivatives_and_verification_of_means_count_the_same_positions(tmp_path):
    names = ["A_x_mean", "d_A_x_mean_d_a1", "A_x_mean_gradient_status"]
    given = swept(names, theta1=ALL)
    # A_x is a1 cos(theta1): the derivative of the mean of samples is that mean over a1, of 1
    assert math.isclose(float(given.d_A_x_mean_d_a1.item()), float(given.A_x_mean.item()), rel_tol=1e-14)
    assert int(given.A_x_mean_gradient_status.item()) == 7  # of the sampled positions that assemble
    turn = swept(names, theta1=96)
    assert np.isnan(turn.d_A_x_mean_d_a1.item())  # the limits of the integral move
    assert int(turn.A_x_mean_gradient_status.item()) == 10
    names = ["A_x_mean", "A_y_rms", "G1_x_max", "v1_dot_min", "A_x_min"]
    space = fl.grid(a1=np.linspace(0.5, 1.5, 8), a2=0.6, a3=0.7, a4=1.2, G1_u=0.3, G1_v=0.1, omega1=2.0)
    maps = sweep_4r(space, names, theta1=60, extrema="sampled", to=tmp_path / "map.h5", verify=8)
    assert all(maps[name].attrs["verify_mismatches"] == 0 for name in names)
    assert all(maps[name].attrs["error_max_relative"] < 1e-14 for name in names)


@pytest.mark.sample(1)
@pytest.mark.parametrize("part", range(6))
@pytest.mark.parametrize("mechanism", [name for name in NAMES if catalogue(name).graded is not None])
def test_a_peak_is_the_greatest_magnitude(mechanism, part):
    """With its place, error bound and derivatives: those of the greatest value, or of the least."""
    known, rng = catalogue(mechanism), np.random.default_rng(3)
    numbers = [
        name
        for name in known.public
        if known.has_reductions(name) and not known.public[name].flags and not known.is_derivative(name)
    ]
    at, first = known.position.name, next(iter(known.inputs))
    names = numbers[part::6]
    design = draw(known.inputs, rng, 12)
    asked = [f"{form}_{how}" for name in names for form in (name, f"{at}_at_{name}") for how in EXTREMES]
    design |= {one: np.ones(12) for one, of in known.inputs.items() if of.choices}
    for extrema in ("refined", "sampled"):
        has_slope = extrema == "refined" and part == SLOPED
        asked += [f"d_{names[0]}_{how}_d_{first}" for how in EXTREMES if has_slope]
        maps = sweep_both(mechanism, fl.table(design), asked, extrema=extrema)
        for name in names:
            high, low, peak = (maps[f"{name}_{how}"].values for how in EXTREMES)
            assert_array_equal(peak, np.maximum(high, -low), err_msg=name)
            high_at, low_at, place = (maps[f"{at}_at_{name}_{how}"].values for how in EXTREMES)
            apart = ~(high == -low)  # where both are as great, either place is one of the peak
            assert_array_equal(place[apart], np.where(high > -low, high_at, low_at)[apart], name)
        if has_slope:
            high, low, _ = (maps[f"{names[0]}_{how}"].values for how in EXTREMES)
            slopes = [maps[f"d_{names[0]}_{how}_d_{first}"].values for how in EXTREMES]
            assert_array_equal(slopes[2], np.where(high > -low, slopes[0], -slopes[1]))


def test_a_peak_has_an_error_bound_and_is_verified():
    names = ["alpha4_peak", "alpha4_peak_error", "alpha4_max_error", "alpha4_min_error", "theta4_peak"]
    space = fl.grid(a1=0.3, a2=np.linspace(0.6, 1.2, 7), a3=0.8, a4=1.0, omega1=2.0)
    maps = sweep_4r(space, names, verify=7)
    assert maps.alpha4_peak.attrs["long_name"].endswith("greatest magnitude over the cycle")
    assert maps.attrs["verify_mismatches"] == 0
    assert maps.alpha4_peak.attrs["independent_max_difference"] < 1e-30  # of 50 digits
    both = np.maximum(maps.alpha4_max_error, maps.alpha4_min_error)
    assert ((maps.alpha4_peak_error > 0.0) & (maps.alpha4_peak_error <= both)).all()


# == Extremes over a part of the turn: exact within it, its ends among them, at every door alike =============

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


@pytest.mark.sample(1)
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
        assert_allclose(maps[f"d_omega4_max_d_{by}"], slope, rtol=1e-6)


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
    assert_allclose(exact, maps.theta4_travel, rtol=1e-14)
    h = 1e-6
    ends = [
        sweep_4r(FOUR_BAR | {"arc_start": 0.5, "arc_end": 1.5, "a1": 0.4 + k * h}, names[:1]) for k in (-1, 1)
    ]
    # central differences: the square of h and a rounding over h
    assert_allclose(maps.d_theta4_travel_d_a1, (ends[1] - ends[0]).theta4_travel / (2 * h), rtol=1e-8)

"""Greatest, least and listed extremes of every mechanism: within their bounds and none missed, as 50 digits tell."""

from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.configurations import LENGTHS, numbers
from tests.support.extremes import (
    QUIET,
    SEARCHED,
    assert_none_beyond,
    bounded_extremes,
    designs_of,
    search_of,
    searched,
    swept_4r,
)
from tests.support.neighbourhoods import folded_planar_4r
from tests.support.refusals import refused
from tests.support.sweeps import BARS, CRANK, sweep_4r, sweep_both

import fastlink as fl
from fastlink.codegen.kernel import kernel_of
from fastlink.codegen.runtime.cells import of_better
from fastlink.engine.resolve import _plan
from fastlink.facts.names import derivative_name
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.plan.programs import KnownProgram, make_plan
from fastlink.precision.errors import MeasuredErrors
from fastlink.precision.reference import CONTEXT

PLANAR = SEARCHED[0]
#: Some of each kind: accelerations, forces, a coordinate, an angle with kinks.
SOME = {
    "theta1": ("alpha4", "F41"),
    "theta": ("slider_acceleration",),
    "sigma": ("transmission_angle_F",),
    "phi": ("F_y",),
}
LOOSENESS = 250.0


def held(entry, designs, names):
    """Assert that all bounds hold; return bounds over errors."""
    extremes = list(bounded_extremes(entry, designs, names))
    assert [one for one in extremes if not one.holds] == []
    finite = [one for one in extremes if np.isfinite(one.value) and np.isfinite(one.bound)]
    return [one.bound / max(one.error, UNIT_ROUNDING * abs(one.value)) for one in finite if one.value != 0.0]


def by_name(*lengths, **others):
    """Return designs of the planar 4R as columns."""
    columns = dict(zip(LENGTHS, np.array(lengths, dtype=float).T, strict=True))
    return columns | {name: np.full(len(lengths), value) for name, value in others.items()}


CASES = [(PLANAR, kind) for kind in PLANAR.families] + [(entry, "random") for entry in SEARCHED[1:]]


@pytest.mark.sample(4)
@pytest.mark.parametrize(("entry", "kind"), CASES, ids=str)
def test_extremes_are_within_their_bounds(entry, kind):
    names = [name for name in SOME.get(entry.input, ("joint_omega_2",)) if name in entry.names]
    ratios = held(entry, designs_of(entry, kind, 1, 2), names or ["joint_omega_3"])
    assert ratios
    assert entry is not PLANAR or np.median(ratios) < LOOSENESS


@pytest.mark.stress
@pytest.mark.parametrize("entry", SEARCHED, ids=str)
def test_extremes_of_all_quantities_are_within_their_bounds(entry):
    for seed, kind in enumerate([*entry.families, *entry.families]):
        designs = designs_of(entry, kind, seed, 5)
        names = np.random.default_rng(seed).permutation(searched(entry, designs))[:6]
        ratios = held(entry, designs, [str(name) for name in names])
        assert entry.mechanism != "planar_4r" or not ratios or np.median(ratios) < LOOSENESS


#: Toggles on both sides, where rates are infinite; change points with and without a full turn; a parallelogram, whose
#: rates are constant in one branch.
SINGULAR = ((1.0, 0.6, 0.7, 1.2), (2.0, 3.0, 2.5, 2.5), (4.0, 9.0, 12.0, 7.0), (1.0, 2.0, 1.0, 2.0))


def test_extremes_at_toggles_and_change_points_are_within_their_bounds_or_infinite():
    held(PLANAR, by_name(*SINGULAR, omega1=3.0), ("omega4", "theta4"))
    names = ["omega4_max", "omega4_max_error", "omega4_extrema", "omega4_extrema_error"]
    never = swept_4r(names, (5.0, 1.0, 1.0, 1.0))
    assert all(np.isnan(never[name]).all() for name in names)
    toggles = swept_4r(names, SINGULAR[0])
    assert (np.isinf(toggles["omega4_max"]) == np.isinf(toggles["omega4_max_error"])).all()
    listed = np.isfinite(toggles["omega4_extrema"])
    assert (listed == np.isfinite(toggles["omega4_extrema_error"])).all()


@pytest.mark.parametrize("n", [12, pytest.param(300, marks=pytest.mark.stress)])
def test_extremes_of_links_that_fold_are_within_their_bounds_or_have_none(n):
    """A gap of the lengths that counts as zero is in the bound: it holds for the lengths as they are."""
    designs = {name: values for name, values in folded_planar_4r(np.random.default_rng(3), n).items()}
    designs = {name: designs[name] for name in LENGTHS} | {"omega1": np.ones(n)}
    extremes = list(bounded_extremes(PLANAR, designs, ("omega4", "transmission_angle")))
    assert [one for one in extremes if one.bound != np.inf and not one.holds] == []
    assert sum(one.bound < np.inf for one in extremes) > n


def test_forces_are_infinite_where_a_change_point_folds_under_a_load():
    """All bars lie in line there, and no finite force along them holds a weight across; along them some do."""
    lengths = (2.0, 3.0, 2.5, 2.5)
    names = ["F21_max", "F21_max_error", "F21_min", "F21_min_error"]
    space = fl.grid(**dict(zip(LENGTHS, lengths, strict=True)), omega1=1.0, gravity_y=[-9.81])
    loaded = sweep_4r(space, names, links=BARS)
    assert np.isinf(loaded["F21_max"]).all()
    assert np.isinf(loaded["F21_max_error"]).all()
    assert (loaded["F21_min_error"] < 1e-9 * loaded["F21_min"]).all()
    assert np.isfinite(swept_4r(["F21_max"], lengths, links=BARS)["F21_max"]).all()


FIRST = {"theta1", "theta", "joint_angle_2"}  # the others share their facts with one of these


@pytest.mark.parametrize(
    "entry",
    [pytest.param(e, id=str(e), marks=[] if e.input in FIRST else pytest.mark.stress) for e in SEARCHED],
)
def test_extremes_of_derivatives_are_those_at_one_input_position(entry):
    """In the range that is searched a place moves with the lengths, and must not take the derivative along."""
    designs, known = designs_of(entry, "random", 5, 6), entry.catalogue
    preferred = ("B_x", "slider_position", "joint_angle_3", "joint_angle_4", "F_y", "N_y")
    name = next(one for one in preferred if one in entry.names)
    names = [derivative_name(name, by) for by in designs if by in known.variables]
    name = next(one for one in names if search_of(entry, one, designs))
    ends = [f"{name}_max", f"{name}_min"]
    found, sampled = (
        sweep_both(entry.mechanism, fl.table(designs), ends, input=entry.input, **QUIET, **at)
        for at in ({}, {"angles": 500, "extrema": "sampled"})
    )
    for end, sign in zip(ends, (1.0, -1.0), strict=True):
        exact, near = (sign * one[end].values for one in (found, sampled))
        assert (np.isnan(exact) == np.isnan(near)).all()
        # the samples are among all positions, and not one of them is beyond the extreme
        assert (exact >= near - 1e-9 * abs(near))[~np.isnan(near)].all()


@pytest.mark.parametrize(
    ("best", "bound", "value", "other", "of_best"),
    [
        (5.0, 1.0, 3.0, 1.0, 1.0),  # far apart: that of the better one
        (5.0, 1.0, 4.5, 3.0, 2.5),  # the other may reach to 7.5
        (4.5, 3.0, 5.0, 1.0, 2.5),  # in whatever order they come
        (-np.inf, 0.0, 2.0, 0.5, 0.5),  # the first one
        (5.0, 1.0, np.nan, np.inf, 1.0),  # nothing
        (5.0, 1.0, 2.0, np.inf, np.inf),  # one of which nothing is known
        (np.inf, np.inf, 2.0, 1.0, np.inf),
    ],
)
def test_the_bound_of_the_best_counts_that_another_one_may_be_it(best, bound, value, other, of_best):
    assert of_better(best, bound, value, other) == of_best


def test_labels_and_axes_of_errors_are_their_own_and_a_kernel_computes_them_on_request_alone():
    found = swept_4r(["omega4_max_error", "omega4_error_max", "omega4_extrema_error"])
    assert found["omega4_max_error"].attrs["symbol"] == "err max omega_4"
    assert found["omega4_error_max"].attrs["symbol"] == "max err omega_4"
    assert {found[name].attrs["units"] for name in found.data_vars if name != "status"} == {"rad s-1"}
    assert found["omega4_extrema_error"].dims == ("branch", "extremum")
    # Left out as a product, its rounding would be missing.
    one = swept_4r(["omega4_max_error"])
    axis = fl.grid(**CRANK, omega1=[1.0, 3.0])
    found = sweep_4r(axis, ["omega4_max", "omega4_max_error"])
    assert "scaling_axis" not in found.attrs
    assert_array_equal(found["omega4_max_error"][0], one["omega4_max_error"])
    names = ("omega4_max", "alpha4_max", "omega4_rms")
    plan = make_plan(catalogue("planar_4r"), names, given=(*LENGTHS, "omega1"))
    texts = [kernel_of(program).text for program in plan.programs]
    assert not any("error" in text or "winners" in text for text in texts)
    with refused("quantity 'omega4_max_error'", "write 'omega4_error'"):
        fl.evaluate("planar_4r", ["omega4_max_error"], theta1=1.0, omega1=1.0, **CRANK)


def test_verification_holds_errors_of_extremes_against_their_bounds():
    names = ["omega4_max", "omega4_max_error", "omega4_extrema", "omega4_extrema_error", "theta4_min_error"]
    found = swept_4r(names, verify=1)
    for name in ("omega4_max_error", "omega4_extrema_error"):
        assert 0.0 <= found[name].attrs["error_max_of_bound"] <= 1.0
    assert found.attrs["verify_mismatches"] == 0
    assert found.attrs["verify_left_out"] == "theta4_min_error"  # without its value there is no error
    assert "of the bound, of 1" in found.fastlink.summary()
    measured = MeasuredErrors("")
    measured.add_bound(0.5, 1.0, CONTEXT.mpf(1.25))
    assert measured.attrs()["error_max_of_bound"] == 0.5
    for bound, value, exact in ((0.2, 1.0, 1.25), (0.0, 1.0, 1.25), (np.nan, 1.0, 1.25), (1.0, np.inf, 1.0)):
        measured.add_bound(bound, value, CONTEXT.mpf(exact))
    assert (measured.values, measured.mismatches) == (5, 4)


@pytest.mark.parametrize(
    ("name", "options", "remedy"),
    [
        ("omega4_mean_error", {}, "ask for omega4_error_max"),
        ("theta1_at_omega4_max_error", {}, "ask for omega4_max_error"),
        ("theta1_at_omega4_extrema_error", {}, "ask for omega4_extrema_error"),
        ("omega4_extrema_count_error", {}, "leave it out"),
        ("omega4_max_error", {"extrema": "sampled"}, "write extrema='refined', or ask for omega4_error_max"),
        ("omega4_min_error", {"theta1": [0.1, 0.2], "extrema": "sampled"}, "give no array of theta1"),
        ("loop_residual_max_error", {}, "ask for loop_residual_error_max"),
        ("omega4_error_max_error", {}, "leave it out"),
        ("d_omega4_max_d_theta1", {}, "such as d_omega4_max_d_"),
        ("d_omega4_max_d_a2_error", {}, "ask for omega4_max_error"),
        ("d_d_omega4_max_d_a1_d_a2", {}, "ask for d_omega4_max_d_a1"),
        ("d_omega4_fluctuation_d_a2", {}, "leave it out"),
        ("d_theta1_at_omega4_max_d_a2", {"extrema": "sampled"}, "leave it out"),
        ("d_circuit_max_d_a2", {}, "leave it out"),
        ("d_omega4_error_max_d_a2", {}, "leave it out"),
    ],
)
def test_what_has_no_bound_or_derivative_is_refused_with_the_reason(name, options, remedy):
    with refused("quantity ", remedy):
        swept_4r([name], **options)


def parts_of(name, position, by):
    """Return what may be requested of a quantity."""
    lists = ["extrema", "extrema_count", "extrema_kind"]
    best = [f"{name}_max", f"{position}_at_{name}_max", f"{name}_min", f"{position}_at_{name}_min"]
    slopes = [f"d_{name}_max_d_{by}", f"d_{name}_min_d_{by}", f"{name}_max_gradient_status"]
    return [
        [*(f"{name}_{part}" for part in lists), f"{position}_at_{name}_extrema"],
        best,
        slopes,
        [f"{name}_max_error", f"{name}_extrema_error"],
    ]


def differing(entry, designs, requests):
    """Return the results that are not the same together and in requests of their own, by name."""

    def found(names):
        maps = sweep_both(entry.mechanism, fl.table(designs), names, input=entry.input, **QUIET)
        return {name: maps[name].values for name in names}

    together = found(list(dict.fromkeys(name for names in requests for name in names)))
    return {
        name: of for names in requests for name, of in found(names).items() if not same(together[name], of)
    }


def same(one, other):
    """Compare to the bit; lists of one request may be longer than those of another, by what is NaN, or 0 as a kind."""
    if one.ndim == other.ndim and one.shape != other.shape:
        length = min(one.shape[-1], other.shape[-1])
        one, other = (values[..., :length] for values in (one, other))
    return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")


#: An extreme known in closed form, one that is searched; and designs where rounding errors once filled lists.
TOGETHER = {
    "known": [["theta4_max"], ["theta4_max_error", "theta4_extrema", "d_theta4_max_d_a2"], ["T41_min"]],
    "searched": parts_of("omega4", "theta1", "a2"),
    "folded": [
        *(parts_of(name, "theta1", "a2")[0] for name in ("alpha4", "F41")),
        ["F41_max", "shaking_force_extrema"],
    ],
}


@pytest.mark.sample(1)
@pytest.mark.parametrize("case", TOGETHER)
def test_results_are_the_same_whatever_else_is_requested(case):
    folded = case == "folded"
    rng = np.random.default_rng(5)
    designs = folded_planar_4r(rng, 40) if folded else designs_of(PLANAR, "random", 7, 40)
    assert differing(PLANAR, designs, TOGETHER[case]) == {}


@pytest.mark.stress
@pytest.mark.parametrize("entry", SEARCHED, ids=str)
def test_results_of_a_mechanism_are_the_same_whatever_else_is_requested(entry):
    for seed, kind in enumerate(entry.families):
        designs = designs_of(entry, kind, seed, 60)
        names = map(str, np.random.default_rng(seed).permutation(searched(entry, designs))[:3])
        by = next(name for name in designs if not entry.catalogue.known_inputs(())[name].choices)
        parts = [parts_of(name, entry.input, by) for name in names]
        wholes = [[name for part in of for name in part] for of in parts]
        assert differing(entry, designs, [*wholes, *(part for of in parts for part in of)]) == {}, kind


def test_designs_in_a_sweep_leave_each_other_alone():
    """A speed that is constant but for rounding has zeros of its slope without end, which once filled all lists."""
    constant = (0.0004194733386214631, 0.4003315786432696, 0.00041947333862142275, 0.4003315786432696)
    narrow = (1.0881782807647401, 2.1763565615294802, 2.5390826551177268, 1.4509043743529879)
    points = {
        "P_u": (-0.36602983798650074, 2.8528788783126706),
        "P_v": (13.846241829606216, -1782570.0943710102),
    }

    def least(neighbours):
        rows = [0] * neighbours + [1]
        columns = by_name(*((constant, narrow)[k] for k in rows))
        columns |= {name: np.array([of[k] for k in rows]) for name, of in points.items()}
        columns["omega1"] = np.array([(1.0, -1.0)[k] for k in rows])
        return sweep_4r(fl.table(columns), ["P_speed_min"]).P_speed_min.values[-1]

    assert_array_equal(least(40), least(0))


#: Mechanism, input, quantity, branch, the fold or place beside which extremes hide, design.
HIDDEN = {
    # one half of the turn is constant but for rounding, and has the least value
    "half a turn at rest": (
        ("planar_4r", "theta1", "F32", 2, 0.0),
        numbers(
            "a1=9 a2=2 a3=9 a4=2 omega1=0.5 m1=2.4671355648387943e-07 I1=0 G1_u=9 G1_v=-0.0006549136337967812 "
            "m2=1.7271844878678653 I2=0.9867537083850588 G2_u=9 G2_v=0 m3=501834486656.10767 I3=0 "
            "G3_u=15.265182336000926 G3_v=43421.32110501148 P_u=0.6000493924319583 P_v=9911.360095279775 "
            "T_load=1 T_load_linear=1.494155118855378 T_load_quadratic=-1"
        ),
    ),
    # the crank alone has mass: nothing grows where coupler and output link are in line, and the least is there
    "force of links without mass": (
        ("planar_4r", "theta1", "shaking_force", 1, 0.9272952180016122),
        numbers(
            "a1=5 a2=2 a3=3 a4=4 omega1=-0.441125 m1=0.001349 I1=1 G1_u=-5 G1_v=5 m2=0 I2=3.8e-05 G2_u=7 "
            "G2_v=5 m3=0 I3=1.680962 G3_u=0 G3_v=0 gravity_x=-0.032687 gravity_y=0"
        ),
    ),
    # P passes so near to the centre about which the coupler turns that no sample beside shows it
    "curvature at a cusp": (
        ("planar_4r", "theta1", "curvature", 1, 3.4),
        numbers(
            "a1=1.1944011076648948 a2=3.321112303368561 a3=1.7553999076621674 a4=2.760113502371308 omega1=1 "
            "P_u=3.321112303368561 P_v=-0.02649742954072939"
        ),
    ),
    # where r = l and e = 0 the slider stays at O for half a turn, and its torque is zero but for rounding
    "torque that is zero for half a turn": (
        ("slider_crank", "theta", "T41", 1, np.pi / 2),
        numbers(
            "r=8 l=8 e=0 omega=0.5639 m1=0 I1=0 m2=0 I2=0.84 m3=0.167 G1_u=8 G1_v=8 G2_u=-4.2 G2_v=9 "
            "F_load=179"
        ),
    ),
    # only I2 acts, so that F41 changes its sign with alpha2: its zero at a sample has no slope
    "force that is exactly 0 at a sample": (
        ("slider_crank", "theta", "F41", 2, np.pi / 2),
        numbers(
            "r=1.048245833941114 l=2.8151436694020036 e=-1.7668978354608884 omega=-1 m1=0 "
            "I1=1.4162467717588534e-09 m2=0 I2=6.210836172235572e-05 m3=0 G1_u=0.35166168617373966 "
            "G1_v=4.174227550120641 G2_u=2.8151436694020036 G2_v=-0.002658583659505936"
        ),
    ),
    # T is 3e9 lengths away where rho nears -1, and AB turns within 1e-9 rad of the fold
    "a point far away that swings round": (
        ("focal", "sigma", "T_y", 1, 0.0),
        numbers("a=6 b=6 c=2 d=2 rho=-0.9999999993232827 completion=1"),
    ),
}
OCTAVES = 2.0 ** np.linspace(-60.0, 0.0, 601)


def extremes_beside(case):
    """Return greatest and least values with their bounds, beyond which nothing is near the fold."""
    (mechanism, drive, quantity, branch, fold), design = HIDDEN[case]
    columns = {name: np.array([value]) for name, value in design.items()}
    near = np.concatenate([fold - OCTAVES, fold + OCTAVES, fold + np.linspace(-np.pi, np.pi, 401)])[None]
    found = assert_none_beyond(mechanism, drive, columns, [quantity], near, [branch])
    return [float(found[name].item()) for name in found]


def test_nothing_next_to_change_points_is_beyond_greatest_and_least():
    """With gaps down to a last bit, links of very different lengths, and a rocker."""
    gaps = [sign * 10.0**-power for power in (1, 4, 8, 12, 15) for sign in (-1, 1)] + [2.0**-52, 0.0]
    folded = [(1.25, 1.0, 0.875, 1.125), (1.375, 1.25, 1.5, 1.125), (1.25, 1.0, 1.125, 0.875)]
    lengths = [(a + gap, b, c, d) for a, b, c, d in folded for gap in gaps]
    lengths += [(1e-8, 1.1, 0.8, 0.9), (1.0, 3.0, 2.0, 1e-8), (2.0, 1.0, 2.5, 3.0)]
    near = np.concatenate([np.geomspace(1e-17, 3.0, 400), np.linspace(0.01, 3.1, 200)])
    positions = np.concatenate([sign * (fold + near) for sign in (-1, 1) for fold in (0.0, -np.pi)])[None]
    names = ["omega4", "transmission_angle"]
    assert_none_beyond("planar_4r", "theta1", by_name(*lengths, omega1=25.0), names, positions)


def test_a_torque_that_is_zero_for_half_a_turn_has_the_extreme_of_its_closed_form():
    """T41 of r = l without offset."""
    most = extremes_beside("torque that is zero for half a turn")[0]
    theta = np.linspace(0.0, np.pi / 2, 100001)
    load = 179.0 + 2 * 0.167 * 8.0 * 0.5639**2 * np.cos(theta)
    assert most == pytest.approx(np.max(16.0 * np.sin(theta) * load), rel=1e-9)


@pytest.mark.stress
def test_extremes_beside_folds_are_those_of_closed_forms():
    """The pull of the crank alone; a cusp; what is 0, and what rests."""
    # F = m1 |g - a|, a = omega1^2 |OG1| towards O, over the reachable range
    outward = np.arccos((5.0**2 + 4.0**2 - 5.0**2) / 40.0) * np.linspace(-1.0, 1.0, 200001) + 0.75 * np.pi
    pull = 0.441125**2 * np.sqrt(50.0)
    force = 0.001349 * np.hypot(pull * np.cos(outward) - 0.032687, pull * np.sin(outward))
    most, _, least, _ = extremes_beside("force of links without mass")
    assert (most, least) == (pytest.approx(force.max(), rel=1e-9), pytest.approx(force.min(), rel=1e-12))
    assert extremes_beside("curvature at a cusp")[0] > 1e9
    _, _, least, bound = extremes_beside("force that is exactly 0 at a sample")
    assert least <= bound
    most, _, least, _ = extremes_beside("half a turn at rest")
    assert least < 1e6 < 1e18 < most
    assert extremes_beside("a point far away that swings round")[0] > 1e9


def test_a_limit_at_a_fold_that_has_no_value_is_flagged():
    """T of a focal kite comes to the ground line where it folds, from below; in doubles it has no place there."""
    kite = {"a": 3.0, "b": 6.0, "c": 3.0, "d": 6.0, "lambda_": -0.9999999999995224, "completion": 2.0}
    found = fl.sweep(
        "focal", fl.grid(**kite, omega=1.0), ["T_y_max", "T_y_max_error"], input="sigma", branch=2
    )
    # within 1e-13 of the places and 2^-30 of the fold: rounding over the distance
    assert abs(float(found.T_y_max)) < 1e-4
    assert float(found.T_y_max_error) == np.inf


#: Half the number of cells of a search that divides none; a power of two.
FINE = 512
#: What may still hide, of all counts: where the gap of a change point is near the rounding of the lengths, one pair of
#: extremes of a curvature in 172,000 counts was seen to, and one of a shaking moment of huge slider-cranks.
MOST_HIDDEN = {"gap 1e-13": 1e-5, "scale 1e20": 1e-5}
#: More extremes than anything has: samples so close show the rounding of a flat function (F_x of the focal crank).
MOST_REAL = 16


def counted(entry, designs, names, monkeypatch=None):
    """Count the extremes of quantities (quantity, design, branch); with sixteen times as many cells, to monkeypatch."""
    if monkeypatch is not None:
        monkeypatch.setattr(entry.catalogue, "graded", replace(entry.catalogue.graded, cells_otherwise=FINE))
    _plan.cache_clear()
    asked = [f"{name}_extrema_count" for name in names]
    maps = sweep_both(entry.mechanism, fl.table(designs), asked, input=entry.input, **QUIET)
    _plan.cache_clear()
    return np.stack([maps[name].transpose("design", ...).values for name in asked])


@pytest.mark.stress
@pytest.mark.parametrize("entry", SEARCHED, ids=str)
def test_finer_samples_show_no_more_extremes_of_anything(entry, monkeypatch):
    searches = {name: search_of(entry, name) for name in entry.names}
    names = [name for name, search in searches.items() if search is not None and search.divided]
    for kind in entry.families:
        if kind.startswith(("kite", "line 1e-12")):
            continue  # much is constant but for rounding there, whose extremes are not counted alike
        designs, hidden, of = designs_of(entry, kind, 31, 3000), 0, 0
        for start in range(0, len(names), 6):  # a kernel of all takes long to compile
            some = names[start : start + 6]
            counts = counted(entry, designs, some)
            with monkeypatch.context() as patch:
                finer = counted(entry, designs, some, patch)
            hidden += np.count_nonzero((counts != finer) & (finer <= MOST_REAL))
            of += counts.size
        assert hidden <= MOST_HIDDEN.get(kind, 0.0) * of, kind


def test_counts_beside_toggles_and_folds_are_of_extremes_not_of_rounding():
    """Next to a straight line T_x has an extreme within 2^-24 of the toggle, where its slope is 1e-6 of what it is."""
    (entry,) = (entry for entry in SEARCHED if str(entry) == "focal sigma")
    designs = entry.drawn("line 1e-8", 31, 3000)
    some = {
        name: designs[name][[1086, 1737, 2057, 2989]] for name in entry.catalogue.inputs if name in designs
    }
    assert (counted(entry, some, ["T_x"]) == 2).all()
    # Forces of a kite stay finite where it folds; their slope is rounding errors over the distance from
    # there.
    a, b = (
        np.array([1.5299061143042894, 0.4009099102008036]),
        np.array([1.9559321078037128, 1.910416264244732]),
    )
    space = fl.table({"a1": a, "a2": b, "a3": b, "a4": a, "omega1": np.full(2, 25.0)})
    counts = sweep_4r(space, ["F32_extrema_count"], links=BARS).F32_extrema_count
    assert np.all(counts == 0)


#: The functions that are not smooth where their argument vanishes; `sqrt` and `select` choose and scale within facts.
SHARP = {"abs", "magnitude", "largest", "sign", "absolute", "choice", "zero_where"}
#: What is searched without being told, and why; dense samples say whether that is enough.
SMOOTH_ELSEWHERE = {
    "P_speed": "the size is that of an input; the one magnitude turns sharply at cusps, as the tests below make it do",
    "M_across_AB": "sizes choose between two forms of the same coordinate",
    "transmission_angle_F": "a size in one of two forms of the same angle; no sample was beyond, which is no proof",
}
#: How many quantities are sharp by their text, of the inputs that have such: one less is one that is not looked at.
KNOWN = {("planar_4r", "theta1"): 6, ("slider_crank", "theta"): 4, ("focal", "phi"): 3, ("focal", "sigma"): 4}


def sharp_by_text(entry):
    """Return the quantities whose own text takes a magnitude, a size or a choice of signs, with their searches."""
    known, found = entry.catalogue, {}
    for name in filter(known.varies, known.public):
        search = search_of(entry, name)
        if search is not None and not known.facts[name].formula.uses.isdisjoint(SHARP):
            found[name] = search
    return found


def undeclared(entry):
    """Return the quantities with sharp places that their searches do not know of."""
    searches = sharp_by_text(entry).items()
    return [name for name, of in searches if not (of.magnitude or of.folds or name in SMOOTH_ELSEWHERE)]


def test_searches_know_what_is_sharp(monkeypatch):
    assert [name for entry in SEARCHED for name in undeclared(entry)] == []
    counts = {(entry.mechanism, entry.input): len(sharp_by_text(entry)) for entry in SEARCHED}
    assert {key: count for key, count in counts.items() if count} == KNOWN
    monkeypatch.setattr("fastlink.plan.programs.is_magnitude", lambda step: False)
    assert undeclared(PLANAR) == ["F41", "F21", "F32", "F43", "shaking_force"]


@pytest.mark.stress
@pytest.mark.parametrize("entry", [e for e in SEARCHED if (e.mechanism, e.input) in KNOWN], ids=str)
def test_nothing_sharp_is_beyond_greatest_and_least(entry):
    for kind in entry.families:
        if kind != "short 1e-8":  # such a rod moves between two samples
            positions = np.linspace(0.0, 2 * np.pi, 2001)[None]
            designs = designs_of(entry, kind, 5, 200)
            assert_none_beyond(entry.mechanism, entry.input, designs, list(sharp_by_text(entry)), positions)


def almost_vanishing(name, n, seed):
    """Return designs whose coupler point or force is within 1e-9 to 0.1 of its size of zero at theta1 = 1."""
    rng = np.random.default_rng(seed)
    lengths = {"a1": rng.uniform(0.1, 0.5, n), "a2": rng.uniform(0.8, 1.3, n), "a3": rng.uniform(0.8, 1.2, n)}
    designs = {**lengths, "a4": np.ones(n), "omega1": np.full(n, 3.0)}
    # both are linear in two inputs: where they vanish, from three evaluations
    places = ("P_u", "P_v") if name == "P_speed" else ("G1_u", "G1_v")
    parts = {"P_speed": ("P_vx", "P_vy")}.get(name, (f"{name}_x", f"{name}_y"))
    if name != "P_speed":
        for k in (1, 2, 3):
            designs |= {f"m{k}": rng.uniform(0.5, 2.0, n), f"I{k}": rng.uniform(0.1, 1.0, n)}
            designs |= {f"G{k}_u": rng.uniform(-1.0, 1.0, n), f"G{k}_v": rng.uniform(-1.0, 1.0, n)}
    values = []
    for u, v in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)):
        at = {**designs, places[0]: np.full(n, u), places[1]: np.full(n, v)}
        found = fl.evaluate("planar_4r", list(parts), **at, theta1=1.0, branch=1)
        values.append(np.array([np.broadcast_to(found[part], n) for part in parts]))
    slopes = np.moveaxis(np.array([values[1] - values[0], values[2] - values[0]]), (0, 1), (2, 1))
    solved = np.linalg.solve(slopes, -values[0].T[:, :, None])[:, :, 0]
    off = 10.0 ** rng.uniform(-9.0, -1.0, n)
    return designs | {places[0]: solved[:, 0] + off, places[1]: solved[:, 1]}


def near_cusps(seed, n):
    """Return designs, branches and positions where P is near the coupler's instant centre, at all distances."""
    rng = np.random.default_rng(seed)
    lengths = np.exp(rng.uniform(-1.5, 1.5, (4, n)))
    folded = rng.random(n) < 0.3
    gap = 1.0 + rng.choice([-1.0, 1.0], n) * 10.0 ** rng.uniform(-14, -2, n)
    lengths[0, folded] = (gap * abs(lengths[1] - lengths[2] + lengths[3]))[folded]
    design = dict(zip(LENGTHS, lengths, strict=True)) | {"omega1": np.ones(n)}
    theta1, branch = rng.uniform(0.0, 2.0 * np.pi, n), rng.integers(1, 3, n).astype(float)
    rates = fl.evaluate("planar_4r", ["omega2", "theta2"], theta1=theta1, branch=branch, **design)
    turns = abs(rates["omega2"]) > 1e-6
    # A' + omega2 w' = 0 for the arm w of P
    arm = -design["a1"] * np.exp(1j * theta1) / np.where(turns, rates["omega2"], 1.0)
    off = 10.0 ** rng.uniform(-9.0, 0.0, n) * design["a1"]
    arm = arm * np.exp(-1j * rates["theta2"]) + off * np.exp(1j * rng.uniform(0.0, 2.0 * np.pi, n))
    design |= {"P_u": arm.real, "P_v": arm.imag}
    return {name: values[turns] for name, values in design.items()}, branch[turns], theta1[turns]


@pytest.mark.sample(2)
@pytest.mark.parametrize("n", [1, pytest.param(60, marks=pytest.mark.stress)])
@pytest.mark.parametrize("name", ["P_speed", "shaking_force", "F41", "curvature"])
def test_none_is_beyond_where_a_magnitude_almost_vanishes(name, n):
    """Of the three extremes within a cusp one of the outer two may be taken for the other: in one of 10,000."""
    steps = np.concatenate([[0.0], 10.0 ** np.linspace(-12.0, 0.4, 200)])
    if name == "curvature":
        designs, _, places = near_cusps(1, 700 * n)
    else:
        designs, places = almost_vanishing(name, 40 * n, 3), np.ones(1)
    positions = places[:, None] + np.concatenate([-steps, steps])
    assert_none_beyond("planar_4r", "theta1", designs, [name], positions)


# == Extremes that are known in closed form: what a search finds =============================================

KNOWN_ENTRIES = [entry for entry in SEARCHED if entry.catalogue.graded.known]
MANY = [e for e in KNOWN_ENTRIES if len(e.catalogue.graded.known) > 4 and e.mechanism != "focal"]
#: Both ways evaluate by the same facts, at places that differ by roundings: their bounds are the same but for a few
#: of the second order. A place where nothing is extreme is not told from its neighbours by rounding.
ALIKE = 1.01
#: Beside kites of Hart's linkage the slope that is computed at a place is not 0 but within its bound: the square of the
#: sum of both, which the bound of the value has, is four times that of the bound alone. 2.8 at most in 2,000 designs.
ALIKE_OF = {"hart": 4.0}
#: Change points, kites, parallelograms, rhombi, rigid and impossible linkages.
FOLDING = "1221 2112 1122 2211 1212 2121 1111 2345 5432 4523 1234 6123 1623 1236 7123"


@contextmanager
def all_searched(of):
    """Let every extreme be searched."""
    graded = of.graded
    assert graded is not None
    of.graded = replace(graded, known={})
    try:
        yield
    finally:
        of.graded = graded


def assert_alike(mechanism, input, designs):
    """Assert that known extremes are those that a search finds, with their bounds."""
    of = catalogue(mechanism, input)
    assert of.graded is not None
    ends = [f"{name}_{end}" for name in of.graded.known for end in ("max", "min")]
    names = [name + part for name in ends for part in ("", "_error")]
    known = sweep_both(mechanism, fl.table(designs), names, input=input)
    with all_searched(of):
        found = sweep_both(mechanism, fl.table(designs), names, input=input)
    for name in ends:
        one, other = known[name].values, found[name].values
        bound, other_bound = known[f"{name}_error"].values, found[f"{name}_error"].values
        assert np.array_equal(np.isnan(one), np.isnan(other)), name
        assert np.array_equal(np.isnan(bound), np.isnan(other_bound)), name
        there = ~np.isnan(one)
        assert np.all(abs(one - other)[there] <= (bound + other_bound)[there]), name
        alike = ALIKE_OF.get(mechanism, ALIKE)
        assert np.all(bound[there] <= alike * other_bound[there] + np.spacing(abs(other))[there]), name


def drawn(entry, family, n):
    """Return designs of a family, in one completion."""
    designs = designs_of(entry, family, 0, n)
    return {name: values for name, values in designs.items() if name != "completion"}


@pytest.mark.sample(1)
@pytest.mark.parametrize("entry", MANY, ids=str)
def test_known_extremes_are_those_that_a_search_finds(entry):
    """Of all families together; the inputs with one law or two are left to the long form."""
    parts = [drawn(entry, family, 3) for family in entry.families]
    designs = {name: np.concatenate([each[name] for each in parts]) for name in parts[0]}
    assert_alike(entry.mechanism, entry.input, designs)


@pytest.mark.stress
@pytest.mark.parametrize("entry", KNOWN_ENTRIES, ids=str)
def test_known_extremes_are_those_that_a_search_finds_in_many_designs(entry):
    for family in entry.families:
        assert_alike(entry.mechanism, entry.input, drawn(entry, family, 2000))


@pytest.mark.parametrize("longest", [0, pytest.param(9, marks=pytest.mark.stress)])
def test_known_extremes_of_linkages_that_fold(longest):
    """Exact change points, and linkages that assemble in one position or never; all whole lengths in the long form."""
    lengths = np.array([[float(digit) for digit in design] for design in FOLDING.split()]).T
    if longest:
        lengths = np.stack(np.meshgrid(*[np.arange(1.0, longest + 1.0)] * 4), axis=-1).reshape(-1, 4).T
    assert_alike("planar_4r", None, dict(zip(LENGTHS, lengths, strict=True)))


def test_places_are_those_of_a_search_and_hold_the_extreme():
    """Of linkages without symmetry. At theta1 as a double a slope of up to 1e8 next to a toggle may count."""
    designs = dict(zip(LENGTHS, np.random.default_rng(1).uniform(0.2, 2.0, (4, 400)), strict=True))
    names = [f"{name}_{end}" for name in ("theta4", "B_x") for end in ("max", "min")]
    places = [f"theta1_at_{name}" for name in names]
    known = sweep_4r(fl.table(designs), [*names, *places])
    with all_searched(catalogue("planar_4r")):
        found = sweep_4r(fl.table(designs), places)
    for name, place in zip(names, places, strict=True):
        apart = abs(known[place] - found[place]).values
        # a place where the slope is 0 to a rounding is known to its root
        assert np.nanmax(np.minimum(apart, abs(apart - 2 * np.pi))) < 1e-6, name
        assert np.array_equal(np.isnan(known[place]), np.isnan(known[name]))


@pytest.mark.parametrize("quantity", ["transmission_angle", pytest.param("theta4", marks=pytest.mark.stress)])
def test_derivatives_of_known_extremes_are_those_that_a_search_finds(quantity):
    """With what they are worth, of linkages of every kind, next to change points and at them."""
    random = np.random.default_rng(4).uniform(0.2, 2.0, (4, 60))
    whole = np.array([[float(digit) for digit in design] for design in FOLDING.split()]).T
    near = whole * (1.0 + 1e-9 * np.random.default_rng(5).uniform(-1.0, 1.0, whole.shape))
    # a kite whose link stands still has an extreme everywhere: which one is found is rounding
    designs = dict(zip(LENGTHS, np.concatenate([random, near, whole[:, 7:]], axis=1), strict=True))
    ends = [f"{quantity}_{end}" for end in ("max", "min")]
    slopes = [f"d_{of}_d_{by}" for end in ends for of in (end, f"theta1_at_{end}") for by in LENGTHS]
    names = [*slopes, *(f"{end}_gradient_status" for end in ends)]
    known = sweep_4r(fl.table(designs), names)
    with all_searched(catalogue("planar_4r")):
        found = sweep_4r(fl.table(designs), names)
    for end in ends:
        assert np.array_equal(known[f"{end}_gradient_status"], found[f"{end}_gradient_status"])
    for name in slopes:
        # the place is off by a rounding over the curvature: of gaps of 1e-9 in the root, 3e-5
        assert np.allclose(known[name], found[name], rtol=1e-4, atol=1e-9, equal_nan=True), name


def test_what_is_known_is_not_searched():
    """The plan tells; lists and what a variant replaces are searched."""
    planar = catalogue("planar_4r")
    names = ["transmission_angle_max", "omega4_max", "theta4_extrema"]
    kinds = [type(p) is KnownProgram for p in make_plan(planar, names, given=list(planar.inputs)).programs]
    assert sorted(kinds) == [False, False, True] or sorted(kinds) == [False, True]
    text = fl.explain("planar_4r", fl.grid(a1=1, a2=2, a3=2, a4=3), ["theta4_max"], branch=(1, 2)).text(
        kernels=True
    )
    assert "theta4_max; known extremes, which are not searched, of theta4" in text
    by_crank = catalogue("focal", "sigma")
    asked, given = ["transmission_angle_P_max"], ["a", "b", "c", "d", "lambda_", "completion"]
    (program,) = make_plan(
        by_crank, asked, given=given, variants=by_crank.variants_selected_by(given)
    ).programs
    assert type(program) is not KnownProgram

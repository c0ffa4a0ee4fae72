"""Extremes of declared linkages, which are searched in the pieces of the turn in which all dyads close."""

import numpy as np
import pytest
from tests.mechanisms.linkages.declared import (
    FOUR_BAR,
    HART,
    SIX_BAR,
    SLIDER_CRANK,
    TURNING,
    four_bars,
    six_bars,
    slider_cranks,
)
from tests.mechanisms.linkages.test_dyads import CRANK, EACH, KINDS

import fastlink as fl
from fastlink.codegen.kernel import llvm_text
from fastlink.engine.resolve import resolve
from fastlink.mechanisms import catalogue

#: By the name of a mechanism: the declared one, what its speed is called, its designs, its quantities by their names.
DECLARED = {
    "planar_4r": (
        FOUR_BAR,
        "omega1",
        four_bars,
        "theta4=angle_DB omega2=omega_AB alpha4=alpha_DB P_x=P_x P_speed=P_speed "
        "transmission_angle=transmission_angle_B T41=torque F21=force_AB_A F32_x=force_AB_B_x "
        "F43=force_DB_D F41_y=force_OA_O_y shaking_force=shaking_force shaking_moment=shaking_moment",
    ),
    "slider_crank": (
        SLIDER_CRANK,
        "omega",
        slider_cranks,
        "slider_position=slide_B slider_acceleration=slide_B_acceleration theta2=angle_AB omega2=omega_AB "
        "transmission_angle=transmission_angle_B T41=torque side_force=normal_force_B F32=force_AB_B "
        "F21=force_AB_A shaking_force_x=shaking_force_x shaking_moment=shaking_moment",
    ),
}


def agree(one, off, other, error):
    """Tell where each of two values is within its own bound of the exact one, or neither is a number."""
    with np.errstate(invalid="ignore"):
        return (one == other) | (np.isnan(one) & np.isnan(other)) | (abs(one - other) <= off + error)


#: Numbers of designs and seeds, in a run and in a long one.
COUNTS = [(300, 1), *(pytest.param(20_000, seed, marks=pytest.mark.stress) for seed in range(2, 7))]
#: What is compared in a run; all that is shared in a long one.
FEW = {
    "planar_4r": ("theta4", "P_x", "T41", "F43"),
    "slider_crank": ("slider_position", "theta2", "side_force"),
}


@pytest.mark.parametrize(("count", "seed"), COUNTS)
@pytest.mark.parametrize("mechanism", DECLARED)
def test_a_declared_mechanism_has_the_extremes_of_the_one_by_hand(mechanism, count, seed):
    """Which is exact next to change points."""
    declared, speed, designs_of, shared = DECLARED[mechanism]
    shared = dict(pair.split("=") for pair in shared.split())
    names = FEW[mechanism] if count == COUNTS[0][0] else shared
    shared, designs = {name: shared[name] for name in names}, designs_of(count, seed)
    ends = [(how, of) for how in ("max", "min") for of in ("", "_error")]
    theirs = [f"{name}_{how}{of}" for name in shared for how, of in ends]
    ours = [f"{name}_{how}{of}" for name in shared.values() for how, of in ends]
    known = fl.sweep(mechanism, designs | {speed: 10.0}, theirs, branch=(1, 2))
    found = fl.sweep(declared, designs | {"omega": 10.0}, ours, branch=(1, 2))
    words = ("change_point", "assembles_in_one_position", "never_assembles")
    flags = known.status.attrs["flag_meanings"].split()
    # the longest bar is as long as the others by one rounding: there is one position, or none
    one = flags.index("assembles_in_one_position") if "assembles_in_one_position" in flags else -1
    none = found.status.attrs["flag_meanings"].split().index("never_assembles")
    open_by_rounding = (known.status.values[:, None] == one) & (found.status.values == none)
    for name, other in zip(theirs[::2], ours[::2], strict=True):
        a, b = known[name].values, found[other].values
        same = agree(a, known[f"{name}_error"].values, b, found[f"{other}_error"].values)
        same |= open_by_rounding
        assert same.all(), (name, np.argwhere(~same)[:3], a[~same][:3], b[~same][:3])
    # where the other counts a gap as zero, the declared one sees which side it is on, if its bounds are finite
    unsure = [flags.index(word) for word in words if word in flags]
    decided = np.isfinite(found[ours[1]].values).all(axis=1) & ~np.isin(known.status.values, unsure)
    assert (found.status.values[decided] == known.status.values[decided, None]).all()


def test_the_least_transmission_angle_is_that_of_the_worst_dyad_where_that_is_worst():
    ends = [f"transmission_angle_{name}_{how}" for name in "BF" for how in ("min", "max")]
    least = "least_transmission_angle_min"
    maps = fl.sweep(SIX_BAR, six_bars(300, 7) | {"omega": 1.0}, [*ends, least], branch=(1, 2, 3, 4), verify=1)
    of_dyads = np.minimum(
        *(np.minimum(maps[f"{one}_min"], np.pi - maps[f"{one}_max"]) for one in (ends[0][:-4], ends[2][:-4]))
    )
    assert maps.attrs["verify_mismatches"] == 0
    # angles within [0, pi], each of which is right to a rounding or two
    assert np.allclose(maps[least], of_dyads, rtol=0.0, atol=8 * 2.0**-52, equal_nan=True)


@pytest.mark.parametrize(("count", "seed"), COUNTS)
def test_harts_linkage_is_the_one_by_hand(count, seed):
    """Positions, and extremes of the rocker.

    Where F is in line with P and Q the dyad touches its limit, and goes on by either of its ways to assemble.
    """
    rng = np.random.default_rng(seed)
    # of few binary digits, so that the lengths of the bars are exact
    kappa = rng.integers(4, 30, count) / 32
    m, n, d = (rng.integers(8, 64, count) / 64 for _ in range(3))
    bars = {"mp": m, "nq": n, "ma": (1 - kappa**2) * m, "nb": (1 - kappa**2) * n}
    bars |= {"ab": kappa * d, "pf": kappa * n, "qf": kappa * m, "d": d, "omega": 1.0}
    given, angles = {"m": m, "n": n, "d": d, "kappa": kappa}, np.linspace(0.05, 6.2, 12)
    curve, (both, all_four) = ("F_y", "F_y_error"), ((1, 2), (1, 2, 3, 4))
    known = fl.sweep("hart", given, curve, branch=both, phi=angles)
    found = fl.sweep(HART, bars, curve, branch=all_four, theta=angles)
    # by whether F is left of PQ, and by whether B is left of AN
    ours, bound = (found[name].values.reshape(count, 2, 2, -1) for name in curve)
    same = agree(*(known[name].values[:, None] for name in curve), ours, bound).any(axis=1)
    assert same.all(), np.argwhere(~same)[:3]
    for end in ("max", "min"):
        theirs, mine = ([f"{name}_{end}", f"{name}_{end}_error"] for name in ("psi", "angle_NB"))
        known = fl.sweep("hart", given, theirs, branch=both)
        found = fl.sweep(HART, bars, mine, branch=all_four)
        ours, bound = (found[name].values.reshape(count, 2, 2) for name in mine)
        unsure = [
            known.status.attrs["flag_meanings"].split().index(word) for word in ("change_point", "rigid")
        ]
        sure = ~np.isin(known.status.values, unsure)
        same = agree(*(known[name].values[:, None] for name in theirs), ours, bound)[sure]
        assert same.all(), np.argwhere(~same)[:3]


MANY = ("F_x", "F_y", "angle_GF", "transmission_angle_F", "omega_GF", "F_speed", "alpha_PF")


@pytest.mark.parametrize(
    ("count", "seed", "names", "arc"),
    [
        (60, 2, ("F_x", "B_y", "omega_GF"), None),
        (60, 3, ("F_y",), (0.5, 2.5)),
        *(
            pytest.param(1000, seed, MANY, arc, marks=pytest.mark.stress)
            for first, arc in ((11, None), (10, (1.0, 5.0)))
            for seed in range(first, 20, 2)
        ),
    ],
)
def test_no_sample_of_a_six_bar_is_beyond_its_extremes(count, seed, names, arc):
    """And there are none where nothing closes."""
    designs, (low, high) = six_bars(count, seed), arc or (0.0, 2.0 * np.pi)
    ends = {} if arc is None else {"arc_start": low, "arc_end": high}
    wanted = [f"{name}_{how}" for name in names for how in ("max", "min")]
    maps = fl.sweep(SIX_BAR, designs | ends | {"omega": 10.0}, wanted, branch=(1, 2, 3, 4))
    positions = np.linspace(low, high, 2001)
    given = {name: of[:, None, None] for name, of in designs.items()}
    branches = np.arange(1, 5)[:, None]
    with np.errstate(all="ignore"):
        values = fl.evaluate(
            SIX_BAR, list({*names, "F_x"}), branch=branches, theta=positions, omega=10.0, **given
        )
    closes = np.isfinite(values["F_x"])
    for name in names:
        inside = np.where(closes, values[name], np.nan)
        most, least = (maps[f"{name}_{how}"].values for how in ("max", "min"))
        # rounding of the samples, some of which are next to limits, and of an arc's end
        slack = 1e-9 * (1.0 + sum(np.where(np.isfinite(of), abs(of), 0.0) for of in (most, least)))
        with np.errstate(invalid="ignore"):
            assert not (inside > (most + slack)[..., None]).any(), name
            assert not (inside < (least - slack)[..., None]).any(), name
            turning = closes.all(axis=-1)
            span = most - least
            # of a place a sample is within 1e-2 of what it spans of an extreme; rates have sharper peaks
            near = abs(np.max(values[name], axis=-1) - most) <= 1e-2 * span
        assert near[turning & np.isfinite(span)].all() or not name.endswith(("_x", "_y")), name
        assert np.isnan(most).sum() <= (~closes.any(axis=-1)).sum()


def last_quantities(mechanism):
    """Return places, speeds and rates that have a value where all dyads close, and there alone."""
    known = catalogue(mechanism)
    given = {*known.inputs, *known.tables, known.position.name, "branch"}
    ends = ("_x", "_y", "_speed", "_rate")
    names = [
        one.name for one in fl.quantities(mechanism) if one.name.endswith(ends) and known.varies(one.name)
    ]
    gaps = set(known.graded.gaps or ())
    return [
        one
        for one in names
        if gaps <= {each for step in known.dependencies([one], given) for each in step.names}
    ]


@pytest.mark.stress
@pytest.mark.parametrize("kind", EACH)
def test_no_sample_of_any_kind_of_dyad_is_beyond_its_extremes(kind):
    declared, design, branches = KINDS[kind]
    drive = {} if "slider" in declared else CRANK
    mechanism, rng = fl.linkage("any", **drive, **declared), np.random.default_rng(len(kind))
    designs = {name: value * rng.uniform(0.5, 1.6, 100_000) for name, value in design.items()} | {
        "omega": 2.0
    }
    names = last_quantities(mechanism)
    assert names
    wanted, every = (
        [f"{name}_{how}" for name in names for how in ("max", "min")],
        tuple(range(1, branches + 1)),
    )
    maps = fl.sweep(mechanism, designs, wanted, branch=every)
    samples = fl.sweep(mechanism, designs, wanted, branch=every, positions=720, extrema="sampled")
    for name in names:
        most, least = (maps[f"{name}_{how}"].values for how in ("max", "min"))
        above, below = (samples[f"{name}_{how}"].values for how in ("max", "min"))
        slack = 1e-9 * (1.0 + sum(np.where(np.isfinite(of), abs(of), 0.0) for of in (most, least)))
        with np.errstate(invalid="ignore"):
            beyond = (above > most + slack) | (below < least - slack)
        missed = np.isnan(most) & np.isfinite(above)
        assert not (beyond | missed).any(), (name, np.argwhere(beyond | missed)[:5])


def test_ranges_and_what_limits_them_are_verified(tmp_path):
    names = ["theta_low", "theta_high", "theta_low_by", "theta_high_by"]
    names += ["F_x_max", "F_x_extrema", "omega_GF_min"]
    maps = fl.sweep(
        SIX_BAR,
        six_bars(40, 4) | {"omega": 3.0},
        names,
        branch=(1, 2, 3, 4),
        to=tmp_path / "maps.h5",
        progress=False,
        verify=24,
    )
    assert maps.attrs["verify_mismatches"] == 0
    assert maps.theta_low.error_max_relative < 1e-12
    assert maps.F_x_max.independent_max_difference < 1e-40
    assert {*np.unique(maps.theta_low_by)} == {0, 1, 2}


def test_kernels_of_extremes_need_no_other_compiler_and_have_gradients():
    # numba, which compiles what the translator refuses, takes half a minute for one
    wanted = ["F_x_max", "d_F_x_max_d_a1", "F_x_max_error", "F_x_extrema", "theta_low", "theta_low_by"]
    for kernel in resolve(SIX_BAR, TURNING | {"omega": 1.0}, wanted, branch=3).kernels:
        assert llvm_text(kernel.source)
    given = {name: value for name, value in TURNING.items() if name not in ("a1", "a5")}
    number = fl.function(SIX_BAR, ["a1", "a5"], ["F_x_max"], branch=3, omega=1.0, **given)
    start, step = np.array([0.1, 0.3]), 1e-6
    slope = [(number(start + step * e) - number(start - step * e))[0] / (2 * step) for e in np.eye(2)]
    # differences are off by the square of their step, and by a rounding over it
    assert np.allclose(number.gradient(start)[0], slope, rtol=0, atol=1e-8)


def test_derivatives_at_limits_follow_these():
    designs = {
        name: of[200:] for name, of in four_bars(400, 4).items()
    }  # without those next to change points
    by = ("a1", "a2", "a3", "a4", "P_u")
    wanted = [f"d_P_{axis}_{how}_d_{of}" for axis in "xy" for how in ("max", "min") for of in by]
    known = fl.sweep("planar_4r", designs, [*wanted, "P_y_max_gradient_status"], branch=(1, 2))
    found = fl.sweep(FOUR_BAR, designs, wanted, branch=(1, 2))
    at_limits = known.P_y_max_gradient_status.fastlink.status_is("at a limit of motion that moves")
    assert int(at_limits.sum()) > 20
    for name in wanted:
        a, b = known[name].values, found[name].values
        moves = np.isfinite(a) & (known.status.values != 0)[:, None]
        # a place next to a limit, where quantities change with its root, loses half its digits: 2^-26 at most
        assert (abs(a - b) <= 2.0**-26 * (1.0 + abs(a)))[moves].all(), name


def test_derivatives_where_the_second_dyad_limits():
    at = TURNING | {"a1": 0.3, "omega": 1.0}
    names = [f"{name}_{how}" for name in ("F_x", "angle_AB") for how in ("max", "min")]
    of = ["a1", "a3", "G_y", "a5"]
    found = fl.sweep(SIX_BAR, at, [f"d_{name}_d_{by}" for name in names for by in of], branch=3)
    for by in of:
        ends = [fl.sweep(SIX_BAR, at | {by: at[by] + step}, names, branch=3) for step in (-1e-6, 1e-6)]
        for name in names:
            slope = float(ends[1][name] - ends[0][name]) / 2e-6
            # differences are off by the square of their step, and by a rounding over it
            assert abs(float(found[f"d_{name}_d_{by}"]) - slope) < 1e-8 * (1.0 + abs(slope)), (name, by)

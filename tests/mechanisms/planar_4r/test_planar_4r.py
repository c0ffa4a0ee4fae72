"""The planar 4R: both solvers, the mirror image of the motion, and loads of nothing."""

import numpy as np
import pytest
from tests.support.configurations import (
    CURVE,
    LENGTHS,
    LOADS,
    PLANAR,
    all_loads,
    draw,
    masses_and_points,
    random_lengths,
    under_loads,
)
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.codegen.kernel import kernel_of
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.plan.programs import make_program
from fastlink.plan.request import selected_variants

FORCES = ("F41", "F21", "F32", "F43")
REACTIONS = [f"{force}_{axis}" for force in FORCES for axis in "xy"] + ["T41"]
MOMENTS = ["shaking_moment", "shaking_moment_at", "shaking_moment_printed"]
SHAKING = ["shaking_force_x", "shaking_force_y", *MOMENTS]


def test_dense_and_eliminated_agree_under_all_loads():
    rng, n = np.random.default_rng(9), 300
    inputs = dict(zip(LENGTHS, random_lengths(rng, n), strict=True)) | masses_and_points(rng, n)
    inputs |= all_loads(rng, n) | {"theta1": rng.uniform(-np.pi, np.pi, n)}
    names = [*REACTIONS, *SHAKING]
    eliminated = fl.evaluate("planar_4r", [*names, "transmission_angle"], **inputs)
    dense = fl.evaluate("planar_4r", names, solver="dense", **inputs)
    closes = np.isfinite(eliminated["T41"])
    assert closes.sum() > 60
    largest = np.max([np.abs(eliminated[name]) for name in REACTIONS], axis=0)
    arm = 1 + sum(np.abs(inputs[name]) for name in (*LENGTHS, "M_x", "M_y"))
    # Both are bounded by cond(9x9), about 10/sin(mu), times roundings of the largest unknown.
    allowed = 32 * UNIT_ROUNDING * (10 / np.sin(eliminated["transmission_angle"])) * largest * arm
    for name in names:
        assert np.all(np.abs(eliminated[name] - dense[name])[closes] <= allowed[closes]), name


EVERY = [
    name
    for name, fact in PLANAR.public.items()
    if not fact.flags and name != "circuit" and "residual" not in name
]
MIRRORED = ("G1_v", "G2_v", "G3_v", "P_v", "omega1", "alpha1", "gravity_y", "FP_y", "T_load", "M_y")
MIRRORED += ("counterweight1_direction", "counterweight3_direction", "theta1")
TANGENTS = [f"v{i}{of}" for i in (1, 2, 3, 4) for of in ("", "_dot", "_ddot")]
#: What a reflection in the ground line changes the sign of, besides all angles, rates and ordinates.
ODD = ("T41", *MOMENTS, *(f"inertia_moment{i}" for i in (1, 2, 3)), *TANGENTS)


def test_the_mirror_in_the_ground_line_exchanges_the_branches_bit_by_bit():
    """Every operation is odd or even in what changes sign, and rounding is symmetric."""
    for seed in range(20):
        one = under_loads(200 + seed, LOADS)
        other = {name: -value if name in MIRRORED else value for name, value in one.items()}
        got = fl.evaluate("planar_4r", EVERY, **one)
        mirrored = fl.evaluate("planar_4r", EVERY, **other | {"branch": 3 - one["branch"]})
        for name in filter(PLANAR.varies, EVERY):
            units = PLANAR.facts[name].units
            odd = (
                name.endswith("y") or name in ODD or (units.startswith("rad") and "transmission" not in name)
            )
            assert mirrored[name] == (-got[name] if odd else got[name]), name


@pytest.mark.parametrize("load", LOADS)
def test_a_load_of_nothing_changes_nothing_but_roundings_and_a_load_not_given_is_not_computed(load):
    rng = np.random.default_rng(8)
    inputs = dict(zip(LENGTHS, random_lengths(rng, 1), strict=True)) | masses_and_points(rng, 1)
    inputs = {name: float(value[0]) for name, value in inputs.items()}
    names = [*REACTIONS, *SHAKING, "alpha4", "jerk4"]
    nothing = dict.fromkeys(PLANAR.variant_inputs[load], 0.0)
    chosen = selected_variants(PLANAR, None, "eliminated", nothing)
    assert chosen == (load,)
    bare = kernel_of(make_program(PLANAR, names, given=tuple(inputs)))
    assert not any(name in bare.text for other in LOADS for name in PLANAR.variant_inputs[other])
    loaded = kernel_of(make_program(PLANAR, names, given=(*inputs, *nothing), variants=chosen))
    assert any(name in loaded.text for name in nothing)
    others = set(LOADS) - {load}
    assert not any(name in loaded.text for other in others for name in PLANAR.variant_inputs[other])
    for theta in rng.uniform(-np.pi, np.pi, 5):
        without = fl.evaluate("planar_4r", names, theta1=theta, **inputs)
        with_nothing = fl.evaluate("planar_4r", names, theta1=theta, **inputs, **nothing)
        # x + 0 and x - 0 are x; only the mass centre that r34 starts from takes another way with counterweights.
        alike = [name for name in names if "printed" not in name]
        assert all(np.array_equal(without[n], with_nothing[n], equal_nan=True) for n in alike)
        a, b = without["shaking_moment_printed"], with_nothing["shaking_moment_printed"]
        # Ten roundings of each of its terms, which are not larger than this.
        arms = sum(abs(inputs[name]) for name in (*LENGTHS, "G3_u", "G3_v"))
        size = sum(abs(without[name]) for name in REACTIONS) * arms
        assert np.isnan(a) or abs(a - b) <= 10 * UNIT_ROUNDING * size


# == Straightness and roundness of the path of a point, over given positions or the whole turn ===============

HOEKEN = {"a1": 1.0, "a2": 2.5, "a3": 2.5, "a4": 2.0, "P_u": 5.0, "P_v": 0.0}
ARC = np.linspace(2.1, 4.2, 72)


def test_paths_that_are_nearly_straight_or_round_have_the_narrowest_strip_and_ring():
    """The reference is the convex hull. The sums of each point's distance have ten roundings of the path's size."""
    columns = draw(PLANAR.inputs, np.random.default_rng(5), 400)
    columns = {name: columns[name] for name in CURVE}
    columns["a1"] *= np.where(np.arange(400) % 3, 0.2, 1.0)
    maps = sweep_4r(fl.table(columns), ["P_straightness", "P_roundness"], theta1=ARC)
    wide = {name: values[:, None, None] for name, values in columns.items()}
    at = fl.evaluate("planar_4r", ["P_x", "P_y"], theta1=ARC, branch=np.array([[1], [2]]), **wide)
    points = np.stack([at["P_x"], at["P_y"]], axis=-1)  # (design, branch, position, 2)
    whole = np.isfinite(points).all(axis=(-1, -2))
    exact = np.where(whole, fl.planar.straightness(points[..., 0], points[..., 1]), np.nan)
    found, size = maps.P_straightness.values, np.ptp(points, axis=-2).max(axis=-1)
    assert (np.isnan(found) == ~whole).all()  # a path of which points are missing has none
    straight = whole & (exact < 0.02 * size)
    assert straight.sum() > 10
    assert (abs(found - exact)[straight] <= 10 * 2.0**-52 * size[straight]).all()
    # others are not less, and hardly more: another edge of the hull may be a little better
    assert (found[whole] >= exact[whole] - 10 * 2.0**-52 * size[whole]).all()
    assert np.median(found[whole] / exact[whole]) < 1.0 + 1e-12
    assert (found[whole] <= 1.05 * exact[whole]).all()
    # A coupler point in A runs on the circle of the crank; others are off the circle of the same fit by
    # NumPy.
    crank = sweep_4r(fl.grid(**HOEKEN | {"P_u": 0.0}), ["P_roundness"], theta1=72)
    assert (crank.P_roundness < 20 * 2.0**-52).all()
    for design, branch in np.argwhere(np.isfinite(points).all(axis=(-1, -2)))[::40].tolist():
        own = points[design, branch] - points[design, branch].mean(axis=0)
        centre, *_ = np.linalg.lstsq(np.c_[own, np.ones(72)], (own * own).sum(axis=1), rcond=None)
        radii = np.hypot(*(own - centre[:2] / 2.0).T)
        expected = abs(radii - radii.mean()).max()
        # the centre is the solution of two equations: its condition is that of the fit, at most 1e6 here
        assert abs(float(maps.P_roundness[design, branch]) - expected) < 1e6 * 2.0**-52 * radii.max()


def test_hoekens_family_is_found():
    space = fl.sobol(
        20_000, seed=1, a1=(0.2, 1.0), a2=(0.5, 3.0), a3=(0.5, 3.0), a4=1.0, P_u=(0.0, 6.0), P_v=0.0
    )
    asked = {"theta1": ARC, "where": {"status": "rotates_fully"}, "branch": [1, 2], "top": 1}
    found = fl.search("planar_4r", space, ["P_roundness"], minimise="P_straightness", **asked)
    hoeken = fl.sweep("planar_4r", fl.grid(**HOEKEN), ["P_straightness"], theta1=ARC, branch=2)
    share = float(hoeken.P_straightness.item()) / HOEKEN["a4"]
    assert 0.0 < found.P_straightness.item() < 2.0 * share
    assert (
        found.P_straightness.attrs["long_name"] == "Path of P: greatest distance from the best straight line"
    )
    assert found.P_straightness.attrs["units"] == "m"


def test_what_has_no_path_is_refused():
    for name, key, remedy in (
        ("Q_straightness", "'Q'", "P_straightness"),
        ("omega4_straightness", "'omega4'", "P_straightness"),
        ("d_P_straightness_d_a1", "no derivative", "P_straightness"),
        ("P_straightness_error", "error bound", "P_straightness"),
    ):
        with refused(key, remedy):
            sweep_4r(fl.grid(**HOEKEN), [name])
    assert "P_straightness" in [row.name for row in fl.quantities("planar_4r", find="straight line of P")]


# == Forces at the folded position of a change point: infinite or not, however small the factor of the pole is


def change_points(seed, n):
    """Return change points of whole lengths, a1 + a2 = a3 + a4, with masses and mass centres of any size."""
    rng = np.random.default_rng(seed)
    lengths = rng.integers(1, 9, (4, n)).astype(float)
    lengths[1] = lengths[2] + lengths[3]  # a1 + a2 = (a3 + a1) + a4
    lengths[2] += lengths[0]
    design = dict(zip(("a1", "a2", "a3", "a4"), lengths, strict=True)) | {
        "omega1": 10.0 ** rng.uniform(-6, 6, n)
    }
    for k in (1, 2, 3):
        design |= {f"m{k}": 10.0 ** rng.uniform(-12, 2, n), f"I{k}": 10.0 ** rng.uniform(-9, 3, n)}
        design[f"G{k}_u"] = lengths[k - 1] * rng.uniform(-2.0, 2.0, n)
        across = rng.choice([0.0, 1.0], n) * 10.0 ** rng.uniform(-6, 6, n)
        design[f"G{k}_v"] = np.where(rng.random(n) < 0.7, across, 0.0)
    return design


def test_forces_are_infinite_where_they_have_a_pole():
    n = 500
    design = change_points(1, n)
    asked = [f"{name}_{end}" for name in FORCES for end in ("max", "max_error")]
    maps = sweep_4r(fl.table(design), asked)
    infinite = 0
    for branch in (1.0, 2.0):
        near, nearer = (
            fl.evaluate("planar_4r", FORCES, theta1=np.full(n, theta), branch=branch, **design)
            for theta in (1e-50, 1e-55)
        )
        for name in FORCES:
            # a pole grows by 1e5 from there to there, a sum of other powers not at all
            grows = nearer[name] > 1e4 * near[name]
            most = maps[f"{name}_max"].sel(branch=branch).values
            np.testing.assert_array_equal(np.isinf(most), grows)
            assert np.all(np.isinf(maps[f"{name}_max_error"].sel(branch=branch).values[grows]))
            infinite += grows.sum()
    of = 2 * len(FORCES) * n
    assert 0.2 * of < infinite < 0.8 * of

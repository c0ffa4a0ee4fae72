"""The planar 4R: both solvers, the mirror image of the motion, and loads of nothing.

Its formulas are held by the loops (tests/precision/test_loops.py).
"""

import numpy as np
import pytest
from tests.support.configurations import (
    LENGTHS,
    LOADS,
    PLANAR,
    all_loads,
    masses_and_points,
    random_lengths,
    under_loads,
)

import fastlink as fl
from fastlink.codegen.kernel import kernel_of
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.plan.programs import make_program
from fastlink.plan.request import selected_variants

FORCES = ("F41", "F21", "F32", "F43")
REACTIONS = [f"{force}_{axis}" for force in FORCES for axis in "xy"] + ["T41"]
MOMENTS = ["shaking_moment", "shaking_moment_at", "shaking_moment_printed"]
SHAKING = ["shaking_force_x", "shaking_force_y", *MOMENTS]


# -- digits -------------------------------------------------------------------------------------------------------


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


# -- mirror, reversal, loads --------------------------------------------------------------------------------------

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

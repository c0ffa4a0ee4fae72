"""The second reference: it agrees with the facts everywhere, and a wrong formula of theirs does not escape it."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from tests.support.neighbourhoods import DRAWN
from tests.support.precision import in_every_mode
from tests.support.registry import ENTRIES

import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue, inputs_of
from fastlink.plan.request import constants_of, variants_of
from fastlink.precision.errors import unit_of
from fastlink.precision.independent import TOLERANCE, IndependentValues
from fastlink.precision.reference import CONTEXT, HighPrecision

ENTRY = {str(entry): entry for entry in ENTRIES if entry.solver == "eliminated"}
CRANK = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
BARS = fl.round_bar(density=7750.0, radius=0.01)

#: What must have an independent value, by mechanism and input; more may.
CONFIRMED = {
    (
        "planar_4r",
        "theta1",
    ): """A_x A_y B_x B_y P_x P_y theta2 theta4 transmission_angle omega2 omega4 alpha2 alpha4
        jerk2 jerk4 P_vx P_vy P_speed P_ax P_ay curvature F41 F41_x F41_y F21 F21_x F21_y F32 F32_x F32_y F43 F43_x
        F43_y T41 input_power shaking_force shaking_force_x shaking_force_y shaking_moment shaking_moment_at
        shaking_moment_printed theta1_low theta1_high theta4_low theta4_high transmission_angle_least""",
    **{
        ("planar_4r", f"joint_angle_{k}"): " ".join(
            f"joint_angle_{i} joint_omega_{i} joint_alpha_{i} v{i} transmission_angle"
            for i in (1, 2, 3, 4)
            if i != k
        )
        + " A_x A_y B_x B_y"
        for k in (1, 2, 3, 4)
    },
    (
        "minkowski_4r",
        "theta",
    ): """A_x A_y B_x B_y X_x X_y psi phi AB_rapidity AB_orientation CB_orientation zeta
        cosh_zeta half_angle_root dpsi_dtheta d2psi_dtheta2 T1 T2 T3 T4 T5 T7 cosh_theta_min cosh_theta_max
        cosh_psi_min cosh_psi_max theta_escape""",
    ("focal", "phi"): """A_x A_y B_x B_y P_x P_y Q_x Q_y T_x T_y F_x F_y psi sigma omega_angle alpha beta chi
        dpsi_dphi dsigma_dphi psi_rate sigma_rate lambda_ m n p q r s FT T_ratio line_x transmission_angle_F
        X_x X_y Y_x PFQX_x PFQX_radius SFTY_y PSQT_radius M_along_AB N_across_AB S_along_AB F_across_AB
        line_along_AB""",
    ("focal", "sigma"): """A_x A_y B_x B_y P_x P_y Q_x Q_y T_x T_y F_x F_y psi phi omega_angle alpha beta chi
        dpsi_dsigma dphi_dsigma psi_rate phi_rate lambda_ m n p q r s FT transmission_angle_P transmission_angle_Q
        X_x Y_x PFQX_x SFTY_radius PSQT_y M_across_AB N_along_AB S_across_AB F_along_AB""",
    (
        "hart",
        "phi",
    ): """A_x A_y B_x B_y P_x P_y Q_x Q_y F_x F_y PF_mid_x PF_mid_y psi omega_angle dpsi_dphi dF_y_dphi
        line_x F_y_outer F_y_inner stroke p q a b c lambda_ M_along_AB F_across_AB line_along_AB""",
    ("hart", "F_y"): "A_x A_y B_x B_y P_x P_y Q_x Q_y F_x phi psi omega_angle dphi_dF_y dpsi_dF_y line_x",
    (
        "slider_crank",
        "theta",
    ): """A_x A_y slider_position theta2 transmission_angle slider_velocity slider_jerk
        slider_acceleration omega2 alpha2 jerk2 F41 F41_x F41_y F21 F21_x F21_y F32 F32_x F32_y side_force T41
        input_power shaking_force shaking_force_x shaking_force_y shaking_moment stroke outer_dead_centre""",
}


@pytest.mark.parametrize(
    ("mechanism", "drive"), [(name, drive) for name in NAMES for drive in inputs_of(name)]
)
def test_what_has_an_independent_value(mechanism, drive):
    known = catalogue(mechanism, drive)
    names = CONFIRMED[mechanism, drive].split()
    assert set(names) <= set(known.public)
    assert IndependentValues(known, names).names == tuple(names)
    derivative = f"d_{names[0]}_d_{known.position.name}"
    assert IndependentValues(known, [derivative, f"{names[0]}_error", "status"]).names == (derivative,)


def compared(entry, kind, n):
    """Assert that facts and loops agree in n configurations of a family; return how many values were compared."""
    inputs = in_every_mode(entry, entry.drawn(kind, n, n))
    position = entry.catalogue.position.name
    inputs = {position: np.ones_like(next(iter(inputs.values())))} | inputs
    independent = IndependentValues(entry.catalogue, entry.names)
    facts = HighPrecision(
        entry.catalogue, independent.names, inputs, variants_of(entry.catalogue, None, entry.solver, inputs)
    )
    numbers = [name for name in inputs if name not in ("branch", "completion")]
    count = 0
    for i in range(len(inputs[position])):
        at = {name: float(values[i]) for name, values in inputs.items()}
        exact = facts.at(at)
        condition = facts.condition(exact, numbers)
        units = {name: unit_of(exact[name], condition[name], 1.0) for name in independent.names}
        found = independent.differences(at, exact, units)
        assert {name: value for name, value in found.items() if value > TOLERANCE} == {}, at
        count += len(found)
    return count


@pytest.mark.sample(4)
@pytest.mark.parametrize("name", ENTRY)
def test_facts_and_loops_agree_to_fifty_digits(name):
    first, *others = ENTRY[name].families
    assert compared(ENTRY[name], first, 1)
    for kind in others[:1]:
        compared(ENTRY[name], kind, 1)


@pytest.mark.stress
@pytest.mark.parametrize("name", ENTRY)
def test_facts_and_loops_agree_in_many_configurations(name):
    kinds = list(ENTRY[name].families)
    assert sum(compared(ENTRY[name], kind, 40) for kind in kinds) > 1000


def agreed(mechanism, drive, n):
    """Assert that no quantity has a number by the facts alone or by the loops alone; count what closes and not."""
    known = catalogue(mechanism, drive)
    inputs = DRAWN[mechanism, drive](np.random.default_rng(n), n) | {"branch": np.ones(n)}
    variants = known.variants_selected_by(inputs)
    inputs |= {
        name: np.full(n, value) for name, value in constants_of(known, None, variants).items()
    } | inputs
    names = [name for name in CONFIRMED[mechanism, drive].split() if name not in inputs]
    independent = IndependentValues(known, names)
    facts = HighPrecision(known, names, inputs, variants)
    counts = Counter()
    for i in range(n):
        at = {name: float(values[i]) for name, values in inputs.items()}
        exact = facts.at(at)
        found = independent.differences(at, exact, dict.fromkeys(names, 1.0))
        assert [name for name, difference in found.items() if difference == np.inf] == [], at
        counts[any(CONTEXT.isnan(exact[name]) for name in found)] += 1
    return counts


@pytest.mark.sample(3)
@pytest.mark.parametrize(("mechanism", "drive"), DRAWN)
def test_both_references_have_the_same_numbers(mechanism, drive):
    """Most configurations are next to something degenerate.

    Where the loop does not close the end of the driven bar alone has a place, where links are in line rates have no
    number: a map whose references differ there has a mismatch in its file.
    """
    counts = agreed(mechanism, drive, 60)
    assert min(counts[True], counts[False]) > 5


@pytest.mark.stress
@pytest.mark.parametrize(("mechanism", "drive"), DRAWN)
def test_both_references_have_the_same_numbers_in_many_configurations(mechanism, drive):
    counts = agreed(mechanism, drive, 4000)
    assert min(counts[True], counts[False]) > 400


def nearly(right):
    """Return what a formula says that is wrong in the twelfth digit."""
    return right * 1.000000000001


#: A mechanism, a fact on the way, a quantity that it makes wrong, and inputs of a sweep.
WRONG = [
    ("planar_4r", "torque2", "T41", CRANK, {"links": BARS}),
    ("planar_4r", "jerk4", "jerk4", CRANK, {}),
    ("planar_4r", "joint_angle_3", "joint_angle_3", CRANK, {}),
    (
        "slider_crank",
        "slider_acceleration",
        "slider_acceleration",
        {"r": 1.0, "l": 2.5, "e": 0.3, "omega": 2.0},
        {},
    ),
    ("minkowski_4r", "dpsi_dtheta", "dpsi_dtheta", {"a": 0.6, "b": 1.0, "g": 0.7, "h": 0.5}, {}),
    ("focal", "lambda_", "F_x", {"a": 4.0, "b": 5.0, "c": 2.0, "d": 4.0, "s": 1.5, "completion": 1}, {}),
    ("hart", "PF_across", "F_y", {"m": 4.0, "n": 7.0, "d": 6.0, "kappa": 0.5}, {}),
]


#: Those that are tested in each run; every one compiles two kernels.
QUICK = (0, 5)


@pytest.mark.parametrize(
    ("mechanism", "fact", "quantity", "design", "options"),
    [pytest.param(*row, marks=[] if k in QUICK else pytest.mark.stress) for k, row in enumerate(WRONG)],
)
def test_a_wrong_formula_is_a_mismatch_in_the_file(
    monkeypatch, tmp_path, mechanism, fact, quantity, design, options
):
    """Kernels and 50-digit facts share their formulas: only what does not can tell that one is wrong."""
    known = catalogue(mechanism)
    law = known.facts[fact]
    angles = {known.position.name: np.linspace(0.9, 1.1, 5)}

    def swept(name):
        with fl.sweep(
            mechanism, fl.grid(**design), [quantity], **angles, **options, to=tmp_path / name, verify=1
        ) as maps:
            return dict(maps[quantity].attrs), maps.attrs["verify_mismatches"], fl.summary(maps)

    attrs, mismatches, summary = swept("right.h5")
    assert mismatches == 0
    assert attrs["independent_values"] == 1
    assert attrs["independent_max_difference"] < TOLERANCE
    assert "NOT AS" not in summary
    monkeypatch.setitem(known.facts, "right", replace(law, name="right", internal=True))
    monkeypatch.setitem(known.facts, fact, replace(law, function=nearly, depends_on=("right",)))
    attrs, mismatches, summary = swept("wrong.h5")
    assert attrs["verify_mismatches"] == attrs["independent_values"] == 1 <= mismatches
    assert attrs["independent_max_difference"] > 1e-16
    assert "NOT AS WITH 50 DIGITS" in summary

"""The focal mechanism in motion, by either drive: what the loops have no value of, and the paper's special cases."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.focal_configurations import DRIVES, family, random_designs
from tests.support.sweeps import sweep_both

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING


@pytest.mark.parametrize("drive", DRIVES)
def test_every_bar_and_both_ratios_close_in_every_branch_and_F_stays_on_its_circle(drive):
    inputs = family(drive, "random", np.random.default_rng(11), 3000)
    bars = ("m", "n", "p", "q", "r", "S_x", "FT")
    found = inputs | fl.evaluate(
        "focal", [*bars, "B_x", "closure_residual", "F_path_residual"], input=drive, **inputs
    )
    closes = np.all([np.isfinite(found[name]) for name in ("B_x", "F_path_residual", "S_x")], axis=0)
    found = {name: np.asarray(values)[closes] for name, values in found.items()}
    for completion in (1, 2):
        for branch in (1, 2):
            assert ((found["completion"] == completion) & (found["branch"] == branch)).sum() > 30
    # a point is a sum of two bars whose directions are the products of five; each is some roundings off
    assert found["closure_residual"].max() <= 30 * UNIT_ROUNDING
    # F is some roundings of the bars off, and as many more as P is far away: w then is told by small angles
    size = np.max([np.abs(found[name]) for name in (*"abcd", *bars)], axis=0)
    far = size / np.maximum(found["a"], found["d"])
    assert (found["F_path_residual"] <= 30 * UNIT_ROUNDING * size * far).all()


def test_with_rho_minus_1_F_runs_along_lines_perpendicular_to_MN_and_to_AB():
    """Section 7: T is at infinity. Of the other completion lambda is 0: it has no P."""
    design = {"a": 1.2, "b": 0.9, "c": 0.8, "d": 1.1, "rho": -1.0, "completion": 2}
    names = ["F_along_AB", "F_across_AB", "line_along_AB", "line_x", "F_x", "F_path_residual", "lambda_"]
    found = fl.evaluate("focal", names, **design, phi=np.linspace(-3.0, 3.0, 400))
    moves = np.isfinite(found["F_x"])
    assert moves.sum() > 100
    assert np.ptp(found["F_across_AB"][moves]) > 0.5
    # sums of three lengths of at most 4, each some roundings off
    assert_allclose(found["F_along_AB"][moves], found["line_along_AB"][moves], rtol=0, atol=2e-14)
    assert_allclose(found["F_x"][moves], found["line_x"][moves], rtol=0, atol=4e-15)
    assert np.nanmax(found["F_path_residual"]) <= 30 * UNIT_ROUNDING
    # AB held fixed, MN moves: (7.5) with c and d exchanged, and lambda/(lambda - 1) for lambda
    other = float(found["lambda_"][0]) / (float(found["lambda_"][0]) - 1.0)
    place = 0.4 + (1.2**2 - 0.9**2) / (2.0 * 0.8 * other)
    assert abs(found["line_along_AB"][0] - place) <= 1e-15


def test_the_graphic_solution_of_figure_4():
    """Section 6: the angles are right ones, ST is a diameter of the circle SPTQ, and 2 r is h1 - h2."""
    names = ["omega_angle", "chi", "PSQT_radius", "T_x", "T_y", "S_x", "r", "h1", "h2", "F_x"]
    for a, c, d in ((5.0, 2.0, 4.0), (3.0, 1.0, 2.5), (2.0, 0.7, 1.9)):
        given = {"a": a, "b": a, "c": c, "d": d, "rho": 1.0, "completion": 1}
        found = fl.evaluate("focal", names, **given, phi=np.arccos(0.5 * (d - c) / a), branch=2)
        at = {name: float(value) for name, value in found.items()}
        # angles that phi determines to some ten roundings
        assert abs(abs(at["omega_angle"]) - 0.5 * np.pi) <= 30 * UNIT_ROUNDING
        assert abs(abs(at["chi"]) - 0.5 * np.pi) <= 100 * UNIT_ROUNDING
        assert abs(at["F_x"] - 0.5 * d) <= 10 * UNIT_ROUNDING * d
        diameter = np.hypot(at["T_x"] - at["S_x"], at["T_y"])
        assert abs(2.0 * at["PSQT_radius"] - diameter) <= 30 * UNIT_ROUNDING * a
        assert abs(2.0 * at["r"] - (at["h1"] - at["h2"])) <= 10 * UNIT_ROUNDING * a


def test_the_crank_turns_without_a_jump_of_branch():
    """Whole turns: from sample to sample the rockers move as their rates say, and come back."""
    designs = random_designs(np.random.default_rng(6), 4000)
    kind = fl.evaluate("focal", ["crank_type"], phi=1.0, **designs)["crank_type"]
    turning = {name: values[kind == 0][:100, None] for name, values in designs.items()}
    assert turning["a"].shape == (100, 1)
    sigma = np.linspace(-np.pi, np.pi, 1441)
    names = ["phi", "psi", "phi_error", "psi_error", "dphi_dsigma", "dpsi_dsigma", "omega_angle"]
    names.append("closure_residual")
    found = fl.evaluate("focal", names, input="sigma", sigma=sigma, **turning)
    step = sigma[1] - sigma[0]
    assert np.isfinite(found["closure_residual"]).all()
    assert (np.diff(np.sign(found["omega_angle"]), axis=1) == 0.0).all()
    for name in ("phi", "psi"):
        rate = found[f"d{name}_dsigma"]
        moved = np.angle(np.exp(1j * np.diff(found[name], axis=1)))
        bends = np.abs(np.diff(rate, axis=1))
        around = bends + np.roll(bends, 1, axis=1) + np.roll(bends, -1, axis=1)
        # the rate between two samples is within what it changes by from those before to those after
        off = np.abs(moved - 0.5 * step * (rate[:, 1:] + rate[:, :-1]))
        lost = found[f"{name}_error"]
        # and angles have their errors, those within (-pi, pi] a rounding of pi more
        assert (off <= step * around + lost[:, 1:] + lost[:, :-1] + 8 * np.pi * UNIT_ROUNDING).all()
        # pi and -pi are two roundings apart from being a whole turn
        first, last = found[name][:, 0], found[name][:, -1]
        allowed = lost[:, 0] + lost[:, -1] + (np.abs(rate[:, 0]) + 4.0) * 2 * np.pi * UNIT_ROUNDING
        assert (np.abs(np.exp(1j * first) - np.exp(1j * last)) <= allowed).all()


def test_extremes_of_what_passes_infinity_are_those_of_the_given_positions():
    """MA and NB of this four-bar are parallel somewhere: no smooth curve leads from one extreme of X to the other."""
    space = fl.grid(a=1.2, b=0.9, c=2.0, d=2.3, rho=0.7, completion=1)
    maps = sweep_both("focal", space, ["X_x", "X_x_max", "Y_x", "Y_x_min"])
    assert_array_equal(maps.X_x_max, maps.X_x.max("phi"))
    assert_array_equal(maps.Y_x_min, maps.Y_x.min("phi"))

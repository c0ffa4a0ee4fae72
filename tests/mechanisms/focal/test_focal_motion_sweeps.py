"""Sweeps of the focal mechanism by either drive: refined extremes, the bits of its kernels, what messages tell."""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.focal_configurations import DRIVES, random_designs

import fastlink as fl
from fastlink.errors import InputError
from fastlink.numerics.compensated import UNIT_ROUNDING


def test_the_coupler_is_farthest_where_it_is_parallel():
    """Chebyshev's linkage: T is at the distance h1 = 2 sqrt(6) of MN (6.4) there; at F the angle is least."""
    one = fl.grid(a=5.0, b=5.0, c=2.0, d=4.0, rho=1.0, omega=1.0, completion=[1.0])
    found = fl.sweep("focal", one, ["T_y_max", "transmission_angle_F_min"], branch=2)
    # a value whose slope is zero: the roundings of T alone
    assert found["T_y_max"].item() == pytest.approx(2.0 * np.sqrt(6.0), rel=10 * UNIT_ROUNDING)
    # AB the other way round is parallel there: of the triangle with the sides 5, 5 and 4 + 2
    assert found["transmission_angle_F_min"].item() == pytest.approx(
        np.pi - 2.0 * np.arcsin(3.0 / 5.0), rel=100 * UNIT_ROUNDING
    )


@pytest.mark.parametrize("drive", DRIVES)
def test_refined_extremes_are_beyond_sampled_ones_and_near_where_it_turns(drive):
    designs = random_designs(np.random.default_rng(9), 400)
    del designs["branch"]
    space = fl.table(designs)
    refined = fl.sweep("focal", space, ["T_y_max"], input=drive)
    names = ["T_y", "T_y_error", "crank_type", "grashof_class"]
    sampled = fl.sweep("focal", space, names, input=drive, **{drive: 1800})
    assert refined["T_y_max"].attrs["extrema"] == "refined"
    # over a whole turn: cranks SF, and rockers MA that turn (crank_rocker, double_crank)
    turns = sampled["crank_type"].values == 0 if drive == "sigma" else sampled["grashof_class"].values <= 1
    assert turns.sum() > 20
    curve, errors = sampled["T_y"].values, sampled["T_y_error"].values
    reached = np.any(np.isfinite(curve), axis=-1)
    greatest = np.max(curve, axis=-1, where=np.isfinite(curve), initial=-np.inf)
    lost = np.max(errors, axis=-1, where=np.isfinite(curve), initial=0.0)
    beyond = refined["T_y_max"].values - greatest
    np.testing.assert_array_equal(reached, ~np.isnan(refined["T_y_max"].values))
    # Both are right to the bound of their errors, and what is between samples can only be more.
    assert (beyond >= -2.0 * lost)[reached & np.isfinite(beyond)].all()
    # Half a step off its top a curve is lower by an eighth of its second difference, which changes by less than a half
    # of the greatest from sample to sample.
    bends = np.abs(np.roll(curve, 1, -1) - 2.0 * curve + np.roll(curve, -1, -1)).max(axis=-1)
    within = turns[:, None] & np.isfinite(bends)
    assert within.sum() > 40
    assert (beyond <= 0.25 * bends + 2.0 * lost)[within].all()


@pytest.mark.parametrize("drive", DRIVES)
def test_kernels_have_the_bits_of_the_facts(drive):
    designs = random_designs(np.random.default_rng(10), 50)
    del designs["branch"]
    names = ["F_x", "chi", "closure_residual", "dsigma_dphi" if drive == "phi" else "dpsi_dsigma"]
    angles = np.linspace(-3.0, 3.0, 13)
    found = fl.sweep("focal", fl.table(designs), names, input=drive, **{drive: angles})
    for branch in (1, 2):
        columns = {name: values[:, None] for name, values in designs.items()}
        same = fl.evaluate("focal", names, input=drive, branch=branch, **columns, **{drive: angles})
        for name in names:
            values = found[name].values
            values = values[:, branch - 1] if values.ndim == 3 else values
            np.testing.assert_array_equal(values, np.broadcast_to(same[name], values.shape))


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        (
            "sigma",
            {"input": "sigma"},
            "quantity 'sigma' is the input position, a coordinate of the result; leave it out",
        ),
        (
            "dsigma_dphi",
            {"input": "sigma"},
            "defined for input 'phi' alone; .* ask for such as 'dphi_dsigma'",
        ),
        ("F_x", {"input": "psi"}, "input: 'psi' is unknown to focal"),
        ("F_x", {"sigma": 36}, "sigma: the input is phi; write its positions as phi"),
        ("F_x", {"branch": 3}, "branch: 3 is not an assembly mode of focal; write some of 1, 2"),
    ],
)
def test_what_the_other_drive_has_is_told(name, options, message):
    one = fl.grid(a=5.0, b=5.0, c=2.0, d=4.0, rho=1.0, omega=1.0)
    with pytest.raises(InputError, match=message):
        fl.sweep("focal", one, [name], **options)

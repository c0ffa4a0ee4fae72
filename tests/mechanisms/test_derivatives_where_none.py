"""A derivative is no number where its quantity is none, though its own text may not depend on that."""

from __future__ import annotations

import numpy as np
import pytest
from tests.mechanisms.test_degenerate_bounds import bounded, slopes
from tests.support.degenerate import FAMILIES

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.plan.request import variants_of

#: Inputs that stand in one term alone of some quantities, by mechanism.
ALONE = {
    "planar_4r": ("m1", "FP_y", "counterweight1_mass", "a4"),
    "slider_crank": ("m1", "l"),
    "minkowski_4r": ("x", "h"),
    "focal": ("rho",),
    "hart": ("kappa",),
}
CASES = [(*family, by) for family in FAMILIES for by in ALONE[family[0]]]


def finite_where_none(mechanism, drive, about, by, count):
    """Return the derivatives that are finite somewhere where the quantity is not, and how many were looked at."""
    of, rng = catalogue(mechanism, drive), np.random.default_rng(7)
    given = FAMILIES[mechanism, drive, about](rng, count)
    if by not in given:
        return [], 0
    given.setdefault("branch", rng.integers(1, 3, count).astype(float))
    names = bounded(of, given)
    found = slopes(of, names, by, variants_of(of, None, "eliminated", given))
    quantity = {slope: slope[len("d_") : slope.rindex("_d_")] for slope in found}
    values = fl.evaluate(mechanism, [*found, *set(quantity.values())], input=drive, **given)
    none = {slope: ~np.isfinite(values[quantity[slope]]) for slope in found}
    wrong = [slope for slope in found if np.any(np.isfinite(values[slope]) & none[slope])]
    return wrong, sum(np.count_nonzero(some) for some in none.values())


def test_none_is_finite_where_its_quantity_is_none():
    looked_at = 0
    for mechanism, drive, about, by in CASES:
        if drive.startswith("joint_angle"):
            continue
        wrong, some = finite_where_none(mechanism, drive, about, by, 48)
        assert wrong == [], (mechanism, drive, about, by)
        looked_at += some
    assert looked_at > 1000


@pytest.mark.parametrize(("mechanism", "drive"), [family[:2] for family in FAMILIES if not family[2]])
def test_none_by_the_position_is_finite_where_its_quantity_is_none(mechanism, drive):
    """At exactly 0, where a sine is exactly 0, and with the crank's pivot at infinity, too."""
    of, rng = catalogue(mechanism, drive), np.random.default_rng(7)
    given = FAMILIES[mechanism, drive, ""](rng, 120)
    given[drive] = np.where(np.arange(given[drive].size) < 12, 0.0, given[drive])
    if "rho" in given:
        given["rho"] = np.where(np.arange(given["rho"].size) < 40, -1.0, given["rho"])
    given.setdefault("branch", rng.integers(1, 3, given[drive].size).astype(float))
    found = slopes(of, bounded(of, given), drive, variants_of(of, None, "eliminated", given))
    quantity = {slope: slope[len("d_") : slope.rindex("_d_")] for slope in found}
    values = fl.evaluate(mechanism, [*found, *set(quantity.values())], input=drive, **given)
    wrong = [s for s in found if np.any(np.isfinite(values[s]) & ~np.isfinite(values[quantity[s]]))]
    assert wrong == []
    assert len(found) > 10


@pytest.mark.stress
@pytest.mark.parametrize("case", CASES, ids="-".join)
def test_none_of_many_is_finite_where_its_quantity_is_none(case):
    assert finite_where_none(*case, 3000)[0] == []


@pytest.mark.parametrize("theta1", [2.0, 0.2])
def test_a_kernel_says_so_too(theta1):
    """A crank of three times the length of the others assembles near 0 alone."""
    lengths = {"a1": 3.0, "a2": 1.0, "a3": 1.0, "a4": 2.0, "omega1": 1.0}
    links = fl.round_bar(density=1000.0, radius=0.01)
    names = ["F41_y", "d_F41_y_d_FP_y", "d_shaking_force_y_d_FP_y", "d_shaking_force_y_d_FP_y_error"]
    loads = {"FP_x": 0.0, "FP_y": 1.0, "P_u": 0.5, "P_v": 0.1}
    maps = fl.sweep("planar_4r", fl.grid(**lengths, **loads), names, links=links, theta1=[theta1], branch=1)
    assert {name: bool(np.isfinite(maps[name]).all()) for name in names} == dict.fromkeys(
        names, theta1 == 0.2
    )

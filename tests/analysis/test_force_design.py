"""What designers do with forces: balancing, flywheels, and Table 3 of Hayes et al. as it follows from Table 1."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.configurations import LENGTHS, PLANAR, masses_and_points, random_lengths
from tests.support.refusals import refused
from tests.support.registry import MULTIPLE
from tests.support.sweeps import BARS, CRANK, TURNING, sweep_4r, sweep_both

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.plan.request import selected_variants
from fastlink.precision.reference import HighPrecision


def test_force_balance_leaves_no_shaking_force():
    rng = np.random.default_rng(31)
    n = 40
    designs = dict(zip(LENGTHS, random_lengths(rng, n), strict=True)) | masses_and_points(rng, n)
    weights = fl.planar.force_balance(designs, radius1=0.3, mass3=rng.uniform(0.2, 2.0, n))
    theta = rng.uniform(-np.pi, np.pi, n)
    names = ["shaking_force_x", "shaking_force_y"]
    tested = 0
    for i in range(n):
        one = {name: value[i] for name, value in (designs | weights).items()}
        one |= {"theta1": theta[i], "branch": 1 + i % 2}
        got = fl.evaluate("planar_4r", [*names, "shaking_force"], **one)
        if np.isnan(got["shaking_force"]):
            continue
        facts = HighPrecision(PLANAR, names, one, selected_variants(PLANAR, None, "eliminated", one))
        sums = facts.condition(facts.at(one), [name for name in one if name != "branch"])
        for name in names:
            # The exact force is zero but for the roundings of the weights, up to 8 of each term that they balance;
            # each term stands in the sum as that of a mass. The facts add their MULTIPLE.
            assert abs(got[name]) <= (MULTIPLE + 8) * UNIT_ROUNDING * sums[name]
        bare = {name: value for name, value in one.items() if name not in weights}
        assert (
            fl.evaluate("planar_4r", ["shaking_force"], **bare)["shaking_force"] > 1e8 * got["shaking_force"]
        )
        tested += 1
    assert tested > 10


def test_the_free_radius_or_mass_is_kept_and_the_link_itself_is_the_default_radius():
    by_default = fl.planar.force_balance(CRANK, links=BARS)
    assert (by_default["counterweight1_radius"], by_default["counterweight3_radius"]) == (0.4, 0.8)
    # Mass centres at mid-length: products m1 a1/2 + m2 a1/2 and m3 a3/2 + m2 a3/2, opposite to the links.
    m1, m2, m3 = (7750.0 * np.pi * 1e-4 * a for a in (0.4, 1.2, 0.8))
    # Five roundings on either side.
    assert by_default["counterweight1_mass"] == pytest.approx((m1 + m2) / 2, rel=10 * UNIT_ROUNDING)
    assert by_default["counterweight3_mass"] == pytest.approx((m3 + m2) / 2, rel=10 * UNIT_ROUNDING)
    assert abs(by_default["counterweight1_direction"]) == np.pi
    chosen = fl.planar.force_balance(CRANK, links=BARS, mass1=2.0)
    product = chosen["counterweight1_mass"] * chosen["counterweight1_radius"]
    assert chosen["counterweight1_mass"] == 2.0
    assert product == pytest.approx(0.4 * (m1 + m2) / 2, rel=10 * UNIT_ROUNDING)
    with refused("radius1", "write one of them"):
        fl.planar.force_balance(CRANK, links=BARS, radius1=0.1, mass1=2.0)
    with pytest.raises(fl.InputError, match=r"(?s)m1 is missing .*m2 is missing .*; add it"):
        fl.planar.force_balance(CRANK)


def test_the_flywheel_takes_up_the_fluctuation_also_of_a_map_in_a_file(tmp_path):
    maps = sweep_4r(fl.grid(**CRANK | {"omega1": [5.0, 25.0]}), ["T41_fluctuation"], links=BARS)
    inertia = fl.planar.flywheel_inertia(maps, C_s=0.02)
    assert inertia.dims == maps.T41_fluctuation.dims
    assert inertia.attrs["units"] == "kg m2"
    # Torques grow with the square of the speed: the flywheel is the same, to some roundings of the torques (1e-13).
    assert_allclose(inertia.sel(omega1=5.0), inertia.sel(omega1=25.0), rtol=1e-11)
    assert_array_equal(inertia.sel(omega1=5.0), maps.T41_fluctuation.sel(omega1=5.0) / (0.02 * 25.0))
    crank = fl.grid(r=0.1, l=0.4, e=0.0, omega=[5.0, 25.0], m3=1.0)
    maps = sweep_both("slider_crank", crank, ["T41_fluctuation"], links=BARS, to=tmp_path / "m.h5", verify=0)
    expected = fl.planar.flywheel_inertia(maps, C_s=0.02)
    maps.close()
    assert_array_equal(fl.planar.flywheel_inertia(tmp_path / "m.h5", C_s=0.02), expected)
    converted = maps.assign_coords(omega=maps.omega.assign_attrs(units="rpm"))
    with pytest.raises(fl.InputError, match=r"omega.*rpm.*; give the map as it was"):
        fl.planar.flywheel_inertia(converted, C_s=0.02)


def test_table_3_as_it_follows_from_table_1():
    design = fl.grid(**TURNING)
    got = fl.sweep(
        "planar_4r", design, ["shaking_force_extrema", "shaking_moment_extrema"], links=BARS, branch=2
    ).squeeze()
    forces, moments = got.shaking_force_extrema.values, got.shaking_moment_extrema.values
    # The figures of docs/papers.md, half a unit of the last.
    assert np.nanmax(forces) == pytest.approx(2512.318373, abs=5e-7)
    assert np.nanmin(forces) == pytest.approx(685.182260, abs=5e-7)
    assert np.nanmax(np.abs(moments)) == pytest.approx(2048.609105, abs=5e-7)
    places = got.theta1_at_shaking_force_extrema.values
    assert places[np.nanargmax(forces)] == pytest.approx(0.109628, abs=5e-7)
    assert places[np.nanargmin(forces)] == pytest.approx(5.546474, abs=5e-7)
    place = got.theta1_at_shaking_moment_extrema.values[np.nanargmax(np.abs(moments))]
    assert place == pytest.approx(0.219954, abs=5e-7)
    assert np.nanmin(forces) > 12 * 56.9764


def test_the_bound_and_the_printed_expression_of_table_3():
    curves = fl.sweep(
        "planar_4r",
        fl.grid(**TURNING),
        ["alpha4", "shaking_moment_printed"],
        links=BARS,
        branch=2,
        theta1=36000,
    ).squeeze()
    # The bound that needs no solve: the output link's mass centre alone.
    assert 0.62 * np.pi * 0.4 * float(curves.alpha4.max()) == pytest.approx(828.0, abs=0.5)
    printed = curves.shaking_moment_printed
    # The nearest sample is half a step off: f'' h^2/8 with |f''| below 100 times the value, 4e-7 of it.
    assert float(printed.max()) == pytest.approx(806.192, rel=2e-6)
    assert float(printed.min()) == pytest.approx(-399.354, rel=2e-6)

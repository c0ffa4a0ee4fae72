"""Designs of any size give the same bits at every door: in units of their own, whatever stands beside them."""

from __future__ import annotations

import numpy as np
import pytest
from fastlink.facts.sizes import dimensions

import fastlink as fl
from fastlink.mechanisms import catalogue

PLANAR = catalogue("planar_4r")
DESIGN = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0, "m1": 1.0, "m2": 2.0, "m3": 1.5}
DESIGN |= {"I1": 0.0, "I2": 0.1, "I3": 0.2, "G1_u": 0.2, "G2_u": 0.6, "G3_u": 0.3, "G1_v": 0.0, "G2_v": 0.0}
DESIGN |= {"G3_v": 0.01}
#: Exponents of mass, length and time: an ordinary design stands among far ones.
UNITS = [(600, -500, 0), (0, 0, 0), (-600, 500, 0), (700, 0, 0), (0, -300, 0), (-3, 2, 1)]
NAMES = [
    "F32_max",
    "T41_max",
    "F32_error_max",
    "d_F32_d_a1_max",
    "T41_rms",
    "theta1_at_T41_max",
    "omega4_max",
]


def in_units(name, value, unit):
    """Return an input or result in other units."""
    units = PLANAR.known_inputs(PLANAR.variant_inputs)[name].units if name in DESIGN else name
    return np.ldexp(value, sum(x * y for x, y in zip(dimensions(units), unit, strict=True)))


TABLE = {name: np.array([in_units(name, value, unit) for unit in UNITS]) for name, value in DESIGN.items()}


@pytest.fixture(scope="module")
def maps():
    return fl.sweep("planar_4r", fl.table(TABLE), [*NAMES, "F32", "T41_extrema"], theta1=8, block=2)


def test_results_of_sweeps_are_those_of_ordinary_designs_in_other_units(maps):
    for name in maps.data_vars:
        if name != "status":
            units = maps[name].attrs.get("units", "1")
            for k, unit in enumerate(UNITS):
                expected = in_units(units, maps[name].values[1], unit)
                np.testing.assert_array_equal(maps[name].values[k], expected, err_msg=f"{name} in {unit}")
    found = fl.evaluate("planar_4r", ["F32"], theta1=maps.theta1.values[3], branch=2, **TABLE)
    np.testing.assert_array_equal(found["F32"], maps.F32.sel(branch=2).values[:, 3])


def test_neighbours_and_axes_change_no_bit(maps):
    for k in range(len(UNITS)):
        alone = fl.sweep(
            "planar_4r", {name: float(values[k]) for name, values in TABLE.items()}, NAMES, theta1=8
        )
        for name in NAMES:
            np.testing.assert_array_equal(alone[name].values, maps[name].values[k], err_msg=name)
    speeds = 2.0 ** np.array([-400.0, 0.0, 300.0])
    swept = fl.sweep(
        "planar_4r", fl.grid(**DESIGN | {"omega1": speeds}), ["omega4_max", "theta1_at_omega4_max"]
    )
    assert "scaling_axis" not in swept.attrs
    np.testing.assert_array_equal(swept.omega4_max, np.outer(speeds, swept.omega4_max[1]))


def test_functions_give_the_bits_of_sweeps(maps):
    values, names = np.array(list(TABLE.values())), NAMES[:3]
    function = fl.function("planar_4r", list(TABLE), names, branch=1, angles=8)
    expected = np.array([maps[name].sel(branch=1).values for name in names])
    np.testing.assert_array_equal(function(values), expected)
    for k in range(len(UNITS)):
        np.testing.assert_array_equal(function(values[:, k]), expected[:, k])
    # what stays is far from 1, too
    short = {name: float(values[0]) for name, values in TABLE.items() if name != "omega1"}
    of_speed = fl.function("planar_4r", ["omega1"], names, branch=1, angles=8, **short)
    np.testing.assert_array_equal(of_speed([25.0]), expected[:, 0])


def test_round_bars_of_any_size_have_their_moments_of_inertia():
    lengths = {name: DESIGN[name] for name in ("a1", "a2", "a3", "a4")}
    plain = fl.sweep(
        "planar_4r", {**lengths, "omega1": 3.0}, ["F32_max"], links=fl.round_bar(density=8e3, radius=0.01)
    )
    # a moment of inertia grows with the fifth power: 2^-1250 is no double
    small = {name: np.ldexp(value, -250) for name, value in lengths.items()}
    bars = fl.round_bar(density=np.ldexp(8e3, 250), radius=np.ldexp(0.01, -250))
    found = fl.sweep("planar_4r", {**small, "omega1": 3.0}, ["F32_max"], links=bars)
    np.testing.assert_array_equal(found.F32_max, np.ldexp(plain.F32_max, -750))


def test_verification_reads_far_designs_too(tmp_path):
    names = ["F32_max", "T41_extrema", "T41_mean", "F32"]
    found = fl.sweep("planar_4r", fl.table(TABLE), names, theta1=8, to=tmp_path / "map.h5", verify=6)
    for name in names:
        assert found[name].attrs["verify_mismatches"] == 0
        assert found[name].attrs["error_max_roundings"] < 4.0  # as everywhere, tests/support/registry.py


def test_numbers_that_no_units_bring_together_have_no_bound():
    design = {**DESIGN, "I2": 1e300} | {name: 1e-300 * DESIGN[name] for name in ("a1", "a2", "a3", "a4")}
    found = fl.evaluate("planar_4r", ["F32_error", "F32_trust"], theta1=1.0, **design)
    assert found == {"F32_error": np.inf, "F32_trust": 1.0} or found["F32_trust"] == 2.0


def test_values_below_all_doubles_are_not_trusted():
    design = {name: in_units(name, value, (-300, -600, 0)) for name, value in DESIGN.items()} | {
        "I2": 0.0,
        "I3": 0.0,
    }
    found = fl.evaluate("planar_4r", ["T41", "T41_error", "T41_trust"], theta1=1.0, **design)
    assert found["T41"] == 0.0
    assert found["T41_error"] > 0.0
    assert found["T41_trust"] == 1.0

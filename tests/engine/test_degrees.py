"""Angles in degrees, by names that end in _deg, at every door; and remarks on angles that look like degrees."""

import math

import numpy as np
import pytest
import xarray as xr
from mpmath import mp
from numpy.testing import assert_array_equal
from tests.support.refusals import refused

import fastlink as fl
from fastlink.space.units import PI, looks_like_degrees, scaled

DESIGN = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
WEIGHT = {"counterweight1_mass": 1.0, "counterweight1_radius": 0.1}
BARS = fl.round_bar(density=7750.0, radius=0.01)
ANGLES = [0.0, 40.0, 80.0, 180.0]


def radians(degrees):
    return scaled(degrees, PI / 180)


def exact(degrees):
    with mp.workprec(300):
        return float(mp.mpf(degrees) * mp.pi / 180)


def test_degrees_are_rounded_once():
    """The sum of two doubles has pi/180 to 2^-106; the chance that a product is rounded otherwise is 2^-50 each."""
    rng = np.random.default_rng(1)
    values = [*range(-720, 721), *rng.uniform(-400, 400, 2000), 1e-300, 5e-324, 1e15, 1e300, 1.7e308, 0.1]
    assert_array_equal(radians(np.array(values, float)), [exact(float(value)) for value in values])
    assert radians(180.0) == math.pi
    assert math.copysign(1.0, radians(-0.0)) == -1.0
    assert_array_equal(radians([np.inf, np.nan]), [np.inf, np.nan])
    with mp.workprec(300):
        assert abs(mp.pi - mp.mpf(PI.numerator) / PI.denominator) < mp.mpf(2) ** -280


def test_input_positions_in_degrees():
    names = ["theta4", "omega4"]
    got = fl.sweep("planar_4r", fl.grid(**DESIGN), names, theta1_deg=ANGLES, branch=(1, 2))
    expected = fl.sweep(
        "planar_4r", fl.grid(**DESIGN), names, theta1=[exact(value) for value in ANGLES], branch=(1, 2)
    )
    xr.testing.assert_equal(got, expected)
    assert got.theta1.attrs["units"] == "rad"
    assert got.theta1.attrs["comment"] == "given in degrees"
    assert expected.theta1.attrs["comment"] == "direction of OA in the ground frame"
    lengths = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0)
    one = fl.sweep(
        "planar_4r",
        lengths,
        ["joint_angle_3"],
        input="joint_angle_2",
        joint_angle_2_deg=[100.0],
        branch=(1, 2),
    )
    assert one.joint_angle_2.item() == exact(100.0)


def test_configurations_in_degrees():
    for theta in (40.0, [[40.0], [80]], xr.DataArray([40, 80], dims="k", coords={"k": [1, 2]})):
        got = fl.evaluate("planar_4r", ["omega4"], **DESIGN, theta1_deg=theta)["omega4"]
        expected = fl.evaluate("planar_4r", ["omega4"], **DESIGN, theta1=radians_of(theta))
        assert_array_equal(got, expected["omega4"])
        assert type(got) is type(expected["omega4"])


def radians_of(theta):
    return theta.copy(data=radians(theta.values)) if hasattr(theta, "dims") else radians(theta)


def test_inputs_in_degrees():
    turned = [exact(value) for value in ANGLES]
    options = {"links": BARS, "branch": 1}
    inputs = {**DESIGN, **WEIGHT}
    name = "counterweight1_direction"
    expected = fl.sweep(
        "planar_4r",
        fl.grid(**inputs, **{name: turned}),
        ["shaking_force_max"],
        **{"branch": (1, 2)} | options,
    )
    got = fl.sweep(
        "planar_4r",
        fl.grid(**inputs, **{f"{name}_deg": ANGLES}),
        ["shaking_force_max"],
        **{"branch": (1, 2)} | options,
    )
    xr.testing.assert_equal(got, expected)
    assert got[name].attrs["comment"] == "given in degrees"
    table = fl.table({**inputs, f"{name}_deg": ANGLES})
    tabled = fl.sweep("planar_4r", table, ["shaking_force_max"], **{"branch": (1, 2)} | options)
    assert_array_equal(tabled.shaking_force_max, got.shaking_force_max)
    labelled = fl.grid(**inputs, **{name: xr.DataArray(ANGLES, dims="k", attrs={"units": "degrees"})})
    xr.testing.assert_equal(
        fl.sweep("planar_4r", labelled, ["shaking_force_max"], **{"branch": (1, 2)} | options), expected
    )
    one = fl.sweep(
        "planar_4r", {**inputs, f"{name}_deg": 40.0}, ["shaking_force_max"], **{"branch": (1, 2)} | options
    )
    assert one.shaking_force_max == expected.shaking_force_max[1]
    fixed = {key: value for key, value in inputs.items() if key != "a2"}
    function = fl.function(
        "planar_4r", ["a2"], ["shaking_force_max"], links=BARS, **fixed, **{f"{name}_deg": 40.0}
    )
    assert function([1.2])[0] == one.shaking_force_max


def test_functions_and_studies_in_degrees(tmp_path):
    fixed = {name: value for name, value in DESIGN.items() if name != "a2"}
    function = fl.function("planar_4r", ["a2"], ["omega4"], theta1_deg=ANGLES, **fixed)
    expected = fl.sweep("planar_4r", fl.grid(**DESIGN), ["omega4"], theta1_deg=ANGLES, branch=1)
    assert_array_equal(function([1.2])[0], expected.omega4)
    path = tmp_path / "study.toml"
    design = "\n".join(f"{name} = {value}" for name, value in DESIGN.items())
    for axis in (f"{{values = {ANGLES}}}", "{linspace = [0.0, 180.0, 4]}"):
        path.write_text(
            f'mechanism = "planar_4r"\nquantities = ["omega4"]\n[design]\n{design}\n'
            f"[cycle]\nbranch = 1\ntheta1_deg = {axis}\n"
        )
        with fl.run(path, to=tmp_path / "map.h5", overwrite=True, verify=0) as maps:
            assert maps.theta1.values[-1] == math.pi
            assert maps.theta1.attrs["comment"] == "given in degrees"
            assert maps.omega4.values[0] == expected.omega4.values[0]
    path.write_text(path.read_text().replace("{linspace = [0.0, 180.0, 4]}", "72"))
    with pytest.raises(fl.InputError, match=r"cycle\.theta1_deg"):
        fl.run(path, to=tmp_path / "map.h5", overwrite=True)


SWEEPS = {
    "both": ({"theta1": [0.5], "theta1_deg": [40.0]}, "theta1_deg", "write one of them"),
    "a number": ({"theta1_deg": 72}, "theta1_deg", "a flat array of degrees; theta1 may be a number"),
    "nan": ({"theta1_deg": [1.0, math.nan]}, "theta1_deg[1]", "finite angles in degrees"),
    "twice": ({"theta1_deg": [1.0, 1.0]}, "theta1_deg", "each position once"),
    "angles_deg": ({"angles_deg": [1.0]}, "angles_deg", "theta1_deg"),
}


@pytest.mark.parametrize(("options", "key", "remedy"), SWEEPS.values(), ids=SWEEPS)
def test_what_is_no_array_of_degrees(options, key, remedy):
    with refused(key, remedy):
        fl.sweep("planar_4r", fl.grid(**DESIGN), ["omega4"], **{"branch": (1, 2)} | options)


def test_only_angles_have_degrees():
    hart = {"m": 1.0, "n": 1.4, "d": 2.5, "kappa": 0.6}
    with refused("F_y_deg", "write F_y"):
        fl.sweep("hart", fl.grid(**hart), ["phi"], input="F_y", F_y_deg=[0.1, 0.2], branch=(1, 2))
    with refused("a2_deg", "write a2"):
        fl.sweep("planar_4r", {**DESIGN, "a2_deg": 1.0}, ["omega4"], theta1=8, branch=(1, 2))
    both = {"counterweight1_direction_deg": 40.0, "counterweight1_direction": 0.5, **WEIGHT, **DESIGN}
    with refused("counterweight1_direction_deg", "write one of them"):
        fl.sweep("planar_4r", fl.grid(**both), ["omega4"], theta1=8, branch=(1, 2))
    with refused("theta1_deg", "write one of them"):
        fl.evaluate("planar_4r", ["omega4"], theta1=1.0, theta1_deg=40.0, **DESIGN)
    with refused("a2_deg", "write a2"):
        fl.evaluate("planar_4r", ["omega4"], theta1=1.0, a2_deg=40.0, **DESIGN)
    with refused("theta1_deg", "write"):
        fl.evaluate("planar_4r", ["omega4"], theta1_deg="forty", **DESIGN)
    with refused("a2_deg", "write a2"):
        fl.function("planar_4r", ["a2_deg"], ["theta4"], a1=0.4, a3=0.8, a4=1.0)


IN_DEGREES = [[40, 80, 120], [-90.0], 45]
IN_RADIANS = [[0, 1, 2, 3, 4, 5, 6], np.linspace(0, 2 * np.pi, 73), [12.566370614359172], 5.5, [np.nan]]


@pytest.mark.parametrize("values", IN_DEGREES)
def test_what_can_hardly_be_radians_gets_a_remark(values):
    assert looks_like_degrees(values)
    if np.ndim(values):
        with pytest.warns(fl.InputWarning, match="theta1_deg"):
            fl.sweep("planar_4r", fl.grid(**DESIGN), ["omega4"], theta1=values, branch=(1, 2))
        with pytest.warns(fl.InputWarning, match="theta1_deg"):
            fl.sweep("planar_4r", fl.grid(**DESIGN), ["omega4"], angles=values, branch=(1, 2))
    with pytest.warns(fl.InputWarning, match="theta1_deg"):
        fl.evaluate("planar_4r", ["omega4"], theta1=values, **DESIGN)
    with pytest.warns(fl.InputWarning, match="counterweight1_direction_deg"):
        fl.sweep(
            "planar_4r",
            fl.grid(counterweight1_direction=values, **WEIGHT, **DESIGN),
            ["omega4_max"],
            branch=(1, 2),
        )


@pytest.mark.parametrize("values", IN_RADIANS)
def test_radians_get_none(values):
    assert not looks_like_degrees(values)

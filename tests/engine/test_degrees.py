"""Angles in degrees, by names that end in _deg, at every door; and remarks on angles that look like degrees."""

import math

import numpy as np
import pytest
import xarray as xr
from mpmath import mp
from numpy.testing import assert_array_equal
from tests.support.four_bar import sweep_4r
from tests.support.refusals import refused

import fastlink as fl
from fastlink.space.units import PI, looks_like_degrees, scaled

DESIGN = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
FIXED = {name: value for name, value in DESIGN.items() if name != "a4"}
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
    got = sweep_4r(fl.grid(**DESIGN), names, theta1_deg=ANGLES)
    expected = sweep_4r(fl.grid(**DESIGN), names, theta1=[exact(value) for value in ANGLES])
    xr.testing.assert_equal(got, expected)
    assert got.theta1.attrs["units"] == "rad"
    assert got.theta1.attrs["comment"] == "given in degrees"
    assert expected.theta1.attrs["comment"] == "direction of OA in the ground frame"
    lengths = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0)
    one = sweep_4r(lengths, ["joint_angle_3"], input="joint_angle_2", joint_angle_2_deg=[100.0])
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
    """Of a grid; that all doors take units by name alike is tested with lengths."""
    name = "counterweight1_direction"
    got, expected = (
        fl.sweep("planar_4r", fl.grid(**DESIGN, **WEIGHT, **given), ["shaking_force_max"], links=BARS)
        for given in ({f"{name}_deg": ANGLES}, {name: [exact(value) for value in ANGLES]})
    )
    xr.testing.assert_equal(got, expected)
    assert got[name].attrs["comment"] == "given in degrees"


def labelled(values, units):
    values = np.asarray(values)
    return xr.DataArray(values, dims=["x"][: values.ndim], attrs={"units": units})


@pytest.mark.parametrize("name", ["theta1", "theta1_deg"])
def test_positions_in_another_unit_are_refused(name):
    remedy = "convert it to degrees" if name.endswith("_deg") else "convert it to rad"
    unit = "turn" if name.endswith("_deg") else "mm"
    for call in (
        lambda: sweep_4r(DESIGN, ["omega4"], **{name: labelled([0.1, 0.2], unit)}),
        lambda: fl.evaluate("planar_4r", ["omega4"], **DESIGN, **{name: labelled(0.1, unit)}),
        lambda: fl.function("planar_4r", ["a4"], ["omega4"], **FIXED, **{name: labelled([0.1], unit)}),
    ):
        with refused(name, remedy):
            call()


def test_labelled_degrees_are_converted_alike():
    degrees = fl.evaluate("planar_4r", ["omega4"], **DESIGN, theta1=labelled(60.0, "degree"))["omega4"]
    by_name = fl.evaluate("planar_4r", ["omega4"], **DESIGN, theta1_deg=60.0)["omega4"]
    both = fl.evaluate("planar_4r", ["omega4"], **DESIGN, theta1_deg=labelled(60.0, "degree"))["omega4"]
    assert float(degrees) == by_name == float(both)
    swept = fl.sweep("planar_4r", DESIGN, ["omega4"], theta1=labelled([60.0], "deg"), branch=1)
    assert swept.omega4.item() == by_name


def test_functions_and_studies_in_degrees(tmp_path):
    function = fl.function("planar_4r", ["a4"], ["omega4"], theta1_deg=ANGLES, **FIXED)
    expected = fl.sweep("planar_4r", fl.grid(**DESIGN), ["omega4"], theta1_deg=ANGLES, branch=1)
    assert_array_equal(function([1.0])[0], expected.omega4)
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
        sweep_4r(fl.grid(**DESIGN), ["omega4"], **options)


def test_only_angles_have_degrees():
    hart = {"m": 1.0, "n": 1.4, "d": 2.5, "kappa": 0.6}
    with refused("F_y_deg", "write F_y"):
        fl.sweep("hart", fl.grid(**hart), ["phi"], input="F_y", F_y_deg=[0.1, 0.2], branch=(1, 2))
    with refused("a2_deg", "write a2"):
        sweep_4r({**DESIGN, "a2_deg": 1.0}, ["omega4"], theta1=8)
    both = {"counterweight1_direction_deg": 40.0, "counterweight1_direction": 0.5, **WEIGHT, **DESIGN}
    with refused("counterweight1_direction_deg", "write one of them"):
        sweep_4r(fl.grid(**both), ["omega4"], theta1=8)
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
            sweep_4r(fl.grid(**DESIGN), ["omega4"], theta1=values)
        with pytest.warns(fl.InputWarning, match="theta1_deg"):
            sweep_4r(fl.grid(**DESIGN), ["omega4"], angles=values)
    with pytest.warns(fl.InputWarning, match="theta1_deg"):
        fl.evaluate("planar_4r", ["omega4"], theta1=values, **DESIGN)
    with pytest.warns(fl.InputWarning, match="counterweight1_direction_deg"):
        sweep_4r(fl.grid(counterweight1_direction=values, **WEIGHT, **DESIGN), ["omega4_max"])


@pytest.mark.parametrize("values", IN_RADIANS)
def test_radians_get_none(values):
    assert not looks_like_degrees(values)

"""The door: shapes, labels, statuses, NaN, bits, files, and every bad input with its message."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from tests.support.configurations import PLANAR
from tests.support.four_bar import sweep_4r
from tests.support.refusals import refused

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

TABLE_1 = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0}
BARS = fl.round_bar(density=7750.0, radius=0.01)
#: Quantities of the coupler point, which these designs do not have; test_coupler.py asks for them.
AT_P = ("P_x", "P_y", "P_vx", "P_vy", "P_ax", "P_ay", "P_speed", "curvature")
# Some of these turn fully, some do not, some never assemble.
MIXED = fl.grid(a1=0.4, a2=np.linspace(0.1, 1.9, 13), a3=np.linspace(0.1, 1.2, 11), a4=1.0, omega1=25.0)


def small_map(**options):
    asked = [
        "omega4_max",
        "theta1_at_omega4_max",
        "transmission_angle_min",
        "shaking_force_rms",
        "theta4",
        "T41",
    ]
    return sweep_4r(MIXED, asked, links=BARS, **{"theta1": 45} | options)


def test_dimensions_are_the_swept_ones_then_branch_then_theta1():
    result = small_map()
    assert result.omega4_max.dims == ("a2", "a3", "branch")
    assert result.theta4.dims == ("a2", "a3", "branch", "theta1")
    assert result.status.dims == ("a2", "a3")
    assert result.sizes == {"a2": 13, "a3": 11, "branch": 2, "theta1": 45}
    np.testing.assert_array_equal(result.theta1, np.arange(45) * (2 * np.pi / 45))
    assert result.theta4.attrs["units"] == "rad"
    assert result.theta1_at_omega4_max.attrs["units"] == "rad"
    assert result.omega4_max.attrs["references"] == "Hayes, Hninn, Irani, eq. (7)"
    assert float(result.radius) == 0.01
    assert result.a2.attrs["long_name"] == "length of the coupler AB"


def test_a_single_design_has_no_swept_dimension():
    result = fl.sweep("planar_4r", fl.grid(**TABLE_1), ["B_x", "transmission_angle_max"], theta1=8, branch=2)
    assert result.B_x.dims == ("theta1",)
    assert result.transmission_angle_max.shape == ()
    assert result.status.shape == ()


def test_a_map_of_design_facts_touches_no_angle():
    result = sweep_4r(fl.grid(a1=[0.1, 0.4], a2=1.2, a3=0.8, a4=1.0), ["status"])
    assert set(result.dims) == {"a1"}
    assert "theta1_count" not in result.attrs


@pytest.mark.parametrize(
    ("lengths", "meaning"),
    [
        ((0.4, 1.2, 0.8, 1.0), "rotates_fully"),  # crank-rocker
        ((1.2, 0.8, 1.0, 0.5), "rotates_fully"),  # drag link, other order
        ((0.8, 0.4, 1.2, 1.0), "assembles_over_part_of_the_turn"),  # rocker input
        ((1.0, 1.0, 1.0, 4.0), "never_assembles"),
        ((1.0, 2.0, 1.0, 2.0), "change_point"),  # parallelogram
        ((1.0, 2.0, 2.0, 1.0), "change_point"),  # kite
        ((0.1, 0.3, 0.6, 0.4), "change_point"),  # 0.1 + 0.6 = 0.3 + 0.4 but for rounding
        ((1.0, 1.0, 1.0, 3.0), "assembles_in_one_position"),
        ((0.3, 0.1, 0.7, 0.3), "assembles_in_one_position"),  # 0.3 + 0.1 + 0.3 = 0.7 but for rounding
        ((1.0, 1.0, 1.0, 3.0 - 1e-14), "assembles_over_part_of_the_turn"),
    ],
)
def test_status(lengths, meaning):
    result = sweep_4r(fl.grid(**dict(zip(TABLE_1, lengths, strict=True))), ["status"])
    meanings = result.status.attrs["flag_meanings"].split()
    assert meanings[list(result.status.attrs["flag_values"]).index(int(result.status))] == meaning
    assert result.attrs[f"designs_{meaning}"] == 1


def test_at_a_change_point_the_last_bit_of_a_length_decides_nothing():
    """Along a2 = a3 + a1 + a4 the gap is zero or a rounding; rates vary smoothly, not by 1e8."""
    a3 = np.linspace(0.4, 0.9, 51)
    line = fl.table({"a1": 0.2, "a2": a3 + 0.4, "a3": a3, "a4": 0.6, "omega1": 25.0})
    result = sweep_4r(line, ["alpha4_max", "omega4_max", "B_x"], theta1=360)
    assert (result.status == 3).all()
    assert np.isfinite(result.B_x).all()
    neighbours = result.alpha4_max.values[1:] / result.alpha4_max.values[:-1]
    # a3 changes by 1 to 2.5 % from one design to the next.
    assert np.all(np.abs(neighbours - 1) < 0.1)


def test_what_does_not_assemble_is_nan_and_alters_no_extreme():
    result = small_map(extrema="sampled")
    closes = np.isfinite(result.theta4)
    partial = closes.any("theta1") & ~closes.all("theta1")
    never = ~closes.any("theta1")
    assert int(partial.sum()) > 10
    assert int(never.sum()) > 10
    folded = (result.status == 3) & (result.theta1 == 0.0)
    assert bool(folded.any())
    np.testing.assert_array_equal(np.isfinite(result.T41), closes & ~folded)
    curves = sweep_4r(MIXED, ["omega4", "transmission_angle", "shaking_force"], links=BARS, theta1=45)
    for name, expected in {
        "omega4_max": curves.omega4.max("theta1"),
        "transmission_angle_min": curves.transmission_angle.min("theta1"),
    }.items():
        np.testing.assert_array_equal(result[name], expected)
    at = curves.theta1[curves.omega4.fillna(-np.inf).argmax("theta1")].where(~never)
    np.testing.assert_array_equal(result.theta1_at_omega4_max, at)
    # 45 squares summed in another order: 45 roundings at most.
    rms = np.sqrt((curves.shaking_force**2).mean("theta1"))
    np.testing.assert_allclose(result.shaking_force_rms, rms, rtol=45 * UNIT_ROUNDING)


def bits(values: np.ndarray) -> bytes:
    """Return the bits of every number; IEEE 754 leaves the sign of a NaN open, and compilers use that."""
    return (
        np.where(np.isnan(values), np.nan, values).tobytes() if values.dtype.kind == "f" else values.tobytes()
    )


def assert_same_bits(one: xr.Dataset, two: xr.Dataset):
    for name in one.data_vars:
        if name in two:
            assert bits(one[name].values) == bits(two[name].values), name


@pytest.mark.parametrize("options", [{"threads": 1}, {"threads": 3, "block": 64}, {"block": 7}])
def test_bits_depend_neither_on_threads_nor_on_blocks(options):
    assert_same_bits(small_map(threads=1, block=4096), small_map(**options))


@pytest.mark.parametrize("step", [9, pytest.param(1, marks=pytest.mark.stress)])
def test_bits_depend_neither_on_what_else_is_asked_nor_on_the_lanes(step):
    everything = [name for name in PLANAR.public if name not in AT_P]
    # Curves alone: lanes are angles. With an extreme: lanes are designs. With few angles too.
    curves = sweep_4r(MIXED, everything, links=BARS, theta1=45)
    mixed = sweep_4r(MIXED, [*everything, "alpha4_max"], links=BARS, theta1=45)
    assert_same_bits(curves, mixed)
    for name in everything[::step]:
        alone = sweep_4r(MIXED, [name], links=BARS, theta1=45)
        assert_same_bits(alone, curves)
    few = sweep_4r(MIXED, everything, links=BARS, theta1=curves.theta1.values[:9])
    assert_same_bits(few, curves.isel(theta1=slice(0, 9)))
    one_branch = fl.sweep("planar_4r", MIXED, everything, links=BARS, theta1=45, branch=[2])
    assert_same_bits(one_branch, curves.isel(branch=[1]))


def test_the_plain_facts_have_the_bits_of_the_compiled_ones():
    names = [name for name in PLANAR.public if PLANAR.varies(name) and name not in AT_P]
    space = fl.grid(a1=0.4, a2=np.linspace(0.7, 1.6, 13), a3=0.5, a4=1.0, omega1=25.0)
    swept = sweep_4r(space, names, links=BARS, theta1=30)
    plain = fl.evaluate(
        "planar_4r",
        names,
        links=BARS,
        a1=0.4,
        a2=swept.a2,
        a3=0.5,
        a4=1.0,
        omega1=25.0,
        branch=swept.branch,
        theta1=swept.theta1,
    )
    for name in names:
        np.testing.assert_array_equal(
            swept[name].values, plain[name].transpose(*swept[name].dims).values, err_msg=name
        )


def test_mass_data_of_the_design_replace_those_of_the_model():
    ours = sweep_4r(fl.grid(**TABLE_1, omega1=25.0, m3=0.0, I3=0.0), ["shaking_force_max"], links=BARS)
    bars = sweep_4r(fl.grid(**TABLE_1, omega1=25.0), ["shaking_force_max"], links=BARS)
    assert float(ours.shaking_force_max[0]) < float(bars.shaking_force_max[0])


def test_invalid_designs_can_be_flagged_instead_of_refused():
    bad = fl.table(
        {"a1": [0.4, -0.4, np.nan, np.inf, 0.0], "a2": [1.2] * 5, "a3": 0.8, "a4": 1.0}, allow_invalid=True
    )
    result = sweep_4r(bad, ["B_x", "transmission_angle_min"], theta1=8, allow_invalid=True)
    assert list(result.status.values) == [0, 4, 4, 4, 4]
    assert np.isfinite(result.B_x[0]).all()
    assert np.isnan(result.B_x[1:]).all()
    assert np.isnan(result.transmission_angle_min[1:]).all()


def test_file_and_memory_hold_the_same(tmp_path):
    path = tmp_path / "maps.h5"
    in_file, in_memory = small_map(to=path, verify=4), small_map(verify=4)
    assert_same_bits(in_memory, in_file)
    for name in in_memory.variables:
        assert in_file[name].attrs.keys() == in_memory[name].attrs.keys()
    assert [p.name for p in tmp_path.iterdir()] == ["maps.h5"]
    in_file.close()
    with xr.open_dataset(path, engine="netcdf4") as other:
        assert_same_bits(in_memory, other)


@pytest.mark.parametrize(
    ("change", "key", "remedy"),
    [
        ({"mechanism": "planar_4R"}, "mechanism: 'planar_4R'", "did you mean 'planar_4r'?"),
        ({"quantities": ["omega_4"]}, "quantity 'omega_4'", "did you mean 'omega4'?"),
        ({"quantities": ["status_max"]}, "quantity 'status_max'", ""),
        ({"quantities": []}, "quantities", "at least one name"),
        ({"quantities": ["omega4", "omega4"]}, "quantities[1]", "name it once"),
        ({"space": {"a1": 0.4, "a2": 1.2, "a3": 0.8, "omega1": 1.0}}, "design: a4", ""),
        ({"space": {**TABLE_1, "omega1": 1.0, "a5": 1.0}}, "design: a5", "did you mean 'a4'"),
        (
            {"quantities": ["T41"], "space": {**TABLE_1, "omega1": 1.0}, "links": fl.round_bar(7750.0)},
            "links: radius",
            "",
        ),
        ({"space": {**TABLE_1, "omega1": 1.0, "a3": 0.0}}, "design: a3", "greater than 0"),
        ({"space": {**TABLE_1, "omega1": 1.0, "a3": [0.8, -0.1]}}, "design: a3[1]", ""),
        ({"space": {**TABLE_1, "omega1": 1.0, "m2": -1.0}}, "design: m2", "at least 0"),
        ({"theta1": 0}, "theta1", "a number from 1 to 100000000, or an array in rad"),
        ({"theta1": [0.0, 1.0, 0.0]}, "theta1", "each position once"),
        ({"theta1": [0.0, np.nan]}, "theta1[1]", "finite angles in rad"),
        ({"branch": 3}, "branch", "some of 1, 2"),
        ({"branch": (1, 1)}, "branch", "each once"),
    ],
)
def test_bad_input_gets_one_clear_line(change, key, remedy):
    options = {
        "mechanism": "planar_4r",
        "space": {**TABLE_1, "omega1": 1.0},
        "quantities": ["omega4"],
    } | change
    with refused(key, remedy):
        fl.sweep(
            options.pop("mechanism"),
            fl.grid(**options.pop("space")),
            options.pop("quantities"),
            **{"branch": (1, 2)} | options,
        )


def test_a_map_that_does_not_fit_the_disk_is_refused_before_anything_is_computed(tmp_path):
    huge = fl.grid(a1=0.4, a2=np.linspace(1, 1.4, 10**5), a3=np.linspace(0.6, 1, 10**4), a4=1.0)
    with pytest.raises(fl.InputError, match=r"needs 11\.5 TB but .* are free"):
        sweep_4r(huge, ["theta4"], theta1=720, to=tmp_path / "huge.h5")
    assert not list(tmp_path.iterdir())

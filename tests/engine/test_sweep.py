"""The door: shapes, labels, statuses, NaN, bits, files, and every bad input with its message."""

import warnings

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.configurations import PLANAR
from tests.support.refusals import refused
from tests.support.sweeps import BARS, CRANK, TURNING, sweep_4r, sweep_both

import fastlink as fl
from fastlink.app.report import contents
from fastlink.engine.resolve import resolve
from fastlink.engine.scaling import ScalingAxis, homogeneity_degrees
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

#: Quantities of the coupler point, which these designs do not have; test_curves.py asks for them.
AT_P = ("P_x", "P_y", "P_vx", "P_vy", "P_ax", "P_ay", "P_speed", "curvature")
# Some of these turn fully, some do not, some never assemble.
MIXED = fl.grid(a1=0.4, a2=np.linspace(0.1, 1.9, 13), a3=np.linspace(0.1, 1.2, 11), a4=1.0, omega1=25.0)


def small_map(**options):
    asked = ["omega4_max", "theta1_at_omega4_max", "transmission_angle_min"]
    asked += ["shaking_force_rms", "theta4", "T41"]
    return sweep_4r(MIXED, asked, links=BARS, **{"theta1": 45} | options)


def test_dimensions_are_the_swept_ones_then_branch_then_theta1():
    result = small_map()
    assert result.omega4_max.dims == ("a2", "a3", "branch")
    assert result.theta4.dims == ("a2", "a3", "branch", "theta1")
    assert result.status.dims == ("a2", "a3")
    assert result.sizes == {"a2": 13, "a3": 11, "branch": 2, "theta1": 45}
    assert_array_equal(result.theta1, np.arange(45) * (2 * np.pi / 45))
    assert result.theta4.attrs["units"] == "rad"
    assert result.theta1_at_omega4_max.attrs["units"] == "rad"
    assert result.omega4_max.attrs["references"] == "Hayes, Hninn, Irani, eq. (7)"
    assert float(result.radius) == 0.01
    assert result.a2.attrs["long_name"] == "length of the coupler AB"
    result = fl.sweep("planar_4r", fl.grid(**CRANK), ["B_x", "transmission_angle_max"], theta1=8, branch=2)
    assert result.B_x.dims == ("theta1",)
    assert result.transmission_angle_max.shape == ()
    assert result.status.shape == ()
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
    result = sweep_4r(fl.grid(**dict(zip(CRANK, lengths, strict=True))), ["status"])
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
    assert_array_equal(np.isfinite(result.T41), closes & ~folded)
    curves = sweep_4r(MIXED, ["omega4", "transmission_angle", "shaking_force"], links=BARS, theta1=45)
    for name, expected in {
        "omega4_max": curves.omega4.max("theta1"),
        "transmission_angle_min": curves.transmission_angle.min("theta1"),
    }.items():
        assert_array_equal(result[name], expected)
    at = curves.theta1[curves.omega4.fillna(-np.inf).argmax("theta1")].where(~never)
    assert_array_equal(result.theta1_at_omega4_max, at)
    # 45 squares summed in another order: 45 roundings at most.
    rms = np.sqrt((curves.shaking_force**2).mean("theta1"))
    assert_allclose(result.shaking_force_rms, rms, rtol=45 * UNIT_ROUNDING)


def bits(values):
    """Return the bits of every number; IEEE 754 leaves the sign of a NaN open, and compilers use that."""
    return (
        np.where(np.isnan(values), np.nan, values).tobytes() if values.dtype.kind == "f" else values.tobytes()
    )


def assert_same_bits(one, two):
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
    design = {"a1": 0.4, "a2": np.linspace(0.7, 1.6, 13), "a3": 0.5, "a4": 1.0, "omega1": 25.0}
    swept = sweep_4r(fl.grid(**design), names, links=BARS, theta1=30)
    at = design | {"a2": swept.a2, "branch": swept.branch, "theta1": swept.theta1}
    plain = fl.evaluate("planar_4r", names, links=BARS, **at)
    for name in names:
        assert_array_equal(swept[name].values, plain[name].transpose(*swept[name].dims).values, err_msg=name)


def test_mass_data_of_the_design_replace_those_of_the_model():
    ours = sweep_4r(fl.grid(**TURNING, m3=0.0, I3=0.0), ["shaking_force_max"], links=BARS)
    bars = sweep_4r(fl.grid(**TURNING), ["shaking_force_max"], links=BARS)
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


@pytest.mark.parametrize(
    ("change", "key", "remedy"),
    [
        ({"mechanism": "planar_4R"}, "mechanism: 'planar_4R'", "did you mean 'planar_4r'?"),
        ({"quantities": ["omega_4"]}, "quantity 'omega_4'", "did you mean 'omega4'?"),
        ({"quantities": ["status_max"]}, "quantity 'status_max'", ""),
        ({"quantities": []}, "quantities", "at least one name"),
        ({"quantities": ["omega4", "omega4"]}, "quantities[1]", "name it once"),
        ({"space": {"a1": 0.4, "a2": 1.2, "a3": 0.8, "omega1": 1.0}}, "design: a4", ""),
        ({"space": {**TURNING, "a5": 1.0}}, "design: a5", "did you mean 'a4'"),
        ({"quantities": ["T41"], "links": fl.round_bar(7750.0)}, "links: radius", ""),
        ({"space": {**TURNING, "a3": 0.0}}, "design: a3", "greater than 0"),
        ({"space": {**TURNING, "a3": [0.8, -0.1]}}, "design: a3[1]", ""),
        ({"space": {**TURNING, "m2": -1.0}}, "design: m2", "at least 0"),
        ({"theta1": 0}, "theta1", "a number from 1 to 100000000, or an array in rad"),
        ({"theta1": [0.0, 1.0, 0.0]}, "theta1", "each position once"),
        ({"theta1": [0.0, np.nan]}, "theta1[1]", "finite angles in rad"),
        ({"branch": 3}, "branch", "some of 1, 2"),
        ({"branch": (1, 1)}, "branch", "each once"),
    ],
)
def test_bad_input_gets_one_clear_line(change, key, remedy):
    request = {"mechanism": "planar_4r", "space": TURNING, "quantities": ["omega4"]} | change
    with refused(key, remedy):
        sweep_both(**request | {"space": fl.grid(**request["space"])})


def test_a_map_that_does_not_fit_the_disk_is_refused_before_anything_is_computed(tmp_path):
    huge = fl.grid(a1=0.4, a2=np.linspace(1, 1.4, 10**5), a3=np.linspace(0.6, 1, 10**4), a4=1.0)
    with pytest.raises(fl.InputError, match=r"needs 11\.5 TB but .* are free"):
        sweep_4r(huge, ["theta4"], theta1=720, to=tmp_path / "huge.h5")
    assert not list(tmp_path.iterdir())


# == Designs of every kind through a sweep: tables, maps fed back, labels, units, angles in degrees ==========

FIXED = {"a1": 0.4, "a4": 1.0, "omega1": 25.0}
GRID = fl.grid(a2=[1.1, 1.2, 5.0], a3=[0.7, 0.8], **FIXED)
NAMES = ["omega4_max"]
IGNORED = pytest.warns(fl.InputWarning, match="omega4_max, status")


def sweep(space, names=NAMES, **options):
    return sweep_4r(space, names, **options)


@pytest.fixture(scope="module")
def maps():
    return sweep(GRID)


FED_BACK = {
    "whole": lambda maps: maps,
    "one assembly mode": lambda maps: maps.sel(branch=1),
    "some couplers": lambda maps: maps.isel(a2=[2, 0]),
    "one design": lambda maps: maps.isel(a2=1, a3=1),
    "in another order": lambda maps: maps.transpose("branch", "a3", "a2"),
    "those that assemble": lambda maps: maps.where(maps.status < 2, drop=True),
}


@pytest.mark.parametrize("select", FED_BACK.values(), ids=FED_BACK)
def test_a_map_stands_for_its_designs_in_their_dimensions(maps, select):
    chosen = select(maps)
    with IGNORED:
        again = sweep(chosen)
    wanted = chosen.drop_vars("branch") if chosen.branch.ndim == 0 else chosen
    expected = maps.omega4_max.sel({name: wanted[name] for name in ("a2", "a3")})
    xr.testing.assert_equal(again.omega4_max, expected.transpose(*again.omega4_max.dims))
    assert again.attrs["design_ignored"] == "omega4_max, status"


FLAT = {
    "stacked": lambda maps: maps.stack(design=("a2", "a3")),
    "rows": lambda maps: maps.to_dataframe(),
    "rows of one assembly mode": lambda maps: maps.sel(branch=2).to_dataframe().reset_index(),
    "table of rows": lambda maps: fl.table(maps.to_dataframe().reset_index()),
}


@pytest.mark.parametrize("select", FLAT.values(), ids=FLAT)
def test_rows_of_a_map_are_its_designs_each_once(maps, select):
    with IGNORED:
        again = sweep(select(maps))
    assert again.omega4_max.dims == ("design", "branch")
    assert_array_equal(again.omega4_max.values.reshape(3, 2, 2), maps.omega4_max)
    assert_array_equal(again.a2, np.repeat(maps.a2, 2))


def test_a_file_of_the_rows_of_a_map(maps, tmp_path):
    maps.to_dataframe().to_csv(tmp_path / "rows.csv")
    with IGNORED:
        again = sweep(tmp_path / "rows.csv")
    assert_array_equal(again.omega4_max.values.reshape(3, 2, 2), maps.omega4_max)


def test_selected_designs_keep_their_numbers_and_may_get_other_inputs(maps):
    sample = fl.sobol(8, a2=(1.0, 1.4), a3=0.8, **FIXED)
    whole = sweep(sample)
    with IGNORED:
        chosen = sweep(whole.isel(design=[5, 3]).assign(omega1=50.0))
    assert chosen.design.values.tolist() == [5, 3]
    # twice the speed of the crank is twice every rate, a power of two without rounding
    assert_array_equal(chosen.omega4_max, 2.0 * whole.omega4_max.sel(design=[5, 3]))


def test_a_map_without_results_is_taken_in_silence(maps):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        again = sweep(maps.drop_vars(maps.data_vars))
    xr.testing.assert_equal(again.omega4_max, maps.omega4_max)
    assert "design_ignored" not in again.attrs


def test_choices_that_a_map_made_come_back():
    space = fl.table({"a": [5.0, 5.5], "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0})
    whole = sweep_both("focal", space, ["crank_type"])
    with pytest.warns(fl.InputWarning, match="crank_type"):
        again = sweep_both("focal", whole, ["crank_type"])
    assert again.crank_type.dims == ("design", "completion")
    xr.testing.assert_equal(again.crank_type, whole.crank_type)


def test_links_count_before_those_of_a_map():
    light, heavy = fl.round_bar(density=2700.0, radius=0.01), fl.round_bar(density=7750.0, radius=0.01)
    whole = sweep(GRID, ["T41_max"], links=heavy)
    with pytest.warns(fl.InputWarning, match="density, radius"):
        again = sweep(whole, ["T41_max"], links=light)
    xr.testing.assert_equal(again.T41_max, sweep(GRID, ["T41_max"], links=light).T41_max)
    with pytest.warns(fl.InputWarning, match="density, radius"):
        assert "density" not in sweep(whole).coords
    with pytest.warns(fl.InputWarning, match="T41_max, status"):
        again = sweep(whole, ["T41_max"], links=fl.round_bar())
    xr.testing.assert_equal(again.T41_max, whole.T41_max)


def test_only_results_are_ignored():
    table = {"a2": [1.1, 1.2], "a3": 0.8, **FIXED}
    with pytest.warns(fl.InputWarning, match="omega4_rms"):
        assert sweep({**table, "omega4_rms": [1.0, 2.0]}).attrs["design_ignored"] == "omega4_rms"
    with refused("omgea1", "did you mean 'omega1'? Or pass keep=['omgea1']"):
        sweep({**table, "omgea1": [1.0, 2.0]})
    with refused("omega4", "did you mean"):  # a grid is written by hand
        sweep(fl.grid(a2=1.1, a3=0.8, omega4=[1.0, 2.0], **FIXED))
    for name in ("branch", "theta1", "theta1_deg"):
        for space in ({**table, name: [1.0, 2.0]}, fl.grid(a2=1.1, a3=0.8, **{name: [1.0, 2.0]}, **FIXED)):
            with refused(name, "as an option of the sweep"):
                sweep(space)


LABELS = pd.DataFrame(
    {"a2": [1.1, 1.2, 5.0], "a3": 0.8, **FIXED, "maker": ["Müller", "", "B & C"]},
    index=pd.Index(["P1", "P2", "P3"], name="part"),
)


def test_labels_are_coordinates_in_memory_and_in_files(tmp_path):
    plain = sweep(LABELS.reset_index(drop=True).drop(columns="maker"))
    memory = sweep(LABELS)
    with sweep(LABELS, to=tmp_path / "map.h5", block=2, verify=2) as file:
        for result in (memory, file):
            assert result.part.values.tolist() == ["P1", "P2", "P3"]
            assert result.maker.values.tolist() == ["Müller", "", "B & C"]
            assert (
                result.omega4_max.set_index(design="part").sel(design="P2", branch=1)
                == plain.omega4_max[1, 0]
            )
            assert_array_equal(result.omega4_max, plain.omega4_max)
            assert "P1" in contents(result)
            assert result.omega4_max.to_dataframe().maker.iloc[0] == "Müller"
        xr.testing.assert_equal(memory, file)
    with xr.open_dataset(tmp_path / "map.h5", engine="netcdf4") as other:
        assert other.part.values.tolist() == ["P1", "P2", "P3"]
        assert other.omega4_max.dims == ("design", "branch")
    with sweep(LABELS, to=tmp_path / "map.h5", verify=2) as again:  # up to date
        assert again.attrs["written_time_ns"] == file.attrs["written_time_ns"]
    with refused("map.h5"):
        sweep(LABELS.assign(maker="x"), to=tmp_path / "map.h5")


def test_names_of_designs_as_their_dimension():
    dataset = xr.Dataset({"a2": ("design", [1.1, 1.2])}, coords={"design": ["P1", "P2"], "a3": 0.8, **FIXED})
    result = sweep(dataset)
    assert float(result.omega4_max.sel(design="P2", branch=1)) > 0.0
    picture = fl.plot(result, "omega4_max")
    assert [text.get_text() for text in picture.axes[0].get_xticklabels()] == ["P1", "P2"]


def test_a_map_is_swept_again_by_its_path(tmp_path):
    path = tmp_path / "maps.h5"
    sweep(GRID, to=path).close()
    with IGNORED:
        again = sweep(path, ["transmission_angle_min"])
    assert again.transmission_angle_min.dims == ("a2", "a3", "branch")
    with refused("maps.h5", "fastlink.open"):
        fl.table(path)
    (tmp_path / "other.csv").write_bytes(path.read_bytes()[:100])
    with refused("other.csv", "a map that a sweep has written"):
        sweep(tmp_path / "other.csv")


# == An axis that only scales results is multiplied, not evaluated again =====================================

PLANAR_SCALED = catalogue("planar_4r")
NAMES_SCALED = ["omega4", "T41_rms", "omega4_max"]
NAMES_SCALED += ["alpha4_extrema", "theta1_at_shaking_force_max", "shaking_force_max"]
COUPLERS, OUTPUTS = np.linspace(1.0, 1.4, 9), np.linspace(0.6, 1.0, 11)
# Powers of two scale without rounding: rates by omega1, forces by its square.
SPEEDS = np.array([0.5, 1.0, 8.0])


def sweep_scaled(quantities=NAMES_SCALED, mechanism="planar_4r", links=BARS, **given):
    options = {
        key: given.pop(key)
        for key in ("to", "block", "threads", "overwrite", "solver", "verify")
        if key in given
    }
    return sweep_both(mechanism, fl.grid(**given), quantities, links=links, theta1=12, **options)


@pytest.mark.sample(3)
@pytest.mark.parametrize("order", [("omega1", "a2", "a3"), ("a2", "omega1", "a3"), ("a2", "a3", "omega1")])
@pytest.mark.parametrize("block", [None, 1, 7, 64])
def test_a_speed_axis_has_the_bits_of_its_speeds(order, block, tmp_path):
    axes = {"omega1": SPEEDS, "a2": COUPLERS, "a3": OUTPUTS}
    options = {} if block is None else {"to": tmp_path / "speeds.h5", "verify": 0}
    together = sweep_scaled(a1=0.4, a4=1.0, **{name: axes[name] for name in order}, block=block, **options)
    assert together.attrs["scaling_axis"] == "omega1"
    assert together.attrs["designs"] == 3 * 9 * 11
    meanings = together.status.attrs["flag_meanings"].split()
    counts = [together.attrs[f"designs_{meaning}"] for meaning in meanings]
    assert counts == np.bincount(together.status.values.ravel(), minlength=len(meanings)).tolist()
    for speed in SPEEDS:
        alone = sweep_scaled(a1=0.4, a4=1.0, **(axes | {"omega1": float(speed)}))
        assert "scaling_axis" not in alone.attrs
        for name in alone:
            expected = alone[name].transpose(*(dim for dim in together[name].dims if dim != "omega1"))
            assert_array_equal(together[name].sel(omega1=speed), expected, err_msg=name)
    together.close()


def test_any_speed_is_within_rounding():
    names, lengths = ["shaking_force_max", "omega4_max"], CRANK | {"a2": COUPLERS}
    together = sweep_scaled(names, **lengths, omega1=[3.0, 7.0, 25.0])
    for speed in together.omega1.values:
        alone = sweep_scaled(names, **lengths, omega1=float(speed))
        for name in names:
            # Extremes of size do not cancel: both ways are within 4 (1 + 2) roundings, by the power of omega1.
            assert_allclose(together[name].sel(omega1=speed), alone[name], rtol=2 * 12 * UNIT_ROUNDING)


@pytest.mark.parametrize(
    ("given", "names"),
    [
        ({"omega1": [-1.0, 2.0]}, ["omega4_max"]),
        ({"omega1": [0.0, 2.0]}, ["omega4_max"]),
        ({"omega1": [1.0, 2.0], "gravity_y": -9.81}, ["T41_max"]),
        ({"omega1": 2.0, "a2": [1.1, 1.2]}, ["omega4_max"]),
        ({"omega1": [1.0, 2.0]}, ["omega4", "omega4_error"]),
        ({"omega1": 2.0, "P_u": [0.1, 0.2], "P_v": 0.1}, ["P_x_max"]),
    ],
)
def test_no_axis_is_used_that_does_more_than_scale(given, names):
    space = fl.grid(**{"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0, **given})
    assert resolve("planar_4r", space, names, links=BARS, branch=(1, 2)).scaling_axis is None


@pytest.mark.parametrize(
    ("name", "chosen", "expected"),
    [
        (
            "omega1",
            (),
            {"omega2": 1, "jerk4": 3, "F32": 2, "input_power": 3, "theta2": 0, "status": 0, "curvature": 0},
        ),
        ("density", ("gravity", "round_bar"), {"omega2": 0, "F32": 1, "T41": 1, "shaking_moment": 1}),
        ("omega1", ("gravity",), {"T41": None, "F32": None, "omega4": 1}),
        ("a1", (), {"A_x": 1, "omega4": None, "status": None}),
    ],
)
def test_degrees(name, chosen, expected):
    of_bars = PLANAR_SCALED.variants["round_bar"] if "round_bar" in chosen else {}
    inputs = [key for key in PLANAR_SCALED.known_inputs(chosen) if key not in of_bars]
    leaves = (*inputs, *PLANAR_SCALED.tables, *PLANAR_SCALED.table_low_parts, "branch", "theta1")
    result = homogeneity_degrees(PLANAR_SCALED.dependencies(expected, leaves, chosen), name)
    assert {key: result[key] for key in expected} == expected


@pytest.mark.parametrize("inner", [1, 4])
def test_every_cut_delivers_each_design_once(inner):
    length, slabs = 3, 5
    space = fl.grid(a1=np.arange(1.0, slabs + 1), a2=np.arange(1.0, inner + 1))
    axis = ScalingAxis("omega1", space, inner, (None,), length)
    numbers = np.arange(float(slabs * inner))
    whole = np.repeat(numbers.reshape(slabs, 1, inner), length, axis=1).ravel()
    for block in range(1, slabs * inner + 1):
        result = np.full(whole.size, np.nan)

        def take(start, stop, arrays, result=result):
            assert np.isnan(result[start:stop]).all()
            result[start:stop] = arrays[0]

        sink = axis.over(take)
        for start in range(0, numbers.size, block):
            stop = min(start + block, numbers.size)
            sink(start, stop, [numbers[start:stop]])
        assert_array_equal(result, whole)

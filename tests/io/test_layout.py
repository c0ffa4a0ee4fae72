"""The two layouts of a map: the same numbers, in other places."""

import itertools
import sys
from dataclasses import replace
from types import SimpleNamespace

import h5py
import netCDF4
import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_array_equal
from tests.io.test_resume import RUNS
from tests.support.refusals import refused
from tests.support.study_files import BARE
from tests.support.sweeps import sweep_4r, sweep_both
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.engine.resolve import resolve
from fastlink.engine.sinks import designs_per_block, needs_of
from fastlink.engine.sweep import Evaluation
from fastlink.io.layout import Placement, Variable, assemble, coordinates, plain_attrs
from fastlink.io.output_path import progress_bar
from fastlink.pictures.maps import select
from fastlink.space.samplers import grid
from fastlink.space.tables import table

LENGTHS = {"a1": 0.4, "a2": np.linspace(1.0, 1.4, 13), "a3": np.linspace(0.6, 1.0, 7), "a4": 1.0}
SPEEDS = {"omega1": np.array([1.0, 5.0, 25.0])}
#: Grids; the input that only scales leads, or is the last axis.
SPACES = {
    "lengths": fl.grid(**LENGTHS, omega1=2.0),
    "speeds last": fl.grid(**LENGTHS, **SPEEDS),
    "speeds first": fl.grid(**SPEEDS, **LENGTHS),
    "one axis": fl.grid(**LENGTHS | {"a3": 0.8}, omega1=2.0),
    "sample": fl.sobol(50, a1=0.4, a2=(1.0, 1.4), a3=(0.6, 1.0), a4=1.0, omega1=2.0),
}
NAMES = ["omega4_max", "theta4", "omega4_extrema", "grashof_class"]


def sweep(to, space=SPACES["lengths"], **options):
    return fl.sweep(
        "planar_4r",
        space,
        NAMES,
        **{"theta1": 5, "threads": 1, "verify": 0, "to": to, "branch": (1, 2), **options},
    )


def assert_same(found, expected, same_labels=True):
    """Assert that two maps have the same values by name, whatever the order of dimensions, and the same labels."""
    assert set(found) == set(expected)
    for name in expected:
        turned = found[name].transpose(*expected[name].dims)
        assert_array_equal(turned, expected[name], err_msg=name)
        labels = [{key: str(value) for key, value in one.attrs.items()} for one in (turned, expected[name])]
        assert labels[0] == labels[1] or not same_labels
    counts = [name for name in expected.attrs if name.startswith("designs_") and "second" not in name]
    assert {name: found.attrs[name] for name in counts} == {name: expected.attrs[name] for name in counts}


@pytest.mark.sample(2)
@pytest.mark.parametrize("space", SPACES.values(), ids=SPACES)
def test_both_layouts_hold_the_same_numbers(tmp_path, space):
    path = tmp_path / "maps.h5"
    with sweep(None, space, verify=2) as expected:
        for options in ({"verify": 2, "threads": 2}, {"block": 5, "threads": 2}, {"block": 10**6}):
            with sweep(path, space, layout="maps", overwrite=True, **options) as found:
                assert_same(found, expected, "verify" in options)
                assert found.theta4.dims == ("branch", "theta1", *space.dims)
                assert found.omega4_max.dims == ("branch", *space.dims)
                assert found.status.dims == space.dims
                assert fl.check(path)
        kept = sweep(None, space, layout="maps")
        assert [one.dims for one in kept.values()] == [found[name].dims for name in kept]
        assert_same(kept, expected, same_labels=False)


def test_a_map_of_one_position_is_one_piece_of_the_file(tmp_path):
    path = tmp_path / "maps.h5"
    with sweep(path, layout="maps", branch=1) as found:
        picture = found.theta4.isel(theta1=3)
        with h5py.File(path) as file:
            start = file["theta4"].id.get_offset() + 3 * picture.nbytes
        raw = np.frombuffer(path.read_bytes()[start : start + picture.nbytes])
        assert_array_equal(raw.reshape(picture.shape), picture)


def test_a_map_of_the_other_layout_is_refused_by_name(tmp_path):
    path = tmp_path / "m.h5"
    sweep(path).close()
    with refused("to", "overwrite=True"):
        sweep(path, layout="maps")
    with pytest.raises(fl.InputError, match="other layout"):
        sweep(path, layout="maps")
    before = path.stat().st_mtime_ns
    sweep(path).close()
    assert path.stat().st_mtime_ns == before
    sweep(path, layout="maps", overwrite=True).close()
    sweep(path, layout="maps").close()


def test_a_study_and_the_command_line_choose_the_layout(tmp_path):
    study = tmp_path / "study.toml"
    design = "[design]\na1 = 0.4\na2 = {linspace = [1.0, 1.4, 3]}\na3 = 0.8\na4 = 1.0\n"
    study.write_text(
        f'{BARE}{design}[cycle]\ntheta1 = 4\nbranch = [1, 2]\n[output]\nlayout = "maps"\nverify = 0\n'
    )
    with fl.run(study, to=tmp_path / "a.h5") as found:
        assert found.theta4.dims == ("branch", "theta1", "a2")
    with fl.run(study, to=tmp_path / "b.h5", layout="curves") as found:
        assert found.theta4.dims == ("a2", "branch", "theta1")
    study.write_text(study.read_text().replace('"maps"', '"map"'))
    with refused("output.layout", '"curves" or "maps"'):
        fl.run(study, to=tmp_path / "c.h5")
    with refused("layout", "maps"):
        fl.run(study, to=tmp_path / "c.h5", layout="map")
    with refused("layout", "maps"):
        sweep(None, layout="map")
    study.write_text(study.read_text().replace('layout = "map"\n', ""))
    command = ["run", str(study), "--to", str(tmp_path / "c.h5"), "--layout", "maps", "--quiet"]
    assert CliRunner().invoke(app, command).exit_code == 0
    with fl.open(tmp_path / "c.h5") as found:
        assert found.theta4.dims == ("branch", "theta1", "a2")


def test_functions_of_maps_read_both_layouts(tmp_path):
    space = fl.grid(a=np.linspace(4.5, 5.5, 3), b=5.0, c=2.0, d=4.0, rho=1.0, completion=1)
    given = {"input": "sigma", "sigma": np.linspace(3.3, 6.0, 9), "verify": 0, "to": tmp_path / "curves.h5"}
    curves = sweep_both("focal", space, ["T_x", "T_y"], **given)
    maps = sweep_both(
        "focal", space, ["T_x", "T_y"], **given | {"layout": "maps", "to": tmp_path / "maps.h5"}
    )
    with curves, maps:
        deviations = [fl.focal.T_deviation(one) for one in (maps, curves)]
        assert_array_equal(deviations[0].transpose(*deviations[1].dims), deviations[1])
        best = [one.fastlink.top(4, "T_x").drop_attrs() for one in (maps, curves)]
        assert best[0].equals(best[1])
        again = sweep_both("focal", maps.fastlink.designs, ["T_x"], input="sigma", sigma=given["sigma"])
        assert_array_equal(again.T_x, curves.T_x)
        drawn = [select(one, "T_x", 1, {"sigma": 4.0}).variable for one in (maps, curves)]
        assert_array_equal(drawn[0].transpose(*drawn[1].dims), drawn[1])


def test_memory_of_blocks_that_are_put_in_order_is_counted():
    space = fl.grid(**LENGTHS | {"a2": np.linspace(1.0, 1.4, 4000)}, omega1=2.0)
    options = {"angles": 360, "positions": {}, "options": ("theta1",)}
    curves = resolve("planar_4r", space, ["theta4", "omega4"], **{"branch": (1, 2)} | options)
    maps = replace(curves, layout="maps")
    longer = designs_per_block(maps, 2) / designs_per_block(curves, 2)
    assert 7 < longer <= 9
    needs = [needs_of(one, 2).buffers for one in (curves, maps)]
    row = 2 * 2 * 360 * 8
    # results of a block, and one of the two in its other order, on each of two threads
    assert needs[1] - needs[0] >= 2 * row * (1.5 * designs_per_block(maps, 2) - designs_per_block(curves, 2))


def test_pieces_and_designs_of_bytes_agree():
    """Each byte of a piece is of the designs that the piece was made for."""
    for rows, values, by_value in itertools.product((1, 2, 7), (1, 3), (False, True)):
        placement = Placement(rows, values, 8, by_value=by_value)
        owner = {}
        for row in range(rows):
            for start, count in placement.pieces(row, row + 1):
                owner |= dict.fromkeys(range(start, start + count), row)
        assert sorted(owner) == list(range(rows * values * 8))
        for start, stop in itertools.combinations(range(0, rows * values * 8 + 1, 4), 2):
            designs = {row for first, last in placement.rows_in(start, stop) for row in range(first, last)}
            assert designs == {owner[byte] for byte in range(start, stop)}
        for start, stop in itertools.combinations(range(rows + 1), 2):
            found = {
                at for first, count in placement.pieces(start, stop) for at in range(first, first + count)
            }
            assert found == {byte for byte, row in owner.items() if start <= row < stop}


# == Coordinates that are computed block by block are written so: equal to those in memory ===================

NAMES_COMPUTED = ["omega4_max", "transmission_angle_min"]
#: Of the runs that may be interrupted: those with consecutive designs, and a whole grid.
SPACES_COMPUTED = {name: RUNS[name][0] for name in RUNS if name == "grid" or "consecutive" in name}


def sweep_computed(space, **options):
    return sweep_4r(space, NAMES_COMPUTED, **{"verify": 1, "block": 16, "threads": 2, **options})


def without_times(maps):
    times = ("time", "per_second", "fingerprint", "threads", "history")
    attrs = {name: value for name, value in maps.attrs.items() if not any(word in name for word in times)}
    return maps.assign_attrs(attrs).drop_attrs(deep=False).assign_attrs(attrs)


@pytest.mark.parametrize("space", SPACES_COMPUTED.values(), ids=SPACES_COMPUTED)
def test_a_file_is_equal_to_the_result_in_memory(tmp_path, space):
    path = tmp_path / "m.h5"
    expected = sweep_computed(space)
    with sweep_computed(space, to=path) as maps:
        xr.testing.assert_identical(without_times(maps), without_times(expected))
    assert fl.check(path)
    with netCDF4.Dataset(path) as file:
        for name, coord in expected.coords.items():
            assert file[name].dimensions == coord.dims
            assert_array_equal(file[name][...], coord.values)
            assert all(file[name].getncattr(key) == value for key, value in coord.attrs.items())
    with sweep_computed(space, to=path) as again:  # the same request: the file is opened as it is
        assert again.attrs["fingerprint"] == fl.open(path).attrs["fingerprint"]


def test_every_value_is_written_once_whatever_the_blocks():
    rng = np.random.default_rng(0)
    for rows, shared in [(100, 1), (100, 2), (12, 3), (7, 7)]:
        placement = Placement(rows, 1, 8, by_value=False, shared=shared)
        cuts = [0, *np.sort(rng.integers(0, rows, 6)).tolist(), rows]
        found = [k for start, stop in itertools.pairwise(cuts) for k in range(*placement.own(start, stop))]
        assert found == list(range(rows // shared))
        for k in found:
            ((first, last),) = placement.rows_in(8 * k, 8 * k + 8)
            assert placement.pieces(first, last) == [(8 * k, 8)]


def test_a_file_needs_no_memory_for_them():
    axis = np.linspace(1.0, 1.2, 2155)  # 2155^3 > 10^10
    space = fl.grid(a2=axis, a3=axis - 0.3, a4=axis, a1=0.4)
    part = space.consecutive(10**9, 9 * 10**9)
    resolved = resolve("planar_4r", part, ["grashof_class"], branch=(1, 2))
    evaluation = Evaluation(resolved, {}, 2, None, 0, in_memory=False)
    assert sum(variable.nbytes for variable, _ in evaluation.columns) == 8 * 10**9 * 8 * 4
    assert "a2" not in evaluation._coordinates()
    assert "design" not in evaluation._coordinates()


# == Labels: coordinates of every kind of design space, and the Dataset of a sweep in memory =================

METRE = {"units": "m", "long_name": "length", "symbol": "a"}
DESCRIBED = dict.fromkeys(["a1", "a2", "a3", "a4"], METRE)
BRANCH = {"branch": (("branch",), np.array([1, 2], dtype="i1"), {"long_name": "assembly mode"})}


def test_axes_and_columns_are_coordinates_and_constants_scalars():
    coords = coordinates(grid(a1=0.4, a2=[1.0, 2.0], a3=[3.0, 4.0, 5.0]), DESCRIBED, BRANCH)
    assert dict(coords.sizes) == {"a2": 2, "a3": 3, "branch": 2}
    assert set(coords.indexes) == {"a2", "a3", "branch"}
    assert not coords.data_vars
    assert_array_equal(coords["a3"], [3.0, 4.0, 5.0])
    assert coords["a1"].dims == ()
    assert float(coords["a1"]) == 0.4
    assert coords["a1"].attrs == coords["a2"].attrs == METRE
    assert coords["branch"].attrs == {"long_name": "assembly mode"}
    assert coords.attrs == {"design_kind": "grid"}
    coords = coordinates(table({"a1": [0.4, 0.4, 0.6], "a4": 1.0}), DESCRIBED, {})
    assert dict(coords.sizes) == {"design": 3}
    assert set(coords.indexes) == {"design"}
    assert coords["design"].dtype.kind == "i"
    assert_array_equal(coords["design"], [0, 1, 2])
    assert coords["a1"].dims == ("design",)
    assert_array_equal(coords["a1"], [0.4, 0.4, 0.6])
    assert coords["a1"].attrs == METRE
    assert coords.attrs == {"design_kind": "table"}


def test_assemble_refuses_what_does_not_fit():
    coords = coordinates(grid(a1=0.4, a2=[1.0, 2.0]), DESCRIBED, {})

    def attempt(name, dims, shape, dtype="f8"):
        assemble(
            coords, [Variable(name, dims, shape, np.dtype("f8"), {})], {name: np.zeros(shape, dtype)}, {}
        )

    attempt("x", ("a2",), (2,))
    with pytest.raises(ValueError, match="x: 3 along 'a2', its coordinate 2"):
        attempt("x", ("a2",), (3,))
    with pytest.raises(ValueError, match="x: 2 along 'branch', its coordinate None"):
        attempt("x", ("branch",), (2,))
    with pytest.raises(ValueError, match="a1: a coordinate has that name"):
        attempt("a1", ("a2",), (2,))
    with pytest.raises(TypeError, match="x: values are float32, not float64"):
        attempt("x", ("a2",), (2,), "f4")


def test_a_variable_knows_its_size_and_coordinates_do_not_hide_inputs():
    assert Variable("x", ("a", "b"), (3, 5), np.dtype("f4"), {}).nbytes == 60
    assert Variable("x", (), (), np.dtype("f8"), {}).nbytes == 8
    with pytest.raises(ValueError, match=r"x: dimensions \('a',\) but shape \(3, 5\)"):
        Variable("x", ("a",), (3, 5), np.dtype("f8"), {})
    with pytest.raises(TypeError, match="x: dtype bool is neither integer nor floating point"):
        Variable("x", ("a",), (3,), np.dtype(bool), {})
    with pytest.raises(ValueError, match="'a1' is an input of the design space already"):
        coordinates(grid(a1=0.4), DESCRIBED, {"a1": ((), np.array(1.0), {})})


def test_attributes_are_plain():
    plain = plain_attrs({"t": "text", "b": True, "n": np.int8(3), "f": 0.5, "l": [1, 2]})
    assert [type(value) for value in plain.values()] == [str, int, np.int8, float, np.ndarray]


@pytest.mark.parametrize("value", [None, {"a": 1}, [], ["a", "b"], [[1, 2]], b"bytes"])
def test_other_attributes_are_refused(value):
    with pytest.raises(
        TypeError, match=r"attribute 'x': .* is neither text nor a number nor a list of numbers"
    ):
        plain_attrs({"x": value})


# == Where a progress bar is shown ===========================================================================


class ZMQInteractiveShell:
    """Stands for the shell of a notebook."""


@pytest.mark.parametrize("shell", [None, SimpleNamespace(), ZMQInteractiveShell()])
def test_a_notebook_has_a_bar_without_being_asked(shell, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    bar = progress_bar(10, " designs", None)
    assert (bar is not None) == isinstance(shell, ZMQInteractiveShell)
    if bar is not None:
        bar.update(10)
        bar.close()
        assert "10.0/10.0" in "".join(capsys.readouterr())
    assert progress_bar(10, " designs", False) is None

"""A converted map holds what it says, of the map that it names."""

import errno
import fcntl
import functools
import os
import shutil
import subprocess
import sys
import tracemalloc
import warnings

import h5py
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from numpy.testing import assert_allclose, assert_array_equal
from pyarrow import parquet
from tests.support.map_files import digest, left_in, raising
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.io import checksums, convert, partial_file, where

QUANTITIES = ["theta4", "omega4_max", "transmission_angle_min", "omega4_error", "grashof_class"]
#: What each format holds of a map as it is: all of it.
WHOLE = {
    "plain.h5": {},
    "plain.nc": {},
    "gzip.nc": {"compress": "gzip"},
    "zstd.h5": {"compress": "zstd:3"},
    "blosc.h5": {"compress": "blosc"},
    "lz4.h5": {"compress": "lz4"},
    "plain.zarr": {},
    "gzip.zarr": {"compress": "gzip:1"},
    "zstd.zarr": {"compress": "zstd:9"},
    "blosc.zarr": {"compress": "blosc:1"},
    "lz4.zarr": {"compress": "lz4"},
}


def sweep(space, path, **options):
    given = {"angles": 24, "verify": 8, "overwrite": True, "threads": 1} | options
    sweep_4r(space, QUANTITIES, to=path, **given).close()
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("maps")


@pytest.fixture(scope="module")
def grid(folder):
    axes = {"a1": [0.4, 0.5, 1.5], "a2": np.linspace(1.0, 1.4, 5), "a3": 0.8, "a4": 1.0, "omega1": 25.0}
    return sweep(fl.grid(**axes), folder / "grid.h5")


@pytest.fixture(scope="module")
def sampled(folder):
    return sweep(fl.sobol(32, a1=(0.4, 0.5), a2=(1.0, 1.2), a3=0.8, a4=1.0, omega1=25.0), folder / "sobol.h5")


@pytest.fixture
def small_blocks(monkeypatch):
    """Blocks and chunks as small as those of a large map are to it."""
    monkeypatch.setattr(convert, "BLOCK_BYTES", 20_000)
    monkeypatch.setattr(convert, "CHUNK_BYTES", 2000)


def loaded(path):
    with fl.open(path) as maps:
        return maps.load()


@functools.cache
def whole(path):
    """Return a map that is converted again and again."""
    return loaded(path)


def assert_same(one, other):
    """Assert the same variables, coordinates, bits, types and labels."""
    xr.testing.assert_identical(one.drop_attrs(), other.drop_attrs())
    assert {name: array.dtype for name, array in one.variables.items()} == {
        name: array.dtype for name, array in other.variables.items()
    }
    for name, array in other.variables.items():
        for key, value in array.attrs.items():
            assert_array_equal(one[name].attrs[key], value)


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("kind", "name"), [*(("grid", name) for name in WHOLE), ("sampled", "plain.h5"), ("sampled", "gzip.zarr")]
)
def test_a_whole_map_comes_through_every_format(request, tmp_path, small_blocks, name, kind):
    path = request.getfixturevalue(kind)
    before = digest(path)
    made = fl.convert(path, tmp_path / name, **WHOLE[name])
    assert left_in(tmp_path) == [name]
    assert made == tmp_path / name
    converted = loaded(made)
    assert_same(converted, whole(path))
    assert converted.designs == whole(path).designs
    assert "fingerprint" not in converted.attrs
    assert f"convert {path.name} --to {name}" in converted.history.splitlines()[-1]
    assert "of 32" in fl.open(made).fastlink.summary() or "of 8" in fl.open(made).fastlink.summary()
    assert digest(path) == before


def test_compressed_chunks_are_in_the_file_and_uncompressed_values_are_not(grid, tmp_path, small_blocks):
    for name, filters in (("z.h5", [2, 32015]), ("g.nc", [2, 1]), ("p.h5", [])):
        options = {"z.h5": {"compress": "zstd"}, "g.nc": {"compress": "gzip"}, "p.h5": {}}[name]
        with h5py.File(fl.convert(grid, tmp_path / name, **options)) as file:
            plist = file["theta4"].id.get_create_plist()
            assert [plist.get_filter(k)[0] for k in range(plist.get_nfilters())] == filters
            assert (file["theta4"].chunks is None) == (name == "p.h5")


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["a.h5", "z.h5", "g.nc"])
def test_checksums_of_a_converted_file_are_its_own(grid, tmp_path, name):
    path = fl.convert(
        grid, tmp_path / name, compress=None if name == "a.h5" else "gzip", select={"a2": "#1:"}
    )
    assert fl.check(path)
    content = bytearray(path.read_bytes())
    with h5py.File(path) as file:
        dataset = file["theta4"].id
        place = dataset.get_offset() if name == "a.h5" else dataset.get_chunk_info(0).byte_offset
    content[place + 3] ^= 4
    path.write_bytes(content)
    assert not fl.check(path)
    assert ("theta4" if name == "a.h5" else "values") in str(fl.check(path))


SELECTIONS = {
    "a range with both ends": ({"a2": "1.1:1.2"}, {"a2": slice(1, 3)}),
    "a pair": ({"a2": (1.1, 1.2)}, {"a2": slice(1, 3)}),
    "no lower end": ({"a2": ":1.2"}, {"a2": slice(0, 3)}),
    "no upper end": ({"a2": (1.2, None)}, {"a2": slice(2, 5)}),
    "a value": ({"a1": 0.5}, {"a1": 1}),
    "a value as text": ({"a1": "0.5"}, {"a1": 1}),
    "a number": ({"a2": "#3"}, {"a2": 3}),
    "the last": ({"a2": "#-1"}, {"a2": 4}),
    "numbers": ({"a2": "#1:4"}, {"a2": slice(1, 4)}),
    "every fifth": ({"theta1": "#::5"}, {"theta1": slice(0, 24, 5)}),
    "every one": ({"a2": "#::1"}, {}),
    "degrees": ({"theta1_deg": "90:180"}, {"theta1": slice(6, 13)}),
    "an angle in degrees": ({"theta1_deg": 270}, {"theta1": 18}),
    "an assembly mode": ({"branch": 2}, {"branch": 1}),
    "several": ({"a1": "0.45:2", "a2": "#::2", "theta1": "#::7", "branch": "1"},
                {"a1": slice(1, 3), "a2": slice(0, 5, 2), "theta1": slice(0, 24, 7), "branch": 0}),
    "a constant": ({"a3": 0.8, "a4": "0.9:1.1"}, {}),
}  # fmt: skip


@pytest.mark.parametrize("name", SELECTIONS)
def test_a_selection_is_that_of_xarray(grid, name):
    given, indexers = SELECTIONS[name]
    taken = where.selected(whole(grid), given)
    xr.testing.assert_identical(whole(grid).isel(taken.indexers), whole(grid).isel(indexers))
    sizes = {dim: taken.size(dim, size) for dim, size in whole(grid).sizes.items()}
    assert sizes == {**dict.fromkeys(sizes, 1), **whole(grid).isel(indexers).sizes}


ONE = {"a1": "#1", "a2": "#2", "theta1": "#3", "branch": "1"}


@pytest.mark.sample(1)
@pytest.mark.parametrize(("name", "ending"), [("several", "h5"), ("several", "zarr"), ("a constant", "h5")])
def test_a_part_counts_its_own_designs(grid, tmp_path, small_blocks, name, ending):
    given, indexers = SELECTIONS[name]
    expected = whole(grid).isel(indexers)
    part = loaded(fl.convert(whole(grid), tmp_path / f"part.{ending}", select=given))
    xr.testing.assert_identical(part.drop_attrs(), expected.drop_attrs())
    assert part.designs == expected.status.size
    # the status is that of each design
    codes = zip(part.status.flag_meanings.split(), np.atleast_1d(part.status.flag_values), strict=True)
    for meaning, code in codes:
        assert part.attrs[f"designs_{meaning}"] == int((expected.status == code).sum())
    modes, angles = expected.sizes.get("branch", 1), expected.sizes.get("theta1", 1)
    assert part.configurations == part.designs * modes * angles
    assert part.theta1_count == angles


def test_a_workbook_has_the_numbers_and_says_what_they_are(tmp_path):
    maps = fl.sweep(
        "planar_4r", fl.grid(a1=[0.4, 0.9], a2=1.2, a3=0.8, a4=1.0, omega1=1.0), ["omega4_max", "status"]
    )
    path = fl.convert(maps, tmp_path / "out.xlsx")
    table = pd.read_excel(path)
    assert table.a1.tolist() == [0.4, 0.9]
    # a rate is infinite at a toggle, which Excel has no number for
    assert_allclose(table.omega4_max.astype(float), maps.omega4_max, rtol=1e-15)
    about = pd.read_excel(path, sheet_name="columns", index_col=0)
    assert about.units["omega4_max"] == "rad s-1"
    assert about.meaning["omega4_max"] == maps.omega4_max.attrs["long_name"]
    assert about.meaning["mechanism"] == "planar_4r"
    assert left_in(tmp_path) == ["out.xlsx"]


def test_too_many_rows_and_rows_of_two_kinds_are_refused(grid, tmp_path, monkeypatch):
    monkeypatch.setattr("fastlink.io.convert.MOST_ROWS", 100)
    with refused("to", "write a .csv"):
        fl.convert(grid, tmp_path / "out.xlsx")
    assert left_in(tmp_path) == []
    space = fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0, omega1=25.0)
    maps = sweep_4r(space, ["theta4", "omega4_extrema"], angles=8)
    with refused("quantities", "choose"):
        fl.convert(maps, tmp_path / "out.csv")
    fl.convert(maps, tmp_path / "out.csv", quantities=["theta4"])
    assert len(pd.read_csv(tmp_path / "out.csv")) == 2 * 2 * 8


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["one.h5", "gzip.h5", "one.zarr", "one.csv", "one.parquet", "one.xlsx"])
def test_a_single_configuration_is_converted(grid, tmp_path, name):
    path = converted(grid, tmp_path / name, select=ONE)
    if name.endswith(("csv", "parquet", "xlsx")):
        read = {".csv": pd.read_csv, ".parquet": pd.read_parquet, ".xlsx": pd.read_excel}[path.suffix]
        table = read(path)
        # a workbook holds 16 digits
        digits = 1e-15 if name.endswith("xlsx") else 0.0
        assert table.theta4.item() == pytest.approx(
            whole(grid).theta4.values[1, 2, 0, 3], rel=digits, abs=0.0
        )
    else:
        xr.testing.assert_identical(
            loaded(path).drop_attrs(), whole(grid).isel(a1=1, a2=2, branch=0, theta1=3).drop_attrs()
        )


def test_columns_select_designs(sampled, tmp_path, small_blocks):
    maps = whole(sampled)
    chosen = ((maps.a1 >= 0.42) & (maps.a1 <= 0.47) & (maps.a2 <= 1.1)).values
    part = loaded(fl.convert(sampled, tmp_path / "part.h5", select={"a1": "0.42:0.47", "a2": ":1.1"}))
    assert 0 < chosen.sum() < chosen.size
    xr.testing.assert_identical(part.drop_attrs(), maps.isel(design=chosen).drop_attrs())
    # these designs are no Sobol' points
    assert part.design_kind == "table"
    assert not [name for name in part.attrs if name.startswith("design_") and name != "design_kind"]
    assert (part.source_design_kind, part.source_design_n) == ("sobol", 32)
    again = sweep_4r(part.fastlink.designs, QUANTITIES, angles=24)
    assert_array_equal(again.theta4, part.theta4)


def test_attributes_of_a_part_are_not_those_of_the_whole(grid, tmp_path):
    path = fl.convert(grid, tmp_path / "part.h5", select={"a2": "1.1:1.2"}, quantities=["theta4"])
    part = loaded(path)
    assert list(part.data_vars) == ["theta4", "status"]
    assert part.title.endswith(": theta4, status")
    assert part.selection == "a2=1.1:1.2"
    of_run = ("run_time_s", "verified_designs", "verify_")
    of_run += ("designs_per_second", "fingerprint", "written_time_ns")
    assert not [name for name in part.attrs if name.startswith(of_run)]
    assert part.source_verified_designs == 8
    assert "verified_values" not in part.theta4.attrs
    assert part.theta4.source_verified_values == whole(grid).theta4.verified_values
    assert "of the whole map" in fl.open(path).fastlink.summary()


def test_a_rerun_does_not_take_a_converted_file_for_its_map(tmp_path):
    space = fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0)
    request = "planar_4r", space, ["transmission_angle_min"]
    fl.sweep(*request, to=tmp_path / "whole.h5", verify=0, branch=(1, 2)).close()
    fl.sweep(*request, to=tmp_path / "whole.h5", verify=0, branch=(1, 2)).close()  # taken for what it is
    for options in ({}, {"select": {"a2": "1.1"}}, {"dtype": "float32"}, {"compress": "gzip"}):
        fl.convert(tmp_path / "whole.h5", tmp_path / "other.h5", overwrite=True, **options)
        before = digest(tmp_path / "other.h5")
        with refused("to", "overwrite=True"):
            fl.sweep(*request, to=tmp_path / "other.h5", verify=0, branch=(1, 2))
        assert digest(tmp_path / "other.h5") == before


def test_rounding_is_as_the_attributes_say(grid, tmp_path):
    maps, part = whole(grid), loaded(fl.convert(grid, tmp_path / "f4.nc", dtype="float32"))
    # half an ulp of a binary number of 24 bits
    unit = 2.0**-24
    for name, array in part.data_vars.items():
        values = maps[name].values
        if values.dtype.kind != "f":
            assert array.dtype == values.dtype
            assert_array_equal(array, values)
            continue
        assert array.dtype == np.float32
        assert "float32" in array.rounding
        if name.endswith("_error"):
            known = ~np.isnan(values)
            assert_array_equal(np.isnan(array), ~known)
            assert (array.values >= values)[known].all()  # what bounds errors still does
            assert (array.values <= values * (1 + 2 * unit))[known].all()
        else:
            assert_array_equal(array.values, values.astype(np.float32))
        if "error_max_relative" in maps[name].attrs:
            assert maps[name].error_max_relative + unit <= array.error_max_relative <= 1.01 * unit + 1e-9
        assert "error_max_roundings" not in array.attrs
    assert part.a2.dtype == np.float64
    assert "float32" in fl.open(tmp_path / "f4.nc").fastlink.summary()


def test_what_float32_and_axes_do_not_hold_is_said(tmp_path, grid):
    space = fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0, omega1=[25.0, 1e24])
    maps = fl.sweep("planar_4r", space, ["alpha4_max"], branch=1)
    with pytest.warns(fl.InputWarning, match="2 of alpha4_max"):
        path = fl.convert(maps, tmp_path / "f4.h5", dtype="float32")
    assert loaded(path).rounding_overflows == "alpha4_max: 2"
    with pytest.warns(fl.InputWarning, match="the nearest, 0.5, is taken"):
        part = loaded(fl.convert(grid, tmp_path / "part.h5", select={"a1": 0.51}))
    assert float(part.a1) == 0.5
    with pytest.warns(fl.InputWarning, match=r"\[-30.0, 30.0\] is taken.*theta1_deg"):
        fl.convert(grid, tmp_path / "radians.h5", select={"theta1": "-30:30"})


@pytest.mark.parametrize(
    ("options", "key", "remedy"),
    [
        ({"select": {"a_2": 1.1}}, "a_2", "'a2'"),
        ({"select": {"a2": "2:3"}}, "a2", "widen"),
        ({"select": {"a2": 7.0}}, "a2", "widen"),
        ({"select": {"a3": 7.0}}, "a3", "widen"),
        ({"select": {"a2": "1.2:1.1"}}, "a2", "lesser end first"),
        ({"select": {"a2": "x"}}, "a2", "a range"),
        ({"select": {"a2": "#9"}}, "a2", "#0 to #4"),
        ({"select": {"a2": "#x"}}, "a2", "#3"),
        ({"select": {"a2": "#1:2:-1"}}, "a2", "#3"),
        ({"select": {"a2": None}}, "a2", "a range"),
        ({"select": {"a2_deg": 3}}, "a2_deg", "write a2"),
        ({"select": {"theta4": 1.0}}, "theta4", "a1"),
        ({"select": {"branch": 3}}, "branch", "widen"),
        ({"select": "a2=1"}, "select", "a range"),
        ({"quantities": ["theta_4"]}, "quantities", "'theta4'"),
        ({"quantities": "theta4"}, "quantities", "list"),
        ({"quantities": []}, "quantities", "leave it out"),
        ({"dtype": "int16"}, "dtype", "float32"),
        ({"dtype": object()}, "dtype", "float32"),
        ({"compress": "zip"}, "compress", "gzip"),
        ({"compress": "zstd:99"}, "compress", "22"),
        ({"compress": "lz4:3"}, "compress", "lz4"),
        ({"overwrite": "no"}, "overwrite", "True or False"),
        ({"to": "maps.ods"}, "to", ".csv"),
        ({"to": "maps"}, "to", ".csv"),
        ({"to": "no/such/folder.nc"}, "to", "create it"),
        ({"to": "no/such/folder.zarr"}, "to", "create it"),
        ({"to": "out.csv", "compress": "gzip"}, "compress", "leave it out"),
    ],
)  # fmt: skip
def test_refusals(grid, tmp_path, monkeypatch, options, key, remedy):
    monkeypatch.chdir(tmp_path)
    with refused(key, remedy):
        fl.convert(whole(grid), **({"to": "out.h5"} | options))
    assert left_in(tmp_path) == []


def test_all_problems_are_said_together(grid, tmp_path):
    with pytest.raises(fl.InputError) as caught:
        fl.convert(grid, tmp_path / "o.h5", select={"a_2": 1, "a9": 2}, dtype="int8", quantities=["x"])
    assert len(caught.value.problems) == 4


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["out.h5", "out.nc", "out.zarr", "out.csv", "out.parquet", "out.xlsx"])
def test_what_exists_is_replaced_only_by_overwrite(grid, sampled, tmp_path, name):
    path = fl.convert(grid, tmp_path / name, quantities=["theta4"])
    kept = sorted(one.read_bytes() for one in path.rglob("*") if one.is_file()) or path.read_bytes()
    with refused("to", "overwrite=True"):
        fl.convert(sampled, path)
    assert kept == (sorted(one.read_bytes() for one in path.rglob("*") if one.is_file()) or path.read_bytes())
    fl.convert(sampled, path, overwrite=True)
    assert left_in(tmp_path) == [name]
    if name.endswith(("h5", "nc", "zarr")):
        assert loaded(path).sizes["design"] == 32


def test_the_map_itself_and_other_folders_are_not_replaced(grid, tmp_path):
    before = digest(grid)
    with refused("to", "another name"):
        fl.convert(grid, grid, overwrite=True, compress="gzip")
    assert digest(grid) == before
    (tmp_path / "mine.zarr").mkdir()
    (tmp_path / "mine.zarr" / "thesis.txt").write_text("years")
    with refused("to", "another name"):
        fl.convert(grid, tmp_path / "mine.zarr", overwrite=True)
    (tmp_path / "out.zarr.part").mkdir()
    (tmp_path / "out.zarr.part" / "thesis.txt").write_text("years")
    with refused("to", "remove it"):
        fl.convert(grid, tmp_path / "out.zarr")
    assert left_in(tmp_path) == ["mine.zarr", "out.zarr.part"]
    assert (tmp_path / "out.zarr.part" / "thesis.txt").read_text() == "years"


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["out.h5", "z.h5", "out.zarr", "out.csv", "out.parquet", "out.xlsx"])
@pytest.mark.parametrize("fault", [KeyboardInterrupt, OSError(errno.ENOSPC, "No space left on device")])
def test_what_fails_leaves_nothing_and_touches_nothing(
    grid, tmp_path, monkeypatch, small_blocks, name, fault
):
    path = fl.convert(grid, tmp_path / name)
    before = left_in(tmp_path)
    owner, function = (partial_file, "write_all") if name == "out.h5" else (convert.Source, "read")
    real, count = getattr(owner, function), iter(range(100))

    def failing(*args):
        if next(count) == 3:
            raise fault
        return real(*args)

    monkeypatch.setattr(owner, function, failing)
    options = {"compress": "gzip"} if name == "z.h5" else {}
    with pytest.raises(fault) if fault is KeyboardInterrupt else refused("to", "room"):
        fl.convert(grid, path, overwrite=True, **options)
    assert left_in(tmp_path) == before


KILLED = """
import os, signal, sys
import fastlink as fl
from fastlink.io import convert
convert.BLOCK_BYTES = 1000
read, count = convert.Source.read, iter(range(10**6))
def killing(*args):
    if next(count) == 9:
        os.kill(os.getpid(), signal.SIGKILL)
    return read(*args)
convert.Source.read = killing
fl.convert(sys.argv[1], sys.argv[2], overwrite=True, compress=sys.argv[3] or None)
"""


@pytest.mark.parametrize(
    ("name", "compress"), [pytest.param("out.h5", "gzip", marks=pytest.mark.stress), ("out.zarr", "")]
)
def test_a_kill_touches_nothing_that_is_finished_and_the_next_conversion_goes_through(
    grid, sampled, tmp_path, name, compress
):
    path = fl.convert(sampled, tmp_path / name)
    before = loaded(path)
    done = subprocess.run([sys.executable, "-c", KILLED, str(grid), str(path), compress], check=False)
    assert done.returncode == -9
    assert left_in(tmp_path) == [name, f"{name}.part"]
    xr.testing.assert_identical(loaded(path), before)
    fl.convert(grid, path, overwrite=True, compress=compress or None)
    assert left_in(tmp_path) == [name]
    assert_same(loaded(path), whole(grid))


NOT_LETTERS = os.fsdecode(b"\xff")


def at(tmp_path, name):
    return tmp_path / f"{NOT_LETTERS}{name}"


def is_said(path, name):
    assert f"\\udcff{name}" in loaded(path).attrs["history"]
    assert path.suffix == ".zarr" or fl.check(path)


@pytest.mark.skipif(sys.platform == "darwin", reason="names of files are letters there")
def test_a_name_that_is_no_text_is_one_of_a_file(grid, tmp_path):
    source = at(tmp_path, "grid.h5")
    source.hardlink_to(grid)
    for name in OUTPUTS:
        path = converted(source, at(tmp_path, name), quantities=["theta4"])
        if name.endswith("xlsx"):
            assert len(pd.read_excel(path)) == 15 * 2 * 24
        elif name.endswith(("csv", "parquet")):
            assert fl.table(path).size == 15 * 2 * 24
        else:
            is_said(path, name)
            is_said(converted(source, tmp_path / name), "grid.h5")


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (lambda maps: maps.assign_attrs(note=NOT_LETTERS), "note"),
        (lambda maps: maps.assign_attrs({NOT_LETTERS: "x"}), r"'\udcff'"),
        (lambda maps: maps.assign_attrs(notes=["one", "two"]), "'notes'"),
        (lambda maps: maps.assign(theta4=maps.theta4.assign_attrs(units=NOT_LETTERS)), "theta4: units"),
        (lambda maps: maps.rename(theta4=NOT_LETTERS), r"'\udcff'"),
        (lambda maps: maps.assign_coords(part=("a1", ["a", "b", NOT_LETTERS])), "part"),
    ],
)
def test_what_no_file_can_hold_is_refused_by_its_name(grid, tmp_path, change, named):
    with refused(named, "list of numbers" if named == "'notes'" else "letters alone"):
        fl.convert(change(whole(grid)[["theta4", "status"]]), tmp_path / "out.h5")
    assert left_in(tmp_path) == []


OUTPUTS = ["out.h5", "gzip.h5", "out.nc", "out.zarr", "out.csv", "out.parquet", "out.xlsx"]


def converted(grid, path, **options):
    return fl.convert(grid, path, compress="gzip" if path.name == "gzip.h5" else None, **options)


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", OUTPUTS)
def test_what_a_kill_in_the_last_step_left_is_replaced(grid, tmp_path, name):
    path = tmp_path / name
    converted(grid, path).rename(part := tmp_path / f"{name}.part")
    converted(grid, path)
    path.rename(part)
    converted(grid, path, overwrite=True)
    assert left_in(tmp_path) == [name]


def test_what_a_killed_search_left_is_replaced(grid, tmp_path):
    path, part = tmp_path / "found.h5", tmp_path / "found.h5.part"
    request = "planar_4r", fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0), []
    options = {"minimise": "transmission_angle_max", "top": 1, "to": path, "verify": 0}
    fl.search(*request, **options).close()
    path.rename(part)
    fl.search(*request, **options).close()
    path.rename(part)
    with refused("to", "restart=True"):
        fl.search(*request, **(options | {"top": 2}))
    fl.search(*request, **(options | {"top": 2}), restart=True).close()
    assert left_in(tmp_path) == ["found.h5"]
    converted(grid, tmp_path / "out.h5").rename(tmp_path / "found.h5.part")
    fl.search(*request, **options, overwrite=True).close()  # a conversion is made again, it is no run
    assert left_in(tmp_path) == ["found.h5"]


@pytest.mark.sample(1)
@pytest.mark.parametrize("left", [[], [".zgroup.0123456789abcdef0123456789abcdef.partial"], ["theta4/0.0.0"]])
def test_what_is_left_of_a_zarr_store_is_replaced_too(grid, tmp_path, left):
    """A kill may come before its first file has its name, or while the old store is removed."""
    part = tmp_path / "out.zarr.part"
    (part / "theta4").mkdir(parents=True)
    for name in left:
        (part / name).write_bytes(b"")
    fl.convert(grid, tmp_path / "out.zarr")
    assert left_in(tmp_path) == ["out.zarr"]


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", OUTPUTS)
def test_a_partial_file_of_a_living_process_or_of_another_kind_is_left_alone(grid, tmp_path, name):
    path, part = tmp_path / name, tmp_path / f"{name}.part"
    converted(grid, path).rename(part)
    before = sorted(one.read_bytes() for one in [part, *part.rglob("*")] if one.is_file())
    fd = os.open(part, os.O_RDONLY)
    try:
        fcntl.flock(fd, fcntl.LOCK_EX)
        for overwrite in (False, True):
            with refused(f"{part}: another run is writing it", "wait for it"):
                converted(grid, path, overwrite=overwrite)
    finally:
        os.close(fd)
    assert sorted(one.read_bytes() for one in [part, *part.rglob("*")] if one.is_file()) == before
    if part.is_dir():
        shutil.rmtree(part)
        part.write_text("years")
    else:
        part.unlink()
        part.mkdir()
    with refused(f"{part} is", "remove it"):
        converted(grid, path)


def test_a_partial_file_of_a_sweep_is_kept(grid, tmp_path, monkeypatch):
    space = fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0)
    monkeypatch.setattr(partial_file, "publish", raising(errno.EIO))
    with refused("to"):
        sweep_4r(space, ["transmission_angle_min"], to=tmp_path / "m.h5", verify=0)
    monkeypatch.undo()
    assert left_in(tmp_path) == ["m.h5.part", "m.h5.part.journal"]
    for options in ({}, {"compress": "gzip"}):
        with refused("to", "finish it"):
            fl.convert(grid, tmp_path / "m.h5", **options)
    assert left_in(tmp_path) == ["m.h5.part", "m.h5.part.journal"]


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("kind", "options"),
    [("sampled", {}), ("grid", {"dtype": "float32", "select": {"theta1": "#::3", "branch": 2}})],
)
def test_tables_have_a_row_for_each_configuration(request, tmp_path, small_blocks, kind, options):
    path = request.getfixturevalue(kind)
    wide = loaded(fl.convert(path, tmp_path / "same.h5", **options))
    expected = wide.to_dataframe(dim_order=list(wide.theta4.dims)).reset_index()
    expected = expected.drop(columns=[name for name in expected if name not in wide.variables])
    text = pd.read_csv(fl.convert(path, tmp_path / "out.csv", **options), dtype=str)
    table = pd.read_parquet(fl.convert(path, tmp_path / "out.parquet", **options))
    assert set(table) == set(text) == set(expected)
    for name in expected:
        assert_array_equal(table[name].to_numpy(), expected[name].to_numpy())
        assert table[name].dtype == expected[name].dtype
        read = np.array([float(cell) for cell in text[name].fillna("nan")])
        assert_array_equal(read.astype(expected[name].dtype), expected[name].to_numpy())
    metadata = parquet.read_schema(tmp_path / "out.parquet")
    assert metadata.field("theta4").metadata[b"units"] == b"rad"
    assert b"CF-1.11" in metadata.metadata[b"fastlink"]
    # a block has at most 20,000 bytes in 13 columns of 8 bytes
    assert (parquet.ParquetFile(tmp_path / "out.parquet").num_row_groups > 1) or len(table) <= 192


def test_designs_are_read_back_from_a_table(grid, tmp_path):
    path = fl.convert(grid, tmp_path / "out.csv", quantities=["grashof_class"])
    space = fl.table(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fl.InputWarning)  # of results that are left out
        again = sweep_4r(space, ["theta4_max"])
    straight = sweep_4r(whole(grid).fastlink.designs, ["theta4_max"])
    assert_array_equal(again.theta4_max.values.reshape(-1), straight.theta4_max.values.reshape(-1))


def test_names_of_designs_come_along(tmp_path):
    table = {"name": ['crank, "A"', "b", "ü"], "a1": [0.4, 0.5, 0.6], "a2": 1.2, "a3": 0.8, "a4": 1.0}
    maps = sweep_4r(fl.table(table), ["transmission_angle_min"])
    names = maps["name"].values.tolist()
    for ending in ("h5", "nc", "zarr"):
        path = fl.convert(maps, tmp_path / f"out.{ending}", compress="gzip", select={"name": "b"})
        assert loaded(path)["name"].values.tolist() == ["b"]
    assert pd.read_csv(fl.convert(maps, tmp_path / "o.csv"))["name"].tolist() == [
        n for n in names for _ in "12"
    ]
    assert pd.read_parquet(fl.convert(maps, tmp_path / "o.parquet"))["name"][0] == names[0]


def test_chunks_are_those_of_dask(grid, tmp_path):
    dask = pytest.importorskip("dask.array")
    with fl.open(fl.convert(grid, tmp_path / "plain.nc"), chunks={"a2": 2}) as maps:
        assert maps.theta4.chunks[1] == (2, 2, 1)
        xr.testing.assert_identical(maps.load().drop_attrs(), whole(grid).drop_attrs())
    for name in ("z.zarr", "z.nc"):
        path = fl.convert(grid, tmp_path / name, compress="zstd")
        for chunks in ({}, "auto"):
            with fl.open(path, chunks=chunks) as maps:
                assert isinstance(maps.theta4.data, dask.Array)
                xr.testing.assert_identical(maps.load().drop_attrs(), whole(grid).drop_attrs())


def test_absent_packages_are_named_with_their_extra(grid, tmp_path, monkeypatch):
    zstd, store = fl.convert(grid, tmp_path / "z.h5", compress="zstd"), fl.convert(grid, tmp_path / "z.zarr")
    monkeypatch.setattr("fastlink.errors.find_spec", lambda name: None)
    for key, call in (
        ("compress", lambda: fl.convert(grid, tmp_path / "o.h5", compress="zstd")),
        ("to", lambda: fl.convert(grid, tmp_path / "o.zarr")),
        ("to", lambda: fl.convert(grid, tmp_path / "o.parquet")),
        ("path", lambda: fl.open(zstd)),
        ("path", lambda: fl.open(store)),
    ):
        with refused(key, "python -m pip install "):
            call()
    fl.convert(grid, tmp_path / "o.nc", compress="gzip")
    fl.convert(grid, tmp_path / "o.csv")


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["out.h5", "z.h5", pytest.param("out.csv", marks=pytest.mark.stress)])
def test_memory_does_not_grow_with_the_map(tmp_path, monkeypatch, name):
    """At any time there are one block as it is read and, for each, one as it is written.

    Twice a block while it is selected or rounded, and 100 bytes for each cell of CSV, of which a block has as many
    as fit: 4 blocks are enough, and what is not of a size with the map: labels, HDF5's and Python's own.
    """
    space = fl.grid(a1=np.linspace(0.3, 0.5, 30), a2=np.linspace(1.1, 1.2, 30), a3=0.8, a4=1.0)
    maps = sweep_4r(space, ["theta4"], angles=100, to=tmp_path / "m.h5", verify=0)
    block = 1 << 16
    monkeypatch.setattr(convert, "BLOCK_BYTES", block)
    monkeypatch.setattr(convert, "CHUNK_BYTES", block // 4)
    monkeypatch.setattr(checksums, "READ_BYTES", block)  # of labels, and of what was written
    options = {"compress": "gzip:1"} if name == "z.h5" else {}
    fl.convert(maps.isel(a1=[0]), tmp_path / name, **options)  # what is imported and kept
    tracemalloc.start()
    fl.convert(maps, tmp_path / name, dtype="float32", overwrite=True, **options)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    limit = 4 * block + 400_000
    assert maps.theta4.nbytes > 2 * limit
    assert most < limit
    maps.close()


def test_levels_are_those_of_the_libraries():
    for name, levels in convert.LEVELS.items():
        given = [name] if levels is None else [f"{name}:{levels[0]}", f"{name}:{levels[1]}"]
        for text in given:
            parsed = convert.check_compression(text, "hdf5")
            assert str(parsed) == text
            assert parsed.of_hdf5()
            assert parsed.of_zarr()


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("name", "options"),
    [("o.h5", {}), ("z.h5", {"compress": "gzip"}), ("o.zarr", {}), ("o.csv", {}), ("o.parquet", {})],
)
def test_inputs_of_many_designs_are_read_block_by_block(tmp_path, monkeypatch, name, options):
    """To the result that a few have."""
    space = fl.sobol(40, seed=1, a1=(0.3, 0.5), a2=(1.0, 1.3), a3=0.8, a4=1.0)
    maps = sweep_4r(space, ["transmission_angle_min"], to=tmp_path / "maps.h5", verify=0)
    few, many = tmp_path / name, tmp_path / f"many-{name}"
    options |= {"select": {"design": "#3:30"}}
    fl.convert(maps, few, **options)
    monkeypatch.setattr("fastlink.io.convert.FEW_BYTES", 0)
    monkeypatch.setattr("fastlink.io.convert.BLOCK_BYTES", 64)
    fl.convert(maps, many, **options)
    maps.close()
    if name.endswith((".csv", ".parquet")):
        read = fl.table(few), fl.table(many)
        assert str(read[0]) == str(read[1]).replace("many-", "")
        if name.endswith(".csv"):
            assert few.read_bytes() == many.read_bytes()
        return
    with fl.open(few) as one, fl.open(many) as other:
        assert list(other.a1.dims) == ["design"]
        xr.testing.assert_identical(one.drop_attrs(deep=False), other.drop_attrs(deep=False))
        assert {k: v for k, v in one.attrs.items() if k != "history"} == {
            k: v for k, v in other.attrs.items() if k != "history"
        }
    if name.endswith(".h5"):
        assert fl.check(many)


OF_STRANGERS = {
    "complex": np.array([1j, 2.0]),
    "mixed": np.array(["a", 2], object),
    "dates": np.array(["2020-01-01", "2021-01-01"], "M8[ns]"),
    "durations": np.array([1, 2], "m8[ns]"),
    "truths": np.array([True, False]),
    "bytes": np.array([b"a", b"b"]),
    "records": np.array([(1, 2.0), (3, 4.0)], "i4,f8"),
}


@pytest.mark.sample(4)
@pytest.mark.parametrize("name", OF_STRANGERS)
def test_values_labels_and_attributes_that_are_no_numbers_are_refused(tmp_path, name):
    values, ending = OF_STRANGERS[name], ".csv" if name in ("dates", "bytes", "truths") else ".h5"
    space = fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0)
    maps = sweep_4r(space, ["grashof_class"])
    with_others = [
        maps.assign(other=("a2", values)),
        maps.assign_coords(other=("a2", values)),
        maps.assign_attrs(other=values),
        maps.assign(other=maps.grashof_class.assign_attrs(other=values)),
    ]
    for one in with_others:
        with refused("maps"):
            fl.convert(one, tmp_path / f"new{ending}")
    assert left_in(tmp_path) == []
    if values.dtype.kind != "O":
        fl.convert(with_others[0], tmp_path / f"new{ending}", quantities=["grashof_class"])

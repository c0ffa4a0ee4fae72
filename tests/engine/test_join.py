"""Parts joined are the file that one sweep writes, whatever happens on the way; what does not belong is refused."""

import itertools
import os
import shutil
import subprocess
import sys

import h5py
import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_array_equal
from tests.support.map_files import digest, flip, left_in
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r, sweep_both

import fastlink as fl
from fastlink.errors import InputWarning
from fastlink.io import joining, partial_file
from fastlink.io.checksums import Stored, read_seal
from fastlink.io.writer import Writer

COUPLERS, OUTPUTS, SPEEDS = np.linspace(1.0, 1.4, 7), np.linspace(0.6, 1.0, 5), np.array([0.5, 3.0, 7.0])
AXES = {"omega1": SPEEDS, "a2": COUPLERS, "a3": OUTPUTS}
TABLE = {"a1": np.linspace(0.3, 0.5, 11), "a2": np.linspace(1.0, 1.4, 11)}
TABLE |= {"part_no": [f"P{k}" for k in range(11)], "a3": 0.8, "a4": 1.0}
HUNDREDS = {"a2": np.linspace(1.0, 1.4, 25), "a3": np.linspace(0.6, 1.0, 21)}
RANGES = {"a1": (0.3, 0.5), "a2": (1.0, 1.4), "a3": 0.8, "a4": 1.0}
TINY = {"a1": (3e-7, 5.0), "a2": (1e-7, 1.4), "a3": 0.8e-6, "a4": 1e-6}
GRID = {"a1": 0.4, "a4": 1.0}
BARS = {"b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0}
FOCAL = {"a": [5.0, 5.5, 6.0, 6.5, 7.0], "name": list("vwxyz"), **BARS}


def of_4r(space, *quantities, **options):
    return "planar_4r", space, [*quantities], options


def of_focal(space):
    return "focal", space, ["crank_type"], {}


#: Mechanism, designs, quantities, options of each.
REQUESTS = {
    "grid": of_4r(lambda: fl.grid(**GRID, a2=COUPLERS, a3=OUTPUTS), "theta4", theta1=6),
    "hundreds": of_4r(lambda: fl.grid(**GRID, **HUNDREDS), "theta4", theta1=6),
    "sobol": of_4r(lambda: fl.sobol(37, seed=3, **RANGES), "transmission_angle_min"),
    "hypercube": of_4r(lambda: fl.latin_hypercube(23, seed=3, **RANGES), "transmission_angle_min", branch=2),
    "table": of_4r(lambda: fl.table(TABLE), "theta4", theta1=4),
    "numbered table": of_4r(lambda: fl.table({"design": np.arange(11) * 3 + 7, **TABLE}), "theta4", theta1=4),
    "one design": of_4r(lambda: fl.grid(**GRID, a2=1.2, a3=0.8), "theta4_mean", theta1=4),
    "scalar branch": of_4r(
        lambda: fl.grid(**GRID, a2=COUPLERS, a3=0.8, omega1=2.0), "omega4_extrema", branch=1
    ),
    "tiny designs": of_4r(lambda: fl.sobol(19, seed=1, **TINY), "theta4", theta1=4),
    "scaling axis": of_4r(lambda: fl.grid(**GRID, **AXES), "omega4", theta1=4),
    "layout of maps": of_4r(
        lambda: fl.grid(**GRID, **AXES), "omega4", "omega4_extrema", theta1=4, layout="maps"
    ),
    "completions": of_focal(lambda: fl.grid(a=[5.0, 5.5, 6.0], **BARS)),
    "completions of a table": of_focal(lambda: fl.table(FOCAL)),
    "completions of a numbered table": of_focal(lambda: fl.table({"design": [7, 3, 9, 1, 4], **FOCAL})),
    "completions of a sample": of_focal(lambda: fl.sobol(7, seed=1, a=(5.0, 7.0), **BARS)),
}


def sweep(of, **options):
    """Return the result of a request, by its name or as it stands."""
    mechanism, space, quantities, given = REQUESTS[of] if isinstance(of, str) else of
    return sweep_both(mechanism, space(), quantities, **{"verify": 0, **given, **options})


#: What a joined map says of its making, and a sweep otherwise.
OF_MAKING = {"run_time_s", "set_up_time_s", "designs_per_second"}
OF_MAKING |= {"configurations_per_second", "written_time_ns"}
OF_MAKING |= {"history", "threads", "joined_parts", "core_time_s", "verify_time_s"}
OF_MAKING |= {"verified_designs", "designs_of_earlier_runs"}
#: More than a block of a megabyte in each part.
LARGE = (
    "planar_4r",
    lambda: fl.grid(**GRID, a2=np.linspace(1.0, 1.4, 61), a3=np.linspace(0.6, 1.0, 59)),
    ["theta4"],
)


def parts_of(of, folder, count=3, **options):
    """Write the parts of a request, and return their paths."""
    paths = [folder / f"maps.part-{k}-of-{count}.h5" for k in range(1, count + 1)]
    for k, path in enumerate(paths, 1):
        sweep(of, part=(k, count), to=path, **options).close()
    return paths


def assert_same(joined, whole):
    """Assert that two maps are the same but for their making: dimensions, bits, labels, attributes."""
    joined, whole = joined.load(), whole.load()
    about = [
        {name: value for name, value in one.attrs.items() if name not in OF_MAKING} for one in (joined, whole)
    ]
    assert about[0].keys() == about[1].keys()
    assert all(np.array_equal(about[0][name], about[1][name]) for name in about[1])
    xr.testing.assert_identical(joined.drop_attrs(deep=False), whole.drop_attrs(deep=False))
    assert list(joined.data_vars) == list(whole.data_vars)
    for name in whole.variables:
        assert joined[name].dtype == whole[name].dtype
        assert joined[name].dtype == object or joined[name].values.tobytes() == whole[name].values.tobytes()


@pytest.mark.sample(1)
@pytest.mark.parametrize("of", REQUESTS)
def test_joined_parts_are_the_map_of_one_sweep(of, tmp_path):
    with sweep(of, to=tmp_path / "whole.h5") as whole:
        parts = parts_of(of, tmp_path, min(3, whole.attrs["designs"]))
        for copy in (False, True):
            with fl.join(parts[::-1], to=tmp_path / "maps.h5", copy=copy, overwrite=True) as joined:
                assert_same(joined, whole)
                assert joined.attrs["joined_parts"] == len(parts)
            assert fl.check(tmp_path / "maps.h5")
            before = digest(tmp_path / "maps.h5")
            again = fl.join(tmp_path, to=tmp_path / "maps.h5", copy=copy)
            with again, sweep(of, to=tmp_path / "maps.h5") as found:
                assert found.attrs == again.attrs == joined.attrs
            assert digest(tmp_path / "maps.h5") == before


@pytest.mark.sample(1)
@pytest.mark.parametrize("layout", ["curves", "maps"])
def test_parts_of_several_blocks_are_joined_piece_by_piece(layout, tmp_path, monkeypatch):
    monkeypatch.setattr(joining, "PIECE_BYTES", 700_001)
    of = (*LARGE, {"theta1": 72, "layout": layout})
    paths = parts_of(of, tmp_path)
    with sweep(of, to=tmp_path / "whole.h5") as whole:
        for copy in (False, True):
            with fl.join(paths, to=tmp_path / "maps.h5", copy=copy, overwrite=True) as joined:
                assert_same(joined, whole)
            assert fl.check(tmp_path / "maps.h5")


def test_errors_are_the_greatest_and_numbers_are_sums(tmp_path):
    paths = parts_of("grid", tmp_path, 3, verify=5, threads=2)
    parts = [fl.open(path).load() for path in paths]
    with fl.join(paths, to=tmp_path / "maps.h5") as joined:
        assert joined.attrs["designs"] == 35
        times = ["run_time_s", "set_up_time_s"]
        for name in (*times, "verified_designs", "verify_mismatches", "configurations"):
            assert joined.attrs[name] == sum(part.attrs[name] for part in parts)
        assert joined.attrs["core_time_s"] == 2 * joined.attrs["run_time_s"]
        counts = [name for name in joined.attrs if name.startswith("designs_") and "per" not in name]
        assert sum(joined.attrs[name] for name in counts) == 35
        for name in ("error_max_relative", "error_median_relative", "error_max_roundings"):
            assert joined.theta4.attrs[name] == max(part.theta4.attrs[name] for part in parts)
        assert joined.theta4.attrs["verified_values"] == sum(
            part.theta4.attrs["verified_values"] for part in parts
        )
        assert "of 3 parts together" in joined.fastlink.summary()
    assert "2/3: designs 11 to 22 of 35" in parts[1].fastlink.summary()


#: Sixteen parts of several blocks, whose borders cut rows of both axes.
SIXTEEN = (*LARGE, {"theta1": 6})
SUBFOLDER = "parts of 50%b"  # by which HDF5 would count


@pytest.fixture(scope="module")
def sixteen(tmp_path_factory):
    """Return a folder with the map of one sweep, and one of maps.h5 that shows sixteen parts below it."""
    folder = tmp_path_factory.mktemp("sixteen")
    sweep(SIXTEEN, to=folder / "whole.h5").close()
    (folder / "joined" / SUBFOLDER).mkdir(parents=True)
    fl.join(parts_of(SIXTEEN, folder / "joined" / SUBFOLDER, 16), to=folder / "joined" / "maps.h5").close()
    return folder


@pytest.fixture
def moved(sixteen, tmp_path, monkeypatch):
    """Return a copy of that map with its parts elsewhere; files of the same names are in the working directory."""
    shutil.copytree(sixteen / "joined", tmp_path / "moved")
    (tmp_path / "here" / SUBFOLDER).mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here")
    for part in (tmp_path / "moved" / SUBFOLDER).iterdir():
        with h5py.File(f"{SUBFOLDER}/{part.name}", "w") as other, h5py.File(part) as file:
            for name in ("theta4", "status"):
                other[name] = np.zeros_like(file[name])
    return tmp_path / "moved" / "maps.h5"


def part_of_moved(path, number):
    return path.parent / SUBFOLDER / f"maps.part-{number}-of-16.h5"


@pytest.mark.sample(1)
@pytest.mark.parametrize("reader", ["link", "h5py", "netcdf4", "convert"])
def test_every_reader_finds_the_values_of_all_parts_where_they_were_moved(reader, sixteen, moved):
    assert moved.stat().st_size < 1e5
    readers = {
        "link": lambda: fl.open("link.h5"),
        "h5py": lambda: xr.Dataset(
            {"theta4": (("a2", "a3", "branch", "theta1"), h5py.File(moved)["theta4"][:])}
        ),
        "convert": lambda: fl.open(fl.convert(moved, "alone.h5")),
    }
    os.symlink(moved, "link.h5")
    read = readers.get(reader, lambda: xr.open_dataset(os.path.relpath(moved), engine=reader))
    with xr.open_dataset(sixteen / "whole.h5", engine="h5netcdf") as whole, read() as found:
        assert found.theta4.dims == whole.theta4.dims
        assert found.theta4.values.tobytes() == whole.theta4.values.tobytes()
        assert reader == "h5py" or found.status.identical(whole.status)


def test_a_map_that_shows_its_parts_is_a_map_at_every_door(sixteen, moved):
    whole, shown = (fl.open(path) for path in (sixteen / "whole.h5", moved))
    with whole, shown:
        xr.testing.assert_identical(
            shown.theta4.sel(a2=1.2, method="nearest").load(),
            whole.theta4.sel(a2=1.2, method="nearest").load(),
        )
        assert "shows values of 16 parts" in shown.fastlink.summary()
        ranked = [fl.best(one, maximise="theta4", top=3, refine=False) for one in (whole, shown)]
        xr.testing.assert_identical(*(one.drop_attrs() for one in ranked))
    found = fl.check(moved)
    assert found
    assert len(found.parts) == 16
    assert "so are its 16 parts" in str(found)
    with refused("to", "another name"):
        fl.convert(moved, part_of_moved(moved, 3), overwrite=True)


@pytest.mark.sample(1)
@pytest.mark.parametrize("what", ["missing", "another run", "labels", "no part"])
def test_a_part_that_is_missing_or_another_is_named(what, moved):
    part = part_of_moved(moved, 7)
    why = "has changed since"
    if what == "missing":
        part.unlink()
        why = "is missing"
    elif what == "another run":
        sweep(SIXTEEN, part=(7, 16), to=part, overwrite=True).close()
    elif what == "labels":
        flip(part, part.read_bytes().index(b"Euclidean"))
    else:
        shutil.copy(moved, part)
    for door in (fl.open, lambda path: fl.best(path, minimise="status"), fl.check):
        if what == "labels" and door is fl.check:
            assert str(fl.check(moved)).startswith(str(part))
        else:
            with pytest.raises(fl.InputError, match=r"part-7-of-16\.h5") as caught:
                door(moved)
            assert why in str(caught.value)
            assert "join the parts again" in str(caught.value)
    with refused("part-7-of-16.h5", "join the parts again"):  # not `is no map`
        sweep(SIXTEEN, to=moved)


def test_a_check_reads_every_part(moved):
    part = part_of_moved(moved, 7)
    with h5py.File(part, "r") as file:
        place = Stored.of(file).values["theta4"]
    flip(part, place.offset + place.nbytes // 2)
    found = fl.check(moved)
    assert not found
    assert [one.path for one in found.parts if not one] == [part]
    assert f"{part}: values of theta4 have changed" in str(found)


@pytest.mark.sample(1)
@pytest.mark.parametrize("source", ["../secret.h5", "{folder}/secret.h5", "link.h5", "beside.h5"])
def test_values_of_other_files_than_parts_are_not_shown(source, tmp_path, grid_parts):
    """Not even of parts of the same map that it does not name."""
    folder = tmp_path / "map"
    folder.mkdir()
    shutil.copy(grid_parts[0], tmp_path / "secret.h5")
    shutil.copy(grid_parts[0], folder / "beside.h5")
    os.symlink("../secret.h5", folder / "link.h5")
    layout = h5py.VirtualLayout((11,), "i1")
    layout[:] = h5py.VirtualSource(source.format(folder=tmp_path), "status", (11,))
    sweep("grid", to=folder / "maps.h5").close()
    with h5py.File(folder / "maps.h5", "r+") as file:
        file.create_virtual_dataset("more", layout)
        if source != "beside.h5":
            name = source.format(folder=tmp_path).encode()
            file["parts/names"], file["parts/labels"] = [name], [read_seal(tmp_path / "secret.h5")[1]]
    with pytest.raises(fl.InputError, match="no part of it in its folder"):
        fl.open(folder / "maps.h5")
    assert not fl.check(folder / "maps.h5")


def test_what_cannot_be_shown_is_refused_before_anything_is_written(tmp_path, grid_parts, monkeypatch):
    (tmp_path / "other").mkdir()
    with refused("to", "copy=True"):
        fl.join(grid_parts, to=tmp_path / "other" / "maps.h5")
    resource = pytest.importorskip("resource")
    monkeypatch.setattr(resource, "getrlimit", lambda _: (66, 1000))
    with pytest.raises(fl.InputError, match=r"3 parts must be open at once.*ulimit"):
        joined_to(tmp_path, grid_parts)
    monkeypatch.undo()
    with h5py.File(grid_parts[1], "r+") as file:  # which takes its seal
        file.attrs["note"] = "mine"
        del file.attrs["note"]
    assert not list(tmp_path.glob("**/maps.h5*"))
    sweep("grid", part=(2, 3), to=grid_parts[1], overwrite=True).close()
    joined_to(tmp_path, grid_parts).close()
    with refused("to", "overwrite=True"):  # what is there is no copy
        joined_to(tmp_path, grid_parts, copy=True)
    joined_to(tmp_path, grid_parts, copy=True, overwrite=True).close()
    monkeypatch.setenv("HDF5_VDS_PREFIX", str(tmp_path))
    joined_to(tmp_path, grid_parts, copy=True).close()
    with refused("HDF5_VDS_PREFIX", "unset"):
        joined_to(tmp_path, grid_parts, overwrite=True)


#: Six processes at once, one of which is killed.
PROCESSES = """
import os, signal, sys, time
from pathlib import Path
from fastlink.io import partial_file
from fastlink.io.writer import Writer
from tests.engine.test_join import sweep

def run(k, killed):
    if (child := os.fork()):
        return child
    record = Writer.record
    def counted(self, start, stop):
        record(self, start, stop)
        if killed and start >= 12:
            while sum(b - a for a, b in self._journal.recorded) < 16:  # its thread does it within a second
                time.sleep(0.01)
            os.kill(os.getpid(), signal.SIGKILL)
    Writer.record = counted
    sweep("hundreds", part=(k, 6), to=folder / f"m.part-{k}-of-6.h5", threads=1, block=4).close()
    os._exit(0)

folder = Path(sys.argv[1])
partial_file.STEP_SECONDS = 0.0
sweep("hundreds", part=(1, 6))  # its kernels are loaded
children = [run(k, k == 5) for k in range(1, 7)]
print([os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children])
print([os.waitstatus_to_exitcode(os.waitpid(run(5, False), 0)[1])])
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_six_processes_at_once_one_of_which_is_killed(tmp_path):
    command = [sys.executable, "-c", PROCESSES, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.stdout == "[0, 0, 0, 0, -9, 0]\n[0]\n", done.stderr
    with fl.open(tmp_path / "m.part-5-of-6.h5") as resumed:
        assert resumed.attrs["designs_of_earlier_runs"] >= 16
    with sweep("hundreds", to=tmp_path / "whole.h5") as whole:
        for copy in (True, False):
            with fl.join(tmp_path / "m.part-*-of-6.h5", to=tmp_path / f"m-{copy}.h5", copy=copy) as joined:
                assert_same(joined, whole)
    assert not [name for name in left_in(tmp_path) if ".h5." in name]


def test_a_join_that_is_interrupted_goes_on(tmp_path, monkeypatch):
    monkeypatch.setattr(partial_file, "STEP_SECONDS", 0.0)
    paths, record = parts_of("grid", tmp_path, 5), Writer.record
    copied = []

    def interrupted(self, start, stop):
        record(self, start, stop)
        if (start, stop) == (14, 21):
            raise KeyboardInterrupt

    def noted(self, start, stop):
        record(self, start, stop)
        copied.append((start, stop))

    monkeypatch.setattr("fastlink.design.search.MOST_THREADS", 1)
    with monkeypatch.context() as patched:
        patched.setattr(Writer, "record", interrupted)
        with pytest.raises(KeyboardInterrupt) as caught:
            fl.join(paths, to=tmp_path / "maps.h5", copy=True)
    assert "60% of the designs" in caught.value.__notes__[0]
    with refused("to", "restart=True"):  # a sweep does not go on with it
        sweep("grid", to=tmp_path / "maps.h5")
    monkeypatch.setattr(Writer, "record", noted)
    with fl.join(paths, to=tmp_path / "maps.h5", copy=True) as joined:
        assert copied == [(21, 28), (28, 35)]
        assert_same(joined, sweep("grid", to=tmp_path / "whole.h5"))


@pytest.fixture(scope="module")
def parts_of_grid(tmp_path_factory):
    return parts_of("grid", tmp_path_factory.mktemp("grid"))


@pytest.fixture
def grid_parts(parts_of_grid, tmp_path):
    """Return copies of the three parts of a map."""
    return [shutil.copy2(path, tmp_path / path.name) for path in parts_of_grid]


def joined_to(folder, paths, **options):
    return fl.join(paths, to=folder / "maps.h5", **options)


def test_parts_that_are_missing_or_of_another_map_are_refused(tmp_path, grid_parts):
    grid_parts[1].rename(tmp_path / "maps.part-2-of-3.h5.part")
    with refused("part 2 of 3 (designs 11 to 22) is missing", "part='2/3'"):
        joined_to(tmp_path, tmp_path)
    with pytest.raises(fl.InputError, match="of a run that has not finished"):
        joined_to(tmp_path, tmp_path)
    sweep("grid", part=(1, 4), to=tmp_path / "quarter.h5").close()
    sweep("table", part=(1, 3), to=tmp_path / "table.h5").close()
    with refused("quarter.h5", "all of the same n"):
        joined_to(tmp_path, [*grid_parts[::2], tmp_path / "quarter.h5"])
    with refused("table.h5", "the parts of one map"):
        joined_to(tmp_path, [*grid_parts[::2], tmp_path / "table.h5"])
    assert not (tmp_path / "maps.h5").exists()


def test_a_part_twice_is_read_once_and_refused_with_other_values(tmp_path, grid_parts):
    twin = tmp_path / "twin.h5"
    sweep("grid", part=(2, 3), to=twin).close()
    with pytest.warns(InputWarning, match="one of them is read"):
        joined_to(tmp_path, [*grid_parts, twin, grid_parts[0]]).close()
    sums = "checksums/values"
    with h5py.File(twin, "r+") as file:
        file[sums][0] = file[sums][0] ^ 1
    with refused("twin.h5", "run that part again"):
        fl.join([*grid_parts, twin], to=tmp_path / "again.h5")


def test_what_is_no_part_is_refused(tmp_path, grid_parts):
    sweep("grid", to=tmp_path / "whole.h5").close()
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "empty").mkdir()
    for given in ("whole.h5", "notes.txt", "nothing.h5", "nothing-*.h5", "empty"):
        with refused("paths"):
            joined_to(tmp_path, [tmp_path / given])
    with refused("paths", "'maps.part-1-of-2.h5'"):
        joined_to(tmp_path, 5)
    with refused("to", "another name"):
        fl.join(grid_parts, to=grid_parts[0], overwrite=True)
    (tmp_path / "other.h5").write_text("mine")
    with refused("to", "overwrite=True"):
        fl.join(grid_parts, to=tmp_path / "other.h5")
    joined_to(tmp_path, tmp_path).close()  # in a folder, others are passed over


def test_damaged_parts_labels_and_marks_are_refused_and_a_new_run_joined(tmp_path, monkeypatch, grid_parts):
    monkeypatch.setattr(partial_file, "STEP_SECONDS", 0.0)
    folder, of = tmp_path / "large", (*LARGE, {"theta1": 72})
    folder.mkdir()
    paths = parts_of(of, folder)
    with h5py.File(paths[2], "r") as file:
        place = Stored.of(file).values["theta4"]
    flip(paths[2], place.offset + place.nbytes - 3)
    with refused("maps.part-3-of-3.h5", "run that part again"):
        joined_to(folder, paths, copy=True)
    assert not (folder / "maps.h5").exists()
    sweep(of, part=(3, 3), to=paths[2], overwrite=True).close()
    with joined_to(folder, paths, copy=True) as joined:
        assert_same(joined, sweep(of, to=folder / "whole.h5"))
    content = grid_parts[1].read_bytes()
    for text in (b"part_number", b"Euclidean", b"whole_fingerprint"):
        flip(grid_parts[1], content.index(text) + 2)
        with refused("paths"):
            joined_to(tmp_path, tmp_path)
        assert not (tmp_path / "maps.h5").exists()
        grid_parts[1].write_bytes(content)
    joined_to(tmp_path, tmp_path).close()


# == A part of a sweep is the same bits in a labelled file of its own ========================================


def assert_is_part(part, whole, swept):
    """Assert that a part has the results and inputs of its designs in the whole map, and their numbers."""
    start, stop = part.attrs["part_start"], part.attrs["part_stop"]
    assert part.sizes["design"] == stop - start == part.attrs["designs"]
    for name in whole.data_vars:
        values = whole[name].values
        assert part[name].dims == ("design", *whole[name].dims[swept:])
        rows = np.ascontiguousarray(values.reshape(-1, *values.shape[swept:])[start:stop])
        assert_array_equal(part[name].values, rows, err_msg=name)
        assert rows.tobytes() == part[name].values.tobytes()
        assert whole[name].attrs.keys() <= part[name].attrs.keys()
    sizes = [whole.sizes[dim] for dim in whole["status"].dims]
    for name, coord in whole.coords.items():
        if name != "design" and coord.dims and set(coord.dims) <= set(whole["status"].dims):
            axis = whole["status"].dims.index(coord.dims[0])
            values = np.broadcast_to(
                np.expand_dims(coord.values, [k for k in range(len(sizes)) if k != axis]), sizes
            )
            assert_array_equal(part[name].values, values.ravel()[start:stop], err_msg=str(name))
            assert part[name].dims == ("design",)
            assert repr(part[name].attrs) == repr(coord.attrs)
        elif name != "design":
            assert part[name].variable.identical(coord.variable)


@pytest.mark.sample(4)
@pytest.mark.parametrize("of", [of for of in REQUESTS if of != "layout of maps"])
def test_parts_are_those_of_the_whole(of):
    whole = sweep(of)
    swept = whole["status"].ndim
    count = min(5, whole["status"].size)
    parts = [sweep(of, part=(k, count), threads=2) for k in range(1, count + 1)]
    assert parts[0].attrs["part_start"] == 0
    assert [part.attrs["part_start"] for part in parts[1:]] == [
        part.attrs["part_stop"] for part in parts[:-1]
    ]
    assert parts[-1].attrs["part_stop"] == whole["status"].size == parts[0].attrs["whole_designs"]
    assert len({part.attrs["whole_fingerprint"] for part in parts}) == 1
    for part in parts:
        assert_is_part(part, whole, swept)
    numbers = np.concatenate([part["design"].values for part in parts])
    if whole["status"].dims == ("design",):
        assert_array_equal(numbers, whole["design"])
    else:
        assert_array_equal(numbers, np.arange(numbers.size))


@pytest.mark.sample(1)
@pytest.mark.parametrize("order", list(itertools.permutations(AXES)))
def test_an_axis_that_only_scales_results_has_the_same_bits_in_parts(order):
    """Rows of a part follow from designs that are evaluated at another speed, perhaps of another part."""
    space = fl.grid(a1=0.4, a4=1.0, **{name: AXES[name] for name in order})
    of = "planar_4r", lambda: space, ["omega4", "omega4_max"], {"theta1": 4}
    whole = sweep(of)
    assert whole.attrs["scaling_axis"] == "omega1"
    for count, block in ((2, None), (16, 4)):
        for k in range(1, count + 1):
            part = sweep(of, part=(k, count), block=block)
            assert part.attrs["scaling_axis"] == "omega1"
            assert_is_part(part, whole, 3)


def test_the_request_of_a_part_is_that_of_its_whole(tmp_path):
    def fingerprint(of="grid", **options):
        return sweep(of, **options).attrs["whole_fingerprint"]

    one = fingerprint(part=(1, 3))
    assert one == fingerprint(part="2/3", threads=1, block=7)
    assert one == fingerprint(part=(1, 4), to=tmp_path / "a.h5", verify=0)
    assert one != fingerprint("table", part=(1, 3))
    with sweep("grid", to=tmp_path / "m.h5", verify=0) as whole:
        assert whole.attrs["fingerprint"] == one


@pytest.fixture(scope="module")
def kinds(tmp_path_factory):
    """Return the files of a whole map, of parts, and of what has the same quantities and other designs."""
    folder = tmp_path_factory.mktemp("kinds")
    for part in (None, "1/3", "2/3", "3/3", "2/4"):
        sweep(
            "grid", part=part, to=folder / f"{'whole' if part is None else part.replace('/', ' of ')}.h5"
        ).close()
    sweep("numbered table", part="1/3", to=folder / "other 1 of 3.h5").close()
    space = fl.sobol(7, seed=1, a1=(0.3, 0.5), a2=(1.0, 1.4), a3=0.8, a4=1.0)
    sweep_4r(space, ["theta4"], theta1=6, verify=0, to=folder / "sobol.h5").close()
    return folder


@pytest.mark.sample(3)
@pytest.mark.parametrize(
    ("existing", "asked", "differs"),
    [
        ("whole", "1/3", "a whole map, not part 1/3"),
        ("1 of 3", None, "part 1/3, not a whole map"),
        ("2 of 4", "2/3", "part 2/4, not part 2/3"),
        ("other 1 of 3", "1/3", "a map with other"),
        ("sobol", None, "a map with other"),
        ("other 1 of 3", "join", "part 1/3, not a whole map"),
    ],
)
def test_a_file_of_another_part_or_of_the_whole_is_refused_with_what_it_is(kinds, existing, asked, differs):
    path = kinds / f"{existing}.h5"
    before = path.read_bytes()
    with refused(f"the file exists, {differs}", "overwrite=True"):
        if asked == "join":
            fl.join([kinds / f"{k} of 3.h5" for k in (1, 2, 3)], to=path)
        else:
            sweep("grid", part=asked, to=path)
    assert path.read_bytes() == before


@pytest.mark.parametrize("part", [(0, 3), "4/3", "1/2/3", (True, 2), 3, (1, 2, 3)])
def test_what_is_no_number_of_a_part_is_refused(part):
    with refused("part", "k from 1 to n"):
        sweep("grid", part=part)


def test_a_part_without_designs_is_refused():
    with refused("part", "at most 35 parts"):
        sweep("grid", part=(1, 36))
    with refused("part", "at most 1 part"):
        sweep("one design", part=(1, 2))
    assert sweep("grid", part=(35, 35)).sizes["design"] == 1


@pytest.mark.parametrize("of", ["grid", "sobol", "completions of a numbered table"])
def test_the_netcdf_library_reads_a_part_as_xarray_does(of, tmp_path):
    """The axes of the whole, which have the names of coordinates along the designs, are none of its dimensions."""
    sweep(of, part=(2, 3), to=tmp_path / "part.h5").close()
    with (
        fl.open(tmp_path / "part.h5") as part,
        xr.open_dataset(tmp_path / "part.h5", engine="netcdf4") as other,
    ):
        assert other.sizes == part.sizes
        assert {name: one.dims for name, one in other.variables.items()} == {
            name: one.dims for name, one in part.variables.items()
        }
        assert_array_equal(other.design.values, part.design.values)

"""Parts joined are the file that one sweep writes, whatever happens on the way; what does not belong is refused."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import h5py
import numpy as np
import pytest
import xarray as xr
from tests.support.map_files import digest, left_in
from tests.support.part_requests import GRID, REQUESTS, sweep
from tests.support.refusals import assert_refusal, refused
from tests.support.study_files import GOOD, written
from typer.testing import CliRunner

import fastlink as fl
from fastlink import threads
from fastlink.cli import app
from fastlink.errors import InputWarning
from fastlink.io import joining
from fastlink.io.stored import Stored
from fastlink.io.writing import journal
from fastlink.io.writing.writer import Writer

#: What a joined map says of its making, and a sweep otherwise.
OF_MAKING = {
    "run_time_s",
    "set_up_time_s",
    "designs_per_second",
    "configurations_per_second",
    "written_time_ns",
}
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


@pytest.mark.parametrize("of", REQUESTS)
def test_joined_parts_are_the_map_of_one_sweep(of, tmp_path):
    with sweep(of, to=tmp_path / "whole.h5") as whole:
        parts = parts_of(of, tmp_path, min(3, whole.attrs["designs"]))
        with fl.join(parts[::-1], to=tmp_path / "maps.h5") as joined:
            assert_same(joined, whole)
            assert joined.attrs["joined_parts"] == len(parts)
    assert fl.check(tmp_path / "maps.h5")
    before = digest(tmp_path / "maps.h5")
    with sweep(of, to=tmp_path / "maps.h5") as found, fl.join(tmp_path, to=tmp_path / "maps.h5") as again:
        assert found.attrs == again.attrs == joined.attrs
    assert digest(tmp_path / "maps.h5") == before


@pytest.mark.parametrize("layout", ["curves", "maps"])
def test_parts_of_several_blocks_are_joined_piece_by_piece(layout, tmp_path, monkeypatch):
    monkeypatch.setattr(joining, "PIECE_BYTES", 700_001)
    of = (*LARGE, {"theta1": 72, "layout": layout})
    paths = parts_of(of, tmp_path)
    with sweep(of, to=tmp_path / "whole.h5") as whole, fl.join(paths, to=tmp_path / "maps.h5") as joined:
        assert_same(joined, whole)
    assert fl.check(tmp_path / "maps.h5")


def test_errors_are_the_greatest_and_numbers_are_sums(tmp_path):
    paths = parts_of("grid", tmp_path, 3, verify=5, threads=2)
    parts = [fl.open(path).load() for path in paths]
    with fl.join(paths, to=tmp_path / "maps.h5") as joined:
        assert joined.attrs["designs"] == 35
        for name in (
            "run_time_s",
            "set_up_time_s",
            "verified_designs",
            "verify_mismatches",
            "configurations",
        ):
            assert joined.attrs[name] == sum(part.attrs[name] for part in parts)
        assert joined.attrs["core_time_s"] == 2 * joined.attrs["run_time_s"]
        counts = [name for name in joined.attrs if name.startswith("designs_") and "per" not in name]
        assert sum(joined.attrs[name] for name in counts) == 35
        for name in ("error_max_relative", "error_median_relative", "error_max_roundings"):
            assert joined.theta4.attrs[name] == max(part.theta4.attrs[name] for part in parts)
        assert joined.theta4.attrs["verified_values"] == sum(
            part.theta4.attrs["verified_values"] for part in parts
        )
        assert "of 3 parts together" in fl.summary(joined)
    assert "2/3: designs 11 to 22 of 35" in fl.summary(parts[1])


# --- on the way ------------------------------------------------------------------------------------

#: Sixteen processes at once, one of which is killed; each fault of a join.
PROCESSES = """
import os, signal, sys, time
from pathlib import Path
import fastlink as fl
from fastlink.io.writing import journal
from fastlink.io.writing.writer import Writer
from tests.support.faults import Injector
from tests.support.part_requests import sweep

def forked(function):
    child = os.fork()
    if not child:
        try:
            function()
            code = 0
        except fl.InputError:
            code = 2
        except KeyboardInterrupt:
            code = 130
        finally:
            os._exit(code)
    return child

def run(k, killed):
    record = Writer.record
    def counted(self, start, stop):
        record(self, start, stop)
        if killed and start >= 12:
            while sum(b - a for a, b in self._journal.recorded) < 16:  # its thread does it within a second
                time.sleep(0.01)
            os.kill(os.getpid(), signal.SIGKILL)
    Writer.record = counted
    sweep(of, part=(k, 16), to=folder / f"m.part-{k:02}-of-16.h5", threads=1, block=4).close()

def join(at, fault, to):
    injector = Injector(at, fault)
    injector.install()
    fl.join(folder / "m.part-*-of-16.h5", to=to).close()

of, folder = sys.argv[1], Path(sys.argv[2])
journal.STEP_SECONDS = 0.0
sweep(of, part=(1, 16))  # its kernels are loaded
children = [forked(lambda: run(k, k == 5)) for k in range(1, 17)]
print([os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children])
print([os.waitstatus_to_exitcode(os.waitpid(forked(lambda: run(5, False)), 0)[1])])
for number, (at, fault) in enumerate(eval(sys.argv[3])):
    to = folder / f"joined-{number}.h5"
    print(os.waitstatus_to_exitcode(os.waitpid(forked(lambda: join(at, fault, to)), 0)[1]))
"""
FEW = [(30, "EIO"), (70, "kill"), (100, "interrupt")]
FAULTS = [(at, fault) for at in range(3, 160, 7) for fault in ("kill", "EIO", "interrupt")]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
@pytest.mark.parametrize("faults", [FEW, pytest.param(FAULTS, marks=pytest.mark.stress)], ids=["few", "many"])
def test_sixteen_processes_at_once_and_a_join_that_fails_at_any_call(tmp_path, faults):
    command = [sys.executable, "-c", PROCESSES, "hundreds", str(tmp_path), repr(faults)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    parts, again, *codes = map(eval, done.stdout.splitlines())
    assert parts == [0, 0, 0, 0, -9] + [0] * 11
    assert again == [0]
    with fl.open(tmp_path / "m.part-05-of-16.h5") as resumed:
        assert resumed.attrs["designs_of_earlier_runs"] >= 16
    with sweep("hundreds", to=tmp_path / "whole.h5") as whole:
        for number, (code, (_, fault)) in enumerate(zip(codes, faults, strict=True)):
            to = tmp_path / f"joined-{number}.h5"
            assert code in {"kill": (-9, 0), "EIO": (2, 0), "interrupt": (130, 0)}[fault]
            assert to.exists() or code != 0
            with fl.join(tmp_path / "m.part-*-of-16.h5", to=to) as joined:
                assert_same(joined, whole)
            assert fl.check(to)
    assert not [name for name in left_in(tmp_path) if ".h5." in name]


def test_a_join_that_is_interrupted_goes_on(tmp_path, monkeypatch):
    monkeypatch.setattr(journal, "STEP_SECONDS", 0.0)
    paths, record = parts_of("grid", tmp_path, 5), Writer.record
    copied = []

    def interrupted(self, start, stop):
        record(self, start, stop)
        if (start, stop) == (14, 21):
            raise KeyboardInterrupt

    def noted(self, start, stop):
        record(self, start, stop)
        copied.append((start, stop))

    monkeypatch.setattr("fastlink.searching.join.MOST_THREADS", 1)
    with monkeypatch.context() as patched:
        patched.setattr(Writer, "record", interrupted)
        with pytest.raises(KeyboardInterrupt) as caught:
            fl.join(paths, to=tmp_path / "maps.h5")
    assert "60% of the designs" in caught.value.__notes__[0]
    with refused("to", "restart=True"):  # a sweep does not go on with it
        sweep("grid", to=tmp_path / "maps.h5")
    monkeypatch.setattr(Writer, "record", noted)
    with fl.join(paths, to=tmp_path / "maps.h5") as joined:
        assert copied == [(21, 28), (28, 35)]
        assert_same(joined, sweep("grid", to=tmp_path / "whole.h5"))


def test_a_thread_of_a_join_that_has_failed_takes_no_further_piece(tmp_path, monkeypatch):
    """One thread may work for two: what failed half-way is in no checksum of the journal, and nothing has changed."""
    monkeypatch.setattr(journal, "STEP_SECONDS", 0.0)
    paths, write, written = parts_of("grid", tmp_path, 5), Writer.write_pieces, []

    def failing(self, name, pieces):
        written.append(name)
        if len(written) == 6:  # the last variable of the third piece
            raise OSError(errno.EIO, "I/O")
        write(self, name, pieces)

    with monkeypatch.context() as patched:
        patched.setattr(Writer, "write_pieces", failing)
        patched.setattr(threads, "ThreadPoolExecutor", lambda count, **options: ThreadPoolExecutor(1))
        with pytest.raises(OSError, match="I/O"):
            fl.join(paths, to=tmp_path / "maps.h5")
    assert len(written) == 6
    with fl.join(paths, to=tmp_path / "maps.h5") as joined:  # a remark on changed values is an error here
        assert_same(joined, sweep("grid", to=tmp_path / "whole.h5"))


# --- what is refused -------------------------------------------------------------------------------


@pytest.fixture
def grid_parts(tmp_path):
    return parts_of("grid", tmp_path)


def joined_to(folder, paths, **options):
    return fl.join(paths, to=folder / "maps.h5", **options)


def test_missing_parts_are_named(tmp_path, grid_parts):
    grid_parts[1].rename(tmp_path / "maps.part-2-of-3.h5.part")
    with refused("part 2 of 3 (designs 11 to 22) is missing", "part='2/3'"):
        joined_to(tmp_path, tmp_path)
    with pytest.raises(fl.InputError, match="of a run that has not finished"):
        joined_to(tmp_path, tmp_path)
    assert not (tmp_path / "maps.h5").exists()
    with refused("paths", "part='3/3'"):
        joined_to(tmp_path, [*grid_parts[:1], tmp_path / "maps.part-2-of-3.h5.part"])


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


def test_parts_of_another_request_or_division_are_refused(tmp_path, grid_parts):
    sweep("grid", part=(1, 4), to=tmp_path / "quarter.h5").close()
    sweep("table", part=(1, 3), to=tmp_path / "table.h5").close()
    with refused("quarter.h5", "all of the same n"):
        joined_to(tmp_path, [*grid_parts, tmp_path / "quarter.h5"])
    with refused("table.h5", "the parts of one map"):
        joined_to(tmp_path, [*grid_parts, tmp_path / "table.h5"])
    with refused("paths"):
        joined_to(tmp_path, [tmp_path / "quarter.h5", tmp_path / "table.h5"])


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


def flip(path, offset):
    with open(path, "r+b") as file:
        file.seek(offset)
        byte = file.read(1)
        file.seek(offset)
        file.write(bytes([byte[0] ^ 4]))


def test_a_damaged_part_is_refused_by_name_and_its_new_run_joined(tmp_path, monkeypatch):
    monkeypatch.setattr(journal, "STEP_SECONDS", 0.0)
    of = (*LARGE, {"theta1": 72})
    paths = parts_of(of, tmp_path)
    with h5py.File(paths[2], "r") as file:
        place = Stored.of(file).values["theta4"]
    flip(paths[2], place.offset + place.nbytes - 3)
    with refused("maps.part-3-of-3.h5", "run that part again"):
        joined_to(tmp_path, paths)
    assert not (tmp_path / "maps.h5").exists()
    sweep(of, part=(3, 3), to=paths[2], overwrite=True).close()
    with joined_to(tmp_path, paths) as joined:
        assert_same(joined, sweep(of, to=tmp_path / "whole.h5"))


def test_damaged_labels_and_marks_are_refused(tmp_path, grid_parts):
    content = grid_parts[1].read_bytes()
    for text in (b"part_number", b"Euclidean", b"whole_fingerprint"):
        flip(grid_parts[1], content.index(text) + 2)
        with refused("paths"):
            joined_to(tmp_path, tmp_path)
        assert not (tmp_path / "maps.h5").exists()
        grid_parts[1].write_bytes(content)
    joined_to(tmp_path, tmp_path).close()


def test_studies_in_parts_are_joined_by_the_command_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    study, runner = str(written(GOOD)), CliRunner()
    for part in ("1/3", "3/3"):
        assert runner.invoke(app, ["run", study, "--part", part, "--verify", "0"]).exit_code == 0
    missing = runner.invoke(app, ["join", ".", "--to", "maps.h5"])
    assert missing.exit_code == 2
    assert_refusal(ValueError(missing.output.strip()), "part 2 of 3", "fastlink run --part 2/3")
    assert runner.invoke(app, ["run", study, "--part", "2/3", "--verify", "0", "--quiet"]).exit_code == 0
    done = runner.invoke(app, ["join", "study.part-*.h5", "--to", "study.h5"])
    assert done.exit_code == 0, done.output
    assert "of 3 parts together" in done.output
    again = runner.invoke(app, ["run", study, "--verify", "0"])
    assert "study.h5 is up to date" in again.output

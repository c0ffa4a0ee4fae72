"""A run that was killed or interrupted is gone on with, and ends with the same bits."""

import errno
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.map_files import failing_after, flip, left_in, raising
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.codegen.kernel import Kernel
from fastlink.io import partial_file
from fastlink.io.checksums import missing
from fastlink.io.layout import FINGERPRINT, WRITTEN
from fastlink.io.output_path import part_of
from fastlink.io.partial_file import Journal, journal_of, read_journal

COUPLERS, OUTPUTS = np.linspace(1.0, 1.4, 41), np.linspace(0.6, 1.0, 31)
FIXED = {"a1": 0.4, "a4": 1.0}
SPEEDS = {"omega1": np.array([1.0, 5.0, 25.0])}
LENGTHS = {"a2": COUPLERS, "a3": OUTPUTS}
FEW = {"a2": COUPLERS[:20], "a3": OUTPUTS}
TABLE = fl.table(
    FIXED | {"a2": np.linspace(1.0, 1.4, 900), "a3": 0.8, "maker": [f"No. {k}" for k in range(900)]}
)
NAMES = ["omega4_max", "theta4", "grashof_class"]
GRID = fl.grid(**FIXED, **LENGTHS, omega1=2.0)
#: Designs and options of runs whose results, or coordinates too, are written block by block, in every order.
RUNS = {
    "grid": (GRID, {}),
    "an axis that scales": (fl.grid(**FIXED, **FEW, **SPEEDS), {}),
    "layout of maps": (GRID, {"layout": "maps"}),
    "layout of maps, an axis that scales": (fl.grid(**FIXED, **SPEEDS, **FEW), {"layout": "maps"}),
    "consecutive designs": (GRID.consecutive(100, 1100), {}),
    "consecutive rows with texts": (TABLE.with_constants({"omega1": 2.0}).consecutive(10, 610), {}),
    "consecutive rows, an axis that scales": (TABLE.consecutive(100, 500).with_axis("omega1", [1.0, 2.5, 7.0]), {}),
    "consecutive rows, an axis": (
        fl.grid(**FIXED, a2=np.linspace(1.0, 1.4, 500), omega1=2.0).consecutive(100, 400).with_axis("a3", [0.7, 0.8]),
        {},
    ),
    "part": (GRID, {"part": (2, 3)}),
    "part, an axis that scales": (fl.grid(**FIXED, **SPEEDS, **FEW), {"part": (2, 3)}),
}  # fmt: skip


def sweep(to, run="grid", **options):
    space, of_run = RUNS[run]
    given = {"theta1": 8, "block": 16, "threads": 1, "verify": 1, "branch": (1, 2), "to": to}
    return sweep_4r(space, NAMES, **given | of_run | options)


def interrupted(monkeypatch, path, records, **options):
    """Sweep until so many blocks are written; return the interrupt."""
    with monkeypatch.context() as patched:
        patched.setattr(partial_file, "STEP_SECONDS", 0.0)
        failing_after(patched, records, KeyboardInterrupt())
        with pytest.raises(KeyboardInterrupt) as caught:
            sweep(path, **options)
    assert not path.exists()
    return caught.value


def assert_same(resumed, expected):
    """Assert the same values, coordinates and counts of designs."""
    assert set(resumed.variables) == set(expected.variables)
    for name in expected.variables:
        assert_array_equal(resumed[name], expected[name], err_msg=name)
    counts = [name for name in expected.attrs if name.startswith("designs_") and name != "designs_per_second"]
    assert len(counts) >= 5
    assert all(resumed.attrs[name] == expected.attrs[name] for name in counts)


@pytest.mark.sample(2)
@pytest.mark.parametrize("run", RUNS)
def test_an_interrupted_run_goes_on(tmp_path, monkeypatch, run):
    path = tmp_path / "map.h5"
    assert "run the same again" in interrupted(monkeypatch, path, 5, run=run).__notes__[0]
    other = {"part": (1, 3)} if "part" in run else {"layout": "curves"} if "layout" in run else {"theta1": 9}
    with refused("to", "restart=True"):
        sweep(path, run, **other)
    for door in (fl.check, fl.open):
        with refused("map.h5.part: is of a run that has not finished", "run the same again to go on"):
            door(part_of(path))
    # the rest with other blocks and threads
    with sweep(path, run, block=40, threads=2) as resumed, sweep(tmp_path / "whole.h5", run) as expected:
        done = resumed.attrs["designs_of_earlier_runs"]
        assert 0 < done < resumed.status.size
        assert "scales" in run or done == 5 * 16
        assert "designs_of_earlier_runs" not in expected.attrs
        assert_same(resumed, expected)
        with sweep(path, run) as again:  # finished
            assert again.attrs == resumed.attrs
    assert fl.check(path)
    assert left_in(tmp_path) == ["map.h5", "whole.h5"]


def place_of(path, name, design):
    """Return where a file holds the first value of a design."""
    with h5py.File(path) as file:
        data = file[name]
        a_design = data.nbytes // data.shape[0] if data.ndim == 1 or name != "theta4" else data.dtype.itemsize
        return data.id.get_offset() + design * a_design


@pytest.mark.parametrize(
    ("run", "name"),
    [
        ("grid", "theta4"),
        ("layout of maps, an axis that scales", "theta4"),
        ("consecutive designs", "a2"),
        ("consecutive designs", "design"),
    ],
)
def test_what_has_changed_of_a_partial_file_is_computed_again(tmp_path, monkeypatch, small_blocks, run, name):
    path = tmp_path / "map.h5"
    interrupted(monkeypatch, path, 20, run=run)
    part = tmp_path / "map.h5.part"
    flip(part, place_of(part, name, 20))
    with pytest.warns(fl.InputWarning, match="designs have changed; they are computed again"):
        found = sweep(path, run)
    with found, sweep(None, run) as expected:
        assert 0 < found.attrs["designs_of_earlier_runs"] < found.status.size
        assert_same(found, expected)
    assert fl.check(path)
    flip(path, place_of(path, name, 20))
    assert list(fl.check(path).damaged) == [name]


def test_another_sweep_is_refused_and_starts_afresh_when_told(tmp_path, monkeypatch):
    path = tmp_path / "map.h5"
    interrupted(monkeypatch, path, 5)
    before = [one.read_bytes() for one in sorted(tmp_path.iterdir())]
    with refused("to", "restart=True"):
        sweep(path, theta1=9)
    assert [one.read_bytes() for one in sorted(tmp_path.iterdir())] == before
    with sweep(path, theta1=9, restart=True) as resumed:
        assert "designs_of_earlier_runs" not in resumed.attrs
    assert [path.name for path in tmp_path.iterdir()] == ["map.h5"]


def test_a_sweep_may_be_interrupted_again_and_again(tmp_path, monkeypatch):
    path = tmp_path / "map.h5"
    for _ in range(3):
        interrupted(monkeypatch, path, 4)
    with sweep(path) as resumed, sweep(tmp_path / "whole.h5") as expected:
        assert resumed.attrs["designs_of_earlier_runs"] == 12 * 16
        assert "resumed         192 designs from an earlier run" in resumed.fastlink.summary()
        assert_same(resumed, expected)


KILLED = """
import os, signal, sys, threading
import numpy as np
import fastlink as fl
from fastlink.io import partial_file
partial_file.STEP_SECONDS = 0.0
commit, add = partial_file.Journal._commit, partial_file.Journal.add
place, kill_at = sys.argv[1], int(sys.argv[2])
seen = commits = 0
changed = threading.Condition()
def counted(self):
    global seen, commits
    commit(self)
    seen += os.path.exists(place + ".part.journal")
    if seen == kill_at:
        os.kill(os.getpid(), signal.SIGKILL)
    with changed:
        commits += 1
        changed.notify_all()
def waits(self, ranges, addends):
    # until a commit that began after it: however slow the disk, the sweep does not end before it is killed
    add(self, ranges, addends)
    with changed:
        wanted = commits + 2
        assert changed.wait_for(lambda: commits >= wanted, timeout=60)
partial_file.Journal._commit, partial_file.Journal.add = counted, waits
fl.sweep(
    "planar_4r",
    fl.grid(a1=0.4, a2=np.linspace(1.0, 1.4, 41), a3=np.linspace(0.6, 1.0, 31), a4=1.0, omega1=2.0),
    ["omega4_max", "theta4", "grashof_class"], theta1=8, block=8, threads=2, to=place, verify=2, branch=(1, 2),
)
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")
def test_a_killed_run_loses_nothing_that_was_noted(tmp_path):
    path = tmp_path / "map.h5"
    run = subprocess.run([sys.executable, "-c", KILLED, str(path), "2"], check=False, capture_output=True)
    assert run.returncode == -signal.SIGKILL, run.stderr.decode()
    designs = sum(stop - start for start, stop in read_journal(tmp_path / "map.h5.part")[1])
    assert designs > 0
    with sweep(path) as resumed, sweep(tmp_path / "whole.h5") as expected:
        assert resumed.attrs["designs_of_earlier_runs"] == designs
        assert_same(resumed, expected)


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_a_resumed_run_that_cannot_begin_its_journal_keeps_that_of_the_run_before(
    tmp_path, monkeypatch, step
):
    """What was noted stays noted: the old journal goes when the new one names the same designs."""
    path = tmp_path / "map.h5"
    interrupted(monkeypatch, path, 5)
    start = Journal._start
    with monkeypatch.context() as patched:

        def failing(self, first):
            with monkeypatch.context() as within:
                within.setattr(partial_file.os, step, raising(errno.EIO))
                return start(self, first)

        patched.setattr(Journal, "_start", failing)
        with refused("to"):
            sweep(path)
    assert read_journal(tmp_path / "map.h5.part")[1] == [(0, 5 * 16)]
    with sweep(path) as resumed:
        assert resumed.attrs["designs_of_earlier_runs"] == 5 * 16


def test_at_no_moment_are_noted_designs_without_a_journal(tmp_path, monkeypatch):
    """Where a resumed run is killed just after its journal has replaced that of the run before."""
    part = tmp_path / "map.h5.part"
    part.write_bytes(b"data")
    fd = os.open(part, os.O_RDWR)
    replaced = []
    replace = os.replace
    monkeypatch.setattr(
        os, "replace", lambda *names: (replace(*names), replaced.append(read_journal(part)[1]))
    )
    notes = Journal(fd, part, {"fingerprint": "f", "offsets": {}}, [(0, 2)], {0: 12})
    notes.close()
    assert replaced == [[(0, 2)]]
    os.close(fd)


def test_a_torn_record_ends_the_journal(tmp_path):
    part = tmp_path / "map.h5.part"
    part.write_bytes(b"data")
    fd = os.open(part, os.O_RDWR)
    notes = Journal(fd, part, {"fingerprint": "f", "offsets": {}}, [(0, 2)], {0: 12})
    notes.add([(2, 4)], [(0, 5)])
    notes._commit()
    notes.add([(6, 8)], [(0, 3), (1, 8), (1, 1)])
    notes.close()
    first, both = ([(0, 4)], {0: 12 ^ 5}), ([(0, 4), (6, 8)], {0: 12 ^ 5 ^ 3, 1: 8 ^ 1})
    assert (read_journal(part)[1:], missing(both[0], 9)) == (both, [(4, 6), (8, 9)])
    whole = journal_of(part).read_bytes()
    head, second = whole.index(b"\n"), whole.rindex(b"\n", 0, -1)
    assert read_journal(part)[0]["fingerprint"] == "f"
    for place in range(second + 1, len(whole) - 1):
        journal_of(part).write_bytes(whole[:place])
        assert read_journal(part)[1:] == first
    for place in range(len(whole) - 1):
        flipped = bytearray(whole)
        flipped[place] ^= 1
        journal_of(part).write_bytes(flipped)
        found = read_journal(part)
        if place <= head:
            assert found is None
        else:
            assert found[1:] == (first if place > second else ([], {}))
    os.close(fd)


# == A map that is there already: used where it is that of the request, else refused with what differs =======

DESIGNS = {"a1": 0.4, "a2": np.array([1.1, 1.2]), "a3": 0.8, "a4": 1.0, "omega1": 2.0}
FOCAL = {"mechanism": "focal", "space": {"a": 2.0, "b": 3.0, "c": 4.0, "d": 5.0, "s": 1.0}}
REQUEST = {"mechanism": "planar_4r", "space": DESIGNS, "quantities": ["omega4"], "theta1": 12, "verify": 2}


def swept(path, **changes):
    request = {name: value for name, value in {**REQUEST, **changes}.items() if value is not None}
    names = [request.pop(name) for name in ("mechanism", "space", "quantities")]
    names[1] = names[1] if isinstance(names[1], fl.DesignSpace) else fl.grid(**names[1])
    return fl.sweep(*names, to=path, **{"branch": (1, 2)} | request)


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    """Return the path of a finished map."""
    path = tmp_path_factory.mktemp("finished") / "maps.h5"
    swept(path).close()
    return path


@pytest.fixture
def path(original, tmp_path):
    """Return the path of a finished map of the test alone."""
    return Path(shutil.copy2(original, tmp_path / "maps.h5"))


@pytest.fixture
def nothing_is_compiled(monkeypatch):
    monkeypatch.setattr(Kernel, "compiled", lambda *_: pytest.fail("compiled"))


@pytest.mark.parametrize("same", [{}, {"verify": 1, "threads": 1, "block": 1}])
def test_the_same_request_opens_the_map(path, same, nothing_is_compiled):
    before = path.stat()
    with swept(path, **same) as maps:
        assert maps.omega4.shape == (2, 2, 12)
        assert maps.attrs[WRITTEN] == before.st_mtime_ns
        assert len(maps.attrs[FINGERPRINT]) == 64
    assert (path.stat().st_mtime_ns, path.stat().st_ino) == (before.st_mtime_ns, before.st_ino)


@pytest.mark.parametrize(
    ("change", "differs"),
    [
        ({"quantities": ["omega4", "theta4"]}, "quantities"),
        ({"space": {**DESIGNS, "a3": np.nextafter(0.8, 1.0)}}, "a3"),
        ({"theta1": 13}, "theta1"),
        ({"branch": [2, 1]}, "branch"),
        ({"attrs": {"project": "press"}}, "project"),
        (FOCAL | {"quantities": ["m"], "theta1": None}, ""),
        ({"verify": 3, "space": {**DESIGNS, "a2": [1.1, 1.2, 1.3]}}, "a2"),
    ],
)
def test_another_request_is_refused_with_what_differs(path, change, differs, nothing_is_compiled):
    before = path.read_bytes()
    with refused(
        f"the file exists, a map {'with other ' + differs if differs else 'of planar_4r'}", "overwrite=True"
    ):
        swept(path, **change)
    assert path.read_bytes() == before


def test_more_verified_designs_and_the_last_value_of_a_long_attribute_make_another_request(tmp_path):
    values = np.arange(5000.0)
    swept(tmp_path / "maps.h5", attrs={"weights": values}).close()
    swept(tmp_path / "maps.h5", attrs={"weights": values}).close()
    with refused("other weights"):
        swept(tmp_path / "maps.h5", attrs={"weights": np.where(values == 2500.0, -1.0, values)})
    swept(tmp_path / "verified.h5", verify=0).close()
    with refused("with 0 verified designs, not 2"):
        swept(tmp_path / "verified.h5", verify=64)


def test_a_table_or_map_that_changed_since_is_another_request_and_so_is_another_version(
    tmp_path, path, monkeypatch
):
    of_table, table = tmp_path / "of_table.h5", tmp_path / "designs.csv"
    table.write_text("a1,a2\n0.4,1.1\n0.5,1.2\n")
    constants = {"a3": 0.8, "a4": 1.0, "omega1": 2.0}
    swept(of_table, space=fl.table(table).with_constants(constants)).close()
    swept(of_table, space=fl.table(table).with_constants(constants)).close()
    table.write_text("a1,a2\n0.4,1.1\n0.5,1.3\n")
    with refused("other a2"):
        swept(of_table, space=fl.table(table).with_constants(constants))
    time.sleep(0.02)  # two ticks of a kernel's clock of 100 Hz
    with h5py.File(path, "r+") as file:
        file["omega4"][0, 0, 0] = 7.0
    with refused("changed or copied since it was written", "overwrite=True"):
        swept(path)
    with swept(path, overwrite=True) as maps:
        assert float(maps.omega4[0, 0, 0]) != 7.0
    shutil.copy2(path, tmp_path / "copy.h5")
    swept(tmp_path / "copy.h5").close()  # a copy with its times
    os.utime(path, ns=(0, path.stat().st_mtime_ns // 10**9 * 10**9))
    swept(path).close()  # moved to a file system that knows whole seconds
    from fastlink.engine import labels, resolve

    monkeypatch.setattr(labels, "__version__", "9.9")
    with refused("other versions"):
        swept(path)
    monkeypatch.undo()
    monkeypatch.setattr(resolve, "environment", lambda: b"other code")
    with refused("a map by another version"):
        swept(path)

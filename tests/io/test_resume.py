"""A run that was killed or interrupted is gone on with, and ends with the same bits."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.map_files import raising
from tests.support.refusals import refused

import fastlink as fl
from fastlink.io import partial_file
from fastlink.io.checksums import missing
from fastlink.io.partial_file import Journal, journal_of, read_journal
from fastlink.io.writer import Writer

COUPLERS, OUTPUTS = np.linspace(1.0, 1.4, 41), np.linspace(0.6, 1.0, 31)
DESIGNS = {"a1": 0.4, "a2": COUPLERS, "a3": OUTPUTS, "a4": 1.0}
SPEEDS = {"omega1": np.array([1.0, 5.0, 25.0])}
NAMES = ["omega4_max", "theta4", "grashof_class"]


def sweep(to, **given):
    options = {
        "theta1": 8,
        "block": 64,
        "threads": 1,
        "to": to,
        "verify": 1,
        "branch": given.pop("branch", (1, 2)),
    }
    options |= given.pop("options", {})
    return fl.sweep(
        "planar_4r", fl.grid(**(DESIGNS | {"omega1": 2.0} | given)), NAMES, **{"branch": (1, 2)} | options
    )


def interrupt_after(monkeypatch, records):
    """Let a sweep be interrupted once so many blocks are written."""
    record = Writer.record

    def counted(self, start, stop, seen=[0]):  # noqa: B006
        record(self, start, stop)
        seen[0] += 1
        if seen[0] == records:
            raise KeyboardInterrupt

    monkeypatch.setattr(Writer, "record", counted)


def assert_same(resumed, expected):
    for name in expected:
        assert_array_equal(resumed[name], expected[name], err_msg=name)
    counts = [name for name in expected.attrs if name.startswith("designs_") and name != "designs_per_second"]
    assert len(counts) >= 5
    assert all(resumed.attrs[name] == expected.attrs[name] for name in counts)


@pytest.mark.parametrize("given", [{}, {"a2": COUPLERS[:20], **SPEEDS}])
def test_an_interrupted_sweep_goes_on(tmp_path, monkeypatch, given):
    path = tmp_path / "map.h5"
    with monkeypatch.context() as patched:
        interrupt_after(patched, 5)
        with pytest.raises(KeyboardInterrupt) as caught:
            sweep(path, **given)
    assert "run the same again" in caught.value.__notes__[0]
    assert not path.exists()
    # the rest with other blocks and threads
    more = {"options": {"block": 40, "threads": 2}}
    with sweep(path, **given, **more) as resumed, sweep(tmp_path / "whole.h5", **given) as expected:
        assert resumed.attrs["designs_of_earlier_runs"] == 5 * 64 * (3 if "omega1" in given else 1)
        assert "designs_of_earlier_runs" not in expected.attrs
        assert_same(resumed, expected)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["map.h5", "whole.h5"]


@pytest.mark.parametrize("change", [{"omega1": 3.0}, {"options": {"theta1": 9}}])
def test_another_sweep_is_refused_and_starts_afresh_when_told(tmp_path, monkeypatch, change):
    path = tmp_path / "map.h5"
    with monkeypatch.context() as patched:
        interrupt_after(patched, 5)
        with pytest.raises(KeyboardInterrupt):
            sweep(path)
    before = [one.read_bytes() for one in sorted(tmp_path.iterdir())]
    with refused("to", "restart=True"), sweep(path, **change):
        pass
    assert [one.read_bytes() for one in sorted(tmp_path.iterdir())] == before
    change = {**change, "options": {**change.get("options", {}), "restart": True}}
    with sweep(path, **change) as resumed:
        assert "designs_of_earlier_runs" not in resumed.attrs
    assert [path.name for path in tmp_path.iterdir()] == ["map.h5"]


def test_a_sweep_may_be_interrupted_again_and_again(tmp_path, monkeypatch):
    path = tmp_path / "map.h5"
    for _ in range(3):
        with monkeypatch.context() as patched:
            interrupt_after(patched, 4)
            with pytest.raises(KeyboardInterrupt):
                sweep(path)
    with sweep(path) as resumed, sweep(tmp_path / "whole.h5") as expected:
        assert resumed.attrs["designs_of_earlier_runs"] == 12 * 64
        assert "resumed         768 designs from an earlier run" in resumed.fastlink.summary()
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
    with monkeypatch.context() as patched:
        interrupt_after(patched, 5)
        with pytest.raises(KeyboardInterrupt):
            sweep(path)
    start = Journal._start
    with monkeypatch.context() as patched:

        def failing(self, first):
            with monkeypatch.context() as within:
                within.setattr(partial_file.os, step, raising(errno.EIO))
                return start(self, first)

        patched.setattr(Journal, "_start", failing)
        with refused("to"):
            sweep(path)
    assert read_journal(tmp_path / "map.h5.part")[1] == [(0, 5 * 64)]
    with sweep(path) as resumed:
        assert resumed.attrs["designs_of_earlier_runs"] == 5 * 64


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

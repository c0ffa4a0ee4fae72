"""Whatever happens to a run, nothing finished is touched, nothing noted is lost, nothing wrong gets the name."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.faults import FAULTS
from tests.support.map_files import Sample, digest, left_in, raising
from tests.support.refusals import refused

import fastlink as fl
from fastlink.io.reader import open_map
from fastlink.io.writing import journal, partial_file, writer
from fastlink.io.writing.journal import journal_of

COUPLERS = np.linspace(1.0, 1.4, 64)


def sweep(to, **options):
    return fl.sweep(
        "planar_4r",
        fl.grid(a1=0.4, a2=COUPLERS, a3=0.8, a4=1.0, omega1=2.0),
        ["omega4_max", "theta4"],
        **{"theta1": 8, "block": 8, "threads": 1, "verify": 2, "to": to, **options},
    )


@pytest.fixture
def expected():
    with sweep(None) as found:
        yield found.load()


def assert_resumes(path, expected, designs):
    """Assert that the same request goes on after so many designs, to the same bits."""
    with sweep(path) as resumed:
        assert resumed.attrs["designs_of_earlier_runs"] == designs
        for name in expected:
            assert_array_equal(resumed[name], expected[name], err_msg=name)
    assert left_in(path.parent) == [path.name]


# --- nothing finished is touched -------------------------------------------------------------------


@pytest.mark.parametrize("with_journal", [False, True])
def test_a_second_name_that_a_kill_has_left_of_a_map_is_not_emptied(tmp_path, with_journal):
    """Of systems that cannot rename without replacing: a kill between link and unlink leaves both names."""
    path, part, kept = tmp_path / "m.h5", tmp_path / "m.h5.part", tmp_path / "kept.h5"
    sweep(path).close()
    os.link(path, part)
    if with_journal:
        journal_of(part).write_text("of the run that was killed")
    before = digest(path)
    path.rename(kept)
    sweep(path).close()
    assert (digest(kept), kept.stat().st_nlink, left_in(tmp_path)) == (before, 1, ["kept.h5", "m.h5"])


def test_a_second_name_of_the_map_itself_is_removed(tmp_path):
    path, part = tmp_path / "m.h5", tmp_path / "m.h5.part"
    sweep(path).close()
    os.link(path, part)
    before = digest(path)
    with refused("to"):
        sweep(path, theta1=9)
    assert digest(path) == before
    sweep(path, overwrite=True).close()
    assert left_in(tmp_path) == ["m.h5"]


@pytest.mark.parametrize("ending", [".part", ".part.new", ".part.journal", ".part.journal.new"])
def test_what_a_link_leads_to_is_not_written(tmp_path, monkeypatch, ending):
    monkeypatch.setattr(journal, "STEP_SECONDS", 0.0)
    precious, path = tmp_path / "precious", tmp_path / "m.h5"
    precious.write_text("mine")
    (tmp_path / f"m.h5{ending}").symlink_to(precious)
    if ending == ".part":
        with refused("to", "remove it"):
            sweep(path)
    else:
        sweep(path).close()
    assert precious.read_text() == "mine"


def test_links_that_lead_to_themselves_are_refused_before_anything_is_computed(tmp_path):
    (tmp_path / "a.h5").symlink_to(tmp_path / "b.h5")
    (tmp_path / "b.h5").symlink_to(tmp_path / "a.h5")
    with refused("to", "choose another name"):
        sweep(tmp_path / "a.h5")


def test_a_whole_map_without_its_name_is_refused_to_another_request(tmp_path):
    """Where another file has taken the name during the run."""
    path, part = tmp_path / "m.h5", tmp_path / "m.h5.part"
    with pytest.raises(fl.InputError, match="cannot give the complete file its name"):
        Sample().save(path, between=lambda: path.write_text("mine"))
    path.unlink()
    before = digest(part)
    with refused("to", "restart=True"):
        sweep(path)
    assert digest(part) == before
    sweep(path, restart=True).close()
    assert left_in(tmp_path) == ["m.h5"]


# --- nothing noted is lost -------------------------------------------------------------------------


def failing_after(patch, count, error):
    """Let the block after so many raise."""
    record = writer.Writer.record

    def counted(self, start, stop, seen=[0]):  # noqa: B006
        record(self, start, stop)
        seen[0] += 1
        if seen[0] == count:
            raise error

    patch.setattr(writer.Writer, "record", counted)


@pytest.mark.parametrize(
    "error", [KeyboardInterrupt(), ZeroDivisionError(), MemoryError(), OSError(errno.EIO, "I/O")]
)
def test_after_any_exception_a_run_goes_on(tmp_path, monkeypatch, error, expected):
    path = tmp_path / "m.h5"
    with monkeypatch.context() as patch:
        failing_after(patch, 3, error)
        with pytest.raises(type(error)) as caught:
            sweep(path)
    (note,) = caught.value.__notes__
    assert note.startswith("38% of the designs are kept in ")
    assert_resumes(path, expected, 24)


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EIO, errno.EFBIG])
def test_after_a_write_that_failed_late_a_run_goes_on(tmp_path, monkeypatch, number, expected):
    path = tmp_path / "m.h5"
    pwrite = os.pwrite

    def failing(fd, data, position, seen=[0]):  # noqa: B006
        seen[0] += 1
        if seen[0] > 9:  # three blocks of three variables
            raise OSError(number, os.strerror(number))
        return pwrite(fd, data, position)

    with monkeypatch.context() as patch:
        patch.setattr(os, "pwrite", failing)
        with pytest.raises(fl.InputError) as caught:
            sweep(path)
    assert "38% of the designs are kept" in caught.value.__notes__[0]
    assert_resumes(path, expected, 24)


ENDS = {
    "the last synchronisation": lambda patch: patch.setattr(os, "fsync", raising(errno.EIO)),
    "the last attributes": lambda patch: patch.setattr(writer, "set_attrs", raising(errno.EIO)),
    "the time of the file": lambda patch: patch.setattr(os, "utime", raising(errno.EPERM)),
    "its name": lambda patch: patch.setattr(partial_file, "_rename", raising(errno.EACCES)),
}


@pytest.mark.parametrize("end", ENDS.values(), ids=ENDS)
def test_a_failure_of_the_end_loses_nothing(tmp_path, monkeypatch, end, expected):
    path = tmp_path / "m.h5"
    with monkeypatch.context() as patch:
        patch.setattr(journal, "STEP_SECONDS", 0.0)
        start = journal.Journal._start
        # the journal's own first lines pass
        patch.setattr(journal.Journal, "_start", lambda self: start(self))
        fsync = os.fsync
        end(patch)
        patch.setattr(journal.os, "fsync", fsync) if os.fsync is fsync else None
        with pytest.raises(fl.InputError):
            sweep(path)
    assert not path.exists()
    with sweep(path) as resumed:
        for name in expected:
            assert_array_equal(resumed[name], expected[name], err_msg=name)
    assert left_in(tmp_path) == ["m.h5"]


def test_a_failed_synchronisation_is_not_forgotten(tmp_path, monkeypatch, expected):
    """The system reports it once: what was written since may be lost though all later calls succeed."""
    path = tmp_path / "m.h5"
    monkeypatch.setattr(journal, "STEP_SECONDS", 0.0)
    synchronise, calls = journal.synchronise, []

    def failing_once(fd):
        calls.append(fd)
        if len(calls) == 3:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        synchronise(fd)

    with monkeypatch.context() as patch:
        patch.setattr(journal, "synchronise", failing_once)
        with pytest.raises(fl.InputError, match="Input/output error"):
            sweep(path, block=1)
    assert not path.exists()
    with sweep(path) as resumed:
        for name in expected:
            assert_array_equal(resumed[name], expected[name], err_msg=name)


def test_an_interrupt_in_the_finish_waits_for_its_end(tmp_path, monkeypatch):
    path = tmp_path / "m.h5"
    set_attrs = writer.set_attrs

    def interrupted(*arguments):
        signal.raise_signal(signal.SIGINT)
        set_attrs(*arguments)

    monkeypatch.setattr(writer, "set_attrs", interrupted)
    with pytest.raises(KeyboardInterrupt):
        sweep(path)
    assert left_in(tmp_path) == ["m.h5"]
    open_map(path).close()


def test_an_interrupt_of_the_verification_keeps_all_designs(tmp_path, monkeypatch, expected):
    path = tmp_path / "m.h5"

    def interrupted(self):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("fastlink.precision.Verification.measure", interrupted)
        with pytest.raises(KeyboardInterrupt) as caught:
            sweep(path)
    assert "100% of the designs are kept" in caught.value.__notes__[0]
    assert_resumes(path, expected, 64)


# --- faults by the hundred -------------------------------------------------------------------------

TRIAL = """
import os, signal, sys, traceback
import fastlink as fl
from fastlink.io.writing import journal
from tests.io.test_faults import sweep
from tests.support.faults import Injector
journal.STEP_SECONDS = 0.0
sweep(None).close()  # its kernels are loaded
for line in sys.stdin:
    path, at, fault = line.split()
    child = os.fork()
    if not child:
        injector = Injector(int(at), fault)
        injector.install()
        try:
            sweep(path, verify=0).close()
            code = 0
        except KeyboardInterrupt:
            code = 130
        except fl.InputError as error:
            code = 2
        except BaseException:
            traceback.print_exc()
            code = 1
        os._exit(code)
    status = os.waitpid(child, 0)[1]
    print(os.waitstatus_to_exitcode(status), flush=True)
"""


class Trials:
    """Runs of a sweep in a process of their own, each with a fault."""

    def __init__(self):
        command = [sys.executable, "-c", TRIAL]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def code(self, path, at, fault):
        """Return how a run ended."""
        print(path, at, fault, file=self.process.stdin, flush=True)
        return int(self.process.stdout.readline())

    def close(self):
        self.process.stdin.close()
        assert self.process.wait(60) == 0
        self.process.stdout.close()


def assert_survives(folder: Path, code: int, fault: str, expected) -> str:
    """Assert what must hold after a fault, and that the next run ends well; return the outcome."""
    path = folder / "m.h5"
    assert code in {"kill": (-9, 0), "interrupt": (130, 0)}.get(fault, (2, 0)), code
    if path.exists():
        with open_map(path) as found:
            for name in expected:
                assert_array_equal(found[name], expected[name], err_msg=name)
        outcome = "finished"
    else:
        assert code != 0
        outcome = "loud" if code > 0 else "killed"
    read = journal.read_journal(folder / "m.h5.part")
    noted = 0 if read is None or path.exists() else sum(stop - start for start, stop in read[1])
    with sweep(path, verify=0) as found:
        for name in expected:
            assert_array_equal(found[name], expected[name], err_msg=name)
        if outcome != "finished":
            assert found.attrs.get("designs_of_earlier_runs", 0) == noted
    assert left_in(folder) == ["m.h5", "other.h5"]
    assert (folder / "other.h5").read_text() == "mine"
    return outcome


def run_trials(tmp_path, expected, count, seed):
    rng = np.random.default_rng(seed)
    trials, table = Trials(), Counter()
    try:
        for k in range(count):
            folder = tmp_path / str(k)
            folder.mkdir()
            (folder / "other.h5").write_text("mine")
            fault = list(FAULTS)[k % len(FAULTS)]
            code = trials.code(folder / "m.h5", rng.integers(0, 130), fault)
            table[fault, assert_survives(folder, code, fault, expected)] += 1
    finally:
        trials.close()
    return table


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_faults_of_system_calls(tmp_path, expected):
    table = run_trials(tmp_path, expected, 16, seed=1)
    assert len({fault for fault, _ in table}) == len(FAULTS)


@pytest.mark.stress
@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_thousand_faults_of_system_calls(tmp_path, expected, capsys):
    table = run_trials(tmp_path, expected, 1000, seed=2)
    with capsys.disabled():
        print("\nfault       outcome   times")
        for (fault, outcome), count in sorted(table.items()):
            print(f"{fault:<11} {outcome:<9} {count:>5}")
        print("wrong 0, lost 0")

"""The place of a map file: other processes, systems that lack something, full disks, bad places."""

import errno
import multiprocessing
import os
import resource
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import xarray as xr
from tests.support.map_files import DESCRIBED, Sample, digest, left_in, raising

from fastlink.errors import InputError
from fastlink.io import output_path, partial_file, writer
from fastlink.io.layout import Variable, coordinates
from fastlink.io.partial_file import check_target
from fastlink.io.reader import open_map
from fastlink.io.writer import Writer, lay_out
from fastlink.space.samplers import grid

# --- other processes -------------------------------------------------------------------------------


def test_what_a_killed_run_left_is_replaced(tmp_path):
    path, part, killed = tmp_path / "m.h5", tmp_path / "m.h5.part", Sample()
    with killed.writer(path) as writer:
        killed.fill(writer)
        content = part.read_bytes()
    part.write_bytes(content)
    (tmp_path / "m.h5.part.new").write_text("of a run killed earlier still")
    with pytest.raises(InputError, match="is of a run that has not finished"):
        open_map(part)
    sample = Sample(seed=1)
    sample.save(path)
    assert left_in(tmp_path) == ["m.h5"]
    with open_map(path) as opened:
        xr.testing.assert_identical(opened, sample.expected())


@pytest.mark.skipif(not hasattr(os, "memfd_create"), reason="files without a name are of Linux")
def test_labels_are_laid_out_in_a_file_without_a_name(tmp_path, monkeypatch):
    """So that a kill leaves none. Files that other tests hold open in this process are not looked at."""
    named = []

    def create_checksums(file, variables, create=writer.create_checksums):
        links = [f"/proc/self/fd/{fd}" for fd in os.listdir("/proc/self/fd")]
        names = [os.readlink(link) for link in links if os.path.lexists(link)]
        named.extend(name for name in names if os.path.isfile(name) and name.startswith(str(tmp_path)))
        return create(file, variables)

    monkeypatch.setattr(writer, "create_checksums", create_checksums)
    Sample().save(tmp_path / "m.h5")
    found = [name for name in named if name.endswith((".h5", ".part", ".new"))]
    assert found == [str(tmp_path / "m.h5.part")]


def test_the_room_of_what_a_killed_run_left_is_given_back_first(tmp_path, monkeypatch):
    part = tmp_path / "m.h5.part"
    part.write_bytes(b"x" * 1_000_000)
    sizes = []

    def observed(*args, **options):
        sizes.append(part.stat().st_size)
        return lay_out(*args, **options)

    monkeypatch.setattr("fastlink.io.writer.lay_out", observed)
    Sample().save(tmp_path / "m.h5")
    assert sizes == [0]


@pytest.mark.parametrize("next_run", [False, True])
def test_a_partial_file_that_gets_its_name_while_it_is_claimed_is_left_alone(tmp_path, monkeypatch, next_run):
    part, other = tmp_path / "m.h5.part", tmp_path / "other.h5"
    part.write_text("complete")
    lock = partial_file._lock

    def published_meanwhile(fd, path):
        if not other.exists():
            part.rename(other)
            if next_run:
                part.write_text("killed early")
        lock(fd, path)

    monkeypatch.setattr(partial_file, "_lock", published_meanwhile)
    with partial_file.claimed(part):
        assert other.read_text() == "complete"
        assert part.read_bytes() == b""


def test_of_two_runs_that_start_at_once_one_is_refused(tmp_path):
    sample, path = Sample(), tmp_path / "m.h5"
    barrier = threading.Barrier(2)

    def start():
        barrier.wait()
        try:
            return sample.writer(path)
        except InputError as error:
            return error

    for _ in range(4):
        with ThreadPoolExecutor(2) as pool:
            results = [future.result() for future in [pool.submit(start), pool.submit(start)]]
        (writer,) = [result for result in results if isinstance(result, Writer)]
        (error,) = [result for result in results if isinstance(result, InputError)]
        message = f"to: {path}.part: another run is writing it; wait for it or choose another name"
        assert str(error) == message
        with writer:
            with pytest.raises(InputError, match="another run is writing it"):
                check_target(path, 0, True)
            sample.fill(writer)
            writer.finish({"run_time": 1.5})
        with open_map(path) as opened:
            xr.testing.assert_identical(opened, sample.expected())
        path.unlink()


# --- systems that lack something -------------------------------------------------------------------

LACKS = {
    "pwrite": lambda patch: patch.delattr(os, "pwrite"),
    "room for a whole write": lambda patch: patch.setattr(
        os, "pwrite", lambda fd, data, at, write=os.pwrite: write(fd, data[:7], at)
    ),
    "fcntl": lambda patch: patch.setattr(partial_file, "fcntl", None),
    "locks": lambda patch: patch.setattr(partial_file.fcntl, "flock", raising(errno.ENOSYS)),
    "posix_fallocate": lambda patch: patch.delattr(os, "posix_fallocate"),
    "reserving": lambda patch: patch.setattr(os, "posix_fallocate", raising(errno.EOPNOTSUPP)),
    "hard links": lambda patch: patch.setattr(os, "link", raising(errno.EPERM)),
}


@pytest.mark.sample(2)
@pytest.mark.parametrize("lack", LACKS.values(), ids=LACKS)
def test_the_same_file_comes_out_where_the_system_lacks(tmp_path, monkeypatch, lack):
    expected = digest(Sample().save(tmp_path / "usual.h5"))
    lack(monkeypatch)
    assert digest(Sample().save(tmp_path / "m.h5")) == expected
    Sample().save(tmp_path / "m.h5", overwrite=True)
    with Sample().writer(tmp_path / "failed.h5"):
        pass
    assert left_in(tmp_path) == ["m.h5", "usual.h5"]


# --- full disks ------------------------------------------------------------------------------------


def test_what_a_killed_run_left_counts_as_free(tmp_path, monkeypatch):
    (tmp_path / "m.h5.part").write_bytes(b"x" * 4_000_000)
    monkeypatch.setattr(partial_file, "free_bytes", lambda path: output_path.SLACK)
    monkeypatch.setattr(output_path, "free_bytes", lambda path: output_path.SLACK)
    assert check_target(tmp_path / "m.h5", 3_900_000, False) == tmp_path / "m.h5"
    with pytest.raises(InputError, match=r"needs 5\.25 MB but 1\.05 MB are free"):
        check_target(tmp_path / "m.h5", 4_200_000, False)


def in_another_process(folder, queue):
    """Write a map while HDF5 is told to lock, and then ever larger ones up to a limit on files."""
    os.environ["HDF5_USE_FILE_LOCKING"] = "TRUE"
    Sample().save(folder / "locked.h5")
    axis = np.arange(1.0, 1001.0)
    coords = coordinates(grid(a2=axis, a3=axis), DESCRIBED, {})
    for limit in (8_500_000, 4_000_000, 4096):
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        try:
            variable = Variable("x", ("a2", "a3"), (1000, 1000), np.dtype("f8"), {})
            Writer(folder / "m.h5", coords, [variable], {})
            queue.put("written")
        except InputError as error:
            queue.put(str(error))


def test_locks_that_the_environment_forces_and_a_limit_on_the_size_of_files(tmp_path):
    context = multiprocessing.get_context("spawn")
    queue = context.Queue()
    process = context.Process(target=in_another_process, args=(tmp_path, queue))
    process.start()
    for message in [queue.get(timeout=60) for _ in range(3)]:
        assert message.startswith(f"to: {tmp_path / 'm.h5'} ")
        assert "\n" not in message
        assert "File too large" in message
    process.join()
    assert process.exitcode == 0
    assert left_in(tmp_path) == ["locked.h5"]
    with open_map(tmp_path / "locked.h5") as opened:
        xr.testing.assert_identical(opened, Sample().expected())


@pytest.mark.parametrize("good_calls", [0, 1], ids=["for the labels", "for the values"])
def test_a_disk_that_fills_up_as_room_is_reserved(tmp_path, monkeypatch, good_calls):
    calls = []

    def reserve(*args):
        calls.append(args)
        if len(calls) > good_calls:
            raising(errno.ENOSPC)()

    monkeypatch.setattr(os, "posix_fallocate", reserve)
    sample = Sample()
    with pytest.raises(InputError) as caught:
        sample.writer(tmp_path / "m.h5")
    assert len(calls) == good_calls + 1
    assert sample.coords.nbytes == 74
    # which has room for them again by now
    assert str(caught.value) == (
        f"to: {tmp_path / 'm.h5'}: the disk or its quota was full (No space left on device); make room, or choose "
        "another disk"
    )
    assert left_in(tmp_path) == []


# --- bad places ------------------------------------------------------------------------------------


def test_places_that_cannot_be_written(tmp_path, monkeypatch):
    def message(path):
        with pytest.raises(InputError) as caught:
            check_target(path, 0, True)
        return str(caught.value)

    assert (
        message(tmp_path) == f"to: {tmp_path} is a folder; add a file name, for instance {tmp_path}/maps.h5"
    )
    assert "there is no folder" in message("~nobody-of-that-name/m.h5")
    missing = tmp_path / "none" / "m.h5"
    assert (
        message(missing) == f"to: {missing}: there is no folder {tmp_path}/none; create it or choose another"
    )
    assert message("/dev/null") == "to: /dev/null is a device or a pipe; choose another name"
    assert "holds the control character" in message("a\0b")
    os.symlink(tmp_path / "b.h5", tmp_path / "a.h5")
    os.symlink(tmp_path / "a.h5", tmp_path / "b.h5")
    assert message(tmp_path / "a.h5").endswith("lead back to themselves; choose another name")
    long = tmp_path / ("x" * 254)
    assert message(long).endswith("cannot be written (File name too long); choose another place")
    monkeypatch.setattr(output_path.tempfile, "TemporaryFile", raising(errno.EACCES))
    path = tmp_path / "m.h5"
    assert message(path) == f"to: {path} cannot be written (Permission denied); choose another place"


FAILURES = [
    (
        "before",
        "pwrite",
        errno.ENOSPC,
        ": the disk or its quota was full \\(No space left on device\\); make",
    ),
    ("between", "fsync", errno.EIO, " cannot be written \\(Input/output error\\); choose another place"),
]


@pytest.mark.parametrize(("moment", "call", "number", "message"), FAILURES)
def test_a_disk_that_fails(tmp_path, monkeypatch, moment, call, number, message):
    failing = {moment: lambda: monkeypatch.setattr(os, call, raising(number))}
    with pytest.raises(InputError, match=f"^to: {tmp_path}/m\\.h5{message}"):
        Sample().save(tmp_path / "m.h5", **failing)
    assert left_in(tmp_path) == []


def test_a_folder_that_cannot_be_written(tmp_path):
    # /proc refuses files to everyone, a folder of mode 0o500 to all but the superuser
    folder = "/proc" if os.geteuid() == 0 else str(tmp_path)
    tmp_path.chmod(0o500)
    with pytest.raises(InputError, match=r"^.*m\.h5 cannot be written \(.*\); choose another place$"):
        check_target(f"{folder}/m.h5", 0, False)
    tmp_path.chmod(0o700)

"""Map files: what is in them, how they appear, and what is refused."""

import errno
import multiprocessing
import os
import random
import re
import resource
import threading
from concurrent.futures import ThreadPoolExecutor

import h5py
import numpy as np
import pytest
import xarray as xr
from tests.support.map_files import DESCRIBED, SPACES, Sample, digest, left_in, raising
from tests.support.refusals import refused

from fastlink.errors import InputError
from fastlink.io import output_path, partial_file, writer
from fastlink.io.layout import Variable, coordinates
from fastlink.io.partial_file import check_target
from fastlink.io.reader import open_map
from fastlink.io.writer import Writer, lay_out
from fastlink.space.samplers import grid


@pytest.mark.parametrize("space", SPACES.values(), ids=SPACES)
def test_the_file_equals_the_dataset_in_memory_in_both_engines(tmp_path, space):
    sample = Sample(space)
    path = sample.save(tmp_path / "m.h5")
    for opened in (open_map(path), xr.open_dataset(path, engine="netcdf4")):
        with opened:
            xr.testing.assert_identical(opened, sample.expected())
            for variable in sample.variables:
                assert opened[variable.name].dtype == variable.dtype
            assert opened.coords["branch"].dtype == np.int8


def test_threads_may_write_in_any_order(tmp_path):
    sample = Sample()
    blocks = [(name, start) for name in sample.arrays for start in range(sample.size)]
    random.Random(1).shuffle(blocks)
    with sample.writer(tmp_path / "m.h5") as writer:
        with ThreadPoolExecutor(4) as pool:
            list(pool.map(lambda b: writer.write(*b, sample.arrays[b[0]][b[1] : b[1] + 1]), blocks))
        writer.finish({"run_time": 1.5})
    with open_map(tmp_path / "m.h5") as opened:
        xr.testing.assert_identical(opened, sample.expected())


def test_the_layout_is_contiguous_aligned_and_without_slack(tmp_path):
    axis = np.linspace(1.0, 2.0, 100)
    coords = coordinates(grid(a2=axis, a3=axis), DESCRIBED, {})
    variables = [Variable(name, ("a2", "a3"), (100, 100), np.dtype("f8"), {}) for name in ("x", "y")]
    path = tmp_path / "m.h5"
    with Writer(path, coords, variables, {}) as writer:
        for name in ("x", "y"):
            writer.write(name, 0, np.ones(10_000))
        writer.finish({})
    with h5py.File(path) as file:
        for name in ("x", "y"):
            assert file[name].chunks is None
            assert file[name].id.get_offset() % 4096 == 0
            assert "_FillValue" not in file[name].attrs
            assert h5py.h5g.get_objinfo(file.id, name.encode()).mtime == 0
        assert "_FillValue" not in file["a2"].attrs
    assert 160_000 < path.stat().st_size < 160_000 + 40_000


def test_the_name_exists_only_when_the_file_is_finished(tmp_path):
    with Sample().writer(tmp_path / "m.h5") as writer:
        pass
    assert left_in(tmp_path) == []
    with pytest.raises(ValueError, match="the file is closed"):
        writer.write("status", 0, np.zeros(1, "i1"))
    with pytest.raises(RuntimeError, match="0 of 9 values of omega4_max were written"):
        writer.finish({})
    sample = Sample()
    with sample.writer(tmp_path / "m.h5") as writer:
        sample.fill(writer)
        assert left_in(tmp_path) == ["m.h5.part"]
        with pytest.raises(
            InputError, match=r"there is no such file; m\.h5\.part is of a run that has not finished"
        ):
            open_map(tmp_path / "m.h5")
        writer.finish({})
        assert left_in(tmp_path) == ["m.h5"]


@pytest.mark.parametrize("moment", ["before", "between"])
def test_a_failed_run_leaves_nothing(tmp_path, moment):
    def fail():
        assert left_in(tmp_path) == ["m.h5.part"]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Sample().save(tmp_path / "m.h5", **{moment: fail})
    with pytest.raises(TypeError, match="attribute 'run_time'"):
        Sample().save(tmp_path / "m.h5", last=None)
    assert left_in(tmp_path) == []


def test_an_existing_file_is_kept_unless_overwritten_for_whom_has_it_open_even_then(tmp_path):
    path = Sample().save(tmp_path / "m.h5")
    before = digest(path)
    with pytest.raises(InputError) as caught:
        Sample(seed=1).writer(path)
    assert str(caught.value) == f"to: {path}: the file exists; choose another name, or write overwrite=True"
    assert digest(path) == before
    assert left_in(tmp_path) == ["m.h5"]
    old, new = Sample(), Sample(seed=1)
    with open_map(path) as reader:
        new.save(path, overwrite=True)
        xr.testing.assert_identical(reader, old.expected())
    with open_map(path) as reader:
        xr.testing.assert_identical(reader, new.expected())
    assert left_in(tmp_path) == ["m.h5"]


def without_exclusive_renaming(patch):
    patch.setattr(partial_file, "exclusive_rename", lambda: raising(errno.EINVAL))


def without_links(patch):
    without_exclusive_renaming(patch)
    patch.setattr(os, "link", raising(errno.EPERM))


#: Systems by what they lack to give a file its name.
LACKS = {"nothing": lambda patch: None, "renaming": without_exclusive_renaming, "links": without_links}
every_lack = pytest.mark.parametrize("lack", LACKS.values(), ids=LACKS)


@every_lack
def test_a_file_that_appears_during_the_run_is_kept_and_so_is_the_result(tmp_path, monkeypatch, lack):
    lack(monkeypatch)
    path = tmp_path / "m.h5"
    sample = Sample()
    with pytest.raises(InputError) as caught:
        sample.save(path, between=lambda: path.write_text("mine"))
    assert str(caught.value) == (
        f"to: {path}: cannot give the complete file its name (File exists); make way for it and run the same "
        f"again, or rename {path}.part"
    )
    assert path.read_text() == "mine"
    path.with_name("m.h5.part").rename(tmp_path / "kept.h5")
    with open_map(tmp_path / "kept.h5") as opened:
        xr.testing.assert_identical(opened, sample.expected())


@pytest.mark.parametrize("overwrite", [False, True])
@every_lack
def test_a_file_can_be_read_from_its_first_moment_on(tmp_path, monkeypatch, overwrite, lack):
    lack(monkeypatch)
    path = tmp_path / "m.h5"
    read = []

    def reading(give_name):
        def give_name_and_read(source, to):
            give_name(source, to)
            if to == path:
                with open_map(path) as opened:
                    read.append(opened.title)

        return give_name_and_read

    exclusive = reading(partial_file.exclusive_rename())
    monkeypatch.setattr(partial_file, "exclusive_rename", lambda: exclusive)
    for name in ("replace", "link", "rename"):
        monkeypatch.setattr(os, name, reading(getattr(os, name)))
    Sample().save(path, overwrite=overwrite)
    assert read == ["übung"]


def test_a_link_is_followed(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "link.h5").symlink_to(tmp_path / "there" / "m.h5")
    Sample().save(tmp_path / "link.h5")
    assert left_in(tmp_path / "there") == ["m.h5"]
    assert (tmp_path / "link.h5").is_symlink()


BLOCKS = {
    "other type": ("omega4_max", 0, np.zeros(2, "f4"), TypeError, "block is float32, the variable float64"),
    "other byte order": ("omega4_max", 0, np.zeros(2, ">f8"), TypeError, "block is >f8"),
    "strided": ("omega4_max", 0, np.zeros(4)[::2], ValueError, "block is not C-contiguous"),
    "other rows": ("B_x", 0, np.zeros((2, 2, 4)), ValueError, r"shape \(2, 2, 4\) does not hold rows of"),
    "scalar": ("omega4_max", 0, np.float64(1.0)[()], ValueError, "does not hold rows of"),
    "too many dimensions": ("omega4_max", 0, np.zeros((1, 1, 1, 1)), ValueError, "does not hold rows of"),
    "before the first": ("omega4_max", -1, np.zeros(2), ValueError, "designs -1 to 1 of 9"),
    "beyond the last": ("omega4_max", 8, np.zeros(2), ValueError, "designs 8 to 10 of 9"),
}


@pytest.mark.parametrize(("name", "start", "block", "error", "message"), BLOCKS.values(), ids=BLOCKS)
def test_a_block_that_does_not_fit_is_refused(tmp_path, name, start, block, error, message):
    with Sample().writer(tmp_path / "m.h5") as writer, pytest.raises(error, match=f"^{name}: .*{message}"):
        writer.write(name, start, np.asarray(block) if np.ndim(block) == 0 else block)


def test_a_variable_along_an_unknown_dimension_is_refused(tmp_path):
    sample = Sample()
    sample.variables.append(Variable("x", ("extremum",), (2,), np.dtype("f8"), {}))
    with pytest.raises(ValueError, match="x: 2 along 'extremum', its coordinate None"):
        sample.writer(tmp_path / "m.h5")
    assert left_in(tmp_path) == []


def test_leaving_waits_for_writes_under_way(tmp_path, monkeypatch):
    sample = Sample()
    writing, go = threading.Event(), threading.Event()
    pwrite, closed = os.pwrite, []

    def slow(fd, data, at):
        writing.set()
        assert go.wait(30)
        closed.append(writer._fd == fd and os.fstat(fd).st_nlink)
        return pwrite(fd, data, at)

    with ThreadPoolExecutor(1) as pool:
        with sample.writer(tmp_path / "m.h5") as writer:
            monkeypatch.setattr(os, "pwrite", slow)
            future = pool.submit(writer.write, "status", 0, sample.arrays["status"])
            assert writing.wait(30)
            threading.Timer(0.1, go.set).start()
        future.result()
    assert closed == [1]
    assert left_in(tmp_path) == []


def test_files_that_cannot_be_opened(tmp_path):
    def message(path):
        with pytest.raises(InputError) as caught:
            open_map(path)
        return str(caught.value)

    path = tmp_path / "m.h5"
    assert message(str(path)) == f"{path}: there is no such file; give the path of a written map"
    assert message(tmp_path) == f"{tmp_path}: is a folder; give the path of a map that a sweep has written"
    path.write_text("text")
    assert message(path).startswith(f"{path}: cannot be read as HDF5 (")
    assert message(path).endswith("); give a map that a sweep has written")
    assert "\n" not in message(path)
    whole = Sample().save(tmp_path / "whole.h5").read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    assert message(path).startswith(f"{path}: cannot be read as HDF5 (")
    xr.Dataset({"x": 1.0}).to_netcdf(tmp_path / "other.nc", engine="h5netcdf")
    assert message(tmp_path / "other.nc") == (
        f"{tmp_path / 'other.nc'}: is not a finished map (it has no attribute 'fastlink_map'); "
        "other files open with xarray.open_dataset"
    )
    with h5py.File(tmp_path / "whole.h5", "r+") as file:
        file.attrs["fastlink_map"] = 2
    assert message(tmp_path / "whole.h5") == (
        f"{tmp_path / 'whole.h5'}: has format 2, this version reads up to 1; update fastlink"
    )


def test_files_that_are_none_are_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.h5")
    Sample().save(tmp_path / "m.h5")
    for path, remedy in (
        (tmp_path / "pipe.h5", "a map that a sweep has written"),
        (f"{tmp_path}/m.h5/", "m.h5'"),
        ("/dev/null", "a map that a sweep has written"),
        ("x" * 300 + ".h5", "maps.h5"),
    ):
        with pytest.raises(InputError, match=re.escape(remedy)):
            open_map(path)


def test_options_of_xarray_are_passed_on_or_refused(tmp_path):
    path = Sample().save(tmp_path / "m.h5")
    with open_map(path) as whole:
        name = next(iter(whole.data_vars))
    with open_map(path, drop_variables=[name], cache=False) as opened:
        assert name not in opened
    with refused("cach", "'cache'"):
        open_map(path, cach=False)
    with refused("engine", "known"):
        open_map(path, engine="netcdf4")
    for options in ({"drop_variables": 3}, {"backend_kwargs": 3}):
        with refused(next(iter(options)), "xarray"):
            open_map(path, **options)


def test_chunks_need_dask(tmp_path, monkeypatch):
    path = Sample().save(tmp_path / "m.h5")
    monkeypatch.setattr("fastlink.errors.find_spec", lambda name: None)
    with refused("chunks", "install dask"):
        open_map(path, chunks="auto")


# == The place of a map file: other processes, systems that lack something, full disks, bad places ===========


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


LACKING = {
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
@pytest.mark.parametrize("lack", LACKING.values(), ids=LACKING)
def test_the_same_file_comes_out_where_the_system_lacks(tmp_path, monkeypatch, lack):
    expected = digest(Sample().save(tmp_path / "usual.h5"))
    lack(monkeypatch)
    assert digest(Sample().save(tmp_path / "m.h5")) == expected
    Sample().save(tmp_path / "m.h5", overwrite=True)
    with Sample().writer(tmp_path / "failed.h5"):
        pass
    assert left_in(tmp_path) == ["m.h5", "usual.h5"]


def test_free_room_counts_what_a_killed_run_left_and_a_folder_must_be_writable(tmp_path, monkeypatch):
    (tmp_path / "m.h5.part").write_bytes(b"x" * 4_000_000)
    monkeypatch.setattr(partial_file, "free_bytes", lambda path: output_path.SLACK)
    monkeypatch.setattr(output_path, "free_bytes", lambda path: output_path.SLACK)
    assert check_target(tmp_path / "m.h5", 3_900_000, False) == tmp_path / "m.h5"
    with pytest.raises(InputError, match=r"needs 5\.25 MB but 1\.05 MB are free"):
        check_target(tmp_path / "m.h5", 4_200_000, False)
    # /proc refuses files to everyone, a folder of mode 0o500 to all but the superuser
    folder = "/proc" if os.geteuid() == 0 else str(tmp_path)
    tmp_path.chmod(0o500)
    with pytest.raises(InputError, match=r"^.*m\.h5 cannot be written \(.*\); choose another place$"):
        check_target(f"{folder}/m.h5", 0, False)
    tmp_path.chmod(0o700)


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

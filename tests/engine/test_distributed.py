"""Sweeps on a real cluster of dask.distributed, two processes: the bits of one thread, whatever is lost on the way."""

import functools
import heapq
import os
import queue
import signal
import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from distributed import Client, LocalCluster
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.engine import cluster
from fastlink.engine.cluster import Report
from fastlink.engine.run import Job
from fastlink.io.writer import Writer

SPACE = {"a1": 0.4, "a2": np.linspace(1.0, 1.2, 30), "a3": np.linspace(0.7, 0.9, 20), "a4": 1.0}
NAMES = ["transmission_angle", "transmission_angle_max"]
OPTIONS = {"theta1": 12, "verify": 0, "progress": False}
SPACES = {
    "grid": fl.grid(**SPACE),
    "scaling axis": fl.grid(**SPACE, omega1=[1.0, 2.0, 5.0, 25.0]),
    "sample": fl.sobol(500, seed=3, a1=(0.3, 0.5), a2=(1.0, 1.3), a3=0.8, a4=1.0),
    "lengths in micrometres": fl.table(
        {"a1": [4e-7, 0.4], "a2": [1e-6, 1.0], "a3": [9e-7, 0.9], "a4": [1e-6, 1.0]}
    ),
}


@pytest.fixture(scope="module")
def client():
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with LocalCluster(processes=True, **options) as cluster, Client(cluster) as client:
        yield client


@pytest.fixture
def workers(client):
    """Wait for both workers, and forget what a test has changed in them."""
    client.wait_for_workers(2, timeout=120)
    yield client
    client.run(_restore, on_error="ignore")


def _change(module, name, value):
    """Change a name of a module in this process, until `_restore`."""
    import builtins
    import importlib

    changed = builtins.__dict__.setdefault("_changed_by_tests", [])
    found = importlib.import_module(module)
    changed.append((found, name, getattr(found, name)))
    setattr(found, name, value)


def _restore():
    import builtins

    for found, name, value in reversed(builtins.__dict__.pop("_changed_by_tests", [])):
        setattr(found, name, value)


def swept(space="grid", names=NAMES, **options):
    return sweep_4r(SPACES[space], names, **OPTIONS | options)


def assert_same(found, expected):
    """Assert that two maps have the same bits and counts, and that the file of the first is whole."""
    assert list(found.variables) == list(expected.variables)
    for name, variable in expected.variables.items():
        assert found[name].dims == variable.dims
        assert found[name].values.tobytes() == variable.values.tobytes(), name
    counts = [
        name for name in expected.attrs if name.startswith(("designs_", "verified")) and "per" not in name
    ]
    assert {name: found.attrs[name] for name in counts} == {name: expected.attrs[name] for name in counts}


@pytest.fixture
def small_tasks(monkeypatch):
    """Make a task of few designs, so that there are many."""
    monkeypatch.setattr(cluster, "FIRST_DESIGNS", 32)
    monkeypatch.setattr(cluster, "GROWTH", 1)


@pytest.fixture
def written(monkeypatch):
    """Note who writes values: this process, or a worker; never the thread that an interrupt comes to."""
    writers, threads = [], set()
    for name in ("write", "merge"):
        method = getattr(Writer, name)

        @functools.wraps(method)  # it travels by its name
        def noted(self, *args, method=method, name=name):
            writers.append(name)
            threads.add(threading.current_thread())
            return method(self, *args)

        monkeypatch.setattr(Writer, name, noted)
    yield writers
    assert threading.main_thread() not in threads


@pytest.mark.sample(2)
@pytest.mark.parametrize("space", SPACES)
def test_results_in_memory_have_the_bits_of_one_thread(workers, small_tasks, space):
    names = [*NAMES, "omega4_max"] if space == "scaling axis" else NAMES
    assert_same(swept(space, names, client=workers), swept(space, names, threads=1))


@pytest.mark.sample(3)
@pytest.mark.parametrize("options", [{}, {"layout": "maps"}, {"part": (2, 3)}], ids=str)
@pytest.mark.parametrize("space", ["grid", "scaling axis", "sample"])
def test_workers_write_into_the_file_that_they_see(workers, small_tasks, written, tmp_path, space, options):
    names = [*NAMES, "omega4_max"] if space == "scaling axis" else NAMES
    with swept(space, names, client=workers, to=tmp_path / "maps.h5", **options) as maps:
        assert set(written) == {"merge"}
        with swept(space, names, threads=1, to=tmp_path / "one.h5", **options) as expected:
            assert_same(maps, expected)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["maps.h5", "one.h5"]
    fl.check(tmp_path / "maps.h5")


def test_results_come_back_from_workers_that_do_not_see_the_file(workers, small_tasks, written, tmp_path):
    options = {"layout": "maps", "verify": 4}

    def no_such_file(path, flags=0):
        raise FileNotFoundError(path)

    first, _ = workers.nthreads()
    workers.run(_change, "fastlink.io.partial_file", "opened", no_such_file, workers=[first])
    with swept(client=workers, to=tmp_path / "maps.h5", **options) as maps:
        assert set(written) == {"write", "merge"}  # one sees it, and one does not
        with swept(threads=1, to=tmp_path / "one.h5", **options) as expected:
            assert_same(maps, expected)
            for name in NAMES:
                assert maps[name].attrs == expected[name].attrs  # the measured errors
    fl.check(tmp_path / "maps.h5")


def test_another_file_of_the_same_name_is_not_written(workers, small_tasks, written, tmp_path):
    def opened_another(path, flags=0):
        import os

        other = path.with_name("other.h5")
        other.write_bytes(path.read_bytes()[:4096].ljust(1 << 20, b"\0"))
        return os.open(other, os.O_RDWR)

    workers.run(_change, "fastlink.io.partial_file", "opened", opened_another)
    with swept(client=workers, to=tmp_path / "maps.h5") as maps:
        assert_same(maps, swept(threads=1))
    assert set(written) == {"write"}


def test_an_interrupt_keeps_what_is_recorded(workers, small_tasks, monkeypatch, tmp_path):
    reports, learn, target = [], cluster._Length.learn, tmp_path / "maps.h5"

    def interrupt(self, designs, seconds):
        learn(self, designs, seconds)
        reports.append(designs)
        if len(reports) % 10 == 9:
            raise KeyboardInterrupt

    monkeypatch.setattr(cluster._Length, "learn", interrupt)
    for _ in range(2):  # the second goes on with the first
        with pytest.raises(KeyboardInterrupt) as caught:
            swept(client=workers, to=target)
        (note,) = caught.value.__notes__
        assert "maps.h5.part" in note
    deadline = time.monotonic() + 10  # what was under way is given up
    while workers.processing() and any(workers.processing().values()):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    with swept(threads=1, to=target) as maps:  # and who has no cluster goes on with both
        assert maps.attrs["designs_of_earlier_runs"] >= 8 * 32
        expected = swept(threads=1)
        assert all(maps[name].values.tobytes() == expected[name].values.tobytes() for name in NAMES)
    fl.check(target)


def test_what_a_worker_cannot_bring_to_the_disk_is_not_recorded(workers, small_tasks, tmp_path):
    def failing(fd):
        raise OSError(5, "Input/output error")

    workers.run(_change, "fastlink.io.writer", "synchronise", failing)
    with refused("worker", "choose another place"):
        swept(client=workers, to=tmp_path / "maps.h5")
    assert list(tmp_path.iterdir()) == []


class Simulated:
    """A client of as many workers of one thread each, in a time of its own: 2 ms for a task, and 3 us for a design."""

    def __init__(self, threads):
        self.now, self.busy, self.seconds = 0.0, 0.0, []
        self.free, self.ends = [(0.0, k) for k in range(threads)], []
        self.tasks = dict.fromkeys(range(threads), 0)

    def nthreads(self):
        return dict.fromkeys(self.tasks, 1)

    def wait_for_workers(self, count):
        pass

    def cancel(self, futures, force):
        assert not futures

    def scatter(self, data, **options):
        return [None]

    def submit(self, function, data, name, start, stop, **options):
        self.now, self.busy = self.now + 2e-3, self.busy + 2e-3
        seconds = (stop - start) * 3e-6
        free, worker = heapq.heappop(self.free)
        end = max(free, self.now) + seconds
        heapq.heappush(self.free, (end, worker))
        self.tasks[worker] += 1
        self.seconds.append(seconds)
        note = functools.partial(heapq.heappush, self.ends)
        future = type("Future", (), {"status": "finished", "result": lambda self: Report(seconds)})()
        future.add_done_callback = lambda put: note((end, id(future), future))
        return future

    def empty(self):
        return not (self.ends and self.ends[0][0] <= self.now)

    def get(self, timeout):
        end, _, future = heapq.heappop(self.ends)
        self.now = max(self.now, end)
        return future

    put = None


@pytest.mark.parametrize(
    ("threads", "work", "used", "longest"), [(1000, 10.0, 0.85, 4.1), (16, 10.0, 0.98, 1.05)]
)
def test_the_client_keeps_up_with_any_number_of_threads(monkeypatch, threads, work, used, longest):
    client = Simulated(threads)
    monkeypatch.setattr(cluster, "queue", SimpleNamespace(SimpleQueue=lambda: client, Empty=queue.Empty))
    job = Job((), [((28,), "float64")], int(threads * work / 3e-6))
    cluster.Cluster(client).run(job, print)
    assert sum(client.seconds) == pytest.approx(threads * work)
    assert sum(client.seconds) / threads / client.now >= used
    assert client.busy / client.now < 0.8
    assert max(client.seconds) < longest  # which is lost with a worker
    assert min(client.tasks.values()) >= 3


def test_what_is_no_client_is_refused_and_threads_are_those_of_the_workers(workers):
    with Client(workers.scheduler.address) as closed:
        pass
    with refused("client", "make it anew"):
        swept(client=closed)
    for wrong in (1, "tcp://127.0.0.1:8786", Client):
        with refused("client", "distributed.Client"):
            swept(client=wrong)
    with refused("threads", "leave it out"):
        swept(client=workers, threads=2)
    assert swept(client=workers).attrs["threads"] == 2


def test_a_worker_with_another_version_is_refused_beforehand(workers, tmp_path):
    first, _ = workers.nthreads()
    workers.run(_change, "fastlink.engine.cluster", "environment", lambda: b"other", workers=[first])
    with refused(f"{first}", "install the version"):
        swept(client=workers, to=tmp_path / "maps.h5")
    assert list(tmp_path.iterdir()) == []


def test_a_study_runs_on_a_cluster(workers, tmp_path):
    from typer.testing import CliRunner

    from fastlink.app.cli import app

    study, target = tmp_path / "study.toml", tmp_path / "maps.h5"
    study.write_text(
        'mechanism = "planar_4r"\nquantities = ["transmission_angle_max"]\n[design]\na1 = 0.4\n'
        "a2 = {linspace = [1.0, 1.2, 30]}\na3 = 0.8\na4 = 1.0\n"
    )
    command = ["run", str(study), "--to", str(target), "--quiet", "--verify", "0", "--dask"]
    assert CliRunner().invoke(app, [*command, workers.scheduler.address]).exit_code == 0
    with xr.open_dataset(target, engine="h5netcdf") as maps:
        assert maps.attrs["threads"] == 2
    refusal = CliRunner().invoke(app, [*command, "tcp://127.0.0.1:9"])
    assert refusal.exit_code == 2
    assert "--dask: no scheduler answers" in refusal.output


@pytest.mark.parametrize(
    ("to_file", "count"),
    [
        pytest.param(True, 1, id="file"),
        pytest.param(False, 1, id="memory", marks=pytest.mark.stress),
        # with both, all that was handed out is lost; the cluster takes seconds to start two processes
        pytest.param(True, 2, id="both", marks=pytest.mark.stress),
    ],
)
def test_the_designs_of_a_lost_worker_are_done_again(
    workers, small_tasks, monkeypatch, tmp_path, to_file, count
):
    pids, reports = workers.run(os.getpid), []
    learn = cluster._Length.learn

    def kill_then_learn(self, designs, seconds):
        reports.append(designs)
        if len(reports) == 3:
            for pid in list(pids.values())[:count]:
                os.kill(pid, signal.SIGKILL)
        learn(self, designs, seconds)

    def slowly(*args, **options):
        import time

        from fastlink.engine.run import run

        time.sleep(0.02)
        run(*args, **options)

    workers.run(_change, "fastlink.engine.cluster", "run", slowly)
    monkeypatch.setattr(cluster._Length, "learn", kill_then_learn)
    maps = swept(client=workers, to=tmp_path / "maps.h5" if to_file else None)
    with maps:
        assert_same(maps, swept(threads=1))
    assert len(set(pids.values()) - set(workers.run(os.getpid).values())) == count
    if to_file:
        fl.check(tmp_path / "maps.h5")

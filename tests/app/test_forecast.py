"""The memory, file and time that `fastlink explain` says beforehand."""

import os
import re
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from tests.support.four_bar import sweep_4r
from tests.support.refusals import refused
from tests.support.study_files import GOOD, written
from typer.testing import CliRunner

import fastlink as fl
from fastlink import machine
from fastlink.app import explain
from fastlink.app.cli import app
from fastlink.app.explain import timing_of
from fastlink.codegen.kernel import Kernel, kernel_of
from fastlink.engine.resolve import resolve
from fastlink.engine.sinks import needs_of

LENGTHS = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0}


@pytest.fixture
def empty_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("FASTLINK_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr("fastlink.codegen.kernel._loaded", {})
    kernel_of.cache_clear()  # each keeps what it has compiled


def test_a_kernel_that_a_sweep_has_compiled_counts_as_compiled(empty_cache):
    request = ("planar_4r", fl.grid(**LENGTHS), ["swing"])
    assert fl.explain(*request).forecast.compiled == 0
    fl.sweep(*request, branch=(1, 2))
    shutil.rmtree(os.environ["FASTLINK_CACHE_DIR"])
    assert fl.explain(*request).forecast.compiled == 1


def test_nothing_is_compiled_unless_it_is_to_be_measured(folder, empty_cache, monkeypatch):
    path = written(GOOD)
    with monkeypatch.context() as patch:
        patch.setattr(Kernel, "compiled", lambda *_: pytest.fail("compiled"))
        needs = fl.explain(path).forecast
    assert (needs.compiled, needs.timing) == (0, None)
    assert needs.kernels > 0
    assert needs.compile_time > 0.0
    assert "--measure" in str(needs)
    monkeypatch.setattr(sys.modules["fastlink.app.explain"], "PATIENCE", 60.0)  # however busy the machine is
    measured = fl.explain(path, measure=True).forecast
    assert (measured.compiled, measured.timing.designs) == (0, 6)
    # compiled now, so that it is measured by default
    after = CliRunner().invoke(app, ["explain", str(path)]).output
    assert "compiled already" in after, after
    assert "estimated from 6 of 6 designs at 8 positions" in after
    # what a map calls its run time, and verification apart in both
    assert re.search(
        r"run time:  about [.\d]+ s by \d+ threads?, then [.\d]+ s of verification, estimated", after
    )
    assert measured.timing.total == measured.timing.evaluation + measured.timing.file
    assert not Path("study.h5").exists()
    with fl.run(path) as maps:
        (line,) = [line for line in maps.fastlink.summary().splitlines() if line.startswith("run time")]
        assert re.search(r"\d threads?; then [.\d]+ s of verification", line)
    assert fl.explain(path, measure=False).forecast.timing is None


@pytest.mark.parametrize(
    ("names", "space", "options"),
    [
        (["theta4", "swing"], fl.grid(**{**LENGTHS, "a2": np.linspace(1.0, 1.4, 90)}), {"theta1": 90}),
        (["swing"], fl.sobol(4096, a1=(0.2, 0.4), a2=(1.0, 1.4), a3=0.8, a4=1.0), {}),
        (["omega4_max"], fl.grid(**LENGTHS, omega1=np.linspace(1.0, 2.0, 20_000)), {}),
        (["grashof_class"], fl.grid(**LENGTHS), {}),
    ],
)
def test_the_file_is_as_large_as_was_said(names, space, options, tmp_path):
    said = fl.explain(
        "planar_4r", space, names, to=tmp_path / "maps.h5", measure=False, **{"branch": (1, 2)} | options
    ).forecast
    sweep_4r(space, names, to=tmp_path / "maps.h5", verify=1, **options).close()
    # values and coordinates are counted; the labels, of which there are 10 to 50 kB, are estimated
    assert abs(os.path.getsize(tmp_path / "maps.h5") - said.file) < 50_000
    assert said.folder == tmp_path


def test_the_memory_is_that_which_a_sweep_is_refused_by(monkeypatch):
    space, angles = fl.grid(**{**LENGTHS, "a2": np.linspace(1.0, 1.4, 20_000)}), {"theta1": 200}
    said = fl.explain(
        "planar_4r", space, ["theta4"], threads=2, measure=False, **{"branch": (1, 2)} | angles
    ).forecast
    assert (
        said.memory
        == needs_of(resolve("planar_4r", space, ["theta4"], angles=200, branch=(1, 2)), 2).in_memory
    )
    monkeypatch.setattr(machine, "available_memory", lambda: said.memory - 1)
    with refused("the result", "to='maps.h5'"):
        sweep_4r(space, ["theta4"], threads=2, **angles)
    monkeypatch.setattr("fastlink.app.explain.available_memory", lambda: said.memory - 1)
    assert "which is refused" in str(
        fl.explain("planar_4r", space, ["theta4"], threads=2, **{"branch": (1, 2)} | angles, measure=False)
    )


@pytest.mark.parametrize("size", [1, 2, 17, 1000, 10**9])
@pytest.mark.parametrize("count", [1, 5, 16, 100, 999])
def test_samples_are_spread_over_all_designs(size, count):
    ranges = explain._spread(size, min(count, size))
    assert ranges[0][0] == 0
    assert ranges[-1][1] == size or count == 1
    flat = [edge for pair in ranges for edge in pair]
    assert flat == sorted(flat)
    assert min(count, size) <= sum(stop - start for start, stop in ranges) + len(ranges) - 1


def test_the_time_of_a_sample_is_that_of_all_designs():
    """In proportion: a sample's time per design times their number, whatever a clock says."""
    space = fl.grid(**{**LENGTHS, "a2": np.linspace(1.0, 1.4, 300), "a3": np.linspace(0.6, 1.0, 300)})
    request = resolve("planar_4r", space, ["theta4"], angles=5000, branch=(1, 2))
    clock = iter(np.arange(0.0, 1000.0, 0.5))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(explain.time, "perf_counter", lambda: next(clock))
        found = timing_of(request, threads=1)
    # each look at the clock is half a second after the last: for the tables, and for the sample
    assert found.positions == 4096
    assert found.evaluation == pytest.approx(
        5000 / 4096 * (0.5 + 0.5 * space.size / found.designs), rel=1e-12
    )


def test_a_sweep_is_explained_with_the_arguments_of_a_sweep(tmp_path):
    space = fl.grid(**LENGTHS, omega1=2.0)
    steel = fl.round_bar(density=7750.0, radius=0.01)
    options = {
        "links": steel,
        "branch": 1,
        "theta1": 7,
        "threads": 1,
        "verify": 3,
        "overwrite": True,
        "progress": False,
    }
    options |= {"to": tmp_path / "m.h5", "attrs": {"a": 1}, "block": 8}
    found = fl.explain("planar_4r", space, ["T41"], **{"branch": (1, 2)} | options)
    assert "7 values of theta1" in found.title
    assert found.forecast.threads == 1
    with refused("theta_1", "did you mean 'theta1'?"):
        fl.explain("planar_4r", space, ["T41"], theta_1=7, links=steel, branch=(1, 2))
    with refused("quantities is missing", "explain(mechanism, space, quantities)"):
        fl.explain("planar_4r", space)
    with refused("threads is an option of a sweep", "write it in the study"):
        fl.explain("study.toml", threads=1)


def test_all_problems_of_an_explained_sweep_are_told_together():
    with pytest.raises(fl.InputError) as caught:
        fl.explain(
            "planar_4r", fl.grid(**LENGTHS), ["thta4"], threads=0, overwrite="no", theta_1=3, branch=(1, 2)
        )
    assert {one.where[0] for one in caught.value.problems} == {
        "quantities",
        "threads",
        "overwrite",
        "theta_1",
    }
    with refused("measure is 'yes'", "True or False"):
        fl.explain("planar_4r", fl.grid(**LENGTHS), ["theta4"], measure="yes", branch=(1, 2))

"""What a study computes and leaves out, as `fastlink explain` tells it."""

import os
import re
import shutil
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
from tests.support.refusals import refused
from tests.support.study_files import GOOD, written
from tests.support.sweeps import BARS, sweep_4r
from typer.testing import CliRunner

import fastlink as fl
from fastlink import machine
from fastlink.app import explain
from fastlink.app.cli import app
from fastlink.app.explain import explain_request, timing_of
from fastlink.app.report import contents
from fastlink.codegen.kernel import Kernel, kernel_of
from fastlink.codegen.translate import Refused
from fastlink.engine.resolve import resolve
from fastlink.engine.sinks import needs_of
from fastlink.facts.evaluate import evaluate_step, steps_of
from fastlink.facts.formula import Formula
from fastlink.mechanisms import catalogue

explain_module = sys.modules["fastlink.app.explain"]
LENGTHS = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0}


def explained(names, space, mechanism="planar_4r", **options):
    return explain_request(resolve(mechanism, space, names, branch=(1, 2), **options))


def asked(names, **inputs):
    return explained(names, fl.grid(**LENGTHS, **inputs), angles=36, extrema="sampled")


class Tally(float):
    """A number that counts what is done with it."""

    done: ClassVar[Counter[str]] = Counter()

    def __hash__(self):
        return super().__hash__()


def _counted(kind, name):
    def operation(self, *others):
        Tally.done[kind] += 1
        return Tally(getattr(float, name)(self, *others))

    return operation


for _kind, _names in {
    "+ -": ("add", "radd", "sub", "rsub", "neg", "abs"),
    "*": ("mul", "rmul"),
    "/": ("truediv", "rtruediv"),
}.items():
    for _name in _names:
        setattr(Tally, f"__{_name}__", _counted(_kind, f"__{_name}__"))


@pytest.mark.parametrize("name", ["time_ratio", "swing", "least_transmission_angle", "status"])
def test_operations_of_a_design_are_those_that_its_facts_do(name, monkeypatch):
    def counting(name):
        def function(*args):
            Tally.done[name] += 1
            return Tally(getattr(np, {"atan2": "arctan2"}.get(name, name))(*map(float, args)))

        return function

    planar = catalogue("planar_4r")
    for fact in planar.facts.values():
        names = {one: counting(one) for one in ("sqrt", "atan2")}
        counted = Formula(
            fact.name, fact.formula.parameters, fact.formula.lines, {**fact.formula.names, **names}
        )
        monkeypatch.setitem(planar.facts, fact.name, replace(fact, formula=counted))
    Tally.done.clear()
    known = {key: Tally(value) for key, value in LENGTHS.items()}
    for step in steps_of(planar, [name, "status"], known):
        evaluate_step(step, known)
    (loop,) = asked([name]).kernels[0].loops
    assert loop.per == "design"
    Tally.done["atan2, log, cos"] = Tally.done["atan2"]
    for kind in ("+ -", "*", "/", "sqrt", "atan2, log, cos"):
        assert loop.work[kind] == Tally.done[kind], kind


def test_a_map_of_designs_touches_no_angle_and_refined_extremes_tell_samples_and_places():
    found = asked(["grashof_class", "swing"])
    assert found.tables == ()
    assert [loop.per for kernel in found.kernels for loop in kernel.loops] == ["design"]
    assert {"omega4", "shaking_force", "theta4"} < set(found.left_out)
    assert not {"grashof_class", "swing", "status"} & set(found.left_out)
    found = explained(["omega4_max"], fl.grid(**LENGTHS, omega1=9.0))
    pers = [loop.per for kernel in found.kernels for loop in kernel.loops]
    assert {"design", "design and sample", "place", "extreme"} <= set(pers)
    space = fl.grid(a=1.0, b=1.1, g=0.9, h=0.8)
    found = explained(["psi"], space, "minkowski_4r", angles=np.linspace(-1.0, 1.0, 600))
    assert "for piece in" in found.kernels[-1].source.text
    assert [loop.per for loop in found.kernels[-1].loops] == ["design", "design and theta"]


def test_loads_and_stores_are_counted_and_a_larger_request_never_does_less():
    found = asked(["A_x", "A_y"])
    loops = {loop.per: loop.work for kernel in found.kernels for loop in kernel.loops}
    # A = a1 (cos, sin): two tables and one length read, two results for each of two modes written
    assert loops["design and theta1"]["*"] == 2
    assert loops["design and theta1"]["stores"] == 4
    small, large = asked(["omega4_max"], omega1=9.0), asked(["omega4_max", "alpha4_max"], omega1=9.0)
    (first,), (second,) = ([loop for loop in e.kernels[0].loops if "and" in loop.per] for e in (small, large))
    assert all(second.work[kind] >= first.work[kind] for kind in first.work)
    assert second.work["*"] > first.work["*"]
    assert set(small.kernels[0].facts) < set(large.kernels[0].facts)
    found = asked(["omega4_max"], omega1=[1.0, 2.0, 3.0])
    assert found.scaling_axis == "omega1 (3 values)"
    assert "omega1 (3 values): only scales" in str(found)


def test_a_search_is_told_by_what_is_searched():
    """Steps and extremes of each quantity, samples of all, with what is told by both sides of the range."""
    names = ["omega4_max", "T41_extrema"]
    space = fl.grid(**LENGTHS, omega1=9.0, gravity_y=-9.81)  # gravity makes the sides unlike
    found = explained(names, space, links=BARS)
    loops = {(loop.per, loop.times): loop.work for kernel in found.kernels for loop in kernel.loops}
    for quantity in ("omega4", "T41"):
        step = loops["place", f"each step of the search of {quantity}"]
        # the derivative is stored; of the extreme, its value, its place and that of its mirror image, or 0
        assert step["stores"] == 1
        assert loops["extreme", f"once, of {quantity}"]["stores"] == 3
        assert step["*"] > 0
    often = {times for per, times in loops if per == "design and sample"}
    assert {"33 samples of the graded range", "65 samples of the graded range, on 2 sides"} <= often
    # What has loops of its own is named, not counted.
    assert "gather" in found.text(kernels=True).partition("not counted")[2]
    assert "not counted" not in asked(["omega4_max"], omega1=9.0).text(kernels=True)
    assert "kernel 1" not in str(found)  # the answer alone
    text = explained(names, fl.grid(**LENGTHS, omega1=9.0, T_load=1.0), links=BARS).text(kernels=True)
    assert "every extreme of T41; cells split at the zeros of omega4\n" in text


@pytest.fixture
def study(folder):
    design = "{a1 = 0.4, a2 = 1.1, a3 = 0.8, a4 = 1.0, omega1 = 2.0}"
    return written(f'mechanism = "planar_4r"\nquantities = ["omega4"]\ndesign = {design}')


def test_llvm_and_assembly_language_are_printed_where_wanted(study):
    """One kernel of the rates, and one of what each design has."""
    plain, ir, asm, both = (
        CliRunner().invoke(app, ["explain", str(study), *options]).output
        for options in (("--kernels",), ("--ir",), ("--asm",), ("--ir", "--asm"))
    )
    kernels = plain.count("\nkernel ")
    assert kernels > 0
    for text, is_ir, is_asm in ((plain, 0, 0), (ir, 1, 0), (asm, 0, 1), (both, 1, 1)):
        assert text.count("define void @kernel(ptr %table)") == is_ir * kernels
        assert text.count("\t.globl\tkernel") + text.count("\t.globl\t_kernel") == is_asm * kernels
        assert "def kernel(" not in text
    assert "fmul <" in ir


def test_a_kernel_that_numba_compiles_has_no_llvm_of_ours(study, monkeypatch):
    def refuse(source):
        raise Refused("kernel, line 3: x: no such expression here")

    monkeypatch.setattr(explain_module, "llvm_text", refuse)
    found = fl.explain(study).text(ir=True)
    assert "compiled by numba, for the translator refuses it: kernel, line 3" in found


def test_the_command_and_every_option_of_a_sweep_explain(study):
    brief = CliRunner().invoke(app, ["explain", str(study)])
    assert brief.exit_code == 0
    assert "asked for: omega4, status" in brief.output
    assert "def kernel(" not in brief.output
    long = CliRunner().invoke(app, ["explain", str(study), "--text"])
    assert "def kernel(" in long.output
    request = "planar_4r", fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0), ["theta4"]
    assert fl.explain(*request, part=(1, 2), measure=False).results == ("theta4", "status")
    with pytest.raises(fl.InputError, match="part is 1/3, but there are 2 designs"):
        fl.explain(*request, part=(1, 3), measure=False)


# == The memory, file and time that `fastlink explain` says beforehand =======================================


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
    without = fl.explain(path, measure=False).forecast
    assert without.timing is None
    assert "not measured; --measure" in str(without)  # whatever is compiled already


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
    request = "planar_4r", fl.grid(**LENGTHS | {"a2": np.linspace(1.0, 1.4, 20_000)}), ["theta4"]
    options = {"theta1": 200, "threads": 2, "branch": (1, 2)}
    memory = fl.explain(*request, measure=False, **options).forecast.memory
    assert memory == needs_of(resolve(*request, angles=200, branch=(1, 2)), 2).in_memory
    monkeypatch.setattr(machine, "available_memory", lambda: memory - 1)
    with refused("the result", "to='maps.h5'"):
        fl.sweep(*request, **options)
    monkeypatch.setattr("fastlink.app.explain.available_memory", lambda: memory - 1)
    assert "which is refused" in str(fl.explain(*request, measure=False, **options))


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
    options = {"links": BARS, "branch": 1, "theta1": 7, "threads": 1}
    options |= {"verify": 3, "overwrite": True, "progress": False}
    options |= {"to": tmp_path / "m.h5", "attrs": {"a": 1}, "block": 8}
    found = fl.explain("planar_4r", space, ["T41"], **options)
    assert "7 values of theta1" in found.title
    assert found.forecast.threads == 1
    with refused("theta_1", "did you mean 'theta1'?"):
        fl.explain("planar_4r", space, ["T41"], theta_1=7, links=BARS)
    with refused("quantities is missing", "explain(mechanism, space, quantities)"):
        fl.explain("planar_4r", space)
    with refused("threads is an option of a sweep", "write it in the study"):
        fl.explain("study.toml", threads=1)


def test_all_problems_of_an_explained_sweep_are_told_together():
    with pytest.raises(fl.InputError) as caught:
        fl.explain("planar_4r", fl.grid(**LENGTHS), ["thta4"], threads=0, overwrite="no", theta_1=3)
    keys = {one.where[0] for one in caught.value.problems}
    assert keys == {"quantities", "threads", "overwrite", "theta_1"}


# == Summaries of maps, of parts of maps, and of what users have made of them ================================


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("maps") / "maps.h5"
    space = fl.grid(a1=[0.4, 0.6, 3.0], a2=[1.1, 1.2], a3=0.8, a4=1.0, omega1=25.0)
    sweep_4r(space, ["omega4_max", "theta4"], theta1=4, to=path, verify=2).close()
    return path


@pytest.fixture(scope="module")
def maps(path):
    with fl.open(path) as opened:
        return opened.load()


def test_a_path_is_as_good_as_a_map_and_so_is_one_that_xarray_has_saved(path, maps, tmp_path):
    with fl.open(path) as opened:
        assert contents(path) == contents(opened)
    maps.isel(a1=[0, 1]).to_netcdf(tmp_path / "part.nc", engine="h5netcdf")
    assert "4 of the 6" in fl.open(tmp_path / "part.nc").fastlink.summary()
    with refused("fastlink_map", "keep_attrs"):
        maps.drop_attrs().fastlink.summary()


def test_a_part_of_a_map_counts_its_own_designs(maps):
    part = maps.isel(a1=[0, 2])
    lines = part.fastlink.summary().splitlines()
    assert lines[0].split(maxsplit=1)[1] == "4 of the 6 of the sweep"
    (full,) = [line.split()[0] for line in lines if "rotates fully" in line]
    assert int(full) == int((part.status == 0).sum())
    assert "rotates" not in maps.mean("a1").fastlink.summary()


HOSTILE = {
    "one design": lambda maps: maps.isel(a1=0, a2=0),
    "no design": lambda maps: maps.isel(a1=[]),
    "one mode": lambda maps: maps.isel(branch=0),
    "mean": lambda maps: maps.mean("a1", keep_attrs=True),
    "mean of all": lambda maps: maps.mean(keep_attrs=True),
    "without coordinates": lambda maps: maps.drop_vars(["a1", "branch", "theta1", "a3"]),
    "without status": lambda maps: maps.drop_vars("status"),
    "stacked": lambda maps: maps.stack(all=("a1", "a2")),
    "renamed": lambda maps: maps.rename(a1="crank", omega4_max="fast", status="state"),
    "named designs": lambda maps: maps.assign_coords(
        a1=["x", "y", "z"], maker="someone", when=np.datetime64("2020")
    ),
    "numbers in words": lambda maps: maps.assign_attrs(designs="many", run_time_s=None, threads=[1, 2]),
    "not a number": lambda maps: maps.assign_attrs(designs=np.nan, run_time_s=np.inf, threads=-1),
    "no attributes of variables": lambda maps: maps.assign(
        {name: array.drop_attrs() for name, array in maps.data_vars.items()}
    ),
    "damaged codes": lambda maps: maps.assign(status=maps.status.assign_attrs(flag_meanings=3)),
    "text": lambda maps: maps.assign(note=("a1", ["a", "b", "c"])),
    "arithmetic": lambda maps: (maps * 2).assign_attrs(maps.attrs),
}


@pytest.mark.parametrize("change", HOSTILE.values(), ids=HOSTILE)
def test_whatever_became_of_a_map_is_summarised(maps, change):
    assert change(maps).fastlink.summary()
    assert contents(change(maps)).startswith("title")

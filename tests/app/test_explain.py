"""What a study computes and leaves out, as `fastlink explain` tells it."""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.app.explain import explain_request
from fastlink.codegen.translate import Refused
from fastlink.engine.resolve import resolve
from fastlink.facts.evaluate import evaluate_step, steps_of
from fastlink.facts.formula import Formula
from fastlink.mechanisms import catalogue

explain_module = sys.modules["fastlink.app.explain"]
ROUND_BAR = fl.round_bar(density=7750.0, radius=0.01)
LENGTHS = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0}


def asked(names, mechanism="planar_4r", angles=36, **inputs):
    return explain_request(
        resolve(
            mechanism, fl.grid(**LENGTHS, **inputs), names, angles=angles, extrema="sampled", branch=(1, 2)
        )
    )


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


def test_a_map_of_designs_touches_no_angle():
    found = asked(["grashof_class", "swing"])
    assert found.tables == ()
    assert [loop.per for kernel in found.kernels for loop in kernel.loops] == ["design"]
    assert {"omega4", "shaking_force", "theta4"} < set(found.left_out)
    assert not {"grashof_class", "swing", "status"} & set(found.left_out)


def test_loads_and_stores_of_a_configuration():
    found = asked(["A_x", "A_y"])
    loops = {loop.per: loop.work for kernel in found.kernels for loop in kernel.loops}
    # A = a1 (cos, sin): two tables and one length read, two results for each of two modes written
    assert loops["design and theta1"]["*"] == 2
    assert loops["design and theta1"]["stores"] == 4


def test_a_larger_request_never_does_less():
    small, large = asked(["omega4_max"], omega1=9.0), asked(["omega4_max", "alpha4_max"], omega1=9.0)
    (first,), (second,) = ([loop for loop in e.kernels[0].loops if "and" in loop.per] for e in (small, large))
    assert all(second.work[kind] >= first.work[kind] for kind in first.work)
    assert second.work["*"] > first.work["*"]
    assert set(small.kernels[0].facts) < set(large.kernels[0].facts)


def test_an_axis_that_scales_is_named():
    found = asked(["omega4_max"], omega1=[1.0, 2.0, 3.0])
    assert found.scaling_axis == "omega1 (3 values)"
    assert "omega1 (3 values): only scales" in str(found)


def test_refined_extremes_tell_samples_and_places():
    found = explain_request(
        resolve("planar_4r", fl.grid(**LENGTHS, omega1=9.0), ["omega4_max"], branch=(1, 2))
    )
    pers = [loop.per for kernel in found.kernels for loop in kernel.loops]
    assert {"design", "design and sample", "place", "extreme"} <= set(pers)


def test_a_search_is_told_by_what_is_searched():
    """Steps and extremes of each quantity, samples of all, with what is told by both sides of the range."""
    names = ["omega4_max", "T41_extrema"]
    space = fl.grid(**LENGTHS, omega1=9.0, gravity_y=-9.81)  # gravity makes the sides unlike
    found = explain_request(resolve("planar_4r", space, names, links=ROUND_BAR, branch=(1, 2)))
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
    loaded = resolve(
        "planar_4r", fl.grid(**LENGTHS, omega1=9.0, T_load=1.0), names, links=ROUND_BAR, branch=(1, 2)
    )
    text = explain_request(loaded).text(kernels=True)
    assert "every extreme of T41; cells split at the zeros of omega4\n" in text


def test_curves_in_pieces_are_of_designs_and_positions():
    space = fl.grid(a=1.0, b=1.1, g=0.9, h=0.8)
    found = explain_request(
        resolve("minkowski_4r", space, ["psi"], angles=np.linspace(-1.0, 1.0, 600), branch=(1, 2))
    )
    assert "for piece in" in found.kernels[-1].source.text
    assert [loop.per for loop in found.kernels[-1].loops] == ["design", "design and theta"]


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(
        'mechanism = "planar_4r"\nquantities = ["omega4"]\n'
        "[design]\na1 = 0.4\na2 = 1.1\na3 = 0.8\na4 = 1.0\nomega1 = 2.0\n",
        encoding="utf-8",
    )
    return path


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


def test_the_command(study):
    brief = CliRunner().invoke(app, ["explain", str(study)])
    assert brief.exit_code == 0
    assert "asked for: omega4, status" in brief.output
    assert "def kernel(" not in brief.output
    long = CliRunner().invoke(app, ["explain", str(study), "--text"])
    assert "def kernel(" in long.output


def test_every_option_of_a_sweep_is_one_of_an_explanation():
    request = "planar_4r", fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0), ["theta4"]
    assert fl.explain(*request, part=(1, 2), measure=False).results == ("theta4", "status")
    with pytest.raises(fl.InputError, match="part is 1/3, but there are 2 designs"):
        fl.explain(*request, part=(1, 3), measure=False)

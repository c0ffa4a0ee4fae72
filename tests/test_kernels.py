"""Compiled kernels: packed arithmetic, no undeclared libm call, a readable text, a cache that notices edits."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys

import numpy as np
import pytest

import fastlink as fl
from configurations import PLANAR
from fastlink.catalogue import Catalogue, Input
from fastlink.codegen import compiled
from fastlink.mechanisms import NAMES, catalogue
from fastlink.plan import make_plan
from fastlink.plans import make_plans
from fastlink.reading import evaluate

GIVEN = tuple(PLANAR.inputs)
#: The plans of the benchmarks, and what the lanes are in each.
PLANS = {
    "positions": (["A_x", "A_y", "B_x", "B_y"], (), "angles"),
    "rates": (["B_x", "B_y", "omega2", "omega4", "alpha2", "alpha4"], (), "angles"),
    "angles": (["theta2", "theta4"], (), "angles"),
    "reactions": (
        ["F41_x", "F41_y", "F21_x", "F21_y", "F32_x", "F32_y", "F43_x", "F43_y", "T41"],
        (),
        "angles",
    ),
    "extremes": (
        ["omega4_max", "omega4_min", "alpha4_max", "alpha4_min", "T41_max", "F32_x_max"],
        (),
        "designs",
    ),
    "map": (
        ["transmission_angle_min", "shaking_force_max", "shaking_moment_max", "theta1_at_omega4_max"],
        (),
        "designs",
    ),
    "rms": (["T41_rms", "status"], (), "designs"),
    "dense": (["F32_x", "T41"], ("dense",), "designs"),
}
#: What kernels may call: numba's own frame, and memset or memcpy where loops copy.
DECLARED = re.compile(r"^(NRT_|numba_|Py|_Py|memset|memcpy|memmove|\.|_ZN)")
LIBM = re.compile(
    r"^_?_?(sin|cos|tan|atan|atan2|acos|asin|exp|log|pow|hypot|sqrt|fmod|copysign|fmax|fmin)f?$|_ZGV"
)


@pytest.fixture(scope="module")
def assembly():
    """The machine code of a plan, compiled afresh (a kernel from the cache cannot be read)."""
    texts = {}

    def read(name):
        if name not in texts:
            names, alternatives, lanes = PLANS[name]
            plan = make_plan(PLANAR, names, given=GIVEN, alternatives=alternatives)
            assert plan.lanes == lanes
            namespace = {}
            exec(compile(plan.source, f"<{name}>", "exec"), namespace)
            from fastlink.numerics.elementary import compile_kernel

            kernel = compile_kernel(namespace["kernel"], compiled.signature(plan), cache=False)
            texts[name] = kernel.inspect_asm(kernel.signatures[0])
        return texts[name]

    return read


@pytest.mark.parametrize("name", PLANS)
def test_a_plan_holds_packed_arithmetic(assembly, name):
    text = assembly(name)
    packed = len(re.findall(r"\bv?(?:add|sub|mul|div|sqrt)pd\b|\bf(?:add|sub|mul|div|sqrt)\s+v\d+\.2d", text))
    single = len(re.findall(r"\bv?(?:add|sub|mul|div|sqrt)sd\b|\bf(?:add|sub|mul|div|sqrt)\s+d\d+", text))
    assert packed > 40
    # Where lanes are angles, the angles beyond the last whole vector have a scalar copy of the loop.
    assert packed > (0.5 if PLANS[name][2] == "angles" else 4) * single


@pytest.mark.parametrize("name", PLANS)
def test_a_plan_calls_no_undeclared_function(assembly, name):
    called = set(re.findall(r"(?:call|jmp|bl)q?\s+\*?([A-Za-z_][\w.@]*)", assembly(name)))
    called |= set(re.findall(r"movabsq?\s+\$([A-Za-z_][\w.]*)", assembly(name)))
    names = {symbol.split("@")[0] for symbol in called}
    assert not {symbol for symbol in names if LIBM.search(symbol)}


def test_the_libm_check_would_notice():
    assert LIBM.search("atan2")
    assert LIBM.search("_ZGVeN8v_sin")
    assert not LIBM.search("NRT_decref")


@pytest.mark.parametrize("name", PLANS)
def test_only_what_was_asked_is_computed(name):
    names, alternatives, _ = PLANS[name]
    plan = make_plan(PLANAR, names, given=GIVEN, alternatives=alternatives)
    needed = {output.request.quantity for output in plan.outputs}
    for step in reversed(plan.steps):
        made = set(getattr(step, "unknowns", (step.name,)))
        assert made & needed, f"{step.name} is computed for nothing"
        needed |= set(step.needs)
    assert set(plan.inputs) <= needed
    assert set(plan.tables) <= needed | {"theta1"}


def test_the_text_can_be_read():
    plan = make_plan(PLANAR, ["omega4_max"], given=GIVEN)
    assert (
        "omega4__1 = mean_rate - odd_rate * output_share" in plan.source
        or "omega4__1 = mean_rate +" in plan.source
    )
    assert "F32" not in plan.source
    assert "alpha" not in plan.source


SCRIPT = """
import sys, time
from fastlink.mechanisms import catalogue
from fastlink.plan import make_plan
planar = catalogue("planar_4r")
kernel = make_plan(planar, ["omega4_max"], given=tuple(planar.inputs)).kernel
hits = sum(kernel.stats.cache_hits.values())
print(hits)
"""


def run_script(folder, script=SCRIPT):
    environment = os.environ | {"FASTLINK_CACHE_DIR": str(folder)}
    return subprocess.run(
        [sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True
    ).stdout


def test_a_second_process_takes_the_kernel_from_the_cache(tmp_path):
    assert run_script(tmp_path).strip() == "0"
    assert run_script(tmp_path).strip() == "1"


def test_an_edited_fact_is_another_kernel(tmp_path):
    edited = SCRIPT.replace(
        "kernel =",
        "import dataclasses\nfact = planar.facts['omega4']\n"
        "from fastlink.mechanisms.planar_4r import rates\n"
        "needs = planar.facts['omega2'].needs\n"
        "planar.facts['omega4'] = dataclasses.replace(fact, needs=needs, function=rates.omega2)\n"
        "kernel =",
    )
    assert run_script(tmp_path).strip() == "0"
    assert run_script(tmp_path, edited).strip() == "0"


def test_a_cache_folder_that_cannot_be_written_is_done_without(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("not a folder")
    monkeypatch.setenv("FASTLINK_CACHE_DIR", str(tmp_path / "file"))
    folder = compiled.cache_folder()
    assert folder.is_dir()
    assert tmp_path not in folder.parents


def names_of_its_own(plan):
    """Return the names in a kernel that are no values of the mechanism."""
    tree = ast.parse(plan.source)
    stored = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    stored |= {argument.arg for argument in ast.walk(tree) if isinstance(argument, ast.arg)}
    known = known_names(PLANAR) | set(PLANAR.graded.leaves)
    return {name for name in stored if name.split("__")[0] not in known and not name.startswith("out_")}


def known_names(mechanism):
    chosen = {name for facts in mechanism.alternatives.values() for name in facts}
    inputs = mechanism.known_inputs(tuple(mechanism.alternatives))
    tables = {mechanism.position.name, *mechanism.tables, *mechanism.table_low_parts}
    return {*mechanism.facts, *chosen, *inputs, *tables, "branch"}


@pytest.mark.parametrize("name", NAMES)
def test_no_value_of_a_mechanism_has_a_name_that_kernels_use(name):
    """Such a value would be taken for a count or an array: designs were left out in silence."""
    plans = [make_plan(PLANAR, names, given=GIVEN, alternatives=more) for names, more, _ in PLANS.values()]
    plans += make_plans(PLANAR, ["omega4_max", "T41_extrema"], given=GIVEN, extrema="refined").parts
    own = set().union(*map(names_of_its_own, plans))
    assert {"designs", "n_designs", "lanes", "state", "w", "w2"} <= own
    assert not own & known_names(catalogue(name))


def test_designs_beyond_the_first_lanes_are_computed_too():
    """Of lengths that are called m and n."""
    n, design = np.linspace(0.8, 1.2, 130), {"m": 1.0, "d": 1.2, "kappa": 0.5}
    found = fl.sweep("hart", fl.grid(n=n, **design), ["stroke"])["stroke"]
    np.testing.assert_array_equal(found, evaluate("hart", ["stroke"], n=n, phi=0.0, **design)["stroke"])


@pytest.mark.parametrize("lanes", ["designs", "angles"])
def test_a_fact_may_need_the_branch_itself(lanes):
    toy = Catalogue("toy", "a toy", {1: "one", 2: "other"}, Input("theta", "rad", "theta", "input"))
    toy.input("a", units="m", symbol="a", meaning="a length")
    labels = {"units": "m", "symbol": "x", "source": "here"}

    def x(a, branch, theta):
        """A fact of all three."""
        return a * branch + theta

    toy.quantity(**labels)(x)
    plan = make_plan(toy, ["x"], given=["a"], angles=40, lanes=lanes)
    designs, angles = np.full((1, 64), 3.0), np.arange(40.0).reshape(1, 40)
    found = np.empty((2, 2, 40))
    plan.kernel(designs, angles, 2, 40, *(np.empty(size) for size in plan.scratch), found)
    np.testing.assert_array_equal(found, [[3.0 + np.arange(40.0), 6.0 + np.arange(40.0)]] * 2)

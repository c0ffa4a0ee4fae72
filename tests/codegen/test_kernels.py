"""The text of kernels: what is computed, what it is called, that it can be read."""

import ast

import numpy as np
import pytest
from tests.support.configurations import PLANAR
from tests.support.toys import toy

import fastlink as fl
from fastlink.codegen.kernel import kernel_of, llvm_text
from fastlink.engine.evaluate import evaluate
from fastlink.mechanisms import NAMES, catalogue
from fastlink.plan.programs import make_plan, make_program

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


@pytest.mark.parametrize("name", PLANS)
def test_only_what_was_asked_is_computed(name):
    names, variants, lanes = PLANS[name]
    plan = make_program(PLANAR, names, given=GIVEN, variants=variants)
    assert plan.lanes == lanes
    needed = {output.request.quantity for output in plan.outputs}
    for step in reversed(plan.steps):
        made = set(getattr(step, "unknowns", (step.name,)))
        assert made & needed, f"{step.name} is computed for nothing"
        needed |= set(step.depends_on)
    assert set(plan.inputs) <= needed
    assert set(plan.tables) <= needed | {"theta1"}


def test_the_text_can_be_read():
    text = kernel_of(make_program(PLANAR, ["omega4_max"], given=GIVEN)).text
    assert "            for i in lanes(width):\n" in text
    assert "omega4__1 = mean_rate " in text
    assert "F32" not in text
    assert "alpha" not in text


@pytest.mark.parametrize("name", ["theta1_at_omega4_max", "omega4_extrema", "d_omega4_max_d_a2", ""])
def test_where_extremes_are_is_computed_where_it_is_asked_for(name):
    *_, program = make_plan(PLANAR, ["omega4_max", *filter(None, [name])], given=GIVEN).programs
    assert ("atan2(" in kernel_of(program).text) == bool(name)


def names_of_its_own(plan):
    """Return the names in a kernel that are no values of the mechanism."""
    tree = ast.parse(kernel_of(plan).text)
    stored = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    stored |= {argument.arg for argument in ast.walk(tree) if isinstance(argument, ast.arg)}
    stored |= {alias.name for alias in ast.walk(tree) if isinstance(alias, ast.alias)}
    known = known_names(PLANAR) | set(PLANAR.graded.coordinates)
    return {name for name in stored if name.split("__")[0] not in known and not name.startswith("out_")}


def known_names(mechanism):
    chosen = {name for facts in mechanism.variants.values() for name in facts}
    inputs = mechanism.known_inputs(tuple(mechanism.variants))
    tables = {mechanism.position.name, *mechanism.tables, *mechanism.table_low_parts}
    return {*mechanism.facts, *chosen, *inputs, *tables, "branch"}


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", NAMES)
def test_no_value_of_a_mechanism_has_a_name_that_kernels_use(name):
    """Such a value would be taken for a count or an array: designs were left out in silence."""
    plans = [make_program(PLANAR, names, given=GIVEN, variants=more) for names, more, _ in PLANS.values()]
    plans += make_plan(PLANAR, ["omega4_max", "T41_extrema"], given=GIVEN).programs
    own = set().union(*map(names_of_its_own, plans))
    assert {"designs", "n_designs", "lanes", "width", "state", "w", "w2"} <= own
    assert not own & known_names(catalogue(name))


def test_designs_beyond_the_first_lanes_are_computed_too():
    """Of lengths that are called m and n."""
    n, design = np.linspace(0.8, 1.2, 130), {"m": 1.0, "d": 1.2, "kappa": 0.5}
    found = fl.sweep("hart", fl.grid(n=n, **design), ["stroke"], branch=(1, 2))["stroke"]
    np.testing.assert_array_equal(found, evaluate("hart", ["stroke"], n=n, phi=0.0, **design)["stroke"])


@pytest.mark.parametrize("lanes", ["designs", "angles"])
def test_a_fact_may_need_the_branch_itself(lanes):
    made = toy("""\
        [inputs]
        a [m] a: a length
        [facts]
        ## here
        x [m] x: A fact of all three
            = a * branch + theta
        """, {1: "one", 2: "other"})  # fmt: skip
    kernel = kernel_of(make_program(made, ["x"], given=["a"], angles=40, lanes=lanes))
    designs, angles = np.full((1, 64), 3.0), np.arange(40.0).reshape(1, 40)
    found = np.empty((2, 2, 40))
    scratch = (np.empty(array.lengths(40)) for array in kernel.source.scratch)
    kernel.compiled()(designs, angles, 2, 40, *scratch, found)
    np.testing.assert_array_equal(found, [[3.0 + np.arange(40.0), 6.0 + np.arange(40.0)]] * 2)


@pytest.mark.parametrize(
    "names",
    [["theta4_extrema"], ["alpha4_extrema", "alpha4_extrema_error", "d_alpha4_max_d_a2"], ["theta4_max_error"]],
    ids=",".join,
)  # fmt: skip
def test_kernels_of_extremes_are_translated(names):
    """By our own translator: numba takes a minute for one, and makes it several times slower."""
    for program in make_plan(PLANAR, names, given=list(PLANAR.inputs)).programs:
        llvm_text(kernel_of(program).source)  # or `Refused`

"""Derivatives d_NAME_d_PARAM: against 50-digit differences and the complex step, their bits, labels and errors."""

import ast
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_array_equal
from tests.support.configurations import DIGITS, LENGTHS, PLANAR, masses_and_points, random_lengths, reference
from tests.support.precision import derivatives
from tests.support.registry import ENTRIES
from tests.support.sweeps import sweep_4r
from tests.support.toys import toy

import fastlink as fl
from fastlink.errors import InputError
from fastlink.facts.derivative import RULES
from fastlink.facts.evaluate import read_facts
from fastlink.facts.expression import ExpressionGraph, generate_formula
from fastlink.facts.fact import Fact
from fastlink.facts.formula import CatalogueError
from fastlink.numerics import compensated, vectors
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.plan.programs import make_program
from fastlink.precision.reference import HighPrecision


def one_configuration(seed, **changed):
    """Return a configuration that assembles, away from toggles and folds."""
    rng = np.random.default_rng(seed)
    while True:
        one = dict(zip(LENGTHS, random_lengths(rng, 1)[:, 0], strict=True))
        one |= {name: values[0] for name, values in masses_and_points(rng, 1).items()}
        one |= {"theta1": rng.uniform(-np.pi, np.pi), "branch": 1 + seed % 2} | changed
        if reference(["sigma"], one)["sigma"] > 0.05:
            return {name: float(value) for name, value in one.items()}


def difference(names, one, by, variants=()):
    """Return central differences with 50 digits.

    With a step of 1e-20 the third derivative leaves 1e-40 and rounding 1e-50/1e-20, times the condition number
    (below 1e4 here): 1e-25 is safe.
    """
    with mp.workdps(DIGITS):
        facts = HighPrecision(PLANAR, names, one, variants)  # pi with all digits, too
        exact = facts.at(one)
        step = abs(exact[by]) * mp.mpf(10) ** -20
        ends = [facts.moved(exact, {by: exact[by] + s * step}) for s in (1, -1)]
        return {name: (ends[0][name] - ends[1][name]) / (2 * step) for name in names}


def test_second_derivatives_are_derivatives_of_derivatives():
    one = one_configuration(4)
    slopes = difference(["d_T41_d_a2"], one, "m3")
    assert abs(reference(["d_d_T41_d_a2_d_m3"], one)["d_d_T41_d_a2_d_m3"] - slopes["d_T41_d_a2"]) < 1e-20
    assert reference(["jerk4"], one)["jerk4"] == pytest.approx(
        reference(["d_d_omega4_d_theta1_d_theta1"], one)["d_d_omega4_d_theta1_d_theta1"] * one["omega1"] ** 2,
        rel=1e-30,
    )


def test_derivatives_by_round_bars_are_total():
    """The length of a bar changes its mass, too; what is given beside the bars stays as it is."""
    one = {name: one_configuration(5)[name] for name in (*LENGTHS, "omega1", "theta1", "branch")}
    one |= {"density": 7800.0, "radius": 0.02}
    for by in ("a1", "a3", "density", "radius"):
        slopes = difference(["T41", "shaking_force"], one, by, ("round_bar",))
        for name, slope in slopes.items():
            derivative = f"d_{name}_d_{by}"
            found = reference([derivative], one, ("round_bar",))[derivative]
            assert abs(found - slope) <= 1e-25 * (1 + abs(slope))
    given = one | {"m3": 2.0, "I3": 0.1, "G3_u": 0.3, "G3_v": 0.1}
    slope = difference(["T41"], given, "a3", ("round_bar",))["T41"]
    found = reference(["d_T41_d_a3"], given, ("round_bar",))["d_T41_d_a3"]
    assert abs(found - slope) <= 1e-25 * (1 + abs(slope))
    links = fl.round_bar(density=7800.0, radius=0.02)
    swept = fl.sweep(
        "planar_4r",
        fl.grid(**{name: one[name] for name in (*LENGTHS, "omega1")}),
        ["d_T41_d_a3", "d_T41_d_density"],
        theta1=[one["theta1"]],
        links=links,
        branch=int(one["branch"]),
    )
    for name in ("d_T41_d_a3", "d_T41_d_density"):
        exact = float(reference([name], one, ("round_bar",))[name])
        # away from toggles the condition number is below 1e4
        assert swept[name].item() == pytest.approx(exact, rel=1e-11)
    assert swept["d_T41_d_density"].attrs["units"] == "N m4 kg-1"


@pytest.mark.parametrize(
    ("chosen", "given", "by"),
    [
        ("gravity", {"gravity_x": 1.5, "gravity_y": -9.81}, "gravity_y"),
        ("gravity", {"gravity_x": 1.5, "gravity_y": -9.81}, "theta1"),
        ("acceleration", {"alpha1": 40.0}, "alpha1"),
        ("acceleration", {"alpha1": 40.0}, "theta1"),
    ],
)
def test_loads_have_their_own_derivatives(chosen, given, by):
    """A derivative that is declared of a fact is not that of the fact which replaces it."""
    one = one_configuration(8) | given
    names = ["T41", "alpha4", "jerk2", "shaking_force"]
    made = derivatives(ENTRIES[0], tuple(names), by, (chosen,))
    values = reference([*names, *made.values()], one, (chosen,))
    for name, slope in difference(names, one, by, (chosen,)).items():
        found = values[made[name]] if name in made else mp.mpf(0)
        assert abs(found - slope) <= 1e-25 * (1 + abs(slope) + abs(values[name]))
    assert "T41" in made


def test_a_change_point_has_the_derivative_of_what_rounding_made_zero():
    """In a parallelogram a gap is zero; it still changes with the lengths: P_x, B and the rates near them."""
    one = one_configuration(6, a1=0.5, a3=0.5, a2=1.25, a4=1.25, theta1=1.0, branch=2)
    exact = difference(["omega4", "theta4"], one | {"a3": 0.5 + 1e-9}, "a3")
    for name, slope in exact.items():
        # the second derivative is below 100 here: 1e-9 off in a3 changes the slope by less than 1e-7
        assert fl.evaluate("planar_4r", [f"d_{name}_d_a3"], **one)[f"d_{name}_d_a3"] == pytest.approx(
            float(slope), abs=1e-6
        )


def test_a_sweep_has_the_bits_of_evaluate():
    names = [f"d_{name}_d_a1" for name in ("theta2", "curvature", "v2", "T41")]
    names += [f"d_{name}_d_theta1" for name in ("B_x", "alpha4", "shaking_force")]
    rng = np.random.default_rng(32)
    values = {name: v[0] for name, v in masses_and_points(rng, 1).items()}
    a1 = np.linspace(0.3, 2.0, 7)
    space = fl.grid(a1=a1, a2=1.4, a3=1.1, a4=1.3, **values)
    theta = np.linspace(0.1, 6.0, 40)
    swept = sweep_4r(space, names, theta1=theta, threads=1)
    given = {"a1": xr.DataArray(a1, dims="a1"), "theta1": xr.DataArray(theta, dims="theta1")}
    given["branch"] = xr.DataArray([1, 2], dims="branch")
    plain = fl.evaluate("planar_4r", names, a2=1.4, a3=1.1, a4=1.3, **values, **given)
    for name in names:
        assert swept[name].dims == ("a1", "branch", "theta1")
        assert_array_equal(swept[name], plain[name].transpose("a1", "branch", "theta1"), err_msg=name)


def test_what_is_taken_over_the_cycle_and_labels():
    space = fl.grid(a1=0.4, a2=[1.0, 1.1], a3=0.9, a4=1.2, omega1=3.0)
    names = ["d_omega4_d_a1", "d_omega4_d_a1_max", "theta1_at_d_omega4_d_a1_max", "d_omega4_d_a1_rms"]
    result = sweep_4r(space, names, theta1=90, extrema="sampled")
    curve = result["d_omega4_d_a1"]
    assert_array_equal(result["d_omega4_d_a1_max"], curve.max("theta1"))
    assert_array_equal(result["theta1_at_d_omega4_d_a1_max"], curve.idxmax("theta1"))
    assert curve.dims == ("a2", "branch", "theta1")
    assert curve.attrs["units"] == "rad s-1 m-1"
    assert curve.attrs["long_name"] == (
        "Derivative of angular velocity of the output link with respect to length of the input crank OA"
    )
    assert "numerics.md#derivatives" in curve.attrs["references"]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("d_omega4_d_m2", "omega4 does not depend on m2 with what is given; leave it out"),
        ("d_status_d_a1", "status is a code, which has no derivative"),
        ("d_omega3_d_a1", "'omega3' is unknown to planar_4r; did you mean 'd_omega2_d_a1'"),
        ("d_omega4_d_a5", "'a5' is unknown to planar_4r; did you mean 'a4'"),
        ("d_sigma_d_a1", "'sigma' is unknown to planar_4r"),
    ],
)
def test_what_has_no_derivative_is_told(name, message):
    one = one_configuration(7)
    with pytest.raises(InputError, match=message) as told:
        fl.evaluate("planar_4r", [name], **one)
    assert "\n" not in str(told.value)
    with pytest.raises(InputError):
        make_program(PLANAR, [name], given=PLANAR.inputs)


def test_linear_systems_and_missing_inputs_are_told():
    with pytest.raises(
        InputError, match="d_T41_d_a1': a linear system determines T41; write solver='eliminated'"
    ):
        make_program(PLANAR, ["d_T41_d_a1"], given=PLANAR.inputs, variants=("dense",))
    with pytest.raises(InputError, match="a3 is missing"):
        make_program(PLANAR, ["d_omega4_d_a1"], given=("a1", "a2", "a4", "omega1"))


def test_a_table_without_a_derivative_is_a_fault_of_the_mechanism():
    made = toy("""\
        ## here
        [tables]
        s [1] s: Sine
            = sin(theta)
        [facts]
        b [1] b: Twice
            = 2.0 * s
        """)
    with pytest.raises(CatalogueError, match="table s has no declared derivative with respect to theta"):
        made.resolve("d_b_d_theta")


def test_derivatives_are_short_and_keep_to_the_grammar():
    """No step twice, no factor 1, nothing added to zero: what finds the extremes of T41 runs a billion times."""
    leaves = (*PLANAR.inputs, *PLANAR.tables, *PLANAR.table_low_parts, "branch", "theta1")
    for step in PLANAR.dependencies(["d_T41_d_theta1", "d_curvature_d_a1"], leaves):
        written = [node for s in step.formula.statements for node in ast.walk(s)]
        products = [ast.unparse(node) for node in written if isinstance(node, ast.BinOp)]
        if step.name.startswith("d_") and step.name not in PLANAR.facts:
            assert len(products) == len(set(products)), step.name
            for node in written:
                if isinstance(node, ast.BinOp):
                    numbers = {x.value for x in (node.left, node.right) if isinstance(x, ast.Constant)}
                    neutral = {1.0, -1.0} if isinstance(node.op, ast.Mult) else {0.0}
                    assert not numbers & neutral, ast.unparse(node)
    plain = sum(1 for _ in PLANAR.dependencies(["T41"], leaves))
    assert sum(1 for _ in PLANAR.dependencies(["d_T41_d_theta1"], leaves)) < 2 * plain + 15


def test_every_function_of_geometry_has_a_rule_or_can_be_read():
    """A function that splits numbers would be read as if it were smooth."""
    exact = {"gap_product_quotient", "pair_product", "pair_quotient", "sum_of_four", "two_product", "two_sum"}
    piecewise = {"absolute", "choice", "power_of_two_below", "zero_where"}
    read = {"cross", "largest", "magnitude", "sign", "size_power", "square_sum", "turn_rate"}
    elementary = {"sqrt", "sine", "cosine", "log", "log_quotient", "log1p"}
    assert exact | piecewise | elementary == {function.__name__ for function in RULES}
    assert exact | piecewise | read == {*compensated.__all__, *vectors.__all__}


#: Beyond it Python refuses to recurse, with its default limit.
CHAIN = 1200


#: A mechanism whose chains have two inputs.
INPUTS = "[inputs]\n{x,y} [1] {x,y}: a number\n[facts]\n## tests\n"


def assert_held_to_the_end(mechanism, last, x, y):
    """Compare the last of a chain f <- f y + y, its derivative and both error bounds with exact arithmetic."""
    names = [last, f"d_{last}_d_y"]
    found = read_facts(mechanism, [*names, *(f"{name}_error" for name in names)], {"x": x, "y": y})
    exact, slope = Fraction(x), Fraction(0)
    for _ in range(CHAIN):
        # rounded to 200 places, which is nothing next to doubles, as exact numbers grow at every step
        exact, slope = (
            Fraction(round(z * 2**200), 2**200)
            for z in (exact * Fraction(y) + Fraction(y), slope * Fraction(y) + exact + 1)
        )
    for name, right in zip(names, (exact, slope), strict=True):
        assert abs(Fraction(found[name]) - right) <= Fraction(found[f"{name}_error"])
        # errors shrink by y at each step: the sum of some roundings over 1 - y
        assert found[f"{name}_error"] <= 100 * UNIT_ROUNDING * abs(found[name]) / (1 - y) ** 2


@pytest.mark.stress
def test_chains_of_facts_of_any_length_are_derived():
    chain = (
        f"f{k} [1] f: a link of the chain\n    = {f'f{k - 1}' if k else 'x'} * y + y\n" for k in range(CHAIN)
    )
    assert_held_to_the_end(toy(INPUTS + "".join(chain)), f"f{CHAIN - 1}", 0.3, 0.5)


def test_texts_of_any_length_are_derived():
    graph = ExpressionGraph([])
    value = graph.name("x")
    for _ in range(CHAIN):
        value = graph.add(graph.mul(value, graph.name("y")), graph.name("y"))
    formula = generate_formula("f", graph, value, {})
    mechanism = toy(INPUTS)
    mechanism.declare(Fact("f", formula, formula.parameters, "1", "f", "the end of the text", "tests"))
    assert_held_to_the_end(mechanism, "f", 0.3, 0.5)

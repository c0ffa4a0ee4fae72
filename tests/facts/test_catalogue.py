"""Declarations: what follows from them, what a catalogue rejects, and that all mechanisms are declared in full."""

from fractions import Fraction
from importlib import import_module

import pytest
from tests.support.toys import add, toy

from fastlink.errors import InputError
from fastlink.facts.evaluate import read_facts
from fastlink.facts.expression import GraphAsWritten
from fastlink.facts.formula import NAMESPACE, CatalogueError
from fastlink.mechanisms import NAMES
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.precision.reference import CONTEXT


@pytest.fixture
def made():
    return toy("[inputs]\na [m] a: a length")


def declare(made, name, of, variant=""):
    section = f"[variant {variant}]" if variant else "[facts]"
    add(made, f"{section}\n## here\n{name} [m] x: Something\n    = {of}")


SQUARE = """\
## here
step b [m] x: Square of a, without loss
    low: b_low
    = two_product(a, a)
"""


def test_a_fact_with_a_low_part_determines_two_values(made):
    add(made, f"{SQUARE}c [m] x: Square of a, rounded twice\n    = (b - 1.0) + b_low")
    made.check()
    a = 1.0 + 2.0**-40
    found = read_facts(made, ["c"], {"a": a})
    assert Fraction(found["b"]) + Fraction(found["b_low"]) == Fraction(a) ** 2
    assert found["b_low"] != 0.0
    assert [step.names for step in made.dependencies(["b_low", "b", "c"], ["a"])] == [
        ("b", "b_low"),
        ("c",),
    ]
    # the derivative is that of the high part, and the low part carries none
    assert read_facts(made, ["d_c_d_a"], {"a": a})["d_c_d_a"] == 2.0 * a
    with pytest.raises(InputError, match="b_low does not depend on a"):
        made.resolve("d_b_low_d_a")
    # to error bounds the low part is what the high one lost: their sum has no error
    bounds = made.selection((), ()).error_bounds
    ((low, (times, high)),) = bounds.of(bounds.graph.name("b")).lost.items()
    assert (low.value, times, high.value) == ("b_low", -1.0, "b")
    # 50 digits hold the square, so that nothing is lost
    exact = read_facts(made, ["b"], {"a": CONTEXT.mpf(a)})
    assert (exact["b"], exact["b_low"]) == (CONTEXT.mpf(a) ** 2, 0)


def test_low_parts_have_names_of_their_own(made):
    add(made, SQUARE)
    with pytest.raises(CatalogueError, match="b_low is declared twice"):
        declare(made, "b_low", "a")


def test_a_fact_has_not_the_name_of_a_variant(made):
    """What is selected counts as given where facts are among what is given: such a fact had no derivative."""
    declare(made, "load", "a")
    with pytest.raises(CatalogueError, match="load is the name of a fact and of a variant"):
        add(made, "[variant load]\nweight [N] W: weight\n    default: 0.0")
    add(made, "[variant brake]\nspeed [1] v: speed\n    default: 0.0")
    with pytest.raises(CatalogueError, match="brake is the name of a fact and of a variant"):
        declare(made, "brake", "a")
    # but the fact that an input of that name replaces
    declare(made, "c", "a")
    add(made, "[variant c]\nc [1] c: c")


def test_a_missing_input_is_named_with_what_needs_it(made):
    declare(made, "b", "a")
    with pytest.raises(InputError, match=r"a is missing \(a length \[m\]\); b depends on it"):
        list(made.dependencies(["b"], []))


def test_inputs_that_determine_each_other(made):
    add(made, "[inputs]\nrho [1] rho: ratio")
    for other in ("s", "lambda_"):
        add(made, f"[variant {other}]\n{other} [1] x: {other}")
        declare(made, "rho", other, variant=other)
    declare(made, "r", "rho")
    made.check()
    assert made.variants_selected_by(["s"]) == ("s",)
    assert made.mutually_exclusive_inputs("rho") == ("s", "lambda_")
    assert made.mutually_exclusive_inputs("s") == ("rho", "lambda_")
    with pytest.raises(InputError, match=r"rho is missing .*add it, or 's' instead, or 'lambda_' instead"):
        list(made.dependencies(["r"], []))


@pytest.mark.parametrize("mechanism", NAMES)
def test_every_mechanism_is_declared_in_full(mechanism):
    """What it takes 10 ms a catalogue to find out is found out here, not at each start of a program."""
    driven = import_module(f"fastlink.mechanisms.{mechanism}").DRIVEN
    for position in (None, *driven):
        find_catalogue(mechanism, position).check()


def branching(x):
    if x > 0:
        return x
    return -x


def looping(x):
    for _ in range(3):
        x = x + 1
    return x


def powering(x):
    return x**2


def unfinished(x):
    y = x  # noqa: F841


@pytest.mark.parametrize("function", [branching, looping, powering, unfinished])
def test_a_function_that_formulas_call_keeps_to_their_grammar(function):
    graph = GraphAsWritten(())
    with pytest.raises(CatalogueError, match=r"formula of .* (has .*grammar|must end in its one return)"):
        graph.read(function, [graph.name("x")])


def test_formulas_call_the_projects_own_functions():
    called = {value for value in NAMESPACE.values() if callable(value)}
    assert all(function.__module__.startswith("fastlink.numerics.") for function in called)


@pytest.mark.parametrize("mechanism", NAMES)
def test_symbols_of_inputs_differ(mechanism):
    """A picture shows an input by its symbol alone."""
    declared = find_catalogue(mechanism)
    inputs = declared.known_inputs(declared.variant_inputs).values()
    symbols = [given.symbol for given in inputs]
    assert len(set(symbols)) == len(symbols)

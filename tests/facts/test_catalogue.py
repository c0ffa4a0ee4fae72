"""Declarations: what a catalogue rejects, the grammar of facts, and the derivative check."""

from __future__ import annotations

import ast
from fractions import Fraction
from importlib import import_module

import pytest
from tests.support.configurations import PLANAR

from fastlink.errors import InputError
from fastlink.facts.catalogue import Catalogue
from fastlink.facts.evaluate import read_facts
from fastlink.facts.fact import CatalogueError, Fact, Input, System, statements
from fastlink.mechanisms import NAMES
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.numerics.compensated import two_product
from fastlink.precision.reference import CONTEXT

LABELS = {"units": "m", "symbol": "x", "source": "here"}


@pytest.fixture
def catalogue():
    made = Catalogue("toy", "a toy", {1: "the only one"}, Input("theta", "rad", "theta", "input"))
    made.input("a", units="m", symbol="a", meaning="a length")
    return made


def declare(catalogue, name, depends_on, doc="Something.", **labels):
    namespace = {}
    exec(f"def {name}({', '.join(depends_on)}):\n    '''{doc}'''\n    return 0.0\n", namespace)
    return catalogue.quantity(**LABELS | labels)(namespace[name])


@pytest.mark.parametrize("missing", ["units", "symbol", "source"])
def test_a_fact_without_a_label_is_rejected(catalogue, missing):
    with pytest.raises(CatalogueError, match=f"fact b has no {missing}"):
        declare(catalogue, "b", ["a"], **{missing: ""})


def test_a_fact_without_a_meaning_is_rejected(catalogue):
    with pytest.raises(CatalogueError, match="fact b has no meaning"):
        declare(catalogue, "b", ["a"], doc="")


@pytest.mark.parametrize("name", ["a", "theta", "branch", "b"])
def test_a_duplicate_is_rejected(catalogue, name):
    declare(catalogue, "b", ["a"])
    with pytest.raises(CatalogueError, match=f"{name} is declared twice"):
        declare(catalogue, name, ["a"])


def scaled(length, factor):
    return length * factor


def reversed_sign(length, factor):
    return -(length * factor)


def test_a_row_of_a_vector_declares_both_of_its_components(catalogue):
    step = catalogue.steps(units="m", source="here")
    step.vector((scaled, reversed_sign), "P_*", "P_*", "Point P", length="Q_*", factor="a", units="1")
    x, y = catalogue.facts["P_x"], catalogue.facts["P_y"]
    assert (x.function, y.function) == (scaled, reversed_sign)
    assert (x.depends_on, y.depends_on) == (("Q_x", "a"), ("Q_y", "a"))
    assert (x.symbol, y.symbol, x.meaning, y.meaning) == ("P_x", "P_y", "Point P, x", "Point P, y")
    assert (x.units, x.source, x.internal) == ("1", "here", True)
    quantity = catalogue.quantities(units="m", source="here")
    quantity.vector(scaled, "R_*", "R", "Point R", length="P_*", factor="a")
    assert catalogue.facts["R_x"].function is catalogue.facts["R_y"].function is scaled
    assert catalogue.facts["R_y"].depends_on == ("P_y", "a")


def test_a_circle_is_rejected(catalogue):
    declare(catalogue, "b", ["c"])
    declare(catalogue, "c", ["b"])
    with pytest.raises(CatalogueError, match=r"circular: (b -> c -> b|c -> b -> c)"):
        catalogue.check()


def test_one_law_serves_several_quantities(catalogue):
    def double(x):
        """Twice a number."""
        return 2.0 * x

    for name, of in (("b", "a"), ("c", "b")):
        catalogue.quantity(**LABELS, name=name, meaning=f"twice {of}", given={"x": of})(double)
    assert catalogue.facts["c"].depends_on == ("b",)
    assert read_facts(catalogue, ["c"], {"a": 3.0})["c"] == 12.0


def declare_square(catalogue, **labels):
    @catalogue.quantity(**LABELS | {"internal": True} | labels, low="b_low")
    def b(a: float) -> tuple[float, float]:
        """Square of a, without loss."""
        return two_product(a, a)


def test_a_fact_with_a_low_part_determines_two_values(catalogue):
    declare_square(catalogue)

    @catalogue.quantity(**LABELS)
    def c(b, b_low):
        """Square of a, rounded twice."""
        return (b - 1.0) + b_low

    catalogue.check()
    a = 1.0 + 2.0**-40
    found = read_facts(catalogue, ["c"], {"a": a})
    assert Fraction(found["b"]) + Fraction(found["b_low"]) == Fraction(a) ** 2
    assert found["b_low"] != 0.0
    assert [step.names for step in catalogue.dependencies(["b_low", "b", "c"], ["a"])] == [
        ("b", "b_low"),
        ("c",),
    ]
    # the derivative is that of the high part, and the low part carries none
    assert read_facts(catalogue, ["d_c_d_a"], {"a": a})["d_c_d_a"] == 2.0 * a
    with pytest.raises(InputError, match="b_low does not depend on a"):
        catalogue.resolve("d_b_low_d_a")
    # to error bounds the low part is what the high one lost: their sum has no error
    ((low, (times, high)),) = catalogue._selection((), ()).error_bounds.named("b").lost.items()
    assert (low.value, times, high.value) == ("b_low", -1.0, "b")
    # 50 digits hold the square, so that nothing is lost
    exact = read_facts(catalogue, ["b"], {"a": CONTEXT.mpf(a)})
    assert (exact["b"], exact["b_low"]) == (CONTEXT.mpf(a) ** 2, 0)


def test_low_parts_are_steps_on_the_way_and_have_names_of_their_own(catalogue):
    with pytest.raises(CatalogueError, match="fact b has a low part, and is not internal"):
        declare_square(catalogue, internal=False)
    declare_square(catalogue)
    with pytest.raises(CatalogueError, match="b_low is declared twice"):
        declare(catalogue, "b_low", ["a"])


def test_a_fact_has_not_the_name_of_a_variant(catalogue):
    """What is selected counts as given where facts are among what is given: such a fact had no derivative."""
    declare(catalogue, "load", ["a"])
    with pytest.raises(CatalogueError, match="load is the name of a fact and of a variant"):
        catalogue.input("weight", units="N", symbol="W", meaning="weight", variant="load", default=0.0)
    catalogue.input("speed", units="1", symbol="v", meaning="speed", variant="brake", default=0.0)
    with pytest.raises(CatalogueError, match="brake is the name of a fact and of a variant"):
        declare(catalogue, "brake", ["a"])
    # but the fact that an input of that name replaces
    declare(catalogue, "c", ["a"])
    catalogue.input("c", units="1", symbol="c", meaning="c", variant="c")


def test_an_undeclared_need_is_rejected(catalogue):
    declare(catalogue, "b", ["z"])
    with pytest.raises(CatalogueError, match="b depends on z, which is not declared"):
        catalogue.check()


def test_a_table_depends_on_the_position_alone(catalogue):
    def sine(a):
        """Sine."""
        return a

    with pytest.raises(CatalogueError, match="must depend on theta alone"):
        catalogue.table(symbol="s", source="here")(sine)


def test_a_missing_input_is_named_with_what_needs_it(catalogue):
    declare(catalogue, "b", ["a"])
    with pytest.raises(InputError, match=r"a is missing \(a length \[m\]\); b depends on it"):
        list(catalogue.dependencies(["b"], []))


def test_inputs_that_determine_each_other(catalogue):
    catalogue.input("rho", units="1", symbol="rho", meaning="ratio")
    for other in ("s", "lambda_"):
        catalogue.input(other, units="1", symbol=other, meaning=other, variant=other)
        declare(catalogue, "rho", [other], variant=other)
    declare(catalogue, "r", ["rho"])
    catalogue.check()
    assert catalogue.variants_selected_by(["s"]) == ("s",)
    assert catalogue.mutually_exclusive_inputs("rho") == ("s", "lambda_")
    assert catalogue.mutually_exclusive_inputs("s") == ("rho", "lambda_")
    with pytest.raises(InputError, match=r"rho is missing .*add it, or 's' instead, or 'lambda_' instead"):
        list(catalogue.dependencies(["r"], []))


@pytest.mark.parametrize("mechanism", NAMES)
def test_every_mechanism_is_declared_in_full(mechanism):
    """What it takes 10 ms a catalogue to find out is found out here, not at each start of a program."""
    driven = import_module(f"fastlink.mechanisms.{mechanism}").DRIVEN
    for position in (None, *driven):
        find_catalogue(mechanism, position).check()


def every_fact():
    variants = [found for variant in PLANAR.variants.values() for found in variant.values()]
    facts = [*PLANAR.facts.values(), *PLANAR.tables.values(), *variants]
    return list({id(fact.function): fact for fact in facts}.values())


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
def test_the_grammar_refuses(function):
    with pytest.raises(CatalogueError):
        statements(function)


def test_facts_keep_to_the_grammar_and_call_the_projects_own_functions():
    for fact in every_fact():
        assert isinstance(fact, Fact | System)
        for statement in statements(fact.function):
            for node in ast.walk(statement):
                if isinstance(node, ast.Call):
                    called = fact.function.__globals__.get(node.func.id, node.func.id)
                    name = getattr(called, "__module__", called)
                    assert name.startswith("fastlink.numerics.") or name in ("abs", "builtins"), (
                        fact.name,
                        node.func.id,
                    )


@pytest.mark.parametrize("mechanism", NAMES)
def test_symbols_of_inputs_differ(mechanism):
    """A picture shows an input by its symbol alone."""
    declared = find_catalogue(mechanism)
    inputs = declared.known_inputs(declared.variant_inputs).values()
    symbols = [given.symbol for given in inputs]
    assert len(set(symbols)) == len(symbols)

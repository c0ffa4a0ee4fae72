"""The grammar of names: what is spelt is read again, each name has one reading, and one module knows the rules."""

import ast
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.support.registry import every_input
from tests.support.toys import add, toy

import fastlink as fl
from fastlink.errors import InputError
from fastlink.facts.formula import CatalogueError
from fastlink.facts.names import (
    Below,
    Change,
    Derivative,
    ErrorBound,
    GradientStatus,
    ListOfExtrema,
    Quantity,
    Reduced,
    Trust,
    innermost,
    parse,
    plain_part,
    register_reduction,
    root_of,
    signed,
)
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.programs import make_plan
from fastlink.plan.query import REDUCTIONS, list_names, parse_request

SOURCE = Path(__file__).parents[2] / "src" / "fastlink"


def plain_names(catalogue):
    """Return the declared names that are not made of others."""
    sets = [*catalogue.variants.values(), *catalogue.variant_inputs.values()]
    declared = {*catalogue.facts, *catalogue.inputs, *catalogue.tables}
    declared |= {catalogue.position.name, *(name for names in sets for name in names)}
    return sorted(name for name in declared if parse(name, catalogue) == Quantity(name))


@cache
def trees(catalogue):
    """Return a strategy for all that may be made of what a catalogue declares."""
    plain = plain_names(catalogue)
    leaves = [st.sampled_from(plain).map(Quantity)]
    replaced = [
        Below(Quantity(name), variant)
        for variant, facts in catalogue.variants.items()
        for name in facts
        if name in plain
    ]
    leaves += [st.sampled_from(replaced)] if replaced else []
    variables, hows = st.sampled_from(sorted(catalogue.variables)), st.sampled_from(("worst", "rss"))
    pointwise = st.recursive(
        st.one_of(leaves),
        lambda of: st.one_of(
            st.builds(Derivative, of, variables, st.booleans()),
            st.builds(ErrorBound, of),
            st.builds(Trust, of),
            st.builds(Change, of, hows),
        ),
        max_leaves=4,
    )
    at = catalogue.position.name
    positions = [
        (how, position) for how, r in REDUCTIONS.items() for position in ([""] + [at] * r.has_position)
    ]
    parts = [("value", ""), ("value", at), ("count", ""), ("kind", ""), ("error", "")]
    reduced = st.builds(lambda of, way: Reduced(of, *way), pointwise, st.sampled_from(positions))
    lists = st.builds(lambda of, way: ListOfExtrema(of, *way), pointwise, st.sampled_from(parts))
    gradients = st.builds(Derivative, reduced, variables)
    of_cycle = (st.builds(ErrorBound, reduced), gradients, st.builds(ErrorBound, gradients))
    changes = st.builds(Change, reduced, hows)
    of_cycle = (*of_cycle, changes, st.builds(ErrorBound, changes), st.builds(Derivative, changes, variables))
    status = st.builds(GradientStatus, reduced.filter(lambda tree: not tree.position))
    return st.one_of(pointwise, reduced, lists, *of_cycle, status)


@pytest.mark.sample(3)
@every_input
@settings(deadline=None)
@given(data=st.data())
def test_what_is_spelt_is_read_again(mechanism, drive, data):
    catalogue = find_catalogue(mechanism, drive)
    tree = data.draw(trees(catalogue))
    # what hides a reduction is declared so, and takes its place; so does a fact with that of an internal value
    replaced = str(tree) in catalogue.hiding or (isinstance(tree, Reduced) and catalogue.declares(str(tree)))
    assert parse(str(tree), catalogue) == (Quantity(str(tree)) if replaced else tree)


def reduced_names(catalogue):
    """Yield every name of a reduction or list over a mechanism's cycle: of all but the codes of a design."""
    for quantity in filter(catalogue.varies, catalogue.public):
        for reduction in REDUCTIONS.values():
            if reduction.of_path or (reduction.of_size and catalogue.public[quantity].flags):
                continue
            yield str(Reduced(Quantity(quantity), reduction.suffix))
            if reduction.has_position:
                yield str(Reduced(Quantity(quantity), reduction.suffix, catalogue.position.name))
        yield from list_names(catalogue, quantity)


@pytest.mark.sample(4)
@every_input
def test_every_listed_name_is_read(mechanism, drive):
    catalogue = find_catalogue(mechanism, drive)
    for name in catalogue.public:
        assert parse(name, catalogue) == Quantity(name)
    for row in fl.quantities(mechanism, internal=True, input=drive):
        assert str(parse(row.name, catalogue)) == row.name
    for name in reduced_names(catalogue):
        tree = parse(name, catalogue)
        assert str(tree) == name
        assert root_of(tree) in catalogue.public
        request = parse_request(name, catalogue)
        assert signed(request.quantity) == (name if name in catalogue.hiding else str(tree.of))
        assert (signed(request.quantity) != request.quantity) is name.endswith("_peak")


@pytest.mark.parametrize(
    ("name", "tree"),
    [
        ("d_d_omega4_d_a1_d_a2", Derivative(Derivative(Quantity("omega4"), "a1"), "a2")),
        ("d_omega4_d_a1_error", ErrorBound(Derivative(Quantity("omega4"), "a1"))),
        ("theta1_at_omega4_error_max", Reduced(ErrorBound(Quantity("omega4")), "max", "theta1")),
        ("omega4_max_error", ErrorBound(Reduced(Quantity("omega4"), "max"))),
        ("omega4_error_max_error", ErrorBound(Reduced(ErrorBound(Quantity("omega4")), "max"))),
        ("theta1_at_omega4_max_error", ErrorBound(Reduced(Quantity("omega4"), "max", "theta1"))),
        ("d_omega4_max_d_a2", Derivative(Reduced(Quantity("omega4"), "max"), "a2")),
        ("d_theta1_at_omega4_max_d_a2", Derivative(Reduced(Quantity("omega4"), "max", "theta1"), "a2")),
        ("d_omega4_max_d_a2_error", ErrorBound(Derivative(Reduced(Quantity("omega4"), "max"), "a2"))),
        ("d_d_omega4_d_a1_max_d_a2", Derivative(Reduced(Derivative(Quantity("omega4"), "a1"), "max"), "a2")),
        ("omega4_max_gradient_status", GradientStatus(Reduced(Quantity("omega4"), "max"))),
        ("d_omega4_d_a2__moving", Derivative(Quantity("omega4"), "a2", moving=True)),
        ("omega4_extrema_error", ListOfExtrema(Quantity("omega4"), "error")),
        ("omega4_extrema_kind", ListOfExtrema(Quantity("omega4"), "kind")),
        ("theta1_at_omega4_extrema", ListOfExtrema(Quantity("omega4"), "value", "theta1")),
        ("T41__below_gravity", Below(Quantity("T41"), "gravity")),
        ("Z0_low", Quantity("Z0_low")),  # declared: what Z0 lost in rounding
        ("theta4_low", Quantity("theta4_low")),  # declared: the least |theta4|
        ("theta1_at_omega4_rms", Quantity("theta1_at_omega4_rms")),  # no place has the root mean square
        ("d_omega4_d_nothing", Quantity("d_omega4_d_nothing")),
        ("_error", Quantity("_error")),
        ("_max", Quantity("_max")),
    ],
)
def test_how_names_are_read(name, tree):
    catalogue = find_catalogue("planar_4r")
    assert parse(name, catalogue) == tree


def test_what_a_name_is_made_of_in_the_end():
    catalogue = find_catalogue("planar_4r")
    for name in [
        "omega4_max_error",
        "d_omega4_max_d_a1",
        "theta1_at_omega4_min",
        "omega4_error_extrema",
        "omega4",
    ]:
        assert innermost(name, catalogue) == "omega4"
    assert plain_part(parse("d_omega4_d_a1_error", catalogue)) == "omega4"
    assert plain_part(parse("omega4_max", catalogue)) == "omega4_max"


def test_a_declared_limit_hides_the_extreme_of_the_same_name():
    """psi_max of the Minkowskian 4R is the limit of a theorem; where psi is greatest has a name."""
    catalogue = find_catalogue("minkowski_4r")
    assert parse("psi_max", catalogue) == Quantity("psi_max")
    assert parse("theta_at_psi_max", catalogue) == Reduced(Quantity("psi"), "max", "theta")
    with pytest.raises(InputError, match="cannot be listed; ask for psi, and take extremes of the map"):
        make_plan(catalogue, ["psi_extrema"], given=list(catalogue.inputs))
    with pytest.raises(InputError, match="cannot be listed; ask for A_y_max and A_y_min"):
        make_plan(catalogue, ["A_y_extrema"], given=list(catalogue.inputs))


@pytest.fixture
def made():
    return toy("[inputs]\na [m] a: a length")


def declare(catalogue, name, step="", saying=""):
    add(catalogue, f"## here\n{step}{name} [m] x: Something\n    = a\n{saying}")


#: Made of b, a public quantity, and a, an input.
OF_B = ["b_error", "b_trust", "b_max", "b_mean", "b_extrema", "b_extrema_count", "b_extrema_kind"]
OF_B += ["b_max_error", "b_extrema_error", "b_max_gradient_status"]
MADE = [*OF_B, "d_b_d_a", "d_b_d_theta", "d_b_error_d_a", "b_error_max", "theta_at_b_max", "b__below_gravity"]


@pytest.mark.parametrize("name", MADE)
def test_a_fact_that_reads_as_made_of_another_is_refused(made, name):
    declare(made, "b")
    with pytest.raises(CatalogueError, match=f"{name} reads as "):
        declare(made, name)


@pytest.mark.parametrize("name", OF_B)
def test_it_is_refused_in_whatever_order_both_are_declared(made, name):
    declare(made, name)
    with pytest.raises(CatalogueError, match=f"with b, {name} reads as made of it"):
        declare(made, "b")


@pytest.mark.parametrize("name", OF_B)
def test_what_is_declared_past_the_door_is_refused_by_the_check(made, name):
    declare(made, "b")
    made.facts[name] = replace(made.facts["b"], name=name)
    with pytest.raises(CatalogueError, match=f"{name} reads as "):
        made.check()


@pytest.mark.parametrize("name", ["x_d_y", "theta_at_rest", "x__below_y"])
def test_what_tells_the_parts_of_a_name_apart_is_in_no_plain_name(made, name):
    with pytest.raises(CatalogueError, match=f"{name} reads as "):
        declare(made, name)


#: Every declaration but that of a fact.
WAYS = {
    "input": "[inputs]\nb_error [m] x: a length",
    "input of a variant": "[variant other]\nb_error [m] x: a length",
    "fact of a variant": "[variant other]\n## here\nb_error [m] x: Something\n    = a",
    "table": "[tables]\n## here\nb_error [1] x: Something\n    = theta",
    "low part": "[tables]\n## here\nt [1] x: Something\n    low: b_error\n    = theta",
    "unknown": "[variant other]\nsystem s: b_error\n    | theta, theta",
}


@pytest.mark.parametrize("kind", WAYS)
def test_every_declaration_is_checked(made, kind):
    declare(made, "b")
    with pytest.raises(CatalogueError, match="b_error reads as "):
        add(made, WAYS[kind])


def test_names_that_only_look_like_others_are_not_refused(made):
    declare(made, "b", "step ")
    declare(made, "b_max")  # users cannot ask for b, nor for its maximum
    declare(made, "AB_error")  # there is no AB
    declare(made, "c")
    declare(made, "c_min", saying="    hides: its reduction\n")
    made.check()
    assert parse("b_max", made) == Quantity("b_max")
    assert parse("AB_error", made) == Quantity("AB_error")


@pytest.mark.parametrize(
    "how", ["error", "trust", "low", "kind", "count", "extrema", "status", "two_words", "no name"]
)
def test_a_reduction_cannot_be_called_what_an_ending_means_already(how):
    with pytest.raises(CatalogueError, match="a reduction cannot be called"):
        register_reduction(how, has_position=False)


ENDINGS = ["error", "trust", "extrema", "extrema_count", "extrema_kind", "extrema_error", "gradient_status"]
ENDINGS += [*REDUCTIONS]
#: A name that is made of the value in a formatted text, which is {} here, and texts that can only be parts of names.
MADE_OF = re.compile(rf"(?<![a-z])d_{{}}|_d_{{}}|{{}}_(d|at)_|__below_|{{}}_({'|'.join(ENDINGS)})(?![a-z])")
PARTS = re.compile(rf"_({'|'.join(ENDINGS)}|_moving|_below_|d_|at_)|d_|\S*(_d_|d_\()\S*")
SPLITTERS = ("partition", "rpartition", "split", "rsplit")


def faults(source):
    """Return the expressions of a module that spell names which are made of others, or take them apart."""
    found = []
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.JoinedStr(values=parts):
                fault = MADE_OF.search("".join(getattr(part, "value", "") if isinstance(part, ast.Constant) else "{}"
                                               for part in parts))  # fmt: skip
            case ast.Constant(value=str(text)):
                fault = PARTS.fullmatch(text)
            case ast.Call(func=ast.Attribute(attr=method), args=[ast.Constant(value="_"), *_]):
                fault = method in SPLITTERS
            case _:
                fault = False
        found += [ast.unparse(node)] if fault else []
    return found


def test_the_search_finds_what_it_is_for():
    spelt = ('f"d_{x}_d_{by}"', 'f"{x}_error"', 'f"{at}_at_{x}_max"')
    spelt += ('f"ask for {x}_max and _min"', 'x + "_trust"')
    taken = ('x.endswith(("_error", "_trust"))', 'x.startswith("d_")')
    taken += ('x.rpartition("_")', 're.compile("d_(.+)")')
    assert all(map(faults, (*spelt, *taken, 'x.partition("__below_")', 'ERROR = "_error"')))


def test_no_other_module_spells_names_or_takes_them_apart():
    """But the rules of derivatives, whose parameters are called so, and that of units, which end names of inputs."""
    others = ("names.py", "derivative.py", "units.py")
    paths = [path for path in SOURCE.rglob("*.py") if path.name not in others]
    assert {path.name: found for path in paths if (found := faults(path.read_text()))} == {}

"""Each fact is defined once: no two of a catalogue compute one expression, and the factors are the paper's."""

from fractions import Fraction

import numpy as np
import pytest
from tests.support.configurations import PLANAR

from fastlink.facts.evaluate import read_facts
from fastlink.facts.expression import ExpressionGraph
from fastlink.facts.fact import Fact
from fastlink.mechanisms import NAMES, inputs_of
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.numerics import compensated, elementary, logarithm, vectors

NUMERICS = (compensated, elementary, logarithm, vectors)
FUNCTIONS = [f for module in NUMERICS for f in vars(module).values() if callable(f)]
CASES = [
    (mechanism, position, chosen)
    for mechanism in NAMES
    for position in inputs_of(mechanism)
    for chosen in ((), *((name,) for name in find_catalogue(mechanism, position).variants))
]


def bare(node):
    return node.args[0] if node.kind == "neg" else node


def twins(catalogue, chosen):
    """Return pairs of facts whose texts, written over inputs alone, are one expression or its negative."""
    graph = ExpressionGraph(FUNCTIONS)
    replaced = {name for key in chosen for name in catalogue.variants.get(key, {})}
    given = {*catalogue.known_inputs(chosen), *catalogue.tables, *catalogue.table_low_parts}
    given |= {catalogue.position.name, "branch", *(catalogue.graded.coordinates if catalogue.graded else ())}
    values = {name: graph.name(name) for name in given - replaced}
    names = sorted(name for name in catalogue.facts if not catalogue.is_derivative(name))
    first, pairs = {}, []
    for step in catalogue.dependencies(names, given - replaced, chosen):
        if not isinstance(step, Fact):
            values |= {name: graph.name(name) for name in step.names}
            continue
        own, whole = (
            graph.read(step.formula, list(depends_on))
            for depends_on in (map(graph.name, step.depends_on), (values[need] for need in step.depends_on))
        )
        for k, name in enumerate(step.names):
            text, value = own, whole
            if step.low is not None:
                text, value = graph.part(own, k), graph.part(whole, k)
            values[name] = value
            if bare(text).kind not in ("name", "number") and bare(value).kind != "number":
                pairs += [(first[bare(value)], name)] if bare(value) in first else []
                first.setdefault(bare(value), name)
    return pairs


@pytest.mark.sample(4)
@pytest.mark.parametrize(("mechanism", "position", "chosen"), CASES)
def test_no_two_facts_compute_one_expression(mechanism, position, chosen):
    assert twins(find_catalogue(mechanism, position), chosen) == []


# Hayes, Hninn, Irani, below eq. (1), as printed.
FACTORS = {
    "A1": lambda a_1, a_2, a_3, a_4: a_1 - a_2 + a_3 - a_4,
    "A2": lambda a_1, a_2, a_3, a_4: a_1 + a_2 + a_3 - a_4,
    "B1": lambda a_1, a_2, a_3, a_4: a_1 + a_2 - a_3 - a_4,
    "B2": lambda a_1, a_2, a_3, a_4: a_1 - a_2 - a_3 - a_4,
    "C1": lambda a_1, a_2, a_3, a_4: a_1 - a_2 - a_3 + a_4,
    "C2": lambda a_1, a_2, a_3, a_4: a_1 + a_2 - a_3 + a_4,
    "D1": lambda a_1, a_2, a_3, a_4: a_1 + a_2 + a_3 + a_4,
    "D2": lambda a_1, a_2, a_3, a_4: a_1 - a_2 + a_3 + a_4,
}


@pytest.mark.parametrize("change_point", ["A1", "B1", "C1", None])
def test_factors_are_those_of_the_paper_to_the_last_bit(change_point):
    rng = np.random.default_rng(12)
    for _ in range(50):
        lengths = rng.uniform(0.25, 2.0, 4)
        if change_point is not None:  # lengths whose factor is a few roundings, or none
            sign = {"A1": (1, -1, 1), "B1": (1, 1, -1), "C1": (-1, 1, 1)}[change_point]
            last = float(np.dot(sign, lengths[:3]))
            lengths[3] = abs(last) * (1.0 + rng.integers(-3, 4) * 2.0**-52) or 1.0
        values = dict(zip(("a1", "a2", "a3", "a4"), map(float, lengths), strict=True))
        names = [f"factor_{name}{low}" for name in FACTORS for low in ("", "_low")]
        found = read_facts(PLANAR, [*names, "s1"], values)
        unit = Fraction(values["a1"]) / Fraction(found["s1"])
        for name, factor in FACTORS.items():
            exact = factor(*map(Fraction, values.values())) / unit
            high, low = found[f"factor_{name}"], found[f"factor_{name}_low"]
            # Lengths of 2^-60 to 2 are multiples of 2^-112, and all errors of the sum are so, of 2^-51 at most: each
            # sum of errors has no more than 61 bits, of which all but the last stand in one double, and two hold all.
            assert Fraction(high) + Fraction(low) == exact
            assert high == float(exact)

"""Changes by tolerances, to first order: of a value, from its derivatives by the inputs that have tolerances.

An input X is known within ``X_tolerance``, or within ``X_relative_tolerance`` times itself. At the worst all of them
change a value in one direction: by the sum of all |dNAME/dX| T_X. Where errors of the inputs are independent, their
standard deviations add as squares: the root of the sum of the squares of these terms.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from fastlink.facts.fact import Fact, Input
from fastlink.facts.names import Change, Quantity
from fastlink.numerics.vectors import magnitude
from fastlink.symbolic.derivative import in_a_sentence
from fastlink.symbolic.expression import ExpressionGraph, Node
from fastlink.symbolic.generate import generate_function

__all__ = [
    *("TOLERANCES", "Term", "change_fact", "is_tolerance", "tolerance_fact", "tolerance_inputs"),
    *("terms", "tolerance_name", "toleranced", "with_change_labels", "worded"),
]

#: The variant that designs with tolerances select.
TOLERANCES = "tolerances"
ABSOLUTE, RELATIVE = "_tolerance", "_relative_tolerance"
#: What tells the change that an input may have from the tolerance that is given.
OWN = "__tolerance"
WORDS = {
    "worst": "Worst-case change by the tolerances of the inputs of: ",
    "rss": "Root sum of squares of the changes by the tolerances of the inputs of: ",
}
SOURCE = "docs/design_search.md#tolerances"


@dataclass(frozen=True)
class Term:
    """The input of one term of a change, and the fact of its tolerance."""

    by: str
    tolerance: str


def tolerance_name(name: str, relative: bool = False) -> str:
    """Return the name of the tolerance of an input.

    Examples
    --------
    >>> tolerance_name("a1"), tolerance_name("a1", relative=True)
    ('a1_tolerance', 'a1_relative_tolerance')
    """
    return f"{name}{RELATIVE if relative else ABSOLUTE}"


def is_tolerance(name: str) -> bool:
    """Tell whether a name has the form of a tolerance."""
    return name.endswith(ABSOLUTE)


def toleranced(name: str) -> str:
    """Return the input in the name of a tolerance."""
    return name.removesuffix(RELATIVE if name.endswith(RELATIVE) else ABSOLUTE)


def tolerance_inputs(inputs: Iterable[Input]) -> dict[str, Input]:
    """Return the tolerances of inputs, which are inputs themselves; codes have none."""
    found = {}
    for of in inputs:
        if of.choices:
            continue
        own, share = tolerance_name(of.name), tolerance_name(of.name, relative=True)
        meaning = in_a_sentence(of.meaning)
        found[own] = Input(own, of.units, f"T_{of.symbol}", f"Tolerance of {meaning}", "non-negative")
        label = f"T_{of.symbol}/{of.symbol}", f"Tolerance of {meaning}, over its value"
        found[share] = Input(share, "1", *label, "non-negative")
    return found


def tolerance_fact(name: str, given: Iterable[str]) -> Fact | None:
    """Return the fact of the change that an input may have, None for the name of another."""
    of = name.removesuffix(OWN)
    if of == name:
        return None
    own, share = tolerance_name(of), tolerance_name(of, relative=True)
    labels: dict[str, Any] = {
        "units": "1",
        "symbol": f"T_{of}",
        "meaning": f"Tolerance of {of}",
        "source": SOURCE,
    }
    if share in given:
        return Fact(name, of_relative, (of, share), internal=True, **labels)
    return Fact(name, of_absolute, (own,), internal=True, **labels)


def of_absolute(tolerance: Any) -> Any:
    """Tolerance as it is given."""
    return tolerance


def of_relative(value: Any, share: Any) -> Any:
    """Tolerance as a share of the value."""
    return abs(value) * share


def terms(inputs: Iterable[str]) -> tuple[Term, ...]:
    """Return the terms of inputs."""
    return tuple(Term(by, f"{by}{OWN}") for by in inputs)


def worded(how: str, meaning: str) -> str:
    """Return the meaning of a change."""
    return WORDS[how] + in_a_sentence(meaning)


def with_change_labels(fact: Fact, how: str) -> Fact:
    """Return a fact with the labels of its change, with its own function still."""
    return replace(
        fact,
        name=str(Change(Quantity(fact.name), how)),
        low=None,
        symbol=f"{how} change {fact.symbol}",
        meaning=worded(how, fact.meaning),
        source=f"{fact.source}; {SOURCE}",
        flags={},
    )


def change_fact(labelled: Fact, how: str, derivatives: Sequence[tuple[str, str]]) -> Fact:
    """Return a change, which is labelled already, from derivatives, each with the fact of the tolerance."""
    graph = ExpressionGraph((magnitude,))
    found: Node | None = None
    for derivative, tolerance in derivatives:
        change = graph.mul(graph.call(abs, graph.name(derivative)), graph.name(tolerance))
        if found is None:
            found = change
        else:
            found = graph.add(found, change) if how == "worst" else graph.call(magnitude, found, change)
    assert found is not None
    function, depends_on = generate_function(labelled.name, graph, found, {})
    return replace(labelled, function=function, depends_on=depends_on)

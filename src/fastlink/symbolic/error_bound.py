"""Error bounds of facts: NAME_error, and NAME_trust, which tells where the bound is small against the value.

The text of a bound is written from that of the fact (`fastlink.symbolic.error_propagation`), fact by fact: it depends
on the bounds of those facts on which the fact depends, unless their relative error is a number known beforehand. It
is a `Fact` like any other: kernels paste it, and it runs on floats and arrays.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from fastlink.errors import InputError, Setting
from fastlink.facts.fact import Fact, Input, System
from fastlink.facts.names import Quantity, Trust, error_name
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.numerics.elementary import INFINITY, select
from fastlink.symbolic.bound import Bound, Lost
from fastlink.symbolic.derivative import in_a_sentence
from fastlink.symbolic.error_laws import of_small_angle
from fastlink.symbolic.error_propagation import Rules, bounded_parts
from fastlink.symbolic.expression import Node, is_power_of_two
from fastlink.symbolic.generate import generate_function
from fastlink.symbolic.postorder import postorder

__all__ = ["ErrorBounds", "trust_fact", "with_error_labels"]

#: Relative error bounds up to this one are trusted.
TRUSTED = 1e-6
#: Roundings of the two fractions of the graded range at an exact x, rest = 1/(1 + x x) and (x x) rest: at most one
#: each of x x, of the sum, of the quotient and of the product.
FRACTION = 4.0
TRUST_FLAGS = {0: "trusted", 1: "ill_conditioned", 2: "not_finite"}
NUMERICS = "docs/numerics.md#error-bounds"


def with_error_labels(fact: Fact) -> Fact:
    """Return a fact with the labels of its error bound, with its own function still."""
    return replace(
        fact,
        name=error_name(fact.name),
        low=None,
        symbol=f"err {fact.symbol}",
        meaning=f"Error bound of {in_a_sentence(fact.meaning)}",
        source=f"{fact.source}; {NUMERICS}",
        flags={},
    )


def trust_fact(fact: Fact) -> Fact:
    """Return the fact that tells whether an error bound is small against the value."""
    return replace(
        fact,
        name=str(Trust(Quantity(fact.name))),
        function=trust,
        depends_on=(fact.name, error_name(fact.name)),
        units="1",
        symbol=f"trust {fact.symbol}",
        meaning=f"Whether digits of {in_a_sentence(fact.meaning)} are known",
        source=f"{fact.source}; {NUMERICS}",
        flags=TRUST_FLAGS,
    )


def trust(value: Any, error: Any) -> Any:
    """Return 0 where the bound is at most a millionth of the value, else 1; 2 for NaN."""
    size = abs(value)
    return select(size < INFINITY, select(error <= TRUSTED * size, 0.0, 1.0), 2.0)


class ErrorBounds:
    """The error bounds of a mechanism's facts; given values have none.

    Parameters
    ----------
    find : callable
        Returns the fact or system that determines a name, None for a given value.
    inputs : mapping of str to Input
        The inputs that may be given.
    branches : mapping of int to str
        The assembly modes.
    tables, low_parts : mapping
        The tables of the input position, and the table of which each low part is one.
    fractions : sequence of str
        The coordinates in the graded range that kernels compute from an exact position there.
    is_quantity : callable
        Tells whether users may request a name: its bound is never NaN where the value is a number.
    angle_of : callable
        Returns the input position if that is an angle with which a name changes, else None.
    """

    def __init__(
        self,
        find: Callable[[str], Fact | System | None],
        inputs: Mapping[str, Input],
        branches: Mapping[int, str],
        tables: Mapping[str, Fact],
        low_parts: Mapping[str, str],
        fractions: Sequence[str] = (),
        *,
        is_quantity: Callable[[str], bool],
        angle_of: Callable[[str], str | None],
    ) -> None:
        self.is_quantity, self.angle_of = is_quantity, angle_of
        self.find, self.inputs, self.branches = find, inputs, branches
        self.tables, self.low_parts, self.fractions = tables, low_parts, fractions
        self.rules = Rules(self.named)
        self.graph, self.exact = self.rules.graph, self.rules.exact
        self._named: dict[str, Bound] = {}
        self._values: dict[str, Node] = {}
        self._facts: dict[str, Fact] = {}

    def fact(self, name: str) -> Fact:
        """Return the error bound of a fact.

        Raises
        ------
        InputError
            A linear system determines the fact, or one of its dependencies.
        """
        if name not in self._facts:
            fact = self.bounded_fact(name)
            root, own = self._expression(name)
            function, depends_on = generate_function(error_name(name), self.graph, root, own)
            self._facts[name] = replace(with_error_labels(fact), function=function, depends_on=depends_on)
        return self._facts[name]

    def bounded_fact(self, name: str) -> Fact:
        """Return the fact of a name; values of a linear system have no bound."""
        fact = self.find(name)
        if isinstance(fact, System):
            what = f"quantity {error_name(name)!r}: a linear system determines {name}"
            raise InputError(what, remedy=("write ", Setting("solver", "eliminated")))
        if fact is None:
            what = f"quantity {error_name(name)!r}: {name} is given, which has no error"
            raise InputError(what, remedy="leave it out")
        return fact

    def _value(self, name: str) -> Node:
        if name not in self._values:
            self._values[name] = self.graph.read_fact(self.bounded_fact(name), name)
        return self._values[name]

    def _expression(self, name: str) -> tuple[Node, dict[Node, str]]:
        """Return the expression of a bound, and the fact's value as a name."""
        value = self._value(name)
        bound = self.rules.bound(value)
        if not self._pair(name, bound):
            bound = self.rules.settled(value, bound)
        if bound.gap or (bound.rest is not self.graph.zero and self.is_quantity(name)):
            error = self._or_infinite(value, self.rules.error(value, bound))
        else:  # at least a trace of the value: where it is not finite, so is its error
            error = self.rules.error(value, replace(bound, relative=max(bound.relative, UNIT_ROUNDING)))
        angle = self.angle_of(name) if self.is_quantity(name) else None
        if angle is not None:
            error = self.graph.read(of_small_angle, [self.graph.name(angle), error])
        return error, {} if value.kind in ("name", "number", "neg") else {value: name}

    def _or_infinite(self, value: Node, error: Node) -> Node:
        """Return an error, infinite where an infinite one meets 0 on the way; |value| where that is not finite."""
        graph, infinite = self.graph, self.graph.number(INFINITY)
        size = graph.call(abs, value)
        known = graph.select(graph.node("<=", error, infinite), error, infinite)
        return graph.select(graph.node("<", size, infinite), known, size)

    # -- names ---------------------------------------------------------------------------------------------------

    def named(self, name: str) -> Bound:
        """Return the error bound of a name as an expression in other names."""
        for each in postorder([name], self._parts, self._named):
            self._named[each] = self._of_name(each)
        return self._named[name]

    def _parts(self, name: str) -> Iterator[str]:
        """Yield the names whose bounds determine the bound of a name."""
        if name in self.low_parts or self.find(name) is None:
            return
        visited: dict[Node, None] = {}
        for node in postorder([self._value(name)], bounded_parts, visited):
            visited[node] = None
            if node.kind == "name":
                yield node.value

    def _of_name(self, name: str) -> Bound:
        graph = self.graph
        if name in self.low_parts:
            return replace(self.exact, lost={graph.name(name): (1.0, graph.name(self.low_parts[name]))})
        if name in self.fractions:
            return replace(self.exact, relative=FRACTION, positive=True)
        if self.find(name) is None:  # no fact of a variant gives a table otherwise
            if name in self.tables:
                return self._of_table(name)
            positive = name in self.inputs and self.inputs[name].rule != "any"
            return replace(self.exact, positive=positive)
        fact = self.bounded_fact(name)
        if fact.depends_on == ("branch",):
            values = [fact.function(float(number)) for number in self.branches]
            if all(map(is_power_of_two, values)):
                return replace(
                    self.exact, scale=True, one={*map(abs, values)} == {1.0}, positive=min(values) > 0.0
                )
        value = self._value(name)
        bound = self.rules.bound(value)
        lost = self._pair(name, bound)
        bound = replace(bound if lost else self.rules.settled(value, bound), lost=lost)
        if bound.rest is graph.zero:
            return bound
        return replace(bound, relative=0.0, rest=graph.name(error_name(name)))

    def _of_table(self, name: str) -> Bound:
        """Return the bound of a table: exact, or rounded once, perhaps with a low part."""
        table, graph = self.tables[name], self.graph
        given = [graph.node("given", value=part) for part in table.depends_on]
        bound = self.rules.bound(graph.read(table.function, given))
        if bound.relative == 0.0:
            return bound
        low = next((low for low, high in self.low_parts.items() if high == name), None)
        if low is None:
            return replace(self.exact, relative=1.0, positive=bound.positive)
        lost = {graph.name(low): (-1.0, graph.name(name))}
        return replace(self.exact, relative=UNIT_ROUNDING, lost=lost, positive=bound.positive)

    def _pair(self, name: str, bound: Bound) -> Lost:
        """Return what a fact with a low part loses, if both words lose the same."""
        fact, graph = self.bounded_fact(name), self.graph
        if fact.low is None or len(bound.lost) != 1:
            return {}
        low = self._value(fact.low)
        of_both = [word for word in fact.names if low in self.rules.bound(self._value(word)).lost]
        if name not in of_both or fact.name not in of_both:
            return {}
        return {graph.name(fact.low): (1.0 if name == fact.low else -1.0, graph.name(fact.name))}

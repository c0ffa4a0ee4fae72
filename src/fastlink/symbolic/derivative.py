"""Differentiate facts by forward mode, from text to text.

A fact is straight-line text, so its derivative is too: each operation has one rule. What is structurally zero is
left out, numbers are folded (`fastlink.symbolic.expression`). The result is a `Fact` like any other: kernels
paste it, and it runs on floats, arrays and mpmath numbers.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from fastlink.errors import InputError, Setting
from fastlink.facts.fact import Fact, Input, System
from fastlink.facts.names import derivative_name
from fastlink.numerics import compensated, vectors
from fastlink.numerics.elementary import NOT_A_NUMBER, atan2, cosine, sine, sqrt
from fastlink.numerics.logarithm import log, log1p, log_quotient
from fastlink.symbolic.choices import SLOPES
from fastlink.symbolic.existence import Existence
from fastlink.symbolic.expression import ExpressionGraph, Node, is_power_of_two
from fastlink.symbolic.generate import generate_function
from fastlink.symbolic.postorder import postorder

__all__ = [
    "Derivation",
    "NoDependence",
    "NoDerivative",
    "in_a_sentence",
    "units_per",
    "with_derivative_labels",
]


class NoDerivative(InputError):
    """The requested derivative is zero everywhere, or not offered."""


class NoDependence(NoDerivative):
    """The requested derivative is zero everywhere."""


def with_derivative_labels(fact: Fact, by: Input) -> Fact:
    """Return a fact with the labels of its derivative, with its own function still."""
    return replace(
        fact,
        name=derivative_name(fact.name, by.name),
        units=units_per(fact.units, by.units),
        low=None,
        symbol=f"d {fact.symbol}/d {by.symbol}",
        meaning=f"Derivative of {in_a_sentence(fact.meaning)} with respect to {by.meaning}",
        source=f"{fact.source}; docs/numerics.md#derivatives",
    )


def in_a_sentence(meaning: str) -> str:
    """Return the meaning of a quantity for use within a sentence.

    Examples
    --------
    >>> in_a_sentence("Moving pivot B, x"), in_a_sentence("AB over its length")
    ('moving pivot B, x', 'AB over its length')
    """
    return meaning if meaning[1:2].isupper() else meaning[:1].lower() + meaning[1:]


def units_per(units: str, by: str) -> str:
    """Return UDUNITS text of a quotient.

    Examples
    --------
    >>> units_per("rad s-1", "m"), units_per("N m", "m"), units_per("1", "kg m2"), units_per("rad", "rad")
    ('rad s-1 m-1', 'N', 'kg-1 m-2', '1')
    """
    powers: dict[str, int] = {}
    for text, sign in ((units, 1), (by, -1)):
        for unit, power in re.findall(r"([A-Za-z]+)(-?\d*)", text):
            powers[unit] = powers.get(unit, 0) + sign * int(power or 1)
    parts = [f"{unit}{power if power != 1 else ''}" for unit, power in powers.items() if power]
    return " ".join(parts) or "1"


# -- rules -------------------------------------------------------------------------------------------------

Rule = Callable[[ExpressionGraph, Sequence[Node], Sequence[Node], Node], Node]


def _of_sum(graph: ExpressionGraph, args: Sequence[Node], slopes: Sequence[Node], value: Node) -> Node:
    total = graph.zero
    for slope in slopes:
        total = graph.add(total, slope)
    return total


def _of_product(graph: ExpressionGraph, args: Sequence[Node], slopes: Sequence[Node], value: Node) -> Node:
    (a, *_, b), (da, *_, db) = args, slopes
    return graph.add(graph.mul(da, b), graph.mul(a, db))


def _of_pair_product(
    graph: ExpressionGraph, args: Sequence[Node], slopes: Sequence[Node], value: Node
) -> Node:
    return _of_product(graph, (args[0], args[2]), (slopes[0], slopes[2]), value)


def _of_pair_quotient(
    graph: ExpressionGraph, args: Sequence[Node], slopes: Sequence[Node], value: Node
) -> Node:
    return graph.div(graph.sub(slopes[0], graph.mul(value, slopes[2])), args[2])


def _of_gap_product_quotient(
    graph: ExpressionGraph, args: Sequence[Node], slopes: Sequence[Node], value: Node
) -> Node:
    x, y = args[4:]
    product = _of_pair_product(graph, args, slopes, value)
    share = graph.div(graph.mul(graph.number(0.25), product), graph.mul(x, y))
    relative = graph.add(graph.div(slopes[4], x), graph.div(slopes[5], y))
    return graph.sub(share, graph.mul(value, relative))


#: Functions with a rule of their own; the text of others is read. The derivative of (high, low) is that of high.
RULES: dict[Any, Rule] = {
    compensated.two_sum: _of_sum,
    compensated.sum_of_four: _of_sum,
    compensated.two_product: _of_product,
    compensated.pair_product: _of_pair_product,
    compensated.pair_quotient: _of_pair_quotient,
    compensated.gap_product_quotient: _of_gap_product_quotient,
    compensated.power_of_two_below: lambda graph, args, slopes, value: graph.zero,
    vectors.zero_where: lambda graph, args, slopes, value: slopes[1],
    **SLOPES,
}


class Derivation:
    """The derivatives of a mechanism's facts with respect to one variable.

    Parameters
    ----------
    by : Input
        The variable.
    find : callable
        Returns the fact or system that determines a name, None for a given value.
    declared : callable
        Returns the derivative of a name where one is declared, else None.
    moving : bool
        Whether places move with their range, which the names of the derivatives say.
    guards : callable
        As of `Existence`.
    """

    def __init__(
        self,
        by: Input,
        find: Callable[[str], Fact | System | None],
        declared: Callable[[str], Fact | None],
        moving: bool = False,
        guards: Callable[[str], bool] = lambda name: False,
    ) -> None:
        self.by, self.find, self.declared, self.moving = by, find, declared, moving
        self.graph = ExpressionGraph(RULES)
        self._values: dict[str, tuple[Node, Node]] = {}
        self._slopes: dict[str, Node] = {}
        self._facts: dict[str, Fact] = {}
        self._originals: dict[str, str] = {}
        self._existence = Existence(self.graph, self._expression, guards)

    def fact(self, name: str) -> Fact:
        """Return the derivative of a fact.

        Raises
        ------
        NoDerivative
            The fact does not depend on the input, or a linear system determines it.
        """
        if name not in self._facts:
            self._facts[name] = self._fact(name, derivative_name(name, self.by.name, self.moving))
        return self._facts[name]

    def _fact(self, name: str, derivative: str) -> Fact:
        if self.slope(name) is self.graph.zero:
            what = f"quantity {derivative!r}: {name} does not depend on {self.by.name} with what is given"
            raise NoDependence(what, remedy="leave it out")
        declared, step = self.declared(name), self.find(name)
        if declared is None:
            assert isinstance(step, Fact)
            root, value = self._values[name]
            return self._written(step, self._existence.guarded(name, root, value), value)
        labelled, root = replace(declared, name=derivative), self.graph.read_fact(declared, declared.name)
        value = self.graph.read_fact(step, name) if isinstance(step, Fact) else root
        guarded = self._existence.guarded(name, root, value)
        if guarded is root:
            return labelled
        function, depends_on = generate_function(derivative, self.graph, guarded, {})
        return replace(labelled, function=function, depends_on=depends_on, flags={})

    def slope(self, name: str) -> Node:
        """Return the derivative of a name as a number, a name, or minus a name."""
        for each in postorder([name], self._parts, self._slopes):
            self._slopes[each] = self._slope(each)
        return self._slopes[name]

    def _parts(self, name: str) -> tuple[str, ...]:
        """Return the names whose derivatives determine the derivative of a name."""
        step = None if name == self.by.name or self.declared(name) is not None else self.find(name)
        return () if step is None or (isinstance(step, Fact) and name == step.low) else step.depends_on

    def _slope(self, name: str) -> Node:
        graph = self.graph
        if name == self.by.name:
            return graph.one
        step, declared = self.find(name), self.declared(name)
        if declared is not None:
            root = graph.read_fact(declared, declared.name)
        elif step is None or (isinstance(step, Fact) and name == step.low):
            return graph.zero  # given, or a rounding error
        elif all(self._slopes[part] is graph.zero for part in step.depends_on):
            return graph.zero
        elif isinstance(step, System):
            what = f"quantity {derivative_name(name, self.by.name)!r}: a linear system determines {name}"
            raise NoDerivative(what, remedy=("write ", Setting("solver", "eliminated")))
        else:
            value = graph.read_fact(step, name)
            root = self._differentiate(value)
            self._values[name] = root, value
        bare = root.args[0] if root.kind == "neg" else root
        if bare.kind in ("name", "number"):
            return root
        derivative = derivative_name(name, self.by.name, self.moving)
        self._originals[derivative] = name
        return graph.name(derivative)

    def _expression(self, name: str) -> Node | None:
        """Return the expression that a name stands for, None for what is given."""
        original = self._originals.get(name)
        if original in self._values:
            return self._values[original][0]
        step = self.find(name) if original is None else self.declared(original)
        if not isinstance(step, Fact):
            return None
        return self.graph.read_fact(step, name if original is None else step.name)

    def _differentiate(self, root: Node) -> Node:
        """Return the derivative of a value."""
        slopes: dict[Node, Node] = {}
        for node in postorder([root], lambda node: node.args, slopes):
            slopes[node] = self._rule(node, [slopes[arg] for arg in node.args])
        return slopes[root]

    def _rule(self, node: Node, slopes: Sequence[Node]) -> Node:
        if node.kind == "name":
            return self._slopes[node.value]
        graph, args = self.graph, node.args
        if all(slope is graph.zero for slope in slopes):
            return graph.zero
        match node.kind:
            case "neg":
                return graph.neg(slopes[0])
            case "+":
                return graph.add(*slopes)
            case "-":
                return graph.sub(*slopes)
            case "*":
                return self._of_power(node, slopes) or _of_product(graph, args, slopes, node)
            case "/":
                return self._of_quotient(node, slopes)
            case "item":
                # the slope of a call is that of its first result
                return slopes[0] if node.value == 0 else graph.zero
            case "call":
                return self._of_call(node, slopes)
        return graph.zero  # comparisons: the selected values are differentiated in `select`

    def _of_power(self, node: Node, slopes: Sequence[Node]) -> Node | None:
        """Return the derivative of x x or x x x, None of another product."""
        graph, (a, b) = self.graph, node.args
        if a is b:
            return graph.mul(graph.mul(graph.number(2.0), a), slopes[0])
        if a.kind == "*" and a.args[0] is b and a.args[1] is b:
            return graph.mul(graph.mul(graph.number(3.0), a), slopes[1])
        return None

    def _of_quotient(self, node: Node, slopes: Sequence[Node]) -> Node:
        graph, (a, b), (da, db) = self.graph, node.args, slopes
        if db is graph.zero:
            return graph.div(da, b)
        if a.kind == "number" and is_power_of_two(a.value):
            square = graph.mul(graph.number(1.0 / a.value), graph.mul(node, node))
            return graph.neg(graph.mul(square, db))
        return graph.div(graph.sub(da, graph.mul(node, db)), b)

    def _of_call(self, node: Node, slopes: Sequence[Node]) -> Node:
        graph, function, args = self.graph, node.value, node.args
        if function in RULES:
            first = graph.node("item", node, value=0)
            return RULES[function](graph, args, slopes, first)
        if function is sqrt:
            return graph.div(graph.mul(graph.number(0.5), slopes[0]), node)
        if function is sine:
            return graph.mul(graph.call(cosine, *args), slopes[0])
        if function is cosine:
            return graph.neg(graph.mul(graph.call(sine, *args), slopes[0]))
        if function is log:
            return graph.div(slopes[0], args[0])
        if function is log_quotient:
            return graph.sub(graph.div(slopes[0], args[0]), graph.div(slopes[1], args[1]))
        if function is log1p:
            return graph.div(slopes[0], graph.add(graph.one, args[0]))
        if function is atan2:
            return graph.call(vectors.turn_rate, *args, *slopes)
        if function is abs:
            negative = graph.node("<", args[0], graph.zero)
            return graph.select(negative, graph.neg(slopes[0]), slopes[0])
        condition, *values = args
        # Where the value is no number, neither is the derivative; what is infinite is NaN.
        parts = [
            graph.number(NOT_A_NUMBER) if x.kind == "number" and x.value - x.value != 0.0 else d
            for x, d in zip(values, slopes[1:], strict=True)
        ]
        return graph.select(condition, *parts)

    def _written(self, step: Fact, root: Node, value: Node) -> Fact:
        own = {} if value.kind in ("name", "number", "neg") else {value: step.name}
        name = derivative_name(step.name, self.by.name, self.moving)
        function, depends_on = generate_function(name, self.graph, root, own)
        labelled = with_derivative_labels(step, self.by)
        return replace(labelled, name=name, function=function, depends_on=depends_on, flags={})

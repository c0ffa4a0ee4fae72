"""Derivatives of facts, from text to text; whether values are numbers; changes by tolerances."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from fastlink.errors import InputError, Setting
from fastlink.facts.expression import (
    Algebra,
    ExpressionGraph,
    Node,
    generate_formula,
    is_power_of_two,
)
from fastlink.facts.fact import Fact, Input, System
from fastlink.facts.formula import Formula, parameters
from fastlink.facts.names import (
    Change,
    Derivative,
    ErrorBound,
    Made,
    Quantity,
    derivative_name,
    error_name,
    signed,
)
from fastlink.numerics import compensated, vectors
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, atan2, cosine, select, sine, sqrt
from fastlink.numerics.logarithm import log, log1p, log_quotient
from fastlink.numerics.vectors import magnitude

# -- Tell from the text of facts on what it depends whether a value is a number

# A configuration that does not exist shows in a root of a negative number, a quotient by zero, or a choice
# that says so. What does not depend on it has a value all the same.


#: Functions that have no value for some numbers.
PARTIAL = (sqrt, log, log1p, log_quotient)


def _cause(node: Node) -> Node | None:
    """Return by what an operation may have no value: itself, or what it divides by; None if it always has one."""
    if node.kind == "/":
        return None if node.args[1].kind == "number" else node.args[1]
    if node.kind != "call":
        return None
    chosen = node.args[1:] if node.value is select else ()
    endless = any(part.kind == "number" and part.value - part.value != 0.0 for part in chosen)
    return node if endless or node.value in PARTIAL else None


# -- Differentiate facts by forward mode, from text to text

# A fact is straight-line text, so its derivative is too: each operation has one rule. What is structurally
# zero is left out, numbers are folded (`fastlink.facts.expression`). The result is a `Fact` like any
# other: kernels paste it, and it runs on floats, arrays and mpmath numbers.


class NoDerivative(InputError):
    """The requested derivative is zero everywhere, or not offered."""


class NoDependence(NoDerivative):
    """The requested derivative is zero everywhere."""


def in_a_sentence(meaning: str) -> str:
    """Return the meaning of a quantity for use within a sentence."""
    return meaning if meaning[1:2].isupper() else meaning[:1].lower() + meaning[1:]


def units_per(units: str, by: str) -> str:
    """Return UDUNITS text of a quotient."""
    powers: dict[str, int] = {}
    for text, sign in ((units, 1), (by, -1)):
        for unit, power in re.findall(r"([A-Za-z]+)(-?\d*)", text):
            powers[unit] = powers.get(unit, 0) + sign * int(power or 1)
    parts = [f"{unit}{power if power != 1 else ''}" for unit, power in powers.items() if power]
    return " ".join(parts) or "1"


#: Relative error bounds up to this one are trusted.
TRUSTED = 1e-6


def trust(value: Any, error: Any) -> Any:
    """Return 0 where the bound is at most a millionth of the value, else 1; 2 for NaN."""
    size = abs(value)
    return select(size < INFINITY, select(error <= TRUSTED * size, 0.0, 1.0), 2.0)


def labelled(fact: Fact, tree: Made, variables: Mapping[str, Input]) -> Fact:
    """Return a fact with the labels of what is made of it, with its own formula still unless that is a trust."""
    name, symbol, said = fact.name, fact.symbol, in_a_sentence(fact.title)
    more: dict[str, Any] = {}
    match tree:
        case Derivative(by=by):
            symbol = f"d {symbol}/d {variables[by].symbol}"
            meaning = f"Derivative of {said} with respect to {variables[by].title}"
            source = "numerics.md#derivatives"
            more["units"] = units_per(fact.units, variables[by].units)
        case Change(how=how):
            symbol, meaning, source = f"{how} change {symbol}", worded(how, fact.title), TOLERANCED
        case ErrorBound():
            symbol, meaning, source = f"err {symbol}", f"Error bound of {said}", "numerics.md#error-bounds"
        case _:
            symbol, meaning = f"trust {symbol}", f"Whether digits of {said} are known"
            source = "numerics.md#error-bounds"
            more = {"formula": Formula.of(trust), "depends_on": (name, error_name(name)), "units": "1"}
            more["flags"] = {0: "trusted", 1: "ill_conditioned", 2: "not_finite"}
    labels = {"symbol": symbol, "meaning": meaning, "source": f"{fact.source}; docs/{source}"}
    return replace(fact, **{"name": str(tree), "low": None, "flags": {}} | labels | more)


# -- rules -------------------------------------------------------------------------------------------------

#: Derivatives of calls in terms of their arguments x, the derivatives d_x of these, and the `value`, of a pair its
#: high part, whose derivative that of (high, low) is. The text of functions without a rule is read.
DERIVATIVES: dict[Callable[..., Any], str] = {
    compensated.two_sum: "d_a + d_b",
    compensated.sum_of_four: "d_a + d_b + d_c + d_d",
    compensated.two_product: "d_a * b + a * d_b",
    compensated.pair_product: "d_a * b + a * d_b",
    compensated.pair_quotient: "(d_a - value * d_b) / b",
    compensated.gap_product_quotient: ("0.25 * (d_f * g + f * d_g) / (x * y) - value * (d_x / x + d_y / y)"),
    compensated.power_of_two_below: "0.0",
    vectors.zero_where: "d_x",
    # choices that rounding may make: choices of the same kind
    vectors.choice: "choice(condition, d_if_true, d_if_false)",
    vectors.absolute: "choice(x < 0.0, -d_x, d_x)",
    sqrt: "0.5 * d_x / value",
    sine: "cosine(x) * d_x",
    cosine: "-(sine(x) * d_x)",
    log: "d_x / x",
    log_quotient: "d_x / x - d_y / y",
    log1p: "d_x / (1.0 + x)",
}


def _rule(function: Callable[..., Any], text: str) -> Formula:
    """Return the derivative of a call as a formula."""
    names = parameters(inspect.unwrap(function))
    return Formula(function.__name__, [*names, *(f"d_{name}" for name in names), "value"], [f"return {text}"])


RULES = {function: _rule(function, text) for function, text in DERIVATIVES.items()}
#: Functions that return a pair.
PAIRS = {getattr(compensated, name) for name in compensated.__all__} - {compensated.power_of_two_below}


class _Causes(Algebra[frozenset[Node]]):
    """The operations beneath values, those of the names in them too, by which they may be no number."""

    def __init__(self, expression: Callable[[str], Node | None]) -> None:
        super().__init__()
        self._expression = expression

    def parts(self, node: Node) -> tuple[Node, ...]:
        """Return the parts of a value, of a name the expression that it stands for."""
        expression = self._expression(node.value) if node.kind == "name" else None
        return node.args if expression is None else (expression,)

    def rule(self, node: Node, parts: Sequence[frozenset[Node]]) -> frozenset[Node]:
        """Return the operation itself, if it is one of these, and those of its parts."""
        return frozenset(filter(None, [_cause(node)])).union(*parts)


class Derivation(Algebra[Node]):
    """The derivatives of a mechanism's facts with respect to one variable."""

    def __init__(
        self,
        by: Input,
        find: Callable[[str], Fact | System | None],
        declared: Callable[[str], Fact | None],
        moving: bool = False,
        guards: Callable[[str], bool] = lambda name: False,
    ) -> None:
        super().__init__()
        self.by, self.find, self.declared, self.moving = by, find, declared, moving
        self.graph = ExpressionGraph(RULES)
        self._values: dict[str, tuple[Node, Node]] = {}
        self._facts: dict[str, Fact] = {}
        self._originals: dict[str, str] = {}
        self._guards = guards
        self._causes = _Causes(self._expression)

    def fact(self, name: str) -> Fact:
        """Return the derivative of a fact."""
        if name not in self._facts:
            self._facts[name] = self._fact(name, derivative_name(name, self.by.name, self.moving))
        return self._facts[name]

    def _fact(self, name: str, derivative: str) -> Fact:
        if self.slope(name) is self.graph.zero:
            of, by = signed(name), self.by.name
            what = f"quantity {derivative_name(of, by)!r}: {of} does not depend on {by} with what is given"
            if by.startswith("arc_"):  # extremes over an arc depend on its ends
                raise NoDerivative(f"{by}: there is no derivative by an end of an arc", remedy="leave it out")
            raise NoDependence(what, remedy="leave it out")
        declared, step = self.declared(name), self.find(name)
        if declared is None:
            assert isinstance(step, Fact)
            root, value = self._values[name]
            return self._written(step, self._guarded(name, root, value), value)
        labels, root = replace(declared, name=derivative), self.graph.read_fact(declared, declared.name)
        value = self.graph.read_fact(step, name) if isinstance(step, Fact) else root
        guarded = self._guarded(name, root, value)
        if guarded is root:
            return labels
        formula = generate_formula(derivative, self.graph, guarded, {})
        return replace(labels, formula=formula, depends_on=formula.parameters, flags={})

    def _guarded(self, name: str, root: Node, value: Node) -> Node:
        """Return a derivative that is none where the name is no finite number."""
        # a force is none where the linkage does not assemble, but its derivative by a mass, an acceleration, may exist
        if not self._guards(name) or not self._causes.of(value) - self._causes.of(root):
            return root
        graph = self.graph
        exists = graph.node("<", graph.call(abs, graph.name(name)), graph.number(INFINITY))
        return graph.select(exists, root, graph.number(NOT_A_NUMBER))

    def slope(self, name: str) -> Node:
        """Return the derivative of a name as a number, a name, or minus a name."""
        return self.of(self.graph.name(name))

    def parts(self, node: Node) -> tuple[Node, ...]:
        """Return the values whose derivatives determine that of a value; of a name those that its fact depends on."""
        if node.kind != "name":
            return node.args
        known = node.value == self.by.name or self.declared(node.value) is not None
        step = None if known else self.find(node.value)
        is_low = isinstance(step, Fact) and node.value == step.low
        return () if step is None or is_low else tuple(map(self.graph.name, step.depends_on))

    def _of_name(self, node: Node, *slopes: Node) -> Node:
        name, graph = node.value, self.graph
        if name == self.by.name:
            return graph.one
        step, declared = self.find(name), self.declared(name)
        if declared is not None:
            root = graph.read_fact(declared, declared.name)
        elif step is None or (isinstance(step, Fact) and name == step.low):
            return graph.zero  # given, or a rounding error
        elif all(slope is graph.zero for slope in slopes):
            return graph.zero
        elif isinstance(step, System):
            what = f"quantity {derivative_name(name, self.by.name)!r}: a linear system determines {name}"
            raise NoDerivative(what, remedy=("write ", Setting("solver", "eliminated")))
        else:
            value = graph.read_fact(step, name)
            root = self.of(value)
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

    def rule(self, node: Node, slopes: Sequence[Node]) -> Node:
        """Return the derivative of a value, zero if all its parts have none."""
        if node.kind != "name" and all(slope is self.graph.zero for slope in slopes):
            return self.graph.zero
        return super().rule(node, slopes)

    def _of_negative(self, node: Node, da: Node) -> Node:
        return self.graph.neg(da)

    def _of_sum(self, node: Node, da: Node, db: Node) -> Node:
        return self.graph.operation(node.kind, da, db)

    def _of_product(self, node: Node, da: Node, db: Node) -> Node:
        graph, (a, b) = self.graph, node.args
        if a is b:
            return graph.mul(graph.mul(graph.number(2.0), a), da)
        if a.kind == "*" and a.args[0] is b and a.args[1] is b:
            return graph.mul(graph.mul(graph.number(3.0), a), db)
        return graph.add(graph.mul(da, b), graph.mul(a, db))

    def _of_quotient(self, node: Node, da: Node, db: Node) -> Node:
        graph, (a, b) = self.graph, node.args
        if db is graph.zero:
            return graph.div(da, b)
        if a.kind == "number" and is_power_of_two(a.value):
            square = graph.mul(graph.number(1.0 / a.value), graph.mul(node, node))
            return graph.neg(graph.mul(square, db))
        return graph.div(graph.sub(da, graph.mul(node, db)), b)

    def _of_item(self, node: Node, slope: Node) -> Node:  # that of a call is the one of its first result
        return slope if node.value == 0 else self.graph.zero

    def _of_other(
        self, node: Node, *slopes: Node
    ) -> Node:  # what a comparison selects is differentiated in `select`
        return self.graph.zero

    def _of_call(self, node: Node, *slopes: Node) -> Node:
        graph, function, args = self.graph, node.value, node.args
        if function is vectors.choice and slopes[1] is slopes[2]:
            return slopes[1]
        if function in RULES:
            value = graph.node("item", node, value=0) if function in PAIRS else node
            return graph.read(RULES[function], [*args, *slopes, value])
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
        formula = generate_formula(name, self.graph, root, own)
        labels = labelled(step, Derivative(Quantity(step.name), self.by.name), {self.by.name: self.by})
        return replace(labels, name=name, formula=formula, depends_on=formula.parameters)


# -- Changes by tolerances, to first order: of a value, from its derivatives by the inputs that have
#    tolerances

# An input X is known within ``X_tolerance``, or within ``X_relative_tolerance`` times itself. At the worst
# all of them change a value in one direction: by the sum of all |dNAME/dX| T_X. Where errors of the inputs
# are independent, their standard deviations add as squares: the root of the sum of the squares of these
# terms.


#: The variant that designs with tolerances select.
TOLERANCES = "tolerances"
ABSOLUTE, RELATIVE = "_tolerance", "_relative_tolerance"
#: What tells the change that an input may have from the tolerance that is given.
ALLOWED_CHANGE = "__tolerance"
WORDS = {
    "worst": "Worst-case change by the tolerances of the inputs of: ",
    "rss": "Root sum of squares of the changes by the tolerances of the inputs of: ",
}
TOLERANCED = "tolerances.md#tolerances-as-inputs"
#: Tolerances as they are given, and as shares of the value.
AS_GIVEN = Formula("tolerance", ("tolerance",), ["return tolerance"])
OF_SHARE = Formula("tolerance", ("value", "share"), ["return abs(value) * share"])


@dataclass(frozen=True)
class Term:
    """The input of one term of a change, and the fact of its tolerance."""

    by: str
    tolerance: str


def tolerance_name(name: str, relative: bool = False) -> str:
    """Return the name of the tolerance of an input."""
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
        meaning = in_a_sentence(of.title)
        found[own] = Input(own, of.units, f"T_{of.symbol}", f"Tolerance of {meaning}", "non-negative")
        label = f"T_{of.symbol}/{of.symbol}", f"Tolerance of {meaning}, over its value"
        found[share] = Input(share, "1", *label, "non-negative")
    return found


def tolerance_fact(name: str, given: Iterable[str]) -> Fact | None:
    """Return the fact of the change that an input may have, None for the name of another."""
    of = name.removesuffix(ALLOWED_CHANGE)
    if of == name:
        return None
    own, share = tolerance_name(of), tolerance_name(of, relative=True)
    formula, read = (OF_SHARE, (of, share)) if share in given else (AS_GIVEN, (own,))
    labels = "1", f"T_{of}", f"Tolerance of {of}", f"docs/{TOLERANCED}"
    return Fact(name, formula, read, *labels, internal=True)


def worded(how: str, meaning: str) -> str:
    """Return the meaning of a change."""
    return WORDS[how] + in_a_sentence(meaning)


def change_fact(labels: Fact, how: str, derivatives: Sequence[tuple[str, str]]) -> Fact:
    """Return a change, which has its labels already, from derivatives, each with the fact of the tolerance."""
    graph = ExpressionGraph((magnitude,))
    found: Node | None = None
    for derivative, tolerance in derivatives:
        change = graph.mul(graph.call(abs, graph.name(derivative)), graph.name(tolerance))
        if found is None:
            found = change
        else:
            found = graph.add(found, change) if how == "worst" else graph.call(magnitude, found, change)
    assert found is not None
    formula = generate_formula(labels.name, graph, found, {})
    return replace(labels, formula=formula, depends_on=formula.parameters)

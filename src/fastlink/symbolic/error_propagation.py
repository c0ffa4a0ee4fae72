"""Propagate error bounds through the operations of an expression, each of which adds its own rounding.

Each operation has one rule, as each has one for its derivative. The rules bound the error, not its first order only:
products and quotients of errors are in them. A bound is u `relative` |value| + `rest`, where u is UNIT_WITH_MARGIN and
`relative` a number known beforehand; where nothing cancels the rest is zero, and nothing is computed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from fastlink.numerics.compensated import (
    UNIT_ROUNDING,
    gap_product_quotient,
    pair_product,
    pair_quotient,
    power_of_two_below,
    sum_of_four,
    two_product,
    two_sum,
)
from fastlink.numerics.elementary import (
    atan2,
    binary_exponent,
    cos,
    cosh,
    cosine,
    exp,
    ldexp,
    select,
    sin,
    sine,
    sinh,
    sqrt,
)
from fastlink.numerics.logarithm import arsinh, log, log1p, log_quotient
from fastlink.numerics.vectors import absolute, sign, zero_where
from fastlink.symbolic import gaps
from fastlink.symbolic.bound import Bound, Lost, multiplied, united
from fastlink.symbolic.error_laws import (
    of_direction,
    of_logarithm,
    of_product,
    of_quotient,
    of_root,
    of_root_of_sum,
    of_root_or_none,
)
from fastlink.symbolic.expression import ExpressionGraph, Node, is_power_of_two
from fastlink.symbolic.postorder import postorder

__all__ = ["UNIT_WITH_MARGIN", "Rules", "bounded_parts"]

#: A rounding, and a millionth more: for the rounding of the bounds themselves, and for products of a few roundings.
UNIT_WITH_MARGIN = UNIT_ROUNDING * (1.0 + 2.0**-20)

#: Calls that remain calls, and the error of an unevaluated sum (high, low) that they return: roundings of the sum.
#: In `sum_of_four` the last addition of low words rounds; the others leave out products of low words; see the tests.
WORDS = {
    two_sum: 0.0,
    two_product: 0.0,
    sum_of_four: 4 * UNIT_ROUNDING,
    pair_product: 8 * UNIT_ROUNDING,
    pair_quotient: 16 * UNIT_ROUNDING,
    gap_product_quotient: 16 * UNIT_ROUNDING,
}
#: Elementary functions: two (arsinh, log_quotient: three) units in the last place are four (six) roundings.
ARCTANGENT, LOGARITHM, LOG_QUOTIENT, ARSINH, COSINE = 4.0, 4.0, 6.0, 6.0, 4.0
#: The reduction of a direction to a quarter turn leaves multiples of 2^-104, which count near zeros.
REDUCTION = 2.0**-103
#: Tabled, with one rounding.
TABLED = (sin, cos, exp, sinh, cosh)
#: Functions whose results have an error that is known whatever their arguments are.
BOUNDED_ALONE = (*TABLED, binary_exponent, power_of_two_below)


class Rules:
    """The bounds of values, by one rule for each operation.

    Parameters
    ----------
    named : callable
        Returns the bound of a name.
    """

    def __init__(self, named: Callable[[str], Bound]) -> None:
        self.named = named
        self.graph = ExpressionGraph({*WORDS, *BOUNDED_ALONE, absolute, arsinh, ldexp, sign, *gaps.LAWS})
        self.exact = Bound(0.0, self.graph.zero)
        self._bounds: dict[Node, Bound] = {}

    def bound(self, node: Node) -> Bound:
        """Return the bound of a value."""
        for each in postorder([node], bounded_parts, self._bounds):
            bound = self._rule(each)
            gap = bound.gap or any(self._bounds[part].gap for part in bounded_parts(each))
            self._bounds[each] = replace(bound, gap=gap)
        return self._bounds[node]

    def settled(self, node: Node, bound: Bound | None = None) -> Bound:
        """Return the bound of a value that does not meet its low word."""
        bound = bound or self.bound(node)
        relative, rest = bound.relative, bound.rest
        for times, high in bound.lost.values():
            if high in (node, *(node.args if node.kind == "neg" else ())):
                relative += abs(times)
            else:
                rest = self.graph.add(rest, self._roundings(abs(times), high))
        return replace(bound, relative=relative, rest=rest, lost={})

    def size(self, node: Node) -> Node:
        """Return the magnitude of a value."""
        bare = node.args[0] if node.kind == "neg" else node
        if self.bound(bare).one:
            return self.graph.one
        return bare if self.bound(bare).positive else self.graph.call(abs, bare)

    def error(self, node: Node, bound: Bound) -> Node:
        """Return the bound of a value as one expression, without what is lost."""
        return self.graph.add(bound.rest, self._roundings(bound.relative, node))

    def _roundings(self, number: float, node: Node) -> Node:
        return self.graph.mul(self.graph.number(UNIT_WITH_MARGIN * number), self.size(node))

    def _rule(self, node: Node) -> Bound:
        match node.kind:
            case "name":
                return self.named(node.value)
            case "number":
                x = node.value
                scale = x == 0.0 or x - x != 0.0 or is_power_of_two(x)
                return replace(self.exact, scale=scale, one=abs(x) == 1.0 or x != x, positive=not x < 0.0)
            case "neg":
                bound = self.bound(node.args[0])
                return replace(bound, lost=multiplied(bound.lost, -1.0), positive=False)
            case "+" | "-":
                return self._of_sum(node)
            case "*" | "/":
                return self._of_scaled(node) or self._of_ratio(node)
            case "item":
                return self._of_word(node)
            case "call":
                return self._of_call(node)
        return self.exact  # a comparison, or several; what is given

    def _of_sum(self, node: Node) -> Bound:
        x, y = node.args
        a, b = self.bound(x), self.bound(y)
        if not b.lost and self._is_high_word(x, a):  # low words meet in sums of sums
            a = self.settled(x)
        if not a.lost and self._is_high_word(y, b):
            b = self.settled(y)
        lost = united(a.lost, b.lost if node.kind == "+" else multiplied(b.lost, -1.0))
        if node.kind == "+" and a.positive and b.positive:
            rest = self.graph.add(a.rest, b.rest)
            return Bound(max(a.relative, b.relative) + 1.0, rest, lost, positive=True)
        return Bound(1.0, self.graph.add(self.error(x, a), self.error(y, b)), lost)

    def _is_high_word(self, node: Node, bound: Bound) -> bool:
        bare = node.args[0] if node.kind == "neg" else node
        return any(high in (node, bare) and low is not bare for low, (_number, high) in bound.lost.items())

    def _of_scaled(self, node: Node) -> Bound | None:
        """Return the bound of a product or quotient with a power of two, else None."""
        (x, y), graph = node.args, self.graph
        a, b = self.bound(x), self.bound(y)
        operate = graph.mul if node.kind == "*" else graph.div
        change: Callable[[Node], Node]
        if b.scale:
            other, by, change = a, b, lambda value: operate(value, y)
            rest = operate(a.rest, self.size(y))
        elif a.scale and node.kind == "*":
            other, by, change = b, a, partial(operate, x)
            rest = operate(self.size(x), b.rest)
        else:
            return None
        same = by.one and by.positive
        lost = {
            low if same else change(low): (times, change(high)) for low, (times, high) in other.lost.items()
        }
        positive = a.positive and b.positive
        return Bound(other.relative, rest, lost, a.scale and b.scale, a.one and b.one, positive)

    def _of_ratio(self, node: Node) -> Bound:
        x, y = node.args
        a, b = self.settled(x), self.settled(y)
        positive = (a.positive and b.positive) or x is y
        if node.kind == "*":
            rest = self._product(x, y)
        else:
            rest = self._quotient(node if positive else self.graph.call(abs, node), y, a.rest, b.rest)
        return Bound(a.relative + b.relative + 1.0, rest, positive=positive)

    def _product(self, x: Node, y: Node) -> Node:
        """Return the effect of the rests of two factors on their product."""
        e_x, e_y = self.settled(x).rest, self.settled(y).rest
        return self.graph.read(of_product, [self.size(x), self.size(y), e_x, e_y])

    def _quotient(self, quotient: Node, y: Node, e_x: Node, e_y: Node) -> Node:
        """Return the effect of the rests of dividend and divisor on a quotient."""
        if e_y is self.graph.zero:
            return self.graph.div(e_x, self.size(y))
        return self.graph.read(of_quotient, [quotient, self.size(y), e_x, e_y])

    def _of_word(self, node: Node) -> Bound:
        """Return the bound of a word of an unevaluated sum; the low word has no error."""
        (call,) = node.args
        high, low = (self.graph.node("item", call, value=k) for k in (0, 1))
        if node is low:
            return replace(self.exact, lost={low: (1.0, high)})
        relative, rest = self._of_words(call, high)
        return Bound(relative + WORDS[call.value], rest, {low: (-1.0, high)})

    def _of_words(self, call: Node, high: Node) -> tuple[float, Node]:
        """Return relative part and rest of the arguments' effect on an unevaluated sum."""
        function, args, graph = call.value, call.args, self.graph
        if function in (two_sum, sum_of_four):
            rest: Node = graph.zero
            lost: Lost = {}
            for arg in args:
                bound = self.bound(arg)
                rest, lost = graph.add(rest, self.error(arg, bound)), united(lost, bound.lost)
            return 0.0, self.settled(high, Bound(0.0, rest, lost)).rest
        if function is two_product:
            bound = self._of_ratio(graph.node("*", *args))
            return bound.relative - 1.0, bound.rest
        f, g = self._pair(*args[:2]), self._pair(*args[2:4])
        if function is pair_quotient:
            return f.relative + g.relative, self._quotient(graph.call(abs, high), args[2], f.rest, g.rest)
        sizes = self.size(args[0]), self.size(args[2])
        relative, rest = f.relative + g.relative, graph.read(of_product, [*sizes, f.rest, g.rest])
        if function is gap_product_quotient:
            x, y = args[4:]
            divisor = graph.mul(graph.number(4.0), graph.mul(x, y))
            relative += self.settled(x).relative + self.settled(y).relative
            of_divisor = graph.mul(graph.number(4.0), self._product(x, y))
            rest = self._quotient(graph.call(abs, high), divisor, rest, of_divisor)
        return relative, rest

    def _pair(self, high: Node, low: Node) -> Bound:
        """Return the bound of an unevaluated sum."""
        a, b = self.bound(high), self.bound(low)
        rest = self.graph.add(a.rest, self.error(low, b))
        return self.settled(high, Bound(a.relative, rest, united(a.lost, b.lost)))

    def _of_call(self, node: Node) -> Bound:
        function, graph = node.value, self.graph
        if function is select:
            return self._of_choice(node)
        if function in gaps.LAWS:
            return gaps.LAWS[function](self, node)
        if function in TABLED:
            return replace(self.exact, relative=1.0, positive=function in (exp, cosh))
        if function is binary_exponent:
            return self.exact
        if function is power_of_two_below:
            return replace(self.exact, scale=True, positive=True)
        x = node.args[0]
        a = self.settled(x)
        if function is sign:
            return gaps.bound_of_sign(self, x)
        if function in (abs, absolute, ldexp):
            return replace(a, one=False) if function is ldexp else replace(a, positive=True)
        if function is sqrt:
            law = of_root if a.positive else of_root_or_none if a.gap else of_root_of_sum
            rest = a.rest if a.rest is graph.zero else graph.read(law, [x, node, a.rest])
            return Bound(0.5 * a.relative + 1.0, rest, positive=True)
        if function is atan2:
            return self._of_direction(node)
        if function is arsinh:  # of x >= 0, where its slope times x is at most its value, and sqrt(2)/(1 + x)
            rest = self._of_slope(graph.add(graph.one, x), graph.mul(graph.number(1.4143), a.rest))
            return Bound(a.relative + ARSINH, rest, positive=True)
        if function is log1p:
            # of x >= 0 the slope times x is at most the value
            share, rest = (a.relative, a.rest) if a.positive else (0.0, self.error(x, a))
            rest = self._of_slope(graph.add(graph.one, x), rest)
            return Bound(share + LOGARITHM, rest, positive=a.positive)
        if function is log_quotient:
            return self._of_logarithm(node.args[:2], LOG_QUOTIENT)
        if function is log:
            return self._of_logarithm(node.args, LOGARITHM)
        assert function in (sine, cosine)
        return Bound(COSINE, graph.add(graph.number(REDUCTION), self.error(x, a)))

    def _of_choice(self, node: Node) -> Bound:
        condition, x, y = node.args
        a, b = self.bound(x), self.bound(y)
        if self.bound(condition).gap:
            return gaps.bound_of_doubtful_choice(self, node)
        lost: dict[Node, tuple[float, Node]] = {}
        if a.lost and y.kind == "number" and y.value != y.value:  # else there is no number at all
            lost = {low: (times, node if high is x else high) for low, (times, high) in a.lost.items()}
        else:
            a, b = self.settled(x), self.settled(y)
        rest = self.graph.select(condition, a.rest, b.rest)
        both = (a.scale and b.scale, a.one and b.one, a.positive and b.positive)
        return Bound(max(a.relative, b.relative), rest, lost, *both)

    def _of_direction(self, node: Node) -> Bound:
        y, x = node.args
        a, b = self.settled(y), self.settled(x)
        rest = self.graph.zero
        if a.rest is not rest or b.rest is not rest:
            rest = self.graph.read(of_direction, [self.size(y), self.size(x), a.rest, b.rest])
        # A relative error of y or x turns the vector by half of it times the sine of twice the angle.
        return Bound(a.relative + b.relative + ARCTANGENT, rest, positive=a.positive)

    def _of_logarithm(self, args: Sequence[Node], own: float) -> Bound:
        """Return the bound of the logarithm of a number or a quotient."""
        rest = self.graph.zero
        for x in args:
            a = self.settled(x)
            constant = self.graph.number(UNIT_WITH_MARGIN * a.relative)
            rest = self.graph.add(rest, self.graph.add(self._of_slope(self.size(x), a.rest), constant))
        return Bound(own, rest)

    def _of_slope(self, argument: Node, error: Node) -> Node:
        """Return the effect of an error on a logarithm whose slope is 1/`argument`."""
        return error if error is self.graph.zero else self.graph.read(of_logarithm, [argument, error])


def bounded_parts(node: Node) -> tuple[Node, ...]:
    """Return the values whose errors determine that of a value."""
    if node.kind == "item":
        return node.args[0].args
    if node.value is zero_where:
        return node.args[1:]
    return () if node.value in BOUNDED_ALONE else node.args

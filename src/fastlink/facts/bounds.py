"""Error bounds of facts, from their text: of an operation, of a gap, of all; NAME_error and NAME_trust."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any

from fastlink.errors import InputError, Setting
from fastlink.facts.derivative import labelled
from fastlink.facts.expression import (
    COMPARISONS,
    Algebra,
    ExpressionGraph,
    Node,
    generate_formula,
    is_power_of_two,
    postorder,
)
from fastlink.facts.fact import PIECE_ERRORS, Fact, System
from fastlink.facts.names import ErrorBound, Quantity, error_name
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
    INFINITY,
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
from fastlink.numerics.vectors import absolute, choice, sign, zero_where

if TYPE_CHECKING:
    from fastlink.facts.catalogue import Selection


# -- The error bound of one value: a relative part known beforehand, an expression, and low words


#: What rounding lost and another value keeps (the low word of a sum of two): a multiple of that value is the error,
#: with its sign, and cancels where both words meet. With it stands the high word, of which it is a rounding at most.
Lost = Mapping[Node, tuple[float, Node]]


@dataclass(frozen=True)
class Bound:
    """An error bound: u `relative` |value| + `rest`, besides what is `lost`.

    Here u is UNIT_WITH_MARGIN. `scale` tells that the value is 0 or a power of two, up to its sign, with which products
    are exact; `one` that it is 1, up to its sign (or NaN); `positive` that it is not negative; `gap` that a gap is in
    it, which may have been set to zero: its sign may be wrong.
    """

    relative: float
    rest: Node
    lost: Lost = field(default_factory=dict)
    scale: bool = False
    one: bool = False
    positive: bool = False
    gap: bool = False


def multiplied(lost: Lost, number: float) -> Lost:
    """Return a multiple of the lost low words."""
    return {low: (number * times, high) for low, (times, high) in lost.items()}


def united(first: Lost, second: Lost) -> Lost:
    """Return what two values lose together; a low word with both signs cancels."""
    sums = dict(first)
    for low, (times, high) in second.items():
        sums[low] = (times + (sums[low][0] if low in sums else 0.0), high)
    return {low: entry for low, entry in sums.items() if entry[0] != 0.0}


# -- Bound the effect of the arguments' errors on the result of an operation, from magnitudes and errors

# Each bounds the whole effect, not only its first order.


#: Powers of smaller input angles, but 0, underflow on the way.
SMALL_ANGLE = 2.0**-200
#: The double next above pi.
HALF_TURN = 3.1415926535897936


def of_product(x: Any, y: Any, e_x: Any, e_y: Any) -> Any:
    """Return the effect of errors of x and y on x y."""
    return x * e_y + (y + e_y) * e_x


def of_quotient(quotient: Any, y: Any, e_x: Any, e_y: Any) -> Any:
    """Return the effect of errors of x and y on x/y: infinite where y may be zero."""
    return (quotient * e_y + e_x) / select(e_y < y, y - e_y, 0.0)


def of_root(x: Any, root: Any, e: Any) -> Any:
    """Return the effect of an error of x >= 0 on its root: by the steepest chord."""
    return select(e < x, 0.5 * (e + e * (e / x)) / root, sqrt(e))


def of_root_or_none(x: Any, root: Any, e: Any) -> Any:
    """Return the effect of an error of x >= 0 on its root: infinite where x may be negative, and have none."""
    return select(e > x, INFINITY, of_root(x, root, e))


def of_root_of_sum(x: Any, root: Any, e: Any) -> Any:
    """Return the effect of an error of x on its root: infinite where x may be negative, unless it cancels to 0."""
    return select(x == 0.0, sqrt(e), of_root_or_none(x, root, e))


def of_root_or_zero(x: Any, root: Any, e: Any) -> Any:
    """Return the effect of an error of any x on its root, or on 0 where x is negative."""
    return select(e < -x, 0.0, select(x > 0.0, of_root(x, root, e), sqrt(e)))


def of_choice(doubt: Any, x: Any, y: Any, e_x: Any, e_y: Any, e: Any) -> Any:
    """Return the error of x or y, e unless the choice is in doubt: then it covers both, or is infinite."""
    both = abs(x - y) + (e_x + e_y)
    return select(doubt, select(both < INFINITY, both, INFINITY), e)


def of_direction(y: Any, x: Any, e_y: Any, e_x: Any) -> Any:
    """Return the effect of errors of a vector on its direction: at most pi, infinite where they are."""
    size = select(x < y, y, x)
    v = y / size
    u = x / size
    # The sine of the angle between both vectors; below 1/8 the angle exceeds its sine by less than 0.3 %.
    turn = (u * e_y + v * e_x) / ((u * u + v * v) * (size - (e_x + e_y)))
    most = select(e_x + e_y < INFINITY, HALF_TURN, INFINITY)
    return select((e_x + e_y < size) & (turn < 0.125), 1.003 * turn, most)


def of_logarithm(x: Any, e: Any) -> Any:
    """Return the effect of an error of x on its logarithm: infinite if x may be zero."""
    return e / select(e < x, x - e, 0.0)


def of_small_angle(angle: Any, e: Any) -> Any:
    """Return an error, infinite where powers of the input angle underflow."""
    size = abs(angle)
    return select((size < SMALL_ANGLE) & (size > 0.0), INFINITY, e)


# -- Propagate error bounds through the operations of an expression, each of which adds its own rounding

# Each operation has one rule, as each has one for its derivative. The rules bound the error, not its first
# order only: products and quotients of errors are in them. A bound is u `relative` |value| + `rest`, where
# u is UNIT_WITH_MARGIN and `relative` a number known beforehand; where nothing cancels the rest is zero,
# and nothing is computed.


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


#: Roundings of the two fractions of the graded range at an exact x, rest = 1/(1 + x x) and (x x) rest: at most one
#: each of x x, of the sum, of the quotient and of the product.
FRACTION = 4.0
#: A millionth more than what is left out of a gap that counts as zero, for the rounding of the bound on its way.
MARGIN = 1.0 + 2.0**-20


# NAME_error is written from the text of a fact, fact by fact: it depends on the bounds of those facts on which the
# fact depends, unless their relative error is a number known beforehand. It is a `Fact` like any other: kernels paste
# it, and it runs on floats and arrays.


class ErrorBounds(Algebra[Bound]):
    """The error bounds of a mechanism's facts, by one rule for each operation; given values have none."""

    def __init__(self, of: Selection) -> None:
        super().__init__()
        opaque = {*WORDS, *BOUNDED_ALONE, absolute, arsinh, ldexp, sign, zero_where, choice}
        self.graph = ExpressionGraph(opaque)
        self.exact = Bound(0.0, self.graph.zero)
        self.selection, self.catalogue, self.find = of, of.catalogue, of.find
        self._values: dict[str, Node] = {}
        self._facts: dict[str, Fact] = {}

    def parts(self, node: Node) -> tuple[Node, ...]:
        """Return the values whose bounds determine that of a value; of a name the one that it stands for."""
        if node.kind == "name":
            given = node.value in self.catalogue.table_low_parts or self.find(node.value) is None
            return () if given else (self._value(node.value),)
        if node.kind == "item":
            return node.args[0].args
        if node.value is zero_where:
            return node.args[1:]
        return () if node.value in BOUNDED_ALONE else node.args

    def rule(self, node: Node, parts: Sequence[Bound]) -> Bound:
        """Return the bound of a value; a gap in a part is in it too."""
        bound = super().rule(node, parts)
        return replace(bound, gap=bound.gap or any(part.gap for part in parts))

    def settled(self, node: Node, bound: Bound | None = None) -> Bound:
        """Return the bound of a value that does not meet its low word."""
        bound = bound or self.of(node)
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
        if self.of(bare).one:
            return self.graph.one
        return bare if self.of(bare).positive else self.graph.call(abs, bare)

    def error(self, node: Node, bound: Bound) -> Node:
        """Return the bound of a value as one expression, without what is lost."""
        return self.graph.add(bound.rest, self._roundings(bound.relative, node))

    def _roundings(self, number: float, node: Node) -> Node:
        return self.graph.mul(self.graph.number(UNIT_WITH_MARGIN * number), self.size(node))

    def _of_number(self, node: Node) -> Bound:
        x = node.value
        scale = x == 0.0 or x - x != 0.0 or is_power_of_two(x)
        return replace(self.exact, scale=scale, one=abs(x) == 1.0 or x != x, positive=not x < 0.0)

    def _of_negative(self, node: Node, bound: Bound) -> Bound:
        return replace(bound, lost=multiplied(bound.lost, -1.0), positive=False)

    def _of_other(self, node: Node, *parts: Bound) -> Bound:  # a comparison, or several; what is given
        return self.exact

    def _of_sum(self, node: Node, a: Bound, b: Bound) -> Bound:
        x, y = node.args
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

    def _of_product(self, node: Node, a: Bound, b: Bound) -> Bound:
        """Return the bound of a product or quotient; those with a power of two have no rounding."""
        (x, y), graph = node.args, self.graph
        operate = graph.mul if node.kind == "*" else graph.div
        change: Callable[[Node], Node]
        if b.scale:
            other, by, change = a, b, lambda value: operate(value, y)
            rest = operate(a.rest, self.size(y))
        elif a.scale and node.kind == "*":
            other, by, change = b, a, partial(operate, x)
            rest = operate(self.size(x), b.rest)
        else:
            return self._of_ratio(node)
        same = by.one and by.positive
        lost = {
            low if same else change(low): (times, change(high)) for low, (times, high) in other.lost.items()
        }
        positive = a.positive and b.positive
        return Bound(other.relative, rest, lost, a.scale and b.scale, a.one and b.one, positive)

    _of_quotient = _of_product

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

    def _of_item(self, node: Node, *parts: Bound) -> Bound:
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
                bound = self.of(arg)
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
        a, b = self.of(high), self.of(low)
        rest = self.graph.add(a.rest, self.error(low, b))
        return self.settled(high, Bound(a.relative, rest, united(a.lost, b.lost)))

    def _of_call(self, node: Node, *parts: Bound) -> Bound:
        function, graph = node.value, self.graph
        if function is select:
            return self._of_choice(node, *parts)
        if function is zero_where:
            return self._of_zeroed(node)
        if function is choice:
            return self._of_doubtful_choice(node, every=True)
        if function in TABLED:
            return replace(self.exact, relative=1.0, positive=function in (exp, cosh))
        if function is binary_exponent:
            return self.exact
        if function is power_of_two_below:
            return replace(self.exact, scale=True, positive=True)
        x = node.args[0]
        a = self.settled(x)
        if function is sign:
            return self._of_sign(x)
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

    def _of_choice(self, node: Node, doubtful: Bound, a: Bound, b: Bound) -> Bound:
        condition, x, y = node.args
        if doubtful.gap:
            return self._of_doubtful_choice(node)
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

    # -- where a gap counts as zero: a sum of lengths within their rounding, which decides what a linkage is

    # What is left out is the error of the zero. It is propagated like any other, to the bounds of all that follows;
    # where it may change the choice between two values, the bound covers both. So it does where an error may change a
    # sign.

    def _of_zeroed(self, node: Node) -> Bound:
        """Return the bound of a gap that is 0 within the rounding of the lengths: there its size is the error."""
        (condition, x), graph = node.args, self.graph
        bound = self.of(x)
        choose = partial(graph.call, zero_where, condition)
        lost = {choose(low): (times, choose(high)) for low, (times, high) in bound.lost.items()}
        if x in bound.lost:  # the low word: what is left out is counted with the high one
            return replace(bound, lost=lost, gap=True)
        left_out = graph.add(self.size(x), self.error(x, self.settled(x)))
        left_out = graph.mul(graph.number(MARGIN), left_out)
        return replace(bound, rest=graph.select(condition, left_out, bound.rest), lost=lost, gap=True)

    def _of_doubtful_choice(self, node: Node, every: bool = False) -> Bound:
        """Return the bound of a choice by a gap, which may be another one if the gap was not set to zero.

        With `every`, each comparison of values that are off may be another one.
        """
        graph, (condition, x, y) = self.graph, node.args
        a, b = self.settled(x), self.settled(y)
        relative = max(a.relative, b.relative)
        if y is graph.zero and x.value is sqrt and condition is graph.node(">", x.args[0], y):
            rest = graph.read(of_root_or_zero, [x.args[0], x, self.settled(x.args[0]).rest])
            return Bound(relative, rest, positive=True)
        errors = [self.error(x, a), self.error(y, b), graph.select(condition, a.rest, b.rest)]
        doubt = self._doubt(condition, every)
        if doubt is None:
            return Bound(relative, errors[2], positive=a.positive and b.positive)
        rest = graph.read(of_choice, [doubt, x, y, *errors])
        return Bound(relative, rest, positive=a.positive and b.positive)

    def _of_sign(self, x: Node) -> Bound:
        """Return the bound of the sign of a value, which is the other one where the error exceeds the value."""
        graph, bound = self.graph, self.settled(x)
        sign = replace(self.exact, scale=True)
        if bound.rest is graph.zero:
            return sign
        error = self.error(x, bound)
        known = graph.node("|", graph.node("<", error, self.size(x)), graph.node("==", error, graph.zero))
        return replace(sign, scale=False, rest=graph.select(known, graph.zero, graph.number(2.0)))

    def _doubt(self, condition: Node, every: bool) -> Node | None:
        """Return the condition that errors may change a comparison, None if there are none."""

        def parts(node: Node) -> list[Node]:
            return [part for part in node.args if every or self.of(part).gap] if joins(node) else []

        def joins(node: Node) -> bool:
            return node.kind in ("&", "|") or node.args[0].kind in COMPARISONS

        found: dict[Node, Node | None] = {}
        for node in postorder([condition], parts, found):
            if joins(node):
                doubts = [doubt for part in parts(node) if (doubt := found[part]) is not None]
                found[node] = self.graph.node("|", *doubts) if doubts[1:] else next(iter(doubts), None)
            else:
                found[node] = self._doubt_of_one(*node.args)
        return found[condition]

    def _doubt_of_one(self, x: Node, y: Node) -> Node | None:
        """Return the condition that the errors of two values may change their comparison, None if there are none."""
        graph = self.graph
        errors = [self.error(part, self.settled(part)) for part in (x, y)]
        if x is y:  # whether there is a number
            return graph.node("==", errors[0], graph.number(INFINITY))
        e = graph.add(*errors)
        if e is graph.zero:
            return None
        near = graph.node("<=", graph.call(abs, graph.sub(x, y)), e)
        return graph.node("&", near, graph.node(">", e, graph.zero))

    # -- facts -----------------------------------------------------------------------------------------------------

    def fact(self, name: str) -> Fact:
        """Return the error bound of a fact."""
        if name not in self._facts:
            fact = self.bounded_fact(name)
            root, own = self._expression(name)
            formula = generate_formula(error_name(name), self.graph, root, own)
            labels = labelled(fact, ErrorBound(Quantity(fact.name)), {})
            self._facts[name] = replace(labels, formula=formula, depends_on=formula.parameters)
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
        bound = self.of(value)
        if not self._lost_of(name, bound):
            bound = self.settled(value, bound)
        if bound.gap or (bound.rest is not self.graph.zero and self.catalogue.is_quantity(name)):
            error = self._or_infinite(value, self.error(value, bound))
        else:  # at least a trace of the value: where it is not finite, so is its error
            error = self.error(value, replace(bound, relative=max(bound.relative, UNIT_ROUNDING)))
        angle = self.selection.angle_of(name) if self.catalogue.is_quantity(name) else None
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

    def _of_name(self, node: Node, *of_value: Bound) -> Bound:
        name, graph = node.value, self.graph
        if name in self.catalogue.table_low_parts:
            return replace(
                self.exact, lost={graph.name(name): (1.0, graph.name(self.catalogue.table_low_parts[name]))}
            )
        graded = self.catalogue.graded
        if graded is not None and name in graded.coordinates[:2]:
            return replace(self.exact, relative=FRACTION, positive=True)
        if graded is not None and graded.gaps is not None and name in PIECE_ERRORS:
            return replace(self.exact, rest=graph.name(PIECE_ERRORS[name]))
        if not of_value:  # no fact of a variant gives a table otherwise
            if name in self.catalogue.tables:
                return self._of_table(name)
            inputs = self.catalogue.known_inputs(self.selection.variants)
            positive = name in inputs and inputs[name].rule != "any"
            return replace(self.exact, positive=positive)
        fact = self.bounded_fact(name)
        if fact.depends_on == ("branch",):
            values = [fact.formula(float(number)) for number in self.catalogue.branches]
            if all(map(is_power_of_two, values)):
                return replace(
                    self.exact, scale=True, one={*map(abs, values)} == {1.0}, positive=min(values) > 0.0
                )
        (bound,) = of_value
        lost = self._lost_of(name, bound)
        bound = replace(bound if lost else self.settled(self._value(name), bound), lost=lost)
        if bound.rest is graph.zero:
            return bound
        return replace(bound, relative=0.0, rest=graph.name(error_name(name)))

    def _of_table(self, name: str) -> Bound:
        """Return the bound of a table: exact, or rounded once, perhaps with a low part."""
        table, graph = self.catalogue.tables[name], self.graph
        given = [graph.node("given", value=part) for part in table.depends_on]
        bound = self.of(graph.read(table.formula, given))
        if bound.relative == 0.0:
            return bound
        low = next((low for low, high in self.catalogue.table_low_parts.items() if high == name), None)
        if low is None:
            return replace(self.exact, relative=1.0, positive=bound.positive)
        lost = {graph.name(low): (-1.0, graph.name(name))}
        return replace(self.exact, relative=UNIT_ROUNDING, lost=lost, positive=bound.positive)

    def _lost_of(self, name: str, bound: Bound) -> Lost:
        """Return what a fact with a low part loses, if both words lose the same."""
        fact, graph = self.bounded_fact(name), self.graph
        if fact.low is None or len(bound.lost) != 1:
            return {}
        low = self._value(fact.low)
        of_both = [word for word in fact.names if low in self.of(self._value(word)).lost]
        if name not in of_both or fact.name not in of_both:
            return {}
        return {graph.name(fact.low): (1.0 if name == fact.low else -1.0, graph.name(fact.name))}

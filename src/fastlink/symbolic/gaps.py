"""Error bounds where a gap counts as zero: a sum of lengths within their rounding, which decides what a linkage is.

What is left out is the error of the zero. It is propagated like any other, to the bounds of all that follows; where
it may change the choice between two values, the bound covers both. So it does where an error may change a sign.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from fastlink.numerics.elementary import INFINITY, sqrt
from fastlink.numerics.vectors import choice, zero_where
from fastlink.symbolic.bound import Bound
from fastlink.symbolic.error_laws import of_choice, of_root_or_zero
from fastlink.symbolic.expression import COMPARISONS, Node
from fastlink.symbolic.postorder import postorder

if TYPE_CHECKING:
    from collections.abc import Callable

    from fastlink.symbolic.error_propagation import Rules

__all__ = ["LAWS", "bound_of_doubtful_choice", "bound_of_sign"]


#: A millionth more than what is left out, for the rounding of the bound on its way.
MARGIN = 1.0 + 2.0**-20


def bound_of_zeroed(rules: Rules, node: Node) -> Bound:
    """Return the bound of a gap that is 0 within the rounding of the lengths: there its size is the error."""
    (condition, x), graph = node.args, rules.graph
    bound = rules.bound(x)
    choose = partial(graph.call, zero_where, condition)
    lost = {choose(low): (times, choose(high)) for low, (times, high) in bound.lost.items()}
    if x in bound.lost:  # the low word: what is left out is counted with the high one
        return replace(bound, lost=lost, gap=True)
    left_out = graph.add(rules.size(x), rules.error(x, rules.settled(x)))
    left_out = graph.mul(graph.number(MARGIN), left_out)
    return replace(bound, rest=graph.select(condition, left_out, bound.rest), lost=lost, gap=True)


def bound_of_doubtful_choice(rules: Rules, node: Node, every: bool = False) -> Bound:
    """Return the bound of a choice by a gap, which may be another one if the gap was not set to zero.

    With `every`, each comparison of values that are off may be another one.
    """
    graph, (condition, x, y) = rules.graph, node.args
    a, b = rules.settled(x), rules.settled(y)
    relative = max(a.relative, b.relative)
    if y is graph.zero and x.value is sqrt and condition is graph.node(">", x.args[0], y):
        rest = graph.read(of_root_or_zero, [x.args[0], x, rules.settled(x.args[0]).rest])
        return Bound(relative, rest, positive=True)
    errors = [rules.error(x, a), rules.error(y, b), graph.select(condition, a.rest, b.rest)]
    doubt = _doubt(rules, condition, every)
    if doubt is None:
        return Bound(relative, errors[2], positive=a.positive and b.positive)
    rest = graph.read(of_choice, [doubt, x, y, *errors])
    return Bound(relative, rest, positive=a.positive and b.positive)


def bound_of_sign(rules: Rules, x: Node) -> Bound:
    """Return the bound of the sign of a value, which is the other one where the error exceeds the value."""
    graph, bound = rules.graph, rules.settled(x)
    sign = replace(rules.exact, scale=True)
    if bound.rest is graph.zero:
        return sign
    error = rules.error(x, bound)
    known = graph.node("|", graph.node("<", error, rules.size(x)), graph.node("==", error, graph.zero))
    return replace(sign, scale=False, rest=graph.select(known, graph.zero, graph.number(2.0)))


#: The bounds of calls of two functions.
LAWS: dict[Any, Callable[[Rules, Node], Bound]] = {
    zero_where: bound_of_zeroed,
    choice: partial(bound_of_doubtful_choice, every=True),
}


def _doubt(rules: Rules, condition: Node, every: bool) -> Node | None:
    """Return the condition that the errors of the compared values may change a comparison, None if there are none."""

    def parts(node: Node) -> list[Node]:
        return [part for part in node.args if every or rules.bound(part).gap] if joins(node) else []

    def joins(node: Node) -> bool:
        return node.kind in ("&", "|") or node.args[0].kind in COMPARISONS

    found: dict[Node, Node | None] = {}
    for node in postorder([condition], parts, found):
        if joins(node):
            doubts = [doubt for part in parts(node) if (doubt := found[part]) is not None]
            found[node] = rules.graph.node("|", *doubts) if doubts[1:] else next(iter(doubts), None)
        else:
            found[node] = _doubt_of_one(rules, *node.args)
    return found[condition]


def _doubt_of_one(rules: Rules, x: Node, y: Node) -> Node | None:
    """Return the condition that the errors of two values may change their comparison, None if there are none."""
    graph = rules.graph
    errors = [rules.error(part, rules.settled(part)) for part in (x, y)]
    if x is y:  # whether there is a number
        return graph.node("==", errors[0], graph.number(INFINITY))
    e = graph.add(*errors)
    if e is graph.zero:
        return None
    near = graph.node("<=", graph.call(abs, graph.sub(x, y)), e)
    return graph.node("&", near, graph.node(">", e, graph.zero))

"""How each rounding on the way passes through to the end of sums, products, quotients and roots.

Where terms share factors, what an error of a factor does to one may undo what it does to another. The slope of the end
by a value on the way knows: all paths from there are in it.
"""

from __future__ import annotations

from typing import Any

from fastlink.error_rules import Rules
from fastlink.graph import Node
from fastlink.jit import select, sqrt

__all__ = ["is_smooth", "rounds", "slopes_of"]

TINY = 2.0**-1000


def root_slope(x: Any, root: Any, e: Any) -> Any:
    """Return the slope of a root; it bounds the chord over an error e of x, however near to zero x is."""
    return select(16.0 * e < x, 0.52 / root, 1.0 / sqrt(e + TINY))


def root_slope_of_squares(root: Any) -> Any:
    """Return the slope of the root of what is never negative: its chords through zero are no steeper than that."""
    return 0.5 / select(root > TINY, root, TINY)


def is_smooth(rules: Rules, node: Node) -> bool:
    """Tell whether a value is made of names and numbers by operations that have slopes."""
    if node.kind in ("name", "number") or rules.bound(node).scale:
        return True
    root = node.kind == "call" and node.value is sqrt
    operation = root or node.kind in ("+", "-", "*", "/", "neg")
    return operation and all(is_smooth(rules, arg) for arg in node.args)


def rounds(rules: Rules, node: Node) -> bool:
    """Tell whether an operation rounds: products and quotients with powers of two do not."""
    if node.kind in ("*", "/"):
        factors = node.args if node.kind == "*" else node.args[1:]
        return not any(rules.bound(factor).scale for factor in factors)
    return node.kind in ("+", "-", "call")


def slopes_of(rules: Rules, value: Node, slope: Node) -> dict[Node, Node]:
    """Return the slopes by all values that a smooth one is made of, times a slope; powers of two are constant."""
    graph, slopes = rules.graph, {value: slope}
    order: list[Node] = []

    def visit(node: Node) -> None:
        if node not in order and not rules.bound(node).scale:
            for arg in node.args:
                visit(arg)
            order.append(node)

    visit(value)
    for node in reversed(order):
        for arg, part in zip(node.args, _slopes(rules, node, slopes[node]), strict=True):
            if arg in order:
                slopes[arg] = graph.add(slopes[arg], part) if arg in slopes else part
    return {node: slopes[node] for node in order}


def _slopes(rules: Rules, node: Node, slope: Node) -> tuple[Node, ...]:
    """Return the slopes by the arguments of an operation."""
    graph, args = rules.graph, node.args
    match node.kind:
        case "neg":
            return (graph.neg(slope),)
        case "+":
            return slope, slope
        case "-":
            return slope, graph.neg(slope)
        case "*":
            return graph.mul(slope, args[1]), graph.mul(args[0], slope)
        case "/":
            share = graph.div(slope, args[1])
            return share, graph.neg(graph.mul(share, node))
        case "call":
            bound = rules.settled(args[0])
            error = rules.error(args[0], bound)
            law = (root_slope_of_squares, node) if bound.positive else (root_slope, args[0], node, error)
            return (graph.mul(slope, graph.read(law[0], law[1:])),)
    return ()

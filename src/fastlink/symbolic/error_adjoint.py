"""How each rounding on the way passes through to the end of sums, products, quotients and roots.

Where terms share factors, what an error of a factor does to one may undo what it does to another. The slope of the end
by a value on the way knows: all paths from there are in it.
"""

from __future__ import annotations

from fastlink.numerics.elementary import sqrt
from fastlink.symbolic.error_laws import root_slope, root_slope_of_squares
from fastlink.symbolic.error_propagation import UNIT, Rules
from fastlink.symbolic.expression import Node

__all__ = ["ReverseMode", "is_size", "is_smooth"]

#: A number of times a value.
Share = tuple[float, Node]


def is_smooth(rules: Rules, node: Node) -> bool:
    """Tell whether a value is made of names and numbers by operations that have slopes."""
    if node.kind in ("name", "number") or rules.bound(node).scale:
        return True
    root = node.kind == "call" and node.value is sqrt
    operation = root or node.kind in ("+", "-", "*", "/", "neg")
    return operation and all(is_smooth(rules, arg) for arg in node.args)


def is_size(rules: Rules, node: Node) -> bool:
    """Tell whether a value is the root of a sum of squares, which has no slope at zero."""
    if node.kind in ("*", "/"):
        return any(is_size(rules, arg) for arg in node.args)
    return node.kind == "call" and node.value is sqrt and rules.bound(node.args[0]).positive


class ReverseMode:
    """What the roundings of all values on the way do to a smooth one, the end.

    An error goes on to the end by the slope there, a rounding of a value by the slope times the value. All along a
    chain of products and quotients that is the same: it is told once, with the number of roundings.

    Parameters
    ----------
    rules : Rules
        The bounds of values.
    end : Node
        The name of the end.
    """

    def __init__(self, rules: Rules, end: Node) -> None:
        self.rules, self.graph = rules, rules.graph
        self._slopes = {end: self.graph.one}
        self._uses: dict[Node, list[Share | None]] = {end: [None]}
        self._roundings: dict[Node, float] = {}

    def follow(self, name: Node, value: Node) -> None:
        """Go on from a name, all whose uses are followed, to the names that its value is made of."""
        slope, share = self._leave(name)
        self._reach(value, slope, share)
        for node in reversed(self._parts(value)):
            if node.kind != "name":
                slope, share = self._leave(node)
                self._count(node, share)
                if not self._is_constant(node):
                    for arg, part, of in self._passed(node, slope, share):
                        if not self.rules.bound(arg).scale:
                            self._reach(arg, part, of)

    def total(self) -> Node:
        """Return what the roundings and the errors of all names that are not followed do to the end."""
        total = self.graph.zero
        for name in [*self._slopes]:
            slope, share = self._leave(name)
            if self._is_constant(name):
                self._count(name, share)
            else:
                error = self.rules.error(name, self.rules.settled(name))
                total = self.graph.add(total, self.graph.mul(self._size(slope), error))
        for value, number in self._roundings.items():
            total = self.graph.add(total, self.graph.mul(self.graph.number(UNIT * number), value))
        return total

    def _parts(self, value: Node) -> list[Node]:
        """Return what a value is made of, each after its own parts; powers of two are constant."""
        order: dict[Node, None] = {}

        def visit(node: Node) -> None:
            if node not in order and not self.rules.bound(node).scale:
                for arg in () if self._is_constant(node) else node.args:
                    visit(arg)
                order[node] = None

        visit(value)
        return [*order]

    def _is_constant(self, node: Node) -> bool:
        """Tell whether the relative error of a value is known beforehand."""
        return self.rules.settled(node).rest is self.graph.zero

    def _reach(self, node: Node, slope: Node, share: Share | None) -> None:
        self._slopes[node] = self.graph.add(self._slopes[node], slope) if node in self._slopes else slope
        self._uses.setdefault(node, []).append(share)

    def _leave(self, node: Node) -> tuple[Node, Share]:
        """Return the slope by a value, and the slope times the value: that of its one use, where it is a factor."""
        slope, uses = self._slopes.pop(node), self._uses.pop(node)
        if len(uses) == 1 and uses[0] is not None:
            return slope, uses[0]
        return slope, (1.0, self._size(self.graph.mul(slope, node)))

    def _size(self, node: Node) -> Node:
        return self.graph.call(abs, node.args[0] if node.kind == "neg" else node)

    def _count(self, node: Node, share: Share) -> None:
        number = self.rules.settled(node).relative if self._is_constant(node) else float(self._rounds(node))
        times, value = share
        self._roundings[value] = self._roundings.get(value, 0.0) + times * number

    def _rounds(self, node: Node) -> bool:
        """Tell whether an operation rounds: products and quotients with powers of two do not."""
        if node.kind in ("*", "/"):
            factors = node.args if node.kind == "*" else node.args[1:]
            return not any(self.rules.bound(factor).scale for factor in factors)
        return node.kind != "neg"

    def _passed(self, node: Node, slope: Node, share: Share) -> list[tuple[Node, Node, Share | None]]:
        """Return the arguments of an operation, with the slopes by them and what they share."""
        graph, args = self.graph, node.args
        match node.kind:
            case "neg":
                return [(args[0], graph.neg(slope), share)]
            case "+":
                return [(arg, slope, None) for arg in args]
            case "-":
                return [(args[0], slope, None), (args[1], graph.neg(slope), None)]
            case "*":
                return [
                    (args[0], graph.mul(slope, args[1]), share),
                    (args[1], graph.mul(args[0], slope), share),
                ]
            case "/":
                part = graph.div(slope, args[1])
                return [(args[0], part, share), (args[1], graph.neg(graph.mul(part, node)), share)]
        (x,) = args
        bound = self.rules.settled(x)
        if bound.positive:
            part = graph.read(root_slope_of_squares, [node])
            return [(x, graph.mul(slope, part), (0.5 * share[0], share[1]))]
        part = graph.read(root_slope, [x, node, self.rules.error(x, bound)])
        return [(x, graph.mul(slope, part), None)]

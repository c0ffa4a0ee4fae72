"""Tell from the text of facts on what it depends whether a value is a number.

A configuration that does not exist shows in a root of a negative number, a quotient by zero, or a choice that says so.
What does not depend on it has a value all the same.
"""

from __future__ import annotations

from collections.abc import Callable

from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, select, sqrt
from fastlink.numerics.logarithm import log, log1p, log_quotient
from fastlink.symbolic.expression import ExpressionGraph, Node
from fastlink.symbolic.postorder import postorder

__all__ = ["Existence"]

#: Functions that have no value for some numbers.
PARTIAL = (sqrt, log, log1p, log_quotient)


class Existence:
    """On what it depends whether values are numbers.

    Parameters
    ----------
    graph : ExpressionGraph
        Where the expressions are.
    read : callable
        Returns the expression in names that a name stands for, None for what is given.
    guards : callable
        Tells whether the derivative of a name is to be none where the name is no finite number.
    """

    def __init__(
        self, graph: ExpressionGraph, read: Callable[[str], Node | None], guards: Callable[[str], bool]
    ) -> None:
        self._graph, self._read, self._guards = graph, read, guards
        self._of_names: dict[str, frozenset[Node]] = {}
        self._within: dict[Node, tuple[list[str], frozenset[Node]]] = {}

    def guarded(self, name: str, root: Node, value: Node) -> Node:
        """Return a derivative that is none where the name is no finite number.

        Its own text may not depend on that: a force is none where the linkage does not assemble, and its derivative by
        a mass is an acceleration that may exist.
        """
        if not self._guards(name) or not self.causes(value) - self.causes(root):
            return root
        graph = self._graph
        exists = graph.node("<", graph.call(abs, graph.name(name)), graph.number(INFINITY))
        return graph.select(exists, root, graph.number(NOT_A_NUMBER))

    def causes(self, root: Node) -> frozenset[Node]:
        """Return the operations beneath a value, those of the names in it too, by which it may be no number."""
        texts: dict[str, Node | None] = {}

        def parts(name: str) -> list[str]:
            expression = texts[name] = self._read(name)
            return [] if expression is None else self._walked(expression)[0]

        for name in postorder(self._walked(root)[0], parts, self._of_names):
            expression = texts[name]
            self._of_names[name] = frozenset() if expression is None else self._beneath(expression)
        return self._beneath(root)

    def _beneath(self, root: Node) -> frozenset[Node]:
        names, own = self._walked(root)
        return own.union(*(self._of_names[name] for name in names))

    def _walked(self, root: Node) -> tuple[list[str], frozenset[Node]]:
        """Return the names in an expression, and its own operations by which it may be no number."""
        if root not in self._within:
            seen: dict[Node, None] = {}
            for node in postorder([root], lambda node: node.args, seen):
                seen[node] = None
            causes = frozenset(cause for node in seen if (cause := _cause(node)) is not None)
            self._within[root] = [node.value for node in seen if node.kind == "name"], causes
        return self._within[root]


def _cause(node: Node) -> Node | None:
    """Return by what an operation may have no value: itself, or what it divides by; None if it always has one."""
    if node.kind == "/":
        return None if node.args[1].kind == "number" else node.args[1]
    if node.kind != "call":
        return None
    chosen = node.args[1:] if node.value is select else ()
    endless = any(part.kind == "number" and part.value - part.value != 0.0 for part in chosen)
    return node if endless or node.value in PARTIAL else None

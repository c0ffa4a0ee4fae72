"""Derivatives of choices that rounding may make: choices of the same kind."""

from __future__ import annotations

from collections.abc import Sequence

from fastlink.numerics import vectors
from fastlink.symbolic.expression import ExpressionGraph, Node

__all__ = ["SLOPES"]


def _of_choice(graph: ExpressionGraph, args: Sequence[Node], slopes: Sequence[Node], value: Node) -> Node:
    return slopes[1] if slopes[1] is slopes[2] else graph.call(vectors.choice, args[0], *slopes[1:])


def _of_size(graph: ExpressionGraph, args: Sequence[Node], slopes: Sequence[Node], value: Node) -> Node:
    negative = graph.node("<", args[0], graph.zero)
    return graph.call(vectors.choice, negative, graph.neg(slopes[0]), slopes[0])


#: The rules of the derivatives of both, see `fastlink.symbolic.derivative`.
SLOPES = {vectors.choice: _of_choice, vectors.absolute: _of_size}

"""The work of the loops of a kernel, counted in the statements that the writer of its text recorded."""

from __future__ import annotations

import ast
from collections import Counter
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

from fastlink.codegen.runtime import results, sampling
from fastlink.numerics import compensated, vectors
from fastlink.numerics.compiler import COMPILED_AS, INLINED, parsed, syntax

if TYPE_CHECKING:
    from fastlink.codegen.source import Source

__all__ = ["HELPERS", "KINDS", "LoopWork", "loop_work"]

OPERATIONS = {
    ast.Add: "+ -",
    ast.Sub: "+ -",
    ast.USub: "+ -",
    ast.Mult: "*",
    ast.Div: "/",
    ast.Compare: "choices",
    ast.IfExp: "choices",
}
CALLS = {"select": "choices", "sqrt": "sqrt", "abs": "+ -"}
ELEMENTARY = ("atan2", "cosine", "sine", "log_quotient", "arsinh")
#: Functions that are counted by what they do.
HELPERS = {
    name: COMPILED_AS.get(function, function)
    for module in (compensated, vectors, sampling, results)
    for name, function in vars(module).items()
    if name in module.__all__ and COMPILED_AS.get(function, function) in INLINED
}
KINDS = ("+ -", "*", "/", "sqrt", "choices", "atan2, log, cos", "loads", "stores")


class LoopWork(NamedTuple):
    """The work of one loop of a kernel in each of its passes.

    Attributes
    ----------
    per : str
        For what a pass is: a design, an input position, both, a sample, a step of a refinement.
    times : str
        How often.
    work : dict of str to int
        Number of operations of each kind, of numbers read from arrays and written to arrays; functions of the house
        are counted by what they do, elementary functions as one; functions with loops are not counted.
    """

    per: str
    times: str
    work: dict[str, int]


def loop_work(source: Source) -> list[LoopWork]:
    """Return the work of every loop of a kernel that computes something."""
    rows = []
    for loop in source.loops:
        work: Counter[str] = Counter()
        for statement in parsed("\n".join(loop.statements)).body:
            _count(statement, work)
        if any(work.values()):
            rows.append(LoopWork(loop.per, loop.times, {kind: work[kind] for kind in KINDS}))
    return rows


def _count(statement: ast.stmt, work: Counter[str]) -> None:
    """Add the operations of an assignment, or of the result of a function."""
    if not isinstance(statement, (ast.Assign, ast.Return)) or statement.value is None:
        return
    pending: list[ast.AST] = [statement.value]
    if isinstance(statement, ast.Assign):
        work["stores"] += sum(isinstance(target, ast.Subscript) for target in statement.targets)
    while pending:
        node = pending.pop()
        if isinstance(node, ast.Subscript):
            work["loads"] += 1
            continue
        if isinstance(node, ast.Call):
            name = node.func.id if isinstance(node.func, ast.Name) else ""
            if name in ELEMENTARY:
                work["atan2, log, cos"] += 1
            elif name in CALLS:
                work[CALLS[name]] += 1
            elif name in HELPERS:
                work.update(_helper(name))
        operation = getattr(node, "op", node)
        if isinstance(node, (ast.operator, ast.unaryop)) or _is_constant(node):
            continue
        if kind := OPERATIONS.get(type(operation)):
            work[kind] += 1
        pending += ast.iter_child_nodes(node)


def _is_constant(node: ast.AST) -> bool:
    """Tell whether the compiler knows a value: a number, a constant of the module, an expression of these."""
    if isinstance(node, ast.Name):
        return any(isinstance(getattr(module, node.id, None), float) for module in (compensated, vectors))
    if isinstance(node, (ast.BinOp, ast.UnaryOp)):
        operands = (node.left, node.right) if isinstance(node, ast.BinOp) else (node.operand,)
        return all(_is_constant(operand) for operand in operands)
    return isinstance(node, ast.Constant)


@cache
def _helper(name: str) -> Counter[str]:
    """Return the operations of a function that is pasted at each call."""
    work: Counter[str] = Counter()
    for statement in syntax(HELPERS[name]).body:
        _count(statement, work)
    return work

"""Facts to kernel text: each fact's statements are pasted once, with its names made unique.

The grammar of facts (`fastlink.fact`) is assignments and one return.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping
from copy import deepcopy
from typing import TYPE_CHECKING, Any

from fastlink.fact import Fact, System, statements

if TYPE_CHECKING:
    from fastlink.closure import Closure, RefinedClosure

__all__ = ["Text", "paste_fact", "paste_system"]

HEADER = '''"""Kernel of {mechanism}, written by fastlink: {names}."""

from numpy import {of_numpy}
{imports}

'''


class Text:
    """Lines of a kernel under construction, with the functions it must import."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.indent = 0
        self.imports: dict[str, set[str]] = {}

    def add(self, line: str = "") -> None:
        """Append one line at the current indentation."""
        self.lines.append("    " * self.indent + line if line else "")

    def open(self, line: str) -> None:
        """Append the head of a block and go one level in."""
        self.add(line)
        self.indent += 1

    def close(self) -> None:
        """Leave a block."""
        self.indent -= 1

    def module(self, plan: Closure | RefinedClosure, of_numpy: str) -> str:
        """Return the lines as a module: what it gives, its imports, the kernel."""
        imports = "\n".join(
            f"from {module} import {', '.join(sorted(found))}"
            for module, found in sorted(self.imports.items())
        )
        names = ", ".join(output.name for output in plan.outputs)
        header = HEADER.format(mechanism=plan.catalogue.name, names=names, of_numpy=of_numpy, imports=imports)
        return header + "\n".join(self.lines) + "\n"


class _Rename(ast.NodeTransformer):
    """Make parameters, locals and globals of a fact into names of the kernel."""

    def __init__(
        self, function: Callable[..., Any], values: Mapping[str, str], local: Callable[[str], str], text: Text
    ):
        self.function, self.values, self.local, self.text = function, values, local, text
        self.locals: set[str] = set()

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if isinstance(node.ctx, ast.Store):
            self.locals.add(node.id)
        if node.id in self.locals:
            return ast.Name(self.local(node.id), node.ctx)
        if node.id in self.values:
            return ast.parse(self.values[node.id], mode="eval").body
        found = getattr(self.function, "__globals__", {}).get(node.id)
        if isinstance(found, float):
            if math.isfinite(found):
                return ast.Constant(found)
            return ast.Name("nan" if math.isnan(found) else "inf", ast.Load())
        if callable(found):
            self.text.imports.setdefault(found.__module__, set()).add(node.id)
        return node


def _paste(
    function: Callable[..., Any], values: Mapping[str, str], label: str, suffix: str, text: Text
) -> ast.expr:
    """Paste the assignments of a fact; return the expression that it returns."""
    body = statements(function)
    rename = _Rename(function, values, lambda local: f"{label}__{local}{suffix}", text)
    for statement in body[:-1]:
        assert isinstance(statement, ast.Assign)
        value = rename.visit(deepcopy(statement.value))
        targets = [rename.visit(deepcopy(target)) for target in statement.targets]
        assign = ast.Assign(targets, value)
        text.add(ast.unparse(ast.fix_missing_locations(assign)))
    last = body[-1]
    assert isinstance(last, ast.Return)
    assert last.value is not None
    result = rename.visit(deepcopy(last.value))
    assert isinstance(result, ast.expr)
    return result


def paste_fact(fact: Fact, values: Mapping[str, str], suffix: str, text: Text) -> str:
    """Append a fact's statements to the text and return the name that holds its value.

    `values` gives the kernel's name of each parameter; `suffix` tells branches apart.
    """
    result = _paste(fact.function, values, fact.name, suffix, text)
    name = f"{fact.name}{suffix}"
    text.add(f"{name} = {ast.unparse(result)}")
    return name


def paste_system(
    system: System, values: Mapping[str, str], suffix: str, text: Text, store: Callable[[int, int], str]
) -> None:
    """Append the statements that store row r, column c of a system at ``store(r, c)``."""
    rows = _paste(system.function, values, system.name, suffix, text)
    assert isinstance(rows, ast.Tuple)
    for r, row in enumerate(rows.elts):
        assert isinstance(row, ast.Tuple)
        for c, entry in enumerate(row.elts):
            text.add(f"{store(r, c)} = {ast.unparse(entry)}")

"""Facts to kernel text: each fact's statements are pasted once, with its names made unique.

The grammar of facts (`fastlink.facts.fact`) is assignments and one return.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fastlink.facts.fact import Fact, System, statements

if TYPE_CHECKING:
    from fastlink.plan.program import ExtremaProgram, Program

__all__ = ["Array", "Source", "Text", "paste_fact", "paste_system"]

HEADER = '''"""Kernel of {mechanism}, written by fastlink: {names}."""

from numpy import {of_numpy}
{imports}

'''


#: Stands for the number of input positions in the shape of an array.
N_ANGLES = "n_angles"


@dataclass(frozen=True)
class Array:
    """An array that a kernel is called with.

    Attributes
    ----------
    name, dtype : str
        Its name in the text, and what it is of: float64, int64 or int8.
    shape : tuple of int, str or None
        Lengths of its axes; `N_ANGLES` for that of the input positions, None where the text does not know.
    """

    name: str
    dtype: str
    shape: tuple[int | str | None, ...]

    def lengths(self, n_angles: int) -> tuple[int, ...]:
        """Return the shape for a number of input positions, of an array without unknown lengths."""
        return tuple(n_angles if length == N_ANGLES else int(length or 0) for length in self.shape)


@dataclass(frozen=True)
class Source:
    """The text of a kernel, and what it is called with.

    A kernel takes the array of designs (inputs, designs padded to whole vectors), the array of angles (tables, input
    positions), the numbers of both, scratch, and an array for each result.

    Attributes
    ----------
    text : str
        A module with a function ``kernel``.
    inputs, tables : int
        Rows of the arrays of designs and of angles.
    scratch, results : tuple of Array
        In the order of the arguments.
    """

    text: str
    inputs: int
    tables: int
    scratch: tuple[Array, ...]
    results: tuple[Array, ...]

    @property
    def arguments(self) -> list[tuple[str, tuple[int | None, ...]]]:
        """The dtype of each argument and its lengths, None for those that are known at run time only."""
        designs, angles = ("float64", (self.inputs, None)), ("float64", (self.tables, None))
        count: tuple[str, tuple[int | None, ...]] = ("int64", ())
        arrays = (
            (array.dtype, tuple(n if isinstance(n, int) else None for n in array.shape))
            for array in (*self.scratch, *self.results)
        )
        return [designs, angles, count, count, *arrays]


class Text:
    """Lines of a kernel under construction, with the functions it must import."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.indent = 0
        self.imports: dict[str, set[str]] = {}
        #: The lines of functions that the kernel calls.
        self.functions: list[str] = []

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

    def use(self, module: str, *names: str) -> None:
        """Import names of a module of fastlink."""
        self.imports.setdefault(f"fastlink.{module}", set()).update(names)

    def module(
        self, plan: Program | ExtremaProgram, scratch: Sequence[Array], results: Sequence[Array]
    ) -> str:
        """Return a module: what it gives, its imports, what was written before, and the lines as the kernel's body."""
        names = ", ".join(array.name for array in (*scratch, *results))
        head = f"def kernel(designs, angles, n_designs, n_angles, {names}):"
        body = [head, *(f"    {line}" if line else "" for line in self.lines)]
        of_numpy = "array, inf, nan"
        imports = "\n".join(
            f"from {module} import {', '.join(sorted(found))}"
            for module, found in sorted(self.imports.items())
        )
        names = ", ".join(output.name for output in plan.outputs)
        header = HEADER.format(mechanism=plan.catalogue.name, names=names, of_numpy=of_numpy, imports=imports)
        return header + "\n".join([*self.functions, *body]) + "\n"


class _Rename:
    """The parameters, locals and globals of a fact as names of the kernel."""

    def __init__(
        self, function: Callable[..., Any], values: Mapping[str, str], local: Callable[[str], str], text: Text
    ):
        self.function, self.values, self.local, self.text = function, values, local, text
        self.locals: set[str] = set()

    def __call__(self, node: ast.AST) -> Any:
        """Return an expression or a target with the kernel's names; what needs none is shared, not copied."""
        if isinstance(node, ast.Name):
            return self.name(node)
        fields = {}
        for key, value in ast.iter_fields(node):
            if isinstance(value, list):
                fields[key] = [self(part) for part in value]
            else:
                fields[key] = self(value) if isinstance(value, ast.expr) else value
        return type(node)(**fields)

    def name(self, node: ast.Name) -> ast.AST:
        """Return what stands for a name."""
        if isinstance(node.ctx, ast.Store):
            self.locals.add(node.id)
        if node.id in self.locals:
            return ast.Name(self.local(node.id), node.ctx)
        if node.id in self.values:
            value = self.values[node.id]
            return ast.Name(value, node.ctx) if value.isidentifier() else ast.parse(value, mode="eval").body
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
        value = rename(statement.value)  # before the targets, which may have a parameter's name
        targets = [rename(target) for target in statement.targets]
        text.add(ast.unparse(ast.Assign(targets, value, lineno=0)))
    last = body[-1]
    assert isinstance(last, ast.Return)
    assert last.value is not None
    result = rename(last.value)
    assert isinstance(result, ast.expr)
    return result


def paste_fact(fact: Fact, values: Mapping[str, str], suffix: str, text: Text) -> None:
    """Append a fact's statements to the text.

    `values` gives the kernel's name of each parameter; `suffix` tells branches apart.
    """
    result = _paste(fact.function, values, fact.name, suffix, text)
    names = [name + suffix for name in fact.names]
    parts = result.elts if isinstance(result, ast.Tuple) else [result]
    if len(parts) == len(names):
        for name, part in zip(names, parts, strict=True):
            text.add(f"{name} = {ast.unparse(part)}")
    else:
        text.add(f"{', '.join(names)} = {ast.unparse(result)}")


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

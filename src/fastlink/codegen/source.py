"""Facts to kernel text: each fact's statements are pasted once, with its names made unique.

The grammar of facts (`fastlink.facts.fact`) is assignments and one return.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from fastlink.codegen.runtime.cells import LANES, MOST_LANES
from fastlink.facts.fact import Fact, System
from fastlink.numerics.compiler import parsed

if TYPE_CHECKING:
    from fastlink.plan.programs import Program


HEADER = '''"""Kernel of {mechanism}, written by fastlink: {names}."""

from numpy import array, inf, nan
{imports}

'''


#: Stands for the number of input positions in the shape of an array.
N_ANGLES = "n_angles"
#: Where the functions with loops stand that kernels call.
RUNTIME = "fastlink.codegen.runtime"


@dataclass(frozen=True)
class Loop:
    """The work of a loop of a kernel in each of its passes."""

    #: For what a pass is: a design, an input position, both, a sample, a step of a refinement.
    per: str
    times: str
    statements: list[str]


@dataclass(frozen=True)
class Array:
    """An array that a kernel is called with."""

    name: str
    dtype: str
    #: Lengths of its axes; `N_ANGLES` for that of the input positions, None where the text does not know.
    shape: tuple[int | str | None, ...]

    def lengths(self, n_angles: int) -> tuple[int, ...]:
        """Return the shape for a number of input positions, of an array without unknown lengths."""
        return tuple(n_angles if length == N_ANGLES else int(length or 0) for length in self.shape)


@dataclass(frozen=True)
class Source:
    """The text of a kernel, and what it is called with.

    A kernel takes the array of designs (inputs, designs padded to whole vectors), the array of angles (tables, input
    positions), the numbers of both, scratch, and an array for each result.
    """

    text: str
    inputs: int
    tables: int
    scratch: tuple[Array, ...]
    results: tuple[Array, ...]
    loops: tuple[Loop, ...] = ()
    calls: tuple[str, ...] = ()

    @property
    def arguments(self) -> list[tuple[str, tuple[int | None, ...]]]:
        """The dtype of each argument and its lengths; None for a length that is known at run time only."""
        designs, angles = ("float64", (self.inputs, None)), ("float64", (self.tables, None))
        count: tuple[str, tuple[int | None, ...]] = ("int64", ())
        arrays = (
            (array.dtype, tuple(n if isinstance(n, int) else None for n in array.shape))
            for array in (*self.scratch, *self.results)
        )
        return [designs, angles, count, count, *arrays]


class Text:
    """Lines of a kernel under construction, with the functions it must import and the work of its loops."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.imports: dict[str, set[str]] = {}
        #: The lines of functions that the kernel calls.
        self.functions: list[str] = []
        self.indent = 0
        self.loops: dict[tuple[str, str], Loop] = {}
        #: The statements of the loop at hand, if its work counts.
        self.statements: list[str] | None = None

    def add(self, line: str) -> None:
        """Append one line at the current indentation."""
        self.lines.append("    " * self.indent + line)
        if self.statements is not None:
            self.statements.append(line)

    @contextmanager
    def block(self, head: str, per: str = "", times: str = "once") -> Iterator[None]:
        """Append the head of a block, then one level in what is appended meanwhile.

        The work of a loop counts where `per` says for what each of its passes is, see `Loop`. A block that stays empty
        is left out.
        """
        self.lines.append("    " * self.indent + head)
        before = len(self.lines)
        around = self.statements
        if per:
            self.statements = self.loops.setdefault((per, times), Loop(per, times, [])).statements
        self.indent += 1
        yield
        self.indent -= 1
        self.statements = around
        if len(self.lines) == before:
            self.lines.pop()

    @contextmanager
    def lanes_of(self, total: str, first: str) -> Iterator[None]:
        """Append a loop over blocks of designs or pieces, which lie in lanes side by side."""
        with self.block(f"for {first} in range(0, {total}, {LANES}):"):
            self.count_lanes(total, first)
            yield

    def count_lanes(self, total: str, first: str) -> None:
        """Append how many lanes there are from the first one on, and how many in whole vectors."""
        self.add(f"n_here = min({LANES}, {total} - {first})")
        self.add(f"width = (n_here + {MOST_LANES - 1}) & {-MOST_LANES}")

    def use(self, module: str, *names: str) -> None:
        """Import names of a module of fastlink."""
        self.imports.setdefault(f"fastlink.{module}", set()).update(names)

    def call(self, function: Callable[..., Any], arguments: str, result: str = "") -> None:
        """Append a call of a function of `fastlink.codegen.runtime`, whose result may be bound to a name."""
        self.imports.setdefault(function.__module__, set()).add(function.__name__)
        self.add(f"{result}{' = ' if result else ''}{function.__name__}({arguments})")

    def source(self, program: Program, scratch: Sequence[Array]) -> Source:
        """Return the kernel of a program: a module with the functions and the lines, as the kernel's body."""
        lengths = {"branch": len(program.branches)}
        results = [
            Array(f"out_{output.name}", output.dtype, (None, *map(lengths.get, output.axes)))
            for output in program.outputs
        ]
        names = ", ".join(array.name for array in (*scratch, *results))
        head = f"def kernel(designs, angles, n_designs, n_angles, {names}):"
        used = [(module, sorted(names)) for module, names in sorted(self.imports.items())]
        header = HEADER.format(
            mechanism=program.catalogue.name,
            names=", ".join(output.name for output in program.outputs),
            imports="\n".join(f"from {module} import {', '.join(names)}" for module, names in used),
        )
        text = header + "\n".join([*self.functions, head, *(f"    {line}" for line in self.lines)]) + "\n"
        calls = tuple(name for module, names in used if module.startswith(RUNTIME) for name in names)
        rows, loops = (len(program.inputs), len(program.tables)), tuple(self.loops.values())
        return Source(text, *rows, tuple(scratch), tuple(results), loops, calls)


class _Rename:
    """The parameters, locals and globals of a fact as names of the kernel."""

    def __init__(self, step: Fact | System, values: Sequence[str], suffix: str, text: Text) -> None:
        self.values = dict(zip(step.formula.parameters, values, strict=True))
        self.globals = step.formula.names
        self.local, self.text = f"{step.name}__{{}}{suffix}", text
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
            return ast.Name(self.local.format(node.id), node.ctx)
        if node.id in self.values:
            name = self.values[node.id]
            return ast.Name(name, node.ctx) if name.isidentifier() else parsed(name, "eval").body
        value = self.globals.get(node.id)
        if isinstance(value, float):
            if math.isfinite(value):
                return ast.Constant(value)
            return ast.Name("nan" if math.isnan(value) else "inf", ast.Load())
        if callable(value):
            self.text.imports.setdefault(value.__module__, set()).add(node.id)
        return node


def _paste(step: Fact | System, values: Sequence[str], suffix: str, text: Text) -> ast.expr:
    """Append the assignments of a fact; return the expression that it returns."""
    *assignments, last = step.formula.statements
    rename = _Rename(step, values, suffix, text)
    for statement in assignments:
        assert isinstance(statement, ast.Assign)
        value = rename(statement.value)  # before the targets, which may have a parameter's name
        targets = [rename(target) for target in statement.targets]
        text.add(ast.unparse(ast.Assign(targets, value, lineno=0)))
    assert isinstance(last, ast.Return)
    assert last.value is not None
    result = rename(last.value)
    assert isinstance(result, ast.expr)
    return result


def paste_fact(fact: Fact, values: Sequence[str], suffix: str, text: Text) -> None:
    """Append a fact's statements to the text.

    `values` are the kernel's names of its parameters, in order; `suffix` tells branches apart.
    """
    result = _paste(fact, values, suffix, text)
    names = [name + suffix for name in fact.names]
    parts = result.elts if isinstance(result, ast.Tuple) else [result]
    if len(parts) == len(names):
        for name, part in zip(names, parts, strict=True):
            text.add(f"{name} = {ast.unparse(part)}")
    else:
        text.add(f"{', '.join(names)} = {ast.unparse(result)}")


def paste_system(system: System, values: Sequence[str], suffix: str, text: Text, start: int) -> None:
    """Append the statements that store a linear system, row by row, into the rows of ``w2`` from `start` on."""
    rows = _paste(system, values, suffix, text)
    assert isinstance(rows, ast.Tuple)
    entries = [entry for row in rows.elts if isinstance(row, ast.Tuple) for entry in row.elts]
    for k, entry in enumerate(entries, start):
        text.add(f"w2[{k}, i] = {ast.unparse(entry)}")


Step = Fact | System
S = TypeVar("S", Fact, Step)


def needed_steps(steps: Sequence[S], names: Iterable[str]) -> list[S]:
    """Return the steps that values need, in order."""
    needed, result = set(names), []
    for step in reversed(steps):
        if needed.intersection(step.names):
            needed.update(step.depends_on)
            result.append(step)
    return result[::-1]

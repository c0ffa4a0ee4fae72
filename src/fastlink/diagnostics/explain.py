"""The work of a study, and what it leaves out: counted in the loops of its kernels."""

from __future__ import annotations

import ast
import textwrap
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from fastlink._text import aligned, counted
from fastlink.codegen.kernel import llvm_text
from fastlink.codegen.machine import assembly
from fastlink.codegen.runtime import results, sampling
from fastlink.codegen.translate import Refused
from fastlink.doors import door
from fastlink.engine.resolve import ResolvedSweep, resolve
from fastlink.numerics import compensated, vectors
from fastlink.numerics.compiler import COMPILED_AS, INLINED, syntax
from fastlink.plan.program import ExtremaProgram
from fastlink.study.schema import A_STUDY
from fastlink.study.study import read_study

if TYPE_CHECKING:
    from fastlink.codegen.kernel import Kernel
    from fastlink.codegen.source import Source

__all__ = ["Explanation", "KernelWork", "LoopWork", "explain"]

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


class KernelWork(NamedTuple):
    """The work of one kernel.

    Attributes
    ----------
    results : str
        What it gives.
    facts : tuple of str
        The facts that it computes.
    loops : list of LoopWork
        The work of its loops.
    source : Source
        Its text, and what it is called with.
    """

    results: str
    facts: tuple[str, ...]
    loops: list[LoopWork]
    source: Source


@dataclass(frozen=True, eq=False)
class Explanation:
    """The work of a request; prints as text.

    Attributes
    ----------
    title : str
        The mechanism, and how many designs, branches and positions.
    results : tuple of str
        The requested results.
    scaling_axis : str
        The axis that is multiplied instead of evaluated, or an empty text.
    kernels : tuple of KernelWork
        The work of each kernel.
    left_out : tuple of str
        Public quantities of the mechanism that no requested result needs.
    facts_left_out, facts_known : int
        How many facts of the mechanism are not computed, and how many there are.
    tables : tuple of str
        Tabled functions of the input position; none for a map of designs.
    """

    title: str
    results: tuple[str, ...]
    scaling_axis: str
    kernels: tuple[KernelWork, ...]
    left_out: tuple[str, ...]
    facts_left_out: int
    facts_known: int
    tables: tuple[str, ...]

    @door
    def text(self, *, kernels: bool = False, ir: bool = False, asm: bool = False) -> str:
        """Return the explanation, with the kernels' text, its translation for LLVM, its assembly language if wanted."""
        lines = [self.title, _folded("asked for", self.results)]
        if self.scaling_axis:
            lines.append(
                f"{self.scaling_axis}: only scales what is asked for; evaluated once, then multiplied"
            )
        lines.append(
            _folded("tables of the input", self.tables or ["none: nothing depends on the input position"])
        )
        for number, kernel in enumerate(self.kernels, 1):
            rows = [(loop.per, loop.times, *map(str, loop.work.values())) for loop in kernel.loops]
            lines += [
                "",
                f"kernel {number} of {len(self.kernels)}: {kernel.results}",
                _folded("computes", kernel.facts),
                aligned([("for each", "how often", *KINDS), *rows], right=2, indent="  "),
            ]
            if helpers := [name for name in kernel.source.calls if name not in HELPERS]:
                lines.append(_folded("  not counted", helpers))
            lines += ["", kernel.source.text] if kernels else []
            if ir or asm:
                lines += _machine_texts(kernel.source, ir, asm)
        share = f"{self.facts_left_out} of {self.facts_known} facts"
        return "\n".join([*lines, "", _folded(f"left out: {share}, among them", self.left_out)])

    def __str__(self) -> str:
        return self.text()

    __repr__ = __str__


@door(hint=A_STUDY)
def explain(study: str | Path) -> Explanation:
    """Return the work of a study and what it leaves out; nothing is compiled or run.

    Parameters
    ----------
    study : path
        A study file.

    Returns
    -------
    Explanation
        Prints as text.

    Raises
    ------
    InputError
        One line for each problem of the study.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> text = '''
    ... mechanism = "planar_4r"
    ... quantities = ["grashof_class"]
    ... design = {a1 = 0.4, a2 = 1.1, a3 = 0.8, a4 = 1.0}
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "study.toml")
    ...     _ = path.write_text(text)
    ...     found = explain(path)
    >>> found.tables, [loop.per for loop in found.kernels[0].loops]
    ((), ['design'])
    """
    read = read_study(study)
    return explain_request(resolve(read.mechanism, read.space, read.quantities, **read.options))


def explain_request(request: ResolvedSweep) -> Explanation:
    """Return the work of a request, and what it leaves out."""
    plan, catalogue, axis = request.plan, request.catalogue, request.scaling_axis
    computed = {name for program in plan.programs for step in program.steps for name in step.names}
    requested = {output.request.quantity for output in plan.outputs}
    sizes = [counted(request.space.size, "design"), counted(len(request.branches), "assembly mode")]
    if plan.uses_position:
        sizes.append(f"{counted(request.positions.size, 'value')} of {catalogue.position.name}")
    return Explanation(
        f"{request.mechanism}: {', '.join(sizes)}",
        tuple(output.name for output in plan.outputs),
        "" if axis is None else f"{axis.name} ({counted(axis.length, 'value')})",
        tuple(map(_kernel_work, request.kernels)),
        tuple(name for name in catalogue.public if name not in computed | requested),
        sum(name not in computed for name in catalogue.facts),
        len(catalogue.facts),
        tuple(dict.fromkeys(table for program in plan.programs for table in program.tables)),
    )


def _kernel_work(kernel: Kernel) -> KernelWork:
    program = kernel.program
    names = ", ".join(output.name for output in program.outputs)
    if isinstance(program, ExtremaProgram):
        names += f"; every extreme of {', '.join(search.quantity for search in program.searches)}"
    facts = tuple(name for step in program.steps for name in step.names)
    return KernelWork(names, facts, _loop_work(kernel.source), kernel.source)


def _machine_texts(source: Source, ir: bool, asm: bool) -> list[str]:
    """Return a kernel in LLVM's language, in assembly language, or both."""
    try:
        text = llvm_text(source)
    except Refused as why:
        return ["", f"compiled by numba, for the translator refuses it: {why}"]
    return [*(["", text] if ir else []), *(["", assembly(text)] if asm else [])]


def _loop_work(source: Source) -> list[LoopWork]:
    """Return the work of every loop of a kernel that computes something."""
    rows = []
    for loop in source.loops:
        work: Counter[str] = Counter()
        for statement in ast.parse("\n".join(loop.statements)).body:
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


def _folded(head: str, names: Iterable[str]) -> str:
    return textwrap.fill(f"{head}: {', '.join(names)}", 110, subsequent_indent="  ")

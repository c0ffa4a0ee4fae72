"""What a study computes, and what it leaves out: read off the text of its kernels."""

from __future__ import annotations

import ast
import re
import textwrap
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from fastlink._text import aligned
from fastlink.codegen.kernel import llvm_text
from fastlink.codegen.machine import assembly
from fastlink.codegen.translate import Refused
from fastlink.engine.resolve import ResolvedSweep, resolve
from fastlink.numerics import compensated, vectors
from fastlink.numerics.compiler import COMPILED_AS, syntax
from fastlink.plan.program import ExtremaProgram, Program
from fastlink.study.study import read_study

if TYPE_CHECKING:
    from fastlink.codegen.kernel import Kernel
    from fastlink.codegen.source import Source

__all__ = ["Explanation", "LoopWork", "explain"]

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
HELPERS = {name: getattr(module, name) for module in (compensated, vectors) for name in module.__all__}
KINDS = ("+ -", "*", "/", "sqrt", "choices", "atan2, log, cos", "loads", "stores")


@dataclass(frozen=True)
class LoopWork:
    """What one loop of a kernel does each time.

    Attributes
    ----------
    per : str
        For what it is run: a design, an input position, both, a sample, a step of a refinement.
    times : str
        How often.
    work : dict of str to int
        Number of operations of each kind, of numbers read from arrays and written to arrays; functions of the house
        are counted by what they do, elementary functions as one; functions with loops are not counted.
    """

    per: str
    times: str
    work: dict[str, int]


@dataclass(frozen=True, eq=False)
class Explanation:
    """What a request computes; prints as text.

    Attributes
    ----------
    title : str
        The mechanism, and how many designs, branches and positions.
    results : tuple of str
        What was asked for.
    scaling_axis : str
        The axis that is multiplied instead of evaluated, or an empty text.
    kernels : list of (str, tuple of str, list of LoopWork, str)
        For each kernel what it gives, the facts it computes, its loops, its text.
    left_out : tuple of str
        Public quantities of the mechanism that nothing asked for needs.
    facts_left_out, facts_known : int
        How many facts of the mechanism are not computed, and how many there are.
    tables : tuple of str
        What of the input position is tabled; none for a map of designs.
    sources : tuple of Source
        For each kernel its text, and what it is called with.
    """

    title: str
    results: tuple[str, ...]
    scaling_axis: str
    kernels: list[tuple[str, tuple[str, ...], list[LoopWork], str]]
    left_out: tuple[str, ...]
    facts_left_out: int
    facts_known: int
    tables: tuple[str, ...] = field(default=())
    sources: tuple[Source, ...] = field(default=())

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
        for number, (gives, facts, loops, text) in enumerate(self.kernels, 1):
            lines += [
                "",
                f"kernel {number} of {len(self.kernels)}: {gives}",
                _folded("computes", facts),
                _table(loops),
            ]
            if helpers := re.findall(
                r"^from fastlink\.codegen\.runtime\.\w+ import (.+)", text, re.MULTILINE
            ):
                lines.append(_folded("  not counted", helpers))
            lines += ["", text] if kernels else []
            if ir or asm:
                lines += _machine_texts(self.sources[number - 1], ir, asm)
        share = f"{self.facts_left_out} of {self.facts_known} facts"
        return "\n".join([*lines, "", _folded(f"left out: {share}, among them", self.left_out)])

    def __str__(self) -> str:
        return self.text()

    __repr__ = __str__


def explain(study: str | Path) -> Explanation:
    """Tell what a study computes and what it leaves out; nothing is compiled or run.

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
    >>> found.tables, [loop.per for loop in found.kernels[0][2]]
    ((), ['design'])
    """
    read = read_study(study)
    return explain_request(resolve(read.mechanism, read.space, read.quantities, **read.options))


def explain_request(asked: ResolvedSweep) -> Explanation:
    """Tell what a request computes and what it leaves out."""
    plan, catalogue = asked.plan, asked.catalogue
    made = dict.fromkeys(name for program in plan.programs for step in program.steps for name in step.names)
    wanted = {output.request.quantity for output in plan.outputs}
    sizes = [f"{asked.space.size:,} designs", f"{len(asked.branches)} assembly modes"]
    if plan.uses_position:
        sizes.append(f"{asked.positions.size:,} values of {catalogue.position.name}")
    return Explanation(
        f"{asked.mechanism}: {', '.join(sizes)}",
        tuple(output.name for output in plan.outputs),
        ""
        if asked.scaling_axis is None
        else f"{asked.scaling_axis.name} ({asked.scaling_axis.length:,} values)",
        [_kernel(kernel, asked) for kernel in asked.kernels],
        tuple(name for name in catalogue.public if name not in made and name not in wanted),
        sum(name not in made for name in catalogue.facts),
        len(catalogue.facts),
        tuple(dict.fromkeys(table for program in plan.programs for table in _tables(program))),
        tuple(kernel.source for kernel in asked.kernels),
    )


def _tables(program: Program | ExtremaProgram) -> tuple[str, ...]:
    return () if isinstance(program, ExtremaProgram) else program.tables


def _kernel(kernel: Kernel, asked: ResolvedSweep) -> tuple[str, tuple[str, ...], list[LoopWork], str]:
    program = kernel.program
    gives = ", ".join(output.name for output in program.outputs)
    searched = [search.quantity for search in program.searches] if isinstance(program, ExtremaProgram) else []
    if searched:
        gives += f"; every extreme of {', '.join(searched)}"
    facts = tuple(name for step in program.steps for name in step.names)
    loops = _loops(kernel.text, asked.catalogue.position.name, searched)
    return gives, facts, loops, kernel.text


def _machine_texts(source: Source, ir: bool, asm: bool) -> list[str]:
    """Return a kernel in LLVM's language, in assembly language, or both."""
    try:
        text = llvm_text(source)
    except Refused as why:
        return ["", f"compiled by numba, for the translator refuses it: {why}"]
    return [*(["", text] if ir else []), *(["", assembly(text)] if asm else [])]


def _loops(source: str, position: str, searched: Sequence[str]) -> list[LoopWork]:
    """Return the work of every loop of a kernel that computes something."""
    found: dict[tuple[str, str], Counter[str]] = {}

    def walk(body: Iterable[ast.stmt], function: str, around: Mapping[str, str]) -> None:
        for statement in body:
            if isinstance(statement, ast.For):
                loop = {ast.unparse(statement.target): ast.unparse(statement.iter)}
                walk(statement.body, function, {**around, **loop})
            elif isinstance(statement, ast.If):
                walk((*statement.body, *statement.orelse), function, around)
            elif isinstance(statement, ast.Assign) and ("i" in around or "j" in around):
                where = _place(function, around, position, searched)
                _count(statement, found.setdefault(where, Counter()))

    functions = [node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)]
    for part in sorted(functions, key=lambda node: node.name != "kernel"):
        walk(part.body, part.name, {})
    rows = [
        LoopWork(per, times, {kind: work[kind] for kind in KINDS}) for (per, times), work in found.items()
    ]
    return [row for row in rows if any(row.work.values())]


def _place(
    function: str, around: Mapping[str, str], position: str, searched: Sequence[str]
) -> tuple[str, str]:
    """Return for what a loop is run, and how often: by its function, and the loops it stands in."""
    kind, _, number = function.rpartition("_")
    if kind == "slope":
        return "place", f"each step of the search of {searched[int(number)]}"
    if kind == "value":
        return "extreme", f"once, of {searched[int(number)]}"
    if "j" not in around:
        return "design", "once"
    per = f"design and {position}" if "i" in around else position
    if "n_angles" in around["j"]:
        return per, "both modes together"
    samples, sides = (re.sub(r"\D", "", around.get(counter, "1")) for counter in ("j", "turn"))
    often = f"{samples} samples of the graded range"
    return "design and sample", often if sides == "1" else f"{often}, on {sides} sides"


def _count(statement: ast.Assign, work: Counter[str]) -> None:
    """Add what an assignment does."""
    pending: list[ast.AST] = [statement.value]
    for target in statement.targets:
        work["stores"] += isinstance(target, ast.Subscript)
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
    """Tell whether the compiler knows a value: a number, a constant of the module, what is made of such."""
    if isinstance(node, ast.Name):
        return any(isinstance(getattr(module, node.id, None), float) for module in (compensated, vectors))
    if isinstance(node, (ast.BinOp, ast.UnaryOp)):
        operands = (node.left, node.right) if isinstance(node, ast.BinOp) else (node.operand,)
        return all(_is_constant(operand) for operand in operands)
    return isinstance(node, ast.Constant)


@cache
def _helper(name: str) -> Counter[str]:
    """Return what a function of `fastlink.numerics.compensated` does."""
    work: Counter[str] = Counter()
    function = HELPERS[name]
    tree = syntax(COMPILED_AS.get(function, function))
    for node in ast.walk(tree):
        if isinstance(node, (ast.Assign, ast.Return)) and node.value is not None:
            _count(ast.Assign([], node.value), work)
    return work


def _folded(head: str, names: Iterable[str]) -> str:
    return textwrap.fill(f"{head}: {', '.join(names)}", 110, subsequent_indent="  ")


def _table(loops: Sequence[LoopWork]) -> str:
    """Return the work of loops as aligned text."""
    rows = [(loop.per, loop.times, *(str(loop.work[kind]) for kind in KINDS)) for loop in loops]
    return aligned([("for each", "how often", *KINDS), *rows], right=2, indent="  ")

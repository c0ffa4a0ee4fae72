"""Facts to kernel text: each fact's statements are pasted once, with its names made unique.

The grammar of facts (`fastlink.facts.fact`) is assignments and one return.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

from fastlink.codegen.runtime.cells import LANES, MOST_LANES
from fastlink.facts.fact import Fact, System, parameters, statements
from fastlink.facts.names import Quantity, Reduced
from fastlink.numerics.compiler import parsed
from fastlink.plan.query import COUNT

if TYPE_CHECKING:
    from fastlink.plan.programs import Output, Program
    from fastlink.plan.query import Reduction

__all__ = [
    "Array",
    "CycleValue",
    "Schedule",
    "Source",
    "Step",
    "Text",
    "needed_steps",
    "paste_fact",
    "paste_system",
]


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
    """The work of a loop of a kernel in each of its passes.

    Attributes
    ----------
    per : str
        For what a pass is: a design, an input position, both, a sample, a step of a refinement.
    times : str
        How often.
    statements : list of str
        What is written in it.
    """

    per: str
    times: str
    statements: list[str]


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
    loops : tuple of Loop
        The loops that compute values.
    calls : tuple of str
        The functions of `fastlink.codegen.runtime` that it calls.
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
    def blocks_of_designs(self) -> Iterator[None]:
        """Append the loop over blocks of designs, which lie in lanes side by side."""
        with self.block(f"for i0 in range(0, n_designs, {LANES}):"):
            self.add(f"n_here = min({LANES}, n_designs - i0)")
            self.add(f"width = (n_here + {MOST_LANES - 1}) & {-MOST_LANES}")
            yield

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
        self.values = dict(zip(parameters(step.function), values, strict=True))
        self.globals = getattr(step.function, "__globals__", {})
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
    *assignments, last = statements(step.function)
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


# -- The loop of a kernel that each value stands in, and the row that keeps it

# A value that the design alone determines stands in the loop over designs, one that the input position
# alone determines in the loop over positions, all others in the lanes. Lane values that one loop leaves to
# the next are rows of a scratch array.


Step = Fact | System
S = TypeVar("S", Fact, Step)

# A lane loop of fewer facts than this is short enough for the processor to look past its roots and divisions.
FEW_STEPS = 24


@dataclass(frozen=True)
class CycleValue:
    """A result over the cycle for one copy of its quantity, and the kernel's names of its lane values.

    Attributes
    ----------
    output : Output
        The result.
    reduction : Reduction
        The reduction that it is.
    suffix : str
        The ending of the copy's name.
    slopes : tuple of str
        The copies of the derivatives by inputs, of a result that is that of the reduction or made of several.
    value, counted : str
        The copies of the quantity, and of the fact that is a number where a position counts, if not all do.
    """

    output: Output
    reduction: Reduction
    suffix: str
    slopes: tuple[str, ...] = ()
    value: str = ""
    counted: str = ""

    @property
    def name(self) -> str:
        """Name of the copy, of which only values at counted positions are numbers."""
        quantity = self.output.request.quantity
        return f"{quantity}__counted{self.suffix}" if self.counted else f"{quantity}{self.suffix}"

    @property
    def slots(self) -> dict[str, str]:
        """The accumulators, by what the reduction's text calls them."""
        return {
            key: f"{self.output.request.quantity if pair == COUNT else self._own}__{key}{self.suffix}"
            for key, pair in self.reduction.accumulators.items()
        }

    @property
    def gradient_slots(self) -> list[dict[str, str]]:
        """The further accumulators of each derivative by an input, where the result is one or made of them."""
        return [
            {key: f"{self._own}__{key}__{slope}" for key in self.reduction.gradient} for slope in self.slopes
        ]

    @property
    def position_slots(self) -> list[str]:
        """The position of an extremum, where it is the result; else none."""
        request = self.output.request
        return [f"{request.name}__position{self.suffix}"] if request.is_position else []

    @property
    def whole_slot(self) -> str:
        """The result of a reduction of the whole curve."""
        return f"{self._own}__whole{self.suffix}"

    @property
    def _own(self) -> Reduced:
        return Reduced(Quantity(self.output.request.quantity), self.reduction.suffix)


class Schedule:
    """The steps of a program by loop, and the rows of lane values."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.rows: dict[str, int] = {}
        self.position = position = program.catalogue.position.name
        axes = [(step, self.axes(step)) for step in program.steps]
        self.lane_steps = [step for step, on in axes if on >= {"design", position}]
        self.design_steps = [step for step, on in axes if position not in on and "design" in on]
        self.angle_steps = [step for step, on in axes if on == {position}]
        self.constant_steps = [step for step, on in axes if on <= {"branch"}]
        self.systems = [step for step in self.lane_steps if isinstance(step, System)]
        self.curves = [output for output in program.outputs if position in output.axes]
        self.per_design = [output for output in program.outputs if not output.axes]
        self.cycle_values = [
            CycleValue(
                output,
                reduction,
                suffix,
                tuple(self.copy_for(slope, k) for slope in output.slopes),
                self.copy_for(output.request.quantity, k),
                self.copy_for(output.counted, k) if output.counted else "",
            )
            for output in program.outputs
            if (reduction := output.request.reduction) is not None
            for suffix, k in self.suffixes(*_read_by(output))
        ]
        #: The facts of the design that tell where an integral over the turn meets a toggle.
        self.toggles = list(dict.fromkeys(name for o in program.outputs for name in o.toggles))
        self.accumulated = [value for value in self.cycle_values if not value.reduction.whole]
        #: The values whose whole cycle is needed at once.
        self.whole_curves = list(dict.fromkeys(v.name for v in self.cycle_values if v.reduction.whole))
        #: The quantities of results that need the loop over input positions.
        reduced = [value.output for value in self.cycle_values]
        further = (name for output in reduced for name in (*output.slopes, output.counted) if name)
        #: The tolerances that changes are made of, of the design.
        self.tolerances = list(dict.fromkeys(term.tolerance for o in program.outputs for term in o.terms))
        self.varying = list(
            dict.fromkeys([*(output.request.quantity for output in (*self.curves, *reduced)), *further])
        )

    def axes(self, step: Step) -> frozenset[str]:
        """Return the axes on which the values of a step depend."""
        return self.program.axes[step.names[0]]

    def suffixes(self, *names: str) -> list[tuple[str, int]]:
        """Return the copies of what is made of values: one, or one for each branch, with the branch's number."""
        if any("branch" in self.program.axes[name] for name in names):
            return [(f"__{branch}", k) for k, branch in enumerate(self.program.branches)]
        return [("", 0)]

    def copies(self, names: Iterable[str]) -> list[str]:
        """Return the kernel's names of all copies of values."""
        return [name + suffix for name in names for suffix, _ in self.suffixes(name)]

    def copy_for(self, name: str, branch: int) -> str:
        """Return the kernel's name of a value for one branch; the branch itself is a number."""
        if name == "branch":
            return f"{self.program.branches[branch]}.0"
        copies = self.copies([name])
        return copies[min(branch, len(copies) - 1)]

    def branches_of(self, value: CycleValue) -> list[int]:
        """Return the numbers of the branches whose result a copy gives."""
        copies = self.suffixes(*_read_by(value.output))
        return [
            k for k in range(len(self.program.branches)) if copies[min(k, len(copies) - 1)][0] == value.suffix
        ]

    def row(self, name: str) -> str:
        """Return a lane value in the scratch array, reserving its row on first use."""
        return f"w[{self.rows.setdefault(name, len(self.rows))}, i]"

    @cached_property
    def lane_needs(self) -> list[str]:
        """The values of the design that the lane loop reads: inputs and facts."""
        computed, axes = _computed(self.lane_steps), self.program.axes
        kinds = ({"design"}, {"design", "branch"})
        needs = _reads(self.lane_steps) | dict.fromkeys(self.varying)
        return self.copies(name for name in needs if name not in computed and axes[name] in kinds)

    @staticmethod
    def system_size(step: System) -> int:
        """Return the number of entries of a linear system, its right-hand side included."""
        return len(step.unknowns) * (len(step.unknowns) + 1)

    def unknown_rows(self, system: System) -> list[tuple[str, int]]:
        """Return each copy of a system's unknowns with the row of the solution that holds it."""
        n, size = len(system.unknowns), self.system_size(system)
        return [
            (unknown + suffix, k * size + r * (n + 1) + n)
            for r, unknown in enumerate(system.unknowns)
            for suffix, k in self.suffixes(unknown)
        ]

    # -- stages ------------------------------------------------------------------------------------

    def stages(self) -> list[list[Step]]:
        """Split the lane steps into loops over the lanes.

        First the roots and divisions that both branches share, with what they need: in one loop with the rest,
        their latency is longer than the processor looks ahead (25 % on extrema with reactions). Then what a
        linear system needs, which is solved outside the lane loop, and last all the rest.
        """
        roots = [step for step in self.lane_steps if "branch" not in self.axes(step) and _is_slow(step)]
        if len(self.lane_steps) < FEW_STEPS:
            roots = []
        first = self.needed_for(roots)
        second = [step for step in self.needed_for(self.systems) if step not in first]
        rest = [step for step in self.lane_steps if step not in first and step not in second]
        # After a system there is always a loop, if only to load the unknowns.
        return [*(stage for stage in (first, second) if stage), rest]

    def curve_stages(self) -> list[list[Step]]:
        """Split the steps of curves, whose lanes are positions, into loops: what shared logarithms need, then the rest.

        A logarithm and the root before it are a chain of 100 cycles and more (33 % on psi of the Minkowskian 4R).
        Roots and divisions alone are short enough: there a split gains nothing.
        """
        steps = [*self.angle_steps, *self.lane_steps]
        logs = [s for s in self.lane_steps if "branch" not in self.axes(s) and _calls(s, "log_quotient")]
        first = [step for step in self.needed_for(logs) if step not in logs]
        if not first or _computed(logs) & _reads(first).keys():
            return [steps]
        first = [*self.angle_steps, *first]
        return [first, [step for step in steps if step not in first]]

    def needed_for(self, wanted: Sequence[Step]) -> list[Step]:
        """Return the lane steps that `wanted` need, and themselves."""
        return needed_steps(self.lane_steps, _computed(wanted))

    def carried(self, stages: Sequence[Sequence[Step]], number: int) -> set[str]:
        """Return the values of a stage that later ones read."""
        later = [step for stage in stages[number + 1 :] for step in stage]
        reads = {*_reads(later), *(self.varying if number < len(stages) - 1 else ())}
        return set(self.copies(_computed(_facts(stages[number])) & reads))

    def loads(self, stages: Sequence[Sequence[Step]], number: int) -> list[str]:
        """Return the lane values that a stage reads from scratch."""
        computed = _computed(_facts(stages[number]))
        needs = _reads(stages[number])
        if number == len(stages) - 1:
            needs |= dict.fromkeys(self.varying)
        earlier = set(self.lane_needs).union(*(self.carried(stages, k) for k in range(len(stages))))
        return [name for name in self.copies(n for n in needs if n not in computed) if name in earlier]


def needed_steps(steps: Sequence[S], names: Iterable[str]) -> list[S]:
    """Return the steps that values need, in order."""
    needed, result = set(names), []
    for step in reversed(steps):
        if needed.intersection(step.names):
            needed.update(step.depends_on)
            result.append(step)
    return result[::-1]


def _read_by(output: Output) -> list[str]:
    """Return what the accumulators of a reduction read that may differ by branch."""
    return [output.request.quantity, *([output.counted] if output.counted else [])]


def _computed(steps: Iterable[Step]) -> set[str]:
    return {name for step in steps for name in step.names}


def _reads(steps: Iterable[Step]) -> dict[str, None]:
    """Return the names that steps depend on, in order."""
    return dict.fromkeys(name for step in steps for name in step.depends_on)


def _facts(steps: Iterable[Step]) -> list[Fact]:
    return [step for step in steps if isinstance(step, Fact)]


def _is_slow(step: Step) -> bool:
    """Tell whether a fact takes a root or divides."""
    return _calls(step, "sqrt", "atan2", "log_quotient", divides=True)


def _calls(step: Step, *functions: str, divides: bool = False) -> bool:
    """Tell whether the text of a fact names one of these functions, or divides."""
    return isinstance(step, Fact) and any(
        (isinstance(node, ast.Name) and node.id in functions) or (divides and isinstance(node, ast.Div))
        for statement in statements(step.function)
        for node in ast.walk(statement)
    )

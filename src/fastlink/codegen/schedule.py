"""The loop of a kernel that each value stands in, and the row that keeps it.

A value that the design alone determines stands in the loop over designs, one that the input position alone determines
in the loop over positions, all others in the lanes. Lane values that one loop leaves to the next are rows of a
scratch array.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

from fastlink.facts.fact import Fact, System, statements
from fastlink.facts.names import Quantity, Reduced
from fastlink.plan.reductions import COUNT

if TYPE_CHECKING:
    from fastlink.plan.program import Output, Program
    from fastlink.plan.reductions import Reduction

__all__ = ["CycleValue", "Schedule", "Step", "needed_steps"]

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

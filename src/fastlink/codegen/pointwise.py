"""The text of a kernel: straight-line loops over lanes.

Lanes are designs (blocks of `LANES`, outer loop over the input positions) whenever something is reduced over the
cycle, because a running extremum kept in a scalar stops vectorisation; lanes are input positions for curves alone,
because then each curve is written as it lies in the file.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from fastlink.codegen.runtime import paths
from fastlink.codegen.runtime.cells import LANES
from fastlink.codegen.runtime.systems import solve_lanes
from fastlink.codegen.source import (
    N_ANGLES,
    Array,
    Source,
    Step,
    Text,
    needed_steps,
    paste_fact,
    paste_system,
)
from fastlink.facts.arc import ARC
from fastlink.facts.fact import Fact, System
from fastlink.facts.names import Quantity, Reduced
from fastlink.plan.query import COUNT, OF_ARC, WHOLE_PART, status_text

if TYPE_CHECKING:
    from fastlink.plan.programs import Output, Program
    from fastlink.plan.query import Reduction

# Input positions between two loops of curves: what is kept between them stays in the first cache.
TILE = 512
#: How often a loop over input positions runs for one of these.
BOTH_MODES = "both modes together"
# A lane loop of fewer facts than this is short enough for the processor to look past its roots and divisions.
FEW_STEPS = 24


@dataclass(frozen=True)
class CycleValue:
    """A result over the cycle for one copy of its quantity, and the kernel's names of its lane values."""

    output: Output
    reduction: Reduction
    suffix: str
    #: The copies of the derivatives by inputs, of a result that is that of the reduction or made of several.
    slopes: tuple[str, ...] = ()
    value: str = ""
    #: The copy of the fact that is a number where a position counts, if not all do.
    counted: str = ""

    @property
    def name(self) -> str:
        """Name of the copy, of which only values at counted positions are numbers."""
        quantity = self.output.request.quantity
        return f"{quantity}__counted{self.suffix}" if self.counted else f"{quantity}{self.suffix}"

    #: The name of the copy of the other coordinate, of a reduction of a point's path.
    other: str = ""

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


class _PointwiseWriter:
    """One kernel while it is written: the steps of a program by loop, and the rows of lane values.

    A value that the design alone determines stands in the loop over designs, one that the input position alone
    determines in the loop over positions, all others in the lanes. Lane values that one loop leaves to the next are
    rows of a scratch array.
    """

    def __init__(self, program: Program) -> None:
        self.program = program
        self.text = Text()
        self.tile: list[str] = []
        self.rows: dict[str, int] = {}
        self.position = position = program.catalogue.position.name
        self.configuration = f"design and {position}", BOTH_MODES
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
                self.copy_for(output.request.other, k) if output.request.other else "",
            )
            for output in program.outputs
            if (reduction := output.request.reduction) is not None
            for suffix, k in self.suffixes(*_read_by(output))
        ]
        #: The facts of the design that tell where an integral over the turn meets a toggle.
        self.toggles = list(dict.fromkeys(name for o in program.outputs for name in o.toggles))
        self.part = OF_ARC if ARC in program.variants else WHOLE_PART
        self.accumulated = [value for value in self.cycle_values if not value.reduction.whole]
        #: The values whose whole cycle is needed at once.
        whole = [value for value in self.cycle_values if value.reduction.whole]
        self.whole_curves = list(dict.fromkeys(name for v in whole for name in (v.name, v.other) if name))
        #: The quantities of results that need the loop over input positions.
        reduced = [value.output for value in self.cycle_values]
        further = [name for o in reduced for name in (*o.slopes, o.counted, o.request.other) if name]
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

    # -- the kernel --------------------------------------------------------------------------------

    def write(self) -> Source:
        """Return the kernel."""
        self.text.use("numerics.compiler", "lanes", "entries")
        self.paste(self.constant_steps)
        with self.text.lanes_of("n_designs", "i0"):
            self.write_designs()
            if self.curves or self.cycle_values:
                if self.program.lanes == "designs":
                    self.write_positions()
                else:
                    self.write_curves()
            self.write_results()
        return self.text.source(self.program, self.scratch())

    def scratch(self) -> list[Array]:
        """Return the arrays that the kernel works in."""
        systems = sum(self.system_size(s) * len(self.suffixes(s.unknowns[0])) for s in self.systems)
        arrays = [Array("w", "float64", (max(len(self.rows), 1), LANES))]
        if systems:
            arrays.append(Array("w2", "float64", (systems, LANES)))
        if self.tile:
            arrays.append(Array("tile", "float64", (len(self.tile), TILE)))
        if self.whole_curves:
            arrays.append(Array("sums", "float64", (paths.ROWS, LANES)))
        return arrays + [Array(f"whole_{name}", "float64", (N_ANGLES, LANES)) for name in self.whole_curves]

    # -- facts -------------------------------------------------------------------------------------

    def paste(self, steps: Sequence[Step], stores: Mapping[str, list[str]] | None = None) -> None:
        """Append steps branch by branch, and each value's lines of `stores` as soon as it is known.

        Either way fewer values wait in registers than fact by fact. For the same reason curves (`stores`) compute
        what both branches share where branch 1 first needs it; with all that first they take 5 % longer,
        while extrema take 5 % less.
        """
        shared = [step for step in steps if "branch" not in self.axes(step)]
        own = [step for step in steps if "branch" in self.axes(step)]
        first = list(steps) if stores and own else shared
        self.paste_for(first, 0, stores or {})
        for k in range(len(self.program.branches) if own else 0):
            if k or first is shared:
                self.paste_for(own, k, stores or {})

    def paste_for(self, steps: Sequence[Step], k: int, stores: Mapping[str, list[str]]) -> None:
        """Append steps for branch number k; the entries of linear systems go to this branch's rows."""
        for step in steps:
            suffix = f"__{self.program.branches[k]}" if "branch" in self.axes(step) else ""
            values = [self.copy_for(name, k) for name in step.depends_on]
            if isinstance(step, System):
                paste_system(step, values, suffix, self.text, k * self.system_size(step))
            else:
                paste_fact(step, values, suffix, self.text)
            for name in step.names:
                for line in stores.get(name + suffix, ()):
                    self.text.add(line)

    # -- the loops ---------------------------------------------------------------------------------

    def write_designs(self) -> None:
        """Write the values that depend on the design alone, and the accumulators' first values."""
        text = self.text
        with text.block("for i in lanes(width):", "design"):
            for k, name in enumerate(self.program.inputs):
                text.add(f"{name} = designs[{k}, i0 + i]")
            self.paste(self.design_steps)
            per_design = [output.request.quantity for output in self.per_design]
            for name in dict.fromkeys((*self.lane_needs, *per_design, *self.toggles, *self.tolerances)):
                text.add(f"{self.row(name)} = {name}  # {name}")
            for value in self.accumulated:
                initial = {name: value.reduction.accumulators[key][0] for key, name in value.slots.items()}
                for slots in value.gradient_slots:
                    initial |= {name: value.reduction.gradient[key][0] for key, name in slots.items()}
                for name, number in (initial | dict.fromkeys(value.position_slots, "nan")).items():
                    if name not in self.rows:
                        text.add(f"{self.row(name)} = {number}  # {name}")

    def write_tables(self, position: str) -> None:
        """Write the loads of the functions of the input position."""
        for k, name in enumerate(self.program.tables):
            self.text.add(f"{name} = angles[{k}, {position}]")

    def write_positions(self) -> None:
        """Write the loop over input positions where lanes are designs; extrema stay in the lanes."""
        text, stages = self.text, self.stages()
        with text.block("for j in range(n_angles):", self.position, BOTH_MODES):
            self.write_tables("j")
            if self.part is OF_ARC and self.accumulated:
                text.add("part = 0.5 if (j == 0) | (j == n_angles - 1) else 1.0")
            self.paste(self.angle_steps)
            for number in range(len(stages)):
                self.write_stage(stages, number)
            if self.curves:
                with text.block("for i in range(n_here):", *self.configuration):
                    for output in self.curves:
                        for k in range(len(self.program.branches)):
                            name = self.copy_for(output.request.quantity, k)
                            text.add(f"out_{output.name}[i0 + i, {k}, j] = {self.row('curve ' + name)}")
            for name in self.whole_curves:
                with text.block("for i in lanes(width):", *self.configuration):
                    text.add(f"whole_{name}[j, i] = {self.row('curve ' + name)}")
        for value in self.cycle_values:
            if value.reduction.whole:
                self.row(value.whole_slot)
                module, _, function = value.reduction.whole.rpartition(".")
                text.use(f"codegen.runtime.{module}", function)
                row = self.rows[value.whole_slot]
                curves = ", ".join(f"whole_{name}" for name in (value.name, value.other) if name)
                text.add(f"{function}({curves}, w[{row}], n_angles, width, sums)")

    def write_stage(self, stages: Sequence[Sequence[Step]], number: int) -> None:
        """Write one loop over lanes that are designs, and the solution of the systems whose entries it stores."""
        text, stage = self.text, stages[number]
        with text.block("for i in lanes(width):", *self.configuration):
            for name in self.loads(stages, number):
                text.add(f"{name} = {self.row(name)}")
            for system in (s for s in stages[number - 1] if number and isinstance(s, System)):
                for name, row in self.unknown_rows(system):
                    text.add(f"{name} = w2[{row}, i]")
            self.paste(stage)
            for name in sorted(self.carried(stages, number)):
                text.add(f"{self.row(name)} = {name}  # {name}")
            if number == len(stages) - 1:
                self.write_updates()
                curves = self.copies(output.request.quantity for output in self.curves)
                for name in dict.fromkeys((*curves, *self.whole_curves)):
                    text.add(f"{self.row('curve ' + name)} = {name}  # {name}")
        for system in (s for s in stage if isinstance(s, System)):
            for _, k in self.suffixes(system.unknowns[0]):
                text.call(solve_lanes, f"w2, {k * self.system_size(system)}, {len(system.unknowns)}, width")

    def write_updates(self) -> None:
        """Write the updates of the accumulators by the values at this input position."""
        text = self.text
        text.use("numerics.elementary", "select", "sqrt")
        written: set[str] = set()
        for value in {value.name: value for value in self.cycle_values if value.counted}.values():
            counts = f"{value.counted} == {value.counted}"
            text.add(f"{value.name} = select({counts}, {value.value}, nan)")
        for value in self.accumulated:
            better = f"{value.name}_{value.reduction.suffix}__better"
            if better not in written:
                new = {key: name for key, name in value.slots.items() if name not in written}
                known = {"value": value.name, "better": better, **value.slots, **self.part}
                for name in new.values():
                    text.add(f"{name} = {self.row(name)}")
                if value.reduction.better:
                    text.add(f"{better} = {value.reduction.better.format(**known)}")
                for key, name in new.items():
                    text.add(f"{self.row(name)} = {value.reduction.accumulators[key][1].format(**known)}")
                written.update((better, *new.values()))
            self.write_gradient_updates(value, better, written)
            for name in value.position_slots:
                text.add(f"{self.row(name)} = select({better}, {self.position}, {self.row(name)})")

    def write_gradient_updates(self, value: CycleValue, better: str, written: set[str]) -> None:
        """Write the updates of the accumulators of derivatives by inputs that are not written yet."""
        for slope, slots in zip(value.slopes, value.gradient_slots, strict=True):
            rows = {other: self.row(slot) for other, slot in slots.items()}
            known = {
                "value": value.name,
                "better": better,
                "slope": slope,
                **value.slots,
                **rows,
                **self.part,
            }
            for key, name in slots.items():
                if name not in written:
                    self.text.add(f"{self.row(name)} = {value.reduction.gradient[key][1].format(**known)}")
            written.update(slots.values())

    def write_curves(self) -> None:
        """Write the loop over designs where lanes are input positions: curves go straight into the results."""
        text, stages = self.text, self.curve_stages()
        self.tile = sorted(self.carried(stages, 0))
        position = "j0 + j" if self.tile else "j"
        stores: dict[str, list[str]] = {}
        for output in self.curves:
            for k in range(len(self.program.branches)):
                value = self.copy_for(output.request.quantity, k)
                store = f"out_{output.name}[i0 + i, {k}, {position}] = {value}"
                stores.setdefault(value, []).append(store)
        with text.block("for i in range(n_here):", "design"):
            for name in self.lane_needs:
                text.add(f"{name} = {self.row(name)}")
            with text.block(f"for piece in range(0, n_angles, {TILE}):") if self.tile else nullcontext():
                if self.tile:
                    # The last piece ends where the input positions end.
                    text.add(f"j0 = max(min(piece, n_angles - {TILE}), 0)")
                for stage in stages:
                    self.write_curve_stage(stage, stores, position)

    def write_curve_stage(
        self, stage: Sequence[Step], stores: Mapping[str, list[str]], position: str
    ) -> None:
        """Write one loop over input positions; values made here and read in the next one wait in the tile."""
        text, count = self.text, f"min({TILE}, n_angles)" if self.tile else "n_angles"
        with text.block(f"for j in entries({count}):", *self.configuration):
            self.write_tables(position)
            computed = {name for step in stage for name in step.names}
            for row, name in enumerate(self.tile):
                if name not in computed:
                    text.add(f"{name} = tile[{row}, j]")
            self.paste(stage, stores)
            for row, name in enumerate(self.tile):
                if name in computed:
                    text.add(f"tile[{row}, j] = {name}")

    # -- results -----------------------------------------------------------------------------------

    def write_results(self) -> None:
        """Write the copies of what each design has one of, and the results of the reductions."""
        text = self.text
        if self.per_design:
            # Whole blocks are stored by vectors: one by one, types of linkages take a third longer.
            with text.block(f"if n_here == {LANES}:"):
                self.write_per_design(f"lanes({LANES})", "design")
            with text.block("else:"):
                self.write_per_design("range(n_here)", "")
        if self.cycle_values:
            with text.block("for i in range(n_here):", "design"):
                self.write_cycle_results()

    def write_per_design(self, counters: str, per: str) -> None:
        """Write the copies of what each design has one of."""
        with self.text.block(f"for i in {counters}:", per):
            for output in self.per_design:
                self.text.add(f"out_{output.name}[i0 + i] = {self.row(output.request.quantity)}")

    def write_cycle_results(self) -> None:
        """Write the results of the reductions, from the accumulators or from what a function has made of the curve."""
        for value in self.cycle_values:
            rows = {key: self.row(name) for key, name in value.slots.items()}
            at_toggle = "nan" if value.slopes else value.reduction.at_toggle.format(**rows)
            if value.reduction.whole:
                result = self.row(value.whole_slot)
            elif value.position_slots:
                result = self.row(*value.position_slots)
            elif value.slopes:
                result = self.derivative_or_change(value, rows)
            else:
                result = value.reduction.finish.format(**rows)
            if value.output.request.is_status:
                result, at_toggle = status_text(value.reduction, result, bool(value.output.toggles))
            if value.output.toggles:
                self.text.use("numerics.elementary", "select", "sqrt")
                meets = " | ".join(f"({self.row(name)} > 0.0)" for name in value.output.toggles)
                result = f"select({meets}, {at_toggle}, {result})"
            for k in self.branches_of(value):
                self.text.add(f"out_{value.output.name}[i0 + i, {k}] = {result}")

    def derivative_or_change(self, value: CycleValue, rows: Mapping[str, str]) -> str:
        """Return the derivative of a reduction by an input, or its change by the tolerances of several."""
        finish = value.reduction.gradient_finish
        found = [
            finish.format(**rows, **{key: self.row(name) for key, name in slots.items()})
            for slots in value.gradient_slots
        ]
        terms = value.output.terms
        if not terms:
            return found[0]
        pairs = zip(found, terms, strict=True)
        first, *others = (f"abs({slope}) * {self.row(term.tolerance)}" for slope, term in pairs)
        for other in others:
            first = (
                f"{first} + {other}"
                if value.output.request.change == "worst"
                else f"magnitude({first}, {other})"
            )
        if others and value.output.request.change == "rss":
            self.text.use("numerics.vectors", "magnitude")
        return first


def _read_by(output: Output) -> list[str]:
    """Return what the accumulators of a reduction read that may differ by branch."""
    request = output.request
    return [name for name in (request.quantity, request.other, output.counted) if name]


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
    if not isinstance(step, Fact):
        return False
    named = not step.formula.uses.isdisjoint(functions)
    return named or (divides and any(isinstance(node, ast.Div) for node in step.formula.nodes))


def write_kernel(program: Program) -> Source:
    """Return the text of the program's kernel, and what it is called with."""
    return _PointwiseWriter(program).write()

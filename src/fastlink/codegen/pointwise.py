"""The text of a kernel: straight-line loops over lanes.

Lanes are designs (blocks of `LANES`, outer loop over the angles) whenever something is taken over the
cycle, because a running extreme kept in a scalar stops vectorisation; lanes are angles for curves alone,
because then each curve is written as it lies in the file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from fastlink.catalogue.catalogue import Fact, System, parameters
from fastlink.codegen.runtime.cells import LANES, MOST_LANES
from fastlink.codegen.schedule import Schedule, Step
from fastlink.codegen.source import N_ANGLES, Array, Source, Text, paste_fact, paste_system
from fastlink.facts.names import Quantity, Reduced
from fastlink.plan.reductions import COUNT

if TYPE_CHECKING:
    from fastlink.plan.program import ExtremaProgram, Output, Program

__all__ = ["results_of", "write_kernel"]

# Angles between two loops of curves: what is kept between them stays in the first cache.
TILE = 512


class _Writer(Schedule):
    """One kernel while it is written."""

    def __init__(self, plan: Program) -> None:
        super().__init__(plan)
        self.text = Text()
        self.tile: list[str] = []

    def write(self) -> Source:
        text = self.text
        text.use("numerics.compiler", "lanes", "entries")
        for step in self.constant_steps:
            for branch in self.plan.branches:
                assert isinstance(step, Fact)
                paste_fact(step, {"branch": f"{branch}.0"}, f"__{branch}", text)
        text.open(f"for i0 in range(0, n_designs, {LANES}):")
        text.add(f"n_here = min({LANES}, n_designs - i0)")
        text.add(f"width = (n_here + {MOST_LANES - 1}) & {-MOST_LANES}")
        self.write_design_loop()
        if self.curves or self.cycles:
            if self.plan.lanes == "designs":
                self.write_angle_loop()
            else:
                self.write_curve_loop()
        self.write_results()
        scratch, results = self.scratch(), results_of(self.plan)
        written = text.module(self.plan, scratch, results)
        return Source(written, len(self.plan.inputs), len(self.plan.tables), scratch, results)

    def scratch(self) -> tuple[Array, ...]:
        """Return the arrays that the kernel works in."""
        systems = sum(self.system_size(s) * len(self.suffixes(s.unknowns[0])) for s in self.systems)
        arrays = [Array("w", "float64", (max(len(self.rows), 1), LANES))]
        if systems:
            arrays.append(Array("w2", "float64", (systems, LANES)))
        if self.tile:
            arrays.append(Array("tile", "float64", (len(self.tile), TILE)))
        if self.whole_curves():
            arrays.append(Array("sums", "float64", (4, LANES)))
        wholes = dict.fromkeys(value for value, _ in self.whole_curves())
        return (*arrays, *(Array(f"whole_{value}", "float64", (N_ANGLES, LANES)) for value in wholes))

    def paste(self, steps: Sequence[Step], stores: Mapping[str, list[str]] | None = None) -> None:
        """Append steps branch by branch, and each value's lines of `stores` as soon as it is known.

        Either way fewer values wait in registers than fact by fact. For the same reason curves (`stores`) compute
        what both branches share where branch 1 first needs it; with all that first they take 5 % longer,
        while extremes take 5 % less.
        """
        shared = [step for step in steps if "branch" not in self.axes(step)]
        own = [step for step in steps if "branch" in self.axes(step)]
        first = list(steps) if stores and own else shared
        self.paste_for(first, 0, stores or {})
        for k in range(len(self.plan.branches) if own else 0):
            if k or first is shared:
                self.paste_for(own, k, stores or {})

    def paste_for(self, steps: Sequence[Step], k: int, stores: Mapping[str, list[str]]) -> None:
        """Append steps for branch number k."""
        for step in steps:
            suffix = f"__{self.plan.branches[k]}" if "branch" in self.axes(step) else ""
            copies = (self.copy_for(need, k) for need in step.depends_on)
            values = dict(zip(parameters(step.function), copies, strict=True))
            if isinstance(step, System):
                self.paste_entries(step, values, suffix, k)
            else:
                paste_fact(step, values, suffix, self.text)
            for name in step.names:
                for line in stores.get(name + suffix, ()):
                    self.text.add(line)

    def paste_entries(self, system: System, values: Mapping[str, str], suffix: str, k: int) -> None:
        """Append the entries of a linear system, into its place for branch number k."""
        start, width = k * self.system_size(system), len(system.unknowns) + 1
        paste_system(system, values, suffix, self.text, lambda r, c: f"w2[{start + r * width + c}, i]")

    def write_design_loop(self) -> None:
        """What depends on the design alone, and the accumulators' first values."""
        text, plan = self.text, self.plan
        text.open("for i in lanes(width):")
        for k, name in enumerate(plan.inputs):
            text.add(f"{name} = designs[{k}, i0 + i]")
        self.paste(self.design_steps)
        for name in dict.fromkeys((*self.lane_needs(), *(o.request.quantity for o in self.per_design))):
            text.add(f"{self.row(name)} = {name}  # {name}")
        for output, suffix, _ in self.accumulators():
            reduction = output.request.reduction
            assert reduction is not None
            slots = {slot: reduction.accumulators[key][0] for key, slot in _slots(output, suffix).items()}
            for name, initial in (slots | self.place_of(output, suffix)).items():
                if name not in self.rows:
                    text.add(f"{self.row(name)} = {initial}  # {name}")
        text.close()

    def write_angle_loop(self) -> None:
        """Lanes are designs: for each angle, all lanes; extremes stay in the lanes."""
        text = self.text
        text.open("for j in range(n_angles):")
        for k, name in enumerate(self.plan.tables):
            text.add(f"{name} = angles[{k}, j]")
        self.paste(self.angle_steps)
        stages = self.stages()
        carried = self.carried(stages)
        for number, stage in enumerate(stages):
            text.open("for i in lanes(width):")
            facts = [s for s in stage if isinstance(s, Fact)]
            made = {n for s in facts for n in s.names}
            last = number == len(stages) - 1
            for name in self.loads(stage, made, carried, last):
                text.add(f"{name} = {self.row(name)}")
            if number:
                for system in (s for s in stages[number - 1] if isinstance(s, System)):
                    self.write_unknowns(system)
            self.paste(stage)
            for name in sorted(carried[number]):
                text.add(f"{self.row(name)} = {name}  # {name}")
            if last:
                self.write_updates()
                for name in dict.fromkeys((*self.curve_copies(), *(v for v, _ in self.whole_curves()))):
                    text.add(f"{self.row('curve ' + name)} = {name}  # {name}")
            text.close()
            for step in stage:
                if isinstance(step, System):
                    self.write_solve(step)
        if self.curves:
            text.open("for i in range(n_here):")
            for output in self.curves:
                for k in range(len(self.plan.branches)):
                    name = self.copy_for(output.request.quantity, k)
                    text.add(f"out_{output.name}[i0 + i, {k}, j] = {self.row('curve ' + name)}")
            text.close()
        for value in dict.fromkeys(value for value, _ in self.whole_curves()):
            text.open("for i in lanes(width):")
            text.add(f"whole_{value}[j, i] = {self.row('curve ' + value)}")
            text.close()
        text.close()
        for value, output in self.whole_curves():
            reduction = output.request.reduction
            assert reduction is not None
            result = _whole(output, value.removeprefix(output.request.quantity))
            self.row(result)
            module, _, function = reduction.whole.rpartition(".")
            text.use(f"codegen.runtime.{module}", function)
            text.add(f"{function}(whole_{value}, w[{self.rows[result]}], n_angles, width, sums)")

    def write_unknowns(self, system: System) -> None:
        n = len(system.unknowns)
        for r, unknown in enumerate(system.unknowns):
            for suffix, k in self.suffixes(unknown):
                row = k * self.system_size(system) + r * (n + 1) + n
                self.text.add(f"{unknown}{suffix} = w2[{row}, i]")

    def write_solve(self, system: System) -> None:
        self.text.use("codegen.runtime.linear_solve", "solve_lanes")
        for _, k in self.suffixes(system.unknowns[0]):
            start, size = k * self.system_size(system), len(system.unknowns)
            self.text.add(f"solve_lanes(w2, {start}, {size}, width)")

    def write_updates(self) -> None:
        """Take the values of this angle into the accumulators."""
        self.text.use("numerics.elementary", "select", "sqrt")
        done: set[str] = set()
        for output, suffix, _ in self.accumulators():
            reduction = output.request.reduction
            assert reduction is not None
            value, slots = f"{output.request.quantity}{suffix}", _slots(output, suffix)
            better = f"{value}_{reduction.suffix}__better"
            if better not in done:
                known = {"value": value, "better": better, **slots}
                for name in slots.values():
                    if name not in done:
                        self.text.add(f"{name} = {self.row(name)}")
                if reduction.better:
                    self.text.add(f"{better} = {reduction.better.format(**known)}")
                for key, name in slots.items():
                    if name not in done:
                        update = reduction.accumulators[key][1].format(**known)
                        self.text.add(f"{self.row(name)} = {update}")
                done.update((better, *slots.values()))
            for place in self.place_of(output, suffix):
                self.text.add(f"{self.row(place)} = select({better}, {self.position}, {self.row(place)})")

    def place_of(self, output: Output, suffix: str) -> dict[str, str]:
        """Return the lane value of the place of an extreme, where it is a result, with its first value."""
        request = output.request
        if not request.place or request.reduction is None:
            return {}
        of, how = Quantity(request.quantity), request.reduction.suffix
        return {f"{Reduced(of, how, self.position)}__place{suffix}": "nan"}

    def write_curve_loop(self) -> None:
        """Lanes are angles: each design's curves go straight into the results."""
        text, stages = self.text, self.curve_stages()
        self.tile = sorted(self.carried(stages)[0])
        text.open("for i in range(n_here):")
        for name in self.lane_needs():
            text.add(f"{name} = {self.row(name)}")
        if self.tile:
            text.open(f"for piece in range(0, n_angles, {TILE}):")
            # The last piece ends where the angles end.
            text.add(f"j0 = max(min(piece, n_angles - {TILE}), 0)")
        stores: dict[str, list[str]] = {}
        for output in self.curves:
            for k in range(len(self.plan.branches)):
                value = self.copy_for(output.request.quantity, k)
                store = f"out_{output.name}[i0 + i, {k}, {self.angle}] = {value}"
                stores.setdefault(value, []).append(store)
        for stage in stages:
            self.write_curve_stage(stage, stores)
        if self.tile:
            text.close()
        text.close()

    @property
    def angle(self) -> str:
        """The index of an input position in a loop over these."""
        return "j0 + j" if self.tile else "j"

    def write_curve_stage(self, stage: Sequence[Step], stores: Mapping[str, list[str]]) -> None:
        """One loop over angles; what is made here and read in the next one waits in the tile."""
        text = self.text
        text.open(f"for j in entries({f'min({TILE}, n_angles)' if self.tile else 'n_angles'}):")
        for k, name in enumerate(self.plan.tables):
            text.add(f"{name} = angles[{k}, {self.angle}]")
        made = {name for step in stage for name in step.names}
        for row, name in enumerate(self.tile):
            if name not in made:
                text.add(f"{name} = tile[{row}, j]")
        self.paste(stage, stores)
        for row, name in enumerate(self.tile):
            if name in made:
                text.add(f"tile[{row}, j] = {name}")
        text.close()

    def write_per_design(self, counters: str) -> None:
        """Store what each design has one of."""
        self.text.open(f"for i in {counters}:")
        for output in self.per_design:
            self.text.add(f"out_{output.name}[i0 + i] = {self.row(output.request.quantity)}")
        self.text.close()

    def write_results(self) -> None:
        """Copy what each design has one of, and finish the reductions."""
        text = self.text
        if self.per_design:
            # Whole blocks are stored by vectors: one by one, types of linkages take a third longer.
            text.open(f"if n_here == {LANES}:")
            self.write_per_design(f"lanes({LANES})")
            text.close()
            text.open("else:")
            self.write_per_design("range(n_here)")
            text.close()
        if not self.cycles:
            return
        text.open("for i in range(n_here):")
        for output in self.cycles:
            reduction = output.request.reduction
            assert reduction is not None
            for k in range(len(self.plan.branches)):
                suffix = self.copy_for(output.request.quantity, k).removeprefix(output.request.quantity)
                rows = {key: self.row(name) for key, name in _slots(output, suffix).items()}
                if reduction.whole:
                    result = self.row(_whole(output, suffix))
                elif output.request.place:
                    (result,) = map(self.row, self.place_of(output, suffix))
                else:
                    result = reduction.finish.format(**rows)
                text.add(f"out_{output.name}[i0 + i, {k}] = {result}")
        text.close()


def _slots(output: Output, suffix: str) -> dict[str, str]:
    """Return the lane values of a reduction's accumulators for one branch, by what its text calls them."""
    request = output.request
    assert request.reduction is not None
    own = Reduced(Quantity(request.quantity), request.reduction.suffix)
    return {
        key: f"{request.quantity if pair == COUNT else own}__{key}{suffix}"
        for key, pair in request.reduction.accumulators.items()
    }


def _whole(output: Output, suffix: str) -> str:
    """Return the lane value of a reduction of a whole curve for one branch."""
    request = output.request
    assert request.reduction is not None
    return f"{Reduced(Quantity(request.quantity), request.reduction.suffix)}__whole{suffix}"


def results_of(plan: Program | ExtremaProgram) -> tuple[Array, ...]:
    """Return the arrays of a plan's results: designs, then branches, then input positions or extremes."""
    lengths = {"branch": len(plan.branches)}
    return tuple(
        Array(f"out_{o.name}", o.dtype, (None, *(lengths.get(axis) for axis in o.axes))) for o in plan.outputs
    )


def write_kernel(plan: Program) -> Source:
    """Return the text of the plan's kernel, and what it is called with."""
    return _Writer(plan).write()

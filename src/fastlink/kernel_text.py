"""The text of a kernel: which loop a value stands in, and where it is kept.

Lanes are designs (blocks of `LANES`, outer loop over the angles) whenever something is taken over the
cycle, because a running extreme kept in a scalar stops vectorisation; lanes are angles for curves alone,
because then each curve is written as it lies in the file. All lane values live in one scratch array with
constant rows: one base pointer needs no alias checks, and with many arrays those checks end vectorisation.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastlink.catalogue import Fact, System
from fastlink.emit import Text, paste_fact, paste_system

if TYPE_CHECKING:
    from collections.abc import Iterable

    from fastlink.plan import Output, Plan

__all__ = ["LANES", "scratch_sizes", "write_kernel"]

LANES = 64
HEADER = '''"""Kernel of {mechanism}, written by fastlink: {names}."""

from numpy import inf, nan, sqrt
{imports}

'''


class _Writer:
    """State of one kernel while it is written."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.text = Text()
        self.rows: dict[str, int] = {}
        self.position = plan.catalogue.position.name
        self.lane_steps = [s for s in plan.steps if self.axes(s) >= {"design", self.position}]
        self.design_steps = [
            s for s in plan.steps if self.position not in self.axes(s) and "design" in self.axes(s)
        ]
        self.angle_steps = [s for s in plan.steps if self.axes(s) == {self.position}]
        self.constant_steps = [s for s in plan.steps if self.axes(s) <= {"branch"}]
        self.systems = [s for s in self.lane_steps if isinstance(s, System)]
        self.curves = [o for o in plan.outputs if self.position in o.axes]
        self.cycles = [o for o in plan.outputs if o.request.reduction is not None]
        self.per_design = [o for o in plan.outputs if not o.axes]

    # -- names and places ------------------------------------------------------------------------

    def axes(self, step: Fact | System) -> frozenset[str]:
        name = step.unknowns[0] if isinstance(step, System) else step.name
        return self.plan.axes[name]

    def suffixes(self, name: str) -> list[tuple[str, int]]:
        """Return the copies of a value: one, or one for each branch, with the branch's place."""
        if "branch" in self.plan.axes[name]:
            return [(f"__{branch}", k) for k, branch in enumerate(self.plan.branches)]
        return [("", 0)]

    def copy_for(self, name: str, branch: int) -> str:
        """Return the kernel's name of a value for one branch."""
        copies = self.suffixes(name)
        return name + copies[min(branch, len(copies) - 1)][0]

    def row(self, name: str) -> str:
        """Return the place of a lane value in the scratch array, reserving it on first use."""
        row = self.rows.setdefault(name, len(self.rows))
        return f"w[{row * LANES} + i]"

    def lane_needs(self) -> list[str]:
        """Return what the lane loop reads of the design: inputs and facts of the design."""
        return self._outside_needs(self.lane_steps, {"design"}, {"design", "branch"})

    def _outside_needs(self, steps: Iterable[Fact | System], *kinds: set[str]) -> list[str]:
        needs = [need for step in steps for need in step.needs]
        needs += [o.request.quantity for o in (*self.curves, *self.cycles)]
        made = {name for step in self.lane_steps for name in _names(step)}
        wanted = [
            n for n in dict.fromkeys(needs) if n not in made and self.plan.axes[n] in map(frozenset, kinds)
        ]
        return [n + suffix for n in wanted for suffix, _ in self.suffixes(n)]

    # -- pasting ---------------------------------------------------------------------------------

    def paste(self, step: Fact | System, store: str = "") -> None:
        """Append a step, once or for each branch."""
        for suffix, k in self.suffixes(_names(step)[0]):
            values = {need: self.copy_for(need, k) for need in step.needs}
            if isinstance(step, System):
                start = k * self.system_size(step)
                width = len(step.unknowns) + 1
                paste_system(
                    step,
                    values,
                    suffix,
                    self.text,
                    lambda r, c, at=start, n=width: f"m[{(at + r * n + c) * LANES} + i]",
                )
            else:
                paste_fact(step, values, suffix, self.text)

    @staticmethod
    def system_size(step: System) -> int:
        return len(step.unknowns) * (len(step.unknowns) + 1)

    # -- the kernel ------------------------------------------------------------------------------

    def write(self) -> str:
        text = self.text
        outputs = ", ".join(f"out_{o.name}" for o in self.plan.outputs)
        text.open(f"def kernel(x, angles, n, n_angles, w, m, {outputs}):")
        for step in self.constant_steps:
            for k, branch in enumerate(self.plan.branches):
                assert isinstance(step, Fact)
                paste_fact(step, {"branch": f"{branch}.0"}, f"__{branch}", text)
                del k
        text.open(f"for i0 in range(0, n, {LANES}):")
        text.add(f"lanes = min({LANES}, n - i0)")
        self.write_design_loop()
        if self.curves or self.cycles:
            if self.plan.lanes == "designs":
                self.write_angle_loop()
            else:
                self.write_curve_loop()
        self.write_results()
        names = ", ".join(o.name for o in self.plan.outputs)
        imports = "\n".join(
            f"from {module} import {', '.join(sorted(found))}"
            for module, found in sorted(text.imports.items())
        )
        header = HEADER.format(mechanism=self.plan.catalogue.name, names=names, imports=imports)
        return header + "\n".join(text.lines) + "\n"

    def write_design_loop(self) -> None:
        """What depends on the design alone, and the accumulators' first values."""
        text, plan = self.text, self.plan
        text.open(f"for i in range({LANES}):")
        for k, name in enumerate(plan.inputs):
            text.add(f"{name} = x[{k}, i0 + i]")
        for step in self.design_steps:
            self.paste(step)
        for name in dict.fromkeys((*self.lane_needs(), *(o.request.quantity for o in self.per_design))):
            text.add(f"{self.row(name)} = {name}  # {name}")
        for output, suffix, _ in self.accumulators():
            reduction = output.request.reduction
            assert reduction is not None
            for name, initial in _slots(output, suffix, self.position, reduction.initial):
                if name not in self.rows:
                    text.add(f"{self.row(name)} = {initial}  # {name}")
        text.close()

    def accumulators(self) -> list[tuple[Output, str, int]]:
        return [(o, suffix, k) for o in self.cycles for suffix, k in self.suffixes(o.request.quantity)]

    def write_angle_loop(self) -> None:
        """Lanes are designs: for each angle, all lanes; extremes stay in the lanes."""
        text = self.text
        text.open("for j in range(n_angles):")
        for k, name in enumerate(self.plan.tables):
            text.add(f"{name} = angles[{k}, j]")
        for step in self.angle_steps:
            self.paste(step)
        stages = self.stages()
        carried = self.carried(stages)
        for number, stage in enumerate(stages):
            text.open(f"for i in range({LANES}):")
            facts = [s for s in stage if isinstance(s, Fact)]
            made = {n for s in facts for n in _names(s)}
            last = number == len(stages) - 1
            for name in self.loads(stage, made, carried, last):
                text.add(f"{name} = {self.row(name)}")
            if number:
                for system in (s for s in stages[number - 1] if isinstance(s, System)):
                    self.write_unknowns(system)
            for step in stage:
                self.paste(step)
            for name in sorted(carried[number]):
                text.add(f"{self.row(name)} = {name}  # {name}")
            if last:
                self.write_updates()
                for name in dict.fromkeys(self.curve_copies()):
                    text.add(f"{self.row('curve ' + name)} = {name}  # {name}")
            text.close()
            for step in stage:
                if isinstance(step, System):
                    self.write_solve(step)
        if self.curves:
            text.open("for i in range(lanes):")
            for output in self.curves:
                for k in range(len(self.plan.branches)):
                    name = self.copy_for(output.request.quantity, k)
                    text.add(f"out_{output.name}[i0 + i, {k}, j] = {self.row('curve ' + name)}")
            text.close()
        text.close()

    def curve_copies(self) -> list[str]:
        return [
            o.request.quantity + suffix
            for o in self.curves
            for suffix, _ in self.suffixes(o.request.quantity)
        ]

    def stages(self) -> list[list[Fact | System]]:
        """Split the lane steps after each linear system, which is solved outside the lane loop.

        Steps that no system waits for stand in the last stage, next to their use.
        """
        if not self.systems:
            return [self.lane_steps]
        needed: set[str] = set()
        before: list[Fact | System] = []
        for step in reversed(self.lane_steps):
            if isinstance(step, System) or any(name in needed for name in _names(step)):
                needed.update(step.needs)
                before.insert(0, step)
        after = [step for step in self.lane_steps if step not in before]
        return [before, after]

    def carried(self, stages: list[list[Fact | System]]) -> list[set[str]]:
        """Return for each stage the values that later ones read."""
        result: list[set[str]] = []
        for number, stage in enumerate(stages):
            made = {name for step in stage if isinstance(step, Fact) for name in _names(step)}
            later = {need for rest in stages[number + 1 :] for step in rest for need in step.needs}
            later |= (
                {o.request.quantity for o in (*self.curves, *self.cycles)}
                if number < len(stages) - 1
                else set()
            )
            result.append({name + suffix for name in made & later for suffix, _ in self.suffixes(name)})
        return result

    def loads(
        self, stage: list[Fact | System], made: set[str], carried: list[set[str]], last: bool
    ) -> list[str]:
        """Return the lane values that a stage reads from scratch."""
        needs = [need for step in stage for need in step.needs]
        if last:
            needs += [o.request.quantity for o in (*self.curves, *self.cycles)]
        earlier = set().union(*carried)
        names = [n + suffix for n in dict.fromkeys(needs) if n not in made for suffix, _ in self.suffixes(n)]
        return [name for name in names if name in earlier or name in self.lane_needs()]

    def write_unknowns(self, system: System) -> None:
        n = len(system.unknowns)
        for r, unknown in enumerate(system.unknowns):
            for suffix, k in self.suffixes(unknown):
                self.text.add(
                    f"{unknown}{suffix} = m[{(k * self.system_size(system) + r * (n + 1) + n) * LANES} + i]"
                )

    def write_solve(self, system: System) -> None:
        self.text.imports.setdefault("fastlink.dense", set()).add("solve_lanes")
        for _, k in self.suffixes(system.unknowns[0]):
            self.text.add(
                f"solve_lanes(m.reshape(m.size // {LANES}, {LANES}), {k * self.system_size(system)}, {len(system.unknowns)})"
            )

    def write_updates(self) -> None:
        """Take the values of this angle into the accumulators."""
        done: set[str] = set()
        for output, suffix, _ in self.accumulators():
            reduction = output.request.reduction
            assert reduction is not None
            value, acc, place, count = _slot_names(output, suffix, self.position)
            wants_place = output.request.place
            better = f"{acc}__better"
            if acc not in done:
                self.text.add(f"{acc} = {self.row(acc)}")
                if reduction.better:
                    self.text.add(f"{better} = {reduction.better.format(value=value, acc=acc)}")
                update = reduction.update.format(value=value, acc=acc, better=better)
                self.text.add(f"{self.row(acc)} = {update}")
                done.add(acc)
            if wants_place:
                self.text.add(f"{self.row(place)} = {self.position} if {better} else {self.row(place)}")
            if reduction.count_update and count not in done:
                update = reduction.count_update.format(value=value, count=self.row(count))
                self.text.add(f"{self.row(count)} = {update}")
                done.add(count)

    def write_curve_loop(self) -> None:
        """Lanes are angles: for each tile of angles and each design, curves in scratch, then copied out."""
        text, tile = self.text, self.plan.tile
        curves = list(dict.fromkeys(self.curve_copies()))
        text.open(f"for j0 in range(0, n_angles, {tile}):")
        text.add(f"width = min({tile}, n_angles - j0)")
        # Indices that are constants plus the loop variable need no check of their sign, so they vectorise.
        places = {name: f"m[{(len(curves) + k) * tile} + j]" for k, name in enumerate(self.plan.tables)}
        text.open(f"for j in range({tile}):")
        for k, place in enumerate(places.values()):
            text.add(f"{place} = angles[{k}, j0 + j]")
        text.close()
        text.open("for i in range(lanes):")
        for name in self.lane_needs():
            text.add(f"{name} = {self.row(name)}")
        text.open(f"for j in range({tile}):")
        for name, place in places.items():
            text.add(f"{name} = {place}")
        for step in (*self.angle_steps, *self.lane_steps):
            self.paste(step)
        for k, name in enumerate(curves):
            text.add(f"m[{k * tile} + j] = {name}")
        text.close()
        for output in self.curves:
            for k in range(len(self.plan.branches)):
                at = curves.index(self.copy_for(output.request.quantity, k)) * tile
                text.add(f"curve = out_{output.name}[i0 + i, {k}, j0 : j0 + width]")
                text.open("for j in range(width):")
                text.add(f"curve[j] = m[{at} + j]")
                text.close()
        text.close()
        text.close()

    def write_results(self) -> None:
        """Copy what each design has one of, and finish the reductions."""
        text = self.text
        if not (self.per_design or self.cycles):
            return
        text.open("for i in range(lanes):")
        for output in self.per_design:
            text.add(f"out_{output.name}[i0 + i] = {self.row(output.request.quantity)}")
        for output in self.cycles:
            reduction = output.request.reduction
            assert reduction is not None
            for k in range(len(self.plan.branches)):
                suffix = self.copy_for("", k) if False else self.copy_for(output.request.quantity, k)
                suffix = suffix.removeprefix(output.request.quantity)
                _, acc, place, count = _slot_names(output, suffix, self.position)
                if output.request.place:
                    result = self.row(place)
                else:
                    result = reduction.finish.format(acc=self.row(acc), count=self.row(count))
                text.add(f"out_{output.name}[i0 + i, {k}] = {result}")
        text.close()


def _names(step: Fact | System) -> tuple[str, ...]:
    return step.unknowns if isinstance(step, System) else (step.name,)


def _slot_names(output: Output, suffix: str, position: str) -> tuple[str, str, str, str]:
    """Return the names of the value, accumulator, place and count of one reduction and branch."""
    request = output.request
    assert request.reduction is not None
    acc = f"{request.quantity}_{request.reduction.suffix}{suffix}"
    return f"{request.quantity}{suffix}", acc, f"{position}_at_{acc}", f"count_{request.quantity}{suffix}"


def _slots(output: Output, suffix: str, position: str, initial: str) -> list[tuple[str, str]]:
    """Return the accumulators that one reduction needs, with their first values."""
    _, acc, place, count = _slot_names(output, suffix, position)
    slots = [(acc, initial)]
    if output.request.place:
        slots.append((place, "nan"))
    if output.request.reduction is not None and output.request.reduction.count_update:
        slots.append((count, "0.0"))
    return slots


def scratch_sizes(plan: Plan) -> tuple[int, int]:
    """Return the lengths of the kernel's two scratch arrays."""
    writer = _Writer(plan)
    writer.write()
    systems = sum(writer.system_size(s) * len(writer.suffixes(s.unknowns[0])) for s in writer.systems) * LANES
    tiles = (len(set(writer.curve_copies())) + len(plan.tables)) * plan.tile
    return max(len(writer.rows), 1) * LANES, max(systems, tiles, 1)


def write_kernel(plan: Plan) -> str:
    """Return the text of the plan's kernel.

    The kernel takes the design array (inputs, padded designs), the angle array (tables, padded angles), the
    numbers of designs and angles, two scratch arrays, and one output array for each result.
    """
    return _Writer(plan).write()

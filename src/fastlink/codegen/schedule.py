"""Which loop of a kernel a value stands in, and where it is kept.

A value that the design alone determines stands in the loop over designs, one that the angle alone determines
in the loop over angles, all others in the lanes. Lane values that one loop leaves to the next are rows of a
scratch array.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import TYPE_CHECKING

from fastlink.facts.fact import Fact, System, statements

if TYPE_CHECKING:
    from fastlink.plan.program import Output, Program

__all__ = ["Schedule", "Step"]

Step = Fact | System

# A lane loop of fewer facts than this is short enough for the processor to look past its roots and divisions.
FEW_STEPS = 24


class Schedule:
    """The steps of a plan by loop, and the places of lane values."""

    def __init__(self, plan: Program) -> None:
        self.plan = plan
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

    def axes(self, step: Step) -> frozenset[str]:
        """Return what the values of a step depend on."""
        return self.plan.axes[step.names[0]]

    def suffixes(self, name: str) -> list[tuple[str, int]]:
        """Return the copies of a value: one, or one for each branch, with the branch's place."""
        if "branch" in self.plan.axes[name]:
            return [(f"__{branch}", k) for k, branch in enumerate(self.plan.branches)]
        return [("", 0)]

    def copy_for(self, name: str, branch: int) -> str:
        """Return the kernel's name of a value for one branch; the branch itself is a number."""
        if name == "branch":
            return f"{self.plan.branches[branch]}.0"
        copies = self.suffixes(name)
        return name + copies[min(branch, len(copies) - 1)][0]

    def row(self, name: str) -> str:
        """Return the place of a lane value in the scratch array, reserving it on first use."""
        row = self.rows.setdefault(name, len(self.rows))
        return f"w[{row}, i]"

    def lane_needs(self) -> list[str]:
        """Return what the lane loop reads of the design: inputs and facts of the design."""
        return self._outside_needs(self.lane_steps, {"design"}, {"design", "branch"})

    def _outside_needs(self, steps: Sequence[Step], *kinds: set[str]) -> list[str]:
        depends_on = [need for step in steps for need in step.depends_on]
        depends_on += [o.request.quantity for o in (*self.curves, *self.cycles)]
        made = {name for step in self.lane_steps for name in step.names}
        wanted = [
            n
            for n in dict.fromkeys(depends_on)
            if n not in made and self.plan.axes[n] in map(frozenset, kinds)
        ]
        return [n + suffix for n in wanted for suffix, _ in self.suffixes(n)]

    def accumulators(self) -> list[tuple[Output, str, int]]:
        """Return what is taken over the cycle, once for each copy of its quantity."""
        reduced = [o for o in self.cycles if o.request.reduction and not o.request.reduction.whole]
        return [(o, suffix, k) for o in reduced for suffix, k in self.suffixes(o.request.quantity)]

    def whole_curves(self) -> list[tuple[str, Output]]:
        """Return the values whose whole cycle is needed at once, with what is taken of them."""
        wholes = [o for o in self.cycles if o.request.reduction and o.request.reduction.whole]
        return [(o.request.quantity + s, o) for o in wholes for s, _ in self.suffixes(o.request.quantity)]

    def curve_copies(self) -> list[str]:
        """Return the kernel's names of all values that are stored as curves."""
        return [
            o.request.quantity + suffix
            for o in self.curves
            for suffix, _ in self.suffixes(o.request.quantity)
        ]

    @staticmethod
    def system_size(step: System) -> int:
        """Return the number of entries of a linear system, its right-hand side included."""
        return len(step.unknowns) * (len(step.unknowns) + 1)

    def stages(self) -> list[list[Step]]:
        """Split the lane steps into loops over the lanes.

        First the roots and divisions that both branches share, with what they need: in one loop with the rest,
        their latency is longer than the processor looks ahead (25 % on extremes with reactions). Then what a
        linear system needs, which is solved outside the lane loop, and last all the rest.
        """
        roots = [s for s in self.lane_steps if "branch" not in self.axes(s) and _is_slow(s)]
        if len(self.lane_steps) < FEW_STEPS:
            roots = []
        first = self.needed_for(roots)
        second = [step for step in self.needed_for(self.systems) if step not in first]
        rest = [step for step in self.lane_steps if step not in first and step not in second]
        # After a system there is always a loop, if only to load the unknowns.
        return [*(stage for stage in (first, second) if stage), rest]

    def curve_stages(self) -> list[list[Step]]:
        """Split the steps of curves, whose lanes are angles, into loops: what shared logarithms take, then the rest.

        A logarithm and the root before it are a chain of 100 cycles and more (33 % on psi of the Minkowskian 4R).
        Roots and divisions alone are short enough: there a split gains nothing.
        """
        steps = [*self.angle_steps, *self.lane_steps]
        logs = [s for s in self.lane_steps if "branch" not in self.axes(s) and _names(s, ("log_quotient",))]
        names = {name for step in logs for name in step.names}
        first = [step for step in self.needed_for(logs) if step not in logs]
        if not first or any(names.intersection(step.depends_on) for step in first):
            return [steps]
        first = [*self.angle_steps, *first]
        return [first, [step for step in steps if step not in first]]

    def needed_for(self, wanted: Sequence[Step]) -> list[Step]:
        """Return the lane steps that `wanted` need, and themselves."""
        needed = {name for step in wanted for name in step.names}
        found: list[Step] = []
        for step in reversed(self.lane_steps):
            if needed.intersection(step.names):
                needed.update(step.depends_on)
                found.insert(0, step)
        return found

    def carried(self, stages: list[list[Step]]) -> list[set[str]]:
        """Return for each stage the values that later ones read."""
        result: list[set[str]] = []
        for number, stage in enumerate(stages):
            made = {name for step in stage if isinstance(step, Fact) for name in step.names}
            later = {need for rest in stages[number + 1 :] for step in rest for need in step.depends_on}
            later |= (
                {o.request.quantity for o in (*self.curves, *self.cycles)}
                if number < len(stages) - 1
                else set()
            )
            result.append({name + suffix for name in made & later for suffix, _ in self.suffixes(name)})
        return result

    def loads(self, stage: list[Step], made: set[str], carried: list[set[str]], last: bool) -> list[str]:
        """Return the lane values that a stage reads from scratch."""
        depends_on = [need for step in stage for need in step.depends_on]
        if last:
            depends_on += [o.request.quantity for o in (*self.curves, *self.cycles)]
        earlier = set().union(*carried)
        names = [
            n + suffix for n in dict.fromkeys(depends_on) if n not in made for suffix, _ in self.suffixes(n)
        ]
        return [name for name in names if name in earlier or name in self.lane_needs()]


def _is_slow(step: Step) -> bool:
    """Tell whether a fact takes a root or divides."""
    if isinstance(step, System):
        return False
    divides = any(isinstance(node, ast.Div) for node in _nodes(step))
    return divides or _names(step, ("sqrt", "atan2", "log_quotient"))


def _nodes(step: Fact) -> list[ast.AST]:
    return [node for statement in statements(step.function) for node in ast.walk(statement)]


def _names(step: Step, functions: tuple[str, ...]) -> bool:
    """Tell whether the text of a fact names one of these functions."""
    return isinstance(step, Fact) and any(
        isinstance(node, ast.Name) and node.id in functions for node in _nodes(step)
    )

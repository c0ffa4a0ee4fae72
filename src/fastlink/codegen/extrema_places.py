"""The parts of a kernel of a search that evaluate at places: the sampled function, the quantity, derivatives by inputs.

Derivatives by inputs are evaluated once all extremes of a quantity are known, where the greatest and the least value
are: at one input position, or at limits of motion at a place that moves with them, see
`fastlink.codegen.runtime.winners`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from fastlink.codegen.extrema_schedule import ExtremaSchedule
from fastlink.codegen.runtime import cells, ends, roots, winners
from fastlink.codegen.runtime.cells import LANES, MOST_LANES, STATE_ROWS
from fastlink.codegen.source import Text, paste_fact

if TYPE_CHECKING:
    from fastlink.facts.fact import Fact
    from fastlink.plan.program import ExtremaProgram, ExtremumSearch, Gradient, Output

__all__ = ["PlacesWriter"]

#: The functions that evaluate derivatives by inputs: at one input position, and at limits of motion.
FUNCTIONS = ("gradient", "limit")


class PlacesWriter(ExtremaSchedule):
    """One kernel while it is written: where it evaluates at places."""

    def __init__(self, program: ExtremaProgram) -> None:
        super().__init__(program)
        self.text = Text()

    def write_position(self, position: str, upper: str) -> None:
        """Write the distances of a position from the near and the far end, over the width."""
        near, far, _ = self.program.graded.coordinates
        self.text.add(f"square = {position} * {position}")
        self.text.add("rest = 1.0 / (1.0 + square)")
        self.text.add(f"{near} = rest if {upper} else square * rest")
        self.text.add(f"{far} = square * rest if {upper} else rest")

    def paste(self, step: Fact, suffix: str = "") -> None:
        """Append a fact, reading the copies of one branch."""
        values = [self.copy_for(name, suffix) for name in step.depends_on]
        paste_fact(step, values, self.suffix_for(step.name, suffix), self.text)

    def write_evaluations(self, number: int, search: ExtremumSearch) -> None:
        """Write functions of their own: the sampled function at the positions of items, and the quantity there."""
        quantity, position = search.quantity, self.program.catalogue.position.name
        with self.evaluation(f"slope_{number}", "place", f"each step of the search of {quantity}"):
            self.write_values(
                self.slope_names(search), {cells.F: self.scaled(search)}, self.item_needs(search)
            )
        with self.evaluation(f"value_{number}", "extreme", f"once, of {quantity}"):
            stores = {cells.VALUE: quantity, cells.THETA: position}
            if self.program.mirrored:
                self.text.use("codegen.runtime.results", "mirror_image")
                stores[cells.IMAGE] = f"mirror_image({position}, {2.0 * self.program.graded.axis})"
            names = [quantity, position]
            if search.bounded_by:
                names += search.bounded_by
                bound, slope_bound, bend, slope = search.bounded_by
                stores |= {cells.BOUND: bound, cells.SLOPE_BOUND: slope_bound}
                stores |= {cells.BEND: f"abs({bend})", cells.SLOPE: f"abs({slope})"}
            self.write_values(names, stores, self.item_needs(search))
        self.write_gradient_functions(number, search)

    @contextmanager
    def evaluation(self, name: str, per: str, times: str) -> Iterator[None]:
        """Append the head of a function of the state, and its loop over the vectors of items."""
        text = self.text
        text.add("@outlined")
        with text.block(f"def {name}(state, vectors, n_vectors):"), text.block("for v in range(n_vectors):"):
            text.add("at = vectors[v]")
            with text.block(f"for i in lanes({MOST_LANES}):", per, times):
                yield
        text.lines += ["", ""]

    def write_values(self, names: Sequence[str], stores: Mapping[int, str], carried: Sequence[str]) -> None:
        """Write values at the positions of items, which carry values of the design, and their stores in the state."""
        text = self.text
        text.add(f"upper = state[{cells.UPPER}, at + i] > 0.0")
        self.write_position(f"state[{cells.X}, at + i]", "upper")
        self.write_half(f"state[{cells.HALF}, at + i]")
        steps = self.needed_for(names)
        own = [name for name in names if self.program.axes[name] <= {"design"}]
        for name in dict.fromkeys([*self.design_needs(steps), *own]):
            text.add(f"{name} = state[{STATE_ROWS + carried.index(name)}, at + i]")
        for step in steps:
            self.paste(step)
        for row, value in stores.items():
            text.add(f"state[{row}, at + i] = {value}")

    def write_half(self, half: str) -> None:
        """Write branch and side of a half: halves are numbered branch by branch, both sides of each."""
        side, (first, *others) = self.program.graded.coordinates[2], self.program.searched_branches
        sides = self.program.sides
        above = f"1.0 if ({half} == 0.0) | ({half} == 2.0) else -1.0"
        self.text.add(f"{side} = {above if sides == 2 else '1.0'}")
        former = f"{first}.0 if {half} <= {sides - 1.0} else " if others else ""
        self.text.add(f"branch = {former}{[first, *others][-1]}.0")

    def write_gradients(self, number: int) -> None:
        """Write the derivatives at the greatest and least values of a search, as far as they are requested."""
        text, search = self.text, self.program.searches[number]
        own = [o for o in self.program.outputs if o.request.quantity == search.quantity and not search.onto]
        own = [output for output in own if output.request.is_of_gradient]
        if not own:
            return
        magnitude = int(search.magnitude)
        text.call(winners.judge_winners, f"winners, w, n_here, table, search_{number}, {magnitude}")
        for sign in sorted({_sign(output) for output in own if output.inputs}):
            for at_limit, function in enumerate(FUNCTIONS):
                pick = f"pick_{number}_{int(sign < 0)}_{at_limit}"
                text.add(f"{pick} = array({self.pick(number, sign, at_limit)})")
                text.call(winners.collect_winners, f"winners, w, n_here, table, {pick}, ends", "n_ends")
                with text.block(f"for start in range(0, n_ends, {LANES}):"):
                    text.call(cells.gather, f"ends, start, n_ends, w, places_{number}, state", "filled")
                    text.call(ends.place_ends, "state, filled, 1.0")
                    text.call(roots.every_vector, "vectors, filled", "n_open")
                    text.add(f"{function}_{number}(state, vectors, n_open)")
                    text.call(winners.take_gradients, f"state, filled, {pick}, gradients")
            if any(other.jumps and other.onto == search.quantity for other in self.program.searches):
                text.call(winners.settle_jumps, f"winners, n_here, table, {pick}, gradients")

    @property
    def gradient_signs(self) -> set[int]:
        """The signs of the extremes whose derivatives or status are requested."""
        return {_sign(output) for output in self.program.outputs if output.request.is_of_gradient}

    def pick(self, number: int, sign: int, at_limit: int) -> list[int]:
        """Return the table of derivatives that are evaluated together, see `runtime.winners`."""
        search = self.program.searches[number]
        n_values = sum(not gradient.is_position for gradient in search.gradients)
        rows = [self.gradient_row, len(search.gradients), n_values, self.gradient_base(sign)]
        return [number, int(sign < 0), at_limit, *rows, search.parity]

    def write_gradient_functions(self, number: int, search: ExtremumSearch) -> None:
        """Write the functions of their own that evaluate derivatives at the places of items."""
        if not search.gradients:
            return
        for at_limit, function in enumerate(FUNCTIONS):
            stores: dict[int, str] = {}
            names: list[str] = []
            for k, gradient in enumerate(search.gradients):
                stores[self.gradient_row + k], read = _text(gradient, at_limit > 0)
                names += read
            with self.evaluation(
                f"{function}_{number}", "extreme", f"once, for derivatives of {search.quantity}"
            ):
                self.write_values(names, stores, self.gradient_needs(search))

    def write_gradient_result(self, output: Output, number: int) -> None:
        """Write the copy of a derivative of extremes, of their status, or of a change by tolerances."""
        request, search = output.request, self.program.searches[number]
        target, first = f"out_{output.name}, i0, n_here", number * len(self.program.branches) * LANES
        if request.is_status:
            row = winners.WINNER_ROWS * (_sign(output) < 0) + winners.CODE
            self.text.call(winners.store_status, f"{target}, {first}, winners, {row}")
            return
        kinds = [(one.by, one.is_position) for one in search.gradients]
        base = self.gradient_base(_sign(output))
        rows = [base + kinds.index((by, request.is_position)) for by in output.inputs]
        if not request.change:
            self.text.call(winners.store_gradient, f"{target}, {first}, gradients, {rows[0]}")
            return
        table, tolerances = f"{output.name}__terms", [self.row(term.tolerance) for term in output.terms]
        self.text.add(
            f"{table} = array({[first, int(request.change == 'rss'), len(rows), *rows, *tolerances]})"
        )
        self.text.call(winners.store_change, f"{target}, gradients, w, {table}")


def _text(gradient: Gradient, at_limit: bool) -> tuple[str, tuple[str, ...]]:
    """Return the kernel text of a derivative, and the values that it reads."""
    if at_limit:
        return (gradient.moving, (gradient.moving,)) if gradient.moving else ("0.0", ())
    if not gradient.held:
        return "0.0", ()
    if gradient.is_position:
        along, bend = gradient.held
        return f"-({along} / {bend})", gradient.held
    return gradient.held[0], gradient.held


def _sign(output: Output) -> int:
    """Return 1 for greatest values, -1 for least ones, 0 for a list."""
    reduction = output.request.reduction
    return reduction.sign if reduction is not None else 0

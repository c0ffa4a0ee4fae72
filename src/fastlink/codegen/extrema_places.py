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
from fastlink.codegen.runtime import cells, winners
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
        quantity = search.quantity
        with self.evaluation(f"slope_{number}", "place", f"each step of the search of {quantity}"):
            self.write_values(
                self.slope_names(search), {cells.F: self.scaled(search)}, self.item_needs(search)
            )
        if search.splits:
            return
        with self.evaluation(f"value_{number}", "extreme", f"once, of {quantity}"):
            stores, names = {cells.VALUE: quantity}, [quantity, *self.places_wanted]
            # any number will do where places are not wanted: an arc tangent is half of a function such as omega4
            stores[cells.THETA] = stores[cells.IMAGE] = "0.0"
            for position in self.places_wanted:
                stores[cells.THETA] = position
                if self.program.mirrored:
                    self.text.use("codegen.runtime.results", "mirror_image")
                    stores[cells.IMAGE] = f"mirror_image({position}, {2.0 * self.program.graded.axis})"
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
        asked = [int(sign in self.gradient_signs) for sign in (1, -1)]
        text.add(f"asked_{number} = array({[*asked, int(search.magnitude), int(search.folds)]})")
        columns = len(self.program.branches) * LANES
        text.add(f"columns_{number} = array({[number * columns, (number + 1) * columns]})")
        judged = f"winners, w, n_here, table, search_{number}, asked_{number}"
        text.call(winners.judge_winners, judged, "n_moving")
        signs = sorted({_sign(output) for output in own if output.inputs})
        calls = {sign: self.gradient_arguments(number, sign) for sign in signs}
        for arguments in calls.values():
            text.add(f"gradient_{number}({arguments})")
        if any(gradient.moving for gradient in search.gradients):
            with text.block("if n_moving > 0:"):
                self.write_late(search)
                for arguments in calls.values():
                    text.add(f"limit_{number}({arguments})")
        if search.folds or any(o.jumps and o.onto == search.quantity for o in self.program.searches):
            values = sum(not gradient.is_position for gradient in search.gradients)
            for sign in signs:
                row, base = winners.WINNER_ROWS * (sign < 0), self.gradient_base(sign)
                text.call(
                    winners.settle_jumps, f"winners, {row}, columns_{number}, gradients, {base}, {values}"
                )

    @property
    def gradient_signs(self) -> set[int]:
        """The signs of the extremes whose derivatives or status are requested."""
        return {_sign(output) for output in self.program.outputs if output.request.is_of_gradient}

    def gradient_arguments(self, number: int, sign: int) -> str:
        """Return what a function of derivatives is called with: arrays, first rows and columns, the width."""
        row, base = winners.WINNER_ROWS * (sign < 0), self.gradient_base(sign)
        return f"w, winners, gradients, {row}, {base}, columns_{number}, width"

    def write_late(self, search: ExtremumSearch) -> None:
        """Write the design values that only derivatives along with limits of motion need."""
        text = self.text
        late = [name for name in self.gradient_needs(search, moving=True) if name in self.late]
        early = self.rows.keys() - self.late
        steps, needed = [], set(late)
        for step in reversed(self.design_steps):
            if needed.intersection(step.names) - early:
                steps.append(step)
                needed.update(step.depends_on)
        with text.block("for i in lanes(width):", "design", f"for {search.quantity} at limits of motion"):
            read = {name for step in steps for name in step.depends_on}
            for k, name in enumerate(self.program.inputs):
                if name in read | set(late) and name not in early:
                    text.add(f"{name} = designs[{k}, i0 + i]")
            for name in sorted(read & early):
                text.add(f"{name} = w[{self.row(name)}, i]")
            for step in reversed(steps):
                paste_fact(step, step.depends_on, "", text)
            for name in late:
                text.add(f"w[{self.row(name)}, i] = {name}")

    def write_gradient_functions(self, number: int, search: ExtremumSearch) -> None:
        """Write the functions of their own that evaluate derivatives, lanes being designs."""
        for at_limit, function in enumerate(FUNCTIONS):
            if search.gradients and (not at_limit or any(one.moving for one in search.gradients)):
                self.write_gradient_function(f"{function}_{number}", search, at_limit > 0)

    def write_gradient_function(self, name: str, search: ExtremumSearch, at_limit: bool) -> None:
        """Write the function that evaluates derivatives at one input position, or along with limits of motion."""
        text, wanted = self.text, winners.ALONG if at_limit else winners.HELD
        needs = self.gradient_needs(search, moving=at_limit)
        times = f"for derivatives of {search.quantity}" + (" at limits of motion" if at_limit else "")
        text.add("@outlined")
        with (
            text.block(f"def {name}(w, winners, gradients, row__0, base__0, columns__of, width):"),
            text.block(f"for column__0 in range(columns__of[0], columns__of[1], {LANES}):"),
            text.block("for i in lanes(width):", "extreme", times),
        ):
            text.add(f"x__of = winners[row__0 + {winners.AT_X}, column__0 + i]")
            text.add(f"upper = winners[row__0 + {winners.IN_UPPER}, column__0 + i] > 0.0")
            self.write_position("x__of", "upper")
            text.add(f"half__of = winners[row__0 + {winners.IN_HALF}, column__0 + i]")
            self.write_half("half__of")
            for need in needs:
                text.add(f"{need} = w[{self.row(need)}, i]")
            for step in self.needed_for(self.gradient_names(search, moving=at_limit)):
                self.paste(step)
            text.add(f"mirrored__of = winners[row__0 + {winners.MIRRORED}, column__0 + i] > 0.0")
            text.add(f"counts__of = winners[row__0 + {winners.WHERE}, column__0 + i] == {wanted}")
            for k, gradient in enumerate(search.gradients):
                target = f"gradients[base__0 + {k}, column__0 + i]"
                text.add(f"slope__{k} = {_text(gradient, at_limit)}")
                if gradient.is_position or search.parity < 0:
                    text.add(f"slope__{k} = -slope__{k} if mirrored__of else slope__{k}")
                otherwise = target if at_limit else "nan"
                text.add(f"{target} = slope__{k} if counts__of else {otherwise}")
        text.lines += ["", ""]

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


def _text(gradient: Gradient, at_limit: bool) -> str:
    """Return the kernel text of a derivative."""
    if at_limit:
        return gradient.moving or "0.0"
    if not gradient.held:
        return "0.0"
    return f"-({' / '.join(gradient.held)})" if gradient.is_position else gradient.held[0]


def _sign(output: Output) -> int:
    """Return 1 for greatest values, -1 for least ones, 0 for a list."""
    reduction = output.request.reduction
    return reduction.sign if reduction is not None else 0

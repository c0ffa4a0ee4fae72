"""The text of a kernel that finds every extremum of some quantities, to rounding.

For a block of designs: samples of the derivatives on the graded range (lanes are designs), the cells that hold a
zero, their refinement (lanes are cells), and the quantities there. See `fastlink.codegen.runtime.sampling`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from fastlink.codegen.extrema_folds import FoldsWriter
from fastlink.codegen.runtime import (
    bounds,
    cells,
    ends,
    hidden,
    noise,
    resting,
    results,
    roots,
    sampling,
    splits,
    subdivision,
    toggles,
    winners,
)  # fmt: skip
from fastlink.codegen.runtime.cells import LANES
from fastlink.codegen.schedule import needed_steps
from fastlink.codegen.source import Source, paste_fact

if TYPE_CHECKING:
    from fastlink.plan.program import ExtremaProgram, Output

__all__ = ["write_extrema"]

# Bisection alone halves a cell to nothing in half as many; values that are no numbers must not go on for ever.
MOST_STEPS = 200


class _ExtremaWriter(FoldsWriter):
    """One kernel while it is written."""

    def write(self) -> Source:
        """Return the kernel."""
        text, searches = self.text, self.program.searches
        text.use("numerics.compiler", "lanes", "outlined")
        self.write_tables()
        with text.blocks_of_designs():
            self.write_designs()
            self.write_samples()
            text.call(results.clear, f"lists, best, {self.kept}")
            if self.program.has_gradients:
                text.call(winners.forget_winners, "winners, gradients")
            text.add(f"counts[{cells.DESIGNS}] = n_here")
            text.call(splits.forget_splits, "splits")
            for number in sorted(range(len(searches)), key=lambda k: not searches[k].splits):
                self.write_search(number)
            for search in filter(self.needs_ends, searches):
                self.write_ends(searches.index(search))
            if self.kept:
                self.write_thinning()
            for row in self.doubts:
                text.call(results.doubt, f"w, {row}, n_here, lists, best")
            if self.flagged:
                self.write_flags()
            for number in range(len(searches)):
                self.write_gradients(number)
            for output in self.program.outputs:
                self.write_result(output)
        kernel, text.lines = text.lines, text.functions
        for number, search in enumerate(searches):
            self.write_evaluations(number, search)
        text.lines = kernel
        return text.source(self.program, self.scratch())

    def write_tables(self) -> None:
        """Write the tables of whole numbers that tell the searches, branches and halves apart, see `runtime.cells`."""
        program, searched = self.program, self.program.searched_branches
        _, start, toggle = map(self.row, program.graded.ends[0])
        none = [-1] * (2 - len(searched))
        own, mirror = ([*map(column, searched), *none] for column in (self.own_column, self.mirror_column))
        sizes = [start, toggle, program.sides, self.halves, len(program.branches)]
        tables = {"table": [*sizes, *own, *mirror]}
        for k, search in enumerate(program.searches):
            flags = [int(search.at_limit), int(search.jumps) - int(search.piece)]
            about = [k, self.number_of(search.quantity), search.order, search.parity]
            tables[f"search_{k}"] = [*about, *flags, self.room(search), *self.most_items(search)]
            if numbers := self.split_by(search):
                tables[f"split_by_{k}"] = numbers
            tables[f"rows_{k}"] = [self.row(name) for name in self.item_needs(search)] or [0]
            for half in range(self.halves):
                first, beyond = self.sample_row(k, half), self.sample_row(k, self.half_beyond(half))
                sign, along = self.sign_of(search, half), self.continued(search)
                tables[f"part_{k}_{half}"] = [first, beyond, half, sign, self.cells, along]
        if self.program.has_gradients:
            tables["signs"] = [int(sign in self.gradient_signs) for sign in (1, -1)]
        self.reserve_for_gradients()
        for name, numbers in tables.items():
            self.text.add(f"{name} = array({numbers})")

    def write_designs(self) -> None:
        """Write the values that depend on the design alone."""
        text = self.text
        with text.block("for i in lanes(width):", "design"):
            for k, name in enumerate(self.program.inputs):
                text.add(f"{name} = designs[{k}, i0 + i]")
            early = [name for name in self.rows if name not in self.late]
            for step in needed_steps(self.design_steps, early):
                paste_fact(step, step.depends_on, "", text)
            for name in early:
                text.add(f"w[{self.row(name)}, i] = {name}")

    def write_samples(self) -> None:
        """Write the derivatives at all samples of the graded range, on both sides: both branches side by side."""
        text, sides = self.text, self.program.sides
        scale, start, _ = map(self.row, self.program.graded.ends[0])
        text.call(sampling.place_samples, f"w, samples, {scale}, {start}, {self.cells}, width")
        often = f"{self.samples} samples of the graded range" + (f", on {sides} sides" if sides > 1 else "")
        lanes = "for i in lanes(width):", "design and sample", often
        # a row of the nearer end's distance, then one of the farther end's, where positions are no longer placed
        near = 2 * (self.cells + 1)
        with text.block(f"for j in range({self.samples}):"):
            text.add(f"from_upper = j > {self.cells}")
            text.add(f"position = {3 * self.cells + 1} - j if from_upper else j")
            text.add(f"low__row = {near + 1} if from_upper else {near}")
            text.add(f"high__row = {near} if from_upper else {near + 1}")
            text.add("j1 = max(j - 1, 0)")
            text.add("j2 = max(j - 2, 0)")
            # Three loops: what waits for the divisions and roots of one is as long as the processor looks ahead.
            with text.block(*lanes):
                text.add("square = samples[position, i] * samples[position, i]")
                text.add("rest = 1.0 / (1.0 + square)")
                text.add(f"samples[{near}, i] = square * rest")
                text.add(f"samples[{near + 1}, i] = rest")
            with text.block(f"for turn in range({sides}):"):
                with text.block(*lanes):
                    self.write_sample()
                with text.block(*lanes):
                    self.write_marks()

    def write_sample(self) -> None:
        """Write the derivatives at one sample."""
        text, program = self.text, self.program
        steps = self.needed_for(self.slope_names(*program.searches))
        for name, row in zip(program.graded.coordinates, ("low__row", "high__row"), strict=False):
            text.add(f"{name} = samples[{row}, i]")
        side = "1.0 if turn == 0 else -1.0" if program.sides > 1 else "1.0"
        text.add(f"{program.graded.coordinates[2]} = {side}")
        for name in self.design_needs(steps):
            text.add(f"{name} = w[{self.row(name)}, i]")
        for step in (s for s in steps if "branch" not in program.axes[s.name]):
            self.paste(step)
        for branch in program.searched_branches:
            text.add(f"branch__{branch} = {branch}.0")
            for step in (s for s in steps if "branch" in program.axes[s.name]):
                self.paste(step, f"__{branch}")
        for number, search in enumerate(program.searches):
            values = [f"f_{number}__{branch}" for branch in program.searched_branches]
            for value, branch in zip(values, program.searched_branches, strict=True):
                text.add(f"{value} = {self.scaled(search, f'__{branch}')}")
            if program.mirrored:
                text.call(sampling.silenced, ", ".join(values), ", ".join(values))
            for k, value in enumerate(values):
                text.add(f"{self.sample(number, k, 'j')} = {value}")

    def sample(self, number: int, k: int, j: str) -> str:
        """Return the entry of a sample of a function in one branch."""
        return f"samples[{self.sample_row(number, k * self.program.sides)} + turn * {self.samples} + {j}, i]"

    def write_marks(self) -> None:
        """Mark the samples before those at hand, of all functions in all branches."""
        self.text.use("codegen.runtime.sampling", "mark")
        for number, search in enumerate(self.program.searches):
            for k in range(len(self.program.searched_branches)):
                before, here, now = (self.sample(number, k, j) for j in ("j2", "j1", "j"))
                mark = f"mark({before}, {here}, {now}, {self.sign_of(search, k)}.0)"
                self.text.add(f"{self.sample(number, k, 'j1').replace('samples', 'marks')} = {mark}")

    def write_search(self, number: int) -> None:
        """Write the search for the cells that hold a zero of one function, their refinement, and the extrema there."""
        text, search = self.text, self.program.searches[number]
        text.call(cells.nothing_yet, f"counts, search_{number}")
        parts, split = self.parts_of(number), bool(self.split_by(search))
        for part in self.parts_that_may_rest(number):
            text.call(resting.silence_rest, f"w, table, samples, marks, {part}, n_here")
        if self.looks_away(number):
            self.write_toggles(number, parts[0])
        if split:
            self.write_splits(number)
        elif self.n_splits:
            text.call(splits.forget_slopes, "splits")
        for part in parts:
            text.call(sampling.mark_ends, f"w, table, samples, marks, {part}, width")
            if split:
                text.call(splits.mark_splits, f"samples, marks, {part}, splits")
            if search.divided:
                text.call(subdivision.mark_unresolved, f"samples, marks, {part}, width")
        if search.divided or not search.parity:  # else its extremes are counted: none hides
            self.write_octaves(number, parts[0])
        for part in parts:
            if search.divided:
                arguments = f"samples, marks, {part}, counts, unresolved, splits"
                text.call(subdivision.collect_unresolved, arguments)
                if split:
                    text.call(splits.collect_jumps, f"{part}, splits, counts, roots")
            text.call(sampling.collect, f"samples, marks, {part}, counts, roots, valleys")
        if search.divided:
            self.write_division(number)
        for items, count in (("valleys", cells.VALLEYS), ("roots", cells.ROOTS)):
            with text.block(f"for start in range(0, counts[{count}], {LANES}):"):
                text.call(cells.gather, f"{items}, start, counts[{count}], w, rows_{number}, state", "filled")
                if items == "valleys":
                    text.call(roots.begin_valleys, "state, filled, vectors", "n_open")
                    self.write_steps(number, roots.advance_valleys)
                    text.call(roots.split, "state, filled, counts, roots")
                else:
                    text.call(roots.begin_roots, "state, filled, vectors, flags", "n_open")
                    self.write_steps(number, roots.advance_roots)
                    if search.splits:
                        arguments = f"state, filled, samples, {parts[0]}, splits, {number}"
                        text.call(splits.keep_splits, arguments)
                    else:
                        self.write_extrema(number, results.extrema_at_zeros, "state, filled, table")

    def write_division(self, number: int) -> None:
        """Write the division of unresolved cells, and of their parts that are still unresolved."""
        text = self.text
        text.add("divided = 0")
        with text.block(f"while divided < counts[{cells.UNRESOLVED}]:"):
            items = f"unresolved, divided, counts[{cells.UNRESOLVED}]"
            text.call(cells.gather, f"{items}, w, rows_{number}, state", "filled")
            text.call(roots.every_vector, "vectors, filled", "n_open")
            with text.block(f"for k in range({cells.FINE_SAMPLES}):"):
                text.call(subdivision.place_fine, "state, filled, k")
                text.add(f"slope_{number}(state, vectors, n_open)")
                text.call(subdivision.keep_fine, "state, filled, k")
            text.call(subdivision.mark_fine, "state, filled, fine_marks")
            text.call(subdivision.divide, "state, filled, fine_marks, counts, unresolved")
            text.call(subdivision.collect_fine, "state, filled, fine_marks, counts, roots, valleys")
            text.add("divided = divided + filled")

    def write_steps(self, number: int, advance: Callable[..., Any]) -> None:
        """Write the steps of a refinement."""
        with self.text.block(f"for step in range({MOST_STEPS}):"):
            self.text.add("if n_open == 0: break")
            self.text.add(f"slope_{number}(state, vectors, n_open)")
            self.text.call(advance, "state, vectors, n_open, flags", "n_open")

    def write_extrema(self, number: int, classify: Callable[..., Any], state: str) -> None:
        """Write the quantity's evaluation at items of a search, what is extreme there, and its storing."""
        text, search = self.text, self.program.searches[number]
        listed = bool(self.kept) and classify is results.extrema_at_zeros
        if listed:
            self.write_noise(number)
        self.write_value(number)
        if listed:
            text.call(noise.settle_noise, "state, filled")
        if classify is ends.end_values and search.at_limit:
            text.call(ends.place_lost, f"state, filled, w, table, {ends.FARTHER}", "n_lost")
            with text.block("if n_lost > 0:"):
                self.write_value(number)
        text.call(classify, f"{state}, search_{number}")
        if classify is results.extrema_at_zeros:
            text.call(results.drop_folds, f"state, filled, w, table, search_{number}")
        if self.program.has_bounds and classify is results.extrema_at_zeros:
            text.call(bounds.bound_zeros, f"state, filled, search_{number}, {int(search.magnitude)}")
            if listed and not search.onto:
                text.call(hidden.note_uncertain, f"state, filled, w, table, search_{number}, best")
        elif self.program.has_bounds:
            text.call(bounds.bound_ends, "state, filled, w, table")
            if self.bounds_hidden(number):
                text.call(toggles.bound_hidden, "state, filled")
        if self.program.has_gradients:
            arguments = f"state, filled, table, search_{number}, winners, signs"
            text.call(winners.note_winners, arguments)
            if search.kinked and classify is results.extrema_at_zeros:
                text.call(winners.note_kinks, arguments)
        text.call(results.store_extrema, f"state, filled, table, search_{number}, lists, best")

    def write_ends(self, number: int) -> None:
        """Write the values at the ends of the range, where these may be extreme."""
        text, search = self.text, self.program.searches[number]
        text.call(ends.collect_ends, f"w, n_here, table, search_{number}, best, ends", "n_ends")
        for part in self.parts_that_may_rest(number):
            text.call(resting.collect_rest, f"samples, {part}, n_here, ends, n_ends", "n_ends")
        with text.block(f"for start in range(0, n_ends, {LANES}):"):
            text.call(cells.gather, f"ends, start, n_ends, w, rows_{number}, state", "filled")
            if search.order > 0:
                text.call(ends.tries, "state, filled, w, table", "n_tries")
                with text.block("for k in range(n_tries):"):
                    text.call(ends.place_beside, "state, filled, k")
                    self.write_value(number)
                    text.call(ends.keep_beside, "state, filled, w, table, k")
            if self.bounds_hidden(number):
                self.write_hidden(number)
            text.call(ends.place_ends, "state, filled, 1.0")
            self.write_extrema(number, ends.end_values, "state, filled, w, table")

    def write_result(self, output: Output) -> None:
        """Write the copy of one result of a search."""
        request = output.request
        number = self.number_of(request.quantity)
        base = number * len(self.program.branches) * LANES
        target = f"out_{output.name}, i0, n_here, {base}"
        if request.is_of_gradient:
            self.write_gradient_result(output, number)
        elif request.reduction is not None:
            row = {1: results.GREATEST, -1: results.LEAST}[request.reduction.sign] + int(request.is_position)
            store = results.store_bound if request.is_error else results.store_best
            self.text.call(store, f"{target}, best, {row}")
        elif request.listed == "count":
            self.text.call(results.store_counts, f"{target}, best")
        else:
            row = results.LIST_ROW_OF[request.listed]
            self.text.call(results.store_list, f"{target}, lists, {row}")


def write_extrema(program: ExtremaProgram) -> Source:
    """Return the text of the kernel, and what it is called with."""
    return _ExtremaWriter(program).write()

"""The text of a kernel that finds every extreme of some quantities, to rounding.

For a block of designs: samples of the derivatives on the graded range (lanes are designs), the cells that hold a
zero, their refinement (lanes are cells), and the quantities there. See `fastlink.codegen.runtime.sampling`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from fastlink.catalogue.catalogue import Fact, parameters
from fastlink.codegen.extrema_schedule import ExtremaSchedule
from fastlink.codegen.pointwise import results_of
from fastlink.codegen.runtime.cells import HALF, ITEM_ROWS, LANES, MOST_LANES, STATE_ROWS, UPPER, X
from fastlink.codegen.runtime.cells import F as F_ROW
from fastlink.codegen.source import Array, Source, Text, paste_fact

if TYPE_CHECKING:
    from fastlink.plan.program import ExtremaProgram, ExtremumSearch, Output

__all__ = ["write_extrema"]

# Bisection alone halves a cell to nothing in half as many; values that are no numbers must not go on for ever.
MOST_STEPS = 200


class _Refined(ExtremaSchedule):
    """One kernel while it is written."""

    def __init__(self, plan: ExtremaProgram) -> None:
        super().__init__(plan)
        self.text = Text()

    def write(self) -> Source:
        """Return the kernel."""
        text, plan = self.text, self.plan
        text.use("numerics.compiler", "lanes")
        for number, search in enumerate(plan.searches):
            self.write_evaluations(number, search)
        self.write_tables()
        text.open(f"for i0 in range(0, n_designs, {LANES}):")
        text.add(f"n_here = min({LANES}, n_designs - i0)")
        text.add(f"width = (n_here + {MOST_LANES - 1}) & {-MOST_LANES}")
        self.write_designs()
        self.write_samples()
        text.use("codegen.runtime.results", "clear")
        text.add("clear(lists, best, found)")
        for number, search in enumerate(plan.searches):
            self.write_search(number, search)
        for number, search in enumerate(plan.searches):
            if self.wants_ends(search):
                self.write_ends(number, search)
        for output in plan.outputs:
            self.write_result(output)
        text.close()
        scratch, results = self.scratch(), results_of(plan)
        return Source(text.module(plan, scratch, results), len(plan.inputs), 0, scratch, results)

    def scratch(self) -> tuple[Array, ...]:
        """Return the arrays that the kernel works in."""
        plan, searches = self.plan, self.plan.searches
        columns = len(searches) * len(plan.branches) * LANES
        room = LANES * self.halves
        kept = max(search.most for search in searches) if self.lists else 0
        return (
            Array("w", "float64", (self.used(), LANES)),
            Array("samples", "float64", (len(searches) * self.halves * self.samples, LANES)),
            Array("state", "float64", (self.value_row + 2, LANES)),
            Array("marks", "int8", (len(searches) * self.halves * self.samples, LANES)),
            Array("valleys", "float64", (ITEM_ROWS, room * self.samples + MOST_LANES)),
            Array("roots", "float64", (ITEM_ROWS, 3 * room * self.samples + MOST_LANES)),
            Array("ends", "float64", (ITEM_ROWS, 2 * room + MOST_LANES)),
            Array("flags", "int8", (LANES,)),
            Array("vectors", "int64", (LANES // MOST_LANES,)),
            Array("counts", "int64", (2,)),
            Array("found", "int64", (columns,)),
            Array("best", "float64", (4, columns)),
            Array("lists", "float64", (3, columns, kept)),
        )

    @property
    def lists(self) -> bool:
        """Whether whole lists of extremes are asked for."""
        return any(output.request.listed for output in self.plan.outputs)

    # -- the loops ---------------------------------------------------------------------------------

    def write_tables(self) -> None:
        """Write the tables that tell the searches and branches apart."""
        plan, searches = self.plan, self.plan.searches
        toggle = self.row(self.graded.ends[0][2])
        for name, numbers in (
            ("about", [self.value_row, toggle, plan.sides, len(plan.branches)]),
            ("own", [self.own_place(b) for b in plan.computed]),
            ("other", [self.mirror_of(b) for b in plan.computed]),
            ("order", [search.order for search in searches]),
            ("onto", [self.number_of(search.quantity) for search in searches]),
            ("parity", [float(search.parity) for search in searches]),
            *(
                (f"rows_{k}", [self.row(n) for n in self.item_needs(s)] or [0])
                for k, s in enumerate(searches)
            ),
        ):
            self.text.add(f"{name} = array({numbers})")

    def write_designs(self) -> None:
        """Write the values that depend on the design alone."""
        text, plan = self.text, self.plan
        text.open("for i in lanes(width):")
        for k, name in enumerate(plan.inputs):
            text.add(f"{name} = designs[{k}, i0 + i]")
        for step in self.design_steps:
            paste_fact(step, dict(zip(parameters(step.function), step.depends_on, strict=True)), "", text)
        for name, row in self.rows.items():
            text.add(f"w[{row}, i] = {name}")
        text.close()

    def write_samples(self) -> None:
        """The derivatives at all places of the graded range, on both sides of it: both branches side by side."""
        text, cells, plan = self.text, self.cells, self.plan
        side = self.graded.coordinates[2]
        self.places = rows = self.row("places", 2 * (cells + 1))
        spare = self.row("spare", 4)
        scale, start = self.row(self.graded.ends[0][0]), self.row(self.graded.ends[0][1])
        steps = self.needed_for(self.slope_names())
        text.use("codegen.runtime.sampling", "place_samples")
        text.add(f"place_samples(w, {scale}, {start}, {rows}, {spare}, {cells}, width)")
        text.open(f"for j in range({self.samples}):")
        text.add(f"from_upper = j > {cells}")
        text.add(f"place = {rows + 3 * cells + 1} - j if from_upper else {rows} + j")
        text.add("j1 = max(j - 1, 0)")
        text.add("j2 = max(j - 2, 0)")
        text.open(f"for turn in range({plan.sides}):")
        text.open("for i in lanes(width):")
        self.write_place("w[place, i]", "from_upper")
        text.add(f"{side} = 1.0 if turn == 0 else -1.0")
        self.load_designs(steps, lambda name: self.row(name), "w")
        for step in (s for s in steps if "branch" not in plan.axes[s.name]):
            self.paste(step)
        for branch in plan.computed:
            text.add(f"branch__{branch} = {branch}.0")
            for step in (s for s in steps if "branch" in plan.axes[s.name]):
                self.paste(step, f"__{branch}")
        for number, search in enumerate(plan.searches):
            self.write_marks(number, search)
        for _ in range(3):
            text.close()

    def write_marks(self, number: int, search: ExtremumSearch) -> None:
        """Store the samples of a function in all branches, and mark those before.

        Here the marks cost little: the loop waits for divisions.
        """
        text, plan = self.text, self.plan
        values = [f"f_{number}__{branch}" for branch in plan.computed]
        for value, branch in zip(values, plan.computed, strict=True):
            text.add(f"{value} = {self.scaled(search, f'__{branch}')}")
        text.use("codegen.runtime.sampling", "mark")
        if plan.mirrored:
            text.use("codegen.runtime.sampling", "silenced")
            text.add(f"{', '.join(values)} = silenced({', '.join(values)})")
        for k, value in enumerate(values):
            row = f"{self.sample_row(number, k * plan.sides)} + turn * {self.samples}"
            now, here, before = (f"samples[{row} + {j}, i]" for j in ("j", "j1", "j2"))
            text.add(f"{now} = {value}")
            text.add(f"marks[{row} + j1, i] = mark({before}, {here}, {value}, {self.sign_of(search, k)})")

    def sign_of(self, search: ExtremumSearch, half: int) -> float:
        """Return the sign with which a function is searched in a half: the mirror continues the first one."""
        return float(search.slope_parity) if self.plan.mirrored and half == 0 else 1.0

    def write_place(self, place: str, upper: str) -> None:
        """The distances of a place from the near and the far end, over the width."""
        near, far = self.graded.coordinates[:2]
        text = self.text
        text.add(f"square = {place} * {place}")
        text.add("rest = 1.0 / (1.0 + square)")
        text.add(f"{near} = rest if {upper} else square * rest")
        text.add(f"{far} = square * rest if {upper} else rest")

    def load_designs(
        self, steps: Sequence[Fact], row: Callable[[str], int], array: str, lane: str = "i"
    ) -> None:
        """Write the loads of the design values that facts need."""
        for name in self.design_needs(steps):
            self.text.add(f"{name} = {array}[{row(name)}, {lane}]")

    def named(self, name: str, copy: str = "") -> str:
        """Return the name of a value, of one branch's copy where there are copies."""
        return name + (copy if "branch" in self.plan.axes[name] else "")

    def scaled(self, search: ExtremumSearch, copy: str = "") -> str:
        """Return the derivative times the power of sin mu that keeps it finite and not zero at a toggle."""
        factors = [search.slope, *[self.graded.bounded_factor] * search.slope_order]
        return " * ".join(self.named(name, copy) for name in factors)

    def paste(self, step: Fact, copy: str = "") -> None:
        """Append a fact, reading the copies of one branch."""
        names = (self.named(need, copy) for need in step.depends_on)
        values = dict(zip(parameters(step.function), names, strict=True))
        paste_fact(step, values, copy if "branch" in self.plan.axes[step.name] else "", self.text)

    # -- the search --------------------------------------------------------------------------------

    def write_search(self, number: int, search: ExtremumSearch) -> None:
        """Cells that hold a zero of one function, their refinement, and what is found there."""
        text = self.text
        text.use("codegen.runtime.cells", "gather")
        text.use(
            "codegen.runtime.roots",
            "advance_roots",
            "advance_valleys",
            "begin_roots",
            "begin_valleys",
            "split",
        )
        text.add("counts[0] = 0")
        text.add("counts[1] = 0")
        self.write_collect(number, search)
        text.open(f"for start in range(0, counts[0], {LANES}):")
        text.add(f"filled = gather(valleys, start, counts[0], w, rows_{number}, state)")
        text.add("n_open = begin_valleys(state, filled, vectors)")
        self.write_steps(number, "advance_valleys")
        text.add("split(state, filled, counts, roots)")
        text.close()
        text.open(f"for start in range(0, counts[1], {LANES}):")
        text.add(f"filled = gather(roots, start, counts[1], w, rows_{number}, state)")
        text.add("n_open = begin_roots(state, filled, vectors, flags)")
        self.write_steps(number, "advance_roots")
        self.write_take(number, ends=False)
        text.close()

    def write_steps(self, number: int, advance: str) -> None:
        """The steps of a refinement."""
        text = self.text
        text.open(f"for step in range({MOST_STEPS}):")
        text.open("if n_open == 0:")
        text.add("break")
        text.close()
        text.add(f"slope_{number}(state, vectors, n_open)")
        text.add(f"n_open = {advance}(state, vectors, n_open, flags)")
        text.close()

    def write_take(self, number: int, *, ends: bool) -> None:
        """Values at the places of items, and to which design they belong."""
        self.text.use("codegen.runtime.results", "take")
        self.text.use("codegen.runtime.roots", "every_vector")
        self.text.add("n_open = every_vector(vectors, filled)")
        self.text.add(f"value_{number}(state, vectors, n_open)")
        tables = "about, own, other, onto, order, parity, lists, best, found"
        twice_axis = 2.0 * self.graded.axis
        self.text.add(f"take(state, filled, {number}, {ends}, w, {tables}, {twice_axis})")

    def write_ends(self, number: int, search: ExtremumSearch) -> None:
        """Values at the ends of the range, where these may be extreme."""
        text = self.text
        text.use("codegen.runtime.results", "collect_ends")
        text.use("codegen.runtime.roots", "place_ends")
        start = self.row(self.graded.ends[0][1])
        where = f"w, {start}, n_here, {self.halves}, {number}, {search.at_limit}"
        text.add(f"n_ends = collect_ends({where}, best, {len(self.plan.branches)}, ends)")
        text.open(f"for start in range(0, n_ends, {LANES}):")
        text.add(f"filled = gather(ends, start, n_ends, w, rows_{number}, state)")
        text.add("place_ends(state, filled)")
        self.write_take(number, ends=True)
        text.close()

    def write_collect(self, number: int, search: ExtremumSearch) -> None:
        """Make items of all halves of one function."""
        self.text.use("codegen.runtime.sampling", "collect", "mark_ends")
        for half in range(self.halves):
            row, beyond = self.sample_row(number, half), self.sample_row(number, self.beyond(half))
            sign = self.sign_of(search, half)
            self.text.add(f"mark_ends(samples, marks, {row}, {beyond}, {self.samples - 1}, {sign}, width)")
            where = f"{row}, {self.places}, {self.cells}, n_here, {half}"
            self.text.add(f"collect(w, samples, marks, {where}, counts, roots, valleys)")

    def write_evaluations(self, number: int, search: ExtremumSearch) -> None:
        """Functions of their own: the sampled function at the places of items, and the quantity there."""
        self.write_evaluation(f"slope_{number}", search, self.slope_of(search), {F_ROW: self.scaled(search)})
        quantity, position = self.values_of(search)
        stores = {self.value_row: quantity, self.value_row + 1: position}
        self.write_evaluation(f"value_{number}", search, [quantity, position], stores)

    def write_evaluation(
        self, name: str, search: ExtremumSearch, names: Sequence[str], stores: Mapping[int, str]
    ) -> None:
        """A function of the state that computes values at the places of items."""
        outer, self.text.lines = self.text.lines, []
        text = self.text
        text.use("numerics.compiler", "outlined")
        text.add("@outlined")
        text.open(f"def {name}(state, vectors, n_vectors):")
        text.open("for v in range(n_vectors):")
        text.add("at = vectors[v]")
        text.open(f"for i in lanes({MOST_LANES}):")
        text.add(f"upper = state[{UPPER}, at + i] > 0.0")
        self.write_place(f"state[{X}, at + i]", "upper")
        self.write_half(f"state[{HALF}, at + i]")
        steps, depends_on = self.needed_for(names), self.item_needs(search)
        self.load_designs(steps, lambda need: STATE_ROWS + depends_on.index(need), "state", "at + i")
        for step in steps:
            self.paste(step)
        for row, value in stores.items():
            text.add(f"state[{row}, at + i] = {value}")
        for _ in range(3):
            text.close()
        text.functions += [*text.lines, "", ""]
        text.lines = outer

    def write_half(self, half: str) -> None:
        """Tell branch and side of a half: halves are numbered branch by branch, both sides of each."""
        side, computed = self.graded.coordinates[2], self.plan.computed
        above = f"({half} == 0.0) | ({half} == 2.0)"
        self.text.add(f"{side} = 1.0 if {above} else -1.0" if self.plan.sides == 2 else f"{side} = 1.0")
        former = f"{computed[0]}.0 if {half} <= {self.plan.sides - 1.0} else " if len(computed) > 1 else ""
        self.text.add(f"branch = {former}{computed[-1]}.0")

    def write_result(self, output: Output) -> None:
        """Copy one result of a search."""
        name, values = self.store_of(output)
        self.text.use("codegen.runtime.results", name)
        base = self.number_of(output.request.quantity) * len(self.plan.branches) * LANES
        self.text.add(f"{name}(out_{output.name}, i0, n_here, {base}, {values})")


def write_extrema(plan: ExtremaProgram) -> Source:
    """Return the text of the kernel, and what it is called with."""
    return _Refined(plan).write()

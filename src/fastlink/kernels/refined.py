"""The text of a kernel that finds every extreme of some quantities, to rounding.

For a block of designs: samples of the derivatives on the graded range (lanes are designs), the cells that hold a
zero, their refinement (lanes are cells), and the quantities there. See `fastlink.kernels.search`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fastlink.catalogue import Fact, parameters
from fastlink.kernels.emit import Text, paste_fact
from fastlink.kernels.items import HALF, ITEM_ROWS, LANES, STATE_ROWS, UPPER, WHICH, X
from fastlink.kernels.items import F as F_ROW
from fastlink.kernels.refined_layout import RefinedLayout

if TYPE_CHECKING:
    from fastlink.closure import Output, RefinedClosure, Search

__all__ = ["write_refined"]

# Facts of a branch, beyond which the text of both would take longer to compile than it saves.
MOST_ABREAST = 30

# Bisection alone halves a cell to nothing in half as many; values that are no numbers must not go on for ever.
MOST_STEPS = 200


class _Refined(RefinedLayout):
    """One kernel while it is written."""

    def __init__(self, plan: RefinedClosure) -> None:
        super().__init__(plan)
        self.text = Text()
        # Names of lane values end in the name of their loop: numba takes long over names with two meanings.
        self.loop = ""

    def use(self, module: str, *names: str) -> None:
        """Import functions of `fastlink.kernels`."""
        self.text.imports.setdefault(f"fastlink.kernels.{module}", set()).update(names)

    # -- the loops ---------------------------------------------------------------------------------

    def write(self) -> str:
        text, plan = self.text, self.plan
        self.write_evaluation()
        text.add()
        outputs = ", ".join(f"out_{o.name}" for o in plan.outputs)
        text.open(f"def kernel(designs, angles, n_designs, n_angles, w, w2, {outputs}):")
        self.write_arrays()
        text.open(f"for i0 in range(0, n_designs, {LANES}):")
        text.add(f"lanes = min({LANES}, n_designs - i0)")
        self.write_designs()
        self.write_samples()
        self.write_search()
        for output in plan.outputs:
            self.write_result(output)
        return text.module(plan, "array, empty, inf, int8, int64, nan, uint64")

    def write_arrays(self) -> None:
        """Scratch, and what tells the searches and branches apart."""
        plan, searches = self.plan, self.plan.searches
        columns = len(searches) * len(plan.branches) * LANES
        room = LANES * len(searches) * self.halves
        listed = any(output.request.listed for output in plan.outputs)
        for line in (
            f"w_rows = w.reshape(w.size // {LANES}, {LANES})",
            f"w2_rows = w2.reshape(w2.size // {LANES}, {LANES})",
            f"state = empty({(self.slope_row + len(searches)) * LANES})",
            f"state_rows = state.reshape(state.size // {LANES}, {LANES})",
            f"valleys = empty(({room * self.samples}, {ITEM_ROWS}))",
            f"roots = empty(({3 * room * self.samples}, {ITEM_ROWS}))",
            f"ends = empty(({2 * room}, {ITEM_ROWS}))",
            f"flags = empty({LANES}, int8)",
            f"lane = empty({LANES}, uint64)",
            "counts = empty(2, int64)",
            f"found = empty({columns}, int64)",
            f"best = empty((4, {columns}))",
            f"lists = empty((3, {columns}, {max(search.most for search in searches) if listed else 0}))",
            f"own = array({[self.own_place(b) for b in plan.computed]})",
            f"other = array({[self.mirror_of(b) for b in plan.computed]})",
            f"rows = array({[self.row(name) for name in self.item_needs] or [0]})",
            f"order = array({[search.order for search in searches]})",
            f"onto = array({[self.number_of(search.quantity) for search in searches]})",
            f"parity = array({[float(search.parity) for search in searches]})",
            f"wanted = array({[self.wants_ends(search) for search in searches]})",
        ):
            self.text.add(line)

    def write_designs(self) -> None:
        """What depends on the design alone."""
        text, plan = self.text, self.plan
        text.open(f"for i in range({LANES}):")
        for k, name in enumerate(plan.inputs):
            text.add(f"{name} = designs[{k}, i0 + i]")
        for step in self.design_steps:
            paste_fact(step, dict(zip(parameters(step.function), step.needs, strict=True)), "", text)
        for name, row in self.rows.items():
            text.add(f"w[{row * LANES} + i] = {name}")
        text.close()

    def write_samples(self) -> None:
        """The derivatives at all places of the graded range, for every half of it."""
        text, cells = self.text, self.cells
        near, far = self.graded.leaves[:2]
        rows = self.row("places", 2 * (cells + 1))
        self.places = rows
        spare = self.row("spare", 4)
        scale, start = self.row(self.graded.ends[0][0]), self.row(self.graded.ends[0][1])
        self.use("search", "place_samples")
        text.add(f"place_samples(w_rows, {scale}, {start}, {rows}, {spare}, {cells})")
        steps = self.needed_for(self.slope_names())
        of_branch = [s for s in steps if "branch" in self.plan.axes[s.name]]
        if not self.plan.mirrored or len(of_branch) > MOST_ABREAST:
            self.write_sample_calls()
            return
        self.use("search", "fractions")
        at_near, at_far = self.row(near), self.row(far)
        text.open(f"for j in range({self.samples}):")
        text.open(f"if j <= {cells}:")
        text.add(f"fractions(w_rows, {rows} + j, {at_near}, {at_far})")
        text.close()
        text.open("else:")
        text.add(f"fractions(w_rows, {rows + 3 * cells + 1} - j, {at_far}, {at_near})")
        text.close()
        self.write_sample_loop(steps, of_branch)
        text.close()

    def write_sample_calls(self) -> None:
        """Sample half by half with what evaluates items: one text of the facts, which are many."""
        text, rows, cells = self.text, self.places, self.cells
        self.use("search", "load_designs", "set_places")
        text.add("load_designs(w_rows, rows, state_rows)")
        text.open(f"for j in range({self.samples}):")
        text.add(f"place = {rows} + j if j <= {cells} else {rows + 3 * cells + 1} - j")
        text.open(f"for half in range({self.halves}):")
        text.add(f"set_places(w_rows, place, j > {cells}, half, state_rows)")
        text.add(f"evaluate(state, {LANES})")
        for number in range(len(self.plan.searches)):
            row = f"{self.sample_row(number, 0)} + half * {self.samples} + j"
            text.add(f"w2_rows[{row}] = state_rows[{self.slope_row + number}]")
        text.close()
        text.close()

    def write_sample_loop(self, steps: Sequence[Fact], of_branch: Sequence[Fact]) -> None:
        """Sample both branches side by side: what they share is computed once."""
        text, plan = self.text, self.plan
        near, far, side = self.graded.leaves
        self.loop = tag = "__s"
        text.open(f"for i in range({LANES}):")
        for name in (near, far, *self.design_needs(steps)):
            text.add(f"{name}{tag} = w[{self.row(name) * LANES} + i]")
        text.add(f"{side}{tag} = 1.0")
        for step in (s for s in steps if "branch" not in plan.axes[s.name]):
            self.paste(step)
        for k, branch in enumerate(plan.computed):
            text.add(f"branch{tag}__{branch} = {branch}.0")
            for step in of_branch:
                self.paste(step, f"__{branch}")
            for number, search in enumerate(plan.searches):
                row = f"{self.sample_row(number, k)} + j"
                text.add(f"w2[({row}) * {LANES} + i] = {self.scaled(search, f'__{branch}')}")
        text.close()

    def write_half(self, half: str) -> None:
        """Tell branch and side of a half: halves are numbered branch by branch, both sides of each."""
        side, tag, computed = self.graded.leaves[2], self.loop, self.plan.computed
        above = f"({half} == 0.0) | ({half} == 2.0)"
        self.text.add(
            f"{side}{tag} = 1.0 if {above} else -1.0" if self.plan.sides == 2 else f"{side}{tag} = 1.0"
        )
        former = f"{computed[0]}.0 if {half} <= {self.plan.sides - 1.0} else " if len(computed) > 1 else ""
        self.text.add(f"branch{tag} = {former}{computed[-1]}.0")

    def named(self, name: str, copy: str = "") -> str:
        """Return the name of a value in this loop, of one branch's copy where there are copies."""
        return name + self.loop + (copy if "branch" in self.plan.axes[name] else "")

    def scaled(self, search: Search, copy: str = "") -> str:
        """Return the derivative times the power of sin mu that keeps it finite and not zero at a toggle."""
        factors = [search.slope, *[self.graded.sine] * search.slope_order]
        return " * ".join(self.named(name, copy) for name in factors)

    def paste(self, step: Fact, copy: str = "") -> None:
        """Append a fact, reading the copies of one branch."""
        names = (self.named(need, copy) for need in step.needs)
        values = dict(zip(parameters(step.function), names, strict=True))
        paste_fact(
            step, values, self.loop + (copy if "branch" in self.plan.axes[step.name] else ""), self.text
        )

    # -- the search --------------------------------------------------------------------------------

    def write_search(self) -> None:
        """Cells that hold a zero, their refinement, and what is found there."""
        text, plan = self.text, self.plan
        (_, start, toggle), _ = self.graded.ends
        self.use("items", "gather")
        self.use("bracket", "advance", "begin", "split")
        self.use("found", "clear", "collect_ends", "take")
        text.add("counts[:] = 0")
        text.add("clear(lists, best, found)")
        for number, search in enumerate(plan.searches):
            self.write_collect(number, search)
        text.open(f"for phase in range({3 if any(map(self.wants_ends, plan.searches)) else 2}):")
        text.add("items, total = (valleys, counts[0]) if phase == 0 else (roots, counts[1])")
        text.open("if phase == 2:")
        options = f"wanted, best, {len(plan.branches)}, ends"
        text.add(f"total = collect_ends(w_rows, {self.row(start)}, lanes, {self.halves}, {options})")
        text.add("items = ends")
        text.close()
        text.open(f"for start in range(0, total, {LANES}):")
        text.add("width = gather(items, start, total, w_rows, rows, state_rows, lane)")
        text.add("open_items = begin(state_rows, width, phase)")
        text.open(f"for step in range({MOST_STEPS}):")
        text.add("evaluate(state, width)")
        text.open("if open_items == 0:")
        text.add("break")
        text.close()
        text.add("open_items = advance(state_rows, width, phase == 0)")
        text.close()
        text.open("if phase == 0:")
        text.add("split(state_rows, width, counts, roots)")
        text.close()
        text.open("else:")
        self.loop = "__t"
        self.write_items([plan.catalogue.position.name])
        angle = self.value_row + len(plan.searches)
        text.add(f"state[{angle * LANES} + i] = {self.named(plan.catalogue.position.name)}")
        text.close()
        text.add(
            f"take(state_rows, width, {self.value_row}, phase == 2, {self.row(toggle)}, w_rows, {plan.sides}, "
            f"{len(plan.branches)}, own, other, onto, order, parity, lists, best, found)"
        )
        text.close()
        text.close()
        text.close()

    def write_collect(self, number: int, search: Search) -> None:
        """Make items of all halves of one function."""
        self.use("search", "collect")
        if self.plan.mirrored:
            self.use("search", "silence")
            rows = f"{self.sample_row(number, 0)}, {self.sample_row(number, 1)}"
            self.text.add(f"silence(w2_rows, {rows}, {self.samples})")
        for half in range(self.halves):
            first = self.plan.mirrored and half == 0
            rows = f"{self.sample_row(number, half)}, {self.sample_row(number, self.beyond(half))}"
            what = f"{number}, {half}, {float(search.slope_parity) if first else 1.0}"
            self.text.add(
                f"collect(w_rows, w2_rows, {rows}, {self.places}, {self.cells}, lanes, {what}, "
                "flags, counts, roots, valleys)"
            )

    def write_evaluation(self) -> None:
        """A function of its own: the sampled functions and the quantities at the places of items."""
        text, searches = self.text, self.plan.searches
        text.imports.setdefault("fastlink.jit", set()).add("separate")
        text.add("@separate")
        text.open("def evaluate(state, width):")
        self.loop = ""
        values = [search.quantity for search in searches]
        self.write_items([*self.slope_names(), *values])
        for number, search in enumerate(searches):
            text.add(f"f_{number} = {self.scaled(search)}")
            text.add(f"state[{(self.slope_row + number) * LANES} + i] = f_{number}")
            text.add(f"state[{(self.value_row + number) * LANES} + i] = {self.named(search.quantity)}")
        choice = f"f_{len(searches) - 1}"
        for number in range(len(searches) - 2, -1, -1):
            choice = f"(f_{number} if state[{WHICH * LANES} + i] == {number}.0 else {choice})"
        text.add(f"state[{F_ROW * LANES} + i] = {choice}")
        text.close()
        text.close()

    def write_items(self, names: Sequence[str]) -> None:
        """Open the loop over items and compute values at their places."""
        text, tag = self.text, self.loop
        near, far = self.graded.leaves[:2]
        steps = self.needed_for(names)
        text.open("for i in range(width):")
        text.add(f"square{tag} = state[{X * LANES} + i] * state[{X * LANES} + i]")
        text.add(f"rest{tag} = 1.0 / (1.0 + square{tag})")
        text.add(f"upper{tag} = state[{UPPER * LANES} + i] > 0.0")
        text.add(f"{near}{tag} = rest{tag} if upper{tag} else square{tag} * rest{tag}")
        text.add(f"{far}{tag} = square{tag} * rest{tag} if upper{tag} else rest{tag}")
        text.add(f"half{tag} = state[{HALF * LANES} + i]")
        self.write_half(f"half{tag}")
        used = {need for step in steps for need in step.needs} | set(names)
        for r, name in enumerate(self.item_needs):
            if name in used:
                text.add(f"{name}{tag} = state[{(STATE_ROWS + r) * LANES} + i]")
        for step in steps:
            self.paste(step)

    def write_result(self, output: Output) -> None:
        """Copy one result of a search."""
        name, values = self.store_of(output)
        self.use("found", name)
        base = self.number_of(output.request.quantity) * len(self.plan.branches) * LANES
        self.text.add(f"{name}(out_{output.name}, i0, lanes, {base}, {values})")


def write_refined(plan: RefinedClosure) -> tuple[str, tuple[int, int]]:
    """Return the text of the kernel and the lengths of its two scratch arrays."""
    writer = _Refined(plan)
    text = writer.write()
    return text, (writer.used() * LANES, len(plan.searches) * writer.halves * writer.samples * LANES)

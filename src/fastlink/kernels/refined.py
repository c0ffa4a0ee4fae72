"""The text of a kernel that finds every extreme of some quantities, to rounding.

For a block of designs: samples of the derivatives on the graded range (lanes are designs), the cells that hold a
zero, their refinement (lanes are cells), and the quantities there. See `fastlink.kernels.search`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from fastlink.catalogue import Fact, parameters
from fastlink.kernels.emit import Text, paste_fact
from fastlink.kernels.found import GREATEST, LEAST, PLACE, VALUE
from fastlink.kernels.layout import LANES
from fastlink.kernels.search import ITEM_ROWS, STATE_ROWS, X
from fastlink.kernels.search import F as F_ROW

if TYPE_CHECKING:
    from fastlink.closure import Output, RefinedClosure
    from fastlink.searches import Search

__all__ = ["write_refined"]

HEADER = '''"""Kernel of {mechanism}, written by fastlink: {names}."""

from numpy import array, empty, inf, int8, int64, nan, uint64
{imports}

'''
SEARCH = "fastlink.kernels.search"
FOUND = "fastlink.kernels.found"


class _Refined:
    """One kernel while it is written."""

    def __init__(self, plan: RefinedClosure) -> None:
        self.plan, self.text = plan, Text()
        graded = plan.catalogue.graded
        assert graded is not None
        self.graded = graded
        self.cells = plan.searches[0].cells
        self.samples = 2 * self.cells + 1
        self.design_steps = [s for s in plan.steps if plan.axes[s.name] <= {"design"}]
        self.branch_steps = [s for s in plan.steps if plan.axes[s.name] == {"branch"}]
        self.lane_steps = [s for s in plan.steps if s not in self.design_steps]
        self.rows: dict[str, int] = {}
        for end in zip(*graded.ends, strict=True):
            for name in end:
                self.row(name)
        self.places = 0

    def row(self, name: str, count: int = 1) -> int:
        """Return the row of a lane value, reserving it on first use."""
        if name not in self.rows:
            self.rows[name] = self.used()
            for k in range(1, count):
                self.rows[f"{name} + {k}"] = self.used()
        return self.rows[name]

    def used(self) -> int:
        return len(self.rows)

    def use(self, module: str, *names: str) -> None:
        self.text.imports.setdefault(module, set()).update(names)

    def needed_for(self, names: Iterable[str]) -> list[Fact]:
        """Return the lane steps that these values need, branch signs among them."""
        needed, found = set(names), []
        for step in reversed(self.lane_steps):
            if step.name in needed:
                needed.update(step.needs)
                found.insert(0, step)
        return found

    def design_needs(self, steps: Sequence[Fact], names: Iterable[str]) -> list[str]:
        """Return what a loop over lanes reads of the design."""
        needs = [need for step in steps for need in step.needs] + list(names)
        return [n for n in dict.fromkeys(needs) if self.plan.axes[n] <= {"design"}]

    # -- the loops ---------------------------------------------------------------------------------

    def write(self) -> str:
        text, plan = self.text, self.plan
        outputs = ", ".join(f"out_{o.name}" for o in plan.outputs)
        text.open(f"def kernel(x, angles, n, n_angles, w, m, {outputs}):")
        halves = len(plan.computed) * plan.sides
        listed = any(output.request.listed for output in plan.outputs)
        room = max(search.most for search in plan.searches) if listed else 0
        text.add(f"w_rows = w.reshape(w.size // {LANES}, {LANES})")
        text.add(f"m_rows = m.reshape(m.size // {LANES}, {LANES})")
        text.add(f"s = empty({(STATE_ROWS + self.most_needs() + 2) * LANES})")
        text.add(f"s_rows = s.reshape(s.size // {LANES}, {LANES})")
        text.add(f"valleys = empty(({LANES * halves * self.samples}, {ITEM_ROWS}))")
        text.add(f"roots = empty(({3 * LANES * halves * self.samples}, {ITEM_ROWS}))")
        text.add(f"ends = empty(({2 * LANES * halves}, {ITEM_ROWS}))")
        text.add(f"flags = empty({LANES}, int8)")
        text.add(f"lane = empty({LANES}, uint64)")
        text.add("counts = empty(2, int64)")
        text.add(f"found = empty({len(plan.branches) * LANES}, int64)")
        text.add(f"best = empty((4, {len(plan.branches) * LANES}))")
        text.add(f"lists = empty((3, {len(plan.branches) * LANES}, {room}))")
        text.add(f"own = array({[_place(plan.branches, b) for b in plan.computed]})")
        text.add(f"other = array({[self.mirror_of(b) for b in plan.computed]})")
        text.open(f"for i0 in range(0, n, {LANES}):")
        text.add(f"lanes = min({LANES}, n - i0)")
        self.write_designs()
        self.write_samples()
        for number, search in enumerate(plan.searches):
            self.write_search(number, search)
        names = ", ".join(o.name for o in plan.outputs)
        imports = "\n".join(
            f"from {module} import {', '.join(sorted(found))}"
            for module, found in sorted(text.imports.items())
        )
        header = HEADER.format(mechanism=plan.catalogue.name, names=names, imports=imports)
        return header + "\n".join(text.lines) + "\n"

    def mirror_of(self, branch: int) -> int:
        if not self.plan.mirrored:
            return -1
        return next((k for k, b in enumerate(self.plan.branches) if b != branch), -1)

    def most_needs(self) -> int:
        """Return how many design values the items of any search carry."""
        return max(len(self.item_needs(search)) for search in self.plan.searches)

    def item_names(self, search: Search) -> tuple[list[str], list[str]]:
        position = self.plan.catalogue.position.name
        slope = [search.slope, *([self.graded.vanishing] if search.slope_order else [])]
        return slope, [search.quantity, position]

    def item_needs(self, search: Search) -> list[str]:
        slope, value = self.item_names(search)
        return self.design_needs(self.needed_for((*slope, *value)), ())

    def write_designs(self) -> None:
        """What depends on the design alone."""
        text, plan = self.text, self.plan
        text.open(f"for i in range({LANES}):")
        for k, name in enumerate(plan.inputs):
            text.add(f"{name} = x[{k}, i0 + i]")
        for step in self.design_steps:
            paste_fact(
                step, {p: n for p, n in zip(parameters(step.function), step.needs, strict=True)}, "", text
            )
        kept = [name for name in self.rows]
        wanted = [n for search in plan.searches for n in self.item_needs(search)]
        for name in dict.fromkeys((*kept, *wanted)):
            text.add(f"w[{self.row(name) * LANES} + i] = {name}")
        text.close()

    def write_samples(self) -> None:
        """The derivatives at all places of the graded range, for every half of it."""
        text, plan, cells = self.text, self.plan, self.cells
        near, far = self.graded.leaves[:2]
        rows = self.row("places", 2 * (cells + 1))
        self.places = rows
        spare = self.row("spare", 4)
        at_near, at_far = self.row(near), self.row(far)
        scale, start = self.row(self.graded.ends[0][0]), self.row(self.graded.ends[0][1])
        self.use(SEARCH, "place_samples", "fractions")
        text.add(f"place_samples(w_rows, {scale}, {start}, {rows}, {spare}, {cells})")
        text.open(f"for j in range({self.samples}):")
        text.open(f"if j <= {cells}:")
        text.add(f"fractions(w_rows, {rows} + j, {at_near}, {at_far})")
        text.close()
        text.open("else:")
        text.add(f"fractions(w_rows, {rows + 3 * cells + 1} - j, {at_far}, {at_near})")
        text.close()
        for number in range(plan.sides):
            self.write_sample_loop(number, at_near, at_far)
        text.close()

    def write_sample_loop(self, number: int, at_near: int, at_far: int) -> None:
        text, plan = self.text, self.plan
        near, far, side = self.graded.leaves
        wanted = [name for search in plan.searches for name in self.item_names(search)[0]]
        steps = self.needed_for(wanted)
        text.open(f"for i in range({LANES}):")
        text.add(f"{near} = w[{at_near * LANES} + i]")
        text.add(f"{far} = w[{at_far * LANES} + i]")
        text.add(f"{side} = {1.0 - 2.0 * number}")
        for name in self.design_needs(steps, ()):
            text.add(f"{name} = w[{self.row(name) * LANES} + i]")
        for step in (s for s in steps if "branch" not in plan.axes[s.name]):
            self.paste(step, "", "")
        for k, branch in enumerate(plan.computed):
            text.add(f"branch__{branch} = {branch}.0")
            for step in (s for s in steps if "branch" in plan.axes[s.name]):
                self.paste(step, f"__{branch}", f"__{branch}")
            for place, search in enumerate(plan.searches):
                row = self.sample_row(place, k * plan.sides + number)
                text.add(f"m[({row} + j) * {LANES} + i] = {self.scaled(search, f'__{branch}')}")
        text.close()

    def sample_row(self, search: int, half: int) -> int:
        """Return the first row of a search's samples in one half of the range."""
        return (search * len(self.plan.computed) * self.plan.sides + half) * self.samples

    def scaled(self, search: Search, suffix: str) -> str:
        """Return the derivative times the power of sigma that keeps it finite and not zero at a toggle."""

        def named(name: str) -> str:
            return name + suffix if "branch" in self.plan.axes[name] else name

        return " * ".join([named(search.slope), *[named(self.graded.vanishing)] * search.slope_order])

    def paste(self, step: Fact, suffix: str, branch: str) -> None:
        """Append a fact, reading the copies of one branch."""
        values = {
            p: need + (branch if "branch" in self.plan.axes[need] else "")
            for p, need in zip(parameters(step.function), step.needs, strict=True)
        }
        paste_fact(step, values, suffix, self.text)

    # -- one search --------------------------------------------------------------------------------

    def write_search(self, number: int, search: Search) -> None:
        text, plan = self.text, self.plan
        halves = len(plan.computed) * plan.sides
        toggles = self.row(self.graded.ends[0][2])
        start = self.row(self.graded.ends[0][1])
        needs = self.item_needs(search)
        value = STATE_ROWS + self.most_needs()
        self.use(SEARCH, "advance", "begin", "collect", "gather", "split")
        self.use(FOUND, "clear", "collect_ends", "take")
        text.add(f"rows = array({[self.row(name) for name in needs] or [0]})")
        text.add("counts[:] = 0")
        text.add("clear(lists, best, found)")
        for half in range(halves):
            beyond = self.sample_row(number, self.beyond(half))
            sign = -float(search.parity) if plan.mirrored and plan.computed[half] == plan.computed[0] else 1.0
            text.add(
                f"collect(w_rows, m_rows, {self.sample_row(number, half)}, {beyond}, {self.places}, {self.cells}, lanes, {half}, "
                f"{sign}, flags, counts, roots, valleys)"
            )
        outputs = [o for o in plan.outputs if o.request.quantity == search.quantity]
        ends = any(o.request.can_be_refined for o in outputs)
        text.open(f"for phase in range({3 if ends else 2}):")
        text.add("items, total = (valleys, counts[0]) if phase == 0 else (roots, counts[1])")
        if ends:
            text.open("if phase == 2:")
            text.add(
                f"total = collect_ends(w_rows, {start}, lanes, {halves}, {search.at_limit}, best, {len(plan.branches)}, ends)"
            )
            text.add("items = ends")
            text.close()
        text.open(f"for start in range(0, total, {LANES}):")
        text.add("width = gather(items, start, total, w_rows, rows, s_rows, lane)")
        text.add("open_items = begin(s_rows, width, phase)")
        slope, values = self.item_names(search)
        text.open("while open_items > 0:")
        self.write_items(needs, slope)
        text.add(f"s[{F_ROW * LANES} + i] = {self.scaled(search, '')}")
        text.close()
        text.add("open_items = advance(s_rows, width, phase == 0)")
        text.close()
        text.open("if phase == 0:")
        text.add("split(s_rows, width, counts, roots)")
        text.close()
        text.open("else:")
        self.write_items(needs, values)
        for k, name in enumerate(values):
            text.add(f"s[{(value + k) * LANES} + i] = {name}")
        text.close()
        text.add(
            f"take(s_rows, width, {value}, phase == 2, {search.order}, {toggles}, w_rows, {plan.sides}, own, other, "
            f"{float(search.parity)}, lists, best, found)"
        )
        text.close()
        text.close()
        text.close()
        for output in outputs:
            self.write_result(output)

    def beyond(self, half: int) -> int:
        """Return the half that continues a half beyond the ground line."""
        sides = self.plan.sides
        if self.plan.mirrored:
            return 1 - half
        return half // sides * sides + (1 - half % sides) % sides

    def write_items(self, needs: Sequence[str], names: Sequence[str]) -> None:
        """Open the loop over items and compute values at their places."""
        text, plan = self.text, self.plan
        near, far, side = self.graded.leaves
        steps = self.needed_for(names)
        text.open("for i in range(width):")
        text.add(f"place = s[{X * LANES} + i]")
        text.add("square = place * place")
        text.add("rest = 1.0 / (1.0 + square)")
        text.add(f"upper = s[{2 * LANES} + i] > 0.0")
        text.add(f"{near} = rest if upper else square * rest")
        text.add(f"{far} = square * rest if upper else rest")
        text.add(f"half = s[{LANES} + i]")
        if plan.sides == 2:
            # Halves are numbered branch by branch, both sides of each.
            text.add("second = (half == 1.0) | (half == 3.0)")
            text.add(f"{side} = -1.0 if second else 1.0")
            text.add(f"branch = {self.branch_text('half > 1.0')}")
        else:
            text.add(f"{side} = 1.0")
            text.add(f"branch = {self.branch_text('half > 0.0')}")
        used = {need for step in steps for need in step.needs} | set(names)
        for r, name in enumerate(needs):
            if name in used:
                text.add(f"{name} = s[{(STATE_ROWS + r) * LANES} + i]")
        for step in steps:
            self.paste(step, "", "")

    def branch_text(self, second: str) -> str:
        computed = self.plan.computed
        if len(computed) == 1:
            return f"{computed[0]}.0"
        return f"{computed[1]}.0 if {second} else {computed[0]}.0"

    def write_result(self, output: Output) -> None:
        """Copy one result of a search."""
        request = output.request
        if request.reduction is not None:
            row = (GREATEST if request.reduction.suffix == "max" else LEAST) + int(request.place)
            name, rest = "store_best", f"best, {row}"
        elif request.listed == "count":
            name, rest = "store_counts", "found"
        elif request.listed == "kind":
            name, rest = "store_kinds", "lists"
        else:
            name, rest = "store_list", f"lists, {PLACE if request.listed == 'place' else VALUE}"
        self.use(FOUND, name)
        self.text.add(f"{name}(out_{output.name}, i0, lanes, {rest})")


def _place(branches: Sequence[int], branch: int) -> int:
    return branches.index(branch) if branch in branches else -1


def write_refined(plan: RefinedClosure) -> tuple[str, tuple[int, int]]:
    """Return the text of the kernel and the lengths of its two scratch arrays."""
    writer = _Refined(plan)
    text = writer.write()
    halves = len(plan.computed) * plan.sides
    return text, (writer.used() * LANES, len(plan.searches) * halves * writer.samples * LANES)

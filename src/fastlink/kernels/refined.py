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
from fastlink.kernels.search import HALF, ITEM_ROWS, STATE_ROWS, UPPER, X
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
        self.lane_steps = [s for s in plan.steps if s not in self.design_steps]
        self.rows: dict[str, int] = {}
        for end in zip(*graded.ends, strict=True):
            for name in end:
                self.row(name)
        self.places = 0
        # Names of lane values end in the number of their loop: numba takes long over names with two meanings.
        self.loop = ""

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
        needed: set[str] = set(names)
        found: list[Fact] = []
        for step in reversed(self.lane_steps):
            if step.name in needed:
                needed.update(step.needs)
                found.insert(0, step)
        return found

    def design_needs(self, steps: Sequence[Fact]) -> list[str]:
        """Return what a loop over lanes reads of the design."""
        needs = dict.fromkeys(need for step in steps for need in step.needs)
        return [name for name in needs if self.plan.axes[name] <= {"design"}]

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

    def slope_names(self, search: Search) -> list[str]:
        """Return what the sampled function is made of."""
        return [search.slope, *([self.graded.vanishing] if search.slope_order else [])]

    def item_needs(self, search: Search) -> list[str]:
        """Return the design values that an item carries."""
        names = (*self.slope_names(search), search.quantity, self.plan.catalogue.position.name)
        return self.design_needs(self.needed_for(names))

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
        text, cells = self.text, self.cells
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
        self.write_sample_loops()
        text.close()

    def write_sample_loops(self) -> None:
        """One place of the range: both branches side by side where the mirror gives the rest, else half by half.

        What the branches share is computed once in the first case; the second keeps the text of forces short.
        """
        text, plan = self.text, self.plan
        near, far, side = self.graded.leaves
        slopes = [name for search in plan.searches for name in self.slope_names(search)]
        steps = self.needed_for(slopes)
        self.loop = tag = "__s"
        if not plan.mirrored:
            text.open(f"for half in range({len(plan.computed) * plan.sides}):")
            self.write_half("half", "0", "1", "2")
        text.open(f"for i in range({LANES}):")
        for name in (near, far, *self.design_needs(steps)):
            text.add(f"{name}{tag} = w[{self.row(name) * LANES} + i]")
        if plan.mirrored:
            text.add(f"{side}{tag} = 1.0")
            for step in (s for s in steps if "branch" not in plan.axes[s.name]):
                self.paste(step)
            for k, branch in enumerate(plan.computed):
                text.add(f"branch{tag}__{branch} = {branch}.0")
                for step in (s for s in steps if "branch" in plan.axes[s.name]):
                    self.paste(step, f"__{branch}")
                self.store_samples(f"{k}", f"__{branch}")
        else:
            for step in steps:
                self.paste(step)
            self.store_samples("half")
            text.close()
        text.close()

    def store_samples(self, half: str, copy: str = "") -> None:
        """Store the sampled functions of one half."""
        for number, search in enumerate(self.plan.searches):
            row = f"{self.sample_row(number, 0)} + {half} * {self.samples} + j"
            self.text.add(f"m[({row}) * {LANES} + i] = {self.scaled(search, copy)}")

    def write_half(self, half: str, first: str, second: str, third: str) -> None:
        """Tell branch and side of a half: halves are numbered branch by branch, both sides of each."""
        side, tag, computed = self.graded.leaves[2], self.loop, self.plan.computed
        above = f"({half} == {first}) | ({half} == {third})"
        self.text.add(
            f"{side}{tag} = 1.0 if {above} else -1.0" if self.plan.sides == 2 else f"{side}{tag} = 1.0"
        )
        last = second if self.plan.sides == 2 else first
        former = f"{computed[0]}.0 if {half} <= {last} else " if len(computed) > 1 else ""
        self.text.add(f"branch{tag} = {former}{computed[-1]}.0")

    def sample_row(self, search: int, half: int) -> int:
        """Return the first row of a search's samples in one half of the range."""
        return (search * len(self.plan.computed) * self.plan.sides + half) * self.samples

    def named(self, name: str, copy: str = "") -> str:
        """Return the name of a value in this loop, of one branch's copy where there are copies."""
        return name + self.loop + (copy if "branch" in self.plan.axes[name] else "")

    def scaled(self, search: Search, copy: str = "") -> str:
        """Return the derivative times the power of sigma that keeps it finite and not zero at a toggle."""
        factors = [search.slope, *[self.graded.vanishing] * search.slope_order]
        return " * ".join(self.named(name, copy) for name in factors)

    def paste(self, step: Fact, copy: str = "") -> None:
        """Append a fact, reading the copies of one branch."""
        names = (self.named(need, copy) for need in step.needs)
        values = dict(zip(parameters(step.function), names, strict=True))
        paste_fact(
            step, values, self.loop + (copy if "branch" in self.plan.axes[step.name] else ""), self.text
        )

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
            sample = self.sample_row(number, half)
            text.add(
                f"collect(w_rows, m_rows, {sample}, {beyond}, {self.places}, {self.cells}, lanes, {half}, {sign}, "
                "flags, counts, roots, valleys)"
            )
        outputs = [o for o in plan.outputs if o.request.quantity == search.quantity]
        ends = any(o.request.can_be_refined for o in outputs)
        text.open(f"for phase in range({3 if ends else 2}):")
        text.add("items, total = (valleys, counts[0]) if phase == 0 else (roots, counts[1])")
        if ends:
            text.open("if phase == 2:")
            options = f"{search.at_limit}, best, {len(plan.branches)}, ends"
            text.add(f"total = collect_ends(w_rows, {start}, lanes, {halves}, {options})")
            text.add("items = ends")
            text.close()
        text.open(f"for start in range(0, total, {LANES}):")
        text.add("width = gather(items, start, total, w_rows, rows, s_rows, lane)")
        text.add("open_items = begin(s_rows, width, phase)")
        text.open("while True:")
        self.loop = f"__r{number}"
        self.write_items(needs, [*self.slope_names(search), search.quantity])
        text.add(f"s[{F_ROW * LANES} + i] = {self.scaled(search)}")
        text.add(f"s[{value * LANES} + i] = {self.named(search.quantity)}")
        text.close()
        text.open("if open_items == 0:")
        text.add("break")
        text.close()
        text.add("open_items = advance(s_rows, width, phase == 0)")
        text.close()
        text.open("if phase == 0:")
        text.add("split(s_rows, width, counts, roots)")
        text.close()
        text.open("else:")
        self.loop = f"__t{number}"
        self.write_items(needs, [plan.catalogue.position.name])
        text.add(f"s[{(value + 1) * LANES} + i] = {self.named(plan.catalogue.position.name)}")
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
        text, tag = self.text, self.loop
        near, far = self.graded.leaves[:2]
        steps = self.needed_for(names)
        text.open("for i in range(width):")
        text.add(f"square{tag} = s[{X * LANES} + i] * s[{X * LANES} + i]")
        text.add(f"rest{tag} = 1.0 / (1.0 + square{tag})")
        text.add(f"upper{tag} = s[{UPPER * LANES} + i] > 0.0")
        text.add(f"{near}{tag} = rest{tag} if upper{tag} else square{tag} * rest{tag}")
        text.add(f"{far}{tag} = square{tag} * rest{tag} if upper{tag} else rest{tag}")
        text.add(f"half{tag} = s[{HALF * LANES} + i]")
        self.write_half(f"half{tag}", "0.0", "1.0", "2.0")
        used = {need for step in steps for need in step.needs} | set(names)
        for r, name in enumerate(needs):
            if name in used:
                text.add(f"{name}{tag} = s[{(STATE_ROWS + r) * LANES} + i]")
        for step in steps:
            self.paste(step)

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

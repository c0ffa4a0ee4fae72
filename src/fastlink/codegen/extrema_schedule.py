"""Which rows a refined kernel keeps its values in, and which parts of the range it searches."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from fastlink.catalogue.catalogue import Fact
from fastlink.codegen.runtime.cells import STATE_ROWS
from fastlink.codegen.runtime.results import GREATEST, LEAST, PLACE, VALUE

if TYPE_CHECKING:
    from fastlink.plan.program import ExtremaProgram, ExtremumSearch, Output

__all__ = ["ExtremaSchedule"]


class ExtremaSchedule:
    """The steps of a refined plan by loop, and the places of lane values."""

    def __init__(self, plan: ExtremaProgram) -> None:
        self.plan = plan
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

    def row(self, name: str, count: int = 1) -> int:
        """Return the row of a lane value, reserving it on first use."""
        if name not in self.rows:
            self.rows[name] = self.used()
            for k in range(1, count):
                self.rows[f"{name} + {k}"] = self.used()
        return self.rows[name]

    def used(self) -> int:
        """Return how many rows are reserved."""
        return len(self.rows)

    def needed_for(self, names: Iterable[str]) -> list[Fact]:
        """Return the lane steps that these values need, branch signs among them."""
        needed: set[str] = set(names)
        found: list[Fact] = []
        for step in reversed(self.lane_steps):
            if needed.intersection(step.names):
                needed.update(step.depends_on)
                found.insert(0, step)
        return found

    def design_needs(self, steps: Sequence[Fact]) -> list[str]:
        """Return what a loop over lanes reads of the design."""
        depends_on = dict.fromkeys(need for step in steps for need in step.depends_on)
        return [name for name in depends_on if self.plan.axes[name] <= {"design"}]

    def mirror_of(self, branch: int) -> int:
        """Return where the results of a searched branch's mirror go, -1 for nowhere."""
        if not self.plan.mirrored:
            return -1
        return next((k for k, b in enumerate(self.plan.branches) if b != branch), -1)

    @property
    def halves(self) -> int:
        """How many halves of the range are searched: branches and sides of the ground line."""
        return len(self.plan.computed) * self.plan.sides

    def slope_names(self) -> list[str]:
        """Return what the sampled functions are made of."""
        return [self.graded.bounded_factor, *(search.slope for search in self.plan.searches)]

    def slope_of(self, search: ExtremumSearch) -> list[str]:
        """Return what one sampled function is made of."""
        return [self.graded.bounded_factor, search.slope]

    def values_of(self, search: ExtremumSearch) -> list[str]:
        """Return what is evaluated where an extreme was found: the quantity and the input position."""
        return [search.quantity, self.plan.catalogue.position.name]

    def item_needs(self, search: ExtremumSearch) -> list[str]:
        """Return the design values that an item of a search carries."""
        return self.design_needs(self.needed_for((*self.slope_of(search), *self.values_of(search))))

    def wants_ends(self, search: ExtremumSearch) -> int:
        """Tell whether the ends of the range count: 0 for no, 1 where samples begin, 2 at the very end."""
        asked = (o for o in self.plan.outputs if o.request.quantity == search.quantity and not search.onto)
        return (2 if search.at_limit else 1) if any(o.request.can_be_refined for o in asked) else 0

    def beyond(self, half: int) -> int:
        """Return the half that continues a half beyond the ground line."""
        sides = self.plan.sides
        if self.plan.mirrored:
            return 1 - half
        return half // sides * sides + (1 - half % sides) % sides

    def sample_row(self, search: int, half: int) -> int:
        """Return the first row of a search's samples in one half of the range."""
        return (search * self.halves + half) * self.samples

    @cached_property
    def value_row(self) -> int:
        """Row of the state that holds a quantity; that of the input position follows."""
        return STATE_ROWS + max(len(self.item_needs(search)) for search in self.plan.searches)

    def number_of(self, quantity: str) -> int:
        """Return the number of the search for a quantity's extremes, which stands before that for its jumps."""
        return [search.quantity for search in self.plan.searches].index(quantity)

    @staticmethod
    def store_of(output: Output) -> tuple[str, str]:
        """Return the function that copies a result, and what it copies from."""
        request = output.request
        if request.reduction is not None:
            row = {1: GREATEST, -1: LEAST}[request.reduction.sign] + int(request.place)
            return "store_best", f"best, {row}"
        if request.listed == "count":
            return "store_counts", "found"
        if request.listed == "kind":
            return "store_kinds", "lists"
        return "store_list", f"lists, {PLACE if request.listed == 'place' else VALUE}"

    def own_place(self, branch: int) -> int:
        """Return where the results of a searched branch go, -1 for nowhere."""
        return self.plan.branches.index(branch) if branch in self.plan.branches else -1

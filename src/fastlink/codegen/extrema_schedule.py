"""The loop of each value in the kernel of a search, the row that keeps it, the arrays, and the parts of the range."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from fastlink.codegen.runtime import cells, results
from fastlink.codegen.runtime.cells import ITEM_ROWS, LANES, MOST_LANES, STATE_ROWS
from fastlink.codegen.runtime.octaves import OCTAVES
from fastlink.codegen.runtime.splits import MOST_SPLITS, SPLIT_ROWS
from fastlink.codegen.runtime.winners import WINNER_ROWS
from fastlink.codegen.schedule import needed_steps
from fastlink.codegen.source import Array
from fastlink.facts.fact import Fact
from fastlink.facts.names import error_name

if TYPE_CHECKING:
    from fastlink.plan.program import ExtremaProgram, ExtremumSearch

__all__ = ["ExtremaSchedule"]


class ExtremaSchedule:
    """The steps of a search by loop, and the rows of lane values."""

    def __init__(self, program: ExtremaProgram) -> None:
        self.program = program
        self.cells = program.searches[0].cells
        self.samples = 2 * self.cells + 1
        steps = [step for step in program.steps if isinstance(step, Fact)]
        self.design_steps = [step for step in steps if program.axes[step.name] <= {"design"}]
        self.lane_steps = [step for step in steps if step not in self.design_steps]
        self.rows: dict[str, int] = {}
        #: Those that are written where a greatest or least value is at a limit of motion, and only there.
        self.late: set[str] = set()
        # Both ends of each: kernels know the row of the lower end.
        for ends in zip(*program.graded.ends, strict=True):
            for name in ends:
                self.row(name)
        for output in program.outputs:
            for term in output.terms:
                self.row(term.tolerance)
        # positive where a gap counts as zero, so that it is not known whether there is a toggle
        self.doubts = [self.row(error_name(end[2])) for end in program.graded.ends if program.has_bounds]

    def row(self, name: str) -> int:
        """Return the row of a lane value, reserving it on first use."""
        return self.rows.setdefault(name, len(self.rows))

    def needed_for(self, names: Iterable[str]) -> list[Fact]:
        """Return the lane steps that these values need, branch signs among them."""
        return needed_steps(self.lane_steps, names)

    def design_needs(self, steps: Sequence[Fact]) -> list[str]:
        """Return the values of the design that a loop over lanes reads."""
        depends_on = dict.fromkeys(name for step in steps for name in step.depends_on)
        return [name for name in depends_on if self.program.axes[name] <= {"design"}]

    def item_needs(self, search: ExtremumSearch) -> list[str]:
        """Return the design values that an item of a search carries."""
        names = [*self.slope_names(search), search.quantity, *self.places_wanted]
        return self.design_needs(self.needed_for([*names, *search.bounded_by]))

    @property
    def places_wanted(self) -> list[str]:
        """Return the name of the input position where results tell or hang on where extremes are; else none."""
        requests = [output.request for output in self.program.outputs]
        wanted = any(r.is_position or r.listed or r.is_of_gradient for r in requests)
        return [self.program.catalogue.position.name] if wanted else []

    def gradient_names(self, search: ExtremumSearch, *, moving: bool) -> list[str]:
        """Return the derivatives by inputs that are evaluated at the extremes of a search."""
        if moving:
            return list(dict.fromkeys(gradient.moving for gradient in search.gradients if gradient.moving))
        return list(dict.fromkeys(name for gradient in search.gradients for name in gradient.held))

    def gradient_needs(self, search: ExtremumSearch, *, moving: bool) -> list[str]:
        """Return the design values that are read where derivatives by inputs are evaluated."""
        names = self.gradient_names(search, moving=moving)
        own = [name for name in names if self.program.axes[name] <= {"design"}]
        return list(dict.fromkeys([*self.design_needs(self.needed_for(names)), *own]))

    def reserve_for_gradients(self) -> None:
        """Reserve the rows that derivatives by inputs read; what only those at limits of motion do is written late."""
        for moving in (False, True):
            early = set(self.rows)
            for search in self.program.searches:
                for name in self.gradient_needs(search, moving=moving):
                    self.row(name)
        self.late = set(self.rows) - early

    def gradient_base(self, sign: int) -> int:
        """Return the first row of the derivatives of the greatest or least values among the results."""
        return self.most_gradients * (sign < 0)

    def slope_names(self, *searches: ExtremumSearch) -> list[str]:
        """Return the values that the sampled functions are products of."""
        magnitudes = (search.quantity for search in searches if search.magnitude)
        slopes = (name for search in searches for name in (search.slope, *search.divisors[:1]))
        return [self.program.graded.bounded_factor, *slopes, *magnitudes]

    def needs_ends(self, search: ExtremumSearch) -> bool:
        """Tell whether the ends of the range count: where a greatest or least value is requested."""
        requests = (o.request for o in self.program.outputs if not search.onto)
        return any(r.can_be_refined for r in requests if r.quantity == search.quantity)

    def parts_of(self, number: int) -> list[str]:
        """Return the names of the tables of all halves in one search."""
        return [f"part_{number}_{half}" for half in range(self.halves)]

    def parts_that_may_rest(self, number: int) -> list[str]:
        """Return those of halves that are silenced one by one; where they are mirrored, branches are together."""
        own = not self.program.mirrored and not self.program.searches[number].onto
        return self.parts_of(number) if own else []

    def number_of(self, quantity: str) -> int:
        """Return the number of the search for a quantity's extrema, which stands before that for its jumps."""
        return [search.quantity for search in self.program.searches].index(quantity)

    def scratch(self) -> tuple[Array, ...]:
        """Return the arrays that the kernel works in."""
        searches, samples = self.program.searches, self.sample_row(len(self.program.searches), 0)
        columns = len(searches) * len(self.program.branches) * LANES
        room = LANES * self.halves
        kept = max(map(self.room, searches))
        return (
            Array("w", "float64", (len(self.rows), LANES)),
            Array("samples", "float64", (samples, LANES)),
            Array("state", "float64", (self.state_rows, LANES)),
            Array("marks", "int8", (samples, LANES)),
            *self.item_lists(),
            Array("ends", "float64", (ITEM_ROWS, 3 * room + MOST_LANES)),
            Array("octaves", "float64", (OCTAVES, LANES)),
            Array("splits", "float64", (SPLIT_ROWS, LANES * (1 + MOST_SPLITS * self.n_splits) + MOST_LANES)),
            Array("flags", "int8", (LANES,)),
            Array("vectors", "int64", (LANES // MOST_LANES,)),
            Array("counts", "int64", (cells.COUNTS,)),
            Array("best", "float64", (results.BEST_ROWS + 3 * self.program.has_bounds, columns)),
            Array("lists", "float64", (results.LIST_ROWS + self.program.has_bounds, columns, kept)),
            *self.places(columns),
        )

    @property
    def n_splits(self) -> int:
        """How many searches are for places at which cells of others are split."""
        return sum(search.splits for search in self.program.searches)

    def split_by(self, search: ExtremumSearch) -> list[int]:
        """Return the numbers of the searches for places at which the cells of one are split."""
        return [k for k, one in enumerate(self.program.searches) if one.splits and one.slope in search.turns]

    @property
    def most_gradients(self) -> int:
        """The greatest number of derivatives by inputs of one search."""
        return max(len(search.gradients) for search in self.program.searches)

    @property
    def state_rows(self) -> int:
        """The number of rows of the state."""
        return STATE_ROWS + max(map(len, map(self.item_needs, self.program.searches)))

    def places(self, columns: int) -> tuple[Array, ...]:
        """Return the places of greatest and least values, and the derivatives there, where these are requested."""
        if not self.program.has_gradients:
            return ()
        return (
            Array("winners", "float64", (2 * WINNER_ROWS, columns)),
            Array("gradients", "float64", (2 * self.most_gradients, columns)),
        )

    @property
    def kept(self) -> int:
        """The length of the lists that are returned, 0 where none is."""
        has_lists = any(output.request.listed for output in self.program.outputs)
        return max(search.most for search in self.program.searches) if has_lists else 0

    def room(self, search: ExtremumSearch) -> int:
        """Return how many entries a list of extremes has room for, 0 where none is requested."""
        return search.most + results.MORE if self.kept else 0

    def most_items(self, search: ExtremumSearch) -> tuple[int, ...]:
        """Return how many valleys, roots and unresolved cells a design may have; a smooth function has few.

        Rounding errors have as many: each cell has a zero and a valley, which splits into two zeros more; where cells
        are divided, each part of a cell has.
        """
        own = (other for other in self.program.searches if other.quantity == search.quantity)
        of_cell = (10, 10, 4) if any(other.divided for other in own) else (1, 3, 0)
        return tuple(number * self.halves * self.samples for number in of_cell)

    def item_lists(self) -> tuple[Array, ...]:
        """Return the lists of items, with as much room for each lane."""
        most = zip(*map(self.most_items, self.program.searches), strict=True)
        sizes = [(ITEM_ROWS, LANES * max(numbers) + MOST_LANES) for numbers in most]
        names = ("valleys", "roots", "unresolved")
        lists = tuple(Array(name, "float64", size) for name, size in zip(names, sizes, strict=True))
        if not any(search.divided for search in self.program.searches):
            return lists[:2]
        return *lists, Array("fine_marks", "int8", (cells.FINE_SAMPLES, LANES))

    # -- names of values ---------------------------------------------------------------------------

    def copy_for(self, name: str, suffix: str) -> str:
        """Return the name of a value, of one branch's copy where there are copies."""
        return name + self.suffix_for(name, suffix)

    def suffix_for(self, name: str, suffix: str) -> str:
        """Return the ending of the names of one branch's copies, where a value has such."""
        return suffix if "branch" in self.program.axes[name] else ""

    def scaled(self, search: ExtremumSearch, suffix: str = "") -> str:
        """Return the derivative times the power of sin mu that keeps it finite and not zero at a toggle.

        That of a magnitude is half the derivative of the square, which has no kink where the vector is almost zero;
        that of a quotient is multiplied by what it is divided by, so that no pole hides between two samples. Both are 0
        where that is exactly 0, and the derivative no number.
        """
        bounded = self.copy_for(self.program.graded.bounded_factor, suffix)
        factors = [self.copy_for(search.slope, suffix), *[bounded] * search.slope_order]
        divisors = [self.copy_for(divisor, suffix) for divisor in search.divisors]
        factors += divisors
        if search.magnitude:
            value = self.copy_for(search.quantity, suffix)
            # the sign is the same without this factor, where it would overflow or underflow
            factors.append(f"({value} if ({value} > 1e-100) & ({value} < 1e100) else 1.0)")
            factors += [bounded] * search.order
            divisors = [value]
        product = " * ".join(factors)
        return f"(0.0 if {divisors[0]} == 0.0 else {product})" if divisors else product

    # -- branches and halves of the range ----------------------------------------------------------

    @property
    def halves(self) -> int:
        """Number of halves of the range that are searched: branches and sides of the ground line."""
        return len(self.program.searched_branches) * self.program.sides

    def half_beyond(self, half: int) -> int:
        """Return the half that continues a half beyond the ground line."""
        sides = self.program.sides
        if self.program.mirrored:
            return 1 - half
        return half // sides * sides + (1 - half % sides) % sides

    def sign_of(self, search: ExtremumSearch, half: int) -> int:
        """Return the sign with which a function is searched in a half: the mirror continues the first one."""
        return search.slope_parity if self.program.mirrored and half == 0 else 1

    def continued(self, search: ExtremumSearch) -> int:
        """Return the sign with which the half beyond the ends of a half continues the function."""
        return search.slope_parity if self.program.mirrored else 1

    def sample_row(self, search: int, half: int) -> int:
        """Return the first row of a search's samples in one half of the range; the positions stand before them."""
        return 2 * (self.cells + 1) + 4 + (search * self.halves + half) * self.samples

    def own_column(self, branch: int) -> int:
        """Return the number of a searched branch among the results, -1 where it is not."""
        return self.program.branches.index(branch) if branch in self.program.branches else -1

    def mirror_column(self, branch: int) -> int:
        """Return the number among the results of a searched branch's mirror, -1 where it has none there."""
        others = (k for k, other in enumerate(self.program.branches) if other != branch)
        return next(others, -1) if self.program.mirrored else -1

"""The text of a kernel that finds every extremum of some quantities, to rounding.

For a block of designs: samples of the derivatives on the graded range (lanes are designs), the cells that hold a zero,
their refinement (lanes are cells), and the quantities there, see `fastlink.codegen.runtime.cells`. Derivatives by
inputs are evaluated once all extremes of a quantity are known, where the greatest and the least value are: at one input
position, or at limits of motion at a place that moves with them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fastlink.codegen.runtime import beside, cells, pieces
from fastlink.codegen.runtime.beside import MOST_SPLITS, OCTAVES, SPLIT_ROWS
from fastlink.codegen.runtime.cells import ITEM_ROWS, LANES, MOST_LANES, STATE_ROWS, WINNER_ROWS
from fastlink.codegen.source import Array, Source, Text, needed_steps, paste_fact
from fastlink.facts.arc import ARC_FACTS
from fastlink.facts.fact import PIECE, Fact, ranges_of
from fastlink.facts.names import error_name
from fastlink.plan.programs import VALID

if TYPE_CHECKING:
    from fastlink.plan.programs import ExtremaProgram, ExtremumSearch, Output


class ExtremaWriter:
    """One kernel while it is written: the steps of a search by loop, and the rows of lane values."""

    def __init__(self, program: ExtremaProgram) -> None:
        self.program = program
        self.text = Text()
        self.cells = program.searches[0].cells
        self.samples = 2 * self.cells + 1
        self.searched_branches, self.sides = program.searched_branches, program.sides
        steps = [step for step in program.steps if isinstance(step, Fact)]
        self.design_steps = [step for step in steps if program.axes[step.name] <= {"design"}]
        self.lane_steps = [step for step in steps if step not in self.design_steps]
        self.rows: dict[str, int] = {}
        # in the order of `cells.START`, `cells.TOGGLE` and `cells.SCALE`
        scales, starts, toggles = zip(*program.graded.ends, strict=True)
        for name in (*starts, *toggles, *scales):
            self.row(name)
        #: The values of the design that are read where results are stored.
        self.of_results = [term.tolerance for output in program.outputs for term in output.terms]
        self.of_results += [VALID] if any(output.is_assembly for output in program.outputs) else []
        for name in self.of_results:
            self.row(name)
        # positive where a gap counts as zero, so that it is not known whether there is a toggle
        doubted = program.graded.ends if program.has_bounds and not program.in_pieces else ()
        self.doubts = [self.row(error_name(end[2])) for end in doubted]

    def row(self, name: str) -> int:
        """Return the row of a lane value, reserving it on first use."""
        return self.rows.setdefault(name, len(self.rows))

    def needed_for(self, names: Iterable[str]) -> list[Fact]:
        """Return the lane steps that these values need, branch signs among them."""
        return needed_steps(self.lane_steps, names)

    def design_needs(self, names: Sequence[str]) -> list[str]:
        """Return the values of the design that a loop over lanes reads for values, those among these too."""
        read = (name for step in self.needed_for(names) for name in step.depends_on)
        return [name for name in dict.fromkeys((*read, *names)) if self.program.axes[name] <= {"design"}]

    def item_needs(self, search: ExtremumSearch) -> list[str]:
        """Return the design values that an item of a search carries."""
        names = [*self.slope_names(search), search.quantity, *self.places_wanted]
        names += [*search.bounded_by, *search.certain_by, *self.at_zeros(search)]
        return [*self.design_needs(names), *(ARC_FACTS if search.arc else ())]

    @property
    def places_wanted(self) -> list[str]:
        """Return the name of the input position where results tell or hang on where extremes are; else none."""
        requests = [output.request for output in self.program.outputs]
        wanted = any(r.is_position or r.listed or r.is_of_gradient for r in requests)
        wanted = wanted or self.program.searches[0].arc or self.program.in_pieces
        return [self.program.catalogue.position.name] if wanted else []

    def at_zeros(self, search: ExtremumSearch) -> tuple[str, ...]:
        """Return what is evaluated at the zeros of a gap; error bounds only where bounds are requested."""
        return search.at_zeros if self.program.has_bounds else search.at_zeros[:1]

    def gradient_names(self, search: ExtremumSearch) -> list[str]:
        """Return the derivatives by inputs that are evaluated at the extremes of a search."""
        return list(dict.fromkeys(name for gradient in search.gradients for name in gradient.names))

    def reserve_for_gradients(self) -> None:
        """Reserve the rows that derivatives by inputs read."""
        for search in self.program.searches:
            for name in self.design_needs(self.gradient_names(search)):
                self.row(name)

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
        columns = len(searches) * self.columns * LANES
        room, most_carried = LANES * self.halves, max(map(len, map(self.item_needs, searches)))
        return (
            Array("w", "float64", (len(self.rows), LANES)),
            Array("samples", "float64", (samples, LANES)),
            Array("state", "float64", (STATE_ROWS + most_carried, LANES)),
            Array("marks", "int8", (samples, LANES)),
            *self.item_lists(),
            Array("ends", "float64", (ITEM_ROWS, 3 * room + MOST_LANES)),
            Array("octaves", "float64", (OCTAVES, LANES)),
            Array("splits", "float64", (SPLIT_ROWS, LANES * (1 + MOST_SPLITS * self.n_splits) + MOST_LANES)),
            Array("flags", "int8", (LANES,)),
            Array("vectors", "int64", (LANES // MOST_LANES,)),
            Array("counts", "int64", (cells.COUNTS,)),
            *self.places(columns),
            self.lists(columns),
            *(self.of_all() if self.program.in_pieces else ()),
        )

    def of_all(self) -> list[Array]:
        """Return the arrays of pieces, and those of what their extremes come to by design and branch."""
        branches = len(self.program.branches)
        columns, most = len(self.program.searches) * branches * LANES, LANES * branches * pieces.MOST_PIECES
        both = [
            Array(name, "float64", (pieces.PIECE_ROWS, most + 2 * MOST_LANES))
            for name in ("pieces", "further")
        ]
        found = Array("found", "float64", (3, branches * LANES))
        ranges = Array("ranges", "float64", (pieces.RANGE_ROWS, branches * LANES, pieces.MOST_RANGES))
        zeros = [
            Array(name, "float64", (pieces.ZERO_ROWS, LANES, pieces.MOST_ZEROS))
            for name in ("zeros", "leasts")
        ]
        joined = [*self.places(columns), self.lists(columns)]
        return [*both, found, ranges, *zeros, *(replace(array, name=f"all_{array.name}") for array in joined)]

    @property
    def columns(self) -> int:
        """How many columns of results each search has for a lane: one of each branch, or of a piece."""
        return 1 if self.program.in_pieces else len(self.program.branches)

    @property
    def all(self) -> str:
        """What the names of arrays begin with that hold results by design and branch."""
        return "all_" if self.program.in_pieces else ""

    def lists(self, columns: int) -> Array:
        """Return the array of lists of extremes."""
        return Array("lists", "float64", (cells.LIST_ROWS + self.program.has_bounds, columns, self.kept))

    @property
    def n_splits(self) -> int:
        """How many searches are for places at which cells of others are split."""
        return sum(search.splits for search in self.program.searches)

    def split_by(self, search: ExtremumSearch) -> list[int]:
        """Return the numbers of the searches for places at which the cells of one are split."""
        return [k for k, one in enumerate(self.program.searches) if one.splits and one.slope in search.turns]

    def breaks_of(self, search: ExtremumSearch) -> list[int]:
        """Return the numbers of the searches for places at which a quantity that is searched jumps or is infinite."""
        places = [] if search.onto else self.program.graded.breakpoints(search.quantity, "jump", "pole")
        zeros = [place.zero for place in places]
        return [k for k in self.split_by(search) if self.program.searches[k].slope in zeros]

    @property
    def most_gradients(self) -> int:
        """The greatest number of derivatives by inputs of one search."""
        return max(len(search.gradients) for search in self.program.searches)

    def places(self, columns: int) -> list[Array]:
        """Return the greatest and least values, and where requested their places and the derivatives there."""
        rows = {"best": cells.BEST_ROWS + 3 * self.program.has_bounds}
        if self.program.has_gradients:
            rows |= {"winners": 2 * WINNER_ROWS, "gradients": 2 * self.most_gradients}
        return [Array(name, "float64", (number, columns)) for name, number in rows.items()]

    @property
    def kept(self) -> int:
        """The length of the longest list of extremes, 0 where none is requested."""
        return max(map(self.room, self.program.searches))

    def room(self, search: ExtremumSearch) -> int:
        """Return how many entries a list of extremes has room for, 0 where none is requested."""
        return search.most if search.certain_by else 0

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
        return len(self.searched_branches) * self.sides

    def half_beyond(self, half: int) -> int:
        """Return the half that continues a half beyond the ground line."""
        return half if self.program.in_pieces else half ^ 1

    def continued(self, search: ExtremumSearch) -> int:
        """Return the sign with which the half beyond the ends of a half continues the function."""
        return search.slope_parity if self.program.mirrored else 1

    def sign_of(self, search: ExtremumSearch, half: int) -> int:
        """Return the sign with which a function is searched in a half: the mirror continues the first one."""
        return self.continued(search) if half == 0 else 1

    def sample_row(self, search: int, half: int) -> int:
        """Return the first row of a search's samples in one half of the range; the positions stand before them."""
        return 2 * (self.cells + 1) + 4 + (search * self.halves + half) * self.samples

    def columns_of(self, mirror: bool) -> list[int]:
        """Return the numbers of two searched branches among the results, or of their mirrors; -1 for none."""
        branches, searched = self.program.branches, self.searched_branches
        numbers = [
            next((k for k, other in enumerate(branches) if (other != branch) == mirror), -1)
            for branch in searched
        ]
        if mirror and not self.program.mirrored:
            numbers = [-1] * len(searched)
        return [*numbers, *[-1] * (2 - len(searched))]

    # -- evaluation at places: the sampled function, the quantity, derivatives by inputs ---------------

    def write_place(self, position: str, half: str) -> None:
        """Write the distances of a position from the lower and the upper end, over the width, its side and branch.

        Halves are numbered branch by branch, both sides of each.
        """
        text, sides, (first, *others) = self.text, self.sides, self.searched_branches
        low, high, side = self.program.graded.coordinates
        text.add(f"square = {position} * {position}")
        text.add("rest = 1.0 / (1.0 + square)")
        text.add(f"{low} = rest if upper else square * rest")
        text.add(f"{high} = square * rest if upper else rest")
        above = f"1.0 if ({half} == 0.0) | ({half} == 2.0) else -1.0"
        text.add(f"{side} = {above if sides == 2 else '1.0'}")
        if not self.program.in_pieces:
            former = f"{first}.0 if {half} <= {sides - 1.0} else " if others else ""
            text.add(f"branch = {former}{[first, *others][-1]}.0")

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
        if search.certain_by:
            (bound,) = search.certain_by
            with self.evaluation(f"certain_{number}", "place", f"for extremes of {quantity} next to limits"):
                stores = {cells.F: search.slope, cells.SLOPE_BOUND: bound}
                self.write_values([search.slope, bound], stores, self.item_needs(search))
        with self.evaluation(f"value_{number}", "extreme", f"once, of {quantity}"):
            stores, names = {cells.VALUE: quantity}, [quantity, *self.places_wanted]
            # any number will do where places are not wanted: an arc tangent is half of a function such as omega4
            stores[cells.THETA] = stores[cells.IMAGE] = "0.0"
            for position in self.places_wanted:
                stores[cells.THETA] = position
                if search.arc:
                    self.text.use("codegen.runtime.cells", "within_arc")
                    stores[cells.VALUE] = f"within_arc({quantity}, {position}, {', '.join(ARC_FACTS)})"
                    names += ARC_FACTS
                if self.program.mirrored:
                    self.text.use("codegen.runtime.cells", "mirror_image")
                    stores[cells.IMAGE] = f"mirror_image({position}, {2.0 * self.program.graded.axis})"
            names += self.at_zeros(search)
            rows = cells.IMAGE, cells.BOUND, cells.SLOPE_BOUND
            stores |= dict(zip(rows, self.at_zeros(search), strict=False))
            if search.bounded_by:
                names += search.bounded_by
                bound, slope_bound, bend, slope = search.bounded_by
                stores |= {cells.BOUND: bound, cells.SLOPE_BOUND: slope_bound}
                stores |= {cells.BEND: f"abs({bend})", cells.SLOPE: f"abs({slope})"}
            self.write_values(names, stores, self.item_needs(search))
        self.write_gradient_function(number, search)

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
        self.write_place(f"state[{cells.X}, at + i]", f"state[{cells.HALF}, at + i]")
        for name in self.design_needs(names):
            text.add(f"{name} = state[{STATE_ROWS + carried.index(name)}, at + i]")
        for step in self.needed_for(names):
            self.paste(step)
        for row, value in stores.items():
            text.add(f"state[{row}, at + i] = {value}")

    def write_gradients(self, number: int) -> None:
        """Write the derivatives at the greatest and least values of a search, as far as they are requested."""
        text, search = self.text, self.program.searches[number]
        own = [o for o in self.program.outputs if o.request.quantity == search.quantity and not search.onto]
        own = [output for output in own if output.request.is_of_gradient]
        if not own:
            return
        asked = [int(sign in map(sign_of, own)) for sign in (1, -1)]
        text.add(f"asked_{number} = array({[*asked, int(search.magnitude), int(search.folds)]})")
        columns = self.columns * LANES
        text.add(f"columns_{number} = array({[number * columns, (number + 1) * columns]})")
        text.call(cells.judge_winners, f"winners, w, n_here, table, search_{number}, asked_{number}")
        values = sum(not gradient.is_position for gradient in search.gradients)
        wraps = any(o.kind == "wrap" and o.onto == search.quantity for o in self.program.searches)
        jumps = search.folds or wraps or bool(search.known and search.known.jumps)
        for sign in sorted({sign_of(output) for output in own if output.inputs}):
            row, base = WINNER_ROWS * (sign < 0), self.gradient_base(sign)
            text.add(f"gradient_{number}(w, winners, gradients, {row}, {base}, columns_{number}, width)")
            if jumps:
                arguments = f"winners, {row}, columns_{number}, gradients, {base}, {values}"
                text.call(cells.settle_jumps, arguments)

    def write_gradient_function(self, number: int, search: ExtremumSearch) -> None:
        """Write the function of its own that evaluates derivatives at greatest or least values, lanes being designs."""
        if not search.gradients:
            return
        text = self.text
        text.add("@outlined")
        with (
            text.block(f"def gradient_{number}(w, winners, gradients, row__0, base__0, columns__of, width):"),
            text.block(f"for column__0 in range(columns__of[0], columns__of[1], {LANES}):"),
            text.block("for i in lanes(width):", "extreme", f"for derivatives of {search.quantity}"),
        ):
            text.add(f"x__of = winners[row__0 + {cells.AT_X}, column__0 + i]")
            text.add(f"upper = winners[row__0 + {cells.IN_UPPER}, column__0 + i] > 0.0")
            text.add(f"half__of = winners[row__0 + {cells.IN_HALF}, column__0 + i]")
            self.write_place("x__of", "half__of")
            for need in self.design_needs(self.gradient_names(search)):
                text.add(f"{need} = w[{self.row(need)}, i]")
            for step in self.needed_for(self.gradient_names(search)):
                self.paste(step)
            text.add(f"mirrored__of = winners[row__0 + {cells.MIRRORED}, column__0 + i] > 0.0")
            text.add(f"where__of = winners[row__0 + {cells.WHERE}, column__0 + i]")
            for k, gradient in enumerate(search.gradients):
                held = " / ".join(gradient.held) or "0.0"
                held = f"-({held})" if gradient.is_position and gradient.held else held
                moving = gradient.moving or "0.0"
                text.add(f"slope__{k} = {moving} if where__of == {cells.ALONG} else {held}")
                if gradient.is_position or search.parity < 0:
                    text.add(f"slope__{k} = -slope__{k} if mirrored__of else slope__{k}")
                text.add(f"gradients[base__0 + {k}, column__0 + i] = slope__{k} if where__of > 0.0 else nan")
        text.lines += ["", ""]

    def write_gradient_result(self, output: Output, number: int) -> None:
        """Write the copy of a derivative of extremes, of their status, or of a change by tolerances."""
        request, search = output.request, self.program.searches[number]
        target, first = f"out_{output.name}, i0, n_here", number * len(self.program.branches) * LANES
        if request.is_status:
            row = cells.WINNER_ROWS * (sign_of(output) < 0) + cells.CODE
            self.text.call(cells.store_row, f"{target}, {first}, {self.all}winners, {row}")
            return
        kinds = [(one.by, one.is_position) for one in search.gradients]
        base = self.gradient_base(sign_of(output))
        rows = [base + kinds.index((by, request.is_position)) for by in output.inputs]
        if not request.change:
            self.text.call(cells.store_row, f"{target}, {first}, {self.all}gradients, {rows[0]}")
            return
        table, tolerances = f"{output.name}__terms", [self.row(term.tolerance) for term in output.terms]
        self.text.add(
            f"{table} = array({[first, int(request.change == 'rss'), len(rows), *rows, *tolerances]})"
        )
        self.text.call(cells.store_change, f"{target}, {self.all}gradients, w, {table}")

    # -- beside folds and toggles, where slopes may be rounding ----------------------------------------

    @property
    def flagged(self) -> bool:
        """Whether lists of extremes have error bounds, which tell where a list is undecided."""
        return bool(self.kept) and self.program.has_bounds

    @contextmanager
    def gathered(self, number: int, items: str, last: str, first: int = 0) -> Iterator[None]:
        """Write a loop over items of a search, as many at a time as there are lanes."""
        with self.text.block(f"for start in range({first}, {last}, {LANES}):"):
            self.text.call(cells.gather, f"{items}, start, {last}, w, rows_{number}, state", "filled")
            yield

    def call(self, function: Callable[..., Any], functions: str, further: str = "") -> None:
        """Write a call with functions of a search, the items at hand and what else is given."""
        self.text.call(function, f"{functions}, state, filled, vectors{further and ', '}{further}")

    def looks_away(self, number: int) -> bool:
        """Whether the sampled function's signs beside toggles stand for those at toggles."""
        search = self.program.searches[number]
        return (search.divided or not search.parity) and search.order == 0

    def bounds_hidden(self, number: int) -> bool:
        """Whether what is then not looked for is in error bounds."""
        return bool(self.program.searches[number].bounded_by) and self.looks_away(number)

    # -- the kernel ------------------------------------------------------------------------------------

    def write(self) -> Source:
        """Return the kernel."""
        text, searches = self.text, self.program.searches
        text.use("numerics.compiler", "lanes", "outlined")
        self.write_tables()
        of_cuts = [k for k, search in enumerate(searches) if search.cuts]
        others = [k for k in range(len(searches)) if k not in of_cuts]
        with text.lanes_of("n_designs", "i0"):
            if self.program.in_pieces:
                self.write_pieces(of_cuts, others)
            else:
                self.write_pass(others)
            if self.flagged:
                columns = len(self.program.branches) * LANES
                for number in others:
                    if room := self.room(searches[number]):
                        span = f"{number * columns}, {(number + 1) * columns}, {room}"
                        text.call(cells.flag_undecided, f"{self.all}lists, {self.all}best, {span}")
            if not self.program.in_pieces:
                for number in others:
                    self.write_gradients(number)
            for output in self.program.outputs:
                self.write_result(output)
        self.write_functions(self.write_evaluations)
        return text.source(self.program, self.scratch())

    def write_pass(self, numbers: Sequence[int]) -> None:
        """Write some searches in the lanes at hand, from the values of the designs to all extremes."""
        text, searches = self.text, self.program.searches
        with text.block("for i in lanes(width):", "design"):
            self.write_design_values()
        self.write_samples(numbers)
        text.call(cells.clear, "lists, best")
        if self.program.has_gradients:
            text.call(cells.forget_winners, "winners, gradients")
        text.add(f"counts[{cells.DESIGNS}] = n_here")
        text.call(beside.forget_splits, "splits")
        for number in sorted(numbers, key=lambda k: not searches[k].splits):
            self.write_search(number)
        for number in numbers:
            if self.needs_ends(searches[number]):
                self.write_ends(number)
        for row in self.doubts:
            text.call(cells.doubt, f"w, {row}, n_here, lists, best")

    def write_pieces(self, of_cuts: Sequence[int], others: Sequence[int]) -> None:
        """Write how gaps cut the turn into pieces, the searches in these, and what their extremes come to."""
        text, searches, branches = self.text, self.program.searches, self.program.branches
        text.add(
            f"numbers = array({[k for k in others if not (searches[k].onto or searches[k].splits)] or [0]})"
        )
        text.call(pieces.begin_pieces, f"pieces, n_here, array({[float(b) for b in branches]})", "n_pieces")
        for number in of_cuts:
            text.add("n_further = 0")
            with text.lanes_of("n_pieces", "p0"):
                text.call(pieces.forget_zeros, "zeros, leasts")
                self.write_pass([number])
                middle = self.sample_row(number, 0) + self.cells
                arguments = f"pieces, p0, n_here, zeros, leasts, samples, {middle}, {searches[number].cuts}"
                text.call(pieces.cut_pieces, f"{arguments}, further, n_further", "n_further")
            text.call(pieces.close_pieces, "further, n_further, pieces", "n_pieces")
        text.call(cells.clear, "all_lists, all_best")
        text.call(pieces.clear_ranges, "found, ranges")
        if self.program.has_gradients:
            text.call(cells.forget_winners, "all_winners, all_gradients")
        text.call(pieces.note_pieces, "pieces, n_pieces, found, ranges")
        if others:
            with text.lanes_of("n_pieces", "p0"):
                self.write_pass(others)
                for number in others:
                    self.write_gradients(number)
                arguments = f"pieces, p0, n_here, {len(branches)}, numbers"
                text.call(pieces.join_pieces, f"{arguments}, lists, best, all_lists, all_best")
                if self.program.has_gradients:
                    text.call(
                        pieces.join_winners, f"{arguments}, winners, gradients, all_winners, all_gradients"
                    )
        text.count_lanes("n_designs", "i0")
        if self.of_results:
            with text.block("for i in lanes(width):"):
                self.write_design_values(only=self.of_results)

    def write_functions(self, write: Callable[[int, ExtremumSearch], None]) -> None:
        """Write the functions of each search, which the kernel calls."""
        kernel, self.text.lines = self.text.lines, self.text.functions
        for number, search in enumerate(self.program.searches):
            write(number, search)
        self.text.lines = kernel

    def write_tables(self) -> None:
        """Write the tables of whole numbers that tell the searches, branches and halves apart, see `runtime.cells`."""
        program, columns = self.program, [*self.columns_of(False), *self.columns_of(True)]
        tables = {"table": [program.sides, self.halves, self.columns, *columns]}
        for k, search in enumerate(program.searches):
            flags = [int(search.at_limit), int(search.kind == "wrap") - int(search.kind in ("piece", "end"))]
            about = [k, self.number_of(search.quantity), search.order, search.parity]
            tables[f"search_{k}"] = [*about, *flags, self.room(search), *self.most_items(search)]
            if numbers := self.split_by(search):
                tables[f"split_by_{k}"] = numbers
            tables[f"rows_{k}"] = [self.row(name) for name in self.item_needs(search)] or [0]
            for half in range(self.halves):
                first, beyond = self.sample_row(k, half), self.sample_row(k, self.half_beyond(half))
                sign, along = self.sign_of(search, half), self.continued(search)
                tables[f"part_{k}_{half}"] = [first, beyond, half, sign, self.cells, along]
        self.reserve_for_gradients()
        if self.program.has_gradients:
            signs = {sign_of(output) for output in program.outputs if output.request.is_of_gradient}
            tables["signs"] = [int(sign in signs) for sign in (1, -1)]
        for name, numbers in tables.items():
            self.text.add(f"{name} = array({numbers})")

    def write_design_values(self, further: Sequence[str] = (), only: Sequence[str] = ()) -> None:
        """Write the values of the design that the rows hold, and further ones; of a piece what is given of it."""
        rows, lane = only or [*self.rows], "i"
        if self.program.in_pieces and not only:
            lane = f"int(pieces[{pieces.OF_LANE}, p0 + i])"
            for k, name in enumerate(("branch", *PIECE), pieces.BRANCH):
                self.text.add(f"{name} = pieces[{k}, p0 + i]")
        for k, name in enumerate(self.program.inputs):
            self.text.add(f"{name} = designs[{k}, i0 + {lane}]")
        for step in needed_steps(self.design_steps, [*rows, *further]):
            paste_fact(step, step.depends_on, "", self.text)
        for name in rows:
            self.text.add(f"w[{self.row(name)}, i] = {name}")

    def write_samples(self, numbers: Sequence[int]) -> None:
        """Write the derivatives at all samples of the graded range, on both sides: both branches side by side."""
        text, sides = self.text, self.sides
        text.call(cells.place_samples, f"w, samples, {self.cells}, width")
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
                    self.write_sample(numbers)
                with text.block(*lanes):
                    self.write_marks(numbers)

    def write_sample(self, numbers: Sequence[int]) -> None:
        """Write the derivatives at one sample, of some searches."""
        text, program = self.text, self.program
        names = self.slope_names(*(program.searches[number] for number in numbers))
        steps = self.needed_for(names)
        for name, row in zip(program.graded.coordinates, ("low__row", "high__row"), strict=False):
            text.add(f"{name} = samples[{row}, i]")
        side = "1.0 if turn == 0 else -1.0" if program.sides > 1 else "1.0"
        text.add(f"{program.graded.coordinates[2]} = {side}")
        for name in self.design_needs(names):
            text.add(f"{name} = w[{self.row(name)}, i]")
        for step in (s for s in steps if "branch" not in program.axes[s.name]):
            self.paste(step)
        for branch in program.searched_branches:
            text.add(f"branch__{branch} = {branch}.0")
            for step in (s for s in steps if "branch" in program.axes[s.name]):
                self.paste(step, f"__{branch}")
        for number in numbers:
            search = program.searches[number]
            values = [f"f_{number}__{branch}" for branch in program.searched_branches]
            for value, branch in zip(values, program.searched_branches, strict=True):
                text.add(f"{value} = {self.scaled(search, f'__{branch}')}")
            if program.mirrored:
                text.call(cells.silenced, ", ".join(values), ", ".join(values))
            for k, value in enumerate(values):
                text.add(f"{self.sample(number, k, 'j')} = {value}")

    def sample(self, number: int, k: int, j: str) -> str:
        """Return the entry of a sample of a function in one branch."""
        return f"samples[{self.sample_row(number, k * self.sides)} + turn * {self.samples} + {j}, i]"

    def write_marks(self, numbers: Sequence[int]) -> None:
        """Mark the samples before those at hand, of functions in all branches."""
        self.text.use("codegen.runtime.cells", "mark")
        for number in numbers:
            search = self.program.searches[number]
            for k in range(len(self.searched_branches)):
                before, here, now = (self.sample(number, k, j) for j in ("j2", "j1", "j"))
                mark = f"mark({before}, {here}, {now}, {self.sign_of(search, k)}.0)"
                self.text.add(f"{self.sample(number, k, 'j1').replace('samples', 'marks')} = {mark}")

    def write_search(self, number: int) -> None:
        """Write the search for the cells that hold a zero of one function, their refinement, and the extrema there."""
        text, search = self.text, self.program.searches[number]
        text.call(cells.nothing_yet, f"counts, search_{number}")
        parts, split = self.parts_of(number), bool(self.split_by(search))
        slope, value = f"slope_{number}", f"value_{number}"
        for part in self.parts_that_may_rest(number):
            text.call(cells.silence_rest, f"w, samples, marks, {part}, n_here")
        if self.looks_away(number):
            text.call(beside.collect_beside, f"w, table, {parts[0]}, samples, n_here, ends, False", "n_ends")
            with self.gathered(number, "ends", "n_ends"):
                self.call(beside.settle_toggles, slope, "samples")
        if split:
            with self.gathered(number, "splits", f"int(splits[{beside.NEXT}, 0])", LANES):
                self.call(beside.keep_slopes, slope, f"splits, start, split_by_{number}")
        elif self.n_splits:
            text.call(beside.forget_slopes, "splits")
        for part in parts:
            text.call(cells.mark_ends, f"w, samples, marks, {part}, width")
            if split:
                text.call(beside.mark_splits, f"samples, marks, {part}, splits")
            if search.divided:
                text.call(beside.mark_unresolved, f"samples, marks, {part}, width")
        if search.divided or not search.parity:  # else its extremes are counted: none hides
            text.call(beside.collect_beside, f"w, table, {parts[0]}, samples, n_here, ends, True", "n_ends")
            with self.gathered(number, "ends", "n_ends"):
                self.call(beside.search_octaves, slope, "octaves, counts, roots, splits, marks")
                # by its symmetry the slope of one with a parity is 0 at the fold: it falls, and hides nothing
                if self.flagged and search.bounded_by and not (search.onto or search.parity):
                    self.call(beside.mark_hiding, value, f"table, search_{number}, best")
        for part in parts:
            if search.divided:
                arguments = f"samples, marks, {part}, counts, unresolved, splits"
                text.call(beside.collect_unresolved, arguments)
                if split:
                    text.call(beside.collect_jumps, f"{part}, splits, counts, roots")
            text.call(cells.collect, f"samples, marks, {part}, counts, roots, valleys")
        if search.divided:
            text.add("divided = 0")
            with text.block(f"while divided < counts[{cells.UNRESOLVED}]:"):
                items = f"unresolved, divided, counts[{cells.UNRESOLVED}]"
                text.call(cells.gather, f"{items}, w, rows_{number}, state", "filled")
                self.call(beside.divide_cells, slope, "fine_marks, counts, unresolved, roots, valleys")
                text.add("divided = divided + filled")
        if search.cuts:
            text.call(pieces.collect_leasts, f"samples, {parts[0]}, n_here, ends", "n_leasts")
            with self.gathered(number, "ends", "n_leasts"):
                self.call(pieces.keep_leasts, f"{slope}, {value}", "flags, leasts")
        with self.gathered(number, "valleys", f"counts[{cells.VALLEYS}]"):
            self.call(cells.split_valleys, slope, "flags, counts, roots")
        with self.gathered(number, "roots", f"counts[{cells.ROOTS}]"):
            self.call(cells.find_roots, slope, "flags")
            if search.splits:
                text.call(beside.keep_splits, f"state, filled, samples, {parts[0]}, splits, {number}")
            elif search.kind == "jump":
                text.call(cells.copy_row, f"state, filled, {cells.XA}, {cells.X}")
                with text.block("for k in range(4):"):
                    text.call(beside.place_aside, "state, filled, k")
                    self.write_extrema(number, cells.extrema_at_zeros, "state, filled, table")
            elif search.kind == "pole":
                with text.block("for turn in range(2):"):
                    self.call(beside.values_at_pole, value, f"w, table, search_{number}, turn")
                    self.write_extrema(number, beside.pole_values, "state, filled, w")
            else:
                self.write_extrema(number, cells.extrema_at_zeros, "state, filled, table")

    def write_extrema(self, number: int, classify: Callable[..., Any], state: str) -> None:
        """Write the quantity's evaluation at items of a search, what is extreme there, and its storing."""
        text, search = self.text, self.program.searches[number]
        if search.cuts:
            self.call(cells.evaluate_items, f"value_{number}")
            text.call(pieces.keep_zeros, "state, filled, zeros, leasts")
            return
        listed = bool(search.certain_by) and classify is cells.extrema_at_zeros
        if listed:
            self.call(cells.find_certain, f"certain_{number}", "w")
        self.call(cells.evaluate_items, f"value_{number}")
        if classify is beside.end_values and search.at_limit:
            self.call(beside.values_lost, f"value_{number}", "w")
        text.call(classify, f"{state}, search_{number}")
        if breaks := self.breaks_of(search):
            text.call(beside.unlist_jumps, f"state, filled, splits, array({breaks})")
        if classify is cells.extrema_at_zeros:
            text.call(cells.drop_folds, f"state, filled, w, search_{number}")
        if self.program.has_bounds and classify is cells.extrema_at_zeros:
            text.call(cells.bound_zeros, f"state, filled, search_{number}, {int(search.magnitude)}")
            if search.kind == "jump":
                text.call(beside.bound_aside, "state, filled")
            if listed and not search.onto:
                text.call(cells.note_uncertain, f"state, filled, w, table, search_{number}, best")
        elif self.program.has_bounds and search.kind != "pole":
            text.call(cells.bound_ends, "state, filled, w")
            if self.bounds_hidden(number):
                text.call(beside.bound_hidden, "state, filled")
        if self.program.has_gradients:
            arguments = f"state, filled, table, search_{number}, winners, signs"
            text.call(cells.note_winners, arguments)
            if search.kinked and classify is cells.extrema_at_zeros:
                text.call(cells.note_kinks, arguments)
        text.call(cells.store_extrema, f"state, filled, table, search_{number}, lists, best")

    def write_ends(self, number: int) -> None:
        """Write the values at the ends of the range, where these may be extreme."""
        text, search = self.text, self.program.searches[number]
        arguments = f"w, n_here, table, search_{number}, best, ends, {int(self.program.in_pieces)}"
        text.call(beside.collect_ends, arguments, "n_ends")
        for part in self.parts_that_may_rest(number):
            text.call(cells.collect_rest, f"samples, {part}, n_here, ends, n_ends", "n_ends")
        with self.gathered(number, "ends", "n_ends"):
            if search.order > 0:
                self.call(beside.values_beside, f"value_{number}", "w")
            if self.bounds_hidden(number):
                self.call(beside.find_hidden, f"slope_{number}, value_{number}", "w")
            text.call(cells.copy_row, f"state, filled, {cells.X}, {cells.XA}")
            self.write_extrema(number, beside.end_values, "state, filled, w")

    def write_result(self, output: Output) -> None:
        """Write the copy of one result of a search."""
        request = output.request
        if output.is_assembly:
            target = f"out_{output.name}, i0, n_here"
            row = ranges_of(self.program.catalogue.position.name).get(output.name, -1)
            if row < 0:
                self.text.call(pieces.store_assembly, f"{target}, found, w, {self.row(VALID)}")
            else:
                self.text.call(cells.store_list, f"{target}, 0, ranges, {row}, {'nan' if row < 2 else '0.0'}")
            return
        number = self.number_of(request.quantity)
        base = number * len(self.program.branches) * LANES
        target = f"out_{output.name}, i0, n_here, {base}"
        if request.is_of_gradient:
            self.write_gradient_result(output, number)
        elif request.reduction is not None:
            least = request.reduction.sign < 0
            row, at, bound = cells.ROWS_OF_LEAST if least else cells.ROWS_OF_GREATEST
            row = at if request.is_position else bound if request.is_error else row
            self.text.call(cells.store_best, f"{target}, {self.all}best, {row}, {at}")
        elif request.listed == "count":
            self.text.call(cells.store_counts, f"{target}, {self.all}best")
        else:
            row = cells.LIST_ROW_OF[request.listed]
            beyond = "0.0" if row == cells.LIST_KIND else "nan"
            self.text.call(cells.store_list, f"{target}, {self.all}lists, {row}, {beyond}")


def sign_of(output: Output) -> int:
    """Return 1 for greatest values, -1 for least ones, 0 for a list."""
    reduction = output.request.reduction
    return reduction.sign if reduction is not None else 0


def write_extrema(program: ExtremaProgram) -> Source:
    """Return the text of the kernel, and what it is called with."""
    return ExtremaWriter(program).write()

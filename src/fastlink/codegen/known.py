"""The text of a kernel of extremes that are known: the greatest and the least of a quantity at a few places.

One loop over lanes that are designs, without any branch. The places are the ends of the range, and those that facts of
the design give (`fastlink.facts.fact.KnownExtremes`); what counts of them is what a search would have found there, in
its order. From there on they are as extremes that are searched: their bounds, their derivatives and the results are
written by `fastlink.codegen.extremes`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fastlink.codegen.extremes import ExtremaWriter, sign_of
from fastlink.codegen.runtime import cells
from fastlink.codegen.runtime.cells import LANES
from fastlink.codegen.source import Array, Source, paste_fact
from fastlink.facts.names import error_name

if TYPE_CHECKING:
    from fastlink.facts.fact import KnownExtremes
    from fastlink.plan.programs import ExtremumSearch, KnownProgram


#: The labels of the ends of the range, the lower one first.
ENDS = ("low", "high")


@dataclass(frozen=True)
class Half:
    """One side of the ground line in one branch, and whether its mirror image is meant."""

    branch: int
    side: int
    mirrored: bool

    @property
    def endings(self) -> dict[str, str]:
        """The endings of names of values that depend on the branch and on the side."""
        return {"branch": str(self.branch), "side": str(int(self.side > 0))}


@dataclass(frozen=True)
class Candidate:
    """Kernel text of a value that may be the greatest or the least, of its input position and error bound.

    `at` is the place in a half, `kind` is 1 for a zero of the slope, 0 for an end of the range, 2 for a jump.
    """

    greatest: str
    least: str
    place: str
    bound: str
    at: str
    half: Half
    kind: str


class KnownWriter(ExtremaWriter):
    """One kernel while it is written."""

    def __init__(self, program: KnownProgram) -> None:
        super().__init__(program)
        self.written: set[str] = set()
        # no sample is placed: only what derivatives hang on is kept
        _, starts, toggles = zip(*program.graded.ends, strict=True)
        self.rows = {}
        for name in (*starts, *toggles) if program.has_gradients else ():
            self.row(name)
        # quantities of both symmetries are in one kernel
        self.searched_branches, self.sides = tuple(program.catalogue.branches), 2

    def write(self) -> Source:
        """Return the kernel."""
        text, searches = self.text, self.program.searches
        text.use("numerics.compiler", "lanes", "outlined")
        if self.program.has_gradients:
            self.write_tables()
        with text.lanes_of("n_designs", "i0"):
            with text.block("for i in lanes(width):", "design"):
                self.write_places()
                for number, search in enumerate(searches):
                    for k, branch in enumerate(self.program.branches):
                        self.write_extremes(search, branch, (number * len(self.program.branches) + k) * LANES)
            for number in range(len(searches)):
                self.write_gradients(number)
            for output in self.program.outputs:
                self.write_result(output)
        self.write_functions(self.write_gradient_function)
        columns = len(searches) * len(self.program.branches) * LANES
        rows = Array("w", "float64", (max(len(self.rows), 1), LANES))
        return text.source(self.program, [rows, *self.places(columns)])

    def write_tables(self) -> None:
        """Write those parts of the tables of a search that tell where derivatives are evaluated."""
        table = [self.sides, 0, len(self.program.branches)]
        self.text.add(f"table = array({table})")
        for number in range(len(self.program.searches)):
            self.text.add(f"search_{number} = array({[number]})")
        self.reserve_for_gradients()

    # -- values at places --------------------------------------------------------------------------

    def write_places(self) -> None:
        """Write the values that depend on the design alone, the sides and the branches."""
        text, side = self.text, self.program.graded.coordinates[2]
        names = [*(name for end in self.program.graded.ends for name in end[1:]), *self.places_wanted]
        for search in self.program.searches:
            assert search.known is not None
            names += [search.quantity, *search.known.facts, *search.bounded_by]
            names += [search.slope] if search.slope in self.program.axes else []
            names += [error_name(end[2]) for end in self.program.graded.ends if search.bounded_by]
        self.write_design_values([*names, *self.design_needs(names)])
        text.add(f"{side}__1 = 1.0")
        text.add(f"{side}__0 = -1.0")
        for branch in self.program.catalogue.branches:
            text.add(f"branch__{branch} = {branch}.0")

    def suffix(self, name: str, place: str, endings: Mapping[str, str]) -> str:
        """Return the ending of the name of a value at a place of a half."""
        axes = self.program.axes[name]
        return "".join(f"__{part}" for axis, part in {"place": place, **endings}.items() if axis in axes)

    def values(self, names: Sequence[str], place: str, half: Half) -> Iterator[str]:
        """Write values at a place of a half, as far as they are not known, and yield their names."""
        self.write_known_place(place)
        for step in self.needed_for(names):
            suffix = self.suffix(step.name, place, half.endings)
            if step.name + suffix not in self.written:
                self.written.add(step.name + suffix)
                known = [name + self.suffix(name, place, half.endings) for name in step.depends_on]
                paste_fact(step, known, suffix, self.text)
        yield from (name + self.suffix(name, place, half.endings) for name in names)

    def end_of(self, place: str) -> tuple[str, str]:
        """Return the first sample and the toggle of the end of the range that a place is; empty if it is none."""
        ends = {label: end[1:] for label, end in zip(ENDS, self.program.graded.ends, strict=True)}
        return ends.get(place.removesuffix("_beside"), ("", ""))

    def write_known_place(self, place: str) -> None:
        """Write the distances of a place from the lower and the upper end, over the width."""
        if place in self.written:
            return
        self.written.add(place)
        text, (low, high, _) = self.text, self.program.graded.coordinates
        first, _ = self.end_of(place)
        if first:
            x = f"-{first} if {first} < 0.0 else 0.0" if place in ENDS else f"abs({first})"
            text.add(f"x__{place} = {x}")
            near, far = (low, high) if place.startswith(ENDS[0]) else (high, low)
            # the first place is at most 2^-60, and 1 + 2^-120 is 1
            text.add(f"{near}__{place} = x__{place} * x__{place}")
            text.add(f"{far}__{place} = 1.0")
            return
        upper = f"{place} > 1.0"
        text.add(f"x__{place} = 1.0 / {place} if {upper} else {place}")
        text.add(f"square__{place} = x__{place} * x__{place}")
        text.add(f"rest__{place} = 1.0 / (1.0 + square__{place})")
        text.add(f"part__{place} = square__{place} * rest__{place}")
        text.add(f"{low}__{place} = rest__{place} if {upper} else part__{place}")
        text.add(f"{high}__{place} = part__{place} if {upper} else rest__{place}")

    # -- what may be extreme -----------------------------------------------------------------------

    def halves_of(self, search: ExtremumSearch, branch: int) -> list[Half]:
        """Return the halves of the range that a branch has, in the order of a search."""
        if search.mirrored:
            return [Half(other, 1, other != branch) for other in self.program.catalogue.branches]
        return [Half(branch, 1, False), Half(branch, -1, False)]

    def of_half(self, known: KnownExtremes, of: Mapping[int, tuple[str, ...]], half: Half) -> tuple[str, ...]:
        """Return the places of a half, of those by branch on the upper side."""
        branches = self.program.catalogue.branches
        others = dict(zip(branches, reversed(branches), strict=True))
        return of.get(others[half.branch] if known.exchanged and half.side < 0 else half.branch, ())

    def candidates(self, search: ExtremumSearch, branch: int) -> Iterator[Candidate]:
        """Write and yield what may be extreme in a branch: zeros of the slope, jumps by a full turn, ends."""
        known = search.known
        assert known is not None
        halves, found = self.halves_of(search, branch), []
        for half in halves:
            for place in self.of_half(known, known.places, half):
                candidate = self.candidate(search, place, half, self.apart_from_folds(place))
                found.append(candidate.greatest)
                yield candidate
        for half in halves:
            for place in self.of_half(known, known.jumps, half):
                self.text.use("numerics.elementary", "PI")
                name = self.bind(f"jump__{place}", f"PI if ({place} > 0.0) & ({place} < inf) else nan")
                found.append(name)
                place_of = self.place(place, half)
                if self.program.has_bounds:
                    self.text.use("codegen.runtime.cells", "OF_PI")
                yield Candidate(name, f"-{name}", place_of, "OF_PI", place, half, "2.0")
        none = " & ".join(f"({name} != {name})" for name in dict.fromkeys(found))
        for half in halves:
            for end in ENDS:
                first, _ = self.end_of(end)
                place = end if search.at_limit else f"{end}_beside"
                counts = f"({first} != 0.0) | ({none})" if known.places else ""
                yield self.candidate(search, place, half, counts)

    def candidate(self, search: ExtremumSearch, place: str, half: Half, counts: str = "") -> Candidate:
        """Write the value of a quantity at a place of a half, and return it; NaN where it does not count."""
        (value,) = self.values([search.quantity], place, half)
        label = f"{search.quantity}__{place}__{half.branch}__{int(half.side > 0)}__{int(half.mirrored)}"
        sign = "-" if half.mirrored and search.parity < 0 else ""
        text = f"{sign}{value} if {counts} else nan" if counts else f"{sign}{value}"
        name = self.bind(f"value__{label}", text)
        first, _ = self.end_of(place)
        kind = "1.0"
        if first:
            kind = "0.0"
            if self.program.has_gradients and search.known is not None and not search.known.places:
                (slope,) = self.values([search.slope], place, half)  # not a number where nothing can move
                kind = f"(1.0 if ({first} == 0.0) & ({slope} == {slope}) else 0.0)"
        bound = self.bound(search, place, half, label)
        return Candidate(name, name, self.place(place, half), bound, place, half, kind)

    def apart_from_folds(self, place: str) -> str:
        """Write whether a place is another one than a fold at an end of the range, which no search finds."""
        self.write_known_place(place)
        (_, low, toggle_low), (_, high, toggle_high) = self.program.graded.ends
        self.text.use("codegen.runtime.cells", "FOLDED")
        upper = f"{place} > 1.0"
        first, toggle = f"({high} if {upper} else {low})", f"({toggle_high} if {upper} else {toggle_low})"
        return self.bind(f"apart__{place}", f"(x__{place} >= FOLDED * abs({first})) | ({toggle} > 0.0)")

    def bind(self, name: str, text: str) -> str:
        """Write the assignment of a value that is not known, and return its name."""
        if name not in self.written:
            self.written.add(name)
            self.text.add(f"{name} = {text}")
        return name

    def place(self, place: str, half: Half) -> str:
        """Write the input position of a place of a half, or of its mirror image, if positions are requested."""
        if not self.places_wanted:
            return "0.0"
        (found,) = self.values(self.places_wanted, place, half)
        if not half.mirrored:
            return found
        self.text.use("codegen.runtime.cells", "mirror_image")
        return self.bind(f"{found}__image", f"mirror_image({found}, {2.0 * self.program.graded.axis})")

    def bound(self, search: ExtremumSearch, place: str, half: Half, label: str) -> str:
        """Write the error bound of a value at a place, if it is requested."""
        if not search.bounded_by:
            return "nan"
        own, slope_bound, bend, slope = self.values(search.bounded_by, place, half)
        (value,) = self.values([search.quantity], place, half)
        text, name = self.text, f"bound__{label}"
        text.use("codegen.runtime.cells", "bound_at_zero", "known")
        if name in self.written:
            return name
        zero = f"zero__{label}"
        text.add(f"own__{label}, {zero} = bound_at_zero({own}, abs({slope}), {slope_bound}, abs({bend}))")
        first, toggle = self.end_of(place)
        if not first:
            return self.bind(name, f"known({zero})")
        text.use("codegen.runtime.cells", "MARGIN", "has_no_bound", "off_at_end")
        off = f"off_at_end(x__{place}, abs({slope}), {slope_bound}, abs({bend}), {first})"
        lost = f"has_no_bound(x__{place}, abs({value}), abs({bend}), {first}, {toggle})"
        at_end = f"(inf if {lost} else known(MARGIN * {own} + {off}))"
        if search.known is not None and search.known.places:
            return self.bind(name, at_end)
        return self.bind(name, f"{at_end} if ({first} != 0.0) | ({slope} != {slope}) else known({zero})")

    # -- results -----------------------------------------------------------------------------------

    def write_extremes(self, search: ExtremumSearch, branch: int, column: int) -> None:
        """Write the greatest and the least value of a quantity in one branch into their column of the results."""
        own = [output for output in self.program.outputs if output.request.quantity == search.quantity]
        candidates = list(self.candidates(search, branch))
        for sign in (1, -1):
            outputs = [output for output in own if sign_of(output) == sign]
            if any(not output.request.is_of_gradient for output in outputs):
                self.write_extreme(candidates, sign, column, bounded=bool(search.bounded_by))
            if any(output.request.is_of_gradient for output in outputs):
                self.write_winner(candidates, sign, column)

    def write_extreme(
        self, candidates: Iterable[Candidate], sign: int, column: int, *, bounded: bool
    ) -> None:
        """Write which of the candidates is the greatest or the least, with its place and bound."""
        text, better = self.text, ">" if sign > 0 else "<"
        text.add(f"extreme = {'-inf' if sign > 0 else 'inf'}")
        text.add("bound = 0.0")
        if self.places_wanted:
            text.add("place = nan")
        for candidate in candidates:
            value = candidate.greatest if sign > 0 else candidate.least
            if bounded:
                text.use("codegen.runtime.cells", "of_better")
                ahead = f"extreme, bound, {value}" if sign > 0 else f"-extreme, bound, -({value})"
                text.add(f"bound = of_better({ahead}, {candidate.bound})")
            if self.places_wanted:
                text.add(f"place = {candidate.place} if {value} {better} extreme else place")
            text.add(f"extreme = {value} if {value} {better} extreme else extreme")
        row = cells.GREATEST if sign > 0 else cells.LEAST
        text.add(f"best[{row}, {column} + i] = extreme")
        place = (
            "place" if self.places_wanted else f"nan if extreme == {'-inf' if sign > 0 else 'inf'} else 0.0"
        )
        text.add(f"best[{row | 1}, {column} + i] = {place}")
        if bounded:
            doubt = " | ".join(f"({error_name(end[2])} > 0.0)" for end in self.program.graded.ends)
            row = cells.GREATEST_BOUND if sign > 0 else cells.LEAST_BOUND
            text.add(f"best[{row}, {column} + i] = inf if {doubt} else bound")

    def write_winner(self, candidates: Iterable[Candidate], sign: int, column: int) -> None:
        """Write where the greatest or least of the candidates is, for its derivatives: see `cells.note_winners`."""
        text, kept = self.text, {"BEST": "-inf", "SECOND": "-inf", "PLACE": "nan", "OF_KIND": "nan"}
        kept |= dict.fromkeys(("AT_X", "IN_HALF", "IN_UPPER", "MIRRORED"), "0.0")
        for name, value in kept.items():
            text.add(f"{name}__ = {value}")
        text.use("codegen.runtime.cells", "next_best")
        for candidate in candidates:
            at, half = candidate.at, candidate.half
            self.write_known_place(at)
            number = self.sides * self.searched_branches.index(half.branch) + int(half.side < 0)
            values = {"BEST": "high", "PLACE": candidate.place, "OF_KIND": candidate.kind, "AT_X": f"x__{at}"}
            is_upper = f"(1.0 if {at} > 1.0 else 0.0)"
            if self.end_of(at)[0]:
                is_upper = "1.0" if at.startswith(ENDS[1]) else "0.0"
            values |= {"IN_HALF": f"{number}.0", "IN_UPPER": is_upper, "MIRRORED": f"{int(half.mirrored)}.0"}
            text.add(f"high = {candidate.greatest if sign > 0 else f'-({candidate.least})'}")
            text.add("better = high > BEST__")
            text.add(f"SECOND__ = next_best(BEST__, SECOND__, PLACE__, high, {candidate.place})")
            for name, value in values.items():
                text.add(f"{name}__ = {value} if better else {name}__")
        for name in kept:
            row = cells.WINNER_ROWS * (sign < 0) + getattr(cells, name)
            text.add(f"winners[{row}, {column} + i] = {name}__")


def write_known(program: KnownProgram) -> Source:
    """Return the text of the kernel, and what it is called with."""
    return KnownWriter(program).write()

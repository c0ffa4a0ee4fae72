"""The text of a kernel of extremes that are known: the greatest and the least of a quantity at a few places.

One loop over lanes that are designs, without any branch. The places are the ends of the range, and those that facts of
the design give (`fastlink.facts.fact.KnownExtremes`); what counts of them is what a search would have found there, in
its order, so that values, places and bounds are the same, see `fastlink.codegen.extremes`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fastlink.codegen.runtime.cells import LANES
from fastlink.codegen.source import Array, Source, Text, needed_steps, paste_fact
from fastlink.facts.fact import Fact
from fastlink.facts.names import error_name

if TYPE_CHECKING:
    from fastlink.facts.fact import KnownExtremes
    from fastlink.plan.programs import ExtremumSearch, KnownProgram, Output


# -- The text of derivatives by inputs of extremes that are known: where the greatest or the least of the
#    candidates is

# Which of them that is, how near the next best comes and what derivatives are worth there is as in a
# search, see `fastlink.codegen.runtime.results`. They are evaluated once, at the place of the best in each
# lane.


#: What is known of the best candidate: its value, input position, place and kind, where that is, and the next best.
FIRST = {"best": "-inf", "place": "nan", "x": "nan", "upper": "0.0", "kind": "nan", "mirrored": "0.0"}
FIRST |= {"branch": "1.0", "side": "1.0", "second": "-inf"}


def kind_at_end(writer: KnownWriter, search: ExtremumSearch, value: str, rests: str) -> str:
    """Return the kind of an extreme at an end of the range: 0 at limits of motion, else 1 or, where an angle folds, 2.

    Driven past 0 or pi an angle from 0 to pi turns back there, whatever the lengths: its extreme is one or the other.
    """
    if not search.folds:
        return f"(1.0 if {rests} else 0.0)"
    writer.text.use("codegen.runtime.results", "FOLD")
    writer.text.use("numerics.elementary", "PI")
    folded = f"({value} < FOLD) | ({value} > PI - FOLD)"
    return f"(2.0 if {folded} else (1.0 if {rests} else 0.0))"


def write_gradients(
    writer: KnownWriter, search: ExtremumSearch, candidates: Sequence[Candidate], sign: int, label: str
) -> dict[tuple[str, bool] | str, str]:
    """Write the derivatives of a greatest or least value and of its place."""
    best = {key: f"{key}__of__{label}" for key in FIRST}
    for key, name in best.items():
        writer.text.add(f"{name} = {FIRST[key]}")
    for candidate in candidates:
        _write_candidate(writer, candidate, sign, best)
    code, at_limit = _write_code(writer, best, label)
    endings = _write_place(writer, best, at_limit, label)
    found: dict[tuple[str, bool] | str, str] = {"": code}
    known = f"(({code} <= TIED) | ({code} == CONSTANT))"
    for gradient in search.gradients:
        *held, moving = [*writer.values_at(gradient.held, label, endings), "0.0"]
        if gradient.moving:
            (moving,) = writer.values_at((gradient.moving,), label, endings)
        quotient = gradient.is_position and bool(held)
        still = f"-({held[0]} / {held[1]})" if quotient else (held or ["0.0"])[0]
        turned = gradient.is_position or search.parity < 0
        name = f"slope_{'of_place' if gradient.is_position else 'of_value'}_{gradient.by}__{label}"
        writer.text.add(f"{name} = {moving} if {at_limit} else {still}")
        if turned:
            writer.text.add(f"{name} = -{name} if {best['mirrored']} > 0.0 else {name}")
        none = "nan" if gradient.is_position else f"(0.0 if {code} == JUMP else nan)"
        writer.text.add(f"{name} = {name} if {known} else {none}")
        found[gradient.by, gradient.is_position] = name
    return found


def _write_candidate(writer: KnownWriter, candidate: Candidate, sign: int, best: dict[str, str]) -> None:
    """Write whether a candidate is better than the best so far, and what is kept then."""
    text, at, half = writer.text, candidate.at, candidate.half
    text.use("codegen.runtime.results", "SAME")
    text.use("numerics.elementary", "TWO_PI")
    text.add(f"high = {candidate.greatest}" if sign > 0 else f"high = -({candidate.least})")
    text.add(f"apart = abs({candidate.place} - {best['place']})")
    text.add("same = (apart < SAME) | (abs(apart - TWO_PI) < SAME)")
    text.add("differs = (apart >= SAME) & (abs(apart - TWO_PI) >= SAME)")
    text.add(f"better = high > {best['best']}")
    second = best["second"]
    other = f"(high if (high > {second}) & differs else {second})"
    text.add(f"{second} = ({second} if same else {best['best']}) if better else {other}")
    writer.write_place(at)
    values = {
        "best": "high",
        "place": candidate.place,
        "x": f"x__{at}",
        "upper": writer.is_upper(at),
        "kind": candidate.kind,
        "mirrored": f"{int(half.mirrored)}.0",
        "branch": f"{half.branch}.0",
        "side": f"{half.side}.0",
    }
    for key, value in values.items():
        text.add(f"{best[key]} = {value} if better else {best[key]}")


def _write_code(writer: KnownWriter, best: dict[str, str], label: str) -> tuple[str, str]:
    """Write what derivatives are worth, and whether they are those at a limit of motion; return their names."""
    text, code, at_limit = writer.text, f"code__{label}", f"at_limit__{label}"
    codes = ("AT_CHANGE_POINT", "AT_LIMIT", "CONSTANT", "JUMP", "NOTHING", "SMOOTH", "TIED")
    text.use("numerics.compiler", *codes)
    text.use("codegen.runtime.results", "TIE")
    text.use("codegen.runtime.results", "FOLDED")
    (_, low, toggle_low), (_, high, toggle_high) = writer.program.graded.ends
    text.add(f"first__{label} = abs({high} if {best['upper']} > 0.0 else {low})")
    text.add(f"toggle__{label} = ({toggle_high} if {best['upper']} > 0.0 else {toggle_low}) > 0.0")
    text.add(f"no_toggle__{label} = ({toggle_high} if {best['upper']} > 0.0 else {toggle_low}) == 0.0")
    kind, value = best["kind"], best["best"]
    beside = f"(({kind} == 0.0) | ({best['x']} < FOLDED * first__{label}))"
    text.add(f"{code} = 1.0 * AT_LIMIT if {kind} == 0.0 else 1.0 * SMOOTH")
    text.add(f"{code} = 1.0 * TIED if {best['second']} >= {value} - TIE * abs({value}) else {code}")
    text.add(f"{code} = 1.0 * CONSTANT if ({kind} == 0.0) & no_toggle__{label} else {code}")
    text.add(
        f"{code} = 1.0 * AT_CHANGE_POINT if (first__{label} > 0.0) & no_toggle__{label} & {beside} else {code}"
    )
    text.add(f"{code} = 1.0 * JUMP if {kind} == 2.0 else {code}")
    text.add(f"{code} = {code} if {kind} == {kind} else 1.0 * NOTHING")
    text.add(f"{at_limit} = ({kind} == 0.0) & (({code} < CONSTANT) | ({code} > CONSTANT))")
    return code, at_limit


def _write_place(writer: KnownWriter, best: dict[str, str], at_limit: str, label: str) -> dict[str, str]:
    """Write the place of the best in each lane, at limits beside them; return the endings of names there."""
    text, (low, high, side), first = writer.text, writer.program.coordinates, f"first__{label}"
    x = best["x"]
    text.add(f"x__{label} = {first} if {at_limit} & ({x} < {first}) else {x}")
    writer.write_parts(label, f"{best['upper']} > 0.0", (low, high))
    text.add(f"{side}__{label} = {best['side']}")
    text.add(f"branch__{label} = {best['branch']}")
    return {"branch": label, "side": label}


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


class KnownWriter:
    """One kernel while it is written."""

    def __init__(self, program: KnownProgram) -> None:
        self.program, self.text = program, Text()
        self.position = program.catalogue.position.name
        self.steps = [step for step in program.steps if isinstance(step, Fact)]
        self.rows: dict[str, int] = {}
        self.written: set[str] = set()

    def write(self) -> Source:
        """Return the kernel."""
        text = self.text
        text.use("numerics.compiler", "lanes")
        with text.blocks_of_designs():
            with text.block("for i in lanes(width):", "design"):
                self.write_designs()
                for search in self.program.searches:
                    for branch in self.program.branches:
                        self.write_extremes(search, branch)
            with text.block("for i in range(n_here):"):
                for output in self.program.outputs:
                    for k, branch in enumerate(self.program.branches):
                        row = self.rows[f"{output.name}__{branch}"]
                        value = f"int(w[{row}, i])" if output.request.is_status else f"w[{row}, i]"
                        text.add(f"out_{output.name}[i0 + i, {k}] = {value}")
        return text.source(self.program, [Array("w", "float64", (len(self.rows), LANES))])

    # -- values at places --------------------------------------------------------------------------

    def write_designs(self) -> None:
        """Write the values that depend on the design alone, the sides and the branches."""
        text, side = self.text, self.program.coordinates[2]
        for k, name in enumerate(self.program.inputs):
            text.add(f"{name} = designs[{k}, i0 + i]")
        for step in self.steps:
            if self.program.axes[step.name] <= {"design"}:
                paste_fact(step, step.depends_on, "", text)
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
        self.write_place(place)
        yield from self.values_at(names, place, half.endings)

    def values_at(self, names: Sequence[str], place: str, endings: Mapping[str, str]) -> Iterator[str]:
        """Write values at a place that is written, and yield their names."""
        lane_steps = [step for step in self.steps if not self.program.axes[step.name] <= {"design"}]
        for step in needed_steps(lane_steps, names):
            suffix = self.suffix(step.name, place, endings)
            if step.name + suffix not in self.written:
                self.written.add(step.name + suffix)
                known = [name + self.suffix(name, place, endings) for name in step.depends_on]
                paste_fact(step, known, suffix, self.text)
        yield from (name + self.suffix(name, place, endings) for name in names)

    def write_place(self, place: str) -> None:
        """Write the distances of a place from the lower and the upper end, over the width."""
        if place in self.written:
            return
        self.written.add(place)
        text, (low, high, _) = self.text, self.program.coordinates
        end = place.removesuffix("_beside")
        upper = f"{place} > 1.0"
        if end in ENDS:
            first = self.program.graded.ends[ENDS.index(end)][1]
            beside = place != end
            text.add(f"x__{place} = {f'abs({first})' if beside else f'-{first} if {first} < 0.0 else 0.0'}")
            near, far = (low, high) if end == ENDS[0] else (high, low)
            # the first place is at most 2^-60, and 1 + 2^-120 is 1
            text.add(f"{near}__{place} = x__{place} * x__{place}")
            text.add(f"{far}__{place} = 1.0")
        else:
            text.add(f"x__{place} = 1.0 / {place} if {upper} else {place}")
            self.write_parts(place, upper, (low, high))

    def write_parts(self, place: str, upper: str, names: tuple[str, str]) -> None:
        """Write the distances of a place from both ends; `upper` is where its position counts from the upper one."""
        text = self.text
        text.add(f"square__{place} = x__{place} * x__{place}")
        text.add(f"rest__{place} = 1.0 / (1.0 + square__{place})")
        text.add(f"part__{place} = square__{place} * rest__{place}")
        for name, lower, higher in ((names[0], "part", "rest"), (names[1], "rest", "part")):
            text.add(f"{name}__{place} = {higher}__{place} if {upper} else {lower}__{place}")

    def is_upper(self, place: str) -> str:
        """Return kernel text that is 1 where the position of a place is counted from the upper end, else 0."""
        end = place.removesuffix("_beside")
        return {"low": "0.0", "high": "1.0"}.get(end, f"(1.0 if {place} > 1.0 else 0.0)")

    # -- what may be extreme -----------------------------------------------------------------------

    def halves(self, search: ExtremumSearch, branch: int) -> list[Half]:
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
        halves, found = self.halves(search, branch), []
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
                yield Candidate(name, f"-{name}", place_of, self.bound_of_jump(), place, half, "2.0")
        none = " & ".join(f"({name} != {name})" for name in dict.fromkeys(found))
        for half in halves:
            for end, (_, first, _) in zip(ENDS, self.program.graded.ends, strict=True):
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
        end, kind = place.removesuffix("_beside"), "1.0"
        if end in ENDS:
            first = self.program.graded.ends[ENDS.index(end)][1]
            kind = "0.0"
            if self.program.has_gradients and search.known is not None and not search.known.places:
                (slope,) = self.values([search.slope], place, half)  # not a number where nothing can move
                kind = kind_at_end(self, search, value, f"({first} == 0.0) & ({slope} == {slope})")
        bound = self.bound(search, place, half, label)
        return Candidate(name, name, self.place(place, half), bound, place, half, kind)

    def apart_from_folds(self, place: str) -> str:
        """Write whether a place is another one than a fold at an end of the range, which no search finds."""
        self.write_place(place)
        (_, low, toggle_low), (_, high, toggle_high) = self.program.graded.ends
        self.text.use("codegen.runtime.results", "FOLDED")
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
        if self.position not in (name for step in self.steps for name in step.names):
            return "nan"
        (found,) = self.values([self.position], place, half)
        if not half.mirrored:
            return found
        self.text.use("codegen.runtime.results", "mirror_image")
        return self.bind(f"{found}__image", f"mirror_image({found}, {2.0 * self.program.graded.axis})")

    def bound_of_jump(self) -> str:
        """Return the error bound of a jump."""
        if self.program.has_bounds:
            self.text.use("codegen.runtime.results", "OF_PI")
        return "OF_PI"

    def bound(self, search: ExtremumSearch, place: str, half: Half, label: str) -> str:
        """Write the error bound of a value at a place, if it is requested."""
        if not search.bounded_by:
            return "nan"
        own, slope_bound, bend, slope = self.values(search.bounded_by, place, half)
        (value,) = self.values([search.quantity], place, half)
        text, name = self.text, f"bound__{label}"
        text.use("codegen.runtime.results", "bound_at_zero", "known")
        if name in self.written:
            return name
        zero = f"zero__{label}"
        text.add(f"own__{label}, {zero} = bound_at_zero({own}, abs({slope}), {slope_bound}, abs({bend}))")
        end = place.removesuffix("_beside")
        if end not in ENDS:
            return self.bind(name, f"known({zero})")
        text.use("codegen.runtime.results", "MARGIN", "has_no_bound", "off_at_end")
        _, first, toggle = self.program.graded.ends[ENDS.index(end)]
        off = f"off_at_end(x__{place}, abs({slope}), {slope_bound}, abs({bend}), {first})"
        lost = f"has_no_bound(x__{place}, abs({value}), abs({bend}), {first}, {toggle})"
        at_end = f"(inf if {lost} else known(MARGIN * {own} + {off}))"
        if search.known is not None and search.known.places:
            return self.bind(name, at_end)
        return self.bind(name, f"{at_end} if ({first} != 0.0) | ({slope} != {slope}) else known({zero})")

    # -- results -----------------------------------------------------------------------------------

    def write_extremes(self, search: ExtremumSearch, branch: int) -> None:
        """Write the results of a quantity in one branch."""
        own = [output for output in self.program.outputs if output.request.quantity == search.quantity]
        candidates = list(self.candidates(search, branch))
        for sign in (1, -1):
            outputs = [o for o in own if o.request.reduction is not None and o.request.reduction.sign == sign]
            if values := [output for output in outputs if not output.request.is_of_gradient]:
                self.write_extreme(candidates, values, sign)
                for output in values:
                    self.store(output, branch)
            if gradients := [output for output in outputs if output.request.is_of_gradient]:
                found = write_gradients(
                    self, search, candidates, sign, f"{search.quantity}__{branch}__{sign > 0:d}"
                )
                for output in gradients:
                    request = output.request
                    key = (request.by, request.is_position)
                    self.keep(output, branch, found["" if request.is_status else key])

    def write_extreme(self, candidates: Iterable[Candidate], outputs: Sequence[Output], sign: int) -> None:
        """Write which of the candidates is the greatest or the least, with what is requested of it."""
        text, better = self.text, ">" if sign > 0 else "<"
        placed, bounded = (
            any(getattr(o.request, f"is_{of}") for o in outputs) for of in ("position", "error")
        )
        text.add(f"best = {'-inf' if sign > 0 else 'inf'}")
        text.add("place = nan")
        text.add("bound = 0.0")
        for candidate in candidates:
            value = candidate.greatest if sign > 0 else candidate.least
            if bounded:
                text.use("codegen.runtime.results", "of_better")
                ahead = f"best, bound, {value}" if sign > 0 else f"-best, bound, -({value})"
                text.add(f"bound = of_better({ahead}, {candidate.bound})")
            if placed:
                text.add(f"place = {candidate.place} if {value} {better} best else place")
            text.add(f"best = {value} if {value} {better} best else best")
        text.add("none = (best == inf) | (best == -inf)")
        if bounded:
            errors = [error_name(end[2]) for end in self.program.graded.ends]
            doubt = " | ".join(f"({error} > 0.0)" for error in errors)
            text.add(f"bound = inf if {doubt} else bound")

    def store(self, output: Output, branch: int) -> None:
        """Write one result into its row."""
        request = output.request
        value = "place" if request.is_position else "bound" if request.is_error else "best"
        self.keep(output, branch, f"nan if none else {value}")

    def keep(self, output: Output, branch: int, value: str) -> None:
        """Write a value into the row of a result."""
        row = self.rows.setdefault(f"{output.name}__{branch}", len(self.rows))
        self.text.add(f"w[{row}, i] = {value}")


def write_known(program: KnownProgram) -> Source:
    """Return the text of the kernel, and what it is called with."""
    return KnownWriter(program).write()

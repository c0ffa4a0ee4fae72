"""Programs: what each kernel computes, as data; how a request is split into them."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, Literal

from fastlink.errors import InputError, Setting
from fastlink.facts.arc import ARC, ARC_FACTS, AT_ENDS
from fastlink.facts.asymptotics import asymptotics
from fastlink.facts.catalogue import Catalogue
from fastlink.facts.derivative import NoDependence, NoDerivative, Term
from fastlink.facts.expression import beneath, value_of
from fastlink.facts.fact import (
    PIECE,
    Breaking,
    Breakpoint,
    Fact,
    GradedRange,
    System,
    ranges_of,
    slope_of_gap,
)
from fastlink.facts.formula import CatalogueError
from fastlink.facts.names import (
    Change,
    ErrorBound,
    Quantity,
    Reduced,
    derivative_name,
    error_name,
    signed,
)
from fastlink.facts.tables import angle_tables
from fastlink.numerics.elementary import atan2
from fastlink.numerics.vectors import absolute, choice, magnitude
from fastlink.plan.query import REDUCTIONS, Extrema, Request, check_sampled, parse_request
from fastlink.space.design_space import BRANCH, EXTREMUM

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.facts.catalogue import Catalogue
    from fastlink.facts.fact import Fact, GradedRange, KnownExtremes, System


# -- Programs: the computation of one kernel as data, of which its text is made


Lanes = Literal["designs", "angles"]


@dataclass(frozen=True)
class Output:
    """One result of a kernel: the request and the axes it has besides the design."""

    request: Request
    axes: tuple[str, ...]
    dtype: str
    refined: bool = False
    #: The facts of the design that are positive where its integral over the turn meets a toggle that it cannot pass.
    toggles: tuple[str, ...] = ()
    #: The fact that is a number where its positions count, if the quantity has values at others; else empty.
    counted: str = ""
    #: Of a change by tolerances, the inputs that have some, with the facts of these.
    terms: tuple[Term, ...] = ()
    #: Whether it is how the design assembles over the turn, which the pieces of its range tell.
    is_assembly: bool = False

    @property
    def slopes(self) -> tuple[str, ...]:
        """The derivatives of the quantity that a derivative or change of its reduction is made of."""
        if self.terms:
            return tuple(derivative_name(self.request.quantity, term.by) for term in self.terms)
        return (self.request.bounded,) if self.request.by else ()

    @property
    def inputs(self) -> tuple[str, ...]:
        """The inputs of these derivatives."""
        return tuple(term.by for term in self.terms) or ((self.request.by,) if self.request.by else ())

    @property
    def name(self) -> str:
        """Name of the result."""
        return self.request.name


@dataclass(frozen=True, eq=False, kw_only=True)
class Program:
    """Facts to compute at input positions, and the results that are made of them."""

    #: The mechanism.
    catalogue: Catalogue
    #: The results, in the order of the request.
    outputs: tuple[Output, ...]
    #: Everything computed, in order.
    steps: tuple[Fact | System, ...]
    #: The inputs that the steps read, the rows of the kernel's design array.
    inputs: tuple[str, ...]
    #: The branches.
    branches: tuple[int, ...]
    #: The selected variants.
    variants: tuple[str, ...]
    #: The functions of the input position that the steps read, the rows of the kernel's angle array.
    tables: tuple[str, ...] = ()
    #: What stands side by side in the vector lanes.
    lanes: Lanes = "designs"

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The values that are given at each input position."""
        return self.tables

    @cached_property
    def axes(self) -> dict[str, frozenset[str]]:
        """The axes on which each value depends."""
        return self._axes_by({name: self.catalogue.position.name for name in self.coordinates})

    def _axes_by(self, coordinates: Mapping[str, str]) -> dict[str, frozenset[str]]:
        """Return the axes on which each value depends, with those of coordinates."""
        axes = {name: frozenset({"design"}) for name in self.inputs}
        axes["branch"] = frozenset({"branch"})
        axes |= {name: frozenset({axis}) for name, axis in coordinates.items()}
        for step in self.steps:
            joint = frozenset[str]().union(*(axes[name] for name in step.depends_on))
            axes |= dict.fromkeys(step.names, joint)
        return axes

    def angle_tables(self, positions: NDArray[Any]) -> NDArray[Any]:
        """Return the rows of the kernel's angle array (tables, positions)."""
        return angle_tables(self.catalogue, self.tables, positions)


@dataclass(frozen=True)
class ExtremumSearch:
    """A quantity whose extrema are searched."""

    #: Its name.
    quantity: str
    #: The fact that vanishes where it is extreme.
    slope: str
    #: Half the number of cells of the graded range, a power of two, and how many extrema are kept.
    cells: int
    most: int
    #: The powers of 1/sigma by which quantity and slope grow at a toggle.
    order: int
    slope_order: int
    #: What the mirror does to them: 1, -1, or 0 for no symmetry.
    parity: int
    slope_parity: int
    #: Whether the quantity has a value exactly at a toggle.
    at_limit: bool
    #: Whether cells are divided whose samples cannot exclude further extrema; the others have none that hide.
    divided: bool
    #: Whether it is the magnitude of a vector: its square is smooth where it comes close to zero.
    magnitude: bool
    #: Whether it is an angle from 0 to pi, which turns back at both.
    folds: bool = False
    #: Whether its slope may jump over zero: it chooses the larger of two values, or takes the size of one.
    kinked: bool = False
    #: The values other than 1/sigma by whose product the slope is divided.
    divisors: tuple[str, ...] = ()
    #: Where `slope` is another one, at whose zeros the quantity may be greatest or least too: the quantity.
    onto: str = ""
    #: Of such a one, or of places at which cells of others are split: the kind of its breakpoints.
    kind: Breaking | None = None
    #: Whether the extremes are those within an arc.
    arc: bool = False
    #: What vanishes where the slope jumps or has a kink: cells are split at these places.
    turns: tuple[str, ...] = ()
    #: Where error bounds of the extremes are requested: those of quantity and slope, the slope's derivative, and
    #: the slope.
    bounded_by: tuple[str, ...] = ()
    #: Where a list of its extremes is requested: the error bound of the slope, by which an entry is certain.
    certain_by: tuple[str, ...] = ()
    #: The derivatives of the extremes by inputs that are requested, of the values before those of the places.
    gradients: tuple[Gradient, ...] = ()
    #: Where its extremes are, if that is known in closed form.
    known: KnownExtremes | None = None
    #: If its zeros cut the range into pieces, before all other searches, the number of the gap, else 0.
    cuts: int = 0
    #: What is evaluated at these zeros: the second derivative of the gap, and error bounds of it and of its slope.
    at_zeros: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """All that is evaluated for it."""
        of_gradients = (name for gradient in self.gradients for name in gradient.names)
        bounds = *self.bounded_by, *self.certain_by
        return self.slope, self.quantity, *self.divisors, *bounds, *self.at_zeros, *of_gradients

    @property
    def mirrored(self) -> bool:
        """Whether half the range in both branches says all, the other half being its mirror."""
        return self.parity != 0

    @property
    def splits(self) -> bool:
        """Whether it is for places at which cells of others are split, and nothing else."""
        return self.kind == "split"


@dataclass(frozen=True)
class Gradient:
    """The derivative of an extreme, or of its place, by an input."""

    #: The input.
    by: str
    #: Whether it is that of the place.
    is_position: bool
    #: The derivative of the quantity at one input position; for the place those of the slope by the input and by
    #: the position, whose quotient times -1 it is. Empty where the input moves nothing but the limits of motion.
    held: tuple[str, ...]
    #: The derivative at a place that moves with the limits of motion, empty where nothing moves.
    moving: str

    @property
    def names(self) -> tuple[str, ...]:
        """All facts that it needs."""
        return (*self.held, self.moving) if self.moving else self.held


@dataclass(frozen=True, eq=False, kw_only=True)
class ExtremaProgram(Program):
    """Facts to compute at positions of the graded range, to find every extremum of some quantities.

    Attributes
    ----------
    searches : tuple of ExtremumSearch
        Quantities of one fineness and symmetry.
    """

    searches: tuple[ExtremumSearch, ...]

    @property
    def graded(self) -> GradedRange:
        """The range in which the extremes are."""
        assert self.catalogue.graded is not None
        return self.catalogue.graded

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The values that are given at each position of the graded range."""
        return self.graded.coordinates

    @property
    def in_pieces(self) -> bool:
        """Whether lanes are pieces of the range, each of one design and branch."""
        return self.graded.gaps is not None

    @cached_property
    def axes(self) -> dict[str, frozenset[str]]:
        """The axes on which each value depends: a piece is of one design, and all that is given of it is its own."""
        coordinates = dict.fromkeys(self.coordinates, self.catalogue.position.name)
        of_piece = dict.fromkeys((*PIECE, "branch"), "design") if self.in_pieces else {}
        return self._axes_by(coordinates | of_piece)

    @property
    def has_bounds(self) -> bool:
        """Whether error bounds of extremes are requested."""
        return any(search.bounded_by for search in self.searches)

    @property
    def has_gradients(self) -> bool:
        """Whether derivatives of extremes by inputs, or their status, are requested."""
        return any(output.request.is_of_gradient for output in self.outputs)

    @property
    def mirrored(self) -> bool:
        """Whether half the range in both branches says all, the other half being its mirror."""
        return self.searches[0].mirrored

    @property
    def searched_branches(self) -> tuple[int, ...]:
        """The branches that are searched; a piece has its own, whatever that is."""
        if self.in_pieces:
            return self.branches[:1]
        return tuple(self.catalogue.branches) if self.mirrored else self.branches

    @property
    def sides(self) -> int:
        """Number of sides of the ground line that are searched."""
        return 1 if self.mirrored or self.in_pieces else 2


@dataclass(frozen=True, eq=False, kw_only=True)
class KnownProgram(ExtremaProgram):
    """Facts to compute at the few places of the graded range where the extremes of some quantities are known to be."""

    @cached_property
    def axes(self) -> dict[str, frozenset[str]]:
        """The axes on which each value depends: those of a place are the place itself and the side."""
        near, far, side = self.coordinates
        return self._axes_by({near: "place", far: "place", side: "side"})


# -- Where facts turn sharply or have kinks: magnitudes, angles by the size of a sine, choices of users,
#    loads


#: What a user's fact calls where it has kinks.
KINKS = {absolute.__name__, choice.__name__}
#: Cells in place of one where a user's fact takes two or more magnitudes: where both almost vanish next to each other,
#: their sum turns twice within a fraction of a cell, which the samples of its slope do not show (5 of 1,001 differences
#: of forces on the crank missed their greatest value by up to 2 % with one cell, none with this many).
FINER = 8


def is_magnitude(step: Fact | System) -> bool:
    """Tell whether a fact is the magnitude of a vector and nothing else."""
    return value_of(step.formula).value is magnitude


def folds(step: Fact | System) -> bool:
    """Tell whether a fact is an angle by the size of its sine: it turns back at 0 and at pi."""
    value = value_of(step.formula)
    return value.value is atan2 and value.args[0].value is abs


def has_sharp_terms(steps: Sequence[Fact | System]) -> bool:
    """Tell whether the last of these steps, a user's, is computed from two magnitudes or more."""
    last = steps[-1]
    if not (isinstance(last, Fact) and last.own):
        return False
    own = (step for step in steps if isinstance(step, Fact) and step.own)
    within = sum(node.value is magnitude for step in own for node in beneath([value_of(step.formula)]))
    return within + sum(isinstance(step, Fact) and not step.own and is_magnitude(step) for step in steps) > 1


def is_sharp(catalogue: Catalogue, name: str) -> bool:
    """Tell whether a quantity is the magnitude of a vector, sharp where that almost vanishes."""
    return name in catalogue.public and is_magnitude(catalogue.facts[name])


def may_have_kinks(step: Fact | System) -> bool:
    """Tell whether a user's fact chooses between values that may meet."""
    return isinstance(step, Fact) and step.own and not KINKS.isdisjoint(step.formula.uses)


def turns_of(graded: GradedRange, quantity: str, steps: Iterable[Fact | System]) -> tuple[str, ...]:
    """Return what vanishes where the slope of a quantity, which steps compute, jumps, has a kink or a pole."""
    names = {name for step in steps for name in step.names}
    turns = (zero for name, zero in graded.turns.items() if name in names)
    return (*turns, *(place.zero for place in graded.breakpoints(quantity, "kink", "jump", "pole")))


def is_of_known(output: Output, searches: Iterable[ExtremumSearch]) -> bool:
    """Tell whether a result is one of extremes that are known: lists and changes by tolerances are searched."""
    request = output.request
    own = any(search.known is not None for search in searches if search.quantity == request.quantity)
    return own and request.can_be_refined and not request.change


# -- Plan the programs of a mechanism, for designs that give some of its inputs

# A fact that depends on the design alone is computed once per design; a fact of the input position alone,
# once per position; a fact that does not depend on the branch, once for both branches.


#: The fact that is 1 where all inputs are as they have to be, and the code by which a mechanism assembles.
VALID, ASSEMBLY = "valid", "status"
#: The order of the searches for breakpoints, by their kinds.
ORDER: dict[Breaking, int] = {"wrap": 0, "jump": 1, "pole": 2, "end": 3, "kink": 4, "piece": 4}
# Fewer angles than this leave vector lanes idle when lanes are angles.
ANGLES_FOR_LANES = 32


@dataclass(frozen=True, eq=False)
class Planner:
    """Plans programs of a mechanism, for the inputs that designs give, some variants and branches."""

    catalogue: Catalogue
    given: tuple[str, ...]
    variants: tuple[str, ...] = ()
    branches: tuple[int, ...] = (1, 2)

    @property
    def graded(self) -> GradedRange:
        """The range in which extremes are searched."""
        assert self.catalogue.graded is not None
        return self.catalogue.graded

    @property
    def is_in_pieces(self) -> bool:
        """Whether the range of the mechanism is cut into pieces, see `GradedRange.gaps`."""
        return self.catalogue.graded is not None and self.catalogue.graded.gaps is not None

    @property
    def tables(self) -> tuple[str, ...]:
        """The functions of the input position."""
        return self.catalogue.position.name, *self.catalogue.tables, *self.catalogue.table_low_parts

    def curve_steps(self, names: Iterable[str]) -> tuple[Fact | System, ...]:
        """Return the steps that compute facts at input positions."""
        leaves = (*self.given, *self.tables, "branch")
        return tuple(self.catalogue.dependencies(names, leaves, self.variants))

    def steps(self, names: Iterable[str]) -> tuple[Fact | System, ...]:
        """Return the steps that compute facts at positions of the graded range."""
        leaves = (*self.given, *self.graded.given, "branch")
        return tuple(self.catalogue.dependencies(names, leaves, (self.graded.name, *self.variants)))

    def made_of(self, steps: tuple[Fact | System, ...]) -> dict[str, Any]:
        """Return what every program of some steps has; inputs by the catalogue, however the design is written."""
        read = {name for step in steps for name in step.depends_on}
        known = self.catalogue.known_inputs(self.variants)
        return {
            "catalogue": self.catalogue,
            "steps": steps,
            "inputs": tuple(name for name in known if name in read and name in self.given),
            "branches": self.branches,
            "variants": self.variants,
        }

    # -- Over what a reduction runs: positions where the loop closes, no toggle that an integral cannot pass

    def counted_by(self, request: Request) -> str:
        """Return the fact that is a number where a position counts, empty if the quantity has no value at others.

        A crank pin has a place where the linkage cannot be assembled, too: that is no part of the motion. Codes have
        one for such positions.
        """
        closes = self.catalogue.closes
        if not closes or request.reduction is None or self.catalogue.public_fact(request.quantity).flags:
            return ""
        made_of = {name for step in self.curve_steps([request.quantity]) for name in step.names}
        return "" if made_of.intersection(closes) else closes[0]

    def toggles_of(self, request: Request) -> tuple[str, ...]:
        """Return the facts of a design that are positive where a reduction over the turn meets a toggle it cannot pass.

        A quantity grows as sigma^-n, sigma as the root of the distance from the toggle. Its mean exists for n < 2, that
        of its square for n < 1. Derivatives by inputs meet every toggle: limits that move are not seen by samples.
        """
        reduction, graded = request.reduction, self.catalogue.graded
        if graded is None or reduction is None or reduction.toggle_order is None:
            return ()
        if request.quantity in graded.not_differentiable:  # of samples, as its extremes
            return ()
        if reduction.toggle_order > 0 and not request.is_of_gradient:
            order = self.order_at_toggles(request.quantity)
            if order is None or order < reduction.toggle_order:
                return ()
        if self.is_in_pieces:
            what = f"quantity {request.name!r} has no value where the turn has a limit of motion"
            remedy = ("write ", Setting("extrema", "sampled"), " for that of samples")
            raise InputError(f"{what}, which only a search finds", remedy=remedy)
        return tuple(toggle for _, _, toggle in graded.ends)

    def order_at_toggles(self, quantity: str) -> int | None:
        """Return the power of 1/sigma by which a quantity grows at toggles, or None where it is not known.

        A change by tolerances grows as the derivative by the position does: what moves a toggle acts as what moves the
        input position towards it.
        """
        tree, position = self.catalogue.parse(quantity), self.catalogue.position.name
        name = derivative_name(str(tree.of), position) if isinstance(tree, Change) else quantity
        # of a linear system nothing is known; closed forms have the same values
        closed = tuple(variant for variant in self.variants if variant not in self.catalogue.solvers)
        try:
            steps = replace(self, variants=closed).steps([name])
        except (CatalogueError, NoDerivative):
            return None
        if any(isinstance(step, System) for step in steps):
            return None
        coordinates = (*self.graded.given, "branch")
        return round(asymptotics(self.graded, steps, coordinates, strict=True)[name].order)

    # -- Values at given input positions, and their reductions

    def output(
        self,
        request: Request,
        *,
        whole_turn: bool = False,
        refined: bool = False,
        is_assembly: bool = False,
    ) -> Output:
        """Return the result of a request."""
        catalogue, fact = self.catalogue, self.catalogue.public_fact(request.quantity)
        axes: tuple[str, ...] = (BRANCH,)
        if is_assembly:
            axes = (BRANCH,) if request.name == ASSEMBLY else (BRANCH, EXTREMUM)
        elif not catalogue.varies(fact.name):
            axes = ()
        elif request.listed and request.listed != "count":
            axes = (BRANCH, EXTREMUM)
        elif not request.listed and request.reduction is None:
            axes = (BRANCH, catalogue.position.name)
        is_code = (bool(fact.flags) and request.is_of_quantity) or request.listed in ("count", "kind")
        terms: tuple[Term, ...] = ()
        if request.change:
            selection = catalogue.selection(self.variants, self.given)
            terms = selection.change_terms(request.quantity, over_cycle=True, at_limits=refined)
        return Output(
            request,
            axes,
            "int8" if is_code or request.is_status else "float64",
            refined,
            self.toggles_of(request) if whole_turn else (),
            "" if refined else self.counted_by(request),
            terms,
            is_assembly,
        )

    def program(
        self, names: Iterable[str], angles: int = 360, lanes: Lanes | None = None, whole_turn: bool = False
    ) -> Program:
        """Return the program of some results at input positions."""
        requests = [parse_request(name, self.catalogue) for name in names]
        check_sampled(requests, self.catalogue)
        outputs = tuple(self.output(request, whole_turn=whole_turn) for request in requests)
        needed = [request.quantity for request in requests]
        needed += [name for output in outputs for name in output.toggles]
        needed += [name for o in outputs for name in (*o.slopes, *(term.tolerance for term in o.terms))]
        needed += [output.counted for output in outputs if output.counted]
        needed += [request.other for request in requests if request.other]
        steps = self.curve_steps(dict.fromkeys(needed))
        read = {need for step in steps for need in step.depends_on}
        position, *_ = self.tables
        tables = tuple(name for name in self.tables if name in read)
        if any(request.is_position for request in requests) and position not in tables:
            tables = (position, *tables)
        if lanes is None:
            together = any(request.reduction for request in requests)
            together = together or any(isinstance(step, System) for step in steps)
            lanes = "designs" if together or angles < ANGLES_FOR_LANES or not tables else "angles"
        return Program(**self.made_of(steps), outputs=outputs, tables=tables, lanes=lanes)

    def pointwise_programs(self, names: Sequence[str], angles: int, whole_turn: bool) -> list[Program]:
        """Return the programs that together give some results fastest: curves apart from the rest.

        With lanes that are designs a curve is stored across the lines of its array, 1 ns a value; with lanes that are
        angles it costs less to compute the shared facts again.
        """
        program, position = self.program(names, angles, None, whole_turn), self.catalogue.position.name
        curves = [output.name for output in program.outputs if position in output.axes]
        others = [output.name for output in program.outputs if position not in output.axes]
        has_system = any(isinstance(step, System) for step in program.steps)
        if has_system or program.lanes == "angles" or angles < ANGLES_FOR_LANES or not curves or not others:
            return [program]
        read = replace(self, given=program.inputs)
        return [read.program(part, angles, None, whole_turn) for part in (curves, others)]

    # -- Searches for extrema: each of a quantity by its derivative with respect to the input position

    def search(self, quantity: str) -> ExtremumSearch | None:
        """Return how a quantity is searched, or None where it has no derivative or no graded range.

        An arc of the turn is no mirror image of itself, and extremes that are known may be outside of it.
        """
        found, is_arc = self._search_of_turn(quantity), ARC in self.variants
        if found is not None and (is_arc or self.is_in_pieces):  # no piece is the mirror image of another
            found = replace(found, parity=0, slope_parity=0)
        return replace(found, arc=True, known=None) if found is not None and is_arc else found

    def _search_of_turn(self, quantity: str) -> ExtremumSearch | None:
        if signed(quantity) != quantity:
            # the magnitude is extreme where the quantity is, or zero: its greatest is found by the same slope
            found = self._search_of_turn(signed(quantity))
            return found and replace(found, quantity=quantity, parity=abs(found.parity))
        graded = self.catalogue.graded
        if graded is None or quantity in graded.not_differentiable:
            return None
        slope = derivative_name(quantity, self.catalogue.position.name)
        try:
            steps = self.steps((quantity, slope))
        except (CatalogueError, NoDerivative):
            return None
        if any(isinstance(step, System) for step in steps):
            return None
        grades = asymptotics(graded, steps, (*graded.given, "branch"))
        grade = grades[quantity]
        divisor, power = graded.divisors.get(quantity, (quantity, 0))
        own = self.steps((quantity,))
        needed = {name for step in own for name in step.names}
        by_name = {name: step for step in steps for name in step.names}
        return ExtremumSearch(
            quantity,
            slope,
            graded.cells.get(quantity, graded.cells_otherwise) * (FINER if has_sharp_terms(own) else 1),
            graded.max_extrema.get(quantity, graded.max_extrema_otherwise),
            round(grade.order),
            max(round(grades[slope].order + power * grades[divisor].order), 0),
            grade.parity,
            -grade.parity,  # the input position is odd
            at_limit=grade.order <= 0.0
            if graded.gaps is not None
            else graded.reciprocal not in needed and not grade.choice,
            divided=quantity not in graded.cells,
            turns=() if quantity in graded.cells else turns_of(graded, quantity, steps),
            magnitude=is_magnitude(by_name[quantity]),
            folds=folds(by_name[quantity]),
            kinked=any(map(may_have_kinks, own)),
            divisors=(divisor,) * power,
            known=self.known_extremes(quantity, own),
        )

    def known_extremes(self, quantity: str, steps: Iterable[Fact | System]) -> KnownExtremes | None:
        """Return where the extremes of a quantity are; what is declared holds for steps that no variant replaces."""
        replaced = {name for variant in self.variants for name in self.catalogue.variants.get(variant, ())}
        if any(name in replaced for step in steps for name in step.names):
            return None
        return self.graded.known.get(quantity)

    def part_search(self, search: ExtremumSearch, place: Breakpoint) -> Iterator[ExtremumSearch]:
        """Yield the search for breakpoints on behalf of another search, none where they are nowhere or everywhere."""
        graded, name, slope = self.graded, place.of, place.zero
        try:
            steps = self.steps((name, slope))
        except (CatalogueError, NoDerivative, NoDependence):
            return  # the same at all positions, or of those of the whole alone
        divisor, power = graded.divisors.get(name, (name, 0)) if slope != name else (name, 0)
        if slope != name and is_magnitude(next(step for step in steps if name in step.names)):
            divisor, power = name, 1  # half the derivative of the square, which has no kink
        grades = asymptotics(graded, steps, (*graded.given, "branch"))
        parity = grades[slope].parity if slope == name else -grades[name].parity  # the position is odd
        if place.kind == "wrap":  # the sine of the angle times a length is odd where the angle is
            parity = -search.slope_parity
        if search.mirrored and not parity:
            return  # its mirror image is that of another part, which is searched where this one is not
        jumps = (other.zero for other in graded.breakpoints(search.quantity, "jump", "pole"))
        yield replace(
            search,
            slope=slope,
            slope_order=max(round(grades[slope].order + power * grades[divisor].order), 0),
            slope_parity=parity,
            divisors=(divisor,) * power,
            onto=search.quantity,
            kind=place.kind,
            magnitude=False,
            kinked=False,
            turns=() if slope == name else (*turns_of(graded, name, steps), *jumps),
            bounded_by=() if place.kind in ("wrap", "split") else search.bounded_by,
            certain_by=(),
            gradients=(),
        )

    def breakpoints(self, search: ExtremumSearch) -> Iterator[Breakpoint]:
        """Yield the places where a quantity may be greatest or least, though its slope is not 0 there."""
        quantity, graded = signed(search.quantity), self.graded
        yield from graded.breakpoints(quantity, "wrap", "jump", "pole")
        yield from (Breakpoint("end", end, end) for end in AT_ENDS if search.arc)
        yield from graded.breakpoints(quantity, "kink")
        fact, (_, pieces) = self.catalogue.facts.get(quantity), graded.kinks.get(quantity, ((), ()))
        read = fact.depends_on if fact and fact.own else ()
        for name in dict.fromkeys((*pieces, *(name for name in read if is_sharp(self.catalogue, name)))):
            yield Breakpoint("piece", derivative_name(name, self.catalogue.position.name), name)

    def searches_for_splits(self, searches: Iterable[ExtremumSearch]) -> list[ExtremumSearch]:
        """Return the searches for the places at which cells of searches, which share samples, are split."""
        first: dict[str, ExtremumSearch] = {}
        for search in searches:
            for name in search.turns:
                first.setdefault(name, search)  # it is the same for all
        return [
            replace(one, quantity=one.slope, divided=one.slope not in self.graded.cells, order=0)
            for name, search in first.items()
            for one in self.part_search(search, Breakpoint("split", name, name))
        ]

    def searches_for_cuts(self, cells: int) -> list[ExtremumSearch]:
        """Return the searches for zeros of gaps, in their order."""
        found, position = [], self.catalogue.position.name
        for k, gap in enumerate(self.graded.gaps or (), 1):
            search, slope = self.search(slope_of_gap(gap)), derivative_name(gap, position)
            assert search is not None
            at_zeros = derivative_name(slope, position), error_name(gap), error_name(slope)
            found.append(replace(search, cells=cells, cuts=k, at_zeros=at_zeros, turns=(), arc=False))
        return found

    def further_searches(
        self, searches: Sequence[ExtremumSearch], bounded: Container[str]
    ) -> list[ExtremumSearch]:
        """Return the searches for places where a quantity may be greatest or least, though its slope is not 0.

        Next to zero of what a quotient is divided by three extremes may be too close to tell, as may be those on both
        sides of a kink: there is one where that is least, and one of each smooth part.
        """
        searches = [search for search in searches if search.quantity in bounded]
        places = [(search, place) for search in searches for place in self.breakpoints(search)]
        places.sort(key=lambda pair: ORDER[pair[1].kind])
        found = [one for search, place in places for one in self.part_search(search, place)]
        nearly_poles = [
            replace(
                s,
                slope=derivative_name(s.divisors[0], self.catalogue.position.name),
                divisors=s.divisors[:1],  # the square's derivative, which has no kink
                divided=False,
                turns=(),
                onto=s.quantity,
                certain_by=(),
                gradients=(),
            )
            for s in (*searches, *found)
            if s.divisors
        ]
        return found + nearly_poles

    def requested(self, search: ExtremumSearch, outputs: Sequence[Output]) -> ExtremumSearch:
        """Return a search with the error bounds and derivatives that are requested of its extremes."""
        own = [output for output in outputs if output.request.quantity == search.quantity]
        search = replace(search, gradients=self.gradients(search, own))
        if any(output.request.listed for output in own):
            search = replace(search, certain_by=(error_name(search.slope),))
        if not any(output.request.is_error for output in own):
            return search
        bend = derivative_name(search.slope, self.catalogue.position.name)
        bounds = error_name(search.quantity), error_name(search.slope), bend, search.slope
        return replace(search, bounded_by=bounds)

    def gradients(self, search: ExtremumSearch, outputs: Sequence[Output]) -> tuple[Gradient, ...]:
        """Return the requested derivatives of the extremes of a quantity, of the values before those of the places."""
        own = [(output.request.is_position, by) for output in outputs for by in output.inputs]
        position, found = self.catalogue.position.name, []
        for place, by in dict.fromkeys(sorted(own, key=lambda pair: pair[0])):
            of = position if place else search.quantity
            own_slope = derivative_name(search.slope if place else search.quantity, by)
            held: tuple[str, ...] = (own_slope,)
            held += (derivative_name(search.slope, position),) if place else ()
            moving, absent = derivative_name(of, by, moving=True), None
            try:
                self.steps((own_slope,))
            except NoDependence as error:
                held, absent = (), error
            try:
                self.steps((moving,))
            except NoDerivative:
                moving = ""  # limits of motion do not depend on it
            if absent is not None and not moving:
                raise absent
            found.append(Gradient(by, place, held, moving))
        return tuple(found)

    def extrema_programs(
        self, outputs: Sequence[Output], searches: Sequence[ExtremumSearch]
    ) -> list[ExtremaProgram]:
        """Return a program of extremes that are known, and group searches by what may share samples.

        These are fineness and symmetry: no bit changes.
        """
        ends, position = self.graded.ends, self.catalogue.position.name
        known = [output for output in outputs if is_of_known(output, searches)]
        programs: list[ExtremaProgram] = [self.known_program(known, searches)] if known else []
        outputs = [output for output in outputs if output not in known]
        quantities = {output.request.quantity for output in outputs}
        searches = [self.requested(search, outputs) for search in searches if search.quantity in quantities]
        bounded = {output.request.quantity for output in outputs if output.request.can_be_refined}
        first: list[ExtremumSearch] = []
        groups = {(self.graded.cells_otherwise, False): first} if any(o.is_assembly for o in outputs) else {}
        for search in (*searches, *self.further_searches(searches, bounded)):
            groups.setdefault((search.cells, search.mirrored), []).append(search)
        for (cells, _), group in groups.items():
            group += self.searches_for_splits(group)
            group += self.searches_for_cuts(cells)
            names = [position, self.graded.bounded_factor, *(name for end in ends for name in end)]
            names += [name for s in group for name in s.names]
            of_group = [o for s in group for o in outputs if o.request.quantity == s.quantity and not s.onto]
            if group is first:
                of_group += [output for output in outputs if output.is_assembly]
            names += [term.tolerance for o in of_group for term in o.terms]
            names += [
                error_name(end[2])
                for end in ends
                if any(s.bounded_by for s in group) and self.graded.gaps is None
            ]
            names += [VALID for o in of_group if o.is_assembly]
            names += [name for s in group[:1] if s.arc for name in ARC_FACTS]
            of_steps = self.made_of(self.steps(names))
            programs.append(ExtremaProgram(**of_steps, outputs=tuple(of_group), searches=tuple(group)))
        return programs

    def known_program(self, outputs: Sequence[Output], searches: Iterable[ExtremumSearch]) -> KnownProgram:
        """Return the program of extremes that are known: the quantity at a few places, and nothing that is searched."""
        ends = self.graded.ends
        quantities = {output.request.quantity for output in outputs}
        searches = [self.requested(search, outputs) for search in searches if search.quantity in quantities]
        has_gradients = any(output.request.is_of_gradient for output in outputs)
        names = [name for end in ends for name in end[1:]]
        if has_gradients or any(output.request.is_position for output in outputs):
            names.append(self.catalogue.position.name)
        for search in searches:
            assert search.known is not None
            names += [search.quantity, *search.known.facts, *search.bounded_by]
            names += [name for gradient in search.gradients for name in gradient.names]
            if has_gradients and not search.known.places:
                names.append(search.slope)
            if search.bounded_by:
                names += [error_name(end[2]) for end in ends]
        of_steps = self.made_of(self.steps(dict.fromkeys(names)))
        return KnownProgram(**of_steps, outputs=tuple(outputs), searches=tuple(searches))


def make_program(
    catalogue: Catalogue,
    names: Iterable[str],
    *,
    given: Iterable[str],
    branches: Sequence[int] = (1, 2),
    variants: Sequence[str] = (),
    **options: Any,
) -> Program:
    """Return the program of some results at input positions, see `Planner.program`."""
    return Planner(catalogue, tuple(given), tuple(variants), tuple(branches)).program(names, **options)


# -- Split a request into programs: values at each position, samples over the cycle, refined extremes


@dataclass(frozen=True, eq=False)
class Plan:
    """The programs that together give all results; a plan equals itself alone, so that it can be a key."""

    #: The mechanism.
    catalogue: Catalogue
    #: The results, in the order of the request.
    outputs: tuple[Output, ...]
    #: One for each kernel.
    programs: tuple[Program, ...]
    #: The branches.
    branches: tuple[int, ...]
    #: The selected variants.
    variants: tuple[str, ...]
    #: Length of the dimension of extrema.
    extrema_kept: int
    #: The arguments of `planned_again`, which makes the plan in another process: facts are functions, and stay.
    recipe: tuple[Any, ...] = field(default=(), repr=False)

    def __reduce__(self) -> tuple[Any, ...]:
        return planned_again, self.recipe

    @property
    def positions(self) -> int:
        """The number of input positions, 0 where the plan was not made for any."""
        return int(dict(self.recipe[2])["angles"]) if self.recipe else 0

    @property
    def uses_position(self) -> bool:
        """Whether anything is computed at the given input positions."""
        return any(program.tables for program in self.programs)

    @cached_property
    def depends_on_solver(self) -> bool:
        """Whether anything that is computed depends on the solver."""
        return any(self.catalogue.depends_on_solver(program.steps) for program in self.programs)

    @property
    def extrema(self) -> str:
        """The search for extrema: refined, sampled, both, or an empty text where there are none."""
        reduced = [output for output in self.outputs if output.request.reduction or output.refined]
        return " and ".join(sorted({"refined" if output.refined else "sampled" for output in reduced}))


def make_plan(
    catalogue: Catalogue,
    names: Iterable[str],
    *,
    given: Sequence[str],
    branches: Sequence[int] = (1, 2),
    variants: Sequence[str] = (),
    angles: int = 360,
    extrema: Extrema = "refined",
) -> Plan:
    """Resolve the requested names into programs."""
    names, setting = tuple(names), dict[str, Any](angles=angles, extrema=extrema)
    requests = [parse_request(name, catalogue) for name in names]
    for request in requests:
        if request.name in given:
            what = f"quantity {request.name!r} is given, and a coordinate of the result"
            raise InputError(what, remedy="leave it out")
    planner = Planner(catalogue, tuple(given), tuple(variants), tuple(branches))
    searches: dict[str, ExtremumSearch | None] = {}
    refined: set[str] = set()
    cut = planner.is_in_pieces and bool(planner.graded.gaps)
    of_pieces = {ASSEMBLY, *ranges_of(catalogue.position.name)} if cut else set()
    assembly = of_pieces.intersection(request.name for request in requests)
    refined |= assembly
    for request in requests:
        if request.listed or request.is_error or (extrema == "refined" and request.can_be_refined):
            quantity = request.quantity
            if quantity not in searches:
                searches[quantity] = planner.search(quantity)
            is_searched = searches[quantity] is not None
            if request.is_error and not (is_searched and (request.listed or extrema == "refined")):
                raise _no_error(request, planner, is_searched)
            if is_searched:
                refined.add(request.name)
            elif request.listed:
                raise _not_refined(request, catalogue)
    whole_turn = extrema == "refined" and ARC not in variants
    outputs = tuple(
        planner.output(r, whole_turn=whole_turn, refined=r.name in refined, is_assembly=r.name in assembly)
        for r in requests
    )
    programs: list[Program] = []
    if sampled := [output.name for output in outputs if not output.refined]:
        programs += planner.pointwise_programs(sampled, angles, whole_turn)
    searched = [search for search in searches.values() if search is not None]
    if searched or assembly:
        programs += planner.extrema_programs([output for output in outputs if output.refined], searched)
    kept = max((search.most for search in searched), default=0)
    if len(assembly) > (ASSEMBLY in assembly):
        kept = max(kept, planner.graded.max_extrema_otherwise)
    setting |= {"given": planner.given, "branches": planner.branches, "variants": planner.variants}
    recipe = catalogue, names, tuple(setting.items())
    return Plan(catalogue, outputs, tuple(programs), planner.branches, planner.variants, kept, recipe)


def all_declared(catalogue: Catalogue) -> tuple[Any, ...]:
    """Return a key that changes when a fact, an input or a reduction is declared or replaced."""
    return catalogue.version, *REDUCTIONS.values()


def planned_again(catalogue: Catalogue, *recipe: Any) -> Plan:
    """Return the plan that `make_plan` made in another process, once as long as nothing is declared."""
    return _again(all_declared(catalogue), catalogue, *recipe)


@lru_cache(maxsize=64)
def _again(declared: tuple[Any, ...], catalogue: Catalogue, names: tuple[str, ...], setting: Any) -> Plan:
    return make_plan(catalogue, names, **dict(setting))


def _not_refined(request: Request, catalogue: Catalogue) -> InputError:
    ends = [str(Reduced(Quantity(request.quantity), how)) for how in ("max", "min")]
    offered = " and ".join(name for name in ends if name not in catalogue.hiding)
    remedy = f"ask for {offered}" if offered else f"ask for {request.quantity}, and take extremes of the map"
    return InputError(
        f"quantity {request.name!r}: {request.quantity} of {catalogue.name} has no derivative by "
        f"{catalogue.position.name} here, so its extremes cannot be listed",
        remedy=remedy,
    )


def _no_error(request: Request, planner: Planner, searched: bool) -> InputError:
    """Return the error for the error bound of an extreme of samples; `searched` tells that they were chosen."""
    quantity, position = request.quantity, planner.catalogue.position.name
    # values of a linear system have none
    planner.catalogue.resolve(error_name(quantity), planner.variants, planner.given)
    what = f"quantity {request.name!r}: the extremes of {quantity} are those of samples here, and how far they are from"
    what += f" those over all {position} is not known"
    of_samples = (
        f"ask for {Reduced(ErrorBound(Quantity(quantity)), 'max')}, the greatest error of the samples"
    )
    if not searched:
        return InputError(what, remedy=of_samples)
    turn = (f"give no array of {position} and write ", Setting("extrema", "refined"))
    return InputError(what, remedy=(*turn, f", or {of_samples}"))

"""Programs: the computation of one kernel as data, of which its text is made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

from fastlink.catalogue.catalogue import Catalogue, Fact, System
from fastlink.catalogue.tables import angle_tables
from fastlink.facts.names import derivative_name
from fastlink.plan.query import Request
from fastlink.symbolic.changes import Term

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.facts.fact import GradedRange, KnownExtremes

__all__ = ["ExtremaProgram", "ExtremumSearch", "Gradient", "KnownProgram", "Lanes", "Output", "Program"]

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
    """Facts to compute at input positions, and the results that are made of them.

    Attributes
    ----------
    catalogue : Catalogue
        The mechanism.
    outputs : tuple of Output
        The results, in the order of the request.
    steps : tuple of Fact or System
        Everything computed, in order.
    inputs : tuple of str
        The inputs that the steps read, the rows of the kernel's design array.
    branches : tuple of int
        The assembly modes.
    variants : tuple of str
        The selected variants.
    tables : tuple of str
        The functions of the input position that the steps read, the rows of the kernel's angle array.
    lanes : {"designs", "angles"}
        What stands side by side in the vector lanes.
    """

    catalogue: Catalogue
    outputs: tuple[Output, ...]
    steps: tuple[Fact | System, ...]
    inputs: tuple[str, ...]
    branches: tuple[int, ...]
    variants: tuple[str, ...]
    tables: tuple[str, ...] = ()
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
        axes |= {name: frozenset({axis}) for name, axis in coordinates.items()}
        axes["branch"] = frozenset({"branch"})
        for step in self.steps:
            joint = frozenset[str]().union(*(axes[name] for name in step.depends_on))
            axes |= dict.fromkeys(step.names, joint)
        return axes

    def angle_tables(self, positions: NDArray[Any]) -> NDArray[Any]:
        """Return the rows of the kernel's angle array (tables, positions)."""
        return angle_tables(self.catalogue, self.tables, positions)


@dataclass(frozen=True)
class ExtremumSearch:
    """A quantity whose extrema are searched.

    Attributes
    ----------
    quantity : str
        Its name.
    slope : str
        The fact that vanishes where it is extreme.
    cells, most : int
        Half the number of cells of the graded range, a power of two, and how many extrema are kept.
    order, slope_order : int
        The powers of 1/sigma by which quantity and slope grow at a toggle.
    parity, slope_parity : int
        What the mirror does to them: 1, -1, or 0 for no symmetry.
    at_limit : bool
        Whether the quantity has a value exactly at a toggle.
    divided : bool
        Whether cells are divided whose samples cannot exclude further extrema; the others have none that hide.
    magnitude : bool
        Whether it is the magnitude of a vector: its square is smooth where it comes close to zero.
    folds : bool
        Whether it is an angle from 0 to pi, which turns back at both.
    kinked : bool
        Whether its slope may jump over zero: it chooses the larger of two values, or takes the size of one.
    divisors : tuple of str
        The values other than 1/sigma by whose product the slope is divided.
    onto : str
        Where `slope` is another one, at whose zeros the quantity may be greatest or least too: the quantity.
    piece : bool
        Whether `slope` is the derivative of a smooth quantity that the quantity is in some places.
    jumps : bool
        Whether these are jumps of an angle by 2 pi, which reaches pi and -pi there.
    turns : tuple of str
        What vanishes where the slope jumps or has a kink: cells are split at these places.
    splits : bool
        Whether the zeros of `slope` are such places of other searches, and nothing else.
    bounded_by : tuple of str
        Where error bounds of the extremes are requested: those of quantity and slope, the slope's derivative, and the
        slope.
    gradients : tuple of Gradient
        The derivatives of the extremes by inputs that are requested, of the values before those of the places.
    known : KnownExtremes, optional
        Where its extremes are, if that is known in closed form.
    """

    quantity: str
    slope: str
    cells: int
    most: int
    order: int
    slope_order: int
    parity: int
    slope_parity: int
    at_limit: bool
    divided: bool
    magnitude: bool
    folds: bool = False
    kinked: bool = False
    divisors: tuple[str, ...] = ()
    onto: str = ""
    piece: bool = False
    jumps: bool = False
    turns: tuple[str, ...] = ()
    splits: bool = False
    bounded_by: tuple[str, ...] = ()
    gradients: tuple[Gradient, ...] = ()
    known: KnownExtremes | None = None

    @property
    def mirrored(self) -> bool:
        """Whether half the range in both branches says all, the other half being its mirror."""
        return self.parity != 0


@dataclass(frozen=True)
class Gradient:
    """The derivative of an extreme, or of its place, by an input.

    Attributes
    ----------
    by : str
        The input.
    is_position : bool
        Whether it is that of the place.
    held : tuple of str
        The derivative of the quantity at one input position; for the place those of the slope by the input and by the
        position, whose quotient times -1 it is. Empty where the input moves nothing but the limits of motion.
    moving : str
        The derivative at a place that moves with the limits of motion, empty where nothing moves.
    """

    by: str
    is_position: bool
    held: tuple[str, ...]
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
        """The branches that are searched."""
        return tuple(self.catalogue.branches) if self.mirrored else self.branches

    @property
    def sides(self) -> int:
        """Number of sides of the ground line that are searched."""
        return 1 if self.mirrored else 2


@dataclass(frozen=True, eq=False, kw_only=True)
class KnownProgram(ExtremaProgram):
    """Facts to compute at the few places of the graded range where the extremes of some quantities are known to be."""

    @cached_property
    def axes(self) -> dict[str, frozenset[str]]:
        """The axes on which each value depends: those of a place are the place itself and the side."""
        near, far, side = self.coordinates
        return self._axes_by({near: "place", far: "place", side: "side"})

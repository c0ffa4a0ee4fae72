"""What is computed for a set of names: data only, which kernel text and plans are made of."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from fastlink.catalogue.catalogue import Catalogue, Fact, System
from fastlink.catalogue.tables import angle_tables
from fastlink.plan.query import Request

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["EXTREMUM", "ExtremaProgram", "ExtremumSearch", "Lanes", "Output", "Program"]

Lanes = Literal["designs", "angles"]
#: The dimension along which the extremes of a quantity stand.
EXTREMUM = "extremum"


@dataclass(frozen=True)
class Output:
    """One result of a kernel: the request and the axes it has besides the design."""

    request: Request
    axes: tuple[str, ...]
    dtype: str
    refined: bool = False

    @property
    def name(self) -> str:
        """Name of the result."""
        return self.request.name


@dataclass(frozen=True, eq=False)
class Program:
    """What is computed for a set of names.

    Attributes
    ----------
    catalogue : Catalogue
        The mechanism.
    outputs : tuple of Output
        The results, in the order asked.
    steps : tuple of Fact or System
        The closure: everything computed, in order.
    inputs : tuple of str
        The inputs that the closure reads, the rows of the kernel's design array.
    tables : tuple of str
        The functions of the input position that it reads, the rows of the kernel's angle array.
    branches : tuple of int
        The assembly modes.
    lanes : {"designs", "angles"}
        What stands side by side in the vector lanes.
    variants : tuple of str
        The chosen sets of facts.
    """

    catalogue: Catalogue
    outputs: tuple[Output, ...]
    steps: tuple[Fact | System, ...]
    inputs: tuple[str, ...]
    tables: tuple[str, ...]
    branches: tuple[int, ...]
    lanes: Lanes
    variants: tuple[str, ...]

    @cached_property
    def axes(self) -> dict[str, frozenset[str]]:
        """The axes on which each value of the closure depends."""
        return axes_of(self.steps, self.inputs, self.tables, self.catalogue.position.name)

    @property
    def uses_position(self) -> bool:
        """Whether anything depends on the input position; a map of design facts touches none."""
        return bool(self.tables)

    def angle_tables(self, positions: NDArray[Any]) -> NDArray[Any]:
        """Return the rows of the kernel's angle array (tables, positions)."""
        return angle_tables(self.catalogue, self.tables, positions)


@dataclass(frozen=True)
class ExtremumSearch:
    """One quantity whose extremes are looked for.

    Attributes
    ----------
    quantity : str
        What is extreme.
    slope : str
        The fact that vanishes where it is.
    cells, most : int
        Half the number of cells of the graded range, a power of two, and how many extremes are kept.
    order, slope_order : int
        The powers of 1/sigma by which both grow at a toggle.
    parity, slope_parity : int
        What the mirror does to both: 1, -1, or 0 for no symmetry.
    at_limit : bool
        Whether the quantity has a value exactly at a toggle.
    onto : str
        Where `slope` vanishes at jumps by 2 pi instead: the quantity, which there reaches pi and -pi.
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
    onto: str = ""


@dataclass(frozen=True, eq=False)
class ExtremaProgram:
    """What is computed to find every extreme of some quantities.

    Attributes
    ----------
    catalogue : Catalogue
        The mechanism, which has a graded range.
    outputs : tuple of Output
        The results, in the order of the searches.
    searches : tuple of Search
        Quantities of one fineness and symmetry.
    steps : tuple of Fact
        Everything computed at a place of the graded range, in order.
    inputs : tuple of str
        The inputs that are read, the rows of the kernel's design array.
    branches : tuple of int
        The assembly modes that are asked for.
    variants : tuple of str
        The chosen sets of facts.
    """

    catalogue: Catalogue
    outputs: tuple[Output, ...]
    searches: tuple[ExtremumSearch, ...]
    steps: tuple[Fact, ...]
    inputs: tuple[str, ...]
    branches: tuple[int, ...]
    variants: tuple[str, ...]

    @cached_property
    def axes(self) -> dict[str, frozenset[str]]:
        """The axes on which each value depends."""
        graded = self.catalogue.graded
        assert graded is not None
        return axes_of(self.steps, self.inputs, graded.coordinates, self.catalogue.position.name)

    @property
    def mirrored(self) -> bool:
        """Whether half the range in both branches says all, the other half being its mirror."""
        return self.searches[0].parity != 0

    @property
    def computed(self) -> tuple[int, ...]:
        """The branches that are searched."""
        return tuple(self.catalogue.branches) if self.mirrored else self.branches

    @property
    def sides(self) -> int:
        """How many sides of the ground line are searched."""
        return 1 if self.mirrored else 2

    @property
    def uses_position(self) -> bool:
        """Whether anything is computed at the given input positions: never, samples are graded by design."""
        return False

    def angle_tables(self, positions: NDArray[Any]) -> NDArray[Any]:
        """Return an empty angle array."""
        return np.empty((0, 0))


def axes_of(
    steps: Iterable[Fact | System], inputs: Iterable[str], positions: Iterable[str], position: str
) -> dict[str, frozenset[str]]:
    """Return the axes on which values depend, for steps in order."""
    axes = {name: frozenset({"design"}) for name in inputs}
    axes |= {name: frozenset({position}) for name in positions}
    axes["branch"] = frozenset({"branch"})
    for step in steps:
        joint = frozenset[str]().union(*(axes[need] for need in step.depends_on))
        for name in step.names:
            axes[name] = joint
    return axes

"""The designs that are verified, their results, and the budget of evaluations."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue.catalogue import Fact, System
from fastlink.catalogue.evaluate import read_facts
from fastlink.catalogue.sizes import natural_size
from fastlink.catalogue.tables import angle_tables
from fastlink.errors import InputError
from fastlink.facts.names import error_name
from fastlink.precision.reference import HighPrecision

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.plan.plan import Plan

__all__ = ["Sample", "cost", "read_curves", "within"]

#: The cost of a table of the input position, a linear system and a function of double words, in facts.
TABLE, SYSTEM, PAIRS = 40, 300, 16
OF_PAIRS = {"gap", "gap_product_quotient", "pair_product", "pair_quotient", "two_product"}
#: Designs that are verified whatever the cost.
FEWEST = 8


@dataclass(frozen=True, eq=False)
class Sample:
    """Designs of a sweep with their results, and one branch of each for reductions.

    Attributes
    ----------
    plan : Plan
        The plan of the sweep.
    inputs : mapping of str to array (designs,)
        The inputs of the designs.
    positions : array
        The input positions.
    branch_indices : array of int
        For each design the index of its branch among those of the plan.
    results : mapping of str to array (designs, ...)
        The results of the sweep by output.
    """

    plan: Plan
    inputs: dict[str, NDArray[Any]]
    positions: NDArray[Any]
    branch_indices: NDArray[Any]
    results: dict[str, NDArray[Any]] = field(default_factory=dict)

    @property
    def catalogue(self) -> Catalogue:
        """The mechanism."""
        return self.plan.catalogue

    @property
    def count(self) -> int:
        """The number of designs."""
        return int(self.branch_indices.size)

    @cached_property
    def branches(self) -> NDArray[Any]:
        """The assembly mode of each design."""
        modes: NDArray[Any] = np.array(self.plan.branches, dtype=float)[self.branch_indices]
        return modes

    @cached_property
    def movable(self) -> list[str]:
        """The inputs that are not codes, with respect to which derivatives exist."""
        known = self.catalogue.known_inputs(self.plan.variants)
        return [name for name in self.inputs if not known[name].choices]

    def facts(self, names: Iterable[str], *, zeroes: bool = False) -> HighPrecision:
        """Return facts at configurations of these designs, with 50 digits."""
        given = (*self.inputs, self.catalogue.position.name, "branch")
        return HighPrecision(self.catalogue, names, given, self.plan.variants, zeroes=zeroes)

    def result(self, name: str, design: int) -> Any:
        """Return the result of a reduction for a design in its branch."""
        return self.results[name][design, self.branch_indices[design]]

    def configuration(self, design: int, branch: float, position: float) -> dict[str, float]:
        """Return the values that `facts` are evaluated at."""
        values = {name: float(column[design]) for name, column in self.inputs.items()}
        return {**values, "branch": branch, self.catalogue.position.name: position}

    def arguments(self, facts: HighPrecision) -> list[str]:
        """Return the inputs and position whose changes make up the condition of facts."""
        position = self.catalogue.position.name
        return [name for name in (*self.movable, position) if facts.steps_after(name)]

    def terms(self, quantity: str, design: int) -> float:
        """Return the size of a quantity of a design by its lengths, masses and rates."""
        values = {name: float(column[design]) for name, column in self.inputs.items()}
        return natural_size(self.catalogue, values, self.catalogue.public_fact(quantity).units)

    def bound(self, quantity: str, at: Mapping[str, float]) -> float:
        """Return the error bound of a quantity at a configuration; infinite where it has none."""
        try:
            facts = read_facts(
                self.catalogue,
                [name := error_name(quantity)],
                {k: np.float64(v) for k, v in at.items()},
                self.plan.variants,
            )
        except InputError:
            return np.inf
        return float(facts[name]) if facts[name] == facts[name] else np.inf

    def affordable(self, facts: HighPrecision, share: int, most: int) -> int:
        """Return the number of configurations that a share of the evaluations pays for."""
        condition = sum(cost(facts.steps_after(name)) for name in self.arguments(facts))
        return within(share, cost(facts.steps) + condition + 2 * TABLE * len(facts.tables), most)

    def curves(self, quantity: str, designs: int) -> NDArray[Any]:
        """Return a quantity (designs, positions) at all input positions, in doubles."""
        values: dict[str, Any] = {name: column[:designs, None] for name, column in self.inputs.items()}
        values["branch"] = self.branches[:designs, None]
        samples = read_curves(self.catalogue, quantity, values, self.positions, self.plan.variants)
        return np.broadcast_to(samples, (designs, self.positions.size))


def read_curves(
    catalogue: Catalogue,
    quantity: str,
    values: Mapping[str, Any],
    positions: NDArray[Any],
    variants: Iterable[str],
) -> Any:
    """Return a quantity over the input positions (last axis), without a kernel."""
    tables = (catalogue.position.name, *catalogue.tables, *catalogue.table_low_parts)
    tabled = zip(tables, angle_tables(catalogue, tables, positions), strict=True)
    return read_facts(catalogue, [quantity], {**values, **dict(tabled)}, variants)[quantity]


def cost(steps: Iterable[Fact | System]) -> int:
    """Return the cost of steps with 50 digits, in facts."""
    return sum(
        SYSTEM
        if isinstance(step, System)
        else PAIRS
        if OF_PAIRS.intersection(step.function.__code__.co_names)
        else 1
        for step in steps
    )


def within(share: int, each: int, most: int) -> int:
    """Return the number that a share of the evaluations pays for, at this cost each."""
    return min(max(share // max(each, 1), FEWEST), most)

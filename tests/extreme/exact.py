"""What rounding the data of one configuration does to its quantities, told sharply."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from typing import Any

from fastlink.facts.catalogue import Catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision.reference import CONTEXT, HighPrecision

__all__ = ["CONTEXT", "TINY", "Configuration", "Size", "alone"]

#: What one rounding of a sum in twice the working precision does.
UNIT_OF_TWO = 2.0**-103
#: What rounding does where numbers are below 2^-1022: half of the least subnormal number.
TINY = CONTEXT.mpf(2) ** -1075

Size = Callable[[Mapping[str, Any]], Any]

#: A gap within the rounding of the lengths is zero here, too: what comes out is right for the change point.
exact_facts = lru_cache(maxsize=32)(partial(HighPrecision, zeroes=True))


def alone(values: Mapping[str, Any]) -> Any:
    """Return the size of what is not a difference."""
    return 0


class Configuration:
    """The facts of one configuration with 50 digits, and what rounding does to them.

    Facts that are `held` are right to a few roundings however their data cancel, being taken in twice the working
    precision; of all values they have the size of what they are differences of.
    """

    def __init__(
        self,
        catalogue: Catalogue,
        names: tuple[str, ...],
        inputs: Mapping[str, float],
        held: Mapping[str, Size],
    ) -> None:
        chosen = catalogue.variants_selected_by(inputs)
        self.names, self.held = names, held
        self.inputs = tuple(name for name in inputs if name != "branch")
        self.tables = tuple(catalogue.tables)
        self.plain = exact_facts(catalogue, (*names, *held), tuple(inputs), chosen)
        self.from_held = exact_facts(catalogue, names, (*inputs, *held), chosen)
        self.values = self.plain.at(inputs)

    def condition(self) -> dict[str, Any]:
        """Return the condition numbers times the values: the sums over the inputs x of abs(x df/dx)."""
        return self.plain.condition(self.values, self.inputs)

    def roundings(self) -> dict[str, Any]:
        """Return the same where inputs, tables of the position and held facts have one rounding each.

        It does not grow with what the condition number owes to differences that are taken without loss.
        """
        sums = dict.fromkeys(self.names, CONTEXT.zero)
        moving = (name for name in self.inputs if name != self.plain.position)
        for name in (*moving, *(table for table in self.tables if table in self.values), *self.held):
            size = abs(self.values[name])
            if size == 0 or CONTEXT.isnan(size):
                continue
            parts = self.held[name](self.values) if name in self.held else 0
            rounding = (max(UNIT_ROUNDING * size, TINY) + UNIT_OF_TWO * abs(parts)) / size
            for quantity, slope in self.from_held.condition(self.values, (name,)).items():
                # Where the value ends, it has no slope: nothing is allowed for it.
                sums[quantity] += 0 if CONTEXT.isnan(slope) else slope * rounding
        return sums

    def depending(self, on: Callable[[Any], bool], tables: bool = False) -> set[str]:
        """Return what a fact (or table) of some kind is met on the way to."""
        found = {step.name for step in self.plain.steps if on(self.values[step.name])}
        found |= {name for name in self.tables if tables and name in self.values and on(self.values[name])}
        for step in self.plain.steps:
            if found.intersection(step.depends_on):
                found.add(step.name)
        return found

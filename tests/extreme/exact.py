"""What rounding the data of one configuration does to its quantities, told sharply."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any

from fastlink.catalogue import Catalogue
from fastlink.exact import CONTEXT, UNIT, Exact

__all__ = ["CONTEXT", "TINY", "UNIT", "Configuration"]

#: What one rounding of a sum in twice the working precision does.
UNIT_OF_TWO = 2.0**-103
#: Half the least subnormal number: what rounding does where numbers are that small.
TINY = CONTEXT.mpf(2) ** -1075

exact_facts = lru_cache(maxsize=32)(Exact)


class Configuration:
    """The facts of one configuration with 50 digits, and what rounding does to them.

    Parameters
    ----------
    catalogue : Catalogue
        The mechanism.
    names : tuple of str
        Facts.
    inputs : mapping of str to float
        Inputs, position and branch, all taken as exact.
    held : mapping of str to tuple of str
        Facts that are right to a few roundings however their data cancel, being differences of the facts named here
        in twice the working precision.
    """

    def __init__(
        self,
        catalogue: Catalogue,
        names: tuple[str, ...],
        inputs: Mapping[str, float],
        held: Mapping[str, tuple[str, ...]],
    ) -> None:
        chosen = catalogue.chosen_by(inputs)
        self.names, self.held = names, held
        self.inputs = tuple(name for name in inputs if name != "branch")
        self.tables = tuple(catalogue.tables)
        self.plain = exact_facts(catalogue, (*names, *held), tuple(inputs), chosen)
        self.from_held = exact_facts(catalogue, names, (*inputs, *held), chosen)
        self.values = self.plain.at(inputs)

    def condition(self) -> dict[str, Any]:
        """Return what one rounding of each input adds up to: the condition numbers times values and rounding."""
        return {name: UNIT * of for name, of in self.plain.condition(self.values, self.inputs).items()}

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
            parts = sum(abs(self.values[part]) for part in self.held.get(name, ()))
            rounding = (max(UNIT * size, TINY) + UNIT_OF_TWO * parts) / size
            for quantity, slope in self.from_held.condition(self.values, (name,)).items():
                sums[quantity] += slope * rounding
        return sums

    def leaves_doubles(self, largest: float) -> set[str]:
        """Return what depends on a value beyond the largest double."""
        beyond: set[str] = {name for name, value in self.values.items() if abs(value) > largest}
        for step in self.plain.steps:
            if beyond.intersection(step.needs):
                beyond.add(step.name)
        return beyond

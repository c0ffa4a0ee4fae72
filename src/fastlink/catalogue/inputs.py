"""Inputs: own ones, those of variants, tolerances; which variants they select, which exclude others."""

from __future__ import annotations

from collections.abc import Iterable

from fastlink.catalogue.declare import Declarations
from fastlink.facts.fact import Input
from fastlink.symbolic.changes import (
    TOLERANCES,
    is_tolerance,
    tolerance_inputs,
    tolerance_name,
    toleranced,
)

__all__ = ["DesignInputs"]


class DesignInputs(Declarations):
    """The inputs of one mechanism."""

    def known_inputs(self, variants: Iterable[str] = ()) -> dict[str, Input]:
        """Return every input that a design may give, with those of the selected variants."""
        known = dict(self.inputs)
        for variant in variants:
            known.update(self.tolerances if variant == TOLERANCES else self.variant_inputs.get(variant, {}))
        return known

    @property
    def all_inputs(self) -> dict[str, Input]:
        """Every input that a design of any variant may give, and their tolerances."""
        return self.known_inputs((*self.variant_inputs, TOLERANCES))

    @property
    def tolerances(self) -> dict[str, Input]:
        """The tolerances of all inputs, which a design may give as it gives inputs."""
        if self._tolerances[0] != (version := self.version):
            inputs = {**self.known_inputs(self.variant_inputs), self.position.name: self.position}
            self._tolerances = version, tolerance_inputs(inputs.values())
        return self._tolerances[1]

    _tolerances: tuple[int, dict[str, Input]] = -1, {}

    def variants_selected_by(self, given: Iterable[str]) -> tuple[str, ...]:
        """Return the variants that a design selects by giving these inputs.

        An input selects the variant that is named after it (it replaces another input), and the variant to which it
        belongs if some input of that variant has a default.
        """
        names = set(given)
        selected = tuple(
            variant
            for variant, inputs in self.variant_inputs.items()
            if variant in names
            or (names & set(inputs) and any(i.default is not None for i in inputs.values()))
        )
        return (*selected, TOLERANCES) if any(map(is_tolerance, names)) else selected

    def mutually_exclusive_inputs(self, name: str) -> tuple[str, ...]:
        """Return the inputs that cannot be given together with this one."""
        if is_tolerance(name):
            both = (tolerance_name(toleranced(name), relative) for relative in (False, True))
            return tuple(other for other in both if other != name)
        replaced = [other for other in self.variants.get(name, {}) if other in self.inputs]
        replacing = [key for key, facts in self.variants.items() if name in facts and name in self.inputs]
        named = [key for key in replacing if key in self.variant_inputs.get(key, {})]
        siblings = [key for other in replaced for key in self.mutually_exclusive_inputs(other) if key != name]
        return (*replaced, *named, *siblings)

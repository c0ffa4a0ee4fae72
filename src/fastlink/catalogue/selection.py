"""A mechanism with selected variants, some of whose facts are given: its derivatives and error bounds."""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property
from typing import TYPE_CHECKING

from fastlink.errors import InputError
from fastlink.facts.fact import CatalogueError, Fact, System
from fastlink.facts.names import Below, Change, Name, Quantity, derivative_name
from fastlink.symbolic.changes import (
    Term,
    change_fact,
    is_tolerance,
    terms,
    tolerance_fact,
    tolerance_name,
    toleranced,
)
from fastlink.symbolic.derivative import Derivation, NoDependence, NoDerivative
from fastlink.symbolic.error_bound import ErrorBounds

if TYPE_CHECKING:
    from fastlink.catalogue.catalogue import Catalogue

__all__ = ["Selection", "name_below", "plain_and_above", "replaced_by", "variants_below"]


class Selection:
    """The facts of a mechanism with selected variants, but for facts that are given.

    Parameters
    ----------
    catalogue : Catalogue
        The mechanism.
    variants : tuple of str
        The selected variants; the first one that has a fact counts.
    given : collection of str
        The facts and tolerances that are given.
    """

    def __init__(self, catalogue: Catalogue, variants: tuple[str, ...], given: Collection[str]) -> None:
        self.catalogue, self.variants, self.given = catalogue, variants, given
        self._derivations: dict[tuple[str, bool], Derivation] = {}

    def find(self, name: str) -> Fact | System | None:
        """Return the fact or system that determines a name, None if it is given."""
        return None if name in self.given else self.catalogue.resolve(name, self.variants, self.given)

    def derivation(self, by: str, moving: bool = False) -> Derivation:
        """Return the derivatives with respect to a variable, those by an input at one input position.

        In the graded range a place moves with the lengths, as its ends do. Unless a derivative is `moving`, too,
        the facts of a given position are differentiated by an input instead, which have the same values.
        """
        if (by, moving) not in self._derivations:
            variable, graded = self.catalogue.variables[by], self.catalogue.graded
            held = graded is not None and by != self.catalogue.position.name and graded.name in self.variants
            at = self._without(graded.name) if graded is not None and held and not moving else self
            own = variable, at.find, lambda name: at._declared(name, by)
            guards = [self.catalogue.is_public] if by != self.catalogue.position.name and not moving else []
            self._derivations[by, moving] = Derivation(*own, moving, *guards)
        return self._derivations[by, moving]

    def _without(self, variant: str) -> Selection:
        """Return the mechanism with the other variants."""
        return Selection(self.catalogue, tuple(one for one in self.variants if one != variant), self.given)

    @cached_property
    def toleranced(self) -> tuple[str, ...]:
        """The inputs that have tolerances, in the order of the catalogue."""
        of = set(map(toleranced, filter(is_tolerance, self.given)))
        return tuple(name for name in self.catalogue.variables if name in of)

    def change_terms(self, name: str, over_cycle: bool = False, at_limits: bool = False) -> tuple[Term, ...]:
        """Return the terms of the change of a fact by the tolerances that are given.

        A property of the cycle (`over_cycle`) does not change with the input position; an extreme that is searched
        (`at_limits`) does with what moves the limits of motion.

        Raises
        ------
        InputError
            No tolerance is given of an input on which it depends.
        """
        of = {self.catalogue.position.name} if over_cycle else set()
        needed = [
            by
            for by in self.toleranced
            if by not in of and (self._depends(name, by) or (at_limits and self.moves(name, by)))
        ]
        if not needed:
            what = f"the change of {name} needs the tolerance of an input on which {name} depends"
            known = self.catalogue.known_inputs(self.variants)
            some = [
                tolerance_name(by)
                for by in self.catalogue.variables
                if by in known and self._depends(name, by)
            ]
            raise InputError(
                what, remedy=f"add to the design some of {', '.join(some)}" if some else "leave it out"
            )
        return terms(needed)

    def _depends(self, name: str, by: str) -> bool:
        """Tell whether a fact changes with an input."""
        try:
            self.derivation(by).fact(name)
        except NoDependence:
            return False
        return True

    def moves(self, name: str, by: str) -> bool:
        """Tell whether a fact changes at a place that moves with the limits of motion as an input does."""
        graded = self.catalogue.graded
        if graded is None:
            return False
        try:
            moving = derivative_name(name, by, moving=True)
            return self.catalogue.resolve(moving, (graded.name, *self.variants), self.given) is not None
        except NoDerivative:
            return False

    def change(self, name: str, how: str) -> Fact:
        """Return the change of a fact by the tolerances that are given."""
        labelled = self.catalogue.public_fact(str(Change(Quantity(name), how)))  # codes have none
        pairs = [(derivative_name(name, term.by), term.tolerance) for term in self.change_terms(name)]
        return change_fact(labelled, how, pairs)

    def tolerance(self, name: str) -> Fact | None:
        """Return the fact of the change that an input may have, None for the name of another."""
        return tolerance_fact(name, self.given)

    @cached_property
    def error_bounds(self) -> ErrorBounds:
        """The error bounds."""
        known = self.catalogue
        inputs = known.known_inputs(self.variants)
        fractions = known.graded.coordinates[:2] if known.graded is not None else ()
        return ErrorBounds(
            self.find,
            inputs,
            known.branches,
            known.tables,
            known.table_low_parts,
            fractions,
            is_quantity=known.is_quantity,
            angle_of=self._angle_of,
        )

    def _angle_of(self, name: str) -> str | None:
        """Return the input position if a name changes with it and it is an angle, a number of no length."""
        known = self.catalogue
        is_angle = known.position.units in ("rad", "1")
        return known.position.name if is_angle and known.varies(name) else None

    def _declared(self, name: str, by: str) -> Fact | None:
        """Return the declared derivative of a name, None if there is none."""
        if name in self.given:
            return None
        known = self.catalogue
        plain, above = plain_and_above(known.parse(name))
        variants = [known.variants.get(variant, {}) for variant in variants_below(self.variants, above)]
        # the declared derivative of a fact is not the derivative of a fact that replaces it
        facts = next((facts for facts in variants if plain in facts), known.facts)
        derivative = facts.get(derivative_name(plain, by))
        if isinstance(derivative, Fact):
            return derivative
        if facts is known.facts and plain in known.tables and by == known.position.name:
            raise CatalogueError(
                f"{known.name}: table {plain} has no declared derivative with respect to {by}"
            )
        return None


def plain_and_above(tree: Name) -> tuple[str, str]:
    """Return the name of a fact, and the variant whose fact builds on it, if any."""
    return (str(tree.of), tree.variant) if isinstance(tree, Below) else (str(tree), "")


def variants_below(variants: tuple[str, ...], above: str) -> tuple[str, ...]:
    """Return the variants after the one `above`, all if that is empty."""
    return variants[variants.index(above) + 1 :] if above else variants


def name_below(name: str, variant: str) -> str:
    """Return the name by which the fact of a variant uses the fact that it replaces."""
    return str(Below(Quantity(name), variant))


def replaced_by(variant: str, fact: Fact) -> Fact:
    """Return a fact under the names by which the fact of a variant, if any, uses it."""
    return (
        fact.renamed(lambda name: name_below(name, variant) if name in fact.names else name)
        if variant
        else fact
    )

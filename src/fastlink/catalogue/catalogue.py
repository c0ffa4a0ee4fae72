"""Answer questions about a mechanism from its declarations: quantities, dependencies, derivatives, error bounds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cached_property
from typing import Self

from fastlink.catalogue.inputs import DesignInputs
from fastlink.catalogue.selection import Selection, name_below, plain_and_above, replaced_by, variants_below
from fastlink.errors import InputError, Model, Piece, Problem, suggest
from fastlink.facts.fact import CatalogueError, Fact, GradedRange, Input, System, parameters
from fastlink.facts.names import (
    Change,
    Derivative,
    ErrorBound,
    Made,
    Trust,
    as_derivative,
    innermost,
    plain_part,
)
from fastlink.symbolic.changes import TOLERANCES, Term, is_tolerance, with_change_labels
from fastlink.symbolic.derivative import NoDerivative, with_derivative_labels
from fastlink.symbolic.error_bound import trust_fact, with_error_labels
from fastlink.symbolic.postorder import CircularError, postorder

__all__ = ["Catalogue", "CatalogueError", "Fact", "GradedRange", "Input", "System", "parameters"]


class Catalogue(DesignInputs):
    """The inputs and facts of one mechanism.

    Parameters
    ----------
    name : str
        Name of the mechanism, as a study file has it.
    title : str
        One line about it.
    branches : mapping of int to str
        The assembly modes and what distinguishes them.
    position : Input
        The input position, which runs over the cycle.
    positions : (first, last, number), optional
        The default input positions of an input without bounds; without them the input turns in equal steps.
    """

    #: A fact that is a number exactly where the loop closes, and further ones by which only such values are made. Empty
    #: where no quantity has a value elsewhere.
    closes: tuple[str, ...] = ()

    def copied(self) -> Self:
        """Return the same declarations, to which others can be added."""
        copied = object.__new__(type(self))  # copy.copy takes what travels by its name for the same thing
        derived = ("_selections", "_varying")
        copied.__dict__.update({name: own for name, own in self.__dict__.items() if name not in derived})
        copied.inputs, copied.facts, copied.tables = dict(self.inputs), dict(self.facts), dict(self.tables)
        copied.variants = {name: dict(facts) for name, facts in self.variants.items()}
        copied.variant_inputs = {name: dict(inputs) for name, inputs in self.variant_inputs.items()}
        copied.hiding = set(self.hiding)
        copied._formed = {name: list(formed) for name, formed in self._formed.items()}
        copied._seen = [], -1
        return copied

    @property
    def public(self) -> dict[str, Fact]:
        """The quantities: the facts that users may request by name."""
        return {name: fact for name, fact in self.facts.items() if not fact.internal}

    def resolve(
        self, name: str, variants: Iterable[str] = (), given: Iterable[str] = ()
    ) -> Fact | System | None:
        """Return the fact or system that determines `name`, else None.

        Inputs, tables and unknown names have none. The fact of the first selected variant that has one counts, else
        that of the mechanism itself. A fact of a variant that depends on its own name builds on the fact that it
        replaces (in a later variant, or in the mechanism), see `fastlink.facts.names.Below`: in this way loads add up
        in any combination. In derivatives and error bounds, facts among `given` count as inputs.
        """
        selected = tuple(variants)
        tree = self.parse(name)
        if isinstance(tree, (Derivative, ErrorBound, Trust, Change)):
            return self._derived(tree, self._selection(selected, given))
        if TOLERANCES in selected and (fact := self._selection(selected, given).tolerance(name)):
            return fact
        plain, above = plain_and_above(tree)
        if above and above not in selected:
            return None
        for variant in variants_below(selected, above):
            step = self.variants.get(variant, {}).get(plain)
            if isinstance(step, System):
                return step
            if step is not None:
                own = {name: name_below(name, variant) for name in step.names}
                if not own.keys().isdisjoint(step.depends_on):
                    step = replace(step, depends_on=tuple(own.get(name, name) for name in step.depends_on))
                return replaced_by(above, step)
        fact = self.facts.get(plain)
        return fact and replaced_by(above, fact)

    def change_terms(
        self,
        name: str,
        variants: Iterable[str] = (),
        given: Iterable[str] = (),
        *,
        over_cycle: bool = False,
        at_limits: bool = False,
    ) -> tuple[Term, ...]:
        """Return the terms of the changes of a fact by the tolerances that are given, see `Selection.change_terms`."""
        return self._selection(tuple(variants), given).change_terms(name, over_cycle, at_limits)

    def moves_at_limits(self, name: str, by: str, variants: Iterable[str], given: Iterable[str]) -> bool:
        """Tell whether a fact changes with an input at limits of motion, see `Selection.moves`."""
        return self._selection(tuple(variants), given).moves(name, by)

    def _derived(self, tree: Derivative | ErrorBound | Trust | Change, selection: Selection) -> Fact:
        """Return the fact of a derivative, an error bound, a trust or a change."""
        of = str(tree.of)
        if isinstance(tree, Change):
            return selection.change(of, tree.how)
        if isinstance(tree, ErrorBound):
            return selection.error_bounds.fact(of)
        if isinstance(tree, Trust):
            return trust_fact(selection.error_bounds.bounded_fact(of))
        if isinstance(tree.of, (ErrorBound, Trust)):
            what = f"quantity {str(tree)!r}: {of} is an error bound, which has no derivative"
            raise NoDerivative(what, remedy="leave it out")
        return selection.derivation(tree.by, tree.moving).fact(of)

    def _selection(self, variants: tuple[str, ...], given: Iterable[str]) -> Selection:
        """Return the mechanism with these variants and given facts."""
        facts = {*self.facts, *(name for variant in variants for name in self.variants.get(variant, {}))}
        key = variants, frozenset(name for name in given if name in facts or is_tolerance(name))
        if key not in self._selections:
            self._selections[key] = Selection(self, *key)
        return self._selections[key]

    @cached_property
    def _selections(self) -> dict[tuple[tuple[str, ...], frozenset[str]], Selection]:
        return {}

    @cached_property
    def _varying(self) -> set[str]:
        """The names of the plain values that change over the cycle."""
        varying = {self.position.name, *self.tables, *self.table_low_parts}
        leaves = {*varying, "branch", *self.known_inputs(self.variant_inputs)}
        names = [name for name in self.facts if not self.is_derivative(name)]
        for step in self.dependencies(names, leaves):
            if not varying.isdisjoint(step.depends_on):
                varying.update(step.names)
        return varying

    def varies(self, name: str) -> bool:
        """Tell whether a fact changes over the cycle."""
        # derivatives and error bounds vary where their quantity does; constant tables have none
        return plain_part(self.parse(name)) in self._varying

    def check(self) -> None:
        """Raise CatalogueError if a name is not declared, or a fact depends on itself."""
        for variant, steps in self.variants.items():
            for name in set(steps) - set(self.facts) - set(self.inputs):
                step = steps[name]
                if isinstance(step, System) or not step.internal:
                    raise CatalogueError(
                        f"{self.name}: {variant} gives {name}, which is not a quantity or input"
                    )
        derivatives = {name for name in self.facts if self.is_derivative(name)}
        for name in set(self.facts) - derivatives:
            self.check_reading(name)
        parts = {part for name in derivatives for part in self.facts[name].depends_on}
        names = {*self.facts, *parts} - derivatives
        leaves = {"branch", self.position.name, *self.tables, *self.table_low_parts}
        if self.graded is not None:
            leaves |= set(self.graded.coordinates)
        for option in ((), *((name,) for name in {*self.variants, *self.variant_inputs})):
            replaced = {name for key in option for name in self.variants.get(key, {})}
            known = leaves | (set(self.known_inputs(option)) - replaced)
            for _ in self.dependencies(sorted(names), known, option):
                pass

    def is_quantity(self, name: str) -> bool:
        """Tell whether a name is a public fact, or a derivative or error bound of one."""
        tree = self.parse(name)
        return self.is_public(plain_part(tree)) and not (isinstance(tree, Derivative) and tree.moving)

    def has_reductions(self, name: str) -> bool:
        """Tell whether a name is a quantity that changes over the cycle."""
        return self.is_quantity(name) and self.varies(name)

    def public_fact(self, name: str) -> Fact:
        """Return the labels of a public quantity.

        Raises
        ------
        InputError
            There is no such quantity.
        """
        if not self.is_quantity(name):
            raise self.unknown_error(name)
        tree = self.parse(name)
        if not isinstance(tree, Made):
            return self.facts[name]
        of = self.public_fact(str(tree.of))
        lacks = (
            "change"
            if isinstance(tree, Change)
            else "derivative"
            if isinstance(tree, Derivative)
            else "error"
        )
        if isinstance(tree, Change) and isinstance(tree.of, Change):
            raise InputError(f"quantity {name!r}: {of.name} is a change itself", remedy=f"ask for {of.name}")
        if of.flags or isinstance(tree.of, (ErrorBound, Trust)):
            kind = "a code" if of.flags else "an error bound"
            what = f"quantity {name!r}: {of.name} is {kind}, which has no {lacks}"
            raise InputError(what, remedy="leave it out")
        if isinstance(tree, Derivative):
            return with_derivative_labels(of, self.variables[tree.by])
        if isinstance(tree, Change):
            return with_change_labels(of, tree.how)
        return with_error_labels(of) if isinstance(tree, ErrorBound) else trust_fact(of)

    def is_of_position(self, name: str) -> bool:
        """Tell whether a name is the input position, or a form of it such as its maximum."""
        return innermost(name, self) == self.position.name

    def absence(self, name: str) -> InputError | None:
        """Return the error that says why a name is not a quantity here, if more is known than that."""
        if not self.is_of_position(name):
            return None
        of = "" if name == self.position.name else f": {self.position.name}"
        what = f"quantity {name!r}{of} is the input position, a coordinate of the result"
        return InputError(what, remedy="leave it out")

    def unknown_part(self, name: str) -> tuple[str, bool]:
        """Return the part of a name that is unknown, else all of it, and whether it stands for a variable."""
        tree = self.parse(name)
        if isinstance(tree, (ErrorBound, Trust, Change)):
            return str(tree.of), False
        if parts := as_derivative(name):
            of_variable = self.is_quantity(parts[0])
            return parts[of_variable], of_variable
        return name, False

    def unknown_error(self, name: str) -> InputError:
        """Return the error for a name that is no quantity, with the nearest by its letters."""
        wrong, of_variable = self.unknown_part(name)
        what = f"quantity {name!r}" if wrong == name else f"quantity {name!r}: {wrong!r}"
        remedy = suggest(wrong, self.variables if of_variable else self.public)
        return self.absence(name) or InputError(f"{what} is unknown to {self.name}", remedy=remedy)

    def dependencies(
        self, names: Iterable[str], leaves: Iterable[str], variants: Iterable[str] = ()
    ) -> Iterator[Fact | System]:
        """Yield the steps that `names` depend on, each after its own dependencies.

        Names in `leaves` are given. A missing input is an InputError.
        """
        given, selected = set(leaves), tuple(variants)
        done = set(given)
        steps: dict[str, Fact | System] = {}

        def parts(name: str) -> tuple[str, ...]:
            step = self.resolve(name, selected, given)
            if step is None:
                dependents = (of for of in reversed(steps) if name in steps[of].depends_on)
                raise self._missing(name, next(dependents, None))
            steps[name] = step
            return step.depends_on

        try:
            for name in postorder(names, parts, done):
                done.update(steps[name].names)
                yield steps[name]
        except CircularError as error:
            raise CatalogueError(f"{self.name}: circular: {' -> '.join(error.args)}") from None

    def models_of(self, name: str) -> tuple[Model, ...]:
        """Return the models of the links that give an input."""
        return tuple(
            Model(model, tuple(inputs))
            for model, inputs in self.variant_inputs.items()
            if name in self.variants.get(model, {}) and model not in self.mutually_exclusive_inputs(name)
        )

    def missing_problem(self, declared: Input, dependent: str | None, *inside: str) -> Problem:
        """Return the problem that an input, on which another name depends, is not given."""
        others = "".join(f", or {other!r} instead" for other in self.mutually_exclusive_inputs(declared.name))
        what = f"is missing ({declared.meaning} [{declared.units}])"
        remedy: list[Piece] = [f"{dependent} depends on it: add it{others}"]
        for model in self.models_of(declared.name):
            remedy += [", or write ", model]
        return Problem(what, (*inside, declared.name), tuple(remedy) if remedy[1:] else str(remedy[0]))

    def _missing(self, name: str, dependent: str | None) -> Exception:
        declared = self.known_inputs(self.variant_inputs).get(name)
        if declared is not None:
            return InputError.of([self.missing_problem(declared, dependent)])
        if dependent is not None:
            return CatalogueError(f"{self.name}: {dependent} depends on {name}, which is not declared")
        return CatalogueError(f"{self.name}: {name} is not declared")

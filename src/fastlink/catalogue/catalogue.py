"""Read a mechanism off its declarations: what there is, what it depends on, what must be computed for it.

A *fact* (see `fastlink.facts.fact`) is a straight-line function; its parameters are the names of what it
depends on, its name is the name of the quantity, the first line of its docstring is its meaning.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cached_property

from fastlink.catalogue.declare import Declarations
from fastlink.errors import InputError, Problem, suggest
from fastlink.facts.fact import CatalogueError, Fact, GradedRange, Input, System, parameters
from fastlink.facts.names import (
    Below,
    Derivative,
    ErrorBound,
    Made,
    Name,
    Quantity,
    Trust,
    as_derivative,
    derivative_name,
    plain_part,
    reading_of,
)
from fastlink.symbolic.derivative import Derivation, NoDerivative, with_derivative_labels
from fastlink.symbolic.error_bound import ErrorBounds, trust_fact, with_error_labels
from fastlink.symbolic.postorder import CircularError, postorder

__all__ = ["Catalogue", "CatalogueError", "Fact", "GradedRange", "Input", "System", "parameters"]


class Catalogue(Declarations):
    """The inputs and facts of one mechanism.

    Parameters
    ----------
    name : str
        Name of the mechanism, as a study file has it.
    title : str
        What it is, in a line.
    branches : mapping of int to str
        The assembly modes and what tells them apart.
    position : Input
        The input position over which a cycle is taken.
    positions : (first, last, number), optional
        The input positions unless some are given, of an input without bounds; without them it turns, in equal steps.
    """

    @property
    def public(self) -> dict[str, Fact]:
        """The facts that users ask for by name."""
        return {name: fact for name, fact in self.facts.items() if not fact.internal}

    def known_inputs(self, variants: Iterable[str] = ()) -> dict[str, Input]:
        """Return every input that a design may give, with those of the chosen sets of facts."""
        known = dict(self.inputs)
        for variant in variants:
            known.update(self.variant_inputs.get(variant, {}))
        return known

    def variants_selected_by(self, given: Iterable[str]) -> tuple[str, ...]:
        """Return the sets of facts that giving these inputs chooses.

        Those with an input that may be left out, and those named after an input, which stands for another one.
        """
        names = set(given)
        return tuple(
            variant
            for variant, inputs in self.variant_inputs.items()
            if variant in names
            or (names & set(inputs) and any(i.default is not None for i in inputs.values()))
        )

    def mutually_exclusive_inputs(self, name: str) -> tuple[str, ...]:
        """Return the inputs that giving this one makes a result, or that make this one a result."""
        replaced = [other for other in self.variants.get(name, {}) if other in self.inputs]
        replacing = [key for key, facts in self.variants.items() if name in facts and name in self.inputs]
        named = [key for key in replacing if key in self.variant_inputs.get(key, {})]
        siblings = [key for other in replaced for key in self.mutually_exclusive_inputs(other) if key != name]
        return (*replaced, *named, *siblings)

    def resolve(
        self, name: str, variants: Iterable[str] = (), given: Iterable[str] = ()
    ) -> Fact | System | None:
        """Return what determines `name`, or None for an input, a table or an unknown name.

        The first of the chosen sets that has it, else the mechanism itself. A fact of a set that needs its own
        name builds on what it replaces (in a later set, or the mechanism), see `fastlink.facts.names.Below`: loads
        add themselves so, in any combination. A derivative is by what is given: facts among `given` count as inputs.
        """
        chosen = tuple(variants)
        tree = self.parse(name)
        if isinstance(tree, Derivative):
            if isinstance(tree.of, (ErrorBound, Trust)):
                what = f"quantity {name!r}: {tree.of} is an error bound, which has no derivative"
                raise NoDerivative(what, remedy="leave it out")
            return self._derivation(tree.by, chosen, given).fact(str(tree.of))
        if isinstance(tree, ErrorBound):
            return self._error_bounds(chosen, given).fact(str(tree.of))
        if isinstance(tree, Trust):
            return trust_fact(self._error_bounds(chosen, given).found(str(tree.of)))
        plain, above = _plain(tree)
        if above and above not in chosen:
            return None
        for variant in chosen[chosen.index(above) + 1 if above else 0 :]:
            found = self.variants.get(variant, {}).get(plain)
            if isinstance(found, Fact):
                depends_on = tuple(_below(n, variant) if n in found.names else n for n in found.depends_on)
                found = found if depends_on == found.depends_on else replace(found, depends_on=depends_on)
                return _replaced_by(above, found) if above else found
            if found is not None:
                return found
        fact = self.facts.get(plain)
        return _replaced_by(above, fact) if fact is not None and above else fact

    def _replaced(self, chosen: tuple[str, ...]) -> set[str]:
        """Return the names of all facts, those of the chosen sets too."""
        return {*self.facts, *(name for key in chosen for name in self.variants.get(key, {}))}

    def _error_bounds(self, chosen: tuple[str, ...], given: Iterable[str]) -> ErrorBounds:
        fixed = self._replaced(chosen).intersection(given)
        key = chosen, frozenset(fixed)
        if key not in self._bounds:
            self._bounds[key] = ErrorBounds(
                lambda name: None if name in fixed else self.resolve(name, chosen, fixed),
                self.known_inputs(chosen),
                self.branches,
                self.tables,
                self.table_low_parts,
            )
        return self._bounds[key]

    @cached_property
    def _bounds(self) -> dict[tuple[tuple[str, ...], frozenset[str]], ErrorBounds]:
        return {}

    def _derivation(self, by: str, chosen: tuple[str, ...], given: Iterable[str]) -> Derivation:
        fixed = self._replaced(chosen).intersection(given)
        key = by, chosen, frozenset(fixed)

        def find(name: str) -> Fact | System | None:
            return None if name in fixed else self.resolve(name, chosen, fixed)

        def declared(name: str) -> Fact | None:
            if name in fixed:
                return None
            plain, above = _plain(self.parse(name))
            sets = [self.variants.get(key, {}) for key in chosen[chosen.index(above) + 1 if above else 0 :]]
            # a derivative that is declared of a fact is not that of what replaces it
            within = next((facts for facts in sets if plain in facts), self.facts)
            found = within.get(derivative_name(plain, by))
            if found is None and within is self.facts and plain in self.tables and by == self.position.name:
                raise CatalogueError(f"{self.name}: table {plain} has no declared derivative by {by}")
            return found if isinstance(found, Fact) else None

        if key not in self._derivations:
            self._derivations[key] = Derivation(self.variables[by], find, declared)
        return self._derivations[key]

    @cached_property
    def _derivations(self) -> dict[tuple[str, tuple[str, ...], frozenset[str]], Derivation]:
        return {}

    @cached_property
    def _axes(self) -> dict[str, frozenset[str]]:
        axes = {name: frozenset({"design"}) for name in self.known_inputs(self.variant_inputs)}
        axes["branch"] = frozenset({"branch"})
        for name in (self.position.name, *self.tables, *self.table_low_parts):
            axes[name] = frozenset({self.position.name})
        # a derivative varies with what it is of, see `varies`; that of a constant table is none
        names = [name for name in self.facts if not self.is_derivative(name)]
        for found in self.dependencies(names, tuple(axes)):
            if isinstance(found, Fact):
                axes |= dict.fromkeys(
                    found.names, frozenset().union(*(axes[need] for need in found.depends_on))
                )
        return axes

    def varies(self, name: str) -> bool:
        """Tell whether a fact changes over the input cycle."""
        of = plain_part(self.parse(name))
        return self.position.name in self._axes[of]

    def check(self) -> None:
        """Raise CatalogueError unless every name is declared and no fact depends on itself."""
        for chosen, found in self.variants.items():
            for name in set(found) - set(self.facts) - set(self.inputs):
                fact = found[name]
                if isinstance(fact, System) or not fact.internal:
                    raise CatalogueError(f"{self.name}: {chosen} gives {name}, which is no quantity or input")
        derivatives = {name for name in self.facts if self.is_derivative(name)}
        for name in set(self.facts) - derivatives - self.hiding:
            if tree := reading_of(name, self):
                raise CatalogueError(f"{self.name}: {name} reads as {tree!r}; call it otherwise")
        names = {
            *self.facts,
            *(need for name in derivatives for need in self.facts[name].depends_on),
        } - derivatives
        leaves = {"branch", self.position.name, *self.tables, *self.table_low_parts}
        if self.graded is not None:
            leaves |= set(self.graded.coordinates)
        for option in ((), *((name,) for name in {*self.variants, *self.variant_inputs})):
            replaced = {name for key in option for name in self.variants.get(key, {})}
            known = leaves | (set(self.known_inputs(option)) - replaced)
            for _ in self.dependencies(sorted(names), known, option):
                pass

    def is_quantity(self, name: str) -> bool:
        """Tell whether users may ask for a name: a public fact, the derivative of one, the error bound of these."""
        return plain_part(self.parse(name)) in self.public

    def has_reductions(self, name: str) -> bool:
        """Tell whether users may ask for what is taken of a name over the cycle."""
        return self.is_quantity(name) and self.varies(name)

    def public_fact(self, name: str) -> Fact:
        """Return the labels of a quantity that users may ask for.

        Raises
        ------
        InputError
            There is no such quantity.
        """
        if not self.is_quantity(name):
            raise self.unknown_error(name, self.public)
        tree = self.parse(name)
        if not isinstance(tree, Made):
            return self.facts[name]
        of = self.public_fact(str(tree.of))
        lacks = "derivative" if isinstance(tree, Derivative) else "error"
        if of.flags or isinstance(tree.of, (ErrorBound, Trust)):
            kind = "a code" if of.flags else "an error bound"
            what = f"quantity {name!r}: {of.name} is {kind}, which has no {lacks}"
            raise InputError(what, remedy="leave it out")
        if isinstance(tree, Derivative):
            return with_derivative_labels(of, self.variables[tree.by])
        return with_error_labels(of) if isinstance(tree, ErrorBound) else trust_fact(of)

    def unknown_error(self, name: str, known: Iterable[str]) -> InputError:
        """Return the error of a name that is none of the known ones."""
        tree = self.parse(name)
        wrong, options = name, known
        if isinstance(tree, (ErrorBound, Trust)):
            wrong, options = str(tree.of), self.public
        elif made := as_derivative(name):
            wrong, options = (
                (made[1], self.variables) if self.is_quantity(made[0]) else (made[0], self.public)
            )
        what = f"quantity {name!r}" if wrong == name else f"quantity {name!r}: {wrong!r}"
        return InputError(f"{what} is unknown to {self.name}", remedy=suggest(wrong, options))

    def dependencies(
        self, names: Iterable[str], leaves: Iterable[str], variants: Iterable[str] = ()
    ) -> Iterator[Fact | System]:
        """Yield what must be computed for `names`, each after what it depends on.

        Names in `leaves` are given. A name that is neither given nor declared is an InputError.
        """
        given, chosen = set(leaves), tuple(variants)
        done: set[str] = set(given)
        steps: dict[str, Fact | System] = {}

        def parts(name: str) -> tuple[str, ...]:
            step = self.resolve(name, chosen, given)
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

    def missing_problem(self, declared: Input, dependent: str | None, *inside: str) -> Problem:
        """Return what is wrong where something depends on an input and nothing gives it."""
        others = "".join(f", or {other!r} instead" for other in self.mutually_exclusive_inputs(declared.name))
        what = f"is missing ({declared.meaning} [{declared.units}])"
        return Problem(what, (*inside, declared.name), f"{dependent} depends on it: add it{others}")

    def _missing(self, name: str, dependent: str | None) -> Exception:
        declared = self.known_inputs(self.variant_inputs).get(name)
        if declared is not None:
            return InputError.of([self.missing_problem(declared, dependent)])
        if dependent is not None:
            return CatalogueError(f"{self.name}: {dependent} depends on {name}, which is not declared")
        return CatalogueError(f"{self.name}: {name} is not declared")


def _plain(tree: Name) -> tuple[str, str]:
    """Return the name of a fact, and the set whose own fact of that name builds on it, if it is one below."""
    return (str(tree.of), tree.variant) if isinstance(tree, Below) else (str(tree), "")


def _below(name: str, variant: str) -> str:
    """Return what the fact of a variant calls what it replaces."""
    return str(Below(Quantity(name), variant))


def _replaced_by(variant: str, fact: Fact) -> Fact:
    """Return a fact under the names that it has where the fact of a variant replaces it."""
    return replace(fact, name=_below(fact.name, variant), low=fact.low and _below(fact.low, variant))

"""The catalogue of a mechanism: its inputs and facts, each declared once, and what follows from them."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from itertools import count
from typing import Any, Self

from fastlink.errors import InputError, Model, Piece, Problem, suggest
from fastlink.facts.bounds import ErrorBounds
from fastlink.facts.derivative import (
    ALLOWED_CHANGE,
    TOLERANCES,
    Derivation,
    NoDependence,
    NoDerivative,
    Term,
    change_fact,
    is_tolerance,
    labelled,
    tolerance_fact,
    tolerance_inputs,
    tolerance_name,
    toleranced,
)
from fastlink.facts.expression import CircularError, postorder, value_of
from fastlink.facts.fact import Fact, GradedRange, Input, Loops, System
from fastlink.facts.formula import CatalogueError, Formula, SheetError
from fastlink.facts.names import (
    Below,
    Change,
    Derivative,
    ErrorBound,
    ListOfExtrema,
    Made,
    Name,
    Quantity,
    Reduced,
    Size,
    Trust,
    as_derivative,
    bounded_of,
    derivative_name,
    form_of,
    innermost,
    parse,
    plain_part,
    reading_of,
    root_of,
    size_name,
)

#: The name of the solver that needs no linear system: closed forms.
ELIMINATED = "eliminated"

_versions = count()


# -- A mechanism with selected variants, some of whose facts are given: its derivatives and error bounds


class Selection:
    """The facts of a mechanism with selected variants, but for facts that are given."""

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
        return tuple(Term(by, f"{by}{ALLOWED_CHANGE}") for by in needed)

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

    def fact(self, tree: Name) -> Fact:
        """Return the fact of a derivative, an error bound, a trust, a change or a magnitude."""
        known = self.catalogue
        match tree:
            case Size(of=of):
                return size_fact(known.public_fact(str(of)))
            case Change(of=of, how=how):
                labels = known.public_fact(str(tree))  # codes have none
                changing = self.change_terms(str(of))
                pairs = [(derivative_name(str(of), term.by), term.tolerance) for term in changing]
                return change_fact(labels, how, pairs)
            case ErrorBound(of=of):
                return self.error_bounds.fact(str(of))
            case Trust(of=of):
                return labelled(self.error_bounds.bounded_fact(str(of)), tree, {})
            case Derivative(of=ErrorBound() | Trust() as of):
                what = f"quantity {str(tree)!r}: {of} is an error bound, which has no derivative"
                raise NoDerivative(what, remedy="leave it out")
        assert isinstance(tree, Derivative)
        return self.derivation(tree.by, tree.moving).fact(str(tree.of))

    @cached_property
    def error_bounds(self) -> ErrorBounds:
        """The error bounds."""
        return ErrorBounds(self)

    def angle_of(self, name: str) -> str | None:
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
    if not variant:
        return fact
    return fact.renamed(lambda name: name_below(name, variant) if name in fact.names else name)


#: The magnitude of a value.
SIZE_OF = Formula("magnitude_of", ("value",), ("return abs(value)",))


def size_fact(fact: Fact) -> Fact:
    """Return the magnitude of a fact, under its labels."""
    return replace(fact, name=size_name(fact.name), formula=SIZE_OF, depends_on=(fact.name,), low=None)


# -- A mechanism: its declarations, and answers from them


class Catalogue:
    """The inputs and facts of one mechanism, each declared once: quantities, tables, linear systems, derivatives."""

    #: A fact that is a number exactly where the loop closes, and further ones by which only such values are made. Empty
    #: where no quantity has a value elsewhere.
    closes: tuple[str, ...] = ()
    #: What designers ask for most, by names that may be requested: the first rows of its list.
    most_asked = ""

    def __init__(
        self,
        name: str,
        title: str,
        branches: Mapping[int, str],
        position: Input,
        positions: tuple[float, float, int] | None = None,
    ) -> None:
        self.name = name
        self.title = title
        self.branches = dict(branches)
        self.position = position
        self.positions = positions
        self.inputs: dict[str, Input] = {}
        self.facts: dict[str, Fact] = {}
        self.tables: dict[str, Fact] = {}
        self.table_low_parts: dict[str, str] = {}
        self.variants: dict[str, dict[str, Fact | System]] = {}
        #: Quantities that a further part of its declaration gives: what they begin with, what is wrong, the remedy.
        self.lacking: tuple[tuple[str, ...], str, str] = ((), "", "")
        self.variant_inputs: dict[str, dict[str, Input]] = {}
        self.graded: GradedRange | None = None
        #: Closed forms, and each variant that has a linear system.
        self.solvers: tuple[str, ...] = (ELIMINATED,)
        self.hiding: set[str] = set()
        #: What else names are called in the field, by which they are found.
        self.keywords: dict[str, tuple[str, ...]] = {}
        #: The equations of its loops, where its sheet has them.
        self.loops: Loops | None = None
        #: What a user has declared of it, see `fastlink.own`.
        self.definition: tuple[Any, ...] = ()
        self._formed: dict[str, list[tuple[str, bool]]] = {}
        self._seen: tuple[list[Any], int] = [], next(_versions)
        self._tolerances: tuple[int, dict[str, Input]] = -1, {}

    @property
    def version(self) -> int:
        """A number that changes when a declaration changes, for the keys of caches.

        All declarations are compared by identity with those of the last call: 8 us for the planar 4R.
        """
        now: list[Any] = [self.position, self.graded, self.positions, *self.branches]
        sets: tuple[Mapping[str, Any], ...] = (self.inputs, self.facts, self.tables)
        sets = (*sets, self.table_low_parts, *self.variants.values(), *self.variant_inputs.values())
        for declared in sets:
            now += declared.values()
        seen, version = self._seen
        if now != seen:
            version = next(_versions)
            self._seen = now, version
        return version

    def declare_input(self, declared: Input, variant: str | None = None) -> None:
        """Declare a number that the user gives.

        An input with a `variant` belongs to that variant alone. Which inputs select a variant is defined by
        `Catalogue.variants_selected_by`. The codes of `choices` become a dimension of the result unless the design
        gives one of them.
        """
        self._check_labels(declared, "units", "symbol", "meaning")
        self._check_name(declared.name, variant)
        if variant is None:
            self.inputs[declared.name] = declared
        else:
            self.variant_inputs.setdefault(variant, {})[declared.name] = declared
            self._check_variant(variant)

    def declare(self, fact: Fact, variant: str | None = None) -> None:
        """Declare a fact, of a variant if one is named."""
        self._check_labels(fact, "units", "symbol", "source", "meaning")
        if fact.low is not None and not fact.internal:
            raise self._fault(f"fact {fact.name} has a low part, and is not internal", "make it a step")
        known: Any = self.variants.setdefault(variant, {}) if variant else self.facts
        for each in fact.names:
            self._check_name(each, variant, public=not fact.internal)
            known[each] = fact
        self._check_variant(variant or fact.name)

    def also_called(self, **keywords: str) -> None:
        """Declare what quantities and inputs are called elsewhere: phrases with commas between, by name."""
        for name, phrases in keywords.items():
            self.keywords[name] = tuple(phrase.strip() for phrase in phrases.split(","))

    def declare_table(self, fact: Fact, low: str | None) -> None:
        """Declare a function of the input position alone.

        It is tabled once per sweep, correctly rounded. `low` is the name of a second table, for the low parts.
        """
        self._check_name(fact.name, None)
        if fact.depends_on != (self.position.name,):
            raise self._fault(
                f"table {fact.name} must depend on {self.position.name} alone", "make it a step"
            )
        self.tables[fact.name] = fact
        if low is not None:
            self._check_name(low, None)
            self.table_low_parts[low] = fact.name

    def declare_system(self, declared: System, variant: str) -> None:
        """Declare a linear system, as part of a variant."""
        self.solvers = tuple(dict.fromkeys((*self.solvers, variant)))
        for unknown in declared.unknowns:
            self._check_name(unknown, variant)
            self.variants.setdefault(variant, {})[unknown] = declared
        self._check_variant(variant)

    def declare_derivative(self, name: str, formula: Formula, variant: str | None = None) -> None:
        """Declare the derivative of a fact or table by an input or the position, by its name.

        Others are generated, see `fastlink.facts.derivative`: declare one where a closed form is better. It holds
        for the fact of that `variant`, not for a fact that replaces it.
        """
        tree = self.parse(name)
        of = str(tree.of) if isinstance(tree, Derivative) else ""
        fact = self.facts.get(of) or self.tables.get(of) or self.variants.get(variant or "", {}).get(of)
        if not isinstance(fact, Fact) or not isinstance(tree, Derivative):
            remedy = "write NAME [units] symbol: meaning, as of a fact"
            raise self._fault(f"{name} is no derivative of a fact by an input", remedy)
        labels = labelled(fact, tree, self.variables)
        declared = replace(labels, formula=formula, depends_on=formula.parameters, internal=True)
        self._check_new(declared.name, variant)
        facts = self.facts if variant is None else self.variants.setdefault(variant, {})
        facts[declared.name] = declared

    def depends_on_solver(self, steps: Iterable[Fact | System]) -> bool:
        """Tell whether steps include a value of a linear system, or a derivative of one."""
        solved = {name for solver in self.solvers if solver != ELIMINATED for name in self.variants[solver]}
        solved |= {derivative_name(name, by) for name in solved for by in self.variables}
        return any(not solved.isdisjoint(step.names) for step in steps)

    @property
    def variables(self) -> dict[str, Input]:
        """The variables of derivatives: every input and the position."""
        sets = self.variant_inputs.values()
        known = {name: given for inputs in (self.inputs, *sets) for name, given in inputs.items()}
        return {**known, self.position.name: self.position}

    def parse(self, name: str) -> Name:
        """Return the tree of a name, see `fastlink.facts.names`."""
        return parse(name, self)

    def is_derivative(self, name: str) -> bool:
        """Tell whether a name is the name of a derivative."""
        return isinstance(self.parse(name), Derivative)

    def declares(self, name: str) -> bool:
        """Tell whether a name is declared: as a fact, an input, a table or the position."""
        sets: tuple[Mapping[str, Any], ...] = (*self.variants.values(), *self.variant_inputs.values())
        return self._is_own(name) or any(name in names for names in sets)

    def _is_own(self, name: str) -> bool:
        """Tell whether a name is declared for the mechanism itself, not for a variant."""
        own = (self.facts, self.inputs, self.tables, self.table_low_parts, (self.position.name, "branch"))
        return any(name in names for names in own)

    def is_public(self, name: str) -> bool:
        """Tell whether a declared name is the name of a public quantity."""
        return name in self.facts and not self.facts[name].internal

    def _check_labels(self, declared: Fact | Input, *labels: str) -> None:
        for label in labels:
            if not getattr(declared, label):
                kind = "input" if isinstance(declared, Input) else "fact"
                raise self._fault(f"{kind} {declared.name} has no {label}", "write it")

    def _check_new(self, name: str, variant: str | None) -> None:
        of_variant = (*self.variants.get(variant or "", {}), *self.variant_inputs.get(variant or "", {}))
        if self._is_own(name) if variant is None else name in of_variant:
            raise self._fault(f"{name} is declared twice", "call one otherwise")

    def _check_name(self, name: str, variant: str | None, public: bool = False) -> None:
        """Refuse a name that is declared, or that is part of another, or made of one."""
        self._check_new(name, variant)
        self.check_reading(name)
        for other, of_cycle in self._formed.get(name, ()):
            if other not in self.hiding and (public or not of_cycle):
                raise self._fault(f"with {name}, {other} reads as made of it", "call one otherwise")
        form = form_of(name, self)
        if form is not None:
            of_cycle = isinstance(bounded_of(form), (Reduced, ListOfExtrema))
            self._formed.setdefault(root_of(form), []).append((name, of_cycle))

    def _check_variant(self, name: str) -> None:
        """Refuse a fact with the name of a variant, but for one that an input of that name replaces."""
        named = name in self.variants or name in self.variant_inputs
        if named and name in self.facts and name not in self.variant_inputs.get(name, {}):
            raise self._fault(f"{name} is the name of a fact and of a variant", "call one otherwise")

    def check_reading(self, name: str) -> None:
        """Refuse a name that reads as made of another one."""
        if name not in self.hiding and (tree := reading_of(name, self)):
            raise self._fault(f"{name} reads as {tree!r}", "call it otherwise")

    # -- inputs: own ones, those of variants, tolerances; which variants they select, which exclude others

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

    # -- quantities, dependencies, derivatives, error bounds

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
        if isinstance(tree, (Derivative, ErrorBound, Trust, Change, Size)):
            return self.selection(selected, given).fact(tree)
        if TOLERANCES in selected and (fact := tolerance_fact(name, self.selection(selected, given).given)):
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

    def selection(self, variants: Iterable[str], given: Iterable[str]) -> Selection:
        """Return the mechanism with these variants and given facts."""
        selected = tuple(variants)
        facts = {*self.facts, *(name for variant in selected for name in self.variants.get(variant, {}))}
        key = selected, frozenset(name for name in given if name in facts or is_tolerance(name))
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

    def winding_of(self, name: str) -> Mapping[str, float]:
        """Return by how many turns what a name stands for changes where each angle goes through one, see `winding`."""
        if name == self.position.name:
            return {name: 1.0}
        if self.graded is None:
            return {}
        if name in self.graded.wraps_at:
            return {name: 1.0}
        if name in self.graded.not_differentiable:
            fact = self.facts[name]
            return {name: 1.0 if fact.units == "rad" and not fact.own else math.nan}
        return self.graded.windings.get(name, {})

    def varies(self, name: str) -> bool:
        """Tell whether a fact changes over the cycle."""
        # derivatives and error bounds vary where their quantity does; constant tables have none
        return plain_part(self.parse(name)) in self._varying

    def check(self) -> None:
        """Raise SheetError if a formula is none, a name is not declared, or a fact depends on itself."""
        sets: tuple[Mapping[str, Fact | System], ...] = (self.facts, self.tables, *self.variants.values())
        for steps in sets:
            for step in steps.values():
                value_of(step.formula)
                if isinstance(step, System):
                    self._check_size(step)
        for variant, steps in self.variants.items():
            for name in set(steps) - set(self.facts) - set(self.inputs):
                step = steps[name]
                if isinstance(step, System) or not step.internal:
                    what = f"{variant} gives {name}, which is not a quantity or input"
                    raise self._fault(what, "declare it in [facts] or [inputs], or make it a step", step)
        derivatives = {name for name in self.facts if self.is_derivative(name)}
        for name in set(self.facts) - derivatives:
            self.check_reading(name)
        parts = {part for name in derivatives for part in self.facts[name].depends_on}
        names = {*self.facts, *parts} - derivatives
        leaves = {"branch", self.position.name, *self.tables, *self.table_low_parts}
        if self.graded is not None:
            leaves |= set(self.graded.given)
        for option in ((), *((name,) for name in {*self.variants, *self.variant_inputs})):
            replaced = {name for key in option for name in self.variants.get(key, {})}
            known = (leaves | set(self.known_inputs(option))) - replaced
            for _ in self.dependencies(sorted(names), known, option):
                pass

    def _check_size(self, system: System) -> None:
        """Refuse a system that has not a row for each unknown, with the right-hand side last."""
        rows = getattr(system.formula.result, "elts", ())
        sizes, n = [len(getattr(row, "elts", ())) for row in rows], len(system.unknowns)
        if sizes != [n + 1] * n:
            what = f"system {system.name} of {n} unknowns has rows of {', '.join(map(str, sizes))} numbers"
            raise self._fault(what, f"write {n} rows of {n + 1}, the right-hand side last", system)

    def is_quantity(self, name: str) -> bool:
        """Tell whether a name is a public fact, or a derivative or error bound of one."""
        tree = self.parse(name)
        return self.is_public(plain_part(tree)) and not (isinstance(tree, Derivative) and tree.moving)

    def has_reductions(self, name: str) -> bool:
        """Tell whether a name is a quantity that changes over the cycle."""
        return self.is_quantity(name) and self.varies(name)

    def public_fact(self, name: str) -> Fact:
        """Return the labels of a public quantity."""
        if not self.is_quantity(name):
            raise self.unknown_error(name)
        tree = self.parse(name)
        if not isinstance(tree, Made):
            return self.facts[name]
        of = self.public_fact(str(tree.of))
        if isinstance(tree, Size):
            return size_fact(of)
        lacks = {Change: "change", Derivative: "derivative"}.get(type(tree), "error")
        if isinstance(tree, Change) and isinstance(tree.of, Change):
            raise InputError(f"quantity {name!r}: {of.name} is a change itself", remedy=f"ask for {of.name}")
        if of.flags or isinstance(tree.of, (ErrorBound, Trust)):
            kind = "a code" if of.flags else "an error bound"
            what = f"quantity {name!r}: {of.name} is {kind}, which has no {lacks}"
            raise InputError(what, remedy="leave it out")
        return labelled(of, tree, self.variables)

    def is_of_position(self, name: str) -> bool:
        """Tell whether a name is the input position, or a form of it such as its maximum."""
        return innermost(name, self) == self.position.name

    def absence(self, name: str) -> InputError | None:
        """Return the error that says why a name is not a quantity here, if more is known than that."""
        words, what, remedy = self.lacking
        if (as_derivative(name) or (name,))[0].startswith(words):
            return InputError(f"quantity {name!r}: {what}", remedy=remedy)
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
                of = next(dependents, None)
                raise self._missing(name, of, steps.get(of or ""))
            steps[name] = step
            return step.depends_on

        try:
            for name in postorder(names, parts, done):
                done.update(steps[name].names)
                yield steps[name]
        except CircularError as error:
            what = f"circular: {' -> '.join(error.args)}"
            raise self._fault(what, "let one of them depend on inputs", steps[error.args[0]]) from None

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

    def _missing(self, name: str, dependent: str | None, step: Fact | System | None) -> Exception:
        declared = self.known_inputs(self.variant_inputs).get(name)
        if declared is not None:
            return InputError.of([self.missing_problem(declared, dependent)])
        what = f"{dependent} depends on {name}, which" if dependent else name
        return self._fault(f"{what} is not declared", "declare it, or mend the name", step)

    def _fault(self, what: str, remedy: str, step: Fact | System | None = None) -> SheetError:
        """Return the error of a declaration, of a step by the line of its sheet if it has one."""
        place = step.formula.place if step else ""
        return SheetError(place or self.name, what, remedy)

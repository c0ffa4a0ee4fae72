"""Declare physical facts once: inputs, quantities, tables, linear systems, derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import count
from typing import Any, TypeVar

from fastlink.catalogue.rows import Rows
from fastlink.facts.fact import CatalogueError, Fact, GradedRange, Input, Rule, System, first_line, needs_of
from fastlink.facts.names import (
    Derivative,
    ListOfExtrema,
    Name,
    Reduced,
    bounded_of,
    derivative_name,
    form_of,
    parse,
    reading_of,
    root_of,
)
from fastlink.symbolic.derivative import with_derivative_labels

__all__ = ["ELIMINATED", "Declarations"]

#: The name of the solver that needs no linear system: closed forms.
ELIMINATED = "eliminated"

F = TypeVar("F", bound=Callable[..., Any])
_versions = count()


class Declarations:
    """The declarations of one mechanism, for `fastlink.catalogue.catalogue.Catalogue`."""

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
        self.variant_inputs: dict[str, dict[str, Input]] = {}
        self.graded: GradedRange | None = None
        #: Closed forms, and each variant that has a linear system.
        self.solvers: tuple[str, ...] = (ELIMINATED,)
        self.hiding: set[str] = set()
        #: What else names are called in the field, by which they are found.
        self.keywords: dict[str, tuple[str, ...]] = {}
        #: What a user has declared of it, see `fastlink.own`.
        self.definition: tuple[Any, ...] = ()
        self._formed: dict[str, list[tuple[str, bool]]] = {}
        self._seen: tuple[list[Any], int] = [], next(_versions)

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

    def input(
        self,
        name: str,
        *,
        units: str,
        symbol: str,
        meaning: str,
        rule: Rule = "any",
        variant: str | None = None,
        default: float | None = None,
        choices: Mapping[int, str] | None = None,
    ) -> None:
        """Declare a number that the user gives.

        An input with a `variant` belongs to that variant alone. Which inputs select a variant is defined by
        `Catalogue.variants_selected_by`. The codes of `choices` become a dimension of the result unless the design
        gives one of them.
        """
        self._check_name(name, variant)
        declared = Input(name, units, symbol, meaning, rule, default, dict(choices or {}))
        if variant is None:
            self.inputs[name] = declared
        else:
            self.variant_inputs.setdefault(variant, {})[name] = declared
            self._check_variant(variant)

    def quantity(
        self,
        *,
        units: str,
        symbol: str,
        source: str,
        internal: bool = False,
        flags: Mapping[int, str] | None = None,
        variant: str | None = None,
        name: str | None = None,
        meaning: str | None = None,
        given: Mapping[str, str] | None = None,
        hides_reduction: bool = False,
        low: str | None = None,
    ) -> Callable[[F], F]:
        """Declare a fact.

        Parameters
        ----------
        units, symbol, source : str
            UDUNITS text, the symbol in the paper, and the source (paper and equation number).
        internal : bool
            An intermediate step, which users cannot request.
        flags : mapping of int to str, optional
            For a quantity that is a code: the CF flag meaning of each value.
        variant : str, optional
            The variant to which the fact belongs: it replaces or adds facts when it is selected.
        name, meaning : str, optional
            Used instead of the function's name and the first line of its docstring where one law is
            declared for several links.
        given : mapping of str to str, optional
            The names that replace the parameters of the law.
        hides_reduction : bool
            Allow a name that reads as a reduction of another quantity, which then cannot be requested.
        low : str, optional
            The name of the low part, for an internal fact whose function returns ``(high, low)``.
        """

        def declare(function: F) -> F:
            fact = self._fact(
                function,
                given,
                name=name or function.__name__,
                meaning=meaning or first_line(function),
                units=units,
                symbol=symbol,
                source=source,
                internal=internal,
                flags=dict(flags or {}),
                low=low,
            )
            if low is not None and not internal:
                raise CatalogueError(f"{self.name}: fact {fact.name} has a low part, and is not internal")
            if hides_reduction:
                self.hiding.add(fact.name)
            known: Any = self.variants.setdefault(variant, {}) if variant else self.facts
            for each in fact.names:
                self._check_name(each, variant, public=not internal)
                known[each] = fact
            self._check_variant(variant or fact.name)
            return function

        return declare

    def also_called(self, **keywords: str) -> None:
        """Declare what quantities and inputs are called elsewhere: phrases with commas between, by name."""
        for name, phrases in keywords.items():
            self.keywords[name] = tuple(phrase.strip() for phrase in phrases.split(","))

    def quantities(self, **labels: Any) -> Rows:
        """Return a function that declares public quantities with common labels."""
        return Rows([self], labels)

    def steps(self, **labels: Any) -> Rows:
        """Return a function that declares internal facts with common labels."""
        return Rows([self], {**labels, "internal": True})

    def table(self, *, symbol: str, source: str, low: str | None = None) -> Callable[[F], F]:
        """Declare a function of the input position alone.

        It is tabled once per sweep, correctly rounded. `low` is the name of a second table, for the low parts.
        """

        def declare(function: F) -> F:
            labels = {"units": "1", "symbol": symbol, "source": source, "internal": True}
            fact = self._fact(function, None, name=function.__name__, meaning=first_line(function), **labels)
            self._check_name(fact.name, None)
            if fact.depends_on != (self.position.name,):
                raise CatalogueError(
                    f"{self.name}: table {fact.name} must depend on {self.position.name} alone"
                )
            self.tables[fact.name] = fact
            if low is not None:
                self._check_name(low, None)
                self.table_low_parts[low] = fact.name
            return function

        return declare

    def system(self, name: str, unknowns: Sequence[str], *, variant: str) -> Callable[[F], F]:
        """Declare a linear system that determines `unknowns`, as part of a variant."""

        def declare(function: F) -> F:
            declared = System(name, tuple(unknowns), function, needs_of(function))
            self.solvers = tuple(dict.fromkeys((*self.solvers, variant)))
            for unknown in unknowns:
                self._check_name(unknown, variant)
                self.variants.setdefault(variant, {})[unknown] = declared
            self._check_variant(variant)
            return function

        return declare

    def derivative(
        self, name: str, by: str, *, given: Mapping[str, str] | None = None, variant: str | None = None
    ) -> Callable[[F], F]:
        """Declare the derivative of a fact or table with respect to a variable.

        Others are generated, see `fastlink.symbolic.derivative`: declare one where a closed form is better. It holds
        for the fact of that `variant`, not for a fact that replaces it.
        """

        def declare(function: F) -> F:
            fact = self.facts.get(name) or self.tables[name]
            declared = replace(
                with_derivative_labels(fact, self.variables[by]),
                function=function,
                depends_on=needs_of(function, given),
                internal=True,
            )
            self._check_new(declared.name, variant)
            facts = self.facts if variant is None else self.variants.setdefault(variant, {})
            facts[declared.name] = declared
            return function

        return declare

    def depends_on_solver(self, steps: Iterable[Fact | System]) -> bool:
        """Tell whether steps include a value of a linear system, or a derivative of one."""
        solved = {name for solver in self.solvers if solver != ELIMINATED for name in self.variants[solver]}
        solved |= {derivative_name(name, by) for name in solved for by in self.variables}
        return any(not solved.isdisjoint(step.names) for step in steps)

    def derivatives(self, by: str, *, variant: str | None = None) -> Callable[..., None]:
        """Return a function that declares derivatives with respect to one variable.

        Its arguments are the law, the name of the fact or table, and the names that replace parameters of the law.
        """

        def declare(law: Callable[..., Any], name: str, /, **given: str) -> None:
            self.derivative(name, by, given=given, variant=variant)(law)

        return declare

    @property
    def variables(self) -> dict[str, Input]:
        """The variables of derivatives: every input and the position."""
        sets = self.variant_inputs.values()
        known = {name: given for inputs in (self.inputs, *sets) for name, given in inputs.items()}
        return {**known, self.position.name: self.position}

    def _fact(self, function: Callable[..., Any], given: Mapping[str, str] | None, **labels: Any) -> Fact:
        for label in ("units", "symbol", "source", "meaning"):
            if not labels[label]:
                raise CatalogueError(f"{self.name}: fact {labels['name']} has no {label}")
        return Fact(function=function, depends_on=needs_of(function, given), **labels)

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

    def _check_new(self, name: str, variant: str | None) -> None:
        of_variant = (*self.variants.get(variant or "", {}), *self.variant_inputs.get(variant or "", {}))
        if self._is_own(name) if variant is None else name in of_variant:
            raise CatalogueError(f"{self.name}: {name} is declared twice")

    def _check_name(self, name: str, variant: str | None, public: bool = False) -> None:
        """Refuse a name that is declared, or that is part of another, or made of one."""
        self._check_new(name, variant)
        self.check_reading(name)
        for other, of_cycle in self._formed.get(name, ()):
            if other not in self.hiding and (public or not of_cycle):
                raise CatalogueError(
                    f"{self.name}: with {name}, {other} reads as made of it; call one otherwise"
                )
        form = form_of(name, self)
        if form is not None:
            of_cycle = isinstance(bounded_of(form), (Reduced, ListOfExtrema))
            self._formed.setdefault(root_of(form), []).append((name, of_cycle))

    def _check_variant(self, name: str) -> None:
        """Refuse a fact with the name of a variant, but for one that an input of that name replaces."""
        named = name in self.variants or name in self.variant_inputs
        if named and name in self.facts and name not in self.variant_inputs.get(name, {}):
            raise CatalogueError(
                f"{self.name}: {name} is the name of a fact and of a variant; call one otherwise"
            )

    def check_reading(self, name: str) -> None:
        """Raise CatalogueError if a name reads as made of another one."""
        if name not in self.hiding and (tree := reading_of(name, self)):
            raise CatalogueError(f"{self.name}: {name} reads as {tree!r}; call it otherwise")

"""Declare physical facts once: inputs, quantities, tables, linear systems, derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import count
from typing import Any, TypeVar

from fastlink.catalogue.rows import DerivativeRows, Rows
from fastlink.facts.fact import CatalogueError, Fact, GradedRange, Input, Rule, System, parameters
from fastlink.facts.names import (
    Derivative,
    ListOfExtrema,
    Name,
    Reduced,
    derivative_name,
    form_of,
    parse,
    reading_of,
    root_of,
)
from fastlink.symbolic.derivative import with_derivative_labels

__all__ = ["ELIMINATED", "Declarations"]

#: The solver that solves no linear system: closed forms.
ELIMINATED = "eliminated"

F = TypeVar("F", bound=Callable[..., Any])
_versions = count()


class Declarations:
    """What is declared of one mechanism; `fastlink.catalogue.catalogue.Catalogue` reads it."""

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
        #: Closed forms, and each set of facts that has a linear system.
        self.solvers: tuple[str, ...] = (ELIMINATED,)
        self.hiding: set[str] = set()
        self._formed: dict[str, list[tuple[str, bool]]] = {}
        self._seen: tuple[list[Any], int] = [], next(_versions)

    @property
    def version(self) -> int:
        """A number that is another one whenever anything declared is another one, for what is found once.

        All that is declared is compared with what it was, by identity: 8 us for the planar 4R.
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
        """Declare a number that the user gives; `variant` restricts it to a named set of facts.

        Giving an input of a set that has one with a default, or that the set is named after, chooses the set: see
        `variants_selected_by`. The codes of `choices` become a dimension of the result unless the design names one.
        """
        self._check_new(name, variant)
        self._check_reading(name, public=False)
        declared = Input(name, units, symbol, meaning, rule, default, dict(choices or {}))
        if variant is None:
            self.inputs[name] = declared
        else:
            self.variant_inputs.setdefault(variant, {})[name] = declared

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
            UDUNITS text, the paper's symbol, and where it stands (paper and equation number).
        internal : bool
            A step on the way: not offered to users by name.
        flags : mapping of int to str, optional
            For a quantity that is a code: the CF flag meanings of its values.
        variant : str, optional
            The name of the set of facts it belongs to, which replaces or adds facts when asked for.
        name, meaning : str, optional
            Instead of the function's name and the first line of its docstring: where one law holds for
            several links, it is written once and declared for each.
        given : mapping of str to str, optional
            With them: what stands for the law's parameters.
        hides_reduction : bool
            Its name may read as what is taken of another quantity over the cycle, which then has no name.
        low : str, optional
            The name of what rounding to double lost, of an internal fact whose function returns ``(high, low)``.
        """

        def declare(function: F) -> F:
            labels = (units, symbol, source, internal, flags)
            fact = self._fact(function, *labels, name, meaning, given or {}, low)
            if low is not None and not internal:
                raise CatalogueError(f"{self.name}: fact {fact.name} has a low part, and is not internal")
            if hides_reduction:
                self.hiding.add(fact.name)
            known: Any = self.variants.setdefault(variant, {}) if variant else self.facts
            for each in fact.names:
                self._check_new(each, variant)
                self._check_reading(each, public=not fact.internal)
                known[each] = fact
            return function

        return declare

    def quantities(
        self,
        *,
        units: str,
        source: str,
        variant: str | None = None,
        flags: Mapping[int, str] | None = None,
    ) -> Rows:
        """Return what declares quantities that users ask for, row by row."""
        return Rows([self], units, source, internal=False, variant=variant, flags=flags)

    def steps(self, *, units: str, source: str, variant: str | None = None) -> Rows:
        """Return what declares steps on the way, row by row."""
        return Rows([self], units, source, internal=True, variant=variant)

    def table(self, *, symbol: str, source: str, low: str | None = None) -> Callable[[F], F]:
        """Declare a function of the input position alone, tabled once per sweep from 40 digits.

        `low` names a second table: what rounding to double lost.
        """

        def declare(function: F) -> F:
            fact = self._fact(function, "1", symbol, source, True, None)
            self._check_new(fact.name, None)
            self._check_reading(fact.name, public=False)
            if fact.depends_on != (self.position.name,):
                raise CatalogueError(
                    f"{self.name}: table {fact.name} must depend on {self.position.name} alone"
                )
            self.tables[fact.name] = fact
            if low is not None:
                self._check_new(low, None)
                self._check_reading(low, public=False)
                self.table_low_parts[low] = fact.name
            return function

        return declare

    def system(self, name: str, unknowns: Sequence[str], *, variant: str) -> Callable[[F], F]:
        """Declare a linear system that determines `unknowns`, as part of a named set of facts."""

        def declare(function: F) -> F:
            declared = System(name, tuple(unknowns), function, parameters(function))
            self.solvers = tuple(dict.fromkeys((*self.solvers, variant)))
            for unknown in unknowns:
                self._check_new(unknown, variant)
                self._check_reading(unknown, public=False)
                self.variants.setdefault(variant, {})[unknown] = declared
            return function

        return declare

    def derivative(
        self, name: str, by: str, *, given: Mapping[str, str] | None = None, variant: str | None = None
    ) -> Callable[[F], F]:
        """Declare the derivative of a fact or table by an input or the position, where a closed form is better.

        All others are generated, see `fastlink.symbolic.derivative`. It holds of the fact of that set
        (`variant`), not of
        what replaces it.
        """

        def declare(function: F) -> F:
            fact = self.facts.get(name) or self.tables[name]
            depends_on = tuple((given or {}).get(parameter, parameter) for parameter in parameters(function))
            found = replace(
                with_derivative_labels(fact, self.variables[by]),
                function=function,
                depends_on=depends_on,
                internal=True,
            )
            self._check_new(found.name, variant)
            within = self.facts if variant is None else self.variants.setdefault(variant, {})
            within[found.name] = found
            return function

        return declare

    def depends_on_solver(self, steps: Iterable[Fact | System]) -> bool:
        """Tell whether a solver determines any of the values of a closure, or has no derivative of one."""
        solved = {name for key in self.solvers if key != ELIMINATED for name in self.variants[key]}
        slopes = {derivative_name(name, by) for name in solved for by in self.variables}
        names = {
            name for step in steps for name in (step.unknowns if isinstance(step, System) else (step.name,))
        }
        return not names.isdisjoint(solved | slopes)

    def derivatives(self, by: str, *, variant: str | None = None) -> DerivativeRows:
        """Return what declares derivatives with respect to an input or the position, row by row."""
        return DerivativeRows(self, by, variant)

    @property
    def variables(self) -> dict[str, Input]:
        """What there are derivatives by: every input that a design may give, and the position."""
        sets = self.variant_inputs.values()
        known = {name: given for inputs in (self.inputs, *sets) for name, given in inputs.items()}
        return {**known, self.position.name: self.position}

    def _fact(
        self,
        function: Callable[..., Any],
        units: str,
        symbol: str,
        source: str,
        internal: bool,
        flags: Mapping[int, str] | None,
        name: str | None = None,
        meaning: str | None = None,
        given: Mapping[str, str] | None = None,
        low: str | None = None,
    ) -> Fact:
        name = name or function.__name__
        meaning = meaning or (function.__doc__ or "").strip().split("\n", 1)[0].rstrip(".")
        for what, value in (("units", units), ("symbol", symbol), ("source", source), ("meaning", meaning)):
            if not value:
                raise CatalogueError(f"{self.name}: fact {name} has no {what}")
        depends_on = tuple((given or {}).get(parameter, parameter) for parameter in parameters(function))
        return Fact(
            name, function, depends_on, units, symbol, meaning, source, internal, dict(flags or {}), low
        )

    def parse(self, name: str) -> Name:
        """Return what a name is made of, see `fastlink.facts.names`."""
        return parse(name, self)

    def is_derivative(self, name: str) -> bool:
        """Tell whether a name is that of a derivative."""
        return isinstance(self.parse(name), Derivative)

    def declares(self, name: str) -> bool:
        """Tell whether a name is declared: that of a fact, an input, a table, the position."""
        sets: tuple[Mapping[str, Any], ...] = (*self.variants.values(), *self.variant_inputs.values())
        return self._is_own(name) or any(name in names for names in sets)

    def _is_own(self, name: str) -> bool:
        """Tell whether a name is declared of the mechanism itself, not of a set of facts."""
        return (
            name in self.facts
            or name in self.inputs
            or name in self.tables
            or name in self.table_low_parts
            or name in (self.position.name, "branch")
        )

    def is_public(self, name: str) -> bool:
        """Tell whether a declared name is that of a quantity that users ask for."""
        return name in self.facts and not self.facts[name].internal

    def _check_new(self, name: str, variant: str | None) -> None:
        if variant is None:
            taken = self._is_own(name)
        else:
            taken = name in self.variants.get(variant, {})
            taken = taken or name in self.variant_inputs.get(variant, {})
        if taken:
            raise CatalogueError(f"{self.name}: {name} is declared twice")

    def _check_reading(self, name: str, public: bool) -> None:
        """Refuse a name that says something else by its form, or lets another one do so; see `fastlink.facts.names`."""
        tree = None if name in self.hiding else reading_of(name, self)
        if tree is not None:
            raise CatalogueError(f"{self.name}: {name} reads as {tree!r}; call it otherwise")
        for other, of_cycle in self._formed.get(name, ()):
            if other not in self.hiding and (public or not of_cycle):
                raise CatalogueError(
                    f"{self.name}: with {name}, {other} reads as made of it; call one otherwise"
                )
        form = form_of(name, self)
        if form is not None:
            of_cycle = isinstance(form, (Reduced, ListOfExtrema))
            self._formed.setdefault(root_of(form), []).append((name, of_cycle))

"""Declare physical facts once; everything else is read off the declaration.

A *fact* (see `fastlink.fact`) is a straight-line function; its parameters are the names of what it
depends on, its name is the name of the quantity, the first line of its docstring is its meaning.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, TypeVar

from fastlink.errors import InputError, suggest
from fastlink.fact import CatalogueError, Fact, GradedRange, Input, Rule, System, parameters

__all__ = ["Catalogue", "CatalogueError", "Fact", "GradedRange", "Input", "System", "parameters"]

F = TypeVar("F", bound=Callable[..., Any])
# NAME__below_SET: what the fact NAME of that set replaces.
BELOW = "__below_"


class Catalogue:
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
    """

    def __init__(self, name: str, title: str, branches: Mapping[int, str], position: Input) -> None:
        self.name = name
        self.title = title
        self.branches = dict(branches)
        self.position = position
        self.inputs: dict[str, Input] = {}
        self.facts: dict[str, Fact] = {}
        self.tables: dict[str, Fact] = {}
        self.table_low_parts: dict[str, str] = {}
        self.alternatives: dict[str, dict[str, Fact | System]] = {}
        self.alternative_inputs: dict[str, dict[str, Input]] = {}
        self.graded: GradedRange | None = None

    # -- declaring -------------------------------------------------------------------------------

    def input(
        self,
        name: str,
        *,
        units: str,
        symbol: str,
        meaning: str,
        rule: Rule = "any",
        alternative: str | None = None,
        default: float | None = None,
    ) -> None:
        """Declare a number that the user gives; `alternative` restricts it to a named set of facts.

        Giving an input of a set that has one with a default chooses the set: see `chosen_by`.
        """
        self._check_new(name, alternative)
        declared = Input(name, units, symbol, meaning, rule, default)
        if alternative is None:
            self.inputs[name] = declared
        else:
            self.alternative_inputs.setdefault(alternative, {})[name] = declared

    def quantity(
        self,
        *,
        units: str,
        symbol: str,
        source: str,
        internal: bool = False,
        flags: Mapping[int, str] | None = None,
        alternative: str | None = None,
        name: str | None = None,
        meaning: str | None = None,
        given: Mapping[str, str] | None = None,
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
        alternative : str, optional
            The name of the set of facts it belongs to, which replaces or adds facts when asked for.
        name, meaning : str, optional
            Instead of the function's name and the first line of its docstring: where one law holds for
            several links, it is written once and declared for each.
        given : mapping of str to str, optional
            With them: what stands for the law's parameters.
        """

        def declare(function: F) -> F:
            labels = (units, symbol, source, internal, flags)
            fact = self._fact(function, *labels, name, meaning, given or {})
            self._check_new(fact.name, alternative)
            if alternative is None:
                self.facts[fact.name] = fact
            else:
                self.alternatives.setdefault(alternative, {})[fact.name] = fact
            return function

        return declare

    def table(self, *, symbol: str, source: str, low: str | None = None) -> Callable[[F], F]:
        """Declare a function of the input position alone, tabled once per sweep from 40 digits.

        `low` names a second table: what rounding to double lost.
        """

        def declare(function: F) -> F:
            fact = self._fact(function, "1", symbol, source, True, None)
            self._check_new(fact.name, None)
            if fact.needs != (self.position.name,):
                raise CatalogueError(
                    f"{self.name}: table {fact.name} must depend on {self.position.name} alone"
                )
            self.tables[fact.name] = fact
            if low is not None:
                self._check_new(low, None)
                self.table_low_parts[low] = fact.name
            return function

        return declare

    def system(self, name: str, unknowns: Sequence[str], *, alternative: str) -> Callable[[F], F]:
        """Declare a linear system that determines `unknowns`, as part of a named set of facts."""

        def declare(function: F) -> F:
            declared = System(name, tuple(unknowns), function, parameters(function))
            for unknown in unknowns:
                self._check_new(unknown, alternative)
                self.alternatives.setdefault(alternative, {})[unknown] = declared
            return function

        return declare

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
    ) -> Fact:
        name = name or function.__name__
        meaning = meaning or (function.__doc__ or "").strip().split("\n", 1)[0].rstrip(".")
        for what, value in (("units", units), ("symbol", symbol), ("source", source), ("meaning", meaning)):
            if not value:
                raise CatalogueError(f"{self.name}: fact {name} has no {what}")
        needs = tuple((given or {}).get(parameter, parameter) for parameter in parameters(function))
        return Fact(name, function, needs, units, symbol, meaning, source, internal, dict(flags or {}))

    def _check_new(self, name: str, alternative: str | None) -> None:
        if alternative is None:
            taken = (
                name in self.inputs
                or name in self.facts
                or name in self.tables
                or name in self.table_low_parts
            )
            taken = taken or name in (self.position.name, "branch")
        else:
            taken = name in self.alternatives.get(alternative, {})
            taken = taken or name in self.alternative_inputs.get(alternative, {})
        if taken:
            raise CatalogueError(f"{self.name}: {name} is declared twice")

    # -- reading ---------------------------------------------------------------------------------

    @property
    def public(self) -> dict[str, Fact]:
        """The facts that users ask for by name."""
        return {name: fact for name, fact in self.facts.items() if not fact.internal}

    def known_inputs(self, alternatives: Iterable[str] = ()) -> dict[str, Input]:
        """Return every input that a design may give, with those of the chosen sets of facts."""
        known = dict(self.inputs)
        for alternative in alternatives:
            known.update(self.alternative_inputs.get(alternative, {}))
        return known

    def chosen_by(self, given: Iterable[str]) -> tuple[str, ...]:
        """Return the sets of facts that giving these inputs chooses: those with an input that may be left out."""
        names = set(given)
        return tuple(
            alternative
            for alternative, inputs in self.alternative_inputs.items()
            if names & set(inputs) and any(i.default is not None for i in inputs.values())
        )

    def lookup(self, name: str, alternatives: Iterable[str] = ()) -> Fact | System | None:
        """Return what determines `name`, or None for an input, a table or an unknown name.

        The first of the chosen sets that has it, else the mechanism itself. A fact of a set that needs its own
        name builds on what it replaces (in a later set, or the mechanism), there called NAME__below_SET: loads
        add themselves so, in any combination.
        """
        chosen = tuple(alternatives)
        plain, _, above = name.partition(BELOW)
        start = chosen.index(above) + 1 if above else 0
        for alternative in chosen[start:]:
            found = self.alternatives.get(alternative, {}).get(plain)
            if isinstance(found, Fact):
                below = f"{plain}{BELOW}{alternative}"
                needs = tuple(below if need == plain else need for need in found.needs)
                return found if needs == found.needs and not above else replace(found, name=name, needs=needs)
            if found is not None:
                return found
        fact = self.facts.get(plain)
        return replace(fact, name=name) if fact is not None and above else fact

    @cached_property
    def _axes(self) -> dict[str, frozenset[str]]:
        axes = {name: frozenset({"design"}) for name in self.known_inputs(self.alternative_inputs)}
        axes["branch"] = frozenset({"branch"})
        for name in (self.position.name, *self.tables, *self.table_low_parts):
            axes[name] = frozenset({self.position.name})
        for found in self.closure(self.facts, tuple(axes)):
            if isinstance(found, Fact):
                axes[found.name] = frozenset().union(*(axes[need] for need in found.needs))
        return axes

    def varies(self, name: str) -> bool:
        """Tell whether a fact changes over the input cycle."""
        return self.position.name in self._axes[name]

    def check(self) -> None:
        """Raise CatalogueError unless every name is declared and no fact depends on itself."""
        for chosen, found in self.alternatives.items():
            for name in set(found) - set(self.facts) - set(self.inputs):
                fact = found[name]
                if isinstance(fact, System) or not fact.internal:
                    raise CatalogueError(f"{self.name}: {chosen} gives {name}, which is no quantity or input")
        leaves = {"branch", self.position.name, *self.tables, *self.table_low_parts}
        if self.graded is not None:
            leaves |= set(self.graded.leaves)
        for option in ((), *((name,) for name in {*self.alternatives, *self.alternative_inputs})):
            replaced = {name for key in option for name in self.alternatives.get(key, {})}
            known = leaves | (set(self.known_inputs(option)) - replaced)
            for _ in self.closure([*self.facts], known, option):
                pass

    def require(self, name: str) -> None:
        """Raise InputError unless `name` is a quantity that users may ask for."""
        if name not in self.public:
            raise InputError(self.unknown(name, self.public))

    def unknown(self, name: str, known: Iterable[str]) -> str:
        """Return what to say of a name that is none of the known ones."""
        return f"quantity {name!r} is unknown to {self.name}; {suggest(name, known)}"

    def closure(
        self, names: Iterable[str], leaves: Iterable[str], alternatives: Iterable[str] = ()
    ) -> Iterator[Fact | System]:
        """Yield what must be computed for `names`, each after what it depends on.

        Names in `leaves` are given. A name that is neither given nor declared is an InputError.
        """
        given, chosen = set(leaves), tuple(alternatives)
        done: set[str] = set(given)
        pending: list[str] = []

        def visit(name: str, asked_by: str | None) -> Iterator[Fact | System]:
            if name in done:
                return
            if name in pending:
                raise CatalogueError(f"{self.name}: circular: {' -> '.join([*pending, name])}")
            found = self.lookup(name, chosen)
            if found is None:
                raise self._missing(name, asked_by, given)
            pending.append(name)
            for need in found.needs:
                yield from visit(need, name)
            pending.pop()
            done.update(found.unknowns if isinstance(found, System) else (name,))
            yield found

        for name in names:
            yield from visit(name, None)

    def _missing(self, name: str, asked_by: str | None, given: set[str]) -> InputError:
        declared = self.known_inputs(self.alternative_inputs).get(name)
        if declared is not None:
            about = f"({declared.meaning} [{declared.units}])"
            return InputError(
                f"input {name!r} is missing {about}; {asked_by} depends on it: add it to the design"
            )
        if asked_by is not None:
            raise CatalogueError(f"{self.name}: {asked_by} depends on {name}, which is not declared")
        raise CatalogueError(f"{self.name}: {name} is not declared")

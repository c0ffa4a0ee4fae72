"""Extend a mechanism by quantities and inputs of one's own: `extend`, and what it returns."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from fastlink._text import short_repr
from fastlink.errors import InputError, KeyPath, Problems, Setting, check_choice, door
from fastlink.facts import own as declarations
from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Input, Rule
from fastlink.mechanisms import base_catalogue
from fastlink.space.design_space import in_unit, numbers_of

F = TypeVar("F", bound=Callable[..., Any])
RULES: tuple[Rule, ...] = ("any", "non-negative", "positive")


class Extension:
    """A mechanism with quantities and inputs of one's own, made by `fastlink.extend`.

    Every function that takes the name of a mechanism takes it: `fastlink.sweep`, `fastlink.function`,
    `fastlink.evaluate`, `fastlink.explain`, `fastlink.quantities`, `fastlink.draw`. It can be pickled, and holds texts
    alone: what another process runs is compiled from these. Its attribute `mechanism` is the name of the mechanism.
    """

    def __init__(self, mechanism: str, definition: declarations.Definition = ()) -> None:
        self.mechanism, self._definition = mechanism, definition

    @door
    def quantity(
        self, *, units: str, description: str | None = None, symbol: str | None = None
    ) -> Callable[[F], F]:
        """Declare a function of quantities and inputs as a quantity.

        Examples
        --------
        >>> mine = fl.extend("planar_4r")
        >>> @mine.quantity(units="N", description="Larger of the forces on the crank's bearings")
        ... def bearing_load(F21, F41):
        ...     return max(F21, F41)
        >>> mine
        <planar_4r with bearing_load>
        """
        problems = Problems()
        units = problems.attempt(declarations.check_units, ("quantity", "units"), units)
        texts = _labels(problems, "quantity", description=description, symbol=symbol)
        problems.stop()

        def declare(function: F) -> F:
            self._add(declarations.read_quantity(function, units, *texts))
            return function

        return declare

    @door
    def input(
        self,
        name: str,
        *,
        units: str,
        default: float | None = None,
        rule: Rule = "any",
        description: str | None = None,
        symbol: str | None = None,
    ) -> None:
        """Declare an input, such as a weight of a cost function.

        Examples
        --------
        >>> mine = fl.extend("planar_4r")
        >>> mine.input("F_allowed", units="N", default=500.0, rule="positive")
        """
        problems = Problems()
        with problems.at("input", "name"):
            declarations.check_name(name)
        with problems.at():
            units = declarations.check_units(("input", "units"), units)
        with problems.at():
            check_choice(("input", "rule"), rule, RULES)
            number = _number(default, rule, units)
        texts = _labels(problems, "input", description=description, symbol=symbol)
        problems.stop()
        self._add(Input(name, units, texts[1] or name, texts[0] or name, rule, number))

    @property
    def text(self) -> str:
        """The declarations as Python code that makes them again; maps have it in their attribute ``own_quantities``."""
        return declarations.definition_text(self.mechanism, self._definition)

    def catalogue(self, input: str | None = None) -> Catalogue:
        """Return the catalogue with the declarations, by the named input."""
        first = base_catalogue(self.mechanism)
        own = declarations.extended(first, first.version, self._definition)
        base = base_catalogue(self.mechanism, input)
        return own if base is first else declarations.extended(base, base.version, self._definition, own)

    def copy(self) -> Extension:
        """Return an extension with the same declarations, to which others can be added."""
        return type(self)(self.mechanism, self._definition)

    def _add(self, declared: Input | declarations.OwnQuantity) -> None:
        """Add a declaration; one of its name gives way to it unless both stand in one file, line below line."""
        others = [one for one in self._definition if one.name != declared.name]
        before = next((one for one in self._definition if one.name == declared.name), None)
        both = isinstance(before, declarations.OwnQuantity) and isinstance(declared, declarations.OwnQuantity)
        (file, line), (own_file, own_line) = _place(before), _place(declared)
        if both and file == own_file and line != own_line:
            what = f"is declared in line {line} of {file} already"
            raise InputError(what, (declared.name,), "call one of them otherwise")
        definition = _in_order([*others, declared]) if before else (*self._definition, declared)
        type(self)(self.mechanism, definition).catalogue()
        self._definition = definition

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.mechanism, self._definition)

    def __repr__(self) -> str:
        names = ", ".join(one.name for one in self._definition)
        return f"<{self.mechanism} with {names or 'nothing of its own yet'}>"


def _place(one: Input | declarations.OwnQuantity | None) -> tuple[str, int]:
    return (one.file, one.line) if isinstance(one, declarations.OwnQuantity) else ("", 0)


def _in_order(
    declared: Iterable[Input | declarations.OwnQuantity],
) -> declarations.Definition:
    """Return declarations, each after those on which it depends."""
    left = {one.name: one for one in declared}
    found: dict[str, Input | declarations.OwnQuantity] = {}
    while left:
        needs = {name: set(getattr(one, "parameters", ())) - {name} for name, one in left.items()}
        free = [name for name in left if left.keys().isdisjoint(needs[name])]
        if not free:
            what = f"{', '.join(left)} depend on each other"
            raise InputError(what, (next(iter(left)),), "take parameters that depend on none of them")
        found[free[0]] = left.pop(free[0])
    return tuple(found.values())


def _labels(problems: Problems, door: str, **given: Any) -> list[str]:
    """Return texts of one line, empty where none is given."""
    for key, value in given.items():
        if value is not None and (not isinstance(value, str) or not value.strip() or not value.isprintable()):
            problems.add(f"is {short_repr(value)}", (door, key), "write a text of one line")
    return [value.strip() if isinstance(value, str) else "" for value in given.values()]


def _number(value: Any, rule: Rule, units: str) -> float | None:
    """Return the default of an input."""
    if value is None:
        return None
    where = ("input", "default")
    number = float(in_unit(where, value, numbers_of(*where, value, 0), units))
    if not Input("default", units, "", "", rule).allows(number):
        least = {"any": "", "positive": " greater than 0", "non-negative": " of at least 0"}[rule]
        raise InputError(f"is {short_repr(value)}", where, f"write a finite number{least}")
    return number


@door
def extend(mechanism: str | Extension) -> Extension:
    """Return a mechanism to which quantities and inputs of one's own are added; nothing else changes.

    Parameters
    ----------
    mechanism : str or Extension
        Name of the mechanism, such as ``"planar_4r"``; or another extension, whose declarations are taken over.

    Returns
    -------
    Extension
        Takes declarations, and stands for the mechanism wherever a name does. A declared quantity has all that others
        have: it is compiled, has extremes and means over the cycle, derivatives by every input, error bounds, labels.
        Maps hold the text of what is declared in the attribute ``own_quantities``; see docs/own_quantities.md.

    Examples
    --------
    >>> mine = fl.extend("planar_4r")
    >>> mine.input("weight", units="1", default=0.5)
    >>> @mine.quantity(units="1")
    ... def cost(transmission_angle, omega4, omega1, weight):
    ...     '''Poor transmission, and speed of the output.'''
    ...     return weight * (1.0 - sin(transmission_angle)) + (omega4 / omega1) ** 2
    >>> maps = fl.sweep(mine, {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}, ["cost_max"])
    >>> float(maps.cost_max.round(6))
    1.171108
    """
    if isinstance(mechanism, Extension):
        return mechanism.copy()
    base_catalogue(mechanism)
    return Extension(str(mechanism))


# -- Check the declarations of a user against the text of them that a map has, which nothing runs


class _Mine:
    """The extension that a remedy names: a variable in Python, its file at the command line."""

    def __repr__(self) -> str:
        return "mine"

    def __str__(self) -> str:
        return "mine.py"


def is_own(name: str, text: str) -> bool:
    """Tell whether a name of a map is of quantities or inputs of a user, of which the map has the text.

    Examples
    --------
    >>> is_own("cost_max", "def cost(F21):"), is_own("omega4_max", "def cost(F21):")
    (True, False)
    """
    return any(re.search(rf"(^|_){re.escape(own)}(_|$)", name) for own in declarations.declared_names(text))


def own_refused(where: KeyPath, name: str) -> InputError:
    """Return the error of a result of a map that a user has declared, where the declarations are not given."""
    what = f"{name!r} is of quantities of a user's own, of which a map has the text and runs none"
    return InputError(what, where, ("write ", Setting("mechanism", _Mine()), ", with which the map was made"))


def check_declared(given: Any, mechanism: str, text: str) -> Extension:
    """Return the extension by which a map was made, or refuse another one."""
    if not isinstance(given, Extension):
        remedy = "give what fastlink.extend returned"
        raise InputError(f"is {short_repr(given)}, not an extended mechanism", ("mechanism",), remedy)
    catalogue = given.catalogue()
    names = declarations.declared_names(text)
    if given.mechanism != mechanism or (
        text and declarations.definition_text(mechanism, declarations.used(catalogue, (), names)) != text
    ):
        what = f"is {short_repr(given)}, and the map is of {mechanism} with other declarations"
        raise InputError(what, ("mechanism",), "give the extension by which it was made")
    return given

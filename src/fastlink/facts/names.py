"""The grammar of names: what a name is made of, and how a name that is made of others is spelt.

=============================================  =====================================================================
``NAME``                                       `Quantity`: what is declared (facts, inputs, tables, the position)
``d_NAME_d_PARAM``                             `Derivative` of NAME with respect to an input or the position
``NAME_error``, ``NAME_trust``                 `ErrorBound` of NAME, and `Trust`: whether it is small against NAME
``NAME__below_VARIANT``                        `Below`: what the fact NAME of that variant replaces
``NAME_max``, ``POSITION_at_NAME_max``, ...    `Reduced` over the cycle, and the position where that is
``NAME_extrema``, ``POSITION_at_NAME_extrema``,
``NAME_extrema_count``, ``NAME_extrema_kind``  `ListOfExtrema`: all extremes, where they are, how many, which
=============================================  =====================================================================

NAME is itself such a name; what belongs to the cycle as a whole (the last three rows) is outermost. A name is read by
the first of these rules that holds:

1. ``d_NAME_d_PARAM`` is a derivative where PARAM is an input or the position; the last ``_d_`` is the one that counts.
   No declared name but that of a declared derivative contains ``_d_``.
2. A declared name is what it is declared as: the ``AB_error`` of Hart's mechanism is a quantity.
3. What ends as above is what the ending says, the position told by its prefix first.
4. Any other name is a quantity, known or not.

Declarations refuse a name that rules 1 and 3 read otherwise while what it would be made of is declared too, see
`reading_of`; so each name has one reading, and ``parse(str(tree), known) == tree``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from fastlink.facts.fact import CatalogueError

__all__ = [
    "Below", "Derivative", "ErrorBound", "Known", "ListOfExtrema", "Made", "Name", "Quantity", "Reduced",
    "Trust", "as_derivative", "derivative_name", "error_name", "forget_reduction", "form_of", "innermost", "parse",
    "plain_part", "reading_of", "register_reduction", "root_of",
]  # fmt: skip

#: What may be taken over the cycle, by the ending of its name, and whether it has a place: see `register_reduction`.
_REDUCTIONS: dict[str, bool] = {}
#: The parts of a list of extremes, by the ending of their names.
_PARTS = {"_extrema": "value", "_extrema_count": "count", "_extrema_kind": "kind"}
_ENDINGS = {part: ending for ending, part in _PARTS.items()}
_ERROR, _TRUST = "_error", "_trust"
_BEFORE, _BY, _AT, _BELOW = "d_", "_d_", "_at_", "__below_"
_RESERVED = frozenset({"error", "trust", "low", "extrema", "count", "kind"})


@dataclass(frozen=True)
class Name:
    """What a name says, as a tree; ``str`` spells it."""


@dataclass(frozen=True)
class Quantity(Name):
    """A name that is not made of others."""

    name: str

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True)
class Made(Name):
    """A name that is made of another one, `of`."""

    of: Name


@dataclass(frozen=True)
class Derivative(Made):
    """The derivative of a quantity with respect to the input or the position `by`."""

    by: str

    def __str__(self) -> str:
        return f"{_BEFORE}{self.of}{_BY}{self.by}"


@dataclass(frozen=True)
class ErrorBound(Made):
    """The bound of the error that rounding makes in a quantity."""

    def __str__(self) -> str:
        return f"{self.of}{_ERROR}"


@dataclass(frozen=True)
class Trust(Made):
    """Whether the error bound of a quantity is small against its value."""

    def __str__(self) -> str:
        return f"{self.of}{_TRUST}"


@dataclass(frozen=True)
class Below(Made):
    """What the fact of a variant replaces and builds on."""

    variant: str

    def __str__(self) -> str:
        return f"{self.of}{_BELOW}{self.variant}"


@dataclass(frozen=True)
class Reduced(Made):
    """What is taken of a quantity over the cycle; `place` is the position's name where that is meant, else empty."""

    how: str
    place: str = ""

    def __str__(self) -> str:
        return f"{_at(self.place)}{self.of}_{self.how}"


@dataclass(frozen=True)
class ListOfExtrema(Made):
    """All extremes of a quantity: the `part` "value", "count" or "kind", or with `place` the positions of them."""

    part: str = "value"
    place: str = ""

    def __str__(self) -> str:
        return f"{_at(self.place)}{self.of}{_ENDINGS[self.part]}"


def derivative_name(name: str, by: str) -> str:
    """Return the name of the derivative of `name` with respect to `by`.

    Examples
    --------
    >>> derivative_name("omega4", "a1")
    'd_omega4_d_a1'
    """
    return str(Derivative(Quantity(name), by))


def error_name(name: str) -> str:
    """Return the name of the error bound of `name`."""
    return str(ErrorBound(Quantity(name)))


class Known(Protocol):
    """What the names of a mechanism are read by: its declarations."""

    position: Any

    @property
    def variables(self) -> Mapping[str, Any]:
        """What there are derivatives with respect to."""

    def declares(self, name: str) -> bool:
        """Tell whether a name is declared: that of a fact, an input, a table, the position."""

    def is_public(self, name: str) -> bool:
        """Tell whether a declared name is that of a quantity that users ask for."""


def parse(name: str, known: Known) -> Name:
    """Return what a name is made of, by the rules above.

    Examples
    --------
    >>> from fastlink.mechanisms import catalogue
    >>> planar_4r = catalogue("planar_4r")
    >>> parse("theta1_at_d_omega4_d_a1_max", planar_4r)
    Reduced(of=Derivative(of=Quantity(name='omega4'), by='a1'), how='max', place='theta1')
    >>> str(_)
    'theta1_at_d_omega4_d_a1_max'
    """
    if plain := _declared(name, known):
        return plain
    return _over_cycle(name, known) or _of_position(name, known) or Quantity(name)


def as_derivative(name: str) -> tuple[str, str] | None:
    """Return NAME and PARAM of d_NAME_d_PARAM, whether they are known or not; None of another name."""
    if not name.startswith(_BEFORE):
        return None
    of, sign, by = name[len(_BEFORE) :].rpartition(_BY)
    return (of, by) if sign and of and by else None


def plain_part(tree: Name) -> str:
    """Return the name that derivatives and error bounds are of: it changes with the position where they do."""
    while isinstance(tree, (Derivative, ErrorBound, Trust)):
        tree = tree.of
    return str(tree)


def root_of(tree: Name) -> str:
    """Return the name of the quantity that a name is made of in the end."""
    while isinstance(tree, Made):
        tree = tree.of
    return str(tree)


def innermost(name: str, known: Known) -> str:
    """Return what a name is made of in the end, also where its parts cannot stand in each other: x of x_max_error."""
    root = root_of(parse(name, known))
    return root if root == name else innermost(root, known)


def register_reduction(how: str, has_place: bool) -> None:
    """Let names end in that of a reduction.

    Raises
    ------
    CatalogueError
        The ending is one that means something else, or is none that can be told apart.
    """
    if how in _RESERVED or not how.isidentifier() or "_" in how:
        raise CatalogueError(
            f"a reduction cannot be called {how!r}: names that end so are others, or no names"
        )
    _REDUCTIONS[how] = has_place


def forget_reduction(how: str) -> None:
    """Let names no longer end in that of a reduction."""
    del _REDUCTIONS[how]


def form_of(name: str, known: Known) -> Name | None:
    """Return what a name is made of by its form alone, whether that is declared or not; None of a plain name."""
    made = _derivative(name, known) or _over_cycle(name, known) or _of_position(name, known)
    reserved = _BY in name or _BELOW in name or name.startswith(_at(known.position.name))
    return made or (Quantity(name) if reserved else None)


def reading_of(name: str, known: Known) -> Name | None:
    """Return what a name says by its form, where what it would be made of is declared; else None.

    A name with such a reading is not to be declared: it would be two things. What is taken over the cycle is taken of
    quantities that users ask for; ``_d_``, ``__below_`` and ``POSITION_at_`` are never part of a plain name.
    """
    tree = form_of(name, known)
    if isinstance(tree, (Reduced, ListOfExtrema)) and not tree.place:
        return tree if known.is_public(root_of(tree)) else None
    if isinstance(tree, (ErrorBound, Trust)):
        return tree if known.declares(root_of(tree)) else None
    return tree


def _at(position: str) -> str:
    return f"{position}{_AT}" if position else ""


def _derivative(name: str, known: Known) -> Name | None:
    parts = as_derivative(name)
    return Derivative(_within(parts[0], known), parts[1]) if parts and parts[1] in known.variables else None


def _declared(name: str, known: Known) -> Name | None:
    """Return a name that is read whole: a derivative, or what is declared."""
    if derivative := _derivative(name, known):
        return derivative
    return Quantity(name) if known.declares(name) else None


def _within(name: str, known: Known) -> Name:
    """Return what a name is made of, which is part of another."""
    return _declared(name, known) or _of_position(name, known) or Quantity(name)


def _of_position(name: str, known: Known) -> Name | None:
    """Return a name by its ending, where a value at a position is meant."""
    if name.endswith(_ERROR) and name != _ERROR:
        return ErrorBound(_within(name.removesuffix(_ERROR), known))
    if name.endswith(_TRUST) and name != _TRUST:
        return Trust(_within(name.removesuffix(_TRUST), known))
    of, sign, variant = name.partition(_BELOW)
    return Below(Quantity(of), variant) if sign and of and variant else None


def _over_cycle(name: str, known: Known) -> Name | None:
    """Return a name by its ending, where something of the cycle as a whole is meant."""
    inner = name.removeprefix(_at(known.position.name))
    place = "" if inner == name else known.position.name
    for ending, part in _PARTS.items():
        if inner.endswith(ending) and inner != ending and (part == "value" or not place):
            return ListOfExtrema(_within(inner.removesuffix(ending), known), part, place)
    of, sign, how = inner.rpartition("_")
    if sign and of and how in _REDUCTIONS and (_REDUCTIONS[how] or not place):
        return Reduced(_within(of, known), how, place)
    return None

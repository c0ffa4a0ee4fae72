"""The grammar of names: how names are composed and read.

=============================================  =====================================================================
``NAME``                                       `Quantity`: a declared name (facts, inputs, tables, the position)
``d_NAME_d_PARAM``                             `Derivative` of NAME with respect to an input or the position
``NAME_error``, ``NAME_trust``                 `ErrorBound` of NAME, and `Trust`: whether it is small against NAME
``NAME__below_VARIANT``                        `Below`: the fact that the fact NAME of that variant replaces
``NAME_max``, ``POSITION_at_NAME_max``, ...    `Reduced` over the cycle, and the position where that is
``NAME_extrema``, ``POSITION_at_NAME_extrema``,
``NAME_extrema_count``, ``NAME_extrema_kind``  `ListOfExtrema`: all extremes, where they are, how many, which
``NAME_max_error``, ``NAME_extrema_error``     `ErrorBound` of `Reduced`, and those in a `ListOfExtrema`
``d_NAME_max_d_INPUT``, ...                    `Derivative` of `Reduced`, a value or a position, by an input
``NAME_max_gradient_status``                   `GradientStatus` of `Reduced`: whether these derivatives exist
``NAME_worst_change``, ``NAME_rss_change``     `Change` of NAME or of `Reduced` by the tolerances of the inputs
=============================================  =====================================================================

NAME is itself such a name but in the last seven rows, properties of the cycle. Internally ``d_NAME_d_PARAM__moving`` is
taken at a place that moves with the limits of motion, and ``NAME__size`` is the magnitude of NAME, whose greatest is
``NAME_peak``. A name is read by the first of these rules that holds:

1. ``d_NAME_d_PARAM`` is a derivative where PARAM is an input or the position; the last ``_d_`` counts.
   No declared name but that of a declared derivative contains ``_d_``.
2. A declared name is its declaration: the ``AB_error`` of Hart's mechanism is a quantity.
3. A name with an ending as above is what the ending says, after the prefix of the position.
4. Any other name is a quantity, known or not.

Declarations refuse a name that rules 1 and 3 read otherwise if its innermost name is declared too, see
`reading_of`; so each name has one reading, and ``parse(str(tree), known) == tree``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from fastlink.facts.formula import CatalogueError

if TYPE_CHECKING:
    from fastlink.facts.catalogue import Catalogue


# -- Names as trees: what a name is made of, and how it is spelt. They are read in `fastlink.facts.names`


#: The parts of a list of extremes, by the ending of their names.
PARTS = {
    "_extrema": "value",
    "_extrema_count": "count",
    "_extrema_kind": "kind",
    "_extrema_error": "error",
}
ENDINGS = {part: ending for ending, part in PARTS.items()}
#: How the changes by the tolerances of several inputs are put together, by the ending of names.
CHANGES = {"_worst_change": "worst", "_rss_change": "rss"}
ERROR, TRUST, STATUS, MOVING = "_error", "_trust", "_gradient_status", "__moving"
SIZE = "__size"
BEFORE, BY, AT, BELOW = "d_", "_d_", "_at_", "__below_"


def at(position: str) -> str:
    """Return what stands before the name of an extreme in that of its position."""
    return f"{position}{AT}" if position else ""


@dataclass(frozen=True)
class Name:
    """A name as a tree; ``str`` spells it."""


@dataclass(frozen=True)
class Quantity(Name):
    """A name that is not composed of others."""

    name: str

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True)
class Made(Name):
    """A name composed of another one, `of`, by an ending unless it says otherwise."""

    of: Name
    ending: ClassVar[str]

    def __str__(self) -> str:
        return f"{self.of}{self.ending}"


@dataclass(frozen=True)
class Derivative(Made):
    """The derivative with respect to the input or position `by`; `moving`: at fixed distances from the limits."""

    by: str
    moving: bool = False

    def __str__(self) -> str:
        return f"{BEFORE}{self.of}{BY}{self.by}{MOVING if self.moving else ''}"


class ErrorBound(Made):
    """The bound of the rounding error of a quantity."""

    ending = ERROR


class Trust(Made):
    """Whether the error bound of a quantity is small against its value."""

    ending = TRUST


class Size(Made):
    """The magnitude of a quantity."""

    ending = SIZE


class GradientStatus(Made):
    """The status of the derivatives of a reduction by the inputs: smooth, one-sided, none."""

    ending = STATUS


@dataclass(frozen=True)
class Change(Made):
    """The change of a value by the tolerances of the inputs: all at their worst, or the root sum of squares."""

    how: str

    def __str__(self) -> str:
        return f"{self.of}_{self.how}_change"


@dataclass(frozen=True)
class Below(Made):
    """The fact that the fact of a variant replaces and builds on."""

    variant: str

    def __str__(self) -> str:
        return f"{self.of}{BELOW}{self.variant}"


@dataclass(frozen=True)
class Reduced(Made):
    """A reduction of a quantity over the cycle, or the `position` where it is."""

    how: str
    position: str = ""

    def __str__(self) -> str:
        return f"{at(self.position)}{self.of}_{self.how}"


@dataclass(frozen=True)
class ListOfExtrema(Made):
    """All extremes of a quantity: values, count, kinds, error bounds, or their positions."""

    part: str = "value"
    position: str = ""

    def __str__(self) -> str:
        return f"{at(self.position)}{self.of}{ENDINGS[self.part]}"


def plain_part(tree: Name) -> str:
    """Return the name inside derivatives, bounds, changes and magnitudes, which varies where they do."""
    made = (Derivative, ErrorBound, Trust, Change, Size)
    return plain_part(tree.of) if isinstance(tree, made) else str(tree)


def root_of(tree: Name) -> str:
    """Return the innermost name of a tree."""
    while isinstance(tree, Made):
        tree = tree.of
    return str(tree)


def bounded_of(tree: Name) -> Name:
    """Return the property of the cycle of which a name is the error bound, status or change; others as they are."""
    if isinstance(tree, (ErrorBound, GradientStatus, Change)) and isinstance(
        tree.of, (Reduced, ListOfExtrema)
    ):
        return tree.of
    return tree


#: The reductions over the cycle by the ending of names, and whether each has a position: see `register_reduction`.
_REDUCTIONS: dict[str, bool] = {}
_RESERVED = frozenset({"error", "trust", "low", "extrema", "count", "kind", "status", "change"})


def derivative_name(name: str, by: str, moving: bool = False) -> str:
    """Return the name of the derivative of `name` with respect to `by`."""
    return str(Derivative(Quantity(name), by, moving))


def error_name(name: str) -> str:
    """Return the name of the error bound of `name`."""
    return f"{name}{ERROR}"


def size_name(name: str) -> str:
    """Return the name of the magnitude of `name`."""
    return f"{name}{SIZE}"


def signed(name: str) -> str:
    """Return the name of the quantity of which a name may be the magnitude."""
    return name.removesuffix(SIZE)


def parse(name: str, known: Catalogue) -> Name:
    """Return the tree of a name, by the rules above.

    Examples
    --------
    >>> from fastlink.mechanisms import catalogue
    >>> planar_4r = catalogue("planar_4r")
    >>> parse("theta1_at_d_omega4_d_a1_max", planar_4r)
    Reduced(of=Derivative(of=Quantity(name='omega4'), by='a1', moving=False), how='max', position='theta1')
    >>> str(_)
    'theta1_at_d_omega4_d_a1_max'
    """
    if plain := _declared(name, known):
        return plain
    return _of_cycle(name, known) or _of_position(name, known) or Quantity(name)


def as_derivative(name: str) -> tuple[str, str] | None:
    """Return NAME and PARAM of d_NAME_d_PARAM, known or not; None for another name."""
    if not name.startswith(BEFORE):
        return None
    of, sign, by = name[len(BEFORE) :].rpartition(BY)
    return (of, by) if sign and of and by else None


def ending(name: str) -> tuple[str, str]:
    """Return a name without its last part, and that part: omega4 and maxx of omega4_maxx."""
    of, _, last = name.rpartition("_")
    return of, last


def innermost(name: str, known: Catalogue) -> str:
    """Return the innermost name, also in forms that are not offered: x in x_max_trust."""
    root = root_of(parse(name, known))
    return root if root == name else innermost(root, known)


def register_reduction(how: str, has_position: bool) -> None:
    """Let names end in the name of a reduction."""
    if how in _RESERVED or not how.isidentifier() or "_" in how:
        raise CatalogueError(
            f"a reduction cannot be called {how!r}: names that end so are others, or no names"
        )
    _REDUCTIONS[how] = has_position


def forget_reduction(how: str) -> None:
    """Let names no longer end in the name of a reduction."""
    del _REDUCTIONS[how]


def form_of(name: str, known: Catalogue) -> Name | None:
    """Return the tree of a name by its form alone; None for a plain name."""
    tree = _derivative(name, known) or _of_cycle(name, known) or _of_position(name, known)
    reserved = BY in name or BELOW in name or name.startswith(at(known.position.name))
    return tree or (Quantity(name) if reserved else None)


def reading_of(name: str, known: Catalogue) -> Name | None:
    """Return the tree of a name by its form if the innermost name is declared.

    A name with such a reading cannot be declared: it would have two meanings. Reductions are of public quantities;
    ``_d_``, ``__below_`` and ``POSITION_at_`` are never part of a plain name.
    """
    tree = form_of(name, known)
    of = bounded_of(tree) if tree else None
    if isinstance(of, (Reduced, ListOfExtrema)) and not of.position:
        return tree if known.is_public(root_of(of)) else None
    if isinstance(tree, (ErrorBound, Trust, Change)):
        return tree if known.declares(root_of(tree)) else None
    return tree


def _derivative(name: str, known: Catalogue) -> Name | None:
    parts = as_derivative(plain := name.removesuffix(MOVING))
    if not parts or parts[1] not in known.variables:
        return None
    # each part is read once: names may be long
    over = _over_cycle(parts[0], known) or _change_of_cycle(parts[0], known)
    of = _declared(parts[0], known) or over or _of_position(parts[0], known)
    return Derivative(of or Quantity(parts[0]), parts[1], plain != name)


def _declared(name: str, known: Catalogue) -> Name | None:
    """Return the tree of a derivative or of a declared name, else None."""
    if derivative := _derivative(name, known):
        return derivative
    return Quantity(name) if known.declares(name) else None


def _within(name: str, known: Catalogue) -> Name:
    """Return the tree of a name that is part of another."""
    return _declared(name, known) or _of_position(name, known) or Quantity(name)


def _of_position(name: str, known: Catalogue) -> Name | None:
    """Return the tree of a name whose ending means a value at a position, else None."""
    for made in (ErrorBound, Trust, Size):
        if name.endswith(made.ending) and name != made.ending:
            return made(_within(name.removesuffix(made.ending), known))
    for ending, how in CHANGES.items():
        if name.endswith(ending) and name != ending:
            return Change(_within(name.removesuffix(ending), known), how)
    of, sign, variant = name.partition(BELOW)
    return Below(Quantity(of), variant) if sign and of and variant else None


def _of_cycle(name: str, known: Catalogue) -> Name | None:
    """Return the tree of a name whose ending means a property of the cycle, or the error bound of one, else None."""
    if tree := _over_cycle(name, known):
        return tree
    for made in (ErrorBound, GradientStatus):
        of = _inner_over_cycle(name, made.ending, known)
        if of and (made is ErrorBound or (isinstance(of, Reduced) and not of.position)):
            return made(of)
    bounded = _change_of_cycle(name.removesuffix(ERROR), known)
    return ErrorBound(bounded) if bounded and name.endswith(ERROR) else bounded


def _change_of_cycle(name: str, known: Catalogue) -> Change | None:
    """Return the tree of a name whose ending means the change of a property of the cycle, else None."""
    for ending, how in CHANGES.items():
        if of := _inner_over_cycle(name, ending, known):
            return Change(of, how)
    return None


def _inner_over_cycle(name: str, ending: str, known: Catalogue) -> Name | None:
    """Return the tree of a name before an ending, if it means a property of the cycle and is not declared itself."""
    inner = name.removesuffix(ending)
    return _over_cycle(inner, known) if inner != name and not known.declares(inner) else None


def _over_cycle(name: str, known: Catalogue) -> Name | None:
    """Return the tree of a name whose ending means a property of the cycle, else None."""
    inner = name.removeprefix(at(known.position.name))
    position = "" if inner == name else known.position.name
    for ending, part in PARTS.items():
        if inner.endswith(ending) and inner != ending and (part == "value" or not position):
            return ListOfExtrema(_within(inner.removesuffix(ending), known), part, position)
    of, sign, how = inner.rpartition("_")
    if sign and of and how in _REDUCTIONS and (_REDUCTIONS[how] or not position):
        return Reduced(_within(of, known), how, position)
    return None

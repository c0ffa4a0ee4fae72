"""Names as trees: what a name is made of, and how it is spelt. They are read in `fastlink.facts.names`."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "Below", "Change", "Derivative", "ErrorBound", "GradientStatus", "ListOfExtrema", "Made", "Name", "Quantity",
    "Reduced", "Trust", "bounded_of", "plain_part", "root_of",
]  # fmt: skip

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
    """A name composed of another one, `of`."""

    of: Name


@dataclass(frozen=True)
class Derivative(Made):
    """The derivative with respect to the input or position `by`; `moving`: at fixed distances from the limits."""

    by: str
    moving: bool = False

    def __str__(self) -> str:
        return f"{BEFORE}{self.of}{BY}{self.by}{MOVING if self.moving else ''}"


@dataclass(frozen=True)
class ErrorBound(Made):
    """The bound of the rounding error of a quantity."""

    def __str__(self) -> str:
        return f"{self.of}{ERROR}"


@dataclass(frozen=True)
class Trust(Made):
    """Whether the error bound of a quantity is small against its value."""

    def __str__(self) -> str:
        return f"{self.of}{TRUST}"


@dataclass(frozen=True)
class GradientStatus(Made):
    """The status of the derivatives of a reduction by the inputs: smooth, one-sided, none."""

    def __str__(self) -> str:
        return f"{self.of}{STATUS}"


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
    """Return the name inside derivatives, bounds and changes, which varies where they do."""
    return plain_part(tree.of) if isinstance(tree, (Derivative, ErrorBound, Trust, Change)) else str(tree)


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

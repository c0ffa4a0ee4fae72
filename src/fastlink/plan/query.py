"""The names that are asked for: quantities, their reductions over the input cycle, lists of their extremes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from fastlink.facts.names import ListOfExtrema, Quantity, Reduced
from fastlink.plan.reductions import REDUCTIONS, Reduction

if TYPE_CHECKING:
    from collections.abc import Iterable

    from fastlink.catalogue.catalogue import Catalogue, Fact

__all__ = ["Extrema", "Request", "parse_request"]

#: Whether extremes are exact over the cycle, or taken over the given positions.
Extrema = Literal["refined", "sampled"]


@dataclass(frozen=True)
class Request:
    """A requested name: a quantity, a reduction of it over the cycle, or a list of its extremes."""

    name: str
    quantity: str
    reduction: Reduction | None = None
    place: bool = False
    listed: str = ""

    @property
    def is_of_quantity(self) -> bool:
        """Whether a value has the meaning and the values of its quantity: no mean of a code is one, no place."""
        return not self.place and (self.reduction is None or self.reduction.sign != 0)

    @property
    def can_be_refined(self) -> bool:
        """Whether it is one number of the extremes, which samples only come near."""
        return self.reduction is not None and self.reduction.has_place


def parse_request(name: str, catalogue: Catalogue) -> Request:
    """Read a requested name such as ``omega4``, ``omega4_max`` or ``theta1_at_omega4_max``.

    Raises
    ------
    InputError
        Neither the name nor the quantity in it is known.
    """
    if catalogue.is_quantity(name):
        return Request(name, name)
    tree = catalogue.parse(name)
    if isinstance(tree, (Reduced, ListOfExtrema)) and catalogue.has_reductions(quantity := str(tree.of)):
        if isinstance(tree, Reduced):
            return Request(name, quantity, REDUCTIONS[tree.how], bool(tree.place))
        return Request(name, quantity, listed="place" if tree.place else tree.part)
    known = [*catalogue.public, *reduced_names(catalogue)]
    raise catalogue.unknown_error(name, known)


def _cyclic(catalogue: Catalogue) -> dict[str, Fact]:
    """Return the public quantities that change over the cycle: all but the codes of a design."""
    return {name: fact for name, fact in catalogue.public.items() if catalogue.varies(name)}


def reduced_names(catalogue: Catalogue) -> Iterable[str]:
    """Yield every name that can be asked of a mechanism's cycle."""
    for quantity in _cyclic(catalogue):
        for reduction in REDUCTIONS.values():
            yield str(Reduced(Quantity(quantity), reduction.suffix))
            if reduction.has_place:
                yield str(Reduced(Quantity(quantity), reduction.suffix, catalogue.position.name))
        yield from list_names(catalogue, quantity)


def list_names(catalogue: Catalogue, quantity: str) -> tuple[str, ...]:
    """Return the names that belong together: a list of extremes, their places, their number, their kinds."""
    of = Quantity(quantity)
    lists = (
        ListOfExtrema(of, place=catalogue.position.name),
        *(ListOfExtrema(of, part) for part in ("count", "kind")),
    )
    return tuple(map(str, (ListOfExtrema(of), *lists)))


def with_lists(catalogue: Catalogue, names: Iterable[str]) -> list[str]:
    """Return the names with, after each list of extremes, what belongs to it and was not asked for already."""
    asked = list(names)
    result: list[str] = []
    for name in asked:
        request = parse_request(name, catalogue)
        belong = list_names(catalogue, request.quantity) if request.listed == "value" else (name,)
        result += [other for other in belong if other == name or other not in (*asked, *result)]
    return result

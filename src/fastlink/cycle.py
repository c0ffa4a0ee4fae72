"""What is taken over the input cycle: extremes, where they are, means, fluctuations.

A reduction is a few lines of kernel text over accumulators that stand in the lanes, because a cycle
maximum kept in a scalar stops vectorisation. Configurations that do not assemble are NaN and never
enter: each comparison with NaN is false. A cycle without any value gives NaN.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from fastlink.errors import InputError
from fastlink.names import ListOfExtrema, Quantity, Reduced, register_reduction

if TYPE_CHECKING:
    from collections.abc import Iterable

    from fastlink.catalogue import Catalogue, Fact

__all__ = ["REDUCTIONS", "Reduction", "Request", "parse_request"]


@dataclass(frozen=True)
class Reduction:
    """One way to take a number from a quantity's cycle.

    `update` and `finish` are kernel text over ``{value}`` (the quantity here), ``{acc}`` (the accumulator),
    ``{place}`` (that of the input position) and ``{count}`` (that of the configurations that assemble). Where the whole
    curve is needed at once, `whole` names the function of `fastlink.codegen.runtime.fluctuation` that takes it instead.
    """

    suffix: str
    phrase: str
    initial: str
    update: str
    finish: str
    has_place: bool = False
    better: str = ""
    count_update: str = ""
    whole: str = ""


def _extreme(suffix: str, phrase: str, sign: str, initial: str) -> Reduction:
    return Reduction(
        suffix,
        phrase,
        initial,
        update="select({better}, {value}, {acc})",
        finish=f"select({{acc}} {sign} {initial}, {{acc}}, nan)",
        has_place=True,
        better=f"{{value}} {sign} {{acc}}",
    )


_COUNT = "{count} + select({value} == {value}, 1.0, 0.0)"

REDUCTIONS: dict[str, Reduction] = {
    "max": _extreme("max", "greatest over the cycle", ">", "-inf"),
    "min": _extreme("min", "least over the cycle", "<", "inf"),
    "rms": Reduction(
        "rms",
        "root mean square over the cycle",
        "0.0",
        update="{acc} + select({value} == {value}, {value} * {value}, 0.0)",
        finish="sqrt({acc} / {count})",
        count_update=_COUNT,
    ),
    "mean": Reduction(
        "mean",
        "mean over the cycle",
        "0.0",
        update="{acc} + select({value} == {value}, {value}, 0.0)",
        finish="{acc} / {count}",
        count_update=_COUNT,
    ),
    "fluctuation": Reduction(
        "fluctuation",
        "greatest minus least integral over the input angle of what exceeds the mean",
        "nan",
        update="",
        finish="{acc}",
        whole="fluctuation_lanes",
    ),
}
for _reduction in REDUCTIONS.values():
    register_reduction(_reduction.suffix, _reduction.has_place)

#: Whether extremes are exact over the cycle, or taken over the given positions.
Extrema = Literal["refined", "sampled"]


@dataclass(frozen=True)
class Request:
    """A name that was asked for: a quantity, what is taken of it over the cycle, or a list of its extremes.

    `of_curves` tells of a quantity that is made of whole curves, see `Catalogue.over_positions`.
    """

    name: str
    quantity: str
    reduction: Reduction | None = None
    place: bool = False
    listed: str = ""
    of_curves: bool = False

    @property
    def is_pointwise(self) -> bool:
        """Whether a position says something of it by itself: it needs no whole curve at once."""
        return not (self.of_curves or (self.reduction is not None and self.reduction.whole))

    @property
    def can_be_refined(self) -> bool:
        """Whether it is one number of the extremes, which samples only come near."""
        return bool(self.reduction and self.reduction.has_place)


def parse_request(name: str, catalogue: Catalogue) -> Request:
    """Read a requested name such as ``omega4``, ``omega4_max`` or ``theta1_at_omega4_max``.

    Raises
    ------
    InputError
        Neither the name nor the quantity in it is known.
    """
    if catalogue.is_quantity(name):
        return Request(name, name)
    if name in catalogue.curves:
        return Request(name, name, of_curves=True)
    tree = catalogue.parse(name)
    if isinstance(tree, (Reduced, ListOfExtrema)) and catalogue.is_cyclic(quantity := str(tree.of)):
        if isinstance(tree, Reduced):
            return Request(name, quantity, REDUCTIONS[tree.how], bool(tree.place))
        return Request(name, quantity, listed="place" if tree.place else tree.part)
    known = [*catalogue.offered, *reduced_names(catalogue)]
    raise InputError(catalogue.unknown(name, known))


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

"""How names of reductions, derivatives and bounds are formed from those of quantities, for the list of these."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastlink._text import joined
from fastlink.facts.names import (
    Change,
    Derivative,
    ErrorBound,
    GradientStatus,
    ListOfExtrema,
    Quantity,
    Reduced,
    Trust,
)
from fastlink.plan.reductions import REDUCTIONS
from fastlink.space.design_space import BRANCH, DESIGN

if TYPE_CHECKING:
    from fastlink.catalogue.catalogue import Catalogue

__all__ = ["naming"]

NAME = Quantity("NAME")


def naming(catalogue: Catalogue) -> str:
    """Return how names of reductions, derivatives and bounds are formed, as Markdown."""
    position = catalogue.position
    unit = "" if position.units == "1" else f" in {position.units}"
    reductions = [f"`{Reduced(NAME, each.suffix)}` ({each.phrase})" for each in REDUCTIONS.values()]
    positions = [
        f"`{Reduced(NAME, each.suffix, position.name)}`" for each in REDUCTIONS.values() if each.has_position
    ]
    bounds = [
        f"`{ErrorBound(Reduced(NAME, each.suffix))}`" for each in REDUCTIONS.values() if each.has_position
    ]
    extreme = Reduced(NAME, "max")
    lists = (
        f"`{ListOfExtrema(NAME)}` lists all extremes over the reachable range by growing {position.name}, along "
        f"the dimension `extremum`, together with `{ListOfExtrema(NAME, position=position.name)}`, "
        f"`{ListOfExtrema(NAME, 'count')}` and `{ListOfExtrema(NAME, 'kind')}`. "
        f"{', '.join(bounds)} and `{ListOfExtrema(NAME, 'error')}` bound the errors of exact extremes. "
    )
    known = [f"`{name}`" for name in catalogue.graded.known] if catalogue.graded is not None else []
    sure = (
        f"The greatest and least {joined(known)} are known in closed form and not searched. " if known else ""
    )
    return (
        f"Any NAME with the dimension `{position.name}` has {joined(reductions)}, and {joined(positions)} (the "
        f"{position.name}{unit} there), with the dimensions ({DESIGN}, {BRANCH}). "
        f"{lists if catalogue.graded is not None else ''}{sure}"
        f"`{Derivative(extreme, 'PARAM')}` is the derivative of such a number by an input, "
        f"`{GradientStatus(extreme)}` tells what it is worth. "
        "Positions at which it does not assemble do not count: all is NaN there but "
        "what the driven link alone determines, such as the place of its pin. "
        f"`{Derivative(NAME, 'PARAM')}` is the derivative of NAME with respect to an input or to "
        f"`{position.name}`, and is itself such a NAME. "
        f"`{Change(NAME, 'worst')}` and `{Change(NAME, 'rss')}` are the changes of any of these numbers by the "
        "tolerances of the inputs. "
        f"`{ErrorBound(NAME)}` bounds the rounding error of NAME, and `{Trust(NAME)}` flags where that bound "
        f"exceeds a millionth of NAME. `{DESIGN}` stands for the swept dimensions."
    )

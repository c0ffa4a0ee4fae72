"""Programs of extremes that are known in closed form: the quantity at a few places, and nothing that is searched."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from fastlink.facts.names import error_name
from fastlink.plan.program import KnownProgram

if TYPE_CHECKING:
    from fastlink.catalogue.catalogue import Catalogue, Fact, System
    from fastlink.facts.fact import KnownExtremes
    from fastlink.plan.program import ExtremumSearch, Output

__all__ = ["find_known_extremes", "is_of_known", "known_program"]


def find_known_extremes(
    catalogue: Catalogue, quantity: str, steps: Iterable[Fact | System], variants: Sequence[str]
) -> KnownExtremes | None:
    """Return where the extremes of a quantity are, None where that is not known for the facts that are selected.

    `steps` are those that compute it: what was declared holds for the mechanism's own, not for those of a variant.
    """
    assert catalogue.graded is not None
    replaced = {name for variant in variants for name in catalogue.variants.get(variant, ())}
    if any(name in replaced for step in steps for name in step.names):
        return None
    return catalogue.graded.known.get(quantity)


def is_of_known(output: Output, searches: Iterable[ExtremumSearch]) -> bool:
    """Tell whether a result is one of extremes that are known: lists and changes by tolerances are searched."""
    request = output.request
    own = any(search.known is not None for search in searches if search.quantity == request.quantity)
    return own and request.can_be_refined and not request.change


def known_program(
    catalogue: Catalogue,
    outputs: Sequence[Output],
    searches: Sequence[ExtremumSearch],
    steps_of: Callable[[Iterable[str]], tuple[Fact | System, ...]],
    *,
    given: Sequence[str],
    branches: Sequence[int],
    variants: Sequence[str],
) -> KnownProgram:
    """Return the program of extremes that are known.

    Parameters
    ----------
    catalogue, outputs, searches, given, branches, variants
        As for `fastlink.plan.extrema.extrema_programs`, which calls it.
    steps_of : callable
        The steps that compute facts at places of the graded range.
    """
    graded = catalogue.graded
    assert graded is not None
    names = [name for end in graded.ends for name in end[1:]]
    if any(output.request.is_position or output.request.is_of_gradient for output in outputs):
        names.append(catalogue.position.name)
    for search in searches:
        assert search.known is not None
        names += [search.quantity, *search.known.facts, *search.bounded_by]
        names += [name for gradient in search.gradients for name in gradient.names]
        if any(output.request.is_of_gradient for output in outputs) and not search.known.places:
            names.append(search.slope)
        if search.bounded_by:
            names += [error_name(end[2]) for end in graded.ends]
    steps = steps_of(dict.fromkeys(names))
    read = {name for step in steps for name in step.depends_on}
    return KnownProgram(
        catalogue=catalogue,
        outputs=tuple(outputs),
        steps=steps,
        inputs=tuple(name for name in catalogue.known_inputs(variants) if name in read and name in given),
        branches=tuple(branches),
        variants=tuple(variants),
        searches=tuple(searches),
    )

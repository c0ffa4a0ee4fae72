"""What is searched for extremes: a quantity, its derivative by the input position, how fine the search is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from fastlink.catalogue.catalogue import Catalogue, CatalogueError, Fact, System
from fastlink.facts.names import derivative_name
from fastlink.plan.program import ExtremaProgram, ExtremumSearch, Output
from fastlink.symbolic.asymptotics import asymptotics
from fastlink.symbolic.derivative import NoDerivative

__all__ = ["extrema_programs", "find_extremum_search", "find_jumps"]


def find_extremum_search(
    catalogue: Catalogue, quantity: str, given: Iterable[str], variants: Sequence[str]
) -> ExtremumSearch | None:
    """Return how a quantity is searched, or None where it has no derivative or no graded range.

    Raises
    ------
    InputError
        An input that it needs is not given.
    """
    graded = catalogue.graded
    if graded is None or quantity in graded.not_differentiable:
        return None
    slope = derivative_name(quantity, catalogue.position.name)
    try:
        steps = _closure(catalogue, (quantity, slope), given, variants)
    except (CatalogueError, NoDerivative):
        return None
    if any(isinstance(step, System) for step in steps):
        return None
    found = asymptotics(graded, steps, (*graded.coordinates, "branch"))
    needed = {name for step in _closure(catalogue, (quantity,), given, variants) for name in step.names}
    return ExtremumSearch(
        quantity,
        slope,
        graded.cells.get(quantity, graded.cells_otherwise),
        graded.max_extrema.get(quantity, graded.max_extrema_otherwise),
        round(found[quantity].order),
        max(round(found[slope].order), 0),
        found[quantity].parity,
        -found[quantity].parity,  # the input position is odd
        graded.reciprocal not in needed and not found[quantity].choice,
    )


def find_jumps(catalogue: Catalogue, search: ExtremumSearch) -> ExtremumSearch | None:
    """Return where the angle of a search jumps by 2 pi, or None where it does not."""
    graded = catalogue.graded
    assert graded is not None
    vanishing = graded.wraps_at.get(search.quantity)
    if vanishing is None:
        return None
    # It is the sine of the angle times a length: odd where the angle is.
    return replace(search, slope=vanishing, slope_order=0, slope_parity=search.parity, onto=search.quantity)


def _closure(
    catalogue: Catalogue, names: Iterable[str], given: Iterable[str], variants: Sequence[str]
) -> tuple[Fact | System, ...]:
    """Return what is computed for facts at places of the graded range."""
    graded = catalogue.graded
    assert graded is not None
    return tuple(
        catalogue.dependencies(names, (*given, *graded.coordinates, "branch"), (graded.name, *variants))
    )


def extrema_programs(
    catalogue: Catalogue,
    outputs: Iterable[Output],
    searches: Iterable[ExtremumSearch],
    given: Sequence[str],
    branches: tuple[int, ...],
    variants: tuple[str, ...],
) -> list[ExtremaProgram]:
    """Group searches by what may share samples without changing any bit: fineness and symmetry."""
    graded = catalogue.graded
    assert graded is not None
    groups: dict[tuple[int, bool], list[ExtremumSearch]] = {}
    for search in searches:
        groups.setdefault((search.cells, search.parity != 0), []).append(search)
    asked = list(outputs)
    ends = [name for end in graded.ends for name in end]
    result = []
    for group in groups.values():
        names = [catalogue.position.name, graded.bounded_factor, *ends]
        names += [name for search in group for name in (search.slope, search.quantity)]
        steps = [s for s in _closure(catalogue, names, given, variants) if isinstance(s, Fact)]
        read = {need for step in steps for need in step.depends_on}
        inputs = tuple(name for name in catalogue.known_inputs(variants) if name in read and name in given)
        own = tuple(
            o for search in group for o in asked if o.request.quantity == search.quantity and not search.onto
        )
        result.append(
            ExtremaProgram(
                catalogue=catalogue,
                outputs=own,
                steps=tuple(steps),
                inputs=inputs,
                branches=branches,
                variants=variants,
                searches=tuple(group),
            )
        )
    return result

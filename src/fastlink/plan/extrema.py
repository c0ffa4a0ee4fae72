"""Programs of searches for extrema: each of a quantity by its derivative with respect to the input position."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from fastlink.catalogue.catalogue import Catalogue, CatalogueError, Fact, System
from fastlink.facts.names import derivative_name, error_name
from fastlink.plan.kinks import (
    FINER,
    folds,
    has_sharp_terms,
    is_magnitude,
    may_have_kinks,
    searches_at_kinks,
    searches_for_splits,
    turns_of,
)
from fastlink.plan.known import find_known_extremes, is_of_known, known_program
from fastlink.plan.program import ExtremaProgram, ExtremumSearch, Gradient, KnownProgram, Output
from fastlink.symbolic.asymptotics import asymptotics
from fastlink.symbolic.derivative import NoDependence, NoDerivative

__all__ = ["extrema_programs", "find_extremum_search"]


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
        steps = _steps(catalogue, (quantity, slope), given, variants)
    except (CatalogueError, NoDerivative):
        return None
    if any(isinstance(step, System) for step in steps):
        return None
    grades = asymptotics(graded, steps, (*graded.coordinates, "branch"))
    grade = grades[quantity]
    divisor, power = graded.divisors.get(quantity, (quantity, 0))
    own = _steps(catalogue, (quantity,), given, variants)
    needed = {name for step in own for name in step.names}
    by_name = {name: step for step in steps for name in step.names}
    return ExtremumSearch(
        quantity,
        slope,
        graded.cells.get(quantity, graded.cells_otherwise) * (FINER if has_sharp_terms(own) else 1),
        graded.max_extrema.get(quantity, graded.max_extrema_otherwise),
        round(grade.order),
        max(round(grades[slope].order + power * grades[divisor].order), 0),
        grade.parity,
        -grade.parity,  # the input position is odd
        at_limit=graded.reciprocal not in needed and not grade.choice,
        divided=quantity not in graded.cells,
        turns=() if quantity in graded.cells else turns_of(graded, quantity, steps),
        magnitude=is_magnitude(by_name[quantity]),
        folds=folds(by_name[quantity]),
        kinked=any(map(may_have_kinks, own)),
        divisors=(divisor,) * power,
        known=find_known_extremes(catalogue, quantity, own, variants),
    )


def _steps(
    catalogue: Catalogue, names: Iterable[str], given: Iterable[str], variants: Sequence[str]
) -> tuple[Fact | System, ...]:
    """Return the steps that compute facts at positions of the graded range."""
    graded = catalogue.graded
    assert graded is not None
    return tuple(
        catalogue.dependencies(names, (*given, *graded.coordinates, "branch"), (graded.name, *variants))
    )


def _further_searches(
    catalogue: Catalogue, searches: Iterable[ExtremumSearch], bounded: Container[str], steps_of: Any
) -> list[ExtremumSearch]:
    """Return the searches for places where a quantity may be greatest or least, though its slope is not 0.

    Where the greatest or least value of an angle is requested, its jumps by 2 pi are searched too; where that of a
    quotient is, the places where what it is divided by is least: next to zero three extremes may be too close to tell.
    So may be those on both sides of a kink: of what has kinks these are searched, and the extremes of its smooth parts.
    """
    graded, position = catalogue.graded, catalogue.position.name
    assert graded is not None
    # The fact that vanishes there is the sine of the angle times a length: odd where the angle is.
    jumps = [
        replace(
            s,
            slope=graded.wraps_at[s.quantity],
            slope_order=0,
            slope_parity=s.parity,
            magnitude=False,
            divisors=(),
            onto=s.quantity,
            jumps=True,
            turns=(),
            bounded_by=(),
            gradients=(),
        )
        for s in searches
        if s.quantity in bounded and s.quantity in graded.wraps_at
    ]
    kinks = [
        one for s in searches if s.quantity in bounded for one in searches_at_kinks(catalogue, s, steps_of)
    ]
    nearly_poles = [
        replace(
            s,
            slope=derivative_name(s.divisors[0], position),
            divisors=s.divisors[:1],  # the square's derivative, which has no kink
            divided=False,
            turns=(),
            onto=s.quantity,
            gradients=(),
        )
        for s in (*searches, *kinks)
        if s.quantity in bounded and s.divisors
    ]
    return jumps + kinks + nearly_poles


def extrema_programs(
    catalogue: Catalogue,
    outputs: Sequence[Output],
    searches: Sequence[ExtremumSearch],
    *,
    given: Sequence[str],
    branches: Sequence[int],
    variants: Sequence[str],
) -> list[ExtremaProgram]:
    """Return a program of extremes that are known, and group searches by what may share samples.

    These are fineness and symmetry: no bit changes.
    """
    graded = catalogue.graded
    assert graded is not None
    known = _known_programs(catalogue, outputs, searches, given=given, branches=branches, variants=variants)
    outputs = [output for output in outputs if not is_of_known(output, searches)]
    quantities = {output.request.quantity for output in outputs}
    searches = [search for search in searches if search.quantity in quantities]
    searches = [_asked(catalogue, search, outputs, given=given, variants=variants) for search in searches]
    bounded = {output.request.quantity for output in outputs if output.request.can_be_refined}
    groups: dict[tuple[int, bool], list[ExtremumSearch]] = {}
    steps_of = partial(_steps, catalogue, given=given, variants=variants)
    for search in (*searches, *_further_searches(catalogue, searches, bounded, steps_of)):
        groups.setdefault((search.cells, search.mirrored), []).append(search)
    programs: list[ExtremaProgram] = [*known]
    for group in groups.values():
        group += searches_for_splits(catalogue, group, steps_of)
        names = [
            catalogue.position.name,
            graded.bounded_factor,
            *(name for end in graded.ends for name in end),
        ]
        names += [name for s in group for name in (s.slope, s.quantity, *s.divisors, *s.bounded_by)]
        names += [name for s in group for gradient in s.gradients for name in gradient.names]
        of_group = [o for s in group for o in outputs if o.request.quantity == s.quantity and not s.onto]
        names += [term.tolerance for o in of_group for term in o.terms]
        names += [error_name(end[2]) for end in graded.ends if any(s.bounded_by for s in group)]
        steps = _steps(catalogue, names, given, variants)
        read = {name for step in steps for name in step.depends_on}
        inputs = catalogue.known_inputs(variants)
        programs.append(
            ExtremaProgram(
                catalogue=catalogue,
                outputs=tuple(of_group),
                steps=steps,
                inputs=tuple(name for name in inputs if name in read and name in given),
                branches=tuple(branches),
                variants=tuple(variants),
                searches=tuple(group),
            )
        )
    return programs


def _known_programs(
    catalogue: Catalogue,
    outputs: Iterable[Output],
    searches: Sequence[ExtremumSearch],
    *,
    given: Sequence[str],
    branches: Sequence[int],
    variants: Sequence[str],
) -> list[KnownProgram]:
    """Return the program of extremes that are known, if such are requested."""
    own = [output for output in outputs if is_of_known(output, searches)]
    quantities = {output.request.quantity for output in own}
    known = [
        _asked(catalogue, search, own, given=given, variants=variants)
        for search in searches
        if search.quantity in quantities
    ]
    steps_of = partial(_steps, catalogue, given=given, variants=variants)
    setting: dict[str, Any] = {"given": given, "branches": branches, "variants": variants}
    return [known_program(catalogue, own, known, steps_of, **setting)] if own else []


def _asked(
    catalogue: Catalogue,
    search: ExtremumSearch,
    outputs: Sequence[Output],
    *,
    given: Sequence[str],
    variants: Sequence[str],
) -> ExtremumSearch:
    """Return a search with the error bounds and derivatives that are requested of its extremes."""
    own = [output for output in outputs if output.request.quantity == search.quantity]
    gradients = _gradients(catalogue, search, own, given=given, variants=variants)
    if not any(output.request.is_error for output in own):
        return replace(search, gradients=gradients)
    bend = derivative_name(search.slope, catalogue.position.name)
    bounds = error_name(search.quantity), error_name(search.slope), bend, search.slope
    return replace(search, bounded_by=bounds, gradients=gradients)


def _gradients(
    catalogue: Catalogue,
    search: ExtremumSearch,
    outputs: Sequence[Output],
    *,
    given: Sequence[str],
    variants: Sequence[str],
) -> tuple[Gradient, ...]:
    """Return the requested derivatives of the extremes of a quantity, of the values before those of the places."""
    own = [(output.request.is_position, by) for output in outputs for by in output.inputs]
    position, found = catalogue.position.name, []
    for place, by in dict.fromkeys(sorted(own, key=lambda pair: pair[0])):
        of = position if place else search.quantity
        own_slope = derivative_name(search.slope if place else search.quantity, by)
        held: tuple[str, ...] = (own_slope,)
        held += (derivative_name(search.slope, position),) if place else ()
        moving, absent = derivative_name(of, by, moving=True), None
        try:
            _steps(catalogue, (own_slope,), given, variants)
        except NoDependence as error:
            held, absent = (), error
        try:
            _steps(catalogue, (moving,), given, variants)
        except NoDerivative:
            moving = ""  # limits of motion do not depend on it
        if absent is not None and not moving:
            raise absent
        found.append(Gradient(by, place, held, moving))
    return tuple(found)

"""Split a request into programs: values at each position, samples over the cycle, refined extremes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any

from fastlink.catalogue.catalogue import Catalogue
from fastlink.errors import InputError, Setting
from fastlink.facts.names import ErrorBound, Quantity, Reduced, error_name
from fastlink.plan.extrema import extrema_programs, find_extremum_search
from fastlink.plan.pointwise import output_of, pointwise_programs, terms_of
from fastlink.plan.program import ExtremumSearch, Output, Program
from fastlink.plan.query import Extrema, Request, parse_request
from fastlink.plan.reductions import REDUCTIONS
from fastlink.plan.toggles import counted_by, toggles_of

__all__ = ["Plan", "all_declared", "make_plan", "planned_again"]


@dataclass(frozen=True, eq=False)
class Plan:
    """The programs that together give all results; two plans are equal only if they are one object, so it can be a key.

    Attributes
    ----------
    catalogue : Catalogue
        The mechanism.
    outputs : tuple of Output
        The results, in the order of the request.
    programs : tuple of Program
        One for each kernel.
    branches : tuple of int
        The assembly modes.
    variants : tuple of str
        The selected variants.
    extrema_kept : int
        Length of the dimension of extrema.
    recipe : tuple
        The arguments of `planned_again`, which makes the plan in another process: facts are functions, and stay.
    """

    catalogue: Catalogue
    outputs: tuple[Output, ...]
    programs: tuple[Program, ...]
    branches: tuple[int, ...]
    variants: tuple[str, ...]
    extrema_kept: int
    recipe: tuple[Any, ...] = field(default=(), repr=False)

    def __reduce__(self) -> tuple[Any, ...]:
        return planned_again, self.recipe

    @property
    def uses_position(self) -> bool:
        """Whether anything is computed at the given input positions."""
        return any(program.tables for program in self.programs)

    @cached_property
    def depends_on_solver(self) -> bool:
        """Whether anything that is computed depends on the solver."""
        return any(self.catalogue.depends_on_solver(program.steps) for program in self.programs)

    @property
    def extrema(self) -> str:
        """The search for extrema: refined, sampled, both, or an empty text where there are none."""
        reduced = [output for output in self.outputs if output.request.reduction or output.refined]
        return " and ".join(sorted({"refined" if output.refined else "sampled" for output in reduced}))


def make_plan(
    catalogue: Catalogue,
    names: Iterable[str],
    *,
    given: Sequence[str],
    branches: Sequence[int] = (1, 2),
    variants: Sequence[str] = (),
    angles: int = 360,
    extrema: Extrema = "refined",
) -> Plan:
    """Resolve the requested names into programs.

    Parameters
    ----------
    catalogue, given, branches, variants, angles
        As for `make_program`.
    names : iterable of str
        Quantities, their reductions over the cycle, lists of their extrema.
    extrema : {"refined", "sampled"}
        Whether ``NAME_max`` and its like are exact over the cycle, or over the given positions only.

    Raises
    ------
    InputError
        A name is unknown, an input is not given, or a quantity cannot be refined.
    """
    names = tuple(names)
    requests = [parse_request(name, catalogue) for name in names]
    for request in requests:
        if request.name in given:
            what = f"quantity {request.name!r} is given, and a coordinate of the result"
            raise InputError(what, remedy="leave it out")
    searches: dict[str, ExtremumSearch | None] = {}
    refined: set[str] = set()
    for request in requests:
        if request.listed or request.is_error or (extrema == "refined" and request.can_be_refined):
            quantity = request.quantity
            if quantity not in searches:
                searches[quantity] = find_extremum_search(catalogue, quantity, given, variants)
            if request.is_error and (
                searches[quantity] is None or not (request.listed or extrema == "refined")
            ):
                raise _no_error(request, catalogue, variants, given, searched=searches[quantity] is not None)
            if searches[quantity] is not None:
                refined.add(request.name)
            elif request.listed:
                raise _not_refined(request, catalogue)
    whole_turn = extrema == "refined"
    met = [toggles_of(catalogue, r, given, variants) if whole_turn else () for r in requests]
    outputs = tuple(
        output_of(
            r,
            catalogue,
            refined=r.name in refined,
            toggles=toggles,
            counted="" if r.name in refined else counted_by(catalogue, r, given, variants),
            terms=terms_of(r, catalogue, given, variants, refined=r.name in refined),
        )
        for r, toggles in zip(requests, met, strict=True)
    )
    setting: dict[str, Any] = {"given": given, "branches": branches, "variants": variants}
    programs: list[Program] = []
    if sampled := [output.name for output in outputs if not output.refined]:
        programs += pointwise_programs(catalogue, sampled, angles, whole_turn=whole_turn, **setting)
    searched = [search for search in searches.values() if search is not None]
    if searched:
        programs += extrema_programs(catalogue, [o for o in outputs if o.refined], searched, **setting)
    kept = max((search.most for search in searched), default=0)
    recipe = catalogue, names, tuple(given), tuple(branches), tuple(variants), angles, extrema
    return Plan(catalogue, outputs, tuple(programs), tuple(branches), tuple(variants), kept, recipe)


def all_declared(catalogue: Catalogue) -> tuple[Any, ...]:
    """Return a key that changes when a fact, an input or a reduction is declared or replaced."""
    return catalogue.version, *REDUCTIONS.values()


def planned_again(
    catalogue: Catalogue, names: tuple[str, ...], given: tuple[str, ...], *options: Any
) -> Plan:
    """Return the plan that `make_plan` made in another process, once as long as nothing is declared."""
    return _again(all_declared(catalogue), catalogue, names, given, options)


@lru_cache(maxsize=64)
def _again(
    declared: tuple[Any, ...],
    catalogue: Catalogue,
    names: tuple[str, ...],
    given: tuple[str, ...],
    options: Any,
) -> Plan:
    branches, variants, angles, extrema = options
    setting: dict[str, Any] = {"branches": branches, "variants": variants, "angles": angles}
    return make_plan(catalogue, names, given=given, extrema=extrema, **setting)


def _not_refined(request: Request, catalogue: Catalogue) -> InputError:
    ends = [str(Reduced(Quantity(request.quantity), how)) for how in ("max", "min")]
    offered = " and ".join(name for name in ends if name not in catalogue.hiding)
    remedy = f"ask for {offered}" if offered else f"ask for {request.quantity}, and take extremes of the map"
    return InputError(
        f"quantity {request.name!r}: {request.quantity} of {catalogue.name} has no derivative by "
        f"{catalogue.position.name} here, so its extremes cannot be listed",
        remedy=remedy,
    )


def _no_error(
    request: Request, catalogue: Catalogue, variants: Sequence[str], given: Sequence[str], *, searched: bool
) -> InputError:
    """Return the error for the error bound of an extreme of samples; `searched` tells that they were chosen."""
    quantity, position = request.quantity, catalogue.position.name
    catalogue.resolve(error_name(quantity), variants, given)  # values of a linear system have none
    what = f"quantity {request.name!r}: the extremes of {quantity} are those of samples here, and how far they are from"
    what += f" those over all {position} is not known"
    of_samples = (
        f"ask for {Reduced(ErrorBound(Quantity(quantity)), 'max')}, the greatest error of the samples"
    )
    if not searched:
        return InputError(what, remedy=of_samples)
    turn = (f"give no array of {position} and write ", Setting("extrema", "refined"))
    return InputError(what, remedy=(*turn, f", or {of_samples}"))

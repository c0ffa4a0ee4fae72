"""Split a request into programs: values at each position, samples over the cycle, refined extremes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

from fastlink.catalogue.catalogue import Catalogue, System
from fastlink.errors import InputError
from fastlink.facts.names import Quantity, Reduced
from fastlink.plan.extrema import extrema_programs, find_extremum_search, find_jumps
from fastlink.plan.pointwise import ANGLES_FOR_LANES, make_program, output_of, parse_requests
from fastlink.plan.program import ExtremumSearch, Output, Program
from fastlink.plan.query import Extrema, Request

__all__ = ["Plan", "make_plan"]


@dataclass(frozen=True, eq=False)
class Plan:
    """The programs that together give all results; two plans are equal only if they are one object, so it can be a key.

    Attributes
    ----------
    catalogue : Catalogue
        The mechanism.
    outputs : tuple of Output
        The results, in the order asked.
    programs : tuple of Program
        One for each kernel.
    branches : tuple of int
        The assembly modes.
    variants : tuple of str
        The chosen sets of facts.
    extrema_kept : int
        Length of the dimension of extremes.
    """

    catalogue: Catalogue
    outputs: tuple[Output, ...]
    programs: tuple[Program, ...]
    branches: tuple[int, ...]
    variants: tuple[str, ...]
    extrema_kept: int

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
        """How extremes are found: refined, sampled, both, or nothing where there are none."""
        ways = {
            "refined" if o.refined else "sampled" for o in self.outputs if o.request.reduction or o.refined
        }
        return " and ".join(sorted(ways))


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
    catalogue : Catalogue
        The mechanism.
    names : iterable of str
        Quantities, what is taken of them over the cycle, lists of their extremes.
    given : sequence of str
        The inputs that the design space gives.
    branches : sequence of int
        Assembly modes.
    variants : sequence of str
        Chosen sets of facts.
    angles : int
        Number of input positions.
    extrema : {"refined", "sampled"}
        Whether ``NAME_max`` and its like are exact over the cycle, or over the given positions only.

    Raises
    ------
    InputError
        A name is unknown or asked twice, an input is not given, or a quantity cannot be refined.
    """
    requests = parse_requests(names, catalogue)
    for request in requests:
        if request.name in given:
            what = f"quantity {request.name!r} is given, and a coordinate of the result"
            raise InputError(what, remedy="leave it out")
    searches: dict[str, ExtremumSearch] = {}
    refined: set[str] = set()
    for request in requests:
        if request.listed or (extrema == "refined" and request.can_be_refined):
            search = searches.get(request.quantity) or find_extremum_search(
                catalogue, request.quantity, given, variants
            )
            if search is not None:
                searches[request.quantity] = search
                refined.add(request.name)
            elif request.listed:
                raise _not_refined(request, catalogue)
    sampled = [r.name for r in requests if r.name not in refined]
    outputs = tuple(output_of(r, catalogue, refined=r.name in refined) for r in requests)
    make = partial(make_program, catalogue, branches=branches, variants=variants, angles=angles)
    programs: list[Program] = []
    if sampled:
        programs += _split(make(sampled, given=given), angles, make)
    if searches:
        bounded = {r.quantity for r in requests if r.name in refined and r.can_be_refined}
        jumps = [find_jumps(catalogue, search) for name, search in searches.items() if name in bounded]
        programs += extrema_programs(
            catalogue,
            [o for o in outputs if o.refined],
            [*searches.values(), *(jump for jump in jumps if jump is not None)],
            given,
            tuple(branches),
            tuple(variants),
        )
    kept = max((search.most for search in searches.values()), default=0)
    return Plan(catalogue, outputs, tuple(programs), tuple(branches), tuple(variants), kept)


def _not_refined(request: Request, catalogue: Catalogue) -> InputError:
    ends = [str(Reduced(Quantity(request.quantity), how)) for how in ("max", "min")]
    offered = " and ".join(name for name in ends if name not in catalogue.hiding)
    remedy = f"ask for {offered}" if offered else f"ask for {request.quantity}, and take extremes of the map"
    return InputError(
        f"quantity {request.name!r}: {request.quantity} of {catalogue.name} has no derivative by "
        f"{catalogue.position.name} here, so its extremes cannot be listed",
        remedy=remedy,
    )


def _split(program: Program, angles: int, make: Callable[..., Program]) -> list[Program]:
    """Return the programs that together give a program's results fastest: curves apart from the rest.

    With lanes that are designs a curve is stored across the lines of its array, 1 ns a value; with lanes that are
    angles it costs less to compute the shared facts again.
    """
    position = program.catalogue.position.name
    curves = [output.name for output in program.outputs if position in output.axes]
    others = [output.name for output in program.outputs if position not in output.axes]
    has_system = any(isinstance(step, System) for step in program.steps)
    if has_system or program.lanes == "angles" or angles < ANGLES_FOR_LANES or not curves or not others:
        return [program]
    return [make(names, given=program.inputs) for names in (curves, others)]

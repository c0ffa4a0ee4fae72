"""Everything asked of a sweep to the kernels that give it: curves, what is taken of samples, refined extremes."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue.catalogue import Catalogue, Fact, System
from fastlink.codegen.extrema import write_extrema
from fastlink.errors import InputError
from fastlink.facts.names import Quantity, Reduced
from fastlink.plan.extrema import extrema_programs, find_extremum_search, find_jumps
from fastlink.plan.pointwise import ANGLES_FOR_LANES, Kernel, Plan, make_plan, output_of, parse_requests
from fastlink.plan.program import ExtremaProgram, ExtremumSearch, Output
from fastlink.plan.query import Extrema, Request

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.codegen.source import Source

__all__ = ["CurvePlan", "Plan_", "RefinedPlan", "make_plans"]


class RefinedPlan(ExtremaProgram, Kernel):
    """A closure that finds every extreme of some quantities, with its kernel."""

    @cached_property
    def written(self) -> Source:  # type: ignore[override]
        """The text of the kernel, and what it is called with."""
        return write_extrema(self)

    def angle_tables(self, theta: NDArray[Any]) -> NDArray[Any]:
        """Return an empty angle array: places are graded by design."""
        return np.empty((0, 0))


@dataclass(frozen=True)
class CurvePlan(Plan):
    """What is made of whole curves: the kernel of a plan gives these, functions of NumPy the results.

    Attributes
    ----------
    curves : Plan
        The plan of the curves.
    facts : tuple of Fact
        What is made of them, for each output.
    """

    curves: Plan
    facts: tuple[Fact, ...]

    @cached_property
    def written(self) -> Source:  # type: ignore[override]
        """The text of the curves' kernel and of the functions."""
        files = (inspect.getmodule(fact.function) for fact in self.facts)
        texts = (inspect.getsource(file) for file in dict.fromkeys(files) if file is not None)
        of_curves = self.curves.written
        return replace(of_curves, text="\n\n".join((of_curves.text, *texts)))

    def _load(self, backend: str, relaxed: bool) -> Any:
        return self._from(self.curves.compiled(backend, relaxed=relaxed))

    def _from(self, kernel: Callable[..., None]) -> Callable[..., None]:
        def run(x: NDArray[Any], angles: NDArray[Any], n: int, n_angles: int, *arrays: NDArray[Any]) -> None:
            count = len(self.written.scratch)
            scratch, results = arrays[:count], arrays[count:]
            curves = {o.name: np.empty((n, len(self.branches), n_angles)) for o in self.curves.outputs}
            kernel(x, angles, n, n_angles, *scratch, *curves.values())
            with np.errstate(all="ignore"):
                for fact, result in zip(self.facts, results, strict=True):
                    result[...] = fact.function(*(curves[need] for need in fact.depends_on))

        return run


@dataclass(frozen=True, eq=False)
class Plan_:
    """The kernels that together give all results; it is itself alone that it equals, so that things are kept by it.

    Attributes
    ----------
    catalogue : Catalogue
        The mechanism.
    outputs : tuple of Output
        The results, in the order asked.
    parts : tuple of Plan, CurvePlan or RefinedPlan
        The kernels.
    branches : tuple of int
        The assembly modes.
    variants : tuple of str
        The chosen sets of facts.
    extrema_kept : int
        Length of the dimension of extremes.
    """

    catalogue: Catalogue
    outputs: tuple[Output, ...]
    parts: tuple[Plan | RefinedPlan, ...]
    branches: tuple[int, ...]
    variants: tuple[str, ...]
    extrema_kept: int

    @property
    def uses_position(self) -> bool:
        """Whether anything is computed at the given input positions."""
        return any(isinstance(part, Plan) and part.uses_position for part in self.parts)

    @cached_property
    def depends_on_solver(self) -> bool:
        """Whether anything that is computed depends on the solver."""
        return any(self.catalogue.depends_on_solver(part.steps) for part in self.parts)

    @property
    def extrema(self) -> str:
        """How extremes are found: refined, sampled, both, or nothing where there are none."""
        ways = {
            "refined" if o.refined else "sampled" for o in self.outputs if o.request.reduction or o.refined
        }
        return " and ".join(sorted(ways))


def make_plans(
    catalogue: Catalogue,
    names: Iterable[str],
    *,
    given: Sequence[str],
    branches: Sequence[int] = (1, 2),
    variants: Sequence[str] = (),
    angles: int = 360,
    extrema: Extrema = "refined",
) -> Plan_:
    """Resolve the asked names into kernels.

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
    sampled = [r.name for r in requests if r.name not in refined and not r.of_curves]
    outputs = tuple(output_of(r, catalogue, refined=r.name in refined) for r in requests)
    options: dict[str, Any] = {"branches": branches, "variants": variants, "angles": angles}
    parts: list[Plan | RefinedPlan] = []
    if sampled:
        parts += _split(make_plan(catalogue, sampled, given=given, **options), angles)
    if of_curves := tuple(output for output in outputs if output.request.of_curves):
        parts.append(_over_curves(catalogue, of_curves, given, options))
    if searches:
        bounded = {r.quantity for r in requests if r.name in refined and r.can_be_refined}
        jumps = [find_jumps(catalogue, search) for name, search in searches.items() if name in bounded]
        programs = extrema_programs(
            catalogue,
            [o for o in outputs if o.refined],
            [*searches.values(), *(jump for jump in jumps if jump is not None)],
            given,
            tuple(branches),
            tuple(variants),
        )
        parts += [RefinedPlan(*(getattr(c, field.name) for field in fields(c))) for c in programs]
    kept = max((search.most for search in searches.values()), default=0)
    return Plan_(catalogue, outputs, tuple(parts), tuple(branches), tuple(variants), kept)


def _not_refined(request: Request, catalogue: Catalogue) -> InputError:
    ends = [str(Reduced(Quantity(request.quantity), how)) for how in ("max", "min")]
    offered = " and ".join(name for name in ends if name not in catalogue.hiding)
    remedy = f"ask for {offered}" if offered else f"ask for {request.quantity}, and take extremes of the map"
    return InputError(
        f"quantity {request.name!r}: {request.quantity} of {catalogue.name} has no derivative by "
        f"{catalogue.position.name} here, so its extremes cannot be listed",
        remedy=remedy,
    )


def _over_curves(
    catalogue: Catalogue, outputs: tuple[Output, ...], given: Sequence[str], options: dict[str, Any]
) -> CurvePlan:
    """Return the plan of what is made of whole curves."""
    facts = tuple(catalogue.curves[output.name] for output in outputs)
    depends_on = dict.fromkeys(need for fact in facts for need in fact.depends_on)
    curves = make_plan(catalogue, depends_on, given=given, **options)
    same = {field.name: getattr(curves, field.name) for field in fields(curves)}
    return CurvePlan(
        **same | {"outputs": outputs, "steps": (*curves.steps, *facts)}, curves=curves, facts=facts
    )


def _split(plan: Plan, angles: int) -> list[Plan]:
    """Return the plans that together give a plan's results fastest: curves apart from the rest.

    With lanes that are designs a curve is stored across the lines of its array, 1 ns a value; with lanes that are
    angles it costs less to compute what both need again.
    """
    position = plan.catalogue.position.name
    curves = [output.name for output in plan.outputs if position in output.axes]
    rest = [output.name for output in plan.outputs if position not in output.axes]
    whole = (
        plan.lanes == "angles" or angles < ANGLES_FOR_LANES or any(isinstance(s, System) for s in plan.steps)
    )
    if whole or not curves or not rest:
        return [plan]
    options: dict[str, Any] = {"branches": plan.branches, "variants": plan.variants, "angles": angles}
    return [make_plan(plan.catalogue, names, given=plan.inputs, **options) for names in (curves, rest)]

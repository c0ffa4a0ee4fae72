"""What a sweep was asked for, resolved: designs, input positions, and the plans that give the results."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any

from fastlink.codegen.kernel import Kernel, kernel_of
from fastlink.engine.checks import Checked, check
from fastlink.engine.executor import Part
from fastlink.engine.scaling import ScalingAxis, find_scaling_axis
from fastlink.errors import InputError, Problem, Problems
from fastlink.plan.plan import Plan, make_plan
from fastlink.plan.pointwise import ANGLES_FOR_LANES
from fastlink.plan.query import Extrema, parse_request, with_lists
from fastlink.plan.reductions import REDUCTIONS
from fastlink.plan.validate import all_choices, constants_of
from fastlink.space.links import MODELS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.space.design_space import DesignSpace
    from fastlink.space.links import Links

__all__ = ["ResolvedSweep", "resolve"]


@dataclass(frozen=True, eq=False)
class ResolvedSweep:
    """A request to sweep that was found right.

    Attributes
    ----------
    mechanism : str
        Its name.
    catalogue : Catalogue
        The mechanism by what drives it.
    space : DesignSpace
        The designs, with every constant and choice.
    plan : PlanSet
        What is computed.
    branches : tuple of int
        Assembly modes.
    positions : array
        Input positions.
    solver : str
        How reactions are found; empty where nothing that is computed depends on it.
    scaling_axis : ScalingAxis or None
        The axis that only scales the results, if there is one.
    backend : str
        What compiles the kernels.
    """

    mechanism: str
    catalogue: Catalogue
    space: DesignSpace
    plan: Plan
    branches: tuple[int, ...]
    positions: NDArray[Any]
    solver: str
    scaling_axis: ScalingAxis | None
    backend: str

    @property
    def kernels(self) -> list[Kernel]:
        """The kernels of the plan's programs."""
        return [kernel_of(program) for program in self.plan.programs]

    @property
    def fingerprint(self) -> str:
        """What tells the numbers that result from all others: kernels, designs, input positions."""
        digest = hashlib.sha256()
        for kernel in self.kernels:
            digest.update(kernel.key.encode())
        space = self.space
        digest.update(repr((space.dims, space.shape, sorted(space.constants.items()))).encode())
        for name, values in sorted({**space.axes, **space.columns}.items()):
            digest.update(name.encode() + values.tobytes())
        digest.update(repr([self.branches, *(o.name for o in self.plan.outputs)]).encode())
        digest.update(self.positions.tobytes())
        return digest.hexdigest()

    @property
    def evaluated(self) -> DesignSpace:
        """The designs that kernels see."""
        return self.space if self.scaling_axis is None else self.scaling_axis.space

    def parts(self, *, relaxed: bool = False) -> list[Part]:
        """Return the kernels, compiled, with what they run on."""
        places = {output.name: place for place, output in enumerate(self.plan.outputs)}
        return [
            Part(
                kernel.compiled(self.backend, relaxed=relaxed),
                kernel.source.scratch,
                len(kernel.program.inputs),
                kernel.program.angle_tables(self.positions),
                tuple(places[output.name] for output in kernel.program.outputs),
                partial(self.evaluated.fill, kernel.program.inputs),
            )
            for kernel in self.kernels
        ]


def resolve(
    mechanism: str,
    space: DesignSpace,
    quantities: Sequence[str],
    *,
    links: Links | None = None,
    input: str | None = None,
    angles: Any = None,
    positions: Mapping[str, Any] | None = None,
    options: Iterable[str] = (),
    branch: int | Sequence[int] = (1, 2),
    solver: str = "eliminated",
    extrema: str | None = None,
    allow_invalid: bool = False,
    backend: str | None = None,
    companions: bool = True,
    called: str = "quantities",
) -> ResolvedSweep:
    """Check a request, and find what is to be computed; nothing is compiled.

    Parameters
    ----------
    positions : mapping of str to angles, optional
        Input positions that were given by the name of the input.
    options : iterable of str
        What else may be given by name, for a hint where a name is unknown.
    companions : bool
        Whether the status of each design comes along, and what belongs to a list of extremes.
    called : str
        The parameter that holds the quantities.
    mechanism, space, quantities, links, input, angles, branch, solver, extrema, allow_invalid, backend
        As in `fastlink.sweep`.

    Raises
    ------
    InputError
        Bad input; the message says what, where, and what to write instead.
    """
    checked = check(
        mechanism,
        space,
        quantities,
        links=links,
        input=input,
        angles=angles,
        positions=positions,
        options=options,
        branch=branch,
        solver=solver,
        extrema=extrema,
        allow_invalid=allow_invalid,
        backend=backend,
        companions=companions,
        called=called,
    )
    catalogue, variants = checked.catalogue, checked.variants
    space = space.with_constants(constants_of(catalogue, links, variants))
    for name, codes in all_choices(catalogue, space.names, variants).items():
        space = space.with_axis(name, codes)
    try:
        plan = cached_plan(
            catalogue,
            checked.names,
            companions,
            given=space.names,
            branches=checked.branches,
            variants=variants,
            angles=checked.positions.size,
            extrema=checked.extrema,
        )
    except InputError as error:
        raise (_faults(checked, space.names, called) or error) from None
    spread = find_scaling_axis(plan, space)
    used = solver if plan.depends_on_solver else ""
    return ResolvedSweep(
        mechanism, catalogue, space, plan, checked.branches, checked.positions, used, spread, checked.backend
    )


def missing_inputs(
    catalogue: Catalogue, names: Iterable[str], variants: Sequence[str], given: Iterable[str]
) -> list[Problem]:
    """Return each input that a quantity depends on and that nothing gives."""
    of_links = {name for model in MODELS for name in catalogue.variant_inputs.get(model, {})}
    known, has = catalogue.known_inputs(variants), set(given)
    absent = {name for name in known if name not in has and catalogue.resolve(name, variants) is None}
    tables = (catalogue.position.name, *catalogue.tables, *catalogue.table_low_parts)
    missing = []
    for request in (parse_request(name, catalogue) for name in names):
        steps = catalogue.dependencies([request.quantity], {*has, *absent, *tables, "branch"}, variants)
        needed = absent & {need for step in steps for need in step.depends_on}
        for name in (name for name in known if name in needed):
            absent.discard(name)
            has.add(name)
            table = "links" if name in of_links else "design"
            missing.append(catalogue.missing_message(known[name], request.name, table))
    return missing


def _faults(checked: Checked, given: Sequence[str], called: str) -> InputError | None:
    """Return what keeps each quantity from being computed: every input that is missing, once, or else its own fault."""
    catalogue, problems = checked.catalogue, Problems()
    for k, name in enumerate(checked.names):
        with problems.at(called, k):
            missing = missing_inputs(catalogue, [name], checked.variants, given)
            known = [one.where for one in problems.noted]
            problems.noted += [one for one in missing if one.where not in known]
            if not missing:
                make_plan(
                    catalogue,
                    [name],
                    given=given,
                    branches=checked.branches,
                    variants=checked.variants,
                    angles=checked.positions.size,
                    extrema=checked.extrema,
                )
    return InputError.of(problems.noted) if problems.noted else None


def cached_plan(
    catalogue: Catalogue,
    names: Sequence[str],
    companions: bool,
    *,
    given: Iterable[str],
    branches: tuple[int, ...],
    variants: tuple[str, ...],
    angles: int,
    extrema: Extrema,
) -> Plan:
    """Return what `make_plan` makes of a request, made once."""
    # the number of angles decides no more than what the lanes are
    lanes = min(angles, ANGLES_FOR_LANES)
    known = tuple(names), companions, frozenset(given), branches, variants, lanes, extrema
    return _plan(catalogue, (catalogue.version, *REDUCTIONS.values()), *known)


@lru_cache(maxsize=256)
def _plan(
    catalogue: Catalogue,
    version: tuple[Any, ...],
    names: tuple[str, ...],
    companions: bool,
    given: frozenset[str],
    branches: tuple[int, ...],
    variants: tuple[str, ...],
    angles: int,
    extrema: Extrema,
) -> Plan:
    return make_plan(
        catalogue,
        with_lists(catalogue, names) if companions else names,
        given=sorted(given),
        branches=branches,
        variants=variants,
        angles=angles,
        extrema=extrema,
    )

"""Resolve a request to sweep into its designs, input positions and plan."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.codegen.cache import environment
from fastlink.codegen.kernel import Kernel, kernel_of
from fastlink.engine.binding import KernelTask
from fastlink.engine.checks import CheckedRequest, check
from fastlink.engine.designs import designs_of, without
from fastlink.engine.executor import Job, Shapes
from fastlink.engine.scaling import ScalingAxis, find_scaling_axis
from fastlink.engine.sizes import UnitsOfDesigns
from fastlink.errors import InputError, KeyPath, Problem, Problems
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.mechanisms import name_of
from fastlink.options import check_path
from fastlink.own.catalogue import used
from fastlink.plan.plan import Plan, all_declared, make_plan
from fastlink.plan.pointwise import ANGLES_FOR_LANES
from fastlink.plan.positions import in_degrees
from fastlink.plan.query import Extrema, with_companions
from fastlink.plan.validate import all_choices, constants_of, joined_missing, missing_inputs
from fastlink.space.column import definition_of
from fastlink.space.dataset import CURVES
from fastlink.space.degrees import COMMENT
from fastlink.space.design_space import EXTREMUM
from fastlink.space.table import as_space

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.engine.extending import Extension
    from fastlink.own.definition import Definition
    from fastlink.space.design_space import DesignSpace

__all__ = ["ResolvedSweep", "axis_lengths", "cached_plan", "resolve"]


@dataclass(frozen=True, eq=False)
class ResolvedSweep:
    """A request to sweep whose every part was checked.

    Attributes
    ----------
    mechanism : str
        The name of the mechanism, whatever input drives it.
    space : DesignSpace
        The designs, with every constant and choice.
    plan : Plan
        What is computed.
    positions : array
        Input positions.
    solver : str
        How reactions are computed; empty where nothing that is computed depends on it.
    scaling_axis : ScalingAxis or None
        The axis that only scales the results, if there is one.
    backend : str
        What compiles the kernels.
    one_branch : bool
        Whether the assembly mode was given as a scalar, which makes it a coordinate instead of a dimension.
    layout : str
        How the results lie in a file, one of `fastlink.io.placement.LAYOUTS`.
    """

    mechanism: str
    space: DesignSpace
    plan: Plan
    positions: NDArray[Any]
    solver: str
    scaling_axis: ScalingAxis | None
    backend: str
    one_branch: bool
    layout: str = CURVES

    @property
    def catalogue(self) -> Catalogue:
        """The mechanism, as driven by the input."""
        return self.plan.catalogue

    @property
    def branches(self) -> tuple[int, ...]:
        """The assembly modes."""
        return self.plan.branches

    @property
    def evaluated(self) -> DesignSpace:
        """The designs that kernels see: an axis that only scales results is left out."""
        return self.space if self.scaling_axis is None else self.scaling_axis.space

    @property
    def kernels(self) -> list[Kernel]:
        """The kernels of the plan's programs."""
        return [kernel_of(program) for program in self.plan.programs]

    @property
    def lengths(self) -> dict[str, int]:
        """The length of each axis that a result may have besides the design."""
        return axis_lengths(self.plan, self.positions.size)

    @property
    def shapes(self) -> Shapes:
        """The shape of each result of one design, and its dtype."""
        lengths = self.lengths
        return [(tuple(lengths[axis] for axis in o.axes), o.dtype) for o in self.plan.outputs]

    @property
    def declared(self) -> Definition:
        """The declarations of a user on which what is computed depends."""
        steps = (step for program in self.plan.programs for step in program.steps)
        inputs = (name for program in self.plan.programs for name in program.inputs)
        return used(self.catalogue, steps, inputs)

    @cached_property
    def fingerprint(self) -> str:
        """A hash of all that the numbers depend on: kernels, designs, input positions; the same on any machine."""
        digest = _of_kernels(self.kernels)
        space = self.space
        texts = sorted(space.attrs.items()), sorted(space.comments.items())
        described = space.dims, space.shape, sorted(space.constants.items()), texts
        digest.update(repr(described).encode())
        for name, values in sorted({**space.axes, **space.columns}.items()):
            digest.update(repr((name, definition_of(values))).encode())
        for name, label in sorted(space.labels.items()):
            digest.update(repr((name, definition_of(label))).encode())
        digest.update(repr([self.branches, *(o.name for o in self.plan.outputs)]).encode())
        digest.update(self.positions.tobytes())
        if declared := self.declared:
            digest.update(repr(declared).encode())
        return digest.hexdigest()

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"kernel_digest": _of_kernels(self.kernels).digest()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        digest = state.pop("kernel_digest")
        self.__dict__.update(state)
        if digest != _of_kernels(self.kernels).digest():
            what = f"this sweep of {self.mechanism} was made by another version of fastlink, or with other declarations"
            remedy = "use the same version, and import the modules that declare quantities, on both sides"
            raise InputError(what, remedy=remedy)

    def places(self, kernel: Kernel) -> float:
        """Return how many places a kernel evaluates; see `Kernel.compiled`."""
        return kernel.places(self.evaluated.size, self.positions.size)

    def job(self, runs: float = 1) -> Job:
        """Return the compiled kernels with the designs and positions that they run on.

        Parameters
        ----------
        runs : float
            How often all designs are evaluated.
        """
        names = [output.name for output in self.plan.outputs]
        tasks = [
            KernelTask(
                kernel.source,
                kernel.program.inputs,
                self.backend,
                kernel.compiled(self.backend, runs * self.places(kernel)),
                kernel.program.angle_tables(self.positions),
                tuple(names.index(output.name) for output in kernel.program.outputs),
                partial(self.evaluated.fill, kernel.program.inputs),
            )
            for kernel in self.kernels
        ]
        return Job(tasks, self.shapes, self.evaluated.size, UnitsOfDesigns.of(self.plan, self.evaluated))


def _of_kernels(kernels: Iterable[Kernel]) -> hashlib._Hash:
    """Return a hash of the texts of kernels, and of what compiles and runs them."""
    digest = hashlib.sha256(environment())
    for kernel in kernels:
        digest.update(kernel.text.encode())
    return digest


def axis_lengths(plan: Plan, positions: int) -> dict[str, int]:
    """Return the length of each axis that a result may have besides the design."""
    return {
        "branch": len(plan.branches),
        plan.catalogue.position.name: positions,
        EXTREMUM: plan.extrema_kept,
    }


def resolve(
    mechanism: str | Extension,
    space: Any,
    quantities: Sequence[str],
    *,
    companions: bool = True,
    parameter: str = "quantities",
    **options: Any,
) -> ResolvedSweep:
    """Check a request and plan it; nothing is compiled.

    Parameters
    ----------
    mechanism, space, quantities
        As in `fastlink.sweep`.
    companions : bool
        Whether to add the status of each design, and what belongs to a list of extremes.
    parameter : str
        The parameter that holds the quantities.
    **options
        Of `fastlink.engine.checks.check`.

    Raises
    ------
    InputError
        Bad input; the message says what, where, and what to write instead.
    """
    problems, designs = Problems(), None
    catalogue = find_catalogue(mechanism, options.get("input"))
    with problems.at():
        given = _space_of(space, bool(options.get("allow_invalid")))
        designs = designs_of(catalogue, given, options.get("links"), problems)
    with problems.at():
        checked = check(mechanism, designs, quantities, companions=companions, parameter=parameter, **options)
    problems.stop()
    assert designs is not None
    if in_degrees(catalogue, options.get("angles"), options.get("positions") or {}):
        designs = replace(designs, comments={**designs.comments, catalogue.position.name: COMMENT})
    space, variants = designs, checked.variants
    space = space.with_constants(constants_of(catalogue, checked.links, variants))
    for name, codes in all_choices(catalogue, space.names, variants).items():
        space = space.with_axis(name, codes)
    planning: dict[str, Any] = {
        "given": space.names,
        "branches": checked.branches,
        "variants": variants,
        "angles": checked.positions.size,
        "extrema": checked.extrema,
    }
    try:
        plan = cached_plan(catalogue, checked.names, companions, declared=checked.declared, **planning)
    except InputError as error:
        raise (_problem_of_each(checked, planning, parameter) or error) from None
    space = _without_unread(space, plan)
    axis = find_scaling_axis(plan, space) if UnitsOfDesigns.of(plan, space).ordinary else None
    solver = checked.solver if plan.depends_on_solver else ""
    one_branch = np.ndim(options.get("branch", checked.branches)) == 0
    mechanism, ways = name_of(mechanism), (checked.backend, one_branch)
    return ResolvedSweep(mechanism, space, plan, checked.positions, solver, axis, *ways)


def _without_unread(space: DesignSpace, plan: Plan) -> DesignSpace:
    """Return designs without the default values of a user's inputs that nothing computed depends on."""
    if not plan.catalogue.definition:
        return space
    own = {one.name for one in plan.catalogue.definition if getattr(one, "default", None) is not None}
    read = {name for program in plan.programs for name in program.inputs}
    return without(space, own.intersection(space.constants) - read)


def _space_of(space: Any, allow_invalid: bool) -> DesignSpace:
    """Return the designs that a caller gives, see `as_space`; those of a map by the path of its file too."""
    if isinstance(space, (str, os.PathLike)):
        from fastlink.io.reader import is_hdf5, open_map  # which imports xarray

        path = check_path(("space",), space, "designs.csv")
        if path.is_file() and is_hdf5(path):
            with open_map(path) as maps:
                return as_space(maps, allow_invalid=allow_invalid)
    return as_space(space, allow_invalid=allow_invalid)


def _problem_of_each(
    checked: CheckedRequest, planning: Mapping[str, Any], parameter: str
) -> InputError | None:
    """Return every missing input, once, and the other problems of each quantity."""
    catalogue, problems = checked.catalogue, Problems()
    missing: dict[KeyPath, Problem] = {}
    for k, name in enumerate(checked.names):
        with problems.at(parameter, k):
            absent = missing_inputs(catalogue, name, checked.variants, planning["given"])
            missing |= {one.where: one for one in absent if one.where not in missing}
            if not absent:
                make_plan(catalogue, [name], **planning)
    noted = [*joined_missing(missing.values()), *problems.noted]
    return InputError.of(noted) if noted else None


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
    declared: tuple[Any, ...] | None = None,
) -> Plan:
    """Return the plan that `make_plan` makes, once; `companions` as in `resolve`."""
    return _plan(
        catalogue,
        declared or all_declared(catalogue),
        tuple(names),
        companions,
        given=tuple(sorted(given)),
        branches=branches,
        variants=variants,
        angles=min(angles, ANGLES_FOR_LANES),  # their number decides no more than what the lanes are
        extrema=extrema,
    )


@lru_cache(maxsize=256)
def _plan(
    catalogue: Catalogue, declared: tuple[Any, ...], names: tuple[str, ...], companions: bool, **options: Any
) -> Plan:
    return make_plan(catalogue, with_companions(catalogue, names) if companions else names, **options)

"""Resolve a request to sweep into its designs, input positions and plan."""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import short_repr
from fastlink.codegen.cache import environment
from fastlink.codegen.kernel import Kernel, backend_of, kernel_of
from fastlink.engine.designs import designs_of, without
from fastlink.engine.run import Job, KernelTask, Shapes
from fastlink.engine.scaling import FarDesigns, ScalingAxis, find_scaling_axis
from fastlink.errors import InputError, KeyPath, Problem, Problems, check_path
from fastlink.facts.arc import ARC, ARC_ENDS
from fastlink.facts.catalogue import ELIMINATED, Catalogue
from fastlink.facts.derivative import is_tolerance, tolerance_name
from fastlink.facts.own import Definition, used
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.mechanisms import name_of
from fastlink.plan import request
from fastlink.plan.programs import ANGLES_FOR_LANES, Plan, all_declared, make_plan
from fastlink.plan.query import check_names, parse_request, with_companions
from fastlink.space.design_space import EXTREMUM, definition_of, in_unit, numbers_of
from fastlink.space.tables import CURVES, as_space
from fastlink.space.units import check_unit, comment, in_words, named_with_unit, scaled, split

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.engine.extend import Extension
    from fastlink.space.design_space import DesignSpace, Links


# -- Check a request part by part, so that all its problems are reported together


#: The options that decide what is computed, at every door.
OF_REQUEST = (
    *("links", "input", "angles", "branch", "positions", "allow_invalid"),
    *("solver", "extrema", "backend"),
)


def of_request(call: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options of a call that decide what is computed."""
    return {name: call[name] for name in OF_REQUEST if name in call}


def check(
    mechanism: str | Extension,
    space: DesignSpace | None,
    quantities: Sequence[str],
    *,
    links: Links | None = None,
    input: str | None = None,
    angles: Any = None,
    positions: Mapping[str, Any] | None = None,
    options: Iterable[str] = (),
    branch: int | Sequence[int] = 1,
    solver: str = ELIMINATED,
    extrema: str | None = None,
    allow_invalid: bool = False,
    backend: str | None = None,
    companions: bool = True,
) -> tuple[Any, ...]:
    """Check each part of a request; all problems are raised together.

    Return the names of all results, variants, branches, input positions, how extremes are found, the compiler, and the
    unit in which positions were given, if not that of SI.
    """
    catalogue, problems = find_catalogue(mechanism, input), Problems()
    names: tuple[str, ...] = ()
    with problems.at():
        names = check_names("quantities", quantities)
        _check_quantities(catalogue, names)
        names = names if "status" in names or not companions else (*names, "status")
    problems.attempt(request.check_model, catalogue, links, solver)
    variants = request.selected_variants(catalogue, links, solver, () if space is None else space.names)
    if space is not None:
        problems.attempt(request.check_inputs, catalogue, space, variants, allow_invalid)
        if ARC in variants and not problems.noted:
            problems.attempt(request.check_arcs, space, allow_invalid)
    branches = problems.attempt(request.check_branches, catalogue, branch)
    problems.attempt(request.check_keywords, mechanism, catalogue, positions or (), options)
    with problems.at():
        key, given = request.given_angles(catalogue, angles, positions or {})
        values = request.check_positions(catalogue, given, key)
        if not problems.noted:
            request.check_turn(catalogue, names, given)
        if space is not None and ARC in variants and not problems.noted:
            values = request.positions_of_arc(catalogue, space, given, key, names)
        method = request.check_extrema(extrema, catalogue, given, () if problems.noted else names)
    compiler = problems.attempt(backend_of, backend)
    problems.stop()
    unit = split(key, (catalogue.position.name,))[1]
    return names, variants, branches, values, method, compiler, unit


@lru_cache(maxsize=256)
def _check_quantities(catalogue: Catalogue, names: tuple[str, ...]) -> None:
    """Refuse unknown quantities; checked once, since it takes longer than all other checks together (0.15 ms)."""
    # what is declared later takes no name away, and what was refused is looked at again
    problems = Problems()
    for k, name in enumerate(names):
        with problems.at("quantities", k):
            parse_request(name, catalogue)
    problems.stop()


@dataclass(frozen=True, eq=False)
class ResolvedSweep:
    """A request to sweep whose every part was checked."""

    #: The name of the mechanism, whatever input drives it.
    mechanism: str
    #: The designs, with every constant and choice.
    space: DesignSpace
    #: What is computed.
    plan: Plan
    #: Input positions.
    positions: NDArray[Any]
    #: How reactions are computed; empty where nothing that is computed depends on it.
    solver: str
    #: The axis that only scales the results, if there is one.
    scaling_axis: ScalingAxis | None
    #: What compiles the kernels.
    backend: str
    #: Whether the branch was given as a scalar, which makes it a coordinate instead of a dimension.
    one_branch: bool
    #: How the results lie in a file, one of `fastlink.io.layout.LAYOUTS`.
    layout: str = CURVES

    @property
    def size(self) -> int:
        """The number of designs."""
        return self.space.size

    @property
    def catalogue(self) -> Catalogue:
        """The mechanism, as driven by the input."""
        return self.plan.catalogue

    @property
    def branches(self) -> tuple[int, ...]:
        """The branches."""
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
        plan, position = self.plan, self.catalogue.position.name
        return {"branch": len(plan.branches), position: self.positions.size, EXTREMUM: plan.extrema_kept}

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
        """Return the compiled kernels with the designs and positions that they run on."""
        names = [output.name for output in self.plan.outputs]

        def task(kernel: Kernel) -> KernelTask:
            code = kernel.compiled(self.backend, runs * self.places(kernel))
            inputs, results = kernel.program.inputs, kernel.program.outputs
            numbers = tuple(names.index(output.name) for output in results)
            data = kernel.program.angle_tables(self.positions), numbers, partial(self.evaluated.fill, inputs)
            return KernelTask(kernel.source, inputs, self.backend, code, *data)

        tasks = [task(kernel) for kernel in self.kernels]
        return Job(tasks, self.shapes, self.evaluated.size, FarDesigns.of(self.plan, self.evaluated))


def _of_kernels(kernels: Iterable[Kernel]) -> hashlib._Hash:
    """Return a hash of the texts of kernels, and of what compiles and runs them."""
    digest = hashlib.sha256(environment())
    for kernel in kernels:
        digest.update(kernel.text.encode())
    return digest


def resolve(
    mechanism: str | Extension,
    space: Any,
    quantities: Sequence[str],
    *,
    companions: bool = True,
    **options: Any,
) -> ResolvedSweep:
    """Check a request and plan it; nothing is compiled."""
    problems, designs = Problems(), None
    catalogue = find_catalogue(mechanism, options.get("input"))
    with problems.at():
        allowed = bool(options.get("allow_invalid"))
        given = _space_of(space, allowed)
        designs = designs_of(catalogue, given, options.get("links"), problems, allowed)
    named: dict[str, Any] = {"companions": companions, **options}
    checked = problems.attempt(check, mechanism, designs, quantities, **named)
    problems.stop()
    assert designs is not None
    assert checked is not None
    names, variants, branches, angles, extrema, backend, unit = checked
    if unit:
        comments = {**designs.comments, catalogue.position.name: comment(unit)}
        designs = replace(designs, comments=comments)
    space = designs.with_constants(request.constants_of(catalogue, options.get("links"), variants))
    for name, codes in request.all_choices(catalogue, space.names, variants).items():
        space = space.with_axis(name, codes)
    planning: dict[str, Any] = {"given": space.names, "branches": branches, "variants": variants}
    planning |= {"angles": angles.size, "extrema": extrema}
    try:
        plan = cached_plan(catalogue, names, companions, **planning)
    except InputError as error:
        raise (_problem_of_each(catalogue, names, planning) or error) from None
    if catalogue.definition:  # default values of a user's inputs that nothing computed depends on
        own = {one.name for one in catalogue.definition if getattr(one, "default", None) is not None}
        read = {name for program in plan.programs for name in program.inputs}
        space = without(space, own.intersection(space.constants) - read)
    axis = find_scaling_axis(plan, space)
    solver = options.get("solver", ELIMINATED) if plan.depends_on_solver else ""
    one_branch = np.ndim(options.get("branch", 1)) == 0
    return ResolvedSweep(name_of(mechanism), space, plan, angles, solver, axis, backend, one_branch)


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
    catalogue: Catalogue, names: Sequence[str], planning: Mapping[str, Any]
) -> InputError | None:
    """Return every missing input, once, and the other problems of each quantity."""
    problems, missing = Problems(), dict[KeyPath, Problem]()
    for k, name in enumerate(names):
        with problems.at("quantities", k):
            absent = request.missing_inputs(catalogue, name, planning["variants"], planning["given"])
            missing |= {one.where: one for one in absent if one.where not in missing}
            if not absent:
                make_plan(catalogue, [name], **planning)
    noted = [*request.joined_missing(missing.values()), *problems.noted]
    return InputError.of(noted) if noted else None


def cached_plan(
    catalogue: Catalogue,
    names: Sequence[str],
    companions: bool,
    *,
    given: Iterable[str],
    angles: int,
    **planning: Any,
) -> Plan:
    """Return the plan that `make_plan` makes, once; `companions` as in `resolve`."""
    # the number of angles decides no more than what the lanes are
    planning |= {"given": tuple(sorted(given)), "angles": min(angles, ANGLES_FOR_LANES)}
    return _plan(catalogue, all_declared(catalogue), tuple(names), companions, **planning)


@lru_cache(maxsize=256)
def _plan(
    catalogue: Catalogue, declared: tuple[Any, ...], names: tuple[str, ...], companions: bool, **options: Any
) -> Plan:
    return make_plan(catalogue, with_companions(catalogue, names) if companions else names, **options)


# -- Read tolerances of inputs as callers and studies give them: in the units of the inputs, or in per cent


def given_tolerances(
    catalogue: Catalogue, tolerances: Mapping[str, Any], parent: str, problems: Problems
) -> dict[str, float]:
    """Return tolerances by the names that they have in a design: numbers, or texts in per cent."""
    known = {name: one for name, one in catalogue.all_inputs.items() if not is_tolerance(name)}
    known[catalogue.position.name] = catalogue.position
    found: dict[str, float] = {}
    others = {name: name for name in tolerances}
    for name, value in tolerances.items():
        of, unit = split(name, known)
        if of not in known:
            problems.noted.append(request.unknown_input(catalogue, name, known, parent))
        elif known[of].choices or of in ARC_ENDS:
            what = "a code" if known[of].choices else "an end of an arc, by which there is no derivative"
            problems.add(f"is {what}, and has no tolerance", (parent, name), "leave it out")
        else:
            with problems.at(parent, name):
                units = known[of].units
                factor = check_unit(of, unit, units, others)
                share, number = _tolerance((parent, name), value, unit or units, is_in_unit=bool(unit))
                found[tolerance_name(of, relative=share)] = float(scaled(number, factor))
    return found


def _tolerance(where: tuple[str, str], value: Any, units: str, *, is_in_unit: bool) -> tuple[bool, float]:
    """Return whether a tolerance is a share, as one in per cent is, and its number."""
    remedy = f"write a number of at least 0{'' if units == '1' else f' in {in_words(units)}'}"
    remedy += "" if is_in_unit else ', or a text such as "0.1 %"'
    if share := isinstance(value, str):
        number = None if is_in_unit else _percent(value)
    else:
        numbers = in_unit(where, value, numbers_of(*where, value), units)
        number = float(numbers) if numbers.ndim == 0 else None
    if number is None or not 0.0 <= number < math.inf:
        raise InputError(f"is {short_repr(value)}", where, named_with_unit(where[1], value) or remedy)
    return share, number


def _percent(text: str) -> float | None:
    """Return the share that a text in per cent means, None for another text."""
    number, sign, rest = text.partition("%")
    try:
        return float(number) / 100.0 if sign and not rest.strip() else None
    except ValueError:
        return None

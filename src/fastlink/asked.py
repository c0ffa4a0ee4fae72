"""What a sweep was asked for, resolved: designs, input positions, and the plans that give the results."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any

from fastlink.codegen.kernel import backend_of
from fastlink.cycle import Extrema, parse_request, with_lists
from fastlink.errors import InputError, Problems
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan import ANGLES_FOR_LANES
from fastlink.plans import PlanSet, make_plans
from fastlink.reductions import REDUCTIONS
from fastlink.request import (
    all_choices,
    check_branches,
    check_extrema,
    check_inputs,
    check_keywords,
    check_model,
    check_positions,
    check_turn,
    chosen_sets,
    constants_of,
    given_angles,
    missing_inputs,
)
from fastlink.run import Part
from fastlink.spread import Spread, find_spread

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from fastlink.catalogue import Catalogue
    from fastlink.links import Links
    from fastlink.space import DesignSpace

__all__ = ["Asked", "check", "check_names", "resolve"]


@dataclass(frozen=True, eq=False)
class Asked:
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
    spread : Spread or None
        The axis that only scales the results, if there is one.
    backend : str
        What compiles the kernels.
    """

    mechanism: str
    catalogue: Catalogue
    space: DesignSpace
    plan: PlanSet
    branches: tuple[int, ...]
    positions: NDArray[Any]
    solver: str
    spread: Spread | None
    backend: str

    @property
    def fingerprint(self) -> str:
        """What tells the numbers that result from all others: kernels, designs, input positions."""
        digest = hashlib.sha256()
        for part in self.plan.parts:
            digest.update(part.key.encode())
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
        return self.space if self.spread is None else self.spread.space

    def parts(self, *, relaxed: bool = False) -> list[Part]:
        """Return the kernels, compiled, with what they run on."""
        places = {output.name: place for place, output in enumerate(self.plan.outputs)}
        return [
            Part(
                part.compiled(self.backend, relaxed=relaxed),
                part.written.scratch,
                len(part.inputs),
                part.angle_tables(self.positions),
                tuple(places[output.name] for output in part.outputs),
                partial(self.evaluated.fill, part.inputs),
            )
            for part in self.plan.parts
        ]


@dataclass(frozen=True, eq=False)
class Checked:
    """A request whose parts were each found right.

    Attributes
    ----------
    catalogue : Catalogue
        The mechanism by the input that drives it.
    names : tuple of str
        The quantities.
    alternatives : tuple of str
        The chosen sets of facts.
    branches : tuple of int
        Assembly modes.
    positions : array
        Input positions.
    extrema : {"refined", "sampled"}
        How extremes are found.
    backend : str
        What compiles the kernels.
    """

    catalogue: Catalogue
    names: tuple[str, ...]
    alternatives: tuple[str, ...]
    branches: tuple[int, ...]
    positions: NDArray[Any]
    extrema: Extrema
    backend: str


def check(
    mechanism: str,
    space: DesignSpace | None,
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
) -> Checked:
    """Check each part of a request; all that is wrong is raised together.

    Parameters
    ----------
    space : DesignSpace or None
        The designs; None leaves them unchecked.
    called : str
        The parameter that holds the quantities.
    mechanism, quantities, links, input, angles, positions, options, branch, solver, extrema
        As in `resolve`.
    allow_invalid, backend, companions
        As in `resolve`.

    Raises
    ------
    InputError
        With every problem; an unknown mechanism or input is the only one.
    """
    catalogue, problems = find_catalogue(mechanism, input), Problems()
    names: tuple[str, ...] = ()
    with problems.at():
        names = check_names(called, quantities)
        for k, name in enumerate(names):
            with problems.at(called, k):
                parse_request(name, catalogue)
        names = names if "status" in names or not companions else (*names, "status")
    with problems.at():
        check_model(catalogue, links, solver)
    alternatives = chosen_sets(catalogue, links, solver, () if space is None else space.names)
    if space is not None:
        with problems.at():
            check_inputs(catalogue, space, alternatives, allow_invalid)
    with problems.at():
        branches = check_branches(catalogue, branch)
    with problems.at():
        check_keywords(mechanism, catalogue, positions or (), options)
    with problems.at():
        key, given = given_angles(catalogue, angles, positions or {})
        values = check_positions(catalogue, given, key)
        if not problems.noted:
            check_turn(catalogue, names, given)
        way = check_extrema(extrema, catalogue, given)
    with problems.at():
        compiler = backend_of(backend)
    problems.stop()
    return Checked(catalogue, names, alternatives, branches, values, way, compiler)


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
) -> Asked:
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
    catalogue, alternatives = checked.catalogue, checked.alternatives
    space = space.with_constants(constants_of(catalogue, links, alternatives))
    for name, codes in all_choices(catalogue, space.names, alternatives).items():
        space = space.with_axis(name, codes)
    try:
        plan = plans_of(
            catalogue,
            checked.names,
            companions,
            given=space.names,
            branches=checked.branches,
            alternatives=alternatives,
            angles=checked.positions.size,
            extrema=checked.extrema,
        )
    except InputError as error:
        raise (_faults(checked, space.names, called) or error) from None
    spread = find_spread(plan, space)
    used = solver if plan.depends_on_solver else ""
    return Asked(
        mechanism, catalogue, space, plan, checked.branches, checked.positions, used, spread, checked.backend
    )


def _faults(checked: Checked, given: Sequence[str], called: str) -> InputError | None:
    """Return what keeps each quantity from being computed: every input that is missing, once, or else its own fault."""
    catalogue, problems = checked.catalogue, Problems()
    for k, name in enumerate(checked.names):
        with problems.at(called, k):
            missing = missing_inputs(catalogue, [name], checked.alternatives, given)
            known = [one.where for one in problems.noted]
            problems.noted += [one for one in missing if one.where not in known]
            if not missing:
                make_plans(
                    catalogue,
                    [name],
                    given=given,
                    branches=checked.branches,
                    alternatives=checked.alternatives,
                    angles=checked.positions.size,
                    extrema=checked.extrema,
                )
    return InputError.of(problems.noted) if problems.noted else None


def plans_of(
    catalogue: Catalogue,
    names: Sequence[str],
    companions: bool,
    *,
    given: Iterable[str],
    branches: tuple[int, ...],
    alternatives: tuple[str, ...],
    angles: int,
    extrema: Extrema,
) -> PlanSet:
    """Return what `make_plans` makes of a request, made once."""
    # the number of angles decides no more than what the lanes are
    lanes = min(angles, ANGLES_FOR_LANES)
    known = tuple(names), companions, frozenset(given), branches, alternatives, lanes, extrema
    return _plans(catalogue, (catalogue.version, *REDUCTIONS.values()), *known)


@lru_cache(maxsize=256)
def _plans(
    catalogue: Catalogue,
    version: tuple[Any, ...],
    names: tuple[str, ...],
    companions: bool,
    given: frozenset[str],
    branches: tuple[int, ...],
    alternatives: tuple[str, ...],
    angles: int,
    extrema: Extrema,
) -> PlanSet:
    return make_plans(
        catalogue,
        with_lists(catalogue, names) if companions else names,
        given=sorted(given),
        branches=branches,
        alternatives=alternatives,
        angles=angles,
        extrema=extrema,
    )


def check_names(called: str, given: Sequence[str]) -> tuple[str, ...]:
    """Return the names of a list, each of which is there once.

    Parameters
    ----------
    called : str
        The parameter that holds them.
    given : sequence of str
        The names.

    Raises
    ------
    InputError
        It is one text, or empty, or a name stands twice.
    """
    if isinstance(given, str):
        raise InputError(f"is one text, {given!r}", where=(called,), remedy=f"write a list: [{given!r}]")
    names = tuple(given)
    if not names:
        raise InputError("is empty", where=(called,), remedy="write at least one name")
    problems = Problems()
    for k, name in enumerate(names):
        if name in names[:k]:
            problems.add(f"{name!r} is named twice", (called, k), "name it once")
    problems.stop()
    return names

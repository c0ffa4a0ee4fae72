"""A request checked part by part, so that all that is wrong with it is told at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fastlink.codegen.kernel import backend_of
from fastlink.errors import InputError, Problems
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.query import Extrema, parse_request
from fastlink.plan.validate import (
    check_branches,
    check_extrema,
    check_inputs,
    check_keywords,
    check_model,
    check_positions,
    check_turn,
    chosen_sets,
    given_angles,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.space.design_space import DesignSpace
    from fastlink.space.links import Links

__all__ = ["Checked", "check", "check_names"]


@dataclass(frozen=True, eq=False)
class Checked:
    """A request whose parts were each found right.

    Attributes
    ----------
    catalogue : Catalogue
        The mechanism by the input that drives it.
    names : tuple of str
        The quantities.
    variants : tuple of str
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
    variants: tuple[str, ...]
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
    variants = chosen_sets(catalogue, links, solver, () if space is None else space.names)
    if space is not None:
        with problems.at():
            check_inputs(catalogue, space, variants, allow_invalid)
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
    return Checked(catalogue, names, variants, branches, values, way, compiler)


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

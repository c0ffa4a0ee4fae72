"""Programs of values at given input positions and of their reductions.

A fact that depends on the design alone is computed once per design; a fact of the input position alone, once per
position; a fact that does not depend on the branch, once for both branches.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from fastlink.catalogue.catalogue import Catalogue, System
from fastlink.plan.gradients import check_sampled
from fastlink.plan.program import Lanes, Output, Program
from fastlink.plan.query import Request, parse_request
from fastlink.plan.toggles import counted_by, toggles_of
from fastlink.space.design_space import BRANCH, EXTREMUM
from fastlink.symbolic.changes import Term

__all__ = ["ANGLES_FOR_LANES", "make_program", "output_of", "pointwise_programs", "terms_of"]

# Fewer angles than this leave vector lanes idle when lanes are angles.
ANGLES_FOR_LANES = 32


def make_program(
    catalogue: Catalogue,
    names: Iterable[str],
    *,
    given: Iterable[str],
    branches: Sequence[int] = (1, 2),
    variants: Sequence[str] = (),
    angles: int = 360,
    lanes: Lanes | None = None,
    whole_turn: bool = False,
) -> Program:
    """Resolve requested names into one program.

    Parameters
    ----------
    catalogue : Catalogue
        The mechanism.
    names : iterable of str
        Quantities or their reductions over the cycle.
    given : iterable of str
        The inputs that the design space gives.
    branches : sequence of int
        Assembly modes.
    variants : sequence of str
        Selected variants, such as ``"round_bar"`` or ``"dense"``.
    angles : int
        Number of input positions: decides, with the request, what the lanes are.
    lanes : {"designs", "angles"}, optional
        Force one; both give the same bits.
    whole_turn : bool
        Whether reductions are integrals over the turn, which may not exist, or means of samples.

    Raises
    ------
    InputError
        A name is unknown, or an input that a fact depends on is not given.
    """
    requests = [parse_request(name, catalogue) for name in names]
    position = catalogue.position.name
    tables = (position, *catalogue.tables, *catalogue.table_low_parts)
    leaves = (*given, *tables, "branch")
    check_sampled(requests, catalogue)
    met = {r.name: toggles_of(catalogue, r, given, variants) if whole_turn else () for r in requests}
    needed = [request.quantity for request in requests] + [
        name for toggles in met.values() for name in toggles
    ]
    outputs = tuple(
        output_of(
            r,
            catalogue,
            toggles=met[r.name],
            counted=counted_by(catalogue, r, given, variants),
            terms=terms_of(r, catalogue, given, variants),
        )
        for r in requests
    )
    needed += [name for o in outputs for name in (*o.slopes, *(term.tolerance for term in o.terms))]
    needed += [output.counted for output in outputs if output.counted]
    steps = tuple(catalogue.dependencies(dict.fromkeys(needed), leaves, variants))
    read = {need for step in steps for need in step.depends_on}
    read_tables = tuple(name for name in tables if name in read)
    if any(request.is_position for request in requests) and position not in read_tables:
        read_tables = (position, *read_tables)
    has_cycle = any(request.reduction for request in requests)
    has_system = any(isinstance(step, System) for step in steps)
    if lanes is None:
        lanes = (
            "designs" if has_cycle or has_system or angles < ANGLES_FOR_LANES or not read_tables else "angles"
        )
    # In the catalogue's order, so that one set of names has one kernel however the design is written.
    inputs = tuple(name for name in catalogue.known_inputs(variants) if name in read and name in leaves)
    return Program(
        catalogue=catalogue,
        outputs=outputs,
        steps=steps,
        inputs=inputs,
        branches=tuple(branches),
        variants=tuple(variants),
        tables=read_tables,
        lanes=lanes,
    )


def pointwise_programs(
    catalogue: Catalogue, names: Sequence[str], angles: int, *, given: Iterable[str], **options: Any
) -> list[Program]:
    """Return the programs that together give some results fastest: curves apart from the rest.

    With lanes that are designs a curve is stored across the lines of its array, 1 ns a value; with lanes that are
    angles it costs less to compute the shared facts again.
    """
    program = make_program(catalogue, names, given=given, angles=angles, **options)
    position = catalogue.position.name
    curves = [output.name for output in program.outputs if position in output.axes]
    others = [output.name for output in program.outputs if position not in output.axes]
    has_system = any(isinstance(step, System) for step in program.steps)
    if has_system or program.lanes == "angles" or angles < ANGLES_FOR_LANES or not curves or not others:
        return [program]
    return [
        make_program(catalogue, part, given=program.inputs, angles=angles, **options)
        for part in (curves, others)
    ]


def output_of(
    request: Request,
    catalogue: Catalogue,
    *,
    refined: bool = False,
    toggles: tuple[str, ...] = (),
    counted: str = "",
    terms: tuple[Term, ...] = (),
) -> Output:
    """Return the result of a request."""
    fact = catalogue.public_fact(request.quantity)
    axes: tuple[str, ...] = (BRANCH,)
    if not catalogue.varies(fact.name):
        axes = ()
    elif request.listed and request.listed != "count":
        axes = (BRANCH, EXTREMUM)
    elif not request.listed and request.reduction is None:
        axes = (BRANCH, catalogue.position.name)
    is_code = (bool(fact.flags) and request.is_of_quantity) or request.listed in ("count", "kind")
    is_code = is_code or request.is_status
    return Output(request, axes, "int8" if is_code else "float64", refined, toggles, counted, terms)


def terms_of(
    request: Request,
    catalogue: Catalogue,
    given: Iterable[str],
    variants: Sequence[str],
    *,
    refined: bool = False,
) -> tuple[Term, ...]:
    """Return the terms of a change of a reduction by tolerances, none of another request."""
    if not request.change:
        return ()
    return catalogue.change_terms(request.quantity, variants, given, over_cycle=True, at_limits=refined)

"""Asked names to one compiled kernel: the closure of facts, each value where it is cheapest.

A fact that depends on the design alone is computed once per design; what depends on the input angle
alone, once per angle; what does not depend on the branch, once for both branches. The kernel's text is a
straight-line loop over lanes (see `fastlink.codegen`), to be read with ``plan.source``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from fastlink.catalogue.catalogue import Catalogue, System
from fastlink.errors import InputError
from fastlink.plan.program import EXTREMUM, Lanes, Output, Program
from fastlink.plan.query import Request, parse_request

__all__ = ["ANGLES_FOR_LANES", "make_program", "output_of", "parse_requests"]

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
) -> Program:
    """Resolve the asked names into a plan.

    Parameters
    ----------
    catalogue : Catalogue
        The mechanism.
    names : iterable of str
        Quantities or what is taken of them over the cycle.
    given : iterable of str
        The inputs that the design space gives.
    branches : sequence of int
        Assembly modes.
    variants : sequence of str
        Chosen sets of facts, such as ``"round_bar"`` or ``"dense"``.
    angles : int
        Number of input positions: decides, with what is asked, what the lanes are.
    lanes : {"designs", "angles"}, optional
        Force one; both give the same bits.

    Raises
    ------
    InputError
        A name is unknown or asked twice, or an input that the closure needs is not given.
    """
    requests = parse_requests(names, catalogue)
    position = catalogue.position.name
    tables = (position, *catalogue.tables, *catalogue.table_low_parts)
    leaves = (*given, *tables, "branch")
    steps = tuple(catalogue.dependencies([request.quantity for request in requests], leaves, variants))
    read = {need for step in steps for need in step.depends_on}
    read_tables = tuple(name for name in tables if name in read)
    if any(request.place for request in requests) and position not in read_tables:
        read_tables = (position, *read_tables)
    outputs = tuple(output_of(request, catalogue) for request in requests)
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


def parse_requests(names: Iterable[str], catalogue: Catalogue) -> list[Request]:
    """Read requested names, each of which is there once."""
    requests = [parse_request(name, catalogue) for name in names]
    for i, request in enumerate(requests):
        if any(other.name == request.name for other in requests[:i]):
            raise InputError(f"quantity {request.name!r} is asked for twice", remedy="name it once")
    return requests


def output_of(request: Request, catalogue: Catalogue, *, refined: bool = False) -> Output:
    """Return what a request results in."""
    fact = catalogue.public_fact(request.quantity)
    axes: tuple[str, ...]
    if not catalogue.varies(fact.name):
        axes = ()
    elif request.listed:
        axes = ("branch",) if request.listed == "count" else ("branch", EXTREMUM)
    elif request.reduction is None:
        axes = ("branch", catalogue.position.name)
    else:
        axes = ("branch",)
    is_code = (bool(fact.flags) and request.is_of_quantity) or request.listed in ("count", "kind")
    return Output(request, axes, "int8" if is_code else "float64", refined)

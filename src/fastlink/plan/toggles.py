"""Decide over what a reduction runs: positions where the loop closes, no toggle that an integral cannot pass."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from fastlink.catalogue.catalogue import Catalogue, CatalogueError, System
from fastlink.facts.names import Change, Derivative, derivative_name
from fastlink.plan.query import Request
from fastlink.symbolic.asymptotics import asymptotics
from fastlink.symbolic.derivative import NoDerivative

__all__ = ["counted_by", "order_at_toggles", "toggles_of"]


def counted_by(catalogue: Catalogue, request: Request, given: Iterable[str], variants: Sequence[str]) -> str:
    """Return the fact that is a number where a position counts, empty if the quantity has no value at others.

    A crank pin has a place where the linkage cannot be assembled, too: that is no part of the motion. Codes have one
    for such positions.
    """
    if not catalogue.closes or request.reduction is None or catalogue.public_fact(request.quantity).flags:
        return ""
    tables = (catalogue.position.name, *catalogue.tables, *catalogue.table_low_parts)
    steps = catalogue.dependencies([request.quantity], (*given, *tables, "branch"), variants)
    made_of = {name for step in steps for name in step.names}
    return "" if made_of.intersection(catalogue.closes) else catalogue.closes[0]


def toggles_of(
    catalogue: Catalogue, request: Request, given: Iterable[str], variants: Sequence[str]
) -> tuple[str, ...]:
    """Return the facts of a design that are positive where a reduction over the turn meets a toggle it cannot pass.

    A quantity grows as sigma^-n, sigma as the root of the distance from the toggle. Its mean exists for n < 2, that of
    its square for n < 1: see `fastlink.plan.reductions.Reduction.toggle_order`. Without a graded range there are none.
    What an integral changes as its limits move is not that of samples: its derivatives by inputs meet them all.
    """
    reduction = request.reduction
    if catalogue.graded is None or reduction is None or reduction.toggle_order is None:
        return ()
    if request.quantity in catalogue.graded.not_differentiable:  # of samples, as its extremes
        return ()
    if reduction.toggle_order > 0 and not request.is_of_gradient:
        order = order_at_toggles(catalogue, request.quantity, given, variants)
        if order is None or order < reduction.toggle_order:
            return ()
    return tuple(toggle for _, _, toggle in catalogue.graded.ends)


def order_at_toggles(
    catalogue: Catalogue, quantity: str, given: Iterable[str], variants: Sequence[str]
) -> int | None:
    """Return the power of 1/sigma by which a quantity grows at toggles, or None where it is not known.

    What moves a toggle acts as what moves the input position towards it: a derivative by an input grows as that by the
    position does, or faster.
    """
    graded, tree = catalogue.graded, catalogue.parse(quantity)
    assert graded is not None
    names = [quantity]
    if isinstance(tree, Change) or (isinstance(tree, Derivative) and tree.by != catalogue.position.name):
        names.append(derivative_name(str(tree.of), catalogue.position.name))
    # of a linear system nothing is known; closed forms have the same values
    chosen = (graded.name, *(variant for variant in variants if variant not in catalogue.solvers))
    orders = []
    for name in names:
        try:
            steps = tuple(catalogue.dependencies([name], (*given, *graded.coordinates, "branch"), chosen))
        except (CatalogueError, NoDerivative):
            continue
        if not any(isinstance(step, System) for step in steps):
            orders.append(round(asymptotics(graded, steps, (*graded.coordinates, "branch"))[name].order))
    return max(orders, default=None)

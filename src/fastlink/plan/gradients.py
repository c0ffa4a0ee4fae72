"""Derivatives of reductions over the cycle by the inputs: which there are, and what the codes of their status mean.

An extreme inside the range changes by an input as the quantity does at its place, which need not be moved along: the
slope is zero there. At a limit of motion the place moves with the limit, and the derivative that counts keeps
the place at the end of the range.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastlink.errors import InputError
from fastlink.facts.names import (
    Change,
    Derivative,
    ErrorBound,
    GradientStatus,
    ListOfExtrema,
    Reduced,
    derivative_name,
)
from fastlink.numerics.gradient_status import (
    AT_CHANGE_POINT,
    AT_LIMIT,
    CONSTANT,
    INFINITE,
    JUMP,
    KINK,
    MOVING,
    NOTHING,
    OF_SAMPLES,
    SMOOTH,
    TIED,
)
from fastlink.plan.reductions import REDUCTIONS
from fastlink.symbolic.derivative import units_per

if TYPE_CHECKING:
    from collections.abc import Iterable

    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.facts.names import Name
    from fastlink.plan.query import Request
    from fastlink.plan.reductions import Reduction

__all__ = ["STATUS_FLAGS", "check_sampled", "gradient_refusal", "reduced_of", "status_text", "units_of"]

#: The codes of ``NAME_max_gradient_status``.
STATUS_FLAGS = {
    SMOOTH: "derivative",
    AT_LIMIT: "at a limit of motion that moves",
    TIED: "one-sided as two places tie",
    INFINITE: "none as the value is infinite",
    AT_CHANGE_POINT: "none at the fold of a change point",
    NOTHING: "no value",
    KINK: "none at a kink or next to a pole",
    OF_SAMPLES: "of the sampled positions that assemble",
    CONSTANT: "one-sided as nothing changes over the cycle",
    JUMP: "zero where an angle jumps by a full turn or folds at pi or 0",
    MOVING: "none as limits of motion move",
}


def reduced_of(tree: Name) -> Reduced | ListOfExtrema | None:
    """Return the property of the cycle of which a name is the derivative, status or change, or a bound of one."""
    inner = tree.of if isinstance(tree, ErrorBound) else tree
    while isinstance(inner, Derivative) and isinstance(inner.of, Derivative):
        inner = inner.of
    if isinstance(inner, Derivative) and isinstance(inner.of, Change):
        inner = inner.of
    of = inner.of if isinstance(inner, (Derivative, GradientStatus, Change)) else None
    return of if isinstance(of, (Reduced, ListOfExtrema)) else None


def gradient_refusal(name: str, tree: Name, of: Reduced, catalogue: Catalogue) -> InputError | None:
    """Return the error that says why a property of the cycle has no such derivative, None where it has one."""
    what, quantity, position = f"quantity {name!r}: ", str(of.of), catalogue.position.name
    first = next(iter(catalogue.inputs))
    if isinstance(tree, ErrorBound) and isinstance(tree.of, Change):
        return InputError(f"{what}no error bound of {tree.of} is known", remedy="leave it out")
    if isinstance(tree, ErrorBound):
        what += (
            f"{tree.of} is taken at a place that is off itself, and no bound of what that does to it is known"
        )
        return InputError(what, remedy=f"ask for {ErrorBound(of)}, the error of the extreme itself")
    if isinstance(tree, Derivative) and isinstance(tree.of, (Derivative, Change)):
        return InputError(f"{what}second derivatives of {of} are not offered", remedy=f"ask for {tree.of}")
    if isinstance(tree, Derivative) and tree.by == position:
        by_input = Derivative(of, first)
        what += f"{of} is one number of the cycle, which does not change with {position}"
        return InputError(what, remedy=f"ask for its derivative by an input, such as {by_input}")
    if not REDUCTIONS[of.how].gradient_finish:
        return InputError(f"{what}{of} has no derivative by an input", remedy="leave it out")
    if isinstance(tree, Change) and isinstance(of.of, Change):
        return InputError(f"{what}{of.of} is a change itself", remedy=f"ask for {of}")
    fact = catalogue.public_fact(quantity)
    if fact.flags:
        return InputError(f"{what}{quantity} is a code, which has no derivative", remedy="leave it out")
    by = tree.by if isinstance(tree, Derivative) else first
    catalogue.public_fact(derivative_name(quantity, by))
    return None


def status_text(reduction: Reduction, value: str, over_all: bool) -> tuple[str, str]:
    """Return kernel text of the status of derivatives of a reduction of samples, and that at a limit of motion.

    Parameters
    ----------
    reduction : Reduction
        The reduction.
    value : str
        Kernel text of its value.
    over_all : bool
        Whether it is the integral over the turn where there are no limits, and these are known.
    """
    code = SMOOTH if over_all else OF_SAMPLES
    if reduction.has_kink:
        value, text = f"({value})", f"select({value} == 0.0, {KINK}.0, {code}.0)"
    else:
        text = f"{code}.0"
    found = f"select({value} == {value}, {{}}, {NOTHING}.0)"
    return found.format(text), found.format(f"{MOVING}.0")


def check_sampled(requests: Iterable[Request], catalogue: Catalogue) -> None:
    """Refuse derivatives of places where extremes are those of samples.

    Raises
    ------
    InputError
        With what to ask for instead.
    """
    for request in requests:
        if (request.by or request.change) and request.is_position:
            what = f"quantity {request.name!r}: the extremes of {request.quantity} are those of samples here, whose"
            what += f" {catalogue.position.name} does not change with {request.by or 'the inputs'}"
            raise InputError(what, remedy="leave it out")


def units_of(request: Request, catalogue: Catalogue) -> str:
    """Return the units of a request, of that which has units."""
    if request.by and request.is_position:
        return units_per(catalogue.position.units, catalogue.variables[request.by].units)
    if request.change and request.is_position:
        return catalogue.position.units
    units = catalogue.public_fact(request.bounded if request.by else request.quantity).units
    return units if request.reduction is None else request.reduction.units_of(units)

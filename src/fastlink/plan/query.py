"""Requested names: quantities, their reductions over the input cycle, lists of their extrema."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Literal

from fastlink._text import short_repr
from fastlink.errors import InputError, Problems
from fastlink.facts.names import (
    Change,
    Derivative,
    ErrorBound,
    GradientStatus,
    ListOfExtrema,
    Name,
    Quantity,
    Reduced,
    bounded_of,
    derivative_name,
    error_name,
)
from fastlink.plan.gradients import gradient_refusal, reduced_of
from fastlink.plan.reductions import REDUCTIONS, Reduction
from fastlink.plan.suggestions import unknown_quantity

if TYPE_CHECKING:
    from fastlink.catalogue.catalogue import Catalogue

__all__ = ["Extrema", "Request", "check_names", "parse_request"]

#: Most names in one list; more come from an iterator without end.
MOST_NAMES = 10_000

#: Whether extrema are exact over the cycle, or those of the values at the given positions.
Extrema = Literal["refined", "sampled"]


@dataclass(frozen=True)
class Request:
    """A requested name.

    Attributes
    ----------
    name, quantity : str
        The name, and that of the quantity in it.
    reduction : Reduction, optional
        The reduction over the cycle that it is.
    is_position : bool
        Whether it is the input position of an extremum instead of its value.
    listed : {"", "value", "position", "count", "kind", "error"}
        The part of a list of extrema that it is, if it is one.
    is_error : bool
        Whether it is the error bound of an extremum or of each of a list instead of the value.
    by : str
        The input by which it is the derivative of the reduction or its position; empty if it is none.
    is_status : bool
        Whether it is the status of the derivatives of the reduction by the inputs instead of the value.
    """

    name: str
    quantity: str
    reduction: Reduction | None = None
    is_position: bool = False
    listed: str = ""
    is_error: bool = False
    by: str = ""
    is_status: bool = False
    change: str = ""

    @property
    def is_of_gradient(self) -> bool:
        """Whether it is a derivative of a reduction by an input, their status, or a change by tolerances."""
        return bool(self.by or self.change) or self.is_status

    @property
    def is_of_quantity(self) -> bool:
        """Whether a value has the meaning and the values of its quantity: no mean of a code is one, no position."""
        of_value = self.reduction is None or self.reduction.sign != 0
        return not self.is_position and not self.is_of_gradient and of_value

    @property
    def has_its_units(self) -> bool:
        """Whether it is in the units of its quantity, or those of its reduction: no position, number or kind."""
        return not (self.is_position or self.is_status) and self.listed in ("", "value", "error")

    @property
    def value(self) -> str:
        """The name of the value, of an extreme or a list, of which it is the error bound."""
        of = Quantity(self.quantity)
        return str(ListOfExtrema(of) if self.reduction is None else Reduced(of, self.reduction.suffix))

    @property
    def bounded(self) -> str:
        """The quantity, or its error bound or derivative, where the request is that of extremes."""
        if self.by and not self.is_position:
            return derivative_name(self.quantity, self.by)
        return error_name(self.quantity) if self.is_error else self.quantity

    @property
    def can_be_refined(self) -> bool:
        """Whether it is one number of the extrema, which samples only come near."""
        return self.reduction is not None and self.reduction.has_position


def parse_request(name: str, catalogue: Catalogue) -> Request:
    """Read a requested name such as ``omega4``, ``omega4_max`` or ``theta1_at_omega4_max``.

    Raises
    ------
    InputError
        Neither the name nor the quantity in it is known, or it has no error bound.
    """
    if catalogue.is_quantity(name):
        return Request(name, name)
    tree = catalogue.parse(name)
    if request := _of_gradient(name, tree, catalogue):
        return request
    of = bounded_of(tree)
    if isinstance(tree, Change) and isinstance(of, ListOfExtrema):
        what = f"quantity {name!r}: {of} is a list, of which no change is offered"
        raise InputError(what, remedy=f"ask for {Change(Reduced(of.of, 'max'), tree.how)}")
    if isinstance(of, (Reduced, ListOfExtrema)) and catalogue.has_reductions(quantity := str(of.of)):
        listed = "" if isinstance(of, Reduced) else "position" if of.position else of.part
        if (is_error := of is not tree or listed == "error") and (refusal := _no_error(name, of, catalogue)):
            raise refusal
        if isinstance(of, Reduced):
            return Request(name, quantity, REDUCTIONS[of.how], bool(of.position), is_error=is_error)
        return Request(name, quantity, listed=listed, is_error=is_error)
    raise unknown_quantity(name, catalogue)


def _of_gradient(name: str, tree: Name, catalogue: Catalogue) -> Request | None:
    """Return the request for a derivative of a reduction by an input, or for the status of these."""
    of = reduced_of(tree)
    if not isinstance(of, Reduced) or not catalogue.has_reductions(quantity := str(of.of)):
        return None
    if refusal := gradient_refusal(name, tree, of, catalogue):
        raise refusal
    own = {"by": tree.by} if isinstance(tree, Derivative) else {"change": getattr(tree, "how", "")}
    return Request(
        name, quantity, REDUCTIONS[of.how], bool(of.position), is_status=not any(own.values()), **own
    )


def _no_error(name: str, of: Reduced | ListOfExtrema, catalogue: Catalogue) -> InputError | None:
    """Return the error that says why a property of the cycle has no error bound, None where it has one."""
    catalogue.public_fact(error_name(str(of.of)))  # codes have none, nor have error bounds
    what, remedy = f"quantity {name!r}: ", f"ask for {Reduced(ErrorBound(of.of), 'max')}"
    if isinstance(of, ListOfExtrema) and of.part in ("count", "kind"):
        return InputError(f"{what}{of} is a code, which has no error", remedy="leave it out")
    if of.position:
        of_value = (
            ErrorBound(Reduced(of.of, of.how)) if isinstance(of, Reduced) else ListOfExtrema(of.of, "error")
        )
        what += f"{of} is off by the error of the slope over the curvature there, of which no bound is known"
        return InputError(what, remedy=f"ask for {of_value}, the error of the extreme itself")
    if isinstance(of, Reduced) and REDUCTIONS[of.how].sign == 0:
        what += f"{of} is taken from samples of the cycle, and how far these are from all of it is not known"
        return InputError(what, remedy=f"{remedy}, the greatest error of the samples")
    return None


def check_names(parameter: str, given: Iterable[str]) -> tuple[str, ...]:
    """Return the names of a list, each of which must stand in it once.

    Parameters
    ----------
    parameter : str
        The parameter that holds them.
    given : iterable of str
        The names, in their order.

    Raises
    ------
    InputError
        It is one text, or has no order, or is empty, or an element is not a name or stands in it twice.
    """
    where = (parameter,)
    if isinstance(given, str):
        raise InputError(
            f"is one text, {short_repr(given)}", where=where, remedy=f"write a list: [{short_repr(given)}]"
        )
    names: list[str] = []
    try:
        if not isinstance(given, (bytes, bytearray, set, frozenset, Mapping)):
            names = list(islice(given, MOST_NAMES + 1))
        elif given:
            raise TypeError
    except Exception:  # no list, or whatever a class of somebody's does
        raise InputError(f"is {short_repr(given)}", where=where, remedy="write a list of names") from None
    if not names:
        raise InputError("is empty", where=where, remedy="write at least one name")
    if len(names) > MOST_NAMES:
        raise InputError(f"holds more than {MOST_NAMES} names", where=where, remedy="write fewer")
    problems, known = Problems(), set()
    for k, name in enumerate(names):
        if not isinstance(name, str):
            problems.add(f"is {short_repr(name)}", (parameter, k), "write a name")
        elif name in known:
            problems.add(f"{name!r} is named twice", (parameter, k), "name it once")
        else:
            known.add(name)
    problems.stop()
    return tuple(map(str, names))


def reduced_names(catalogue: Catalogue) -> Iterable[str]:
    """Yield every name of a reduction or list over a mechanism's cycle: of all but the codes of a design."""
    for quantity in filter(catalogue.varies, catalogue.public):
        for reduction in REDUCTIONS.values():
            yield str(Reduced(Quantity(quantity), reduction.suffix))
            if reduction.has_position:
                yield str(Reduced(Quantity(quantity), reduction.suffix, catalogue.position.name))
        yield from list_names(catalogue, quantity)


def list_names(catalogue: Catalogue, quantity: str) -> tuple[str, ...]:
    """Return the names that belong together: a list of extrema, their positions, their number, their kinds."""
    of = Quantity(quantity)
    parts = (ListOfExtrema(of, part) for part in ("count", "kind"))
    return tuple(map(str, (ListOfExtrema(of), ListOfExtrema(of, position=catalogue.position.name), *parts)))


def with_companions(catalogue: Catalogue, names: Iterable[str]) -> list[str]:
    """Return the names with those that belong to each and are not requested already.

    These are the parts of a list of extrema, and after a change by tolerances the status of its derivatives.
    """
    requested = list(names)
    result: list[str] = []
    for name in requested:
        request = parse_request(name, catalogue)
        together: tuple[str, ...] = (name,)
        if request.listed == "value":
            together = list_names(catalogue, request.quantity)
        elif request.change and request.reduction is not None:
            of = Reduced(Quantity(request.quantity), request.reduction.suffix)
            together = (name, str(GradientStatus(of)))
        result += [other for other in together if other == name or other not in (*requested, *result)]
    return result

"""What a case is, what came out of it, and whether that is right."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

import fastlink as fl
from extreme.exact import CONTEXT, TINY, UNIT, Configuration, Size
from fastlink.catalogue import Catalogue

__all__ = ["MULTIPLE", "Case", "Mechanism", "Outcome", "evaluated", "outcomes"]

#: Roundings that the chains of operations may add up to, as in test_precision.py.
MULTIPLE = 8
#: A residual is a few subtractions of numbers of at most 1, right to some roundings each; where a gap of the last bits
#: of the lengths counts as zero, it is that gap in units of the smallest distances there (37 roundings at most here).
RESIDUAL = 64
#: What a quotient by rounding errors exceeds.
POLE = 2.0**50
LARGEST = np.finfo(float).max


@dataclass(frozen=True)
class Case:
    """One configuration where a computation may go wrong.

    Attributes
    ----------
    name : str
        What is extreme in it.
    inputs : mapping of str to float
        All inputs and the position.
    status : str
        What `status` must say, by rational arithmetic or by definition.
    """

    name: str
    inputs: Mapping[str, float]
    status: str


@dataclass(frozen=True)
class Mechanism:
    """What the runner needs to know of a mechanism.

    Attributes
    ----------
    catalogue : Catalogue
        The mechanism.
    families : mapping of str to callable
        By name of the family what returns its cases, all of them or the small form.
    loop : str
        A fact that is NaN where the loop does not close.
    swept : tuple of str
        What the compiled sweep is asked for: compiling all takes long.
    lengths : tuple of str
        The inputs that are lengths of links.
    free : tuple of str
        What does not need the loop.
    held : mapping of str to callable
        Internal facts that are right to a few roundings, see `extreme.exact.Exact`.
    """

    catalogue: Catalogue
    families: Mapping[str, Callable[[bool], list[Case]]]
    loop: str
    swept: tuple[str, ...] = ()
    lengths: tuple[str, ...] = ()
    free: tuple[str, ...] = ()
    held: Mapping[str, Size] = field(default_factory=dict)

    @cached_property
    def quantities(self) -> tuple[str, ...]:
        return tuple(self.catalogue.public)


@dataclass(frozen=True)
class Outcome:
    """What came out for one quantity of one configuration.

    Attributes
    ----------
    what : str
        ``value``, ``nan``, ``inf``; or what is wrong with it.
    right : bool
        Whether it is what must come out.
    error : float
        In units of (condition x rounding), where both are numbers.
    """

    what: str
    right: bool
    error: float = 0.0


def evaluated(mechanism: Mechanism, cases: list[Case]) -> dict[int, dict[str, Any]]:
    """Return by branch every quantity of every case."""
    inputs = {name: np.array([case.inputs[name] for case in cases]) for name in cases[0].inputs}
    return {
        branch: fl.evaluate(
            mechanism.catalogue.name,
            mechanism.quantities,
            branch=np.full(len(cases), float(branch)),
            **inputs,
        )
        for branch in mechanism.catalogue.branches
    }


def outcomes(mechanism: Mechanism, case: Case, branch: int, found: Mapping[str, float]) -> dict[str, Outcome]:
    """Hold every quantity of one configuration against exact arithmetic."""
    catalogue, names = mechanism.catalogue, mechanism.quantities
    exact = Configuration(
        catalogue, (*names, mechanism.loop), case.inputs | {"branch": branch}, mechanism.held
    )
    units, beyond = exact.roundings(), exact.leaves_doubles(LARGEST)
    closes = not CONTEXT.isnan(exact.values[mechanism.loop])
    result = {}
    for name in names:
        value = exact.values[name]
        if catalogue.facts[name].flags:
            result[name] = _code(found[name], value, name in beyond)
        elif not closes and catalogue.varies(name) and name not in mechanism.free:
            result[name] = Outcome("nan", True) if np.isnan(found[name]) else Outcome("open, a number", False)
        elif not np.isfinite(found[name]):
            result[name] = _not_finite(found[name], value, name in beyond or units[name] >= abs(value))
        elif "residual" in name:
            # A coordinate has no more digits than its doubles.
            unit = max(UNIT, max(TINY / case.inputs[length] for length in mechanism.lengths))
            result[name] = _value(found[name], CONTEXT.zero, RESIDUAL * unit / MULTIPLE)
        else:
            result[name] = _value(found[name], value, UNIT * abs(value) + units[name])
    return result


def _code(found: float, exact: Any, beyond: bool) -> Outcome:
    same = np.isnan(found) if CONTEXT.isnan(exact) else found == float(exact)
    return Outcome(f"code {found:.0f}", bool(same or beyond))


def _not_finite(found: float, exact: Any, undetermined: bool) -> Outcome:
    """Judge NaN and infinity: right where there is no number, or none of doubles, or data do not determine it."""
    beyond = not abs(exact) <= LARGEST * (1 - MULTIPLE * UNIT)
    return Outcome("nan" if np.isnan(found) else "inf", bool(beyond or undetermined))


def _value(found: float, exact: Any, unit: Any) -> Outcome:
    if not CONTEXT.isfinite(exact):
        # A pole is met but for rounding.
        return Outcome("pole" if abs(found) > POLE else "undetermined, a number", abs(found) > POLE)
    if exact == found:
        return Outcome("value", True)
    error = abs(CONTEXT.mpf(float(found)) - exact) / (unit + TINY)
    return Outcome("value", bool(error <= MULTIPLE), float(error))

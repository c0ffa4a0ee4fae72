"""What a case is, what came out of it, and whether that is right."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

import fastlink as fl
from fastlink.facts.catalogue import Catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING
from tests.extreme.exact import CONTEXT, TINY, Configuration, Size

__all__ = ["MULTIPLE", "Case", "Mechanism", "Outcome", "evaluated", "outcomes", "unknown"]

#: Roundings that the chains of operations may add up to, as in test_precision.py.
MULTIPLE = 8
#: A residual is a few subtractions of numbers of at most 1, right to some roundings each; where a gap of the last bits
#: of the lengths counts as zero, it is that gap in units of the smallest distances there (37 roundings at most here).
RESIDUAL = 64
#: What products of numbers below 2^-1022 on the way may do; a rate of psi by 1/d^2 may be 0 from there on.
UNDERFLOW = CONTEXT.mpf(2) ** -1022 / MULTIPLE
#: What a quotient by rounding errors exceeds.
POLE = 2.0**50
LARGEST = np.finfo(float).max
#: A fact as small as that may have a factor (a squared length, say) below 2^-1022.
LEAST = 2.0**-900


@dataclass(frozen=True)
class Case:
    """One configuration where a computation may go wrong: its name says what is extreme in it."""

    name: str
    #: All inputs and the position.
    inputs: Mapping[str, float]
    #: What `status` must say by rational arithmetic; else it is that of the same facts with 50 digits.
    status: str | None = None


@dataclass(frozen=True)
class Mechanism:
    """A mechanism and its cases."""

    catalogue: Catalogue
    #: By name of the family what returns its cases, all of them or the small form.
    families: Mapping[str, Callable[[bool], list[Case]]]
    #: A fact that is NaN where the loop does not close, and with it all that is not `free`.
    loop: str | None = None
    #: The inputs that are lengths of links.
    lengths: tuple[str, ...] = ()
    #: What does not need the loop.
    free: tuple[str, ...] = ()
    #: What measures its own roundings, not named a residual: the greatest that comes out.
    measures: Mapping[str, float] = field(default_factory=dict)
    #: What is left out, with the reason beside it.
    skipped: tuple[str, ...] = ()
    #: Internal facts that are right to a few roundings, see `extreme.exact.Configuration`.
    held: Mapping[str, Size] = field(default_factory=dict)

    @cached_property
    def quantities(self) -> tuple[str, ...]:
        return tuple(name for name in self.catalogue.public if name not in self.skipped)


@dataclass(frozen=True)
class Outcome:
    """What came out for one quantity of one configuration."""

    #: ``value``, ``nan``, ``inf``, ``pole``, ``code``; ``underflow`` where digits are lost and a product on the way may
    #: be below 2^-1022; or what is wrong with it.
    what: str
    #: Whether it is what must come out.
    right: bool
    #: In units of (condition x rounding), where both are numbers.
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
    loop = mechanism.loop
    facts = names if loop is None else (*names, loop)
    exact = Configuration(catalogue, facts, case.inputs | {"branch": branch}, mechanism.held)
    units = exact.roundings()
    beyond = exact.depending(lambda value: abs(value) > LARGEST, tables=True)
    small = exact.depending(lambda value: 0 < abs(value) < LEAST)
    closes = loop is None or not CONTEXT.isnan(exact.values[loop])
    codes = [name for name in names if catalogue.facts[name].flags]
    result = {}
    for name in (name for name in names if name not in codes):
        value = exact.values[name]
        if not closes and catalogue.varies(name) and name not in mechanism.free:
            result[name] = Outcome("nan", True) if np.isnan(found[name]) else Outcome("open, a number", False)
        elif not np.isfinite(found[name]):
            result[name] = _not_finite(found[name], value, name in beyond or units[name] >= abs(value))
        elif name in mechanism.measures:
            result[name] = _value(found[name], CONTEXT.zero, mechanism.measures[name] / MULTIPLE)
        elif "residual" in name:
            # A coordinate has no more digits than its doubles.
            unit = max(UNIT_ROUNDING, max(TINY / case.inputs[length] for length in mechanism.lengths))
            result[name] = _value(found[name], CONTEXT.zero, RESIDUAL * unit / MULTIPLE)
        else:
            angle = catalogue.facts[name].units == "rad" and catalogue.varies(name)
            turned = angle and abs(found[name] - float(value)) > np.pi
            # Next to the straight angle rounding tells pi from -pi.
            value -= np.sign(float(value)) * 2 * CONTEXT.pi if turned else 0
            result[name] = _value(found[name], value, UNIT_ROUNDING * abs(value) + units[name])
    for name in small.intersection(result):
        if not result[name].right:
            result[name] = Outcome("underflow", True)
    # A code may tell of a number that exact arithmetic has and doubles have not.
    missing = any(abs(exact.values[name]) < CONTEXT.inf and not np.isfinite(found[name]) for name in result)
    return result | {
        name: _code(found[name], exact.values[name], missing and catalogue.varies(name)) for name in codes
    }


def unknown(mechanism: Mechanism, case: Case, branch: int, names: Iterable[str]) -> set[str]:
    """Return the quantities whose error bound is infinite: it says that no digit of them is known."""
    asked = [f"{name}_error" for name in names if not mechanism.catalogue.public_fact(name).flags]
    found = fl.evaluate(mechanism.catalogue.name, asked, branch=branch, **case.inputs) if asked else {}
    return {name.removesuffix("_error") for name, bound in found.items() if np.isinf(bound)}


def _code(found: float, exact: Any, missing: bool) -> Outcome:
    same = np.isnan(found) if CONTEXT.isnan(exact) else found == float(exact)
    return Outcome(f"code {found:.0f}", bool(same or missing))


def _not_finite(found: float, exact: Any, undetermined: bool) -> Outcome:
    """Judge NaN and infinity: right where there is no number, or none of doubles, or data do not determine it."""
    beyond = not abs(exact) <= LARGEST * (1 - MULTIPLE * UNIT_ROUNDING)
    return Outcome("nan" if np.isnan(found) else "inf", bool(beyond or undetermined))


def _value(found: float, exact: Any, unit: Any) -> Outcome:
    if not CONTEXT.isfinite(exact):
        # A pole is met but for rounding.
        return Outcome("pole" if abs(found) > POLE else "undetermined, a number", abs(found) > POLE)
    if exact == found:
        return Outcome("value", True)
    error = abs(CONTEXT.mpf(float(found)) - exact) / (unit + UNDERFLOW)
    return Outcome("value", bool(error <= MULTIPLE), float(error))

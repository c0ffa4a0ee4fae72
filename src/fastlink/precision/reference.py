"""Evaluate facts with 50 digits, and express errors in roundings.

The unit is 2^-53 (|f| + sum over the inputs x of |x df/dx|): the last digit of f and of its inputs.
The derivatives are differences of the same facts with 50 digits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from mpmath import MPContext

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.evaluate import evaluate_step, steps_of, tables_at
from fastlink.facts.fact import Fact, System
from fastlink.facts.formula import Formula
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.numerics.elementary import PI, TWO_PI
from fastlink.numerics.vectors import as_given

DIGITS = 50
#: Numbers of 50 digits, whatever precision others set for theirs.
CONTEXT: Any = MPContext()
CONTEXT.dps = DIGITS
#: Relative step of the differences: their errors are of this size.
STEP = CONTEXT.mpf(10) ** -20
#: Pi and 2 pi with all digits, in place of the doubles of formulas.
TURNS = {PI: CONTEXT.pi, TWO_PI: 2 * CONTEXT.pi}


class HighPrecision:
    """Facts of a mechanism at one configuration after another, with 50 digits.

    Where a step divides by zero or has no finite result, it is evaluated in doubles, which give infinity, NaN or the
    other choice of a `select`, as in the kernels.
    """

    def __init__(
        self,
        catalogue: Catalogue,
        names: Iterable[str],
        given: Iterable[str],
        variants: Iterable[str] = (),
        *,
        zeroes: bool = False,
    ) -> None:
        self.zeroes = zeroes
        #: The gaps that count as zero in doubles, but were taken as they are by the last call of `at`.
        self.left_out: list[Any] = []
        self.catalogue, self.names = catalogue, tuple(names)
        given = tuple(given)
        self.position = catalogue.position.name
        tables = (*catalogue.tables, *catalogue.table_low_parts) if self.position in given else ()
        self.steps = tuple(map(exact_turns, steps_of(catalogue, self.names, (*given, *tables), variants)))
        needed = {need for step in self.steps for need in step.depends_on}
        self.tables = tuple(name for name in tables if name in needed)
        self._after: dict[tuple[str, ...], tuple[Fact | System, ...]] = {}

    def at(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Return every value of the dependencies at one configuration."""
        known = {name: CONTEXT.mpf(value) for name, value in values.items()}
        with as_given(not self.zeroes) as self.left_out:
            return self._follow(known, self.position if self.position in known else "", self.steps)

    def moved(self, base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
        """Return every value of the dependencies with some given values changed."""
        changed = self.position if self.position in changes else ""
        with as_given(not self.zeroes):
            return self._follow({**base, **changes}, changed, self.steps_after(*changes))

    def varied(self, base: Mapping[str, Any], inputs: Iterable[str]) -> Iterator[dict[str, Any]]:
        """Yield every value with one input after another greater by `STEP` of it, but those that are 0."""
        for name in inputs:
            if base[name] != 0:
                yield self.moved(base, {name: base[name] * (1 + STEP)})

    def condition(self, base: Mapping[str, Any], inputs: Iterable[str]) -> dict[str, Any]:
        """Return the sum of |x df/dx| over inputs x, for each name f."""
        sums = dict.fromkeys(self.names, CONTEXT.zero)
        for moved in self.varied(base, inputs):
            for quantity in self.names:
                change = abs(moved[quantity] - base[quantity])
                sums[quantity] += CONTEXT.zero if CONTEXT.isnan(change) else change / STEP
        return sums

    def _follow(self, known: dict[str, Any], changed: str, steps: Iterable[Fact | System]) -> dict[str, Any]:
        with CONTEXT.workprec(CONTEXT.prec + self._bits_of_small(known)):
            if changed == self.position:
                known |= tables_at(self.catalogue, known[changed], self.tables)
            for step in steps:
                take(step, known)
        return known

    def _bits_of_small(self, known: Mapping[str, Any]) -> int:
        """Return further bits for a small input position, which stands beside 1 in its functions."""
        position = known.get(self.position, CONTEXT.zero)
        return 2 * max(0, -CONTEXT.mag(position)) if position != 0 and CONTEXT.isfinite(position) else 0

    def steps_after(self, *names: str) -> tuple[Fact | System, ...]:
        """Return the steps that depend on given values."""
        if names not in self._after:
            changed, steps = {*names, *(self.tables if self.position in names else ())}, []
            for step in self.steps:
                if changed.intersection(step.depends_on):
                    changed.update(step.names)
                    steps.append(step)
            self._after[names] = tuple(steps)
        return self._after[names]


class ExactFormula(Formula):
    """A formula in which pi stands for all its digits, not for the double."""

    @cached_property
    def function(self) -> Callable[..., Any]:
        """The formula as a function of Python."""
        return self.function_with(TURNS)


def exact_turns(step: Fact | System) -> Fact | System:
    """Return a step in whose formula pi stands for all its digits."""
    law = step.formula
    named = any(law.names.get(name) in TURNS for name in law.uses)
    if not named and not any(repr(turn) in line for turn in TURNS for line in law.lines):
        return step
    return replace(step, formula=ExactFormula(law.name, law.parameters, law.lines, law.names))


def take(step: Fact | System, known: dict[str, Any]) -> None:
    """Add the values of a step: those of doubles where a quotient by zero has no value in mpmath."""
    try:
        evaluate_step(step, known)
    except (ZeroDivisionError, ValueError, OverflowError):
        doubles = {need: np.float64(known[need]) for need in step.depends_on}
        try:
            with np.errstate(all="ignore"):
                evaluate_step(step, doubles)
        except np.linalg.LinAlgError:
            doubles = dict.fromkeys(step.names, np.float64("nan"))
        known.update((name, CONTEXT.mpf(float(doubles[name]))) for name in step.names)


def error_in_roundings(value: float, exact: Any, condition: Any) -> float:
    """Return the error of a double in units of 2^-53 (|exact| + condition)."""
    error, unit = abs(CONTEXT.mpf(value) - exact), UNIT_ROUNDING * (abs(exact) + condition)
    return 0.0 if error == 0 else float(error / unit) if unit != 0 else np.inf

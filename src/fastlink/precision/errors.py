"""Collect the errors of one variable, and state them as its attributes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fastlink.precision.independent.check import TOLERANCE
from fastlink.precision.reference import CONTEXT, DIGITS, error_in_roundings

__all__ = ["MeasuredErrors", "unit_of"]

#: Values below this share of the terms that made them vanish: to half its digits, the reference itself is 0.
VANISHES = CONTEXT.mpf(10) ** (-DIGITS // 2)
#: Errors beyond so many roundings are held against the error bound, as are all of values that vanish.
SUSPECT = 16.0


@dataclass
class MeasuredErrors:
    """Errors of the values of one variable against exact ones.

    Attributes
    ----------
    method : str
        The reference of the comparison.
    scale : number
        The size that errors are relative to, unless it is the exact value: a whole turn for positions.
    relative, roundings : list of float
        Errors where both values are finite; relative to the size of such values of the design where the exact one is 0.
    values, mismatches : int
        The number of values compared, and of those with another code, finite where the exact one is not, or wrong by
        more than their error bound; exact values that no formula of the facts confirms are among these.
    independent : list of float
        Differences of exact values from independent ones, in units of `unit_of`.
    shares : list of float
        Of the values of an error bound, the share that the error has.
    """

    method: str
    scale: Any = 0
    relative: list[float] = field(default_factory=list)
    roundings: list[float] = field(default_factory=list)
    values: int = 0
    mismatches: int = 0
    independent: list[float] = field(default_factory=list)
    shares: list[float] = field(default_factory=list)

    def add(
        self,
        value: float,
        exact: Any,
        condition: Any = None,
        terms: float = 0.0,
        bound: Callable[[], float] | None = None,
        zeroed: object = False,
    ) -> None:
        """Compare a value.

        Parameters
        ----------
        value : float
            The value.
        exact, condition : number
            With 50 digits, and the sum of `HighPrecision.condition`.
        terms : float
            The size of such a quantity of such a design, against which the error of a value that vanishes is measured.
        bound : callable, optional
            Returns the error bound: a value that is wrong by more is a mismatch.
        zeroed : object
            True if a gap counts as zero, which decides whether there is a number: then neither reading is wrong.
        """
        self.values += 1
        finite = bool(np.isfinite(value)), bool(CONTEXT.isfinite(exact))
        if not all(finite):
            self.mismatches += int(any(finite) and not zeroed)
            return
        error, least = abs(CONTEXT.mpf(value) - exact), VANISHES * terms
        vanishes = abs(exact) <= least and terms != 0.0
        size = self.scale or (terms if vanishes else abs(exact))
        if size != 0:
            self.relative.append(float(error / size))
        roundings = 0.0
        if condition is not None:
            insensitive = vanishes and abs(exact) + condition <= least
            roundings = error_in_roundings(value, exact, terms if insensitive else condition)
            self.roundings.append(roundings)
        if bound is not None and error != 0 and (vanishes or roundings > SUSPECT):
            self.mismatches += int(error > bound())

    def add_code(self, value: float, exact: Any) -> None:
        """Compare a code, which is right or wrong."""
        self.values += 1
        self.mismatches += int(exact != value)

    def add_bound(self, bound: float, value: float, exact: Any) -> None:
        """Hold an error bound against the error of its value; one of what is not finite has to be infinite or NaN."""
        self.values += 1
        if not (np.isfinite(value) and CONTEXT.isfinite(exact)):
            self.mismatches += int(np.isfinite(bound))
            return
        error = abs(CONTEXT.mpf(value) - exact)
        self.mismatches += int(not error <= bound)
        if 0.0 < bound < np.inf:
            self.shares.append(float(error / bound))

    def add_independent(self, difference: float | None) -> None:
        """Compare an exact value with an independent one, if there is one, by their difference over `unit_of`."""
        if difference is not None:
            self.independent.append(difference)
            self.mismatches += int(difference > TOLERANCE)

    def add_mismatch(self) -> None:
        """Count a value that is missing, or one that should not exist."""
        self.values += 1
        self.mismatches += 1

    def attrs(self) -> dict[str, Any]:
        """Return the attributes of the variable."""
        attrs: dict[str, Any] = {"verified_values": self.values, "verify_mismatches": self.mismatches}
        if self.relative:
            attrs["error_max_relative"] = max(self.relative)
            attrs["error_median_relative"] = float(np.median(self.relative))
            attrs["error_reference"] = self.method
        if self.roundings:
            attrs["error_max_roundings"] = max(self.roundings)
        if self.shares:
            attrs["error_max_of_bound"] = max(self.shares)
            attrs["error_reference"] = self.method
        if self.independent:
            attrs["independent_values"] = len(self.independent)
            attrs["independent_max_difference"] = max(self.independent)
        return attrs


def unit_of(exact: Any, condition: Any, terms: float) -> Any:
    """Return the size against which two references are compared: that of the terms for a value that vanishes."""
    size = abs(exact) + condition
    return CONTEXT.mpf(terms) if size <= VANISHES * terms else size

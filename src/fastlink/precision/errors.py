"""Collect the errors of one variable, and state them as its attributes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fastlink.precision.reference import CONTEXT, error_in_roundings

__all__ = ["MeasuredErrors"]


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
        Errors where both values are finite; none relative to an exact 0.
    values, mismatches : int
        The number of values compared, and of those with another code or finite where the exact one is not.
    """

    method: str
    scale: Any = 0
    relative: list[float] = field(default_factory=list)
    roundings: list[float] = field(default_factory=list)
    values: int = 0
    mismatches: int = 0

    def add(self, value: float, exact: Any, condition: Any = None) -> None:
        """Compare a value; `condition` is the sum of `HighPrecision.condition`."""
        self.values += 1
        finite = bool(np.isfinite(value)), bool(CONTEXT.isfinite(exact))
        if all(finite):
            size = self.scale or abs(exact)
            if size != 0:
                self.relative.append(float(abs(CONTEXT.mpf(value) - exact) / size))
            if condition is not None:
                self.roundings.append(error_in_roundings(value, exact, condition))
        elif any(finite):
            self.mismatches += 1

    def add_code(self, value: float, exact: Any) -> None:
        """Compare a code, which is right or wrong."""
        self.values += 1
        self.mismatches += int(exact != value)

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
        return attrs

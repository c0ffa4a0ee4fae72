"""The errors that were measured of one variable, and what its attributes say of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fastlink.precision.reference import CONTEXT, error_in_roundings

__all__ = ["Measured"]


@dataclass
class Measured:
    """Values of one variable against exact ones.

    Attributes
    ----------
    method : str
        What the values are compared with.
    scale : number
        What errors are relative to, where it is not the exact value: a whole turn for places.
    relative, roundings : list of float
        Errors of the values that both are numbers; there are no errors relative to an exact 0.
    values, mismatches : int
        How many values were compared, and how many are a number or a code where the exact one is another or none.
    """

    method: str
    scale: Any = 0
    relative: list[float] = field(default_factory=list)
    roundings: list[float] = field(default_factory=list)
    values: int = 0
    mismatches: int = 0

    def add(self, value: float, exact: Any, condition: Any = None) -> None:
        """Compare a value; `condition` is the sum of `Exact.condition`."""
        self.values += 1
        here, there = bool(np.isfinite(value)), bool(CONTEXT.isfinite(exact))
        if here and there:
            size = self.scale or abs(exact)
            if size != 0:
                self.relative.append(float(abs(CONTEXT.mpf(value) - exact) / size))
            if condition is not None:
                self.roundings.append(error_in_roundings(value, exact, condition))
        elif here or there:
            self.mismatches += 1

    def add_code(self, value: float, exact: Any) -> None:
        """Compare a code, which is right or wrong."""
        self.values += 1
        self.mismatches += int(exact != value)

    def attrs(self) -> dict[str, Any]:
        """Return the attributes of the variable."""
        found: dict[str, Any] = {"verified_values": self.values, "verify_mismatches": self.mismatches}
        if self.relative:
            found["error_max_relative"] = max(self.relative)
            found["error_median_relative"] = float(np.median(self.relative))
            found["error_reference"] = self.method
        if self.roundings:
            found["error_max_roundings"] = max(self.roundings)
        return found

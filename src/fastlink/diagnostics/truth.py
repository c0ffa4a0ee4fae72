"""The values of a quantity of sampled designs with 50 digits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.precision.extrema import outermost
from fastlink.precision.reference import CONTEXT, HighPrecision
from fastlink.precision.stationary import Stationary

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.diagnostics.methods import Subject

__all__ = ["Truth", "truth_of"]


@dataclass(frozen=True)
class Truth:
    """Exact values, and their indices among the values of a method.

    Attributes
    ----------
    indices : list of tuple
        (design, branch[, position]), or (design,) for a fact of the design.
    exact : list
        Numbers of 50 digits, infinities among them.
    """

    indices: list[tuple[int, ...]]
    exact: list[Any]

    def errors(self, values: NDArray[Any]) -> tuple[NDArray[Any], int, int]:
        """Return relative errors of finite values, the number of wrong ones, and of all."""
        errors, wrong, count = [], 0, 0
        for index, exact in zip(self.indices, self.exact, strict=True):
            if index[0] >= len(values) or CONTEXT.isnan(exact):
                continue
            value, count = float(values[index]), count + 1
            if not (np.isfinite(value) and CONTEXT.isfinite(exact)):
                wrong += int(exact != value)
            elif exact != 0:
                errors.append(float(abs(CONTEXT.mpf(value) - exact) / abs(exact)))
        return np.array(errors), wrong, count


def truth_of(subject: Subject, rng: np.random.Generator) -> Truth:
    """Return exact values of a quantity, one for each design at random."""
    resolved = subject.resolve()
    output, catalogue, variants = resolved.plan.outputs[0], resolved.catalogue, resolved.plan.variants
    count, request = resolved.space.size, output.request
    inputs, k = resolved.space.at(np.arange(count)), rng.integers(len(resolved.branches), size=count)
    branches = np.array(resolved.branches, dtype=float)[k]
    if request.reduction is not None:
        stationary = Stationary(catalogue, request.quantity, inputs, branches, variants)
        extremes = [outermost(stationary, design, request.reduction.sign).value for design in range(count)]
        return Truth(list(zip(range(count), k.tolist(), strict=True)), extremes)
    positions = rng.integers(resolved.positions.size, size=count)
    given = (*inputs, catalogue.position.name, "branch")
    facts = HighPrecision(catalogue, [request.quantity], given, variants)
    indices: list[tuple[int, ...]] = []
    exact = []
    for design in range(count):
        values = {name: float(column[design]) for name, column in inputs.items()}
        values |= {"branch": branches[design], catalogue.position.name: resolved.positions[positions[design]]}
        exact.append(facts.at(values)[request.quantity])
        indices.append((design, int(k[design]), int(positions[design])) if output.axes else (design,))
    return Truth(indices, exact)

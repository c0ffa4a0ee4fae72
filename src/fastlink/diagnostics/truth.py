"""What a quantity of sampled designs is, with 50 digits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.diagnostics.baselines import sign_of
from fastlink.precision.extrema import outermost
from fastlink.precision.reference import CONTEXT, HighPrecision
from fastlink.precision.stationary import Stationary

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.diagnostics.methods import Subject

__all__ = ["Truth", "truth_of"]


@dataclass(frozen=True)
class Truth:
    """Exact values and where they stand among those of a way.

    Attributes
    ----------
    places : list of tuple
        Indices (design, branch[, position]), or (design,) for a fact of the design.
    exact : list
        Numbers of 50 digits, infinities among them.
    """

    places: list[tuple[int, ...]]
    exact: list[Any]

    def errors(self, values: NDArray[Any]) -> tuple[NDArray[Any], int, int]:
        """Return the relative errors of finite values, how many others are wrong, and of how many."""
        found, wrong, count = [], 0, 0
        for place, exact in zip(self.places, self.exact, strict=True):
            if place[0] >= len(values) or CONTEXT.isnan(exact):
                continue
            value, count = float(values[place]), count + 1
            if not (np.isfinite(value) and CONTEXT.isfinite(exact)):
                wrong += int(exact != value)
            elif exact != 0:
                found.append(float(abs(CONTEXT.mpf(value) - exact) / abs(exact)))
        return np.array(found), wrong, count


def truth_of(subject: Subject, rng: np.random.Generator) -> Truth:
    """Return the exact values of a quantity: of each design in one branch, for a curve at one input position."""
    asked = subject.asked()
    output, catalogue, variants = asked.plan.outputs[0], asked.catalogue, asked.plan.variants
    count = asked.space.size
    inputs, k = asked.space.at(np.arange(count)), rng.integers(len(asked.branches), size=count)
    branches = np.array(asked.branches, dtype=float)[k]
    request = output.request
    if request.reduction is not None:
        stationary = Stationary(catalogue, request.quantity, inputs, branches, variants)
        sign = int(sign_of(request))
        extremes = [outermost(stationary, design, sign).value for design in range(count)]
        return Truth(list(zip(range(count), k.tolist(), strict=True)), extremes)
    positions = rng.integers(asked.positions.size, size=count)
    facts = HighPrecision(
        catalogue, [request.quantity], (*inputs, catalogue.position.name, "branch"), variants
    )
    places: list[tuple[int, ...]] = []
    exact = []
    for design in range(count):
        at = {name: float(column[design]) for name, column in inputs.items()}
        at |= {"branch": branches[design], catalogue.position.name: asked.positions[positions[design]]}
        exact.append(facts.at(at)[request.quantity])
        places.append((design, int(k[design]), int(positions[design])) if output.axes else (design,))
    return Truth(places, exact)

"""Curves and facts of the design, and what is taken of samples, against the same facts with 50 digits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision.errors import Measured
from fastlink.precision.reference import CONTEXT
from fastlink.precision.sample import within

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from fastlink.plan.program import Output
    from fastlink.plan.reductions import Reduction
    from fastlink.precision.reference import HighPrecision
    from fastlink.precision.sample import Chosen

__all__ = ["sampled", "values"]

#: Configurations of each design, where they may be as many.
ANGLES = 4
#: Samples that differ by so many roundings may change places.
TIE = 64 * UNIT_ROUNDING
FACTS = "the facts with 50 digits"
#: What reductions are compared with, by whether they are extremes, and whether it is their place.
METHODS = {
    (False, False): "the exact reduction of the samples in doubles",
    (True, False): f"{FACTS}, at the sample",
    (True, True): "the given input positions",
}


def values(
    chosen: Chosen, outputs: Sequence[Output], share: int, rng: np.random.Generator
) -> dict[str, Measured]:
    """Measure curves and facts of the design at random branches and input positions."""
    found = {output.name: Measured(FACTS) for output in outputs}
    facts = chosen.facts(found)
    numbers = any(output.dtype == "float64" for output in outputs)
    vary = any(output.axes for output in outputs)
    most = chosen.count * (ANGLES if vary else 1)
    for number in range(chosen.affordable(facts, share, most) if numbers else most):
        design = number % chosen.count
        branch, place = rng.integers(len(chosen.plan.branches)), rng.integers(chosen.positions.size)
        at = chosen.configuration(design, chosen.plan.branches[branch], chosen.positions[place])
        exact = facts.at(at)
        condition = facts.condition(exact, chosen.by_inputs(facts)) if numbers else {}
        for output in outputs:
            row = chosen.results[output.name][design]
            value = float(row[branch, place]) if output.axes else float(row)
            if output.dtype == "float64":
                found[output.name].add(value, exact[output.name], condition[output.name])
            else:
                found[output.name].add_code(value, exact[output.name])
    return found


def sampled(chosen: Chosen, outputs: Sequence[Output], share: int) -> dict[str, Measured]:
    """Measure reductions of one quantity's samples, by the reference of each reduction.

    The sample of a greatest or least value is chosen in doubles and computed again; others are computed again over the
    samples in doubles.
    """
    quantity = outputs[0].request.quantity
    facts = chosen.facts([quantity])
    count = chosen.affordable(facts, share, chosen.count)
    curves = chosen.curves(quantity, count)
    found: dict[str, Measured] = {}
    for output in outputs:
        reduction = output.request.reduction
        assert reduction is not None
        results = chosen.results[output.name]
        few = count if reduction.has_place else within(share, chosen.positions.size, count)
        measured = Measured(METHODS[reduction.has_place, output.request.place])
        for design, curve in enumerate(curves[:few]):
            value = float(results[design, chosen.places[design]])
            exact, size = _reduced(reduction, curve)
            if reduction.has_place and not CONTEXT.isnan(exact):
                best = int(np.flatnonzero(curve == float(exact))[0])
                if output.request.place:
                    exact, size = _chosen_place(value, curve, best, chosen.positions), None
                else:
                    exact, size = _best(chosen, facts, design, best)
            measured.add(value, exact, size)
        found[output.name] = measured
    return found


def _reduced(reduction: Reduction, curve: NDArray[Any]) -> tuple[Any, Any]:
    """Return the exact value of a reduction of samples in doubles, and the size of the terms it is made of."""
    closes = ~np.isnan(curve)
    if not closes.any() or (reduction.whole and not closes.all()):
        return CONTEXT.nan, CONTEXT.zero
    return reduction.reference([CONTEXT.mpf(sample) for sample in curve[closes].tolist()])


def _best(chosen: Chosen, facts: HighPrecision, design: int, place: int) -> tuple[Any, Any]:
    """Return the value and condition of a sample with 50 digits."""
    at = chosen.configuration(design, chosen.branches[design], chosen.positions[place])
    exact = facts.at(at)
    (name,) = facts.names
    return exact[name], facts.condition(exact, chosen.by_inputs(facts))[name]


def _chosen_place(value: float, curve: NDArray[Any], best: int, positions: NDArray[Any]) -> Any:
    """Return the position that was chosen if its sample is the best one but for rounding, else where that is."""
    here = np.flatnonzero(positions == value)
    if here.size and abs(curve[here[0]] - curve[best]) <= TIE * abs(curve[best]):
        return CONTEXT.mpf(value)
    return CONTEXT.mpf(positions[best])

"""Curves and facts of the design, and what is taken of samples, against the same facts with 50 digits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.exact import CONTEXT
from fastlink.verify.chosen import within
from fastlink.verify.measured import Measured

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from fastlink.closure import Output
    from fastlink.exact import Exact
    from fastlink.verify.chosen import Chosen

__all__ = ["sampled", "values"]

#: Configurations of each design, where they may be as many.
ANGLES = 4
#: Samples that differ by so many roundings may change places.
TIE = 64 * 2.0**-53
FACTS = "the facts with 50 digits"


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
    """Measure what is taken of one quantity's samples.

    For a greatest or least value the sample is chosen in doubles and computed again; the sum of a mean is computed
    again over the samples in doubles.
    """
    quantity = outputs[0].request.quantity
    facts = chosen.facts([quantity])
    count = chosen.affordable(facts, share, chosen.count)
    curves = chosen.curves(quantity, count)
    found: dict[str, Measured] = {}
    for output in outputs:
        reduction = output.request.reduction
        assert reduction is not None
        if not reduction.has_place:
            few = within(share, chosen.positions.size, count)
            found[output.name] = _sums(chosen, output, curves[:few])
            continue
        sign = 1.0 if reduction.suffix == "max" else -1.0
        measured = Measured(
            "the given input positions" if output.request.place else f"{FACTS}, at the sample"
        )
        results = chosen.results[output.name]
        for design in range(count):
            value = float(results[design, chosen.places[design]])
            curve = sign * curves[design]
            if np.isnan(curve).all():
                measured.add(value, CONTEXT.nan)
            elif output.request.place:
                measured.add(value, _chosen_place(value, curve, chosen.positions))
            else:
                measured.add(value, *_best(chosen, facts, design, int(np.nanargmax(curve))))
        found[output.name] = measured
    return found


def _best(chosen: Chosen, facts: Exact, design: int, place: int) -> tuple[Any, Any]:
    """Return the value and condition of a sample with 50 digits."""
    at = chosen.configuration(design, chosen.branches[design], chosen.positions[place])
    exact = facts.at(at)
    (name,) = facts.names
    return exact[name], facts.condition(exact, chosen.by_inputs(facts))[name]


def _chosen_place(value: float, curve: NDArray[Any], positions: NDArray[Any]) -> Any:
    """Return the position that was chosen if its sample is the greatest but for rounding, else where that is."""
    here = np.flatnonzero(positions == value)
    best = int(np.nanargmax(curve))
    if here.size and curve[here[0]] >= curve[best] - TIE * abs(curve[best]):
        return CONTEXT.mpf(value)
    return CONTEXT.mpf(positions[best])


def _sums(chosen: Chosen, output: Output, curves: NDArray[Any]) -> Measured:
    reduction = output.request.reduction
    assert reduction is not None
    measured = Measured("the exact sum of the samples in doubles")
    for design, curve in enumerate(curves):
        samples = [CONTEXT.mpf(float(sample)) for sample in curve if not np.isnan(sample)]
        value = float(chosen.results[output.name][design, chosen.places[design]])
        exact, size = _taken(reduction.suffix, samples)
        measured.add(value, exact, size)
    return measured


def _taken(suffix: str, samples: list[Any]) -> tuple[Any, Any]:
    """Return a mean or root mean square and the size of the terms it is made of."""
    if not samples:
        return CONTEXT.nan, CONTEXT.zero
    if suffix == "rms":
        root = CONTEXT.sqrt(CONTEXT.fsum(sample * sample for sample in samples) / len(samples))
        return root, root
    return CONTEXT.fsum(samples) / len(samples), CONTEXT.fsum(samples, absolute=True) / len(samples)

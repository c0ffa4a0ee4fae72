"""Compare curves, facts of the design and reductions of samples."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.facts.names import ErrorBound
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision.errors import MeasuredErrors, unit_of
from fastlink.precision.independent.check import IndependentValues
from fastlink.precision.reference import CONTEXT
from fastlink.precision.sample import within

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from fastlink.plan.program import Output
    from fastlink.plan.reductions import Reduction
    from fastlink.precision.reference import HighPrecision
    from fastlink.precision.sample import Sample

__all__ = ["configurations", "sampled", "values"]

#: Configurations of each design, if the budget allows.
ANGLES = 4
#: Samples that differ by less may change order.
TIED_SAMPLES = 64 * UNIT_ROUNDING
FACTS = "the facts with 50 digits"
#: The reference of a reduction, by whether it is an extreme, and whether its position is compared.
METHODS = {
    (False, False): "the exact reduction of the samples in doubles",
    (True, False): f"{FACTS}, at the sample",
    (True, True): "the given input positions",
}


def values(
    sample: Sample, outputs: Sequence[Output], share: int, rng: np.random.Generator
) -> dict[str, MeasuredErrors]:
    """Measure errors of curves and facts of the design at random configurations."""
    errors = {output.name: MeasuredErrors(FACTS) for output in outputs}
    independent = IndependentValues(sample.catalogue, errors)
    has_numbers = any(output.dtype == "float64" for output in outputs)
    as_given, as_meant = (
        sample.facts(names, zeroes=zeroes) for zeroes, names in _by_reading(sample, outputs)
    )
    for number in range(configurations(sample, outputs, share)):
        design = number % sample.count
        branch, position = rng.integers(len(sample.plan.branches)), rng.integers(sample.positions.size)
        at = sample.configuration(design, sample.plan.branches[branch], sample.positions[position])
        exact: dict[str, Any] = {}
        condition: dict[str, Any] = {}
        for facts in (as_given, as_meant):
            found = facts.at(at)
            exact |= {name: found[name] for name in facts.names}
            condition |= facts.condition(found, sample.arguments(facts)) if has_numbers else {}
        for output in outputs:
            row = sample.results[output.name][design]
            value = float(row[branch, position]) if output.axes else float(row)
            if output.dtype == "float64":
                terms, bound = sample.terms(output.name, design), partial(sample.bound, output.name, at)
                nearest = _same_turn(sample, output.name, value, exact[output.name])
                zeroed = as_given.left_out
                errors[output.name].add(value, nearest, condition[output.name], terms, bound, zeroed)
            else:
                errors[output.name].add_code(value, exact[output.name])
        if number < sample.count:  # each design once
            sizes = {name: sample.terms(name, design) for name in independent.names}
            units = {name: unit_of(exact[name], condition.get(name, 1), size) for name, size in sizes.items()}
            for name, difference in independent.differences(at, exact, units).items():
                errors[name].add_independent(difference)
    return errors


def _by_reading(sample: Sample, outputs: Sequence[Output]) -> list[tuple[bool, list[str]]]:
    """Return the names of numbers, then of codes and error bounds: they say which gaps count as zero, and why."""

    def zeroes(output: Output) -> bool:
        is_bound = isinstance(sample.catalogue.parse(output.name), ErrorBound)
        return is_bound or output.dtype != "float64"

    return [(which, [o.name for o in outputs if zeroes(o) is which]) for which in (False, True)]


def _same_turn(sample: Sample, quantity: str, value: float, exact: Any) -> Any:
    """Return an exact value; of an angle that is pi for one rounding and -pi for another, the nearer one."""
    graded = sample.catalogue.graded
    if graded is None or quantity not in graded.wraps_at or not abs(value - exact) > CONTEXT.pi:
        return exact
    return exact + 2 * CONTEXT.pi * CONTEXT.nint((CONTEXT.mpf(value) - exact) / (2 * CONTEXT.pi))


def configurations(sample: Sample, outputs: Sequence[Output], share: int) -> int:
    """Return at how many configurations curves and facts of the design are compared."""
    most = sample.count * (ANGLES if any(output.axes for output in outputs) else 1)
    if not any(output.dtype == "float64" for output in outputs):
        return most
    return sample.affordable(sample.facts([output.name for output in outputs]), share, most)


def sampled(sample: Sample, outputs: Sequence[Output], share: int) -> dict[str, MeasuredErrors]:
    """Measure errors of reductions of one quantity's samples, by their references.

    The sample of a greatest or least value is chosen in doubles and computed with 50 digits; other reductions are
    computed with 50 digits from the samples in doubles.
    """
    quantity = outputs[0].request.quantity
    facts = sample.facts([quantity])
    count = sample.affordable(facts, share, sample.count)
    curves = sample.curves(quantity, count)
    if counted := next((output.counted for output in outputs if output.counted), ""):
        curves = np.where(np.isnan(sample.curves(counted, count)), np.nan, curves)
    independent = IndependentValues(sample.catalogue, [quantity])
    errors: dict[str, MeasuredErrors] = {}
    for output in outputs:
        reduction = output.request.reduction
        assert reduction is not None
        compared = count if reduction.has_position else within(share, sample.positions.size, count)
        measured = MeasuredErrors(METHODS[reduction.has_position, output.request.is_position])
        for design, curve in enumerate(curves[:compared]):
            value = float(sample.result(output.name, design))
            exact, size = _reduced(reduction, curve)
            if output.toggles and curve.any() and _meets_toggle(sample, output, design):
                exact = CONTEXT.nan  # the integral does not exist, or is infinite
            if reduction.has_position and not CONTEXT.isnan(exact):
                best = int(np.flatnonzero(curve == float(exact))[0])
                if output.request.is_position:
                    exact, size = _selected_position(value, curve, best, sample.positions), None
                else:
                    at = sample.configuration(design, sample.branches[design], sample.positions[best])
                    exact, size = _exact_sample(sample, facts, at)
                    unit = unit_of(exact, size, sample.terms(quantity, design))
                    measured.add_independent(independent.difference(at, quantity, exact, unit))
            of_quantity = reduction.has_position and not output.request.is_position
            terms = sample.terms(quantity, design) if of_quantity else 0.0
            measured.add(value, exact, size, terms, zeroed=of_quantity and facts.left_out)
        errors[output.name] = measured
    return errors


def _meets_toggle(sample: Sample, output: Output, design: int) -> bool:
    """Tell whether the turn of a design has a toggle."""
    at = sample.configuration(design, sample.branches[design], sample.positions[0])
    known = sample.facts(output.toggles, zeroes=True).at(at)
    return any(known[name] > 0 for name in output.toggles)


def _reduced(reduction: Reduction, curve: NDArray[Any]) -> tuple[Any, Any]:
    """Return the exact value of a reduction of samples, and the size of its terms."""
    assembles = ~np.isnan(curve)
    if not assembles.any() or (reduction.whole and not assembles.all()):
        return CONTEXT.nan, CONTEXT.zero
    return reduction.reference([CONTEXT.mpf(value) for value in curve[assembles].tolist()])


def _exact_sample(sample: Sample, facts: HighPrecision, at: Mapping[str, float]) -> tuple[Any, Any]:
    """Return the value and condition of a curve at one configuration with 50 digits."""
    exact = facts.at(at)
    (name,) = facts.names
    return exact[name], facts.condition(exact, sample.arguments(facts))[name]


def _selected_position(value: float, curve: NDArray[Any], best: int, positions: NDArray[Any]) -> Any:
    """Return a position if its sample is the best up to rounding, else the best one's."""
    selected = np.flatnonzero(positions == value)
    if selected.size and abs(curve[selected[0]] - curve[best]) <= TIED_SAMPLES * abs(curve[best]):
        return CONTEXT.mpf(value)
    return CONTEXT.mpf(positions[best])

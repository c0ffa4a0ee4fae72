"""Compare greatest and least values, their positions, and lists of extremes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.precision.errors import MeasuredErrors, unit_of
from fastlink.precision.independent.check import IndependentValues
from fastlink.precision.reference import CONTEXT
from fastlink.precision.sample import cost, within
from fastlink.precision.stationary import END, JUMP, Extreme, Stationary

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from fastlink.plan.program import Output
    from fastlink.plan.reductions import Reduction
    from fastlink.precision.sample import Sample

__all__ = ["outermost", "refined"]

TURN = 2 * CONTEXT.pi
METHOD = "extremes refined with 50 digits"
BOUNDED = f"errors against {METHOD}"
#: Extremes whose values differ by less may change order: a search in doubles cannot tell them apart.
TIED_EXTREMA = 1e-12
#: The cost of finding an extreme in evaluations, without its condition.
EVALUATIONS = 12


def outermost(
    stationary: Stationary, design: int, sign: int, *, near: float | None = None, of_all: bool = False
) -> Extreme:
    """Return the greatest (sign 1) or least (-1) value of a design, with 50 digits.

    Parameters
    ----------
    stationary : Stationary
        The extremes of a quantity.
    design : int
        Index of the design.
    sign : int
        1 or -1.
    near : float, optional
        The input angle that a sweep found; among equal extremes the nearest one is returned, with the condition of
        its position.
    of_all : bool
        Whether the very greatest is returned, of those that doubles cannot tell apart, too; else any of them.
    """
    candidates = stationary.candidates[design]
    ends = [stationary.extreme(design, candidate) for candidate in candidates if candidate.kind == END]
    if any(c.kind == JUMP for c in candidates) or any(map(stationary.is_half_turn, ends)):
        return Extreme(sign * CONTEXT.pi, CONTEXT.zero, CONTEXT.nan, CONTEXT.zero)
    inner = [candidate for candidate in candidates if candidate.kind == sign]
    best = max((sign * candidate.value for candidate in inner), default=-np.inf)
    tied = [c for c in inner if sign * c.value >= best - TIED_EXTREMA * abs(best)]
    tied = tied[:1] if near is None and not of_all else tied
    extremes = [stationary.extreme(design, c, positions=near is not None) for c in tied]
    extremes += [end for end in ends if not CONTEXT.isnan(end.value)]
    greatest = max((sign * extreme.value for extreme in extremes), default=-CONTEXT.inf)
    sample, size = stationary.largest_sample(design, sign), stationary.size(design)
    if not extremes or sign * sample > greatest + TIED_EXTREMA * size:
        # a constant, an extreme that no slope shows, or no value at all
        return Extreme(CONTEXT.mpf(sample), CONTEXT.mpf(size), CONTEXT.nan, CONTEXT.zero)
    if of_all:
        return max((e for e in extremes if not CONTEXT.isnan(e.value)), key=lambda e: sign * e.value)
    equal = [
        e for e in extremes if sign * e.value >= greatest - TIED_EXTREMA * size or sign * e.value == greatest
    ]
    return equal[0] if near is None else min(equal, key=lambda e: _distance(near, e.position))


def refined(sample: Sample, outputs: Sequence[Output], share: int) -> dict[str, MeasuredErrors]:
    """Measure the errors of all results that belong to the extremes of one quantity."""
    quantity = outputs[0].request.quantity
    parts = {_part(output): output for output in outputs}
    errors = {
        part: MeasuredErrors(
            BOUNDED if output.request.is_error else METHOD, TURN if _is_position(output) else 0
        )
        for part, output in parts.items()
    }
    count = affordable(sample, quantity, share, outputs)
    inputs = {name: column[:count] for name, column in sample.inputs.items()}
    designs = sample.catalogue, quantity, inputs, sample.branches[:count], sample.plan.variants
    stationary = as_meant = Stationary(*designs)
    zeroed = [stationary.zeroed(design) for design in range(count)]
    if "value" in parts and any(zeroed):
        as_meant = Stationary(*designs, zeroes=True)  # which extremes there are is a decision, like a code
    independent = IndependentValues(sample.catalogue, [quantity])
    for design in range(count):
        results = {part: sample.result(output.name, design) for part, output in parts.items()}
        for reduction in _reductions(outputs):
            exact = _compare_outermost(stationary, design, reduction, results, errors, zeroed[design])
            if reduction.suffix in errors:
                _confirm(sample, design, exact, independent, errors[reduction.suffix])
        if "value" in parts:
            for exact in _compare_list(as_meant, design, results, errors)[: not zeroed[design]]:
                _confirm(sample, design, exact, independent, errors["value"])
    return {parts[part].name: measured for part, measured in errors.items()}


def _compare_outermost(
    stationary: Stationary,
    design: int,
    reduction: Reduction,
    results: Mapping[str, Any],
    errors: Mapping[str, MeasuredErrors],
    zeroed: bool,
) -> Extreme:
    value, position = reduction.suffix, f"at {reduction.suffix}"
    near = float(results[position]) if position in results and np.isfinite(results[position]) else None
    exact = outermost(stationary, design, reduction.sign, near=near)
    if value in results:
        errors[value].add(float(results[value]), exact.value, exact.condition, zeroed=zeroed)
    if _bound_of(value) in results:
        greatest = outermost(stationary, design, reduction.sign, of_all=True)
        if not CONTEXT.isnan(greatest.position):  # else it is a sample in doubles
            bound = float(results[_bound_of(value)])
            errors[_bound_of(value)].add_bound(bound, float(results[value]), greatest.value)
    if position in results and not (CONTEXT.isnan(exact.position) and CONTEXT.isfinite(exact.value)):
        _add_position(errors[position], float(results[position]), exact)
    return exact


def _compare_list(
    stationary: Stationary, design: int, results: Mapping[str, Any], errors: Mapping[str, MeasuredErrors]
) -> list[Extreme]:
    candidates = [c for c in stationary.candidates[design] if c.kind in (1, -1)]
    compared = []
    present = int(np.isfinite(results["value"]).sum())
    if "count" in results:
        errors["count"].add_code(float(results["count"]), len(candidates))
    for k in range(max(present, len(candidates))):
        if k >= present or not candidates:  # one that the sweep missed, or one that does not exist
            errors["value"].add_mismatch()
            continue
        near = float(results["position"][k])
        nearest = min(candidates, key=lambda c: _distance(near, stationary.angle(design, c)))
        candidates.remove(nearest)
        exact = stationary.extreme(design, nearest, positions=True)
        errors["value"].add(float(results["value"][k]), exact.value, exact.condition)
        if _bound_of("") in results:
            errors[_bound_of("")].add_bound(
                float(results[_bound_of("")][k]), float(results["value"][k]), exact.value
            )
        if "position" in results:
            _add_position(errors["position"], near, exact)
        if "kind" in results:
            errors["kind"].add_code(float(results["kind"][k]), nearest.kind)
        compared.append(exact)
    return compared


def _confirm(
    sample: Sample, design: int, exact: Extreme, independent: IndependentValues, measured: MeasuredErrors
) -> None:
    """Compare the value of a stationary extreme with an independent one at its position."""
    if exact.is_stationary and CONTEXT.isfinite(exact.value) and independent.names:
        (quantity,) = independent.names
        at = sample.configuration(design, sample.branches[design], exact.position)
        unit = unit_of(exact.value, exact.condition, sample.terms(quantity, design))
        measured.add_independent(independent.difference(at, quantity, exact.value, unit))


def _add_position(measured: MeasuredErrors, value: float, exact: Extreme) -> None:
    """Compare input angles modulo a turn, relative to a whole one."""
    turns = CONTEXT.nint((CONTEXT.mpf(value) - exact.position) / TURN) if np.isfinite(value) else 0
    measured.add(value, exact.position + turns * TURN, TURN + exact.position_condition)


def _distance(angle: float, other: Any) -> float:
    """Return the distance of two angles over the turn."""
    return abs((angle - float(other) + np.pi) % (2 * np.pi) - np.pi)


def _reductions(outputs: Sequence[Output]) -> list[Reduction]:
    """Return the reductions of some outputs, each once."""
    return list(dict.fromkeys(o.request.reduction for o in outputs if o.request.reduction is not None))


def _part(output: Output) -> str:
    """Return the part of an output: [at] SUFFIX, value, position, count or kind, or SUFFIX with error."""
    request = output.request
    if request.is_error:
        return _bound_of(request.reduction.suffix if request.reduction is not None else "")
    if request.reduction is None:
        return request.listed
    return f"at {request.reduction.suffix}" if request.is_position else request.reduction.suffix


def _bound_of(suffix: str) -> str:
    """Return the part of the error bound of an extreme, or of those of a list, which has no suffix."""
    return f"{suffix} error"


def _is_position(output: Output) -> bool:
    return output.request.is_position or output.request.listed == "position"


def affordable(sample: Sample, quantity: str, share: int, outputs: Sequence[Output]) -> int:
    """Return the number of designs whose extremes a share of the evaluations pays for."""
    has_list = any(output.request.listed == "value" for output in outputs)
    searches = len(_reductions(outputs)) + 4 * has_list
    facts = sample.facts([quantity])
    condition = sum(cost(facts.steps_after(name)) for name in sample.movable)
    if any(map(_is_position, outputs)):
        condition *= 5
    each = cost(facts.steps) + EVALUATIONS * len(facts.steps) + condition
    return within(share, each * searches, sample.count)

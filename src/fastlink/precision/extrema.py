"""Exact greatest and least values, their places, and lists of extremes, against `fastlink.precision.stationary`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.precision.errors import Measured
from fastlink.precision.reference import CONTEXT
from fastlink.precision.sample import cost, within
from fastlink.precision.stationary import END, JUMP, Extreme, Stationary

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fastlink.plan.program import Output
    from fastlink.plan.reductions import Reduction
    from fastlink.precision.sample import Chosen

__all__ = ["outermost", "refined"]

TURN = 2 * CONTEXT.pi
METHOD = "extremes refined with 50 digits"
#: Extremes whose values differ by so much may change places: a search by doubles tells no more.
TIE = 1e-12
#: What finding an extreme costs in evaluations, beside its condition.
EVALUATIONS = 12


def outermost(stationary: Stationary, design: int, sign: int, *, near: float | None = None) -> Extreme:
    """Return the greatest (sign 1) or least (-1) value of a design over the reachable range, with 50 digits.

    Parameters
    ----------
    stationary : Stationary
        The extremes of a quantity.
    design : int
        Which design.
    sign : int
        1 or -1.
    near : float, optional
        The input angle that a sweep found; among equal extremes the one next to it is returned, with its condition.
    """
    candidates = stationary.candidates[design]
    ends = [stationary.extreme(design, candidate) for candidate in candidates if candidate.kind == END]
    if any(c.kind == JUMP for c in candidates) or any(map(stationary.is_half_turn, ends)):
        return Extreme(sign * CONTEXT.pi, CONTEXT.zero, CONTEXT.nan, CONTEXT.zero)
    inner = [candidate for candidate in candidates if candidate.kind == sign]
    best = max((sign * candidate.value for candidate in inner), default=-np.inf)
    tied = [c for c in inner if sign * c.value >= best - TIE * abs(best)]
    found = [
        stationary.extreme(design, c, places=near is not None) for c in tied[: 1 if near is None else None]
    ]
    found += [end for end in ends if not CONTEXT.isnan(end.value)]
    greatest = max((sign * extreme.value for extreme in found), default=-CONTEXT.inf)
    sample, size = stationary.largest_sample(design, sign), stationary.size(design)
    if (
        not found or sign * sample > greatest + TIE * size
    ):  # a constant, or what no slope shows, or nothing at all
        return Extreme(CONTEXT.mpf(sample), CONTEXT.mpf(size), CONTEXT.nan, CONTEXT.zero)
    equal = [e for e in found if sign * e.value >= greatest - TIE * size or sign * e.value == greatest]
    return equal[0] if near is None else min(equal, key=lambda e: _apart(near, e.place))


def refined(chosen: Chosen, outputs: Sequence[Output], share: int) -> dict[str, Measured]:
    """Measure everything that is said of the extremes of one quantity."""
    quantity = outputs[0].request.quantity
    names = {_part(output): output.name for output in outputs}
    found = {output.name: Measured(METHOD, TURN if _is_place(output) else 0) for output in outputs}
    count = _affordable(chosen, quantity, share, outputs)
    stationary = Stationary(
        chosen.catalogue,
        quantity,
        {name: column[:count] for name, column in chosen.inputs.items()},
        chosen.branches[:count],
        chosen.plan.variants,
    )
    for design in range(count):
        results = {part: chosen.results[name][design, chosen.places[design]] for part, name in names.items()}
        for reduction in _reductions(outputs):
            _compare_outermost(stationary, design, reduction, results, names, found)
        if "value" in names:
            _compare_list(stationary, design, results, names, found)
    return found


def _compare_outermost(
    stationary: Stationary,
    design: int,
    reduction: Reduction,
    results: dict[str, Any],
    names: dict[str, str],
    found: dict[str, Measured],
) -> None:
    suffix, place = reduction.suffix, f"at {reduction.suffix}"
    near = float(results[place]) if place in names and np.isfinite(results[place]) else None
    exact = outermost(stationary, design, reduction.sign, near=near)
    if suffix in names:
        found[names[suffix]].add(float(results[suffix]), exact.value, exact.condition)
    if place in names and not (CONTEXT.isnan(exact.place) and CONTEXT.isfinite(exact.value)):
        _add_place(found[names[place]], float(results[place]), exact)


def _compare_list(
    stationary: Stationary,
    design: int,
    results: dict[str, Any],
    names: dict[str, str],
    found: dict[str, Measured],
) -> None:
    candidates = [c for c in stationary.candidates[design] if c.kind in (1, -1)]
    kinds = {part: found[name] for part, name in names.items()}
    present = int(np.isfinite(results["value"]).sum())
    if "count" in names:
        kinds["count"].add_code(float(results["count"]), len(candidates))
    for k in range(max(present, len(candidates))):
        if k >= present or not candidates:  # one that is missed, or that is none
            kinds["value"].values += 1
            kinds["value"].mismatches += 1
            continue
        near = float(results["place"][k])
        nearest = min(candidates, key=lambda c: _apart(near, stationary.angle(design, c)))
        candidates.remove(nearest)
        exact = stationary.extreme(design, nearest, places=True)
        kinds["value"].add(float(results["value"][k]), exact.value, exact.condition)
        if "place" in names:
            _add_place(kinds["place"], near, exact)
        if "kind" in names:
            kinds["kind"].add_code(float(results["kind"][k]), nearest.kind)


def _add_place(measured: Measured, value: float, exact: Extreme) -> None:
    """Compare input angles over the turn; what they are relative to is a whole one."""
    turns = CONTEXT.nint((CONTEXT.mpf(value) - exact.place) / TURN) if np.isfinite(value) else 0
    measured.add(value, exact.place + turns * TURN, TURN + exact.place_condition)


def _apart(angle: float, other: Any) -> float:
    """Return the distance of two angles over the turn."""
    return abs((angle - float(other) + np.pi) % (2 * np.pi) - np.pi)


def _reductions(outputs: Sequence[Output]) -> list[Reduction]:
    """Return the reductions of some outputs, each once."""
    return list(dict.fromkeys(o.request.reduction for o in outputs if o.request.reduction is not None))


def _part(output: Output) -> str:
    """Return the part of an output: a reduction's suffix, "at" with it, "value", "place", "count" or "kind"."""
    request = output.request
    if request.reduction is None:
        return request.listed
    return f"at {request.reduction.suffix}" if request.place else request.reduction.suffix


def _is_place(output: Output) -> bool:
    return output.request.place or output.request.listed == "place"


def _affordable(chosen: Chosen, quantity: str, share: int, outputs: Sequence[Output]) -> int:
    """Return for how many designs the extremes may be computed again."""
    parts = {_part(output) for output in outputs}
    searches = len(_reductions(outputs)) + 4 * ("value" in parts)
    places = any(_is_place(output) for output in outputs)
    facts = chosen.facts([quantity])
    condition = sum(cost(facts.steps_after(name)) for name in chosen.movable)
    each = cost(facts.steps) + EVALUATIONS * len(facts.steps) + condition * (5 if places else 1)
    return within(share, each * searches, chosen.count)

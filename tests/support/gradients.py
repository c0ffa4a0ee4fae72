"""Derivatives of extremes by inputs: those of sweeps, and differences of extremes with 50 digits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

import fastlink as fl
from fastlink.facts.names import Derivative, GradientStatus, Quantity, Reduced
from fastlink.numerics.compiler import AT_LIMIT, SMOOTH
from fastlink.precision.errors import outermost
from fastlink.precision.reference import CONTEXT as MP
from fastlink.precision.stationary import Stationary
from tests.support.registry import Entry

SIGNS = {"max": 1, "min": -1}
#: Of an input, by which it is moved for a difference, and twice that: the powers of both beyond the second are left.
#: With 50 digits nothing is lost to cancellation; a step of 2**-12 was off by 3e-7 for one least force.
STEP = 2.0**-16
#: What a derivative that vanishes may be off, its terms being of the size of the inputs over the one that is moved.
ROUNDINGS = 2.0**-46


@dataclass(frozen=True)
class Compared:
    """One derivative: which it is, of which design, as computed and as difference, and how far that may be off."""

    of: str
    inputs: dict[str, float]
    status: int
    value: float
    exact: float
    tolerance: float

    @property
    def holds(self) -> bool:
        return abs(self.value - self.exact) <= self.tolerance


def compared(
    entry: Entry,
    designs: dict[str, np.ndarray],
    quantities: Sequence[str],
    inputs: Sequence[str],
    *,
    places: bool,
) -> Iterator[Compared]:
    """Yield derivatives of greatest and least values, or of their places, that are of extremes without a tie."""
    catalogue, variants = entry.catalogue, entry.catalogue.variants_selected_by(designs)
    at = catalogue.position.name if places else ""
    ends = [(name, how) for name in quantities for how in SIGNS]
    status = {end: str(GradientStatus(Reduced(Quantity(end[0]), end[1]))) for end in ends}
    wanted = {
        (*end, by): str(Derivative(Reduced(Quantity(end[0]), end[1], at), by))
        for end in ends
        for by in inputs
    }
    extremes = {end: str(Reduced(Quantity(end[0]), end[1])) for end in ends}
    options = {"input": entry.input, "allow_invalid": True, "progress": False, "verify": 0}
    names = [*wanted.values(), *status.values(), *extremes.values()]
    found = fl.sweep(entry.mechanism, fl.table(designs), names, **options)
    for (quantity, how, by), name in wanted.items():
        for k in range(len(next(iter(designs.values())))):
            for b, branch in enumerate(found["branch"].values.tolist()):
                code = int(found[status[quantity, how]].values[k, b])
                if code not in (SMOOTH, AT_LIMIT):
                    continue
                inputs_of = {key: float(column[k]) for key, column in designs.items()}
                at_k = inputs_of[by]
                moved = {key: np.full(4, value) for key, value in inputs_of.items()}
                moved[by] = at_k * (1.0 + STEP * np.array([1.0, -1.0, 2.0, -2.0]))
                exact = _difference(
                    Stationary(catalogue, quantity, moved, np.full(4, branch), variants),
                    moved[by],
                    SIGNS[how],
                    places,
                )
                extreme = float(found[extremes[quantity, how]].values[k, b])
                if exact is not None and not _on_another_turn(extreme, exact.of):
                    tolerance = exact.tolerance + ROUNDINGS * (
                        1 + max(map(abs, inputs_of.values())) / abs(at_k)
                    )
                    value = float(found[name].values[k, b])
                    yield Compared(name, inputs_of, code, value, exact.value, tolerance)


class Difference(NamedTuple):
    """A derivative by differences, how far it may be off, and the extreme that it is of."""

    value: float
    tolerance: float
    of: float


def _on_another_turn(found: float, exact: float) -> bool:
    """Tell whether an angle that reaches pi at a limit of motion alone is pi there for one, and -pi for the other."""
    return abs(abs(exact) - math.pi) < 1e-15 and abs(found - exact) > 1e-6


def _difference(stationary: Stationary, at: np.ndarray, sign: int, places: bool) -> Difference | None:
    """Return the derivative by central differences, and how far it may be off; None where they do not settle."""
    extremes = [outermost(stationary, k, sign, of_all=True) for k in range(4)]
    values = [extreme.position if places else extreme.value for extreme in extremes]
    if not all(MP.isfinite(value) for value in values):
        return None
    fine, coarse = ((values[k] - values[k + 1]) / (MP.mpf(at[k]) - MP.mpf(at[k + 1])) for k in (0, 2))
    exact, off = (4 * fine - coarse) / 3, abs(fine - coarse)
    size = abs(exact) + abs(values[0] / at[0])
    if off > 1e-4 * size:  # an extreme that another one overtakes, or a change point nearby
        return None
    # what is left of the differences is a power of the step more; what is computed has a millionth of its digits left
    return Difference(float(exact), float(1e-2 * off + 1e-10 * size), float(extremes[0].value))

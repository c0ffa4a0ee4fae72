"""Extremes of sweeps, with their error bounds, against the same extremes with 50 digits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import fastlink as fl
from fastlink.plan.programs import Planner
from fastlink.precision.reference import CONTEXT as MP
from fastlink.precision.stationary import END, JUMP, Extreme, Stationary
from tests.support.precision import in_every_mode
from tests.support.registry import Entry

#: Extremes nearer to each other in the input position are not told apart.
NEAR = 1e-3


@dataclass(frozen=True)
class Bounded:
    """One extreme: which it is, its value with the error bound, the exact value."""

    of: str
    inputs: dict[str, float]
    value: float
    bound: float
    exact: Any

    @property
    def error(self) -> float:
        """How far the value is from the exact one; 0 where both are the same infinity."""
        return 0.0 if self.value == self.exact else float(abs(MP.mpf(self.value) - self.exact))

    @property
    def holds(self) -> bool:
        """Whether the exact value is within the bound: NaN goes with NaN, what is not finite has no finite bound."""
        if np.isnan(self.value) or MP.isnan(self.exact):
            return bool(np.isnan(self.value) and np.isnan(self.bound))
        if not np.isfinite(self.value) or not MP.isfinite(self.exact):
            return self.bound == np.inf
        return self.error <= self.bound


def designs_of(entry: Entry, kind: str, seed: int, n: int) -> dict[str, np.ndarray]:
    """Return designs of a family of configurations, in every mode but the branch."""
    drawn = in_every_mode(entry, entry.drawn(kind, seed, n))
    first = drawn.get("branch", np.ones(1))[0]
    kept = drawn.get("branch", np.full(len(next(iter(drawn.values()))), first)) == first
    columns = {name: values[kept] for name, values in drawn.items() if name not in ("branch", entry.input)}
    return {name: np.asarray(values, dtype=float) for name, values in columns.items()}


def searched(entry: Entry, designs: dict[str, np.ndarray]) -> list[str]:
    """Return the quantities whose extremes are searched."""
    catalogue = entry.catalogue
    variants = catalogue.variants_selected_by(designs)
    names = [name for name in catalogue.public if catalogue.has_reductions(name)]
    found = ((name, Planner(catalogue, tuple(designs), tuple(variants)).search(name)) for name in names)
    return [name for name, search in found if search is not None and not catalogue.public[name].flags]


def bounded_extremes(entry: Entry, designs: dict[str, np.ndarray], names: Iterable[str]) -> Iterator[Bounded]:
    """Yield greatest, least and listed extremes of quantities of designs."""
    names = tuple(names)
    wanted = [f"{name}_{part}" for name in names for part in ("max", "max_error", "min", "min_error")]
    wanted += [f"{name}_{part}" for name in names for part in ("extrema", "extrema_error")]
    found = fl.sweep(
        entry.mechanism,
        fl.table(designs),
        wanted,
        input=entry.input,
        allow_invalid=True,
        progress=False,
        verify=0,
    )
    catalogue = entry.catalogue
    variants = catalogue.variants_selected_by(designs)
    count = len(next(iter(designs.values())))
    for name in names:
        for branch in found["branch"].values:
            mode = found.sel(branch=branch)
            exact = Stationary(catalogue, name, designs, np.full(count, float(branch)), variants)
            exact.movable = []  # conditions, which take most of the time, are not needed
            for k in range(count):
                inputs = {key: float(values[k]) for key, values in designs.items()} | {
                    "branch": float(branch)
                }
                yield from _of_design(exact, k, inputs, mode.isel(design=k), name, entry.input)


def _of_design(
    exact: Stationary, design: int, inputs: dict[str, float], mode: Any, name: str, position: str
) -> Iterator[Bounded]:
    candidates = exact.candidates[design]
    inner = [exact.extreme(design, one) for one in candidates if one.kind in (1, -1)]
    ends = [
        end
        for end in (exact.extreme(design, c) for c in candidates if c.kind == END)
        if not MP.isnan(end.value)
    ]
    jumps = any(c.kind == JUMP for c in candidates) or any(map(exact.is_half_turn, ends))
    for which, sign in (("max", 1), ("min", -1)):
        value, bound = (float(mode[f"{name}_{part}"]) for part in (which, f"{which}_error"))
        known = [one.value for one in (*inner, *ends)]
        outermost = sign * MP.pi if jumps else sign * max((sign * one for one in known), default=MP.nan)
        if not known and not jumps and not np.isnan(value):  # constant: any place will do
            outermost = MP.mpf(exact.largest_sample(design, sign))
        yield Bounded(f"{name}_{which}", inputs, value, bound, outermost)
    parts = (f"{name}_extrema", f"{name}_extrema_error", f"{position}_at_{name}_extrema")
    for value, bound, place in zip(*(mode[part].values for part in parts), strict=True):
        near = _nearest(inner, float(place)) if np.isfinite(value) else None
        if near is not None:
            yield Bounded(f"{name}_extrema", inputs, float(value), float(bound), near.value)
        elif np.isnan(value) != np.isnan(bound):
            yield Bounded(f"{name}_extrema", inputs, float(value), float(bound), MP.nan)


def _nearest(extremes: list[Extreme], place: float) -> Extreme | None:
    """Return the one exact extreme that is near a place; None where there is none, or two."""
    near = [
        one for one in extremes if abs((float(one.position) - place + np.pi) % (2 * np.pi) - np.pi) < NEAR
    ]
    return near[0] if len(near) == 1 else None

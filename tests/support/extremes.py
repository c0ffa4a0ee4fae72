"""Extremes of sweeps against other ways to them: 50 digits, differences of these, values of the same quantity."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import fastlink as fl
from fastlink.facts.names import Derivative, GradientStatus, Quantity, Reduced
from fastlink.numerics.compiler import AT_LIMIT, SMOOTH
from fastlink.plan.programs import Planner
from fastlink.precision.errors import outermost
from fastlink.precision.reference import CONTEXT as MP
from fastlink.precision.stationary import END, JUMP, Extreme, Stationary
from tests.support.configurations import design_of
from tests.support.precision import in_every_mode
from tests.support.registry import ENTRIES, Entry
from tests.support.sweeps import sweep_4r, sweep_both

#: Mechanisms by each input over which extremes are searched, once.
SEARCHED = [
    entry
    for entry in ENTRIES
    if entry.moves and entry.catalogue.graded and entry.solver == "eliminated" and not entry.about
]
SIGNS = {"max": 1, "min": -1}
QUIET: dict[str, Any] = {"allow_invalid": True, "progress": False, "verify": 0}
#: Extremes nearer to each other in the input position are not told apart.
NEAR = 1e-3


def designs_of(entry: Entry, kind: str, seed: int, n: int) -> dict[str, np.ndarray]:
    """Return designs of a family of configurations, in every mode but the branch."""
    drawn = in_every_mode(entry, entry.drawn(kind, seed, n))
    first = drawn.get("branch", np.ones(1))[0]
    kept = drawn.get("branch", np.full(len(next(iter(drawn.values()))), first)) == first
    columns = {name: values[kept] for name, values in drawn.items() if name not in ("branch", entry.input)}
    return {name: np.asarray(values, dtype=float) for name, values in columns.items()}


def search_of(entry: Entry, name: str, designs: Iterable[str] = ()) -> Any:
    """Return the search for the extremes of a quantity, with inputs by which variants are selected; None if none."""
    given = tuple(designs) or tuple(entry.catalogue.inputs)
    return Planner(entry.catalogue, tuple(given), tuple(entry.catalogue.variants_selected_by(given))).search(
        name
    )


def swept_4r(
    names: Iterable[str], lengths: Sequence[float] = (0.4, 1.2, 0.8, 1.0), omega1: Any = 1.0, **options: Any
) -> Any:
    """Return quantities of one planar 4R, invalid or not."""
    design = design_of(*lengths) | {"omega1": omega1} | options.pop("point", {})
    return sweep_4r(fl.grid(**design), names, **{"progress": False, "allow_invalid": True} | options)


def searched(entry: Entry, designs: dict[str, np.ndarray]) -> list[str]:
    """Return the quantities whose extremes are searched."""
    catalogue = entry.catalogue
    names = [name for name in catalogue.public if catalogue.has_reductions(name)]
    return [name for name in names if search_of(entry, name, designs) and not catalogue.public[name].flags]


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


def bounded_extremes(entry: Entry, designs: dict[str, np.ndarray], names: Iterable[str]) -> Iterator[Bounded]:
    """Yield greatest, least and listed extremes of quantities of designs."""
    names = tuple(names)
    parts = ("max", "max_error", "min", "min_error", "extrema", "extrema_error")
    wanted = [f"{name}_{part}" for name in names for part in parts]
    found = sweep_both(entry.mechanism, fl.table(designs), wanted, input=entry.input, **QUIET)
    variants = entry.catalogue.variants_selected_by(designs)
    count = len(next(iter(designs.values())))
    for name in names:
        for branch in map(float, found["branch"].values):
            mode = found.sel(branch=branch)
            exact = Stationary(entry.catalogue, name, designs, np.full(count, branch), variants)
            exact.movable = []  # conditions, which take most of the time, are not needed
            for k in range(count):
                inputs = {key: float(values[k]) for key, values in designs.items()} | {"branch": branch}
                yield from _of_design(exact, k, inputs, mode.isel(design=k), name, entry.input)


def _of_design(
    exact: Stationary, design: int, inputs: dict[str, float], mode: Any, name: str, position: str
) -> Iterator[Bounded]:
    candidates = exact.candidates[design]
    inner = [exact.extreme(design, one) for one in candidates if one.kind in (1, -1)]
    ends = [exact.extreme(design, one) for one in candidates if one.kind == END]
    ends = [end for end in ends if not MP.isnan(end.value)]
    jumps = any(c.kind == JUMP for c in candidates) or any(map(exact.is_half_turn, ends))
    for which, sign in SIGNS.items():
        value, bound = (float(mode[f"{name}_{part}"]) for part in (which, f"{which}_error"))
        known = [one.value for one in (*inner, *ends)]
        best = sign * MP.pi if jumps else sign * max((sign * one for one in known), default=MP.nan)
        if not known and not jumps and not np.isnan(value):  # constant: any place will do
            best = MP.mpf(exact.largest_sample(design, sign))
        yield Bounded(f"{name}_{which}", inputs, value, bound, best)
    parts = (f"{name}_extrema", f"{name}_extrema_error", f"{position}_at_{name}_extrema")
    for value, bound, place in zip(*(mode[part].values for part in parts), strict=True):
        near = _nearest(inner, float(place)) if np.isfinite(value) else None
        if near is not None:
            yield Bounded(f"{name}_extrema", inputs, float(value), float(bound), near.value)
        elif np.isnan(value) != np.isnan(bound):
            yield Bounded(f"{name}_extrema", inputs, float(value), float(bound), MP.nan)


def _nearest(extremes: list[Extreme], place: float) -> Extreme | None:
    """Return the one exact extreme that is near a place; None where there is none, or two."""
    apart = [abs((float(one.position) - place + np.pi) % (2 * np.pi) - np.pi) for one in extremes]
    near = [one for one, distance in zip(extremes, apart, strict=True) if distance < NEAR]
    return near[0] if len(near) == 1 else None


def assert_none_beyond(
    mechanism: str,
    drive: str | None,
    designs: dict[str, np.ndarray],
    names: Sequence[str],
    positions: np.ndarray,
    branches: Sequence[int] = (1, 2),
) -> dict[str, np.ndarray]:
    """Assert that no value is beyond greatest and least by both bounds; return these, (designs, branches)."""
    ends = [f"{name}_{end}{of}" for name in names for end in SIGNS for of in ("", "_error")]
    maps = fl.sweep(mechanism, fl.table(designs), ends, input=drive, branch=branches, **QUIET)
    drive = str(maps.attrs["input"])
    columns = {name: values[:, None] for name, values in designs.items()}
    seen, shape = 0, np.broadcast_shapes(positions.shape, next(iter(columns.values())).shape)
    for k, branch in enumerate(branches):
        wanted = [*names, *(f"{name}_error" for name in names)]
        at = {"branch": float(branch), "allow_invalid": True, drive: positions}
        found = fl.evaluate(mechanism, wanted, input=drive, **columns, **at)
        for name in names:
            value, error = (np.broadcast_to(found[f"{name}{of}"], shape) for of in ("", "_error"))
            known = np.isfinite(value) & np.isfinite(error)
            seen += np.count_nonzero(known)
            for end, sign in SIGNS.items():
                best, bound = (maps[f"{name}_{end}{of}"].values[:, k, None] for of in ("", "_error"))
                with np.errstate(invalid="ignore"):
                    beyond = known & (sign * value - error > sign * best + bound)
                assert not beyond.any(), (name, end, branch, np.argwhere(beyond)[:5].tolist())
    assert seen
    return {name: maps[name].values for name in ends}


#: Of an input, by which it is moved for a difference, and twice that: the powers of both beyond the second are left.
#: With 50 digits nothing is lost to cancellation; a step of 2**-12 was off by 3e-7 for one least force.
STEP = 2.0**-16
#: What a derivative that vanishes may be off, its terms being of the size of the inputs over the one that is moved.
ROUNDINGS = 2.0**-46


def held_slopes(
    entry: Entry,
    designs: dict[str, np.ndarray],
    quantities: Sequence[str],
    inputs: Sequence[str],
    *,
    places: bool,
) -> int:
    """Hold derivatives of greatest and least values or places without a tie to differences; return how many."""
    catalogue, variants = entry.catalogue, entry.catalogue.variants_selected_by(designs)
    at = catalogue.position.name if places else ""
    cases = [(name, how, by) for name in quantities for how in SIGNS for by in inputs]
    wanted = {case: str(Derivative(Reduced(Quantity(case[0]), case[1], at), case[2])) for case in cases}
    extremes = {case: Reduced(Quantity(case[0]), case[1]) for case in cases}
    names = {*wanted.values(), *map(str, extremes.values())}
    names |= {str(GradientStatus(extreme)) for extreme in extremes.values()}
    found = sweep_both(entry.mechanism, fl.table(designs), sorted(names), input=entry.input, **QUIET)
    held = 0
    for (quantity, how, by), name in wanted.items():
        extreme = extremes[quantity, how, by]
        status = found[str(GradientStatus(extreme))].values
        for k, b in np.argwhere((status == SMOOTH) | (status == AT_LIMIT)):
            one = {key: float(column[k]) for key, column in designs.items()}
            moved = {key: np.full(4, value) for key, value in one.items()}
            moved[by] = one[by] * (1.0 + STEP * np.array([1.0, -1.0, 2.0, -2.0]))
            branch = np.full(4, found["branch"].values[b])
            exact = Stationary(catalogue, quantity, moved, branch, variants)
            computed = float(found[str(extreme)].values[k, b])
            slope = _difference(exact, moved[by], SIGNS[how], places, computed)
            if slope is not None:
                rounding = ROUNDINGS * (1 + max(map(abs, one.values())) / abs(one[by]))
                assert abs(float(found[name].values[k, b]) - slope[0]) <= slope[1] + rounding, (name, one)
                held += 1
    return held


def _difference(
    stationary: Stationary, at: np.ndarray, sign: int, places: bool, computed: float
) -> tuple[float, float] | None:
    """Return the derivative by central differences, and how far it may be off; None where they do not settle."""
    extremes = [outermost(stationary, k, sign, of_all=True) for k in range(4)]
    values = [extreme.position if places else extreme.value for extreme in extremes]
    if not all(MP.isfinite(value) for value in values):
        return None
    exact = float(extremes[0].value)
    if abs(abs(exact) - math.pi) < 1e-15 and abs(computed - exact) > 1e-6:
        return (
            None  # an angle that reaches pi at a limit of motion alone is pi there for one, -pi for the other
        )
    fine, coarse = ((values[k] - values[k + 1]) / (MP.mpf(at[k]) - MP.mpf(at[k + 1])) for k in (0, 2))
    slope, off = (4 * fine - coarse) / 3, abs(fine - coarse)
    size = abs(slope) + abs(values[0] / at[0])
    if off > 1e-4 * size:  # an extreme that another one overtakes, or a change point nearby
        return None
    # what is left of the differences is a power of the step more; what is computed has a millionth of its digits left
    return float(slope), float(1e-2 * off + 1e-10 * size)

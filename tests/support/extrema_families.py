"""The families of linkages on which the extrema are counted, and the engine's answer there."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import fastlink as fl
from tests.support.configurations import LENGTHS

Rng = np.random.Generator


def uniform(rng: Rng, n: int) -> np.ndarray:
    return rng.uniform(0.05, 1.0, (4, n))


def grashof(lengths: np.ndarray) -> np.ndarray:
    return 2 * (lengths.min(axis=0) + lengths.max(axis=0)) < lengths.sum(axis=0)


def shortest(lengths: np.ndarray, links: tuple[int, ...]) -> np.ndarray:
    return np.isin(lengths.argmin(axis=0), [link - 1 for link in links])


def assembles(lengths: np.ndarray) -> np.ndarray:
    return 2 * lengths.max(axis=0) < lengths.sum(axis=0)


def kept(draw: Callable[[Rng, int], np.ndarray], keep: Callable[[np.ndarray], np.ndarray]) -> Callable:
    """Return a family: what is drawn and can move, and is of the kind wanted."""

    def family(rng: Rng, n: int) -> np.ndarray:
        found = np.empty((4, 0))
        while found.shape[1] < n:
            lengths = draw(rng, 2 * n + 100)
            found = np.hstack([found, lengths[:, assembles(lengths) & keep(lengths)]])
        return found[:, :n]

    return family


def log_uniform(rng: Rng, n: int) -> np.ndarray:
    return 10.0 ** rng.uniform(-3, 3, (4, n))


def small(rng: Rng, n: int, least: float) -> np.ndarray:
    """Return numbers of either sign and every size from `least` to 0.01."""
    return rng.choice([-1.0, 1.0], n) * 10.0 ** rng.uniform(np.log10(least), -2, n)


def change_point_gap(rng: Rng, n: int) -> np.ndarray:
    """Return a crank such that a gap of 1e-2 ... 1e-12, of either sign, is left to a change point of each type."""
    b, c, d = rng.uniform(0.3, 1.0, (3, n))
    partner = rng.integers(3, size=n)
    others = np.choose(partner, [b + d - c, c + d - b, b + c - d])
    return np.array([np.maximum(others + small(rng, n, 1e-12), 0.0), b, c, d])


def near_kite(rng: Rng, n: int) -> np.ndarray:
    """Two pairs of neighbours are nearly alike."""
    one, two = rng.uniform(0.3, 1.0, (2, n))
    near_one, near_two = one * (1 + small(rng, n, 1e-8)), two * (1 + small(rng, n, 1e-8))
    turned = rng.random(n) < 0.5
    return np.where(turned, [one, near_one, two, near_two], [one, two, near_two, near_one])


def near_parallelogram(rng: Rng, n: int) -> np.ndarray:
    """Opposite links are nearly alike."""
    one, two = rng.uniform(0.3, 1.0, (2, n))
    return np.array([one, two, one * (1 + small(rng, n, 1e-8)), two * (1 + small(rng, n, 1e-8))])


def everything(lengths: np.ndarray) -> np.ndarray:
    return lengths.min(axis=0) > 0


FAMILIES: dict[str, Callable[[Rng, int], np.ndarray]] = {
    "crank": kept(uniform, lambda x: grashof(x) & shortest(x, (1,))),
    "drag-link": kept(uniform, lambda x: grashof(x) & shortest(x, (4,))),
    "rocker input": kept(uniform, lambda x: grashof(x) & shortest(x, (2, 3))),
    "non-Grashof": kept(uniform, lambda x: ~grashof(x)),
    "log-uniform": kept(log_uniform, everything),
    "change-point gap": kept(change_point_gap, everything),
    "near kite": kept(near_kite, everything),
    "near parallelogram": kept(near_parallelogram, everything),
}


def space(lengths: np.ndarray, omega1: float = 1.0) -> fl.DesignSpace:
    return fl.table(dict(zip(LENGTHS, lengths, strict=True)) | {"omega1": omega1})


def names_of(quantity: str) -> list[str]:
    return [
        f"{quantity}_extrema",
        f"theta1_at_{quantity}_extrema",
        f"{quantity}_extrema_count",
        f"{quantity}_extrema_kind",
    ]


def found(
    lengths: np.ndarray, quantities: Sequence[str], omega1: float = 1.0, **options: Any
) -> dict[str, list[np.ndarray]]:
    """Return value, theta1, count and kind of the engine, by quantity."""
    asked = [f"{quantity}_extrema" for quantity in quantities]
    result = fl.sweep("planar_4r", space(lengths, omega1), asked, **options)
    return {quantity: [result[name].values for name in names_of(quantity)] for quantity in quantities}

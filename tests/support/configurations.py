"""Random configurations of the planar 4R, easy and hard, and their reference with 50 digits."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from benchmarks.cases import near_change_point as near_change_point
from benchmarks.cases import near_toggle as near_toggle

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Input
from fastlink.mechanisms import catalogue
from fastlink.precision.reference import DIGITS as DIGITS
from fastlink.precision.reference import HighPrecision

PLANAR: Catalogue = catalogue("planar_4r")
LENGTHS = ("a1", "a2", "a3", "a4")
#: The sets of facts that giving one of their inputs chooses.
LOADS = tuple(
    name
    for name, inputs in PLANAR.variant_inputs.items()
    if any(declared.default is not None for declared in inputs.values())
)


def draw(declared: Mapping[str, Input], rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Values for inputs, of either sign where they may."""
    inputs = {}
    for name, one in declared.items():
        size = rng.uniform(0.2, 2.0, n)
        inputs[name] = size if one.rule != "any" else size * rng.choice([-1.0, 1.0], n)
    return inputs


def masses_and_points(rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Every input but the lengths: mass centres anywhere, coupler point anywhere."""
    return draw({name: one for name, one in PLANAR.inputs.items() if name not in LENGTHS}, rng, n)


def all_loads(rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Every input of every load."""
    return {name: v for load in LOADS for name, v in draw(PLANAR.variant_inputs[load], rng, n).items()}


def random_lengths(rng: np.random.Generator, n: int) -> np.ndarray:
    """Lengths (4, n) of all classes."""
    return rng.uniform(0.3, 2.0, (4, n))


#: Families: anywhere, near the folded position of a change point, inside a toggle, as near as the number says.
FAMILIES = ("random", "gap 1e-4", "gap 1e-8", "gap 1e-13", "toggle 1e-3", "toggle 1e-6", "toggle 1e-9")


def lengths_and_angles(kind: str, rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return lengths (4, n) and input angles of a family."""
    if kind == "random":
        return random_lengths(rng, n), rng.uniform(-np.pi, np.pi, n)
    name, _, size = kind.partition(" ")
    return {"gap": near_change_point, "toggle": near_toggle}[name](rng, n, float(size))


def family(kind: str, rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Return configurations driven at O, without loads."""
    lengths, theta = lengths_and_angles(kind, rng, n)
    return dict(zip(LENGTHS, lengths, strict=True)) | masses_and_points(rng, n) | {"theta1": theta}


def loaded(kind: str, rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Return configurations driven at O, under all loads at once."""
    return family(kind, rng, n) | all_loads(rng, n)


def driven(joint: int, kind: str, rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Return configurations of a family turned so that its first joint is the driven one."""
    lengths, theta = lengths_and_angles(kind, rng, n)
    turned = {f"a{(i + joint - 1) % 4 + 1}": values for i, values in enumerate(lengths)}
    return turned | {
        f"joint_angle_{joint}": theta - np.pi,
        f"joint_omega_{joint}": rng.uniform(-2.0, 2.0, n),
        "P_u": rng.uniform(-1.0, 2.0, n),
        "P_v": rng.uniform(-1.0, 1.0, n),
    }


def designs(kind: str, rng: np.random.Generator, n: int) -> np.ndarray:
    """Return lengths (4, n) of all classes: plain, of ratios up to 1e3, and near change points of every type."""
    if kind == "random":
        return random_lengths(rng, n)
    if kind == "wide":
        return np.exp(rng.uniform(-3.5, 3.5, (4, n)))
    lengths = random_lengths(rng, n)
    # One of A1, B1, C1 is a gap of 1e-2 to 1e-13, of either sign.
    gap = np.exp(rng.uniform(np.log(1e-13), np.log(1e-2), n)) * rng.choice([-1.0, 1.0], n)
    signs = np.array([(1, -1, 1), (1, 1, -1), (-1, 1, 1)]).T[:, rng.integers(0, 3, n)]
    # Ordered so that the last link is positive: a4 = the sum of two minus the third, plus the gap.
    last = np.sum(signs * lengths[:3], axis=0) + gap
    lengths[3] = np.where(last > 0.1, last, lengths[3])
    return lengths


def reference(
    names: list[str],
    inputs: dict[str, Any],
    variants: tuple[str, ...] = (),
    catalogue: Catalogue = PLANAR,
) -> dict[str, Any]:
    """Return the facts of one configuration with 50 digits."""
    found = HighPrecision(catalogue, names, inputs, variants).at(inputs)
    return {name: found[name] for name in names}


def condition_sums(
    names: list[str],
    inputs: dict[str, Any],
    variants: tuple[str, ...] = (),
    catalogue: Catalogue = PLANAR,
) -> dict[str, Any]:
    """Return sum over the inputs of |x df/dx|: what one rounding of each input does to each quantity."""
    facts = HighPrecision(catalogue, names, inputs, variants)
    return facts.condition(facts.at(inputs), [name for name in inputs if name != "branch"])


# -- Families of linkages whose extremes are counted

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


LINKAGES: dict[str, Callable[[Rng, int], np.ndarray]] = {
    "crank": kept(uniform, lambda x: grashof(x) & shortest(x, (1,))),
    "drag-link": kept(uniform, lambda x: grashof(x) & shortest(x, (4,))),
    "rocker input": kept(uniform, lambda x: grashof(x) & shortest(x, (2, 3))),
    "non-Grashof": kept(uniform, lambda x: ~grashof(x)),
    "log-uniform": kept(log_uniform, everything),
    "change-point gap": kept(change_point_gap, everything),
    "near kite": kept(near_kite, everything),
    "near parallelogram": kept(near_parallelogram, everything),
}

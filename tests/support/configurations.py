"""Random configurations and coupler curves of the planar 4R, and their reference with 50 digits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from benchmarks.cases import near_change_point as near_change_point
from benchmarks.cases import near_toggle as near_toggle

import fastlink as fl
from fastlink.facts.arc import ARC
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
    if name != ARC and any(declared.default is not None for declared in inputs.values())
)


def numbers(text: str) -> dict[str, float]:
    """Return a design that is written as on the command line: NAME=VALUE, one after the other."""
    words = (word.partition("=") for word in text.split())
    return {name: float(value) for name, _, value in words}


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


def reference(names: list[str], inputs: dict[str, Any], variants: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return the facts of one configuration with 50 digits."""
    found = HighPrecision(PLANAR, names, inputs, variants).at(inputs)
    return {name: found[name] for name in names}


def under_loads(seed: int, loads: Sequence[str]) -> dict[str, float]:
    """Return one random design with these loads, at an angle where it assembles, as numbers."""
    rng = np.random.default_rng(seed)
    while True:
        inputs = dict(zip(LENGTHS, random_lengths(rng, 1), strict=True)) | masses_and_points(rng, 1)
        for load in loads:
            inputs |= draw(PLANAR.variant_inputs[load], rng, 1)
        one = {name: float(value[0]) for name, value in inputs.items()}
        one |= {"theta1": rng.uniform(-np.pi, np.pi), "branch": int(rng.integers(1, 3))}
        if fl.evaluate("planar_4r", ["transmission_angle"], **one)["transmission_angle"] > 0.2:
            return one


CURVE = (*LENGTHS, "P_u", "P_v")


def design_of(*numbers: Any) -> dict[str, Any]:
    """Return lengths, and a coupler point if it is given, by their names."""
    return dict(zip(CURVE, numbers, strict=False))


def random_designs(seed: int, n: int) -> tuple[dict[str, Any], Any]:
    """Lengths of all classes and coupler points anywhere, and input angles."""
    rng = np.random.default_rng(seed)
    inputs = dict(zip(LENGTHS, random_lengths(rng, n), strict=True))
    inputs |= {name: rng.uniform(-2.0, 2.0, n) for name in ("P_u", "P_v")}
    return inputs, rng.uniform(-np.pi, np.pi, n)


def evaluate(names: list[str], inputs: dict[str, Any], theta: Any, branch: Any) -> dict[str, Any]:
    return fl.evaluate("planar_4r", names, branch=branch, theta1=theta, allow_invalid=True, **inputs)


def traced(one: dict[str, Any], branch: int, theta: Any) -> Any:
    """Coupler points as complex numbers by the law of cosines; on AD where the linkage does not assemble."""
    a, b, c, d, u, v = (one[name] for name in CURVE)
    A = a * np.exp(1j * theta)
    AD = d - A
    square = np.abs(AD) ** 2
    along = (b * b - c * c + square) / (2 * square)
    across = (2 * branch - 3) * np.sqrt(np.maximum(b * b / square - along**2, 0.0))
    return A + (u + 1j * v) / b * AD * (along + 1j * across)


def apart_from_change_points(lengths: Any, gap: float = 0.1) -> Any:
    """Which of the lengths (4, n) are farther than `gap` from a change point and from a single configuration."""
    a, b, c, d = lengths
    gaps = [a - b + c - d, a + b - c - d, a - b - c + d, a + b + c - d, a + b - c + d, a - b + c + d]
    return np.min(np.abs([*gaps, -a + b + c + d]), axis=0) > gap

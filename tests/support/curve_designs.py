"""Random designs of the planar 4R with coupler points."""

from __future__ import annotations

from typing import Any

import numpy as np

import fastlink as fl
from tests.support.configurations import LENGTHS, random_lengths

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

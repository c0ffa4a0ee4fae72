"""Random designs with coupler points, and their motions followed along the configuration curve."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

import fastlink as fl
from tests.support.configurations import LENGTHS, random_lengths

CURVE = (*LENGTHS, "P_u", "P_v")

#: Step on the torus of theta1 and theta2 [rad], and steps that go around every curve (two turns of both: 18 rad).
STEP, STEPS = 0.02, 1000
#: Input angles from which motions start.
ANGLES = np.linspace(-np.pi, np.pi, 37)[:-1] + 0.03


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


def onto_curve(lengths: Any, e: Any) -> tuple[Any, Any]:
    """Move angles theta1, theta2 (2, n) across the curve |OA + AB - OD| = a3 onto it; with the unit tangent."""
    a, b, c, d = lengths
    for _ in range(5):
        A, AB = a * np.exp(1j * e[0]), b * np.exp(1j * e[1])
        DB = A + AB - d
        slope = np.array([np.real(1j * A * DB.conj()), np.real(1j * AB * DB.conj())])
        # Newton's step: the first one lands from the tangent, the others polish.
        e = e - slope * (0.5 * (np.abs(DB) ** 2 - c * c) / np.sum(slope * slope, axis=0))
    assert np.all(np.abs(np.abs(DB) - c) < 1e-9 * (a + b + c + d))
    return e, np.array([-slope[1], slope[0]]) / np.hypot(*slope)


def moved(lengths: Any, e: Any) -> Any:
    """Follow the curve from one configuration (2, n) of each design, and around: (2, steps, n)."""
    path = np.empty((2, STEPS, e.shape[1]))
    direction = np.zeros_like(e)
    for k in range(STEPS):
        path[:, k], tangent = onto_curve(lengths, e)
        # Onwards, never back.
        direction = tangent * np.where(np.sum(tangent * direction, axis=0) < 0.0, -1.0, 1.0)
        e = path[:, k] + STEP * direction
    return path


def on_path(path: Any, theta1: Any, theta2: Any) -> Any:
    """Whether configurations lie on a path (2, steps): a sample within a step, turns apart."""
    offsets = [
        np.abs(np.exp(1j * along) - np.exp(1j * angle)[:, None])
        for along, angle in zip(path, (theta1, theta2), strict=True)
    ]
    return np.min(np.hypot(*offsets), axis=1) <= STEP


def motions(lengths: Any) -> Iterator[tuple[int, Any, Any]]:
    """Yield every motion of every design: its number, a path (2, steps), what it reached (branch, angle)."""
    given = dict(zip(LENGTHS, lengths[:, :, None, None], strict=True))
    theta2 = evaluate(["theta2"], given, ANGLES, np.array([[1], [2]]))["theta2"]
    left = np.isfinite(theta2)
    while left.any():
        # Start each design from a configuration that no motion has reached yet.
        todo = np.flatnonzero(left.any(axis=(1, 2)))
        start = np.array([np.argwhere(left[i])[0] for i in todo]).T
        paths = moved(lengths[:, todo], np.array([ANGLES[start[1]], theta2[todo, *start]]))
        for k, i in enumerate(todo):
            there = np.isfinite(theta2[i])
            reached = np.zeros_like(there)
            reached[there] = on_path(
                paths[:, :, k], np.broadcast_to(ANGLES, there.shape)[there], theta2[i][there]
            )
            assert reached[*start[:, k]]
            left[i] &= ~reached
            yield int(i), paths[:, :, k], reached

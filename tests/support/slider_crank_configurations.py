"""Random configurations of the slider-crank, easy and hard."""

from __future__ import annotations

import numpy as np

from fastlink.mechanisms import catalogue

SLIDER_CRANK = catalogue("slider_crank")
LENGTHS = ("r", "l", "e")
#: A pump of a crank of 50 mm.
PUMP = {"r": 0.05, "l": 0.17, "e": 0.02, "omega": 100.0}
#: Masses of links that are not bars, centres anywhere.
MASSES = {
    "m1": 0.4,
    "I1": 3e-4,
    "G1_u": 0.012,
    "G1_v": -0.004,
    "m2": 0.3,
    "I2": 9e-4,
    "G2_u": 0.06,
    "G2_v": 0.003,
    "m3": 0.8,
}
FAMILIES = (
    *("random", "inline", "gap 1e-4", "gap 1e-8", "gap 1e-13", "toggle 1e-3", "toggle 1e-6", "toggle 1e-9"),
    *("normal 1e-3", "normal 1e-9", "aligned 1e-3", "aligned 1e-9", "isosceles 1e-3", "isosceles 1e-9"),
    *(
        "reach 1e-3",
        "reach 1e-9",
        "stiff 1e3",
        "stiff 1e9",
        "short 1e-1",
        "short 1e-8",
        "scale 1e-20",
        "scale 1e20",
    ),
)


def lengths(kind: str, rng: np.random.Generator, n: int) -> np.ndarray:
    """Lengths r, l, e: of a kind that a size tells how hard it is."""
    name, _, text = kind.partition(" ")
    size = float(text or 1.0)
    r, l, e = rng.uniform(0.3, 2.0, n), rng.uniform(0.3, 2.0, n), rng.uniform(-1.5, 1.5, n)
    near = size * rng.choice([-1.0, 1.0], n) * rng.uniform(0.5, 2.0, n)
    if name == "inline":
        e = np.zeros(n)
    elif name == "gap":  # a change point: l = r + |e| or r = l + |e|
        e = np.where(rng.random(n) < 0.5, (l - r) + near, (r - l) + near)
    elif name == "isosceles":  # both change points at once
        l, e = r * (1.0 + near), near * rng.uniform(-1.0, 1.0, n)
    elif name == "reach":  # the line is just within reach
        e = (r + l) * (1.0 - abs(near)) * rng.choice([-1.0, 1.0], n)
    elif name == "stiff":
        l, e = l * size, e * rng.choice([0.2 * size, 1.0], n)
    elif name == "short":
        l, e = l * size, r * rng.uniform(-0.99, 0.99, n)
    elif name == "aligned":
        l, e = r * rng.uniform(1.2, 5.0, n), size * rng.choice([0.0, 0.1, 1.0], n)
    scale = size if name == "scale" else 1.0
    return np.array([r, l, e]) * scale


def positions(kind: str, rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Lengths of a kind and a crank angle at which most of them assemble."""
    name, _, text = kind.partition(" ")
    r, l, e = lengths(kind, rng, n)
    low, high = np.clip((e - l) / r, -1.0, 1.0), np.clip((e + l) / r, -1.0, 1.0)
    share = rng.uniform(0.0, 1.0, n)
    if name == "toggle":
        share = rng.choice([0.0, 1.0], n)
    sine = low + (high - low) * share
    theta = np.arcsin(sine)
    if name == "toggle":
        theta = theta + float(text) * np.where(share == 0.0, 1.0, -1.0) * rng.uniform(0.5, 2.0, n)
    elif name == "normal":  # the crank square to the line
        theta = 0.5 * np.pi * rng.choice([-1.0, 1.0], n) + float(text) * rng.uniform(-1.0, 1.0, n)
    elif name == "aligned":  # without offset, or a little: crank and rod in line with the slider
        theta = float(text) * rng.uniform(-1.0, 1.0, n)
    theta = np.where(rng.random(n) < 0.5, theta, np.pi - theta)
    return {"r": r, "l": l, "e": e, "theta": theta}


def family(kind: str, rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Configurations of a kind with all inputs: mass centres anywhere, sizes in proportion to the link."""
    inputs = positions(kind, rng, n)
    for name, declared in SLIDER_CRANK.inputs.items():
        if name not in LENGTHS:
            value = rng.uniform(0.2, 2.0, n)
            value = value if declared.rule != "any" else value * rng.choice([-1.0, 1.0], n)
            power = {"m": 1, "kg m2": 2}.get(declared.units, 0)
            inputs[name] = value * inputs["l" if "2" in name else "r"] ** power
    return inputs

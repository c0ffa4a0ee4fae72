"""Random configurations of the slider-crank, easy and hard."""

from __future__ import annotations

import numpy as np

from fastlink.mechanisms import catalogue

SLIDER_CRANK = catalogue("slider_crank")
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
#: The others are among the `neighbourhoods`.
FAMILIES = ("random",)


def family(kind: str, rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Configurations that assemble, most of them: mass centres anywhere, sizes in proportion to the link."""
    r, l, e = rng.uniform(0.3, 2.0, n), rng.uniform(0.3, 2.0, n), rng.uniform(-1.5, 1.5, n)
    low, high = np.clip((e - l) / r, -1.0, 1.0), np.clip((e + l) / r, -1.0, 1.0)
    theta = np.arcsin(low + (high - low) * rng.uniform(0.0, 1.0, n))
    inputs = {"r": r, "l": l, "e": e, "theta": np.where(rng.random(n) < 0.5, theta, np.pi - theta)}
    for name, declared in SLIDER_CRANK.inputs.items():
        if name not in inputs:
            value = rng.uniform(0.2, 2.0, n)
            value = value if declared.rule != "any" else value * rng.choice([-1.0, 1.0], n)
            power = {"m": 1, "kg m2": 2}.get(declared.units, 0)
            inputs[name] = value * inputs["l" if "2" in name else "r"] ** power
    return inputs

"""Random configurations of Hart's linkage, easy and hard."""

from __future__ import annotations

import numpy as np

import fastlink as fl
from fastlink.mechanisms import catalogue

HART = catalogue("hart")
#: The linkage of Figures 6 and 7.
WUNDERLICH = {"m": 4.0, "n": 8.0, "d": 6.0, "kappa": 0.5}
MEASURES = ("F_deviation", "closure_residual")
QUANTITIES = [name for name, fact in HART.public.items() if not fact.flags and name not in MEASURES]
# There though the loop does not close.
OF_THE_CRANK = {"A_x", "A_y", "P_x", "P_y"}
#: The others are among the `neighbourhoods`.
FAMILIES = ("random", "near 1 1e-9", "gap 1e-4", "toggle 1e-3")


def family(kind: str, rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Return configurations that assemble at phi in one branch or the other, most of them."""
    name, *_, size = kind.split(" ") if " " in kind else (kind, "1")
    m, n_, below = rng.uniform(0.3, 2.0, n), rng.uniform(0.3, 2.0, n), rng.uniform(0.1, 0.9, n)
    kappa = np.where(rng.random(n) < 0.6, below, 1.0 / below) * rng.choice([-1.0, 1.0], n)
    sign = rng.choice([-1.0, 1.0], n)
    if name == "near":
        kappa = sign * (1.0 + float(size) * rng.choice([-1.0, 1.0], n))
    K = abs(kappa)
    low, high = abs(1.0 - K) * abs(m - n_), (1.0 + K) * (m + n_)
    d = low + (high - low) * rng.uniform(0.02, 0.98, n)
    if name == "gap":
        reach = np.where(rng.random(n) < 0.5, abs(1.0 - K) * (m + n_), (1.0 + K) * abs(m - n_))
        d = reach + float(size) * rng.uniform(-1.0, 1.0, n)
    e = np.where(K < 1.0, d, -d)
    Z0 = -((1.0 - K) * (m + n_) - e) * ((1.0 + K) * (m - n_) - e) / (4.0 * m * e)
    C0 = ((1.0 - K) * (m + n_) + e) * ((1.0 + K) * (m - n_) + e) / (4.0 * m * e)
    first, last = np.clip(Z0, 0.0, 1.0), np.clip(1.0 - C0, 0.0, 1.0)
    share = rng.uniform(0.01, 0.99, n)
    if name == "toggle":
        share = np.where(rng.random(n) < 0.5, float(size), 1.0 - float(size))
    phi = 2.0 * np.arcsin(np.sqrt(np.clip(first + (last - first) * share, 0.0, 1.0)))
    return {"m": m, "n": n_, "d": d, "kappa": kappa, "phi": phi * sign}


def along_line(rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Return configurations as driven by F, most of them on its stroke."""
    inputs = family("random", rng, n)
    phi = inputs.pop("phi")
    return inputs | {
        "F_y": fl.evaluate("hart", ["F_y_outer"], phi=phi, **inputs)["F_y_outer"] * np.sin(1.7 * phi)
    }


def at(names, **given):
    """Evaluate at one input position unless it is given; what cannot be is NaN."""
    with np.errstate(all="ignore"):
        return fl.evaluate("hart", names, allow_invalid=True, **({"phi": 1.0} | given))

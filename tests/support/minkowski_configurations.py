"""Random configurations of the Minkowskian 4R, easy and hard."""

from __future__ import annotations

import numpy as np

#: The others are among the `neighbourhoods`.
FAMILIES = ("random", "great theta")


def family(kind: str, rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Return configurations anywhere, of ordinary rapidities or of such whose functions are nearly too great."""
    theta = rng.uniform(-4.0, 4.0, n)
    if kind == "great theta":
        theta = rng.choice([-1.0, 1.0], n) * np.exp(rng.uniform(np.log(4.0), np.log(700.0), n))
    inputs = dict(zip("abgh", rng.uniform(0.3, 2.0, (4, n)), strict=True))
    return inputs | {name: rng.uniform(-2.0, 2.0, n) for name in "xy"} | {"theta": theta}


def adversarial(rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Return inputs by name: whole and other lengths, alike and unlike, of every size, at every special rapidity."""
    lengths = np.where(rng.random(n) < 0.5, rng.integers(1, 4, (4, n)), rng.uniform(0.3, 2.0, (4, n)))
    unlike = 10.0 ** (rng.uniform(-1.0, 1.0, (4, n)) * rng.choice([0.3, 3.0, 10.0], n))
    lengths = lengths * np.where(rng.random(n) < 0.4, 1.0, unlike)
    lengths *= np.where(rng.random(n) < 0.5, 1.0, 10.0 ** rng.uniform(-3.0, 20.0, n)) / lengths.max(axis=0)
    a, b, g, h = lengths
    with np.errstate(all="ignore"):
        limits = [np.arccosh((a / g + g / a - reach / a * (reach / g)) / 2.0) for reach in (b + h, b - h)]
        places = [
            np.zeros(n),
            np.abs(np.log(g / a)),
            *limits,
            rng.uniform(-4.0, 4.0, n),
            rng.uniform(-60.0, 60.0, n),
        ]
    places += [
        rng.uniform(300.0, 800.0, n),
        rng.uniform(700.0, 712.0, n),
        10.0 ** rng.uniform(-300.0, 12.0, n),
    ]
    theta = np.choose(rng.integers(0, len(places), n), places)
    theta = np.where(np.isfinite(theta), theta, 0.3) * rng.choice([-1.0, 1.0], n)
    theta = theta * np.where(rng.random(n) < 0.5, 1.0, 1.0 + rng.choice([1e-15, -1e-15, 1e-9, -1e-9], n))
    x, y = (
        rng.choice([-1.0, 0.0, 1.0], n, p=[0.4, 0.2, 0.4])
        * lengths[rng.integers(0, 4, n), np.arange(n)]
        * 10.0 ** (rng.uniform(-1.0, 1.0, n) * rng.choice([0.0, 3.0], n))
        for _ in "xy"
    )
    return dict(zip("abgh", lengths, strict=True)) | {"x": x, "y": y, "theta": theta}

"""Random configurations of the Minkowskian 4R, easy and hard."""

from __future__ import annotations

import mpmath as mp
import numpy as np

from tests.support.configurations import DIGITS

FAMILIES = [
    *(
        "random",
        "great theta",
        "small theta",
        "unequal",
        "limit 1e-3",
        "limit 1e-9",
        "escape 1e-3",
        "escape 1e-9",
    ),
    *("gap 1e-4", "gap 1e-9", "gap 0", "light 1e-3", "rigid 1e-4", "rigid 1e-9"),
]


def family(kind: str, rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Return configurations: anywhere, or as near as the number says to where digits may get lost."""
    name, _, size = kind.partition(" ")
    lengths, theta = rng.uniform(0.3, 2.0, (4, n)), rng.uniform(-4.0, 4.0, n)
    sides = rng.choice([-1.0, 1.0], n)
    if name == "great":
        theta = sides * np.exp(rng.uniform(np.log(4.0), np.log(700.0), n))
    elif name == "small":
        theta *= 1e-8
    elif name == "unequal":
        lengths = np.exp(rng.uniform(-20.0, 20.0, (4, n)))
    elif name == "light":  # a short coupler: AB, between the far pins, is nearly lightlike
        lengths[3] *= float(size)
    elif name == "escape":  # A and C nearly lightlike separated
        theta = np.log(lengths[2] / lengths[0]) * sides * (1.0 + float(size) * rng.choice([-1.0, 1.0], n))
    elif name == "gap":  # T1 or T2 nearly 0, near the folded position
        a, b, g, _h = lengths
        lengths[3] = abs(np.where(rng.random(n) < 0.5, g + b - a, a - g + b) - float(size))
        theta = sides * np.exp(rng.uniform(np.log(1e-6), 0.0, n))
    elif (
        name == "rigid"
    ):  # T3 or T4 nearly 0: a link nearly as long as the others together, near the folded position
        a, b, g, h = lengths
        lengths[[0, 2]] = np.where(rng.random(n) < 0.5, (a, a + b + h), (g + b + h, g))
        lengths[3] -= float(size)
        limit = np.sqrt(2.0 * float(size) * (b + h) / (lengths[0] * lengths[2]))
        theta = sides * limit * rng.uniform(0.0, 1.1, n)
    elif name == "limit":
        for i in range(n):
            lengths[:, i], theta[i] = near_limit(rng, float(size))
    inputs = dict(zip("abgh", lengths, strict=True))
    return inputs | {name: rng.uniform(-2.0, 2.0, n) for name in "xy"} | {"theta": theta}


def near_limit(rng: np.random.Generator, offset: float) -> tuple[np.ndarray, float]:
    """Return lengths, and a rapidity by a fraction `offset` inside a limit of the input."""
    while True:
        lengths, inner = rng.uniform(0.3, 2.0, 4), rng.random() < 0.5
        with mp.workdps(DIGITS):
            a, b, g, h = (mp.mpf(float(v)) for v in lengths)
            cosh = (a * a + g * g - (b + h if inner else b - h) ** 2) / (2 * a * g)
            if cosh > 1.01:
                theta = mp.acosh(cosh) * (1 - offset if inner else 1 + offset)
                return lengths, float(theta) * rng.choice([-1.0, 1.0])


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

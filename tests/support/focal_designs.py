"""Designs of the focal mechanism, easy and hard, and their facts."""

from __future__ import annotations

import numpy as np

from fastlink.facts.evaluate import read_facts
from fastlink.mechanisms import catalogue
from fastlink.precision.reference import HighPrecision

FOCAL = catalogue("focal")
LENGTHS = ("a", "b", "c", "d")
#: What a design is given by, and the set of facts that this chooses.
GIVEN = {
    "rho": ((*LENGTHS, "rho"), ()),
    "s": ((*LENGTHS, "s"), ("s",)),
    "lambda_": ((*LENGTHS, "lambda_"), ("lambda_",)),
}
#: What belongs to a design alone.
FACTS = [name for name in FOCAL.public if not FOCAL.varies(name)]
CODES = [name for name in FACTS if FOCAL.facts[name].flags]
NUMBERS = [name for name in FACTS if name not in CODES]


def random_designs(rng, n):
    """Designs of all classes, with rho of either sign."""
    lengths = dict(zip(LENGTHS, rng.uniform(0.2, 2.0, (4, n)), strict=True))
    return lengths | {"rho": 2.0 * rng.normal(size=n)}


def small(rng, n, greatest=-3):
    """Numbers of either sign from 1e-15 on."""
    return 10.0 ** rng.uniform(-15, greatest, n) * rng.choice([-1.0, 1.0], n)


def meeting(rng, designs, n):
    """Return designs with rho next to where both completions are one."""
    a, b, c, d = (designs[name] for name in LENGTHS)
    sign = rng.choice([-1.0, 1.0], n)
    free = np.where(sign > 0.0, (a + b) ** 2 - (c + d) ** 2, (c - d) ** 2 - (a - b) ** 2)
    # b^2 k^2 + (free - 2 a b) k + a^2 = 0 for k = |rho|
    half = (2 * a * b - free) / (2 * b * b)
    with np.errstate(invalid="ignore"):
        size = half + rng.choice([-1.0, 1.0], n) * np.sqrt(half * half - (a / b) ** 2)
    kept = size > 0.0
    return {
        name: values[kept] for name, values in (designs | {"rho": sign * size * (1 + small(rng, n))}).items()
    }


def family(kind, rng, n):
    """Return designs of one kind, n of them or fewer."""
    designs = random_designs(rng, n)
    a, b, c, d = (designs[name] for name in LENGTHS)
    near = 1.0 + small(rng, n)
    short = 10.0 ** rng.uniform(-15, -3, n)
    match kind:
        case "rho near -1":
            return designs | {"rho": -1.0 + small(rng, n), "b": np.where(rng.random(n) < 0.3, a, b)}
        case "rho next to -1":
            rho = -1.0 + rng.choice([2.0**-53, 2.0**-52, -(2.0**-52)], n)
            return designs | {"rho": rho, "c": np.where(rng.random(n) < 0.3, d, c)}
        case "rho from 1e-3 to 1e3":
            return designs | {"rho": 10.0 ** rng.uniform(-3, 3, n)}
        case "lambda near 1":
            return designs | {"c": short, "a": b + d - short * rng.uniform(-1.0, 1.0, n)}
        case "lambda near 0":
            return designs | {"rho": -((a / b) ** 2) * near}
        case "a = b, c = d":
            return designs | {"b": a, "d": c, "rho": np.where(rng.random(n) < 0.2, 1.0, designs["rho"])}
        case "near a = b, c = d":
            return designs | {"b": a * near, "d": c * (1.0 + small(rng, n))}
        case "a = c, b = d":
            return designs | {"c": a, "d": b}
        case "a = d, b = c":
            return designs | {"d": a, "c": b}
        case "near a = d, b = c":
            return designs | {"d": a * near, "c": b * (1.0 + small(rng, n))}
        case "symmetric":
            return designs | {"b": a, "rho": np.ones(n)}
        case "completions meet":
            return meeting(rng, designs, n)
        case "1e-20" | "1e20":
            return {name: v * (float(kind) if name in LENGTHS else 1.0) for name, v in designs.items()}
    assert kind == "random"
    return designs


FAMILIES = (
    *("random", "rho from 1e-3 to 1e3", "rho near -1", "rho next to -1", "lambda near 1", "lambda near 0"),
    *("a = b, c = d", "near a = b, c = d", "a = c, b = d", "a = d, b = c", "near a = d, b = c"),
    *("symmetric", "completions meet", "1e-20", "1e20"),
)


def given_by(name, designs):
    """Return designs given by s or lambda_ instead of rho; those that have none are left out."""
    if name == "rho":
        return designs
    if name == "s":
        return designs | {"s": designs["d"] * designs["rho"] / (1.0 + designs["rho"])}
    found = facts(designs, 1.0, ["lambda_"])["lambda_"]
    kept = np.isfinite(found)
    return {key: values[kept] for key, values in (designs | {"lambda_": found}).items()}


def drawn(given, kind, rng, n):
    """Return designs of one kind as inputs, given by rho, s or lambda_."""
    designs = given_by(given, family(kind, rng, n))
    return {name: designs[name] for name in GIVEN[given][0]}


def facts(designs, completion, names=FACTS, given="rho"):
    """Return facts of many designs as arrays."""
    inputs, variants = GIVEN[given]
    values = {name: np.asarray(designs[name], dtype=float) for name in inputs}
    values["completion"] = np.full_like(values["a"], completion)
    with np.errstate(all="ignore"):
        found = read_facts(FOCAL, names, values, variants)
    return {name: np.broadcast_to(found[name], values["a"].shape) for name in names}


def exact(names, given="rho"):
    """Return facts with 50 digits, see `Exact.at`."""
    inputs, variants = GIVEN[given]
    return HighPrecision(FOCAL, names, (*inputs, "completion"), variants)


def one(designs, i, completion, given="rho"):
    """Return one design as numbers."""
    return {name: float(designs[name][i]) for name in GIVEN[given][0]} | {"completion": completion}

"""Configurations of the focal mechanism, easy and hard."""

import numpy as np

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.precision.reference import CONTEXT as MP
from fastlink.precision.reference import HighPrecision

BY_ROCKER, BY_CRANK = catalogue("focal"), catalogue("focal", "sigma")
DRIVES = {"phi": BY_ROCKER, "sigma": BY_CRANK}
LENGTHS = "abcd"


#: rho near -1 has S and T far away, lambda near 0 (rho is then near -(a/b)^2, or -1) P and Q; near kites P and Q almost
#: meet.
FAMILIES = (
    *("random", "toggle 1e-3", "toggle 1e-8", "line 1e-3", "line 1e-8", "line 1e-12"),
    *("kite 1e-3", "kite 1e-8", "scale 1e-20", "scale 1e20"),
)


def random_designs(rng, n, low=0.3, high=2.0):
    """Lengths of all classes, rho of either sign, both completions and branches."""
    return {
        **dict(zip(LENGTHS, rng.uniform(low, high, (4, n)), strict=True)),
        "rho": rng.choice([-1.0, 1.0], n) * np.exp(rng.uniform(-1.6, 1.6, n)),
        "omega": rng.uniform(0.5, 2.0, n) * rng.choice([-1.0, 1.0], n),
        "completion": rng.integers(1, 3, n).astype(float),
        "branch": rng.integers(1, 3, n).astype(float),
    }


def positions(seed, n, *names):
    """Return positions in which the first of some quantities has a value, with these."""
    rng = np.random.default_rng(seed)
    inputs = random_designs(rng, n) | {"phi": rng.uniform(-np.pi, np.pi, n)}
    found = inputs | fl.evaluate("focal", names, **inputs)
    closes = np.isfinite(found[names[0]])
    return {name: np.asarray(values)[closes] for name, values in found.items()}


def near_kites(rng, n, size):
    """Lengths near a = d, b = c, and rho near a/b: P and Q nearly meet near the folded position."""
    designs = random_designs(rng, n)
    near = 1.0 + size * rng.uniform(-1.0, 1.0, (3, n))
    b = designs["b"]
    return designs | {"d": designs["a"] * near[0], "c": b * near[1], "rho": designs["a"] / b * near[2]}


def near_toggle(drive, designs, offset):
    """Return designs that have a dead centre and the input angle `offset` inside it."""
    names = ("bar_Z0",) if drive == "phi" else ("sine_at_0", "sine_at_pi")
    facts = HighPrecision(DRIVES[drive], names, designs)
    kept, angles = [], []
    for i, one in enumerate(rows(designs)):
        found = facts.at(one)
        if drive == "phi":
            dead, sense = found["bar_Z0"], 1
        else:
            start, end = found["sine_at_0"], found["sine_at_pi"]
            dead, sense = (
                (start / (start - end), 1 if end > 0 else -1) if start * end < 0 else (MP.mpf(-1), 1)
            )
        if 0.05 < dead < 0.95:
            kept.append(i)
            angles.append(float(2 * MP.asin(MP.sqrt(dead)) + sense * offset))
    return {name: values[kept] for name, values in designs.items()} | {drive: np.array(angles)}


def rows(inputs):
    """Yield configurations one by one as numbers."""
    for i in range(len(next(iter(inputs.values())))):
        yield {name: float(values[i]) for name, values in inputs.items()}


def family(drive, kind, rng, n):
    """Return inputs by name for one family of configurations."""
    name, _, size = kind.partition(" ")
    if name == "toggle":
        return near_toggle(drive, random_designs(rng, 4 * n), float(size))
    designs = near_kites(rng, n, float(size)) if name == "kite" else random_designs(rng, n)
    angles = rng.uniform(-np.pi, np.pi, n)
    if name == "kite":
        angles = rng.choice([-1.0, 1.0], n) * np.exp(rng.uniform(np.log(1e-6), np.log(3.0), n))
    if name == "line":
        designs["rho"] = -1.0 + rng.choice([-1.0, 1.0], n) * float(size) * rng.uniform(0.5, 2.0, n)
    if name == "scale":
        designs |= {length: designs[length] * float(size) for length in LENGTHS}
    return designs | {drive: angles}

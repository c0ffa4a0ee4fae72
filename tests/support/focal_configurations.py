"""Configurations of the focal mechanism, easy and hard."""

from __future__ import annotations

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
    *(
        "random",
        "toggle 1e-3",
        "toggle 1e-8",
        "line 1e-3",
        "line 1e-8",
        "line 1e-12",
        "kite 1e-3",
        "kite 1e-8",
    ),
    *("scale 1e-20", "scale 1e20"),
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


# -- unlike numbers -----------------------------------------------------------------------------------------------

#: rho from 1e-10 to 1e10 and lambda next to 1 or 0 (where one bar, or the other, is 1e-10 of its neighbours), two bars
#: or one bar down to 1e-8 of the others.
UNLIKE = (
    "rho",
    "lambda next to 0",
    "two short",
    "two short, rho",
    "two short, lambda next to 0",
    "one short, rho",
    "joints nearly meet",
)

#: One of each kind that lost up to 1700 roundings times the condition by formulas that cancel: short AB and MN with F
#: next to S; the same where AB does not revolve; short MA and NB with FT next to r; P or Q, and both, next to S by
#: the rocker and by the crank; AB through M with the crank nearly along MN. Input, a, b, c, d and rho, completion,
#: branch and angle.
HARD = (
    ("phi", (1.4876067609403902, 1.4876067915037017, 1.1641287653460961e-08, 5.08542713222432e-08),
     -3.1936477301963375, 1, 1, -2.21582079157216),
    ("phi", (1.1064759783042777, 1.1065813593618898, 0.00013470665958833461, 0.00011341668559384905),
     -2.5247319287543577e-06, 1, 1, 2.761629103640262),
    ("phi", (2.62689561908054e-06, 1.8133461291596687e-06, 1.0736202188969304, 1.0736212447261426),
     -0.2164134315982942, 2, 1, 0.8171327104814652),
    ("phi", (1.5659435107387152, 1.6279134292230382e-06, 1.565942637138195, 2.0236994430000296e-06),
     610.6705184519694, 2, 2, 1.6208317177807414),
    ("sigma", (1.139446842609193, 0.0008942536246440642, 1.7659998470817786, 1.2185614987526048),
     -11063382.666683791, 1, 1, 2.7222103606148997),
    ("sigma", (3.825450676050422e-08, 1.8923354364733516, 1.7455017174889176e-07, 1.892335598755912),
     57298.769137784766, 1, 2, 2.614056658498866),
    ("sigma", (0.7974562804843726, 1.1132276716677723, 1.7606986842216354, 0.44909383608152686),
     -0.0005521337544905362, 1, 2, -0.003100490020995127),
)  # fmt: skip


def short_bars(rng, n, of):
    """Return lengths that assemble, one or two of them down to 1e-8 of the others."""
    lengths = np.empty((4, n))
    for i in range(n):
        bars = rng.permutation(4)
        size = 10.0 ** rng.uniform(-8.0, 0.0)
        if of == "two":
            short = rng.uniform(0.3, 2.0, 2) * size
            long = rng.uniform(0.5, 2.0)
            values = (*short, long, abs(long + short.sum() * rng.uniform(-0.95, 0.95)))
        else:
            one, two = rng.uniform(0.5, 1.5, 2)
            values = (one * size, one, two, abs(one - two) + 2.0 * min(one, two) * rng.uniform(0.05, 0.95))
        lengths[bars, i] = values
    return dict(zip(LENGTHS, lengths, strict=True))


def unlike(drive, kind, rng, n):
    """Return configurations of designs with unlike numbers, within reach of the crank and of the rockers."""
    if kind == "joints nearly meet":
        names = (*LENGTHS, "rho", "completion", "branch", drive)
        hard = np.array([(*of, *others) for by, of, *others in HARD if by == drive]).T
        return dict(zip(names, hard, strict=True)) | {"omega": np.ones(hard.shape[1])}
    of, _, ratio = kind.rpartition(", ") if "," in kind else ("", "", kind)
    designs = random_designs(rng, n)
    if kind.startswith(("two", "one")):
        designs |= short_bars(rng, n, kind[:3])
        ratio = ratio if of else ""
    signs = rng.choice([-1.0, 1.0], n)
    if ratio == "rho":
        designs["rho"] = signs * 10.0 ** rng.uniform(-10.0, 10.0, n)
    if ratio == "lambda next to 0":
        off = 1.0 + signs * 10.0 ** rng.uniform(-12.0, -1.0, n)
        designs["rho"] = -((designs["a"] / designs["b"]) ** 2) * off
    ends = [fl.evaluate("focal", [end], phi=0.0, **designs)[end] for end in ("phi_low", "phi_high")]
    angles = ends[0] + rng.uniform(0.02, 0.98, n) * (ends[1] - ends[0])
    designs["phi"] = rng.choice([-1.0, 1.0], n) * angles
    designs = {name: values[np.isfinite(angles)] for name, values in designs.items()}
    if drive == "phi":
        return designs
    sigma = fl.evaluate("focal", ["sigma"], **designs)["sigma"]
    designs = {name: values[np.isfinite(sigma)] for name, values in designs.items() if name != "phi"}
    return designs | {"sigma": sigma[np.isfinite(sigma)]}

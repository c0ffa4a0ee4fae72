"""Refined extremes: their time, also against samples and scipy, their error, what is missed.

A fact is (what, value, unit, aim). Times are of the bare kernel, one thread, by design and branch: a quantity with a
mirror symmetry is searched in both branches whichever are requested, so that one alone costs as much as both.
"""

import math
from dataclasses import replace

import mpmath
import numpy as np
from scipy.optimize import brentq

from benchmarks import c_kernel, engine
from benchmarks.families import FAMILIES
from benchmarks.inputs import INPUTS, race, round_bars
from fastlink.facts.evaluate import read_facts
from fastlink.mechanisms import catalogue
from fastlink.plan.programs import make_plan
from fastlink.precision.reference import DIGITS

PLANAR = catalogue("planar_4r")
RATES = ("omega2", "omega4", "alpha2", "alpha4")
#: What is timed, by label: quantities, branches, and the aim in ns by design and branch.
TIMED = {
    "omega4": (("omega4",), (1, 2), "<= 200"),
    "omega4, one branch alone": (("omega4",), (1,), "<= 200"),
    "omega4 and alpha4": (("omega4", "alpha4"), (1, 2), "<= 450"),
    "omega2, omega4, alpha2, alpha4, shaking_force, T41": ((*RATES, "shaking_force", "T41"), (1, 2), ""),
}
#: Quantities whose extremes are known.
KNOWN = ("transmission_angle", "theta4", "theta2", "B_x")
TIMED_FAMILIES = ("crank", "drag-link", "rocker input", "non-Grashof")
BLOCK = 4096


def extremes(quantities):
    """Return the names of the greatest and least values."""
    return [f"{quantity}_{kind}" for quantity in quantities for kind in ("max", "min")]


def programs(names, **options):
    """Return the programs of names, of designs that give every input."""
    return make_plan(PLANAR, names, given=INPUTS, **options).programs


def draw(family, n, seed=0):
    """Return designs of round bars of a family."""
    return round_bars(FAMILIES[family](np.random.default_rng(seed), n))


def bind(names, x, **options):
    """Return the bound kernels of names."""
    return [engine.bind_program(part, x) for part in programs(names, **options)]


def together(kernels):
    """Return one call for several kernels."""

    def call():
        for kernel in kernels:
            kernel()

    return call


def times(n=BLOCK, rounds=12, labels=tuple(TIMED)):
    """Every extreme of some quantities, in families of linkages."""
    calls, facts = {}, []
    for label in labels:
        quantities, branches, _ = TIMED[label]
        for family in TIMED_FAMILIES:
            kernels = bind(extremes(quantities), draw(family, n), branches=branches)
            calls[label, family] = together(kernels)
    best = race(calls, rounds)
    for (label, family), seconds in best.items():
        _, branches, aim = TIMED[label]
        ns = 1e9 * seconds / (n * len(branches))
        facts.append((f"extremes of {label}, {family}", ns, "ns", aim))
    return facts


def known(n=BLOCK, rounds=12):
    """Extremes that are known in closed form against the quantity at two angles, and against their search."""
    x, facts = draw("non-Grashof", n), []
    for quantity in KNOWN:
        names = extremes([quantity])
        (at_two,) = programs([quantity], angles=2)
        graded = PLANAR.graded
        calls = {
            "known": together(bind(names, x)),
            "two angles": engine.bind_program(at_two, x, [0.0, math.pi]),
        }
        PLANAR.graded = replace(graded, known={})
        try:
            calls["searched"] = together(bind(names, x))
        finally:
            PLANAR.graded = graded
        best = race(calls, rounds)
        of = f"of {quantity}, non-Grashof"
        facts.append((f"known extremes {of}", 1e9 * best["known"] / n, "ns a design", ""))
        facts.append((f"known extremes {of} / two values", best["known"] / best["two angles"], "", "<= 3"))
        facts.append((f"search of extremes {of} / known", best["searched"] / best["known"], "times", ""))
    return facts


def gradients(n=BLOCK, rounds=12, quantities=("omega4", "alpha4", "T41", "transmission_angle", "theta4")):
    """The greatest value with its derivatives by four lengths against it alone."""
    facts = []
    for family in ("crank", "non-Grashof"):
        x = draw(family, n)
        for quantity in quantities:
            alone = [f"{quantity}_max"]
            more = [*alone, *(f"d_{quantity}_max_d_a{k}" for k in (1, 2, 3, 4))]
            best = race({"alone": together(bind(alone, x)), "more": together(bind(more, x))}, rounds)
            of = f"{quantity}_max and its derivatives by four lengths, {family}"
            known = PLANAR.graded is not None and quantity in PLANAR.graded.known
            facts.append((of, 1e9 * best["more"] / n, "ns a design", ""))
            facts.append(
                (f"{of} / the value alone", best["more"] / best["alone"], "", "" if known else "<= 1.3")
            )
    return facts


def against_c(n=BLOCK, rounds=12):
    """Every extreme of omega4 against C."""
    facts = []
    if c_kernel.available():
        for family in TIMED_FAMILIES:
            x = draw(family, n)
            calls = {"ours": together(bind(extremes(["omega4"]), x)), "C": c_kernel.bind_extrema(x)[0]}
            best = race(calls, rounds)
            facts.append((f"extremes of omega4 / C, {family}", best["ours"] / best["C"], "", "<= 1.1"))
    return facts


# ---- error ----


def exact_extreme(quantity, x, branch, theta1):
    """Return the extreme next to an angle, with 50 digits, as a number of mpmath."""
    slope = f"d_{quantity}_d_theta1"
    known = {name: mpmath.mpf(float(value)) for name, value in zip(INPUTS, x, strict=True)}

    def at(name, t):
        return read_facts(PLANAR, [name], known | {"theta1": t, "branch": branch})[name]

    place = mpmath.findroot(lambda t: at(slope, t), (mpmath.mpf(theta1), mpmath.mpf(theta1) + 1e-12))
    return at(quantity, place)


def error(n=40, K=360, quantities=("omega4", "alpha4")):
    """The greatest error of maxima of cranks, refined and over samples."""
    x, facts = draw("crank", n), []
    for quantity in quantities:
        name = f"{quantity}_max"
        (refined,) = bind([name, f"theta1_at_{name}"], x)
        (sampling,) = programs([name], angles=K, extrema="sampled")
        sampled = engine.bind_program(sampling, x, engine.angles(K))
        worst = {"refined": 0.0, f"of {K} samples": 0.0}
        with mpmath.workdps(DIGITS):
            for i in range(n):
                branch = i % 2
                value, place = (array[i, branch] for array in refined.arrays)
                exact = exact_extreme(quantity, x[:, i], branch + 1, place)
                for way, found in zip(worst, (value, sampled.arrays[0][i, branch]), strict=True):
                    worst[way] = max(worst[way], float(abs(mpmath.mpf(float(found)) / exact - 1)))
        for (way, value), aim in zip(worst.items(), ("<= 1e-14", ""), strict=True):
            facts.append((f"max relative error of {name} {way}, crank", value, "", aim))
    return facts


# ---- what is missed ----


def with_cells(program, times):
    """Return a program that searches so many times as many cells."""
    return replace(program, searches=tuple(replace(s, cells=int(times * s.cells)) for s in program.searches))


def missed(n=100_000, families=FAMILIES, quantities=RATES, finer=8):
    """Designs whose number of extremes is another in a search that is so many times as fine."""
    facts = []
    counts = programs([f"{quantity}_extrema_count" for quantity in quantities])
    for family in families:
        x, differ = draw(family, n, seed=1), np.zeros(n, dtype=bool)
        for program in counts:
            found = zip(
                *(engine.bind_program(p, x).arrays for p in (program, with_cells(program, finer))),
                strict=True,
            )
            for one, other in found:
                differ |= np.any(one != other, axis=1)
        facts.append((f"missed by rates: designs of {n:,}, {family}", int(differ.sum()), "", "0"))
    return facts


# ---- against scipy ----


def output_rate(m, t, a, b, c, d, w):
    """Return omega4 and its derivative in branch 2, the textbook way, by the functions of a module."""
    G, dG, ddG = a * a + d * d - 2 * a * d * m.cos(t), 2 * a * d * m.sin(t), 2 * a * d * m.cos(t)
    P, R = G - (b - c) ** 2, (b + c) ** 2 - G
    S = m.sqrt(P * R)
    e, k = (a * a - d * d) / G, (b * b - c * c) / G
    odd = dG * (1 + k) / S
    slope = (ddG * (1 + k) - dG * dG * k / G) / S - odd * dG * (R - P) / (2 * S * S)
    return 0.5 * w * (1 + e + odd), 0.5 * w * (slope - e * dG / G)


def by_scipy(x, K=360):
    """Return the greatest and least omega4 of designs that turn fully: samples, then brentq in each cell."""
    theta = np.linspace(0.0, 2 * np.pi, K + 1)
    found = np.empty((2, x.shape[1]))
    for i, design in enumerate(x[:5].T):
        samples = output_rate(np, theta, *design)[1]
        values = []
        for j in np.flatnonzero((samples[1:] > 0) != (samples[:-1] > 0)):
            place = brentq(lambda t, *rest: output_rate(math, t, *rest)[1], *theta[j : j + 2], tuple(design))
            values.append(output_rate(math, place, *design)[0])
        found[:, i] = max(values), min(values)
    return found


def against_scipy(n=100, rounds=12):
    """What NumPy and scipy take."""
    x = draw("crank", BLOCK)
    calls = {"ours": together(bind(extremes(["omega4"]), x)), "scipy": lambda: by_scipy(x[:, :n])}
    best = race(calls, rounds)
    ratio = (best["scipy"] / n) / (best["ours"] / BLOCK)
    return [("extremes of omega4 by 360 samples and brentq / refined, crank", ratio, "times", "")]


# ---- derivatives ----


def derivative(n=64, K=360, rounds=12):
    """The derivative of a curve against the curve."""
    x, theta = engine.designs(n), engine.angles(K)
    best = race(
        {
            name: engine.bind_program(programs([name], angles=K)[0], x, theta)
            for name in ("T41", "d_T41_d_theta1")
        },
        rounds,
    )
    return [("d_T41_d_theta1 / T41, curves", best["d_T41_d_theta1"] / best["T41"], "", "")]


def measure(quick=False, log=lambda text: None):
    """Return all facts; quick: small sizes, few quantities."""
    if quick:
        few = ("omega4",)
        facts = times(64, 1, few) + against_c(64, 1) + error(2, 36, few) + missed(64, ("crank",), ("alpha4",))
        return facts + known(64, 1) + gradients(64, 1, few) + against_scipy(2, 1) + derivative(8, 64, 1)
    facts = []
    for part in (times, known, gradients, against_c, error, missed, against_scipy, derivative):
        log(f"extrema: {part.__name__}")
        facts += part()
    return facts

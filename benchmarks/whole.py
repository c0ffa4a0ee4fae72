"""Extremes end to end and against each other: `fastlink.sweep` over C, refined over sampled, one mode over both.

Ratios of times, less is better. C of samples is the kernel's own text (`in_c`), of refined extremes `extrema.c`, which
finds those of omega4. A fact is (what, value, unit, aim).
"""

import time

import numpy as np

import fastlink as fl
from benchmarks import c_kernel, engine, extrema, in_c
from benchmarks.inputs import CASES, INPUTS, designs, race

FIVE = CASES["extremes"][:5]
OMEGA4 = extrema.extremes(["omega4"])
K = 360
#: What is refined, by label: names, aim of refined over sampled.
REFINED = {
    "omega4": (OMEGA4, "<= 0.7"),
    "omega4 and alpha4": (extrema.extremes(["omega4", "alpha4"]), "<= 1.0"),
    "shaking force": (extrema.extremes(["shaking_force"]), "<= 1.0"),
}


def swept(x, names, way):
    """Return a call of `fastlink.sweep` for designs that give every input: one thread, in memory."""
    space = fl.table(dict(zip(INPUTS, x, strict=True)))
    options = {"extrema": way, "threads": 1, "verify": 0, "progress": False}
    return lambda: fl.sweep("planar_4r", space, names, **options)


def in_turns(calls, rounds):
    """Return the shortest time of each call, in turns; the calls are long, so that one warms up for all rounds."""
    best = dict.fromkeys(calls, np.inf)
    for call in calls.values():
        call()
    for _ in range(rounds):
        for name, call in calls.items():
            start = time.perf_counter()
            call()
            best[name] = min(best[name], time.perf_counter() - start)
    return best


def sampled_in_c(x):
    """Return a call of C for five extremes over samples."""
    program = engine.make_program(extrema.PLANAR, FIVE, given=INPUTS, angles=K)
    return in_c.bind(engine.bind_results(program, INPUTS, x, engine.angles(K)))[0]


def end_to_end(n=200_000, rounds=4, count=3):
    """Extremes of many designs through `fastlink.sweep`, over C where there is a compiler."""
    x, facts = designs(n), []
    cases = {
        "five sampled extremes": (swept(x, FIVE, "sampled"), lambda: sampled_in_c(x)),
        "refined extremes of omega4": (swept(x, OMEGA4, "refined"), lambda: c_kernel.bind_extrema(x)[0]),
        "five refined extremes": (swept(x, FIVE, "refined"), None),
    }
    for label, (ours, theirs) in list(cases.items())[:count]:
        calls = {"ours": ours}
        if theirs is not None and c_kernel.available():
            calls["C"] = theirs()
        best = in_turns(calls, rounds)
        what = f"{label}, `fastlink.sweep` of {n:,} designs"
        facts.append((f"{what}, by design", 1e9 * best["ours"] / n, "ns", ""))
        if "C" in best:
            facts.append((f"{what} / C", best["ours"] / best["C"], "", "<= 1.15"))
    return facts


def bound(names, x, way, branches=(1, 2)):
    """Return one call of the bare kernels of extremes."""
    parts = extrema.programs(names, angles=K, extrema=way, branches=branches)
    theta = engine.angles(K) if way == "sampled" else ()
    return extrema.together([engine.bind_results(part, INPUTS, x, theta) for part in parts])


def refined_over_sampled(n=2048, rounds=10, labels=tuple(REFINED)):
    """Refined extremes over 360 samples of the same quantities."""
    x, facts = designs(n), []
    for label in labels:
        names, aim = REFINED[label]
        best = race({way: bound(names, x, way) for way in ("refined", "sampled")}, rounds)
        what = f"extremes of {label}, refined / of {K} samples"
        facts.append((what, best["refined"] / best["sampled"], "", aim))
    return facts


def one_mode(n=2048, rounds=10, labels=tuple(REFINED)):
    """One assembly mode alone over both."""
    x, facts = designs(n), []
    cases = {f"refined extremes of {label}": (REFINED[label][0], "refined") for label in labels}
    for label, (names, way) in {"five sampled extremes": (FIVE, "sampled"), **cases}.items():
        calls = {branches: bound(names, x, way, branches) for branches in ((1,), (2,), (1, 2))}
        best = race(calls, rounds)
        ratio = max(best[1,], best[2,]) / best[1, 2]
        facts.append((f"{label}, one assembly mode / both", ratio, "", "<= 0.65"))
    return facts


def measure(quick=False, log=lambda text: None):
    """Return all facts; quick: small sizes."""
    if quick:
        few = ("omega4",)
        return end_to_end(128, 1, count=2) + refined_over_sampled(64, 1, few) + one_mode(64, 1, few)
    facts = []
    for part in (end_to_end, refined_over_sampled, one_mode):
        log(f"whole: {part.__name__}")
        facts += part()
    return facts

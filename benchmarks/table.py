"""The table of speed and error, and ratios of extremes: two things of a ratio are timed in turns.

Times are of the bare kernel, one thread, but for what names `fastlink.sweep`.
"""

import numpy as np

import fastlink as fl
from benchmarks import numba_baseline, peers
from benchmarks.cases import (
    CASES,
    angle_tables,
    angles,
    bind,
    bind_case,
    designs,
    fact,
    log,
    race,
    space_of,
    threads,
)

#: No multiple of 32: curves of 360 angles, one behind the other, would all begin at one place of their pages, for which
#: the first cache has fewer lines than there are curves. Those of sweeps do not lie so.
DESIGNS = 60
K = 360


# ---- the table ----


def against_c(case, n=DESIGNS, K=K):
    """Return calls, of ours and of C where there is a compiler, and what they are called with."""
    x, tables = designs(n), angle_tables(K)
    calls = {"ours": bind_case(case, x, K)[0]}
    if peers.compiler():
        calls["C"], _ = peers.bind_c(case, x, tables)
    return calls, x, tables


def ratios_to_c():
    """Return rows with the time of each case over that of C alone."""
    found = {case: race(against_c(case)[0]) for case in CASES}
    return [{"case": case, "to_C": t["ours"] / t["C"]} for case, t in found.items() if "C" in t]


def error_of(case, K, count, **options):
    """Return the largest error in roundings, by the verification of a sweep."""
    options |= {"theta1": K, "extrema": "sampled", "verify": count, "progress": False}
    maps = fl.sweep("planar_4r", space_of(designs(64, seed=1)), CASES[case], **options)
    return max(float(maps[name].attrs["error_max_roundings"]) for name in CASES[case])


def case_row(case, n, K, rounds, count, **lengths):
    """Return the row of a case without JAX; times are ns per configuration, one thread."""
    calls, x, tables = against_c(case, n, K)
    calls["NumPy"], _ = peers.bind_numpy(case, x, tables)
    calls["numba"], _ = numba_baseline.bind(case, x, tables)
    if peers.heyoka_has(case):
        calls["heyoka"], _ = peers.bind_heyoka(case, x, tables)
    best = race(calls, rounds)
    one, two, configurations = threads(case, K=K, **lengths)
    found = {"case": case, "ns": 1e9 * best["ours"] / (2 * n * K), "threads": one / two}
    found |= {"run_ns": 1e9 * one / configurations, "error": error_of(case, K, count)}
    found |= {name: best[name] / best["ours"] for name in ("NumPy", "heyoka", "numba") if name in best}
    return found | ({"to_C": best["ours"] / best["C"]} if "C" in best else {})


def dense_rows(n, K, rounds, count):
    """Return the rows of the nine reactions against the stacked 9x9, eliminated and by our own LU."""
    few = designs(n // 4)  # for LU in NumPy, which takes hundreds of times as long
    assembled = peers.system(few, angles(K))
    ways = {"eliminated": "reactions", "dense": 'solver="dense"'}
    calls = {way: bind_case("reactions", designs(n), K, solver=way)[0] for way in ways}
    best = race({"solve": lambda: peers.solve(*assembled)} | calls, rounds)
    theirs = best["solve"] * (n // few.shape[1])
    return [
        {
            "case": f"{label} against np.linalg.solve",
            "ns": 1e9 * best[way] / (2 * n * K),
            "NumPy": theirs / best[way],
            "error": error_of("reactions", K, count, solver=way),
        }
        for way, label in ways.items()
    ]


def add_jax(rows, turns=2):
    """Put in how many times as long JAX takes: a fresh process each time, in turns with ours."""
    if not peers.available("jax"):
        return
    kernels = {case: bind_case(case, designs(DESIGNS), K)[0] for case in CASES}
    ours, theirs = dict.fromkeys(kernels, np.inf), dict.fromkeys(kernels, np.inf)
    for wide in (True, False) * turns:
        found, best = peers.jax_times(wide), race(kernels, rounds=4)
        for case in kernels:
            theirs[case] = min(theirs[case], found[case])
            ours[case] = min(ours[case], 1e9 * best[case] / (2 * DESIGNS * K))
    for row in rows:
        if row["case"] in kernels:
            row["JAX"] = theirs[row["case"]] / ours[row["case"]]


def measure(quick=False):
    """Return the rows of the table; quick: small sizes, no JAX."""
    size = (
        {"n": 8, "K": 64, "rounds": 1, "count": 3}
        if quick
        else {"n": DESIGNS, "K": K, "rounds": 12, "count": 64}
    )
    lengths = {"seconds": 0.01, "repeats": 1} if quick else {}
    rows = []
    for case in CASES:
        log(case)
        rows.append(case_row(case, **size, **lengths))
    log("np.linalg.solve")
    rows += dense_rows(**size)
    if not quick:
        log("JAX")
        add_jax(rows)
    return rows


# ---- extremes ----

#: What is refined, by label.
REFINED = {
    "omega4": ("omega4",),
    "omega4 and alpha4": ("omega4", "alpha4"),
    "shaking force": ("shaking_force",),
}


def extremes(label):
    """Return the names of the greatest and least values."""
    return [f"{quantity}_{kind}" for quantity in REFINED[label] for kind in ("max", "min")]


def end_to_end(n=200_000, rounds=4):
    """Extremes of omega4 of many designs through `fastlink.sweep`, over the kernel alone."""
    names, space = extremes("omega4"), space_of(designs(n))
    calls = {
        "sweep": lambda: fl.sweep("planar_4r", space, names, threads=1, verify=0, progress=False),
        "kernel": bind(names, space)[0],
    }
    best = race(calls, rounds, 0.0)
    what = f"refined extremes of omega4, `fastlink.sweep` of {n:,} designs"
    return [
        fact(f"{what}, by design", 1e9 * best["sweep"] / n, "ns"),
        fact(f"{what} / kernel alone", best["sweep"] / best["kernel"]),
    ]


def refined_over_sampled(n=2048, rounds=10, labels=tuple(REFINED)):
    """Refined extremes over 360 samples of the same quantities."""
    space, facts = space_of(designs(n)), []
    for label in labels:
        ways = {"refined": {}, "sampled": {"extrema": "sampled", "angles": K}}
        best = race({way: bind(extremes(label), space, **ways[way])[0] for way in ways}, rounds)
        what = f"extremes of {label}, refined / of {K} samples"
        facts.append(fact(what, best["refined"] / best["sampled"]))
    return facts


def one_mode(n=2048, rounds=10, labels=tuple(REFINED)):
    """One assembly mode alone over both."""
    space, facts = space_of(designs(n)), []
    cases = {"five sampled extremes": (CASES["extremes"][:5], {"extrema": "sampled", "angles": K})}
    cases |= {f"refined extremes of {label}": (extremes(label), {}) for label in labels}
    for label, (names, options) in cases.items():
        modes = (1,), (2,), (1, 2)
        best = race({mode: bind(names, space, branch=mode, **options)[0] for mode in modes}, rounds)
        ratio = max(best[1,], best[2,]) / best[1, 2]
        facts.append(fact(f"{label}, one assembly mode / both", ratio))
    return facts


def facts(quick=False):
    """Return all facts; quick: small sizes."""
    few = (64, 1, ("omega4",))
    found = []
    for part, size in {end_to_end: (128, 1), refined_over_sampled: few, one_mode: few}.items():
        log(part.__name__)
        found += part(*size) if quick else part()
    return found

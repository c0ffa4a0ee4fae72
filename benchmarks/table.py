"""The table of speed and error, and ratios of extremes: two things of a ratio are timed in turns.

A fact is (what, value, unit, aim). Times are of the bare kernel, one thread, but for what names `fastlink.sweep`.
"""

import numpy as np

import fastlink as fl
from benchmarks import numba_baseline, peers
from benchmarks.cases import CASES, INPUTS, angle_tables, angles, bind, bind_names, designs, race, threads

#: No multiple of 32: curves of 360 angles, one behind the other, would all begin at one place of their pages, for which
#: the first cache has fewer lines than there are curves. Those of sweeps do not lie so.
DESIGNS = 60
K = 360


# ---- the table ----


def against_c(case, n=DESIGNS, K=K):
    """Return calls, of ours and of C where there is a compiler, and what they are called with."""
    x, tables = designs(n), angle_tables(K)
    calls = {"ours": bind(case, x, K)[0]}
    if peers.compiler():
        calls["C"], _ = peers.bind_c(case, x, tables)
    return calls, x, tables


def ratios_to_c(cases=CASES, rounds=12):
    """Return facts: the time of each case over that of C."""
    found = {case: race(against_c(case)[0], rounds) for case in cases}
    return [(f"{case}, time / C", t["ours"] / t["C"], "", "") for case, t in found.items() if "C" in t]


def error_of(case, K, count, **options):
    """Return the largest error in roundings, by the verification of a sweep."""
    space = fl.table(dict(zip(INPUTS, designs(64, seed=1), strict=True)))
    options |= {"theta1": K, "extrema": "sampled", "verify": count, "progress": False}
    maps = fl.sweep("planar_4r", space, CASES[case], **options)
    return max(float(maps[name].attrs["error_max_roundings"]) for name in CASES[case])


def case_row(case, n, K, rounds, seconds, repeats, count):
    """Return the row of a case without JAX; times are ns per configuration, one thread."""
    calls, x, tables = against_c(case, n, K)
    calls["NumPy"], _ = peers.bind_numpy(case, x, tables)
    calls["numba"], _ = numba_baseline.bind(case, x, tables)
    if peers.heyoka_has(case):
        calls["heyoka"], _ = peers.bind_heyoka(case, x, tables)
    best = race(calls, rounds)
    one, two, configurations = threads(case, seconds, repeats, K)
    found = {"case": case, "ns": 1e9 * best["ours"] / (2 * n * K), "threads": one / two}
    found |= {"run_ns": 1e9 * one / configurations, "error": error_of(case, K, count)}
    found |= {name: best[name] / best["ours"] for name in ("NumPy", "heyoka", "numba") if name in best}
    return found | ({"to_C": best["ours"] / best["C"]} if "C" in best else {})


def dense_rows(n, K, rounds, count):
    """Return the rows of the nine reactions against the stacked 9x9, eliminated and by our own LU."""
    few = designs(n // 4)  # for LU in NumPy, which takes hundreds of times as long
    assembled = peers.system(few, angles(K))
    ways = {"reactions": "eliminated", 'solver="dense"': "dense"}
    variants = {"eliminated": (), "dense": ("dense",)}
    calls = {way: bind("reactions", designs(n), K, variants=variants[way])[0] for way in ways.values()}
    best = race({"solve": lambda: peers.solve(*assembled)} | calls, rounds)
    theirs = best["solve"] * (n // few.shape[1])
    return [
        {
            "case": f"{label} against np.linalg.solve",
            "ns": 1e9 * best[way] / (2 * n * K),
            "NumPy": theirs / best[way],
            "error": error_of("reactions", K, count, solver=way),
        }
        for label, way in ways.items()
    ]


def add_jax(rows, n, K, turns=2):
    """Put in how many times as long JAX takes: a fresh process each time, in turns with ours."""
    if not peers.available("jax"):
        return
    kernels = {case: bind(case, designs(n), K)[0] for case in CASES}
    ours, theirs = dict.fromkeys(kernels, np.inf), dict.fromkeys(kernels, np.inf)
    for wide in (True, False) * turns:
        found, best = peers.jax_times(wide), race(kernels, rounds=4)
        for case in kernels:
            theirs[case] = min(theirs[case], found[case])
            ours[case] = min(ours[case], 1e9 * best[case] / (2 * n * K))
    for row in rows:
        if row["case"] in kernels:
            row["JAX"] = theirs[row["case"]] / ours[row["case"]]


def measure(quick=False, log=lambda text: None):
    """Return the rows of the table; quick: small sizes, no JAX."""
    n, K, rounds, seconds, repeats, count = (
        (8, 64, 1, 0.01, 1, 3) if quick else (DESIGNS, 360, 12, 1.2, 3, 64)
    )
    rows = []
    for case in CASES:
        log(case)
        rows.append(case_row(case, n, K, rounds, seconds, repeats, count))
    log("np.linalg.solve")
    rows += dense_rows(n, K, rounds, count)
    if not quick:
        log("JAX")
        add_jax(rows, n, K)
    return rows


# ---- extremes ----


def extremes(*quantities):
    """Return the names of the greatest and least values."""
    return [f"{quantity}_{kind}" for quantity in quantities for kind in ("max", "min")]


#: What is refined, by label: names, aim of refined over sampled.
REFINED = {
    "omega4": (extremes("omega4"), "<= 0.7"),
    "omega4 and alpha4": (extremes("omega4", "alpha4"), "<= 1.0"),
    "shaking force": (extremes("shaking_force"), "<= 1.0"),
}


def end_to_end(n=200_000, rounds=4):
    """Extremes of omega4 of many designs through `fastlink.sweep`, over the kernel alone."""
    x, names = designs(n), REFINED["omega4"][0]
    space = fl.table(dict(zip(INPUTS, x, strict=True)))
    calls = {
        "sweep": lambda: fl.sweep("planar_4r", space, names, threads=1, verify=0, progress=False),
        "kernel": bind_names(names, x),
    }
    best = race(calls, rounds, 0.0)
    what = f"refined extremes of omega4, `fastlink.sweep` of {n:,} designs"
    return [
        (f"{what}, by design", 1e9 * best["sweep"] / n, "ns", ""),
        (f"{what} / kernel alone", best["sweep"] / best["kernel"], "", ""),
    ]


def of_extremes(names, x, way, branches=(1, 2)):
    return bind_names(names, x, angles(K) if way == "sampled" else (), extrema=way, branches=branches)


def refined_over_sampled(n=2048, rounds=10, labels=tuple(REFINED)):
    """Refined extremes over 360 samples of the same quantities."""
    x, facts = designs(n), []
    for label in labels:
        names, aim = REFINED[label]
        best = race({way: of_extremes(names, x, way) for way in ("refined", "sampled")}, rounds)
        ratio = best["refined"] / best["sampled"]
        facts.append((f"extremes of {label}, refined / of {K} samples", ratio, "", aim))
    return facts


def one_mode(n=2048, rounds=10, labels=tuple(REFINED)):
    """One assembly mode alone over both."""
    x, facts = designs(n), []
    cases = {f"refined extremes of {label}": (REFINED[label][0], "refined") for label in labels}
    for label, (names, way) in {"five sampled extremes": (CASES["extremes"][:5], "sampled"), **cases}.items():
        best = race({modes: of_extremes(names, x, way, modes) for modes in ((1,), (2,), (1, 2))}, rounds)
        ratio = max(best[1,], best[2,]) / best[1, 2]
        facts.append((f"{label}, one assembly mode / both", ratio, "", "<= 0.65"))
    return facts


def facts(quick=False, log=lambda text: None):
    """Return all facts; quick: small sizes."""
    few = ("omega4",)
    sizes = {end_to_end: (128, 1), refined_over_sampled: (64, 1, few), one_mode: (64, 1, few)}
    found = []
    for part, size in sizes.items():
        log(part.__name__)
        found += part(*size) if quick else part()
    return found

"""The table of speed and error, and ratios of extremes: two things of a ratio are timed in turns.

Times are of the bare kernel, one thread, but for what names `fastlink.sweep`.
"""

import fastlink as fl
from benchmarks import numba_baseline, peers
from benchmarks.cases import CASES, angle_tables, bind, bind_case, designs, fact, log, race, space_of, threads

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
    maps = fl.sweep("planar_4r", space_of(designs(64, seed=1)), CASES[case], **{"branch": (1, 2)} | options)
    return max(float(maps[name].attrs["error_max_roundings"]) for name in CASES[case])


def case_row(case, n=DESIGNS, K=K, rounds=12, repeats=3, size=500_000, count=64, turns=2):
    """Return the row of a case; times are ns per configuration, one thread."""
    calls, x, tables = against_c(case, n, K)
    calls["NumPy"], _ = peers.bind_numpy(case, x, tables)
    calls["numba"], _ = numba_baseline.bind(case, x, tables)
    if peers.heyoka_has(case):
        calls["heyoka"], _ = peers.bind_heyoka(case, x, tables)
    best = {name: 1e9 * seconds / (2 * n * K) for name, seconds in race(calls, rounds).items()}
    if turns and peers.available("jax"):
        best["JAX"] = min(peers.jax_time(case, wide) for wide in (True, False) * turns)
    one, two = (1e9 * seconds / (2 * size * K) for seconds in threads(case, size, repeats, K))
    found = {
        "case": case,
        "ns": best["ours"],
        "threads": one / two,
        "run_ns": one,
        "error": error_of(case, K, count),
    }
    found |= {name: best[name] / best["ours"] for name in ("NumPy", "JAX", "heyoka", "numba") if name in best}
    return found | ({"to_C": best["ours"] / best["C"]} if "C" in best else {})


def dense_rows(n=DESIGNS // 4, K=K, rounds=12, count=64):
    """Return the rows of the nine reactions against the stacked 9x9, eliminated and by our own LU."""
    x, ways = designs(n), {"eliminated": "reactions", "dense": 'solver="dense"'}
    calls = {way: bind_case("reactions", x, K, solver=way)[0] for way in ways}
    assembled = peers.system(x, K)
    best = race({"solve": lambda: peers.solve(*assembled)} | calls, rounds)
    return [
        {
            "case": f"{label} against np.linalg.solve",
            "ns": 1e9 * best[way] / (2 * n * K),
            "NumPy": best["solve"] / best[way],
            "error": error_of("reactions", K, count, solver=way),
        }
        for way, label in ways.items()
    ]


def measure(quick=False):
    """Return the rows of the table; quick: small sizes, no JAX."""
    few = {"n": 8, "K": 64, "rounds": 1, "count": 3} if quick else {}
    short = {"repeats": 1, "size": 4096, "turns": 0} if quick else {}
    rows = []
    for case in CASES:
        log(case)
        rows.append(case_row(case, **few, **short))
    log("np.linalg.solve")
    return rows + dense_rows(**few)


# ---- extremes ----

SAMPLED = {"extrema": "sampled", "angles": K}
#: What is refined, by label.
REFINED = {
    "omega4": ("omega4_max", "omega4_min"),
    "omega4 and alpha4": ("omega4_max", "omega4_min", "alpha4_max", "alpha4_min"),
    "shaking force": ("shaking_force_max", "shaking_force_min"),
}


def end_to_end(n=200_000, rounds=4):
    """Extremes of omega4 of many designs through `fastlink.sweep`, over the kernel alone."""
    names, space = REFINED["omega4"], space_of(designs(n))
    calls = {
        "sweep": lambda: fl.sweep(
            "planar_4r", space, names, threads=1, verify=0, progress=False, branch=(1, 2)
        ),
        "kernel": bind(names, space)[0],
    }
    best = race(calls, rounds, 0.0)
    what = f"refined extremes of omega4, `fastlink.sweep` of {n:,} designs"
    return [
        fact(f"{what}, by design", 1e9 * best["sweep"] / n, "ns"),
        fact(f"{what} / kernel alone", best["sweep"] / best["kernel"]),
    ]


def of_extremes(n=2048, rounds=10, labels=tuple(REFINED)):
    """Refined extremes over 360 samples of the same quantities, and one branch over both."""
    space, facts = space_of(designs(n)), []
    requests = {f"refined extremes of {label}": (REFINED[label], {}) for label in labels}
    requests["five sampled extremes"] = CASES["extremes"][:5], SAMPLED
    for what, (names, options) in requests.items():
        ways = {mode: options | {"branch": mode} for mode in (1, 2, (1, 2))} | {"sampled": SAMPLED}
        best = race({way: bind(names, space, **ways[way])[0] for way in ways}, rounds)
        facts.append(fact(f"{what}, one branch / both", max(best[1], best[2]) / best[1, 2]))
        if not options:
            ratio = best[1, 2] / best["sampled"]
            facts.append(fact(f"{what.removeprefix('refined ')}, refined / of {K} samples", ratio))
    return facts

"""The table of speed and error: one row for each case, every ratio of two things timed in turns."""

from functools import partial

import numpy as np

from benchmarks import (
    c_kernel,
    dense_baseline,
    engine,
    errors,
    heyoka_baseline,
    jax_baseline,
    numba_baseline,
    numpy_baseline,
)
from benchmarks.closed_forms import FORMS
from benchmarks.inputs import CASES, angle_tables, designs, outputs, race

COLUMNS = ("case", "ns", "to_C", "NumPy", "JAX", "heyoka", "numba", "threads", "error")


#: No multiple of 32: curves of 360 angles, one behind the other, would all begin at one place of their pages, for which
#: the first cache has fewer lines than there are curves. Those of sweeps do not lie so.
DESIGNS = 60


def against_c(case, n=DESIGNS, K=360):
    """Return calls, of ours and of C where there is a compiler, and what they are called with."""
    x, tables = designs(n), angle_tables(K)
    calls = {"ours": engine.bind(case, x, K)}
    if c_kernel.available():
        calls["C"], _ = c_kernel.bind(case, x, tables)
    return calls, x, tables


def ratios_to_c(cases=CASES, rounds=12):
    """Return facts: the time of each case over that of C."""
    facts = []
    for case in cases:
        best = race(against_c(case)[0], rounds)
        if "C" in best:
            facts.append((f"{case}, time / C", best["ours"] / best["C"], "", ""))
    return facts


def case_row(case, n, K, rounds, seconds, repeats):
    """Return the row of a case without JAX; times are ns per configuration, one thread."""
    calls, x, tables = against_c(case, n, K)
    calls["NumPy"] = partial(numpy_baseline.evaluate, case, x, tables, outputs(case, n, K))
    calls["numba"], _ = numba_baseline.bind(case, x, tables)
    if case in FORMS and heyoka_baseline.available():
        calls["heyoka"], _ = heyoka_baseline.bind(case, x, tables)
    best = race(calls, rounds)
    one, two, count = engine.threads(case, seconds, repeats, K)
    faster = {
        name: best[name] / best["ours"] if name in best else None for name in ("NumPy", "heyoka", "numba")
    }
    return {
        "case": case,
        "ns": 1e9 * best["ours"] / (2 * n * K),
        "to_C": best["ours"] / best["C"] if "C" in best else None,
        "JAX": None,
        **faster,
        "threads": one / two,
        "error": None,
        "run_ns": 1e9 * one / count,
    }


def error_of(case, K, count, **options):
    return errors.worst(case, lambda x, K: engine.bind(case, x, K, **options).arrays, K=K, count=count)


def dense_rows(n, K, rounds, count):
    """Return the rows of the nine reactions against the stacked 9x9, eliminated and by our own LU."""
    x, tables = designs(n), angle_tables(K)
    few = designs(n // 4)  # for LU in NumPy, which takes hundreds of times as long
    calls = {
        "eliminated": engine.bind("reactions", x, K),
        "dense": engine.bind("reactions", x, K, variants=engine.DENSE),
        "solve": partial(dense_baseline.reactions, few, tables, dense_baseline.system(few, tables)),
    }
    best = race(calls, rounds)
    best["solve"] *= n // few.shape[1]
    empty = dict.fromkeys(COLUMNS)
    rows = []
    for label, name, options in (
        ("reactions against np.linalg.solve", "eliminated", {}),
        ('solver="dense" against np.linalg.solve', "dense", {"variants": engine.DENSE}),
    ):
        numbers = {"ns": 1e9 * best[name] / (2 * n * K), "NumPy": best["solve"] / best[name]}
        rows.append(empty | {"case": label} | numbers | {"error": error_of("reactions", K, count, **options)})
    return rows


def add_jax(rows, n, K, turns=2):
    """Put in how many times as long JAX takes: a fresh process each time, in turns with ours."""
    if not jax_baseline.available():
        return
    kernels = {row["case"]: engine.bind(row["case"], designs(n), K) for row in rows if row["case"] in CASES}
    ours, theirs = dict.fromkeys(kernels, np.inf), dict.fromkeys(kernels, np.inf)
    for _ in range(turns):
        for wide in (True, False):
            found = jax_baseline.times(one_thread=True, wide=wide)
            if found is None:
                return
            best = race(kernels, rounds=4)
            for case in kernels:
                theirs[case] = min(theirs[case], found[case])
                ours[case] = min(ours[case], 1e9 * best[case] / (2 * n * K))
    for row in rows:
        if row["case"] in kernels:
            row["JAX"] = theirs[row["case"]] / ours[row["case"]]


def measure(quick=False, log=lambda text: None):
    """Return the rows of the table; quick: small sizes, no JAX."""
    n, K, rounds, seconds, repeats, count = (
        (8, 64, 1, 0.01, 1, 3) if quick else (DESIGNS, 360, 12, 1.2, 3, 100)
    )
    rows = []
    for case in CASES:
        log(case)
        rows.append(case_row(case, n, K, rounds, seconds, repeats))
        rows[-1]["error"] = error_of(case, K, count)
    log("np.linalg.solve")
    rows += dense_rows(n, K, rounds, count)
    if not quick:
        log("JAX")
        add_jax(rows, n, K)
    return rows

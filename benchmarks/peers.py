"""Peers beside fastlink: hand-written numba with a scan, pylinkage, what compilers take, errors of all.

How long heyoka.py, JAX and numba run is in the table of `table`. A fact is (what, value, unit, aim).
"""

import tempfile

import numpy as np

from benchmarks import errors, extrema, heyoka_baseline, jax_baseline, numba_baseline, pylinkage_baseline
from benchmarks.answers import child
from benchmarks.closed_forms import FORMS
from benchmarks.inputs import CASES, angle_tables, designs, race


def against_scan(n=extrema.BLOCK, rounds=12):
    """Every extreme of omega4 of cranks against a scan of 24 angles with false position, in numba."""
    x = extrema.draw("crank", n)
    by_scan, found = numba_baseline.bind_scan(x, angle_tables(numba_baseline.SCAN))
    (ours,) = extrema.bind(extrema.extremes(["omega4"]), x)
    best = race({"ours": ours, "scan": by_scan}, rounds)
    missed = [np.abs(a / b - 1) > 1e-9 for a, b in zip(found, ours.arrays, strict=True)]
    label = f"extremes of omega4 by {numba_baseline.SCAN} angles and false position in numba"
    return [
        (f"{label}, by design", 1e9 * best["scan"] / n, "ns", ""),
        ("extremes of omega4, by design, crank", 1e9 * best["ours"] / n, "ns", ""),
        ("extremes of omega4, crank / scan of 24 angles in numba", best["ours"] / best["scan"], "", ""),
        (f"{label}: designs of {n:,} that it gets wrong", int(np.any(missed, axis=(0, 2)).sum()), "", ""),
    ]


def against_pylinkage(n=10, K=360, rounds=3):
    """Positions by pylinkage, next to the kernel's time."""
    if not pylinkage_baseline.available():
        return []
    x = designs(n)
    call, _ = pylinkage_baseline.bind(x, K)
    best = race({"ours": extrema.engine.bind("positions", x, K), "theirs": call}, rounds)
    theirs, ours = best["theirs"] / (n * K), best["ours"] / (2 * n * K)
    return [
        ("positions by pylinkage", 1e9 * theirs, "ns", ""),
        ("positions, pylinkage / ours", theirs / ours, "times", ""),
    ]


def largest_errors(count=40, K=360):
    """Errors of the peers' results against 50 digits."""
    peers = {"numba by hand": (numba_baseline.evaluate, CASES)}
    if heyoka_baseline.available():
        peers["heyoka.py"] = heyoka_baseline.evaluate, FORMS
    if jax_baseline.available():
        peers["JAX"] = jax_baseline.evaluate, CASES
    facts = []
    for peer, (evaluate, cases) in peers.items():
        for case in cases:
            worst = errors.worst(
                case, lambda x, K, case=case, by=evaluate: by(case, x, angle_tables(K)), K=K, count=count
            )
            facts.append((f"max error of {case} by {peer}", worst, "roundings", ""))
    return facts


def compilation(cases=CASES):
    """What JAX and numba take to compile the same, in fresh processes."""
    facts = []
    for case in cases:
        with tempfile.TemporaryDirectory() as folder:
            seconds = child(f"compile_time({case!r})", module="numba_baseline", NUMBA_CACHE_DIR=folder)
        facts.append((f"compile {case} by numba, written by hand", seconds, "s", ""))
        if jax_baseline.available():
            seconds = child(f"compile_time({case!r})", module="jax_baseline")
            facts.append((f"compile {case} by JAX", seconds, "s", ""))
    return facts


def measure(quick=False, log=lambda text: None):
    """Return all facts; quick: small sizes, no compilation."""
    if quick:
        return against_scan(64, 1) + against_pylinkage(1, 36, 1)
    facts = []
    for part in (against_scan, against_pylinkage, largest_errors, compilation):
        log(f"peers: {part.__name__}")
        facts += part()
    return facts

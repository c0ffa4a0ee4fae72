"""``python -m benchmarks.agree``: agreement and speed of C, NumPy, the dense solve, JAX, and the paper."""

import importlib.util
from functools import partial

import numpy as np

from benchmarks import c_kernel, dense_baseline, jax_baseline, numpy_baseline
from benchmarks.inputs import CASES, angle_tables, best_time, designs, outputs, round_bars

TABLE_1 = ([0.4], [1.2], [0.8], [1.0])
#: Hayes, Hninn, Irani, Table 2 (one misprint corrected), branch 2: quantity, theta1, value there; and the
#: greatest shaking force |F41 + F43| of the round bars of Table 1, to the digits given.
TABLE_2 = (
    ("omega4", 1.667165012, 13.51343678),
    ("omega4", 5.913849943, -23.95938172),
    ("alpha4", 0.1482557001, 1062.775829),
    ("shaking force", 0.1096, 2512.318),
)


def difference(ours, reference):
    """Return the largest difference relative to the design's greatest value; inf where only one is NaN."""
    worst = 0.0
    for a, b in zip(ours, reference, strict=True):
        if not np.array_equal(np.isnan(a), np.isnan(b)):
            return np.inf
        axes = tuple(range(1, b.ndim))
        scale = np.fmax.reduce(np.abs(b), axis=axes, keepdims=True)
        worst = np.fmax(worst, np.fmax.reduce(np.abs(a - b) / scale, axis=None))
    return float(worst)


def agree(n=100, K=90):
    """Return the largest relative differences by (case, baseline): from C, and of C from the paper."""
    x, tables = designs(n), angle_tables(K)
    c = {case: c_kernel.evaluate(case, x, tables) for case in CASES}
    found = {(case, "NumPy"): difference(numpy_baseline.evaluate(case, x, tables), c[case]) for case in CASES}
    found["reactions", "9x9"] = difference(dense_baseline.reactions(x, tables), c["reactions"])
    if importlib.util.find_spec("jax"):
        for case in ("rates", "reactions"):
            found[case, "JAX"] = difference(jax_baseline.evaluate(case, x, tables), c[case])
    hayes = round_bars(TABLE_1)
    tables = angle_tables([theta1 for _, theta1, _ in TABLE_2])
    at = {case: dict(zip(CASES[case], c_kernel.evaluate(case, hayes, tables), strict=True)) for case in CASES}
    force = at["reactions"]
    curves = {
        **at["rates"],
        "shaking force": np.hypot(force["F41_x"] + force["F43_x"], force["F41_y"] + force["F43_y"]),
    }
    for k, (name, theta1, value) in enumerate(TABLE_2):
        found[f"{name} at {theta1}", "paper"] = abs(curves[name][0, 1, k] / value - 1)
    return found


def times(n=64, K=360):
    """Return ns per configuration by (case, baseline), one thread unless the name says otherwise."""
    x, tables = designs(n), angle_tables(K)
    found = {}
    for case in CASES:
        call, _ = c_kernel.bind(case, x, tables)
        found[case, "C"] = best_time(call)
        run = partial(numpy_baseline.evaluate, case, x, tables, outputs(case, n, K))
        found[case, "NumPy"] = best_time(run)
    few = designs(n // 4)
    system = dense_baseline.system(few, tables)
    found["reactions", "9x9"] = 4 * best_time(partial(dense_baseline.reactions, few, tables, system))
    found["reactions", "9x9 assembled"] = 4 * best_time(partial(dense_baseline.reactions, few, tables))
    found = {key: 1e9 * t / (2 * n * K) for key, t in found.items()}
    for name, options in (
        ("JAX", {"one_thread": True}),
        ("JAX, 256 bits", {"one_thread": True, "wide": False}),
        ("JAX, all threads", {"one_thread": False}),
    ):
        found |= {(case, name): t for case, t in (jax_baseline.times(**options) or {}).items()}
    return found


if __name__ == "__main__":
    for key, value in agree().items():
        print("{:28}{:20}".format(*key), f"{value:9.1e}")
    for key, value in times().items():
        print("{:28}{:20}".format(*key), f"{value:9.3f} ns")

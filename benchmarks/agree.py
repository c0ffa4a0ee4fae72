"""``python -m benchmarks.agree``: agreement of fastlink, its peers, the dense solve and the paper."""

import importlib.util

import numpy as np

from benchmarks import (
    c_kernel,
    dense_baseline,
    engine,
    heyoka_baseline,
    jax_baseline,
    numba_baseline,
    numpy_baseline,
)
from benchmarks.closed_forms import FORMS
from benchmarks.inputs import CASES, angle_tables, designs, round_bars

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


def reference(case, x, theta1):
    return engine.bind(case, x, theta1).arrays


def agree(n=100, K=90):
    """Return the largest relative differences by (case, baseline): from fastlink, and of fastlink from the paper."""
    x, tables = designs(n), angle_tables(K)
    ours = {case: reference(case, x, K) for case in CASES}
    others = [(case, "NumPy", numpy_baseline.evaluate) for case in CASES]
    if c_kernel.available():
        others += [(case, "C", c_kernel.evaluate) for case in CASES]
    if importlib.util.find_spec("jax"):
        others += [(case, "JAX", jax_baseline.evaluate) for case in CASES]
    if heyoka_baseline.available():
        others += [(case, "heyoka.py", heyoka_baseline.evaluate) for case in FORMS]
    others += [(case, "numba by hand", numba_baseline.evaluate) for case in CASES]
    found = {
        (case, name): difference(evaluate(case, x, tables), ours[case]) for case, name, evaluate in others
    }
    found["reactions", "9x9"] = difference(dense_baseline.reactions(x, tables), ours["reactions"])
    hayes, theta1 = round_bars(TABLE_1), [theta1 for _, theta1, _ in TABLE_2]
    curves = {}
    for case in ("rates", "reactions"):
        curves |= dict(zip(CASES[case], reference(case, hayes, theta1), strict=True))
    force = [curves[f"F41_{axis}"] + curves[f"F43_{axis}"] for axis in "xy"]
    curves["shaking force"] = np.hypot(*force)
    for k, (name, theta1, value) in enumerate(TABLE_2):
        found[f"{name} at {theta1}", "paper"] = abs(curves[name][0, 1, k] / value - 1)
    return found


if __name__ == "__main__":
    for key, value in agree().items():
        print("{:28}{:20}".format(*key), f"{value:9.1e}")

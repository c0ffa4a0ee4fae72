"""Other facts: angles, the stacked system, the start of a program. A fact is (what, value, unit, aim)."""

import os
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks import dense_baseline, engine, errors
from benchmarks.inputs import angle_tables, designs, empty, race
from fastlink.codegen.kernel import load_kernel
from fastlink.codegen.source import Array, Source

ROOT = Path(__file__).parents[1]
LIBRARIES = "import llvmlite.binding, xarray, h5netcdf"
TIMED = "import time; start = time.perf_counter(); {}; print(time.perf_counter() - start)"
ATAN2 = """
from fastlink.numerics.compiler import lanes
from fastlink.numerics.elementary import atan2


def kernel(points, angles, n, n_angles, out):
    for i in lanes(n):
        out[i] = atan2(points[0, i], points[1, i])
"""


def python(code, **environment):
    """Return the last number that a fresh Python prints."""
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return float(done.stdout.split()[-1])


def angles(n=64, K=360, rounds=12):
    """What theta2 and theta4 add to a plan, and the arc tangent alone."""
    x, facts = designs(n), []
    for case in ("rates", "reactions"):
        with_angles = engine.bind(case, x, K, further=("theta2", "theta4"))
        best = race({"without": engine.bind(case, x, K), "with": with_angles}, rounds)
        facts.append((f"{case} with theta2, theta4 / without", best["with"] / best["without"], "", "<= 2.3"))

    kernel = load_kernel(Source(ATAN2, 2, 0, (), (Array("out", "float64", (None,)),)))
    points, out = empty((2, 4096)), empty((4096,))
    points[:] = np.random.default_rng(0).normal(size=points.shape)
    calls = {
        "ours": partial(kernel, points, np.empty((0, 0)), out.size, 0, out),
        "NumPy": partial(np.arctan2, *points, out=out),
    }
    best = {name: 1e9 * t / out.size for name, t in race(calls, rounds).items()}
    facts.append(("atan2", best["ours"], "ns", ""))
    facts.append(("np.arctan2", best["NumPy"], "ns", ""))
    return facts


def system(n=64, K=360, rounds=6, count=100):
    """The stacked 9x9 with its assembly, and its error."""
    few, tables = designs(n // 4), angle_tables(K)
    calls = {
        "ours": engine.bind("reactions", designs(n), K),
        "9x9": lambda: dense_baseline.reactions(few, tables),
    }
    best = race(calls, rounds)
    error = errors.worst(
        "reactions", lambda x, K: dense_baseline.reactions(x, angle_tables(K)), n=16, K=K, count=count
    )
    ratio = best["9x9"] * (n // few.shape[1]) / best["ours"]
    return [
        ("9x9 assembled and solved by NumPy / nine reactions", ratio, "times", ""),
        ("max error of np.linalg.solve", error, "roundings", ""),
    ]


def start(repeats=5):
    """Imports in fresh processes, in turns; the shortest of each."""
    codes = {
        "libraries": TIMED.format(LIBRARIES),
        "import fastlink": TIMED.format("import fastlink"),
        "import fastlink; fastlink.sweep": TIMED.format("import fastlink; fastlink.sweep"),
        "import fastlink; fastlink.sweep and the planar 4R": TIMED.format(
            "import fastlink, fastlink.mechanisms.planar_4r; fastlink.sweep"
        ),
    }
    best = dict.fromkeys(codes, np.inf)
    help_time = np.inf
    for _ in range(repeats):
        best = {name: min(best[name], python(code)) for name, code in codes.items()}
        begun = time.perf_counter()
        main = "from fastlink.app.cli import main; main()"
        subprocess.run([sys.executable, "-c", main, "--help"], check=True, capture_output=True)
        help_time = min(help_time, time.perf_counter() - begun)
    libraries = best.pop("libraries")
    facts = [(LIBRARIES, libraries, "s", "")]
    for name, seconds in best.items():
        facts += [(name, seconds, "s", ""), (f"{name} / the libraries", seconds / libraries, "", "<= 1.3")]
    return [*facts, ("fastlink --help, whole process", help_time, "s", "")]

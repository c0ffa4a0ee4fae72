"""What is measured, and how: designs, families of linkages, tables of the input angle, fastlink's kernels, a clock.

A design is a column of ``x``, whose rows are `INPUTS`; an angle is a column of ``tables``, whose rows are `TABLES`.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import mpmath
import numpy as np

import fastlink as fl
from fastlink._text import aligned as aligned_text
from fastlink.engine.resolve import resolve
from fastlink.engine.run import Runner, aligned, run
from fastlink.facts.tables import angle_tables as engine_tables
from fastlink.mechanisms import catalogue

ROOT = Path(__file__).parents[1]
PLANAR = catalogue("planar_4r")

INPUTS = (
    *("a1", "a2", "a3", "a4", "omega1", "m1", "m2", "m3", "I1", "I2", "I3"),
    *("G1_u", "G1_v", "G2_u", "G2_v", "G3_u", "G3_v"),
)
TABLES = ("cos_theta1", "sin_theta1", "Z", "Z_low", "C", "C_low")

#: What each case puts out, in order. A curve has the shape (design, branch, angle), an extreme (design,
#: branch); the branches are 1 and 2.
CASES = {
    "positions": ("A_x", "A_y", "B_x", "B_y"),
    "rates": ("B_x", "B_y", "omega2", "omega4", "alpha2", "alpha4"),
    "reactions": ("F41_x", "F41_y", "F21_x", "F21_y", "F32_x", "F32_y", "F43_x", "F43_y", "T41"),
    "extremes": ("omega4_max", "omega4_min", "alpha4_max", "alpha4_min", "T41_max", "F32_x_max"),
}


def angles(theta1):
    """Return the input angles: so many equally spaced ones, or those given."""
    return np.arange(theta1) * (2 * np.pi / theta1) if np.ndim(theta1) == 0 else np.asarray(theta1)


def angle_tables(theta1):
    """Return the rows `TABLES` at the angles ``theta1``, or at so many equally spaced ones.

    Z and C are the squares of the half angle's sine and cosine, Z_low and C_low what these doubles leave out.
    """
    return aligned_copy(engine_tables(PLANAR, TABLES, angles(theta1)))


def round_bars(lengths, omega1=25.0, density=7750.0, radius=0.01):
    """Designs ``x`` from the rows a1 a2 a3 a4 of ``lengths``; links 1, 2, 3 are solid cylinders."""
    lengths = np.asarray(lengths, dtype=float)
    x = np.zeros((len(INPUTS), lengths.shape[1]))
    x[:4], x[4] = lengths, omega1
    x[5:8] = density * np.pi * radius**2 * lengths[:3]
    x[8:11] = x[5:8] * (lengths[:3] ** 2 / 12 + radius**2 / 4)
    x[11::2] = lengths[:3] / 2
    return aligned_copy(x)


def designs(n, seed=0):
    """Random round-bar linkages around Table 1 of Hayes et al., most of which rotate fully."""
    centre, spread = np.array([0.4, 1.2, 0.8, 1.0]), np.array([0.1, 0.2, 0.2, 0.1])
    uniform = np.random.default_rng(seed).uniform(-1, 1, (n, 4))
    return round_bars((centre + spread * uniform).T)


def aligned_copy(array):
    copy = aligned(array.shape)
    copy[...] = array
    return copy


def outputs(case, n, K):
    """Return an array of arrays, one for each name of ``CASES[case]``."""
    return aligned((len(CASES[case]), n, 2) if case == "extremes" else (len(CASES[case]), n, 2, K))


# ---- clocks, and what is said ----


def shortest(call, seconds=0.0, least=1):
    """Return the shortest processor and wall time of calls in s: what the code needs, whoever else uses the machine."""
    best, runs, end = [np.inf] * 2, 0, time.perf_counter() + seconds
    while runs < least or time.perf_counter() < end:
        cpu, wall = time.process_time(), time.perf_counter()
        call()
        wall = time.perf_counter() - wall
        best, runs = [min(best[0], time.process_time() - cpu), min(best[1], wall)], runs + 1
    return best


def race(calls, rounds=12, seconds=0.05):
    """Return the shortest run time in s of each named call, timed in turns so that all see the same machine."""
    best = dict.fromkeys(calls, np.inf)
    for _ in range(rounds):
        for name, call in calls.items():
            call()
            best[name] = min(best[name], shortest(call, seconds)[1])
    return best


def log(text):
    """Say what is measured now."""
    print(f"... {text}", file=sys.stderr, flush=True)


def fact(what, value, unit=""):
    return {"fact": what, "value": value, "unit": unit}


def markdown(head, *rows):
    """Return a table of texts."""
    lines = head, ["---", *["--:"] * (len(head) - 1)], *rows
    cells = [[*(part for cell in line for part in ("|", cell)), "|"] for line in lines]
    return aligned_text(cells, right=2).replace("|  ", "| ").replace("  |", " |")


# ---- families: easy and hard, link lengths (4, n) ----


def near_change_point(rng: np.random.Generator, n: int, sum_of_four: float) -> tuple[np.ndarray, np.ndarray]:
    """Lengths with a1 + a2 = a3 + a4 - gap, and input angles near the folded position."""
    a2, a3, a4 = rng.uniform(1.0, 1.3, n), rng.uniform(0.6, 0.9, n), rng.uniform(1.2, 1.5, n)
    theta = rng.choice([-1.0, 1.0], n) * np.exp(rng.uniform(np.log(1e-6), np.log(1e-1), n))
    return np.array([a3 + a4 - a2 - sum_of_four, a2, a3, a4]), theta


def near_toggle(rng: np.random.Generator, n: int, offset: float) -> tuple[np.ndarray, np.ndarray]:
    """Lengths whose input does not turn fully, and input angles `offset` inside the range."""
    lengths, theta = [], []
    while len(theta) < n:
        a, b, c, d = rng.uniform(0.3, 2.0, 4)
        inner = -(a - b + c - d) * (a + b - c - d) / (4 * a * d)
        if 0.05 < inner < 0.95:
            with mpmath.workdps(50):
                x, y, z, w = (mpmath.mpf(v) for v in (a, b, c, d))
                toggle = 2 * mpmath.asin(mpmath.sqrt(-(x - y + z - w) * (x + y - z - w) / (4 * x * w)))
                theta.append(float(toggle + offset))
            lengths.append((a, b, c, d))
    return np.array(lengths).T, np.array(theta)


# ---- fastlink's kernels ----


def space_of(x, names=INPUTS):
    """Return designs, of which ``names`` are the rows, for `fastlink.sweep`."""
    return fl.table(dict(zip(names, x, strict=True)))


def job_of(names, space, mechanism="planar_4r", **options):
    """Return the compiled kernels of quantities, bound to designs, by the options of `fastlink.sweep`."""
    job = resolve(mechanism, space, names, companions=False, **{"branch": (1, 2)} | options).job()
    return replace(job, far=None)  # the sizes of inputs are looked at by sweeps, not by kernels


def bind(names, space, **options):
    """Return a call of the kernels of quantities, and the arrays that it evaluates into."""
    job = job_of(names, space, **options)
    if len(set(job.shapes)) == 1:  # in one array, as the C kernel has them
        arrays = list(aligned((len(job.shapes), job.size, *job.shapes[0][0]), job.shapes[0][1]))
    else:
        arrays = [aligned((job.size, *shape), dtype) for shape, dtype in job.shapes]
    runner = Runner(job, job.size, targets=arrays)
    runner.evaluate(0, job.size)
    calls = [kernel.bind([arrays[k] for k in kernel.task.results]) for kernel in runner.kernels]
    # the arrays of the kernels live as long as the call
    return lambda _=runner: [call(job.size) for call in calls], arrays


def bind_case(case, x, theta1, **options):
    """Return the same of a case."""
    return bind(CASES[case], space_of(x), extrema="sampled", angles=theta1, **options)


def threads(case, size, repeats, K):
    """Return the run time in s of the engine's blocks with one thread and with two."""
    job = job_of(CASES[case], space_of(designs(size)), extrema="sampled", angles=K)
    best = race({count: lambda count=count: run(job, threads=count) for count in (1, 2)}, repeats, 0.0)
    return best[1], best[2]


def child(code, module, **environment):
    """Return the value of an expression over a module of this package, in a fresh Python."""
    code = f"import json; from benchmarks.{module} import *; print(json.dumps({code}))"
    environment = os.environ | environment
    said = subprocess.check_output([sys.executable, "-c", code], cwd=ROOT, env=environment, text=True)
    return json.loads(said.splitlines()[-1])

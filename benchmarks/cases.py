"""What is measured, and how: designs, families of linkages, tables of the input angle, fastlink's kernels, a clock.

A design is a column of ``x``, whose rows are `INPUTS`; an angle is a column of ``tables``, whose rows are `TABLES`.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path

import mpmath
import numpy as np

from fastlink.codegen.kernel import BACKENDS, kernel_of
from fastlink.codegen.runtime.cells import LANES
from fastlink.engine.run import BLOCK_DESIGNS, Job, KernelTask, aligned, run
from fastlink.mechanisms import catalogue
from fastlink.plan.programs import Program, make_plan, make_program

ROOT = Path(__file__).parents[1]

INPUTS = (
    *("a1", "a2", "a3", "a4", "omega1", "m1", "m2", "m3", "I1", "I2", "I3"),
    *("G1_u", "G1_v", "G2_u", "G2_v", "G3_u", "G3_v"),
)
TABLES = ("cos", "sin", "Z", "Z_low", "C", "C_low")

#: What each case puts out, in order. A curve has the shape (design, branch, angle), an extreme (design,
#: branch); the branches are 1 and 2.
CASES = {
    "positions": ("A_x", "A_y", "B_x", "B_y"),
    "rates": ("B_x", "B_y", "omega2", "omega4", "alpha2", "alpha4"),
    "reactions": ("F41_x", "F41_y", "F21_x", "F21_y", "F32_x", "F32_y", "F43_x", "F43_y", "T41"),
    "extremes": ("omega4_max", "omega4_min", "alpha4_max", "alpha4_min", "T41_max", "F32_x_max"),
}


def angle_tables(theta1):
    """Return the rows `TABLES` at the angles ``theta1``, or at so many equally spaced ones.

    Z and C are the squares of the half angle's sine and cosine, Z_low and C_low what these doubles leave out.
    """
    if np.ndim(theta1) == 0:
        theta1 = np.arange(theta1) * (2 * np.pi / theta1)
    rows = np.empty((len(TABLES), len(theta1)))
    with mpmath.workdps(50):
        for k, t in enumerate(map(mpmath.mpf, map(float, theta1))):
            Z, C = mpmath.sin(t / 2) ** 2, mpmath.cos(t / 2) ** 2
            rows[:, k] = mpmath.cos(t), mpmath.sin(t), Z, Z - float(Z), C, C - float(C)
    return aligned_copy(rows)


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


def empty(shape):
    """Return an uninitialised array that begins on a cache line: stores across two lines take longer."""
    size = int(np.prod(shape)) * 8
    raw = np.empty(size + 64, dtype=np.uint8)
    start = -raw.ctypes.data % 64
    return raw[start : start + size].view(np.float64).reshape(shape)


def aligned_copy(array):
    copy = empty(array.shape)
    copy[...] = array
    return copy


def outputs(case, n, K):
    """One array for each name of ``CASES[case]``."""
    return tuple(empty((n, 2) if case == "extremes" else (n, 2, K)) for _ in CASES[case])


def best_time(call, seconds=0.3, least=5):
    """Return the shortest run time of ``call()`` in s: what the code needs, whoever else uses the machine."""
    call()
    best, runs, end = np.inf, 0, time.perf_counter() + seconds
    while runs < least or time.perf_counter() < end:
        start = time.perf_counter()
        call()
        best, runs = min(best, time.perf_counter() - start), runs + 1
    return best


def race(calls, rounds=12, seconds=0.05):
    """Return the shortest run time in s of each named call, timed in turns so that all see the same machine."""
    best = dict.fromkeys(calls, np.inf)
    for _ in range(rounds):
        for name, call in calls.items():
            best[name] = min(best[name], best_time(call, seconds, least=1))
    return best


# ---- families: easy and hard, link lengths (4, n) ----

Rng = np.random.Generator


def near_change_point(rng: Rng, n: int, sum_of_four: float) -> tuple[np.ndarray, np.ndarray]:
    """Lengths with a1 + a2 = a3 + a4 - gap, and input angles near the folded position."""
    a2, a3, a4 = rng.uniform(1.0, 1.3, n), rng.uniform(0.6, 0.9, n), rng.uniform(1.2, 1.5, n)
    theta = rng.choice([-1.0, 1.0], n) * np.exp(rng.uniform(np.log(1e-6), np.log(1e-1), n))
    return np.array([a3 + a4 - a2 - sum_of_four, a2, a3, a4]), theta


def near_toggle(rng: Rng, n: int, offset: float) -> tuple[np.ndarray, np.ndarray]:
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


@dataclass(frozen=True)
class Bound:
    """A kernel bound to its arguments; calling it evaluates into ``arrays``."""

    program: Program
    arguments: tuple
    arrays: list

    def __call__(self):
        """Evaluate."""
        self.call()

    @cached_property
    def call(self):
        """What evaluates. The table of arguments is filled once, as ctypes has those of the C kernels."""
        kernel = kernel_of(self.program).compiled()
        if not hasattr(kernel, "table"):  # numba's
            return partial(kernel, *self.arguments)
        table = kernel.table(*self.arguments)
        address, call = table.ctypes.data, kernel.call
        return lambda table=table: call(address)


def angles(theta1):
    """Return the input angles: so many equally spaced ones, or those given."""
    return np.arange(theta1) * (2 * np.pi / theta1) if np.ndim(theta1) == 0 else np.asarray(theta1)


def program_of(case, K=360, variants=()):
    return make_program(catalogue("planar_4r"), CASES[case], given=INPUTS, variants=variants, angles=K)


def rows_of(program, x, names=INPUTS):
    """Return the rows of the design array that the program's kernel reads, padded to whole lanes."""
    rows = x[[names.index(name) for name in program.inputs]]
    return aligned_copy(np.pad(rows, ((0, 0), (0, -x.shape[1] % LANES)), mode="edge"))


def shapes(program, K):
    lengths = {"branch": len(program.branches)}
    return [tuple(lengths.get(axis, K) for axis in output.axes) for output in program.outputs]


def bind(case, x, theta1, **options):
    """Return the kernel of a case bound to designs and angles; compiles it."""
    theta = angles(theta1)
    return bind_program(program_of(case, theta.size, **options), x, theta)


def bind_program(program, x, theta=(), names=INPUTS):
    """Return a kernel bound to designs, of which ``names`` are the rows, and to angles; compiles it."""
    (n, K), outputs = (x.shape[1], len(theta)), program.outputs
    if len({output.dtype for output in outputs}) == 1:  # in one array, as the C kernel has them
        arrays = list(aligned((len(outputs), n, *shapes(program, K)[0]), outputs[0].dtype))
    else:
        arrays = [aligned((n, *s), o.dtype) for s, o in zip(shapes(program, K), outputs, strict=True)]
    scratch = [aligned(array.lengths(K), array.dtype) for array in kernel_of(program).source.scratch]
    tables = aligned_copy(program.angle_tables(np.asarray(theta)))
    bound = Bound(program, (rows_of(program, x, names), tables, n, K, *scratch, *arrays), arrays)
    bound()
    return bound


def extremes(quantities):
    """Return the names of the greatest and least values."""
    return [f"{quantity}_{kind}" for quantity in quantities for kind in ("max", "min")]


def bind_names(names, x, theta=(), **options):
    """Return one call of the kernels of names, of designs that give every input, and these kernels."""
    options |= {"given": INPUTS, "angles": len(theta) or None}
    programs = make_plan(catalogue("planar_4r"), names, **options).programs
    kernels = [bind_program(program, x, theta) for program in programs]
    return lambda: [kernel() for kernel in kernels], kernels


def threads(case, seconds=1.2, repeats=3, K=360):
    """Return the run time in s through `fastlink.engine.run` with one thread and with two, and configurations."""
    program, pool, size = program_of(case, K), BLOCK_DESIGNS, 4096
    kernel, rows = kernel_of(program), np.tile(rows_of(program, designs(pool)), 2)
    outputs = [(s, output.dtype) for s, output in zip(shapes(program, K), program.outputs, strict=True)]

    def fill(start, stop, x):
        first = start % pool  # designs repeat those of the pool; a block is a slice, wherever it begins
        x[:, : stop - start] = rows[:, first : first + stop - start]

    def clock(count):
        called = kernel.compiled(BACKENDS[0]), program.angle_tables(angles(K)), tuple(range(len(outputs)))
        job = Job([KernelTask(kernel.source, program.inputs, BACKENDS[0], *called, fill)], outputs, size)
        start = time.perf_counter()
        run(job, threads=count)
        return time.perf_counter() - start

    clock(1)
    size = max(size, round(size * seconds / clock(1)))
    best = {1: np.inf, 2: np.inf}
    for _ in range(repeats):
        best = {count: min(known, clock(count)) for count, known in best.items()}
    return best[1], best[2], size * 2 * K


def child(code, module, **environment):
    """Return the value of an expression over a module of this package, in a fresh Python."""
    done = subprocess.run(
        [sys.executable, "-c", f"import json; from benchmarks.{module} import *; print(json.dumps({code}))"],
        cwd=ROOT,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout.splitlines()[-1])

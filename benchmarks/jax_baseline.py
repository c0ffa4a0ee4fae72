"""The closed forms in jitted JAX on the CPU, in double precision.

Threads and the width of vectors are fixed when JAX starts; `times` therefore measures in a process of its own
(this file's). What was measured to be fastest: each branch a separate output (stacked inside the jit, the
branches take 2 to 5 times as long), blocks of some hundred designs, vectors of 512 bits where the
processor has them.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from benchmarks.inputs import angle_tables, best_time, designs
from benchmarks.numpy_baseline import constants

WIDE = "--xla_cpu_prefer_vector_width=512"


def kernels():
    """Return by case the jitted functions of (x, tables): for each curve a pair, its two branches."""
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    jax.config.update("jax_platforms", "cpu")

    def kinematics(o, tables):
        cos, sin, Z, Z_low, C, C_low = tables
        p = (Z - o["Z0"]) + (Z_low - o["Z0_low"])
        q = (C - o["C0"]) + (C_low - o["C0_low"])
        sigma = jnp.sqrt(p * q)
        r_sigma, r_gamma = 1 / sigma, 1 / (o["gamma0"] + Z)
        A = o["a"] * cos, o["a"] * sin
        u_x = (o["d"] - o["a"]) + 2 * o["a"] * Z
        AB, DB, height = (p / 2 + o["beta"]) * r_gamma, -(p / 2 + o["delta"]) * r_gamma, sigma / 2 * r_gamma
        odd = height * A[1], height * u_x
        w, h = o["w"], sin / 2
        H, k = h * r_sigma, o["kappa"] * r_gamma
        dH = (o["C0"] * Z * p - o["Z0"] * C * q) * (r_sigma * r_sigma * r_sigma) / 2
        T, j = w / 2 * ((o["lambda"] + Z) * r_gamma), h * r_gamma
        E, L = -w * w / 2 * (o["eps"] * j * r_gamma), H * k * j
        parts = (
            (T, w / 2 * (H * (k - 1))),
            (T, w / 2 * (H * (k + 1))),
            (E, w * w / 2 * (dH * (k - 1) - L)),
            (E, w * w / 2 * (dH * (k + 1) - L)),
        )
        return A, (AB * u_x, -AB * A[1]), (DB * u_x, -DB * A[1]), odd, parts, r_sigma

    def both(even, odd):
        return even - odd, even + odd

    def rates(x, tables):
        A, AB, _, odd, parts, _ = kinematics(constants(x), tables)
        return (*(both(A[i] + AB[i], odd[i]) for i in range(2)), *(both(*part) for part in parts))

    def branch_reactions(o, tables, parts, s):
        cos, sin = tables[:2]
        A, AB, DB, odd, rate, r_sigma = parts
        AB, DB = ([even[i] + s * odd[i] for i in range(2)] for even in (AB, DB))
        omega2, omega4, alpha2, alpha4 = (even + s * f for even, f in rate)
        g2 = o["g2_u"] * AB[0] - o["g2_v"] * AB[1], o["g2_u"] * AB[1] + o["g2_v"] * AB[0]
        g3 = o["f3_u"] * DB[0] - o["f3_v"] * DB[1], o["f3_u"] * DB[1] + o["f3_v"] * DB[0]
        ww, w2, w4 = o["w"] * o["w"], omega2 * omega2, omega4 * omega4
        f2_x = o["m2"] * (-ww * A[0] - alpha2 * g2[1] - w2 * g2[0])
        f2_y = o["m2"] * (-ww * A[1] + alpha2 * g2[0] - w2 * g2[1])
        scale = 2 * s * o["r"] * r_sigma
        M2 = (o["I2"] * alpha2 + (g2[0] * f2_y - g2[1] * f2_x)) * scale
        M3 = o["J3"] * scale * alpha4
        F32_x, F32_y = M2 * DB[0] + M3 * AB[0], M2 * DB[1] + M3 * AB[1]
        F21_x, F21_y = F32_x - f2_x, F32_y - f2_y
        F41_x = o["f1_u"] * cos - o["f1_v"] * sin - F21_x
        F41_y = o["f1_u"] * sin + o["f1_v"] * cos - F21_y
        F43_x = F32_x - (alpha4 * g3[1] + w4 * g3[0])
        F43_y = F32_y + (alpha4 * g3[0] - w4 * g3[1])
        T41 = A[1] * F21_x - A[0] * F21_y
        return F41_x, F41_y, F21_x, F21_y, F32_x, F32_y, F43_x, F43_y, T41

    def reactions(x, tables):
        o = constants(x)
        parts = kinematics(o, tables)
        branches = (branch_reactions(o, tables, parts, s) for s in (-1, 1))
        return tuple(zip(*branches, strict=True))

    return {"rates": jax.jit(rates), "reactions": jax.jit(reactions)}


def evaluate(case, x, tables):
    """One array for each name of ``CASES[case]``."""
    return tuple(np.stack(pair, axis=1) for pair in kernels()[case](x, tables))


def measure(n=512, K=360):
    """Return ns per configuration by case, in this process."""
    import jax

    jitted = kernels()  # first: it asks for double precision
    x, tables = jax.device_put(designs(n)), jax.device_put(angle_tables(K))
    seconds = {}
    for case, kernel in jitted.items():
        if kernel(x, tables)[0][0].dtype != np.float64:
            raise RuntimeError("JAX did not compute in double precision")
        seconds[case] = best_time(lambda run=kernel: jax.block_until_ready(run(x, tables)))
    return {case: 1e9 * t / (2 * n * K) for case, t in seconds.items()}


def times(one_thread, wide=True, n=512, K=360):
    """Return `measure` of a fresh process, on one processor or on all; None if JAX is not installed there.

    ``wide=False`` leaves XLA its usual vectors of 256 bits; so does a JAX that does not know the option.
    """
    command = [sys.executable, "-m", "benchmarks.jax_baseline", str(n), str(K)]
    if one_thread:
        command.append("--one-thread")
    for flag in [WIDE, ""] if wide else [""]:
        flags = f"{os.environ.get('XLA_FLAGS', '')} {flag}".strip()
        result = subprocess.run(
            command,
            env={**os.environ, "XLA_FLAGS": flags},
            cwd=Path(__file__).parents[1],
            capture_output=True,
            text=True,
        )
        if result.returncode == 0:
            return json.loads(result.stdout.splitlines()[-1])
    if "No module named 'jax'" in result.stderr:
        return None
    raise RuntimeError(f"the JAX baseline failed:\n{result.stderr}")


def main():
    parser = argparse.ArgumentParser(description=measure.__doc__)
    parser.add_argument("n", type=int)
    parser.add_argument("K", type=int)
    parser.add_argument("--one-thread", action="store_true", help="use one processor only (Linux)")
    arguments = parser.parse_args()
    if arguments.one_thread:  # before JAX starts its threads
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    print(json.dumps(measure(arguments.n, arguments.K)))


if __name__ == "__main__":
    main()

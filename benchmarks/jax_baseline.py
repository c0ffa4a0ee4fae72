"""The closed forms in jitted JAX on the CPU, in double precision.

Threads and the width of vectors are fixed when JAX starts; `times` therefore measures in a process of its own
(this file's). What was measured to be fastest: each branch a separate output (stacked inside the jit, the
branches take 2 to 5 times as long), blocks of some hundred designs, vectors of 512 bits where the
processor has them.
"""

import argparse
import importlib.util
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from benchmarks.closed_forms import FORMS, rates, reactions
from benchmarks.inputs import CASES, angle_tables, best_time, designs
from benchmarks.numpy_baseline import constants

WIDE = "--xla_cpu_prefer_vector_width=512"


def kernels():
    """Return by case the jitted functions of (x, tables): for each result a pair, its two branches."""
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    jax.config.update("jax_platforms", "cpu")

    def form(name):
        return jax.jit(lambda x, tables: FORMS[name](constants(x), tables, jnp.sqrt))

    def greatest(curve):
        found = jnp.max(jnp.where(curve == curve, curve, -jnp.inf), axis=1)
        return jnp.where(found > -jnp.inf, found, jnp.nan)

    def extremes(x, tables):
        o = constants(x)
        omega4, alpha4 = rates(o, tables, jnp.sqrt)[3::2]
        found = dict(zip(CASES["reactions"], reactions(o, tables, jnp.sqrt), strict=True))
        of = {"omega4": omega4, "alpha4": alpha4, "T41": found["T41"], "F32_x": found["F32_x"]}
        results = []
        for name in CASES["extremes"]:
            quantity, _, kind = name.rpartition("_")
            sign = 1.0 if kind == "max" else -1.0
            results.append(tuple(sign * greatest(sign * curve) for curve in of[quantity]))
        return tuple(results)

    return {name: form(name) for name in FORMS} | {"extremes": jax.jit(extremes)}


def evaluate(case, x, tables):
    """One array for each name of ``CASES[case]``."""
    return tuple(np.stack(pair, axis=1) for pair in kernels()[case](x, tables))


def available():
    return importlib.util.find_spec("jax") is not None


def compile_time(case, n=512, K=360):
    """Return how long a case takes to compile, in s; to be called once in a process."""
    import jax

    kernel, x, tables = kernels()[case], jax.device_put(designs(n)), jax.device_put(angle_tables(K))
    start = time.perf_counter()
    kernel.lower(x, tables).compile()
    return time.perf_counter() - start


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

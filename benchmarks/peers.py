"""Peers: C, NumPy, NumPy's 9x9 systems, heyoka.py and JAX; numba by hand is `numba_baseline`.

``bind_NAME(case, x, tables)`` returns ``call, arrays``: ``call()`` evaluates into the arrays, one for each name of
``CASES[case]``. Those but C read one text of the closed forms: operators, and a square root that is handed in.
"""

import ctypes
import functools
import importlib.util
import os
import platform
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import fastlink as fl
from benchmarks.cases import (
    CASES,
    INPUTS,
    TABLES,
    aligned_copy,
    angle_tables,
    angles,
    child,
    designs,
    outputs,
    shortest,
)
from fastlink.codegen.machine import lanes_of_host
from fastlink.engine.run import aligned
from fastlink.numerics.compensated import gap_product_quotient, sum_of_four


def available(module):
    return importlib.util.find_spec(module) is not None


def heyoka_has(case):
    """Tell whether heyoka.py is here and can do a case: it has no extremes."""
    return available("heyoka") and case in ("positions", "rates", "reactions")


# ---- C: compiled by gcc at the first use, called by ctypes ----

#: Strict IEEE arithmetic; without the last two gcc vectorises neither the square root nor a choice.
FLAGS = (
    *("-O3", "-march=native", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math"),
    *("-std=c11", "-fPIC", "-shared"),
)
ADDRESS = ctypes.POINTER(ctypes.c_double)


def compiler():
    """Return the C compiler's path, or None."""
    return shutil.which(os.environ.get("CC", "gcc"))


@functools.cache
def library():
    """Return `kernels.c`, compiled and loaded."""
    width = ["-mprefer-vector-width=512"] if platform.machine().lower() in ("x86_64", "amd64") else []
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder, "kernels.so")
        source = Path(__file__).with_name("kernels.c")
        subprocess.run([compiler(), *FLAGS, *width, source, "-o", target, "-lm"], check=True)
        return ctypes.CDLL(str(target))  # stays loaded when the file goes


def bind_c(case, x, tables):
    """Python takes next to nothing of a call, so that the clock sees the kernel."""
    n, K = x.shape[1], tables.shape[1]
    kernel, arrays = getattr(library(), f"c_{case}"), (x, tables, outputs(case, n, K))
    kernel.restype = None
    arguments = [ctypes.c_long(n), ctypes.c_long(K), *(a.ctypes.data_as(ADDRESS) for a in arrays)]
    # the arrays live as long as the call
    return lambda arrays=arrays: kernel(*arguments), arrays[-1]


# ---- the closed forms: a quantity is even + s odd, with s = -1 for branch 1, +1 for 2 ----


def by_name(x):
    return dict(zip(INPUTS, x[:, :, None], strict=True))  # columns (design, 1)


def constants(i, exact=True):
    """Return what depends on the design alone, from its inputs by name.

    Expressions that are simplified cannot carry what rounding left out: ``exact=False``.
    """
    a, b, c, d, w = (i[name] for name in INPUTS[:5])
    r = 1.0 / (4.0 * (a * d))
    o = {"a": a, "d": d, "w": w, "r": r, "d_a": d - a, "two_a": 2.0 * a, "half_w": 0.5 * w}
    o["half_ww"] = 0.5 * w * w
    if exact:
        u, v = sum_of_four(-a, b, -c, d), sum_of_four(a, b, -c, -d)
        o["Z0"], o["Z0_low"] = gap_product_quotient(*u, *v, a, d)
        u, v = sum_of_four(a, -b, -c, d), sum_of_four(a, b, c, d)
        o["C0"], o["C0_low"] = gap_product_quotient(*u, *v, a, d)
    else:
        o["Z0"] = ((b + d) - (a + c)) * ((a + b) - (c + d)) * r
        o["C0"] = ((a + d) - (b + c)) * ((a + d) + (b + c)) * r
        o |= {"Z0_low": 0.0, "C0_low": 0.0}
    o["Z0_ww"], o["C0_ww"] = 0.25 * w * w * o["Z0"], 0.25 * w * w * o["C0"]
    o |= {"gamma0": (a - d) * (a - d) * r, "lambda": 0.5 * (a - d) / d, "kappa": (b - c) * (b + c) * r}
    o |= {"eps": (a - d) * (a + d) * r, "beta": b * (b - c) * r, "delta": c * (c - b) * r}
    o |= {"f1_u": -(w * w) * i["m1"] * i["G1_u"], "f1_v": -(w * w) * i["m1"] * i["G1_v"], "ww": w * w}
    o |= {"g2_u": i["G2_u"] / b, "g2_v": i["G2_v"] / b, "m2": i["m2"], "I2": i["I2"]}
    o |= {"f3_u": i["m3"] * i["G3_u"] / c, "f3_v": i["m3"] * i["G3_v"] / c}
    o["J3"] = i["I3"] + i["m3"] * (i["G3_u"] * i["G3_u"] + i["G3_v"] * i["G3_v"])
    return o


def both(even, odd):
    return even - odd, even + odd


def turned(u, v, x, y):
    return u * x - v * y, u * y + v * x


def quantities(case, o, tables, sqrt):
    """Return by name a pair, its two branches, of what a case needs."""
    cos, sin, Z, Z_low, C, C_low = tables
    p = (Z - o["Z0"]) + (Z_low - o["Z0_low"])
    q = (C - o["C0"]) + (C_low - o["C0_low"])
    sigma, r_gamma = sqrt(p * q), 1.0 / (o["gamma0"] + Z)
    A, u_x = (o["a"] * cos, o["a"] * sin), o["d_a"] + o["two_a"] * Z
    length, height = (0.5 * p + o["beta"]) * r_gamma, 0.5 * sigma * r_gamma
    AB, odd = (length * u_x, -length * A[1]), (height * A[1], height * u_x)  # AB and DB share their odd part
    found = {"A_x": (A[0], A[0]), "A_y": (A[1], A[1])}
    if case in ("positions", "rates"):
        found |= {f"B_{axis}": both(A[i] + AB[i], odd[i]) for i, axis in enumerate("xy")}
    if case == "positions":
        return found

    rates, r_sigma = rates_of(o, tables, p, q, sigma, r_gamma)
    found |= dict(zip(("omega2", "omega4", "alpha2", "alpha4"), rates, strict=True))
    if case == "rates":
        return found

    length = (0.5 * p + o["delta"]) * r_gamma
    DB = -length * u_x, length * A[1]
    moves = zip((-1.0, 1.0), *map(both, AB + DB, odd + odd), *rates, strict=True)
    branches = [forces(o, tables, A, r_sigma, *move) for move in moves]
    return found | dict(zip(CASES["reactions"], zip(*branches, strict=True), strict=True))


def rates_of(o, tables, p, q, sigma, r_gamma):
    """Return the pairs of omega2, omega4, alpha2, alpha4, and 1/sigma."""
    _, sin, Z, _, C, _ = tables
    r_sigma, h, k = 1.0 / sigma, 0.5 * sin, o["kappa"] * r_gamma
    H, minus, plus = h * r_sigma, k - 1.0, k + 1.0
    dH = (o["C0_ww"] * Z * p - o["Z0_ww"] * C * q) * (r_sigma * r_sigma * r_sigma)
    T, j, wH = o["half_w"] * ((o["lambda"] + Z) * r_gamma), o["half_ww"] * h * r_gamma, o["half_w"] * H
    E, L = -(o["eps"] * j * r_gamma), H * k * j
    return (both(T, wH * minus), both(T, wH * plus), both(E, dH * minus - L), both(E, dH * plus - L)), r_sigma


def forces(o, tables, A, r_sigma, s, AB_x, AB_y, DB_x, DB_y, omega2, omega4, alpha2, alpha4):
    """Return the reactions of a branch."""
    cos, sin = tables[:2]
    g_x, g_y = turned(o["g2_u"], o["g2_v"], AB_x, AB_y)
    w2, w4 = omega2 * omega2, omega4 * omega4
    f2_x = o["m2"] * (-o["ww"] * A[0] - alpha2 * g_y - w2 * g_x)
    f2_y = o["m2"] * (-o["ww"] * A[1] + alpha2 * g_x - w2 * g_y)
    scale = 2.0 * s * o["r"] * r_sigma
    M2, M3 = (o["I2"] * alpha2 + (g_x * f2_y - g_y * f2_x)) * scale, o["J3"] * scale * alpha4
    F32_x, F32_y = M2 * DB_x + M3 * AB_x, M2 * DB_y + M3 * AB_y
    F21_x, F21_y = F32_x - f2_x, F32_y - f2_y
    F41_x, F41_y = o["f1_u"] * cos - o["f1_v"] * sin - F21_x, o["f1_u"] * sin + o["f1_v"] * cos - F21_y
    g_x, g_y = turned(o["f3_u"], o["f3_v"], DB_x, DB_y)
    F43_x, F43_y = F32_x - (alpha4 * g_y + w4 * g_x), F32_y + (alpha4 * g_x - w4 * g_y)
    return F41_x, F41_y, F21_x, F21_y, F32_x, F32_y, F43_x, F43_y, A[1] * F21_x - A[0] * F21_y


def evaluate(case, o, tables, sqrt, greatest=None):
    """Return for each name of ``CASES[case]`` a pair; ``greatest`` passes over NaN along the angle."""
    found = quantities(case, o, tables, sqrt)
    if case != "extremes":
        return [found[name] for name in CASES[case]]
    results = []
    for name in CASES[case]:
        quantity, _, kind = name.rpartition("_")
        results.append([greatest(c) if kind == "max" else -greatest(-c) for c in found[quantity]])
    return results


# ---- NumPy ----

#: Pairs (design, angle) evaluated at once, so that the intermediate arrays stay in the cache.
PIECE = 23040

# An array of 16 MB, freed at once: from then on glibc serves smaller ones from the heap and keeps what they
# leave, where otherwise each array above 128 KB costs page faults (measured: up to 4 times the run time).
np.empty(2**21)


def bind_numpy(case, x, tables):
    """A good user's NumPy: each value once, where it depends on least, in pieces of a few designs."""
    arrays, size = outputs(case, x.shape[1], tables.shape[1]), max(1, PIECE // tables.shape[1])
    greatest = functools.partial(np.fmax.reduce, axis=-1)

    def call():
        o = constants(by_name(x))
        with np.errstate(invalid="ignore", divide="ignore"):
            for first in range(0, x.shape[1], size):
                part = slice(first, first + size)
                some = {name: column[part] for name, column in o.items()}
                pairs = evaluate(case, some, tables, np.sqrt, greatest)
                for array, pair in zip(arrays, pairs, strict=True):
                    array[part, 0], array[part, 1] = pair

    return call, arrays


def system(x, K):
    """Return the matrices (design, branch, angle, 9, 9) and right sides of eq. (9) of Hayes, Hninn, Irani.

    Unknowns: ``CASES["reactions"]`` in order.
    """
    found = fl.planar.force_equations(branch=np.array([[1], [2]]), theta1=angles(K), **by_name(x[:, :, None]))
    matrix, right = found.A.values.copy(), found.b.values.copy()
    open_loop = np.isnan(right).any(axis=-1)  # LU of NaN raises: keep NaN to the right side
    matrix[open_loop], right[open_loop] = np.eye(9), np.nan
    return matrix, right


def solve(matrix, right):
    """Return the reactions of the paper's stacked 9x9 systems by LU."""
    return tuple(np.moveaxis(np.linalg.solve(matrix, right[..., None])[..., 0], -1, 0))


# ---- heyoka.py, which writes vectors of LLVM as fastlink does: its caches are off ----

#: Tables that are no zeros here: expressions are simplified, and carry no second digits.
READ = [k for k, name in enumerate(TABLES) if not name.endswith("_low")]
#: Configurations of one call: a call costs some microseconds, and what leaves the second-level cache as much again.
BLOCK = 8192


def inputs_of(case):
    return {"positions": INPUTS[:4], "rates": INPUTS[:5]}.get(case, INPUTS)


def heyoka_compiled(case):
    """Return a case's function of inputs and then tables, both modes at once, as wide as the processor's vectors."""
    import heyoka as hy

    hy.llvm_state.set_memcache_limit(0)
    hy.llvm_state.set_diskcache_enabled(False)
    names = [*inputs_of(case), *(TABLES[k] for k in READ)]
    known = dict.fromkeys(INPUTS + TABLES, 0.0) | dict(zip(names, hy.make_vars(*names), strict=True))
    pairs = evaluate(case, constants(known, exact=False), [known[name] for name in TABLES], hy.sqrt)
    # "force_avx512" takes effect where the processor has it, as the width of eight does.
    options = {"compact_mode": False, "force_avx512": True, "batch_size": lanes_of_host()}
    return hy.cfunc([one for pair in pairs for one in pair], [known[name] for name in names], **options)


def bind_heyoka(case, x, tables):
    """As it knows no loops, it takes again for each angle what is fixed for a design."""
    n, K = x.shape[1], tables.shape[1]
    function, rows = heyoka_compiled(case), x[[INPUTS.index(name) for name in inputs_of(case)]]
    given = np.vstack([np.repeat(rows, K, axis=1), np.tile(tables[READ], n)])
    blocks = [aligned_copy(given[:, k : k + BLOCK]) for k in range(0, n * K, BLOCK)]
    results = [aligned((2 * len(CASES[case]), block.shape[1])) for block in blocks]

    def call():
        for block, result in zip(blocks, results, strict=True):
            function(block, quantities=result)

    call()
    return call, tuple(np.hstack(results).reshape(len(CASES[case]), 2, n, K).swapaxes(1, 2))


def heyoka_compile_time(case):
    """Return how long a case takes to compile, expressions and all, in s; to be called once in a process."""
    import heyoka  # noqa: F401

    return shortest(lambda: heyoka_compiled(case))[1]


# ---- JAX on the CPU, in double precision ----


def jax_kernel(case):
    """Return the jitted function of (x, tables); branches stacked inside take 2 to 5 times as long."""
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    jax.config.update("jax_platforms", "cpu")

    def greatest(curve):
        found = jnp.max(jnp.where(curve == curve, curve, -jnp.inf), axis=1)
        return jnp.where(found > -jnp.inf, found, jnp.nan)

    return jax.jit(lambda x, tables: evaluate(case, constants(by_name(x)), tables, jnp.sqrt, greatest))


def jax_measure(case, n, K):
    """Return ns per configuration, on one processor (Linux); to be called before JAX starts its threads."""
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    import jax

    kernel = jax_kernel(case)  # first: it asks for double precision
    x, tables = jax.device_put(designs(n)), jax.device_put(angle_tables(K))
    jax.block_until_ready(kernel(x, tables))
    return 1e9 * shortest(lambda: jax.block_until_ready(kernel(x, tables)), 0.3, 5)[1] / (2 * n * K)


def jax_time(case, wide, n=512, K=360):
    """Return `jax_measure` of a fresh process, with vectors of 512 bits or XLA's usual ones: fixed when JAX starts."""
    flags = f"{os.environ.get('XLA_FLAGS', '')} {'--xla_cpu_prefer_vector_width=512' if wide else ''}".strip()
    return child(f"jax_measure({case!r}, {n}, {K})", "peers", XLA_FLAGS=flags)

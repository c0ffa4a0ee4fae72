"""psi of the Minkowskian 4R with its orientation: the engine against C, against NumPy and against eq. (3) of the paper.

A fact is (what, value, unit, aim).
"""

from functools import partial

import numpy as np

from benchmarks import c_kernel
from benchmarks.engine import bind_results
from benchmarks.inputs import aligned_copy, empty, race
from benchmarks.numpy_baseline import PIECE
from fastlink.facts.evaluate import read_facts
from fastlink.facts.tables import angle_tables
from fastlink.mechanisms import catalogue
from fastlink.plan.programs import make_program

MINKOWSKI = catalogue("minkowski_4r")
LENGTHS = ("a", "b", "g", "h")
PSI = ("psi", "CB_orientation")
TYPES = ("linkage_type", "input_type", "output_type", "grashof", "assembly_count_future")


def designs(n, seed=0):
    """Return random lengths (4, n), of all types."""
    return aligned_copy(np.exp(np.random.default_rng(seed).uniform(-1.5, 1.5, (4, n))))


# ---- in NumPy ----

DESIGN = (
    *("inner_limit", "inner_limit_low", "outer_limit", "outer_limit_low", "ground_share", "ground_share_low"),
    *("CB_inner", "CB_outer", "product_two", "a_two", "b_share"),
)
TABLES = ("side", "twos", "r", "S_r", "S_r_low", "p_r", "p_r_low", "per_p", "per_p_low")


def constants(x):
    """Return what depends on the design alone, as columns (design, 1)."""
    found = read_facts(MINKOWSKI, DESIGN, dict(zip(LENGTHS, x, strict=True)))
    return {name: found[name][:, None] for name in DESIGN}


def difference(limit, limit_low, r, table, table_low):
    """Return table - limit r, both with what rounding left out."""
    found = table_low - limit_low * r
    high = table - limit * r
    high += found
    return high


def null_piece(o, tables, psi, orientation):
    """Put psi and orientation (design, branch, theta) of a few designs: the closed forms of the mechanism."""
    side, twos, r, S_r, S_r_low, p_r, p_r_low, per_p, per_p_low = tables
    S_r, S_r_low = o["product_two"] * S_r, o["product_two"] * S_r_low
    inside = difference(o["inner_limit"], o["inner_limit_low"], r, S_r, S_r_low)
    outside = difference(o["outer_limit"], o["outer_limit_low"], r, S_r, S_r_low)
    alpha = difference(o["ground_share"], o["ground_share_low"], r, p_r, p_r_low)
    alpha *= -o["a_two"] * o["b_share"]
    beta = difference(o["ground_share"], o["ground_share_low"], 1.0, per_p, per_p_low)
    beta *= -o["a_two"] * o["b_share"]
    within = inside <= 0.0  # minus what the mechanism calls inside
    half = np.where(within, inside - o["CB_inner"] * r, outside - o["CB_outer"] * r)
    inside *= outside
    np.sqrt(inside, out=inside)  # NaN where the loop does not close
    total = np.copysign(inside, half)
    total += half  # of the sum that does not cancel; the other root by Vieta
    roots = total / beta, np.divide(alpha, total, out=alpha)
    shift = twos * np.log(2.0)
    logs = [np.log(np.abs(root)) for root in roots]
    logs[0] += shift
    signs = [(root > 0.0).view(np.int8) - (root < 0.0).view(np.int8) for root in roots]
    first = (half < 0.0) != (side > 0.0)  # where the sum is the root of branch 1
    for branch, (one, other) in enumerate(((0, 1), (1, 0))):
        np.multiply(side, np.where(first, logs[one], logs[other]), out=psi[:, branch])
        orientation[:, branch] = np.where(first, signs[one], signs[other])


def null_form(o, tables, out):
    """Put psi and orientation, each (design, branch, theta), into ``out``; pieces stay in the cache."""
    step = max(1, PIECE // tables.shape[1])
    with np.errstate(all="ignore"):
        for first in range(0, len(out[0]), step):
            part = slice(first, first + step)
            null_piece({name: column[part] for name, column in o.items()}, tables, *(a[part] for a in out))
    return out


def eq3(x, theta):
    """Return psi and orientation, each (design, branch, theta), by eq. (3); CB is past-pointing if |y| > 1."""
    a, b, g, h = x[:, :, None]
    with np.errstate(all="ignore"):
        A = 2 * g * b - 2 * a * b * np.cosh(theta)
        B = 2 * a * b * np.sinh(theta)
        C = h * h - g * g - b * b - a * a + 2 * a * g * np.cosh(theta)
        root = np.sqrt(B * B + C * C - A * A)
        y = np.stack([-B + root, -B - root], axis=1) / (A + C)[:, None]
        ahead = np.abs(y) < 1
        return 2 * np.arctanh(np.where(ahead, y, 1 / y)), np.where(ahead, 1.0, np.where(np.isnan(y), y, -1.0))


# ---- time ----


def bind(names, x, theta=()):
    """Return one call of the bare kernel and the arrays that it fills."""
    program = make_program(MINKOWSKI, names, given=LENGTHS, angles=len(theta) or 1)
    bound = bind_results(program, LENGTHS, x, theta)
    return bound, bound.arrays


def bind_c(x, theta):
    """Return one call of the C kernel and the arrays that it fills: the limit, the same operations."""
    n, K = x.shape[1], len(theta)
    arrays = empty((n, 2, K)), np.empty((n, 2, K), dtype=np.int8)
    tables = aligned_copy(angle_tables(MINKOWSKI, TABLES, np.asarray(theta)))
    return c_kernel.call_of("minkowski_psi", (n, K), [x, tables, *arrays]), arrays


def bind_c_types(x):
    """Return one call of the C kernel of linkage_type, and the codes that it fills."""
    codes = np.empty(x.shape[1], dtype=np.int8)
    return c_kernel.call_of("minkowski_types", (x.shape[1],), [x, codes]), codes


def times(n=114, K=400, rounds=12):
    """The kernel against NumPy and C, both orientations; a classification without any theta."""
    x, theta, many = designs(n), np.linspace(-4.0, 4.0, K), designs(64 * n)
    tables = angle_tables(MINKOWSKI, TABLES, theta)
    kernel, _ = bind(PSI, x, theta)
    out = empty((n, 2, K)), np.empty((n, 2, K), dtype=np.int8)
    calls = {
        "ours": kernel,
        "NumPy": partial(null_form, constants(x), tables, out),
        "eq3": partial(eq3, x, theta),
    }
    classes = {"ours": bind(("linkage_type",), many)[0], "all": bind(TYPES, many)[0]}
    if c_kernel.available():
        calls["C"], classes["C"] = bind_c(x, theta)[0], bind_c_types(many)[0]
    best, of_types = race(calls, rounds), race(classes, rounds)
    what = "psi and CB_orientation of the Minkowskian 4R"
    facts = [
        (what, best["ours"] * 1e9 / (2 * n * K), "ns", ""),
        (f"{what}, NumPy / ours", best["NumPy"] / best["ours"], "times", ">= 8"),
        (f"{what}, eq. (3) in NumPy / ours", best["eq3"] / best["ours"], "times", ""),
        ("types and count of assemblies, by design", 1e9 * of_types["all"] / (64 * n), "ns", "< 100"),
    ]
    if "C" in best:
        facts.append((f"{what}, time / C", best["ours"] / best["C"], "", "<= 1.1"))
        facts.append(("linkage_type, time / C", of_types["ours"] / of_types["C"], "", "<= 1.1"))
    return facts


def measure(quick=False, log=lambda text: None):
    """Return all facts; quick: small sizes."""
    from benchmarks.minkowski_errors import errors

    log("minkowski")
    facts = times(8, 64, rounds=1) if quick else times()
    found = max(own for _, own, _ in errors(3 if quick else 100))
    return [*facts, ("max error of psi, Minkowskian 4R, all families", found, "roundings", "<= 4")]

"""psi of the Minkowskian 4R with its orientation: time and error of the null form and of eq. (3) of the paper.

``python -m benchmarks.minkowski`` prints the table of errors of docs/minkowski.md. A fact is (what, value, unit, aim).
"""

from functools import partial

import mpmath
import numpy as np

from benchmarks.inputs import aligned_copy, empty, race
from benchmarks.numpy_baseline import PIECE
from benchmarks.report import fact_table
from fastlink.exact import DIGITS, STEP
from fastlink.kernels import LANES
from fastlink.mechanisms import catalogue
from fastlink.plan import make_plan
from fastlink.reading import evaluate, read_facts
from fastlink.run import aligned
from fastlink.tables import angle_tables

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


# ---- error ----


def exact(a, b, g, h, theta, branch):
    """Return psi, the loop's root with as many digits as mpmath works with; NaN where it does not assemble."""
    p = mpmath.exp(theta)
    alpha, beta = g - a * p, g - a / p
    middle = alpha * beta + b * b - h * h
    square = middle**2 - 4 * b * b * alpha * beta
    if square < 0:
        return mpmath.nan
    root = mpmath.sqrt(square) * (1 if branch == 1 else -1)
    q = 2 * b * alpha / (-middle - root) if middle * root > 0 else (-middle + root) / (2 * b * beta)
    return mpmath.log(abs(q))


def condition(one, branch, value):
    """Return |psi| + sum |x dpsi/dx| over lengths and theta: what one rounding each may do."""
    found = abs(value)
    for k, number in enumerate(one):
        found += abs(exact(*one[:k], number * (1 + STEP), *one[k + 1 :], branch) - value) / STEP
    return found


def families(n, seed=0):
    """Return, by name, lengths (4, n) and an input each, none of them exactly on what it is near."""
    rng = np.random.default_rng(seed)
    sides = rng.choice([-1.0, 1.0], n)
    near = sides * np.exp(rng.uniform(np.log(1e-12), np.log(1e-3), n))
    x = designs(n, seed)
    a, b, g, h = x

    def at(cosh):
        return sides * np.arccosh(np.maximum(cosh, 1.0)) * (1 + np.abs(near))

    close = x.copy()
    close[3] = np.abs(g + b - a) * (1 + near)  # T1 or T2 near 0
    equal, long, light = x.copy(), x.copy(), x.copy()
    equal[1] = h * (1 + near)
    long[2] = (a + b + h) * (1 + np.abs(near) * 1e3)  # has a theta_min
    light[3] = h * np.abs(near)  # AB is short, its null coordinates are not
    long_min = np.arccosh((a * a + long[2] ** 2 - (b + h) ** 2) / (2 * a * long[2]))
    return {
        "any": (x, rng.uniform(-4, 4, n)),
        "near ±ln(g/a)": (x, sides * np.abs(np.log(g / a)) * (1 + near)),
        "near theta_max": (x, at((a * a + g * g - (b - h) ** 2) / (2 * a * g))),
        "near theta_min": (long, sides * long_min * (1 - np.abs(near))),
        "AB near lightlike": (light, rng.uniform(-4, 4, n)),
        "near T1 T2 = 0, theta = 0": (close, near),
        "b near h": (equal, rng.uniform(-4, 4, n)),
        "theta 10 ... 300": (x, sides * rng.uniform(10, 300, n)),
        "theta 400 ... 700": (x, sides * rng.uniform(400, 700, n)),
        "lengths 1e-150": (1e-150 * x, rng.uniform(-4, 4, n)),
        "lengths 1e150": (1e150 * x, rng.uniform(-4, 4, n)),
    }


def worst(psi, x, theta):
    """Return the largest error of psi (n, 2) in roundings times the condition; infinite if one is missing."""
    found = 0.0
    with mpmath.workdps(DIGITS):
        for i, t in enumerate(theta):
            one = [mpmath.mpf(float(number)) for number in (*x[:, i], t)]
            for branch in (1, 2):
                value = exact(*one, branch)
                if mpmath.isnan(value):
                    continue
                ours = psi[i, branch - 1]
                if not np.isfinite(ours):
                    return np.inf
                unit = condition(one, branch, value) * mpmath.mpf(2) ** -53
                found = max(found, float(abs(mpmath.mpf(float(ours)) - value) / unit))
    return found


def one_each(form, x, theta):
    """Return psi (n, 2) of one input per design by a form of many."""
    return np.array([form(x[:, i : i + 1], theta[i : i + 1])[0][0, :, 0] for i in range(len(theta))])


def ours(x, theta):
    """Return psi (n, 2) of one input per design by fastlink."""
    inputs = {name: row[:, None] for name, row in zip(LENGTHS, x, strict=True)}
    return evaluate("minkowski_4r", ["psi"], branch=np.array([1, 2]), theta=theta[:, None], **inputs)["psi"]


def errors(n=100):
    """Yield each family, the error of fastlink there and that of eq. (3)."""
    for name, (x, theta) in families(n).items():
        yield name, worst(ours(x, theta), x, theta), worst(one_each(eq3, x, theta), x, theta)


def error_table(n=100):
    """Return the table of docs/minkowski.md."""
    lines = ["| inputs | fastlink | eq. (3) in doubles |", "|---|---|---|"]
    for name, own, by_eq3 in errors(n):
        lines.append(f"| {name} | {own:.1f} | {f'{by_eq3:.2g}' if np.isfinite(by_eq3) else 'no value'} |")
    return "\n".join(lines)


# ---- time ----


def bind(names, x, theta=()):
    """Return one call of the bare kernel and the arrays that it fills."""
    n = x.shape[1]
    plan = make_plan(MINKOWSKI, names, given=LENGTHS, angles=len(theta) or 1)
    rows = x[[LENGTHS.index(name) for name in plan.inputs]]
    rows = aligned_copy(np.pad(rows, ((0, 0), (0, -n % LANES)), mode="edge"))
    tables = aligned_copy(plan.angle_tables(np.asarray(theta)))
    lengths = {"branch": len(plan.branches)}
    shapes = [tuple(lengths.get(axis, len(theta)) for axis in output.axes) for output in plan.outputs]
    arrays = [aligned((n, *shape), output.dtype) for shape, output in zip(shapes, plan.outputs, strict=True)]
    scratch = [empty((size,)) for size in plan.scratch]
    call = partial(plan.kernel, rows, tables, n, len(theta), *scratch, *arrays)
    call()
    return call, arrays


def times(n=114, K=400, rounds=12):
    """The kernel against NumPy, both orientations asked; a classification without any theta."""
    x, theta = designs(n), np.linspace(-4.0, 4.0, K)
    tables = angle_tables(MINKOWSKI, TABLES, theta)
    kernel, _ = bind(PSI, x, theta)
    out = empty((n, 2, K)), np.empty((n, 2, K), dtype=np.int8)
    calls = {
        "ours": kernel,
        "NumPy": partial(null_form, constants(x), tables, out),
        "eq3": partial(eq3, x, theta),
    }
    best = race(calls, rounds)
    per = 1e9 / (2 * n * K)
    types, _ = bind(TYPES, designs(64 * n))
    seconds = race({"types": types}, rounds)["types"]
    return [
        ("psi and CB_orientation of the Minkowskian 4R", best["ours"] * per, "ns", ""),
        ("psi and CB_orientation, NumPy / ours", best["NumPy"] / best["ours"], "times", ">= 8"),
        ("psi and CB_orientation, eq. (3) in NumPy / ours", best["eq3"] / best["ours"], "times", ""),
        ("types and count of assemblies, by design", 1e9 * seconds / (64 * n), "ns", "< 100"),
    ]


def measure(quick=False, log=lambda text: None):
    """Return all facts; quick: small sizes."""
    log("minkowski")
    facts = times(8, 64, rounds=1) if quick else times()
    found = max(own for _, own, _ in errors(3 if quick else 100))
    return [*facts, ("max error of psi, Minkowskian 4R, all families", found, "roundings", "<= 4")]


if __name__ == "__main__":
    print(fact_table(times()), error_table(), sep="\n\n")

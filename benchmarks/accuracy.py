"""The errors of docs/accuracy.md, of fastlink's forms and methods and of others that it does not offer.

``python -m benchmarks.accuracy`` prints the table of textbook formulas beside fastlink's. Both get the same doubles. An
error is in roundings: relative to the value of these very doubles by 50-digit arithmetic, over 2^-53. The textbook's:
Heron's area, the law of cosines, Freudenstein's equation, circles that intersect, loops of velocity and acceleration
divided by the sine of a difference of angles; the 9x9 system of what these give, by LU.

``python -m benchmarks.accuracy STUDY.toml [PICTURE]`` prints error against run time and draws the picture; the page has
that of ``docs/images/accuracy.toml``. The others: kernels with relaxed arithmetic, the facts read in single precision,
and extremes by scipy's brentq, which starts from the best of the samples.
"""

import sys
from dataclasses import replace

import numpy as np

from benchmarks.cases import CASES, INPUTS, markdown, near_change_point, near_toggle, round_bars
from fastlink.app.accuracy import USUAL, Method, accuracy_table, curves_by_numpy, draw, measure, methods_for
from fastlink.app.study import read_study
from fastlink.codegen.kernel import MachineCode, llvm_text
from fastlink.codegen.machine import compile_object
from fastlink.facts.evaluate import evaluate_step, read_facts, steps_of
from fastlink.facts.names import derivative_name
from fastlink.facts.tables import angle_tables
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision.reference import HighPrecision

# ---- textbook formulas ----

PLANAR = catalogue("planar_4r")
#: What is compared, by what it is made of; a vector is measured by its longest error over its length.
QUANTITIES = {
    "area of ABD": ("sigma",),
    "transmission angle": ("transmission_angle",),
    "theta4": ("theta4",),
    "omega4": ("omega4",),
    "alpha4": ("alpha4",),
    "reactions": CASES["reactions"][:8],
}
NAMES = [name for names in QUANTITIES.values() for name in names]
CLOSE = {
    "random": lambda rng, n: (
        rng.uniform((0.3, 1.1, 0.7, 0.9), (0.5, 1.3, 0.9, 1.1), (n, 4)).T,
        rng.uniform(-3, 3, n),
    ),
    "gap 1e-8": lambda rng, n: near_change_point(rng, n, 1e-8),
    "gap 1e-15": lambda rng, n: near_change_point(rng, n, 1e-15),
    "toggle 1e-5": lambda rng, n: near_toggle(rng, n, 1e-5),
    "toggle 1e-8": lambda rng, n: near_toggle(rng, n, 1e-8),
}


def naive(x):
    """Return position, rates and reactions of branch 2 by textbook formulas."""
    a, b, c, d, w, t = (x[name] for name in ("a1", "a2", "a3", "a4", "omega1", "theta1"))
    A_x, A_y = a * np.cos(t), a * np.sin(t)
    AD = np.sqrt(a**2 + d**2 - 2 * a * d * np.cos(t))
    half = (AD + b + c) / 2
    found = {"sigma": np.sqrt(half * (half - AD) * (half - b) * (half - c)) / (a * d)}
    found["transmission_angle"] = np.arccos((b**2 + c**2 - AD**2) / (2 * b * c))
    # circles about A and D
    along = (AD**2 + b**2 - c**2) / (2 * AD)
    across = np.sqrt(b**2 - along**2)
    e_x, e_y = (d - A_x) / AD, -A_y / AD
    found |= {"A_x": A_x, "A_y": A_y, "AB_x": along * e_x - across * e_y, "AB_y": along * e_y + across * e_x}
    found |= {"DB_x": A_x + found["AB_x"] - d, "DB_y": A_y + found["AB_y"]}
    # Freudenstein
    k1, k2, k3 = d / a, d / c, (a**2 - b**2 + c**2 + d**2) / (2 * a * c)
    p, q, r = np.cos(t) - k1 - k2 * np.cos(t) + k3, -2 * np.sin(t), k1 - (k2 + 1) * np.cos(t) + k3
    found["theta4"] = 2 * np.arctan((-q - np.sqrt(q**2 - 4 * p * r)) / (2 * p))
    t2, t4 = np.arctan2(found["AB_y"], found["AB_x"]), found["theta4"]
    w2 = found["omega2"] = a * w * np.sin(t - t4) / (b * np.sin(t4 - t2))
    w4 = found["omega4"] = a * w * np.sin(t - t2) / (c * np.sin(t4 - t2))
    turn = a * w**2 * np.cos(t - t2) + b * w2**2 - c * w4**2 * np.cos(t4 - t2)
    found["alpha4"] = turn / (c * np.sin(t4 - t2))
    turn = c * w4**2 - a * w**2 * np.cos(t - t4) - b * w2**2 * np.cos(t2 - t4)
    found["alpha2"] = turn / (b * np.sin(t2 - t4))
    known = x | {"branch": 2.0, "cos_theta1": np.cos(t), "sin_theta1": np.sin(t)}
    return found | read_facts(PLANAR, CASES["reactions"], known | found, ("dense",))


def stable(x):
    """Return the same by fastlink's facts."""
    names = (*PLANAR.tables, *PLANAR.table_low_parts)
    tables = dict(zip(names, angle_tables(PLANAR, names, x["theta1"]), strict=True))
    return read_facts(PLANAR, NAMES, x | tables | {"branch": 2.0})


def errors(family, n, seed=1):
    """Return for each quantity the errors (configuration) of both, in roundings; infinite where a number is missing."""
    lengths, theta1 = CLOSE[family](np.random.default_rng(seed), n)
    x = dict(zip(INPUTS, round_bars(lengths), strict=True)) | {"theta1": theta1}
    facts = HighPrecision(PLANAR, NAMES, (*x, "branch"))
    exact = [facts.at({name: values[i] for name, values in x.items()} | {"branch": 2}) for i in range(n)]
    closes = [i for i in range(n) if exact[i]["sigma"] == exact[i]["sigma"]]
    with np.errstate(all="ignore"):
        ways = naive(x), stable(x)
    return {
        quantity: [[error(way, exact[i], names, i) for i in closes] for way in ways]
        for quantity, names in QUANTITIES.items()
    }


def error(way, exact, names, i):
    if not all(np.isfinite(way[name][i]) for name in names):
        return np.inf
    greatest = max(abs(exact[name]) for name in names)
    return float(max(abs(float(way[name][i]) - exact[name]) for name in names) / greatest) / UNIT_ROUNDING


def table(n=200):
    """Return the table: the median and the greatest error, of the textbook and of fastlink."""
    found = {family: errors(family, n) for family in CLOSE}
    rows = []
    for quantity in QUANTITIES:
        ways = (found[family][quantity] for family in CLOSE)
        cells = (" : ".join(f"{np.median(way):.2g} ({np.max(way):.2g})" for way in both) for both in ways)
        rows.append([quantity, *cells])
    return markdown(["", *CLOSE], *rows)


# ---- error against run time ----

#: Freedoms of arithmetic in LLVM's words: sums are regrouped, products fused with them.
RELAXED = ("reassoc", "contract", "arcp", "nsz")
SAMPLED = {"extrema": "sampled", "angles": USUAL}


def relaxed_job(resolved):
    """Return the kernels of a request, compiled with relaxed arithmetic, with what they run on."""
    job = resolved.job()
    sources = [task.source for task in job.tasks]
    codes = [MachineCode(source, compile_object(llvm_text(source, fast_math=RELAXED))) for source in sources]
    return replace(job, tasks=[replace(task, code=code) for task, code in zip(job.tasks, codes, strict=True)])


def by_numpy_single(resolved, designs):
    """Return curves in single precision."""
    catalogue, quantity = resolved.catalogue, resolved.plan.outputs[0].request.quantity
    tables = (catalogue.position.name, *catalogue.tables, *catalogue.table_low_parts)
    values = {name: column[:, None, None] for name, column in resolved.space.at(np.arange(designs)).items()}
    values |= zip(tables, angle_tables(catalogue, tables, resolved.positions), strict=True)
    # The unit of scaled lengths is found by the digits of doubles; a power of two, it changes no digit.
    values |= {"branch": np.array(resolved.branches)[:, None], "unit": 1.0}
    values = {name: np.float32(value) for name, value in values.items()}
    with np.errstate(all="ignore"):
        for step in steps_of(catalogue, [quantity], values, resolved.plan.variants):
            evaluate_step(step, values)
            values |= {name: np.float32(values[name]) for name in step.names}
    return np.broadcast_to(values[quantity], (designs, len(resolved.branches), resolved.positions.size))


def by_brentq(resolved, designs):
    """Return extremes by scipy's brentq on the derivative, between the neighbours of the best sample."""
    from scipy.optimize import brentq

    catalogue, request = resolved.catalogue, resolved.plan.outputs[0].request
    quantity, sign = request.quantity, request.reduction.sign
    slope = derivative_name(quantity, catalogue.position.name)
    curves, inputs = curves_by_numpy(resolved, designs), resolved.space.at(np.arange(designs))
    step = resolved.positions[1] - resolved.positions[0]
    result = np.full(curves.shape[:2], np.nan)
    for design, k in np.argwhere(np.isfinite(curves).any(axis=-1)).tolist():
        given = {name: float(column[design]) for name, column in inputs.items()}
        given["branch"] = float(resolved.branches[k])

        def value(name, t, given=given):
            with np.errstate(all="ignore"):
                at = {**given, catalogue.position.name: np.float64(t)}
                return float(read_facts(catalogue, [name], at, resolved.plan.variants)[name])

        middle = resolved.positions[int(np.nanargmax(sign * curves[design, k]))]
        low, high = middle - step, middle + step
        if value(slope, low) * value(slope, high) < 0.0:
            place = brentq(lambda t, value=value: value(slope, t), low, high, xtol=1e-15)
            result[design, k] = value(quantity, place)
    return result


def all_methods(subject):
    """Return fastlink's methods for a quantity, and those that it does not offer."""
    methods, output = methods_for(subject, with_numpy=True), subject.resolve().plan.outputs[0]
    if output.axes and output.request.reduction is None:
        methods.append(Method("eliminated, relaxed", job=relaxed_job))
        methods.append(Method("NumPy, single precision", baseline=by_numpy_single))
    elif output.axes and output.refined:
        methods.append(Method("refined, relaxed", job=relaxed_job))
        methods.append(Method("scipy, brentq", SAMPLED, baseline=by_brentq))
    return methods


def main(study=None, picture=None):
    if study is None:
        print(table())
        return
    measured = measure(
        read_study(study), all_methods, designs=64, announce=lambda line: print(line, file=sys.stderr)
    )
    print(accuracy_table(measured))
    if picture:
        draw(measured).savefig(picture)


if __name__ == "__main__":
    main(*sys.argv[1:])

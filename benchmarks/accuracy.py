"""Error against run time, by fastlink's methods and by others that it does not offer.

``python -m benchmarks.accuracy STUDY.toml [PICTURE]`` prints the table and draws the picture; docs/accuracy.md has
those of ``docs/images/accuracy.toml``. The others: kernels with relaxed arithmetic, the facts read in single precision,
and extremes by scipy's minimize_scalar and brentq, which start from the best of the samples.
"""

import argparse
import sys
from dataclasses import replace

import numpy as np

from fastlink.app.accuracy import USUAL, Method, accuracy_table, curves_by_numpy, draw, measure, methods_for
from fastlink.app.study import read_study
from fastlink.codegen.kernel import MachineCode, llvm_text
from fastlink.codegen.machine import compile_object
from fastlink.facts.evaluate import read_facts
from fastlink.facts.names import derivative_name
from fastlink.facts.tables import angle_tables

#: Freedoms of arithmetic in LLVM's words: sums are regrouped, products fused with them.
RELAXED = ("reassoc", "contract", "arcp", "nsz")
SAMPLED = {"extrema": "sampled", "angles": USUAL}


def relaxed_job(resolved):
    """Return the kernels of a request, compiled with relaxed arithmetic, with what they run on."""
    job = resolved.job()
    sources = [task.source for task in job.tasks]
    codes = [MachineCode(source, compile_object(llvm_text(source, fast_math=RELAXED))) for source in sources]
    tasks = [replace(task, code=code) for task, code in zip(job.tasks, codes, strict=True)]
    return replace(job, tasks=tasks)


def by_numpy_single(resolved, designs):
    """Return curves in single precision (but for arctangents)."""
    catalogue, quantity = resolved.catalogue, resolved.plan.outputs[0].request.quantity
    tables = (catalogue.position.name, *catalogue.tables, *catalogue.table_low_parts)
    values = {name: column[:, None, None] for name, column in resolved.space.at(np.arange(designs)).items()}
    values |= zip(tables, angle_tables(catalogue, tables, resolved.positions), strict=True)
    values["branch"] = np.array(resolved.branches)[:, None]
    values = {name: value.astype(np.float32) for name, value in values.items()}
    with np.errstate(all="ignore"):
        curves = read_facts(catalogue, [quantity], values, resolved.plan.variants)[quantity]
    return np.broadcast_to(curves, (designs, len(resolved.branches), resolved.positions.size))


def by_minimize(resolved, designs):
    """Return extremes by scipy's minimize_scalar."""
    from scipy.optimize import minimize_scalar

    def extreme(value, quantity, sign, low, high):
        options = {"bounds": (low, high), "method": "bounded", "options": {"xatol": 1e-12}}
        return -sign * minimize_scalar(lambda t: -sign * value(quantity, t), **options).fun

    return _extremes(resolved, designs, extreme)


def by_brentq(resolved, designs):
    """Return extremes by scipy's brentq on the derivative."""
    from scipy.optimize import brentq

    def extreme(value, quantity, sign, low, high):
        slope = derivative_name(quantity, resolved.catalogue.position.name)
        if not value(slope, low) * value(slope, high) < 0.0:
            return np.nan
        return value(quantity, brentq(lambda t: value(slope, t), low, high, xtol=1e-15))

    return _extremes(resolved, designs, extreme)


def _extremes(resolved, designs, extreme):
    """Return what a search finds between the neighbours of the best sample, for each design and branch."""
    catalogue, request = resolved.catalogue, resolved.plan.outputs[0].request
    quantity, sign = request.quantity, request.reduction.sign
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
        result[design, k] = extreme(value, quantity, sign, middle - step, middle + step)
    return result


def all_methods(subject):
    """Return fastlink's methods for a quantity, and those that it does not offer."""
    methods, output = methods_for(subject, with_numpy=True), subject.resolve().plan.outputs[0]
    if not output.axes:
        return methods
    if output.request.reduction is None:
        relaxed = Method("eliminated, relaxed", job=relaxed_job)
        return [*methods, relaxed, Method("NumPy, single precision", baseline=by_numpy_single)]
    methods.append(Method(f"{USUAL} angles, relaxed", SAMPLED, job=relaxed_job))
    methods.append(Method("scipy, minimize_scalar", SAMPLED, baseline=by_minimize))
    if output.refined:
        methods.append(Method("refined, relaxed", job=relaxed_job))
        methods.append(Method("scipy, brentq", SAMPLED, baseline=by_brentq))
    return methods


def main():
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy", description=__doc__)
    parser.add_argument("study")
    parser.add_argument("picture", nargs="?")
    parser.add_argument("--designs", type=int, default=64)
    arguments = parser.parse_args()
    study = read_study(arguments.study)
    measured = measure(
        study, all_methods, designs=arguments.designs, announce=lambda line: print(line, file=sys.stderr)
    )
    print(accuracy_table(measured))
    if arguments.picture:
        draw(measured).savefig(arguments.picture)


if __name__ == "__main__":
    main()

"""The largest error of a case against the facts with 50 digits, in the unit of `fastlink.precision.reference`."""

import numpy as np

from benchmarks import numpy_baseline
from benchmarks.engine import angles
from benchmarks.inputs import CASES, INPUTS, angle_tables, designs
from fastlink.mechanisms import catalogue
from fastlink.precision.reference import HighPrecision, error_in_roundings


def in_units(values, inputs):
    """Return the largest error of the named values of one configuration, in that unit."""
    facts = HighPrecision(catalogue("planar_4r"), values, inputs)
    exact = facts.at(inputs)
    sums = facts.condition(exact, (*INPUTS, "theta1"))
    return max(error_in_roundings(value, exact[name], sums[name]) for name, value in values.items())


def configurations(case, arrays, x, K, count):
    """Yield (design, branch, angle, values by quantity) of so many designs, one of each."""
    rng = np.random.default_rng(0)
    for i in rng.permutation(x.shape[1])[:count]:
        branch = rng.integers(2)
        if case != "extremes":
            closed = np.flatnonzero(np.isfinite(arrays[-1][i, branch]))
            if closed.size == 0:
                continue
            k = rng.choice(closed)
            values = {name: a[i, branch, k] for name, a in zip(CASES[case], arrays, strict=True)}
            yield i, branch, k, values
            continue
        if np.isnan(arrays[0][i, branch]):
            continue
        one = x[:, i : i + 1]
        curves = {}
        for source in ("rates", "reactions"):
            found = numpy_baseline.evaluate(source, one, angle_tables(K))
            curves |= dict(zip(CASES[source], found, strict=True))
        for name, a in zip(CASES[case], arrays, strict=True):
            quantity, _, kind = name.rpartition("_")
            best = np.nanargmax if kind == "max" else np.nanargmin
            yield i, branch, best(curves[quantity][0, branch]), {quantity: a[i, branch]}


def worst(case, evaluate, n=64, K=360, count=40):
    """Return the largest error of ``evaluate(x, K)``, the arrays of a case, over random configurations."""
    x, theta = designs(n, seed=1), angles(K)
    arrays = [np.array(array) for array in evaluate(x, K)]
    found = 0.0
    for i, branch, k, values in configurations(case, arrays, x, K, count):
        inputs = dict(zip(INPUTS, x[:, i], strict=True)) | {"theta1": theta[k], "branch": branch + 1}
        found = max(found, in_units(values, inputs))
    return found

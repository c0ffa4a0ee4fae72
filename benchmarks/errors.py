"""The largest error of a case against the facts with 50 digits.

The unit is what one rounding does: 2^-53 (|f| + sum over the inputs x of |x df/dx|), the last digit of f and
of all that f was made of.
"""

import mpmath
import numpy as np

from benchmarks import numpy_baseline
from benchmarks.engine import angles
from benchmarks.inputs import CASES, INPUTS, angle_tables, designs
from fastlink.mechanisms import catalogue
from fastlink.reading import read_facts

DIGITS = 50
STEP = 20  # digits of the relative step of the derivatives


def in_units(values, inputs):
    """Return the largest error of the named values of one configuration, in the unit above."""
    names, mechanism = list(values), catalogue("planar_4r")
    with mpmath.workdps(DIGITS):
        exact = {name: mpmath.mpf(float(value)) for name, value in inputs.items()}

        def facts(**moved):
            found = read_facts(mechanism, names, exact | moved)
            return [found[name] for name in names]

        base = facts()
        condition = [abs(f) for f in base]
        step = mpmath.mpf(10) ** -STEP
        for name in (*INPUTS, "theta1"):
            moved = facts(**{name: exact[name] * (1 + step)})
            pairs = zip(moved, base, strict=True)
            condition = [c + abs(m - f) / step for c, (m, f) in zip(condition, pairs, strict=True)]
        errors = [
            abs(mpmath.mpf(float(values[name])) - f) / (c * mpmath.mpf(2) ** -53)
            for name, f, c in zip(names, base, condition, strict=True)
        ]
        return max(map(float, errors))


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

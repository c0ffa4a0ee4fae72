"""The facts of a plan in NumPy: what a user writes who takes each value where it is cheapest, and clears up.

What the input position alone determines is an array (theta,), what does not depend on the branch (design, 1, theta).
Pieces of a few designs are evaluated, and what is not needed again is given back at once, so that the intermediate
arrays stay in the cache. Of curves, what the design alone determines is computed beforehand, outside the time.
"""

import numpy as np

from benchmarks.numpy_baseline import PIECE
from fastlink.engine.run import aligned
from fastlink.facts.evaluate import evaluate_step


def last_uses(steps, kept):
    """Return for each step the values that neither a later one nor a result needs."""
    dead, kept = [], set(kept)
    for step in reversed(steps):
        names = {*step.depends_on, step.name} - kept
        dead.append(names)
        kept |= names
    return dead[::-1]


def bind(bound):
    """Return a call of a bound kernel (`engine.Bound`) in NumPy, and the arrays that it fills."""
    program, (rows, tables, n, K, *_) = bound.program, bound.arguments
    arrays, results = (
        [aligned(a.shape, a.dtype) for a in bound.arrays],
        [o.request.quantity for o in program.outputs],
    )
    shared = dict(zip(program.tables, tables, strict=True))
    shared["branch"] = np.array(program.branches, dtype=float)[:, None]
    columns = dict(zip(program.inputs, rows[:, :n, None, None] if K else rows[:, :n], strict=True))
    steps = list(program.steps)
    if K:
        for step in [step for step in steps if program.axes[step.name] == {"design"}]:
            with np.errstate(all="ignore"):
                evaluate_step(step, columns)
            steps.remove(step)
    dead, size = last_uses(steps, results), max(1, PIECE // max(1, K))

    def call():
        with np.errstate(all="ignore"):
            for first in range(0, n, size):
                part = slice(first, first + size)
                known = shared | {name: column[part] for name, column in columns.items()}
                for step, names in zip(steps, dead, strict=True):
                    evaluate_step(step, known)
                    for name in names:
                        del known[name]
                for array, name in zip(arrays, results, strict=True):
                    array[part] = known[name]

    return call, arrays

"""The closed forms compiled by heyoka.py, which writes vectors of LLVM as fastlink does: its caches are off.

One function gives both assembly modes, of the design's inputs and of the tables of the angle; as it knows no loops, it
takes again for each angle what is fixed for a design. Vectors are as wide as the processor's.
"""

import importlib.util
import time

import numpy as np

from benchmarks.closed_forms import FORMS, plain_constants
from benchmarks.inputs import CASES, INPUTS, TABLES, aligned_copy, empty

#: Tables that are no zeros here: expressions are simplified, and carry no second digits.
READ = [k for k, name in enumerate(TABLES) if not name.endswith("_low")]
#: Configurations of one call: a call costs some microseconds, and what leaves the second-level cache as much again.
BLOCK = 8192


def available():
    return importlib.util.find_spec("heyoka") is not None


def inputs_of(case):
    return INPUTS if case == "reactions" else INPUTS[:5]


def compiled(case):
    """Return a case's function of columns, inputs and then tables; compiled anew at each call."""
    import heyoka as hy

    hy.llvm_state.set_memcache_limit(0)
    hy.llvm_state.set_diskcache_enabled(False)
    names = inputs_of(case)
    design = dict(zip(names, hy.make_vars(*names), strict=True))
    table = dict(zip(TABLES, [0.0] * len(TABLES), strict=True))
    variables = hy.make_vars(*(TABLES[k] for k in READ))
    table |= dict(zip((TABLES[k] for k in READ), variables, strict=True))
    pairs = FORMS[case](plain_constants(design), tuple(table.values()), hy.sqrt)
    given = [*design.values(), *variables]
    if case == "positions":
        given.remove(design["omega1"])
    results = [one for pair in pairs for one in pair]
    # "force_avx512" takes effect where the processor has it, as the width of eight does.
    return hy.cfunc(results, given, compact_mode=False, force_avx512=True, batch_size=lanes())


def lanes():
    from fastlink.codegen.machine import lanes_of_host

    return lanes_of_host()


def columns(case, x, tables):
    """Return what the function is called with: a column for each design and angle."""
    names = [name for name in inputs_of(case) if case != "positions" or name != "omega1"]
    rows = x[[INPUTS.index(name) for name in names]]
    n, K = x.shape[1], tables.shape[1]
    return aligned_copy(np.vstack([np.repeat(rows, K, axis=1), np.tile(tables[READ], n)]))


def bind(case, x, tables):
    """Return ``call, arrays``: ``call()`` evaluates into the arrays, one for each name of ``CASES[case]``."""
    n, K = x.shape[1], tables.shape[1]
    function, given = compiled(case), columns(case, x, tables)
    pieces = [slice(k, k + BLOCK) for k in range(0, n * K, BLOCK)]
    blocks = [aligned_copy(given[:, piece]) for piece in pieces]
    outputs = [empty((2 * len(CASES[case]), block.shape[1])) for block in blocks]
    arrays = tuple(np.empty((n, 2, K)) for _ in CASES[case])

    def call():
        for block, output in zip(blocks, outputs, strict=True):
            function(block, outputs=output)

    call()
    whole = np.hstack(outputs).reshape(len(CASES[case]), 2, n, K)
    for array, values in zip(arrays, whole, strict=True):
        array[...] = values.swapaxes(0, 1)
    return call, arrays


def evaluate(case, x, tables):
    """One array for each name of ``CASES[case]``."""
    return bind(case, x, tables)[1]


def compile_time(case):
    """Return how long a case takes to compile, expressions and all, in s; to be called once in a process."""
    import heyoka  # noqa: F401

    start = time.perf_counter()
    compiled(case)
    return time.perf_counter() - start

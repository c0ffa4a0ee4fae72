"""The C limit kernels: compiled by gcc at the first use, in a temporary directory, called by ctypes."""

import ctypes
import functools
import os
import platform
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.inputs import CASES, empty, outputs

#: Strict IEEE arithmetic; without the last two gcc vectorises neither the square root nor a choice.
FLAGS = ("-O3", "-march=native", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math")
ADDRESS = ctypes.POINTER(ctypes.c_double)


def compiler():
    """Return the C compiler's path, or None."""
    return shutil.which(os.environ.get("CC", "gcc"))


def available():
    return compiler() is not None


@functools.cache
def library():
    """Return the compiled and loaded C files of this folder."""
    return build(sorted(Path(__file__).parent.glob("*.c")))


def build(sources, *flags):
    """Return C files compiled, with more flags, and loaded."""
    if not available():
        raise RuntimeError("the C limit kernels need gcc: install it, or name another C compiler in CC")
    width = ["-mprefer-vector-width=512"] if platform.machine().lower() in ("x86_64", "amd64") else []
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder, "kernels.so")
        command = [
            compiler(),
            *FLAGS,
            *flags,
            *width,
            "-std=c11",
            "-fPIC",
            "-shared",
            *sources,
            "-o",
            target,
            "-lm",
        ]
        subprocess.run(command, check=True)
        return ctypes.CDLL(str(target))  # stays loaded when the file goes


def call_of(name, lengths, arrays):
    """Return a call of a C function with these arguments, the last array being what it evaluates into.

    What Python does per call is next to nothing, so that the clock sees the kernel alone.
    """
    kernel = getattr(library(), f"c_{name}")
    kernel.restype = None
    if any(not a.flags.c_contiguous or a.dtype not in (np.float64, np.int8) for a in arrays):
        raise ValueError("C kernels take C-contiguous arrays of doubles, and of bytes for codes")
    arguments = [*map(ctypes.c_long, lengths), *(a.ctypes.data_as(ADDRESS) for a in arrays)]

    def call():
        kernel(*arguments)
        return arrays  # they live as long as the call

    return call


def bind(case, x, tables):
    """Return ``call, arrays``: ``call()`` evaluates into the arrays, one for each name of ``CASES[case]``."""
    n, K = x.shape[1], tables.shape[1]
    whole = empty((len(CASES[case]), *outputs(case, n, K)[0].shape))
    return call_of(case, (n, K), [x, tables, whole]), tuple(whole)


def extrema_cells():
    """Return half the number of cells that C searches."""
    return ctypes.c_long.in_dll(library(), "c_extrema_cells").value


def bind_extrema(x):
    """Return ``call, arrays`` for every extreme of omega4: its greatest and its least value."""
    whole = empty((2, x.shape[1], 2))
    return call_of("extrema", (x.shape[1],), [x, whole]), tuple(whole)


def evaluate(case, x, tables):
    """One array for each name of ``CASES[case]``."""
    call, arrays = bind(case, x, tables)
    call()
    return arrays

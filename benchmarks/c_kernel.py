"""The C limit kernels: compiled by gcc when first asked for, in a temporary directory, called by ctypes."""

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
    """Return the compiled and loaded ``kernels.c``."""
    if not available():
        raise RuntimeError("the C limit kernels need gcc: install it, or name another C compiler in CC")
    source = Path(__file__).with_name("kernels.c")
    width = ["-mprefer-vector-width=512"] if platform.machine().lower() in ("x86_64", "amd64") else []
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder, "kernels.so")
        command = [compiler(), *FLAGS, *width, "-std=c11", "-fPIC", "-shared", source, "-o", target, "-lm"]
        subprocess.run(command, check=True)
        return ctypes.CDLL(str(target))  # stays loaded when the file goes


def bind(case, x, tables):
    """Return ``call, arrays``: ``call()`` evaluates into the arrays, one for each name of ``CASES[case]``.

    What Python does per call is next to nothing, so that the clock sees the kernel alone.
    """
    n, K = x.shape[1], tables.shape[1]
    whole = empty((len(CASES[case]), *outputs(case, n, K)[0].shape))
    kernel = getattr(library(), f"c_{case}")
    kernel.restype = None
    held = [x, tables, whole]  # the arrays live as long as the call
    if any(not a.flags.c_contiguous or a.dtype != np.float64 for a in held):
        raise ValueError("x and tables must be C-contiguous arrays of doubles")
    arguments = [ctypes.c_long(n), ctypes.c_long(K), *(a.ctypes.data_as(ADDRESS) for a in held)]

    def call():
        kernel(*arguments)
        return held

    return call, tuple(whole)


def evaluate(case, x, tables):
    """One array for each name of ``CASES[case]``."""
    call, arrays = bind(case, x, tables)
    call()
    return arrays

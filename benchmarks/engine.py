"""Calls of fastlink on the benchmarks' inputs: the bare kernel, and the kernel handed out to threads."""

import time
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from benchmarks.inputs import CASES, INPUTS, aligned_copy, designs
from fastlink.codegen.kernel import BACKENDS, kernel_of
from fastlink.codegen.runtime.cells import LANES
from fastlink.engine.run import BLOCK_DESIGNS, Job, KernelTask, aligned, run
from fastlink.mechanisms import catalogue
from fastlink.plan.programs import Program, make_program

DENSE = ("dense",)


def angles(theta1):
    """Return the input angles: so many equally spaced ones, or those given."""
    return np.arange(theta1) * (2 * np.pi / theta1) if np.ndim(theta1) == 0 else np.asarray(theta1)


def program_of(case, K=360, *, further=(), variants=()):
    """Return the program of ``CASES[case]`` and further names, of designs that give every input."""
    names = (*CASES[case], *further)
    return make_program(catalogue("planar_4r"), names, given=INPUTS, variants=variants, angles=K)


def rows_of(program, x):
    """Return the rows of the design array that the program's kernel reads, padded to whole lanes."""
    rows = x[[INPUTS.index(name) for name in program.inputs]]
    return aligned_copy(np.pad(rows, ((0, 0), (0, -x.shape[1] % LANES)), mode="edge"))


def scratch_of(program, K):
    """Return the arrays that a kernel works in."""
    return [aligned(array.lengths(K), array.dtype) for array in kernel_of(program).source.scratch]


def shapes(program, K):
    lengths = {"branch": len(program.branches), "theta1": K}
    return [tuple(lengths[axis] for axis in output.axes) for output in program.outputs]


@dataclass(frozen=True)
class Bound:
    """A kernel bound to its arguments; calling it evaluates into ``arrays``."""

    program: Program
    arguments: tuple
    arrays: list

    def __call__(self):
        """Evaluate."""
        self.call()

    @cached_property
    def call(self):
        """What evaluates. The table of arguments is filled once, as ctypes has those of the C kernels."""
        kernel = kernel_of(self.program).compiled()
        if not hasattr(kernel, "table"):  # numba's
            return partial(kernel, *self.arguments)
        table = kernel.table(*self.arguments)
        address, call = table.ctypes.data, kernel.call
        return lambda table=table: call(address)


def bind(case, x, theta1, **options):
    """Return the kernel of a case bound to designs and angles; compiles it."""
    theta = angles(theta1)
    return bind_program(program_of(case, theta.size, **options), x, theta)


def bind_program(program, x, theta=()):
    """Return a kernel whose results are alike in shape, bound to designs and angles; compiles it."""
    n, tables = x.shape[1], aligned_copy(program.angle_tables(np.asarray(theta)))
    scratch = scratch_of(program, len(theta))
    shape = shapes(program, len(theta))[0]
    whole = aligned((len(program.outputs), n, *shape), program.outputs[0].dtype)  # as the C kernel has it
    bound = Bound(program, (rows_of(program, x), tables, n, len(theta), *scratch, *whole), list(whole))
    bound()
    return bound


def job_of(program, size, K, pool=BLOCK_DESIGNS):
    """Return a job of ``size`` designs, which repeat those of a pool; no result is kept."""
    rows = np.tile(rows_of(program, designs(pool)), 2)  # a block is a slice, wherever it begins

    def fill(start, stop, x):
        first = start % pool
        x[:, : stop - start] = rows[:, first : first + stop - start]

    outputs = [
        (shape, output.dtype) for shape, output in zip(shapes(program, K), program.outputs, strict=True)
    ]
    kernel = kernel_of(program)
    task = KernelTask(
        kernel.source,
        program.inputs,
        BACKENDS[0],
        kernel.compiled(BACKENDS[0]),
        program.angle_tables(angles(K)),
        tuple(range(len(outputs))),
        fill,
    )
    return Job([task], outputs, size)


def threads(case, seconds=1.2, repeats=3, K=360):
    """Return the run time in s through `fastlink.engine.run` with one thread and with two, and configurations."""
    program = program_of(case, K)
    size = 4096

    def clock(count):
        job = job_of(program, size, K)
        start = time.perf_counter()
        run(job, threads=count)
        return time.perf_counter() - start

    clock(1)
    size = max(size, round(size * seconds / clock(1)))
    best = {1: np.inf, 2: np.inf}
    for _ in range(repeats):
        best = {count: min(known, clock(count)) for count, known in best.items()}
    return best[1], best[2], size * 2 * K


def bind_results(program, names, x, theta=()):
    """Return a kernel with an array for each result, bound to designs and angles; compiles it.

    ``names`` are those of the rows of ``x``.
    """
    n, K = x.shape[1], len(theta)
    rows = x[[names.index(name) for name in program.inputs]]
    rows = aligned_copy(np.pad(rows, ((0, 0), (0, -n % LANES)), mode="edge"))
    lengths = {"branch": len(program.branches)}
    arrays = [
        aligned((n, *(lengths.get(axis, K) for axis in output.axes)), output.dtype)
        for output in program.outputs
    ]
    scratch = scratch_of(program, K)
    tables = aligned_copy(program.angle_tables(np.asarray(theta)))
    bound = Bound(program, (rows, tables, n, K, *scratch, *arrays), arrays)
    bound()
    return bound

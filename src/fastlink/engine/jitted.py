"""Call kernels by their address from numba's code, without another compilation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numba
import numpy as np
from llvmlite import ir
from numba.extending import intrinsic

from fastlink.codegen.kernel import MachineCode
from fastlink.codegen.numba_backend import OPTIONS
from fastlink.engine.run import COUNT, VECTOR, Runner
from fastlink.errors import InputError, Setting
from fastlink.facts.powers import limits

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.engine.function import Rows
    from fastlink.facts.fact import Input


#: Designs in one call of a kernel.
JITTED_BLOCK = 64
#: Doubles and bytes of a cache line.
LINE, LINE_BYTES = 8, 64
DTYPES = ["float64", "int64", "int8"]
ANY, POSITIVE, NON_NEGATIVE, CHOICE = range(4)
RULES = {"any": ANY, "positive": POSITIVE, "non-negative": NON_NEGATIVE}


def _call_kernel(typing: Any, address: Any, table: Any) -> Any:
    """Call the machine code at an address with the address of its table."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        pointer = ir.IntType(8).as_pointer()
        kernel = ir.FunctionType(ir.VoidType(), [pointer]).as_pointer()
        builder.call(builder.inttoptr(values[0], kernel), [builder.inttoptr(values[1], pointer)])
        return context.get_dummy_value()

    return numba.types.void(numba.types.int64, numba.types.int64), generate


def _put(typing: Any, address: Any, value: Any) -> Any:
    """Write a double to an address: it compiles half a second faster than a view."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        builder.store(values[1], builder.inttoptr(values[0], ir.DoubleType().as_pointer()))
        return context.get_dummy_value()

    return numba.types.void(numba.types.int64, numba.types.float64), generate


call_kernel, put = intrinsic(_call_kernel), intrinsic(_put)


def _is_valid(value: float, rule: int, codes: NDArray[Any]) -> bool:
    if rule == CHOICE:
        known = False
        for k in range(codes.size):
            known |= value == codes[k]
        return known
    finite = -np.inf < value < np.inf
    return finite and (rule == ANY or value > 0.0 or (rule == NON_NEGATIVE and value == 0.0))


def _evaluate(x: Any, y: int, values: int, layout: Any, rules: Any, codes: Any) -> None:
    """Evaluate designs x (inputs, n) into (outputs, n, values) at the address y; beyond the range x becomes NaN."""
    # Each call has buffers of its own for all arrays of the kernels, so that threads share nothing. Entries
    # are set one by one: an assignment to a slice compiles a second longer, and each view of an array half a
    # second.
    sizes, addresses, tables, starts, moving, varying, fixed, numbers, results, picked, ranges, flag = layout
    far = np.zeros(x.shape[1], np.bool_)
    for i in range(x.shape[1]):
        for k in range(x.shape[0]):
            size = abs(x[k, i])
            far[i] |= 0.0 < size < np.inf and not ranges[k, 0] < size < ranges[k, 1]
        for k in range(x.shape[0] if far[i] else 0):
            x[k, i] = np.nan
    doubles, words = np.empty(sizes[0] + LINE), np.empty(sizes[1], np.int64)
    octets = np.empty(sizes[2], np.int8)
    at_words = np.int64(words.ctypes.data)
    first = (-np.int64(doubles.ctypes.data) % LINE_BYTES) // 8
    bases = np.int64(doubles.ctypes.data) + 8 * first, at_words, np.int64(octets.ctypes.data)
    for k in range(tables.size):
        words[k] = tables[k]
    for k in range(moving.shape[0]):
        words[moving[k, 0]] = bases[moving[k, 1]] + moving[k, 2]
    for k in range(fixed.size):
        for i in range(JITTED_BLOCK):
            doubles[first + fixed[k] + i] = numbers[k]
    for start in range(0, x.shape[1], JITTED_BLOCK):
        count = min(JITTED_BLOCK, x.shape[1] - start)
        for k in range(varying.shape[0]):
            # lanes beyond the last design repeat it
            for i in range(-(-count // VECTOR) * VECTOR):
                doubles[first + varying[k, 0] + i] = x[varying[k, 1], start + min(i, count - 1)]
        for k in range(addresses.size):
            words[starts[k] + COUNT] = count
            call_kernel(addresses[k], at_words + 8 * starts[k])
        for k in range(results.shape[0]):
            offset, each, is_code = results[k, 0], results[k, 1], results[k, 2]
            for i in range(count):
                row = y + 8 * values * (k * x.shape[1] + start + i)
                for j in range(values):
                    at = offset + i * each + picked[k, j]
                    put(row + 8 * j, octets[at] if is_code else doubles[first + at])
    for i in range(x.shape[1]):
        for row in range(x.shape[0]):
            if not is_valid(x[row, i], rules[row], codes[row]):
                for k in range(results.shape[0]):
                    for j in range(0 if results[k, 2] else values):
                        put(y + 8 * (values * (k * x.shape[1] + i) + j), np.nan)
        for k in range(0, flag.size if far[i] else 0, 2):
            for j in range(values):
                put(y + 8 * (values * (flag[k] * x.shape[1] + i) + j), flag[k + 1])


is_valid = numba.njit(**OPTIONS)(_is_valid)
evaluate = numba.njit(**OPTIONS)(_evaluate)


class _Layout:
    """Offsets of the arrays of all kernels in three buffers: doubles, words, octets."""

    # The tables of addresses come first among the words.

    def __init__(self, runner: Runner, rows: Rows) -> None:
        self.addresses: list[int] = []
        self.tables: list[NDArray[np.int64]] = []
        self.starts: list[int] = []
        self.moving: list[tuple[int, int, int]] = []
        self.varying: list[tuple[int, int]] = []
        self.fixed: list[tuple[int, float]] = []
        self.offsets: dict[int, int] = {}
        results = [[runner.results[k] for k in kernel.task.results] for kernel in runner.kernels]
        arguments = [kernel.arguments(of) for kernel, of in zip(runner.kernels, results, strict=True)]
        for kernel, arrays in zip(runner.kernels, arguments, strict=True):
            code = kernel.task.code
            assert isinstance(code, MachineCode)
            self.addresses.append(code.address)
            self.tables.append(code.table(*arrays))
        self.sizes = [0, sum(table.size for table in self.tables), 0]
        entry = 0
        for kernel, arrays in zip(runner.kernels, arguments, strict=True):
            self.starts.append(entry)
            for k, (argument, array) in enumerate(zip(kernel.task.source.arguments, arrays, strict=True)):
                lengths = argument[1]
                if lengths and k != 1:  # the angles stay where they are
                    self._add(entry, array)
                entry += 1 + lengths.count(None)
            self._add_rows(kernel.designs, rows)
        self.offsets |= {k: self.offsets[id(result)] for k, result in enumerate(runner.results)}

    def _add(self, entry: int, array: NDArray[Any]) -> None:
        """Note where an array stands, and which entry of the tables holds its address."""
        buffer, size = DTYPES.index(array.dtype.name), array.itemsize
        offset = self.offsets[id(array)] = self.sizes[buffer]
        self.moving.append((entry, buffer, offset * size))
        self.sizes[buffer] += -(-array.nbytes // LINE_BYTES) * LINE_BYTES // size

    def _add_rows(self, designs: NDArray[Any], rows: Rows) -> None:
        """Note which rows of a kernel's designs are inputs, and what the others hold."""
        inputs = {row.ctypes.data: index for row, index in rows}
        for k, row in enumerate(designs):
            offset = self.offsets[id(designs)] + k * designs.shape[1]
            if row.ctypes.data in inputs:
                self.varying.append((offset, inputs[row.ctypes.data]))
            else:
                self.fixed.append((offset, float(row[0])))


def jitted_of(
    runner: Runner,
    rows: Rows,
    declared: Sequence[Input],
    shapes: Sequence[tuple[int, ...]],
    trailing: tuple[int, ...],
    flag: tuple[int, int] | None,
) -> Any:
    """Return a function of arrays (inputs,) or (inputs, n) for callers in numba."""
    if not all(isinstance(kernel.task.code, MachineCode) for kernel in runner.kernels):
        what = "jitted calls kernels by address, which those of backend 'numba' do not have"
        raise InputError(what, ("function",), ("write ", Setting("backend", "llvm")))
    layout = _Layout(runner, rows)
    codes = [result.dtype == np.int8 for result in runner.results]
    picked = [np.broadcast_to(np.arange(math.prod(s)).reshape(s), trailing).ravel() for s in shapes]
    results = [(layout.offsets[k], math.prod(shape), codes[k]) for k, shape in enumerate(shapes)]
    data = (
        tuple(layout.sizes),
        np.array(layout.addresses),
        np.concatenate(layout.tables),
        np.array(layout.starts),
        np.array(layout.moving).reshape(-1, 3),
        np.array(layout.varying).reshape(-1, 2),
        np.array([offset for offset, _ in layout.fixed], dtype=np.int64),
        np.array([number for _, number in layout.fixed], dtype=np.float64),
        np.array(results, dtype=np.int64),
        np.array(picked),
        np.array([limits(known.units, known.rule) for known in declared]),
        np.array(flag or (), dtype=np.int64),
    )
    rules = np.array([CHOICE if known.choices else RULES[known.rule] for known in declared])
    longest = max((len(known.choices) for known in declared), default=0)
    allowed = np.full((len(declared), max(longest, 1)), np.nan)
    for row, known in zip(allowed, declared, strict=True):
        row[: len(known.choices)] = list(known.choices)
    inputs, outputs, values = len(rules), len(shapes), math.prod(trailing)

    def call(x: Any) -> Any:
        count = 1 if x.ndim == 1 else x.shape[1]
        if x.shape[0] != inputs:
            raise ValueError("x has not as many rows as the function has inputs")
        given = np.empty((inputs, count))
        for row in range(inputs):
            for i in range(count):
                given[row, i] = x[row] if x.ndim == 1 else x[row, i]
        y = np.empty((outputs, *trailing) if x.ndim == 1 else (outputs, count, *trailing))
        evaluate(given, np.int64(y.ctypes.data), values, data, rules, allowed)
        return y

    jitted = numba.njit(**OPTIONS)(call)
    jitted.kept = runner  # their arrays of angles, whose addresses stand in the tables
    return jitted

"""A kernel with one thread's buffers and the table of their addresses, which is filled once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.codegen.kernel import MachineCode
from fastlink.engine.executor import Part, aligned

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["BLOCK", "COUNT", "Bound", "bind"]

#: Most designs in one call.
BLOCK = 1024
#: Where the number of designs stands in the table of addresses: after two arrays with a length each.
COUNT = 4


@dataclass(frozen=True, eq=False)
class Bound:
    """A kernel with the arrays that it is called with.

    Attributes
    ----------
    kernel : callable
        The kernel.
    table : array of int64, or None
        The addresses and lengths of the arguments, where the kernel takes them so.
    arguments : tuple
        Designs, angles, two numbers, scratch.
    rows : list of (array, int)
        A row of the designs, and which input of the function it holds.
    results : list of (int, array)
        Which output of the function it gives, and where.
    run : callable
        ``run(count)`` evaluates the first designs.
    """

    kernel: Callable[..., None]
    table: NDArray[np.int64] | None
    arguments: tuple[Any, ...]
    rows: list[tuple[NDArray[Any], int]]
    results: list[tuple[int, NDArray[Any]]]
    run: Callable[[int], None]


def bind(
    part: Part,
    names: Sequence[str],
    places: Mapping[str, int],
    constants: Mapping[str, float],
    outputs: Sequence[tuple[tuple[int, ...], str]],
    block: int,
) -> Bound:
    """Return a kernel with buffers of its own.

    Parameters
    ----------
    part : Part
        The kernel and what it runs on.
    names : sequence of str
        The inputs that it reads, in the order of the rows of its designs.
    places : mapping of str to int
        The inputs of the function and their order.
    constants : mapping of str to float
        The values of all others.
    outputs : sequence of (shape, dtype)
        What each design has of each output of the function.
    block : int
        Most designs in one call.
    """
    designs = aligned((len(names), -(-block // 64) * 64))
    angles = aligned(part.angles.shape)
    angles[...] = part.angles
    for name, row in zip(names, designs, strict=True):
        row[...] = constants.get(name, np.nan)
    n_angles = angles.shape[1]
    scratch = [aligned(array.lengths(n_angles), array.dtype) for array in part.scratch]
    results = [aligned((block, *outputs[k][0]), outputs[k][1]) for k in part.results]
    rows = [(row, places[name]) for name, row in zip(names, designs, strict=True) if name in places]
    arguments = designs, angles, block, n_angles, *scratch
    kernel, table = part.kernel, None
    if isinstance(kernel, MachineCode):
        table = kernel.table(*arguments, *results)
        run = _by_table(kernel, table)
    else:
        run = _by_arguments(kernel, arguments, results)
    return Bound(kernel, table, arguments, rows, list(zip(part.results, results, strict=True)), run)


def _by_table(kernel: MachineCode, table: NDArray[np.int64]) -> Callable[[int], None]:
    call, address = kernel.call, table.ctypes.data

    def run(count: int) -> None:
        table[COUNT] = count
        call(address)

    return run


def _by_arguments(
    kernel: Callable[..., None], arguments: tuple[Any, ...], results: Sequence[NDArray[Any]]
) -> Callable[[int], None]:
    designs, angles, _, n_angles, *scratch = arguments

    def run(count: int) -> None:
        kernel(designs, angles, count, n_angles, *scratch, *(result[:count] for result in results))

    return run

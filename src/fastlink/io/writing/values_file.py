"""Write blocks of values where they lie in a laid-out file, and tell what they add to its checksums."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink.io.checksums import of_pieces
from fastlink.io.dataset import Variable
from fastlink.io.ranges import Range
from fastlink.io.writing import partial_file
from fastlink.io.writing.blocks import OfThread, cut
from fastlink.io.writing.resume import first_blocks
from fastlink.io.writing.skeleton import places_of_values

__all__ = ["ValuesFile"]


class ValuesFile:
    """The values in a laid-out file.

    Parameters
    ----------
    fd : int
        The open file.
    offsets : mapping of str to int
        Where the values of each variable begin.
    variables : sequence of Variable
        The variables.

    Attributes
    ----------
    places : dict of int to int
        The bytes of the values of each variable, by where they begin.
    """

    def __init__(self, fd: int, offsets: Mapping[str, int], variables: Sequence[Variable]) -> None:
        self.fd, self._offsets = fd, offsets
        self._variables = {variable.name: variable for variable in variables}
        self._first_block = first_blocks(variables)
        self.places = places_of_values(offsets, variables)

    def pieces(
        self, name: str, start: int, block: NDArray[Any], of_thread: OfThread
    ) -> list[tuple[int, memoryview]]:
        """Return the bytes of a block, each piece with its position from the first value. See `Writer.write`."""
        places = self._places(name, start, block)
        in_order = of_thread.by_value(block) if self._variables[name].leading else block
        return list(cut(in_order.reshape(-1).view(np.uint8).data, places))

    def put(self, name: str, pieces: Sequence[tuple[int, memoryview]]) -> list[tuple[int, int]]:
        """Write pieces, and return what they add to the checksums; thread-safe."""
        for position, data in pieces:
            partial_file.write_all(self.fd, data, self._offsets[name] + position)
        first = self._first_block[name]
        return [(first + k, addend) for k, addend in of_pieces(pieces, self._variables[name].nbytes)]

    def _places(self, name: str, start: int, block: NDArray[Any]) -> list[Range]:
        """Return where the pieces of a block lie among the values of its variable, or refuse one that does not fit."""
        variable = self._variables[name]
        if block.dtype != variable.dtype:
            raise TypeError(f"{name}: block is {block.dtype}, the variable {variable.dtype}")
        if not block.flags.c_contiguous:
            raise ValueError(f"{name}: block is not C-contiguous")
        shape, leading = variable.shape, variable.leading
        swept = leading or len(shape) - (block.ndim - 1)
        own, designs = (shape[:swept], shape[swept:]) if leading else (shape[swept:], shape[:swept])
        if block.ndim == 0 or swept < 0 or block.shape[1:] != own:
            raise ValueError(f"{name}: a block of shape {block.shape} does not hold rows of {shape}")
        count = math.prod(designs)
        if not 0 <= start <= start + len(block) <= count:
            raise ValueError(f"{name}: designs {start} to {start + len(block)} of {count}")
        return variable.placement(count).pieces(start, start + len(block))

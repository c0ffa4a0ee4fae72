"""Write a converted map as HDF5 or netCDF-4, which is HDF5: as a sweep does, or compressed."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from fastlink.io.checksums import OF_REST, of_file, seal
from fastlink.io.converting.compression import Compression, chunks_of
from fastlink.io.converting.source import Source
from fastlink.io.dataset import FORMAT_VERSION
from fastlink.io.output import OutputFile
from fastlink.io.writing import partial_file
from fastlink.io.writing.skeleton import create_checksums, label, lay_labels
from fastlink.io.writing.writer import Writer
from fastlink.space.dataset import FORMAT

__all__ = ["write_compressed", "write_plain"]

#: Bytes of the values of a chunk, the unit of compression.
CHUNK_BYTES = 1 << 20


class _UntilItFails(io.FileIO):
    """A file for HDF5 to write; an error of the disk is kept for `check`, and what is written after it is dropped.

    HDF5 tries again what it could not write when the file is closed and when the process ends, and may then end it by a
    violation of memory.

    Parameters
    ----------
    fd : int
        The open file, which stays open.
    """

    def __init__(self, fd: int) -> None:
        super().__init__(fd, "r+b", closefd=False)
        self._error: OSError | None = None

    def check(self) -> None:
        """Raise the error that there was."""
        if self._error is not None:
            raise self._error

    def write(self, data: Any) -> int:
        """Write every byte, unless an earlier write has failed."""
        position, content = self.tell(), memoryview(data).cast("B")
        self._tried(partial_file.write_all, self.fileno(), content, position)
        self.seek(position + len(content))
        return len(content)

    def truncate(self, size: int | None = None) -> int:
        """Give the file a size, unless an earlier write has failed."""
        nbytes = self.tell() if size is None else size
        self._tried(os.ftruncate, self.fileno(), nbytes)
        return nbytes

    def _tried(self, call: Callable[..., Any], *arguments: Any) -> None:
        if self._error is None:
            try:
                call(*arguments)
            except OSError as error:
                self._error = error


def write_plain(path: Path, source: Source, attrs: Mapping[str, Any], overwrite: bool, show: Any) -> None:
    """Write a file with contiguous variables and their checksums."""
    with Writer(path, source.coords, source.all, attrs, overwrite=overwrite) as writer:
        for variable in source.all:
            for _, first, values in source.blocks(variable):
                writer.write(variable.name, first, values.reshape(-1))
                show(values.nbytes)
        writer.finish(source.remarks())


def write_compressed(
    path: Path,
    source: Source,
    attrs: Mapping[str, Any],
    overwrite: bool,
    show: Any,
    *,
    compression: Compression,
) -> None:
    """Write a file with compressed chunks, and one checksum of all its bytes."""
    with OutputFile(path, overwrite, lambda fresh: lay_labels(fresh, source.coords, attrs)) as out:
        target = _UntilItFails(out.fd)
        with h5py.File(target, "r+") as file:
            filters = compression.of_hdf5()
            for variable in source.all:
                chunks = chunks_of(variable, CHUNK_BYTES)
                how = {"chunks": chunks, "shuffle": True, **filters} if chunks else {}
                dataset = file.create_dataset(variable.name, variable.shape, variable.dtype, **how)
                label(file, dataset, source.coords, variable, source.columns)
                for index, _, values in source.blocks(variable, chunks):
                    dataset[index] = values
                    target.check()
                    show(values.nbytes)
            for name, value in {**source.remarks(), FORMAT: FORMAT_VERSION}.items():
                file.attrs[name] = value
            place = create_checksums(file, [])[OF_REST]
            file["checksums"].create_dataset("values", (0,), "u4")
            file.flush()
            of_values: list[Any] = []
            for variable in source.all:
                if file[variable.name].chunks:
                    file[variable.name].id.chunk_iter(of_values.append)
        target.check()
        compressed = {int(chunk.byte_offset): int(chunk.size) for chunk in of_values}
        position, sealed = seal(out.fd, compressed, place)
        partial_file.write_all(out.fd, memoryview(sealed), position)
        rest = np.array([of_file(out.fd, {}, (place, place + 4))], "u4")
        partial_file.write_all(out.fd, rest.view(np.uint8).data, place)
        out.publish()

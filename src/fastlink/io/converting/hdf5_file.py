"""Write a converted map as HDF5 or netCDF-4, which is HDF5: as a sweep does, or compressed."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fastlink.io.checksums import OF_REST, of_file
from fastlink.io.converting.compression import Compression, chunks_of
from fastlink.io.converting.output import OutputFile
from fastlink.io.converting.source import Source
from fastlink.io.dataset import FORMAT_VERSION
from fastlink.io.writing import partial_file
from fastlink.io.writing.skeleton import create_checksums, label, lay_labels, opened
from fastlink.io.writing.writer import Writer
from fastlink.space.dataset import FORMAT

__all__ = ["write_compressed", "write_plain"]

#: Bytes of the values of a chunk, the unit of compression.
CHUNK_BYTES = 1 << 20


def write_plain(path: Path, source: Source, attrs: Mapping[str, Any], overwrite: bool, show: Any) -> None:
    """Write a file with contiguous variables and their checksums."""
    with Writer(path, source.coords, source.variables, attrs, overwrite=overwrite) as writer:
        for variable in source.variables:
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
        with opened(out.fd, out.part, "r+") as file:
            filters = compression.of_hdf5()
            for variable in source.variables:
                chunks = chunks_of(variable, CHUNK_BYTES)
                how = {"chunks": chunks, "shuffle": True, **filters} if chunks else {}
                dataset = file.create_dataset(variable.name, variable.shape, variable.dtype, **how)
                label(file, dataset, source.coords, variable)
                for index, _, values in source.blocks(variable, chunks):
                    dataset[index] = values
                    show(values.nbytes)
            for name, value in {**source.remarks(), FORMAT: FORMAT_VERSION}.items():
                file.attrs[name] = value
            place = create_checksums(file, [])[OF_REST]
            file["checksums"].create_dataset("values", (0,), "u4")
        rest = np.array([of_file(out.fd, {}, (place, place + 4))], "u4")
        partial_file.write_all(out.fd, rest.view(np.uint8).data, place)
        out.publish()

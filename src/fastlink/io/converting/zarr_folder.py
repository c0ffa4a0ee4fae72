"""Write a converted map as a zarr store, version 2 of the format, which most readers know."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fastlink.io.converting.compression import Compression, chunks_of
from fastlink.io.converting.labels import as_json
from fastlink.io.converting.source import Source
from fastlink.io.dataset import FORMAT_VERSION
from fastlink.io.output import OutputFolder
from fastlink.io.writing.skeleton import auxiliary
from fastlink.space.dataset import FORMAT

__all__ = ["write_zarr"]

#: Bytes of the values of a chunk, which is a file.
CHUNK_BYTES = 1 << 22
ZARR_FORMAT = 2


def write_zarr(
    path: Path,
    source: Source,
    attrs: Mapping[str, Any],
    overwrite: bool,
    show: Any,
    *,
    compression: Compression | None,
) -> None:
    """Write a zarr store, chunk by chunk; without a compression by the library's own."""
    import zarr

    labels = source.coords.assign_attrs(as_json(attrs))
    with OutputFolder(path, overwrite) as out:
        labels.to_zarr(
            out.part,
            mode="a",
            zarr_format=ZARR_FORMAT,
            consolidated=False,
            encoding={name: {"_FillValue": None} for name in labels.coords},
        )
        group = zarr.open_group(str(out.part), mode="r+", zarr_format=ZARR_FORMAT)
        for variable in source.all:
            described: dict[str, Any] = {"_ARRAY_DIMENSIONS": list(variable.dims), **as_json(variable.attrs)}
            along = auxiliary(source.coords, variable, source.columns)
            if along and not variable.is_coordinate:
                described["coordinates"] = along
            chunks = chunks_of(variable, CHUNK_BYTES)
            array = group.create_array(
                variable.name,
                shape=variable.shape,
                dtype=variable.dtype,
                chunks=chunks or "auto",
                compressors="auto" if compression is None else compression.of_zarr(),
                fill_value=None,
                attributes=described,
            )
            for index, _, values in source.blocks(variable, chunks):
                array[index if index else ...] = values
                show(values.nbytes)
        group.attrs.update(as_json({**source.remarks(), FORMAT: FORMAT_VERSION}))
        zarr.consolidate_metadata(str(out.part), zarr_format=ZARR_FORMAT)
        out.publish()

"""Write a converted map as a long table, one row per configuration: CSV or Parquet."""

from __future__ import annotations

import csv
import io
import json
import math
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fastlink.errors import InputError
from fastlink.io.converting.compression import Compression
from fastlink.io.converting.labels import as_json
from fastlink.io.converting.source import BLOCK_BYTES, Index, Source
from fastlink.io.dataset import Variable
from fastlink.io.output import OutputFile
from fastlink.io.ranges import pieces
from fastlink.io.writing import partial_file

__all__ = ["check_table", "write_csv", "write_parquet"]

#: Bytes of a number as text, with the object that holds it, and of one in a column of a table.
TEXT_BYTES, NUMBER_BYTES = 100, 8
#: Key of the attributes of a map in those of a Parquet file.
METADATA = "fastlink"


def check_table(variables: list[Variable]) -> None:
    """Refuse variables that no table has one row per configuration of."""
    widest = max(variables, key=lambda variable: len(variable.dims))
    for variable in variables:
        if other := [dim for dim in variable.dims if dim not in widest.dims]:
            inside = [dim for dim in widest.dims if dim not in variable.dims]
            along = f"{widest.name} along {', '.join(inside)}"
            what = (
                f"{variable.name} is along {', '.join(other)} but {along}, and a table has one kind of rows"
            )
            raise InputError(
                what, where=("quantities",), remedy="choose those of one kind, such as one of the two"
            )


class _Rows:
    """The rows of a long table, block by block.

    Parameters
    ----------
    source : Source
        The part of a map.
    cell_bytes : int
        Bytes of a cell in memory.

    Attributes
    ----------
    coords : dict of str
        The columns of inputs, arrays or what is read block by block: those along the dimensions first, then constants.
    """

    def __init__(self, source: Source, cell_bytes: int) -> None:
        widest = max(source.variables, key=lambda variable: len(variable.dims))
        self.source, self.dims, self.shape = source, widest.dims, widest.shape
        inputs: dict[str, Any] = {str(name): coord for name, coord in source.coords.coords.items()}
        inputs |= {column.name: column for column in source.columns}
        order = [*self.dims, *(name for name in inputs if name not in self.dims)]
        inside = [name for name in order if name in inputs and set(inputs[name].dims) <= set(self.dims)]
        inside.sort(key=lambda name: not inputs[name].dims)
        self.coords = {name: inputs[name] for name in inside}
        self.most = max(1, BLOCK_BYTES // (cell_bytes * (len(self.coords) + len(source.variables))))

    @property
    def names(self) -> list[str]:
        """The names of all columns."""
        return [*self.coords, *(variable.name for variable in self.source.variables)]

    def blocks(self) -> Iterator[tuple[tuple[int, ...], list[NDArray[Any]]]]:
        """Yield the shape of a block, and the values of each column, which spread over that shape."""
        for index, _ in pieces(self.shape, self.most):
            box = {
                dim: slice(part, part + 1) if isinstance(part, int) else part
                for dim, part in zip(self.dims, index, strict=False)
            }
            shape = tuple(
                len(range(size)[box.get(dim, slice(None))])
                for dim, size in zip(self.dims, self.shape, strict=True)
            )
            columns = []
            for one in (*self.coords.values(), *self.source.variables):
                if isinstance(one, Variable):
                    whole: Index = tuple(box.get(dim, slice(None)) for dim in one.dims)
                    values = self.source.read(one, whole)
                else:
                    values = one.variable.isel({dim: box[dim] for dim in one.dims if dim in box}).values
                columns.append(self._spread(values, one.dims))
            yield shape, columns

    def _spread(self, values: NDArray[Any], dims: tuple[Any, ...]) -> NDArray[Any]:
        """Return values with all dimensions of the rows, of length 1 where they do not vary."""
        here = [dim for dim in self.dims if dim in dims]
        ordered = np.transpose(values, [dims.index(dim) for dim in here])
        places = tuple(slice(None) if dim in dims else None for dim in self.dims)
        return np.asarray(ordered[places])


def write_csv(path: Path, source: Source, attrs: Mapping[str, Any], overwrite: bool, show: Any) -> None:
    """Write a CSV file; its numbers are read back with the same bits."""
    rows = _Rows(source, TEXT_BYTES)
    with OutputFile(path, overwrite, _empty) as out:
        with os.fdopen(os.dup(out.fd), "w", encoding="utf-8", newline="") as file:
            file.write(",".join(map(_quoted, rows.names)) + "\n")
            for shape, columns in rows.blocks():
                texts = [np.broadcast_to(_texts(values), shape).ravel().tolist() for values in columns]
                file.write("\n".join(map(",".join, zip(*texts, strict=True))) + "\n")
                show(_nbytes(shape, source))
        out.publish()


def write_parquet(
    path: Path,
    source: Source,
    attrs: Mapping[str, Any],
    overwrite: bool,
    show: Any,
    *,
    compression: Compression | None,
) -> None:
    """Write a Parquet file, a row group for each block; without a compression by the library's own."""
    import pyarrow as pa
    from pyarrow import parquet

    rows = _Rows(source, NUMBER_BYTES)
    fields = rows.coords | {variable.name: variable for variable in source.variables}
    schema = pa.schema(
        [
            pa.field(name, _arrow(pa, one.dtype), metadata=_metadata(one.attrs))
            for name, one in fields.items()
        ],
        metadata={METADATA: json.dumps(as_json(attrs))},
    )
    options: dict[str, Any] = {}
    if compression is not None:
        options = {"compression": compression.name, "compression_level": compression.level}
    with OutputFile(path, overwrite, _empty) as out:
        with (
            os.fdopen(os.dup(out.fd), "wb") as file,
            parquet.ParquetWriter(file, schema, **options) as writer,
        ):
            for shape, columns in rows.blocks():
                arrays = [
                    pa.array(np.broadcast_to(values, shape).ravel(), field.type)
                    for values, field in zip(columns, schema, strict=True)
                ]
                writer.write_batch(pa.record_batch(arrays, schema=schema), row_group_size=math.prod(shape))
                show(_nbytes(shape, source))
        out.publish()


def _nbytes(shape: tuple[int, ...], source: Source) -> int:
    """Return the share of a block of rows in all values."""
    widest = max(math.prod(variable.shape) for variable in source.variables)
    return source.nbytes * math.prod(shape) // widest


def _empty(path: Path) -> None:
    os.close(partial_file.create(path))


def _texts(values: NDArray[Any]) -> NDArray[Any]:
    """Return numbers as the shortest texts that are read back as the same numbers."""
    flat = values.ravel()
    if values.dtype.kind == "f" and values.dtype.itemsize < 8:
        texts = [str(number) for number in flat]
    elif values.dtype.kind in "iuf":
        texts = list(map(repr, flat.tolist()))
    else:
        texts = [_quoted(str(text)) for text in flat.tolist()]
    result = np.empty(flat.size, dtype=object)
    result[:] = texts
    return result.reshape(values.shape)


def _quoted(text: str) -> str:
    """Return a text as a cell."""
    line = io.StringIO()
    csv.writer(line, lineterminator="").writerow([text])
    return line.getvalue()


def _arrow(pa: Any, dtype: np.dtype[Any]) -> Any:
    return pa.from_numpy_dtype(dtype) if dtype.kind in "iuf" else pa.string()


def _metadata(attrs: Mapping[str, Any]) -> dict[str, str]:
    return {
        name: value if isinstance(value, str) else json.dumps(value) for name, value in as_json(attrs).items()
    }

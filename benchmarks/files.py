"""What checksums and layouts of map files cost: ``python -m benchmarks.files``."""

import argparse
import contextlib
import os
import time
from pathlib import Path
from unittest import mock

import h5py
import numpy as np
import xarray as xr

import fastlink as fl
from benchmarks import output
from benchmarks.output import RAW_BLOCK, clock, lengths, write_raw
from benchmarks.report import fact_table
from fastlink.io import writer
from fastlink.io.layout import Variable
from fastlink.io.writer import Writer

ANGLES = 360
LAYOUTS = ("curves", "maps")
#: Places at which a picture or a curve is read; the shortest time counts.
PLACES = (0.1, 0.37, 0.5, 0.73, 0.9)


def rows_of(block):
    """Return the rows of a block of plain writing, and its values."""
    count = RAW_BLOCK // (8 * ANGLES)
    return count, np.random.default_rng(0).random((count, ANGLES))[: min(count, block)]


def write_map(path, rows):
    """Write so many rows by the writer of maps, by one thread; its checksums and its journal included."""
    step, block = rows_of(rows)
    variable = Variable("x", ("a2", "theta1"), (rows, ANGLES), np.dtype("f8"), {})
    coords = xr.Dataset(coords={"a2": np.arange(float(rows)), "theta1": np.arange(float(ANGLES))})
    with Writer(path, coords, [variable], {}, run=("benchmark", rows)) as writer:
        for start in range(0, rows, step):
            part = block[: rows - start]
            writer.write("x", start, part)
            writer.record(start, start + len(part))
        writer.finish({})


def write_unchecked(path, rows):
    """Write them without checksums."""
    with (
        mock.patch.object(writer, "of_pieces", return_value=[]),
        mock.patch.object(Writer, "_write_checksums"),
    ):
        write_map(path, rows)


def write_h5py(path, rows):
    """Write them by h5py, and wait for the disk."""
    step, block = rows_of(rows)
    with h5py.File(path, "w") as file:
        data = file.create_dataset("x", (rows, ANGLES), "f8")
        for start in range(0, rows, step):
            data[start : start + step] = block[: rows - start]
    fd = os.open(path, os.O_RDWR)
    os.fsync(fd)
    os.close(fd)


def checksums(folder, rows=350_000, repeats=5):
    """The writer against plain writes of the same bytes, and against itself without checksums, in turns."""
    path, size = Path(folder, "written"), 8 * ANGLES * rows
    ways = {
        "plain write + fsync": lambda: write_raw(path, size),
        "h5py + fsync": lambda: clock(write_h5py, path, rows),
        "the writer": lambda: clock(write_map, path, rows),
        "the writer without checksums": lambda: clock(write_unchecked, path, rows),
    }
    best, busy, names = dict.fromkeys(ways, np.inf), dict.fromkeys(ways, np.inf), list(ways)
    for k in range(repeats):
        for name in names[k % len(names) :] + names[: k % len(names)]:  # each comes after each other one
            os.sync()  # what the one before has left to the disk to do, its removal too
            before = time.process_time()
            best[name] = min(best[name], ways[name]())
            busy[name] = min(busy[name], time.process_time() - before)
            path.unlink()
    found = [(f"{name}, {size / 1e9:.3g} GB", size / 1e9 / t, "GB/s", "") for name, t in best.items()]
    found += [(f"{name}, processor time", 1e9 * t / size, "s per GB", "") for name, t in busy.items()]
    times = [best[name] for name in ways]
    found.append(("speed of the writer / plain write + fsync", times[0] / times[2], "", ">= 1.2"))
    return [*found, ("speed of the writer / without checksums", times[3] / times[2], "", "")]


def forget(path):
    """Take a file out of the page cache."""
    fd = os.open(path, os.O_RDONLY)
    try:
        os.fsync(fd)
        if hasattr(os, "posix_fadvise"):
            os.posix_fadvise(fd, 0, 0, os.POSIX_FADV_DONTNEED)
    finally:
        os.close(fd)


def read(path, axis, place):
    """Read a picture at one input position (``theta1``), or the curve of one design (``a2``, ``a3``)."""
    with fl.open(path) as maps:
        angles = maps.theta4.isel(branch=0)
        where = {dim: int(place * angles.sizes[dim]) for dim in axis}
        start = time.perf_counter()
        angles.isel(where).values.sum()
        return time.perf_counter() - start


def layouts(folder, side=500, repeats=3):
    """Sweeps of one quantity by both layouts, in turns, and reading them from disk and from memory."""
    paths = {layout: Path(folder, f"{layout}.h5") for layout in LAYOUTS}
    what = {"picture": ("theta1",), "curve": ("a2", "a3")}
    times = {}

    def note(seconds, *key):
        times[key] = min(times.get(key, np.inf), seconds)

    for _ in range(repeats):
        for layout, path in paths.items():
            with contextlib.suppress(FileNotFoundError):
                path.unlink()
            note(clock(sweep, side, path, layout), layout, "writing")
    for layout, path in paths.items():
        for name, axis in what.items():
            for place in PLACES:
                forget(path)
                note(read(path, axis, place), layout, f"{name}, from disk")
                note(read(path, axis, place), layout, f"{name}, from memory")
    size = paths["curves"].stat().st_size / 1e9
    for path in paths.values():
        path.unlink()
    return [(f"{layout}, {size:.3g} GB: {name}", 1e3 * t, "ms", "") for (layout, name), t in times.items()]


def sweep(side, to, layout):
    options = {"layout": layout, "theta1": ANGLES, "threads": 2, "verify": 0}
    fl.sweep("planar_4r", lengths(side), ["theta4"], to=to, **options).close()


#: What is measured, by `output.measure`.
PARTS = (checksums, layouts)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m benchmarks.files", description=__doc__)
    parser.add_argument("--folder", help="where to write 3 GB; default: a temporary one here")
    parser.add_argument("--repeats", type=int, default=3, help="rounds, of which the shortest time counts")
    arguments = parser.parse_args()
    print(fact_table(output.measure(arguments.folder, print, PARTS, repeats=arguments.repeats)))

"""What writing costs: curves against the raw disk, a map with its file against without, memory."""

import os
import shutil
import tempfile
import time
from pathlib import Path

import numpy as np

import fastlink as fl
from benchmarks.facts import python

CURVES = ("B_x", "B_y", "omega4", "alpha4")
EXTREMES = ("omega4_max", "omega4_min", "alpha4_max", "alpha4_min", "T41_max", "F32_x_max")
RAW_BLOCK = 4 << 20
NEED = 6_000_000_000  # two files of 2 GB, and room to spare
PEAK = (
    "from benchmarks import output; output.{call}; "
    "import resource; status = '/proc/self/status'; import os; "
    "print(next(l.split()[1] for l in open(status) if l.startswith('VmHWM')) if os.path.exists(status) "
    "else resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
)


def lengths(side, **further):
    """Return a grid around Table 1 of Hayes et al.: a2 and a3, and whatever else."""
    a2, a3 = np.linspace(1.0, 1.4, side), np.linspace(0.6, 1.0, side)
    return fl.grid(**({"a1": 0.4, "a2": a2, "a3": a3, "a4": 1.0, "omega1": 25.0} | further))


def sweep_curves(side, to, threads=2):
    """Write four curves of side^2 designs."""
    options = {"threads": threads, "overwrite": True, "verify": 0}
    fl.sweep("planar_4r", lengths(side), CURVES, to=to, **options).close()


def sweep_map(side, to=None, threads=2, theta1=360):
    """Take six extremes of side^3 designs; what verification takes is reported by every map itself."""
    space = lengths(side, a4=np.linspace(0.8, 1.2, side))
    bars = fl.round_bar(density=7750.0, radius=0.01)
    options = {"theta1": theta1, "threads": threads, "overwrite": True, "verify": 0}
    fl.sweep("planar_4r", space, EXTREMES, links=bars, to=to, **options).close()


def write_raw(path, size):
    """Write so many bytes in plain blocks, and wait for the disk."""
    block = memoryview(np.random.default_rng(0).bytes(RAW_BLOCK))
    start = time.perf_counter()
    fd = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    try:
        for begun in range(0, size, RAW_BLOCK):
            os.write(fd, block[: min(RAW_BLOCK, size - begun)])
        os.fsync(fd)
    finally:
        os.close(fd)
    return time.perf_counter() - start


def clock(call, *arguments):
    start = time.perf_counter()
    call(*arguments)
    return time.perf_counter() - start


def disk(folder, side=295, repeats=3):
    """The sweep of curves against the same bytes raw, in turns; fsync in both."""
    curves, raw = Path(folder, "curves.h5"), Path(folder, "raw")
    sweep_curves(2, curves)  # compiles
    times = {"sweep": np.inf, "raw": np.inf}
    for _ in range(repeats):
        curves.unlink()
        times["sweep"] = min(times["sweep"], clock(sweep_curves, side, curves))
        size = curves.stat().st_size
        times["raw"] = min(times["raw"], write_raw(raw, size))
        raw.unlink()
    curves.unlink()
    return [
        (f"curves to file, {size / 1e9:.2f} GB, 2 threads", times["sweep"], "s", ""),
        ("the same bytes raw", times["raw"], "s", ""),
        ("speed of curves to file / raw", times["raw"] / times["sweep"], "", ">= 0.7"),
    ]


def map_overhead(folder, side, theta1, repeats=5):
    """A sweep with its file against without, in turns: both times in s."""
    path = Path(folder, "map.h5")
    kept, written = np.inf, np.inf
    for _ in range(repeats + 1):  # the first compiles, or loads
        kept = min(kept, clock(sweep_map, side, None, 2, theta1))
        path.unlink(missing_ok=True)
        written = min(written, clock(sweep_map, side, path, 2, theta1))
    path.unlink()
    return kept, written


def maps(folder):
    """What a file costs a sweep that mostly computes, and one that does not."""
    facts = []
    kept, written = map_overhead(folder, 2, 360)
    facts.append(("any file, whatever its size, costs", written - kept, "s", ""))
    for side, theta1, aim in ((59, 3600, "< 10"), (126, 360, "")):
        kept, written = map_overhead(folder, side, theta1, repeats=3)
        name = f"map of {side**3:,} designs, {theta1} angles"
        facts.append((f"{name}, in memory, 2 threads", kept, "s", ""))
        facts.append((f"{name}, to file costs more", 100 * (written / kept - 1), "%", aim))
    return facts


def memory(folder, curves_side=295, map_side=126):
    """Peak memory of whole processes."""
    path = str(Path(folder, "memory.h5"))
    facts = []
    for label, call in (
        (f"peak memory, curves of {curves_side**2:,} designs", f"sweep_curves({curves_side}, {path!r})"),
        (f"peak memory, map of {map_side**3:,} designs to file", f"sweep_map({map_side}, {path!r})"),
    ):
        facts.append((label, python(PEAK.format(call=call)) / 1024, "MiB", "< 600"))
        Path(path).unlink()
    return facts


def measure(folder=None, log=lambda text: None, parts=(disk, maps, memory), **options):
    """Return the facts about output; in a folder of its own, which is removed."""
    with tempfile.TemporaryDirectory(dir=folder or Path.cwd(), prefix="fastlink-benchmark-") as place:
        free = shutil.disk_usage(place).free
        if free < NEED:
            log(f"output skipped: {place} has {free / 1e9:.1f} GB free, {NEED / 1e9:.1f} GB are needed")
            return []
        facts = []
        for part in parts:
            log(part.__name__)
            facts += part(place, **options)
        return facts

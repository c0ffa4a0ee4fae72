"""Time to an answer: with an empty cache, with a known kernel, in a process that knows the request.

Every number is of a fresh process, the shortest of some. Imports are not counted, of which the modules of a mechanism
are one. A row is what the README shows of a request: set-up with an empty cache (s), over what heyoka.py takes to
compile the same, the first sweep of one design in a new process that finds the kernel in the cache (s), the same again
(ms), memory that compiling took (MiB), bytes in the cache for each kernel (KiB); and of both times, in processor
seconds, how many times a fixed piece of Python they would take, for `--check`. The README's command is set up only.
"""

import contextlib
import importlib
import importlib.util
import os
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.cases import CASES, INPUTS, ROOT, child, designs
from benchmarks.peers import FORMS, available

COMMAND = "README's command"
STUDY = ROOT / "data" / "studies" / "crank_rocker_map.toml"
SAMPLED = {"extrema": "sampled"}
#: By request: names and options.
REQUESTS = {
    "positions": (CASES["positions"], {}),
    "rates": (CASES["rates"], {}),
    "reactions": (CASES["reactions"], {}),
    "sampled extremes": (CASES["extremes"], SAMPLED),
    "extremes of omega4": (("omega4_max", "omega4_min"), {}),
    "extremes of omega4, alpha4": (("omega4_max", "omega4_min", "alpha4_max", "alpha4_min"), {}),
    "greatest shaking force": (("shaking_force_max",), {}),
}
LABELS = (COMMAND, *REQUESTS)
COLUMNS = ("request", "cold", "to_heyoka", "known", "again", "memory", "cache")
FIXED = "\n".join(f"x{k} = (a{k} * {k} + b[{k}, i]) / f(c{k}, {k}.5)" for k in range(1500))


# ---- in the fresh process ----


def fixed_work():
    """Do the fixed piece of Python: what depends on this machine and on nothing of fastlink's."""
    import ast

    ast.unparse(ast.parse(FIXED))
    compile(FIXED, "fixed", "exec")


def shortest(call, times):
    """Return the shortest processor and wall time of some calls in s."""
    best = [float("inf")] * 2
    for _ in range(times):
        cpu, wall = time.process_time(), time.perf_counter()
        call()
        best = list(map(min, best, (time.process_time() - cpu, time.perf_counter() - wall)))
    return best


def peak():
    """Return the greatest memory of this process so far in MiB, and reset it, where the system reports it."""
    status, clear = Path("/proc/self/status"), Path("/proc/self/clear_refs")
    if not status.exists():
        return None
    sizes = dict(line.split(":") for line in status.read_text().splitlines())
    with contextlib.suppress(OSError):
        clear.write_text("5")
    return int(sizes["VmHWM"].split()[0]) / 1024


def requested(label):
    """Return what a request hands to `fastlink.sweep`: mechanism, designs, names, options."""
    import fastlink as fl

    if label == COMMAND:
        from fastlink.app.study import read_study

        study = read_study(STUDY)
        return study.mechanism, study.space, study.quantities, study.options
    names, options = REQUESTS[label]
    values = dict(zip(INPUTS, designs(1)[:, 0].tolist(), strict=True))
    return "planar_4r", fl.grid(**values), names, options


def resolved(label):
    """Return a request, resolved."""
    from fastlink.engine.resolve import resolve

    mechanism, space, names, options = requested(label)
    return resolve(mechanism, space, names, **options)


def sweep(label, to=None):
    import fastlink as fl

    mechanism, space, names, options = requested(label)
    return fl.sweep(mechanism, space, names, **options, threads=1, verify=0, to=to, overwrite=True)


def import_all():
    """Import what a request of the planar 4R needs, whatever is imported on first use."""
    import fastlink as fl

    fl.sweep, fl.evaluate  # noqa: B018
    for name in (
        *("h5netcdf", "llvmlite.binding", "xarray", "filelock"),
        *("fastlink.engine.resolve", "fastlink.app.study", "fastlink.mechanisms.planar_4r"),
    ):
        if importlib.util.find_spec(name):
            importlib.import_module(name)
    import xarray as xr

    # xarray imports dask and pint, where they are installed, with the first variable: 0.45 s.
    xr.Dataset(coords={"a2": [1.0]})


def first(label, is_known):
    """Return what the first request of this process takes, and what it takes again."""
    import_all()
    found = {"fixed": shortest(fixed_work, 3)[0]}
    peak()
    before = peak()
    parts, whole = [], label == COMMAND or not is_known
    found["cpu"], found["wall"] = shortest(
        lambda: parts.extend(resolved(label).job().tasks if whole else [sweep(label)]), 1
    )
    found["kernels"] = len(parts)
    after = peak()
    found["memory"] = None if after is None else after - before
    if not whole:
        found["again"] = shortest(lambda: sweep(label), 50)[1]
    return found


# ---- from outside ----


def least(found, name):
    """Return the least number of that name in some records."""
    return min(one[name] for one in found)


def row_of(label, repeats):
    """Return the row of a request, measured so many times."""
    cold, known, theirs = [], [], []
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as folder:
            cold.append(child(f"first({label!r}, False)", "answers", FASTLINK_CACHE_DIR=folder))
            size = sum(file.stat().st_size for file in Path(folder).rglob("*") if file.is_file())
            known.append(child(f"first({label!r}, True)", "answers", FASTLINK_CACHE_DIR=folder))
        if label in FORMS and available("heyoka"):
            theirs.append(child(f"heyoka_compile_time({label!r})", "peers"))
    fixed = least(cold + known, "fixed")
    return {
        "request": label,
        "cold": least(cold, "wall"),
        "to_heyoka": least(cold, "wall") / min(theirs) if theirs else None,
        "known": least(known, "wall"),
        "again": None if label == COMMAND else 1e3 * least(known, "again"),
        "memory": None if cold[0]["memory"] is None else least(cold, "memory"),
        "cache": size / 1024 / cold[0]["kernels"],
        "to_fixed": least(cold, "cpu") / fixed,
        "known_to_fixed": least(known, "cpu") / fixed,
        "compile_heyoka": min(theirs) if theirs else None,
    }


def rows(labels=LABELS, repeats=3, log=lambda text: None):
    """Return the row of each request."""
    found = []
    for label in labels:
        log(f"time to an answer: {label}")
        found.append(row_of(label, repeats))
    return found


# ---- layouts of files ----

#: Places at which a picture or a curve is read; the shortest time counts.
PLACES = (0.1, 0.37, 0.5, 0.73, 0.9)
PARTS = {"picture": ("theta1",), "curve": ("a2", "a3")}


def forget(path):
    """Take a file out of the page cache."""
    fd = os.open(path, os.O_RDONLY)
    os.fsync(fd)
    if hasattr(os, "posix_fadvise"):
        os.posix_fadvise(fd, 0, 0, os.POSIX_FADV_DONTNEED)
    os.close(fd)


def read(path, axis, place):
    """Read a picture at one input position (``theta1``), or the curve of one design (``a2``, ``a3``)."""
    import fastlink as fl

    with fl.open(path) as maps:
        found = maps.theta4.isel(branch=0)
        where = {dim: int(place * found.sizes[dim]) for dim in axis}
        return shortest(lambda: found.isel(where).values.sum(), 1)[1]


def layouts(folder=None, side=500, repeats=3):
    """Sweeps of one quantity by both layouts, in turns, and reading them from disk and from memory (docs/files.md)."""
    import fastlink as fl

    grid = {"a1": 0.4, "a2": np.linspace(1.0, 1.4, side), "a3": np.linspace(0.6, 1.0, side), "a4": 1.0}
    space, facts = fl.grid(**grid, omega1=25.0), []
    with tempfile.TemporaryDirectory(dir=folder or Path.cwd(), prefix="fastlink-benchmark-") as place:
        paths = {layout: Path(place, f"{layout}.h5") for layout in ("curves", "maps")}

        def write(layout):
            options = {"layout": layout, "theta1": 360, "threads": 2, "verify": 0, "overwrite": True}
            fl.sweep("planar_4r", space, ["theta4"], to=paths[layout], **options).close()

        writing = [[shortest(lambda one=one: write(one), 1)[1] for one in paths] for _ in range(repeats)]
        for (layout, path), seconds in zip(paths.items(), map(min, *writing, writing[0]), strict=True):
            size = path.stat().st_size / 1e9
            facts.append((f"{layout}, {size:.3g} GB: writing", 1e3 * seconds, "ms", ""))
            for name, axis in PARTS.items():
                disk, memory = [], []
                for at in PLACES:
                    forget(path)
                    disk.append(read(path, axis, at))
                    memory.append(read(path, axis, at))
                for source, times in (("disk", disk), ("memory", memory)):
                    facts.append(
                        (f"{layout}, {size:.3g} GB: {name}, from {source}", 1e3 * min(times), "ms", "")
                    )
    return facts

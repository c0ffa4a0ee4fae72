"""Time to an answer: with an empty cache, with a known kernel, in a process that knows the request.

Every number is of a fresh process, the shortest of some. Imports are not counted, of which the modules of a mechanism
are one. A row is what the README shows of a request: set-up with an empty cache (s), over what heyoka.py takes to
compile the same, the first sweep of one design in a new process that finds the kernel in the cache (s), the same again
(ms), memory that compiling took (MiB), bytes in the cache for each kernel (KiB); and of both times, in processor
seconds, how many times a fixed piece of Python they would take, for `--check`. The README's command is set up only.
"""

import ast
import contextlib
import itertools
import os
import tempfile
from pathlib import Path

import filelock  # noqa: F401
import llvmlite.binding  # noqa: F401
import numpy as np
import xarray as xr

import fastlink as fl
from benchmarks.cases import CASES, INPUTS, ROOT, child, designs, fact, log, shortest
from benchmarks.peers import heyoka_has
from fastlink.app.study import read_study
from fastlink.engine.resolve import resolve

COMMAND = "README's command"
STUDY = ROOT / "data" / "studies" / "crank_rocker_map.toml"
#: By request: names and options.
REQUESTS = {
    **{case: (CASES[case], {}) for case in ("positions", "rates", "reactions")},
    "sampled extremes": (CASES["extremes"], {"extrema": "sampled"}),
    "extremes of omega4": (("omega4_max", "omega4_min"), {}),
    "extremes of omega4, alpha4": (("omega4_max", "omega4_min", "alpha4_max", "alpha4_min"), {}),
    "greatest shaking force": (("shaking_force_max",), {}),
}
LABELS = (COMMAND, *REQUESTS)
FIXED = "\n".join(f"x{k} = (a{k} * {k} + b[{k}, i]) / f(c{k}, {k}.5)" for k in range(1500))


# ---- in the fresh process ----


def fixed_work():
    """Do the fixed piece of Python: what depends on this machine and on nothing of fastlink's."""
    ast.unparse(ast.parse(FIXED))
    compile(FIXED, "fixed", "exec")


def peak():
    """Return the greatest memory of this process so far in MiB, and reset it, where the system reports it."""
    status, clear = Path("/proc/self/status"), Path("/proc/self/clear_refs")
    if not status.exists():
        return None
    sizes = dict(line.split(":") for line in status.read_text().splitlines())
    with contextlib.suppress(OSError):
        clear.write_text("5")
    return int(sizes["VmHWM"].split()[0]) / 1024


def request(label):
    """Return what `fastlink.sweep` is called with."""
    if label == COMMAND:
        study = read_study(STUDY)
        names, space, options = study.quantities, study.space, study.options
    else:
        (names, options), values = REQUESTS[label], designs(1)[:, 0].tolist()
        space = fl.grid(**dict(zip(INPUTS, values, strict=True)))
    return {"mechanism": "planar_4r", "space": space, "quantities": names, **options}


def sweep(label):
    return fl.sweep(**{"branch": (1, 2)} | request(label), threads=1, verify=0)


def first(label, is_known):
    """Return what the first request of this process takes, and what it takes again."""
    # xarray imports dask and pint, where they are installed, with the first variable: 0.45 s.
    xr.Dataset(coords={"a2": [1.0]})
    found, parts = {"fixed": shortest(fixed_work, least=3)[0]}, []
    swept = is_known and label != COMMAND
    peak()
    before = peak()
    found["cpu"], found["wall"] = shortest(
        lambda: sweep(label) if swept else parts.extend(resolve(**request(label)).job().tasks)
    )
    if before is not None:
        found["memory"] = peak() - before
    if swept:
        return found | {"again": 1e3 * shortest(lambda: sweep(label), least=50)[1]}
    return found | {"kernels": len(parts)}


# ---- from outside ----


def row_of(label, repeats):
    """Return the row of a request, measured so many times."""
    log(f"time to an answer: {label}")
    cold, known, theirs = [], [], []
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as folder:
            cold.append(child(f"first({label!r}, False)", "answers", FASTLINK_CACHE_DIR=folder))
            size = sum(file.stat().st_size for file in Path(folder).rglob("*") if file.is_file())
            known.append(child(f"first({label!r}, True)", "answers", FASTLINK_CACHE_DIR=folder))
        if heyoka_has(label):
            theirs.append(child(f"heyoka_compile_time({label!r})", "peers"))

    def least(found, name):
        return min((one[name] for one in found if name in one), default=None)

    wall, fixed = least(cold, "wall"), least(cold + known, "fixed")
    return {
        "request": label,
        "cold": wall,
        "to_heyoka": wall / min(theirs) if theirs else None,
        "known": least(known, "wall"),
        "again": least(known, "again"),
        "memory": least(cold, "memory"),
        "cache": size / 1024 / least(cold, "kernels"),
        "to_fixed": least(cold, "cpu") / fixed,
        "known_to_fixed": least(known, "cpu") / fixed,
    }


# ---- layouts of files ----

#: What is read, by the axes that are fixed: at these shares of them, of which the shortest time counts.
PARTS = {"picture": ("theta1",), "curve": ("a2", "a3")}
PLACES = (0.1, 0.37, 0.5, 0.73, 0.9)


def forget(path):
    """Take a file out of the page cache."""
    with path.open("rb") as file:
        os.fsync(file.fileno())
        if hasattr(os, "posix_fadvise"):
            os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def read(path, axes, place):
    """Read what is at a place of axes; return the time in s."""
    with fl.open(path) as maps:
        found = maps.theta4.isel(branch=0)
        where = {dim: int(place * found.sizes[dim]) for dim in axes}
        return shortest(lambda: found.isel(where).values.sum())[1]


def layouts(side=500, repeats=3):
    """Sweeps of one quantity by both layouts, in turns, and reading them from disk and from memory (docs/files.md).

    They are files of 3 GB in a folder of the current directory, which goes at the end.
    """
    grid = {"a1": 0.4, "a2": np.linspace(1.0, 1.4, side), "a3": np.linspace(0.6, 1.0, side), "a4": 1.0}
    options = {"theta1": 360, "threads": 2, "verify": 0, "overwrite": True}
    space, best = fl.grid(**grid, omega1=25.0), {}

    def note(path, what, seconds):
        label = f"{path.stem}, {path.stat().st_size / 1e9:.3g} GB: {what}"
        best[label] = min(1e3 * seconds, best.get(label, np.inf))

    def write(path):
        fl.sweep(
            "planar_4r", space, ["theta4"], to=path, layout=path.stem, **{"branch": (1, 2)} | options
        ).close()

    with tempfile.TemporaryDirectory(dir=Path.cwd(), prefix="fastlink-benchmark-") as folder:
        paths = [Path(folder, f"{layout}.h5") for layout in ("curves", "maps")]
        for path in paths * repeats:
            note(path, "writing", shortest(lambda path=path: write(path))[1])
        for path, (name, axes), place in itertools.product(paths, PARTS.items(), PLACES):
            forget(path)
            note(path, f"{name}, from disk", read(path, axes, place))
            note(path, f"{name}, from memory", read(path, axes, place))
    return [fact(label, value, "ms") for label, value in best.items()]

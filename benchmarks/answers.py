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
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks import heyoka_baseline
from benchmarks.closed_forms import FORMS
from benchmarks.inputs import CASES, INPUTS, designs

ROOT = Path(__file__).parents[1]
COMMAND = "README's command"
STUDY = ROOT / "data" / "studies" / "crank_rocker_map.toml"
SAMPLED = {"extrema": "sampled"}
#: By request: names, options, and the aim of its set-up.
REQUESTS = {
    "positions": (CASES["positions"], {}, "< 0.25"),
    "rates": (CASES["rates"], {}, "< 0.25"),
    "reactions": (CASES["reactions"], {}, "< 0.25"),
    "sampled extremes": (CASES["extremes"], SAMPLED, "< 0.25"),
    "extremes of omega4": (("omega4_max", "omega4_min"), {}, "< 0.8"),
    "extremes of omega4, alpha4": (("omega4_max", "omega4_min", "alpha4_max", "alpha4_min"), {}, "< 0.8"),
    "greatest shaking force": (("shaking_force_max",), {}, "< 0.8"),
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
    names, options, _ = REQUESTS[label]
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


def calls():
    """Return the shortest times of small calls that this process knows: a sweep to a file, one configuration."""
    import fastlink as fl

    import_all()
    label = "extremes of omega4"
    one = dict(zip(INPUTS, designs(1)[:, 0].tolist(), strict=True)) | {"theta1": 1.0, "branch": 2}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "one.h5")
        to_file = shortest(lambda: sweep(label, file).close(), 20)[1]
    return {"file": to_file, "one": shortest(lambda: fl.evaluate("planar_4r", ["omega4"], **one), 200)[1]}


# ---- from outside ----


def child(code, module="answers", **environment):
    """Return the value of an expression over a module of this package, in a fresh Python."""
    done = subprocess.run(
        [sys.executable, "-c", f"import json; from benchmarks.{module} import *; print(json.dumps({code}))"],
        cwd=ROOT,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout.splitlines()[-1])


def least(found, name):
    """Return the least number of that name in some records."""
    return min(one[name] for one in found)


def heyoka_time(case):
    """Return how long heyoka.py takes to compile a case in a fresh process, in s."""
    return child(f"compile_time({case!r})", module="heyoka_baseline")


def row_of(label, repeats):
    """Return the row of a request, measured so many times."""
    cold, known, theirs = [], [], []
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as folder:
            cold.append(child(f"first({label!r}, False)", FASTLINK_CACHE_DIR=folder))
            size = sum(file.stat().st_size for file in Path(folder).rglob("*") if file.is_file())
            known.append(child(f"first({label!r}, True)", FASTLINK_CACHE_DIR=folder))
        if label in FORMS and heyoka_baseline.available():
            theirs.append(heyoka_time(label))
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


def facts_of(found):
    """Return facts about the rows, with their aims, and those of small calls."""
    aims = {COMMAND: "< 2"} | {label: aim for label, (_, _, aim) in REQUESTS.items()}
    facts = []
    for row in found:
        label = row["request"]
        facts.append((f"set-up of {label}, empty cache", row["cold"], "s", aims[label]))
        if row["to_heyoka"] is not None:
            facts.append((f"compile {label} by heyoka.py", row["compile_heyoka"], "s", ""))
            facts.append((f"set-up of {label}, empty cache / heyoka.py", row["to_heyoka"], "", "<= 4"))
        facts.append((f"{label}, known kernel, new process", row["known"], "s", "< 0.15"))
        if row["again"] is not None:
            facts.append((f"{label}, sweep of one design, known in this process", row["again"], "ms", "< 1"))
    return facts


def small_calls():
    """Return the facts about small calls."""
    found = child("calls()")
    return [
        ("sweep of one design to a file, known in this process", 1e3 * found["file"], "ms", "< 40"),
        ("evaluate one configuration, known in this process", 1e3 * found["one"], "ms", "< 0.2"),
    ]

"""Results to text: the tables, ``data/benchmarks/``, and the part of docs/performance.md between its markers."""

import json
import os
import platform
import re
import subprocess
from datetime import date
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from benchmarks import c_kernel

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "data" / "benchmarks"
PAGE = ROOT / "docs" / "performance.md"
BEGIN, END = "<!-- benchmarks -->", "<!-- /benchmarks -->"
HEADS = {
    "case": "case",
    "ns": "ns per configuration",
    "to_C": "time / C",
    "NumPy": "faster than NumPy",
    "JAX": "faster than JAX",
    "heyoka": "faster than heyoka.py",
    "numba": "faster than numba by hand",
    "threads": "gain by two threads",
    "error": "max error",
}
FORMATS = {
    "ns": ".2f",
    "to_C": ".2f",
    "NumPy": ".3g",
    "JAX": ".3g",
    "heyoka": ".3g",
    "numba": ".3g",
    "threads": ".2f",
    "error": ".1f",
}
LEGEND = (
    "One thread, 360 input angles, two assembly modes; times are shortest of many, taken in turns in one "
    "process (JAX: fresh ones), without compilation. C: `benchmarks/kernels.c`, gcc -O3, the same arithmetic. "
    "np.linalg.solve: the stacked 9x9 systems, ready assembled. Errors against 50 digits, in roundings: "
    "2^-53 (|f| + sum of |x df/dx| over the inputs x)."
)
BY_HAND = (
    "numba by hand: textbook formulas in plain loops. heyoka.py: both modes by one function, widest vectors."
)
#: Of the table of times to an answer, in the order of `answers.COLUMNS`.
ANSWER_HEADS = {
    "request": "time to a first answer",
    "cold": "set-up, empty cache: s",
    "to_heyoka": "/ heyoka.py",
    "known": "known kernel, new process: s",
    "again": "known in the process: ms",
    "memory": "compiling takes: MiB",
    "cache": "cached: KiB per kernel",
}
ANSWER_FORMATS = {
    "cold": ".2f",
    "to_heyoka": ".1f",
    "known": ".3f",
    "again": ".2f",
    "memory": ".0f",
    "cache": ".1f",
}
ANSWER_LEGEND = (
    "Shortest of fresh processes, imports not counted. A known kernel is in the cache; known times are of one design "
    "swept, but for the README's command, which is set up. heyoka.py compiles the same, its caches off."
)
USED = ("llvmlite", "numba", "numpy", "jax", "heyoka", "gcc")
PACKAGES = ("numba", "llvmlite", "numpy", "xarray", "h5py", "h5netcdf", "jax", "heyoka", "pylinkage")


def _version(package):
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _processor():
    known = Path("/proc/cpuinfo")
    found = re.search(r"^model name\s*:\s*(.+)$", known.read_text(), re.M) if known.exists() else None
    return found.group(1) if found else platform.processor() or platform.machine()


def machine():
    """Return what the numbers depend on."""
    compiler = c_kernel.compiler()
    if compiler is not None:
        done = subprocess.run([compiler, "-dumpfullversion"], capture_output=True, text=True, check=False)
        compiler = done.stdout.strip() or None
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return {
        "processor": _processor(),
        "cores": cores,
        "system": f"{platform.system()} {platform.machine()}",
        "versions": {
            "python": platform.python_version(),
            "gcc": compiler,
            **{package: _version(package) for package in PACKAGES},
        },
        "date": date.today().isoformat(),
    }


def _markdown(heads, rows):
    widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]
    rule = ["-" * widths[0], *("-" * (width - 1) + ":" for width in widths[1:])]
    lines = []
    for row in (heads, rule, *rows):
        cells = [row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True))]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _table(rows, heads, formats):
    """Return a table without the columns that no row has, as of peers that are not installed."""
    heads = {name: head for name, head in heads.items() if any(row.get(name) is not None for row in rows)}

    def cell(row, name):
        value = row.get(name)
        return "-" if value is None else format(value, formats[name]) if name in formats else value

    return _markdown(list(heads.values()), [[cell(row, name) for name in heads] for row in rows])


def speed_table(rows):
    return _table(rows, HEADS, FORMATS)


def answer_table(answers):
    return f"{_table(answers, ANSWER_HEADS, ANSWER_FORMATS)}\n\n{ANSWER_LEGEND}"


def fact_table(facts):
    rows = [[what, f"{value:.3g} {unit}".strip(), aim or "-"] for what, value, unit, aim in facts]
    return _markdown(["fact", "measured", "aim"], rows)


def caption(rows, about):
    versions = about["versions"]
    used = ", ".join(f"{name} {versions[name]}" for name in USED if versions.get(name))
    peers = "" if all(row.get("numba") is None for row in rows) else f" {BY_HAND}"
    absent = "" if versions["gcc"] else " No gcc: C is not measured."
    place = f"{about['processor']}, {about['cores']} cores, {about['system']}"
    return f"{LEGEND}{peers}{absent} {place}; {used}; {about['date']}."


def text_of(rows, answers, about):
    """Return the tables with their captions: what the page shows."""
    shown = f"{speed_table(rows)}\n\n{caption(rows, about)}"
    return f"{answer_table(answers)}\n\n{shown}" if answers else shown


def in_page():
    """Return what the page has between the markers, or None without markers."""
    found = re.search(f"{re.escape(BEGIN)}\n(.*){re.escape(END)}", PAGE.read_text(), re.S)
    return found.group(1).strip() if found else None


def record():
    """Return what was written last, or None."""
    path = FOLDER / "benchmarks.json"
    return json.loads(path.read_text()) if path.exists() else None


def write(rows, answers, facts, about):
    """Write both files, and the page's part where it has the markers."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    named = [dict(zip(("fact", "value", "unit", "aim"), fact, strict=True)) for fact in facts]
    everything = {"machine": about, "cases": rows, "answers": answers, "facts": named}
    (FOLDER / "benchmarks.json").write_text(json.dumps(everything, indent=2) + "\n")
    shown = text_of(rows, answers, about)
    (FOLDER / "benchmarks.md").write_text(f"{shown}\n\n{fact_table(facts)}\n")
    if in_page() is not None:
        before, rest = PAGE.read_text().split(BEGIN, 1)
        PAGE.write_text(f"{before}{BEGIN}\n{shown}\n{END}{rest.split(END, 1)[1]}")

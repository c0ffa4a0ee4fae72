"""Results to text: a record, and docs/performance.md between its markers; and what is worse than the record."""

import json
import os
import platform
import re
import subprocess
from datetime import date
from importlib.metadata import version
from pathlib import Path

from benchmarks import answers, peers, table
from benchmarks.cases import ROOT

FOLDER = ROOT / "data" / "benchmarks"
PAGE = ROOT / "docs" / "performance.md"
BEGIN, END = "<!-- benchmarks -->", "<!-- /benchmarks -->"
#: By column: its head, and the format of its numbers.
SPEED = {
    "case": ("case", ""),
    "ns": ("ns per configuration", ".2f"),
    "to_C": ("time / C", ".2f"),
    "NumPy": ("faster than NumPy", ".3g"),
    "JAX": ("faster than JAX", ".3g"),
    "heyoka": ("faster than heyoka.py", ".3g"),
    "numba": ("faster than numba by hand", ".3g"),
    "threads": ("gain by two threads", ".2f"),
    "error": ("max error", ".1f"),
}
ANSWERS = {
    "request": ("time to a first answer", ""),
    "cold": ("set-up, empty cache: s", ".2f"),
    "to_heyoka": ("/ heyoka.py", ".1f"),
    "known": ("known kernel, new process: s", ".3f"),
    "again": ("known in the process: ms", ".2f"),
    "memory": ("compiling takes: MiB", ".0f"),
    "cache": ("cached: KiB per kernel", ".1f"),
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
ANSWER_LEGEND = (
    "Shortest of fresh processes, imports not counted. A known kernel is in the cache; known times are of one design "
    "swept, but for the README's command, which is set up. heyoka.py compiles the same, its caches off."
)
USED = ("llvmlite", "numba", "numpy", "jax", "heyoka", "gcc")
PACKAGES = ("numba", "llvmlite", "numpy", "xarray", "h5py", "h5netcdf", "jax", "heyoka")


def _processor():
    known = Path("/proc/cpuinfo")
    found = re.search(r"^model name\s*:\s*(.+)$", known.read_text(), re.M) if known.exists() else None
    return found.group(1) if found else platform.processor() or platform.machine()


def machine():
    """Return what the numbers depend on."""
    compiler = peers.compiler()
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
            **{package: version(package) for package in filter(peers.available, PACKAGES)},
        },
        "date": date.today().isoformat(),
    }


def _markdown(columns, rows):
    """Return a table of rows by name; ``columns`` has for each name its head and the format of its numbers."""
    shown = [[head for head, _ in columns.values()]]
    for row in rows:
        cells = ((row.get(name), form) for name, (_, form) in columns.items())
        shown.append(["-" if value is None else format(value, form) for value, form in cells])
    widths = [max(map(len, column)) for column in zip(*shown, strict=True)]
    shown.insert(1, ["-" * widths[0], *("-" * (width - 1) + ":" for width in widths[1:])])
    sides = ["<", *">" * (len(widths) - 1)]
    lines = (map("{:{}{}}".format, row, sides, widths) for row in shown)
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _table(rows, columns):
    """Return a table without the columns that no row has, as of peers that are not installed."""
    return _markdown(
        {name: c for name, c in columns.items() if any(row.get(name) is not None for row in rows)}, rows
    )


def fact_table(facts):
    rows = [
        {"fact": what, "measured": f"{value:.3g} {unit}".strip(), "aim": aim or None}
        for what, value, unit, aim in facts
    ]
    return _markdown({name: (name, "") for name in ("fact", "measured", "aim")}, rows)


def caption(rows, about):
    versions = about["versions"]
    used = ", ".join(f"{name} {versions[name]}" for name in USED if versions.get(name))
    peers = "" if all(row.get("numba") is None for row in rows) else f" {BY_HAND}"
    absent = "" if versions["gcc"] else " No gcc: C is not measured."
    place = f"{about['processor']}, {about['cores']} cores, {about['system']}"
    return f"{LEGEND}{peers}{absent} {place}; {used}; {about['date']}."


def text_of(rows, answered, about):
    """Return the tables with their captions: what the page shows."""
    shown = f"{_table(rows, SPEED)}\n\n{caption(rows, about)}"
    return f"{_table(answered, ANSWERS)}\n\n{ANSWER_LEGEND}\n\n{shown}" if answered else shown


def in_page():
    """Return what the page has between the markers, or None without markers."""
    found = re.search(f"{re.escape(BEGIN)}\n(.*){re.escape(END)}", PAGE.read_text(), re.S)
    return found.group(1).strip() if found else None


def record():
    """Return what was written last, or None."""
    path = FOLDER / "benchmarks.json"
    return json.loads(path.read_text()) if path.exists() else None


def write(rows, answered, facts, about):
    """Write the record, and the page's part where it has the markers."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    named = [dict(zip(("fact", "value", "unit", "aim"), fact, strict=True)) for fact in facts]
    everything = {"machine": about, "cases": rows, "answers": answered, "facts": named}
    (FOLDER / "benchmarks.json").write_text(json.dumps(everything, indent=2) + "\n")
    shown = text_of(rows, answered, about)
    if in_page() is not None:
        before, rest = PAGE.read_text().split(BEGIN, 1)
        PAGE.write_text(f"{before}{BEGIN}\n{shown}\n{END}{rest.split(END, 1)[1]}")


# ---- ``python -m benchmarks --check``: ratios of times that got worse than the committed record has them ----
#
# A ratio is of two things that were timed in turns in one run: ours to C, to a peer, or to a fixed piece of Python.
# What looks worse is measured again, in further rounds of which the least counts: other load seldom slows one side.

#: A ratio that is more than so many times the record's is worse.
WORSE = 1.1
#: How often a group is measured that holds something worse.
ROUNDS = 4


def ratios(facts):
    """Return by name what facts have of ratios of times, where less is better."""
    return {what: value for what, value, unit, _ in facts if unit == "" and " / " in what}


#: By column of an answer: what its ratio is to.
ANSWER_RATIOS = {
    "to_heyoka": "/ heyoka.py",
    "to_fixed": "/ fixed work",
    "known_to_fixed": "from the cache / fixed work",
}


def answer_ratios(rows):
    """Return by name the ratios of times to an answer."""
    return {
        f"set-up of {row['request']}, {other}": row[column]
        for row in rows
        for column, other in ANSWER_RATIOS.items()
        if row.get(column) is not None
    }


def groups():
    """Return what is measured together, by name."""
    parts = table.ratios_to_c, table.refined_over_sampled, table.one_mode, table.end_to_end
    measured = {part.__name__: lambda part=part: ratios(part()) for part in parts}
    for label in answers.LABELS:
        measured[f"set-up of {label}"] = lambda one=label: answer_ratios([answers.row_of(one, repeats=2)])
    return measured


def recorded(record):
    """Return the ratios of a record by name."""
    found = ratios(tuple(fact.values()) for fact in record["facts"]) | answer_ratios(record["answers"])
    to_c = {f"{row['case']}, time / C": row.get("to_C") for row in record["cases"]}
    return found | {name: value for name, value in to_c.items() if value is not None}


def worse(now, then):
    """Return the names of what is worse than recorded."""
    return [name for name, value in now.items() if name in then and value > WORSE * then[name]]


def check(record, measured, log=lambda text: None):
    """Return what got worse: by name, the ratio now and the one recorded.

    ``measured`` has functions that measure some ratios together, by the name of the group.
    """
    then, found = recorded(record), {}
    for group, measure in measured.items():
        log(group)
        now = measure()
        for _ in range(ROUNDS - 1):
            if slower := worse(now, then):
                log(f"{group}, again: {', '.join(slower)}")
                again = measure()
                now = {name: min(value, again.get(name, value)) for name, value in now.items()}
        found |= {name: (now[name], then[name]) for name in worse(now, then)}
        for name in now.keys() - then.keys():
            log(f"not in the record: {name}")
    return found


def report_worse(record, log=lambda text: None, measured=None):
    """Print what got worse; return the exit status, 1 if anything did."""
    if record is None:
        print("no record to check against: run `python -m benchmarks` first")
        return 1
    found = check(record, groups() if measured is None else measured, log)
    for name, (now, then) in found.items():
        print(f"{name}: {now:.3g}, recorded {then:.3g}, {100 * (now / then - 1):.0f} % worse")
    if not found:
        print(f"nothing is more than {100 * (WORSE - 1):.0f} % worse than recorded")
    return 1 if found else 0

"""Results to text: a record, and docs/performance.md between its markers; and what is worse than the record."""

import json
import platform
import re
import subprocess
from datetime import date
from importlib.metadata import version
from pathlib import Path

from benchmarks import answers, peers, table
from benchmarks.cases import ROOT, log, markdown
from fastlink.engine.run import default_threads

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
FACTS = {"fact": ("fact", ""), "value": ("measured", ".3g"), "unit": ("unit", "")}
LEGEND = (
    "One thread, 360 input angles, two branches; times are shortest of many, taken in turns in one "
    "process (JAX: fresh ones), without compilation. C: `benchmarks/kernels.c`, gcc -O3, the same arithmetic. "
    "np.linalg.solve: the stacked 9x9 systems, ready assembled. Errors against 50 digits, in roundings: "
    "2^-53 (|f| + sum of |x df/dx| over the inputs x). numba by hand: textbook formulas in plain loops. "
    "heyoka.py: both modes by one function, widest vectors."
)
ANSWER_LEGEND = (
    "Shortest of fresh processes, imports not counted. A known kernel is in the cache; known times are of one design "
    "swept, but for the README's command, which is set up. heyoka.py compiles the same, its caches off."
)
PACKAGES = ("llvmlite", "numba", "numpy", "xarray", "h5py", "h5netcdf", "jax", "heyoka")


def _processor():
    known = Path("/proc/cpuinfo")
    found = re.search(r"^model name\s*:\s*(.+)$", known.read_text(), re.M) if known.exists() else None
    return found.group(1) if found else platform.processor() or platform.machine()


def machine():
    """Return what the numbers depend on."""
    compiler = peers.compiler()
    if compiler is not None:
        compiler = subprocess.check_output([compiler, "-dumpfullversion"], text=True).strip()
    return {
        "processor": _processor(),
        "cores": default_threads(),
        "system": f"{platform.system()} {platform.machine()}",
        "versions": {
            "python": platform.python_version(),
            "gcc": compiler,
            **{package: version(package) for package in filter(peers.available, PACKAGES)},
        },
        "date": date.today().isoformat(),
    }


def table_of(rows, columns):
    """Return a table without the columns that no row has, as of peers that are not installed."""
    columns = {name: c for name, c in columns.items() if any(row.get(name) is not None for row in rows)}
    cells = [[(row.get(name), form) for name, (_, form) in columns.items()] for row in rows]
    texts = [["-" if value is None else format(value, form) for value, form in row] for row in cells]
    return markdown([head for head, _ in columns.values()], *texts)


def text_of(rows, answered, about):
    """Return the tables with their captions: what the page shows."""
    versions = {name: about["versions"].get(name) for name in ("python", "gcc", *PACKAGES)}
    used = ", ".join(f"{name} {version}" for name, version in versions.items() if version)
    absent = "" if versions["gcc"] else " No gcc: C is not measured."
    place = f"{about['processor']}, {about['cores']} cores, {about['system']}; {used}; {about['date']}."
    tables = table_of(answered, ANSWERS), ANSWER_LEGEND, table_of(rows, SPEED), f"{LEGEND}{absent} {place}"
    return "\n\n".join(tables)


def parts_of_page():
    """Return what the page has before, between and behind the markers."""
    before, rest = PAGE.read_text().split(f"{BEGIN}\n")
    return before, *rest.split(f"\n{END}")


def record():
    """Return what was written last."""
    return json.loads((FOLDER / "benchmarks.json").read_text())


def write(rows, answered, facts, about):
    """Write the record, and the page's part between its markers."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    everything = {"machine": about, "cases": rows, "answers": answered, "facts": facts}
    (FOLDER / "benchmarks.json").write_text(json.dumps(everything, indent=2) + "\n")
    before, _, behind = parts_of_page()
    PAGE.write_text(f"{before}{BEGIN}\n{text_of(rows, answered, about)}\n{END}{behind}")


# ---- ``python -m benchmarks --check``: ratios of times that got worse than the committed record has them ----
#
# A ratio is of two things that were timed in turns in one run: ours to C, to a peer, or to a fixed piece of Python.
# What looks worse is measured again, in further rounds of which the least counts: other load seldom slows one side.

#: A ratio that is more than so many times the record's is worse.
WORSE = 1.1
#: How often a group is measured that holds something worse.
ROUNDS = 4
#: By column of a case or an answer: the ratio that it is.
RATIOS = {
    "to_C": "time / C",
    "to_heyoka": "set-up / heyoka.py",
    "to_fixed": "set-up / fixed work",
    "known_to_fixed": "set-up from the cache / fixed work",
}


def ratios(*tables):
    """Return by name the ratios of times in rows of cases, answers and facts, where less is better."""
    rows = [row for table in tables for row in table]
    return {row["fact"]: row["value"] for row in rows if row.get("unit") == ""} | {
        f"{row.get('case', row.get('request'))}, {name}": row[column]
        for row in rows
        for column, name in RATIOS.items()
        if row.get(column) is not None
    }


def groups():
    """Return what is measured together, by name."""
    parts = table.ratios_to_c, table.of_extremes, table.end_to_end
    measured = {part.__name__: lambda part=part: ratios(part()) for part in parts}
    for label in answers.LABELS:
        measured[f"set-up of {label}"] = lambda label=label: ratios([answers.row_of(label, repeats=2)])
    return measured


def worse(now, then):
    """Return the names of what is worse than recorded."""
    return [name for name, value in now.items() if name in then and value > WORSE * then[name]]


def check(record, measured):
    """Print what got worse than recorded; return the exit status, 1 if anything did.

    ``measured`` has functions that measure some ratios together, by the name of the group.
    """
    then, found = ratios(record["cases"], record["answers"], record["facts"]), []
    for group, measure in measured.items():
        log(group)
        now = measure()
        for _ in range(ROUNDS - 1):
            if slower := worse(now, then):
                log(f"{group}, again: {', '.join(slower)}")
                again = measure()
                now = {name: min(value, again.get(name, value)) for name, value in now.items()}
        for name in now.keys() - then.keys():
            log(f"not in the record: {name}")
        for name in worse(now, then):
            more = 100 * (now[name] / then[name] - 1)
            found.append(f"{name}: {now[name]:.3g}, recorded {then[name]:.3g}, {more:.0f} % worse")
    print("\n".join(found or [f"nothing is more than {100 * (WORSE - 1):.0f} % worse than recorded"]))
    return int(bool(found))

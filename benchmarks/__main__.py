"""``python -m benchmarks``: measure, print tables, write them to ``data/benchmarks/``, or ``--check`` against these."""

import argparse
import sys

from benchmarks import answers, report, table
from benchmarks.cases import fact, log


def measure(quick=False):
    """Return rows, answers and facts; quick: at small sizes, whether everything runs, not how fast."""
    rows = table.measure(quick)
    labels, repeats = (["positions"], 1) if quick else (answers.LABELS, 3)
    found = [answers.row_of(label, repeats) for label in labels]
    through = "through `run`, blocks of memory"
    facts = [fact(f"{row['case']} {through}", row["run_ns"], "ns") for row in rows if "run_ns" in row]
    log("extremes")
    if quick:
        return rows, found, facts + table.end_to_end(128, 1) + table.of_extremes(64, 1, ["omega4"])
    facts += table.end_to_end() + table.of_extremes()
    log("layouts")
    return rows, found, facts + answers.layouts()


def main():
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small sizes; nothing is written")
    parser.add_argument(
        "--check", action="store_true", help="name what is worse than recorded; nothing is written"
    )
    arguments = parser.parse_args()
    if arguments.check:
        sys.exit(report.check(report.record(), report.groups()))
    measured, about = measure(arguments.quick), report.machine()
    print(report.text_of(*measured[:2], about), report.table_of(measured[2], report.FACTS), sep="\n\n")
    if not arguments.quick:
        report.write(*measured, about)


if __name__ == "__main__":
    main()

"""``python -m benchmarks``: measure, print tables, write them to ``data/benchmarks/``, or ``--check`` against these."""

import argparse
import sys

from benchmarks import (
    answers,
    check,
    extrema,
    facts,
    files,
    focal,
    leave_out,
    minkowski,
    output,
    peers,
    report,
    table,
    whole,
)

#: Modules that measure all they have, in full or in little.
PARTS = (extrema, whole, peers, minkowski, focal, leave_out)


def quick():
    """Return rows, answers and facts at small sizes: whether everything runs, not how fast."""
    others = facts.angles(8, 64, rounds=1) + facts.system(8, 64, rounds=1, count=2)
    for part in PARTS:
        others += part.measure(quick=True)
    found = answers.rows(["positions"], repeats=1)
    return table.measure(quick=True), found, others + answers.facts_of(found)


def full(folder, log):
    """Return rows, answers and facts."""
    rows, found = table.measure(log=log), answers.rows(log=log)
    others = answers.facts_of(found) + answers.small_calls()
    for part in (facts.angles, facts.system, facts.start):
        log(part.__name__)
        others += part()
    others += [
        (f"{row['case']} through `run`, blocks of memory", row["run_ns"], "ns", "")
        for row in rows
        if "run_ns" in row
    ]
    for part in PARTS:
        others += part.measure(log=log)
    return rows, found, others + output.measure(folder, log) + output.measure(folder, log, files.PARTS)


def main():
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small sizes, no output; nothing is written")
    parser.add_argument(
        "--check", action="store_true", help="name what is worse than recorded; nothing is written"
    )
    parser.add_argument("--folder", help="where to write 2 GB; default: a temporary one here")
    arguments = parser.parse_args()

    def log(text):
        print(f"... {text}", file=sys.stderr, flush=True)

    if arguments.check:
        sys.exit(check.report_worse(report.record(), log))
    rows, found, others = quick() if arguments.quick else full(arguments.folder, log)
    about = report.machine()
    print(report.text_of(rows, found, about), report.fact_table(others), sep="\n\n")
    if not arguments.quick:
        report.write(rows, found, others, about)


if __name__ == "__main__":
    main()

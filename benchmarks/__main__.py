"""``python -m benchmarks``: measure, print two tables, write them to ``data/benchmarks/``."""

import argparse
import sys

from benchmarks import extrema, facts, focal, leave_out, minkowski, output, report, table

#: Modules that measure all they have, in full or in little.
PARTS = (extrema, minkowski, focal, leave_out)


def quick():
    """Return rows and facts at small sizes: whether everything runs, not how fast."""
    others = facts.angles(8, 64, rounds=1) + facts.system(8, 64, rounds=1, count=2)
    for part in PARTS:
        others += part.measure(quick=True)
    return table.measure(quick=True), others


def full(folder, log):
    """Return rows and facts."""
    found = table.measure(log=log)
    others = []
    for part in (facts.angles, facts.system, facts.compilation, facts.start):
        log(part.__name__)
        others += part()
    others += [
        (f"{row['case']} through `run`, blocks of memory", row["run_ns"], "ns", "")
        for row in found
        if "run_ns" in row
    ]
    for part in PARTS:
        others += part.measure(log=log)
    return found, others + output.measure(folder, log)


def main():
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small sizes, no output; nothing is written")
    parser.add_argument("--folder", help="where to write 2 GB; default: a temporary one here")
    arguments = parser.parse_args()

    def log(text):
        print(f"... {text}", file=sys.stderr, flush=True)

    rows, others = quick() if arguments.quick else full(arguments.folder, log)
    about = report.machine()
    print(report.text_of(rows, about), report.fact_table(others), sep="\n\n")
    if not arguments.quick:
        report.write(rows, others, about)


if __name__ == "__main__":
    main()

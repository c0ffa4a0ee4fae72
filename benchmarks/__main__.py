"""``python -m benchmarks``: measure, print tables, write them to ``data/benchmarks/``, or ``--check`` against these."""

import argparse
import sys

from benchmarks import answers, report, table


def quick():
    """Return rows, answers and facts at small sizes: whether everything runs, not how fast."""
    found = answers.rows(["positions"], repeats=1)
    facts = table.facts(quick=True)
    return table.measure(quick=True), found, facts


def full(folder, log):
    """Return rows, answers and facts."""
    rows, found = table.measure(log=log), answers.rows(log=log)
    through = [
        (f"{r['case']} through `run`, blocks of memory", r["run_ns"], "ns", "") for r in rows if "run_ns" in r
    ]
    facts = through + table.facts(log=log)
    log("layouts")
    return rows, found, facts + answers.layouts(folder)


def main():
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small sizes, no output; nothing is written")
    parser.add_argument(
        "--check", action="store_true", help="name what is worse than recorded; nothing is written"
    )
    parser.add_argument("--folder", help="where to write 3 GB; default: a temporary one here")
    arguments = parser.parse_args()

    def log(text):
        print(f"... {text}", file=sys.stderr, flush=True)

    if arguments.check:
        sys.exit(report.report_worse(report.record(), log))
    rows, found, others = quick() if arguments.quick else full(arguments.folder, log)
    about = report.machine()
    print(report.text_of(rows, found, about), report.fact_table(others), sep="\n\n")
    if not arguments.quick:
        report.write(rows, found, others, about)


if __name__ == "__main__":
    main()

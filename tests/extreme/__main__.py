"""Print what comes out in every extreme case: ``PYTHONPATH=.:tests python -m extreme [small]``."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator

from tests.extreme.case import Case, Mechanism, evaluated, outcomes
from tests.extreme.exact import CONTEXT, Configuration
from tests.extreme.mechanisms import MECHANISMS


def lines(mechanism: Mechanism, cases: list[Case]) -> Iterator[str]:
    """Yield a row for each case and branch.

    It has the greatest error in units of (condition x rounding) and the quantity that has it, the greatest condition
    number, and how many quantities came out as what.
    """
    found = evaluated(mechanism, cases)
    for i, case in enumerate(cases):
        for branch in mechanism.catalogue.branches:
            values = {name: array[i] for name, array in found[branch].items()}
            result = outcomes(mechanism, case, branch, values)
            worst = max(result, key=lambda name: result[name].error)
            kinds = Counter(outcome.what.split()[0] for outcome in result.values())
            came_out = ", ".join(f"{count} {what}" for what, count in kinds.items())
            wrong = [name for name, outcome in result.items() if not outcome.right]
            verdict = f" WRONG: {', '.join(wrong)}" if wrong else ""
            number = condition_number(mechanism, case, branch, result)
            yield f"| {case.name} | {branch} | {result[worst].error:.2f} | {worst} | {number} | {came_out}{verdict} |"


def condition_number(mechanism: Mechanism, case: Case, branch: int, result: dict) -> str:
    """Return the greatest one of the quantities that have a value and are not residuals."""
    names = tuple(
        name for name, outcome in result.items() if outcome.what == "value" and "residual" not in name
    )
    exact = Configuration(mechanism.catalogue, names, case.inputs | {"branch": branch}, mechanism.held)
    sums = exact.condition()
    numbers = [sums[name] / abs(exact.values[name]) for name in names if exact.values[name] != 0]
    # By differences of 1e-20: where that much leaves the range in which the loop closes, none is known.
    return f"{float(max(numbers)):.0e}" if numbers and all(map(CONTEXT.isfinite, numbers)) else "-"


def main() -> None:
    """Print all tables."""
    full = sys.argv[1:] != ["small"]
    for name, mechanism in MECHANISMS.items():
        for family, make in mechanism.families.items():
            print(f"\n## {name}: {family}\n")
            print(
                "| case | branch | worst error | of | condition number | came out |\n|---|---|---|---|---|---|"
            )
            for line in lines(mechanism, make(full)):
                print(line)


if __name__ == "__main__":
    main()

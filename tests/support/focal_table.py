"""The table of docs/focal.md: `python -m tests.support.focal_table`, from the root of the repository."""

from __future__ import annotations

import numpy as np

from fastlink.precision.reference import CONTEXT as MP
from fastlink.precision.reference import error_in_roundings
from tests.support.focal_designs import FAMILIES, GIVEN, exact, facts, family, one

BARS = ("lambda_", "m", "n", "p", "q", "r")
N = 60


def as_printed(a, b, c, d, rho, completion):
    """Return lambda, m, n, p, q, r by the quadratic equation and eqs. (2.5) and (1.8) in doubles."""
    B = rho * b * b + a * a / rho
    middle, end = a * a + b * b + d * d - c * c + B, a * a + b * b + B
    root = np.sqrt(middle * middle - 4 * d * d * end)
    both = (middle + root) / (2 * d * d), (middle - root) / (2 * d * d)
    L = both[0] if (abs(both[0] - 1) > abs(both[1] - 1)) == (completion == 1) else both[1]
    m, n = a / L, b / L
    q = np.sqrt((L - 1) * a * a / (L * L * rho))
    p = rho * n * q / m
    sizes = m * m * n * n * (p * p + q * q) + (m * m + n * n) * p * p * q * q
    square = sizes + m * n * p * q * (m * m + n * n + p * p + q * q - d * d)
    return dict(zip(BARS, (L, m, n, p, q, np.sqrt(square) / abs(m * p + n * q)), strict=True))


def row(kind):
    """Return the greatest errors of fastlink and of the printed formulas, in roundings."""
    designs = family(kind, np.random.default_rng(1), N)
    exactly, worst = exact(BARS), np.zeros(2)
    for completion in (1.0, 2.0):
        found = facts(designs, completion, BARS)
        for i in range(len(designs["a"])):
            given = one(designs, i, completion)
            at = exactly.at(given)
            if MP.isnan(at["r"]):
                continue
            condition = exactly.condition(at, GIVEN["rho"][0])
            with np.errstate(all="ignore"):
                printed = as_printed(**{name: np.float64(value) for name, value in given.items()})
            for name in BARS:
                values = float(found[name][i]), float(printed[name])
                errors = [
                    error_in_roundings(v, at[name], condition[name]) if np.isfinite(v) else np.inf
                    for v in values
                ]
                worst = np.maximum(worst, errors)
    return worst


if __name__ == "__main__":
    for kind in FAMILIES:
        ours, printed = row(kind)
        print(f"| {kind} | {ours:.1f} | {'no value' if np.isinf(printed) else format(printed, '.2g')} |")

"""Burmester's focal mechanism and Hart's linkage: time of completions and of positions, against C and NumPy.

C is the kernel's own text (`in_c`), NumPy its facts (`in_numpy`): both give the same bits. What they take next to C and
NumPy by hand is told of the planar 4R. A fact is (what, value, unit, aim).
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from benchmarks import c_kernel, in_c, in_numpy, inputs, numpy_baseline
from benchmarks.engine import angles, bind_results, program_of
from benchmarks.inputs import aligned_copy, race
from benchmarks.report import fact_table
from fastlink.mechanisms import catalogue
from fastlink.plan.programs import make_program

FOUR_BAR = ("a", "b", "c", "d", "rho", "completion")
HART = ("m", "n", "d", "kappa")


def joints(letters):
    return tuple(f"{letter}_{axis}" for letter in letters for axis in "xy")


@dataclass(frozen=True)
class Case:
    """A request: quantities of a mechanism by design, or by design, branch and input."""

    title: str
    mechanism: str
    input: str | None
    names: tuple
    curves: bool = True


CASES = (
    Case(
        "completions of a focal mechanism, by design",
        "focal",
        None,
        ("lambda_", "m", "n", "p", "q", "r", "FT", "S_x", "status"),
        curves=False,
    ),
    Case("focal positions by phi", "focal", "phi", ("psi", *joints("ABPQFT"))),
    Case("focal positions by sigma", "focal", "sigma", (*joints("FPQABT"), "dphi_dsigma")),
    Case("positions of Hart's linkage", "hart", None, joints("ABPQF")),
)


def four_bars(n, seed=0):
    """Return random double rockers (6, n) with both completions: a, b, c, d, rho, completion."""
    rng = np.random.default_rng(seed)
    a, b, c, d = rng.uniform([[3.0], [3.0], [1.0], [2.0]], [[6.0], [6.0], [3.0], [5.0]], (4, n))
    return aligned_copy(np.array([a, b, c, d, np.exp(rng.uniform(-1, 1, n)), 1.0 + np.arange(n) % 2]))


def harts(n, seed=0):
    """Return random linkages of Hart (4, n): m, n, d, kappa."""
    sizes = np.exp(np.random.default_rng(seed).uniform(-0.5, 0.5, (4, n)))
    sizes[3] *= 0.5
    return aligned_copy(sizes)


def quadratic(x):
    """Return lambda_, m, n, p, q, r, FT, S_x as eqs. (1.8), (1.9), (2.5), (2.6) of Wunderlich have them, in NumPy."""
    a, b, c, d, rho, completion = x
    with np.errstate(all="ignore"):
        W = (1 + rho) * (a**2 + rho * b**2) / rho
        half = (W - c**2 - d**2) / 2
        greater = (half + np.copysign(np.sqrt(half**2 - (c * d) ** 2), half)) / d**2
        found = np.where(completion == 1, greater, (c / d) ** 2 / greater)  # lambda - 1
        m, n = a / (1 + found), b / (1 + found)
        q = np.sqrt(found / rho) * np.abs(m)
        r = np.sqrt(rho / found) * c / np.abs(1 + rho)
        FT = np.sqrt(rho * found) * d / np.abs(1 + rho)
        return 1 + found, m, n, rho * b / a * q, q, r, FT, rho * d / (1 + rho)


def bind(case, n, K):
    """Return the bare kernel of a case, with the arrays that it fills; compiles it."""
    x, given = (harts(n), HART) if case.mechanism == "hart" else (four_bars(n), FOUR_BAR)
    K = K if case.curves else 0
    program = make_program(catalogue(case.mechanism, case.input), case.names, given=given, angles=K or 1)
    return bind_results(program, given, x, np.arange(K) * (2 * np.pi / K) if K else ())


def facts_of(case, n, K, rounds):
    """Return the time of a case, what C takes and what NumPy takes."""
    n = n if case.curves else 128 * n
    bound = bind(case, n, K)
    calls = {"ours": bound, "NumPy": in_numpy.bind(bound)[0]}
    if c_kernel.available():
        calls["C"] = in_c.bind(bound)[0]
    if not case.curves:
        calls["quadratic"] = partial(quadratic, four_bars(n))
    best = race(calls, rounds)
    ours = best["ours"]
    facts = [(case.title, 1e9 * ours / (n * 2 * K if case.curves else n), "ns", "")]
    if "C" in best:
        facts.append((f"{case.title}, time / C", ours / best["C"], "", "<= 1.1"))
    facts.append((f"{case.title}, NumPy / ours", best["NumPy"] / ours, "times", ">= 8"))
    if "quadratic" in best:
        ratio = best["quadratic"] / ours
        facts.append((f"{case.title}, eq. (2.5) as it stands in NumPy / ours", ratio, "times", ""))
    return facts


def by_hand(n, K, rounds, case="rates"):
    """Tell what C and NumPy take that were written by hand, next to those of the text."""
    x, tables = inputs.designs(n), inputs.angle_tables(K)
    bound = bind_results(program_of(case, K), inputs.INPUTS, x, angles(K))
    out = inputs.outputs(case, n, K)
    calls = {
        "NumPy": in_numpy.bind(bound)[0],
        "by hand": partial(numpy_baseline.evaluate, case, x, tables, out),
    }
    best = race(calls, rounds)
    title = f"{case} of the planar 4R"
    facts = [(f"{title}, NumPy of the facts / by hand", best["NumPy"] / best["by hand"], "", "")]
    if c_kernel.available():
        best = race({"C": in_c.bind(bound)[0], "by hand": c_kernel.bind(case, x, tables)[0]}, rounds)
        facts.append((f"{title}, C of the text / by hand", best["C"] / best["by hand"], "", ""))
    return facts


def measure(quick=False, log=lambda text: None):
    """Return all facts; quick: small sizes."""
    facts = by_hand(2, 64, rounds=1) if quick else by_hand(64, 360, rounds=12)
    for case in CASES:
        log(case.title)
        facts += facts_of(case, 2, 64, rounds=1) if quick else facts_of(case, 64, 360, rounds=12)
    return facts


if __name__ == "__main__":
    print(fact_table(measure()))

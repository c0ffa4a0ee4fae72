"""The extreme cases of Burmester's focal mechanism, driven by the rocker MA."""

from __future__ import annotations

import numpy as np

from fastlink.mechanisms import catalogue
from tests.extreme.case import Case, Mechanism
from tests.support.focal_configurations import LENGTHS, random_designs, rows
from tests.support.focal_configurations import family as drawn

ULP = 2.0**-53


def cases(name: str, inputs: dict[str, np.ndarray]) -> list[Case]:
    """Return each row as a case; its branch is the runner's."""
    found = []
    for i, one in enumerate(rows(inputs)):
        one.pop("branch")
        found.append(Case(f"{name}, {i}", one))
    return found


def of_kinds(kinds: tuple[str, ...], full: bool, seed: int) -> list[Case]:
    rng = np.random.default_rng(seed)
    return [case for kind in kinds for case in cases(kind, drawn("phi", kind, rng, 12 if full else 2))]


def toggles(full: bool) -> list[Case]:
    return of_kinds(("toggle 1e-3", "toggle 1e-6", "toggle 1e-8", "toggle 1e-10"), full, 1)


def straight_lines(full: bool) -> list[Case]:
    """mp + nq = 0 exactly, where S and T are at infinity, to an ulp, and less nearly."""
    rng = np.random.default_rng(2)
    away = (0.0, ULP, -2 * ULP, 1e-15, -1e-12, 1e-8) if full else (0.0, ULP, -2 * ULP, 1e-8)
    found = []
    for size in away:
        inputs = random_designs(rng, 12 if full else 2) | {"rho": np.full(12 if full else 2, -1.0 + size)}
        found += cases(f"rho = -1 + {size:.1e}", inputs | {"phi": rng.uniform(-3.0, 3.0, len(inputs["a"]))})
    return found


def lambdas(full: bool) -> list[Case]:
    """The factor a/m = b/n near 1 (the short coupler: P is at A), near 0 (P far away), and m = p (a kite)."""
    rng = np.random.default_rng(3)
    found = []
    for size in (1e-3, 1e-8, 1e-15) if full else (1e-8,):
        inputs = random_designs(rng, 12 if full else 3)
        inputs |= {"c": inputs["c"] * size, "d": np.hypot(inputs["a"], inputs["b"])}
        found += cases(
            f"lambda next to 1, c times {size:.0e}",
            inputs | {"phi": rng.uniform(-3.0, 3.0, len(inputs["a"]))},
        )
    return found + of_kinds(("kite 1e-3", "kite 1e-8", "kite 1e-15"), full, 4)


def scales(full: bool) -> list[Case]:
    found = of_kinds(("scale 1e-20", "scale 1e20"), full, 5)
    for name in (*LENGTHS, "rho"):
        for by in (1e-8, 1e8):
            inputs = drawn("phi", "random", np.random.default_rng(6), 1)
            found += cases(f"{name} times {by:.0e}", inputs | {name: inputs[name] * by})
    return found


def angles(full: bool) -> list[Case]:
    found = []
    for phi in (0.0, 5e-324, 1e-160, 1e-8, np.pi / 2, -np.pi, 2e6 * np.pi, 1.7e308):
        inputs = drawn("phi", "random", np.random.default_rng(7), 4 if full else 1)
        found += cases(f"phi = {phi:.1e}", inputs | {"phi": np.full(len(inputs["a"]), phi)})
    return found


FOCAL = Mechanism(
    catalogue("focal"),
    {
        "toggles": toggles,
        "straight lines": straight_lines,
        "lambdas": lambdas,
        "scales": scales,
        "angles": angles,
    },
    # a distance without scale, whose exact value 0 has no condition number: test_focal_figure.py
    skipped=("F_path_residual",),
    lengths=tuple(LENGTHS),
)

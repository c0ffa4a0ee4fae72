"""The extreme cases of Hart's straight-line linkage."""

from __future__ import annotations

import numpy as np

from fastlink.mechanisms import catalogue
from tests.extreme.case import Case, Mechanism
from tests.support.hart_configurations import OF_THE_CRANK, WUNDERLICH
from tests.support.hart_configurations import family as drawn


def of_kinds(kinds: tuple[str, ...], full: bool, seed: int) -> list[Case]:
    rng = np.random.default_rng(seed)
    found = []
    for kind in kinds:
        inputs = drawn(kind, rng, 12 if full else 2)
        for i in range(len(inputs["m"])):
            found.append(Case(f"{kind}, {i}", {name: float(values[i]) for name, values in inputs.items()}))
    return found


def toggles(full: bool) -> list[Case]:
    return of_kinds(("toggle 1e-3", "toggle 1e-6", "toggle 1e-9", "toggle 1e-12"), full, 1)


def change_points(full: bool) -> list[Case]:
    return of_kinds(
        ("gap 1e-1", "gap 1e-8", "gap 1e-15", "gap 0", "kite 0", "kite 1e-9", "folded 1e-9"), full, 2
    )


def ratios(full: bool) -> list[Case]:
    kinds = ("kappa 1e-3", "kappa 1e-15", "near 1 1e-3", "near 1 1e-9", "near 1 2e-16", "great")
    return of_kinds(kinds, full, 3)


def scales(full: bool) -> list[Case]:
    found = of_kinds(("scale 1e-20", "scale 1e20"), full, 4)
    for name in "mnd":
        for by in (1e-8, 1e8):
            found.append(
                Case(f"{name} times {by:.0e}", WUNDERLICH | {name: WUNDERLICH[name] * by, "phi": 1.0})
            )
    return found


def angles(full: bool) -> list[Case]:
    places = (0.0, 5e-324, 1e-160, 1e-8, np.pi / 2, -np.pi, 2e6 * np.pi, 1.7e308)
    return [Case(f"phi = {phi:.1e}", WUNDERLICH | {"phi": phi}) for phi in places]


HART = Mechanism(
    catalogue("hart"),
    {
        "toggles": toggles,
        "change points": change_points,
        "ratios": ratios,
        "scales": scales,
        "angles": angles,
    },
    loop="sigma",
    lengths=("m", "n", "d"),
    free=tuple(OF_THE_CRANK),
    # three roundings of MP and PF, which sum to MP + PF
    measures={"F_deviation": 6.0},
)

"""The planar 4R's 9x9 by LU next to toggles, and its refined extremes in extreme designs."""

from __future__ import annotations

import numpy as np

import fastlink as fl
from fastlink.facts.fact import System
from fastlink.facts.fact import parameters as needs_of
from fastlink.numerics.compensated import UNIT_ROUNDING
from tests.extreme.exact import Configuration
from tests.extreme.planar import FOLDED, PLANAR_4R, ULP, scaled
from tests.support.configurations import LENGTHS, PLANAR

DENSE = PLANAR.variants["dense"]["T41"]
assert isinstance(DENSE, System)


def test_the_dense_solve_is_right_to_its_condition_number_next_to_toggles():
    """Errors of the matrix' entries, of LU (backward stable, of growth 2 or less here) and of the right-hand side."""
    cases = [case for case in PLANAR_4R.families["toggles"](False) if "inside" in case.name]
    inputs = {name: np.array([case.inputs[name] for case in cases]) for name in cases[0].inputs}
    seen = 0
    for branch in (1.0, 2.0):
        found = fl.evaluate(
            "planar_4r", DENSE.unknowns, branch=np.full(len(cases), branch), solver="dense", **inputs
        )
        for i, case in enumerate(cases):
            names = (*DENSE.unknowns, *needs_of(DENSE.function))
            exact = Configuration(PLANAR, names, case.inputs | {"branch": branch}, {}).values
            rows = np.array(DENSE.function(*(float(exact[need]) for need in DENSE.depends_on)))
            inverse, x = np.linalg.inv(rows[:, :9]), np.array([float(exact[name]) for name in DENSE.unknowns])
            # Entries are differences of lengths up to twice their size; pivoting mixes the rows.
            disturbed = np.max(2.0 * abs(rows[:, :9]) @ abs(x) + 4.0 * abs(rows[:, 9]))
            bound = 16 * UNIT_ROUNDING * np.sum(abs(inverse), axis=1) * disturbed
            error = abs(np.array([float(found[name][i]) for name in DENSE.unknowns]) - x)
            assert np.all(error <= bound), case.name
            seen += 1
    assert seen == len(cases) * 2


# -- extremes --------------------------------------------------------------------------------------------------

NAMES = ("omega4", "transmission_angle")
KINDS = {"max": 1.0, "min": -1.0}
#: Dense at the folded positions, where extremes of such designs crowd.
ANGLES = np.concatenate([np.geomspace(1e-17, 3.0, 400), np.linspace(0.01, 3.1, 200)])
ANGLES = np.concatenate([sign * (about + ANGLES) for sign in (-1, 1) for about in (0.0, -np.pi)])


def designs() -> np.ndarray:
    """Cranks next to change points, of extreme scale and proportion, and rockers."""
    sizes = (1e-1, 1e-4, 1e-8, 1e-12, 4 * ULP, ULP, 0.0)
    gapped = [(a + gap, b, c, d) for (a, b, c, d), _ in FOLDED.values() for s in sizes for gap in (s, -s)]
    crank = (0.375, 1.1, 0.8, 0.9)
    others = [scaled(crank, 1e20), scaled(crank, 1e-20), (1e-8, 1.1, 0.8, 0.9)]
    others += [
        (1.0, 3.0, 2.0, 1e-8),
        (1.0, 1.0 + 1e-8, 1.0, 1.0 - 1e-9),
        (2.0, 1.0, 2.5, 3.0),
        (9.0, 1.0, 1.0, 1.0),
    ]
    return np.array(gapped + others).T


def test_refined_extremes_are_attained_and_nothing_exceeds_them():
    lengths = dict(zip(LENGTHS, designs(), strict=True))
    asked = [name for of in NAMES for kind in KINDS for name in (f"{of}_{kind}", f"theta1_at_{of}_{kind}")]
    swept = fl.sweep("planar_4r", fl.table(lengths | {"omega1": np.full(designs().shape[1], 25.0)}), asked)
    columns = {name: values[:, None] for name, values in lengths.items()} | {"omega1": 25.0}
    flags = PLANAR.facts["status"].flags
    states = [flags[int(code)] for code in swept["status"].values]
    assert set(states) == set(flags.values()) - {"invalid_input", "beyond_range", "assembles_in_one_position"}
    for k, branch in enumerate((1.0, 2.0)):
        curves = fl.evaluate("planar_4r", NAMES, branch=branch, theta1=ANGLES[None, :], **columns)
        for of in NAMES:
            # Relative to the greatest value twelve operations on factors right to a rounding each: 40 at most.
            rounding = 40 * UNIT_ROUNDING * np.nanmax(abs(curves[of]), axis=1, initial=0.0)
            for kind, sign in KINDS.items():
                extreme, place = (
                    swept[f"{of}_{kind}"].values[:, k],
                    swept[f"theta1_at_{of}_{kind}"].values[:, k],
                )
                missing = np.array([state == "never_assembles" for state in states])
                np.testing.assert_array_equal(np.isnan(extreme), missing)
                most = np.nanmax(sign * curves[of], axis=1, initial=-np.inf)
                assert np.all((sign * extreme + rounding >= most) | missing), (of, kind)
                turns = np.array([state == "rotates_fully" for state in states])
                assert np.all(np.isfinite(extreme[turns]))
                steps = place[:, None] + np.spacing(np.pi) * np.arange(-4.0, 5.0)
                at = {"branch": branch, "theta1": steps, "allow_invalid": True, **columns}
                about = fl.evaluate("planar_4r", [of], **at)[of]
                low, high = np.min(about, axis=1) - rounding, np.max(about, axis=1) + rounding
                assert np.all(((extreme >= low) & (extreme <= high))[turns]), (of, kind)

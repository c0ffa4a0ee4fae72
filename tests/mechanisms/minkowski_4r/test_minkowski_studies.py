"""The studies of the Minkowskian 4R: every number of section 3.7 of the paper, and the atlas at reduced size."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import fastlink as fl
from fastlink.mechanisms.minkowski_4r.types import LINKAGE_FLAGS
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.study.study import run_study

STUDIES = Path(__file__).parents[3] / "data" / "studies"

#: As printed, with what half a unit of the last digit printed is worth ("1.6666" and "0.71428" are cut, not rounded).
EXACT, CUT = 1e-15, 1e-4
PRINTED = {
    "cosh_theta_min": ((1.625, EXACT), (1.0, EXACT), (-4.0, EXACT), (-1.6666, CUT)),
    "cosh_theta_max": ((2.125, EXACT), (1.6666, CUT), (1.0, EXACT), (0.71428, 1e-5)),
    "cosh_psi_min": ((-2.125, EXACT), (1.0, EXACT), (-0.25, EXACT), (-1.05714, 1e-5)),
    "cosh_psi_max": ((-1.625, EXACT), (7.0, EXACT), (1.0, EXACT), (-0.2, EXACT)),
    "T1": ((3.0, EXACT), (-0.8, EXACT), (0.0, EXACT), (0.6, EXACT)),
    "T2": ((-3.0, EXACT), (0.8, EXACT), (-3.0, EXACT), (0.4, EXACT)),
    "T3": ((1.0, EXACT), (-1.6, EXACT), (-2.0, EXACT), (-1.4, EXACT)),
    "T4": ((5.0, EXACT), (0.0, EXACT), (5.0, EXACT), (1.6, EXACT)),
    "T5": ((5.0, EXACT), (1.6, EXACT), (1.0, EXACT), (1.8, EXACT)),
    "cosh_theta_branching": ((1.5, EXACT), (np.nan, EXACT), (-5.0, EXACT), (-0.5555, CUT)),
}
TYPES = (
    "strange_superrocker_crank",
    "rigid_rocker_rocker",
    "reducible_crank_crank",
    "irreducible_crank_crank",
)


@pytest.fixture(scope="module")
def examples(tmp_path_factory):
    with run_study(
        STUDIES / "minkowski_examples.toml", to=tmp_path_factory.mktemp("examples") / "e.h5"
    ) as maps:
        return maps.load()


@pytest.mark.parametrize("name", PRINTED)
def test_every_number_of_the_examples(examples, name):
    for found, (printed, allowed) in zip(examples[name].values, PRINTED[name], strict=True):
        # Decimals are a rounding off their doubles, and so is each of three sums and two ratios: below 8 of 1e-16.
        np.testing.assert_allclose(found, printed, rtol=allowed, atol=allowed)


def test_the_types_of_the_examples(examples):
    assert tuple(LINKAGE_FLAGS[int(code)] for code in examples.linkage_type) == TYPES
    np.testing.assert_array_equal(np.isfinite(examples.theta_branching), [True, False, False, False])


def test_the_curves_of_the_examples_are_where_the_paper_says(examples):
    """Figures 9 to 24: assembled up to theta_min and from theta_max on, there in both branches."""
    cosh = np.cosh(examples.theta)
    closes = (cosh <= examples.cosh_theta_min) | (cosh >= examples.cosh_theta_max)
    # At theta = 0 the second example is in line, but for the last bits of its decimals.
    sure = (examples.theta != 0.0) | (examples.design != 1)
    found = np.isfinite(examples.psi).all("branch")
    assert bool((found == closes).where(sure, True).all())
    assert 0 < int(closes[:, 0].sum()) < 401


def test_the_middle_of_the_coupler_traces_the_coupler_curve(examples):
    size = abs(examples.A_x) + abs(examples.B_x) + examples.g
    for name in ("x", "y"):
        middle = (examples[f"A_{name}"] + examples[f"B_{name}"]) / 2
        # Each of the points is some ten roundings off the size of its null coordinates.
        assert float((abs(examples[f"X_{name}"] - middle) / size).max()) <= 32 * UNIT_ROUNDING
    c = fl.minkowski.sextic(*(examples[name].values for name in "abghxy"))
    X, Y = examples.X_x.values, examples.X_y.values
    terms = np.array([c[:, i, j, None, None] * X**i * Y**j for i in range(7) for j in range(7 - i)])
    there = np.isfinite(X)
    assert there.sum() > 2500
    # X and Y are some ten roundings off, and their powers six times that at most.
    assert np.all(np.abs(terms.sum(axis=0))[there] <= 64 * UNIT_ROUNDING * np.abs(terms).sum(axis=0)[there])


def test_the_atlas(tmp_path):
    text = (STUDIES / "minkowski_atlas.toml").read_text(encoding="utf-8")
    assert "128 x 128 x 128" in text
    study = tmp_path / "atlas.toml"
    study.write_text(
        text.replace("linspace = [0.03125, 4.0, 128]", "linspace = [0.25, 4.0, 16]"), encoding="utf-8"
    )
    with run_study(study, to=tmp_path / "atlas.h5") as maps:
        found = maps.load()
    assert found.linkage_type.shape == (16, 16, 16)
    # Multiples of 1/4 are exact: all kinds are there, rigid and reducible ones among them.
    kinds = {LINKAGE_FLAGS[int(code)].partition("_")[0] for code in np.unique(found.linkage_type)}
    assert kinds == {"strange", "rigid", "reducible", "irreducible"}
    a, b, h = np.meshgrid(found.a, found.b, found.h, indexing="ij")
    sides = np.array([a, b, np.ones_like(a), h])
    excess = 2.0 * sides.max(axis=0) - sides.sum(axis=0)
    code = found.linkage_type.values
    np.testing.assert_array_equal(code < 4, excess > 0.0)
    np.testing.assert_array_equal((code >= 4) & (code < 8), excess == 0.0)
    np.testing.assert_array_equal(
        np.isfinite(found.theta_max.values), (1 + b - h - a) * (a + b - 1 - h) < 0.0
    )
    assert set(np.unique(found.assembly_count_future)) == {1, 2, 3}

"""Hart's linkage: the stroke by brute force, the kite, status; its equations are held by the loops (test_loops.py)."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.hart_configurations import HART, OF_THE_CRANK, QUANTITIES, WUNDERLICH, at
from tests.support.sweeps import sweep_both

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

KITE_FLAGS = catalogue("hart").facts["is_kite"].flags
STATUS_FLAGS = catalogue("hart").facts["status"].flags


@pytest.mark.parametrize(
    "design",
    [WUNDERLICH, {"m": 1.0, "n": 8.0, "d": 7.0, "kappa": 0.5}, {"m": 1.0, "n": 1.4, "d": 2.5, "kappa": 0.6}],
)
def test_F_traces_its_stroke_and_assembles_along_it_alone(design):
    """Driven by MA over both branches F covers the segments and nothing else; driven by F it closes there."""
    told = at(["F_y_outer", "F_y_inner", "stroke", "status"], **design)
    outer, inner = float(told["F_y_outer"]), float(told["F_y_inner"])
    two = STATUS_FLAGS[int(told["status"])] == "two_segments"
    assert_allclose(told["stroke"], outer - inner if two else 2.0 * outer, rtol=64 * UNIT_ROUNDING)
    phi = np.linspace(-np.pi, np.pi, 20001)
    y = np.sort(at(["F_y"], branch=np.array([[1.0], [2.0]]), phi=phi, **design)["F_y"], axis=None)
    y = y[np.isfinite(y)]
    # F is off by a few roundings of m sin(phi) and of the toggles: 2^-40 is far more
    assert np.abs(y).max() <= outer * (1.0 + 2.0**-40)
    assert np.abs(y).min() >= inner * (1.0 - 2.0**-40)
    # near a toggle F moves as the root of a step of phi: a hole would be more
    holes = np.diff(np.concatenate([[-outer], y, [outer]])) > 0.05 * outer
    assert holes.sum() == two
    places = np.linspace(-1.01, 1.01, 2000) * outer
    maps = sweep_both("hart", fl.grid(**design), ["phi", "F_x", "P_y"], input="F_y", angles=places)
    inside = (np.abs(places) <= outer) & (np.abs(places) >= inner)
    for name in ("phi", "F_x", "P_y"):
        assert_array_equal(np.isfinite(maps[name]), [inside, inside])
    assert maps.phi.dims == ("branch", "F_y")


def test_the_linkage_of_figures_6_and_7():
    told = at(
        [*"pqabc", "line_x", "is_kite", "stroke", "ellipse_a", "ellipse_b", "grashof_class"], **WUNDERLICH
    )
    # (7.7) with q = -2; F runs from 8 to -8, where M, P, F and N, Q, F are in line
    assert [float(told[name]) for name in "pqabc"] == [4.0, -2.0, 3.0, 6.0, 3.0]
    assert (told["line_x"], told["stroke"], told["ellipse_a"], told["ellipse_b"]) == (0.0, 16.0, 6.0, 2.0)
    assert KITE_FLAGS[int(told["is_kite"])] == "kite_with_m_equal_p"
    assert HART.facts["grashof_class"].flags[int(told["grashof_class"])] == "change_point_kite_a1_a2"


def test_the_study_of_the_example(tmp_path):
    study = Path(__file__).parents[3] / "data" / "studies" / "hart_8.toml"
    with fl.run(study, to=tmp_path / "hart_8.h5") as maps:
        maps.load()
    assert maps.F_deviation.max() <= 3.0
    # sixteen joints of about four roundings each, over the longest bar
    assert maps.closure_residual.max() <= 16 * UNIT_ROUNDING
    assert (maps.F_x == 0.0).all()
    moves = (maps.branch == 2) == (maps.phi < np.pi)
    # at M, C and Z being a rounding apart
    assert abs(maps.F_y.where(~moves)).max() <= 8 * 16 * UNIT_ROUNDING
    # the figures: y = 2 m sin(phi), the ellipse about M; P runs on a circle of 4, twice as low as F
    assert abs(maps.F_y - 8.0 * np.sin(maps.phi)).where(moves).max() <= 32 * UNIT_ROUNDING
    round_M = (maps.PF_mid_x / maps.ellipse_b) ** 2 + (maps.PF_mid_y / maps.ellipse_a) ** 2
    assert abs(round_M - 1.0).where(moves).max() <= 16 * UNIT_ROUNDING


@pytest.mark.parametrize("kappa", [0.1, 0.5, -0.3, 0.9, 1.5, -4.0])
@pytest.mark.parametrize("n", [0.3, 8.0, 1e20])
def test_kites_in_decimals(kappa, n):
    """(7.6) as a user computes it, a few roundings off: a kite, through M; mirrored, through N."""
    small, ground = abs(kappa) * n, abs(1.0 - kappa * kappa) * n
    phi = np.linspace(0.1, 3.0, 9)
    for m, other, kite in ((small, n, 1), (n, small, 2)):
        given = {"m": m, "n": other, "d": ground, "kappa": kappa}
        told = at(["is_kite", "status", "line_x", "stroke", "ellipse_a", "ellipse_b"], **given)
        assert (told["is_kite"], told["status"]) == (kite, 2)
        assert np.isfinite(told["ellipse_a"]) == (kite == 1)
        # the line runs through M or N within the rounding of three lengths
        assert abs(told["line_x"] - (0.0 if kite == 1 else ground)) <= 8 * UNIT_ROUNDING * (
            m + other + ground
        )
        assert_allclose(told["stroke"], 4.0 * small, rtol=8 * UNIT_ROUNDING)
        if kite == 1:
            found = at(["PF_mid_x", "PF_mid_y", "F_y"], branch=np.array([[1], [2]]), phi=phi, **given)
            moves = np.abs(found["F_y"]) > 1e-6 * small  # in the other branch F stays at M
            assert moves.sum() == phi.size
            x, y = found["PF_mid_x"] / told["ellipse_b"], found["PF_mid_y"] / told["ellipse_a"]
            # the lengths are off the kite by 2 roundings, each coordinate by 4
            assert_allclose((x * x + y * y)[moves], 1.0, rtol=32 * UNIT_ROUNDING)


@pytest.mark.parametrize(
    ("status", "changes"),
    [
        ("one_segment", {"d": 5.0}),
        ("two_segments", {"m": 1.0, "n": 8.0, "d": 7.0}),
        ("change_point", {}),
        ("change_point", {"m": 8.0, "n": 8.0, "d": 8.0}),
        ("rigid", {"m": 8.0, "n": 8.0, "d": 24.0}),
        ("rigid", {"m": 1.0, "n": 8.0, "d": 3.5}),
        ("never_assembles", {"d": 18.000001}),
        ("never_assembles", {"d": 1.999999}),
        ("kappa_is_0", {"kappa": 0.0}),
        ("kappa_is_1_or_minus_1", {"kappa": 1.0}),
        ("kappa_is_1_or_minus_1", {"kappa": -1.0}),
        ("invalid_input", {"kappa": 1e70}),
        ("invalid_input", {"kappa": 1e-70}),
        ("invalid_input", {"kappa": np.nan}),
        ("invalid_input", {"d": -6.0}),
        ("invalid_input", {"m": np.inf}),
        ("invalid_input", {"n": 0.0, "kappa": 0.0}),
    ],
)
def test_every_status(status, changes):
    with np.errstate(all="ignore"):
        told = at(["status", *QUANTITIES], phi=1.0, branch=2, **(WUNDERLICH | changes))
    assert STATUS_FLAGS[int(told["status"])] == status
    none = status not in ("one_segment", "two_segments", "change_point", "rigid")
    assert np.isnan(told["stroke"]) == none
    if none:
        assert np.isnan(told["line_x"])
        assert all(np.isnan(told[q]) for q in QUANTITIES if HART.varies(q) and q not in OF_THE_CRANK)
    if none and status != "never_assembles":
        assert all(np.isnan(told[name]) for name in QUANTITIES)


def test_status_agrees_with_the_four_bar():
    """A design assembles, is rigid or not, as the planar 4R of the same lengths does."""
    rng = np.random.default_rng(8)
    m, n, d = rng.integers(1, 12, (3, 4000)).astype(float)
    kappa = rng.choice([0.25, 0.5, 0.75, 1.5, 2.0], 4000) * rng.choice([-1.0, 1.0], 4000)
    with np.errstate(all="ignore"):
        told = at(["status", "grashof_class"], m=m, n=n, d=d, kappa=kappa)
        factor = abs(1.0 - kappa * kappa)
        four = {"a1": factor * m, "a2": abs(kappa) * d, "a3": factor * n, "a4": d}
        bars = fl.evaluate("planar_4r", ["status", "grashof_class"], theta1=1.0, **four)
    assert_array_equal(told["status"] == 4, bars["status"] == 2)
    assert_array_equal(told["grashof_class"], bars["grashof_class"])
    lengths = np.sort([*four.values()], axis=0)
    assert_array_equal(told["status"] == 3, lengths[3] == lengths[:3].sum(axis=0))

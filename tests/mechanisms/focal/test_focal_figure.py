"""The focal mechanism in motion, by either drive: what the paper says of its figure holds, joint by joint.

Its formulas are held by the loops (tests/precision/test_loops.py), its digits by the rule of all mechanisms.
"""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.focal_configurations import DRIVES, family, random_designs

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

CIRCLES = ("PFQX", "SFTY", "PSQT")
JOINTS = "ABPQFTX"
NAMES = [
    *(f"{joint}_{axis}" for joint in JOINTS for axis in "xy"),
    *("S_x", "Y_x", "r", "FT", "m", "n", "p", "q", "closure_residual", "F_path_residual", "F_x_error"),
    *("omega_angle", "alpha", "beta", "chi", "transmission_angle_P", "transmission_angle_Q"),
    *(f"{points}_{part}" for points in CIRCLES for part in ("x", "y", "radius")),
    *(f"{joint}_{way}_AB" for joint in "MNSF" for way in ("along", "across")),
]


class Figure:
    """Joints as complex numbers, and all that is computed, by name, of configurations that close."""

    def __init__(self, drive):
        inputs = family(drive, "random", np.random.default_rng(11), 9000)
        found = fl.evaluate("focal", NAMES, input=drive, **inputs)
        closes = np.all([np.isfinite(found[name]) for name in ("B_x", "F_x", "S_x")], axis=0)
        assert closes.sum() > 1000
        self.values = {name: np.asarray(value)[closes] for name, value in (inputs | found).items()}
        self.points = {joint: self[f"{joint}_x"] + 1j * self[f"{joint}_y"] for joint in JOINTS}
        self.points |= {
            "M": 0j * self["d"],
            "N": self["d"] + 0j,
            "S": self["S_x"] + 0j,
            "Y": self["Y_x"] + 0j,
        }
        self.size = np.max([np.abs(self.points[joint]) for joint in "ABPQFTSN"], axis=0)

    def __getitem__(self, name):
        return self.values[name]

    def of(self, joints):
        return [self.points[joint] for joint in joints]


@pytest.fixture(scope="module", params=DRIVES)
def figure(request):
    return Figure(request.param)


def assert_zero(value, *sizes):
    """Assert that a sum of products is zero to the roundings of its factors: points of a size each."""
    assert (np.abs(value) <= 200 * UNIT_ROUNDING * np.prod(sizes, axis=0)).all()


def test_every_bar_and_both_ratios_close_in_every_branch_and_F_stays_on_its_circle(figure):
    for completion in (1, 2):
        for branch in (1, 2):
            assert ((figure["completion"] == completion) & (figure["branch"] == branch)).sum() > 30
    # a point is a sum of two bars whose directions are the products of five; each is some roundings off
    assert figure["closure_residual"].max() <= 30 * UNIT_ROUNDING
    # F is some roundings of the bars off, and as many more as P is far away: w then is told by small angles
    size = np.max([np.abs(figure[name]) for name in (*"abcdmnpqr", "S_x", "FT")], axis=0)
    far = size / np.maximum(figure["a"], figure["d"])
    assert (figure["F_path_residual"] <= 30 * UNIT_ROUNDING * size * far).all()


def test_triangles_are_similar_and_omega_is_the_same_at_both(figure):
    """MPF ~ FQB and NQF ~ FPA, turned over; (1.1): the angle at P and that at Q are supplementary."""
    M, N, A, B, P, Q, F = figure.of("MNABPQF")
    assert_zero((F - P) * np.conj(F - Q) - (M - P) * np.conj(B - Q), figure.size, figure.size)
    assert_zero((F - Q) * np.conj(F - P) - (N - Q) * np.conj(A - P), figure.size, figure.size)
    at_P, at_Q = (F - P) * np.conj(M - P), (F - Q) * np.conj(N - Q)
    assert_zero((at_P * np.conj(at_Q)).imag, *[figure.size] * 4)
    w = np.exp(1j * figure["omega_angle"])
    assert_zero(at_P - figure["m"] * figure["p"] * w, figure.size, figure.size)
    assert_zero(at_Q + figure["n"] * figure["q"] * w, figure.size, figure.size)


def test_the_rockers_keep_the_relation_of_the_paper(figure):
    """(2.2), which holds of m, n, p, q what (2.4) does of a, b, c."""
    m, n, p, q, d = (figure[name] for name in "mnpqd")
    u, v = figure.points["A"] / figure["a"], (figure.points["B"] - d) / figure["b"]
    left = 2.0 * ((m * n + p * q) * (u * np.conj(v)).real + m * d * u.real - n * d * v.real)
    assert_zero(left - (m * m + n * n - p * p - q * q + d * d), figure.size, figure.size)


def test_the_quadrangles_of_section_4_are_similar(figure):
    """MPFS ~ FQBT and NQFS ~ FPAT, turned over."""
    for one, other in (("MPFS", "FQBT"), ("NQFS", "FPAT")):
        sides = [corner - figure.points[one[1]] for corner in figure.of(one)]
        images = [corner - figure.points[other[1]] for corner in figure.of(other)]
        for k in (2, 3):
            assert_zero(sides[0].conj() * images[k] - sides[k].conj() * images[0], figure.size, figure.size)


@pytest.mark.parametrize("points", CIRCLES)
def test_four_points_are_as_far_from_the_centre_as_the_radius(figure, points):
    """Section 4: P, S, Q, T; P, F, Q, X; S, F, T, Y."""
    centre, radius = figure[f"{points}_x"] + 1j * figure[f"{points}_y"], figure[f"{points}_radius"]
    # a centre moves more than the points by the inverse of the angles in the circle
    one, two, three = figure.of(points[:3])
    sides = [np.abs(one - two), np.abs(two - three), np.abs(three - one)]
    condition = np.maximum(1.0, figure.size / np.min(sides, axis=0)) ** 2
    for joint in points:
        # every point and the centre are some ten roundings of the joints, and of the radius, off
        off = np.abs(np.abs(figure.points[joint] - centre) - radius)
        far = np.abs(figure.points[joint]) + figure.size + radius
        assert (off <= 30 * UNIT_ROUNDING * far * condition).all(), joint


def test_X_and_Y_lie_on_both_their_sides(figure):
    """Of X and Y, which are infinite where the sides are parallel, over their distance."""
    A, B, N, X, Y = figure.of("ABNXY")
    for point, start, end in ((X, 0 * A, A), (X, N, B), (Y, A, B)):
        area = ((end - start) * np.conj(point - start)).imag
        # off by roundings of the point's distance, over the sine of the angle of both sides: of its distance again
        assert (np.abs(area) <= 30 * UNIT_ROUNDING * (np.abs(point) + figure.size) ** 2).all()


def test_angles_are_those_of_the_figure(figure):
    """(4.1) to (4.4), and (3.1): BQF = MPF and FPA = FQN, by the points."""
    M, N, A, B, P, Q, F = figure.of("MNABPQF")
    for name, apex, start, end in (
        *(("beta", F, P, M), ("beta", B, F, Q), ("alpha", F, N, Q), ("alpha", A, P, F), ("chi", F, A, M)),
    ):
        turned = (end - apex) * np.conj(start - apex) * np.exp(-1j * figure[name])
        assert_zero(turned.imag, figure.size, figure.size)
        assert (turned.real >= -200 * UNIT_ROUNDING * figure.size**2).all()
    other = np.where(figure["rho"] > 0.0, np.pi, 0.0) - figure["chi"]
    assert_zero(((B - F) * np.conj(N - F) * np.exp(-1j * other)).imag, figure.size, figure.size)
    for name, corners in (
        ("transmission_angle_P", ((M, P, F), (B, Q, F))),
        ("transmission_angle_Q", ((N, Q, F), (F, P, A))),
    ):
        for one, apex, other in corners:
            enclosed = np.abs(np.angle((one - apex) * np.conj(other - apex)))
            shorter = np.minimum(np.abs(one - apex), np.abs(other - apex))
            assert (np.abs(enclosed - figure[name]) <= 30 * UNIT_ROUNDING * figure.size / shorter).all()


def test_opposite_sides_are_seen_from_F_at_angles_of_sum_0_or_pi(figure):
    """(4.4) and (4.7): AFM + NFB and MFN + BFA, as directed angles of lines."""
    M, N, A, B, F = figure.of("MNABF")
    nearest = np.min([np.abs(F - corner) for corner in (M, N, A, B)], axis=0)
    for corners in ((A, M, N, B), (M, N, B, A)):
        one, two, three, four = (corner - F for corner in corners)
        # four directions, each off by roundings of its ends over their distance
        off = np.abs(np.sin(np.angle(two * np.conj(one) * four * np.conj(three))))
        assert (off <= 60 * UNIT_ROUNDING * figure.size / nearest).all()


def test_seen_from_AB_joints_are_turned_and_F_runs_on_a_circle_about_T(figure):
    """Section 3: with AB held fixed, T divides AB as S divides MN, and does not move there."""
    A, B, T = figure.of("ABT")
    for joint in "MNSF":
        seen = figure[f"{joint}_along_AB"] + 1j * figure[f"{joint}_across_AB"]
        turned = (figure.points[joint] - A) * np.conj(B - A) / figure["c"]
        # the direction of AB is off by roundings of A and B over its length
        far = figure.size * (1.0 + np.abs(figure.points[joint] - A) / figure["c"])
        assert (np.abs(seen - turned) <= 40 * UNIT_ROUNDING * far).all(), joint
    along = ((T - A) * np.conj(B - A)).real / figure["c"]
    reach = np.hypot(figure["F_along_AB"] - along, figure["F_across_AB"])
    far = figure.size * (1.0 + figure.size / figure["c"])
    assert (np.abs(reach - figure["FT"]) <= 60 * UNIT_ROUNDING * far).all()


def test_with_rho_minus_1_F_runs_along_lines_perpendicular_to_MN_and_to_AB():
    """Section 7: T is at infinity. Of the other completion lambda is 0: it has no P."""
    design = {"a": 1.2, "b": 0.9, "c": 0.8, "d": 1.1, "rho": -1.0, "completion": 2}
    names = ["F_along_AB", "F_across_AB", "line_along_AB", "line_x", "F_x", "F_path_residual", "lambda_"]
    found = fl.evaluate("focal", names, **design, phi=np.linspace(-3.0, 3.0, 400))
    moves = np.isfinite(found["F_x"])
    assert moves.sum() > 100
    assert np.ptp(found["F_across_AB"][moves]) > 0.5
    # sums of three lengths of at most 4, each some roundings off
    np.testing.assert_allclose(found["F_along_AB"][moves], found["line_along_AB"][moves], rtol=0, atol=2e-14)
    np.testing.assert_allclose(found["F_x"][moves], found["line_x"][moves], rtol=0, atol=4e-15)
    assert np.nanmax(found["F_path_residual"]) <= 30 * UNIT_ROUNDING
    # AB held fixed, MN moves: (7.5) with c and d exchanged, and lambda/(lambda - 1) for lambda
    other = float(found["lambda_"][0]) / (float(found["lambda_"][0]) - 1.0)
    place = 0.4 + (1.2**2 - 0.9**2) / (2.0 * 0.8 * other)
    assert abs(found["line_along_AB"][0] - place) <= 1e-15


def test_the_graphic_solution_of_figure_4():
    """Section 6: the angles are right ones, ST is a diameter of the circle SPTQ, and 2 r is h1 - h2."""
    names = ["omega_angle", "chi", "PSQT_radius", "T_x", "T_y", "S_x", "r", "h1", "h2", "F_x"]
    for a, c, d in ((5.0, 2.0, 4.0), (3.0, 1.0, 2.5), (2.0, 0.7, 1.9)):
        given = {"a": a, "b": a, "c": c, "d": d, "rho": 1.0, "completion": 1}
        found = fl.evaluate("focal", names, **given, phi=np.arccos(0.5 * (d - c) / a), branch=2)
        at = {name: float(value) for name, value in found.items()}
        # angles that phi determines to some ten roundings
        assert abs(abs(at["omega_angle"]) - 0.5 * np.pi) <= 30 * UNIT_ROUNDING
        assert abs(abs(at["chi"]) - 0.5 * np.pi) <= 100 * UNIT_ROUNDING
        assert abs(at["F_x"] - 0.5 * d) <= 10 * UNIT_ROUNDING * d
        diameter = np.hypot(at["T_x"] - at["S_x"], at["T_y"])
        assert abs(2.0 * at["PSQT_radius"] - diameter) <= 30 * UNIT_ROUNDING * a
        assert abs(2.0 * at["r"] - (at["h1"] - at["h2"])) <= 10 * UNIT_ROUNDING * a


# -- motion -------------------------------------------------------------------------------------------------------


def with_bounds(names):
    return [*names, *(f"{name}_error" for name in names)]


def test_the_crank_turns_without_a_jump_of_branch():
    """Whole turns: from sample to sample the rockers move as their rates say, and come back."""
    designs = random_designs(np.random.default_rng(6), 4000)
    kind = fl.evaluate("focal", ["crank_type"], phi=1.0, **designs)["crank_type"]
    turning = {name: values[kind == 0][:100, None] for name, values in designs.items()}
    assert turning["a"].shape == (100, 1)
    sigma = np.linspace(-np.pi, np.pi, 1441)
    names = [*with_bounds(["phi", "psi"]), "dphi_dsigma", "dpsi_dsigma", "omega_angle", "closure_residual"]
    found = fl.evaluate("focal", names, input="sigma", sigma=sigma, **turning)
    step = sigma[1] - sigma[0]
    assert np.isfinite(found["closure_residual"]).all()
    assert (np.diff(np.sign(found["omega_angle"]), axis=1) == 0.0).all()
    for name in ("phi", "psi"):
        rate = found[f"d{name}_dsigma"]
        moved = np.angle(np.exp(1j * np.diff(found[name], axis=1)))
        bends = np.abs(np.diff(rate, axis=1))
        around = bends + np.roll(bends, 1, axis=1) + np.roll(bends, -1, axis=1)
        # the rate between two samples is within what it changes by from those before to those after
        off = np.abs(moved - 0.5 * step * (rate[:, 1:] + rate[:, :-1]))
        lost = found[f"{name}_error"]
        # and angles have their errors, those within (-pi, pi] a rounding of pi more
        assert (off <= step * around + lost[:, 1:] + lost[:, :-1] + 8 * np.pi * UNIT_ROUNDING).all()
        # pi and -pi are two roundings apart from being a whole turn
        first, last = found[name][:, 0], found[name][:, -1]
        allowed = lost[:, 0] + lost[:, -1] + (np.abs(rate[:, 0]) + 4.0) * 2 * np.pi * UNIT_ROUNDING
        assert (np.abs(np.exp(1j * first) - np.exp(1j * last)) <= allowed).all()


# -- sweeps -------------------------------------------------------------------------------------------------------


def test_extremes_of_what_passes_infinity_are_those_of_the_given_positions():
    """MA and NB of this four-bar are parallel somewhere: no smooth curve leads from one extreme of X to the other."""
    space = fl.grid(a=1.2, b=0.9, c=2.0, d=2.3, rho=0.7, completion=1)
    maps = fl.sweep("focal", space, ["X_x", "X_x_max", "Y_x", "Y_x_min"], branch=(1, 2))
    np.testing.assert_array_equal(maps.X_x_max, maps.X_x.max("phi"))
    np.testing.assert_array_equal(maps.Y_x_min, maps.Y_x.min("phi"))

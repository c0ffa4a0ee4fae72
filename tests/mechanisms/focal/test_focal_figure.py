"""Points, circles and angles that the paper draws beside the mechanism, and the motion with AB held fixed."""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.focal_configurations import DRIVES, family

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

CIRCLES = ("PFQX", "SFTY", "PSQT")
JOINTS = ("A", "B", "P", "Q", "F", "T", "X")
NAMES = [
    *(f"{joint}_{axis}" for joint in JOINTS for axis in "xy"),
    *("S_x", "Y_x", "transmission_angle_P", "transmission_angle_Q", "F_x_error"),
    *(f"{points}_{part}" for points in CIRCLES for part in ("x", "y", "radius")),
    *(f"{joint}_{way}_AB" for joint in "MNSF" for way in ("along", "across")),
]


class Figure:
    """Joints as complex numbers, and all that is computed, by name."""

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


@pytest.fixture(scope="module", params=DRIVES)
def figure(request):
    return Figure(request.param)


@pytest.mark.parametrize("points", CIRCLES)
def test_four_points_are_as_far_from_the_centre_as_the_radius(figure, points):
    """Section 4: P, S, Q, T; P, F, Q, X; S, F, T, Y."""
    centre, radius = figure[f"{points}_x"] + 1j * figure[f"{points}_y"], figure[f"{points}_radius"]
    for joint in points:
        # every point and the centre are some ten roundings of the joints, and of the radius, off
        off = np.abs(np.abs(figure.points[joint] - centre) - radius)
        far = np.abs(figure.points[joint]) + figure.size + radius
        assert (off <= 30 * UNIT_ROUNDING * far * condition(figure, points)).all(), joint


def condition(figure, points):
    """By how much a centre moves more than the points: the inverse of the angles in the circle."""
    one, two, three = (figure.points[joint] for joint in points[:3])
    sides = [np.abs(one - two), np.abs(two - three), np.abs(three - one)]
    return np.maximum(1.0, figure.size / np.min(sides, axis=0)) ** 2


def test_X_and_Y_lie_on_both_their_sides(figure):
    """Of X and Y, which are infinite where the sides are parallel, over their distance."""
    A, B, N, X, Y = (figure.points[joint] for joint in "ABNXY")
    for point, start, end in ((X, 0 * A, A), (X, N, B), (Y, A, B)):
        area = ((end - start) * np.conj(point - start)).imag
        # off by roundings of the point's distance, over the sine of the angle of both sides: of its distance again
        assert (np.abs(area) <= 30 * UNIT_ROUNDING * (np.abs(point) + figure.size) ** 2).all()


def test_the_angles_of_3_1_are_those_of_1_1(figure):
    """(3.1): BQF = MPF and FPA = FQN, by the points."""
    A, B, P, Q, F, M, N = (figure.points[joint] for joint in "ABPQFMN")
    for name, corners in (
        ("transmission_angle_P", ((M, P, F), (B, Q, F))),
        ("transmission_angle_Q", ((N, Q, F), (F, P, A))),
    ):
        for one, apex, other in corners:
            enclosed = np.abs(np.angle((one - apex) * np.conj(other - apex)))
            shorter = np.minimum(np.abs(one - apex), np.abs(other - apex))
            assert (np.abs(enclosed - figure[name]) <= 30 * UNIT_ROUNDING * figure.size / shorter).all()


def test_the_quadrangles_of_section_4_are_similar(figure):
    """MPFS ~ FQBT and NQFS ~ FPAT, turned over."""
    points = figure.points
    for one, other in (("MPFS", "FQBT"), ("NQFS", "FPAT")):
        sides = [points[corner] - points[one[1]] for corner in one]
        images = [points[corner] - points[other[1]] for corner in other]
        for k in (2, 3):
            turned = sides[0].conj() * images[k] - sides[k].conj() * images[0]
            # products of two vectors, each some ten roundings of the joints off
            assert (np.abs(turned) <= 100 * UNIT_ROUNDING * figure.size**2).all(), (one, k)


def test_the_graphic_solution_of_figure_4():
    """Section 6: the angles are right ones, ST is a diameter of the circle SPTQ, and 2 r is h1 - h2."""
    names = ["omega_angle", "chi", "PSQT_radius", "T_x", "T_y", "S_x", "r", "h1", "h2", "F_x"]
    for a, c, d in ((5.0, 2.0, 4.0), (3.0, 1.0, 2.5), (2.0, 0.7, 1.9)):
        phi = np.arccos(0.5 * (d - c) / a)
        given = {"a": a, "b": a, "c": c, "d": d, "rho": 1.0, "completion": 1}
        at = {
            name: float(value)
            for name, value in fl.evaluate("focal", names, **given, phi=phi, branch=2).items()
        }
        # angles that phi determines to some ten roundings
        assert abs(abs(at["omega_angle"]) - 0.5 * np.pi) <= 30 * UNIT_ROUNDING
        assert abs(abs(at["chi"]) - 0.5 * np.pi) <= 100 * UNIT_ROUNDING
        assert abs(at["F_x"] - 0.5 * d) <= 10 * UNIT_ROUNDING * d
        assert (
            abs(2.0 * at["PSQT_radius"] - np.hypot(at["T_x"] - at["S_x"], at["T_y"]))
            <= 30 * UNIT_ROUNDING * a
        )
        assert abs(2.0 * at["r"] - (at["h1"] - at["h2"])) <= 10 * UNIT_ROUNDING * a


def test_opposite_sides_are_seen_from_F_at_angles_of_sum_0_or_pi(figure):
    """(4.4) and (4.7): AFM + NFB and MFN + BFA, as directed angles of lines."""
    M, N, A, B, F = (figure.points[joint] for joint in "MNABF")
    nearest = np.min([np.abs(F - corner) for corner in (M, N, A, B)], axis=0)
    for corners in ((A, M, N, B), (M, N, B, A)):
        one, two, three, four = (corner - F for corner in corners)
        turned = two * np.conj(one) * four * np.conj(three)
        # four directions, each off by roundings of its ends over their distance
        off = np.abs(np.sin(np.angle(turned)))
        assert (off <= 60 * UNIT_ROUNDING * figure.size / nearest).all()


def test_joints_seen_from_AB_are_those_of_the_ground_turned(figure):
    A, B = figure.points["A"], figure.points["B"]
    for joint in "MNSF":
        seen = figure[f"{joint}_along_AB"] + 1j * figure[f"{joint}_across_AB"]
        turned = (figure.points[joint] - A) * np.conj(B - A) / figure["c"]
        # the direction of AB is off by roundings of A and B over its length
        far = figure.size * (1.0 + np.abs(figure.points[joint] - A) / figure["c"])
        assert (np.abs(seen - turned) <= 40 * UNIT_ROUNDING * far).all(), joint


def test_with_AB_held_F_runs_on_a_circle_about_T(figure):
    """Section 3: T divides AB as S divides MN, and does not move there."""
    T = figure.points["T"]
    along = ((T - figure.points["A"]) * np.conj(figure.points["B"] - figure.points["A"])).real / figure["c"]
    FT = np.abs(figure.points["F"] - T)
    reach = np.hypot(figure["F_along_AB"] - along, figure["F_across_AB"])
    far = figure.size * (1.0 + figure.size / figure["c"])
    assert (np.abs(reach - FT) <= 60 * UNIT_ROUNDING * far).all()


def test_with_rho_minus_1_F_runs_along_a_line_perpendicular_to_AB():
    """Section 7: T is at infinity."""
    design = {"a": 1.2, "b": 0.9, "c": 0.8, "d": 1.1, "rho": -1.0, "completion": 2}
    names = ["F_along_AB", "F_across_AB", "line_along_AB", "line_x", "F_x"]
    found = fl.evaluate("focal", names, **design, phi=np.linspace(-3.0, 3.0, 400))
    moves = np.isfinite(found["F_x"])
    assert moves.sum() > 100
    assert np.ptp(found["F_across_AB"][moves]) > 0.5
    # sums of three lengths of at most 4, each some roundings off
    np.testing.assert_allclose(found["F_along_AB"][moves], found["line_along_AB"][moves], rtol=0, atol=2e-14)
    # AB held fixed, MN moves: (7.5) with c and d exchanged, and lambda/(lambda - 1) for lambda
    lengths = fl.evaluate("focal", ["lambda_"], **design, phi=0.0)
    other = float(lengths["lambda_"]) / (float(lengths["lambda_"]) - 1.0)
    place = 0.4 + (1.2**2 - 0.9**2) / (2.0 * 0.8 * other)
    assert abs(found["line_along_AB"][0] - place) <= 1e-15


def test_extremes_of_what_passes_infinity_are_those_of_the_given_positions():
    """MA and NB of this four-bar are parallel somewhere: no smooth curve leads from one extreme of X to the other."""
    maps = fl.sweep(
        "focal",
        fl.grid(a=1.2, b=0.9, c=2.0, d=2.3, rho=0.7, completion=1),
        ["X_x", "X_x_max", "Y_x", "Y_x_min"],
    )
    np.testing.assert_array_equal(maps.X_x_max, maps.X_x.max("phi"))
    np.testing.assert_array_equal(maps.Y_x_min, maps.Y_x.min("phi"))


def test_where_the_dyads_do_not_close_there_is_no_frame_of_AB():
    """By the crank MPF and NQF must reach the end of the crank, in a triangle each; else F and AB have no place."""
    seen = [f"{joint}_{way}_AB" for joint in "MNSF" for way in ("along", "across")]
    design = {"a": 1.3757, "b": 1.7453, "c": 0.6526, "d": 1.1454, "rho": -0.7693, "completion": 2}
    sigma = np.linspace(-3.0, 3.0, 50)
    bars = fl.evaluate("focal", ["S_x", *"rmnpq"], input="sigma", sigma=sigma, **design)
    end = bars["S_x"] + bars["r"] * np.exp(1j * sigma)
    closes = np.ones(50, dtype=bool)
    for pivot, one, other in ((0.0, "m", "p"), (design["d"], "n", "q")):
        one, other = abs(bars[one]), abs(bars[other])
        closes &= (abs(one - other) <= abs(end - pivot)) & (abs(end - pivot) <= one + other)
    assert 0 < closes.sum() < 50
    found = fl.evaluate("focal", ["F_x", "F_y", "B_x", *seen], input="sigma", sigma=sigma, **design)
    for name, values in found.items():
        np.testing.assert_array_equal(np.isfinite(values), closes, err_msg=name)

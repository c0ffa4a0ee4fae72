"""From a point of the focal cubic to the mechanism, the best point, the five-bar, and AB held in place of MN."""

from fractions import Fraction

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.focal_configurations import positions
from tests.support.refusals import refused

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision.reference import CONTEXT as MP

POSITION = ("a", "b", "c", "d", "phi", "branch")


@pytest.fixture(scope="module")
def known():
    """Designs by rho in positions in which they close, with F and lambda."""
    return positions(1, 3000, "F_x", "F_y", "lambda_")


@pytest.mark.parametrize("by", ["rho", "s", "lambda_"])
def test_from_the_F_of_a_mechanism_it_finds_that_mechanism(known, by):
    made = fl.focal.from_point(*(known[name] for name in POSITION), x=known["F_x"], y=known["F_y"], by=by)
    if by == "rho":
        assert_array_equal(made.design["completion"], known["completion"])
    expected = {
        "rho": known["rho"],
        "s": known["d"] * known["rho"] / (1 + known["rho"]),
        "lambda_": known["lambda_"],
    }
    # a product of four distances of F, each off by its roundings over the distance
    F = known["F_x"] + 1j * known["F_y"]
    A, B = (made.values[f"{joint}_x"] + 1j * made.values[f"{joint}_y"] for joint in "AB")
    size = np.max([np.abs(F), np.abs(B), known["a"], known["d"]], axis=0)
    near = np.min([np.abs(F), np.abs(F - known["d"]), np.abs(F - A), np.abs(F - B)], axis=0)
    steep = 1.0 if by != "s" else 1.0 + 1.0 / np.abs(1.0 + known["rho"])
    off = np.abs(made.design[by] / expected[by] - 1.0)
    if by == "lambda_":
        off = off * np.abs(known["lambda_"] / (known["lambda_"] - 1.0))
    assert (off <= 100 * UNIT_ROUNDING * (size / near) * steep).all()
    assert (made.values["status"] == 0).all()
    for name in ("m", "n", "p", "q", "r", "FT", "T_x", "P_y", "Q_x"):
        assert np.isfinite(made.values[name]).all(), name
    # F by the design: both completions meet where its digits are lost
    back = np.hypot(made.values["F_x"] - known["F_x"], made.values["F_y"] - known["F_y"])
    assert np.median(back) <= 10 * UNIT_ROUNDING
    assert (back <= 1e-8 * size).all()


def test_the_ratios_are_those_of_the_triangles_in_exact_arithmetic():
    """A rational cubic: a kite with its corners in whole numbers has its circle, with rational points on it."""
    # M = (0, 0), A = (0, 2), B = (2, 2), N = (2, 0): any point of a diagonal is on the cubic
    for place in (Fraction(1, 4), Fraction(5, 3), Fraction(-2, 7)):
        F = place, place
        MF, NF, AF, BF = ((F[0] - x) ** 2 + (F[1] - y) ** 2 for x, y in ((0, 0), (2, 0), (0, 2), (2, 2)))
        made = fl.focal.from_point(2.0, 2.0, 2.0, 2.0, np.pi / 2, 2, x=float(place), y=float(place))
        # four distances of points of at most 3, each some roundings off; lambda - 1 of a rounded lambda
        assert abs(float(made.design["rho"]) ** 2 / (AF * MF / (BF * NF)) - 1) <= 40 * UNIT_ROUNDING
        excess = float(made.values["lambda_"]) - 1
        assert abs(excess**2 / (AF * BF / (NF * MF)) - 1) <= 100 * UNIT_ROUNDING * (1 + abs(1 / excess))


def test_the_angles_alone_make_the_same_mechanism_with_50_digits():
    """The paper's way: P and Q by the angles beta at B and alpha at A, (4.1) and (4.2)."""
    one = {name: float(values[3]) for name, values in positions(5, 40, "F_x", "F_y").items()}
    made = fl.focal.from_point(*(one[name] for name in POSITION), x=one["F_x"], y=one["F_y"])
    value = {name: MP.mpf(float(number)) for name, number in made.values.items()}
    F, A, B = (MP.mpc(value[f"{joint}_x"], value[f"{joint}_y"]) for joint in "FAB")
    N = MP.mpf(one["d"])
    # P on MA and Q on NB with PFM = FBN and NFQ = MAF as directed angles of lines
    u, v = A / abs(A), (B - N) / abs(B - N)

    def cut(start, along, angle_of, to):
        """Return where a line through F, turned from `to` by the angle of two lines, meets a side."""
        turned = to * angle_of / abs(angle_of)
        share = (MP.conj(turned) * (F - start)).imag / (MP.conj(turned) * along).imag
        return start + share * along

    P = cut(MP.mpc(0), u, (F - B) / (B - N), F)
    Q = cut(N, v, (F - A) / A, F - N)
    assert abs(P - MP.mpc(value["P_x"], value["P_y"])) <= 1e-12 * (1 + abs(P))
    assert abs(Q - MP.mpc(value["Q_x"], value["Q_y"])) <= 1e-12 * (1 + abs(Q))


def test_of_other_points_the_nearest_point_of_the_cubic_is_taken(known):
    rng = np.random.default_rng(2)
    position = [known[name][:100] for name in POSITION]
    x, y = rng.uniform(-3.0, 3.0, (2, 100))
    made = fl.focal.from_point(*position, x=x, y=y)
    off = np.hypot(made.values["F_x"] - x, made.values["F_y"] - y)
    traced = fl.focal.cubic_points(*position, samples=700)
    least = np.nanmin(np.hypot(traced[..., 0] - x[:, None], traced[..., 1] - y[:, None]), axis=1)
    assert (off <= least * (1.0 + 1e-9)).all()
    # points of an arc are at most some thousandths of its length apart
    assert (off >= least - 0.05 * (1.0 + least)).all()
    # far away the nearest point is next to the asymptote, (V_x, V_y) = MN - AB
    far = fl.focal.from_point(1.0, 2.0, 1.5, 1.9, 0.5, x=-1e5, y=3e3).values
    k = fl.focal.cubic(1.0, 2.0, 1.5, 1.9, 0.5)
    direction = np.array([k[0, 3], -k[3, 0]]) / np.hypot(k[0, 3], k[3, 0])
    across = abs(-1e5 * direction[1] - 3e3 * direction[0])
    assert abs(np.hypot(far["F_x"] + 1e5, far["F_y"] - 3e3) - across) <= 5.0


def test_where_there_is_no_mechanism_the_status_says_why():
    A = 5.0 * np.exp(1.2j)
    at = fl.focal.from_point(5.0, 5.0, 2.0, 4.0, 1.2, 2, x=[0.0, 4.0, A.real], y=[0.0, 0.0, A.imag])
    assert (at.values["status"] == 5).all()  # S_in_M_or_N
    at = fl.focal.from_point(5.0, 5.0, 2.0, 4.0, [1.2, 0.1], x=1.0, y=2.0)
    assert at.values["status"].tolist() == [0, 7]  # the second position does not assemble
    assert np.isnan(at.design["rho"]).tolist() == [False, True]


@pytest.mark.parametrize("name", ["cubic_points", "from_point"])
def test_lengths_may_be_as_unlike_as_each_may_be(name):
    further = {"x": 1.0, "y": 1.0} if name == "from_point" else {"samples": 2}
    getattr(fl.focal, name)(1e-11, 1e12, 1e12, 1e12, 0.5, **further)
    with refused(name, "within a factor of 1e24"):
        getattr(fl.focal, name)(1e-12, 1e13, 1e13, 1e13, 0.5, **further)


def test_no_support_and_no_completion_has_a_greater_least_angle():
    rng = np.random.default_rng(5)
    a, b, c, d = rng.uniform(0.3, 3.0, (4, 60))
    best = fl.focal.best_point(a, b, c, d, 1.0)
    share = np.linspace(0.1, 0.9, 801)[:, None, None]
    given = {"a": a, "b": b, "c": c, "d": d, "s": share * d, "completion": np.array([[1], [2]]), "phi": 0.0}
    every = fl.evaluate("focal", ["transmission_angle_PQ_least", "crank_type"], **given)
    angles = np.where(every["crank_type"] == 0, every["transmission_angle_PQ_least"], 0.0).max(axis=(0, 1))
    found = best.values["transmission_angle_PQ_least"]
    turns = angles > 0.0
    assert turns.sum() > 10
    # an angle and its support are some hundred roundings off
    assert (found[turns] >= angles[turns] - 1e-13).all()
    # from one support to the next it changes by less than this, where it begins with a root by more
    assert np.median(found[turns] - angles[turns]) <= 0.001
    assert (found[turns] <= angles[turns] + 0.05).all()
    assert (best.values["crank_type"][turns] == 0).all()
    assert np.isin(best.values["status"][~turns], (6, 7)).all()


def test_where_the_angles_at_both_ends_are_equal_the_best_is_exact():
    """cos(omega) = (m^2 + p^2 - (s -+ r)^2)/(2 m p) then has two values of one size: m^2 + p^2 = s^2 + r^2."""
    best = fl.focal.best_point(4.0, 5.0, 2.0, 4.0, 1.2, branch=2, by="s").values
    m, p, s, r = (float(best[name]) for name in ("m", "p", "s", "r"))
    # the support is right to 1e-14 of the range, and the squares are at most 10
    assert abs(m * m + p * p - s * s - r * r) <= 1e-12
    cosine = s * r / (m * p)
    assert abs(np.cos(best["transmission_angle_PQ_least"]) - cosine) <= 1e-13


@pytest.mark.parametrize(
    "between", [0.5, (0.9, 0.1), (0.1, np.inf), "s", (0.1, 0.2, 0.3), (-1.7e308, 1.7e308)]
)
def test_limits_are_two_numbers_in_order(between):
    with refused("between", "write"):
        fl.focal.best_point(4.0, 5.0, 2.0, 4.0, 1.2, between=between)


def test_a_design_is_given_by_one_ratio_of_three():
    for function in (
        fl.focal.best_point,
        lambda *position, by: fl.focal.from_point(*position, x=1.0, y=1.0, by=by),
    ):
        with refused("by", "did you mean 'lambda_'"):
            function(4.0, 5.0, 2.0, 4.0, 1.2, by="lambda")
    bars = {"a": 1.2, "b": 0.9, "c": 0.5, "d": 1.1}
    with refused("held_at_AB", "give one of them"):
        fl.focal.held_at_AB(bars)
    with refused("held_at_AB", "leave one of them out"):
        fl.focal.held_at_AB(bars, rho=1.0, s=0.4)


def test_the_five_bar_keeps_its_bars_and_its_angle():
    rng = np.random.default_rng(7)
    m, p, q, n, d = rng.uniform(0.3, 3.0, (5, 4000))
    phi, omega = rng.uniform(-4.0, 4.0, (2, 4000))
    at = fl.focal.five_bar(m, p, q, n, d, phi, omega_angle=omega, branch=rng.integers(1, 3, 4000))
    closes = np.isfinite(at["psi"])
    assert 1000 < closes.sum() < 4000
    P, F, Q = (at[f"{joint}_x"] + 1j * at[f"{joint}_y"] for joint in "PFQ")
    # sums of two bars of at most 3
    for start, end, length in ((0, P, m), (P, F, p), (F, Q, q), (Q, d, n)):
        assert (np.abs(np.abs(end - start) - length) <= 40 * UNIT_ROUNDING)[closes].all()
    turned = (F - P) * np.conj(0 - P) - m * p * np.exp(1j * omega)  # omega from PM to PF
    assert np.abs(turned).max() <= 200 * UNIT_ROUNDING
    enclosed = np.abs(np.angle((F - Q) * np.conj(d - Q)))
    assert (np.abs(enclosed - at["angle_FQN"])[closes] <= 1e-13).all()
    apart = np.abs(Q - d - n * np.exp(1j * at["psi"]))
    assert (apart[closes] <= 40 * UNIT_ROUNDING).all()


def test_with_hart_s_condition_it_is_the_focal_mechanism(known):
    """(1.1): the angles at P and Q have the sum pi."""
    names = ["m", "n", "p", "q", "omega_angle", "psi", "F_x", "F_y", "Q_x", "Q_y", "transmission_angle_Q"]
    given = {name: known[name] for name in (*POSITION, "rho", "completion")}
    found = fl.evaluate("focal", names, **given)
    lengths = (found["m"] > 0.1) & (found["p"] > 0.1) & (np.abs(found["F_x"]) < 10.0)
    given, found = ({name: np.asarray(one)[lengths] for name, one in of.items()} for of in (given, found))
    F, N = found["F_x"] + 1j * found["F_y"], given["d"]
    Q = found["Q_x"] + 1j * found["Q_y"]
    right = ((Q - F) * np.conj(N - F)).imag < 0.0
    sizes = (found[name] for name in "mpqn")
    at = fl.focal.five_bar(
        *sizes, given["d"], given["phi"], omega_angle=found["omega_angle"], branch=np.where(right, 1, 2)
    )
    straight = np.abs(np.sin(found["omega_angle"])) > 0.1
    assert straight.sum() > 300
    # FQ and QN are not in line, so Q is off by the roundings of F over the sine of their angle
    for name in ("F_x", "F_y", "Q_x", "Q_y"):
        assert (np.abs(at[name] - found[name])[straight] <= 1e-12).all(), name
    assert_allclose(at["angle_FQN"][straight], found["transmission_angle_Q"][straight], rtol=0, atol=1e-11)
    assert_allclose(
        np.cos(at["angle_FQN"][straight]), -np.cos(found["omega_angle"][straight]), rtol=0, atol=1e-11
    )


def test_the_four_bar_of_a_five_bar_is_that_of_2_6(known):
    names = ["m", "n", "p", "q", "s", "lambda_"]
    given = {name: known[name] for name in (*POSITION, "rho", "completion")}
    found = fl.evaluate("focal", names, **given)
    m, n, p, q, s, lambda_ = (found[name] for name in names)
    made = fl.focal.from_five_bar(m, n, p, q, known["d"])
    assert_array_equal(made["completion"], known["completion"])
    for name in ("a", "b", "c", "rho"):
        # c^2 is a difference of products; lambda m of lambda near 0 is a sum of 1 and -1
        steep = (1.0 + np.abs(lambda_ - 1.0)) / np.abs(lambda_)
        if name == "c":
            squares = known["a"] ** 2 + known["b"] ** 2 + known["d"] ** 2 * (1 + np.abs(lambda_))
            steep = steep**2 * squares / known["c"] ** 2
        assert (np.abs(made[name] / known[name] - 1.0) <= 100 * UNIT_ROUNDING * steep).all(), name
    # (1.8), s corrected, in plain arithmetic
    total = m * p + n * q
    squared = m**2 * n**2 * (p**2 + q**2) + (m**2 + n**2) * p**2 * q**2
    squared = squared + m * n * p * q * (m**2 + n**2 + p**2 + q**2 - known["d"] ** 2)
    again = fl.evaluate("focal", ["r", "s"], **made, phi=0.0)
    sure = np.abs(total) > 0.1 * (np.abs(m * p) + np.abs(n * q))
    assert (np.abs(again["s"] - m * p * known["d"] / total)[sure] <= 1e-11 * (1 + np.abs(s[sure]))).all()
    assert np.median(np.abs(again["r"] ** 2 / (squared / total**2) - 1.0)[sure]) <= 1e-14
    m, n, d, kappa = 4.0, 8.0, 6.0, 0.5
    made = fl.focal.from_five_bar(m, n, kappa * n, -kappa * m, d)
    assert {name: float(value) for name, value in made.items() if name != "completion"} == {
        "a": 3.0, "b": 6.0, "c": 3.0, "d": 6.0, "rho": -1.0,
    }  # fmt: skip


def test_held_at_AB_it_is_a_focal_mechanism_that_moves_as_seen_from_AB(known):
    """Section 3: the motion of M, N, S and F in the frame of AB is that of A, B, T and F of the other mechanism."""
    names = [f"{joint}_{way}_AB" for joint in "MNSF" for way in ("along", "across")]
    given = {name: known[name] for name in (*POSITION, "rho", "completion")}
    found = fl.evaluate("focal", [*names, "A_x", "A_y", "B_x", "B_y", "psi", "T_ratio"], **given)
    held = fl.focal.held_at_AB(
        {name: values for name, values in given.items() if name not in ("phi", "branch")}
    )
    AB = np.arctan2(found["B_y"] - found["A_y"], found["B_x"] - found["A_x"])
    position = {"phi": given["phi"] + np.pi - AB, "branch": np.where(np.sin(found["psi"]) > 0.0, 1, 2)}
    other = fl.evaluate(
        "focal",
        ["A_x", "A_y", "B_x", "B_y", "T_x", "T_y", "F_x", "F_y", "T_ratio", "dpsi_dphi"],
        **held,
        **position,
    )
    assert_allclose(other["T_ratio"], found["T_ratio"], rtol=1e-13)
    # next to a toggle of the other one, where N, M, A fall in line, its B is off by the root of a rounding
    sure = (
        np.isfinite(other["B_x"])
        & (np.abs(np.sin(found["psi"])) > 0.05)
        & (np.abs(found["S_along_AB"]) < 20.0)
    )
    assert sure.sum() > 500
    for joint, seen in zip("ABTF", "MNSF", strict=True):
        for axis, way in (("x", "along"), ("y", "across")):
            off = np.abs(other[f"{joint}_{axis}"] - found[f"{seen}_{way}_AB"])[sure]
            assert np.median(off) <= 10 * UNIT_ROUNDING, joint
            assert (off <= 1e-8).all(), joint


@pytest.mark.parametrize("by", ["rho", "s", "lambda_"])
def test_held_twice_it_is_itself(by):
    design = {"a": 1.2, "b": 0.9, "c": 0.5, "d": 1.1, by: 0.7 if by != "lambda_" else 3.0, "completion": 1}
    twice = fl.focal.held_at_AB(fl.focal.held_at_AB(design))
    for name, value in design.items():
        assert abs(twice[name] - value) <= 8 * UNIT_ROUNDING


def test_a_hart_linkage_held_at_AB_is_one_that_moves_as_seen_from_AB():
    rng = np.random.default_rng(9)
    n = 2000
    given = {"m": rng.uniform(0.3, 3.0, n), "n": rng.uniform(0.3, 3.0, n), "d": rng.uniform(0.3, 3.0, n)}
    given |= {"kappa": rng.uniform(0.2, 3.0, n) * rng.choice([-1, 1], n)}
    given |= {"phi": rng.uniform(-3.0, 3.0, n), "branch": rng.integers(1, 3, n)}
    found = fl.evaluate(
        "hart", ["F_along_AB", "F_y", "line_along_AB"], **given
    )  # the first as the loops have it
    closes = np.isfinite(found["F_y"])
    assert closes.sum() > 500
    given, found = ({name: np.asarray(one)[closes] for name, one in of.items()} for of in (given, found))
    assert_array_equal(found["F_along_AB"], found["line_along_AB"])
    held = fl.hart.held_at_AB({name: given[name] for name in ("m", "n", "d", "kappa")})
    line = fl.evaluate("hart", ["line_x"], **held, phi=0.0)["line_x"]
    # the terms of (7.5) with the rounded inputs of the other linkage
    m, n, d, kappa = (given[name] for name in ("m", "n", "d", "kappa"))
    size = np.abs(kappa) * (d + (1.0 + kappa**2) * (m**2 + n**2) / (2.0 * d))
    assert (np.abs(line - found["line_along_AB"]) <= 10 * UNIT_ROUNDING * size).all()


@pytest.mark.parametrize(
    ("kappa", "other"), [(0.0, np.inf), (-0.0, -np.inf), (5e-324, np.inf), (-1e200, -1e-200)]
)
def test_what_is_beyond_doubles_of_a_hart_linkage_held_at_AB_is_infinite(kappa, other):
    held = fl.hart.held_at_AB(m=4.0, n=8.0, d=6.0, kappa=kappa)
    assert held["kappa"] == other
    assert held["m"] == (np.inf if abs(kappa) > 1.0 else 0.0)


@pytest.mark.parametrize(
    ("given", "key", "remedy"),
    [
        ({"m": np.inf}, "m", "write a finite number"),
        ({"q": "long"}, "q", "write a number"),
        ({"n": 1e80}, "n", "write 1e-24 to 1e+24"),
        ({"p": 0.0}, "p", "write 1e-24 to 1e+24"),
        ({"d": -1.0}, "d", "write a finite number greater than 0"),
    ],
)
def test_impossible_bars_are_refused(given, key, remedy):
    with refused(key, remedy):
        fl.focal.from_five_bar(**{"m": 1.0, "n": 1.0, "p": 1.0, "q": 1.0, "d": 1.0} | given)

"""The focal mechanism in motion, by either drive: it closes, and what the paper says of its figure holds."""

from __future__ import annotations

import numpy as np
import pytest
from tests.support.focal_configurations import DRIVES, family, random_designs

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision.independent import IndependentValues

MANY = 27_000
POINTS = [f"{point}_{axis}" for point in "ABPQFT" for axis in "xy"]
BARS = ["s", "r", "FT", "m", "n", "p", "q", "lambda_"]
DESIGN = ("a", "b", "c", "d", "rho", "completion")


class Figure:
    """Configurations that assemble: points as complex numbers, lengths and all else by name."""

    def __init__(self, drive, inputs, more=()):
        names = [*POINTS, *BARS, "closure_residual", *more]
        found = fl.evaluate("focal", names, input=drive, **inputs)
        closes = np.isfinite(found["closure_residual"])
        self.values = {name: np.asarray(value)[closes] for name, value in (inputs | found).items()}
        self.M, self.N, self.S = 0.0, self["d"] + 0j, self["s"] + 0j
        for point in "ABPQFT":
            setattr(self, point, self[f"{point}_x"] + 1j * self[f"{point}_y"])
        self.size = np.max([np.abs(self[name]) for name in (*"abcdmnpqrs", "FT")], axis=0)

    def __getitem__(self, name):
        return self.values[name]


@pytest.fixture(scope="module", params=DRIVES)
def figure(request):
    inputs = family(request.param, "random", np.random.default_rng(1), MANY)
    return Figure(request.param, inputs, ["omega_angle", "alpha", "beta", "chi", "psi", "F_path_residual"])


@pytest.mark.sample(3)
@pytest.mark.parametrize("kind", ["random", "toggle 1e-3", "toggle 1e-8", "kite 1e-3", "kite 1e-8"])
@pytest.mark.parametrize("drive", DRIVES)
def test_every_bar_and_both_ratios_close_in_every_branch(drive, kind):
    inputs = family(drive, kind, np.random.default_rng(2), 300 if "toggle" in kind else MANY)
    figure = Figure(drive, inputs)
    for completion in (1, 2):
        for branch in (1, 2):
            assert ((figure["completion"] == completion) & (figure["branch"] == branch)).sum() > 30
    # a point is a sum of two bars whose directions are the products of five; each is some roundings off
    assert figure["closure_residual"].max() <= 30 * UNIT_ROUNDING


def test_F_stays_on_its_circle(figure):
    # F is some roundings of the bars off, and as many more as P is far away: w then is told by small angles
    far = figure.size / np.maximum(figure["a"], figure["d"])
    assert (figure["F_path_residual"] <= 30 * UNIT_ROUNDING * figure.size * far).all()


def test_F_stays_on_a_straight_line_where_rho_is_minus_1():
    inputs = {"a": 1.2, "b": 0.9, "c": 0.8, "d": 1.1, "rho": -1.0, "phi": np.linspace(-3.0, 3.0, 500)}
    names = ["F_x", "line_x", "F_path_residual", "closure_residual"]
    # of the other completion lambda is 0: it has no P
    found = fl.evaluate("focal", names, completion=2, **inputs)
    closes = np.isfinite(found["F_x"])
    assert closes.sum() > 100
    assert np.abs(found["F_x"] - found["line_x"])[closes].max() <= 30 * UNIT_ROUNDING
    assert np.nanmax(found["F_path_residual"]) <= 30 * UNIT_ROUNDING
    assert np.nanmax(found["closure_residual"]) <= 30 * UNIT_ROUNDING


def assert_zero(value, *sizes):
    """Assert that a sum of products is zero to the roundings of its factors: points of a size each."""
    total = np.ones_like(sizes[0])
    for size in sizes:
        total = total * size
    assert (np.abs(value) <= 200 * UNIT_ROUNDING * total).all()


def test_triangles_are_similar(figure):
    """MPF ~ FQB and NQF ~ FPA, turned over."""
    M, N, A, B, P, Q, F = (getattr(figure, point) for point in "MNABPQF")
    assert_zero((F - P) * np.conj(F - Q) - (M - P) * np.conj(B - Q), figure.size, figure.size)
    assert_zero((F - Q) * np.conj(F - P) - (N - Q) * np.conj(A - P), figure.size, figure.size)


def test_omega_is_the_same_at_both(figure):
    """(1.1): the angle at P and that at Q are supplementary."""
    M, N, P, Q, F = (getattr(figure, point) for point in "MNPQF")
    at_P, at_Q = (F - P) * np.conj(M - P), (F - Q) * np.conj(N - Q)
    assert_zero((at_P * np.conj(at_Q)).imag, *[figure.size] * 4)
    w = np.exp(1j * figure["omega_angle"])
    assert_zero(at_P - figure["m"] * figure["p"] * w, figure.size, figure.size)
    assert_zero(at_Q + figure["n"] * figure["q"] * w, figure.size, figure.size)


def concyclic(one, two, three, four):
    """Return what vanishes where four points lie on a circle or line: of a cross-ratio."""
    return ((one - two) * (three - four) * np.conj((one - four) * (three - two))).imag


def test_P_S_Q_T_lie_on_a_circle(figure):
    size = np.maximum(figure.size, np.abs(figure.T))
    assert_zero(concyclic(figure.P, figure.S, figure.Q, figure.T), *[size] * 4)


def test_P_F_Q_X_and_S_F_T_Y_lie_on_circles(figure):
    """X = MA.NB and Y = MN.AB, which may be at infinity: times what then vanishes."""
    a, b, d = figure["a"], figure["b"], figure["d"]
    u, v, along = figure.A / a, (figure.B - d) / b, (figure.B - figure.A) / figure["c"]
    weight = (np.conj(u) * v).imag
    X = u * (d * v.imag)
    one, two, three, four = figure.P, figure.F, figure.Q, X
    value = ((one - two) * (weight * three - four) * np.conj((weight * one - four) * (three - two))).imag
    assert_zero(value, *[figure.size] * 4)
    Y = figure.A.real * along.imag - figure.A.imag * along.real
    one, two, three, weight = figure.S, figure.F, figure.T, along.imag
    value = ((one - two) * (weight * three - Y) * np.conj((weight * one - Y) * (three - two))).imag
    assert_zero(value, *[np.maximum(figure.size, np.abs(figure.T))] * 4)


def test_angles_are_those_of_the_figure(figure):
    """(4.1) to (4.4) by the points."""
    M, N, A, B, P, Q, F = (getattr(figure, point) for point in "MNABPQF")
    for name, apex, start, end in (
        *(("beta", F, P, M), ("beta", B, F, Q), ("alpha", F, N, Q), ("alpha", A, P, F), ("chi", F, A, M)),
    ):
        turned = (end - apex) * np.conj(start - apex)
        assert_zero((turned * np.exp(-1j * figure[name])).imag, figure.size, figure.size)
        assert ((turned * np.exp(-1j * figure[name])).real >= -200 * UNIT_ROUNDING * figure.size**2).all()
    other = np.where(figure["rho"] > 0.0, np.pi, 0.0) - figure["chi"]
    turned = (B - F) * np.conj(N - F)
    assert_zero((turned * np.exp(-1j * other)).imag, figure.size, figure.size)


def test_the_rockers_keep_the_relation_of_the_paper(figure):
    """(2.2), which holds of m, n, p, q what (2.4) does of a, b, c."""
    m, n, p, q, d = (figure[name] for name in "mnpqd")
    u, v = figure.A / figure["a"], (figure.B - d) / figure["b"]
    left = 2.0 * ((m * n + p * q) * (u * np.conj(v)).real + m * d * u.real - n * d * v.real)
    assert_zero(left - (m * m + n * n - p * p - q * q + d * d), figure.size, figure.size)


def test_completions_exchange_the_crank_and_FT():
    designs = {name: values for name, values in random_designs(np.random.default_rng(3), MANY).items()}
    first, second = (
        fl.evaluate("focal", ["r", "FT"], **designs | {"completion": k, "phi": 1.0}) for k in (1.0, 2.0)
    )
    for one, other in (("r", "FT"), ("FT", "r")):
        assert np.isfinite(first[one]).sum() > MANY // 2
        # roots that do not cancel: a dozen operations
        np.testing.assert_allclose(first[one], second[other], rtol=30 * UNIT_ROUNDING)


def with_bounds(names):
    return [*names, *(f"{name}_error" for name in names)]


def test_both_drives_say_the_same():
    """The crank, put where the rocker has it, puts the rocker where it was."""
    inputs = family("phi", "random", np.random.default_rng(4), MANY)
    by_rocker = Figure("phi", inputs, [*with_bounds(["sigma", "psi", "dsigma_dphi"]), "omega_angle"])
    kept = {name: by_rocker[name] for name in (*DESIGN, "sigma")}
    branch = np.where(by_rocker["omega_angle"] > 0.0, 1, 2)
    names = [*with_bounds(["phi", "psi", "dphi_dsigma"]), "dpsi_dsigma", "d_dphi_dsigma_d_sigma"]
    by_crank = fl.evaluate("focal", names, input="sigma", branch=branch, **kept)
    lost = by_rocker["sigma_error"]
    # What rounding does by each drive, and what the error of sigma does to the rockers.
    given = {"phi": 0.0, "psi": by_rocker["psi_error"]}
    for name, error in given.items():
        allowed = error + by_crank[f"{name}_error"] + np.abs(by_crank[f"d{name}_dsigma"]) * lost
        off = np.abs(np.angle(np.exp(1j * (by_crank[name] - by_rocker[name]))))
        assert (off <= allowed).all()
        assert np.median(allowed) < 1e-13
    there, back = by_crank["dphi_dsigma"], by_rocker["dsigma_dphi"]
    error = by_crank["dphi_dsigma_error"] + np.abs(by_crank["d_dphi_dsigma_d_sigma"]) * lost
    allowed = error * np.abs(back) + by_rocker["dsigma_dphi_error"] * np.abs(there) + UNIT_ROUNDING
    assert (np.abs(there * back - 1.0) <= allowed).all()
    assert np.median(allowed) < 1e-13
    assert off.size > MANY // 4


def test_the_crank_turns_without_a_jump_of_branch():
    """Whole turns: from sample to sample the rockers move as their rates say, and come back."""
    rng = np.random.default_rng(6)
    designs = random_designs(rng, 4000)
    kind = fl.evaluate("focal", ["crank_type"], phi=1.0, **designs)["crank_type"]
    turning = {name: values[kind == 0][:300, None] for name, values in designs.items()}
    assert turning["a"].shape == (300, 1)
    sigma = np.linspace(-np.pi, np.pi, 1441)
    found = fl.evaluate(
        "focal",
        [*with_bounds(["phi", "psi"]), "dphi_dsigma", "dpsi_dsigma", "omega_angle", "closure_residual"],
        input="sigma",
        sigma=sigma,
        **turning,
    )
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


@pytest.mark.parametrize("drive", DRIVES)
def test_newton_on_all_bars_finds_the_same(drive):
    """All points unknown but those that the drive holds: eight bars and both ratios in least squares, by Newton."""
    inputs = family(drive, "random", np.random.default_rng(7), 3000)
    figure = Figure(drive, inputs)
    d, a, b, c = (figure[name] for name in "dabc")
    shares = figure["m"] / a, figure["s"] / d
    known = np.stack([figure.A, figure.B, figure.F], axis=-1)
    unknown = known + 1e-3 * np.exp(1j * np.arange(3)) * d[:, None]
    held = figure["phi"] if drive == "phi" else figure["sigma"]

    def errors(points):
        A, B, F = np.moveaxis(points, -1, 0)
        P, Q, T = shares[0] * A, d + shares[0] * (B - d), A + shares[1] * (B - A)
        ends = ((A, 0.0, a), (B, d, b), (B, A, c), (F, P, figure["p"]), (F, Q, figure["q"]))
        ends += ((F, figure.S, figure["r"]), (F, T, figure["FT"]))
        driven = A * np.exp(-1j * held) if drive == "phi" else (F - figure.S) * np.exp(-1j * held)
        return np.stack([*(np.abs(x - y) - np.abs(size) for x, y, size in ends), driven.imag], axis=-1)

    for _ in range(8):
        slopes = [
            (errors(unknown + h * np.eye(3)[k]) - errors(unknown - h * np.eye(3)[k])) / 2e-6
            for h in (1e-6, 1e-6j)
            for k in range(3)
        ]
        jacobian = np.stack(slopes, axis=-1)
        inverse = np.linalg.pinv(jacobian)
        step = np.einsum("nij,nj->ni", inverse, errors(unknown))
        unknown = unknown - (step[:, :3] + 1j * step[:, 3:])
    # away from singular positions, where Newton's first step is already too long
    condition = np.linalg.cond(jacobian)
    sure = (condition < 30.0) & (figure.size < 20.0)
    assert sure.sum() > 300
    # the residuals are roundings of the bars, times the condition number
    assert np.abs(unknown - known)[sure].max() <= 30.0 * 20.0 * 100 * UNIT_ROUNDING


def test_T_deviation_of_a_straight_line_is_zero():
    x = np.linspace(-1.0, 2.0, 50)
    line = fl.focal.straight_line(np.append(3.0 + 2.0 * x, np.nan), np.append(1.0 - x, 0.0))
    assert np.abs(line.deviation[:-1]).max() <= 10 * UNIT_ROUNDING * 7.0
    assert np.isnan(line.deviation[-1])
    assert line.direction == pytest.approx(np.arctan2(-1.0, 2.0), abs=10 * UNIT_ROUNDING)


@pytest.mark.parametrize("power", [-900, -500, 500, 900])
def test_the_straight_line_has_the_same_bits_in_any_units(power):
    x, y = np.random.default_rng(11).normal(size=(2, 5, 40)) * np.array([[[1.0]], [[1e-9]]])
    plain, scaled = (fl.focal.straight_line(np.ldexp(x, k), np.ldexp(y, k)) for k in (0, power))
    np.testing.assert_array_equal(scaled.direction, plain.direction)
    np.testing.assert_array_equal(scaled.deviation, np.ldexp(plain.deviation, power))


def test_the_straight_line_has_the_least_sum_of_squares():
    x, y = np.random.default_rng(8).normal(size=(2, 20, 40)) * np.array([[[2.0]], [[1.0]]])
    line = fl.focal.straight_line(x, y)
    least = (line.deviation**2).sum(axis=-1)
    for turn in np.linspace(-1.5, 1.5, 31):
        for shift in (-0.1, 0.0, 0.1):
            angle = (line.direction + turn)[:, None]
            off = (y - line.y[:, None]) * np.cos(angle) - (x - line.x[:, None]) * np.sin(angle) + shift
            assert ((off**2).sum(axis=-1) >= least * (1 - 100 * UNIT_ROUNDING)).all()


def test_F_is_where_a_crank_far_away_puts_it():
    """In doubles s + r is 0 here: which side of M the crank reaches is told by the power of M."""
    design = {"a": 7.0, "b": 5.0, "c": 6.0, "d": 5.0, "rho": -0.9999999999999993, "completion": 1}
    at = design | {"sigma": 0.0, "branch": 1}
    independent = IndependentValues(catalogue("focal", "sigma"), ["F_x"]).values(at)["F_x"]
    found = fl.evaluate("focal", ["F_x", "F_x_error"], input="sigma", branch=1, sigma=0.0, **design)
    assert abs(found["F_x"] - float(independent)) <= found["F_x_error"] < 1e-12

"""Equation (9) as labelled arrays, Table 1, and the extremes of the rates of any pair of joints."""

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.configurations import all_loads, family
from tests.support.refusals import refused
from tests.support.sweeps import BARS, CRANK

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.planar import SYSTEM


@pytest.mark.parametrize("loaded", [False, True], ids=["no loads", "all loads"])
def test_the_solution_of_the_equations_are_the_joint_forces(loaded):
    rng = np.random.default_rng(5)
    inputs = family("random", rng, 60) | (all_loads(rng, 60) if loaded else {})
    branch = rng.integers(1, 3, 60)
    found = fl.planar.force_equations(inputs, branch=branch)
    names = [*SYSTEM.unknowns, "transmission_angle"]
    expected = fl.evaluate("planar_4r", names, **inputs, branch=branch)
    mu = expected.pop("transmission_angle")
    closes = np.isfinite(mu)
    assert closes.sum() > 25
    forces = np.linalg.solve(found.A.values[closes], found.b.values[closes][..., None])[..., 0]
    expected = np.stack([expected[name][closes] for name in found.unknown.values], axis=-1)
    # LU of 9 rows is backward stable: its error is that condition number (7 to 10 over sin mu) times some roundings
    size = np.max(abs(expected), axis=-1, keepdims=True) / np.sin(mu[closes])[:, None]
    assert np.all(abs(forces - expected) <= 1000 * UNIT_ROUNDING * size)
    assert np.isnan(found.b.values[~closes]).any(axis=-1).all()


def test_the_matrix_is_the_printed_one():
    """Moments of the joint forces about mass centres, written from the drawing: Fig. 2, r_ij from CG_i to joint j."""
    theta1 = 0.7
    found = fl.planar.force_equations(CRANK, omega1=25.0, theta1=theta1, branch=2, links=BARS)
    assert found.A.dims == ("equation", "unknown")
    assert found.b.dims == ("equation",)
    points = fl.evaluate("planar_4r", ["A_x", "A_y", "B_x", "B_y"], **CRANK, theta1=theta1, branch=2)
    o, a, b, d = 0.0, complex(points["A_x"], points["A_y"]), complex(points["B_x"], points["B_y"]), 1.0
    column = {str(name): k for k, name in enumerate(found.unknown.values)}
    expected = np.zeros((9, 9))
    ends = {
        1: [("F41", o, 1), ("F21", a, 1)],
        2: [("F21", a, -1), ("F32", b, 1)],
        3: [("F32", b, -1), ("F43", d, 1)],
    }
    for i, ((_, first, _), (_, second, _)) in ends.items():
        centre = (first + second) / 2
        for force, joint, sign in ends[i]:
            x, y, r = column[f"{force}_x"], column[f"{force}_y"], joint - centre
            expected[3 * i - 3, x] = expected[3 * i - 2, y] = sign
            expected[3 * i - 1, x], expected[3 * i - 1, y] = -sign * r.imag, sign * r.real
    expected[2, column["T41"]] = 1.0
    assert_allclose(found.A, expected, rtol=0, atol=8 * UNIT_ROUNDING)  # lengths of about 1


def test_labels_of_the_inputs_are_those_of_the_equations():
    theta1 = xr.DataArray([0.5, 1.0, 1.5], dims="theta1", coords={"theta1": [0.5, 1.0, 1.5]})
    found = fl.planar.force_equations(CRANK, omega1=25.0, theta1=theta1, links=BARS)
    assert found.A.dims == ("theta1", "equation", "unknown")
    one = fl.planar.force_equations(CRANK, omega1=25.0, theta1=1.0, links=BARS)
    assert_array_equal(found.sel(theta1=1.0).A, one.A)
    assert float(one.b.sel(equation="inertia_moment1")) == 0.0


def test_what_cannot_be_written_as_equations_is_refused():
    with refused("theta1", "give it in rad"):
        fl.planar.force_equations(CRANK, omega1=25.0, links=BARS)
    with refused("a1"):
        fl.planar.force_equations(CRANK | {"a1": -1.0}, omega1=25.0, theta1=1.0, links=BARS)
    with refused("a1", "leave one out"):
        fl.planar.force_equations(CRANK, a1=1.0, omega1=25.0, theta1=1.0, links=BARS)
    with pytest.raises(fl.InputError, match=r"^force_equations: .*m1.* are missing"):
        fl.planar.force_equations(CRANK, omega1=25.0, theta1=1.0)
    with refused("links", "round_bar"):
        fl.planar.bar_properties(CRANK, links=None)
    with refused("radius"):
        fl.planar.bar_properties(CRANK, links=fl.round_bar(7750.0))


def test_table_1_of_the_paper():
    bars = fl.planar.bar_properties(CRANK, links=BARS)
    # four products, each of one rounding
    for i, (volume, mass) in enumerate(((1 / 25000, 0.31), (3 / 25000, 0.93), (1 / 12500, 0.62)), 1):
        assert abs(bars[f"volume{i}"] - np.pi * volume) <= 8 * UNIT_ROUNDING * volume * np.pi
        assert abs(bars[f"m{i}"] - np.pi * mass) <= 8 * UNIT_ROUNDING * mass * np.pi
    explicit = {name: value for name, value in bars.items() if "volume" not in name}
    given = {**CRANK, "omega1": 25.0, "theta1": 1.0}
    with_bars = fl.evaluate("planar_4r", ["shaking_force"], **given, links=BARS)
    assert fl.evaluate("planar_4r", ["shaking_force"], **given, **explicit) == with_bars


#: Pairs with an input that turns fully: of Table 1 the joints at the ends of the shortest link a1; and of a4.
DOUBLE_CRANK = {"a1": 1.2, "a2": 0.9, "a3": 1.0, "a4": 0.4}
CASES = [*((pair, CRANK) for pair in ("12", "13", "14", "23", "24")), ("43", DOUBLE_CRANK)]


def by_the_equation(pair, lengths, rate):
    """Rates and accelerations of the output in both modes over a turn of the input: eqs. (1) to (8), v'' corrected."""
    order = pair if pair in ("12", "13", "14", "23", "24", "34") else pair[::-1]
    A, B, C, K, D = fl.planar.io_coefficients(lengths, pair=order)
    if order != pair:
        B, C = C, B
    x = np.tan(np.linspace(-np.pi, np.pi, 40001)[1:-1] / 2)
    square, linear, constant = A * x**2 + C, K * x, B * x**2 + D
    root = np.sqrt(linear**2 - 4 * square * constant)
    x, root = np.concatenate([x, x]), np.concatenate([root, -root])
    square, linear = np.tile(square, 2), np.tile(linear, 2)
    y = (root - linear) / (2 * square)
    dx = rate * (1 + x**2) / 2
    ddx = x * rate**2 * (1 + x**2) / 2
    F_x, F_y = 2 * x * (A * y**2 + B) + K * y, 2 * y * (A * x**2 + C) + K * x
    dy = -F_x * dx / F_y
    bends = 2 * (A * y**2 + B) * dx**2 + 2 * (A * x**2 + C) * dy**2 + 2 * (4 * A * x * y + K) * dx * dy
    ddy = -(F_x * ddx + bends) / F_y
    turn = 2 * dy / (1 + y**2)
    return turn, 2 * ddy / (1 + y**2) - y * turn**2


@pytest.mark.sample(2)
@pytest.mark.parametrize(("pair", "lengths"), CASES, ids=[pair for pair, _ in CASES])
def test_extremes_of_rates_follow_from_the_equation_of_the_pair(pair, lengths):
    i, j = pair
    found = fl.planar.rate_extrema(lengths | {f"joint_omega_{i}": 25.0}, pair=pair, branch=(1, 2))
    for name, curve in zip(("omega", "alpha"), by_the_equation(pair, lengths, 25.0), strict=True):
        extremes = found[f"joint_{name}_{j}_extrema"]
        # half a step of 1.6e-4 from the extreme, a curve of second derivative 100 times its size at most is 3e-7 lower
        assert_allclose([extremes.max(), extremes.min()], [np.nanmax(curve), np.nanmin(curve)], rtol=1e-6)
        assert f"joint_angle_{i}_at_joint_{name}_{j}_extrema" in found


def test_the_crank_s_rate_may_have_its_usual_name_and_other_pairs_have_none():
    lengths = CRANK | {"a2": [1.1, 1.2]}
    usual = [lengths | {"omega1": [25.0, 30.0]}, fl.grid(**lengths, omega1=[25.0, 30.0])]
    other = [lengths | {"joint_omega_1": [25.0, 30.0]}, fl.grid(**lengths, joint_omega_1=[25.0, 30.0])]
    for one, two in zip(usual, other, strict=True):
        found = fl.planar.rate_extrema(one, pair="13", branch=(1, 2))
        assert found.identical(
            fl.planar.rate_extrema(two, pair="13", branch=(1, 2)).assign_attrs(found.attrs)
        )
    with refused("omega1", "joint_omega_2"):
        fl.planar.rate_extrema(usual[0], pair="23", branch=(1, 2))
    for pair in ("11", "15", 14, None):
        with refused("pair", "12, 13, 14"):
            fl.planar.rate_extrema(CRANK, pair=pair, branch=(1, 2))

"""An axis that only scales results is multiplied, not evaluated again."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import fastlink as fl
from fastlink.engine.resolve import resolve
from fastlink.engine.scaling import ScalingAxis, homogeneity_degrees
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

PLANAR = catalogue("planar_4r")
BAR = fl.round_bar(density=7750.0, radius=0.01)
NAMES = [
    "omega4",
    "T41_rms",
    "omega4_max",
    "alpha4_extrema",
    "theta1_at_shaking_force_max",
    "shaking_force_max",
]
COUPLERS, OUTPUTS = np.linspace(1.0, 1.4, 9), np.linspace(0.6, 1.0, 11)
# Powers of two scale without rounding: rates by omega1, forces by its square.
SPEEDS = np.array([0.5, 1.0, 8.0])


def sweep(quantities=NAMES, mechanism="planar_4r", links=BAR, **given):
    options = {
        key: given.pop(key)
        for key in ("to", "block", "threads", "overwrite", "solver", "verify")
        if key in given
    }
    return fl.sweep(
        mechanism, fl.grid(**given), quantities, links=links, theta1=12, **{"branch": (1, 2)} | options
    )


@pytest.mark.sample(3)
@pytest.mark.parametrize("order", [("omega1", "a2", "a3"), ("a2", "omega1", "a3"), ("a2", "a3", "omega1")])
@pytest.mark.parametrize("block", [None, 1, 7, 64])
def test_a_speed_axis_has_the_bits_of_its_speeds(order, block, tmp_path):
    axes = {"omega1": SPEEDS, "a2": COUPLERS, "a3": OUTPUTS}
    options = {} if block is None else {"to": tmp_path / "speeds.h5", "verify": 0}
    together = sweep(a1=0.4, a4=1.0, **{name: axes[name] for name in order}, block=block, **options)
    assert together.attrs["scaling_axis"] == "omega1"
    assert together.attrs["designs"] == 3 * 9 * 11
    meanings = together.status.attrs["flag_meanings"].split()
    counts = [together.attrs[f"designs_{meaning}"] for meaning in meanings]
    assert counts == np.bincount(together.status.values.ravel(), minlength=len(meanings)).tolist()
    for speed in SPEEDS:
        alone = sweep(a1=0.4, a4=1.0, **(axes | {"omega1": float(speed)}))
        assert "scaling_axis" not in alone.attrs
        for name in alone:
            expected = alone[name].transpose(*(dim for dim in together[name].dims if dim != "omega1"))
            assert_array_equal(together[name].sel(omega1=speed), expected, err_msg=name)
    together.close()


def test_any_speed_is_within_rounding():
    together = sweep(
        ["shaking_force_max", "omega4_max"], a1=0.4, a2=COUPLERS, a3=0.8, a4=1.0, omega1=[3.0, 7.0, 25.0]
    )
    for speed in together.omega1.values:
        alone = sweep(
            ["shaking_force_max", "omega4_max"], a1=0.4, a2=COUPLERS, a3=0.8, a4=1.0, omega1=float(speed)
        )
        for name in ("shaking_force_max", "omega4_max"):
            # Extremes of size do not cancel: both ways are within 4 (1 + 2) roundings, by the power of omega1.
            assert_allclose(together[name].sel(omega1=speed), alone[name], rtol=2 * 12 * UNIT_ROUNDING)


@pytest.mark.parametrize(
    ("given", "names"),
    [
        ({"omega1": [-1.0, 2.0]}, ["omega4_max"]),
        ({"omega1": [0.0, 2.0]}, ["omega4_max"]),
        ({"omega1": [1.0, 2.0], "gravity_y": -9.81}, ["T41_max"]),
        ({"omega1": 2.0, "a2": [1.1, 1.2]}, ["omega4_max"]),
        ({"omega1": [1.0, 2.0]}, ["omega4", "omega4_error"]),
        ({"omega1": 2.0, "P_u": [0.1, 0.2], "P_v": 0.1}, ["P_x_max"]),
    ],
)
def test_no_axis_is_used_that_does_more_than_scale(given, names):
    space = fl.grid(**{"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0, **given})
    assert resolve("planar_4r", space, names, links=BAR, branch=(1, 2)).scaling_axis is None


@pytest.mark.parametrize(
    ("name", "chosen", "expected"),
    [
        (
            "omega1",
            (),
            {"omega2": 1, "jerk4": 3, "F32": 2, "input_power": 3, "theta2": 0, "status": 0, "curvature": 0},
        ),
        ("density", ("gravity", "round_bar"), {"omega2": 0, "F32": 1, "T41": 1, "shaking_moment": 1}),
        ("omega1", ("gravity",), {"T41": None, "F32": None, "omega4": 1}),
        ("a1", (), {"A_x": 1, "omega4": None, "status": None}),
    ],
)
def test_degrees(name, chosen, expected):
    of_bars = PLANAR.variants["round_bar"] if "round_bar" in chosen else {}
    inputs = [key for key in PLANAR.known_inputs(chosen) if key not in of_bars]
    leaves = (*inputs, *PLANAR.tables, *PLANAR.table_low_parts, "branch", "theta1")
    result = homogeneity_degrees(PLANAR.dependencies(expected, leaves, chosen), name)
    assert {key: result[key] for key in expected} == expected


@pytest.mark.parametrize("inner", [1, 4])
def test_every_cut_delivers_each_design_once(inner):
    length, slabs = 3, 5
    space = fl.grid(a1=np.arange(1.0, slabs + 1), a2=np.arange(1.0, inner + 1))
    axis = ScalingAxis("omega1", space, inner, (None,), length)
    numbers = np.arange(float(slabs * inner))
    whole = np.repeat(numbers.reshape(slabs, 1, inner), length, axis=1).ravel()
    for block in range(1, slabs * inner + 1):
        result = np.full(whole.size, np.nan)

        def take(start, stop, arrays, result=result):
            assert np.isnan(result[start:stop]).all()
            result[start:stop] = arrays[0]

        sink = axis.over(take)
        for start in range(0, numbers.size, block):
            stop = min(start + block, numbers.size)
            sink(start, stop, [numbers[start:stop]])
        assert_array_equal(result, whole)

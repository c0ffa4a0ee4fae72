"""Extremes of what is made of angles as numbers, which jump; and of the greater of values that change sign."""

import numpy as np
import pytest

import fastlink as fl
from fastlink.facts.expression import GraphAsWritten, beneath, winding
from fastlink.facts.formula import Formula
from fastlink.numerics.elementary import cosine, sine

planar = fl.extend("planar_4r")
slider = fl.extend("slider_crank")
hart = fl.extend("hart")


@planar.quantity(units="rad")
def turned_by(theta4, theta2):
    return theta4 - 2 * theta2


@planar.quantity(units="1")
def of_half(theta2):
    return np.sin(theta2 / 2)


@planar.quantity(units="m")
def unrolled(theta4, a3, theta1):
    return a3 * theta4 * np.cos(theta1)


@planar.quantity(units="rad")
def larger(theta4, turned_by):
    return max(theta4, 0.3 * turned_by)


@planar.quantity(units="N")
def lower(F21_y, F43_y):
    return min(F21_y, F43_y)


@planar.quantity(units="rad")
def ahead(theta4, theta1):
    return theta4 - theta1


@planar.quantity(units="1")
def periodic(theta4, theta1):
    return np.cos(theta4 - 2 * theta1)


@slider.quantity(units="rad")
def twice(theta2):
    return 2 * theta2 + 0.1


@hart.quantity(units="rad")
def shifted(psi):
    return 0.5 - psi / 3


RANGES = {"a1": (0.2, 2.5), "a2": (0.5, 2.5), "a3": (0.5, 2.5), "a4": (0.3, 1.5)}
PLANAR = (planar, ["turned_by", "of_half", "unrolled", "larger", "lower"])
CASES = {
    "planar": (PLANAR[0], fl.sobol(32, RANGES, seed=3).with_constants({"omega1": 1.0}), PLANAR[1]),
    "planar, many": (PLANAR[0], fl.sobol(150, RANGES, seed=3).with_constants({"omega1": 1.0}), PLANAR[1]),
    "slider": (
        slider,
        fl.sobol(40, {"r": (0.1, 0.4), "l": (0.1, 0.5), "e": (0.0, 0.1)}).with_constants({"omega": 1.0}),
        ["twice"],
    ),
    "hart": (hart, {"m": 4.0, "n": 8.0, "d": 6.0, "kappa": [0.4, 0.5, 0.6]}, ["shifted"]),
}
ANGLES = 7200


@pytest.mark.parametrize("case", [pytest.param(c, marks=[pytest.mark.stress] * ("many" in c)) for c in CASES])
def test_none_of_dense_samples_is_beyond_an_extreme(case):
    mechanism, designs, names = CASES[case]
    links = {"links": fl.round_bar(density=7750.0, radius=0.01)} if mechanism is planar else {}
    given = {"branch": (1, 2), "progress": False, **links}
    curves = fl.sweep(mechanism, designs, names, **{"branch": (1, 2)} | given, positions=ANGLES)
    wanted = [f"{name}_{end}{more}" for name in names for end in ("min", "max") for more in ("", "_error")]
    maps = fl.sweep(mechanism, designs, wanted, **{"branch": (1, 2)} | given)
    for name in names:
        assert maps[f"{name}_max"].attrs["extrema"] == "refined"
        curve = curves[name]
        axis = curve.dims[-1]
        size = abs(curve).max(axis)
        for end, sign in (("max", 1.0), ("min", -1.0)):
            best, found = (sign * curve).max(axis), sign * maps[f"{name}_{end}"]
            # a sample is off by its own rounding, beside a toggle by the root of one
            beyond = best - found > maps[f"{name}_{end}_error"] + 1e-12 * size
            assert not beyond.any(), name
            # samples miss an extreme by a step times the slope; in the median of designs that is below 40 sizes a turn
            short = ((found - best) / size).values[np.isfinite(found.values)]
            assert np.median(short) < 40.0 / ANGLES, name


def test_the_greater_of_values_that_change_sign_is_not_mirrored():
    """Once the least of branch 2 was the greatest of branch 1 with its sign changed, as of each of both."""
    design = {"a1": 2.0, "a2": 2.5, "a3": 2.2, "a4": 0.8, "omega1": 1.0}
    maps = fl.sweep(planar, design, ["larger_min", "larger_max"], branch=(1, 2), verify=2)
    assert float(maps.larger_min[1]) != -float(maps.larger_max[0])
    assert maps.attrs["verify_mismatches"] == 0


def test_sides_of_jumps_are_verified_with_50_digits():
    design = {"a1": 2.0, "a2": 2.5, "a3": 2.2, "a4": 0.8, "omega1": 1.0}
    names = [
        "turned_by_max",
        "of_half_min",
        "unrolled_max",
        "unrolled_extrema",
        "larger_max",
        "larger_min_error",
    ]
    maps = fl.sweep(planar, design, names, branch=(1, 2), verify=2)
    assert maps.attrs["verify_mismatches"] == 0
    for name in names[:5]:
        # the place of a jump is known to 2^-46 of the range, 64 roundings of the value's change over the turn
        assert maps[name].attrs["error_max_relative"] < 64 * 2.0**-52 * 20.0
    # a jump is no extreme of a list: only what the curve itself turns at
    curve = fl.sweep(planar, design, ["unrolled"], positions=20000, branch=(1, 2)).unrolled.values
    steps = np.roll(curve, -1, axis=-1) - curve
    after = np.roll(steps, -1, axis=-1)
    turns = (steps * after < 0) & (abs(steps) < 0.1) & (abs(after) < 0.1)
    assert (maps.unrolled_extrema.notnull().sum("extremum").values == turns.sum(axis=-1)).all()


def test_what_reads_the_position_as_a_number_is_sampled():
    """The position jumps at the end of the turn, wherever that is: `ahead` once had other extremes than its curve."""
    design = {"a1": 0.5, "a2": 3.0, "a3": 2.5, "a4": 2.2, "omega1": 1.0}
    maps = fl.sweep(planar, design, ["ahead_min", "ahead_max", "periodic_min"], positions=360, branch=(1, 2))
    curve = fl.sweep(planar, design, ["ahead"], positions=360, branch=(1, 2))
    assert maps.ahead_min.attrs["extrema"] == "sampled"
    assert maps.periodic_min.attrs["extrema"] == "refined"
    assert (maps.ahead_min == curve.ahead.min("theta1")).all()


@pytest.mark.parametrize(
    ("text", "turns"),
    [
        ("x - 2.0 * y", {"x": 1.0, "y": -2.0}),
        ("x - (x + y) / 2.0", {"x": 0.5, "y": -0.5}),
        ("x - x", {}),
        ("sine(3.0 * x - y)", {}),
        ("cosine(x / 2.0)", {"x": np.nan}),
        ("x * y", {"x": np.nan, "y": np.nan}),
        ("z * sine(x) + -y", {"y": -1.0}),
    ],
)
def test_turns_of_what_is_made_of_angles(text, turns):
    graph = GraphAsWritten((sine, cosine))
    root = graph.read(Formula("f", ("x", "y", "z"), [f"return {text}"]), [*map(graph.name, "xyz")])
    found = winding(beneath([root]), lambda name: {name: 1.0} if name in "xy" else {})
    np.testing.assert_equal(found, turns)

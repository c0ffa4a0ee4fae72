"""Greatest and least values of what chooses, takes sizes or magnitudes: none of dense samples is beyond them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_equal
from tests.support.sweeps import BARS, sweep_4r, sweep_both
from tests.support.toys import declare_all

import fastlink as fl
from fastlink.facts.expression import GraphAsWritten, beneath, generate_formula, winding
from fastlink.facts.formula import Formula
from fastlink.facts.own import split
from fastlink.numerics.elementary import cosine, sine
from fastlink.numerics.vectors import absolute, choice

FUNCTIONS = (absolute, choice)
mine = fl.extend("planar_4r")
declare_all(
    mine,
    {
        "lesser(F21, F41)": ("N", "min(F21, F41)"),
        "apart(F21, F41)": ("N", "abs(F21 - 2 * F41)"),
        "drag(omega2, omega4)": ("rad2 s-2", "1e6 * omega4 * abs(omega4) - omega2 * abs(omega2)"),
        "lower(omega2, omega4)": ("rad s-1", "min(omega2, 1e3 * abs(omega4))"),
        # two kinks in one place
        "wide(omega2, omega4)": ("rad s-1", "max(omega2, omega4) - min(omega4, omega2)"),
        "joint(F32_x, F32_y, F21)": ("N", "np.hypot(F32_x, F32_y) + F21"),
    },
)


@mine.quantity(units="N")
def nested(lesser, F32_x, F32_y):
    size = np.hypot(F32_x, F32_y)
    return max(lesser, size / 2) - min(size, lesser)


NAMES = [f"{name}_{how}" for name in ("lesser", "apart", "nested") for how in ("min", "max")]
#: The forces on the crank almost vanish close to where they are equal: both kinks and two extremes in one cell.
#: At the second both turn sharply near theta1 = 0.03, where their difference has three extremes within 0.015 rad.
KNOWN = {"a1": [0.25050164, 0.499595358], "a2": [1.25901682, 0.969889661], "a3": [0.51193397, 1.085353234]}


@pytest.mark.parametrize(
    ("names", "count", "samples", "bounds"),
    [
        ([*NAMES[:2], "apart_min"], 12, 8001, False),
        # its slope is multiplied by it, and neither the slope nor the quantity is computed from it by its name
        pytest.param(["joint_min", "joint_max"], 4, 2001, True, marks=pytest.mark.stress),
        pytest.param(NAMES, 1000, 8001, True, marks=pytest.mark.stress),
    ],
)
def test_none_of_dense_samples_is_beyond_an_extreme(names, count, samples, bounds):
    space = fl.sobol(count, {"a1": (0.1, 0.5), "a2": (0.8, 1.3), "a3": (0.5, 1.2)}, seed=7)
    columns = {name: np.append(values, KNOWN[name]) for name, values in space.at(np.arange(count)).items()}
    designs = fl.table(columns).with_constants({"a4": 1.0, "omega1": 25.0})
    given = {"links": BARS, "progress": False}
    errors = [f"{name}_error" for name in names] if bounds else []
    maps = sweep_both(mine, designs, [*names, *errors], **given)
    angles = np.linspace(-np.pi, np.pi, samples)
    quantities = list(dict.fromkeys(name.rpartition("_")[0] for name in names))
    curves = sweep_both(mine, designs, quantities, **given, theta1=angles)
    for name in names:
        quantity, _, how = name.rpartition("_")
        sign = 1.0 if how == "max" else -1.0
        best = (sign * curves[quantity]).max("theta1")
        # a sample is off by its own rounding, which the bound of the extreme next to it is of too: twice that; without
        # bounds by less than 1e-10 of the greatest value, far below what was missed once (4e-8 and 5e-5 of it)
        off = 2.0 * maps[f"{name}_error"] if bounds else 1e-10 * abs(curves[quantity]).max("theta1")
        beyond = best - sign * maps[name] - off
        assert not (beyond > 0.0).any(), (name, np.argwhere((beyond > 0.0).values))


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["drag", "lower", "wide"])
def test_lists_hold_the_extremes_beside_kinks(name):
    """Next to a dead point of the output link a thousandth of a cell may hold two or three of them."""
    rng = np.random.default_rng(3)
    columns = {"a1": (0.1, 0.3), "a2": (0.9, 1.1), "a3": (0.7, 1.1)}
    columns = {length: rng.uniform(*ends, 12) for length, ends in columns.items()}
    columns |= {"a4": np.ones(12), "omega1": np.full(12, 2.5)}
    given = {"branch": 1, "progress": False}
    maps = sweep_both(mine, fl.table(columns), [f"{name}_extrema", "theta4_extrema"], **given)
    beside = np.geomspace(1e-9, 1e-2, 81)
    for k, dead in enumerate(maps["theta1_at_theta4_extrema"].values[:, :2]):
        near = (dead[:, None] + np.concatenate([-beside, [0.0], beside])).ravel()
        angles = np.unique(np.concatenate([np.linspace(0.0, 2.0 * np.pi, 4000, endpoint=False), near]))
        design = fl.table({length: values[k : k + 1] for length, values in columns.items()})
        values = sweep_both(mine, design, [name], **given, theta1=angles)[name].values.ravel()
        rises = np.sign(np.diff(values, append=values[0]))
        rises = rises[rises != 0.0]
        assert maps[f"{name}_extrema_count"][k] == (rises != np.roll(rises, 1)).sum(), k


def values_of(parameters, *lines, kinked=()):
    """Return what vanishes at the kinks of a formula and its smooth values, as texts."""
    graph = GraphAsWritten(FUNCTIONS)
    root = graph.read(Formula("f", parameters, lines), [*map(graph.name, parameters)])
    found = split(graph, root, dict(kinked))
    return [["; ".join(generate_formula("f", graph, one, {}).lines) for one in values] for values in found]


def test_a_text_is_split_at_its_kinks():
    switches, pieces = values_of(
        "xy", "a = absolute(x)", "return a * choice(y != y, y, choice(y > 1.0, y, 1.0))"
    )
    assert sorted(switches) == ["return x", "return y - 1.0"]
    assert sorted(pieces) == ["return -x * 1.0", "return -x * y", "return x * 1.0", "return x * y"]
    assert values_of("x", "return x * x") == [[], []]
    # a parameter with kinks of its own is replaced by what it is between these
    _, inner = values_of("x", "return x + 1.0", kinked={"x": ("x_piece0", "F21")})
    assert inner == ["return x_piece0 + 1.0", "return F21 + 1.0"]
    _, beside = values_of("xy", "return x + y", kinked={"x": ("y", "z")})
    assert beside == ["return y + y", "return z + y"]
    # one kink in two lines is one, and what nothing is made of has none
    assert values_of("xy", "a = absolute(y)", "return absolute(x) + absolute(x)")[0] == ["return x"]


# == Extremes of what is made of angles as numbers, which jump; and of the greater of values that change sign

planar = fl.extend("planar_4r")
slider = fl.extend("slider_crank")
hart = fl.extend("hart")
declare_all(
    planar,
    {
        "turned_by(theta4, theta2)": ("rad", "theta4 - 2 * theta2"),
        "of_half(theta2)": ("1", "np.sin(theta2 / 2)"),
        "unrolled(theta4, a3, theta1)": ("m", "a3 * theta4 * np.cos(theta1)"),
        "larger(theta4, turned_by)": ("rad", "max(theta4, 0.3 * turned_by)"),
        "lowest(F21_y, F43_y)": ("N", "min(F21_y, F43_y)"),
        "ahead(theta4, theta1)": ("rad", "theta4 - theta1"),
        "periodic(theta4, theta1)": ("1", "np.cos(theta4 - 2 * theta1)"),
        "torque_ratio(omega1, omega4)": ("1", "omega1 / omega4"),
        "even(omega4)": ("s2", "1.0 / (omega4 * omega4)"),
        "slope_of_output(theta4)": ("1", "math.tan(theta4)"),
        "over_height(A_y)": ("m-1", "1.0 / A_y"),
        "with_limit(A_y, omega4)": ("rad s-1", "A_y * omega4 / A_y"),
        "within(torque_ratio)": ("1", "1.0 + torque_ratio"),
        "undone(omega1, torque_ratio)": ("rad s-1", "omega1 / torque_ratio"),
    },
)
declare_all(slider, {"twice(theta2)": ("rad", "2 * theta2 + 0.1")})
declare_all(hart, {"shifted(psi)": ("rad", "0.5 - psi / 3")})


RANGES = {"a1": (0.2, 2.5), "a2": (0.5, 2.5), "a3": (0.5, 2.5), "a4": (0.3, 1.5)}
PLANAR = ["turned_by", "of_half", "unrolled", "larger", "lowest"]
CASES = {
    "planar": (planar, fl.sobol(150, RANGES, seed=3).with_constants({"omega1": 1.0}), PLANAR),
    "slider": (
        slider,
        fl.sobol(40, {"r": (0.1, 0.4), "l": (0.1, 0.5), "e": (0.0, 0.1)}).with_constants({"omega": 1.0}),
        ["twice"],
    ),
    "hart": (hart, {"m": 4.0, "n": 8.0, "d": 6.0, "kappa": [0.4, 0.5, 0.6]}, ["shifted"]),
}
ANGLES = 7200


@pytest.mark.parametrize("case", [pytest.param(c, marks=[pytest.mark.stress] * (c != "hart")) for c in CASES])
def test_no_dense_sample_is_beyond_an_extreme_of_what_jumps(case):
    mechanism, designs, names = CASES[case]
    links = {"links": BARS} if mechanism is planar else {}
    given = {"branch": (1, 2), "progress": False, **links}
    curves = sweep_both(mechanism, designs, names, **given, positions=ANGLES)
    wanted = [f"{name}_{end}{more}" for name in names for end in ("min", "max") for more in ("", "_error")]
    maps = sweep_both(mechanism, designs, wanted, **given)
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
    maps = sweep_both(planar, design, ["larger_min", "larger_max"], verify=2)
    assert float(maps.larger_min[1]) != -float(maps.larger_max[0])
    assert maps.attrs["verify_mismatches"] == 0


def test_sides_of_jumps_are_verified_with_50_digits():
    design = {"a1": 2.0, "a2": 2.5, "a3": 2.2, "a4": 0.8, "omega1": 1.0}
    names = ["turned_by_max", "of_half_min", "unrolled_max"]
    names += ["unrolled_extrema", "larger_max", "larger_min_error"]
    maps = sweep_both(planar, design, names, verify=2)
    assert maps.attrs["verify_mismatches"] == 0
    for name in names[:5]:
        # the place of a jump is known to 2^-46 of the range, 64 roundings of the value's change over the turn
        assert maps[name].attrs["error_max_relative"] < 64 * 2.0**-52 * 20.0
    # a jump is no extreme of a list: only what the curve itself turns at
    curve = sweep_both(planar, design, ["unrolled"], positions=20000).unrolled.values
    steps = np.roll(curve, -1, axis=-1) - curve
    after = np.roll(steps, -1, axis=-1)
    turns = (steps * after < 0) & (abs(steps) < 0.1) & (abs(after) < 0.1)
    assert (maps.unrolled_extrema.notnull().sum("extremum").values == turns.sum(axis=-1)).all()


def test_what_reads_the_position_as_a_number_is_sampled():
    """The position jumps at the end of the turn, wherever that is: `ahead` once had other extremes than its curve."""
    design = {"a1": 0.5, "a2": 3.0, "a3": 2.5, "a4": 2.2, "omega1": 1.0}
    maps = sweep_both(planar, design, ["ahead_min", "ahead_max", "periodic_min"], positions=360)
    curve = sweep_both(planar, design, ["ahead"], positions=360)
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
    assert_equal(found, turns)


# == Quantities that pass infinity: their greatest and least values are infinite, wherever what divides them vanishes


#: What vanishes where each may be infinite, whether it is of one sign on both sides, and the built-in quantities.
POLES = {
    "torque_ratio": ("omega4", False),
    "even": ("omega4", True),
    "over_height": ("A_y", False),
    "within": ("omega4", False),
    "mechanical_advantage": ("omega4", False),
    "instant_centre_x": ("omega2", False),
    "instant_centre_y": ("omega2", False),
}


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", POLES)
def test_extremes_are_infinite_where_the_divisor_changes_its_sign(name):
    space = fl.sobol(200, a1=(0.2, 1.5), a2=(0.2, 1.5), a3=(0.2, 1.5)).with_constants(
        {"a4": 1.0, "omega1": 10.0}
    )
    wanted = [f"{name}_max", f"{name}_min", f"{name}_peak"]
    found = sweep_both(planar, space, wanted, verify=20)
    assert found.attrs["verify_mismatches"] == 0
    divisor, even_pole = POLES[name]
    angles = np.linspace(0.001, 2.0 * np.pi, 720, endpoint=False)
    dense = sweep_both(planar, space, [divisor, name, "theta4"], angles=angles)
    dense = dense.where(dense.theta4.notnull())  # where the linkage assembles
    sign = np.sign(dense[divisor])
    turns = ((sign * sign.roll(theta1=1)) < 0).any("theta1") & sign.notnull().all("theta1")
    assert turns.any()
    # a quotient of two that vanish at one place has a limit; of 200 designs none does but by chance
    high, low = (found[f"{name}_{end}"] for end in ("max", "min"))
    assert np.isposinf(high.where(turns, np.inf)).all()
    assert even_pole or np.isneginf(low.where(turns, -np.inf)).all()
    assert np.isposinf(found[f"{name}_peak"].where(turns, np.inf)).all()
    # and no sample is beyond what is finite, but for its rounding
    assert not ((dense[name].max("theta1") - high) > 1e-9 * abs(high)).any()
    assert not ((low - dense[name].min("theta1")) > 1e-9 * abs(low)).any()


def test_places_bounds_and_lists_beside_poles():
    design = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
    names = ["torque_ratio_max", "torque_ratio_max_error", "theta1_at_torque_ratio_max"]
    names += ["even_extrema", "even_min"]
    names += ["with_limit_max", "undone_max", "omega4_max", "d_torque_ratio_max_d_a1", "slope_of_output_peak"]
    found = sweep_both(planar, design, names, verify=1)
    assert found.attrs["verify_mismatches"] == 0
    assert np.isposinf(found.torque_ratio_max_error).all()
    assert np.isnan(found.d_torque_ratio_max_d_a1).all()
    # the output link rests there: its rate is that of a place off by a few roundings, of some 50 rad/s per rad
    for branch in (1, 2):
        place = float(found.theta1_at_torque_ratio_max.sel(branch=branch))
        rest = fl.sweep("planar_4r", design, ["omega4"], branch=branch, angles=[place])
        assert abs(rest.omega4.item()) < 1e-11
    assert found.even_extrema_count.values.tolist() == [2, 2]
    assert (found.even_extrema.min("extremum") == found.even_min).all()
    # a divisor of what it stands beside leaves no pole
    for name in ("with_limit_max", "undone_max"):
        assert_allclose(found[name], found.omega4_max, rtol=1e-14)
    assert np.isposinf(found.slope_of_output_peak).all()
    arc = sweep_both(planar, design | {"arc_start": 0.5, "arc_end": 1.5}, names[:1]).torque_ratio_max
    dense = sweep_both(planar, design, ["torque_ratio"], angles=np.linspace(0.5, 1.5, 4001))
    assert_allclose(arc, dense.torque_ratio.max("theta1"), rtol=1e-5)


def test_poles_of_the_slider_crank_and_where_the_centre_is():
    space = fl.sobol(200, r=(0.05, 0.3), l=(0.1, 0.5), e=(-0.2, 0.2)).with_constants({"omega": 10.0})
    names = [
        f"{name}_{end}" for name in ("mechanical_advantage", "instant_centre_x") for end in ("max", "min")
    ]
    found = sweep_both("slider_crank", space, names, verify=20)
    assert found.attrs["verify_mismatches"] == 0
    turning = found.where(found.status == 0)
    assert all(np.isinf(turning[name].where(turning.status == 0, np.inf)).all() for name in names[:2])
    # both points of the rod move across the lines to its centre: O, A and the centre are in line, B below or above it
    at = fl.sweep(
        "slider_crank",
        space,
        ["instant_centre_x", "instant_centre_y", "A_x", "A_y", "slider_position"],
        branch=1,
    )
    scale = abs(at.instant_centre_x) + abs(at.instant_centre_y)
    # the centre is off by some roundings of A times its distance, which its rate over that of the crank is
    off = abs(at.A_x * at.instant_centre_y - at.A_y * at.instant_centre_x) / scale
    assert float(off.max()) < 1e-13
    away = abs(at.instant_centre_x - at.slider_position) / scale
    assert float(away.max()) < 1e-11


def test_centres_of_the_planar_4r_are_where_the_links_meet():
    design = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
    names = ["instant_centre_x", "instant_centre_y", "relative_centre_x", "A_x", "A_y", "B_x", "B_y"]
    at = sweep_4r(design, [*names, "mechanical_advantage", "omega4"], positions=50)
    x, y = at.instant_centre_x, at.instant_centre_y
    scale = abs(x) + abs(y) + 1.0
    # lines through A and O, and through B and D, meet there: roundings times how far it is
    assert float(abs(at.A_x * y - at.A_y * x).max() / scale.max()) < 1e-14
    assert float((abs((at.B_x - 1.0) * y - at.B_y * (x - 1.0)) / scale**2).max()) < 1e-13
    crossing = at.A_x - at.A_y * (at.B_x - at.A_x) / (at.B_y - at.A_y)
    assert_allclose(at.relative_centre_x, crossing, rtol=1e-11)
    # each is rounded on its own, and cancels next to where the output link rests
    assert_allclose(at.mechanical_advantage * at.omega4, 25.0, rtol=1e-13)

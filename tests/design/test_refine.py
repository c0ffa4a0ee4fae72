"""Refined designs: better, within the conditions, to the bits of a sweep, and nowhere near is a better one."""

import itertools
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import minimize
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r, sweep_both

import fastlink as fl
from fastlink.design.refine import FIRST_REACH, Descent, Outcome, Starts, descend, is_one_design
from fastlink.maps.units import flags_of

#: Of each mechanism: its inputs, and what is asked for.
MECHANISMS = {
    "planar_4r": (
        {"a1": (0.2, 0.5), "a2": (0.8, 1.3), "a3": (0.6, 1.2), "a4": 1.0, "omega1": 25.0},
        {"minimise": "omega4_max", "where": {"swing": (1.0, None), "status": "rotates_fully"}},
    ),
    "slider_crank": (
        {"r": (0.05, 0.15), "l": (0.2, 0.5), "e": (0.0, 0.05), "omega": 10.0},
        {"minimise": "slider_acceleration_max", "where": {"stroke": (0.2, None), "status": "rotates_fully"}},
    ),
    "focal": (
        {
            "a": (4.0, 6.0),
            "b": (4.0, 6.0),
            "c": (1.5, 2.5),
            "d": (3.0, 5.0),
            "rho": (0.5, 1.5),
            "completion": 1,
        },
        {"maximise": "transmission_angle_PQ_least", "where": {"status": "completed"}},
    ),
    "hart": ({"m": (3.0, 5.0), "n": (7.0, 9.0), "d": 6.0, "kappa": (0.3, 0.6)}, {"maximise": "stroke"}),
    "minkowski_4r": (
        {"a": (2.5, 3.5), "b": (4.5, 5.5), "g": (5.5, 6.5), "h": (3.5, 4.5)},
        {"minimise": "cosh_psi_max", "where": {"theta_max": (0.5, None)}},
    ),
}


def sampled(mechanism, n=256, **further):
    inputs, asked = MECHANISMS[mechanism]
    names = [
        asked.get("minimise", asked.get("maximise")),
        *(n for n in asked.get("where", ()) if n != "status"),
    ]
    return fl.sweep(mechanism, fl.sobol(n, inputs, seed=4), names, branch=1, **further), asked


@pytest.fixture(scope="module")
def rockers():
    return sampled("planar_4r")


def value_of(found, asked):
    sign = 1.0 if "minimise" in asked else -1.0
    return sign * found[asked.get("minimise", asked.get("maximise"))].values


def codes_of(found, name="refinement"):
    meanings = {code: meaning for meaning, code in flags_of(found[name]).items()}
    return [meanings[code] for code in found[name].values.tolist()]


@pytest.mark.sample(1)
@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_of_every_mechanism(mechanism):
    maps, asked = sampled(mechanism)
    inputs, _ = MECHANISMS[mechanism]
    ranges = {name: ends for name, ends in inputs.items() if isinstance(ends, tuple)}
    found = fl.best(maps, **asked, top=2, refine=True)
    starts = fl.best(maps, **asked, top=2)
    # better than all starts, by what it says
    assert value_of(found, asked)[0] <= value_of(starts, asked).min()
    name = asked.get("minimise", asked.get("maximise"))
    assert (found[f"{name}_gain"] > 0.0).all()
    # within the ranges and the conditions, to the bits of a sweep
    for key, (low, high) in ranges.items():
        assert ((found[key] >= low) & (found[key] <= high)).all()
    assert fl.best(found, **asked, top=2).sizes == found.sizes
    designs, names = found.fastlink.designs.drop_vars("active"), [*map(str, maps.data_vars)][:-1]
    again = fl.sweep(mechanism, designs, names, branch=1)
    for key in maps.data_vars:
        assert_array_equal(again[key], found[key])
    # of 4,000 designs about it, none that meets the conditions is better by more than they are apart to second order
    rng, best = np.random.default_rng(1), found.isel(design=0)
    assert codes_of(found)[0] == "converged"
    about = {key: np.full(4000, value) for key, value in inputs.items() if key not in ranges}
    for key, (low, high) in ranges.items():
        reach = 1e-3 * (high - low) * rng.uniform(-1.0, 1.0, 4000)
        about[key] = np.clip(float(best[key]) + reach, low, high)
    near = fl.sweep(mechanism, fl.table(about), [*map(str, maps.data_vars)][:-1], branch=1)
    others = value_of(fl.best(near, **asked, top=1), asked)
    assert (others >= value_of(found, asked)[0] - 1e-6 * abs(float(best[name]))).all()


def test_a_crank_rocker_as_by_its_own_formulas():
    """The greatest swing with transmission angles from 45 to 135 degrees: by the cosine law alone, from many starts.

    At the folded positions of crank and ground DB and BA make the extreme transmission angles; at those of crank and
    coupler the output link turns back.
    """

    def angle(opposite, one, other):
        return np.arccos((one**2 + other**2 - opposite**2) / (2.0 * one * other))

    def swing(x):
        a1, a2, a3 = x
        return abs(angle(a2 + a1, 1.0, a3) - angle(a2 - a1, 1.0, a3))

    def margins(x):
        a1, a2, a3 = x
        return np.array([angle(1.0 - a1, a2, a3) - np.pi / 4, 3 * np.pi / 4 - angle(1.0 + a1, a2, a3)])

    bounds, known = [(0.1, 0.6), (0.6, 1.4), (0.5, 1.2)], 0.0
    for start in itertools.product((0.15, 0.25), (0.8, 1.0), (0.6, 0.8)):
        with np.errstate(invalid="ignore"):
            one = minimize(lambda x: -swing(x), start, method="SLSQP", bounds=bounds, options={"ftol": 1e-14},
                           constraints={"type": "ineq", "fun": margins})  # fmt: skip
        if one.success and margins(one.x).min() > -1e-9:
            known = max(known, -one.fun)
    space = fl.grid(
        a1=np.linspace(0.1, 0.6, 11), a2=np.linspace(0.6, 1.4, 11), a3=np.linspace(0.5, 1.2, 11), a4=1.0
    )
    names = ["swing", "transmission_angle_min", "transmission_angle_max"]
    maps = fl.sweep("planar_4r", space, names, branch=1)
    where = {"status": "rotates_fully", "transmission_angle_min": (np.pi / 4, None)}
    where["transmission_angle_max_deg"] = (None, 135.0)
    found = fl.best(maps, maximise="swing", where=where, top=3, refine=True)
    # limits are kept by 1e-9 of their size, and the swing changes by a few times as much; SciPy's differences of
    # the oracle are right to 1e-8
    assert float(found.swing[0]) == pytest.approx(known, rel=1e-7)
    assert "transmission_angle_min >= 0.785398 rad" in str(found.active[0].item())
    assert "transmission_angle_max <= 2.35619 rad" in str(found.active[0].item())


def test_counterweights_of_berkof_and_lowen():
    """The shaking force vanishes where counterweights keep the mass centre at rest: m r = (m1 + m2) a1 / 2."""
    bar = 7750.0 * np.pi * 0.01**2
    m1, m2, m3 = (bar * a for a in (0.4, 1.2, 0.8))
    known = [(m1 + m2) * 0.5 * 0.4 / 0.2, (m2 + m3) * 0.5 * 0.8 / 0.4]
    space = fl.sobol(64, a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0, counterweight1_mass=(0.0, 7.8),
                     counterweight1_radius=0.2, counterweight3_mass=(0.0, 9.7), counterweight3_radius=0.4)  # fmt: skip
    bars = fl.round_bar(density=7750.0, radius=0.01)
    maps = fl.sweep("planar_4r", space, ["shaking_force_max"], links=bars, branch=1)
    found = fl.best(maps, minimise="shaking_force_max", top=1, refine=True)
    # a force is 1e3 N per kilogram that is off, and its rounding 1e-12 N
    masses = [float(found.counterweight1_mass[0]), float(found.counterweight3_mass[0])]
    assert_allclose(masses, known, rtol=1e-9)
    assert float(found.shaking_force_max[0]) < 1e-6


def test_a_position_is_found_too(rockers):
    """Of a quantity at each position a row has one: the best is at the greatest value over the cycle."""
    inputs, _ = MECHANISMS["planar_4r"]
    maps = sweep_4r(fl.sobol(16, inputs, seed=2), ["omega4", "omega4_max"], theta1=16)
    where = {"status": "rotates_fully", "branch": (1, 1)}
    found = fl.best(maps, maximise="omega4", where=where, top=2, refine=["a1"])
    assert_allclose(found.omega4, found.omega4_max, rtol=1e-9)
    assert ((found.theta1 >= 0.0) & (found.theta1 < 2.0 * np.pi)).all()
    again = fl.evaluate("planar_4r", ["omega4"], theta1=found.theta1.values, branch=found.branch.values,
                        **{key: found[key].values for key in inputs})  # fmt: skip
    assert_array_equal(again["omega4"], found.omega4)
    narrow = fl.best(
        maps, maximise="omega4", where={**where, "theta1_deg": (20.0, 70.0)}, top=2, refine=["a1"]
    )
    assert ((narrow.theta1 >= np.deg2rad(20.0)) & (narrow.theta1 <= np.deg2rad(70.0))).all()


def test_a_front_moves_out(rockers):
    maps = rockers[0].isel(design=slice(0, 64))
    aims = {"minimise": "omega4_max", "maximise": "swing", "where": {"status": "rotates_fully"}}
    front, finer = fl.best(maps, **aims), fl.best(maps, **aims, refine=True)
    assert ((finer.omega4_max_gain >= 0.0) & (finer.swing_gain >= 0.0)).all()
    assert float(finer.swing_gain.max()) > 0.0
    for speed, swing in zip(front.omega4_max.values, front.swing.values, strict=True):
        assert ((finer.omega4_max <= speed) & (finer.swing >= swing)).any()
    again = fl.best(finer, **aims)
    assert again.sizes["design"] == finer.sizes["design"]


def test_inputs_of_a_table_that_lie_on_a_line_stay_there():
    rng = np.random.default_rng(3)
    a2 = rng.uniform(0.9, 1.3, 60)
    columns = {"a1": rng.uniform(0.2, 0.4, 60), "a2": a2, "a3": a2, "a4": 0.5 * a2 + 0.6}
    maps = fl.sweep("planar_4r", fl.table(columns), ["transmission_angle_min", "swing"], branch=1)
    found = fl.best(maps, maximise="swing", where={"transmission_angle_min": (0.7, None)}, top=1, refine=True)
    assert float(found.swing_gain[0]) > 0.0
    assert_allclose(found.a3, found.a2, rtol=4e-16)
    assert_allclose(found.a4, 0.5 * found.a2 + 0.6, rtol=1e-15)


def test_only_named_inputs_change_and_what_is_at_its_best_already_stays(rockers):
    maps, asked = rockers
    start, found, once = (fl.best(maps, **asked, top=1, refine=one) for one in (False, "a2", True))
    for name in ("a1", "a3"):
        assert_array_equal(found[name], start[name])
    assert float(found.omega4_max_gain[0]) > 0.0
    space = {name: float(once[name].item()) for name in ("a1", "a2", "a3", "a4", "omega1")}
    space = fl.grid(**space | {"a1": [space["a1"], 1.1 * space["a1"]]})
    again = fl.sweep("planar_4r", space, ["omega4_max", "swing"], branch=1)
    again = fl.best(again, **asked, top=1, refine=True)
    assert codes_of(again) == ["nothing_to_gain"]
    assert_array_equal(again.omega4_max, once.omega4_max)
    assert_array_equal(again.omega4_max_gain, [0.0])


def test_a_map_that_the_mechanism_does_not_give_is_said(rockers):
    maps, asked = rockers
    changed = maps.assign(omega4_max=(maps.omega4_max + 0.1).assign_attrs(maps.omega4_max.attrs))
    found = fl.best(changed, **asked, top=1, refine=True)
    assert codes_of(found) == ["not_what_the_map_says"]
    assert_array_equal(found.a1, fl.best(changed, **asked, top=1).a1)


def test_a_code_is_a_border():
    """Nothing but the status bounds the crank: it grows up to where the linkage does not turn fully any more."""
    space = fl.grid(a1=np.linspace(0.1, 0.9, 5), a2=1.2, a3=0.8, a4=1.0)
    maps = fl.sweep("planar_4r", space, ["swing"], branch=1)
    found = fl.best(maps, maximise="a1", where="rotates_fully", top=1, refine=True)
    assert codes_of(found) == ["blocked_by_a_code_or_where_there_is_no_value"]
    # the border is at a1 = 0.8 + 1.0 - 1.2; steps end below 1e-10 of the range, tenfold shorter each
    assert 0.6 - 1e-6 < float(found.a1[0]) < 0.6
    assert codes_of(found, "status") == ["rotates_fully"]


def refused_cases(maps):
    """Yield requests, and what is said of them."""
    mask, cost = maps.a1 < 0.4, maps.assign(cost=maps.omega4_max + maps.a1)
    yield maps, {"refine": "a9"}, "refine", "a3"
    yield maps, {"refine": ["a4"]}, "refine", "known: a1, a2, a3"
    yield maps, {"refine": 1}, "refine", "True or False"
    yield maps, {"where": mask}, "where", "ranges"
    yield cost, {"minimise": "cost"}, "minimise", "leave refine out"
    yield maps.fastlink.degrees(), {"minimise": "swing"}, "swing", "before it was converted"
    single = sweep_4r(fl.grid(a1=[0.4], a2=1.2, a3=0.8, a4=1.0), ["swing"])
    yield single, {"minimise": "swing"}, "refine", "sweep the inputs"


def test_what_cannot_be_refined_is_refused(rockers):
    for maps, asked, key, remedy in refused_cases(rockers[0]):
        with refused(key, remedy):
            fl.best(maps, **{"minimise": "omega4_max", "refine": True} | asked)


def test_extremes_over_positions_that_a_map_does_not_hold_are_refused():
    space = fl.sobol(16, {"m": (3.0, 5.0), "n": (7.0, 9.0), "d": 6.0, "kappa": (0.3, 0.6)})
    given = {"input": "F_y", "F_y": np.linspace(-1.0, 1.0, 9), "branch": 1, "progress": False}
    maps = sweep_both("hart", space, ["A_y_max"], **given)
    with refused("minimise", "along F_y"):
        fl.best(maps, minimise="A_y_max", refine=True)
    both = sweep_both("hart", space, ["A_y_max", "A_y"], **given)
    found = fl.best(both, minimise="A_y_max", top=1, refine=True)
    assert float(found.A_y_max_gain[0]) > 0.0
    asked = {name: value for name, value in given.items() if name != "branch"}
    searched = fl.search("hart", space, minimise="A_y_max", top=1, **asked)
    assert float(searched.A_y_max[0]) == float(found.A_y_max[0])


# == Descents of numbers alone: kinks, bent limits, places without numbers, several objectives ===============

NONE = np.inf


def task(f, slopes, *, signs=(1.0,), low=(-NONE,), high=(NONE,), counts=None):
    """Return the task of results of single points, f(x) and its slopes."""

    def values(points):
        found = np.array([f(x) for x in points], dtype=float)
        return found, np.ones(len(points), bool) if counts is None else np.array([counts(x) for x in points])

    def slopes_of(points):
        return np.array([slopes(x) for x in points], dtype=float)

    return SimpleNamespace(values=values, slopes=slopes_of, limits=np.array((low, high, signs)))


def test_a_least_greatest_value_is_at_the_vertex_of_its_pieces():
    """max of three planes and a paraboloid: where the planes 3x - 1, 1 - x - y, 2y - 1 meet, x = 0.4, y = 0.5."""
    normals, offsets = np.array([[3.0, 0.0], [-1.0, -1.0], [0.0, 2.0]]), np.array([-1.0, 1.1, -0.8])

    def pieces(x):
        return normals @ x + offsets

    found = descend(
        task(lambda x: [pieces(x).max()], lambda x: [normals[pieces(x).argmax()]]), np.array([0.9, 0.05])
    )
    # 3x - 1 = 1.1 - x - y = 2y - 0.8
    vertex = np.linalg.solve([[4.0, 1.0], [3.0, -2.0]], [2.1, 0.2])
    assert found.outcome is Outcome.CONVERGED
    # SLSQP's precision is 1e-12 of the objective, the linear programs are exact on planes: 1e-9 of the ranges
    assert_allclose(found.point, vertex, atol=1e-9)


def test_a_bent_limit_is_kept_and_named():
    """The greatest x + y within the quarter circle of radius 0.7: at 45 degrees."""
    found = descend(
        task(
            lambda x: [x.sum(), x @ x], lambda x: [np.ones(2), 2.0 * x],
            signs=(-1.0, 0.0), low=(-NONE, -NONE), high=(NONE, 0.49),
        ),
        np.array([0.1, 0.3]),
    )  # fmt: skip
    assert found.values[1] <= 0.49
    # limits are kept by 1e-9 of their size, and sqrt(2 * 0.49) changes by no more than that relatively
    assert found.values[0] == pytest.approx(np.sqrt(2.0 * 0.49), rel=3e-9)
    assert (found.limits, found.ends) == ({(1, 1)}, set())


def test_ends_of_inputs_are_named_and_where_nothing_can_be_gained_the_start_stays():
    found = descend(task(lambda x: [x[0] - x[1]], lambda x: [[1.0, -1.0]]), np.array([0.5, 0.5]))
    assert_array_equal(found.point, [0.0, 1.0])
    assert found.ends == {(0, -1), (1, 1)}
    start = np.array([0.5, 0.25])
    found = descend(task(lambda x: [abs(x - start).sum()], lambda x: [np.sign(x - start + 1e-300)]), start)
    assert found.outcome is Outcome.NOTHING_TO_GAIN
    assert_array_equal(found.point, start)
    found = descend(task(lambda x: [x[0]], lambda x: [[np.nan]]), np.array([0.5]))
    assert found.outcome is Outcome.NO_DERIVATIVE_AT_THE_START


@pytest.mark.parametrize("blocked_by", ["a code", "no number"])
def test_what_does_not_count_is_not_entered(blocked_by):
    def f(x):
        return [np.nan if blocked_by == "no number" and x[0] < 0.2 else x[0]]

    counts = (lambda x: x[0] >= 0.2) if blocked_by == "a code" else None
    found = descend(task(f, lambda x: [[1.0, 0.0]], counts=counts), np.array([0.9, 0.5]))
    assert found.outcome is Outcome.BLOCKED_BY_A_CODE_OR_WHERE_THERE_IS_NO_VALUE
    # steps shrink tenfold as long as they lead across the border
    assert 0.2 <= found.point[0] < 0.2 + 1e-6


def test_several_objectives_fall_together():
    """Least distances from two points: better in both until between them."""
    a, b = np.array([0.2, 0.2]), np.array([0.8, 0.2])
    found = descend(
        task(
            lambda x: [(x - a) @ (x - a), (x - b) @ (x - b)], lambda x: [2.0 * (x - a), 2.0 * (x - b)],
            signs=(1.0, 1.0), low=(-NONE, -NONE), high=(NONE, NONE),
        ),
        np.array([0.4, 0.9]),
    )  # fmt: skip
    assert (found.values < [0.2**2 + 0.7**2, 0.4**2 + 0.7**2]).all()
    assert found.point[1] == pytest.approx(0.2, abs=1e-5)  # values are quadratic there: 1e-10 of them
    assert 0.2 <= found.point[0] <= 0.8


# == Starts that end in one design are told once, with their number, and the next different designs follow ===

mine = fl.extend("planar_4r")


@mine.quantity(units="1")
def wells(a1, a4):
    """Two wells of unlike depth over the crank, at 0.2 and 0.45 of the ground but for the slope."""
    x = a1 / a4
    return 400 * (x - 0.2) ** 2 * (x - 0.45) ** 2 + x / 10


#: The bottoms: where d/dx of 400 (x - 0.2)^2 (x - 0.45)^2 + x / 10 is 0, but for the hill between them.
BOTTOMS = np.polyder(400.0 * np.poly1d([0.2, 0.2, 0.45, 0.45], r=True) + np.poly1d([0.1, 0.0])).roots.real
BOTTOMS = np.sort(BOTTOMS)[[0, 2]]
RANGES = {"a1": (0.1, 0.55), "a2": 1.2, "a3": 0.8, "a4": 1.0}
#: The descent ends where less than 1e-10 is to be gained, so about the root of that over the curvature from the bottom.
NEAR = 1e-5


def test_of_a_map_and_of_a_search():
    space = fl.sobol(200, RANGES, seed=1)
    maps = fl.sweep(mine, space, ["wells"], branch=1)
    asked = {"minimise": "wells", "top": 4}
    found = fl.best(maps, **asked, refine=True, mechanism=mine)
    assert_allclose(np.sort(found.a1), BOTTOMS, atol=NEAR)
    assert float(found.a1[0]) < float(found.a1[1])  # the deeper one first
    assert int(found.starts.sum()) > 2
    assert f"from {int(found.starts.sum())} of these to 2 different designs" in found.attrs["selection"]
    searched = fl.search(mine, space, **asked)
    assert_array_equal(searched.a1, found.a1)
    assert_array_equal(searched.starts, found.starts)


def test_designs_of_a_front_that_are_the_same_are_told_once():
    """Copies of a design, off by less than the refinement leaves undone, are one design of the front."""
    a1 = np.concatenate([np.linspace(0.2, 0.4, 5)] * 2) + np.repeat([0.0, 1e-12], 5)
    space = fl.table({"a1": a1, "a2": np.tile(np.linspace(1.0, 1.2, 5), 2), "a3": 0.8, "a4": 1.0})
    asked = {"minimise": "a1", "maximise": "swing"}
    maps = fl.sweep("planar_4r", space, ["swing"], branch=1)
    assert fl.best(maps, **asked).sizes["design"] == 10
    found = fl.best(maps, **asked, refine="a2")
    # nothing but a2 may change: each start keeps its own a1, so that all ten differ
    assert found.sizes["design"] == 10
    found = fl.best(maps, **asked, refine=True)
    assert found.sizes["design"] <= 5
    assert int(found.starts.sum()) > found.sizes["design"]


@dataclass
class Line:
    """Points of a line, with one result that is to be least: what `is_one_design` asks of points."""

    curve: object

    limits = np.array([[-np.inf], [np.inf], [1.0]])

    def values(self, points):
        return self.curve(points), np.ones(len(points), dtype=bool)

    def place_of(self, design):
        return design


@pytest.mark.parametrize(
    ("hill", "apart", "same"),
    [
        (0.0, 1e-4, True),
        (1e-9, 1e-4, True),  # less than limits are kept by
        (1e-7, 1e-4, False),  # a hill
        (0.0, 2.0 * FIRST_REACH, False),  # farther than the refinement looks: a valley of equal designs
    ],
)
def test_what_lies_between_tells_whether_designs_are_one(hill, apart, same):
    line = Line(lambda points: 1.0 + hill * np.sin(np.pi * points / apart) ** 2)
    end = Descent(np.zeros(1), np.ones(1), Outcome.CONVERGED, np.ones(1))
    assert is_one_design(line, end, np.array([apart])) == same


def test_starts_are_the_best_of_each_neighbourhood():
    rng = np.random.default_rng(0)
    clusters = np.concatenate([centre + rng.uniform(-0.02, 0.02, (50, 2)) for centre in (0.2, 0.8)])
    starts = Starts(clusters, [()] * 100, 1000, top=10)
    order = []
    for row in starts:
        order.append(row)
        starts.ended(row, clusters[row])
    assert order == [0, 50]
    # of other assembly modes, or with other inputs that stay, they are no neighbours
    starts = Starts(clusters, [(k % 2,) for k in range(100)], 1000, top=10)
    assert [*starts] == [0, 1, 50, 51]
    # the number of starts is limited
    assert len([*Starts(rng.uniform(size=(2000, 6)), [()] * 2000, 10**9, top=3)]) == 10

"""Linkages for tasks: cases of the literature, random linkages found again, defects, doors."""

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose, assert_array_equal

import fastlink as fl
from fastlink.codegen.kernel import load_kernel
from fastlink.design import search
from fastlink.synthesis import found as doors
from fastlink.synthesis import functions, kernels, paths
from fastlink.synthesis.found import DEFECTS, Linkages, cognates_of, judged
from fastlink.synthesis.poses import dyads_of_five
from tests.synthesis.test_nine_points import POINTS

TURN = 2.0 * np.pi
#: Kunjur, Krishnamurty 1997, as later papers use it: 18 points, a step of 20 degrees of the crank each.
KUNJUR = [(0.5, 1.1), (0.4, 1.1), (0.3, 1.1), (0.2, 1.0), (0.1, 0.9), (0.05, 0.75), (0.02, 0.6), (0, 0.5), (0, 0.4),
          (0.03, 0.3), (0.1, 0.25), (0.15, 0.2), (0.2, 0.3), (0.3, 0.4), (0.4, 0.5), (0.5, 0.7), (0.6, 0.9),
          (0.6, 1.0)]  # fmt: skip
ARC = [(3, 3), (2.759, 3.363), (2.372, 3.663), (1.890, 3.862), (1.355, 3.943)]
ELLIPSE = [(20, 10), (17.66, 15.142), (11.736, 17.878), (5, 16.928), (0.60307, 12.736), (0.60307, 7.2638), (5, 3.0718),
           (11.736, 2.1215), (17.66, 4.8577)]  # fmt: skip
POSES = np.array([(0.943625, 1.338128, 46.092477), (0.969123, 1.594198, 31.440725), (0.548548, 1.684502, 21.448516),
                  (-0.069327, 1.283887, 21.110821), (-0.338809, 0.726122, 33.866682)])  # fmt: skip
POSES[:, 2] = np.radians(POSES[:, 2])


def points_of(found, design=0):
    """Return where the coupler point of a result is, in the frame of the task, by the facts of the mechanism alone."""
    row = found.isel(design=design)
    inputs = {name: float(row[name]) for name in ("a1", "a2", "a3", "a4", "P_u", "P_v")}
    at = fl.evaluate(
        "planar_4r", ["P_x", "P_y", "theta2"], branch=int(row.branch), theta1=row.theta1.values, **inputs
    )
    place = complex(row.O_x, row.O_y) + np.exp(1j * float(row.ground_angle)) * (at["P_x"] + 1j * at["P_y"])
    return place, at["theta2"] + float(row.ground_angle)


def random_crank(rng):
    """Return a crank-rocker of random lengths, and a random coupler point."""
    while True:
        lengths = np.sort(rng.uniform(0.1, 1.0, 4))
        if lengths[0] + lengths[3] < 0.98 * (lengths[1] + lengths[2]):
            a2, a3, a4 = rng.permutation(lengths[1:])
            point = rng.uniform(-1, 1, 2)
            return {"a1": lengths[0], "a2": a2, "a3": a3, "a4": a4, "P_u": point[0], "P_v": point[1]}


def path_of(rng, theta):
    """Return points of a random crank-rocker at crank angles."""
    design = random_crank(rng)
    at = fl.evaluate("planar_4r", ["P_x", "P_y"], branch=int(rng.integers(1, 3)), theta1=theta, **design)
    return np.stack([at["P_x"], at["P_y"]], axis=1)


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("task", "least"),
    [
        ({"path": KUNJUR, "timing": np.radians(20 * np.arange(18)), "closed": True}, 0.0090288760),
        ({"path": ARC, "timing": np.radians([30, 45, 60, 75, 90]),
          "fixed": {"O_x": 0, "O_y": 0, "ground_angle": 0, "phase": 0}}, 7.4157513e-7),
        ({"path": [*ELLIPSE, (20, 10)], "bounds": {f"a{k}": (5, 80) for k in (1, 2, 3, 4)}
          | {k: (-80, 80) for k in ("P_u", "P_v", "O_x", "O_y")}}, 0.000401992054),
    ],
    ids=["kunjur18", "arc5", "ellipse10"],
)  # fmt: skip
def test_cases_of_the_literature(task, least):
    """The sum of squares of each is at or below the least that is known, by the facts of the mechanism."""
    found = fl.synthesise("planar_4r", top=1, seed=3, **task)
    place, _ = points_of(found)
    off = np.abs(place - np.asarray(task["path"]) @ [1, 1j])
    assert np.sum(off**2) < least * (1 + 2e-6)
    assert_allclose(found.point_error[0], off, atol=1e-12 * np.abs(place).max())
    assert found.defect.item() == 0
    if "bounds" in task:
        assert "a4 <= 80 m" in found.active.item()
        assert (np.diff(found.theta1[0]) * int(found.order[0]) > 0).all()
        assert abs(float(found.theta1[0, -1] - found.theta1[0, 0])) == pytest.approx(TURN)


@pytest.mark.stress
def test_a_random_linkage_comes_back_from_points_of_its_closed_curve():
    """Of 12 points the 9 + 12 unknowns are fixed: an error of 1e-10 of the size is the linkage, or a cognate of it."""
    rng = np.random.default_rng(5)
    points = path_of(rng, np.sort(rng.uniform(0, TURN, 12)))
    found = fl.synthesise("planar_4r", path=points, closed=True)
    size = np.abs(points @ [1, 1j] - points.mean(axis=0) @ [1, 1j]).max()
    assert float(found.path_error[0]) < 1e-10 * size
    first = found.isel(design=found.cognate_of.values == 0)
    assert first.sizes["design"] >= 2  # it turns by the cranks of two cognates
    assert (first.path_error < 1e-9 * size).all()


@pytest.mark.stress
def test_a_whole_curve_is_compared_as_a_whole():
    """An ellipse of 60 points: what the distances are is of the 200 places, a step of 2 pi / 200 each."""
    angle = TURN * np.arange(60) / 60
    ellipse = np.stack([np.cos(angle), 0.6 * np.sin(angle)], axis=1)
    found = fl.synthesise("planar_4r", path=ellipse, closed=True, top=1)
    assert float(found.chamfer[0]) < 2 * TURN / 200
    assert float(found.ordered_distance[0]) < TURN * (TURN / 200) ** 2 / 100
    # links of up to 20 times the curve come so near; longer ones ever nearer
    found = fl.synthesise("planar_4r", path=ellipse, closed=True, top=1, minimise="path_error")
    assert float(found.path_error_max[0]) < 3e-4


@pytest.mark.stress
def test_nothing_is_drawn_beside_a_curve():
    """An aerofoil, NACA 2412: linkages that pass its points in order and swing far out after its tail come last."""
    x = (1 - np.cos(np.linspace(0, np.pi, 40))) / 2
    half = 0.6 * (0.2969 * np.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    line = 0.02 * np.where(x < 0.4, x * (0.8 - x) / 0.16, (0.2 + x * (0.8 - x)) / 0.36)
    path = np.append(x + 1j * (line + half), (x + 1j * (line - half))[-2:0:-1])
    found = fl.synthesise("planar_4r", path=path, closed=True, top=1)
    # both ways within a step of the 200 places of a curve that is about 5 long
    assert float(found.chamfer[0]) < 2 * 5 / 200
    assert float(found.ordered_distance[0]) < TURN * (5 / 200) ** 2


@pytest.mark.stress
@pytest.mark.parametrize("span", [0.55, 1.0, 2.5])
def test_a_random_linkage_comes_back_from_points_of_an_arc(span):
    """Arcs of many linkages are alike: those through nine of the points are among the starts."""
    rng = np.random.default_rng(8)
    points = path_of(rng, rng.uniform(0, TURN) + np.sort(rng.uniform(0, span, 12)))
    found = fl.synthesise("planar_4r", path=points, top=1)
    assert float(found.path_error[0]) < 1e-10 * np.abs((points - points.mean(axis=0)) @ [1, 1j]).max()


def test_five_poses_have_all_their_dyads():
    """Four dyads, one of them with a radius 29 times the other's; residuals are of rounding alone."""
    found = fl.synthesise("planar_4r", motion=POSES, top=20)
    assert found.attrs["complete"] == "all 4 dyads of five poses, 12 linkages"
    known = found.isel(design=int(np.argmin(np.abs(found.a1.values - 0.8) + np.abs(found.a3.values - 1.5))))
    assert_allclose([known.a2, known.a4, known.P_u, known.P_v], [1.7, 2.0, 0.9, 0.6], atol=2e-5)
    place, theta2 = points_of(found)
    turn = np.exp(1j * (theta2 + float(found.body_angle[0]))) - np.exp(1j * POSES[:, 2])
    assert np.abs(place - POSES @ [1, 1j, 0]).max() < 1e-14
    assert np.abs(turn).max() < 1e-14
    assert found.defect.values[:4].tolist() == [0] * 4
    assert set(found.defect.values[4:].tolist()) == {2}


def test_dyads_of_random_poses_are_as_many_as_the_resultant_has_real_roots():
    """Against the roots of a resultant in a null space by SVD, on random tasks; each dyad leaves no circle."""
    rng, count = np.random.default_rng(0), 300
    poses = np.concatenate(
        [rng.uniform(-1, 1, (count, 5, 2)), rng.uniform(-np.pi, np.pi, (count, 5, 1))], axis=2
    )
    d, e = poses[..., 0] + 1j * poses[..., 1], np.exp(1j * poses[..., 2])
    centre, pin = dyads_of_five(d, poses[..., 2])
    radius = np.abs(d[:, None] + e[:, None] * pin[..., None] - centre[..., None])
    assert np.nanmax(np.ptp(radius, axis=-1) / np.maximum(1, radius.max(axis=-1))) < 1e-13
    assert np.isfinite(centre).sum(axis=1).tolist() == [real_dyads(*one) for one in zip(d, e, strict=True)]


def real_dyads(d, e):
    """Return how many dyads five poses have, from the resultant of two conics in a null space of SVD."""
    m = np.conj(d) * e
    rows = np.c_[
        np.abs(d) ** 2, 2 * m.real, -2 * m.imag, -2 * d.real, -2 * d.imag, -2 * e.real, 2 * e.imag, np.ones(5)
    ]
    basis = np.linalg.qr(np.random.default_rng(0).standard_normal((3, 3)))[0] @ np.linalg.svd(rows)[2][-3:]

    def form(a):
        p = a @ basis
        return p[0] * (p[5] + 1j * p[6]) - (p[3] - 1j * p[4]) * (p[1] + 1j * p[2])

    unit, poly = np.eye(3), np.polynomial.polynomial
    both = np.array([[(form(u + v) - form(u) - form(v)) / 2 for u in unit] for v in unit])
    (a1, b1, c1), (a2, b2, c2) = (
        (q[2, 2], 2 * q[:2, 2], np.array([q[0, 0], 2 * q[0, 1], q[1, 1]])) for q in (both.real, both.imag)
    )
    u, v = poly.polysub(a1 * c2, a2 * c1), poly.polysub(a1 * b2, a2 * b1)
    w = poly.polysub(poly.polymul(b1, c2), poly.polymul(b2, c1))
    roots = poly.polyroots(poly.polysub(poly.polymul(u, u), poly.polymul(v, w)))
    return int(np.count_nonzero(np.abs(roots.imag) < 1e-7 * (1 + np.abs(roots))))


@pytest.mark.sample(1)
@pytest.mark.parametrize("count", [2, 3, 4])
def test_fewer_poses_are_met_exactly_by_the_best_of_a_family(count):
    found = fl.synthesise("planar_4r", motion=POSES[:count], top=3)
    assert found.sizes["design"] == 3
    assert (found.pose_error < 1e-12).all()  # links up to 15 times the size, each pose to its rounding
    assert (found.defect == 0).all()
    used = found.least_transmission_angle_used.values
    assert (np.diff(used) <= 0).all()
    assert used[0] > np.radians(45)


KNOWN = {"a1": 0.8, "a2": 1.7, "a3": 1.5, "a4": 2.0, "P_u": 0.9, "P_v": 0.6}


def poses_of_known(rng):
    """Return eight poses of the coupler of a known linkage."""
    theta = np.sort(rng.uniform(0, 3, 8))
    at = fl.evaluate("planar_4r", ["P_x", "P_y", "theta2"], branch=2, theta1=theta, **KNOWN)
    return np.stack([at["P_x"], at["P_y"], at["theta2"]], axis=1)


def test_more_poses_are_met_by_the_linkage_that_made_them():
    poses = poses_of_known(np.random.default_rng(2))
    found = fl.synthesise("planar_4r", motion=poses, rotation_length=1.0, top=1)
    assert float(found.pose_error[0]) < 1e-13
    assert {name: float(found[name][0]) for name in KNOWN} == pytest.approx(KNOWN, abs=1e-9)


def test_five_timed_points_are_exact():
    theta = np.array([0.2, 1.0, 1.7, 3.0, 4.0])
    points = path_of(np.random.default_rng(4), theta)
    found = fl.synthesise("planar_4r", path=points, timing=theta - 0.7, exact=True, top=20)
    assert found.attrs["complete"].startswith("all ")
    good = found.isel(design=found.defect.values == 0)
    assert good.sizes["design"] >= 1
    assert float(good.path_error[0]) < 1e-13
    assert_allclose(np.diff(good.theta1[0]), np.diff(theta), atol=1e-12)


def test_nine_points_have_all_their_linkages_with_their_defects():
    """Problem 3 of Wampler, Morgan, Sommese 1992: 64 real triples (alphaCertified), of which one linkage, and its
    cognate with the same crank, pass the points in order by a crank that turns.
    """
    found = fl.synthesise("planar_4r", path=POINTS[3], exact=True, closed=True, top=400)
    assert found.attrs["complete"] == "all 64 real of 1,442 triples of cognates"
    assert found.sizes["design"] == 384
    assert found.defect.values[:3].tolist()[:2] == [0, 0]
    assert found.defect.values[2] > 0
    place, _ = points_of(found)
    assert np.abs(place - np.array(POINTS[3]) @ [1, 1j]).max() < 1e-12


def test_the_greatest_error_of_a_function_equioscillates():
    """At the optimum of five free numbers the greatest error stands at least six times with changing signs."""
    found = fl.synthesise("planar_4r", function=np.square, over=(0, 1), turn_deg=(90, 90), top=1)
    greatest = float(found.structural_error[0])
    assert np.degrees(greatest) < 0.0669885
    peaks = found.peak_error.values[0]
    high = peaks[np.abs(peaks) > greatest * (1 - 1e-6)]
    assert len(high) >= 6
    assert (high[1:] * high[:-1] < 0).all()
    row = found.isel(design=0)
    turn = np.linspace(0, np.pi / 2, 5001)
    lengths = {name: float(row[name]) for name in ("a1", "a2", "a3", "a4")}
    at = fl.evaluate(
        "planar_4r", ["theta4"], branch=int(row.branch), theta1=float(row.theta1[0]) + turn, **lengths
    )
    wanted = float(row.theta4[0]) + int(row.sense) * np.pi / 2 * (turn / (np.pi / 2)) ** 2
    off = np.abs(np.remainder(at["theta4"] - wanted + np.pi, TURN) - np.pi)
    assert off.max() == pytest.approx(
        greatest, rel=1e-5
    )  # 5001 places miss an extreme by the square of their step


@pytest.mark.sample(1)
@pytest.mark.parametrize("points", [3, 4, 5])
def test_precision_points_are_met(points):
    found = fl.synthesise(
        "planar_4r", function=np.log10, over=(1, 2), turn_deg=(60, 60), precision_points=points, top=2
    )
    assert float(np.abs(found.output_error).max()) < 1e-9
    assert (found.structural_error > 1e-9).all()


def linkage(theta, lengths=(1.0, 3.0, 2.5, 3.5), side=1.0):
    """Return a four-bar of four lengths, or a slider-crank of three."""
    numbers = np.zeros((1, 10))
    numbers[0, : len(lengths)], numbers[0, 4:6] = lengths, 0.5
    theta = np.array([theta], dtype=float)
    side = np.broadcast_to(side, theta.shape).astype(float)
    return Linkages(numbers, theta, side, np.ones(1, dtype=np.int64), slider=len(lengths) == 3)


@pytest.mark.parametrize(
    ("found", "closed", "meaning"),
    [
        (linkage([0, 1, 2, 3]), False, "no_defect"),
        (linkage([0, 1, 2, -1]), True, "no_defect"),
        (linkage([0, 2, 1, 3]), False, "order_defect"),
        (linkage([0, 1, 2], side=np.array([1, -1, 1])), False, "circuit_defect"),
        (linkage([0.5, 1, 1.5], (2, 2, 2, 3.9), np.array([1, -1, 1])), False, "branch_defect"),
        (linkage([0.5, 1.0, 2.5], (2, 2, 2, 3.9)), False, "dead_point"),
        (linkage([-0.5, 0.1, 0.5], (2, 2, 2, 3.9)), True, "dead_point"),
        (linkage([0, 1, 2, 3], (1, 2, 0.5), -1), True, "no_defect"),
        (linkage([0, 2, 1, 3], (1, 2, 0.5), -1), False, "order_defect"),
        (linkage([0, 1, 2], (1, 2, 0.5), np.array([1, -1, 1])), False, "circuit_defect"),
        # r = 2 turns over where |2 sin - 0.5| < 1: up to 48.6 degrees on either side of the pivot, which are circuits
        (linkage([-0.2, 0.2, 0.7], (2, 1, 0.5), np.array([1, -1, 1])), False, "branch_defect"),
        (linkage([0.2, 0.7, np.pi - 0.2], (2, 1, 0.5), -1), False, "circuit_defect"),
        # r = 2, l = 1.8, e = 0.5: no link turns; the upper toggle lies beyond, the lower one at -40.5 degrees
        (linkage([-1.0, 0.5, 1.0], (2, 1.8, 0.5), -1), False, "dead_point"),
        (linkage([-0.5, 0.5, 1.0], (2, 1.8, 0.5), -1), True, "dead_point"),
    ],
)
def test_defects_are_told(found, closed, meaning):
    """The input of (2, 2, 2, 3.9) turns as far as AD = 4: by 78 degrees to both sides."""
    assert DEFECTS[int(judged(found, closed, False).more["defect"][0])] == meaning


def test_cognates_draw_the_same_curve():
    found = linkage([0.3, 1.0, 2.0, 4.0])
    six = cognates_of(found)
    assert six.more["cognate"].tolist() == [1, 1, 2, 2, 3, 3]
    point = six.pins()[-1]
    assert_allclose(point, np.repeat(found.pins()[-1], 6, axis=0), atol=1e-13)


SLIDER = {"mechanism": "slider_crank"}
LOG = SLIDER | {"function": np.log10, "over": (1, 2)}


@pytest.mark.parametrize(
    ("task", "line"),
    [
        ({"path": [(0, 0)]}, "path has 1 point; give at least 2 points"),
        ({"path": [(0, 0), (0, 0), (1, 1)]}, "path has the same point in rows 0 and 1; leave one of them out"),
        ({"path": [(0, 0), (np.nan, 0)]}, "path is not finite in row 1; leave that row out"),
        ({"motion": [(0, 0, 0), (0, 0, 0)]}, "motion has the same pose in rows 0 and 1"),
        ({"motion": np.eye(7, 3)[:, ::-1] + np.arange(7)[:, None]}, "rotation_length is missing"),
        ({"motion": POSES, "fixed": {"phase": 0.1}}, "phase is of a path with timing; leave it out"),
        ({"path": ARC, "bounds": {"b1": (0, 1)}}, "bounds: 'b1' is no number of a linkage"),
        ({"path": ARC, "where": {"swin": (0, 1)}}, "where: quantity 'swin' is unknown"),
        ({"path": ARC, "over": (1, 2)}, "over is for function=...; leave it out"),
        ({"function": np.log10, "over": (1, 2)}, "turn_deg is missing; write the turns of both shafts"),
        ({"path": ARC, "exact": True}, "exact is for nine points, or five with timing"),
        ({"path": ARC, "timing": list("abcde")}, "timing has the shape (0,), and there are 5 points"),
        ({"function": lambda x: 1 / 0, "over": (0, 1), "turn_deg": (60, 60)}, "function: cannot be called"),
        ({}, "synthesise has no task"),
        (LOG, "turn_deg is missing; write the turn, such as"),
        (LOG | {"turn_deg": (0, 400)}, "turn_deg is (0, 400); write a turn up to"),
        (LOG | {"function": lambda x: 0 * x, "turn_deg": 60}, "function has one value alone"),
        (LOG | {"turn_deg": 60, "travel": 0.0}, "travel is 0.0; write how far"),
        (SLIDER | {"path": np.eye(2), "exact": True}, "exact is for planar_4r"),
        (SLIDER | {"path": ARC, "bounds": {"a1": (0, 1)}}, "bounds: 'a1' is no number of a linkage"),
        (SLIDER | {"path": ARC, "bounds": {"r": (-1, 0)}}, "bounds: r is (-1, 0), and a length is positive"),
        (SLIDER | {"motion": POSES}, "rotation_length is missing: over four poses"),
    ],
)  # fmt: skip
def test_bad_tasks_are_refused_with_a_remedy(task, line):
    with pytest.raises(fl.InputError) as error:
        fl.synthesise(**{"mechanism": "planar_4r"} | task)
    assert str(error.value).startswith(line)


@pytest.mark.stress
def test_conditions_and_other_objectives_hold_at_the_end():
    """The least error with an angle of 50 degrees at least is at that limit; the least greatest distance is less."""
    ask = {"path": KUNJUR, "timing": np.radians(20 * np.arange(18)), "closed": True, "top": 1}
    found = fl.synthesise("planar_4r", where={"least_transmission_angle_deg": (50, None)}, **ask)
    assert np.radians(50) <= float(found.least_transmission_angle[0]) < np.radians(50 + 1e-6)
    assert float(found.path_error_sum[0]) < 0.01123885
    greatest = fl.synthesise("planar_4r", minimise="path_error_max", **ask)
    assert float(greatest.path_error_max[0]) < 0.030625 < float(found.path_error_max[0])


@pytest.mark.parametrize("mechanism", ["planar_4r", "slider_crank"])
def test_a_family_of_poses_is_searched_for_the_best(monkeypatch, mechanism):
    """Changes that are ever smaller: better than the best of the family's sample, and each pose to its rounding."""
    ask = {"motion": POSES[:3], "maximise": "least_transmission_angle", "where": {"status": "rotates_fully"}}
    made = []
    for changes in ([], 0.3 * 0.4 ** np.arange(5)):
        monkeypatch.setattr(doors, "CHANGES", changes)
        made.append(fl.synthesise(mechanism, top=1, **ask))
        assert float(made[-1].pose_error[0]) < 1e-12  # links up to 15 times the size
        assert made[-1].status.item() == made[-1].defect.item() == 0
    sample, best = (np.degrees(float(one.least_transmission_angle[0])) for one in made)
    assert sample + 0.1 < best < 90


@pytest.mark.parametrize(
    ("mechanism", "count", "fixed"),
    [
        ("planar_4r", 2, {"O_x": 0.0, "O_y": 0.0}),
        ("planar_4r", 3, {"P_u": 0.0, "P_v": 0.0}),
        ("planar_4r", 3, {"a1": 0.7, "a4": 2.0, "ground_angle": 0.3}),
        ("planar_4r", 4, {"O_x": 0.5, "a4": 2.0}),
        ("slider_crank", 2, {"ground_angle": 0.2, "e": 0.05}),
    ],
)
def test_numbers_that_are_given_are_met_in_a_family_of_poses(monkeypatch, mechanism, count, fixed):
    """To the last bit. Links are up to 15 times the size of the poses, 1: these are met to some roundings of that."""
    monkeypatch.setattr(doors, "CHANGES", 0.3 * 0.4 ** np.arange(5))
    found = fl.synthesise(mechanism, motion=POSES[:count], fixed=fixed, top=2)
    assert found.sizes["design"]
    assert "missed" not in found
    for name, value in fixed.items():
        assert (found[name] == value).all()
    assert float(found.pose_error.max()) < 1e-12
    assert (found.defect == 0).all()


def test_two_pivots_and_three_poses_have_one_linkage(monkeypatch):
    """Its pins have equal distances from the places of the pivots in the body: two linear equations each."""
    monkeypatch.setattr(doors, "CHANGES", [0.3])
    o, d = 0.1 + 0.0j, 2.0 + 0.1j
    fixed = {"O_x": o.real, "O_y": o.imag, "D_x": d.real, "D_y": d.imag}
    found = fl.synthesise("planar_4r", motion=POSES[:3], fixed=fixed)
    assert found.sizes["design"] == 1
    assert (found.O_x.item(), found.O_y.item()) == (o.real, o.imag)
    # D is O and a4 in a direction: some roundings of 2
    assert complex(found.D_x.item(), found.D_y.item()) == pytest.approx(d, abs=4 * 2.2e-16 * 2)
    pins = []
    for pivot in (o, d):
        q = np.exp(-1j * POSES[:3, 2]) * (pivot - POSES[:3] @ [1, 1j, 0])
        rows = np.stack([np.diff(q).real, np.diff(q).imag], axis=1)
        pins.append(complex(*np.linalg.solve(rows, np.diff(np.abs(q) ** 2) / 2)))
        assert np.linalg.cond(rows) < 100  # of some roundings each
    known = abs(q[0] - pins[1]), abs(pins[1] - pins[0])
    assert_allclose([found.a3[0], found.a2[0]], known, rtol=1e-13)


def test_a_pivot_of_four_poses_is_on_their_curve_or_refused(monkeypatch):
    monkeypatch.setattr(doors, "CHANGES", [0.3])
    free = fl.synthesise("planar_4r", motion=POSES[:4], top=1)
    place = {name: float(free[name][0]) for name in ("O_x", "O_y")}
    found = fl.synthesise("planar_4r", motion=POSES[:4], fixed=place, top=1)
    assert {name: float(found[name][0]) for name in place} == place
    assert float(found.pose_error[0]) < 1e-12
    with pytest.raises(
        fl.InputError, match=r"off the centre-point curve .*fix O_x alone, for which O_y is"
    ) as e:
        fl.synthesise("planar_4r", motion=POSES[:4], fixed={**place, "O_y": place["O_y"] + 1e-3})
    near = float(str(e.value).partition("O_y is ")[2].partition(",")[0])
    assert near == pytest.approx(place["O_y"], abs=1e-5)  # six digits are told
    with pytest.raises(fl.InputError, match=r"D at \(3, 0.1\) is off the centre-point curve .*leave D out"):
        fl.synthesise("planar_4r", motion=POSES[:4], fixed={**place, "D_x": 3.0, "D_y": 0.1})
    with pytest.raises(
        fl.InputError, match="P is to be the pin A, and the four points of the poses are on no circle"
    ):
        fl.synthesise("planar_4r", motion=POSES[:4], fixed={"P_u": 0.0, "P_v": 0.0})


def test_four_points_on_a_circle_are_those_of_a_pin(monkeypatch):
    """The body's own point is the pin A then, its pivot the middle of the circle; the places are of some roundings."""
    monkeypatch.setattr(doors, "CHANGES", [0.3])
    turn = np.exp(1j * np.array([0.2, 0.9, 1.5, 2.4]))
    poses = np.column_stack([0.5 + 0.8 * turn.real, 0.8 * turn.imag, [0.3, 0.1, 0.2, 0.5]])
    found = fl.synthesise("planar_4r", motion=poses, fixed={"P_u": 0, "P_v": 0}, top=1)
    assert (found.P_u.item(), found.P_v.item()) == (0.0, 0.0)
    assert_allclose([found.a1[0], found.O_x[0], found.O_y[0]], [0.8, 0.5, 0.0], atol=1e-12)
    assert float(found.pose_error[0]) < 1e-12


@pytest.mark.stress
@pytest.mark.parametrize("seed", range(20))
def test_the_best_of_a_family_does_not_depend_on_the_seed(seed):
    """Of all linkages through six points of a line: 67.91225 degrees is the most that was ever found."""
    line, bars = [(20, y) for y in range(20, 46, 5)], {f"a{k}": (5, 60) for k in (1, 2, 3, 4)}
    where = {"status": "rotates_fully", "path_error": (None, 1e-9)}
    ask = {"path": line, "bounds": bars, "where": where, "maximise": "least_transmission_angle"}
    found = fl.synthesise("planar_4r", top=1, seed=seed, **ask)
    assert 67.4 < np.degrees(float(found.least_transmission_angle[0])) < 67.9123
    place, _ = points_of(found)
    assert np.abs(place - np.array(line) @ [1, 1j]).max() < 1e-11


@pytest.mark.stress
def test_conditions_hold_where_poses_are_met_nearly():
    """At the least error of a motion with a limit it stands at that limit, to what sequential programs leave of it."""
    rng = np.random.default_rng(4)
    poses = poses_of_known(rng) + 0.01 * rng.normal(size=(8, 3))
    ask = {"motion": poses, "rotation_length": 1.0, "top": 1}
    free = fl.synthesise("planar_4r", **ask)
    short = fl.synthesise("planar_4r", where={"a4": (None, 1.95)}, **ask)
    assert float(short.a4[0]) == pytest.approx(1.95, abs=1e-9)
    assert 1.05 < float(short.pose_error[0] / free.pose_error[0]) < 1.3
    flat = fl.synthesise("planar_4r", minimise="pose_error_max", **ask)
    assert float(flat.pose_error_max[0]) < 0.8 * float(free.pose_error_max[0])
    where = {"pose_error": (None, 0.02)}
    good = fl.synthesise("planar_4r", maximise="least_transmission_angle", where=where, **ask)
    assert np.degrees(float(good.least_transmission_angle[0])) > 65
    assert float(good.pose_error[0]) <= 0.02


@pytest.mark.stress
def test_conditions_hold_where_a_function_is_met_nearly():
    """Limits of lengths and of quantities over the whole turn are active at the end, to a millionth of them."""
    ask = {"function": np.square, "over": (0, 1), "turn_deg": (90, 90), "top": 1}
    where = {"a1": (None, 1.0), "a3": (0.8, None), "least_transmission_angle_used_deg": (40, None)}
    found = fl.synthesise("planar_4r", where=where, **ask)
    assert "missed" not in found
    at = [found.a1[0], found.a3[0], np.degrees(found.least_transmission_angle_used[0])]
    assert_allclose(at, [1.0, 0.8, 40.0], rtol=1e-6)
    found = fl.synthesise("planar_4r", where={"least_transmission_angle_deg": (20, None)}, **ask)
    assert np.degrees(float(found.least_transmission_angle[0])) == pytest.approx(20.0, rel=1e-6)
    assert np.degrees(float(found.structural_error[0])) < 0.8214


@pytest.mark.stress
def test_free_turns_are_chosen_with_the_linkage():
    """The error as a share of the output's turn is less than at the middle and at the ends of both ranges."""
    ask = {"function": np.log10, "over": (1, 2), "top": 1}
    free = fl.synthesise("planar_4r", turn_deg=((40, 90), (60, 120)), **ask)
    for turns in ((65, 90), (40, 60), (40, 120), (90, 60), (90, 120)):
        assert free.function_error[0] < fl.synthesise("planar_4r", turn_deg=turns, **ask).function_error[0]
    row = free.isel(design=0)
    assert 40 - 1e-9 <= np.degrees(float(row.input_turn)) <= 90 + 1e-9
    assert 60 - 1e-9 <= np.degrees(float(row.output_turn)) <= 120 + 1e-9
    assert float(row.theta1[-1] - row.theta1[0]) == pytest.approx(float(row.input_turn), abs=1e-13)
    turned = abs(float(row.theta4[-1] - row.theta4[0]))
    assert turned == pytest.approx(float(row.output_turn), abs=1e-13)


def test_no_linkage_is_an_empty_result_with_the_reason_and_a_condition_no_start_meets_is_met():
    found = fl.synthesise("planar_4r", motion=POSES, where={"status": "never_assembles"})
    assert found.sizes["design"] == 0
    assert {"a1", "theta1", "pose_error"} <= set(found.variables)
    assert "12 fail status" in found.attrs["reason"]
    # Once the refinement towards it ended at a ground link of length 0.
    square = [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.5), (0.2, 0.9)]
    found = fl.synthesise("planar_4r", path=square, where={"transmission_angle_min_deg": (95, None)}, top=2)
    assert found.sizes["design"] == 2
    assert (np.degrees(found.transmission_angle_min) >= 95.0).all()
    assert (found.path_error < 1e-6).all()


def test_a_result_is_a_map(tmp_path):
    """It is written, found again, drawn with its target, and ranked."""
    ask = {"motion": POSES, "quantities": ["swing"], "to": tmp_path / "found.h5"}
    with fl.synthesise("planar_4r", **ask) as found:
        xr.testing.assert_identical(found.load(), fl.synthesise("planar_4r", **ask).load())
        figure = fl.draw(found, design=1)
        assert any(line.get_marker() == "x" and len(line.get_xdata()) == 5 for line in figure.axes[0].lines)
        best = fl.best(found, maximise="least_transmission_angle_used", top=1)
        assert float(best.a2[0]) == pytest.approx(1.7, abs=1e-5)


def test_a_stopped_run_goes_on(tmp_path, monkeypatch):
    """Each linear program's end is a step: those that were done are not done again, and the bits are the same."""
    x = np.linspace(0, 1, 7)
    monkeypatch.setattr(functions, "STARTS", 30)
    ask = {"function": np.c_[x, x**2], "turn_deg": (60, -60), "to": tmp_path / "found.h5"}
    made, minimax = [], functions._minimax

    def stops(*of):
        made.append(of)
        if len(made) == 4:
            assert [one.name for one in tmp_path.iterdir()] == ["found.h5.search"]
            raise KeyboardInterrupt
        return minimax(*of)

    monkeypatch.setattr(functions, "_minimax", lambda *of: made.append(of) or minimax(*of))
    wanted = fl.synthesise("planar_4r", **{**ask, "to": None})
    whole = len(made)
    made.clear()
    monkeypatch.setattr(functions, "_minimax", stops)
    monkeypatch.setattr(search, "STEP_SECONDS", 0.0)
    with pytest.raises(KeyboardInterrupt) as caught:
        fl.synthesise("planar_4r", **ask)
    assert "4 steps of it are kept" in caught.value.__notes__[0]  # the scan, and three programs
    assert [one.name for one in tmp_path.iterdir()] == ["found.h5.search"]
    with pytest.raises(fl.InputError, match="another search"):
        fl.synthesise("planar_4r", **ask, seed=1)
    with fl.synthesise("planar_4r", **ask) as found:
        assert len(made) == 4 + whole - 3 > 4
        for name in wanted.variables:
            assert_array_equal(found[name], wanted[name])
    assert [one.name for one in tmp_path.iterdir()] == ["found.h5"]


def test_one_step_that_is_kept_is_told_as_one(tmp_path, monkeypatch):
    def stops(*of):
        raise KeyboardInterrupt

    monkeypatch.setattr(doors, "labelled", stops)
    with pytest.raises(KeyboardInterrupt) as caught:
        fl.synthesise("planar_4r", motion=POSES, to=tmp_path / "found.h5")
    assert caught.value.__notes__[0].startswith("1 step of it is kept in ")


def test_a_study_and_a_command_ask_for_the_same(tmp_path, monkeypatch, capsys):
    from fastlink.app.cli import main

    monkeypatch.chdir(tmp_path)
    rows = "\n".join(";".join(map(repr, map(float, row))) for row in POSES)
    (tmp_path / "poses.csv").write_text(f"x [m];y [m];angle [rad]\n{rows}")
    (tmp_path / "study.toml").write_text(
        'mechanism = "planar_4r"\nquantities = []\n[synthesis]\nmotion = true\nfile = "poses.csv"\ntop = 2\n'
    )
    monkeypatch.setattr("sys.argv", ["fastlink", "run", "study.toml"])
    with pytest.raises(SystemExit) as end:
        main()
    assert not end.value.code
    with fl.open("study.h5") as found:
        assert found.sizes["design"] == 2
        assert "[synthesis]" in found.attrs["study"]
        monkeypatch.setattr(
            "sys.argv", ["fastlink", "synthesise", "poses.csv", "--motion", "--top", "2", "--to", "own.h5"]
        )
        with pytest.raises(SystemExit):
            main()
        assert "no_defect" in capsys.readouterr().out
        with fl.open("own.h5") as own:
            assert_array_equal(own.a1, found.a1)
    (tmp_path / "pairs.csv").write_text("x,y\n0,0\n1,1\n2,4")
    (tmp_path / "slider.toml").write_text(
        'mechanism = "slider_crank"\n[synthesis]\nfunction = true\nfile = "pairs.csv"\nturn_deg = 90\ntravel = 0.1\n'
    )
    with fl.run("slider.toml") as found:
        words = "synthesise pairs.csv --function --mechanism slider_crank --turn-deg 90 --travel 0.1"
        words += " --precision-points 3 --to own2.h5"
        monkeypatch.setattr("sys.argv", ["fastlink", *words.split()])
        with pytest.raises(SystemExit):
            main()
        with fl.open("own2.h5") as own:
            assert_array_equal(own.r, found.r)
            assert float(np.abs(own.output_error).max()) < 1e-10


@pytest.mark.stress
@pytest.mark.parametrize("seed", range(20))
def test_random_closed_paths(seed):
    """All but few random crank-rockers come back from 12 points within the rounds of one call."""
    rng = np.random.default_rng(seed)
    points = path_of(rng, np.sort(rng.uniform(0, TURN, 12)))
    found = fl.synthesise("planar_4r", path=points, closed=True, top=1)
    assert float(found.path_error[0]) < 1e-6


@pytest.mark.parametrize("compiler", ["llvm", pytest.param("numba", marks=pytest.mark.stress)])
@pytest.mark.parametrize(("timed", "slider"), [(False, False), (True, False), (False, True)])
def test_the_kernel_has_the_bits_of_its_text(compiler, timed, slider):
    """Nine linkages with limits, eight abreast and one alone: the text run as Python, and compiled."""
    source, rng = paths.refinement(), np.random.default_rng(1)
    angle = TURN * np.arange(7) / 7
    target = np.stack([np.cos(angle), 0.4 * np.sin(angle) + 0.1 * np.cos(2 * angle)], axis=1)
    task = paths.PathTask(target @ [1, 1j], angle if timed else None, closed=True, slider=slider)
    starts = paths.starts_of(task, 64, 9, 0).at(slice(0, 9))
    upper = np.array([3.0, 3, 3, 3, 1, 1, *[np.inf] * 4])
    scratch = [np.zeros(one.lengths(2 * 7 + 10)) for one in source.scratch]
    options = np.array([timed, True, True, slider], dtype=np.int64)
    free = np.array([1.0, 1, 1, not slider, 1, 1, 1, 1, 1, timed])
    rest = (target, np.ones(7), angle, options, free, -upper, upper, np.zeros(1), 4)
    made = []
    for code in (kernels.kernel, load_kernel(source, compiler)):
        given = [part.copy() for part in (starts.numbers, starts.signs, starts.theta, starts.cost)]
        with np.errstate(all="ignore"):
            code(*given, *rest, *(one + rng.normal(size=one.shape) for one in scratch))
        made.append(given)
    for one, other in zip(*made, strict=True):
        assert_array_equal(one, other)
    assert (made[0][3] < starts.cost).any()


@pytest.mark.parametrize(
    "limits",
    [{"bounds": {"O_x": (-0.05, 0.05), "O_y": (-0.05, 0.05)}}, {"bounds": {"e": (-0.002, 0.002)}}],
    ids=str,
)
def test_a_family_is_searched_within_limits(monkeypatch, limits):
    monkeypatch.setattr(doors, "CHANGES", 0.4 * 0.5 ** np.arange(8))
    poses = [(0.1, 0.2, 0.1), (0.2, 0.25, 0.3), (0.33, 0.26, 0.2)]
    found = fl.synthesise("slider_crank", motion=poses, top=1, **limits)
    for name, (low, high) in limits["bounds"].items():
        assert low <= found[name].item() <= high
    # places below 1 m, of some hundred roundings
    assert found.pose_error.item() < 1e-12


@pytest.mark.parametrize(
    "rows", [POSES * [1, 1, 180 / np.pi], dict(zip("xy", POSES.T, strict=False))], ids=str
)
def test_angles_that_can_be_no_radians_are_warned_of_once(rows):
    if isinstance(rows, dict):
        rows["angle"] = np.degrees(POSES[:, 2])
    with pytest.warns(fl.InputWarning, match="angle_deg") as caught:
        fl.synthesise("planar_4r", motion=rows, top=1)
    assert len(caught) == 1
    assert caught[0].filename == __file__
    with pytest.warns(fl.InputWarning, match="timing is .* taken as radians"):
        fl.synthesise("planar_4r", path=ARC, timing=[30, 45, 60, 75, 90], exact=True)


def test_angles_with_a_unit_are_not_warned_of(recwarn):
    table = {"x": POSES[:, 0], "y": POSES[:, 1], "angle_deg": np.degrees(POSES[:, 2])}
    found = fl.synthesise("planar_4r", motion=table, top=20)
    assert not recwarn.list
    assert found.attrs["dyads"] == 4


def test_precision_points_of_a_table_are_pairs_of_it():
    """Those next to Chebyshev's spacing are met; the structural error is the greatest of all pairs."""
    x = np.linspace(1, 2, 61)
    ask = {"turn_deg": (60, 90), "precision_points": 4, "top": 3}
    found = fl.synthesise("planar_4r", function=np.c_[x, np.log10(x)], **ask)
    spacing = 1.5 - 0.5 * np.cos((2 * np.arange(4) + 1) * np.pi / 8)
    assert np.abs(found.x - spacing).max() <= 0.5 / 60 + 1e-15
    assert np.abs(found.output_error).max() < 1e-9  # Newton's steps end there
    row = found.isel(design=0)
    sides = {name: float(row[name]) for name in ("a1", "a2", "a3", "a4")}
    shares = (x - float(row.x[0])) * np.radians(60)
    at = fl.evaluate(
        "planar_4r", ["theta4"], branch=int(row.branch), theta1=float(row.theta1[0]) + shares, **sides
    )
    wanted = (np.log10(x) - np.log10(float(row.x[0]))) / np.log10(2) * np.radians(90) * int(row.sense)
    off = np.angle(np.exp(1j * (at["theta4"] - float(row.theta4[0]) - wanted)))
    assert np.abs(off).max() == pytest.approx(float(row.structural_error), abs=1e-9)
    with pytest.raises(fl.InputError, match="precision_points is 4, and there are 3 pairs"):
        fl.synthesise("planar_4r", function=np.c_[x, x][:3], **ask)


def test_studies_of_tasks_are_no_sweeps_and_a_turn_of_a_slider_crank_grows(tmp_path):
    study = tmp_path / "task.toml"
    study.write_text('mechanism = "planar_4r"\n[synthesis]\npath = [[0, 0], [1, 1], [2, 1]]\n')
    with pytest.raises(fl.InputError, match=r"no sweep; `fastlink run .*` finds them"):
        fl.explain(study)
    for turn in ((90, 30), (90, 90), "90"):
        with pytest.raises(fl.InputError, match="turn_deg is"):
            fl.synthesise("slider_crank", function=np.exp, over=(0, 1), turn_deg=turn, travel=0.1)

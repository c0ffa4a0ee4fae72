"""Slider-cranks for tasks: functions, motions, paths; the facts of the mechanism draw what was asked for."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fastlink as fl
from fastlink.synthesis import paths
from fastlink.synthesis.found import cognates_of
from tests.synthesis.test_synthesis import linkage

#: A slider-crank in its place: its body is turned by 0.1 from AB.
KNOWN, AT, GROUND, POINT, BODY = {"r": 0.5, "l": 1.3, "e": 0.2}, 0.2 + 0.1j, 0.3, 0.7 + 0.4j, 0.1


def moved(theta, design=KNOWN, branch=1, at=AT, ground=GROUND, point=POINT):
    """Return the places of a point of the rod, and the directions of the rod, by the facts of the mechanism alone."""
    names = ["A_x", "A_y", "theta2"]
    found = fl.evaluate("slider_crank", names, branch=branch, theta=np.asarray(theta), **design)
    a_x, a_y, rod = (np.asarray(found[name]) for name in names)
    return at + np.exp(1j * ground) * (a_x + 1j * a_y + point * np.exp(1j * rod)), rod + ground


def drawn(found, design=0):
    """Return the same of a result, at its crank angles, with its body."""
    row = found.isel(design=design)
    inputs = {name: float(row[name]) for name in ("r", "l", "e")}
    place = complex(row.O_x, row.O_y), float(row.ground_angle), complex(row.P_u, row.P_v)
    z, rod = moved(row.theta.values, inputs, int(row.branch), *place)
    return z, rod + float(row.get("body_angle", 0.0))


def poses(theta):
    z, rod = moved(theta)
    return np.stack([z.real, z.imag, rod + BODY], axis=1)


@pytest.mark.sample(2)
@pytest.mark.parametrize("count", [2, 3, 4])
def test_poses_are_met_exactly_by_the_best_of_a_family(count):
    """Links are up to 15 times the size: each pose is met to 100 roundings of that."""
    wanted = poses([0.3, 1.1, 2.0, 3.1][:count])
    found = fl.synthesise("slider_crank", motion=wanted, top=3)
    assert found.sizes["design"] == 3
    for design in range(3):
        z, angle = drawn(found, design)
        assert np.abs(z - wanted @ [1, 1j, 0]).max() < 100 * 15 * 2.2e-16
        assert np.abs(np.exp(1j * angle) - np.exp(1j * wanted[:, 2])).max() < 100 * 15 * 2.2e-16
    assert (found.defect == 0).all()
    assert (np.diff(found.least_transmission_angle_used) <= 0).all()


@pytest.mark.parametrize("count", [4, 7])
def test_more_poses_are_met_by_the_slider_crank_that_made_them(count):
    """Least squares end where steps are 1e-15; the numbers are known but for the condition, which is about 1e3."""
    wanted = poses(np.linspace(0.2, 3.0, count))
    near = {name: (0.98 * value, 1.02 * value) for name, value in KNOWN.items()} if count == 4 else {}
    found = fl.synthesise("slider_crank", motion=wanted, rotation_length=1.0, top=1, bounds=near)
    assert float(found.pose_error[0]) < 1e-13
    if count > 4:
        assert_allclose([found[name].item() for name in KNOWN], [*KNOWN.values()], atol=1e-11)
        assert complex(found.P_u.item(), found.P_v.item()) == pytest.approx(POINT, abs=1e-11)
        assert float(found.body_angle[0]) == pytest.approx(BODY, abs=1e-11)


def test_four_poses_have_one_point_that_moves_along_a_line():
    """All linkages of four poses have one slider; its line is straight by the poses themselves, to their rounding."""
    wanted = poses([0.3, 1.1, 2.0, 3.1])
    found = fl.synthesise("slider_crank", motion=wanted, top=50)
    turn = np.exp(1j * (wanted[:, 2] - found.body_angle.values[:, None]))
    b = wanted @ [1, 1j, 0] + turn * (found.l - found.P_u - 1j * found.P_v).values[:, None]
    along = (b - b[:, :1]) * np.exp(-1j * found.ground_angle.values[:, None])
    assert np.abs(along.imag).max() < 1e-12
    assert np.ptp(b[:, 0].real) < 1e-12 > np.ptp(b[:, 0].imag)


@pytest.mark.sample(1)
@pytest.mark.parametrize("points", [3, 4, 5])
def test_precision_points_are_met_by_the_closed_form(points):
    """x K1 cos + K2 sin + K3 = x^2 through three of the points gives the lengths, as far as its condition goes."""
    ask = {"over": (1, 2), "turn_deg": 90, "travel": 0.05, "precision_points": points, "top": 2}
    found = fl.synthesise("slider_crank", function=np.log10, **ask)
    x = 1.5 - 0.5 * np.cos((2 * np.arange(points) + 1) * np.pi / (2 * points))
    assert_allclose(found.x, x, rtol=1e-14)
    assert (
        float(np.abs(found.output_error).max()) < 1e-9 * 0.05
    )  # Newton's steps end below 1e-9 of the travel
    assert (found.structural_error > 1e-9).all()
    some = np.linspace(0, points - 1, 3).astype(int)
    place, angle = found.slider_position.values[0][some], found.theta.values[0][some]
    assert_allclose(np.diff(place), np.diff(np.log10(x[some])) / np.log10(2) * 0.05, atol=1e-12)
    rows = np.stack([place * np.cos(angle), np.sin(angle), np.ones(3)], axis=1)
    k = np.linalg.solve(rows, place**2)
    r, e = k[0] / 2, k[1] / k[0]
    condition = np.linalg.cond(rows / np.linalg.norm(rows, axis=0))
    lengths = [found[name].item(0) for name in ("r", "l", "e")]
    assert_allclose([r, np.sqrt(k[2] + r**2 + e**2), e], lengths, rtol=1e-8 * condition)


def test_the_greatest_error_of_a_slider_equioscillates():
    """Six times with changing signs, for five free numbers; between 5,001 places an extreme is missed by 1e-7 of it."""
    found = fl.synthesise("slider_crank", function=np.exp, over=(0, 1), turn_deg=90, travel=0.1, top=1)
    greatest, peaks = float(found.structural_error[0]), found.peak_error.values[0]
    high = peaks[np.abs(peaks) > greatest * (1 - 1e-5)]
    assert len(high) == 6
    assert (high[1:] * high[:-1] < 0).all()
    row, turn = found.isel(design=0), np.linspace(0, 1, 5001)
    inputs = {name: float(row[name]) for name in ("r", "l", "e")}
    angle = float(row.theta[0]) + turn * np.pi / 2
    at = fl.evaluate("slider_crank", ["slider_position"], branch=int(row.branch), theta=angle, **inputs)
    wanted = float(row.slider_position[0]) + 0.1 * (np.exp(turn) - 1) / (np.e - 1)
    assert np.abs(at["slider_position"] - wanted).max() == pytest.approx(greatest, rel=1e-6)
    assert greatest < 1.7646e-5  # the least of 40 x 120 x 120 starts


@pytest.mark.stress
def test_a_free_turn_of_the_crank_is_chosen():
    """It is no worse than the best of turns that are given, and within its range; units are those of a slider."""
    ask = {"function": np.log10, "over": (1, 2), "travel": 0.05, "top": 1}
    free = fl.synthesise("slider_crank", turn_deg=(50, 90), **ask)
    given = fl.synthesise("slider_crank", turn_deg=70, **ask)
    assert float(free.function_error[0]) <= float(given.function_error[0])
    assert 50 - 1e-9 <= np.degrees(float(free.input_turn[0])) <= 90 + 1e-9
    assert float(free.theta[0, -1] - free.theta[0, 0]) == pytest.approx(float(free.input_turn[0]), abs=1e-14)
    assert free.structural_error.units == free.output_error.units == "m"
    assert float(free.function_error[0]) * 0.05 == pytest.approx(float(free.structural_error[0]), rel=1e-12)


def test_timed_points_are_passed(monkeypatch):
    """A sample of 256 shapes has its nearest one close enough."""
    monkeypatch.setattr(paths, "SHAPES", 256)
    theta = np.array([0.2, 0.9, 1.7, 2.8, 4.0, 5.1])
    z, _ = moved(theta)
    found = fl.synthesise("slider_crank", path=np.c_[z.real, z.imag], timing=theta - 0.4, top=1)
    assert (
        np.abs(drawn(found)[0] - z).max() < 1e-11
    )  # the squares end at 1e-31 of the size, times their condition
    assert_allclose(np.diff(found.theta[0]), np.diff(theta), atol=1e-14)
    assert_allclose([found[name].item() for name in KNOWN], [*KNOWN.values()], atol=1e-9)


@pytest.mark.stress
@pytest.mark.parametrize("seed", range(10))
def test_random_closed_paths(seed):
    """Of 12 points the 8 + 12 unknowns are fixed: an error of 1e-10 of the size is the slider-crank."""
    rng = np.random.default_rng(seed)
    design = {"r": 1.0, "e": rng.uniform(-1, 1)}
    design["l"] = 1.0 + abs(design["e"]) + rng.uniform(0.1, 2)
    z, _ = moved(
        np.sort(rng.uniform(0, 6.28, 12)), design, point=rng.uniform(-2, 2) + 1j * rng.uniform(-2, 2)
    )
    found = fl.synthesise("slider_crank", path=np.c_[z.real, z.imag], closed=True, top=1)
    assert np.abs(drawn(found)[0] - z).max() < 1e-9
    assert found.defect.item() == 0
    assert_allclose([found.l.item(), abs(found.e.item())], [design["l"], abs(design["e"])], atol=1e-7)


def test_the_cognate_draws_the_same_curve():
    """Its crank is as long as AP, and turns as the rod does; differences are of rounding of lengths below 10."""
    found = linkage([0.3, 1.0, 2.0, 4.0], (1, 2.5, 0.5), -1)
    two = cognates_of(found)
    assert two.more["cognate"].tolist() == [1, 2]
    assert two.numbers[1, 0] == pytest.approx(abs(0.5 + 0.5j), rel=1e-14)
    assert_allclose(two.pins()[-1], np.repeat(found.pins()[-1], 2, axis=0), atol=1e-13)
    assert_allclose(np.abs(np.diff(two.pins()[3] - two.pins()[2])).max(), 0, atol=9)


def test_an_orientation_that_is_asked_for_is_kept():
    """A slider-crank turned by half a turn is the same in the other branch: limits choose."""
    wanted = poses([0.3, 1.1, 2.0])
    bounds = {"ground_angle": (GROUND + np.pi - 0.5, GROUND + np.pi + 0.5)}
    found = fl.synthesise("slider_crank", motion=wanted, top=20, bounds=bounds)
    assert (np.abs(found.ground_angle - GROUND - np.pi) <= 0.5).all()
    assert found.pose_error.max() < 1e-12
    assert 2 in found.branch.values
    assert set(fl.synthesise("slider_crank", motion=wanted, top=20).branch.values) == {1}


def test_a_result_is_a_map(tmp_path):
    """It is written, found again, drawn with its target, and ranked; nothing found is labelled too."""
    ask = {"motion": poses([0.3, 1.1, 2.0]), "quantities": ["stroke"], "top": 2}
    with fl.synthesise("slider_crank", to=tmp_path / "found.h5", **ask) as found:
        figure = fl.draw(found, design=1)
        assert any(line.get_marker() == "x" and len(line.get_xdata()) == 3 for line in figure.axes[0].lines)
        best = fl.best(found, maximise="stroke", top=1, refine=False)
        assert float(best.stroke[0]) == float(found.stroke.max())
    none = fl.synthesise("slider_crank", where={"status": "never_assembles"}, **ask)
    assert none.sizes["design"] == 0
    assert "fail" in none.attrs["reason"]

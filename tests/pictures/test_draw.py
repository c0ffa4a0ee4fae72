"""Pictures of mechanisms: joints stand where the facts say, at rest and in films; of designs, studies and maps."""

import base64
import io
import itertools
import json
import re
import stat
import sys
import xml.etree.ElementTree as ET
from functools import cache
from inspect import signature
from pathlib import Path

import numpy as np
import pytest
from matplotlib.patches import Ellipse
from numpy.testing import assert_allclose
from PIL import Image
from scipy.spatial import cKDTree
from tests.support.refusals import refused
from tests.support.sweeps import BARS, sweep_4r

import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue, inputs_of
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.pictures.draw import picture_of
from fastlink.pictures.linkage import GRID
from fastlink.pictures.motion import PLANES, Motion

FOUR_BAR = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0}
CURVED = FOUR_BAR | {"P_u": 0.5, "P_v": 0.35}
ROCKER = {"a1": 1.2, "a2": 1.3, "a3": 0.8, "a4": 1.0}
DESIGNS = {
    "planar_4r": CURVED | {"theta1": 1.0},
    "minkowski_4r": {"a": 1.0, "b": 1.0, "g": 4.0, "h": 1.0, "x": 0.5, "y": 0.3, "theta": 1.6},
    "focal": {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "s": 2.0, "completion": 1, "phi": 1.3},
    "hart": {"m": 4.0, "n": 8.0, "d": 5.0, "kappa": 0.5, "phi": 0.9},
    "slider_crank": {"r": 0.1, "l": 0.3, "e": 0.02, "theta": 0.9},
}
DRIVEN = [(name, other) for name in NAMES for other in inputs_of(name)[1:]]
DISTANCES = {
    "euclidean": np.hypot,
    "minkowskian": lambda x, y: np.sqrt(np.abs(x - y)) * np.sqrt(np.abs(x + y)),
}


@cache
def drawn(mechanism):
    return fl.draw(mechanism, DESIGNS[mechanism])


def bars(figure, sheet=0):
    """Return the ends of each bar by its points and its assembly mode."""
    lines = [(line.get_gid() or "", line.get_xydata()) for line in figure.axes[sheet].lines]
    return {tuple(gid.split()[1:]): ends for gid, ends in lines if gid.startswith("bar")}


def teeth(figure):
    """Return the teeth of combs."""
    return [line.get_xydata() for line in figure.axes[0].lines if line.get_alpha() and line.get_lw() == 0.5]


def arrows(figure):
    return [one for one in figure.axes[0].texts if getattr(one, "arrow_patch", None)]


def motion_of(mechanism, design, **options):
    known = catalogue(mechanism)
    return Motion(mechanism, known, picture_of(mechanism, known), design, (1, 2), None, **options)


@pytest.mark.parametrize("mechanism", NAMES)
def test_every_mechanism_declares_what_is_drawn_of_it(mechanism):
    """A mechanism without a picture, or with one that names no facts of it, fails here."""
    known = catalogue(mechanism)
    picture = picture_of(mechanism, known)
    values = {value for one in picture.points for value in (one.x, one.y)}
    values |= {circle.radius for circle in picture.circles}
    values |= {length for bar in picture.bars for length in bar.lengths.values()}
    values |= {name for loads in picture.loads.values() for one in loads for name in one.components}
    values |= {value for ends in picture.spans.values() for value in ends}
    values |= {bar.orientation for bar in picture.bars if bar.orientation}
    values |= set(re.findall(r"{(\w+)}", picture.title))
    names = {value for value in values if isinstance(value, str)}
    assert names <= {*known.facts, *known.inputs, *inputs_of(mechanism), *known.variant_inputs}
    points = [one.name for one in picture.points]
    assert len(set(points)) == len(points)
    assert {name for bar in picture.bars for name in bar.points.split()} <= set(points)
    assert set(picture.usual.split()) <= set(picture.words)


@pytest.mark.parametrize("mechanism", NAMES)
def test_bars_are_where_and_as_long_as_the_facts_say_in_both_assembly_modes(mechanism):
    design, found = DESIGNS[mechanism], bars(drawn(mechanism))
    picture = picture_of(mechanism, catalogue(mechanism))
    assert {branch for *_, branch in found} == {"1", "2"}
    for (*pair, branch), ends in found.items():
        names = {value for name in pair for value in (picture.point(name).x, picture.point(name).y)}
        (length,) = [one for bar in picture.bars for key, one in bar.lengths.items() if key.split() == pair]
        names = [one for one in (*names, length) if isinstance(one, str) and one not in design]
        facts = {0.0: 0.0} | design
        facts |= fl.evaluate(mechanism, names, **design, branch=int(branch)) if names else {}
        for name, place in zip(pair, ends, strict=True):
            point = picture.point(name)
            assert tuple(place) == (facts[point.x], facts[point.y]), (name, branch)
        # ends are rounded by some ten units of the largest coordinate; in the Minkowskian plane a sum and a
        # difference of coordinates are multiplied
        expected = abs(float(facts[length]))
        size = np.abs(ends).max() * max(1.0, np.abs(ends).max() / expected)
        measured = DISTANCES[picture.metric](*(ends[1] - ends[0]))
        assert abs(measured - expected) <= 64 * UNIT_ROUNDING * max(size, expected), (pair, branch)


@pytest.mark.parametrize("mechanism", NAMES)
def test_names_are_shown_none_covers_another_and_the_picture_is_to_scale(mechanism):
    figure = drawn(mechanism)
    axis = figure.axes[0]
    texts = [text for text in axis.texts if text.get_gid() == "name"]
    shown = {letter for text in texts for letter in text.get_text().strip("$").split("$, $")}
    picture = picture_of(mechanism, catalogue(mechanism))
    assert {one.name for one in picture.points if one.is_named and not one.group} <= shown
    renderer = figure.canvas.get_renderer()
    boxes = [text.get_window_extent(renderer).shrunk(0.8, 0.6) for text in texts]
    assert not [one for one in itertools.combinations(boxes, 2) if one[0].overlaps(one[1])]
    inches = axis.get_position().size * figure.get_size_inches()
    units = np.array([np.ptp(axis.get_xlim()), np.ptp(axis.get_ylim())])
    # three roundings of either
    assert_allclose(*inches / units, rtol=8 * UNIT_ROUNDING)
    assert any(text.get_text().endswith(" m") for text in axis.texts)


def test_modes_and_angles_are_named_once():
    found = bars(fl.draw("planar_4r", FOUR_BAR, theta1=1.0))
    both = [("A", "B", "1"), ("A", "B", "2"), ("D", "B", "1"), ("D", "B", "2"), ("O", "A", "1")]
    assert sorted(found) == both
    second = [("A", "B", "2"), ("D", "B", "2"), ("O", "A", "2")]
    assert sorted(bars(fl.draw("planar_4r", FOUR_BAR, theta1=1.0, branch=2))) == second
    one, both = (fl.draw("planar_4r", CURVED, theta1=1.0, branch=branch) for branch in (2, None))
    assert [text.get_text() for text in one.legends[0].get_texts()] == ["path of $P$"]
    assert any("branch 2: B to the left" in text.get_text() for text in one.texts)
    assert len(both.legends[0].get_texts()) == 3
    assert not fl.draw("planar_4r", FOUR_BAR, theta1=1.0, branch=1, show=[]).legends[0].get_texts()
    figure = fl.draw("planar_4r", FOUR_BAR)
    assert any("$\\theta_{1}$ = 60°" in text.get_text() for text in figure.texts)
    figure = fl.draw("planar_4r", FOUR_BAR, theta1=1.0)
    assert any("$\\theta_{1}$ = 1 rad" in text.get_text() for text in figure.texts)
    assert motion_of("planar_4r", {"a1": 0.9, "a2": 1.0, "a3": 0.9, "a4": 0.3}).title == "Double crank"
    figure = fl.draw("planar_4r", FOUR_BAR, input="joint_angle_3")
    assert "Crank-rocker" in [text.get_text() for text in figure.texts]


@pytest.mark.parametrize(
    ("mechanism", "title"),
    [
        ("planar_4r", "Crank-rocker, swing 68.4°"),
        ("slider_crank", "Slider-crank, crank turns fully, stroke 0.201 m"),
        ("focal", "Focal mechanism, double rocker"),
        ("hart", "Hart's linkage, triple rocker longest output link, stroke 15.8 m"),
        ("minkowski_4r", "Minkowskian four-bar, strange superrocker crank"),
    ],
)
def test_the_title_says_what_this_design_is(mechanism, title):
    figure = drawn(mechanism)
    assert title in [text.get_text() for text in figure.texts]


def test_what_all_shows_is_in_the_legend():
    figure = fl.draw("planar_4r", CURVED, theta1=1.0, omega1=10.0, links=BARS, show="all")
    for word in ("circles", "comb", "mass centres", "path of", "forces", "torques"):
        assert legend(figure, word)
    assert {"$G_{1}$", "$G_{2}$", "$G_{3}$"} <= {text.get_text() for text in figure.axes[0].texts}
    assert legend(fl.draw("focal", DESIGNS["focal"], show="foci"), "second focus")
    view = np.reshape([figure.axes[0].get_xlim(), figure.axes[0].get_ylim()], (2, 2))
    for centre, radius in ((0.0, 0.4), (1.0, 0.8)):  # no circle is cut
        assert view[0, 0] <= centre - radius < centre + radius <= view[0, 1]
        assert view[1, 0] <= -radius < radius <= view[1, 1]


def test_arrows_and_films_are_of_the_first_mode_that_is_there(tmp_path):
    given = CURVED | {"omega1": 10.0, "theta1": 1.0}
    assert {branch for *_, branch in bars(fl.draw("planar_4r", given, links=BARS, show="forces"))} == {"1"}
    figure = fl.draw("planar_4r", FOUR_BAR, animate=tmp_path / "a.gif", frames=2)
    assert {branch for *_, branch in bars(figure)} == {"1"}
    # a quarter of a frame beyond half a turn, as the last picture says
    assert "$\\theta_{1}$ = 45°" in [text.get_text() for text in figure.axes[0].texts]


@pytest.mark.parametrize(
    ("mechanism", "design", "limits"),
    [
        ("planar_4r", ROCKER, ["theta1_low", "theta1_high"]),
        ("focal", DESIGNS["focal"], ["phi_low", "phi_high"]),
        ("slider_crank", {"r": 0.4, "l": 0.3, "e": 0.02}, ["theta_low", "theta_high"]),
        ("planar_4r", FOUR_BAR, []),
    ],
)
def test_the_range_ends_at_the_toggles_of_the_facts(mechanism, design, limits):
    design = {name: value for name, value in design.items() if name != "phi"}
    motion = motion_of(mechanism, design)
    ends = np.array(motion.ranges).ravel()
    for limit in fl.evaluate(mechanism, limits, **design).values() if limits else (-np.pi, np.pi):
        # halved to 2^-44 of half a degree; near a toggle the sign of what is under the root is rounded
        assert abs(ends - limit).min() < 1e-12
    assert motion.turns_fully == (not limits)


@pytest.mark.parametrize(("mechanism", "other"), DRIVEN)
def test_by_another_input_the_linkage_stands_where_the_first_one_puts_it(mechanism, other):
    """One of the two assembly modes by the other; its points lose a few roundings in either way, its angles one."""
    design = DESIGNS[mechanism]
    first = catalogue(mechanism).position.name
    given = {other: float(fl.evaluate(mechanism, [other], **design, branch=1)[other])}
    given |= {name: value for name, value in design.items() if name != first}
    found = bars(fl.draw(mechanism, given, input=other))
    for (a, b, _), ends in bars(fl.draw(mechanism, design, branch=1)).items():
        modes = [one for (*pair, _), one in found.items() if pair == [a, b]]
        size = 64 * UNIT_ROUNDING * max(1.0, np.abs(ends).max())
        assert any(np.abs(one - ends).max() < size for one in modes), (a, b)


def test_ranges_that_are_only_looked_at_are_no_limits_and_one_of_several_positions_may_lie_beyond():
    linkage = {"a": 1.0, "b": 1.0, "g": 4.0, "h": 1.0, "x": 0.5, "y": 0.3}
    motion = motion_of("minkowski_4r", linkage, reach=5.0)
    limits = fl.evaluate("minkowski_4r", ["theta_min", "theta_max"], **linkage)
    inner, outer = f"{limits['theta_min']:g}", f"{limits['theta_max']:g}"
    assert motion.range_texts(False) == [f"up to -{outer}", f"-{inner} to {inner}", f"{outer} on"]
    assert motion.span == (-5.0, 5.0)
    assert bars(fl.draw("minkowski_4r", linkage, theta=4.5))
    figure = fl.draw("planar_4r", ROCKER, theta1_deg=[60, 170])
    assert (bool(bars(figure, 0)), bool(bars(figure, 1))) == (True, False)
    assert "does not assemble" in [text.get_text() for text in figure.axes[1].texts]


@pytest.mark.parametrize(
    ("show", "further"),
    [("path circles comb", 2 + 2), ("comb", 2 - 1), ([], -1)],  # two circles; teeth and their ends; no path
)
def test_words_add_what_they_say(show, further):
    usual, more = (fl.draw("planar_4r", CURVED, theta1=1.0, branch=1, show=one) for one in (None, show))
    assert len(more.axes[0].lines) == len(usual.axes[0].lines) + further


def test_the_teeth_of_a_comb_are_as_long_as_the_curvature():
    figure = fl.draw("planar_4r", CURVED, theta1=1.0, branch=2, show="comb")
    feet, tips, _ = teeth(figure)[0].reshape(-1, 3, 2).transpose(1, 0, 2)
    at = np.linspace(-np.pi, np.pi, 100_001)
    every = fl.evaluate("planar_4r", ["curvature", "P_x", "P_y"], **CURVED, theta1=at, branch=2)
    gaps, places = cKDTree(np.stack([every["P_x"], every["P_y"]], axis=-1)).query(feet)
    assert gaps.max() < 1e-4  # of a path of length 2
    ways = np.hypot(*np.diff(feet, axis=0).T) + np.hypot(*np.diff(tips, axis=0).T)
    assert ways.max() < 1.5 * np.median(ways)  # no gap where the path bends most
    lengths = np.hypot(*(tips - feet).T)
    ratio = lengths / np.abs(every["curvature"][places])
    # by the nearest of many places: not where the curvature doubles from one to the next
    is_so = np.abs(ratio / np.median(ratio) - 1.0) < 1e-3
    is_longest = lengths > 0.999 * lengths.max()
    assert is_so.mean() > 0.5
    assert (is_so | is_longest).mean() > 0.97


@pytest.mark.parametrize(("mechanism", "show", "paths"), [
    ("focal", "path comb", 1), ("hart", "path comb", 0), ("hart", "path ellipse comb", 1), ("minkowski_4r", "comb", 1),
])  # fmt: skip
def test_every_path_that_is_bent_has_a_comb(mechanism, show, paths):
    """Hart's line has none: its curvature is rounding alone."""
    assert len(teeth(fl.draw(mechanism, DESIGNS[mechanism], show=show, branch=1))) == paths


@pytest.mark.parametrize(("phi", "sign"), [(4.93, 1.0), (1.3, -1.0)], ids=["ellipse", "hyperbola"])
def test_a_conic_has_the_foci_that_are_shown(phi, sign):
    """Distances to them have one sum or difference, to a tenth of a pixel: a drawn ellipse is a polygon."""
    design = DESIGNS["focal"] | {"phi": phi}
    axis = fl.draw("focal", design, show="foci", branch=1).axes[0]
    to_data = axis.transData.inverted().transform
    drawn = [to_data(one.get_verts()) for one in axis.patches if isinstance(one, Ellipse)]
    drawn += [one.get_xydata() for one in axis.lines if len(one.get_xdata()) == GRID]
    (other,) = [one.get_xydata()[0] for one in axis.lines if one.get_marker() == "x"]
    focus = [*fl.evaluate("focal", ["F_x", "F_y"], **design, branch=1).values()]
    to_focus, to_other = (np.hypot(*(np.concatenate(drawn) - at).T) for at in (focus, other))
    assert_allclose(abs(to_focus + sign * to_other), abs(to_focus[0] + sign * to_other[0]), rtol=1e-3)
    assert np.ptp(to_focus) > 0.1 * design["a"]


def test_a_circle_has_teeth_of_one_length_in_either_plane():
    """Its vector of curvature is along the radius, of size 1/r: to the centre, of a hyperbola away from it."""
    t, radius = np.linspace(-1.5, 1.5, 13), 2.5
    circle = radius * np.stack([np.cos(t), np.sin(t)], axis=-1)
    slope = radius * np.stack([-np.sin(t), np.cos(t)], axis=-1)
    assert_allclose(PLANES["euclidean"].curvature(slope, -circle), -circle / radius**2, atol=1e-15)
    arm = radius * np.stack([np.cosh(t), np.sinh(t)], axis=-1)
    for sign in (1.0, -1.0):
        found = PLANES["minkowskian"].curvature(sign * arm[:, ::-1], sign * arm)
        assert_allclose(found, sign * arm / radius**2, atol=1e-14)


def legend(figure, word):
    (found,) = [one.get_text() for one in figure.legends[0].get_texts() if word in one.get_text()]
    return found


def test_forces_are_arrows_and_torques_curved_ones_in_their_directions():
    given = CURVED | {"omega1": 20.0, "theta1": 1.0}
    figure = fl.draw("planar_4r", given, links=BARS, branch=1, show="forces")
    vectors = np.array([np.subtract(one.xy, one.xyann) for one in arrows(figure)])
    names = [f"{name}_{xy}" for name in ("F41", "F21", "F32", "F43") for xy in "xy"]
    forces = fl.evaluate("planar_4r", names, **given, links=BARS, branch=1)
    expected = np.reshape(list(forces.values()), (4, 2))
    greatest = legend(figure, "forces").split()[-2]
    assert float(greatest) == float(f"{np.hypot(*expected.T).max():.3g}")
    assert "e+" not in greatest
    ratio = np.hypot(*vectors.T) / np.hypot(*expected.T)
    assert_allclose(ratio, ratio[0], rtol=1e-12)  # 2^-53 of a coordinate of 1 in an arrow of a thousandth
    assert_allclose(np.arctan2(*vectors.T), np.arctan2(*expected.T), rtol=1e-12)
    given = {"r": 0.1, "l": 0.3, "e": 0.02, "omega": 50.0, "m3": 0.5, "theta": 0.9}
    figure = fl.draw("slider_crank", given, links=BARS, show="torques", branch=[1, 2])
    torques = fl.evaluate("slider_crank", ["T41"], **given, links=BARS, branch=[1, 2])["T41"]
    arcs = [line.get_xydata() for line in figure.axes[0].lines if line.get_zorder() == 6.5]
    turns = [np.unwrap(np.arctan2(*arc.T[::-1])) for arc in arcs]
    assert [np.sign(turn[-1] - turn[0]) for turn in turns] == np.sign(torques).tolist()
    assert legend(figure, "torques") == f"torques, the greatest {np.abs(torques).max():.3g} N m"


def test_the_conic_about_F_touches_the_four_sides():
    """Its second focus mirrored in a tangent is twice the major semi-axis from the first."""
    figure = fl.draw("focal", DESIGNS["focal"], branch=2, show="foci")
    (second,) = [line.get_xydata()[0] for line in figure.axes[0].lines if line.get_marker() == "x"]
    found = bars(figure)
    (shape,) = [one for one in figure.axes[0].patches if hasattr(one, "get_center")]
    first = found["P", "F", "2"][1]
    for start, end in (found["M", "A", "2"], found["N", "B", "2"], found["A", "B", "2"]):
        across = np.array([start[1] - end[1], end[0] - start[0]]) / np.hypot(*(end - start))
        mirrored = second - 2.0 * ((second - start) @ across) * across
        # a root of a quadratic of coordinates of 5, some ten roundings each
        assert abs(np.hypot(*(mirrored - first)) - max(shape.width, shape.height)) < 1e-12


@pytest.mark.parametrize(
    ("mechanism", "given", "titles"),
    [
        ("planar_4r", {"strip": 6, "degrees": True}, ["0°", "60°", "120°", "180°", "240°", "300°"]),
        ("planar_4r", {"theta1_deg": [10, 20, 200]}, ["10°", "20°", "200°"]),
        ("focal", {"completion": None}, ["completion 1", "completion 2"]),
    ],
)
def test_what_stands_side_by_side(mechanism, given, titles):
    design = {key: value for key, value in {**DESIGNS[mechanism], **given}.items() if value is not None}
    design.pop("theta1", None)
    shown = [axis.get_title() for axis in fl.draw(mechanism, **design).axes]
    assert [title.rpartition("= ")[2].partition(":")[0] for title in shown] == titles


def test_curves_stand_beside_with_the_input_marked():
    figure = fl.draw("planar_4r", FOUR_BAR, theta1_deg=60, curves=["theta4", "transmission_angle"])
    for name, axis in zip(("theta4", "transmission_angle"), figure.axes[1:], strict=True):
        marks = [line.get_xydata()[0] for line in axis.lines if line.get_marker() == "o"]
        expected = fl.evaluate("planar_4r", [name], **FOUR_BAR, theta1=np.pi / 3, branch=[1, 2])[name]
        # a conversion and, of theta1, a shift by a turn
        assert_allclose(marks, [(60.0, value) for value in np.degrees(expected)], rtol=1e-14)


STUDY = """
mechanism = "planar_4r"
quantities = ["transmission_angle_min"]
[links]
model = "round_bar"
density = 7750.0
radius = 0.01
[design]
a1 = 0.4
a2 = {linspace = [1.0, 1.2, 3]}
a3 = {values = [0.7, 0.8]}
a4 = 1.0
omega1 = 20.0
"""
SINGLE = STUDY.replace("{linspace = [1.0, 1.2, 3]}", "1.1").replace("{values = [0.7, 0.8]}", "0.8")


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    place = tmp_path_factory.mktemp("maps") / "maps.h5"
    space = fl.grid(a1=0.4, a2=[1.0, 1.1, 1.2], a3=[0.7, 0.8], a4=1.0)
    sweep_4r(space, ["transmission_angle"], theta1=[1.0, 2.0], to=place, verify=0).close()
    return place


@pytest.fixture(scope="module")
def maps(place):
    with fl.open(place) as maps:
        return maps.load()


def lengths(figure):
    """Return a2 and a3, measured in the picture."""
    found = {key[:2]: float(np.hypot(*np.diff(ends, axis=0)[0])) for key, ends in bars(figure).items()}
    return found["A", "B"], found["D", "B"]


# design 3 of 3 x 2 in C order is the second a2 and the second a3; a length of 1 from coordinates of 1: some roundings
EXPECTED = pytest.approx((1.1, 0.8), rel=1e-14)


def test_designs_by_number_values_or_row_have_their_mode_and_position(maps, place, tmp_path):
    for name, text in (("study", STUDY), ("single", SINGLE)):
        (tmp_path / f"{name}.toml").write_text(text)
    near = {"at": {"a2": 1.12, "a3": 0.79}}
    for source, given in (
        (maps, {"design": 3}), (maps, near), (maps, {"design": 2, "a3": 0.8}), (str(place), {"design": 3}),
        (tmp_path / "study.toml", near), (tmp_path / "single.toml", {}),
    ):  # fmt: skip
        assert lengths(fl.draw(source, **given, theta1=1.0)) == EXPECTED
    assert lengths(fl.draw(place, 3)) == EXPECTED
    figure = fl.draw(tmp_path / "study.toml", 3, theta1=1.0, show="forces", branch=2)  # with its links
    assert (lengths(figure), len(arrows(figure))) == (EXPECTED, 4)
    rows = maps.fastlink.top(2, "transmission_angle")
    figure = fl.draw(rows, 1)
    crank = bars(figure)["O", "A", str(int(rows.branch[1]))][1]
    assert np.arctan2(*crank[::-1]) == pytest.approx(float(rows.theta1[1]), rel=1e-15)
    assert lengths(figure) == pytest.approx((float(rows.a2[1]), float(rows.a3[1])), rel=1e-14)
    assert {branch for *_, branch in bars(figure)} == {str(int(rows.branch[1]))}
    assert {branch for *_, branch in bars(fl.draw(rows, 1, theta1_deg=20, branch=[1, 2]))} == {"1", "2"}


FRAMES = 3


def test_a_gif_has_the_pictures_asked_for_and_ends_where_it_began(tmp_path):
    place = tmp_path / "turn.gif"
    fl.draw("planar_4r", FOUR_BAR, branch=1, animate=place, frames=FRAMES)
    pictures = []
    with Image.open(place) as film:
        assert (film.n_frames, film.info["loop"]) == (FRAMES, 0)
        for k in range(FRAMES):
            film.seek(k)
            pictures.append(np.array(film.convert("L")))
    assert pictures[0][0, 0] == 255
    changes = [(pictures[k] != pictures[k - 1]).mean() for k in range(FRAMES)]
    assert all(0.001 < change < 0.2 for change in changes)  # the linkage, and it alone


def test_a_page_needs_nothing_else(tmp_path):
    place = tmp_path / "swing.html"
    fl.draw("planar_4r", ROCKER, branch=1, theta1_deg=60, animate=place, frames=FRAMES)
    text = place.read_text()
    assert not re.search(r"(src|href)\s*=\s*[\"']?(https?:)?//", text)
    found = (re.search(rf"{key} = (\[.*?\])[,;]", text)[1] for key in ("frames", "labels"))
    frames, labels = map(json.loads, found)
    assert len(frames) == len(labels) == FRAMES
    with Image.open(io.BytesIO(base64.b64decode(frames[0]))) as first:
        assert first.format == "PNG"
    angles = [float(label.removesuffix("°")) for label in labels]
    assert all(24.147 <= angle <= 145.168 for angle in angles)  # the range in which 60 degrees is


def test_a_film_is_handed_to_ffmpeg(tmp_path, monkeypatch):
    """With a program in its place that counts the pixels that it receives, or fails."""
    monkeypatch.setenv("PATH", str(tmp_path))
    film, program = tmp_path / "line.mp4", tmp_path / "ffmpeg"
    with refused("animate", "apt install ffmpeg"):
        fl.draw("planar_4r", FOUR_BAR, animate=film)
    script = f"#!{sys.executable}\nimport sys\nread, given = sys.stdin.buffer.read(), sys.argv[1:]\n"
    program.write_text(
        f"{script}width, height = map(int, given[given.index('-s') + 1].split('x'))\n"
        "open(given[-1], 'w').write('{} {}'.format(*divmod(len(read), 3 * width * height)))\n"
    )
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    fl.draw("hart", m=4.0, n=8.0, d=5.0, kappa=0.5, animate=film, frames=FRAMES)
    assert film.read_text() == f"{FRAMES} 0"
    program.write_text(f"{script}sys.exit('no such codec')\n")
    with refused("animate", "a .gif"):
        fl.draw("hart", m=4.0, n=8.0, d=5.0, kappa=0.5, animate=film, frames=2)


@pytest.mark.parametrize("at", [60.0, [60.0, 80.0]])
def test_an_angle_that_looks_like_degrees_is_remarked_on_once(at):
    with pytest.warns(fl.InputWarning) as noted:
        fl.draw("planar_4r", FOUR_BAR, theta1=at)
    (text,) = [str(one.message) for one in noted]
    assert text.startswith(f"draw: theta1: {at} is taken as radians")


@pytest.mark.parametrize(
    ("given", "key", "remedy"),
    [
        ({"a1": -1.0}, "a1", "greater than 0"),
        ({"a1": [0.4, 0.5]}, "a1", "one number"),
        ({"a7": 1.0}, "a7", "did you mean"),
        ({"a2": 5.0}, "never assembles", "another design"),
        (ROCKER | {"theta1_deg": 170}, "theta1_deg", "-145.168° to -24.147° or 24.147° to 145.168°"),
        (ROCKER | {"theta1": 0.1}, "assembles over part of the turn", ""),
        ({"branch": 3}, "branch", "1, 2"),
        ({"strip": 1}, "strip", "2 to 24"),
        ({"strip": 4, "theta1": 1.0}, "theta1", "leave one"),
        ({"theta1": []}, "theta1", "1 to 24"),
        ({"theta1": float("nan")}, "theta1", "finite"),
        ({"curves": ["status"]}, "curves[0]", "known"),
        ({"curves": ["omega_4"]}, "curves[0]", "omega4"),
        ({"curves": ["theta4", "theta2", "A_x", "A_y", "B_x", "B_y", "v1"]}, "curves", "at most 6"),
        ({"show": "shadow"}, "show", "known"),
        ({"show": 3}, "show", "list of names"),
        ({"curves": "theta4"}, "curves", "['theta4']"),
        ({"curves": ["theta4", "theta4"]}, "curves[1]", "once"),
        ({"show": "forces", "omega1": 20.0}, "draw", "round_bar"),
        ({"to": "linkage.bmp"}, "to", "png, svg, pdf, dxf"),
        ({"degrees": 3}, "degrees", "True or False"),
        ({"trust_code": "no"}, "trust_code", "True or False"),
        ({"theta1_degg": 3.0}, "theta1_degg", ""),
        ({"animate": "turn.avi"}, "animate", "gif, html, mp4"),
        ({"animate": "turn.gif", "frames": 1}, "frames", "2 to 720"),
        ({"animate": "turn.gif", "strip": 3}, "animate", "leave strip"),
        ({"animate": "turn.gif", "theta1": [1.0, 2.0]}, "animate", "leave strip"),
        ({"at": {"a1": 1.0}}, "at", "leave it out"),
        ({"design": {"a1": 0.4}}, "design", "once"),
        ({"design": 3}, "design", "by name"),
    ],
)
def test_requests_that_mean_nothing_are_refused(given, key, remedy, folder):
    with refused(key, remedy):
        fl.draw("planar_4r", **FOUR_BAR | given)


@pytest.mark.parametrize(
    ("given", "key", "remedy"),
    [
        ({}, "design", "design=0"),
        ({"design": 6}, "design", "0 to 5"),
        ({"design": "first"}, "design", "0 to 5"),
        ({"design": 1, "at": {"a2": 1.0}}, "at", "leave one"),
        ({"at": {"a2": 1.0}}, "at", "such as 0.7"),
        ({"at": {"a2": 3.0, "a3": 0.7}}, "at", "from 1 to 1.2"),
        ({"at": {"a9": 3.0, "a2": 1.0, "a3": 0.7}}, "at", "a2, a3"),
        ({"at": 3}, "at", "{'a4': 1.0}"),
    ],
)
def test_what_names_no_design_of_a_map_is_refused(maps, given, key, remedy):
    with refused(key, remedy):
        fl.draw(maps, **given, theta1=1.0)


def test_a_curve_whose_function_takes_more_than_the_design_gives_is_left_out_of_all_and_refused_by_its_word():
    design = {name: DESIGNS["minkowski_4r"][name] for name in "abgh"}
    every = fl.draw("minkowski_4r", design, show="all")
    assert not any("sextic" in one.get_text() for one in every.legends[0].get_texts())
    with pytest.raises(fl.InputError, match="x is missing; sextic depends on it; add it"):
        fl.draw("minkowski_4r", design, show="sextic")


def test_other_sources_and_options_among_the_inputs_are_refused(tmp_path):
    """A design is a mapping, whose names would else be taken for keywords of the evaluation."""
    with refused("mechanism", "mechanisms/toggle_press/__init__.py"):
        picture_of("toggle_press", catalogue("hart"))
    with refused("mechanism", "did you mean 'planar_4r'"):
        fl.draw("planar4r", FOUR_BAR)
    for absent in (tmp_path / "absent.h5", Path("absent.toml")):
        with pytest.raises(fl.InputError, match="absent"):
            fl.draw(absent, 3)
    for name in signature(fl.evaluate).parameters:
        remedy = f"beside the design, {name}=" if name in ("branch", "input", "links") else "leave it out"
        with refused(name, remedy):
            fl.draw("planar_4r", FOUR_BAR | {name: 1})


# == Drawings for CAD: joints and paths stand where the facts say, in millimetres, on layers of their own ====

ezdxf = pytest.importorskip("ezdxf")

SVG = "{http://www.w3.org/2000/svg}"


def expected(mechanism, branch):
    """Return the points of a mechanism by name, in millimetres, as the facts say."""
    design, picture = DESIGNS[mechanism], picture_of(mechanism, catalogue(mechanism))
    points = [one for one in picture.points if not one.group]
    names = {value for one in points for value in (one.x, one.y) if isinstance(value, str)} - design.keys()
    known = design | dict(fl.evaluate(mechanism, sorted(names), **design, branch=branch))
    return {
        one.name: [1000.0 * (known[v] if isinstance(v, str) else v) for v in (one.x, one.y)] for one in points
    }


@pytest.mark.parametrize("mechanism", NAMES)
def test_joints_of_a_dxf_stand_where_the_facts_say(mechanism, tmp_path):
    place = tmp_path / "linkage.dxf"
    fl.draw(mechanism, DESIGNS[mechanism], branch=2, to=place)
    drawing = ezdxf.readfile(place)
    assert not drawing.audit().has_issues
    assert drawing.header["$INSUNITS"] == ezdxf.units.MM
    space = drawing.modelspace()
    circles = [tuple(one.dxf.center)[:2] for one in space.query("CIRCLE")]
    texts = [one.dxf.text for one in space.query("TEXT")]
    points = expected(mechanism, 2)
    assert sorted(texts) == sorted(points)
    # the order of both is that of the points; written with 16 digits
    assert_allclose(circles, [points[name] for name in texts], rtol=1e-14, atol=1e-12)
    ends = np.concatenate([bar.get_points("xy") for bar in space.query('LWPOLYLINE[layer=="bars"]')])
    assert {*map(tuple, ends.round(6))} <= {tuple(np.round(one, 6)) for one in points.values()}
    assert {one.dxf.layer for one in space} >= {"bars", "joints", "ground"}


def test_paths_are_those_of_the_facts_and_modes_have_layers(tmp_path):
    place = tmp_path / "both.dxf"
    fl.draw("planar_4r", DESIGNS["planar_4r"], to=place)
    space = ezdxf.readfile(place).modelspace()
    layers = {one.dxf.layer for one in space}
    assert layers == {"ground", "bars 1", "bars 2", "joints 1", "joints 2", "paths 1", "paths 2"}
    for branch in (1, 2):
        (path,) = space.query(f'LWPOLYLINE[layer=="paths {branch}"]')
        at = np.linspace(-np.pi, np.pi, 722)
        design = DESIGNS["planar_4r"] | {"theta1": at}
        known = fl.evaluate("planar_4r", ["P_x", "P_y"], **design, branch=branch)
        assert_allclose(
            path.get_points("xy"), 1000.0 * np.stack([known["P_x"], known["P_y"]], axis=-1), atol=1e-9
        )
    fl.draw("slider_crank", DESIGNS["slider_crank"], branch=1, to=place)
    (guide,) = ezdxf.readfile(place).modelspace().query('LWPOLYLINE[layer=="ground"]')
    stroke = float(fl.evaluate("slider_crank", ["stroke"], r=0.1, l=0.3, e=0.02)["stroke"])
    (low, y), (high, _) = guide.get_points("xy")
    assert (y, high - low) == (20.0, pytest.approx(1000.0 * stroke, rel=1e-3))  # by 722 positions


@pytest.mark.parametrize("mechanism", NAMES)
def test_an_svg_in_millimetres_has_the_same_places(mechanism, tmp_path):
    place = tmp_path / "linkage.mm.svg"
    fl.draw(mechanism, DESIGNS[mechanism], branch=1, to=place)
    page = ET.parse(place).getroot()
    box = [float(one) for one in page.get("viewBox").split()]
    assert (page.get("width"), page.get("height")) == (f"{box[2]}mm", f"{box[3]}mm")
    points = expected(mechanism, 1)
    circles = [(float(one.get("cx")), -float(one.get("cy"))) for one in page.iter(f"{SVG}circle")]
    texts = [one.text for one in page.iter(f"{SVG}text")]
    assert_allclose(circles, [points[name] for name in texts], rtol=1e-14, atol=1e-12)
    x, y = np.transpose(circles)
    assert (box[0] < x.min()) & (x.max() < box[0] + box[2])
    assert (box[1] < -y.max()) & (-y.min() < box[1] + box[3])


def test_without_ezdxf_the_remedy_is_said_before_anything_is_drawn(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    with refused("to", "python -m pip install ezdxf"):
        fl.draw("planar_4r", DESIGNS["planar_4r"], to=tmp_path / "linkage.dxf")
    assert not list(tmp_path.iterdir())

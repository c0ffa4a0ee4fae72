"""Pictures of mechanisms: joints stand where the facts say, names are shown, requests that mean nothing are refused."""

import itertools
from functools import cache
from inspect import signature

import numpy as np
import pytest
from numpy.testing import assert_allclose
from tests.support.refusals import refused
from tests.support.registry import ENTRIES

import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue, inputs_of
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.pictures.draw import picture_of
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
DRAWN = [entry for entry in ENTRIES if not entry.about and entry.moves]


@cache
def drawn(mechanism):
    return fl.draw(mechanism, DESIGNS[mechanism])


def bars(figure, sheet=0):
    """Return the ends of each bar by its points and its assembly mode."""
    lines = [(line.get_gid() or "", line.get_xydata()) for line in figure.axes[sheet].lines]
    return {tuple(gid.split()[1:]): ends for gid, ends in lines if gid.startswith("bar")}


def names(figure, sheet=0):
    return [text.get_text().strip("$") for text in figure.axes[sheet].texts if text.get_gid() == "name"]


# -- what is drawn is what the facts say -----------------------------------------------------------------------------


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
    names = {value for value in values if isinstance(value, str)}
    assert names <= {*known.facts, *known.inputs, *inputs_of(mechanism), *known.variant_inputs}
    points = [one.name for one in picture.points]
    assert len(set(points)) == len(points)
    assert {name for bar in picture.bars for name in bar.points.split()} <= set(points)
    assert set(picture.usual.split()) <= set(picture.words)


def test_a_mechanism_without_a_picture_is_refused(monkeypatch):
    with refused("mechanism", "mechanisms/toggle_press/picture.py"):
        picture_of("toggle_press", catalogue("hart"))


@pytest.mark.sample(3)
@pytest.mark.parametrize("entry", DRAWN, ids=str)
def test_bars_are_as_long_as_the_design_says(entry):
    """The ends of a bar are rounded by some ten units of the largest coordinate, so its length is by twice that."""
    picture, checked = picture_of(entry.mechanism, entry.catalogue), set()
    plane = PLANES[picture.metric]
    given = entry.drawn("random", 3, 40)
    motions = [{name: values[k] for name, values in given.items()} for k in range(len(given[entry.input]))]
    for design in motions:
        design = {name: float(value) for name, value in design.items() if name != "branch"}
        position = design.pop(entry.input)
        motion = Motion(entry.mechanism, entry.catalogue, picture, design, (1, 2), None)
        if checked or not motion.assembles(position).any():
            continue
        checked.add(position)
        figure = fl.draw(entry.mechanism, design, input=entry.input, **{entry.input: position})
        found = bars(figure)
        assert found
        for (a, b, branch), ends in found.items():
            (length,) = [
                one for bar in picture.bars for pair, one in bar.lengths.items() if pair.split() == [a, b]
            ]
            expected = abs(motion.values([length], [position])[length][int(branch) - 1, 0])
            # in the Minkowskian plane a sum and a difference of coordinates are multiplied
            size = np.abs(ends).max() * max(1.0, np.abs(ends).max() / expected)
            measured = plane.distance(ends[1] - ends[0])
            assert abs(measured - expected) <= 64 * UNIT_ROUNDING * max(size, expected), (a, b, branch)
    assert checked


@pytest.mark.sample(2)
@pytest.mark.parametrize("mechanism", NAMES)
def test_joints_stand_where_the_facts_say_in_both_assembly_modes(mechanism):
    design = DESIGNS[mechanism]
    found = bars(drawn(mechanism))
    picture = picture_of(mechanism, catalogue(mechanism))
    assert {branch for *_, branch in found} == {"1", "2"}
    for (a, b, branch), ends in found.items():
        for name, place in zip((a, b), ends, strict=True):
            point = picture.point(name)
            for value, coordinate in zip((point.x, point.y), place, strict=True):
                if value in design or isinstance(value, float):
                    assert coordinate == design.get(value, value)
                else:
                    fact = fl.evaluate(mechanism, [value], **design, branch=int(branch))[value]
                    assert coordinate == fact, (name, branch)


@pytest.mark.parametrize("mechanism", NAMES)
def test_names_are_shown_and_none_covers_another(mechanism):
    figure = drawn(mechanism)
    shown = [letter for text in names(figure) for letter in text.split("$, $")]
    picture = picture_of(mechanism, catalogue(mechanism))
    wanted = {one.name for one in picture.points if one.is_named and not one.group}
    assert wanted <= set(shown)
    renderer = figure.canvas.get_renderer()
    texts = [text for text in figure.axes[0].texts if text.get_gid() == "name"]
    boxes = [text.get_window_extent(renderer).shrunk(0.8, 0.6) for text in texts]
    over = [
        (texts[i].get_text(), texts[j].get_text())
        for i, j in itertools.combinations(range(len(boxes)), 2)
        if boxes[i].overlaps(boxes[j])
    ]
    assert over == []


@pytest.mark.parametrize("mechanism", NAMES)
def test_the_picture_is_to_scale(mechanism):
    figure = drawn(mechanism)
    axis = figure.axes[0]
    inches = axis.get_position().size * figure.get_size_inches()
    units = np.array([np.ptp(axis.get_xlim()), np.ptp(axis.get_ylim())])
    # three roundings of either
    assert_allclose(*inches / units, rtol=8 * UNIT_ROUNDING)
    assert any(text.get_text().endswith(" m") for text in axis.texts)


def test_what_both_assembly_modes_share_is_drawn_once():
    found = bars(fl.draw("planar_4r", FOUR_BAR, theta1=1.0))
    assert sorted(found) == [
        *(("A", "B", "1"), ("A", "B", "2"), ("D", "B", "1"), ("D", "B", "2"), ("O", "A", "1")),
    ]
    assert sorted(bars(fl.draw("planar_4r", FOUR_BAR, theta1=1.0, branch=2))) == [
        *(("A", "B", "2"), ("D", "B", "2"), ("O", "A", "2")),
    ]


# -- the range of the motion -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("mechanism", "design", "low", "high"),
    [
        ("planar_4r", ROCKER, "theta1_low", "theta1_high"),
        ("focal", {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "s": 2.0, "completion": 1}, "phi_low", "phi_high"),
        ("slider_crank", {"r": 0.4, "l": 0.3, "e": 0.02}, "theta_low", "theta_high"),
    ],
)
def test_the_range_ends_at_the_toggles_of_the_facts(mechanism, design, low, high):
    known = catalogue(mechanism)
    motion = Motion(mechanism, known, picture_of(mechanism, known), design, (1, 2), None)
    found = fl.evaluate(mechanism, [low, high], **design)
    ends = np.array(motion.ranges).ravel()
    for limit in found.values():
        # halved to 2^-44 of half a degree; near a toggle the sign of what is under the root is rounded
        assert abs(ends - limit).min() < 1e-12


def test_a_design_that_turns_fully_has_one_range_of_a_turn():
    known = catalogue("planar_4r")
    motion = Motion("planar_4r", known, picture_of("planar_4r", known), FOUR_BAR, (1, 2), None)
    assert motion.turns_fully
    assert motion.ranges == ((-np.pi, np.pi),)


@pytest.mark.parametrize("joint", [1, 2, 3, 4])
def test_by_a_joint_angle_the_linkage_stands_where_theta1_puts_it(joint):
    """One of the two assembly modes by the joint; its points lose a few roundings in either way, its angles one."""
    given = fl.evaluate("planar_4r", [f"joint_angle_{joint}"], **DESIGNS["planar_4r"], branch=1)
    angle = {name: float(value) for name, value in given.items()}
    expected = bars(fl.draw("planar_4r", DESIGNS["planar_4r"], branch=1))
    found = bars(fl.draw("planar_4r", CURVED, input=f"joint_angle_{joint}", **angle))
    for (a, b, _), ends in expected.items():
        modes = [one for (*pair, _), one in found.items() if pair == [a, b]]
        assert any(np.abs(one - ends).max() < 64 * UNIT_ROUNDING for one in modes), (a, b)


# -- words, strips and curves ----------------------------------------------------------------------------------------


def test_words_add_what_they_say():
    usual = fl.draw("planar_4r", CURVED, theta1=1.0, branch=1)
    more = fl.draw("planar_4r", CURVED, theta1=1.0, branch=1, show="path circles comb")
    assert (
        len(more.axes[0].lines) == len(usual.axes[0].lines) + 2 + 2
    )  # circles of A and B; teeth and their ends
    alone = fl.draw("planar_4r", CURVED, theta1=1.0, branch=1, show="comb")
    assert len(alone.axes[0].lines) == len(usual.axes[0].lines) + 2 - 1
    none = fl.draw("planar_4r", CURVED, theta1=1.0, branch=1, show=[])
    assert len(none.axes[0].lines) == len(usual.axes[0].lines) - 1


def test_the_teeth_of_a_comb_are_as_long_as_the_curvature():
    figure = fl.draw("planar_4r", CURVED, theta1=1.0, branch=2, show="comb")
    teeth = [line.get_xydata() for line in figure.axes[0].lines if line.get_alpha() and line.get_lw() == 0.5]
    feet, tips, _ = teeth[0].reshape(-1, 3, 2).transpose(1, 0, 2)
    at = np.linspace(-np.pi, np.pi, 2 * len(feet) * 2 // 2)[::2]
    expected = fl.evaluate("planar_4r", ["curvature", "P_x"], **CURVED, theta1=at, branch=2)
    assert_allclose(feet[:, 0], expected["P_x"], rtol=1e-15)
    ratio = np.hypot(*(tips - feet).T) / np.abs(expected["curvature"])
    clipped = ratio < 0.999 * ratio.max()
    assert clipped.mean() < 0.2
    # of a difference of coordinates of size 1, teeth of a hundredth
    assert_allclose(ratio[~clipped], ratio.max(), rtol=1e-3)


def test_forces_are_arrows_in_their_directions():
    given = CURVED | {"omega1": 20.0, "theta1": 1.0}
    links = fl.round_bar(7750.0, 0.01)
    figure = fl.draw("planar_4r", given, links=links, branch=1, show="forces")
    arrows = [one for one in figure.axes[0].texts if getattr(one, "arrow_patch", None)]
    vectors = np.array([np.subtract(one.xy, one.xyann) for one in arrows])
    names = [f"{name}_{xy}" for name in ("F41", "F21", "F32", "F43") for xy in "xy"]
    forces = fl.evaluate("planar_4r", names, **given, links=links, branch=1)
    expected = np.reshape(list(forces.values()), (4, 2))
    (legend,) = [one.get_text() for one in figure.legends[0].get_texts() if "forces" in one.get_text()]
    assert float(legend.split()[-2]) == float(f"{np.hypot(*expected.T).max():.3g}")
    assert "e+" not in legend
    ratio = np.hypot(*vectors.T) / np.hypot(*expected.T)
    assert_allclose(ratio, ratio[0], rtol=1e-12)  # 2^-53 of a coordinate of 1 in an arrow of a thousandth
    assert_allclose(np.arctan2(*vectors.T), np.arctan2(*expected.T), rtol=1e-12)


def test_torques_are_curved_arrows_in_their_sense():
    given = {"r": 0.1, "l": 0.3, "e": 0.02, "omega": 50.0, "m3": 0.5, "theta": 0.9}
    links = fl.round_bar(7750.0, 0.01)
    figure = fl.draw("slider_crank", given, links=links, show="torques")
    torques = fl.evaluate("slider_crank", ["T41"], **given, links=links, branch=[1, 2])["T41"]
    arcs = [line.get_xydata() for line in figure.axes[0].lines if line.get_zorder() == 6.5]
    assert len(arcs) == 2
    for arc, torque in zip(arcs, torques, strict=True):
        turn = np.unwrap(np.arctan2(*arc.T[::-1]))
        assert np.sign(turn[-1] - turn[0]) == np.sign(torque)
    (legend,) = [one.get_text() for one in figure.legends[0].get_texts() if "torques" in one.get_text()]
    assert legend == f"torques, the greatest {np.abs(torques).max():.3g} N m"


@pytest.mark.parametrize(("mechanism", "show", "paths"), [
    ("focal", "path comb", 1), ("hart", "path comb", 0), ("hart", "path ellipse comb", 1), ("minkowski_4r", "comb", 1),
])  # fmt: skip
def test_every_path_that_is_bent_has_a_comb(mechanism, show, paths):
    """Hart's line has none: its curvature is rounding alone."""
    figure = fl.draw(mechanism, DESIGNS[mechanism], show=show, branch=1)
    combs = [line for line in figure.axes[0].lines if line.get_alpha() and line.get_lw() == 0.5]
    assert len(combs) == paths


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


def test_a_strip_stands_at_equal_steps_over_the_motion():
    figure = fl.draw("planar_4r", FOUR_BAR, strip=6, degrees=True)
    assert [axis.get_title().split("= ")[1] for axis in figure.axes] == [
        "0°", "60°", "120°", "180°", "240°", "300°"
    ]  # fmt: skip
    given = fl.draw("planar_4r", FOUR_BAR, theta1_deg=[10, 20, 200])
    assert [axis.get_title().split("= ")[1] for axis in given.axes] == ["10°", "20°", "200°"]


def test_both_completions_of_the_focal_mechanism_stand_side_by_side():
    design = {name: value for name, value in DESIGNS["focal"].items() if name != "completion"}
    first, second = fl.draw("focal", design).axes
    assert (first.get_title()[:12], second.get_title()[:12]) == ("completion 1", "completion 2")


def test_curves_stand_beside_with_the_input_marked():
    figure = fl.draw("planar_4r", FOUR_BAR, theta1_deg=60, curves=["theta4", "transmission_angle"])
    _, *beside = figure.axes
    assert len(beside) == 2
    for name, axis in zip(("theta4", "transmission_angle"), beside, strict=True):
        marks = [line.get_xydata()[0] for line in axis.lines if line.get_marker() == "o"]
        expected = fl.evaluate("planar_4r", [name], **FOUR_BAR, theta1=np.pi / 3, branch=[1, 2])[name]
        # a conversion and, of theta1, a shift by a turn
        assert_allclose(marks, [(60.0, value) for value in np.degrees(expected)], rtol=1e-14)


# -- what means nothing ----------------------------------------------------------------------------------------------


def test_a_position_beyond_the_limits_says_why_and_where_it_assembles():
    with refused("theta1_deg", "-145.168° to -24.147° or 24.147° to 145.168°"):
        fl.draw("planar_4r", ROCKER, theta1_deg=170)
    with pytest.raises(fl.InputError, match="assembles over part of the turn"):
        fl.draw("planar_4r", ROCKER, theta1=0.1)
    figure = fl.draw("planar_4r", ROCKER, theta1_deg=[60, 170])  # of several, one assembles
    assert (bool(bars(figure, 0)), bool(bars(figure, 1))) == (True, False)
    assert "does not assemble" in [text.get_text() for text in figure.axes[1].texts]


@pytest.mark.parametrize("at", [60.0, [60.0, 80.0]])
def test_an_angle_that_looks_like_degrees_is_remarked_on_once(at):
    with pytest.warns(fl.InputWarning) as noted:
        fl.draw("planar_4r", FOUR_BAR, theta1=at)
    (text,) = [str(one.message) for one in noted]
    assert text.startswith(f"draw: theta1: {at} is taken as radians")


def test_a_design_that_never_assembles_says_so():
    with refused("never assembles", "another design"):
        fl.draw("planar_4r", a1=0.4, a2=5.0, a3=0.8, a4=1.0)


@pytest.mark.parametrize(
    ("given", "key", "remedy"),
    [
        ({"a1": -1.0}, "a1", "greater than 0"),
        ({"a1": [0.4, 0.5]}, "a1", "one number"),
        ({"a7": 1.0}, "a7", "did you mean"),
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
        ({"to": "linkage.bmp"}, "to", "png, svg, pdf"),
        ({"degrees": 3}, "degrees", "True or False"),
        ({"theta1_degg": 3.0}, "theta1_degg", ""),
    ],
)
def test_requests_that_mean_nothing_are_refused(given, key, remedy):
    with refused(key, remedy):
        fl.draw("planar_4r", **FOUR_BAR | given)


def test_options_among_the_inputs_are_refused():
    """A design is a mapping, whose names would else be taken for keywords of the evaluation."""
    for name in signature(fl.evaluate).parameters:
        remedy = f"beside the design, {name}=" if name in ("branch", "input", "links") else "leave it out"
        with refused(name, remedy):
            fl.draw("planar_4r", FOUR_BAR | {name: 1})
    with refused("trust_code", "True or False"):
        fl.draw("planar_4r", FOUR_BAR, trust_code="no")


@pytest.mark.parametrize("kind", ["svg", "pdf"])  # png: test_page.py
def test_pictures_of_each_kind_are_written(tmp_path, kind):
    place = tmp_path / f"linkage.{kind}"
    fl.draw("slider_crank", DESIGNS["slider_crank"], to=place)
    begins = {"svg": b"<?xml", "pdf": b"%PDF"}
    assert place.read_bytes().startswith(begins[kind])


def test_a_notebook_shows_the_figure_by_itself():
    assert drawn("hart")._repr_png_().startswith(b"\x89PNG")


def test_a_range_that_is_only_looked_at_is_no_limit():
    linkage = {"a": 1.0, "b": 1.0, "g": 4.0, "h": 1.0, "x": 0.5, "y": 0.3}
    known = catalogue("minkowski_4r")
    motion = Motion(
        "minkowski_4r", known, picture_of("minkowski_4r", known), linkage, (1, 2), None, reach=5.0
    )
    limits = fl.evaluate("minkowski_4r", ["theta_min", "theta_max"], **linkage)
    inner, outer = f"{limits['theta_min']:g}", f"{limits['theta_max']:g}"
    assert motion.range_texts(False) == [f"up to -{outer}", f"-{inner} to {inner}", f"{outer} on"]
    assert motion.span == (-5.0, 5.0)
    assert bars(fl.draw("minkowski_4r", linkage, theta=4.5))


def test_the_conic_about_F_touches_the_four_sides():
    """Its second focus mirrored in a tangent is twice the major semi-axis from the first."""
    design = DESIGNS["focal"]
    figure = fl.draw("focal", design, branch=2, show="foci")
    (second,) = [line.get_xydata()[0] for line in figure.axes[0].lines if line.get_marker() == "x"]
    found = bars(figure)
    (shape,) = [one for one in figure.axes[0].patches if hasattr(one, "get_center")]
    first = found["P", "F", "2"][1]
    sides = [found["M", "A", "2"], found["N", "B", "2"], found["A", "B", "2"]]
    for start, end in sides:
        across = np.array([start[1] - end[1], end[0] - start[0]]) / np.hypot(*(end - start))
        mirrored = second - 2.0 * ((second - start) @ across) * across
        # a root of a quadratic of coordinates of 5, some ten roundings each
        assert abs(np.hypot(*(mirrored - first)) - max(shape.width, shape.height)) < 1e-12

"""Facts as JavaScript give what the same facts give in Python, and motions the same ranges."""

from importlib.resources import files

import numpy as np
import pytest
from tests.support.sweeps import sweep_both

import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue
from fastlink.pictures import content
from fastlink.pictures.content import OWN, Values, content_of, script_of
from fastlink.pictures.draw import picture_of
from fastlink.pictures.motion import Motion
from fastlink.plan.request import missing_inputs

#: One design of each mechanism that turns fully, one with limits.
DESIGNS = [
    ("planar_4r", {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0, "omega1": 3.0, "P_u": 0.3, "P_v": 0.2}),
    ("planar_4r", {"a1": 1.2, "a2": 0.8, "a3": 0.7, "a4": 1.0, "omega1": 3.0}),
    ("slider_crank", {"r": 0.05, "l": 0.16, "e": 0.01, "omega": 20.0}),
    ("slider_crank", {"r": 0.2, "l": 0.16, "e": 0.01, "omega": 20.0}),
    ("minkowski_4r", {"a": 1.0, "b": 1.3, "g": 1.0, "h": 1.25}),
    ("focal", {"a": 5.0, "b": 4.5, "c": 2.0, "d": 4.0, "rho": 0.8, "completion": 1}),
    ("hart", {"m": 4.0, "n": 8.0, "d": 6.0, "kappa": 0.5}),
]
assert {name for name, _ in DESIGNS} == set(NAMES)

#: Counts of roundings, which are others in other functions.
ROUNDINGS = {"F_deviation"}
TASK = """([told, given]) => {
    const content = {mechanism: told};
    MOTION
    const motion = new Motion(given.design, Object.keys(mechanism.branches).map(Number));
    const each = run => given.positions.map(at => motion.branches.map(branch => run(at, branch)));
    const place = (of, at, point) => of.place(of.at(at, of.branches[0]), point), branch = motion.branches[0];
    const size = Math.max(...mechanism.points.flatMap(one => place(motion, given.positions[1], one)).map(Math.abs));
    const moves = mechanism.points.filter(one => moversOf(one).length).map(one => {
        const target = place(motion, given.positions[1], one).map((at, k) => at + [0.03, 0.02][k] * size);
        const {inputs, position} = motion.moved(one, branch, given.positions[1], target);
        return {name: one.name, target, inputs, position, fixed: one.kind === "ground"};
    });
    return {moves, ranges: motion.ranges, places: each((at, branch) => motion.places(at, branch)),
        values: given.names.map(name => each((at, branch) => valueOf(motion.at(at, branch), name)))};
}"""


@pytest.fixture(scope="module")
def blank(browser):
    """A tab without a page."""
    tab = browser.new_page()
    yield tab
    tab.close()


@pytest.mark.sample(2)
@pytest.mark.parametrize(("mechanism", "design"), DESIGNS)
@pytest.mark.browser
@pytest.mark.filterwarnings("default:NOT TESTED")
def test_a_page_moves_a_mechanism_as_a_picture_does(blank, mechanism, design):
    known = catalogue(mechanism)
    motion = Motion(mechanism, known, picture_of(mechanism, known), design, tuple(known.branches), None)
    page = content_of(Values(sweep_both(mechanism, fl.grid(**design), ["status"])))["mechanism"]
    low, high = motion.ranges[0]
    positions = low + (high - low) * np.array([0.03, 0.2, 0.41, 0.5, 0.77, 0.96])
    names = [one["name"] for one in page["curves"] if one["name"] not in ROUNDINGS]
    text = files("fastlink").joinpath("pictures", "page", "motion.js").read_text(encoding="utf-8")
    task = TASK.replace("MOTION", text.replace("/*FACTS*/", page["script"]))
    given = {"design": design, "positions": positions.tolist(), "names": names}
    found = blank.evaluate(task, [page | {"script": ""}, given])
    # bisection ends at neighbouring doubles; where the linkage just assembles, rounding decides within some of them
    np.testing.assert_allclose(found["ranges"], motion.ranges, rtol=1e-7)
    # each joint is where it was dragged to, by the changed inputs; those of the ground stay on its line
    for one in found["moves"]:
        dragged = Motion(mechanism, known, picture_of(mechanism, known), design | one["inputs"], (1,), None)
        place = dragged.places(np.array([one["position"]]))[one["name"]].ravel()
        kept = slice(0, 1) if one["fixed"] else slice(None)
        np.testing.assert_allclose(place[kept], np.array(one["target"])[kept], rtol=1e-6, err_msg=one["name"])
    # some hundred roundings, which these positions amplify by 1e3 at most: 1e2 * 2^-53 * 1e3 < 2e-11 of the size
    for name, place in motion.places(positions).items():
        if name in found["places"][0][0]:
            own = np.array([[modes[name] for modes in at] for at in found["places"]], dtype=float)
            np.testing.assert_allclose(own, place.transpose(1, 0, 2), rtol=1e-10, atol=1e-10, err_msg=name)
    expected = motion.values(names, positions)
    for name, values in zip(names, found["values"], strict=True):
        own, true = np.array(values, dtype=float), expected[name].T
        size = np.abs(true[np.isfinite(true)]).max(initial=1e-3)
        np.testing.assert_allclose(own, true, rtol=1e-9, atol=1e-9 * size, err_msg=name)


@pytest.mark.parametrize("mechanism", NAMES)
def test_every_quantity_over_the_input_is_translated(mechanism):
    known = catalogue(mechanism)
    given = list(known.inputs)
    curves = [name for name in known.public if known.varies(name)]
    names = tuple(name for name in curves if not missing_inputs(known, name, (), given))
    assert script_of(known, names, given, ())[1] == names


def test_what_has_no_counterpart_is_left_out(monkeypatch):
    monkeypatch.setattr(content, "OWN", {key: name for key, name in OWN.items() if name != "Math.sqrt"})
    known = catalogue("planar_4r")
    assert script_of(known, ["A_x", "B_x", "A_y"], known.inputs, ())[1] == ("A_x", "A_y")

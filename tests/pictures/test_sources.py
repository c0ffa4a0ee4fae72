"""Designs that are drawn: by numbers, of a study, of a map, of the best rows of a map."""

import numpy as np
import pytest
from tests.pictures.test_draw import FOUR_BAR, bars
from tests.support.refusals import refused

import fastlink as fl

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


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    place = tmp_path_factory.mktemp("maps") / "maps.h5"
    space = fl.grid(a1=0.4, a2=[1.0, 1.1, 1.2], a3=[0.7, 0.8], a4=1.0)
    fl.sweep("planar_4r", space, ["transmission_angle"], theta1=[1.0, 2.0], to=place, verify=0).close()
    return place


@pytest.fixture(scope="module")
def maps(place):
    with fl.open(place) as maps:
        return maps.load()


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def lengths(figure):
    """Return a2 and a3, measured in the picture."""
    found = {key[:2]: float(np.hypot(*np.diff(ends, axis=0)[0])) for key, ends in bars(figure).items()}
    return found["A", "B"], found["D", "B"]


# design 3 of 3 x 2 in C order is the second a2 and the second a3; a length of 1 from coordinates of 1: some roundings
EXPECTED = pytest.approx((1.1, 0.8), rel=1e-14)


def test_a_design_of_a_map_by_its_number_and_by_its_values(maps, place):
    assert lengths(fl.draw(maps, 3, theta1=1.0)) == EXPECTED
    assert lengths(fl.draw(maps, at={"a2": 1.12, "a3": 0.79}, theta1=1.0)) == EXPECTED
    assert lengths(fl.draw(maps, 2, a3=0.8, theta1=1.0)) == EXPECTED
    assert lengths(fl.draw(place, 3)) == EXPECTED
    assert lengths(fl.draw(str(place), 3, theta1=1.0)) == EXPECTED


def test_a_row_has_its_assembly_mode_and_its_position(maps):
    rows = maps.fastlink.top(2, "transmission_angle")
    expected = float(rows.a2[1]), float(rows.a3[1])
    figure = fl.draw(rows, 1)
    crank = bars(figure)["O", "A", str(int(rows.branch[1]))][1]
    assert np.arctan2(*crank[::-1]) == pytest.approx(float(rows.theta1[1]), rel=1e-15)
    assert lengths(figure) == pytest.approx(expected, rel=1e-14)
    assert {branch for *_, branch in bars(figure)} == {str(int(rows.branch[1]))}
    assert {branch for *_, branch in bars(fl.draw(rows, 1, theta1_deg=20, branch=[1, 2]))} == {"1", "2"}


def test_a_design_of_a_study_with_its_links(study):
    figure = fl.draw(study, 3, theta1=1.0, show="forces", branch=2)
    assert lengths(figure) == EXPECTED
    assert sum(getattr(one, "arrow_patch", None) is not None for one in figure.axes[0].texts) == 4
    assert lengths(fl.draw(study, at={"a2": 1.12, "a3": 0.79}, theta1=1.0)) == EXPECTED


def test_a_single_design_needs_no_number(study):
    study.write_text(
        STUDY.replace("{linspace = [1.0, 1.2, 3]}", "1.1").replace("{values = [0.7, 0.8]}", "0.8")
    )
    assert lengths(fl.draw(study, theta1=1.0)) == EXPECTED


@pytest.mark.parametrize(
    ("given", "key", "remedy"),
    [
        ({}, "design", "design=0"),
        ({"design": 6}, "design", "0 to 5"),
        ({"design": "first"}, "design", "0 to 5"),
        ({"design": 1, "at": {"a2": 1.0}}, "at", "leave one"),
        ({"at": {"a2": 1.0}}, "at", "such as 0.7"),
        ({"at": {"a2": 3.0, "a3": 0.7}}, "at", "from 1 to 1.2"),
        ({"at": {"a9": 3.0, "a2": 1.0, "a3": 0.7}}, "at", "did you mean"),
        ({"at": 3}, "at", "{'a4': 1.0}"),
    ],
)
def test_what_names_no_design_of_a_map_is_refused(maps, given, key, remedy):
    with refused(key, remedy):
        fl.draw(maps, **given, theta1=1.0)


def test_what_is_no_source_is_refused(tmp_path):
    with refused("mechanism", "did you mean 'planar_4r'"):
        fl.draw("planar4r", FOUR_BAR)
    with refused("at", "leave it out"):
        fl.draw("planar_4r", FOUR_BAR, at={"a1": 1.0})
    with refused("design", "by name"):
        fl.draw("planar_4r", 3)
    with refused("design", "once"):
        fl.draw("planar_4r", FOUR_BAR, a1=0.4)
    with pytest.raises(fl.InputError, match="absent"):
        fl.draw(tmp_path / "absent.h5", 3)
    with pytest.raises(fl.InputError, match="absent"):
        fl.draw(tmp_path / "absent.toml", 3)

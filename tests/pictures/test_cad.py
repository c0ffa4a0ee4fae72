"""Drawings for CAD: joints and paths stand where the facts say, in millimetres, on layers of their own."""

import sys
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from numpy.testing import assert_allclose
from tests.support.refusals import refused

import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue
from fastlink.pictures.draw import picture_of

ezdxf = pytest.importorskip("ezdxf")

DESIGNS = {
    "planar_4r": {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0, "P_u": 0.5, "P_v": 0.35, "theta1": 1.0},
    "minkowski_4r": {"a": 1.0, "b": 1.0, "g": 4.0, "h": 1.0, "x": 0.5, "y": 0.3, "theta": 1.6},
    "focal": {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "s": 2.0, "completion": 1, "phi": 1.3},
    "hart": {"m": 4.0, "n": 8.0, "d": 5.0, "kappa": 0.5, "phi": 0.9},
    "slider_crank": {"r": 0.1, "l": 0.3, "e": 0.02, "theta": 0.9},
}
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
    bars = {
        tuple(np.round(one, 6))
        for bar in space.query('LWPOLYLINE[layer=="bars"]')
        for one in bar.get_points("xy")
    }
    assert bars <= {tuple(np.round(one, 6)) for one in points.values()}
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

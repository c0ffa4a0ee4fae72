"""What the server answers, and what it refuses."""

import contextlib
import itertools
import json
import signal
import subprocess
import sys
import urllib.request
from http.client import HTTPConnection
from importlib.resources import files
from unittest.mock import Mock
from urllib.parse import quote, urlsplit

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.refusals import refused
from tests.support.sweeps import sweep_both

import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue
from fastlink.pictures import content, explore
from fastlink.pictures.content import OWN, Values, content_of, script_of
from fastlink.pictures.draw import picture_of
from fastlink.pictures.motion import Motion
from fastlink.plan.request import missing_inputs


def ask(page, where, query=None, **headers):
    """Return status and body of an answer; a query that is a text is sent as it is."""
    base, _, token = page.url.partition("?token=")
    if query is not None:
        where += "?query=" + quote(query if isinstance(query, str) else json.dumps(query))
    with contextlib.closing(HTTPConnection(urlsplit(base).netloc, timeout=30)) as connection:
        connection.request("GET", f"/{where}", headers={"X-Token": token, **headers})
        with connection.getresponse() as reply:
            return reply.status, reply.read()


def picture(page, **query):
    """Return head and values of a picture."""
    status, body = ask(page, "picture", {"name": "omega4_max", "window": {}, **query})
    assert status == 200, body
    length = int.from_bytes(body[:4], "little")
    return json.loads(body[4 : 4 + length]), np.frombuffer(body[4 + length :], dtype="<f4")


def test_it_is_served_on_this_machine_alone_to_whoever_has_the_token(page):
    assert page.url.startswith("http://127.0.0.1:")
    assert len(page.url.partition("?token=")[2]) >= 32
    for where, token in itertools.product(("", "picture", "row", "no", "../../etc/passwd"), ("", "x", "é")):
        address = f"{where}?token={quote(token)}&query=%7B%7D"
        assert ask(page, address, **{"X-Token": "no"})[0] == 403, (where, token)
    assert ask(page, "row", {"at": {}}, Host="evil.example")[0] == 403  # another name of this machine
    for where in ("etc/passwd", "../lengths.h5", "lengths.h5", "page/main.js"):
        assert ask(page, where, {})[0] == 404, where


def nested(opening, closing, count=1000):
    return '{"name": ' + opening * count + "1" + closing * count + "}"


SIZES = {"axes": ["a2"], "at": {}, "window": {}}
ROW = '{{"at": {{"a1": {}, "a2": 0, "a3": 0, "branch": 0}}}}'
BAD = [
    *("/picture", "/picture?query=5", "/row?query=[]", "/row", "http://[row"),
    *("/row?query=" + quote(one) for one in (nested("[", "]"), ROW.format("1" + 400 * "0"), '"\\ud800"')),
    *("/row?query=" + quote(one) for one in (ROW.format("1" + 5000 * "0"), '{"at": {"a1": "x"}}')),
    *(
        "/picture?query=" + quote(one if isinstance(one, str) else json.dumps(one))
        for one in (
            nested('{"a": ', "}"),
            {**SIZES, "name": "no"},
            {**SIZES, "name": "omega4_max", "axes": ["a2", "a3"]},
            {**SIZES, "name": "omega4_max", "axes": [["a2"]]},
            {**SIZES, "name": "omega4_max", "at": {"a1": 99, "a3": 0, "branch": 0}},
        )
    ),
]


def test_whatever_is_asked_is_answered_on_the_same_connection(page, monkeypatch):
    base, _, token = page.url.partition("?token=")
    address = urlsplit(base).netloc
    connection = HTTPConnection(address, timeout=30)

    def status(where):
        connection.putrequest("GET", where, skip_host=True)  # which would look into the address
        connection.putheader("Host", address)
        connection.putheader("X-Token", token)
        connection.endheaders()
        with connection.getresponse() as reply:
            assert b"\n" not in reply.read()
            return reply.status

    row = "/row?query=" + quote(ROW.format(0))
    with contextlib.closing(connection):
        assert status(row) == 200
        opened = connection.sock
        for where in BAD:
            assert status(where) == 400, where
        with monkeypatch.context() as patch:
            for error in (OSError("gone"), RuntimeError("not\nread"), MemoryError(), AssertionError()):
                patch.setattr(Values, "row", Mock(side_effect=error))
                assert status(row) == 500
        assert status(row) == 200
        assert connection.sock is opened


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    "text",
    ["/*FACTS*/", "/*STYLE*/", "/*SCRIPT*/", "NONCE", "</script><script>", "<!--", r"\1 \g<0>", "a\u2028b"],
)
def test_texts_of_a_map_are_told_to_the_page_as_they_are(path, tmp_path, text):
    def page_of(word):
        with fl.open(path) as maps:
            other = maps.assign_attrs(title=word).rename(omega4_max=word)
            other[word].attrs.update(long_name=word, symbol=word, units=word)
            fl.explore(other, to=tmp_path / "page.html", browser=False)
        return (tmp_path / "page.html").read_text()

    found = page_of(text)
    told = json.JSONDecoder().raw_decode(found, found.index("const content = ") + len("const content = "))[0]
    assert told["title"] == text
    (one,) = (one for one in told["variables"] if one["name"] == text)
    assert (one["meaning"], one["symbol"], one["units"]) == (text, text, text)
    written = json.dumps(text).replace("<", r"\u003c")
    assert found.replace(written, '"plain"') == page_of("plain")


def test_a_picture_and_a_row_hold_the_values_of_the_map(page, path, tmp_path):
    fl.convert(path, tmp_path / "small.h5", compress="gzip:4")
    at, axes = {"a1": 1, "branch": 0}, ["a3", "a2"]
    with fl.open(path) as maps, fl.open(tmp_path / "small.h5") as compressed:
        expected = maps.omega4_max.isel(a1=1, branch=0).transpose("a3", "a2").values.astype("f4")
        assert_array_equal(Values(compressed).picture("omega4_max", (*axes,), at, {})[0], expected)
        one = maps.isel(a1=1, a2=3, a3=4, branch=1)
        row = json.loads(ask(page, "row", {"at": {"a1": 1, "a2": 3, "a3": 4, "branch": 1}})[1])
        assert {name: float(value) for name, value in row.items()} == {
            name: float(one[name]) for name in maps.data_vars
        }
    head, values = picture(page, axes=axes, at=at)
    assert head["steps"] == {"a2": 1, "a3": 1}
    assert_array_equal(values.reshape(expected.shape), expected)
    _, values = picture(page, axes=axes, at=at, window={"a2": [2, 4], "a3": [5, 5]})
    assert_array_equal(values, expected[5, 2:5])


@pytest.mark.parametrize(
    "changed",
    [
        lambda maps: maps.isel(a2=slice(None, None, -1)),
        lambda maps: maps.assign(omega4_max=2.0 * maps.omega4_max),
        lambda maps: maps.isel(a1=slice(1, None)),
    ],
)
def test_a_map_that_was_changed_is_shown_as_it_is_now(path, changed):
    """Not as the file has it from which it was opened."""
    with fl.open(path) as maps:
        other = changed(maps)
        with fl.explore(other, browser=False) as page:
            _, values = picture(page, axes=["a2", "a3"], at={"a1": 0, "branch": 0})
        expected = other.omega4_max.isel(a1=0, branch=0).values
        assert_array_equal(values.reshape(expected.shape), expected.astype("f4"))


@pytest.mark.parametrize("pool", ["mean", "least", "greatest"])
@pytest.mark.parametrize("axes", [("a", "b"), ("b", "a")])
def test_a_cell_of_several_designs_is_made_of_all_of_them(pool, axes, monkeypatch):
    """Of 3 x 2 designs, of fewer at the ends; those without a value count in none, nor infinite ones in a mean."""
    monkeypatch.setattr(content, "MOST_CELLS", 5)
    monkeypatch.setattr(content, "BLOCK", 40)
    numbers = np.random.default_rng(5).normal(size=(13, 2, 9))
    numbers[3:6, 0, 2:4], numbers[0, 0, 0], numbers[9, 0, 8] = np.nan, np.nan, np.inf
    maps = xr.Dataset({"x": (("a", "c", "b"), numbers, {"units": "1"})})
    found, steps, said = Values(maps).picture("x", axes, {"c": 0}, {}, pool)
    assert (steps, said) == ({"a": 3, "b": 2}, pool)
    slices, merge = numbers[:, 0], {"mean": np.nanmean, "least": np.nanmin, "greatest": np.nanmax}[pool]
    for i, j in itertools.product(range(5), range(5)):
        cell = slices[3 * i : 3 * i + 3, 2 * j : 2 * j + 2]
        cell = cell[np.isfinite(cell)] if pool == "mean" else cell[~np.isnan(cell)]
        expected = np.float32(merge(cell)) if cell.size else np.nan
        at = (i, j) if axes == ("a", "b") else (j, i)
        # a mean of six is added in another order; both are rounded to 24 bits
        assert_allclose(found[at], expected, rtol=2.0**-22)


def test_a_large_picture_is_read_at_the_resolution_of_a_screen():
    maps = xr.Dataset({"x": (("a", "b"), np.arange(3000.0 * 4).reshape(3000, 4), {"units": "1"})})
    maps["count"] = maps.x % 3
    for name, pool in (("x", "one"), ("count", "mean")):  # of counts there is no mean
        values, steps, said = Values(maps).picture(name, ("b", "a"), {}, {}, pool)
        assert (steps, said) == ({"a": 5, "b": 1}, "one")
        assert_array_equal(values, maps[name].values[::5].T)
    values, steps, _ = Values(maps).picture("x", ("a", "b"), {}, {"a": (10, 20)})
    assert steps == {"a": 1, "b": 1}
    assert_array_equal(values, maps.x.values[10:21])


@pytest.mark.parametrize("block", [1, 100, 1 << 20])
def test_the_best_of_a_region_over_all_values_of_a_slider(page, path, block, monkeypatch):
    monkeypatch.setattr(explore, "BLOCK", block)
    query = {"name": "omega4_max", "axes": ["a3", "a2", "a1"], "at": {"branch": 0}, "largest": True}
    status, body = ask(page, "region", query | {"window": {"a1": [0, 2], "a2": [3, 11], "a3": [4, 11]}})
    assert status == 200
    found = json.loads(body)
    with fl.open(path) as maps:
        inside = maps.isel(branch=0, a2=slice(3, 12), a3=slice(4, 12))
        true = inside.fastlink.top(12, "omega4_max").omega4_max.values
        best = [float(maps.omega4_max.isel(one["at"])) for one in found["best"]]
    assert_array_equal(best, true)
    assert found["count"] == 3 * 9 * 8
    assert {one["at"]["a1"] for one in found["best"]} <= {0, 1, 2}
    assert len(found["values"]["omega4_max"]) == len(found["axes"]["a1"]) <= explore.MOST_ROWS


def test_wrong_options_are_refused(page, path, folder, monkeypatch):
    monkeypatch.setattr(explore, "MOST_BYTES", 1000)
    for options, key, remedy in (
        ({"to": "page.pdf"}, "to", "page.html"),
        ({"to": "no/page.html"}, "to", "create it"),
        ({"to": "page.html"}, "to", "fastlink.convert"),  # more than a browser holds
        ({"port": -1}, "port", "from 0 to 65535"),
        ({"port": urlsplit(page.url).port}, "port", "leave it out"),
        ({"browser": 1}, "browser", "True or False"),
    ):
        with refused(key, remedy):
            fl.explore(path, **{"browser": False, **options})
    assert not list(folder.iterdir())


def test_the_command_serves_until_it_is_interrupted(path):
    # a shell's background ignores the signal, and what it starts does too
    heeds = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    runs = "from fastlink.app.cli import main; main()"
    command = [sys.executable, "-c", f"{heeds}; {runs}", "explore", str(path), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as running:
        try:
            address = running.stdout.readline().strip()
            with urllib.request.urlopen(address, timeout=60) as reply:
                assert b"lengths.h5" in reply.read()
            running.send_signal(signal.SIGINT)
            assert running.wait(timeout=60) == 0
        finally:
            running.kill()


# == Facts as JavaScript give what the same facts give in Python, and motions the same ranges ================

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
    assert_allclose(found["ranges"], motion.ranges, rtol=1e-7)
    # each joint is where it was dragged to, by the changed inputs; those of the ground stay on its line
    for one in found["moves"]:
        dragged = Motion(mechanism, known, picture_of(mechanism, known), design | one["inputs"], (1,), None)
        place = dragged.places(np.array([one["position"]]))[one["name"]].ravel()
        kept = slice(0, 1) if one["fixed"] else slice(None)
        assert_allclose(place[kept], np.array(one["target"])[kept], rtol=1e-6, err_msg=one["name"])
    # some hundred roundings, which these positions amplify by 1e3 at most: 1e2 * 2^-53 * 1e3 < 2e-11 of the size
    for name, place in motion.places(positions).items():
        if name in found["places"][0][0]:
            own = np.array([[modes[name] for modes in at] for at in found["places"]], dtype=float)
            assert_allclose(own, place.transpose(1, 0, 2), rtol=1e-10, atol=1e-10, err_msg=name)
    expected = motion.values(names, positions)
    for name, values in zip(names, found["values"], strict=True):
        own, true = np.array(values, dtype=float), expected[name].T
        size = np.abs(true[np.isfinite(true)]).max(initial=1e-3)
        assert_allclose(own, true, rtol=1e-9, atol=1e-9 * size, err_msg=name)


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

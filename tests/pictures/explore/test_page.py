"""The page in a real browser: what a reader sees follows from what is done."""

import contextlib
import csv
import time
import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.browser import PATIENCE, new_tab, opened
from tests.support.sweeps import BARS, sweep_4r

import fastlink as fl
from fastlink.maps.units import flags_of

pytestmark = [pytest.mark.browser, pytest.mark.filterwarnings("default:NOT TESTED")]

#: The colours at the middle of the cells of a picture of 15 by 13; pixels in the colour of the first assembly mode.
PIXELS = """(() => {
    const canvas = element("map"), pen = canvas.getContext("2d"), ratio = canvas.width / canvas.clientWidth;
    const found = [], {left, top, width, height} = view.box;
    for (let j = 0; j < 13; j++) for (let i = 0; i < 15; i++) {
        const x = (left + (i + 0.5) / 15 * width) * ratio, y = (top + (1 - (j + 0.5) / 13) * height) * ratio;
        found.push([...pen.getImageData(Math.round(x), Math.round(y), 1, 1).data.slice(0, 3)]);
    }
    return found;
})()"""
GREATEST = """async () => {
    const found = await source.picture({...view.query, pool: "greatest"});
    return [found.pooled, Array.from(found.values, one => String(Math.fround(one)))];
}"""
#: Keep each text of a canvas with its box on it since the canvas was cleared.
HOOK = """(() => {
    const pen = CanvasRenderingContext2D.prototype, {fillText, clearRect} = pen;
    pen.clearRect = function (...box) { this.canvas.texts = []; clearRect.apply(this, box); };
    pen.fillText = function (text, x, y) {
        const {a, b, c, d, e, f} = this.getTransform(), ratio = this.canvas.width / this.canvas.clientWidth;
        const at = (u, v) => [(a * u + c * v + e) / ratio, (b * u + d * v + f) / ratio];
        const wide = this.measureText(text).width, left = x - wide * {left: 0, center: 0.5, right: 1}[this.textAlign];
        const [p, q] = [at(left, y - 5), at(left + wide, y + 5)];
        this.canvas.texts.push([text, ...[0, 1].flatMap(k => [Math.min(p[k], q[k]), Math.max(p[k], q[k])])]);
        fillText.call(this, text, x, y);
    };
})()"""
#: All texts of the page, each with left, right, top and bottom; of one that ends in dots the first box counts.
TEXTS = """(() => {
    const found = [], range = document.createRange();
    const all = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (all.nextNode()) {
        const {currentNode: node, currentNode: {parentElement: parent, textContent: text}} = all;
        if (!text.trim() || parent.closest("option, script, #said, sub")) continue;
        if (!parent.checkVisibility({visibilityProperty: true})) continue;
        range.selectNodeContents(node);
        const end = parent.closest("#values div > :first-child")?.getBoundingClientRect().right ?? Infinity;
        [...range.getClientRects()].filter((one, k, every) => one.top !== every[k - 1]?.top).forEach(one =>
            found.push([text, one.left, Math.min(one.right, end), one.top + 2, one.bottom - 2]));
    }
    for (const canvas of document.querySelectorAll("canvas")) {
        const {left, top} = canvas.getBoundingClientRect();
        for (const [text, a, b, c, d] of canvas.texts ?? []) found.push([text, a + left, b + left, c + top, d + top]);
    }
    return found;
})()"""
INK = """(() => {
    const canvas = element("linkage"), size = [canvas.width, canvas.height];
    const data = canvas.getContext("2d").getImageData(0, 0, ...size).data, wanted = ofHex(MODES[0]);
    let count = 0;
    for (let k = 0; k < data.length; k += 4) count += wanted.every((one, c) => one === data[k + c]);
    return count;
})()"""


@pytest.fixture(scope="module")
def show(browser):
    with new_tab(browser) as found:
        yield found


@pytest.fixture
def tab(show, page):
    return show(page.url)


def state(tab, expression="state"):
    """Return a value of the page."""
    return tab.evaluate(expression)


def settled(tab, condition):
    """Wait until a condition of the page holds."""
    end = time.monotonic() + PATIENCE / 1000.0
    while not tab.evaluate(condition):  # the page lets nobody evaluate a text in it, but this
        assert time.monotonic() < end, condition
        tab.wait_for_timeout(15)


def point(tab, across, up):
    """Move the mouse to a place of the picture, in shares of its sides."""
    box, left = tab.locator("#over").bounding_box(), state(tab, "view.box")
    x = box["x"] + left["left"] + across * left["width"]
    y = box["y"] + left["top"] + (1 - up) * left["height"]
    tab.mouse.move(x, y)
    return x, y


def values(tab):
    """Return the values that are shown, by name."""
    return tab.evaluate(
        "Object.fromEntries([...document.querySelectorAll('#values div')].map(one => [one.dataset.name,"
        "(one.querySelector('input')?.value ?? '') + one.querySelector('.value').textContent]))"
    )


def shown_cells(tab, of="view.values"):
    """Return the values of a picture."""
    return np.array(state(tab, f"Array.from({of}, String)"), dtype=float)


def cells_of(path, **at):
    """Return the values of the map that its first picture shows."""
    with fl.open(path) as maps:
        return maps.omega4_max.isel(branch=0, **at).transpose("a3", "a2").values.astype("f4").ravel()


def middle(tab):
    """Point at the middle of the picture, and return the design there."""
    point(tab, 0.5, 0.5)
    settled(tab, "design.at.a2 === 7 && design.at.a3 === 6")
    return {"a1": 0.4, "a2": np.linspace(0.8, 1.5, 15)[7], "a3": np.linspace(0.4, 1.3, 13)[6], "a4": 1.0}


def test_it_shows_the_map_and_the_values_under_the_cursor(tab, path):
    assert tab.locator("#choose-name").input_value() == "omega4_max"
    assert (state(tab, "state.x"), state(tab, "state.y")) == ("a2", "a3")
    point(tab, 0.99, 0.01)
    settled(tab, "design.at.a2 === 14 && design.at.a3 === 0")
    with fl.open(path) as maps:
        one = maps.isel(a1=1, a2=14, a3=0, branch=0)
        shown = values(tab)
        assert shown["a2"] == "1.5 m"
        (meaning,) = [
            name for name, code in flags_of(one.grashof_class).items() if code == int(one.grashof_class)
        ]
        assert shown["grashof_class"] == meaning.replace("_", " ")
        for name in ("omega4_max", "transmission_angle_min"):
            value = float(one[name]) * (180 / np.pi if name == "transmission_angle_min" else 1.0)
            text = shown[name].replace("−", "-")
            number = float(text.split("°")[0].split()[0].replace("none", "nan"))
            assert number == pytest.approx(value, rel=1e-5, nan_ok=True)  # six digits are shown


def test_the_pixels_have_the_colours_of_the_values(tab, path):
    """The colour at the middle of each cell is that of its value, the first row below."""
    colours = tab.evaluate(PIXELS)
    cells = [None if np.isnan(one) else float(one) for one in cells_of(path, a1=1)]
    painted = "cells => cells.map(one => painter(view.scale)(one === null ? NaN : one))"
    assert colours == tab.evaluate(painted, cells)
    assert len({tuple(one) for one in colours}) > 20


def test_a_slider_shows_another_slice(tab, path):
    assert_array_equal(shown_cells(tab), cells_of(path, a1=1))
    tab.locator("#slide-a1").focus()
    tab.keyboard.press("ArrowLeft")
    settled(tab, "!loading && design.at.a1 === 0")
    assert_array_equal(shown_cells(tab), cells_of(path, a1=0))


def test_the_mechanism_is_that_of_the_design_under_the_cursor_and_its_extremes_are_marked(tab):
    design = middle(tab)
    place = state(tab, "design.motion.places(0.7, 1)")
    true = fl.evaluate("planar_4r", ["A_x", "A_y", "B_x", "B_y"], **design, theta1=0.7, branch=1)
    assert_allclose([*place["A"], *place["B"]], list(true.values()), rtol=1e-12)
    assert tab.evaluate(INK) > 300  # and it is drawn: ink of the assembly mode on the canvas
    marks, bends = (
        [one["value"] for one in state(tab, f"design.motion.{of}', 1, design.motion.curve('{name}', 1))")]
        for name, of in (("omega4", "extremes('omega4"), ("jerk4", "bends('jerk4"))
    )
    names = ["omega4_max", "omega4_min", "jerk4_extrema"]
    true = fl.sweep("planar_4r", fl.grid(**design, omega1=10.0), names, branch=1)
    # the place of an extreme is found to the root of a rounding, its value to its square
    assert_allclose(marks, [true.omega4_max, true.omega4_min], rtol=1e-12)
    expected = true.jerk4_extrema.values[np.isfinite(true.jerk4_extrema.values)]
    assert len(expected) >= 3
    assert_allclose(np.sort(bends), np.sort(expected), rtol=1e-9)


def test_designs_are_locked_compared_and_written(tab, path):
    x, y = point(tab, 0.3, 0.4)
    tab.mouse.dblclick(x, y)
    settled(tab, "state.locks.length === 1")
    over = tab.locator("#over")
    over.focus()
    for key in ("ArrowRight", "ArrowUp", "Enter"):
        tab.keyboard.press(key)
    settled(tab, "state.locks.length === 2 && document.querySelectorAll('#cards figure').length === 2")
    first, second = state(tab, "state.locks.map(one => one.at)")
    assert (second["a2"], second["a3"]) == (first["a2"] + 1, first["a3"] + 1)
    with tab.expect_download() as waiting:
        tab.locator("#to-csv").click()
    rows = list(csv.DictReader(waiting.value.path().read_text().splitlines()))
    with fl.open(path) as maps:
        for row, at in zip(rows, (first, second), strict=True):
            one = maps.isel(at)
            assert {name: float(row[name]) for name in ("a1", "a2", "a3", "a4", "omega1", "branch")} == {
                name: float(one[name]) for name in ("a1", "a2", "a3", "a4", "omega1", "branch")
            }
            assert row["omega4_max"] == ("" if np.isnan(one.omega4_max) else repr(float(one.omega4_max)))
    tab.locator("#cards button", has_text="Remove").first.click()
    settled(tab, "state.locks.length === 1 && document.querySelectorAll('#cards figure').length === 1")


def test_the_view_is_a_link(browser, page, tab):
    tab.locator("#choose-name").select_option("grashof_class")
    settled(tab, "view.name === 'grashof_class' && !loading")
    tab.locator("#slide-a1").focus()
    tab.keyboard.press("End")
    x, y = point(tab, 0.2, 0.8)
    tab.mouse.dblclick(x, y)
    settled(tab, "state.locks.length === 1 && !loading")
    with opened(browser, state(tab, "location.href")) as other:
        for key in ("state.name", "state.at.a1", "state.cursor", "state.locks.map(one => one.at)"):
            assert state(other, key) == state(tab, key)
        assert "crank rocker" in other.locator("#legend").inner_text()


def test_the_page_asks_nothing_of_any_other_machine_and_needs_its_token(browser, page):
    asked, host = [], page.url.partition("://")[2].partition("/")[0]
    with opened(browser, page.url) as tab:
        tab.on("request", lambda request: asked.append(request.url))
        tab.reload()
        tab.wait_for_selector("body[data-ready=yes]")
    assert {one.partition("://")[2].partition("/")[0] for one in asked} == {host}
    with contextlib.closing(browser.new_context()) as context:
        tab = context.new_page()
        assert tab.goto(page.url[:-1]).status == 403
        assert "token" in tab.inner_text("body")


def drag(tab, start, end):
    """Drag a region from one place of the picture to another."""
    point(tab, *start)
    tab.mouse.down()
    point(tab, *(0.5 * (a + b) for a, b in zip(start, end, strict=True)))
    point(tab, *end)
    tab.mouse.up()


def listed(tab):
    """Return the places of the best designs of the region."""
    return state(tab, "region.best.map(one => one.at)")


def test_a_region_shows_its_best_designs_and_can_be_seen_alone(tab, path):
    drag(tab, (0.21, 0.32), (0.78, 0.9))
    settled(tab, "region !== null && !element('region').hidden")
    window = state(tab, "windowOf(state.brush)")
    assert window == {"a2": [3, 11], "a3": [4, 11]}
    assert state(tab, "region.count") == 9 * 8
    with fl.open(path) as maps:
        inside = maps.isel(a1=1, branch=0, a2=slice(3, 12), a3=slice(4, 12))
        for order, largest in (("", False), ("1", True)):
            tab.locator("#choose-order").select_option(order)
            settled(tab, f"region.largest === {str(largest).lower()} && region.best.length === 12")
            true = inside.fastlink.top(12, "omega4_max", largest=largest).omega4_max.values
            found = [float(maps.omega4_max.isel(at)) for at in listed(tab)]
            assert_array_equal(found, true)
        rows = state(
            tab, "Object.fromEntries(region.fields.map((of, k) => [of.name, region.rows[k].length]))"
        )
        assert rows == dict.fromkeys(("a2", "a3", "omega4_max", "transmission_angle_min"), 72)
    tab.locator("#tick-whole").check()
    settled(tab, "region.count === 9 * 8 * 3 * 2")
    with fl.open(path) as maps:
        inside = maps.isel(a2=slice(3, 12), a3=slice(4, 12))
        true = inside.fastlink.top(12, "omega4_max", largest=True).omega4_max.values
        assert_array_equal([float(maps.omega4_max.isel(at)) for at in listed(tab)], true)
    assert state(tab, "region.fields.map(of => of.name)")[:4] == ["a2", "a3", "a1", "branch"]
    tab.locator("#zoom").click()
    settled(tab, "view.values.length === 72 && !loading && region === null")
    tab.locator("#controls button", has_text="Whole picture").click()
    settled(tab, "view.values.length === 195 && !loading")


def test_a_region_by_the_keyboard(tab):
    over = tab.locator("#over")
    over.focus()
    for key in ("ArrowLeft", "b", "Shift+ArrowRight", "ArrowUp", "b"):
        tab.keyboard.press(key)
    settled(tab, "region !== null")
    assert state(tab, "windowOf(state.brush)") == {"a2": [6, 14], "a3": [6, 7]}
    settled(
        tab, "element('said').textContent.includes('a_2')"
    )  # where the last arrow led is said a moment later
    tab.keyboard.press("Escape")
    settled(tab, "region === null && element('region').hidden")


@pytest.mark.parametrize("count", [1, 2])
def test_chosen_designs_are_a_study_that_gives_the_same_values(tab, path, tmp_path, count):
    places = [{"a1": 1, "a2": 9, "a3": 6, "branch": 0}, {"a1": 0, "a2": 4, "a3": 8, "branch": 0}][:count]
    tab.evaluate("async places => { for (const at of places) await lock(at); }", places)
    for name, text in state(tab, "studyOf(state.locks)").items():
        (tmp_path / name).write_text(text)
    with fl.run(tmp_path / "study.toml", to=tmp_path / "again.h5", verify=0) as again, fl.open(path) as maps:
        for k, at in enumerate(places):
            one = again.isel(branch=0, **({"design": k} if count > 1 else {}))
            for name in maps.data_vars:
                assert float(one[name]) == float(
                    maps[name].isel({d: p for d, p in at.items() if d in maps[name].dims})
                )


@pytest.fixture(scope="module")
def written(path, tmp_path_factory):
    """The page of the map as a file."""
    file = tmp_path_factory.mktemp("pages") / "page.html"
    fl.explore(path, to=file, browser=False).close()
    return file


def test_a_page_without_a_server_shows_the_same(browser, tab, written):
    script = """async () => {
        const found = {};
        for (const [a1, name] of [[0, "omega4_max"], [2, "omega4_max"], [1, "grashof_class"]]) {
            change({name, at: {...state.at, a1}});
            while (loading) await new Promise(done => setTimeout(done, 5));
            found[`${name} ${a1}`] = [Array.from(view.values, String), view.scale];
        }
        Object.assign(state, {name: "omega4_max", brush: [0.1, 0.9, 0.2, 0.7]});
        change({});
        while (loading) await new Promise(done => setTimeout(done, 5));
        await drawRegion();
        const short = one => typeof one === "number" ? String(Math.fround(one)) : one;
        const named = row => Object.entries(row).map(([name, value]) => `${name} ${short(value)}`).sort();
        found.best = region.best.map(one => [one.at, named(one.row)]);
        found.rows = region.rows.map(row => row.map(short));
        found.places = design.motion.places(0.3, 1);
        return found;
    }"""
    with opened(browser, written.as_uri(), offline=True) as alone:
        assert alone.evaluate(script) == tab.evaluate(script)
        assert "http" not in alone.evaluate(
            "performance.getEntriesByType('resource').map(one => one.name).join()"
        )


@pytest.mark.stress
def test_a_map_of_sampled_designs_is_points(browser, tmp_path):
    maps, file = maps_of("points", None), tmp_path / "page.html"
    maps.fastlink.explore(to=file, browser=False)
    with opened(browser, file.as_uri()) as tab:
        assert state(tab, "view.values.length") == 64
        place = state(tab, "placeOf({design: 17})")
        box = tab.locator("#over").bounding_box()
        tab.mouse.move(box["x"] + place[0], box["y"] + place[1])
        settled(tab, "design.at.design === 17")
        inputs = {name: state(tab, "design.motion.inputs")[name] for name in ("a1", "a2", "a3")}
        assert inputs == {name: float(maps[name][17]) for name in inputs}
        drag(tab, (0.0, 0.0), (1.0, 1.0))
        settled(tab, "region !== null && region.count === 64 && region.best.length === 12")
        least = np.argsort(maps.omega4_max.values.ravel())[:12]
        assert [one["design"] for one in listed(tab)] == least.tolist()


@pytest.mark.stress
def test_a_cell_of_many_designs_shows_their_mean_once_a_slider_rests(browser, show, tmp_path):
    space = fl.grid(a1=np.linspace(0.2, 1.9, 1500), a2=[0.8, 1.1], a3=[0.7, 0.9], a4=1.0)
    maps = sweep_4r(space, ["least_transmission_angle"])
    values, file = maps.least_transmission_angle.values[:, :, 0], tmp_path / "page.html"
    count = -(-1500 // 720)
    cells = values.reshape(1500 // count, count, 2)
    with fl.explore(maps, browser=False) as page:
        tab = show(page.url)
        settled(tab, "view.pooled === 'mean'")
        assert f"of {count} × 1 designs" in tab.locator("#legend").inner_text()
        for pool, merge in (("mean", np.nanmean), ("least", np.nanmin), ("greatest", np.nanmax)):
            tab.locator("#choose-pool").select_option(pool)
            settled(tab, f"!loading && view.pooled === '{pool}'")
            found = shown_cells(tab).reshape(2, -1).T
            with warnings.catch_warnings(action="ignore", category=RuntimeWarning):
                assert_allclose(found, merge(cells, axis=1), rtol=2.0**-22)
        tab.locator("#choose-pool").select_option("one")
        settled(tab, "!loading && view.pooled === 'one'")
        fl.explore(maps, to=file, browser=False).close()
        with opened(browser, file.as_uri(), offline=True) as alone:
            settled(alone, "view.pooled === 'mean'")
            assert alone.evaluate(GREATEST) == tab.evaluate(GREATEST)


@pytest.mark.stress
def test_a_map_of_one_axis_is_a_line(show):
    with fl.explore(maps_of("line", None), browser=False) as page:
        tab = show(page.url)
        assert (state(tab, "state.x"), state(tab, "state.y")) == ("theta1", "")
        point(tab, 0.5, 0.5)
        settled(tab, "design.at.theta1 === 18")
        assert values(tab)["theta1"] == "180°"


@pytest.fixture(scope="module")
def coupler():
    """A map with a coupler point and links that have a mass, of one assembly mode."""
    lengths = {
        "a1": [0.3, 0.4, 0.5],
        "a2": np.linspace(0.8, 1.4, 13),
        "a3": np.linspace(0.4, 1.2, 9),
        "a4": 1.0,
    }
    space = fl.grid(lengths, omega1=10.0, P_u=0.5, P_v=0.3)
    names = ["omega4_max", "omega4_peak", "omega4_rms"]
    names += ["shaking_force_max", "transmission_angle_min", "P_y_min"]
    return fl.sweep("planar_4r", space, [*names, "grashof_class", "status", "swing"], links=BARS)


@pytest.fixture(scope="module")
def coupler_page(coupler):
    with fl.explore(coupler, browser=False) as page:
        yield page


def clashes(texts):
    """Return the pairs of texts whose boxes overlap by more than a pixel."""
    boxes = np.array([one[1:] for one in texts])
    low, high = boxes[:, [0, 2]] + 0.5, boxes[:, [1, 3]] - 0.5
    both = (low[:, None] < high[None]).all(axis=2) & (low[None] < high[:, None]).all(axis=2)
    return [(texts[i], texts[j]) for i, j in zip(*np.nonzero(np.triu(both, 1)), strict=True)]


def maps_of(kind, coupler):
    """Return a map whose picture has cells, points or a line."""
    if kind == "cells":
        return coupler
    if kind == "points":
        space = fl.sobol(64, seed=1, a1=(0.2, 0.5), a2=(0.9, 1.4), a3=(0.6, 1.2), a4=1.0, omega1=10.0)
        return fl.sweep("planar_4r", space, ["omega4_max", "swing"], branch=1)
    space = fl.grid(a1=0.4, a2=1.1, a3=0.8, a4=1.0, omega1=10.0)
    return sweep_4r(space, ["omega4"], theta1=36)


@pytest.mark.sample(1)
@pytest.mark.parametrize("width", [390, 900, 1400])
@pytest.mark.parametrize("kind", ["points", "cells", "line"])
def test_no_text_lies_on_another_and_nothing_is_beyond_the_side(browser, coupler, kind, width):
    with fl.explore(maps_of(kind, coupler), browser=False) as page:
        view = {"width": width, "height": 844 if width == 390 else 900}
        with new_tab(browser, viewport=view) as show:
            tab = show(page.url)
            tab.context.add_init_script(HOOK)
            show(page.url)
            tab.evaluate("""async () => {
                const at = {...state.at}, dim = content.dims[0].name;
                await lock(at);
                await lock({...at, [dim]: at[dim] + 1});
                state.brush = [0.3, 0.9, 0.2, 0.9];
                await drawRegion();
                drawOver();
            }""")
            for act in ("0", "depart({a1: 0.4123})"):
                tab.evaluate(act)
                settled(tab, "!loading && !designing")
                assert state(tab, "document.documentElement.scrollWidth") == width
                texts = state(tab, TEXTS)
                assert len(texts) > 60
                assert not clashes(texts)
            sliders = [one.bounding_box()["width"] for one in tab.locator("#sliders input").all()]
            assert all(one > 0.3 * min(width, 700) for one in sliders)


def joint(tab, name):
    """Return where a joint is drawn, in the window."""
    canvas = tab.locator("#linkage")
    canvas.scroll_into_view_if_needed()
    x, y = tab.evaluate(
        """name => {
            const canvas = element("linkage"), {motion, scene} = design;
            const [on] = framing(scene.view, canvas.clientWidth, canvas.clientHeight);
            const point = mechanism.points.find(one => one.name === name);
            return on(motion.place(motion.at(positionNow(), motion.branches[0]), point));
        }""",
        name,
    )
    box = canvas.bounding_box()
    return box["x"] + x, box["y"] + y


def computed(tab, names):
    """Return the inputs, the position and the quantities there of the design that is shown, and its row."""
    settled(tab, "!loading && !designing")
    told = """names => {
        const at = design.motion.at(positionNow(), design.motion.branches[0]), {inputs} = design.motion;
        return [inputs, positionNow(), Object.fromEntries(names.map(one => [one, valueOf(at, one)])), design.row];
    }"""
    return tab.evaluate(told, names)


def agree(tab, coupler):
    """Check the numbers of the page against those of fastlink at the same design."""
    names = ["B_x", "B_y", "P_x", "P_y", "omega4", "alpha4", "transmission_angle"]
    inputs, position, values, row = computed(tab, names)
    density, radius = inputs.pop("density"), inputs.pop("radius")
    true = fl.evaluate("planar_4r", names, **inputs, theta1=position, branch=1)
    assert_allclose([values[one] for one in names], [true[one] for one in names], rtol=1e-9, atol=1e-9)
    links = fl.round_bar(density=density, radius=radius)
    wanted = fl.sweep("planar_4r", fl.grid(**inputs), list(row), links=links, branch=1)
    assert set(row) == set(coupler.data_vars)
    assert_allclose(list(row.values()), [float(wanted[one]) for one in row], rtol=1e-9)
    return inputs


def test_an_input_is_typed_off_the_grid_and_back(browser, coupler, show, coupler_page):
    tab = show(coupler_page.url)
    typed = {"a2": 1.2345, "omega1": 12.5, "P_v": -0.2}
    for name, value in typed.items():
        tab.locator(f"#type-{name}").fill(str(value))
        settled(tab, f"design.motion.inputs.{name} === {value}")
    inputs = agree(tab, coupler)
    assert inputs == {"a1": 0.4, "a3": inputs["a3"], "a4": 1.0, "P_u": 0.5} | typed
    assert "Off the grid" in tab.locator("#off").inner_text()
    assert "sampled" in values(tab)["omega4_max"]
    for text in ("0", "-1", ""):  # a length has to be positive
        tab.locator("#type-a2").fill(text)
        assert tab.locator("#type-a2").get_attribute("aria-invalid") == "true"
    assert computed(tab, [])[0]["a2"] == 1.2345
    tab.locator("#keep").click()
    settled(tab, "state.locks.length === 1")
    place = state(tab, "placeOf(state.cursor)")
    box = state(tab, "view.box")
    step = (1.4 - 0.8) / 12
    assert place[0] == pytest.approx(box["left"] + (1.2345 - 0.8 + step / 2) / (13 * step) * box["width"])
    with opened(browser, state(tab, "location.href")) as other:
        for key in ("state.cursor", "design.row", "state.locks.map(one => [one.at, one.row])"):
            assert state(other, key) == state(tab, key)
    # typed faster than the rows come, of which the first comes last: each input counts, the newest design is shown
    tab.evaluate(
        "(() => { const row = source.row; let wait = 500; source.row = async place =>"
        " { await new Promise(done => setTimeout(done, wait = Math.max(0, wait - 200))); return row(place); }; })()"
    )
    for name, value in {"a2": 0.9, "omega1": 10, "P_v": 0.3}.items():
        tab.locator(f"#type-{name}").fill(str(value))
    settled(tab, "!loading && !designing && !state.cursor.free")
    own = coupler.omega4_max.isel(a1=1, a2=2, a3=4)
    assert float(own.a2) == pytest.approx(0.9)
    assert state(tab, "design.row.omega4_max") == float(own)


def test_forces_are_shown_as_arrows_where_masses_are_known(browser, coupler_page, show):
    tab = show(coupler_page.url)
    symbols = [one["symbol"] for one in state(tab, "mechanism.loads")]
    assert symbols == ["F_41", "F_21", "F_32", "F_43", "T_41"]
    before = state(tab, "element('linkage').toDataURL()")
    tab.locator("#tick-forces").click()
    settled(tab, "!loading && design.motion.greatest")
    assert state(tab, "element('linkage').toDataURL()") != before
    most, inputs = state(tab, "[design.motion.greatest, design.motion.inputs]")
    links = fl.round_bar(density=inputs.pop("density"), radius=inputs.pop("radius"))
    names = [f"F{one}_max" for one in (41, 21, 32, 43)]
    turn = state(tab, "design.motion.ranges.flatMap(range => design.motion.along(61, range))")
    given = {"links": links, "branch": 1, "angles": turn, "extrema": "sampled"}
    wanted = fl.sweep("planar_4r", fl.grid(**inputs), [*names, "T41_max", "T41_min"], **given)
    assert most["N"] == pytest.approx(max(float(wanted[one]) for one in names), rel=1e-9)
    assert most["N m"] == pytest.approx(
        max(abs(float(wanted[f"T41_{one}"])) for one in ("max", "min")), rel=1e-9
    )
    with opened(browser, state(tab, "location.href")) as other:
        assert other.locator("#tick-forces").is_checked()


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("name", "changed"), [("A", {"a1"}), ("B", {"a2", "a3"}), ("D", {"a4"}), ("P", {"P_u", "P_v"})]
)
def test_a_joint_is_dragged(coupler, show, coupler_page, name, changed):
    tab = show(coupler_page.url)
    before = computed(tab, [])[0]
    x, y = joint(tab, name)
    tab.mouse.move(x, y)
    tab.mouse.down()
    for k in (1, 2, 3):
        tab.mouse.move(x + 4 * k, y - 3 * k)
    settled(tab, "!designing && state.cursor.free !== undefined")
    assert_allclose(joint(tab, name), [x + 12, y - 9 if name != "D" else y], atol=1.0)
    tab.mouse.up()
    after = agree(tab, coupler)
    assert {one for one in after if after[one] != before[one]} == changed


def test_a_linkage_that_is_dragged_apart_stops_there(show, coupler_page):
    tab = show(coupler_page.url)
    x, y = joint(tab, "A")
    tab.mouse.move(x, y)
    tab.mouse.down()
    for k in range(1, 9):
        tab.mouse.move(x - 40 * k, y)
    settled(tab, "!designing && state.cursor.free !== undefined")
    tab.mouse.up()
    assert state(tab, "design.motion.assembles(positionNow())")


@pytest.mark.stress
def test_a_map_over_positions_is_evaluated_at_the_position_that_is_chosen(show):
    design = {"a2": 1.1, "a3": 0.8, "a4": 1.0, "omega1": 10.0}
    maps = sweep_4r(fl.grid(design, a1=[0.3, 0.4]), ["omega4"], theta1_deg=[10, 50])
    with fl.explore(maps, browser=False) as page:
        tab = show(page.url)
        tab.locator("#type-a1").fill("0.35")
        settled(tab, "!loading && !designing && state.cursor?.free?.a1 === 0.35")
        true = fl.evaluate("planar_4r", ["omega4"], **design, a1=0.35, theta1_deg=10)
        assert state(tab, "state.cursor.theta1") == 0
        assert state(tab, "design.row.omega4") == pytest.approx(float(true["omega4"]), rel=1e-9)

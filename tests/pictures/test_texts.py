"""Every kind of picture at three sizes: no text covers another, none stands outside the frame."""

import importlib.util
import itertools
import re
import shlex
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from tests.support.commands import code_blocks, run_command
from tests.support.sweeps import BARS, sweep_4r, sweep_both

import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue
from fastlink.pictures.draw import picture_of
from fastlink.pictures.style import NotebookFigure

FOUR_BAR = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0, "P_u": 0.5, "P_v": 0.35}
DESIGNS = {
    "planar_4r": FOUR_BAR | {"omega1": 10.0},
    "minkowski_4r": {"a": 1.0, "b": 1.0, "g": 4.0, "h": 1.0, "x": 0.5, "y": 0.3},
    "focal": {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "s": 2.0},
    "hart": {"m": 4.0, "n": 8.0, "d": 5.0, "kappa": 0.5},
    "slider_crank": {"r": 0.1, "l": 0.3, "e": 0.02, "omega": 50.0, "m3": 0.5},
}
LOADS = {"planar_4r", "slider_crank"}
QUANTITIES = ["shaking_force_max", "transmission_angle_min", "omega4_max"]
QUANTITIES += ["status", "grashof_class", "theta1_at_omega4_max"]
FORCE, ANGLE = QUANTITIES[:2]


@cache
def maps():
    """The starter study, of fewer designs."""
    axes = {"a2": np.linspace(1.0, 1.4, 31), "a3": np.linspace(0.6, 1.0, 31), "a4": [0.8, 0.9, 1.0, 1.1, 1.2]}
    return sweep_4r(fl.grid(axes, a1=0.4, omega1=25.0), QUANTITIES, links=BARS)


@cache
def types():
    lengths = np.linspace(0.125, 4.0, 32)
    space = fl.grid(a=lengths, b=lengths, g=1.0, h=[0.1, 0.8, 1.6, 2.4, 3.2, 4.0])
    return sweep_both("minkowski_4r", space, ["linkage_type", "assembly_count_future"])


def plot(*given, of=maps, **options):
    return lambda: fl.plot(of(), *given, **options)


def drawn(mechanism, **options):
    options = ({"links": BARS} if mechanism in LOADS else {}) | options
    return lambda: fl.draw(mechanism, DESIGNS[mechanism], **options)


AT = {"a4": 1.0}
KINDS = {
    "map": plot(FORCE, at=AT),
    "map of two modes": plot("theta1_at_omega4_max", at=AT, degrees=True),
    "codes": plot("status", at=AT),
    "panels": plot(FORCE, panels="a4", branch=1),
    "one row of panels": lambda: fl.plot(maps().isel(a4=[1, 2, 3]), FORCE, panels="a4", branch=1),
    "panels of two modes": plot("theta1_at_omega4_max", panels="a4"),
    "panels of types": plot("linkage_type", of=types, panels="h"),
    "panels of counts": plot("assembly_count_future", of=types, panels="h"),
    "two panels of codes": lambda: fl.plot(maps().isel(a4=[1, 2]), "grashof_class", panels="a4"),
    "line": plot(FORCE, at=AT | {"a3": 0.8}, branch=1),
    "lines": plot(FORCE, lines="a4", at={"a3": 0.8}, branch=1),
    "lines of two modes": plot("theta1_at_omega4_max", lines="a4", at={"a3": 0.8}),
    "scatter": plot([FORCE, ANGLE]),
    "scatter of three": plot([FORCE, ANGLE, "omega4_max"], degrees=True),
    "scatter of a code": plot([FORCE, ANGLE, "grashof_class"]),
    "corner": plot([FORCE, ANGLE, "a2", "a3"], where={"status": "rotates_fully", ANGLE: (0.2, None)}),
    "corner of two": plot([FORCE, ANGLE], kind="corner"),
    "corner of six": plot([FORCE, ANGLE, "omega4_max", "a2", "a3", "a4"]),
    "cumulative": plot(FORCE, kind="cumulative"),
    "cumulative of two": plot([FORCE, ANGLE], kind="cumulative"),
    "front": plot(minimise=FORCE, maximise=ANGLE, degrees=True, where="rotates_fully"),
    "front of three": plot(minimise=[FORCE, "omega4_max"], maximise=ANGLE),
}
for name in DESIGNS:
    KINDS |= {
        name: drawn(name),
        f"{name}, one mode": drawn(name, branch=2),
        f"{name}, all": drawn(name, show="all"),
        f"{name}, all of two modes": drawn(name, show="all", branch=[1, 2]),
        f"{name}, strip of 3": drawn(name, strip=3),
        f"{name}, strip of 8": drawn(name, strip=8, branch=1),
    }
KINDS |= {
    "forces": drawn("planar_4r", show="forces torques"),
    "forces of a slider": drawn("slider_crank", show="forces torques", branch=[1, 2]),
    "curves": drawn(
        "planar_4r", branch=1, show="path comb", curves=["curvature", "transmission_angle", "omega4"]
    ),
    "by another joint": lambda: fl.draw("planar_4r", FOUR_BAR, input="joint_angle_3"),
}


@pytest.mark.sample(6)
@pytest.mark.parametrize("size", [0, 1, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_no_text_covers_another_and_none_is_outside(kind, size):
    """A chart lays itself out anew, a drawing to scale has the inches that its letters need."""
    figure = KINDS[kind]()
    size = [0.85 if figure.get_layout_engine() else 1.25, 1.0, 1.5][size]
    figure.set_size_inches(size * figure.get_size_inches())
    assert flaws_of(figure) == ([], [])


@pytest.mark.sample(2)
@pytest.mark.parametrize("frame", [0, 3, 7, 11])
@pytest.mark.parametrize("mechanism", ["planar_4r", "slider_crank"])
def test_no_text_of_a_film_covers_another(mechanism, frame, tmp_path, monkeypatch):
    """The figure of a film stands at its last picture."""
    figure = drawn(mechanism, show="forces torques", animate=tmp_path / "a.gif", frames=2 + frame)()
    assert flaws_of(figure) == ([], [])


def test_texts_that_overlap_are_found():
    figure = NotebookFigure(layout=None)
    figure.text(0.5, 0.5, "one text")
    figure.text(0.5, 0.51, "another")
    figure.text(0.99, 0.1, "beyond the frame")
    assert flaws_of(figure) == ([("one text", "another")], ["beyond the frame"])


# == docs/gallery.md, docs/drawing.md: each picture is there, small, and made by a command that runs =========

DOCS = Path(__file__).parents[2] / "docs"
SPEC = importlib.util.spec_from_file_location("pages", DOCS / "images" / "pages.py")
pages = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(pages)
GALLERY, DRAWING = ((DOCS / name).read_text(encoding="utf-8") for name in ("gallery.md", "drawing.md"))
BLOCKS = [block for block in pages.blocks_of(GALLERY) if block[0][1] == "run"]
SHOWN = pages.shown_on(GALLERY)
LINES = "".join(code_blocks(DRAWING, "sh")).splitlines()
FEW = 5


def few(text):
    """Return a study of few designs."""
    counts = r"(space = \[[^,\]]*,[^,\]]*,\s*)(\d+)"
    text = re.sub(counts, lambda found: found[1] + str(min(FEW, int(found[2]))), text)
    text = re.sub(r"^\[output\]$", "[output]\nverify = 0", text, flags=re.MULTILINE)
    return re.sub(r"^n = \d+$", "n = 16", text, flags=re.MULTILINE)


def test_each_picture_is_there_and_small_and_has_one_command():
    commands = [arguments for block in pages.blocks_of(GALLERY) for arguments in block]
    made = [pages.output_of(arguments) for arguments in commands if arguments[1] != "run"]
    assert sorted(made) == sorted(SHOWN)
    assert {path.name for path in (DOCS / "images" / "gallery").iterdir()} == set(SHOWN)
    sizes = [(DOCS / place).stat().st_size for place in SHOWN.values()]
    assert min(sizes) > 1000
    assert sum(sizes) < 3_000_000
    drawn = re.findall(r"images/(\w+\.png)", DRAWING)
    assert all((DOCS / "images" / name).stat().st_size < 60_000 for name in drawn)
    assert set() < set(drawn) <= {name for line in LINES for name in shlex.split(line)}


def test_each_entry_says_what_to_see_and_every_figure_of_the_papers_has_one():
    for entry in re.split(r"^### ", GALLERY, flags=re.MULTILINE)[1:]:
        words, _, picture = entry.partition("\n")[2].partition("```sh")
        assert words.strip().endswith("."), entry
        assert "](images/" in picture, entry
    for paper, first, last in (("Hayes", 1, 4), ("Heged", 9, 24), ("Wunderlich", 1, 7)):
        part = re.search(rf"^## {paper}.*?(?=^## )", GALLERY, flags=re.MULTILINE | re.DOTALL)[0]
        named = set()
        for low, high in re.findall(r"^### Figs?\. (\d+)(?: (?:to|and) (\d+))?", part, flags=re.MULTILINE):
            named |= set(range(int(low), int(high or low) + 1))
        assert named == set(range(first, last + 1)), paper


@pytest.mark.parametrize("mechanism", NAMES)
def test_the_page_names_every_word(mechanism):
    table = "".join(line for line in DRAWING.splitlines() if line.startswith("|"))
    assert all(f"`{word}`" in table for word in picture_of(mechanism, catalogue(mechanism)).words)


@pytest.mark.sample(2)
@pytest.mark.parametrize("line", [line for line in LINES if ">" not in line])
def test_the_commands_of_the_page(line, folder):
    for study in (line for line in LINES if ">" in line):
        run_command(study)
    arguments, done = run_command(line)
    (place,) = [arguments[arguments.index(key) + 1] for key in ("--to", "--animate") if key in arguments]
    assert done.output.strip() == place
    assert Path(place).stat().st_size > 1000


@pytest.mark.parametrize(
    "block", [BLOCKS[0], *(pytest.param(one, marks=pytest.mark.stress) for one in BLOCKS[1:])]
)
def test_the_maps_of_the_gallery_in_short(block, folder):
    """Each study runs, of few designs, and the last picture of its map is drawn; what is refused stops the pages."""
    (folder / "data" / "studies").mkdir(parents=True)
    for path in (DOCS.parent / "data" / "studies").iterdir():
        (folder / "data" / "studies" / path.name).write_text(
            few(path.read_text(encoding="utf-8")), encoding="utf-8"
        )
    run, *_, last = block
    for arguments in (run, last):
        pages.run(arguments)
    assert (folder / pages.output_of(last)).stat().st_size > 1000
    with pytest.raises(RuntimeError, match="no_such"):
        pages.run(["fastlink", "draw", "no_such_mechanism", "--to", "a.png"])


@pytest.mark.stress
def test_the_pictures_of_the_gallery(folder):
    (folder / "data").symlink_to(DOCS.parent / "data")
    made = {picture.name for _, picture in pages.make(GALLERY) if picture.stat().st_size > 1000}
    assert made == set(SHOWN)


# == Texts of a picture, as a renderer places them: which cover each other, which stand outside the frame ====

#: Of letters in points: the margin that a renderer puts around them; how far one may stand beyond the frame in pixels.
MARGIN, BEYOND = 0.8, 1.0


def texts_of(figure):
    """Return the texts that are drawn: tick labels outside a range are there, and are not."""
    found = [*figure.texts, *(text for legend in figure.legends for text in legend.get_texts())]
    for axes in filter(lambda axes: axes.get_visible(), figure.axes):
        found += [*axes.texts, axes.title, *(axes.get_legend().get_texts() if axes.get_legend() else ())]
        for axis in (axes.xaxis, axes.yaxis) if axes.axison else ():
            found += [axis.label, axis.offsetText]
            found += [label for tick in axis._update_ticks() for label in (tick.label1, tick.label2)]
    return [text for text in found if text.get_visible() and text.get_text().strip()]


def corners_of(text, renderer):
    """Return the corners of the box around a text, along its letters."""
    box, turn = text.get_window_extent(renderer), text.get_rotation()
    text.set_rotation(0.0)
    wide, high = text.get_window_extent(renderer).size
    text.set_rotation(turn)
    margin = MARGIN * text.figure.get_figure(root=True).dpi / 72.0
    half = 0.5 * np.maximum([wide - margin, high - 2.0 * margin], 1.0)
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    around = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]) * half
    return 0.5 * (box.p0 + box.p1) + around @ np.array([[c, s], [-s, c]])


def overlap(one, other):
    """Tell whether two boxes overlap: no side of either has all of one on this and all of the other on that side."""
    for across in (*np.diff(one[:3], axis=0), *np.diff(other[:3], axis=0)):
        first, second = one @ across, other @ across
        if first.max() <= second.min() or second.max() <= first.min():
            return False
    return True


def flaws_of(figure):
    """Return the pairs of texts that overlap, and the texts that are not inside the picture."""
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    boxes = [(text.get_text(), corners_of(text, renderer)) for text in texts_of(figure)]
    size = figure.bbox.size + BEYOND
    outside = [words for words, box in boxes if (box < -BEYOND).any() or (box > size).any()]
    pairs = [
        (one, other)
        for (one, box), (other, further) in itertools.combinations(boxes, 2)
        if overlap(box, further)
    ]
    return pairs, outside

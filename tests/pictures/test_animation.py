"""Moving pictures: as many as asked for, of each kind a valid file."""

import base64
import io
import json
import re
import stat
import sys

import numpy as np
import pytest
from PIL import Image
from tests.pictures.test_draw import FOUR_BAR, ROCKER
from tests.support.refusals import refused

import fastlink as fl

FRAMES = 3


def test_a_gif_has_the_pictures_asked_for_and_ends_where_it_began(tmp_path):
    place = tmp_path / "turn.gif"
    fl.draw("planar_4r", FOUR_BAR, branch=1, animate=place, frames=FRAMES)
    with Image.open(place) as film:
        assert film.n_frames == FRAMES
        assert film.info["loop"] == 0
        pictures = []
        for k in range(FRAMES):
            film.seek(k)
            pictures.append(np.array(film.convert("L")))
    assert pictures[0][0, 0] == 255
    changes = [
        (one != other).mean() for one, other in zip(pictures, pictures[1:] + pictures[:1], strict=True)
    ]
    assert all(0.001 < change < 0.2 for change in changes)  # the linkage, and it alone


def test_a_page_needs_nothing_else(tmp_path):
    place = tmp_path / "swing.html"
    fl.draw("planar_4r", ROCKER, branch=1, theta1_deg=60, animate=place, frames=FRAMES)
    text = place.read_text()
    assert not re.search(r"(src|href)\s*=\s*[\"']?(https?:)?//", text)
    frames, labels = (
        json.loads(re.search(rf"{key} = (\[.*?\])[,;]", text)[1]) for key in ("frames", "labels")
    )
    assert len(frames) == len(labels) == FRAMES
    with Image.open(io.BytesIO(base64.b64decode(frames[0]))) as first:
        assert first.format == "PNG"
    angles = [float(label.removesuffix("°")) for label in labels]
    assert all(24.147 <= angle <= 145.168 for angle in angles)  # the range in which 60 degrees is


def test_a_film_is_handed_to_ffmpeg(tmp_path, monkeypatch):
    """With a program in its place that counts the pixels that it receives."""
    program = tmp_path / "ffmpeg"
    program.write_text(
        f"#!{sys.executable}\nimport sys\n"
        "given = sys.argv[1:]\n"
        "width, height = map(int, given[given.index('-s') + 1].split('x'))\n"
        "pictures, rest = divmod(len(sys.stdin.buffer.read()), 3 * width * height)\n"
        "open(given[-1], 'w').write(f'{pictures} {rest}')\n"
    )
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(tmp_path))
    fl.draw("hart", m=4.0, n=8.0, d=5.0, kappa=0.5, animate=tmp_path / "line.mp4", frames=FRAMES)
    assert (tmp_path / "line.mp4").read_text() == f"{FRAMES} 0"
    program.write_text(
        f"#!{sys.executable}\nimport sys\nsys.stdin.buffer.read()\nsys.exit('no such codec')\n"
    )
    with refused("animate", "a .gif"), pytest.MonkeyPatch.context():
        fl.draw("hart", m=4.0, n=8.0, d=5.0, kappa=0.5, animate=tmp_path / "line.mp4", frames=2)


def test_a_film_without_ffmpeg_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with refused("animate", "apt install ffmpeg"):
        fl.draw("planar_4r", FOUR_BAR, animate=tmp_path / "turn.mp4")


@pytest.mark.parametrize(
    ("given", "key", "remedy"),
    [
        ({"animate": "turn.avi"}, "animate", "gif, html, mp4"),
        ({"animate": "turn.gif", "frames": 1}, "frames", "2 to 720"),
        ({"animate": "turn.gif", "strip": 3}, "animate", "leave strip"),
        ({"animate": "turn.gif", "theta1": [1.0, 2.0]}, "animate", "leave strip"),
    ],
)
def test_films_that_mean_nothing_are_refused(given, key, remedy, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with refused(key, remedy):
        fl.draw("planar_4r", FOUR_BAR, **given)

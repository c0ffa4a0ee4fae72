"""Write a linkage that moves: as GIF, as film, or as a page with a slider."""

from __future__ import annotations

import base64
import html
import io
import json
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

from fastlink._text import filled
from fastlink.errors import InputError
from fastlink.io.output import write_whole

if TYPE_CHECKING:
    from fastlink.pictures.board import Board

__all__ = ["check_film", "write_film"]


DPI, COLOURS = 90, 48
SECONDS = 6.0  # of a cycle
#: Away from the ends of the motion, so that no two pictures in a row are the same.
PHASE = 0.25
INSTALL = "install it, such as by `apt install ffmpeg`, or write a .gif or an .html"


def check_film(path: Path) -> None:
    """Refuse a film where there is no program that writes it."""
    if path.suffix.lower() == ".mp4" and shutil.which("ffmpeg") is None:
        what = "ffmpeg, which writes films, is not installed"
        raise InputError(what, where=("animate",), remedy=INSTALL)


def write_film(board: Board, path: Path, frames: int) -> None:
    """Write the motion of a picture of one position: a turn, or there and back through the range."""
    motion = board.motion
    low, high = motion.around(board.request.positions)[0]
    share = (np.arange(frames) + PHASE) / frames
    if motion.turns_fully:
        positions = low + (high - low) * share
    else:
        positions = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(2.0 * np.pi * share)
    pictures = _pictures(board, positions)
    written = {".gif": _gif, ".mp4": _film, ".html": _page}[path.suffix.lower()]
    labels = [motion.shown(one, board.request.degrees) for one in positions]
    write_whole(path, written(pictures, f"{motion.mechanism}: {motion.input}", labels), "animate")


def _pictures(board: Board, positions: Any) -> list[Any]:
    """Return a picture for each position: what stands still is drawn once."""
    figure = board.figure
    figure.set_dpi(DPI)
    for one in board.moving:
        one.remove()
    board.moving = []
    canvas: Any = figure.canvas
    canvas.draw()
    still = canvas.copy_from_bbox(figure.bbox)
    found = []
    for position in positions:
        board.show([position] * len(board.sheets))
        canvas.restore_region(still)
        for one in sorted(board.moving, key=lambda artist: artist.get_zorder()):
            figure.draw_artist(one)
        found.append(Image.fromarray(np.array(canvas.buffer_rgba())[..., :3]))
    return found


def _small(pictures: list[Any]) -> list[Any]:
    """Return pictures of the same few colours, each the nearest: Pillow's own are near ones, and white turns grey."""
    few = pictures[0].quantize(COLOURS)
    palette = np.reshape(few.getpalette(), (-1, 3))
    palette[few.getpixel((0, 0))] = 255
    found = []
    for picture in pictures:
        pixels = np.asarray(picture, dtype=np.int64)
        packed: Any = pixels @ np.array([1 << 16, 1 << 8, 1])
        colours, places = np.unique(packed, return_inverse=True)
        parts = np.stack([colours >> 16, (colours >> 8) & 255, colours & 255], axis=-1)
        nearest = ((parts[:, None] - palette[None]) ** 2).sum(axis=-1).argmin(axis=1)
        small = Image.fromarray(nearest[places].reshape(pixels.shape[:2]).astype(np.uint8))
        small.putpalette(palette.ravel().tolist())
        found.append(small)
    return found


def _gif(pictures: list[Any], title: str, labels: Sequence[str]) -> bytes:
    first, *others = _small(pictures)
    step = max(20, round(1000.0 * SECONDS / len(pictures)))
    film = io.BytesIO()
    first.save(film, format="GIF", save_all=True, append_images=others, duration=step, loop=0, disposal=1)
    return film.getvalue()


def _film(pictures: list[Any], title: str, labels: Sequence[str]) -> bytes:
    width, height = pictures[0].size
    rate = f"{len(pictures) / SECONDS:.6f}"
    # coding takes sides of an even number of pixels
    given = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", rate, "-i", "-"]
    wanted = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p", "-f", "mp4"]
    pixels = b"".join(picture.tobytes() for picture in pictures)
    with (
        tempfile.TemporaryDirectory() as folder
    ):  # a file: ffmpeg goes back in it to note where the pictures are
        film = Path(folder, "film.mp4")
        command = ["ffmpeg", "-y", "-loglevel", "error", *given, *wanted, str(film)]
        done = subprocess.run(command, input=pixels, capture_output=True, check=False)
        if done.returncode:
            lines = done.stderr.decode(errors="replace").strip().splitlines()
            what = f"ffmpeg failed ({lines[-1] if lines else f'exit status {done.returncode}'})"
            raise InputError(what, where=("animate",), remedy="write a .gif or an .html")
        return film.read_bytes()


PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>TITLE</title>
<style>
body {font: 15px sans-serif; margin: 1em auto; max-width: WIDTHpx; text-align: center}
img {max-width: 100%} input {width: 60%; vertical-align: middle} output {display: inline-block; min-width: 8em}
</style></head><body>
<img id="picture" alt="TITLE"><br>
<button id="play" aria-label="play or pause">&#10074;&#10074;</button>
<input id="place" type="range" min="0" max="LAST" value="0" aria-label="TITLE"> <output id="label"></output>
<script>
const frames = FRAMES, labels = LABELS, step = STEP;
const [picture, play, place, label] = ["picture", "play", "place", "label"].map(id => document.getElementById(id));
let timer = null;
function show(k) { place.value = k; picture.src = "data:image/png;base64," + frames[k]; label.value = labels[k]; }
function run(on) {
  clearInterval(timer);
  timer = on ? setInterval(() => show((+place.value + 1) % frames.length), step) : null;
  play.innerHTML = on ? "&#10074;&#10074;" : "&#9654;";
}
play.onclick = () => run(timer === null);
place.oninput = () => { run(false); show(+place.value); };
show(0); run(!window.matchMedia("(prefers-reduced-motion: reduce)").matches);
</script></body></html>
"""


def _page(pictures: list[Any], title: str, labels: Sequence[str]) -> bytes:
    texts = []
    for picture in _small(pictures):
        page = io.BytesIO()
        picture.save(page, format="PNG", optimize=True)
        texts.append(base64.b64encode(page.getvalue()).decode())
    values = {
        "TITLE": html.escape(title),
        "WIDTH": str(pictures[0].width),
        "LAST": str(len(pictures) - 1),
        "LABELS": json.dumps(list(labels)),
        "STEP": f"{1000.0 * SECONDS / len(pictures):.0f}",
        "FRAMES": json.dumps(texts),
    }
    return filled(PAGE, values).encode()

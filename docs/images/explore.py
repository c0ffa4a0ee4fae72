"""Make the pictures of docs/explore.md: python -m docs.images.explore."""

from __future__ import annotations

import io
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image
from tests.support.browser import chromium, opened

import fastlink as fl

HERE, COLOURS = Path(__file__).parent, 256
QUANTITIES = ["transmission_angle_min", "omega4_max", "swing", "time_ratio", "grashof_class"]


def save(name: str, shot: bytes) -> None:
    """Write a picture with few colours."""
    picture = Image.open(io.BytesIO(shot)).convert("RGB").quantize(COLOURS, Image.Quantize.MAXCOVERAGE)
    picture.save(HERE / name, optimize=True)


def main() -> None:
    """Write the pictures."""
    space = fl.grid(
        a1=np.linspace(0.2, 0.7, 11), a2=np.linspace(0.7, 1.5, 161), a3=np.linspace(0.5, 1.3, 161), a4=1.0,
        omega1=10.0, P_u=0.6, P_v=0.35,
    )  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        path = f"{folder}/four_bars.h5"
        fl.sweep("planar_4r", space, QUANTITIES, branch=1, extrema="sampled", to=path, verify=0).close()
        size = {"viewport": {"width": 1280, "height": 800}}
        with (
            fl.explore(path, browser=False) as page,
            chromium() as browser,
            opened(browser, page.url, **size) as tab,
        ):
            box = tab.locator("#over").bounding_box()
            x, y = (lambda a: box["x"] + a * box["width"]), (lambda b: box["y"] + b * box["height"])
            tab.mouse.click(x(0.58), y(0.3))
            tab.mouse.move(0, 0)
            tab.evaluate("state.share = 0.32; drawFrame(); document.activeElement.blur()")
            tab.wait_for_timeout(500)
            save("explore.png", tab.screenshot())
            tab.mouse.move(x(0.2), y(0.45))
            tab.mouse.down()
            tab.mouse.move(x(0.3), y(0.6))
            tab.mouse.move(x(0.4), y(0.75))
            tab.mouse.up()
            tab.evaluate("Object.assign(state, {by: 'transmission_angle_min', largest: true}); drawRegion()")
            tab.wait_for_timeout(1000)
            tab.evaluate("(async () => { await lock(region.best[0].at); await lock(region.best[11].at); })()")
            tab.wait_for_timeout(1000)
            tab.evaluate("drawFrame(); document.activeElement.blur()")
            top = tab.locator("#region").bounding_box()["y"] - 4
            high = tab.evaluate("document.body.scrollHeight") - top
            clip = {"x": 0, "y": top, "width": 1280, "height": high}
            save("explore_region.png", tab.screenshot(full_page=True, clip=clip))


if __name__ == "__main__":
    main()

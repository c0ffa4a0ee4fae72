"""Make the picture of docs/explore.md: python docs/images/explore.py."""

from __future__ import annotations

import io
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image
from tests.support.browser import chromium, opened

import fastlink as fl

HERE = Path(__file__).parent
QUANTITIES = ["transmission_angle_min", "omega4_max", "swing", "time_ratio", "grashof_class"]
COLOURS = 256


def main() -> None:
    """Write the picture."""
    space = fl.grid(
        a1=np.linspace(0.2, 0.7, 11), a2=np.linspace(0.7, 1.5, 161), a3=np.linspace(0.5, 1.3, 161), a4=1.0,
        omega1=10.0, P_u=0.6, P_v=0.35,
    )  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        path = f"{folder}/four_bars.h5"
        fl.sweep("planar_4r", space, QUANTITIES, branch=1, extrema="sampled", to=path, verify=0).close()
        with fl.explore(path, browser=False) as page, chromium() as browser, opened(browser, page.url) as tab:
            box = tab.locator("#over").bounding_box()
            tab.mouse.dblclick(box["x"] + 0.35 * box["width"], box["y"] + 0.5 * box["height"])
            tab.wait_for_timeout(300)
            tab.mouse.click(box["x"] + 0.58 * box["width"], box["y"] + 0.3 * box["height"])
            tab.mouse.move(0, 0)
            tab.evaluate("state.share = 0.32; drawFrame()")
            tab.wait_for_timeout(300)
            picture = Image.open(io.BytesIO(tab.screenshot()))
    picture.convert("RGB").quantize(COLOURS, Image.Quantize.FASTOCTREE).save(
        HERE / "explore.png", optimize=True
    )


if __name__ == "__main__":
    main()

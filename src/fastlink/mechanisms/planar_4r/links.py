"""Links made of a round bar: masses, inertias and mass centres from the lengths."""

from __future__ import annotations

from fastlink.mechanisms._shared import round_bars
from fastlink.mechanisms.planar_4r.inputs import LINKS, planar_4r

round_bars.declare(planar_4r, {i: (link, f"a{i}") for i, link in LINKS.items()})

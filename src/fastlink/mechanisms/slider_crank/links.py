"""Crank and connecting rod made of a round bar; the slider's mass is given."""

from __future__ import annotations

from fastlink.mechanisms._shared import round_bars
from fastlink.mechanisms.slider_crank.inputs import BARS, slider_crank

round_bars.declare(slider_crank, BARS)

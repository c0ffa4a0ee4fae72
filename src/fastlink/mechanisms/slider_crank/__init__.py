"""The offset slider-crank: crank, connecting rod, and a slider on a line that may miss the crank's pivot."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastlink.mechanisms.slider_crank import forces, motion, picture, strokes  # noqa: F401 (they declare its facts)
from fastlink.mechanisms.slider_crank.inputs import slider_crank

if TYPE_CHECKING:
    from collections.abc import Callable

    from fastlink.facts.catalogue import Catalogue

__all__ = ["DRIVEN", "slider_crank"]

#: No other input drives it.
DRIVEN: dict[str, Callable[[], Catalogue]] = {}

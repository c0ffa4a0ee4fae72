"""The offset slider-crank: crank, connecting rod, and a slider on a line that may miss the crank's pivot."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastlink.mechanisms.slider_crank import (  # noqa: F401 (they declare its facts)
    derivatives,
    forces,
    graded,
    keywords,
    known,
    links,
    loads,
    position,
    rates,
    shaking,
    strokes,
    toggles,
)
from fastlink.mechanisms.slider_crank.inputs import slider_crank

if TYPE_CHECKING:
    from collections.abc import Callable

    from fastlink.catalogue.catalogue import Catalogue

__all__ = ["DRIVEN", "slider_crank"]

#: No other input drives it.
DRIVEN: dict[str, Callable[[], Catalogue]] = {}

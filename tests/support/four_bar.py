"""The planar 4R as most tests sweep it."""

from __future__ import annotations

from typing import Any

import fastlink as fl


def sweep_4r(space: Any, quantities: Any, **options: Any) -> Any:
    """Sweep the planar 4R in both assembly modes, unless an option says another."""
    return fl.sweep("planar_4r", space, quantities, **{"branch": (1, 2)} | options)

"""Sweeps in both assembly modes, as most tests want them."""

from __future__ import annotations

from functools import partial
from typing import Any

import fastlink as fl


def sweep_both(mechanism: Any, space: Any, quantities: Any, **options: Any) -> Any:
    """Sweep a mechanism in both assembly modes, unless an option says another."""
    return fl.sweep(mechanism, space, quantities, **{"branch": (1, 2)} | options)


sweep_4r = partial(sweep_both, "planar_4r")

#: The links, the lengths and the speed that most tests have.
BARS = fl.round_bar(density=7750.0, radius=0.01)
CRANK = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0}
TURNING = CRANK | {"omega1": 25.0}

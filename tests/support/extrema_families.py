"""The engine's answer on the families of linkages on which the extrema are counted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from benchmarks.cases import FAMILIES

import fastlink as fl
from tests.support.configurations import LENGTHS

__all__ = ["FAMILIES", "found", "names_of", "space"]


def space(lengths: np.ndarray, omega1: float = 1.0) -> fl.DesignSpace:
    return fl.table(dict(zip(LENGTHS, lengths, strict=True)) | {"omega1": omega1})


def names_of(quantity: str) -> list[str]:
    return [
        f"{quantity}_extrema",
        f"theta1_at_{quantity}_extrema",
        f"{quantity}_extrema_count",
        f"{quantity}_extrema_kind",
    ]


def found(
    lengths: np.ndarray, quantities: Sequence[str], omega1: float = 1.0, **options: Any
) -> dict[str, list[np.ndarray]]:
    """Return value, theta1, count and kind of the engine, by quantity."""
    asked = [f"{quantity}_extrema" for quantity in quantities]
    result = fl.sweep("planar_4r", space(lengths, omega1), asked, **options)
    return {quantity: [result[name].values for name in names_of(quantity)] for quantity in quantities}

"""The Minkowskian planar 4R of Hegedüs and Moore."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastlink.mechanisms.minkowski_4r import design_facts, motion, picture  # noqa: F401 (they declare its facts)
from fastlink.mechanisms.minkowski_4r.inputs import minkowski_4r

if TYPE_CHECKING:
    from collections.abc import Callable

    from fastlink.facts.catalogue import Catalogue

__all__ = ["DRIVEN", "minkowski_4r"]

#: No other input drives it.
DRIVEN: dict[str, Callable[[], Catalogue]] = {}

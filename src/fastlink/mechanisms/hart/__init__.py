"""Hart's straight-line linkage, as Wunderlich derives it from Burmester's focal mechanism."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastlink.mechanisms.hart import design_facts, four_bar, line, motion
from fastlink.mechanisms.hart.declare import hart

if TYPE_CHECKING:
    from fastlink.catalogue import Catalogue

__all__ = ["DRIVEN", "design_facts", "four_bar", "hart", "line", "motion"]

hart.check()
#: No other input drives it.
DRIVEN: dict[str, Catalogue] = {}

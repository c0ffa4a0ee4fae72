"""Hart's straight-line linkage, as Wunderlich derives it from Burmester's focal mechanism."""

from __future__ import annotations

from fastlink.mechanisms.hart import (  # noqa: F401 (they declare its facts)
    by_line,
    design_facts,
    four_bar,
    frame_AB,
    keywords,
    line,
    motion,
)
from fastlink.mechanisms.hart.inputs import hart

__all__ = ["DRIVEN", "hart"]

#: The same linkage driven by F along its line.
DRIVEN = {by_line.by_line.position.name: by_line.with_facts_of_hart}

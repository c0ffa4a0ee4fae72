"""Hart's straight-line linkage, as Wunderlich derives it from Burmester's focal mechanism."""

from __future__ import annotations

from fastlink.mechanisms.hart import by_line, motion, picture  # noqa: F401 (they declare its facts)
from fastlink.mechanisms.hart.inputs import hart

__all__ = ["DRIVEN", "hart"]

#: The same linkage driven by F along its line.
DRIVEN = {by_line.by_line.position.name: by_line.with_facts_of_hart}

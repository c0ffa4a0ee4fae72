"""Hart's straight-line linkage, as Wunderlich derives it from Burmester's focal mechanism."""

from __future__ import annotations

from fastlink.mechanisms.hart import by_line, design_facts, four_bar, line, motion
from fastlink.mechanisms.hart.declare import hart

__all__ = ["DRIVEN", "by_line", "design_facts", "four_bar", "hart", "line", "motion"]

#: The same linkage driven by F along its line.
DRIVEN = {by_line.by_line.position.name: by_line.with_facts_of_hart}

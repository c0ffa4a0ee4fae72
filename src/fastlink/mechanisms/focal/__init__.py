"""The focal mechanism of Burmester, after Wunderlich."""

from fastlink.catalogue import Catalogue
from fastlink.mechanisms.focal import completion, design_facts, ranges, status
from fastlink.mechanisms.focal.declare import focal

__all__ = ["DRIVEN", "completion", "design_facts", "focal", "ranges", "status"]

focal.check()
#: The same mechanism by its other inputs.
DRIVEN: dict[str, Catalogue] = {}

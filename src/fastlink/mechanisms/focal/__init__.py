"""The focal mechanism of Burmester, after Wunderlich."""

from fastlink.mechanisms.focal import curves, design_facts, inputs, motion, picture  # noqa: F401 (they declare its facts)
from fastlink.mechanisms.focal.inputs import focal

__all__ = ["DRIVEN", "focal"]

#: The same mechanism by its other inputs.
DRIVEN = {"sigma": inputs.with_design_facts}

"""The part of the turn over which extremes are wanted: two inputs of a design, and where its ends are."""

from __future__ import annotations

import math
from typing import Any

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Fact, Input
from fastlink.facts.formula import Formula

#: The variant, its inputs, the facts that vanish at either end, and those of the design that tell what is within.
ARC, ARC_ENDS = "arc", ("arc_start", "arc_end")
AT_ENDS, ARC_FACTS = ("at_arc_start", "at_arc_end"), ("arc_middle", "arc_reach")
#: An arc is longer than nothing and no longer than a turn, but for roundings of both ends.
REACH = """
turns = 0.25 * (arc_end - arc_start)
return select((turns > 0.0) & (turns < 1.5707963267948974), sine(turns), NOT_A_NUMBER)
"""


def with_arc(known: Catalogue) -> Catalogue:
    """Return a catalogue whose designs may give an arc, if its input is an angle whose turn is searched."""
    if known.graded is None or known.positions is not None or ARC in known.variant_inputs:
        return known
    position = known.position.name
    for name, noun, default in zip(ARC_ENDS, ("Start", "End"), (0.0, 2.0 * math.pi), strict=True):
        meaning = f"{noun} of the part of the turn that counts"
        known.declare_input(Input(name, "rad", name, meaning, rule="any", default=default), ARC)
    formulas = {f"at_{end}": (f"return sine({position} - {end})", (position, end)) for end in ARC_ENDS}
    formulas["arc_middle"] = "return 0.5 * (arc_start + arc_end)", ARC_ENDS
    formulas["arc_reach"] = REACH.strip(), ARC_ENDS
    for name, (text, parameters) in formulas.items():
        units = "rad" if name == "arc_middle" else "1"
        formula = Formula(name, parameters, text.splitlines())
        about: dict[str, Any] = {"units": units, "symbol": name, "meaning": name, "source": "docs/designs.md"}
        known.declare(Fact(name, formula, parameters, **about, internal=True), ARC)
    return known

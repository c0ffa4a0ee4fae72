"""Hart's straight-line linkage: its inputs and its two assembly modes.

M = (0, 0) and N = (d, 0) are fixed; MA and NB carry P and Q, AB joins the two, and F hangs on PF and QF. Given are
m = MP, n = NQ, d = MN, and kappa = PF/NQ = QF/MP = AB/MN.
"""

from __future__ import annotations

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Input

WUNDERLICH = "Wunderlich"
PAGE = "docs/hart.md"

hart = Catalogue(
    "hart",
    "Hart's straight-line linkage of six bars: F on bars from P and Q runs along a line perpendicular to MN",
    branches={
        1: "B to the right of the directed line from A to N",
        2: "B to the left of the directed line from A to N",
    },
    position=Input("phi", "rad", "phi", "direction of MA in the ground frame"),
)
hart.closes = ("sigma", "past_Z0", "past_C0")

hart.input("m", units="m", symbol="m", meaning="length of MP", rule="positive")
hart.input("n", units="m", symbol="n", meaning="length of NQ", rule="positive")
hart.input("d", units="m", symbol="d", meaning="length of the ground link MN", rule="positive")
hart.input(
    "kappa", units="1", symbol="kappa", meaning="ratio PF/NQ = QF/MP = AB/MN; its sign is that of p and c"
)

"""The reachable range of phi, graded: that of the four-bar MABN as a planar 4R, with what is taken over from there."""

from __future__ import annotations

from dataclasses import replace

from fastlink.catalogue import Fact
from fastlink.mechanisms.borrow import borrow, moved
from fastlink.mechanisms.focal.declare import focal
from fastlink.mechanisms.focal.design_facts import PREFIX
from fastlink.mechanisms.focal.rocker import NAMES, RENAME
from fastlink.mechanisms.planar_4r import planar_4r

_lent = planar_4r.graded
assert _lent is not None
_places = [fact for fact in planar_4r.alternatives[_lent.name].values() if isinstance(fact, Fact)]
_needed = {need for fact in _places for need in fact.needs}.intersection(planar_4r.facts)
_needed |= {_lent.sine, _lent.inverse, *(name for end in _lent.ends for name in end)}
borrow(focal, planar_4r, NAMES, PREFIX, {name: {} for name in sorted(_needed)})

focal.alternatives[_lent.name] = {RENAME(fact.name): moved(fact, RENAME) for fact in _places}
(_low, _high) = (tuple(map(RENAME, end)) for end in _lent.ends)
focal.graded = replace(
    _lent,
    ends=((_low[0], _low[1], _low[2]), (_high[0], _high[1], _high[2])),
    odd=tuple(map(RENAME, _lent.odd)),
    vanishing=RENAME(_lent.vanishing),
    inverse=RENAME(_lent.inverse),
    sine=RENAME(_lent.sine),
    cells={"psi": _lent.cells["theta4"], "dpsi_dphi": _lent.cells["omega4"]},
    most={"psi": _lent.most["theta4"], "dpsi_dphi": _lent.most["omega4"]},
    rough=("closure_residual", "F_path_residual"),
    jumps={"psi": "NB_y", "sigma": "MF_y", **dict.fromkeys(("omega_angle", "alpha", "beta", "chi"), "w_y")},
)

"""The reachable range of phi, graded: that of the four-bar MABN as a planar 4R, with what is taken over from there."""

from __future__ import annotations

from fastlink.mechanisms.borrow import borrow_range
from fastlink.mechanisms.focal.declare import focal
from fastlink.mechanisms.focal.design_facts import PREFIX
from fastlink.mechanisms.focal.rocker import NAMES
from fastlink.mechanisms.planar_4r import planar_4r

_lent = planar_4r.graded
assert _lent is not None
borrow_range(
    focal,
    planar_4r,
    NAMES,
    PREFIX,
    cells={"psi": _lent.cells["theta4"], "dpsi_dphi": _lent.cells["omega4"]},
    most={"psi": _lent.most["theta4"], "dpsi_dphi": _lent.most["omega4"]},
    rough=("closure_residual", "F_path_residual"),
    jumps={"psi": "NB_y", "sigma": "MF_y", **dict.fromkeys(("omega_angle", "alpha", "beta", "chi"), "w_y")},
)

"""The Minkowskian planar 4R of Hegedüs and Moore: its facts stand in the sheets beside this file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Input
from fastlink.facts.sheet import read_sheets
from fastlink.mechanisms._shared.picture import Bar, Circle, Locus, Picture, Point, joint

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["DRIVEN", "PICTURE", "minkowski_4r"]

minkowski_4r = Catalogue(
    "minkowski_4r",
    "Planar four-bar linkage of the Minkowskian plane with four revolute joints, driven at O",
    branches={
        1: "the root with the plus sign of eq. (3)",
        2: "the root with the minus sign of eq. (3)",
    },
    position=Input("theta", "1", "theta", "input rapidity; of OA in the ground frame"),
    positions=(-4.0, 4.0, 401),
)
minkowski_4r.closes = ("half_root", "inside", "outside")
minkowski_4r.most_asked = (
    "psi CB_orientation dpsi_dtheta AB_rapidity zeta X_x X_y linkage_type input_type output_type grashof "
    "theta_min theta_max psi_min psi_max theta_escape assembly_count_future status"
)
read_sheets(__file__, ("inputs", "design_facts", "motion"), minkowski_4r)

#: Figs. 9 to 24 of Hegedüs and Moore.
PICTURE = Picture(
    points=(
        Point("O", 0.0, 0.0, "ground"),
        Point("C", "g", 0.0, "ground"),
        joint("A"),
        joint("B"),
        joint("X", "traced"),
    ),
    bars=(
        Bar("O C", {"O C": "g"}, is_ground=True),
        Bar("O A", {"O A": "a"}),
        Bar("A B X", {"A B": "h"}, orientation="AB_orientation"),
        Bar("C B", {"C B": "b"}, orientation="CB_orientation"),
    ),
    circles=(Circle("O", "a"), Circle("C", "b")),
    loci=(Locus("sextic", "minkowski.sextic", "equation", "sextic of the coupler curve"),),
    traced={"path": "X"},
    metric="minkowskian",
    usual="path circles cone",
    title="Minkowskian four-bar, {linkage_type}",
    spans={"theta": (2.0, 2.0)},
)

#: No other input drives it.
DRIVEN: dict[str, Callable[[], Catalogue]] = {}

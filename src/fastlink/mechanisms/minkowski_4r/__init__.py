"""The Minkowskian planar 4R of Hegedüs and Moore: its names in books, and what is drawn of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastlink.mechanisms._shared.picture import Bar, Circle, Locus, Picture, Point, joint
from fastlink.mechanisms.minkowski_4r import design_facts, motion  # noqa: F401 (they declare its facts)
from fastlink.mechanisms.minkowski_4r.inputs import minkowski_4r

if TYPE_CHECKING:
    from collections.abc import Callable

    from fastlink.facts.catalogue import Catalogue

__all__ = ["DRIVEN", "PICTURE", "minkowski_4r"]


# -- Further names, in books and drawings, of the quantities and inputs of the Minkowskian 4R


minkowski_4r.also_called(
    a="crank, crank length, a1",
    b="rocker, output link, a3",
    g="ground, ground link, base, frame, a4",
    h="coupler, coupler length, a2",
    x="coupler point",
    y="coupler point",
    tolerance="tol, eps",
)
minkowski_4r.also_called(
    psi="output angle, rocker angle, output rapidity",
    phi="coupler angle",
    zeta="transmission angle",
    X_x="coupler curve, coupler point, path",
    X_y="coupler curve, coupler point, path",
    dpsi_dtheta="transmission ratio, velocity ratio, output speed",
    d2psi_dtheta2="output acceleration",
    theta_branching="branching point",
    grashof="grashof condition, grashof class",
    linkage_type="class",
    status="feasible, feasibility, valid, assembles, assembly",
    loop_residual="closure error",
    coefficient_A="A, A(theta)",
    coefficient_B="B, B(theta)",
    coefficient_C="C, C(theta)",
    r_AX="r, AX",
    s_BX="s, BX",
    lambda_AX="lambda",
    mu_BX="mu",
    psi_remark="Remark",
)


# -- The picture of the Minkowskian 4R: Figs. 9 to 24 of Hegedüs and Moore


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
    spans={"theta": (2.0, 2.0)},
)

#: No other input drives it.
DRIVEN: dict[str, Callable[[], Catalogue]] = {}

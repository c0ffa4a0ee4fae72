"""Hart's straight-line linkage, as Wunderlich derives it from Burmester's focal mechanism."""

from __future__ import annotations

from fastlink.mechanisms._shared.picture import Bar, Guide, Picture, Point, joint
from fastlink.mechanisms.hart import by_line, motion  # noqa: F401 (they declare its facts)
from fastlink.mechanisms.hart.inputs import hart

__all__ = ["DRIVEN", "PICTURE", "hart"]


# -- Further names, in books and drawings, of the quantities and inputs of Hart's linkage


hart.also_called(
    m="crank, l1, a1",
    n="rocker, output link, a3",
    d="ground, ground link, base, base length, frame, a4",
    kappa="k, scale, similarity ratio",
)
hart.also_called(
    F_x="position of F, path",
    F_y="position of F, path",
    psi="output angle, rocker angle",
    dF_y_dphi="velocity of F, speed",
    dpsi_dphi="velocity ratio, transmission ratio",
    F_deviation="straight line deviation, straightness, straight line error, path error",
    stroke="stroke length, travel",
    grashof_class="grashof condition, linkage type",
    status="feasible, feasibility, valid, assembles, assembly",
    closure_residual="closure error, loop residual",
)


# -- The picture of Hart's straight-line linkage: Figs. 6 and 7 of Wunderlich


PICTURE = Picture(
    points=(
        Point("M", 0.0, 0.0, "ground"),
        Point("N", "d", 0.0, "ground"),
        *(joint(name) for name in "ABPQF"),
        joint("PF_mid", "mark", group="ellipse", is_named=False),
    ),
    bars=(
        Bar("M N", {"M N": "d"}, is_ground=True),
        Bar("M P A", {"M A": "a", "M P": "m"}),
        Bar("N Q B", {"N B": "b", "N Q": "n"}),
        Bar("A B", {"A B": "c"}),
        Bar("P F", {"P F": "p"}),
        Bar("Q F", {"Q F": "q"}),
    ),
    guides=(Guide(x="line_x", group="line"),),
    traced={"path": "F", "ellipse": "PF_mid"},
    usual="path line",
    spans={"F_y": ("F_y_outer", "F_y_outer")},
)

#: The same linkage driven by F along its line.
DRIVEN = {by_line.by_line.position.name: by_line.with_facts_of_hart}

"""The picture of Hart's straight-line linkage: Figs. 6 and 7 of Wunderlich."""

from __future__ import annotations

from fastlink.mechanisms._shared.picture import Bar, Guide, Picture, Point, joint

__all__ = ["PICTURE"]

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

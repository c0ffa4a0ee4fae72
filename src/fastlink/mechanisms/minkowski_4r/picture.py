"""The picture of the Minkowskian 4R: Figs. 9 to 24 of Hegedüs and Moore."""

from __future__ import annotations

from fastlink.mechanisms._shared.picture import Bar, Circle, Locus, Picture, Point, joint

__all__ = ["PICTURE"]

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

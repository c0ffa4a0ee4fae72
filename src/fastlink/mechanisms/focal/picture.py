"""The picture of Burmester's focal mechanism: Figs. 1 to 5 of Wunderlich."""

from __future__ import annotations

from fastlink.mechanisms._shared.picture import Bar, Circle, Guide, Locus, Picture, Point, joint

__all__ = ["PICTURE"]

CENTRES = ("PFQX", "SFTY", "PSQT")

FOCUS = {"x": "F_x", "y": "F_y"}

PICTURE = Picture(
    points=(
        Point("M", 0.0, 0.0, "ground"),
        Point("N", "d", 0.0, "ground"),
        Point("S", "S_x", 0.0, "ground"),
        *(joint(name) for name in "ABPQTF"),
        joint("X", "mark", group="crossings"),
        Point("Y", "Y_x", 0.0, "mark", group="crossings"),
        *(joint(points, "mark", group="circles", is_named=False) for points in CENTRES),
    ),
    bars=(
        Bar("M S N", {"M N": "d"}, is_ground=True),
        Bar("M P A", {"M A": "a", "M P": "m"}),
        Bar("N Q B", {"N B": "b", "N Q": "n"}),
        Bar("A T B", {"A B": "c"}),
        Bar("P F", {"P F": "p"}),
        Bar("Q F", {"Q F": "q"}),
        Bar("S F", {"S F": "r"}),
        Bar("F T", {"F T": "FT"}),
    ),
    circles=(
        Circle("S", "r", group="path"),
        *(Circle(points, f"{points}_radius") for points in CENTRES),
    ),
    guides=(Guide(x="line_x", group="path"),),
    loci=(
        Locus("cubic", "focal.cubic_points", "points", "focal cubic", by="phi"),
        Locus("foci", "focal.inscribed_conics", "conic", "conic with the focus F", by="phi", given=FOCUS),
    ),
    traced={"path": "T"},
    usual="path cubic",
)

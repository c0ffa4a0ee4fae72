"""The picture of the planar 4R: Figs. 1 and 2 of Hayes, Hninn and Irani."""

from __future__ import annotations

from fastlink.mechanisms._shared.picture import Bar, Circle, Force, Picture, Point, Torque, joint

__all__ = ["PICTURE"]

PICTURE = Picture(
    points=(
        Point("O", 0.0, 0.0, "ground"),
        Point("D", "a4", 0.0, "ground"),
        joint("A"),
        joint("B"),
        joint("P", "traced"),
        *(joint(f"G{number}", "mark", group="centres") for number in (1, 2, 3)),
    ),
    bars=(
        Bar("O D", {"O D": "a4"}, is_ground=True),
        Bar("O A", {"O A": "a1"}),
        Bar("A B P", {"A B": "a2"}),
        Bar("D B", {"D B": "a3"}),
    ),
    circles=(Circle("O", "a1"), Circle("D", "a3")),
    forces=(Force("F41", "O"), Force("F21", "A"), Force("F32", "B"), Force("F43", "D")),
    torques=(Torque("T41", "O"),),
    traced={"path": "P"},
)

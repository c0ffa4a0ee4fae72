"""The focal mechanism of Burmester, after Wunderlich: its names in books, and what is drawn of it."""

from fastlink.mechanisms._shared.picture import Bar, Circle, Guide, Locus, Picture, Point, joint
from fastlink.mechanisms.focal import curves, design_facts, inputs, motion  # noqa: F401 (they declare its facts)
from fastlink.mechanisms.focal.inputs import focal

__all__ = ["DRIVEN", "PICTURE", "focal"]


# -- Further names, in books and drawings, of the quantities and inputs of the focal mechanism


focal.also_called(
    a="crank, rocker, a1",
    b="rocker, output link, a3",
    c="coupler, coupler length, a2",
    d="ground, ground link, base, frame, a4",
    s="crank support",
    omega="speed, rpm, angular speed, input speed",
    completion="root, solution",
)
focal.also_called(
    F_x="position of F, path, trace, coupler curve",
    F_y="position of F, path, trace, coupler curve",
    sigma="crank angle",
    psi="output angle, rocker angle",
    dpsi_dphi="velocity ratio, transmission ratio, mechanical advantage",
    psi_rate="output speed, rocker speed",
    transmission_angle_F="transmission angle, pressure angle",
    F_path_residual="straight line error, straightness, deviation of F, path error",
    grashof_class="grashof condition, linkage type",
    phi_low="limit angle, toggle angle, toggle position, dead centre",
    phi_high="limit angle, toggle angle, toggle position, dead centre",
    status="feasible, feasibility, valid, assembles, assembly, closes",
    closure_residual="closure error, loop residual",
    X_x="pole, instant centre, intersection of the rockers",
    X_y="pole, instant centre, intersection of the rockers",
    F_along_AB="inversion, AB fixed, relative motion",
    F_across_AB="inversion, AB fixed, relative motion",
)


# -- The picture of Burmester's focal mechanism: Figs. 1 to 5 of Wunderlich


CENTRES, FOCUS = ("PFQX", "SFTY", "PSQT"), {"x": "F_x", "y": "F_y"}
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

#: The same mechanism by its other inputs.
DRIVEN = {"sigma": inputs.with_design_facts}

"""Further names, in books and drawings, of the quantities and inputs of Hart's linkage."""

from __future__ import annotations

from fastlink.mechanisms.hart.inputs import hart

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

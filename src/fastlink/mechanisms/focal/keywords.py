"""Further names, in books and drawings, of the quantities and inputs of the focal mechanism."""

from __future__ import annotations

from fastlink.mechanisms.focal.inputs import focal

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

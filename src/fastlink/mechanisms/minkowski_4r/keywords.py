"""Further names, in books and drawings, of the quantities and inputs of the Minkowskian 4R."""

from __future__ import annotations

from fastlink.mechanisms.minkowski_4r.inputs import minkowski_4r

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

"""Facts of motion of the Minkowskian 4R: the rates of psi by theta.

With (u, v) the null coordinates of AB, (a p, a/p) and (b q, b/q) those of the cranks, and d their product
b q v - b u/q, which is the root of the discriminant,

    psi'  = a (p v - u/p)/d
    psi'' = a b g {(p q v^2 - u^2/(p q)) (u - v) - h^2 (p/q - q/p) [a (p - 1/p) + b (q - 1/q)]}/d^3

where each null coordinate is right to a few roundings of its own. Differentiated instead of reduced, psi'' would be
a difference of terms that grow against it like e^theta.
"""

from __future__ import annotations

from typing import Any

from fastlink.jit import NOT_A_NUMBER, select
from fastlink.mechanisms.minkowski_4r import position  # noqa: F401 (whose rates these are)
from fastlink.mechanisms.minkowski_4r.declare import NUMERICS, minkowski_4r

RATES = f"{NUMERICS}#rates"


@minkowski_4r.quantity(units="1", symbol="1/d", source=RATES, internal=True)
def per_root(half_root: Any, branch_sign: Any, side: Any) -> Any:
    """Reciprocal of the root of the discriminant times r, with the sign of the root; NaN at a limit."""
    return branch_sign * side * 0.5 / select(half_root == 0.0, NOT_A_NUMBER, half_root)


@minkowski_4r.quantity(units="1", symbol="dpsi/dtheta", source=RATES)
def dpsi_dtheta(s_a: Any, s_h: Any, p_r: Any, per_p: Any, AB_u: Any, AB_v: Any, per_root: Any) -> Any:
    """Transmission ratio: rate of psi by theta."""
    return s_a * s_h * (p_r * AB_v - per_p * AB_u) * per_root


@minkowski_4r.quantity(units="1", symbol="d2psi/dtheta2", source=RATES)
def d2psi_dtheta2(
    s_a: Any,
    s_b: Any,
    s_g: Any,
    s_h: Any,
    sinh_r: Any,
    p_r: Any,
    per_p: Any,
    r: Any,
    CB_u: Any,
    CB_v: Any,
    AB_u: Any,
    AB_v: Any,
    side: Any,
    per_root: Any,
) -> Any:
    """Rate of the transmission ratio by theta."""
    squares = p_r * CB_u * (AB_v * AB_v) - per_p * CB_v * (AB_u * AB_u)
    across = s_h * squares * (AB_u - AB_v * r)
    heights = 2.0 * s_a * sinh_r + s_b * (CB_u - CB_v * r)
    turning = (p_r * CB_v - per_p * CB_u) * heights * r
    return side * (s_a * s_b * s_g * (s_h * s_h)) * ((across - turning) * per_root * per_root * per_root)


def same(x: Any) -> Any:
    """Return x."""
    return x


for _of, _need in (("psi", "dpsi_dtheta"), ("dpsi_dtheta", "d2psi_dtheta2")):
    minkowski_4r.derivative(_of, "theta", given={"x": _need})(same)

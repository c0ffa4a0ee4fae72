"""The angles alpha, beta and chi that F encloses with the joints of the four-bar.

Each is that of two vectors from F, in a frame along a bar. FM and FN are taken by the shorter way
(`joint_F`), and so is FA: by way of P, with PA = (lambda - 1) m, or by way of T. A and F may nearly coincide
(rho near 0): FA is never MA - MF. Across its bar each is a product: with MP or NQ times sin(omega).
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import product
from fastlink.mechanisms.focal.by_crank import either, steps
from fastlink.mechanisms.focal.inputs import WUNDERLICH, focal
from fastlink.mechanisms.focal.points import POSITION
from fastlink.numerics.elementary import atan2


@either(units="rad", symbol="alpha", source=f"{WUNDERLICH}, eq. (4.2)")
def alpha(
    s_n: Any, near_q: Any, near_n: Any, w_x: Any, w_y: Any, from_N_by_S_x: Any, from_N_by_S_y: Any, h_x: Any,
    h_y: Any,
) -> Any:  # fmt: skip
    """Angle from FN to FQ, and from AP to AF."""
    x = (near_q + near_n * w_x) + (h_x * from_N_by_S_x + h_y * from_N_by_S_y)
    return atan2(s_n * w_y + 0.0, x)


@either(units="rad", symbol="beta", source=f"{WUNDERLICH}, eq. (4.1)")
def beta(
    ratio_sign: Any, s_m: Any, near_p: Any, near_m: Any, w_x: Any, w_y: Any, by_S_x: Any, by_S_y: Any,
    f_x: Any, f_y: Any,
) -> Any:  # fmt: skip
    """Angle from FP to FM, and from BF to BQ."""
    x = (near_p - near_m * w_x) - (by_S_x * f_x + by_S_y * f_y)
    return atan2(ratio_sign * (s_m * w_y) + 0.0, ratio_sign * x)


# -- chi, in the frame along MA ----------------------------------------------------------------------------------


@focal.quantity(units="1", symbol="FT", source=POSITION, internal=True)
def held_FT_along(held_FT: Any, crank_sign: Any) -> Any:
    """Scaled distance of T from F along u v w, where that way is taken."""
    return -crank_sign * held_FT


step = steps(units="1", source=f"{WUNDERLICH}, eq. (1.3)")
step(product, "MF_across", "h", "Distance of F from MA to its right, scaled", x="s_p", y="w_y")


@either(units="1", symbol="MF_u", source=f"{WUNDERLICH}, eqs. (1.3), (1.7)", internal=True)
def MF_along(near_m: Any, near_p: Any, w_x: Any, by_S_x: Any, by_S_y: Any, u_x: Any, u_y: Any) -> Any:
    """Vector from M to F along MA, scaled."""
    return (near_m - near_p * w_x) + (by_S_x * u_x + by_S_y * u_y)


@either(units="1", symbol="FA_u", source=f"{WUNDERLICH}, eqs. (1.3), (3.2)", internal=True)
def FA_along(
    held_AP: Any, held_p: Any, w_x: Any, held_FT_along: Any, uwv_x: Any, uwv_y: Any, held_AT: Any, e_x: Any,
    e_y: Any, u_x: Any, u_y: Any,
) -> Any:  # fmt: skip
    """Vector from F to A along MA, scaled."""
    x = held_FT_along * uwv_x - held_AT * e_x
    y = held_FT_along * uwv_y - held_AT * e_y
    return (held_AP + held_p * w_x) + (x * u_x + y * u_y)


@either(units="rad", symbol="chi", source=f"{WUNDERLICH}, eq. (4.3)")
def chi(s_a: Any, MF_across: Any, MF_along: Any, FA_along: Any) -> Any:
    """Angle from FA to FM; from FN to FB it is pi - chi, or -chi where rho is negative."""
    x = MF_across * MF_across - MF_along * FA_along
    return atan2(s_a * MF_across + 0.0, x)

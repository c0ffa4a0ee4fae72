"""Facts of the joint F: its vector z from M, by way of S or of P.

One of both may be far away: S where rho nears -1, P where lambda nears 0. So F is computed from S where that is nearer
to M and F than P is, else from P; the lengths of the other way count as 0.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import angle, product, same
from fastlink.mechanisms.focal.by_crank import either, steps
from fastlink.mechanisms.focal.inputs import WUNDERLICH, focal
from fastlink.mechanisms.focal.points import FIGURES, POSITION
from fastlink.numerics.elementary import atan2, select, sqrt


@focal.quantity(units="1", symbol="|s| + r < |m|, |p|", source=POSITION, internal=True)
def near_crank(s_s: Any, s_r: Any, s_m: Any, s_p: Any) -> Any:
    """1 where S is nearer to M and F than P is, else 0."""
    reach = abs(s_s) + s_r
    return select((reach < abs(s_m)) & (reach < abs(s_p)), 1.0, 0.0)


def of_crank(near_crank: Any, length: Any) -> Any:
    """A length where F is computed from S, else 0."""
    return select(near_crank == 1.0, length, 0.0)


def of_dyad(near_crank: Any, length: Any) -> Any:
    """A length where F is computed from P, else 0."""
    return select(near_crank == 1.0, 0.0, length)


@focal.quantity(units="1", symbol="d - s", source=f"{WUNDERLICH}, eq. (1.9)", internal=True)
def s_SN(s_d: Any, rho_plus_1: Any) -> Any:
    """Scaled distance from S to N along MN."""
    return s_d / rho_plus_1


step = focal.steps(units="1", source=POSITION)
step(of_crank, "near_s", "s_s", length="s_s")
step(of_crank, "near_r", "s_r", length="s_r")
step(of_crank, "near_SN", "s_SN", length="s_SN")
step(of_dyad, "near_m", "s_m", length="s_m")
step(of_dyad, "near_n", "s_n", length="s_n")
step(of_dyad, "near_p", "s_p", length="s_p")
step(of_dyad, "near_q", "s_q", length="s_q")
step(of_dyad, "far_s", "s_s", length="s_s")

# -- z by S; 0 where it is computed from P ------------------------------------------------------------------------


@either(units="1", symbol="z_x", source=f"{WUNDERLICH}, eq. (1.7)", internal=True)
def by_S_x(near_s: Any, near_r: Any, g_x: Any) -> Any:
    """Vector from M to F by way of S, x."""
    return near_s + near_r * g_x


@either(units="1", symbol="z_x - d", source=f"{WUNDERLICH}, eq. (1.7)", internal=True)
def from_N_by_S_x(near_SN: Any, near_r: Any, g_x: Any) -> Any:
    """Vector from N to F by way of S, x."""
    return near_r * g_x - near_SN


step = steps(units="1", source=f"{WUNDERLICH}, eq. (1.7)")
step(product, "by_S_y", "z_y", "Vector from M or N to F by way of S, y", x="near_r", y="g_y")

# -- angles that F encloses ---------------------------------------------------------------------------------------


@either(units="rad", symbol="alpha", source=f"{WUNDERLICH}, eq. (4.2)")
def alpha(
    near_q: Any, near_n: Any, w_x: Any, w_y: Any, from_N_by_S_x: Any, by_S_y: Any, h_x: Any, h_y: Any
) -> Any:
    """Angle from FN to FQ, and from AP to AF."""
    x = (near_q + near_n * w_x) + (h_x * from_N_by_S_x + h_y * by_S_y)
    y = near_n * w_y + (h_y * from_N_by_S_x - h_x * by_S_y)
    return atan2(y + 0.0, x)


@either(units="rad", symbol="beta", source=f"{WUNDERLICH}, eq. (4.1)")
def beta(
    ratio_sign: Any, near_p: Any, near_m: Any, w_x: Any, w_y: Any, by_S_x: Any, by_S_y: Any, f_x: Any,
    f_y: Any,
) -> Any:  # fmt: skip
    """Angle from FP to FM, and from BF to BQ."""
    x = (near_p - near_m * w_x) - (by_S_x * f_x + by_S_y * f_y)
    y = near_m * w_y + (by_S_x * f_y - by_S_y * f_x)
    return atan2(ratio_sign * y + 0.0, ratio_sign * x)


@either(units="rad", symbol="chi", source=f"{WUNDERLICH}, eq. (4.3)")
def chi(MF_x: Any, MF_y: Any, s_a: Any, u_x: Any, u_y: Any) -> Any:
    """Angle from FA to FM; from FN to FB it is pi - chi, or -chi where rho is negative."""
    x = MF_x * (MF_x - s_a * u_x) + MF_y * (MF_y - s_a * u_y)
    y = s_a * (MF_x * u_y - MF_y * u_x)
    return atan2(y + 0.0, x)


# -- driven by the rocker -----------------------------------------------------------------------------------------


def whether_far(near_crank: Any) -> Any:
    """1 where F is computed from P, else 0."""
    return 1.0 - near_crank


@focal.quantity(units="1", symbol="sgn p m", source=POSITION, internal=True)
def near_P_sign(near_crank: Any, P_sign: Any) -> Any:
    """Sign of m p where F is computed from S, else 0."""
    return near_crank * P_sign


@focal.quantity(units="1", symbol="1/p", source=POSITION, internal=True)
def near_per_p(near_crank: Any, s_p: Any) -> Any:
    """Reciprocal of p where F is computed from S, else 0."""
    return select(near_crank == 1.0, 1.0 / s_p, 0.0)


focal.steps(units="1", source=POSITION)(whether_far, "far_crank", "1")


@focal.quantity(units="1", symbol="sin omega", source=f"{WUNDERLICH}, eq. (1.3)", internal=True)
def by_S_sine(near_per_p: Any, by_S_x: Any, by_S_y: Any, u_x: Any, u_y: Any) -> Any:
    """Sine of omega by way of S: the height of F over MP, over p."""
    return near_per_p * (by_S_x * u_y - by_S_y * u_x)


@focal.quantity(units="1", symbol="cos omega", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def w_x(far_crank: Any, closing_x: Any, near_P_sign: Any, by_S_sine: Any) -> Any:
    """Cosine of omega."""
    # PF and PM are longer than FM where F is computed from S: omega is within pi/3 of 0 or pi
    return far_crank * closing_x + near_P_sign * sqrt(1.0 - by_S_sine * by_S_sine)


@focal.quantity(units="1", symbol="sin omega", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def w_y(far_crank: Any, closing_y: Any, by_S_sine: Any) -> Any:
    """Sine of omega."""
    return far_crank * closing_y + by_S_sine


def from_M(by_S: Any, near_m: Any, u: Any, near_p: Any, f: Any) -> Any:
    """Return a component of the vector from M to F by way of S, or of P."""
    return by_S + (near_m * u - near_p * f)


step = focal.steps(units="1", source=f"{WUNDERLICH}, eqs. (1.3), (1.7)")
step.vector(from_M, "MF_*", "z_*", "Vector from M to F, scaled", by_S="by_S_*", u="u_*", f="f_*")


@focal.quantity(units="1", symbol="z_x - s", source=POSITION, internal=True)
def SF_x(far_s: Any, near_r: Any, g_x: Any, near_m: Any, u_x: Any, near_p: Any, f_x: Any) -> Any:
    """Vector from S to F, scaled, x."""
    return near_r * g_x + (near_m * u_x - near_p * f_x - far_s)


angle_of_crank = focal.quantities(units="rad", source=FIGURES)
angle_of_crank(angle, "sigma", "sigma", "Direction of the crank SF in the ground frame", x="SF_x", y="MF_y")


@focal.quantity(units="1", symbol="(1 + rho) kappa b/(2 d |lambda|)", source=POSITION, internal=True)
def crank_lever(rho_plus_1: Any, root_x: Any, root_rho: Any, s_b: Any, s_d: Any, lambda_: Any) -> Any:
    """p/(2 s)."""
    return 0.5 * rho_plus_1 * (root_x / root_rho) * (s_b / s_d) / abs(lambda_)


@focal.quantity(units="1", symbol="d sigma/d phi", source=POSITION)
def dsigma_dphi(crank_lever: Any, w_y: Any, bar_per_sigma: Any, branch_sign: Any) -> Any:
    """Angular velocity of the crank SF over that of MA."""
    return branch_sign * (crank_lever * w_y * bar_per_sigma)


focal.derivatives(focal.position.name)(same, "sigma", x="dsigma_dphi")

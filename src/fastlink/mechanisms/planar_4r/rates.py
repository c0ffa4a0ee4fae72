"""Facts of velocity and acceleration of the planar 4R, at constant input speed.

With gamma = |AD|^2/(4 a1 a4), sigma = sqrt(p q) and ' = d/dtheta1 the transmission ratios are

    omega4/omega1 = [1 + epsilon/gamma + s H (1 + kappa/gamma)]/2
    omega2/omega1 = [1 + epsilon/gamma - s H (1 - kappa/gamma)]/2,    H = sin(theta1)/(2 sigma),

the solution of eq. (7) without the half-angle of the output, and free of cancellation except at its own
zeros. 1 + kappa/gamma and 1 - kappa/gamma are twice the feet of B on AD, from A and from D, over |AD|: sums with p that
keep their digits where two short links stand on two long ones. H' needs no difference of large terms either:
H' = (C0 Z p - Z0 C q)/(2 sigma^3).
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import half, product
from fastlink.mechanisms.planar_4r.inputs import HAYES, NUMERICS, planar_4r

RATES = f"{NUMERICS}#rates"


@planar_4r.quantity(units="1", symbol="1/sigma", source=RATES, internal=True)
def per_sigma(sigma: Any) -> Any:
    """Reciprocal of sigma; infinite at a toggle."""
    return 1.0 / sigma


step = planar_4r.steps(units="1", source=RATES)
step(half, "half_sine", "sin(theta_1)/2", "Derivative of gamma by the input angle", x="sin_theta1")
step(product, "H", "H", "Part of the ratios that changes sign with the branch", x="half_sine", y="per_sigma")
step(product, "kappa_per_gamma", "kappa/gamma", "(a2^2 - a3^2)/|AD|^2", x="kappa", y="per_gamma")
step = planar_4r.steps(units="rad s-1", source=RATES)
step(half, "half_omega1", "omega_1/2", "Half the input speed", x="omega1")
step(product, "odd_rate", "omega_1 H/2", "H times half the input speed", x="half_omega1", y="H")


@planar_4r.quantity(units="rad2 s-2", symbol="omega_1^2/2", source=RATES, internal=True)
def half_omega1_squared(omega1: Any) -> Any:
    """Half the squared input speed."""
    return 0.5 * (omega1 * omega1)


@planar_4r.quantity(units="rad s-1", symbol="omega_1 T/2", source=RATES, internal=True)
def mean_rate(half_omega1: Any, crank_excess: Any, Z: Any, per_gamma: Any) -> Any:
    """Mean of the angular velocity over both branches."""
    return half_omega1 * ((crank_excess + Z) * per_gamma)


def link_rate(mean_rate: Any, odd_rate: Any, share: Any, branch_sign: Any) -> Any:
    """Angular velocity of a link, or its ratio to that of the crank."""
    return mean_rate + branch_sign * (odd_rate * share)


rate = planar_4r.quantities(units="rad s-1", source=f"{HAYES}, eq. (7)")
rate(link_rate, "omega4", "omega_4", "Angular velocity of the output link", share="output_share")
rate = planar_4r.quantities(units="rad s-1", source=f"{HAYES}, eq. (7) for the pair 1-2")
rate(link_rate, "omega2", "omega_2", "Angular velocity of the coupler", share="coupler_share")


@planar_4r.quantity(units="rad2 s-2", symbol="omega_1^2 gamma'/(2 gamma)", source=RATES, internal=True)
def gamma_rate(half_omega1_squared: Any, half_sine: Any, per_gamma: Any) -> Any:
    """Logarithmic derivative of gamma times half the squared input speed."""
    return (half_omega1_squared * half_sine) * per_gamma


@planar_4r.quantity(units="rad s-2", symbol="omega_1^2 T'/2", source=RATES, internal=True)
def mean_acceleration(epsilon: Any, gamma_rate: Any, per_gamma: Any) -> Any:
    """Mean of the angular acceleration over both branches."""
    return -((epsilon * gamma_rate) * per_gamma)


def squared_rate(limit: Any, half_omega1_squared: Any) -> Any:
    """Return a squared sine or cosine times a quarter of the squared input speed."""
    return 0.5 * half_omega1_squared * limit


step = planar_4r.steps(units="rad2 s-2", source=RATES)
_TIMES = "times a quarter of the squared input speed"
step(squared_rate, "C0_squared_rate", "omega_1^2 C_0/4", f"C0 {_TIMES}", limit="C0")
step(squared_rate, "Z0_squared_rate", "omega_1^2 Z_0/4", f"Z0 {_TIMES}", limit="Z0")


@planar_4r.quantity(units="rad s-2", symbol="omega_1^2 H'/2", source=RATES, internal=True)
def H_rate(C0_squared_rate: Any, Z0_squared_rate: Any, Z: Any, C: Any, p: Any, q: Any, per_sigma: Any) -> Any:
    """Derivative of H times half the squared input speed."""
    return (C0_squared_rate * Z * p - Z0_squared_rate * C * q) * (per_sigma * per_sigma * per_sigma)


@planar_4r.quantity(
    units="rad s-2", symbol="omega_1^2 H kappa gamma'/(2 gamma^2)", source=RATES, internal=True
)
def kappa_rate(H: Any, kappa_per_gamma: Any, gamma_rate: Any) -> Any:
    """H times the derivative of -kappa/gamma times half the squared input speed."""
    return (H * kappa_per_gamma) * gamma_rate


def link_acceleration(
    mean_acceleration: Any, H_rate: Any, share: Any, kappa_rate: Any, branch_sign: Any
) -> Any:
    """Angular acceleration of a link, or the derivative of its ratio."""
    return mean_acceleration + branch_sign * (H_rate * share - kappa_rate)


rate = planar_4r.quantities(units="rad s-2", source=f"{HAYES}, eq. (8)")
rate(link_acceleration, "alpha4", "alpha_4", "Angular acceleration of the output link", share="output_share")
rate = planar_4r.quantities(units="rad s-2", source=f"{HAYES}, eq. (8) for the pair 1-2")
rate(link_acceleration, "alpha2", "alpha_2", "Angular acceleration of the coupler", share="coupler_share")


@planar_4r.quantity(units="1", symbol="gamma'/gamma", source=RATES, internal=True)
def log_rate(half_sine: Any, per_gamma: Any) -> Any:
    """Logarithmic derivative of gamma."""
    return half_sine * per_gamma


@planar_4r.quantity(units="1", symbol="-(1/gamma)'' gamma", source=RATES, internal=True)
def gamma_bend(cos_theta1: Any, half_sine: Any, log_rate: Any, per_gamma: Any) -> Any:
    """Second derivative of -1/gamma, times gamma."""
    return (0.5 * cos_theta1 - 2.0 * (half_sine * log_rate)) * per_gamma


@planar_4r.quantity(units="1", symbol="T''/2", source=RATES, internal=True)
def mean_bend(epsilon: Any, per_gamma: Any, gamma_bend: Any) -> Any:
    """Second derivative of the mean of the ratios."""
    return -(0.5 * ((epsilon * per_gamma) * gamma_bend))


@planar_4r.quantity(units="1", symbol="H''/2", source=RATES, internal=True)
def H_bend(half_sine: Any, C0: Any, Z0: Any, Z: Any, C: Any, p: Any, q: Any, per_sigma: Any) -> Any:
    """Half the second derivative of H."""
    slope = C0 * (p + Z) + Z0 * (q + C)
    factor = C0 * Z * p - Z0 * C * q
    bend = slope - (1.5 * (q - p)) * (factor * (per_sigma * per_sigma))
    return (0.25 * half_sine) * (bend * (per_sigma * per_sigma * per_sigma))


@planar_4r.quantity(units="1", symbol="-(2 H' k' + H k'')/2", source=RATES, internal=True)
def kappa_bend(H: Any, H_slope: Any, kappa_per_gamma: Any, log_rate: Any, gamma_bend: Any) -> Any:
    """Part of the second derivative of kappa/gamma in that of the ratios."""
    return kappa_per_gamma * (2.0 * (H_slope * log_rate) + 0.5 * (H * gamma_bend))


def bend(mean_bend: Any, H_bend: Any, share: Any, kappa_bend: Any, branch_sign: Any) -> Any:
    """Second derivative of a ratio."""
    return mean_bend + branch_sign * (H_bend * share - kappa_bend)


step = planar_4r.steps(units="1", source=RATES)
_OUTPUT, _COUPLER = (
    f"second derivative of {omega}/omega1 by the input angle" for omega in ("omega4", "omega2")
)
step(bend, "output_bend", "n_4''", _OUTPUT, share="output_share")
step(bend, "coupler_bend", "n''", _COUPLER, share="coupler_share")


@planar_4r.quantity(units="rad3 s-3", symbol="omega_1^3", source=RATES, internal=True)
def omega1_cubed(omega1_squared: Any, omega1: Any) -> Any:
    """Cube of the input speed."""
    return omega1_squared * omega1


jerk = planar_4r.quantities(units="rad s-3", source=f"{HAYES}, eq. (8), differentiated")
jerk(product, "jerk4", "jerk_4", "Angular jerk of the output link", x="omega1_cubed", y="output_bend")
jerk = planar_4r.quantities(units="rad s-3", source=f"{HAYES}, eq. (8) for the pair 1-2, differentiated")
jerk(product, "jerk2", "jerk_2", "Angular jerk of the coupler", x="omega1_cubed", y="coupler_bend")

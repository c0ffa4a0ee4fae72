"""Facts of velocity and acceleration of the planar 4R, at constant input speed.

With gamma = |AD|^2/(4 a1 a4), sigma = sqrt(p q) and ' = d/dtheta1 the transmission ratios are

    omega4/omega1 = [1 + epsilon/gamma + s H (1 + kappa/gamma)]/2
    omega2/omega1 = [1 + epsilon/gamma - s H (1 - kappa/gamma)]/2,    H = sin(theta1)/(2 sigma),

the solution of eq. (7) without the half-angle of the output, and free of cancellation except at its own
zeros. H' needs no difference of large terms either: H' = (C0 Z p - Z0 C q)/(2 sigma^3).
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.planar_4r.declare import HAYES, NUMERICS, planar_4r

RATES = f"{NUMERICS}#rates"


@planar_4r.quantity(units="1", symbol="1/sigma", source=RATES, internal=True)
def per_sigma(sigma: Any) -> Any:
    """Reciprocal of sigma; infinite at a toggle."""
    return 1.0 / sigma


@planar_4r.quantity(units="1", symbol="sin(theta_1)/2", source=RATES, internal=True)
def half_sine(sin_theta1: Any) -> Any:
    """Derivative of gamma by the input angle."""
    return 0.5 * sin_theta1


@planar_4r.quantity(units="1", symbol="H", source=RATES, internal=True)
def H(half_sine: Any, per_sigma: Any) -> Any:
    """Part of the ratios that changes sign with the branch."""
    return half_sine * per_sigma


@planar_4r.quantity(units="1", symbol="T", source=RATES, internal=True)
def mean_ratio(crank_excess: Any, Z: Any, per_gamma: Any) -> Any:
    """1 + epsilon/gamma: the sum of the ratios of both branches."""
    return (crank_excess + Z) * per_gamma


@planar_4r.quantity(units="1", symbol="kappa/gamma", source=RATES, internal=True)
def kappa_per_gamma(kappa: Any, per_gamma: Any) -> Any:
    """(a2^2 - a3^2)/|AD|^2."""
    return kappa * per_gamma


@planar_4r.quantity(units="rad s-1", symbol="omega_4", source=f"{HAYES}, eq. (7)")
def omega4(omega1: Any, mean_ratio: Any, H: Any, kappa_per_gamma: Any, branch_sign: Any) -> Any:
    """Angular velocity of the output link."""
    return (0.5 * omega1) * (mean_ratio + branch_sign * (H * (1.0 + kappa_per_gamma)))


@planar_4r.quantity(units="rad s-1", symbol="omega_2", source=f"{HAYES}, eq. (7) for the pair 1-2")
def omega2(omega1: Any, mean_ratio: Any, H: Any, kappa_per_gamma: Any, branch_sign: Any) -> Any:
    """Angular velocity of the coupler."""
    return (0.5 * omega1) * (mean_ratio - branch_sign * (H * (1.0 - kappa_per_gamma)))


@planar_4r.quantity(units="1", symbol="gamma'/gamma", source=RATES, internal=True)
def log_rate(half_sine: Any, per_gamma: Any) -> Any:
    """Logarithmic derivative of gamma."""
    return half_sine * per_gamma


@planar_4r.quantity(units="1", symbol="T'", source=RATES, internal=True)
def mean_ratio_rate(epsilon: Any, log_rate: Any, per_gamma: Any) -> Any:
    """Derivative of the mean ratio."""
    return -(epsilon * per_gamma) * log_rate


@planar_4r.quantity(units="1", symbol="H'", source=RATES, internal=True)
def H_rate(C0: Any, Z0: Any, Z: Any, C: Any, p: Any, q: Any, per_sigma: Any) -> Any:
    """Derivative of H."""
    return 0.5 * (C0 * Z * p - Z0 * C * q) * (per_sigma * per_sigma * per_sigma)


@planar_4r.quantity(units="1", symbol="H (kappa/gamma)'", source=RATES, internal=True)
def kappa_rate(H: Any, kappa_per_gamma: Any, log_rate: Any) -> Any:
    """H times the derivative of -kappa/gamma."""
    return H * (kappa_per_gamma * log_rate)


@planar_4r.quantity(units="rad s-2", symbol="alpha_4", source=f"{HAYES}, eq. (8)")
def alpha4(
    omega1: Any, mean_ratio_rate: Any, H_rate: Any, kappa_per_gamma: Any, kappa_rate: Any, branch_sign: Any
) -> Any:
    """Angular acceleration of the output link."""
    odd = H_rate * (1.0 + kappa_per_gamma) - kappa_rate
    return (0.5 * omega1 * omega1) * (mean_ratio_rate + branch_sign * odd)


@planar_4r.quantity(units="rad s-2", symbol="alpha_2", source=f"{HAYES}, eq. (8) for the pair 1-2")
def alpha2(
    omega1: Any, mean_ratio_rate: Any, H_rate: Any, kappa_per_gamma: Any, kappa_rate: Any, branch_sign: Any
) -> Any:
    """Angular acceleration of the coupler."""
    odd = H_rate * (1.0 - kappa_per_gamma) + kappa_rate
    return (0.5 * omega1 * omega1) * (mean_ratio_rate - branch_sign * odd)

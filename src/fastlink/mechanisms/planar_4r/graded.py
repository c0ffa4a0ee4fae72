"""The reachable range of the input, graded: where to look for extremes, and the position from there.

In Z the singularities lie at 0 and Z0 below, at 1 and 1 - C0 above; the reachable range runs from the upper of the
lower two to the lower of the upper two. A place in it is two fractions of its width, `from_low` and
`from_high`, and the side of the ground line. Everything that the position facts need is then a sum of
positive terms, without any trigonometric function and without the second word of Z and C.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.catalogue.catalogue import GradedRange
from fastlink.mechanisms._shared.laws import difference, product
from fastlink.mechanisms.planar_4r.inputs import NUMERICS, planar_4r
from fastlink.mechanisms.planar_4r.residuals import IO_PRODUCTS
from fastlink.numerics.elementary import NOT_A_NUMBER, TWO_PI, atan2, select, sqrt

EXTREMES = f"{NUMERICS}#extremes"
#: Of the first sample's distance from a toggle: so close that the highest power of 1/sigma is all there is.
NEAR_TOGGLE = 2.0**-60

# Between extremes of a rate its derivative has the sign of a polynomial of degree 6 in tan^2(theta1/2): never more
# than one maximum and one minimum by branch; that of an acceleration is of degree 11: at most 5 were found.
MONOTONE = ("omega2", "omega4", "theta2", "theta4", "transmission_angle")
ACCELERATIONS = ("alpha2", "alpha4")


@planar_4r.quantity(units="1", symbol="w", source=EXTREMES, internal=True)
def range_width(
    s1: Any, s2: Any, s3: Any, s4: Any, factor_A2: Any, factor_B2: Any, factor_C2: Any, factor_D2: Any,
    Z0: Any, C0: Any, per_4_s1_s4: Any, assembles: Any,
) -> Any:  # fmt: skip
    """Width of the reachable range in Z; NaN where the design never assembles."""
    low = Z0 > 0.0
    high = C0 > 0.0
    both = 4.0 * (s2 * s3)
    width = select(
        low,
        select(high, both, factor_C2 * factor_D2),
        select(high, -(factor_A2 * factor_B2), 4.0 * (s1 * s4)),
    )
    return select(assembles == 1.0, width * per_4_s1_s4, NOT_A_NUMBER)


def above_zero(x: Any) -> Any:
    """Return x where it is positive, else 0."""
    return select(x > 0.0, x, 0.0)


def below_zero(x: Any) -> Any:
    """Return -x where x is negative, else 0."""
    return select(x < 0.0, -x, 0.0)


step = planar_4r.steps(units="1", source=EXTREMES)
step(above_zero, "Z_least", "max(Z_0, 0)", "least Z of the reachable range", x="Z0")
step(below_zero, "p_least", "max(-Z_0, 0)", "least p of the reachable range", x="Z0")
step(above_zero, "C_least", "max(C_0, 0)", "least C of the reachable range", x="C0")
step(below_zero, "q_least", "max(-C_0, 0)", "least q of the reachable range", x="C0")


def grade(near: Any, width: Any) -> Any:
    """Root of the distance to the next singularity beyond the end over that to the other end; 1 if none."""
    return select(near > 0.0, sqrt(near / (width + near)), 1.0)


@planar_4r.quantity(units="1", symbol="near", source=EXTREMES, internal=True)
def near_low(Z0: Any, gamma0: Any) -> Any:
    """Distance in Z from the lower end of the range to the next singularity below it."""
    return select(Z0 == 0.0, gamma0, abs(Z0))


@planar_4r.quantity(units="1", symbol="near", source=EXTREMES, internal=True)
def near_high(C0: Any) -> Any:
    """Distance in Z from the upper end of the range to the next singularity above it."""
    return abs(C0)


def first_place(limit: Any, scale: Any) -> Any:
    """Where samples begin: at the end of the range, or just before a toggle or fold."""
    return select(limit >= 0.0, NEAR_TOGGLE * scale, 0.0)


def first_place_low(limit: Any, scale: Any, gamma0: Any) -> Any:
    """Where samples begin at the lower end: minus that place in a kite, whose fold has no direction of AD."""
    place = NEAR_TOGGLE * scale
    return select(limit >= 0.0, select((limit == 0.0) & (gamma0 == 0.0), -place, place), 0.0)


def is_toggle(limit: Any) -> Any:
    """1 where the range ends at a toggle, else 0."""
    return select(limit > 0.0, 1.0, 0.0)


def declare_end(end: str, where: str, limit: str, first: Callable[..., Any]) -> None:
    """Declare the facts that grade the samples at one end of the range."""
    at = f"at the {where} end of the range"
    near, scale = f"near_{end}", f"scale_{end}"
    step(grade, scale, "scale", f"scale of the graded samples, {at}", near=near, width="range_width")
    step(first, f"start_{end}", "start", f"place of the first sample, {at}", limit=limit, scale=scale)
    step(is_toggle, f"toggle_{end}", "toggle", f"1 for a toggle, else 0, {at}", limit=limit)


declare_end("low", "lower", "Z0", first_place_low)
declare_end("high", "upper", "C0", first_place)

planar_4r.graded = GradedRange(
    antisymmetric=("side", "branch_sign"),
    vanishes_at_toggle="sigma",
    reciprocal="per_sigma",
    bounded_factor="sine_mu",
    cells=dict.fromkeys(MONOTONE, 16) | dict.fromkeys(ACCELERATIONS, 32),
    max_extrema=dict.fromkeys(MONOTONE, 2) | dict.fromkeys(ACCELERATIONS, 5),
    not_differentiable=(
        "loop_residual",
        "joint_angle_1",
        *(f"io_residual_{pair}" for pair in IO_PRODUCTS),
        *(f"v{k}{of}" for k in range(1, 5) for of in ("", "_dot", "_ddot")),
    ),
    wraps_at={"theta2": "AB_y", "theta4": "DB_y", "joint_angle_2": "AB_v", "joint_angle_4": "DB_y"},
    divisors={"curvature": ("curve_rate", 5)},  # (P' x P'')/|P'|^3
    turns={"load_torque": "omega4"},  # T_2 omega4 |omega4|
)


@planar_4r.quantity(units="1", symbol="2 a_1 a_4/(a_2 a_3)", source=EXTREMES, internal=True)
def sine_scale(s1: Any, s2: Any, s3: Any, s4: Any) -> Any:
    """Sine of the transmission angle over sigma."""
    return 2.0 * (s1 / s2) * (s4 / s3)


step(product, "sine_mu", "sin mu", "Sine of the transmission angle", x="sigma", y="sine_scale")


def from_end(least: Any, range_width: Any, fraction: Any) -> Any:
    """Least value and the part of the width."""
    return least + range_width * fraction


graded = planar_4r.steps(units="1", source=EXTREMES, variant="graded")
graded(from_end, "Z", "Z", "Z at a place of the graded range", least="Z_least", fraction="from_low")
graded(from_end, "p", "p", "p at a place of the graded range", least="p_least", fraction="from_low")
graded(from_end, "C", "C", "C at a place of the graded range", least="C_least", fraction="from_high")
graded(from_end, "q", "q", "q at a place of the graded range", least="q_least", fraction="from_high")


@planar_4r.quantity(units="1", symbol="sin theta_1", source=EXTREMES, internal=True, variant="graded")
def sin_theta1(side: Any, Z: Any, C: Any) -> Any:
    """Sine of the input angle."""
    return side * (2.0 * sqrt(Z * C))


graded(difference, "cos_theta1", "cos theta_1", "Cosine of the input angle", x="C", y="Z")


@planar_4r.quantity(units="rad", symbol="theta_1", source=EXTREMES, internal=True, variant="graded")
def theta1(side: Any, Z: Any, C: Any) -> Any:
    """Input angle in [0, 2 pi), rounded."""
    half_turn = 2.0 * atan2(sqrt(Z), sqrt(C))
    mirrored = select(half_turn > 0.0, TWO_PI - half_turn, 0.0)
    return select(side > 0.0, half_turn, mirrored)

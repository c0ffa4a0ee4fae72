"""Hart's linkage driven by F itself along its line: everything is explicit.

With t the height of F over MN, G - H and G + H as in `line` and K = |kappa|

    cos^2(omega/2) = (G + H - t^2)/(4 K m n),    sin^2(omega/2) = (t^2 - (G - H))/(4 K m n),

and with w = e^(i omega) the directions of MP and NQ are those of F from M and N over m - K n w and n - K m w, by (1.3)
and (1.4).
"""

from __future__ import annotations

from functools import cache
from typing import Any

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import Input
from fastlink.mechanisms._shared import laws
from fastlink.mechanisms._shared.laws import (
    ACROSS,
    ALONG,
    AB_along,
    ByOtherInput,
    M_across,
    M_along,
    across,
    along,
    mean,
    opposite_product,
    product,
    quotient,
    square_difference,
    turned,
    twice_product,
)
from fastlink.mechanisms.hart.inputs import PAGE, WUNDERLICH, hart
from fastlink.mechanisms.hart.motion import BAR_ERRORS, omega_angle
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.numerics.elementary import NOT_A_NUMBER, atan2, select, sqrt

DRIVE = f"{PAGE}#driven-along-the-line"
POSITION = f"{WUNDERLICH}, eqs. (1.2) to (1.4); {DRIVE}"

by_line = ByOtherInput(
    hart,
    f"{hart.title}, driven by F along its line",
    branches={
        1: "F to the right of the directed line from M to P: omega from 0 to pi where kappa > 0",
        2: "F to the left of the directed line from M to P: omega from -pi to 0 where kappa > 0",
    },
    position=Input("F_y", "m", "y", "height of F over MN"),
    positions=(-1.0, 1.0, 401),
    instead=("dphi_dF_y", "dpsi_dF_y"),
)
by_line.inputs = hart.inputs


step = by_line.steps(units="1", source=POSITION)
step(laws.scaled, "s_t", "t", "scaled height of F", length="F_y")


@by_line.quantity(units="1", symbol="h", source=POSITION, internal=True)
def omega_sign(branch: Any) -> Any:
    """1 in branch 1, -1 in branch 2."""
    return 3.0 - 2.0 * branch


@by_line.quantity(units="1", symbol="2 sqrt(K m n) cos(omega/2)", source=POSITION, internal=True)
def to_outer(outer_end: Any, s_t: Any) -> Any:
    """Root of G + H - t^2, scaled; NaN where F cannot be."""
    return sqrt(outer_end - abs(s_t)) * sqrt(outer_end + abs(s_t))


@by_line.quantity(units="1", symbol="2 sqrt(K m n) sin(omega/2)", source=POSITION, internal=True)
def to_inner(inner_end: Any, stays_off: Any, s_t: Any, omega_sign: Any) -> Any:
    """Root of t^2 - (G - H), scaled, with the sign of omega; NaN where F cannot be."""
    below = sqrt(abs(s_t) - inner_end) * sqrt(abs(s_t) + inner_end)
    return omega_sign * select(stays_off == 1.0, below, sqrt(s_t * s_t + inner_end * inner_end))


@by_line.quantity(units="1", symbol="2 sqrt(K m n)", source=POSITION, internal=True)
def omega_scale(to_outer: Any, to_inner: Any) -> Any:
    """Root of 4 K m n, from the two: so that the squares of sine and cosine make 1."""
    return sqrt(to_outer * to_outer + to_inner * to_inner)


step(quotient, "half_cosine", "cos(omega/2)", "cos(omega/2)", x="to_outer", y="omega_scale")
step(quotient, "half_sine", "sin(omega/2)", "sin(omega/2)", x="to_inner", y="omega_scale")
step(twice_product, "w_y", "sin omega", "Sine of omega", x="half_sine", y="half_cosine")


step(square_difference, "w_x", "cos omega", "Cosine of omega", x="half_cosine", y="half_sine")


def arm_x(own: Any, other: Any, K: Any, half_sine: Any) -> Any:
    """Component along the bar of F from its pivot, own - K other cos(omega)."""
    return (own - K * other) + 2.0 * (K * other) * (half_sine * half_sine)


def arm_y(other: Any, K: Any, w_y: Any) -> Any:
    """Component across the bar of F from its pivot."""
    return -(K * other * w_y)


def turned_x(x: Any, y: Any, arm_x: Any, arm_y: Any) -> Any:
    """Cosine of the direction that turns an arm into F as seen from the pivot."""
    size = sqrt(x * x + y * y) * sqrt(arm_x * arm_x + arm_y * arm_y)
    return (x * arm_x + y * arm_y) / size


def turned_y(x: Any, y: Any, arm_x: Any, arm_y: Any) -> Any:
    """Sine of that direction."""
    size = sqrt(x * x + y * y) * sqrt(arm_x * arm_x + arm_y * arm_y)
    return (y * arm_x - x * arm_y) / size


def from_M(line_x: Any, lift: Any, unit: Any) -> Any:
    """Where the line is, scaled, as seen from M."""
    return line_x * lift / unit


def from_N(line_x: Any, d: Any, lift: Any, unit: Any) -> Any:
    """Where the line is, scaled, as seen from N."""
    return (line_x - d) * lift / unit


step(from_M, "M_line", "x", "scaled x of the line from M")
step(arm_x, "M_arm_x", "M_arm_x", own="s_m", other="s_n")
step(arm_y, "M_arm_y", "M_arm_y", other="s_n")
step(turned_x, "u_x", "u_x", x="M_line", y="s_t", arm_x="M_arm_x", arm_y="M_arm_y")
step(turned_y, "u_y", "u_y", x="M_line", y="s_t", arm_x="M_arm_x", arm_y="M_arm_y")
step(from_N, "N_line", "x", "scaled x of the line from N")
step(arm_x, "N_arm_x", "N_arm_x", own="s_n", other="s_m")
step(arm_y, "N_arm_y", "N_arm_y", other="s_m")
step(turned_x, "v_x", "v_x", x="N_line", y="s_t", arm_x="N_arm_x", arm_y="N_arm_y")
step(turned_y, "v_y", "v_y", x="N_line", y="s_t", arm_x="N_arm_x", arm_y="N_arm_y")


# -- quantities ----------------------------------------------------------------------------------------------


def direction(x: Any, y: Any, lambda_sign: Any) -> Any:
    """Return the direction from the pivot to A or B."""
    return atan2(lambda_sign * y + 0.0, lambda_sign * x)


def rate(x: Any, y: Any, own: Any, other: Any, K: Any, w_x: Any, w_y: Any, lift: Any, unit: Any) -> Any:
    """Return the rate of a direction by the height of F."""
    # Im(w u)/(own sin(omega)) for u = z/(own - K other w), of which both lengths are that of z
    turned = x * own * w_y + y * (own * w_x - K * other)
    return turned / (x * x + y * y) / (own * w_y) * lift / unit


@by_line.quantity(units="m", symbol="F_x", source=f"{POSITION}, eq. (7.5)")
def F_x(line_x: Any, w_y: Any) -> Any:
    """Point F, x: that of its line, where the linkage assembles."""
    return select(w_y == w_y, line_x, NOT_A_NUMBER)


angle = by_line.quantities(units="rad", source=POSITION)
angle(direction, "phi", "phi", "Direction of MA in the ground frame", x="u_x", y="u_y")
angle(direction, "psi", "psi", "Direction of NB in the ground frame", x="v_x", y="v_y")
_OMEGA = hart.facts["omega_angle"].source
angle(omega_angle, "omega_angle", "omega", source=_OMEGA, sine_part="w_y", cosine_part="w_x")
joint = by_line.quantities(units="m", source=POSITION)
joint.vector(product, "P_*", "P_*", "Joint P", x="m", y="u_*")
joint.vector(product, "A_*", "A_*", "Joint A", x="a", y="u_*")
joint(along, "Q_x", "Q_x", "Joint Q, x", start="d", length="n", direction="v_x")
joint(product, "Q_y", "Q_y", "Joint Q, y", x="n", y="v_y")
joint(along, "B_x", "B_x", "Joint B, x", start="d", length="b", direction="v_x")
joint(product, "B_y", "B_y", "Joint B, y", x="b", y="v_y")
joint.vector(mean, "PF_mid_*", "PF_mid_*", "Middle of PF", x="P_*", y="F_*")
_MA, _NB = "Rate of the direction of MA by the height of F", "Rate of the direction of NB by the height of F"
turn = by_line.quantities(units="rad m-1", source=f"{PAGE}#rates-and-extremes")
turn(rate, "dphi_dF_y", "dphi_dF_y", _MA, x="M_line", y="s_t", own="s_m", other="s_n")
turn(rate, "dpsi_dF_y", "dpsi_dF_y", _NB, x="N_line", y="s_t", own="s_n", other="s_m")


@by_line.quantity(units="1", symbol="u", source=DRIVE)
def F_deviation(P_x: Any, u_x: Any, u_y: Any, w_x: Any, w_y: Any, line_x: Any, m: Any, n: Any, K: Any) -> Any:
    """Distance of the end of MP and PF as computed from the line, in units of 2^-53 (MP + PF)."""
    reached = P_x - K * n * (u_x * w_x - u_y * w_y)
    return abs(reached - line_x) / (m + K * n) / UNIT_ROUNDING


@cache
def with_facts_of_hart() -> Catalogue:
    """Return the catalogue with the facts of the design as a whole, and those that measure the bars."""
    by_line.adopt_design_facts((*BAR_ERRORS, "closure_residual"))
    return by_line


# -- Hart's linkage with AB held fixed (section 7): joints in the frame of AB, with its origin in A

# With E = u v w, the product of the directions of MP and NQ and of exp(i omega), and * for the conjugate
#
#     AB = kappa d E,   F - A = -kappa E (F - N)*,   M - A = -a E (v w)*,   N - B = -b E (u w)*.
#
# So F runs along a straight line perpendicular to AB, and is off AB |kappa| times as far as off MN.


HELD = f"{WUNDERLICH}, section 7"


@hart.quantity(units="m", symbol="x_AB", source=HELD)
def line_along_AB(K: Any, d: Any, line_x: Any) -> Any:
    """Place of the line of F in the frame of AB, from A towards B."""
    return K * (d - line_x)


def on_line(line_along_AB: Any, closes: Any) -> Any:
    """Return the place of the line where the linkage assembles."""
    return select(closes == closes, line_along_AB, NOT_A_NUMBER)


# -- driven by MA -----------------------------------------------------------------------------------------------

step = hart.steps(units="1", source=HELD)
step.vector(quotient, "e_*", "e_*", "Direction of AB", x="AB_*", y="size_c")
seen = hart.quantities(units="m", source=HELD)
MA = {"a": "size_a", "u_x": "cos_phi", "u_y": "sin_phi"}
seen(M_along, "M_along_AB", "M_AB", ALONG.format("M"), **MA)
seen(M_across, "M_across_AB", "M_AB", ACROSS.format("M"), **MA)
seen(AB_along, "N_along_AB", "N_AB", ALONG.format("N"), place="d", **MA)
seen(across, "N_across_AB", "N_AB", ACROSS.format("N"), place="d", **MA)
seen(on_line, "F_along_AB", "F_AB", ALONG.format("F"), closes="B_y")
seen(product, "F_across_AB", "F_AB", ACROSS.format("F"), x="K", y="F_y")

# -- driven by F ------------------------------------------------------------------------------------------------


def less_bar(c: Any, b: Any, uw_x: Any) -> Any:
    """Return how far N is along AB from A, by way of B."""
    return abs(c) - b * uw_x


def off_AB(K: Any, F_y: Any, w_y: Any) -> Any:
    """Return how far F is to the left of AB where the linkage assembles."""
    return select(w_y == w_y, K * F_y, NOT_A_NUMBER)


step = by_line.steps(units="1", source=HELD)
step.vector(
    turned, "uw_*", "u w", "Direction of BN turned over, seen from AB", u="u_x", v="u_y", x="w_x", y="w_y"
)
step.vector(
    turned, "vw_*", "v w", "Direction of AM turned over, seen from AB", u="v_x", v="v_y", x="w_x", y="w_y"
)
seen = by_line.quantities(units="m", source=HELD)
seen(opposite_product, "M_along_AB", "M_AB", ALONG.format("M"), x="a", y="vw_x")
seen(product, "M_across_AB", "M_AB", ACROSS.format("M"), x="a", y="vw_y")
seen(less_bar, "N_along_AB", "N_AB", ALONG.format("N"))
seen(product, "N_across_AB", "N_AB", ACROSS.format("N"), x="b", y="uw_y")
seen(on_line, "F_along_AB", "F_AB", ALONG.format("F"), closes="w_y")
seen(off_AB, "F_across_AB", "F_AB", ACROSS.format("F"))

"""Facts of the Minkowskian 4R by the paper's own symbols: A, B, C of eq. (6), the Remark's form, the coupler triangle.

A + B and A - B are 2 b times the null coordinates of AC, so that the Remark's root of A^2 - B^2 is 2 b |AC|: the limits
and null coordinates of `position` keep its digits where its own terms cancel.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import difference, total
from fastlink.mechanisms.minkowski_4r import position  # noqa: F401 (on which it builds)
from fastlink.mechanisms.minkowski_4r.flags import with_reason
from fastlink.mechanisms.minkowski_4r.inputs import HEGEDUS, NUMERICS, minkowski_4r
from fastlink.numerics.compensated import sum_of_four
from fastlink.numerics.elementary import NOT_A_NUMBER, select, sqrt
from fastlink.numerics.logarithm import arsinh
from fastlink.numerics.vectors import size_power

PRINTED = f"{NUMERICS}#the-papers-symbols"
EQUATION_6, REMARK = f"{HEGEDUS}, eq. (6)", f"{HEGEDUS}, eq. (7); {PRINTED}"
TRIANGLE = f"{HEGEDUS}, section 3.5; {PRINTED}"
REMARK_FLAGS = {
    0: "holds",
    1: "see_configuration_status",
    2: "A_not_above_the_size_of_B",
    3: "CB_past_pointing",
}
ANGLES_FLAGS = {0: "there", 1: "see_configuration_status", 2: "AX_lightlike", 3: "BX_lightlike"}

# -- eq. (6): A ch(psi) + B sh(psi) = C ------------------------------------------------------------------------------


@minkowski_4r.quantity(units="m2", symbol="A(theta)", source=EQUATION_6)
def coefficient_A(a: Any, b: Any, g: Any, cosh_theta: Any) -> Any:
    """Coefficient of ch(psi) in the constraint, 2 g b - 2 a b ch(theta)."""
    return 2.0 * b * (g - a * cosh_theta)


@minkowski_4r.quantity(units="m2", symbol="B(theta)", source=EQUATION_6)
def coefficient_B(a: Any, b: Any, sinh_theta: Any) -> Any:
    """Coefficient of sh(psi) in the constraint, 2 a b sh(theta)."""
    return 2.0 * b * (a * sinh_theta)


@minkowski_4r.quantity(units="m2", symbol="C(theta)", source=EQUATION_6)
def coefficient_C(a: Any, b: Any, g: Any, h: Any, S_r: Any, r: Any) -> Any:
    """Right-hand side of the constraint, h^2 - b^2 less the square of AC."""
    return ((h - b) * (h + b) - (g - a) * (g - a)) + 4.0 * a * g * (S_r / r)


# -- the Remark: psi = -delta ± arch(C/sqrt(A^2 - B^2)) -------------------------------------------------------------


@minkowski_4r.quantity(units="1", symbol="d", source=REMARK, internal=True)
def diagonal_root(alpha_r: Any, beta: Any, a_one: Any, r: Any) -> Any:
    """Scaled length of AC, sqrt(A^2 - B^2)/(2 b); NaN where A is at most abs(B)."""
    product = (sqrt(a_one * alpha_r) / sqrt(r)) * sqrt(a_one * beta)
    return select((alpha_r > 0.0) & (beta > 0.0), product, NOT_A_NUMBER)


@minkowski_4r.quantity(units="1", symbol="delta", source=REMARK)
def delta(s_a: Any, sinh_r: Any, r: Any, diagonal_root: Any, side: Any) -> Any:
    """Rapidity with th(delta) = B/A, that of the diagonal AC but for its sign; NaN where A is at most abs(B)."""
    return side * arsinh(s_a * sinh_r / r / diagonal_root)


@minkowski_4r.quantity(units="1", symbol="psi", source=REMARK)
def psi_remark(
    delta: Any,
    diagonal_root: Any,
    outside: Any,
    product_one: Any,
    r: Any,
    s_b: Any,
    s_h: Any,
    branch_sign: Any,
) -> Any:
    """Output angle by the Remark's closed form; NaN where it has none, though the loop may close."""
    # 4 b d sh^2(arch/2) = (h - b - d)(h + b + d) with d = |AC|, and (h - b - d)(h - b + d) = 4 a g Q.
    ratio = ((s_h + s_b) + diagonal_root) / ((s_h - s_b) + diagonal_root)
    half = sqrt(product_one * (outside / r) / s_b) * sqrt(0.5 * ratio / diagonal_root)
    return select((s_h > s_b) & (outside >= 0.0), branch_sign * (2.0 * arsinh(half)) - delta, NOT_A_NUMBER)


@minkowski_4r.quantity(units="1", symbol="remark", source=REMARK, internal=True)
def remark_code(psi_remark: Any, delta: Any) -> Any:
    """0 where the Remark's form holds, 2 where A is not above abs(B), 3 where it is, with roots past-pointing."""
    return select(psi_remark == psi_remark, 0.0, select(delta == delta, 3.0, 2.0))


_FLAG = minkowski_4r.quantities(units="1", source=REMARK, flags=REMARK_FLAGS)
_FLAG(
    with_reason,
    "remark_status",
    "remark",
    "Whether the Remark's closed form of psi holds",
    code="remark_code",
)

# -- the coupler triangle XAB ------------------------------------------------------------------------------------


def end_sum(x: Any, y: Any, h: Any) -> Any:
    """Return x - h + y, rounded once: BX may be nearly lightlike."""
    high, _low = sum_of_four(x, -h, y, 0.0)
    return high


def end_difference(x: Any, y: Any, h: Any) -> Any:
    """Return x - h - y, rounded once."""
    high, _low = sum_of_four(x, -h, -y, 0.0)
    return high


def modulus(u: Any, v: Any) -> Any:
    """Return the length of a vector by its null coordinates."""
    size = size_power(u, v)
    return size * sqrt(abs((u / size) * (v / size)))


def frame_rapidity(x: Any, y: Any, length: Any) -> Any:
    """Return the rapidity of a vector from the axis of its causal type; NaN of a lightlike one."""
    size = arsinh(select(abs(x) < abs(y), abs(x), abs(y)) / select(length > 0.0, length, NOT_A_NUMBER))
    return select((x < 0.0) == (y < 0.0), size, -size)


step, number = (
    declare(units="m", source=TRIANGLE) for declare in (minkowski_4r.steps, minkowski_4r.quantities)
)
step(difference, "BX_along", "x - h", "Coupler point along AB from B", x="x", y="h")
step(total, "AX_null_1", "x + y", "First null coordinate of AX against AB")
step(difference, "AX_null_2", "x - y", "Second null coordinate of AX against AB")
step(end_sum, "BX_null_1", "x - h + y", "First null coordinate of BX against AB")
step(end_difference, "BX_null_2", "x - h - y", "Second null coordinate of BX against AB")
number(
    modulus, "r_AX", "r", "Hyperbolic length of AX, whatever its causal type", u="AX_null_1", v="AX_null_2"
)
number(
    modulus, "s_BX", "s", "Hyperbolic length of BX, whatever its causal type", u="BX_null_1", v="BX_null_2"
)
step, number = (
    declare(units="1", source=TRIANGLE) for declare in (minkowski_4r.steps, minkowski_4r.quantities)
)
step(frame_rapidity, "AX_frame_rapidity", "AX", "Rapidity of AX against AB", x="x", y="y", length="r_AX")
step(
    frame_rapidity, "BX_frame_rapidity", "BX", "Rapidity of BX against AB", x="BX_along", y="y", length="s_BX"
)
_LIGHT = "NaN where it is lightlike"
number(total, "lambda_AX", "lambda", f"Rapidity of AX; {_LIGHT}", x="AB_rapidity", y="AX_frame_rapidity")
number(total, "mu_BX", "mu", f"Rapidity of BX; {_LIGHT}", x="AB_rapidity", y="BX_frame_rapidity")


@minkowski_4r.quantity(units="1", symbol="gamma", source=TRIANGLE)
def gamma(x: Any, y: Any, h: Any, BX_along: Any, r_AX: Any, s_BX: Any) -> Any:
    """Angle from AX to BX, mu - lambda; NaN where one of them is lightlike."""
    # r s ch(gamma) and r s sh(gamma), exchanged where one is spacelike and the other timelike
    product, moment = x * BX_along - y * y, h * y
    less = select(abs(product) < abs(moment), abs(product), abs(moment))
    there = (r_AX > 0.0) & (s_BX > 0.0)
    size = arsinh((less / select(there, r_AX, NOT_A_NUMBER)) / s_BX)
    return select((product < 0.0) == (moment < 0.0), size, -size)


@minkowski_4r.quantity(units="1", symbol="angles", source=TRIANGLE, internal=True)
def coupler_angles_code(r_AX: Any, s_BX: Any, AB_rapidity: Any) -> Any:
    """0 where AX and BX have rapidities, else the number of the reason."""
    light = select(r_AX == 0.0, 2.0, select(s_BX == 0.0, 3.0, 0.0))
    return select(AB_rapidity == AB_rapidity, light, 1.0)


_FLAG = minkowski_4r.quantities(units="1", source=TRIANGLE, flags=ANGLES_FLAGS)
_FLAG(
    with_reason, "coupler_angles_status", "angles", "Why lambda_AX or mu_BX is not a finite number",
    code="coupler_angles_code",
)  # fmt: skip

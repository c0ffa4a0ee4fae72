"""Facts of the Minkowskian 4R in the words of the paper: its angles, points in the ground frame, status."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastlink.mechanisms._shared.laws import product
from fastlink.mechanisms.minkowski_4r import position  # noqa: F401 (on which it builds)
from fastlink.mechanisms.minkowski_4r.inputs import HEGEDUS, NUMERICS, minkowski_4r
from fastlink.numerics.elementary import INFINITY, NOT_A_NUMBER, PI, select, sqrt
from fastlink.numerics.logarithm import arsinh, log_quotient

POSITION = f"{NUMERICS}#position"
# Beyond it 2 arsinh(sqrt(x/2)) is log(2 x) to rounding.
GREAT = 2.0**100
CONFIGURATION_FLAGS = {
    0: "closes",
    1: "does_not_close",
    2: "root_at_infinity",
    3: "undetermined",
    4: "at_a_limit",
    5: "beyond_the_range_of_numbers",
    6: "invalid_input",
    7: "closes_zeta_undefined",
    8: "closes_half_angle_root_infinite",
    9: "closes_zeta_undefined_half_angle_root_infinite",
}


@minkowski_4r.quantity(units="1", symbol="th(psi/2)", source=f"{HEGEDUS}, eq. (3); {POSITION}")
def half_angle_root(CB_ratio: Any, CB_scale: Any, side: Any) -> Any:
    """Root of the tan-half-angle quadratic: th(psi/2), or its reciprocal where CB is past-pointing."""
    below = CB_ratio + CB_scale
    return select(below == 0.0, INFINITY, side * (CB_ratio - CB_scale) / select(below == 0.0, 1.0, below))


@minkowski_4r.quantity(units="1", symbol="phi", source=f"{HEGEDUS}, Theorem 3.5")
def phi(AB_ratio: Any, AB_takes_sum: Any, p_r: Any, twos: Any, side: Any) -> Any:
    """Coupler angle as printed: rapidity of AB less theta, plus pi."""
    return side * log_quotient(AB_ratio, p_r, select(AB_takes_sum == 1.0, 0.0, -twos)) + PI


@minkowski_4r.quantity(units="1", symbol="r (ch(zeta) - 1)", source=POSITION, internal=True)
def zeta_excess(outside: Any, product_one: Any, s_b: Any, s_h: Any) -> Any:
    """Hyperbolic cosine of the transmission angle less 1, times r."""
    return product_one * outside / s_b / s_h


@minkowski_4r.quantity(units="1", symbol="ch(zeta)", source=f"{HEGEDUS}, Theorem 3.6; {POSITION}")
def cosh_zeta(inside: Any, zeta_excess: Any, product_one: Any, s_b: Any, s_h: Any, r: Any) -> Any:
    """Hyperbolic cosine of the transmission angle; negative inside the inner limit, where no angle has it."""
    past = -1.0 - product_one * inside / s_b / s_h / r
    found = select(inside >= 0.0, past, select(zeta_excess >= 0.0, 1.0 + zeta_excess / r, NOT_A_NUMBER))
    return select(abs(found) < INFINITY, found, NOT_A_NUMBER)


@minkowski_4r.quantity(units="1", symbol="zeta", source=f"{HEGEDUS}, Theorem 3.6; {POSITION}")
def zeta(zeta_excess: Any, r: Any, twos: Any) -> Any:
    """Transmission angle: between the coupler and the output crank; NaN inside the inner limit."""
    great = zeta_excess > GREAT * r
    return select(
        great, log_quotient(2.0 * zeta_excess, 1.0, twos), 2.0 * arsinh(sqrt(0.5 * (zeta_excess / r)))
    )


# -- points ------------------------------------------------------------------------------------------------------


def finite(x: Any) -> Any:
    """Return x; NaN where it is beyond the range of numbers."""
    return select(abs(x) < INFINITY, x, NOT_A_NUMBER)


def first(offset: Any, along_u: Any, along_v: Any, u: Any, v: Any, side: Any) -> Any:
    """Return the first coordinate of a point from null coordinates."""
    return offset + 0.5 * (along_u * u + along_v * v)


def second(offset: Any, along_u: Any, along_v: Any, u: Any, v: Any, side: Any) -> Any:
    """Return the second coordinate."""
    return offset + side * (0.5 * (along_u * u - along_v * v))


@minkowski_4r.quantity(units="m", symbol="x + y", source=POSITION, internal=True)
def X_along_u(x: Any, y: Any, side: Any) -> Any:
    """First null coordinate of the coupler point in the coupler's frame, for abs(theta)."""
    return x + side * y


@minkowski_4r.quantity(units="m", symbol="x - y", source=POSITION, internal=True)
def X_along_v(x: Any, y: Any, side: Any) -> Any:
    """Second null coordinate of the coupler point in the coupler's frame, for abs(theta)."""
    return x - side * y


@minkowski_4r.quantity(units="m", symbol="C_y", source=POSITION, internal=True)
def C_y(g: Any) -> Any:
    """Ground pivot C, second coordinate."""
    return 0.0 * g


def declare_coordinate(name: str, meaning: str, equation: str, law: Callable[..., Any], **given: str) -> None:
    """Declare a coordinate of a point, and the same beyond the range of numbers."""
    point, source = f"point_{name}", f"{HEGEDUS}, {equation}; {POSITION}"
    minkowski_4r.steps(units="m", source=source)(law, point, name, f"{meaning}, whatever its size", **given)
    minkowski_4r.quantities(units="m", source=source)(finite, name, name, meaning, x=point)


_B = {"along_u": "b", "along_v": "b", "u": "CB_far", "v": "CB_v"}
_X = {"along_u": "X_along_u", "along_v": "X_along_v", "u": "AB_far", "v": "AB_v"}
declare_coordinate("A_x", "Moving pivot A, first coordinate", "eq. (5)", product, x="a", y="cosh_theta")
declare_coordinate("A_y", "Moving pivot A, second coordinate", "eq. (5)", product, x="a", y="sinh_theta")
declare_coordinate("B_x", "Moving pivot B, first coordinate", "eq. (5)", first, offset="g", **_B)
declare_coordinate("B_y", "Moving pivot B, second coordinate", "eq. (5)", second, offset="C_y", **_B)
declare_coordinate("X_x", "Coupler point X, first coordinate", "section 3.5", first, offset="point_A_x", **_X)
declare_coordinate(
    "X_y", "Coupler point X, second coordinate", "section 3.5", second, offset="point_A_y", **_X
)


# -- residual and status -----------------------------------------------------------------------------------------


@minkowski_4r.quantity(units="1", symbol="e", source=POSITION)
def loop_residual(
    s_a: Any, s_b: Any, s_g: Any, s_h: Any, p_r: Any, per_p: Any, r: Any, AB_u: Any, AB_v: Any, CB_u: Any,
    CB_v: Any,
) -> Any:  # fmt: skip
    """Closure error of the loop in null coordinates, relative to the sizes of its terms."""
    u_terms = (s_a * p_r + s_h * abs(AB_u)) + (s_g * r + s_b * abs(CB_u))
    v_terms = (s_a * per_p + s_h * abs(AB_v)) + (s_g + s_b * abs(CB_v))
    e_u = ((s_a * p_r - s_g * r) + (s_h * AB_u - s_b * CB_u)) / u_terms
    e_v = ((s_a * per_p - s_g) + (s_h * AB_v - s_b * CB_v)) / v_terms
    return sqrt(e_u * e_u + e_v * e_v)


@minkowski_4r.quantity(
    units="1", symbol="configuration", source=f"{NUMERICS}#configurations", flags=CONFIGURATION_FLAGS
)
def configuration_status(
    half_root: Any, CB_orientation: Any, AB_orientation: Any, CB_ratio: Any, CB_scale: Any, AB_ratio: Any,
    CB_half: Any, alpha_r: Any, beta: Any, inside: Any, B_x: Any, A_x: Any, cosh_zeta: Any,
    loop_residual: Any, valid: Any,
) -> Any:  # fmt: skip
    """Whether the loop closes in this configuration, and why a quantity of it is not a finite number."""
    escaped = CB_orientation * AB_orientation == 0.0
    lightlike = (alpha_r == 0.0) | (beta == 0.0)
    pins_coincide = (alpha_r == 0.0) & (beta == 0.0) & (CB_half == 0.0)
    ratios = (CB_ratio == CB_ratio) & (AB_ratio == AB_ratio) & (loop_residual == loop_residual)
    small = (A_x == A_x) & (B_x == B_x) & (cosh_zeta == cosh_zeta) & ratios
    code = select(inside >= 0.0, 7.0, 0.0) + select(CB_ratio + CB_scale == 0.0, 8.0, 0.0)
    code = select(code == 15.0, 9.0, code)
    code = select(half_root == 0.0, 4.0, code)
    code = select(small, code, 5.0)
    code = select(escaped, select(pins_coincide, 3.0, select(lightlike, 2.0, 5.0)), code)
    code = select(half_root == half_root, code, 1.0)
    return select(valid == 1.0, code, 6.0)

"""The four-bar MABN of Hart's linkage, driven by MA: a planar 4R, whose position and graded range it reuses.

Its toggles are those of `design_facts`, in which lambda is divided out, as it is here where lengths are over lengths.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import product, size
from fastlink.mechanisms._shared.reuse import KNOWN_OF_MABN, borrow, borrow_range, borrow_tables
from fastlink.mechanisms.hart.design_facts import NUMERICS
from fastlink.mechanisms.hart.inputs import WUNDERLICH, hart
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.numerics.compensated import pair_product, sum_of_four, two_product
from fastlink.numerics.elementary import NOT_A_NUMBER, select

PLANAR = "docs/numerics.md"
POSITION = f"{WUNDERLICH}, eqs. (1.2) to (1.4); {NUMERICS}"


length = hart.steps(units="m", source=NUMERICS)
length(size, "size_a", "size_a", "length MA", x="a")
length(size, "size_b", "size_b", "length NB", x="b")
length(size, "size_c", "size_c", "length AB", x="c")
step = hart.steps(units="1", source=NUMERICS)
step(product, "s_a", "s_a", "scaled length MA", x="size_lambda", y="s_m")
step(product, "s_b", "s_b", "scaled length NB", x="size_lambda", y="s_n")
step(product, "s_c", "s_c", "scaled length AB", x="K", y="s_d")


@hart.quantity(units="1", symbol="MN - MA", source=NUMERICS, internal=True)
def ground_excess(s_d: Any, s_m: Any, size_lambda: Any, size_lambda_low: Any) -> Any:
    """Length MN less MA, scaled, right to a rounding."""
    arm, arm_low = pair_product(size_lambda, size_lambda_low, s_m, 0.0)
    total, _low = sum_of_four(s_d, -arm, -arm_low, 0.0)
    return total


@hart.quantity(units="1", symbol="AB - NB", source=NUMERICS, internal=True)
def coupler_excess(K: Any, s_d: Any, s_n: Any, size_lambda: Any, size_lambda_low: Any) -> Any:
    """Length AB less NB, scaled, right to a rounding."""
    coupler, coupler_low = two_product(K, s_d)
    arm, arm_low = pair_product(size_lambda, size_lambda_low, s_n, 0.0)
    total, _low = sum_of_four(coupler, coupler_low, -arm, -arm_low)
    return total


@hart.quantity(units="1", symbol="-2 delta", source=f"{PLANAR}#position", internal=True)
def output_offset(s_n: Any, coupler_excess: Any, s_m: Any, s_d: Any) -> Any:
    """NB (AB - NB)/(2 MA MN), lambda divided out."""
    return (s_n * coupler_excess) / (2.0 * (s_m * s_d))


@hart.quantity(units="1", symbol="2 beta", source=f"{PLANAR}#position", internal=True)
def coupler_offset(K: Any, coupler_excess: Any, s_a: Any) -> Any:
    """AB (AB - NB)/(2 MA MN), MN divided out."""
    return (K * coupler_excess) / (2.0 * s_a)


@hart.quantity(units="1", symbol="gamma_0", source=f"{PLANAR}#rates", internal=True)
def gamma0(ground_excess: Any, s_a: Any, s_d: Any) -> Any:
    """(MN - MA)^2/(4 MA MN): squared distance of A and N over 4 MA MN, at phi = 0."""
    return ground_excess * ground_excess / (4.0 * (s_a * s_d))


@hart.quantity(units="1", symbol="lambda", source=f"{PLANAR}#rates", internal=True)
def crank_excess(ground_excess: Any, s_d: Any) -> Any:
    """(MA - MN)/(2 MN)."""
    return -(0.5 * ground_excess) / s_d


@hart.quantity(units="1", symbol="kappa", source=f"{PLANAR}#rates", internal=True)
def squares_excess(coupler_excess: Any, s_b: Any, s_c: Any, s_a: Any, s_d: Any) -> Any:
    """(AB^2 - NB^2)/(4 MA MN)."""
    return coupler_excess * (s_c + s_b) / (4.0 * (s_a * s_d))


@hart.quantity(units="m", symbol="AN_x", source=f"{PLANAR}#position", internal=True)
def AN_x(ground_excess: Any, size_a: Any, Z: Any, lift: Any, unit: Any) -> Any:
    """Vector from A to N, x."""
    return ground_excess * unit / lift + 2.0 * size_a * Z


@hart.quantity(units="1", symbol="w", source=f"{PLANAR}#extremes", internal=True)
def range_width(
    far_sum_less: Any, far_sum_plus: Any, near_difference_less: Any, near_difference_plus: Any, Z0: Any,
    C0: Any, s_m: Any, s_n: Any, e: Any, K: Any, assembles: Any,
) -> Any:  # fmt: skip
    """Width of the reachable range of phi in Z; NaN where the design never assembles."""
    to_pi = far_sum_plus * near_difference_plus / (4.0 * (s_m * e))
    from_0 = -(far_sum_less * near_difference_less) / (4.0 * (s_m * e))
    high = C0 > 0.0
    width = select(Z0 > 0.0, select(high, K * (s_n / s_m), to_pi), select(high, from_0, 1.0))
    return select(assembles == 1.0, width, NOT_A_NUMBER)


def near_factor(K: Any, lambda_sign: Any, reach: Any) -> Any:
    """Return a factor of MABN that has 1 + K as a factor, from the other one."""
    return (1.0 + K) * (lambda_sign * reach)


def far_factor(K: Any, reach: Any) -> Any:
    """Return a factor of MABN that has 1 - K as a factor, from the other one; with its size."""
    return abs(1.0 - K) * reach


for _law, _name, _reach in (
    (near_factor, "sure_A1", "near_sum_less"),
    (near_factor, "factor_B2", "near_difference_less"),
    (near_factor, "factor_C2", "near_difference_plus"),
    (far_factor, "factor_A2", "far_sum_less"),
    (far_factor, "factor_D2", "far_sum_plus"),
    (far_factor, "sure_B1", "far_difference_less"),
    (far_factor, "sure_C1", "far_difference_plus"),
):
    _letters = f"{_name[-2]}_{_name[-1]}"
    step(_law, _name, _letters, f"factor {_name[-2:]} of MABN, zero within rounding", reach=_reach)

PREFIX = "bar_"
#: The names of MABN's values as a planar 4R.
NAMES = {"a1": "size_a", "a2": "size_c", "a3": "size_b", "a4": "d"}
NAMES |= {"s1": "s_a", "s2": "s_c", "s3": "s_b", "s4": "s_d"}
NAMES |= {"theta1": "phi", "cos_theta1": "cos_phi", "sin_theta1": "sin_phi", "p": "past_Z0", "q": "past_C0"}
NAMES |= {"DB_x": "NB_x", "DB_y": "B_y", "theta4": "psi", "output_ratio": "dpsi_dphi"}
NAMES |= {
    name: name
    for name in ("sure_A1", "sure_B1", "sure_C1", "factor_A2", "factor_B2", "factor_C2", "factor_D2")
}
NAMES |= {
    name: name for name in ("Z", "Z_low", "C", "C_low", "Z0", "Z0_low", "C0", "C0_low", "sigma", "per_sigma")
}
NAMES |= {
    name: name
    for name in ("coupler_offset", "branch_sign", "output_offset", "gamma0", "crank_excess", "range_width")
}
NAMES |= {"kappa": "squares_excess", "AD_x": "AN_x", "assembles": "assembles", "valid": "valid"}
NAMES |= {name: name for name in ("A_x", "A_y", "AB_x", "AB_y", "grashof_class")}

borrow_tables(hart, planar_4r, NAMES)

LABELS: dict[str, dict[str, Any]] = {
    "A_x": {"source": POSITION},
    "A_y": {"source": POSITION},
    "AB_x": {},
    "AB_y": {},
    "DB_y": {"symbol": "B_y", "meaning": "Joint B, y", "source": POSITION, "internal": False},
    "theta4": {"symbol": "psi", "meaning": "Direction of NB in the ground frame", "source": POSITION},
    "output_ratio": {
        "symbol": "dpsi/dphi",
        "meaning": "Rate of the direction of NB by that of MA",
        "source": f"{WUNDERLICH}, eq. (2.4), differentiated",
        "internal": False,
    },
    "grashof_class": {
        "meaning": "Type of the four-bar MABN, with the crank MA, the coupler AB and the output link NB"
    },
}
borrow(hart, planar_4r, NAMES, PREFIX, LABELS)

assert planar_4r.graded is not None
borrow_range(
    hart,
    planar_4r,
    NAMES,
    PREFIX,
    cells={"psi": planar_4r.graded.cells["theta4"], "dpsi_dphi": planar_4r.graded.cells["omega4"]},
    max_extrema={
        "psi": planar_4r.graded.max_extrema["theta4"],
        "dpsi_dphi": planar_4r.graded.max_extrema["omega4"],
    },
    known=KNOWN_OF_MABN,
    not_differentiable=("F_x", "F_along_AB", "F_deviation", "closure_residual"),
    wraps_at={"psi": "B_y", "omega_angle": "sine_part"},
)

"""Types of one design of the Minkowskian 4R, and its assemblies under the paper's standing assumption.

The types are those of Theorems 3.9 to 3.22, by exact signs of the T_i: they decide where the loop closes at all. The
paper supposes that OA and CB are future-pointing; where that is so is another matter, the subject of the facts with
`future` in their names. docs/minkowski_theorems.md lists the theorems whose words need one or the other.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.minkowski_4r.inputs import HEGEDUS, minkowski_4r
from fastlink.mechanisms.minkowski_4r.limits import THEOREMS
from fastlink.numerics.elementary import NOT_A_NUMBER, select
from fastlink.numerics.vectors import sign

FUTURE = f"{THEOREMS}#future-pointing-assemblies"
CRANK_FLAGS = {0: "crank", 1: "rocker", 2: "superrocker", 3: "invalid_input"}
# 4 kind + 2 (the input is not a crank) + (the output is not a crank)
LINKAGE_FLAGS = {
    0: "strange_crank_crank",
    1: "strange_crank_superrocker",
    2: "strange_superrocker_crank",
    3: "strange_superrocker_superrocker",
    4: "rigid_crank_crank",
    5: "rigid_crank_rocker",
    6: "rigid_rocker_crank",
    7: "rigid_rocker_rocker",
    8: "reducible_crank_crank",
    9: "reducible_crank_rocker",
    12: "irreducible_crank_crank",
    13: "irreducible_crank_rocker",
    14: "irreducible_rocker_crank",
    15: "irreducible_rocker_rocker",
    16: "invalid_input",
}
GRASHOF_FLAGS = {0: "l_plus_s_below_p_plus_q", 1: "l_plus_s_at_least_p_plus_q", 2: "invalid_input"}


@minkowski_4r.quantity(units="1", symbol="input", source=f"{HEGEDUS}, Theorem 3.9", flags=CRANK_FLAGS)
def input_type(sign_T1: Any, sign_T2: Any, sign_T3: Any, sign_T4: Any, sums_are_valid: Any) -> Any:
    """How the input crank moves where CB may point either way."""
    outer = select(sign(sign_T1) * sign(sign_T2) < 0.0, 1.0, 0.0)
    code = select(sign(sign_T3) * sign(sign_T4) > 0.0, 2.0, outer)
    return select(sums_are_valid == 1.0, code, 3.0)


@minkowski_4r.quantity(units="1", symbol="output", source=f"{HEGEDUS}, Theorem 3.11", flags=CRANK_FLAGS)
def output_type(sign_T1: Any, sign_T4: Any, sign_T5: Any, sums_are_valid: Any) -> Any:
    """How the output crank moves where OA may point either way."""
    outer = select(sign_T1 < 0.0, 1.0, 0.0)
    code = select(sign(sign_T4) * sign(sign_T5) < 0.0, 2.0, outer)
    return select(sums_are_valid == 1.0, code, 3.0)


@minkowski_4r.quantity(
    units="1", symbol="type", source=f"{HEGEDUS}, Theorems 3.12 to 3.22, Tables 1 to 3", flags=LINKAGE_FLAGS
)
def linkage_type(
    sign_T1: Any, sign_T2: Any, sign_T3: Any, sign_T4: Any, sign_T5: Any, sign_T6: Any, input_type: Any,
    output_type: Any, sums_are_valid: Any,
) -> Any:  # fmt: skip
    """Strange, rigid, reducible or irreducible, and the motions of input and output."""
    strange = (sign_T3 > 0.0) | (sign_T4 < 0.0) | (sign_T5 < 0.0) | (sign_T6 < 0.0)
    rigid = (sign_T3 == 0.0) | (sign_T4 == 0.0) | (sign_T5 == 0.0) | (sign_T6 == 0.0)
    reducible = (sign_T1 == 0.0) | (sign_T2 == 0.0)
    kind = select(strange, 0.0, select(rigid, 4.0, select(reducible, 8.0, 12.0)))
    code = kind + (select(input_type > 0.0, 2.0, 0.0) + select(output_type > 0.0, 1.0, 0.0))
    return select(sums_are_valid == 1.0, code, 16.0)


@minkowski_4r.quantity(units="1", symbol="Grashof", source=f"{HEGEDUS}, section 3.6", flags=GRASHOF_FLAGS)
def grashof(sign_T1: Any, sign_T2: Any, sign_T8: Any, sums_are_valid: Any) -> Any:
    """Grashof's criterion with the reversed triangle inequality: longest plus shortest against the other two."""
    # Each has b with one other link against the rest. If b is l or s, the two that do not pair l with s have one sign
    # and the third is l + s - p - q; if b is p or q, they have two signs and the third is p + q - l - s.
    criterion = sign(sign_T1) * sign(sign_T2) * sign(sign_T8) >= 0.0
    return select(sums_are_valid == 1.0, select(criterion, 1.0, 0.0), 2.0)


# -- future-pointing assemblies -------------------------------------------------------------------------------


@minkowski_4r.quantity(units="1", symbol="outer", source=FUTURE, internal=True)
def outer_range_points_ahead(sure_g_minus_a: Any, sure_b_minus_h: Any) -> Any:
    """1 where (g - a)(h - b) > 0: CB points to the future in both branches from theta_max to theta_escape."""
    return select(sign(sure_g_minus_a) * sign(sure_b_minus_h) < 0.0, 1.0, 0.0)


@minkowski_4r.quantity(units="1", symbol="through 0", source=FUTURE, internal=True)
def crosses_theta_0(outer_range_points_ahead: Any, pins_may_coincide: Any, sign_T1: Any, sign_T2: Any) -> Any:
    """1 where every theta has a future-pointing assembly, else 0."""
    ahead = (outer_range_points_ahead == 1.0) & (sign(sign_T1) * sign(sign_T2) >= 0.0)
    return select(ahead | (pins_may_coincide == 1.0), 1.0, 0.0)


@minkowski_4r.quantity(units="1", symbol="N", source=FUTURE)
def assembly_count_future(crosses_theta_0: Any, sign_T4: Any, sums_are_valid: Any) -> Any:
    """Number of intervals of theta with a future-pointing assembly, isolated angles not counted."""
    apart = select(sign_T4 < 0.0, 3.0, 2.0)
    count = select(crosses_theta_0 == 1.0, 1.0, apart)
    return select(sums_are_valid == 1.0, count, NOT_A_NUMBER)


@minkowski_4r.quantity(units="1", symbol="theta_{min}", source=FUTURE)
def theta_min_future(theta_min: Any, sign_T4: Any) -> Any:
    """Greatest |theta| of the inner range with a future-pointing assembly; NaN where there is no such range."""
    return select(sign_T4 < 0.0, theta_min, NOT_A_NUMBER)


@minkowski_4r.quantity(units="1", symbol="theta_{max}", source=FUTURE)
def theta_max_future(
    theta_max: Any, theta_escape: Any, outer_range_points_ahead: Any, crosses_theta_0: Any
) -> Any:
    """Least |theta| of the outer ranges with a future-pointing assembly; NaN where 0 is between them."""
    limit = select(outer_range_points_ahead == 1.0, theta_max, theta_escape)
    return select(crosses_theta_0 == 1.0, NOT_A_NUMBER, limit)


@minkowski_4r.quantity(units="1", symbol="psi_{min}", source=FUTURE)
def psi_min_future(psi_min: Any, sign_T4: Any) -> Any:
    """Greatest |psi| of the inner range with OA pointing to the future; NaN where there is no such range."""
    return select(sign_T4 < 0.0, psi_min, NOT_A_NUMBER)

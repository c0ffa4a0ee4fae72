"""Facts of one design of Hart's linkage: its bars, where the line is and how much of it F traces, the kite.

With t = y of F, eqs. (1.5) say t^2 = G - H cos(omega), H = 2 K m n, and G - H and G + H are products of reaches less d:
F runs from one end of its segment to the other and back while omega turns. Where G > H the segment does not reach the
line MN, and there is a second one, its mirror image.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms.hart import design_facts  # noqa: F401 (on which it builds)
from fastlink.mechanisms.hart.inputs import PAGE, WUNDERLICH, hart
from fastlink.numerics.elementary import NOT_A_NUMBER, select, sqrt

STROKE = f"{PAGE}#stroke"
KITE = f"{WUNDERLICH}, eq. (7.6)"
STATUS_FLAGS = {
    0: "one_segment",
    1: "two_segments",
    2: "change_point",
    3: "rigid",
    4: "never_assembles",
    5: "kappa_is_0",
    6: "kappa_is_1_or_minus_1",
    7: "invalid_input",
}
KITE_FLAGS = {0: "no", 1: "kite_with_m_equal_p", 2: "kite_with_n_equal_q"}


@hart.quantity(units="1", symbol="lambda", source=f"{WUNDERLICH}, eq. (7.3)")
def lambda_(lambda_sign: Any, size_lambda: Any, valid: Any) -> Any:
    """Factor a/m = b/n, 1 - kappa^2: negative where A and P lie on opposite sides of M."""
    return select(valid == 1.0, lambda_sign * size_lambda, NOT_A_NUMBER)


def ratio_times(ratio: Any, length: Any, valid: Any) -> Any:
    """Return ratio times length."""
    return select(valid == 1.0, ratio * length, NOT_A_NUMBER)


def minus_ratio_times(ratio: Any, length: Any, valid: Any) -> Any:
    """Return minus ratio times length."""
    return select(valid == 1.0, -(ratio * length), NOT_A_NUMBER)


length = hart.quantities(units="m", source=f"{WUNDERLICH}, eq. (7.2)")
_KAPPA, _LAMBDA = {"ratio": "kappa"}, {"ratio": "lambda_"}
length(ratio_times, "p", "p", "Length of PF, kappa n, with the sign of kappa", **_KAPPA, length="n")
length(minus_ratio_times, "q", "q", "Length of QF, -kappa m, with the sign of -kappa", **_KAPPA, length="m")
length = hart.quantities(units="m", source=f"{WUNDERLICH}, eq. (7.4)")
length(
    ratio_times, "a", "a", "Length of MA along MP: negative on the extension beyond M", **_LAMBDA, length="m"
)
length(
    ratio_times, "b", "b", "Length of NB along NQ: negative on the extension beyond N", **_LAMBDA, length="n"
)
length(ratio_times, "c", "c", "Length of AB, kappa d, with the sign of kappa", **_KAPPA, length="d")


@hart.quantity(
    units="m", symbol="x", source=f"{WUNDERLICH}, eq. (7.5), corrected: {PAGE}#where-the-paper-differs"
)
def line_x(m: Any, lambda_sign: Any, Z0: Any, Z0_low: Any, C0: Any, C0_low: Any, assembles: Any) -> Any:
    """Where the line of F crosses MN, from M: d/2 + (1 - kappa^2)(m^2 - n^2)/(2 d)."""
    return select(assembles == 1.0, lambda_sign * m * ((C0 - Z0) + (C0_low - Z0_low)), NOT_A_NUMBER)


# -- the stroke -----------------------------------------------------------------------------------------------


@hart.quantity(units="1", symbol="sqrt(G + H)", source=STROKE, internal=True)
def outer_end(far_sum_excess: Any, near_difference_excess: Any, s_d: Any) -> Any:
    """Root of G + H, scaled; NaN where the linkage never assembles."""
    return 0.5 * (sqrt(far_sum_excess) * sqrt(-near_difference_excess) / s_d)


@hart.quantity(units="1", symbol="sqrt|G - H|", source=STROKE, internal=True)
def inner_end(near_sum_excess: Any, far_difference_excess: Any, s_d: Any) -> Any:
    """Root of the size of G - H, scaled."""
    return 0.5 * (sqrt(abs(near_sum_excess)) * sqrt(abs(far_difference_excess)) / s_d)


@hart.quantity(units="1", symbol="G > H", source=STROKE, internal=True)
def stays_off(near_sum_excess: Any, far_difference_excess: Any) -> Any:
    """1 where F does not reach MN, else 0."""
    return select((near_sum_excess < 0.0) != (far_difference_excess < 0.0), 1.0, 0.0)


@hart.quantity(units="m", symbol="y_{outer}", source=STROKE)
def F_y_outer(outer_end: Any, lift: Any, unit: Any, assembles: Any) -> Any:
    """Greatest distance of F from MN, where MPF and NQF are stretched; as far on the other side."""
    return select(assembles == 1.0, outer_end * unit / lift, NOT_A_NUMBER)


@hart.quantity(units="m", symbol="y_{inner}", source=STROKE)
def F_y_inner(inner_end: Any, stays_off: Any, lift: Any, unit: Any, assembles: Any) -> Any:
    """Least distance of F from MN, where MPF and NQF are folded; 0 where its line is traced across MN."""
    height = select(stays_off == 1.0, inner_end * unit / lift, 0.0)
    return select(assembles == 1.0, height, NOT_A_NUMBER)


@hart.quantity(units="m", symbol="stroke", source=STROKE)
def stroke(F_y_outer: Any, F_y_inner: Any, m: Any, n: Any, K: Any) -> Any:
    """Length of the line that F traces without disassembly."""
    # the squares of both ends differ by 4 K m n
    segment = 4.0 * (m / (F_y_outer + F_y_inner)) * (K * n)
    return select(F_y_inner > 0.0, segment, 2.0 * F_y_outer)


# -- the kite -------------------------------------------------------------------------------------------------


@hart.quantity(units="1", symbol="kite", source=KITE, flags=KITE_FLAGS)
def is_kite(
    near_sum_excess: Any, far_difference_excess: Any, far_difference: Any, lambda_sign: Any, valid: Any
) -> Any:
    """Whether MABN is a kite, so that F's line passes through M (a = c, b = d), or through N (b = c, a = d)."""
    kite = (near_sum_excess == 0.0) & (far_difference_excess == 0.0) & (valid == 1.0)
    return select(kite, select(far_difference * lambda_sign < 0.0, 1.0, 2.0), 0.0)


@hart.quantity(units="m", symbol="a", source=KITE)
def ellipse_a(is_kite: Any, m: Any) -> Any:
    """Semi-axis along the line of F of the ellipse of the middle of PF about M; NaN if that is none."""
    return select(is_kite == 1.0, 1.5 * m, NOT_A_NUMBER)


@hart.quantity(units="m", symbol="b", source=KITE)
def ellipse_b(is_kite: Any, m: Any) -> Any:
    """Semi-axis along MN of the ellipse of the middle of PF about M; NaN if that is none."""
    return select(is_kite == 1.0, 0.5 * m, NOT_A_NUMBER)


@hart.quantity(units="1", symbol="status", source=f"{STROKE}; {WUNDERLICH}, section 7", flags=STATUS_FLAGS)
def status(
    kappa: Any, F_y_inner: Any, far_sum_excess: Any, near_difference_excess: Any, near_sum_excess: Any,
    far_difference_excess: Any, assembles: Any, lengths_are_valid: Any, valid: Any,
) -> Any:  # fmt: skip
    """How F traces its line, or why there is none."""
    change_point = (near_sum_excess == 0.0) | (far_difference_excess == 0.0)
    rigid = (far_sum_excess == 0.0) | (near_difference_excess == 0.0)
    code = select(change_point, 2.0, select(F_y_inner > 0.0, 1.0, 0.0))
    code = select(rigid, 3.0, code)
    code = select(assembles == 1.0, code, 4.0)
    code = select(valid == 1.0, code, 7.0)
    code = select((lengths_are_valid == 1.0) & (abs(kappa) == 1.0), 6.0, code)
    return select((lengths_are_valid == 1.0) & (kappa == 0.0), 5.0, code)

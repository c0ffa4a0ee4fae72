"""Where F crosses MN: s + r with sigma = 0 and s - r with sigma = pi, as seen from M and N.

In between, z_x = (s + r) C + (s - r) Z with C = cos^2(sigma/2), Z = sin^2(sigma/2). Where S is far away, or M
near the circle of F, one of both is a difference. It is the length of the dyad MPF there, |m - p w|^2 = (|m|
- |p|)^2 + 4 |m p| s of the squared half-angle s of `dyad`, a sum of positive terms where F reaches it. Where
it does not and S is far away, it is the power of M over the other one.

Next to kites F passes a pivot: a = c and b = d, then the circle of F passes M, or a = d and b = c, then N. On which
side is the sign of the power, which eq. (2.5) makes a sum of differences of lengths:

    s^2 - r^2 = [(c^2 - a^2) + rho (d^2 - b^2)]/((1 + rho)(1 - x/rho)),
    (d - s)^2 - r^2 = [(d^2 - a^2) + rho (c^2 - b^2)]/((1 + rho)(1 - x rho)),      x = lambda - 1.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import difference, opposite, product, quotient, total
from fastlink.mechanisms.focal.dyad import DYAD
from fastlink.mechanisms.focal.inputs import focal
from fastlink.mechanisms.focal.points import POSITION
from fastlink.numerics.elementary import select, sqrt
from fastlink.numerics.vectors import sign

#: A difference is as good as its terms where it is so much of them.
LEAST = 0.125


@focal.quantity(units="1", symbol="|1 + rho| < 1/2", source=POSITION, internal=True)
def far_S(rho_plus_1: Any) -> Any:
    """1 where S is far away, else 0."""
    return select(abs(rho_plus_1) < 0.5, 1.0, 0.0)


def power_of_M(rho: Any, s_d: Any, V: Any, rho_plus_1: Any) -> Any:
    """Power of M with respect to the circle of F, s^2 - r^2."""
    return (rho * (s_d * s_d) - V / rho_plus_1) / rho_plus_1


def power_of_N(s_d: Any, V: Any, rho_plus_1: Any) -> Any:
    """Power of N with respect to the circle of F, (d - s)^2 - r^2."""
    return (s_d * s_d - V / rho_plus_1) / rho_plus_1


def gap(longer: Any, shorter: Any) -> Any:
    """Difference of two squared lengths."""
    return (longer - shorter) * (longer + shorter)


def apart(share: Any) -> Any:
    """1 less a share, 0 where that cancels."""
    rest = 1.0 - share
    return select(abs(rest) > LEAST * (1.0 + abs(share)), rest, 0.0)


def power_by_gaps(one: Any, rho: Any, other: Any, rho_plus_1: Any, apart: Any) -> Any:
    """Power of M or N with respect to the circle of F, by differences of lengths."""
    return (one + rho * other) / (rho_plus_1 * apart)


def whether_by_gaps(
    total: Any, other: Any, one: Any, rho: Any, second: Any, rho_plus_1: Any, apart: Any
) -> Any:
    """1 where a total cancels and differences of lengths do not, else 0."""
    terms, size = abs(one) + abs(rho * second), abs(rho_plus_1 * apart)
    return select((abs(total) < LEAST * abs(other)) & (terms < LEAST * size * (other * other)), 1.0, 0.0)


def where_folded(fold_sign: Any, sine: Any, cosine: Any) -> Any:
    """Return the squared half-angle that is 0 where a dyad is folded: sine or cosine."""
    return select(fold_sign > 0.0, sine, cosine)


def dyad_length(straight: Any, one: Any, two: Any, squared: Any) -> Any:
    """Return the length of a dyad with the crank in MN, from that where it is folded; only where it reaches."""
    return sqrt(straight * straight + 4.0 * abs(one * two) * select(squared > 0.0, squared, 0.0))


def better_known(
    one: Any, two: Any, s_r: Any, squared: Any, dyad: Any, far_S: Any, power: Any, total: Any, other: Any,
    by_gaps: Any, power_by_gaps: Any,
) -> Any:  # fmt: skip
    """Return a total that cancels: from the dyad, if that is shorter than the crank and reaches, or from the power."""
    by_power = select(far_S == 1.0, power / other, total)
    by_power = select(by_gaps == 1.0, power_by_gaps / other, by_power)
    shorter = abs(one) + abs(two) < s_r
    return select(shorter & (squared >= 0.0), sign(by_power) * dyad, by_power)


def crossing_at_0(start: Any, total: Any, better: Any) -> Any:
    """Return where F crosses MN with sigma = 0: start + r."""
    return select(start < 0.0, better, total)


def crossing_at_pi(start: Any, total: Any, better: Any) -> Any:
    """Return where F crosses MN with sigma = pi: start - r."""
    return select(start > 0.0, better, total)


def declare_crossings(pivot: str, start: str, fold_sign: str, one: str, two: str) -> None:
    """Declare where F crosses MN, as seen from M or N."""
    gaps = {"one": f"{pivot}_gap_of_a", "second": f"{pivot}_gap_of_b", "apart": f"{pivot}_apart"}
    by_power = f"{pivot}_power_by_gaps"
    step(power_by_gaps, by_power, "s^2 - r^2", one=gaps["one"], other=gaps["second"], apart=gaps["apart"])
    sums = {"at_0": total, "at_pi": difference}
    for law, end, other in ((crossing_at_0, "at_0", "at_pi"), (crossing_at_pi, "at_pi", "at_0")):
        squared, dyad, better = (f"{pivot}_{what}_{end}" for what in ("squared", "dyad", "better"))
        sum_of = {side: f"{pivot}_sum_{side}" for side in sums}
        step(sums[end], sum_of[end], "s", x=start, y="s_r")
        step(where_folded, squared, "s", fold_sign=fold_sign, sine=f"sine_{end}", cosine=f"cosine_{end}")
        step(dyad_length, dyad, f"{pivot}F", straight=f"straight_{pivot}", one=one, two=two, squared=squared)
        given = {"one": one, "two": two, "squared": squared, "dyad": dyad, "power": f"power_of_{pivot}"}
        by_gaps, totals = f"{pivot}_by_gaps_{end}", {"total": sum_of[end], "other": sum_of[other]}
        step(whether_by_gaps, by_gaps, "|s - r| < s/8", **totals, **gaps)
        given |= {"by_gaps": by_gaps, "power_by_gaps": by_power}
        step(better_known, better, f"{pivot}F", **totals, **given)
        step(law, f"{pivot}F_{end}", f"{pivot}F", total=sum_of[end], start=start, better=better)


step = focal.steps(units="1", source=DYAD)
step(opposite, "s_NS", "-(d - s)", "Scaled distance from N to S along MN", x="s_SN")
step(power_of_M, "power_of_M", "s^2 - r^2")
step(power_of_N, "power_of_N", "(d - s)^2 - r^2")
step(gap, "M_gap_of_a", "c^2 - a^2", "c^2 - a^2, scaled", longer="s_c", shorter="s_a")
step(gap, "M_gap_of_b", "d^2 - b^2", "d^2 - b^2, scaled", longer="s_d", shorter="s_b")
step(gap, "N_gap_of_a", "d^2 - a^2", "d^2 - a^2, scaled", longer="s_d", shorter="s_a")
step(gap, "N_gap_of_b", "c^2 - b^2", "c^2 - b^2, scaled", longer="s_c", shorter="s_b")
step(quotient, "M_share", "x/rho", "x/rho", x="x", y="rho")
step(product, "N_share", "rho x", "rho x", x="rho", y="x")
step(apart, "M_apart", "1 - x/rho", share="M_share")
step(apart, "N_apart", "1 - rho x", share="N_share")
declare_crossings("M", "s_s", "P_sign", "s_m", "s_p")
declare_crossings("N", "s_NS", "minus_lambda_sign", "s_n", "s_q")

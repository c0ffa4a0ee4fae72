"""Where F crosses MN: s + r with sigma = 0 and s - r with sigma = pi, as seen from M and N.

In between, z_x = (s + r) C + (s - r) Z with C = cos^2(sigma/2), Z = sin^2(sigma/2). Where S is far away, or M
near the circle of F, one of both is a difference. It is the length of the dyad MPF there, |m - p w|^2 = (|m|
- |p|)^2 + 4 |m p| s of the squared half-angle s of `dyad`, a sum of positive terms where F reaches it. Where
it does not and S is far away, it is the power of M over the other one.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import difference, opposite, total
from fastlink.mechanisms.focal.dyad import DYAD
from fastlink.mechanisms.focal.inputs import focal
from fastlink.mechanisms.focal.points import POSITION
from fastlink.numerics.elementary import select, sqrt
from fastlink.numerics.vectors import sign


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


def where_folded(fold_sign: Any, sine: Any, cosine: Any) -> Any:
    """Return the squared half-angle that is 0 where a dyad is folded: sine or cosine."""
    return select(fold_sign > 0.0, sine, cosine)


def dyad_length(straight: Any, one: Any, two: Any, squared: Any) -> Any:
    """Return the length of a dyad with the crank in MN, from that where it is folded; only where it reaches."""
    return sqrt(straight * straight + 4.0 * abs(one * two) * select(squared > 0.0, squared, 0.0))


def better_known(
    one: Any, two: Any, s_r: Any, squared: Any, dyad: Any, far_S: Any, power: Any, total: Any, other: Any
) -> Any:
    """Return a total that cancels: from the dyad, if that is shorter than the crank and reaches, or from the power."""
    by_power = select(far_S == 1.0, power / other, total)
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
    sums = {"at_0": total, "at_pi": difference}
    for law, end, other in ((crossing_at_0, "at_0", "at_pi"), (crossing_at_pi, "at_pi", "at_0")):
        squared, dyad, better = (f"{pivot}_{what}_{end}" for what in ("squared", "dyad", "better"))
        sum_of = {side: f"{pivot}_sum_{side}" for side in sums}
        step(sums[end], sum_of[end], "s", x=start, y="s_r")
        step(where_folded, squared, "s", fold_sign=fold_sign, sine=f"sine_{end}", cosine=f"cosine_{end}")
        step(dyad_length, dyad, f"{pivot}F", straight=f"straight_{pivot}", one=one, two=two, squared=squared)
        given = {"one": one, "two": two, "squared": squared, "dyad": dyad, "power": f"power_of_{pivot}"}
        step(better_known, better, f"{pivot}F", total=sum_of[end], other=sum_of[other], **given)
        step(law, f"{pivot}F_{end}", f"{pivot}F", total=sum_of[end], start=start, better=better)


step = focal.steps(units="1", source=DYAD)
step(opposite, "s_NS", "-(d - s)", "Scaled distance from N to S along MN", x="s_SN")
step(power_of_M, "power_of_M", "s^2 - r^2")
step(power_of_N, "power_of_N", "(d - s)^2 - r^2")
declare_crossings("M", "s_s", "P_sign", "s_m", "s_p")
declare_crossings("N", "s_NS", "minus_lambda_sign", "s_n", "s_q")

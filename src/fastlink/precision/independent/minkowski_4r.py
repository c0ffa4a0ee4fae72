"""The Minkowskian 4R from the closure of its loop in null coordinates: eqs. (5) and (9) of Hegedüs and Moore."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from fastlink.precision.independent.loops import Open, Series, Singular, closed, exponential, solved

__all__ = ["DESIGN", "QUANTITIES", "configuration", "design", "digits"]

#: Quantities by the order of the derivatives that they need.
QUANTITIES = dict.fromkeys(("A_x", "A_y", "B_x", "B_y", "X_x", "X_y", "psi", "phi", "cosh_zeta", "zeta"), 0)
QUANTITIES |= dict.fromkeys(("AB_rapidity", "AB_orientation", "CB_orientation", "half_angle_root"), 0)
QUANTITIES |= dict.fromkeys(("coefficient_A", "coefficient_B", "coefficient_C", "delta", "psi_remark"), 0)
QUANTITIES |= dict.fromkeys(("lambda_AX", "mu_BX"), 0)
QUANTITIES |= {"dpsi_dtheta": 1, "d2psi_dtheta2": 2}
DESIGN: tuple[str, ...] = ("T1", "T2", "T3", "T4", "T5", "T7")
DESIGN += ("cosh_theta_min", "cosh_theta_max", "cosh_psi_min", "cosh_psi_max", "theta_escape")
DESIGN += ("r_AX", "s_BX", "gamma")


#: Rapidities beyond which the equations take too many digits.
GREATEST = 4000


def digits(at: Mapping[str, Any]) -> int | None:
    """Return the digits that the loop loses, whose terms are e^theta and e^-theta; None if these are too many."""
    theta = abs(float(at.get("theta", 0.0)))
    return 50 * math.ceil(theta / 50) if theta <= GREATEST else None


def configuration(ctx: Any, at: Mapping[str, Any], order: int, values: dict[str, Any]) -> None:
    """Add the quantities of one configuration."""
    a, b, g, h = (at[name] for name in "abgh")
    drive = Series((at["theta"], *([ctx.mpf(1), ctx.mpf(0)][:order])))
    p = ctx.exp(drive.terms[0])
    values |= _coordinates("A", a * p, a / p)
    values |= _remark(ctx, at, p)
    try:
        q = _root(ctx, at, p)
    except Open:
        values |= {"CB_orientation": ctx.mpf(0), "AB_orientation": ctx.mpf(0)}
        raise
    k = (g + b * q - a * p) / h
    if k == 0 or q == 0:
        raise Singular("a root is infinite")
    signs = [1 if one > 0 else -1 for one in (q, k)]

    def closure(unknown: list[Series], drive: Series) -> list[Series]:
        CB, AB = (sign * exponential(ctx, one) for sign, one in zip(signs, unknown, strict=True))
        OA = exponential(ctx, drive)
        return [a * OA + h * AB - b * CB - g, a / OA + h / AB - b / CB - g]

    psi, rapidity = solved(ctx, closure, [ctx.log(abs(q)), ctx.log(abs(k))], drive)
    q, k = (sign * ctx.exp(one.terms[0]) for sign, one in zip(signs, (psi, rapidity), strict=True))
    values |= {"psi": psi.terms[0], "AB_rapidity": rapidity.terms[0]}
    values |= {"CB_orientation": ctx.mpf(signs[0]), "AB_orientation": ctx.mpf(signs[1])}
    values["phi"] = rapidity.terms[0] - drive.terms[0] + ctx.pi
    if q != -1:
        values["half_angle_root"] = (q - 1) / (q + 1)
    # of vectors (u, v) and (x, y) in null coordinates the scalar product is (u y + v x)/2
    values["cosh_zeta"] = (k / q + q / k) / 2
    if values["cosh_zeta"] >= 1:
        values["zeta"] = abs(rapidity.terms[0] - psi.terms[0])
    values |= _coordinates("B", g + b * q, g + b / q)
    if "x" in at and "y" in at:
        AX = (at["x"] + at["y"]) * k, (at["x"] - at["y"]) / k
        BX = AX[0] - h * k, AX[1] - h / k
        values |= _coordinates("X", a * p + AX[0], a / p + AX[1])
        for name, (u, v) in (("lambda_AX", AX), ("mu_BX", BX)):
            if u * v != 0:
                values[name] = ctx.log(abs(u / v)) / 2
    values |= {name: psi.derivative(i) for i, name in enumerate(RATES[:order], 1)}


def _coordinates(name: str, u: Any, v: Any) -> dict[str, Any]:
    """Return the coordinates of a point from its null coordinates."""
    return {f"{name}_x": (u + v) / 2, f"{name}_y": (u - v) / 2}


def _coefficients(at: Mapping[str, Any], p: Any) -> tuple[Any, Any, Any]:
    """Return A, B and C of Theorem 3.1 for p = e^theta."""
    a, b, g, h = (at[name] for name in "abgh")
    ch, sh = (p + 1 / p) / 2, (p - 1 / p) / 2
    return 2 * g * b - 2 * a * b * ch, 2 * a * b * sh, h * h - g * g - b * b - a * a + 2 * a * g * ch


def _remark(ctx: Any, at: Mapping[str, Any], p: Any) -> dict[str, Any]:
    """Return A, B and C, and the closed form of the Remark to Theorem 3.1 where it has a value."""
    A, B, C = _coefficients(at, p)
    values = {"coefficient_A": A, "coefficient_B": B, "coefficient_C": C}
    if abs(B) < A:
        values["delta"] = ctx.atanh(B / A)
        cosh = C / ctx.sqrt(A * A - B * B)
        if cosh >= 1:
            arch = ctx.acosh(cosh)
            values["psi_remark"] = (arch if at["branch"] == 1 else -arch) - values["delta"]
    return values


RATES = ("dpsi_dtheta", "d2psi_dtheta2")


def _root(ctx: Any, at: Mapping[str, Any], p: Any) -> Any:
    """Return q = e^psi, or -e^psi where CB is past-pointing, by the half-angle of eq. (3)."""
    A, B, C = _coefficients(at, p)
    size = B * B + C * C + A * A
    square = closed(ctx, B * B + C * C - A * A, size, "no root of eq. (3) is real")
    sign = 1 if at["branch"] == 1 else -1
    top, below = -B + sign * ctx.sqrt(square), A + C
    if below == top:
        raise Singular("psi is infinite")
    # y = top/below, q = (1 + y)/(1 - y)
    return (below + top) / (below - top)


def design(ctx: Any, at: Mapping[str, Any], values: dict[str, Any]) -> None:
    """Add the sums of lengths, and the limits of Theorems 3.8 and 3.10 as they stand there."""
    a, b, g, h = (at[name] for name in "abgh")
    values |= {"T1": g + b - h - a, "T2": a - g + b - h, "T3": g - a - b - h}
    values |= {"T4": g - a + b + h, "T5": a - h + g + b, "T7": g + b + a + h}
    values["cosh_theta_min"] = (a * a + g * g - (b + h) ** 2) / (2 * a * g)
    values["cosh_theta_max"] = (a * a + g * g - (b - h) ** 2) / (2 * a * g)
    values["cosh_psi_min"] = ((a - h) ** 2 - g * g - b * b) / (2 * b * g)
    values["cosh_psi_max"] = ((a + h) ** 2 - g * g - b * b) / (2 * b * g)
    values["theta_escape"] = abs(ctx.log(g / a))
    if "x" in at and "y" in at:
        x, y = at["x"], at["y"]
        AX, BX = (x + y, x - y), (x - h + y, x - h - y)
        values |= {"r_AX": ctx.sqrt(abs(AX[0] * AX[1])), "s_BX": ctx.sqrt(abs(BX[0] * BX[1]))}
        if values["r_AX"] * values["s_BX"] != 0:
            values["gamma"] = ctx.log(abs(BX[0] * AX[1] / (BX[1] * AX[0]))) / 2

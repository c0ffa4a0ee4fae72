"""Hart's straight-line linkage: its bars from (7.2) to (7.4), its joints from (1.3) and (1.4)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fastlink.precision.independent.loops import (
    SEEN,
    Open,
    Series,
    Singular,
    between_rockers,
    by_F,
    closing,
    coordinates,
    points,
    rotation,
    seen_from_AB,
    unit_vector,
    wrapped,
)

__all__ = ["BY_LINE", "BY_ROCKER", "DESIGN", "configuration", "design"]

#: Quantities by the order of the derivatives that they need.
_BOTH = dict.fromkeys((f"{joint}_{axis}" for joint in ("A", "B", "P", "Q", "PF_mid") for axis in "xy"), 0)
_BOTH |= {"F_x": 0, "psi": 0, "omega_angle": 0}
_BOTH |= {name: order for name, order in SEEN.items() if name[0] != "S"}
BY_ROCKER = _BOTH | {"F_y": 0, "dF_y_dphi": 1, "dpsi_dphi": 1}
BY_LINE = _BOTH | {"phi": 0, "dphi_dF_y": 1, "dpsi_dF_y": 1}
DESIGN = ("p", "q", "a", "b", "c", "lambda_", "line_x", "line_along_AB", "F_y_outer", "F_y_inner", "stroke")


def design(ctx: Any, at: Mapping[str, Any], values: dict[str, Any]) -> None:
    """Add the bars of a design, and of one that assembles its line, and how much of it F traces."""
    m, n, d, kappa = (at[name] for name in ("m", "n", "d", "kappa"))
    ratio = 1 - kappa * kappa
    if kappa == 0 or ratio == 0:
        raise Singular("bars have no length")
    values |= {
        "p": kappa * n,
        "q": -kappa * m,
        "c": kappa * d,
        "lambda_": ratio,
        "a": ratio * m,
        "b": ratio * n,
    }
    sides = sorted((abs(values["a"]), abs(values["b"]), abs(values["c"]), d))
    if sides[3] > sides[0] + sides[1] + sides[2]:
        raise Open("the four-bar never assembles")
    # F where the circles about M and about N, of radii that belong to one omega, meet: on a line across MN
    line = d / 2 + (m * m + values["p"] ** 2 - n * n - values["q"] ** 2) / (2 * d)
    ends = [(m + sign * abs(values["p"])) ** 2 - line * line for sign in (1, -1)]
    outer, inner = (ctx.sqrt(max(end, 0 * d)) for end in ends)
    stroke = outer - inner if inner > 0 else 2 * outer
    AP, BQ = m - values["a"], n - values["b"]
    seen = abs(values["c"])
    values["line_along_AB"] = seen / 2 + (AP * AP + values["p"] ** 2 - BQ * BQ - values["q"] ** 2) / (
        2 * seen
    )
    values |= {"line_x": line, "F_y_outer": outer, "F_y_inner": inner, "stroke": stroke}


def configuration(ctx: Any, at: Mapping[str, Any], by_line: bool, order: int, values: dict[str, Any]) -> None:
    """Add the quantities of one configuration."""
    bars = dict(at)
    try:
        design(ctx, at, bars)
    finally:
        if "a" in bars and not by_line:
            along_MA = unit_vector(ctx, at["phi"])
            reach = bars["m"] if bars["a"] > 0 else -bars["m"]
            places = {"A": abs(bars["a"]) * along_MA, "P": reach * along_MA}
            values |= coordinates({name: Series((place,)) for name, place in places.items()})
    ratio, branch = bars["lambda_"], at["branch"]
    drive = Series((at["F_y" if by_line else "phi"], *([ctx.mpf(1)][:order])))
    if by_line:

        def joint_F(drive: Series) -> Series:
            on_line: Series = drive * ctx.mpc(0, 1) + bars["line_x"]
            return on_line

        side = 1 if (branch == 1) == (bars["kappa"] > 0) else -1
        found, angles = by_F(ctx, bars, joint_F, drive, side)
        if ratio < 0:  # MA points away from P
            angles = [angle + ctx.pi for angle in angles]
    else:
        lengths = bars["d"], *(abs(bars[name]) for name in "acb")
        angles = [drive, between_rockers(ctx, lengths, drive, branch)]
        sign = 1 if ratio > 0 else -1  # of MA and MP
        found = closing(bars, *(sign * rotation(ctx, angle) for angle in angles))
    places = points(bars, ratio, found)
    places["PF_mid"] = (places["P"] + places["F"]) / 2
    w = found.w.terms[0]
    values |= {"phi": wrapped(ctx, angles[0].terms[0]), "psi": wrapped(ctx, angles[1].terms[0])}
    values |= {"omega_angle": ctx.atan2(w.imag, w.real)}
    if order:
        rates = {"dphi_dF_y": angles[0], "dpsi_dF_y": angles[1]} if by_line else {"dpsi_dphi": angles[1]}
        rates |= {} if by_line else {"dF_y_dphi": places["F"].imag}
        values |= {name: rate.derivative(1) for name, rate in rates.items()}
    A, B, F = (places[name].terms[0] for name in "ABF")
    values |= coordinates(places) | seen_from_AB({"M": 0 * A, "N": 0 * A + bars["d"], "F": F}, A, B)

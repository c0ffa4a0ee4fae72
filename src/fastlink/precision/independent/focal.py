"""Burmester's focal mechanism: its bars from (2.5) and (1.9), its joints from (1.3), (1.4) and (3.2)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fastlink.precision.independent.loops import (
    CIRCLES,
    MEETING,
    SEEN,
    Open,
    Position,
    Series,
    Singular,
    angle_between,
    argument,
    between_rockers,
    by_F,
    circles,
    closed,
    closing,
    coordinates,
    meeting,
    points,
    rotation,
    seen_from_AB,
    solved,
    wrapped,
)

__all__ = ["BY_CRANK", "BY_ROCKER", "DESIGN", "configuration", "design"]

#: Quantities by the order of the derivatives that they need.
_BOTH = dict.fromkeys((f"{joint}_{axis}" for joint in "ABPQTF" for axis in "xy"), 0)
_BOTH |= dict.fromkeys(("psi", "omega_angle", "alpha", "beta", "chi"), 0)
_BOTH |= dict.fromkeys((f"transmission_angle_{joint}" for joint in "PQF"), 0) | MEETING | CIRCLES | SEEN
BY_ROCKER = _BOTH | {"sigma": 0, "dpsi_dphi": 1, "psi_rate": 1, "dsigma_dphi": 1, "sigma_rate": 1}
BY_CRANK = _BOTH | {"phi": 0, "dpsi_dsigma": 1, "psi_rate": 1, "dphi_dsigma": 1, "phi_rate": 1}
DESIGN = ("lambda_", "m", "n", "p", "q", "r", "FT", "s", "S_x", "T_ratio", "line_x", "line_along_AB")


def design(ctx: Any, at: Mapping[str, Any], values: dict[str, Any]) -> None:
    """Add the bars of a design, by Newton's iteration on eq. (2.5)."""
    a, b, c, d = (at[name] for name in "abcd")
    rho: Any = at.get("rho")
    factor: Any = at.get("lambda_")
    squares = a * a + b * b + d * d - c * c
    # the quadratic equation that section 6 speaks of, for lambda or for rho; the first completion is the greater root
    if factor is None:
        share = at["s"] / d if "s" in at else rho / (1 + rho) if rho != -1 else None
        if share is not None:
            values["T_ratio"], values["s"], values["S_x"] = share, share * d, share * d
        if rho == 0 or share == 0 or share == 1:
            raise Singular("S is M or N")
        if "s" in at:
            rho = at["s"] / (d - at["s"])
        _assembled(a, b, c, d)
        sides = rho * b * b + a * a / rho
        roots = _roots(ctx, d * d, -(squares + sides), a * a + b * b + sides)
        factor = sorted(roots, key=lambda root: -abs(root - 1))[at["completion"] - 1]
    else:
        _assembled(a, b, c, d)
        none, one = a * a * (1 - factor), d * d * factor * factor - squares * factor + a * a + b * b
        roots = _roots(ctx, b * b * (1 - factor), one, none)
        rho = sorted(roots, key=lambda root: -abs(root))[at["completion"] - 1]
    if factor == 0 or factor == 1 or rho == 0:
        raise Singular("a bar has no length, or no end")
    square = (factor - 1) * a * a / (factor * factor * rho)
    if square <= 0:
        raise Open("p and q are imaginary")
    q = ctx.sqrt(square)
    start = [a / factor, b / factor, rho * (b / factor) * q / (a / factor), q]
    zero = 0 * a

    def equations(unknown: list[Series], _drive: Series) -> list[Series]:
        m, n, p, q = unknown
        ties = [a * n - b * m, b * m - (m * n + p * q)]
        ties.append(a * (m * m + n * n - p * p - q * q + d * d) - m * squares)
        return [*ties, a - factor * m if "lambda_" in at else m * p - rho * n * q]

    m, n, p, q = (one.terms[0] for one in solved(ctx, equations, start, Series((zero,))))
    values |= {"m": m, "n": n, "p": p, "q": q, "lambda_": 1 + p * q / (m * n)}
    weight = m * p + n * q
    if rho == -1:
        values["line_x"] = d / 2 + (m * m + p * p - n * n - q * q) / (2 * d)
        AP, BQ = p * q / n, p * q / m
        values["line_along_AB"] = c / 2 + (AP * AP + p * p - BQ * BQ - q * q) / (2 * c)
        return
    values["s"] = values["S_x"] = m * p * d / weight
    values["T_ratio"] = m * p / weight
    values["r"] = _radius(ctx, m, n, p, q, d)
    # section 3: fixed AB makes it the five-bar BQFPA
    values["FT"] = _radius(ctx, p * q / m, p * q / n, q, p, c)


def _assembled(a: Any, b: Any, c: Any, d: Any) -> None:
    """Raise where one link of the four-bar is longer than the other three together."""
    if 2 * max(a, b, c, d) > a + b + c + d:
        raise Open("the four-bar never assembles")


def _roots(ctx: Any, two: Any, one: Any, none: Any) -> tuple[Any, Any]:
    """Return the roots of a quadratic equation."""
    square = closed(ctx, one * one - 4 * two * none, one * one + abs(4 * two * none), "no root is real")
    if two == 0:
        raise Singular("a root is infinite")
    return tuple((sign * ctx.sqrt(square) - one) / (2 * two) for sign in (1, -1))


def _radius(ctx: Any, m: Any, n: Any, p: Any, q: Any, d: Any) -> Any:
    """Return the radius of the circle of F, eq. (1.8)."""
    squares = m * m + n * n + p * p + q * q - d * d
    top = m * m * n * n * (p * p + q * q) + (m * m + n * n) * p * p * q * q + m * n * p * q * squares
    if top <= 0:
        raise Singular("the circle of F has no radius")
    return ctx.sqrt(top) / abs(m * p + n * q)


def configuration(
    ctx: Any, at: Mapping[str, Any], by_crank: bool, order: int, values: dict[str, Any]
) -> None:
    """Add the quantities of one configuration."""
    order_of = [ctx.mpf(1)][:order]
    drive = Series((at["sigma" if by_crank else "phi"], *order_of))
    bars = dict(at)
    if by_crank:
        design(ctx, at, bars)
        found, names = _by_crank(ctx, bars, drive, values)
    else:
        found, names = _by_rocker(ctx, at, bars, drive, values)
    places = points(bars, bars["lambda_"], found)
    values |= _angles(ctx, bars, places, found.w.terms[0])
    if "T_ratio" in bars:
        places["T"] = places["A"] + bars["T_ratio"] * (places["B"] - places["A"])
        if not by_crank and "r" in bars:
            names["sigma"] = argument(ctx, places["F"] - bars["s"])
    values |= coordinates(places) | _figures(ctx, bars, places)
    _add_angles(ctx, at, names, "sigma" if by_crank else "phi", values)


def _figures(ctx: Any, bars: Mapping[str, Any], places: Mapping[str, Series]) -> dict[str, Any]:
    """Return points, circles and joints in the frame of AB, as far as the joints are known."""
    joints = {name: place.terms[0] for name, place in places.items()}
    A, B, d = joints["A"], joints["B"], bars["d"]
    joints |= {"M": 0 * A, "N": 0 * A + d}
    if "s" in bars:
        joints["S"] = 0 * A + bars["s"]
    seen = {name: joints[name] for name in "MNSF" if name in joints}
    return meeting(ctx, A, B, d) | circles(ctx, joints) | seen_from_AB(seen, A, B)


def _by_crank(
    ctx: Any, bars: Mapping[str, Any], drive: Series, values: dict[str, Any]
) -> tuple[Position, dict[str, Series]]:
    """Return the position that SF gives, and the angles of MA and NB; F is nowhere where both dyads do not reach it."""
    if "r" not in bars:
        raise Open("there is no crank")

    def joint_F(drive: Series) -> Series:
        from_M: Series = rotation(ctx, drive) * bars["r"] + bars["s"]
        return from_M

    try:
        found, angles = by_F(ctx, bars, joint_F, drive, 1 if bars["branch"] == 1 else -1)
    except Singular:
        values |= coordinates({"F": joint_F(drive)})
        raise
    return found, dict(zip(("phi", "psi"), angles, strict=True))


def _by_rocker(
    ctx: Any, at: Mapping[str, Any], bars: dict[str, Any], drive: Series, values: dict[str, Any]
) -> tuple[Position, dict[str, Series]]:
    """Return the position that MA gives, and the angle of NB; what is there without dyads is added first."""
    a, b, c, d = (at[name] for name in "abcd")
    u = rotation(ctx, drive)
    values |= coordinates({"A": a * u})
    completed: ArithmeticError | None = None
    try:
        design(ctx, at, bars)
        values |= coordinates({"P": bars["m"] * u})
    except (Open, Singular) as error:
        completed = error
    try:
        psi = between_rockers(ctx, (d, a, c, b), drive, at["branch"])
    except Open as error:
        # the bars that are not told here may exist, and P with them
        raise completed if isinstance(completed, Singular) else error from None
    v = rotation(ctx, psi)
    places = {"B": b * v + d}
    if "T_ratio" in bars:
        places["T"] = a * u + bars["T_ratio"] * (places["B"] - a * u)
    values |= coordinates(places) | _figures(ctx, bars, places | {"A": a * u})
    _add_angles(ctx, at, {"psi": psi}, "phi", values)
    if completed is not None:
        # PF and QF are parallel to MA and NB turned by omega, whatever their lengths
        sign = at["rho"] if "rho" in at else at["s"] * (d - at["s"]) if "s" in at else at["lambda_"] - 1
        if sign != 0:
            ahead = -1 if sign < 0 else 1
            values["transmission_angle_F"] = abs(angle_between(ctx, ahead * u.terms[0], -v.terms[0]))
        raise completed
    return closing(bars, u, v), {"psi": psi}


def _add_angles(
    ctx: Any, at: Mapping[str, Any], angles: Mapping[str, Series], by: str, values: dict[str, Any]
) -> None:
    """Add angles, and their rates where the series have them."""
    for name, angle in angles.items():
        values[name] = wrapped(ctx, angle.terms[0])
        if len(angle.terms) > 1:
            values[f"d{name}_d{by}"] = angle.derivative(1)
            if "omega" in at:
                values[f"{name}_rate"] = angle.derivative(1) * at["omega"]


def _angles(ctx: Any, bars: Mapping[str, Any], places: Mapping[str, Series], w: Any) -> dict[str, Any]:
    """Return the angles at F, P and Q, from the joints."""
    A, P, Q, F = (places[name].terms[0] for name in "APQF")
    M, N = 0 * F, 0 * F + bars["d"]

    def between(corner: Any, one: Any, other: Any) -> Any:
        return angle_between(ctx, one - corner, other - corner)

    return {
        "omega_angle": ctx.atan2(w.imag, w.real),
        "alpha": between(F, N, Q),
        "beta": between(F, P, M),
        "chi": between(F, A, M),
        "transmission_angle_P": abs(between(P, M, F)),
        "transmission_angle_Q": abs(between(Q, N, F)),
        "transmission_angle_F": abs(between(F, P, Q)),
    }

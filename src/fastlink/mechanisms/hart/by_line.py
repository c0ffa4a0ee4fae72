"""Hart's linkage driven by F itself along its line: everything is explicit.

With t the height of F over MN, G - H and G + H as in `line` and K = |kappa|

    cos^2(omega/2) = (G + H - t^2)/(4 K m n),    sin^2(omega/2) = (t^2 - (G - H))/(4 K m n),

and with w = e^(i omega) the directions of MP and NQ are those of F from M and N over m - K n w and n - K m w, by (1.3)
and (1.4).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar

from fastlink.catalogue.catalogue import Catalogue, Input
from fastlink.mechanisms import lengths
from fastlink.mechanisms.hart.declare import PAGE, WUNDERLICH, hart
from fastlink.mechanisms.hart.motion import BAR_ERRORS, omega_angle, quotient
from fastlink.mechanisms.planar_4r.rates import product
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.numerics.elementary import NOT_A_NUMBER, atan2, select, sqrt

F = TypeVar("F", bound=Callable[..., Any])
DRIVE = f"{PAGE}#driven-along-the-line"
POSITION = f"{WUNDERLICH}, eqs. (1.2) to (1.4); {DRIVE}"

by_line = Catalogue(
    f"{hart.name} driven by F_y",
    f"{hart.title}, driven by F along its line",
    branches={
        1: "F to the right of the directed line from M to P: omega from 0 to pi where kappa > 0",
        2: "F to the left of the directed line from M to P: omega from -pi to 0 where kappa > 0",
    },
    position=Input("F_y", "m", "y", "height of F over MN"),
    positions=(-1.0, 1.0, 401),
)
by_line.inputs = hart.inputs


def _step(symbol: str, **labels: Any) -> Callable[[F], F]:
    """Declare a step on the way."""
    return by_line.quantity(units="1", symbol=symbol, source=POSITION, internal=True, **labels)


_step("t", name="s_t", meaning="scaled height of F", given={"length": "F_y"})(lengths.scaled)


@_step("h")
def omega_sign(branch: Any) -> Any:
    """1 in branch 1, -1 in branch 2."""
    return 3.0 - 2.0 * branch


@_step("2 sqrt(K m n) cos(omega/2)")
def to_outer(outer_end: Any, s_t: Any) -> Any:
    """Root of G + H - t^2, scaled; NaN where F cannot be."""
    return sqrt(outer_end - abs(s_t)) * sqrt(outer_end + abs(s_t))


@_step("2 sqrt(K m n) sin(omega/2)")
def to_inner(inner_end: Any, stays_off: Any, s_t: Any, omega_sign: Any) -> Any:
    """Root of t^2 - (G - H), scaled, with the sign of omega; NaN where F cannot be."""
    below = sqrt(abs(s_t) - inner_end) * sqrt(abs(s_t) + inner_end)
    return omega_sign * select(stays_off == 1.0, below, sqrt(s_t * s_t + inner_end * inner_end))


@_step("2 sqrt(K m n)")
def omega_scale(to_outer: Any, to_inner: Any) -> Any:
    """Root of 4 K m n, from the two: so that the squares of sine and cosine make 1."""
    return sqrt(to_outer * to_outer + to_inner * to_inner)


for _name, _symbol, _part in (
    ("half_cosine", "cos(omega/2)", "to_outer"),
    ("half_sine", "sin(omega/2)", "to_inner"),
):
    _step(_symbol, name=_name, meaning=_symbol, given={"x": _part, "y": "omega_scale"})(quotient)


@_step("sin omega")
def w_y(half_sine: Any, half_cosine: Any) -> Any:
    """Sine of omega."""
    return 2.0 * (half_sine * half_cosine)


@_step("cos omega")
def w_x(half_sine: Any, half_cosine: Any) -> Any:
    """Cosine of omega."""
    return (half_cosine - half_sine) * (half_cosine + half_sine)


def arm_x(own: Any, other: Any, K: Any, half_sine: Any) -> Any:
    """Component along the bar of F from its pivot, own - K other cos(omega)."""
    return (own - K * other) + 2.0 * (K * other) * (half_sine * half_sine)


def arm_y(other: Any, K: Any, w_y: Any) -> Any:
    """Component across the bar of F from its pivot."""
    return -(K * other * w_y)


def turned_x(x: Any, y: Any, arm_x: Any, arm_y: Any) -> Any:
    """Cosine of the direction that turns an arm into F as seen from the pivot."""
    size = sqrt(x * x + y * y) * sqrt(arm_x * arm_x + arm_y * arm_y)
    return (x * arm_x + y * arm_y) / size


def turned_y(x: Any, y: Any, arm_x: Any, arm_y: Any) -> Any:
    """Sine of that direction."""
    size = sqrt(x * x + y * y) * sqrt(arm_x * arm_x + arm_y * arm_y)
    return (y * arm_x - x * arm_y) / size


def from_M(line_x: Any, lift: Any, unit: Any) -> Any:
    """Where the line is, scaled, as seen from M."""
    return line_x * lift / unit


def from_N(line_x: Any, d: Any, lift: Any, unit: Any) -> Any:
    """Where the line is, scaled, as seen from N."""
    return (line_x - d) * lift / unit


_law: Any
for _u, _bar, _pivot, _own, _other, _from in (
    ("u", "MP", "M", "s_m", "s_n", from_M),
    ("v", "NQ", "N", "s_n", "s_m", from_N),
):
    _step("x", name=f"{_pivot}_line", meaning=f"scaled x of the line from {_pivot}")(_from)
    _seen = {"x": f"{_pivot}_line", "y": "s_t", "arm_x": f"{_pivot}_arm_x", "arm_y": f"{_pivot}_arm_y"}
    for _name, _law, _given in (
        (f"{_pivot}_arm_x", arm_x, {"own": _own, "other": _other}),
        (f"{_pivot}_arm_y", arm_y, {"other": _other}),
        (f"{_u}_x", turned_x, _seen),
        (f"{_u}_y", turned_y, _seen),
    ):
        _step(_name, name=_name, given=_given)(_law)


# -- what is told ---------------------------------------------------------------------------------------------


def direction(x: Any, y: Any, lambda_sign: Any) -> Any:
    """Return the direction from the pivot to A or B."""
    return atan2(lambda_sign * y + 0.0, lambda_sign * x)


def along(start: Any, length: Any, share: Any) -> Any:
    """Return start + length share."""
    return start + length * share


def mean(x: Any, y: Any) -> Any:
    """Return the mean of two numbers."""
    return 0.5 * (x + y)


def rate(x: Any, y: Any, own: Any, other: Any, K: Any, w_x: Any, w_y: Any, lift: Any, unit: Any) -> Any:
    """Return the rate of a direction by the height of F."""
    # Im(w u)/(own sin(omega)) for u = z/(own - K other w), of which both lengths are that of z
    turned = x * own * w_y + y * (own * w_x - K * other)
    return turned / (x * x + y * y) / (own * w_y) * lift / unit


@by_line.quantity(units="m", symbol="F_x", source=f"{POSITION}, eq. (7.5)")
def F_x(line_x: Any, w_y: Any) -> Any:
    """Point F, x: that of its line, where the linkage assembles."""
    return select(w_y == w_y, line_x, NOT_A_NUMBER)


for _name, _units, _meaning, _law, _given in (
    ("phi", "rad", "Direction of MA in the ground frame", direction, {"x": "u_x", "y": "u_y"}),
    ("psi", "rad", "Direction of NB in the ground frame", direction, {"x": "v_x", "y": "v_y"}),
    ("P_x", "m", "Joint P, x", product, {"x": "m", "y": "u_x"}),
    ("P_y", "m", "Joint P, y", product, {"x": "m", "y": "u_y"}),
    ("A_x", "m", "Joint A, x", product, {"x": "a", "y": "u_x"}),
    ("A_y", "m", "Joint A, y", product, {"x": "a", "y": "u_y"}),
    ("Q_x", "m", "Joint Q, x", along, {"start": "d", "length": "n", "share": "v_x"}),
    ("Q_y", "m", "Joint Q, y", product, {"x": "n", "y": "v_y"}),
    ("B_x", "m", "Joint B, x", along, {"start": "d", "length": "b", "share": "v_x"}),
    ("B_y", "m", "Joint B, y", product, {"x": "b", "y": "v_y"}),
    ("PF_mid_x", "m", "Middle of PF, x", mean, {"x": "P_x", "y": "F_x"}),
    ("PF_mid_y", "m", "Middle of PF, y", mean, {"x": "P_y", "y": "F_y"}),
):
    by_line.quantity(units=_units, symbol=_name, source=POSITION, name=_name, meaning=_meaning, given=_given)(
        _law
    )

for _name, _what, _given in (
    ("dphi_dF_y", "MA", {"x": "M_line", "own": "s_m", "other": "s_n"}),
    ("dpsi_dF_y", "NB", {"x": "N_line", "own": "s_n", "other": "s_m"}),
):
    by_line.quantity(
        units="rad m-1",
        symbol=_name,
        source=f"{PAGE}#rates-and-extremes",
        name=_name,
        meaning=f"Rate of the direction of {_what} by the height of F",
        given={"y": "s_t", **_given},
    )(rate)

by_line.quantity(
    units="rad",
    symbol="omega",
    source=hart.facts["omega_angle"].source,
    given={"sine_part": "w_y", "cosine_part": "w_x"},
)(omega_angle)


@by_line.quantity(units="1", symbol="u", source=DRIVE)
def F_deviation(P_x: Any, u_x: Any, u_y: Any, w_x: Any, w_y: Any, line_x: Any, m: Any, n: Any, K: Any) -> Any:
    """Distance of the end of MP and PF as computed from the line, in units of 2^-53 (MP + PF)."""
    reached = P_x - K * n * (u_x * w_x - u_y * w_y)
    return abs(reached - line_x) / (UNIT_ROUNDING * (m + K * n))


@cache
def with_facts_of_hart() -> Catalogue:
    """Return the catalogue with what belongs to the design as a whole, and what measures the bars."""
    for name, fact in hart.facts.items():
        if not (hart.is_derivative(name) or hart.varies(name)) or name in (*BAR_ERRORS, "closure_residual"):
            by_line.facts.setdefault(name, fact)
    return by_line

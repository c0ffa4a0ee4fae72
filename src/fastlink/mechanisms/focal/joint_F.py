"""Facts of the joint F: its vectors from M, N and S, each by way of the joint in between that is nearest.

Every pivot has two bars to F: from M by way of P (m, p) or of S (s, r), from N by way of Q (n, q) or of S. A
sum of two bars has the rounding of the longer one, and F may be next to M (rho near 0) or to N (rho large),
while P and Q (lambda near 0) or S (rho near -1) are far away. So from each pivot the shorter way is taken,
and the place of F is that from the pivot whose way is shorter; the lengths of the other ways count as 0. The
height of F over MN is that over S, too: by the crank alone where this is shorter than PF or QF, however far S is
from M and N.
"""

from __future__ import annotations

from typing import Any

from fastlink.mechanisms._shared.laws import angle, opposite
from fastlink.mechanisms.focal.by_crank import steps
from fastlink.mechanisms.focal.inputs import WUNDERLICH, focal
from fastlink.mechanisms.focal.points import FIGURES, POSITION
from fastlink.numerics.elementary import NOT_A_NUMBER, select, sqrt


def whether_nearer(one: Any, two: Any, far: Any, other: Any) -> Any:
    """1 where a way of two lengths is shorter than each of two others, else 0."""
    reach = abs(one) + abs(two)
    return select((reach < abs(far)) & (reach < abs(other)), 1.0, 0.0)


def where(way: Any, length: Any) -> Any:
    """Return a length of a way that is taken, else 0."""
    return select(way == 1.0, length, 0.0)


def unless(way: Any, length: Any) -> Any:
    """Return a length where another way is not taken, else 0."""
    return select(way == 1.0, 0.0, length)


@focal.quantity(units="1", symbol="d - s", source=f"{WUNDERLICH}, eq. (1.9)", internal=True)
def s_SN(s_d: Any, rho_plus_1: Any) -> Any:
    """Scaled distance from S to N along MN."""
    return s_d / rho_plus_1


step = focal.steps(units="1", source=POSITION)
_NEAR = "1 where S is nearer to {0} and F than {1} is, else 0"
step(
    whether_nearer, "near_crank", "|s| + r < |m|, |p|", _NEAR.format("M", "P"),
    one="s_s", two="s_r", far="s_m", other="s_p",
)  # fmt: skip
step(
    whether_nearer, "near_crank_N", "|d - s| + r < |n|, |q|", _NEAR.format("N", "Q"),
    one="s_SN", two="s_r", far="s_n", other="s_q",
)  # fmt: skip
by_S, by_S_N = {"way": "near_crank"}, {"way": "near_crank_N"}
step(where, "near_s", "s_s", length="s_s", **by_S)
step(where, "near_r", "s_r", length="s_r", **by_S)
step(unless, "near_m", "s_m", length="s_m", **by_S)
step(unless, "near_p", "s_p", length="s_p", **by_S)
step(where, "near_SN", "s_SN", length="s_SN", **by_S_N)
step(where, "near_r_N", "s_r", length="s_r", **by_S_N)
step(unless, "near_n", "s_n", length="s_n", **by_S_N)
step(unless, "near_q", "s_q", length="s_q", **by_S_N)

# -- by way of S; 0 where that is not taken ----------------------------------------------------------------------


def by_S_along(start: Any, length: Any, g: Any) -> Any:
    """Return a component of the vector from M or N to F by way of S."""
    return start + length * g


def by_S_across(length: Any, g: Any) -> Any:
    """Return the component of that vector across MN."""
    return length * g


step = steps(units="1", source=f"{WUNDERLICH}, eq. (1.7)")
step(opposite, "near_NS", "s - d", "Scaled distance from N to S, where that way is taken", x="near_SN")
_FROM = "Vector from {} to F by way of S, {}"
step(by_S_along, "by_S_x", "z_x", _FROM.format("M", "x"), start="near_s", length="near_r", g="g_x")
step(by_S_across, "by_S_y", "z_y", _FROM.format("M", "y"), length="near_r", g="g_y")
step(
    by_S_along,
    "from_N_by_S_x",
    "z_x - d",
    _FROM.format("N", "x"),
    start="near_NS",
    length="near_r_N",
    g="g_x",
)
step(by_S_across, "from_N_by_S_y", "z_y", _FROM.format("N", "y"), length="near_r_N", g="g_y")

# -- driven by the rocker -----------------------------------------------------------------------------------------


def whether_far(near_crank: Any) -> Any:
    """1 where F is computed from P, else 0."""
    return 1.0 - near_crank


@focal.quantity(units="1", symbol="sgn p m", source=POSITION, internal=True)
def near_P_sign(near_crank: Any, P_sign: Any) -> Any:
    """Sign of m p where F is computed from S, else 0."""
    return near_crank * P_sign


@focal.quantity(units="1", symbol="1/p", source=POSITION, internal=True)
def near_per_p(near_crank: Any, s_p: Any) -> Any:
    """Reciprocal of p where F is computed from S, else 0."""
    return select(near_crank == 1.0, 1.0 / s_p, 0.0)


focal.steps(units="1", source=POSITION)(whether_far, "far_crank", "1")


@focal.quantity(units="1", symbol="sin(MA, SF)", source=POSITION, internal=True)
def sine_of_crank(
    crank_sign: Any, sine_B: Any, e_x: Any, e_y: Any, v_x: Any, v_y: Any, closing_x: Any, closing_sine: Any
) -> Any:
    """Sine of the angle from MA to SF, which is -k v w/e."""
    return -crank_sign * (sine_B * closing_x + (e_x * v_x + e_y * v_y) * closing_sine)


@focal.quantity(units="1", symbol="sin omega", source=f"{WUNDERLICH}, eq. (1.3)", internal=True)
def by_S_sine(near_per_p: Any, near_s: Any, near_r: Any, sine_of_crank: Any, u_y: Any) -> Any:
    """Sine of omega by way of S: the height of F over MP, over p."""
    return near_per_p * (near_s * u_y - near_r * sine_of_crank)


@focal.quantity(units="1", symbol="cos omega", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def w_x(far_crank: Any, closing_x: Any, near_P_sign: Any, by_S_sine: Any) -> Any:
    """Cosine of omega."""
    # PF and PM are longer than FM where F is computed from S: omega is within pi/3 of 0 or pi
    return far_crank * closing_x + near_P_sign * sqrt(1.0 - by_S_sine * by_S_sine)


@focal.quantity(units="1", symbol="sin omega", source=f"{WUNDERLICH}, eqs. (1.3), (1.4)", internal=True)
def w_y(far_crank: Any, closing_sine: Any, by_S_sine: Any) -> Any:
    """Sine of omega."""
    return far_crank * closing_sine + by_S_sine


# -- its place, from the pivot whose way is shorter ----------------------------------------------------------------


@focal.quantity(units="1", symbol="NF < MF", source=POSITION, internal=True)
def near_N(
    near_s: Any, near_m: Any, near_p: Any, near_SN: Any, near_r: Any, near_r_N: Any, near_n: Any, near_q: Any
) -> Any:
    """1 where the way from N to F is shorter than that from M, else 0."""
    from_M = (abs(near_s) + near_r) + (abs(near_m) + abs(near_p))
    from_N = (abs(near_SN) + near_r_N) + (abs(near_n) + near_q)
    return select(from_N < from_M, 1.0, 0.0)


def of_nearer(near_N: Any, from_M: Any, from_N: Any) -> Any:
    """Return a length of the way from M, or of that from N where this is shorter."""
    return select(near_N == 1.0, from_N, from_M)


@focal.quantity(units="1", symbol="MF_0", source=POSITION, internal=True)
def place_start(near_N: Any, near_s: Any, near_crank_N: Any, s_s: Any, s_d: Any) -> Any:
    """Where the way to F begins, by way of S at S itself: M, S or N, as seen from M, scaled."""
    return select(near_N == 1.0, select(near_crank_N == 1.0, s_s, s_d), near_s)


@focal.quantity(units="1", symbol="SF_0", source=POSITION, internal=True)
def crank_start(near_N: Any, near_crank: Any, near_crank_N: Any, s_s: Any, s_SN: Any) -> Any:
    """Where the way to F begins, as seen from S, scaled."""
    from_N = select(near_crank_N == 1.0, 0.0, s_SN)
    return select(near_N == 1.0, from_N, select(near_crank == 1.0, 0.0, -s_s))


step = focal.steps(units="1", source=POSITION)
step(of_nearer, "place_r", "s_r", from_M="near_r", from_N="near_r_N")
by_N = {"way": "near_N"}
step(unless, "place_m", "s_m", length="near_m", **by_N)
step(unless, "place_p", "s_p", length="near_p", **by_N)
step(where, "place_n", "s_n", length="near_n", **by_N)
step(where, "place_q", "s_q", length="near_q", **by_N)


# -- its height, by the crank where that is shorter still: S is on MN ----------------------------------------------


@focal.quantity(units="1", symbol="r < p, q", source=POSITION, internal=True)
def height_by_S(s_r: Any, place_p: Any, place_q: Any) -> Any:
    """1 where the crank is shorter than PF or QF, whichever is on the way that is taken, else 0."""
    # heights of P and Q are products, right to roundings of their own: only what stands off them has others
    return select(s_r < abs(place_p) + place_q, 1.0, 0.0)


@focal.quantity(units="1", symbol="r", source=POSITION, internal=True)
def height_r(height_by_S: Any, s_r: Any, place_r: Any) -> Any:
    """The crank where the height of F is taken from S, else 0, scaled."""
    return select(height_by_S == 1.0, s_r, place_r)


step = focal.steps(units="1", source=POSITION)
HEIGHT = {"place_r": "height_r"}
for _bar in "mpnq":
    HEIGHT[f"place_{_bar}"] = f"height_{_bar}"
    step(unless, f"height_{_bar}", f"s_{_bar}", way="height_by_S", length=f"place_{_bar}")


def way(
    place_r: Any,
    g: Any,
    place_m: Any,
    u: Any,
    place_p: Any,
    f: Any,
    place_n: Any,
    v: Any,
    place_q: Any,
    h: Any,
) -> Any:
    """Return a component of the bars of the shorter way."""
    return place_r * g + ((place_m * u - place_p * f) + (place_n * v + place_q * h))


def way_from(start: Any, way: Any) -> Any:
    """Return the component along MN of a vector to F."""
    return start + way


step = focal.steps(units="1", source=f"{WUNDERLICH}, eqs. (1.3), (1.4), (1.7)")
_BARS = {"g": "g_*", "u": "u_*", "f": "f_*", "v": "v_*", "h": "h_*"}
along_x = {name: bar.replace("*", "x") for name, bar in _BARS.items()}
along_y = {name: bar.replace("*", "y") for name, bar in _BARS.items()}
step(way, "way_x", "z_x", "Bars of the shorter way to F, scaled, x", **along_x)
step(way, "MF_y", "z_y", "Vector from M, N or S to F, scaled, y", **HEIGHT, **along_y)
step(way_from, "MF_x", "z_x", "Vector from M to F, scaled, x", start="place_start", way="way_x")
step(way_from, "SF_x", "z_x - s", "Vector from S to F, scaled, x", start="crank_start", way="way_x")
angle_of_crank = focal.quantities(units="rad", source=FIGURES)
angle_of_crank(angle, "sigma", "sigma", "Direction of the crank SF in the ground frame", x="SF_x", y="MF_y")


@focal.quantity(units="1", symbol="(1 + rho) kappa b/(2 d |lambda|)", source=POSITION, internal=True)
def crank_lever(rho_plus_1: Any, root_x: Any, root_rho: Any, s_b: Any, s_d: Any, lambda_: Any) -> Any:
    """p/(2 s)."""
    return 0.5 * rho_plus_1 * (root_x / root_rho) * (s_b / s_d) / abs(lambda_)


@focal.quantity(units="1", symbol="d sigma/d phi", source=POSITION)
def dsigma_dphi(crank_lever: Any, w_y: Any, bar_per_sigma: Any, branch_sign: Any) -> Any:
    """Angular velocity of the crank SF over that of MA."""
    return branch_sign * (crank_lever * w_y * bar_per_sigma)


def where_it_points(rho_plus_1: Any, rate: Any) -> Any:
    """Return the derivative of a direction, which the crank with S at infinity has not."""
    return select(rho_plus_1 == 0.0, NOT_A_NUMBER, rate)


focal.derivatives(focal.position.name)(where_it_points, "sigma", rate="dsigma_dphi")

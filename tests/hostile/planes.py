"""Check functions of both planes: laws of vectors with 50 digits, closed loops, tangents, one door against another."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from mpmath import MPContext

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

MP = MPContext()
MP.dps = 50
#: Sizes of numbers that are checked, as in `checks`; and by how many roundings of them a result may be off.
LEAST, GREATEST, ROUNDINGS = 1e-3, 1e3, 100.0
NOWHERE = MP.nan
VECTORS = frozenset("zwOABC")


def usual(given: dict[str, Any]) -> bool:
    """Tell whether all numbers are of usual sizes, and whether there is one."""
    numbers = np.abs(np.concatenate([np.ravel(value) for value in given.values()]))
    return all(map(np.size, given.values())) and bool(
        np.all((numbers == 0.0) | ((numbers >= LEAST) & (numbers <= GREATEST)))
    )


def numbers_of(given: dict[str, Any]) -> dict[str, Any]:
    """Return the numbers of a call as arrays of one shape; its texts are left out."""
    numbers = {name: np.asarray(value, float) for name, value in given.items() if not isinstance(value, str)}
    return dict(zip(numbers, np.broadcast_arrays(*numbers.values()), strict=True))


def off(what: str, error: Any, size: Any, roundings: float = ROUNDINGS) -> str:
    """Return the text of an error beyond the roundings of a size, or an empty one; NaN is none."""
    error, size = np.abs(error), np.asarray(size)
    return f"{what} is off by {error}" if np.any(error > roundings * UNIT_ROUNDING * size) else ""


# The Minkowskian plane, by the formulas of Hegedues and Moore as they are printed.


def _square(z: Any) -> Any:
    return z[0] * z[0] - z[1] * z[1]


def _norm(z: Any) -> Any:
    return MP.sqrt(abs(_square(z)))


def _between(one: Any, other: Any) -> Any:
    return other[0] - one[0], other[1] - one[1]


def _rapidity(z: Any) -> Any:
    short, long = sorted(z, key=abs)
    return MP.atanh(short / long) if _square(z) else NOWHERE


def _arm(z: Any) -> tuple[Any, Any]:
    """Return the causal type of a vector, and its orientation."""
    return MP.sign(_square(z)), MP.sign(max(z, key=abs)) if _square(z) else MP.mpf(0)


def _angle(z: Any, w: Any) -> Any:
    return _rapidity(w) - _rapidity(z) if _arm(z) == _arm(w) else NOWHERE


def _excess(z: Any, w: Any) -> Any:
    alike = _arm(z) == _arm(w) and _square(z)
    return _norm((z[0] + w[0], z[1] + w[1])) - _norm(z) - _norm(w) if alike else NOWHERE


def _motion(t: Any, a: Any = 0, b: Any = 0) -> list[Any]:
    ch, sh = MP.cosh(t), MP.sinh(t)
    return [ch, sh, MP.mpf(a), sh, ch, MP.mpf(b), MP.zero, MP.zero, MP.one]


def _moved(z: Any, t: Any, a: Any, b: Any) -> list[Any]:
    m = _motion(t, a, b)
    return [m[0] * z[0] + m[1] * z[1] + m[2], m[3] * z[0] + m[4] * z[1] + m[5]]


def _quadrilateral(O: Any, A: Any, B: Any, C: Any) -> list[Any]:
    sides = [_between(O, A), _between(A, B), _between(B, C)]
    ahead = all(_arm(side) == (1, 1) for side in sides)
    return [_norm(_between(O, C)) - sum(map(_norm, sides)) if ahead else NOWHERE]


def _pure(A: Any, B: Any, C: Any) -> list[Any]:
    AB, BC, AC = _between(A, B), _between(B, C), _between(A, C)
    if not _arm(AB) == _arm(BC) == (-1, 1):
        return [MP.zero, *[NOWHERE] * 7]
    a, b, c = map(_norm, (BC, AC, AB))
    angles = [abs(_angle(*pair)) for pair in ((AB, AC), (AB, BC), (BC, AC))]
    return [MP.one, a, b, c, *angles, b - a - c]


def _third_side(a: Any, b: Any, angle: Any) -> list[Any]:
    square = a * a + b * b - 2 * a * b * MP.cosh(angle)
    return [MP.sqrt(square) if square >= 0 else NOWHERE]


def _angle_of_sides(a: Any, b: Any, c: Any) -> list[Any]:
    cosine = (a * a + b * b - c * c) / (2 * a * b)
    return [MP.acosh(cosine) if cosine >= 1 else NOWHERE]


LAWS: dict[str, Callable[..., list[Any]]] = {
    "multiply": lambda z, w: [z[0] * w[0] + z[1] * w[1], z[0] * w[1] + z[1] * w[0]],
    "conjugate": lambda z: [z[0], -z[1]],
    "polar": lambda r, phi: [r * MP.cosh(phi), r * MP.sinh(phi)],
    "scalar_product": lambda z, w: [z[0] * w[0] - z[1] * w[1]],
    "norm": lambda z: [_norm(z)],
    "causal_type": lambda z: [_arm(z)[0]],
    "orientation": lambda z: [_arm(z)[1]],
    "rapidity": lambda z: [_rapidity(z)],
    "hyperbolic_angle": lambda z, w: [_angle(z, w)],
    "boost": lambda phi: [MP.cosh(phi), MP.sinh(phi), MP.sinh(phi), MP.cosh(phi)],
    "motion": _motion,
    "moved": _moved,
    "pure_triangle": _pure,
    "cosine_rule": _third_side,
    "cosine_rule_angle": _angle_of_sides,
    "triangle_excess": lambda z, w: [_excess(z, w)],
    "quadrilateral_excess": _quadrilateral,
}


def _places(given: dict[str, Any]) -> Iterator[tuple[tuple[int, ...], dict[str, Any]]]:
    """Yield the first and the last place of a call, with its numbers there."""
    shapes = {name: np.shape(of)[:-1] if name in VECTORS else np.shape(of) for name, of in given.items()}
    shape = np.broadcast_shapes(*shapes.values())
    if 0 in shape:
        return
    for place in {tuple(0 for _ in shape), tuple(n - 1 for n in shape)}:
        at = {}
        for name, of in given.items():
            values = np.broadcast_to(of, (*shape, 2) if name in VECTORS else shape)[place]
            at[name] = [MP.mpf(float(one)) for one in values] if name in VECTORS else MP.mpf(float(values))
        yield place, at


def double_numbers(result: Any, name: str, given: dict[str, Any]) -> str:
    """Return what is wrong with a function of vectors, by the laws with 50 digits."""
    given = {key: np.asarray(value, float) for key, value in given.items()}
    largest = max((float(np.max(abs(value))) for value in given.values() if value.size), default=0.0)
    for place, at in _places(given):
        if not usual(at):
            continue
        exact = LAWS[name](**at)
        parts = result if isinstance(result, tuple) else (result,)
        found = [float(one) for part in parts for one in np.ravel(np.asarray(part)[place])]
        size = max([abs(float(one)) for one in exact if MP.isfinite(one)], default=0.0)
        for one, wanted in zip(found, exact, strict=True):
            if np.isnan(one) or MP.isnan(wanted) or np.isinf(float(wanted)):
                if np.isfinite(one) or np.isnan(one) != bool(MP.isnan(wanted)):
                    return f"is {one}, with 50 digits {wanted}"
            elif off(name, float(one - wanted), size * (1.0 + largest)):
                return f"is {one}, with 50 digits {float(wanted)}"
    return ""


def circles(found: Any, name: str, given: dict[str, Any]) -> str:
    """Return what is wrong with the circles of a coupler point, by their distances from the turned coupler."""
    of = numbers_of(given)
    a, b, g, h, x, y, X, Y = (of[key] for key in ("a", "b", "g", "h", "x", "y", "X", "Y"))
    if not usual(of) or not np.all(abs(x) > abs(y)):
        return ""
    for angle in (0.3, -1.1):
        ch, sh = np.cosh(angle), np.sinh(angle)
        size = np.sqrt((x - y) * (x + y))
        e = (ch * x - sh * y) / size, (sh * x - ch * y) / size  # e^(j lambda) conj(p)/r
        arm = e[0] * (x - h) + e[1] * y, e[0] * y + e[1] * (x - h)
        for A, B, C, length, centre, end in (
            (found.A1, found.B1, found.C1, b, g, arm),
            (found.A2, found.B2, found.C2, a, 0.0, (size * ch, size * sh)),
        ):
            z = X - centre - end[0], Y - end[1]
            terms = [length, X, Y, centre, *end, x, y, h]
            error = A * ch + B * sh - C - (length**2 - _square(z))
            if wrong := off("a circle", error, np.max(np.square(np.broadcast_arrays(*terms)), axis=0)):
                return wrong
    return ""


# The focal mechanism and Hart's linkages, in complex numbers.


def _corners(a: Any, b: Any, c: Any, d: Any, phi: Any, branch: Any) -> tuple[Any, Any]:
    """Return A and B, by the triangle ABN."""
    A = a * np.exp(1j * phi)
    diagonal = np.abs(A - d)
    along = (diagonal**2 + b**2 - c**2) / (2.0 * diagonal)
    with np.errstate(invalid="ignore"):
        across = np.sqrt(b * b - along * along)
    # seen from A to N, B is to the right in mode 1
    return A, d + (A - d) / diagonal * (along + 1j * np.where(branch == 1, 1.0, -1.0) * across)


def _bars_are(bars: dict[str, tuple[Any, Any]], size: Any) -> str:
    """Return which vector has not the length that it should have."""
    return next(
        (
            wrong
            for name, (vector, length) in bars.items()
            if (wrong := off(name, abs(vector) - abs(length), size))
        ),
        "",
    )


def constructed(made: Any, name: str, given: dict[str, Any]) -> str:
    """Return what is wrong with a mechanism on a position, by the lengths of its bars."""
    of = made.design | made.values | made.position
    if not usual({key: of[key] for key in "abcd"}):
        return ""
    joints = {joint: of[f"{joint}_x"] + 1j * of[f"{joint}_y"] for joint in "ABPQTF"}
    A, B, P, Q, T, F = joints.values()
    d, S = of["d"], of["s"]
    if wrong := off("phi", np.sin(np.angle(A) - of["phi"]), 1.0 + abs(of["phi"])):
        return wrong
    bars = {"MA": (A, of["a"]), "NB": (B - d, of["b"]), "AB": (B - A, of["c"]), "MP": (P, of["m"])}
    bars |= {"NQ": (Q - d, of["n"]), "PF": (F - P, of["p"]), "QF": (F - Q, of["q"]), "SF": (F - S, of["r"])}
    bars |= {"TF": (F - T, of["FT"])}
    # a joint far out moves by its own roundings
    return _bars_are(bars, np.max([abs(end) for pair in bars.values() for end in pair], axis=0))


def touching(conic: Any, name: str, given: dict[str, Any]) -> str:
    """Return which line is not a tangent: the distances of the foci from it have the product of minor squared."""
    of = numbers_of(given)
    if not usual(of):
        return ""
    A, B = _corners(*(of[key] for key in ("a", "b", "c", "d", "phi", "branch")))
    d = of["d"] + 0j
    foci = conic.x1 + 1j * conic.y1, conic.x2 + 1j * conic.y2
    wanted = np.select([conic.kind == 0.0, conic.kind == 1.0], [1.0, -1.0], 0.0) * conic.minor**2
    for line, start, end in (("MA", 0.0 * A, A), ("AB", A, B), ("BN", B, d), ("NM", d, 0.0 * d)):
        along = (end - start) / abs(end - start)
        distances = [((focus - start) * np.conj(along)).imag for focus in foci]
        size = np.max([abs(focus - start) for focus in foci], axis=0) + of["d"]
        if wrong := off(line, distances[0] * distances[1] - wanted, size**2):
            return wrong
    return ""


def paired(rays: Any, name: str, given: dict[str, Any]) -> str:
    """Return which rays to opposite corners are not a pair."""
    of = numbers_of(given)
    A, B = _corners(*(of[key] for key in ("a", "b", "c", "d", "phi", "branch")))
    point, d = of["x"] + 1j * of["y"], of["d"]
    if not usual(of) or np.any(np.isnan(B)):
        return ""
    to_M, to_A, to_B, to_N = (np.angle(corner - point) for corner in (0.0 * A, A, B, d))
    if np.min(abs(np.sin([to_M - to_A, to_A - to_B, to_B - to_N, to_N - to_M]))) < LEAST:
        return ""  # on the line of a bar a ray is of both pairs
    for one, other in ((0.0 * A, B), (A, d), (B, 0.0 * A)):
        turn = rays.partner(np.angle(one - point)) - np.angle(other - point)
        near = np.minimum(abs(one - point), abs(other - point))
        if wrong := off("a ray", np.sin(turn), 10.0 * (1.0 + abs(point) + d) / near):
            return wrong
    return ""


def five_bars(at: Any, name: str, given: dict[str, Any]) -> str:
    """Return which bar of a five-bar has not its length, or which angle is another."""
    of = numbers_of(given)
    if not usual(of):
        return ""
    P, F, Q = (at[f"{joint}_x"] + 1j * at[f"{joint}_y"] for joint in "PFQ")
    bars = {"MP": (P, of["m"]), "PF": (F - P, of["p"]), "FQ": (Q - F, of["q"]), "QN": (Q - of["d"], of["n"])}
    size = np.max([of[key] for key in "mpqnd"], axis=0)
    turns = {
        "omega": np.exp(1j * of["omega_angle"]) * (0.0 - P) * np.conj(F - P),
        "psi": np.exp(1j * at["psi"]) * np.conj(Q - of["d"]) * of["n"],
        "phi": np.exp(1j * of["phi"]) * np.conj(P) * of["m"],
    }
    wrong = (
        off(key, turn.imag, size**2 * (1 + of["omega_angle"] ** 2)) or off(key, turn.real < 0.0, 1.0)
        for key, turn in turns.items()
    )
    return _bars_are(bars, size) or next((one for one in wrong if one), "")


def of_five_bars(design: Any, name: str, given: dict[str, Any]) -> str:
    """Return which bar of a five-bar its focal mechanism has not, up to signs."""
    of = numbers_of(given)
    if not usual(of) or not np.all(np.isfinite(design["c"])):
        return ""
    found = fl.evaluate("focal", list("mnpq"), **design, phi=0.0, allow_invalid=True)
    if not all(np.all(np.isfinite(value)) for value in found.values()):
        return "is not completed"
    wrong = (off(key, abs(found[key]) - abs(of[key]), 10.0 * (1.0 + abs(of[key]))) for key in "mnpq")
    return next((one for one in wrong if one), "")


def held(design: Any, name: str, given: dict[str, Any]) -> str:
    """Return what is not as it was where AB is held, and then AB of that."""
    if not usual(given) or np.any(np.equal(given.get("kappa", 1.0), 0.0)):
        return ""
    if not np.all(np.isin(design.get("completion", 1.0), (1.0, 2.0))):
        return "is not a completion"
    package = fl.focal if "rho" in given else fl.hart
    again = package.held_at_AB(design)
    wrong = (off(key, again[key] - value, abs(np.asarray(value))) for key, value in given.items())
    return next((one for one in wrong if one), "")


#: By the word of a door.
PLANES: dict[str, Callable[[Any, str, dict[str, Any]], str]] = {
    "double numbers": double_numbers,
    "circles": circles,
    "constructed": constructed,
    "touching": touching,
    "paired": paired,
    "five bars": five_bars,
    "of five bars": of_five_bars,
    "held": held,
}

"""The focal mechanism by circles alone: joints as intersections of bars, with 120 digits and no formula of the facts.

The design is what the paper asks of it: lambda - 1 = x of W x = (1 + x)(c^2 + x d^2), eq. (2.5), m p : n q = rho
and p q : m n = x, eqs. (1.9). With the direction of one bar given, all other joints are meets of two circles; which
of both is told by the branch, or by a further bar that has to have its length. Rates are differences, and so is what
a change of an input does.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from mpmath import MPContext

MP: Any = MPContext()
MP.dps = 120
#: Relative step of the differences: half of the digits.
STEP = MP.mpf(10) ** -50


class DoesNotCloseError(Exception):
    """There is no such position, or no such mechanism."""


def turn(z: Any) -> Any:
    """Return the direction of a vector as a complex number of size 1."""
    return z / abs(z)


def angle(z: Any) -> Any:
    """Return the angle of a vector."""
    return MP.arg(z)


def meets(centre: Any, radius: Any, other: Any, other_radius: Any) -> tuple[Any, Any]:
    """Return both points of two circles, that to the left of the line from the first centre to the other one first."""
    span = other - centre
    size = abs(span)
    along = (size**2 + radius**2 - other_radius**2) / (2 * size)
    square = radius**2 - along**2
    if square < 0:
        raise DoesNotCloseError
    across = MP.mpc(0, MP.sqrt(square))
    return centre + (along + across) * span / size, centre + (along - across) * span / size


class Design:
    """Bars of a focal mechanism of given rho and completion."""

    def __init__(self, inputs: Mapping[str, Any]) -> None:
        self.a, self.b, self.c, self.d, self.rho = (inputs[name] for name in ("a", "b", "c", "d", "rho"))
        a, b, c, d, rho = self.a, self.b, self.c, self.d, self.rho
        both = (1 + rho) * (a**2 + rho * b**2) / rho
        middle, free = both - c**2 - d**2, both**2 - 2 * both * (c**2 + d**2) + (c**2 - d**2) ** 2
        if free < 0:
            raise DoesNotCloseError
        far = (middle + MP.sign(middle) * MP.sqrt(free)) / (2 * d**2)
        self.x = far if inputs["completion"] == 1 else (c / d) ** 2 / far
        self.lambda_ = 1 + self.x
        if self.x * rho <= 0:
            raise DoesNotCloseError
        self.m, self.n = a / self.lambda_, b / self.lambda_
        self.p, self.q = MP.sqrt(self.x * rho) * abs(self.n), MP.sqrt(self.x / rho) * abs(self.m)
        self.p *= MP.sign(rho)
        self.S = d * rho / (1 + rho)
        power = (rho * d**2 - (a**2 + rho * b**2) / self.lambda_) / (1 + rho)
        self.r = MP.sqrt(self.S**2 - power)  # eq. (1.6) over n q (1 + rho), at the centre


def crossing(one: Any, along: Any, other: Any, way: Any) -> Any:
    """Return where two lines meet, each through a point along a direction."""
    return one + along * ((other - one) / way).imag / (along / way).imag


def middle_of_circle(one: Any, two: Any, three: Any) -> Any:
    """Return the centre of the circle through three points: where the bisectors of two chords meet."""
    return crossing((one + two) / 2, 1j * (two - one), (one + three) / 2, 1j * (three - one))


def nearest(points: Iterable[Any], origin: Any, length: Any) -> Any:
    """Return the point whose distance from another one is nearest to a length."""
    return min(points, key=lambda z: abs(abs(z - origin) - length))


class Position:
    """All joints, with MA or SF in a given direction."""

    def __init__(self, inputs: Mapping[str, Any], drive: str) -> None:
        self.inputs, self.drive = inputs, drive
        self.design = design = Design(inputs)
        self.M, self.N, self.S = MP.mpc(0), MP.mpc(design.d), MP.mpc(design.S)
        (self._by_rocker if drive == "phi" else self._by_crank)()
        rho = design.rho
        self.T = self.A + rho / (1 + rho) * (self.B - self.A)
        self.u, self.v, self.e = self.A / design.a, (self.B - self.N) / design.b, (self.B - self.A) / design.c

    def _by_rocker(self) -> None:
        design = self.design
        self.A = design.a * MP.expj(self.inputs["phi"])
        left, right = meets(self.A, design.c, self.N, design.b)
        self.B = right if self.inputs["branch"] == 1 else left
        self.P, self.Q = self.A / design.lambda_, self.N + (self.B - self.N) / design.lambda_
        self.F = nearest(meets(self.P, abs(design.p), self.Q, design.q), self.S, design.r)

    def _by_crank(self) -> None:
        design = self.design
        self.F = self.S + design.r * MP.expj(self.inputs["sigma"])
        left, right = meets(self.M, abs(design.m), self.F, abs(design.p))
        self.P = left if (self.inputs["branch"] == 1) == (design.m * design.p > 0) else right
        self.A = design.lambda_ * self.P
        each = (
            self.N + design.lambda_ * (Q - self.N) for Q in meets(self.N, abs(design.n), self.F, design.q)
        )
        self.B = nearest(each, self.A, design.c)
        self.Q = self.N + (self.B - self.N) / design.lambda_

    def angles(self) -> dict[str, Any]:
        """Return the angles of the paper, each between the two bars that enclose it."""
        design, F = self.design, self.F
        between = {
            "alpha": (self.N, F, self.Q),
            "beta": (self.P, F, self.M),
            "chi": (self.A, F, self.M),
        }
        found = {name: angle((to - at) / (start - at)) for name, (start, at, to) in between.items()}
        inner = {"P": (self.M, self.P, F), "Q": (self.N, self.Q, F), "F": (self.P, F, self.Q)}
        for name, (start, at, to) in inner.items():
            found[f"transmission_angle_{name}"] = abs(angle((to - at) / (start - at)))
        found["omega_angle"] = angle((design.m - F / self.u) / design.p)
        return found

    def figure(self) -> dict[str, Any]:
        """Return where opposite sides meet, the circles of section 4, and joints in the frame of AB."""
        M, N, S, F, A = self.M, self.N, self.S, self.F, self.A
        X, Y = crossing(M, self.u, N, self.v), crossing(A, self.e, M, N - M)
        found = {"X_x": X.real, "X_y": X.imag, "Y_x": Y.real}
        circles = {"PFQX": (self.P, F, self.Q), "SFTY": (S, F, self.T), "PSQT": (self.P, S, self.Q)}
        for name, points in circles.items():
            centre = middle_of_circle(*points)
            found |= {f"{name}_x": centre.real, f"{name}_y": centre.imag}
            found[f"{name}_radius"] = abs(points[0] - centre)
        for name, joint in {"M": M, "N": N, "S": S, "F": F}.items():
            seen = (joint - A) / self.e
            found |= {f"{name}_along_AB": seen.real, f"{name}_across_AB": seen.imag}
        return found

    def quantities(self) -> dict[str, Any]:
        """Return what a map has of this position, but for rates."""
        found = self.angles() | self.figure()
        for name in "ABFPQT":
            point = getattr(self, name)
            found |= {f"{name}_x": point.real, f"{name}_y": point.imag}
        if self.drive == "phi":
            found |= {"sigma": angle(self.F - self.S), "psi": angle(self.v)}
        else:
            found |= {"phi": angle(self.u), "psi": angle(self.v)}
        return found


#: Rates by the input position, and the angles that they are derivatives of.
RATES = {
    "phi": {"dpsi_dphi": "psi", "dsigma_dphi": "sigma"},
    "sigma": {"dphi_dsigma": "phi", "dpsi_dsigma": "psi"},
}


def at(inputs: Mapping[str, Any], drive: str) -> dict[str, Any]:
    """Return all quantities of a configuration; rates by differences."""
    inputs = {name: MP.mpf(value) for name, value in inputs.items()}
    step = STEP * max(1, abs(inputs[drive]))
    found = Position(inputs, drive).quantities()
    high, low = (
        Position(inputs | {drive: inputs[drive] + sign * step}, drive).quantities() for sign in (1, -1)
    )
    for rate, of in RATES[drive].items():
        found[rate] = turned(high[of] - low[of]) / (2 * step)
    return found


def turned(change: Any) -> Any:
    """Return a difference of two angles without whole turns."""
    return change - 2 * MP.pi * MP.nint(change / (2 * MP.pi))


def changes(
    inputs: Mapping[str, Any], drive: str, exact: Mapping[str, Any], by: str, names: Iterable[str]
) -> dict[str, Any]:
    """Return abs(x df/dx) of some quantities by an input x."""
    step = 1000 * STEP
    moved = at({**inputs, by: MP.mpf(inputs[by]) * (1 + step)}, drive)
    found = {name: moved[name] - exact[name] for name in names}
    return {name: abs(turned(change) if name in ANGLES else change) / step for name, change in found.items()}


ANGLES = ("alpha", "beta", "chi", "omega_angle", "sigma", "phi", "psi")

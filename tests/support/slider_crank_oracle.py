"""The slider-crank by other means: circle and line, derivatives by differences of 60 digits, free bodies one by one."""

from __future__ import annotations

from typing import Any

import mpmath as mp

from fastlink.precision.reference import HighPrecision
from tests.support.slider_crank_configurations import SLIDER_CRANK

#: What differences of functions with this many digits leave of a first to third derivative, relative to its scale.
DIGITS, DERIVED = 60, mp.mpf("1e-15")


def facts(names, given, alternatives=()) -> dict[str, Any]:
    """Return facts of one configuration with 50 digits."""
    found = HighPrecision(SLIDER_CRANK, names, given, alternatives).at(given)
    return {name: found[name] for name in names}


class Mechanism:
    """One slider-crank: positions of its points by the crank angle, from the quadratic equation of circle and line."""

    def __init__(self, given: dict[str, float], branch: int) -> None:
        self.given = {name: mp.mpf(value) for name, value in given.items()}
        self.sign = 1 if branch == 1 else -1

    def slider(self, theta: Any) -> Any:
        """Return x of B: a root of x^2 - 2 x A_x + |A|^2 - 2 e A_y + e^2 - l^2."""
        r, l, e = (self.given[name] for name in "rle")
        half = r * mp.cos(theta)
        rest = r * r - 2 * e * r * mp.sin(theta) + e * e - l * l
        return half + self.sign * mp.sqrt(half * half - rest)

    def rod(self, theta: Any) -> Any:
        """Return the direction of AB, as the argument of a complex number."""
        A = self.given["r"] * mp.expj(theta)
        return mp.arg(mp.mpc(self.slider(theta), self.given["e"]) - A)

    def centre(self, link: int, theta: Any) -> Any:
        """Return the mass centre of the crank, the rod or the slider as a complex number."""
        A = self.given["r"] * mp.expj(theta)
        B = mp.mpc(self.slider(theta), self.given["e"])
        if link == 3:
            return B
        local = mp.mpc(self.given[f"G{link}_u"], self.given[f"G{link}_v"])
        return local * mp.expj(theta) if link == 1 else A + local * (B - A) / self.given["l"]

    def by_time(self, curve: Any, theta: Any, order: int) -> Any:
        """Return a derivative of a curve by time, at constant speed of the crank."""
        with mp.workdps(DIGITS):
            return mp.diff(curve, mp.mpf(theta), order) * self.given["omega"] ** order

    def momentum(self, theta: Any) -> Any:
        """Return the momentum of all links as a complex number."""
        return sum(
            self.given[f"m{i}"] * self.by_time(lambda t, i=i: self.centre(i, t), theta, 1) for i in (1, 2, 3)
        )

    def acceleration(self, link: int, theta: Any) -> Any:
        """Return the acceleration of a mass centre as a complex number."""
        return self.by_time(lambda t: self.centre(link, t), theta, 2)

    def free_bodies(self, theta: Any, F_load: float = 0.0) -> dict[str, Any]:
        """Return all forces and the torque from the equations of Newton and Euler of the three bodies."""
        given, theta = self.given, mp.mpf(theta)
        A, B = given["r"] * mp.expj(theta), mp.mpc(self.slider(theta), given["e"])
        unknowns = ("F41_x", "F41_y", "F21_x", "F21_y", "F32_x", "F32_y", "side_force", "T41")
        column = {name: k for k, name in enumerate(unknowns)}
        rows, right = mp.zeros(8), mp.zeros(8, 1)

        def add(row: int, name: str, factor: Any) -> None:
            rows[row, column[name]] += factor

        def force(row: int, name: str, at: Any, about: Any, sign: int) -> None:
            arm = at - about
            add(row, f"{name}_x", sign)
            add(row + 1, f"{name}_y", sign)
            add(row + 2, f"{name}_x", -sign * arm.imag)
            add(row + 2, f"{name}_y", sign * arm.real)

        for link, row, forces in (
            (1, 0, (("F41", mp.mpc(0), 1), ("F21", A, 1))),
            (2, 3, (("F21", A, -1), ("F32", B, 1))),
        ):
            centre, acceleration = self.centre(link, theta), self.acceleration(link, theta)
            for name, at, sign in forces:
                force(row, name, at, centre, sign)
            right[row] = given[f"m{link}"] * acceleration.real
            right[row + 1] = given[f"m{link}"] * acceleration.imag
        add(2, "T41", 1)
        right[5] = given["I2"] * self.by_time(self.rod, theta, 2)
        add(6, "F32_x", -1)
        add(7, "F32_y", -1)
        add(7, "side_force", 1)
        right[6] = given["m3"] * self.acceleration(3, theta).real - F_load
        solved = mp.lu_solve(rows, right)
        return {name: solved[k] for name, k in column.items()}

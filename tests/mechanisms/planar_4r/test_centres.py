"""Mass centres, and the vectors r_ij of eq. (9) against differences of positions; what is printed of v."""

import mpmath as mp
import numpy as np
import pytest
from tests.support.configurations import LOADS, PLANAR, under_loads

import fastlink as fl
from fastlink.facts.evaluate import read_facts
from fastlink.plan.request import constants_of, selected_variants

LINKS = (1, 2, 3)
#: The joints at the ends of each link: O, A, B, D are 1, 2, 3, 4.
JOINTS = {1: (1, 2), 2: (2, 3), 3: (3, 4)}
COMBINATIONS = [(), ("acceleration",), ("counterweight1", "counterweight3"), tuple(LOADS)]
# Central differences with a step of 1e-12: 1e-24 times fourth derivatives over second ones, 1e6 at most here.
STEP, RELATIVE = mp.mpf(10) ** -12, mp.mpf(10) ** -15


def facts(names, values):
    """The facts on 50-digit numbers, with the sets of facts that the given inputs choose."""
    variants = selected_variants(PLANAR, None, "eliminated", values)
    values = {name: mp.mpf(value) for name, value in (constants_of(PLANAR, None, variants) | values).items()}
    return read_facts(PLANAR, names, values, variants)


class Bodies:
    """The three links as point masses, positions from the facts of the joints alone."""

    def __init__(self, one):
        self.one = {name: mp.mpf(value) for name, value in one.items()}

    def __getitem__(self, name):
        return self.one.get(name, mp.mpf(0))

    def at(self, time):
        """Positions of everything at a time, the crank being driven from theta1 by omega1 and alpha1."""
        theta = self["theta1"] + self["omega1"] * time + self["alpha1"] * time**2 / 2
        found = facts(["A_x", "A_y", "B_x", "B_y"], {**self.one, "theta1": theta})
        a, b = mp.mpc(found["A_x"], found["A_y"]), mp.mpc(found["B_x"], found["B_y"])
        d = mp.mpc(self["a4"], 0)
        frames = {1: (0, a / abs(a)), 2: (a, (b - a) / abs(b - a)), 3: (d, (b - d) / abs(b - d))}
        return a, b, d, frames

    def points(self, link, frames):
        """Mass and place of the link's own mass centre and of its counterweight."""
        origin, axis = frames[link]
        yield self[f"m{link}"], origin + mp.mpc(self[f"G{link}_u"], self[f"G{link}_v"]) * axis
        if link != 2:
            direction = self.one.get(f"counterweight{link}_direction", mp.pi)
            arm = self[f"counterweight{link}_radius"] * mp.expj(direction)
            yield self[f"counterweight{link}_mass"], origin + arm * axis


def vector(found, name):
    """A vector as a complex number."""
    return mp.mpc(found[f"{name}x"], found[f"{name}y"])


def whole_centre(bodies, link, frames):
    """Mass centre of a link with its counterweight."""
    masses = list(bodies.points(link, frames))
    return sum(mass * place for mass, place in masses) / sum(mass for mass, _ in masses)


@pytest.mark.parametrize("loads", COMBINATIONS, ids="+".join)
def test_mass_centres_and_joints_from_them(loads):
    names = [f"{name}{xy}" for i in LINKS for name in (f"G{i}_", f"G{i}_a") for xy in "xy"]
    names += [f"r{i}{j}_{xy}" for i in LINKS for j in JOINTS[i] for xy in "xy"]
    with mp.workdps(50):
        for seed in range(3):
            one = under_loads(seed, loads)
            bodies = Bodies(one)
            before, (a, b, d, frames), after = (bodies.at(t) for t in (-STEP, mp.mpf(0), STEP))
            found = facts(names, one)
            joints = {1: mp.mpc(0), 2: a, 3: b, 4: d}
            for i in LINKS:
                past, centre, future = (whole_centre(bodies, i, f) for f in (before[3], frames, after[3]))
                assert abs(vector(found, f"G{i}_") - centre) <= RELATIVE
                for j in JOINTS[i]:
                    assert abs(vector(found, f"r{i}{j}_") - (joints[j] - centre)) <= RELATIVE
                acceleration = (future - 2 * centre + past) / STEP**2
                assert abs(vector(found, f"G{i}_a") - acceleration) <= RELATIVE * (1 + abs(acceleration)) * 10


def test_the_printed_second_derivative_of_v_is_another():
    """Section 2 prints (theta'' + theta'^2)(1 + v^2)/2, without the factor v."""
    one = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0, "theta1": 2.0, "branch": 2}
    names = ["v4", "v4_ddot", "joint_omega_4", "joint_alpha_4"]
    v, second, rate, bend = fl.evaluate("planar_4r", names, **one).values()
    assert np.isclose(
        second, (bend + v * rate**2) * (1 + v**2) / 2, rtol=1e-14
    )  # seven roundings, none cancels
    assert abs(second - (bend + rate**2) * (1 + v**2) / 2) > 0.1 * abs(second)

"""What Newton would write down for the loaded four-bar: point masses and spins, from positions alone."""

from __future__ import annotations

import mpmath as mp
import numpy as np

import fastlink as fl
from fastlink.facts.evaluate import read_facts
from fastlink.plan.request import constants_of, selected_variants
from tests.support.configurations import LENGTHS, PLANAR, draw, masses_and_points, random_lengths


def configuration(seed, loads):
    """One random design with these loads, at an angle where it assembles, as numbers."""
    rng = np.random.default_rng(seed)
    while True:
        inputs = dict(zip(LENGTHS, random_lengths(rng, 1), strict=True)) | masses_and_points(rng, 1)
        for load in loads:
            inputs |= draw(PLANAR.variant_inputs[load], rng, 1)
        one = {name: float(value[0]) for name, value in inputs.items()}
        one |= {"theta1": rng.uniform(-np.pi, np.pi), "branch": int(rng.integers(1, 3))}
        if fl.evaluate("planar_4r", ["transmission_angle"], **one)["transmission_angle"] > 0.2:
            return one


def facts(names, values, solver="eliminated"):
    """The facts on 50-digit numbers, with the sets of facts that the given inputs choose."""
    variants = selected_variants(PLANAR, None, solver, values)
    values = {name: mp.mpf(value) for name, value in (constants_of(PLANAR, None, variants) | values).items()}
    return read_facts(PLANAR, names, values, variants)


class Bodies:
    """The three links as point masses and spins, positions from the facts alone: what Newton would write down."""

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


def cross(a, b):
    return a.real * b.imag - a.imag * b.real


def newton_euler(one):
    """What Newton's and Euler's laws say of each link: force and moment about O that the joints must supply."""
    bodies = Bodies(one)
    step = mp.mpf(10) ** -12
    before, now, after = (bodies.at(t) for t in (-step, mp.mpf(0), step))
    gravity = mp.mpc(bodies["gravity_x"], bodies["gravity_y"])
    force, moment = {}, {}
    speed = {}
    for link in (1, 2, 3):
        angles = [mp.arg(frames[link][1] / now[3][link][1]) for *_, frames in (before, now, after)]
        speed[link] = (angles[2] - angles[0]) / (2 * step)
        moment[link] = bodies[f"I{link}"] * (angles[2] - 2 * angles[1] + angles[0]) / step**2
        force[link] = mp.mpc(0)
        places = zip(*(bodies.points(link, frames) for *_, frames in (before, now, after)), strict=True)
        for (mass, past), (_, place), (_, future) in places:
            supplied = mass * ((past - 2 * place + future) / step**2 - gravity)
            force[link] += supplied
            moment[link] += cross(place, supplied)
    origin, axis = now[3][2]
    load = mp.mpc(bodies["FP_x"], bodies["FP_y"])
    force[2] -= load
    moment[2] -= cross(origin + mp.mpc(bodies["P_u"], bodies["P_v"]) * axis, load)
    moment[3] -= bodies["T_load"] + bodies["T_load_linear"] * speed[3]
    moment[3] -= bodies["T_load_quadratic"] * speed[3] * abs(speed[3])
    return force, moment, now

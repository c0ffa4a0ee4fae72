"""Quantities that are not requested cost nothing: a tenth of a study, maps without the input, an axis that only scales.

A tenth of a study needs its share of the study's operations, as `fastlink.explain` counts them, and so its share of
the time; the fact is the ratio of the two for the worst of ten tenths. A fact is (what, value, unit, aim).
"""

import time

import numpy as np

import fastlink as fl
from benchmarks import focal
from benchmarks.engine import bind_results
from benchmarks.inputs import CASES, INPUTS, designs, race
from benchmarks.report import fact_table
from fastlink.app.explain import explain_request
from fastlink.engine.resolve import resolve

#: Thirty curves of the planar 4R, in tenths of what belongs together.
TENTHS = (
    ("A_x", "A_y", "B_x"),
    ("B_y", "P_x", "P_y"),
    ("theta2", "theta4", "transmission_angle"),
    ("omega2", "omega4", "P_vx"),
    ("P_vy", "P_speed", "curvature"),
    ("alpha2", "alpha4", "P_ax"),
    ("F21_x", "F21_y", "F41_x"),
    ("F32_x", "F32_y", "F43_x"),
    ("T41", "F41_y", "F43_y"),
    ("shaking_force", "shaking_moment", "input_power"),
)
GIVEN = (*INPUTS, "P_u", "P_v")
#: What a vector unit could add or multiply meanwhile; the arc tangent is 63 operations and a division.
WORTH = {"/": 8, "sqrt": 8, "atan2, log, cos": 71}
MAP = focal.CASES[0].names
PLAIN = {"threads": 1, "verify": 0}


def operations(resolved):
    """Return the operations of a request for each design and input angle, in additions."""
    (kernel,) = explain_request(resolved).kernels
    loops = [loop.work for loop in kernel.loops if loop.per.startswith("design and")]
    return sum(WORTH.get(kind, 1) * count for work in loops for kind, count in work.items())


def tenths(groups=TENTHS, n=8, K=360, rounds=12):
    """Ask for all, and for each tenth alone; few designs, so that the thirty curves stay in the cache."""
    everything = sum(groups, ())
    x = np.vstack([designs(n), np.full((2, n), 0.3)])
    space = fl.table(dict(zip(GIVEN, x, strict=True)))
    calls, depends_on = {}, {}
    for names in (everything, *groups):
        resolved = resolve("planar_4r", space, names, angles=K)
        (program,) = resolved.plan.programs
        calls[names], depends_on[names] = (
            bind_results(program, GIVEN, x, resolved.positions),
            operations(resolved),
        )
    best = race(calls, rounds)
    whole, *alone = [best[names] / depends_on[names] for names in calls]
    worst = max(alone) / whole
    shares = [best[names] / best[everything] for names in groups]
    return [
        ("3 of 30 curves, time / share of the operations, worst of ten", worst, "", "<= 1.15"),
        ("3 of 30 curves, time / that of all, least of ten", min(shares), "", ""),
        ("3 of 30 curves, time / that of all, greatest of ten", max(shares), "", ""),
    ]


def clock(*calls, rounds):
    """Return the shortest run times in s of calls taken in turns: what this thread computes, without compilation."""
    best = [np.inf] * len(calls)
    for call in calls:
        call()
    for _ in range(rounds):
        for number, call in enumerate(calls):
            start = time.thread_time()
            call()
            best[number] = min(best[number], time.thread_time() - start)
    return best


def without_input(side=24, rounds=12):
    """Time a map of designs with few input angles and with many: it depends on none of them."""
    a, c, rho = np.linspace(3.0, 6.0, side), np.linspace(1.0, 3.0, side), np.geomspace(0.3, 3.0, side)
    space = fl.grid(a=a, b=a, c=c, d=4.0, rho=rho)

    def take(phi):
        return lambda: fl.sweep("focal", space, MAP, phi=phi, **PLAIN)

    few, many = clock(take(36), take(3600), rounds=rounds)
    return [("map of completions, 3600 input angles / 36", many / few, "", "<= 1.05")]


def scaled_axis(names=CASES["extremes"], side=128, values=17, K=360, rounds=6):
    """Add values of omega1 to a map of extremes: what each costs, next to a product in NumPy and to an evaluation."""
    a2, a3 = np.linspace(1.0, 1.4, side), np.linspace(0.6, 1.0, side)
    omega1, a4 = np.linspace(10.0, 50.0, values), np.linspace(0.9, 1.1, 5)
    bars = fl.round_bar(density=7750.0, radius=0.01)

    def take(omega1=25.0, a4=1.0):
        space = fl.grid(a1=0.4, a2=a2, a3=a3, a4=a4, omega1=omega1)
        return fl.sweep("planar_4r", space, names, links=bars, theta1=K, extrema="sampled", **PLAIN)

    found = [take()[name].values for name in names]

    def multiply():
        return [np.multiply(one[:, :, None], omega1[:, None]) for one in found]

    one, scaled, evaluated, product = clock(
        take, lambda: take(omega1=omega1), lambda: take(a4=a4), multiply, rounds=rounds
    )
    each, full = (scaled - one) / (values - 1), (evaluated - one) / (len(a4) - 1)
    return [
        ("one more omega1 in a map of six extremes, by design", 1e9 * each / side**2, "ns", ""),
        ("one more omega1, time / np.multiply", each / (product / values), "", "<= 2.5"),
        ("one more omega1, time / one more a4, evaluated", each / full, "", ""),
    ]


def measure(quick=False, log=lambda text: None):
    """Return all facts; quick: small sizes."""
    log("leave out")
    if quick:
        facts = tenths(TENTHS[:2], 2, 64, rounds=1) + without_input(4, rounds=1)
        return facts + scaled_axis(CASES["extremes"][:1], 64, 65, rounds=2)
    return [*tenths(), *without_input(), *scaled_axis()]


if __name__ == "__main__":
    print(fact_table(measure()))

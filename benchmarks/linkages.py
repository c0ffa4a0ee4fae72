"""Linkages declared by their joints beside the planar 4R, and beside pylinkage where that is installed.

``python -m benchmarks.linkages`` prints the table of docs/linkages.md: kernels of one thread, without the files about
them, a configuration or a design in one branch; all of them are compiled before they are timed, in turns.
"""

import argparse
import time
import warnings

import numpy as np

import fastlink as fl
from benchmarks.cases import bind, markdown, race
from benchmarks.peers import available
from fastlink.mechanisms import catalogue

SIX_BAR = fl.linkage(
    "six_bar",
    ground={"O": (0, 0), "D": ("a4", 0), "G": ("G_x", "G_y")},
    crank={"A": ("O", "a1")},
    dyads={
        "B": {"rrr": ("A", "D"), "lengths": ("a2", "a3")},
        "P": {"on": ("A", "B"), "at": ("P_u", "P_v")},
        "F": {"rrr": ("P", "G"), "lengths": ("a5", "a6")},
    },
    masses={
        link: {"mass": f"m{k}", "inertia": f"I{k}", "centre": (f"G{k}_u", f"G{k}_v")}
        for k, link in enumerate(("OA", "AB", "DB", "PF", "GF"), 1)
    },
)
JANSEN = fl.linkage(
    "jansen",
    ground={"Z": (0, 0), "Y": ("Y_x", "Y_y")},
    crank={"X": ("Z", "l_m")},
    dyads={
        "W": {"rrr": ("X", "Y"), "lengths": ("l_j", "l_b")},
        "V": {"on": ("Y", "W"), "lengths": ("l_d", "l_e")},
        "U": {"rrr": ("X", "Y"), "lengths": ("l_k", "l_c")},
        "T": {"rrr": ("V", "U"), "lengths": ("l_f", "l_g")},
        "S": {"on": ("U", "T"), "lengths": ("l_i", "l_h")},
    },
)
DESIGN = {"a1": 0.1, "a2": 0.3, "a3": 0.35, "a4": 0.4, "P_u": 0.15, "P_v": 0.1}
DESIGN |= {"G_x": 0.45, "G_y": 0.3, "a5": 0.3, "a6": 0.25}
MASSES = {f"{word}{k}": value for k in range(1, 6) for word, value in (("m", 1.0), ("I", 0.01))}
MASSES |= {f"G{k}_{axis}": 0.05 for k in range(1, 6) for axis in "uv"}
#: Jansen's lengths, by his letters.
LEG = {"Y_x": -38.0, "Y_y": -7.8, "l_m": 15.0, "l_j": 50.0, "l_b": 41.5, "l_e": 55.8, "l_d": 40.1}
LEG |= {"l_k": 61.9, "l_c": 39.3, "l_f": 39.4, "l_g": 36.7, "l_h": 65.7, "l_i": 49.0}
#: What is timed: the mechanism, its design, the quantities; at positions, or over the turn.
POSITIONS = {
    "planar 4R: B, theta4, theta2": ("planar_4r", DESIGN, ("B_x", "B_y", "theta4", "theta2")),
    "six-bar: F and both angles of its dyad": (SIX_BAR, DESIGN, ("F_x", "F_y", "angle_PF", "angle_GF")),
    "six-bar: B, F and all angles": (
        SIX_BAR,
        DESIGN,
        ("B_x", "B_y", "angle_AB", "angle_DB", "F_x", "F_y", "angle_PF", "angle_GF"),
    ),
    "Jansen's leg: foot S": (JANSEN, LEG, ("S_x", "S_y")),
}
RATES = {
    "planar 4R: omega2, omega4, alpha2, alpha4": (
        "planar_4r",
        DESIGN,
        ("omega2", "omega4", "alpha2", "alpha4"),
    ),
    "six-bar: omega and alpha of its second dyad": (
        SIX_BAR,
        DESIGN,
        ("omega_PF", "omega_GF", "alpha_PF", "alpha_GF"),
    ),
}
PINS = ("OA_O", "AB_A", "AB_B", "DB_D", "PF_P", "PF_F", "GF_G")
REACTIONS = {
    "planar 4R: all joint forces and the torque": (
        "planar_4r",
        DESIGN | MASSES,
        (*(f"{force}_{axis}" for force in ("F41", "F21", "F32", "F43") for axis in "xy"), "T41"),
    ),
    "six-bar: all joint forces and the torque": (
        SIX_BAR,
        DESIGN | MASSES,
        (*(f"force_{pin}_{axis}" for pin in PINS for axis in "xy"), "torque"),
    ),
    "six-bar: the torque": (SIX_BAR, DESIGN | MASSES, ("torque",)),
}
EXTREMES = {
    "planar 4R: greatest P_x": ("planar_4r", DESIGN, ("P_x_max",)),
    "six-bar: greatest F_x": (SIX_BAR, DESIGN, ("F_x_max",)),
    "six-bar: greatest alpha_GF": (SIX_BAR, DESIGN, ("alpha_GF_max",)),
    "six-bar: status": (SIX_BAR, DESIGN, ("status",)),
    "Jansen's leg: greatest S_y": (JANSEN, LEG, ("S_y_max",)),
}


def designs_of(mechanism, design, n, seed=0):
    """Return n designs within 3 % of one."""
    rng = np.random.default_rng(seed)
    speed = {"omega1" if mechanism == "planar_4r" else "omega": np.full(n, 10.0)}
    named = {name: value for name, value in design.items() if name in catalogue(mechanism).inputs}
    return fl.table({name: value * rng.uniform(0.97, 1.03, n) for name, value in named.items()} | speed)


def times(cases, n, **options):
    """Return the shortest time of each case in s."""
    calls = {}
    for label, (mechanism, design, names) in cases.items():
        branch = 1 if mechanism == "planar_4r" else 3  # which turns fully
        space = designs_of(mechanism, design, n)
        calls[label], _ = bind(names, space, mechanism=mechanism, branch=branch, **options)
    return race(calls)


def by_pylinkage(steps=3600):
    """Return the times in s of a configuration of the six-bar by pylinkage: step by step, and compiled."""
    from pylinkage import Crank, FixedDyad, Ground, Linkage, RRRDyad

    at, pivots = DESIGN, {"O": (0, 0), "D": (DESIGN["a4"], 0), "G": (DESIGN["G_x"], DESIGN["G_y"])}
    ground = {name: Ground(*place, name=name) for name, place in pivots.items()}
    crank = Crank(ground["O"], at["a1"], 2 * np.pi / 360)
    start = fl.evaluate(SIX_BAR, ["B_x", "B_y", "F_x", "F_y"], theta=0.0, branch=3, **at)
    coupler = RRRDyad(crank, ground["D"], at["a2"], at["a3"], start["B_x"], start["B_y"])
    far, turned = np.hypot(at["P_u"], at["P_v"]), np.arctan2(at["P_v"], at["P_u"])
    point = FixedDyad(crank, coupler, far, turned)
    last = RRRDyad(point, ground["G"], at["a5"], at["a6"], start["F_x"], start["F_y"])
    linkage = Linkage([*ground.values(), crank, coupler, point, last])
    started = time.perf_counter()
    for _ in linkage.step(iterations=steps):
        pass
    found, best = [(time.perf_counter() - started) / steps], np.inf
    for _ in range(8):
        started = time.perf_counter()
        linkage.step_fast(iterations=steps)
        best = min(best, (time.perf_counter() - started) / steps)
    return [*found, best]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=4096)
    n, K = parser.parse_args().designs, 360
    rows = []
    for cases in (POSITIONS, RATES, REACTIONS):
        found = times(cases, n, extrema="sampled", angles=K)
        first = next(iter(found.values()))
        rows += [[label, f"{s / n / K * 1e9:.1f} ns", f"{s / first:.2f}"] for label, s in found.items()]
    found = times(EXTREMES, n)
    first = next(iter(found.values()))
    rows += [[label, f"{s / n * 1e6:.2f} us", f"{s / first:.2f}"] for label, s in found.items()]
    if available("pylinkage"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            own = (
                times({"six_bar": POSITIONS["six-bar: F and both angles of its dyad"]}, n, angles=K)[
                    "six_bar"
                ]
                / n
                / K
            )
            for label, seconds in zip(("step", "step_fast"), by_pylinkage(), strict=True):
                took = f"{seconds * 1e9:.0f} ns", f"{seconds / own:.0f} times ours"
                rows.append([f"pylinkage: {label} of the six-bar", *took])
    print(markdown(["", "time", "over the first"], *rows))


if __name__ == "__main__":
    main()

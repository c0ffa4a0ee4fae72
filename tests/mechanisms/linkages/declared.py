"""Linkages that tests share, and random designs of them."""

import numpy as np

import fastlink as fl


def numbered(**links):
    """Return the masses of links by the names that mechanisms by hand have for them."""
    return {
        name: {"mass": f"m{k}", "inertia": f"I{k}", "centre": (f"G{k}_u", f"G{k}_v")}
        for name, k in links.items()
    }


FOUR_BAR = fl.linkage(
    "four_bar",
    ground={"O": (0, 0), "D": ("a4", 0)},
    crank={"A": ("O", "a1")},
    dyads={"B": {"rrr": ("A", "D"), "lengths": ("a2", "a3")}, "P": {"on": ("A", "B"), "at": ("P_u", "P_v")}},
    masses=numbered(OA=1, AB=2, DB=3),
    loads={"P": ("FP_x", "FP_y"), "DB": "T_load"},
    gravity=("gravity_x", "gravity_y"),
)
DECLARED = {
    "name": "six_bar",
    "ground": {"O": (0, 0), "D": ("a4", 0), "G": ("G_x", "G_y")},
    "crank": {"A": ("O", "a1")},
    "dyads": {
        "B": {"rrr": ("A", "D"), "lengths": ("a2", "a3")},
        "P": {"on": ("A", "B"), "at": ("P_u", "P_v")},
        "F": {"rrr": ("P", "G"), "lengths": ("a5", "a6")},
    },
}
SIX_BAR = fl.linkage(**DECLARED)
SLIDER_CRANK = fl.linkage(
    "declared_slider_crank",
    ground={"O": (0, 0), "C": (0, "e")},
    crank={"A": ("O", "r")},
    dyads={"B": {"rrp": "A", "length": "l", "along": ("C", 0)}},
    masses={**numbered(OA=1, AB=2), "B": "m3"},
)
HART = fl.linkage(
    "declared_hart",
    ground={"M": (0, 0), "N": ("d", 0)},
    crank={"A": ("M", "ma")},
    dyads={
        "B": {"rrr": ("A", "N"), "lengths": ("ab", "nb")},
        "P": {"on": ("M", "A"), "at": ("mp", 0)},
        "Q": {"on": ("N", "B"), "at": ("nq", 0)},
        "F": {"rrr": ("P", "Q"), "lengths": ("pf", "qf")},
    },
)
#: A six-bar that turns fully in branch 3.
TURNING = {"a1": 0.1, "a2": 0.3, "a3": 0.35, "a4": 0.4, "P_u": 0.15, "P_v": 0.1}
TURNING |= {"G_x": 0.45, "G_y": 0.3, "a5": 0.3, "a6": 0.25}


def masses(rng, count, *links):
    """Return random masses of links, whose mass centres may be anywhere."""
    found = {f"{word}{k}": rng.uniform(0.1, 3.0, count) for k in links for word in ("m", "I")}
    return found | {f"G{k}_{axis}": rng.uniform(-0.5, 1.0, count) for k in links for axis in "uv"}


def four_bars(count, seed):
    """Return four-bars, of which half are next to change points, down to rounding."""
    rng = np.random.default_rng(seed)
    designs = {name: rng.uniform(0.1, 1.0, count) for name in ("a1", "a2", "a3", "a4")}
    designs |= {name: rng.uniform(-1.0, 1.0, count) for name in ("P_u", "P_v")}
    half = count // 2
    sum_of = abs(designs["a1"] + designs["a2"] - designs["a3"])[:half]
    near = 1.0 + 10.0 ** rng.uniform(-14.0, -1.0, half) * rng.choice([-1.0, 1.0], half)
    designs["a4"][:half] = np.where(sum_of > 1e-3, sum_of * near, designs["a4"][:half])
    loads = {
        name: rng.uniform(-30.0, 30.0, count) for name in ("FP_x", "FP_y", "T_load", "gravity_x", "gravity_y")
    }
    return designs | masses(rng, count, 1, 2, 3) | loads


def slider_cranks(count, seed):
    """Return slider-cranks, of which half are next to change points, down to rounding."""
    rng = np.random.default_rng(seed)
    designs = {"r": rng.uniform(0.1, 1.0, count), "l": rng.uniform(0.1, 1.0, count)}
    designs["e"] = rng.uniform(-0.6, 0.6, count)
    half = count // 2
    sum_of = abs(designs["r"] + rng.choice([-1.0, 1.0], count) * designs["e"])[:half]
    near = 1.0 + 10.0 ** rng.uniform(-14.0, -1.0, half) * rng.choice([-1.0, 1.0], half)
    designs["l"][:half] = np.where(sum_of > 1e-2, sum_of * near, designs["l"][:half])
    return designs | masses(rng, count, 1, 2) | {"m3": rng.uniform(0.1, 3.0, count)}


def six_bars(count, seed):
    """Return six-bars of all kinds: most of them move over parts of the turn."""
    rng = np.random.default_rng(seed)
    spans = {
        "a1": (0.05, 0.4),
        "P_u": (-0.3, 0.5),
        "P_v": (-0.3, 0.3),
        "G_x": (-0.2, 0.8),
        "G_y": (-0.5, 0.5),
    }
    spans |= dict.fromkeys(("a2", "a3", "a4", "a5", "a6"), (0.1, 0.6))
    return {name: rng.uniform(*span, count) for name, span in spans.items()}

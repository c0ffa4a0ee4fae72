"""Configurations of every mechanism and input at each of its degenerate sets, and a few roundings beside it.

A gap is a sum of lengths that is zero where links can lie in one line. Gaps are 1e-17 to 1e-13 of the lengths, of
either sign, or the least that the lengths, as doubles, can have; input positions come as near to the fold.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

import fastlink as fl
from tests.support import configurations, focal_configurations, focal_designs, hart_configurations
from tests.support.slider_crank_configurations import SLIDER_CRANK

Inputs = dict[str, np.ndarray]
Family = Callable[[np.random.Generator, int], Inputs]
#: Signs of a1 ... a4 in each gap: the change points, and the linkages in one line.
GAPS = np.array(
    [
        (1, -1, 1, -1),
        (1, 1, -1, -1),
        (1, -1, -1, 1),
        (1, 1, 1, -1),
        (1, 1, -1, 1),
        (1, -1, 1, 1),
        (-1, 1, 1, 1),
    ]
)


def gaps(rng: np.random.Generator, n: int) -> np.ndarray:
    """Return small numbers of either sign, one in five exactly zero."""
    sizes = 10.0 ** rng.uniform(-17.5, -13.0, n) * rng.choice([-1.0, 1.0], n)
    return np.where(rng.random(n) < 0.2, 0.0, sizes)


def angles(rng: np.random.Generator, n: int, folds: tuple[float, ...]) -> np.ndarray:
    """Return angles from 1e-18 to 1 beside a fold, of either sign, and some exactly there."""
    offset = 10.0 ** rng.uniform(-18.0, 0.0, n) * rng.choice([-1.0, 1.0], n)
    return rng.choice(folds, n) + np.where(rng.random(n) < 0.1, 0.0, offset)


def lengths(rng: np.random.Generator, n: int) -> np.ndarray:
    """Return lengths (4, n) of planar four-bars with a small gap, or two: one link may be far shorter than others."""
    found = rng.uniform(0.3, 2.0, (4, n))
    found[rng.integers(0, 4, n), np.arange(n)] *= 10.0 ** rng.uniform(-3.0, 0.0, n)
    # Of a gap the shortest length follows from the others: its last place is the least gap.
    signs = GAPS[rng.integers(0, len(GAPS), n)].T
    order = np.argsort(found, axis=0)
    for link in order:  # the first that comes out positive
        others = np.sum(signs * found, axis=0) - signs[link, np.arange(n)] * found[link, np.arange(n)]
        solved = -signs[link, np.arange(n)] * others * (1.0 + gaps(rng, n))
        zero = np.abs(np.sum(signs * found, axis=0)) < 1e-12
        new = np.where((solved > 0.0) & ~zero, solved, found[link, np.arange(n)])
        found[link, np.arange(n)] = new
    # Kites, parallelograms, rhombi: pairs of equal lengths.
    pairs = rng.random(n) < 0.4
    partner = np.array([(3, 2, 1, 0), (1, 0, 3, 2), (2, 3, 0, 1)])[rng.integers(0, 3, n)].T
    first = np.array([np.minimum(np.arange(4), each) for each in partner.T]).T
    paired = found[first, np.arange(n)] * (1.0 + gaps(rng, 4 * n).reshape(4, n))
    equal = found[0] * (1.0 + gaps(rng, 4 * n).reshape(4, n))
    found = np.where(pairs, paired, found)
    return np.where(rng.random(n) < 0.05, equal, found)


def beside(rng: np.random.Generator, angle: np.ndarray, limits: Inputs) -> np.ndarray:
    """Return angles of which some are a few roundings from one of the limits, where there is one."""
    limit = np.stack(list(limits.values()))[rng.integers(0, len(limits), angle.size), np.arange(angle.size)]
    limit = limit * (1.0 + gaps(rng, angle.size)) * rng.choice([-1.0, 1.0], angle.size)
    return np.where((rng.random(angle.size) < 0.3) & np.isfinite(limit), limit, angle)


def planar(rng: np.random.Generator, n: int) -> Inputs:
    """Return configurations of the planar 4R driven at O, at folds and toggles."""
    inputs = dict(zip(configurations.LENGTHS, lengths(rng, n), strict=True))
    theta = angles(rng, n, (0.0, 0.0, np.pi))
    toggles = fl.evaluate("planar_4r", ["theta1_low", "theta1_high"], theta1=theta, **inputs)
    theta = beside(rng, theta, toggles)
    return inputs | configurations.masses_and_points(rng, n) | {"theta1": theta}


def loaded(rng: np.random.Generator, n: int) -> Inputs:
    """Return the same under all loads at once."""
    return planar(rng, n) | configurations.all_loads(rng, n)


def driven(joint: int, rng: np.random.Generator, n: int) -> Inputs:
    """Return configurations of the planar 4R driven at another joint, which folds at half a turn."""
    inputs = dict(zip(configurations.LENGTHS, lengths(rng, n), strict=True))
    rate = {f"joint_omega_{joint}": rng.uniform(0.5, 2.0, n)}
    rate |= {name: rng.uniform(-1.0, 2.0, n) for name in ("P_u", "P_v")}
    return inputs | rate | {f"joint_angle_{joint}": angles(rng, n, (-np.pi, np.pi, 0.0))}


def slider_crank(rng: np.random.Generator, n: int) -> Inputs:
    """Return configurations of the slider-crank."""
    r, l = rng.uniform(0.3, 2.0, (2, n)) * 10.0 ** rng.uniform(-2.0, 0.0, (2, n))
    l = np.where(rng.random(n) < 0.3, r * (1.0 + gaps(rng, n)), l)
    e = np.where(rng.random(n) < 0.8, l - r, l + r) * rng.choice([-1.0, 1.0], n)
    e = e * (1.0 + gaps(rng, n)) + np.where(rng.random(n) < 0.5, r * gaps(rng, n), 0.0)
    inputs = {"r": r, "l": l, "e": e}
    for name, declared in SLIDER_CRANK.inputs.items():
        if name not in inputs:
            inputs |= configurations.draw({name: declared}, rng, n)
    theta = angles(rng, n, (0.5 * np.pi, -0.5 * np.pi, 0.0))
    toggles = fl.evaluate("slider_crank", ["theta_low", "theta_high"], theta=theta, **inputs)
    return inputs | {"theta": beside(rng, theta, toggles)}


def hart(rng: np.random.Generator, n: int) -> Inputs:
    """Return configurations of Hart's linkage by phi."""
    m, n_, kappa = *rng.uniform(0.3, 2.0, (2, n)), hart_configurations.some_kappa(rng, n)
    K = abs(kappa)
    kite = rng.random(n) < 0.4
    m = np.where(kite, K * n_ * (1.0 + gaps(rng, n)), m)
    reach = np.array(
        [abs(1 - K) * (m + n_), (1 + K) * abs(m - n_), (1 + K) * (m + n_), abs(1 - K) * abs(m - n_)]
    )
    d = reach[rng.choice(4, n, p=[0.35, 0.35, 0.15, 0.15]), np.arange(n)]
    d = np.where(kite, abs((1.0 - K) * (1.0 + K)) * n_, d) * (1.0 + gaps(rng, n))
    return {"m": m, "n": n_, "d": d, "kappa": kappa, "phi": angles(rng, n, (0.0, 0.0, np.pi))}


def hart_by_line(rng: np.random.Generator, n: int) -> Inputs:
    """Return configurations of Hart's linkage by F_y, from the ends of its line and its middle on."""
    inputs = hart(rng, n)
    ends = fl.evaluate("hart", ["F_y_outer", "F_y_inner"], **inputs)
    del inputs["phi"]
    end = np.nan_to_num(np.where(rng.random(n) < 0.3, ends["F_y_outer"], ends["F_y_inner"]))
    offset = 10.0 ** rng.uniform(-18.0, 0.0, n) * rng.choice([-1.0, 1.0], n)
    return inputs | {
        "F_y": np.where(rng.random(n) < 0.1, end, end * (1.0 - abs(offset)) + offset * inputs["n"])
    }


def focal(drive: str, rng: np.random.Generator, n: int) -> Inputs:
    """Return configurations of the focal mechanism whose four-bar has a gap, or with rho next to where bars vanish."""
    inputs = focal_configurations.random_designs(rng, n)
    # MA, NB, AB, MN are the links 1, 3, 2, 4 of the planar 4R
    inputs |= dict(zip("acbd", lengths(rng, n), strict=True))
    ratio = inputs["a"] / inputs["b"]
    met = focal_designs.meeting(rng, inputs, n)["rho"]
    special = np.array([np.full(n, -1.0), ratio, -(ratio**2), rng.choice(met, n) if met.size else ratio])
    rho = special[rng.integers(0, 4, n), np.arange(n)] * (1.0 + gaps(rng, n))
    inputs["rho"] = np.where(rng.random(n) < 0.3, rho, inputs["rho"])
    return inputs | {drive: angles(rng, n, (0.0, 0.0, np.pi))}


def focal_by(given: str, drive: str, rng: np.random.Generator, n: int) -> Inputs:
    """Return the same given by s or lambda_."""
    inputs = focal(drive, rng, n)
    inputs["rho"] = np.where(inputs["rho"] == -1.0, 1.0, inputs["rho"])  # S is at infinity
    inputs = focal_designs.given_by(given, inputs)
    return {name: values for name, values in inputs.items() if name != "rho"}


def minkowski(rng: np.random.Generator, n: int) -> Inputs:
    """Return configurations of the Minkowskian 4R, of which one in two has a tolerance."""
    inputs = dict(zip("ahbg", lengths(rng, n), strict=True)) | {
        name: rng.uniform(-2.0, 2.0, n) for name in "xy"
    }
    theta = angles(rng, n, (0.0,))
    limits = fl.evaluate("minkowski_4r", ["theta_min", "theta_max", "theta_escape"], theta=theta, **inputs)
    return inputs | {"theta": beside(rng, theta, limits)}


def tolerant(rng: np.random.Generator, n: int) -> Inputs:
    """Return the same with a tolerance about as large as the gaps."""
    return minkowski(rng, n) | {"tolerance": 10.0 ** rng.uniform(-17.0, -13.0, n)}


#: By mechanism, input, and what else is given.
FAMILIES: dict[tuple[str, str, str], Family] = {
    ("planar_4r", "theta1", ""): planar,
    ("planar_4r", "theta1", "loads"): loaded,
    **{("planar_4r", f"joint_angle_{joint}", ""): partial(driven, joint) for joint in (1, 2, 3, 4)},
    ("slider_crank", "theta", ""): slider_crank,
    ("hart", "phi", ""): hart,
    ("hart", "F_y", ""): hart_by_line,
    ("focal", "phi", ""): partial(focal, "phi"),
    ("focal", "sigma", ""): partial(focal, "sigma"),
    ("focal", "phi", "s"): partial(focal_by, "s", "phi"),
    ("focal", "sigma", "lambda_"): partial(focal_by, "lambda_", "sigma"),
    ("minkowski_4r", "theta", ""): minkowski,
    ("minkowski_4r", "theta", "tolerance"): tolerant,
}

"""Designs and positions drawn from all that is legal, most of them next to some degenerate set."""

from functools import partial

import numpy as np

ULP = 2.0**-52


def mixed(rng, n, *makers):
    """Return numbers, each by one of some functions of a count, all as likely."""
    which = rng.integers(len(makers), size=n)
    found = np.empty(n)
    for k, make in enumerate(makers):
        chosen = np.flatnonzero(which == k)
        found[chosen] = make(chosen.size)
    return found


def sign(rng, n):
    return rng.choice([-1.0, 1.0], n)


def powers(rng, n, low, high):
    """Return powers of ten between two exponents."""
    return 10.0 ** rng.uniform(low, high, n)


def beside(rng, values):
    """Return values moved relatively by nothing, some last bits, or a power of ten."""
    n = values.size
    moved = mixed(
        rng,
        n,
        np.zeros,
        lambda k: rng.integers(-6, 7, k) * ULP,
        lambda k: sign(rng, k) * powers(rng, k, -16, -1),
    )
    return values * (1.0 + moved)


def lengths(rng, n, count):
    """Return rows (count, n) of positive lengths."""
    ordinary = rng.uniform(0.2, 2.0, (count, n))
    wide = powers(rng, (count, n), -4, 4)
    whole = rng.integers(1, 9, (count, n)).astype(float)
    found = np.choose(rng.integers(3, size=n), [ordinary, wide, whole])
    kind = rng.integers(4, size=n)
    # equal links: one is a copy of another, sometimes two
    for _ in range(2):
        equal = np.flatnonzero((kind == 1) | ((kind == 2) & (rng.random(n) < 0.3)))
        one, other = rng.integers(count, size=equal.size), rng.integers(count, size=equal.size)
        found[one, equal] = beside(rng, found[other, equal])
    # change points: one is a sum of the others with signs
    folded = np.flatnonzero(kind == 2)
    one, signs = rng.integers(count, size=folded.size), sign(rng, (count, folded.size))
    signs[one, np.arange(folded.size)] = 0.0
    total = abs((signs * found[:, folded]).sum(axis=0))
    found[one, folded] = np.where(total > 0.0, beside(rng, total), found[one, folded])
    return found


def angles(rng, n, *toggles):
    """Return input angles; `toggles` are arrays of angles to be near to, NaN where there are none."""
    quarter = np.pi / 2

    def ordinary(k):
        return rng.uniform(-np.pi, np.pi, k)

    def quarters(k):
        return beside(rng, rng.integers(-4, 5, k) * quarter)

    def near_quarters(k):
        return rng.integers(-2, 3, k) * quarter + sign(rng, k) * powers(rng, k, -17, -1)

    def small(k):
        return sign(rng, k) * powers(rng, k, -60, 0)

    def great(k):
        return sign(rng, k) * powers(rng, k, 0, 20)

    found = mixed(rng, n, ordinary, ordinary, quarters, near_quarters, small, great)
    for toggle in toggles:
        near = np.flatnonzero((rng.random(n) < 0.2) & np.isfinite(toggle))
        found[near] = sign(rng, near.size) * beside(rng, toggle[near])
    return found


def factors(rng, n):
    """Return numbers of any size and sign, some of them 0."""
    return mixed(
        rng,
        n,
        lambda k: rng.uniform(-2.0, 2.0, k),
        lambda k: sign(rng, k) * powers(rng, k, -6, 6),
        lambda k: rng.choice([0.0, 1.0, -1.0, 0.5], k),
    )


def masses(rng, n):
    """Return masses and inertias, some of them 0."""
    return mixed(
        rng,
        n,
        lambda k: rng.uniform(0.0, 2.0, k),
        lambda k: powers(rng, k, -12, 12),
        lambda k: rng.choice([0.0, 1.0], k),
    )


def scaled(rng, design, names, inertias=()):
    """Give a share of the designs lengths far from 1, and inertias as they are with other units of length."""
    n = len(next(iter(design.values())))
    by = np.where(rng.random(n) < 0.15, powers(rng, n, -12, 11), 1.0)
    return (
        design
        | {name: design[name] * by for name in names}
        | {name: design[name] * by**2 for name in inertias}
    )


def four_bar_toggles(crank, coupler, output, ground):
    """Return the angles at the crank where coupler and output link align, nearly."""
    squares, twice = crank**2 + ground**2, 2.0 * crank * ground
    with np.errstate(invalid="ignore"):
        return tuple(np.arccos((squares - (coupler + s * output) ** 2) / twice) for s in (-1.0, 1.0))


LOADS = {
    "gravity": ("gravity_x", "gravity_y"),
    "load": ("FP_x", "FP_y"),
    "torque": ("T_load", "T_load_linear", "T_load_quadratic"),
    "moment point": ("M_x", "M_y"),
    "acceleration": ("alpha1",),
}


def planar_4r(rng, n, joint=0):
    """Return designs of the planar 4R driven at O (0) or by a joint angle, with some of the loads."""
    a = lengths(rng, n, 4)
    design = {f"a{i + 1}": a[i] for i in range(4)}
    if joint:
        crank, coupler, output, ground = (a[(joint - 1 + k) % 4] for k in range(4))
        design |= {name: factors(rng, n) for name in (f"joint_omega_{joint}", "P_u", "P_v")}
        toggles = (np.pi - one for one in four_bar_toggles(crank, coupler, output, ground))
        return scaled(rng, design, (*tuple(design)[:4], "P_u", "P_v")) | {
            f"joint_angle_{joint}": angles(rng, n, *toggles)
        }
    toggles = four_bar_toggles(*a)
    size = a.max(axis=0)
    points = ["P_u", "P_v", *(f"G{i}_{axis}" for i in (1, 2, 3) for axis in "uv")]
    points += [name for name in ("M_x", "M_y") if "moment point" in (chosen := _loads(rng))]
    design |= {name: size * factors(rng, n) for name in points}
    long = tuple(design)
    design |= {f"{name}{i}": masses(rng, n) for i in (1, 2, 3) for name in "mI"}
    design = scaled(rng, design, long, ("I1", "I2", "I3"))
    design["omega1"] = factors(rng, n)
    design |= {name: factors(rng, n) for load in chosen if load != "moment point" for name in LOADS[load]}
    return design | {"theta1": angles(rng, n, *toggles)}


def folded_planar_4r(rng, n):
    """Return designs of the planar 4R whose links come to lie in one line, but for the rounding of the lengths."""
    while True:
        design = planar_4r(rng, 12 * n)
        a = np.array([design[f"a{i + 1}"] for i in range(4)])
        gaps = [a.sum(axis=0) - 2.0 * part for part in (a[0] + a[1], a[0] + a[2], a[0] + a[3], *a)]
        folds = (np.abs(gaps) <= 4.0 * ULP * a.max(axis=0)).any(axis=0)
        (kept,) = np.nonzero(folds & (a.max(axis=0) < 1e6 * a.min(axis=0)))
        if kept.size >= n:
            return {name: values[kept[:n]] for name, values in design.items() if name != "theta1"}


def _loads(rng):
    return [load for load in LOADS if rng.random() < 0.3]


def slider_crank(rng, n):
    """Return designs of the slider-crank."""
    r, l, e = lengths(rng, n, 3)
    e *= rng.choice([-1.0, 0.0, 1.0], n)
    with np.errstate(invalid="ignore"):
        toggles = tuple(np.arcsin((e + s * l) / r) for s in (-1.0, 1.0))
    design = {"r": r, "l": l, "e": e}
    design |= {f"G{i}_{axis}": np.maximum(r, l) * factors(rng, n) for i in (1, 2) for axis in "uv"}
    long = tuple(design)
    design |= {name: masses(rng, n) for name in ("m1", "I1", "m2", "I2", "m3")}
    design = scaled(rng, design, long, ("I1", "I2")) | {"omega": factors(rng, n)}
    if rng.random() < 0.5:
        design["F_load"] = factors(rng, n)
    return design | {"theta": angles(rng, n, *toggles)}


def minkowski_4r(rng, n):
    """Return designs of the Minkowskian 4R."""
    a, b, g, h = lengths(rng, n, 4)
    with np.errstate(invalid="ignore"):
        limits = [np.arccosh((a * a + g * g - (b + s * h) ** 2) / (2.0 * a * g)) for s in (-1.0, 1.0)]
    design = {"a": a, "b": b, "g": g, "h": h}
    design |= {name: np.maximum(a, h) * factors(rng, n) for name in "xy"}
    theta = mixed(
        rng,
        n,
        lambda k: rng.uniform(-4.0, 4.0, k),
        lambda k: sign(rng, k) * powers(rng, k, -20, 0),
        lambda k: sign(rng, k) * powers(rng, k, 0, 2.5),
    )
    for near in (*limits, abs(np.log(g / a))):
        chosen = np.flatnonzero((rng.random(n) < 0.2) & np.isfinite(near))
        theta[chosen] = sign(rng, chosen.size) * beside(rng, near[chosen])
    return scaled(rng, design, tuple(design)) | {"theta": theta}


def focal(rng, n, by_crank=False):
    """Return designs of the focal mechanism, by rho, s or lambda."""
    a, b, c, d = lengths(rng, n, 4)
    design = {"a": a, "b": b, "c": c, "d": d}
    given = rng.choice(["rho", "s", "lambda_"])
    ratio = mixed(
        rng,
        n,
        lambda k: sign(rng, k) * powers(rng, k, -4, 4),
        lambda k: rng.uniform(-2.0, 2.0, k),
        lambda k: beside(rng, rng.choice([-1.0, 1.0], k)),
    )
    design[given] = ratio * d if given == "s" else ratio
    toggles = () if by_crank else four_bar_toggles(a, c, b, d)
    design = scaled(rng, design, ("a", "b", "c", "d", *(["s"] if given == "s" else [])))
    design |= {"omega": factors(rng, n), "completion": rng.integers(1, 3, n).astype(float)}
    return design | {"sigma" if by_crank else "phi": angles(rng, n, *toggles)}


def hart(rng, n, by_line=False):
    """Return designs of Hart's linkage."""
    m, q, d = lengths(rng, n, 3)
    kappa = mixed(
        rng,
        n,
        lambda k: rng.uniform(-2.0, 2.0, k),
        lambda k: sign(rng, k) * powers(rng, k, -6, 3),
        lambda k: beside(rng, rng.choice([-1.0, 1.0, 0.5], k)),
    )
    # kites: m = kappa n and d = (1 - kappa^2) n, or the same of N
    kite = np.flatnonzero((rng.random(n) < 0.2) & (abs(kappa) < 0.99) & (kappa != 0.0))
    m[kite] = beside(rng, abs(kappa[kite]) * q[kite])
    d[kite] = beside(rng, (1.0 - kappa[kite] ** 2) * q[kite])
    ratio = abs(1.0 - kappa * kappa)
    design = {"m": m, "n": q, "d": d}
    if by_line:
        line = d / 2 + (1 - kappa**2) * (m * m - q * q) / (2 * d)
        ends = [np.sqrt(abs((m + s * abs(kappa) * q) ** 2 - line**2)) for s in (-1.0, 1.0)]
        y = mixed(
            rng, n, lambda k: rng.uniform(-1.2, 1.2, k), lambda k: sign(rng, k) * powers(rng, k, -15, 0)
        )
        y *= ends[1]
        for end in ends:
            near = np.flatnonzero(rng.random(n) < 0.2)
            y[near] = sign(rng, near.size) * beside(rng, end[near])
        return scaled(rng, design | {"F_y": y}, ("m", "n", "d", "F_y")) | {"kappa": kappa}
    toggles = four_bar_toggles(ratio * m, abs(kappa) * d, ratio * q, d)
    return scaled(rng, design, ("m", "n", "d")) | {"kappa": kappa, "phi": angles(rng, n, *toggles)}


#: Functions that draw designs and positions, by mechanism and input.
DRAWN = {
    ("planar_4r", "theta1"): planar_4r,
    **{("planar_4r", f"joint_angle_{k}"): partial(planar_4r, joint=k) for k in (1, 2, 3, 4)},
    ("slider_crank", "theta"): slider_crank,
    ("minkowski_4r", "theta"): minkowski_4r,
    ("focal", "phi"): focal,
    ("focal", "sigma"): partial(focal, by_crank=True),
    ("hart", "phi"): hart,
    ("hart", "F_y"): partial(hart, by_line=True),
}

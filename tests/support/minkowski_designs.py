"""Designs of the Minkowskian 4R by the conditions of the paper's theorems, and their facts."""

import numpy as np

from fastlink.facts.evaluate import read_facts
from fastlink.mechanisms.minkowski_4r import minkowski_4r

MANY = 10_000
LENGTHS = "abgh"
#: What the sums T_i add up: signs of a, b, g, h.
SUMS = {
    "T1": (-1, 1, 1, -1),
    "T2": (1, 1, -1, -1),
    "T3": (-1, -1, 1, -1),
    "T4": (-1, 1, 1, 1),
    "T5": (1, 1, 1, -1),
    "T6": (1, -1, 1, 1),
    "T7": (1, 1, 1, 1),
    "T8": (-1, 1, -1, 1),
}
FACTS = [
    name
    for name, fact in minkowski_4r.facts.items()
    if name in SUMS or (not fact.internal and fact.formula.place.startswith("design_facts.facts"))
]


def facts(lengths, names=FACTS, **given):
    """Return facts of designs (4, n) by name; codes as their meanings."""
    values = dict(zip(LENGTHS, np.asarray(lengths, dtype=float), strict=True)) | given
    with np.errstate(all="ignore"):
        found = read_facts(minkowski_4r, names, values, minkowski_4r.variants_selected_by(given))
    return {name: decoded(name, found[name]) for name in names}


def decoded(name, values):
    flags = minkowski_4r.facts[name].flags
    if not flags:
        return values
    meanings = np.full(max(flags) + 1, "", dtype=object)
    meanings[list(flags)] = list(flags.values())
    return meanings[np.asarray(values).astype(int)]


# -- designs ------------------------------------------------------------------------------------------------


def random_lengths(rng, n):
    return np.exp(rng.uniform(-0.9, 0.9, (4, n)))


def whole(rng, n):
    """Three whole numbers of 1024ths, whose sums are exact."""
    return rng.integers(512, 2048, (3, n)) / 1024.0


def one_long(link, excess):
    """Make lengths of which one is the sum of the others, and more by an excess of 1 or nothing."""

    def make(rng, n):
        others = whole(rng, n)
        total = np.sum(others, axis=0)
        return np.insert(
            others, LENGTHS.index(link), total + excess * rng.integers(1, 1024, n) / 1024.0, axis=0
        )

    return make


def reducible(sign):
    """Make lengths with T1 = 0 (sign 1: h = g + b - a) or T2 = 0 (sign -1: h = a + b - g)."""

    def make(rng, n):
        a, b, g = whole(rng, 2 * n)
        h = b + sign * (g - a)
        return np.array([a, b, g, h])[:, h > 0.2][:, :n]

    return make


#: Theorem: designs that meet its condition, and the type it gives them.
THEOREMS = {
    "3.12": (one_long("g", 1), "strange_superrocker_crank"),
    "3.13": (one_long("a", 1), "strange_superrocker_superrocker"),
    "3.14": (one_long("h", 1), "strange_crank_superrocker"),
    "3.15": (one_long("b", 1), "strange_crank_crank"),
    "3.16": (one_long("g", 0), "rigid_rocker_crank"),
    "3.17": (one_long("a", 0), "rigid_rocker_rocker"),
    "3.18": (one_long("h", 0), "rigid_crank_rocker"),
    "3.19": (one_long("b", 0), "rigid_crank_crank"),
    "3.20": (reducible(1), "reducible_crank_crank"),
    "3.21": (reducible(-1), None),
    "3.22": (random_lengths, None),
}


def all_kinds(rng, n):
    """Whole lengths of every kind: with g = b, h = a, g = a and b = h now and then."""
    a, b, g, h = rng.integers(1, 64, (4, n)).astype(float)
    g = np.where(rng.random(n) < 0.2, b, g)
    h = np.where(rng.random(n) < 0.2, a, h)
    g = np.where(rng.random(n) < 0.1, a, g)
    return np.array([a, b, g, np.where(rng.random(n) < 0.2, b, h)])


def near_zero(rng, n):
    """Lengths with some T_i that is 0 but for the last bits, of exponents that differ."""
    bits = np.where(rng.random(n) < 0.5, 20, 52)
    mantissas = np.ldexp(np.rint(np.ldexp(rng.uniform(1.0, 2.0, (4, n)), bits)), -bits)
    lengths = np.ldexp(mantissas, rng.integers(-bits - 8, 3, (4, n)))
    signs = np.array(list(SUMS.values()))[rng.choice([0, 1, 2, 3, 4, 5, 7], n)].T
    # the longest link is what makes the sum vanish, as rounding allows, or a little more
    rest = np.where(np.arange(4)[:, None] == 2, 0.0, signs * lengths)
    last = abs(np.sum(rest, axis=0)) + rng.integers(-2, 3, n) * np.spacing(lengths[2])
    lengths[2] = np.where(last > 0.0, last, lengths[2])
    return lengths


def across(rng, n):
    """Lengths of 1e-20 to 1e20 in one design."""
    return 10.0 ** rng.uniform(-20, 20, (4, n))


#: Where signs and digits may get lost.
FAMILIES = {
    "random": lambda rng, n: np.exp(rng.uniform(-0.9, 0.9, (4, n))),
    "near 0": near_zero,
    "across": across,
    "small": lambda rng, n: 1e-20 * rng.uniform(0.5, 2.0, (4, n)),
    "large": lambda rng, n: 1e20 * rng.uniform(0.5, 2.0, (4, n)),
}

"""Designs of the focal mechanism, easy and hard, and their facts."""

import numpy as np

from fastlink.facts.evaluate import read_facts
from fastlink.mechanisms import catalogue
from fastlink.precision.reference import HighPrecision

FOCAL = catalogue("focal")
LENGTHS = ("a", "b", "c", "d")
#: What a design is given by, and the set of facts that this chooses.
GIVEN = {
    "rho": ((*LENGTHS, "rho"), ()),
    "s": ((*LENGTHS, "s"), ("s",)),
    "lambda_": ((*LENGTHS, "lambda_"), ("lambda_",)),
}
#: What belongs to a design alone.
FACTS = [name for name in FOCAL.public if not FOCAL.varies(name)]
CODES = [name for name in FACTS if FOCAL.facts[name].flags]
NUMBERS = [name for name in FACTS if name not in CODES]


def random_designs(rng, n):
    """Designs of all classes, with rho of either sign."""
    lengths = dict(zip(LENGTHS, rng.uniform(0.2, 2.0, (4, n)), strict=True))
    return lengths | {"rho": 2.0 * rng.normal(size=n)}


def facts(designs, completion, names=FACTS, given="rho"):
    """Return facts of many designs as arrays."""
    inputs, variants = GIVEN[given]
    values = {name: np.asarray(designs[name], dtype=float) for name in inputs}
    values["completion"] = np.full_like(values["a"], completion)
    with np.errstate(all="ignore"):
        found = read_facts(FOCAL, names, values, variants)
    return {name: np.broadcast_to(found[name], values["a"].shape) for name in names}


def exact(names, given="rho"):
    """Return facts with 50 digits, see `Exact.at`."""
    inputs, variants = GIVEN[given]
    return HighPrecision(FOCAL, names, (*inputs, "completion"), variants)


def one(designs, i, completion, given="rho"):
    """Return one design as numbers."""
    return {name: float(designs[name][i]) for name in GIVEN[given][0]} | {"completion": completion}

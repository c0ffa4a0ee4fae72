"""Hart's linkage driven by F along its line: the same positions as driven by MA, every digit, where F can be."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from tests.support.hart_configurations import HART, INPUTS, MEASURES, WUNDERLICH, family
from tests.support.refusals import refused

import fastlink as fl
from fastlink.mechanisms import catalogue
from fastlink.precision.reference import CONTEXT, HighPrecision

BY_LINE = catalogue("hart", "F_y")
DESIGN = INPUTS[:-1]
QUANTITIES = [name for name in BY_LINE.public if BY_LINE.varies(name) and name not in MEASURES]
SHARED = [name for name in QUANTITIES if name in HART.public]
#: In roundings of a double; 2.2 is the worst seen in 2000 configurations of the families.
MULTIPLE = 4


def positions(kind, n):
    """Yield configurations driven by MA that close, all their joints, and the same as driven by F."""
    inputs = family(kind, np.random.default_rng(n), n)
    facts = HighPrecision(HART, ["sigma", "sine_part", "F_y", "stroke", *SHARED], [*INPUTS, "branch"])
    for i in range(n):
        one = {name: float(values[i]) for name, values in inputs.items()}
        for branch in (1, 2):
            found = facts.at(one | {"branch": branch})
            folded = abs(found["F_y"]) <= 1e-10 * found["stroke"]  # a kite, with F at M: phi is undetermined
            if not (mp.isnan(found["sigma"]) or folded):
                design = {name: one[name] for name in DESIGN}
                yield found, design | {"F_y": found["F_y"], "branch": 1 if found["sine_part"] > 0 else 2}


@pytest.mark.parametrize("kind", ["random", "near 1 1e-3", "gap 1e-4", "great"])
def test_it_is_the_position_that_MA_gives(kind):
    facts = HighPrecision(BY_LINE, ["phi", *SHARED], [*DESIGN, "F_y", "branch"])
    compared = 0
    for found, place in positions(kind, 12):
        here = facts.at(place)
        size = max(place[name] for name in "mnd") * max(1.0, place["kappa"] ** 2)
        for name in ("phi", *SHARED):
            assert abs(here[name] - found[name]) <= CONTEXT.mpf(10) ** -40 * (1 + size), name
            compared += 1
    assert compared > 100


def test_rates_are_those_of_the_other_drive():
    for found, place in positions("random", 8):
        rates = HighPrecision(BY_LINE, ["dphi_dF_y", "dpsi_dF_y"], place).at(place)
        given = {name: place[name] for name in DESIGN} | {"phi": found["phi"], "branch": found["branch"]}
        other = HighPrecision(HART, ["dF_y_dphi", "dpsi_dphi"], given).at(given)
        assert abs(rates["dphi_dF_y"] * other["dF_y_dphi"] - 1) <= 1e-40
        assert abs(rates["dpsi_dF_y"] * other["dF_y_dphi"] - other["dpsi_dphi"]) <= 1e-35


@pytest.mark.parametrize("design", [WUNDERLICH, {"m": 1.0, "n": 8.0, "d": 7.0, "kappa": 0.5}])
def test_it_assembles_along_the_stroke_alone(design):
    told = fl.evaluate("hart", ["F_y_outer", "F_y_inner"], phi=1.0, **design)
    y = np.linspace(-1.01, 1.01, 2000) * told["F_y_outer"]
    maps = fl.sweep("hart", fl.grid(**design), ["phi", "F_x", "P_y"], input="F_y", angles=y)
    inside = (np.abs(y) <= told["F_y_outer"]) & (np.abs(y) >= told["F_y_inner"])
    for name in ("phi", "F_x", "P_y"):
        np.testing.assert_array_equal(np.isfinite(maps[name]), [inside, inside])
    assert maps.phi.dims == ("branch", "F_y")


def test_what_it_does_not_tell_is_said():
    with refused("'dF_y_dphi'", "'dphi_dF_y'"):
        fl.sweep("hart", fl.grid(**WUNDERLICH), ["dF_y_dphi"], input="F_y")
    with refused("F_y", "write a flat array of numbers"):
        fl.sweep("hart", fl.grid(**WUNDERLICH), ["phi"], input="F_y", F_y=[[0.1]])
    with refused("input", "did you mean 'F_y'?"):
        fl.sweep("hart", fl.grid(**WUNDERLICH), ["psi"], input="F_x")
    with refused("angles", "numpy.linspace"):
        fl.sweep("hart", fl.grid(**WUNDERLICH), ["psi"], input="F_y", angles=12)

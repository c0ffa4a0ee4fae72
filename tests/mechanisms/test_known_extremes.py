"""Extremes that are known in closed form: what a search finds."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from tests.support.extremes import SEARCHED, designs_of
from tests.support.registry import Entry
from tests.support.sweeps import sweep_4r, sweep_both

import fastlink as fl
from fastlink.facts.catalogue import Catalogue
from fastlink.mechanisms import catalogue
from fastlink.plan.programs import KnownProgram, make_plan

KNOWN = [entry for entry in SEARCHED if entry.catalogue.graded.known]
MANY = [e for e in KNOWN if len(e.catalogue.graded.known) > 4 and e.mechanism != "focal"]
#: Both ways evaluate by the same facts, at places that differ by roundings: their bounds are the same but for a few
#: of the second order. A place where nothing is extreme is not told from its neighbours by rounding.
ALIKE = 1.01
#: Beside kites of Hart's linkage the slope that is computed at a place is not 0 but within its bound: the square of the
#: sum of both, which the bound of the value has, is four times that of the bound alone. 2.8 at most in 2,000 designs.
ALIKE_OF = {"hart": 4.0}
LENGTHS = ("a1", "a2", "a3", "a4")
#: Change points, kites, parallelograms, rhombi, rigid and impossible linkages.
FOLDING = "1221 2112 1122 2211 1212 2121 1111 2345 5432 4523 1234 6123 1623 1236 7123"


@contextmanager
def searched(of: Catalogue) -> Iterator[None]:
    """Let every extreme be searched."""
    graded = of.graded
    assert graded is not None
    of.graded = replace(graded, known={})
    try:
        yield
    finally:
        of.graded = graded


def assert_alike(mechanism: str, input: str | None, designs: dict[str, np.ndarray]) -> None:
    """Assert that known extremes are those that a search finds, with their bounds."""
    of = catalogue(mechanism, input)
    assert of.graded is not None
    ends = [f"{name}_{end}" for name in of.graded.known for end in ("max", "min")]
    names = [name + part for name in ends for part in ("", "_error")]
    known = sweep_both(mechanism, fl.table(designs), names, input=input)
    with searched(of):
        found = sweep_both(mechanism, fl.table(designs), names, input=input)
    for name in ends:
        one, other = known[name].values, found[name].values
        bound, other_bound = known[f"{name}_error"].values, found[f"{name}_error"].values
        assert np.array_equal(np.isnan(one), np.isnan(other)), name
        assert np.array_equal(np.isnan(bound), np.isnan(other_bound)), name
        there = ~np.isnan(one)
        assert np.all(abs(one - other)[there] <= (bound + other_bound)[there]), name
        alike = ALIKE_OF.get(mechanism, ALIKE)
        assert np.all(bound[there] <= alike * other_bound[there] + np.spacing(abs(other))[there]), name


def drawn(entry: Entry, family: str, n: int) -> dict[str, np.ndarray]:
    """Return designs of a family, in one completion."""
    designs = designs_of(entry, family, 0, n)
    return {name: values for name, values in designs.items() if name != "completion"}


@pytest.mark.sample(1)
@pytest.mark.parametrize("entry", MANY, ids=str)
def test_known_extremes_are_those_that_a_search_finds(entry):
    """Of all families together; the inputs with one law or two are left to the long form."""
    parts = [drawn(entry, family, 3) for family in entry.families]
    designs = {name: np.concatenate([each[name] for each in parts]) for name in parts[0]}
    assert_alike(entry.mechanism, entry.input, designs)


@pytest.mark.stress
@pytest.mark.parametrize("entry", KNOWN, ids=str)
def test_known_extremes_are_those_that_a_search_finds_in_many_designs(entry):
    for family in entry.families:
        assert_alike(entry.mechanism, entry.input, drawn(entry, family, 2000))


@pytest.mark.parametrize("longest", [0, pytest.param(9, marks=pytest.mark.stress)])
def test_known_extremes_of_linkages_that_fold(longest):
    """Exact change points, and linkages that assemble in one position or never; all whole lengths in the long form."""
    lengths = np.array([[float(digit) for digit in design] for design in FOLDING.split()]).T
    if longest:
        lengths = np.stack(np.meshgrid(*[np.arange(1.0, longest + 1.0)] * 4), axis=-1).reshape(-1, 4).T
    assert_alike("planar_4r", None, dict(zip(LENGTHS, lengths, strict=True)))


def test_places_are_those_of_a_search_and_hold_the_extreme():
    """Of linkages without symmetry. At theta1 as a double a slope of up to 1e8 next to a toggle may count."""
    designs = dict(zip(LENGTHS, np.random.default_rng(1).uniform(0.2, 2.0, (4, 400)), strict=True))
    names = [f"{name}_{end}" for name in ("theta4", "B_x") for end in ("max", "min")]
    places = [f"theta1_at_{name}" for name in names]
    known = sweep_4r(fl.table(designs), [*names, *places])
    with searched(catalogue("planar_4r")):
        found = sweep_4r(fl.table(designs), places)
    for name, place in zip(names, places, strict=True):
        apart = abs(known[place] - found[place]).values
        # a place where the slope is 0 to a rounding is known to its root
        assert np.nanmax(np.minimum(apart, abs(apart - 2 * np.pi))) < 1e-6, name
        assert np.array_equal(np.isnan(known[place]), np.isnan(known[name]))


@pytest.mark.parametrize("quantity", ["transmission_angle", pytest.param("theta4", marks=pytest.mark.stress)])
def test_derivatives_of_known_extremes_are_those_that_a_search_finds(quantity):
    """With what they are worth, of linkages of every kind, next to change points and at them."""
    random = np.random.default_rng(4).uniform(0.2, 2.0, (4, 60))
    whole = np.array([[float(digit) for digit in design] for design in FOLDING.split()]).T
    near = whole * (1.0 + 1e-9 * np.random.default_rng(5).uniform(-1.0, 1.0, whole.shape))
    # a kite whose link stands still has an extreme everywhere: which one is found is rounding
    designs = dict(zip(LENGTHS, np.concatenate([random, near, whole[:, 7:]], axis=1), strict=True))
    ends = [f"{quantity}_{end}" for end in ("max", "min")]
    slopes = [f"d_{of}_d_{by}" for end in ends for of in (end, f"theta1_at_{end}") for by in LENGTHS]
    names = [*slopes, *(f"{end}_gradient_status" for end in ends)]
    known = sweep_4r(fl.table(designs), names)
    with searched(catalogue("planar_4r")):
        found = sweep_4r(fl.table(designs), names)
    for end in ends:
        assert np.array_equal(known[f"{end}_gradient_status"], found[f"{end}_gradient_status"])
    for name in slopes:
        # the place is off by a rounding over the curvature: of gaps of 1e-9 in the root, 3e-5
        assert np.allclose(known[name], found[name], rtol=1e-4, atol=1e-9, equal_nan=True), name


def test_what_is_known_is_not_searched():
    """The plan tells; lists and what a variant replaces are searched."""
    planar = catalogue("planar_4r")
    names = ["transmission_angle_max", "omega4_max", "theta4_extrema"]
    kinds = [type(p) is KnownProgram for p in make_plan(planar, names, given=list(planar.inputs)).programs]
    assert sorted(kinds) == [False, False, True] or sorted(kinds) == [False, True]
    text = fl.explain("planar_4r", fl.grid(a1=1, a2=2, a3=2, a4=3), ["theta4_max"], branch=(1, 2)).text(
        kernels=True
    )
    assert "theta4_max; known extremes, which are not searched, of theta4" in text
    by_crank = catalogue("focal", "sigma")
    asked, given = ["transmission_angle_P_max"], ["a", "b", "c", "d", "lambda_", "completion"]
    (program,) = make_plan(
        by_crank, asked, given=given, variants=by_crank.variants_selected_by(given)
    ).programs
    assert type(program) is not KnownProgram

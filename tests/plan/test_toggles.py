"""Integrals over a turn that do not exist: decided by how quantities grow at toggles, which is measured here."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.errors import InputError
from fastlink.facts.evaluate import evaluate_on_doubles, read_facts
from fastlink.facts.formula import CatalogueError
from fastlink.facts.tables import angle_tables
from fastlink.mechanisms import NAMES, catalogue, inputs_of
from fastlink.plan.programs import Planner

DRIVEN = [
    (mechanism, input)
    for mechanism in NAMES
    for input in inputs_of(mechanism)
    if catalogue(mechanism, input).graded is not None
]
#: Over the width of the range; sigma is their root.
DISTANCES = (1e-4, 1e-7)
#: Tangents of half angles are infinite wherever the angle passes pi, which a toggle may be; the bound of derivatives of
#: the curvature, whose parts grow and cancel, is 2 where they grow by 1.
LOOSE = ("v1", "v2", "v3", "v4", "curvature", "residual")
#: Derivatives by lengths whose parts grow and cancel, by mechanism and input: the bound is 1 where they stay finite.
CANCELS = {
    ("planar_4r", "joint_angle_2"): ("B_x",),
    ("planar_4r", "joint_angle_3"): ("A_x",),
    ("focal", "phi"): ("N_along_AB",),
    ("hart", "phi"): ("N_along_AB",),
}
TABLE_1 = ("a1", "a2", "a3", "a4")
PARTIAL, TURNING = (1.0, 0.6, 0.7, 1.2), (0.4, 1.2, 0.8, 1.0)


def draw(mechanism, rng, n):
    design = {}
    for name, given in mechanism.inputs.items():
        design[name] = rng.uniform(-1.5, 1.5, n) if given.rule == "any" else rng.uniform(0.3, 2.0, n)
        if given.choices:
            design[name] = rng.choice(list(given.choices), n).astype(float)
    return design | {"branch": np.ones(n)}


def near_toggles(mechanism, design, n):
    """Return for each end input positions at both distances from it, and which designs have a toggle there."""
    graded, position = mechanism.graded, mechanism.position.name
    for end, (_, _, toggle) in enumerate(graded.ends):
        thetas = []
        for distance in DISTANCES:
            places = [np.full(n, distance), np.full(n, 1.0 - distance)]
            coordinates = dict(
                zip(graded.coordinates, [*(places if end == 0 else places[::-1]), np.ones(n)], strict=True)
            )
            found = read_facts(mechanism, [position, toggle], design | coordinates, (graded.name,))
            thetas.append(np.broadcast_to(found[position], n).copy())
        yield thetas, np.broadcast_to(found[toggle] > 0.0, n)


def measured_order(mechanism, name, design, places, n):
    """Return the median power of 1/sigma by which a quantity grows from the one distance to the other."""
    tables = (mechanism.position.name, *mechanism.tables, *mechanism.table_low_parts)
    steps = tuple(mechanism.dependencies([name], (*mechanism.inputs, *tables, "branch")))
    orders = []
    for thetas, there in places:
        values = []
        for theta in thetas:
            known = design | dict(zip(tables, angle_tables(mechanism, tables, theta), strict=True))
            evaluate_on_doubles(steps, known)
            values.append(np.broadcast_to(known[name], n))
        with np.errstate(all="ignore"):
            grown = 2.0 * np.log(np.abs(values[1] / values[0])) / np.log(DISTANCES[0] / DISTANCES[1])
        orders += list(grown[there & np.isfinite(grown)])
    return max(float(np.median(orders)), 0.0) if orders else None


def assert_orders_decide_alike(mechanism, input, derivatives):
    cancels = CANCELS.get((mechanism, input), ())
    mechanism, n = catalogue(mechanism, input), 24
    with np.errstate(all="ignore"):
        design = draw(mechanism, np.random.default_rng(5), n)
        places = list(near_toggles(mechanism, design, n))
    public = [name for name, fact in mechanism.public.items() if mechanism.varies(name) and not fact.flags]
    tested = 0
    for quantity in public:
        if any(word in quantity for word in LOOSE):
            continue
        for name in [f"d_{quantity}_d_{by}" for by in mechanism.inputs] if derivatives else [quantity]:
            try:
                order = Planner(mechanism, tuple(mechanism.inputs)).order_at_toggles(name)
                measured = measured_order(mechanism, name, design, places, n) if order is not None else None
            except (InputError, CatalogueError):
                continue  # it needs a load, or has no derivative
            if measured is not None:
                # by the next power of sigma a value differs by 1e-3 or so; orders are whole numbers
                decided = [order >= least for least in (1, 2)]
                if derivatives and quantity in cancels:
                    assert order >= round(measured)
                    continue
                assert decided == [measured > least - 0.5 for least in (1, 2)], (name, order, measured)
                tested += 1
    assert tested >= 10


@pytest.mark.sample(3)
@pytest.mark.parametrize(("mechanism", "input"), DRIVEN)
def test_quantities_grow_at_toggles_as_their_facts_say(mechanism, input):
    assert_orders_decide_alike(mechanism, input, derivatives=False)


@pytest.mark.stress
@pytest.mark.parametrize(("mechanism", "input"), DRIVEN)
def test_derivatives_grow_at_toggles_as_their_facts_say(mechanism, input):
    assert_orders_decide_alike(mechanism, input, derivatives=True)


def swept(lengths, names, **options):
    space = fl.grid(**dict(zip(TABLE_1, lengths, strict=True)), omega1=2.0)
    return fl.sweep("planar_4r", space, names, **{"theta1": 90, "branch": 1, "verify": 1} | options)


def test_integrals_that_do_not_exist_are_not_finite():
    names = ["omega4_rms", "omega4_mean", "alpha4_rms", "alpha4_mean"]
    names += ["theta4_rms", "theta4_mean", "omega4_fluctuation"]
    partial, turning = swept(PARTIAL, names), swept(TURNING, names)
    assert partial.omega4_rms == partial.alpha4_rms == np.inf
    assert np.isnan(partial.alpha4_mean)
    assert np.isnan(partial.omega4_fluctuation)
    for name in ("omega4_mean", "theta4_rms", "theta4_mean"):
        assert np.isfinite(partial[name])
    for name in names:
        assert np.isfinite(turning[name])
        assert partial[name].attrs["verify_mismatches"] == turning[name].attrs["verify_mismatches"] == 0


def test_derivatives_and_reductions_over_given_angles_grow_as_their_own_facts():
    """Once these means were taken for divergent: their order was that of the derivative by the position."""
    names = ["d_omega4_d_omega1_mean", "d_P_x_d_P_u_rms", "omega4_mean"]
    space = fl.grid(**dict(zip(TABLE_1, PARTIAL, strict=True)), omega1=2.0, P_u=0.5, P_v=0.25)
    found = fl.sweep("planar_4r", space, names, positions=90, branch=1)
    # omega4 is in proportion to omega1: a division by 2, which is exact
    assert found.d_omega4_d_omega1_mean == found.omega4_mean / 2.0
    assert 0.0 < found.d_P_x_d_P_u_rms <= 1.0
    angles = np.arange(90) * (2.0 * np.pi / 90)
    values = swept(PARTIAL, ["omega4"], theta1=angles).omega4.values
    found = swept(PARTIAL, ["omega4_rms"], theta1=angles)
    # a rounding for each sum, of 90 positive terms
    assert_allclose(found.omega4_rms, np.sqrt(np.nanmean(values**2)), rtol=90 * 2.0**-53)
    same = swept(PARTIAL, ["omega4_rms"], extrema="sampled")
    assert_array_equal(found.omega4_rms, same.omega4_rms)


def test_a_gap_between_two_samples_counts_and_what_is_zero_everywhere_has_a_mean():
    """The input misses 2e-3 rad on both sides of pi, where none of 7 samples is."""
    lengths = (1.0, 1.1, 1.1 - 1e-6, 1.2)
    sampled = swept(lengths, ["omega4_rms", "omega4"], theta1=7, extrema="sampled")
    assert np.isfinite(sampled.omega4).all()
    assert np.isfinite(sampled.omega4_rms)
    assert swept(lengths, ["omega4_rms"], theta1=7).omega4_rms == np.inf
    space = fl.grid(**dict(zip(TABLE_1, PARTIAL, strict=True)), omega1=0.0)
    found = sweep_4r(space, ["omega4_rms", "alpha4_mean"], theta1=90)
    assert np.all(found.omega4_rms == 0.0)
    assert np.all(found.alpha4_mean == 0.0)

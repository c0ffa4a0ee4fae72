"""Error bounds at degenerate designs and extreme inputs: they hold for the numbers as given, or are infinite."""

import contextlib

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.configurations import numbers
from tests.support.extremes import SEARCHED, bounded_extremes
from tests.support.neighbourhoods import DRAWN
from tests.support.sweeps import sweep_4r

import fastlink as fl
from fastlink.facts.bounds import SMALL_ANGLE
from fastlink.facts.derivative import NoDerivative
from fastlink.facts.powers import limits
from fastlink.mechanisms import NAMES, catalogue, inputs_of
from fastlink.plan.request import selected_variants
from fastlink.precision.reference import CONTEXT, HighPrecision

#: A change point but for 1e-16: the gap is within the rounding of the lengths.
NEARLY = numbers("a1=0.6286585380403462 a2=1.197852049758225 a3=0.8341289441152699 a4=0.9923816436833014")
#: Inputs with respect to which derivatives are taken: a length, and some that stand in one term alone.
BY = {
    "planar_4r": ("a4", "m1", "FP_y"),
    "slider_crank": ("e", "l", "m1"),
    "hart": ("kappa",),
    "focal": ("d", "rho"),
    "minkowski_4r": ("h", "x"),
}
SIZES = np.array([0.0, 5e-324, *(10.0**k for k in (-300, -150, -60, -23, -8, 0, 8, 23, 60, 150, 300))])


def test_every_mechanism_and_input_is_drawn():
    assert set(DRAWN) == {(name, drive) for name in NAMES for drive in inputs_of(name)}


def bounded(of, inputs):
    """Return the quantities that have an error bound, but those that are nothing but errors."""
    measures = ("residual", "deviation")
    return [
        name
        for name, one in of.public.items()
        if not (one.flags or name in inputs or any(word in name for word in measures))
    ]


def slopes(of, names, by, inputs):
    """Return the names of the derivatives that there are, each with its quantity."""
    variants = selected_variants(of, None, "eliminated", inputs)
    found = {}
    for name in names:
        with contextlib.suppress(NoDerivative):
            of.resolve(f"d_{name}_d_{by}", variants, variants)
            found[f"d_{name}_d_{by}"] = name
    return found


def drawn(mechanism, drive, n, seed=7):
    """Return configurations at degenerate sets and beside them, with their assembly modes."""
    rng = np.random.default_rng(seed)
    inputs = DRAWN[mechanism, drive](rng, n)
    if mechanism == "planar_4r" and drive == "theta1":
        inputs |= {
            name: np.zeros(n) for name in ("M_x", "M_y")
        }  # where shaking_moment_at has its point, by default
    return inputs | {"branch": inputs.get("branch", rng.integers(1, 3, n).astype(float))}


def evaluated(mechanism, drive, names, inputs):
    """Return values, bounds and trusts as arrays (quantities, configurations)."""
    n = inputs["branch"].size
    asked = {ending: [f"{name}{ending}" for name in names] for ending in ("", "_error", "_trust")}
    every = [name for each in asked.values() for name in each]
    values = fl.evaluate(mechanism, every, input=drive, allow_invalid=True, **inputs)  # NaN beyond the range
    return [np.array([np.broadcast_to(values[one], n) for one in each]) for each in asked.values()]


@pytest.mark.sample(2)
@pytest.mark.parametrize("n", [12, pytest.param(1000, marks=pytest.mark.stress)])
@pytest.mark.parametrize(("mechanism", "drive"), DRAWN)
def test_bounds_of_derivatives_hold(mechanism, drive, n):
    """By the position and by an input, against 50 digits of the very same doubles."""
    of, inputs = catalogue(mechanism, drive), drawn(mechanism, drive, n)
    finite = 0
    for by in (drive, BY[mechanism][0]):
        names = list(slopes(of, bounded(of, inputs), by, inputs))
        values, bounds, trusts = evaluated(mechanism, drive, names, inputs)
        facts = HighPrecision(of, names, inputs, selected_variants(of, None, "eliminated", inputs))
        for i in np.flatnonzero(np.isfinite(values).any(axis=0)):
            at = {name: float(column[i]) for name, column in inputs.items()}
            exact = facts.at(at)
            for k in np.flatnonzero(np.isfinite(values[:, i])):
                bound, name = float(bounds[k, i]), names[k]
                finite += bound < np.inf
                if not bound < np.inf:
                    assert trusts[k, i] == 1.0, (name, at)
                    continue
                assert CONTEXT.isfinite(exact[name]), (name, at, bound)
                error = abs(CONTEXT.mpf(float(values[k, i])) - exact[name])
                assert error <= bound, (name, at, float(error), bound)
    assert finite > n


def with_extremes(of, inputs):
    """Return the same, every number in four an extreme one."""
    rng, n = np.random.default_rng(8), inputs["branch"].size
    known = of.known_inputs(of.variants_selected_by(inputs))
    for name, values in inputs.items():
        if name == "branch" or (name in known and known[name].choices):
            continue
        rule = known[name].rule if name in known else "any"
        least, most = limits(known[name].units, rule) if name in known else (0.0, np.inf)
        sizes = SIZES[(most > SIZES) & ((least < SIZES) | ((SIZES == 0.0) & (rule != "positive")))]
        size = rng.choice(sizes, n)
        extreme = size * rng.choice([-1.0, 1.0], n) if rule == "any" else size
        inputs = inputs | {name: np.where(rng.random(n) < 0.25, extreme, values)}
    return inputs


@pytest.mark.sample(2)
@pytest.mark.parametrize("n", [200, pytest.param(20_000, marks=pytest.mark.stress)])
@pytest.mark.parametrize(("mechanism", "drive"), DRAWN)
def test_a_bound_is_a_number_where_the_value_is_one(mechanism, drive, n):
    of, plain = catalogue(mechanism, drive), drawn(mechanism, drive, n)
    for inputs in (plain, with_extremes(of, plain)):
        names = bounded(of, inputs)
        for asked in (names, list(slopes(of, names, drive, inputs))):
            values, bounds, trusts = evaluated(mechanism, drive, asked, inputs)
            finite = np.isfinite(values)
            assert [asked[k] for k in np.flatnonzero((finite & np.isnan(bounds)).any(axis=1))] == []
            assert (trusts[finite & ~(bounds < np.inf)] == 1.0).all()
            assert finite.sum() > n


@pytest.mark.sample(3)
@pytest.mark.parametrize("n", [120, pytest.param(3000, marks=pytest.mark.stress)])
@pytest.mark.parametrize(("mechanism", "drive"), DRAWN)
def test_no_derivative_is_finite_where_its_quantity_is_not(mechanism, drive, n):
    """Though its own text may not depend on that; at exactly 0, and with the crank's pivot at infinity, too."""
    of, inputs = catalogue(mechanism, drive), drawn(mechanism, drive, n)
    inputs[drive] = np.where(np.arange(n) < 12, 0.0, inputs[drive])
    if "rho" in inputs:
        inputs["rho"] = np.where(np.arange(n) < 40, -1.0, inputs["rho"])
    of_none = 0
    for by in (drive, *(name for name in BY[mechanism] if name in inputs)):
        found = slopes(of, bounded(of, inputs), by, inputs)
        values = fl.evaluate(mechanism, [*found, *set(found.values())], input=drive, **inputs)
        wrong = [s for s in found if np.any(np.isfinite(values[s]) & ~np.isfinite(values[found[s]]))]
        assert wrong == [], by
        of_none += sum(np.count_nonzero(~np.isfinite(values[name])) for name in found.values())
    assert of_none > 100


@pytest.mark.parametrize("theta1", [2.0, 0.2])
def test_a_kernel_has_no_derivative_either_where_the_quantity_is_none(theta1):
    """A crank of three times the length of the others assembles near 0 alone."""
    lengths = {"a1": 3.0, "a2": 1.0, "a3": 1.0, "a4": 2.0, "omega1": 1.0}
    links = fl.round_bar(density=1000.0, radius=0.01)
    names = ["F41_y", "d_F41_y_d_FP_y", "d_shaking_force_y_d_FP_y", "d_shaking_force_y_d_FP_y_error"]
    loads = {"FP_x": 0.0, "FP_y": 1.0, "P_u": 0.5, "P_v": 0.1}
    maps = fl.sweep("planar_4r", fl.grid(**lengths, **loads), names, links=links, theta1=[theta1], branch=1)
    assert {bool(np.isfinite(maps[name]).all()) for name in names} == {theta1 == 0.2}


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    ("mechanism", "drive"), [key for key in DRAWN if catalogue(*key).position.units != "m"]
)
def test_of_angles_whose_powers_underflow_no_digit_is_known(mechanism, drive):
    of, inputs = catalogue(mechanism, drive), drawn(mechanism, drive, 40)
    names = [name for name in bounded(of, inputs) if of.varies(name)]
    small = 10.0 ** np.random.default_rng(9).uniform(-323, -61, 40)
    for angles, known in ((small, False), (-small, False), (np.zeros(40), True)):
        values, bounds, trusts = evaluated(mechanism, drive, names, inputs | {drive: angles})
        finite = np.isfinite(values)
        assert finite.any()
        if known:
            assert (bounds[finite] < np.inf).any()
        else:
            assert (bounds[finite] == np.inf).all()
            assert (trusts[finite] == 1.0).all()


def test_sweeps_know_small_angles_too():
    linkage = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=1.0)
    angles = [0.0, 0.5 * SMALL_ANGLE, -5e-324, SMALL_ANGLE, 1.0]
    names = ["omega4_error", "omega4_trust", "theta1_low_error", "omega4_error_max", "d_A_y_d_a1_error"]
    maps = fl.sweep("planar_4r", linkage, names, theta1=angles, extrema="sampled", branch=1)
    for name in ("omega4_error", "d_A_y_d_a1_error"):
        assert_array_equal(np.isinf(maps[name].squeeze()), [False, True, True, False, False])
    assert_array_equal(maps["omega4_trust"].squeeze(), [0, 1, 1, 0, 0])
    assert np.isinf(maps["omega4_error_max"]).all()
    assert not np.isinf(maps["theta1_low_error"]).any()  # it belongs to the design


def test_a_gap_that_counts_as_zero_is_in_the_bound():
    names = ["omega4", "theta4", "transmission_angle"]
    asked = [f"{name}{ending}" for name in names for ending in ("", "_error", "_trust")]
    near, far = (
        fl.evaluate("planar_4r", asked, theta1=theta1, omega1=1.0, branch=2, **NEARLY)
        for theta1 in (1e-8, 0.1)
    )
    assert near["omega4"] == pytest.approx(0.8739, abs=1e-4)  # of the change point; as given it is -0.01044
    assert near["omega4_error"] > 0.88
    assert near["omega4_trust"] == 1.0
    # Away from the fold p = Z - Z0 loses |Z0|/Z of itself: |Z0| is 1e-16 at most, Z some 0.0025.
    for name in names:
        assert far[f"{name}_error"] < 1e-12 * abs(far[name])
        assert far[f"{name}_trust"] == 0.0
    names = ["omega4_max", "omega4_max_error", "omega4_extrema", "omega4_extrema_error", "theta4_max_error"]
    lengths = {"a1": 0.6, "a2": 0.3, "a3": 0.4, "a4": 0.1}  # 0.6 + 0.1 is not 0.3 + 0.4 in binary
    found = sweep_4r(fl.grid(**lengths, omega1=1.0), names)
    assert np.isfinite(found["omega4_max"]).all()
    for name in ("omega4_max", "theta4_max"):
        assert (found[f"{name}_error"] == np.inf).all()
    assert_array_equal(np.isnan(found["omega4_extrema"]), np.isnan(found["omega4_extrema_error"]))
    assert (found["omega4_extrema_error"].max("extremum") == np.inf).any()


def test_verification_takes_lengths_as_they_are_and_codes_as_meant():
    names = ["transmission_angle_min", "omega4_extrema", "grashof_class", "grashof_excess_trust"]
    result = fl.sweep("planar_4r", fl.grid(**NEARLY, omega1=1.0), names, branch=2, verify=1)
    assert result["transmission_angle_min"].values == 0.0
    assert result["transmission_angle_min"].attrs["error_max_relative"] == 1.0  # as given it is not 0
    assert result["omega4_extrema_count"].values == 0
    assert result["grashof_class"].values == 8
    assert result["grashof_excess_trust"].values == 1  # the flag of such a design
    assert result.attrs["verify_mismatches"] == 0  # neither reading is wrong
    exact = {"a1": 0.5, "a2": 1.25, "a3": 0.75, "a4": 1.0}
    found = fl.evaluate("planar_4r", ["grashof_excess", "grashof_excess_trust"], theta1=1.0, **exact)
    assert (found["grashof_excess"], found["grashof_excess_trust"]) == (0.0, 0.0)
    rates = fl.sweep(
        "planar_4r",
        fl.grid(**NEARLY, omega1=1.0),
        ["omega4"],
        angles=np.array([1e-8, 2e-8]),
        branch=2,
        verify=1,
    )
    assert rates["omega4"].attrs["error_max_relative"] > 0.9
    assert rates.attrs["verify_mismatches"] == 0  # its bound is infinite


def test_an_extreme_beside_a_toggle_that_is_not_looked_for_is_in_the_bound():
    """MA and NB are parallel within 2^-22 of the scale from where the crank stops."""
    (entry,) = (one for one in SEARCHED if str(one) == "focal sigma")
    design = numbers(
        "a=1.9664390820123145 b=3.839279211923328 c=0.0005705711695696084 d=1.8722695587414444 "
        "rho=-1.0000000000003526 omega=1.0724489878099615 completion=1"
    )
    columns = {name: np.array([value]) for name, value in design.items()}
    least = [one for one in bounded_extremes(entry, columns, ["transmission_angle_F"]) if "min" in one.of]
    assert len(least) == 2
    for one in least:
        assert one.exact < 1e-50  # they are parallel
        assert one.error <= one.bound < 1e-12


def test_a_direction_is_wrong_by_half_a_turn_at_most():
    """The bound is not pi as rounded, which is less."""
    inputs = dict.fromkeys("abcd", 0.3157642406445423)
    inputs |= {"s": -0.3773939580730596, "completion": 1.0, "branch": 2.0, "phi": -1.5733016276073395e-17}
    found = fl.evaluate("focal", ["beta", "beta_error"], **inputs)
    facts = HighPrecision(catalogue("focal"), ["beta"], inputs, ("s",))
    assert abs(CONTEXT.mpf(float(found["beta"])) - facts.at(inputs)["beta"]) <= found["beta_error"]
    assert found["beta_error"] < 3.2

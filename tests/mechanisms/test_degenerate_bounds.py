"""Error bounds of designs with a gap that counts as zero: they hold for the lengths as given, or are infinite."""

from __future__ import annotations

import contextlib

import mpmath as mp
import numpy as np
import pytest
from tests.support.degenerate import FAMILIES
from tests.support.extrema_errors import bounded_extremes
from tests.support.registry import ENTRIES

import fastlink as fl
from fastlink.facts.derivative import NoDerivative
from fastlink.mechanisms import NAMES, catalogue, inputs_of
from fastlink.plan.request import variants_of
from fastlink.precision.reference import CONTEXT, HighPrecision

#: A change point but for 1e-16: the gap is within the rounding of the lengths.
ISSUE = {
    "a1": 0.6286585380403462,
    "a2": 1.197852049758225,
    "a3": 0.8341289441152699,
    "a4": 0.9923816436833014,
}
CASES = [pytest.param(*case, id="-".join(filter(None, case))) for case in FAMILIES]


#: A length of each mechanism, with respect to which derivatives are taken.
LAST = {"planar_4r": "a4", "slider_crank": "e", "hart": "kappa", "focal": "d", "minkowski_4r": "h"}


def bounded(of, inputs):
    """Return the quantities that have an error bound, but those that are nothing but errors."""
    measures = ("residual", "deviation")
    return [
        name
        for name, one in of.public.items()
        if not (one.flags or name in inputs or any(word in name for word in measures))
    ]


def slopes(of, names, by, variants):
    """Return the names of the derivatives that there are."""
    found = []
    for name in (f"d_{name}_d_{by}" for name in names):
        with contextlib.suppress(NoDerivative):
            of.resolve(name, variants, variants)
            found.append(name)
    return found


def test_every_mechanism_and_input_has_degenerate_designs():
    assert {case[:2] for case in FAMILIES} == {(name, drive) for name in NAMES for drive in inputs_of(name)}


def errors(mechanism, drive, about, n, by=""):
    """Yield quantity, value, bound, trust and exact value at configurations of the family; or of derivatives."""
    of = catalogue(mechanism, drive)
    rng = np.random.default_rng(7)
    inputs = FAMILIES[mechanism, drive, about](rng, n)
    n = len(inputs[drive])
    inputs.setdefault("branch", rng.integers(1, 3, n).astype(float))
    variants = variants_of(of, None, "eliminated", inputs)
    names = bounded(of, inputs)
    names = slopes(of, names, by, variants) if by else names
    asked = [f"{name}{ending}" for name in names for ending in ("", "_error", "_trust")]
    found = fl.evaluate(mechanism, asked, input=drive, **inputs)
    found = {name: np.broadcast_to(values, n) for name, values in found.items()}
    facts = HighPrecision(of, names, inputs, variants)
    for i in range(n):
        one = {name: float(values[i]) for name, values in inputs.items()}
        exact = facts.at(one)
        for name in names:
            value, bound, trust = (float(found[f"{name}{ending}"][i]) for ending in ("", "_error", "_trust"))
            if np.isfinite(value):
                yield name, one, value, bound, trust, exact[name]


def assert_bounds_hold(mechanism, drive, about, n, by=""):
    """Hold every bound against the exact value of the very same doubles; return how many are finite, and all."""
    of = catalogue(mechanism, drive)
    finite = total = 0
    for name, one, value, bound, trust, exact in errors(mechanism, drive, about, n, by):
        total += 1
        finite += bound < np.inf
        if not bound < np.inf:
            assert trust == 1.0, (name, one)
            continue
        assert CONTEXT.isfinite(exact), (name, one, value, bound)
        error = abs(CONTEXT.mpf(value) - exact)
        if of.public_fact(name).units == "rad":  # to within full turns
            error = min(error, abs(error - 2 * CONTEXT.pi))
        assert error <= bound, (name, one, value, float(exact), bound)
    return finite, total


@pytest.mark.sample(4)
@pytest.mark.parametrize(("mechanism", "drive", "about"), CASES)
def test_bounds_hold_at_every_degenerate_set(mechanism, drive, about):
    finite, total = assert_bounds_hold(mechanism, drive, about, 30)
    # infinite bounds are for places where nothing is known; Hart's line ends where most of these positions are
    assert finite > (0.5 if mechanism == "hart" else 0.7) * total
    assert total > 40


@pytest.mark.sample(2)
@pytest.mark.parametrize("mechanism", LAST)
def test_bounds_of_derivatives_hold_at_every_degenerate_set(mechanism):
    finite, total = assert_bounds_hold(mechanism, inputs_of(mechanism)[0], "", 12, LAST[mechanism])
    assert 0 < finite <= total


@pytest.mark.stress
@pytest.mark.parametrize(("mechanism", "drive", "about"), CASES)
def test_bounds_hold_at_many_degenerate_designs(mechanism, drive, about):
    assert_bounds_hold(mechanism, drive, about, 10_000)
    for by in (drive, LAST[mechanism]):
        assert_bounds_hold(mechanism, drive, about, 2_000, by)


def test_a_gap_that_counts_as_zero_is_in_the_bound():
    names = ["omega4", "theta4", "transmission_angle"]
    asked = [f"{name}{ending}" for name in names for ending in ("", "_error", "_trust")]
    near, far = (
        fl.evaluate("planar_4r", asked, theta1=theta1, omega1=1.0, branch=2, **ISSUE)
        for theta1 in (1e-8, 0.1)
    )
    assert near["omega4"] == pytest.approx(0.8739, abs=1e-4)  # of the change point; as given it is -0.01044
    assert near["omega4_error"] > 0.88
    assert near["omega4_trust"] == 1.0
    # Away from the fold p = Z - Z0 loses |Z0|/Z of itself: |Z0| is 1e-16 at most, Z some 0.0025.
    for name in names:
        assert far[f"{name}_error"] < 1e-12 * abs(far[name])
        assert far[f"{name}_trust"] == 0.0


def assembled(a1, a2, a3, a4, theta1, branch):
    """Return theta4 and omega4/omega1 by circles that intersect and by the loop's derivative, with 60 digits."""
    A, D = a1 * mp.expj(theta1), mp.mpf(a4)
    along = D - A
    cosine = (a2**2 + abs(along) ** 2 - a3**2) / (2 * a2 * abs(along))
    if abs(cosine) > 1:
        return None
    B = A + a2 * along / abs(along) * mp.expj((1 if branch == 2 else -1) * mp.acos(cosine))
    assert abs(abs(B - D) - a3) < mp.mpf(10) ** -50
    # d/dt of A + AB = D + DB, across AB: i a1 n1 . AB = i n4 DB . AB
    AB, DB = B - A, B - D
    dot = [mp.re(1j * arm * mp.conj(AB)) for arm in (A, DB)]
    return mp.arg(DB), dot[0] / dot[1]


def test_a_direction_is_wrong_by_half_a_turn_at_most():
    """The bound is not pi as rounded, which is less."""
    kite = {
        "a": 0.3157642406445423,
        "b": 0.3157642406445423,
        "c": 0.3157642406445423,
        "d": 0.3157642406445423,
    }
    inputs = kite | {
        "s": -0.3773939580730596,
        "completion": 1.0,
        "branch": 2.0,
        "phi": -1.5733016276073395e-17,
    }
    found = fl.evaluate("focal", ["beta", "beta_error"], **inputs)
    facts = HighPrecision(catalogue("focal"), ["beta"], inputs, ("s",))
    assert abs(CONTEXT.mpf(float(found["beta"])) - facts.at(inputs)["beta"]) <= found["beta_error"]
    assert found["beta_error"] < 3.2


def test_bounds_hold_against_circles_that_intersect():
    """The facts share no formula with this reference."""
    rng, n = np.random.default_rng(8), 300
    inputs = FAMILIES["planar_4r", "theta1", ""](rng, n) | {"branch": rng.integers(1, 3, n).astype(float)}
    lengths = {name: inputs[name] for name in ("a1", "a2", "a3", "a4", "theta1", "branch")}
    asked = ["theta4", "theta4_error", "omega4", "omega4_error"]
    found = fl.evaluate("planar_4r", asked, omega1=1.0, **lengths)
    tested = 0
    with mp.workdps(60):
        for i in range(n):
            one = {name: mp.mpf(float(values[i])) for name, values in lengths.items()}
            values = {name: float(column[i]) for name, column in found.items()}
            if not values["omega4_error"] < np.inf or not np.isfinite(values["omega4"]):
                continue
            exact = assembled(**one)
            assert exact is not None, one
            turned = abs(values["theta4"] - exact[0])
            assert min(turned, abs(turned - 2 * mp.pi)) <= values["theta4_error"], one
            assert abs(values["omega4"] - exact[1]) <= values["omega4_error"], one
            tested += 1
    assert tested > n // 3


#: A rate, and an angle or coordinate, by mechanism and input.
EXTREMES = {
    ("planar_4r", "theta1"): ("omega4", "transmission_angle"),
    ("planar_4r", "joint_angle_2"): ("joint_omega_3",),
    ("slider_crank", "theta"): ("slider_acceleration", "slider_position"),
    ("hart", "phi"): ("F_y",),
    ("focal", "sigma"): ("transmission_angle_F",),
}


def assert_extremes_are_within_their_bounds(mechanism, drive, n):
    """Hold extremes of the family's designs against those of the lengths as given; return how many have a bound."""
    entry = next(one for one in ENTRIES if (one.mechanism, one.input) == (mechanism, drive))
    designs = FAMILIES[mechanism, drive, ""](np.random.default_rng(3), n)
    designs = {name: values for name, values in designs.items() if name not in (drive, "branch")}
    extremes = list(bounded_extremes(entry, designs, EXTREMES[mechanism, drive]))
    assert [one for one in extremes if one.bound != np.inf and not one.holds] == []
    return sum(one.bound < np.inf for one in extremes)


def test_extremes_are_within_their_bounds_or_have_none():
    assert assert_extremes_are_within_their_bounds("planar_4r", "theta1", 12) > 20


#: A focal mechanism in which MA and NB are parallel within 2^-22 of the scale from where its crank stops.
NEARLY_STRAIGHT = {
    "a": 1.9664390820123145,
    "b": 3.839279211923328,
    "c": 0.0005705711695696084,
    "d": 1.8722695587414444,
    "rho": -1.0000000000003526,
    "omega": 1.0724489878099615,
    "completion": 1.0,
}


def test_an_extreme_beside_a_toggle_that_is_not_looked_for_is_in_the_bound():
    entry = next(one for one in ENTRIES if (one.mechanism, one.input) == ("focal", "sigma"))
    designs = {name: np.array([value]) for name, value in NEARLY_STRAIGHT.items()}
    least = [one for one in bounded_extremes(entry, designs, ["transmission_angle_F"]) if "min" in one.of]
    assert len(least) == 2
    for one in least:
        assert one.exact < 1e-50  # they are parallel
        assert one.error <= one.bound < 1e-12


@pytest.mark.stress
@pytest.mark.parametrize(("mechanism", "drive"), EXTREMES)
def test_many_extremes_are_within_their_bounds_or_have_none(mechanism, drive):
    assert_extremes_are_within_their_bounds(mechanism, drive, 300)


def test_of_extremes_at_a_gap_that_counts_as_zero_nothing_is_known():
    names = ["omega4_max", "omega4_max_error", "omega4_extrema", "omega4_extrema_error", "theta4_max_error"]
    lengths = {"a1": 0.6, "a2": 0.3, "a3": 0.4, "a4": 0.1}  # 0.6 + 0.1 is not 0.3 + 0.4 in binary
    found = fl.sweep("planar_4r", fl.grid(**lengths, omega1=1.0), names)
    assert np.isfinite(found["omega4_max"]).all()
    for name in ("omega4_max", "theta4_max"):
        assert (found[f"{name}_error"] == np.inf).all()
    np.testing.assert_array_equal(np.isnan(found["omega4_extrema"]), np.isnan(found["omega4_extrema_error"]))
    assert (found["omega4_extrema_error"].max("extremum") == np.inf).any()


def test_verification_takes_lengths_as_they_are_and_codes_as_meant():
    names = ["transmission_angle_min", "omega4_extrema", "grashof_class", "grashof_excess_trust"]
    result = fl.sweep("planar_4r", fl.grid(**ISSUE, omega1=1.0), names, branch=2, verify=1)
    assert result["transmission_angle_min"].values == 0.0
    assert result["transmission_angle_min"].attrs["error_max_relative"] == 1.0  # as given it is not 0
    assert result["omega4_extrema_count"].values == 0
    assert result["grashof_class"].values == 8
    # neither reading is wrong
    assert result.attrs["verify_mismatches"] == 0
    assert result["grashof_excess_trust"].values == 1  # the flag of such a design
    exact = {"a1": 0.5, "a2": 1.25, "a3": 0.75, "a4": 1.0}
    found = fl.evaluate("planar_4r", ["grashof_excess", "grashof_excess_trust"], theta1=1.0, **exact)
    assert (found["grashof_excess"], found["grashof_excess_trust"]) == (0.0, 0.0)


def test_verification_shows_how_far_rates_are_from_those_of_the_lengths_as_they_are():
    angles = np.array([1e-8, 2e-8])
    result = fl.sweep(
        "planar_4r", fl.grid(**ISSUE, omega1=1.0), ["omega4"], angles=angles, branch=2, verify=1
    )
    assert result["omega4"].attrs["error_max_relative"] > 0.9
    assert result.attrs["verify_mismatches"] == 0  # its bound is infinite

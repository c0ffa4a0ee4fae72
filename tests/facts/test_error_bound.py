"""Error bounds: each law alone, every quantity by 50 digits, bits, labels, messages."""

from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support import configurations
from tests.support.configurations import LENGTHS, PLANAR, lengths_and_angles
from tests.support.precision import Truth, in_every_mode, plain
from tests.support.registry import ENTRIES, every_input
from tests.support.sweeps import sweep_4r, sweep_both
from tests.support.toys import toy

import fastlink as fl
from fastlink.errors import InputError
from fastlink.facts import bounds
from fastlink.facts.bounds import UNIT_WITH_MARGIN, WORDS
from fastlink.facts.evaluate import read_facts
from fastlink.facts.tables import angle_tables
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING, sum_of_four
from fastlink.precision.reference import CONTEXT

MINKOWSKI = catalogue("minkowski_4r")
MECHANISMS = {"planar_4r": PLANAR, "minkowski_4r": MINKOWSKI}


def quantities(mechanism):
    return [name for name, fact in mechanism.public.items() if not fact.flags]


#: The law over magnitudes and errors, and the operation.
LAWS = {
    "product": (lambda x, y, e, f: bounds.of_product(abs(x), abs(y), e, f), lambda x, y: x * y),
    "quotient": (lambda x, y, e, f: bounds.of_quotient(abs(x / y), abs(y), e, f), lambda x, y: x / y),
    "root": (lambda x, y, e, f: bounds.of_root(abs(x), np.sqrt(abs(x)), e), lambda x, y: mp.sqrt(abs(x))),
    "direction": (lambda x, y, e, f: bounds.of_direction(abs(y), abs(x), f, e), lambda x, y: mp.atan2(y, x)),
    "logarithm": (lambda x, y, e, f: bounds.of_logarithm(abs(x), e), lambda x, y: mp.log(abs(x))),
}


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", LAWS)
def test_a_law_bounds_what_errors_of_any_size_do(name):
    law, operation = LAWS[name]
    rng = np.random.default_rng(1)
    shares = [(a, b) for a in (-1.0, 1.0, 0.3) for b in (-1.0, 1.0, -0.2)]
    tight = 0
    with mp.workdps(30), np.errstate(all="ignore"):
        for _ in range(400):
            x, y = rng.choice([-1.0, 1.0], 2) * np.exp(rng.uniform(-5.0, 5.0, 2))
            e, f = np.abs((x, y)) * np.exp(rng.uniform(-35.0, 1.0, 2))
            if "root" in name or name == "logarithm":
                e = min(e, abs(x))  # beyond, its argument would be of another sign
            bound = law(x, y, e, f)
            worst = mp.mpf(0)
            for a, b in shares:
                moved = operation(mp.mpf(x) + mp.mpf(a) * e, mp.mpf(y) + mp.mpf(b) * f)
                change = abs(moved - operation(mp.mpf(x), mp.mpf(y)))
                worst = max(worst, min(change, abs(change - 2 * mp.pi)) if name == "direction" else change)
            # 1e-13: the law itself is computed with some ten roundings, and the change with 30 digits
            assert worst <= bound * (1 + 1e-13) or np.isinf(bound), (x, y, e, f)
            tight += bound <= 2.1 * worst
    assert tight > 200


def test_a_gap_is_right_to_twice_the_digits_of_itself_however_much_cancels():
    rng = np.random.default_rng(2)
    nonzero = 0
    for _ in range(4000):
        a, b, c = (float(x) for x in rng.uniform(0.5, 2.0, 3) * 2.0 ** rng.integers(-60, 3, 3))
        d = -float(Fraction(a) + Fraction(b) + Fraction(c)) * float(1.0 + rng.choice([0.0, 1e-16, 1e-9]))
        d += float(rng.choice([0.0, 1e-20, 1e-35]))
        high, low = sum_of_four(a, b, c, d)
        exact = sum(map(Fraction, (a, b, c, d)))
        assert abs(Fraction(high) + Fraction(low) - exact) <= WORDS[sum_of_four] * Fraction(
            UNIT_ROUNDING
        ) * abs(exact)
        nonzero += exact != 0
    assert nonzero > 3000


#: Formulas, and how often a rounding changes them.
COUNTED = {
    "x * y": 1.0,
    "2.0 * (x * x)": 1.0,
    "-(4.0 * x) / 8.0": UNIT_ROUNDING,  # which no rounding touches
    "(x * y + 1.0) - x * y": None,  # whose terms are bounded each on its own, though they share an error
}


@pytest.mark.parametrize("formula", COUNTED)
def test_roundings_are_counted_once(formula):
    made = toy(f"[inputs]\n{{x,y}} [1] {{x,y}}: a number\n[facts]\n## tests\nf [1] f: it\n    = {formula}")
    found = read_facts(made, ["f", "f_error"], {"x": 3.0, "y": 0.7})
    if COUNTED[formula] is None:
        # two sums of sizes 3.1 and 1, and the rounding of the product, 2.1, in both terms
        assert found["f_error"] == pytest.approx(UNIT_WITH_MARGIN * (3.1 + 1.0 + 2 * 2.1), rel=1e-12)
    else:
        assert found["f_error"] == UNIT_WITH_MARGIN * COUNTED[formula] * abs(found["f"])


def bound_of(bounds, name):
    return bounds.of(bounds.graph.name(name))


def test_the_words_of_sums_of_two_meet():
    bounds = PLANAR.selection((), ()).error_bounds
    for name in ("Z0", "C0", "Z", "C"):
        ((low, (sign, high)),) = bound_of(bounds, name).lost.items()
        assert (low.value, sign, high.value) == (f"{name}_low", -1.0, name)
    assert bound_of(MINKOWSKI.selection((), ()).error_bounds, "ground_share").lost
    # what tables and branches choose between is exact, and products with it too
    assert all(
        bound_of(MINKOWSKI.selection((), ()).error_bounds, name).scale
        for name in ("side", "r", "branch_sign")
    )
    assert bound_of(MINKOWSKI.selection((), ()).error_bounds, "twos").relative == 0.0
    lengths, theta = lengths_and_angles("toggle 1e-9", np.random.default_rng(5), 40)
    tables = ("theta1", *PLANAR.tables, *PLANAR.table_low_parts)
    values = dict(zip(LENGTHS, lengths, strict=True)) | dict(
        zip(tables, angle_tables(PLANAR, tables, theta), strict=True)
    )
    found = read_facts(PLANAR, ["p", "p_error"], values)
    # three roundings of p at most, though p is 1e-9 of Z and Z0
    assert np.all(found["p_error"] <= 3.001 * UNIT_ROUNDING * np.abs(found["p"]))


def bounds_over_errors(entry, names, kind, n):
    """Return quantities and their ratios of bound to error in configurations, where no error is beyond its bound."""
    inputs = in_every_mode(entry, entry.drawn(kind, 10, n))
    units = {name: entry.catalogue.public_fact(name).units for name in names}
    found = plain(entry, (*names, *(f"{name}_error" for name in names)), inputs)
    ratios = []
    for i, one, exact in Truth(entry, names, inputs, zeroes=False).rows():
        for name in names:
            value, bound = float(found[name][i]), float(found[f"{name}_error"][i])
            if not np.isfinite(value):
                assert not np.isfinite(bound)
                continue
            if not CONTEXT.isfinite(exact[name]):
                continue
            error = abs(CONTEXT.mpf(value) - exact[name])
            if units[name] == "rad":  # to within full turns
                error = min(error, abs(error - 2 * CONTEXT.pi))
            assert error <= bound, (name, one, value, float(error), bound)
            if name not in entry.errors:  # these are nothing but errors, and may be 0 by chance
                ratios.append((name, bound / max(float(error), UNIT_ROUNDING * abs(value), 1e-320)))
    return ratios


BOUNDED = [entry for entry in ENTRIES if entry.solver == "eliminated"]  # a linear system has no bounds


@pytest.mark.sample(5)
@pytest.mark.parametrize("entry", BOUNDED, ids=str)
def test_every_bound_holds_and_is_not_much_greater_than_the_error(entry):
    names = tuple(name for name in entry.names if not entry.catalogue.public_fact(name).flags)
    ratios = [ratio for kind in entry.families for ratio in bounds_over_errors(entry, names, kind, 6)]
    near = [ratio <= 100.0 for name, ratio in ratios if name not in entry.sharing_errors]
    assert np.mean(near) > entry.near_bounds
    near = [ratio <= 1000.0 for name, ratio in ratios if name in entry.sharing_errors]
    assert bool(near) == bool(entry.sharing_errors)
    assert not near or np.mean(near) > entry.near_bounds
    assert np.median([ratio for _name, ratio in ratios]) < entry.looseness


SWEPT = {
    "planar_4r": (
        {"a1": [0.3, 0.4, 0.9], "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0},
        {"angles": 40},
        ["omega4", "v2"],
    ),
    "minkowski_4r": (
        {"a": [1.0, 1.2, 0.4], "b": 0.8, "g": 1.5, "h": 0.7},
        {"angles": np.linspace(-3.0, 3.0, 40)},
        ["psi"],
    ),
}


@pytest.fixture(scope="module")
def swept():
    found = {}
    for name, (inputs, options, names) in SWEPT.items():
        asked = [x for quantity in names for x in (quantity, f"{quantity}_error", f"{quantity}_trust")]
        asked += [f"{names[0]}_error_max", f"{MECHANISMS[name].position.name}_at_{names[0]}_error_max"]
        found[name] = sweep_both(name, fl.grid(**inputs), asked, **options)
    return found


@pytest.mark.parametrize("name", MECHANISMS)
def test_compiled_bounds_have_the_bits_of_plain_ones(name, swept):
    inputs, _options, names = SWEPT[name]
    result, first = swept[name], names[0]
    position = MECHANISMS[name].position.name
    axis = next(key for key, value in inputs.items() if isinstance(value, list))
    given = inputs | {axis: np.array(inputs[axis])[:, None, None], position: result[position].values}
    judged = [f"{quantity}_{ending}" for quantity in names for ending in ("error", "trust")]
    found = fl.evaluate(name, [*names, *judged], branch=np.array([1, 2])[:, None], **given)
    for quantity in judged:
        expected = result[quantity].broadcast_like(result[first]).transpose(*result[first].dims)
        assert_array_equal(found[quantity], expected)
    greatest = np.nanmax(found[f"{first}_error"], axis=2)
    assert_array_equal(result[f"{first}_error_max"], greatest)


def test_bounds_have_labels(swept):
    result = swept["planar_4r"]
    assert result.omega4_error.attrs == {
        "units": "rad s-1",
        "long_name": "Error bound of angular velocity of the output link",
        "symbol": "err omega_4",
        "references": "Hayes, Hninn, Irani, eq. (7); docs/numerics.md#error-bounds",
    }
    assert result.omega4_error_max.attrs["extrema"] == "sampled"
    assert result.omega4_trust.dtype == np.int8
    assert result.omega4_trust.attrs["flag_meanings"] == "trusted ill_conditioned not_finite"


def test_bounds_have_labels_and_tell_where_digits_are_known(swept):
    for name, result in swept.items():
        for quantity in SWEPT[name][2]:
            value, error, code = (result[f"{quantity}{x}"].values for x in ("", "_error", "_trust"))
            expected = np.where(error <= 1e-6 * np.abs(value), 0, 1)
            assert_array_equal(code, np.where(np.isfinite(value), expected, 2))
    # a residual is nothing but rounding
    lengths = {"a1": 0.3, "a2": 1.2, "a3": 0.8, "a4": 1.0}
    assert (
        fl.evaluate("planar_4r", ["loop_residual_trust"], theta1=1.0, **lengths)["loop_residual_trust"] == 1.0
    )
    assert (
        fl.evaluate("planar_4r", ["A_x_trust"], theta1=np.nan, allow_invalid=True, **lengths)["A_x_trust"]
        == 2.0
    )
    names = ["transmission_angle", "theta4"]
    judged = [f"{name}_error" for name in names]
    kite = {"a1": 1.0, "a2": 2.0, "a3": 2.0, "a4": 1.0}
    found = fl.evaluate("planar_4r", [*names, *judged], theta1=np.array([0.0, 1e-8]), **kite)
    # A and D coincide at 0: the transmission angle is 0 exactly, theta4 anything
    assert found["transmission_angle_error"][0] == 0.0
    assert np.isnan(found["theta4_error"][0])
    assert found["theta4_error"][1] < 4.01 * UNIT_ROUNDING * np.pi
    # at a toggle, told in doubles, the angle is known to the root of a rounding of a rounding
    # arccos 0.6 is 0.92729521800161223: some machines round it up, to where the linkage does not assemble
    toggle = fl.evaluate(
        "planar_4r", ["joint_angle_3_error"], a1=3.0, a2=2.0, a3=2.0, a4=5.0, theta1=0.9272952180016122
    )
    assert toggle["joint_angle_3_error"] < 1e-7


def test_what_has_no_bound_is_refused_in_one_line():
    for name, about in (
        ("omega44_error", "did you mean .*'omega4_error'"),
        ("status_error", "status is a code, which has no error"),
        ("grashof_class_trust", "grashof_class is a code, which has no error"),
        ("omega4_error_error", "omega4_error is an error bound, which has no error"),
        ("d_omega4_error_d_a1", "omega4_error is an error bound, which has no derivative"),
        ("omega4_error_extrema", "omega4_error of planar_4r has no derivative"),
        ("Z0_error", "'Z0' is unknown"),
    ):
        with pytest.raises(InputError, match=about):
            sweep_4r(fl.grid(a1=0.3, a2=1.2, a3=0.8, a4=1.0, omega1=25.0), [name], angles=8)
    with pytest.raises(InputError, match="a linear system determines"):
        fl.evaluate("planar_4r", ["T41_error"], theta1=1.0, solver="dense", a1=0.3)


@pytest.mark.parametrize("power", [-70, -7, 70])
def test_bounds_scale_with_the_lengths(power):
    lengths = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "P_u": 0.3, "P_v": -0.1}
    names = [f"{name}_error" for name in ("omega4", "theta4", "loop_residual", "P_x", "curvature")]
    factors = np.array([0.0, 0.0, 0.0, power, -power])
    found = [
        fl.evaluate("planar_4r", names, theta1=1.0, omega1=3.0, **{x: v * scale for x, v in lengths.items()})
        for scale in (1.0, 2.0**power)
    ]
    one, other = ([values[name] for name in names] for values in found)
    # what is added to keep roots from zero, 2^-1000 of squares of ratios, is below all roundings
    assert_array_equal(other, one * 2.0**factors)


@every_input
def test_every_quantity_of_every_mechanism_has_a_bound(mechanism, drive):
    known = catalogue(mechanism, drive)
    given = ("branch", drive, *known.tables, *known.table_low_parts)
    judged = [f"{quantity}_error" for quantity in quantities(known)]
    steps = known.dependencies(judged, (*known.inputs, *given))
    assert {step.name for step in steps}.issuperset(judged)


@pytest.mark.parametrize("name", MECHANISMS)
def test_nothing_of_a_bound_is_computed_unless_it_is_asked_for(name):
    mechanism = MECHANISMS[name]
    given = ("branch", mechanism.position.name, *mechanism.tables, *mechanism.table_low_parts)
    steps = mechanism.dependencies(quantities(mechanism), (*mechanism.inputs, *given))
    assert not [step.name for step in steps if step.name.endswith(("_error", "_trust"))]


DEEP = ["d_F41_d_a1_error", "d_shaking_moment_printed_d_a1_error"]


def test_bounds_of_derivatives_under_all_loads_are_evaluated():
    """Their texts are thousands of operations deep, which Python must not read by recursion."""
    design = configurations.loaded("random", np.random.default_rng(1), 1)
    found = fl.evaluate("planar_4r", DEEP, branch=2, **design)
    assert all(0.0 < found[name] < np.inf for name in DEEP)

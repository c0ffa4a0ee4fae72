"""The Minkowskian 4R: eq. (3), laws of its plane, rapidities of any size, and flags where something is no number.

Its formulas are held by the loops (tests/precision/test_loops.py), its digits by the rule of all mechanisms.
"""

from __future__ import annotations

import contextlib

import mpmath as mp
import numpy as np
import pytest
from tests.support.configurations import DIGITS, condition_sums, reference
from tests.support.minkowski_configurations import adversarial
from tests.support.refusals import refused

import fastlink as fl
from fastlink.errors import InputError
from fastlink.facts.evaluate import read_facts
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision.reference import CONTEXT, HighPrecision

MINKOWSKI = catalogue("minkowski_4r")
ALL = [name for name in MINKOWSKI.public if MINKOWSKI.varies(name)]
CLOSES, OPEN, ESCAPED, UNDETERMINED, AT_A_LIMIT, BEYOND, INVALID, WITHOUT_ZETA = range(8)
#: What tells why a quantity is not a finite number, if it is not `configuration_status`.
FLAGS = {
    **dict.fromkeys(("X_x", "X_y", "sextic_residual"), "coupler_point_status"),
    **dict.fromkeys(("dpsi_dtheta", "d2psi_dtheta2"), "rates_status"),
    **dict.fromkeys(("psi_remark", "delta"), "remark_status"),
    **dict.fromkeys(("lambda_AX", "mu_BX"), "coupler_angles_status"),
}
#: Of degree 2 and linear in ch(theta): they are infinite where they are greater than any double, never NaN.
COEFFICIENTS = ("coefficient_A", "coefficient_B", "coefficient_C")
COORDINATES = ("A_x", "A_y", "B_x", "B_y", "X_x", "X_y")
BRANCHES = np.array([[1], [2]])


def evaluated(names, theta, **given):
    """Return facts in both branches, arrays (branch, theta)."""
    return fl.evaluate(
        "minkowski_4r", names, branch=BRANCHES, theta=np.asarray(theta), allow_invalid=True, **given
    )


def drawn(n, seed):
    """Return lengths and coupler points as columns."""
    rng = np.random.default_rng(seed)
    columns = {name: rng.uniform(0.3, 2.0, (n, 1, 1)) for name in "abgh"}
    return columns | {name: rng.uniform(-2.0, 2.0, (n, 1, 1)) for name in "xy"}


# -- the paper ----------------------------------------------------------------------------------------------------


def test_residuals_are_roundings_on_every_circuit():
    names = ["loop_residual", "sextic_residual", "configuration_status"]
    found = evaluated(names, [*np.linspace(-6.0, 6.0, 25), -650.0, 300.0, 650.0], **drawn(1000, 4))
    closes = np.isin(found["configuration_status"], (CLOSES, WITHOUT_ZETA))
    assert closes.mean() > 0.9
    # Two sums of four terms, each right to 2 roundings; a product of two sums of 10 terms of 8 roundings at most.
    assert found["loop_residual"][closes].max() <= 8 * UNIT_ROUNDING
    assert np.abs(found["sextic_residual"][closes]).max() <= 16 * UNIT_ROUNDING


def test_both_roots_are_past_pointing_in_the_example_of_the_errata():
    names = ["CB_orientation", "half_angle_root", "zeta", "cosh_zeta"]
    found = evaluated(names, [-1.0, 0.0, 1.0], a=1.0, b=1.0, g=4.0, h=1.0)
    assert (found["CB_orientation"] == -1).all()
    assert (abs(found["half_angle_root"]) > 1).all()
    assert np.isnan(found["zeta"]).all()
    assert (found["cosh_zeta"] < -1).all()


def test_the_point_at_infinity_of_the_half_angle_is_an_ordinary_position():
    """At A + C = 0 of Corollary 3.2 one root is y = infinity: B = (g - b, 0)."""
    found = evaluated(["psi", "CB_orientation"], np.arccosh(1.5), a=1.0, b=1.0, g=4.0, h=1.0)
    # q = -1 there; theta is off by a rounding, and dpsi/dtheta is 1 or 14.
    assert np.abs(found["psi"]).min() <= 32 * UNIT_ROUNDING
    assert (found["CB_orientation"] == -1).all()
    folded = evaluated(["half_angle_root", "B_x", "B_y"], 0.5, a=2, b=3, g=3, h=2)
    k = int(np.argmax(np.abs(folded["half_angle_root"])))
    assert folded["half_angle_root"].flat[k] == np.inf
    assert abs(folded["B_x"].flat[k]) + abs(folded["B_y"].flat[k]) <= 8 * 3 * UNIT_ROUNDING


# -- laws of the plane --------------------------------------------------------------------------------------------


def test_the_mirror_exchanges_the_branches_bit_by_bit():
    theta, designs = np.array([0.3, 1.0, 2.5, 40.0, 800.0]), drawn(50, 6)
    odd = ["psi", "AB_rapidity", "half_angle_root", "A_y", "B_y", "X_y", "d2psi_dtheta2"]
    even = ["CB_orientation", "AB_orientation", "A_x", "B_x", "X_x", "cosh_zeta", "zeta", "dpsi_dtheta"]
    there = evaluated([*odd, *even], theta, **designs)
    back = evaluated([*odd, *even], -theta, **designs | {"y": -designs["y"]})
    for name in there:
        sign = -1.0 if name in odd else 1.0
        one, other = (np.broadcast_to(values[name], (50, 2, 5)) for values in (there, back))
        np.testing.assert_array_equal(one, sign * other[:, ::-1], err_msg=name)


def test_links_keep_their_lengths_and_orientations_in_every_frame():
    """A Lorentz boost multiplies null coordinates by e^t and e^-t: intervals and orientations stay."""
    designs = drawn(100, 7)
    found = evaluated([*COORDINATES, "AB_orientation"], np.linspace(-2.0, 2.0, 21), **designs)
    closes = np.isfinite(found["B_x"])
    # the coupler point is carried along: its interval from A is x^2 - y^2
    for end, interval in (("B", designs["h"] ** 2), ("X", designs["x"] ** 2 - designs["y"] ** 2)):
        dx, dy = found[f"{end}_x"] - found["A_x"], found[f"{end}_y"] - found["A_y"]
        for boost in (0.0, 0.8):
            x, y = np.cosh(boost) * dx + np.sinh(boost) * dy, np.sinh(boost) * dx + np.cosh(boost) * dy
            size = x * x + y * y + found["A_x"] ** 2 + found[f"{end}_x"] ** 2
            off = abs(x * x - y * y - interval) / (64 * UNIT_ROUNDING * np.exp(2 * boost) * size)
            assert (off[closes] <= 1.0).all()
            assert end == "X" or (np.sign(x) == found["AB_orientation"])[closes].all()


def test_the_rates_are_the_derivatives():
    rng = np.random.default_rng(8)
    names = ["psi", "dpsi_dtheta", "d2psi_dtheta2"]
    for _ in range(60):
        one = dict(zip("abgh", rng.uniform(0.3, 2.0, 4), strict=True)) | {"branch": rng.integers(1, 3)}
        theta = float(rng.uniform(-4, 4))
        with mp.workdps(DIGITS):
            step = mp.mpf(10) ** -15
            values = {name: mp.mpf(float(value)) for name, value in one.items()}
            before, here, after = (
                read_facts(MINKOWSKI, names, values | {"theta": theta + k * step}) for k in (-1, 0, 1)
            )
            if mp.isnan(here["psi"]):
                continue
            for of, rate in (("psi", "dpsi_dtheta"), ("dpsi_dtheta", "d2psi_dtheta2")):
                slope = (after[of] - before[of]) / (2 * step)
                # The error of the difference is step^2 times a third derivative, of a limit 1e-3 away at most.
                assert abs(slope - here[rate]) <= mp.mpf(10) ** -18 * (1 + abs(here[rate]))


def test_derivatives_by_theta_are_the_ratios_of_the_paper_and_none_where_a_root_is_infinite():
    one = {"a": 0.7, "b": 1.3, "g": 1.9, "h": 0.4, "theta": np.array([-5.0, 1.7, 60.0])}
    names = ["d_psi_d_theta", "dpsi_dtheta", "d_dpsi_dtheta_d_theta", "d2psi_dtheta2"]
    found = fl.evaluate("minkowski_4r", names, **one)
    np.testing.assert_array_equal(found["d_psi_d_theta"], found["dpsi_dtheta"])
    np.testing.assert_array_equal(found["d_dpsi_dtheta_d_theta"], found["d2psi_dtheta2"])
    # of branch 1 of this kite CB is past-pointing along the axis, and the root of the quadratic is infinite
    kite = {"a": 2.9233144391063974, "h": 2.9233144391063974, "b": 0.923320238192247, "g": 0.923320238192247}
    slopes = [f"d_half_angle_root_d_{by}" for by in "abgh"]
    trusts = [f"{slope}_trust" for slope in slopes]
    found = fl.evaluate(
        "minkowski_4r", ["half_angle_root", *slopes, *trusts], branch=1, theta=-1.1524972054802625, **kite
    )
    assert np.isinf(found["half_angle_root"])
    assert all(np.isnan(found[slope]) for slope in slopes)
    assert {float(found[trust]) for trust in trusts} == {2.0}


# -- far out ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [720.0, 1e3, 1e42, 1e300, 1e308])
def test_the_loop_closes_at_any_rapidity(size):
    """Beyond 300, e^-theta is nothing beside 1: a rapidity is a constant, or theta and a constant."""
    names, design = (
        ("psi", "AB_rapidity", "dpsi_dtheta", "CB_orientation"),
        {"a": 1.0, "b": 2.0, "g": 0.5, "h": 3.0},
    )
    for sign in (-1.0, 1.0):
        near = evaluated([*names], sign * 300.0, **design)
        far = evaluated([*names, "configuration_status", "A_x"], sign * size, **design)
        assert (far["configuration_status"] == BEYOND).all()  # e^720 is
        assert np.isnan(far["A_x"]).all()
        np.testing.assert_array_equal(far["CB_orientation"], near["CB_orientation"])
        assert (abs(far["dpsi_dtheta"] - near["dpsi_dtheta"]) <= np.exp(-290.0)).all()
        for name in names[:2]:
            slope = np.rint(near[name] / (sign * 300.0))
            expected = slope * sign * size + (near[name] - slope * sign * 300.0)
            # two roundings of 300 near, and three of the value, one of which is that of k log(2)
            assert (abs(far[name] - expected) <= 2.0**-52 * 300.0 + 3 * 2.0**-53 * abs(expected)).all()
    at = {**design, "theta": size, "branch": 1.0}
    exact = HighPrecision(MINKOWSKI, ["psi"], at).at(at)["psi"]
    assert abs(CONTEXT.mpf(float(far["psi"][0].item())) - exact) <= 4 * 2.0**-53 * abs(exact)


def within_bounds(inputs, rng):
    """Compare derivatives by all inputs with 50 digits and their bounds; return how many have digits."""
    names = []
    for of in ("psi", "AB_rapidity", "phi", "zeta", "dpsi_dtheta", "B_x", "B_y", "X_x", "X_y", "A_x"):
        for by in "abghxy":
            with contextlib.suppress(fl.InputError):
                MINKOWSKI.resolve(derivative := f"d_{of}_d_{by}")
                names.append(derivative)
    assert len(names) > 30
    n = len(inputs["theta"])
    inputs = inputs | {"x": rng.uniform(-2, 2, n), "y": rng.uniform(-2, 2, n)}
    inputs["branch"] = rng.integers(1, 3, n).astype(float)
    found = fl.evaluate("minkowski_4r", [*names, *(f"{one}_error" for one in names)], **inputs)
    exact, tested = HighPrecision(MINKOWSKI, names, [*inputs]), 0
    for i in range(n):
        true = exact.at({name: values[i] for name, values in inputs.items()})
        for name in names:
            if CONTEXT.isnan(true[name]) or abs(true[name]) < 1e-290:  # bounds do not count underflow
                continue
            bound = found[f"{name}_error"][i]
            assert np.isfinite(found[name][i]), (name, i)
            assert abs(CONTEXT.mpf(found[name][i]) - true[name]) <= bound, (name, i)
            tested += bound < 1e-12 * abs(found[name][i])
    return tested


@pytest.mark.parametrize("n", [6, pytest.param(200, marks=pytest.mark.stress)])
def test_derivatives_hold_their_bounds_far_out(n):
    """Beyond 354, e^-theta times 2^-500 is subnormal: half of them were off by up to a factor of 2."""
    rng = np.random.default_rng(n)
    lengths = dict(zip("abgh", rng.uniform(0.3, 2.0, (4, n)), strict=True))
    theta = rng.choice([-1.0, 1.0], n) * np.linspace(345.0, 640.0, n)
    assert within_bounds(lengths | {"theta": theta}, rng) > 10 * n


@pytest.mark.parametrize("short", ["a", "g", "abgh"])
def test_derivatives_hold_their_bounds_where_links_are_short(short):
    """They are as great as the inverse of a length, which products with 2^1000 on the way have made infinite."""
    rng, n = np.random.default_rng(5), 8
    lengths = dict(zip("abgh", rng.uniform(0.3, 2.0, (4, n)), strict=True))
    for name in short:
        lengths[name] = lengths[name] * 2.0**-70
    theta = rng.choice([-1.0, 1.0], n) * rng.uniform(1.0, 4.0, n)
    if short != "abgh":  # AC is bent enough where e^theta makes up for the short link
        theta += np.copysign(50.0, theta)
    assert within_bounds(lengths | {"theta": theta}, rng) > 10 * n


# -- right, or flagged, never a quiet NaN -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("theta", "design", "code"),
    [
        (1.5, (1.0, 1.0, 4.0, 1.0), CLOSES),
        (0.5, (1.0, 1.0, 4.0, 1.0), WITHOUT_ZETA),
        (1.2, (1.0, 1.0, 4.0, 1.0), OPEN),
        (0.0, (1.0, 2.0, 1.0, 2.0), UNDETERMINED),
        (0.0, (1.0, 2.0, 1.0, 1.5), ESCAPED),
        (0.0, (3.0, 1.0, 1.0, 1.0), AT_A_LIMIT),
        (0.3, (-1.0, 1.0, 4.0, 1.0), INVALID),
    ],
)
def test_what_went_wrong_is_told(theta, design, code):
    found = evaluated(["configuration_status", "psi"], theta, **dict(zip("abgh", design, strict=True)))
    assert (found["configuration_status"] == code).all()
    assert code != INVALID or np.isnan(found["psi"]).all()


def beyond_the_doubles(inputs):
    """Tell which coordinates are greater than any double: they are even where the longest link is near 1."""
    power = np.frexp(np.max([inputs[name] for name in "abgh"], axis=0))[1]
    near_1 = {name: value if name == "theta" else np.ldexp(value, -power) for name, value in inputs.items()}
    found = evaluated(COORDINATES, **near_1)
    with np.errstate(over="ignore"):
        infinite = {name: np.isinf(np.ldexp(found[name], power)) for name in COORDINATES}
    return {name: infinite[name] & (np.isfinite(found[name]) | (power >= 0)) for name in COORDINATES}


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.stress)])
def test_what_is_no_finite_number_has_a_flag_and_each_flag_a_cause(seed):
    inputs = adversarial(np.random.default_rng(seed), 20000 * seed**4)
    inputs["a"][0] = -1.0
    inputs |= {name: np.append(values, np.ones(9)) for name, values in inputs.items()}
    for k, name in enumerate("abgh"):  # a length below 3e-39 of the longest
        inputs[name][-9:] = np.roll([1e-20, 1e20, 2e20, 1e20], k)[np.arange(9) % 4]
    inputs["theta"][-9:] = np.linspace(1.0, 90.0, 9)
    found = evaluated(ALL, **inputs)
    beyond = beyond_the_doubles(inputs)
    missing = {name: ~np.isfinite(found[name]) for name in ALL}
    missing |= {name: np.isnan(found[name]) for name in COEFFICIENTS}
    missing |= {name: missing[name] & ~(np.isinf(found[name]) & beyond[name]) for name in COORDINATES}
    for name in ALL:
        assert (found[FLAGS.get(name, "configuration_status")][missing[name]] != 0).all(), name
    # Each flag is met, but for both roots' exceptions at once, and none is there without a cause.
    for name in ("configuration_status", *dict.fromkeys(FLAGS.values())):
        assert set(np.unique(found[name]).astype(int)) | {9} >= set(MINKOWSKI.public[name].flags)
        told = [of for of in ALL if FLAGS.get(of, "configuration_status") == name]
        cause = np.any([~np.isfinite(found[of]) for of in told], axis=0)
        if name == "configuration_status":
            cause |= found[name] == AT_A_LIMIT  # where the rates are infinite
        assert (cause[found[name] != 0]).all(), name
    # and what each flag of a closed loop says is so
    code, inside = found["configuration_status"], np.isin(found["configuration_status"], (WITHOUT_ZETA, 9))
    for name in ("psi", "AB_rapidity", "phi", "A_x", "A_y", "B_x", "B_y", "cosh_zeta", "loop_residual"):
        there = np.isfinite(found[name]) | beyond.get(name, False)
        assert there[np.isin(code, (CLOSES, WITHOUT_ZETA, 8, 9))].all(), name
    closed = (code == CLOSES) | (code >= WITHOUT_ZETA)
    np.testing.assert_array_equal(np.isnan(found["zeta"][closed]), inside[closed])
    assert (found["cosh_zeta"][inside] <= -1.0).all()
    assert (found["half_angle_root"][code >= 8] == np.inf).all()


@pytest.mark.parametrize("n", [60, pytest.param(1500, marks=pytest.mark.stress)])
def test_what_has_no_flag_is_right(n):
    inputs = adversarial(np.random.default_rng(7), n)
    names = [name for name in ALL if not MINKOWSKI.public[name].flags and "residual" not in name]
    found = evaluated([*names, *set(FLAGS.values())], **inputs)
    tested = 0
    for k, i in np.ndindex(2, n):
        one = {name: float(values[i]) for name, values in inputs.items()} | {"branch": k + 1}
        here = [name for name in names if np.isfinite(found[name][k, i])]
        # A power of two of the lengths too many and the reference itself underflows.
        if not here or abs(one["theta"]) > 1e5 or not all(np.isfinite([*one.values()])):
            continue
        true = reference(here, one, catalogue=MINKOWSKI)
        sums = condition_sums(here, one, catalogue=MINKOWSKI)
        for name in here:
            if mp.isnan(sums[name]):  # an end of what closes: no neighbour to measure by
                continue
            # 4 roundings; rates that fall like e^-|theta| underflow below 1e-200, products of two lengths at last
            bound = 4 * UNIT_ROUNDING * (sums[name] + abs(true[name])) + (1e-200 if name in FLAGS else 0.0)
            bound += 2.0**-1074 if name in COEFFICIENTS else 0.0
            error = abs(mp.mpf(float(found[name][k, i])) - true[name])
            assert error <= bound, (name, one, float(found[name][k, i]), true[name])
            tested += 1
    assert tested > 5 * n


# -- the door -----------------------------------------------------------------------------------------------------

UNIT = {"a": 1.0, "b": 1.0, "g": 4.0, "h": 1.0}


def test_theta_is_an_array_and_has_a_usual_one():
    found = fl.sweep("minkowski_4r", fl.grid(**UNIT), ["psi", "phi_max"])
    np.testing.assert_array_equal(found.theta, np.linspace(-4.0, 4.0, 401))
    assert found.theta.attrs["units"] == "1"
    assert found.psi.dims == ("branch", "theta")
    assert found.phi_max.attrs["extrema"] == "sampled"


@pytest.mark.parametrize(
    ("quantity", "options", "key", "remedy"),
    [
        ("phi_max", {"angles": 100}, "angles", "numpy.linspace"),
        ("phi_max", {"theta": [0.0, np.inf]}, "theta[1]", "finite numbers"),
        ("phi_max", {"theta1": [0.0]}, "theta1", "theta"),
        ("phi_max", {"theta": [0.0], "angles": [1.0]}, "theta", "one of them"),
        ("phi_max", {"extrema": "refined"}, "extrema", "extrema='sampled'"),
        ("psi_fluctuation", {}, "'psi_fluctuation'", ""),
        ("psi_extrema", {}, "'psi_extrema'", ""),
    ],
)
def test_bad_input_is_told_in_one_line(quantity, options, key, remedy):
    with refused(key, remedy):
        fl.sweep("minkowski_4r", fl.grid(**UNIT), [quantity], **options)


def test_a_study_gives_theta_by_its_name(tmp_path):
    text = 'mechanism = "minkowski_4r"\nquantities = ["A_x"]\n[design]\na = 1.0\nb = 1.0\ng = 4.0\nh = 1.0\n[cycle]\n'
    study = tmp_path / "study.toml"
    study.write_text(text + "theta = {linspace = [-1.0, 1.0, 5]}\n")
    with fl.run_study(study, to=tmp_path / "maps.h5") as found:
        np.testing.assert_array_equal(found.theta, [-1.0, -0.5, 0.0, 0.5, 1.0])
    study.write_text(text + "theta = 5\n")
    with pytest.raises(
        InputError, match=r"cycle\.theta: 5 is not an array.*such as \{linspace = \[-4, 4, 401\]\}"
    ):
        fl.run_study(study, to=tmp_path / "more.h5")

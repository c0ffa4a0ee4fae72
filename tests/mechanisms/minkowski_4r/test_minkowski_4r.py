"""The Minkowskian 4R: eq. (3), rapidities of any size, and flags where something is no number."""

import contextlib

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.neighbourhoods import minkowski_4r

import fastlink as fl
from fastlink.mechanisms import catalogue
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


def test_both_roots_are_past_pointing_in_the_example_of_the_errata():
    names = ["CB_orientation", "half_angle_root", "zeta", "cosh_zeta"]
    found = evaluated(names, [-1.0, 0.0, 1.0], a=1.0, b=1.0, g=4.0, h=1.0)
    assert (found["CB_orientation"] == -1).all()
    assert (abs(found["half_angle_root"]) > 1).all()
    assert np.isnan(found["zeta"]).all()
    assert (found["cosh_zeta"] < -1).all()


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
        assert_array_equal(far["CB_orientation"], near["CB_orientation"])
        assert (abs(far["dpsi_dtheta"] - near["dpsi_dtheta"]) <= np.exp(-290.0)).all()
        for name in names[:2]:
            slope = np.rint(near[name] / (sign * 300.0))
            expected = slope * sign * size + (near[name] - slope * sign * 300.0)
            # two roundings of 300 near, and three of the value, one of which is that of k log(2)
            assert (abs(far[name] - expected) <= 2.0**-52 * 300.0 + 3 * 2.0**-53 * abs(expected)).all()
    at = {**design, "theta": size, "branch": 1.0}
    exact = HighPrecision(MINKOWSKI, ["psi"], at).at(at)["psi"]
    assert abs(CONTEXT.mpf(float(far["psi"][0].item())) - exact) <= 4 * 2.0**-53 * abs(exact)


@pytest.mark.parametrize("n", [6, pytest.param(200, marks=pytest.mark.stress)])
def test_derivatives_hold_their_bounds_far_out(n):
    """Beyond 354, e^-theta times 2^-500 is subnormal: half of them were off by up to a factor of 2."""
    rng = np.random.default_rng(n)
    lengths = dict(zip("abgh", rng.uniform(0.3, 2.0, (4, n)), strict=True))
    theta = rng.choice([-1.0, 1.0], n) * np.linspace(345.0, 640.0, n)
    names = []
    for of in ("psi", "AB_rapidity", "phi", "zeta", "dpsi_dtheta", "B_x", "B_y", "X_x", "X_y", "A_x"):
        for by in "abghxy":
            with contextlib.suppress(fl.InputError):
                MINKOWSKI.resolve(derivative := f"d_{of}_d_{by}")
                names.append(derivative)
    assert len(names) > 30
    inputs = lengths | {"theta": theta, "x": rng.uniform(-2, 2, n), "y": rng.uniform(-2, 2, n)}
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
    assert tested > 10 * n


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
    rng, n = np.random.default_rng(seed), 20000 * seed**4
    inputs = minkowski_4r(rng, n)
    size = np.where(rng.random(n) < 0.5, 1.0, 10.0 ** rng.uniform(-3.0, 20.0, n))
    inputs |= {name: inputs[name] * size for name in "abghxy"}
    sizes = [rng.uniform(300.0, 800.0, n), rng.uniform(700.0, 712.0, n), 10.0 ** rng.uniform(-300.0, 0.0, n)]
    far = np.choose(rng.integers(0, 3, n), sizes) * rng.choice([-1.0, 1.0], n)
    inputs["theta"] = np.where(rng.random(n) < 0.4, far, inputs["theta"])
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
        assert set(np.unique(found[name]).astype(int)) | {9} >= set(MINKOWSKI.public[name].flags), name
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
    assert_array_equal(np.isnan(found["zeta"][closed]), inside[closed])
    assert (found["cosh_zeta"][inside] <= -1.0).all()
    assert (found["half_angle_root"][code >= 8] == np.inf).all()

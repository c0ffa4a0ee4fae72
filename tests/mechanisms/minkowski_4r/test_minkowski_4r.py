"""The Minkowskian 4R: closure by substitution, eq. (3), laws of its plane, precision near everything."""

from __future__ import annotations

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from tests.support.configurations import DIGITS
from tests.support.refusals import refused

import fastlink as fl
from fastlink.errors import InputError
from fastlink.facts.evaluate import read_facts
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

MINKOWSKI = catalogue("minkowski_4r")
#: In roundings of a double; 3.0 is the worst seen in 10^4 configurations of the families.
MULTIPLE = 4
QUANTITIES = [
    name
    for name, fact in MINKOWSKI.public.items()
    if MINKOWSKI.varies(name) and "residual" not in name and not fact.flags
]
# They are there though the loop does not close.
OF_THE_CRANK = ("A_x", "A_y")
CLOSES, OPEN, ESCAPED, UNDETERMINED, AT_A_LIMIT, BEYOND, INVALID, WITHOUT_ZETA = range(8)
POSITION = ["psi", "CB_orientation", "AB_rapidity", "AB_orientation"]
#: One kernel for all sweeps, of fewer than 32 rapidities each, as compiling takes longest.
ALL = [name for name in MINKOWSKI.public if MINKOWSKI.varies(name)]


def maps(theta, space=None, **design):
    designs = fl.grid(**({"x": 0.3, "y": -0.7} | design)) if space is None else space
    assert len(theta) < 32
    return fl.sweep("minkowski_4r", designs, ALL, theta=theta, threads=1, allow_invalid=True)


def random_designs(n, seed):
    sides = dict.fromkeys("abgh", (0.3, 2.0)) | dict.fromkeys("xy", (-2.0, 2.0))
    return fl.latin_hypercube(n, seed=seed, **sides)


def exact(names, one):
    with mp.workdps(DIGITS):
        return read_facts(MINKOWSKI, names, {name: mp.mpf(float(value)) for name, value in one.items()})


def test_residuals_are_roundings_on_every_circuit():
    found = maps([*np.linspace(-6.0, 6.0, 25), -650.0, 300.0, 650.0], random_designs(1000, 4))
    closes = np.isin(found.configuration_status.values, (CLOSES, WITHOUT_ZETA))
    assert closes.mean() > 0.9
    # Two sums of four terms, each right to 2 roundings; a product of two sums of 10 terms of 8 roundings at most.
    assert found.loop_residual.values[closes].max() <= 8 * UNIT_ROUNDING
    assert np.abs(found.sextic_residual.values[closes]).max() <= 16 * UNIT_ROUNDING


# -- the equations of the paper --------------------------------------------------------------------------------


def test_the_loop_and_the_branches_are_those_of_equation_3():
    rng = np.random.default_rng(5)
    orientations = set()
    for _ in range(150):
        one = dict(zip("abgh", rng.uniform(0.3, 2.0, 4), strict=True)) | {"theta": rng.uniform(-4, 4)}
        with mp.workdps(DIGITS):
            a, b, g, h, theta = (mp.mpf(float(v)) for v in one.values())
            A = 2 * g * b - 2 * a * b * mp.cosh(theta)
            B = 2 * a * b * mp.sinh(theta)
            C = h * h - g * g - b * b - a * a + 2 * a * g * mp.cosh(theta)
            square = B * B + C * C - A * A
            for branch, sign in ((1, 1), (2, -1)):
                found = exact([*POSITION, "half_angle_root"], one | {"branch": branch})
                if square < 0:
                    assert mp.isnan(found["psi"])
                    continue
                root = (-B + sign * mp.sqrt(square)) / (A + C)
                assert abs(found["half_angle_root"] - root) <= abs(root) * mp.mpf(10) ** -40
                future = found["CB_orientation"]
                assert future == (1 if abs(root) < 1 else -1)
                orientations.add(future)
                # Eq. (4) by substitution, with the orientation of CB: |AB|^2 = h^2, and the direction of AB.
                AB_x = g + future * b * mp.cosh(found["psi"]) - a * mp.cosh(theta)
                AB_y = future * b * mp.sinh(found["psi"]) - a * mp.sinh(theta)
                assert abs(AB_x**2 - AB_y**2 - h * h) <= mp.mpf(10) ** -38
                assert abs(mp.atanh(AB_y / AB_x) - found["AB_rapidity"]) <= mp.mpf(10) ** -35
                assert mp.sign(AB_x) == found["AB_orientation"]
    assert orientations == {-1.0, 1.0}


def test_both_roots_are_past_pointing_in_the_example_of_the_errata():
    found = maps([-1.0, 0.0, 1.0], a=1.0, b=1.0, g=4.0, h=1.0)
    assert (found.CB_orientation == -1).all()
    assert (abs(found.half_angle_root) > 1).all()
    assert np.isnan(found.zeta).all()
    assert (found.cosh_zeta < -1).all()


EXAMPLES = {  # section 3.7: lengths, then ch(theta) at the limits; None where there is none
    1: ((1.0, 1.0, 4.0, 1.0), (1.625, 2.125)),
    2: ((1.2, 0.4, 0.4, 0.4), (None, 5.0 / 3.0)),
    3: ((0.5, 1.0, 2.0, 2.5), (None, None)),
    4: ((0.6, 1.0, 0.7, 0.5), (None, None)),
}


@pytest.mark.parametrize("number", EXAMPLES)
def test_the_examples_assemble_where_the_paper_says(number):
    (a, b, g, h), (inner, outer) = EXAMPLES[number]
    theta = np.linspace(0.0, 4.0, 4001)
    lengths = {"a": a, "b": b, "g": g, "h": h, "theta": theta}
    status = fl.evaluate("minkowski_4r", ["configuration_status"], **lengths)["configuration_status"]
    gap = (theta > np.arccosh(inner or 1.0)) & (theta < np.arccosh(outer or 1.0))
    # The limits themselves are not samples, but theta = 0 of examples 2 and 3 is a limit.
    assert ((status == OPEN) == gap)[1:].all()


def test_the_point_at_infinity_of_the_half_angle_is_an_ordinary_position():
    """At A + C = 0 of Corollary 3.2 one root is y = infinity: B = (g - b, 0)."""
    theta = np.arccosh(1.5)
    found = maps([theta], a=1.0, b=1.0, g=4.0, h=1.0)
    # q = -1 there; theta is off by a rounding, and dpsi/dtheta is 1 or 14.
    assert np.abs(found.psi.values).min() <= 32 * UNIT_ROUNDING
    assert (found.CB_orientation == -1).all()
    folded = fl.evaluate(
        "minkowski_4r", ["half_angle_root", "B_x", "B_y"], branch=[1, 2], theta=0.5, a=2, b=3, g=3, h=2
    )
    k = int(np.argmax(np.abs(folded["half_angle_root"])))
    assert folded["half_angle_root"][k] == np.inf
    assert abs(folded["B_x"][k]) + abs(folded["B_y"][k]) <= 8 * 3 * UNIT_ROUNDING


# -- laws of the plane -------------------------------------------------------------------------------------------


def test_the_mirror_exchanges_the_branches_bit_by_bit():
    theta = np.array([0.3, 1.0, 2.5, 40.0, 800.0])
    designs = random_designs(50, 6)
    mirrored = replace(designs, columns=designs.columns | {"y": -designs.columns["y"]})
    odd = ["psi", "AB_rapidity", "half_angle_root", "A_y", "B_y", "X_y", "d2psi_dtheta2"]
    even = ["CB_orientation", "AB_orientation", "A_x", "B_x", "X_x", "cosh_zeta", "zeta", "dpsi_dtheta"]
    there, back = maps(theta, designs), maps(-theta, mirrored)
    for names, sign in ((odd, -1.0), (even, 1.0)):
        for name in names:
            np.testing.assert_array_equal(there[name].values, sign * back[name].values[:, ::-1])


def test_links_keep_their_lengths_and_orientations_in_every_frame():
    """A Lorentz boost multiplies null coordinates by e^t and e^-t: intervals and orientations stay."""
    found = maps(np.linspace(-2.0, 2.0, 21), random_designs(100, 7))
    closes = found.AB_orientation != 0
    dx, dy = found.B_x - found.A_x, found.B_y - found.A_y
    for boost in (0.0, 0.8):
        x, y = np.cosh(boost) * dx + np.sinh(boost) * dy, np.sinh(boost) * dx + np.cosh(boost) * dy
        size = x * x + y * y + found.A_x**2 + found.B_x**2
        assert (
            (abs(x * x - y * y - found.h**2) <= 64 * UNIT_ROUNDING * np.exp(2 * boost) * size)
            .values[closes]
            .all()
        )
        assert (np.sign(x) == found.AB_orientation).values[closes].all()
    # The coupler point is carried along: its interval from A is x^2 - y^2.
    dx, dy = found.X_x - found.A_x, found.X_y - found.A_y
    size = dx * dx + dy * dy + found.A_x**2 + found.X_x**2
    assert (
        (abs(dx * dx - dy * dy - (found.x**2 - found.y**2)) <= 64 * UNIT_ROUNDING * size).values[closes].all()
    )


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


# -- far out and at the edges --------------------------------------------------------------------------------------


def test_far_beyond_the_overflow_of_cosh_angles_are_right_and_points_flagged():
    design = {"a": 0.7, "b": 1.3, "g": 1.1, "h": 0.4}
    theta = np.array([700.0, 750.0, 1e4, 1e6])
    found = maps(theta, **design)
    for k, branch in enumerate((1, 2)):
        for i, t in enumerate(theta):
            true = exact([*POSITION, "zeta"], design | {"theta": t, "branch": branch})
            for name in (*POSITION, "zeta"):
                # psi and zeta follow theta or are of the size of 1: 4 roundings of that.
                bound = 4 * UNIT_ROUNDING * (abs(true[name]) + 8)
                assert abs(mp.mpf(float(found[name].values[k, i])) - true[name]) <= bound
    far = theta > 710.0
    assert (found.configuration_status.values[:, far] == BEYOND).all()
    assert np.isnan(found.A_x.values[:, far]).all()
    assert (found.configuration_status.values[:, ~far] == CLOSES).all()
    for name, values in found.data_vars.items():
        # A, B and C are of degree 1 in cosh: beyond the range of numbers they are infinite, and nothing else is.
        assert np.isinf(values).any() == name.startswith("coefficient_"), name


@pytest.mark.parametrize("scale", [1e-20, 1.0, 1e20])
def test_lengths_from_1e_minus_20_to_1e20(scale):
    lengths = {name: value * scale for name, value in {"a": 0.7, "b": 1.3, "g": 1.1, "h": 0.4}.items()}
    theta = [-5.0, 0.5, 3.0]
    found = maps(theta, **lengths)
    same = maps(theta, a=0.7, b=1.3, g=1.1, h=0.4)
    # The scaled lengths are each off by a rounding; the condition number of these configurations is below 30.
    np.testing.assert_allclose(found.psi, same.psi, rtol=0.0, atol=64 * UNIT_ROUNDING)
    np.testing.assert_allclose(found.AB_rapidity, same.AB_rapidity, rtol=0.0, atol=64 * UNIT_ROUNDING)
    assert np.isfinite(found.B_x.values[~np.isnan(found.psi.values)]).all()


def test_what_went_wrong_is_told():
    def status(theta, **design):
        return maps([theta], **design).configuration_status.values[:, 0].tolist()

    assert status(1.5, a=1.0, b=1.0, g=4.0, h=1.0) == [CLOSES, CLOSES]
    assert status(0.5, a=1.0, b=1.0, g=4.0, h=1.0) == [WITHOUT_ZETA, WITHOUT_ZETA]
    assert status(1.2, a=1.0, b=1.0, g=4.0, h=1.0) == [OPEN, OPEN]
    assert status(0.0, a=1.0, b=2.0, g=1.0, h=2.0) == [UNDETERMINED, UNDETERMINED]
    assert status(0.0, a=1.0, b=2.0, g=1.0, h=1.5) == [ESCAPED, ESCAPED]
    assert status(0.0, a=3.0, b=1.0, g=1.0, h=1.0) == [AT_A_LIMIT, AT_A_LIMIT]
    bad = maps([0.3], a=-1.0, b=1.0, g=4.0, h=1.0)
    assert (bad.configuration_status == INVALID).all()
    assert np.isnan(bad.psi).all()


# -- the door ------------------------------------------------------------------------------------------------------


def test_theta_is_an_array_and_has_a_usual_one():
    found = fl.sweep("minkowski_4r", fl.grid(a=1.0, b=1.0, g=4.0, h=1.0), ["psi", "phi_max"])
    np.testing.assert_array_equal(found.theta, np.linspace(-4.0, 4.0, 401))
    assert found.theta.attrs["units"] == "1"
    assert found.psi.dims == ("branch", "theta")
    assert found.phi_max.attrs["extrema"] == "sampled"


@pytest.mark.parametrize(
    ("options", "key", "remedy"),
    [
        (
            {"angles": 100},
            "angles",
            "numpy.linspace",
        ),
        ({"theta": [0.0, np.inf]}, "theta[1]", "finite numbers"),
        ({"theta1": [0.0]}, "theta1", "theta"),
        ({"theta": [0.0], "angles": [1.0]}, "theta", "one of them"),
        ({"extrema": "refined"}, "extrema", "extrema='sampled'"),
        ({"quantities": ["psi_fluctuation"]}, "'psi_fluctuation'", ""),
        ({"quantities": ["psi_extrema"]}, "'psi_extrema'", ""),
    ],
)
def test_bad_input_is_told_in_one_line(options, key, remedy):
    options = {"quantities": ["phi_max"]} | options
    with refused(key, remedy):
        fl.sweep("minkowski_4r", fl.grid(a=1.0, b=1.0, g=4.0, h=1.0), options.pop("quantities"), **options)


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

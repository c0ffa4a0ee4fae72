"""No digits are lost, however unlike the lengths and however far rho from 1: against circles alone, with 120 digits."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest
from tests.support import focal_geometry as geometry
from tests.support.focal_configurations import DRIVES, LENGTHS, UNLIKE, rows, unlike

import fastlink as fl
from fastlink.numerics.compensated import UNIT_ROUNDING

#: The longest chain from the inputs to a quantity has some 60 operations that do not cancel, of one rounding each.
#: Left out is what is only a multiple (rates by time).
ROUNDINGS = 64
#: What is within its bound, but may lose more: the circle PSQT where P and Q are next to M and N; by sigma, what the
#: direction of NB decides where that is far less certain.
FRAME = {f"{joint}_{way}_AB" for joint in "MNS" for way in ("along", "across")}
UNCERTAIN = {"phi": {"PSQT_x"}, "sigma": {"PSQT_x", "PFQX_x", "PFQX_y", "PFQX_radius", *FRAME}}


def lost(drive, inputs):
    """Return by name the errors that are too great, in roundings of the value and of the inputs."""
    exact = {
        name: value for name, value in geometry.at(inputs, drive).items() if name not in UNCERTAIN[drive]
    }
    found = fl.evaluate("focal", tuple(exact), input=drive, **inputs)
    sizes, units = {}, {name: abs(value) for name, value in exact.items()}
    for name, value in exact.items():
        error = geometry.MP.mpf(float(found[name])) - value
        sizes[name] = abs(geometry.turned(error) if name in geometry.ANGLES else error) / UNIT_ROUNDING
    for moved in (drive, "rho", *LENGTHS):
        beyond = [name for name in exact if not sizes[name] <= ROUNDINGS * units[name]]
        if not beyond:
            return {}
        for name, change in geometry.changes(inputs, drive, exact, moved, beyond).items():
            units[name] += change
    return {
        name: float(sizes[name] / units[name]) for name in exact if not sizes[name] <= ROUNDINGS * units[name]
    }


def losses(drive, kind, n, seed):
    """Return what is lost in each of n configurations at most, those that close."""
    found = []
    for inputs in rows(unlike(drive, kind, np.random.default_rng(seed), n)):
        with suppress(geometry.DoesNotCloseError):
            found.append(lost(drive, inputs))
    return found


@pytest.mark.sample(3)
@pytest.mark.parametrize("kind", UNLIKE)
@pytest.mark.parametrize("drive", DRIVES)
def test_no_quantity_loses_digits(drive, kind):
    found = losses(drive, kind, 20, 3)
    assert len(found) > 8
    assert not any(found)


#: One of each kind that lost up to 1700 roundings times the condition by formulas that cancel: short AB and MN with F
#: next to S; the same where AB does not revolve; short MA and NB with FT next to r; P or Q, and both, next to S by
#: the rocker and by the crank; AB through M with the crank nearly along MN. Input, a, b, c, d and rho, completion,
#: branch and angle.
HARD = (
    ("phi", (1.4876067609403902, 1.4876067915037017, 1.1641287653460961e-08, 5.08542713222432e-08),
     -3.1936477301963375, 1, 1, -2.21582079157216),
    ("phi", (1.1064759783042777, 1.1065813593618898, 0.00013470665958833461, 0.00011341668559384905),
     -2.5247319287543577e-06, 1, 1, 2.761629103640262),
    ("phi", (2.62689561908054e-06, 1.8133461291596687e-06, 1.0736202188969304, 1.0736212447261426),
     -0.2164134315982942, 2, 1, 0.8171327104814652),
    ("phi", (1.5659435107387152, 1.6279134292230382e-06, 1.565942637138195, 2.0236994430000296e-06),
     610.6705184519694, 2, 2, 1.6208317177807414),
    ("sigma", (1.139446842609193, 0.0008942536246440642, 1.7659998470817786, 1.2185614987526048),
     -11063382.666683791, 1, 1, 2.7222103606148997),
    ("sigma", (3.825450676050422e-08, 1.8923354364733516, 1.7455017174889176e-07, 1.892335598755912),
     57298.769137784766, 1, 2, 2.614056658498866),
    ("sigma", (0.7974562804843726, 1.1132276716677723, 1.7606986842216354, 0.44909383608152686),
     -0.0005521337544905362, 1, 2, -0.003100490020995127),
)  # fmt: skip


@pytest.mark.parametrize("hard", HARD)
def test_no_quantity_loses_digits_where_joints_nearly_meet(hard):
    drive, lengths, rho, completion, branch, angle = hard
    inputs = dict(zip(LENGTHS, lengths, strict=True)) | {"rho": rho, "completion": float(completion)}
    assert not lost(drive, inputs | {"branch": float(branch), drive: angle})


@pytest.mark.stress
@pytest.mark.parametrize("kind", UNLIKE)
@pytest.mark.parametrize("drive", DRIVES)
def test_no_quantity_loses_digits_in_many_configurations(drive, kind):
    found = losses(drive, kind, 1000, 4)
    assert len(found) > 400
    assert not any(found), [one for one in found if one]


def test_the_circle_through_F_is_nowhere_without_F():
    """Where p and q are imaginary S and Y have places, but the circle through S, F, T and Y has none."""
    design = {"a": 0.956, "b": 0.341, "c": 0.395, "d": 0.354, "s": 0.578, "completion": 2, "branch": 1}
    found = fl.evaluate("focal", ["status", "S_x", "Y_x", "SFTY_x", "SFTY_y"], phi=1e-3, **design)
    assert np.isfinite(found["S_x"])
    assert np.isfinite(found["Y_x"])
    assert np.isnan([found["SFTY_x"], found["SFTY_y"]]).all()


@pytest.mark.parametrize("drive", DRIVES)
def test_the_figure_is_within_its_bounds(drive):
    """X, Y, the circles of section 4 and the frame of AB, with 120 digits."""
    count = 0
    for kind in UNLIKE:
        for inputs in rows(unlike(drive, kind, np.random.default_rng(5), 8)):
            with suppress(geometry.DoesNotCloseError):
                numbers = {name: geometry.MP.mpf(value) for name, value in inputs.items()}
                exact = geometry.Position(numbers, drive).figure()
                found = fl.evaluate("focal", [*exact, *map("{}_error".format, exact)], input=drive, **inputs)
                for name, value in exact.items():
                    assert abs(geometry.MP.mpf(float(found[name])) - value) <= float(found[f"{name}_error"])
                    count += 1
    assert count > 500


def test_F_is_nowhere_where_the_crank_cannot_be():
    """By sigma F lies at a crank that only MPF and NQF hold: with neither in reach it has no place."""
    design = {"a": 1.5, "b": 1.2, "c": 1.4, "d": 0.8, "rho": 0.7, "completion": 1, "branch": 1}
    sigma = np.linspace(-3.1, 3.1, 63)
    found = fl.evaluate("focal", ["crank_type", "F_x", "F_y", "P_x"], input="sigma", sigma=sigma, **design)
    assert np.isin(found["crank_type"], (1, 2, 3)).all()
    assert 0 < np.isnan(found["P_x"]).sum() < len(sigma)
    for name in ("F_x", "F_y"):
        np.testing.assert_array_equal(np.isnan(found[name]), np.isnan(found["P_x"]))

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
CIRCLES = {f"{points}_{part}" for points in ("PFQX", "SFTY", "PSQT") for part in ("x", "y", "radius")}
#: What is known to lose digits in one of a thousand configurations.
LOSING = {"F_y", "transmission_angle_F", "X_x", "X_y", *CIRCLES}
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


@pytest.mark.parametrize("kind", UNLIKE)
@pytest.mark.parametrize("drive", DRIVES)
def test_no_quantity_loses_digits(drive, kind):
    found = losses(drive, kind, 20, 3)
    assert len(found) > 8
    assert not any(found)


@pytest.mark.stress
@pytest.mark.parametrize("kind", UNLIKE)
@pytest.mark.parametrize("drive", DRIVES)
def test_hardly_any_quantity_loses_digits_in_many_configurations(drive, kind):
    """With long rockers beside each other F_y, X and the angle at F by phi lose up to three digits more."""
    found = losses(drive, kind, 1000, 4)
    assert len(found) > 400
    beyond = [one for one in found if one]
    assert len(beyond) <= 0.005 * len(found), beyond
    assert {name for one in beyond for name in one} <= LOSING
    assert all(size < 2**12 for one in beyond for size in one.values())


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

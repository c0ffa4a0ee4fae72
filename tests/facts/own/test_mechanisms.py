"""A quantity of one's own of every mechanism: values, extremes, derivatives."""

import numpy as np
import pytest

import fastlink as fl

slider = fl.extend("slider_crank")
hart = fl.extend("hart")
focal = fl.extend("focal")
minkowski = fl.extend("minkowski_4r")


@slider.quantity(units="m s-1", description="Greater of the speeds of slider and pin")
def of_slider_crank(slider_velocity, omega, r):
    return max(abs(slider_velocity), omega * r / 2)


@hart.quantity(units="m2", description="Squared distance of Q from the origin")
def of_hart(Q_x, Q_y):
    return Q_x**2 + Q_y**2


@focal.quantity(units="m", description="Distance of A and B")
def of_focal(A_x, A_y, B_x, B_y):
    return ((A_x - B_x) ** 2 + (A_y - B_y) ** 2) ** 0.5


@minkowski.quantity(units="m2", description="Product of the coordinates of A")
def of_minkowski_4r(A_x, A_y):
    return A_x * A_y


CASES = {
    "slider_crank": (slider, {"r": 0.1, "l": 0.3, "e": 0.02, "omega": 20.0}),
    "hart": (hart, {"m": 4.0, "n": 8.0, "d": 6.0, "kappa": 0.5}),
    "focal": (focal, {"a": 5.0, "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0, "completion": 1}),
    "minkowski_4r": (minkowski, {"a": 1.0, "b": 7.0, "g": 4.0, "h": 1.0}),
}


LATER = ("focal", "hart")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.stress if name in LATER else ()) for name in CASES]
)
def test_it_is_compiled_searched_and_differentiated(name):
    mechanism, design = CASES[name]
    own, first = f"of_{name}", next(iter(design))
    wanted = [own, f"{own}_max", f"{own}_min", f"d_{own}_d_{first}", f"{own}_error"]
    maps = fl.sweep(
        mechanism, design, wanted, angles=None if mechanism is minkowski else 90, branch=1, verify=1
    )
    curve = maps[own]
    assert curve.notnull().any()
    size = float(abs(curve).max())
    # a sample is no better than the extreme; the extreme is off a sample by a step times the slope at most
    assert float(curve.max()) <= float(maps[f"{own}_max"]) + 1e-12 * size
    assert float(maps[f"{own}_min"]) <= float(curve.min()) + 1e-12 * size
    assert maps.attrs["verify_mismatches"] == 0
    for each in (own, f"d_{own}_d_{first}"):
        assert maps[each].attrs["error_max_roundings"] < 64.0
    assert np.isfinite(maps[f"{own}_error"].where(curve.notnull())).any()

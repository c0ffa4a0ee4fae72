"""One browser, and one small map, for all tests of the page."""

import numpy as np
import pytest
from tests.support.browser import chromium
from tests.support.sweeps import sweep_4r

import fastlink as fl


@pytest.fixture(scope="package")
def browser():
    with chromium() as found:
        yield found


@pytest.fixture(scope="package")
def path(tmp_path_factory):
    """A map over three lengths, in both assembly modes, with codes and with designs that do not assemble."""
    file = tmp_path_factory.mktemp("maps") / "lengths.h5"
    space = fl.grid(
        a1=[0.3, 0.4, 0.9], a2=np.linspace(0.8, 1.5, 15), a3=np.linspace(0.4, 1.3, 13), a4=1.0, omega1=10.0
    )
    names = ["omega4_max", "transmission_angle_min", "grashof_class"]
    sweep_4r(space, names, extrema="sampled", theta1=24, to=file, verify=0).close()
    return file


@pytest.fixture(scope="module")
def page(path):
    with fl.explore(path, browser=False) as served:
        yield served

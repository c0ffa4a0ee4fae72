"""Requests of each kind of design space, for the tests of sweeps in parts."""

import numpy as np

import fastlink as fl
from tests.support.sweeps import sweep_both

COUPLERS, OUTPUTS, SPEEDS = np.linspace(1.0, 1.4, 7), np.linspace(0.6, 1.0, 5), np.array([0.5, 3.0, 7.0])
AXES = {"omega1": SPEEDS, "a2": COUPLERS, "a3": OUTPUTS}
TABLE = {"a1": np.linspace(0.3, 0.5, 11), "a2": np.linspace(1.0, 1.4, 11)}
TABLE |= {"part_no": [f"P{k}" for k in range(11)], "a3": 0.8, "a4": 1.0}
HUNDREDS = {"a2": np.linspace(1.0, 1.4, 25), "a3": np.linspace(0.6, 1.0, 21)}
RANGES = {"a1": (0.3, 0.5), "a2": (1.0, 1.4), "a3": 0.8, "a4": 1.0}
TINY = {"a1": (3e-7, 5.0), "a2": (1e-7, 1.4), "a3": 0.8e-6, "a4": 1e-6}
GRID = {"a1": 0.4, "a4": 1.0}
BARS = {"b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0}
FOCAL = {"a": [5.0, 5.5, 6.0, 6.5, 7.0], "name": list("vwxyz"), **BARS}


def of_4r(space, *quantities, **options):
    return "planar_4r", space, [*quantities], options


def of_focal(space):
    return "focal", space, ["crank_type"], {}


#: Mechanism, designs, quantities, options of each.
REQUESTS = {
    "grid": of_4r(lambda: fl.grid(**GRID, a2=COUPLERS, a3=OUTPUTS), "theta4", theta1=6),
    "hundreds": of_4r(lambda: fl.grid(**GRID, **HUNDREDS), "theta4", theta1=6),
    "sobol": of_4r(lambda: fl.sobol(37, seed=3, **RANGES), "transmission_angle_min"),
    "hypercube": of_4r(lambda: fl.latin_hypercube(23, seed=3, **RANGES), "transmission_angle_min", branch=2),
    "table": of_4r(lambda: fl.table(TABLE), "theta4", theta1=4),
    "numbered table": of_4r(lambda: fl.table({"design": np.arange(11) * 3 + 7, **TABLE}), "theta4", theta1=4),
    "one design": of_4r(lambda: fl.grid(**GRID, a2=1.2, a3=0.8), "theta4_mean", theta1=4),
    "scalar branch": of_4r(
        lambda: fl.grid(**GRID, a2=COUPLERS, a3=0.8, omega1=2.0), "omega4_extrema", branch=1
    ),
    "tiny designs": of_4r(lambda: fl.sobol(19, seed=1, **TINY), "theta4", theta1=4),
    "scaling axis": of_4r(lambda: fl.grid(**GRID, **AXES), "omega4", theta1=4),
    "layout of maps": of_4r(
        lambda: fl.grid(**GRID, **AXES), "omega4", "omega4_extrema", theta1=4, layout="maps"
    ),
    "completions": of_focal(lambda: fl.grid(a=[5.0, 5.5, 6.0], **BARS)),
    "completions of a table": of_focal(lambda: fl.table(FOCAL)),
    "completions of a numbered table": of_focal(lambda: fl.table({"design": [7, 3, 9, 1, 4], **FOCAL})),
    "completions of a sample": of_focal(lambda: fl.sobol(7, seed=1, a=(5.0, 7.0), **BARS)),
}


def sweep(of, **options):
    """Return the result of a request, by its name or as it stands."""
    mechanism, space, quantities, given = REQUESTS[of] if isinstance(of, str) else of
    return sweep_both(mechanism, space(), quantities, **{"verify": 0, **given, **options})

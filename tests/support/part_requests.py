"""Requests of each kind of design space, for the tests of sweeps in parts."""

import numpy as np

import fastlink as fl
from tests.support.sweeps import sweep_both

COUPLERS, OUTPUTS, SPEEDS = np.linspace(1.0, 1.4, 7), np.linspace(0.6, 1.0, 5), np.array([0.5, 3.0, 7.0])
AXES = {"omega1": SPEEDS, "a2": COUPLERS, "a3": OUTPUTS}
TABLE = {"a1": np.linspace(0.3, 0.5, 11), "a2": np.linspace(1.0, 1.4, 11)}
TABLE |= {"part_no": [f"P{k}" for k in range(11)]}
FOCAL = {"a": [5.0, 5.5, 6.0, 6.5, 7.0], "name": list("vwxyz"), "b": 5.0, "c": 2.0, "d": 4.0, "rho": 1.0}
RANGES = {"a1": (0.3, 0.5), "a2": (1.0, 1.4), "a3": 0.8, "a4": 1.0}
GRID = {"a1": 0.4, "a4": 1.0}
ANGLE = ["transmission_angle_min"]

#: Mechanism, designs, quantities, options of each.
REQUESTS = {
    "grid": ("planar_4r", lambda: fl.grid(**GRID, a2=COUPLERS, a3=OUTPUTS), ["theta4"], {"theta1": 6}),
    "hundreds": (
        "planar_4r",
        lambda: fl.grid(**GRID, a2=np.linspace(1.0, 1.4, 25), a3=np.linspace(0.6, 1.0, 21)),
        ["theta4"],
        {"theta1": 6},
    ),
    "sobol": ("planar_4r", lambda: fl.sobol(37, seed=3, **RANGES), ANGLE, {}),
    "hypercube": ("planar_4r", lambda: fl.latin_hypercube(23, seed=3, **RANGES), ANGLE, {"branch": 2}),
    "table": ("planar_4r", lambda: fl.table({**TABLE, "a3": 0.8, "a4": 1.0}), ["theta4"], {"theta1": 4}),
    "numbered table": (
        "planar_4r",
        lambda: fl.table({"design": np.arange(11) * 3 + 7, **TABLE, "a3": 0.8, "a4": 1.0}),
        ["theta4"],
        {"theta1": 4},
    ),
    "one design": ("planar_4r", lambda: fl.grid(**GRID, a2=1.2, a3=0.8), ["theta4_mean"], {"theta1": 4}),
    "scalar branch": (
        "planar_4r",
        lambda: fl.grid(**GRID, a2=COUPLERS, a3=0.8, omega1=2.0),
        ["omega4_extrema"],
        {"branch": 1},
    ),
    "tiny designs": (
        "planar_4r",
        lambda: fl.sobol(19, seed=1, a1=(3e-7, 5.0), a2=(1e-7, 1.4), a3=0.8e-6, a4=1e-6),
        ["theta4"],
        {"theta1": 4},
    ),
    "scaling axis": ("planar_4r", lambda: fl.grid(**GRID, **AXES), ["omega4"], {"theta1": 4}),
    "layout of maps": (
        "planar_4r",
        lambda: fl.grid(**GRID, **AXES),
        ["omega4", "omega4_extrema"],
        {"theta1": 4, "layout": "maps"},
    ),
    "completions": (
        "focal",
        lambda: fl.grid(a=[5.0, 5.5, 6.0], b=5.0, c=2.0, d=4.0, rho=1.0),
        ["crank_type"],
        {},
    ),
    "completions of a table": ("focal", lambda: fl.table(FOCAL), ["crank_type"], {}),
    "completions of a numbered table": (
        "focal",
        lambda: fl.table({"design": [7, 3, 9, 1, 4], **FOCAL}),
        ["crank_type"],
        {},
    ),
    "completions of a sample": (
        "focal",
        lambda: fl.sobol(7, seed=1, a=(5.0, 7.0), b=5.0, c=2.0, d=4.0, rho=1.0),
        ["crank_type"],
        {},
    ),
}


def sweep(of, **options):
    """Return the result of a request, by its name or as it stands."""
    mechanism, space, quantities, given = REQUESTS[of] if isinstance(of, str) else of
    return sweep_both(mechanism, space(), quantities, **{"verify": 0, **given, **options})

"""Positions by pylinkage: a linkage object for each design, its compiled solver, one assembly mode."""

import importlib.util

import numpy as np

from benchmarks.inputs import outputs


def available():
    return importlib.util.find_spec("pylinkage") is not None


def bind(x, K):
    """Return ``call, arrays``: A_x, A_y, B_x, B_y of branch 2 at K angles over the turn, the first 0."""
    from pylinkage.actuators import Crank
    from pylinkage.components import Ground
    from pylinkage.dyads import RRRDyad
    from pylinkage.simulation import Linkage

    arrays = [array[:, 0] for array in outputs("positions", x.shape[1], K)]
    step = 2 * np.pi / K

    def call():
        for i, (a, b, c, d) in enumerate(x[:4].T.tolist()):
            O, D = Ground(0.0, 0.0), Ground(d, 0.0)
            crank = Crank(anchor=O, radius=a, angular_velocity=step, initial_angle=-step)
            rocker = RRRDyad(anchor1=crank.output, anchor2=D, distance1=b, distance2=c)
            found = Linkage([O, D, crank, rocker]).step_fast(K)
            for axis in range(2):
                arrays[axis][i], arrays[axis + 2][i] = found[:, 2, axis], found[:, 3, axis]

    return call, arrays

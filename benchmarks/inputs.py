"""What every kernel and baseline is given: designs, tables of the input angle, aligned arrays, a clock.

A design is a column of ``x``, whose rows are `INPUTS`; an angle is a column of ``tables``, whose rows are
`TABLES`.
"""

import time

import mpmath
import numpy as np

INPUTS = (
    *("a1", "a2", "a3", "a4", "omega1", "m1", "m2", "m3", "I1", "I2", "I3"),
    *("G1_u", "G1_v", "G2_u", "G2_v", "G3_u", "G3_v"),
)
TABLES = ("cos", "sin", "Z", "Z_low", "C", "C_low")

#: What each case puts out, in order. A curve has the shape (design, branch, angle), an extreme (design,
#: branch); the branches are 1 and 2.
CASES = {
    "positions": ("A_x", "A_y", "B_x", "B_y"),
    "rates": ("B_x", "B_y", "omega2", "omega4", "alpha2", "alpha4"),
    "reactions": ("F41_x", "F41_y", "F21_x", "F21_y", "F32_x", "F32_y", "F43_x", "F43_y", "T41"),
    "extremes": ("omega4_max", "omega4_min", "alpha4_max", "alpha4_min", "T41_max", "F32_x_max"),
}


def angle_tables(theta1):
    """Return the rows `TABLES` at the angles ``theta1``, or at so many equally spaced ones.

    Z and C are the squares of the half angle's sine and cosine, Z_low and C_low what these doubles leave out.
    """
    if np.ndim(theta1) == 0:
        theta1 = np.arange(theta1) * (2 * np.pi / theta1)
    rows = np.empty((len(TABLES), len(theta1)))
    with mpmath.workdps(50):
        for k, t in enumerate(map(mpmath.mpf, map(float, theta1))):
            Z, C = mpmath.sin(t / 2) ** 2, mpmath.cos(t / 2) ** 2
            rows[:, k] = mpmath.cos(t), mpmath.sin(t), Z, Z - float(Z), C, C - float(C)
    return aligned_copy(rows)


def round_bars(lengths, omega1=25.0, density=7750.0, radius=0.01):
    """Designs ``x`` from the rows a1 a2 a3 a4 of ``lengths``; links 1, 2, 3 are solid cylinders."""
    lengths = np.asarray(lengths, dtype=float)
    x = np.zeros((len(INPUTS), lengths.shape[1]))
    x[:4], x[4] = lengths, omega1
    x[5:8] = density * np.pi * radius**2 * lengths[:3]
    x[8:11] = x[5:8] * (lengths[:3] ** 2 / 12 + radius**2 / 4)
    x[11::2] = lengths[:3] / 2
    return aligned_copy(x)


def designs(n, seed=0):
    """Random round-bar linkages around Table 1 of Hayes et al., most of which rotate fully."""
    centre, spread = np.array([0.4, 1.2, 0.8, 1.0]), np.array([0.1, 0.2, 0.2, 0.1])
    uniform = np.random.default_rng(seed).uniform(-1, 1, (n, 4))
    return round_bars((centre + spread * uniform).T)


def empty(shape):
    """Return an uninitialised array that begins on a cache line: stores across two lines take longer."""
    size = int(np.prod(shape)) * 8
    raw = np.empty(size + 64, dtype=np.uint8)
    start = -raw.ctypes.data % 64
    return raw[start : start + size].view(np.float64).reshape(shape)


def aligned_copy(array):
    copy = empty(array.shape)
    copy[...] = array
    return copy


def outputs(case, n, K):
    """One array for each name of ``CASES[case]``."""
    return tuple(empty((n, 2) if case == "extremes" else (n, 2, K)) for _ in CASES[case])


def best_time(call, seconds=0.3, least=5):
    """Return the shortest run time of ``call()`` in s: what the code needs, whoever else uses the machine."""
    call()
    best, runs, end = np.inf, 0, time.perf_counter() + seconds
    while runs < least or time.perf_counter() < end:
        start = time.perf_counter()
        call()
        best, runs = min(best, time.perf_counter() - start), runs + 1
    return best


def race(calls, rounds=12, seconds=0.05):
    """Return the shortest run time in s of each named call, timed in turns so that all see the same machine."""
    best = dict.fromkeys(calls, np.inf)
    for _ in range(rounds):
        for name, call in calls.items():
            best[name] = min(best[name], best_time(call, seconds, least=1))
    return best

"""The planar 4R as a user writes it in numba: textbook formulas in loops, `@njit`, no thought of lanes.

Circles that intersect, loops of velocity and of acceleration by Cramer's rule, forces link by link.
"""

import math

import numba
import numpy as np

from benchmarks.cases import outputs

jit = numba.njit(error_model="numpy", cache=True)


@jit
def motion(x, i, cos, sin, s):
    """Return A, AB, DB, and the rates of links 2 and 3."""
    a, b, c, d, w = x[0, i], x[1, i], x[2, i], x[3, i], x[4, i]
    A_x, A_y = a * cos, a * sin
    x, y = d - A_x, -A_y
    square = x * x + y * y
    along = 0.5 * (square + b * b - c * c) / square
    across = s * math.sqrt(b * b / square - along * along)
    AB_x, AB_y = along * x - across * y, along * y + across * x
    DB_x, DB_y = AB_x - x, AB_y - y
    det = AB_x * DB_y - AB_y * DB_x
    omega2 = -w * (A_x * DB_y - A_y * DB_x) / det
    omega4 = -w * (A_x * AB_y - A_y * AB_x) / det
    u = w * w * A_x + omega2 * omega2 * AB_x - omega4 * omega4 * DB_x
    v = w * w * A_y + omega2 * omega2 * AB_y - omega4 * omega4 * DB_y
    alpha2, alpha4 = (DB_x * u + DB_y * v) / det, (AB_x * u + AB_y * v) / det
    return A_x, A_y, AB_x, AB_y, DB_x, DB_y, omega2, omega4, alpha2, alpha4


@jit
def positions(x, tables, A_x, A_y, B_x, B_y):
    for i in range(x.shape[1]):
        for j in range(2):
            for k in range(tables.shape[1]):
                m = motion(x, i, tables[0, k], tables[1, k], 2.0 * j - 1.0)
                A_x[i, j, k], A_y[i, j, k] = m[0], m[1]
                B_x[i, j, k], B_y[i, j, k] = m[0] + m[2], m[1] + m[3]


@jit
def rates(x, tables, B_x, B_y, omega2, omega4, alpha2, alpha4):
    for i in range(x.shape[1]):
        for j in range(2):
            for k in range(tables.shape[1]):
                m = motion(x, i, tables[0, k], tables[1, k], 2.0 * j - 1.0)
                B_x[i, j, k], B_y[i, j, k] = m[0] + m[2], m[1] + m[3]
                omega2[i, j, k], omega4[i, j, k], alpha2[i, j, k], alpha4[i, j, k] = m[6], m[7], m[8], m[9]


@jit
def forces(x, i, cos, sin, s):
    """Return omega4, alpha4 and the nine reactions of design i."""
    b, c, w = x[1, i], x[2, i], x[4, i]
    A_x, A_y, AB_x, AB_y, DB_x, DB_y, omega2, omega4, alpha2, alpha4 = motion(x, i, cos, sin, s)
    u, v = x[11, i], x[12, i]
    p1_x, p1_y = -x[5, i] * w * w * (u * cos - v * sin), -x[5, i] * w * w * (u * sin + v * cos)
    u, v = x[13, i] / b, x[14, i] / b
    g_x, g_y = u * AB_x - v * AB_y, u * AB_y + v * AB_x
    p2_x = x[6, i] * (-w * w * A_x - alpha2 * g_y - omega2 * omega2 * g_x)
    p2_y = x[6, i] * (-w * w * A_y + alpha2 * g_x - omega2 * omega2 * g_y)
    M2 = x[9, i] * alpha2 + g_x * p2_y - g_y * p2_x
    u, v = x[15, i] / c, x[16, i] / c
    g_x, g_y = u * DB_x - v * DB_y, u * DB_y + v * DB_x
    p3_x = x[7, i] * (-alpha4 * g_y - omega4 * omega4 * g_x)
    p3_y = x[7, i] * (alpha4 * g_x - omega4 * omega4 * g_y)
    M3 = x[10, i] * alpha4 + g_x * p3_y - g_y * p3_x
    det = AB_x * DB_y - AB_y * DB_x
    F32_x, F32_y = (M2 * DB_x + M3 * AB_x) / det, (M2 * DB_y + M3 * AB_y) / det
    F21_x, F21_y = F32_x - p2_x, F32_y - p2_y
    T41 = A_y * F21_x - A_x * F21_y
    F41_x, F41_y, F43_x, F43_y = p1_x - F21_x, p1_y - F21_y, F32_x + p3_x, F32_y + p3_y
    return omega4, alpha4, F41_x, F41_y, F21_x, F21_y, F32_x, F32_y, F43_x, F43_y, T41


@jit
def reactions(x, tables, F41_x, F41_y, F21_x, F21_y, F32_x, F32_y, F43_x, F43_y, T41):
    for i in range(x.shape[1]):
        for j in range(2):
            for k in range(tables.shape[1]):
                f = forces(x, i, tables[0, k], tables[1, k], 2.0 * j - 1.0)
                F41_x[i, j, k], F41_y[i, j, k], F21_x[i, j, k], F21_y[i, j, k] = f[2], f[3], f[4], f[5]
                F32_x[i, j, k], F32_y[i, j, k], F43_x[i, j, k], F43_y[i, j, k] = f[6], f[7], f[8], f[9]
                T41[i, j, k] = f[10]


@jit
def extremes(x, tables, omega4_max, omega4_min, alpha4_max, alpha4_min, T41_max, F32_x_max):
    for i in range(x.shape[1]):
        for j in range(2):
            w_max, w_min, a_max, a_min, T_max, F_max = -np.inf, np.inf, -np.inf, np.inf, -np.inf, -np.inf
            for k in range(tables.shape[1]):
                f = forces(x, i, tables[0, k], tables[1, k], 2.0 * j - 1.0)
                if f[0] == f[0]:  # it assembles
                    w_max, w_min = max(w_max, f[0]), min(w_min, f[0])
                    a_max, a_min = max(a_max, f[1]), min(a_min, f[1])
                    T_max, F_max = max(T_max, f[10]), max(F_max, f[6])
            omega4_max[i, j], omega4_min[i, j], alpha4_max[i, j] = w_max, w_min, a_max
            alpha4_min[i, j], T41_max[i, j], F32_x_max[i, j] = a_min, T_max, F_max


def bind(case, x, tables):
    """Return ``call, arrays``: ``call()`` evaluates into the arrays, one for each name of ``CASES[case]``."""
    arrays = outputs(case, x.shape[1], tables.shape[1])
    function = globals()[case]
    return lambda: function(x, tables, *arrays), arrays

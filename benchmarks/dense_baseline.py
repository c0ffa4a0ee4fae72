"""The reactions from the paper's stacked 9x9 systems by `numpy.linalg.solve`."""

import numpy as np

from benchmarks.inputs import CASES, INPUTS
from benchmarks.numpy_baseline import all_kinematics, constants, split


def system(x, tables):
    """Return the matrices (design, branch, angle, 9, 9) and right sides of eq. (9) of Hayes, Hninn, Irani.

    Unknowns: ``CASES["reactions"]`` in order, F_ij the force of link i on link j. Rows: forces along x and y
    and moment about the mass centre, of links 1, 2, 3. r_ij points from the mass centre of link i to joint j.
    """
    n, K = x.shape[1], tables.shape[1]
    i = {name: row[:, None, None] for name, row in zip(INPUTS, x, strict=True)}
    cos, sin = tables[:2]
    with np.errstate(invalid="ignore", divide="ignore"):
        A, AB, DB, odd, *parts, _ = all_kinematics(constants(x), tables)
        curves = []
        for even, f in (*zip(AB + DB, odd + odd, strict=True), *parts):
            curves.append(np.empty((n, 2, K)))
            split(even, f, curves[-1])
    AB_x, AB_y, DB_x, DB_y, omega2, omega4, alpha2, alpha4 = curves
    A_x, A_y = A[0][:, None], A[1][:, None]

    def turned(u, v, x, y):
        return u * x - v * y, u * y + v * x

    def acceleration(a0, g, omega, alpha):
        return a0[0] - alpha * g[1] - omega**2 * g[0], a0[1] + alpha * g[0] - omega**2 * g[1]

    omega1 = i["omega1"]
    centre = (
        turned(i["G1_u"], i["G1_v"], cos, sin),
        turned(i["G2_u"] / i["a2"], i["G2_v"] / i["a2"], AB_x, AB_y),
        turned(i["G3_u"] / i["a3"], i["G3_v"] / i["a3"], DB_x, DB_y),
    )
    a_A = -(omega1**2) * A_x, -(omega1**2) * A_y
    motion = (
        (i["m1"], acceleration((0, 0), centre[0], omega1, 0), 0),
        (i["m2"], acceleration(a_A, centre[1], omega2, alpha2), i["I2"] * alpha2),
        (i["m3"], acceleration((0, 0), centre[2], omega4, alpha4), i["I3"] * alpha4),
    )
    # Each link's two joints: the column of the force's x component, r_ij, the force's sign.
    near = [(-g[0], -g[1]) for g in centre]
    ends = (A_x, A_y), (AB_x, AB_y), (DB_x, DB_y)
    far = [(end[0] - g[0], end[1] - g[1]) for end, g in zip(ends, centre, strict=True)]
    forces = ((0, near[0], 1, 2, far[0], 1), (2, near[1], -1, 4, far[1], 1), (6, near[2], 1, 4, far[2], -1))
    matrix = np.zeros((n, 2, K, 9, 9))
    right = np.empty((n, 2, K, 9))
    for link, ((m, a, torque), row) in enumerate(zip(motion, forces, strict=True)):
        e = 3 * link
        for column, r, sign in (row[:3], row[3:]):
            matrix[..., e, column] = matrix[..., e + 1, column + 1] = sign
            matrix[..., e + 2, column] = -sign * r[1]
            matrix[..., e + 2, column + 1] = sign * r[0]
        right[..., e], right[..., e + 1], right[..., e + 2] = m * a[0], m * a[1], torque
    matrix[..., 2, 8] = 1
    open_loop = np.isnan(right[..., 8])  # LU of NaN raises: keep NaN to the right side
    matrix[open_loop], right[open_loop] = np.eye(9), np.nan
    return matrix, right


def reactions(x, tables, assembled=None):
    """One array for each reaction, by LU; pass `system`'s result to keep its own time off the clock."""
    matrix, right = system(x, tables) if assembled is None else assembled
    solution = np.linalg.solve(matrix, right[..., None])[..., 0]
    return tuple(solution[..., i] for i in range(len(CASES["reactions"])))

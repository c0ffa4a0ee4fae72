"""The closed forms in vectorised NumPy.

A good user's NumPy: whatever does not depend on the angle is taken once per design, what does not depend on
the branch once per angle, and pieces of a few designs are evaluated so that the intermediate arrays stay in
the cache. A quantity is even + s odd, with s = -1 for branch 1 and s = +1 for branch 2.
"""

import functools

import numpy as np

from benchmarks.inputs import INPUTS, outputs

#: Pairs (design, angle) evaluated at once: arrays of 184 KB stay in the second-level cache, and a call's
#: fixed cost is below a tenth.
PIECE = 23040

# An array of 16 MB, freed at once: from then on glibc serves smaller ones from the heap and keeps what they
# leave, where otherwise each array above 128 KB costs page faults (measured: up to 4 times the run time).
np.empty(2**21)


# ---- once per design; operators only, so that JAX arrays pass too ----


def two_sum(a, b):
    s = a + b
    t = s - a
    return s, (a - (s - t)) + (b - t)


def sum4(a, b, c, d):
    s, low_1 = two_sum(a, b)
    s, low_2 = two_sum(s, c)
    s, low_3 = two_sum(s, d)
    return two_sum(s, low_1 + low_2 + low_3)  # next to a change point s may have cancelled to less


def two_product(a, b):
    """Return a b and what the rounding left out (Dekker)."""
    p = a * b
    a_hi, b_hi = a * 134217729.0, b * 134217729.0
    a_hi, b_hi = a_hi - (a_hi - a), b_hi - (b_hi - b)
    a_lo, b_lo = a - a_hi, b - b_hi
    return p, ((a_hi * b_hi - p) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo


def sum_of_four(u, v, a, d):
    """Return u v / (4 a d) to twice the working precision, u and v being (high, low)."""
    p, p_low = two_product(u[0], v[0])
    p_low = p_low + (u[0] * v[1] + u[1] * v[0])
    g, g_low = two_product(4 * a, d)
    ratio = p / g
    back, back_low = two_product(ratio, g)
    return two_sum(ratio, ((p - back) - back_low + p_low - ratio * g_low) / g)


def constants(x):
    """Return what depends on the design alone, as columns (design, 1); masses only if x has their rows."""
    i = {name: row[:, None] for name, row in zip(INPUTS, x, strict=False)}
    a, b, c, d, w = i["a1"], i["a2"], i["a3"], i["a4"], i["omega1"]
    Z0, Z0_low = sum_of_four(sum4(a, -b, c, -d), sum4(a, b, -c, -d), a, d)
    o = {"a": a, "d": d, "w": w, "r": 1 / (4 * a * d), "Z0": -Z0, "Z0_low": -Z0_low}
    o["C0"], o["C0_low"] = sum_of_four(sum4(a, -b, -c, d), sum4(a, b, c, d), a, d)
    o["gamma0"] = (a - d) * (a - d) * o["r"]
    o["lambda"] = (a - d) / (2 * d)
    o["kappa"] = (b - c) * (b + c) * o["r"]
    o["eps"] = (a - d) * (a + d) * o["r"]
    o["beta"] = b * (b - c) * o["r"]
    o["delta"] = c * (c - b) * o["r"]
    if len(i) == len(INPUTS):
        o["f1_u"], o["f1_v"] = -w * w * i["m1"] * i["G1_u"], -w * w * i["m1"] * i["G1_v"]
        o["g2_u"], o["g2_v"] = i["G2_u"] / b, i["G2_v"] / b
        o["f3_u"], o["f3_v"] = i["m3"] * i["G3_u"] / c, i["m3"] * i["G3_v"] / c
        o["m2"], o["I2"] = i["m2"], i["I2"]
        o["J3"] = i["I3"] + i["m3"] * (i["G3_u"] * i["G3_u"] + i["G3_v"] * i["G3_v"])
    return o


# ---- once per design and angle ----


def dependencies(o, tables):
    _, _, Z, Z_low, C, C_low = tables
    p = Z - o["Z0"]
    p += Z_low - o["Z0_low"]
    q = C - o["C0"]
    q += C_low - o["C0_low"]
    sigma = p * q
    np.sqrt(sigma, out=sigma)
    r_gamma = o["gamma0"] + Z
    np.divide(1.0, r_gamma, out=r_gamma)
    return p, q, sigma, r_gamma


def positions(o, tables, p, sigma, r_gamma, rocker=True):
    """Return A, the even parts of AB and (if wanted) DB, and the odd part that they share, each as x, y."""
    cos, sin, Z = tables[:3]
    A_x, A_y = o["a"] * cos, o["a"] * sin
    u_x = (2 * o["a"]) * Z
    u_x += o["d"] - o["a"]
    AB = 0.5 * p
    AB += o["beta"]
    AB *= r_gamma
    AB_even = AB * u_x, np.negative(np.multiply(AB, A_y, out=AB), out=AB)
    DB_even = None
    if rocker:
        DB = -0.5 * p
        DB -= o["delta"]
        DB *= r_gamma
        DB_even = DB * u_x, np.negative(np.multiply(DB, A_y, out=DB), out=DB)
    height = sigma * r_gamma
    height *= 0.5
    odd_x = height * A_y
    height *= u_x
    return (A_x, A_y), AB_even, DB_even, (odd_x, height)


def rates(o, tables, p, q, sigma, r_gamma):
    """Return (even, odd) of omega2, omega4, alpha2, alpha4, and 1/sigma."""
    sin, Z, C = tables[1], tables[2], tables[4]
    w, h = o["w"], 0.5 * sin
    r_sigma = 1 / sigma
    H = h * r_sigma
    dH = (0.25 * w * w * o["C0"]) * Z
    dH *= p
    other = (0.25 * w * w * o["Z0"]) * C
    other *= q
    dH -= other
    for _ in range(3):
        dH *= r_sigma
    k = o["kappa"] * r_gamma
    plus, minus = 1 + k, np.subtract(k, 1)
    T = o["lambda"] + Z
    T *= r_gamma
    T *= 0.5 * w
    j = (0.5 * w * w) * h
    j = j * r_gamma
    E = -o["eps"] * j
    E *= r_gamma
    k *= H
    k *= j
    H *= 0.5 * w
    alpha2, alpha4 = dH * minus, np.multiply(dH, plus, out=dH)
    alpha2 -= k
    alpha4 -= k
    minus *= H
    plus *= H
    return (T, minus), (T, plus), (E, alpha2), (E, alpha4), r_sigma


def split(even, odd, out):
    """Put both branches into ``out`` (design, branch, angle)."""
    np.subtract(even, odd, out=out[:, 0])
    np.add(even, odd, out=out[:, 1])


def reactions(o, tables, kinematics, s, out):
    """Put the nine reactions of the branch with sign ``s`` into the arrays ``out``, each (design, angle)."""
    cos, sin = tables[:2]
    (A_x, A_y), AB_even, DB_even, odd, omega2, omega4, alpha2, alpha4, r_sigma = kinematics
    F41_x, F41_y, F21_x, F21_y, F32_x, F32_y, F43_x, F43_y, T41 = out
    join = np.add if s > 0 else np.subtract
    AB_x, AB_y, DB_x, DB_y = (join(e, f) for e, f in zip(AB_even + DB_even, odd + odd, strict=True))
    omega2, omega4, alpha2, alpha4 = (join(*pair) for pair in (omega2, omega4, alpha2, alpha4))
    omega2 *= omega2
    omega4 *= omega4
    g_x, g_y = o["g2_u"] * AB_x, o["g2_v"] * AB_x
    g_x -= o["g2_v"] * AB_y
    g_y += o["g2_u"] * AB_y
    ww = o["w"] * o["w"]
    f2_x, f2_y = ww * A_x, -ww * A_y
    f2_x += alpha2 * g_y
    f2_x += omega2 * g_x
    f2_x *= -o["m2"]
    f2_y += alpha2 * g_x
    f2_y -= omega2 * g_y
    f2_y *= o["m2"]
    g_x *= f2_y
    g_y *= f2_x
    g_x -= g_y
    M2 = np.multiply(o["I2"], alpha2, out=alpha2)
    M2 += g_x
    scaled = (2 * s * o["r"]) * r_sigma
    M2 *= scaled
    scaled *= o["J3"]
    scaled *= alpha4
    np.multiply(M2, DB_x, out=F32_x)
    AB_x *= scaled
    F32_x += AB_x
    np.multiply(M2, DB_y, out=F32_y)
    AB_y *= scaled
    F32_y += AB_y
    np.subtract(F32_x, f2_x, out=F21_x)
    np.subtract(F32_y, f2_y, out=F21_y)
    np.subtract(o["f1_u"] * cos - o["f1_v"] * sin, F21_x, out=F41_x)
    np.subtract(o["f1_u"] * sin + o["f1_v"] * cos, F21_y, out=F41_y)
    g_x, g_y = o["f3_u"] * DB_x, o["f3_v"] * DB_x
    g_x -= o["f3_v"] * DB_y
    g_y += o["f3_u"] * DB_y
    np.subtract(F32_x, alpha4 * g_y, out=F43_x)
    alpha4 *= g_x
    np.add(F32_y, alpha4, out=F43_y)
    g_x *= omega4
    g_y *= omega4
    F43_x -= g_x
    F43_y -= g_y
    np.multiply(A_y, F21_x, out=T41)
    np.multiply(A_x, F21_y, out=g_x)
    T41 -= g_x


# ---- the cases ----


def all_kinematics(o, tables, rocker=True):
    p, q, sigma, r_gamma = dependencies(o, tables)
    A, AB, DB, odd = positions(o, tables, p, sigma, r_gamma, rocker)
    return (A, AB, DB, odd, *rates(o, tables, p, q, sigma, r_gamma))


def put_B(A, AB, odd, out):
    for axis in range(2):
        split(A[axis] + AB[axis], odd[axis], out[axis])


def piece_positions(o, tables, out):
    p, _, sigma, r_gamma = dependencies(o, tables)
    A, AB, _, odd = positions(o, tables, p, sigma, r_gamma, rocker=False)
    for axis in range(2):
        out[axis][...] = A[axis][:, None]
    put_B(A, AB, odd, out[2:])


def piece_rates(o, tables, out):
    A, AB, _, odd, *parts, _ = all_kinematics(o, tables, rocker=False)
    put_B(A, AB, odd, out[:2])
    for part, curve in zip(parts, out[2:], strict=True):
        split(*part, curve)


def piece_reactions(o, tables, out):
    kinematics = all_kinematics(o, tables)
    for branch, s in enumerate((-1, 1)):
        reactions(o, tables, kinematics, s, [curve[:, branch] for curve in out])


@functools.cache
def scratch(n, K):
    return outputs("reactions", n, K)


def piece_extremes(o, tables, out):
    kinematics = all_kinematics(o, tables)
    *spare, T41 = curves = scratch(*kinematics[0][0].shape)
    for branch, s in enumerate((-1, 1)):
        reactions(o, tables, kinematics, s, [curve[:, branch] for curve in curves])
    np.fmax.reduce(T41, axis=-1, out=out[4])  # fmax passes over NaN
    np.fmax.reduce(spare[4], axis=-1, out=out[5])
    for part, greatest, least in ((kinematics[5], out[0], out[1]), (kinematics[7], out[2], out[3])):
        split(*part, spare[0])
        np.fmax.reduce(spare[0], axis=-1, out=greatest)
        np.fmin.reduce(spare[0], axis=-1, out=least)


PIECES = {
    "positions": piece_positions,
    "rates": piece_rates,
    "reactions": piece_reactions,
    "extremes": piece_extremes,
}


def evaluate(case, x, tables, out=None):
    """One array for each name of ``CASES[case]``; ``out`` reuses those of an earlier call."""
    out = outputs(case, x.shape[1], tables.shape[1]) if out is None else out
    o = constants(x)
    piece = max(1, PIECE // tables.shape[1])
    with np.errstate(invalid="ignore", divide="ignore"):
        for first in range(0, x.shape[1], piece):
            part = slice(first, first + piece)
            own = {name: column[part] for name, column in o.items()}
            PIECES[case](own, tables, [array[part] for array in out])
    return out

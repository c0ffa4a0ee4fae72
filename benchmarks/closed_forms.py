"""The closed forms of the planar 4R for peers that read expressions: JAX's arrays, heyoka.py's symbols.

Operators and a square root that is handed in, nothing else. What depends on the design alone is given by name, as
`numpy_baseline.constants` or `plain_constants` has it. A quantity is even + s odd, with s = -1 for branch 1, +1 for 2.
"""


def plain_constants(i):
    """Return what depends on the design alone, from its inputs by name, to working precision.

    Expressions that are simplified cannot carry what rounding left out, as `numpy_baseline.constants` does.
    """
    a, b, c, d, w = (i[name] for name in ("a1", "a2", "a3", "a4", "omega1"))
    r = 1.0 / (4.0 * (a * d))
    o = {"a": a, "d": d, "w": w, "r": r, "Z0_low": 0.0, "C0_low": 0.0}
    o["Z0"] = ((b + d) - (a + c)) * ((a + b) - (c + d)) * r
    o["C0"] = ((a + d) - (b + c)) * ((a + d) + (b + c)) * r
    o["gamma0"] = (a - d) * (a - d) * r
    o["lambda"] = 0.5 * (a - d) / d
    o["kappa"] = (b - c) * (b + c) * r
    o["eps"] = (a - d) * (a + d) * r
    o["beta"] = b * (b - c) * r
    o["delta"] = c * (c - b) * r
    if "m1" in i:
        o["f1_u"], o["f1_v"] = -(w * w) * i["m1"] * i["G1_u"], -(w * w) * i["m1"] * i["G1_v"]
        o["g2_u"], o["g2_v"] = i["G2_u"] / b, i["G2_v"] / b
        o["f3_u"], o["f3_v"] = i["m3"] * i["G3_u"] / c, i["m3"] * i["G3_v"] / c
        o["m2"], o["I2"] = i["m2"], i["I2"]
        o["J3"] = i["I3"] + i["m3"] * (i["G3_u"] * i["G3_u"] + i["G3_v"] * i["G3_v"])
    return o


def kinematics(o, tables, sqrt):
    """Return A, the even parts of AB and DB, the odd part that they share, (even, odd) of the rates, and 1/sigma."""
    cos, sin, Z, Z_low, C, C_low = tables
    p = (Z - o["Z0"]) + (Z_low - o["Z0_low"])
    q = (C - o["C0"]) + (C_low - o["C0_low"])
    sigma = sqrt(p * q)
    r_sigma, r_gamma = 1.0 / sigma, 1.0 / (o["gamma0"] + Z)
    A = o["a"] * cos, o["a"] * sin
    u_x = (o["d"] - o["a"]) + 2.0 * o["a"] * Z
    AB, DB = (0.5 * p + o["beta"]) * r_gamma, -(0.5 * p + o["delta"]) * r_gamma
    height = 0.5 * sigma * r_gamma
    odd = height * A[1], height * u_x
    w, h = o["w"], 0.5 * sin
    H, k = h * r_sigma, o["kappa"] * r_gamma
    dH = 0.5 * (o["C0"] * Z * p - o["Z0"] * C * q) * (r_sigma * r_sigma * r_sigma)
    T, j = 0.5 * w * ((o["lambda"] + Z) * r_gamma), h * r_gamma
    E, L = -(0.5 * w * w) * (o["eps"] * j * r_gamma), H * k * j
    parts = (
        (T, 0.5 * w * (H * (k - 1.0))),
        (T, 0.5 * w * (H * (k + 1.0))),
        (E, 0.5 * w * w * (dH * (k - 1.0) - L)),
        (E, 0.5 * w * w * (dH * (k + 1.0) - L)),
    )
    return A, (AB * u_x, -AB * A[1]), (DB * u_x, -DB * A[1]), odd, parts, r_sigma


def both(even, odd):
    return even - odd, even + odd


def positions(o, tables, sqrt):
    """Return for each name of ``CASES["positions"]`` a pair, its two branches."""
    A, AB, _, odd, _, _ = kinematics(o, tables, sqrt)
    return (*((axis, axis) for axis in A), *(both(A[i] + AB[i], odd[i]) for i in range(2)))


def rates(o, tables, sqrt):
    """Return for each name of ``CASES["rates"]`` a pair, its two branches."""
    A, AB, _, odd, parts, _ = kinematics(o, tables, sqrt)
    return (*(both(A[i] + AB[i], odd[i]) for i in range(2)), *(both(*part) for part in parts))


def _reactions(o, tables, parts, s):
    cos, sin = tables[:2]
    A, AB, DB, odd, rate, r_sigma = parts
    AB, DB = ([even[i] + s * odd[i] for i in range(2)] for even in (AB, DB))
    omega2, omega4, alpha2, alpha4 = (even + s * f for even, f in rate)
    g2 = o["g2_u"] * AB[0] - o["g2_v"] * AB[1], o["g2_u"] * AB[1] + o["g2_v"] * AB[0]
    g3 = o["f3_u"] * DB[0] - o["f3_v"] * DB[1], o["f3_u"] * DB[1] + o["f3_v"] * DB[0]
    ww, w2, w4 = o["w"] * o["w"], omega2 * omega2, omega4 * omega4
    f2_x = o["m2"] * (-ww * A[0] - alpha2 * g2[1] - w2 * g2[0])
    f2_y = o["m2"] * (-ww * A[1] + alpha2 * g2[0] - w2 * g2[1])
    scale = 2.0 * s * o["r"] * r_sigma
    M2 = (o["I2"] * alpha2 + (g2[0] * f2_y - g2[1] * f2_x)) * scale
    M3 = o["J3"] * scale * alpha4
    F32_x, F32_y = M2 * DB[0] + M3 * AB[0], M2 * DB[1] + M3 * AB[1]
    F21_x, F21_y = F32_x - f2_x, F32_y - f2_y
    F41_x = o["f1_u"] * cos - o["f1_v"] * sin - F21_x
    F41_y = o["f1_u"] * sin + o["f1_v"] * cos - F21_y
    F43_x = F32_x - (alpha4 * g3[1] + w4 * g3[0])
    F43_y = F32_y + (alpha4 * g3[0] - w4 * g3[1])
    T41 = A[1] * F21_x - A[0] * F21_y
    return F41_x, F41_y, F21_x, F21_y, F32_x, F32_y, F43_x, F43_y, T41


def reactions(o, tables, sqrt):
    """Return for each name of ``CASES["reactions"]`` a pair, its two branches."""
    parts = kinematics(o, tables, sqrt)
    return tuple(zip(*(_reactions(o, tables, parts, s) for s in (-1.0, 1.0)), strict=True))


FORMS = {"positions": positions, "rates": rates, "reactions": reactions}

"""psi of the Minkowskian 4R near all that is hard: error against 50 digits and time, of the null form and of eq. (3).

``python -m benchmarks.minkowski`` prints the table of docs/minkowski.md.
"""

import math
from functools import partial

import mpmath
import numba
import numpy as np

from benchmarks.cases import bind, markdown, race, space_of
from fastlink.engine.evaluate import evaluate
from fastlink.mechanisms import catalogue
from fastlink.precision.reference import HighPrecision, error_in_roundings

LENGTHS = ("a", "b", "g", "h")
MINKOWSKIAN = catalogue("minkowski_4r")


def designs(n, seed=0):
    """Return random lengths (4, n), of all types."""
    return np.exp(np.random.default_rng(seed).uniform(-1.5, 1.5, (4, n)))


def bind_psi(x, theta):
    """Return a call of the kernel of psi and its orientation, and its arrays."""
    names = "psi", "CB_orientation"
    return bind(names, space_of(x, LENGTHS), mechanism="minkowski_4r", angles=theta)


def eq3_roots(a, b, g, h, cosh, sinh):
    """Return both y of eq. (3) as printed, infinite or NaN where doubles have none."""
    A = 2 * g * b - 2 * a * b * cosh
    B = 2 * a * b * sinh
    C = h * h - g * g - b * b - a * a + 2 * a * g * cosh
    root = np.sqrt(B * B + C * C - A * A)
    return (root - B) / (A + C), (-root - B) / (A + C)


def eq3(x, theta):
    """Return psi and orientation, each (design, branch, theta), by eq. (3); CB is past-pointing if |y| > 1."""
    with np.errstate(all="ignore"):
        y = np.stack(eq3_roots(*x[:, :, None], np.cosh(theta), np.sinh(theta)), axis=1)
        ahead = np.abs(y) < 1
        return 2 * np.arctanh(np.where(ahead, y, 1 / y)), np.where(ahead, 1.0, np.where(np.isnan(y), y, -1.0))


roots_of_one = numba.njit(error_model="numpy")(eq3_roots)


@numba.njit(error_model="numpy")
def compiled_eq3(x, cosh, sinh, psi, orientation):
    """Eq. (3) as a loop, as one writes it: the mathematical library's artanh."""
    for i in range(x.shape[1]):
        for k in range(cosh.size):
            roots = roots_of_one(x[0, i], x[1, i], x[2, i], x[3, i], cosh[k], sinh[k])
            for branch in range(2):
                y = roots[branch]
                ahead = abs(y) < 1
                psi[i, branch, k] = 2 * math.atanh(y if ahead else 1 / y)
                orientation[i, branch, k] = 0 if y != y else 1 if ahead else -1


def families(n, seed=0):
    """Return, by name, lengths (4, n) and an input each, none of them exactly on what it is near."""
    rng = np.random.default_rng(seed)
    sides = rng.choice([-1.0, 1.0], n)
    near = sides * np.exp(rng.uniform(np.log(1e-12), np.log(1e-3), n))
    x = designs(n, seed)
    a, b, g, h = x

    def at(cosh):
        return sides * np.arccosh(np.maximum(cosh, 1.0)) * (1 + np.abs(near))

    equal, long, light = x.copy(), x.copy(), x.copy()
    equal[1] = h * (1 + near)
    long[2] = (a + b + h) * (1 + np.abs(near) * 1e3)  # has a theta_min
    light[3] = h * np.abs(near)  # AB is short, its null coordinates are not
    long_min = np.arccosh((a * a + long[2] ** 2 - (b + h) ** 2) / (2 * a * long[2]))

    def sum_of_four(of, rest):
        """Lengths of which number `of` nearly is the sum of the others, with the given signs."""
        found = x.copy()
        found[of] = np.abs(np.array(rest) @ np.delete(x, of, axis=0)) * (1 + near)
        return found

    anywhere = rng.uniform(-4, 4, n)
    return {
        "any: ratios of lengths up to 20, theta in -4 ... 4": (x, rng.uniform(-4, 4, n)),
        "theta near ±ln(g/a)": (x, sides * np.abs(np.log(g / a)) * (1 + near)),
        "theta near theta_max": (x, at((a * a + g * g - (b - h) ** 2) / (2 * a * g))),
        "theta near theta_min": (long, sides * long_min * (1 - np.abs(near))),
        "AB near lightlike (h from 1e-12 to 1e-3 of the others)": (light, rng.uniform(-4, 4, n)),
        "T1 near 0, theta near 0": (sum_of_four(3, (-1, 1, 1)), near),
        "T2 near 0, theta near 0": (sum_of_four(3, (1, 1, -1)), near),
        "T3 near 0, theta near 0": (sum_of_four(2, (1, 1, 1)), near),
        "T4 near 0, theta near 0": (sum_of_four(0, (1, 1, 1)), near),
        "T5 near 0": (sum_of_four(3, (1, 1, 1)), anywhere),
        "b near a + g + h": (sum_of_four(1, (1, 1, 1)), anywhere),
        "b near h": (equal, rng.uniform(-4, 4, n)),
        "theta from 10 to 300": (x, sides * rng.uniform(10, 300, n)),
        "theta from 400 to 700": (x, sides * rng.uniform(400, 700, n)),
        "theta from 710 to 1e5, where cosh overflows": (
            x,
            sides * np.exp(rng.uniform(np.log(710), np.log(1e5), n)),
        ),
    }


def worst(psi, x, theta):
    """Return the largest error of psi (n, 2) in roundings times the condition; infinite if one is missing."""
    found, facts = 0.0, HighPrecision(MINKOWSKIAN, ["psi"], (*LENGTHS, "theta", "branch"))
    for (i, k), value in np.ndenumerate(psi):
        given = dict(zip(LENGTHS, x[:, i], strict=True)) | {"theta": theta[i]}
        exact = facts.at(given | {"branch": k + 1})
        if mpmath.isnan(exact["psi"]):
            continue
        if not np.isfinite(value):
            return np.inf
        found = max(found, error_in_roundings(value, exact["psi"], facts.condition(exact, given)["psi"]))
    return found


def ours(x, theta):
    """Return psi (n, 2) of one input per design by fastlink."""
    inputs = {name: row[:, None] for name, row in zip(LENGTHS, x, strict=True)}
    return evaluate("minkowski_4r", ["psi"], branch=np.array([1, 2]), theta=theta[:, None], **inputs)["psi"]


def errors(n=100):
    """Yield each family, the error of fastlink there and that of eq. (3)."""
    for name, (x, theta) in families(n).items():
        yield name, worst(ours(x, theta), x, theta), worst(eq3(x, theta[:, None])[0][..., 0], x, theta)


def times_of(x, theta, rounds):
    """Return ns for each configuration of designs, four times over, by inputs: ours, eq. (3) in NumPy, compiled."""
    x, theta = np.tile(x, 4), np.unique(theta)
    kernel, arrays = bind_psi(x, theta)
    with np.errstate(over="ignore"):
        cosh, sinh = np.cosh(theta), np.sinh(theta)
    calls = {
        "ours": kernel,
        "NumPy": partial(eq3, x, theta),
        "compiled": partial(compiled_eq3, x, cosh, sinh, *arrays),
    }
    return [1e9 * seconds / arrays[0].size for seconds in race(calls, rounds, 0.02).values()]


def error_table(n=100, rounds=5):
    """Return the table of docs/minkowski.md."""
    heads = ["inputs", "fastlink: error", "eq. (3): error"]
    heads += ["fastlink: ns", "eq. (3) in NumPy: ns", "eq. (3) compiled: ns"]
    rows = []
    for (name, own, by_eq3), (x, theta) in zip(errors(n), families(n).values(), strict=True):
        times = (f"{time:.2g}" for time in times_of(x, theta, rounds))
        rows.append([name, f"{own:.1f}", f"{by_eq3:.2g}" if np.isfinite(by_eq3) else "no value", *times])
    return markdown(heads, *rows)


if __name__ == "__main__":
    print(error_table())

"""Dimensional synthesis: published cases with the least that was found, random linkages found again, functions; times.

``python -m benchmarks.synthesis`` prints the tables of docs/synthesis.md and, with ``--random N``, how many of N random
crank-rockers come back from twelve points each; with ``--curves N``, how near N curves that no four-bar draws are met,
beside an atlas of elliptic Fourier descriptors with differential evolution and, from the folder of an installation
(``--pylinkage``), pylinkage's swarm. Everything is compiled before it is timed.
"""

import argparse
import sys
import time

import numpy as np
from matplotlib.textpath import TextPath
from scipy.optimize import differential_evolution

import fastlink as fl
from benchmarks.cases import markdown
from fastlink.synthesis.poses import dyads_of_five

ARC = [(3, 3), (2.759, 3.363), (2.372, 3.663), (1.890, 3.862), (1.355, 3.943)]
KUNJUR = [(0.5, 1.1), (0.4, 1.1), (0.3, 1.1), (0.2, 1.0), (0.1, 0.9), (0.05, 0.75), (0.02, 0.6), (0, 0.5), (0, 0.4),
          (0.03, 0.3), (0.1, 0.25), (0.15, 0.2), (0.2, 0.3), (0.3, 0.4), (0.4, 0.5), (0.5, 0.7), (0.6, 0.9),
          (0.6, 1.0)]  # fmt: skip
ELLIPSE = [(20, 10), (17.66, 15.142), (11.736, 17.878), (5, 16.928), (0.60307, 12.736), (0.60307, 7.2638), (5, 3.0718),
           (11.736, 2.1215), (17.66, 4.8577), (20, 10)]  # fmt: skip
GAIT = np.stack([
    (0.7429, 0.6551, 0.6014, 0.5189, 0.4159, 0.3001, 0.1964, 0.1639, 0.1605, 0.1934, 0.2619, 0.4201, 0.6474, 0.7429),
    (0.1880, 0.1573, 0.1388, 0.1149, 0.1012, 0.1074, 0.1375, 0.1662, 0.2003, 0.2256, 0.2251, 0.1808, 0.1607, 0.1880),
], axis=1)  # fmt: skip


def box(lengths, others):
    names = ("P_u", "P_v", "O_x", "O_y")
    return {f"a{k}": lengths for k in (1, 2, 3, 4)} | dict.fromkeys(names, others)


#: The task, and what was published: Cabrera 2002 and Mejia; of the 10^-6 and others as remembered in the study.
CASES = {
    "line6": ({"path": [(20, y) for y in range(20, 46, 5)], "bounds": box((5, 60), (-60, 60)),
               "where": {"status": "rotates_fully"}}, "1e-20"),
    "arc5": ({"path": ARC, "timing": np.radians([30, 45, 60, 75, 90]),
              "fixed": {"O_x": 0, "O_y": 0, "ground_angle": 0, "phase": 0}}, "1e-6"),
    "kunjur18": ({"path": KUNJUR, "timing": np.radians(20 * np.arange(18)), "closed": True,
                  "bounds": box((0, 50), (-50, 50))}, "0.0109"),
    "ellipse10": ({"path": ELLIPSE, "bounds": box((5, 80), (-80, 80))}, "0.0047"),
    "gait14": ({"path": GAIT, "bounds": box((0, 1), (0, 1)) | {"ground_angle": (0, np.pi)}}, "-"),
}  # fmt: skip
ANGLE = {"least_transmission_angle_used_deg": (30, None)}
#: Functions over a range with both turns, and the greatest error of the best that was found by other programs.
FUNCTIONS = {
    "log10 x": (np.log10, (1, 2), (60, 90), {}, 0.012043),
    "log10 x, angle >= 30": (
        np.log10,
        (1, 2),
        (60, 90),
        {"least_transmission_angle_used_deg": (30, None)},
        0.047782,
    ),
    "x^2": (np.square, (0, 1), (90, 90), {}, 0.067130),
    "sin x": (np.sin, (0, np.pi / 2), (90, 90), {}, 0.190586),
    "e^x": (np.exp, (0, 1), (90, 90), {}, 0.007981),
    "e^x, angle >= 30": (
        np.exp,
        (0, 1),
        (90, 90),
        {"least_transmission_angle_used_deg": (30, None)},
        0.025935,
    ),
    "1/x": (lambda x: 1 / x, (1, 2), (90, 90), {}, 0.008426),
}


def timed(function, clock=time.perf_counter):
    start = clock()
    return function(), clock() - start


def paths(seeds):
    """Return a row for each published path: the worst and the best of some seeds, and the median time."""
    rows = []
    for name, (task, published) in CASES.items():
        fl.synthesise("planar_4r", seed=seeds, top=1, **task)
        asks = [task | {"seed": seed, "top": 1} for seed in range(seeds)]
        made = [timed(lambda ask=ask: fl.synthesise("planar_4r", **ask)) for ask in asks]
        least = [float(found.path_error_sum[0]) for found, _ in made]
        active = str(made[0][0].active.values[0]) if "active" in made[0][0].coords else ""
        seconds = f"{np.median([one for _, one in made]):.2f}"
        rows.append((name, published, f"{min(least):.8g}", f"{max(least):.8g}", seconds, active))
    return rows


def functions():
    rows = []
    for name, (function, over, turns, where, known) in FUNCTIONS.items():
        ask = {"function": function, "over": over, "turn_deg": turns, "where": where, "top": 1}
        found, seconds = timed(lambda ask=ask: fl.synthesise("planar_4r", **ask))
        error, angle = np.degrees([found.structural_error[0], found.least_transmission_angle_used[0]])
        rows.append((name, str(known), f"{error:.6f}", f"{angle:.1f}", f"{seconds:.2f}"))
    return rows


def sliders():
    """Return a row for functions of a slider-crank with a travel of 1: the greatest error of the best, and seconds."""
    rows = []
    for name, (function, over, turns, where, _) in FUNCTIONS.items():
        ask = {
            "function": function,
            "over": over,
            "turn_deg": turns[0],
            "travel": 1.0,
            "where": where,
            "top": 1,
        }
        found, seconds = timed(lambda ask=ask: fl.synthesise("slider_crank", **ask))
        error, angle = (
            float(found.structural_error[0]),
            np.degrees(float(found.least_transmission_angle_used[0])),
        )
        lengths = ", ".join(f"{float(found[name][0]):.4g}" for name in ("r", "l", "e"))
        rows.append((name, f"{error:.3g}", lengths, f"{angle:.1f}", f"{seconds:.2f}"))
    return rows


def families(seeds):
    """Return a row for each family that is searched: the worst and the best of some seeds, and the median time."""
    bars = {f"a{k}": (5, 60) for k in (1, 2, 3, 4)}
    line = {
        "path": CASES["line6"][0]["path"],
        "bounds": bars,
        "where": {"status": "rotates_fully", "path_error": (None, 1e-9)},
    }
    poses = [(0.9436, 1.3381, 0.8045), (0.9691, 1.5942, 0.5487), (0.5485, 1.6845, 0.3744)]
    three = {"motion": poses, "where": {"status": "rotates_fully"}}
    tasks = {
        "line6": ("planar_4r", line),
        "three poses": ("planar_4r", three),
        "three poses, slider": ("slider_crank", three),
    }
    rows = []
    for name, (mechanism, task) in tasks.items():
        ask = task | {"maximise": "least_transmission_angle", "top": 1}
        made = [timed(lambda m=mechanism, a=ask, k=k: fl.synthesise(m, seed=k, **a)) for k in range(seeds)]
        angles = [np.degrees(float(found.least_transmission_angle[0])) for found, _ in made]
        seconds = f"{np.median([one for _, one in made]):.2f}"
        rows.append((name, f"{min(angles):.2f}", f"{np.median(angles):.2f}", f"{max(angles):.2f}", seconds))
    return rows


def dyads(tasks=100_000):
    """Return how many five-pose tasks a second are solved, and the greatest distance from circles by their size."""
    places, angles = np.random.default_rng(0).uniform(-1, 1, (2, tasks, 5, 2))
    points, angles = places @ [1, 1j], np.pi * angles[..., 0]
    (centres, pins), seconds = timed(lambda: dyads_of_five(points, angles))
    radius = np.abs(points[:, None] + np.exp(1j * angles)[:, None] * pins[..., None] - centres[..., None])
    off = np.nanmax(np.ptp(radius, axis=-1) / np.maximum(1.0, radius.max(axis=-1)))
    return tasks / seconds, off, np.bincount(np.isfinite(centres).sum(axis=1)).tolist()


def random_path(rng, closed):
    lengths = np.array([9.0, 1.0, 1.0, 9.0])
    while lengths[0] + lengths[3] >= 0.98 * (lengths[1] + lengths[2]):
        lengths = np.sort(rng.uniform(0.1, 1.0, 4))
    numbers = [lengths[0], *rng.permutation(lengths[1:]), *rng.uniform(-1, 1, 2)]
    design = dict(zip(("a1", "a2", "a3", "a4", "P_u", "P_v"), numbers, strict=True))
    span = 2 * np.pi if closed else rng.uniform(0.5, 5.0)
    theta = rng.uniform(0, 2 * np.pi) + np.sort(rng.uniform(0, span, 12))
    at = fl.evaluate("planar_4r", ["P_x", "P_y"], branch=int(rng.integers(1, 3)), theta1=theta, **design)
    points = np.stack([at["P_x"], at["P_y"]], axis=1)
    return points, float(np.sqrt(((points - points.mean(axis=0)) ** 2).sum(axis=1).mean()))


def random_linkages(count):
    rows = []
    for closed in (True, False):
        made = []
        for seed in range(count):
            points, size = random_path(np.random.default_rng(seed), closed)
            ask = {"path": points, "closed": closed, "top": 1}
            found, seconds = timed(lambda ask=ask: fl.synthesise("planar_4r", **ask))
            made.append((found.sizes["design"] > 0 and float(found.path_error[0]) < 1e-10 * size, seconds))
        good, seconds = np.array(made).T
        soon = f"{np.sum(good * (seconds < 2)):.0f}"
        rows.append(("closed" if closed else "open", f"{good.sum():.0f}", soon, f"{np.median(seconds):.2f}"))
    return rows


#: Curves that no four-bar draws: letters and digits, polygons, ellipses and the like, airfoils; places, and harmonics.
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefhkmnorstuvwxyz0123456789"
PLACES, HARMONICS = 200, 20


def uniform(z, count=PLACES):
    z = np.append(z, z[0])
    behind = np.append(0.0, np.cumsum(np.abs(np.diff(z))))
    return np.interp(behind[-1] * np.arange(count) / count, behind, z)


def target(k):
    rng, turn = np.random.default_rng(k), 2 * np.pi * np.arange(400) / 400
    if k % 4 == 0:
        parts = TextPath((0, 0), LETTERS[k // 4 % len(LETTERS)], size=1).to_polygons()
        z = max((part @ [1, 1j] for part in parts), key=lambda z: np.abs(np.diff(z)).sum())
    elif k % 4 == 1:
        sides = rng.integers(3, 9)
        z = np.exp(2j * np.pi * (np.arange(sides) + rng.uniform(-0.3, 0.3, sides)) / sides) * rng.uniform(
            0.6, 1, sides
        )
    elif k % 4 == 2:
        power, x, y = 2 / rng.choice([1, 2, 2, 3, 6]), np.cos(turn), np.sin(turn)
        z = np.sign(x) * abs(x) ** power + 1j * rng.uniform(0.15, 0.9) * np.sign(y) * abs(y) ** power
    else:  # NACA's four digits
        camber, at, thick = rng.uniform(0, 0.09), rng.uniform(0.2, 0.7), rng.uniform(0.06, 0.24)
        x = (1 - np.cos(np.linspace(0, np.pi, 100))) / 2
        half = 5 * thick * (0.2969 * np.sqrt(x) + x * (-0.1260 + x * (-0.3516 + x * (0.2843 - 0.1036 * x))))
        line = (
            np.where(x < at, (2 * at * x - x * x) / at**2, (1 - 2 * at + 2 * at * x - x * x) / (1 - at) ** 2)
            * camber
        )
        z = np.append(x + 1j * (line + half), (x + 1j * (line - half))[-2:0:-1])
    return uniform(z * np.exp(2j * np.pi * rng.random()))


def distances(curve, wanted, finer=8):
    """Return chamfer and ordered distance of LInK of a curve from 200 places; its first place is between such too.

    With its own first places alone the ordered distance would be that of half a step, and tell near curves not apart.
    """
    centre, size = wanted.mean(), wanted.std()
    own, wanted = (uniform(curve, finer * PLACES) - centre) / size, (wanted - centre) / size
    chamfer, ordered = [], []
    for first in range(finer):
        some = own[first::finer]
        apart = np.abs(some[:, None] - wanted)
        chamfer.append(apart.min(0).mean() + apart.min(1).mean())
        ordered += [
            np.mean(np.abs(np.roll(one, k) - wanted) ** 2)
            for one in (some, some[::-1])
            for k in range(PLACES)
        ]
    return min(chamfer), 2 * np.pi * min(ordered)


def placed(own, wanted):
    """Return a curve turned, sized and placed so that the ordered distance is least."""
    best = None
    for one in (own, own[::-1]):
        a, b = one - one.mean(), wanted - wanted.mean()
        both = np.fft.ifft(np.fft.fft(b) * np.conj(np.fft.fft(a)))  # of all first places
        k = int(np.argmax(np.abs(both)))
        if best is None or abs(both[k]) > best[0]:
            best = abs(both[k]), wanted.mean() + np.roll(a, k) * both[k] / np.sum(np.abs(a) ** 2)
    return best[1]


def curves_of(x, count=128):
    """Return coupler curves of shapes (a1, a2, a3, P_u, P_v by the ground; a side): NaN where the crank cannot turn."""
    (a1, a2, a3, u, v), side = 10.0 ** np.clip(x[:5], -3, 3), np.where(x[5] > 0.5, 1, -1)
    u, v = u * np.cos(x[4]), u * np.sin(x[4])
    pin = a1 * np.exp(2j * np.pi * np.arange(count) / count)[:, None]
    far = 1 - pin
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = (abs(far) ** 2 + a2**2 - a3**2) / (2 * abs(far) * a2)
        return (pin + (u + 1j * v) * far / abs(far) * (cosine + 1j * side * np.sqrt(1 - cosine**2))).T


def descriptors(z):
    """Return elliptic Fourier descriptors of curves, whatever their place, size, rotation, first place and sense."""
    around = np.concatenate([z, z[:, :1]], axis=1)
    behind = np.concatenate([np.zeros((len(z), 1)), np.cumsum(abs(np.diff(around)), axis=1)], axis=1)
    table, rows = behind / behind[:, -1:] + np.arange(len(z))[:, None], np.arange(len(z))[:, None]
    even = np.interp((rows + np.arange(64) / 64).ravel(), table.ravel(), around.ravel()).reshape(len(z), 64)
    k = np.arange(-HARMONICS, HARMONICS + 1)
    c = np.fft.fft(even)[:, k]
    back = abs(c[:, HARMONICS - 1]) > abs(c[:, HARMONICS + 1])
    c[back] = c[back, ::-1]
    one, other = np.angle(c[:, HARMONICS + 1, None]), np.angle(c[:, HARMONICS - 1, None])
    c = c * np.exp(-0.5j * ((one + other) + k * (one - other))) / abs(c[:, HARMONICS + 1, None])
    c[:, HARMONICS] = 0
    return c


def by_descriptors(wanted, atlas, seconds):
    """Return the curve of the least difference of descriptors: the nearest of an atlas, then differential evolution."""
    shapes, known = atlas
    goal, k = descriptors(wanted[None])[0], np.arange(-HARMONICS, HARMONICS + 1)
    goals = [goal, goal * (-1.0) ** (k - 1)]
    end = time.process_time() + seconds

    def off(x):
        z = curves_of(x)
        fine, found = np.isfinite(z).all(axis=1), np.full(len(z), 1e3)
        if not fine.any():
            return found
        found[fine] = np.min([(abs(descriptors(z[fine]) - one) ** 2).sum(axis=1) for one in goals], axis=0)
        return found

    near = np.argsort(np.min([(abs(known - one) ** 2).sum(axis=1) for one in goals], axis=0))[:60]
    bounds = [(-1.3, 1.3)] * 4 + [(0, 2 * np.pi), (0, 1)]
    best = differential_evolution(off, bounds, init=np.clip(shapes[:, near].T, *np.transpose(bounds)), vectorized=True,
                                  updating="deferred", maxiter=10**6, tol=0, seed=0, polish=False,
                                  callback=lambda *_, **__: time.process_time() > end)  # fmt: skip
    return placed(uniform(curves_of(best.x[:, None], 400)[0]), wanted)


def make_atlas(count=100_000):
    x = np.random.default_rng(0).uniform(size=(6, 12 * count)) * np.array([2.6] * 4 + [2 * np.pi, 1])[:, None]
    x[:4] -= 1.3
    a = np.concatenate([10.0 ** x[:3], np.ones((1, x.shape[1]))])
    turns = (a.max(axis=0) + a.min(axis=0) < 0.5 * a.sum(axis=0)) & (
        np.minimum(a[0], 1) <= np.minimum(a[1], a[2])
    )
    x = x[:, turns][:, :count]
    parts = [descriptors(curves_of(x[:, k : k + 5000])) for k in range(0, x.shape[1], 5000)]
    return x, np.concatenate(parts)


def by_swarm(wanted, seconds):
    """Return the curve of pylinkage's swarm; turn, size and place are those of the least ordered distance."""
    from pylinkage.actuators import Crank
    from pylinkage.components import Ground
    from pylinkage.dyads import FixedDyad, RRRDyad
    from pylinkage.optimization import particle_swarm_optimization
    from pylinkage.simulation import Linkage

    o, d = Ground(0, 0), Ground(1, 0)
    crank = Crank(anchor=o, radius=0.3, angular_velocity=2 * np.pi / 100)
    pin = RRRDyad(crank.output, d, distance1=0.9, distance2=0.8)
    linkage = Linkage([o, d, crank, pin, FixedDyad(crank.output, pin, distance=0.5, angle=0.3)])

    def curve(numbers, start):
        linkage.set_coords(start)
        linkage.set_constraints([float(one) for one in numbers])
        path = linkage.step_fast(100)[:, -1]
        return path[:, 0] + 1j * path[:, 1]

    start, pairs = linkage.get_coords(), ([0.05, 0.05, 0.05, 0.05, 0.0], [4.0, 4.0, 4.0, 4.0, 6.3])

    def score(_, numbers, __):
        z = curve(numbers, start)
        if not np.isfinite(z).all() or np.ptp(abs(z)) + abs(z).max() == 0.0:
            return -1e3
        z = uniform(z)
        return (
            -float(np.mean(np.abs(placed(z, wanted) - wanted) ** 2))
            if abs(z - z.mean()).max() > 1e-9
            else -1e3
        )

    begin = time.process_time()
    for _ in range(20):
        score(None, [0.3, 0.9, 0.8, 0.5, 0.3], None)
    rounds = max(2, int(seconds / 50 / ((time.process_time() - begin) / 20)))
    found = particle_swarm_optimization(score, linkage, n_particles=50, iterations=rounds, bounds=pairs, verbose=False,
                                        dimensions=5)  # fmt: skip
    return placed(uniform(curve(found[0].dimensions, start)), wanted)


def curves(count, pylinkage, seconds=1.0):
    """Return rows of medians of chamfer, ordered distance and seconds of one core; others have one second for each."""
    atlas = make_atlas()

    def own(wanted):
        found = fl.synthesise("planar_4r", path=wanted, closed=True, top=1).isel(design=0)
        theta = 2 * np.pi * np.arange(400) / 400
        design = {name: float(found[name]) for name in ("a1", "a2", "a3", "a4", "P_u", "P_v")}
        at = fl.evaluate("planar_4r", ["P_x", "P_y"], branch=int(found.branch), theta1=theta, **design)
        turn = np.exp(1j * float(found.ground_angle))
        return uniform(complex(found.O_x, found.O_y) + turn * (at["P_x"] + 1j * np.asarray(at["P_y"])))

    ways = {
        "fastlink": own,
        "descriptors, then evolution": lambda wanted: by_descriptors(wanted, atlas, seconds),
    }
    if pylinkage:
        sys.path.append(pylinkage)
        ways["pylinkage's swarm"] = lambda wanted: by_swarm(wanted, seconds)
    made = {name: [] for name in ways}
    for k in range(-1, count):  # the first one compiles
        for name, way in ways.items():
            wanted = target(k % 1000)
            z, spent = timed(lambda way=way, wanted=wanted: way(wanted), time.process_time)
            if k >= 0:
                made[name].append((*distances(z, wanted), spent))
    rows = []
    for name, known in made.items():
        chamfer, ordered, spent = np.median(known, axis=0)
        rows.append(
            (name, f"{chamfer:.4f}", f"{ordered:.5f}", f"{spent:.2f}", f"{np.max(known, axis=0)[2]:.2f}")
        )
    return rows, made


def main():
    parser = argparse.ArgumentParser(prog="python -m benchmarks.synthesis", description=__doc__)
    parser.add_argument("--seeds", type=int, default=5, help="of each published path")
    parser.add_argument("--families", type=int, default=5, help="seeds of each family that is searched")
    parser.add_argument("--random", type=int, default=0, help="random crank-rockers")
    parser.add_argument("--curves", type=int, default=0, help="that no four-bar draws")
    parser.add_argument("--pylinkage", default="", help="the folder of packages that it is installed in")
    arguments = parser.parse_args()
    dyads(10)
    fl.synthesise("planar_4r", function=np.log10, over=(1, 2), turn_deg=(60, 90), top=1)
    rate, off, counts = dyads()
    print(markdown(("case", "published", "found", "worst seed", "s", "held by"), *paths(arguments.seeds)), "")
    print(markdown(("function", "known", "found [deg]", "angle [deg]", "s"), *functions()), "")
    print(markdown(("function by a slider", "found", "r, l, e", "angle [deg]", "s"), *sliders()), "")
    head = f"best angle [deg] of a family, {arguments.families} seeds", "worst", "median", "best", "s"
    print(markdown(head, *families(arguments.families)), "")
    print(
        f"dyads of five poses: {rate:,.0f} tasks a second, off circles by {off:.1e}, {counts} tasks with 0, 1, ..."
    )
    if arguments.random:
        head = "paths", f"found again of {arguments.random}", "within 2 s", "median s"
        print(markdown(head, *random_linkages(arguments.random)), "")
    if arguments.curves:
        rows, _ = curves(arguments.curves, arguments.pylinkage)
        head = f"{arguments.curves} curves, medians", "chamfer", "ordered", "s", "greatest s"
        print(markdown(head, *rows))


if __name__ == "__main__":
    main()

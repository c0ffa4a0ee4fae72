"""Dimensional synthesis: published cases with the least that was found, random linkages found again, functions; times.

``python -m benchmarks.synthesis`` prints the tables of docs/synthesis.md and, with ``--random N``, how many of N random
crank-rockers come back from twelve points each. Everything is compiled before it is timed.
"""

import argparse
import time

import numpy as np

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


def timed(function):
    start = time.perf_counter()
    return function(), time.perf_counter() - start


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


def main():
    parser = argparse.ArgumentParser(prog="python -m benchmarks.synthesis", description=__doc__)
    parser.add_argument("--seeds", type=int, default=5, help="of each published path")
    parser.add_argument("--random", type=int, default=0, help="random crank-rockers")
    arguments = parser.parse_args()
    dyads(10)
    fl.synthesise("planar_4r", function=np.log10, over=(1, 2), turn_deg=(60, 90), top=1)
    rate, off, counts = dyads()
    print(markdown(("case", "published", "found", "worst seed", "s", "held by"), *paths(arguments.seeds)), "")
    print(markdown(("function", "known", "found [deg]", "angle [deg]", "s"), *functions()), "")
    print(
        f"dyads of five poses: {rate:,.0f} tasks a second, off circles by {off:.1e}, {counts} tasks with 0, 1, ..."
    )
    if arguments.random:
        head = "paths", f"found again of {arguments.random}", "within 2 s", "median s"
        print(markdown(head, *random_linkages(arguments.random)))


if __name__ == "__main__":
    main()

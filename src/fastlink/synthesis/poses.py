"""Motion generation: dyads and linkages that carry a body through poses; paths with timing as motions of a cognate."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from fastlink.synthesis.paths import compiled, curve_of

__all__ = ["Dyad", "MotionTask", "dyads_of", "pairs_of", "solve_motion", "timed_by_cognate"]

Floats = NDArray[np.float64]

#: Further poses that are drawn where fewer than five are given, each with up to four dyads.
DRAWN = 1500
#: Of the dyads of a family so many are paired; longer links than so many times the size of the task are left out.
PAIRED, LONGEST = 260, 15.0


@dataclass(frozen=True)
class MotionTask:
    """Poses that were checked: points of the body, directions of it, and the length that weighs angles."""

    points: NDArray[np.complex128]
    angles: Floats
    rotation_length: float

    @property
    def size(self) -> float:
        """The greatest distance from the mean, or the length that weighs angles where all points are one."""
        return float(np.abs(self.points - self.points.mean()).max()) or self.rotation_length


#: Centre and body point of a dyad.
Dyad = tuple[complex, complex]


def dyads_of(points: NDArray[np.complex128], angles: Floats) -> list[Dyad]:
    """Return all RR dyads of five poses; of more, those of the linear form's least squares, then nearest to circles."""
    found, counts = np.empty((1, 4, 4)), np.zeros(1, dtype=np.int64)
    if len(points) == 5:
        poses = np.stack([points.real, points.imag, angles], axis=1)[None]
        compiled("dyads")(poses, np.zeros((1, 5, 8)), found, counts)
        return [(complex(a, b), complex(c, d)) for a, b, c, d in found[0, : counts[0]]]
    origin = points.mean()
    size = float(np.abs(points - origin).max()) or 1.0
    d, e = (points - origin) / size, np.exp(1j * angles)
    m = np.conj(d) * e
    columns = (
        np.abs(d) ** 2,
        2 * m.real,
        -2 * m.imag,
        -2 * d.real,
        -2 * d.imag,
        -2 * e.real,
        2 * e.imag,
        np.ones(len(d)),
    )
    rows = np.linalg.svd(np.stack(columns, axis=1))[2][:5]
    compiled("dyads")(np.full((1, 5, 3), np.nan), np.ascontiguousarray(rows[None]), found, counts)
    starts = [(complex(a, b), complex(c, f)) for a, b, c, f in found[0, : counts[0]]]
    return [(origin + size * c, size * w) for c, w in (_on_circle(d, e, start) for start in starts)]


def _on_circle(d: NDArray[np.complex128], e: NDArray[np.complex128], start: Dyad) -> Dyad:
    """Return the dyad whose pin leaves its circle least, in lengths, near a start."""

    def off(x: Floats) -> Floats:
        return np.asarray(np.abs(d + e * complex(x[2], x[3]) - complex(x[0], x[1])) - x[4])

    def slopes(x: Floats) -> Floats:
        pin = d + e * complex(x[2], x[3]) - complex(x[0], x[1])
        unit = pin / np.abs(pin)
        turn = np.conj(unit) * e
        return np.stack([-unit.real, -unit.imag, turn.real, -turn.imag, -np.ones(len(d))], axis=1)

    c, w = start
    radius = float(np.mean(np.abs(d + e * w - c)))
    x = np.array([c.real, c.imag, w.real, w.imag, radius])
    if not np.isfinite(x).all():
        return start
    found = least_squares(off, x, slopes, method="lm", xtol=1e-15, ftol=1e-15, gtol=1e-15).x
    return complex(found[0], found[1]), complex(found[2], found[3])


def family_of(task: MotionTask, seed: int) -> list[Dyad]:
    """Return dyads of two to four poses: those of the poses with further ones that are drawn about them."""
    rng = np.random.default_rng(seed)
    count = len(task.points)
    poses = np.empty((DRAWN, 5, 3))
    poses[:, :count] = np.stack([task.points.real, task.points.imag, task.angles], axis=1)
    more = 5 - count
    weights = rng.dirichlet(np.ones(count), (DRAWN, more))
    centre = weights @ task.points + task.size * (
        rng.normal(size=(DRAWN, more)) + 1j * rng.normal(size=(DRAWN, more))
    )
    poses[:, count:, 0], poses[:, count:, 1] = centre.real, centre.imag
    spread = max(float(np.ptp(task.angles)), 0.3)
    poses[:, count:, 2] = weights @ task.angles + 0.7 * spread * rng.normal(size=(DRAWN, more))
    found, counts = np.empty((DRAWN, 4, 4)), np.zeros(DRAWN, dtype=np.int64)
    compiled("dyads")(poses, np.zeros((DRAWN, 5, 8)), found, counts)
    rows = found[np.isfinite(found[..., 0])]
    return [(complex(a, b), complex(c, d)) for a, b, c, d in rows]


def pairs_of(task: MotionTask, dyads: list[Dyad], both: bool = True) -> dict[str, Any]:
    """Return the linkages of pairs of dyads, driven by the first of each: arrays by name.

    Besides the crank angles at each pose come the signs of B beside the line from A to D, and the angle of the body
    from AB.
    """
    choose = permutations if both else combinations
    pairs = np.array(list(choose(range(len(dyads)), 2)), dtype=int).reshape(-1, 2)
    c, w = np.array([one[0] for one in dyads]), np.array([one[1] for one in dyads])
    c1, w1, c2, w2 = c[pairs[:, 0]], w[pairs[:, 0]], c[pairs[:, 1]], w[pairs[:, 1]]
    e = np.exp(1j * task.angles)
    a, b = task.points + e * w1[:, None], task.points + e * w2[:, None]
    ground, bar = c2 - c1, w2 - w1
    with np.errstate(all="ignore"):
        place = -w1 / (bar / np.abs(bar))
        crank = np.abs(a - c1[:, None]).mean(axis=1)
        output = np.abs(b - c2[:, None]).mean(axis=1)
        theta = np.angle((a - c1[:, None]) / ground[:, None])
        side = np.sign((np.conj(c2[:, None] - a) * (b - a)).imag)
    numbers = np.stack([crank, np.abs(bar), output, np.abs(ground), place.real, place.imag, c1.real, c1.imag,
                        np.angle(ground), np.zeros(len(pairs))], axis=1)  # fmt: skip
    return {
        "numbers": numbers,
        "theta": np.unwrap(theta, axis=1),
        "side": side,
        "body_angle": -np.angle(bar),
        "pairs": pairs,
    }


def solve_motion(task: MotionTask, seed: int) -> tuple[dict[str, Any], int]:
    """Return the linkages of a motion, and how many dyads they are made of."""
    if len(task.points) >= 5:
        dyads = dyads_of(task.points, task.angles)
        found = pairs_of(task, dyads)
        if len(task.points) > 5:
            found = _on_poses(task, found)
        return found, len(dyads)
    dyads = family_of(task, seed)
    size, origin = task.size, task.points.mean()
    kept = [
        one
        for one in dyads
        if abs(one[0] - origin) < LONGEST * size and 1e-3 * size < _radius(task, one) < LONGEST * size
    ]
    rng = np.random.default_rng(seed)
    some = [kept[k] for k in rng.permutation(len(kept))[:PAIRED]]
    return pairs_of(task, some), len(kept)


def _radius(task: MotionTask, dyad: Dyad) -> float:
    return float(np.abs(task.points[0] + np.exp(1j * task.angles[0]) * dyad[1] - dyad[0]))


def _on_poses(task: MotionTask, found: dict[str, Any]) -> dict[str, Any]:
    """Refine linkages on what they are to do: the body's places, and its directions times the length that weighs them.

    A direction is a second point of the body, so that both are distances; the crank angles are unknowns besides.
    """
    length, n = task.rotation_length, len(task.points)
    e = np.exp(1j * task.angles)
    kept = []
    for row in range(len(found["numbers"])):
        x = found["numbers"][row][:9]
        side = float(np.sign(found["side"][row].sum()) or 1.0)
        start = np.concatenate([x, [found["body_angle"][row]], found["theta"][row]])

        def at(v: Floats, side: float = side) -> tuple[Any, ...]:
            return curve_of(np.append(v[:9], 0.0), v[10:], side)

        def off(v: Floats, at: Any = at) -> Floats:
            point, _, along, *_ = at(v)
            away, tilt = point - task.points, length * (along * np.exp(1j * v[9]) - e)
            return np.concatenate([away.real, away.imag, tilt.real, tilt.imag])

        def slopes(v: Floats, at: Any = at) -> Floats:
            _, by, along, rate, _ = at(v)
            tilt = (length * 1j * along * np.exp(1j * v[9]))[:, None] * rate
            wide, own = np.zeros((4 * n, 10 + n)), np.arange(n)
            for k, part in enumerate((by.real, by.imag, tilt.real, tilt.imag)):
                wide[k * n : (k + 1) * n, :9] = part[:, :9]
                wide[k * n + own, 10 + own] = part[:, 9]
            body = tilt[:, 8]  # by the direction of the body as by that of the ground
            wide[2 * n : 3 * n, 9], wide[3 * n :, 9] = body.real, body.imag
            return wide

        if not np.isfinite(start).all() or not at(start)[-1]:
            continue
        best = least_squares(off, start, slopes, method="trf", x_scale="jac", xtol=1e-15, ftol=1e-15, gtol=1e-15,
                             max_nfev=300)  # fmt: skip
        if (best.x[:4] <= 0.0).any() or not at(best.x)[-1]:
            continue
        kept.append((np.append(best.x[:9], 0.0), best.x[10:], side, best.x[9], row))
    names = ("numbers", "theta", "side", "body_angle")
    if not kept:
        return {name: found[name][:0] for name in (*names, "pairs")}
    numbers, theta, sides, body, rows = (np.array(part) for part in zip(*kept, strict=True))
    sides = np.repeat(sides[:, None], n, axis=1)
    parts = (numbers, theta, sides, body, found["pairs"][rows])
    return dict(zip((*names, "pairs"), parts, strict=True))


def timed_by_cognate(points: NDArray[np.complex128], times: Floats) -> tuple[Floats, Floats]:
    """Return linkages (rows of ten numbers) whose crank turns by times while the point passes points, and their signs.

    The crank of a linkage turns as the coupler of a cognate does (S. Roberts 1875), so points with times are poses of
    that cognate: exact for five, up to twelve linkages.
    """
    e = np.exp(1j * times)
    rows, signs = [], []
    for (c1, w1), (c2, w2) in permutations(dyads_of(points, times), 2):
        if w1 == w2:
            continue
        k = -w1 / (w2 - w1)
        third, arm = c1 + (c2 - c1) * k, float(np.mean(np.abs(points + e * w1 - c1)))
        place = arm * np.exp(-1j * np.angle(k))
        ground = float(np.angle(third - c1))
        lengths = (
            abs(third - c1),
            abs(w1),
            abs(k) * arm,
            abs(k) * float(np.mean(np.abs(points + e * w2 - c2))),
        )
        a4, a1, a2, a3 = lengths
        if not min(lengths) > 0.0:
            continue
        rows.append(
            [a1, a2, a3, a4, place.real, place.imag, c1.real, c1.imag, ground, float(np.angle(-w1)) - ground]
        )
        crank = a1 * np.exp(1j * (rows[-1][9] + times))
        coupler = (points - c1) * np.exp(-1j * ground) - crank
        b = crank + a2 * coupler / place
        side = np.sign((np.conj(a4 - crank) * (b - crank)).imag)
        signs.append(side)
    return np.array(rows).reshape(-1, 10), np.array(signs).reshape(-1, len(points))

"""Motion generation: dyads and linkages that carry a body through poses; paths with timing as motions of a cognate."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from fastlink.synthesis.paths import Complex, Floats, curve_of, from_pins, solved

__all__ = ["Dyad", "MotionTask", "dyads_of", "dyads_of_five", "pairs_of", "solve_motion", "timed_by_cognate"]

#: Further poses that are drawn where fewer than five are given, each with up to four dyads.
DRAWN = 1500
#: Of the dyads of a family so many are paired; longer links than so many times the size of the task are left out.
PAIRED, LONGEST = 260, 15.0
#: Directions of a slider's line that are tried where two or three poses leave it free.
DIRECTIONS = 90


@dataclass(frozen=True)
class MotionTask:
    """Poses that were checked: points of the body, directions of it, and the length that weighs angles."""

    points: Complex
    angles: Floats
    rotation_length: float
    #: Whether a slider-crank is to carry the body.
    slider: bool = False

    @property
    def size(self) -> float:
        """The greatest distance from the mean, or the length that weighs angles where all points are one."""
        return float(np.abs(self.points - self.points.mean()).max()) or self.rotation_length


#: Centre and body point of a dyad.
Dyad = tuple[complex, complex]


#: Tasks that are solved at once.
BLOCK = 2048
#: A turn of the null space, so that no dyad of the usual tasks has a coordinate without size.
MIX = np.array([[0.6, 0.48, 0.64], [-0.8, 0.36, 0.48], [0.0, -0.8, 0.6]])


def _rows(d: Complex, e: Complex) -> Floats:
    """Return the linear form of poses: |d + e w - c|^2 = R^2 as a row times (p0, w, c, q, k), with q p0 = conj(c) w."""
    m, one = np.conj(d) * e, np.ones(d.shape)
    parts = (
        np.abs(d) ** 2,
        2.0 * m.real,
        -2.0 * m.imag,
        -2.0 * d.real,
        -2.0 * d.imag,
        -2.0 * e.real,
        2.0 * e.imag,
    )
    return np.stack([*parts, one], axis=-1)


def _product(a: Floats, b: Floats) -> Floats:
    """Return products of polynomials (tasks, powers), lowest power first."""
    made = np.zeros((len(a), a.shape[1] + b.shape[1] - 1))
    for k in range(a.shape[1]):
        made[:, k : k + b.shape[1]] += a[:, k : k + 1] * b
    return made


@np.errstate(all="ignore")
def _of_null_space(rows: Floats) -> tuple[Complex, Complex]:
    """Return centres and body points (tasks, 4) of all dyads whose linear form meets five rows; NaN where fewer are.

    The rows leave three dimensions, and both parts of q p0 = conj(c) w are conics there, which meet in four points.
    """
    basis = MIX @ np.linalg.qr(np.swapaxes(rows, 1, 2), mode="complete")[0][:, :, 5:].swapaxes(1, 2)
    w, c, q = (basis[..., k] + 1j * basis[..., k + 1] for k in (1, 3, 5))
    both = basis[:, :, None, 0] * q[:, None] - np.conj(c)[:, :, None] * w[:, None]
    both = 0.5 * (both + both.swapaxes(1, 2))
    # a y^2 + b(x) y + c(x) = 0 of either; the resultant of both is the quartic
    (a1, a2), (b1, b2), (c1, c2) = zip(*(
        (of[:, 2, 2, None], 2.0 * of[:, :2, 2], np.stack([of[:, 0, 0], 2.0 * of[:, 0, 1], of[:, 1, 1]], axis=1))
        for of in (both.real, both.imag)), strict=True)  # fmt: skip
    u, slope = a1 * c2 - a2 * c1, a1 * b2 - a2 * b1
    quartic = _product(u, u) - _product(slope, _product(b1, c2) - _product(b2, c1))
    companion = np.zeros((len(rows), 4, 4))
    companion[:, 1:, :3] = np.eye(3)
    companion[:, :, 3] = -quartic[:, :4] / quartic[:, 4:]
    companion[~np.isfinite(companion).all(axis=(1, 2))] = 0.0
    roots = np.linalg.eigvals(companion)
    # of a pair that nearly meets both count as real: the conics tell
    x = np.where(np.abs(roots.imag) <= 1e-5 * (1.0 + np.abs(roots)), roots.real, np.nan)
    y = -(u[:, :1] + x * (u[:, 1:2] + x * u[:, 2:])) / (slope[:, :1] + slope[:, 1:] * x)
    f00, f01, f02, f11, f12, f22 = (
        both[:, i, k, None] for i, k in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    )
    for _ in range(6):
        value = f00 + x * (2.0 * f01 + f11 * x) + y * (2.0 * (f02 + f12 * x) + f22 * y)
        by_x, by_y = 2.0 * (f01 + f11 * x + f12 * y), 2.0 * (f02 + f12 * x + f22 * y)
        det = (np.conj(by_x) * by_y).imag
        x, y = x - (np.conj(value) * by_y).imag / det, y - (np.conj(by_x) * value).imag / det
    size = 1.0 + x * x + y * y
    x = np.where(np.abs(value.real) + np.abs(value.imag) < 1e-11 * size, x, np.nan)
    w, c = (of[:, :1] + x * of[:, 1:2] + y * of[:, 2:] for of in (w, c))
    scale = basis[:, :1, 0] + x * basis[:, 1:2, 0] + y * basis[:, 2:, 0]
    return c / scale, w / scale


def _without_doubles(c: Complex, w: Complex) -> tuple[Complex, Complex]:
    """Return dyads (tasks, 4) with NaN for those that are there before, or at infinity."""
    same = np.abs(c[:, :, None] - c[:, None]) + np.abs(w[:, :, None] - w[:, None])
    same = same < 1e-9 * (1.0 + np.abs(c) + np.abs(w))[:, :, None]
    drop = np.tril(same, -1).any(axis=2) | ~(np.abs(c) < 1e12)
    return np.where(drop, np.nan, c), np.where(drop, np.nan, w)


@np.errstate(all="ignore")
def dyads_of_five(points: Complex, angles: Floats) -> tuple[Complex, Complex]:
    """Return centres and body points (tasks, 4) of all RR dyads of tasks of five poses (tasks, 5); NaN for no dyad."""
    centres, pins = np.empty((2, len(points), 4), dtype=complex)
    for k in range(0, len(points), BLOCK):
        z, e = points[k : k + BLOCK], np.exp(1j * angles[k : k + BLOCK])
        origin = z.mean(axis=1, keepdims=True)
        size = np.abs(z - origin).max(axis=1, keepdims=True)
        size = np.where(size > 0.0, size, 1.0)
        d = (z - origin) / size
        c, w = _of_null_space(_rows(d, e))
        task, which = np.nonzero(np.isfinite(c) & np.isfinite(w))
        d, e, centre, pin = d[task], e[task], c[task, which], w[task, which]
        for _ in range(2):  # on the circles of the poses themselves
            at = d + e * pin[:, None] - centre[:, None]
            first, other = at[:, :1], at[:, 1:]
            shift, turn = first - other, np.conj(other) * e[:, 1:] - np.conj(first) * e[:, :1]
            jac = 2.0 * np.stack([shift.real, shift.imag, turn.real, -turn.imag], axis=-1)
            # the difference of two squares as a product, which loses nothing
            off = -shift.real * (other.real + first.real) - shift.imag * (other.imag + first.imag)
            step = solved(jac, off)
            centre, pin = centre - (step[:, 0] + 1j * step[:, 1]), pin - (step[:, 2] + 1j * step[:, 3])
        c[task, which], w[task, which] = centre, pin
        c, w = _without_doubles(c, w)
        centres[k : k + BLOCK], pins[k : k + BLOCK] = origin + size * c, size * w
    return centres, pins


def dyads_of(points: Complex, angles: Floats) -> list[Dyad]:
    """Return all RR dyads of five poses; of more, those of the linear form's least squares, then nearest to circles."""
    if len(points) == 5:
        return _listed(*dyads_of_five(points[None], angles[None]))
    origin = points.mean()
    size = float(np.abs(points - origin).max()) or 1.0
    d, e = (points - origin) / size, np.exp(1j * angles)
    starts = _listed(*_without_doubles(*_of_null_space(np.linalg.svd(_rows(d, e))[2][None, :5])))
    return [(origin + size * c, size * w) for c, w in (_on_circle(d, e, start) for start in starts)]


def _listed(centres: Complex, pins: Complex) -> list[Dyad]:
    fine = np.isfinite(centres) & np.isfinite(pins)
    return [(complex(c), complex(w)) for c, w in zip(centres[fine], pins[fine], strict=True)]


def _on_circle(d: Complex, e: Complex, start: Dyad) -> Dyad:
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
    return _listed(*dyads_of_five(poses[..., 0] + 1j * poses[..., 1], poses[..., 2]))


def sliders_of(task: MotionTask) -> tuple[Complex, Complex]:
    """Return directions across a line, and the body points that move along it: of four poses the one there is.

    Re(conj(n) (d + e w)) = k is linear in conj(n) w and k for each direction n. Of more poses it is the one whose
    squares are least, besides one where they are stationary; of three there is one point for each n, of two a line.
    """
    origin, count = task.points.mean(), len(task.points)
    d, e = (task.points - origin) / task.size, np.exp(1j * task.angles)
    rows, right = np.stack([e.real, -e.imag, -np.ones(count)], axis=1), np.stack([d.real, d.imag], axis=1)
    if count > 3:
        n = np.linalg.svd(right - rows @ np.linalg.lstsq(rows, right)[0])[2][::-1].T
        n = n[:, :1] if count == 4 else n
    else:
        angle = np.pi * (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
        n = np.stack([np.cos(angle), np.sin(angle)])
    found = np.linalg.lstsq(rows, -right @ n)[0]
    if count == 2:  # what the poses leave free
        found += (
            np.linalg.svd(rows)[2][2][:, None] * np.tan(1.4 * np.linspace(-1, 1, n.shape[1]) ** 3)[:, None].T
        )
    across = n[0] + 1j * n[1]
    return across, task.size * (found[0] + 1j * found[1]) / np.conj(across)


def pairs_of(task: MotionTask, dyads: list[Dyad]) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the linkages of pairs of dyads, driven by the first of each.

    As numbers, crank angles at each pose, signs of B beside the line from A to D, and angles of the body from AB.
    """
    c, w = np.array(dyads, dtype=complex).reshape(-1, 2).T
    if task.slider:
        d, pins = sliders_of(task)
        first, other = (of.ravel() for of in np.indices((len(c), len(d))))
    else:
        d, pins = c, w
        first, other = np.array(list(permutations(range(len(c)), 2)), dtype=int).reshape(-1, 2).T
    points, e = np.broadcast_to(task.points, (len(first), len(task.points))), np.exp(1j * task.angles)
    a, b = (points + e * of[:, None] for of in (w[first], pins[other]))
    numbers, theta, side = from_pins(c[first], d[other], a, b, points, task.slider)
    return numbers, np.unwrap(theta, axis=1), side, -np.angle(pins[other] - w[first])


def solve_motion(task: MotionTask, seed: int) -> tuple[Floats, Floats, Floats, Floats, int]:
    """Return the linkages of a motion as `pairs_of` does, and how many dyads with a crank they are made of."""
    if len(task.points) >= 5:
        dyads = dyads_of(task.points, task.angles)
        found = pairs_of(task, dyads)
        return *(_on_poses(task, *found) if len(task.points) > 5 or task.slider else found), len(dyads)
    dyads = family_of(task, seed)
    size, origin = task.size, task.points.mean()
    kept = [
        one
        for one in dyads
        if abs(one[0] - origin) < LONGEST * size and 1e-3 * size < _radius(task, one) < LONGEST * size
    ]
    rng, most = np.random.default_rng(seed), PAIRED * (8 if task.slider and len(task.points) == 4 else 1)
    return *pairs_of(task, [kept[k] for k in rng.permutation(len(kept))[:most]]), len(kept)


def _radius(task: MotionTask, dyad: Dyad) -> float:
    return float(np.abs(task.points[0] + np.exp(1j * task.angles[0]) * dyad[1] - dyad[0]))


@np.errstate(all="ignore")  # at a dead point rates are infinite
def _on_poses(
    task: MotionTask, numbers: Floats, theta: Floats, sides: Floats, bodies: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """Refine linkages on what they are to do: the body's places, and its directions times the length that weighs them.

    A direction is a second point of the body, so that both are distances; the crank angles are unknowns besides.
    """
    length, n = task.rotation_length, len(task.points)
    e, lengths = np.exp(1j * task.angles), 2 if task.slider else 4
    kept = []
    for row, x in enumerate(numbers[:, :9]):
        side = float(np.sign(sides[row].sum()) or 1.0)
        start = np.concatenate([x, [bodies[row]], theta[row]])

        def at(v: Floats, side: float = side) -> tuple[Any, ...]:
            return curve_of(np.append(v[:9], 0.0), v[10:], side, task.slider)

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
        if (best.x[:lengths] > 0.0).all() and at(best.x)[-1]:
            kept.append((np.append(best.x[:9], 0.0), best.x[10:], np.full(n, side), best.x[9]))
    if not kept:
        return numbers[:0], theta[:0], sides[:0], bodies[:0]
    found, angles, signs, body = (np.array(part) for part in zip(*kept, strict=True))
    return found, angles, signs, body


def timed_by_cognate(points: Complex, times: Floats) -> tuple[Floats, Floats]:
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

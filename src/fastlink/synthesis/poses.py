"""Motion generation: dyads and linkages that carry a body through poses; paths with timing as motions of a cognate."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from fastlink.synthesis.paths import Complex, Fit, Floats, PathTask, from_pins, solved, wrapped

__all__ = ["dyads_of", "dyads_of_five", "pairs_of", "solve_motion"]

#: Further poses that are drawn where fewer than five are given, each with up to four dyads.
DRAWN = 1500
#: Of the dyads of a family so many are paired; longer links than so many times the size of the task are left out.
PAIRED, LONGEST = 260, 15.0
#: Directions of a slider's line that are tried where two or three poses leave it free.
DIRECTIONS = 90
#: Pairs of dyads that are moved to numbers that are given.
MOVED = 1500
#: Residuals by the size of a task, of links that are up to as long: of some ten operations each, whose roundings are
#: 1e-15 in sum, and a thousand times that for the condition of Newton's last step.
MET = 1e-12


#: Tasks that are solved at once.
BLOCK = 2048
#: A turn of the null space, so that no dyad of the usual tasks has a coordinate without size.
MIX = np.array([[0.6, 0.48, 0.64], [-0.8, 0.36, 0.48], [0.0, -0.8, 0.6]])


def _rows(d: Complex, e: Complex) -> Floats:
    """Return the linear form of poses: |d + e w - c|^2 = R^2 as a row times (p0, w, c, q, k), with q p0 = conj(c) w."""
    m, one = np.conj(d) * e, np.ones(d.shape)
    twice = (m.real, -m.imag, -d.real, -d.imag, -e.real, e.imag)
    return np.stack([np.abs(d) ** 2, *(2.0 * part for part in twice), one], axis=-1)


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
    f00, f01, f02, f11, f12, f22 = (both[:, i, k, None] for i in range(3) for k in range(i, 3))
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
def dyads_of_five(points: Complex, angles: Floats, steps: int = 2) -> tuple[Complex, Complex]:
    """Return centres and body points (tasks, 4) of all RR dyads of tasks of five poses (tasks, 5); NaN for no dyad.

    Of more poses, those of the linear form's least squares, moved next to circles by as many steps.
    """
    centres, pins = np.empty((2, len(points), 4), dtype=complex)
    for k in range(0, len(points), BLOCK):
        z, e = points[k : k + BLOCK], np.exp(1j * angles[k : k + BLOCK])
        origin = z.mean(axis=1, keepdims=True)
        size = np.abs(z - origin).max(axis=1, keepdims=True)
        size = np.where(size > 0.0, size, 1.0)
        d = (z - origin) / size
        rows = _rows(d, e)
        c, w = _of_null_space(rows if z.shape[1] == 5 else np.linalg.svd(rows)[2][:, :5])
        task, which = np.nonzero(np.isfinite(c) & np.isfinite(w))
        c[task, which], w[task, which] = _on_circles(d[task], e[task], c[task, which], w[task, which], steps)
        c, w = _without_doubles(c, w)
        centres[k : k + BLOCK], pins[k : k + BLOCK] = origin + size * c, size * w
    return centres, pins


def _on_circles(d: Complex, e: Complex, centre: Complex, pin: Complex, steps: int) -> tuple[Complex, Complex]:
    """Return dyads next to others whose pins are on circles of the poses themselves, after Newton's steps."""
    for _ in range(steps):
        at = d + e * pin[:, None] - centre[:, None]
        first, other = at[:, :1], at[:, 1:]
        shift, turn = first - other, np.conj(other) * e[:, 1:] - np.conj(first) * e[:, :1]
        jac = 2.0 * np.stack([shift.real, shift.imag, turn.real, -turn.imag], axis=-1)
        # the difference of two squares as a product, which loses nothing
        off = -shift.real * (other.real + first.real) - shift.imag * (other.imag + first.imag)
        step = solved(jac, off) if off.shape[1] == 4 else (np.linalg.pinv(jac) @ off[..., None])[..., 0]
        centre, pin = centre - (step[:, 0] + 1j * step[:, 1]), pin - (step[:, 2] + 1j * step[:, 3])
    return centre, pin


def dyads_of(task: PathTask) -> Complex:
    """Return all RR dyads of five poses; of more, those of the linear form's least squares, then nearest to circles."""
    steps = 2 if len(task.target) == 5 else 8
    return _listed(*dyads_of_five(task.target[None], task.angles[None], steps))


def _listed(centres: Complex, pins: Complex) -> Complex:
    """Return the centres and body points there are (2, dyads)."""
    fine = np.isfinite(centres) & np.isfinite(pins)
    return np.stack([centres[fine], pins[fine]])


def family_of(task: PathTask, seed: int) -> Complex:
    """Return dyads of two to four poses: those of the poses with further ones that are drawn about them."""
    rng = np.random.default_rng(seed)
    count = len(task.target)
    poses = np.empty((DRAWN, 5, 3))
    poses[:, :count] = np.stack([task.target.real, task.target.imag, task.angles], axis=1)
    more = 5 - count
    weights = rng.dirichlet(np.ones(count), (DRAWN, more))
    x, y = rng.normal(size=(2, DRAWN, more))
    centre = weights @ task.target + task.extent * (x + 1j * y)
    poses[:, count:, 0], poses[:, count:, 1] = centre.real, centre.imag
    spread = max(float(np.ptp(task.angles)), 0.3)
    poses[:, count:, 2] = weights @ task.angles + 0.7 * spread * rng.normal(size=(DRAWN, more))
    return _listed(*dyads_of_five(poses[..., 0] + 1j * poses[..., 1], poses[..., 2]))


def sliders_of(task: PathTask, angles: Floats, free: Any = 0.0) -> tuple[Complex, Complex]:
    """Return directions across a line, and the body points that move along it: of four poses the one there is.

    Re(conj(n) (d + e w)) = k is linear in conj(n) w and k for each direction n. Of more poses it is the one whose
    squares are least, besides one where they are stationary; of three there is one point for each n, of two a line of
    them. These directions are given, and places along such lines.
    """
    origin, count = task.target.mean(), len(task.target)
    d, e = (task.target - origin) / task.extent, np.exp(1j * task.angles)
    rows, right = np.stack([e.real, -e.imag, -np.ones(count)], axis=1), np.stack([d.real, d.imag], axis=1)
    if count > 3:
        n = np.linalg.svd(right - rows @ np.linalg.lstsq(rows, right)[0])[2][::-1].T
        n = n[:, :1] if count == 4 else n
    else:
        n = np.stack([np.cos(angles), np.sin(angles)])
    found = np.linalg.lstsq(rows, -right @ n)[0]
    if count == 2:
        found += np.linalg.svd(rows)[2][2][:, None] * free
    across = n[0] + 1j * n[1]
    return across, task.extent * (found[0] + 1j * found[1]) / np.conj(across)


def linkages_of(task: PathTask, c: Any, w: Any, d: Any, v: Any) -> tuple[Floats, Floats, Floats, Floats]:
    """Return linkages of dyads with centres and body points c, w that are driven, and d, v.

    As numbers, crank angles at each pose, signs of B beside the line from A to D, and angles of the body from AB.
    """
    points, e = np.broadcast_to(task.target, (len(c), len(task.target))), np.exp(1j * task.angles)
    a, b = points + e * w[:, None], points + e * v[:, None]
    numbers, theta, side = from_pins(c, d, a, b, points, task.slider)
    longest = 1.0 + np.abs(numbers[:, :8]).max(axis=1, keepdims=True) / task.extent
    met = np.abs(_from_fixed(task, numbers)) <= MET * longest
    return np.where(met, task.fixed, numbers), np.unwrap(theta, axis=1), side, -np.angle(v - w)


def _from_fixed(task: PathTask, numbers: Floats) -> Floats:
    """Return how far numbers of linkages are from those that are given, lengths by the size of the task."""
    off = numbers - task.fixed
    off[..., :8] /= task.extent
    off[..., 8:] = wrapped(off[..., 8:])
    return np.asarray(off)


@np.errstate(all="ignore")
def as_given(task: PathTask, c: Any, w: Any, d: Any, v: Any) -> tuple[NDArray[np.bool_], Complex]:
    """Return which pairs of dyads have the numbers that are given and meet the poses, after they were moved to these.

    Fixed pivots begin where they are to be: what is left is linear in the moving ones then, and the first step of
    Newton is the closed form, the point with equal distances from the places of the pivot in the body. Of all changes
    that a step may be it is the least one.
    """
    given, origin, size = np.flatnonzero(np.isfinite(task.fixed)), task.target.mean(), task.extent
    points, e = np.broadcast_to(task.target, (len(c), len(task.target))), np.exp(1j * task.angles)
    a4, at, ground = task.fixed[3], task.fixed[6:8], task.fixed[8]
    c = np.where(np.isfinite(at[0]), at[0], c.real) + 1j * np.where(np.isfinite(at[1]), at[1], c.imag)
    if task.slider:
        d = d if np.isnan(ground) else 1j * np.exp(1j * np.full(len(c), ground))
    else:
        far = d - c
        turn = far / np.abs(far) if np.isnan(ground) else np.exp(1j * ground)
        d = c + (np.abs(far) if np.isnan(a4) else a4) * turn

    def pins(x: Floats) -> Any:
        z = size * (x[:, ::2] + 1j * x[:, 1::2])
        d = np.exp(1j * x[:, 4]) if task.slider else origin + z[:, 2]
        return origin + z[:, 0], z[:, 1], d, z[:, 3]

    def off(x: Floats) -> Floats:
        c, w, d, v = pins(x)
        z = np.resize(points, (len(x), len(e)))
        a, b = z + e * w[:, None], z + e * v[:, None]
        numbers = from_pins(c, d, a, b, z, task.slider)[0]
        # squares of distances, whose differences are linear in either pivot
        parts = [_squares(a - c[:, None]) / size**2]
        parts.append((np.conj(d)[:, None] * (b - b[:, :1])).real[:, 1:] / size if task.slider
                     else _squares(b - d[:, None]) / size**2)  # fmt: skip
        return np.hstack([*parts, _from_fixed(task, numbers)[:, given]])

    z = np.stack([c - origin, w, 0.0 * d if task.slider else d - origin, v], axis=1) / size
    x = np.stack([z.real, z.imag], axis=2).reshape(-1, 8)
    if task.slider:
        x[:, 4] = np.angle(d)
    for _ in range(12):
        now, step = off(x), 1e-7 * (1.0 + np.abs(x))
        beside = (x[:, None] + step[:, :, None] * np.eye(8)).reshape(-1, 8)
        jac = (off(beside).reshape(len(x), 8, -1) - now[:, None]) / step[:, :, None]
        jac = np.nan_to_num(jac, posinf=0.0, neginf=0.0)
        square = jac.swapaxes(1, 2) @ jac
        # of equations that depend on each other, as for a pivot on the centre-point curve, the rest is dropped
        square += 1e-13 * np.trace(square, axis1=1, axis2=2)[:, None, None] * np.eye(square.shape[1])
        x = x - (jac @ solved(square, np.nan_to_num(now))[..., None])[..., 0]
    made = pins(x)
    longest = 1.0 + np.abs(x).max(axis=1)
    return np.asarray(np.abs(off(x)).max(axis=1) <= MET * longest**2), np.stack(made)


def on_circle(task: PathTask, pivot: complex | None = None) -> bool:
    """Tell whether the places of a fixed pivot in the body, or those of the body's own point, are on a circle."""
    places = task.target if pivot is None else np.exp(-1j * task.angles) * (pivot - task.target)
    places = (places - places[0]) / task.extent
    rows = np.stack([places.real, places.imag], axis=1)[1:]
    middle = complex(*np.linalg.lstsq(rows, 0.5 * np.abs(places[1:]) ** 2)[0])
    return bool(np.ptp(np.abs(places - middle)) <= MET * (1.0 + np.abs(places).max() + abs(middle)))


def nearest_centre(task: PathTask) -> float:
    """Return O_y of the centre-point curve of four poses for the O_x that is given, next to the one that is."""
    c, w = family_of(task, 0)[:, :MOVED]
    alone = replace(task, fixed=np.where(np.arange(10) == 6, task.fixed, np.nan), slider=False)
    meets, found = as_given(alone, c, w, np.roll(c, 1), np.roll(w, 1))
    of = found[0, meets].imag
    return float(of[np.argmin(np.abs(of - task.fixed[7]))]) if len(of) else np.nan


def _squares(away: Complex) -> Floats:
    """Return the differences of the squares of distances (linkages, poses) from the first ones."""
    return np.asarray(((away - away[:, :1]) * np.conj(away + away[:, :1])).real[:, 1:])


def pairs_of(task: PathTask, dyads: Complex) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the linkages of all pairs of dyads, driven by the first of each, or of all with the sliders there are."""
    c, w = dyads
    if task.slider:
        turns = (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
        d, v = sliders_of(task, np.pi * turns, np.tan(1.4 * (2.0 * turns - 1.0) ** 3))
        first, other = (of.ravel() for of in np.indices((len(c), len(d))))
    else:
        d, v = c, w
        first, other = np.array(list(permutations(range(len(c)), 2)), dtype=int).reshape(-1, 2).T
    if np.isfinite(task.fixed).any():
        some = np.random.default_rng(0).permutation(len(first))[:MOVED]
        found = np.stack([c[first[some]], w[first[some]], d[other[some]], v[other[some]]])
        meets, moved = as_given(task, *found)
        if meets.any():  # else they are approached, see `found`
            key = np.round(moved[:, meets] / task.extent, 9)
            return linkages_of(task, *moved[:, meets][:, np.unique(key, axis=1, return_index=True)[1]])
    return linkages_of(task, c[first], w[first], d[other], v[other])


def varied(task: PathTask, pins: tuple[Complex, ...], change: float, rng: Any) -> tuple[Floats, ...]:
    """Return linkages that meet poses exactly, near others (their pins): both dyads are changed at random."""
    c, d, a, b, _ = pins
    e = np.exp(1j * task.angles)
    w, v = ((of[:, 0] - task.target[0]) / e[0] for of in (a, b))

    points, turns = (np.broadcast_to(of, (len(w), len(e))) for of in (task.target, e))

    def moved(centre: Complex, pin: Complex) -> tuple[Complex, Complex]:
        wide = change * (task.extent + np.abs(centre - task.target.mean()))
        x, y = wide * (rng.normal(size=(2, len(w))) + 1j * rng.normal(size=(2, len(w))))
        return _on_circles(points, turns, centre + x, pin + y, 8)

    c, w = moved(c, w)
    if not task.slider:
        d, v = moved(d, v)
    elif len(e) == 3:
        d, v = sliders_of(task, np.angle(d) + change * rng.normal(size=len(w)))
    elif len(e) == 2:
        v = v + change * task.extent * (rng.normal(size=len(w)) + 1j * rng.normal(size=len(w)))
        line = np.diff(points + turns * v[:, None])[:, 0]
        d = 1j * line / np.abs(line)
    if np.isfinite(task.fixed).any():
        meets, given = as_given(task, c, w, d, v)
        c, w, d, v = np.where(meets, given, [c, w, d, v])
    return linkages_of(task, c, w, d, v)


def solve_motion(task: PathTask, seed: int) -> tuple[Floats, Floats, Floats, Floats, int]:
    """Return the linkages of a motion as `pairs_of` does, and how many dyads with a crank they are made of."""
    if len(task.target) >= 5:
        dyads = dyads_of(task)
        found = pairs_of(task, dyads)
        return *(_on_poses(task, *found) if len(task.target) > 5 or task.slider else found), dyads.shape[1]
    dyads = family_of(task, seed)
    size, origin = task.extent, task.target.mean()
    crank = np.abs(task.target[0] + np.exp(1j * task.angles[0]) * dyads[1] - dyads[0])
    fine = (np.abs(dyads[0] - origin) < LONGEST * size) & (1e-3 * size < crank) & (crank < LONGEST * size)
    kept = dyads[:, fine]
    rng, most = np.random.default_rng(seed), PAIRED * (8 if task.slider and len(task.target) == 4 else 1)
    return *pairs_of(task, kept[:, rng.permutation(kept.shape[1])[:most]]), kept.shape[1]


def _on_poses(
    task: PathTask, numbers: Floats, theta: Floats, sides: Floats, bodies: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return linkages that come nearest to poses, from others, in places and in directions."""
    kept = np.zeros(len(numbers), dtype=bool)
    for row, x in enumerate(numbers):
        fit = Fit(task, theta[row], float(np.sign(sides[row].sum()) or 1.0))
        start = np.append(x[:9], bodies[row])
        if not np.isfinite(start).all() or not np.isfinite(theta[row]).all():
            continue
        best = least_squares(lambda v, fit=fit: fit(v)[0], start, lambda v, fit=fit: fit(v)[1], method="trf",
                             x_scale="jac", xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=300).x  # fmt: skip
        fit(best)
        kept[row] = (best[: 2 if task.slider else 4] > 0.0).all()
        numbers[row], bodies[row] = np.append(best[:9], 0.0), best[9]
        theta[row], sides[row] = fit.theta, fit.side
    return numbers[kept], theta[kept], sides[kept], bodies[kept]

"""Function generation: an output link that follows a function of the crank angle, with the least greatest error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from fastlink.synthesis.paths import solved, wrapped

__all__ = ["FunctionTask", "Generator", "chebyshev", "solve_function"]

Floats = NDArray[np.float64]

#: Start angles of each shaft that are tried, over half a turn (negative lengths are the other half); places of a
#: function in the scan, and in the refinement.
STARTS, PLACES, FINE = 120, 13, 81
#: Linkages that are refined by sums of powers of the errors, and then by linear programs.
MANY, FEW = 150, 10
#: The powers, and the steps with each.
POWERS, STEPS = (2, 4, 8, 16, 48), 8
#: Links are so many times as long as the ground link at most, and as short at least: the error alone may want an
#: infinite one, whose angle nobody could set.
LONGEST = 20.0
#: The most that a linear program may move a number, as a share of its size or of a radian, at first.
TRUST = 0.2


def chebyshev(low: float, high: float, count: int) -> Floats:
    """Return Chebyshev's spacing of precision points of a range."""
    k = np.arange(1, count + 1)
    return (low + high) / 2.0 - (high - low) / 2.0 * np.cos((2 * k - 1) * np.pi / (2 * count))


@dataclass(frozen=True)
class FunctionTask:
    """A function that was checked: the turns of both shafts from where they begin."""

    #: Turns of the crank at places, and of the output link there; the places of a table, or of a function some.
    turn_in: Floats
    turn_out: Floats
    #: The output turn of any input turn; None of a table.
    output: Callable[[Floats], Floats] | None = None
    #: The least acute transmission angle that is wanted between the first and the last place.
    transmission: float = 0.0
    #: Whether the places are precision points: no error there.
    exact: bool = False
    #: The senses of the output that are tried.
    senses: tuple[int, ...] = (1,)


@dataclass(frozen=True, eq=False)
class Generator:
    """A linkage that generates a function: K1, K2, K3, both start angles; the sign of its assembly mode; errors."""

    numbers: Floats
    sign: float
    sense: int
    #: The greatest error over the whole range, and where along the crank's turn the greatest ones are, with signs.
    error: float
    peaks: Floats
    errors: Floats

    def lengths(self) -> tuple[float, float, float, float]:
        """Return a1, a2, a3 for a ground of length 1, and 1."""
        k1, k2, k3 = self.numbers[:3]
        r2, r4 = 1.0 / k1, 1.0 / k2
        return abs(r2), float(np.sqrt(1.0 + r2 * r2 + r4 * r4 - 2.0 * r2 * r4 * k3)), abs(r4), 1.0

    def crank(self, turn: Floats) -> Floats:
        """Return the crank angle; a negative length means that the crank points the other way."""
        return np.asarray(self.numbers[3] + turn + (np.pi if self.numbers[0] < 0.0 else 0.0))


def _angles(numbers: Floats, sign: Any, turn: Floats) -> tuple[Floats, Floats]:
    """Return output and crank angles (linkages, places): K1 cos psi - K2 cos phi + K3 = cos(phi - psi)."""
    k1, k2, k3, phi0 = (numbers[:, k, None] for k in range(4))
    phi = phi0 + turn
    a, b, c = k1 - np.cos(phi), -np.sin(phi), k2 * np.cos(phi) - k3
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.arctan2(b, a) + sign * np.arccos(c / np.hypot(a, b)), phi


def _off(numbers: Floats, sign: Any, turn: Floats, wanted: Floats) -> Floats:
    """Return the errors of the output angle (linkages, places), NaN where the bars do not meet."""
    psi, _ = _angles(numbers, sign, turn)
    return wrapped(psi - numbers[:, 4, None] - wanted)


def _slopes(numbers: Floats, sign: Any, turn: Floats) -> Floats:
    """Return the derivatives of the errors (linkages, places, numbers)."""
    psi, phi = _angles(numbers, sign, turn)
    k1, k2 = numbers[:, 0, None], numbers[:, 1, None]
    with np.errstate(invalid="ignore", divide="ignore"):
        rate = -(k1 - np.cos(phi)) * np.sin(psi) - np.sin(phi) * np.cos(psi)
        by = [np.cos(psi), -np.cos(phi), np.ones_like(psi), np.sin(phi - psi) + k2 * np.sin(phi)]
        return np.stack([*(-one / rate for one in by), np.full_like(psi, -1.0)], axis=-1)


def _transmission(numbers: Floats, turn: Floats) -> Floats:
    """Return the least acute transmission angle (linkages) between the first and the last place."""
    r2, r4 = 1.0 / numbers[:, 0], 1.0 / numbers[:, 1]
    square = 1.0 + r2 * r2 + r4 * r4 - 2.0 * r2 * r4 * numbers[:, 2]
    first, last = numbers[:, 3] + turn.min(), numbers[:, 3] + turn.max()
    high = np.where(np.floor(last / (2 * np.pi)) != np.floor(first / (2 * np.pi)), 1.0, -1.0)
    half = np.floor((last - np.pi) / (2 * np.pi)) != np.floor((first - np.pi) / (2 * np.pi))
    ends = np.cos(first), np.cos(last)
    most, least = np.maximum(high, np.maximum(*ends)), np.where(half, -1.0, np.minimum(*ends))
    with np.errstate(invalid="ignore", divide="ignore"):
        at = [
            (square + r4 * r4 - 1.0 - r2 * r2 + 2.0 * r2 * c) / (2.0 * np.sqrt(square) * abs(r4))
            for c in (most, least)
        ]
        return np.asarray(np.arccos(np.minimum(np.maximum(abs(at[0]), abs(at[1])), 1.0)))


@np.errstate(all="ignore")
def freudenstein(phi: Floats, psi: Floats) -> tuple[Floats, Floats]:
    """Return for all pairs of start angles (pairs, places) the greatest error to first order, and the best K1, K2, K3.

    The least squares of K1 cos psi - K2 cos phi + K3 = cos(phi - psi) are weighed by the rate at which the output angle
    changes it; where that changes its sign the linkage would change its assembly mode, and the error is infinite.
    """
    difference = phi[:, None] - psi
    right, turn = np.cos(difference), np.sin(difference)
    x = np.ones((*right.shape, 3))
    x[..., 0], x[..., 1] = np.cos(psi), -np.cos(phi)[:, None]
    rate, fine = np.ones_like(right), np.ones(right.shape[:2], dtype=bool)
    for _ in range(3):
        weighted = x / (rate * rate)[..., None]
        matrices, sides = weighted.swapaxes(2, 3) @ x, (weighted * right[..., None]).sum(axis=2)
        k = solved(matrices.reshape(-1, 3, 3), sides.reshape(-1, 3)).reshape(*fine.shape, 3)
        off = (x @ k[..., None])[..., 0] - right
        rate = -k[..., :1] * np.sin(psi) - turn
        fine &= (rate * rate[..., :1] > 0.0).all(axis=2)
    r2, r4 = 1.0 / k[..., 0], 1.0 / k[..., 1]
    fine &= (1.0 + r2 * r2 + r4 * r4 - 2.0 * r2 * r4 * k[..., 2] > 0.0) & (abs(r2) < 1e3) & (abs(r4) < 1e3)
    return np.where(fine, np.abs(off / rate).max(axis=2), np.inf), k


def _scanned(task: FunctionTask, sense: int) -> tuple[Floats, Floats]:
    """Return start values and their signs: the best places of the scan, each better than its neighbours."""
    count = min(PLACES, len(task.turn_in))
    places = np.unique(np.linspace(0, len(task.turn_in) - 1, count).round().astype(int))
    if task.output is not None and not task.exact:
        turn = chebyshev(task.turn_in[0], task.turn_in[-1], PLACES)
        wanted = sense * task.output(turn)
    else:
        turn, wanted = task.turn_in[places], sense * task.turn_out[places]
    starts = np.pi * np.arange(STARTS) / STARTS
    error, ratios = freudenstein(starts[:, None] + turn, starts[:, None] + wanted)
    least = np.ones_like(error, dtype=bool)
    for shift in ((0, 1), (1, 0), (1, 1), (1, -1)):
        for side in (1, -1):
            least &= error <= np.roll(error, (side * shift[0], side * shift[1]), (0, 1))
    rows = np.flatnonzero(least & np.isfinite(error))
    if task.transmission or task.exact:  # the least errors may have bad angles: all places count
        rows = np.union1d(rows, np.flatnonzero(np.isfinite(error))[::37])
    i, k = np.unravel_index(rows, error.shape)
    numbers = np.column_stack([ratios[i, k], starts[i], starts[k]])
    if task.transmission:
        fine = _transmission(numbers, turn) > 0.6 * task.transmission
        numbers, rows = numbers[fine], rows[fine]
    fine = _is_built(numbers)
    numbers, rows = numbers[fine], rows[fine]
    numbers = numbers[np.argsort(error.reshape(-1)[rows], kind="stable")[:MANY]]
    off = [
        np.nanmax(np.abs(np.nan_to_num(_off(numbers, s, turn, wanted), nan=9.0)), axis=1) for s in (1.0, -1.0)
    ]
    return numbers, np.where(off[0] <= off[1], 1.0, -1.0)


def _is_built(numbers: Floats) -> NDArray[np.bool_]:
    """Tell which linkages (linkages, numbers) have links of usable lengths."""
    with np.errstate(all="ignore"):
        r2, r4 = 1.0 / numbers[:, 0], 1.0 / numbers[:, 1]
        lengths = np.stack(
            [np.abs(r2), np.sqrt(1.0 + r2 * r2 + r4 * r4 - 2.0 * r2 * r4 * numbers[:, 2]), np.abs(r4)]
        )
        return np.asarray(((lengths <= LONGEST * 1.000001) & (lengths >= 0.999999 / LONGEST)).all(axis=0))


def _by_powers(
    numbers: Floats, sign: Floats, turn: Floats, wanted: Floats, powers: tuple[int, ...]
) -> Floats:
    """Return linkages after damped least squares towards the least sum of powers of the errors, all at once."""
    side, damping = sign[:, None], np.full(len(numbers), 1e-3)

    def norm(of: Floats, power: int, scale: Floats) -> Floats:
        return np.asarray(np.nan_to_num(np.sum((np.abs(of) / scale) ** power, axis=1), nan=np.inf))

    for power in powers:
        off = _off(numbers, side, turn, wanted)
        for _ in range(STEPS if power > 2 else 2 * STEPS):
            scale = np.nanmax(np.abs(off), axis=1, keepdims=True) + 1e-300
            with np.errstate(all="ignore"):
                weights = (np.abs(off) / scale) ** (power - 2)
            j = _slopes(numbers, side, turn)
            bad = np.asarray(~np.isfinite(j).all(axis=(1, 2)) | ~np.isfinite(off).all(axis=1))
            j[bad], off_now = 0.0, np.where(bad[:, None], 0.0, off)
            h = np.einsum("mp,mpa,mpb->mab", weights * (1.0 if power == 2 else power - 1.0), j, j)
            g = np.einsum("mp,mpa,mp->ma", weights, j, off_now)
            diagonal = np.einsum("maa->ma", h)
            h = h + np.einsum("ma,ab->mab", damping[:, None] * diagonal + 1e-30, np.eye(5))
            step = np.linalg.solve(h, -g[..., None])[..., 0]
            moved = numbers + np.clip(step, -0.3 * (1 + abs(numbers)), 0.3 * (1 + abs(numbers)))
            with np.errstate(all="ignore"):
                other = _off(moved, side, turn, wanted)
                other[~_is_built(moved)] = np.nan
                better = norm(other, power, scale) < norm(off, power, scale)
            numbers = np.where(better[:, None], moved, numbers)
            off = np.where(better[:, None], other, off)
            damping = np.where(better, damping * 0.2, damping * 5.0).clip(1e-14, 1e8)
    return numbers


def peaks_of(task: FunctionTask, numbers: Floats, sign: float, sense: int) -> tuple[Floats, Floats]:
    """Return where the error has extremes along the crank's turn, the ends among them, and the errors there.

    Each is enclosed by places, and found by parabolas through three of them, ever nearer: the error is flat there.
    """
    if task.output is None:
        return task.turn_in, _off(numbers[None], sign, task.turn_in, sense * task.turn_out)[0]
    output = task.output

    def error(turn: Floats) -> Floats:
        return np.asarray(_off(numbers[None], sign, turn, sense * output(turn))[0])

    places = np.linspace(task.turn_in[0], task.turn_in[-1], 2 * FINE + 1)
    known = error(places)
    inner = np.flatnonzero((known[1:-1] - known[:-2]) * (known[2:] - known[1:-1]) <= 0.0) + 1
    at, step = places[inner], places[1] - places[0]
    for _ in range(3):
        one, two, three = (
            error(np.clip(at + side * step, places[0], places[-1])) for side in (-1.0, 0.0, 1.0)
        )
        bend = one - 2.0 * two + three
        with np.errstate(all="ignore"):
            shift = np.nan_to_num(0.5 * (one - three) / bend, posinf=0.0, neginf=0.0)
        at = np.clip(at + step * np.clip(shift, -1.0, 1.0), places[0], places[-1])
        step *= 0.05
    found = np.concatenate([places[:1], at, places[-1:]])
    return found, error(found)


def _minimax(task: FunctionTask, numbers: Floats, sign: float, sense: int, aim: float) -> Generator | None:
    """Return the linkage with the least greatest error near a start: linear programs on the peaks of its error.

    What gains little and stays above twice the aim is given up.
    """
    turn, wanted = task.turn_in, sense * task.turn_out
    if task.output is not None:
        turn = np.linspace(task.turn_in[0], task.turn_in[-1], FINE)
        wanted = sense * task.output(turn)
    peaks, errors = peaks_of(task, numbers, sign, sense)
    best, trust = float(np.max(np.abs(errors))), TRUST
    if not np.isfinite(best):
        return None
    low = task.transmission

    def short(of: Floats) -> float:
        return max(0.0, low - float(_transmission(of[None], turn)[0]))

    merit = best + short(numbers)
    for _ in range(30):
        some = np.linspace(0, len(turn) - 1, 25).astype(int)
        places = np.concatenate([peaks, turn[some]]) if task.output is not None else turn
        now = (
            np.concatenate([errors, _off(numbers[None], sign, turn[some], wanted[some])[0]])
            if task.output is not None
            else errors
        )
        j = _slopes(numbers[None], sign, places)[0]
        one = np.ones((len(places), 1))
        rows, right = [np.hstack([j, -one]), np.hstack([-j, -one])], [-now, now]
        if low:
            at = float(_transmission(numbers[None], turn)[0])
            h = 1e-7 * (1.0 + np.abs(numbers))
            ends = [_transmission(numbers + np.diag(side * h), turn) for side in (1.0, -1.0)]
            by = (ends[0] - ends[1]) / (2.0 * h)
            if np.isfinite(by).all():
                rows.append(np.append(-by, 0.0)[None])
                right.append(np.array([at - low if at >= low or trust < 1e-3 else 0.5 * (at - low)]))
        reach = trust * (1.0 + np.abs(numbers))
        lower, upper = -reach, reach
        for k in (0, 1):  # K1 and K2 keep their signs and sizes
            ends = np.sort(np.sign(numbers[k]) * np.array([1.0 / LONGEST, LONGEST])) - numbers[k]
            lower[k], upper[k] = max(lower[k], min(ends[0], 0.0)), min(upper[k], max(ends[1], 0.0))
        scale = best or 1.0
        matrix = np.vstack(rows) * np.append(np.ones(5), scale)
        program = linprog(np.append(np.zeros(5), 1.0), matrix / scale, np.concatenate(right) / scale,
                          bounds=[*zip(lower, upper, strict=True), (0.0, None)], method="highs")  # fmt: skip
        if program.x is None:
            trust *= 0.3
            if trust < 1e-9:
                break
            continue
        moved = numbers + program.x[:5]
        where, there = peaks_of(task, moved, sign, sense)
        other = float(np.max(np.abs(there))) + (short(moved) if low else 0.0)
        other = other if _is_built(moved[None])[0] else np.inf
        if other < merit:
            gain = (merit - other) / merit
            if gain < 0.02 and other > 2.0 * aim:
                break
            numbers, peaks, errors, merit = moved, where, there, other
            best = float(np.max(np.abs(errors)))
            trust = min(2.0 * trust, TRUST)
            if gain < 1e-8:
                break
        else:
            trust *= 0.25
            if trust < 1e-11:
                break
    if low and short(numbers) > 1e-9:
        return None
    keep = np.abs(errors) > 0.2 * best
    return Generator(numbers, sign, sense, best, peaks[keep], errors[keep])


def solve_function(task: FunctionTask, few: int = FEW) -> list[Generator]:
    """Return linkages that generate a function, all different ones that were found, the best first."""
    starts: list[tuple[float, Floats, float, int]] = []
    for sense in task.senses:
        numbers, sign = _scanned(task, sense)
        if not len(numbers):
            continue
        turn, wanted = task.turn_in, sense * task.turn_out
        if task.output is not None and not task.exact:
            turn = np.linspace(task.turn_in[0], task.turn_in[-1], FINE)
            wanted = sense * task.output(turn)
        numbers = _by_powers(numbers, sign, turn, wanted, (2,) if task.exact else POWERS)
        with np.errstate(invalid="ignore"):
            worst = np.max(np.abs(_off(numbers, sign[:, None], turn, wanted)), axis=1)
        if task.transmission:
            worst = worst + 0.2 * np.maximum(0.0, task.transmission - _transmission(numbers, turn))
        rows = np.flatnonzero(np.isfinite(worst))
        starts += [(float(worst[k]), numbers[k], float(sign[k]), sense) for k in rows]
    found: list[Generator] = []
    tried: list[tuple[Floats, float, int]] = []
    aim = np.inf
    for worst_of, one, side, sense in sorted(starts, key=lambda start: start[0]):
        if _is_known(tried, (one, side, sense), 1e-3):
            continue
        tried.append((one, side, sense))
        if task.exact:
            off = _off(one[None], side, task.turn_in, sense * task.turn_out)[0]
            if worst_of < 1e-9:
                found.append(Generator(one, side, sense, worst_of, task.turn_in, off))
        elif (best := _minimax(task, one, side, sense, aim)) is not None:
            found.append(best)
            aim = min(aim, best.error)
        if len(tried) == few and not task.exact:
            break
    found.sort(key=lambda one: one.error)
    distinct: list[Generator] = []
    for made in found:
        known = [(k.numbers, k.sign, k.sense) for k in distinct]
        if not _is_known(known, (made.numbers, made.sign, made.sense), 1e-5):
            distinct.append(made)
    return distinct


def _is_known(
    known: list[tuple[Floats, float, int]], one: tuple[Floats, float, int], tolerance: float
) -> bool:
    """Tell whether a linkage is one of some."""
    return any(
        (np.abs(_wrapped(one[0] - other[0])) < tolerance * (1.0 + np.abs(one[0]))).all()
        and one[1:] == other[1:]
        for other in known
    )


def _wrapped(numbers: Floats) -> Floats:
    """Return differences of numbers, those of angles within half a turn."""
    turned = numbers.copy()
    turned[..., 3:] = wrapped(turned[..., 3:])
    return turned

"""Function generation: an output that follows a function of the crank angle, with the least greatest error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from fastlink.synthesis.paths import solved, transmission, wrapped

__all__ = ["FunctionTask", "Generator", "chebyshev", "solve_function"]

Floats = NDArray[np.float64]

#: Start angles of each shaft that are tried, over half a turn (negative lengths are the other half); places of a
#: function in the scan, and in the refinement.
STARTS, PLACES, FINE = 120, 13, 81
#: Turns of a shaft that are tried where a range is given.
SCALES = 3
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
    """A function that was checked: the turns of both shafts from where they begin, or the travel of a slider.

    A linkage is K1, K2, K3, the crank angle and the output where they begin, and by how much the given turns are
    multiplied. K1 cos psi - K2 cos phi + K3 = cos(phi - psi) is the equation of four bars, K1 x cos phi + K2 sin phi
    + K3 = x^2 that of a slider-crank: K1 = 2 r, K2 = 2 r e, K3 = l^2 - r^2 - e^2, for a travel of 1.
    """

    #: Turns of the crank at places, and of the output link there; the places of a table, or of a function some.
    turn_in: Floats
    turn_out: Floats
    #: The output turn of any input turn; None of a table.
    output: Callable[[Floats], Floats] | None = None
    #: Whether the places are precision points: no error there.
    exact: bool = False
    #: The senses of the output that are tried.
    senses: tuple[int, ...] = (1,)
    #: Whether the output is a slider's.
    slider: bool = False
    #: By how much both turns may be multiplied.
    scales: tuple[tuple[float, float], tuple[float, float]] = ((1.0, 1.0), (1.0, 1.0))
    #: By how much linkages (linkages, numbers) of a sense meet further conditions (linkages, conditions).
    limits: Callable[[Floats, int], Floats] | None = None

    @property
    def free(self) -> NDArray[np.int64]:
        """Which numbers of a linkage are free."""
        return np.array([*range(5), *(5 + k for k, (low, high) in enumerate(self.scales) if low < high)])

    def fine(self, sense: int) -> tuple[Floats, Floats]:
        """Return the places of a refinement, and the output there."""
        if self.output is None or self.exact:
            return self.turn_in, sense * self.turn_out
        turn = np.linspace(self.turn_in[0], self.turn_in[-1], FINE)
        return turn, sense * self.output(turn)

    def lengths(self, numbers: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the crank, the square of the coupler, and the output link or the offset; signed."""
        k1, k2, k3 = (numbers[..., k] for k in range(3))
        with np.errstate(all="ignore"):
            if self.slider:
                r, e = k1 / 2.0, k2 / k1
                return r, k3 + r * r + e * e, e
            r2, r4 = 1.0 / k1, 1.0 / k2
            return r2, 1.0 + r2 * r2 + r4 * r4 - 2.0 * r2 * r4 * k3, r4

    def is_built(self, numbers: Floats) -> NDArray[np.bool_]:
        """Tell which linkages (linkages, numbers) have links of usable lengths."""
        crank, square, last = self.lengths(numbers)
        with np.errstate(invalid="ignore"):
            lengths = np.stack([np.abs(crank), np.sqrt(square), np.abs(last)])
        short = lengths[: 2 if self.slider else 3] >= 0.999999 / LONGEST
        return np.asarray(short.all(axis=0) & (lengths <= LONGEST * 1.000001).all(axis=0))

    def rates(self, numbers: Floats, phi: Floats, out: Floats) -> tuple[Floats, Floats]:
        """Return the derivatives of the equation by the output and by the crank angle."""
        k1, k2 = numbers[..., :1], numbers[..., 1:2]
        if self.slider:
            return k1 * np.cos(phi) - 2.0 * out, k2 * np.cos(phi) - k1 * out * np.sin(phi)
        turn = np.sin(phi - out)
        return -k1 * np.sin(out) - turn, k2 * np.sin(phi) + turn

    def terms(self, phi: Floats, out: Floats) -> tuple[Floats, Floats]:
        """Return the factors of K1, K2, K3, and what the equation has on its right."""
        right = out * out + 0.0 * phi if self.slider else np.cos(phi - out)
        x = np.ones((*right.shape, 3))
        if self.slider:
            x[..., 0], x[..., 1] = out * np.cos(phi), np.sin(phi)
        else:
            x[..., 0], x[..., 1] = np.cos(out), -np.cos(phi)
        return x, right

    def outputs(self, numbers: Floats, sign: Any, turn: Floats) -> tuple[Floats, Floats]:
        """Return outputs and crank angles (linkages, places); NaN where the bars do not meet."""
        k1, k2, k3 = (numbers[:, k, None] for k in range(3))
        phi = numbers[:, 3, None] + numbers[:, 5, None] * turn
        with np.errstate(invalid="ignore", divide="ignore"):
            if self.slider:
                half = 0.5 * k1 * np.cos(phi)
                return half + sign * np.sqrt(half * half + (k2 * np.sin(phi) + k3)), phi
            a, b, c = k1 - np.cos(phi), -np.sin(phi), k2 * np.cos(phi) - k3
            return np.arctan2(b, a) + sign * np.arccos(c / np.hypot(a, b)), phi

    def off(self, numbers: Floats, sign: Any, turn: Floats, wanted: Floats) -> Floats:
        """Return the errors of the output (linkages, places) by its scale, NaN where the bars do not meet."""
        out, scale = self.outputs(numbers, sign, turn)[0] - numbers[:, 4, None], numbers[:, 6, None]
        off = out - scale * wanted
        return np.asarray((off if self.slider else wrapped(off)) / scale)

    def slopes(self, numbers: Floats, sign: Any, turn: Floats, wanted: Floats) -> Floats:
        """Return the derivatives of the errors (linkages, places, free numbers)."""
        out, phi = self.outputs(numbers, sign, turn)
        x, _ = self.terms(phi, out)
        rate, by_phi = self.rates(numbers, phi, out)
        made, scale = np.empty((*out.shape, 7)), numbers[:, 6, None, None]
        with np.errstate(invalid="ignore", divide="ignore"):
            made[..., :3], made[..., 3], made[..., 4] = -x / rate[..., None], -by_phi / rate, -1.0
            made[..., 5] = made[..., 3] * turn
            made[..., 6] = -wanted - self.off(numbers, sign, turn, wanted)
            return np.asarray((made / scale)[..., self.free])

    def transmissions(self, numbers: Floats) -> Floats:
        """Return the least acute transmission angle (linkages) between the first and the last place."""
        crank, square, last = self.lengths(numbers)
        ends = numbers[:, 3:4] + numbers[:, 5:6] * self.turn_in[[0, -1]]
        with np.errstate(invalid="ignore"):
            rod = np.sqrt(square)
        return transmission(crank, rod, last, 1.0, ends, np.False_, self.slider)[0]

    def short(self, numbers: Floats, sense: int) -> Floats:
        """Return by how much linkages (linkages, numbers) miss their conditions."""
        return np.asarray(np.maximum(0.0, -self.slack(numbers, sense)).sum(axis=1))

    def slack(self, numbers: Floats, sense: int) -> Floats:
        """Return by how much linkages (linkages, numbers) meet their conditions (linkages, conditions)."""
        if self.limits is None:
            return np.zeros((len(numbers), 0))
        return np.nan_to_num(self.limits(numbers, sense), nan=-1.0)

    def built(self, numbers: Floats, sense: Any, turn: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Return lengths (linkages, 4), crank angles and outputs wanted at places (linkages, places), sides of B."""
        crank, square, last = self.lengths(numbers)
        lengths = [np.abs(crank), np.sqrt(square), last if self.slider else np.abs(last), 0.0 * crank]
        lengths[3] += not self.slider
        # a negative length means that a link points the other way
        theta = numbers[:, 3:4] + numbers[:, 5:6] * turn[0] + np.pi * (numbers[:, :1] < 0.0)
        out = numbers[:, 4:5] + np.reshape(sense, (-1, 1)) * numbers[:, 6:7] * turn[1]
        pin, far = lengths[0][:, None] * np.exp(1j * theta), 1j
        if self.slider:
            b = out + 1j * last[:, None]
        else:
            out = out + np.pi * (numbers[:, 1:2] < 0.0)
            far, b = 1.0 - pin, 1.0 + lengths[2][:, None] * np.exp(1j * out)
        return np.stack(lengths, axis=1), theta, out, np.sign((np.conj(far) * (b - pin)).imag)

    @np.errstate(all="ignore")
    def ratios(self, phi: Floats, out: Floats) -> tuple[Floats, Floats]:
        """Return for all pairs of starts (pairs, places) the greatest error to first order, and the best K1, K2, K3.

        The least squares of the equation are weighed by the rate at which the output changes it; where that changes its
        sign the linkage would change its assembly mode, and the error is infinite.
        """
        x, right = self.terms(phi[:, None], out)
        rate, fine = np.ones_like(right), np.ones(right.shape[:2], dtype=bool)
        for _ in range(3):
            weighted = x / (rate * rate)[..., None]
            matrices, sides = weighted.swapaxes(2, 3) @ x, (weighted * right[..., None]).sum(axis=2)
            k = solved(matrices.reshape(-1, 3, 3), sides.reshape(-1, 3)).reshape(*fine.shape, 3)
            off = (x @ k[..., None])[..., 0] - right
            rate, _ = self.rates(k, phi[:, None], out)
            fine &= (rate * rate[..., :1] > 0.0).all(axis=2)
        crank, square, last = self.lengths(k)
        fine &= (square > 0.0) & (abs(crank) < 1e3) & (abs(last) < 1e3)
        return np.where(fine, np.abs(off / rate).max(axis=2), np.inf), k


@dataclass(frozen=True, eq=False)
class Generator:
    """A linkage that generates a function, and the sign of its assembly mode; errors."""

    numbers: Floats
    sign: float
    sense: int
    #: The greatest error over the whole range, and where along the crank's turn the greatest ones are, with signs.
    error: float
    peaks: Floats
    errors: Floats


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
    outs = np.tan(starts - 0.5 * np.pi * (1.0 - 1.0 / STARTS)) if task.slider else starts
    parts, errors = [], []
    for scales in product(*(np.linspace(*ends, SCALES if ends[0] < ends[1] else 1) for ends in task.scales)):
        phi, out = starts[:, None] + scales[0] * turn, outs[:, None] + scales[1] * wanted
        error, ratios = task.ratios(phi, out)
        least = np.ones_like(error, dtype=bool)
        for shift in ((0, 1), (1, 0), (1, 1), (1, -1)):
            for side in (1, -1):
                least &= error <= np.roll(error, (side * shift[0], side * shift[1]), (0, 1))
        rows = np.flatnonzero(least & np.isfinite(error))
        if task.limits or task.exact:  # the least errors may have bad angles: all places count
            rows = np.union1d(rows, np.flatnonzero(np.isfinite(error))[::37])
        i, k = np.unravel_index(rows, error.shape)
        parts.append(np.column_stack([ratios[i, k], starts[i], outs[k], np.tile(scales, (len(rows), 1))]))
        errors.append(error[i, k] / scales[1])
    numbers, found = np.concatenate(parts), np.concatenate(errors)
    fine, short = task.is_built(numbers), task.short(numbers, sense)
    numbers = numbers[fine][np.argsort((found + 0.2 * short)[fine], kind="stable")[:MANY]]
    both = (np.nan_to_num(task.off(numbers, side, turn, wanted), nan=9.0) for side in (1.0, -1.0))
    off = [np.abs(one).max(axis=1) for one in both]
    return numbers, np.where(off[0] <= off[1], 1.0, -1.0)


def _by_powers(task: FunctionTask, numbers: Floats, sign: Floats, sense: int) -> Floats:
    """Return linkages after damped least squares towards the least sum of powers of the errors, all at once."""
    side, damping, free = sign[:, None], np.full(len(numbers), 1e-3), task.free
    (turn, wanted), (low, high) = task.fine(sense), np.transpose(task.scales)
    short = task.short(numbers, sense)

    def norm(of: Floats, power: int, scale: Floats) -> Floats:
        return np.asarray(np.nan_to_num(np.sum((np.abs(of) / scale) ** power, axis=1), nan=np.inf))

    for power in (2,) if task.exact else POWERS:
        off = task.off(numbers, side, turn, wanted)
        for _ in range(STEPS if power > 2 else 2 * STEPS):
            scale = np.nanmax(np.abs(off), axis=1, keepdims=True) + 1e-300
            with np.errstate(all="ignore"):
                weights = (np.abs(off) / scale) ** (power - 2)
            j = task.slopes(numbers, side, turn, wanted)
            bad = np.asarray(~np.isfinite(j).all(axis=(1, 2)) | ~np.isfinite(off).all(axis=1))
            j[bad], off_now = 0.0, np.where(bad[:, None], 0.0, off)
            h = np.einsum("mp,mpa,mpb->mab", weights * (1.0 if power == 2 else power - 1.0), j, j)
            g = np.einsum("mp,mpa,mp->ma", weights, j, off_now)
            diagonal = np.einsum("maa->ma", h)
            h = h + np.einsum("ma,ab->mab", damping[:, None] * diagonal + 1e-30, np.eye(len(free)))
            step, reach = np.linalg.solve(h, -g[..., None])[..., 0], 0.3 * (1 + abs(numbers[:, free]))
            moved = numbers.copy()
            moved[:, free] += np.clip(step, -reach, reach)
            moved[:, 5:] = np.clip(moved[:, 5:], low, high)
            with np.errstate(all="ignore"):
                other = task.off(moved, side, turn, wanted)
                other[~task.is_built(moved)] = np.nan
                missed = task.short(moved, sense)
                other[missed > short] = np.nan  # conditions that are met stay so
                better = norm(other, power, scale) < norm(off, power, scale)
            numbers = np.where(better[:, None], moved, numbers)
            off, short = np.where(better[:, None], other, off), np.where(better, missed, short)
            damping = np.where(better, damping * 0.2, damping * 5.0).clip(1e-14, 1e8)
    return numbers


def peaks_of(task: FunctionTask, numbers: Floats, sign: float, sense: int) -> tuple[Floats, Floats]:
    """Return where the error has extremes along the crank's turn, the ends among them, and the errors there.

    Each is enclosed by places, and found by parabolas through three of them, ever nearer: the error is flat there.
    """
    if task.output is None:
        return task.turn_in, task.off(numbers[None], sign, task.turn_in, sense * task.turn_out)[0]
    output = task.output

    def error(turn: Floats) -> Floats:
        return np.asarray(task.off(numbers[None], sign, turn, sense * output(turn))[0])

    places = np.linspace(task.turn_in[0], task.turn_in[-1], 2 * FINE + 1)
    known = error(places)
    inner = np.flatnonzero((known[1:-1] - known[:-2]) * (known[2:] - known[1:-1]) <= 0.0) + 1
    at, step = places[inner], places[1] - places[0]
    for _ in range(3):
        beside = (np.clip(at + side * step, places[0], places[-1]) for side in (-1.0, 0.0, 1.0))
        one, two, three = map(error, beside)
        bend = one - 2.0 * two + three
        with np.errstate(all="ignore"):
            shift = np.nan_to_num(0.5 * (one - three) / bend, posinf=0.0, neginf=0.0)
        at = np.clip(at + step * np.clip(shift, -1.0, 1.0), places[0], places[-1])
        step *= 0.05
    found = np.concatenate([places[:1], at, places[-1:]])
    return found, error(found)


def _minimax(task: FunctionTask, numbers: Floats, sign: float, sense: int, aim: float) -> tuple[Any, ...]:
    """Return the linkage with the least greatest error near a start: linear programs on the peaks of its error.

    As its numbers, the error, where its peaks are and they; nothing where there is none.

    What gains little and stays above twice the aim is given up.
    """
    (turn, wanted), free = task.fine(sense), task.free
    peaks, errors = peaks_of(task, numbers, sign, sense)
    best, trust = float(np.max(np.abs(errors))), TRUST
    if not np.isfinite(best):
        return ()
    merit = best + float(task.short(numbers[None], sense)[0])
    for _ in range(30):
        places, aims, now = turn, wanted, errors
        if task.output is not None:  # between the peaks, too
            some = np.linspace(0, len(turn) - 1, 25).astype(int)
            places = np.concatenate([peaks, turn[some]])
            aims = np.concatenate([sense * task.output(peaks), wanted[some]])
            now = np.append(errors, task.off(numbers[None], sign, turn[some], wanted[some])[0])
        j = task.slopes(numbers[None], sign, places, aims)[0]
        one = np.ones((len(places), 1))
        rows, right = [np.hstack([j, -one]), np.hstack([-j, -one])], [-now, now]
        reach, h = trust * (1.0 + np.abs(numbers)), 1e-7 * (1.0 + np.abs(numbers))
        if len(slack := task.slack(numbers[None], sense)[0]):
            ends = [task.slack(numbers + np.diag(side * h), sense) for side in (1.0, -1.0)]
            by = ((ends[0] - ends[1]) / (2.0 * h[:, None]))[free].T
            # what is missed is to be missed by half, or by half of what a step can do
            nearer = np.minimum(-slack * (1.0 if trust < 1e-3 else 0.5), 0.5 * np.abs(by) @ reach[free])
            rows.append(np.hstack([-by, 0.0 * by[:, :1]]))
            right.append(np.where(slack >= 0.0, slack, -nearer))
        lower, upper, kept = -reach, reach, {5 + k: np.array(ends) for k, ends in enumerate(task.scales)}
        # K1 keeps its sign and size, and so does K2 of four bars
        for k, least in ((0, 2.0),) if task.slider else ((0, 1.0), (1, 1.0)):
            kept[k] = np.sort(np.sign(numbers[k]) * least * np.array([1.0 / LONGEST, LONGEST]))
        for k, end in kept.items():
            lower[k] = max(lower[k], min(end[0] - numbers[k], 0.0))
            upper[k] = min(upper[k], max(end[1] - numbers[k], 0.0))
        scale, aim_of = best or 1.0, np.append(np.zeros(len(free)), 1.0)
        matrix = np.vstack(rows) * np.where(aim_of > 0.0, scale, 1.0)
        program = linprog(aim_of, matrix / scale, np.concatenate(right) / scale, method="highs",
                          bounds=[*zip(lower[free], upper[free], strict=True), (0.0, None)])  # fmt: skip
        if program.x is None:
            trust *= 0.3
            if trust < 1e-9:
                break
            continue
        moved = numbers.copy()
        moved[free] += program.x[:-1]
        where, there = peaks_of(task, moved, sign, sense)
        other = float(np.max(np.abs(there))) + float(task.short(moved[None], sense)[0])
        other = other if task.is_built(moved[None])[0] else np.inf
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
    if task.short(numbers[None], sense)[0] > 1e-9:
        return ()
    keep, scale = np.abs(errors) > 0.2 * best, float(numbers[6])
    return numbers, scale * best, peaks[keep], scale * errors[keep]


def _started(task: FunctionTask, sense: int) -> tuple[Floats, Floats, Floats]:
    """Return linkages of the scan after least sums of powers, their signs and greatest errors."""
    numbers, sign = _scanned(task, sense)
    if len(numbers):
        numbers = _by_powers(task, numbers, sign, sense)
    with np.errstate(invalid="ignore"):
        worst = np.max(np.abs(task.off(numbers, sign[:, None], *task.fine(sense))), axis=1)
    return numbers, sign, worst + 0.2 * task.short(numbers, sense)


def solve_function(task: FunctionTask, steps: Any, few: int) -> list[Generator]:
    """Return linkages that generate a function, all different ones that were found, the best first."""
    starts: list[tuple[float, Floats, float, int]] = []
    for sense in task.senses:
        numbers, sign, worst = steps(_started, task, sense)
        rows = np.flatnonzero(np.isfinite(worst))
        starts += [(float(worst[k]), numbers[k], float(sign[k]), sense) for k in rows]
    found: list[Generator] = []
    tried: list[Floats] = []
    aim = np.inf
    for worst_of, one, side, sense in sorted(starts, key=lambda start: start[0]):
        if not _is_new(tried, np.append(one, [side, sense]), 1e-3):
            continue
        if task.exact:
            off = task.off(one[None], side, task.turn_in, sense * task.turn_out)[0]
            if worst_of < 1e-9:
                found.append(Generator(one, side, sense, worst_of, task.turn_in, off))
        elif made := steps(_minimax, task, one, side, sense, aim):
            best = Generator(made[0], side, sense, float(made[1]), *made[2:])
            found.append(best)
            aim = min(aim, best.error / best.numbers[6])
        if len(tried) == few and not task.exact:
            break
    known: list[Floats] = []
    found.sort(key=lambda one: one.error / one.numbers[6])
    return [one for one in found if _is_new(known, np.append(one.numbers, [one.sign, one.sense]), 1e-5)]


def _is_new(known: list[Floats], one: Floats, tolerance: float) -> bool:
    """Tell whether a row of a linkage is none of those that are known, and count it among them."""
    off = np.array(known).reshape(-1, len(one)) - one
    off[:, 3:5] = wrapped(off[:, 3:5])
    if (np.abs(off) < tolerance * (1.0 + np.abs(one))).all(axis=1).any():
        return False
    known.append(one)
    return True

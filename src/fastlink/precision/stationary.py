"""Find every extreme of a quantity by fine samples, and refine it with 50 digits.

Positions are those of the graded range (see `fastlink.facts.fact.GradedRange`): a signed number x counted from the
lower or the upper end, where rho = x^2 is the ratio of the distances to both ends and the sign tells the side. The
search shares nothing with that of the kernels but the facts: eight times as many samples, then subdivision, then
Newton's iteration on differences with 50 digits.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.facts.arc import ARC, ARC_FACTS, AT_ENDS
from fastlink.facts.catalogue import Catalogue
from fastlink.facts.evaluate import read_facts
from fastlink.facts.names import derivative_name, signed
from fastlink.numerics.vectors import as_given
from fastlink.precision.reference import CONTEXT, DIGITS, STEP, HighPrecision

if TYPE_CHECKING:
    from numpy.typing import NDArray


# -- Signs of slopes at samples: by doubles, and with many digits wherever a change of sign rests on them

# Beside a fold, and of what is constant, a slope in doubles is nothing but its rounding error: its changes
# of sign look like extremes. All precisions evaluate the same facts: where doubles and 50 digits agree,
# neither is noise, which is 2^115 times as great in doubles. Elsewhere further digits tell.


#: Two precisions agree to this share of a slope.
AGREE = 0.25
#: Further digits, no multiple of 50: noise may be a product of errors, as great with twice as many digits.
FURTHER = 137


def side_of(doubles: float, slope: Callable[[], Any]) -> float:
    """Return the sign of a slope, 0 where it is nothing but noise."""
    exact = slope()
    if exact != exact or not np.isfinite(doubles):
        return float(np.sign(doubles))
    if abs(exact - doubles) < AGREE * abs(exact):
        return float(np.sign(doubles))
    with CONTEXT.workdps(FURTHER):
        finer = slope()
        sure = abs(exact - finer) < AGREE * abs(finer)
    return (float(finer > 0) - float(finer < 0)) if sure else 0.0


def turning_cells(
    sides: NDArray[Any], apart: NDArray[Any], exactly: Callable[[int, int, int], float]
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the cells between whose ends a slope changes its sign, and the signs."""
    sides, known = sides.copy(), np.zeros(sides.shape, dtype=bool)
    last = sides.shape[-1] - 1
    while True:
        filled = _filled(sides)
        turning = ~apart & (filled[..., 1:] * filled[..., :-1] < 0.0)
        doubtful = np.zeros_like(known)
        doubtful[..., 1:] |= turning
        doubtful[..., :-1] |= turning
        doubtful &= ~known
        if not doubtful.any():
            return turning, filled
        for design, end, sample in np.argwhere(doubtful).tolist():
            ends = slice(None) if sample in (0, last) else end
            sides[design, ends, sample] = exactly(design, end, sample)
            known[design, ends, sample] = True


def _filled(sides: NDArray[Any]) -> NDArray[Any]:
    """Return signs without zeros: of the sample before on the way from the middle of the range to an end."""
    filled = sides.copy()
    # Both ends are counted from one position; a zero of the slope there belongs to one of them.
    seam = np.where(filled[:, 0, [0, -1]] == 0.0, filled[:, 0, [1, -2]], filled[:, 0, [0, -1]])
    filled[:, :, [0, -1]] = seam[:, None, :]
    half = filled.shape[-1] // 2
    for way in (filled[..., :half], filled[..., : half - 1 : -1]):
        before = np.maximum.accumulate(np.where(way != 0.0, np.arange(half), 0), axis=-1)
        way[...] = np.take_along_axis(way, before, axis=-1)
    return filled


#: Samples from the middle of the range to an end, on one side of the ground line.
SAMPLES = 128
#: A cell that holds an extreme is subdivided in so many rounds into so many parts, to 1e-9 of the range.
ROUNDS, PARTS = 6, 16
#: Newton's iteration ends at this change of x; from 1e-9 it takes two steps.
SETTLED, MOST_STEPS = CONTEXT.mpf(10) ** -25, 12
DIFFERENCE = CONTEXT.mpf(10) ** -12
#: An iteration is lost that ends at a value less extreme than that of the samples, by more than their rounding.
LOST = 1e-9
#: Distances from a kink of the positions whose lines meet there, but for the square of the distance.
KINKS = (CONTEXT.mpf(10) ** -7, CONTEXT.mpf(10) ** -12, CONTEXT.mpf(10) ** -20)
#: Kinds of candidates beside maxima (1) and minima (-1).
END, JUMP, BESIDE = 0, 2, 3
#: So far beside a jump are the values on both sides of it.
ASIDE = CONTEXT.mpf(10) ** -40
#: As near to a toggle as the digits of ends allow, where three powers of 1/x may cancel, and so much
#: farther: a quantity that changes by such a factor between the two is infinite or 0 at the toggle.
AT_END, FARTHER, GROWS = CONTEXT.mpf(10) ** -40, 1000, 10
#: Digits of extremes (of 50, second differences over 1e-12 have few) and of ends; a share of the usual size below both.
OF_EXTREMES, OF_ENDS, NOTHING = 2 * DIGITS, 3 * DIGITS, CONTEXT.mpf(10) ** -70


@dataclass(frozen=True)
class Candidate:
    """An extreme by samples: the end that x counts from, x, the value and its kind.

    `kind` is 1 for a maximum, -1 for a minimum, `END` for an end of the range, `JUMP` for a jump by a whole turn,
    `BESIDE` and -`BESIDE` for the sides of a jump of what is made of angles, where the fact `zero` vanishes.
    """

    end: int
    x: float
    value: float
    kind: int
    zero: str = ""


@dataclass(frozen=True)
class Extreme:
    """An extreme with 50 digits: value and input angle, each with its condition; whether the slope is 0 there."""

    value: Any
    condition: Any = CONTEXT.zero
    position: Any = CONTEXT.nan
    position_condition: Any = CONTEXT.zero
    is_stationary: bool = False


class Stationary:
    """The extremes of one quantity for some designs, in one branch each: `candidates` by samples of each design."""

    #: The first step towards a zero, over its place.
    first_step = CONTEXT.mpf(10) ** -3

    def __init__(
        self,
        catalogue: Catalogue,
        quantity: str,
        inputs: Mapping[str, NDArray[Any]],
        branches: NDArray[Any],
        variants: Sequence[str] = (),
        *,
        zeroes: bool = False,
    ) -> None:
        graded = catalogue.graded
        assert graded is not None
        self.catalogue, self.quantity, self.graded = catalogue, quantity, graded
        self.position = catalogue.position.name
        self.slope = derivative_name(quantity, self.position)
        self.inputs = {**inputs, "branch": branches}
        in_pieces, self.zeroes = graded.gaps is not None, zeroes
        self.variants = tuple(variants) if in_pieces else (graded.name, *variants)
        self.coordinates = (self.position,) if in_pieces else graded.coordinates
        zeros = (place.zero for place in graded.breakpoints(signed(quantity), "jump", "pole"))
        arc = (*AT_ENDS, *ARC_FACTS) if ARC in variants else ()
        self.facts = self._facts_of(quantity, self.position, *zeros, *arc, *(graded.gaps or ()))
        self.movable = [n for n in inputs if not catalogue.known_inputs(variants)[n].choices]
        self._sample()
        self.candidates = self._candidates()
        if arc:
            self._keep_arc()

    def _facts_of(self, *names: str) -> HighPrecision:
        given = (*self.inputs, *self.coordinates)
        return HighPrecision(self.catalogue, names, given, self.variants, zeroes=self.zeroes)

    # -- samples -----------------------------------------------------------------------------------

    def _read(
        self, names: Sequence[str], x: NDArray[Any], high: NDArray[Any], designs: NDArray[Any]
    ) -> list[NDArray[Any]]:
        """Return facts of designs at signed x from the lower ends, or upper where `high`."""
        values: dict[str, Any] = {name: column[designs] for name, column in self.inputs.items()}
        values |= zip(self.coordinates, self._leaves(x, high), strict=True)
        with as_given(not self.zeroes), np.errstate(invalid="ignore", divide="ignore"):
            facts = read_facts(self.catalogue, names, values, self.variants)
        return [np.broadcast_to(facts[name], x.shape) for name in names]

    def _leaves(self, x: NDArray[Any], high: NDArray[Any]) -> tuple[NDArray[Any], ...]:
        """Return the fractions of the range from both ends, and the side, in doubles."""
        square = x * x
        far = 1.0 / (1.0 + square)
        near = square * far
        return np.where(high, far, near), np.where(high, near, far), np.where(x < 0.0, -1.0, 1.0)

    def _sampled(self, names: Sequence[str]) -> list[NDArray[Any]]:
        """Return facts at the samples."""
        high = np.broadcast_to(np.arange(self.x.shape[1])[:, None] == 1, self.x.shape)
        return self._read(names, self.x, high, np.arange(len(self.x))[:, None, None])

    def _read_at(self, design: int, candidate: Candidate, *names: str) -> list[float]:
        """Return facts at a candidate, in doubles."""
        x, high = np.array([candidate.x]), np.array([bool(candidate.end)])
        return [float(values[0]) for values in self._read(names, x, high, np.array([design]))]

    def _values(self, design: int, end: int, x: Any) -> dict[str, Any]:
        """Return the inputs of a design and the coordinates of a place."""
        return {name: column[design] for name, column in self.inputs.items()} | self._leaves_at(end, x)

    def _sample(self) -> None:
        """Evaluate the quantity and its slope at ``x[design, end, sample]``."""
        ends = [name for end in self.graded.ends for name in end]
        count = self.inputs["branch"].size
        middle = np.full((count, 1), 0.5)
        designs = np.arange(count)[:, None]
        facts = self._read(ends, middle, np.zeros_like(middle, dtype=bool), designs)
        scale, start, toggle = (np.hstack([facts[k], facts[k + 3]])[..., None] for k in range(3))
        self.scale = scale[..., 0]
        # Where the range has no end, x = 0 is a position like any other, and samples go on with the other sign.
        self.bounded = ((start != 0.0) | (toggle > 0.0))[..., 0]
        #: Which designs fold at an end of their range: change points.
        self.folds = ((start != 0.0) & ~(toggle > 0.0))[..., 0].any(axis=1)
        grid = scale * np.sinh(np.arange(1, SAMPLES + 1) * (np.arcsinh(1.0 / scale) / SAMPLES))
        first = np.where(start != 0.0, abs(start), 0.5 * grid[..., :1])
        self.x = np.concatenate([-grid[..., ::-1], -first, first, grid], axis=-1)
        self.values, self.slopes = self._sampled((self.quantity, self.slope))

    def _candidates(self) -> list[list[Candidate]]:
        """Return the extremes of each design by samples, jumps and ends among them."""
        candidates: list[list[Candidate]] = [[] for _ in range(len(self.x))]
        inside = np.ones((*self.x.shape[:2], self.x.shape[2] - 1), dtype=bool)
        inside[..., SAMPLES] = ~self.bounded
        with np.errstate(invalid="ignore", over="ignore"):
            jumping = (
                inside & (abs(np.diff(self.values)) > np.pi) & (signed(self.quantity) in self.graded.wraps_at)
            )
            # where an angle jumps that the quantity is made of
            angles = tuple(self.graded.windings.get(self.quantity, ()))
            steps = (abs(np.diff(values)) for values in self._sampled(angles))
            beside = {angle: inside & (step > np.pi) for angle, step in zip(angles, steps, strict=True)}
            beside = {self.graded.wraps_at[angle]: cells for angle, cells in beside.items()}
            # and where what it is divided by vanishes
            for zero in self.graded.poles.get(signed(self.quantity), ()):
                (values,) = self._sampled((zero,))
                beside[zero] = inside & (values[..., 1:] * values[..., :-1] < 0.0)
            apart = np.logical_or.reduce([~inside, jumping, *beside.values()])
            turning, sides = turning_cells(np.sign(self.slopes), apart, self._side)
        for zero, cells in beside.items():
            for design, end, cell in np.argwhere(cells).tolist():
                for k, kind in ((0, -BESIDE), (1, BESIDE)):
                    place = float(self.x[design, end, cell + k]), float(self.values[design, end, cell + k])
                    candidates[design].append(Candidate(end, *place, kind, zero))
        for design, end, cell in np.argwhere(jumping).tolist():
            candidates[design].append(Candidate(end, float(self.x[design, end, cell]), np.nan, JUMP))
        for design, end in np.argwhere(self.bounded).tolist():
            for k in (SAMPLES, SAMPLES + 1):
                value = float(self.values[design, end, k])
                if not np.isnan(value):
                    candidates[design].append(Candidate(end, float(self.x[design, end, k]), value, END))
        turns = np.argwhere(turning)
        found = self._subdivided(sides, *turns.T)
        for (design, end), x, value, kind in zip(turns[:, :2].tolist(), *found, strict=True):
            candidates[design].append(Candidate(end, x, value, kind))
        return candidates

    def _keep_arc(self) -> None:
        """Keep the candidates within the arc of each design, and add the ends of the arc."""
        for name, values in zip(AT_ENDS, self._sampled(AT_ENDS), strict=True):
            for design, end, cell in np.argwhere(values[..., 1:] * values[..., :-1] < 0.0).tolist():
                place = float(self.x[design, end, cell]), float(self.values[design, end, cell])
                self.candidates[design].append(Candidate(end, *place, BESIDE, name))
        for design, found in enumerate(self.candidates):
            inside = []
            for one in found:
                if one.zero and one.kind != END:
                    base = self.facts.at(self._values(design, one.end, CONTEXT.mpf(one.x)))
                    one = replace(one, x=float(self._zero(base, one)))
                angle, centre, half = self._read_at(design, one, self.position, *ARC_FACTS)
                if abs(np.sin(0.5 * (angle - centre))) <= half + 2.0**-46:
                    inside.append(one)
            self.candidates[design] = inside
        theta, middle, reach = self._sampled((self.position, *ARC_FACTS))
        self.values = np.where(abs(np.sin(0.5 * (theta - middle))) <= reach, self.values, np.nan)

    def _side(self, design: int, end: int, sample: int) -> float:
        """Return the sign of the slope at a sample."""
        x = CONTEXT.mpf(float(self.x[design, end, sample]))
        return side_of(
            float(self.slopes[design, end, sample]),
            lambda: self._slope_facts.at(self._values(design, end, x))[self.slope],
        )

    def _subdivided(
        self, sides: NDArray[Any], design: NDArray[Any], end: NDArray[Any], cell: NDArray[Any]
    ) -> list[list[Any]]:
        """Narrow down cells whose slope changes sign; return x, values and kinds."""
        low, high = self.x[design, end, cell], self.x[design, end, cell + 1]
        before, after = sides[design, end, cell], sides[design, end, cell + 1]
        parts, rows = np.linspace(0.0, 1.0, PARTS + 1), np.arange(cell.size)
        for _ in range(ROUNDS):
            x = low[:, None] + (high - low)[:, None] * parts
            (slopes,) = self._read((self.slope,), x, end[:, None] == 1, design[:, None])
            changed = np.sign(slopes[:, 1:]) != before[:, None]
            part = np.where(changed.any(axis=1), changed.argmax(axis=1), PARTS - 1)
            low, high = x[rows, part], x[rows, part + 1]
        middle = 0.5 * (low + high)
        (values,) = self._read((self.quantity,), middle, end == 1, design)
        # the input angle grows with x counted from the lower end, and falls with that from the upper end
        kinds = np.sign(before - after) * np.where(end == 1, -1, 1)
        return [middle.tolist(), values.tolist(), kinds.astype(int).tolist()]

    @cached_property
    def _slope_facts(self) -> HighPrecision:
        return self._facts_of(self.slope)

    def zeroed(self, design: int) -> bool:
        """Tell whether a gap of a design counts as zero in doubles, but not here."""
        self.facts.at(self._values(design, 0, CONTEXT.mpf(1)))
        return bool(self.facts.left_out)

    def size(self, design: int) -> float:
        """Return the usual size of the quantity: values far below it are noise."""
        values = abs(self.values[design][np.isfinite(self.values[design])])
        return float(np.quantile(values, 0.75)) if values.size else 0.0

    def largest_sample(self, design: int, sign: int) -> float:
        """Return the greatest (sign 1) or least (-1) of the samples, NaN without any."""
        values = self.values[design][np.isfinite(self.values[design])]
        return float(sign * np.max(sign * values)) if values.size else np.nan

    def is_half_turn(self, extreme: Extreme) -> bool:
        """Tell whether an angle ends at pi, which is -pi, too."""
        return (
            signed(self.quantity) in self.graded.wraps_at
            and abs(abs(extreme.value) - CONTEXT.pi) < SETTLED * GROWS
        )

    def angle(self, design: int, candidate: Candidate) -> float:
        """Return the input angle of a candidate, in doubles."""
        return self._read_at(design, candidate, self.position)[0]

    # -- 50 digits ---------------------------------------------------------------------------------

    def extreme(self, design: int, candidate: Candidate, *, positions: bool = False) -> Extreme:
        """Return an extreme with 50 digits; `positions` adds the condition of its angle."""
        if candidate.kind == JUMP:
            return Extreme(CONTEXT.pi)
        with CONTEXT.workdps(OF_ENDS if candidate.kind == END else OF_EXTREMES):
            found = self._extreme(design, candidate, positions=positions)
        return replace(found, value=CONTEXT.zero) if abs(found.value) < NOTHING * self.size(design) else found

    def _extreme(self, design: int, candidate: Candidate, *, positions: bool) -> Extreme:
        end, x = candidate.end, CONTEXT.mpf(candidate.x)
        base = self.facts.at(self._values(design, end, x))
        if candidate.kind == END:
            return self._at_end(base, candidate, self.size(design))
        if candidate.zero:
            return self._beside(base, candidate)
        scale = CONTEXT.mpf(min(1.0, self.scale[design, end]))
        x, smooth = self._refined(base, candidate, x, scale)
        base = self._at(base, end, x)
        condition = self.facts.condition(base, self.movable)
        position_condition = self._position_condition(base, end, x, scale) if positions else CONTEXT.zero
        value, size = base[self.quantity], condition[self.quantity]
        return Extreme(value, size, base[self.position], position_condition, smooth)

    def _refined(
        self, base: Mapping[str, Any], candidate: Candidate, first: Any, scale: Any
    ) -> tuple[Any, bool]:
        """Return the place of an extreme, and whether Newton's iteration finds it: at a kink that is lost."""
        end, x = candidate.end, first
        for _ in range(MOST_STEPS):
            change = self._newton(base, end, x, scale)
            if not abs(change) < abs(x) + AT_END:
                break
            x += change
            if abs(change) < SETTLED * scale:
                found = self._at(base, end, x)[self.quantity]
                if candidate.kind * (found - candidate.value) >= -LOST * abs(candidate.value):
                    return x, True
                break
        kink = self._kink(base, end, first, scale)
        value, there = (self._at(base, end, place)[self.quantity] for place in (first, kink))
        return kink if candidate.kind * (there - value) > 0 else first, False  # or that by samples is better

    def _beside(self, base: Mapping[str, Any], candidate: Candidate) -> Extreme:
        """Return the value on one side of a jump, or of a pole, where it is infinite, whose place a fact's zero is."""
        end, x = candidate.end, self._zero(base, candidate)
        if candidate.zero in self.graded.poles.get(signed(self.quantity), ()):
            aside = ASIDE if candidate.kind > 0 else -ASIDE  # at a place where x is 0, too
            near, far = (self._at(base, end, x + k * aside)[self.quantity] for k in (FARTHER, FARTHER**2))
            place = self._at(base, end, x)[self.position]
            limit = near * CONTEXT.inf if abs(near) > GROWS * abs(far) else near
            return Extreme(limit, position=place)
        aside = ASIDE if (candidate.kind > 0) == (x > 0) else -ASIDE
        value, farther = (self._at(base, end, x * (1 + k * aside))[self.quantity] for k in (1, 2))
        return Extreme(value, abs(farther - value) / ASIDE)

    def _zero(self, base: Mapping[str, Any], candidate: Candidate) -> Any:
        """Return the place where the fact of a candidate vanishes."""
        end, zero, x = candidate.end, candidate.zero, CONTEXT.mpf(candidate.x)
        step = (abs(x) + AT_END) * self.first_step
        for _ in range(MOST_STEPS):
            here, there = (self._at(base, end, x + k * step)[zero] for k in (0, 1))
            if here == 0 or here == there:
                break
            change = -step * here / (there - here)
            x, step = x + change, abs(change) / 1000 + AT_END
            if abs(change) < ASIDE * abs(x):
                break
        return x

    def _leaves_at(self, end: int, x: Any) -> dict[str, Any]:
        near = x * x / (1 + x * x)
        fractions = (1 - near, near) if end else (near, 1 - near)
        return dict(zip(self.coordinates, (*fractions, CONTEXT.mpf(-1 if x < 0 else 1)), strict=True))

    def _at(self, base: Mapping[str, Any], end: int, x: Any) -> dict[str, Any]:
        return self.facts.moved(base, self._leaves_at(end, x))

    def _newton(self, base: Mapping[str, Any], end: int, x: Any, scale: Any) -> Any:
        """Return one step towards the extreme, from differences of the quantity over a share of the scale there."""
        step = DIFFERENCE * scale
        below, here, above = (self._at(base, end, x + k * step)[self.quantity] for k in (-1, 0, 1))
        curvature = (below - 2 * here + above) / step
        return -(above - below) / 2 / curvature if curvature != 0 else CONTEXT.zero

    def _kink(self, base: Mapping[str, Any], end: int, x: Any, scale: Any) -> Any:
        """Return the place of a kink: where the lines on both sides of it meet."""
        for distance in KINKS:
            step = distance * (abs(x) + scale)
            here = {k: self._at(base, end, x + k * step)[self.quantity] for k in (-2, -1, 1, 2)}
            before, after = here[-1] - here[-2], here[2] - here[1]
            if before != after:
                x += step * (here[1] - after - here[-1] - before) / (before - after)
        return x

    def _position_condition(self, base: Mapping[str, Any], end: int, x: Any, scale: Any) -> Any:
        """Return the condition of the input angle of an extreme, which moves with inputs."""
        total = CONTEXT.zero
        for moved in self.facts.varied(base, self.movable):
            there = self._at(moved, end, x + self._newton(moved, end, x, scale))
            total += abs(there[self.position] - base[self.position]) / STEP
        return total

    def _at_end(self, base: Mapping[str, Any], candidate: Candidate, size: float) -> Extreme:
        """Return the limit at an end of the range: infinite, 0 or finite."""
        x, aside = self._end(base, candidate)
        farther = self._at(base, candidate.end, x + FARTHER * aside)[self.quantity]
        there = self._at(base, candidate.end, x + aside)
        value, position = there[self.quantity], there[self.position]
        if max(abs(value), abs(farther)) > GROWS * min(abs(value), abs(farther)):
            if abs(value) > size:
                return Extreme(value * CONTEXT.inf, position=position)
            return Extreme(CONTEXT.zero, CONTEXT.mpf(size), position)
        condition, of_position = self._condition_at_end(there, candidate)
        return Extreme(value, condition, position, of_position)

    def _end(self, base: Mapping[str, Any], candidate: Candidate) -> tuple[Any, Any]:
        """Return the place of an end, and the way from there into the range."""
        return CONTEXT.zero, AT_END if candidate.x > 0 else -AT_END

    def _condition_at_end(self, there: Mapping[str, Any], candidate: Candidate) -> tuple[Any, Any]:
        """Return the conditions of the value beside an end, and of its input angle."""
        condition = self.facts.condition(there, self.movable)
        return condition[self.quantity], condition[self.position]


#: The fact that is 1 where all loops close.
CLOSES = "closes"
#: Where kernels cut the turn, so that ranges are told from there on.
SEAM = -0.7390851332151607
#: Samples of a turn that gaps cut into pieces, and how often least and greatest gaps between them are refined; powers
#: of ten of the distances from a limit of further samples; halvings that place a limit.
TURN_SAMPLES, REFINED, BESIDE_LIMIT, HALVINGS = 1024, 4, range(2, 15), 50


#: The samples and the limits of turns by mechanism and design, and of how many they are kept.
_TURNS: dict[Any, tuple[NDArray[Any], list[tuple[float, int, str]]]] = {}
MOST_TURNS = 512


class StationaryInPieces(Stationary):
    """The extremes over a turn that gaps cut into pieces: x is the input position, and there are no coordinates.

    Limits are where a gap vanishes, found between samples; nothing is graded but by further samples beside them.
    """

    # another limit may be as near
    first_step = CONTEXT.mpf(10) ** -13

    def _sample(self) -> None:
        """Evaluate the quantity and its slope at ``x[design, 0, sample]``, with samples beside limits."""
        count, gaps = self.inputs["branch"].size, self.graded.gaps or ()
        self.folds, self.scale = np.zeros(count, dtype=bool), np.ones((count, 1))
        first = -np.pi + 0.1234567  # at no place that symmetry gives an extreme
        every = np.linspace(first, first + 2.0 * np.pi, TURN_SAMPLES + 1)
        #: The limits of each design: the position, the direction of what closes, the gap.
        self.limits: list[list[tuple[float, int, str]]] = []
        rows = []
        known = self.catalogue.name, self.catalogue.version, self.variants, self.zeroes
        for design in range(count):
            key = known, tuple((name, float(column[design])) for name, column in self.inputs.items())
            if key not in _TURNS:  # all quantities of a design have the same
                x = every
                for gap in gaps:  # beside the limits of one the next may rise and fall at once
                    x = np.unique(np.concatenate([x, *self._beside_zeros(design, x, gap)]))
                    for _ in range(REFINED):
                        x = np.unique(np.concatenate([x, self._turning(design, x, gap)]))
                    x = np.unique(np.concatenate([x, *self._beside_zeros(design, x, gap)]))
                if len(_TURNS) >= MOST_TURNS:
                    _TURNS.clear()
                _TURNS[key] = x, self._limits(design, x)
            x, limits = _TURNS[key]
            self.limits.append(limits)
            rows.append(x)
        length = max(row.size for row in rows)
        length += length % 2
        self.x = np.stack([np.pad(row, (0, length - row.size), mode="edge") for row in rows])[:, None, :]
        values = self._sampled((CLOSES, *((self.quantity, self.slope) if self.quantity != CLOSES else ())))
        self.closes, *of = (np.where(values[0] == 1.0, value, np.nan) for value in values)
        self.values, self.slopes = of or (self.closes, self.closes)

    def assembly(self, design: int) -> int:
        """Return the code of how a design assembles over the turn."""
        (valid,) = self._along(design, self.x[design, 0, :1], "valid")
        if valid[0] != 1.0:
            return 3
        closes = self.closes[design] == 1.0
        return 0 if closes.all() else (1 if closes.any() else 2)

    def limits_of(self, design: int, side: int) -> list[tuple[Any, int, Any]]:
        """Return the limits where ranges begin (side 1) or end (-1): position, number of the gap, condition.

        They are in the order of where their ranges begin, from the seam of kernels on.
        """
        found, turn = [], 2.0 * np.pi
        ordered = sorted(self.limits[design], key=lambda limit: (limit[0] - SEAM) % turn)
        if ordered and ordered[0][1] < 0:  # the range that the seam cuts is the first
            ordered = [ordered[-1], *ordered[:-1]]
        for at, own, gap in ordered:
            if own != side:
                continue
            candidate = Candidate(0, at, np.nan, END, gap)
            with CONTEXT.workdps(OF_ENDS):
                base = self.facts.at(self._values(design, 0, CONTEXT.mpf(at)))
                x, condition = self._zero(base, candidate), CONTEXT.zero
                for moved in self.facts.varied(base, self.movable):
                    condition += abs(self._zero(moved, candidate) - x) / STEP
            found.append((x % (2 * CONTEXT.pi), (self.graded.gaps or ()).index(gap) + 1, condition))
        return found

    def _turning(self, design: int, x: NDArray[Any], gap: str) -> NDArray[Any]:
        """Return where parabolas through samples of a gap are least or greatest."""
        (f,) = self._along(design, x, gap)
        with np.errstate(invalid="ignore", divide="ignore"):
            left, right = np.diff(f)[:-1] / np.diff(x)[:-1], np.diff(f)[1:] / np.diff(x)[1:]
            turns = left * right < 0.0
            at = 0.5 * (x[:-2] + x[1:-1]) + left / (left - right) * 0.5 * (x[2:] - x[:-2])
        found: NDArray[Any] = at[turns & np.isfinite(at)]
        return found

    def _beside_zeros(self, design: int, x: NDArray[Any], gap: str) -> list[NDArray[Any]]:
        """Return positions on both sides of the zeros of a gap between samples."""
        (f,) = self._along(design, x, gap)
        cells = np.flatnonzero((f[1:] >= 0.0) & (f[:-1] < 0.0) | (f[1:] < 0.0) & (f[:-1] >= 0.0))
        low, high = self._halved(design, gap, 0.0, x[cells], x[cells + 1], f[cells + 1] >= 0.0)
        steps = 10.0 ** -np.array(BESIDE_LIMIT)
        return [(low[:, None] - steps).ravel(), (high[:, None] + steps).ravel()]

    def _halved(
        self, design: int, name: str, least: float, low: NDArray[Any], high: NDArray[Any], rises: NDArray[Any]
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        """Return cells, between whose ends a fact comes to a value, as narrow as doubles are."""
        for _ in range(HALVINGS if low.size else 0):
            middle = 0.5 * (low + high)
            (here,) = self._along(design, middle, name)
            above = (here >= least) == rises
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        return low, high

    def _limits(self, design: int, x: NDArray[Any]) -> list[tuple[float, int, str]]:
        """Return the limits of motion between samples, each next to what closes."""
        (closes,) = self._along(design, x, CLOSES)
        cells = np.flatnonzero((closes[1:] == 1.0) != (closes[:-1] == 1.0))
        rises = closes[cells + 1] == 1.0
        low, high = self._halved(design, CLOSES, 1.0, x[cells], x[cells + 1], rises)
        gaps, outer = self.graded.gaps or (), np.where(rises, low, high)
        values = self._along(design, outer, *gaps)
        first = [
            next((k for k, of in enumerate(values) if not of[cell] >= 0.0), -1) for cell in range(cells.size)
        ]
        inner, sides = np.where(rises, high, low).tolist(), np.where(rises, 1, -1).tolist()
        return [(at, side, gaps[k]) for at, side, k in zip(inner, sides, first, strict=True)]

    def _candidates(self) -> list[list[Candidate]]:
        """Return the extremes of each design by samples, jumps and limits among them."""
        self.bounded = np.zeros(self.x.shape[:2], dtype=bool)
        if self.quantity == CLOSES:
            return [[] for _ in self.limits]
        found = super()._candidates()
        for design, limits in enumerate(self.limits):
            for at, side, gap in limits:
                found[design].append(Candidate(0, at, np.nan, END, f"{side} {gap}"))
        return found

    def _along(self, design: int, x: NDArray[Any], *names: str) -> list[NDArray[Any]]:
        """Return facts of one design at input positions."""
        return self._read(names, x, np.zeros(x.shape, dtype=bool), np.full(x.size, design))

    def _leaves(self, x: NDArray[Any], high: NDArray[Any]) -> tuple[NDArray[Any], ...]:
        return (x,)

    def _leaves_at(self, end: int, x: Any) -> dict[str, Any]:
        return {self.position: CONTEXT.mpf(x)}

    def _end(self, base: Mapping[str, Any], candidate: Candidate) -> tuple[Any, Any]:
        side, gap = candidate.zero.split()
        return self._zero(base, replace(candidate, zero=gap)), AT_END * int(side)

    def _condition_at_end(self, there: Mapping[str, Any], candidate: Candidate) -> tuple[Any, Any]:
        """Return the condition of the value: a limit moves with the inputs, and the value with it."""
        condition = CONTEXT.zero
        for moved in self.facts.varied(there, self.movable):
            x, aside = self._end(moved, candidate)
            condition += abs(self._at(moved, 0, x + aside)[self.quantity] - there[self.quantity]) / STEP
        return condition, condition


def stationary_of(catalogue: Catalogue, *arguments: Any, **options: Any) -> Stationary:
    """Return the extremes of a quantity, see `Stationary`."""
    in_pieces = catalogue.graded is not None and catalogue.graded.gaps is not None
    return (StationaryInPieces if in_pieces else Stationary)(catalogue, *arguments, **options)

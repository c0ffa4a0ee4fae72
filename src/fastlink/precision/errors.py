"""Compare the results of some designs with 50 digits, and state the errors as attributes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.errors import InputError
from fastlink.facts.arc import ARC
from fastlink.facts.evaluate import read_facts
from fastlink.facts.fact import Fact, System, ranges_of
from fastlink.facts.names import ErrorBound, error_name, signed
from fastlink.facts.powers import UNITS, dimensions
from fastlink.facts.tables import angle_tables
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.precision.independent import TOLERANCE, IndependentValues
from fastlink.precision.reference import CONTEXT, DIGITS, HighPrecision, error_in_roundings
from fastlink.precision.stationary import (
    CLOSES,
    END,
    JUMP,
    Extreme,
    Stationary,
    StationaryInPieces,
    stationary_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from fastlink.facts.catalogue import Catalogue
    from fastlink.plan.programs import Output, Plan
    from fastlink.plan.query import Reduction
    from fastlink.precision.reference import HighPrecision


# -- The designs that are verified, their results, and the budget of evaluations


#: The cost of a table of the input position, a linear system and a function of double words, in facts.
TABLE, SYSTEM, PAIRS = 40, 300, 16
OF_PAIRS = {"gap", "gap_product_quotient", "pair_product", "pair_quotient", "two_product"}
#: Designs that are verified whatever the cost.
FEWEST = 8


@dataclass(frozen=True, eq=False)
class Sample:
    """Designs of a sweep with their results (designs, ...) by output, and one branch of each for reductions."""

    plan: Plan
    inputs: dict[str, NDArray[Any]]
    positions: NDArray[Any]
    #: For each design the index of its branch among those of the plan.
    branch_indices: NDArray[Any]
    results: dict[str, NDArray[Any]] = field(default_factory=dict)

    @property
    def catalogue(self) -> Catalogue:
        """The mechanism."""
        return self.plan.catalogue

    @property
    def count(self) -> int:
        """The number of designs."""
        return int(self.branch_indices.size)

    @cached_property
    def branches(self) -> NDArray[Any]:
        """The branch of each design."""
        found: NDArray[Any] = np.array(self.plan.branches, dtype=float)[self.branch_indices]
        return found

    @cached_property
    def movable(self) -> list[str]:
        """The inputs that are not codes, with respect to which derivatives exist."""
        known = self.catalogue.known_inputs(self.plan.variants)
        return [name for name in self.inputs if not known[name].choices]

    def facts(self, names: Iterable[str], *, zeroes: bool = False) -> HighPrecision:
        """Return facts at configurations of these designs, with 50 digits."""
        given = (*self.inputs, self.catalogue.position.name, "branch")
        return HighPrecision(self.catalogue, names, given, self.plan.variants, zeroes=zeroes)

    def result(self, name: str, design: int) -> Any:
        """Return the result of a reduction for a design in its branch."""
        return self.results[name][design, self.branch_indices[design]]

    def configuration(self, design: int, branch: float, position: float) -> dict[str, float]:
        """Return the values that `facts` are evaluated at."""
        values = {name: float(column[design]) for name, column in self.inputs.items()}
        return {**values, "branch": branch, self.catalogue.position.name: position}

    def arguments(self, facts: HighPrecision) -> list[str]:
        """Return the inputs and position whose changes make up the condition of facts."""
        position = self.catalogue.position.name
        return [name for name in (*self.movable, position) if facts.steps_after(name)]

    def terms(self, quantity: str, design: int) -> float:
        """Return the power of two near which a quantity is: of the longest bar, greatest mass and rate of a design."""
        known = self.catalogue.known_inputs(self.plan.variants)
        values = {name: float(column[design]) for name, column in self.inputs.items()}
        finite = [name for name, value in values.items() if 0.0 < abs(value) < math.inf]
        #: Of each input the exponent of its number, and the powers of kg, m and s in its units.
        inputs = {name: (math.frexp(values[name])[1], dimensions(known[name].units)) for name in finite}
        bars = [k for name, (k, of) in inputs.items() if of == UNITS["m"] and known[name].rule == "positive"]
        length = max(bars, default=0)
        rate = max((k // -s for k, (kg, m, s) in inputs.values() if (kg, m) == (0, 0) and s < 0), default=0)
        masses = [k for k, of in inputs.values() if of == UNITS["kg"]]
        masses = masses or [k - m * length + s * rate for k, (kg, m, s) in inputs.values() if kg == 1]
        powers = dimensions(self.catalogue.public_fact(quantity).units)
        sizes = max(masses, default=0), length, -rate
        return math.ldexp(1.0, sum(x * y for x, y in zip(powers, sizes, strict=True)))

    def bound(self, quantity: str, at: Mapping[str, float]) -> float:
        """Return the error bound of a quantity at a configuration; infinite where it has none."""
        name, doubles = error_name(quantity), {key: np.float64(value) for key, value in at.items()}
        try:
            bound = float(read_facts(self.catalogue, [name], doubles, self.plan.variants)[name])
        except InputError:
            return np.inf
        return np.inf if math.isnan(bound) else bound

    def affordable(self, facts: HighPrecision, share: int, most: int) -> int:
        """Return the number of configurations that a share of the evaluations pays for."""
        condition = sum(cost(facts.steps_after(name)) for name in self.arguments(facts))
        return within(share, cost(facts.steps) + condition + 2 * TABLE * len(facts.tables), most)

    def curves(self, quantity: str, designs: int) -> NDArray[Any]:
        """Return a quantity (designs, positions) at all input positions, in doubles."""
        values: dict[str, Any] = {name: column[:designs, None] for name, column in self.inputs.items()}
        values["branch"] = self.branches[:designs, None]
        samples = read_curves(self.catalogue, quantity, values, self.positions, self.plan.variants)
        return np.broadcast_to(samples, (designs, self.positions.size))


def read_curves(
    catalogue: Catalogue,
    quantity: str,
    values: Mapping[str, Any],
    positions: NDArray[Any],
    variants: Iterable[str],
) -> Any:
    """Return a quantity over the input positions (last axis), without a kernel."""
    tables = (catalogue.position.name, *catalogue.tables, *catalogue.table_low_parts)
    tabled = zip(tables, angle_tables(catalogue, tables, positions), strict=True)
    return read_facts(catalogue, [quantity], {**values, **dict(tabled)}, variants)[quantity]


def cost(steps: Iterable[Fact | System]) -> int:
    """Return the cost of steps with 50 digits, in facts."""
    return sum(
        SYSTEM if isinstance(step, System) else PAIRS if OF_PAIRS.intersection(step.formula.uses) else 1
        for step in steps
    )


def within(share: int, each: int, most: int) -> int:
    """Return the number that a share of the evaluations pays for, at this cost each."""
    return min(max(share // max(each, 1), FEWEST), most)


#: Values below this share of the terms that made them vanish: to half its digits, the reference itself is 0.
VANISHES = CONTEXT.mpf(10) ** (-DIGITS // 2)
#: Errors beyond so many roundings are held against the error bound, as are all of values that vanish.
SUSPECT = 16.0
#: Reductions and positions, which are held against no bound, are wrong beyond so many.
LOST = 1e6


@dataclass
class MeasuredErrors:
    """Errors of the values of one variable against exact ones."""

    #: The reference of the comparison.
    method: str
    #: The size that errors are relative to, unless it is the exact value: a whole turn for positions.
    scale: Any = 0
    #: Errors where both values are finite; relative to the size of such values of the design where the exact one is 0.
    relative: list[float] = field(default_factory=list)
    roundings: list[float] = field(default_factory=list)
    values: int = 0
    #: Values with another code, finite where the exact one is not, or wrong by more than their error bound or, without
    #: one, by more than `LOST`; exact values that no formula of the facts confirms are among these.
    mismatches: int = 0
    #: Differences of exact values from independent ones, in units of `unit_of`.
    independent: list[float] = field(default_factory=list)
    #: Of the values of an error bound, the share that the error has.
    shares: list[float] = field(default_factory=list)

    def add(
        self,
        value: float,
        exact: Any,
        condition: Any = None,
        terms: float = 0.0,
        bound: Callable[[], float] | None = None,
        zeroed: object = False,
    ) -> None:
        """Compare a value."""
        self.values += 1
        finite = bool(np.isfinite(value)), bool(CONTEXT.isfinite(exact))
        if not all(finite):
            self.mismatches += int(any(finite) and not zeroed)
            return
        error, least = abs(CONTEXT.mpf(value) - exact), VANISHES * terms
        vanishes = abs(exact) <= least and terms != 0.0
        size = self.scale or (terms if vanishes else abs(exact))
        if size != 0:
            self.relative.append(float(error / size))
        roundings = 0.0
        if condition is not None:
            insensitive = vanishes and abs(exact) + condition <= least
            roundings = error_in_roundings(value, exact, terms if insensitive else condition)
            self.roundings.append(roundings)
        if bound is not None and error != 0 and (vanishes or roundings > SUSPECT):
            self.mismatches += int(error > bound())
        self.mismatches += int(bound is None and not zeroed and roundings > LOST)

    def add_code(self, value: float, exact: Any) -> None:
        """Compare a code, which is right or wrong."""
        self.values += 1
        self.mismatches += int(exact != value)

    def add_bound(self, bound: float, value: float, exact: Any) -> None:
        """Hold an error bound against the error of its value; one of what is not finite has to be infinite or NaN."""
        self.values += 1
        if not (np.isfinite(value) and CONTEXT.isfinite(exact)):
            self.mismatches += int(np.isfinite(bound))
            return
        error = abs(CONTEXT.mpf(value) - exact)
        self.mismatches += int(not error <= bound)
        if 0.0 < bound < np.inf:
            self.shares.append(float(error / bound))

    def add_independent(self, difference: float | None) -> None:
        """Compare an exact value with an independent one, if there is one, by their difference over `unit_of`."""
        if difference is not None:
            self.independent.append(difference)
            self.mismatches += int(difference > TOLERANCE)

    def add_mismatch(self) -> None:
        """Count a value that is missing, or one that should not exist."""
        self.values += 1
        self.mismatches += 1

    def attrs(self) -> dict[str, Any]:
        """Return the attributes of the variable."""
        attrs: dict[str, Any] = {"verified_values": self.values, "verify_mismatches": self.mismatches}
        if self.relative:
            attrs["error_max_relative"] = max(self.relative)
            attrs["error_median_relative"] = float(np.median(self.relative))
            attrs["error_reference"] = self.method
        if self.roundings:
            attrs["error_max_roundings"] = max(self.roundings)
        if self.shares:
            attrs["error_max_of_bound"] = max(self.shares)
            attrs["error_reference"] = self.method
        if self.independent:
            attrs["independent_values"] = len(self.independent)
            attrs["independent_max_difference"] = max(self.independent)
        return attrs


def unit_of(exact: Any, condition: Any, terms: float) -> Any:
    """Return the size against which two references are compared: that of the terms for a value that vanishes."""
    size = abs(exact) + condition
    return CONTEXT.mpf(terms) if size <= VANISHES * terms else size


# -- Compare curves, facts of the design and reductions of samples


#: Configurations of each design, if the budget allows.
ANGLES = 4
#: Samples that differ by less may change order.
TIED_SAMPLES = 64 * UNIT_ROUNDING
FACTS = "the facts with 50 digits"
TURN = 2 * CONTEXT.pi
#: The reference of a reduction, by whether it is an extreme, and whether its position is compared.
METHODS = {
    (False, False): "the exact reduction of the samples in doubles",
    (True, False): f"{FACTS}, at the sample",
    (True, True): "the given input positions",
}


def values(
    sample: Sample, outputs: Sequence[Output], share: int, rng: np.random.Generator
) -> dict[str, MeasuredErrors]:
    """Measure errors of curves and facts of the design at random configurations."""
    errors = {output.name: MeasuredErrors(FACTS) for output in outputs}
    independent = IndependentValues(sample.catalogue, errors)
    has_numbers = any(output.dtype == "float64" for output in outputs)
    as_given, as_meant = (
        sample.facts(names, zeroes=zeroes) for zeroes, names in _by_reading(sample, outputs)
    )
    for number in range(configurations(sample, outputs, share)):
        design = number % sample.count
        branch, position = rng.integers(len(sample.plan.branches)), rng.integers(sample.positions.size)
        at = sample.configuration(design, sample.plan.branches[branch], sample.positions[position])
        exact: dict[str, Any] = {}
        condition: dict[str, Any] = {}
        for facts in (as_given, as_meant):
            found = facts.at(at)
            exact |= {name: found[name] for name in facts.names}
            condition |= facts.condition(found, sample.arguments(facts)) if has_numbers else {}
        for output in outputs:
            row = sample.results[output.name][design]
            value = float(row[branch, position]) if output.axes else float(row)
            if output.dtype == "float64":
                terms, bound = sample.terms(output.name, design), partial(sample.bound, output.name, at)
                nearest = _same_turn(sample, output.name, value, exact[output.name])
                zeroed = as_given.left_out
                errors[output.name].add(value, nearest, condition[output.name], terms, bound, zeroed)
            else:
                errors[output.name].add_code(value, exact[output.name])
        if number < sample.count:  # each design once
            sizes = {name: sample.terms(name, design) for name in independent.names}
            units = {name: unit_of(exact[name], condition.get(name, 1), size) for name, size in sizes.items()}
            for name, difference in independent.differences(at, exact, units).items():
                errors[name].add_independent(difference)
    return errors


def _by_reading(sample: Sample, outputs: Sequence[Output]) -> list[tuple[bool, list[str]]]:
    """Return the names of numbers, then of codes and error bounds: they say which gaps count as zero, and why."""

    def zeroes(output: Output) -> bool:
        is_bound = isinstance(sample.catalogue.parse(output.name), ErrorBound)
        return is_bound or output.dtype != "float64"

    return [(which, [o.name for o in outputs if zeroes(o) is which]) for which in (False, True)]


def _same_turn(sample: Sample, quantity: str, value: float, exact: Any) -> Any:
    """Return an exact value; of an angle that is pi for one rounding and -pi for another, the nearer one."""
    graded = sample.catalogue.graded
    if graded is None or signed(quantity) not in graded.wraps_at or not abs(value - exact) > CONTEXT.pi:
        return exact
    return _turned_to(value, exact)


def _turned_to(value: float, exact: Any) -> Any:
    """Return an angle, by whole turns nearest to a value."""
    return exact + TURN * CONTEXT.nint((CONTEXT.mpf(value) - exact) / TURN)


def configurations(sample: Sample, outputs: Sequence[Output], share: int) -> int:
    """Return at how many configurations curves and facts of the design are compared."""
    most = sample.count * (ANGLES if any(output.axes for output in outputs) else 1)
    if not any(output.dtype == "float64" for output in outputs):
        return most
    return sample.affordable(sample.facts([output.name for output in outputs]), share, most)


def sampled(sample: Sample, outputs: Sequence[Output], share: int) -> dict[str, MeasuredErrors]:
    """Measure errors of reductions of one quantity's samples, by their references.

    The sample of a greatest or least value is chosen in doubles and computed with 50 digits; other reductions are
    computed with 50 digits from the samples in doubles.
    """
    quantity = outputs[0].request.quantity
    facts = sample.facts([quantity])
    count = sample.affordable(facts, share, sample.count)
    curves = sample.curves(quantity, count)
    if counted := next((output.counted for output in outputs if output.counted), ""):
        curves = np.where(np.isnan(sample.curves(counted, count)), np.nan, curves)
    independent = IndependentValues(sample.catalogue, [quantity])
    errors: dict[str, MeasuredErrors] = {}
    for output in outputs:
        reduction = output.request.reduction
        assert reduction is not None
        compared = count if reduction.has_position else within(share, sample.positions.size, count)
        measured = MeasuredErrors(METHODS[reduction.has_position, output.request.is_position])
        for design, curve in enumerate(curves[:compared]):
            value = float(sample.result(output.name, design))
            # the samples at the ends of an arc count half: those between twice
            parts = [curve, curve[1:-1]] if ARC in sample.plan.variants else [curve]
            exact, size = _reduced(reduction, np.concatenate(parts))
            if output.toggles and curve.any() and _meets_toggle(sample, output, design):
                exact = CONTEXT.nan  # the integral does not exist, or is infinite
            if reduction.has_position and not CONTEXT.isnan(exact):
                best = int(np.flatnonzero(curve == float(exact))[0])
                if output.request.is_position:
                    exact, size = _selected_position(value, curve, best, sample.positions), None
                else:
                    at = sample.configuration(design, sample.branches[design], sample.positions[best])
                    known = facts.at(at)
                    exact, size = known[quantity], facts.condition(known, sample.arguments(facts))[quantity]
                    unit = unit_of(exact, size, sample.terms(quantity, design))
                    measured.add_independent(independent.difference(at, quantity, exact, unit))
            of_quantity = reduction.has_position and not output.request.is_position
            terms = sample.terms(quantity, design) if of_quantity else 0.0
            measured.add(value, exact, size, terms, zeroed=of_quantity and facts.left_out)
        errors[output.name] = measured
    return errors


def _meets_toggle(sample: Sample, output: Output, design: int) -> bool:
    """Tell whether the turn of a design has a toggle."""
    at = sample.configuration(design, sample.branches[design], sample.positions[0])
    known = sample.facts(output.toggles, zeroes=True).at(at)
    return any(known[name] > 0 for name in output.toggles)


def _reduced(reduction: Reduction, curve: NDArray[Any]) -> tuple[Any, Any]:
    """Return the exact value of a reduction of samples, and the size of its terms."""
    assembles = ~np.isnan(curve)
    if not assembles.any() or (reduction.whole and not assembles.all()):
        return CONTEXT.nan, CONTEXT.zero
    assert reduction.reference is not None  # verification leaves paths out
    return reduction.reference([CONTEXT.mpf(value) for value in curve[assembles].tolist()])


def _selected_position(value: float, curve: NDArray[Any], best: int, positions: NDArray[Any]) -> Any:
    """Return a position if its sample is the best up to rounding, else the best one's."""
    selected = np.flatnonzero(positions == value)
    if selected.size and abs(curve[selected[0]] - curve[best]) <= TIED_SAMPLES * abs(curve[best]):
        return CONTEXT.mpf(value)
    return CONTEXT.mpf(positions[best])


# -- Compare greatest and least values, their positions, and lists of extremes


METHOD = "extremes refined with 50 digits"
BOUNDED = f"errors against {METHOD}"
#: Extremes whose values differ by less may change order: a search in doubles cannot tell them apart.
TIED_EXTREMA = 1e-12
#: The cost of finding an extreme in evaluations, without its condition.
EVALUATIONS = 12


def outermost(
    stationary: Stationary, design: int, sign: int, *, near: float | None = None, of_all: bool = False
) -> Extreme:
    """Return the greatest (sign 1) or least (-1) value of a design, with 50 digits."""
    candidates = stationary.candidates[design]
    ends = [stationary.extreme(design, c) for c in candidates if c.kind == END or c.zero]
    if any(c.kind == JUMP for c in candidates) or any(map(stationary.is_half_turn, ends)):
        return Extreme(sign * CONTEXT.pi)
    inner = [candidate for candidate in candidates if candidate.kind == sign]
    best = max((sign * candidate.value for candidate in inner), default=-np.inf)
    tied = [c for c in inner if sign * c.value >= best - TIED_EXTREMA * abs(best)]
    tied = tied[:1] if near is None and not of_all else tied
    extremes = [stationary.extreme(design, c, positions=near is not None) for c in tied]
    extremes += [end for end in ends if not CONTEXT.isnan(end.value)]
    greatest = max((sign * extreme.value for extreme in extremes), default=-CONTEXT.inf)
    sample, size = stationary.largest_sample(design, sign), stationary.size(design)
    if not extremes or sign * sample > greatest + TIED_EXTREMA * size:
        # a constant, an extreme that no slope shows, or no value at all
        return Extreme(CONTEXT.mpf(sample), CONTEXT.mpf(size))
    if of_all:
        return max((e for e in extremes if not CONTEXT.isnan(e.value)), key=lambda e: sign * e.value)
    equal = [
        e for e in extremes if sign * e.value >= greatest - TIED_EXTREMA * size or sign * e.value == greatest
    ]
    return equal[0] if near is None else min(equal, key=lambda e: _distance(near, e.position))


#: Designs whose ranges are compared at most: of each a turn is sampled.
ASSEMBLIES = 16


def refined(sample: Sample, outputs: Sequence[Output], share: int) -> dict[str, MeasuredErrors]:
    """Measure the errors of all results that belong to the extremes of one quantity."""
    quantity = outputs[0].request.quantity
    if outputs[0].is_assembly:
        return _assembly(sample, outputs, share)
    parts = {_part(output): output for output in outputs}
    errors = {
        part: MeasuredErrors(
            BOUNDED if output.request.is_error else METHOD, TURN if _is_position(output) else 0
        )
        for part, output in parts.items()
    }
    count = affordable(sample, quantity, share, outputs)
    inputs = {name: column[:count] for name, column in sample.inputs.items()}
    designs = sample.catalogue, quantity, inputs, sample.branches[:count], sample.plan.variants
    stationary = as_meant = stationary_of(*designs)
    zeroed = [stationary.zeroed(design) for design in range(count)]
    if "value" in parts and any(zeroed):
        as_meant = stationary_of(*designs, zeroes=True)  # which extremes there are is a decision, like a code
    independent = IndependentValues(sample.catalogue, [quantity])
    for design in range(count):
        results = {part: sample.result(output.name, design) for part, output in parts.items()}
        for reduction in _reductions(outputs):
            exact = _compare_outermost(stationary, design, reduction, results, errors, zeroed[design])
            if reduction.suffix in errors:
                _confirm(sample, design, exact, independent, errors[reduction.suffix])
        if "value" in parts:
            for exact in _compare_list(as_meant, design, results, errors)[: not zeroed[design]]:
                _confirm(sample, design, exact, independent, errors["value"])
    return {parts[part].name: measured for part, measured in errors.items()}


def _assembly(sample: Sample, outputs: Sequence[Output], share: int) -> dict[str, MeasuredErrors]:
    """Compare how designs assemble over the turn, and between which limits, with what samples of their gaps show."""
    known, count = sample.catalogue, min(sample.count, ASSEMBLIES)
    rows = {output.name: ranges_of(known.position.name).get(output.name, -1) for output in outputs}
    errors = {name: MeasuredErrors(METHOD, TURN if row in (0, 1) else 0) for name, row in rows.items()}
    inputs = {name: column[:count] for name, column in sample.inputs.items()}
    designs = StationaryInPieces(known, CLOSES, inputs, sample.branches[:count], sample.plan.variants)
    for design in range(count):
        limits = [designs.limits_of(design, side) for side in (1, -1)] if max(rows.values()) >= 0 else []
        for name, row in rows.items():
            result, measured = sample.result(name, design), errors[name]
            if row < 0:
                measured.add_code(float(result), designs.assembly(design))
                continue
            told = result[result > 0] if row > 1 else result[np.isfinite(result)]
            if len(told) != len(limits[row % 2]):
                measured.add_mismatch()
            for value, (at, gap, condition) in zip(told.tolist(), limits[row % 2], strict=False):
                if row > 1:
                    measured.add_code(float(value), gap)
                else:
                    measured.add(float(value), at, TURN + condition)
    return errors


def _compare_outermost(
    stationary: Stationary,
    design: int,
    reduction: Reduction,
    results: Mapping[str, Any],
    errors: Mapping[str, MeasuredErrors],
    zeroed: bool,
) -> Extreme:
    value, position = reduction.suffix, f"at {reduction.suffix}"
    near = float(results[position]) if position in results and np.isfinite(results[position]) else None
    exact = outermost(stationary, design, reduction.sign, near=near)
    if value in results:
        errors[value].add(float(results[value]), exact.value, exact.condition, zeroed=zeroed)
    if _bound_of(value) in results:
        greatest = outermost(stationary, design, reduction.sign, of_all=True)
        if not CONTEXT.isnan(greatest.position):  # else it is a sample in doubles
            bound = float(results[_bound_of(value)])
            errors[_bound_of(value)].add_bound(bound, float(results[value]), greatest.value)
    if position in results and not (CONTEXT.isnan(exact.position) and CONTEXT.isfinite(exact.value)):
        _add_position(errors[position], float(results[position]), exact, zeroed)
    return exact


def _compare_list(
    stationary: Stationary, design: int, results: Mapping[str, Any], errors: Mapping[str, MeasuredErrors]
) -> list[Extreme]:
    candidates = [c for c in stationary.candidates[design] if c.kind in (1, -1)]
    compared = []
    present = int(np.isfinite(results["value"]).sum())
    if "count" in results:
        errors["count"].add_code(float(results["count"]), len(candidates))
    for k in range(max(present, len(candidates))):
        if k >= present or not candidates:  # one that the sweep missed, or one that does not exist
            errors["value"].add_mismatch()
            continue
        near = float(results["position"][k])
        nearest = min(candidates, key=lambda c: _distance(near, stationary.angle(design, c)))
        candidates.remove(nearest)
        exact = stationary.extreme(design, nearest, positions=True)
        errors["value"].add(float(results["value"][k]), exact.value, exact.condition)
        if _bound_of("") in results:
            errors[_bound_of("")].add_bound(
                float(results[_bound_of("")][k]), float(results["value"][k]), exact.value
            )
        if "position" in results:
            _add_position(errors["position"], near, exact)
        if "kind" in results:
            errors["kind"].add_code(float(results["kind"][k]), nearest.kind)
        compared.append(exact)
    return compared


def _confirm(
    sample: Sample, design: int, exact: Extreme, independent: IndependentValues, measured: MeasuredErrors
) -> None:
    """Compare the value of a stationary extreme with an independent one at its position."""
    if exact.is_stationary and CONTEXT.isfinite(exact.value) and independent.names:
        (quantity,) = independent.names
        at = sample.configuration(design, sample.branches[design], exact.position)
        unit = unit_of(exact.value, exact.condition, sample.terms(quantity, design))
        measured.add_independent(independent.difference(at, quantity, exact.value, unit))


def _add_position(measured: MeasuredErrors, value: float, exact: Extreme, zeroed: bool = False) -> None:
    """Compare input angles modulo a turn, relative to a whole one."""
    position = _turned_to(value, exact.position) if np.isfinite(value) else exact.position
    measured.add(value, position, TURN + exact.position_condition, zeroed=zeroed)


def _distance(angle: float, other: Any) -> float:
    """Return the distance of two angles over the turn."""
    return abs((angle - float(other) + np.pi) % (2 * np.pi) - np.pi)


def _reductions(outputs: Sequence[Output]) -> list[Reduction]:
    """Return the reductions of some outputs, each once."""
    return list(dict.fromkeys(o.request.reduction for o in outputs if o.request.reduction is not None))


def _part(output: Output) -> str:
    """Return the part of an output: [at] SUFFIX, value, position, count or kind, or SUFFIX with error."""
    request = output.request
    if request.is_error:
        return _bound_of(request.reduction.suffix if request.reduction is not None else "")
    if request.reduction is None:
        return request.listed
    return f"at {request.reduction.suffix}" if request.is_position else request.reduction.suffix


def _bound_of(suffix: str) -> str:
    """Return the part of the error bound of an extreme, or of those of a list, which has no suffix."""
    return f"{suffix} error"


def _is_position(output: Output) -> bool:
    return output.request.is_position or output.request.listed == "position"


def affordable(sample: Sample, quantity: str, share: int, outputs: Sequence[Output]) -> int:
    """Return the number of designs whose extremes a share of the evaluations pays for."""
    has_list = any(output.request.listed == "value" for output in outputs)
    searches = len(_reductions(outputs)) + 4 * has_list
    facts = sample.facts([quantity])
    condition = sum(cost(facts.steps_after(name)) for name in sample.movable)
    if any(map(_is_position, outputs)):
        condition *= 5
    each = cost(facts.steps) + EVALUATIONS * len(facts.steps) + condition
    return within(share, each * searches, sample.count)

"""Computed quantities of an entry of the registry against the same facts with 50 digits."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

import fastlink as fl
from fastlink.facts.derivative import NoDerivative
from fastlink.numerics.compensated import UNIT_ROUNDING
from fastlink.plan.request import selected_variants
from fastlink.precision.reference import CONTEXT as MP
from fastlink.precision.reference import HighPrecision
from tests.support.registry import Entry
from tests.support.sweeps import sweep_both

#: So many configurations are compiled at once: every design is swept over the positions of all.
BLOCK = 30
LARGEST = np.finfo(float).max


def choices(entry: Entry, inputs: dict[str, Any]) -> dict[str, list[float]]:
    """Return the modes that configurations leave open, with their codes."""
    known = entry.catalogue.known_inputs(entry.catalogue.variants_selected_by(inputs))
    modes = {"branch": entry.catalogue.branches} if entry.moves else {}
    modes |= {name: one.choices for name, one in known.items() if one.choices}
    return {name: [float(code) for code in codes] for name, codes in modes.items() if name not in inputs}


def in_every_mode(entry: Entry, inputs: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the same configurations, in all modes that are left open."""
    for mode, codes in choices(entry, inputs).items():
        n = len(next(iter(inputs.values())))
        inputs = {name: np.tile(values, len(codes)) for name, values in inputs.items()}
        inputs[mode] = np.repeat(codes, n)
    return inputs


def plain(entry: Entry, names: tuple[str, ...], inputs: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return quantities of configurations in every mode as plain arrays, from facts that are not compiled."""
    if not entry.moves:
        inputs = {entry.input: np.float64(1.0)} | inputs
    return fl.evaluate(entry.mechanism, names, input=entry.input, solver=entry.solver, **inputs)


def compiled(entry: Entry, names: tuple[str, ...], inputs: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the same from the kernels of sweeps."""
    n = len(next(iter(inputs.values())))
    parts = []
    for start in range(0, n, BLOCK):
        block = {name: values[start : start + BLOCK] for name, values in inputs.items()}
        parts.append(_swept(entry, names, block))
    return {name: np.concatenate([part[name] for part in parts]) for name in names}


def _swept(entry: Entry, names: tuple[str, ...], inputs: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    columns = {name: values for name, values in inputs.items() if name not in ("branch", entry.input)}
    found = sweep_both(
        entry.mechanism,
        fl.table(columns),
        list(names),
        input=entry.input,
        solver=entry.solver,
        angles=np.unique(inputs.get(entry.input, 1.0)),
        threads=1,
        extrema="sampled",
    )
    rows = len(next(iter(inputs.values())))
    places = {"design": np.arange(rows)}  # of each configuration along each dimension
    for name in ("branch", entry.input):
        if name in inputs:
            labels = np.atleast_1d(found[name].values)
            places[name] = np.searchsorted(labels, inputs[name])
            np.testing.assert_array_equal(labels[places[name]], inputs[name])
    results = {}
    for name in names:
        values = found[name]
        results[name] = np.broadcast_to(values.values[tuple(places[dim] for dim in values.dims)], (rows,))
    return results


class Truth:
    """The facts of an entry's configurations, in every mode, with 50 digits.

    With `zeroes` gaps within the rounding of the lengths are zero, as in doubles: then errors are those of rounding.
    """

    def __init__(
        self, entry: Entry, names: tuple[str, ...], inputs: dict[str, np.ndarray], *, zeroes: bool = True
    ) -> None:
        self.entry, self.names, self.inputs = entry, names, inputs
        catalogue = entry.catalogue
        self.variants = selected_variants(catalogue, None, entry.solver, inputs)
        codes = {name for name, one in catalogue.known_inputs(self.variants).items() if one.choices}
        numbers = [name for name in inputs if name != "branch" and name not in codes]
        # Most is due to the position.
        self.numbers = sorted(numbers, key=lambda name: name != entry.input)
        self.facts = HighPrecision(catalogue, names, inputs, self.variants, zeroes=zeroes)

    def rows(self) -> Iterator[tuple[int, dict[str, float], dict[str, Any]]]:
        """Yield each configuration with its number and its facts."""
        for i in range(len(next(iter(self.inputs.values())))):
            one = {name: float(values[i]) for name, values in self.inputs.items()}
            yield i, one, self.facts.at(one)

    def beyond(self, true: dict[str, Any], values: dict[str, float]) -> dict[str, float]:
        """Return the quantities of one configuration whose errors are too great, with these in their units.

        What one rounding of an input does is added for one input after another, until every error is accounted for.
        """
        units = {name: abs(true[name]) for name in values}
        errors = {name: abs(MP.mpf(value) - true[name]) for name, value in values.items()}
        left = self._left(errors, units)
        for name in self.numbers:
            if not left:
                break
            for quantity, change in self.facts.condition(true, (name,)).items():
                units[quantity] = units.get(quantity, 0) + change
            left = self._left(left, units)
        return {
            name: float(error / (UNIT_ROUNDING * units[name])) if units[name] else np.inf
            for name, error in left.items()
        }

    def _left(self, errors: dict[str, Any], units: dict[str, Any]) -> dict[str, Any]:
        allowed = self.entry.long_chains
        return {
            name: error
            for name, error in errors.items()
            if not error <= allowed.get(name, self.entry.multiple) * UNIT_ROUNDING * units[name]
        }


def wrong(
    entry: Entry,
    names: tuple[str, ...],
    inputs: dict[str, np.ndarray],
    computed: dict[str, np.ndarray],
    known: Mapping[str, np.ndarray] | None = None,
) -> tuple[list[tuple[str, float, dict[str, float]]], int]:
    """Return what breaks the rule of precision, its error and its configuration; and how many numbers were tested.

    Only values that are `known` are tested. A code that is another one, and a number where there is none (or none where
    there is one), is infinitely wrong.
    """
    catalogue, truth, tested = entry.catalogue, Truth(entry, names, inputs), 0
    codes = {name for name in names if catalogue.public_fact(name).flags}
    found = []
    for i, one, true in truth.rows():
        numbers = {}
        for name in names:
            value, exact = float(computed[name][i]), true[name]
            if known is not None and not known[name][i]:
                continue
            if bool(MP.isnan(exact)) != np.isnan(value):
                found.append((name, np.inf, one))
            elif np.isnan(value) or value == exact or (np.isinf(value) and value * exact > LARGEST):
                tested += not np.isnan(value)
            elif name in codes:
                found.append((name, np.inf, one))
            elif name in entry.errors:
                if abs(value) > entry.errors[name]:
                    found.append((name, value, one))
            else:
                numbers[name] = value
        tested += len(numbers)
        found += [(name, error, one) for name, error in truth.beyond(true, numbers).items()]
    return found, tested


def error_by_quantity(entry: Entry, name: str, by: str, one: dict[str, float]) -> float:
    """Return the error of a derivative in roundings of itself and of its quantity over the input."""
    derivative, inputs = f"d_{name}_d_{by}", {given: np.array([value]) for given, value in one.items()}
    truth = Truth(entry, (name, derivative), inputs)
    true = truth.facts.at(one)
    units = {of: abs(true[of]) + change for of, change in truth.facts.condition(true, truth.numbers).items()}
    value = plain(entry, (derivative,), inputs)[derivative][0]
    error = abs(MP.mpf(float(value)) - true[derivative])
    return float(error / (UNIT_ROUNDING * (units[derivative] + units[name] / abs(true[by]))))


def numbers_of(entry: Entry) -> tuple[str, ...]:
    """Return the quantities of an entry that are neither codes nor nothing but errors."""
    labels = {name: entry.catalogue.public_fact(name) for name in entry.names}
    return tuple(name for name, one in labels.items() if not one.flags and name not in entry.errors)


def derivatives(entry: Entry, names: tuple[str, ...], by: str, variants: tuple[str, ...]) -> dict[str, str]:
    """Return the names of the derivatives by an input, of what has one."""
    made = {}
    for name in names:
        try:
            entry.catalogue.resolve(f"d_{name}_d_{by}", variants, variants)
        except NoDerivative:
            continue
        made[name] = f"d_{name}_d_{by}"
    return made

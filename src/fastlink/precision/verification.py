"""Collect results of some designs during a sweep, then measure their errors."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import counted, joined
from fastlink.errors import ResultWarning, check_whole, remark
from fastlink.facts.powers import any_beyond_range
from fastlink.precision.errors import (
    ASSEMBLIES,
    Sample,
    affordable,
    configurations,
    refined,
    sampled,
    values,
)
from fastlink.precision.independent import TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Sequence

    import xarray as xr
    from numpy.typing import NDArray

    from fastlink.errors import KeyPath
    from fastlink.plan.programs import Output, Plan
    from fastlink.precision.errors import MeasuredErrors
    from fastlink.space.design_space import DesignSpace


#: Designs that are verified of a sweep that writes a file.
DESIGNS = 64
SEED = 0
#: Facts that are evaluated in all, each some 6 us: the time does not grow with the number of quantities. A design is at
#: least one of them, so that more designs would not be verified.
EVALUATIONS = 200_000


def check_verify(where: KeyPath, verify: Any) -> int:
    """Return the number of designs to verify, or refuse it."""
    remedy = f"write how many designs to compute again, from 0 for none to {EVALUATIONS}"
    return check_whole(where, verify, 0, EVALUATIONS, remedy)


#: Quantities that are rounding errors themselves, which have none.
OF_ERRORS = ("residual", "deviation")
#: The remedy for wrong results.
DOUBTED = "do not rely on it: ask for NAME_error (NAME_max_error) too, mend your own formulas, or report it"


def with_remark(maps: xr.Dataset) -> xr.Dataset:
    """Return a map; a warning tells if its verification has found that it is wrong, or has failed."""
    found = {str(name): one.attrs for name, one in maps.data_vars.items()}
    wrong = [name for name, attrs in found.items() if attrs.get("verify_mismatches")]
    for name in sorted(wrong, key=lambda name: -found[name].get("error_max_roundings", 0.0))[:1]:
        attrs, designs = found[name], counted(int(maps.attrs["verified_designs"]), "design")
        what = f"{name} is wrong in {attrs['verify_mismatches']:,} of {attrs['verified_values']:,} values"
        if attrs.get("independent_max_difference", 0.0) > TOLERANCE:
            what += ", by formulas that contradict the loops"
        elif "error_max_roundings" in attrs:
            what += f", by up to {attrs['error_max_roundings']:.1e} roundings"
        others = f"; so are {joined(others)}" if (others := [one for one in wrong if one != name]) else ""
        what += f", of {designs} computed again with 50 digits{others}"
        remark(what, (), DOUBTED, ResultWarning)
    if "verify_failed" in maps.attrs:
        what = f"errors are not known: the verification has ended with {maps.attrs['verify_failed']}"
        remark(what, (), "verify=0 (--verify 0) leaves it out", ResultWarning)
    return maps


class Verification:
    """A random sample of the designs of a sweep, computed again with 50 digits."""

    def __init__(self, plan: Plan, space: DesignSpace, positions: NDArray[Any], count: int) -> None:
        self.rng = np.random.default_rng(SEED)
        designs = space.some(count, self.rng)
        known = plan.catalogue.known_inputs(plan.variants)
        far = np.broadcast_to(any_beyond_range(known, space.at(designs)), designs.shape)
        self.designs = designs = designs[~far]  # the others have no numbers
        branch_indices = self.rng.integers(len(plan.branches), size=designs.size)
        # in random order, so that the first of them are a random sample too
        self.order = self.rng.permutation(designs.size)
        self.sample = Sample(plan, space.at(designs[self.order]), positions, branch_indices)
        #: The first and the last but one of some designs, and their results by output.
        self._rows: list[tuple[int, int, list[NDArray[Any]]]] = []

    def collect(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        """Copy the results of the sampled designs among start to stop; thread-safe."""
        first, last = map(int, np.searchsorted(self.designs, (start, stop)))
        if first < last:
            chosen = self.designs[first:last] - start
            self._rows.append((first, last, [array[chosen] for array in arrays]))

    def measure(self) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """Return attributes of the result, which state a failure too, and of its variables."""
        if not self.designs.size:
            return {}, {}
        started = time.perf_counter()
        try:
            groups, left_out, share = self._groups_with_results()
            errors: dict[str, MeasuredErrors] = {}
            for kind, group in groups:
                errors |= self._errors_of(kind, group, share)
        except (ArithmeticError, ValueError, LookupError, TypeError, AttributeError) as error:
            return {"verify_failed": f"{type(error).__name__}: {error}"}, {}
        attrs: dict[str, Any] = {
            "verified_designs": self.designs.size,
            "verify_seed": SEED,
            "verify_time_s": time.perf_counter() - started,
            "verify_mismatches": sum(measured.mismatches for measured in errors.values()),
        }
        if left_out:
            attrs["verify_left_out"] = " ".join(left_out)
        return attrs, {name: measured.attrs() for name, measured in errors.items()}

    def expected_time(self, count: int) -> float:
        """Return the expected time of so many designs in seconds, from the time that these take."""
        groups, _, share = self._groups_with_results()
        more = replace(self.sample, branch_indices=np.zeros(count, dtype=np.int64))
        seconds = 0.0
        for kind, group in groups:
            started = time.perf_counter()
            self._errors_of(kind, group, share)
            took = time.perf_counter() - started
            seconds += took * _compared(more, kind, group, share) / _compared(self.sample, kind, group, share)
        return seconds

    def _groups_with_results(self) -> tuple[list[tuple[str, list[Output]]], list[str], int]:
        """Give the sample its results; return `_groups` of the outputs, and the evaluations that each may take."""
        outputs = self.sample.plan.outputs
        for k, output in enumerate(outputs):
            kind = self._rows[0][2][k]
            results = np.empty((self.designs.size, *kind.shape[1:]), kind.dtype)
            for first, last, arrays in self._rows:
                results[first:last] = arrays[k]
            self.sample.results[output.name] = results[self.order]
        groups, left_out = _groups(outputs)
        return groups, left_out, EVALUATIONS // max(len(groups), 1)

    def _errors_of(self, kind: str, group: list[Output], share: int) -> dict[str, MeasuredErrors]:
        if kind == "values":
            return values(self.sample, group, share, self.rng)
        return (refined if kind == "refined" else sampled)(self.sample, group, share)


def _compared(sample: Sample, kind: str, group: list[Output], share: int) -> int:
    """Return how many designs or configurations of a sample are compared."""
    if kind == "values":
        return configurations(sample, group, share)
    quantity = group[0].request.quantity
    if group[0].is_assembly:
        return min(sample.count, ASSEMBLIES)
    if kind == "refined":
        return affordable(sample, quantity, share, group)
    return sample.affordable(sample.facts([quantity]), share, sample.count)


def _groups(outputs: Sequence[Output]) -> tuple[list[tuple[str, list[Output]]], list[str]]:
    """Return the outputs by method and quantity, and the names of unverified ones."""
    groups: dict[tuple[str, str], list[Output]] = {}
    left_out = []
    names = {output.name for output in outputs}
    for output in outputs:
        request = output.request
        alone = request.is_error and request.value not in names
        if (
            alone
            or request.other
            or request.is_of_gradient
            or any(word in request.quantity for word in OF_ERRORS)
        ):
            left_out.append(output.name)
        elif output.refined:
            of = "" if output.is_assembly else request.quantity
            groups.setdefault(("refined", of), []).append(output)
        elif request.reduction is not None:
            groups.setdefault(("sampled", request.quantity), []).append(output)
        else:
            groups.setdefault(("values", ""), []).append(output)
    return [(kind, group) for (kind, _), group in groups.items()], left_out

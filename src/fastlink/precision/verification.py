"""Keep the results of some designs while a sweep runs, then compare them with 50-digit ones."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.errors import InputError
from fastlink.precision.extrema import refined
from fastlink.precision.pointwise import sampled, values
from fastlink.precision.sample import Chosen

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from fastlink.plan.plan import Plan
    from fastlink.plan.program import Output
    from fastlink.precision.errors import Measured
    from fastlink.space.design_space import DesignSpace

__all__ = ["Verification", "check_verify"]

#: Designs of a sweep that writes a file.
DESIGNS = 64
SEED = 0
#: Facts that are evaluated in all, each some 6 us: what a verification costs does not grow with what is asked for.
EVALUATIONS = 200_000


def check_verify(verify: int | None, lasting: bool) -> int:
    """Return how many designs are computed again; by default some of a result that is written to a file.

    Raises
    ------
    InputError
        It is no whole number, or less than 0.
    """
    if verify is None:
        return DESIGNS if lasting else 0
    if isinstance(verify, bool) or not isinstance(verify, int) or verify < 0:
        remedy = "write how many designs to compute again, 0 for none"
        raise InputError(f"is {verify!r}", where=("verify",), remedy=remedy)
    return verify


class Verification:
    """A random subset of the designs of a sweep, to be computed again.

    Parameters
    ----------
    plan : PlanSet
        What was asked for.
    space : DesignSpace
        The designs.
    positions : array
        The input positions.
    count : int
        How many designs; all of them where there are fewer.
    """

    def __init__(self, plan: Plan, space: DesignSpace, positions: NDArray[Any], count: int) -> None:
        self.rng = np.random.default_rng(SEED)
        self.designs = designs = space.some(count, self.rng)
        places = self.rng.integers(len(plan.branches), size=designs.size)
        # A subset of these is a random one, too.
        self.order = self.rng.permutation(designs.size)
        self.chosen = Chosen(plan, space.at(designs[self.order]), positions, places)
        self._lock = threading.Lock()
        self._kept: list[NDArray[Any]] = []

    def take(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        """Keep the results of the chosen designs among start to stop; thread-safe."""
        first, last = np.searchsorted(self.designs, (start, stop))
        if first == last:
            return
        with self._lock:
            if not self._kept:
                self._kept = [np.empty((self.designs.size, *a.shape[1:]), a.dtype) for a in arrays]
        for kept, array in zip(self._kept, arrays, strict=True):
            kept[first:last] = array[self.designs[first:last] - start]

    def measure(self) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """Return attributes of the whole result, and of its variables; what fails is said in one of them."""
        if not self.designs.size:
            return {}, {}
        started = time.perf_counter()
        try:
            found, left_out = self._measured()
        except (ArithmeticError, ValueError, LookupError, TypeError, AttributeError) as error:
            return {"verify_failed": f"{type(error).__name__}: {error}"}, {}
        attrs: dict[str, Any] = {
            "verified_designs": self.designs.size,
            "verify_seed": SEED,
            "verify_time_s": time.perf_counter() - started,
            "verify_mismatches": sum(measured.mismatches for measured in found.values()),
        }
        if left_out:
            attrs["verify_left_out"] = " ".join(left_out)
        return attrs, {name: measured.attrs() for name, measured in found.items()}

    def _measured(self) -> tuple[dict[str, Measured], list[str]]:
        """Return the errors of each variable, and the names of those that are left out."""
        outputs = self.chosen.plan.outputs
        for output, rows in zip(outputs, self._kept, strict=True):
            self.chosen.results[output.name] = rows[self.order]
        groups, left_out = _groups(outputs)
        share = EVALUATIONS // max(len(groups), 1)
        found: dict[str, Measured] = {}
        for kind, group in groups:
            if kind == "values":
                found |= values(self.chosen, group, share, self.rng)
            else:
                found |= (refined if kind == "refined" else sampled)(self.chosen, group, share)
        return found, left_out


def _groups(outputs: Sequence[Output]) -> tuple[list[tuple[str, list[Output]]], list[str]]:
    """Return outputs that are computed again together, by how, and the names of those that are not."""
    groups: dict[tuple[str, str], list[Output]] = {}
    left_out = []
    for output in outputs:
        request = output.request
        if "residual" in request.quantity:
            # a residual is an error itself
            left_out.append(output.name)
        elif output.refined:
            groups.setdefault(("refined", request.quantity), []).append(output)
        elif request.reduction is not None:
            groups.setdefault(("sampled", request.quantity), []).append(output)
        else:
            groups.setdefault(("values", ""), []).append(output)
    return [(kind, group) for (kind, _), group in groups.items()], left_out

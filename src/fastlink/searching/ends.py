"""The ends of refinements as labelled designs: what was gained, how each ended, what holds it back."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fastlink._text import counted, in_words, short_number
from fastlink.maps.best import ACTIVE, GAIN, REFINEMENT, STARTS
from fastlink.maps.front import nondominated
from fastlink.searching.descent import Descent, Outcome
from fastlink.space.design_space import DESIGN

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from fastlink.searching.model import Results
    from fastlink.searching.points import Looked, Points
    from fastlink.searching.spans import Span

__all__ = ["Aim", "End", "labelled"]

MEANINGS = {
    Outcome.CONVERGED: "converged",
    Outcome.NOTHING_TO_GAIN: "nothing_to_gain",
    Outcome.OUT_OF_STEPS: "out_of_steps",
    Outcome.BLOCKED: "blocked_by_a_code_or_where_there_is_no_value",
    Outcome.NO_DERIVATIVE: "no_derivative_at_the_start",
    Outcome.NOT_REPRODUCED: "not_what_the_map_says",
}
REFERENCE = "docs/design_search.md"


@dataclass(frozen=True, eq=False)
class End:
    """A design at which a refinement ended.

    Attributes
    ----------
    row : int
        The number of its start.
    reader, points : Results, Points
        What computes its results, and the designs that can be reached.
    descent : Descent
        How it was reached.
    design : array
        Its inputs.
    starts : int
        From how many starts.
    """

    row: int
    reader: Results
    points: Points
    descent: Descent
    design: NDArray[np.float64]
    starts: int = 1


@dataclass(frozen=True, eq=False)
class Aim:
    """Results and inputs that a refinement looks at, the units of a map, and how many rows may be starts."""

    results: Sequence[Looked]
    spans: Sequence[Span]
    units: Mapping[str, str]
    rows: int


def labelled(result: xr.Dataset, found: xr.Dataset, ends: Sequence[End], aim: Aim) -> xr.Dataset:
    """Return the designs with how each was refined, best first; of a front those that none beats."""
    aims = [one for one in aim.results if one.sign]
    for one in aims:
        before, after = found[one.name].values, result[one.name].values
        of = result[one.name].attrs
        attrs = {"units": of.get("units", "1"), "references": REFERENCE}
        attrs["long_name"] = f"Gain by refinement of: {of.get('long_name', one.name)}"
        with np.errstate(invalid="ignore"):
            result[f"{one.name}_{GAIN}"] = (DESIGN,), one.sign * (before - after), attrs
    codes = np.array([int(one.descent.outcome) for one in ends], dtype=np.int8)
    attrs = {"long_name": "How the refinement ended", "references": REFERENCE}
    attrs["flag_values"] = np.array([int(one) for one in MEANINGS], dtype=np.int8)
    attrs["flag_meanings"] = " ".join(MEANINGS.values())
    result[REFINEMENT] = (DESIGN,), codes, attrs
    attrs = {"long_name": "Number of starts whose refinement ended in this design", "references": REFERENCE}
    result[STARTS] = (DESIGN,), np.array([one.starts for one in ends], dtype=np.int32), attrs
    attrs = {"long_name": "What holds the design back", "references": REFERENCE}
    texts = np.array([_active(aim, one.descent) for one in ends], dtype=str)
    result = result.assign_coords({ACTIVE: ((DESIGN,), texts, attrs)})
    points = np.stack([one.sign * result[one.name].values for one in aims], axis=1)
    order = np.argsort(points[:, 0], kind="stable") if len(aims) == 1 else nondominated(points)
    beaten = len(points) - len(order)
    endings = Counter(in_words(MEANINGS[one.descent.outcome]) for one in ends)
    starts = sum(one.starts for one in ends)
    some = f" from {starts:,} of these" if starts < aim.rows else ""
    ended = f" to {counted(len(ends), 'different design')}" if len(ends) < starts else ""
    about = ", ".join(f"{count:,} {meaning}" for meaning, count in endings.items()) or "none"
    dropped = f"; {beaten:,} that others beat then are left out" if beaten else ""
    result = result.isel({DESIGN: order})
    result.attrs["selection"] = f"{found.attrs.get('selection', '')}; refined{some}{ended}: {about}{dropped}"
    return result


def _active(aim: Aim, descent: Descent) -> str:
    """Return the limits that hold a design back."""
    shown = [one for one in aim.results if not one.is_code]
    held: list[tuple[Looked | Span, int]] = [(shown[k], sign) for k, sign in sorted(descent.limits)]
    held += [(aim.spans[j], sign) for j, sign in sorted(descent.ends)]

    def units(one: Looked | Span) -> str:
        of = aim.units.get(one.name, "1")
        return "" if of == "1" else f" {of}"

    texts = (
        f"{one.name} {'<=' if sign > 0 else '>='} {short_number(one.high if sign > 0 else one.low)}{units(one)}"
        for one, sign in held
    )
    return ", ".join(texts)

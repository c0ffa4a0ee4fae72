"""Refine designs that were selected from a map: off its grid, by derivatives, within what was asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.engine.declared import is_own, own_refused
from fastlink.engine.labels import request_labels
from fastlink.errors import InputError, Problems
from fastlink.maps.units import check_units, units_of
from fastlink.plan.query import Request, parse_request
from fastlink.searching.descent import Descent, Outcome, Task, descend
from fastlink.searching.ends import Aim, End, labelled
from fastlink.searching.model import Model, Results
from fastlink.searching.points import Looked, Points
from fastlink.searching.spans import Span, swept_inputs, within
from fastlink.searching.starts import Starts, is_one_design
from fastlink.space.design_space import BRANCH, DESIGN, EXTREMUM
from fastlink.symbolic.changes import is_tolerance

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from fastlink.maps.best import Objective
    from fastlink.maps.conditions import Condition

__all__ = ["Refinement"]

#: How far the value of a map may be from that which the mechanism has there: results may be in single precision.
REPRODUCED = 1e-6


class Refinement:
    """The refinement of designs of a map.

    Parameters
    ----------
    maps : xarray.Dataset
        The map, or any labelled part of it: its labels alone are read.
    model : Model
        What computes its results.
    spans : sequence of Span
        The inputs that may change.
    objectives : sequence of Objective
        What is to be least or greatest.
    wanted : sequence of Condition
        What must hold.

    Raises
    ------
    InputError
        Something is asked for that nothing computes between the designs of a map.
    """

    def __init__(
        self,
        maps: xr.Dataset,
        model: Model,
        spans: Sequence[Span],
        objectives: Sequence[Objective],
        wanted: Sequence[Condition],
    ) -> None:
        self.model, catalogue = model, model.catalogue
        self.position = catalogue.position.name
        arrays = [*(one.array for one in objectives), *(one.array for one in wanted)]
        dims = {str(dim) for array in arrays for dim in array.dims}
        self.at_position = self.position in dims
        #: The results of a row: those of one position, the others.
        self.pointwise = {str(name) for name, one in maps.variables.items() if self.position in one.dims}
        self.inputs = [*swept_inputs(catalogue, maps), *([self.position] if self.at_position else [])]
        self.spans = within([*spans, *([self._of_position(maps)] if self.at_position else [])], wanted)
        self.results = self._results(maps, objectives, wanted)
        self.units = units_of(maps)
        self._readers: dict[tuple[Any, ...], Results] = {}

    def _of_position(self, maps: xr.Dataset) -> Span:
        """Return the range of the input position: that of the map, or a whole turn where it goes all around."""
        own = np.sort(np.asarray(maps[self.position].values, dtype=np.float64).ravel())
        catalogue = self.model.catalogue
        step = np.diff(own).max(initial=0.0)
        all_around = catalogue.positions is None and own[-1] - own[0] + step >= 2.0 * np.pi * (1.0 - 1e-9)
        return Span(self.position, float(own[0]), float(own[-1]), period=2.0 * np.pi if all_around else 0.0)

    def _results(
        self, maps: xr.Dataset, objectives: Sequence[Objective], wanted: Sequence[Condition]
    ) -> list[Looked]:
        """Return what is looked at, the codes last, or refuse what nothing computes."""
        problems, found, codes = Problems(), dict[str, dict[str, Any]](), list[Looked]()
        for aim in objectives:
            with problems.at():
                name = self._computed(maps, aim.array, "minimise" if aim.sign > 0.0 else "maximise")
                found[name] = {"sign": aim.sign}
        fixed = {BRANCH, *(n for n in maps.coords if n not in self.inputs), *(one.name for one in self.spans)}
        for one in wanted:
            if one.array.name in fixed and one.array.dtype.kind != "b":
                continue  # which holds for the start and stays, or belongs to the range
            with problems.at():
                name = self._computed(maps, one.array, "where")
                if one.codes is not None or one.array.dtype.kind != "f":
                    codes.append(Looked(name, condition=one))
                else:
                    found.setdefault(name, {})
                    found[name] |= {"low": one.low, "high": one.high}
        problems.stop()
        return [*(Looked(name, **given) for name, given in found.items()), *codes]

    def _computed(self, maps: xr.Dataset, array: xr.DataArray, where: str) -> str:
        """Return the name of a variable that is computed anywhere, or refuse it."""
        name, catalogue = str(array.name), self.model.catalogue
        remedy = "name quantities of the mechanism, or leave refine out"
        if name in self.inputs and array.dtype.kind != "b":
            return name
        if array.name is None or array.dtype.kind == "b":
            what = "is a mask, which is known for the designs of the map alone"
            raise InputError(what, where=(where,), remedy="write ranges such as {'a1': (None, 0.5)}")
        request = self._request(name)
        if request is None and is_own(name, str(maps.attrs.get("own_quantities", ""))):
            raise own_refused((where,), name)
        if request is None:
            what = (
                f"{name!r} is not a quantity of {catalogue.name}, and unknown between the designs of the map"
            )
            raise InputError(what, where=(where,), remedy=remedy)
        if request.reduction is not None and not self.model.knows_positions:
            what = f"{name!r} is of the values of {self.position} of the sweep, which the map does not hold"
            remedy = f"ask for a quantity along {self.position} too, or search by fl.search"
            raise InputError(what, where=(where,), remedy=remedy)
        if EXTREMUM in array.dims or (where != "where" and (request.listed or request.is_error)):
            what = (
                f"{name!r} is {'one of a list' if request.listed else 'an error bound'}, which has no slope"
            )
            raise InputError(what, where=(where,), remedy=remedy)
        if array.dtype.kind != "f" and where != "where":
            raise InputError(f"{name!r} is a whole number", where=(where,), remedy=remedy)
        if array.dtype.kind == "f":
            check_units(array, str(request_labels(catalogue, request).get("units", "1")), (where, name))
        return name

    def _request(self, name: str) -> Request | None:
        """Return the request for a result by its name, None of what is none."""
        try:
            return parse_request(name, self.model.catalogue)
        except InputError:
            return None

    def of(
        self,
        found: xr.Dataset,
        *,
        searched: int,
        top: int | None = None,
        whole: Callable[[list[int]], xr.Dataset] | None = None,
        show: Callable[[int], None] = lambda count: None,
    ) -> xr.Dataset:
        """Return selected designs after their refinement, each once, the best first, with what was gained.

        Parameters
        ----------
        found : xarray.Dataset
            Designs of the map along ``design``, in memory, the best first.
        searched : int
            How many rows they are the best of.
        top : int, optional
            How many different designs are wanted; all that these lead to unless given.
        whole : callable, optional
            Returns rows of `found` by their numbers with all that the map says of them.
        show : callable
            Is told how many designs are done.
        """
        ends = list[End]()
        starts = self._starts(found, searched, top)
        for row in starts:
            one = self._ended(found.isel({DESIGN: row}), row)
            if isinstance(starts, Starts):
                starts.ended(row, self._shares(one.design))
            if self._noted(ends, one):
                show(1)
            if len(ends) == top:
                break
        kept = [one.row for one in ends]
        own = whole(kept) if whole is not None else found.isel({DESIGN: kept})
        designs = np.array([one.design for one in ends]).reshape(-1, len(self.inputs)).T
        aim = Aim(self.results, self.spans, self.units, found.sizes[DESIGN])
        return labelled(self._again(own, designs), own, ends, aim)

    def _starts(self, found: xr.Dataset, searched: int, top: int | None) -> Starts | range:
        """Return the numbers of the rows from which to start."""
        if top is None:
            return range(found.sizes[DESIGN])
        inputs = np.array([found[name].values for name in self.inputs])
        changing = [self.inputs.index(span.name) for span in self.spans]
        other = [k for k in range(len(self.inputs)) if k not in changing]
        followers = {name for span in self.spans for name, _ in span.followers}
        other = [k for k in other if self.inputs[k] not in followers]
        codes = [
            str(n)
            for n in found.coords
            if n not in self.inputs and found[n].dtype.kind in "iuf" and n != DESIGN
        ]
        fixed = [inputs[k] for k in other] + [
            np.broadcast_to(found[name].values, inputs.shape[1]) for name in codes
        ]
        groups = [*zip(*fixed, strict=True)] or [()] * inputs.shape[1]
        return Starts(self._shares(inputs).T, groups, searched, top)

    def _shares(self, designs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the inputs that may change, as shares of their ranges."""
        widths = [max(span.high - span.low, span.period) for span in self.spans]
        rows = designs[[self.inputs.index(span.name) for span in self.spans]]
        shares: NDArray[np.float64] = (rows.T / np.array(widths)).T
        return shares

    def _noted(self, ends: list[End], new: End) -> bool:
        """Add an end, or count it with one that is the same design; tell whether it is a new one."""
        for k, old in enumerate(ends):
            if old.reader is not new.reader:
                continue
            worse, better = (old, new) if self._is_better(new, old) else (new, old)
            if is_one_design(worse.points, worse.descent, better.design):
                ends[k] = replace(better, starts=old.starts + 1)
                return False
        ends.append(new)
        return True

    def _is_better(self, one: End, other: End) -> bool:
        """Tell whether an end is better in the first objective."""
        return bool(
            one.descent.values[0] * self.results[0].sign < other.descent.values[0] * self.results[0].sign
        )

    def _ended(self, row: xr.Dataset, number: int) -> End:
        """Return the end of the descent from one design."""
        reader = self._reader(row)
        start = np.array([float(row[name]) for name in self.inputs])
        points = Points(reader, self.results, self.spans, start)
        descent = self._descent(points, row)
        design = start if descent.point is points.begin else points.designs(descent.point[None])[:, 0]
        return End(number, reader, points, descent, design if design is start else self._wrapped(design))

    def _descent(self, points: Points, row: xr.Dataset) -> Descent:
        aims = [one for one in self.results if one.sign]
        expected = np.array([float(row[one.name]) for one in aims])
        own = points.values(points.begin[None])[0][0]
        if not np.allclose(own[: len(aims)], expected, rtol=REPRODUCED, atol=0.0, equal_nan=True):
            return Descent(points.begin, own, Outcome.NOT_REPRODUCED, np.ones(len(own)))
        low, high, signs = points.limits
        return descend(Task(points.values, points.slopes, signs, low, high), points.begin)

    def _wrapped(self, design: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return a design whose input position, where it goes all around, is in the turn of the map."""
        span = self.spans[-1]
        if span.period:
            design[-1] = span.low + (design[-1] - span.low) % span.period
        return design

    def _reader(self, row: xr.Dataset) -> Results:
        """Return what computes the results of a row, the same for all rows of one assembly mode."""
        branch = int(row[BRANCH]) if BRANCH in row.variables else 1
        links = self.model.options.get("links")
        own = {} if links is None else links.values
        catalogue = self.model.catalogue
        fixed = {
            name: float(row[name])
            for name in (
                *catalogue.known_inputs(catalogue.variant_inputs),
                *filter(is_tolerance, map(str, row.coords)),
            )
            if name in row.variables and name not in self.inputs and name not in own
        }
        key = (branch, *fixed.items())
        if key not in self._readers:
            names = tuple(one.name for one in self.results if one.name not in self.inputs)
            pointwise = tuple(name in self.pointwise for name in names)
            options: dict[str, Any] = {"codes": fixed, "at_position": self.at_position}
            self._readers[key] = Results(self.model, names, pointwise, tuple(self.inputs), branch, **options)
        return self._readers[key]

    def _again(self, found: xr.Dataset, designs: NDArray[np.float64]) -> xr.Dataset:
        """Return the designs with other inputs, and all their results anew, to the bits of a sweep."""
        names = [str(name) for name in found.data_vars if self._request(str(name)) is not None]
        others = [name for name in found.data_vars if name not in names]
        result = found.drop_vars(others).copy()
        for name, values in zip(self.inputs, designs, strict=True):
            result[name] = (DESIGN,), values, found[name].attrs
        values = {name: np.empty(designs.shape[1], found[name].dtype) for name in names}
        groups: dict[int, tuple[Results, list[int]]] = {}
        for row in range(designs.shape[1]):
            reader = self._reader(found.isel({DESIGN: row}))
            groups.setdefault(id(reader), (reader, []))[1].append(row)
        for reader, rows in groups.values():
            pointwise = tuple(name in self.pointwise for name in names)
            whole = Results(
                self.model,
                tuple(names),
                pointwise,
                reader.inputs,
                reader.branch,
                reader.codes,
                reader.at_position,
            )
            for name, column in zip(names, whole.values(designs[:, rows]).T, strict=True):
                values[name][rows] = column
        for name in names:
            result[name] = (DESIGN,), values[name], _unmeasured(found[name].attrs)
        return result


def _unmeasured(attrs: Mapping[Any, Any]) -> dict[Any, Any]:
    """Return the attributes of a result without the errors that were measured on other designs."""
    from fastlink.io.converting.labels import MEASURED

    return {name: value for name, value in attrs.items() if not str(name).startswith(MEASURED)}

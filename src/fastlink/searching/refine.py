"""Refine designs that were selected from a map: off its grid, by derivatives, within what was asked for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import in_words, short_number
from fastlink.engine.labels import request_labels
from fastlink.errors import InputError, Problems
from fastlink.maps.best import ACTIVE, GAIN, REFINEMENT
from fastlink.maps.front import nondominated
from fastlink.maps.units import check_units, units_of
from fastlink.plan.query import Request, parse_request
from fastlink.searching.descent import Descent, Outcome, Task, descend
from fastlink.searching.model import Model, Results
from fastlink.searching.points import Looked, Points
from fastlink.searching.spans import Span, swept_inputs, within
from fastlink.space.design_space import BRANCH, DESIGN, EXTREMUM

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from fastlink.maps.best import Objective
    from fastlink.maps.conditions import Condition

__all__ = ["Refinement"]

MEANINGS = {
    Outcome.CONVERGED: "converged",
    Outcome.NOTHING_TO_GAIN: "nothing_to_gain",
    Outcome.OUT_OF_STEPS: "out_of_steps",
    Outcome.BLOCKED: "blocked_by_a_code_or_where_there_is_no_value",
    Outcome.NO_DERIVATIVE: "no_derivative_at_the_start",
    Outcome.NOT_REPRODUCED: "not_what_the_map_says",
}
REFERENCE = "docs/design_search.md"
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
        if maps.attrs.get("own_quantities"):
            remedy = "write mechanism=..., what fastlink.extend returned when the map was made, or leave refine out"
        if name in self.inputs and array.dtype.kind != "b":
            return name
        if array.name is None or array.dtype.kind == "b":
            what = "is a mask, which is known for the designs of the map alone"
            raise InputError(what, where=(where,), remedy="write ranges such as {'a1': (None, 0.5)}")
        request = self._request(name)
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

    def of(self, found: xr.Dataset, show: Callable[[int], None] = lambda count: None) -> xr.Dataset:
        """Return selected designs after their refinement, the best first, with what was gained.

        Parameters
        ----------
        found : xarray.Dataset
            Designs of the map along ``design``, in memory.
        show : callable
            Is told how many designs are done.
        """
        descents, designs = list[Descent](), np.empty((len(self.inputs), found.sizes[DESIGN]))
        for row in range(found.sizes[DESIGN]):
            one = found.isel({DESIGN: row})
            descent, designs[:, row] = self._descended(one)
            descents.append(descent)
            show(1)
        return self._labelled(self._again(found, designs), found, descents)

    def _descended(self, row: xr.Dataset) -> tuple[Descent, NDArray[np.float64]]:
        """Return the descent from one design, and the inputs of where it ends."""
        start = np.array([float(row[name]) for name in self.inputs])
        points = Points(self._reader(row), self.results, self.spans, start)
        aims = [one for one in self.results if one.sign]
        expected = np.array([float(row[one.name]) for one in aims])
        own = points.values(points.begin[None])[0][0][: len(aims)]
        if not np.allclose(own, expected, rtol=REPRODUCED, atol=0.0, equal_nan=True):
            return Descent(points.begin, own, Outcome.NOT_REPRODUCED), start
        signs, lows, highs = np.array([(r.sign, r.low, r.high) for r in self.results if not r.is_code]).T
        descent = descend(Task(points.values, points.slopes, signs, lows, highs), points.begin)
        if descent.point is points.begin:
            return descent, start
        return descent, self._wrapped(points.designs(descent.point[None])[:, 0])

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
            for name in catalogue.known_inputs(catalogue.variant_inputs)
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

    def _labelled(self, result: xr.Dataset, found: xr.Dataset, descents: Sequence[Descent]) -> xr.Dataset:
        """Return the designs with how each was refined, best first; of a front those that none beats."""
        aims = [one for one in self.results if one.sign]
        for one in aims:
            before, after = found[one.name].values, result[one.name].values
            of = result[one.name].attrs
            attrs = {"units": of.get("units", "1"), "references": REFERENCE}
            attrs["long_name"] = f"Gain by refinement of: {of.get('long_name', one.name)}"
            with np.errstate(invalid="ignore"):
                result[f"{one.name}_{GAIN}"] = (DESIGN,), one.sign * (before - after), attrs
        codes = np.array([int(one.outcome) for one in descents], dtype=np.int8)
        attrs = {"long_name": "How the refinement ended", "references": REFERENCE}
        attrs["flag_values"] = np.array([int(one) for one in MEANINGS], dtype=np.int8)
        attrs["flag_meanings"] = " ".join(MEANINGS.values())
        result[REFINEMENT] = (DESIGN,), codes, attrs
        attrs = {"long_name": "What holds the design back", "references": REFERENCE}
        texts = np.array([self._active(one) for one in descents], dtype=str)
        result = result.assign_coords({ACTIVE: ((DESIGN,), texts, attrs)})
        points = np.stack([one.sign * result[one.name].values for one in aims], axis=1)
        order = np.argsort(points[:, 0], kind="stable") if len(aims) == 1 else nondominated(points)
        beaten = len(points) - len(order)
        endings = Counter(in_words(MEANINGS[one.outcome]) for one in descents)
        about = ", ".join(f"{count:,} {meaning}" for meaning, count in endings.items()) or "none"
        dropped = f"; {beaten:,} that others beat then are left out" if beaten else ""
        result = result.isel({DESIGN: order})
        result.attrs["selection"] = f"{found.attrs.get('selection', '')}; refined: {about}{dropped}"
        return result

    def _active(self, descent: Descent) -> str:
        """Return the limits that hold a design back."""
        shown = [one for one in self.results if not one.is_code]
        held: list[tuple[Looked | Span, int]] = [(shown[k], sign) for k, sign in sorted(descent.limits)]
        held += [(self.spans[j], sign) for j, sign in sorted(descent.ends)]

        def units(one: Looked | Span) -> str:
            of = self.units.get(one.name, "1")
            return "" if of == "1" else f" {of}"

        texts = (
            f"{one.name} {'<=' if sign > 0 else '>='} {short_number(one.high if sign > 0 else one.low)}{units(one)}"
            for one, sign in held
        )
        return ", ".join(texts)


def _unmeasured(attrs: Mapping[Any, Any]) -> dict[Any, Any]:
    """Return the attributes of a result without the errors that were measured on other designs."""
    from fastlink.io.converting.labels import MEASURED

    return {name: value for name, value in attrs.items() if not str(name).startswith(MEASURED)}

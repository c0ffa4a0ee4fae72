"""The request of a search, and its result as a map of the designs that were found."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from fastlink._text import joined
from fastlink.engine import labels
from fastlink.engine.needs import allocated
from fastlink.engine.sweep import sweep
from fastlink.errors import InputError
from fastlink.io.dataset import Variable, plain_attrs
from fastlink.io.history import HISTORY, history
from fastlink.io.writing.writer import Writer
from fastlink.maps.best import ACTIVE, GAIN, REFINEMENT, STARTS, Choice, choice_of
from fastlink.searching.model import Model, angles_of
from fastlink.searching.refine import Refinement
from fastlink.searching.spans import spans_of_space
from fastlink.searching.starts import candidates
from fastlink.searching.stream import Kept, Stream
from fastlink.space.dataset import FORMAT
from fastlink.space.design_space import DESIGN
from fastlink.space.samplers import table

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fastlink.engine.resolve import ResolvedSweep

__all__ = ["Request", "labels_of", "write"]

#: What the attributes begin with that are true of the designs that were searched, not of those that were found.
SEARCHED = "searched_"


@dataclass
class Request:
    """A search whose parts were checked.

    Attributes
    ----------
    mechanism : str or Extension
        The mechanism, as it was given.
    resolved : ResolvedSweep
        The sweep of what objectives and conditions need.
    options : dict
        The options of the sweeps of designs that were found.
    quantities : tuple of str
        What is computed of these.
    only : tuple of str or None
        The inputs that a refinement may change, none named for all; None for no refinement.
    bounds : dict
        Ranges of refined designs, where they are not those of the space.
    labels : xarray.Dataset
        The labels of the sweep, with one design.
    attrs : dict
        Further attributes of the result.
    """

    mechanism: Any
    resolved: ResolvedSweep
    options: dict[str, Any]
    quantities: tuple[str, ...]
    only: tuple[str, ...] | None
    bounds: Mapping[str, tuple[float, float]]
    labels: xr.Dataset
    attrs: Mapping[str, Any] = field(default_factory=dict)
    choice: Choice = field(init=False)
    refinement: Refinement | None = field(init=False, default=None)

    @classmethod
    def of(
        cls,
        mechanism: Any,
        resolved: ResolvedSweep,
        ways: Mapping[str, Any],
        **given: Any,
    ) -> Request:
        """Return the request of a resolved sweep, of which the options are given too."""
        names = ("links", "input", "solver", "backend", "branch")
        options = {name: ways[name] for name in names if name in ways}
        options |= {"extrema": resolved.plan.extrema or None, "threads": None}
        options |= angles_of(resolved.catalogue, resolved.positions)
        return cls(mechanism, resolved, options, labels=labels_of(resolved), **given)

    def choose(self, **asked: Any) -> None:
        """Set what is searched for, and how it is refined, or refuse it."""
        self.choice = choice = choice_of(self.labels, **asked)
        for one in choice.wanted:
            if one.array.dtype.kind == "b":
                remedy = "write conditions by name, such as {'a1': (None, 0.5)}"
                raise InputError("is a mask of one map", where=("where",), remedy=remedy)
        if self.only is not None:
            catalogue = self.resolved.catalogue
            spans = spans_of_space(catalogue, self.resolved.space, self.bounds, self.only)
            of_model = {n: self.options.get(n) for n in ("links", "input", "solver", "extrema", "angles")}
            model = Model(self.mechanism, of_model)
            self.refinement = Refinement(self.labels, model, spans, choice.objectives, choice.wanted)

    @property
    def along(self) -> dict[str, NDArray[Any]]:
        """The values of the dimensions that rows may have besides the design."""
        return {str(dim): self.labels[dim].values for dim in self.labels.dims if dim != DESIGN}

    @property
    def kept(self) -> Choice:
        """Which rows the sweep keeps: of one objective more than are wanted, where several may lead to one design."""
        refined = self.refinement is not None and len(self.choice.objectives) == 1
        return replace(self.choice, top=candidates(self.choice.top)) if refined else self.choice

    @property
    def fingerprint(self) -> str:
        """A hash of all that the result depends on."""
        choice = self.choice
        aims = [(one.array.name, one.sign) for one in choice.objectives]
        wanted = [(one.array.name, one.codes, one.low, one.high) for one in choice.wanted]
        spans = None if self.refinement is None else self.refinement.spans
        own = (
            aims,
            wanted,
            choice.top,
            self.kept.top,
            choice.infinite,
            spans,
            self.quantities,
            self.options.get("links"),
        )
        attrs = sorted((name, repr(value)) for name, value in plain_attrs(self.attrs).items())
        return hashlib.sha256(repr((self.resolved.fingerprint, own, attrs)).encode()).hexdigest()

    def about(self) -> dict[str, Any]:
        """Return what was searched, as attributes."""
        choice = self.choice
        aims = joined([str(one) for one in choice.objectives])
        conditions = joined([str(one) for one in choice.wanted])
        text = f"the {aims}{' where ' if conditions else ''}{conditions}"
        return {**self.attrs, "mechanism": self.resolved.mechanism, "search": text}

    def rows(self, columns: Mapping[str, Any], places: Mapping[str, NDArray[np.int64]], names: Sequence[str],
             verify: int = 0) -> xr.Dataset:  # fmt: skip
        """Return designs with their results, as a sweep gives them, a row each.

        Parameters
        ----------
        columns : mapping
            The inputs of the designs, and their numbers as ``design``.
        places : mapping
            The places of the rows along further dimensions.
        names : sequence of str
            The results.
        verify : int
            How many are computed again.
        """
        links = self.options.get("links")
        own = {} if links is None else links.values
        given = {name: values for name, values in columns.items() if name not in own}
        space = table(given, keep=[name for name in given if name in self.resolved.space.labels])
        swept = sweep(self.mechanism, space, names, **self.options, verify=verify, progress=False)
        count = swept.sizes[DESIGN]
        index = {dim: xr.DataArray(at, dims=DESIGN) for dim, at in places.items()}
        return swept.isel({DESIGN: xr.DataArray(np.arange(count), dims=DESIGN), **index})

    def found(self, stream: Stream, kept: Kept, verify: int, show: Any) -> xr.Dataset:
        """Return the designs that were found, refined if they are to be, as a map."""
        rows = stream.ordered(kept)
        designs, places = stream.rows.places(rows)
        space = self.resolved.space
        columns: dict[str, Any] = {DESIGN: designs, **space.at(designs)}
        columns |= {name: space.constants[name] for name in space.constants}
        of_row = space.size // space.shape[0] if space.dims else 1
        for name, label in space.labels.items():
            columns[name] = np.array([label[k] for k in designs // of_row]) if np.ndim(label) else label
        searched = [name for name in stream.outputs if name != "status"] or ["status"]
        names = list(self.quantities) or ["status"]
        if self.refinement is None:
            return self.rows(columns, places, names, verify)
        top = None if stream.several else self.choice.top
        starts, size = self.rows(columns, places, searched), space.size * stream.rows.of_design
        refined = self.refinement.of(starts, searched=size, top=top, show=show)
        if self.refinement.at_position:
            return refined
        moved = {name: refined[name].values if name in refined else given for name, given in columns.items()}
        moved = {name: values if np.ndim(values) else values[()] for name, values in moved.items()}
        places = {dim: np.searchsorted(self.along[dim], refined[dim].values) for dim in places}
        result = self.rows(moved, places, names, verify)
        added = [
            str(n) for n in refined.data_vars if str(n).endswith(f"_{GAIN}") or n in (REFINEMENT, STARTS)
        ]
        result = result.assign({name: refined[name].variable for name in added})
        result.attrs["selection"] = refined.attrs["selection"]
        return result.assign_coords({ACTIVE: refined[ACTIVE].variable})

    def counts(self, stream: Stream, kept: Kept) -> dict[str, Any]:
        """Return how many designs were searched, and why others were left out, as attributes."""
        size = self.resolved.space.size
        attrs: dict[str, Any] = {
            f"{SEARCHED}{name}": value for name, value in self.resolved.space.attrs.items()
        }
        attrs |= {f"{SEARCHED}designs": size, f"{SEARCHED}rows": size * stream.rows.of_design}
        flags = self.resolved.catalogue.facts["status"].flags
        attrs |= {f"{SEARCHED}designs_{meaning}": int(kept.designs[code]) for code, meaning in flags.items()}
        for one, count in zip(self.choice.wanted, kept.failed.tolist(), strict=True):
            attrs[f"excluded_by_{one.array.name}"] = count
        attrs |= {"excluded_as_not_a_number": kept.not_numbers, "excluded_as_infinite": kept.infinite}
        return attrs | {f"{SEARCHED}rows_considered": kept.considered}


def labels_of(resolved: ResolvedSweep) -> xr.Dataset:
    """Return the labels of a sweep with its first design, and zeros for results."""
    space = resolved.space.consecutive(0, 1)
    columns = {name: np.asarray(values) for name, values in space.columns.items()}
    one = replace(resolved, space=replace(space, columns=columns, labels={}), scaling_axis=None)
    arrays = [np.zeros_like(array) for array in allocated(one.shapes, 1)]
    return labels.labelled(one, labels.variables_of(one), arrays, {})


def write(path: Path, request: Request, found: xr.Dataset, **options: Any) -> None:
    """Write the designs that were found."""
    variables = [
        Variable(str(name), tuple(map(str, one.dims)), one.shape, one.dtype, plain_attrs(one.attrs))
        for name, one in found.data_vars.items()
    ]
    coords = found.drop_vars(list(found.data_vars)).drop_encoding()
    coords.attrs = {}
    attrs = {str(name): value for name, value in found.attrs.items() if name != FORMAT}
    run = request.fingerprint, found.sizes[DESIGN]
    with Writer(path, coords, variables, plain_attrs(attrs), run=run, **options) as writer:
        for variable in variables:
            writer.write(variable.name, 0, np.ascontiguousarray(found[variable.name].values))
        writer.finish({HISTORY: history(f"search {request.resolved.mechanism} to {path.name}")})

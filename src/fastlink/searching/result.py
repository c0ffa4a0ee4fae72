"""The request of a search, and its result as a map of the designs that were found."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from fastlink._text import counted, joined
from fastlink.codegen.cache import environment
from fastlink.engine import labels
from fastlink.engine.needs import allocated
from fastlink.engine.sweep import sweep
from fastlink.errors import InputError
from fastlink.io.dataset import Variable, plain_attrs
from fastlink.io.history import HISTORY
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
    from fastlink.io.parts import PartOfMap
    from fastlink.searching.spans import Span

__all__ = ["SEARCH", "Request", "labels_of", "write"]

#: What a part of a search keeps of its request.
SEARCH = "search"

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
    size : int
        How many designs are searched.
    origin : dict
        What is said of where they come from.
    attrs : dict
        Further attributes of the result.
    spans : list of Span or None
        The inputs that a refinement may change, where they do not follow from the space.
    numbers : array or None
        Of a search that parts make together: the numbers of the designs of `resolved`, which are those that were kept.
    known : str
        Its fingerprint.
    """

    mechanism: Any
    resolved: ResolvedSweep
    options: dict[str, Any]
    quantities: tuple[str, ...]
    only: tuple[str, ...] | None
    bounds: Mapping[str, tuple[float, float]]
    labels: xr.Dataset
    size: int
    origin: Mapping[str, Any]
    attrs: Mapping[str, Any] = field(default_factory=dict)
    spans: list[Span] | None = None
    numbers: NDArray[np.int64] | None = None
    known: str = ""
    asked: dict[str, Any] = field(init=False)
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
        of_space = {"size": resolved.space.size, "origin": resolved.space.attrs}
        return cls(mechanism, resolved, options, labels=labels_of(resolved), **of_space, **given)  # type: ignore[arg-type]

    def choose(self, **asked: Any) -> None:
        """Set what is searched for, and how it is refined, or refuse it."""
        self.asked, self.choice = asked, (choice := choice_of(self.labels, **asked))
        for one in choice.wanted:
            if one.array.dtype.kind == "b":
                remedy = "write conditions by name, such as {'a1': (None, 0.5)}"
                raise InputError("is a mask of one map", where=("where",), remedy=remedy)
        if self.only is not None:
            catalogue = self.resolved.catalogue
            if self.spans is None:
                self.spans = spans_of_space(catalogue, self.resolved.space, self.bounds, self.only)
            of_model = {n: self.options.get(n) for n in ("links", "input", "solver", "extrema", "angles")}
            model = Model(self.mechanism, of_model)
            self.refinement = Refinement(self.labels, model, self.spans, choice.objectives, choice.wanted)

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
        if self.known:
            return self.known
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

    def columns(
        self, stream: Stream, rows: NDArray[np.int64]
    ) -> tuple[dict[str, Any], dict[str, NDArray[np.int64]]]:
        """Return the inputs and labels of the designs of some rows, and their places along further dimensions."""
        designs, places = stream.rows.places(rows)
        space = self.resolved.space
        inside = designs if self.numbers is None else np.searchsorted(self.numbers, designs)
        columns: dict[str, Any] = {DESIGN: designs, **space.at(inside)}
        columns |= {name: space.constants[name] for name in space.constants}
        of_row = space.size // space.shape[0] if space.dims else 1
        for name, label in space.labels.items():
            columns[name] = np.array([label[k] for k in inside // of_row]) if np.ndim(label) else label
        return columns, places

    def found(self, stream: Stream, kept: Kept, verify: int, show: Any) -> xr.Dataset:
        """Return the designs that were found, refined if they are to be, as a map."""
        columns, places = self.columns(stream, stream.ordered(kept).rows)
        names = list(self.quantities) or ["status"]
        if self.refinement is None:
            return self.rows(columns, places, names, verify)
        top = None if stream.several else self.choice.top
        starts = self.rows(columns, places, stream.searched)
        refined = self.refinement.of(starts, searched=self.size * stream.rows.of_design, top=top, show=show)
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

    def of_part(self, stream: Stream, kept: Kept, of: PartOfMap, about: Mapping[str, Any]) -> xr.Dataset:
        """Return the rows that a part keeps as a map, not refined; where there is none its first row stands there."""
        rows = (
            stream.ordered(kept).rows if len(kept.rows) else np.array([of.range[0] * stream.rows.of_design])
        )
        result = self.rows(*self.columns(stream, rows), stream.searched)
        start, stop = of.range
        result.attrs |= {**self.about(), **self.counts(stream, kept, stop - start), **about, **of.attrs()}
        result.attrs["selection"] = (
            f"{self.selection(kept, stop - start)}; part {of.part} of a search, to be joined"
        )
        if not len(kept.rows):
            result.attrs["selection"] += "; none is kept, and the first row stands here"
        return result

    def whole(self, stream: Stream, kept: Kept, verify: int | None) -> xr.Dataset:
        """Return what a part tells to those that join it: the request, and what it has kept, as `of_part` has it."""
        columns, _ = self.columns(stream, np.zeros(1, dtype=np.int64))
        links, left_out = self.options.get("links"), {"threads", "links", "backend"}
        options = {name: value for name, value in self.options.items() if name not in left_out}
        options["links"] = None if links is None else {"model": links.model, "values": links.values}
        about = {
            "environment": environment().hex(),
            "quantities": self.quantities,
            "asked": self.asked | {"refine": self.only if self.only else self.only is not None},
            "options": options,
            "columns": list(columns),
            "rows_of_design": stream.rows.of_design,
            "labels": list(self.resolved.space.labels),
            "spans": None if self.spans is None else [astuple(one) for one in self.spans],
            "size": self.size,
            "origin": self.origin,
            "attrs": list(self.attrs),
            "verify": verify,
        }
        text = json.dumps(about, default=lambda value: value.tolist())
        arrays = {name: np.ravel(value) for name, value in stream.ordered(kept).arrays().items()}
        return xr.Dataset(coords={n: ((n,), a) for n, a in {**arrays, SEARCH: np.array([text])}.items()})

    def selection(self, kept: Kept, size: int) -> str:
        """Return how rows were selected, as a text."""
        aims = joined([str(one) for one in self.choice.objectives])
        return f"{len(kept.rows):,} of {kept.considered:,} rows by the {aims}, of {counted(size, 'design')}"

    def counts(self, stream: Stream, kept: Kept, size: int) -> dict[str, Any]:
        """Return how many designs were searched, and why others were left out, as attributes."""
        attrs: dict[str, Any] = {f"{SEARCHED}{name}": value for name, value in self.origin.items()}
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


def write(path: Path, found: xr.Dataset, fingerprint: str, made: str, **options: Any) -> None:
    """Write the designs that were found; options are those of a `Writer`."""
    variables = [
        Variable(str(name), tuple(map(str, one.dims)), one.shape, one.dtype, plain_attrs(one.attrs))
        for name, one in found.data_vars.items()
    ]
    coords = found.drop_vars(list(found.data_vars)).drop_encoding()
    coords.attrs = {}
    attrs = {str(name): value for name, value in found.attrs.items() if name != FORMAT}
    run = fingerprint, found.sizes[DESIGN]
    with Writer(path, coords, variables, plain_attrs(attrs), run=run, **options) as writer:
        for variable in variables:
            writer.write(variable.name, 0, np.ascontiguousarray(found[variable.name].values))
        writer.finish({HISTORY: made})

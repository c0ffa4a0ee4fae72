"""Search a design space without a map: sweep it block by block, keep the best rows, refine them; join parts."""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import math
import os
import threading
import time
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass, field, replace
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from fastlink._text import counted, joined
from fastlink.codegen.cache import environment
from fastlink.design.best import inputs_to_refine
from fastlink.design.refine import Model, Refinement, Span, angles_of, candidates, spans_of_space
from fastlink.engine import labels
from fastlink.engine.extend import Extension, check_declared, own_refused
from fastlink.engine.options import check_options, checked_call
from fastlink.engine.resolve import ResolvedSweep, of_request, resolve
from fastlink.engine.run import default_threads, run
from fastlink.engine.sinks import ProgressBar, allocated, check_needs, designs_per_block, within
from fastlink.engine.sweep import sweep
from fastlink.errors import InputError, Pair, Problems, Remedy, Setting, check_switch, door
from fastlink.facts.arc import ARC
from fastlink.facts.catalogue import ELIMINATED, Catalogue
from fastlink.facts.own import declared_names
from fastlink.io.checksums import Range, Ranges, count_of, joined_ranges, missing
from fastlink.io.joining import CORE_TIME, JOINED, RUN_AGAIN, JoinedMap, PartFile, merged, part_files
from fastlink.io.layout import HISTORY, Variable, history, plain_attrs
from fastlink.io.output_path import exists_error, not_writable, reason, refused, search_of
from fastlink.io.partial_file import check_left, check_target
from fastlink.io.reader import PartOfMap, as_dataset, finished_map, shown_parts
from fastlink.io.writer import Writer
from fastlink.maps import open as open_map
from fastlink.maps.best import (
    Choice,
    Tally,
    choice_of,
    kept_of,
    least,
    listed,
    merged_nearest,
    remarked,
    strongest,
    unbeaten,
    undominated,
    with_missed,
)
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.mechanisms import mechanism_of_map
from fastlink.plan.query import Results, check_names, parse_request
from fastlink.precision import DESIGNS, with_remark
from fastlink.space.design_space import BRANCH, DESIGN, DesignSpace, Links
from fastlink.space.tables import FORMAT, STATUS, table
from fastlink.space.units import in_si, named_with_unit, split

if TYPE_CHECKING:
    from distributed import Client

    from fastlink.engine.cluster import Cluster


# -- Keep the best rows of a sweep that goes by block by block: memory does not grow with the number of
#    designs


#: Rows that are compared with a front at once: to compare few takes as long as its own length.
MOST_WAITING = 1 << 17
#: Rows of a front with which each block is compared: each leaves less, and takes 20 us of a block of 4,096.
MOST_STRONG = 16
#: What is counted of rows.
COUNTS = ("failed", "considered", "not_numbers", "infinite")


@dataclass(kw_only=True)
class Kept(Tally):
    """The best rows of some designs, and how many rows there were; that of several blocks in any order is the same."""

    #: Their numbers.
    rows: NDArray[np.int64]
    #: Their objectives, to be as small as possible.
    points: NDArray[np.float64]
    #: How often designs have each status.
    designs: NDArray[np.int64]
    #: The numbers of those that miss conditions least, and by how much.
    near: NDArray[np.int64]
    missed: NDArray[np.float64]

    def arrays(self) -> dict[str, Any]:
        """Return everything as arrays by name, as a file keeps them."""
        return {name: np.asarray(value) for name, value in vars(self).items()}

    @property
    def every(self) -> NDArray[np.int64]:
        """The numbers of all rows that are kept."""
        return np.concatenate((self.rows, self.near))

    @classmethod
    def of_arrays(cls, arrays: Mapping[str, Any]) -> Kept:
        """Return what `arrays` has given, perhaps flat."""
        given: dict[str, Any] = {name: np.array(arrays[name]) for name in cls.__dataclass_fields__}
        given |= {name: int(given[name].item()) for name in COUNTS[1:]}
        if len(given["rows"]):
            given["points"] = given["points"].reshape(len(given["rows"]), -1)
        return cls(**given)


class Stream:
    """The reading of the blocks of a sweep."""

    def __init__(self, resolved: ResolvedSweep, choice: Choice, along: Mapping[str, NDArray[Any]]) -> None:
        self.resolved, self.choice, self.along = resolved, choice, along
        dims = dict.fromkeys(str(dim) for array in choice.arrays for dim in array.dims if dim != DESIGN)
        lengths = resolved.lengths
        #: The dimensions of objectives and conditions besides the design, and their lengths; rows are in C order.
        self.sizes = {dim: lengths[dim] for dim in (BRANCH, *along) if dim in dims}
        self.rows_of_design = math.prod(self.sizes.values())
        self.names = list(dict.fromkeys(str(array.name) for array in choice.arrays))
        outputs = {output.name: k for k, output in enumerate(resolved.plan.outputs)}
        self.outputs = {name: outputs[name] for name in self.names if name in outputs}
        self.inputs = [name for name in self.names if name in resolved.space.names]
        self.status = outputs["status"]
        #: How many a design has: that of a linkage is of each branch.
        self.statuses = math.prod(lengths[axis] for axis in resolved.plan.outputs[self.status].axes)
        self.several = len(choice.objectives) > 1
        #: Rows that are not compared with each other yet, and how many; rows of the front that beat most others.
        self.waiting: list[tuple[NDArray[np.int64], NDArray[np.float64]]] = []
        self.count, self.strongest = 0, np.empty((0, len(choice.objectives)))
        self.codes = max(resolved.catalogue.facts["status"].flags) + 1

    def places(self, rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], dict[str, NDArray[np.int64]]]:
        """Return the designs of rows, and their places along each further dimension."""
        designs, inside = np.divmod(rows, self.rows_of_design)
        along = np.unravel_index(inside, tuple(self.sizes.values())) if self.sizes else ()
        return designs, dict(zip(self.sizes, along, strict=True))

    @property
    def searched(self) -> list[str]:
        """The names of the results that are looked at, as a sweep takes them."""
        return [name for name in self.outputs if name != "status"] or ["status"]

    def designs_of(self, kept: Kept) -> int:
        """Return how many designs were searched to keep these."""
        return int(kept.designs.sum()) // self.statuses

    def nothing(self) -> Kept:
        """Return what is kept of no rows."""
        empty = np.empty((0, len(self.choice.objectives)))
        designs, failed = (np.zeros(n, dtype=np.int64) for n in (self.codes, len(self.choice.wanted)))
        none = np.empty(0, dtype=np.int64)
        near: dict[str, Any] = {"near": none, "missed": np.empty(0)}
        return Kept(rows=none, points=empty, designs=designs, failed=failed, **near)

    def read(self, start: int, stop: int, arrays: list[NDArray[Any]], into: Kept, known: Kept) -> None:
        """Add the results of consecutive designs to what is kept of a block; `known` is kept of others already."""
        values = self._values(start, stop, arrays)
        into.designs += np.bincount(arrays[self.status].reshape(-1), minlength=self.codes)
        shape = (stop - start, *self.sizes.values())
        places, points = into.usable(self.choice, shape, lambda array: values[str(array.name)])
        if len(places):
            self._add(into, start * self.rows_of_design + places, points, known)
        if self.choice.limits and len(known.rows) + len(into.rows) < self.choice.enough:
            near, missed = into.nearest(self.choice, shape, lambda array: values[str(array.name)])
            own = start * self.rows_of_design + near, missed
            into.near, into.missed = merged_nearest(self.choice.nearest, (into.near, into.missed), own)

    def _values(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> dict[str, NDArray[Any]]:
        """Return what is looked at, with a length or 1 along each dimension of the rows."""
        count, found = stop - start, dict[str, NDArray[Any]]()

        def shape(*dims: str) -> list[int]:
            return [length if dim in dims else 1 for dim, length in self.sizes.items()]

        for name, k in self.outputs.items():
            found[name] = arrays[k].reshape(count, *shape(*self.resolved.plan.outputs[k].axes))
        if self.inputs:
            read = np.empty((len(self.inputs), count))
            self.resolved.space.fill(self.inputs, start, stop, read)
            found |= {name: row.reshape(count, *shape()) for name, row in zip(self.inputs, read, strict=True)}
        for name in self.names:
            if name not in found:
                found[name] = self.along[name].reshape(1, *shape(name))
        return found

    def merge(self, one: Kept, other: Kept) -> None:
        """Add what is kept of other designs; rows of a front wait until they are many, see `settle`."""
        for name in ("designs", *COUNTS):
            setattr(one, name, getattr(one, name) + getattr(other, name))
        both = (one.near, one.missed), (other.near, other.missed)
        one.near, one.missed = merged_nearest(self.choice.nearest, *both)
        if len(other.rows):
            self.waiting.append((other.rows, other.points))
            self.count += len(other.rows)
        if self.count > (MOST_WAITING if self.several else 0):
            self.settle(one)

    def settle(self, kept: Kept) -> None:
        """Compare the rows that wait: of equal ones those with the least numbers stay."""
        if kept.counting >= self.choice.enough:  # none of those that miss a condition is needed
            kept.near, kept.missed = kept.near[:0], kept.missed[:0]
        if not self.waiting:
            return
        rows, points = (np.concatenate(parts) for parts in zip(*self.waiting, strict=True))
        self.waiting, self.count = [], 0
        if self.several:
            left = undominated(points, kept.points)
            rows, points = rows[left], points[left]
        rows, points = np.concatenate((kept.rows, rows)), np.concatenate((kept.points, points))
        order = np.argsort(rows, kind="stable")
        rows, points = rows[order], points[order]
        chosen = kept_of(points, self.choice.top)
        kept.rows, kept.points = rows[chosen], points[chosen]
        if self.several:
            self.strongest = strongest(kept.points, points, MOST_STRONG)

    def _add(self, into: Kept, rows: NDArray[np.int64], points: NDArray[np.float64], known: Kept) -> None:
        """Add rows that count, but for those that others beat for sure."""
        if self.several:
            first = unbeaten(points, self.strongest)
        else:
            best, top = known.points, self.choice.top
            near = np.flatnonzero(points[:, 0] <= best.max()) if len(best) >= top else np.arange(len(points))
            first = near[least(points[near, 0], top)]
        into.rows = np.concatenate((into.rows, rows[first]))
        into.points = np.concatenate((into.points, points[first]))

    def ordered(self, kept: Kept) -> Kept:
        """Return what was kept, the best row of the first objective first."""
        order = np.lexsort((kept.rows, *kept.points.T[::-1]))
        return replace(kept, rows=kept.rows[order], points=kept.points[order])


# -- Keep what a search has found so far beside its file, so that a killed one goes on


#: Seconds between two states that are kept.
STEP_SECONDS = 10.0


class Unfinished:
    """The state of a search that is under way, or another run: what it keeps, and of which designs.

    It is written whole, under another name, and then given its own: what stands there is never half. A run without a
    file keeps nothing.
    """

    def __init__(self, path: Path | None, fingerprint: str, restart: bool, of_arrays: Any) -> None:
        self.path = None if path is None else search_of(path)
        self.fingerprint, self.of_arrays = fingerprint, of_arrays
        self.due = math.inf if path is None else time.monotonic() + STEP_SECONDS
        if restart:
            self.remove()

    def read(self) -> tuple[Any, list[Range]] | None:
        """Return what an earlier run of the same request has left, None where nothing is; refuse that of another."""
        throw_away = (", or write ", Setting("restart", True), " to throw it away")
        remedy = ("finish that search, choose another name", throw_away)
        if self.path is None:
            return None
        try:
            with np.load(self.path) as arrays:
                about = json.loads(str(arrays["about"]))
                if about.get("fingerprint") == self.fingerprint:
                    ranges = [(int(start), int(stop)) for start, stop in about["done"]]
                    return self.of_arrays(arrays), ranges
        except FileNotFoundError:
            return None
        except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
            raise refused(f"{self.path} cannot be read ({error})", remedy) from error
        raise refused(f"{self.path} is of another search, or by another version", remedy)

    def write(self, kept: Any, done: Sequence[Range]) -> None:
        """Keep a state."""
        if self.path is None:
            return
        about = json.dumps({"fingerprint": self.fingerprint, "done": [list(one) for one in done]})
        content = io.BytesIO()
        np.savez(content, about=np.array(about), **kept.arrays())
        fresh = self.path.with_name(f"{self.path.name}.{os.getpid()}")
        try:
            with open(fresh, "wb") as file:
                file.write(content.getbuffer())
                file.flush()
                os.fsync(file.fileno())
            os.replace(fresh, self.path)
        except OSError as error:
            fresh.unlink(missing_ok=True)
            raise not_writable(self.path, error) from error
        self.due = time.monotonic() + STEP_SECONDS

    def remove(self) -> None:
        """Remove it: the search has its file, or is to begin anew."""
        try:
            if self.path is not None:
                self.path.unlink(missing_ok=True)
        except OSError as error:
            raise InputError(f"{self.path} cannot be removed ({error})", remedy="remove it") from error


# -- Run a search: the sweep whose blocks are read and forgotten, then the refinement of what it has kept


def found_by(
    request: SearchRequest,
    *,
    threads: int,
    block: int | None,
    progress: bool | None,
    verify: int | None,
    path: Path | None = None,
    restart: bool = False,
    of: PartOfMap | None = None,
    cluster: Cluster | None = None,
) -> tuple[xr.Dataset, xr.Dataset | None]:
    """Return the designs that a search finds; of a part the rows that it keeps, and what those who join it need."""
    stream = Stream(request.resolved, request.kept, request.along)
    unfinished = Unfinished(path, (of or request).fingerprint, restart, Kept.of_arrays)
    kept, done = unfinished.read() or (stream.nothing(), [])
    started, resumed = time.perf_counter(), stream.designs_of(kept)
    check_needs(request.resolved, threads, block, 0, 0)
    if cluster is not None:
        cluster.check()
    first, last = of.range if of else (0, request.size)
    with ProgressBar(last - first, progress) as bar:
        bar.merge(resumed)
        gathering = _Gathering(unfinished, bar, stream, (first, last), kept, Ranges(done))
        gathering.all(threads, block, cluster)
    stream.settle(kept)
    seconds = time.perf_counter() - started
    about = {"designs_per_second": (last - first - resumed) / seconds, "run_time_s": seconds}
    about |= {"designs_of_earlier_runs": resumed} if resumed else {}
    about |= {"threads": cluster.threads} if cluster else {}
    whole = None
    if of:
        result, whole = request.of_part(stream, kept, of, about), request.for_joining(stream, kept, verify)
    else:
        if not len(kept.every):
            unfinished.remove()
        verify = (0 if path is None else DESIGNS) if verify is None else verify
        result = finished(request, stream, kept, about, verify=verify, progress=progress)
    unfinished.remove()
    return result, whole


def finished(
    request: SearchRequest,
    stream: Stream,
    kept: Kept,
    about: Mapping[str, Any],
    *,
    verify: int,
    progress: bool | None,
) -> xr.Dataset:
    """Return the result of a search, refined if it is to be, from what it has kept of all designs."""
    if not len(kept.every):
        raise kept.nothing_found(request.choice, request.size * stream.rows_of_design)
    most = len(kept.every) if stream.several else min(request.choice.top, len(kept.every))
    swept = time.perf_counter()
    with ProgressBar(most, progress, " designs refined") as bar:
        result = request.found(stream, kept, verify, bar.merge)
    refined, refinement = result.attrs.pop("selection", ""), time.perf_counter() - swept
    result.attrs |= {**request.about(), **request.counts(stream, kept, request.size), **about}
    result.attrs |= {"run_time_s": about["run_time_s"] + refinement, "refinement_time_s": refinement}
    for name in ("configurations", "configurations_per_second", "set_up_time_s"):
        result.attrs.pop(name, None)
    result.attrs["selection"] = f"{request.selection(kept, request.size)}{refined}"
    return remarked(result)


class _Gathered:
    """The best rows of some designs, which a search keeps."""

    def __init__(self, stream: Stream, rows: Range, kept: Kept, done: Ranges) -> None:
        self.stream, self.rows, self.kept, self.done = stream, rows, kept, done

    def take(self, start: int, stop: int, arrays: list[NDArray[Any]]) -> None:
        """Read the results of evaluated designs."""
        own, axis = self.stream.nothing(), self.stream.resolved.scaling_axis

        def read(first: int, last: int, found: list[NDArray[Any]]) -> None:
            self.stream.read(first, last, found, own, self.kept)

        clipped = within([self.rows], read)
        (axis.over(clipped) if axis else clipped)(start, stop, arrays)
        self.merge((own, [(start, stop)]))

    def merge(self, report: tuple[Kept, list[Range]]) -> None:
        """Add what is kept of further designs, and which evaluated ones these are."""
        self.stream.merge(self.kept, report[0])
        for one in report[1]:
            self.done.add(*one)

    def report(self) -> tuple[Kept, list[Range]]:
        """Return what is kept, and of which evaluated designs."""
        self.stream.settle(self.kept)
        return self.kept, self.done.joined()


class _Gathering(_Gathered):
    """The same of all designs, in threads or on a cluster; from time to time its state is put beside the file."""

    def __init__(self, unfinished: Unfinished, bar: ProgressBar, *given: Any) -> None:
        super().__init__(*given)
        self.unfinished, self.bar, self.lock = unfinished, bar, threading.Lock()

    def remote(self) -> _Gathered:
        """Return an object that gathers on a worker of a cluster."""
        stream = Stream(self.stream.resolved, self.stream.choice, self.stream.along)
        return _Gathered(stream, self.rows, stream.nothing(), Ranges())

    def merge(self, report: tuple[Kept, list[Range]]) -> None:
        """Add what is kept of further designs, also by a worker; thread-safe."""
        with self.lock:
            super().merge(report)
            if time.monotonic() >= self.unfinished.due:
                self.unfinished.write(*self.report())
        self.bar.merge(self.stream.designs_of(report[0]))

    def all(self, threads: int, block: int | None, cluster: Cluster | None) -> None:
        """Evaluate all designs that are not done."""
        resolved, axis, before = self.stream.resolved, self.stream.resolved.scaling_axis, self.done.joined()
        job = resolved.job()
        if axis is not None:
            block = designs_per_block(resolved, threads, block)
        wanted = joined_ranges([*axis.evaluated(*self.rows)]) if axis else [self.rows]
        pending = missing(joined_ranges([*before, *missing(wanted, job.size)]), job.size)
        try:
            if cluster is not None:
                remote = self.remote()
                there = remote.take, remote, self.merge
                cluster.run(job, self.take, remote=there, block=block, pending=pending)
            else:
                apart = self.unfinished.path is not None
                run(job, sink=self.take, threads=threads, block=block, pending=pending, apart=apart)
        except BaseException as error:
            if self.unfinished.path is not None and (now := self.done.joined()):
                with contextlib.suppress(InputError):
                    self.unfinished.write(*self.report())
                    share = count_of(now) / count_of(wanted)
                    searched = f"{share:.0%} of the designs are searched, as {self.unfinished.path} says"
                    error.add_note(f"{searched}; run the same again to go on")
            raise


# -- The request of a search, and its result as a map of the designs that were found


#: What a part of a search keeps of its request.
SEARCH = "search"

#: What the attributes begin with that are true of the designs that were searched, not of those that were found.
SEARCHED = "searched_"


@dataclass
class SearchRequest:
    """A search whose parts were checked."""

    #: The mechanism, as it was given.
    mechanism: Any
    #: The sweep of what objectives and conditions need.
    resolved: ResolvedSweep
    #: The options of the sweeps of designs that were found.
    options: dict[str, Any]
    #: What is computed of these.
    quantities: tuple[str, ...]
    #: What is searched for and refined, as it was given, and which rows that are.
    asked: dict[str, Any]
    choice: Choice
    #: The labels of the sweep, with one design.
    labels: xr.Dataset
    #: How many designs are searched.
    size: int
    #: What is said of where they come from.
    origin: Mapping[str, Any]
    #: Further attributes of the result.
    attrs: Mapping[str, Any] = field(default_factory=dict)
    #: The inputs that a refinement may change, and how it goes.
    spans: list[Span] | None = None
    refinement: Refinement | None = None
    #: Of a search that parts make together: the numbers of the designs of `resolved`, which are those that were
    # kept.
    numbers: NDArray[np.int64] | None = None
    #: The fingerprint of a search that parts make together.
    joined_fingerprint: str = ""

    @property
    def along(self) -> dict[str, NDArray[Any]]:
        """The values of the dimensions that rows may have besides the design."""
        return {str(dim): self.labels[dim].values for dim in self.labels.dims if dim != DESIGN}

    @property
    def kept(self) -> Choice:
        """Which rows the sweep keeps: of one objective more than are wanted, where several may lead to one design."""
        return self.choice if self.refinement is None else self.choice.refined(candidates(self.choice.top))

    @property
    def fingerprint(self) -> str:
        """A hash of all that the result depends on."""
        if self.joined_fingerprint:
            return self.joined_fingerprint
        choice = self.choice
        aims = [(one.array.name, one.sign) for one in choice.objectives]
        wanted = [(one.array.name, one.codes, one.low, one.high) for one in choice.wanted]
        spans = None if self.refinement is None else self.refinement.spans
        tops, links = (choice.top, self.kept.top), self.options.get("links")
        own = aims, wanted, *tops, choice.infinite, spans, self.quantities, links
        attrs = sorted((name, repr(value)) for name, value in plain_attrs(self.attrs).items())
        return hashlib.sha256(repr((self.resolved.fingerprint, own, attrs)).encode()).hexdigest()

    def about(self) -> dict[str, Any]:
        """Return what was searched, as attributes."""
        choice = self.choice
        aims = joined([str(one) for one in choice.objectives])
        conditions = joined([str(one) for one in choice.wanted])
        text = f"the {aims}{' where ' if conditions else ''}{conditions}"
        return {**self.attrs, "mechanism": str(self.resolved.mechanism), "search": text}

    def rows(self, columns: Mapping[str, Any], places: Mapping[str, NDArray[np.int64]], names: Sequence[str],
             verify: int = 0) -> xr.Dataset:  # fmt: skip
        """Return designs with their results, as a sweep gives them, a row each."""
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
        designs, places = stream.places(rows)
        space = self.resolved.space
        inside = designs if self.numbers is None else np.searchsorted(self.numbers, designs)
        columns: dict[str, Any] = {DESIGN: designs, **space.at(inside), **space.constants}
        of_row = space.size // space.shape[0] if space.dims else 1
        for name, label in space.labels.items():
            columns[name] = np.array([label[k] for k in inside // of_row]) if np.ndim(label) else label
        return columns, places

    def found(self, stream: Stream, kept: Kept, verify: int, show: Any) -> xr.Dataset:
        """Return the designs that were found, refined if they are to be, as a map."""
        columns, places = self.columns(stream, stream.ordered(kept).every)
        names = list(self.quantities) or ["status"]
        if self.refinement is None:
            return with_missed(self.rows(columns, places, names, verify), self.choice.limits)
        top = None if stream.several else self.choice.top
        starts = self.rows(columns, places, stream.searched)
        refined = self.refinement.of(starts, searched=self.size * stream.rows_of_design, top=top, show=show)
        if self.refinement.at_position:
            return refined
        moved = {name: refined[name].values if name in refined else given for name, given in columns.items()}
        moved = {name: values if np.ndim(values) else values[()] for name, values in moved.items()}
        places = {dim: np.searchsorted(self.along[dim], refined[dim].values) for dim in places}
        result = self.rows(moved, places, names, verify)
        added = refined.drop_vars([name for name in refined.variables if name in result.variables])
        result.attrs["selection"] = refined.attrs["selection"]
        return result.assign(added.data_vars).assign_coords(added.coords)

    def of_part(self, stream: Stream, kept: Kept, of: PartOfMap, about: Mapping[str, Any]) -> xr.Dataset:
        """Return the rows that a part keeps as a map, not refined; where there is none its first row stands there."""
        rows = (
            stream.ordered(kept).every if len(kept.every) else np.array([of.range[0] * stream.rows_of_design])
        )
        result = self.rows(*self.columns(stream, rows), stream.searched)
        start, stop = of.range
        result.attrs |= {**self.about(), **self.counts(stream, kept, stop - start), **about, **of.attrs()}
        result.attrs["selection"] = (
            f"{self.selection(kept, stop - start)}; part {of.part} of a search, to be joined"
        )
        if not len(kept.every):
            result.attrs["selection"] += "; none is kept, and the first row stands here"
        return result

    def for_joining(self, stream: Stream, kept: Kept, verify: int | None) -> xr.Dataset:
        """Return what a part tells to those that join it: the request, and what it has kept, as `of_part` has it."""
        columns, _ = self.columns(stream, np.zeros(1, dtype=np.int64))
        links, left_out = self.options.get("links"), {"threads", "links", "backend"}
        options = {name: value for name, value in self.options.items() if name not in left_out}
        options["links"] = None if links is None else {"model": links.model, "values": links.values}
        about = {
            "environment": environment().hex(),
            "quantities": self.quantities,
            "asked": self.asked,
            "options": options,
            "columns": list(columns),
            "rows_of_design": stream.rows_of_design,
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
        near = f"{len(kept.near):,} that miss conditions least"
        if len(kept.near) and not len(kept.rows):
            return f"{kept.none_of(self.choice, size, 'design')}; {near}, by the {aims}"
        of = f"{len(kept.rows):,} of {kept.considered:,} rows by the {aims}"
        return f"{of}{f', {near}' if len(kept.near) else ''}, of {counted(size, 'design')}"

    def counts(self, stream: Stream, kept: Kept, size: int) -> dict[str, Any]:
        """Return how many designs were searched, and why others were left out, as attributes."""
        attrs: dict[str, Any] = {f"{SEARCHED}{name}": value for name, value in self.origin.items()}
        attrs |= {f"{SEARCHED}designs": size, f"{SEARCHED}rows": size * stream.rows_of_design}
        flags = self.resolved.catalogue.facts["status"].flags
        counted_as = "designs" if stream.statuses == 1 else "branches"
        attrs |= {
            f"{SEARCHED}{counted_as}_{meaning}": int(kept.designs[code]) for code, meaning in flags.items()
        }
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
    return labels.labelled(one, labels.variables(one), arrays, {})


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


# -- Search a design space without a map: sweep it block by block, keep the best, refine them


@door
def search(
    mechanism: str | Extension,
    space: DesignSpace | Mapping[str, Any] | str | Path | Any,
    quantities: Sequence[str] = (),
    *,
    minimise: str | Sequence[str] = (),
    maximise: str | Sequence[str] = (),
    where: Any = None,
    top: int | None = None,
    infinite: bool = False,
    refine: bool | Sequence[str] = True,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    links: Links | None = None,
    input: str | None = None,
    angles: int | ArrayLike | None = None,
    branch: int | Sequence[int] = 1,
    solver: str = ELIMINATED,
    extrema: str | None = None,
    verify: int | None = None,
    to: str | Path | None = None,
    overwrite: bool = False,
    restart: bool = False,
    part: tuple[int, int] | str | None = None,
    threads: int | None = None,
    client: Client | None = None,
    progress: bool | None = None,
    attrs: Mapping[str, Any] | None = None,
    block: int | None = None,
    backend: str | None = None,
    **positions: int | ArrayLike | None,
) -> xr.Dataset:
    """Search a design space for its best designs, without a map of all, and refine them.

    The designs are swept block by block; the best few, or those of the Pareto front, are kept, and nothing else: memory
    does not grow with their number, a sample of 10^9 designs needs no file. Those that were found are refined as by
    `fastlink.best`.

    Parameters
    ----------
    mechanism, space, links, input, angles, solver, extrema, attrs, backend, **positions
        As in `fastlink.sweep`; for a search, `space` is mostly a sample, such as ``fastlink.sobol(10**7, ...)``.
    quantities : sequence of str
        What else to compute of the designs that are found; objectives and conditions come along.
    minimise, maximise, where, top, infinite
        As in `fastlink.best`, by names of quantities and inputs; conditions by name, not as a mask.
    refine : bool or sequence of str, default True
        As in `fastlink.best`.
    bounds : mapping, optional
        For inputs that are swept the least and greatest value of refined designs; by default those of the space.
    branch : int or sequence of int, default 1
        A branch, or both, in each of which a design is a row of its own.
    verify : int, optional
        How many of the designs that are found are computed again with 50 digits, as in `fastlink.sweep`.
    to : path, optional
        The HDF5 file to write. A file that is there already and holds the result of this search is opened as it is.
    overwrite : bool
        Search anew and replace an existing file.
    threads, client, progress, block
        As in `fastlink.sweep`.
    restart : bool
        Throw away what a killed search has left in ``FILE.search``. Without it, the same search goes on there, to the
        same bits, and another one is refused.
    part : (k, n) or "k/n", optional
        Search the k-th of n nearly equal ranges of consecutive designs alone. What it keeps is not refined; its file is
        a part, of which `fastlink.join` makes the result of the whole search (see docs/performance.md).

    Returns
    -------
    xarray.Dataset
        The designs that were found as a map of their own, along ``design``, the best of the first objective first; the
        label ``design`` is the number of the start in the space. Their attributes say what was searched, how many
        designs, how many rows each condition excludes and how many there were of each status.

    Raises
    ------
    InputError
        Bad input; or no design meets the conditions, with the numbers that each excludes.

    Examples
    --------
    >>> space = fl.sobol(4096, a1=(0.1, 0.5), a2=(0.8, 1.3), a3=(0.5, 1.2), a4=1.0, omega1=1.0)
    >>> where = {"status": "rotates_fully", "transmission_angle_min_deg": (40, None), "swing_deg": (60, None)}
    >>> found = fl.search("planar_4r", space, minimise="omega4_max", where=where, top=2)
    >>> found.omega4_max.values.round(4), found.active.values[0].item()
    (array([0.473]), 'transmission_angle_min >= 0.698132 rad, swing >= 1.0472 rad')
    >>> found.attrs["searched_designs"], found.attrs["excluded_by_swing"] > 1000
    (4096, True)
    """
    call = dict(locals())
    checked, request = checked_call(
        call,
        lambda given: request_of(mechanism, space, quantities, given, **of_request(given), options=_OPTIONS),
    )
    request.options["threads"], request.attrs = checked["threads"], checked["attrs"] or {}
    of = None if part is None else PartOfMap(checked["part"], request.fingerprint, request.size)
    run: dict[str, Any] = {name: checked[name] for name in ("block", "progress", "verify")}
    threads = 1 if client is not None else checked["threads"] or default_threads()
    run |= {"threads": threads, "cluster": checked["client"], "of": of}
    if to is None:
        return found_by(request, **run)[0]
    ways: dict[str, Any] = {"overwrite": overwrite, "made": f"search {request.resolved.mechanism}"}
    about = request.about() | (of.attrs() if of else {})

    def found(path: Path) -> tuple[xr.Dataset, xr.Dataset | None]:
        return found_by(request, path=path, restart=restart, **run)

    return to_file(checked["to"], about, (of or request).fingerprint, found, restart=restart, **ways)


def to_file(
    to: Path,
    about: Mapping[str, Any],
    fingerprint: str,
    found: Callable[[Path], tuple[xr.Dataset, xr.Dataset | None]],
    *,
    made: str,
    overwrite: bool,
    restart: bool,
    parts: Sequence[PartFile] = (),
) -> xr.Dataset:
    """Write the result of a search, and open it; one that is there already is opened as it is."""
    if not overwrite:
        finished = finished_map(to, fingerprint, verified=0, attrs=about)
        if finished is not None:
            return remarked(with_remark(finished))
    path = check_target(to, 0, overwrite, [one.path for one in parts])
    if not restart:
        check_left(path, fingerprint)
    result, whole = found(path)
    before = str(parts[0].attrs.get(HISTORY, "")) if parts else ""
    line = history(f"{made} to {path.name}", before)
    write(path, result, fingerprint, line, whole=whole, overwrite=overwrite, restart=restart)
    return open_map(path)


def request_of_parts(parts: Sequence[PartFile], own: Any) -> tuple[SearchRequest, list[Kept], Any]:
    """Return the search that parts make together, what each has kept, and how many designs are verified.

    Its designs are those that were kept, which know their numbers among all.
    """
    for part in parts:
        part.check_labels()
    wholes, attrs = [part.whole() for part in parts], parts[0].attrs
    about = json.loads(wholes[0][SEARCH].item())
    if about["environment"] != environment().hex():
        what = f"{parts[0].path} is by another version ({attrs.get('source')})"
        raise InputError(what, ("paths",), "join with the version that has searched the parts")
    mechanism, text = mechanism_of_map(attrs), str(attrs.get("own_quantities", ""))
    if own is not None:
        mechanism = check_declared(own, mechanism, text)  # type: ignore[assignment]
    elif text:
        raise own_refused(("mechanism",), declared_names(text)[0])
    kept, numbers, columns = list[Kept](), list[Any](), dict[str, list[Any]]()
    for part, whole in zip(parts, wholes, strict=True):
        kept.append(Kept.of_arrays({str(name): one.values for name, one in whole.coords.items()}))
        rows = kept[-1].every // about["rows_of_design"]
        numbers.append(rows if len(rows) else np.array(part.of.range[:1]))
        with as_dataset(part.path) as opened:
            for name in about["columns"]:
                columns.setdefault(name, []).append(opened[name].values)
    every = np.concatenate(numbers)
    order = np.argsort(every, kind="stable")
    options = dict(about["options"])
    links = options["links"] = None if options["links"] is None else Links(**options["links"])
    given = {name: of for name, of in columns.items() if links is None or name not in links.values}
    designs = {n: np.concatenate(of)[order] if np.ndim(of[0]) else of[0].item() for n, of in given.items()}
    space = table(designs, keep=about["labels"])
    asked = {**about["asked"], "bounds": None, "spans": None}
    if about["spans"] is not None:
        asked["spans"] = [
            Span(a, low, high, tuple(map(tuple, f)), t) for a, low, high, f, t in about["spans"]
        ]
    request = request_of(mechanism, space, about["quantities"], asked, positions={}, **options)
    request.numbers, request.joined_fingerprint = every[order], parts[0].of.whole
    request.size, request.origin = about["size"], about["origin"]
    request.attrs = {name: attrs[name] for name in about["attrs"]}
    return request, kept, about["verify"]


#: The keywords of a search besides the name of the input.
_OPTIONS = tuple(name for name in signature(search).parameters if name != "positions")


def request_of(
    mechanism: Any, space: Any, quantities: Any, asked: Mapping[str, Any], **of_sweep: Any
) -> SearchRequest:
    """Return the request of a search, or refuse it with all its problems; nothing is compiled."""
    problems = Problems()
    only = problems.attempt(inputs_to_refine, asked["refine"])
    catalogue = find_catalogue(mechanism, of_sweep["input"])
    names = names_searched(catalogue, asked, problems)
    bounds = _ranges(asked["bounds"], catalogue, problems)
    resolved, others = None, list[str]()
    with problems.at():
        if not isinstance(quantities, (list, tuple)) or quantities:
            others = list(check_names("quantities", quantities))
        resolve(mechanism, space, [*others, *(n for n in names if n not in others)] or [STATUS], **of_sweep)
        resolved = resolve(mechanism, space, names or [STATUS], **of_sweep)
    problems.stop()
    assert resolved is not None
    labels, space = labels_of(resolved), resolved.space
    choice_asked = {name: asked[name] for name in ("minimise", "maximise", "where", "top", "infinite")}
    choice = choice_of(labels, **choice_asked)
    if any(one.array.dtype.kind == "b" for one in choice.wanted):
        remedy = "write conditions by name, such as {'a1': (None, 0.5)}"
        raise InputError("is a mask of one map", ("where",), remedy)
    taken = ("links", "input", "solver", "backend", "branch")
    options = {name: of_sweep[name] for name in taken if name in of_sweep}
    chosen = dict(resolved.plan.recipe[2])["extrema"]
    options |= {"extrema": None if chosen == "refined" else chosen, "threads": None}
    options |= angles_of(resolved.catalogue, resolved.positions, ARC in resolved.plan.variants)
    wanted = tuple(dict.fromkeys([*others, *names]))
    about = choice_asked | {"refine": asked["refine"]}, choice, labels, space.size, space.attrs
    request = SearchRequest(mechanism, resolved, options, wanted, *about)
    if only is not None:
        spans = asked.get("spans")
        request.spans = spans or spans_of_space(resolved.catalogue, space, bounds, only)
        of_model = {n: options.get(n) for n in ("links", "input", "solver", "extrema", "angles")}
        model = Model(mechanism, of_model)
        request.refinement = Refinement(labels, model, request.spans, choice.objectives, choice.wanted)
    return request


def names_searched(catalogue: Catalogue, asked: Mapping[str, Any], problems: Problems) -> list[str]:
    """Return the quantities that objectives and conditions name; what is unknown is noted, other values are not."""
    aims = [(key, name) for key in ("minimise", "maximise") for name in listed(asked[key])]
    where = asked["where"]
    wanted = where if isinstance(where, Mapping) and not hasattr(where, "data_vars") else {}
    inputs = {*catalogue.known_inputs(catalogue.variant_inputs), catalogue.position.name, BRANCH, STATUS}
    found: dict[str, None] = {}
    for key, name in [*aims, *(("where", name) for name in wanted)]:
        if not isinstance(name, str) or name in inputs:
            continue
        with problems.at(key):
            try:
                parse_request(name, catalogue)
            except InputError:
                of = split(name, inputs)[0] if key == "where" else name
                if of in inputs:
                    continue
                name = split(name, Results(catalogue))[0] if key == "where" else name
                parse_request(name, catalogue)
            found[name] = None
    return list(found)


def _ranges(bounds: Any, catalogue: Catalogue, problems: Problems) -> dict[str, tuple[float, float]]:
    """Return the ranges of refined designs; what is none is noted."""
    found: dict[str, tuple[float, float]] = {}
    if bounds is None:
        return found
    remedy = "write such as {'a1': (0.2, 0.5)}"
    if not isinstance(bounds, Mapping):
        problems.add("is not a mapping", ("bounds",), remedy)
        return found
    for name, ends in bounds.items():
        try:
            low, high = map(float, ends)
            right = -float("inf") < low < high < float("inf")
        except (TypeError, ValueError, OverflowError):
            right = False
        if right:
            found[str(name)] = low, high
        else:
            texts = [named_with_unit(str(name), end, shown=False) for end in listed(ends)]
            pair: Remedy = ("write ", Pair(), " with finite lo < hi")
            problems.add("is not a range", ("bounds", str(name)), next(filter(None, texts), pair))
    known = {name: one.units for name, one in catalogue.all_inputs.items()}
    return problems.attempt(in_si, "bounds", found, known) or {}


# -- Join the parts of a map, or of a search


#: More threads than these do not copy faster.
MOST_THREADS = 4
#: What is told of the run of a joined search, from its parts.
OF_RUN = ("run_time_s", "threads", JOINED, CORE_TIME)


@door
def join(
    paths: str | Path | Sequence[str | Path],
    *,
    to: str | Path,
    copy: bool = False,
    overwrite: bool = False,
    restart: bool = False,
    progress: bool | None = None,
    mechanism: Extension | None = None,
) -> xr.Dataset:
    """Join the parts of a map to the map that one sweep of all designs writes; those of a search to its result.

    Its values stay in the files of the parts, which the map shows as one, as virtual datasets of HDF5. Nothing is
    copied; the parts must stay, and are moved together with the map. `fastlink.open` refuses the map where a part is
    missing or has changed since, and `fastlink.check` reads them all. With ``copy=True`` the values are copied to one
    file, each checked against the checksums of its part as it is read; a copy that was killed goes on when it is called
    again.

    The labels and the bits are those of the whole sweep, and `fastlink.sweep` of the same request finds its map in the
    file. Counts of designs and run times are sums, measured errors the greatest of all parts; docs/performance.md tells
    each attribute. Of a search the best rows of all parts are refined here, to the bits of one search of all designs;
    its file needs no part any more.

    Parameters
    ----------
    paths : path, or sequence of paths
        The files of all parts, made with ``part=(k, n)``; the folder that holds them; or a pattern such as
        ``"maps.part-*.h5"``.
    to : path
        The HDF5 file to write; without a copy in the folder of the parts, or in one above it.
    copy : bool, default False
        Copy the values, to a file that does not need the parts any more.
    overwrite : bool, default False
        Replace an existing file. Without it, an existing map of the same request, unchanged since, is opened as it is.
    restart : bool, default False
        Throw away what an interrupted join has left in ``FILE.part``.
    progress : bool, optional
        Show a progress bar on standard error; by default only on a terminal.
    mechanism : Extension, optional
        Of a search by quantities of one's own: what `fastlink.extend` returned, with which the parts were made.

    Returns
    -------
    xarray.Dataset
        Opened lazily from the file.

    Raises
    ------
    InputError
        A part is missing, damaged, doubled with other values or of another map; the message names it.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> request = "planar_4r", fl.grid(a1=0.4, a2=[1.1, 1.2, 1.3], a3=0.8, a4=[1.0, 1.1]), ["transmission_angle_min"]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     for k in (1, 2, 3):
    ...         fl.sweep(*request, part=(k, 3), to=f"{folder}/maps.part-{k}-of-3.h5", verify=0).close()
    ...     with fl.join(folder, to=pathlib.Path(folder, "maps.h5")) as maps:
    ...         dict(maps.transmission_angle_min.sizes)
    {'a2': 3, 'a4': 2}
    """
    problems = Problems()
    ways: dict[str, Any] = {"overwrite": overwrite, "restart": restart}
    checked = problems.attempt(check_options, {"to": to, **ways, "progress": progress})
    problems.attempt(check_switch, ("copy",), copy)
    parts = problems.attempt(part_files, paths)
    problems.stop()
    if SEARCH in parts[0].whole():
        return _joined_search(parts, mechanism, checked["progress"], Path(to), **ways)
    if mechanism is not None:
        remedy = "leave it out: maps are joined as they are"
        raise InputError("counts for the parts of a search alone", ("mechanism",), remedy)
    joined = JoinedMap(parts)
    about: dict[str, Any] = {"coords": joined.coords, "variables": joined.variables, "attrs": {}}
    if not overwrite:
        found = finished_map(to, joined.fingerprint, verified=0, **about)
        if found is not None:
            if copy and shown_parts(Path(found.encoding["source"])):
                found.close()
                raise exists_error(Path(to), "and shows the values of its parts")
            return with_remark(found)
    path = check_target(to, 0, overwrite, [part.path for part in parts])
    shown = None if copy else joined.shown_in(path.parent)
    ways |= {"run": joined.run(shown), "shown": shown}
    with Writer(path, joined.coords, joined.variables, {}, **ways) as writer:
        with ProgressBar(joined.designs, checked["progress"]) as bar:
            for start, stop in writer.written:
                bar.take(start, stop, [])
            threads = min(default_threads(), MOST_THREADS)
            joined.copy(writer, threads, lambda start, stop: bar.take(start, stop, []), shown)
        writer.finish(joined.last_attrs(path.name), joined.errors)
    return with_remark(open_map(path))


def _joined_search(
    parts: Sequence[PartFile], own: Extension | None, progress: bool | None, to: Path, **ways: Any
) -> xr.Dataset:
    """Return the result of the search of all parts."""
    try:
        request, found, verify = request_of_parts(parts, own)
    except (KeyError, ValueError, TypeError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        what = f"{parts[0].path}: what it says of its search cannot be read ({reason(error)})"
        raise InputError(what, ("paths",), RUN_AGAIN) from error
    stream = Stream(request.resolved, request.kept, request.along)
    kept = stream.nothing()
    for one in found:
        stream.merge(kept, one)
    stream.settle(kept)
    about = {name: value for name, value in merged([part.attrs for part in parts]).items() if name in OF_RUN}
    about["designs_per_second"] = request.size / about["run_time_s"]
    how: dict[str, Any] = {"verify": DESIGNS if verify is None else verify, "progress": progress}
    ways |= {"made": f"join {len(parts)} parts of a search", "parts": parts}

    def result(path: Path) -> tuple[xr.Dataset, None]:
        return finished(request, stream, kept, about, **how), None

    return to_file(to, request.about(), request.fingerprint, result, **ways)

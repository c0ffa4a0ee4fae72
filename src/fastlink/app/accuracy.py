"""Error against run time of a study's quantities, by every method: measured, compared, drawn."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from fastlink._text import aligned, counted, duration, writable
from fastlink.app.study import Study, in_study, read_study
from fastlink.engine.labels import flag_attrs
from fastlink.engine.options import check_options
from fastlink.engine.resolve import ResolvedSweep, resolve
from fastlink.engine.run import Job, run
from fastlink.errors import InputError, door, require_package
from fastlink.facts.catalogue import ELIMINATED
from fastlink.io.layout import plain_attrs
from fastlink.io.output import write_whole
from fastlink.io.partial_file import check_target
from fastlink.io.writer import as_bytes
from fastlink.mechanisms import name_of
from fastlink.pictures.picture import check_picture, save
from fastlink.precision.errors import outermost, read_curves
from fastlink.precision.reference import CONTEXT, HighPrecision
from fastlink.precision.stationary import stationary_of
from fastlink.space.design_space import EXTREMUM, DesignSpace, sampled

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from fastlink.engine.extend import Extension
    from fastlink.plan.programs import Plan


# -- The methods for a quantity, NumPy among them, and their run times


#: Numbers of input angles that extremes are sampled at, and the one for everything else.
ANGLES = tuple(2**k for k in range(5, 13))
USUAL = 360
#: Methods outside the kernels are so slow that only a few designs are evaluated.
BASELINE_DESIGNS = 8
#: A run that is timed lasts at least so long (other processes leave some runs of that length whole), with at most so
#: many designs.
SECONDS, MOST_TIMED_DESIGNS = 0.002, 2**16
#: Rounds end when no method got faster by this share in so many of them, and after the last.
GAIN, IDLE, MOST_ROUNDS = 0.01, 6, 40
#: A method takes about so long (compiling, a dozen rounds), and so does a design of the 50-digit reference.
SECONDS_PER_METHOD, SECONDS_PER_DESIGN = 0.2, 0.04


@dataclass(frozen=True)
class Subject:
    """A quantity of sampled designs, with the options that all methods share."""

    mechanism: str | Extension
    space: DesignSpace
    quantity: str
    options: Mapping[str, Any]

    def resolve(self, **options: Any) -> ResolvedSweep:
        """Return the request, resolved with further options."""
        return resolve(self.mechanism, self.space, [self.quantity], **{**self.options, **options})


@dataclass(frozen=True)
class Method:
    """One method to compute a quantity."""

    #: As in the table.
    name: str
    #: Of `fastlink.sweep`.
    options: Mapping[str, Any] = field(default_factory=dict)
    #: ``job(resolved)`` returns the compiled kernels with their designs and input positions.
    job: Callable[[ResolvedSweep], Job] = ResolvedSweep.job
    #: ``baseline(resolved, designs)`` returns the values of the first designs without any kernel.
    baseline: Callable[[ResolvedSweep, int], NDArray[Any]] | None = None

    def prepare(self, subject: Subject) -> Trial:
        """Return the values of a quantity by this method, ready to be timed again."""
        if self.baseline is not None:
            resolved = subject.resolve(**self.options)
            designs = min(subject.space.size, BASELINE_DESIGNS)
            started = time.perf_counter()
            values = self.baseline(resolved, designs)
            return Trial(values, designs, None, time.perf_counter() - started)
        trial = self._run_kernels(subject)
        while (
            seconds := min(trial.time() for _ in range(3))
        ) < SECONDS and trial.designs < MOST_TIMED_DESIGNS:
            times = 2 ** math.ceil(math.log2(2 * SECONDS / max(seconds, SECONDS / 64)))
            columns = {name: np.tile(column, times) for name, column in subject.space.columns.items()}
            space = replace(subject.space, shape=(subject.space.size * times,), columns=columns)
            subject = replace(subject, space=space)
            trial = self._run_kernels(subject)
        return trial

    def _run_kernels(self, subject: Subject) -> Trial:
        resolved = subject.resolve(**self.options)
        job = self.job(resolved)
        arrays = [np.empty((resolved.space.size, *shape), dtype) for shape, dtype in job.shapes]
        return Trial(arrays[0], resolved.space.size, partial(run, job, targets=arrays))


@dataclass
class Trial:
    """The values of a quantity by a method, and their least time on one thread."""

    values: NDArray[Any]
    designs: int
    run: Callable[[], None] | None
    seconds: float = math.inf

    def time(self) -> float:
        """Evaluate again, unless the method is a slow one, and return the least time so far."""
        if self.run is not None:
            started = time.perf_counter()
            self.run()
            self.seconds = min(self.seconds, time.perf_counter() - started)
        return self.seconds


def race(subject: Subject, methods: Iterable[Method]) -> dict[str, Trial]:
    """Return the trial of each method by name, timed in turns under the same load."""
    trials = {method.name: method.prepare(subject) for method in methods}
    idle = 0
    for _ in range(MOST_ROUNDS):
        before = [trial.seconds for trial in trials.values()]
        after = [trial.time() for trial in trials.values()]
        gained = any(now < (1.0 - GAIN) * then for then, now in zip(before, after, strict=True))
        idle = 0 if gained else idle + 1
        if idle == IDLE:
            break
    return trials


def methods_for(subject: Subject, with_numpy: bool) -> list[Method]:
    """Return every method that the mechanism of a quantity offers, and NumPy's if wanted."""
    resolved = subject.resolve()
    output = resolved.plan.outputs[0]
    others = [name for name in resolved.catalogue.solvers if name != ELIMINATED and resolved.solver]
    if output.request.reduction is None:
        methods = [Method(solver, {"solver": solver}) for solver in (ELIMINATED, *others)]
        return [*methods, *([Method("NumPy", baseline=by_numpy)] if with_numpy else [])]
    methods = [Method("refined")] if output.refined else []
    if resolved.catalogue.positions is not None:  # an input without bounds has no whole turn
        return methods
    sampled = {"extrema": "sampled", "angles": USUAL}
    methods += [Method(f"{count} angles", {**sampled, "angles": count}) for count in ANGLES]
    methods += [Method(f"{USUAL} angles, {solver}", {**sampled, "solver": solver}) for solver in others]
    methods.append(Method(f"{USUAL} angles", sampled))
    if with_numpy:
        methods.append(Method(f"NumPy, {USUAL} angles", sampled, baseline=by_numpy))
    return methods


def curves_by_numpy(resolved: ResolvedSweep, designs: int) -> NDArray[Any]:
    """Return a quantity (designs, branches, positions) from facts read by NumPy, NaN where positions do not count."""
    values: dict[str, Any] = {
        name: column[:, None, None] for name, column in resolved.space.at(np.arange(designs)).items()
    }
    values["branch"] = np.array(resolved.branches, dtype=float)[:, None]
    plan, positions = resolved.plan, resolved.positions
    output, shape = plan.outputs[0], (designs, len(resolved.branches), positions.size)
    names = filter(None, (output.request.quantity, output.counted))
    curves = (read_curves(resolved.catalogue, name, values, positions, plan.variants) for name in names)
    samples, *counted = curves
    for numbers in counted:
        samples = np.where(np.isnan(numbers), np.nan, samples)
    return np.broadcast_to(samples, shape)


def by_numpy(resolved: ResolvedSweep, designs: int) -> NDArray[Any]:
    """Return values of a fact of the design, curves, or their extreme samples."""
    curves, request = curves_by_numpy(resolved, designs), resolved.plan.outputs[0].request
    if not resolved.catalogue.varies(request.quantity):
        return curves[:, 0, 0]
    if request.reduction is None:
        return curves
    sign = request.reduction.sign
    extremes: NDArray[Any] = sign * np.fmax.reduce(sign * curves, axis=-1)
    return extremes


# -- The Pareto front of error against run time


#: Smaller errors count as this one: they are those of the last digits.
EQUAL = 2.0**-48
#: An error that is not smaller than this share of another is not smaller.
ALIKE = 0.99


def front(measured: xr.Dataset) -> NDArray[np.int8]:
    """Return 1 where no other method is faster with an error that is not larger."""
    errors, times = np.maximum(measured["error_max"].values, EQUAL), measured["ns_per_design"].values
    best = np.zeros(errors.shape, dtype=np.int8)
    for quantity in range(errors.shape[1]):
        least = np.inf
        for method in np.lexsort((errors[:, quantity], times[:, quantity])):
            if errors[method, quantity] < ALIKE * least:
                best[method, quantity], least = 1, errors[method, quantity]
    return best


def accuracy_table(measured: xr.Dataset) -> str:
    """Return what was measured as lines of text, the fastest method first; a star marks those that no other beats."""
    head = ("", "way", "ns/design", "largest", "99 %", "median", "missed")
    blocks = []
    for quantity in measured["quantity"].values:
        one = measured.sel(quantity=quantity)
        one = one.isel(way=np.argsort(one["ns_per_design"].values)).dropna("way", subset=["ns_per_design"])
        rows = [head, *(_row(one.isel(way=k)) for k in range(one.sizes["way"]))]
        blocks.append(f"{quantity}\n{aligned(rows, right=2)}")
        if folded := int(one[CHANGE_POINTS].max()) if CHANGE_POINTS in one else 0:
            blocks[-1] += f"\n   {counted(folded, 'design')} left out: change points, where all bars fold"
    return "\n\n".join(blocks)


def _row(method: Any) -> tuple[str, ...]:
    errors = [float(method[name]) for name in ("error_max", "error_99", "error_median")]
    texts = ["-" if math.isnan(error) else f"{error:.1e}" for error in errors]
    missed = f"{int(method['missed'])} of {int(method['values'])}"
    star, name = "*" if int(method["pareto"]) else "", str(method["way"].values)
    return (star, name, f"{float(method['ns_per_design']):,.0f}", *texts, missed)


# -- The picture of error against run time, with every method named


#: Smaller errors are drawn as this one, half a rounding of a double.
LEAST = 2.0**-54
COLUMNS = 2
#: Of the names of points: the size of their letters, how far they may stand from their points, and in which directions.
SIZE, DISTANCES = 6.5, (5.0, 12.0, 20.0, 30.0, 42.0)
PIECES = 40  # of a line between two points, which names keep free
DIRECTIONS = ((1.0, 0.0), (0.7, 0.9), (0.7, -0.9), (-1.0, 0.0), (-0.7, 0.9), (-0.7, -0.9))


def draw(measured: xr.Dataset) -> Figure:
    """Return the work-precision diagram, with a panel for each quantity."""
    from fastlink.pictures.style import NotebookFigure

    quantities = [str(name) for name in measured["quantity"].values]
    columns = min(COLUMNS, len(quantities))
    lines = -(-len(quantities) // columns)
    figure = NotebookFigure(figsize=(5.6 * columns, 4.2 * lines), dpi=160)
    panels = [figure.add_subplot(lines, columns, k + 1) for k in range(len(quantities))]
    pairs = zip(panels, quantities, strict=True)
    points = [_draw_panel(axes, measured.sel(quantity=name), name) for axes, name in pairs]
    figure.draw_without_rendering()  # which settles where the panels are
    figure.set_layout_engine("none")
    for axes, named in zip(panels, points, strict=True):
        _name_points(axes, named)
    return figure


def _draw_panel(axes: Any, measured: xr.Dataset, quantity: str) -> list[tuple[str, float, float]]:
    """Draw error over time of all methods for one quantity; return their names and places."""
    from matplotlib.ticker import LogLocator, NullLocator

    measured = measured.isel(way=np.flatnonzero(np.isfinite(measured["error_max"].values)))
    times, errors = measured["ns_per_design"].values, np.maximum(measured["error_max"].values, LEAST)
    on_front = measured["pareto"].values == 1
    order = np.flatnonzero(on_front)[np.argsort(times[on_front])]
    axes.plot(times[order], errors[order], color="tab:blue", zorder=1)
    axes.scatter(times, errors, c=np.where(on_front, "tab:blue", "0.6"), s=18, zorder=2)
    axes.set(xscale="log", yscale="log", title=quantity, xlabel="run time per design / ns")
    axes.set_ylabel("largest relative error")
    axes.margins(x=0.3, y=0.2)
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        if high < 10.0 * low:  # less than a decade, in which numbers stand at whole powers of ten alone
            middle = np.sqrt(low * high)
            axis.set_view_interval(middle / 10.0, 10.0 * middle, ignore=True)
        axis.set_major_locator(LogLocator(numticks=8))
        axis.set_minor_locator(NullLocator())
    axes.grid(color="0.9", linewidth=0.6)
    return list(zip(measured["way"].values.tolist(), times.tolist(), errors.tolist(), strict=True))


def _name_points(axes: Any, points: list[tuple[str, float, float]]) -> None:
    """Write the names of points beside them, each where it hides neither a point nor another name."""
    unit = axes.figure.dpi / 72.0
    places = axes.transData.transform([(x, y) for _, x, y in points])
    frame = tuple(axes.get_window_extent().extents / unit)
    (front,) = axes.lines
    corners = axes.transData.transform(front.get_xydata())
    along = [np.linspace(a, b, PIECES) for a, b in itertools.pairwise(corners)]
    kept = np.concatenate([places, *along]) / unit
    taken = [(x - 3.0, y - 3.0, x + 3.0, y + 3.0) for x, y in kept.tolist()]
    for (name, x, y), place in sorted(zip(points, places / unit, strict=True), key=lambda one: one[0][2]):
        width, height = 0.56 * SIZE * len(name), 1.2 * SIZE
        area = width * height
        tried = [
            (shift_x if shift_x >= 0 else shift_x - width, shift_y - 0.5 * height)
            for distance in DISTANCES
            for shift_x, shift_y in (distance * np.array(DIRECTIONS)).tolist()
        ]
        boxes = [(place[0] + a, place[1] + b, place[0] + a + width, place[1] + b + height) for a, b in tried]
        # what lies outside the frame is hidden too
        hidden = [sum(_overlap(box, one) for one in taken) + area - _overlap(box, frame) for box in boxes]
        best = int(np.argmin(hidden))
        taken.append(boxes[best])
        shift = (tried[best][0], tried[best][1] + 0.5 * height)
        arrow = {"arrowstyle": "-", "color": "0.6", "linewidth": 0.5} if best >= len(DIRECTIONS) else None
        style = {"textcoords": "offset points", "fontsize": SIZE, "va": "center", "arrowprops": arrow}
        axes.annotate(name, (x, y), xytext=shift, **style)


def _overlap(one: tuple[float, ...], other: tuple[float, ...]) -> float:
    """Return the area that two boxes (left, lower, right, upper) share."""
    width = min(one[2], other[2]) - max(one[0], other[0])
    height = min(one[3], other[3]) - max(one[1], other[1])
    return max(0.0, width) * max(0.0, height)


# -- The values of a quantity of sampled designs with 50 digits


@dataclass(frozen=True)
class Truth:
    """Exact values, and their indices among the values of a method."""

    #: (design, branch[, position]), or (design,) for a fact of the design.
    indices: list[tuple[int, ...]]
    #: Numbers of 50 digits, infinities among them; NaN of what is not compared.
    exact: list[Any]
    #: How many designs are change points. Doubles cannot tell them from their neighbours: their extremes are left out.
    change_points: int = 0

    def errors(self, values: NDArray[Any]) -> tuple[NDArray[Any], int, int]:
        """Return relative errors of finite values, the number of wrong ones, and of all."""
        errors, wrong, count = [], 0, 0
        for index, exact in zip(self.indices, self.exact, strict=True):
            if index[0] >= len(values) or CONTEXT.isnan(exact):
                continue
            value, count = float(values[index]), count + 1
            if not (np.isfinite(value) and CONTEXT.isfinite(exact)):
                wrong += int(exact != value)
            elif exact != 0:
                errors.append(float(abs(CONTEXT.mpf(value) - exact) / abs(exact)))
        return np.array(errors), wrong, count


def truth_of(subject: Subject, rng: np.random.Generator) -> Truth:
    """Return exact values of a quantity, one for each design at random."""
    resolved = subject.resolve()
    output, catalogue, variants = resolved.plan.outputs[0], resolved.catalogue, resolved.plan.variants
    count, request = resolved.space.size, output.request
    inputs, k = resolved.space.at(np.arange(count)), rng.integers(len(resolved.branches), size=count)
    branches = np.array(resolved.branches, dtype=float)[k]
    if request.reduction is not None:
        stationary = stationary_of(catalogue, request.quantity, inputs, branches, variants)
        extremes = [
            CONTEXT.nan if folds else outermost(stationary, design, request.reduction.sign).value
            for design, folds in enumerate(stationary.folds)
        ]
        folded = int(stationary.folds.sum())
        return Truth(list(zip(range(count), k.tolist(), strict=True)), extremes, folded)
    positions = rng.integers(resolved.positions.size, size=count)
    given = (*inputs, catalogue.position.name, "branch")
    facts = HighPrecision(catalogue, [request.quantity], given, variants)
    indices: list[tuple[int, ...]] = []
    exact = []
    for design in range(count):
        values = {name: float(column[design]) for name, column in inputs.items()}
        values |= {"branch": branches[design], catalogue.position.name: resolved.positions[positions[design]]}
        exact.append(facts.at(values)[request.quantity])
        indices.append((design, int(k[design]), int(positions[design])) if output.axes else (design,))
    return Truth(indices, exact)


# -- Measure error against run time of a study's quantities, by every method


CHANGE_POINTS = "change_points"
#: The variables of the result, each over methods and quantities.
LABELS = {
    "error_max": ("1", "largest relative error"),
    "error_99": ("1", "relative error that 99 % are below"),
    "error_median": ("1", "median relative error"),
    "ns_per_design": ("ns", "run time of a design in all branches, one thread, least of repetitions"),
    "missed": ("1", "extremes that are off by more than 1 %, infinite wrongly, or not found"),
    "values": ("1", "values compared"),
    CHANGE_POINTS: ("1", "designs that are change points, whose extremes are left out"),
}
MISSED = 0.01


@door(hint=in_study)
def accuracy(
    study: str | Path,
    *,
    designs: int = 64,
    outside: bool = False,
    seed: int = 0,
    to: str | Path | None = None,
    picture: str | Path | None = None,
    overwrite: bool = False,
    announce: Callable[[str], None] | None = None,
    trust_code: bool = False,
) -> xr.Dataset:
    """Measure error and run time of a study's quantities by every method.

    The methods are refined extremes and those of 32 ... 4096 input angles, and reactions by elimination and by LU of
    the 9x9 system; the reference has 50 digits. docs/accuracy.md says which defaults follow from it.

    Parameters
    ----------
    study : str or path
        The study, a TOML file. Its designs are sampled; curves, facts of the design, greatest and least values are
        measured, other quantities are named in the attribute ``left_out``.
    designs : int, default 64
        Number of designs.
    outside : bool, default False
        Add NumPy, which reads the same facts without any kernel and takes longer.
    seed : int, default 0
        Seed of the sample; the same seed gives the same designs.
    to : path, optional
        An HDF5 file to write.
    picture : path, optional
        A work-precision diagram to write, png, svg or pdf by its ending.
    overwrite : bool
        Replace an existing file.
    trust_code : bool, default False
        Run the Python file of quantities that the study names (see `fastlink.run`).
    announce : callable, optional
        Called before the measurement with a line that says how much is measured and about how long it takes.

    Returns
    -------
    xarray.Dataset
        Dimensions ``way`` (the method) and ``quantity``; NaN where a method does not give a quantity. ``pareto`` is 1
        where no other method is both faster and more accurate. ``.fastlink.summary()`` is a table to
        print.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> text = '''
    ... mechanism = "planar_4r"
    ... quantities = ["grashof_excess"]
    ... design = {a1 = 0.4, a2 = {linspace = [1.0, 1.3, 9]}, a3 = 0.8, a4 = 1.0}
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     study = pathlib.Path(folder, "study.toml")
    ...     _ = study.write_text(text)
    ...     measured = accuracy(study, designs=4)
    >>> dict(measured.sizes), bool((measured.error_max < 1e-14).all())
    ({'way': 1, 'quantity': 1}, True)
    """
    check_options(locals())
    read = read_study(study, trust_code)
    target = None if to is None else check_target(to, 0, overwrite, read.sources, at_once=True)
    path = None if picture is None else check_picture(picture, "picture")
    if path is not None:
        require_package("matplotlib", ("picture",))
    offered = partial(methods_for, with_numpy=outside)
    measured = measure(read, offered, designs=designs, seed=seed, announce=announce)
    if target is not None:
        write_whole(target, partial(as_bytes, measured), overwrite=overwrite)
    if path is not None:
        save(draw(measured), path, "picture")
    return measured


def measure(
    study: Study,
    methods_of: Callable[[Subject], list[Method]],
    *,
    designs: int,
    seed: int = 0,
    announce: Callable[[str], None] | None = None,
) -> xr.Dataset:
    """Measure error and run time of a study's quantities by given methods."""
    mechanism, options = study.mechanism, study.options
    resolved = resolve(mechanism, study.space, study.quantities, **options)
    rng = np.random.default_rng(seed)
    columns = resolved.space.at(resolved.space.some(designs, rng))
    space = sampled("table", {}, columns, {"design_kind": "table"})
    quantities, left_out = _measurable(resolved.plan)
    if not quantities:
        what = "none is a curve, a fact of the design, NAME_max or NAME_min"
        raise InputError(what, ("quantities",), "add one of these")
    # each method names its own solver; the others have the closed form
    subjects = [Subject(mechanism, space, name, {**options, "solver": ELIMINATED}) for name in quantities]
    methods = [methods_of(subject) for subject in subjects]
    if announce is not None:
        announce(_expected(sum(map(len, methods)), len(quantities), space.size))
    rows: dict[tuple[str, str], dict[str, float]] = {}
    for subject, offered in zip(subjects, methods, strict=True):
        truth = truth_of(subject, rng)
        for name, trial in race(subject, offered).items():
            time = 1e9 * trial.seconds / trial.designs
            found = {"ns_per_design": time, CHANGE_POINTS: float(truth.change_points)}
            rows[name, subject.quantity] = _statistics(*truth.errors(trial.values)) | found
    attrs = {
        "title": f"{resolved.catalogue.title}: error against run time",
        "mechanism": name_of(mechanism),
        "study_file": writable(study.path.name),
        "study": study.text,
        "designs": space.size,
        "seed": seed,
        "reference": "the same facts with 50 digits; extremes refined with 50 digits",
        "threads": 1,
    } | ({"left_out": " ".join(left_out)} if left_out else {})
    return _labelled(rows, quantities, attrs)


def _expected(methods: int, quantities: int, designs: int) -> str:
    """Return the announcement of how much is measured, and about how long it takes."""
    seconds = methods * SECONDS_PER_METHOD + quantities * designs * SECONDS_PER_DESIGN
    work = f"{quantities} quantit{'y' if quantities == 1 else 'ies'} of {counted(designs, 'design')}"
    return f"{work} by {counted(methods, 'method')} in all: about {duration(max(1, round(seconds)))}"


def _measurable(plan: Plan) -> tuple[list[str], list[str]]:
    """Return the names that are measured, and the others: codes, means, lists, residuals, bounds of extremes."""
    measurable = []
    for output in plan.outputs:
        request = output.request
        listed = request.listed or EXTREMUM in output.axes
        number = output.dtype == "float64" and "residual" not in request.quantity and not listed
        of_value = request.can_be_refined and not (
            request.is_position or request.is_of_gradient or request.is_error
        )
        extreme = of_value and plan.catalogue.graded is not None
        if number and (request.reduction is None or extreme):
            measurable.append(output.name)
    return measurable, [o.name for o in plan.outputs if o.name not in (*measurable, "status")]


def _statistics(errors: NDArray[Any], wrong: int, count: int) -> dict[str, float]:
    statistics = {"missed": float(wrong + np.sum(errors > MISSED)), "values": float(count)}
    if errors.size:
        statistics |= {"error_max": float(errors.max()), "error_median": float(np.median(errors))}
        statistics["error_99"] = float(np.quantile(errors, 0.99, method="higher"))
    return statistics


def _labelled(
    rows: dict[tuple[str, str], dict[str, float]], quantities: list[str], attrs: dict[str, Any]
) -> xr.Dataset:
    methods = list(dict.fromkeys(method for method, _ in rows))
    data: dict[str, Any] = {}
    for name, (units, meaning) in LABELS.items():
        values = [[rows.get((method, q), {}).get(name, np.nan) for q in quantities] for method in methods]
        data[name] = (("way", "quantity"), np.array(values), {"units": units, "long_name": meaning})
    coords = {"way": ("way", methods), "quantity": ("quantity", quantities)}
    result = xr.Dataset(data, coords=coords, attrs=plain_attrs(attrs))
    fastest = {"long_name": "no other method is faster and more accurate"}
    labels = fastest | flag_attrs({0: "beaten", 1: "best"}, "int8")
    result["pareto"] = (("way", "quantity"), front(result), labels)
    return result

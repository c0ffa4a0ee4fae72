"""Error against run time: a study's quantities on a sample of its designs by every way there is."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from fastlink.catalogue.declare import ELIMINATED
from fastlink.diagnostics.methods import SECONDS_OF_DESIGN, SECONDS_OF_WAY, Subject, methods_for, race
from fastlink.diagnostics.pareto import draw, front
from fastlink.diagnostics.truth import truth_of
from fastlink.engine.resolve import resolve
from fastlink.errors import InputError
from fastlink.io.dataset import plain_attrs
from fastlink.io.partial_file import check_target
from fastlink.space.design_space import sampled
from fastlink.study.study import read_study

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from fastlink.plan.plan import Plan

__all__ = ["accuracy"]

#: What is written for each way and quantity.
LABELS = {
    "error_max": ("1", "largest relative error"),
    "error_99": ("1", "relative error that 99 % are below"),
    "error_median": ("1", "median relative error"),
    "ns_per_design": ("ns", "run time of a design in all branches, one thread, least of repetitions"),
    "missed": ("1", "extremes that are off by more than 1 %, infinite wrongly, or not found"),
    "values": ("1", "values compared"),
}
MISSED = 0.01


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
) -> xr.Dataset:
    """Measure error and run time of a study's quantities by every way that the engine offers.

    Extremes refined and over 32 ... 4096 input angles, reactions by elimination and by LU of the 9x9 system, strict
    and relaxed arithmetic; the reference has 50 digits. docs/accuracy.md tells which defaults follow from it.

    Parameters
    ----------
    study : str or path
        The study, a TOML file. Its designs are sampled; curves, facts of the design, greatest and least values are
        measured, other quantities are named in the attribute ``left_out``.
    designs : int, default 64
        Number of designs.
    outside : bool, default False
        Also NumPy and scipy without any kernel, which take longer.
    seed : int, default 0
        Of the sample; the same seed gives the same designs.
    to : path, optional
        An HDF5 file to write.
    picture : path, optional
        A work-precision diagram to write, png, svg or pdf by its ending.
    overwrite : bool
        Replace an existing file.
    announce : callable, optional
        Called with a line that says how much is measured and about how long it takes, before it starts.

    Returns
    -------
    xarray.Dataset
        Dimensions ``way`` and ``quantity``; NaN where a way does not lead to a quantity. ``pareto`` is 1 where no
        other way is both faster and more accurate. Print it with `fastlink.accuracy_table`.

    Raises
    ------
    InputError
        One line for each problem of the study; nothing in it can be measured.

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
    ({'way': 2, 'quantity': 1}, True)
    """
    for name, value in (("designs", designs), ("seed", seed)):
        if isinstance(value, bool) or not isinstance(value, int) or value < (name == "designs"):
            remedy = f"write a whole number of at least {int(name == 'designs')}"
            raise InputError(f"is {value!r}", where=(name,), remedy=remedy)
    read = read_study(study)
    place = None if to is None else check_target(to, 0, overwrite)
    asked = resolve(read.shape.mechanism, read.space, read.shape.quantities, **read.options)
    rng = np.random.default_rng(seed)
    columns = asked.space.at(asked.space.some(designs, rng))
    space = sampled("table", {}, columns, {"design_kind": "table"})
    measured, left_out = _measurable(asked.plan)
    if not measured:
        what = "none is told of single positions or of the design, or is NAME_max or NAME_min"
        raise InputError(what, where=("quantities",), remedy="ask for one of these")
    # each way has a solver of its own, the closed form unless it is named after another
    options = {**read.options, "solver": ELIMINATED}
    subjects = [Subject(read.shape.mechanism, space, quantity, options) for quantity in measured]
    ways = [methods_for(subject, outside) for subject in subjects]
    if announce is not None:
        announce(_expected(sum(map(len, ways)), len(measured), space.size))
    rows: dict[tuple[str, str], dict[str, float]] = {}
    for subject, of_subject in zip(subjects, ways, strict=True):
        truth, quantity = truth_of(subject, rng), subject.quantity
        for way, bound in race(subject, of_subject).items():
            time = 1e9 * bound.seconds / bound.designs
            rows[way, quantity] = _statistics(*truth.errors(bound.values)) | {"ns_per_design": time}
    attrs = {
        "title": f"{asked.catalogue.title}: error against run time",
        "mechanism": read.shape.mechanism,
        "study_file": read.path.name,
        "study": read.text,
        "designs": space.size,
        "seed": seed,
        "reference": "the same facts with 50 digits; extremes refined with 50 digits",
        "threads": 1,
    } | ({"left_out": " ".join(left_out)} if left_out else {})
    result = _labelled(rows, measured, attrs)
    if place is not None:
        result.to_netcdf(place, engine="h5netcdf")
    if picture is not None:
        draw(result, picture)
    return result


def _expected(ways: int, quantities: int, designs: int) -> str:
    """Return what is said before measuring."""
    seconds = ways * SECONDS_OF_WAY + quantities * designs * SECONDS_OF_DESIGN
    of = "quantity" if quantities == 1 else "quantities"
    return f"{ways} ways to {quantities} {of} of {designs} designs: about {max(1, round(seconds))} s"


def _measurable(plan: Plan) -> tuple[list[str], list[str]]:
    """Return the names that are measured, and those that are not: codes, means, lists, residuals."""
    known = []
    for output in plan.outputs:
        request = output.request
        number = output.dtype == "float64" and "residual" not in request.quantity and not request.listed
        extreme = request.can_be_refined and not request.place and plan.catalogue.graded is not None
        if number and (request.reduction is None or extreme):
            known.append(output.name)
    return known, [o.name for o in plan.outputs if o.name not in (*known, "status")]


def _statistics(errors: NDArray[Any], wrong: int, count: int) -> dict[str, float]:
    found = {"missed": float(wrong + np.sum(errors > MISSED)), "values": float(count)}
    if errors.size:
        found |= {"error_max": float(errors.max()), "error_median": float(np.median(errors))}
        found["error_99"] = float(np.quantile(errors, 0.99, method="higher"))
    return found


def _labelled(
    rows: dict[tuple[str, str], dict[str, float]], quantities: list[str], attrs: dict[str, Any]
) -> xr.Dataset:
    ways = list(dict.fromkeys(way for way, _ in rows))
    data: dict[str, Any] = {}
    for name, (units, meaning) in LABELS.items():
        values = [[rows.get((way, q), {}).get(name, np.nan) for q in quantities] for way in ways]
        data[name] = (("way", "quantity"), np.array(values), {"units": units, "long_name": meaning})
    coords = {"way": ("way", ways), "quantity": ("quantity", quantities)}
    result = xr.Dataset(data, coords=coords, attrs=plain_attrs(attrs))
    labels = {
        "long_name": "no other way is faster and more accurate",
        "flag_values": np.array([0, 1], dtype=np.int8),
        "flag_meanings": "beaten best",
    }
    result["pareto"] = (("way", "quantity"), front(result), labels)
    return result

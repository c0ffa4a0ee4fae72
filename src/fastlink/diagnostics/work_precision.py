"""Measure error against run time of a study's quantities, by every method."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from fastlink._text import counted, duration, short_repr, writable
from fastlink.catalogue.declare import ELIMINATED
from fastlink.diagnostics.methods import SECONDS_PER_DESIGN, SECONDS_PER_METHOD, Subject, methods_for, race
from fastlink.diagnostics.pareto import front
from fastlink.diagnostics.picture import draw
from fastlink.diagnostics.truth import truth_of
from fastlink.doors import door
from fastlink.engine.options import Check, check_options, optional
from fastlink.engine.resolve import resolve
from fastlink.errors import InputError, KeyPath
from fastlink.io.dataset import plain_attrs
from fastlink.io.output import write_whole
from fastlink.io.writing.skeleton import as_bytes
from fastlink.io.writing.target import check_made_at_once
from fastlink.mechanisms import name_of
from fastlink.options import MOST_SEED, check_path, check_switch, check_whole
from fastlink.plot.picture import check_picture, save
from fastlink.space.design_space import sampled
from fastlink.study.schema import A_STUDY
from fastlink.study.study import read_study

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from fastlink.diagnostics.methods import Method
    from fastlink.plan.plan import Plan
    from fastlink.study.study import Study

__all__ = ["accuracy", "measure"]

#: The variables of the result, each over methods and quantities.
LABELS = {
    "error_max": ("1", "largest relative error"),
    "error_99": ("1", "relative error that 99 % are below"),
    "error_median": ("1", "median relative error"),
    "ns_per_design": ("ns", "run time of a design in all branches, one thread, least of repetitions"),
    "missed": ("1", "extremes that are off by more than 1 %, infinite wrongly, or not found"),
    "values": ("1", "values compared"),
}
MISSED = 0.01
#: More designs take the 50-digit reference more than an hour for one quantity.
MOST_DESIGNS = 100_000


def _check_announce(where: KeyPath, announce: Any) -> Any:
    """Return a function, or refuse what cannot be called."""
    if not callable(announce):
        remedy = "write a function that takes a line of text, such as print"
        raise InputError(f"is {short_repr(announce)}", where=where, remedy=remedy)
    return announce


#: The checks of the options that only the measurement has.
CHECKS: dict[str, Check] = {
    "announce": optional(_check_announce),
    "designs": partial(check_whole, least=1, most=MOST_DESIGNS),
    "outside": check_switch,
    "picture": optional(partial(check_path, example="map.png")),
    "seed": partial(check_whole, least=0, most=MOST_SEED),
}


@door(hint=A_STUDY)
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
        Run the Python file of quantities that the study names (see `fastlink.run_study`).
    announce : callable, optional
        Called before the measurement with a line that says how much is measured and about how long it takes.

    Returns
    -------
    xarray.Dataset
        Dimensions ``way`` (the method) and ``quantity``; NaN where a method does not give a quantity. ``pareto`` is 1
        where no other method is both faster and more accurate. Print it with `fastlink.accuracy_table`.

    Raises
    ------
    InputError
        The study has problems (one line for each), or nothing in it can be measured.

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
    given = {"designs": designs, "outside": outside, "seed": seed, "to": to, "picture": picture}
    check_options(given | {"overwrite": overwrite, "announce": announce}, CHECKS)
    read = read_study(study, trust_code)
    target = None if to is None else check_made_at_once(to, 0, overwrite, read.sources)
    path = None if picture is None else check_picture(picture, "picture")
    offered = partial(methods_for, with_numpy=outside)
    measured = measure(read, offered, designs=designs, seed=seed, announce=announce)
    if target is not None:
        write_whole(target, as_bytes(measured), overwrite=overwrite)
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
        raise InputError(what, where=("quantities",), remedy="add one of these")
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
            rows[name, subject.quantity] = _statistics(*truth.errors(trial.values)) | {"ns_per_design": time}
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
    """Return the names that are measured, and the others: codes, means, lists, residuals."""
    measurable = []
    for output in plan.outputs:
        request = output.request
        number = output.dtype == "float64" and "residual" not in request.quantity and not request.listed
        extreme = (
            request.can_be_refined
            and not (request.is_position or request.is_of_gradient)
            and plan.catalogue.graded is not None
        )
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
    labels = {
        "long_name": "no other method is faster and more accurate",
        "flag_values": np.array([0, 1], dtype=np.int8),
        "flag_meanings": "beaten best",
    }
    result["pareto"] = (("way", "quantity"), front(result), labels)
    return result

"""Tell what manufacturing tolerances do to the results of a map or a study."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.app.report import CONTRIBUTION, TOLERANCED, change_name
from fastlink.app.study import read_study
from fastlink.design.refine import Model
from fastlink.design.search import labels_of
from fastlink.engine.designs import without
from fastlink.engine.extend import Extension, is_own, own_refused
from fastlink.engine.function import derivative_of
from fastlink.engine.options import check_options
from fastlink.engine.resolve import given_tolerances, resolve
from fastlink.engine.sweep import sweep
from fastlink.errors import InputError, Problems, check_path, door, remark
from fastlink.facts.derivative import is_tolerance, tolerance_name, toleranced
from fastlink.io.reader import as_map
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.query import check_names, parse_request
from fastlink.space.design_space import BRANCH, DESIGN, MODELS, DesignSpace, bounds_of
from fastlink.space.tables import as_space

if TYPE_CHECKING:
    import xarray as xr

    from fastlink.facts.catalogue import Catalogue


# -- Changes by tolerances from derivatives that are known, and the share of each input in them


HOWS = ("worst", "rss")


def from_derivatives(
    maps: xr.Dataset, subject: Subject, slopes: Mapping[str, Mapping[str, str]], wanted: Sequence[str]
) -> xr.Dataset | None:
    """Return results and changes from the derivatives that a map has; None where it lacks one, or has other units."""
    space = subject.space
    if any(is_tolerance(name) and name not in space.constants for name in space.names):
        return None
    labels = labels_of(resolve(subject.mechanism, space, wanted, **subject.options))
    results = [str(name) for name in labels.data_vars if name not in wanted or name in slopes]
    known = [*results, *(name for of in slopes.values() for name in of.values())]
    inputs = {by for of in slopes.values() for by in of}
    if not maps.data_vars.keys() >= {*known}:
        return None
    if any(maps[name].attrs.get("units") != labels[name].attrs.get("units") for name in (*results, *inputs)):
        return None
    found = maps[list(dict.fromkeys(known))].load()
    found = found.assign_coords({name: labels[name] for name in space.constants if is_tolerance(name)})
    changes: dict[str, xr.DataArray] = {}
    for name, of in slopes.items():
        terms = [abs(found[slope]) * _size(found, by) for by, slope in of.items()]
        for how, add in zip(HOWS, (np.add, np.hypot), strict=True):
            total = reduce(add, terms).transpose(*found[name].dims)
            changes[change_name(name, how)] = total.variable.copy(deep=False)
            changes[change_name(name, how)].attrs = labels[change_name(name, how)].attrs
    found = found.assign(changes)
    return found[[*map(str, labels.data_vars), *dict.fromkeys(known[len(results) :])]]


def with_contributions(found: xr.Dataset, slopes: Mapping[str, Mapping[str, str]]) -> xr.Dataset:
    """Return results with the change of each by each input alone."""
    if not slopes:
        return found
    import xarray as xr

    inputs = list(dict.fromkeys(by for of in slopes.values() for by in of))
    added: dict[str, Any] = {}
    for name, of in slopes.items():
        blank = xr.zeros_like(found[name])
        parts = [(found[of[by]] * _size(found, by) if by in of else blank).values for by in inputs]
        labels = {key: found[name].attrs[key] for key in ("units", "references") if key in found[name].attrs}
        meaning = f"Change by the tolerance of each input of: {found[name].attrs.get('long_name', name)}"
        labels |= {"long_name": meaning}
        added[f"{name}_{CONTRIBUTION}"] = (*found[name].dims, TOLERANCED), np.stack(parts, axis=-1), labels
    result = found.assign(added)
    label = {"long_name": "input that has a tolerance"}
    return result.assign_coords({TOLERANCED: ((TOLERANCED,), np.array(inputs), label)})


def _size(found: xr.Dataset, by: str) -> Any:
    """Return how far an input may be off."""
    own, share = tolerance_name(by), tolerance_name(by, relative=True)
    return abs(found[by]) * found[share] if share in found.variables else found[own]


# -- Tell what manufacturing tolerances do to the results of a map or a study


@dataclass(frozen=True)
class Subject:
    """A map or a study: what is swept again with tolerances."""

    #: Its mechanism.
    mechanism: str | Extension
    #: Its designs.
    space: DesignSpace
    #: The options of its sweep.
    options: dict[str, Any]
    #: Its results.
    names: list[str]
    #: The branch of each design, where each has one of its own.
    rows: Any = None

    @property
    def catalogue(self) -> Catalogue:
        """The mechanism, as it is driven."""
        return find_catalogue(self.mechanism, self.options.get("input"))

    @classmethod
    def of_map(cls, maps: xr.Dataset, own: Any, names: Sequence[str] | None) -> Subject:
        """Return that of a map, with quantities of a user if these are given; what depends on others is refused."""
        model, rows, options = Model.of_map(maps, own), None, dict[str, Any]()
        text = str(maps.attrs.get("own_quantities", "")) if own is None else ""
        if others := [name for name in map(str, names or maps.data_vars) if is_own(name, text)]:
            raise own_refused(("quantities",), others[0])
        if BRANCH in maps.coords:
            modes = np.asarray(maps[BRANCH].values)
            if maps[BRANCH].dims == (DESIGN,):
                rows, options = modes, {BRANCH: [int(mode) for mode in np.unique(modes)]}
            else:
                options = {BRANCH: int(modes) if modes.ndim == 0 else [int(mode) for mode in modes]}
        cycle = [name for name in (BRANCH, model.catalogue.position.name) if name in maps.coords]
        of_links = [name for names in MODELS.values() for name in names if name in maps.coords]
        if fixed := [str(name) for name in maps.coords if is_own(str(name), text)]:
            if fixed[0] in maps.dims:
                raise own_refused(("maps",), fixed[0])
            cycle += fixed  # what the named results do not depend on
        space = as_space(maps.drop_vars([*map(str, maps.data_vars), *cycle, *of_links]))
        return cls(model.mechanism, space, model.options | options, list(map(str, maps.data_vars)), rows)


@door(hint="write the tolerances of inputs by name, such as a1=1e-4")
def tolerance(
    maps: Any,
    quantities: Sequence[str] | None = None,
    *,
    contributions: bool = False,
    to: str | Path | None = None,
    overwrite: bool = False,
    progress: bool | None = None,
    trust_code: bool = False,
    mechanism: Extension | None = None,
    **tolerances: Any,
) -> xr.Dataset:
    """Tell what manufacturing tolerances do to the results of a map or a study.

    The changes come from the derivatives by the inputs, to first order, see docs/tolerances.md: those that a map has
    already, else the designs are swept again. What a derivative is worth is told by ``NAME_gradient_status``; where
    there is none, as at an infinite value, the change is NaN.

    Parameters
    ----------
    maps : xarray.Dataset or path
        A map, such as one of `fastlink.sweep` or `fastlink.best`, its file, or the path of a study (``.toml``).
    quantities : sequence of str, optional
        Quantities, or their extremes, places and means over the cycle, as in `fastlink.sweep`; by default all of the
        map that change with these tolerances, but for the derivatives of others.
    contributions : bool, default False
        Add ``NAME_contribution``: the change by each input alone, with its sign, along ``toleranced``.
    to : path, optional
        The HDF5 file to write; without it the result stays in memory.
    overwrite, progress
        As in `fastlink.sweep`.
    trust_code : bool, default False
        Run the Python file of quantities that a study names, as in `fastlink.run`.
    mechanism : Extension, optional
        For results of a map that are of quantities of one's own: what `fastlink.extend` returned, with which the map
        was made. What a map says of them is not run.
    **tolerances : float or str
        For each input how far it may be off, in its own unit, ``a1_mm=0.05`` in another, or as a text in per cent of
        its value, such as ``a1="0.1 %"``. What a map has of tolerances already stays unless it is given.

    Returns
    -------
    xarray.Dataset
        For each quantity NAME its value, ``NAME_worst_change``, the change with all inputs off at their worst, and
        ``NAME_rss_change``, the root of the sum of the squares of the changes by each: the standard deviation, if the
        tolerances are standard deviations of independent inputs. The tolerances are coordinates.

    Examples
    --------
    >>> space = fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0)
    >>> maps = fl.sweep("planar_4r", space, ["transmission_angle_min"], branch=1)
    >>> found = fl.tolerance(maps, a1=1e-4, a2=1e-4, a3="0.05 %", contributions=True)
    >>> found.transmission_angle_min_worst_change.values.round(6)
    array([0.00033 , 0.000512])
    >>> found.transmission_angle_min_rss_change.values.round(6)
    array([0.000193, 0.000315])
    >>> found.transmission_angle_min_contribution.sel(toleranced="a1").values.round(6)
    array([-0.000128, -0.000141])
    """
    problems = Problems()
    checked = problems.attempt(check_options, {"contributions": contributions}) or {}
    if checked.get("contributions") and to is not None:
        remedy = "leave one of them out; derivatives such as d_omega4_max_d_a1 can be swept into a file"
        problems.add("is given with to", ("contributions",), remedy)
    if isinstance(quantities, Mapping):
        problems.add("is a mapping", ("quantities",), "write tolerances by name, such as a1=1e-4")
        quantities = None
    names = None if quantities is None else problems.attempt(check_names, "quantities", quantities)
    path = problems.attempt(check_path, ("maps",), maps) if isinstance(maps, (str, os.PathLike)) else None
    is_study = path is not None and path.suffix.lower() == ".toml"
    if is_study and mechanism is not None:
        what = "is for a map: a study names the file of its quantities itself"
        problems.add(what, ("mechanism",), "leave it out")
    problems.stop()
    with ExitStack() as stack:
        dataset = None
        if is_study:
            study = read_study(maps, trust_code)
            subject = Subject(study.mechanism, study.space, dict(study.options), study.quantities)
        else:
            dataset = stack.enter_context(as_map(maps))
            subject = Subject.of_map(dataset, mechanism, names)
        subject = replace(subject, space=_with_tolerances(subject, tolerances))
        slopes = _slopes(subject, _checked(subject, names) if names is not None else _that_change(subject))
        if names is None:  # what a map has for the changes of others
            known = {name for of in slopes.values() for name in of.values()}
            slopes = {name: of for name, of in slopes.items() if name not in known}
        read = [name for of in slopes.values() for name in of.values()]
        wanted = [name for of in slopes for name in (of, *(change_name(of, how) for how in HOWS))]
        found = None
        if dataset is not None and to is None:
            found = from_derivatives(dataset, subject, slopes, wanted)
    if found is None:
        given: dict[str, Any] = {"to": to, "overwrite": overwrite, "progress": progress}
        asked = list(dict.fromkeys([*wanted, *(read if contributions else ())]))
        found = sweep(subject.mechanism, subject.space, asked, **subject.options, **given)
    found = with_contributions(found, slopes if contributions else {})
    found = found.drop_vars([name for name in read if name in found and name not in wanted])
    if subject.rows is None or to is not None or BRANCH not in found.dims:
        return found
    import xarray as xr

    at = np.searchsorted(found[BRANCH].values, subject.rows)  # designs that have one branch each
    return found.isel({BRANCH: xr.DataArray(at, dims=(DESIGN,))})


def _with_tolerances(subject: Subject, tolerances: Mapping[str, Any]) -> DesignSpace:
    """Return the designs of a map or a study with the tolerances that are given, or refuse these."""
    problems = Problems()
    given = given_tolerances(subject.catalogue, tolerances, "tolerance", problems)
    problems.stop()
    own = set(map(toleranced, given))
    space = without(
        subject.space, [n for n in subject.space.names if is_tolerance(n) and toleranced(n) in own]
    )
    if not given and not any(map(is_tolerance, space.names)):
        remedy = f"write such as {next(iter(subject.catalogue.inputs))}=1e-4, in the unit of the input"
        raise InputError("no tolerance is given", ("tolerance",), remedy)
    values = {**space.columns, **space.axes, **{name: np.array(one) for name, one in space.constants.items()}}
    for of, declared in subject.catalogue.all_inputs.items():
        number = given.get(tolerance_name(of, relative=False), 0.0)
        if declared.rule == "positive" and of in values and number > max(bounds_of(values[of])):
            what = f"is {number:g} {declared.units}, more than {of} itself"
            remark(what, ("tolerance", of), f"if it is in per cent, write {of}='{number:g} %'")
    return space.with_constants(given)


def _checked(subject: Subject, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the quantities that a caller names, or refuse them."""
    problems = Problems()
    for k, name in enumerate(names):
        with problems.at("quantities", k):
            parse_request(name, subject.catalogue)
            changed = parse_request(change_name(name), subject.catalogue)
            subject.catalogue.public_fact(changed.quantity)  # codes have none
    problems.stop()
    return names


def _that_change(subject: Subject) -> tuple[str, ...]:
    """Return the results of a map or a study that have a change by its tolerances, or refuse it."""
    found = []
    for name in subject.names:
        try:
            parse_request(change_name(name), subject.catalogue)
            resolve(subject.mechanism, subject.space, [change_name(name)], **subject.options)
        except InputError:
            continue
        found.append(name)
    if not found:
        what = f"none of {', '.join(subject.names)} changes with these tolerances"
        remedy = "name quantities that do, or give the tolerance of an input on which these depend"
        raise InputError(what, ("quantities",), remedy)
    return tuple(found)


def _slopes(subject: Subject, names: Sequence[str]) -> dict[str, dict[str, str]]:
    """Return for each result its derivatives, by the inputs that have tolerances."""
    request = resolve(
        subject.mechanism, subject.space, [change_name(name) for name in names], **subject.options
    )
    catalogue, plan = request.catalogue, request.plan
    found: dict[str, dict[str, str]] = {}
    for name in names:
        of = parse_request(name, catalogue)
        output = next(one for one in plan.outputs if one.name == change_name(name))
        selection = catalogue.selection(plan.variants, request.space.names)
        terms = output.terms or selection.change_terms(of.quantity)
        found[name] = {term.by: derivative_of(of, term.by, catalogue.position.name) for term in terms}
    return found

"""A study: one TOML file that says which mechanism, designs and quantities; read, checked, run."""

from __future__ import annotations

import contextlib
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from fastlink.catalogue import Catalogue
from fastlink.codegen.kernel import backend_of
from fastlink.cycle import Request, parse_request
from fastlink.errors import InputError
from fastlink.links import Links, links_from
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.request import (
    all_choices,
    alternatives_of,
    check_branches,
    check_extrema,
    check_keywords,
    check_positions,
    constants_of,
    given_angles,
)
from fastlink.space import DesignSpace
from fastlink.store import check_target
from fastlink.study_design import angles_of, check_values, missing_inputs, space_of
from fastlink.study_schema import Cycle, LinkModel, Problems, StudyFile, problems
from fastlink.sweep import sweep

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

__all__ = ["Study", "read_study", "run_study"]


@dataclass(frozen=True, eq=False)
class Study:
    """A study that was read and found right.

    Attributes
    ----------
    path : Path
        The file.
    text : str
        What it says.
    shape : StudyFile
        Its tables and keys.
    space : DesignSpace
        The designs.
    links : Links or None
        The model of the links.
    angles : int or array
        Number of input angles, or the angles in rad.
    sources : tuple of Path
        The files that it was read from: itself, and a table of designs.
    """

    path: Path
    text: str
    shape: StudyFile
    space: DesignSpace
    links: Links | None
    angles: int | NDArray[Any]
    sources: tuple[Path, ...]

    @property
    def options(self) -> dict[str, Any]:
        """What `fastlink.sweep` is told beside mechanism, designs and quantities."""
        cycle = self.shape.cycle
        return {
            "links": self.links,
            "input": cycle.input,
            "angles": self.angles,
            "branch": cycle.branch,
            "solver": cycle.solver,
            "extrema": cycle.extrema,
            "backend": self.shape.run.backend,
        }


def run_study(
    path: str | Path,
    to: str | Path | None = None,
    threads: int | None = None,
    overwrite: bool = False,
    progress: bool | None = None,
    verify: int | None = None,
) -> xr.Dataset:
    """Run a study file and write its map.

    Parameters
    ----------
    path : str or path
        The study, a TOML file.
    to : path, optional
        The HDF5 file to write; by default what the study says, else the study's name with ``.h5``, in the
        current folder.
    threads : int, optional
        All processors unless given.
    overwrite : bool, default False
        Replace an existing file, even if the study does not say so.
    progress : bool, optional
        Show a progress bar on standard error; by default only on a terminal.
    verify : int, optional
        How many designs are computed again with 50 digits (see `fastlink.sweep`); by default what the study says, else
        64.

    Returns
    -------
    xarray.Dataset
        Opened lazily from the file. The text of the study is in its attribute ``study``.

    Raises
    ------
    InputError
        One line for each problem: the file, the key, what was found, what is allowed.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> text = '''
    ... mechanism = "planar_4r"
    ... quantities = ["transmission_angle_min"]
    ... [design]
    ... a1 = 0.4
    ... a2 = {linspace = [1.0, 1.4, 5]}
    ... a3 = 0.8
    ... a4 = 1.0
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     study = pathlib.Path(folder, "study.toml")
    ...     _ = study.write_text(text)
    ...     with run_study(study, to=f"{folder}/maps.h5") as maps:
    ...         dict(maps.transmission_angle_min.sizes)
    {'a2': 5, 'branch': 2}
    """
    study = read_study(path)
    shape = study.shape
    place = Path(to or shape.output.file or f"{study.path.stem}.h5").expanduser()
    overwrite = overwrite or shape.output.overwrite
    key = "output" if to is not None else "output.file"
    found = Problems(study.path)
    with found.at(key):
        check_target(place, 0, overwrite)
        if any(place.exists() and place.samefile(source) for source in study.sources):
            raise InputError(f"{place}: the study is read from that file; choose another name")
    found.stop()
    title = {} if shape.title is None else {"title": shape.title}
    with found.at(""):
        return sweep(
            shape.mechanism,
            study.space,
            shape.quantities,
            **study.options,
            verify=shape.output.verify if verify is None else verify,
            to=place,
            overwrite=overwrite,
            threads=threads,
            progress=progress,
            attrs={**title, "study_file": study.path.name, "study": study.text},
        )
    raise found.error()


def read_study(path: str | Path) -> Study:
    """Read a study file and check everything that can be checked before running it.

    Raises
    ------
    InputError
        One line for each problem: the file, the key, what was found, what is allowed.
    """
    path = Path(path).expanduser()
    text = _text_of(path)
    found = Problems(path)
    try:
        raw = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"{path}: is no TOML: {error}") from None
    try:
        shape = StudyFile.model_validate(raw)
    except ValidationError as error:
        driven = None
        if isinstance(raw.get("mechanism"), str):
            with contextlib.suppress(InputError):
                driven = _catalogue(found, raw["mechanism"], _input_in(raw))
        for key, fault in problems(error, () if driven is None else (driven.position.name,)):
            found.add(key, fault)
        if driven is not None and isinstance(raw.get("cycle"), dict):
            _check_keys(found, raw["mechanism"], driven, raw["cycle"])
        raise found.error() from None
    catalogue = _catalogue(found, shape.mechanism, shape.cycle.input)
    by_name = shape.cycle.model_extra or {}
    _check_keys(found, shape.mechanism, catalogue, by_name)
    links = _links(found, shape.links)
    requests = _requests(found, catalogue, shape.quantities)
    with found.at("cycle.branch"):
        check_branches(catalogue, shape.cycle.branch)
    angles: int | NDArray[Any] = 0
    with found.at(f"cycle.{catalogue.position.name if catalogue.position.name in by_name else 'angles'}"):
        angles = angles_of(given_angles(catalogue, shape.cycle.angles, by_name))
        check_positions(catalogue, angles)
    with found.at("run.backend"):
        backend_of(shape.run.backend)
    with found.at("cycle.extrema"):
        check_extrema(shape.cycle.extrema, catalogue, angles)
    space = space_of(found, path, shape.design)
    alternatives: tuple[str, ...] = ()
    with found.at("links" if shape.cycle.solver in catalogue.solvers else "cycle.solver"):
        names = () if space is None else space.names
        alternatives = alternatives_of(catalogue, links, shape.cycle.solver, names)
    if space is not None:
        check_values(found, catalogue, shape.design, space, alternatives)
        given = {*space.names, *constants_of(catalogue, links, alternatives)}
        given |= set(all_choices(catalogue, given, alternatives))
        if not found.lines:
            for name, fault in missing_inputs(catalogue, requests, alternatives, given):
                of_links = links is not None and name in catalogue.alternative_inputs[links.model]
                found.add(f"{'links' if of_links else 'design'}.{name}", fault)
    found.stop()
    assert space is not None
    sources = (path, *([path.parent / shape.design.table] if shape.design.table else ()))
    return Study(path, text, shape, space, links, angles, sources)


def _text_of(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is no UTF-8 text ({error.reason} at byte {error.start})") from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        why = getattr(error, "strerror", None) or str(error)
        raise InputError(f"{path}: cannot be read ({why}); give the path of a study file") from None


def _catalogue(found: Problems, mechanism: str, input: str | None = None) -> Catalogue:
    """Return the mechanism; without it nothing else can be checked."""
    with found.at("mechanism"):
        find_catalogue(mechanism)
    found.stop()
    with found.at("cycle.input"):
        return find_catalogue(mechanism, input)
    raise found.error()


def _input_in(raw: Mapping[str, Any]) -> str | None:
    """Return the input that a study names, if it is a text."""
    cycle = raw.get("cycle")
    named = cycle.get("input") if isinstance(cycle, dict) else None
    return named if isinstance(named, str) else None


def _check_keys(found: Problems, mechanism: str, catalogue: Catalogue, cycle: Iterable[str]) -> None:
    """Note the keys of [cycle] that are neither options nor the name of the input."""
    for name in cycle:
        if name not in Cycle.model_fields:
            with found.at(f"cycle.{name}"):
                check_keywords(mechanism, catalogue, [name], Cycle.model_fields)


def _links(found: Problems, given: LinkModel | None) -> Links | None:
    if given is None:
        return None
    with found.at("links.model"):
        links_from(given.model, {})
        values: Mapping[str, float] = given.model_extra or {}
        for name, value in values.items():
            with found.at(f"links.{name}"):
                links_from(given.model, {name: value})
        if not found.lines:
            return links_from(given.model, values)
    return None


def _requests(found: Problems, catalogue: Catalogue, names: Sequence[str]) -> list[Request]:
    requests = []
    for k, name in enumerate(names):
        with found.at(f"quantities[{k}]"):
            if name in names[:k]:
                raise InputError(f"{name!r} is asked for twice; name it once")
            requests.append(parse_request(name, catalogue))
    return requests if "status" in names else [*requests, parse_request("status", catalogue)]

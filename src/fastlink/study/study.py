"""A study: one TOML file that says which mechanism, designs and quantities; read, checked, run."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from fastlink.engine.checks import check
from fastlink.engine.resolve import resolve
from fastlink.engine.sweep import sweep
from fastlink.errors import (
    InputError,
    Pair,
    Piece,
    Place,
    Problem,
    Problems,
    Samples,
    Setting,
    Wording,
    path_text,
)
from fastlink.io.partial_file import check_target
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.validate import check_keywords
from fastlink.space.design_space import DesignSpace
from fastlink.space.links import Links, links_from
from fastlink.space.samplers import grid
from fastlink.study.design import SAMPLES, space_of
from fastlink.study.schema import TABLES, Angles, Cycle, StudyFile, problems

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Study", "read_study", "run_study"]

#: What is called otherwise in a study than in `fastlink.sweep`.
PARAMETERS = {"to": "file"}


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
    sources : tuple of Path
        The files that it was read from: itself, and a table of designs.
    """

    path: Path
    text: str
    shape: StudyFile
    space: DesignSpace
    links: Links | None
    sources: tuple[Path, ...]

    @property
    def options(self) -> dict[str, Any]:
        """What `fastlink.sweep` is told beside mechanism, designs and quantities."""
        cycle = self.shape.cycle
        by_name = _values(next(iter((cycle.model_extra or {}).values()), None))
        return {
            "links": self.links,
            "input": cycle.input,
            "angles": _values(cycle.angles) if by_name is None else by_name,
            "branch": cycle.branch,
            "solver": cycle.solver,
            "extrema": cycle.extrema,
            "backend": self.shape.run.backend,
        }


def _values(given: int | Angles | None) -> Any:
    """Return the number of input positions, or the positions."""
    return given.array() if isinstance(given, Angles) else given


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
    given = {"to": to, "threads": threads, "verify": verify}
    place = Path(to or shape.output.file or f"{study.path.stem}.h5").expanduser()
    overwrite = overwrite or shape.output.overwrite
    title = {} if shape.title is None else {"title": shape.title}
    try:
        check_target(place, 0, overwrite)
        if any(place.exists() and place.samefile(source) for source in study.sources):
            what = f"{place}: the study is read from that file"
            raise InputError(what, where=("to",), remedy="choose another name")
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
    except InputError as error:
        if given.get(str(error.where[0]) if error.where else "") is not None:
            raise  # the caller's own, not the study's
        raise InputError.of(error.problems, _Keys(study.path, shape, study.space)) from None


def read_study(path: str | Path) -> Study:
    """Read a study file and check everything that can be checked before running it.

    Raises
    ------
    InputError
        One line for each problem: the file, the key, what was found, what is allowed.
    """
    path = Path(path).expanduser()
    text = _text_of(path)
    try:
        raw = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError.of([Problem(f"is no TOML: {error}")], _Keys(path)) from None
    try:
        shape = StudyFile.model_validate(raw)
    except ValidationError as error:
        raise InputError.of(_schema_problems(raw, error), _Keys(path)) from None
    found = Problems(_Keys(path, shape))
    links, space = None, None
    with found.at():
        links = None if shape.links is None else links_from(shape.links.model, shape.links.model_extra or {})
    with found.at():
        space = space_of(path, shape.design)
    sources = (path, *([path.parent / shape.design.table] if shape.design.table else ()))
    study = Study(path, text, shape, space or grid(), links, sources)
    if space is not None:
        found.wording = _Keys(path, shape, space)
    cycle = shape.cycle
    positions = {name: _values(given) for name, given in (cycle.model_extra or {}).items()}
    own = {"angles": _values(cycle.angles), "positions": positions, "options": Cycle.model_fields}
    with found.at():
        check(shape.mechanism, space, shape.quantities, **study.options | own)
    found.stop()
    with found.at():
        resolve(shape.mechanism, study.space, shape.quantities, **study.options)
    found.stop()
    return study


def _text_of(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is no UTF-8 text ({error.reason} at byte {error.start})") from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        why = getattr(error, "strerror", None) or str(error)
        raise InputError(f"{path}: cannot be read ({why}); give the path of a study file") from None


def _schema_problems(raw: Mapping[str, Any], error: ValidationError) -> list[Problem]:
    """Return what is wrong with the keys and types of a study, and with its mechanism, input and their names."""
    found, mechanism, cycle = Problems(), raw.get("mechanism"), raw.get("cycle")
    position: tuple[str, ...] = ()
    if isinstance(mechanism, str):
        cycle = cycle if isinstance(cycle, dict) else {}
        input = cycle.get("input")
        with found.at():
            driven = find_catalogue(mechanism, input if isinstance(input, str) else None)
            position = (driven.position.name,)
            names = [name for name in cycle if name not in Cycle.model_fields]
            check_keywords(mechanism, driven, names, Cycle.model_fields)
    return [*problems(error, position), *found.noted]


class _Keys(Wording):
    """How a study file is told of its problems: in its own keys and its own grammar.

    Parameters
    ----------
    path : Path
        The file.
    shape : StudyFile, optional
        What it says, as far as that was read.
    space : DesignSpace, optional
        Its designs.
    """

    def __init__(self, path: Path, shape: StudyFile | None = None, space: DesignSpace | None = None) -> None:
        self.path, self.shape, self.space = path, shape, space

    def line(self, problem: Problem) -> str:
        return f"{self.path}: {super().line(problem)}"

    def place(self, where: Place) -> str:
        return path_text(self._key(where))

    def _key(self, where: Place) -> Place:
        head, *rest = where or ("",)
        if head in ("sobol", "latin_hypercube", "table"):
            return ("design", *where)
        if head in ("grid", "design"):
            return ("design", *self._sample(rest), *rest)
        for table, model in TABLES.items():
            if PARAMETERS.get(str(head), head) in model.model_fields or (
                table == "cycle" and self.shape is not None and head in (self.shape.cycle.model_extra or {})
            ):
                return (table, PARAMETERS.get(str(head), head), *rest)
        return where

    def _sample(self, rest: Sequence[str | int]) -> Place:
        """Return the key of the sample or the table that gives an input, if one does."""
        if self.shape is None or self.space is None or not rest:
            return ()
        design, name = self.shape.design, rest[0]
        if name not in self.space.names or name in (design.model_extra or {}):
            return ()
        return tuple(kind for kind in (*SAMPLES, "table") if getattr(design, kind) is not None)

    def piece(self, piece: Piece) -> str | None:
        if isinstance(piece, Samples):
            return f"{{linspace = [{piece.first:g}, {piece.last:g}, {piece.count}]}}"
        if isinstance(piece, Pair):
            return f"[{piece.low}, {piece.high}]"
        if isinstance(piece, Setting):
            known = any(piece.name in model.model_fields for model in TABLES.values())
            return f"{piece.name} = {json.dumps(piece.value)}" if known else None
        return piece

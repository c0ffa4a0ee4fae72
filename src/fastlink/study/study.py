"""Read, check and run studies."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink.doors import door
from fastlink.engine.checks import check
from fastlink.engine.options import check_options
from fastlink.engine.resolve import resolve
from fastlink.engine.sweep import sweep
from fastlink.errors import (
    InputError,
    Problem,
    Problems,
)
from fastlink.io.partial_file import check_target
from fastlink.io.reader import is_hdf5
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.options import check_path
from fastlink.plan.positions import check_keywords
from fastlink.space.degrees import Degrees, angle_of, degrees_name
from fastlink.space.design_space import DesignSpace
from fastlink.space.links import Links
from fastlink.space.samplers import grid, latin_hypercube, sobol, table
from fastlink.study.schema import A_STUDY, KEYS, SAMPLES, read_tables
from fastlink.study.wording import StudyWording

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Study", "read_study", "run_study"]


@dataclass(frozen=True, eq=False)
class Study:
    """A study without problems, as `fastlink.sweep` takes it.

    Attributes
    ----------
    path : Path
        The file.
    text : str
        Its text.
    tables : dict
        Its tables and keys.
    space : DesignSpace
        The designs.
    options : dict
        The options of the sweep besides mechanism, designs and quantities.
    sources : tuple of Path
        The files that it was read from: itself, and a table of designs.
    """

    path: Path
    text: str
    tables: dict[str, Any]
    space: DesignSpace
    options: dict[str, Any]
    sources: tuple[Path, ...]

    @property
    def mechanism(self) -> str:
        """The name of the mechanism."""
        return str(self.tables["mechanism"])

    @property
    def quantities(self) -> list[str]:
        """The names of the quantities."""
        return list(self.tables["quantities"])

    @property
    def output(self) -> dict[str, Any]:
        """Its table [output]."""
        return dict(self.tables["output"])

    def target(self, to: str | Path | None = None) -> Path:
        """Return the file to write: a given one, else its own, else one of its name in the current folder."""
        return Path(to or self.output.get("file") or f"{self.path.stem}.h5").expanduser()


@door(hint=A_STUDY)
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
        The HDF5 file to write; by default that of the study, else the study's name with ``.h5``, in the
        current folder.
    threads : int, optional
        All processors unless given.
    overwrite : bool, default False
        Compute anew and replace an existing file, even if the study does not say so. Without it, an existing map of
        the same study, unchanged since, is opened as it is; nothing is computed.
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
    given = {"to": to, "threads": threads, "overwrite": overwrite, "progress": progress, "verify": verify}
    check_options(given)
    study = read_study(path)
    target = study.target(to)
    overwrite = overwrite or study.output.get("overwrite", False)
    title = {name: study.tables[name] for name in ("title",) if name in study.tables}
    try:
        # the sweep knows whether the file that exists is its map
        check_target(target, 0, True, study.sources)
        return sweep(
            study.mechanism,
            study.space,
            study.quantities,
            **study.options,
            verify=study.output.get("verify") if verify is None else verify,
            to=target,
            overwrite=overwrite,
            threads=threads,
            progress=progress,
            attrs={**title, "study_file": study.path.name, "study": study.text},
        )
    except InputError as error:
        if given.get(str(error.where[0]) if error.where else "") is not None:
            raise  # the caller's own, not the study's
        raise InputError.of(error.problems, StudyWording(study.path, study.tables, study.space)) from None


def read_study(path: str | Path) -> Study:
    """Read a study file and check everything that can be checked before running it.

    Raises
    ------
    InputError
        One line for each problem: the file, the key, what was found, what is allowed.
    """
    path = check_path(("study",), path, "study.toml")
    text = _text_of(path)
    tables = _tables_of(path, text)
    cycle, design = tables["cycle"], tables["design"]
    positions = {name: values for name, values in cycle.items() if name not in KEYS["cycle"]}
    options = {name: value for name, value in {**cycle, **tables["run"]}.items() if name not in positions}
    problems = Problems(StudyWording(path, tables))
    space = None
    if "links" in tables:
        with problems.at():
            values = dict(tables["links"])
            options["links"] = Links(values.pop("model"), values)
    with problems.at():
        space = _space_of(path, design)
        problems.wording = StudyWording(path, tables, space)
    examine: Callable[..., object] = check if problems.noted else resolve
    with problems.at():
        named = {"positions": positions, "options": KEYS["cycle"]}
        examine(tables["mechanism"], space, tables["quantities"], **named, **options)
    problems.stop()
    assert space is not None
    for name, values in positions.items():
        options["angles"] = Degrees(values) if angle_of(name) else values
    sources = (path, *([path.parent / design["table"]] if "table" in design else ()))
    return Study(path, text, tables, space, options, sources)


def _text_of(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        if is_hdf5(path):
            raise InputError(
                f"{path}: is a map, not a study", remedy=f"`fastlink info {path}` shows it"
            ) from None
        raise InputError(f"{path}: is not UTF-8 text ({error.reason} at byte {error.start})") from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        why = getattr(error, "strerror", None) or str(error)
        raise InputError(f"{path}: cannot be read ({why})", remedy=A_STUDY) from None


def _tables_of(path: Path, text: str) -> dict[str, Any]:
    """Return the tables of a study, or refuse its keys, types and names."""
    try:
        raw = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError.of([Problem(f"is not TOML: {error}")], StudyWording(path)) from None
    mechanism, cycle = raw.get("mechanism"), raw.get("cycle")
    cycle = cycle if isinstance(cycle, dict) else {}
    input, position, names = cycle.get("input"), "", Problems()
    if isinstance(mechanism, str):
        with names.at():
            driven = find_catalogue(mechanism, input if isinstance(input, str) else None)
            position = driven.position.name
            unknown = [name for name in cycle if name not in KEYS["cycle"]]
            check_keywords(mechanism, driven, unknown, KEYS["cycle"])
    try:
        return read_tables(raw, (position, degrees_name(position)))
    except InputError as error:
        problems = [*error.problems, *names.noted]
        raise InputError.of(problems, StudyWording(path, {"cycle": cycle})) from None


def _space_of(path: Path, design: Mapping[str, Any]) -> DesignSpace:
    """Return the design space of a study, or refuse it with all its problems."""
    problems = Problems()
    entries = {name: value for name, value in design.items() if name not in SAMPLES}
    constants = {name: value for name, value in entries.items() if isinstance(value, float)}
    swept = [name for name in entries if name not in constants]
    kinds = [name for name in SAMPLES if name in design]
    if len(kinds) + bool(swept) > 1:
        both = [*kinds, *([f"axes ({', '.join(swept)})"] if swept else [])]
        problems.add(f"has {' and '.join(both)}", ("design",), "write one of them, beside constants")
    if not design:
        problems.add("is empty", ("design",), "write a number or an axis for each input")
    with problems.at():
        space = grid(**entries)
    if len(kinds) == 1:
        (kind,) = kinds
        with problems.at("design", kind):
            if kind == "table":
                space = table(path.parent / design["table"])
            else:
                space = (sobol if kind == "sobol" else latin_hypercube)(**design[kind])
            for name in constants:
                if name in space.names:
                    what = f"gives {name}, which stands in [design] too"
                    problems.add(what, ("design", kind), "write it once")
    problems.stop()
    return space.with_constants(constants)

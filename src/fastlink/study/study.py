"""Read, check and run studies."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink._text import writable
from fastlink.doors import door
from fastlink.engine.options import check_options
from fastlink.engine.sweep import sweep
from fastlink.errors import InputError, Problems, nearest
from fastlink.io.place import existing_file, exists_error
from fastlink.io.reader import open_map
from fastlink.io.writing.target import check_target
from fastlink.mechanisms import NAMES, is_extension, name_of
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.options import check_path, check_switch
from fastlink.searching.search import search
from fastlink.space.dataset import CURVES
from fastlink.space.degrees import Degrees, angle_of, degrees_name
from fastlink.space.design_space import DesignSpace
from fastlink.study.homes import at_home
from fastlink.study.own import KEY, TRUST, load_extension
from fastlink.study.request import Request
from fastlink.study.schema import A_STUDY, read_tables
from fastlink.study.search import asked_for
from fastlink.study.text import contents_of, text_of
from fastlink.study.wording import StudyWording

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client

    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.engine.extending import Extension
    from fastlink.io.parts import Part

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
        The files that it was read from: itself, a table of designs, and Python code that declares quantities.
    mechanism : str or Extension
        The mechanism: its name, or one with the quantities that a file beside the study declares.
    """

    path: Path
    text: str
    tables: dict[str, Any]
    space: DesignSpace
    options: dict[str, Any]
    sources: tuple[Path, ...]
    mechanism: str | Extension

    @property
    def quantities(self) -> list[str]:
        """The names of the quantities."""
        return list(self.tables["quantities"])

    @property
    def search(self) -> dict[str, Any] | None:
        """Objectives and conditions, as `fastlink.search` takes them; None of a study whose map is written."""
        return asked_for(self.tables["search"]) if "search" in self.tables else None

    @property
    def output(self) -> dict[str, Any]:
        """Its table [output]."""
        return dict(self.tables["output"])

    def target(self, to: str | Path | None = None, part: Part | None = None) -> Path:
        """Return the file to write: a given one, else its own, else one of its name in the current folder.

        Unless given, the file of a part has it in its name.
        """
        target = Path(os.path.expanduser(to or self.output.get("file") or f"{self.path.stem}.h5"))
        return target if to or part is None else part.path(target)


@door(hint=A_STUDY)
def run_study(
    path: str | Path,
    to: str | Path | None = None,
    threads: int | None = None,
    overwrite: bool = False,
    progress: bool | None = None,
    verify: int | None = None,
    *,
    restart: bool = False,
    part: tuple[int, int] | str | None = None,
    layout: str | None = None,
    client: Client | None = None,
    trust_code: bool = False,
) -> xr.Dataset:
    """Run a study file and write its map; of a study with a table [search] that of the designs that are found.

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
        Compute anew and replace an existing file, whatever it holds. A study that says ``overwrite = true`` has a map
        replaced, and no other file. Without either, an existing map of the same study, unchanged since, is opened as it
        is; nothing is computed.
    progress : bool, optional
        Show a progress bar on standard error; by default only on a terminal.
    verify : int, optional
        How many designs are computed again with 50 digits (see `fastlink.sweep`); by default what the study says, else
        64.
    restart : bool, default False
        Throw away what an interrupted run has left in ``FILE.part``. Without it, the same study goes on there, and
        another one is refused.
    part : (k, n) or "k/n", optional
        Run the k-th of n parts of the designs (see `fastlink.sweep`), by default into the file of the study with the
        part in its name, such as ``maps.part-03-of-16.h5``.
    layout : {"curves", "maps"}, optional
        How the map is to be read (see `fastlink.sweep`); by default what the study says, else ``"curves"``.
    client : distributed.Client, optional
        Evaluate the designs on the workers of a dask.distributed cluster (see `fastlink.sweep`).
    trust_code : bool, default False
        Run the Python file that the study names as ``quantities_file``, which declares quantities of its own (see
        docs/own_quantities.md). A study alone is data and runs nothing.

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
    given: dict[str, Any] = {"to": to, "threads": threads, "overwrite": overwrite, "verify": verify}
    given |= {"progress": progress, "part": part, "layout": layout, "client": client}
    checked = check_options(given | {"restart": restart, "layout": CURVES if layout is None else layout})
    study = read_study(path, trust_code)
    target = study.target(to, checked["part"])
    title = {name: study.tables[name] for name in ("title",) if name in study.tables}
    try:
        # the sweep knows whether the file that exists is its map
        check_target(target, 0, True, study.sources)
        if not overwrite and study.output.get("overwrite", False):
            _refuse_other_file(target)
            overwrite = True
        attrs = {**title, "study_file": writable(study.path.name), "study": study.text}
        verify = study.output.get("verify") if verify is None else verify
        if study.search is not None:
            _refuse_of_maps(part=part, layout=layout, client=client)
            return search(
                study.mechanism,
                study.space,
                study.quantities,
                **study.search,
                **{"branch": 1, **study.options},
                verify=verify,
                to=target,
                overwrite=overwrite,
                restart=restart,
                threads=threads,
                progress=progress,
                attrs=attrs,
            )
        return sweep(
            study.mechanism,
            study.space,
            study.quantities,
            **study.options,
            verify=verify,
            to=target,
            overwrite=overwrite,
            restart=restart,
            part=part,
            layout=layout or study.output.get("layout") or CURVES,
            threads=threads,
            client=client,
            progress=progress,
            attrs=attrs,
        )
    except InputError as error:
        if given.get(str(error.where[0]) if error.where else "") is not None:
            raise  # the caller's own, not the study's
        raise InputError.of(error.problems, StudyWording(study.path, study.tables, study.space)) from None


def _refuse_other_file(target: Path) -> None:
    """Refuse a file that is no map: a study, which may be a stranger's, does not replace it by its own word."""
    if existing_file(target) is not None:
        try:
            open_map(target).close()
        except InputError:
            raise exists_error(target, "and is no map, which alone a study replaces") from None


def _refuse_of_maps(**options: Any) -> None:
    """Refuse options that belong to a map of all designs."""
    for name, value in options.items():
        if value is not None:
            remedy = "leave it out: a search keeps the best of all designs alone, in one process"
            raise InputError("is for maps, not for a search", where=(name,), remedy=remedy)


def read_study(path: str | Path, trust_code: bool = False) -> Study:
    """Read a study file and check everything that can be checked before running it.

    The Python file that it may name is run only if that code is trusted.

    Raises
    ------
    InputError
        One line for each problem: the file, the key, what was found, what is allowed.
    """
    path = check_path(("study",), path, "study.toml")
    trusted = check_switch((TRUST,), trust_code)
    text = text_of(path)
    contents, problems = contents_of(path, text), Problems(StudyWording(path))
    mechanism = _mechanism(path, contents, problems, trusted)
    driven = _driven(mechanism, contents, problems)
    raw, misplaced = at_home(contents, driven)
    name = "" if driven is None else driven.position.name
    tables, found = read_tables(raw, (name, degrees_name(name)))
    problems.noted += [*misplaced, *found]
    problems.wording = StudyWording(path, raw)
    if driven is None or "mechanism" not in tables:
        problems.stop()
    assert driven is not None
    request = Request(path, raw, tables, driven, problems, mechanism)
    request.check()
    problems.stop()
    assert request.space is not None
    for name, values in request.positions.items():
        request.options["angles"] = Degrees(values) if angle_of(name) else values
    design = tables["design"]
    others = [design["table"]] if "table" in design else []
    others += [tables[KEY]] if KEY in tables else []
    sources = (path, *(path.parent / other for other in others))
    return Study(path, text, tables, request.space, request.options, sources, mechanism)


def _mechanism(path: Path, contents: Mapping[str, Any], problems: Problems, trusted: bool) -> Any:
    """Return the mechanism of a study: its name, or with the quantities that a file declares."""
    mechanism, own = contents.get("mechanism"), contents.get(KEY)
    if not isinstance(own, str) or not own or mechanism not in NAMES:
        return mechanism
    with problems.at():
        return load_extension(path, own, mechanism, trusted)
    problems.stop()  # what depends on its quantities is not worth telling
    return mechanism


def _driven(mechanism: Any, contents: Mapping[str, Any], problems: Problems) -> Catalogue | None:
    """Return the catalogue of a study; a misspelt mechanism is noted and taken for the nearest."""
    cycle = contents.get("cycle")
    input = cycle.get("input") if isinstance(cycle, dict) else None
    if not isinstance(mechanism, str) and not is_extension(mechanism):
        return None
    with problems.at():
        return find_catalogue(mechanism, input if isinstance(input, str) else None)
    name = name_of(mechanism)
    meant = mechanism if name in NAMES else nearest(name, NAMES)
    return None if meant is None else find_catalogue(meant, None)

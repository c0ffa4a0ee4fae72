"""The request of a study, from its tables: checked as far as they are without problems."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink.engine.checks import check
from fastlink.engine.resolve import resolve
from fastlink.engine.tolerances import given_tolerances
from fastlink.errors import InputError, Problems
from fastlink.plan.positions import check_keywords
from fastlink.space.degrees import degrees_name
from fastlink.space.links import MODELS, Links
from fastlink.space.samplers import grid, latin_hypercube, sobol, table
from fastlink.study.schema import KEEP, KEYS, REQUIRED, SAMPLES, TOLERANCES
from fastlink.study.search import request_of_search, searched_space
from fastlink.study.wording import StudyWording
from fastlink.symbolic.changes import toleranced

if TYPE_CHECKING:
    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.errors import Problem
    from fastlink.space.design_space import DesignSpace

__all__ = ["Request"]


class Request:
    """The request of a study.

    Parameters
    ----------
    path : Path
        The file.
    raw : mapping
        Its contents.
    tables : mapping
        What was read of them without problems.
    catalogue : Catalogue
        The mechanism.
    problems : Problems
        Those that were found; `check` adds its own.
    mechanism : str or Extension
        Its name, or the mechanism with quantities that a file declares.

    Attributes
    ----------
    space : DesignSpace or None
        The designs, as soon as they are read.
    options : dict
        The options of a sweep.
    positions : dict
        Input positions by the name of the input.
    """

    def __init__(
        self,
        path: Path,
        raw: Mapping[str, Any],
        tables: Mapping[str, Any],
        catalogue: Catalogue,
        problems: Problems,
        mechanism: Any,
    ) -> None:
        self.path, self.tables, self.catalogue, self.problems = path, tables, catalogue, problems
        self.mechanism, cycle = mechanism, tables["cycle"]
        self.positions = {name: values for name, values in cycle.items() if name not in KEYS["cycle"]}
        own = {**cycle, **tables["run"]}
        self.options = {name: value for name, value in own.items() if name not in self.positions}
        self.raw = raw
        self.space: DesignSpace | None = None
        #: Tables with problems: what follows from their absence is not a problem of its own.
        self.broken = {str(one.where[0]) for one in problems.noted if one.where} - {"study"}

    def check(self) -> None:
        """Read links and designs, and check all parts together."""
        if any(one.where in (("mechanism",), ("input",)) for one in self.problems.noted):
            self.options.pop("input", None)
        self._check_names_of_cycle()
        if "links" in self.tables and "links" not in self.broken:
            known = len(self.problems.noted)
            with self.problems.at():
                values = dict(self.tables["links"])
                self.options["links"] = Links(values.pop("model"), values)
            self.broken |= {"links"} if len(self.problems.noted) > known else set()
        if "design" in self.tables:
            with self.problems.at():
                self.space = self._space()
                self.problems.wording = StudyWording(self.path, self.raw, self.space)
        names = self.tables.get("quantities", REQUIRED["quantities"])
        found = Problems()
        of_driven = ("input",) in {one.where for one in self.problems.noted}
        with found.at():
            self._examine(check if self.problems.noted else resolve, names)
        if of_driven:  # whose inputs are unknown
            found.noted = [one for one in found.noted if one.where[:1] != ("design",)]
        self._add(found.noted)
        self._check_search(names)
        if self.problems.noted and not of_driven:
            self._add_missing(names, found.noted)

    def _examine(self, function: Any, names: list[str]) -> None:
        named = {"positions": self.positions, "options": KEYS["cycle"]}
        mechanism = self.mechanism
        if ("mechanism",) in [one.where for one in self.problems.noted]:
            mechanism = self.catalogue.name  # the nearest
        function(mechanism, self.space, names, **named, **self.options)

    def _check_search(self, names: list[str]) -> None:
        """Check the table [search], once all else is known to be right."""
        others = any(one.where[:1] != ("search",) for one in self.problems.noted)
        if others or self.space is None or "search" not in self.tables:
            return
        named = {"positions": self.positions, "options": KEYS["cycle"]}
        of_run = {name: value for name, value in self.options.items() if name not in KEYS["output"]}
        with self.problems.at("search"):
            request_of_search(self.mechanism, self.space, names, self.tables["search"], **named, **of_run)

    def _check_names_of_cycle(self) -> None:
        """Refuse unknown keys of [cycle] whose values were refused already."""
        cycle = self.raw.get("cycle")
        given = list(cycle) if isinstance(cycle, dict) else []
        lost = [name for name in given if name not in (*self.tables["cycle"], *KEYS["cycle"])]
        with self.problems.at():
            check_keywords(self.catalogue.name, self.catalogue, lost, KEYS["cycle"])

    def _add(self, found: list[Problem]) -> None:
        """Add problems, but those that only follow from others, with the numbers that names have in the file."""
        listed = self.raw.get("quantities")
        numbers = (
            [k for k, name in enumerate(listed) if isinstance(name, str)] if isinstance(listed, list) else []
        )
        for one in found:
            head, *rest = one.where or ("",)
            position = self.catalogue.position.name
            if head in ("angles", position, degrees_name(position)) and "cycle" in self.broken:
                continue
            if head == "quantities" and rest and isinstance(rest[0], int) and rest[0] < len(numbers):
                one = replace(one, where=(head, numbers[rest[0]]))
            self.problems.noted.append(one)

    def _add_missing(self, names: list[str], found: list[Problem]) -> None:
        """Add the inputs that are missing for the quantities without problems, if the designs have none."""
        if self.space is None or self.broken & {"design", "links"}:
            return
        if any(one.where[:1] != ("quantities",) or len(one.where) != 2 for one in found):
            return
        wrong = [one.where[1] for one in found]
        try:
            self._examine(resolve, [name for k, name in enumerate(names) if k not in wrong] or ["status"])
        except InputError as error:
            self._add([one for one in error.problems if one.where[:1] in (("design",), ("links",))])

    def _space(self) -> DesignSpace:
        """Return the design space, or refuse it with all its problems."""
        design, path, problems = self.tables["design"], self.path, Problems()
        if "links" in self.broken:  # whose inputs are unknown without their model
            of_links = {name for model in MODELS for name in self.catalogue.variant_inputs.get(model, {})}
            design = {name: value for name, value in design.items() if name not in of_links}
        entries = {name: value for name, value in design.items() if name not in (*SAMPLES, KEEP)}
        constants = {name: value for name, value in entries.items() if isinstance(value, float)}
        swept = [name for name in entries if name not in constants]
        kinds, space = [name for name in SAMPLES if name in design], None
        if len(kinds) + bool(swept) > 1:
            both = [*kinds, *([f"axes ({', '.join(swept)})"] if swept else [])]
            problems.add(f"has {' and '.join(both)}", ("design",), "write one of them, beside constants")
        if KEEP in design and "table" not in design:
            problems.add("names columns of a table", ("design", KEEP), "leave it out, or write table = ...")
        if not design and not self.broken & {"design", "links"}:
            problems.add("is empty", ("design",), "write a number or an axis for each input")
        with problems.at():
            space = grid(**entries)
        if len(kinds) == 1:
            (kind,) = kinds
            with problems.at("design", kind):
                if kind == "table":
                    space = table(path.parent / design["table"], keep=design.get(KEEP, ()))
                else:
                    space = (sobol if kind == "sobol" else latin_hypercube)(**design[kind])
                for name in constants:
                    if name in space.names:
                        what = f"gives {name}, which stands in [design] too"
                        problems.add(what, ("design", kind), "write it once")
        given = self._tolerances({*design, *(() if space is None else space.names)}, problems)
        problems.stop()
        assert space is not None
        return searched_space(space.with_constants(constants | given), self.tables.get("search", {}))

    def _tolerances(self, in_design: set[str], problems: Problems) -> dict[str, float]:
        """Return the table of tolerances by the names that they have in a design, where they may stand too."""
        given = given_tolerances(self.catalogue, self.tables.get(TOLERANCES, {}), TOLERANCES, problems)
        for name in in_design & given.keys():
            of = (TOLERANCES, toleranced(name.removesuffix("_deg")))
            problems.add(f"is given, and so is {name} in [design]", of, "write it once")
        return given

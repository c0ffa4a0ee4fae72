"""Keys that stand in the wrong table of a study: named with their table, and read there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fastlink.errors import Problem
from fastlink.space.degrees import degrees_name
from fastlink.space.links import MODELS
from fastlink.study.schema import KEEP, KEYS, SAMPLES, StudyFile

if TYPE_CHECKING:
    from fastlink.catalogue.catalogue import Catalogue

__all__ = ["at_home"]

#: The tables of a study.
PLACES = ("design", "links", *KEYS)
#: Keys at the top of a study, besides its tables.
TOP = [name for name in StudyFile.model_fields if name not in PLACES]
WRITE_ABOVE = "write it above the first [table]: what follows a head such as [design] belongs to that table"


def at_home(raw: Mapping[str, Any], catalogue: Catalogue | None) -> tuple[dict[str, Any], list[Problem]]:
    """Return a study with each key in its table, and a problem for each one that was in another.

    Parameters
    ----------
    raw : mapping
        The contents of the file.
    catalogue : Catalogue or None
        The mechanism, whose inputs belong to [design] and [cycle].
    """
    homes: dict[str, tuple[str, ...]] = {
        "model": ("links",),
        **dict.fromkeys((*SAMPLES, KEEP), ("design",)),
        **dict.fromkeys(TOP, ("",)),
    }
    homes |= {key: (table,) for table, keys in KEYS.items() for key in keys}
    if catalogue is not None:
        of_links = {name for model in MODELS for name in catalogue.variant_inputs.get(model, {})}
        homes |= dict.fromkeys(catalogue.all_inputs, ("design",))
        homes |= dict.fromkeys(of_links, ("links", "design"))
        position = catalogue.position.name
        homes |= dict.fromkeys((position, degrees_name(position)), ("cycle",))
    tables = {name: dict(table) for name, table in raw.items() if isinstance(table, dict) and name in PLACES}
    tables[""] = {name: value for name, value in raw.items() if name not in tables}
    problems = []
    for place, table in list(tables.items()):
        for key in list(table):
            home = homes.get(key, (place,))
            if place in home or (place == "" and isinstance(table[key], dict) and key in PLACES):
                continue
            value = table.pop(key)
            if home[0] != "links" or "links" in tables or key == "model":  # without a model they say nothing
                tables.setdefault(home[0], {}).setdefault(key, value)
            problems.append(_problem(key, place, home[0]))
    top = tables.pop("")
    return {**top, **tables}, problems


def _problem(key: str, place: str, home: str) -> Problem:
    what = f"stands under [{place}]" if place else "stands outside of every table"
    remedy = f"write it under [{home}]" if home else WRITE_ABOVE
    return Problem(f"{key} {what}", ("study", key), remedy)

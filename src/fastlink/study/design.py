"""The design space of a study."""

from __future__ import annotations

from pathlib import Path

from fastlink.errors import Problems
from fastlink.space.design_space import DesignSpace
from fastlink.space.samplers import grid, latin_hypercube, sobol, table
from fastlink.study.schema import Axis, Design

SAMPLES = {"sobol": sobol, "latin_hypercube": latin_hypercube}


def space_of(path: Path, design: Design) -> DesignSpace:
    """Return the design space of a study.

    Raises
    ------
    InputError
        With all that is wrong with it.
    """
    problems = Problems()
    entries = {
        name: entry.array() if isinstance(entry, Axis) else entry
        for name, entry in (design.model_extra or {}).items()
    }
    constants = {name: value for name, value in entries.items() if isinstance(value, float)}
    swept = [name for name in entries if name not in constants]
    kinds = [name for name in (*SAMPLES, "table") if getattr(design, name) is not None]
    if len(kinds) + bool(swept) > 1:
        both = [*kinds, *([f"axes ({', '.join(swept)})"] if swept else [])]
        problems.add(f"has {' and '.join(both)}", ("design",), "write one of them, beside constants")
    if not (kinds or entries):
        problems.add("is empty", ("design",), "write a number or an axis for each input")
    with problems.at():
        space = grid(**entries)
    if len(kinds) == 1:
        with problems.at("design", *kinds):
            space = _sampled(path, design, *kinds)
            for name in constants:
                if name in space.names:
                    what = f"gives {name}, which stands in [design] too"
                    problems.add(what, ("design", *kinds), "write it once")
    problems.stop()
    return space.with_constants(constants)


def _sampled(path: Path, design: Design, kind: str) -> DesignSpace:
    if kind == "table":
        return table(path.parent / str(design.table))
    sample = getattr(design, kind)
    return SAMPLES[kind](sample.n, seed=sample.seed, **sample.model_extra)

"""Draw the cases of a seed, judge them, and count what became of them."""

import array
import os
import random
from collections import Counter
from decimal import Decimal
from fractions import Fraction
from functools import cache
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

import fastlink as fl
from tests.hostile import doings
from tests.hostile.doors import DOORS
from tests.hostile.judge import attempt, judged
from tests.hostile.texts import ROOT, SMALL, command_lines, studies, tables
from tests.hostile.values import EITHER, REFUSED, TAKEN
from tests.support.sweeps import sweep_4r, sweep_both


class Case(NamedTuple):
    """One call: its door, what may come of it, its text, that of the same call with plain values, and an argument."""

    door: str
    verdict: str
    text: str
    plain: str
    source: str = ""


def case_of(door, chosen):
    """Return the case with some values at a door."""
    verdicts = {value.verdict for value in chosen.values()}
    verdict = TAKEN if verdicts == {TAKEN} and len(chosen) == 1 else EITHER
    if REFUSED in verdicts or not door.opens:
        verdict = REFUSED
    text = door.called({name: value.text for name, value in chosen.items()})
    made = [f"({value.text})" for name, value in chosen.items() if name != "more"]
    plain = door.called({name: value.plain for name, value in chosen.items()})
    return Case(door.name, verdict, text, plain, f"[{', '.join(made)}]")


@cache
def singles():
    """Return a case for each value of each argument of each door."""
    return tuple(
        case_of(door, {name: value}) for door in DOORS for name in door.slots for value in door.values(name)
    )


def argument_cases(seed, count):
    """Yield calls with a hostile value; a fifth of them with two."""
    rng = random.Random(seed)
    yield from rng.sample(singles(), count - count // 5)
    wide = [door for door in DOORS if len(door.slots) > 1]
    for _ in range(count // 5):
        door = rng.choice(wide)
        chosen = {name: rng.choice(door.values(name) or [None]) for name in rng.sample(list(door.slots), 2)}
        (low, high), (start, stop) = (door.slots[name] for name in chosen)
        if None not in chosen.values() and (high <= start or stop <= low):
            yield case_of(door, chosen)  # type: ignore[arg-type]


def table_cases(seed, count):
    """Yield calls with tables."""
    for door, verdict, source, plain in tables(seed, count):
        yield Case("table", verdict, door.replace("SOURCE", source), door.replace("SOURCE", plain), source)


def study_cases(seed, count):
    """Yield calls with studies."""
    for text in studies(seed, count):
        yield Case(text.partition("(")[0], EITHER, text, text)


def line_cases(seed, count):
    """Yield command lines."""
    for words in command_lines(seed, count):
        yield Case("command line", EITHER, f"to_end(*{words!r})", f"to_end(*{words!r})")


def namespace():
    """Return what the texts of cases are made of; its files are written into the current folder."""
    Path("folder").mkdir(exist_ok=True)
    Path("study.toml").write_text(SMALL.replace("a3 = {values = [0.8, 0.7]}", "a3 = 0.8"))
    for table in ROOT.glob("data/studies/*.csv"):
        Path(table.name).write_bytes(table.read_bytes())
    if not os.path.lexists("loop"):
        os.symlink("loop", "loop")
    named = {name: one for name, one in vars(doings).items() if name[0] != "_"}
    space = fl.grid(a1=0.4, a2=[1.1, 1.2, 1.3], a3=0.8, a4=1.0, omega1=25.0)
    bars = fl.round_bar(density=7750.0, radius=0.01)
    options = {"angles": 8, "threads": 1}
    to_file = options | {"overwrite": True, "verify": 0}
    sweep_4r(space, ["omega4_max"], to="maps.h5", **to_file).close()
    sweep_4r(space, ["omega4_max"], to="part.h5", part=(1, 1), **to_file).close()
    focal = fl.grid(a=5.0, b=5.0, c=2.0, d=4.0, rho=1.0, completion=1)
    rates = [f"{name}_{end}" for name in ("shaking_force", "omega4") for end in ("max", "min")]
    rates += [f"theta1_at_{name}" for name in rates]
    linkages = fl.grid(a=1.0, b=[1.0, 7.0], g=[4.0, 3.0], h=1.0)
    of_linkages = ["linkage_type", "T1", "T2", "T3", "T4", "T5"]
    return {
        **named,
        **dict(np=np, pd=pd, xr=xr, fl=fl, array=array.array, Decimal=Decimal, Fraction=Fraction, Path=Path),
        "SPACE": space,
        "BARS": bars,
        "MAPS": sweep_4r(space, ["omega4_max"], **options),
        "TORQUE": fl.sweep("planar_4r", space, ["T41_fluctuation"], links=bars, branch=1, **options),
        "RATES": fl.sweep("planar_4r", space, rates, links=bars, branch=1, threads=1),
        "LINKAGES": sweep_both("minkowski_4r", linkages, of_linkages, threads=1),
        "RAYS": fl.focal.involution(5.0, 5.0, 2.0, 4.0, 1.369, branch=2, x=2.0, y=0.4495),
        "PATH": sweep_both("focal", focal, ["T_x", "T_y"], phi=8),
        "SPEED": fl.function(
            "planar_4r", ["a2", "a3"], ["omega4_max"], a1=0.4, a4=1.0, omega1=25.0, angles=8
        ),
        "COGNATE": fl.planar.cognates(a1=0.5, a2=1.0, a3=0.75, a4=2.0, P_u=0.0, P_v=2.0)[1],
    }


#: Each part of the default run, and its number of cases.
PARTS = {
    "arguments": (argument_cases, 400),
    "tables": (table_cases, 120),
    "studies": (study_cases, 60),
    "command lines": (line_cases, 30),
}


def judge_all(cases, names):
    """Return how often each door refused, took and failed, and a line for each failure."""
    counts = Counter()
    failures = []
    for case in cases:
        if case.source and attempt(case.source, names)[1] is not None:
            continue  # pandas or xarray cannot make the argument at all
        verdict, why = judged(case.verdict, case.text, case.plain, names)
        counts[case.door, verdict] += 1
        if verdict == "failed":
            failures.append(f"{case.text[:3000]}\n    {why}")
    return counts, failures


def table_of(counts):
    """Return counts as a table."""
    verdicts = ("refused", "taken", "failed")
    lines = [f"{'door':32}" + "".join(f"{verdict:>9}" for verdict in verdicts)]
    for door in dict.fromkeys(door for door, _ in sorted(counts)):
        lines.append(f"{door:32}" + "".join(f"{counts[door, verdict]:9}" for verdict in verdicts))
    return "\n".join(lines)


def draw(part, seed, times=1):
    """Yield the cases of a part, some times as many as in the default run."""
    cases, count = PARTS[part]
    return islice(cases(seed, times * count), times * count)

"""Draw the cases of a seed, judge them, and count what became of them."""

from __future__ import annotations

import array
import os
import traceback
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

import fastlink as fl
from tests.hostile import doings, objects
from tests.hostile.checks import CHECKS
from tests.hostile.doors import DOORS, Door, Slot
from tests.hostile.judge import Outcome, attempt, judged
from tests.hostile.lines import command_lines
from tests.hostile.studies import ROOT, studies
from tests.hostile.tables import tables
from tests.hostile.values import EITHER, REFUSED, ROLES, TAKEN, Value

#: What the tables of linkages of the Minkowskian plane are made of.
SUMS = ("T1", "T2", "T3", "T4", "T5")
DOOR_OF = {"read": "study", "explained": "explain", "ran": "run_study", "commanded": "fastlink run"}
STUDY = """
mechanism = "planar_4r"
quantities = ["omega4_max", "theta4"]
[design]
a1 = 0.4
a2 = {linspace = [1.0, 1.4, 3]}
a3 = 0.8
a4 = 1.0
omega1 = 25.0
[cycle]
theta1 = 8
[output]
verify = 0
"""


def constructible(case: Case, names: dict[str, Any]) -> bool:
    """Tell whether the argument of a call can be made at all, by pandas and xarray."""
    return not case.source or attempt(compile(case.source, "<source>", "eval"), names)[1] is None


def table_cases(seed: int, count: int) -> Iterator[Case]:
    """Yield the calls with tables of a seed."""
    for number, (door, kind, verdict, source, plain) in enumerate(tables(seed, count)):
        text = door.replace("SOURCE", source)
        yield Case(number, "table", kind, verdict, text, door.replace("SOURCE", plain), source=source)


def study_cases(seed: int, count: int) -> Iterator[Case]:
    """Yield the calls with studies of a seed."""
    for number, (door, kind, source) in enumerate(studies(seed, count)):
        text = door.replace("SOURCE", source)
        yield Case(number, DOOR_OF[door.partition("(")[0]], kind, EITHER, text, text)


def line_cases(seed: int, count: int) -> Iterator[Case]:
    """Yield the command lines of a seed."""
    for number, (kind, words) in enumerate(command_lines(seed, count)):
        text = f"to_end(*{words!r})"
        yield Case(number, "command line", kind, EITHER, text, text)


def namespace() -> dict[str, Any]:
    """Return what the texts of cases are made of; its files are written into the current folder."""
    Path("folder").mkdir(exist_ok=True)
    Path("study.toml").write_text(STUDY)
    for table in ROOT.glob("data/studies/*.csv"):
        Path(table.name).write_bytes(table.read_bytes())
    if not os.path.lexists("loop"):
        os.symlink("loop", "loop")
    named = {
        name: value for module in (objects, doings) for name, value in vars(module).items() if name[0] != "_"
    }
    space = fl.grid(a1=0.4, a2=[1.1, 1.2, 1.3], a3=0.8, a4=1.0, omega1=25.0)
    bars = fl.round_bar(density=7750.0, radius=0.01)
    options: dict[str, Any] = {"angles": 8, "threads": 1}
    fl.sweep("planar_4r", space, ["omega4_max"], to="maps.h5", overwrite=True, verify=0, **options).close()
    of_part = options | {"part": (1, 1), "to": "part.h5", "overwrite": True, "verify": 0}
    fl.sweep("planar_4r", space, ["omega4_max"], **of_part).close()
    focal = fl.grid(a=5.0, b=5.0, c=2.0, d=4.0, rho=1.0, completion=1)
    design = dict(a1=0.5, a2=1.0, a3=0.75, a4=2.0, P_u=0.0, P_v=2.0)
    figures = dict.fromkeys(
        ("error_max", "error_99", "error_median", "ns_per_design", "missed", "values", "pareto"), 1.0
    )
    measured = xr.Dataset(
        {name: (("way", "quantity"), [[value]]) for name, value in figures.items()},
        {"way": ["w"], "quantity": ["q"]},
    )
    rates = [f"{name}_{end}" for name in ("shaking_force", "omega4") for end in ("max", "min")]
    rates += [f"theta1_at_{name}" for name in rates]
    return {
        **named,
        **dict(np=np, pd=pd, xr=xr, fl=fl, array=array.array, Decimal=Decimal, Fraction=Fraction, Path=Path),
        "SPACE": space,
        "BARS": bars,
        "MAPS": fl.sweep("planar_4r", space, ["omega4_max"], **options),
        "TORQUE": fl.sweep("planar_4r", space, ["T41_fluctuation"], links=bars, branch=1, **options),
        "RATES": fl.sweep("planar_4r", space, rates, links=bars, branch=1, threads=1),
        "LINKAGES": fl.sweep(
            "minkowski_4r",
            fl.grid(a=1.0, b=[1.0, 7.0], g=[4.0, 3.0], h=1.0),
            ["linkage_type", *SUMS],
            threads=1,
        ),
        "RAYS": fl.focal.involution(5.0, 5.0, 2.0, 4.0, 1.369, branch=2, x=2.0, y=0.4495),
        "PATH": fl.sweep("focal", focal, ["T_x", "T_y"], phi=8),
        "SPEED": fl.function(
            "planar_4r", ["a2", "a3"], ["omega4_max"], a1=0.4, a4=1.0, omega1=25.0, angles=8
        ),
        "COGNATE": fl.planar.cognates(design)[1],
        "MEASURED": measured,
    }


@dataclass(frozen=True)
class Case:
    """One call.

    Attributes
    ----------
    number : int
        Its number in the draws of its seed.
    door, kind : str
        The public name, and the kinds of hostility.
    verdict : str
        What may come of it.
    text, plain : str
        The source of the call, and that of the same call with plain values.
    """

    number: int
    door: str
    kind: str
    verdict: str
    text: str
    plain: str
    check: str = ""
    slots: tuple[str, ...] = ()
    source: str = ""


@cache
def values_of(slot: Slot) -> tuple[Value, ...]:
    """Return the hostile values of an argument."""
    optional = {"None"} if slot.base == "None" else set()
    good = {*slot.good, slot.base, *optional}
    return tuple(value for value in ROLES[slot.role] if value.text not in good)


def case_of(number: int, door: Door, chosen: dict[str, Value]) -> Case:
    """Return the case with some values at a door."""
    chosen = {
        name: value.about(door.slots[name].x or door.slots[name].base) for name, value in chosen.items()
    }
    verdicts = {value.verdict for value in chosen.values()}
    alone = TAKEN if len(chosen) == 1 else EITHER
    verdict = REFUSED if REFUSED in verdicts else EITHER if EITHER in verdicts else alone
    text = door.text({name: value.text for name, value in chosen.items()})
    plain = door.text({name: value.plain for name, value in chosen.items()})
    kind = (
        " and ".join(sorted({value.kind for value in chosen.values()})) if len(chosen) == 1 else "two at once"
    )
    made = [f"({value.text})" for name, value in chosen.items() if door.slots[name].role != "more"]
    if door.check == "refused":
        verdict = REFUSED
    return Case(
        number, door.name, kind, verdict, text, plain, door.check, tuple(chosen), f"[{', '.join(made)}]"
    )


def argument_cases(seed: int, count: int, doors: Iterable[Door] = DOORS) -> Iterator[Case]:
    """Yield the cases of a seed."""
    doors, rng = list(doors), np.random.default_rng(seed)
    for number in range(count):
        door = doors[rng.integers(len(doors))]
        names = [name for name in door.slots if values_of(door.slots[name])]
        two = len(names) > 1 and rng.random() < 0.2
        some = rng.choice(len(names), 2 if two else 1, replace=False)
        chosen = {}
        for k in some:
            values = values_of(door.slots[names[k]])
            chosen[names[k]] = values[rng.integers(len(values))]
        yield case_of(number, door, chosen)


def singles(doors: Iterable[Door] = DOORS) -> Iterator[Case]:
    """Yield a case for each value of each argument."""
    number = 0
    for door in doors:
        for name in door.slots:
            for value in values_of(door.slots[name]):
                yield case_of(number, door, {name: value})
                number += 1


@dataclass
class Tally:
    """What became of cases, by door and kind."""

    counts: Counter[tuple[str, str, str]] = field(default_factory=Counter)
    failures: list[tuple[Case, Outcome]] = field(default_factory=list)

    def take(self, case: Case, outcome: Outcome) -> None:
        """Count one case."""
        self.counts[case.door, case.kind, outcome.verdict] += 1
        if outcome.verdict == "failed":
            self.failures.append((case, outcome))

    def table(self) -> str:
        """Return the counts as a table."""
        lines = [f"{'door':32}{'hostility':28}{'tried':>8}{'refused':>9}{'taken':>8}{'failed':>8}"]
        for door, kind in dict.fromkeys((door, kind) for door, kind, _ in sorted(self.counts)):
            of = [self.counts[door, kind, verdict] for verdict in ("refused", "taken", "failed")]
            lines.append(f"{door:32}{kind:28}{sum(of):8}{of[0]:9}{of[1]:8}{of[2]:8}")
        return "\n".join(lines)


def judge_all(
    cases: Iterable[Case], names: dict[str, Any], show: Callable[[Case, Outcome], None] | None = None
) -> Tally:
    """Judge cases one after another."""
    tally = Tally()
    for case in cases:
        if not constructible(case, names):
            continue
        try:
            check = CHECKS.get(case.check)
            own = partial(check, text=case.plain, names=names) if check else None
            outcome = judged(case.verdict, case.text, case.plain, names, own)
        except Exception:
            outcome = Outcome("failed", "the harness: " + traceback.format_exc()[-300:])
        tally.take(case, outcome)
        if show:
            show(case, outcome)
    return tally

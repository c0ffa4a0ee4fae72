"""Hostile input: no traceback, no wrong number, no hang, at any door.

A case that fails is one line of Python; ``python -m tests.hostile "LINE"`` runs it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import fastlink as fl
from tests.hostile import campaign, checks, judge
from tests.hostile.campaign import Case, Tally
from tests.hostile.checks import CHECKS
from tests.hostile.doors import DOORS, Door

#: Each part of the default run, and its number of cases.
PARTS: dict[str, tuple[Callable[[int, int], Iterator[Case]], int]] = {
    "arguments": (campaign.argument_cases, 650),
    "tables": (campaign.table_cases, 200),
    "studies": (campaign.study_cases, 110),
    "command lines": (campaign.line_cases, 40),
}
SEED = 13
#: How many times as many in the long run, of another seed: 100,000 in all.
LONG = 100
SHOWN = 20
#: What is public and not called here, and why.
ELSEWHERE = {"InputError": "an exception", "InputWarning": "a warning"}
#: Classes of what public functions return.
RESULTS = {
    "planar.Cognate",
    "focal.StraightLine",
    "focal.Construction",
    "focal.InscribedConic",
    "focal.Involution",
}
RESULTS |= {"minkowski.CouplerCircles", "minkowski.PureTriangle"}


@pytest.fixture(scope="module")
def names(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Any]]:
    """Return what the lines of cases are made of, in a folder of their own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("hostile"))
        yield campaign.namespace()


def assert_none_failed(tally: Tally) -> None:
    lines = [
        f"case {case.number}: {case.text}\n    {outcome.why}" for case, outcome in tally.failures[:SHOWN]
    ]
    assert not tally.failures, f"{len(tally.failures)} failed\n" + "\n".join(lines)


@pytest.mark.parametrize("part", PARTS)
def test_hostile_input_is_refused_or_means_what_it_says(part: str, names: dict[str, Any]) -> None:
    cases, count = PARTS[part]
    tally = campaign.judge_all(cases(SEED, count), names)
    assert sum(tally.counts.values()) > 0.8 * count
    assert_none_failed(tally)


def test_the_same_seed_draws_the_same_cases() -> None:
    for cases, _ in PARTS.values():
        assert list(cases(SEED, 40)) == list(cases(SEED, 40))
        assert list(cases(SEED, 40)) != list(cases(SEED + 1, 40))


@pytest.mark.sample(6)
@pytest.mark.parametrize("door", DOORS, ids=lambda door: door.name)
def test_a_door_opens_to_good_values(door: Door, names: dict[str, Any]) -> None:
    outcome = campaign.judged(
        "either" if door.check == "refused" else "taken", door.text({}), door.text({}), names
    )
    assert outcome.verdict == ("refused" if door.check == "refused" else "taken"), outcome.why


def test_every_public_function_is_a_door() -> None:
    tried = {door.name.partition(".")[0] for door in DOORS} | {"table"}
    public = {name for name in dir(fl) if callable(getattr(fl, name))}
    assert public - tried == ELSEWHERE.keys()
    for package in ("planar", "focal", "minkowski", "hart"):
        functions = {f"{package}.{name}" for name in getattr(fl, package).__all__}
        assert functions - {door.name for door in DOORS} == RESULTS & functions


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("1 / 0", "ZeroDivisionError"),
        ("np.float64(1.0) / 0.0", "RuntimeWarning"),
        ("hang()", "hangs"),
        ("fl.grid(a1=0.4)", "accepted"),
    ],
)
def test_the_judge_sees_what_must_not_happen(
    text: str, why: str, names: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(judge, "SECONDS", 0.3)
    outcome = campaign.judged("refused", text, text, names | {"hang": lambda: [0 for _ in iter(int, 1)]})
    assert outcome.verdict == "failed"
    assert why in outcome.why


def test_the_judge_sees_a_wrong_number(names: dict[str, Any]) -> None:
    text, plain = "fl.grid(a1=0.4)", "fl.grid(a1=0.5)"
    assert campaign.judged("taken", text, text, names, check=lambda _: "").verdict == "taken"
    assert campaign.judged("taken", text, plain, names).verdict == "failed"
    assert campaign.judged("either", text, plain, names).verdict == "failed"


CHECKED = [door for door in DOORS if door.check in CHECKS]


def altered(result: Any) -> Any:
    """Return a result with another number in it, or of another design."""
    if isinstance(result, dict):
        return {name: np.asarray(values) * (1.0 + 1e-12) + 1e-15 for name, values in result.items()}
    if isinstance(result, fl.focal.Construction):
        return replace(result, values=altered(result.values))
    if isinstance(result, fl.focal.Involution):
        return fl.focal.Involution(*[(p * (1.0 + 1e-9), q, r) for p, q, r in result._forms])
    if isinstance(result, tuple):
        return type(result)(*map(altered, result))
    if isinstance(result, (np.ndarray, np.generic)):
        return result * (1.0 + 1e-12) + 1e-15
    return result.assign(theta4=-result.theta4) if hasattr(result, "assign") else result


@pytest.mark.parametrize("door", CHECKED, ids=lambda door: door.name)
def test_a_check_sees_a_wrong_number(door: Door, names: dict[str, Any]) -> None:
    text = door.text({})
    check, result = CHECKS[door.check], eval(text, dict(names))
    assert check(result, text, names) == ""
    if door.check == "function":
        assert check(result, door.text({"a4": "1.0 + 2**-30"}), names) != ""
    else:
        assert check(altered(result), text, names) != ""


def test_an_open_loop_is_seen() -> None:
    design = dict(a1=0.4, a2=1.2, a3=0.8, a4=1.0, theta1=0.75)
    theta4 = [fl.evaluate("planar_4r", ["theta4"], **design, branch=branch)["theta4"] for branch in (1, 2)]
    for branch in (1, 2):
        assert not checks.open_loop(theta4[branch - 1], **design, branch=branch)
        assert "other assembly mode" in checks.open_loop(theta4[2 - branch], **design, branch=branch)
        assert "long" in checks.open_loop(theta4[branch - 1] + 1e-12, **design, branch=branch)


@pytest.mark.stress
@pytest.mark.parametrize("part", PARTS)
def test_much_more_hostile_input(part: str, names: dict[str, Any], tell: Callable[[str], None]) -> None:
    cases, count = PARTS[part]
    tally = campaign.judge_all(cases(SEED + 1, LONG * count), names)
    tell(f"{part}, seed {SEED + 1}\n{tally.table()}")
    assert_none_failed(tally)


@pytest.mark.stress
def test_each_hostile_value_at_each_argument(names: dict[str, Any], tell: Callable[[str], None]) -> None:
    tally = campaign.judge_all(campaign.singles(), names)
    tell(f"each value at each argument\n{tally.table()}")
    assert_none_failed(tally)

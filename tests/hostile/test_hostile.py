"""Hostile input: no traceback, no wrong number, no hang, at any door."""

import inspect

import pytest

import fastlink as fl
from tests.hostile import judge
from tests.hostile.campaign import PARTS, draw, judge_all, namespace, singles, table_of
from tests.hostile.doors import DOORS
from tests.hostile.judge import judged

SEED = 13
#: How many times as many cases the long run of another seed has.
LONG = 100
SHOWN = 20
#: What is public and not called here, and why; classes of what public functions return are called by these.
ELSEWHERE = {"InputError": "an exception", "InputWarning": "a warning", "table": "see `tables`"}
ELSEWHERE |= {"synthesise": "see tests/synthesis", "linkage": "see tests/mechanisms/linkages"}
#: Arguments that are not tried, and why.
UNTRIED = {
    **dict.fromkeys(("table.source", "table.keep", "table.allow_invalid"), "see `tables`"),
    **dict.fromkeys(("explain.space", "explain.quantities"), "those of fl.sweep"),
    "open.chunks": "an option of xarray",
    "join.mechanism": "that of fl.tolerance",
    "grid.axes": "by position only",
    **dict.fromkeys(("sobol.ranges", "latin_hypercube.ranges"), "as keywords"),
    **dict.fromkeys(
        (f"{door}.trust_code" for door in ("draw", "accuracy", "tolerance")), "a switch, as others"
    ),
}


@pytest.fixture(scope="module")
def names(tmp_path_factory):
    """Return what the lines of cases are made of, in a folder of their own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("hostile"))
        yield namespace()


@pytest.mark.parametrize("part", PARTS)
def test_hostile_input_is_refused_or_means_what_it_says(part, names):
    counts, failures = judge_all(draw(part, SEED), names)
    assert sum(counts.values()) > 0.8 * PARTS[part][1]
    assert not failures, f"{len(failures)} failed\n" + "\n".join(failures[:SHOWN])


@pytest.mark.parametrize("part", PARTS)
def test_the_same_seed_draws_the_same_cases(part):
    assert list(draw(part, SEED)) == list(draw(part, SEED)) != list(draw(part, SEED + 1))


def test_every_parameter_of_every_public_function_is_tried():
    public = {
        name: one for name in dir(fl) if callable(one := getattr(fl, name)) and not inspect.isclass(one)
    }
    for package in ("planar", "focal", "minkowski", "hart"):
        functions = ((name, getattr(getattr(fl, package), name)) for name in getattr(fl, package).__all__)
        public |= {f"{package}.{name}": one for name, one in functions if not inspect.isclass(one)}
    tried = {}
    for door in DOORS:
        tried.setdefault(door.name, set()).update(door.slots)
    assert public.keys() - tried.keys() <= ELSEWHERE.keys()
    untried = {
        f"{name}.{parameter.name}"
        for name, one in public.items()
        if not ELSEWHERE.get(name, "").startswith("see tests/")
        for parameter in inspect.signature(one).parameters.values()
        if parameter.kind not in (parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL)
        and parameter.name not in tried.get(name, ())
        and not (
            name.startswith("planar.") and parameter.name == "design"
        )  # all read it as `planar.sextic` does
    }
    assert untried == UNTRIED.keys()


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("1 / 0", "ZeroDivisionError"),
        ("np.float64(1.0) / 0.0", "RuntimeWarning"),
        ("hang()", "hangs"),
        ("fl.grid(a1=0.4)", "accepted"),
    ],
)
def test_the_judge_sees_what_must_not_happen(text, why, names, monkeypatch):
    monkeypatch.setattr(judge, "SECONDS", 0.3)
    verdict, found = judged("refused", text, text, names | {"hang": lambda: [0 for _ in iter(int, 1)]})
    assert verdict == "failed"
    assert why in found


def test_the_judge_sees_a_wrong_number(names):
    text, plain = "fl.grid(a1=0.4)", "fl.grid(a1=0.5)"
    assert judged("taken", text, text, names)[0] == "taken"
    assert judged("taken", text, plain, names)[0] == "failed"
    assert judged("either", text, plain, names)[0] == "failed"


@pytest.mark.stress
@pytest.mark.parametrize("part", [*PARTS, "each value at each argument"])
def test_much_more_hostile_input(part, names, tell):
    counts, failures = judge_all(draw(part, SEED + 1, LONG) if part in PARTS else singles(), names)
    tell(f"{part}\n{table_of(counts)}")
    assert not failures, f"{len(failures)} failed\n" + "\n".join(failures[:SHOWN])

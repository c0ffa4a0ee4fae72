"""Greatest and least values of what turns sharply: magnitudes that almost vanish, and angles that turn back.

A search has to be told of both (`fastlink.plan.programs`). What takes a magnitude or a size by its own text is found
here by that text, so that a new quantity fails unless its search knows of it or it stands in `SMOOTH_ELSEWHERE`.
"""

import ast

import numpy as np
import pytest
from tests.support.registry import ENTRIES

import fastlink as fl
from fastlink.numerics.compiler import syntax
from fastlink.plan.programs import Planner

#: Driven inputs whose extremes are searched, with families that are hard.
DRIVES = [entry for entry in ENTRIES if entry.catalogue.graded is not None and not entry.about]
#: The functions that are not smooth where their argument vanishes; `sqrt` and `select` choose and scale within facts.
SHARP = {"abs", "magnitude", "largest", "sign", "absolute", "choice", "zero_where"}
#: What is searched without being told, and why; dense samples say whether that is enough.
SMOOTH_ELSEWHERE = {
    "P_speed": "the size is that of an input; the one magnitude turns sharply at cusps, as the tests below make it do",
    "M_across_AB": "sizes choose between two forms of the same coordinate",
    "transmission_angle_F": "a size in one of two forms of the same angle; no sample was beyond, which is no proof",
}
#: How many quantities are sharp by their text, of the drives that have such: one less is one that is not looked at.
KNOWN = {("planar_4r", "theta1"): 6, ("slider_crank", "theta"): 4, ("focal", "phi"): 3, ("focal", "sigma"): 4}
SHARP_DRIVES = [entry for entry in DRIVES if (entry.mechanism, entry.input) in KNOWN]


def searches_of(entry):
    """Return the searches by quantity, of those whose extremes are searched."""
    catalogue = entry.catalogue
    found = {name: Planner(catalogue, tuple(catalogue.inputs)).search(name) for name in catalogue.public}
    return {name: search for name, search in found.items() if search is not None}


def sharp_by_text(entry):
    """Return the searched quantities whose own text takes a magnitude, a size or a choice of signs."""
    names = []
    for name in searches_of(entry):
        calls = [
            node.func
            for node in ast.walk(syntax(entry.catalogue.facts[name].function))
            if isinstance(node, ast.Call)
        ]
        if any(isinstance(call, ast.Name) and call.id in SHARP for call in calls) and entry.catalogue.varies(
            name
        ):
            names.append(name)
    return names


def undeclared(entry):
    """Return the quantities with sharp places that their searches do not know of."""
    searches = searches_of(entry)
    return [
        name
        for name in sharp_by_text(entry)
        if not (searches[name].magnitude or searches[name].folds or name in SMOOTH_ELSEWHERE)
    ]


@pytest.mark.sample(3)
@pytest.mark.parametrize("entry", DRIVES, ids=str)
def test_searches_know_what_is_sharp(entry):
    assert undeclared(entry) == []


def test_there_are_as_many_as_counted():
    counts = {(entry.mechanism, entry.input): len(sharp_by_text(entry)) for entry in DRIVES}
    assert {key: count for key, count in counts.items() if count} == KNOWN


def test_a_quantity_that_is_not_declared_fails(monkeypatch):
    monkeypatch.setattr("fastlink.plan.programs.is_magnitude", lambda step: False)
    assert undeclared(DRIVES[0]) == ["F41", "F21", "F32", "F43", "shaking_force"]


def assert_none_beyond(mechanism, position, columns, names, positions):
    """Assert that samples are within the bounds of greatest and least values."""
    designs = fl.table(columns)
    asked = [f"{name}_{how}{end}" for name in names for how in ("min", "max") for end in ("", "_error")]
    given = {"input": position, "progress": False, "allow_invalid": True}
    maps = fl.sweep(mechanism, designs, asked, **given)
    curves = fl.sweep(
        mechanism, designs, [*names, *(f"{name}_error" for name in names)], **given, **{position: positions}
    )
    seen = 0
    for name in names:
        for how, sign in (("max", 1.0), ("min", -1.0)):
            # what is not known of a sample, its own bound says; of the extreme, its own
            off = sign * curves[name] - curves[f"{name}_error"]
            beyond = off.max(position) - sign * maps[f"{name}_{how}"] - maps[f"{name}_{how}_error"]
            seen += int(np.isfinite(beyond).sum())
            assert not (beyond > 0.0).any(), (
                name,
                how,
                np.argwhere((beyond > 0.0).values)[:5].tolist(),
                float(beyond.max()),
            )
    return seen


def compare(entry, kind, n, samples):
    drawn = entry.drawn(kind, 5, n)
    columns = {name: value for name, value in drawn.items() if name in entry.catalogue.inputs}
    names = sharp_by_text(entry)
    return assert_none_beyond(
        entry.mechanism, entry.input, columns, names, np.linspace(0.0, 2 * np.pi, samples)
    )


@pytest.mark.parametrize("entry", [one for one in SHARP_DRIVES if one.mechanism == "slider_crank"], ids=str)
def test_none_of_dense_samples_is_beyond(entry):
    assert compare(entry, "random", 8, 1001)


@pytest.mark.stress
@pytest.mark.parametrize("entry", SHARP_DRIVES, ids=str)
def test_none_of_many_samples_is_beyond(entry):
    seen = {kind: compare(entry, kind, 300, 4001) for kind in entry.families}
    # a rod of 1e-8 moves between two samples, where no loop closes at any
    assert [kind for kind, count in seen.items() if not count] == [
        kind for kind in seen if kind == "short 1e-8"
    ]


#: Where the magnitudes of `almost_vanishing` almost vanish.
PLACE = 1.0


def almost_vanishing(name, n, seed):
    """Return designs whose coupler point or force on the frame is within 1e-9 to 0.1 of its size of zero at a place."""
    rng = np.random.default_rng(seed)
    lengths = {"a1": rng.uniform(0.1, 0.5, n), "a2": rng.uniform(0.8, 1.3, n), "a3": rng.uniform(0.8, 1.2, n)}
    designs = {**lengths, "a4": np.ones(n), "omega1": np.full(n, 3.0)}
    # both are linear in two inputs: where they vanish, from three evaluations
    places = ("P_u", "P_v") if name == "P_speed" else ("G1_u", "G1_v")
    parts = {"P_speed": ("P_vx", "P_vy")}.get(name, (f"{name}_x", f"{name}_y"))
    if name != "P_speed":
        for k in (1, 2, 3):
            designs |= {f"m{k}": rng.uniform(0.5, 2.0, n), f"I{k}": rng.uniform(0.1, 1.0, n)}
            designs |= {f"G{k}_u": rng.uniform(-1.0, 1.0, n), f"G{k}_v": rng.uniform(-1.0, 1.0, n)}
    values = []
    for u, v in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)):
        at = {**designs, places[0]: np.full(n, u), places[1]: np.full(n, v)}
        found = fl.evaluate("planar_4r", list(parts), **at, theta1=PLACE, branch=1)
        values.append(np.array([np.broadcast_to(found[part], n) for part in parts]))
    slopes = np.moveaxis(np.array([values[1] - values[0], values[2] - values[0]]), (0, 1), (2, 1))
    solved = np.linalg.solve(slopes, -values[0].T[:, :, None])[:, :, 0]
    off = 10.0 ** rng.uniform(-9.0, -1.0, n)
    designs |= {places[0]: solved[:, 0] + off, places[1]: solved[:, 1]}
    return designs


def compare_almost_vanishing(name, n):
    columns = almost_vanishing(name, n, 3)
    near = np.concatenate([[0.0], np.geomspace(1e-10, 0.3, 300)])
    positions = np.unique(np.concatenate([PLACE - near, PLACE + near, np.linspace(0.0, 2 * np.pi, 501)]))
    assert assert_none_beyond("planar_4r", "theta1", columns, [name], positions) > n


@pytest.mark.parametrize("name", ["P_speed", "shaking_force", "F41"])
def test_none_is_beyond_where_a_magnitude_almost_vanishes(name):
    compare_almost_vanishing(name, 40)


@pytest.mark.stress
@pytest.mark.parametrize("name", ["P_speed", "shaking_force", "F41"])
def test_none_of_many_is_beyond_where_a_magnitude_almost_vanishes(name):
    compare_almost_vanishing(name, 5000)

"""The studies of the repository run, at reduced size, and their numbers are those that their comments promise.

The map of crank-rockers runs at its size in test_readme.py; those of minkowski_4r in test_minkowski_studies.py.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from tests.support.four_bar import sweep_4r

import fastlink as fl
from fastlink.app.study import read_study
from fastlink.mechanisms import catalogue
from fastlink.numerics.compensated import UNIT_ROUNDING

CLASS_FLAGS = catalogue("planar_4r").facts["grashof_class"].flags

STUDIES = Path(__file__).parents[2] / "data" / "studies"
TURN = 2.0 * np.pi


def reduced(name, angles=24, points=3):
    """Run a study with few points on each axis and given input angles, which extremes are then taken over."""
    text = (STUDIES / name).read_text(encoding="utf-8")
    axis = rf"linspace = [\1, {points}]"
    small = re.sub(r"linspace = \[([^]]*), \d+\]", axis, text)
    turn = f'theta1 = {{linspace = [0.0, {TURN * (angles - 1) / angles}, {angles}]}}\nextrema = "sampled"'
    small = re.sub(r"^theta1 = \d+$", turn, small, flags=re.MULTILINE)
    path = Path(name)
    path.write_text(small, encoding="utf-8")
    with fl.run(path) as maps:
        return maps.load()


#: Table 2 and what docs/papers.md has for Table 3, in both assembly modes: value and place.
TABLES = (
    ("omega4_min", (-23.95938172, -23.95938172), (0.36933536497, 5.91384994221)),
    ("omega4_max", (13.51343678, 13.51343678), (TURN - 1.66716501134, 1.66716501134)),
    ("alpha4_max", (462.6986574, 1062.775829), (0.8382412814, 0.1482557001)),
    ("alpha4_min", (-1062.775829, -462.6986574), (TURN - 0.1482557001, 5.44494402572)),
)
SHAKING = ("shaking_force_max", (2512.318, 2512.318), (TURN - 0.1096, 0.1096))


def assert_tables(maps, tables, value, place):
    for name, values, places in tables:
        np.testing.assert_allclose(maps[name], values, rtol=value, err_msg=name)
        np.testing.assert_allclose(maps[f"theta1_at_{name}"] % TURN, places, rtol=0, atol=place, err_msg=name)


def test_the_example_of_the_paper_to_every_digit(folder):
    with fl.run(STUDIES / "hayes_table1.toml") as maps:
        # Half a unit of the last of ten digits printed; of the places the errata give eleven decimals.
        assert_tables(maps, TABLES, value=5e-10, place=1e-10)
        assert_tables(maps, [SHAKING], value=3e-7, place=5e-5)
        assert CLASS_FLAGS[int(maps.grashof_class)] == "crank_rocker"
        assert {"omega4", "alpha4", "T41", "shaking_force", "shaking_moment"} <= set(maps)


def test_the_quick_return_atlas(folder):
    maps = reduced("quick_return_atlas.toml")
    assert set(maps.time_ratio.dims) == {"a1", "a2", "a3"}
    cranks = maps.grashof_class.values == 0
    assert cranks.any()
    np.testing.assert_array_equal(np.isfinite(maps.time_ratio.values), cranks)
    assert maps.time_ratio.min() >= 1.0
    assert maps.swing.values[cranks].max() < np.pi


def test_the_map_of_counterweights(folder):
    maps = reduced("counterweights.toml")
    design = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
    bars = fl.round_bar(7750.0, 0.01)
    force = maps.shaking_force_max.values
    angles = np.linspace(0.0, TURN * 23 / 24, 24)
    options = {"links": bars, "theta1": angles, "extrema": "sampled"}
    without = sweep_4r(fl.grid(**design), ["shaking_force_max"], **options)
    # Masses of zero change no bit.
    np.testing.assert_array_equal(force[0, 0], without.shaking_force_max)
    # The middle is the balance of Berkof and Lowen: the masses are products of a dozen roundings at most.
    weights = fl.planar.force_balance(design, links=bars, radius1=0.2, radius3=0.4)
    for i in (1, 3):
        name = f"counterweight{i}_mass"
        np.testing.assert_allclose(maps[name][1], weights[name], rtol=16 * UNIT_ROUNDING)
    # What is left there are roundings of some ten terms of the force that the counterweights take away.
    assert np.all(force[1, 1] <= 32 * UNIT_ROUNDING * force[0, 0])


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", sorted(path.name for path in STUDIES.glob("*.toml")))
def test_every_study_says_what_it_is_for_and_how_to_run_it(name):
    text = (STUDIES / name).read_text(encoding="utf-8")
    assert text.startswith("# ")
    assert f"#     fastlink run data/studies/{name}" in text
    assert "fastlink plot" in text or "fastlink draw" in text  # a search has a few designs, which are drawn
    study = read_study(STUDIES / name)
    inputs = catalogue(study.mechanism).inputs
    assert {name for name, one in inputs.items() if one.rule == "positive"} <= set(study.space.names)

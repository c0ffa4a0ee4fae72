"""The studies of the Minkowskian 4R: every number of section 3.7 of the paper, and the tables at reduced size."""

from collections import Counter
from itertools import product
from math import comb
from pathlib import Path

import numpy as np
from tests.mechanisms.minkowski_4r.test_minkowski_types import EXAMPLES
from tests.support.refusals import refused
from tests.support.sweeps import sweep_both

import fastlink as fl

STUDIES = Path(__file__).parents[3] / "data" / "studies"


def test_the_curves_of_the_examples_are_where_the_paper_says(tmp_path):
    """Figures 9 to 24: assembled up to theta_min and from theta_max on, there in both branches."""
    with fl.run(STUDIES / "minkowski_examples.toml", to=tmp_path / "examples.h5") as maps:
        examples = maps.load()
    lengths = [lengths for lengths, *_ in EXAMPLES.values()]
    np.testing.assert_array_equal(np.array([examples[name] for name in "abgh"]).T, lengths)
    cosh = np.cosh(examples.theta)
    closes = (cosh <= examples.cosh_theta_min) | (cosh >= examples.cosh_theta_max)
    # At theta = 0 the second example is in line, but for the last bits of its decimals.
    sure = (examples.theta != 0.0) | (examples.design != 1)
    found = np.isfinite(examples.psi).all("branch")
    assert bool((found == closes).where(sure, True).all())
    assert 0 < int(closes[:, 0].sum()) < 401


def by_the_theorems():
    """Count linkages of whole lengths up to 9 by the conditions of Theorems 3.12 to 3.22, and the signs of T1 to T5."""
    counts = Counter()
    for a, b, g, h in product(range(1, 10), repeat=4):
        T = (g + b - h - a, a - g + b - h, g - a - b - h, g - a + b + h, a - h + g + b)
        signs = tuple("-0+"[(x > 0) - (x < 0) + 1] for x in T)
        for one, others, strange, rigid in (
            (b, a + g + h, "crank-crank", "crank-crank"),
            (h, a + b + g, "crank-superrocker", "crank-rocker"),
            (g, a + b + h, "superrocker-crank", "rocker-crank"),
            (a, b + g + h, "superrocker-superrocker", "rocker-rocker"),
        ):
            if one >= others:
                kind, motion = ("strange", strange) if one > others else ("rigid", rigid)
                break
        else:
            kind = "irreducible" if T[0] and T[1] else "reducible"
            if T[0] == 0:
                motion = "crank-crank"  # Theorem 3.20
            elif T[1] == 0:
                motion = "crank-crank" if T[0] > 0 else "crank-rocker"  # 3.21, and 3.11 for the output
            else:  # Table 3
                types = {"++": "crank-crank", "+-": "rocker-crank"}
                types |= {"-+": "rocker-rocker", "--": "crank-rocker"}
                motion = types["".join(signs[:2])]
        counts[kind, motion, *signs] += 1
    return counts


def test_the_study_fills_the_tables_of_the_paper(tmp_path):
    """With whole lengths up to 9."""
    text = (STUDIES / "minkowski_tables.toml").read_text(encoding="utf-8")
    assert "32 x 32 x 32 x 32" in text
    study = tmp_path / "tables.toml"
    study.write_text(text.replace("linspace = [1.0, 32.0, 32]", "linspace = [1.0, 9.0, 9]"), encoding="utf-8")
    fl.run(study, to=tmp_path / "tables.h5").close()
    tables = fl.minkowski.linkage_table(tmp_path / "tables.h5")
    columns = ["kind", "input", "output", "T1", "T2", "T3", "T4", "T5", "linkages"]
    found = {
        (kind, f"{crank}-{rocker}", *signs): count
        for kind, crank, rocker, *signs, count in tables[columns].itertuples(index=False)
    }
    assert found == dict(by_the_theorems())
    assert tables["linkages"].sum() == 9**4
    # a > b + g + h has C(9, 4) solutions, a = b + g + h has C(9, 3); b + g = a + h has (2 n^3 + n)/3.
    assert tables.query("kind == 'strange'")["linkages"].tolist() == 4 * [comb(9, 4)]
    assert tables.query("kind == 'rigid'")["linkages"].tolist() == 4 * [comb(9, 3)]
    on_T1 = tables.query("kind == 'reducible' and T1 == '0'")
    assert on_T1["linkages"].sum() == (2 * 9**3 + 9) // 3
    assert tables["paper"].tolist() == 4 * ["Table 1"] + 4 * ["Table 2"] + 5 * ["Theorems 3.20, 3.21"] + 4 * [
        "Table 3"
    ]
    conditions = dict(zip(tables["condition"], tables["kind"], strict=True))
    for kind, relation in (("strange", ">"), ("rigid", "=")):
        for long in ("a {} b + g + h", "b {} a + g + h", "g {} a + b + h", "h {} a + b + g"):
            assert conditions[long.format(relation)] == kind


def test_a_table_needs_the_types_and_the_sums():
    maps = sweep_both("minkowski_4r", fl.grid(a=1.0, b=1.0, g=4.0, h=[1.0, 2.0]), ["linkage_type", "T1"])
    with refused("T2", "sweep 'linkage_type'"):
        fl.minkowski.linkage_table(maps)
    with refused("maps"):
        fl.minkowski.linkage_table(3.0)

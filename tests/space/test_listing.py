"""How a design space prints, also in a notebook."""

import numpy as np

import fastlink as fl


def test_a_grid_prints_its_axes_and_its_memory():
    space = fl.grid(a1=0.4, a2=np.linspace(1.0, 1.4, 101), a3=[0.7, 0.8], a4=1.0)
    first, header, *rows = str(space).splitlines()
    # 103 values of axes; four inputs of 202 designs
    assert first == "grid of 202 designs (101 x 2), 824 B in memory, 6.46 kB as a table of doubles"
    assert header.split() == ["input", "values", "from", "to", "units"]
    assert [row.split() for row in rows] == [
        ["a2", "101", "1", "1.4"],
        ["a3", "2", "0.7", "0.8"],
        ["a1", "one", "0.4"],
        ["a4", "one", "1"],
    ]
    page = space._repr_html_()
    assert page.count("<tr>") == 5
    assert "<td>1.4</td>" in page


def test_no_list_of_a_sample_is_made_to_print_it():
    space = fl.sobol(10**10, a1=(0.1, 0.5), a2=(1.0, 2.0), a3=1.0, a4=1.0)
    assert "10,000,000,000 designs" in repr(space)
    assert "computed" in space._repr_html_()


def test_one_design_and_a_table():
    assert repr(fl.grid(a1=0.4, a2=1.0, a3=1.0, a4=1.0)).startswith("grid of 1 design, 0 B in memory, 32 B")
    table = fl.table({"a1": [0.4, 0.5], "a2": [1.0, 1.1], "a3": 1.0, "a4": 1.0})
    assert "table of 2 designs" in repr(table)


def test_an_explanation_shows_first_what_a_run_needs(tmp_path):
    study = tmp_path / "study.toml"
    study.write_text(
        'mechanism = "planar_4r"\nquantities = ["theta4"]\n[design]\na1 = 0.4\na2 = 1.2\na3 = 0.8\na4 = 1.0\n'
    )
    page = fl.explain(study)._repr_html_()
    assert page.index("memory") < page.index("<details>") < page.index("left out")

"""The list of mechanisms."""

import subprocess
import sys

import pytest
from tests.support.four_bar import sweep_4r

import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue, inputs_of


def test_every_mechanism_is_listed_within_a_screen():
    listed = fl.mechanisms()
    assert [one.name for one in listed] == list(NAMES)
    assert [one.inputs for one in listed] == [inputs_of(name) for name in NAMES]
    assert [one.quantities for one in listed] == [len(catalogue(name).public) for name in NAMES]
    assert max(map(len, str(listed).splitlines())) <= 132


def test_a_notebook_shows_a_table():
    text = fl.mechanisms()._repr_html_()
    assert text.count("<tr>") == len(NAMES) + 1
    assert "Burmester&#x27;s" in text


def test_the_version_is_that_of_the_maps():
    design = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0)
    source = sweep_4r(design, ["grashof_class"]).attrs["source"]
    assert source.startswith(f"fastlink {fl.__version__},")


@pytest.mark.parametrize("first", ["fl.mechanisms()", "import fastlink.mechanisms.planar_4r as _"])
def test_the_package_of_that_name_stays_one(first):
    """A function and a package share the name, whichever is used first."""
    script = f"""
import fastlink as fl
{first}
import fastlink.mechanisms.planar_4r.by_joint as by_joint
from fastlink.mechanisms import NAMES
assert [one.name for one in fl.mechanisms()] == list(NAMES)
assert fl.mechanisms.planar_4r.by_joint is by_joint
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr

"""Files keep the rules of CF, and are read as docs/files.md says: by other programs, without fastlink."""

import re
import shutil
import subprocess
from pathlib import Path

import h5py
import netCDF4
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.sweeps import sweep_4r, sweep_both

import fastlink as fl

DOCUMENT = (Path(__file__).parents[2] / "docs" / "files.md").read_text()
#: Units of udunits, of which those of a map are products of whole powers.
UNITS = {"m", "s", "kg", "rad", "N", "W", "J", "degree"}
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
LINKS = {"a1": [0.4, 0.5], "a2": np.linspace(1.0, 1.2, 4), "a3": 0.8, "a4": 1.0, "omega1": 25.0}
CURVES = ["theta4", "omega4_extrema", "d_theta4_d_a1", "theta4_trust", "grashof_class"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("maps")


@pytest.fixture(scope="module")
def grid(folder):
    path, options = folder / "grid.nc", {"angles": 12, "verify": 1}
    sweep_4r(fl.grid(**LINKS), CURVES, to=path, **options).close()
    return path


def by_positions(folder, grid):
    path = folder / "by_positions.nc"
    sweep_4r(fl.grid(**LINKS), CURVES, angles=12, verify=0, layout="maps", to=path).close()
    return path


def sampled(folder, grid):
    path = folder / "sampled.nc"
    space = fl.sobol(8, a=(4.0, 5.0), b=5.0, c=2.0, d=4.0, rho=1.0, completion=1)
    sweep_both("focal", space, ["T_x", "F_y"], angles=8, verify=0, to=path).close()
    return path


def named(folder, grid):
    path, table = folder / "named.nc", {"name": ["x", "y"], **LINKS, "a1": [0.4, 0.5], "a2": 1.1}
    sweep_4r(fl.table(table), ["theta4_max"], verify=0, to=path).close()
    return path


def part(folder, grid):
    conditions = {"a2": "1.0:1.1", "a1": 0.5, "theta1": "#::2"}
    return fl.convert(grid, folder / "part.nc", select=conditions, dtype="float32", compress="gzip")


MADE = {
    "by positions": by_positions,
    "sampled": sampled,
    "named": named,
    "part": part,
    "grid": lambda f, g: g,
}


@pytest.fixture(params=MADE)
def file(request, folder, grid):
    with netCDF4.Dataset(MADE[request.param](folder, grid)) as opened:
        opened.set_auto_maskandscale(False)
        yield opened


def labels(one):
    return {name: one.getncattr(name) for name in one.ncattrs()}


def is_unit(text):
    words = [re.fullmatch(r"([A-Za-z]+)(-?\d+)?", word) for word in text.split(" ")]
    return text == "1" or all(word is not None and word[1] in UNITS for word in words)


def test_a_file_keeps_the_rules_of_cf(file):
    """Sections 2.3 (names), 2.6 (attributes), 3.1 to 3.5 (units, long names, flags), 5 (coordinates)."""
    assert file.Conventions.startswith("CF-1.")
    line = r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ fastlink \S+: (sweep|convert) .+"
    assert all(re.fullmatch(line, one) for one in file.history.splitlines())
    assert all(isinstance(labels(file)[name], str) for name in ("title", "source", "history"))
    names = [*file.variables, *file.dimensions, *file.ncattrs()]
    assert [name for name in names if not NAME.fullmatch(name)] == []
    for one in file.variables.values():
        attrs = labels(one)
        assert [key for key in attrs if not NAME.fullmatch(key)] == []
        assert attrs["long_name"]
        assert is_unit(attrs.get("units", "1")), attrs
        assert len(set(one.dimensions)) == one.ndim
        along = attrs.get("coordinates", "").split()
        for other in along:
            assert other not in one.dimensions
            assert set(file[other].dimensions) <= set(one.dimensions)
        if "flag_values" in attrs:
            values, meanings = np.atleast_1d(attrs["flag_values"]), attrs["flag_meanings"].split(" ")
            assert values.dtype == one.dtype
            assert len(set(values.tolist())) == len(values) == len(meanings)
            assert set(np.unique(one[:])) <= set(values.tolist())
            assert all(re.fullmatch(r"[A-Za-z0-9_\-.+@]+", meaning) for meaning in meanings)
            assert "units" not in attrs
    dims = [name for name in file.dimensions if name in file.variables]
    assert dims == list(file.dimensions)
    for name in dims:  # a coordinate variable: strictly monotonic, without missing values
        steps = np.diff(file[name][:].astype(float))
        assert file[name].dimensions == (name,)
        assert (steps > 0).all() or (steps < 0).all()
    results = {name for name, one in file.variables.items() if "references" in labels(one)}
    named = {other for name in results for other in labels(file[name]).get("coordinates", "").split()}
    for name in (*dims, *named):
        assert not {"_FillValue", "missing_value"} & set(file[name].ncattrs())
    # every input is a coordinate of some result
    assert set(file.variables) == results | named | set(dims)


def block(language):
    """Return the first block of code of a language."""
    return re.search(rf"^```{language}\n(.*?)^```", DOCUMENT, flags=re.MULTILINE | re.DOTALL)[1]


def test_the_lines_for_h5py_read_a_map(grid, tmp_path, monkeypatch):
    shutil.copy(grid, tmp_path / "maps.h5")
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(block("python"), "files.md", "exec"), names)
    with fl.open(grid) as maps:
        assert names["dims"] == list(maps.theta4.dims)
        assert names["units"] == "rad"
        assert_array_equal(names["first"], maps.theta4[0, 0].values)


def test_a_variable_is_an_array_at_its_offset(grid):
    with h5py.File(grid) as file, fl.open(grid) as maps:
        for name, one in maps.data_vars.items():
            stored = file[name]
            found = np.memmap(grid, stored.dtype.newbyteorder("<"), "r", stored.id.get_offset(), stored.shape)
            assert_array_equal(found, one.values)


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
def test_the_lines_of_c_read_a_map(grid, tmp_path):
    (tmp_path / "read.c").write_text(block("c"))
    subprocess.run(["cc", "-O1", "-Wall", "-Werror", "read.c", "-o", "read"], cwd=tmp_path, check=True)
    with h5py.File(grid) as file:
        values, offset = file["theta4"][()].reshape(-1), file["theta4"].id.get_offset()
    finite = int(np.argmax(np.isnan(values))) or values.size
    words = [tmp_path / "read", grid, str(offset), str(finite)]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    # the program adds one by one, as a running sum does
    assert float(done.stdout) == np.cumsum(values[:finite])[-1]

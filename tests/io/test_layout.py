"""The two layouts of a map: the same numbers, in other places."""

import itertools
from dataclasses import replace

import h5py
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.refusals import refused
from tests.support.study_files import BARE
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.engine.resolve import resolve
from fastlink.engine.sinks import designs_per_block, needs_of
from fastlink.io import checksums
from fastlink.io.layout import Placement
from fastlink.pictures.maps import select

LENGTHS = {"a1": 0.4, "a2": np.linspace(1.0, 1.4, 13), "a3": np.linspace(0.6, 1.0, 7), "a4": 1.0}
SPEEDS = {"omega1": np.array([1.0, 5.0, 25.0])}
#: Grids; the input that only scales leads, or is the last axis.
SPACES = {
    "lengths": fl.grid(**LENGTHS, omega1=2.0),
    "speeds last": fl.grid(**LENGTHS, **SPEEDS),
    "speeds first": fl.grid(**SPEEDS, **LENGTHS),
    "one axis": fl.grid(**LENGTHS | {"a3": 0.8}, omega1=2.0),
    "sample": fl.sobol(50, a1=0.4, a2=(1.0, 1.4), a3=(0.6, 1.0), a4=1.0, omega1=2.0),
}
NAMES = ["omega4_max", "theta4", "omega4_extrema", "grashof_class"]


def sweep(to, space=SPACES["lengths"], **options):
    return fl.sweep(
        "planar_4r",
        space,
        NAMES,
        **{"theta1": 5, "threads": 1, "verify": 0, "to": to, "branch": (1, 2), **options},
    )


def assert_same(found, expected, same_labels=True):
    """Assert that two maps have the same values by name, whatever the order of dimensions, and the same labels."""
    assert set(found) == set(expected)
    for name in expected:
        turned = found[name].transpose(*expected[name].dims)
        assert_array_equal(turned, expected[name], err_msg=name)
        labels = [{key: str(value) for key, value in one.attrs.items()} for one in (turned, expected[name])]
        assert labels[0] == labels[1] or not same_labels
    counts = [name for name in expected.attrs if name.startswith("designs_") and "second" not in name]
    assert {name: found.attrs[name] for name in counts} == {name: expected.attrs[name] for name in counts}


@pytest.mark.sample(2)
@pytest.mark.parametrize("space", SPACES.values(), ids=SPACES)
def test_both_layouts_hold_the_same_numbers(tmp_path, space):
    path = tmp_path / "maps.h5"
    with sweep(None, space, verify=2) as expected:
        for options in ({"verify": 2, "threads": 2}, {"block": 5, "threads": 2}, {"block": 10**6}):
            with sweep(path, space, layout="maps", overwrite=True, **options) as found:
                assert_same(found, expected, "verify" in options)
                assert found.theta4.dims == ("branch", "theta1", *space.dims)
                assert found.omega4_max.dims == ("branch", *space.dims)
                assert found.status.dims == space.dims
                assert fl.check(path)
        kept = sweep(None, space, layout="maps")
        assert [one.dims for one in kept.values()] == [found[name].dims for name in kept]
        assert_same(kept, expected, same_labels=False)


def test_a_map_of_one_position_is_one_piece_of_the_file(tmp_path):
    path = tmp_path / "maps.h5"
    with sweep(path, layout="maps", branch=1) as found:
        picture = found.theta4.isel(theta1=3)
        with h5py.File(path) as file:
            start = file["theta4"].id.get_offset() + 3 * picture.nbytes
        raw = np.frombuffer(path.read_bytes()[start : start + picture.nbytes])
        assert_array_equal(raw.reshape(picture.shape), picture)


def test_a_map_of_the_other_layout_is_refused_by_name(tmp_path):
    path = tmp_path / "m.h5"
    sweep(path).close()
    with refused("to", "overwrite=True"):
        sweep(path, layout="maps")
    with pytest.raises(fl.InputError, match="other layout"):
        sweep(path, layout="maps")
    before = path.stat().st_mtime_ns
    sweep(path).close()
    assert path.stat().st_mtime_ns == before
    sweep(path, layout="maps", overwrite=True).close()
    sweep(path, layout="maps").close()


def test_a_study_and_the_command_line_choose_the_layout(tmp_path):
    study = tmp_path / "study.toml"
    design = "[design]\na1 = 0.4\na2 = {linspace = [1.0, 1.4, 3]}\na3 = 0.8\na4 = 1.0\n"
    study.write_text(
        f'{BARE}{design}[cycle]\ntheta1 = 4\nbranch = [1, 2]\n[output]\nlayout = "maps"\nverify = 0\n'
    )
    with fl.run(study, to=tmp_path / "a.h5") as found:
        assert found.theta4.dims == ("branch", "theta1", "a2")
    with fl.run(study, to=tmp_path / "b.h5", layout="curves") as found:
        assert found.theta4.dims == ("a2", "branch", "theta1")
    study.write_text(study.read_text().replace('"maps"', '"map"'))
    with refused("output.layout", '"curves" or "maps"'):
        fl.run(study, to=tmp_path / "c.h5")
    with refused("layout", "maps"):
        fl.run(study, to=tmp_path / "c.h5", layout="map")
    with refused("layout", "maps"):
        sweep(None, layout="map")
    study.write_text(study.read_text().replace('layout = "map"\n', ""))
    command = ["run", str(study), "--to", str(tmp_path / "c.h5"), "--layout", "maps", "--quiet"]
    assert CliRunner().invoke(app, command).exit_code == 0
    with fl.open(tmp_path / "c.h5") as found:
        assert found.theta4.dims == ("branch", "theta1", "a2")


def test_functions_of_maps_read_both_layouts(tmp_path):
    space = fl.grid(a=np.linspace(4.5, 5.5, 3), b=5.0, c=2.0, d=4.0, rho=1.0, completion=1)
    given = {"input": "sigma", "sigma": np.linspace(3.3, 6.0, 9), "verify": 0, "to": tmp_path / "curves.h5"}
    curves = fl.sweep("focal", space, ["T_x", "T_y"], **{"branch": (1, 2)} | given)
    maps = fl.sweep(
        "focal",
        space,
        ["T_x", "T_y"],
        **{"branch": (1, 2)} | given | {"layout": "maps", "to": tmp_path / "maps.h5"},
    )
    with curves, maps:
        deviations = [fl.focal.T_deviation(one) for one in (maps, curves)]
        assert_array_equal(deviations[0].transpose(*deviations[1].dims), deviations[1])
        best = [one.fastlink.top(4, "T_x").drop_attrs() for one in (maps, curves)]
        assert best[0].equals(best[1])
        again = fl.sweep(
            "focal", maps.fastlink.designs, ["T_x"], input="sigma", sigma=given["sigma"], branch=(1, 2)
        )
        assert_array_equal(again.T_x, curves.T_x)
        drawn = [select(one, "T_x", 1, {"sigma": 4.0}).variable for one in (maps, curves)]
        assert_array_equal(drawn[0].transpose(*drawn[1].dims), drawn[1])


def test_memory_of_blocks_that_are_put_in_order_is_counted():
    space = fl.grid(**LENGTHS | {"a2": np.linspace(1.0, 1.4, 4000)}, omega1=2.0)
    options = {"angles": 360, "positions": {}, "options": ("theta1",)}
    curves = resolve("planar_4r", space, ["theta4", "omega4"], **{"branch": (1, 2)} | options)
    maps = replace(curves, layout="maps")
    longer = designs_per_block(maps, 2) / designs_per_block(curves, 2)
    assert 7 < longer <= 9
    needs = [needs_of(one, 2).buffers for one in (curves, maps)]
    row = 2 * 2 * 360 * 8
    # results of a block, and one of the two in its other order, on each of two threads
    assert needs[1] - needs[0] >= 2 * row * (1.5 * designs_per_block(maps, 2) - designs_per_block(curves, 2))


def test_pieces_and_designs_of_bytes_agree():
    """Each byte of a piece is of the designs that the piece was made for."""
    for rows, values, by_value in itertools.product((1, 2, 7), (1, 3), (False, True)):
        placement = Placement(rows, values, 8, by_value=by_value)
        owner = {}
        for row in range(rows):
            for start, count in placement.pieces(row, row + 1):
                owner |= dict.fromkeys(range(start, start + count), row)
        assert sorted(owner) == list(range(rows * values * 8))
        for start, stop in itertools.combinations(range(0, rows * values * 8 + 1, 4), 2):
            designs = {row for first, last in placement.rows_in(start, stop) for row in range(first, last)}
            assert designs == {owner[byte] for byte in range(start, stop)}
        for start, stop in itertools.combinations(range(rows + 1), 2):
            found = {
                at for first, count in placement.pieces(start, stop) for at in range(first, first + count)
            }
            assert found == {byte for byte, row in owner.items() if start <= row < stop}


def test_checksums_of_many_pieces_are_those_of_one_by_one():
    rng = np.random.default_rng(1)
    data, nbytes = memoryview(rng.bytes(3_000_000)), 3_000_000
    cuts = [0, *sorted(map(int, rng.integers(0, nbytes, 60))), nbytes]
    pieces = [(start, data[start:stop]) for start, stop in itertools.pairwise(cuts)]
    together, one_by_one = {}, {}
    assert len(pieces) > checksums.FEW
    checksums.add(together, checksums.of_pieces(pieces, nbytes))
    for piece in pieces:
        checksums.add(one_by_one, checksums.of_pieces([piece], nbytes))
    assert together == one_by_one

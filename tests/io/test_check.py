"""A byte that changes in a map is found; one that changes in a partial file is computed again."""

from __future__ import annotations

import itertools
import os
import zlib

import h5py
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.io.test_faults import failing_after, sweep
from tests.support.map_files import SPACES, Sample
from tests.support.refusals import refused

import fastlink as fl
from fastlink.io import checksums, partial_file


def test_a_sum_of_pieces_in_any_order_is_the_crc_of_the_block():
    rng = np.random.default_rng(0)
    nbytes = 2 * checksums.BLOCK_BYTES + 12_345
    data = memoryview(rng.bytes(nbytes))
    cuts = [0, *sorted(map(int, rng.integers(0, nbytes, 30))), nbytes]
    pieces = list(itertools.pairwise(cuts))
    rng.shuffle(pieces)
    sums = {}
    for start, stop in pieces:
        checksums.add(sums, checksums.of_pieces([(int(start), data[start:stop])], nbytes))
    expected = [
        zlib.crc32(data[k : k + checksums.BLOCK_BYTES]) for k in range(0, nbytes, checksums.BLOCK_BYTES)
    ]
    assert [sums[k] for k in range(3)] == expected


@pytest.mark.parametrize("space", SPACES.values(), ids=SPACES)
def test_checksums_are_read_without_fastlink(tmp_path, space, small_blocks):
    """As the attribute `algorithm` says."""
    path = Sample(space).save(tmp_path / "m.h5")
    assert fl.check(path)
    whole = bytearray(path.read_bytes())
    with h5py.File(path) as file:
        group = file["checksums"]
        size, names = int(group.attrs["block_bytes"]), group.attrs["variables"].split()
        values = [file[name][()].tobytes() for name in names]
        places = [(file[name].id.get_offset(), file[name].nbytes) for name in names]
        said, rest, at = group["values"][:], group["rest"][0], group["rest"].id.get_offset()
    assert said.tolist() == [zlib.crc32(v[k : k + size]) for v in values for k in range(0, len(v), size)]
    whole[at : at + 4] = bytes(4)
    for offset, nbytes in sorted(places, reverse=True):
        del whole[offset : offset + nbytes]
    assert rest == zlib.crc32(whole)


def test_what_has_changed_is_told(tmp_path, small_blocks):
    path = tmp_path / "m.h5"
    sweep(path).close()
    assert str(fl.check(path)).endswith("is as it was written")
    with h5py.File(path, "r+") as file:
        start = file["theta4"].id.get_offset()
        file["theta4"].attrs["units"] = "deg"
    with open(path, "r+b") as file:
        file.seek(start + 300)
        file.write(b"changed!")
    found = fl.check(path)
    assert not found
    assert (found.damaged, found.rest_is_intact) == ({"theta4": [(32, 63)]}, False)
    assert "values of theta4 have changed, between number 32 and 63" in str(found)


def test_a_file_without_checksums_is_refused(tmp_path):
    path = Sample().save(tmp_path / "m.h5")
    with h5py.File(path, "r+") as file:
        del file["checksums"]
    with refused("m.h5", "write it again"):
        fl.check(path)


# --- partial files ---------------------------------------------------------------------------------


@pytest.fixture
def interrupted(tmp_path, monkeypatch, small_blocks):
    """A partial file of 40 of 64 designs, and the whole map in memory."""
    path = tmp_path / "m.h5"
    with monkeypatch.context() as patch:
        patch.setattr(partial_file, "STEP_SECONDS", 0.0)
        failing_after(patch, 5, KeyboardInterrupt())
        with pytest.raises(KeyboardInterrupt):
            sweep(path)
    with sweep(None) as expected:
        return path, expected.load()


def assert_goes_on(path, expected):
    with sweep(path, verify=0) as found:
        for name in expected:
            assert_array_equal(found[name], expected[name], err_msg=name)
        assert fl.check(path)
        return int(found.attrs.get("designs_of_earlier_runs", 0))


def test_changed_values_of_a_partial_file_are_computed_again(interrupted):
    path, expected = interrupted
    part = path.with_name("m.h5.part")
    with h5py.File(part) as file:
        start = file["theta4"].id.get_offset()
    with open(part, "r+b") as file:
        file.seek(start + 1000)
        file.write(b"changed!")
    with pytest.warns(fl.InputWarning, match="the values of 2 designs have changed; they are computed again"):
        assert assert_goes_on(path, expected) == 38


@pytest.mark.skipif(not os.path.exists("/proc/self/mem"), reason="of Linux")
def test_a_file_that_cannot_be_read_is_refused_in_the_words_of_the_system():
    """HDF5 adds the time and an address, which differ from call to call."""
    with refused("cannot be read (Input/output error)", "give a map that a sweep has written"):
        fl.check("/proc/self/mem")

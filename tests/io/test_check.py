"""A byte that changes in a map is found."""

import itertools
import os
import zlib

import h5py
import numpy as np
import pytest
from tests.io.test_faults import sweep
from tests.support.map_files import SPACES, Sample
from tests.support.refusals import refused

import fastlink as fl
from fastlink.io import checksums


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


@pytest.mark.skipif(not os.path.exists("/proc/self/mem"), reason="of Linux")
def test_a_file_that_cannot_be_read_is_refused_in_the_words_of_the_system():
    """HDF5 adds the time and an address, which differ from call to call."""
    with refused("cannot be read (Input/output error)", "give a map that a sweep has written"):
        fl.check("/proc/self/mem")

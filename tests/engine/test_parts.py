"""A part of a sweep is the same bits in a labelled file of its own."""

import itertools

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_array_equal
from tests.support.four_bar import sweep_4r
from tests.support.part_requests import AXES, REQUESTS, sweep
from tests.support.refusals import refused

import fastlink as fl


def assert_is_part(part, whole, swept):
    """Assert that a part has the results and inputs of its designs in the whole map, and their numbers."""
    start, stop = part.attrs["part_start"], part.attrs["part_stop"]
    assert part.sizes["design"] == stop - start == part.attrs["designs"]
    for name in whole.data_vars:
        values = whole[name].values
        assert part[name].dims == ("design", *whole[name].dims[swept:])
        rows = np.ascontiguousarray(values.reshape(-1, *values.shape[swept:])[start:stop])
        assert_array_equal(part[name].values, rows, err_msg=name)
        assert rows.tobytes() == part[name].values.tobytes()
        assert whole[name].attrs.keys() <= part[name].attrs.keys()
    sizes = [whole.sizes[dim] for dim in whole["status"].dims]
    for name, coord in whole.coords.items():
        if name != "design" and coord.dims and set(coord.dims) <= set(whole["status"].dims):
            axis = whole["status"].dims.index(coord.dims[0])
            values = np.broadcast_to(
                np.expand_dims(coord.values, [k for k in range(len(sizes)) if k != axis]), sizes
            )
            assert_array_equal(part[name].values, values.ravel()[start:stop], err_msg=str(name))
            assert part[name].dims == ("design",)
            assert repr(part[name].attrs) == repr(coord.attrs)
        elif name != "design":
            assert part[name].variable.identical(coord.variable)


@pytest.mark.sample(4)
@pytest.mark.parametrize("of", [of for of in REQUESTS if of != "layout of maps"])
def test_parts_are_those_of_the_whole(of):
    whole = sweep(of)
    swept = whole["status"].ndim
    count = min(5, whole["status"].size)
    parts = [sweep(of, part=(k, count), threads=2) for k in range(1, count + 1)]
    assert parts[0].attrs["part_start"] == 0
    assert [part.attrs["part_start"] for part in parts[1:]] == [
        part.attrs["part_stop"] for part in parts[:-1]
    ]
    assert parts[-1].attrs["part_stop"] == whole["status"].size == parts[0].attrs["whole_designs"]
    assert len({part.attrs["whole_fingerprint"] for part in parts}) == 1
    for part in parts:
        assert_is_part(part, whole, swept)
    if "design" not in whole.coords or whole["status"].dims != ("design",):
        numbers = np.concatenate([part["design"].values for part in parts])
        assert_array_equal(numbers, np.arange(numbers.size))
    else:
        assert_array_equal(np.concatenate([part["design"].values for part in parts]), whole["design"].values)


@pytest.mark.sample(2)
@pytest.mark.parametrize("order", list(itertools.permutations(AXES)))
def test_an_axis_that_only_scales_results_has_the_same_bits_in_parts(order):
    """Rows of a part follow from designs that are evaluated at another speed, perhaps of another part."""
    space = fl.grid(a1=0.4, a4=1.0, **{name: AXES[name] for name in order})
    of = "planar_4r", lambda: space, ["omega4", "omega4_max"], {"theta1": 4}
    whole = sweep(of)
    assert whole.attrs["scaling_axis"] == "omega1"
    for count, block in ((2, None), (16, 4)):
        for k in range(1, count + 1):
            part = sweep(of, part=(k, count), block=block)
            assert part.attrs["scaling_axis"] == "omega1"
            assert_is_part(part, whole, 3)


def test_the_request_of_a_part_is_that_of_its_whole(tmp_path):
    def fingerprints(**options):
        attrs = sweep("grid", **options).attrs
        return attrs["whole_fingerprint"]

    one = fingerprints(part=(1, 3))
    assert (
        one
        == fingerprints(part="2/3", threads=1, block=7)
        == fingerprints(part=(1, 4), to=tmp_path / "a.h5", verify=0)
    )
    assert one != sweep("table", part=(1, 3)).attrs["whole_fingerprint"]
    with sweep("grid", to=tmp_path / "m.h5", verify=0) as whole:
        assert whole.attrs["fingerprint"] == one


@pytest.fixture(scope="module")
def kinds(tmp_path_factory):
    """Return the files of a whole map, of parts, and of what has the same quantities and other designs."""
    folder = tmp_path_factory.mktemp("kinds")
    for part in (None, "1/3", "2/3", "3/3", "2/4"):
        sweep(
            "grid", part=part, to=folder / f"{'whole' if part is None else part.replace('/', ' of ')}.h5"
        ).close()
    sweep("numbered table", part="1/3", to=folder / "other 1 of 3.h5").close()
    space = fl.sobol(7, seed=1, a1=(0.3, 0.5), a2=(1.0, 1.4), a3=0.8, a4=1.0)
    sweep_4r(space, ["theta4"], theta1=6, verify=0, to=folder / "sobol.h5").close()
    return folder


@pytest.mark.sample(3)
@pytest.mark.parametrize(
    ("existing", "asked", "differs"),
    [
        ("whole", "1/3", "a whole map, not part 1/3"),
        ("1 of 3", None, "part 1/3, not a whole map"),
        ("2 of 4", "2/3", "part 2/4, not part 2/3"),
        ("other 1 of 3", "1/3", "a map with other"),
        ("sobol", None, "a map with other"),
        ("other 1 of 3", "join", "part 1/3, not a whole map"),
    ],
)
def test_a_file_of_another_part_or_of_the_whole_is_refused_with_what_it_is(kinds, existing, asked, differs):
    path = kinds / f"{existing}.h5"
    before = path.read_bytes()
    with refused(f"the file exists, {differs}", "overwrite=True"):
        if asked == "join":
            fl.join([kinds / f"{k} of 3.h5" for k in (1, 2, 3)], to=path)
        else:
            sweep("grid", part=asked, to=path)
    assert path.read_bytes() == before


@pytest.mark.parametrize("part", [(0, 3), "4/3", "1/2/3", (True, 2), 3, (1, 2, 3)])
def test_what_is_no_part_is_refused(part):
    with refused("part", "k from 1 to n"):
        sweep("grid", part=part)


def test_a_part_without_designs_is_refused():
    with refused("part", "at most 35 parts"):
        sweep("grid", part=(1, 36))
    with refused("part", "at most 1 part"):
        sweep("one design", part=(1, 2))
    assert sweep("grid", part=(35, 35)).sizes["design"] == 1


@pytest.mark.parametrize("of", ["grid", "sobol", "completions of a numbered table"])
def test_the_netcdf_library_reads_a_part_as_xarray_does(of, tmp_path):
    """The axes of the whole, which have the names of coordinates along the designs, are none of its dimensions."""
    sweep(of, part=(2, 3), to=tmp_path / "part.h5").close()
    with (
        fl.open(tmp_path / "part.h5") as part,
        xr.open_dataset(tmp_path / "part.h5", engine="netcdf4") as other,
    ):
        assert other.sizes == part.sizes
        assert {name: one.dims for name, one in other.variables.items()} == {
            name: one.dims for name, one in part.variables.items()
        }
        assert_array_equal(other.design.values, part.design.values)

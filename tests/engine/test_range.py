"""Designs with a number beyond 2^-80 to 2^80 are refused where they are given alone, and flagged among others."""

import math

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.support.sweeps import TURNING, sweep_4r

import fastlink as fl
from fastlink.errors import InputError
from fastlink.facts.powers import limits
from fastlink.mechanisms import NAMES, catalogue

MOST, LEAST = 2.0**80, 2.0**-80
#: A column of each input whose first, third and last values are allowed, and the others beyond the range.
COLUMNS = {
    "a2": [1.2, MOST, math.nextafter(MOST, 0.0), LEAST, math.nextafter(LEAST, 1.0)],
    "omega1": [0.0, 1e-30, -1e24, -1e300, 1e-24],
    "P_u": [0.0, MOST, 1e-300, -1e100, -3.0],  # a coordinate may be as small as it likes
    "I2": [0.0, 2.0**-240, 1e-60, MOST**2, 0.1],  # kg m2: three powers of units
}
FAR = np.array([False, True, False, True, False])
MASSES = {f"{name}{bar}": 0.1 for bar in (1, 2, 3) for name in "mI"}
MASSES |= {f"G{bar}_{axis}": 0.1 for bar in (1, 2, 3) for axis in "uv"}
GIVEN = TURNING | MASSES | {"P_u": 0.1, "P_v": 0.2}
OUTPUTS = ["status", "F32_max", "omega4_max", "P_x_max", "omega4_extrema_count", "grashof_class"]


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", COLUMNS)
def test_designs_of_a_table_are_flagged_and_the_others_untouched(name):
    values, others = np.array(COLUMNS[name]), {k: v for k, v in GIVEN.items() if k != name}
    found = sweep_4r(fl.table({name: values} | others), OUTPUTS)
    meanings = found.status.attrs["flag_meanings"].split()
    assert_array_equal(found.status == meanings.index("beyond_range"), FAR)
    assert found.attrs["designs_beyond_range"] == 2
    for output in ("F32_max", "omega4_max", "P_x_max"):
        assert np.isnan(found[output].values[FAR]).all()
    function = fl.function("planar_4r", [name], OUTPUTS, branch=(1, 2), **others)
    for k, value in enumerate(values):
        one = sweep_4r(GIVEN | {name: float(value)}, OUTPUTS, allow_invalid=True)
        for output in OUTPUTS:
            assert_array_equal(found[output].values[k], one[output].values, err_msg=output)
        numbers = ["status", "F32_max", "omega4_max", "P_x_max"]
        rows = dict(zip(OUTPUTS, function(values[k : k + 1]), strict=True))
        for output in numbers:
            assert_array_equal(rows[output], one[output].values + np.zeros(2), err_msg=output)
        assert_array_equal(function(values[None])[:, k], function(values[k : k + 1]))
        if FAR[k]:
            with pytest.raises(InputError, match=r"write (0 or )?a magnitude (of|below)"):
                sweep_4r(GIVEN | {name: float(value)}, OUTPUTS)
    given = {"theta1": 1.0, **GIVEN, name: values}
    allowed = fl.evaluate("planar_4r", ["status", "F32"], allow_invalid=True, **given)
    assert_array_equal(allowed["status"], found.status)
    assert_array_equal(np.isnan(allowed["F32"]), found.status != 0)
    with pytest.raises(InputError, match=rf"{name}\[1\] is .* a magnitude (of|below) .*allow_invalid=True"):
        fl.evaluate("planar_4r", ["status"], **given)


def test_designs_of_tables_axes_and_fixed_values_are_flagged(tmp_path):
    speeds = [1e-100, 1.0, 2.0]
    swept = sweep_4r(fl.grid(**TURNING | {"omega1": speeds}), ["omega4_max"])
    assert "scaling_axis" not in swept.attrs
    assert_array_equal(np.isnan(swept.omega4_max).all("branch"), [True, False, False])
    sampled = fl.sobol(a2=(1.0, 2.0**82), n=64, seed=1, **{k: v for k, v in TURNING.items() if k != "a2"})
    found = sweep_4r(sampled, ["omega4_max"])
    assert_array_equal(found.status == 6, found.a2 >= MOST)
    with pytest.raises(InputError, match=r"a1 is 1e-200 .*write a magnitude of 8.3e-25 to 1.2e\+24 m"):
        fl.function("planar_4r", ["a2"], ["omega4_max"], a1=1e-200, a3=0.8, a4=1.0, omega1=25.0)
    with pytest.raises(InputError, match=r"links: density is 1e\+100"):
        sweep_4r(TURNING, ["F32_max"], links=fl.round_bar(density=1e100, radius=0.01))
    table = fl.table(TURNING | {"a2": [1.2, 1e100, 1.3]})
    found = sweep_4r(table, ["omega4_max"], to=tmp_path / "map.h5", verify=3)
    assert found.attrs["verified_designs"] == 2
    assert found.omega4_max.attrs["verify_mismatches"] == 0


@pytest.mark.parametrize("name", NAMES)
def test_each_status_says_so(name):
    mechanism = catalogue(name)
    assert list(mechanism.facts["status"].flags.values()).count("beyond_range") == 1
    assert limits("1", "any") == (0.0, math.inf)

"""Every number of a focal mechanism's design against the same facts with 50 digits, in families easy and hard.

The unit is that of `fastlink.exact`: what one rounding of the result and of each input does. The greatest error seen
stands in docs/focal.md.
"""

from __future__ import annotations

import numpy as np
import pytest

import fastlink as fl
from fastlink.exact import CONTEXT as MP
from fastlink.exact import in_roundings
from focal_designs import CODES, FACTS, FAMILIES, GIVEN, LENGTHS, NUMBERS, exact, facts, family, given_by, one

# The longest chains (the angles) have some forty operations, whose errors mostly average out: 1.9 is the worst seen.
MULTIPLE = 4
# An s of some 1e16 is rounded to where rho is farther from -1 than one double.
KINDS = [(kind, given) for kind in FAMILIES for given in GIVEN if (kind, given) != ("rho next to -1", "s")]
NAMES = {given: [name for name in NUMBERS if name != given] for given in GIVEN}


def errors(designs, given):
    """Return the greatest error of each number in roundings; NaN is where it is with 50 digits."""
    names = NAMES[given]
    exactly = exact(names, given)
    greatest = dict.fromkeys(names, 0.0)
    for completion in (1.0, 2.0):
        found = facts(designs, completion, names, given)
        for i in range(len(designs["a"])):
            at = exactly.at(one(designs, i, completion, given))
            condition = exactly.condition(at, GIVEN[given][0])
            for name in names:
                value = float(found[name][i])
                assert np.isnan(value) == bool(MP.isnan(at[name])), (name, i, completion)
                if not np.isnan(value):
                    greatest[name] = max(greatest[name], in_roundings(value, at[name], condition[name]))
    return greatest


@pytest.mark.parametrize("n", [8, pytest.param(300, marks=pytest.mark.stress)])
@pytest.mark.parametrize(("kind", "given"), KINDS)
def test_every_number_is_a_few_roundings_off(kind, given, n):
    designs = given_by(given, family(kind, np.random.default_rng(n), n))
    greatest = errors(designs, given)
    assert max(greatest.values()) <= MULTIPLE, greatest


@pytest.fixture(scope="module")
def all_kinds():
    rng = np.random.default_rng(2)
    parts = [family(kind, rng, 40) for kind in FAMILIES]
    return {name: np.concatenate([part[name] for part in parts]) for name in (*LENGTHS, "rho")}


@pytest.fixture(scope="module")
def compiled(all_kinds):
    """Kernel results of all kinds of designs, and of the same 2^480 and 2^-480 times as long."""
    sizes = (1.0, 2.0**480, 2.0**-480)
    table = {name: np.concatenate([all_kinds[name] * size for size in sizes]) for name in LENGTHS}
    # those of 1e150 and 1e-150 leave the range of numbers
    table |= {name: np.clip(values, 1e-307, 1e307) for name, values in table.items()}
    found = fl.sweep("focal", fl.table(table | {"rho": np.tile(all_kinds["rho"], 3)}), FACTS, threads=1)
    return found.drop_vars("design", errors="ignore")


def test_the_kernel_has_the_bits_of_the_plain_facts(all_kinds, compiled):
    n = len(all_kinds["a"])
    for completion in (1, 2):
        plain = facts(all_kinds, float(completion))
        for name in FACTS:
            values = compiled[name]
            if "completion" in values.dims:
                values = values.sel(completion=completion)
            np.testing.assert_array_equal(values.values[:n], plain[name], err_msg=name)


def test_a_power_of_two_changes_no_bit(all_kinds, compiled):
    n = len(all_kinds["a"])
    ordinary = np.max([all_kinds[name] for name in LENGTHS], axis=0)
    ordinary = (
        (ordinary > 1e-10) & (ordinary < 1e10) & (np.min([all_kinds[x] for x in LENGTHS], axis=0) > 1e-16)
    )
    for name in FACTS:
        values = compiled[name].transpose("design", ...).values
        length = name not in CODES and compiled[name].attrs["units"] == "m"
        for k, size in ((1, 2.0**480), (2, 2.0**-480)):
            scaled = values[k * n : (k + 1) * n] / (size if length else 1.0)
            np.testing.assert_array_equal(scaled[ordinary], values[:n][ordinary], err_msg=name)
    assert ordinary.sum() > 400

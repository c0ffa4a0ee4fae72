"""Designs of any size: numbers that are ordinary ones do not suffer from what underflows or overflows on the way.

In other units of mass, length and time every number of a design is multiplied by the power of the unit that is in it.
If the units are powers of two, nothing is rounded: the results are those of the first units, exactly, but for those
that no double is near. No tolerance is needed.
"""

from __future__ import annotations

import numpy as np
import pytest
from fastlink.facts.sizes import FAR, UNDERFLOW, dimensions, is_ordinary
from tests.support.precision import in_every_mode, plain
from tests.support.registry import ENTRIES

import fastlink as fl
from fastlink.errors import InputError

#: Exponents of mass, length and time. Moments of inertia stay normal numbers in the first four.
UNITS = [
    (600, -660, 0),
    (100, -500, 0),
    (-100, 500, 0),
    (-600, 660, 0),
    (0, -500, 0),
    (-70, -80, 0),
    (0, 3, 400),
]
MANY_UNITS = [*UNITS, (900, -900, 30), (-900, 900, -100), (500, -700, 60), (-300, 200, 200), (0, -340, 0)]
#: Gaussian elimination chooses its pivots by the sizes of forces and moments, which grow unlike each other.
SIZED = [entry for entry in ENTRIES if entry.solver == "eliminated"]


def power_of(units, unit):
    """Return the exponent of two by which numbers of some units grow."""
    return sum(power * exponent for power, exponent in zip(dimensions(units), unit, strict=True))


def drawn(entry, n):
    """Return n configurations of each family in every mode, in one table, and once more without inertias."""
    tables = [in_every_mode(entry, entry.drawn(kind, 5, n)) for kind in entry.families]
    table = {name: np.concatenate([one[name] for one in tables]) for name in tables[0]}
    inertias = {name: 0.0 * table[name] for name in ("I1", "I2", "I3") if name in table}
    return [table, table | inertias] if inertias else [table]


def in_units(entry, inputs, units):
    """Return configurations in the first units and in others, where these are normal numbers, and the exponents."""
    catalogue = entry.catalogue
    declared = catalogue.known_inputs(catalogue.variants_selected_by(inputs))
    declared = declared | {entry.input: catalogue.position}
    n = len(next(iter(inputs.values())))
    of = {name: "1" if name == "branch" else declared[name].units for name in inputs}
    exponents = np.repeat(np.array(units), n, axis=0).T
    here = {name: np.tile(values, len(units)) for name, values in inputs.items()}
    with np.errstate(over="ignore", under="ignore"):
        there = {name: np.ldexp(values, power_of(of[name], exponents)) for name, values in here.items()}
    normal = np.ones(n * len(units), dtype=bool)
    for name, values in here.items():
        size = np.abs(there[name])
        normal &= (values == 0.0) | ~np.isfinite(values) | ((size >= 2.0**-1022) & (size < np.inf))
    return *({name: values[normal] for name, values in one.items()} for one in (here, there)), exponents[
        :, normal
    ]


def expected_in(entry, name, values, exponents):
    """Return results in other units, and the exponents of these."""
    label = entry.catalogue.public_fact(name)
    power = np.broadcast_to(0 if label.flags else power_of(label.units, exponents), values.shape)
    with np.errstate(over="ignore", under="ignore"):
        return np.ldexp(values, power), power


def compared(entry, names, n, units):
    """Compare quantities in other units with those in the first; return how many numbers were compared."""
    count = 0
    for inputs in drawn(entry, n):
        here, there, exponents = in_units(entry, inputs, units)
        first, found = plain(entry, names, here), plain(entry, names, there)
        for name in names:
            expected, _ = expected_in(entry, name, first[name], exponents)
            np.testing.assert_array_equal(found[name], expected, err_msg=f"{name} of {entry}")
            count += np.count_nonzero(np.isfinite(expected))
    return count


@pytest.mark.sample(5)
@pytest.mark.parametrize("entry", SIZED, ids=str)
def test_units_of_mass_and_length_and_time_change_no_bit(entry):
    assert compared(entry, entry.names, 2, UNITS) > 20 * len(entry.names)


# -- error bounds, derivatives ------------------------------------------------------------------------------------


def made(entry, share):
    """Return every so many quantities with a derivative by one of their inputs, and bounds and trust of all."""
    catalogue, names = entry.catalogue, []
    numbers = [
        name for name in entry.names if not catalogue.public_fact(name).flags and name not in entry.errors
    ]
    inputs = [name for name, one in catalogue.inputs.items() if one.units in ("m", "kg")]
    for k, name in enumerate(numbers[::share]):
        slope = f"d_{name}_d_{inputs[k % len(inputs)]}"
        names += [name, slope] if not length_drives(entry) and exists(catalogue, slope) else [name]
    return names, [of for name in names for of in (f"{name}_error", f"{name}_trust")]


def exists(catalogue, slope):
    """Tell whether a quantity depends on an input at all."""
    try:
        return catalogue.resolve(slope) is not None
    except InputError:
        return False


def length_drives(entry):
    """Tell whether the input position is a length, which all designs share: units of length stay."""
    return dimensions(entry.catalogue.position.units)[1] != 0


def ordinary(entry, inputs):
    """Return those configurations that are evaluated as they are."""
    declared = entry.catalogue.known_inputs(entry.catalogue.variant_inputs)
    sized = [name for name in inputs if name in declared and any(dimensions(declared[name].units))]
    near = [[is_ordinary(value) for value in inputs[name].tolist()] for name in sized]
    # Derivatives of the Minkowskian 4R hold e^(-2 |theta|), which leaves the doubles beyond |theta| = 354.
    near += (
        [np.abs(inputs["theta"]) < 300.0] if entry.mechanism == "minkowski_4r" and "theta" in inputs else []
    )
    return {name: values[np.all(near, axis=0)] for name, values in inputs.items()}


def bounds_compared(entry, share, n, units):
    """Compare quantities, derivatives, error bounds and trust; return how many numbers were compared."""
    (names, bounds), count = made(entry, share), 0
    # Where lengths stay, bounds lose what underflows in them: less than the millionth that each rounding counts more.
    loss = 2.0**-20 if length_drives(entry) else 0.0
    for inputs in drawn(entry, n):
        here, there, exponents = in_units(entry, ordinary(entry, inputs), units)
        first, found = plain(entry, (*names, *bounds), here), plain(entry, (*names, *bounds), there)
        for name in names:
            expected, _ = expected_in(entry, name, first[name], exponents)
            np.testing.assert_array_equal(found[name], expected, err_msg=f"{name} of {entry}")
            count += np.count_nonzero(np.isfinite(expected))
        for name in bounds:
            expected, power = expected_in(entry, name, first[name], exponents)
            if name.endswith("_trust"):  # where the value may have left the normal numbers, it is not trusted
                label = entry.catalogue.public_fact(name.removesuffix("_trust"))
                far = np.abs(np.broadcast_to(power_of(label.units, exponents), expected.shape)) > FAR + 100
                assert np.all(found[name][far] != 0.0), f"{name} of {entry}"
                near = np.abs(power_of(label.units, exponents)) < FAR - 100
                np.testing.assert_array_equal(found[name][near], expected[near], err_msg=f"{name} of {entry}")
            else:
                np.testing.assert_allclose(
                    found[name], expected, loss, 2 * UNDERFLOW, err_msg=f"{name} of {entry}"
                )
                least = 0.5 * UNDERFLOW  # half of it the value, and half the bound has lost
                assert not np.any((found[name] < least) & (power < -FAR)), f"{name} of {entry}"
            count += np.count_nonzero(np.isfinite(expected))
    return count


@pytest.mark.sample(5)
@pytest.mark.parametrize("entry", SIZED, ids=str)
def test_units_change_no_bit_of_derivatives_and_error_bounds(entry):
    assert bounds_compared(entry, 5, 1, UNITS) > 20


@pytest.mark.stress
@pytest.mark.parametrize("entry", SIZED, ids=str)
def test_many_units_change_no_bit(entry):
    assert compared(entry, entry.names, 200, MANY_UNITS) > 2000 * len(entry.names)
    assert bounds_compared(entry, 1, 40, MANY_UNITS) > 2000


def of_inertias(size, mass):
    """Return extremes of a crank of links with moments of inertia of 1 kg m2, and their bounds."""
    lengths = {
        name: value * size
        for name, value in zip(("a1", "a2", "a3", "a4"), (0.5, 1.5, 1.0, 1.25), strict=True)
    }
    bars = {f"{name}{bar}": value for bar in (1, 2, 3) for name, value in (("m", mass), ("I", 1.0))}
    centres = {f"G{bar}_{axis}": 0.0 for bar in (1, 2, 3) for axis in "uv"}
    names = ["F41_max", "F41_max_error", "F41_extrema", "F41_extrema_error", "P_x_max", "P_x_max_error"]
    space = fl.grid(**lengths, **bars, **centres, omega1=1.0, P_u=[size, 2.0**300 * size], P_v=0.0)
    return fl.sweep("planar_4r", space, names, branch=1, progress=False)


@pytest.mark.stress
def test_extremes_of_forces_are_found_however_great_inertias_are():
    """Squares of such forces overflow. Of masses 2^-860 of the inertias nothing is left in them."""
    far, near = of_inertias(2.0**-430, 1.0), of_inertias(1.0, 0.0)
    for name in ("F41_max", "F41_extrema"):
        error = f"{name}_error"
        same, off = np.ldexp(near[name], 430), far[error] + np.ldexp(near[error], 430)
        np.testing.assert_array_equal(np.isnan(far[name]), np.isnan(same))
        assert (np.isnan(off) | (abs(far[name] - same) <= off)).all()
    assert np.isfinite(near["F41_max_error"][0])
    # a point that is farther out than squares of doubles reach has extremes without bounds
    np.testing.assert_array_equal(np.isinf(far["P_x_max_error"]), [False, True])
    np.testing.assert_array_equal(np.isinf(near["P_x_max_error"]), [False, True])

"""Greatest and least values of what chooses, takes sizes or magnitudes: none of dense samples is beyond them."""

import numpy as np
import pytest

import fastlink as fl
from fastlink.facts.expression import GraphAsWritten, generate_formula
from fastlink.facts.formula import Formula
from fastlink.facts.own import split
from fastlink.numerics.vectors import absolute, choice

FUNCTIONS = (absolute, choice)
mine = fl.extend("planar_4r")


@mine.quantity(units="N")
def lesser(F21, F41):
    return min(F21, F41)


@mine.quantity(units="N")
def apart(F21, F41):
    return abs(F21 - 2 * F41)


@mine.quantity(units="N")
def nested(lesser, F32_x, F32_y):
    size = np.hypot(F32_x, F32_y)
    return max(lesser, size / 2) - min(size, lesser)


@mine.quantity(units="N")
def joint(F32_x, F32_y, F21):
    return np.hypot(F32_x, F32_y) + F21


BARS = fl.round_bar(density=7750.0, radius=0.01)
NAMES = [f"{name}_{how}" for name in ("lesser", "apart", "nested") for how in ("min", "max")]
#: The forces on the crank almost vanish close to where they are equal: both kinks and two extremes in one cell.
#: At the second both turn sharply near theta1 = 0.03, where their difference has three extremes within 0.015 rad.
KNOWN = {"a1": [0.25050164, 0.499595358], "a2": [1.25901682, 0.969889661], "a3": [0.51193397, 1.085353234]}


def check(names, count, samples, bounds=True):
    space = fl.sobol(count, {"a1": (0.1, 0.5), "a2": (0.8, 1.3), "a3": (0.5, 1.2)}, seed=7)
    columns = {name: np.append(values, KNOWN[name]) for name, values in space.at(np.arange(count)).items()}
    designs = fl.table(columns).with_constants({"a4": 1.0, "omega1": 25.0})
    given = {"links": BARS, "progress": False}
    errors = [f"{name}_error" for name in names] if bounds else []
    maps = fl.sweep(mine, designs, [*names, *errors], **{"branch": (1, 2)} | given)
    angles = np.linspace(-np.pi, np.pi, samples)
    quantities = list(dict.fromkeys(name.rpartition("_")[0] for name in names))
    curves = fl.sweep(mine, designs, quantities, **{"branch": (1, 2)} | given, theta1=angles)
    for name in names:
        quantity, _, how = name.rpartition("_")
        sign = 1.0 if how == "max" else -1.0
        best = (sign * curves[quantity]).max("theta1")
        # a sample is off by its own rounding, which the bound of the extreme next to it is of too: twice that; without
        # bounds by less than 1e-10 of the greatest value, far below what was missed once (4e-8 and 5e-5 of it)
        off = 2.0 * maps[f"{name}_error"] if bounds else 1e-10 * abs(curves[quantity]).max("theta1")
        beyond = best - sign * maps[name] - off
        assert not (beyond > 0.0).any(), (name, np.argwhere((beyond > 0.0).values))


def test_none_of_dense_samples_is_beyond_an_extreme():
    check([*NAMES[:2], "apart_min"], 12, 8001, bounds=False)


@pytest.mark.stress
def test_a_magnitude_that_nothing_else_computes_is_searched():
    """Its slope is multiplied by it, and neither the slope nor the quantity is computed from it by its name."""
    check(["joint_min", "joint_max"], 4, 2001)


@mine.quantity(units="rad2 s-2")
def drag(omega2, omega4):
    return 1e6 * omega4 * abs(omega4) - omega2 * abs(omega2)


@mine.quantity(units="rad s-1")
def lower(omega2, omega4):
    return min(omega2, 1e3 * abs(omega4))


@mine.quantity(units="rad s-1")
def wide(omega2, omega4):
    return max(omega2, omega4) - min(omega4, omega2)  # two kinks in one place


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["drag", "lower", "wide"])
def test_lists_hold_the_extremes_beside_kinks(name):
    """Next to a dead point of the output link a thousandth of a cell may hold two or three of them."""
    rng = np.random.default_rng(3)
    columns = {"a1": (0.1, 0.3), "a2": (0.9, 1.1), "a3": (0.7, 1.1)}
    columns = {length: rng.uniform(*ends, 12) for length, ends in columns.items()}
    columns |= {"a4": np.ones(12), "omega1": np.full(12, 2.5)}
    given = {"branch": 1, "progress": False}
    maps = fl.sweep(
        mine, fl.table(columns), [f"{name}_extrema", "theta4_extrema"], **{"branch": (1, 2)} | given
    )
    beside = np.geomspace(1e-9, 1e-2, 81)
    for k, dead in enumerate(maps["theta1_at_theta4_extrema"].values[:, :2]):
        near = (dead[:, None] + np.concatenate([-beside, [0.0], beside])).ravel()
        angles = np.unique(np.concatenate([np.linspace(0.0, 2.0 * np.pi, 4000, endpoint=False), near]))
        design = fl.table({length: values[k : k + 1] for length, values in columns.items()})
        values = fl.sweep(mine, design, [name], **{"branch": (1, 2)} | given, theta1=angles)[
            name
        ].values.ravel()
        rises = np.sign(np.diff(values, append=values[0]))
        rises = rises[rises != 0.0]
        assert maps[f"{name}_extrema_count"][k] == (rises != np.roll(rises, 1)).sum(), k


@pytest.mark.stress
def test_none_of_many_is_beyond_an_extreme():
    check(NAMES, 1000, 8001)


def values_of(parameters, *lines, kinked=()):
    """Return what vanishes at the kinks of a formula and its smooth values, as texts."""
    graph = GraphAsWritten(FUNCTIONS)
    root = graph.read(Formula("f", parameters, lines), [*map(graph.name, parameters)])
    found = split(graph, root, dict(kinked))
    return [["; ".join(generate_formula("f", graph, one, {}).lines) for one in values] for values in found]


def test_a_text_is_split_at_its_kinks():
    switches, pieces = values_of(
        "xy", "a = absolute(x)", "return a * choice(y != y, y, choice(y > 1.0, y, 1.0))"
    )
    assert sorted(switches) == ["return x", "return y - 1.0"]
    assert sorted(pieces) == ["return -x * 1.0", "return -x * y", "return x * 1.0", "return x * y"]
    assert values_of("x", "return x * x") == [[], []]
    # a parameter with kinks of its own is replaced by what it is between these
    _, inner = values_of("x", "return x + 1.0", kinked={"x": ("x_piece0", "F21")})
    assert inner == ["return x_piece0 + 1.0", "return F21 + 1.0"]
    _, beside = values_of("xy", "return x + y", kinked={"x": ("y", "z")})
    assert beside == ["return y + y", "return z + y"]
    # one kink in two lines is one, and what nothing is made of has none
    assert values_of("xy", "a = absolute(y)", "return absolute(x) + absolute(x)")[0] == ["return x"]

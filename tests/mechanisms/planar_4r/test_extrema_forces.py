"""Every extremum of forces, moments and torque, against dense samples refined by golden sections."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from tests.support.configurations import LENGTHS, LOADS, PLANAR, all_loads, masses_and_points
from tests.support.extrema_families import FAMILIES, names_of
from tests.support.extrema_rules import TURN

import fastlink as fl
from fastlink.facts.evaluate import read_facts
from fastlink.numerics.compensated import UNIT_ROUNDING

QUANTITIES = ("shaking_force", "shaking_moment", "T41", "F41", "F21", "F32", "F43")
#: What the short run asks for of each kind of links: a kernel of all takes long to compile.
SOME = {"round bars": ("shaking_force", "shaking_moment"), "anywhere": ("T41", "F32"), "loaded": ("F43",)}
SAMPLES = 20_000
GOLDEN = (np.sqrt(5) - 1) / 2


# What the links are: their inputs, their model, and the sets of facts that these choose.
MASSES = {
    "round bars": lambda rng, n: ({"omega1": np.full(n, 25.0)}, fl.round_bar(7750.0, 0.01), ("round_bar",)),
    "anywhere": lambda rng, n: (masses_and_points(rng, n), None, ()),
    "loaded": lambda rng, n: (masses_and_points(rng, n) | all_loads(rng, n), None, LOADS),
}


def values_at(quantity: str, inputs: dict, links, branch, theta1: np.ndarray) -> np.ndarray:
    return np.asarray(
        fl.evaluate("planar_4r", [quantity], branch=branch, links=links, theta1=theta1, **inputs)[quantity]
    )


def brute_force(inputs: dict, links, quantities) -> dict[str, list[np.ndarray]]:
    """Return design, branch, kind, value and theta1 of every local extremum that dense samples show."""
    uniform = np.arange(SAMPLES) * (TURN / SAMPLES)
    # Extrema crowd towards 0 and pi near change points: equal steps of log tan(theta1/2) in addition.
    half = 2 * np.arctan(np.exp(np.linspace(-12, 12, SAMPLES // 4)))
    theta1 = np.unique(np.concatenate([uniform, half, TURN - half]))
    curves = fl.sweep("planar_4r", fl.table(inputs), quantities, links=links, theta1=theta1)
    shown = {}
    for quantity in quantities:
        curve = curves[quantity].values
        before, after = np.roll(curve, 1, axis=-1), np.roll(curve, -1, axis=-1)
        kind = np.where((curve > before) & (curve > after), 1, 0)
        kind -= np.where((curve < before) & (curve < after), 1, 0)
        design, branch, sample = np.nonzero(kind)
        low = np.where(sample == 0, theta1[-1] - TURN, theta1[sample - 1])
        high = np.where(sample == theta1.size - 1, TURN, theta1[(sample + 1) % theta1.size])
        sign = kind[design, branch, sample]
        one = {name: column[design] for name, column in inputs.items()}
        place = golden_section(lambda t: sign * values_at(quantity, one, links, branch + 1, t), low, high)  # noqa: B023
        shown[quantity] = [
            *(design, branch, sign),
            *(values_at(quantity, one, links, branch + 1, place), place % TURN),
        ]
    return shown


def golden_section(f, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return where f is greatest between low and high, elementwise, to the square root of the rounding."""
    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_left, at_right = f(left), f(right)
    # The interval shrinks by 0.618 a step: 30 steps take 6e-4 to 3e-10.
    for _ in range(30):
        up = at_right > at_left
        low, high = np.where(up, left, low), np.where(up, high, right)
        left, right = (
            np.where(up, right, high - GOLDEN * (high - low)),
            np.where(up, low + GOLDEN * (high - low), left),
        )
        fresh = f(np.where(up, right, left))
        at_left, at_right = np.where(up, at_right, fresh), np.where(up, fresh, at_left)
    return (low + high) / 2


def is_extremum(quantity: str, one: dict, links, variants, branch: int, theta1: float, kind: int) -> bool:
    """Return whether the derivative changes its sign as it should within 1e-9 rad of theta1, by 50 digits."""
    values = one | (dict(links.values) if links is not None else {})
    with mp.workdps(50):
        given = {name: mp.mpf(float(value)) for name, value in values.items()} | {"branch": mp.mpf(branch)}

        def f(theta):
            return read_facts(PLANAR, [quantity], given | {"theta1": theta}, variants)[quantity]

        step, h = mp.mpf(10) ** -9, mp.mpf(10) ** -20
        slopes = [f(place + h) - f(place - h) for place in (mp.mpf(theta1) - step, mp.mpf(theta1) + step)]
    return kind * slopes[0] > 0 > kind * slopes[1]


def designs(family: str, masses: str, n: int, seed: int) -> tuple[dict, fl.Links | None, tuple[str, ...]]:
    rng = np.random.default_rng(seed)
    inputs = dict(zip(LENGTHS, FAMILIES[family](rng, n), strict=True))
    others, links, variants = MASSES[masses](rng, n)
    return inputs | others, links, variants


@pytest.mark.sample(3)
@pytest.mark.parametrize("n", [9, pytest.param(120, marks=pytest.mark.stress)])
@pytest.mark.parametrize("family", ["crank", "drag-link", "non-Grashof"])
@pytest.mark.parametrize("masses", MASSES)
def test_every_local_extremum_of_dense_samples_is_found(family, masses, n):
    inputs, links, variants = designs(family, masses, n, 60)
    quantities = SOME[masses] if n < 100 else QUANTITIES
    result = fl.sweep("planar_4r", fl.table(inputs), [f"{q}_extrema" for q in quantities], links=links)
    shown = brute_force(inputs, links, quantities)
    for quantity in quantities:
        value, theta1, count, kind = (result[name].values for name in names_of(quantity))
        matched = np.zeros(kind.shape, dtype=bool)
        for i, k, sign, seen, place in zip(*shown[quantity], strict=True):
            about = f"{quantity}, {family}, {masses}, design {i}, branch {k + 1}, theta1 {place}"
            same = kind[i, k] == sign
            assert np.any(same), about
            distance = np.where(same, np.abs((theta1[i, k] - place + np.pi) % TURN - np.pi), np.inf)
            j = int(np.argmin(distance))
            # Between two samples there is no other one.
            assert distance[j] <= 2 * TURN / SAMPLES, about
            # A golden section stops within sqrt(rounding) of the place, where values are right to rounding: mostly that
            # of terms no more than 1e3 times larger than the extrema. Next to the toggles of non-Grashof linkages terms
            # are larger: there both values keep to the bound, and so do the two that the section took for alike.
            size = np.max(np.abs(value[i, k, : count[i, k]]))
            if abs(value[i, k, j] - seen) > 1e3 * UNIT_ROUNDING * size:
                one = {name: column[i] for name, column in inputs.items()}
                bound = values_at(f"{quantity}_error", one, links, k + 1, place)
                assert abs(value[i, k, j] - seen) <= 4 * bound, about
            matched[i, k, j] = True
        # What samples do not show are pairs closer than a step: true extrema all the same.
        for i, k, j in zip(*np.nonzero((kind != 0) & ~matched), strict=True):
            one = {name: column[i] for name, column in inputs.items()}
            about = f"{quantity}, {family}, {masses}, design {i}, branch {k + 1}, theta1 {theta1[i, k, j]}"
            assert is_extremum(quantity, one, links, variants, k + 1, theta1[i, k, j], kind[i, k, j]), about


@pytest.mark.parametrize("masses", MASSES)
def test_places_are_stationary_to_50_digits(masses):
    inputs, links, variants = designs("crank", masses, 2, 61)
    result = fl.sweep("planar_4r", fl.table(inputs), [f"{q}_extrema" for q in SOME[masses]], links=links)
    tested = 0
    for quantity in SOME[masses]:
        _, theta1, count, kind = (result[name].values for name in names_of(quantity))
        for i in range(2):
            one = {name: column[i] for name, column in inputs.items()}
            for k in range(2):
                for j in range(count[i, k]):
                    assert is_extremum(quantity, one, links, variants, k + 1, theta1[i, k, j], kind[i, k, j])
                    tested += 1
    assert tested >= 8


@pytest.mark.parametrize("masses", MASSES)
def test_extremes_over_the_cycle_are_those_of_the_extrema(masses):
    inputs, links, _ = designs("crank", masses, 100, 62)
    for quantity in SOME[masses][:1]:
        names = [f"{quantity}_max", f"{quantity}_min"]
        places = [f"theta1_at_{name}" for name in names]
        result = fl.sweep(
            "planar_4r", fl.table(inputs), [*names, *places, f"{quantity}_extrema"], links=links
        )
        value, theta1 = result[f"{quantity}_extrema"].values, result[f"theta1_at_{quantity}_extrema"].values
        for sign, name, place in zip((1, -1), names, places, strict=True):
            best = np.nanargmax(sign * value, axis=2)[:, :, None]
            np.testing.assert_array_equal(result[name], np.take_along_axis(value, best, 2)[:, :, 0])
            np.testing.assert_array_equal(result[place], np.take_along_axis(theta1, best, 2)[:, :, 0])


def test_forces_grow_without_bound_at_a_toggle():
    inputs, links, _ = designs("non-Grashof", "round bars", 50, 63)
    asked = [
        "shaking_force_max",
        "theta1_at_shaking_force_max",
        "shaking_force_min",
        "theta1_low",
        "theta1_high",
    ]
    result = fl.sweep("planar_4r", fl.table(inputs), asked, links=links)
    np.testing.assert_array_equal(result.shaking_force_max, np.inf)
    place = result.theta1_at_shaking_force_max.values
    toggles = np.stack([result.theta1_low, result.theta1_high], axis=-1)[:, None, :]
    distance = np.abs(np.minimum(place, TURN - place)[:, :, None] - toggles)
    assert np.all(distance.min(axis=-1) <= 8 * UNIT_ROUNDING * TURN)
    assert np.all(np.isfinite(result.shaking_force_min))


def test_the_greatest_shaking_force_of_table_1():
    """2512.318 N at 0.1096 rad (docs/errata.md), not the printed 56.9764 N."""
    result = fl.sweep(
        "planar_4r",
        fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0),
        ["shaking_force_max", "theta1_at_shaking_force_max"],
        links=fl.round_bar(7750.0, 0.01),
        branch=2,
    ).squeeze()
    assert float(result.shaking_force_max) == pytest.approx(2512.318, abs=5e-4)
    assert float(result.theta1_at_shaking_force_max) == pytest.approx(0.1096, abs=5e-5)


def test_without_speed_forces_have_no_extremum():
    inputs, links, _ = designs("crank", "round bars", 5, 64)
    inputs["omega1"] = np.zeros(5)
    asked = [f"{quantity}_{which}" for quantity in SOME["round bars"] for which in ("extrema", "max", "min")]
    result = fl.sweep("planar_4r", fl.table(inputs), asked, links=links)
    for quantity in SOME["round bars"]:
        assert not np.any(result[f"{quantity}_extrema_count"]), quantity
        assert np.all(result[f"{quantity}_max"] == 0), quantity
        assert np.all(result[f"{quantity}_min"] == 0), quantity

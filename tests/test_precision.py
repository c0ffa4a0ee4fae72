"""Compiled quantities against the same facts with 50 digits, over easy and hard configurations.

A sum of |x df/dx| over the inputs, times the unit rounding, is what rounding the inputs alone does to f
(`configurations.condition_sums`). The facts are short chains of operations that do not cancel, so the error
of the computed f must be a small multiple of that; MULTIPLE holds for every quantity and family.
"""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

import fastlink as fl
from configurations import (
    LENGTHS,
    PLANAR,
    UNIT,
    condition_sums,
    masses_and_points,
    near_change_point,
    near_toggle,
    random_lengths,
    reference,
)

# The longest chain (T41) has about 40 operations; their errors mostly average out: 1.9 is the worst seen.
MULTIPLE = 4
# By LU of the 9x9 (of growth factor below 4) the worst seen is 4.6.
MULTIPLE_DENSE = 16

# Residuals are nothing but errors; facts of the design alone have their own tests (test_classes.py).
QUANTITIES = [name for name in PLANAR.public if PLANAR.varies(name) and "residual" not in name]
# What the crank alone determines is there though the loop does not close.
OF_THE_CRANK = ("A_x", "A_y", "joint_angle_1", "v1")
REACTIONS = ["F41_x", "F41_y", "F21_x", "F21_y", "F32_x", "F32_y", "F43_x", "F43_y", "T41", "shaking_moment"]


def compiled(names, inputs, theta, **options):
    """Return curves (design, branch) at one input angle each, by one sweep per angle."""
    rows = []
    for i, t in enumerate(theta):
        one = fl.grid(**{name: float(values[i]) for name, values in inputs.items()})
        result = fl.sweep("planar_4r", one, names, theta1=[float(t)], threads=1, **options)
        rows.append({name: result[name].values[:, 0] for name in names})
    return rows


def assert_within(names, inputs, theta, multiple, alternatives=(), **options):
    rows = compiled(names, inputs, theta, **options)
    tested = 0
    for i, row in enumerate(rows):
        for k, branch in enumerate((1, 2)):
            one = {name: values[i] for name, values in inputs.items()} | {
                "theta1": theta[i],
                "branch": branch,
            }
            exact = reference(["sigma", *names], one, alternatives)
            if mp.isnan(exact["sigma"]):
                assert all(np.isnan(row[name][k]) for name in names if name not in OF_THE_CRANK)
                continue
            sums = condition_sums(names, one, alternatives)
            for name in names:
                error = abs(mp.mpf(float(row[name][k])) - exact[name])
                assert error <= multiple * UNIT * (sums[name] + abs(exact[name])), (name, i, branch)
            tested += 1
    return tested


def family(kind, rng, n):
    if kind == "random":
        return random_lengths(rng, n), rng.uniform(-np.pi, np.pi, n)
    name, _, size = kind.partition(" ")
    return {"gap": near_change_point, "toggle": near_toggle}[name](rng, n, float(size))


FAMILIES = ["random", "gap 1e-4", "gap 1e-8", "gap 1e-13", "toggle 1e-3", "toggle 1e-6", "toggle 1e-9"]


@pytest.mark.parametrize("n", [30, pytest.param(600, marks=pytest.mark.stress)])
@pytest.mark.parametrize("kind", FAMILIES)
def test_every_quantity_is_a_few_roundings_off(kind, n):
    rng = np.random.default_rng(n)
    lengths, theta = family(kind, rng, n)
    inputs = dict(zip(LENGTHS, lengths, strict=True)) | masses_and_points(rng, n)
    assert assert_within(QUANTITIES, inputs, theta, MULTIPLE) > n


@pytest.mark.parametrize("kind", ["random", "toggle 1e-6"])
def test_the_dense_solve_is_backward_stable(kind):
    rng = np.random.default_rng(23)
    n = 25
    lengths, theta = family(kind, rng, n)
    inputs = dict(zip(LENGTHS, lengths, strict=True)) | masses_and_points(rng, n)
    assert assert_within(REACTIONS, inputs, theta, MULTIPLE_DENSE, ("dense",), solver="dense") > n // 2


@pytest.mark.parametrize("offset", [1e-3, 1e-6, 1e-9])
def test_near_a_toggle_nothing_is_lost_though_the_condition_number_explodes(offset):
    """Relative to the lengths and angle as given, a toggle costs no digit at all."""
    rng = np.random.default_rng(24)
    n = 60
    lengths, theta = near_toggle(rng, n, offset)
    names = ["transmission_angle", "omega2", "omega4", "alpha2", "alpha4"]
    inputs = dict(zip(LENGTHS, lengths, strict=True)) | {"omega1": np.full(n, 25.0)}
    errors = []
    for i, row in enumerate(compiled(names, inputs, theta)):
        one = {name: values[i] for name, values in inputs.items()} | {"theta1": theta[i], "branch": 2}
        exact = reference(names, one)
        if not mp.isnan(exact["omega4"]):
            errors.append(
                [float(abs(row[name][1] - exact[name]) / abs(exact[name])) / UNIT for name in names]
            )
    assert len(errors) > n // 2
    # Twelve operations on factors that are right to a rounding each; the naive form is off by 0.1/offset units.
    assert np.median(errors, axis=0).max() <= 4
    assert np.max(errors) <= 40

"""Circuits of declared linkages against a walk along the curve of their configurations."""

import numpy as np
import pytest
from tests.mechanisms.linkages.declared import SIX_BAR, six_bars
from tests.support.refusals import refused

import fastlink as fl

ENDS = ["theta_low", "theta_high", "theta_low_by", "theta_high_by"]


def e(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def cross(u, v):
    return float(u[0] * v[1] - u[1] * v[0])


def pins(q, at):
    """Return the pins of the six-bar by its crank angle and the directions of its bars."""
    theta, of_ab, of_db, of_pf, of_gf = q
    a, d, g = at["a1"] * e(theta), np.array([at["a4"], 0.0]), np.array([at["G_x"], at["G_y"]])
    p = a + at["P_u"] * e(of_ab) + at["P_v"] * e(of_ab + np.pi / 2)
    ends = {"B": a + at["a2"] * e(of_ab), "B'": d + at["a3"] * e(of_db)}
    return {
        "A": a,
        "D": d,
        "G": g,
        "P": p,
        **ends,
        "F": p + at["a5"] * e(of_pf),
        "F'": g + at["a6"] * e(of_gf),
    }


def open_by(q, at):
    """Return by how much both loops are open."""
    found = pins(q, at)
    return np.concatenate([found["B"] - found["B'"], found["F"] - found["F'"]])


def branch_of(q, at):
    """Return the branch of a configuration."""
    f = pins(q, at)
    left_of_ad = cross(f["D"] - f["A"], f["B"] - f["A"]) > 0
    return 1 + int(left_of_ad) + 2 * int(cross(f["G"] - f["P"], f["F"] - f["P"]) > 0)


def matrix(q, at):
    """Return the derivatives of the loops by the angles."""
    turned = [e(angle + np.pi / 2) for angle in q]
    crank, none = at["a1"] * turned[0], np.zeros(2)
    point = at["P_u"] * turned[1] - at["P_v"] * e(q[1])
    first = [crank, at["a2"] * turned[1], -at["a3"] * turned[2], none, none]
    second = [crank, point, none, at["a5"] * turned[3], -at["a6"] * turned[4]]
    return np.concatenate([np.array(first).T, np.array(second).T])


def walked(q, at):
    """Return the branches of all configurations that can be reached from one, along the curve that they are."""
    start, direction, seen = q, np.zeros(5), set()
    for k in range(20_000):
        seen.add(branch_of(q, at))
        loops = matrix(q, at)
        tangent = np.array([(-1) ** n * np.linalg.det(np.delete(loops, n, axis=1)) for n in range(5)])
        tangent /= np.linalg.norm(tangent)
        direction = tangent if tangent @ direction >= 0 else -tangent
        q = q + 0.02 * direction
        for _ in range(3):
            q = q - np.linalg.pinv(matrix(q, at)) @ open_by(q, at)
        apart = q - start
        if k > 10 and np.linalg.norm(apart - 2 * np.pi * np.round(apart / (2 * np.pi))) < 0.015:
            return seen
    raise AssertionError("the walk does not come back")


@pytest.mark.parametrize(("count", "seed"), [(2, 5), pytest.param(60, 8, marks=pytest.mark.stress)])
def test_circuits_are_what_a_walk_comes_through(count, seed):
    designs = six_bars(count, seed)
    maps = fl.sweep(SIX_BAR, designs | {"omega": 1.0}, ENDS, branch=(1, 2, 3, 4))
    circuits, checked = maps.fastlink.circuits().values, 0
    low, high = maps.theta_low.values, maps.theta_high.values
    for i in range(count):
        at = {name: float(of[i]) for name, of in designs.items()}
        widths = (high - low)[i][circuits[i] > 0] % (2 * np.pi)
        if (widths < 0.1).any():
            continue  # of a range that is shorter than some steps a walk may miss the ends
        for circuit in range(1, circuits[i].max() + 1):
            branch, n = np.argwhere(circuits[i] == circuit)[0]
            theta = (
                1.0
                if np.isnan(low[i, branch, n])
                else low[i, branch, n] + 0.5 * ((high - low)[i, branch, n] % (2 * np.pi))
            )
            names = ["angle_AB", "angle_DB", "angle_PF", "angle_GF"]
            found = fl.evaluate(SIX_BAR, names, branch=int(branch) + 1, theta=theta, omega=1.0, **at)
            seen = walked(np.array([theta, *(float(found[name]) for name in names)]), at)
            assert seen == {int(b) + 1 for b in np.argwhere(circuits[i] == circuit)[:, 0]}, (i, circuit)
            checked += 1
    assert checked > 0.8 * count


def test_maps_without_their_ends_or_branches_are_refused():
    designs = six_bars(3, 5) | {"omega": 1.0}
    with refused("has no theta_low_by", "theta_high_by, in all its branches"):
        fl.sweep(SIX_BAR, designs, ENDS[:2], branch=(1, 2, 3, 4)).fastlink.circuits()
    with refused("has not all branches", "branch=(1, 2, 3, 4)"):
        fl.sweep(SIX_BAR, designs, ENDS, branch=(1, 2)).fastlink.circuits()

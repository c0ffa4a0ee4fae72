"""Alt's problem: the four problems of Wampler, Morgan, Sommese (1992), random linkages, the general instance."""

import numpy as np
import pytest
from benchmarks.synthesis_instance import remake

import fastlink as fl
from fastlink.synthesis import nine_points

POINTS = {
    1: [(0.8961867, -0.09802917), (1.2156535, -1.18749100), (1.5151435, -0.85449808), (1.6754775, -0.48768058),
        (1.7138690, -0.30099232), (1.7215236, 0.03269953), (1.6642029, 0.33241088), (1.4984171, 0.74435576),
        (1.3011834, 0.92153806)],
    2: [(0.0, 0.0), (0.3, -0.1), (0.7, 0.0), (0.82, 0.2), (0.9, 0.4), (0.9, 0.7), (0.6, 0.7), (0.1, 0.5), (0.0, 0.3)],
    3: [(0.25, 0.0), (0.52, 0.1), (0.8, 0.7), (1.2, 1.0), (1.4, 1.3), (1.1, 1.48), (0.7, 1.4), (0.2, 1.0),
        (0.02, 0.4)],
    4: [(1.0, 0.875), (0.75, 0.625), (0.5, 0.375), (0.25, 0.125), (0.0, 0.0), (0.96824583, 1.32287565),
        (1.56124949, 1.7320508), (1.85404962, 1.93649167), (1.98431348, 2.0)],
}  # fmt: skip


def misses(unknowns, points):
    """Return how far real linkages pass from nine points, over their size, by the facts of the mechanism alone."""
    x, a, y, b = (unknowns[:, k, None] for k in range(4))
    turns = np.concatenate([np.ones((len(x), 1)), unknowns[:, 8:]], axis=1)
    d = points - points[0]
    ground, coupler = b - a, y - x
    crank, bar = d + x * turns - a, (coupler * turns)
    inputs = {"a1": abs(x - a), "a2": abs(coupler), "a3": abs(y - b), "a4": abs(ground)}
    inputs |= {"P_u": (-x / coupler * abs(coupler)).real, "P_v": (-x / coupler * abs(coupler)).imag}
    unit = ground / abs(ground)
    # branch 2: B to the left of the line from A to D
    branch = np.where((np.conj(ground - crank) * bar).imag > 0.0, 2, 1)
    theta1 = np.angle(crank / unit)
    broadcast = {name: np.broadcast_to(one, theta1.shape).ravel() for name, one in inputs.items()}
    at = {
        k: fl.evaluate("planar_4r", ["P_x", "P_y"], branch=k, theta1=theta1.ravel(), **broadcast)
        for k in (1, 2)
    }
    p_x, p_y = (np.where(branch.ravel() == 2, at[2][name], at[1][name]) for name in ("P_x", "P_y"))
    off = abs(a + unit * (np.asarray(p_x) + 1j * np.asarray(p_y)).reshape(theta1.shape) - d)
    return (
        off / max(1.0, abs(d).max()) / np.maximum(1.0, abs(unknowns[:, :4]).max(axis=1, keepdims=True))
    ).max()


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("number", "found", "real"), [(1, 1442, 21), (2, 1442, 45), (3, 1442, 64), (4, 1438, 63)]
)
def test_every_triple_through_nine_points_is_found(number, found, real):
    """The 64 of problem 3 were certified by Hauenstein and Sottile (2012); the other counts are by two ways alike.

    In problem 4 four points are on a line, and four paths leave for infinity.
    """
    points = np.array(POINTS[number]) @ [1, 1j]
    triples = nine_points.solutions(points)
    assert (len(triples.unknowns), triples.real.sum(), len(triples.lost)) == (found, real, 1442 - found)
    # a last correction of 1e-14 with twice the digits: what is left is the rounding of the unknowns
    assert triples.errors.max() < 1e-14
    assert (triples.lost[:, 0] > 0.999).all()
    # the rounding of an angle or length, some units, through the sensitivity of an assembly near a toggle
    assert misses(triples.unknowns[triples.real], points) < 1e-10


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", range(20))
def test_a_linkage_is_among_those_through_its_points(seed):
    random = np.random.default_rng(seed)
    lengths = np.sort(random.uniform(0.2, 1.0, 4))
    a1, rest = lengths[0], random.permutation(lengths[1:])
    theta = np.sort(random.uniform(0.0, 2 * np.pi, 9))
    if lengths[0] + lengths[3] > lengths[1] + lengths[2]:
        a1, rest = 0.2, np.array([0.9, 0.8, 0.7])
    at = fl.evaluate(
        "planar_4r", ["P_x", "P_y", "A_x", "A_y", "B_x", "B_y"], branch=1, theta1=theta,
        a1=a1, a2=rest[0], a3=rest[1], a4=rest[2], P_u=random.normal(), P_v=random.normal(),
    )  # fmt: skip
    points, a, b = (np.asarray(at[f"{k}_x"]) + 1j * np.asarray(at[f"{k}_y"]) for k in "PAB")
    triples = nine_points.solutions(points)
    assert len(triples.unknowns) + len(triples.lost) == 1442
    real = triples.unknowns[triples.real]
    d = np.array([points[1:] - points[0], np.conj(points[1:] - points[0])])
    own = np.array([a[0] - points[0], -points[0], b[0] - points[0], rest[2] - points[0]])
    alike = np.concatenate([real, *nine_points.cognates(real, d)])[:, :4]
    # nine points determine their linkage to some 1e4 units of rounding, of cognates too
    assert min(abs(alike - own).max(axis=1).min(), abs(alike - own[[2, 3, 0, 1]]).max(axis=1).min()) < 1e-8


@pytest.mark.stress
def test_the_general_instance_is_what_its_code_makes():
    """The same triples, in any order: rounding decides which cognate stands for one."""
    made = remake()
    points, known = nine_points._instance()
    assert made.shape == (1444, 8)
    np.testing.assert_allclose(made[:2], points, rtol=1e-12)
    both = np.concatenate([known, nine_points._turns(made[2:], points)])
    assert (np.sort(nine_points._first_of_triple(both)) == np.repeat(np.arange(1442), 2)).all()

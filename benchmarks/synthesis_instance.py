"""The general instance of nine points that the package ships, made anew: ``python -m benchmarks.synthesis_instance``.

It takes 15 s, and prints how many triples there are; ``FILE.npy`` as an argument writes them.
"""

import sys
from itertools import pairwise

import numpy as np

from fastlink.synthesis import nine_points


def _random(random, *shape):
    return random.standard_normal(shape) + 1j * random.standard_normal(shape)


def _first_triple(random):
    """Return a linkage (1, 16) with any numbers, and eight points (2, 8) that it passes."""
    z = np.concatenate([_random(random, 8), np.exp(0.7 * _random(random, 8))])
    points = []

    for u in z[8:]:

        def equation(d, ds, k, u=u):
            x, a, xs, as_ = z[k], z[k + 1], z[k + 4], z[k + 5]
            return d * ds - d * as_ - a * ds + x * as_ + a * xs + x * (ds - as_) * u + xs * (d - a) / u

        # the difference of both equations is linear: ds of d, and so one of them is quadratic in d
        zero = equation(0, 0, 0) - equation(0, 0, 2)
        by_d, by_ds = (equation(d, 1 - d, 0) - equation(d, 1 - d, 2) - zero for d in (1, 0))
        low, middle, high = (equation(d, -(zero + d * by_d) / by_ds, 0) for d in (-1, 0, 1))
        d = np.roots([(low + high) / 2 - middle, (high - low) / 2, middle])[0]
        points.append((d, -(zero + d * by_d) / by_ds))
    return z[None], np.array(points).T


def remake(seed=0):
    """Return what `nine_points.FILE` holds, made anew: the triples of a general instance, by monodromy.

    From one linkage, loops in the space of points lead to others, until two loops have found nothing new.
    """
    random = np.random.default_rng(seed)
    known, base = _first_triple(random)
    idle = 0
    while idle < 2:
        ends, places = known, [base, _random(random, 2, 8), _random(random, 2, 8), base]
        for place, goal in pairwise(places):
            ends, told = nine_points._follow(ends, place, goal)
            ends = ends[told[0] == 1.0]
        ends, corrections = nine_points._run(nine_points.POLISH, ends, base, 0.0 * base, 0.0)
        both = np.concatenate([known, ends[corrections[-1] < nine_points.SETTLED]])
        both = both[nine_points._first_of_triple(both) == np.arange(len(both))]
        idle = idle + 1 if len(both) == len(known) else 0
        known = both
    alike = np.array([known, *nine_points.cognates(known, base)])
    least = np.abs(alike[:, :, :8]).max(axis=2).argmin(axis=0)
    return np.concatenate([base, alike[least, np.arange(len(known)), :8]])


if __name__ == "__main__":
    made = remake()
    print(f"{len(made) - 2:,} triples")
    if len(sys.argv) > 1:
        np.save(sys.argv[1], made)

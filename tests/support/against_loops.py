"""Values and bounds of many designs against the loops.

The reference shares no formula with the facts: `fastlink.precision.independent` on balls of python-flint, with as many
bits as it takes.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from functools import lru_cache

import flint
import numpy as np
from flint import acb, arb

import fastlink as fl
from fastlink.facts.powers import any_beyond_range
from fastlink.mechanisms import catalogue
from fastlink.precision.independent import TURNING, model_of
from tests.support.neighbourhoods import DRAWN

#: Bits of the reference, each taken where the one before leaves something open.
BITS = (256, 1024, 4096)
BLOCK = 4096
#: A whole turn, and what rounding it to a double loses.
TURN, TURN_LOW = 6.283185307179586, 2.4492935982947064e-16
#: What a value of the reference is.
NUMBER, OPEN, UNKNOWN = 0, 1, 2
#: The share of a bound that a ball may have.
SHARP = 2.0**-20


class FlintContext:
    """The functions that the models call, on balls of so many bits (ten times as fast as mpmath); one at a time."""

    mpf, mpc = arb, acb
    sqrt, cos, sin, exp, log = map(staticmethod, (arb.sqrt, arb.cos, arb.sin, arb.exp, arb.log))
    atan2, atanh, acosh = map(staticmethod, (arb.atan2, arb.atanh, arb.acosh))
    #: Where the loop does not close: a ball that is no number has too few bits.
    nan = None
    #: Balls know what rounding leaves open.
    eps = 0

    def __init__(self, bits):
        self.bits, self.dps = bits, int(bits * 0.30103)

    def __enter__(self):
        self.before, flint.ctx.prec = flint.ctx.prec, self.bits
        return self

    def __exit__(self, *_):
        flint.ctx.prec = self.before

    @staticmethod
    def cos_sin(x):
        sine, cosine = x.sin_cos()
        return cosine, sine

    @property
    def pi(self):
        return arb.pi()


@lru_cache(maxsize=64)
def context(bits):
    return FlintContext(bits)


@dataclass
class Tally:
    """What came out for one mechanism by one input."""

    mechanism: str
    input: str
    #: Of designs, values and the like.
    counts: Counter = field(default_factory=Counter)
    #: The greatest share of an error in its bound, and the quantity that has it.
    worst: tuple[float, str] = (0.0, "")
    #: By kind and quantity how many there are, and the first: its configuration and what is wrong.
    failures: dict = field(default_factory=dict)

    def fail(self, kind, name, at, about):
        """Add a failure."""
        self.counts[kind] += 1
        number, *first = self.failures.get((kind, name), (0, at, about))
        self.failures[kind, name] = (number + 1, *first)

    def report(self):
        """Return the failures by their first examples."""
        examples = {}
        for (kind, name), (number, at, about) in self.failures.items():
            examples.setdefault(str(at), []).append(f"    {name}: {kind}, {number} times; {about}")
        return "\n".join(
            f"{self.mechanism}, {self.input}, {at}\n" + "\n".join(of) for at, of in examples.items()
        )


def references(model, names, rows, bits):
    """Return values as high and low parts, radii, and kinds, each (names, rows); `names` has their numbers."""
    shape = (len(names), len(rows))
    high, low, radius = np.full(shape, np.nan), np.zeros(shape), np.zeros(shape)
    kinds = np.full(shape, UNKNOWN)
    for i, at in enumerate(rows):
        lost = model.lost(at)
        if lost is None:
            continue
        with context(bits + 4 * lost) as ctx:
            for name, value in model.values(ctx, at, names).items():
                k = names[name]
                if value is None:
                    kinds[k, i] = OPEN
                    continue
                if not value.is_finite():
                    continue
                high[k, i] = float(value.mid())
                if np.isfinite(high[k, i]):
                    low[k, i] = float((value - high[k, i]).mid())
                radius[k, i] = float(value.rad())
                kinds[k, i] = NUMBER
    return high, low, radius, kinds


def computed(mechanism, drive, names, design):
    """Return the values in doubles and their error bounds, each (names, designs)."""
    n = len(next(iter(design.values())))
    known = catalogue(mechanism, drive)
    bounded = [name for name in names if not known.public_fact(name).flags]
    wanted = [*names, *(f"{name}_error" for name in bounded)]
    with np.errstate(all="ignore"):
        found = fl.evaluate(mechanism, wanted, input=drive, **design)
    values = np.array([np.broadcast_to(found[name], n) for name in names])
    bounds = np.array(
        [np.broadcast_to(found[f"{name}_error"], n) if name in bounded else np.zeros(n) for name in names]
    )
    return values, bounds


def errors_of(values, high, low, turning):
    """Return the errors of values, of angles modulo a turn."""
    with np.errstate(all="ignore"):
        errors = (values - high) - low
        turns = np.where(turning[:, None] & (abs(errors) > 0.5 * TURN), np.sign(errors), 0.0)
        return abs((((values - high) - turns * TURN) - low) - turns * TURN_LOW)


def compare(tally, design):
    """Compare one block of designs."""
    model = model_of(catalogue(tally.mechanism, tally.input))
    known = catalogue(tally.mechanism, tally.input)
    names = [
        name for name in (*model.orders, *model.of_design) if name in known.public and name not in design
    ]
    n = len(next(iter(design.values())))
    rows = [{str(name): float(values[i]) for name, values in design.items()} for i in range(n)]
    values, bounds = computed(tally.mechanism, tally.input, names, design)
    turning = np.array([name in TURNING for name in names])
    index = {name: k for k, name in enumerate(names)}
    high, low, radius, kinds = references(model, index, rows, BITS[0])
    for bits in BITS[1:]:
        errors = errors_of(values, high, low, turning)
        again = suspicious(values, bounds, errors, radius, kinds).any(axis=0).nonzero()[0]
        if not again.size:
            break
        found = references(model, index, [rows[i] for i in again], bits)
        for whole, part in zip((high, low, radius, kinds), found, strict=True):
            whole[:, again] = part
    count(tally, names, rows, values, bounds, errors_of(values, high, low, turning), radius, kinds, high)


def suspicious(values, bounds, errors, radius, kinds):
    """Return where the reference should be computed with more bits: wrong values, unless it is sharp."""
    with np.errstate(invalid="ignore"):
        right = (kinds == NUMBER) & (errors <= bounds) & ((radius <= SHARP * bounds) | (errors == 0.0))
    return np.isfinite(values) & np.isfinite(bounds) & ~right


def count(tally, names, rows, values, bounds, errors, radius, kinds, high):
    """Add a block to the tally; a value with an infinite bound is flagged, it claims nothing."""
    finite, claims = np.isfinite(values), np.isfinite(bounds)
    inside, is_open = (kinds == NUMBER) & np.isfinite(high), kinds == OPEN
    with np.errstate(all="ignore"):
        wrong = finite & inside & claims & (errors > bounds)
        beyond = wrong & (radius <= 0.01 * errors)
        sharp = finite & inside & claims & (bounds > 0.0) & (radius <= SHARP * np.maximum(errors, bounds))
        shares = np.where(sharp & ~beyond, errors / bounds, 0.0)
    unknown = finite & claims & (kinds == UNKNOWN)
    tally.counts += Counter(
        {
            "designs": len(rows),
            "values": int((finite & inside).sum() + (is_open & ~finite).sum()),
            "flagged": int((finite & ~claims & (kinds != UNKNOWN)).sum()),
            "NaN": int((np.isnan(values) & inside).sum()),
            "not told": int((unknown | wrong & ~beyond).sum()),
            "open": int(is_open.any(axis=0).sum()),
        }
    )
    k, i = np.unravel_index(np.argmax(shares), shares.shape)
    tally.worst = max(tally.worst, (float(shares[k, i]), names[k]))
    endless = np.isinf(values) & (bounds != np.inf) & inside & (radius <= SHARP * abs(high))
    failures = {"beyond": beyond, "finite where none": finite & is_open & claims, "infinite": endless}
    for kind, where in failures.items():
        for k, i in zip(*where.nonzero(), strict=True):
            about = f"value {float(values[k, i])!r}, exact {float(high[k, i])!r}, bound {bounds[k, i]:.3g}"
            tally.fail(kind, names[k], rows[i], about)


def campaign(mechanism, drive, designs, seed=0):
    """Return the tally of so many designs."""
    tally = Tally(mechanism, drive)
    rng = np.random.default_rng([seed, *map(ord, mechanism + drive)])
    for start in range(0, designs, BLOCK):
        n = min(BLOCK, designs - start)
        design = DRAWN[mechanism, drive](rng, n) | {"branch": rng.integers(1, 3, n).astype(float)}
        known = catalogue(mechanism, drive)
        far = any_beyond_range(known.known_inputs(known.variants_selected_by(design)), design)
        compare(tally, {name: values[~far] for name, values in design.items()})
    return tally

"""Numbers of python-flint for the models of `fastlink.precision.independent`: balls, ten times as fast as mpmath."""

from __future__ import annotations

from functools import lru_cache

import flint
from flint import acb, arb


class FlintContext:
    """The functions that the models call, on balls of so many bits; one context computes at a time."""

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

"""A second reference that shares no formula with the facts: the loops themselves, by Newton's iteration.

Each mechanism is written down once more as its papers draw it: links as vectors that close, forces as free bodies.
Positions solve these equations, rates follow by series of the drive (`loops`). Nothing of `mechanisms` may enter
here, and no form that is there because it does not cancel: digits are had by computing with more of them.
"""

"""Errors a user can mend: what is wrong, where, and what to write instead, in one line."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

MOST_SHOWN = 12


class InputError(ValueError):
    """Bad input; the message names the place, what was found and the remedy."""


def suggest(name: str, known: Iterable[str]) -> str:
    """Return the end of an "unknown name" message: the nearest known name, or all of them.

    Parameters
    ----------
    name : str
        What the user wrote.
    known : iterable of str
        What would have been accepted.

    Examples
    --------
    >>> suggest("omega_4", ["omega2", "omega4", "theta4"])
    "did you mean 'omega4'?"
    """
    options = sorted(known)
    near = difflib.get_close_matches(name, options, n=1, cutoff=0.5)
    if near:
        return f"did you mean {near[0]!r}?"
    more = f", ... ({len(options)} in all)" if len(options) > MOST_SHOWN else ""
    return f"known: {', '.join(options[:MOST_SHOWN])}{more}"

"""Read names and phrases as words of the field, so that other spellings compare equal."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

__all__ = ["squeezed", "words"]

#: Words of one sense, the first of which stands for all.
SYNONYMS = (
    "velocity speed vel rate rpm",
    "acceleration accel acc accelerations",
    "position pos place location displacement coordinate placement",
    "angle ang direction orientation",
    "coupler floating",
    "output rocker follower driven",
    "input driving driver drive driven_by motor actuator",
    "ground frame base fixed",
    "torque moment couple",
    "force load thrust",
    "reaction bearing pin joint pivot hinge",
    "slider piston ram",
    "rod conrod pitman",
    "mass weight",
    "density",
    "length len size dist distance",
    "ratio share",
    "centre center centroid",
    "deviation residual",
    "swing oscillation",
    "limit toggle",
    "error err uncertainty",
    "transmission trans transm",
    "omega w",
    "theta th",
    "lambda lam",
    "epsilon eps",
    "magnitude mag abs",
    "curvature curv",
    "linkage mechanism",
    "type class kind category",
    "greatest maximum max maximal peak largest highest",
    "least minimum min minimal smallest lowest",
)
#: Characters of a text that are read: no name or phrase has more, and a search takes the square of its length.
LONGEST = 120
_CANONICAL = {word: group.split()[0] for group in SYNONYMS for word in group.split()}
STOP = frozenset(["of", "the", "in", "on", "to", "and", "for", "with", "by", "from", "an", "is", "its"])
_CAMEL = re.compile("(?<=[a-z])(?=[A-Z][a-z])")
_PART = re.compile("[a-z]+|[0-9]+")
#: No moment of a force.
_INERTIA = re.compile("moments? of inertia")
_LETTER = re.compile("LETTER (?:FINAL )?([A-Z]+)")


def _latin(text: str) -> str:
    """Return a text in which Greek letters are spelt, and subscripts are digits."""
    spelt = []
    for character in unicodedata.normalize("NFKC", text):
        name = unicodedata.name(character, "") if character > "\u036f" else ""
        letter = _LETTER.search(name) if name.startswith("GREEK") else None
        spelt.append(f" {letter[1].lower().replace('lamda', 'lambda')} " if letter else character)
    return "".join(spelt)


def parts(text: str) -> list[str]:
    """Return the words and numbers of a text as they are spelt, in lower case.

    Examples
    --------
    >>> parts("dω₄/da2"), parts("maxTorque")
    (['d', 'omega', '4', 'da', '2'], ['max', 'torque'])
    """
    return _PART.findall(_INERTIA.sub("inertia", _CAMEL.sub(" ", _latin(text[:LONGEST])).casefold()))


def canonical(spelt: Iterable[str]) -> tuple[str, ...]:
    """Return words in one spelling for each sense, without plurals and without words that say nothing."""
    singular = (word[:-1] if len(word) > 4 and re.search("[^sui]s$", word) else word for word in spelt)
    read = tuple(_CANONICAL.get(word, word) for word in singular)
    return tuple(word for word in read if word not in STOP) or read


def words(text: str) -> tuple[str, ...]:
    """Return the words of a text, see `canonical`.

    Examples
    --------
    >>> words("Angular velocity of the output link"), words("rocker_speed"), words("ω4")
    (('angular', 'velocity', 'output', 'link'), ('output', 'velocity'), ('omega', '4'))
    """
    return canonical(parts(text))


def squeezed(text: str) -> str:
    """Return the letters and digits of a text: equal for spellings that differ in case and signs alone."""
    return "".join(parts(text))

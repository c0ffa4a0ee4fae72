"""Find declared names by what a phrase means, in whatever spelling."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher, get_close_matches
from functools import lru_cache
from typing import TYPE_CHECKING

from fastlink.facts.names import innermost

if TYPE_CHECKING:
    from fastlink.facts.catalogue import Catalogue


# -- Read names and phrases as words of the field, so that other spellings compare equal


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
    """Return the words and numbers of a text as they are spelt, in lower case."""
    return _PART.findall(_INERTIA.sub("inertia", _CAMEL.sub(" ", _latin(text[:LONGEST])).casefold()))


def canonical(spelt: Iterable[str]) -> tuple[str, ...]:
    """Return words in one spelling for each sense, without plurals and without words that say nothing."""
    singular = (word[:-1] if len(word) > 4 and re.search("[^sui]s$", word) else word for word in spelt)
    read = tuple(_CANONICAL.get(word, word) for word in singular)
    return tuple(word for word in read if word not in STOP) or read


def words(text: str) -> tuple[str, ...]:
    """Return the words of a text, see `canonical`."""
    return canonical(parts(text))


def squeezed(text: str) -> str:
    """Return the letters and digits of a text: equal for spellings that differ in case and signs alone."""
    return "".join(parts(text))


# -- Rank declared names by what a phrase means: by the words of name, symbol, keywords and title, and by letters


#: The part of a phrase's score that counts only as far as the query says all of it; what a title counts.
PARTLY, TITLE = 0.5, 0.85
#: A word that is misspelt or cut short, and words scattered over name, symbol and title.
MISSPELT, SCATTERED = 0.5, 0.7
#: Letters in common from which two words, or two names, may be one misspelt.
LETTERS = 0.7
#: The numbers in a name, and what one counts of which nothing but these is another.
NUMBER, OTHER_NUMBER = re.compile("[0-9]+"), 0.6
#: The least score of a suggestion; and its least share of the best one.
LEAST, NEAR, MOST = 0.42, 0.85, 3


@dataclass(frozen=True)
class Entry:
    """A name with what it is called: symbol, title, and keywords of the field."""

    name: str
    symbol: str = ""
    title: str = ""
    keywords: tuple[str, ...] = ()


@dataclass(frozen=True, order=True)
class Ranked:
    """A name and how well it answers a phrase, from 0 to 1; the best sorts first, of equal ones the shorter."""

    order: tuple[float, int, str]
    score: float
    name: str

    @classmethod
    def of(cls, score: float, name: str) -> Ranked:
        """Return a name with its score."""
        return cls((-round(score, 6), len(name), name), score, name)


class Index:
    """The words of some names, for search."""

    def __init__(self, entries: Iterable[Entry]) -> None:
        entries = tuple(entries)
        self._spellings = {
            x.name: [squeezed(text) for text in (x.name, x.symbol, *x.keywords)] for x in entries
        }
        phrases = {
            x.name: [
                *((1.0, words(text)) for text in (x.name, x.symbol, *x.keywords)),
                (TITLE, words(x.title)),
            ]
            for x in entries
        }
        self._phrases = {name: [(kind, said) for kind, said in of if said] for name, of in phrases.items()}
        self._known = sorted({word for of in phrases.values() for _, said in of for word in said})

    def ranked(self, text: str) -> list[Ranked]:
        """Return the names that a phrase may mean, the best first."""
        return self.ranked_parts(tuple(parts(text)))

    def ranked_parts(self, spelt: Sequence[str]) -> list[Ranked]:
        """Return the names that words, as they are spelt, may mean."""
        if not (joined := "".join(spelt)):
            return []
        query = [self._near(word) for word in canonical(spelt)]
        scores = {name: self._by_words(query, phrases) for name, phrases in self._phrases.items()}
        close = get_close_matches(joined, [own for own, *_ in self._spellings.values()], 9, LETTERS)
        for name, (own, *others) in self._spellings.items():
            letters = 0.0
            if joined in (own, *others):
                letters = 1.0 if joined == own else 0.99
            elif NUMBER.sub("0", joined) == NUMBER.sub("0", own):
                pairs = zip(NUMBER.findall(joined), NUMBER.findall(own), strict=True)
                letters = OTHER_NUMBER - 0.01 * min(10, sum(abs(int(x) - int(y)) for x, y in pairs))
            elif own in close:
                letters = SequenceMatcher(None, own, joined).ratio() ** 2
            scores[name] = max(letters, scores[name])
        return sorted(Ranked.of(score, name) for name, score in scores.items() if score > 0.0)

    def _near(self, word: str) -> dict[str, float]:
        """Return the known words that a word may be, and how near each is."""
        if word in self._known or len(word) < 3:
            return {word: 1.0}
        begun = [known for known in self._known if known.startswith(word)]
        return dict.fromkeys(begun or get_close_matches(word, self._known, MOST, LETTERS), MISSPELT)

    def _by_words(
        self, query: list[dict[str, float]], phrases: Iterable[tuple[float, Sequence[str]]]
    ) -> float:
        """Return the score of the phrases of a name by the words that they share with a query."""
        best, scattered = 0.0, [0.0] * len(query)
        for kind, said in phrases:
            like = [max(near.get(word, 0.0) for word in said) for near in query]
            share = sum(any(word in near for near in query) for word in said) / len(said)
            best = max(best, kind * sum(like) / len(query) * (1.0 - PARTLY + PARTLY * share))
            scattered = [max(pair) for pair in zip(scattered, like, strict=True)]
        return max(best, SCATTERED * sum(scattered) / len(query))


def best_names(ranked: Sequence[Ranked], most: int = MOST) -> list[str]:
    """Return the names to suggest: at most three, none much worse than the best.

    Beside a name of which only case and signs differ there is no other.
    """
    best = ranked[0].score if ranked else 0.0
    least = 1.0 if best == 1.0 else max(LEAST, NEAR * best)
    return [one.name for one in ranked[:most] if one.score >= least]


def did_you_mean(names: Sequence[str]) -> str:
    """Return a remedy that suggests names."""
    quoted = [repr(name) for name in names]
    return f"did you mean {' or '.join(part for part in (', '.join(quoted[:-1]), quoted[-1]) if part)}?"


def index_of_quantities(catalogue: Catalogue) -> Index:
    """Return the index of a mechanism's quantities, and of forms of them that have keywords."""
    return _of_quantities(catalogue, catalogue.version)


def index_of_inputs(catalogue: Catalogue) -> Index:
    """Return the index of a mechanism's inputs, those of links and loads among them."""
    return _of_inputs(catalogue, catalogue.version)


@lru_cache(maxsize=32)
def _of_quantities(catalogue: Catalogue, version: int) -> Index:
    facts = catalogue.public
    further = {name for name in catalogue.keywords if name not in facts and name not in catalogue.variables}
    made = (Entry(name, keywords=catalogue.keywords[name]) for name in further)
    return Index(
        (
            *(Entry(x.name, x.symbol, x.meaning, catalogue.keywords.get(x.name, ())) for x in facts.values()),
            *(entry for entry in made if innermost(entry.name, catalogue) in facts),
        )
    )


@lru_cache(maxsize=32)
def _of_inputs(catalogue: Catalogue, version: int) -> Index:
    inputs = catalogue.known_inputs(catalogue.variant_inputs).values()
    return Index(Entry(x.name, x.symbol, x.meaning, catalogue.keywords.get(x.name, ())) for x in inputs)

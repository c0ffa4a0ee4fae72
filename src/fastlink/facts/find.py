"""Find declared names by what a phrase means, in whatever spelling."""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import lru_cache
from typing import TYPE_CHECKING

from fastlink.facts.names import innermost

if TYPE_CHECKING:
    from fastlink.facts.catalogue import Catalogue

__all__ = [
    "Entry",
    "Index",
    "Ranked",
    "best_names",
    "did_you_mean",
    "index_of_inputs",
    "index_of_quantities",
    "squeezed",
    "words",
]


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


# -- Rank declared names by what a phrase means: by name, symbol, keywords and title, and by letters


#: What a phrase of each kind counts, and how much less where the query says only a part of it.
NAME, SYMBOL, KEYWORD, TITLE = (0.99, 0.5), (0.98, 0.5), (0.97, 0.3), (0.85, 0.2)
#: A word that begins another one, and words scattered over name, symbol and title.
BEGINS, SCATTERED = 0.8, 0.75
#: Letters in common from which two words, or two names, may be one misspelt.
LETTERS = 0.7
#: The numbers in a name, and what it counts if they are others than those asked for.
NUMBER, OTHER_NUMBER = re.compile("[0-9]+"), 0.6
#: The weight of a word that is not known, in that of the rarest word.
UNKNOWN = 0.5
#: Words that say nothing where no name, symbol or title has them.
GENERAL = frozenset(["position", "value", "quantity", "variable", "total", "cycle", "point", "link", "joint"])
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
    """A name and how well it answers a phrase, from 0 to 1; the best sorts first."""

    order: tuple[float, int, str]
    score: float
    name: str

    @classmethod
    def of(cls, score: float, name: str) -> Ranked:
        """Return a name with its score; of equal ones the shorter name comes first."""
        return cls((-round(score, 6), len(name), name), score, name)


class Index:
    """The words of some names, for search."""

    def __init__(self, entries: Iterable[Entry]) -> None:
        entries = tuple(entries)
        self._squeezed = {
            x.name: [squeezed(text) for text in (x.name, x.symbol, *x.keywords)] for x in entries
        }
        self._phrases: dict[str, list[tuple[float, float, dict[str, float]]]] = {}
        self._holders: dict[str, list[str]] = {}
        phrases = {
            x.name: [
                (NAME, words(x.name)),
                (SYMBOL, words(x.symbol)),
                *((KEYWORD, words(keyword)) for keyword in x.keywords),
                (TITLE, words(x.title)),
            ]
            for x in entries
        }
        for name, of in phrases.items():
            for word in {word for _, phrase in of for word in phrase}:
                self._holders.setdefault(word, []).append(name)
        self._weights = {
            word: math.log(1.0 + len(entries) / len(names)) for word, names in self._holders.items()
        }
        # a word that is unknown here, such as "the maximal value", says less than a rare word that is known
        self._otherwise = UNKNOWN * math.log(1.0 + len(entries))
        for name, of in phrases.items():
            self._phrases[name] = [
                (*kind, {word: self._weights[word] for word in phrase}) for kind, phrase in of if phrase
            ]
        self._near = lru_cache(maxsize=1024)(self._near_words)

    def ranked(self, text: str) -> list[Ranked]:
        """Return the names that a phrase may mean, the best first."""
        return self.ranked_parts(tuple(parts(text)))

    def ranked_parts(self, spelt: Sequence[str]) -> list[Ranked]:
        """Return the names that words, as they are spelt, may mean."""
        joined = "".join(spelt)
        if not joined:
            return []
        query = [part for word in canonical(spelt) for part in self._split(word)]
        query = [word for word in query if word in self._weights or word not in GENERAL] or query
        near = [(self._weights.get(word, self._otherwise), self._near(word)) for word in query]
        holders = {name for _, words in near for word in words for name in self._holders.get(word, ())}
        scores = {name: self._meaning(near, name) for name in holders}
        for name, score in self._by_letters(joined):
            scores[name] = max(score, scores.get(name, 0.0))
        return sorted(Ranked.of(score, name) for name, score in scores.items() if score > 0.0)

    def _split(self, word: str) -> list[str]:
        """Return two known words that are written as one, or the word."""
        if word in self._weights:
            return [word]
        for k in range(3, len(word) - 2):
            both = canonical((word[:k], word[k:]))
            if all(part in self._weights for part in both):
                return list(both)
        return [word]

    def _near_words(self, word: str) -> dict[str, float]:
        """Return the known words that a word may be, and how near each is."""
        near = {word: 1.0}
        if len(word) < 3 or word.isdigit():
            return near
        matcher = SequenceMatcher(None, "", word)
        for known in self._weights:
            if known.startswith(word) or (len(known) > 3 and word.startswith(known)):
                near.setdefault(known, BEGINS)
            elif word not in self._weights and len(known) > 3 and (ratio := _ratio(matcher, known)):
                near.setdefault(known, ratio * ratio)
        return near

    def _meaning(self, query: Sequence[tuple[float, Mapping[str, float]]], name: str) -> float:
        """Return the score of a name by words, the rarer of which count more."""
        total = sum(weight for weight, _ in query)
        scattered, best = [0.0] * len(query), 0.0
        for kind, partly, phrase in self._phrases[name]:
            recalled, said = 0.0, set()
            for k, (weight, near) in enumerate(query):
                like, word = max((near.get(word, 0.0), word) for word in phrase)
                if like:
                    recalled += weight * like
                    scattered[k] = max(scattered[k], like)
                    said.add(word)
            if said:
                share = sum(phrase[word] for word in said) / sum(phrase.values())
                best = max(best, kind * recalled / total * (1.0 - partly + partly * share))
        everywhere = sum(weight * like for (weight, _), like in zip(query, scattered, strict=True)) / total
        return max(best, SCATTERED * everywhere)

    def _by_letters(self, joined: str) -> Iterator[tuple[str, float]]:
        """Yield the names that may be misspelt, and the score of each: 1 where only case and signs differ."""
        matcher, numbers, stem = (
            SequenceMatcher(None, "", joined),
            NUMBER.findall(joined),
            NUMBER.sub("0", joined),
        )
        for name, spellings in self._squeezed.items():
            own = NUMBER.findall(spellings[0])
            if joined in spellings:
                yield name, 1.0 if joined == spellings[0] else 0.99
            elif own != numbers and stem == NUMBER.sub("0", spellings[0]):
                apart = sum(abs(int(x) - int(y)) for x, y in zip(own, numbers, strict=True))
                yield name, OTHER_NUMBER - 0.01 * min(apart, 10)
            elif ratio := _ratio(matcher, spellings[0]):
                yield name, ratio * ratio * (1.0 if own == numbers else OTHER_NUMBER)


def _ratio(matcher: SequenceMatcher[str], word: str) -> float:
    """Return the share of letters that a word has in common with that of the matcher; 0 where it is small."""
    matcher.set_seq1(word)
    if matcher.real_quick_ratio() < LETTERS or matcher.quick_ratio() < LETTERS:
        return 0.0
    ratio = matcher.ratio()
    return ratio if ratio >= LETTERS else 0.0


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

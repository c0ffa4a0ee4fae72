"""Reductions over the input cycle: greatest, least, mean, root mean square, fluctuation.

Everything that is true of one reduction stands in its entry of `REDUCTIONS`: the kernel text, the reference that
verification compares with, the sign of an extreme, how its value and its units follow from those of the quantity.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from string import Formatter
from typing import Any

from fastlink.facts.fact import CatalogueError
from fastlink.facts.names import forget_reduction, register_reduction
from fastlink.numerics.elementary import sqrt

__all__ = ["COUNT", "REDUCTIONS", "Reduction", "register", "unregister"]

#: The accumulator ``{count}`` of the configurations that assemble: its first value and its update.
COUNT = ("0.0", "{count} + select({value} == {value}, 1.0, 0.0)")
#: Samples on which a reference is tried when a reduction is defined, and a factor without rounding.
TRIED, FACTOR = (0.375, -1.25, 3.5, -0.0625, 2.0), 4.0
TOLERANCE = 1e-12
#: What kernel text calls the quantity, and whether it replaces an extreme.
RESERVED = {"value", "better", "slope"}


@dataclass(frozen=True, eq=False, kw_only=True)
class Reduction:
    """One way to reduce the cycle of a quantity to a number.

    Kernel text is one expression of arithmetic, comparisons, ``select``, ``sqrt`` and ``abs`` in which ``{value}`` is
    the quantity at an input position and ``{NAME}`` an accumulator. Configurations that do not assemble are NaN and
    must not enter: a comparison with NaN is false. A cycle without any value must give NaN.

    Attributes
    ----------
    suffix : str
        The ending of its names.
    phrase : str
        Its meaning, to follow that of the quantity in a long name.
    keywords : tuple of str
        Other words for it, by which it is found.
    reference : callable
        ``reference(samples)`` returns the exact value over at least one sample, and the size of the terms that it is
        the sum of (its absolute value where it is not a sum): errors are counted in roundings of that. Samples are
        numbers of 50 digits without NaN, in the order of the input positions; it works with floats too.
    accumulators : mapping of str to (str, str)
        For each accumulator its first value and the kernel text that updates it at each input position; all updates see
        the values from before. `COUNT` may be among them, under the name ``count``.
    finish : str
        Kernel text of the result, over accumulators.
    sign : int
        1 for the greatest value, -1 for the least: these are searched exactly, and have a position. 0 for all others.
    power : int or None
        A quantity times a positive factor gives the result times this power of it; units follow. None where there is no
        such power, so that no axis of a sweep only scales the result.
    units : str
        Those of the result, where `power` is None.
    toggle_order : int, optional
        A quantity that grows as this power of 1/sigma at a toggle, or a greater one, sigma as the root of the distance
        from it, has no such integral over the turn.
    at_toggle : str
        Kernel text of the result there, over accumulators.
    whole : str
        ``MODULE.FUNCTION`` of ``fastlink.codegen.runtime``: takes the whole curve at once, of equal steps over a turn,
        instead of `accumulators` and `finish`. A curve with a gap gives NaN.
    gradient, gradient_finish : mapping of str to (str, str), str
        Further accumulators, and kernel text over all of them, of the derivative of the result by an input. Their
        updates may read ``{slope}``, that of the quantity at the input position. Without them it has no derivative.
    has_kink : bool
        Whether it has no derivative where it is zero, as a root.

    Raises
    ------
    CatalogueError
        The parts do not fit together, or the reference contradicts sign or power.
    """

    suffix: str
    phrase: str
    reference: Callable[[Sequence[Any]], tuple[Any, Any]]
    accumulators: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    finish: str = ""
    sign: int = 0
    power: int | None = 1
    units: str = ""
    toggle_order: int | None = None
    at_toggle: str = "nan"
    whole: str = ""
    keywords: tuple[str, ...] = ()
    gradient: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    gradient_finish: str = ""
    has_kink: bool = False

    def __post_init__(self) -> None:
        if bad := RESERVED.intersection((*self.accumulators, *self.gradient)):
            raise CatalogueError(f"reduction {self.suffix}: call the accumulator {bad.pop()!r} otherwise")
        if bool(self.whole) == bool(self.accumulators and self.finish):
            raise CatalogueError(
                f"reduction {self.suffix}: give accumulators and finish, or the function of whole curves"
            )
        if bool(self.units) != (self.power is None):
            raise CatalogueError(f"reduction {self.suffix}: give the power of its units, or its units")
        if self.sign not in (-1, 0, 1):
            raise CatalogueError(f"reduction {self.suffix}: the sign is {self.sign!r}; write 1, -1 or 0")
        self._check_text()
        self._check_reference()

    def _check_text(self) -> None:
        names = set(self.accumulators)
        finals = ((text, names) for text in (self.finish, self.at_toggle))
        updates = [
            (text, names | {"value", "better"}) for pair in self.accumulators.values() for text in pair
        ]
        all_names = names | set(self.gradient)
        slopes = [
            (text, all_names | {"value", "better", "slope"})
            for pair in self.gradient.values()
            for text in pair
        ]
        for text, known in (*updates, *finals, *slopes, (self.gradient_finish, all_names)):
            read = {name for _, name, _, _ in Formatter().parse(text) if name is not None}
            if unknown := read - known:
                raise CatalogueError(f"reduction {self.suffix}: {text!r} reads {', '.join(sorted(unknown))}")

    def _check_reference(self) -> None:
        (one, _), (scaled, _) = self.reference(TRIED), self.reference([FACTOR * sample for sample in TRIED])
        if self.power is not None and not math.isclose(scaled, FACTOR**self.power * one, rel_tol=TOLERANCE):
            raise CatalogueError(
                f"reduction {self.suffix}: {FACTOR:g} times the quantity gives {scaled:g}, not {FACTOR:g}^{self.power} "
                f"times {one:g}"
            )
        if self.sign and one != {1: max, -1: min}[self.sign](TRIED):
            raise CatalogueError(
                f"reduction {self.suffix}: the sign {self.sign} is not that of its reference"
            )

    @property
    def has_position(self) -> bool:
        """Whether it is the value at one position of the cycle, an extremum."""
        return self.sign != 0

    @property
    def better(self) -> str:
        """Kernel text: whether the value at a position replaces the extremum so far."""
        return {0: "", 1: "{value} > {best}", -1: "{value} < {best}"}[self.sign]

    def units_of(self, units: str) -> str:
        """Return the units of the result for a quantity of some units.

        Examples
        --------
        >>> REDUCTIONS["rms"].units_of("rad s-1")
        'rad s-1'
        """
        if self.power is None:
            return self.units
        if self.power == 1:
            return units
        powers = [(unit, self.power * int(n or 1)) for unit, n in re.findall(r"([A-Za-z]+)(-?\d*)", units)]
        return " ".join(f"{unit}{n if n != 1 else ''}" for unit, n in powers if n) or "1"

    def degree_of(self, degree: float) -> float | None:
        """Return the power of an input by which the result grows where the quantity grows by `degree`."""
        if degree == 0.0:
            return 0.0
        return None if self.power is None else self.power * degree


def _greatest(samples: Sequence[Any]) -> tuple[Any, Any]:
    return max(samples), abs(max(samples))


def _least(samples: Sequence[Any]) -> tuple[Any, Any]:
    return min(samples), abs(min(samples))


def _root_mean_square(samples: Sequence[Any]) -> tuple[Any, Any]:
    root = sqrt(sum(sample * sample for sample in samples) / len(samples))
    return root, root


def _mean(samples: Sequence[Any]) -> tuple[Any, Any]:
    return sum(samples) / len(samples), sum(map(abs, samples)) / len(samples)


def _fluctuation(samples: Sequence[Any]) -> tuple[Any, Any]:
    """Return what `fastlink.codegen.runtime.fluctuation` takes, and the sum of the sizes of its terms."""
    count, (mean, size) = len(samples), _mean(samples)
    step = 2 * getattr(samples[0], "context", math).pi / count
    total = low = high = 0 * mean
    for j, here in enumerate(samples):
        before, after, later = (samples[(j + k) % count] for k in (-1, 1, 2))
        turn = total
        if (here - mean) * (after - mean) < 0:
            turn += (here - mean) ** 2 / (2 * (here - after))
        low, high = min(low, turn), max(high, turn)
        total += (13 * (here + after) - (before + later)) / 24 - mean
    # each sample enters four terms, with 28/24 in all, and every mean
    return step * (high - low), step * count * size * 13 / 6


def _extreme(sign: int, suffix: str, phrase: str, reference: Callable[..., Any], keywords: str) -> Reduction:
    initial = "-inf" if sign > 0 else "inf"
    has_value = "{best} > -inf" if sign > 0 else "{best} < inf"
    return Reduction(
        suffix=suffix,
        phrase=phrase,
        reference=reference,
        accumulators={"best": (initial, "select({better}, {value}, {best})")},
        finish=f"select({has_value}, {{best}}, nan)",
        sign=sign,
        keywords=tuple(keywords.split()),
        gradient={"slope_there": ("nan", "select({better}, {slope}, {slope_there})")},
        gradient_finish="{slope_there}",
    )


#: Every reduction by its suffix.
REDUCTIONS: dict[str, Reduction] = {}


def register(reduction: Reduction) -> None:
    """Offer a reduction for every quantity that changes over the cycle.

    Raises
    ------
    CatalogueError
        There is one of that suffix, or names that end so are others.
    """
    if reduction.suffix in REDUCTIONS:
        raise CatalogueError(f"reduction {reduction.suffix} is declared twice")
    register_reduction(reduction.suffix, reduction.has_position)
    REDUCTIONS[reduction.suffix] = reduction


def unregister(suffix: str) -> None:
    """Take back what `register` offers, in a test of a reduction of its own."""
    forget_reduction(suffix)
    del REDUCTIONS[suffix]


register(
    _extreme(1, "max", "greatest over the cycle", _greatest, "maximum maximal peak greatest largest highest")
)
register(_extreme(-1, "min", "least over the cycle", _least, "minimum minimal least smallest lowest"))
register(
    Reduction(
        suffix="rms",
        phrase="root mean square over the cycle",
        reference=_root_mean_square,
        accumulators={
            "total": ("0.0", "{total} + select({value} == {value}, {value} * {value}, 0.0)"),
            "count": COUNT,
        },
        finish="sqrt({total} / {count})",
        toggle_order=1,
        at_toggle="select({total} == 0.0, sqrt({total} / {count}), inf)",
        keywords=("effective", "quadratic"),
        gradient={"product": ("0.0", "{product} + select({value} == {value}, {value} * {slope}, 0.0)")},
        gradient_finish="{product} / ({count} * sqrt({total} / {count}))",
        has_kink=True,
    )
)
register(
    Reduction(
        suffix="mean",
        phrase="mean over the cycle",
        reference=_mean,
        accumulators={
            "total": ("0.0", "{total} + select({value} == {value}, {value}, 0.0)"),
            "count": COUNT,
        },
        finish="{total} / {count}",
        toggle_order=2,
        at_toggle="select({total} == 0.0, {total} / {count}, nan)",
        keywords=("average", "avg", "averaged"),
        gradient={"slopes": ("0.0", "{slopes} + select({value} == {value}, {slope}, 0.0)")},
        gradient_finish="{slopes} / {count}",
    )
)
register(
    Reduction(
        suffix="fluctuation",
        phrase="greatest minus least integral over the input angle of what exceeds the mean",
        reference=_fluctuation,
        whole="fluctuation.fluctuation_lanes",
        toggle_order=0,  # the curve has a gap, be it between two samples
        keywords=("variation", "ripple"),
    )
)

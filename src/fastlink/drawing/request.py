"""Check a request to draw, and settle what the picture shows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from inspect import signature
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import in_words
from fastlink.drawing.motion import Motion, as_draw
from fastlink.drawing.source import Source
from fastlink.engine.declared import is_own
from fastlink.engine.evaluate import evaluate
from fastlink.errors import InputError, Problems, Setting, suggest
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.mechanisms import name_of
from fastlink.options import check_choice, check_switch, check_whole
from fastlink.plan.positions import radian_keywords
from fastlink.plan.query import check_names
from fastlink.plan.validate import all_choices, check_branches, check_model, selected_variants
from fastlink.plot.labels import mathematical
from fastlink.space.degrees import RADIANS, angle_of, degrees_name, remark_on_angles
from fastlink.space.links import Links
from fastlink.space.values import constant, numbers_of

if TYPE_CHECKING:
    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.mechanisms._shared.picture import Picture

__all__ = ["Options", "Request", "picture_of", "request_of"]

#: The most linkages side by side, and curves beside them.
MOST_SHEETS, MOST_CURVES = 24, 6
ALL = "all"
#: Names of the evaluation that no input has; those that are options of a picture too.
OPTIONS, BESIDE = frozenset(signature(evaluate).parameters), ("branch", "input", "links")
#: How much farther than its positions the range of an input without bounds is shown.
BEYOND = 1.25


@dataclass(frozen=True)
class Options:
    """The options of `draw`, as they were given."""

    branch: Any
    links: Any
    input: Any
    strip: Any
    curves: Any
    show: Any
    degrees: Any
    moves: bool = False


@dataclass(frozen=True)
class Request:
    """The whole of what a picture shows.

    Attributes
    ----------
    motions : tuple of Motion
        The designs side by side: one, or one for each value of a choice.
    titles : tuple of str
        What tells them apart.
    positions : array
        The input positions, side by side too.
    show : frozenset of str
        Words, see `fastlink.draw`.
    curves : tuple of str
        Quantities whose curves stand beside.
    degrees : bool
        Whether angles are in degrees.
    moves : bool
        Whether the picture is to be animated, so that the view holds the whole motion.
    """

    motions: tuple[Motion, ...]
    titles: tuple[str, ...]
    positions: Any
    show: frozenset[str]
    curves: tuple[str, ...] = ()
    degrees: bool = False
    moves: bool = False
    sheets: list[tuple[Motion, float, str]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        sheets = [
            (motion, float(position), self._title(title, motion, float(position)))
            for motion, title in zip(self.motions, self.titles, strict=True)
            for position in self.positions
        ]
        object.__setattr__(self, "sheets", sheets)

    def _title(self, title: str, motion: Motion, position: float) -> str:
        if len(self.positions) < 2:
            return title
        symbol = mathematical(motion.catalogue.position.symbol)
        return f"{title}{title and ', '}{symbol} = {motion.shown(position, self.degrees, brief=True)}"


def request_of(source: Source, options: Options) -> Request:
    """Return what is drawn, or refuse it with all that is wrong."""
    input = source.input if options.input is None else options.input
    links = source.links if options.links is None else options.links
    catalogue = find_catalogue(source.mechanism, input)
    picture, problems = picture_of(name_of(source.mechanism), catalogue), Problems()
    branches: tuple[int, ...] = tuple(catalogue.branches)
    with problems.at():
        given = source.branch if options.branch is None else options.branch
        branches = branches if given is None else check_branches(catalogue, given)
    with problems.at():
        check_model(catalogue, links, "eliminated")
    with problems.at():
        check_switch(("degrees",), options.degrees)
    strip = options.strip
    if strip is not None:
        with problems.at():
            strip = check_whole(("strip",), strip, 2, MOST_SHEETS)
    inputs = {name: value for name, value in source.inputs.items() if name not in OPTIONS}
    for name in (name for name in source.inputs if name in OPTIONS):
        remedy = f"write it beside the design, {name}=..." if name in BESIDE else "leave it out"
        problems.add("is an option, not an input", ("draw", name), remedy)
    with problems.at():
        own: dict[str, Any] = {"links": links if isinstance(links, Links) else None, "input": input}
        as_draw(lambda: evaluate(source.mechanism, ["status"], **own, **inputs))
    numbers, positions, in_degrees = _numbers(catalogue, source, problems)
    if positions is not None and strip is not None:
        what, remedy = "is given beside strip", "leave one of them out"
        problems.add(what, ("draw", catalogue.position.name), remedy)
    if options.moves and (strip is not None or (positions is not None and positions.size > 1)):
        what = "shows one position that moves"
        problems.add(what, ("animate",), "leave strip and further positions out")
    problems.stop()
    choices = _choices(catalogue, links, numbers)
    reach = 0.0 if positions is None else BEYOND * float(np.abs(positions).max())
    motions = tuple(
        Motion(source.mechanism, catalogue, picture, numbers | one, tuple(sorted(branches)), links, reach)
        for one in choices
    )
    show, curves = _words(motions[0], options.show), _curves(motions[0], options.curves, source.own)
    degrees = options.degrees or in_degrees
    key = degrees_name(catalogue.position.name) if in_degrees else catalogue.position.name
    drawable = tuple(motion for motion in motions if motion.ranges) or motions[:1]
    for motion in drawable:
        motion.check(positions, degrees, key)
    if positions is None:
        positions = drawable[0].spread(strip, ends=False) if strip else np.array([drawable[0].usual])
    titles = tuple(_title(motion, len(drawable)) for motion in drawable)
    return Request(drawable, titles, positions, show, curves, degrees, options.moves)


def picture_of(mechanism: str, catalogue: Catalogue) -> Picture:
    """Return what a mechanism declares to be drawn, or refuse one that does not.

    Raises
    ------
    InputError
        It has no picture, or none by this input.
    """
    try:
        module = import_module(f"fastlink.mechanisms.{mechanism}.picture")
    except ModuleNotFoundError:
        remedy = f"declare its joints and bars in mechanisms/{mechanism}/picture.py"
        raise InputError(f"{mechanism} has no picture", where=("mechanism",), remedy=remedy) from None
    picture: Picture = module.PICTURE
    known = {*catalogue.facts, *catalogue.inputs, catalogue.position.name}
    for inputs in catalogue.variant_inputs.values():
        known |= set(inputs)
    lacking = [
        one.name
        for one in picture.points
        if one.kind in ("joint", "slider") and not {one.x, one.y} <= known | {0.0}
    ]
    if lacking:
        what = f"by {catalogue.position.name}, {mechanism} has no coordinates of {lacking[0]}"
        raise InputError(what, where=("input",), remedy="leave input out")
    return picture


def _numbers(catalogue: Catalogue, source: Source, problems: Problems) -> tuple[dict[str, float], Any, bool]:
    """Return the inputs of a design, the input positions or None, and whether an angle is given in degrees."""
    name = catalogue.position.name
    given = dict(source.inputs)
    in_degrees = any(map(angle_of, given))
    noted = len(problems.noted)
    given = radian_keywords(catalogue, "draw", given, problems, position=True)
    del problems.noted[noted:]  # which the evaluation refused
    positions, known = None, {one.where[:2] for one in problems.noted}
    if name in given and ("draw", name) not in known:
        with problems.at():
            positions = np.atleast_1d(numbers_of("draw", name, given.pop(name)))
            _check_positions(name, positions)
            if catalogue.position.units == RADIANS and not in_degrees:
                remark_on_angles(name, positions if positions.size > 1 else positions[0], "draw")
        given.pop(name, None)
    numbers = {}
    for key, value in given.items():
        if ("draw", key) not in known:
            with problems.at():
                numbers[key] = constant("draw", key, value)
    return numbers, positions, in_degrees


def _check_positions(name: str, positions: Any) -> None:
    """Refuse positions that are not finite, none, or too many."""
    if not 1 <= positions.size <= MOST_SHEETS:
        what = f"holds {positions.size} positions"
        raise InputError(what, where=("draw", name), remedy=f"write 1 to {MOST_SHEETS}")
    if not np.isfinite(positions).all():
        bad = positions[~np.isfinite(positions)][0]
        raise InputError(f"is {bad}", where=("draw", name), remedy="write finite numbers")


def _given(motion: Motion, *position: float) -> dict[str, Any]:
    of = {"branch": motion.branches[0], "links": motion.links, "input": motion.input}
    return {**of, **motion.design, **dict(zip([motion.input], position, strict=False))}


def _choices(
    catalogue: Catalogue, links: Links | None, numbers: Mapping[str, float]
) -> list[dict[str, float]]:
    """Return each value of a choice that the design leaves open, one alone where there are none."""
    variants = selected_variants(catalogue, links, "eliminated", numbers)
    found = all_choices(catalogue, numbers, variants)
    choices: list[dict[str, float]] = [{}]
    for name, codes in found.items():
        choices = [{**one, name: float(code)} for one in choices for code in codes]
    return choices


def _title(motion: Motion, count: int) -> str:
    """Return what tells a design from the others side by side."""
    inputs = motion.catalogue.known_inputs(motion.catalogue.variant_inputs)
    chosen = [name for name in motion.design if name in inputs and inputs[name].choices]
    if count < 2:
        return ""
    return ", ".join(
        f"{name} {motion.design[name]:g}: {in_words(inputs[name].choices[int(motion.design[name])])}"
        for name in chosen
    )


def _words(motion: Motion, show: Any) -> frozenset[str]:
    """Return the words of what is shown, or refuse unknown ones."""
    known = motion.picture.words
    if show is None:
        return frozenset(motion.picture.usual.split()) & set(known)
    words = _listed("show", show.split() if isinstance(show, str) else show)
    if ALL in words:
        loads = motion.picture.loads.items()
        lacking = {
            kind for kind, ones in loads if not all(motion.has(c) for one in ones for c in one.components)
        }
        return frozenset(known) - lacking
    problems = Problems()
    for word in words:
        with problems.at():
            check_choice(("show",), word, known, f" to {motion.mechanism}")
    problems.stop()
    asked = [one for kind, ones in motion.picture.loads.items() if kind in words for one in ones]
    if names := [one.components[0] for one in asked]:
        as_draw(lambda: evaluate(motion.mechanism, names, **_given(motion, 0.0)))
    return frozenset(words)


def _listed(parameter: str, given: Any) -> tuple[str, ...]:
    """Return the names of a list, none of an empty one."""
    return () if type(given) in (list, tuple) and not given else check_names(parameter, given)


def _curves(motion: Motion, curves: Any, own: str) -> tuple[str, ...]:
    """Return the quantities whose curves stand beside, or refuse what has none."""
    names = _listed("curves", curves)
    if len(names) > MOST_CURVES:
        what = f"names {len(names)} quantities"
        raise InputError(what, where=("curves",), remedy=f"write at most {MOST_CURVES}")
    problems = Problems()
    for k, name in enumerate(names):
        with problems.at("curves", k):
            if is_own(name, own):
                what = f"{name!r} is of quantities of a user's own, of which a map has the text and runs none"
                remedy = (
                    "draw the study that made the map, with ",
                    Setting("trust_code", True),
                    ", or the extension",
                )
                raise InputError(what, remedy=remedy)
            _check_curve(motion, name, k)
    problems.stop()
    return names


def _check_curve(motion: Motion, name: str, k: int) -> None:
    """Refuse a quantity without a curve over the input."""
    as_draw(lambda: evaluate(motion.mechanism, [name], **_given(motion, 0.0)), k)
    if not motion.catalogue.varies(name):
        curved = [one for one in motion.catalogue.public if motion.catalogue.varies(one)]
        what = f"{name} is one number for a design"
        raise InputError(what, remedy=suggest(name, curved))

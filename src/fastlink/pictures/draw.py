"""Draw a mechanism: find its design, check the request, draw, write."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from importlib.util import find_spec
from inspect import signature
from itertools import product
from pathlib import Path
from shutil import which
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink._text import counted, in_words, short_repr
from fastlink.app.study import read_study
from fastlink.engine.designs import designs_of
from fastlink.engine.evaluate import evaluate
from fastlink.engine.extend import is_own
from fastlink.errors import (
    InputError,
    Problem,
    Problems,
    Setting,
    check_choice,
    check_path,
    check_switch,
    check_whole,
    door,
    listed,
    remark,
    require_package,
    suggest,
)
from fastlink.io.output import write_whole
from fastlink.io.reader import as_map
from fastlink.mechanisms import NAMES, SHEET, mechanism_of_map, name_of, picture_of_own
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.pictures.cad import DXF, is_cad, written
from fastlink.pictures.maps import nearest_place, values_at
from fastlink.pictures.motion import Motion, as_draw
from fastlink.pictures.picture import KINDS, check_picture, save
from fastlink.plan.query import check_names
from fastlink.plan.request import all_choices, check_branches, check_model, keywords_in_si, selected_variants
from fastlink.space.design_space import (
    BRANCH,
    DESIGN,
    EXTREMUM,
    Links,
    constant,
    has,
    numbers_of,
    taken_links,
)
from fastlink.space.tables import STATUS
from fastlink.space.units import (
    DEGREES,
    RADIANS,
    has_unit,
    remark_on_angles,
    split,
    usual_name,
    with_unit,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fastlink.engine.extend import Extension
    from fastlink.facts.catalogue import Catalogue
    from fastlink.mechanisms._shared.picture import Picture
    from fastlink.space.design_space import DesignSpace


# -- Find the design that is drawn: by numbers, in a study, or in a map


#: Designs of a study that are tried where none is chosen.
MOST_TRIED = 65
#: Dimensions of what a synthesis says of the points of its task.
OF_A_TASK = ("point", "peak")
STUDY, MAPS = ".toml", (".h5", ".hdf5", ".nc", ".he5")


@dataclass(frozen=True)
class Source:
    """A design, as it was given: its inputs and position, branches, masses, what drives; own quantities' text."""

    mechanism: str | Extension
    inputs: dict[str, Any]
    branch: Any = None
    links: Links | None = None
    input: str | None = None
    own: str = ""
    #: The points of the task of a linkage that was synthesised (points, 2), in its ground frame.
    target: Any = None


def read_source(
    mechanism: Any, design: Any, at: Any, inputs: Mapping[str, Any], trust_code: bool = False
) -> Source:
    """Return the design that a caller names, or refuse it."""
    is_map = has(mechanism, "data_vars")
    if is_map or _is_file(mechanism):
        source = mechanism if is_map else check_path(("mechanism",), mechanism)
        is_study = not is_map and source.suffix.lower() == STUDY
        found = _of_study(source, design, at, trust_code) if is_study else _of_map(source, design, at)
        catalogue = find_catalogue(found.mechanism, found.input)
        known = {*catalogue.all_inputs, catalogue.position.name}
        anew = {split(key, known)[0] for key in inputs}
        own = {key: value for key, value in found.inputs.items() if split(key, known)[0] not in anew}
        return replace(found, inputs={**own, **inputs})
    find_catalogue(mechanism)
    if at is not None:
        remedy = "leave it out, and give inputs by name"
        raise InputError("selects a design of a study or a map", where=("at",), remedy=remedy)
    if design is not None and not isinstance(design, Mapping):
        what = f"is {short_repr(design)}"
        raise InputError(what, where=("design",), remedy="write the inputs by name, such as a1=0.4")
    names = {} if design is None else dict(design)
    for name in names:
        if not isinstance(name, str):
            raise InputError(f"names {short_repr(name)}", where=("design",), remedy="write names of inputs")
        if name in inputs:
            raise InputError(f"{name} is given twice", where=("design",), remedy="write it once")
    return Source(mechanism, {**names, **inputs})


def _is_file(source: Any) -> bool:
    """Tell whether a caller means a file rather than a mechanism."""
    if isinstance(source, str) and (source in NAMES or "\0" in source):
        return False
    try:
        is_path = isinstance(source, os.PathLike)
        return is_path or (isinstance(source, str) and Path(source).suffix.lower() in (STUDY, *MAPS))
    except Exception:  # whatever a class of somebody's does
        return False


def _of_study(path: Any, design: Any, at: Any, trust_code: bool) -> Source:
    """Return a design of a study."""
    study, problems = read_study(path, trust_code), Problems()
    options = study.options
    links, input = options.get("links"), options.get("input")
    catalogue = find_catalogue(study.mechanism, input)
    space = designs_of(catalogue, study.space, links, problems)
    problems.stop()
    known = {name: one.units for name, one in catalogue.all_inputs.items()}
    along = {dim: space.axes.get(dim, np.arange(n)) for dim, n in zip(space.dims, space.shape, strict=True)}
    if along and space.size > 1 and design is None and at is None:
        place = _first_that_assembles(study.mechanism, space, links, input)
        remark(f"design {place} of {space.size:,} is drawn", ("design",))
    else:
        place = int(np.ravel_multi_index(_places(along, design, at, known), space.shape)) if along else 0
    inputs = {name: float(values[0]) for name, values in space.at(np.array([place])).items()}
    return Source(study.mechanism, inputs, options.get("branch"), links, input)


def _first_that_assembles(mechanism: Any, space: DesignSpace, links: Links | None, input: str | None) -> int:
    """Return the number of a design that moves: of some at even distances the nearest to the middle that does."""
    places = np.unique(np.linspace(0, space.size - 1, MOST_TRIED).astype(np.int64))
    places = places[np.argsort(abs(places - space.size // 2), kind="stable")]
    given = {} if links is None else links.values
    columns: dict[str, Any] = {name: values for name, values in space.at(places).items() if name not in given}
    known = evaluate(mechanism, [STATUS], links=links, input=input, allow_invalid=True, **columns)[STATUS]
    code = int(known.min())  # the lower, the freer: 0 is a crank that turns
    return int(places[int(np.argmax(known == code))])


def _of_map(maps: Any, design: Any, at: Any) -> Source:
    """Return a design of a map, or of rows of it; of a row, its branch and input position too."""
    with as_map(maps) as dataset:
        mechanism, input = mechanism_of_map(dataset.attrs), str(dataset.attrs.get("input"))
        catalogue = find_catalogue(mechanism, input)
        dims = [*(dataset[STATUS].dims if STATUS in dataset else ()), *dataset.dims]
        outside = {BRANCH, EXTREMUM, catalogue.position.name, *OF_A_TASK}
        along = {
            str(dim): dataset[dim].values if dim in dataset.coords else np.arange(dataset.sizes[dim])
            for dim in dict.fromkeys(dims)
            if dim not in outside
        }
        stated = {dim: dataset[dim].attrs.get("units", "1") for dim in along}
        row = dataset.isel(dict(zip(along, _places(along, design, at, stated), strict=True)))
        known = {name: one.units for name, one in catalogue.known_inputs(catalogue.variant_inputs).items()}
        known[catalogue.position.name] = catalogue.position.units
        inputs: dict[str, Any] = {}
        for name in known:
            if name in row.variables and row[name].ndim == 0:
                units = str(row[name].attrs.get("units", known[name]))
                inputs[name if has_unit(units, known[name]) else with_unit(name, units)] = float(row[name])
        branch = int(row[BRANCH]) if BRANCH in row.coords and row[BRANCH].ndim == 0 else None
        own = str(dataset.attrs.get("own_quantities", ""))
        target = _target_of(row)
        if target is not None:  # it stands at the first point
            inputs[catalogue.position.name] = float(row[catalogue.position.name][0])
    links = taken_links(inputs)
    return Source(mechanism, inputs, branch, links, input, own, target)


def _target_of(row: Any) -> Any:
    """Return the points of a task in the ground frame of the linkage that was found for it; None of other rows."""
    if not {"target_x", "target_y", "O_x", "O_y", "ground_angle"} <= set(row.variables):
        return None
    away = (row["target_x"] - row["O_x"]) + 1j * (row["target_y"] - row["O_y"])
    turned = np.asarray(away.values * np.exp(-1j * float(row["ground_angle"])))
    return np.stack([turned.real, turned.imag], axis=-1)


def _places(along: Mapping[str, Any], design: Any, at: Any, units: Mapping[str, str]) -> tuple[int, ...]:
    """Return the place of a design along each dimension: by its number in C order, or by values."""
    shape = tuple(len(values) for values in along.values())
    size = int(np.prod(shape, dtype=np.int64))
    if size == 0:
        raise InputError("there are no designs", where=("mechanism",), remedy="draw one of another map")
    if design is not None and at is not None:
        raise InputError("is given beside design", where=("at",), remedy="leave one of them out")
    if at is not None:
        return _nearest_places(along, at, units)
    if design is None and size > 1:
        dim = next(iter(along))
        example = {dim: float(along[dim][0])} if along[dim].dtype.kind in "iuf" else {}
        by_values = (", or ", Setting("at", example)) if example else ()
        remedy = ("choose one by ", Setting(DESIGN, 0), *by_values)
        raise InputError(f"there are {counted(size, 'design')}", where=("design",), remedy=remedy)
    number = 0 if design is None else check_whole(("design",), design, 0, size - 1)
    return tuple(int(k) for k in np.unravel_index(number, shape)) if shape else ()


def _nearest_places(along: Mapping[str, Any], at: Any, units: Mapping[str, str]) -> tuple[int, ...]:
    """Return the place that is nearest to given values along each dimension."""
    problems, places, at = Problems(), [], values_at(at, units)
    for dim in at:
        if dim not in along:
            problems.add(f"{short_repr(dim)} is not a dimension of the designs", ("at",), listed(list(along)))
    for dim, values in along.items():
        if dim not in at and len(values) > 1:
            problems.add(f"{dim} has {len(values)} values", ("at",), f"write which, such as {values[0]:g}")
        with problems.at():
            places.append(nearest_place(dim, values, at[dim]) if dim in at else 0)
    problems.stop()
    return tuple(places)


# -- Check a request to draw, and settle what the picture shows


#: The most linkages side by side, and curves beside them.
MOST_SHEETS, MOST_CURVES = 24, 6
ALL = "all"
#: Names of the evaluation that no input has; those that are options of a picture too.
OPTIONS, BESIDE_A_DESIGN = frozenset(signature(evaluate).parameters), ("branch", "input", "links")
#: How much farther than its positions the range of an input without bounds is shown.
BEYOND = 1.25


@dataclass(frozen=True)
class Request:
    """The whole of what a picture shows."""

    #: The designs side by side, one for each value of a choice.
    motions: tuple[Motion, ...]
    #: The input positions, side by side too.
    positions: Any
    #: Words, see `fastlink.draw`.
    show: frozenset[str]
    #: Quantities whose curves stand beside.
    curves: tuple[str, ...] = ()
    #: Whether angles are in degrees; whether the picture is to be animated, so that the view holds the whole motion.
    degrees: bool = False
    moves: bool = False

    @cached_property
    def sheets(self) -> list[tuple[Motion, float, str]]:
        """Each design at each position, with what tells it from the others."""
        found = []
        for motion, position in product(self.motions, self.positions.tolist()):
            parts = _choices(motion) if len(self.motions) > 1 else []
            if len(self.positions) > 1:
                parts.append(motion.stated(position, self.degrees, brief=True))
            found.append((motion, position, ", ".join(parts)))
        return found


def request_of(source: Source, strip: Any, curves: Any, show: Any, degrees: Any, moves: bool) -> Request:
    """Return what is drawn, or refuse it with all that is wrong."""
    links, catalogue = source.links, find_catalogue(source.mechanism, source.input)
    picture, problems = picture_of(name_of(source.mechanism), catalogue), Problems()
    branches: tuple[int, ...] = tuple(catalogue.branches)
    if source.branch is not None:
        branches = problems.attempt(check_branches, catalogue, source.branch)
    problems.attempt(check_model, catalogue, links, "eliminated")
    problems.attempt(check_switch, ("degrees",), degrees)
    with problems.at():
        strip = None if strip is None else check_whole(("strip",), strip, 2, MOST_SHEETS)
    inputs = {name: value for name, value in source.inputs.items() if name not in OPTIONS}
    for name in (name for name in source.inputs if name in OPTIONS):
        remedy = f"write it beside the design, {name}=..." if name in BESIDE_A_DESIGN else "leave it out"
        problems.add("is an option, not an input", ("draw", name), remedy)
    with problems.at():
        own: dict[str, Any] = {"links": links if isinstance(links, Links) else None, "input": source.input}
        of_position = catalogue.varies("status") and not any(
            split(name, (catalogue.position.name,))[0] == catalogue.position.name for name in inputs
        )
        somewhere = inputs | ({catalogue.position.name: 0.0} if of_position else {})
        as_draw(lambda: evaluate(source.mechanism, ["status"], **own, **somewhere))
    driving, several = (catalogue.position.name,), "holds several values"
    for k, one in enumerate(problems.noted):
        # an element of a list, as of a1=0,4
        if len(one.where) > 2 and split(str(one.where[1]), driving)[0] not in driving:
            problems.noted[k] = Problem(several, one.where[:2], "write one number, with a point")
    numbers, positions, in_degrees = _numbers(catalogue, source, problems)
    if positions is not None and strip is not None:
        problems.add("is given beside strip", ("draw", catalogue.position.name), "leave one of them out")
    if moves and (strip is not None or (positions is not None and positions.size > 1)):
        problems.add("shows one position that moves", ("animate",), "leave strip and further positions out")
    problems.stop()
    reach = 0.0 if positions is None else BEYOND * float(np.abs(positions).max())
    variants = selected_variants(catalogue, links, "eliminated", numbers)
    choices, given = all_choices(catalogue, numbers, variants), tuple(sorted(branches))
    designs = [
        numbers | dict(zip(choices, map(float, one), strict=True)) for one in product(*choices.values())
    ]
    motions = tuple(Motion(source.mechanism, catalogue, picture, one, given, links, reach) for one in designs)
    words, names = _words(motions[0], show), _curves(motions[0], curves, source.own)
    degrees = degrees or in_degrees or positions is None
    key = usual_name(catalogue.position.name, RADIANS) if in_degrees else catalogue.position.name
    drawable = tuple(motion for motion in motions if motion.ranges) or motions[:1]
    for motion in drawable:
        motion.check(positions, degrees, key)
    if positions is None:
        positions = drawable[0].spread(strip, ends=False) if strip else np.array([drawable[0].usual])
    if source.branch is None and (moves or words & set(motions[0].picture.loads)):
        # the first that a design has there: arrows and films of several cover each other
        places = [int(motion.assembles(positions).any(axis=1).argmax()) for motion in drawable]
        drawable = tuple(
            replace(motion, branches=(motion.branches[k],))
            for motion, k in zip(drawable, places, strict=True)
        )
    return Request(drawable, positions, words, names, degrees, moves)


def picture_of(mechanism: str, catalogue: Catalogue) -> Picture:
    """Return what a mechanism declares to be drawn, or refuse one that does not."""
    try:
        picture: Picture = (
            picture_of_own(mechanism) or import_module(f"fastlink.mechanisms.{mechanism}").PICTURE
        )
    except (ModuleNotFoundError, AttributeError):
        remedy = f"declare its joints and bars in mechanisms/{mechanism}/__init__.py"
        if "@" in mechanism or mechanism.endswith(SHEET):
            remedy = "plot its curves: a sheet has no joints and bars"
        raise InputError(f"{mechanism} has no picture", where=("mechanism",), remedy=remedy) from None
    inputs = catalogue.known_inputs(catalogue.variant_inputs)
    known = {*catalogue.facts, *inputs, catalogue.position.name, 0.0}
    for one in picture.points:
        if one.kind in ("joint", "slider") and not {one.x, one.y} <= known:
            what = f"by {catalogue.position.name}, {mechanism} has no coordinates of {one.name}"
            raise InputError(what, where=("input",), remedy="leave input out")
    return picture


def _numbers(catalogue: Catalogue, source: Source, problems: Problems) -> tuple[dict[str, float], Any, bool]:
    """Return the inputs of a design, the input positions or None, and whether an angle is given in degrees."""
    name = catalogue.position.name
    given = dict(source.inputs)
    units = [split(key, {*catalogue.all_inputs, name})[1] for key in given]
    in_degrees = not DEGREES.isdisjoint(units)
    noted = len(problems.noted)
    given = keywords_in_si(catalogue, "draw", given, problems, position=True)
    del problems.noted[noted:]  # which the evaluation refused
    positions, known = None, {one.where[:2] for one in problems.noted}
    if name in given and ("draw", name) not in known:
        with problems.at():
            positions = np.atleast_1d(numbers_of("draw", name, given.pop(name)))
            if not 1 <= positions.size <= MOST_SHEETS:
                problems.add(f"holds {positions.size} positions", ("draw", name), f"write 1 to {MOST_SHEETS}")
            elif catalogue.position.units == RADIANS and not in_degrees:
                remark_on_angles(name, positions if positions.size > 1 else positions[0], "draw")
        given.pop(name, None)
    numbers = {}
    for key, value in given.items():
        if ("draw", key) not in known:
            with problems.at():
                numbers[key] = constant("draw", key, value)
    return numbers, positions, in_degrees


def _check_computed(motion: Motion, names: list[str], curve: int = 0) -> None:
    """Refuse quantities that the design does not give, as the evaluation does."""
    of = {"branch": motion.branches[0], "links": motion.links, "input": motion.input}
    given: dict[str, Any] = {**of, **motion.design, motion.input: 0.0}
    as_draw(lambda: evaluate(motion.mechanism, names, **given), curve)


def _choices(motion: Motion) -> list[str]:
    """Return the inputs of a design that are choices, and what they mean."""
    known = motion.known_inputs
    return [
        f"{name} {value:g}: {in_words(known[name].choices[int(value)])}"
        for name, value in motion.design.items()
        if name in known and known[name].choices
    ]


def _words(motion: Motion, show: Any) -> frozenset[str]:
    """Return the words of what is shown, or refuse unknown ones and those of which the design lacks inputs."""
    known, loads = motion.picture.words, motion.picture.loads
    if show is None:
        return frozenset(motion.picture.usual.split()) & set(known)
    words = _listed("show", show.split() if isinstance(show, str) else show)
    lacking = {locus.group: motion.lacks(locus) for locus in motion.picture.loci}
    if ALL in words:
        for kind, ones in loads.items():
            lacking[kind] = [name for one in ones for name in one.components if not motion.has(name)]
        return frozenset(word for word in known if not lacking.get(word))
    problems = Problems()
    for word in words:
        with problems.at():
            check_choice(("show",), word, known, f" to {motion.mechanism}")
        for name in lacking.get(word, ()):
            problems.add(f"{name} is missing; {word} depends on it", ("draw",), "add it")
    problems.stop()
    if names := [one.components[0] for kind, ones in loads.items() if kind in words for one in ones]:
        _check_computed(motion, names)
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
                trusted = Setting("trust_code", True)
                remedy = ("draw the study that made the map, with ", trusted, ", or the extension")
                raise InputError(what, remedy=remedy)
            _check_computed(motion, [name], k)
            if not motion.catalogue.varies(name):
                curved = [one for one in motion.catalogue.public if motion.catalogue.varies(one)]
                raise InputError(f"{name} is one number for a design", remedy=suggest(name, curved))
    problems.stop()
    return names


# -- Draw a mechanism: check the request, draw, write


#: Endings of what is drawn.
DRAWINGS = (*KINDS, DXF.removeprefix("."))
FILMS, MOST_FRAMES = ("gif", "html", "mp4"), 720


@door(hint="inputs are given by name, such as a1=0.4, or as design={...}")
def draw(
    mechanism: Any,
    design: Any = None,
    *,
    at: Mapping[str, float] | None = None,
    branch: Any = None,
    links: Links | None = None,
    input: str | None = None,
    strip: int | None = None,
    curves: Iterable[str] = (),
    show: Any = None,
    degrees: bool = False,
    to: str | Path | None = None,
    animate: str | Path | None = None,
    frames: int = 60,
    trust_code: bool = False,
    **inputs: Any,
) -> Figure:
    r"""Draw a mechanism to scale, as it stands at an input position.

    Links, joints, hatched ground, names as in the papers, the path of the coupler point, each branch in a colour
    of its own (the second with hollow bars and dashed curves), faintly where the motion ends. All places are facts of
    the mechanism, as `fastlink.evaluate` gives them.

    Parameters
    ----------
    mechanism : str, Extension, path or xarray.Dataset
        The name of a mechanism, or one that `fastlink.extend` returns; or a study, or a map, whose mechanism it is.
    design : mapping of str to float, or int, optional
        The inputs of a mechanism (or each by its name); of a study or a map, the number of the design, from 0.
    at : mapping of str to float, optional
        Of a study or a map, the design by the values of its dimensions, each the nearest one, in place of its number.
    branch : int or sequence of int, optional
        Branches; by default all, with forces and in films the first, or that of a row of `maps.fastlink.top`.
    links : Links, optional
        Where mass data come from, for forces.
    input : str, optional
        What drives, as in `fastlink.sweep`.
    strip : int, optional
        So many positions over the whole motion, side by side.
    curves : sequence of str, optional
        Quantities whose curves over the input stand beside the linkage, the position marked.
    show : str or sequence of str, optional
        What is shown besides the linkage, in place of the usual: words such as ``path``, ``limits``, ``circles`` (on
        which joints run), ``comb`` (the curvature of the path), ``forces``, ``torques``, ``all``; an unknown word is
        answered with those of the mechanism.
    degrees : bool, default False
        Show angles in degrees; so they are unless the input position is given in radians.
    to : path, optional
        The picture to write; its ending (png, svg, pdf) is its kind. An existing one is replaced. A name that ends in
        .dxf (by ezdxf) or .mm.svg is a drawing for CAD: bars, joints, ground and paths on layers of their own, with
        1 unit = 1 mm.
    animate : path, optional
        The moving picture to write, of one turn, or there and back through the range: gif, html (a page with a slider
        that needs nothing else), or mp4 if ffmpeg is installed.
    frames : int, default 60
        How many pictures it has.
    trust_code : bool, default False
        Run the Python file of quantities that a study names (see `fastlink.run`).
    **inputs : float or array_like
        The inputs, and the input position, such as ``theta1`` or ``theta1_deg``: one, or a list for as many linkages
        side by side. Left out, one a sixth of the turn, or a third of the way through the range.

    Returns
    -------
    matplotlib.figure.Figure
        The figure, which a notebook shows; it is not part of matplotlib's global state and need not be closed. None of
        a drawing for CAD where matplotlib is not installed, which it does not need.

    Raises
    ------
    InputError
        A name, value or word is unknown, the linkage does not assemble there, or matplotlib or ezdxf is missing.

    Examples
    --------
    >>> import fastlink as fl
    >>> figure = fl.draw("planar_4r", a1=0.4, a2=1.1, a3=0.8, a4=1.0, theta1_deg=60)
    >>> len(figure.axes)
    1
    >>> figure = fl.draw("hart", m=4.0, n=8.0, d=6.0, kappa=0.5, strip=4, branch=1)
    >>> [axis.get_title() for axis in figure.axes][2]
    '$\\phi$ = 180°'
    """
    path = None if to is None else check_picture(to, "to", kinds=DRAWINGS, example="linkage.png")
    if path is not None and path.suffix.lower() == DXF:
        require_package("ezdxf", ("to",))
    for_cad = path is not None and is_cad(path) and animate is None
    if not for_cad:
        require_package("matplotlib", ("draw",))
    film = None if animate is None else check_picture(animate, "animate", kinds=FILMS, example="linkage.gif")
    if film is not None and film.suffix.lower() == ".mp4" and which("ffmpeg") is None:
        remedy = "install it, such as by `apt install ffmpeg`, or write a .gif or an .html"
        raise InputError("ffmpeg, which writes films, is not installed", ("animate",), remedy)
    check_switch(("trust_code",), trust_code)
    frames = check_whole(("frames",), frames, 2, MOST_FRAMES)
    source = read_source(mechanism, design, at, inputs, trust_code)
    given = {"branch": branch, "links": links, "input": input}
    source = replace(source, **{name: value for name, value in given.items() if value is not None})
    request = request_of(source, strip, curves, show, degrees, film is not None)
    if path is not None and is_cad(path):
        write_whole(path, written(request, path))
    if for_cad and find_spec("matplotlib") is None:
        return None  # type: ignore[return-value]  # what a notebook has no picture for
    from fastlink.pictures.linkage import Board, write_film
    from fastlink.pictures.style import style

    with style():
        board = Board(request)
        board.show()
        if source.target is not None:
            for sheet in board.sheets:
                sheet.axis.plot(*source.target.T, "x", color="0.25", markersize=5.0, zorder=6.0)
        if path is not None and not is_cad(path):
            save(board.figure, path, "to")
        if film is not None:
            write_film(board, film, frames)
    return board.figure

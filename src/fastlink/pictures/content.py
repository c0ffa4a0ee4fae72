"""The content of the page that explores a map: values, colours, facts as JavaScript; put together."""

from __future__ import annotations

import ast
import json
import math
import threading
from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping
from functools import reduce
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fastlink._text import filled, in_words
from fastlink.errors import InputError
from fastlink.facts.arc import ARC_ENDS
from fastlink.facts.catalogue import Catalogue
from fastlink.facts.expression import SIGNS as OF_FORMULAS
from fastlink.facts.fact import Fact, System
from fastlink.facts.formula import Formula
from fastlink.facts.names import innermost, signed
from fastlink.io.reader import is_hdf5
from fastlink.maps.units import flags_of
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.mechanisms import mechanism_of_map
from fastlink.numerics import elementary, logarithm
from fastlink.numerics.compiler import COMPILED_AS, INLINED
from fastlink.pictures.draw import picture_of
from fastlink.pictures.motion import Motion
from fastlink.plan.query import parse_request
from fastlink.plan.request import constants_of
from fastlink.space.design_space import BRANCH, DESIGN, taken_links
from fastlink.space.tables import STATUS
from fastlink.space.units import DEGREES

if TYPE_CHECKING:
    from fastlink.mechanisms._shared.picture import Picture


# -- Write facts as JavaScript, so that a page moves a mechanism by the same formulas

# Doubles of JavaScript are those of IEEE 754, and each operation of a fact is one operation there: only
# functions that JavaScript has itself, such as the sine, may differ in their last bits.


#: Functions that JavaScript has.
OWN: dict[Any, str] = {
    elementary.sqrt: "Math.sqrt",
    elementary.atan2: "Math.atan2",
    elementary.cosine: "Math.cos",
    elementary.sine: "Math.sin",
    elementary.sin: "Math.sin",
    elementary.cos: "Math.cos",
    elementary.exp: "Math.exp",
    elementary.sinh: "Math.sinh",
    elementary.cosh: "Math.cosh",
    elementary.ldexp: "ldexp",
    elementary.binary_exponent: "binaryExponent",
    logarithm.log: "Math.log",
    logarithm.log1p: "Math.log1p",
    logarithm.log_quotient: "logQuotient",
    logarithm.quotient_sign: "quotientSign",
    np.sqrt: "Math.sqrt",
    np.copysign: "copysign",
    abs: "Math.abs",
}
PRELUDE = """\
const copysign = (x, y) => Math.abs(x) * (y < 0 || Object.is(y, -0) ? -1 : 1);
const ldexp = (x, times) => x * 2 ** times;
const binaryExponent = x => Math.round(x / Math.LN2);
const logQuotient = (x, y, twos) => x && y ? Math.log(Math.abs(x / y)) + twos * Math.LN2 : NaN;
const quotientSign = (x, y) => Math.sign(x) * Math.sign(y) || 0;
"""
SIGNS = {**OF_FORMULAS, ast.Pow: "**"}


class Untranslatable(Exception):
    """A text that has no counterpart in JavaScript."""


class _Script:
    """Functions in JavaScript, each after those that it calls."""

    def __init__(self) -> None:
        #: The name and the text of each.
        self.made: dict[Any, tuple[str, str]] = {}

    def add(self, function: Callable[..., Any]) -> str:
        """Return the name of a function in the script, to which it is added if it is not there."""
        if function not in self.made:
            text = _Text(self, function).text()
            name = f"f{len(self.made)}"
            self.made[function] = name, f"const {name} = {text};"
        return self.made[function][0]


class _Text:
    """One function as JavaScript."""

    def __init__(self, script: _Script, function: Callable[..., Any]) -> None:
        formula = Formula.of(function)
        self.script, self.body = script, formula.body
        self.scope, self.parameters = {"abs": abs, **formula.names}, formula.parameters
        stored = (node for line in self.body for node in ast.walk(line) if isinstance(node, ast.Name))
        self.local = {*self.parameters, *(node.id for node in stored if isinstance(node.ctx, ast.Store))}

    def text(self) -> str:
        """Return the whole function."""
        lines = " ".join(map(self.written, self.body))
        own = sorted(self.local - set(self.parameters))
        declared = f"let {', '.join(map(_own, own))}; " if own else ""
        return f"({', '.join(map(_own, self.parameters))}) => {{ {declared}{lines} }}"

    def written(self, node: ast.AST) -> str:
        """Return a statement, an expression, or what is assigned to."""
        match node:
            case ast.Return(value=ast.expr() as value):
                return f"return {self.written(value)};"
            case ast.Assign(targets=[target]):
                return f"{self.written(target)} = {self.written(node.value)};"
            case ast.Constant(value=bool() | int() | float() as number):
                return _number(number)
            case ast.Name(id=name) if name in self.local:
                return _own(name)
            case ast.Name() | ast.Attribute():
                return _number(self.global_of(node))
            case ast.Tuple(elts=parts):
                return f"[{', '.join(map(self.written, parts))}]"
            case ast.BinOp() if type(node.op) in SIGNS:
                return f"({self.written(node.left)} {SIGNS[type(node.op)]} {self.written(node.right)})"
            case ast.UnaryOp(op=ast.USub()):
                return f"(-{self.written(node.operand)})"
            case ast.Compare(ops=[sign], comparators=[other]) if type(sign) in SIGNS:
                return f"({self.written(node.left)} {SIGNS[type(sign)]} {self.written(other)})"
            case ast.Subscript(slice=ast.Constant(value=int() as place)):
                return f"{self.written(node.value)}[{place}]"
            case ast.Call(keywords=[]):
                return self.call(self.global_of(node.func), [self.written(arg) for arg in node.args])
        raise Untranslatable(ast.unparse(node))

    def global_of(self, node: ast.expr) -> Any:
        """Return what a name of the module, or of a module in it, stands for."""
        first, *rest = ast.unparse(node).split(".")
        try:
            return reduce(getattr, rest, self.scope[first])
        except (KeyError, AttributeError):
            raise Untranslatable(ast.unparse(node)) from None

    def call(self, function: Any, args: list[str]) -> str:
        """Return a call: of a choice, of a function of JavaScript, of one of the script."""
        if function is elementary.select:
            condition, yes, no = args
            return f"({condition} ? {yes} : {no})"
        if function not in OWN:
            function = COMPILED_AS.get(function, function)
            if function not in INLINED:
                raise Untranslatable(function)
        return f"{OWN.get(function) or self.script.add(function)}({', '.join(args)})"


def _own(name: str) -> str:
    """Return a name that is none of JavaScript's words."""
    return f"{name}_"


def _number(value: Any) -> str:
    """Return a number as JavaScript."""
    if not isinstance(value, (int, float, np.number, np.bool_)):
        raise Untranslatable(repr(value))
    text = json.dumps(bool(value) if isinstance(value, (bool, np.bool_)) else float(value))
    return f"({text})" if value < 0 else text.removesuffix(".0")


def script_of(
    catalogue: Catalogue, names: Iterable[str], given: Iterable[str], variants: Iterable[str]
) -> tuple[str, tuple[str, ...]]:
    """Return facts as an object of JavaScript, and those of the names that it has.

    The object holds for each value that is computed ``[function, needs, names]``: the function, the names of its
    arguments, and the names of its results. A fact without a counterpart in JavaScript is left out.

    Examples
    --------
    >>> from fastlink.mechanisms import catalogue
    >>> text, found = script_of(catalogue("planar_4r"), ["A_x"], ["a1"], ())
    >>> found
    ('A_x',)
    """
    script, lines, found = _Script(), dict[str, str](), list[str]()
    position, low_parts = catalogue.position.name, catalogue.table_low_parts
    tables = {*catalogue.tables, *low_parts}
    selected, known = tuple(variants), {*given, "branch", position, *tables}
    for name in dict.fromkeys(names):
        steps = [one for one in catalogue.dependencies([name], known, selected) if one.names[0] not in lines]
        before = dict(script.made)
        try:
            added = {own: _entry(script, one) for one in steps for own in one.names}
        except Untranslatable:
            script.made = before
            continue
        lines |= added
        found.append(name)
    for name in sorted(tables):
        is_low = name in low_parts
        function = "() => 0" if is_low else script.add(catalogue.tables[name].formula)
        lines[name] = f"[{function}, {json.dumps([] if is_low else [position])}, {json.dumps([name])}]"
    functions = "\n".join(text for _, text in script.made.values())
    entries = ",\n".join(f"{json.dumps(name)}: {line}" for name, line in lines.items())
    return f"(() => {{\n{PRELUDE}{functions}\nreturn {{\n{entries}\n}};\n}})()", tuple(found)


def _entry(script: _Script, step: Fact | System) -> str:
    """Return a step as an entry of the object."""
    if isinstance(step, System):
        raise Untranslatable(step.name)
    return f"[{script.add(step.formula)}, {json.dumps(step.depends_on)}, {json.dumps(step.names)}]"


# -- Tell a page what a map holds: its dimensions and variables, and the mechanism that it is of


def content_of(values: Values) -> dict[str, Any]:
    """Return what a page has to know of a map before it asks for values."""
    from fastlink.pictures.style import LINES, colour_tables

    maps = values.maps
    names = values.names
    if not names:
        raise InputError("has no variables of numbers", where=("maps",), remedy="give a map with results")
    drawn = {dim for name in names for dim in values.dims(name)}
    along = [
        str(name) for name, one in maps.coords.items() if one.dims == (DESIGN,) and one.dtype.kind in "iuf"
    ]
    return {
        "file": Path(str(values.path or maps.encoding.get("source", ""))).name,
        "title": str(maps.attrs.get("title", "")),
        "version": str(maps.attrs.get("fastlink_version", "")),
        "dims": [_dimension(maps, dim) for dim in map(str, maps.sizes) if dim in drawn],
        "columns": [{"name": name, **_labels(maps[name])} for name in along if name != DESIGN],
        "step": values.step,
        "constants": [
            {"name": str(name), "value": one.item(), **_labels(one)}
            for name, one in maps.coords.items()
            if one.ndim == 0 and one.dtype.kind in "iuf"
        ],
        "variables": [
            {"name": name, "dims": values.dims(name), **_request(maps, name), **_labels(maps[name])}
            for name in names
        ],
        "colours": colour_tables(),
        "modes": list(LINES),
        "mechanism": _mechanism(maps),
    }


def _labels(array: xr.DataArray) -> dict[str, Any]:
    """Return meaning, symbol and units, and the meanings of codes."""
    attrs = array.attrs
    flags = {str(code): in_words(meaning) for meaning, code in flags_of(array).items()}
    return {
        "meaning": str(attrs.get("long_name", array.name)),
        "symbol": str(attrs.get("symbol", array.name)),
        "units": str(attrs.get("units", "1")),
        **({"flags": flags} if flags else {}),
    }


def _catalogue_of(maps: xr.Dataset) -> Catalogue:
    """Return the mechanism of a map, as driven by its input, or refuse it."""
    driven = maps.attrs.get("input")
    return find_catalogue(mechanism_of_map(maps.attrs), None if driven is None else str(driven))


def _request(maps: xr.Dataset, name: str) -> dict[str, Any]:
    """Tell whether a study can ask for a variable, and of what quantity it is which reduction, "" of none."""
    try:
        asked = parse_request(name, _catalogue_of(maps))
    except InputError:
        return {"requested": False, "of": ["", ""]}
    # the page computes reductions over the whole turn, and no others
    plain = name == str(asked.of) and ARC_ENDS[0] not in maps.variables
    own = [signed(asked.quantity), asked.reduction.suffix if asked.reduction else ""]
    return {"requested": True, "of": own if plain else ["", ""]}


def _dimension(maps: xr.Dataset, dim: str) -> dict[str, Any]:
    """Return a dimension with its coordinates; without any, places; names where these are no growing numbers."""
    length = int(maps.sizes[dim])
    found: dict[str, Any] = {"name": dim, "length": length, **_labels(maps[dim])}
    if dim == DESIGN:
        return found
    along = maps[dim].values if dim in maps.coords else np.arange(length)
    numbers = along.dtype.kind in "iuf" and np.isfinite(along).all()
    steps = np.diff(along) if numbers else np.zeros(1)
    if numbers and ((steps > 0).all() or (steps < 0).all()) and "flags" not in found:
        return {**found, "values": along.tolist()}
    flags = found.get("flags", {})
    texts = [str(flags.get(str(one), one)) for one in along.tolist()]
    return {**found, "names": texts, "codes": along.tolist() if numbers else list(range(length))}


def _mechanism(maps: xr.Dataset) -> dict[str, Any] | None:
    """Return what moves beside the picture, None of a map whose mechanism cannot be drawn."""
    name = mechanism_of_map(maps.attrs)
    try:
        catalogue = _catalogue_of(maps)
        picture = picture_of(name, catalogue)
    except InputError:
        return None
    known = catalogue.known_inputs(catalogue.variant_inputs)
    inputs = {one: float(np.ravel(maps[one].values[..., None])[0]) for one in known if one in maps.variables}
    design = dict(inputs)
    links = taken_links(design)
    motion = Motion(name, catalogue, picture, design, tuple(catalogue.branches), links)
    every = constants_of(catalogue, links, motion.variants).items()
    constants = {one: value for one, value in every if one not in inputs}
    points = [one for one in motion.points if one.kind != "mark"]
    coordinates = [value for one in points for value in (one.x, one.y)]
    needed = [*coordinates, *(end for ends in picture.spans.values() for end in ends)]
    needed += [bar.orientation for bar in picture.bars if bar.orientation]
    curves = [one for one in _curves(maps, catalogue) if motion.has(one)]
    components = [one for loads in picture.loads.values() for load in loads for one in load.components]
    needed += [one for one in components if motion.has(one)]
    asked = [_request(maps, str(one))["of"][0] for one in maps.data_vars]
    facts = [one for one in [*needed, *curves, *asked] if isinstance(one, str) and one in catalogue.facts]
    script, found = script_of(catalogue, facts, [*inputs, *constants], motion.variants)
    in_script = {*found}
    if not catalogue.facts.keys() & coordinates <= in_script:
        return None
    position = catalogue.position
    return {
        "name": name,
        "title": catalogue.title,
        "script": script,
        "inputs": list(inputs),
        "rules": {one: known[one].rule for one in inputs if not known[one].choices},
        "degrees": [one for one in inputs if maps[one].attrs.get("units") in DEGREES],
        "constants": constants,
        "branches": {str(branch): meaning for branch, meaning in catalogue.branches.items()},
        "position": {"name": position.name, "symbol": position.symbol, "units": position.units,
                     "meaning": position.title},
        "turns": motion.turns,
        "study": {
            "links": [] if links is None else list(links.values),
            "model": "" if links is None else links.model,
            "count": int(maps.attrs.get(f"{position.name}_count", 0)),
            "extrema": str(maps.attrs.get("extrema", "")),
            "input": "" if catalogue is find_catalogue(name) else position.name,
        },
        "curves": [
            {"name": one, "meaning": fact.title, "symbol": fact.symbol, "units": fact.units}
            for one in curves if one in in_script and (fact := catalogue.public_fact(one))
        ],
        "loads": [
            {"of": one.components, "at": one.at, "units": fact.units, "symbol": fact.symbol.strip("|")}
            for ones in picture.loads.values() for one in ones
            if in_script.issuperset(one.components) and (fact := catalogue.public_fact(one.name))
        ],
        **_shape(picture, points),
    }  # fmt: skip


def _curves(maps: xr.Dataset, catalogue: Catalogue) -> list[str]:
    """Return the quantities that change over the input: first those that the map has results of."""
    own = [innermost(str(name), catalogue) for name in maps.data_vars if str(name) != BRANCH]
    return [
        one
        for one in dict.fromkeys([*own, *catalogue.public])
        if one in catalogue.public and catalogue.varies(one) and not catalogue.public[one].flags
    ]


def _shape(picture: Picture, points: list[Any]) -> dict[str, Any]:
    """Return the points and bars of a picture."""
    names = {one.name for one in points}
    return {
        "metric": picture.metric,
        "spans": {key: list(ends) for key, ends in picture.spans.items()},
        "points": [
            {"name": one.name, "x": one.x, "y": one.y, "kind": one.kind, "named": one.is_named, "group": one.group}
            for one in points
        ],
        "bars": [
            {"points": [one for one in bar.points.split() if one in names], "ground": bar.is_ground,
             "orientation": bar.orientation}
            for bar in picture.bars
        ],
        "guides": [{"x": one.x, "y": one.y, "slider": one.slider} for one in picture.guides if one.slider],
        "traced": [one for names in picture.traced.values() for one in names.split()],
    }  # fmt: skip


# -- Put the page together: one file, with its styles, its scripts and what it has to know of a map


#: The scripts, each after those that it needs.
SCRIPTS = "base motion linkage map source embedded region designs pointing main end"


def page_of(content: dict[str, Any], nonce: str = "") -> str:
    """Return the page of a map."""
    folder = files("fastlink").joinpath("pictures", "page")

    def text(name: str) -> str:
        return folder.joinpath(name).read_text(encoding="utf-8")

    mechanism = content["mechanism"]
    facts = mechanism["script"] if mechanism else "{}"
    shown = {**content, "mechanism": mechanism and {**mechanism, "script": ""}}
    # a text of the map must not end the script
    data = json.dumps(shown, allow_nan=False).replace("<", "\\u003c")
    scripts = [filled(text(f"{name}.js"), {"/*FACTS*/": facts}) for name in SCRIPTS.split()]
    script = "\n".join([f"const content = {data};", *scripts])
    return filled(text("page.html"), {"NONCE": nonce, "/*STYLE*/": text("style.css"), "/*SCRIPT*/": script})


# -- Bring the values of many designs to one for each cell of a picture: their mean, the least or the
#    greatest


#: By dimensions: a place, the first and the last one of a part, and all of them.
Places: TypeAlias = Mapping[str, int]
Window: TypeAlias = Mapping[str, tuple[int, int]]
Ranges: TypeAlias = Mapping[str, range]
#: The word for a picture that shows one design of each cell.
ONE = "one"
#: Values that are read at once.
BLOCK = 1 << 21


def _mean(cells: NDArray[Any]) -> NDArray[Any]:
    """Return the mean of the finite values; where there is none, infinity if a value is infinite, else NaN."""
    finite = np.isfinite(cells)
    count = finite.sum(axis=(1, 3))
    with np.errstate(invalid="ignore"):
        mean = np.where(finite, cells, 0.0).sum(axis=(1, 3)) / count
    return np.asarray(np.where(count > 0, mean, np.fmax.reduce(cells, axis=(1, 3))))


#: What becomes of a cell, of an array whose second and fourth axis are the values of one; NaN counts in none.
POOLS: dict[str, Callable[[NDArray[Any]], NDArray[Any]]] = {
    "mean": _mean,
    "least": lambda cells: np.fmin.reduce(cells, axis=(1, 3)),
    "greatest": lambda cells: np.fmax.reduce(cells, axis=(1, 3)),
}


# -- Read what a page shows of a map: a picture's values at the resolution of a screen, a row, a sample


#: Cells along a side of a picture; values from which a scale of colours is chosen; designs of a sample.
MOST_CELLS, SAMPLED, MOST_DESIGNS = 720, 1 << 18, 100_000
#: Pictures that are kept for the next step.
KEPT = 32
#: The most values of which the cells of a picture are made, where these hold several.
MOST_POOLED = 1 << 26


class Values:
    """The values of a map, as a page wants them."""

    def __init__(self, maps: xr.Dataset, path: Path | None = None) -> None:
        self.maps, self.path = maps, path
        self.lock = threading.Lock()
        self.mapped: dict[str, Any] = {}
        self.scales: dict[str, dict[str, Any]] = {}
        self.kept: OrderedDict[Any, NDArray[Any]] = OrderedDict()

    @property
    def names(self) -> list[str]:
        """The variables of numbers."""
        return [
            str(name) for name, one in self.maps.data_vars.items() if one.dtype.kind in "iuf" and one.size
        ]

    @property
    def step(self) -> int:
        """How many designs of a sample follow each other for one that is shown."""
        return -(-int(self.maps.sizes.get(DESIGN, 1)) // MOST_DESIGNS)

    def dims(self, name: str) -> list[str]:
        """Return the dimensions of a variable or coordinate."""
        return [str(dim) for dim in self.maps[name].dims]

    def part(self, name: str, places: Mapping[str, int | slice]) -> NDArray[Any]:
        """Return a part of a variable or coordinate.

        Of a file without compression it is taken straight from the bytes, which is 10 times as fast as by HDF5.
        """
        variable = self.maps[name].variable
        index = tuple(places.get(str(dim), slice(None)) for dim in variable.dims)
        with self.lock:
            if name not in self.mapped:
                self.mapped[name] = _mapped(self.path, name, variable)
            source = self.mapped[name]
            return np.asarray(variable[index].values if source is None else source[index])

    def along(self, name: str, at: Places, ranges: Ranges) -> NDArray[Any]:
        """Return a variable over ranges of places, in their order, repeated along those that it lacks."""
        slices = {dim: slice(one.start, one.stop, one.step) for dim, one in ranges.items()}
        dims = self.dims(name)
        found = self.part(name, {dim: slices[dim] if dim in slices else at[dim] for dim in dims})
        own = [dim for dim in dims if dim in ranges]
        found = found.transpose([own.index(dim) for dim in ranges if dim in own])
        whole = found[tuple(slice(None) if dim in own else None for dim in ranges)]
        return np.broadcast_to(whole, tuple(map(len, ranges.values())))

    def picture(
        self, name: str, axes: tuple[str, ...], at: Places, window: Window, pool: str = ONE
    ) -> tuple[NDArray[np.float32], dict[str, int], str]:
        """Return the values over one or two axes, the first along rows, the steps between them, and what they are."""
        dims = self.dims(name)
        own = [dim for dim in dims if dim in axes]
        ranges, steps = {}, {}
        for dim in own:
            low, high = window.get(dim, (0, self.maps.sizes[dim] - 1))
            most = MOST_CELLS if len(axes) > 1 else MOST_CELLS * MOST_CELLS
            ranges[dim] = range(low, high + 1)
            steps[dim] = max(1, -(-len(ranges[dim]) // most))
        size = math.prod(map(len, ranges.values()))
        if max(steps.values()) == 1 or size > MOST_POOLED or not self.scale(name)["pools"]:
            pool = ONE
        key = name, axes, str(ranges), str([at[dim] for dim in dims if dim not in own]), pool
        found = self.kept.get(key)
        if found is None:
            if pool == ONE:
                values = self.along(name, at, {dim: one[:: steps[dim]] for dim, one in ranges.items()})
            else:
                values = self._pooled(name, at, ranges, steps, pool)
            order = [own.index(axis) for axis in axes if axis in own]
            found = np.ascontiguousarray(values.transpose(order), dtype=np.float32)
            with self.lock:
                self.kept[key] = found
                while len(self.kept) > KEPT:
                    self.kept.popitem(last=False)
        return found, steps, pool

    def _pooled(
        self, name: str, at: Places, ranges: Ranges, steps: Mapping[str, int], pool: str
    ) -> NDArray[np.float32]:
        """Return one value for each cell, in the order of the variable's dimensions, read a few rows at a time."""
        first, *others = ranges
        down, across = steps[first], steps[others[0]] if others else 1
        columns = math.prod(len(ranges[dim]) for dim in others)
        high = max(1, BLOCK // (down * columns)) * down
        found = []
        for start in range(0, len(ranges[first]), high):
            part = {**ranges, first: ranges[first][start : start + high]}
            block = self.along(name, at, part).reshape(-1, columns).astype(float)
            beyond = (-block.shape[0] % down, -columns % across)
            padded = np.pad(block, [(0, one) for one in beyond], constant_values=np.nan)
            cells = padded.reshape(padded.shape[0] // down, down, padded.shape[1] // across, across)
            found.append(POOLS[pool](cells).astype(np.float32))
        whole = np.concatenate(found)
        return whole if others else whole[:, 0]

    def column(self, name: str, at: Places) -> NDArray[np.float32]:
        """Return the values of a variable or coordinate of the designs of a sample."""
        some = range(0, self.maps.sizes[DESIGN], self.step)
        return self.along(name, at, {DESIGN: some}).astype(np.float32)

    def row(self, at: Places) -> dict[str, Any]:
        """Return all values of one place, those of inputs along ``design`` too."""
        found = {}
        for name in (*self.names, *map(str, self.maps.coords)):
            dims = self.dims(name)
            if name in at or not set(dims) <= at.keys() or not dims:
                continue
            value = self.part(name, {dim: at[dim] for dim in dims})
            found[name] = value.item() if value.dtype.kind in "iuf" else str(value)
        return found

    def scale(self, name: str) -> dict[str, Any]:
        """Return how the values of a variable become colours, from a sample of all of them."""
        if name not in self.scales:
            from fastlink.pictures.style import scale_of

            array = self.maps[name]
            some = _thinned({dim: range(array.sizes[dim]) for dim in self.dims(name)}, SAMPLED)
            self.scales[name] = scale_of(array, self.along(name, {}, some), self._regular(name, some))
        return self.scales[name]

    def _regular(self, name: str, some: Ranges) -> Any:
        """Return which values of a sample are of designs without toggles, None where that is not known."""
        if STATUS not in self.names or name == STATUS or not {*self.dims(STATUS)} <= some.keys():
            return None
        flags = flags_of(self.maps[STATUS])
        return self.along(STATUS, {}, some) == next(iter(flags.values())) if flags else None


def _thinned(ranges: dict[str, range], most: int) -> dict[str, range]:
    """Return about so many places of ranges from 0, by steps along the longest first."""
    while math.prod(map(len, ranges.values())) > most:
        dim = max(ranges, key=lambda one: len(ranges[one]))
        ranges[dim] = range(0, ranges[dim].stop, ranges[dim].step + 1)
    return ranges


def _mapped(path: Path | None, name: str, variable: xr.Variable) -> Any:
    """Return the values of a variable as they lie in its file, None where they do not lie there as they are."""
    if path is None or not path.is_file() or not is_hdf5(path):
        return None
    with h5py.File(path, "r") as file:
        stored = file.get(name)
        if (
            not isinstance(stored, h5py.Dataset)
            or stored.chunks is not None
            or stored.shape != variable.shape
        ):
            return None
        offset = stored.id.get_offset()
        if offset is None or not stored.size:
            return None
        return np.memmap(path, dtype=stored.dtype, mode="r", offset=offset, shape=stored.shape)

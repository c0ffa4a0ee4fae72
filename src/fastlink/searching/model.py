"""Compute the results of a map again, anywhere between its designs: values and derivatives of many points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from fastlink.catalogue.declare import ELIMINATED
from fastlink.engine.declared import check_declared
from fastlink.engine.evaluate import evaluate
from fastlink.engine.function import function
from fastlink.errors import InputError
from fastlink.facts.names import derivative_name
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.positions import check_positions
from fastlink.plan.query import parse_request
from fastlink.plan.validate import selected_variants
from fastlink.space.links import MODELS, Links
from fastlink.symbolic.derivative import NoDependence, NoDerivative

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from fastlink.catalogue.catalogue import Catalogue
    from fastlink.engine.extending import Extension
    from fastlink.engine.function import Function

__all__ = ["Model", "Results", "angles_of"]


@dataclass(frozen=True, eq=False)
class Model:
    """A mechanism with the options of the sweep of a map.

    Attributes
    ----------
    mechanism : str or Extension
        Its name, or its extension by quantities of one's own.
    options : dict
        Links, input, solver, extrema and angles, as `fastlink.sweep` takes them.
    knows_positions : bool
        Whether the input positions of the sweep are known, or there is a usual choice of them.
    """

    mechanism: str | Extension
    options: dict[str, Any]
    knows_positions: bool = True

    @classmethod
    def of_map(cls, maps: xr.Dataset, own: Any = None) -> Model:
        """Return that of a map, by its labels, perhaps with the quantities of a user that it was made with."""
        attrs = maps.attrs
        name, input = str(attrs.get("mechanism")), attrs.get("input")
        mechanism: str | Extension = name
        if own is not None:
            mechanism = check_declared(("mechanism",), own, name, str(attrs.get("own_quantities", "")))
        catalogue = find_catalogue(mechanism, input)
        known = catalogue.known_inputs(catalogue.variant_inputs)
        given = [name for name in known if name in maps.variables]
        links = None
        for model, names in MODELS.items():
            if any(name in given for name in names):
                links = Links(model, {n: float(maps[n]) for n in names if n in given and not maps[n].dims})
        options = {"links": links, "input": input, "solver": attrs.get("solver", ELIMINATED)}
        positions = _positions(catalogue, maps)
        usual = catalogue.positions is None or maps.attrs.get(f"{catalogue.position.name}_count") is None
        return cls(mechanism, options | positions, usual or "angles" in positions)

    @cached_property
    def catalogue(self) -> Catalogue:
        """The mechanism, as it is driven."""
        return find_catalogue(self.mechanism, self.options.get("input"))

    @property
    def of_point(self) -> dict[str, Any]:
        """The options of an evaluation at single positions."""
        return {name: self.options.get(name) for name in ("links", "input", "solver") if name in self.options}


def _positions(catalogue: Catalogue, maps: xr.Dataset) -> dict[str, Any]:
    """Return the positions of the sweep of a map, and how its extremes were found, as far as it tells."""
    name, attrs = catalogue.position.name, maps.attrs
    count = attrs.get(f"{name}_count")
    found = {"extrema": attrs["extrema"]} if attrs.get("extrema") in ("refined", "sampled") else {}
    if name in maps.dims and name in maps.coords and count == maps.sizes[name]:
        own = angles_of(catalogue, np.asarray(maps[name].values, dtype=np.float64))
        return {**own, **found} if isinstance(own["angles"], int) else own
    if catalogue.positions is None and count is not None:
        return found | {"angles": int(count)}
    return found if catalogue.positions is None else {}


def angles_of(catalogue: Catalogue, positions: NDArray[np.float64]) -> dict[str, Any]:
    """Return input positions as the option of a sweep: the number of equal steps over one turn where they are these."""
    count = len(positions)
    if catalogue.positions is None and np.array_equal(positions, check_positions(catalogue, count)):
        return {"angles": count}
    return {"angles": positions}


@dataclass(frozen=True, eq=False)
class Results:
    """Some results of a model, as functions of some inputs.

    Attributes
    ----------
    model : Model
        The mechanism.
    names : tuple of str
        The results.
    pointwise : tuple of bool
        Which of them are of one input position.
    inputs : tuple of str
        The inputs that are given for each design; the last one is the input position where `at_position`.
    branch : int
        The assembly mode.
    codes : dict
        Inputs that are the same for all, such as choices.
    at_position : bool
        Whether designs come with an input position.
    """

    model: Model
    names: tuple[str, ...]
    pointwise: tuple[bool, ...]
    inputs: tuple[str, ...]
    branch: int
    codes: Mapping[str, float] = field(default_factory=dict)
    at_position: bool = False

    def values(self, designs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the results (points, results) of designs (inputs, points)."""
        found = np.empty((designs.shape[1], len(self.names)))
        if self._over_cycle is not None:
            found[:, self._of_cycle] = self._over_cycle(self._of_design(designs)).T
        if self._of_points:
            read = self._evaluated([self.names[k] for k in self._of_points], designs)
            for k in self._of_points:
                found[:, k] = read[self.names[k]]
        return found

    def slopes(self, designs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the derivatives (points, results, inputs); NaN of what has none."""
        found = np.zeros((designs.shape[1], len(self.names), len(self.inputs)))
        function, places = self._with_gradient
        absent = [k for k in self._of_cycle if k not in places]
        found[:, absent] = np.nan
        if function is not None:
            count = len(self.inputs) - self.at_position
            slopes = function.gradient(self._of_design(designs))
            found[:, places, :count] = np.moveaxis(slopes, 2, 0)
        names = self._slopes_at_points
        read = self._evaluated([name for name in names.values() if name], designs)
        for (k, j), name in names.items():
            found[:, k, j] = read[name] if name else np.nan
        return found

    def _of_design(self, designs: NDArray[np.float64]) -> NDArray[np.float64]:
        return designs[: len(self.inputs) - self.at_position]

    @property
    def _of_cycle(self) -> list[int]:
        return [k for k, one in enumerate(self.pointwise) if not one]

    @property
    def _of_points(self) -> list[int]:
        return [k for k, one in enumerate(self.pointwise) if one]

    def _function(self, names: Sequence[str]) -> Function:
        inputs = self.inputs[: len(self.inputs) - self.at_position]
        options: dict[str, Any] = {"branch": self.branch, **self.model.options, **self.codes}
        return function(self.model.mechanism, inputs, names, **options)

    @cached_property
    def _over_cycle(self) -> Function | None:
        names = [self.names[k] for k in self._of_cycle]
        return self._function(names) if names else None

    @cached_property
    def _with_gradient(self) -> tuple[Function | None, list[int]]:
        """The function of the results over the cycle that have derivatives, and their places."""
        if self._over_cycle is None:
            return None, []
        absent = self._over_cycle.without_gradient
        places = [k for k in self._of_cycle if self.names[k] not in absent]
        if len(places) == len(self._of_cycle):
            return self._over_cycle, places
        return self._function([self.names[k] for k in places]) if places else None, places

    def _evaluated(self, names: Sequence[str], designs: NDArray[np.float64]) -> dict[str, Any]:
        """Return quantities at single input positions."""
        if not names:
            return {}
        inputs = {**self.codes, **dict(zip(self.inputs, designs, strict=True))}
        options: dict[str, Any] = {**self.model.of_point, **inputs}
        names = list(dict.fromkeys(names))
        return evaluate(self.model.mechanism, names, branch=self.branch, allow_invalid=True, **options)

    @cached_property
    def _slopes_at_points(self) -> dict[tuple[int, int], str]:
        """The name of each derivative at an input position that is not 0 everywhere, empty where there is none."""
        catalogue, names = self.model.catalogue, dict[tuple[int, int], str]()
        given = [*self.inputs, *self.codes]
        links = self.model.options.get("links")
        variants = selected_variants(catalogue, links, self.model.options.get("solver", ELIMINATED), given)
        for k in self._of_points:
            for j, by in enumerate(self.inputs):
                name = derivative_name(self.names[k], by)
                try:
                    parse_request(name, catalogue)
                    catalogue.resolve(name, variants, given)
                    names[k, j] = name
                except NoDependence:
                    continue
                except (InputError, NoDerivative):
                    names[k, j] = ""
        return names

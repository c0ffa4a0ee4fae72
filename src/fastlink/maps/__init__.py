"""Functions of labelled maps: masks by status, infinite values, units, best designs.

They know a map by its labels alone, no mechanism. xarray objects have the attribute ``fastlink`` as soon as a map is
opened or computed, and xarray is not imported before that.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import xarray as xr

from fastlink._text import short_repr
from fastlink.errors import InputError, Suggesting, check_choice, door
from fastlink.io.reader import as_dataset
from fastlink.io.reader import open_map as open
from fastlink.maps.circuits import circuits_of
from fastlink.maps.units import (
    check_flags,
    convert,
    converted,
    degrees,
    finite,
    flag_counts,
    flags_of,
    has_flag,
    units_of,
)
from fastlink.space.tables import STATUS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from fastlink.pictures.explore import Page

__all__ = ["MapAccessor", "VariableAccessor", "open"]


@xr.register_dataset_accessor("fastlink")  # type: ignore[no-untyped-call]
class MapAccessor(Suggesting):
    """The attribute ``fastlink`` of a map.

    Examples
    --------
    >>> space = fl.grid(a1=[0.4, 0.5, 1.5], a2=1.2, a3=0.8, a4=1.0, omega1=25.0)
    >>> maps = fl.sweep("planar_4r", space, ["omega4_max", "theta4_max"], branch=1)
    >>> maps.fastlink.counts()["rotates_fully"]
    2
    >>> maps.fastlink.top(1, "omega4_max", largest=False).a1.values
    array([0.4])
    """

    def __init__(self, maps: xr.Dataset) -> None:
        self._maps = maps

    @door
    def status_is(self, *meanings: str, of: str = STATUS) -> xr.DataArray:
        """Return where a code has one of some meanings, as a mask.

        Parameters
        ----------
        *meanings : str
            Of the variable's ``flag_meanings``, such as ``"rotates_fully"`` or ``"rotates fully"``.
        of : str, default "status"
            The variable, such as ``"grashof_class"``.
        """
        array = self._coded(of)
        return has_flag(array, check_flags(array, ("meanings",), meanings))

    @door
    def where_status(self, *meanings: str, of: str = STATUS) -> xr.Dataset:
        """Return a copy with NaN where a code has none of some meanings; codes and counts stay.

        Parameters
        ----------
        *meanings, of : str
            As in `status_is`.
        """
        mask = self.status_is(*meanings, of=of)
        numbers = {
            name: array.where(mask).transpose(*array.dims, ...).assign_attrs(array.attrs).variable
            for name, array in self._maps.data_vars.items()
            if array.dtype.kind == "f" and set(mask.dims) <= set(array.dims)
        }
        return self._maps.assign(numbers)

    @door
    def counts(self, of: str = STATUS) -> dict[str, int]:
        """Return how many values of a code have each of its meanings.

        Parameters
        ----------
        of : str, default "status"
            The variable.
        """
        with as_dataset(self._maps):
            counted = flag_counts(self._coded(of))
        if counted is None:
            what = f"{short_repr(of)} holds values that are not codes"
            before = "count before averaging or masking"
            raise InputError(
                what, ("of",), before if flags_of(self._maps[of]) else "name a code, such as status"
            )
        return counted

    @door
    def finite(self) -> xr.Dataset:
        """Replace infinite values by NaN, and note how many there were.

        A quantity that grows without bound at a toggle has an infinite extreme. Matplotlib has no colour for it, and a
        mean over designs is infinite too.

        Returns
        -------
        xarray.Dataset
            A copy in memory, in which each variable that had infinite values has their number as attribute
            ``infinite_values``. Variables in dask chunks stay so, and are not counted.

        Examples
        --------
        >>> space = fl.grid(a1=[0.5, 1.5], a2=1.2, a3=0.8, a4=1.0, omega1=25.0)
        >>> maps = fl.sweep("planar_4r", space, ["omega4_max"])
        >>> finite = maps.fastlink.finite()
        >>> maps.omega4_max.values.round(2), finite.omega4_max.values.round(2)
        (array([16.91,   inf]), array([16.91,   nan]))
        >>> finite.omega4_max.attrs["infinite_values"]
        1
        """
        with as_dataset(self._maps) as maps:
            return maps.assign({name: finite(array).variable for name, array in maps.data_vars.items()})

    @door
    def summary(self) -> str:
        """Return what a sweep did as lines of text; of what `fastlink.accuracy` measures the table.

        Returns
        -------
        str
            Designs and how many have each status, configurations where there were given input positions, run time and
            speed, the largest errors that were measured; and the file with its size, for a map that is opened from one.
            Of a part of a map, the designs of that part. Of measured methods a line each, the fastest first; a star
            marks those that no other one beats in both error and time.

        Examples
        --------
        >>> space = fl.grid(a1=[0.4, 0.6], a2=1.2, a3=0.8, a4=1.0)
        >>> maps = fl.sweep("planar_4r", space, ["transmission_angle"])
        >>> print(maps.fastlink.summary().partition("run time")[0])
        designs         2
                            1  rotates fully                     50.0 %
                            0  assembles over part of the turn    0.0 %
                            0  never assembles                    0.0 %
                            1  change point                      50.0 %
                            0  invalid input                      0.0 %
                            0  assembles in one position          0.0 %
                            0  beyond range                       0.0 %
        configurations  720
        <BLANKLINE>
        """
        from fastlink.app.report import summary  # of maps and of what is measured, which stands above both

        return summary(self._maps)

    @door
    def degrees(self) -> xr.Dataset:
        """Return a copy whose angles, in radians, are in degrees, coordinates too.

        Rates, such as rad s-1, stay as they are: see `convert`.
        """
        with as_dataset(self._maps) as maps:
            return degrees(maps)

    @property
    def designs(self) -> xr.Dataset:
        """The inputs of the map without its results, to be swept again."""
        return self._maps.drop_vars(list(self._maps.data_vars))

    @property
    def plot(self) -> Plot:
        """``plot(names, ...)`` draws this map, see `fastlink.plot`."""
        return Plot(self._maps)

    @door
    def explore(self, *, to: Any = None, port: int = 0, browser: bool = True) -> Page:
        """Show this map in a browser, see `fastlink.explore`."""
        from fastlink.pictures.explore import explore

        return explore(self._maps, to=to, port=port, browser=browser)

    @property
    def units(self) -> dict[str, str]:
        """The units of each variable and coordinate, in the spelling of CF; ``1`` for pure numbers."""
        return units_of(self._maps)

    @door
    def convert(self, *of_all: str, **units: str) -> xr.Dataset:
        """Return a copy with some variables or coordinates in other units.

        Parameters
        ----------
        *of_all : str
            Units in which all of their kind are: ``"mm", "rpm"``.
        **units : str
            Those of single ones, such as ``a1="in"``. Units that no name of an input may end in are read by pint, the
            optional dependency ``units``.

        Raises
        ------
        InputError
            A name or unit is unknown, a unit is of another kind, or pint is missing.

        Examples
        --------
        >>> space = fl.grid(a1_mm=400, a2=1.2, a3=0.8, a4=1, omega1_rpm=60)
        >>> maps = fl.sweep("planar_4r", space, ["omega4_max"], branch=1)
        >>> shown = maps.fastlink.convert("mm", omega1="rpm")
        >>> shown.a1.item(), shown.a2.item(), shown.omega1.item()
        (400.0, 1200.0, 60.0)
        """
        with as_dataset(self._maps) as maps:
            return convert(maps, of_all, units)

    @door
    def circuits(self) -> xr.DataArray:
        """Return by branch and range what a declared linkage reaches without being taken apart, numbered from 1.

        Where a dyad is in its limit the linkage goes on with the other way to assemble it: ranges of several branches
        are one circuit. The map has ``theta_low``, ``theta_high``, ``theta_low_by`` and ``theta_high_by`` in all
        branches. The result has their shape; 0 is where there is no range.

        Raises
        ------
        InputError
            One of these, or a branch, is missing.

        Examples
        --------
        >>> linkage = fl.linkage(
        ...     ground={"O": (0, 0), "D": (0.4, 0)},
        ...     crank={"A": ("O", "a1")},
        ...     dyads={"B": {"rrr": ("A", "D"), "lengths": (0.3, 0.35)}},
        ... )
        >>> ends = ["theta_low", "theta_high", "theta_low_by", "theta_high_by"]
        >>> maps = fl.sweep(linkage, {"a1": [0.1, 0.3]}, ends, branch=(1, 2))
        >>> maps.fastlink.circuits()[..., 0].values  # a crank has two circuits, a rocker one
        array([[1, 2],
               [1, 1]], dtype=int32)
        """
        with as_dataset(self._maps) as maps:
            return circuits_of(maps)

    @door
    def top(
        self, n: int, by: str, *, largest: bool = True, where: Any = None, infinite: bool = False
    ) -> xr.Dataset:
        """Return the best designs: those with the greatest or least values of a variable.

        The map is read block by block and may be larger than memory.

        Parameters
        ----------
        n : int
            How many rows; there are fewer where the map has fewer.
        by : str
            The variable. A row is one of its values: a design in a branch, and at one input position if the
            variable has them.
        largest : bool, default True
            The greatest values; False for the least.
        where : xarray.DataArray, str, list of str or mapping, optional
            A mask, such as ``maps.transmission_angle_min > 0.7``; meanings of ``status``; or ranges, see
            `fastlink.best`, which takes several objectives too.
        infinite : bool, default False
            Consider infinite values too.

        Returns
        -------
        xarray.Dataset
            Along ``design``, the best first, equal ones in the order of the map: all inputs (those that are the same
            for all designs as scalars), the branch, and all results of that place. ``.to_dataframe()`` is the
            table of pandas. The attribute ``selection`` says how many values were considered and left out.
        """
        from fastlink.maps.best import top  # not whenever a map is opened

        with as_dataset(self._maps) as maps:
            return top(maps, n, by, largest=largest, where=where, infinite=infinite)

    def _coded(self, of: str) -> xr.DataArray:
        if not isinstance(of, str) or of not in self._maps.variables:
            check_choice(
                ("of",), of, [str(name) for name, one in self._maps.data_vars.items() if flags_of(one)]
            )
        return self._maps[of]


class Plot:
    """The door of a map to its pictures."""

    def __init__(self, maps: xr.Dataset) -> None:
        self._maps = maps

    @door(name="plot")
    def __call__(self, names: str | Sequence[str] = (), **options: Any) -> Figure:
        """Draw the map, see `fastlink.plot`."""
        from fastlink.pictures.designs import plot  # pictures stand above maps; this is their door

        return plot(self._maps, names, **options)

    if not TYPE_CHECKING:

        def __getattr__(self, name):
            raise AttributeError(
                f"there is no plot.{name}; write maps.fastlink.plot(names, ...), see fastlink.plot"
            )


@xr.register_dataarray_accessor("fastlink")  # type: ignore[no-untyped-call]
class VariableAccessor(Suggesting):
    """The attribute ``fastlink`` of a variable of a map.

    Examples
    --------
    >>> space = fl.grid(a1=[0.5, 1.5], a2=1.2, a3=0.8, a4=1.0, omega1=25.0)
    >>> maps = fl.sweep("planar_4r", space, ["omega4_max"], branch=1)
    >>> maps.omega4_max.fastlink.finite().max().round(2).item()
    16.91
    >>> maps.status.fastlink.status_is("rotates fully").values
    array([ True, False])
    """

    def __init__(self, array: xr.DataArray) -> None:
        self._array = array

    @door
    def status_is(self, *meanings: str) -> xr.DataArray:
        """Return where this code has one of some meanings, as a mask."""
        return has_flag(self._array, check_flags(self._array, ("meanings",), meanings))

    @door
    def finite(self) -> xr.DataArray:
        """Replace infinite values by NaN, and note how many there were, as those of a map."""
        return finite(self._array)

    @door
    def degrees(self) -> xr.DataArray:
        """Return a copy in degrees, if this is an angle in radians; its coordinates too."""
        return degrees(self._array)

    @door
    def convert(self, units: str) -> xr.DataArray:
        """Return a copy in other units, such as ``"rpm"``."""
        return converted(self._array, units)

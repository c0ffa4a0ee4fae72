"""Functions of labelled maps: masks by status, infinite values, units, best designs.

They know a map by its labels alone, no mechanism. `accessor` gives xarray objects the attribute ``fastlink``; it is
registered when a map is opened or computed, and xarray is not imported before that.
"""

from fastlink.io.reader import open_map as open
from fastlink.maps.accessor import MapAccessor, VariableAccessor
from fastlink.maps.units import finite

__all__ = ["MapAccessor", "VariableAccessor", "finite", "open"]

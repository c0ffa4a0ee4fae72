"""Functions of the planar 4R of the Minkowski plane; see `fastlink.analysis.minkowski`."""

from fastlink.analysis.minkowski import *  # noqa: F403
from fastlink.analysis.minkowski import __all__ as __all__
from fastlink.analysis.minkowski import __dir__ as __dir__

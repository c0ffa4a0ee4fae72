"""Functions of the planar 4R; see `fastlink.analysis.planar`."""

from fastlink.analysis.planar import *  # noqa: F403
from fastlink.analysis.planar import __all__ as __all__
from fastlink.analysis.planar import __dir__ as __dir__

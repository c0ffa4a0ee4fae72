"""Functions of Hart's linkages; see `fastlink.analysis.hart`."""

from fastlink.analysis.hart import *  # noqa: F403
from fastlink.analysis.hart import __all__ as __all__
from fastlink.analysis.hart import __dir__ as __dir__

"""Functions of Burmester's focal mechanism; see `fastlink.analysis.focal`."""

from fastlink.analysis.focal import *  # noqa: F403
from fastlink.analysis.focal import __all__ as __all__
from fastlink.analysis.focal import __dir__ as __dir__

"""The version of fastlink, and of what it is built on."""

from __future__ import annotations

from functools import cache
from importlib import metadata

__all__ = ["__version__", "version"]

UNKNOWN = "unknown"  # run from a source tree that is not installed


@cache
def version(distribution: str) -> str:
    """Return the version of an installed distribution."""
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return UNKNOWN


__version__ = version("fastlink-linkages")

"""Labelled HDF5 files: their layout, writing, resuming and reading.

Nothing here knows a mechanism or a kernel.
"""

from fastlink.io.reader import open_map as open

__all__ = ["open"]

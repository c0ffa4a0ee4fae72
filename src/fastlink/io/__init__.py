"""Labelled HDF5 files: what stands in them, reading and checking them; `writing` makes them.

Nothing here knows a mechanism or a kernel.
"""

from fastlink.io.reader import open_map as open

__all__ = ["open"]

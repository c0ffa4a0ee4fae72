"""Labelled HDF5 files: what stands in them, making, reading and checking them.

`writer` makes them, `reader` opens and checks them, `joining` puts parts together, `convert` writes other formats.
Nothing here knows a mechanism or a kernel.
"""

from fastlink.io.reader import open_map as open

__all__ = ["open"]

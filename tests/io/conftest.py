"""What the tests of files share."""

import pytest

from fastlink.io import checksums


@pytest.fixture
def small_blocks(monkeypatch):
    """Make the blocks of checksums as small as those of a large map are to it."""
    for module in ("checksums", "writer"):
        monkeypatch.setattr(f"fastlink.io.{module}.BLOCK_BYTES", 256)
    monkeypatch.setattr("fastlink.io.writer.READ_BYTES", 1024)
    monkeypatch.setattr(checksums, "READ_BYTES", 1000)

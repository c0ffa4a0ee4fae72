"""What the tests share: a kernel cache of their own, random designs, the 50-digit reference."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

# Before fastlink is imported anywhere: the tests neither use nor fill the user's cache.
os.environ.setdefault("FASTLINK_CACHE_DIR", tempfile.mkdtemp(prefix="fastlink-tests-"))


@pytest.fixture(scope="session", autouse=True)
def _kernel_cache() -> Iterator[None]:
    yield
    import shutil

    shutil.rmtree(os.environ["FASTLINK_CACHE_DIR"], ignore_errors=True)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an empty folder that is the current one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path

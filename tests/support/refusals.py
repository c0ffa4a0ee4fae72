"""Refusals: where something is wrong and what to write instead, whatever the words between."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from fastlink.errors import InputError


def assert_refusal(error: BaseException, key: str, remedy: str = "") -> None:
    """Assert that an error is one line, about what its key names, with a remedy."""
    (line,) = str(error).splitlines()
    found, _, mended = line.partition("; ")
    assert re.search(rf"(?<!\w){re.escape(key)}(?!\w)", found), line
    assert remedy in mended, line


@contextmanager
def refused(key: str, remedy: str = "") -> Iterator[None]:
    """Assert that an InputError is raised, about what its key names, with a remedy."""
    with pytest.raises(InputError) as caught:
        yield
    assert_refusal(caught.value, key, remedy)

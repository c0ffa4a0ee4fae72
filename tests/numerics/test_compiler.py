"""Texts of functions are read by any number of threads."""

import gc
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import fastlink
from fastlink.numerics.compiler import parsed


@pytest.fixture
def interrupted():
    """Let threads give way to each other wherever memory is asked for, as finalisers do now and then."""

    def give_way(phase, info):
        time.sleep(1e-6)

    threshold, interval = gc.get_threshold(), sys.getswitchinterval()
    gc.set_threshold(50)
    gc.callbacks.append(give_way)
    sys.setswitchinterval(1e-5)
    yield
    gc.callbacks.remove(give_way)
    gc.set_threshold(*threshold)
    sys.setswitchinterval(interval)


def test_trees_are_made_by_many_threads(interrupted):
    """Python 3.11 takes the calls of all threads for one, and some end with a SystemError."""
    texts = [path.read_text() for path in sorted(Path(fastlink.__file__).parent.glob("mechanisms/*/*.py"))]

    def deep(text, depth):
        return deep(text, depth - 1) if depth else parsed(text)

    with ThreadPoolExecutor(8) as pool:
        trees = list(pool.map(deep, 2 * texts, [k % 17 for k in range(2 * len(texts))]))
    assert all(tree.body for tree in trees)

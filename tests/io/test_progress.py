"""Where a progress bar is shown."""

import sys
from types import SimpleNamespace

import pytest

from fastlink.io.output_path import progress_bar


class ZMQInteractiveShell:
    """Stands for the shell of a notebook."""


@pytest.mark.parametrize("shell", [None, SimpleNamespace(), ZMQInteractiveShell()])
def test_a_notebook_has_a_bar_without_being_asked(shell, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    bar = progress_bar(10, " designs", None)
    assert (bar is not None) == isinstance(shell, ZMQInteractiveShell)
    if bar is not None:
        bar.update(10)
        bar.close()
        assert "10.0/10.0" in "".join(capsys.readouterr())
    assert progress_bar(10, " designs", False) is None

"""Check a picture's name before anything is drawn, and write it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from fastlink.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["check_picture", "require_matplotlib", "save"]

INSTALL = "python -m pip install 'fastlink-linkages[plot]'"


def require_matplotlib(where: str) -> None:
    """Check that matplotlib is installed."""
    try:
        import matplotlib  # noqa: F401
    except ModuleNotFoundError:
        raise InputError("matplotlib is not installed", where=(where,), remedy=INSTALL) from None


def check_picture(to: str | Path, where: str) -> Path:
    """Return the path of a picture to write.

    Raises
    ------
    InputError
        Matplotlib is missing or does not write pictures with this ending, or the folder does not exist.
    """
    require_matplotlib(where)
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    path, kinds = Path(to).expanduser(), FigureCanvasAgg.get_supported_filetypes()
    kind = path.suffix.removeprefix(".").lower()
    if kind not in kinds:
        ending = f"ends in {kind!r}" if kind else "has no ending"
        remedy = f"write one of {', '.join(sorted(kinds))}"
        raise InputError(f"{path}: the name of the picture {ending}", where=(where,), remedy=remedy)
    if not path.parent.is_dir():
        what = f"{path}: there is no folder {path.parent}"
        raise InputError(what, where=(where,), remedy="create it or choose another")
    return path


def save(figure: Figure, path: Path, where: str) -> None:
    """Write a picture; an existing one is replaced."""
    try:
        figure.savefig(path)
    except OSError as error:
        what = f"{path} cannot be written ({error.strerror})"
        raise InputError(what, where=(where,), remedy="choose another file") from error

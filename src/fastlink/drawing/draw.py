"""Draw a mechanism: check the request, draw, write."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastlink.doors import door
from fastlink.drawing.request import Options, request_of
from fastlink.drawing.source import read_source
from fastlink.options import check_switch, check_whole
from fastlink.plot.picture import check_picture, require_matplotlib, save

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fastlink.space.links import Links

__all__ = ["draw"]

FILMS, MOST_FRAMES = ("gif", "html", "mp4"), 720


@door(hint="inputs are given by name, such as a1=0.4, or as design={...}")
def draw(
    mechanism: Any,
    design: Any = None,
    *,
    at: Mapping[str, float] | None = None,
    branch: Any = None,
    links: Links | None = None,
    input: str | None = None,
    strip: int | None = None,
    curves: Iterable[str] = (),
    show: Any = None,
    degrees: bool = False,
    to: str | Path | None = None,
    animate: str | Path | None = None,
    frames: int = 60,
    trust_code: bool = False,
    **inputs: Any,
) -> Figure:
    r"""Draw a mechanism to scale, as it stands at an input position.

    Links, joints, hatched ground, names as in the papers, the path of the coupler point, each assembly mode in a colour
    of its own (the second with hollow bars and dashed curves), faintly where the motion ends. All places are facts of
    the mechanism, as `fastlink.evaluate` gives them.

    Parameters
    ----------
    mechanism : str, Extension, path or xarray.Dataset
        The name of a mechanism, or one that `fastlink.extend` returns; or a study, or a map, whose mechanism it is.
    design : mapping of str to float, or int, optional
        The inputs of a mechanism (or each by its name); of a study or a map, the number of the design, from 0.
    at : mapping of str to float, optional
        Of a study or a map, the design by the values of its dimensions, each the nearest one, in place of its number.
    branch : int or sequence of int, optional
        Assembly modes; by default all, or that of a row of `maps.fastlink.top`.
    links : Links, optional
        Where mass data come from, for forces.
    input : str, optional
        What drives, as in `fastlink.sweep`.
    strip : int, optional
        So many positions over the whole motion, side by side.
    curves : sequence of str, optional
        Quantities whose curves over the input stand beside the linkage, the position marked.
    show : str or sequence of str, optional
        What is shown besides the linkage, in place of the usual: words such as ``path``, ``limits``, ``circles`` (on
        which joints run), ``comb`` (the curvature of the path), ``forces``, ``torques``, ``all``; an unknown word is
        answered with those of the mechanism.
    degrees : bool, default False
        Show angles in degrees; so they are if one is given in degrees.
    to : path, optional
        The picture to write; its ending (png, svg, pdf) is its kind. An existing one is replaced.
    animate : path, optional
        The moving picture to write, of one turn, or there and back through the range: gif, html (a page with a slider
        that needs nothing else), or mp4 if ffmpeg is installed.
    frames : int, default 60
        How many pictures it has.
    trust_code : bool, default False
        Run the Python file of quantities that a study names (see `fastlink.run_study`).
    **inputs : float or array_like
        The inputs, and the input position, such as ``theta1`` or ``theta1_deg``: one, or a list for as many linkages
        side by side. Left out, one a sixth of the turn, or a third of the way through the range.

    Returns
    -------
    matplotlib.figure.Figure
        The figure, which a notebook shows; it is not part of matplotlib's global state and need not be closed.

    Raises
    ------
    InputError
        A name, value or word is unknown, the linkage does not assemble there, or matplotlib is missing.

    Examples
    --------
    >>> import fastlink as fl
    >>> figure = fl.draw("planar_4r", a1=0.4, a2=1.1, a3=0.8, a4=1.0, theta1_deg=60)
    >>> len(figure.axes)
    1
    >>> figure = fl.draw("hart", m=4.0, n=8.0, d=6.0, kappa=0.5, strip=4, branch=1)
    >>> [axis.get_title() for axis in figure.axes][2]
    '$\\phi$ = 3.142 rad'
    """
    require_matplotlib("draw")
    path = None if to is None else check_picture(to, "to", example="linkage.png")
    film = None
    if animate is not None:
        from fastlink.drawing.animation import check_film

        film = check_picture(animate, "animate", kinds=FILMS, example="linkage.gif")
        check_film(film)
    check_switch(("trust_code",), trust_code)
    frames = check_whole(("frames",), frames, 2, MOST_FRAMES)
    source = read_source(mechanism, design, at, inputs, trust_code)
    request = request_of(
        source, Options(branch, links, input, strip, curves, show, degrees, film is not None)
    )
    from fastlink.drawing.board import Board
    from fastlink.plot.figure import style

    with style():
        board = Board(request)
        board.show()
        if path is not None:
            save(board.figure, path, "to")
        if film is not None:
            from fastlink.drawing.animation import animate as write_film

            write_film(board, film, frames)
    return board.figure

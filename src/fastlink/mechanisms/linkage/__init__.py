"""Linkages that a user declares by their joints: a crank, then dyads, each of which a closed form places."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

from fastlink._text import short_repr
from fastlink.errors import InputError, door
from fastlink.facts.own import check_name
from fastlink.mechanisms import NAMES, Mechanism
from fastlink.mechanisms._shared.picture import Picture
from fastlink.mechanisms.linkage.forces import Forces
from fastlink.mechanisms.linkage.motion import Writer


def sheet_of_linkage(text: str) -> tuple[str, Picture]:
    """Return the sheet of formulas and the picture of a declaration, which is a text in JSON.

    Raises
    ------
    InputError
        The declaration is none, or places a point of too few or too many bars.
    """
    writer = Writer(json.loads(text))
    writer.place()
    if not OF_FORCES & writer.declared.keys():
        return writer.sheet(()), writer.picture(())
    forces = Forces(writer)
    variant = forces.write()
    return writer.sheet(variant), writer.picture(forces.drawn)


#: What forces need of a declaration, which has it only if it is given.
OF_FORCES = frozenset(("masses", "loads", "gravity"))


@door
def linkage(
    name: str = "linkage",
    *,
    ground: Mapping[str, Any],
    crank: Mapping[str, Any] | None = None,
    slider: Mapping[str, Any] | None = None,
    dyads: Mapping[str, Any],
    title: str = "",
    defaults: Mapping[str, float] | None = None,
    masses: Mapping[str, Any] | str | None = None,
    loads: Mapping[str, Any] | None = None,
    gravity: Sequence[Any] | None = None,
) -> Mechanism:
    """Declare a planar linkage by its joints: a crank, then dyads, each of which places a point or a link.

    A declaration is data; the same words stand in the table ``[linkage]`` of a study. Lengths and coordinates are names
    of inputs, which a design gives, or numbers, which are inputs with a default.

    Parameters
    ----------
    name : str, default "linkage"
        What it is called.
    ground : mapping
        The pivots of the ground by name, each with x and y, such as ``{"O": (0, 0), "D": ("a4", 0)}``.
    crank : mapping
        The pin of the crank, with its pivot and its length: ``{"A": ("O", "a1")}``. It turns by ``theta`` at the
        constant speed ``omega``.
    slider : mapping
        What drives in place of a crank: the pin of a slider, its fixed line, and the ends of its stroke,
        ``{"A": {"along": ("O", "beta"), "stroke": ("s_1", "s_2")}}``. It goes to and fro as ``theta`` turns, by a
        cosine; ``slide_A`` is its place.
    dyads : mapping
        What is placed one after the other, by the name of the point (or of the link with a slot):

        - ``{"rrr": ("A", "D"), "lengths": ("a2", "a3")}``: a pin that two bars from A and D join;
        - ``{"rrp": "A", "length": "l", "along": ("C", "E")}``: the end of a bar from A, a slider on the line through
          two points of one link, or on a fixed one through a pivot at an angle: ``("C", "beta")``;
        - ``{"rpr": ("A", "D"), "offset": "e"}``: a link about D, along whose slot the pin A slides, e to its left;
        - ``{"rpp": "A", "along": ("C", "E"), "angle": "beta"}``: a slider on a line, in whose slot the pin A slides;
        - ``{"prp": (("C", "E"), ("G", "H"))}``: a pin on two lines;
        - ``{"on": ("A", "B"), "at": ("P_u", "P_v")}``: a point of the link of A and B, so far along AB from A, and to
          the left; or by its distances from both, ``"lengths": ("d", "e")``, on the ``"side"`` "left" or "right"; of a
          link with a slot by its name, ``"on": "lever"``;
        - ``{"gear": ("O", "A"), "about": "D", "ratio": -2, "length": "b"}``: the end of a bar about D that a gear or a
          belt turns so many times as fast as OA, a whole number, ``"phase"`` ahead.
    title : str, optional
        What it is, for pictures and files.
    defaults : mapping of str to float, optional
        Numbers for inputs that a design need not give.
    masses : mapping or "round_bar", optional
        The mass of a link by its name, with its moment of inertia about the mass centre, and that centre along its axis
        and left of it: ``{"AB": {"mass": "m2", "inertia": "I2", "centre": ("G_u", "G_v")}}``; ``"round_bar"`` for a bar
        of two pins, or for all of them; the mass in a point, of a slider above all: ``{"B": "m3"}``.
    loads : mapping, optional
        A force on a point, ``{"P": ("F_x", "F_y")}``, or a torque on a link, ``{"DB": "T_load"}``.
    gravity : sequence, optional
        The acceleration of gravity, ``(0, -9.81)``.

    Returns
    -------
    str
        A name that stands for the mechanism wherever the name of one does, see `fastlink.mechanism`. Branches number
        the ways to assemble its dyads, which ``fl.quantities`` lists.

    Raises
    ------
    InputError
        Something cannot be placed: with the point, the reason and the remedy.

    Notes
    -----
    What a point B has: ``B_x``, ``B_y``, ``B_vx``, ``B_vy``, ``B_ax``, ``B_ay``, ``B_speed``, ``B_acceleration``,
    ``B_curvature``; a bar AB: ``angle_AB``, ``omega_AB``, ``alpha_AB``, ``jerk_AB``; a dyad of two ways:
    ``transmission_angle_B``; all dyads: ``least_transmission_angle``. With masses, loads or gravity: ``torque``,
    ``input_power``, ``shaking_force``, ``shaking_moment``, and the force on a link in a joint, such as ``force_AB_A``.

    Examples
    --------
    >>> import fastlink as fl
    >>> six_bar = fl.linkage(
    ...     "six_bar",
    ...     ground={"O": (0, 0), "D": ("a4", 0), "G": ("G_x", "G_y")},
    ...     crank={"A": ("O", "a1")},
    ...     dyads={
    ...         "B": {"rrr": ("A", "D"), "lengths": ("a2", "a3")},
    ...         "P": {"on": ("A", "B"), "at": ("P_u", "P_v")},
    ...         "F": {"rrr": ("P", "G"), "lengths": ("a5", "a6")},
    ...     },
    ... )
    >>> design = {"a1": 0.1, "a2": 0.3, "a3": 0.35, "a4": 0.4, "P_u": 0.15, "P_v": 0.1}
    >>> design |= {"G_x": 0.45, "G_y": 0.3, "a5": 0.3, "a6": 0.25, "omega": 10.0}
    >>> maps = fl.sweep(six_bar, design, ["F_x_max", "status"], branch=3)
    >>> float(maps.F_x_max.round(12))
    0.240003525055
    """
    where = ("linkage", "defaults")
    if defaults is not None and not isinstance(defaults, Mapping):
        raise InputError(
            f"is {short_repr(defaults)}", where, 'write numbers by the names of inputs, such as {"a1": 0.1}'
        )
    for key, value in (defaults or {}).items():
        if isinstance(value, bool) or not isinstance(value, Real) or float(value) - float(value) != 0.0:
            raise InputError(f"is {short_repr(value)}", (*where, str(key)), "write a number")
    if not isinstance(title, str) or not title.isprintable():
        raise InputError(f"is {short_repr(title)}", ("linkage", "title"), "write a text of one line")
    if (crank is None) == (slider is None):
        remedy = (
            'write crank={"A": ("O", "a1")}, or slider={"A": {"along": ("O", 0), "stroke": ("s_1", "s_2")}}'
        )
        raise InputError("has no drive" if crank is None else "has two drives", ("linkage",), remedy)
    declared: dict[str, Any] = {"name": name, "title": title, "ground": ground}
    declared |= {"slider": slider} if crank is None else {"crank": crank}
    declared |= {"dyads": dyads, "defaults": dict(defaults or {})}
    of_forces = {"masses": masses, "loads": loads, "gravity": gravity}
    declared |= {part: given for part, given in of_forces.items() if given is not None}
    try:
        check_name(name)
    except InputError as error:
        raise InputError(error.what, ("linkage", "name"), error.remedy) from None
    if name in NAMES:
        raise InputError(
            f"{name!r} is a mechanism of fastlink's own", ("linkage", "name"), "call it otherwise"
        )
    try:
        text = json.dumps(declared, default=_as_data)
    except (TypeError, ValueError) as error:
        raise InputError(str(error), ("linkage",), "write names, numbers, lists and mappings") from None
    return Mechanism(text, f"linkage {name}")


def _as_data(value: Any) -> Any:
    """Return a number or an array of NumPy as one of Python, or a list."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{short_repr(value)} is no number or name")

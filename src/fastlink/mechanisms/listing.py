"""List the mechanisms: what each is, what may drive it, how to begin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fastlink._text import folded, html_table
from fastlink.errors import door
from fastlink.mechanisms import NAMES, catalogue, inputs_of

if TYPE_CHECKING:
    from fastlink.typing import MechanismName

HEADER = ("name", "title", "inputs that may drive", "quantities", "a first study")
WIDTHS = (None, 46, 28, None, None)


@dataclass(frozen=True)
class Mechanism:
    """One mechanism.

    Attributes
    ----------
    name : str
        Its name, the first argument of `fastlink.sweep`.
    title : str
        What it is.
    inputs : tuple of str
        The inputs that may drive it; the first does unless another is named.
    quantities : int
        How many quantities it has by its first input, besides their reductions, derivatives and error bounds.
    template : str
        The command that prints a commented study of it.
    """

    name: MechanismName
    title: str
    inputs: tuple[str, ...]
    quantities: int
    template: str


class MechanismList(list[Mechanism]):
    """Mechanisms: a list that prints as a table."""

    def __repr__(self) -> str:
        return folded(HEADER, map(_cells, self), WIDTHS)

    __str__ = __repr__

    def _repr_html_(self) -> str:
        """Return the table as a notebook shows it."""
        return html_table(HEADER, map(_cells, self))


@door
def mechanisms() -> MechanismList:
    """List the mechanisms: title, inputs that may drive, number of quantities, a first study.

    Returns
    -------
    MechanismList
        A list of `Mechanism` that prints as a table.

    Examples
    --------
    >>> import fastlink as fl
    >>> [one.name for one in fl.mechanisms()]
    ['planar_4r', 'minkowski_4r', 'focal', 'hart', 'slider_crank']
    >>> fl.mechanisms()[3].inputs
    ('phi', 'F_y')
    """
    return MechanismList(
        Mechanism(
            name,
            catalogue(name).title,
            inputs_of(name),
            len(catalogue(name).public),
            f"fastlink new {name}",
        )
        for name in NAMES
    )


def _cells(one: Mechanism) -> tuple[str, ...]:
    return one.name, one.title, ", ".join(one.inputs), str(one.quantities), one.template

"""The commands on mechanisms and their kernels: mechanisms, quantities, new, cache."""

from __future__ import annotations

from typing import Annotated

import typer

from fastlink.cli.app import MechanismName, command

__all__ = ["cache", "mechanisms", "new", "quantities"]


@command
def mechanisms() -> None:
    """List the mechanisms."""
    from fastlink.mechanisms.listing import mechanisms as list_mechanisms

    typer.echo(str(list_mechanisms()))


@command
def quantities(
    mechanism: Annotated[
        str | None,
        typer.Argument(metavar="MECHANISM", help="Such as planar_4r; all with --find.", show_default=False),
    ] = None,
    every: Annotated[
        bool, typer.Option("--all", help="List intermediate facts too, which cannot be requested by name.")
    ] = False,
    input: Annotated[
        str | None, typer.Option("--input", metavar="INPUT", help="The driven input, such as joint_angle_2.")
    ] = None,
    find: Annotated[
        str | None, typer.Option("--find", metavar="PHRASE", help="Only what a phrase means, such as torque.")
    ] = None,
) -> None:
    """List the quantities and inputs of a mechanism, or find them by what they mean."""
    from fastlink.report.quantities import quantities as list_quantities

    typer.echo(str(list_quantities(mechanism, internal=every, input=input, find=find)))


@command
def new(
    mechanism: MechanismName,
) -> None:
    """Print a commented study that runs as it is.

    For instance: fastlink new planar_4r > study.toml
    """
    from importlib.resources import files

    from fastlink.mechanisms import NAMES
    from fastlink.options import check_choice

    check_choice(("mechanism",), mechanism, NAMES)
    template = files("fastlink").joinpath("mechanisms", mechanism, "study.toml")
    typer.echo(template.read_text(encoding="utf-8"), nl=False)


@command
def cache(
    clear: Annotated[bool, typer.Option("--clear", help="Remove all compiled kernels.")] = False,
) -> None:
    """Print where compiled kernels are kept and how large they are, or remove them.

    The environment variables FASTLINK_CACHE_DIR and FASTLINK_CACHE_BYTES set another folder and another limit.
    """
    from fastlink._text import counted, size
    from fastlink.codegen import cache as kernel_cache

    state = kernel_cache.clear() if clear else kernel_cache.contents()
    kernels = f"{counted(state.kernels, 'kernel')} of {size(state.size)}"
    if clear:
        left = kernel_cache.contents().size
        remark = f"; {size(left)} could not be removed" if left else ""
        typer.echo(f"{state.folder}: {kernels} removed{remark}")
    else:
        typer.echo(f"{state.folder}: {kernels}; beyond {size(state.limit)} the oldest are removed")

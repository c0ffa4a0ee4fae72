"""The check of each option of the doors, by the name that it has at all of them."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from fastlink._text import short_repr
from fastlink.errors import (
    MOST_SEED,
    InputError,
    KeyPath,
    Problems,
    check_choice,
    check_output,
    check_path,
    check_switch,
    check_whole,
)
from fastlink.io.joining import CORE_TIME, JOINED
from fastlink.io.layout import check_attrs
from fastlink.io.reader import OF_PARTS, check_part, check_size
from fastlink.mechanisms import NAMES, inputs_of
from fastlink.precision import check_verify
from fastlink.space.tables import FORMAT, LAYOUTS

Check = Callable[[KeyPath, Any], Any]

#: More threads than any machine has processors; as many as this take no longer to start than a short sweep to run.
MOST_THREADS = 4096
#: More designs take the 50-digit reference more than an hour for one quantity.
MOST_DESIGNS = 100_000
#: Global attributes that a sweep writes itself; `title`, `study` and `study_file` are those of a study.
RESERVED = frozenset(
    (
        *("Conventions", "mechanism", "input", "source", "backend", "solver", "threads"),
        *("extrema", "scaling_axis"),
        *("designs", "configurations", "configurations_per_second", "set_up_time_s", "run_time_s"),
        *(FORMAT, "written_time_ns", "fingerprint", "compression", "history"),
        *(*OF_PARTS, JOINED, CORE_TIME),
    )
)
#: How others begin: the origin of the designs, counts of each status, the verification.
BEGINNINGS = ("design_", "designs_", "fastlink_", "verified_", "verify_")


def is_reserved(name: str) -> bool:
    """Tell whether a sweep itself may write a global attribute of a name."""
    of_positions = name.endswith("_count") and any(
        name.removesuffix("_count") in inputs_of(mechanism) for mechanism in NAMES
    )
    return of_positions or name in RESERVED or name.startswith(BEGINNINGS)


def optional(check: Check) -> Check:
    """Return the check of an option that may be None."""
    return lambda where, value: None if value is None else check(where, value)


def check_client(where: KeyPath, value: Any) -> Any:
    """Return the workers of a client of dask.distributed, or refuse what is none or cannot be used from here."""
    distributed = sys.modules.get("distributed")  # who has a client has imported it
    write = "write a dask.distributed.Client, such as Client('tcp://127.0.0.1:8786')"
    if distributed is None or not isinstance(value, distributed.Client):
        raise InputError(f"is {short_repr(value)}", where, write)
    if value.asynchronous:
        raise InputError("is asynchronous", where, "write Client(..., asynchronous=False)")
    if value.status != "running":
        raise InputError(f"is {value.status}", where, "make it anew")
    from fastlink.engine.cluster import Cluster  # 25 ms of imports, for clusters alone

    return Cluster(value)


def check_announce(where: KeyPath, announce: Any) -> Any:
    """Return a function, or refuse what cannot be called."""
    if not callable(announce):
        remedy = "write a function that takes a line of text, such as print"
        raise InputError(f"is {short_repr(announce)}", where, remedy)
    return announce


#: The check of each option, by the name that it has at every door.
CHECKS: dict[str, Check] = {
    "allow_invalid": check_switch,
    "announce": optional(check_announce),
    "attrs": optional(partial(check_attrs, reserved=is_reserved)),
    "block": optional(partial(check_whole, least=1)),
    "client": optional(check_client),
    "contributions": check_switch,
    "designs": partial(check_whole, least=1, most=MOST_DESIGNS),
    "internal": check_switch,
    "layout": partial(check_choice, known=LAYOUTS),
    "measure": optional(check_switch),
    "outside": check_switch,
    "overwrite": check_switch,
    "part": optional(check_part),
    "picture": optional(partial(check_path, example="map.png")),
    "progress": optional(check_switch),
    "restart": check_switch,
    "seed": partial(check_whole, least=0, most=MOST_SEED),
    "threads": optional(partial(check_whole, least=1, most=MOST_THREADS)),
    "to": optional(check_output),
    "trust_code": check_switch,
    "verify": optional(check_verify),
}


def check_options(call: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options of a call that decide how it runs, after their checks; all problems are raised together."""
    problems, checked = Problems(), {}
    for name, check in ((name, CHECKS[name]) for name in call if name in CHECKS):
        checked[name] = problems.attempt(check, (name,), call[name])
    problems.stop()
    return checked


def checked_call(call: Mapping[str, Any], request_of: Callable[[Any], Any]) -> tuple[dict[str, Any], Any]:
    """Return the checked options of a call, and its request; all problems are raised together."""
    problems = Problems()
    checked = problems.attempt(check_options, call) or {}
    request = problems.attempt(request_of, {**call, "allow_invalid": checked.get("allow_invalid", False)})
    if request is not None and checked.get("part") is not None:
        problems.attempt(check_size, ("part",), checked["part"], request.size)
    if call.get("client") is not None and call.get("threads") is not None:
        remedy = "leave it out: workers have their own number of threads"
        problems.add("is given with client", ("threads",), remedy)
    problems.stop()
    return checked, request

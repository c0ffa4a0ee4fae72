"""The attributes of a joined map, from those of its parts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["CORE_TIME", "JOINED", "is_measured", "merged", "merged_errors"]

#: The number of parts that a map was joined from, and the seconds of all their threads.
JOINED, CORE_TIME = "joined_parts", "core_time_s"
#: How the attributes of a variable begin that verification adds: counts, and errors.
COUNTS, ERRORS = ("verified_values", "verify_mismatches", "independent_values"), ("error_", "independent_")
#: Global attributes that are sums over the parts, besides the numbers of designs.
SUMS = (
    *("configurations", "set_up_time_s", "run_time_s"),
    *("verified_designs", "verify_time_s", "verify_mismatches"),
)
#: What differs from part to part besides sums, and what parts may lack.
OF_VERIFICATION = ("verify_seed", "verify_left_out")
RATES = ("designs_per_second", "configurations_per_second")
EARLIER = "designs_of_earlier_runs"


def is_measured(name: str) -> bool:
    """Tell whether an attribute of a variable comes from verification."""
    return name in COUNTS or name.startswith(ERRORS)


def merged(parts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the global attributes that a map has at its end, from those of its parts.

    Numbers of designs and configurations, and times, are sums: ``run_time_s`` is that of the parts one after the other,
    ``core_time_s`` that times their threads. Rates are those of a part, on the average.
    """
    counts = {name for attrs in parts for name in attrs if name.startswith("designs_") and name != RATES[0]}
    sums = ["designs", *sorted(counts), *SUMS]
    result = {
        name: sum(attrs.get(name, 0) for attrs in parts) for name in sums if any(name in a for a in parts)
    }
    seconds = result.get("run_time_s", 0.0)
    result[CORE_TIME] = sum(attrs["run_time_s"] * attrs["threads"] for attrs in parts)
    result |= {"threads": max(attrs["threads"] for attrs in parts), JOINED: len(parts)}
    evaluated = result["designs"] - result.get(EARLIER, 0)
    for name, total in zip(RATES, ("designs", "configurations"), strict=True):
        if total in result and seconds > 0.0:
            result[name] = result[total] / result["designs"] * evaluated / seconds
    for attrs in parts:
        result |= {name: attrs[name] for name in OF_VERIFICATION if name in attrs}
    failed = dict.fromkeys(str(attrs["verify_failed"]) for attrs in parts if "verify_failed" in attrs)
    return result | ({"verify_failed": "; ".join(failed)} if failed else {})


def merged_errors(parts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return what verification says of a variable, from what it says of it in each part.

    Counts are sums, errors the greatest of all parts; of their medians too, which the median of all does not exceed.
    """
    result: dict[str, Any] = {}
    for name in dict.fromkeys(name for attrs in parts for name in attrs if is_measured(name)):
        found = [attrs[name] for attrs in parts if name in attrs]
        result[name] = sum(found) if name in COUNTS else found[0] if isinstance(found[0], str) else max(found)
    return result

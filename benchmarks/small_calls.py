"""What a small call costs, part by part: `python -m benchmarks.small_calls` prints the profile of docs/performance.md.

Times are the shortest of many calls, in microseconds of one thread.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fastlink as fl
from fastlink.engine import labels
from fastlink.engine.resolve import resolve
from fastlink.engine.run import run
from fastlink.engine.sweep import Evaluation

FIXED = {"a1": 0.4, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
NAMES = ["omega4_max", "transmission_angle_min", "shaking_force_max"]
BAR = fl.round_bar(density=7750.0, radius=0.01)


def shortest(call: Callable[[int], Any], times: int = 400) -> float:
    """Return the shortest time of a call with 0, 1, ..., in microseconds."""
    found = []
    for k in range(times):
        start = time.perf_counter()
        call(k)
        found.append(time.perf_counter() - start)
    return 1e6 * min(found)


def space(k: int) -> fl.DesignSpace:
    """Return one design, another one for each number."""
    return fl.grid(a2=1.2 + 1e-4 * k, **FIXED)


def sweep_in_parts() -> dict[str, float]:
    """Return what the parts of a sweep of one design take."""
    one = space(0)
    resolved = resolve("planar_4r", one, NAMES, links=BAR)
    evaluation = Evaluation(resolved, 1, None, verify=0, in_memory=True)
    evaluation.load(time.perf_counter())
    maps, job = evaluation.in_memory(lambda *_: None, {}), evaluation.job
    targets = [
        maps[v.name].values.reshape(1, *shape)
        for v, (shape, _) in zip(evaluation.variables, job.shapes, strict=True)
    ]
    function = fl.function(
        "planar_4r", ["a2"], [*NAMES, "status"], links=BAR, branch=(1, 2), **{k: v for k, v in FIXED.items()}
    )
    function([1.2])
    kernels = function._of_thread.kernels
    about = labels.global_attrs(resolved, 1)
    return {
        "the design: `fl.grid`": shortest(space),
        "checks, and the plan that is kept": shortest(lambda k: resolve("planar_4r", one, NAMES, links=BAR)),
        "labels of the results": shortest(lambda k: Evaluation(resolved, 1, None, verify=0, in_memory=True)),
        "buffers, and the kernels in them": shortest(lambda k: run(job, targets=targets)),
        "of these, the kernels themselves": shortest(lambda k: [kernel.run(1) for kernel in kernels]),
        "the Dataset": shortest(lambda k: labels.labelled(resolved, evaluation.variables, targets, about)),
        "all of `fl.sweep`, with its design": shortest(
            lambda k: fl.sweep("planar_4r", space(k), NAMES, links=BAR)
        ),
    }


def other_calls() -> dict[str, float]:
    """Return what other small calls take."""
    function = fl.function("planar_4r", ["a2"], NAMES, links=BAR, **FIXED)
    function([1.2])
    kernels = function._of_thread.kernels
    given = {"a2": 1.2, **FIXED}
    with tempfile.TemporaryDirectory() as folder:

        def to_file(k: int) -> None:
            options = {"links": BAR, "to": Path(folder, "maps.h5"), "overwrite": True}
            fl.sweep("planar_4r", space(k), NAMES, **options).close()

        to_files = shortest(to_file, 20)
    return {
        "`fl.function` of one design": shortest(lambda k: function([1.2 + 1e-4 * k])),
        "of this, the kernels": shortest(lambda k: [kernel.run(1) for kernel in kernels]),
        "`fl.evaluate` of omega4, at the same angle": shortest(
            lambda k: fl.evaluate("planar_4r", ["omega4"], theta1=0.3, **given)
        ),
        "`fl.evaluate` of omega4, at a new angle": shortest(
            lambda k: fl.evaluate("planar_4r", ["omega4"], theta1=0.3 + 1e-3 * k, **given)
        ),
        "`fl.sweep` of one design to a file": to_files,
    }


def main() -> None:
    """Print both tables."""
    for table in (sweep_in_parts(), other_calls()):
        for name, value in table.items():
            print(f"| {name} | {value:,.0f} |")
        print()


if __name__ == "__main__":
    main()

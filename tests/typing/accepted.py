"""Calls that type checkers accept: `mypy` reads this file as it reads the sources."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

import fastlink as fl
from fastlink.typing import MechanismName, Planar4rResult

SPACE = fl.grid(a1=0.4, a2=np.linspace(1.0, 1.4, 5), a3=0.8, a4=1.0, omega1=25.0)


def names_that_are_spelt() -> None:
    """Names of quantities, their reductions, derivatives, and those that no type lists."""
    fl.sweep(
        "planar_4r",
        SPACE,
        ["omega4_max", "theta1_at_omega4_max", "transmission_angle_min"],
        theta1=72,
        branch=(1, 2),
    )
    fl.sweep(
        "planar_4r", SPACE, ("T41_rms",), links=fl.round_bar(7750.0, 0.01), solver="dense", branch=(1, 2)
    )
    fl.sweep(
        "planar_4r",
        SPACE,
        ["d_omega4_d_a2", "omega4_error"],
        input="joint_angle_2",
        joint_angle_2=36,
        branch=(1, 2),
    )
    fl.evaluate("hart", ["F_y"], m=1.0, n=0.8, d=1.2, kappa=0.5, phi=np.linspace(0.0, 1.0, 5))
    fl.function("planar_4r", ["a2", "a3"], ["omega4_max"], a1=0.4, a4=1.0, omega1=25.0, theta1=24)
    fl.sweep("planar_4r", SPACE, ["omega4"], theta1_deg=[0.0, 90.0], branch=(1, 2))
    fl.grid(a1_mm=400, a2_mm=[1100, 1200], a3=0.8, a4=1.0, omega1_rpm=60)
    fl.evaluate("planar_4r", ["omega4"], a1_mm=400, a2=1.1, a3=0.8, a4=1.0, omega1_rpm=60, theta1_deg=40)
    fl.quantities("focal")
    fl.quantities(find="torque")


def names_that_are_computed(mechanism: MechanismName, names: list[str], few: Sequence[str]) -> None:
    """Lists of any texts, and mechanisms in a loop."""
    fl.sweep("planar_4r", SPACE, names, branch=(1, 2))
    fl.sweep("planar_4r", SPACE, [f"d_{name}_d_a1" for name in few], branch=(1, 2))
    fl.function("planar_4r", names, few)
    fl.sweep(mechanism, SPACE, names, branch=(1, 2))
    for one in fl.mechanisms():
        fl.sweep(one.name, SPACE, ["status"], branch=(1, 2))
    wanted: list[Planar4rResult] = ["omega4_max", "T41"]
    fl.sweep("planar_4r", SPACE, wanted, branch=(1, 2))
    design = {"a1": 0.4, "a2": 1.1}
    fl.grid(**design)
    row = fl.quantities(names[0])["T41"]
    print(row.units, row.needs)

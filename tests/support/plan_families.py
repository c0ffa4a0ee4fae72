"""Every kind of kernel there is, on a few designs: what the compilers are compared on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import fastlink as fl
from fastlink.codegen.kernel import MachineCode, load_kernel
from fastlink.codegen.runtime.cells import LANES
from fastlink.engine.resolve import resolve
from fastlink.space.design_space import EXTREMUM
from tests.mechanisms.linkages.declared import SIX_BAR
from tests.support.configurations import draw


@dataclass(frozen=True)
class Family:
    """A request that has kernels of one kind.

    Designs are random, of all classes: some assemble nowhere. There are more of them than the lanes of a vector, and no
    whole number of vectors.
    """

    mechanism: Any
    names: Sequence[str]
    angles: int = 9
    options: Mapping[str, Any] = field(default_factory=dict)
    designs: int = 11
    more: Mapping[str, float] = field(default_factory=dict)

    def request(self) -> Any:
        """Return the request, resolved."""
        from fastlink.mechanisms import catalogue

        found = catalogue(self.mechanism, self.options.get("input"))
        rng = np.random.default_rng(len(self.names) + self.designs)
        columns = draw(found.inputs, rng, self.designs)
        # Twice in three a crank that is short enough to turn.
        first = next(iter(found.inputs))
        columns[first] = np.where(np.arange(self.designs) % 3, 0.3, 1.0) * columns[first]
        if "completion" in columns:
            columns["completion"] = 1.0 + np.arange(self.designs) % 2
        columns |= {name: np.full(self.designs, value) for name, value in self.more.items()}
        # Only angles have a turn that a number of them can share.
        angles = self.angles if found.position.units == "rad" else np.linspace(-2.0, 2.0, self.angles)
        return resolve(
            self.mechanism, fl.table(columns), self.names, angles=angles, **{"branch": (1, 2)} | self.options
        )


OWN = fl.extend("planar_4r")


@OWN.quantity(units="N")
def load(F21, F41):
    """Greater force on the bearings of the crank."""
    return max(F21, F41)


@OWN.quantity(units="rad s-1")
def lower(omega2, omega4):
    """Rate of the coupler, or a thousand times the size of the output link's, which is less."""
    return min(omega2, 1e3 * abs(omega4))


@OWN.quantity(units="rad")
def between(theta4, theta2):
    """Angle between the coupler and the output link as the difference of two, which jump."""
    return theta4 - theta2


SAMPLED = {"extrema": "sampled"}
MOTION = ["A_x", "theta4", "omega4", "alpha2"]
REDUCED = ["omega4_max", "omega4_min", "theta1_at_omega4_max", "T41_mean", "alpha4_rms", "T41_fluctuation"]
FORCES = ["F32_x", "T41", "shaking_moment"]
GRADIENTS = ["d_omega4_max_d_a2", "d_theta4_min_d_a1", "d_theta1_at_omega4_max_d_a3"]
DRIVEN = {"input": "joint_angle_2"}
TOLERANCES = {"a1_tolerance": 1e-3, "a3_relative_tolerance": 1e-2, "m2_tolerance": 1e-2}
FAMILIES: dict[str, Family] = {
    # Lanes are angles: the last vector of angles overlaps the one before.
    "curves": Family("planar_4r", MOTION, 37),
    "curves of forces": Family("planar_4r", FORCES, 41),
    "curves of one branch": Family("planar_4r", MOTION, 37, {"branch": 2}),
    "curves by another joint": Family("planar_4r", ["joint_angle_1", "joint_omega_4"], 37, DRIVEN),
    "curves of rapidity": Family("minkowski_4r", ["psi"], 37),
    "curves in pieces": Family("minkowski_4r", ["psi", "A_x"], 517, designs=2),
    "curves of the focal mechanism": Family("focal", ["T_x", "S_x", "psi_rate"], 37, {"input": "sigma"}),
    "curves by the rocker": Family("focal", ["T_x", "T_y"], 37),
    "curves of Hart's linkage": Family("hart", ["F_x", "F_y", "P_x"], 37),
    "curves by the line": Family("hart", ["phi", "P_x"], 37, {"input": "F_y"}),
    # Lanes are designs.
    "few angles": Family("planar_4r", MOTION, 5),
    "reductions": Family("planar_4r", REDUCED, 9, SAMPLED),
    "fluctuation over two angles": Family("planar_4r", ["T41_fluctuation", "omega4_rms"], 2, SAMPLED),
    "paths of points": Family("planar_4r", ["P_straightness", "A_roundness"], 7),
    "curves and reductions": Family("planar_4r", ["omega4", "omega4_max"], 37, SAMPLED),
    "systems": Family("planar_4r", ["F32_x", "T41", "T41_max"], 5, {"solver": "dense"} | SAMPLED),
    "designs": Family("planar_4r", ["swing", "grashof_class", "time_ratio", "status"], 4),
    "flags": Family("minkowski_4r", ["linkage_type", "configuration_status", "status"], 37),
    "designs of the focal mechanism": Family("focal", ["status"], 4),
    "designs of Hart's linkage": Family("hart", ["stroke", "status"], 4),
    "derivatives": Family("planar_4r", ["d_omega4_d_a1", "d_T41_d_m2", "d_omega4_d_theta1"], 37),
    "error bounds of extremes": Family(
        "planar_4r", ["omega4_max_error", "theta4_min_error", "F41_min_error", "omega4_extrema_error"], 5
    ),
    "derivatives of extremes": Family("planar_4r", [*GRADIENTS, "omega4_min_gradient_status"]),
    "changes by tolerances": Family(
        "planar_4r",
        ["omega4_worst_change", "theta4_min_worst_change", "transmission_angle_min_worst_change"],
        9,
        more=TOLERANCES,
    ),
    "derivatives of extremes by another joint": Family(
        "planar_4r", ["d_joint_angle_4_max_d_a1", "joint_angle_4_min_gradient_status"], options=DRIVEN
    ),
    "derivatives of extremes with kinks": Family(OWN, ["d_load_min_d_a2", "load_min_gradient_status"]),
    "derivatives of reductions": Family(
        "planar_4r", ["d_omega4_rms_d_a2", GRADIENTS[0], "omega4_mean_gradient_status"], 9, SAMPLED
    ),
    "error bounds": Family("planar_4r", ["omega4_error", "omega4_trust", "T41_error"], 5),
    "reduced rapidity": Family("minkowski_4r", ["psi_max", "psi_rms"], 9, SAMPLED),
    # Every extreme: a search by samples, and roots.
    "extremes": Family("planar_4r", ["omega4_max", "theta1_at_omega4_max", "transmission_angle_min"]),
    "extremes of forces": Family("planar_4r", ["T41_max", "F32_max"]),
    "extremes of one branch": Family("planar_4r", ["omega4_min"], 9, {"branch": 1}),
    "lists of extremes": Family("planar_4r", ["alpha4_extrema", "T41_extrema"]),
    # A list, and in its kernel a quantity with more extremes than that has room for.
    "a list beside other extremes": Family("planar_4r", ["alpha4_extrema", "joint_omega_2_max"]),
    "lists of extremes with toggles": Family("planar_4r", ["curvature_extrema_error", "P_x_max_error"]),
    "lists of extremes with folds": Family(
        "planar_4r", ["F41_extrema_error"], more={"a1": 1.0, "a2": 2.0, "a3": 3.0, "a4": 2.0}
    ),
    "lists of extremes with kinks": Family(
        OWN, ["lower_extrema", "T41_extrema"], more={"T_load_quadratic": 1e6}
    ),
    "angles that jump": Family("planar_4r", ["theta4_max", "theta4_min", "theta2_extrema"]),
    "what is made of angles that jump": Family(
        OWN, ["between_max_error", "between_extrema"], more={"a1": 2.0, "a2": 2.5, "a3": 2.2, "a4": 0.8}
    ),
    "extremes over an arc": Family(
        "planar_4r", ["omega4_max", "theta4_min"], 9, more={"arc_start": 0.5, "arc_end": 2.0}
    ),
    "extremes in pieces": Family(
        SIX_BAR,
        ["F_x_max", "F_x_max_error", "d_F_x_max_d_a1", "F_x_extrema", "theta_low", "theta_low_by", "status"],
        options={"branch": (1, 2, 3, 4)},
    ),
    "extremes with poles": Family("planar_4r", ["mechanical_advantage_max", "mechanical_advantage_extrema"]),
    "extremes by another joint": Family("planar_4r", ["joint_omega_4_max"], 9, DRIVEN),
    "extremes of the focal mechanism": Family("focal", ["psi_rate_max"], 9, {"input": "sigma"}),
}


def few(*names):
    """Parameters of a test: these families, all others in the long tests."""
    assert set(names) <= set(FAMILIES)
    return [name if name in names else pytest.param(name, marks=pytest.mark.stress) for name in FAMILIES]


def kernels(request: Any) -> list[tuple[Any, list[Any]]]:
    """Return the kernels of a request, each with its arguments: designs, angles, their numbers, fresh arrays."""
    found = []
    space = request.evaluated
    size = space.size
    for kernel in request.kernels:
        program = kernel.program
        designs = np.empty((len(program.inputs), -(-size // LANES) * LANES))
        space.fill(program.inputs, 0, size, designs)
        designs[:, size:] = designs[:, size - 1 : size]
        angles = program.angle_tables(request.positions)
        n_angles = angles.shape[1]
        lengths = {
            "branch": len(program.branches),
            request.catalogue.position.name: n_angles,
            EXTREMUM: request.plan.extrema_kept,
        }
        # What scratch holds from before, and what results hold, is nothing that a kernel may read.
        scratch = [np.full(a.lengths(n_angles), 77, a.dtype) for a in kernel.source.scratch]
        results = [np.full((size, *(lengths[axis] for axis in o.axes)), 55, o.dtype) for o in program.outputs]
        found.append((kernel, [designs, np.ascontiguousarray(angles), size, n_angles, *scratch, *results]))
    return found


def run_as_python(kernel: Any, arguments: Sequence[Any]) -> list[np.ndarray]:
    """Return the results of the text as it is."""
    namespace: dict[str, Any] = {}
    exec(compile(kernel.text, "<kernel>", "exec"), namespace)
    with np.errstate(all="ignore"):
        return _run(namespace["kernel"], kernel, arguments)


def run_compiled(kernel: Any, arguments: Sequence[Any], backend: str = "llvm") -> list[np.ndarray]:
    """Return the results of machine code."""
    return _run(load_kernel(kernel.source, backend), kernel, arguments)


def run_code(kernel: Any, arguments: Sequence[Any], code: bytes) -> list[np.ndarray]:
    """Return the results of object code."""
    return _run(MachineCode(kernel.source, code), kernel, arguments)


def _run(function: Any, kernel: Any, arguments: Sequence[Any]) -> list[np.ndarray]:
    own = [a.copy() if isinstance(a, np.ndarray) else a for a in arguments]
    function(*own)
    return own[len(own) - len(kernel.program.outputs) :]

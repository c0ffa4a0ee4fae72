"""The text of kernels: what is computed, what it is called, that it can be read."""

import ast
import importlib
import pkgutil
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import llvmlite.binding as llvm
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from tests.mechanisms.linkages.declared import SIX_BAR
from tests.support.compiled import assert_same_bits
from tests.support.configurations import PLANAR, draw
from tests.support.sweeps import sweep_4r, sweep_both
from tests.support.toys import declare_all, toy

import fastlink as fl
import fastlink.codegen.runtime
from fastlink.codegen import kernel as loader
from fastlink.codegen.kernel import (
    BACKENDS,
    FEW,
    SEARCHED,
    SOON,
    MachineCode,
    kernel_of,
    llvm_text,
    load_kernel,
)
from fastlink.codegen.machine import assembly, compile_object, host, lanes_of_host
from fastlink.codegen.runtime.cells import LANES
from fastlink.codegen.source import Array, Source
from fastlink.codegen.translate import Refused, translate
from fastlink.engine.evaluate import evaluate
from fastlink.engine.resolve import resolve
from fastlink.mechanisms import NAMES, catalogue
from fastlink.numerics.compiler import OUTLINED
from fastlink.plan.programs import make_plan, make_program
from fastlink.space.design_space import EXTREMUM

# == Every kind of kernel there is, on a few designs: what the compilers are compared on =====================


@dataclass(frozen=True)
class Family:
    """A request that has kernels of one kind."""

    mechanism: Any
    names: Sequence[str]
    angles: int = 9
    options: Mapping[str, Any] = field(default_factory=dict)
    designs: int = 11
    more: Mapping[str, float] = field(default_factory=dict)

    def request(self):
        """Return the request, resolved."""
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
declare_all(
    OWN,
    {
        "load(F21, F41)": ("N", "max(F21, F41)"),
        # the rate of the coupler, or a thousand times the size of the output link's, which is less
        "lower(omega2, omega4)": ("rad s-1", "min(omega2, 1e3 * abs(omega4))"),
        # of two angles, which jump
        "between(theta4, theta2)": ("rad", "theta4 - theta2"),
    },
)
SAMPLED = {"extrema": "sampled"}
MOTION = ["A_x", "theta4", "omega4", "alpha2"]
REDUCED = ["omega4_max", "omega4_min", "theta1_at_omega4_max", "T41_mean", "alpha4_rms", "T41_fluctuation"]
FORCES = ["F32_x", "T41", "shaking_moment"]
GRADIENTS = ["d_omega4_max_d_a2", "d_theta4_min_d_a1", "d_theta1_at_omega4_max_d_a3"]
DRIVEN = {"input": "joint_angle_2"}
TOLERANCES = {"a1_tolerance": 1e-3, "a3_relative_tolerance": 1e-2, "m2_tolerance": 1e-2}
planar = partial(Family, "planar_4r")
FAMILIES = {
    # Lanes are angles: the last vector of angles overlaps the one before.
    "curves": planar(MOTION, 37),
    "curves of forces": planar(FORCES, 41),
    "curves of one branch": planar(MOTION, 37, {"branch": 2}),
    "curves by another joint": planar(["joint_angle_1", "joint_omega_4"], 37, DRIVEN),
    "curves of rapidity": Family("minkowski_4r", ["psi"], 37),
    "curves in pieces": Family("minkowski_4r", ["psi", "A_x"], 517, designs=2),
    "curves of the focal mechanism": Family("focal", ["T_x", "S_x", "psi_rate"], 37, {"input": "sigma"}),
    "curves by the rocker": Family("focal", ["T_x", "T_y"], 37),
    "curves of Hart's linkage": Family("hart", ["F_x", "F_y", "P_x"], 37),
    "curves by the line": Family("hart", ["phi", "P_x"], 37, {"input": "F_y"}),
    # Lanes are designs.
    "few angles": planar(MOTION, 5),
    "reductions": planar(REDUCED, 9, SAMPLED),
    "fluctuation over two angles": planar(["T41_fluctuation", "omega4_rms"], 2, SAMPLED),
    "paths of points": planar(["P_straightness", "A_roundness"], 7),
    "curves and reductions": planar(["omega4", "omega4_max"], 37, SAMPLED),
    "systems": planar(["F32_x", "T41", "T41_max"], 5, {"solver": "dense"} | SAMPLED),
    "designs": planar(["swing", "grashof_class", "time_ratio", "status"], 4),
    "flags": Family("minkowski_4r", ["linkage_type", "configuration_status", "status"], 37),
    "designs of the focal mechanism": Family("focal", ["status"], 4),
    "designs of Hart's linkage": Family("hart", ["stroke", "status"], 4),
    "derivatives": planar(["d_omega4_d_a1", "d_T41_d_m2", "d_omega4_d_theta1"], 37),
    "error bounds of extremes": planar(
        ["omega4_max_error", "theta4_min_error", "F41_min_error", "omega4_extrema_error"], 5
    ),
    "derivatives of extremes": planar([*GRADIENTS, "omega4_min_gradient_status"]),
    "changes by tolerances": planar(
        ["omega4_worst_change", "theta4_min_worst_change", "transmission_angle_min_worst_change"],
        9,
        more=TOLERANCES,
    ),
    "derivatives of extremes by another joint": planar(
        ["d_joint_angle_4_max_d_a1", "joint_angle_4_min_gradient_status"], options=DRIVEN
    ),
    "derivatives of extremes with kinks": Family(OWN, ["d_load_min_d_a2", "load_min_gradient_status"]),
    "derivatives of reductions": planar(
        ["d_omega4_rms_d_a2", GRADIENTS[0], "omega4_mean_gradient_status"], 9, SAMPLED
    ),
    "error bounds": planar(["omega4_error", "omega4_trust", "T41_error"], 5),
    "reduced rapidity": Family("minkowski_4r", ["psi_max", "psi_rms"], 9, SAMPLED),
    # Every extreme: a search by samples, and roots.
    "extremes": planar(["omega4_max", "theta1_at_omega4_max", "transmission_angle_min"]),
    "extremes of forces": planar(["T41_max", "F32_max"]),
    "extremes of one branch": planar(["omega4_min"], 9, {"branch": 1}),
    "lists of extremes": planar(["alpha4_extrema", "T41_extrema"]),
    # A list, and in its kernel a quantity with more extremes than that has room for.
    "a list beside other extremes": planar(["alpha4_extrema", "joint_omega_2_max"]),
    "lists of extremes with toggles": planar(["curvature_extrema_error", "P_x_max_error"]),
    "lists of extremes with folds": planar(
        ["F41_extrema_error"], more={"a1": 1.0, "a2": 2.0, "a3": 3.0, "a4": 2.0}
    ),
    "lists of extremes with kinks": Family(
        OWN, ["lower_extrema", "T41_extrema"], more={"T_load_quadratic": 1e6}
    ),
    "angles that jump": planar(["theta4_max", "theta4_min", "theta2_extrema"]),
    "what is made of angles that jump": Family(
        OWN, ["between_max_error", "between_extrema"], more={"a1": 2.0, "a2": 2.5, "a3": 2.2, "a4": 0.8}
    ),
    "extremes over an arc": planar(["omega4_max", "theta4_min"], 9, more={"arc_start": 0.5, "arc_end": 2.0}),
    "extremes in pieces": Family(
        SIX_BAR,
        ["F_x_max", "F_x_max_error", "d_F_x_max_d_a1", "F_x_extrema", "theta_low", "theta_low_by", "status"],
        options={"branch": (1, 2, 3, 4)},
    ),
    # of which an earlier search once left bits to the next one
    "extremes of one six-bar": Family(
        SIX_BAR,
        ["F_x_max"],
        options={"branch": 4},
        more={"a1": 0.25, "a2": 0.3, "a3": 0.35, "a4": 0.4, "a5": 0.2, "a6": 0.25, "omega": 10.0}
        | {"P_u": 0.15, "P_v": 0.1, "G_x": 0.45, "G_y": 0.3},
    ),
    "extremes with poles": planar(["mechanical_advantage_max", "mechanical_advantage_extrema"]),
    "extremes by another joint": planar(["joint_omega_4_max"], 9, DRIVEN),
    "extremes of the focal mechanism": Family("focal", ["psi_rate_max"], 9, {"input": "sigma"}),
}


def few(*names):
    """Parameters of a test: these families, all others in the long tests."""
    assert set(names) <= set(FAMILIES)
    return [name if name in names else pytest.param(name, marks=pytest.mark.stress) for name in FAMILIES]


def kernels(request):
    """Return the kernels of a request, each with its arguments: designs, angles, their numbers, fresh arrays."""
    found, space = [], request.evaluated
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


def run_as_python(kernel, arguments):
    """Return the results of the text as it is."""
    namespace = {}
    exec(compile(kernel.text, "<kernel>", "exec"), namespace)
    with np.errstate(all="ignore"):
        return _run(namespace["kernel"], kernel, arguments)


def run_compiled(kernel, arguments, backend="llvm"):
    """Return the results of machine code."""
    return _run(load_kernel(kernel.source, backend), kernel, arguments)


def run_code(kernel, arguments, code):
    """Return the results of object code."""
    return _run(MachineCode(kernel.source, code), kernel, arguments)


def _run(function, kernel, arguments):
    own = [a.copy() if isinstance(a, np.ndarray) else a for a in arguments]
    function(*own)
    return own[len(own) - len(kernel.program.outputs) :]


# == Assembly language of x86-64 (AT&T) and aarch64, read: loops, and which arithmetic is in them ============

LABEL = re.compile(r"^([\w.$]+):")
JUMP = re.compile(r"^\s+(?:j\w+|b|b\.\w+|cbn?z\s+\w+,|tbn?z\s+\w+,\s*#\w+,)\s+(\.?L\w+)\b")
CALL = re.compile(r"^\s+(?:callq?|bl|jmpq?|b)\s+(?!\.?L)(\*?[A-Za-z_][\w.$]*)")
#: Arithmetic of doubles; on x86 a plain .2d is an xmm register.
PACKED = re.compile(r"^\s+(?:v?(?:add|sub|mul|div|sqrt)pd\b|f(?:add|sub|mul|div|sqrt)\s+v\d+\.2d)")
SINGLE = re.compile(r"^\s+(?:v?(?:add|sub|mul|div|sqrt)sd\b|f(?:add|sub|mul|div|sqrt)\s+d\d+)")
#: A number is copied to all lanes.
SPREAD = re.compile(r"^\s+(?:v?(?:broadcastsd|movddup|unpcklpd|movlhps)\b|dup\s|.*\.d\[0\])")
REGISTER = re.compile(r"%[xyz]mm(\d+)|\b[dvq](\d+)\b")
#: Products fused with sums, which round once.
FUSED = re.compile(r"^\s+(?:vfn?m(?:add|sub)\w*|fn?m(?:add|sub|la|ls))\b")


@dataclass
class Loop:
    """Lines from the label of a loop to the last jump back to it."""

    lines: list[str] = field(repr=False)

    @property
    def packed(self):
        return sum(bool(PACKED.match(line)) for line in self.lines)

    @property
    def single(self):
        """Operations of one lane, but for those of numbers from outside, whose result goes to all lanes at once.

        LLVM makes one such operation of a packed one between numbers that stand in all lanes.
        """
        spread = {}
        for k in reversed(range(len(self.lines))):
            if SINGLE.match(self.lines[k]):
                spread[k] = self._is_spread(k, spread)
        return sum(not done for done in spread.values())

    def _is_spread(self, k, spread):
        """Tell whether the next line that reads what line k makes copies it to all lanes, or is of that kind itself."""
        made = _registers(self.lines[k])
        made = made[0] if re.match(r"\s+f", self.lines[k]) else made[-1]
        for later in range(k + 1, len(self.lines)):
            if made in _registers(self.lines[later]):
                return spread.get(later, bool(SPREAD.match(self.lines[later])))
        return False


def _registers(line):
    return [x86 or arm for x86, arm in REGISTER.findall(line)]


def inner_loops(text):
    """Return the loops that hold no other one."""
    lines = text.splitlines()
    labels = {found[1]: k for k, line in enumerate(lines) if (found := LABEL.match(line))}
    ends = {}
    for k, line in enumerate(lines):
        if (found := JUMP.match(line)) and labels.get(found[1], k) < k:
            ends[labels[found[1]]] = k
    inner = [
        (a, b)
        for a, b in ends.items()
        if not any(a <= c and d <= b and (a, b) != (c, d) for c, d in ends.items())
    ]
    return [Loop(lines[a : b + 1]) for a, b in sorted(inner)]


def called(text):
    """Return the functions that are called, or gone on to, and are not part of the text."""
    lines = text.splitlines()
    own = {found[1] for line in lines if (found := LABEL.match(line))}
    return {found[1] for line in lines if (found := CALL.match(line))} - own


def fused(text):
    """Return the lines that fuse a product with a sum."""
    return [line for line in text.splitlines() if FUSED.match(line)]


# == Texts of kernels ==

GIVEN = tuple(PLANAR.inputs)
#: The plans of the benchmarks, and what the lanes are in each.
PLANS = {
    "positions": ("A_x A_y B_x B_y", "angles"),
    "rates": ("B_x B_y omega2 omega4 alpha2 alpha4", "angles"),
    "angles": ("theta2 theta4", "angles"),
    "reactions": ("F41_x F41_y F21_x F21_y F32_x F32_y F43_x F43_y T41", "angles"),
    "extremes": ("omega4_max omega4_min alpha4_max alpha4_min T41_max F32_x_max", "designs"),
    "map": (
        "transmission_angle_min shaking_force_max shaking_moment_max theta1_at_omega4_max",
        "designs",
    ),
    "rms": ("T41_rms status", "designs"),
    "dense": ("F32_x T41", "designs"),
}


def planned(name):
    """Return the program of a plan."""
    variants = ("dense",) if name == "dense" else ()
    return make_program(PLANAR, PLANS[name][0].split(), given=GIVEN, variants=variants)


@pytest.mark.parametrize("name", PLANS)
def test_only_what_was_asked_is_computed(name):
    plan = planned(name)
    assert plan.lanes == PLANS[name][1]
    needed = {output.request.quantity for output in plan.outputs}
    for step in reversed(plan.steps):
        made = set(getattr(step, "unknowns", (step.name,)))
        assert made & needed, f"{step.name} is computed for nothing"
        needed |= set(step.depends_on)
    assert set(plan.inputs) <= needed
    assert set(plan.tables) <= needed | {"theta1"}


def test_the_text_can_be_read():
    text = kernel_of(make_program(PLANAR, ["omega4_max"], given=GIVEN)).text
    assert "            for i in lanes(width):\n" in text
    assert "omega4__1 = mean_rate " in text
    assert "F32" not in text
    assert "alpha" not in text


@pytest.mark.parametrize("name", ["theta1_at_omega4_max", "omega4_extrema", "d_omega4_max_d_a2", ""])
def test_where_extremes_are_is_computed_where_it_is_asked_for(name):
    *_, program = make_plan(PLANAR, ["omega4_max", *filter(None, [name])], given=GIVEN).programs
    assert ("atan2(" in kernel_of(program).text) == bool(name)


def names_of_its_own(plan):
    """Return the names in a kernel that are no values of the mechanism."""
    tree = ast.parse(kernel_of(plan).text)
    stored = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    stored |= {argument.arg for argument in ast.walk(tree) if isinstance(argument, ast.arg)}
    stored |= {alias.name for alias in ast.walk(tree) if isinstance(alias, ast.alias)}
    known = known_names(PLANAR) | set(PLANAR.graded.coordinates)
    return {name for name in stored if name.split("__")[0] not in known and not name.startswith("out_")}


def known_names(mechanism):
    chosen = {name for facts in mechanism.variants.values() for name in facts}
    inputs = mechanism.known_inputs(tuple(mechanism.variants))
    tables = {mechanism.position.name, *mechanism.tables, *mechanism.table_low_parts}
    return {*mechanism.facts, *chosen, *inputs, *tables, "branch"}


@pytest.mark.sample(2)
@pytest.mark.parametrize("name", NAMES)
def test_no_value_of_a_mechanism_has_a_name_that_kernels_use(name):
    """Such a value would be taken for a count or an array: designs were left out in silence."""
    plans = [*map(planned, PLANS)]
    plans += make_plan(PLANAR, ["omega4_max", "T41_extrema"], given=GIVEN).programs
    own = set().union(*map(names_of_its_own, plans))
    assert {"designs", "n_designs", "lanes", "width", "state", "w", "w2"} <= own
    assert not own & known_names(catalogue(name))


def test_designs_beyond_the_first_lanes_are_computed_too():
    """Of lengths that are called m and n."""
    n, design = np.linspace(0.8, 1.2, 130), {"m": 1.0, "d": 1.2, "kappa": 0.5}
    found = sweep_both("hart", fl.grid(n=n, **design), ["stroke"])["stroke"]
    assert_array_equal(found, evaluate("hart", ["stroke"], n=n, phi=0.0, **design)["stroke"])


@pytest.mark.parametrize("lanes", ["designs", "angles"])
def test_a_fact_may_need_the_branch_itself(lanes):
    made = toy("""\
        [inputs]
        a [m] a: a length
        [facts]
        ## here
        x [m] x: A fact of all three
            = a * branch + theta
        """, {1: "one", 2: "other"})  # fmt: skip
    kernel = kernel_of(make_program(made, ["x"], given=["a"], angles=40, lanes=lanes))
    designs, angles = np.full((1, 64), 3.0), np.arange(40.0).reshape(1, 40)
    found = np.empty((2, 2, 40))
    scratch = (np.empty(array.lengths(40)) for array in kernel.source.scratch)
    kernel.compiled()(designs, angles, 2, 40, *scratch, found)
    assert_array_equal(found, [[3.0 + np.arange(40.0), 6.0 + np.arange(40.0)]] * 2)


@pytest.mark.parametrize(
    "names",
    [["theta4_extrema"], ["alpha4_extrema", "alpha4_extrema_error", "d_alpha4_max_d_a2"], ["theta4_max_error"]],
    ids=",".join,
)  # fmt: skip
def test_kernels_of_extremes_are_translated(names):
    """By our own translator: numba takes a minute for one, and makes it several times slower."""
    for program in make_plan(PLANAR, names, given=list(PLANAR.inputs)).programs:
        llvm_text(kernel_of(program).source)  # or `Refused`


# == Every kind of kernel: the text run as Python, our machine code and numba's give the same bits ===========


@pytest.mark.sample(4)
@pytest.mark.parametrize("name", FAMILIES)
def test_machine_code_has_the_bits_of_the_text(name):
    for kernel, arguments in kernels(FAMILIES[name].request()):
        text = llvm_text(kernel.source)
        llvm.parse_assembly(text).verify()
        expected = run_as_python(kernel, arguments)  # first: Python looks whether indices are within arrays
        found = run_compiled(kernel, arguments)
        assert_same_bits(found, expected)
        assert_same_bits(run_code(kernel, arguments, compile_object(text, soon=True)), found)
        assert_written(kernel, arguments, found)


@pytest.mark.parametrize(
    "name",
    few(
        "curves in pieces",
        "derivatives of extremes",
        "lists of extremes with kinks",
        "extremes of one six-bar",
    ),
)
def test_nothing_that_memory_held_before_is_read(name):
    """Else bits differ from run to run: those of six-bars did."""
    held = {"float64": [0.0, 1.0, -1.0, 1e-3, np.nan, np.inf], "int8": [0, 1], "int64": [0, 1, 2, 3]}
    for kernel, arguments in kernels(FAMILIES[name].request()):
        expected = run_compiled(kernel, arguments)
        n_scratch = len(kernel.source.scratch)
        for seed in range(5):
            rng = np.random.default_rng(seed)
            scratch = [
                rng.choice(held[a.dtype.name], a.shape).astype(a.dtype) for a in arguments[4 : 4 + n_scratch]
            ]
            other = [*arguments[:4], *scratch, *arguments[4 + n_scratch :]]
            assert_same_bits(run_compiled(kernel, other), expected)


@pytest.mark.parametrize("name", few("few angles"))
def test_both_compilers_give_the_same_bits(name):
    for kernel, arguments in kernels(FAMILIES[name].request()):
        first, *others = (run_compiled(kernel, arguments, backend) for backend in BACKENDS)
        for other in others:
            assert_same_bits(first, other)


LEVELS = {
    "x86-64-v2": {"sse4.2"},
    "x86-64-v3": {"avx2", "bmi2", "fma"},
    "x86-64-v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
}


def levels():
    """Return the instruction sets that this processor has, from the first on."""
    has = {feature[1:] for feature in host()[1].split(",") if feature.startswith("+")}
    return [level for level, needed in LEVELS.items() if needed <= has]


@pytest.mark.parametrize("name", few("systems", "extremes of one branch"))
def test_any_width_and_instruction_set_gives_the_same_bits(name):
    """Wider vectors than a register holds are several registers."""
    for kernel, arguments in kernels(FAMILIES[name].request()):
        expected = run_compiled(kernel, arguments)
        # Other widths by the processor's own instructions, and each by those that have registers of it.
        others = [(None, lanes) for lanes in (2, 4, 8) if lanes != lanes_of_host()]
        for cpu, lanes in [*others, *zip(levels(), (2, 4, 8), strict=False)]:
            code = compile_object(llvm_text(kernel.source, lanes=lanes), cpu=cpu, check=True)
            assert_same_bits(run_code(kernel, arguments, code), expected)


def assert_written(kernel, arguments, found):
    """Every result was stored, and there is more in it than what does not assemble."""
    for output, before, after in zip(kernel.program.outputs, arguments[-len(found) :], found, strict=True):
        assert not (after == before).any(), output.name
        assert np.isfinite(after).any() or kernel.program.catalogue.name == "focal", output.name


def test_the_families_call_every_function_that_kernels_call():
    modules = [
        importlib.import_module(f"fastlink.codegen.runtime.{module.name}")
        for module in pkgutil.iter_modules(fastlink.codegen.runtime.__path__)
    ]
    functions = {function for function in OUTLINED if function.__module__ in {m.__name__ for m in modules}}
    written = {function.__name__ for function in functions if not function.__name__.startswith("_")}
    texts = [kernel.text for family in FAMILIES.values() for kernel, _ in kernels(family.request())]
    imports = [line for text in texts for line in re.findall(r"^from fastlink.codegen.runtime.*", text, re.M)]
    called = {name for line in imports for name in re.findall(r"\w+", line.partition(" import ")[2])}
    # other functions call them
    helpers = {
        *("append_item", "append_of_lane", "is_unresolved", "next_split", "insert", "position_of"),
        *("every_vector", "first_of", "toggle_of", "evaluate_at", "evaluate_octave", "find_least"),
        *("column_of", "note_best", "mark_undecided"),
    }
    assert written - called <= helpers
    for word in ("entries(min(", "w2[", "turn in range(2)", "silenced(", "store_list("):
        assert any(word in text for text in texts), word


# == Kernels with little to do are compiled in less time; their bits are compared above ======================

LENGTHS = {"a1": 0.4, "a3": 0.8, "a4": 1.0}
NAMES_SOON = ("swing",), ("B_x",)


@pytest.fixture
def compiled(monkeypatch, tmp_path):
    """An empty cache, and a list of how each kernel was compiled: in the shortest time or not."""
    monkeypatch.setenv("FASTLINK_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(loader, "_loaded", {})
    kernel_of.cache_clear()
    compile, found = loader.compile_object, []
    monkeypatch.setattr(
        loader, "compile_object", lambda text, soon: found.append(soon) or compile(text, soon=soon)
    )
    yield found
    kernel_of.cache_clear()


def space(size):
    return fl.grid(a2=np.linspace(1.0, 1.2, size), **LENGTHS)


@pytest.mark.parametrize("names", NAMES_SOON)
def test_few_designs_come_soon_and_many_fast(compiled, names):
    most = FEW // (SEARCHED if names == ("swing",) else 36)
    assert most > 1000
    first = sweep_4r(space(9), names, angles=36)
    assert compiled == [True]
    kernel_of.cache_clear()  # as another process, which finds it in the cache
    loader._loaded.clear()
    second = sweep_4r(space(9), names, angles=36)
    sweep_4r(space(most - 9), names, angles=36)
    assert compiled == [True]
    third = sweep_4r(space(9), names, angles=36)  # too many, all told
    assert compiled == [True, False]
    sweep_4r(space(most + 1), names, angles=36)
    assert compiled == [True, False]
    for found in (second, third):
        assert_array_equal(found[names[0]], first[names[0]], strict=True)


def test_code_that_runs_fast_is_taken_wherever_it_is(compiled):
    sweep_4r(space(FEW), ["swing"])
    kernel_of.cache_clear()
    sweep_4r(space(9), ["swing"])
    loader._loaded.clear()
    kernel_of.cache_clear()
    sweep_4r(space(9), ["swing"])
    assert compiled == [False]


def test_what_is_called_again_and_again_is_compiled_well(compiled):
    fl.function("planar_4r", ["a2"], ["swing"], **LENGTHS)
    assert compiled == [False]


def test_a_forecast_tells_them_apart(compiled):
    small, large = (("planar_4r", space(size), ["swing"]) for size in (9, FEW))
    times = [fl.explain(*request).forecast.compile_time for request in (small, large)]
    assert 0.0 < times[0] < times[1]
    fl.sweep(*small, branch=(1, 2))
    assert [fl.explain(*request).forecast.compiled for request in (small, large)] == [1, 0]
    assert fl.explain(*large, measure=True).forecast.timing is not None  # of the code that will run
    assert compiled == [True, False]


def test_what_numba_compiles_is_compiled_once(compiled, monkeypatch):
    def refuse(*_):
        raise loader.Refused("no")

    monkeypatch.setattr(loader, "llvm_text", refuse)
    keys = []
    monkeypatch.setattr(
        "fastlink.codegen.numba_backend.compile_by_numba", lambda source, key: keys.append(key)
    )
    (of,) = resolve("planar_4r", space(9), ["swing"], branch=(1, 2)).kernels
    for compiler in (SOON, "llvm"):
        load_kernel(of.source, compiler)
    assert len(keys) == 2
    assert len(set(keys)) == 1


# == Machine code of every target: whole vectors in the loops over lanes, no call of a library, nothing fused

#: Processor, platform, and how many doubles a register holds.
TARGETS = {
    "v2": ("x86-64-v2", "x86_64-unknown-linux-gnu", 2),
    "v3": ("x86-64-v3", "x86_64-unknown-linux-gnu", 4),
    "v4": ("x86-64-v4", "x86_64-unknown-linux-gnu", 8),
    "aarch64": ("generic", "aarch64-unknown-linux-gnu", 2),
}
#: What LLVM makes of loops that copy; libc has them, and they know no arithmetic.
COPIES = {"memset", "memcpy", "memmove"}


@pytest.fixture(scope="module", autouse=True)
def all_targets():
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()


def assembly_for(kernel, target, **options):
    cpu, triple, lanes = TARGETS[target]
    text = llvm_text(kernel.source, **{"lanes": lanes} | options)
    return assembly(text, cpu=cpu, triple=triple)


def loops_over_lanes(kernel):
    """Return how many loops of the text over lanes have products in them."""
    loops = [node for node in ast.walk(ast.parse(kernel.text)) if isinstance(node, ast.For)]
    abreast = [loop for loop in loops if ast.unparse(loop.iter).startswith(("lanes(", "entries("))]
    return sum(any(isinstance(node, ast.Mult) for node in ast.walk(loop)) for loop in abreast)


@pytest.mark.sample(3)
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", few("curves of rapidity", "reductions", "systems", "extremes of forces"))
def test_lanes_are_whole_vectors_and_nothing_is_called_or_fused(name, target):
    for kernel, _ in kernels(FAMILIES[name].request()):
        text = assembly_for(kernel, target)
        loops = inner_loops(text)
        vector = [loop for loop in loops if loop.packed]
        assert len(vector) >= loops_over_lanes(kernel) > 0
        assert max(loop.packed for loop in vector) > 40
        assert [loop for loop in vector if loop.single] == []
        # Loops over cells, of bounds and ends, are of one lane: that of bounds of extremes has 16 operations.
        assert max((loop.single for loop in loops if not loop.packed), default=0) <= 16
        assert called(text) <= COPIES
        assert fused(text) == []
        assert "vmaskmov" not in text  # AVX2 stores lane by lane under a mask


#: The most instructions for each operation in the loop over angles.
@pytest.mark.parametrize(("name", "most"), [("curves", 2.2), ("curves of forces", 1.55)])
def test_with_16_registers_little_stands_in_memory(name, most):
    """Half as many instructions again for loads, stores and what registers cannot hold; addresses are known before."""
    kernel, _ = kernels(FAMILIES[name].request())[0]
    hot = [loop for loop in inner_loops(assembly_for(kernel, "v3")) if loop.packed > 40][-1]
    assert len(hot.lines) < most * hot.packed


@pytest.mark.parametrize("target", ["v3", "v4"])
def test_vectors_on_the_stack_lie_in_one_cache_line(target):
    *_, (kernel, _) = kernels(FAMILIES["extremes of forces"].request())
    long = [loop for loop in inner_loops(assembly_for(kernel, target)) if loop.packed > 40]
    stack = [line for loop in long for line in loop.lines if re.search(r"mm\d+, \d*\(%rsp\)", line)]
    assert stack
    assert [line for line in stack if "movup" in line] == []


def test_entries_for_lanes_are_loaded_without_vectors_of_addresses():
    """AVX2 has instructions for neither conversion, and LLVM takes the addresses apart again."""
    *_, (kernel, _) = kernels(FAMILIES["extremes"].request())
    assert "vpextrq" not in assembly_for(kernel, "v3")


@pytest.mark.parametrize("target", TARGETS)
def test_single_lanes_and_fused_products_would_be_noticed(target):
    kernel, _ = kernels(FAMILIES["curves of forces"].request())[0]
    loops = inner_loops(assembly_for(kernel, target, lanes=1))
    assert sum(loop.packed for loop in loops) == 0
    assert max(loop.single for loop in loops) > 40
    # The second level has no instructions that fuse.
    assert bool(fused(assembly_for(kernel, target, fast_math=("contract",)))) == (target != "v2")


@pytest.mark.parametrize("target", TARGETS)
def test_a_call_would_be_noticed(target):
    text = """
    declare double @llvm.sin.f64(double)
    define void @kernel(ptr %x) {
      %v = load double, ptr %x
      %y = call double @llvm.sin.f64(double %v)
      store double %y, ptr %x
      ret void
    }"""
    cpu, triple, _ = TARGETS[target]
    assert called(assembly(text, cpu=cpu, triple=triple)) == {"sin"}


# == The grammar of kernel text: what is outside is refused with its line, and what is inside means what Python means

HEAD = '''"""A kernel."""
import math
import numpy as np
from numpy import array
from fastlink.codegen.runtime.systems import solve_lanes
from fastlink.numerics.compiler import entries, lanes
from fastlink.numerics.elementary import atan2, select, sqrt

def kernel(a, b, n, m, out):
'''
#: Two arrays of two axes and two whole numbers, and an array of one.
ARGUMENTS = [("f", (2, None)), ("f", (0, 0)), ("i", ()), ("i", ()), ("f", (None,))]


def text_of(body):
    return HEAD + "".join(f"    {line}\n" for line in body.splitlines())


def in_lanes(*lines):
    return "\n".join(("for i in lanes(n):", *(f"    {line}" for line in lines)))


REFUSED = {
    # Arithmetic that means other things in machine code, or that nothing is made of.
    "k = n // 2": "n // 2: no such operation",
    "k = n % 2": "n % 2: no such operation",
    "k = n ** 2": "n ** 2: no such operation",
    "x = a[0, 0] ** 2": "a[0, 0] ** 2: no such operation",
    "k = ~n": "~n: numbers are negated by -, truths by not",
    "x = -(n > 0)": "numbers are negated by -, truths by not",
    "x = a[0, 0] & 1": "a[0, 0] & 1: no such operation",
    "x = a + 1.0": "a: a number is wanted",
    "k = 0 < n < 5": "0 < n < 5: no such expression",
    "k = n in (1, 2)": "n in (1, 2): no such expression",
    # Entries.
    "x = a[0, -1]": "a[0, -1]: indices count from the beginning",
    "out[-1] = 1.0": "out[-1]: indices count from the beginning",
    "x = a[0, 1:2]": "1:2: no such expression",
    "x = a[0, 0.5]": "a[0, 0.5]: indices are whole numbers",
    "x = a[0, 1, 2]": "a[0, 1, 2]: an array with as many axes is wanted",
    "x = n[0]": "n[0]: an array with as many axes is wanted",
    "a[0] = 1.0": "a[0]: one number goes to one entry",
    "out[0] = 1.0, 2.0": "out[0]: one number goes to one entry",
    "x = a.T": "a.T: arrays have shape, those of one axis size",
    "x = a.size": "a.size: arrays have shape, those of one axis size",
    "x = np.nothing": "np.nothing: arrays have shape, those of one axis size",
    # Expressions and statements of Python that kernels have none of.
    "x = 'text'": "'text': no such expression",
    "x = [1.0, 2.0]": "[1.0, 2.0]: no such expression",
    "x = (k := n)": "(k := n): no such expression",
    "x = k = 2.0": "x = k = 2.0: no such statement",
    "x: float = 1.0": "x: float = 1.0: no such statement",
    "x, k = 1.0": "(x, k): as many values as names are needed",
    "x, k = 1.0, 2.0, 3.0": "(x, k): as many values as names are needed",
    "a.flags = 1": "a.flags: no such target",
    "try:\n    pass\nfinally:\n    pass": "no such statement",
    "def f(): pass": "no such statement",
    "break": "break: no such statement",
    "continue": "continue: no such statement",
    # Names and their kinds.
    "x = unknown": "unknown: nothing has that name here",
    "k = 1\nk = k * 0.5": "k: its kind changes from i to f",
    "x = a[0, 0]\nx = n": "x: its kind changes from f to i",
    "x = a[0, 0] > 0.0\nx = 1\nx = n": "x: its kind changes from b to i",
    "c = a\nc = b": "c: a counter or an array keeps its name",
    "c = a\nif n > 0:\n    c = b\nout[0] = c[0, 0]": "c: a counter or an array keeps its name",
    "a = b": "a: a counter or an array keeps its name",
    "c = a\nc = 1.0": "c: a counter or an array keeps its name",
    "if n > 0:\n    c = a\nout[0] = c[0, 0]": "c: nothing has that name here",
    "x = a[0, 0] if n > 0 else n": "both values are of one kind",
    # Calls.
    "x = unknown(1.0)": "unknown(1.0): nothing has that name here",
    "x = math.sin(1.0)": "math.sin(1.0): it is none of the functions that kernels call",
    "x = np.zeros(3)": "np.zeros(3): it is none of the functions that kernels call",
    "x = len(a)": "len(a): nothing has that name here",
    "x = lanes(n)": "lanes(n): it is none of the functions that kernels call",
    "x = array(n)": "array(n): it is none of the functions that kernels call",
    "x = sqrt(x=1.0)": "sqrt(x=1.0): arguments stand in order",
    "x = max(1.0, 2.0, 3.0)": "max(1.0, 2.0, 3.0): it takes other arguments",
    "x = sqrt()": "sqrt(): it takes other arguments",
    "x = sqrt(a)": "sqrt(a): it takes other arguments",
    "x = atan2(1.0)": "atan2(1.0): it takes other arguments",
    "solve_lanes(a, 0)": "solve_lanes(a, 0): it takes other arguments",
    "x = a.sum()": "a.sum: arrays have shape, those of one axis size",
    # Loops over numbers.
    "for i in a:\n    pass": "a: loops run over range, lanes or entries",
    "for i in enumerate(a):\n    pass": "enumerate(a): loops run over range, lanes or entries",
    "for i, j in range(n):\n    pass": "no such statement",
    "for i in range(n):\n    pass\nelse:\n    pass": "no such statement",
    "while n > 0:\n    n -= 1\nelse:\n    pass": "no such statement",
    "for i in range(0, n, m):\n    pass": "range(0, n, m): the step is a number that is known",
    "for i in range(0, n, 0):\n    pass": "range(0, n, 0): the step is a number that is known",
    "for i in range(2.5):\n    pass": "range(2.5): counters run from one whole number to another",
    "for i in range():\n    pass": "range(): counters run from one whole number to another",
    "for i in lanes(n, 2):\n    out[i] = 1.0": "lanes(n, 2): counters run from one whole number to another",
    "for i in range(n):\n    i = 2": "i: a counter or an array keeps its name",
    "for n in range(3):\n    pass": "n: a counter has a name of its own",
    "for i in range(n):\n    for i in range(n):\n        pass": "i: a counter has a name of its own",
    "for i in range(n):\n    pass\nx = i": "i: nothing has that name here",
    # Lanes: each on its own, assignments alone, the counter last.
    in_lanes("out[i] = i"): "i: the counter of lanes stands as last index only",
    in_lanes("k = i"): "i: the counter of lanes stands as last index only",
    in_lanes("out[i + 1] = 1.0"): "i: the counter of lanes stands as last index only",
    in_lanes("out[i * 2] = 1.0"): "i: the counter of lanes stands as last index only",
    in_lanes("out[n - i] = 1.0"): "i: the counter of lanes stands as last index only",
    in_lanes("out[i] = a[i, 0]"): "i: the counter of lanes stands as last index only",
    in_lanes("a[i] = 1.0"): "a[i]: lanes stand along the last axis",
    in_lanes("out[0] = a[0, i]"): "out[0]: lanes go to entries side by side",
    in_lanes("out[int(a[0, i])] = 1.0"): "out[int(a[0, i])]: one number goes to one entry",
    in_lanes("out[i] = a[int(a[1, i]), i]"): "in lanes the last one only differs",
    in_lanes("break"): "break: lanes have assignments only",
    in_lanes("return"): "return: lanes have assignments only",
    in_lanes("sqrt(1.0)"): "sqrt(1.0): lanes have assignments only",
    in_lanes("x = solve_lanes(a, 0, 2, n)"): "lanes call no functions with loops",
    in_lanes("if a[0, i] > 0: out[i] = 1.0"): "lanes have assignments only",
    in_lanes("for j in lanes(8): out[j] = 1.0"): "lanes have assignments only",
    in_lanes("x = a[0, i] > 0.0 and n > 0"): "lanes have & and |",
    in_lanes("x = a[0, i] > 0.0 or n > 0"): "lanes have & and |",
    in_lanes("x = not a[0, i] > 0.0"): "numbers are negated by -, truths by not",
    in_lanes("x = a[0, i] // 2.0"): "a[0, i] // 2.0: no such operation",
    in_lanes("x = math.sin(a[0, i])"): "it is none of the functions that kernels call",
    in_lanes("i = 2"): "i: a counter or an array keeps its name",
    in_lanes("n = 2"): "n: what lanes assign is not known outside of them",
    in_lanes("x = a[0, i]") + "\nout[0] = x": "x: nothing has that name here",
}


@pytest.mark.parametrize("body", REFUSED)
def test_what_is_outside_is_refused_with_its_line_and_text(body):
    with pytest.raises(Refused) as told:
        translate(text_of(body), ARGUMENTS, 4)
    where, _, why = str(told.value).partition(": ")
    assert REFUSED[body] in why
    name, _, line = where.partition(", line ")
    assert name == "kernel"
    # What is refused begins on that line; a tuple of names is told with parentheses.
    culprit = why.split(": ")[0].splitlines()[0].replace("(x, k)", "x, k")
    assert culprit in text_of(body).splitlines()[int(line) - 1]


def test_a_function_that_is_called_is_refused_in_its_own_lines():
    text = "\n".join(["def f(x):", "    return x % 2.0", "", *text_of("out[0] = f(1.0)").splitlines()])
    with pytest.raises(Refused, match=r"f, line 2: x % 2.0: no such operation"):
        translate(text, ARGUMENTS, 4)


MEANT = {
    "arithmetic": "out[0] = n * 3 - m\nout[1] = n / m\nout[2] = -n\nout[3] = 1.0 / a[0, 0] - a[0, 1] * 2",
    "bits": "out[0] = (n << 3) >> 1\nout[1] = n & 6\nout[2] = n | 8\nout[3] = n ^ 3\nout[4] = -n >> 1",
    "comparisons": "out[0] = a[0, 0] < a[0, 1]\nout[1] = n == m\nout[2] = n != m\nout[3] = a[0, 8] != a[0, 8]",
    "sizes": "out[0] = abs(-2.5)\nout[1] = abs(a[0, 0] - 9.0)",
    "truths": "t = n > m\nout[0] = t and m > 100\nout[1] = t or m > 100\nout[2] = not t\nout[3] = t & (m > 0)",
    "short cuts": "out[0] = n > 100 and a[n, n] > 0.0\nout[1] = n < 100 or a[n, n] > 0.0",
    "choices": "out[0] = a[0, 0] if n > m else a[0, 1]\nout[1] = a[5, 5] if n < 0 else 3.0",
    "branches": "if n > m:\n    out[0] = 1.0\nelif n == m:\n    out[0] = 2.0\nelse:\n    out[0] = 3.0",
    "loops": (
        "k = 0\nfor j in range(2, n):\n    if j == 5:\n        continue\n    if j > 8:\n        break\n    k += j\n"
        "out[0] = k\nwhile k > 3:\n    k -= 3\nout[1] = k\nfor j in range(n - 1, 2, -2):\n    out[j] = j"
    ),
    "least and greatest": "x = a[0, 8]\nout[0] = min(n, m)\nout[1] = max(1.0, x)\nout[2] = max(x, 1.0)",
    "tables": "t = array([3, 5, 7])\nu = array([0.5, 1])\nout[0] = t[m - 6]\nout[1] = u[1] + int(a[0, 2] * 9.0)",
    "shapes": "out[0] = a.shape[0] * 100 + a.shape[1]\nout[1] = out.size\nrow = a[1]\nout[2] = row[3]",
    "tuples": "x, y = a[0, 0], a[0, 1]\nx, y = y, x\nout[0] = x - 2.0 * y",
    "lanes": in_lanes(
        "x = a[0, i]", "y = sqrt(abs(x))", "out[i] = x if x > 0.5 else -y / 3.0", "out[i] += n"
    ),
    "lanes from the middle": "for i in lanes(8):\n    out[8 + i] = a[1, 8 + i] * a[0, 0]",
    "gathered lanes": in_lanes("k = int(a[1, i] * 15.0)", "out[i] = a[0, k]"),
    # Assignments of longer loops are put in order: by what they read, also of one array by two names, one row by two.
    "long loops in lanes": "c, k, m1 = a, 1, 1\n"
    + in_lanes(
        *(f"x{j} = a[{j % 2}, i] + {j}.0" for j in range(9)),
        "a[0, i] = x1 * 3.0",
        "x1 = x2 - c[0, i]",
        "c[k, i] = x1 + x0",
        "x0, x1 = x1, a[m1, i]",
        "a[m1, i] = x0",
        *(f"out[i] = x{j} - 2.0 * c[k, i]\n    out[i] += out[i] * a[0, i]" for j in range(9)),
    ),
    "entries": "for i in entries(13):\n    out[i] = a[0, i] + 1.0",
    "a NaN": "out[0] = 1.0 if a[0, 8] > 0.0 else 2.0\nout[1] = 1.0 if not a[0, 8] > 0.0 else 2.0",
}


@pytest.mark.parametrize("name", MEANT)
def test_what_is_inside_means_what_python_means(name):
    text = text_of(MEANT[name])
    # As a Source: designs and angles are the arrays, their numbers the whole numbers.
    source = Source(text, 2, 0, (), (Array("out", "float64", (None,)),))
    given = np.random.default_rng(3).uniform(0.05, 0.95, (2, 16))
    given[0, 8] = np.nan
    expected, found = np.full(16, 55.0), np.full(16, 55.0)
    namespace = {}
    exec(compile(text, "<kernel>", "exec"), namespace)
    namespace["kernel"](given.copy(), np.empty((0, 0)), 16, 7, expected)
    load_kernel(source)(given, np.empty((0, 0)), 16, 7, found)
    assert_array_equal(found, expected)
    assert (expected != 55.0).any()


def test_bad_llvm_would_be_noticed():
    """The verifier that other tests run is on: it refuses a block without an end."""
    with pytest.raises(RuntimeError, match=r"terminator|expected instruction"):
        llvm.parse_assembly("define void @kernel(ptr %x) {\n  %y = load i64, ptr %x\n}").verify()


AMONG_ARRAYS = """
import random
import numpy as np
import fastlink as fl
from fastlink.codegen import machine

codes, load = [], machine.Loaded.__init__
machine.Loaded.__init__ = lambda self, code: (codes.append(code), load(self, code))[1]
fl.sweep("planar_4r", {"a1": 0.1, "a2": 0.3, "a3": 0.35, "a4": 0.4}, ["theta4_max"], branch=1)
random.seed(1)
arrays, kernels = [], []
for _ in range(400):
    arrays.append(np.empty(random.choice([10**6, 10**7, 3 * 10**8, 10**9]) // 8))  # of memory that nobody touches
    if len(arrays) > 20:
        arrays.pop(random.randrange(20))
    kernels.append(machine.Loaded(codes[-1]))
    if random.random() < 0.3:
        kernels.pop(random.randrange(len(kernels)))
print(len(kernels))
"""


def test_kernels_are_loaded_wherever_great_arrays_stand():
    # parts of one more than 2 GB apart end the process
    done = subprocess.run([sys.executable, "-c", AMONG_ARRAYS], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-300:]
    assert int(done.stdout) > 200

"""The house: layers, what may be imported where, style and types."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "fastlink"

#: A file imports only from files above it.
LAYERS = [
    *(
        "errors",
        "numerics",
        "fact",
        "names",
        "graph",
        "derivative",
        "error_laws",
        "error_rules",
        "error_paths",
        "error_bound",
        "declaration",
        "catalogue",
        "mechanisms",
        "reductions",
        "cycle",
        "closure",
        "grade",
        "degree",
        "searches",
        "codegen",
        "fixed_point",
        "tables",
        "plan",
        "plans",
    ),
    *(
        "space",
        "table",
        "design",
        "links",
        "request",
        "reading",
        "exact",
        "planar",
        "minkowski",
        "focal",
        "run",
        "spread",
        "checked",
        "asked",
        "engine",
        "verify",
    ),
    *("label", "target", "layout", "journal", "store", "takers", "labelling", "hart", "sweep"),
    *("listing", "summary", "study_schema", "study_design", "study", "accuracy", "explain"),
    *("plot_colour", "plot_text", "plot_draw", "plot", "cli"),
]
#: Only these know of files and of labels.
LABELLED = LAYERS[LAYERS.index("label") :]
FILES = sorted(path for path in SOURCE.rglob("*.py"))


def layer_of(path: Path) -> str:
    return path.relative_to(SOURCE).parts[0].removesuffix(".py")


def imports(path: Path):
    """Yield every imported module, but for those that only types need."""
    tree = ast.parse(path.read_text())
    guarded = {
        id(node)
        for block in ast.walk(tree)
        if isinstance(block, ast.If) and "TYPE_CHECKING" in ast.unparse(block.test)
        for node in ast.walk(block)
    }
    for node in ast.walk(tree):
        if id(node) in guarded:
            continue
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name
        elif isinstance(node, ast.ImportFrom):
            # A name of a package may be a file of it.
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_every_file_has_its_layer():
    assert {layer_of(path) for path in FILES} - {"__init__", "templates"} == set(LAYERS)


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(SOURCE)))
def test_a_file_imports_only_from_above(path):
    layer = layer_of(path)
    if layer == "__init__":
        return
    for module in imports(path):
        if module.startswith("fastlink."):
            other = module.split(".")[1]
            assert LAYERS.index(other) <= LAYERS.index(layer), f"{layer} imports {module}"
            if layer == "mechanisms":
                assert other in ("errors", "numerics", "names", "catalogue", "mechanisms")


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(SOURCE)))
def test_labels_and_files_are_known_below_only(path):
    if layer_of(path) not in LABELLED:
        # `reading` wraps DataArrays that it was given, when it was given some.
        allowed = {"xarray"} if layer_of(path) == "reading" else set()
        assert not {module.split(".")[0] for module in imports(path)} & (
            {"xarray", "h5py", "h5netcdf"} - allowed
        )


#: Packages with a door of their own: only these files know them.
DOORS = {
    "numba": {"codegen/numba_backend.py", "engine/jitted.py"},
    "llvmlite": {"codegen/machine.py", "engine/jitted.py"},
    "llvmlite.binding": {"codegen/machine.py"},
    "filelock": {"codegen/cache.py"},
}


@pytest.mark.parametrize("package", DOORS)
def test_compilers_and_locks_have_one_door(package):
    found = {
        str(path.relative_to(SOURCE))
        for path in FILES
        if any(f"{module}.".startswith(f"{package}.") for module in imports(path))
    }
    assert found == DOORS[package]


@pytest.mark.parametrize(
    "path", sorted((SOURCE / "codegen" / "runtime").glob("*.py")), ids=lambda path: path.name
)
def test_what_kernels_call_imports_numbers_alone(path):
    allowed = ("fastlink.numerics.", "fastlink.codegen.runtime.", "numpy.", "typing.", "__future__.")
    assert [module for module in imports(path) if not f"{module}.".startswith(allowed)] == []


def test_numba_is_imported_only_where_it_is_asked_for():
    """It takes longer to import than all else together."""
    script = """
import sys
import fastlink as fl
found = fl.sweep("planar_4r", fl.grid(a1=0.4, a2=1.1, a3=0.8, a4=1.0, omega1=1.0), ["omega4", "omega4_max"], angles=40)
assert "numba" not in sys.modules
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(SOURCE)))
def test_files_stay_small(path):
    assert len(path.read_text().splitlines()) <= 330


def test_ruff_check_passes():
    run("ruff", "check", ".")


def test_ruff_format_passes():
    run("ruff", "format", "--check", ".")


def test_mypy_passes():
    run("mypy")


def run(*command):
    done = subprocess.run(
        [sys.executable, "-m", *command], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr

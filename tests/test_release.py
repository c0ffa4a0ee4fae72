"""What is released: a wheel, made from the archive of sources, that works alone in a fresh environment."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
STUDY = """
mechanism = "planar_4r"
quantities = ["omega4_max", "shaking_force_max"]
[design]
a1 = 0.4
a2 = {linspace = [1.0, 1.4, 11]}
a3 = 0.8
a4 = 1.0
omega1 = 25.0
[links]
model = "round_bar"
density = 7750.0
radius = 0.01
"""


def test_citation_and_changelog_are_of_this_version():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert citation["version"] == PROJECT["version"]
    assert citation["license"] == PROJECT["license"]
    titles = " ".join(paper["title"] for paper in citation["references"])
    assert all(word in titles for word in ("Minkowskian", "Angular Velocity", "Focal"))
    sections = re.findall(r"^## (.*)$", (ROOT / "CHANGELOG.md").read_text(), flags=re.MULTILINE)
    assert sections[0] == "[Unreleased]"
    version, _, date = sections[1].partition(" - ")
    assert version == f"[{PROJECT['version']}]"
    assert date == str(citation["date-released"])


def run(*command, **options):
    """Run a command outside this environment; return what it prints."""
    bare = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "FASTLINK", "VIRTUAL_ENV"))}
    done = subprocess.run(
        [*map(str, command)], env=bare, capture_output=True, text=True, check=False, **options
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Archive and wheel, the wheel made from the archive."""
    folder = tmp_path_factory.mktemp("built")
    tracked = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True)
    for name in filter(None, tracked.stdout.split("\0")):
        (folder / "tree" / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, folder / "tree" / name)
    venv.create(folder / "builder", with_pip=True)
    python = folder / "builder" / "bin" / "python"
    run(python, "-m", "pip", "install", "--quiet", "build")
    run(python, "-m", "build", "--outdir", folder / "dist", folder / "tree")
    (archive,), (wheel,) = (folder / "dist").glob("*.tar.gz"), (folder / "dist").glob("*.whl")
    return archive, wheel


@pytest.mark.stress
def test_the_wheel_has_the_package_and_its_data(built):
    archive, wheel = built
    assert PROJECT["version"] in wheel.name
    with zipfile.ZipFile(wheel) as opened:
        names = set(opened.namelist())
    source = ROOT / "src"
    kept = {
        str(path.relative_to(source))
        for path in (source / "fastlink").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert kept - names == set()
    assert not [name for name in names if not name.startswith(("fastlink/", "fastlink_linkages-"))]
    with tarfile.open(archive) as opened:
        assert any(name.endswith("/LICENSE") for name in opened.getnames())


PYTHONS = [f"python3.{minor}" for minor in (11, 12, 13)]


@pytest.mark.stress
@pytest.mark.parametrize("python", PYTHONS)
def test_the_wheel_works_in_a_fresh_environment(built, python, tmp_path):
    found = sys.executable if python in os.path.realpath(sys.executable) else shutil.which(python)
    if found is None or subprocess.run([found, "--version"], capture_output=True, check=False).returncode:
        pytest.skip(f"{python} is not installed")
    run(found, "-m", "venv", tmp_path / "fresh")
    bin_ = tmp_path / "fresh" / "bin"
    run(bin_ / "python", "-m", "pip", "install", "--quiet", built[1])
    (tmp_path / "study.toml").write_text(STUDY)
    run(bin_ / "fastlink", "run", "study.toml", cwd=tmp_path)
    shown = run(bin_ / "fastlink", "info", "study.h5", cwd=tmp_path)
    assert "shaking_force_max" in shown
    assert PROJECT["version"] in run(bin_ / "fastlink", "--version", cwd=tmp_path)
    summed = "import fastlink as fl; maps = fl.open('study.h5'); print(float(maps.omega4_max.sum()) > 0)"
    assert run(bin_ / "python", "-W", "error", "-c", summed, cwd=tmp_path).strip() == "True"

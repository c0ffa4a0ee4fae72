"""The cache of kernels: one writer, nothing lost by damage, a bound, and what it says while it compiles."""

import contextlib
import hashlib
import importlib
import io
import os
import pkgutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import filelock
import pytest
from typer.testing import CliRunner

import fastlink
from fastlink.app.cli import app
from fastlink.codegen import cache, kernel
from fastlink.codegen.kernel import MachineCode, llvm_text, load_kernel
from fastlink.codegen.machine import compile_object
from fastlink.codegen.source import Array, Source
from fastlink.errors import InputError
from fastlink.numerics.compiler import COMPILED_AS, INLINED, OUTLINED

#: Kernels that do next to nothing; the number makes others of them.
TEXT = """
def kernel(designs, angles, n_designs, n_angles, out):
    for i in range(n_designs):
        out[i] = {}.0
"""
KEY = "0123456789abcdef" * 2


def source(number):
    return Source(TEXT.format(number), 1, 0, (), (Array("out", "float64", (None,)),))


def code(number=1):
    return compile_object(llvm_text(source(number)))


@pytest.fixture
def place(tmp_path, monkeypatch):
    """An empty cache of its own."""
    monkeypatch.setenv("FASTLINK_CACHE_DIR", str(tmp_path))
    return tmp_path / "kernels"


class Compiler:
    """Counts how often it is asked."""

    def __init__(self, made=b"code"):
        self.made, self.calls = made, 0

    def __call__(self):
        self.calls += 1
        return self.made


def kept(compiler, load=bytes, key=KEY):
    return cache.load_or_compile(key, compiler, load)


def failing(error):
    """Return a function that raises an error, whatever it is given."""

    def fail(*_, **__):
        raise error

    return fail


def test_what_was_compiled_is_kept(place):
    compiler = Compiler()
    assert [kept(compiler), kept(compiler)] == [b"code", b"code"]
    assert compiler.calls == 1
    assert kept(compiler, key="f" * 32) == b"code"
    assert compiler.calls == 2
    assert sorted(path.name for path in place.iterdir()) == [f"{KEY}.o", "f" * 32 + ".o", "locks"]


RIGHT = hashlib.sha256(b"code").digest()
DAMAGED = {
    "of zero length": b"",
    "cut short": (RIGHT + b"code")[:-1],
    "cut within the digest": RIGHT[:20],
    "of another text": RIGHT + b"cod3",
    "the digest of nothing": hashlib.sha256(b"").digest(),
    "of zeros": bytes(200),
}


@pytest.mark.parametrize("damage", DAMAGED)
def test_a_damaged_file_is_made_again(place, damage):
    compiler = Compiler()
    kept(compiler)
    (place / f"{KEY}.o").write_bytes(DAMAGED[damage])
    assert kept(compiler) == b"code"
    assert compiler.calls == 2
    assert kept(compiler) == b"code"
    assert compiler.calls == 2


def test_a_folder_where_the_file_should_be_costs_the_cache_only(place):
    (place / f"{KEY}.o").mkdir(parents=True)
    assert kept(Compiler()) == b"code"


def test_object_code_that_cannot_be_loaded_is_made_again(place):
    """Its digest is right: it was written so."""
    wrong = compile_object("define void @other(ptr %x) {\n  ret void\n}")
    place.mkdir(parents=True)
    (place / f"{KEY}.o").write_bytes(hashlib.sha256(wrong).digest() + wrong)
    compiler = Compiler(code())
    found = kept(compiler, lambda data: MachineCode(source(1), data))
    assert compiler.calls == 1
    assert found.address
    assert kept(compiler, lambda data: MachineCode(source(1), data)).address
    assert compiler.calls == 1


def test_what_the_compiler_raises_is_raised_and_leaves_nothing(place):
    with pytest.raises(ValueError, match="refused"):
        kept(failing(ValueError("refused")))
    assert kept(Compiler()) == b"code"  # no lock is left either
    assert not list(place.glob("*.tmp"))


@pytest.mark.parametrize(
    ("name", "error"),
    [
        ("write_bytes", OSError(28, "No space left on device")),
        ("mkdir", OSError(30, "Read-only file system")),
        ("mkdir", PermissionError(13, "Permission denied")),
    ],
)
def test_a_folder_that_is_full_or_read_only_costs_the_cache_only(place, monkeypatch, name, error):
    place.mkdir(parents=True)
    kept(ready := Compiler())
    for owner, of in ((Path, name), (os, "replace"), (os, "utime")):
        monkeypatch.setattr(owner, of, failing(error))
    assert kept(ready) == b"code"  # what is there is read
    assert ready.calls == 1
    compiler = Compiler()
    for _ in range(2):
        assert kept(compiler, key="f" * 32) == b"code"
    assert compiler.calls == 2
    assert not list(place.glob("*.tmp"))


def test_a_cache_folder_that_is_a_file_is_done_without(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("not a folder")
    monkeypatch.setenv("FASTLINK_CACHE_DIR", str(tmp_path / "file"))
    assert kept(Compiler()) == b"code"
    written = cache.text_file("name.py", "text")
    assert written.read_text() == "text"
    assert tmp_path not in written.parents
    assert cache.contents().kernels == 0


@pytest.mark.parametrize("error", [NotImplementedError("no locks here"), OSError(37, "No locks available")])
def test_a_folder_that_cannot_hold_locks_costs_a_second_compilation_only(place, monkeypatch, error):
    monkeypatch.setattr(filelock.FileLock, "acquire", failing(error))
    assert kept(compiler := Compiler()) == b"code"
    assert kept(compiler) == b"code"
    assert compiler.calls == 1


def test_a_lock_that_another_holds_for_long_costs_a_second_compilation_only(place, monkeypatch):
    monkeypatch.setattr(cache, "PATIENCE", 0.05)
    (place / "locks").mkdir(parents=True)
    with filelock.FileLock(place / "locks" / f"{KEY[:2]}.lock"):
        assert kept(compiler := Compiler()) == b"code"
    assert compiler.calls == 1


def test_a_file_of_text_is_written_again_where_it_is_damaged(place):
    path = cache.text_file("name.py", "text")
    before = path.stat().st_mtime_ns
    assert cache.text_file("name.py", "text") == path
    assert path.stat().st_mtime_ns == before  # numba compares it
    path.write_text("")
    assert cache.text_file("name.py", "text").read_text() == "text"


@pytest.mark.stress
def test_damaged_files_of_numba_are_made_again(place):
    run(place, 7, "numba")
    for ending, keep in (("nbi", 0), ("nbc", 40)):
        (file,) = place.rglob(f"*.{ending}")
        whole = file.read_bytes()
        file.write_bytes(whole[:keep])
        assert run(place, 7, "numba") == "7.0"
        assert len(next(place.rglob(f"*.{ending}")).read_bytes()) > len(whole) / 2


SCRIPT = """
import time
import numpy as np
from fastlink.codegen import kernel
from fastlink.codegen.source import Array, Source

source = Source({text!r}, 1, 0, (), (Array("out", "float64", (None,)),))
made = []
compile_object = kernel.compile_object
def counted(text, **options):
    made.append(text)
    time.sleep({wait})
    return compile_object(text, **options)
kernel.compile_object = counted
loaded = kernel.load_kernel(source, {backend!r})
out = np.zeros(8)
loaded(np.zeros((1, 8)), np.zeros((0, 0)), 8, 0, out)
print("compiled " * len(made) + f"{{out[7]}}\\n", end="")  # in one piece: others write too
"""


#: As many processes as are asked for: what all of them import is imported once, before they part.
PROCESSES = """
import os

children = []
for _ in range({count}):
    child = os.fork()
    if not child:
        break
    children.append(child)
else:
    os._exit(any([os.waitpid(child, 0)[1] for child in children]))
"""


def start(place, number, backend="llvm", wait=0.0, count=0):
    text = SCRIPT.format(text=TEXT.format(number), backend=backend, wait=wait)
    if count:
        imports, mark, rest = text.partition("\nsource = ")
        text = imports + PROCESSES.format(count=count) + mark + rest
    environment = os.environ | {"FASTLINK_CACHE_DIR": str(place.parent)}
    return subprocess.Popen(
        [sys.executable, "-c", text],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def run(*what):
    return finish(start(*what))


def finish(process):
    out, error = process.communicate(timeout=120)
    assert process.returncode == 0, error
    assert error == ""  # no terminal, no line
    return out.strip()


def test_a_second_process_takes_the_kernel_from_the_cache(place):
    assert [run(place, 3), run(place, 3)] == ["compiled 3.0", "3.0"]


@pytest.mark.stress
def test_twenty_processes_compile_once(place):
    """The compilation takes a second more than it would: others come meanwhile."""
    found = sorted(finish(start(place, 4, wait=1.0, count=20)).splitlines())
    assert found == ["4.0"] * 19 + ["compiled 4.0"]
    assert len(list(place.glob("*.o"))) == 1


def test_threads_compile_once(place, monkeypatch):
    compile, made = kernel.compile_object, []
    monkeypatch.setattr(kernel, "compile_object", lambda text, **_: made.append(text) or compile(text))
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(load_kernel, [source(5)] * 8))
    assert len(set(map(id, found))) == len(made) == 1


def test_all_that_kernels_call_is_in_the_packages_that_are_hashed():
    """Facts of mechanisms are pasted into the text; functions that are called by name must be hashed.

    A kernel of synthesis is the whole text of its module.
    """
    for module in pkgutil.walk_packages(fastlink.__path__, "fastlink."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    hashed = tuple(package.__name__ + "." for package in cache.PACKAGES)
    for function in [*INLINED, *OUTLINED, *COMPILED_AS]:
        module = function.__module__ or ""  # of texts that other tests compile there is none
        if module.startswith("fastlink.") and module != "fastlink.synthesis.kernels":
            assert module.startswith(hashed), function


@pytest.mark.parametrize("package", ["numerics", "codegen", "codegen/runtime"])
def test_an_edit_in_a_package_is_another_environment(package, tmp_path, monkeypatch):
    copies = []
    for one in cache.PACKAGES:
        target = tmp_path / one.__name__.split(".")[-1]
        for file in Path(one.__path__[0]).rglob("*.py"):
            copy = target / file.relative_to(one.__path__[0])
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(file.read_bytes())
        copies.append(type("Package", (), {"__path__": [str(target)]}))
    monkeypatch.setattr(cache, "PACKAGES", copies)
    read = cache.environment.__wrapped__
    assert read() == cache.environment()
    edited = next((tmp_path / package).glob("[a-z]*.py"))
    edited.write_bytes(edited.read_bytes() + b"#")
    assert read() != cache.environment()


@pytest.fixture
def every_write_counts(monkeypatch):
    """Look through the folder at every write."""
    monkeypatch.setattr(cache, "PART", float("inf"))


def fill(count, size=1000):
    """Keep kernels in turn, the first one for longest."""
    keys = [f"{k:032x}" for k in range(count)]
    for k, key in enumerate(keys):
        kept(Compiler(bytes(size)), key=key)
        age(cache.cache_folder() / f"{key}.o", (count - k) * 60.0)
    return keys


def age(path, seconds):
    os.utime(path, (time.time() - seconds,) * 2)


def names(place):
    return {path.stem for path in place.glob("*.o")}


def test_what_was_not_used_for_longest_goes(place, monkeypatch, every_write_counts):
    monkeypatch.setenv("FASTLINK_CACHE_BYTES", str(5 * 1032))
    keys = fill(5)
    kept(Compiler(bytes(1000)), key=keys[0])  # now it is the last one that was used
    kept(Compiler(bytes(1000)), key="a" * 32)
    assert names(place) == {keys[0], *keys[2:], "a" * 32}
    assert cache.contents().size <= 5 * 1032


def test_the_bound_holds_though_the_folder_is_looked_through_seldom(place, monkeypatch):
    monkeypatch.setattr(cache, "_written", 0.0)
    monkeypatch.setenv("FASTLINK_CACHE_BYTES", str(32 * 1032))
    looked = []
    entries = cache._entries
    monkeypatch.setattr(cache, "_entries", lambda: looked.append(1) or entries())
    fill(100)
    assert len(looked) <= 100 / 2
    assert cache.contents().size <= (32 + 32 / cache.PART) * 1032


def test_what_nothing_uses_any_more_goes_in_time(place, every_write_counts):
    """Whatever made it: an older version, a process that was killed while it wrote."""
    (first, second) = fill(2)
    strange = [
        place / "fastlink_kernel_0a1b.py",
        place / f"{first}.o.17-1.tmp",
        place / "__pycache__" / "x.nbi",
    ]
    strange[2].parent.mkdir()
    for path in (*strange, place / f"{first}.o"):
        path.write_bytes(b"0")
        age(path, cache.UNUSED + 60.0)
    kept(Compiler(), key="b" * 32)
    assert names(place) == {second, "b" * 32}
    assert not [path for path in strange if path.exists()]


def test_files_of_one_kernel_go_together(place, monkeypatch, every_write_counts):
    """Numba keeps three, and reads the first of them alone at times."""
    monkeypatch.setenv("FASTLINK_CACHE_BYTES", "2500")
    text, index = place / f"kernel_{KEY}.py", place / "__pycache__" / f"kernel_{KEY}.nbi"
    index.parent.mkdir(parents=True)
    for path in (text, index):
        path.write_bytes(bytes(700))
    age(text, 3600.0)
    (old,) = fill(1)
    age(place / f"{old}.o", 1800.0)
    kept(Compiler(bytes(500)), key="b" * 32)
    assert text.exists()
    assert index.exists()
    assert names(place) == {"b" * 32}


@pytest.mark.parametrize("size", ["0", "10"])
def test_a_bound_below_one_kernel_keeps_none(place, monkeypatch, size, every_write_counts):
    monkeypatch.setenv("FASTLINK_CACHE_BYTES", size)
    compiler = Compiler()
    assert [kept(compiler), kept(compiler)] == [b"code"] * 2
    assert compiler.calls == 2


@pytest.mark.parametrize("size", ["many", "-1", "1e6", "256MB"])
def test_a_bound_that_is_no_number_is_told(place, monkeypatch, size):
    monkeypatch.setenv("FASTLINK_CACHE_BYTES", size)
    with pytest.raises(
        InputError, match=r"FASTLINK_CACHE_BYTES: .* is not a number of bytes; write such as \d+"
    ):
        cache.contents()


def test_the_command_shows_and_clears_and_says_what_it_could_not_remove(place, monkeypatch):
    command = CliRunner()
    empty = command.invoke(app, ["cache"])
    assert empty.exit_code == 0
    assert empty.output == f"{place}: 0 kernels of 0 B; beyond 268 MB the oldest are removed\n"
    fill(3)
    assert "3 kernels of 3.1 kB" in command.invoke(app, ["cache"]).output
    assert command.invoke(app, ["cache", "--clear"]).output == f"{place}: 3 kernels of 3.1 kB removed\n"
    assert not [path for path in place.rglob("*") if path.is_file()]
    assert "0 kernels" in command.invoke(app, ["cache", "--clear"]).output
    kept(Compiler())
    assert "1 kernel of 36 B" in command.invoke(app, ["cache"]).output
    command.invoke(app, ["cache", "--clear"])
    fill(2)
    monkeypatch.setattr(Path, "unlink", failing(PermissionError(13, "Permission denied")))
    assert "2.06 kB could not be removed" in command.invoke(app, ["cache", "--clear"]).output


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def terminal(monkeypatch):
    found = Terminal()
    # The notice's own: pytest puts another one in the place of the system's.
    monkeypatch.setattr(cache, "sys", SimpleNamespace(stderr=found))
    monkeypatch.setattr(cache, "PATIENCE", 0.05)
    monkeypatch.setattr(cache, "_ended", float("-inf"))
    return found


def wait_for(terminal):
    """Wait until something stands there, ten seconds at most."""
    end = time.monotonic() + 10.0
    while not terminal.getvalue() and time.monotonic() < end:
        time.sleep(0.01)


@pytest.mark.parametrize("fails", [False, True])
def test_what_takes_long_is_told_and_wiped_out(terminal, fails):
    with contextlib.suppress(ValueError), cache.notice():
        wait_for(terminal)
        assert terminal.getvalue() == f"\r{cache.TEXT}"
        if fails:
            raise ValueError
    assert terminal.getvalue() == f"\r{cache.TEXT}\r{' ' * len(cache.TEXT)}\r"


def test_many_short_ones_are_one_wait(terminal, monkeypatch):
    monkeypatch.setattr(cache, "PAUSE", 60.0)
    with cache.notice():
        pass
    time.sleep(0.05)
    with cache.notice():
        wait_for(terminal)
    assert terminal.getvalue().startswith(f"\r{cache.TEXT}")


@pytest.mark.parametrize("stream", [Terminal(), io.StringIO(), None], ids=["quick", "no terminal", "none"])
def test_what_is_quick_or_without_a_terminal_is_not_told(monkeypatch, stream):
    monkeypatch.setattr(cache, "sys", SimpleNamespace(stderr=stream))
    monkeypatch.setattr(cache, "PATIENCE", 60.0 if isinstance(stream, Terminal) else 0.0)
    with cache.notice():
        time.sleep(0.05)
    assert stream is None or stream.getvalue() == ""


def test_a_kernel_that_compiles_is_told(place, terminal, monkeypatch):
    compile = kernel.compile_object

    def slowly(text, **options):
        wait_for(terminal)
        return compile(text, **options)

    monkeypatch.setattr(kernel, "compile_object", slowly)
    load_kernel(source(6))
    assert "compiling" in terminal.getvalue()


@pytest.fixture
def planted(place):
    """Return a folder with code for `KEY`, with the right digest."""
    assert kept(Compiler(b"planted")) == b"planted"
    cache._remark.cache_clear()
    return place


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="users have no numbers here")
@pytest.mark.parametrize("mode", [0o777, 0o1777, 0o770, None])
def test_code_that_another_user_may_have_planted_is_not_run(planted, monkeypatch, mode):
    said = "can be written by other users"
    if mode is None:
        own = os.geteuid()  # every file is of another user: only the administrator can give files away
        monkeypatch.setattr(os, "geteuid", lambda: own + 1)
        said = "belongs to another user"
    else:
        planted.chmod(mode)
    before = sorted(planted.rglob("*"))
    with pytest.warns(fastlink.InputWarning, match=said):
        assert kept(compiler := Compiler()) == b"code"
    assert kept(compiler) == b"code"  # and nothing more is said
    assert compiler.calls == 2
    assert not cache.is_kept(KEY)
    if mode is not None:  # else this process has no folder of its own either
        assert planted not in cache.text_file(f"{KEY}.py", "text").parents
    with cache.locked(KEY):
        assert sorted(planted.rglob("*")) == before


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="users have no numbers here")
def test_a_file_that_another_user_may_have_written_is_replaced(planted):
    file = planted / f"{KEY}.o"
    file.chmod(0o666)
    assert kept(Compiler()) == b"code"
    assert file.stat().st_mode & 0o077 == 0
    assert kept(Compiler(b"never")) == b"code"


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="users have no numbers here")
def test_what_numba_would_run_is_not_taken_from_another_user(planted):
    name = f"{KEY}.py"
    assert cache.text_file(name, "text").parent == planted
    index = planted / "__pycache__" / f"{KEY}.kernel.nbi"
    index.parent.mkdir()
    index.write_bytes(b"planted")
    index.chmod(0o666)
    assert planted not in cache.text_file(name, "text").parents


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="users have no numbers here")
def test_folders_of_the_cache_are_for_their_user_alone(place):
    before = os.umask(0)
    try:
        kept(Compiler())
    finally:
        os.umask(before)
    assert place.stat().st_mode & 0o077 == 0
    assert kept(Compiler(b"never")) == b"code"

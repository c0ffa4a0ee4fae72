"""Faults of system calls: the n-th call of a run fails, does half, is interrupted or is its last.

A library stands between the process and libc, where there is a C compiler and a preloader: HDF5's own calls fail too.
"""

from __future__ import annotations

import ctypes
import errno
import faulthandler
import functools
import json
import mmap
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

from fastlink.io import partial_file

#: Seconds after which a run is taken for one that hangs.
PATIENCE = 60
#: The faults by the library's numbers: those of errors are their own.
FAULTS = {"kill": 0, "kill after it": -2, "interrupt": -1, "SIGTERM": -5, "half of it": -3}
FAULTS |= {"full disk": -4, "EIO": errno.EIO, "ENOSPC": errno.ENOSPC, "EINTR": errno.EINTR}
#: How a run may end after a fault; it ends with 0 where the call was none that matters, or is done again.
CODES = {
    "kill": (-signal.SIGKILL, 0),
    "kill after it": (-signal.SIGKILL, 0),
    "interrupt": (130, 0),
    "SIGTERM": (-signal.SIGTERM, 0),
    "half of it": (0,),
}


@functools.cache
def library() -> str:
    """Return the path of the library, compiled for this session; why there is none otherwise, as a `RuntimeError`."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None or not sys.platform.startswith("linux"):
        raise RuntimeError("faults below Python need Linux and a C compiler (cc, gcc or clang)")
    source = Path(__file__).with_name("faults.c")
    target = Path(tempfile.mkdtemp(prefix="faults-")) / "faults.so"
    command = [compiler, "-O1", "-shared", "-fPIC", "-o", str(target), str(source), "-ldl"]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"faults below Python: {done.stderr[-500:]}")
    return str(target)


class Outcome(NamedTuple):
    """How a run with a fault ended: exit code, the call that was struck, who made it, and how many calls there were."""

    code: int
    call: str = ""
    caller: str = ""
    calls: int = 0


class Trials:
    """Runs in a process of their own, each with a fault; a context manager."""

    def __init__(self, run: str) -> None:
        command = [sys.executable, "-m", "tests.support.faults", run]
        pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        self.process = subprocess.Popen(command, env={**os.environ, "LD_PRELOAD": library()}, **pipes)

    def run(self, path: Path, at: int, fault: str, **options: Any) -> Outcome:
        """Run with a fault, and return how it ended."""
        self.process.stdin.write(json.dumps([str(path), int(at), fault, options]) + "\n")
        self.process.stdin.flush()
        return Outcome(*json.loads(self.process.stdout.readline()))

    def __enter__(self) -> Trials:
        return self

    def __exit__(self, *error: object) -> None:
        self.process.stdin.close()
        assert self.process.wait(60) == 0
        self.process.stdout.close()


def main(run: str) -> None:
    """Serve trials from standard input, each in a forked process."""
    import importlib
    import traceback

    from fastlink.errors import InputError

    module, _, name = run.partition(":")
    function = getattr(importlib.import_module(module), name)
    partial_file.STEP_SECONDS = 0.0
    signal.signal(signal.SIGINT, signal.default_int_handler)  # which a shell's background ignores
    function(None).close()
    page = mmap.mmap(-1, mmap.PAGESIZE)
    arm = ctypes.CDLL(None).faults_arm
    address = ctypes.addressof(ctypes.c_char.from_buffer(page))
    for line in sys.stdin:
        path, at, fault, options = json.loads(line)
        page[:128] = bytes(128)
        child = os.fork()
        if not child:
            faulthandler.dump_traceback_later(PATIENCE, exit=True)  # a run that hangs ends with 1
            folder = os.path.dirname(path).encode()
            arm(folder, ctypes.c_long(at), FAULTS[fault], ctypes.c_void_p(address))
            try:
                function(path, **options).close()
                code = 0
            except KeyboardInterrupt:
                code = 130
            except InputError:
                code = 2
            except BaseException:
                traceback.print_exc()
                code = 1
            os._exit(code)
        status = os.waitpid(child, 0)[1]
        calls, call, caller = int.from_bytes(page[:8], sys.byteorder), page[8:32], page[32:104]
        texts = [text.rstrip(b"\0").decode() for text in (call, caller)]
        print(json.dumps([os.waitstatus_to_exitcode(status), *texts, calls]), flush=True)


if __name__ == "__main__":
    main(sys.argv[1])

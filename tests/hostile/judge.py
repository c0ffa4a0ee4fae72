"""One oracle for every case: refused with a remedy, or taken with the numbers of the plain value; nothing else."""

import contextlib
import resource
import signal
import warnings
from dataclasses import fields, is_dataclass

import numpy as np
import pandas as pd
import xarray as xr

import fastlink as fl
from fastlink.engine.function import Function
from fastlink.errors import InputError, InputWarning, Wording
from tests.hostile.values import REFUSED, TAKEN

#: Of processor time, for one case; the longest good one takes some tenths.
SECONDS = 5.0
#: Of memory beyond what the process has: what does not fit is to be refused before it is asked for.
BYTES = 12 << 30
LONGEST_LINE = 400


class Hang(BaseException):
    """A case ran too long."""


@contextlib.contextmanager
def limits():
    """Bound processor time and memory of what runs inside."""

    def stop(*_):
        raise Hang

    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    with open("/proc/self/statm") as file:
        now = int(file.read().split()[0]) * resource.getpagesize()
    before = signal.signal(signal.SIGPROF, stop)
    resource.setrlimit(resource.RLIMIT_AS, (now + BYTES, hard))
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
        signal.signal(signal.SIGPROF, before)


def attempt(text, names):
    """Return what a call gives, or what it raises; warnings are errors, but remarks of fastlink."""
    try:
        with warnings.catch_warnings(), limits():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", InputWarning)
            return eval(compile(text, "<case>", "eval"), dict(names)), None
    except (Hang, Exception) as error:
        return None, error


def complaint_about(text):
    """Return what is wrong with the lines of a refusal, or an empty text."""
    try:
        text.encode()
    except UnicodeError:
        return "cannot be printed"
    longest = max(map(len, text.split("\n")))
    if longest >= LONGEST_LINE:
        return f"has a line of {longest} characters"
    if "Traceback" in text or " at 0x" in text or "0x7f" in text:
        return "shows an address or a traceback"
    if not text.strip() or any(ord(sign) < 32 for sign in text if sign != "\n"):
        return "is empty or has control characters"
    return ""


def complaint(error):
    """Return what is wrong with a refusal, or an empty text."""
    if wrong := complaint_about(str(error)):
        return wrong
    wording = error.wording or Wording()
    for problem in error.problems:
        if not wording.remedy(problem.remedy).strip():
            return f"has no remedy: {problem.what[:60]}"
        if not problem.where and ": " not in wording.line(problem):
            return f"says not where: {problem.what[:60]}"
    return ""


def judged(verdict, text, plain, names):
    """Return ``"refused"``, ``"taken"`` or ``"failed"``, and why it failed; the plain call says what is meant."""
    result, error = attempt(text, names)
    if isinstance(error, InputError):
        if verdict == TAKEN:
            return "failed", f"refuses a good value: {str(error)[:200]}"
        if wrong := complaint(error):
            return "failed", f"its refusal {wrong}"
        _, again = attempt(text, names)
        if not isinstance(again, InputError) or str(again) != str(error):
            return "failed", f"another verdict the second time: {again!r}"[:200]
        return "refused", ""
    if error is not None:
        return "failed", "hangs" if isinstance(error, Hang) else f"{type(error).__name__}: {str(error)[:200]}"
    if verdict == REFUSED:
        return "failed", f"accepted, gives {shown(result)}"
    if plain == text:  # the call has checked its result itself, or means what it says
        return "taken", ""
    wanted, error = attempt(plain, names)
    if error is not None:
        return "failed", f"accepted, but the plain call raises {error!r}"
    if not same(result, wanted):
        return "failed", f"gives {shown(result)}, the plain value {shown(wanted)}"
    return "taken", ""


def shown(result):
    """Return a result on one short line."""
    try:
        return " ".join(repr(plain_of(result)).split())[:160]
    except Exception as error:
        return type(error).__name__


def plain_of(result):
    """Return a result as plain containers of arrays."""
    if isinstance(result, xr.Dataset):
        return {str(name): (one.dims, one.values) for name, one in result.variables.items()}
    if isinstance(result, xr.DataArray):
        return result.dims, result.values
    if isinstance(result, fl.DesignSpace):
        plain = {name: getattr(result, name) for name in ("dims", "shape", "constants", "axes")}
        return plain | {"columns": {name: np.asarray(values) for name, values in result.columns.items()}}
    if isinstance(result, Function):
        sample = np.linspace(0.7, 1.3, 3)[None].repeat(len(result.inputs), axis=0)
        return result.inputs, result.quantities, result(sample)
    if is_dataclass(result) and not isinstance(result, type):
        return {one.name: getattr(result, one.name) for one in fields(result)}
    if isinstance(result, fl.focal.Involution):
        return vars(result)
    if isinstance(result, pd.DataFrame):
        return result.to_dict("list")
    if type(result).__name__ == "Page":  # whose address has a token of its own
        return None
    if type(result).__name__ == "NotebookFigure":
        return [len(axes.get_children()) for axes in result.axes]
    return result


def same(one, other):
    """Tell whether two results are the same, bit for bit; a labelled array may stand for a plain one."""
    if isinstance(one, xr.Dataset) and isinstance(other, xr.Dataset):  # labels of designs may come along
        one = one.drop_vars([name for name in one.coords if name not in other.variables])
    if isinstance(one, xr.DataArray) and not isinstance(other, xr.DataArray):
        one = one.values
    one, other = plain_of(one), plain_of(other)
    if isinstance(one, dict):
        alike = isinstance(other, dict) and list(one) == list(other)
        return alike and all(same(one[name], other[name]) for name in one)
    if isinstance(one, (list, tuple)):
        alike = isinstance(other, (list, tuple)) and len(one) == len(other)
        return alike and all(map(same, one, other))
    if isinstance(one, (np.ndarray, np.generic, float)):
        first, second = np.asarray(one), np.asarray(other)
        if first.shape != second.shape or first.dtype != second.dtype:
            return False
        return bool(np.array_equal(first, second, equal_nan=first.dtype.kind in "fc"))
    return bool(one == other)

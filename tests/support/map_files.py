"""A small map file with variables of every kind, for the tests of its writing."""

import hashlib
import os

import numpy as np

from fastlink.io.layout import Variable, assemble, coordinates
from fastlink.io.writer import Writer
from fastlink.space.samplers import grid
from fastlink.space.tables import table

METRE = {"units": "m", "long_name": "length", "symbol": "a"}
DESCRIBED = dict.fromkeys(["a1", "a2", "a3"], METRE)
FURTHER = {
    "branch": (("branch",), np.array([1, 2], dtype="i1"), {"long_name": "assembly mode"}),
    "theta1": (("theta1",), np.array([0.0, 3.0]), {"units": "rad"}),
}
SPACES = {
    "grid with equal axes": grid(a1=0.4, a2=[1.0, 2.0, 3.0], a3=[4.0, 5.0, 6.0]),
    "table": table({"a1": [0.4, 0.4, 0.6], "a2": [1.0, 2.0, 3.0], "a3": 1.0}),
    "one design": grid(a1=0.4, a2=1.2),
}


class Sample:
    """A small sweep: coordinates, variables of every kind, and their values, one row per design."""

    def __init__(self, space=SPACES["grid with equal axes"], seed=0):
        self.coords = coordinates(space, DESCRIBED, FURTHER)
        self.attrs = {"title": "übung", "study": "x" * 70_000, "n": 3, "error": 1e-15}
        self.size = space.size
        self.variables = [
            self.variable(space, "omega4_max", "f8", units="rad s⁻¹"),
            self.variable(space, "status", "i1", flag_values=np.array([0, 1], "i1"), flag_meanings="a b"),
            self.variable(space, "B_x", "f8", "branch", "theta1", units="m"),
            # as long as branch: a reader that matches dimensions by length gets it wrong
            self.variable(space, "count", "i8", "theta1"),
            self.variable(space, "B_y", "f4", "branch", "theta1"),
        ]
        rng = np.random.default_rng(seed)
        self.arrays = {
            item.name: rng.integers(-100, 100, (self.size, *item.shape[len(space.dims) :])).astype(item.dtype)
            for item in self.variables
        }
        self.arrays["omega4_max"][-1] = np.nan

    def variable(self, space, name, dtype, *inner, **attrs):
        shape = space.shape + tuple(self.coords.sizes[dim] for dim in inner)
        return Variable(name, space.dims + inner, shape, np.dtype(dtype), attrs)

    def writer(self, path, **options):
        return Writer(path, self.coords, self.variables, self.attrs, **options)

    def fill(self, writer, step=4):
        for name, values in self.arrays.items():
            for start in range(0, self.size, step):
                writer.write(name, start, values[start : start + step])

    def save(self, path, *, before=None, between=None, last=1.5, **options):
        """Write the file; `before` is called before the values are written, `between` before the end."""
        with self.writer(path, **options) as writer:
            if before:
                before()
            self.fill(writer)
            if between:
                between()
            writer.finish({"run_time": last})
        return path

    def expected(self):
        return assemble(self.coords, self.variables, self.arrays, {**self.attrs, "run_time": 1.5})


def left_in(folder):
    return sorted(path.name for path in folder.iterdir())


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def flip(path, offset):
    """Change one bit of a file."""
    with open(path, "r+b") as file:
        file.seek(offset)
        byte = file.read(1)
        file.seek(offset)
        file.write(bytes([byte[0] ^ 4]))


def failing_after(patch, count, error):
    """Let the block after so many raise."""
    record = Writer.record

    def counted(self, start, stop, seen=[0]):  # noqa: B006
        record(self, start, stop)
        seen[0] += 1
        if seen[0] == count:
            raise error

    patch.setattr(Writer, "record", counted)


def raising(number):
    def fail(*args, **options):
        raise OSError(number, os.strerror(number))

    return fail

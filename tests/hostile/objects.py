"""Objects that fail where a caller looks at them."""

import enum


def _failing(name, *methods):
    """Return a class of which some methods raise."""

    def fail(*_, **__):
        raise RuntimeError(f"no {methods[0]}")

    return type(name, (), dict.fromkeys(methods, fail))


Sulky = _failing("Sulky", "__repr__", "__str__")
BadArray = _failing("BadArray", "__array__")
BadFloat = _failing("BadFloat", "__float__", "__index__")
BadLength = _failing("BadLength", "__len__", "__getitem__")
BadIteration = _failing("BadIteration", "__iter__")
BadTruth = _failing("BadTruth", "__eq__", "__bool__")
BadAttributes = _failing("BadAttributes", "__getattr__")
BadPath = _failing("BadPath", "__fspath__")


class Everything:
    """Has every attribute, and each is itself."""

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return self

    def __call__(self, *args, **options):
        return self


class Real(float):
    """A float of another class."""


class Whole(int):
    """An int of another class."""


class Name(str):
    """A text of another class."""


class Code(enum.IntEnum):
    """Assembly modes as somebody may enumerate them."""

    RIGHT = 1
    LEFT = 2


def circle():
    """Return a list that holds itself."""
    inside = []
    inside.append(inside)
    return inside


def deep():
    """Return a list in a list, a thousand times."""
    inside = []
    for _ in range(1000):
        inside = [inside]
    return inside

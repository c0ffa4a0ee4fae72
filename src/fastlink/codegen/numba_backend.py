"""The other compiler: numba, for the same text. The only module that knows numba's options.

It is what the translator is tested against, and what compiles where that refuses or knows no processor.
"""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numba
import numpy as np
from numba.core.compiler import Compiler
from numba.extending import overload, register_jitable

from fastlink.codegen.cache import text_file
from fastlink.numerics import elementary
from fastlink.numerics.compiler import COMPILED_AS, INLINED, OUTLINED

if TYPE_CHECKING:
    from types import ModuleType

    from fastlink.codegen.source import Source

#: Keeps divisions free of branches; with numba's default nothing vectorises.
OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True}
INLINE_OPTIONS: dict[str, Any] = {"error_model": "numpy", "forceinline": True}


def _trailing_zeros(bits: Any) -> Any:
    count = 0
    while bits & 1 == 0:
        bits = bits >> 1
        count += 1
    return count


#: What numba reads instead of functions that are operations; np.where on scalars would stop vectorisation.
OPERATIONS: dict[Callable[..., Any], Callable[..., Any]] = {
    elementary.sqrt: lambda x: np.sqrt(x),
    elementary.select: lambda condition, if_true, if_false: if_true if condition else if_false,
    elementary.bits_of: lambda x: np.float64(x).view(np.int64),
    elementary.double_of: lambda bits: np.int64(bits).view(np.float64),
    elementary.trailing_zeros: _trailing_zeros,
}


#: The functions that are declared to numba.
_declared: set[Callable[..., Any]] = set()


def declare() -> None:
    """Declare every function that kernels call to numba; when called again, those that were marked since."""

    def reading(text: Callable[..., Any]) -> Callable[..., Any]:
        return lambda *types: text

    texts = OPERATIONS | COMPILED_AS
    for function in [*texts, *INLINED, *OUTLINED]:
        if function in _declared:
            continue
        _declared.add(function)
        if function in texts:
            overload(function, jit_options=INLINE_OPTIONS, strict=False)(reading(texts[function]))
        else:
            register_jitable(**(INLINE_OPTIONS if function in INLINED else OPTIONS))(function)


class _Restrict(Compiler):  # type: ignore[misc]
    """Numba's compiler with one promise more: the array arguments of a kernel do not overlap.

    It is C's ``restrict``. Without it, a loop that stores to more than a few arrays is not vectorised.
    """

    def __init__(self, *arguments: Any) -> None:
        flags = arguments[5]
        flags.noalias = True
        super().__init__(*arguments)


def _signature(arguments: Sequence[tuple[str, tuple[int | None, ...]]]) -> tuple[Any, ...]:
    types = ((getattr(numba.types, dtype), len(lengths)) for dtype, lengths in arguments)
    return tuple(numba.types.Array(dtype, axes, "C") if axes else dtype for dtype, axes in types)


def _module(text: str, key: str) -> ModuleType:
    """Return the text as a module, from a file: numba's cache stands beside it."""
    name = f"fastlink_kernel_{key}"
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, text_file(f"{name}.py", text))
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def compile_by_numba(source: Source, key: str) -> Callable[..., None]:
    """Return the kernel as numba compiles it, or has it in its cache; it is called with the kernel's arguments."""
    declare()
    module = _module(source.text, key)
    for function in vars(module).values():
        if callable(function) and function in OUTLINED | INLINED and function not in _declared:
            register_jitable(**(INLINE_OPTIONS if function in INLINED else OPTIONS))(function)
    kernel = numba.njit(**OPTIONS, cache=True, pipeline_class=_Restrict)(module.kernel)
    kernel.compile(_signature(source.arguments))
    return kernel  # type: ignore[no-any-return]

"""From a plan's facts to a text, from a text to machine code.

`pointwise`, `extremes` and `known` write the text, `translate` reads it as LLVM, `machine` compiles that, `cache`
keeps it; `numba_backend` is the other compiler. What kernels call stands in `runtime`.
"""

"""Functions that kernels call, with loops of their own, in the grammar of `fastlink.codegen.translate`.

Every array is given by the caller; nothing is allocated here.
"""

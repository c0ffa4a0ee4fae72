"""Speed of the compiled plans against C, NumPy and JAX on the same arithmetic."""

import os

# Before NumPy is imported: one thread for everybody.
for _name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ[_name] = "1"

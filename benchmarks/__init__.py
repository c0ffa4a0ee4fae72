"""Speed of the compiled kernels against C, NumPy and other peers, and the time to an answer."""

import os

# Before NumPy is imported: one thread for everybody.
for _name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ[_name] = "1"

"""Tests of the package; where several workers share them, each takes one core."""

import os

# Threads of BLAS that wait for those of other workers spend more time than they save.
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

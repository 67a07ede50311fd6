"""Tests of the package; where several workers share them, each takes one core."""

import os

# Threads of BLAS that wait for those of other workers spend more time than they save. Set where
# the workers are started: in a worker numpy is there already, by the plugins of other packages.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

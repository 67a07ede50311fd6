"""Tests of the package; when several workers run them, each worker uses one core."""

import os

# The BLAS threads of one worker, waiting for the threads of the others, cost more time than they
# save. The variable is set in the process that starts the workers: within a worker the plugins of
# other packages have already imported numpy.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

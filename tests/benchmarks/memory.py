"""Memory: the peak memory of this process."""

import resource


def peak_gigabytes() -> float:
    """Peak memory in GB since the start of the process, hence including all earlier tests."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6

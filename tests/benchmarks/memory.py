"""Memory: the largest part of it that this process has held."""

import resource


def peak_gigabytes() -> float:
    """Since its start, hence of all tests that ran before as well."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6

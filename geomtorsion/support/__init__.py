"""Support: what every part needs and no part is about: checks, files, limits, displays."""

__all__ = [
    "allowance",
    "budget",
    "caching",
    "checks",
    "copies",
    "displays",
    "exclusive",
    "executors",
    "files",
    "hdf5",
    "hints",
    "npz",
    "outgoing",
    "precision",
    "progress",
    "workers",
]

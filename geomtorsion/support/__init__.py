"""Support: what every part needs and no part is about: checks, files, limits, displays."""

# Modules are loaded when they are needed: some of them take long.
# pyright: reportUnsupportedDunderAll=false

__all__ = [
    "allowance",
    "arguments",
    "budget",
    "caching",
    "checks",
    "copies",
    "csv_table",
    "displays",
    "exclusive",
    "executors",
    "file_kinds",
    "files",
    "hdf5",
    "hints",
    "npz",
    "outgoing",
    "precision",
    "progress",
    "text_rows",
    "typed_text",
    "workers",
]

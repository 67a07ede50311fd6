"""cells: Jupyter notebooks as JSON-ready data (nbformat 4.5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from geomtorsion.teaching.exercises.worker_pool import Json


def markdown_cell(key: str, text: str, metadata: Mapping[str, object] | None = None) -> Json:
    """A cell of text; key is its id, letters, digits and dashes.

    Examples
    --------
    >>> markdown_cell("title", "# One\\ntwo")["source"]
    ['# One\\n', 'two']
    """
    return {
        "cell_type": "markdown",
        "id": key,
        "metadata": dict(metadata or {}),
        "source": text.splitlines(keepends=True),
    }


def code_cell(key: str, text: str, metadata: Mapping[str, object] | None = None) -> Json:
    """A cell of Python without output.

    Examples
    --------
    >>> code_cell("imports", "import geomtorsion as gt")["outputs"]
    []
    """
    return {
        "cell_type": "code",
        "execution_count": None,
        "id": key,
        "metadata": dict(metadata or {}),
        "outputs": [],
        "source": text.splitlines(keepends=True),
    }


def notebook(cells: Sequence[Json]) -> Json:
    """A notebook of Python 3.

    Examples
    --------
    >>> document = notebook([])
    >>> document["nbformat"], document["metadata"]["kernelspec"]["name"]
    (4, 'python3')
    """
    return {
        "cells": list(cells),
        "metadata": {
            "kernelspec": {
                "display_name": "Python 3",
                "language": "python",
                "name": "python3",
            },
            "language_info": {"name": "python"},
        },
        "nbformat": 4,
        "nbformat_minor": 5,
    }

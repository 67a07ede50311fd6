"""Tables: columns handed to pandas."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

from geomtorsion.errors import MissingExtraError


def pandas_table(columns: Mapping[str, Any]) -> Any:
    """Columns of equal length, by name, as a pandas DataFrame.

    Raises
    ------
    MissingExtraError
        pandas is not installed.
    """
    try:
        pandas = import_module("pandas")
    except ImportError:
        raise MissingExtraError(
            "to_pandas needs pandas, which is not installed. Run `pip install pandas`."
        ) from None
    return pandas.DataFrame(columns)

"""Checks: one converter for each kind of argument, with one form of refusal.

names: a text, a name out of a set, a path, a mapping of names, an instance; what messages show.
values: a number, a whole number, a truth value, an expression; limits of their sizes.
lists: a list of a length, several numbers, truth values, an array of a shape.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from geomtorsion.errors import LONGEST_SHOWN
from geomtorsion.support.checks.names import (
    GREEK,
    KNOWN_IDENTITIES,
    ErrorClass,
    by_name,
    check_values,
    choice,
    close_names,
    cut,
    did_you_mean,
    file_name,
    instance,
    known_keys,
    known_name,
    labelled,
    near_names,
    refuse,
    sentence,
    shown,
    table,
    text,
)

if TYPE_CHECKING:
    from geomtorsion.support.checks.lists import (
        LARGEST_ARRAYS,
        MEASURABLE,
        array,
        check_one_each,
        check_room,
        entries,
        flags,
        indices,
        is_list,
        measured,
        numbers,
        rows,
        unmasked,
        whole_array,
    )
    from geomtorsion.support.checks.values import (
        DECLARED,
        LARGEST_ARGUMENT,
        LargestArgument,
        against,
        check_constant,
        check_declared,
        count,
        exact_number,
        exponent_too_large,
        expression,
        flag,
        fraction,
        not_negative,
        number,
        plain,
        positive,
        rational,
        real,
        repr_fraction,
        too_large,
        whole,
    )

__all__ = [
    "DECLARED",
    "GREEK",
    "KNOWN_IDENTITIES",
    "LARGEST_ARGUMENT",
    "LARGEST_ARRAYS",
    "LONGEST_SHOWN",
    "MEASURABLE",
    "ErrorClass",
    "LargestArgument",
    "against",
    "array",
    "by_name",
    "check_constant",
    "check_declared",
    "check_one_each",
    "check_room",
    "check_values",
    "choice",
    "close_names",
    "count",
    "cut",
    "did_you_mean",
    "entries",
    "exact_number",
    "exponent_too_large",
    "expression",
    "file_name",
    "flag",
    "flags",
    "fraction",
    "indices",
    "instance",
    "is_list",
    "known_keys",
    "known_name",
    "labelled",
    "measured",
    "near_names",
    "not_negative",
    "number",
    "numbers",
    "plain",
    "positive",
    "rational",
    "real",
    "refuse",
    "repr_fraction",
    "rows",
    "sentence",
    "shown",
    "table",
    "text",
    "too_large",
    "unmasked",
    "whole",
    "whole_array",
]


# Checkers of types know all names from above; with this they would take any name.
if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """A converter of values or lists: both load sympy, for which no help text waits."""
        for module in ("values", "lists") if name in __all__ else ():
            loaded = import_module(f"{__name__}.{module}")
            if hasattr(loaded, name):
                found = globals()[name] = getattr(loaded, name)
                return found
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

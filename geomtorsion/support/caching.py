"""Caching: values that are computed on first use and kept, without a lock."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

if TYPE_CHECKING:
    from functools import cached_property as cached_property
else:

    class cached_property(functools.cached_property):
        """As in functools from Python 3.12 on, except that all threads get the same object.

        Before, one lock for all instances is held while a value is computed: two threads, each of
        which computes what the other needs, wait for each other for ever.
        """

        def __get__(self, instance: Any, owner: type[Any] | None = None) -> Any:
            """The value, computed if it is not yet there."""
            if instance is None:
                return self
            cache = instance.__dict__
            if self.attrname not in cache:
                # Two threads may compute it: the first value stays.
                cache.setdefault(self.attrname, self.func(instance))
            return cache[self.attrname]


def read_only(array: np.ndarray) -> np.ndarray:
    """Return an array that all callers of a cached function share, locked against writing.

    Examples
    --------
    >>> import numpy as np
    >>> read_only(np.zeros(2)).flags.writeable
    False
    """
    array.flags.writeable = False
    return array

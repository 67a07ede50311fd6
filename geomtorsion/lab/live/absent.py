"""absent: stands where numpy and scipy would, on a machine for which nobody has built them.

What is exact needs neither, but imports modules that also do numerical work. There names of an
absent package may be mentioned, called and combined; the error comes from whoever wants a value.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType, SimpleNamespace
from typing import NoReturn

from geomtorsion.errors import MissingExtraError

# What is known of numbers of 64 bits without any arrays: (module, name) -> value.
_FLOAT = sys.float_info
KNOWN: dict[tuple[str, str], object] = {
    ("numpy", "pi"): math.pi,
    ("numpy", "sqrt"): math.sqrt,
    ("numpy", "finfo"): lambda _: SimpleNamespace(
        eps=_FLOAT.epsilon, tiny=_FLOAT.min, precision=_FLOAT.dig, resolution=10.0**-_FLOAT.dig
    ),
    # Types stand in unions of types; nothing is an instance of this one.
    ("numpy", "ndarray"): type("ndarray", (), {"__doc__": "An array, of which there are none."}),
    ("numpy", "iinfo"): lambda _: SimpleNamespace(max=2**63 - 1),
}


class Absent:
    """A value that is not there; it can be handed about, and not be read.

    Examples
    --------
    >>> half = Absent("numpy").linspace(0, 1, 3) / 2
    >>> bool(half)
    Traceback (most recent call last):
    geomtorsion.errors.MissingExtraError: this needs numpy (numpy.linspace()), which has no build...
    >>> isinstance(1, Absent("numpy").ndarray)
    False
    """

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, name: str) -> Absent:
        # What Python looks for by itself, such as __array_interface__, is not there either.
        if name.startswith("__"):
            raise AttributeError(name)
        return Absent(f"{self._name}.{name}")

    def __call__(self, *_: object, **__: object) -> Absent:
        """What would have come back, which is not there either."""
        return Absent(f"{self._name}()")

    def __instancecheck__(self, instance: object) -> bool:
        return False

    def __subclasscheck__(self, subclass: type) -> bool:
        return False

    def __mro_entries__(self, bases: tuple[object, ...]) -> tuple[type, ...]:
        return ()

    def __getitem__(self, _: object) -> Absent:
        return self

    def __repr__(self) -> str:
        return f"<absent {self._name}>"

    def __hash__(self) -> int:
        return hash(self._name)

    def _refuse(self, *_: object) -> NoReturn:
        package = self._name.partition(".")[0]
        raise MissingExtraError(
            f"this needs {package} ({self._name}), which has no build for browsers on PyPI or npm. "
            "Use `geomtorsion lab` or Python on a computer."
        )

    def _same(self, *_: object) -> Absent:
        return self

    __bool__ = __float__ = __int__ = __index__ = __complex__ = __len__ = __iter__ = _refuse
    __eq__ = __ne__ = __lt__ = __le__ = __gt__ = __ge__ = __contains__ = __setitem__ = _refuse
    __str__ = __format__ = __round__ = __reduce_ex__ = __enter__ = __exit__ = _refuse
    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = _same
    __rtruediv__ = __pow__ = __rpow__ = __neg__ = __matmul__ = __rmatmul__ = __or__ = __ror__ = (
        _same
    )


class _Finder(MetaPathFinder, Loader):
    """Gives an empty package for each name below some packages."""

    def __init__(self, packages: Sequence[str]) -> None:
        self.packages = frozenset(packages)

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        if name.partition(".")[0] not in self.packages:
            return None
        return ModuleSpec(name, self, is_package=True)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return _AbsentModule(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        module.__path__ = []


class _AbsentModule(ModuleType):
    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(name)
        known = KNOWN.get((self.__name__, name))
        return Absent(f"{self.__name__}.{name}") if known is None else known


def stand_in(packages: Sequence[str] = ("numpy", "scipy")) -> None:
    """Let these packages be imported, and be absent."""
    sys.meta_path.insert(0, _Finder(packages))

"""Materials: Burgers vectors of measured and simulated matter."""

from importlib import import_module
from typing import TYPE_CHECKING

from geomtorsion.materials.burgers import Burgers, Section
from geomtorsion.materials.source import Backdrop, Source
from geomtorsion.materials.survey import Errors, Survey

if TYPE_CHECKING:
    from geomtorsion.materials import crystals, elasticity, fields, images, lines, maps

_PACKAGES = ("crystals", "elasticity", "fields", "images", "lines", "maps")

__all__ = [
    "Backdrop",
    "Burgers",
    "Errors",
    "Section",
    "Source",
    "Survey",
    "crystals",
    "elasticity",
    "fields",
    "images",
    "lines",
    "maps",
]


def __getattr__(name: str) -> object:
    """A package of one kind of data, imported on first use."""
    if name in _PACKAGES:
        return import_module(f"geomtorsion.materials.{name}")
    raise AttributeError(f"module 'geomtorsion.materials' has no attribute {name!r}")


def __dir__() -> list[str]:
    """All public names."""
    return [*__all__]

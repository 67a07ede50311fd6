"""Errors: every failure a user can cause. A message reads "expected X, got Y. <remedy>".

`error.page` of an error names the page of the documentation (examples/site) that helps.
"""

import re
from typing import Any, ClassVar

# Longer values are cut in messages to their beginning and their end.
LONGEST_SHOWN = 200
# A word, or terms of an expression with their signs between them.
_TERMS = re.compile(r"\S+(?: [-+*/] \S+)*")


def _cut(text: str, most: int) -> str:
    """A text without its middle."""
    half = (most - 3) // 2
    return text if len(text) <= most else f"{text[:half]}...{text[-half:]}"


def _shortened(message: str) -> str:
    """A message without the middle of long words and expressions, so that it is never endless."""
    words = _TERMS.sub(lambda terms: _cut(terms[0], LONGEST_SHOWN), message)
    return _cut(words, 10 * LONGEST_SHOWN)


class GeomtorsionError(Exception):
    """Base class of all errors of this package; their messages have a limited length.

    page: name of the page of the documentation (examples/site) that helps.

    Examples
    --------
    >>> LoopError.page
    'tutorials/loops_that_do_not_close'
    >>> issubclass(CoframeError, GeomtorsionError)
    True
    >>> len(str(CoframeError("x" * 10**6)))
    199
    """

    page: ClassVar[str] = "errors"

    def __init__(self, *args: object) -> None:
        super().__init__(*(_shortened(x) if isinstance(x, str) else x for x in args))


class ArgumentError(GeomtorsionError, TypeError):
    """An argument is of the wrong kind: the message names the required kind and the given one."""


class ExpressionError(GeomtorsionError, ValueError):
    """An expression cannot be read exactly: the message names the entry and the part."""

    page = "howto/tetrad_file"


class LimitError(GeomtorsionError, ValueError):
    """The input is larger than the limit that the message states."""


class AllowanceError(LimitError):
    """Work took more time or memory than `limits` allows; `quantity` is the requested quantity."""

    def __init__(self, message: str, quantity: str = "") -> None:
        super().__init__(message)
        self.quantity = quantity


class CoframeError(GeomtorsionError, ValueError):
    """A coframe (or set of legs) is not square, singular or otherwise no basis."""

    page = "howto/tetrad_file"


class CoordinateError(GeomtorsionError, ValueError):
    """Coordinates or parameters are repeated, missing or clash."""

    page = "howto/tetrad_file"


class MetricError(GeomtorsionError, ValueError):
    """A metric is not symmetric, degenerate, or not of the requested signature."""

    page = "howto/tetrad_file"


class SignatureError(GeomtorsionError, ValueError):
    """eta is not a constant, symmetric, non-degenerate matrix of the right size."""

    page = "howto/tetrad_file"


class StructureConstantError(GeomtorsionError, ValueError):
    """Structure constants are not antisymmetric or violate the Jacobi identity."""

    page = "howto/tetrad_file"


class ShapeError(GeomtorsionError, ValueError):
    """An array does not have the shape that the dimension requires."""


class TensorIndexError(GeomtorsionError, ValueError):
    """Index letters, positions or kinds do not fit together."""

    page = "tutorials/connections"


class MissingValueError(GeomtorsionError, KeyError):
    """A symbol has no value at the point of evaluation."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class SingularPointError(GeomtorsionError, ArithmeticError):
    """A quantity has no finite value at the requested point."""


class BranchError(SingularPointError):
    """A root was read with one sign and has the other at a point: the message names both."""


class UndecidedError(GeomtorsionError, ArithmeticError):
    """Whether an expression vanishes cannot be decided exactly."""

    page = "tutorials/accuracy"


class FileFormatError(GeomtorsionError, ValueError):
    """A file cannot be read or written: the message names the file, the key and the reason."""


class UnknownNameError(GeomtorsionError, KeyError, AttributeError):
    """No space, quantity or format has this name; the message lists near ones.

    A KeyError, by which mappings such as `Moment` know that a name is not in them; and an
    AttributeError, by which `hasattr` knows it of `solution.states`.
    """

    # KeyError.__str__ would put the message in quotes.
    __str__ = Exception.__str__


class MissingExtraError(GeomtorsionError, ImportError):
    """An optional package is not installed; the message names the extra that brings it."""


class PackageError(GeomtorsionError, OSError):
    """A package needed for a page without a server is missing, or is not the right one."""


class LoopError(GeomtorsionError, ValueError):
    """A path is not a loop (it is open or has no length), or an integral along it fails."""

    page = "tutorials/loops_that_do_not_close"


class StartError(GeomtorsionError, ValueError):
    """A motion cannot start like this: the message names the number and the remedy."""


class TimeError(GeomtorsionError, ValueError):
    """Times are empty, not finite, repeated, unsorted, or on both sides of the start."""


class AccuracyError(GeomtorsionError, ArithmeticError):
    """The requested accuracy is invalid, or cannot be reached with the requested engine.

    ensemble: the members of an ensemble that do reach it, or None.
    solution: the computed part of a motion that is closer to an edge than rounding errors, or
        None.
    """

    page = "tutorials/accuracy"

    def __init__(self, message: str, ensemble: Any = None) -> None:
        super().__init__(message)
        self.ensemble: Any = ensemble
        self.solution: Any = None


class WorkerError(GeomtorsionError, RuntimeError):
    """A worker of an executor ended without a result.

    part: the number of its part of the job. partial: what the other workers finished, or None.
    """

    page = "howto/more_machines"

    def __init__(self, message: str, part: int = 0, partial: Any = None) -> None:
        super().__init__(message)
        self.part: int = part
        self.partial: Any = partial

    @classmethod
    def of(cls, error: Exception, part: int) -> "WorkerError":
        """The error for whatever a worker raised."""
        return cls(f"{type(error).__name__}: {error}", part)


class ChartEdgeError(GeomtorsionError, ArithmeticError):
    """A motion ran out of its chart; `solution` holds everything computed so far, or None."""

    page = "howto/second_chart"

    def __init__(self, message: str, solution: Any = None) -> None:
        super().__init__(message)
        self.solution: Any = solution


class StuckError(GeomtorsionError, ArithmeticError):
    """A motion cannot continue; `solution` holds everything computed so far, or None."""

    def __init__(self, message: str, solution: Any = None) -> None:
        super().__init__(message)
        self.solution: Any = solution


class CheckpointError(GeomtorsionError, ValueError):
    """A checkpoint cannot be read, or belongs to another run."""


class ProofError(GeomtorsionError, ArithmeticError):
    """A result cannot be proved: the message names the time or the point, and the reason.

    time: where a proof of a motion ended, else None.
    """

    page = "howto/how_sure_is_a_number"

    def __init__(self, message: str, time: float | None = None) -> None:
        super().__init__(message)
        self.time: float | None = time


class EndpointError(GeomtorsionError, ArithmeticError):
    """No motion, or no unique one, leads from one point to another."""


class NetworkError(GeomtorsionError, ValueError):
    """A network of paths or dislocation lines lacks data or violates a conservation law."""

    page = "tutorials/loops_that_do_not_close"


class CrystalError(GeomtorsionError, ValueError):
    """Atoms form no crystal, or another than named; the message names the crystal that fits."""

    page = "tutorials/from_data"


class GridError(GeomtorsionError, ValueError):
    """A sampled frame has no regular grid, holds no finite values, or is left by a loop."""

    page = "tutorials/from_data"


class OrientationError(GeomtorsionError, ValueError):
    """An orientation map lacks something, or a circuit in it leaves its grain: it names pixels."""

    page = "tutorials/from_data"


class ImageError(GeomtorsionError, ValueError):
    """An image shows no lattice, or too little of it at the requested position."""

    page = "tutorials/from_data"


class ElasticityError(GeomtorsionError, ValueError):
    """No stable crystal has these elastic constants, or their number does not fit its symmetry."""

    page = "tutorials/stress"


class UnitError(GeomtorsionError, ValueError):
    """A unit is unknown, or does not measure what the field measures."""


class BodyError(GeomtorsionError, ValueError):
    """A body has no mass, or moments of inertia that no body can have."""

    page = "tutorials/top_and_effects"


class SceneError(GeomtorsionError, ValueError):
    """A scene contradicts itself or lacks something: effects, start, or outputs."""

    page = "tutorials/top_and_effects"


class LagrangianError(GeomtorsionError, ValueError):
    """A Lagrangian or force holds an unknown symbol, or is not an expression."""

    page = "tutorials/top_and_effects"


class GravityError(GeomtorsionError, ValueError):
    """A Lagrangian of gravity, its connection or its matter do not fit together."""

    page = "tutorials/gravity"


class KineticMatrixError(GeomtorsionError, ValueError):
    """The kinetic matrix of a Lagrangian is singular: accelerations are not determined."""

    page = "tutorials/top_and_effects"


class ConstraintError(GeomtorsionError, ValueError):
    """A constraint is not linear in the velocities, or follows from the others."""

    page = "tutorials/top_and_effects"


def __dir__() -> list[str]:
    """The names that this file defines, without what it imports."""
    return sorted(
        name
        for name, value in globals().items()
        if not name.startswith("_") and getattr(value, "__module__", __name__) == __name__
    )

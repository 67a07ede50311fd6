"""Errors: every failure a user can cause, each saying what was needed, what came, what to do."""


class GeomtorsionError(Exception):
    """Base of every error this package raises on purpose.

    Examples
    --------
    >>> issubclass(CoframeError, GeomtorsionError)
    True
    """


class ExpressionError(GeomtorsionError, ValueError):
    """An expression cannot be read exactly: the message names the entry and the part."""


class LimitError(GeomtorsionError, ValueError):
    """The input is larger than the limit that the message states."""


class CoframeError(GeomtorsionError, ValueError):
    """A coframe (or set of legs) is not square, singular or otherwise no basis."""


class CoordinateError(GeomtorsionError, ValueError):
    """Coordinates or parameters are repeated, missing or clash."""


class MetricError(GeomtorsionError, ValueError):
    """A metric is not symmetric, degenerate, or not of the signature asked for."""


class SignatureError(GeomtorsionError, ValueError):
    """eta is not a constant, symmetric, non-degenerate matrix of the right size."""


class StructureConstantError(GeomtorsionError, ValueError):
    """Structure constants are not antisymmetric or violate the Jacobi identity."""


class ShapeError(GeomtorsionError, ValueError):
    """An array has not the shape that the dimension demands."""


class TensorIndexError(GeomtorsionError, ValueError):
    """Index letters, positions or kinds do not fit together."""


class MissingValueError(GeomtorsionError, KeyError):
    """A symbol has no value at the point of evaluation."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class SingularPointError(GeomtorsionError, ArithmeticError):
    """A quantity has no finite value at the point asked for."""


class UndecidedError(GeomtorsionError, ArithmeticError):
    """Whether an expression vanishes cannot be decided exactly."""


class FileFormatError(GeomtorsionError, ValueError):
    """A file cannot be read: the message names the file, the key and the reason."""


class UnknownNameError(GeomtorsionError, LookupError):
    """No space, quantity or format has this name; the message lists near ones."""


class MissingExtraError(GeomtorsionError, ImportError):
    """An optional package is not installed; the message names the extra that brings it."""


class LoopError(GeomtorsionError, ValueError):
    """A path is no loop (it does not close, has no length), or cannot be integrated over."""

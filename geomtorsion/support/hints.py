"""Hints: a misspelt attribute or argument is answered with the name that was probably meant."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import wraps
from inspect import Parameter, signature
from typing import NoReturn, ParamSpec, TypeVar

from geomtorsion.errors import ArgumentError
from geomtorsion.support.checks import near_names, shown

Kind = TypeVar("Kind", bound=type)
Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


@dataclass(frozen=True, eq=False)
class _Answer:
    """Text about an unknown attribute, worked out when it is read: `hasattr` does not read it.

    Examples
    --------
    >>> print(_Answer("text", "uper", {}))
    str has no attribute 'uper'. Did you mean upper?
    """

    asked: object
    name: str
    meant: Mapping[str, str]

    def __str__(self) -> str:
        near = ""
        # Copies, pickles and notebooks look for names with underscores.
        if not self.name.startswith("_"):
            public = (one for one in dir(self.asked) if not one.startswith("_"))
            near = self.meant.get(self.name) or near_names(self.name, public)
        hint = f". Did you mean {near}?" if near else ""
        return f"{type(self.asked).__name__} has no attribute {self.name!r}{hint}"

    def __repr__(self) -> str:
        return repr(str(self))

    def __reduce__(self) -> tuple[type[str], tuple[str]]:
        # An error that another process raised carries its text, not the object.
        return str, (str(self),)


def attribute_hints(**meant: str) -> Callable[[Kind], Kind]:
    """Let a class answer an unknown attribute with the name, or the line, that was meant.

    meant: attribute that users expect -> the line that gives it.

    The class gets a `__getattr__` that only raises AttributeError, so `hasattr` stays right.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> load("so3").frame.torsion
    Traceback (most recent call last):
    AttributeError: Frame has no attribute 'torsion'. Did you mean gt.cartan(frame).torsion?
    """

    def decorate(kind: Kind) -> Kind:
        def refuse(self: object, name: str) -> NoReturn:
            if hasattr(type(self), name):
                # A property raised AttributeError: its own message counts.
                object.__getattribute__(self, name)
            # With a name in the error, Python would add a question of its own.
            raise AttributeError(_Answer(self, name, meant), name=None)

        # Set here and not written in the class: checkers of types would then take any name.
        setattr(kind, "__getattr__", refuse)  # noqa: B010
        return kind

    return decorate


def argument_hints(
    **meant: str,
) -> Callable[[Callable[Arguments, Result]], Callable[Arguments, Result]]:
    """Let a function answer an unknown keyword with the keyword that was meant.

    meant: keyword of other libraries -> how to write it here.

    Raises
    ------
    ArgumentError
        A call has a keyword that the function does not take, or lacks an argument.

    Examples
    --------
    >>> @argument_hints(rtol="accuracy=1e-8")
    ... def run(time, accuracy=1e-10): ...
    >>> run(1, rtol=1e-3)
    Traceback (most recent call last):
    geomtorsion.errors.ArgumentError: run: expected the arguments time, accuracy, got 'rtol'. Did
    you mean accuracy=1e-8?
    """

    def decorate(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
        parameters = signature(function).parameters.values()
        names = [one.name for one in parameters if one.kind is not Parameter.VAR_KEYWORD]
        allowed = frozenset(names)
        needed = [
            (k, one.name)
            for k, one in enumerate(parameters)
            if one.default is Parameter.empty
            and one.kind in (Parameter.POSITIONAL_OR_KEYWORD, Parameter.KEYWORD_ONLY)
        ]

        @wraps(function)
        def checked(*args: Arguments.args, **options: Arguments.kwargs) -> Result:
            for name in options:
                if name not in allowed:
                    near = meant.get(name) or near_names(name, names)
                    hint = f" Did you mean {near}?" if near else ""
                    raise ArgumentError(
                        f"{function.__name__}: expected the arguments {', '.join(names)}, got "
                        f"{shown(name)}.{hint}"
                    )
            for place, name in needed:
                if place >= len(args) and name not in options:
                    raise ArgumentError(
                        f"{function.__name__}: expected the arguments {', '.join(names)}, got no "
                        f"{name}. Give a value for it."
                    )
            return function(*args, **options)

        return checked

    return decorate

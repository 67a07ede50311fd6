"""Canary: a text that leaves a trace when it is executed, put wherever a value enters."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp

EVENT = "geomtorsion.canary"
# Evaluating this text as Python raises an audit event and does nothing else.
PAYLOAD = f"__import__('sys').audit('{EVENT}')"
MARK = "geomtorsion.canary"
FORBIDDEN = ("os.system", "os.exec", "os.posix_spawn", "subprocess.Popen", "pty.spawn")


class Watch:
    """Audit hook of this process, active only while it is switched on; there is one (`WATCH`)."""

    def __init__(self) -> None:
        self.on = False
        self.installed = False
        self.seen: list[str] = []

    def hook(self, event: str, args: tuple[Any, ...]) -> None:
        if not self.on:
            return
        if event == EVENT or event in FORBIDDEN:
            # The process that grades exercises is our own; it never receives a payload here.
            if event != "subprocess.Popen" or args[0] != sys.executable or MARK in str(args[1]):
                self.seen.append(event)
        elif event in ("compile", "exec") and args and MARK in source_of(args[0]):
            self.seen.append(f"{event} of the payload")
        elif event == "import" and args and "canary" in str(args[0]):
            self.seen.append(f"import of {args[0]}")
        elif event == "open" and isinstance(args[1], str) and set(args[1]) & set("wax+"):
            self.seen.append(f"{args[0]} opened for writing")

    def during(self, call: Callable[[], Any]) -> tuple[BaseException | None, list[str]]:
        """The error of a call, if any, and the forbidden actions that it took."""
        if not self.installed:
            sys.addaudithook(self.hook)
            self.installed = True
        self.seen = []
        self.on = True
        try:
            call()
        except Exception as error:  # noqa: BLE001
            return error, self.seen
        finally:
            self.on = False
        return None, self.seen


def source_of(code: Any) -> str:
    """The text to compile, or the constants and names of code to execute."""
    if isinstance(code, bytes):
        return code.decode("utf-8", "replace")
    if isinstance(code, str):
        return code
    return str((getattr(code, "co_consts", ""), getattr(code, "co_names", "")))


WATCH = Watch()


class Disguised:
    """An object whose text is the payload, which sympify would evaluate."""

    def __str__(self) -> str:
        return PAYLOAD

    __repr__ = __str__


class Listed(list):
    """A list whose text is the payload."""

    __str__ = __repr__ = Disguised.__str__


def payloads() -> dict[str, Any]:
    """The payload by itself and nested, by name."""
    return {
        "text": PAYLOAD,
        "list": [PAYLOAD],
        "tuple": (PAYLOAD,),
        "pair": (PAYLOAD, PAYLOAD),
        "rows": [[PAYLOAD, 0], [0, PAYLOAD]],
        "set": {PAYLOAD},
        "table": {"x": PAYLOAD},
        "key": {PAYLOAD: 1},
        "array": np.array([PAYLOAD]),
        "scalar": np.array(PAYLOAD),
        "objects": np.array([PAYLOAD, 1], dtype=object),
        "numpy": np.str_(PAYLOAD),
        "object": Disguised(),
        "listed": Listed([1]),
        "symbol": sp.Symbol(PAYLOAD),
        "function": sp.Function(PAYLOAD)(sp.Symbol("x")),
    }


# Inside a valid argument only these shapes are tried.
INNER = ("text", "tuple", "scalar", "object", "symbol")


@dataclass
class Case:
    """A valid call and its arguments."""

    name: str
    call: Callable[..., Any]
    arguments: dict[str, Any] = field(default_factory=dict)


def poisoned(case: Case) -> Iterator[tuple[str, dict[str, Any]]]:
    """Arguments of a call with the payload at one position each, as pairs (label, arguments)."""
    shapes = payloads()
    for key, value in case.arguments.items():
        for shape, payload in shapes.items():
            yield f"{case.name}({key}={shape})", case.arguments | {key: payload}
        for place, replaced in leaves(value):
            for shape in INNER:
                changed = case.arguments | {key: replaced(shapes[shape])}
                yield f"{case.name}({key}{place}={shape})", changed


def leaves(value: Any, depth: int = 0) -> Iterator[tuple[str, Callable[[Any], Any]]]:
    """Positions inside lists, tuples and tables, each with a function that replaces its value."""
    if depth > 3:
        return
    if isinstance(value, list | tuple) and not hasattr(value, "_fields"):
        kind = type(value)
        for k, part in enumerate(value):

            def put(x: Any, k: int = k) -> Any:
                return kind([*value[:k], x, *value[k + 1 :]])

            yield f"[{k}]", put
            for place, inner in leaves(part, depth + 1):
                yield f"[{k}]{place}", lambda x, put=put, inner=inner: put(inner(x))
    elif isinstance(value, dict):
        for key, part in value.items():

            def under(x: Any, key: Any = key) -> Any:
                return value | {key: x}

            yield f"[{key}]", under
            for place, inner in leaves(part, depth + 1):
                yield f"[{key}]{place}", lambda x, under=under, inner=inner: under(inner(x))

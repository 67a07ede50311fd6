"""inlined: the body of a generated function, the functions that it calls written out."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from copy import deepcopy


def inlined(source: str) -> tuple[list[str], list[str]] | None:
    """Statements and results of `values`, the last function of a source; None if it is not plain.

    Plain are assignments to names, and one return of a tuple at the end. Arguments keep their
    names; what a called function names gets its name as a prefix.

    Examples
    --------
    >>> inner = "def twice(x):\\n  t = 2*x\\n  return (t,)\\n"
    >>> inlined(inner + "def values(a):\\n  b, = twice(a)\\n  return (b, a)")
    (['twice_t = 2 * a', 'b = twice_t'], ['b', 'a'])
    """
    functions = {f.name: f for f in ast.parse(source).body if isinstance(f, ast.FunctionDef)}
    entry = functions.get("values")
    if entry is None:
        return None
    lines: list[str] = []
    arguments = {one.arg: one.arg for one in entry.args.args}
    try:
        return lines, _expanded(functions, entry, arguments, "", lines)
    except _NotPlainError:
        return None


class _NotPlainError(Exception):
    """The source has something else than assignments of tuples and names."""


class _Renamed(ast.NodeTransformer):
    """Writes expressions with other names."""

    def __init__(self, names: Mapping[str, str]) -> None:
        self.names = names

    def visit_Name(self, node: ast.Name) -> ast.Name:
        return ast.Name(self.names.get(node.id, node.id), node.ctx)

    def text(self, node: ast.expr) -> str:
        """Source of an expression."""
        # Visitors change what they visit, and a function may be called again.
        return ast.unparse(self.visit(deepcopy(node)))


def _expanded(
    functions: Mapping[str, ast.FunctionDef],
    function: ast.FunctionDef,
    arguments: Mapping[str, str],
    prefix: str,
    lines: list[str],
) -> list[str]:
    """The results of a function; its statements are put at the end of the lines."""
    names = dict(arguments)
    for statement in function.body:
        writer = _Renamed(dict(names))
        if isinstance(statement, ast.Return) and isinstance(statement.value, ast.Tuple):
            return [writer.text(one) for one in statement.value.elts]
        if not isinstance(statement, ast.Assign):
            break
        (target, *others), value = statement.targets, statement.value
        targets = target.elts if isinstance(target, ast.Tuple) else [target]
        own = [one.id for one in targets if isinstance(one, ast.Name)]
        called = value.func if isinstance(value, ast.Call) else None
        if isinstance(called, ast.Name) and called.id in functions:
            assert isinstance(value, ast.Call)
            inner = functions[called.id]
            if inner is function:
                break
            given = [writer.text(one) for one in value.args]
            inside = dict(zip([one.arg for one in inner.args.args], given, strict=True))
            longer = f"{prefix}{called.id}_"
            results = _expanded(functions, inner, inside, longer, lines)
        else:
            results = [writer.text(value)]
        if others or len(own) != len(targets) or len(results) != len(own):
            break
        names |= {name: prefix + name for name in own}
        lines += [f"{names[name]} = {one}" for name, one in zip(own, results, strict=True)]
    raise _NotPlainError

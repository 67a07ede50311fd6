"""Source: files, imports, names and annotations of the package, read for `test_layout`."""

from __future__ import annotations

import ast
import io
import tokenize
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path

import networkx as nx

import geomtorsion
from geomtorsion.ode.engines.named import SHIPPED

PACKAGE = Path(geomtorsion.__file__).parent
FILES = tuple(sorted(PACKAGE.rglob("*.py")))
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
LOOKED_FOR = (*FUNCTIONS, ast.Import, ast.ImportFrom, ast.AnnAssign)
NO_CODE = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENCODING,
    tokenize.ENDMARKER,
}
Nodes = Iterable[tuple[ast.AST, bool]]


def name_of(file: Path) -> str:
    """A file relative to the package."""
    return str(file.relative_to(PACKAGE))


@cache
def text_of(file: Path) -> str:
    """The text of a file."""
    return file.read_text("utf-8")


@cache
def tree_of(file: Path) -> ast.Module:
    """The syntax tree of a file."""
    return ast.parse(text_of(file))


def walk(node: ast.AST, inside: bool = False) -> Iterator[tuple[ast.AST, bool]]:
    """Functions, imports and annotated variables, each with whether it is inside a function."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.stmt):
            if isinstance(child, LOOKED_FOR):
                yield child, inside
            yield from walk(child, inside or isinstance(child, FUNCTIONS))
        elif isinstance(child, ast.excepthandler | ast.match_case):
            yield from walk(child, inside)


@cache
def looked_for(file: Path) -> list[tuple[ast.AST, bool]]:
    """Functions, imports and annotated variables of a file."""
    return list(walk(tree_of(file)))


def part_of(file: Path) -> str:
    """First name below geomtorsion of a file."""
    return file.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imported_names(nodes: Nodes) -> Iterator[tuple[str, ...]]:
    """Parts of each dotted name that is imported from geomtorsion, at any depth of the code."""
    for node, _ in nodes:
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"line {node.lineno}: imports are absolute"
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        for name in names:
            head, *rest = name.split(".")
            if head == "geomtorsion":
                yield tuple(rest)


def named_modules(tree: ast.AST) -> Iterator[tuple[str, ...]]:
    """Parts of each name in `import_module("geomtorsion. ...")`, up to the first computed one."""
    for node in ast.walk(tree):
        if not (isinstance(node, ast.Call) and node.args):
            continue
        if ast.unparse(node.func).rpartition(".")[2] not in ("import_module", "__import__"):
            continue
        first = node.args[0]
        if isinstance(first, ast.JoinedStr) and first.values:
            first = first.values[0]
        if isinstance(first, ast.Constant) and isinstance(first.value, str):
            head, *rest = first.value.removesuffix(".").split(".")
            if head == "geomtorsion" and rest:
                yield tuple(rest)


def imported_file(name: tuple[str, ...]) -> Path:
    """The file that defines a dotted name: a module, or the __init__ of a package."""
    for count in range(len(name), 0, -1):
        place = PACKAGE.joinpath(*name[:count])
        if place.with_suffix(".py").is_file():
            return place.with_suffix(".py")
        if (place / "__init__.py").is_file():
            return place / "__init__.py"
    return PACKAGE / "__init__.py"


def rings(edges: Mapping[str, set[str]]) -> list[set[str]]:
    """Groups of nodes in which each node can be reached from each other one."""
    graph = nx.DiGraph([(one, two) for one, found in edges.items() for two in found if two != one])
    return [ring for ring in nx.strongly_connected_components(graph) if len(ring) > 1]


def loaded_imports(file: Path) -> Nodes:
    """What a file looks for while it is loaded: neither for types nor inside a function."""
    for_types = {
        inner
        for node in tree_of(file).body
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    return [
        (node, inside) for node, inside in looked_for(file) if not (inside or node in for_types)
    ]


@cache
def file_imports(loaded: bool = False) -> dict[str, set[str]]:
    """The files that each file imports, also inside functions and for types unless `loaded`."""
    return {
        name_of(file): {
            name_of(imported_file(name))
            for name in imported_names(loaded_imports(file) if loaded else looked_for(file))
        }
        for file in FILES
    }


@cache
def package_imports(deep: tuple[str, ...] = ()) -> dict[str, set[str]]:
    """The packages that each package imports; subpackages of those in `deep` count separately."""

    def package(file: str) -> str:
        first, _, rest = file.partition("/")
        return f"{first}/{rest.partition('/')[0]}" if first in deep else first

    imports: dict[str, set[str]] = {}
    for file, others in file_imports().items():
        imports.setdefault(package(file), set()).update(
            package(other) for other in others if package(other) != package(file)
        )
    return imports


@cache
def exports(package: str) -> frozenset[str]:
    """The names in `__all__` of a package of geomtorsion."""
    for node in tree_of(PACKAGE / package / "__init__.py").body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            return frozenset(ast.literal_eval(node.value))
    return frozenset()


def is_exported(name: tuple[str, ...]) -> bool:
    """Whether a dotted name is in `__all__` of its package, or in a module that is.

    Any package may import a module that is directly in geomtorsion, such as checks.
    """
    package = PACKAGE / name[0]
    return not package.is_dir() or len(name) == 1 or name[1] in exports(name[0])


def code_lines(file: Path) -> int:
    """Number of code lines of a file, without docstrings, comments and blank lines."""
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text_of(file)).readline):
        if token.type not in NO_CODE:
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(tree_of(file)):
        body = getattr(node, "body", None)
        documented = isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
        if documented and body and ast.get_docstring(node, clean=False) is not None:
            lines.difference_update(range(body[0].lineno, (body[0].end_lineno or 0) + 1))
    return len(lines)


def bare_inner_imports(text: str, nodes: Nodes) -> list[int]:
    """Lines of imports inside functions without a comment on their line or on the line before."""
    inner = [n for n, inside in nodes if inside and isinstance(n, ast.Import | ast.ImportFrom)]
    if not inner:
        return []
    comments = {
        token.start[0]
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type == tokenize.COMMENT
    }
    bare, explained = set(), set()
    for node in sorted(inner, key=lambda node: node.lineno):
        last = node.end_lineno or node.lineno
        # One comment covers consecutive imports.
        if comments & set(range(node.lineno - 1, last + 1)) or node.lineno - 1 in explained:
            explained.add(last)
        else:
            bare.add(node.lineno)
    return sorted(bare)


def annotated_types(nodes: Nodes) -> Iterator[ast.expr]:
    """All annotations of arguments, results and variables."""
    for node, _ in nodes:
        if isinstance(node, FUNCTIONS):
            given = node.args
            every = [*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg]
            yield from (a.annotation for a in every if a is not None and a.annotation is not None)
            if node.returns is not None:
                yield node.returns
        elif isinstance(node, ast.AnnAssign):
            yield node.annotation


def has_any(annotation: ast.expr) -> bool:
    """Whether an annotation contains Any."""
    return any(isinstance(node, ast.Name) and node.id == "Any" for node in ast.walk(annotation))


def tuned_constants(tree: ast.Module) -> list[str]:
    """Names in capitals of numbers, at the level of the module."""
    found = []
    for node in tree.body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        target = node.targets[0] if isinstance(node, ast.Assign) else node.target
        if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
            pairs = list(zip(target.elts, node.value.elts, strict=False))
        else:
            pairs = [(target, node.value)]
        found += [
            name.id
            for name, value in pairs
            if isinstance(name, ast.Name) and name.id.lstrip("_").isupper() and _is_number(value)
        ]
    return found


def _is_number(node: ast.expr) -> bool:
    """Whether an expression consists only of written numbers."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float) and not isinstance(node.value, bool)
    if isinstance(node, ast.UnaryOp):
        return _is_number(node.operand)
    return isinstance(node, ast.BinOp) and _is_number(node.left) and _is_number(node.right)


def questions_of_class(tree: ast.AST) -> list[int]:
    """Lines that test the class of an engine."""
    classes = {type(engine).__name__ for engine in SHIPPED}
    found = []
    for node in ast.walk(tree):
        if not isinstance(node, ast.MatchClass | ast.Call):
            continue
        names = [part.id for part in ast.walk(node) if isinstance(part, ast.Name)]
        names += [part.attr for part in ast.walk(node) if isinstance(part, ast.Attribute)]
        if isinstance(node, ast.MatchClass):
            asks = True
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            single = node.func.id == "type" and len(node.args) == 1
            asks = single or (node.func.id == "isinstance" and names[-1] != "type")
        else:
            continue
        if asks and {*names} & {*classes, "engine", "solver", "candidate"}:
            found.append(node.lineno)
    return sorted(found)

"""Doctests: each example in a docstring runs; their number is checked, so that none is lost."""

import doctest
import functools
import importlib
import pkgutil

import pytest

import geomtorsion

OPTIONS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
# A lower number would mean that the search below misses some.
EXPECTED_EXAMPLES = 150
MODULES = sorted(
    module.name
    for module in pkgutil.walk_packages(geomtorsion.__path__, "geomtorsion.")
    if not module.name.endswith("__main__")
)


def doctests(name: str) -> list[doctest.DocTest]:
    """The docstrings of a module that contain examples."""
    module = importlib.import_module(name)
    found = doctest.DocTestFinder(exclude_empty=True).find(module)
    # The finder of the standard library knows properties, but not cached ones.
    for owner in vars(module).values():
        if isinstance(owner, type) and owner.__module__ == name:
            cached = [x for x in vars(owner).values() if isinstance(x, functools.cached_property)]
            for one in cached:
                found += doctest.DocTestFinder(exclude_empty=True).find(
                    one.func, f"{name}.{owner.__qualname__}.{one.attrname}", module
                )
    return [test for test in found if test.examples]


@pytest.mark.parametrize("name", MODULES)
def test_docstrings_are_true(name):
    """The examples in docstrings give the output that they show."""
    runner = doctest.DocTestRunner(optionflags=OPTIONS, verbose=False)
    report: list[str] = []
    for test in doctests(name):
        runner.run(test, out=report.append)
    assert not runner.failures, "".join(report)


def test_docstrings_are_found():
    """The search finds at least the expected number of examples."""
    assert sum(len(test.examples) for name in MODULES for test in doctests(name)) >= (
        EXPECTED_EXAMPLES
    )


def test_a_wrong_docstring_would_be_found():
    """The runner reports a wrong example."""
    test = doctest.DocTestParser().get_doctest(">>> 1 + 1\n3\n", {}, "wrong", None, None)
    runner = doctest.DocTestRunner(optionflags=OPTIONS, verbose=False)
    assert runner.run(test, out=lambda _: None).failed == 1

"""Claims: with --prove every result of the hard cases is proved, and its error has to hold."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import wraps
from typing import Any

import pytest

import geomtorsion as gt

# Functions that make provable results, by the names in test modules.
MAKERS = ("solve", "burgers_vector", "develop")
# Limit of a proof in seconds: a motion to t = 1e5 takes a quarter of an hour.
LONGEST = 60.0


@pytest.fixture(autouse=True)
def claims(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """With --prove results are proved when made; a result that does not hold fails the test."""
    broken: list[str] = []
    if request.config.getoption("--prove"):
        for name in MAKERS:
            made = getattr(request.module, name, None)
            if callable(made):
                monkeypatch.setattr(request.module, name, _proved(made, broken))
            if getattr(request.module, "gt", None) is gt:
                monkeypatch.setattr(gt, name, _proved(getattr(gt, name), broken))
    yield
    assert not broken, "\n".join(broken)


def _proved(make: Callable[..., Any], broken: list[str]) -> Callable[..., Any]:
    """A function with the same results, which are proved."""

    @wraps(make)
    def wrapper(*arguments: Any, **options: Any) -> Any:
        result = make(*arguments, **options)
        if isinstance(result, gt.loops.BurgersVector | gt.loops.Development | gt.ode.Solution):
            try:
                with gt.limits(seconds=LONGEST):
                    proof = gt.prove(result)
            except (gt.errors.ProofError, gt.errors.AllowanceError) as error:
                print(f"not proved: {error}")
            else:
                print(proof)
                if proof.holds is False:
                    broken.append(f"{result!r}\n{proof}")
        return result

    return wrapper

"""Rivals: the same work by other packages, each through its documented interface.

Work that a package does not offer is done on top of it in the way of its users, with the
simplifier of the package itself. None of them supports torsion, so torsion is not requested.
Packages are imported by name, so none is required to read this file.
"""

from __future__ import annotations

import builtins
from contextlib import redirect_stderr, redirect_stdout
from importlib import import_module
from io import StringIO
from itertools import product

import sympy as sp

from tests.benchmarks.cases import Case
from tests.benchmarks.outcome import Outcome, Reached


def einsteinpy(case: Case, reached: Reached) -> Outcome:
    """EinsteinPy: it has no Kretschmann scalar; change_config gives the tensors to contract."""
    package = import_module("einsteinpy.symbolic")
    metric = package.MetricTensor(case.metric.tolist(), case.coordinates)
    christoffel = package.ChristoffelSymbols.from_metric(metric)
    reached("christoffel")
    riemann = package.RiemannCurvatureTensor.from_christoffels(christoffel)
    reached("riemann")
    ricci = package.RicciTensor.from_riemann(riemann)
    package.RicciScalar.from_riccitensor(ricci)
    reached("ricci")
    down, up = riemann.change_config("llll").tensor(), riemann.change_config("uuuu").tensor()
    indices = product(range(case.dimension), repeat=4)
    scalar = sp.simplify(sum(down[i] * up[i] for i in indices))
    reached("kretschmann")
    return Outcome(scalar, tuple(sp.flatten(ricci.tensor().tolist())))


def gravipy(case: Case, reached: Reached) -> Outcome:
    """GraviPy: indices count from 1, negative ones are up; it has no Kretschmann scalar."""
    package = import_module("gravipy.tensorial")
    coordinates = package.Coordinates("q", list(case.coordinates))
    metric = package.MetricTensor("g", coordinates, sp.Matrix(case.metric))
    christoffel = package.Christoffel("Ga", metric)
    axes = range(1, case.dimension + 1)
    for a, b, c in product(axes, repeat=3):
        christoffel(-a, b, c)
    reached("christoffel")
    riemann = package.Riemann("Rm", metric)
    for i in product(axes, repeat=4):
        riemann(*i)
    reached("riemann")
    tensor = package.Ricci("Ri", metric)
    ricci = tuple(tensor(a, b) for a, b in product(axes, repeat=2))
    tensor.scalar()
    reached("ricci")
    terms = (riemann(*i) * riemann(*(-a for a in i)) for i in product(axes, repeat=4))
    scalar = sp.Add(*terms).together().simplify()
    reached("kretschmann")
    return Outcome(scalar, ricci)


def ogrepy(case: Case, reached: Reached) -> Outcome:
    """OGRePy: it simplifies each result and has a Kretschmann scalar."""
    with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
        package = import_module("OGRePy")
        coordinates = package.Coordinates(*case.coordinates)
        metric = package.Metric(coords=coordinates, components=sp.Matrix(case.metric))
        metric.christoffel()
        reached("christoffel")
        metric.riemann()
        reached("riemann")
        ricci = metric.ricci_tensor().components(indices=(-1, -1))
        metric.ricci_scalar()
        reached("ricci")
        scalar = metric.kretschmann().components(indices=())
        reached("kretschmann")
    return Outcome(_only(scalar), tuple(sp.flatten(ricci.tolist())))


def lyra_geometry(case: Case, reached: Reached) -> Outcome:
    """lyra-geometry: the constructor computes everything from Christoffel to Einstein at once."""
    package = import_module("lyra_geometry")
    space = package.SpaceTime(coords=case.coordinates, metric=sp.Matrix(case.metric))
    reached("ricci")
    scalar = space.kretschmann_scalar()
    reached("kretschmann")
    return Outcome(_only(scalar.components), tuple(sp.flatten(space.ricci.components.tolist())))


def pytearcat(case: Case, reached: Reached) -> Outcome:
    """Pytearcat: it takes a line element as text; it factors but does not simplify."""
    with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
        package = import_module("pytearcat")
        # It expects a notebook, and asks at the keyboard before a second metric in a process.
        builtins.__dict__.update(display=lambda *_: None, input=lambda *_: "yes")
        return _pytearcat(package, case, reached)


def _pytearcat(package, case: Case, reached: Reached) -> Outcome:
    package.coords(",".join(map(str, case.coordinates)))
    for function in case.metric.atoms(sp.core.function.AppliedUndef):
        package.fun(function.func.__name__, ",".join(map(str, function.args)))
    for parameter in case.metric.free_symbols - set(case.coordinates):
        package.con(str(parameter))
    line = sum(
        (case.metric[i, j] * sp.Symbol(f"d{p}") * sp.Symbol(f"d{q}"))
        for (i, p), (j, q) in product(enumerate(case.coordinates), repeat=2)
    )
    text = str(line)
    for function in case.metric.atoms(sp.core.function.AppliedUndef):
        text = text.replace(str(function), function.func.__name__)
    package.metric(f"ds2 = {text}")
    package.christoffel()
    reached("christoffel")
    riemann = package.riemann()
    reached("riemann")
    ricci = package.ricci()
    package.riccis()
    reached("ricci")
    riemann.complete("^,_,_,_")
    scalar = package.factor(riemann("_i,_j,_k,_l") * riemann("^i,^j,^k,^l"))
    reached("kretschmann")
    return Outcome(scalar, tuple(sp.flatten(ricci.tensor[0])))


def _only(value):
    """The one entry of an array without indices."""
    return sp.flatten(sp.Array(value).tolist())[0] if sp.Array(value).shape else value[()]

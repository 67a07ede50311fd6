"""Solving: from field equations to numbers with errors."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from geomtorsion.errors import ArgumentError, GravityError
from geomtorsion.gravity.motion.composition import Composition
from geomtorsion.gravity.reduced.beginning import Start
from geomtorsion.gravity.reduced.reduction import Reduction
from geomtorsion.gravity.theory.field_equations import FieldEquations
from geomtorsion.gravity.theory.fluids import Fluid
from geomtorsion.ode import At, Engine, Solution, When
from geomtorsion.ode import solve as solve_ode
from geomtorsion.support import checks


def solve(
    equations: FieldEquations | Reduction,
    variable: object,
    last: object,
    start: Mapping[str, object],
    parameters: Mapping[str, object] | None = None,
    *,
    conditions: object = (),
    near: Mapping[str, object] | None = None,
    origin: object = 0,
    outputs: Mapping[str, object] | None = None,
    events: Iterable[At | When] = (),
    accuracy: float = 1e-10,
    engine: Engine | None = None,
) -> Solution:
    """Solve field equations for unknown functions of one variable.

    Parameters
    ----------
    equations
        field equations, or the result of `FieldEquations.reduce`.
    variable
        the coordinate on which the functions depend.
    last
        its last value, or increasing values from the origin on.
    start
        state -> number; omitted states follow from the constraints. The order matters only for
        `gt.called_for`: a theory without some terms may need fewer numbers, and takes the first
        ones.
    parameters
        name -> number.
    conditions
        further equations: "p = rho/3", "N = 1".
    near
        state -> rough number, where a constraint has several solutions.
    origin
        value of the variable at the start.
    outputs, events, accuracy, engine
        as for `gt.ODE.of` and `gt.solve`.

    Returns
    -------
    Solution: states, outputs and their errors; `drift` of the constraints. With an origin its times
    count from there, and the variable is an output. Each term of the Lagrangian and each fluid is
    an effect for `gt.called_for`, unless the equations were reduced before.

    Raises
    ------
    GravityError, StartError
        the equations do not determine the functions, or the start does not fit them.

    Examples
    --------
    >>> import sympy as sp
    >>> import geomtorsion as gt
    >>> t, x, y, z = sp.symbols("t x y z")
    >>> a = sp.Function("a")(t)
    >>> cosmos = gt.Frame([t, x, y, z], sp.diag(1, a, a, a), (-1, 1, 1, 1))
    >>> vacuum = gt.gravity.equations(gt.levi_civita(cosmos), "R - 2*Lambda")
    >>> solution = gt.gravity.solve(vacuum, "t", 1, {"a": 1}, {"Lambda": 3}, near={"a_1": 1})
    >>> round(float(solution["a"][-1]), 9)
    2.718281828
    """
    equations = checked_theory(equations)
    begin, outputs = Start.of(start, parameters, near, origin), outputs or {}
    if isinstance(equations, Reduction):
        checks.known_name(variable, [equations.variable], "variable", GravityError)
        beginning = equations.beginning(begin)
        ode = equations.ode_of(beginning, outputs, events)
    else:
        name = checks.known_name(
            variable, [x.name for x in equations.frame.coordinates], "variable", GravityError
        )
        if any(isinstance(x, Fluid) and x.matter is not None for x in equations.matter):
            raise GravityError(
                "solve: expected a fluid with one density and one pressure, got an equation of "
                "state, which may have several pieces. Give the equations to gravity.star."
            )
        theory = Composition(equations, name, begin, conditions, outputs, tuple(events))
        beginning, ode = theory.beginning, theory.ode
    place, _ = beginning.first
    times = last if place == 0 else np.asarray(last, dtype=float) - float(place)
    return solve_ode(ode, times, accuracy, engine)


def checked_theory(value: object, subject: str = "equations") -> FieldEquations | Reduction:
    """Field equations, or what `reduce` made of them.

    Examples
    --------
    >>> checked_theory("R/2")
    Traceback (most recent call last):
    geomtorsion.errors.ArgumentError: equations: expected field equations or their reduction, got \
'R/2'. Give gravity.equations(connection, lagrangian).
    """
    if isinstance(value, FieldEquations | Reduction):
        return value
    expected = "field equations or their reduction"
    remedy = "Give gravity.equations(connection, lagrangian)."
    checks.refuse(ArgumentError, subject, expected, value, remedy)

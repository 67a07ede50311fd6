"""Values for parameters and functions, limits and series of tensors: exact, in any order."""

from __future__ import annotations

import math
import pickle

import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import (
    ArgumentError,
    CoordinateError,
    ExpressionError,
    GeomtorsionError,
    SingularPointError,
    UnknownNameError,
)

r, phi, k = sp.symbols("r phi k", positive=True)
t = sp.Symbol("t", real=True)
PARAMETRIC = [name for name in gt.spaces.names() if gt.spaces.load(name).frame.parameters]


@pytest.fixture(scope="module")
def cone() -> gt.Frame:
    """A cone: the circle at r has k times its length in the plane."""
    return gt.Frame([r, phi], [[1, 0], [0, k * r]])


@pytest.fixture(scope="module")
def kerr() -> gt.Frame:
    """Carter's tetrad."""
    return gt.spaces.load("kerr").frame


def test_kerr_without_rotation_is_schwarzschild(kerr):
    """Kerr with a = 0 has the same quantities as the shipped Schwarzschild space."""
    still, other = kerr.subs({"a": 0}), gt.spaces.load("schwarzschild").frame
    assert still.parameters == (sp.Symbol("M", positive=True),)
    for name in ("metric", "anholonomy", "christoffel", "riemann"):
        one = {i: sp.simplify(v) for i, v in still.quantity(name).nonzero().items()}
        two = {i: sp.simplify(v) for i, v in other.quantity(name).nonzero().items()}
        assert one.keys() == two.keys()
        names = dict(zip(other.coordinates, still.coordinates, strict=True))
        assert all(sp.simplify(one[i] - two[i].xreplace(names)) == 0 for i in one), name


@pytest.mark.parametrize("name", PARAMETRIC)
def test_values_may_come_first_or_last(name):
    """A value may be put into the frame first, or into torsion and curvature afterwards."""
    frame = gt.spaces.load(name).frame
    values = {frame.parameters[0]: sp.Rational(1, 10)}
    here = frame.subs(values)
    assert gt.cartan(frame).torsion.S.subs(values) == gt.cartan(here).torsion.S
    bar = gt.levi_civita(frame).curvature
    assert bar.ricci.subs(values) == gt.levi_civita(here).curvature.ricci
    assert bar.subs(values).ricci == gt.levi_civita(here).curvature.ricci
    assert frame.parameters[0] not in here.parameters


def test_equal_values_give_the_same_frame(cone):
    """Tensors with equal values can be added; a copy of the frame gives equal tensors."""
    one, two = cone.metric.subs({k: 2}), cone.metric.subs({"k": "2"})
    assert one.frame is two.frame is cone.subs({k: sp.Integer(2)})
    assert (one + two)[1, 1] == 8 * r**2
    assert pickle.loads(pickle.dumps(cone)).subs({k: 2}).metric[1, 1] == 4 * r**2


def test_all_at_once():
    """Substitution is simultaneous: a value may contain the other parameter."""
    a, b = sp.symbols("a b", positive=True)
    frame = gt.Frame([r, phi], [[a, 0], [0, b * r]])
    swapped = frame.subs({a: b, b: a})
    assert (swapped.coframe[0, 0], swapped.coframe[1, 1]) == (b, a * r)
    new = sp.Symbol("c", positive=True)
    assert frame.subs({a: new / b}).parameters == (b, new)


def test_unknown_functions_all_at_once():
    """Substitution of functions is simultaneous, also if one is in the argument of the other."""
    f, g = sp.Function("f"), sp.Function("g")
    frame = gt.Frame([t, phi], [[f(t), 0], [0, g(t) * f(g(t))]])
    swapped = frame.subs({f(t): g(t), g(t): f(t)})
    assert (swapped.coframe[0, 0], swapped.coframe[1, 1]) == (g(t), f(t) * g(f(t)))
    other = frame.subs({f(t): 1 + g(t) ** 2, g(t): 3 * t})
    assert other.coframe[0, 0] == 1 + g(t) ** 2
    assert swapped.metric.subs({f(t): sp.exp(t), g(t): f(t)})[0, 0] == f(t) ** 2


def test_names_mean_one_thing_in_functions_too():
    """A symbol phi without assumptions is the coordinate phi, on which a(t) cannot depend."""
    a, twin = sp.Function("a"), sp.Symbol("phi")
    frame = gt.Frame([t, phi], [[1, 0], [0, a(t)]])
    with pytest.raises(
        CoordinateError,
        match="a\\(t\\): expected a function of its own arguments, .* also depends on phi",
    ):
        frame.subs({a(t): twin * t})
    plain = sp.Symbol("t")
    for key, value in ((plain, t), (t, plain), (plain, plain)):
        assert frame.subs({a(key): value**2}).coframe[1, 1] == t**2


def test_unknown_functions_become_known():
    """a(t) = exp(H t) gives de Sitter space, R = 12 H^2; dust agrees with Einstein's equation."""
    universe = gt.spaces.load("frw_flat").frame
    time = universe.coordinates[0]
    growth, H = sp.Function("a"), sp.Symbol("H", positive=True)
    values = {growth(time): sp.exp(H * time)}
    assert gt.levi_civita(universe.subs(values)).curvature.scalar == 12 * H**2
    assert gt.levi_civita(universe).curvature.scalar.subs(values) == 12 * H**2
    dust = universe.subs({"a(t)": "t^(2/3)"})
    assert dust.quantity("einstein")[0, 0] == 4 / (3 * time**2)
    assert not dust.quantity("einstein").in_frame()[1, 1]


def test_every_kind_of_frame_and_connection():
    """Frames from legs or a metric, complex frames, branches and any connection."""
    legs = gt.Frame.from_frame([r, phi], [[1, 0], [0, 1 / (k * r)]], signature=(-1, 1))
    assert legs.subs({k: 2}).coframe[1, 1] == 2 * r
    assert legs.subs({k: 2}).eta[0, 0] == -1
    metric = gt.Frame.from_metric([r, phi], [[1, 0], [0, k**2 * r**2]])
    assert metric.subs({k: 2}).coframe[1, 1] == 2 * r
    null = gt.spaces.load("kerr_kinnersley").frame.subs({"a": 0})
    assert null.complex
    assert null.quantity("ricci").is_zero
    x = sp.Symbol("x")
    branched = gt.Frame([x, phi], [[1, 0], [0, k * sp.sqrt(x**2)]], branches={sp.sqrt(x**2): -x})
    assert branched.subs({k: 2}).coframe[1, 1] == -2 * x
    cone = gt.Frame([r, phi], [[1, 0], [0, k * r]])
    half = gt.blend(gt.cartan(cone), gt.levi_civita(cone), sp.Symbol("s", positive=True))
    there = half.subs({"s": 1, "k": 3})
    other = gt.levi_civita(cone.subs({k: 3}))
    assert there.coefficients.nonzero() == other.coefficients.nonzero()
    assert there.name == half.name


def test_a_root_that_becomes_a_square_is_reported():
    """A root that becomes a square is read on a branch that the new frame states."""
    frame = gt.Frame([t, phi], [[1, 0], [0, sp.sqrt(t**2 + k)]])
    found = frame.subs({k: 0})
    assert found.coframe[1, 1] == t
    assert [branch.condition for branch in found.branches] == ["t >= 0"]


@pytest.mark.parametrize(
    ("values", "error", "message"),
    [
        ({"r": 1}, CoordinateError, "got the coordinate r. .* tensor.limit"),
        ({sp.Symbol("q"): 1}, UnknownNameError, "expected a parameter, got 'q'. There are k"),
        ({"q": 1}, UnknownNameError, "expected a parameter, got 'q'. There are k"),
        ({"K": 1}, UnknownNameError, "got 'K'. Did you mean k"),
        ({"k": "r"}, CoordinateError, "expected a value without coordinates .*, got r,"),
        ({"k": -1}, CoordinateError, "k: expected a value that is positive, .*got -1"),
        ({"k": sp.I}, CoordinateError, "k: expected a value that is positive"),
        ({"k": math.inf}, ArgumentError, "expected a finite value, got oo"),
        ({"k": "__import__('os')"}, GeomtorsionError, "expressions are not code"),
        ({"k + 1": 2}, ArgumentError, "a parameter or an unknown function"),
        ({"b(r)": 2}, UnknownNameError, "expected an unknown function of this tensor, got 'b'"),
        ({"k": None}, ArgumentError, "None"),
        ({"k": 0.5}, ExpressionError, "^the value of 'k': 0.5.* exactly, for example 1/2$"),
        ([("k", 1, 2)], GeomtorsionError, "values"),
        (["k"], GeomtorsionError, "values"),
        ({"k": 0}, gt.errors.CoframeError, "singular"),
    ],
)  # fmt: skip
def test_invalid_values_are_refused(cone, values, error, message):
    """Each bad value is named, and the error states the remedy."""
    with pytest.raises(error, match=message):
        cone.subs(values)


def test_values_out_of_the_domain():
    """The domain also holds for parameters; the error at a singular entry advises a limit."""
    frame = gt.Frame([r, phi], [[1, 0], [0, r / k]], domain=[k < 3, r > 0])
    with pytest.raises(CoordinateError, match="got values that violate k < 3"):
        frame.subs({k: 4})
    assert frame.subs({k: 2}).domain == ()
    with pytest.raises(SingularPointError, match=r"coframe\[1, 1\] = r/k .* compute a limit"):
        frame.subs({k: 0})
    universe = gt.spaces.load("frw_flat").frame
    with pytest.raises(
        CoordinateError, match="expected a function of its own arguments, .* also depends on x"
    ):
        universe.subs({"a(t)": "x"})


def test_far_away_kerr_is_flat(kerr):
    """Kerr with M = 0 is flat; 1/r to first order contains the mass and angular momentum."""
    flat = kerr.metric.limit("M", 0)
    empty = gt.Frame.from_metric(kerr.coordinates, flat.to_sympy().tolist())
    assert empty.quantity("riemann").is_zero
    far = kerr.metric.series("r", sp.oo, 1)
    mass, spin = sp.symbols("M a", positive=True)
    _, radius, theta, _ = kerr.coordinates
    assert far[0, 0] == 2 * mass / radius - 1
    # Lense and Thirring: the angular momentum is M a.
    assert sp.simplify(far[0, 3] + 2 * mass * spin * sp.sin(theta) ** 2 / radius) == 0
    assert gt.levi_civita(kerr).curvature.kretschmann.limit("r", "oo") == 0


def test_series_are_written_in_powers(kerr):
    """A series is written in powers, and the remainder is of higher order."""
    slow = kerr.metric.series("a", 0, 1)
    spin = sp.Symbol("a", positive=True)
    assert {index for index, value in slow.nonzero().items() if value.has(spin)} == {(0, 3), (3, 0)}
    assert (kerr.metric - slow).limit("a", 0).is_zero
    assert ((kerr.metric - slow) / spin).limit("a", 0).is_zero
    assert not ((kerr.metric - slow) / spin**2).limit("a", 0).is_zero
    assert str(kerr.metric.series("a", 0, 2)[2, 2]) == "a**2*cos(theta)**2 + r**2"


def test_sides_follow_from_the_domain(kerr):
    """theta > 0 and M > 0 leave only one side; a limit from outside the domain is refused."""
    assert kerr.coframe.limit("theta", 0)[3, 3] == 0
    assert kerr.coframe.limit("theta", "pi", "-")[3, 3] == 0
    with pytest.raises(CoordinateError, match="leads out of the domain"):
        kerr.coframe.limit("theta", 0, "-")
    with pytest.raises(CoordinateError, match="leads out of the domain"):
        kerr.coframe.limit("r", -1)
    with pytest.raises(CoordinateError, match="leads out of the domain"):
        kerr.coframe.limit("phi", sp.oo)
    step = gt.Frame([t, phi], [[1, 0], [0, 1 + 1 / (1 + sp.exp(-1 / t))]])
    with pytest.raises(SingularPointError, match=r"e\[1, 1\] = .* has two limits: 2 as .*, 1 as"):
        _ = step.coframe.limit("t", 0)[1, 1]
    assert step.coframe.limit("t", 0, "-")[1, 1] == 1


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (("q", 0), GeomtorsionError, "q"),
        ((sp.Symbol("q"), 0), UnknownNameError, "expected a coordinate or a parameter, got 'q'"),
        (("r", "r"), ArgumentError, "an expression without r"),
        (("r", sp.nan), GeomtorsionError, "nan"),
        (("r", sp.zoo), ArgumentError, "zoo"),
        (("r", [0]), ArgumentError, "point"),
        (("r", 0.5), ExpressionError, "^point: 0.5.* write it exactly, for example 1/2$"),
        (("r", 1, "both"), ArgumentError, "from above"),
        (("r", 1, 1), ArgumentError, "from above"),
        ((2, 1), ArgumentError, "expected a coordinate or a parameter"),
        (("r", "__import__('os')"), GeomtorsionError, "expressions are not code"),
    ],
)  # fmt: skip
def test_invalid_points_are_refused(cone, arguments, error, message):
    """Each bad argument of limit is named in the error."""
    with pytest.raises(error, match=message):
        _ = cone.metric.limit(*arguments)[1, 1]


def test_invalid_orders_are_refused(cone):
    """The order of a series must be a whole number from 0 up."""
    for order in (-1, 1.5, "2", True, None):
        with pytest.raises(ArgumentError, match="order: expected a whole number"):
            cone.metric.series("r", 1, order)


def test_infinite_points_by_any_name(cone):
    """Infinity may be given by sympy, as a float or as text."""
    falling = cone.inverse_metric
    for far in (sp.oo, math.inf, "oo"):
        assert falling.limit(r, far)[1, 1] == 0


@pytest.mark.parametrize("text", ["2*a", "a + b**2"])
def test_new_names_in_text_become_parameters(text):
    """Text names new parameters as sympy's own expressions do."""
    sphere, names = gt.spaces.load("s2").frame, sp.symbols("a b")
    value = sp.sympify(text, dict(zip("ab", names, strict=True)))
    scaled = sphere.subs({"R": text})
    assert scaled == sphere.subs({"R": value})
    assert set(scaled.parameters) == value.free_symbols
    assert scaled.metric["theta", "theta"] == value**2


def test_new_names_in_the_value_of_a_function():
    """A flat universe that expands exponentially has the curvature scalar 12 H^2."""
    universe = gt.Frame("t x y z", [[1, 0, 0, 0], *([0] * k + ["a(t)"] + [0] * (3 - k)
                        for k in (1, 2, 3))], (-1, 1, 1, 1))  # fmt: skip
    rate = sp.Symbol("H")
    assert gt.levi_civita(universe.subs({"a": "exp(H*t)"})).curvature.scalar[0] == 12 * rate**2

"""Objects behave as their neighbours in NumPy and SymPy do: equality, truth, indices, arrays."""

import copy
import pickle
from typing import Any

import numpy as np
import pandas
import pytest
import sympy as sp

import geomtorsion as gt
from geomtorsion.errors import (
    LoopError,
    MissingValueError,
    ShapeError,
    TensorIndexError,
    UndecidedError,
)
from geomtorsion.spaces import load
from geomtorsion.support.field_names import LIKE

r, theta, phi, k = sp.symbols("r theta phi k", positive=True)
SPHERICAL = [[1, 0, 0], [0, r, 0], [0, 0, r * sp.sin(theta)]]


def spherical(**options: Any) -> gt.Frame:
    """A frame as a notebook makes it each time its cell is run."""
    return gt.Frame([r, theta, phi], SPHERICAL, **options)


F, G = spherical(), spherical(name="the same again")
S = gt.cartan(F).torsion.S
Z = S - S
NINTH = gt.Frame("x y", [[sp.Rational(1, 9), 0], [0, 1]])
LOOP = gt.Loop.circle([0.3, 1.0, 0.2], 0.1)


def burgers() -> gt.loops.BurgersVector:
    """A Burgers vector, computed over a frame of its own."""
    return gt.burgers_vector(load("so3").frame, LOOP)


b = burgers()
motion = gt.solve(gt.geodesic(load("s2").frame, [1.0, 0.0], [0.0, 1.0], parameters={"R": 1}), 1.0)

# -- equality by content --------------------------------------------------------------------------

# Of each kind of frame: with null legs, unknown functions, own charts, roots, large components.
NAMES = ("so3", "s3", "flat_polar", "kerr", "kerr_kinnersley", "frw", "screw_dislocation")


def series(name: str) -> gt.Frame:
    """A frame expanded in a parameter."""
    return load(name).frame.expanded("M", 2)


MAKERS = {
    **{name: lambda name=name: load(name).frame for name in NAMES},
    "connection": lambda: gt.cartan(load("s3").frame),
    "blend": lambda: gt.blend(gt.cartan(F), gt.levi_civita(spherical()), k),
    "constrained": lambda: load("chaplygin_sleigh").connection,
    "series": lambda: series("schwarzschild"),
    "torsion": lambda: gt.cartan(load("s3").frame).torsion,
    "tensor": lambda: gt.levi_civita(load("kerr").frame).coefficients,
    "form": lambda: load("so3").frame.coframe_form(1),
    "space": lambda: load("so3"),
    "loop": lambda: gt.Loop.parametric(["cos(s)", "sin(2*s)/2"], interval=(0, "2*pi")),
    "geodesic": lambda: gt.geodesic(load("so3").frame, [0.3, 1.0, 0.2], [0.1, 0.2, 0.3]),
    "autoparallel": lambda: gt.autoparallel(
        gt.blend(gt.cartan(F), gt.levi_civita(F), k), [1, 1, 1], [0, 0.1, 0], parameters={"k": 0.3}
    ),
    "equations": lambda: gt.ODE.of({"x": "v", "v": "-k*x"}, [1, 0], parameters={"k": 4}),
    "Burgers vector": burgers,
    "sum of Burgers vectors": lambda: 2 * burgers() + burgers(),
}


@pytest.mark.parametrize("name", MAKERS)
def test_values_made_twice_are_equal(name: str) -> None:
    """A value made again, copied or unpickled is equal and has the same hash."""
    value = MAKERS[name]()
    again = (
        MAKERS[name](),
        copy.copy(value),
        copy.deepcopy(value),
        pickle.loads(pickle.dumps(value)),
    )
    for other in again:
        assert other == value
        assert hash(other) == hash(value)
    assert len({value, *again}) == 1


def test_different_things_are_unequal() -> None:
    """No two values of the table are equal, and none equals a value of another type."""
    values = [make() for make in MAKERS.values()]
    assert len(set(values)) == len(values)
    assert all(value != other for value in values for other in (None, "so3", object(), 1))


DIFFERENT = {
    "coframe": gt.Frame([r, theta, phi], sp.diag(1, r, 2 * r * sp.sin(theta))),
    "order of coordinates": gt.Frame([r, phi, theta], SPHERICAL),
    "signature": spherical(signature=(-1, 1, 1)),
    "domain": spherical(domain=theta < 3),
    "parameters": spherical(parameters=[k]),
    "complex": spherical(complex=True),
    "eta": spherical(signature=sp.diag(2, 1, 1)),
}


@pytest.mark.parametrize("name", DIFFERENT)
def test_frames_with_other_content_are_unequal(name: str) -> None:
    """Each part of the content of a frame counts, and tensors of unequal frames do not combine."""
    other = DIFFERENT[name]
    assert other != F
    assert other.metric != F.metric
    with pytest.raises(TensorIndexError, match="expected a tensor over this frame"):
        _ = other.metric + F.metric


def test_frames_are_equal_in_whatever_way_they_are_made() -> None:
    """Frames from legs, from a metric and from other expressions equal the frame of the coframe."""
    half = sp.sin(theta / 2) * sp.cos(theta / 2) * 2 * r
    ways = [
        gt.Frame([r, theta, phi], sp.diag(1, r, half)),
        gt.Frame.from_frame([r, theta, phi], sp.diag(1, 1 / r, 1 / (r * sp.sin(theta)))),
        F.named(rho="r*sin(theta)"),
        G,
    ]
    assert all(way == F and hash(way) == hash(F) for way in ways)
    x, y = sp.symbols("x y", positive=True)
    assert gt.Frame.from_metric([x, y], [[1, 0], [0, x**2]]) == gt.Frame([x, y], [[1, 0], [0, x]])
    assert gt.Frame([x, y], [[1, 0], [0, -x]]) != gt.Frame([x, y], [[1, 0], [0, x]])


@pytest.mark.parametrize("name", NAMES)
def test_tensors_of_equal_frames_combine(name: str) -> None:
    """Sums, products, forms and connections over two equal frames are those over one frame."""
    one, two = load(name).frame, load(name).frame
    # The two fields have grown in different ways.
    _ = gt.levi_civita(two).coefficients.nonzero(), one.volume[()]
    cartan, other = gt.cartan(one), gt.cartan(two)
    assert (one.metric - two.metric).is_zero
    assert (one.volume * two.metric) == one.volume * one.metric
    assert one.coframe_form(0) + two.coframe_form(0) == 2 * one.coframe_form(0)
    summed = gt.contract("abc,cd->abd", cartan.torsion.T, two.metric)
    assert summed.frame is one
    assert summed == other.torsion.T.lowered(2)
    assert cartan.covariant_derivative(two.coframe).is_zero
    assert one.coframe_form().D(other) == cartan.torsion_form()
    assert gt.blend(cartan, other) == cartan
    along = [1] + [0] * (one.dimension - 1)
    assert gt.lie(two.vector(along), one.metric) == gt.lie(one.vector(along), one.metric)


def test_other_values_and_the_legs_differ() -> None:
    """A frame with one other leg keeps its own tensors: nothing of an equal frame leaks over."""
    one, two = load("kerr").frame, load("kerr").frame
    slopes = one.in_coordinates(["t", "u", "theta", "phi"], {"r": "1/u"})
    again = two.in_coordinates(["t", "u", "theta", "phi"], {"r": "1/u"})
    assert slopes == again
    assert slopes.metric.element(0, 0).field is not again.metric.element(0, 0).field
    assert one.metric.in_coordinates(["t", "u", "theta", "phi"], {"r": "1/u"}).frame is slopes


# -- lines as a user types them -------------------------------------------------------------------

TRUE = [
    "Z == 0", "0 == Z", "Z == 0.0", "not (S == 0)", "S != 0", "hash(Z) == hash(0)",
    "F.metric == sp.diag(1, r**2, r**2*sp.sin(theta)**2)",
    "sp.diag(1, r**2, r**2*sp.sin(theta)**2) == F.metric",
    "F.metric == sp.diag(1, r**2, r**2 - r**2*sp.cos(theta)**2)",
    "F.metric == F.metric.to_sympy()", "F.metric == np.asarray(F.metric)",
    "F.metric == [[1, 0, 0], [0, r**2, 0], [0, 0, r**2*sp.sin(theta)**2]]",
    "F.metric != sp.eye(3)", "F.metric != sp.eye(2)", "F.metric != [[1], [2, 3]]",
    "F.metric != 'metric'", "F.metric != None", "F.metric.__eq__(object()) is NotImplemented",
    "F.metric != r", "r != F.metric", "S not in [r, 0]", "bool(F.scalar(r))",
    "not F.scalar(sp.sin(r)**2 + sp.cos(r)**2 - 1)",
    "F.coframe_form(0) - F.coframe_form(0) == 0", "F.coframe_form(0) != 0",
    "F.coframe_form(0) != 'dr'", "gt.Form(F, 0, {(): r}) == r",
    # indices
    "S['r', 'theta', 'theta'] == 1/(2*r)", "S[r, theta, theta] == 1/(2*r)",
    "S[-3, 1, -2] == S[0, 1, 1]", "S[:, 1, 1].tolist() == [1/(2*r), 0, 0]",
    "S[0].tolist() == S.to_sympy()[0].tolist()", "S[..., 1].tolist() == S[:, :, 1].tolist()",
    "S[1:, 0, 1].tolist() == [-1/(2*r), 0]", "S[::-1, 0, 1].tolist() == [0, -1/(2*r), 0]",
    "S[...] == S.to_sympy()", "F.coframe[2, 'phi'] == r*sp.sin(theta)",
    "gt.cartan(F)['r', 1, 1] == 1/r", "gt.cartan(F)[0].shape == (3, 3)",
    "len(S) == len(list(S)) == 3", "[row[0] for row in F.metric] == [1, 0, 0]",
    "S.ndim == 3 and S.shape == (3, 3, 3)", "list(F.vector([r, 0, 1])) == [r, 0, 1]",
    # arrays
    "np.asarray(S).dtype == object", "np.asarray(S)[0, 1, 1] == 1/(2*r)",
    "np.asarray(F.eta).dtype == float", "np.allclose(F.eta, np.eye(3))",
    "np.asarray(gt.cartan(F)).shape == (3, 3, 3)", "np.int64(2)*F.metric == 2*F.metric",
    "np.asarray(F.scalar(3)) == 3.0", "np.asarray(F.eta, dtype=int).dtype == int",
    # verbs of sympy
    "sp.Matrix(NINTH.metric)[0, 0] == sp.Rational(1, 81)",
    "sp.Matrix(NINTH.vector([sp.Rational(1, 3), 1]))[0].is_Rational",
    "sp.Array(NINTH.metric)[0, 0].is_Rational", "type(np.asarray(NINTH.metric)) is np.ndarray",
    "np.allclose(np.linalg.inv(NINTH.metric), np.diag([81, 1]))",
    "sp.Matrix(F.metric).det() == F.metric.det()[()]", "F.metric.inv() == F.inverse_metric",
    "F.coframe.inv() == F.legs and F.coframe.inv().slots == 'uD'",
    "F.metric.diff(r).nonzero()[1, 1] == 2*r", "F.metric.diff('r', 'r')[1, 1] == 2",
    "F.metric.free_symbols == {r, theta}", "F.metric.tolist() == F.metric.to_sympy().tolist()",
    "F.metric.simplify() == F.metric", "sp.simplify(F.metric) == F.metric.to_sympy()",
    "NINTH.metric.evalf(3)[0, 0] == sp.Rational(1, 81).evalf(3)",
    "sp.lambdify([r, theta], F.metric)(2.0, 0.0)[1, 1] == 4",
    "r * F.metric.element(1, 1) + 1 == r**3 + 1", "sp.sympify(F.metric.element(1, 1)) == r**2",
    # solutions
    "'theta' in motion", "'x' not in motion", "'theta' in list(motion)",
    "list(motion) == list(motion.keys())", "dict(motion)['phi'][0] == 0",
    "len(motion) == len(list(motion))", "list(motion.items())[0][0] == list(motion)[0]",
    "np.array(motion).shape == motion.to_pandas().shape", "bool(motion)",
    "np.array_equal(np.array(motion), motion.to_pandas().to_numpy())",
    "gt.solve(motion.problem, '0.05 min')['theta'][-1] == gt.solve(motion.problem, 3)['theta'][-1]",
    # what a frame gives
    "F.conformal(r).metric[0, 0] == r**2 and F.conformal('1/r').metric[1, 1] == 1",
    "F.conformal(1) == F",
    # Burgers vectors and loops
    "f'{b:.3f}' == '[' + ', '.join(f'{x:.3f}' for x in b.vector) + ']'", "f'{b}' == str(b)",
    "np.allclose(b, b.vector)", "np.asarray(b).shape == (3,)", "len(b) == 3",
    "b[0] == b.vector[0]", "list(b) == b.vector.tolist()", "abs(b) == b.magnitude",
    "np.allclose(-b, -b.vector)", "(-b).loop == -b.loop", "-(-b) == b", "-(-LOOP) == LOOP",
    "-LOOP != LOOP", "-LOOP == LOOP.reversed()", "np.allclose(2*b, 2*b.vector)",
    "np.float64(2)*b == b*2", "np.allclose(b/2, b.vector/2)", "np.allclose(b + b, 2*b)",
    "2*b.error <= (b + b).error <= 2*b.error + 1e-15*abs(b)", "(-3*b).error >= 3*b.error",
    "np.allclose(sum([b, b, b]), 3*b)", "(b - b).vanishes", "(b - b.vector).vanishes",
    "np.allclose(b.vector - b, 0)", "np.allclose(np.abs(b), np.abs(b.vector))",
    "np.linalg.norm(b) > 0", "b != b.vector.tolist()", "b != 0.5",
]  # fmt: skip


@pytest.mark.parametrize("line", TRUE)
def test_a_line_is_true(line: str) -> None:
    """Each line holds."""
    assert eval(line)  # noqa: S307  # a line of this file


TINY = gt.burgers_vector(load("so3").frame, gt.Loop.circle([0.3, 1.0, 0.2], 1e-170))
OTHER = gt.burgers_vector(load("so3_right").frame, LOOP)

REFUSED = [
    ("bool(S)", TensorIndexError, "truth value of S_{ab}^{c}"),
    ("bool(F.coframe_form(0))", TensorIndexError, "is ambiguous"),
    ("if_(S)", TensorIndexError, "is ambiguous"),
    ("S[3]", TensorIndexError, "whole number from -3 to 2, a coordinate (r, theta, phi)"),
    ("S[-4, 0, 0]", TensorIndexError, "whole number from -3 to 2"),
    ("S[0, 0, 0, 0]", TensorIndexError, "up to 3 indices"),
    ("S['x', 0, 0]", TensorIndexError, "'x'"),
    ("S[np.array([0, 1]), 0]", TensorIndexError, "expected up to 3 indices"),
    ("S[1.0, 0, 0]", TensorIndexError, "1.0"),
    ("S[True, 0, 0]", TensorIndexError, "True"),
    ("S['r':]", TensorIndexError, "or a slice"),
    ("S[::0]", TensorIndexError, "or a slice"),
    ("S[..., ...]", TensorIndexError, "..., ..."),
    ("F.coframe['r', 'r']", TensorIndexError, "Indices of legs are numbers"),
    ("F.scalar(1)[1]", TensorIndexError, "only index"),
    ("len(F.scalar(1))", TensorIndexError, "has no length"),
    ("list(F.scalar(1))", TensorIndexError, "to iterate over"),
    ("np.asarray(S, dtype=float)", MissingValueError, "expressions in r, theta"),
    ("b + OTHER", LoopError, "expected vectors of one frame"),
    ("b / 0", ZeroDivisionError, "not zero"),
    ("b + 1", TypeError, "unsupported operand"),
    ("b * b", TypeError, "unsupported operand"),
    ("b + 'b'", TypeError, "unsupported operand"),
    ("b * float('nan')", TypeError, "unsupported operand"),
    (
        "gt.contract('ab,bc->ac', F.metric, DIFFERENT['eta'].inverse_metric)",
        ShapeError,
        "this frame",
    ),
]


def if_(value: object) -> str:
    """What a user writes as `if value:`."""
    return "yes" if value else "no"


@pytest.mark.parametrize(("line", "error", "words"), REFUSED)
def test_a_line_is_refused(line: str, error: type[Exception], words: str) -> None:
    """Each line is refused with the error of its kind and words that help."""
    with pytest.raises(error) as caught:
        eval(line)  # noqa: S307  # a line of this file
    assert words in str(caught.value)


def test_an_undecided_zero_is_refused() -> None:
    """Whether something equals 0 raises where no known relation decides it."""
    third = sp.Rational(1, 3)
    # It vanishes, which no known relation proves.
    airy = sp.airyai(r) - sp.sqrt(r / 3) / sp.pi * sp.besselk(third, 2 * r ** (9 * third / 2) / 3)
    frame = gt.Frame([r, theta], [[1, airy * theta], [0, 1]])
    for value in (gt.cartan(frame).torsion.S, gt.cartan(frame).torsion_form(0)):
        assert value.is_zero is None
        with pytest.raises(UndecidedError, match="cannot be decided"):
            _ = value == 0


def test_a_tiny_vector_keeps_its_digits() -> None:
    """Multiples and sums of a vector below all doubles do not underflow."""
    assert float((2 * TINY).numbers[0] / TINY.numbers[0]) == pytest.approx(2)
    assert float((TINY + TINY).numbers[0] / TINY.numbers[0]) == pytest.approx(2)
    assert np.allclose(b + TINY, b)


def test_a_reversed_loop_has_the_opposite_vector() -> None:
    """-b is the Burgers vector of -loop, which is computed on its own."""
    opposite = gt.burgers_vector(load("so3").frame, -LOOP)
    assert np.abs(opposite + b).max() <= opposite.error + b.error
    assert (b + opposite).vanishes


@pytest.mark.parametrize("name", ["Christoffel", "ricci", "tetrad", "killing", "spin_connection"])
def test_names_of_the_field_are_answered_with_ours(name):
    """A name of the field that the package does not have is answered with the line to type."""
    with pytest.raises(AttributeError, match=r"Did you mean gt\.") as error:
        getattr(gt, name)
    line = str(error.value).partition("Did you mean ")[2].removesuffix("?")
    head = line.partition("(")[0].removeprefix("gt.").split(".")
    found = gt
    for part in head:
        found = getattr(found, part)
    assert callable(found)


def test_lines_for_names_of_the_field_run():
    """Each line that needs a frame only gives a result."""
    frame = load("s2").frame
    names = {
        "gt": gt,
        "frame": frame,
        "name": "s2",
        "connection": gt.cartan(frame),
        "tensor": frame.metric,
    }
    lines = [line for line in LIKE.values() if "," not in line and " or " not in line]
    lines.remove("result.plot()")
    assert len(lines) > 15
    for line in lines:
        assert eval(line, names) is not None, line  # noqa: S307


@pytest.mark.parametrize("module", [gt.errors, gt.conventions, gt.effects])
def test_listings_show_public_names(module):
    """`dir` shows no names that a module imports."""
    assert not {"Any", "Sequence", "checks", "annotations"} & {*dir(module)}
    assert all(hasattr(module, name) for name in dir(module))


def test_solutions_as_csv(tmp_path):
    """`save` to a name that ends in .csv writes the table, whose numbers are the same doubles."""
    motion.save(tmp_path / "a.csv")
    table = pandas.read_csv(tmp_path / "a.csv")
    assert np.array_equal(table.to_numpy(), np.array(motion))
    assert list(table) == list(motion.to_pandas())
    assert not list(tmp_path.glob("*.npz"))

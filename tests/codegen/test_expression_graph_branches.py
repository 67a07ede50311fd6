"""branches: an entry read with one sign of a root is refused where the other sign holds."""

import numpy as np
import pytest
import sympy as sp

from geomtorsion import numpy_function
from geomtorsion.codegen.expression_graph import APART, branch_check
from geomtorsion.errors import BranchError
from geomtorsion.exact import Field
from geomtorsion.geometry import Frame, cartan
from geomtorsion.loops import Loop, burgers_vector, exact_burgers_vector

x, y, a = sp.symbols("x y a")

# An entry, points at which it is right as read, and points at which it is wrong.
READ = [
    (1 + sp.sqrt(x**2), [{x: 2}, {x: 0}, {x: 1e-300}], [{x: -2}, {x: -1e-300}]),
    (2 + sp.sqrt(1 - sp.cos(x) ** 2), [{x: 1}, {x: 3}, {x: 7}], [{x: -1}, {x: 4}]),
    (sp.asin(sp.sin(x)), [{x: 1}, {x: -1.5}], [{x: 2}, {x: 7}]),
    (sp.acos(sp.cos(x)), [{x: 1}, {x: 3}], [{x: -1}, {x: 4}]),
    (sp.atan(x) + sp.atan(1 / x), [{x: 1}, {x: 1e6}], [{x: -1}, {x: -1e6}]),
    (sp.acot(x) + sp.atan(x), [{x: 2}], [{x: -2}]),
    (sp.sqrt(a**2) * x, [{x: 1, a: 1}, {x: -1, a: 2}], [{x: 1, a: -1}]),
    (sp.sqrt((x - y) ** 2) + 3, [{x: 1, y: 2}], [{x: 2, y: 1}]),
    (sp.asinh(1 / x), [{x: 2}, {x: 1e-3}], [{x: -2}, {x: -1e-3}]),
    (sp.asec(x), [{x: 2}, {x: 9}], [{x: -2}, {x: -9}]),
    (sp.log(x * y), [{x: 2, y: 1}], [{x: -2, y: -1}]),
]


def principal(entry, point):
    """The value by sympy, to 30 digits."""
    return float(entry.subs({key: sp.Rational(value) for key, value in point.items()}).evalf(30))


@pytest.mark.parametrize(("entry", "right", "wrong"), READ, ids=lambda x: str(x)[:30])
def test_points_and_arrays(entry, right, wrong):
    """At right points the value is the principal one; at other points it is refused."""
    frame = Frame([x, y], [[1, 0], [0, entry]])
    element = frame.coframe.element(1, 1)
    symbols = [s for s in (x, y, a) if any(s in point for point in (*right, *wrong))]
    function = numpy_function([element], symbols)
    plain = numpy_function([element], symbols, check=False)
    for point in right:
        row = [point.get(symbol, 0.0) for symbol in symbols]
        assert frame.coframe.at(point)[1, 1] == pytest.approx(principal(entry, point), rel=1e-12)
        assert function(*row)[0] == pytest.approx(principal(entry, point), rel=1e-12)
    for point in wrong:
        row = [point.get(symbol, 0.0) for symbol in symbols]
        with pytest.raises(BranchError, match="read as"):
            frame.coframe.at(point)
        with pytest.raises(BranchError, match="State a domain around the point"):
            function(*row)
        with pytest.raises(BranchError):
            function(
                *(np.array([right[0].get(s, 0.0), r]) for s, r in zip(symbols, row, strict=True))
            )
        assert np.isnan(plain(*row)).all()
    for one in (frame, element.field.branches[0]):
        assert "read as" in str(one)


def test_later_roots_do_not_restrict_the_frame():
    """A root that is read later for another purpose does not restrict the frame."""
    frame = Frame([x, y], [[1, 0], [0, 1 + x**2]])
    before = frame.metric.at({x: -2})
    frame.read([("a root", sp.sqrt(x**2))])
    assert frame.field.branches
    assert (frame.metric.at({x: -2}) == before).all()


def test_a_field_without_a_frame():
    """An element of a field without a frame depends on all branches of the field."""
    root = Field([x]).read(sp.sqrt(x**2))
    assert numpy_function([root], [x])([1.0, 3.0]).tolist() == [[1.0, 3.0]]
    with pytest.raises(BranchError, match=r"sqrt\(x\*\*2\) read as x.*x = -3"):
        numpy_function([root], [x])([1.0, -3.0])
    assert branch_check([Field([x])], ["x"]) is None


def test_complex_fields_compare_values():
    """A complex root is compared with its reading; a difference below APART is rounding."""
    field = Field([x, y], complex=True)
    field.read(sp.sqrt((x + 1 + sp.I) ** 2))
    check = branch_check([field], ["x"])
    assert check is not None
    assert not check.broken(1.0).any()
    assert check.broken(-3.0).any()
    nearly = (1 + APART / 2, 1 + 2 * APART)
    shifted = Field([x, y], complex=True)
    shifted.read(sp.sqrt((x + sp.I) ** 2))
    assert [check.broken(value).any() for value in nearly] == [False, False]


def test_points_of_complex_frames_are_complex():
    """Points may be complex, also if neither a root read with a sign nor an entry contains I."""
    frame = Frame([x, y], [[2 + sp.sqrt((x + 2) ** 2), y], [0, 3]], complex=True)
    assert frame.coframe.at({x: 1, y: 2})[0, 0] == 5
    assert frame.coframe.at({x: 1 + 2j, y: 2})[0, 0] == 5 + 2j
    assert complex(frame.coframe.at({x: 1 + 2j, y: 2}, digits=30)[0, 0]) == 5 + 2j
    for outside in (-5, -5 + 1j):
        with pytest.raises(BranchError, match="x = -5"):
            frame.coframe.at({x: outside, y: 2})


@pytest.mark.parametrize("entry", [sp.asinh(1 / x), sp.sqrt((x**2 + 1) / x**2)], ids=str)
def test_roots_of_quotients_hold_in_the_domain(entry):
    """With x < 0 declared, a root is right there and is refused elsewhere."""
    frame = Frame([x, y], [[1, 0], [0, 5 + entry]], domain=[x < 0])
    want = float((entry.diff(x) / (5 + entry) / 2).subs(x, -3))
    assert cartan(frame).torsion.S.at({x: -3})[0, 1, 1] == pytest.approx(want, rel=1e-12)
    with pytest.raises(BranchError, match="x = 3"):
        cartan(frame).torsion.S.at({x: 3})


def test_chosen_signs_are_the_user_s():
    """branches={...} states the sign, which then holds everywhere."""
    frame = Frame([x, y], [[1, 0], [0, 2 + sp.sqrt(x**2)]], branches={sp.sqrt(x**2): -x})
    assert frame.coframe.at({x: -3})[1, 1] == 5.0


@pytest.mark.parametrize("method", [burgers_vector, exact_burgers_vector], ids=["numbers", "exact"])
def test_loops(method):
    """b^2 = integral of (1 + |x|) dy: minus the area for x < 0; a loop across x = 0 is refused."""
    frame = Frame([x, y], [[1, 0], [0, 1 + sp.sqrt(x**2)]])
    here = method(frame, Loop.circle([2, 0], 1))
    assert float(here.vector[1]) == pytest.approx(np.pi, rel=1e-12)
    for centre in (-2, 0.5):
        with pytest.raises(BranchError, match=r"sqrt\(x\*\*2\)"):
            method(frame, Loop.circle([centre, 0], 1))
    left = Frame([x, y], [[1, 0], [0, 1 + sp.sqrt(x**2)]], domain=[x < 0])
    there = method(left, Loop.circle([-2, 0], 1))
    assert float(there.vector[1]) == pytest.approx(-np.pi, rel=1e-12)


def test_equal_checks_are_made_once():
    """Equal branches and names share one check and its code; other names have their own."""
    field = Frame([x, y], [[1, 0], [0, 1 + sp.sqrt(x**2)]]).field
    first = branch_check([field], ["x", "y"])
    assert first is not None
    assert branch_check([field], ["x", "y"]) is first
    assert branch_check([field], ["y", "x"]) is not first
    assert branch_check([Frame([x, y], [[1, 0], [0, 1]]).field], ["x", "y"]) is None

"""Invariants: scalars of torsion, curvature and nonmetricity, as sums of products with indices."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction

import sympy as sp

from geomtorsion.errors import GravityError
from geomtorsion.exact import names as words
from geomtorsion.gravity.theory.fields import HALF
from geomtorsion.gravity.theory.products import EPSILON, Product, read_products
from geomtorsion.support import checks

QUARTER = Fraction(1, 4)
# Words of programs that are not quantities, in small letters.
WORDS = frozenset("nan inf infinity oo zoo none null true false self".split())
# Names of invariants of matter fields.
OF_FIELDS = frozenset("X Box hessian2 hessian3 F2".split())
# A name with the ending of another connection.
SUFFIXED = re.compile(r"(.+?)(bar|_[2-9]\d*)")
# Products of which the invariants with a name are made.
FORMULAS = {
    "T1": "T_abc T^abc", "T2": "T_abc T^cba", "T3": "v_a v^a",
    "T dual": "eps^abmn T_abc T_mn^c",
    "Q1": "Q_abc Q^abc", "Q2": "Q_abc Q^bac", "Q3": "Q_a Q^a", "Q4": "q_a q^a", "Q5": "Q_a q^a",
    "U1": "T_abc Q^abc", "U2": "v_a Q^a", "U3": "v_a q^a",
    "R": "R", "R eps": "eps^abmn R_abmn",
    "R1": "R_abcd R^abcd", "R2": "R_abcd R^acbd", "R3": "R_abcd R^cdab", "R4": "R_ab R^ab",
    "R5": "R_ab R^ba", "R6": "R^2", "R7": "V_ab V^ab", "R dual": "eps^abmn R_abij R_mn^ij",
}  # fmt: skip

# Formula, or a name in FORMULAS -> its factor.
Coefficients = dict[str, Fraction]


@dataclass(frozen=True)
class Fixed:
    """Coefficients that do not depend on the dimension.

    items: pairs of a formula, or of a name in FORMULAS, and its factor.
    """

    items: tuple[tuple[str, Fraction], ...]

    def __call__(self, dimension: int) -> Coefficients:
        """The coefficients."""
        return dict(self.items)


@dataclass(frozen=True)
class Invariant:
    """A scalar that a Lagrangian may name.

    name, meaning: how it is written, and its formula.
    of: dimension -> coefficient of each formula.
    only: the dimension in which it exists; 0: any.
    antisymmetric: whether only R_ab[ij] enters, where the connection is not metric.
    """

    name: str
    meaning: str
    of: Callable[[int], Coefficients]
    only: int = 0
    antisymmetric: bool = False

    def products(self, dimension: int) -> tuple[Product, ...]:
        """Its sum of products of tensors in a dimension."""
        return tuple(
            replace(one, coefficient=factor * one.coefficient)
            for formula, factor in self.of(dimension).items()
            for one in read_products(FORMULAS.get(formula, formula), f"invariant {self.name}")
        )

    def __str__(self) -> str:
        return f"{self.name} = {self.meaning}"


def _plain(name: str, meaning: str) -> Invariant:
    """An invariant that is one formula."""
    return Invariant(name, meaning, Fixed(((name, Fraction(1)),)))


def _fixed(**coefficients: Fraction | int) -> Fixed:
    """Coefficients that do not depend on the dimension."""
    return Fixed(tuple((name, Fraction(x)) for name, x in coefficients.items()))


def _added(*shares: tuple[Fraction | int, Coefficients]) -> Coefficients:
    """A sum of multiples of coefficients."""
    total: Coefficients = {}
    for factor, coefficients in shares:
        for name, x in coefficients.items():
            total[name] = total.get(name, Fraction(0)) + factor * x
    return {name: x for name, x in total.items() if x}


def _axial(n: int) -> Coefficients:
    return {"T1": Fraction(1, 3), "T2": Fraction(-2, 3)}


def _vector(n: int) -> Coefficients:
    return {"T3": Fraction(2, n - 1)} if n > 1 else {}


def _tensor(n: int) -> Coefficients:
    return _added((1, {"T1": Fraction(1)}), (-1, _axial(n)), (-1, _vector(n)))


def _scalar_square(n: int) -> Coefficients:
    return {"R6": Fraction(2, n * (n - 1))} if n > 1 else {}


def _ricci(n: int) -> Coefficients:
    share = Fraction(4, n - 2) if n > 2 else Fraction(0)
    return _added((share, {"R4": HALF, "R5": HALF, "R6": Fraction(-1, n)}))


def _antiricci(n: int) -> Coefficients:
    share = Fraction(4, n - 2) if n > 2 else Fraction(0)
    return _added((share, {"R4": HALF, "R5": -HALF}))


def _pseudoscalar(n: int) -> Coefficients:
    return {"R1": Fraction(1, 6), "R2": Fraction(-2, 3), "R3": Fraction(1, 6)}


def _weyl(n: int) -> Coefficients:
    rest = [(-1, part(n)) for part in (_pseudoscalar, _ricci, _scalar_square)]
    return _added((HALF, {"R1": Fraction(1), "R3": Fraction(1)}), *rest)


def _paircom(n: int) -> Coefficients:
    return _added((HALF, {"R1": Fraction(1), "R3": Fraction(-1)}), (-1, _antiricci(n)))


def _nieh_yan(n: int) -> Coefficients:
    return {"T dual": Fraction(1), "R eps": Fraction(2)}


TABLE = (
    _plain("T1", "T_abc T^abc"),
    _plain("T2", "T_abc T^cba"),
    _plain("T3", "v_a v^a, v_a = T_ab^b"),
    Invariant("T", "torsion scalar T1/4 + T2/2 - T3", _fixed(T1=QUARTER, T2=HALF, T3=-1)),
    Invariant("tensor2", "square of the tensor part of torsion", _tensor),
    Invariant("vector2", "square of the vector part of torsion, 2 v^2/(n - 1)", _vector),
    Invariant("axial2", "square of the axial part of torsion", _axial),
    _plain("R", "curvature scalar, positive for spheres"),
    _plain("R1", "R_abcd R^abcd"),
    _plain("R2", "R_abcd R^acbd"),
    _plain("R3", "R_abcd R^cdab"),
    _plain("R4", "R_ab R^ab of the Ricci tensor"),
    _plain("R5", "R_ab R^ba of the Ricci tensor"),
    _plain("R6", "R^2"),
    _plain("R7", "V_ab V^ab, V_ab = R_abc^c"),
    Invariant("P1", "square of weyl", _weyl, antisymmetric=True),
    Invariant("P2", "square of paircom", _paircom, antisymmetric=True),
    Invariant("P3", "square of pseudoscalar, R_[abcd]", _pseudoscalar, antisymmetric=True),
    Invariant("P4", "square of ricci, traceless and symmetric", _ricci, antisymmetric=True),
    Invariant("P5", "square of antiricci", _antiricci, antisymmetric=True),
    Invariant("P6", "square of scalar, 2 R^2/(n (n - 1))", _scalar_square, antisymmetric=True),
    Invariant("GB", "R3 - 4 R5 + R6 (Gauss, Bonnet)", _fixed(R3=1, R5=-4, R6=1), 0, True),
    Invariant("euler", "P1 - P2 + P3 - P4 + P5 + P6", _fixed(R3=1, R5=-4, R6=1), 4, True),
    Invariant(
        "pontryagin", "eps^abmn R_abij R_mn^ij", Fixed((("R dual", Fraction(1)),)), 4, True
    ),
    Invariant("holst", "eps^abmn R_abmn", Fixed((("R eps", Fraction(1)),)), 4),
    Invariant("nieh_yan", "eps^abmn (T_abc T_mn^c + 2 R_abmn)", _nieh_yan, 4),
    _plain("Q1", "Q_abc Q^abc"),
    _plain("Q2", "Q_abc Q^bac"),
    _plain("Q3", "Q_a Q^a, Q_a = Q_ab^b"),
    _plain("Q4", "q_a q^a, q_a = Q^b_ba"),
    _plain("Q5", "Q_a q^a"),
    _plain("U1", "T_abc Q^abc"),
    _plain("U2", "v_a Q^a"),
    _plain("U3", "v_a q^a"),
    Invariant(
        "Q",
        "nonmetricity scalar (Q1 - Q3)/4 - (Q2 - Q5)/2",
        _fixed(Q1=QUARTER, Q2=-HALF, Q3=-QUARTER, Q5=HALF),
    ),
)  # fmt: skip
INVARIANTS = {one.name: one for one in TABLE}


def invariants() -> tuple[Invariant, ...]:
    """The invariants that a Lagrangian may name, with their formulas.

    Examples
    --------
    >>> [one.name for one in invariants() if one.only == 4]
    ['euler', 'pontryagin', 'holst', 'nieh_yan']
    """
    return TABLE


def new_name(entry: object, subject: str) -> str:
    """A name of one word that has no meaning in a Lagrangian yet."""
    name = str(entry) if isinstance(entry, sp.Symbol) else entry
    if not isinstance(name, str) or not name.isidentifier():
        raise GravityError(f"{subject}: expected a name such as alpha, got {checks.shown(entry)}.")
    suffixed = SUFFIXED.fullmatch(name)
    base = suffixed[1] if suffixed else name
    taken = base in INVARIANTS or base in OF_FIELDS or name in words.FUNCTIONS
    if taken or name in words.CONSTANTS or name.lower() in WORDS:
        raise GravityError(
            f"{subject}: expected a new name, got {name}, which has a meaning in Lagrangians. Give "
            "another name."
        )
    return name


def invariant(name: str, formula: str) -> Invariant:
    """A user-defined invariant, a sum of products of tensors with indices.

    Each index occurs twice, once up and once down. `R_ab` is the Ricci tensor R_cab^c, `R` its
    trace, `G_ab` = R_ab - R g_ab/2, `v_a` = T_ab^b, `V_ab` = R_abc^c, `Q_a` = Q_ab^b and
    `q_a` = Q^b_ba. `g_ab` is the metric and `eps_abcd` the volume form. `A_a` and `F_ab` belong to
    a Maxwell field, and `phi_a` is the gradient of the scalar field phi and
    `phi_ab` its second derivative with the Levi-Civita connection. `Rbar_ab` and `R_2_ab`
    are tensors of the Levi-Civita and of the second connection.

    Equation
    --------
    The derivative of a product by one of its tensors, which the field equations contain, is the
    contraction of its other factors.

    Raises
    ------
    ExpressionError
        The formula contains an unknown sign, tensor or index.
    GravityError
        The name has a meaning in Lagrangians already.

    Examples
    --------
    >>> import geomtorsion as gt
    >>> from geomtorsion import gravity
    >>> square = gravity.invariant("Y", "R_abcd R^abdc")
    >>> print(square)
    Y = R_abcd R^abdc
    >>> sphere = gt.levi_civita(gt.spaces.load("s2").frame)
    >>> gravity.equations(sphere, "R1 + Y", invariants=square).L.is_zero
    True
    """
    text = checks.text(name, "name", GravityError)
    formula = checks.text(formula, "formula", GravityError)
    new_name(text, "name")
    if SUFFIXED.fullmatch(text):
        raise GravityError(
            f"name: expected a name that does not end in bar or _2, got {text}. These endings "
            "belong to other connections."
        )
    products = read_products(formula, f"invariant {text}")
    dimensions = {len(x.indices) for one in products for x in one.factors if x.name == EPSILON}
    if len(dimensions) > 1:
        raise GravityError(
            f"invariant {text}: expected eps with the same number of indices everywhere, the "
            f"dimension, got {sorted(dimensions)}. Correct the formula."
        )
    return Invariant(text, formula, Fixed(((formula, Fraction(1)),)), max(dimensions, default=0))

"""Invariants: scalars <X, M X> of torsion, curvature and nonmetricity X, with M self-adjoint.

A table gives each name its field X and its linear map M. The momentum of <X, M X> is 2 M X. The
maps return values with the symmetry of X, so that momenta count all components of X.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from geomtorsion.caching import cached_property
from geomtorsion.exact import Element
from geomtorsion.exclusive import exclusive
from geomtorsion.geometry import Frame, Tensor
from geomtorsion.geometry import antisymmetric as odd
from geomtorsion.geometry import symmetric as even
from geomtorsion.gravity.fields import HALF, FrameFields, Index, Terms

QUARTER = Fraction(1, 4)


@exclusive
@dataclass(frozen=True, eq=False)
class Traced:
    """A field with all indices down in the frame, and its traces, for the maps below."""

    tensor: Tensor

    @property
    def frame(self) -> Frame:
        """The frame of the field."""
        return self.tensor.frame

    def __call__(self, *index: int) -> Element:
        """One component."""
        return self.tensor.components.get(index)

    def eta(self, i: int, j: int) -> Element:
        """eta_ij."""
        return self.frame.eta.components.get((i, j))

    def _trace(self, first: int, second: int) -> Tensor:
        """The trace over two indices."""
        rest = len(self.tensor.slots) - 2
        get, inverse = self.tensor.components.get, self.frame.inverse_eta.components.nonzero

        def rule(index: Index) -> Element:
            terms = []
            for (i, j), x in inverse.items():
                place = list(index)
                place.insert(first, i)
                place.insert(second, j)
                terms.append((1, x, get(tuple(place))))
            return self.frame.field.sum(terms)

        return Tensor(self.frame, "D" * rest, rule)

    @cached_property
    def traces(self) -> Mapping[tuple[int, int], Tensor]:
        """All traces of the field, computed on demand."""
        n = len(self.tensor.slots)
        return {(i, j): self._trace(i, j) for i in range(n) for j in range(i + 1, n)}

    def trace(self, first: int, second: int, *index: int) -> Element:
        """One component of a trace."""
        return self.traces[first, second].components.get(index)

    @cached_property
    def scalar(self) -> Element:
        """eta^ad eta^bc X_abcd, the scalar of a curvature."""
        inverse, ricci = self.frame.inverse_eta.components.nonzero, self.traces[0, 3].components.get
        return self.frame.field.sum([(1, x, ricci(place)) for place, x in inverse.items()])

    @cached_property
    def epsilon(self) -> Tensor:
        """eps_abcd, slots DDDD."""
        size = (self.frame.volume / self.frame.determinant).element()
        alternating = tuple(
            (tuple(k + 1 if j == k else k if j == k + 1 else j for j in range(4)), -1)
            for k in range(3)
        )
        return Tensor(self.frame, "DDDD", {(0, 1, 2, 3): size}, alternating)

    @cached_property
    def dual(self) -> Tensor:
        """eps_ab^mn X_mn..."""
        get, epsilon = self.tensor.components.get, self.epsilon.raised(2).raised(3).components.get
        pairs = [(m, n) for m in range(4) for n in range(m)]

        def rule(index: Index) -> Element:
            head, rest = index[:2], index[2:]
            return self.frame.field.sum(
                [(2, epsilon((*head, *pair)), get((*pair, *rest))) for pair in pairs]
            )

        return Tensor(self.frame, self.tensor.slots, rule)


Map = Callable[[Traced, Index], Terms]


# -- maps of torsion, X_abc antisymmetric in ab ------------------------------------------------


def _t1(x: Traced, index: Index) -> Terms:
    return [(1, x(*index))]


def _t2(x: Traced, index: Index) -> Terms:
    a, b, c = index
    return [(HALF, x(c, b, a)), (-HALF, x(c, a, b))]


def _t3(x: Traced, index: Index) -> Terms:
    a, b, c = index
    return [(HALF, x.trace(1, 2, a), x.eta(b, c)), (-HALF, x.trace(1, 2, b), x.eta(a, c))]


def _dual(x: Traced, index: Index) -> Terms:
    return [(1, x.dual.components.get(index))]


# -- maps of nonmetricity, X_abc symmetric in bc -----------------------------------------------


def _q2(x: Traced, index: Index) -> Terms:
    a, b, c = index
    return [(HALF, x(b, a, c)), (HALF, x(c, a, b))]


def _q3(x: Traced, index: Index) -> Terms:
    a, b, c = index
    return [(1, x.eta(b, c), x.trace(1, 2, a))]


def _q4(x: Traced, index: Index) -> Terms:
    a, b, c = index
    return [(HALF, x.eta(a, b), x.trace(0, 1, c)), (HALF, x.eta(a, c), x.trace(0, 1, b))]


def _q5(x: Traced, index: Index) -> Terms:
    a, b, c = index
    return [
        (HALF, x.eta(b, c), x.trace(0, 1, a)),
        (QUARTER, x.eta(a, b), x.trace(1, 2, c)),
        (QUARTER, x.eta(a, c), x.trace(1, 2, b)),
    ]


# -- maps of one of torsion and nonmetricity to the other --------------------------------------


def _u1_of_q(x: Traced, index: Index) -> Terms:
    a, b, c = index
    return [(HALF, x(a, b, c)), (-HALF, x(b, a, c))]


def _u1_of_t(x: Traced, index: Index) -> Terms:
    a, b, c = index
    return [(HALF, x(a, b, c)), (HALF, x(a, c, b))]


def _u3_of_q(x: Traced, index: Index) -> Terms:
    a, b, c = index
    return [(HALF, x.trace(0, 1, a), x.eta(b, c)), (-HALF, x.trace(0, 1, b), x.eta(a, c))]


def _u3_of_t(x: Traced, index: Index) -> Terms:
    a, b, c = index
    return [(HALF, x.eta(a, b), x.trace(1, 2, c)), (HALF, x.eta(a, c), x.trace(1, 2, b))]


# -- maps of curvature, X_abcd antisymmetric in ab ---------------------------------------------


def _r2(x: Traced, index: Index) -> Terms:
    a, b, c, d = index
    return [(HALF, x(a, c, b, d)), (-HALF, x(b, c, a, d))]


def _r3(x: Traced, index: Index) -> Terms:
    a, b, c, d = index
    return [(HALF, x(c, d, a, b)), (-HALF, x(c, d, b, a))]


def _r4(x: Traced, index: Index) -> Terms:
    a, b, c, d = index
    return [(HALF, x.eta(a, d), x.trace(0, 3, b, c)), (-HALF, x.eta(b, d), x.trace(0, 3, a, c))]


def _r5(x: Traced, index: Index) -> Terms:
    a, b, c, d = index
    return [(HALF, x.eta(a, d), x.trace(0, 3, c, b)), (-HALF, x.eta(b, d), x.trace(0, 3, c, a))]


def _r6(x: Traced, index: Index) -> Terms:
    return [(*term, x.scalar) for term in _r(x, index)]


def _r7(x: Traced, index: Index) -> Terms:
    a, b, c, d = index
    return [(1, x.eta(c, d), x.trace(2, 3, a, b))]


def _r(x: Traced, index: Index) -> Terms:
    a, b, c, d = index
    return [(HALF, x.eta(a, d), x.eta(b, c)), (-HALF, x.eta(b, d), x.eta(a, c))]


def _epsilon(x: Traced, index: Index) -> Terms:
    return [(1, x.epsilon.components.get(index))]


MAPS: dict[str, tuple[str, Map]] = {
    "T1": ("torsion", _t1), "T2": ("torsion", _t2), "T3": ("torsion", _t3),
    "T dual": ("torsion", _dual),
    "Q1": ("nonmetricity", _t1), "Q2": ("nonmetricity", _q2), "Q3": ("nonmetricity", _q3),
    "Q4": ("nonmetricity", _q4), "Q5": ("nonmetricity", _q5),
    "R1": ("curvature", _t1), "R2": ("curvature", _r2), "R3": ("curvature", _r3),
    "R4": ("curvature", _r4), "R5": ("curvature", _r5), "R6": ("curvature", _r6),
    "R7": ("curvature", _r7), "R dual": ("curvature", _dual),
}  # fmt: skip
# Products of torsion and nonmetricity: the momentum of torsion as a map of nonmetricity, and the
# momentum of nonmetricity as a map of torsion.
MIXED: dict[str, tuple[Map, Map]] = {
    "U1": (_u1_of_q, _u1_of_t), "U2": (_t3, _q3), "U3": (_u3_of_q, _u3_of_t),
}  # fmt: skip
# Of these the value is <K, X> and the momentum the constant K.
LINEAR: dict[str, Map] = {"R": _r, "R eps": _epsilon}

Coefficients = dict[str, Fraction]


@dataclass(frozen=True)
class Invariant:
    """A scalar that a Lagrangian may name.

    name, meaning: how it is written, and its formula.
    of: dimension -> coefficient of each map.
    only: the dimension in which it exists; 0: any.
    antisymmetric: whether only R_ab[ij] enters, where the connection is not metric.
    """

    name: str
    meaning: str
    of: Callable[[int], Coefficients]
    only: int = 0
    antisymmetric: bool = False

    def has_nonmetricity(self, dimension: int) -> bool:
        """Whether it contains the nonmetricity."""
        parts = self.of(dimension)
        return any(x in MIXED or (x in MAPS and MAPS[x][0] == "nonmetricity") for x in parts)


def _plain(name: str, meaning: str) -> Invariant:
    """An invariant that is one map."""
    return Invariant(name, meaning, lambda _: {name: Fraction(1)})


def _fixed(**coefficients: Fraction | int) -> Callable[[int], Coefficients]:
    """Coefficients that do not depend on the dimension."""
    return lambda _: {name: Fraction(x) for name, x in coefficients.items()}


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
        "pontryagin", "eps^abmn R_abij R_mn^ij", lambda _: {"R dual": Fraction(1)}, 4, True
    ),
    Invariant("holst", "eps^abmn R_abmn", lambda _: {"R eps": Fraction(1)}, 4),
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


@exclusive
@dataclass(frozen=True, eq=False)
class Scalars:
    """The invariants of one connection: their values, and the images of the fields."""

    fields: FrameFields

    @cached_property
    def _images(self) -> dict[tuple[str, bool], Tensor]:
        return {}

    @cached_property
    def _values(self) -> dict[str, Element]:
        return {}

    @cached_property
    def _traced(self) -> dict[str, Traced]:
        fields = self.fields
        return {
            "torsion": Traced(fields.torsion.lowered(2)),
            "curvature": Traced(fields.curvature),
            "antisymmetric": Traced(fields.rotation_curvature),
            "nonmetricity": Traced(fields.nonmetricity),
        }

    def field(self, name: str, antisymmetric: bool) -> Traced:
        """The field on which a map acts."""
        kind = "curvature" if name in LINEAR else MAPS[name][0]
        return self._traced["antisymmetric" if antisymmetric and kind == "curvature" else kind]

    def mixed(self, name: str, kind: str) -> Tensor:
        """The momentum of torsion or of nonmetricity of a product of both, indices down."""
        key = f"{name} {kind}", False
        if key not in self._images:
            of_torsion = kind == "torsion"
            x = self._traced["nonmetricity" if of_torsion else "torsion"]
            rule, total = MIXED[name][0 if of_torsion else 1], x.frame.field.sum
            symmetry = odd(3) if of_torsion else even(3, 1, 2)
            self._images[key] = Tensor(x.frame, "DDD", lambda i: total(rule(x, i)), symmetry)
        return self._images[key]

    def image(self, name: str, antisymmetric: bool = False) -> Tensor:
        """M X (or the constant K) with all indices down in the frame."""
        key = name, antisymmetric
        if key not in self._images:
            self._images[key] = self._image(*key)
        return self._images[key]

    def _image(self, name: str, antisymmetric: bool) -> Tensor:
        x = self.field(name, antisymmetric)
        kind, rule = ("curvature", LINEAR[name]) if name in LINEAR else MAPS[name]
        total = x.frame.field.sum
        if kind == "torsion":
            return Tensor(x.frame, "DDD", lambda i: total(rule(x, i)), odd(3))
        if kind == "nonmetricity":
            return Tensor(x.frame, "DDD", lambda i: total(rule(x, i)), even(3, 1, 2))
        if not (antisymmetric or self.fields.is_metric):
            return Tensor(x.frame, "DDDD", lambda i: total(rule(x, i)), odd(4))

        def projected(index: Index) -> Element:
            a, b, c, d = index
            terms = [(HALF * term[0], *term[1:]) for term in rule(x, index)]
            terms += [(-HALF * term[0], *term[1:]) for term in rule(x, (a, b, d, c))]
            return total(terms)

        return Tensor(x.frame, "DDDD", projected, odd(4) + odd(4, 2, 3))

    def value(self, name: str) -> Element:
        """The invariant as an exact element."""
        if name not in self._values:
            invariant = INVARIANTS[name]
            terms: Terms = []
            for one, factor in invariant.of(self.fields.frame.dimension).items():
                if one in LINEAR:
                    terms += self._linear(one, factor)
                    continue
                if one in MIXED:
                    upper = self._traced["torsion"].tensor.raised().components.nonzero
                    image = self.mixed(one, "torsion").components.get
                    terms += [(factor, x, image(index)) for index, x in upper.items()]
                    continue
                upper = self.field(one, invariant.antisymmetric).tensor.raised().components.nonzero
                image = self.image(one, invariant.antisymmetric).components.get
                terms += [(factor, x, image(index)) for index, x in upper.items()]
            self._values[name] = self.fields.frame.field.sum(terms)
        return self._values[name]

    def _linear(self, name: str, factor: Fraction) -> Terms:
        """Terms of <K, X>."""
        x = self.field(name, False)
        if name == "R":
            return [(factor, x.scalar)]
        upper = self.image(name).raised().components.nonzero
        return [(factor, k, x(*index)) for index, k in upper.items()]

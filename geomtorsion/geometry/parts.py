"""Parts: irreducible parts of torsion, nonmetricity and curvature, as tensors that add up."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import permutations
from typing import Any, ClassVar, Protocol, TypeVar

from geomtorsion.exact import Element
from geomtorsion.geometry.components import (
    Index,
    Symmetry,
    alternating,
    antisymmetric,
    symmetric,
)

HALF = Fraction(1, 2)
PAIRS: Symmetry = antisymmetric(4) + antisymmetric(4, 2, 3)


class Array(Protocol):
    """The members of a tensor that its parts need."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def frame(self) -> Any:
        """The frame of the tensor."""
        ...

    @property
    def slots(self) -> str:
        """The kinds of its indices."""
        ...

    @property
    def components(self) -> Any:
        """The array behind it."""
        ...


T = TypeVar("T", bound=Array)
Rule = Callable[[Index], Element]


def _like(tensor: T, slots: str, rule: Rule, symmetry: Symmetry = (), name: str = "") -> T:
    """A tensor of the same kind with other components."""
    return replace(tensor, slots=slots, source=rule, symmetry=symmetry, name=name, anchored=())


def torsion_parts(torsion: T) -> Mapping[str, T]:
    """Tensor, vector and axial part of T_abc, all indices down.

    vector: (v_a g_bc - v_b g_ac) / (n - 1), v_a = T_ab^b. axial: T_[abc]. tensor: the rest.
    """
    n = torsion.frame.dimension
    vector = _trace(torsion, 1, 2)
    share = Fraction(1, max(n - 1, 1))
    metric = _metric(torsion)

    def of_vector(index: Index) -> Element:
        a, b, c = index
        v, g = vector.components.get, metric.components.get
        return torsion.frame.field.sum([(share, v((a,)), g((b, c))), (-share, v((b,)), g((a, c)))])

    first = _like(torsion, torsion.slots, of_vector, antisymmetric(3), "vector part")
    cycles = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    axial = _sum(
        [(Fraction(1, 3), torsion, order) for order in cycles], alternating(3), "axial part"
    )
    rest = _rest(torsion, (first, axial), antisymmetric(3), "tensor part")
    return {"tensor": rest, "vector": first, "axial": axial}


def nonmetricity_parts(nonmetricity: T) -> Mapping[str, T]:
    """Symmetric, mixed, Lambda and Weyl part of Q_abc, all indices down.

    Weyl: g_bc q_a / n, q_a = Q_ab^b. Lambda: of the vector L_c = (Q - g q/n)^a_ac,
    (2 n / ((n - 1) (n + 2))) (g_a(b L_c) - g_bc L_a / n). symmetric: the totally symmetric part of
    the remainder, mixed: the rest.
    """
    frame, n = nonmetricity.frame, nonmetricity.frame.dimension
    g = _metric(nonmetricity).components.get
    even = symmetric(3, 1, 2)
    q = _trace(nonmetricity, 1, 2).components.get

    def of_weyl(index: Index) -> Element:
        a, b, c = index
        return frame.field.sum([(Fraction(1, n), g((b, c)), q((a,)))])

    weyl = _like(nonmetricity, nonmetricity.slots, of_weyl, even, "Weyl part")
    free = _rest(nonmetricity, (weyl,), even, "")
    second = _trace(free, 0, 1).components.get
    share = Fraction(2 * n, (n - 1) * (n + 2)) if n > 1 else Fraction(0)

    def of_lambda(index: Index) -> Element:
        a, b, c = index
        return frame.field.sum(
            [
                (share * HALF, g((a, b)), second((c,))),
                (share * HALF, g((a, c)), second((b,))),
                (-share / n, g((b, c)), second((a,))),
            ]
        )

    vector = _like(nonmetricity, nonmetricity.slots, of_lambda, even, "Lambda part")
    left = _rest(nonmetricity, (weyl, vector), even, "")
    cycles = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    whole = symmetric(3) + symmetric(3, 1, 2)
    total = _sum([(Fraction(1, 3), left, order) for order in cycles], whole, "symmetric part")
    mixed = _rest(nonmetricity, (weyl, vector, total), even, "mixed part")
    return {"symmetric": total, "mixed": mixed, "Lambda": vector, "Weyl": weyl}


def curvature_parts(curvature: T, *, is_metric: bool) -> Mapping[str, T]:
    """Six parts of R_abcd, all indices down: weyl, paircom, pseudoscalar, ricci, antiricci, scalar.

    Where the connection is not metric, they add up to R_ab[cd], and strain is R_ab(cd). With
    KN(h)_mnlk = g_mk h_nl - g_nk h_ml - g_ml h_nk + g_nl h_mk: scalar R KN(g) / (2 n (n - 1)),
    ricci KN of the traceless symmetric Ricci tensor / (n - 2), antiricci KN(R_[ab]) / (n - 2),
    pseudoscalar R_[abcd]; weyl and paircom: the rest of the half that is symmetric, and of the
    half that is antisymmetric, under the exchange of the pairs.
    """
    n = curvature.frame.dimension
    identity, swapped, exchanged = (0, 1, 2, 3), (0, 1, 3, 2), (2, 3, 0, 1)
    turning = curvature
    nonmetric: dict[str, T] = {}
    if not is_metric:
        turning = _sum([(HALF, curvature, identity), (-HALF, curvature, swapped)], PAIRS)
        strain = [(HALF, curvature, identity), (HALF, curvature, swapped)]
        nonmetric["strain"] = _sum(strain, antisymmetric(4) + symmetric(4, 2, 3), "strain part")
    metric = _metric(curvature)
    ricci = _trace(turning, 0, 3)
    scalar = _trace(ricci, 0, 1)
    whole = _like(
        metric,
        metric.slots,
        lambda index: metric.components.get(index) * scalar.components.get(()),
        symmetric(2),
    )
    traceless = _sum(
        [(HALF, ricci, (0, 1)), (HALF, ricci, (1, 0)), (Fraction(-1, n), whole, (0, 1))],
        symmetric(2),
    )
    odd = _sum([(HALF, ricci, (0, 1)), (-HALF, ricci, (1, 0))], antisymmetric(2))
    share = Fraction(1, n - 2) if n > 2 else Fraction(0)
    of_scalar = Fraction(1, 2 * n * (n - 1)) if n > 1 else Fraction(0)
    of = {
        "ricci": _kulkarni(traceless, share, "ricci part"),
        "antiricci": _kulkarni(odd, share, "antiricci part"),
        "scalar": _kulkarni(whole, of_scalar, "scalar part"),
    }
    signed = [(Fraction(_sign(order), 24), turning, order) for order in permutations(range(4))]
    of["pseudoscalar"] = _sum(signed, alternating(4), "pseudoscalar part")
    halves = {}
    for sign in (1, -1):
        terms = [(HALF, turning, identity), (sign * HALF, turning, exchanged)]
        halves[sign] = _sum(terms, (*PAIRS, (exchanged, sign)))
    even = [of[name] for name in ("pseudoscalar", "ricci", "scalar")]
    parts = {
        "weyl": _rest(halves[1], even, PAIRS, "weyl part"),
        "paircom": _rest(halves[-1], [of["antiricci"]], PAIRS, "paircom part"),
        **{name: of[name] for name in ("pseudoscalar", "ricci", "antiricci", "scalar")},
    }
    return parts | nonmetric


def _kulkarni(h: T, share: Fraction, name: str) -> T:
    """share * KN(h)."""
    g, get = _metric(h).components.get, h.components.get

    def rule(index: Index) -> Element:
        m, n, l, k = index  # noqa: E741  (the letters of the formula)
        return h.frame.field.sum(
            [
                (share, g((m, k)), get((n, l))),
                (-share, g((n, k)), get((m, l))),
                (-share, g((m, l)), get((n, k))),
                (share, g((n, l)), get((m, k))),
            ]
        )

    return _like(h, h.slots * 2, rule, PAIRS, name)


def _metric(tensor: T) -> T:
    """The metric of the basis in which a tensor has its indices."""
    return tensor.frame.eta if "D" in tensor.slots else tensor.frame.metric


def _trace(tensor: T, first: int, second: int) -> T:
    """The trace over two lower indices."""
    frame, get = tensor.frame, tensor.components.get
    inverse = frame.inverse_eta if "D" in tensor.slots else frame.inverse_metric

    def rule(index: Index) -> Element:
        terms = []
        for (i, j), x in inverse.components.nonzero.items():
            place = list(index)
            place.insert(first, i)
            place.insert(second, j)
            terms.append((1, x, get(tuple(place))))
        return frame.field.sum(terms)

    return _like(tensor, tensor.slots[:-2], rule)


def _sum(
    terms: Sequence[tuple[Fraction | int, T, Sequence[int]]], symmetry: Symmetry, name: str = ""
) -> T:
    """A sum of tensors: a factor, a tensor, and the order in which it takes the indices."""
    frame = terms[0][1].frame

    def rule(index: Index) -> Element:
        return frame.field.sum(
            [
                (factor, one.components.get(tuple([index[k] for k in order])))
                for factor, one, order in terms
            ]
        )

    return _like(terms[0][1], terms[0][1].slots, rule, symmetry, name)


def _rest(whole: T, parts: Sequence[T], symmetry: Symmetry, name: str) -> T:
    """Remainder of a tensor after some parts are subtracted."""
    order = tuple(range(len(whole.slots)))
    return _sum([(1, whole, order), *((-1, part, order) for part in parts)], symmetry, name)


def _sign(order: Sequence[int]) -> int:
    """The sign of a permutation."""
    pairs = [(i, j) for i in range(len(order)) for j in range(i)]
    return -1 if sum(order[i] < order[j] for i, j in pairs) % 2 else 1

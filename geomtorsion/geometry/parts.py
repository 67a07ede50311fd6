"""Parts: irreducible parts of torsion, nonmetricity and curvature, as tensors that add up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import permutations

from geomtorsion.exact import Element
from geomtorsion.geometry.components import (
    Index,
    Symmetry,
    alternating,
    antisymmetric,
    symmetric,
)
from geomtorsion.geometry.tensor import Tensor

HALF = Fraction(1, 2)
PAIRS: Symmetry = antisymmetric(4) + antisymmetric(4, 2, 3)

# A term of a sum: a rational number, a tensor, the order in which it takes the indices.
Term = tuple[Fraction | int, Tensor, Sequence[int]]


def torsion_parts(torsion: Tensor) -> Mapping[str, Tensor]:
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
        return torsion.frame.field.sum(
            [(share, v((a,)), g((b, c))), (-share, v((b,)), g((a, c)))]
        )

    first = Tensor(torsion.frame, torsion.slots, of_vector, antisymmetric(3), "T", "vector part")
    cycles = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    axial = _sum([(Fraction(1, 3), torsion, order) for order in cycles], alternating(3), "T", "axial part")
    rest = _rest(torsion, (first, axial), antisymmetric(3), "tensor part")
    return {"tensor": rest, "vector": first, "axial": axial}


def nonmetricity_parts(nonmetricity: Tensor) -> Mapping[str, Tensor]:
    """Symmetric, mixed, Lambda and Weyl part of Q_abc, all indices down.

    Weyl: g_bc q_a / n, q_a = Q_ab^b. Lambda: of the vector L_c = (Q - g q/n)^a_ac,
    (2 n / ((n - 1) (n + 2))) (g_a(b L_c) - g_bc L_a / n). symmetric: the totally symmetric part
    of what is left, mixed: the rest.
    """
    frame, n = nonmetricity.frame, nonmetricity.frame.dimension
    g = _metric(nonmetricity).components.get
    even = symmetric(3, 1, 2)
    q = _trace(nonmetricity, 1, 2).components.get

    def of_weyl(index: Index) -> Element:
        a, b, c = index
        return frame.field.sum([(Fraction(1, n), g((b, c)), q((a,)))])

    weyl = Tensor(frame, nonmetricity.slots, of_weyl, even, "Q", "Weyl part")
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

    vector = Tensor(frame, nonmetricity.slots, of_lambda, even, "Q", "Lambda part")
    left = _rest(nonmetricity, (weyl, vector), even, "")
    cycles = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    whole = symmetric(3) + symmetric(3, 1, 2)
    total = _sum([(Fraction(1, 3), left, order) for order in cycles], whole, "Q", "symmetric part")
    mixed = _rest(nonmetricity, (weyl, vector, total), even, "mixed part")
    return {"symmetric": total, "mixed": mixed, "Lambda": vector, "Weyl": weyl}


def curvature_parts(curvature: Tensor, *, is_metric: bool) -> Mapping[str, Tensor]:
    """Six parts of R_abcd, all indices down: weyl, paircom, pseudoscalar, ricci, antiricci, scalar.

    Where the connection is not metric, they add up to R_ab[cd], and strain is R_ab(cd). With
    KN(h)_mnlk = g_mk h_nl - g_nk h_ml - g_ml h_nk + g_nl h_mk: scalar R KN(g) / (2 n (n - 1)),
    ricci KN of the traceless symmetric Ricci tensor / (n - 2), antiricci KN(R_[ab]) / (n - 2),
    pseudoscalar R_[abcd]; weyl and paircom: the rest of the half that is symmetric, and of the
    half that is antisymmetric, under the exchange of the pairs.
    """
    frame, n = curvature.frame, curvature.frame.dimension
    one, swapped, exchanged = (0, 1, 2, 3), (0, 1, 3, 2), (2, 3, 0, 1)
    turning = curvature
    found: dict[str, Tensor] = {}
    if not is_metric:
        turning = _sum([(HALF, curvature, one), (-HALF, curvature, swapped)], PAIRS, "R", "")
        strain = [(HALF, curvature, one), (HALF, curvature, swapped)]
        found["strain"] = _sum(strain, antisymmetric(4) + symmetric(4, 2, 3), "R", "strain part")
    metric = _metric(curvature)
    ricci = _trace(turning, 0, 3)
    scalar = _trace(ricci, 0, 1)
    traceless = _sum(
        [(HALF, ricci, (0, 1)), (HALF, ricci, (1, 0)), (Fraction(-1, n), metric * scalar, (0, 1))],
        symmetric(2),
        "R",
        "",
    )
    odd = _sum([(HALF, ricci, (0, 1)), (-HALF, ricci, (1, 0))], antisymmetric(2), "R", "")
    share = Fraction(1, n - 2) if n > 2 else Fraction(0)
    of_scalar = Fraction(1, 2 * n * (n - 1)) if n > 1 else Fraction(0)
    of = {
        "ricci": _kulkarni(traceless, share, "ricci part"),
        "antiricci": _kulkarni(odd, share, "antiricci part"),
        "scalar": _kulkarni(metric * scalar, of_scalar, "scalar part"),
    }
    signed = [(Fraction(_sign(order), 24), turning, order) for order in permutations(range(4))]
    of["pseudoscalar"] = _sum(signed, alternating(4), "R", "pseudoscalar part")
    halves = {}
    for sign in (1, -1):
        terms = [(HALF, turning, one), (sign * HALF, turning, exchanged)]
        halves[sign] = _sum(terms, (*PAIRS, (exchanged, sign)), "R", "")
    even = [of[name] for name in ("pseudoscalar", "ricci", "scalar")]
    parts = {
        "weyl": _rest(halves[1], even, PAIRS, "weyl part"),
        "paircom": _rest(halves[-1], [of["antiricci"]], PAIRS, "paircom part"),
        **{name: of[name] for name in ("pseudoscalar", "ricci", "antiricci", "scalar")},
    }
    return parts | found


def _kulkarni(h: Tensor, share: Fraction, name: str) -> Tensor:
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

    return Tensor(h.frame, h.slots * 2, rule, PAIRS, "R", name)


def _metric(tensor: Tensor) -> Tensor:
    """The metric of the basis in which a tensor has its indices."""
    return tensor.frame.eta if "D" in tensor.slots else tensor.frame.metric


def _trace(tensor: Tensor, first: int, second: int) -> Tensor:
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

    return Tensor(frame, tensor.slots[:-2], rule)


def _sum(terms: Sequence[Term], symmetry: Symmetry, symbol: str, name: str) -> Tensor:
    """A sum of multiples of tensors with their indices in other orders."""
    frame, slots = terms[0][1].frame, terms[0][1].slots

    def rule(index: Index) -> Element:
        return frame.field.sum(
            [
                (factor, one.components.get(tuple([index[k] for k in order])))
                for factor, one, order in terms
            ]
        )

    return Tensor(frame, slots, rule, symmetry, symbol, name)


def _rest(whole: Tensor, parts: Sequence[Tensor], symmetry: Symmetry, name: str) -> Tensor:
    """What is left of a tensor without some parts."""
    order = tuple(range(len(whole.slots)))
    terms: list[Term] = [(1, whole, order), *((-1, part, order) for part in parts)]
    return _sum(terms, symmetry, whole.symbol, name)


def _sign(order: Sequence[int]) -> int:
    """The sign of a permutation."""
    pairs = [(i, j) for i in range(len(order)) for j in range(i)]
    return -1 if sum(order[i] < order[j] for i, j in pairs) % 2 else 1

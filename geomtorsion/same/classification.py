"""Classification: properties of one geometry, such as flat, vacuum or Petrov type D."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import sympy as sp

from geomtorsion.geometry import Curvature, Frame, Tensor, levi_civita
from geomtorsion.geometry.connections import FrameLike, frame_of
from geomtorsion.same.invariants import Growth, Invariants, refuse_functions
from geomtorsion.same.petrov import petrov_type
from geomtorsion.same.products import Factor, factors
from geomtorsion.same.scalars import is_constant


@dataclass(frozen=True, repr=False)
class Classification:
    """Properties of one geometry, such as its symmetries, curvature and Petrov type.

    signature: the numbers of minus and of plus signs of the metric.
    growth: independent invariants at each order at which their number grows.
    symmetries, isotropy: dimension of the symmetries, and of the symmetries that fix a generic
        point.
    curvature: the constant sectional curvature K, R_abcd = K (g_ac g_bd - g_ad g_bc) up to the
        convention of signs; None: not constant, or undecided.
    scalar: the constant curvature scalar; None: not constant.
    einstein: the constant c in R_ab = c g_ab; None: no such constant, or undecided.
    conformally_flat: whether a factor makes the metric flat; None: undecided.
    parallel: whether the legs have no torsion; None: the legs are free to turn, or undecided.
    petrov: the Petrov type I, II, D, III, N or O of a space-time; empty: not four dimensions with
        one time.
    factors: the factors of a product; empty: not a product.

    Examples
    --------
    >>> from geomtorsion.same import classified
    >>> print(classified("schwarzschild"))
    vacuum, Petrov type D, 4 symmetries
    """

    signature: tuple[int, int]
    growth: tuple[Growth, ...]
    symmetries: int
    isotropy: int
    curvature: sp.Expr | None
    scalar: sp.Expr | None
    einstein: sp.Expr | None
    conformally_flat: bool | None
    parallel: bool | None
    petrov: str
    factors: tuple[Factor, ...]

    @property
    def dimension(self) -> int:
        """The number of dimensions."""
        return sum(self.signature)

    @property
    def is_flat(self) -> bool:
        """Whether the curvature of the metric vanishes."""
        return self.curvature == 0

    @property
    def lines(self) -> tuple[str, ...]:
        """The properties in words, only the strongest."""
        words: list[str] = []
        if self.is_flat:
            name = {0: "Euclidean space", 1: "Minkowski space"}.get(self.signature[0], "")
            if self.dimension == 1:
                name = ""
            words = ["flat" + (f" ({name})" if name else "")]
        elif self.curvature is not None:
            words = [f"constant curvature {self.curvature}"]
        else:
            if self.factors:
                words.append("a product of " + " and ".join(map(str, self.factors)))
            if self.einstein is not None and self.dimension > 2:
                zero = self.einstein == 0
                words.append("vacuum" if zero else f"Einstein space, R_ab = {self.einstein} g_ab")
            if self.conformally_flat and self.dimension > 2:
                words.append("conformally flat")
            elif self.petrov:
                words.append(f"Petrov type {self.petrov}")
        if self.parallel is not None:
            words.append("legs without torsion" if self.parallel else "legs with torsion")
        count = self.symmetries
        return (*words, "1 symmetry" if count == 1 else f"{count or 'no'} symmetries")

    def __str__(self) -> str:
        return ", ".join(self.lines)

    def __repr__(self) -> str:
        return str(self)

    # -- comparison ------------------------------------------------------------------------------

    def excludes(self, other: Classification) -> bool:
        """Whether the geometries differ; undecided properties exclude nothing."""
        if self.signature != other.signature or self.growth != other.growth:
            return True
        pairs = [
            (self.curvature is None, other.curvature is None),
            (self.is_flat, other.is_flat),
            (self.scalar is None, other.scalar is None),
            (self.scalar == 0, other.scalar == 0),
            (self.einstein is None, other.einstein is None),
            (self.einstein == 0, other.einstein == 0),
            (self.conformally_flat, other.conformally_flat),
            (self.parallel, other.parallel),
            (self.petrov, other.petrov),
        ]
        return any(None not in pair and pair[0] != pair[1] for pair in pairs)

    def may_be_special(self, family: Classification) -> bool:
        """Whether special parameters of a family may give this geometry, and general ones do not.

        What vanishes in general vanishes for special values as well, and ranks do not rise.
        """
        if self.signature != family.signature or not self.excludes(family):
            return False
        rises = zip(self.growth, family.growth, strict=False)
        kept = [
            (family.curvature is not None, self.curvature is not None),
            (family.scalar is not None, self.scalar is not None),
            (family.scalar == 0, self.scalar == 0),
            (family.einstein is not None, self.einstein is not None),
            (family.einstein == 0, self.einstein == 0),
            (family.conformally_flat, self.conformally_flat is not False),
            (family.parallel, self.parallel is not False),
            (family.petrov == "D", self.petrov in ("D", "O")),
        ]
        return (
            all(own.rank <= other.rank for own, other in rises)
            and self.symmetries >= family.symmetries
            and all(after for before, after in kept if before)
        )


def classified(frame: FrameLike, keep: str = "metric") -> Classification:
    """The properties of a frame or its metric, such as flat, vacuum or Petrov type D.

    Parameters
    ----------
    frame
        A frame, a space or a name; without unknown functions.
    keep
        "metric", "teleparallel" or "legs", as in `same_geometry`.

    Raises
    ------
    ArgumentError
        The frame has unknown functions such as a(t).

    Examples
    --------
    >>> from geomtorsion.geometry import Frame
    >>> print(classified(Frame("m s", [["1/s", 0], [0, "sqrt(2)/s"]])))
    constant curvature -1/2, 3 symmetries
    """
    one = frame_of(frame)
    refuse_functions(one)
    return classification(Invariants(one, keep))


def classification(invariants: Invariants) -> Classification:
    """The properties of a geometry, from its invariants."""
    frame, n = invariants.frame, invariants.frame.dimension
    minus, plus = signature(frame)
    torsion = invariants.keep in ("legs", "teleparallel")
    metric = Invariants(frame, "metric") if torsion else invariants
    curvature = levi_civita(frame).curvature
    scalar = einstein = constant = sp.Integer(0)
    conformally: bool | None = True
    if n > 1:
        conformally = _vanishes(_conformal(curvature, n))
        total = curvature.scalar.element()
        scalar = sp.factor(total.sympy) if is_constant(metric, total) else None
        einstein = None if scalar is None else _einstein(metric, curvature, n)
        constant = None
        if einstein is not None and (n < 4 or conformally):
            constant = sp.factor(einstein / (n - 1))
    parallel = _vanishes(invariants.start) if torsion else None
    is_curved = constant is None
    return Classification(
        (minus, plus),
        invariants.growth,
        invariants.symmetries,
        invariants.isotropy,
        constant,
        scalar,
        einstein,
        conformally,
        parallel,
        "" if n != 4 or 1 not in (minus, plus) else "O" if conformally else petrov_type(metric),
        factors(metric) if is_curved and n > 1 else (),
    )


def signature(frame: Frame) -> tuple[int, int]:
    """The numbers of minus and of plus signs of the metric."""
    signs = frame.region.signature
    if 0 in signs:
        # Null legs, of which two have a product.
        matrix = np.real(frame.metric.at(frame.region.point) if frame.complex else frame.eta.at({}))
        signs = tuple(np.sign(np.linalg.eigvalsh(matrix)))
    return signs.count(-1), signs.count(1)


def _conformal(curvature: Curvature, n: int) -> list[Tensor]:
    """Tensors that vanish where the metric is conformally flat."""
    return [] if n < 3 else [curvature.cotton] if n == 3 else [curvature.weyl]


def _einstein(metric: Invariants, curvature: Curvature, n: int) -> sp.Expr | None:
    """The constant c in R_ab = c g_ab, where the curvature scalar is constant."""
    frame, scalar = metric.frame, curvature.scalar.element()
    g, ricci = frame.metric.element, curvature.ricci.element
    rests = (
        frame.field.sum([(n, ricci(i, j)), (-1, g(i, j), scalar)])
        for i in range(n)
        for j in range(i + 1)
    )
    if n > 2 and not all(x.is_zero is True for x in rests):
        return None
    return sp.factor(scalar.sympy / n)


def _vanishes(tensors: Iterable[Tensor]) -> bool | None:
    """Whether all components vanish; None: undecided."""
    zeros = [x.is_zero for t in tensors for x in t.components.independent.values()]
    return False if False in zeros else None if None in zeros else True

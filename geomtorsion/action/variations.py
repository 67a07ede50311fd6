"""Variation: how the velocities of a frame change when a path is varied."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp

from geomtorsion.action import validation
from geomtorsion.action.gaps import Gap
from geomtorsion.action.hamel import coefficients_of, torsion_over
from geomtorsion.action.principles import principle_named
from geomtorsion.action.tangent_bundle import bundle_over, free_pattern, symbols_of
from geomtorsion.geometry import Tensor
from geomtorsion.geometry.assumption import assumption_latex, assumption_of
from geomtorsion.support.caching import cached_property
from geomtorsion.support.displays import drawn_by, latex_of

if TYPE_CHECKING:
    from geomtorsion.exact import Element
    from geomtorsion.geometry import Connection, Frame
    from geomtorsion.geometry.connections import ConnectionLike, FrameLike
    from geomtorsion.ode import ODE

_IMAGES = ("dPhi{}", "delta{}")


@dataclass(frozen=True, eq=False, repr=False)
class Variation:
    """delta-bar u^i = d/dt dPhi^i + A_kj^i u^j dPhi^k, with dPhi^i = e^i_mu dq^mu.

    frame: the frame of the velocities u^i = e^i_mu q'^mu.
    principle: which variations have fixed ends.
    connection: the connection whose torsion the image has; None: the Cartan connection of the
        frame.
    """

    frame: Frame
    principle: str
    connection: Connection | None = None

    @property
    def velocities(self) -> tuple[sp.Symbol, ...]:
        """The quasi-velocities u^i, as symbols."""
        return symbols_of(self.frame).velocities

    @cached_property
    def images(self) -> tuple[sp.Symbol, ...]:
        """The variation in the frame, dPhi^i, as symbols."""
        return self._numbered(_IMAGES)

    @cached_property
    def image_rates(self) -> tuple[sp.Symbol, ...]:
        """The rates d/dt dPhi^i, as symbols."""
        return self._numbered(tuple(f"{form}dot" for form in _IMAGES))

    @cached_property
    def gaps(self) -> tuple[sp.Symbol, ...]:
        """The gaps b^i, as symbols: e^i_mu dq^mu = dPhi^i + b^i where the image closes."""
        return self._numbered(("b{}", "gap{}"))

    def _numbered(self, forms: Sequence[str]) -> tuple[sp.Symbol, ...]:
        """Symbols with the numbers of the forms, named as the frame has none."""
        numbers = range(1, self.frame.dimension + 1)
        form = free_pattern(self.frame, numbers, forms)
        return tuple(sp.Symbol(form.format(k)) for k in numbers)

    @cached_property
    def coefficients(self) -> Tensor:
        """A_kj^i, slots DDU: index k of dPhi, j of u."""
        coefficients = coefficients_of(self.frame, principle_named(self.principle), self.connection)
        return Tensor(self.frame, "DDU", dict(coefficients), (), "A", f"variation {self.principle}")

    @cached_property
    def changes(self) -> tuple[sp.Expr, ...]:
        """Variation delta-bar u^i of each velocity."""
        terms = _bilinear(self.coefficients, self.velocities, self.images)
        return tuple(rate + term for rate, term in zip(self.image_rates, terms, strict=True))

    @cached_property
    def coordinates(self) -> tuple[sp.Expr, ...]:
        """dq^mu: E_i^mu dPhi^i, or E_i^mu (dPhi^i + b^i) where the image closes."""
        images: Sequence[sp.Expr] = self.images
        if self.principle == "closed_in_image":
            images = [one + two for one, two in zip(self.images, self.gaps, strict=True)]
        legs, n = self.frame.legs, range(self.frame.dimension)
        return tuple(sp.Add(*(legs[mu, i] * images[i] for i in n)) for mu in n)

    @cached_property
    def gap_rates(self) -> tuple[sp.Expr, ...]:
        """Rates d/dt b^i of the gaps, with b^i = 0 at the start.

        closed_in_coordinates: zero. closed_in_image: - T_kj^i u^j dPhi^k - C_kj^i u^j b^k; at the
        end b is a Burgers vector. naive: the same, but b is ignored; its dq^mu are not a variation
        of the path unless this vanishes.
        """
        n = self.frame.dimension
        if self.principle == "closed_in_coordinates":
            return (sp.S.Zero,) * n
        image = self.connection if self.principle == "closed_in_image" else None
        torsion = torsion_over(self.frame, image).in_frame()
        terms = _bilinear(torsion, self.velocities, self.images)
        if self.principle == "naive":
            return tuple(-term for term in terms)
        curl_part = _bilinear(self.frame.anholonomy, self.velocities, self.gaps)
        return tuple(-one - two for one, two in zip(terms, curl_part, strict=True))

    def gap_ode(
        self,
        motion: ODE,
        images: Sequence[object],
        *,
        parameters: Mapping[str, object] | None = None,
    ) -> ODE:
        """The gap b^i of a varied path, solved beside the path (Kleinert and Pelster 1999).

        The path and its variation start at one point. With closed_in_image and dPhi^i = 0 at the
        end, their images in the frame also end at one point. In the space the two ends are
        e^i_mu dq^mu = b^i apart (Fiziev and Kleinert 1996). `pictures.draw_gap` draws both.

        Equation
        --------
        b'^i = - T_kj^i u^j dPhi^k - C_kj^i u^j b^k,  b^i = 0 at t = 0: `gap_rates` along a path

        Parameters
        ----------
        motion
            equations whose states include all coordinates q^mu: of a body
            (`ODE.of(gt.equations_of_motion(...), start)`), or of a path as a function of time.
        images
            dPhi^i, n functions of the time, of states and parameters, as text or expressions.
        parameters
            numbers for names that the motion does not have.

        Returns
        -------
        ODE: the motion, the gaps, and the outputs frame_velocity (u^i), image (dPhi^i) and moved
        (dq^mu).

        Raises
        ------
        ShapeError
            the motion lacks a coordinate, or there are not n images.
        ExpressionError
            an image or a rate of the motion cannot be read, or a name has two meanings.

        Examples
        --------
        A top turns at a constant rate about its third axis:

        >>> from geomtorsion.ode import ODE, solve
        >>> from geomtorsion.spaces import load
        >>> bar = variation(load("so3").frame, "closed_in_image")
        >>> turning = ODE.of({"phi1": 1, "phi2": 0, "phi3": 0}, [0, 1, 0])
        >>> beside = bar.gap_ode(turning, ["sin(t)", 0, 0])
        >>> [beside.rates.expressions[name] for name in ("b1", "b2", "b3")]
        [b2, -b1 - sin(t), 0]
        >>> round(float(solve(beside, 2.0)["b2"][-1]), 6)
        -0.909297
        """
        gap = Gap(self.frame, self.images, self.gaps, self.gap_rates, self.coordinates)
        return gap.beside(motion, images, {} if parameters is None else parameters)

    @cached_property
    def proved(self) -> bool | None:
        """Whether `changes` follow from a variation of the path, decided by exact zero.

        delta (e^i_mu q'^mu) and d/dt (e^i_mu dq^mu) are computed by the chain rule and compared,
        with the gap added. False for the naive variation over an anholonomic frame.
        """
        verdicts = [value.is_zero for value in self._defects()]
        if False in verdicts:
            return False
        return None if None in verdicts else True

    def _defects(self) -> list[Element]:
        """delta (e q') as claimed minus as computed, with q' = E u and dq = E (dPhi + b)."""
        bundle = bundle_over(self.frame, [])
        field, frame = bundle.field, bundle.frame
        field.declare((*self.images, *self.image_rates, *self.gaps))
        u = bundle.velocities
        images, gaps = ([field.symbol(s) for s in row] for row in (self.images, self.gaps))
        changing = [field.symbol(s) for s in self.image_rates]
        claimed = frame.read([("change", value) for value in self.changes])
        if self.principle == "closed_in_image":
            images = [one + two for one, two in zip(images, gaps, strict=True)]
            gap_rates = frame.read([("gap", value) for value in self.gap_rates])
            changing = [one + two for one, two in zip(changing, gap_rates, strict=True)]
        rates, moves = bundle.rates(u), bundle.rates(images)
        defects = []
        for i, row in enumerate(frame.coframe.components.rows):
            terms: list = [(1, claimed[i]), (-1, changing[i])]
            for mu, value in row:
                slopes = [value.diff(symbol) for symbol in frame.coordinates]
                for nu, slope in enumerate(slopes):
                    terms += [(-1, slope, moves[nu], rates[mu]), (1, slope, rates[nu], moves[mu])]
            defects.append(field.sum(terms))
        return defects

    @property
    def text(self) -> str:
        """One line for each velocity.

        Examples
        --------
        >>> from geomtorsion.spaces import load
        >>> print(variation(load("so3").frame).text)
        delta u1 = dPhi1' - dPhi2*u3 + dPhi3*u2
        delta u2 = dPhi2' + dPhi1*u3 - dPhi3*u1
        delta u3 = dPhi3' - dPhi1*u2 + dPhi2*u1
        """
        lines = []
        for symbol, image, change in self._rows():
            rest = f" + {change}".replace("+ -", "- ") if change != 0 else ""
            lines.append(f"delta {symbol} = {image}'{rest}")
        return "\n".join(lines)

    @property
    def latex(self) -> str:
        """The same as aligned LaTeX."""
        named = {
            symbol: sp.Symbol(f"\\delta\\Phi_{{{k + 1}}}") for k, symbol in enumerate(self.images)
        }
        lines = []
        for symbol, image, change in self._rows():
            shown = latex_of(change.xreplace(named)) if change != 0 else ""
            rest = shown if shown.startswith("-") or not shown else f"+ {shown}"
            head = f"\\bar\\delta {latex_of(symbol)} &= \\frac{{d}}{{dt}} {named[image].name}"
            lines.append(f"{head} {rest}".rstrip())
        remark = assumption_latex(self.frame, self.changes)
        lines += [f"&{remark}"] * bool(remark)
        return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"

    def _rows(self) -> list[tuple[sp.Symbol, sp.Symbol, Any]]:
        """Velocity, image and the term added to the rate of the image."""
        pairs = zip(self.velocities, self.images, self.image_rates, self.changes, strict=True)
        return [(u, image, change - rate) for u, image, rate, change in pairs]

    def _repr_latex_(self) -> str:
        return f"$${self.latex}$$"

    _repr_html_ = drawn_by("notebook_tables", "equations_html")

    def __str__(self) -> str:
        remark = assumption_of(self.frame, self.changes)
        return f"{self.text}\n{remark}" if remark else self.text

    def __repr__(self) -> str:
        where = f" on {self.frame.name}" if self.frame.name else ""
        return f"variation {self.principle}{where}:\n{self}"


def variation(
    frame: FrameLike,
    principle: str = "closed_in_coordinates",
    connection: ConnectionLike | None = None,
) -> Variation:
    """How u^i = e^i_mu q'^mu changes under a variation of the path, derived from the frame.

    Equation
    --------
    delta-bar u^i = d/dt dPhi^i + 2 S_kj^i u^j dPhi^k          [FizievKleinert1994], (17)

    Parameters
    ----------
    principle
        "closed_in_coordinates" (Hamilton, Poincare), "closed_in_image" (Kleinert) or "naive".
    connection
        for closed_in_image: the connection whose torsion the image has; None: the Cartan connection
        of the frame.

    Raises
    ------
    UnknownNameError
        No principle has this name; the message names the nearest.
    ShapeError
        The connection belongs to another frame.

    Examples
    --------
    >>> from geomtorsion.spaces import load
    >>> bar = variation(load("r3xso3").frame)
    >>> bar.changes[3]
    -dPhi2*u6 + dPhi3*u5 + dPhi4dot - dPhi5*u3 + dPhi6*u2
    >>> bar.proved, variation(load("so3").frame, "naive").proved
    (True, False)
    """
    chosen = principle_named(principle)
    frame, connection = validation.checked_frame(frame, connection, complex_too=True)
    return Variation(frame, chosen.name, connection)


def _bilinear(
    table: Tensor, velocities: Sequence[sp.Symbol], images: Sequence[sp.Symbol]
) -> list[sp.Expr]:
    """t_kj^i u^j dPhi^k for each i."""
    terms: list[list[sp.Expr]] = [[] for _ in velocities]
    entries: Mapping[Any, Any] = table.nonzero()
    for (k, j, i), value in entries.items():
        terms[i].append(value * velocities[j] * images[k])
    return [sp.Add(*row) for row in terms]

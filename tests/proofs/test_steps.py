"""Steps: each bound of the method holds and is needed: without it the ball is wrong."""

# pyright: reportOptionalMemberAccess=false, reportRedeclaration=false

import pytest
from flint import arb, arb_mat, fmpq

import geomtorsion as gt
from geomtorsion.proofs import series, steps
from geomtorsion.proofs.series import BallSystem
from geomtorsion.proofs.steps import Method
from geomtorsion.support.precision import ball_precision
from tests.proofs.systems import end_of, one_step, system_of

POLE = {"x": "x**2"}
GROWTH = {"x": "x"}


def remainder_holds():
    """Whether P and its remainder contain 1 / (1 - t) at t = 1/8, with a polynomial of order 8."""
    step = one_step(POLE, [arb(1)], Method(8, 4), fmpq(1, 8), radius=0.3)
    with ball_precision(90):
        return step.middle(arb(step.length))[0].contains(arb(8) / 7)


def variation_holds():
    """Whether V contains exp(t), with a polynomial of order 4 over starts from 0.9 to 1.1."""
    step = one_step(GROWTH, [arb(1, 0.1)], Method(20, 6, -60), fmpq(3, 2))
    assert step.variation_order == 4
    with ball_precision(90):
        return step.variation(arb(step.length))[0, 0].contains(arb(1.5).exp())


def tube_holds():
    """Whether the tube contains the largest motion, 1.5 exp(3)."""
    step = one_step(GROWTH, [arb(1, 0.5)], Method(20, 6, -60), fmpq(3))
    with ball_precision(90):
        return step.tube[0].contains(1.5 * arb(3).exp())


def disk_holds():
    """Whether a disk ends before the branch point of x^(5/2), met at about t = -0.01."""
    step = one_step(
        {"x": "1+x**(5/2)"}, [arb(0.01)], Method(10, 4), fmpq(1, 1000), radius=0.1, bits=20
    )
    return step.radius < 0.0101


@pytest.mark.parametrize("holds", [remainder_holds, variation_holds, tube_holds, disk_holds])
def test_the_method_holds(holds):
    """Each bound contains a truth known in closed form."""
    assert holds()


def _no_growth(bound, time):
    n = bound.nrows()
    return arb_mat([[int(i == j) for j in range(n)] for i in range(n)])


def _not_analytic(monkeypatch):
    for name, code in (("rates_on", "_complex_rates"), ("slopes_on", "_complex_slopes")):
        place = 1 if name == "rates_on" else 2

        def unflagged(self, states, code=code, place=place):
            values = self._values()
            found = getattr(self, code)([*states, *values[0]], values[place], False)
            return found if place == 1 else [found[k] for k in self._entries]

        monkeypatch.setattr(BallSystem, name, unflagged)


@pytest.mark.parametrize(
    ("name", "mutation", "holds"),
    [
        ("defect_integral", lambda d, r, t, n: [arb(0)] * len(d), remainder_holds),
        ("defect_integral", "two orders more", remainder_holds),
        ("variation_tail", lambda share, order: arb(0), variation_holds),
        ("growth_of", _no_growth, variation_holds),
        ("growth_of", _no_growth, tube_holds),
    ],
)
def test_no_bound_is_idle(monkeypatch, name, mutation, holds):
    """Without a part of the method the same truth is missed."""
    plain = getattr(steps, name)
    if mutation == "two orders more":

        def mutation(defect, radius, time, order):
            return plain(defect, radius, time, order + 2)

    monkeypatch.setattr(steps, name, mutation)
    assert not holds()


def test_defects_are_bounded_where_rates_are_analytic(monkeypatch):
    """Without the flag `analytic` a disk crosses the branch point."""
    _not_analytic(monkeypatch)
    assert not disk_holds()


def test_taylor_coefficients_in_blocks():
    """Blocks of any length give overlapping coefficients."""
    system = system_of({"x": "v", "v": "-sin(x)*exp(x/3)+x*v"})
    with ball_precision(120):
        start = [arb(0.3), arb(-0.7)]
        plain, _ = series.taylor(system, start, 24, 24)
        for block in (1, 2, 3, 5, 7, 12):
            rows, _ = series.taylor(system, start, 24, block)
            for one, other in zip(plain, rows, strict=True):
                assert all(a.overlaps(b) for a, b in zip(one, other, strict=True))
                assert all(a.rad() < 1e-28 for a in other)


def test_the_variation_is_the_derivative_of_the_flow():
    """V agrees with difference quotients of motions from nearby starts."""
    rates = {"x": "v", "v": "-sin(x)+v*x/5"}
    step = one_step(rates, [arb(0.3), arb(-0.7)], Method(20, 6), fmpq(1, 2), bits=120)
    with ball_precision(120):
        found = step.variation(arb(step.length))
        tiny = arb(2) ** -40
        for j in range(2):
            start = [arb(0.3), arb(-0.7)]
            start[j] = start[j] + tiny
            one = end_of(rates, [0.3, -0.7], fmpq(1, 2), bits=120)
            other = end_of(rates, start, fmpq(1, 2), bits=120)
            for i in range(2):
                quotient = (other[i] - one[i]) / tiny
                assert abs(found[i, j] - quotient) < arb(2) ** -10


@pytest.mark.parametrize("rates", [{"x": "v", "v": "-sin(x)"}, {"x": "x*v", "v": "v-x*v"}])
def test_balls_of_all_methods_overlap(rates):
    """Other bits, orders, blocks and variations give balls with a common point."""
    start = [0.5, 1.25]
    methods = [Method(order, block, bits) for order in (12, 30, 60) for block in (4, 9)
               for bits in (4, 16)]  # fmt: skip
    found = [end_of(rates, start, 6, bits=bits) for bits in (70, 113, 200)]
    found += [end_of(rates, start, 6, bits=90, method=method) for method in methods]
    with ball_precision(250):
        for one in found:
            for other in found:
                assert all(a.overlaps(b) for a, b in zip(one, other, strict=True))


@pytest.mark.parametrize("end", [0.5, 10.0])
def test_a_start_at_which_forces_cancel(end):
    """v' = tanh(100 (x - 3/10)) - x is -a = -2/(e^140 + 1) at x = 1: x = 1 - a (1 - cos t)."""
    rates = {"x": "v", "v": "-x + tanh(100*(x - 3/10))"}
    proof = gt.prove(gt.solve(gt.ODE.of(rates, [1, 0]), end), 80)
    with ball_precision(400):
        x, v = proof.balls[-1]
        pull = 2 / (arb(140).exp() + 1)
        assert abs(x - 1 + pull * (1 - arb(end).cos())) < arb(10) ** -79
        assert (v + pull * arb(end).sin()).contains(0)

"""Systems: small equations in balls, and runs of them, for tests."""

# pyright: reportOptionalMemberAccess=false

from flint import arb, fmpq

from geomtorsion.codegen.balls import exact_ball
from geomtorsion.ode import ODE
from geomtorsion.proofs.motions import Leg, follow
from geomtorsion.proofs.series import BallSystem
from geomtorsion.proofs.sets import LOW_BITS, LohnerSet
from geomtorsion.proofs.steps import Method, Stepper
from geomtorsion.support.precision import ball_precision


def system_of(rates, **parameters):
    """Equations in balls."""
    problem = ODE.of(rates, [1] * len(rates), parameters=parameters)
    numbers = problem.run_numbers(problem.parameters)
    return BallSystem.of(problem.system, lambda: [exact_ball(x) for x in numbers])


def one_step(rates, start, method, length, *, radius=1.0, bits=53):
    """A step of a given length, longer than the automatic choice; None where it is not proved."""
    with ball_precision(bits):
        stepper = Stepper(system_of(rates), LohnerSet.of(start), method, bits)
        with ball_precision(LOW_BITS):
            return stepper.proved(stepper.best_disk(radius, 1.0), length)


def end_of(rates, start, time, *, bits=90, method=None):
    """Boxes of states at a time."""
    with ball_precision(bits):
        whole = LohnerSet.of([arb(x) for x in start])
        leg = Leg(system_of(rates), fmpq(0), fmpq(time), ())
        return follow(leg, whole, method or Method.of(bits)).whole.hull

"""Threads: many threads that use one frame at once get what a single thread gets."""

from __future__ import annotations

import os
import pickle
import random
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import flint
import mpmath
import numpy as np
import pytest
import sympy as sp
from sympy.core.function import AppliedUndef

import geomtorsion as gt
from geomtorsion import gravity
from geomtorsion.exact import Element
from geomtorsion.geometry.quantities import FRAME_QUANTITIES

THREADS = 8
# A thread that needs a result for longer than this waits for another that waits for it.
DEADLOCK = 300


@dataclass(frozen=True)
class Shared:
    """A frame that threads share, and what else they need.

    start, velocity, parameters: of motions. loop: a closed curve.
    """

    frame: gt.Frame
    start: Sequence[float] = ()
    velocity: Sequence[float] = ()
    parameters: Mapping[str, float] | None = None
    loop: gt.Loop | None = None


Question = Callable[[Shared], object]


def nested_roots() -> Shared:
    """A frame with nested roots, a logarithm and an exponential."""
    x, y, z = sp.symbols("x y z", positive=True)
    first = sp.sqrt(sp.sqrt(1 + x**2) + y)
    rows = [[first, 0, 0], [x, sp.exp(y), 0], [0, sp.log(1 + x), sp.cbrt(1 + z)]]
    return Shared(gt.Frame([x, y, z], rows, name="nested roots"))


def unknown_functions() -> Shared:
    """A frame with unknown functions of one and of two coordinates."""
    t, r, phi = sp.symbols("t r phi", positive=True)
    f, h = sp.Function("f", positive=True)(t, r), sp.Function("h", positive=True)(r)
    rows = [[f, 0, 0], [0, h, 0], [0, 0, r]]
    return Shared(gt.Frame([t, r, phi], rows, (-1, 1, 1), name="unknown functions"))


def kerr() -> Shared:
    """Kerr, with an orbit through a chart without singular axis."""
    frame = gt.spaces.load("kerr").frame
    return Shared(frame, (0, 8, 1.4, 0), (1.2, -0.1, 0.02, 0.05), {"M": 1, "a": 0.5})


def group() -> Shared:
    """SO(3), with a motion through several charts and a loop."""
    frame = gt.spaces.load("so3").frame
    loop = gt.Loop.circle([0.3, 1.0, 0.2], 0.1)
    return Shared(frame, (0.3, 1.0, 0.2), (1.0, 0.4, 2.0), None, loop)


def sphere() -> Shared:
    """The three-sphere, with a motion through several charts and a loop."""
    frame = gt.spaces.load("s3").frame
    loop = gt.Loop.circle([0.7, 1.0, 0.2], 0.1)
    return Shared(frame, (0.7, 1.0, 0.2), (1.0, 0.4, 2.0), None, loop)


def shipped(name: str) -> Callable[[], Shared]:
    """Maker of a shipped space."""
    return lambda: Shared(gt.spaces.load(name).frame)


MAKERS: dict[str, Callable[[], Shared]] = {
    "kerr": kerr,
    "so3": group,
    "s3": sphere,
    "kerr_newman": shipped("kerr_newman"),
    "taub_nut": shipped("taub_nut"),
    "frw": shipped("frw"),
    "screw_dislocation": shipped("screw_dislocation"),
    "unknown functions": unknown_functions,
    "nested roots": nested_roots,
}
# Here the order of the calculations decides which of several equal texts a tensor gets.
WRITTEN_IN_SEVERAL_WAYS = ("unknown functions", "nested roots")


def numbers(shared: Shared, tensor: gt.Tensor) -> str:
    """A tensor at a point in doubles and in 30 digits, each bit."""
    values = tensor.nonzero().values()
    unknown = {x for value in values for x in value.atoms(sp.Derivative, AppliedUndef)}
    point = dict(shared.frame.sample_point)
    point |= {x: sp.Rational(3, 7) + len(str(x)) for x in sorted(unknown, key=str)}
    long = [x.man_exp for x in np.ravel(tensor.at(point, digits=30))]
    return f"{tensor.at(point).tolist()!r} {long}"


def bits(ball: flint.arb) -> tuple[object, ...]:
    """Middle and radius of a ball, exactly; its text depends on the precision in use."""
    return ball.mid().man_exp(), ball.rad().man_exp()


def written(shared: Shared, tensor: gt.Tensor) -> str:
    """A tensor as text, as a formula and as components."""
    return f"{tensor!r} {tensor._repr_latex_()} {tensor.nonzero()} {tensor.certainty}"


def of_tensor(look: Callable[[Shared, gt.Tensor], str], name: str) -> Question:
    """A question for a quantity by its name."""
    return lambda shared: look(shared, shared.frame.quantity(name))


def curve(shared: Shared, problem: gt.curves.CurveProblem) -> str:
    """Each bit of a motion."""
    solution = gt.solve(problem, 3.0, 1e-9)
    return repr((solution.error, solution.coordinates.tolist(), solution.velocity.tolist()))


def geodesic(shared: Shared) -> str:
    """A geodesic."""
    start, velocity, values = shared.start, shared.velocity, shared.parameters
    return curve(shared, gt.geodesic(shared.frame, start, velocity, parameters=values))


def autoparallel(shared: Shared) -> str:
    """An autoparallel of the Cartan connection."""
    start, velocity, values = shared.start, shared.velocity, shared.parameters
    connection = gt.cartan(shared.frame)
    return curve(shared, gt.autoparallel(connection, start, velocity, parameters=values))


def proof(shared: Shared) -> str:
    """The balls of a short geodesic."""
    start, velocity, values = shared.start, shared.velocity, shared.parameters
    problem = gt.geodesic(shared.frame, start, velocity, parameters=values)
    balls = gt.prove(gt.solve(problem, 0.2, 1e-9)).balls
    return str([[bits(ball) for ball in row] for row in balls])


def burgers(shared: Shared) -> str:
    """Each bit of a Burgers vector, and its proved balls.

    FLINT keeps the nodes of its integrals for each thread, at the highest precision that was
    needed. The last digits of a ball depend on whether the nodes were already there.
    """
    assert shared.loop is not None
    result = gt.burgers_vector(shared.frame, shared.loop)
    balls = [(round(float(x.mid()), 15), f"{float(x.rad()):.1g}") for x in gt.prove(result).balls]
    return f"{result.vector.tolist()!r} {balls}"


def compiled(shared: Shared) -> str:
    """Values of a compiled tensor."""
    coframe, point = shared.frame.coframe, shared.frame.sample_point
    free = {x for value in coframe.nonzero().values() for x in value.atoms(AppliedUndef)}
    function = gt.numpy_function(coframe, [*point, *free])
    return repr(function(*map(float, point.values()), *(1.5 for _ in free)).tolist())


def copied(shared: Shared) -> str:
    """A tensor through pickle, compared with itself in its new frame."""
    torsion = pickle.loads(pickle.dumps(gt.cartan(shared.frame).torsion.T))
    return f"{torsion!r} {torsion == gt.cartan(torsion.frame).torsion.T}"


def symmetries(shared: Shared) -> str:
    """The Killing vectors."""
    found = gt.symmetries(shared.frame)
    return str(([vector.nonzero() for vector in found.closed_form], found.algebra.brackets()))


def equivalence(shared: Shared) -> str:
    """Independent invariants of the metric, and the verdict on a frame and itself."""
    result = gt.same_geometry(shared.frame, shared.frame, "legs")
    return f"{result.growth} {result}"


def field_equations(shared: Shared) -> str:
    """Einstein's equations, and equations of teleparallel gravity, also with an own invariant."""
    einstein = gravity.equations(gt.levi_civita(shared.frame), gravity.general_relativity)
    parallel = gravity.equations(gt.cartan(shared.frame), gravity.tegr)
    own = gravity.invariant("Own", "T_abc T^bca")
    bent = gravity.equations(gt.cartan(shared.frame), "f(Own)", invariants=own)
    return f"{einstein.E!r} {parallel.E!r} {bent.terms!r}"


def limits(shared: Shared) -> str:
    """Limit and series in a parameter or a coordinate."""
    frame = shared.frame
    symbol = (*frame.parameters, *frame.coordinates)[0]
    value = frame.sample_point[symbol]
    return f"{frame.metric.limit(symbol, value)!r} {frame.metric.series(symbol, value, 2)!r}"


def replaced(shared: Shared) -> str:
    """Torsion over the frame with a number for its first symbol."""
    frame = shared.frame
    if not frame.parameters:
        return str(gt.cartan(frame).torsion.T + gt.cartan(frame).torsion.T)
    values = {frame.parameters[0]: sp.Rational(1, 3)}
    # Equal values give the same frame, also to another thread, so that the tensors can be added.
    return repr(gt.cartan(frame).torsion.T.subs(values) + gt.cartan(frame.subs(values)).torsion.T)


MORE: dict[str, Question] = {
    "frame": lambda shared: repr(shared.frame),
    "identities": lambda shared: str(gt.identities(gt.cartan(shared.frame))),
    "forms": lambda shared: repr(gt.cartan(shared.frame).torsion_form()),
    "compiled": compiled,
    "limits": limits,
    "replaced": replaced,
    "copied": copied,
    "symmetries": symmetries,
    "equivalence": equivalence,
    "field equations": field_equations,
}
MOTIONS: dict[str, Question] = {"geodesic": geodesic, "autoparallel": autoparallel, "proof": proof}


def questions(name: str, shared: Shared) -> dict[str, Question]:
    """Quantities of a space by name."""
    looks = {"numbers": numbers}
    others: dict[str, Question] = {}
    if name not in WRITTEN_IN_SEVERAL_WAYS:
        looks["written"] = written
        others = MORE | (MOTIONS if shared.start else {})
        others |= {"burgers": burgers} if shared.loop else {}
    tensors = {
        f"{q} {how}": of_tensor(look, q) for q in FRAME_QUANTITIES for how, look in looks.items()
    }
    return {**tensors, **others}


def answer(ask: Question, shared: Shared) -> str:
    """The answer as text, or the refusal."""
    try:
        return str(ask(shared))
    except gt.GeomtorsionError as error:
        return f"{type(error).__name__}: {error}"


def answers(name: str, shared: Shared, seed: int, share: int = 1) -> dict[str, str]:
    """The answers to all questions, or to one in `share` of them, in an order of the seed."""
    asked = list(questions(name, shared).items())
    random.Random(seed).shuffle(asked)
    return {key: answer(ask, shared) for key, ask in asked[: len(asked) // share]}


def in_threads(work: Callable[[int], object], count: int = THREADS) -> list[object]:
    """The results of work(0), work(1) ..., each in a thread of its own; all begin at once."""
    results: dict[int, object] = {}
    begin = threading.Barrier(count)

    def run(number: int) -> None:
        begin.wait()
        try:
            results[number] = work(number)
        except BaseException as error:  # noqa: BLE001  # a thread of its own has no other reader
            results[number] = error

    threads = [threading.Thread(target=run, args=(k,), daemon=True) for k in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(DEADLOCK)
    assert not any(thread.is_alive() for thread in threads), "threads wait for each other"
    return [results[k] for k in range(count)]


@pytest.fixture(autouse=True)
def hasty() -> Iterator[None]:
    """Threads take turns after a few steps of Python; no precision is left changed."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    precisions = mpmath.mp.prec, flint.ctx.prec
    yield
    sys.setswitchinterval(before)
    assert precisions == (mpmath.mp.prec, flint.ctx.prec)


def differing(name: str, seed: int, share: int = 1) -> dict[str, tuple[str, str]]:
    """Questions with another answer in some thread than in a single one: both answers."""
    single = answers(name, MAKERS[name](), seed)
    shared = MAKERS[name]()
    wrong = {}
    for own in in_threads(lambda k: answers(name, shared, 100 * seed + k, share)):
        assert isinstance(own, dict), own
        wrong |= {key: (single[key], own[key]) for key in own if own[key] != single[key]}
    return wrong


# Some 20 s of processor time in all; the long run asks everything of each thread, several times.
# The other spaces are asked in the slow test below.
@pytest.mark.parametrize(
    "name",
    [
        pytest.param("kerr", marks=pytest.mark.slow),
        "so3", "s3", "unknown functions", "nested roots",
    ],
)  # fmt: skip
def test_threads_that_share_a_frame(name: str) -> None:
    """Each of eight threads asks a quarter of all questions, and gets what one thread gets."""
    assert differing(name, 1, share=4) == {}


@pytest.mark.slow
@pytest.mark.parametrize("name", MAKERS)
def test_many_runs_of_threads(name: str) -> None:
    """The same with all questions, several times, each time with a new frame."""
    for seed in range(2, 8):
        assert differing(name, seed) == {}


def test_two_frames_in_opposite_order() -> None:
    """Rules of one frame that read another frame, and the other way around, end."""
    frames = [gt.spaces.load(name).frame for name in ("s2", "flat_polar")]

    def scalar(own: int) -> str:
        """A scalar over one frame that is made from a quantity of the other."""

        def rule() -> Element:
            (element,) = frames[own].read([("other", len(repr(frames[1 - own].anholonomy)))])
            return element

        return str(frames[own].scalar(rule).element())

    results = in_threads(lambda k: scalar(k % 2))
    assert set(results[::2]) == {scalar(0)}
    assert set(results[1::2]) == {scalar(1)}


def test_reading_is_not_interrupted() -> None:
    """While a thread reads expressions into a field, which grows, no other does exact work."""
    field, ball = gt.spaces.load("s3").frame.field, gt.spaces.load("s2").frame
    other = threading.Thread(target=lambda: repr(ball.metric), daemon=True)
    waits = []

    def entries() -> Iterator[tuple[str, sp.Expr]]:
        other.start()
        other.join(0.5)
        waits.append(other.is_alive())
        yield "entry", sp.Integer(1)

    assert field.read_all(entries()) == [field.one]
    assert waits == [True]
    other.join(DEADLOCK)
    assert not other.is_alive()


def test_a_limit_ends_the_wait_for_another_thread() -> None:
    """A block with a limit does not wait longer for exact work of another thread."""
    begun, finish = threading.Event(), threading.Event()
    frame = gt.spaces.load("s2").frame

    def slow() -> Element:
        begun.set()
        finish.wait(DEADLOCK)
        return frame.field.one

    other = threading.Thread(target=frame.scalar(slow).element, daemon=True)
    other.start()
    begun.wait(DEADLOCK)
    with pytest.raises(gt.errors.AllowanceError), gt.limits(seconds=0.2):
        repr(gt.spaces.load("so3").frame.metric)
    finish.set()
    other.join(DEADLOCK)
    assert repr(frame.metric).startswith("metric")


@pytest.mark.parametrize("error", [KeyboardInterrupt, gt.errors.AllowanceError, ZeroDivisionError])
def test_an_error_frees_the_frame(error: type[BaseException]) -> None:
    """After an error, Ctrl-C included, within exact work other threads can use the frame."""
    frame = gt.spaces.load("s2").frame

    def broken() -> Element:
        raise error("stopped")

    with pytest.raises(error):
        frame.scalar(broken).element()
    assert in_threads(lambda _: repr(frame.metric), 2) == [repr(frame.metric)] * 2


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_fork_during_exact_work_of_another_thread() -> None:
    """A child of a process whose other threads do exact work can use their frame."""
    shared, stop = kerr(), threading.Event()

    def work() -> None:
        while not stop.is_set():
            repr(gt.levi_civita(gt.spaces.load("kerr").frame).curvature.kretschmann)

    other = threading.Thread(target=work, daemon=True)
    other.start()
    try:
        for _ in range(5):
            child = os.fork()
            if not child:
                signal.alarm(DEADLOCK)
                os._exit(0 if repr(shared.frame.metric).startswith("metric") else 1)
            assert os.waitpid(child, 0)[1] == 0
    finally:
        stop.set()
        other.join(DEADLOCK)

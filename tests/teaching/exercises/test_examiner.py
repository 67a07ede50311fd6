"""The examiner: checks in a process of its own, with a time limit."""

import pytest

from geomtorsion import exercises
from geomtorsion.teaching.exercises import examiner as module
from geomtorsion.teaching.exercises.examiner import Examiner, reply
from geomtorsion.teaching.exercises.worker_pool import Worker, WorkerPool


def processes(examiner: Examiner) -> set[Worker]:
    """The processes of an examiner, on a platform that has them."""
    assert isinstance(examiner.pool, WorkerPool)
    return examiner.pool.workers


def test_the_examiner_returns_the_verdict_of_the_exercise():
    """The verdict of the process equals the verdict of the exercise."""
    with Examiner() as examiner:
        for answer in ("cot(phi2)", "-cot(phi2)", "sin("):
            there = examiner.check("3.2", answer)
            assert there == exercises.load("3.2").check({"christoffel": answer})


def test_an_answer_that_does_not_end_is_ended():
    """The process is killed, the answer counts as too large, and the next answer is checked."""
    with Examiner(seconds=30) as examiner:
        assert examiner.check("3.2", "cot(phi2)").right
        [first] = processes(examiner)
        # A time limit of 0 s has the effect of an endless answer.
        examiner.seconds = 0.0
        verdict = examiner.check("3.2", "cot(phi2)")
        assert verdict["christoffel"].diagnosis == "too large"
        assert "longer than 0 s" in verdict["christoffel"].message
        assert not first.lives
        examiner.seconds = 30
        assert examiner.check("3.2", "cot(phi2)").right
        assert first not in processes(examiner)


class Slow:
    """A pool that simulates the durations of replies without waiting."""

    def __init__(self, prepares, checks):
        self.prepares, self.checks = prepares, checks

    def ask(self, request, seconds):
        """The reply, unless its duration exceeds the limit."""
        if (self.checks if "answers" in request else self.prepares) > seconds:
            raise TimeoutError
        return reply(request)


@pytest.mark.parametrize(
    ("prepares", "checks", "words"),
    [(110, 9.5, "Right"), (130, 9.5, "the solution took too long"), (110, 10.5, "than 10 s")],
)
def test_time_limits_of_the_examiner(prepares, checks, words, monkeypatch):
    """Preparation has two minutes, which is not the student's fault; the check has ten seconds."""
    monkeypatch.setattr(module, "WorkerPool", lambda _: Slow(prepares, checks))
    assert words in Examiner().check("3.2", "cot(phi2)")["christoffel"].message


def test_modules_among_the_answers_are_not_imported(tmp_path, monkeypatch):
    """A sympy.py in the folder of answers is not imported, although the grader runs there."""
    for name in ("sympy", "flint", "json", "geomtorsion"):
        (tmp_path / f"{name}.py").write_text(f"open('{tmp_path}/ran', 'w').write('x')", "utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("PYTHONPATH", raising=False)
    with Examiner() as examiner:
        assert examiner.check("3.2", "cot(phi2)").right
    assert not (tmp_path / "ran").exists()


def test_a_process_that_dies_costs_one_answer():
    """After a process is killed, the next answer is checked."""
    with Examiner() as examiner:
        assert examiner.check("3.2", "cot(phi2)").right
        [worker] = processes(examiner)
        worker.process.process.kill()
        worker.process.process.wait()
        assert examiner.check("3.2", "cot(phi2)").right
    assert not processes(examiner)

"""examiner: checks answers in another process, which is ended if an answer takes too long."""

from __future__ import annotations

from collections.abc import Mapping
from types import TracebackType

from geomtorsion.teaching.exercises.exercise import Exercise
from geomtorsion.teaching.exercises.registry import Own, load
from geomtorsion.teaching.exercises.verdict import QuestionVerdict, Verdict
from geomtorsion.teaching.exercises.worker_pool import EXCEEDED, STARTING, Json, WorkerPool
from geomtorsion.teaching.messages import in_language
from geomtorsion.teaching.texts import ENGLISH, Language, texts

# Far more than a right answer takes.
SECONDS = 10.0


class Examiner:
    """Checks answers within a time; a context manager.

    seconds: time limit for the answers to one exercise. At the limit the process is ended, the
    answers count as too large, and the next answers get a new process.
    function: called by the process with each request; it may handle more requests than `reply`.

    Examples
    --------
    >>> with Examiner() as examiner:
    ...     examiner.check("3.2", {"christoffel": "1/tan(phi2)"}).right
    True
    """

    def __init__(self, seconds: float = SECONDS, function: str = f"{__name__}:reply") -> None:
        self.seconds = seconds
        self.pool = WorkerPool(function)

    def __enter__(self) -> Examiner:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.pool.close()

    def check(
        self,
        number: str,
        answers: object,
        seed: int = 0,
        language: Language = ENGLISH,
        chapter: Own = None,
    ) -> Verdict:
        """The verdict on the answers to an exercise, within the time; see `Exercise.check`.

        Raises
        ------
        UnknownNameError
            There is no such exercise, seed or language.
        """
        exercise = load(number, seed, language, chapter)
        by_question, _ = exercise.arranged(answers)
        request = {"number": number, "seed": seed, "language": exercise.language}
        if exercise.folder:
            request["chapter"] = exercise.folder
        try:
            # The time for the library's own solution is not charged to the student; the process
            # keeps the solution, so that only the first student waits for it.
            self.pool.ask(request, STARTING)
        except (TimeoutError, ChildProcessError):
            return _unchecked(
                exercise,
                by_question,
                "computing the solution took too long or too much memory. This does not depend on "
                "your answer. Try again later.",
            )
        answer = self.ask(request | {"answers": answers}, self.seconds)
        if isinstance(answer, str):
            return _unchecked(exercise, by_question, f"{answer}. Write a shorter answer.")
        return Verdict.from_json(answer["verdict"])

    def ask(self, request: Json, seconds: float) -> Json | str:
        """The reply of the process, or the reason in words why there is none."""
        try:
            answer = self.pool.ask(request, seconds)
        except TimeoutError:
            return f"it took longer than {seconds:g} s"
        except ChildProcessError as error:
            return str(error)
        return f"it needed too much {answer[EXCEEDED]}" if EXCEEDED in answer else answer


def _unchecked(exercise: Exercise, answers: Mapping[str, object], reason: str) -> Verdict:
    """The verdict on answers that could not be checked."""
    verdicts, text = [], texts("feedback", "checking", exercise.language)
    reason = in_language(reason, exercise.language)
    for question in exercise.questions:
        is_answered = question.name in answers
        code = "too large" if is_answered else "empty"
        note = text("unchecked", reason=reason) if is_answered else text("empty")
        verdicts.append(QuestionVerdict(question.name, False, 0.0, note, code, (), question.points))
    return Verdict(exercise.number, exercise.seed, tuple(verdicts), (), exercise.language)


def reply(request: Json) -> Json:
    """The reply of the process: a verdict, or a note that the solution is now available."""
    language, chapter = request.get("language", ENGLISH), request.get("chapter")
    exercise = load(request["number"], request["seed"], language, chapter)
    if "answers" not in request:
        _ = exercise.solution()
        return {"prepared": True}
    return {"verdict": exercise.check(request["answers"]).to_json()}

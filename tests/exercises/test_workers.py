"""Workers: processes where there are some, this very process in a browser."""

from geomtorsion.exercises.worker_pool import WorkerPool
from geomtorsion.exercises.workers import InPlace, workers

EXAMINER = "geomtorsion.exercises.examiner:reply"


def deep(_: object) -> object:
    """A request that needs more depth than there is."""
    raise RecursionError


def large(_: object) -> object:
    """A request that needs more memory than there is."""
    raise MemoryError


def test_a_platform_decides():
    """Browsers have no processes."""
    for platform, kind in (("linux", WorkerPool), ("win32", WorkerPool), ("emscripten", InPlace)):
        found = workers(EXAMINER, platform=platform)
        assert isinstance(found, kind)
        found.close()


def test_both_give_the_same():
    """One request, carried out by a process and in place."""
    request = {"number": "3.2", "seed": 0, "answers": {"christoffel": "1/tan(phi2)"}}
    replies = []
    for platform in ("linux", "emscripten"):
        found = workers(EXAMINER, platform=platform)
        replies.append(found.ask(request, 60))
        found.close()
    assert replies[0] == replies[1]
    assert [one["right"] for one in replies[0]["verdict"]["questions"]] == [True]


def test_limits_are_told_in_place_too():
    """As the processes tell them."""
    assert InPlace(f"{__name__}:deep").ask({}, 1) == {"exceeded": "depth"}
    assert InPlace(f"{__name__}:large").ask({}, 1) == {"exceeded": "memory"}


def test_requests_are_answered_before_they_are_asked():
    """In place that is at once."""
    seen = []
    InPlace(EXAMINER).warm([{"number": "1.1", "seed": 0}], lambda *pair: seen.append(pair))
    assert seen == [({"number": "1.1", "seed": 0}, {"prepared": True})]

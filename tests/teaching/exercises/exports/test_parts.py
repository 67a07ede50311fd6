"""Parts: mistakes of several variants side by side, and answers with half of the components."""

from geomtorsion import exercises
from geomtorsion.teaching.exercises.exports.parts import MISSING, parts_of


def test_each_variant_has_one_mistake_per_slot():
    """A slot has one mistake per variant; a slot that a variant lacks is MISSING and not tested."""
    group = [exercises.load("1.1", seed) for seed in range(4)]
    [part] = parts_of(group)
    tables = dict(part.variables())
    for variant, exercise in enumerate(group):
        held = [slot for slot in part.slots if slot.mistakes[variant] is not None]
        assert len(held) == len(exercise.questions[0].mistakes)
        for slot in part.slots:
            missing = tables[slot.variable][variant] == MISSING
            assert missing == (slot.mistakes[variant] is None)
            assert not (missing and slot.tested)
    assert len({slot.note for slot in part.slots}) == len(part.slots)


def test_half_of_a_symmetric_answer():
    """Zeros are filled in from the other half; mistakes without symmetry are compared as typed."""
    [part] = parts_of([exercises.load("2.3")])[:1]
    assert part.given == "full1"
    assert "-given1" in "".join(part.feedback_variables())
    lacking = [slot for slot in part.slots if part.compared(slot) == "given1"]
    assert lacking
    assert len(lacking) < len(part.slots)


def test_fields():
    """One field for each unknown, for each first index of three, and for a matrix."""
    fields = {
        number: [part.inputs for part in parts_of([exercises.load(number)])]
        for number in ("4.3", "1.3", "1.2", "3.1")
    }
    assert fields == {
        "4.3": [("ans1", "ans2")],
        "1.3": [("ans1", "ans2", "ans3"), ("ans4",)],
        "1.2": [("ans1",), ("ans2",)],
        "3.1": [("ans1",), ("ans2",), ("ans3",)],
    }

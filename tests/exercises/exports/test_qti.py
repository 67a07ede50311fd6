"""QTI: items and manifest of a package, and their response processing carried out."""

import re
from collections.abc import Mapping
from functools import cache
from math import isclose
from xml.etree import ElementTree as ET

import pytest

from geomtorsion import exercises
from geomtorsion.exercises.exports.qti import DECIDED, ITEM, PACKAGE, item_files, spelling
from geomtorsion.exercises.exports.tasks import tasks
from geomtorsion.exercises.question import deviation

NUMBERS = exercises.names()
SEEDS = (0, 1)
Q = f"{{{ITEM}}}"
# The order in which an item has its parts.
PARTS = ["responseDeclaration", "outcomeDeclaration", "itemBody", "responseProcessing",
         "modalFeedback"]  # fmt: skip


@cache
def exported(number: str) -> dict[int, ET.Element]:
    """Seed -> item."""
    files = item_files(tasks([number], SEEDS))
    items = {name: text for name, text in files.items() if name.startswith("items/")}
    return {
        int(name.removesuffix(".xml").rpartition("seed")[2]): ET.fromstring(text)
        for name, text in items.items()
    }


# -- response processing, as QTI 2.1 describes it ------------------------------------------------


def value_of(rule: ET.Element, variables: Mapping[str, object]) -> object:
    """The value of an expression of response processing."""
    kind = rule.tag.removeprefix(Q)
    if kind == "variable":
        return variables[rule.attrib["identifier"]]
    if kind == "baseValue":
        return float(rule.text or "") if rule.attrib["baseType"] == "float" else rule.text
    parts = [value_of(part, variables) for part in rule]
    if kind == "isNull":
        return parts[0] is None
    if kind == "or":
        return any(parts)
    if kind == "and":
        return all(parts)
    if kind == "match":
        return parts[0] == parts[1]
    if kind == "equal":
        assert rule.attrib["toleranceMode"] == "absolute"
        one, two = parts
        assert isinstance(one, float)
        assert isinstance(two, float)
        return abs(one - two) <= float(rule.attrib["tolerance"])
    if kind == "patternMatch":
        return re.fullmatch(rule.attrib["pattern"], str(parts[0])) is not None
    if kind == "sum":
        return sum(part for part in parts if isinstance(part, float))
    assert kind == "multiple", kind
    return [x for part in parts for x in (part if isinstance(part, list) else [part])]


def processed(item: ET.Element, responses: Mapping[str, object]) -> tuple[float, list[str]]:
    """Score and what is said, for responses."""
    variables: dict[str, object] = {"SCORE": 0.0, "FEEDBACK": []}
    for declared in item.findall(f"{Q}responseDeclaration"):
        variables[declared.attrib["identifier"]] = responses.get(declared.attrib["identifier"])
    for condition in item.findall(f"{Q}responseProcessing/{Q}responseCondition"):
        for branch in condition:
            test, *actions = list(branch)
            if branch.tag == f"{Q}responseElse":
                actions = list(branch)
            elif not value_of(test, variables):
                continue
            for action in actions:
                variables[action.attrib["identifier"]] = value_of(action[0], variables)
            break
    score, said = variables["SCORE"], variables["FEEDBACK"]
    assert isinstance(score, float)
    assert isinstance(said, list)
    return score, said


def correct(item: ET.Element) -> dict[str, object]:
    """The right responses, as the item declares them."""
    found: dict[str, object] = {}
    for declared in item.findall(f"{Q}responseDeclaration"):
        text = declared.findtext(f"{Q}correctResponse/{Q}value") or ""
        is_number = declared.attrib["baseType"] == "float"
        found[declared.attrib["identifier"]] = float(text) if is_number else text
    return found


def answered(question, names: list[str], responses: Mapping[str, object], item) -> str:
    """Responses to a question as an answer that the library reads."""
    if question.kind == "choice":
        for choice in item.iter(f"{Q}simpleChoice"):
            place = int(choice.attrib["identifier"].removeprefix("CHOICE_"))
            if choice.attrib["identifier"] == responses[names[0]]:
                return list(question.options)[place - 1]
    values = [str(responses[name]) for name in names]
    return values[0] if not question.shape or question.kind != "number" else str(values)


def names_of(item: ET.Element, place: int) -> list[str]:
    """The response variables of a question."""
    names = [x.attrib["identifier"] for x in item.findall(f"{Q}responseDeclaration")]
    return [name for name in names if re.fullmatch(rf"RESPONSE_{place}(_[0-9]+)?", name)]


def mistaken(item: ET.Element, place: int, number: int) -> dict[str, object]:
    """Responses that are a mistake, read from the test of its branch."""
    for branch in item.iter(f"{Q}responseElseIf"):
        said = [x.text for x in branch.iter(f"{Q}baseValue")]
        if f"MISTAKE_{place}_{number}" not in said:
            continue
        found: dict[str, object] = {}
        tests = branch[0] if branch[0].tag == f"{Q}and" else [branch[0]]
        for test in tests:
            name = test[0].attrib["identifier"]
            if test.tag == f"{Q}patternMatch":
                found[name] = plain(test.attrib["pattern"])
            else:
                found[name] = value_of(test[1], {})
        return found
    raise AssertionError(f"no branch for mistake {number} of question {place}")


def plain(pattern: str) -> str:
    """One of the texts that a pattern describes."""
    text = pattern.replace(r"\s*", "").replace(r"(\^|\*\*)", "^")
    return re.sub(r"(?<!\\)\[(?:\\)?(.)[^\]]*\]", r"\1", text).replace("\\", "")


@pytest.mark.parametrize("number", NUMBERS)
def test_round_trip(number):
    """The declared responses earn all points and are right; those of each mistake are it."""
    for seed, item in exported(number).items():
        asked = exercises.load(number, seed).questions
        right = correct(item)
        points = sum(question.points for question in asked)
        score, said = processed(item, right)
        assert score == points
        assert said == [f"RIGHT_{place}" for place in range(1, len(asked) + 1)]
        for place, question in enumerate(asked, 1):
            names = names_of(item, place)
            text = answered(question, names, right, item)
            verdict = exercises.check(number, {question.name: text}, seed)[question.name]
            assert verdict.right, (seed, text, verdict)
            for k, mistake in enumerate(question.mistakes, 1):
                wrong = mistaken(item, place, k)
                text = answered(question, names, wrong, item)
                verdict = exercises.check(number, {question.name: text}, seed)[question.name]
                assert mistake.code in verdict.codes, (seed, text, verdict)
                score, said = processed(item, right | wrong)
                assert score == points - question.points
                first = next(
                    j
                    for j, other in enumerate(question.mistakes, 1)
                    if other.value == mistake.value
                    or (question.kind == "number"
                        and deviation(question, mistake.value, other.value) <= 1)
                )  # fmt: skip
                assert said[place - 1] == f"MISTAKE_{place}_{first}"


@pytest.mark.parametrize("number", NUMBERS)
def test_an_item_is_built_as_qti_says(number):
    """Parts in their order, declared before they are used, and no identifier twice."""
    for seed, item in exported(number).items():
        assert item.tag == f"{Q}assessmentItem"
        assert {"identifier", "title", "adaptive", "timeDependent"} <= set(item.attrib)
        tags = [part.tag.removeprefix(Q) for part in item]
        assert tags == sorted(tags, key=PARTS.index)
        assert tags.count("itemBody") == tags.count("responseProcessing") == 1
        declared = [x.attrib["identifier"] for x in item.findall(f"{Q}responseDeclaration")]
        fields = [x.attrib["responseIdentifier"] for x in item.iter() if "responseIdentifier"
                  in x.attrib]  # fmt: skip
        assert fields == declared
        shown = [x.attrib["identifier"] for x in item.findall(f"{Q}modalFeedback")]
        assert len(shown) == len(set(shown))
        said = {x.text for x in item.iter(f"{Q}baseValue")
                if x.attrib["baseType"] == "identifier"
                and not (x.text or "").startswith(("CHOICE", "EMPTY"))}  # fmt: skip
        assert said == set(shown)
        inside = {part.tag for formula in item.iter("{http://www.w3.org/1998/Math/MathML}math")
                  for part in formula.iter()}  # fmt: skip
        assert all(tag.startswith("{http://www.w3.org/1998/Math/MathML}") for tag in inside)
        for pattern in (x.attrib["pattern"] for x in item.iter(f"{Q}patternMatch")):
            # What XML Schema lets a backslash stand before.
            assert set(re.findall(r"\\(.)", pattern)) <= set(r"s\|.?*+(){}[]^-")
        asked = exercises.load(number, seed).questions
        told = [x for x in item.iter(f"{Q}rubricBlock") if x.attrib["view"] == "scorer"]
        assert len(told) == sum(question.kind not in DECIDED for question in asked)


def test_the_manifest_lists_the_items():
    """Each item with its type, under the path at which it stands."""
    files = item_files(tasks(["3.1", "3.2"], SEEDS))
    manifest = ET.fromstring(files["imsmanifest.xml"])
    assert manifest.tag == f"{{{PACKAGE}}}manifest"
    rows = list(manifest.iter(f"{{{PACKAGE}}}resource"))
    assert {row.attrib["type"] for row in rows} == {"imsqti_item_xmlv2p1"}
    assert {"imsmanifest.xml", *(row.attrib["href"] for row in rows)} == set(files)


def test_what_qti_cannot_grade_is_left():
    """Another form of the solution earns nothing, and the item says that a person decides."""
    item = exported("3.2")[0]
    for text in ("cot(phi2)", "1/tan(phi2)"):
        assert processed(item, {"RESPONSE_1": text}) == (0.0, ["LEFT_1"])
    assert processed(item, {"RESPONSE_1": " cos( phi2 ) / sin(phi2)"}) == (1.0, ["RIGHT_1"])
    assert processed(item, {}) == (0.0, ["EMPTY_1"])
    [left] = [x for x in item.findall(f"{Q}modalFeedback") if x.attrib["identifier"] == "LEFT_1"]
    assert "decided by a person" in "".join(left.itertext())
    [rubric] = item.iter(f"{Q}rubricBlock")
    assert "geomtorsion exercises check 3.2 --seed 0" in "".join(rubric.itertext())


def test_numbers_are_graded_within_their_tolerance():
    """On both sides of it; rounded too early is said."""
    item = exported("4.4")[0]
    right = correct(item)
    value = right["RESPONSE_1"]
    assert isinstance(value, float)
    assert isclose(value, 1.317344702, rel_tol=1e-9)
    for factor, told in {1.0009: "RIGHT_1", 1.0011: "ROUNDED_1", 1.2: "WRONG_1"}.items():
        assert processed(item, right | {"RESPONSE_1": value * factor})[1][0] == told


def test_spellings():
    """Spaces, several signs for products, powers and minus; nothing else."""
    pattern = spelling("1,1 = -2*r'^2; 2,2 = sin(r)")
    for text in ("1,1=−2·r′**2;2,2=sin(r)", " 1 , 1 = - 2 * r' ^ 2 ; 2,2 = sin( r ) "):
        assert re.fullmatch(pattern, text), text
    for text in ("1,1 = 2*r'^2; 2,2 = sin(r)", "2,2 = sin(r); 1,1 = -2*r'^2", ""):
        assert not re.fullmatch(pattern, text), text


def test_the_reader_undoes_patterns():
    """What the tests above read from a pattern is a spelling of it."""
    for text in ("-r^2*x", "[1, 2]", "1,1 = a - b; 2,1 = 3*phi'"):
        assert re.fullmatch(spelling(text), plain(spelling(text)))


def test_a_converter_reads_the_package(tmp_path):
    """A package for QTI takes items and manifest to QTI 3 and back, with every declaration."""
    converter = pytest.importorskip("qti_convert")
    numbers = ("1.4", "3.1", "5.3")
    exercises.export("qti", tmp_path, numbers)
    found = converter.upgrade_package(tmp_path / "geomtorsion-qti21.zip", tmp_path / "three.zip")
    items = [text for name, text in found.files.items() if name.startswith("items/")]
    assert len(items) == len(numbers)
    for text in items:
        assert "<qti-response-processing>" in text
        assert "<qti-item-body>" in text
    back = converter.downgrade_package(tmp_path / "three.zip", tmp_path / "two.zip")
    # QTI 3 says of a rubric what it is used for; nothing else is lost.
    assert {warning.code for warning in back.warnings} <= {"removed-attribute"}

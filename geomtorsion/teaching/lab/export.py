"""export: the pages of the lab as files that need no server, for the web site of a course."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import partial
from html import escape
from os import PathLike
from pathlib import Path
from shlex import quote

from geomtorsion.pictures.formula import FONT_SOURCE, font_face
from geomtorsion.pictures.text import greek_name
from geomtorsion.support import checks
from geomtorsion.support.files import write_texts
from geomtorsion.teaching.exercises.chapter_folder import load_folder
from geomtorsion.teaching.exercises.prose import html_of
from geomtorsion.teaching.exercises.registry import Own
from geomtorsion.teaching.exercises.worker_pool import Json
from geomtorsion.teaching.lab import guides, views
from geomtorsion.teaching.lab.controls import path_case
from geomtorsion.teaching.lab.space_info import space_info, space_titles
from geomtorsion.teaching.lab.tasks import task
from geomtorsion.teaching.texts import ENGLISH, Language, code_of, language_name, texts

Progress = Callable[[str], object]
# This policy forbids the browser to load anything.
POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; "
)
POLICY += FONT_SOURCE
TETRADS = ("so3", "flat_polar", "s2", "heisenberg", "schwarzschild")
COURSES = (70, 75, 80, 90, 100)
LOOPS = ("so3", "heisenberg", "s2")
RADII = (1e-9, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7)
# Space and moments of inertia.
PATHS: tuple[tuple[str, tuple[float, ...]], ...] = (
    ("r3xso3", ()), ("so3", (1, 2, 3)), ("s2", ()), ("flat_polar", ()), ("heisenberg", ()),
)  # fmt: skip
TOPS: Mapping[str, Json] = {
    "tumbling": {"moments": (1, 2, 3), "omega": (0.1, 2, 0.1), "tilt": 0.3, "t": 12},
    "symmetric": {"moments": (2, 2, 1), "omega": (1, 0, 2), "tilt": 0.3, "t": 12},
    "heavy": {
        "moments": (0.5, 0.5, 0.9), "omega": (0, 0, 8), "tilt": 0.5, "t": 8,
        "effects": ("gravity", "pivot"),
    },
    "wheel": {
        "moments": (1, 2, 3), "omega": (0.1, 2, 0.1), "tilt": 0.3, "t": 12, "effects": ("rotor",),
    },
}  # fmt: skip
_SLIDE = """
for (const slider of document.querySelectorAll("input[data-slides]")) {
  const slides = document.getElementById(slider.dataset.slides).children;
  const show = () => [...slides].forEach((e, k) => { e.hidden = k !== Number(slider.value); });
  slider.addEventListener("input", show);
  show();
}
"""
_BODY = """
body { margin: 0; background: #fff; color-scheme: light dark; }
@media (prefers-color-scheme: dark) { body { background: #16191f; } }
main { max-width: 72rem; margin: 0 auto; padding: 1rem; }
.lab nav { display: flex; flex-wrap: wrap; gap: 0.3rem 1rem; margin: 0.4rem 0 1rem; }
.lab label { display: flex; gap: 0.8rem; align-items: center; margin: 0.4rem 0; }
.lab input[type="range"] { flex: 1; max-width: 30rem; accent-color: #1f5fa8; }
"""


def write_pages(
    directory: str | PathLike[str],
    progress: Progress = lambda _: None,
    language: Language = ENGLISH,
    chapter: Own = None,
) -> tuple[Path, ...]:
    """Write index.html and a page for each tab; return their paths, the index first.

    The pages show computed cases. They check no answers and read no tetrads. They contain
    everything: style, pictures, mathematics (MathML) and the scripts that turn pictures and move
    sliders. Writing starts after all computations. language: of the texts.
    chapter: the folder of a teacher's chapter, whose exercises come last.
    """
    directory = checks.file_name(directory, "directory")
    own = None if chapter is None else load_folder(chapter).folder
    return write_texts(directory, pages(progress, language_name(language), own))


def pages(
    progress: Progress = lambda _: None, language: str = ENGLISH, chapter: str | None = None
) -> dict[str, str]:
    """File name -> page, the index first."""
    makers = {
        guides.COMPASS: compass, guides.LOOPS: loops, guides.PATHS: curves, guides.TOP: tops,
        guides.COSTS: cost_tables, guides.TETRAD: tetrads,
        guides.EXERCISES: partial(exercises, chapter=chapter),
    }  # fmt: skip
    contents = {}
    tabs = {name: guides.tab(name, language, still=True) for name in makers}
    for name, maker in makers.items():
        progress(name)
        guide = views.intro(tabs[name].guide, language)
        inner = f"{guide}{maker(language)}{views.words(name, language)}"
        contents[_file(name)] = _page(tabs[name].name, inner, tabs, language)
    links = "".join(
        f'<li><a href="{_file(name)}">{escape(tab.name)}</a>: {escape(tab.summary)}</li>'
        for name, tab in tabs.items()
    )
    text = texts("lab", "page", language)
    about = "".join(
        html_of(piece).replace("<p>", '<p class="guide">') for piece in text.all("about")
    )
    index = _page(text("name"), f"{about}<ul>{links}</ul>", tabs, language)
    return {"index.html": index, **contents}


def _file(name: str) -> str:
    """Name of the file of a tab, the same in every language.

    >>> _file("The top")
    'the-top.html'
    """
    return f"{guides.tab(name, still=True).name.lower().replace(' ', '-')}.html"


def _page(title: str, inner: str, tabs: Mapping[str, guides.Tab], language: str) -> str:
    """A whole page."""
    links = "".join(f'<a href="{_file(name)}">{escape(tab.name)}</a>' for name, tab in tabs.items())
    first = escape(texts("lab", "page", language)("name"))
    return (
        f'<!doctype html>\n<html lang="{escape(code_of(language))}"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
        f"<title>{escape(title)}</title><style>{font_face()}{views.style()}{_BODY}</style></head>\n"
        f'<body><main class="lab"><h1>{escape(title)}</h1><nav><a href="index.html">{first}'
        f"</a>{links}</nav>{inner}</main><script>{_SLIDE}{views.copying()}</script></body></html>\n"
    )


def compass(language: str) -> str:
    """Both paths on the globe, for some courses."""
    text = texts("figures", "still", language)
    slides = []
    for course in COURSES:
        reply = task("compass")(course=course, language=language)
        title = escape(text("degrees", course=course))
        shown = _nameless(views.compass(reply, language))
        slides.append(f"<section><h3>{title}</h3>{shown}</section>")
    return (
        f'<label>{escape(text("course"))} <input type="range" data-slides="courses" min="0" '
        f'max="{len(COURSES) - 1}" value="1"></label><div id="courses">{"".join(slides)}</div>'
    )


def tetrads(language: str) -> str:
    """Some tetrads with their geometry."""
    parts, named, stories = [], space_titles(language), texts("spaces", "stories", language)
    for name in TETRADS:
        facts = space_info(name)
        reply = task("tetrad")(
            coordinates=", ".join(facts["coordinates"]),
            parameters=", ".join(facts["parameters"]),
            entries=facts["coframe"],
            signature=facts["signature"],
            language=language,
        )
        story = f"<p>{escape(stories(name))}</p>"
        opened = " open" if name == TETRADS[0] else ""
        parts.append(
            f'<details{opened} id="{name}"><summary><strong>{escape(name)}: '
            f"{escape(named[name])}</strong></summary>{story}{_forms(facts, language)}"
            f"{_nameless(views.tetrad(reply, language))}</details>"
        )
    return "".join(parts)


def _forms(known: Json, language: str) -> str:
    """The one-forms as they would be typed."""
    rows, text = [], texts("figures", "still", language)
    for i, row in enumerate(known["coframe"], 1):
        terms = [
            f"({text}) d{greek_name(name)}" if text != "1" else f"d{greek_name(name)}"
            for text, name in zip(row, known["coordinates"], strict=True)
            if text != "0"
        ]
        rows.append(f"{text('row', row=i)}  {' + '.join(terms)}")
    return f'<pre class="plan">{escape(chr(10).join(rows))}</pre>'


def loops(language: str) -> str:
    """Loops of several radii, behind a slider."""
    parts, text, named = [], texts("figures", "still", language), space_titles(language)
    for name in LOOPS:
        facts = space_info(name)
        slides = []
        for radius in RADII:
            plane = facts["planes"][0]
            case = {"space": name, "centre": facts["start"], "radius": radius, "plane": plane}
            reply = task("loop")(**case, language=language)
            shown = _nameless(views.loop(reply, language) + views.loop_below(reply, language))
            title = escape(text("of_radius", radius=f"{radius:g}"))
            slides.append(f"<section><h3>{title}</h3>{shown}</section>")
        parts.append(
            f"<h2>{escape(name)}: {escape(named[name])}</h2><label>{escape(text('radius'))} "
            f'<input type="range" data-slides="loops-{name}" min="0" max="{len(RADII) - 1}" '
            f'value="4"></label><div id="loops-{name}">{"".join(slides)}</div>'
        )
    parts.append(views.atoms(task("atoms")(language=language), language))
    return "".join(parts)


def curves(language: str) -> str:
    """The straightest and the shortest curve in some spaces."""
    parts, text, named = [], texts("figures", "still", language), space_titles(language)
    for name, moments in PATHS:
        facts = space_info(name)
        speeds = {f"u{k}": value for k, value in enumerate(facts["velocity"])} | {"t": facts["t"]}
        inertia = {f"I{k}": value for k, value in enumerate(moments)}
        reply = task("paths")(**path_case(name, speeds | inertia), language=language)
        shown = _nameless(views.paths(reply, language) + views.paths_below(reply, language))
        title = f"{name}: {named[name]}"
        if moments:
            title = text("moments", space=title, moments=moments)
        parts.append(f"<h2>{escape(title)}</h2>{shown}")
    return "".join(parts)


def tops(language: str) -> str:
    """Some bodies that turn."""
    parts, text = [], texts("figures", "still", language)
    for key, case in TOPS.items():
        reply = task("top")(**case, language=language)
        shown = views.top(reply, language) + views.top_below(reply, language)
        parts.append(f"<h2>{escape(text(key))}</h2>{_nameless(shown)}")
    return "".join(parts)


def cost_tables(language: str) -> str:
    """Error against time, measured while the page was written."""
    facts = space_info("so3")
    loop = {"space": "so3", "centre": facts["start"], "radius": 0.3, "plane": facts["planes"][0]}
    path = {"space": "so3", "velocity": facts["velocity"], "t": facts["t"], "moments": [1, 2, 3]}
    replies = [
        task("costs")(kind="loop", case=loop, language=language),
        task("costs")(kind="shortest", case=path, language=language),
    ]
    return "".join(_nameless(views.costs(reply, language)) for reply in replies)


def exercises(language: str, chapter: str | None = None) -> str:
    """All exercises with their hints, and the command that checks an answer."""
    parts, text = [], texts("lab", "form", language)
    source = {"language": language, "chapter": chapter}
    own = "" if chapter is None else load_folder(chapter).number
    for heading, listed in task("listing")(**source)["chapters"].items():
        parts.append(f"<h2>{escape(heading)}</h2>")
        for number in listed:
            reply = task("exercise")(number=number, **source)
            asked_for = {"number": number, "seed": 0, "count": reply["hints"]}
            hints = task("hints")(**asked_for, **source)["hints"]
            asked = "".join(
                f'<li>{question["prompt"]}<p class="note">{escape(_how(question))}</p></li>'
                for question in reply["questions"]
            )
            steps = "".join(f"<li>{hint}</li>" for hint in hints)
            stated = _nameless(views.exercise(reply, language))
            folded = escape(text("hints", count=len(hints)))
            folder = Path(chapter).name if chapter and number.startswith(f"{own}.") else ""
            typed = escape(_command(reply, language, folder))
            command = f"{escape(text('command'))} <code>{typed}</code>"
            parts.append(
                f'<section class="card" id="e{number}">{stated}<ul>{asked}</ul>'
                f"<details><summary>{folded}</summary><ol>{steps}</ol></details>"
                f"<p class='note'>{command}</p></section>"
            )
    return "".join(parts)


def _how(question: Json) -> str:
    """Instructions for an answer; a choice has its options, as the command line takes them."""
    if question["kind"] != "choice":
        return str(question["how"])
    return "; ".join(f"{key}: {text}" for key, text in question["options"].items())


def _command(exercise: Json, language: str = ENGLISH, folder: str = "") -> str:
    """The command that checks the answers to an exercise. folder: of a teacher's chapter.

    >>> _command({"number": "1.2", "questions": [{"name": "metric"}, {"name": "volume"}]})
    'geomtorsion exercises check 1.2 "metric=..." "volume=..."'
    """
    names = [question["name"] for question in exercise["questions"]]
    words = [f'"{name}=..."' for name in names] if len(names) > 1 else ['"..."']
    more = [] if language == ENGLISH else ["--language", quote(language)]
    more += ["--chapter", quote(folder)] if folder else []
    return " ".join(["geomtorsion exercises check", exercise["number"], *words, *more])


# The terms at the end of a view, which a page with several views shows once.
_WORDS = re.compile(r'<h3>[^<]*</h3><dl class="words">.*?</dl>', re.DOTALL)


def _nameless(html: str) -> str:
    """A view without ids and terms, for pages that contain it several times."""
    # An id must be unique on a page.
    return re.sub(r' id="[a-z-]+"', "", _WORDS.sub("", html))

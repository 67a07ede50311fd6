"""laws: rules for the built site; the build fails if one is violated.

No page loads from other hosts, no internal link is broken, every public name has an entry.
Links to other hosts are listed in links.txt of the built site; the build uses no network, so it
follows none of them.
"""

# pyright: reportMissingImports=false

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from html.parser import HTMLParser
from inspect import ismodule
from pathlib import Path
from urllib.parse import unquote, urlsplit

from reference import exported_above, public_modules, public_names
from sources import digest
from sphinx.errors import SphinxError

# Attributes by which a page loads something; of <a> only where it leads matters.
_LOADING = {
    "script": ("src",), "img": ("src", "srcset"), "link": ("href",), "source": ("src", "srcset"),
    "iframe": ("src",), "video": ("src", "poster"), "audio": ("src",), "object": ("data",),
    "embed": ("src",), "use": ("href",), "image": ("href",), "form": ("action",),
}  # fmt: skip
# Says where a page is, and loads nothing.
_STILL = ("canonical", "next", "prev", "author", "license")


class _Page(HTMLParser):
    """What a page loads, where its links lead, and where links to it can lead."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.loads: list[str] = []
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self._style = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.anchors |= {given[name] for name in ("id", "name") if given.get(name)}
        self._style = tag == "style"
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        if tag == "link" and given.get("rel") in _STILL:
            return
        self.loads += [given[name] for name in _LOADING.get(tag, ()) if given.get(name)]
        self.loads += list(style_urls(given.get("style", "")))

    def handle_data(self, data: str) -> None:
        if self._style:
            self.loads += list(style_urls(data))

    def handle_endtag(self, tag: str) -> None:
        self._style = False


def style_urls(text: str) -> Iterator[str]:
    """What a style sheet loads: url(...) and @import."""
    for found in re.finditer(r"url\(\s*['\"]?([^'\")]+)|@import\s+['\"]([^'\"]+)", text):
        yield found[1] or found[2]


def is_foreign(address: str) -> bool:
    """Whether an address belongs to another host."""
    parts = urlsplit(address.strip())
    return bool(parts.netloc) or parts.scheme in ("http", "https", "ftp", "ws", "wss")


def faults(folder: Path) -> tuple[list[str], list[str]]:
    """Faults of the pages in a folder, and all links to other hosts."""
    pages = {path: _Page(path.read_text("utf-8")) for path in sorted(folder.rglob("*.html"))}
    wrong: list[str] = []
    outside: set[str] = set()
    for path, page in pages.items():
        name = path.relative_to(folder)
        wrong += [f"{name} loads {one}" for one in page.loads if is_foreign(one)]
        for link in page.links:
            if is_foreign(link):
                outside.add(link)
            elif not _leads(path, link, pages):
                wrong.append(f"{name}: the link {link} leads nowhere")
    for path in sorted(folder.rglob("*.css")):
        text = path.read_text("utf-8")
        wrong += [f"{path.name} loads {one}" for one in style_urls(text) if is_foreign(one)]
    return wrong, sorted(outside)


def _leads(path: Path, link: str, pages: dict[Path, _Page]) -> bool:
    parts = urlsplit(link)
    if parts.scheme in ("mailto", "data", "javascript"):
        return parts.scheme != "javascript"
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    if target not in pages:
        return target.exists()
    return not parts.fragment or unquote(parts.fragment) in pages[target].anchors


def missing_names(known: Iterable[str]) -> list[str]:
    """Public names without an entry; one that a package above exports has its entry there."""
    entries = set(known)
    found = []
    for module in public_modules():
        package = module.__name__
        for name in public_names(module):
            homes = {f"{package}.{name}", *exported_above(package, name)}
            value = getattr(module, name)
            if ismodule(value):
                # Modules that a package offers to other packages are not documented one by one.
                if package != "geomtorsion":
                    continue
                homes.add(value.__name__)
            if not homes & entries:
                found.append(f"{package}.{name}")
    return found


def _check(app, error) -> None:
    if error is not None or app.builder.format != "html":
        return
    folder = Path(app.outdir)
    wrong, outside = faults(folder.resolve())
    names = app.env.domains["py"].objects
    wrong += [f"{name} has no entry in the reference" for name in missing_names(names)]
    (folder / "links.txt").write_text("".join(f"{link}\n" for link in outside), "utf-8")
    if wrong:
        raise SphinxError("\n".join(wrong))
    (folder / "sources.txt").write_text(digest(), "utf-8")


def setup(app) -> dict[str, bool]:
    """Check when everything is written."""
    app.connect("build-finished", _check, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

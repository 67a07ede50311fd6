"""steps: progress of the build, one line for each page, also with `-q`.

The pages are read by several processes (`-j auto`), so that the lines may come in another order.
"""

# pyright: reportMissingImports=false

from __future__ import annotations


def _reading(app, page: str, source: list[str]) -> None:
    pages = sorted(app.env.found_docs)
    print(f"page {pages.index(page) + 1} of {len(pages)}: {page}", flush=True)


def _writing(app, env) -> None:
    print("writing the pages", flush=True)


def setup(app) -> dict[str, bool]:
    """Print a line when a page is read, and one when writing begins."""
    app.connect("source-read", _reading)
    app.connect("env-check-consistency", _writing)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

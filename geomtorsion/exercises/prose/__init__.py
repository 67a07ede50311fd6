"""Prose: statements in Markdown with LaTeX, as a web page or as plain text."""

from geomtorsion.exercises.prose.markdown import html_of, text_of

__all__ = ["html_of", "text_of"]

"""Symmetries of a frame: Killing vectors, their algebra, and Killing-Yano forms."""

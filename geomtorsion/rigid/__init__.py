"""Rigid: how a body stands and turns, with nothing of what acts on it."""

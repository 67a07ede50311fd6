"""Prices of results."""

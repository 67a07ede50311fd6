"""Tests of the page that works without a server."""

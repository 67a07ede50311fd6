"""Settings of the whole suite: random tests repeat themselves and have no clock; one browser."""

from hypothesis import settings

from tests.browser import address, browser, context, lab, watched

__all__ = ["address", "browser", "context", "lab", "watched"]

settings.register_profile("geomtorsion", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("geomtorsion")

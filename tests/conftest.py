"""Settings of the whole suite: random tests repeat themselves and have no clock."""

from hypothesis import settings

settings.register_profile("geomtorsion", deadline=None, derandomize=True, print_blob=True)
settings.load_profile("geomtorsion")

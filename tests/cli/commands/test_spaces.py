"""spaces: the list."""

from geomtorsion.spaces import names
from tests.cli.running import run


def test_spaces_lists_all():
    """Each space has one line, which begins with its name."""
    lines = run("spaces").stdout.splitlines()
    assert [line.split()[0] for line in lines] == list(names())

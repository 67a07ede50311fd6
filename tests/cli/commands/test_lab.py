"""The command for the classroom page: its printed address, code and QR code."""

import ipaddress
import re

import pytest

from geomtorsion.cli.commands import lab as command
from tests.cli.running import run


def printed(monkeypatch, *options: str) -> str:
    """Text that the command prints when the page is ready; nothing is served."""

    def served(address, ready, *_):
        ready(address.guarded().url(2718))

    monkeypatch.setattr(command, "serve", served)
    return run("lab", *options).stdout


def test_the_own_machine_needs_no_code(monkeypatch):
    """Without --host the command prints one line with the address."""
    assert printed(monkeypatch) == "Torsion lab: http://127.0.0.1:2718/  (Ctrl-C ends it)\n"


@pytest.mark.parametrize("host", ["0.0.0.0", "::"])
def test_other_machines_get_address_and_code(monkeypatch, host):
    """The text has the network address, not the wildcard address, and a code of 8 letters."""
    text = printed(monkeypatch, "--host", host)
    found = re.search(r"Other machines: open http://([^:/]+):2718/ and type the code (\w+)", text)
    assert found is not None
    assert len(found[2]) == 8
    assert f"?access_token={found[2]}" in text
    assert host not in text.split()
    if re.fullmatch(r"[0-9.]+", found[1]):
        assert not ipaddress.ip_address(found[1]).is_unspecified


def test_the_code_is_drawn(monkeypatch):
    """A QR code of half blocks is printed, or the text names the extra that draws it."""
    monkeypatch.setattr(command, "shows_greek", lambda: True)
    text = printed(monkeypatch, "--host", "0.0.0.0")
    assert "█▀" in text or "pip install 'geomtorsion[lab]'" in text

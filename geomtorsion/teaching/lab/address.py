"""address: host, port and access code of the page."""

from __future__ import annotations

import ipaddress
import secrets
import socket
from dataclasses import dataclass, field

from geomtorsion.teaching.lab.settings import PAGE

# Letters of a code that a class types from a projector; none resembles another.
LETTERS = "abcdefghjkmnpqrstuvwxyz23456789"


@dataclass(frozen=True)
class Address:
    """Where the page is served.

    host: name or number of an interface; port: 0 takes a free one.
    token: required from a browser; generated unless the host is this machine.
    """

    host: str = "127.0.0.1"
    port: int = 2718
    token: str = field(default="", repr=False)

    @property
    def is_local(self) -> bool:
        """Whether only this machine can reach it.

        Examples
        --------
        >>> Address("localhost").is_local, Address("0.0.0.0").is_local
        (True, False)
        """
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"

    def guarded(self) -> Address:
        """The same address with a token, if other machines can reach it.

        Examples
        --------
        >>> bool(Address("0.0.0.0").guarded().token), Address().guarded().token
        (True, '')
        """
        if self.is_local or self.token:
            return self
        code = "".join(secrets.choice(LETTERS) for _ in range(PAGE.code))
        return Address(self.host, self.port, code)

    def url(self, port: int) -> str:
        """The URL to open in a browser on any machine of the network, token included."""
        name = lan_address() if self.host in ("0.0.0.0", "::") else self.host
        name = f"[{name}]" if ":" in name else name
        return f"http://{name}:{port}/" + (f"?access_token={self.token}" if self.token else "")


def lan_address() -> str:
    """The address of this machine on its network; its name without a network."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            # This sends nothing: the system only chooses the interface. The address is reserved for
            # documentation.
            probe.connect(("192.0.2.1", 9))
            return str(probe.getsockname()[0])
        except OSError:
            return socket.gethostname()
